// Cards of stability maps, ready figures and measured limits.

// Steps of the keys: panel, column, row.
const STEPS = { ArrowLeft: [0, -1, 0], ArrowRight: [0, 1, 0], ArrowUp: [0, 0, 1], ArrowDown: [0, 0, -1], PageUp: [-1, 0, 0], PageDown: [1, 0, 0] };

function mapCard(map, page) {
  const view = html("div", {}), plot = html("div", { class: "plot" }), legend = html("ul", { class: "keys" });
  const has = (name) => map.panels.some((panel) => panel[name].length > 1);
  map.classes.forEach(({ name, colour }) => {
    const swatch = html("i", { class: "swatch" });
    swatch.style.background = colour;
    legend.append(html("li", {}, swatch, name));
  });
  if (has("theory")) legend.append(html("li", {}, html("i", { class: "curve" }), "theory"));
  if (has("measured")) legend.append(html("li", {}, html("i", { class: "curve dotted" }), "measured limit"));
  view.append(plot, legend);
  let drawn = null, at = { panel: 0, i: 0, j: 0 };

  const limit = (panel, name, i) => { const value = valueAt(panel[name], map.x, map.x.values[i]); return value === null ? "" : numberText(value); };
  const className = (value) => map.classes[value]?.name ?? "not measured";
  const rowsAt = (panel, i, j) => [
    [map.x.name, numberText(map.x.values[i])], [map.y.name, numberText(map.y.values[j])], ["class", className(panel.cells[i]?.[j])],
    ["measured limit", limit(panel, "measured", i)], ["theory", limit(panel, "theory", i)],
  ];
  const header = [map.x.name, `${map.y.name}, from`, "to", "class", "measured limit", "theory"];
  const tables = () => map.panels.flatMap((panel) => {
    const rows = panel.cells.flatMap((column, i) => {
      const starts = column.map((value, j) => j).filter((j) => j === 0 || column[j] !== column[j - 1]);
      return starts.map((j, n) => [numberText(map.x.values[i]), numberText(map.y.values[j]), numberText(map.y.values[(starts[n + 1] ?? column.length) - 1]),
        className(column[j]), limit(panel, "measured", i) || "–", limit(panel, "theory", i) || "–"]);
    });
    return [html("h4", { text: panel.name }), table(`${map.title}: ${panel.name}`, header, rows)];
  });
  const isDrawable = map.panels.length > 0 && map.x.values.length > 0 && map.y.values.length > 0;
  const words = () => ({ title: map.title, subtitle, caption: page.caption });
  const svg = isDrawable ? () => drawMap(map, LIGHT, Math.max(700, 96 + 300 * map.panels.length), words()).svg : null;
  const subtitle = has("theory") ? "measured class of each cell; the line is the limit in theory" : "measured class of each cell";
  const self = card(map, { view, subtitle, csv: () => mapCsv(map), svg, table: tables }, page);

  function draw(width) {
    if (!isDrawable) { plot.replaceChildren(html("p", { class: "empty", text: "This map has no cells." })); return; }
    drawn = drawMap(map, theme(), Math.max(width, 260), null);
    drawn.cursor = svgElement("g", { class: "cursor" });
    drawn.svg.append(drawn.cursor);
    drawn.svg.setAttribute("role", "img");
    drawn.svg.setAttribute("tabindex", "0");
    const names = map.panels.map((panel) => panel.name).join(", "), keys = "Arrow keys move between cells, Page Up and Page Down between panels";
    drawn.svg.setAttribute("aria-label", `${map.title}: ${names}. ${keys}; the table has all values.`);
    plot.replaceChildren(drawn.svg);
  }

  function show() {
    active.set(plot, leave);
    const { panel, x, y } = drawn.panels[at.panel], [x0, x1, y0, y1] = [x[at.i], x[at.i + 1], y[at.j], y[at.j + 1]];
    const edge = (stroke, width) => between(x0, x1, y0, y1, { fill: "none", stroke, "stroke-width": width });
    drawn.cursor.replaceChildren(edge("#ffffff", 5), edge("#14171b", 2));
    const corner = drawn.svg.getBoundingClientRect(), rows = rowsAt(panel, at.i, at.j);
    tip.show(panel.name, rows, corner.left + Math.max(x0, x1), corner.top + Math.max(y0, y1), x0 > drawn.svg.clientWidth / 2);
    return [panel.name, ...rows.filter((row) => row[1]).map((row) => row.join(" "))].join(", ");
  }

  const leave = () => { tip.hide(); drawn?.cursor.replaceChildren(); };
  function point(event) {
    if (!drawn) return;
    const corner = drawn.svg.getBoundingClientRect(), [px, py] = [event.clientX - corner.left, event.clientY - corner.top];
    const cell = (edges, p) => edges.slice(1).findIndex((edge, n) => (edge - p) * (edges[n] - p) <= 0);
    const panel = drawn.panels.findIndex(({ x, y }) => cell(x, px) >= 0 && cell(y, py) >= 0);
    if (panel < 0) return leave();
    at = { panel, i: cell(drawn.panels[panel].x, px), j: cell(drawn.panels[panel].y, py) };
    show();
  }
  plot.addEventListener("pointermove", point);
  plot.addEventListener("pointerdown", point);
  plot.addEventListener("pointerleave", (event) => { if (event.pointerType !== "touch") leave(); });
  plot.addEventListener("focusin", () => { if (drawn?.svg.matches(":focus-visible")) live(show()); });
  plot.addEventListener("focusout", leave);
  plot.addEventListener("keydown", (event) => {
    if (event.key === "Escape") return leave();
    const step = STEPS[event.key];
    if (!step || !drawn) return;
    event.preventDefault();
    const clamp = (n, count) => Math.max(0, Math.min(n, count - 1));
    at = { panel: clamp(at.panel + step[0], map.panels.length), i: clamp(at.i + step[1], map.x.values.length), j: clamp(at.j + step[2], map.y.values.length) };
    live(show());
  });
  onWidth(plot, draw);

  self.update = () => { if (plot.clientWidth) draw(plot.clientWidth); };
  return self;
}

