// Drawings as SVG elements with explicit colours, so that the same function draws on the page and for a download. Twin of `plot.rs` and `figure.rs`.

// Colours of `plot.rs`: the palette of Okabe & Ito without yellow, then darker colours of Tol's.
const LIGHT = {
  paper: "#ffffff", ink: "#20242a", faint: "#60666e", grid: "#d0d4d9", faintGrid: "#eceef1", front: "#ffe599",
  colours: ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#332288", "#882255", "#999933", "#282828", "#44aa99"],
};
// The same hues, light enough for a dark ground.
const DARK = {
  paper: "#1b2019", ink: "#e9ebe4", faint: "#a6aca0", grid: "#3a4138", faintGrid: "#272d25", front: "#75611f",
  colours: ["#3d9fe3", "#f5813a", "#27c596", "#e59ac5", "#a3dbfa", "#f3b93c", "#a79cf5", "#de76a2", "#c6c65f", "#f0f0f0", "#74d3c4"],
};
const FONT = "Helvetica, Arial, sans-serif";
// Corners of the markers (px).
const MARKERS = [
  "-2,-5 2,-5 5,-2 5,2 2,5 -2,5 -5,2 -5,-2", "-5,-5 5,-5 5,5 -5,5", "0,-7 7,5 -7,5", "0,-7 7,0 0,7 -7,0", "0,7 7,-5 -7,-5",
  "-2,-6 2,-6 2,-2 6,-2 6,2 2,2 2,6 -2,6 -2,2 -6,2 -6,-2 -2,-2",
];

function svgElement(tag, attributes, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, typeof value === "number" ? Number(value.toFixed(2)) : value);
  element.append(...children);
  return element;
}

const corners = (points) => points.map((at) => at.map((x) => x.toFixed(1)).join()).join(" ");
const path = (points, attributes) => svgElement("polyline", { points: corners(points), fill: "none", ...attributes });
const segment = (x1, y1, x2, y2, attributes) => svgElement("line", { x1, y1, x2, y2, ...attributes });
const box = (x, y, width, height, attributes) => svgElement("rect", { x, y, width: Math.max(width, 0), height: Math.max(height, 0), ...attributes });

// Rectangle between two values of x and two of y.
const between = (x0, x1, y0, y1, attributes) => box(Math.min(x0, x1), Math.min(y0, y1), Math.abs(x1 - x0), Math.abs(y1 - y0), attributes);

// Text, vertically centred at `y`; `align` is start, middle or end.
function label(text, x, y, theme, { size = 13, align = "start", colour = theme.ink, halo = false, turned = false } = {}) {
  const around = halo ? { stroke: theme.paper, "stroke-width": 4, "stroke-linejoin": "round", "paint-order": "stroke" } : {};
  const turn = turned ? { transform: `rotate(-90 ${x.toFixed(1)} ${y.toFixed(1)})` } : {};
  return svgElement("text", { x, y: y + size * 0.35, "font-size": size, "font-family": FONT, "text-anchor": align, fill: colour, ...around, ...turn }, text);
}

// Approximate width of a text (px).
const widthOf = (text, size = 13) => 0.54 * size * [...text].length;

function marker(method, x, y, theme, scale = 1) {
  const colour = theme.colours[method.colour];
  return svgElement("polygon", {
    points: MARKERS[method.marker], transform: `translate(${x.toFixed(1)} ${y.toFixed(1)}) scale(${scale})`, fill: method.isHollow ? theme.paper : colour,
    stroke: colour, "stroke-width": 2, "stroke-linejoin": "round",
  });
}

// Empty drawing; for a download with ground, title and caption.
function canvas(width, height, theme, words) {
  const svg = svgElement("svg", { width, height, viewBox: `0 0 ${width} ${height}` });
  if (words) {
    svg.setAttribute("xmlns", "http://www.w3.org/2000/svg");
    svg.append(box(0, 0, width, height, { fill: theme.paper }), label(words.title, 24, 30, theme, { size: 22 }));
    svg.append(label(words.subtitle, 24, 56, theme, { colour: theme.faint }));
    svg.append(label(words.caption, 24, height - 18, theme, { size: 12, colour: theme.faint }));
  }
  return svg;
}

