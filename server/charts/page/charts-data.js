// Data of the page: reading, lines of methods, Pareto front, time at an error, ticks, numbers as text, CSV.
// Twin of `line.rs`, `ticks.rs` and `row.rs`.

const isPositive = (x) => typeof x === "number" && Number.isFinite(x) && x > 0;
const isNumber = (x) => typeof x === "number" && Number.isFinite(x);
const list = (x) => Array.isArray(x) ? x : [];
const objects = (x) => list(x).filter((item) => item !== null && typeof item === "object");
const string = (x) => typeof x === "string" ? x : isNumber(x) ? String(x) : "";
const isColour = (x) => /^#[0-9a-f]{6}$/i.test(x);
const pairs = (x) => list(x).filter((at) => Array.isArray(at) && isNumber(at[0]) && isNumber(at[1]));

// Parses the data and fills in what is missing, so that all later code finds strings and arrays.
function readData(text) {
  let data = {};
  try { data = JSON.parse(text) ?? {}; } catch { return null; }
  const charts = objects(data.charts).map((chart) => ({
    kind: "chart", field: string(chart.field) || "other", title: string(chart.problem), error: string(chart.error) || "error", per: string(chart.per),
    default: string(chart.default), rows: objects(chart.rows).map(readRow),
    limit: readLimit(chart.limit),
  }));
  const axis = (axis) => ({ name: string(axis?.name), values: list(axis?.values).filter(isNumber), logarithmic: Boolean(axis?.logarithmic) });
  const maps = objects(data.maps).map((map) => ({
    kind: "map", field: string(map.field) || "other", title: string(map.title), x: axis(map.x), y: axis(map.y),
    classes: objects(map.classes).map(({ name, colour }, n) => ({ name: string(name), colour: isColour(colour) ? colour : LIGHT.colours[n % 11] })),
    panels: objects(map.panels).map((panel) => ({
      name: string(panel.name), cells: list(panel.cells).map(list), theory: pairs(panel.theory), measured: pairs(panel.measured),
    })),
  }));
  const figures = objects(data.figures).map((figure) => ({
    kind: "figure", field: string(figure.field) || "other", title: string(figure.title) || string(figure.name), name: string(figure.name),
    svg: string(figure.svg), csv: string(figure.csv), summary: string(figure.summary),
  }));
  const limits = objects(data.limits).map(({ field, scheme, number, theory, measured }) => ({
    field: string(field) || "limits", scheme: string(scheme), number: string(number), theory, measured,
  }));
  const about = ["date", "about", "command"].map((name) => string(data[name]));
  return { date: about[0], about: about[1], command: about[2], isQuick: data.is_quick === true, charts, maps, figures, limits };
}

function readLimit(limit) {
  const points = pairs(limit?.points).filter((at) => at.slice(0, 2).every(isPositive));
  return points.length ? { label: string(limit.label) || "limit", points } : null;
}

function readRow(row) {
  const { dt_secs, l2, max, simulated_secs, wall_secs } = row;
  return { method: string(row.method) || "unnamed", cells: list(row.cells).filter(isNumber), dt_secs, l2, max, simulated_secs, wall_secs };
}

// Methods of a chart in the order in which they first occur, each with its colour, marker and whether the marker is hollow. Methods of one family share
// colour and marker; the first has solid markers.
function methodsOf(chart) {
  const families = [];
  return [...new Set(chart.rows.map((row) => row.method))].map((name, n) => {
    const family = name.includes(", ") ? name.slice(0, name.lastIndexOf(", ")) : name;
    const isKnown = families.includes(family);
    if (!isKnown) families.push(family);
    const place = families.indexOf(family);
    return {
      name, n, colour: place % 11, marker: (place % 11 + Math.floor(place / 11)) % MARKERS.length, isHollow: isKnown,
      isDefault: chart.default !== "" && (name === chart.default || name.startsWith(chart.default + ", ")),
    };
  });
}

// A line per method: its rows with a positive, finite error and time. Methods without such a row have none.
function linesOf(chart, methods, norm) {
  const isDrawable = (row) => isPositive(row[norm]) && isPositive(row.wall_secs);
  return methods.map((method) => ({
    method,
    points: chart.rows.filter((row) => row.method === method.name && isDrawable(row)).map((row) => ({ row, error: row[norm], secs: row.wall_secs })),
  })).filter((line) => line.points.length > 0);
}

// The Pareto front: the points that no other beats in both error and time, by falling error.
function frontOf(lines) {
  const points = lines.flatMap((line) => line.points).sort((a, b) => a.secs - b.secs || a.error - b.error);
  let best = Infinity;
  return points.filter((point) => point.error < best && (best = point.error, true));
}

// Wall time (s) of a method at `error`: of its cheapest run that reaches it, or less if its line, interpolated logarithmically, crosses `error` between two
// runs. `null` if no run reaches it.
function secsAt(line, error) {
  const found = line.points.filter((point) => point.error <= error).map((point) => point.secs);
  line.points.slice(1).forEach((b, n) => {
    const a = line.points[n];
    if (a.error > error && error >= b.error) {
      found.push(a.secs * (b.secs / a.secs) ** (Math.log(a.error / error) / Math.log(a.error / b.error)));
    }
  });
  return found.length ? Math.min(...found) : null;
}