// A ready SVG inside of an image, where it can neither run scripts nor load anything.
function figureCard(figure, page) {
  const width = Number(/^\s*<svg[^>]*?\swidth="(\d+)/.exec(figure.svg)?.[1]) || 900;
  const alt = [figure.title, figure.summary].filter(Boolean).join(": ");
  const image = html("img", { width, alt, src: `data:image/svg+xml,${encodeURIComponent(figure.svg.toWellFormed?.() ?? figure.svg)}` });
  image.style.minWidth = `${Math.min(width, 700)}px`; // Narrower, its texts could not be read: it scrolls instead.
  const frame = html("div", { class: "scroll figure", tabindex: "0", role: "region", "aria-label": `Figure: ${figure.title}` }, image);
  const view = html("div", {}, frame);
  image.addEventListener("error", () => frame.replaceChildren(html("p", { class: "empty", text: "This figure cannot be shown." })));
  const rows = () => { const [header = [], ...rows] = parseCsv(figure.csv); return table(`Data of ${figure.title}`, header, rows); };
  const csv = figure.csv ? () => figure.csv : null, svg = figure.svg ? () => figure.svg : null;
  const self = card(figure, { view, csv, svg, table: csv && rows }, page);
  self.note.textContent = figure.summary;
  self.note.classList.add("summary");
  return self;
}

// Measured stability limits beside theory, as a table with the ratio drawn from half to twice the theory.
function limitsCard(item, page) {
  const ratio = (row) => isPositive(row.theory) && isPositive(row.measured) ? row.measured / row.theory : null;
  const bar = (value) => {
    const svg = svgElement("svg", { width: 130, height: 20, viewBox: "0 0 130 20", "aria-hidden": "true", class: "ratio" }), place = logScale(0.5, 2, 5, 125);
    svg.append(segment(5, 10, 125, 10, { class: "rail" }), segment(65, 2, 65, 18, { class: "one" }));
    const look = Math.abs(value - 1) > 0.03 ? "off" : "near";
    if (value) svg.append(svgElement("circle", { cx: Math.max(5, Math.min(place(value), 125)), cy: 10, r: 4.5, class: look }));
    return svg;
  };
  const view = html("div", {});
  const rows = () => item.rows.filter((row) => page.matches(item, `${row.scheme} ${row.number}`));
  const asCells = (row) => [row.field, row.scheme, row.number, row.theory, row.measured, ratio(row)];
  const csv = () => csvText([["field", "scheme", "number", "theory", "measured", "ratio"], ...item.rows.map(asCells)]);
  const subtitle = "measured by bisection; the dot shows the ratio from a half to twice, red where it is off by more than 3 %";
  const self = card(item, { view, subtitle, csv }, page);
  self.update = () => {
    const text = (value) => isPositive(value) ? numberText(value, 4) : "failed";
    const cells = rows().map((row) => [row.scheme, row.number, text(row.theory), text(row.measured), ratio(row) ? ratio(row).toFixed(3) : "–", ""]);
    const built = table(`${item.title}: ${item.field}`, ["scheme", "number", "theory", "measured", "measured / theory", "drawn"], cells);
    [...built.querySelectorAll("tbody tr")].forEach((line, n) => line.lastChild.append(bar(ratio(rows()[n]))));
    view.replaceChildren(built);
  };
  return self;
}