// Grid lines, numbers and titles of both axes. Labels that would touch the previous one are left out.
function drawAxes(svg, frame, theme, x, y) {
  const { left, top, width, height } = frame, [right, bottom] = [left + width, top + height];
  const lines = svgElement("g", {}), texts = svgElement("g", {});
  let end = -Infinity;
  for (const tick of [...x.ticks].sort((a, b) => Boolean(a.label) - Boolean(b.label))) {
    const at = x.place(tick.value), half = widthOf(tick.label) / 2;
    lines.append(segment(at, top, at, bottom, { stroke: tick.label ? theme.grid : theme.faintGrid }));
    if (tick.label && at - half > end + 6) {
      texts.append(label(tick.label, Math.min(at, right + 11 - half), bottom + 14, theme, { align: "middle" }));
      end = at + half;
    }
  }
  end = Infinity;
  for (const tick of [...y.ticks].sort((a, b) => Boolean(a.label) - Boolean(b.label))) {
    const at = y.place(tick.value);
    lines.append(segment(left, at, right, at, { stroke: tick.label ? theme.grid : theme.faintGrid }));
    if (tick.label && y.isLabelled !== false && at < end - 16) {
      texts.append(label(tick.label, left - 7, at, theme, { align: "end" }));
      end = at;
    }
  }
  texts.append(label(x.title, left + width / 2, bottom + 38, theme, { size: widthOf(x.title, 14) > width + left ? 12 : 14, align: "middle" }));
  if (y.isLabelled !== false) texts.append(label(y.title, left - 60, top + height / 2, theme, { size: 14, align: "middle", turned: true }));
  svg.append(lines, box(left, top, width, height, { fill: "none", stroke: theme.faint }), texts);
}

const least = (values) => values.reduce((a, b) => Math.min(a, b), Infinity);
const most = (values) => values.reduce((a, b) => Math.max(a, b), 0);
const logScale = (from, to, start, end) => (value) => start + (end - start) * Math.log(value / from) / Math.log(to / from);

// Points of a limit over the whole chart: a single one is a horizontal line.
function limitPoints(limit, errors) {
  return limit.points.length > 1 ? limit.points : errors.map((error) => [error, limit.points[0][1]]);
}

// Inner drawing that clips at the frame, in the same coordinates.
function clipped({ left, top, width, height }, ...children) {
  return svgElement("svg", { x: left, y: top, width, height, viewBox: `${left} ${top} ${width} ${height}` }, ...children);
}

// A work–precision diagram. `view` has the chart's lines, the lines that are shown, its front, limit and titles. Returns the SVG, the
// groups of the lines, the frame of the plot, and the places of the points. For a download (`words`) the legend is drawn, too.
// The axes hold all methods, also hidden ones, so that they stay while methods come and go.
function drawPlot(view, theme, width, words) {
  const points = view.lines.flatMap((line) => line.points);
  const range = (values) => [least(values) / 1.5, most(values) * 1.5];
  const errors = range(points.map((point) => point.error)), drawn = range(points.map((point) => point.secs));
  const limit = view.limit ? limitPoints(view.limit, errors) : [];
  // A limit far away would squeeze the lines; the page states it in words.
  const isNear = limit.length > 0 && least(limit.map((at) => at[1])) > drawn[0] / 1e3 && most(limit.map((at) => at[1])) < drawn[1] * 1e3;
  const times = isNear ? range([...points.map((point) => point.secs), ...limit.map((at) => at[1])]) : drawn;
  const height = words ? 660 : Math.round(Math.min(520, Math.max(330, width * 0.68)));
  const frame = words ? { left: 84, top: 82, width: 660, height: 490 } : { left: 70, top: 10, width: width - 82, height: height - 64 };
  const svg = canvas(width, height, theme, words);
  const [x, y] = [logScale(...errors, frame.left, frame.left + frame.width), logScale(...times, frame.top + frame.height, frame.top)];
  drawAxes(svg, frame, theme, { ticks: logTicks(...errors), place: x, title: view.errorTitle }, { ticks: logTicks(...times), place: y, title: view.timeTitle });

  const best = view.front.map((point) => [x(point.error), y(point.secs)]);
  best.forEach(([cx, cy]) => svg.append(svgElement("circle", { cx, cy, r: 10, fill: theme.front })));
  svg.append(path(best, { stroke: theme.front, "stroke-width": 13, "stroke-linejoin": "round" }));
  const groups = new Map(), places = [];
  for (const line of view.shown) {
    const group = drawLine(line, x, y, theme, width < 480 ? 0.75 : 1, places);
    groups.set(line.method.n, group);
    svg.append(group);
  }
  if (isNear) drawLimit(svg, view.limit.label, limit.map((at) => [x(at[0]), y(at[1])]), frame, theme);
  labelDefault(svg, places, frame, theme);
  if (words) drawLegend(svg, view, theme, 772, 96);
  const errorAt = (px) => errors[0] * (errors[1] / errors[0]) ** ((px - frame.left) / frame.width);
  return { svg, groups, places, frame, errorAt, placeError: x, isLimitNear: isNear };
}