// The fastest line at `error` with its time (s); `null` if none reaches it.
function fastestAt(lines, error) {
  const times = lines.map((line) => ({ line, secs: secsAt(line, error) })).filter((time) => time.secs !== null);
  return times.reduce((a, b) => a && a.secs <= b.secs ? a : b, null);
}

// Why a row is not drawn; an empty string if it is.
function failureOf(row, norm) {
  const word = (x) => x === 0 ? "is 0" : isNumber(x) ? "is negative" : "is missing";
  if (!isPositive(row[norm])) return `failed: error ${word(row[norm])}`;
  return isPositive(row.wall_secs) ? "" : `failed: time ${word(row.wall_secs)}`;
}

// ---- Axes and numbers ----

const superscript = (power) => String(power).replace("-", "⁻").replace(/\d/g, (digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit]);

// Grid lines of a logarithmic axis: multiples of the powers of ten, on long axes only the powers. Minor lines have no label.
function logTicks(least, most) {
  const decades = Math.log10(most / least), found = [];
  const labelled = decades > 2.5 ? [1] : decades > 0.9 ? [1, 2, 5] : [1, 2, 3, 4, 5, 6, 7, 8, 9];
  for (let power = Math.floor(Math.log10(least)); power <= Math.floor(Math.log10(most)); power++) {
    for (let digit = 1; digit < (decades > 8 ? 2 : 10); digit++) {
      const value = Number(`${digit}e${power}`);
      if (value >= least && value <= most) found.push({ value, label: labelled.includes(digit) ? numberText(value) : "" });
    }
  }
  return found;
}

// About `count` round values between two numbers.
function linearTicks(least, most, count) {
  const rough = (most - least) / count, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((digit) => digit * power).find((step) => step >= rough * 0.999) ?? 10 * power, found = [];
  for (let n = Math.ceil(least / step - 1e-9); n * step <= most + 1e-9 * step; n++) found.push({ value: n * step, label: numberText(n * step, 4) });
  return found;
}

// A number to three digits: plain from 0.001 to below 100 000, otherwise like 2·10⁻⁴.
function numberText(x, digits = 3) {
  if (!isNumber(x)) return "–";
  const size = Math.abs(x);
  if (size < 1e-300) return "0";
  if (size >= 9.995e-4 && size < 1e5) return String(Number(x.toPrecision(digits))).replace("-", "−");
  const [factor, power] = x.toExponential(digits - 1).split("e").map(Number);
  return (factor === 1 ? "" : `${factor}·`.replace("-", "−")) + `10${superscript(power)}`;
}

// A time (s) in the unit that suits it.
function secsText(secs) {
  if (!isNumber(secs)) return "–";
  const [unit, name] = [[1, "s"], [1e-3, "ms"], [1e-6, "µs"], [1e-9, "ns"]].find(([unit]) => Math.abs(secs) >= 0.9995 * unit) ?? [1, "s"];
  return `${numberText(secs / unit)} ${name}`;
}

const cellsText = (cells) => cells.length ? cells.join("×") : "–";
const timesText = (ratio) => `${ratio < 9.95 ? ratio.toFixed(2) : numberText(ratio)}×`;

// ---- CSV (RFC 4180) ----

const quoted = (value) => {
  const text = value === null || value === undefined ? "" : String(value);
  return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
};
const csvText = (rows) => rows.map((row) => row.map(quoted).join(",") + "\n").join("");

function chartCsv(chart) {
  const rows = chart.rows.map((row) => [
    chart.field, chart.title, row.method, row.cells.join("x"), row.dt_secs, row.l2, row.max, row.simulated_secs, row.wall_secs,
  ]);
  return csvText([["field", "problem", "method", "cells", "dt_secs", "l2", "max", "simulated_secs", "wall_secs"], ...rows]);
}

function mapCsv(map) {
  const rows = map.panels.flatMap((panel) => panel.cells.flatMap((column, i) => column.map((value, j) => {
    const x = map.x.values[i], limits = [panel.measured, panel.theory].map((curve) => valueAt(curve, map.x, x));
    return [panel.name, x, map.y.values[j], map.classes[value]?.name, ...limits];
  })));
  return csvText([["panel", map.x.name, map.y.name, "class", "measured_limit", "theory"], ...rows]);
}

// Rows of a CSV text, each an array of strings.
function parseCsv(text) {
  const rows = [];
  let row = [], cell = "", isQuoted = false;
  const endRow = () => { if (cell || row.length) rows.push([...row, cell]); row = []; cell = ""; };
  for (let n = 0; n < text.length; n++) {
    const c = text[n];
    if (c === '"' && isQuoted && text[n + 1] === '"') { cell += c; n++; }
    else if (c === '"') isQuoted = !isQuoted;
    else if (isQuoted) cell += c;
    else if (c === ",") { row.push(cell); cell = ""; }
    else if (c === "\n") endRow();
    else if (c !== "\r") cell += c;
  }
  endRow();
  return rows;
}

// Value of a curve at `x`, interpolated along the axis; `null` outside of the curve.
function valueAt(curve, axis, x) {
  const place = axis.logarithmic ? Math.log : Number;
  for (let n = 0; n < curve.length; n++) {
    const [a, b] = [curve[n], curve[n + 1] ?? curve[n]];
    if (a[0] === x) return a[1];
    if ((a[0] - x) * (b[0] - x) < 0) return a[1] + (b[1] - a[1]) * (place(x) - place(a[0])) / (place(b[0]) - place(a[0]));
  }
  return null;
}