// A method's line with its markers; the default method has a thick line and rings. Adds its points to `places`.
function drawLine(line, x, y, theme, scale, places) {
  const { method } = line, at = line.points.map((point) => [x(point.error), y(point.secs)]);
  const joined = path(at, { stroke: theme.colours[method.colour], "stroke-width": method.isDefault ? 4 : 2, "stroke-linejoin": "round" });
  const group = svgElement("g", { class: "line" }, joined);
  line.points.forEach((point, n) => {
    const [cx, cy] = at[n], element = marker(method, cx, cy, theme, scale);
    if (method.isDefault) group.append(svgElement("circle", { cx, cy, r: 9.5 * scale, fill: "none", stroke: theme.ink, "stroke-width": 1.5 }));
    group.append(element);
    places.push({ x: cx, y: cy, point, line, element });
  });
  return group;
}

// The word "default" beside the most accurate point of the default method.
function labelDefault(svg, places, frame, theme) {
  const own = places.filter((place) => place.line.method.isDefault).filter((place, n, all) => place.line === all[0].line);
  if (!own.length) return;
  const { x, y } = own.reduce((a, b) => a.x <= b.x ? a : b);
  const isRight = x > frame.left + frame.width - 80, isLow = y + 14 > frame.top + frame.height - 8;
  svg.append(label("default", isRight ? x - 16 : x + 16, isLow ? y - 16 : y + 14, theme, { align: isRight ? "end" : "start", halo: true }));
}

// Dashed line of a machine limit, with its label at the right end.
function drawLimit(svg, text, points, frame, theme) {
  const end = points.reduce((a, b) => a[0] >= b[0] ? a : b)[1], inside = Math.max(frame.top, Math.min(end, frame.top + frame.height));
  const size = Math.min(13, (frame.width - 20) / widthOf(text, 1));
  svg.append(clipped(frame, path(points, { stroke: theme.ink, "stroke-width": 1.5, "stroke-dasharray": "7 5" })));
  svg.append(label(text, frame.left + frame.width - 8, inside + (inside > frame.top + 30 ? -11 : 12), theme, { align: "end", halo: true, size }));
}

// Line of a legend entry, 34 px long.
const keyLine = (method, x, y, theme) => segment(x, y, x + 34, y, { stroke: theme.colours[method.colour], "stroke-width": method.isDefault ? 4 : 2 });

function drawLegend(svg, view, theme, left, top) {
  const step = Math.min(25, 480 / (view.shown.length + 1));
  view.shown.forEach(({ method }, n) => {
    const y = top + step * n, text = method.name + (method.isDefault ? " (default)" : "");
    svg.append(keyLine(method, left, y, theme), marker(method, left + 17, y, theme), label(text, left + 46, y, theme));
  });
  const y = top + step * view.shown.length;
  svg.append(segment(left, y, left + 34, y, { stroke: theme.front, "stroke-width": 13 }), label("Pareto front", left + 46, y, theme));
}

// ---- Stability maps ----

// Edges of the cells around values, halfway between neighbours (on a logarithmic axis in the logarithm).
function edgesOf(axis, count) {
  const isLog = axis.logarithmic && axis.values.every(isPositive), [to, from] = isLog ? [Math.log, Math.exp] : [Number, Number];
  const at = axis.values.slice(0, count).map(to);
  const first = at.length > 1 ? (at[1] - at[0]) / 2 : 0.5, last = at.length > 1 ? (at.at(-1) - at.at(-2)) / 2 : 0.5;
  const edges = [at[0] - first, ...at.slice(1).map((value, n) => (value + at[n]) / 2), at.at(-1) + last].map(from);
  return { edges, isLog };
}

// Axis of a map over pixels from `start` to `end`.
function mapAxis(axis, start, end) {
  const { edges, isLog } = edgesOf(axis, axis.values.length), range = [edges[0], edges.at(-1)];
  const place = isLog ? logScale(...range, start, end) : (value) => start + (end - start) * (value - range[0]) / (range[1] - range[0]);
  const [low, high] = [Math.min(...range), Math.max(...range)];
  const count = Math.max(3, Math.abs(end - start) / (end > start ? 70 : 45));
  const ticks = (isLog ? logTicks(low, high) : linearTicks(low, high, count)).filter((tick) => tick.label);
  return { place, ticks, title: axis.name, pixels: edges.map(place) };
}

// A stability map: panels beside and below each other, each with its frame and the pixel edges of its cells.
function drawMap(map, theme, width, words) {
  const columns = Math.max(1, Math.min(map.panels.length, Math.floor((width - 60) / 270)));
  const [head, foot] = words ? [78, 84] : [4, 4];
  const start = words ? 84 : 70, panelWidth = (width - start - 12 - (columns - 1) * 24) / columns;
  const panelHeight = Math.min(340, Math.max(230, panelWidth * 0.95));
  const rows = Math.ceil(map.panels.length / columns), rowHeight = panelHeight + 86;
  const svg = canvas(width, head + rows * rowHeight + foot, theme, words);
  const panels = map.panels.map((panel, n) => {
    const [left, top] = [start + (n % columns) * (panelWidth + 24), head + 24 + Math.floor(n / columns) * rowHeight];
    const frame = { left, top, width: panelWidth, height: panelHeight };
    const [x, y] = [mapAxis(map.x, frame.left, frame.left + frame.width), mapAxis(map.y, frame.top + frame.height, frame.top)];
    y.isLabelled = n % columns === 0;
    const cells = svgElement("g", { "shape-rendering": "crispEdges" });
    panel.cells.forEach((column, i) => {
      for (let j = 0, end = 0; j < column.length; j = end) {
        while (end < column.length && column[end] === column[j]) end++;
        const [x0, x1, y0, y1] = [x.pixels[i], x.pixels[i + 1], y.pixels[end], y.pixels[j]], known = map.classes[column[j]];
        if (known && [x0, x1, y0, y1].every(isNumber)) cells.append(between(x0, x1, y0, y1, { fill: known.colour }));
      }
    });
    svg.append(label(panel.name, frame.left, frame.top - 12, theme, { size: 14 }));
    drawAxes(svg, frame, theme, x, y);
    const clip = clipped(frame, cells);
    svg.append(clip, box(frame.left, frame.top, frame.width, frame.height, { fill: "none", stroke: theme.faint }));
    const curve = (points) => points.map((at) => [x.place(at[0]), y.place(at[1])]).filter((at) => at.every(isNumber));
    drawCurve(clip, curve(panel.theory), "");
    drawCurve(clip, curve(panel.measured), "2 5");
    return { panel, frame, x: x.pixels, y: y.pixels };
  });
  if (words) drawMapLegend(svg, map, theme, head + rows * rowHeight + 12);
  return { svg, panels };
}

// A black line with a white edge, visible on any class.
function drawCurve(svg, points, dashes) {
  if (points.length < 2) return;
  const ends = dashes ? { "stroke-dasharray": dashes, "stroke-linecap": "round" } : {};
  svg.append(path(points, { stroke: "#ffffff", "stroke-width": dashes ? 6 : 5, opacity: 0.85, ...ends }));
  svg.append(path(points, { stroke: "#14171b", "stroke-width": dashes ? 3 : 2, ...ends }));
}

function drawMapLegend(svg, map, theme, y) {
  let x = 84;
  const key = (text, ...drawn) => { svg.append(...drawn, label(text, x + 28, y, theme)); x += 52 + widthOf(text); };
  map.classes.forEach(({ name, colour }) => key(name, box(x, y - 8, 20, 16, { fill: colour })));
  const curve = (dashes) => { const clip = svgElement("g", {}); drawCurve(clip, [[x, y], [x + 22, y]], dashes); return clip; };
  if (map.panels.some((panel) => panel.theory.length)) key("theory", curve(""));
  if (map.panels.some((panel) => panel.measured.length)) key("measured limit", curve("2 5"));
}
