// Card of a work–precision diagram: drawing, legend with the times at the error under the pointer, tooltips, keyboard control, table.

const SIDES = "left: more accurate · down: faster";

class ChartCard {
  constructor(chart, page) {
    Object.assign(this, { chart, page, methods: methodsOf(chart), norm: "l2", lines: [], front: [], shown: [], drawn: null });
    this.time = chart.per ? `wall time per ${chart.per}` : "wall time";
    this.plot = html("div", { class: "plot" });
    const view = html("div", { class: "columns" }, this.plot, html("div", {}, this.buildLegend()));
    const parts = { view, subtitle: SIDES, csv: () => chartCsv(chart), svg: () => this.standalone(), table: () => this.table() };
    this.card = Object.assign(card(chart, parts, page), { update: () => this.update() });
    this.leave = this.leave.bind(this);
    this.plot.addEventListener("pointermove", (event) => this.point(event));
    this.plot.addEventListener("pointerdown", (event) => this.point(event));
    this.plot.addEventListener("pointerleave", (event) => { if (event.pointerType !== "touch") this.leave(); });
    this.plot.addEventListener("keydown", (event) => this.press(event));
    onWidth(this.plot, (width) => this.draw(width));
  }

  key(method) { return `${this.chart.key}/${method.name}`; }

  isShown(method) { return !this.page.state.hidden.has(this.key(method)); }

  isOnFront(method) { return this.front.some((point) => point.row.method === method.name); }

  // Whether a method passes the filters above the charts.
  fits(method) { return this.page.matches(this.chart, method.name) && (!this.page.state.front || this.isOnFront(method)); }

  // ---- State ----

  update() {
    this.norm = this.page.state.norm;
    this.lines = linesOf(this.chart, this.methods, this.norm);
    this.front = frontOf(this.lines);
    this.shown = this.lines.filter(({ method }) => this.fits(method) && this.isShown(method));
    for (const { method, entry, button } of this.keys) {
      const isDrawable = this.lines.some((line) => line.method === method), isShown = this.isShown(method);
      entry.hidden = !this.fits(method);
      button.setAttribute("aria-pressed", String(isShown));
      button.title = !isDrawable ? "No run can be drawn" : isShown ? "Hide this method" : "Show this method";
      button.classList.toggle("failed", !isDrawable);
    }
    this.bandEntry.hidden = this.front.length === 0;
    this.card.element.querySelector(".svg").hidden = this.shown.length === 0;
    this.leave();
    this.writeNote();
    if (this.plot.clientWidth) this.draw(this.plot.clientWidth);
    return this.methods.length === 0 || this.methods.some((method) => this.fits(method));
  }

  writeNote() {
    const { rows, limit } = this.chart, failed = rows.filter((row) => failureOf(row, this.norm)).length, notes = [];
    if (failed) notes.push(`${failed} of ${rows.length} runs failed or have no error in this norm; they are in the table, not in the drawing.`);
    this.limitEntry.hidden = !this.drawn?.isLimitNear;
    if (limit && this.drawn && !this.drawn.isLimitNear) {
      notes.push(`The limit “${limit.label}” (${secsText(limit.points[0][1])}) is far outside of the chart.`);
    }
    this.card.note.textContent = notes.join(" ");
  }

  // ---- Drawing ----

  model() {
    const { lines, front, shown, chart, time } = this;
    return { lines, front, shown, limit: chart.limit, errorTitle: `${this.norm === "max" ? "largest" : "L2"} ${chart.error}`, timeTitle: `${time} (s)` };
  }

  standalone() {
    const words = { title: `${this.chart.title}: error against time`, subtitle: SIDES, caption: this.page.caption };
    return drawPlot(this.model(), LIGHT, 920 + Math.ceil(most(this.methods.map((method) => widthOf(method.name)))), words).svg;
  }

  draw(width) {
    const ground = theme(), { plot, chart } = this;
    this.band.style.background = ground.front;
    for (const { method, key } of this.keys) key.replaceChildren(keyLine(method, -17, 0, ground), marker(method, 0, 0, ground));
    if (!this.lines.length) {
      this.drawn = null;
      const norm = this.norm === "max" ? "max" : "L2";
      plot.replaceChildren(html("p", { class: "empty", text: `No run has a positive, finite error and time in the ${norm} norm. The table lists all runs.` }));
      return;
    }
    const drawn = this.drawn = drawPlot(this.model(), ground, Math.max(width, 260), null);
    const methods = `${this.shown.length} method${this.shown.length === 1 ? "" : "s"}`;
    drawn.svg.setAttribute("role", "group");
    drawn.svg.setAttribute("aria-label", `${chart.title}: ${this.model().errorTitle} against ${this.time}, ${methods}. Arrow keys move between points.`);
    drawn.cursor = svgElement("g", { class: "cursor" });
    drawn.svg.append(drawn.cursor);
    drawn.places.forEach((place, n) => this.makeFocusable(place, n === 0));
    plot.replaceChildren(drawn.svg);
    this.writeNote();
  }

  makeFocusable(place, isFirst) {
    const { element } = place;
    element.setAttribute("role", "img");
    element.setAttribute("tabindex", isFirst ? "0" : "-1");
    element.setAttribute("aria-label", [place.line.method.name, ...this.tipRows(place).map((row) => row.join(" "))].join(", "));
    element.addEventListener("focus", () => { if (element.matches(":focus-visible")) this.showPoint(place); });
    element.addEventListener("blur", this.leave);
  }

  // ---- Legend ----

  buildLegend() {
    const { chart, page, methods } = this;
    this.keys = methods.map((method) => this.buildKey(method));
    this.band = html("i", { class: "band" });
    this.bandEntry = html("li", { class: "still" }, this.band, html("span", { text: "Pareto front of all methods" }));
    this.limitEntry = html("li", { class: "still" }, html("i", { class: "dashes" }), html("span", { text: chart.limit?.label ?? "" }));
    const all = (text, isHidden) => {
      const click = () => page.setAll("hidden", methods.filter((method) => this.fits(method)).map((method) => this.key(method)), isHidden);
      return html("button", { type: "button", text, on: { click } });
    };
    const both = methods.length > 2 ? [html("li", { class: "all" }, all("Show all", false), all("Hide all", true))] : [];
    const entries = [...this.keys.map((key) => key.entry), this.bandEntry, this.limitEntry, ...both];
    return html("ul", { class: "legend", "aria-label": `Methods of ${chart.title}` }, ...entries);
  }

  buildKey(method) {
    const key = svgElement("svg", { width: 34, height: 18, viewBox: "-17 -9 34 18", "aria-hidden": "true" });
    const value = html("span", { class: "value" }), badge = method.isDefault ? [" ", html("small", { text: "default" })] : [];
    const [light, dark] = [() => this.light(method.n), () => this.light(null)];
    const on = { click: () => this.page.toggle("hidden", this.key(method)), pointerenter: light, pointerleave: dark, focus: light, blur: dark };
    const button = html("button", { type: "button", "aria-pressed": "true", on }, key, html("span", {}, method.name, ...badge), value);
    return { method, key, value, button, entry: html("li", {}, button) };
  }

  // Highlights the line of a method; null for none.
  light(n) {
    this.drawn?.svg.classList.toggle("dimmed", this.drawn.groups.has(n));
    this.drawn?.groups.forEach((group, other) => group.classList.toggle("lit", other === n));
    this.keys.forEach((key) => key.button.classList.toggle("lit", key.method.n === n));
  }

  // ---- Pointer and keyboard ----

  // Vertical line at an error, and the time of each method there in the legend.
  showError(error) {
    active.set(this.plot, this.leave);
    const { frame, cursor, placeError } = this.drawn, at = placeError(error), best = fastestAt(this.lines, error), ground = theme();
    const x = Math.max(frame.left + 20, Math.min(at, frame.left + frame.width - 20));
    cursor.replaceChildren(
      segment(at, frame.top, at, frame.top + frame.height, { stroke: ground.ink, "stroke-dasharray": "3 3" }),
      label(numberText(error), x, frame.top + 12, ground, { align: "middle", halo: true }),
    );
    for (const { method, value } of this.keys) {
      const line = this.lines.find((line) => line.method === method), secs = line ? secsAt(line, error) : null;
      value.textContent = secs === null ? "–" : `${secsText(secs)} · ${timesText(secs / best.secs)}`;
    }
  }

  showPoint(place) {
    const { svg, cursor, frame } = this.drawn;
    this.showError(place.point.error);
    cursor.append(svgElement("circle", { cx: place.x, cy: place.y, r: 12, fill: "none", stroke: theme().ink, "stroke-width": 2 }));
    this.light(place.line.method.n);
    const corner = svg.getBoundingClientRect(), isLeft = place.x > frame.left + frame.width / 2;
    tip.show(place.line.method.name, this.tipRows(place), corner.left + place.x, corner.top + place.y, isLeft);
  }

  tipRows({ point, line }) {
    const { row } = point, best = fastestAt(this.lines, point.error);
    const fastest = point.secs <= best.secs ? "this run" : best.line === line ? "this method, between two runs" : best.line.method.name;
    const rows = [
      ["cells", row.cells.length ? cellsText(row.cells) : ""],
      ["time step", isPositive(row.dt_secs) ? secsText(row.dt_secs) : ""],
      ["L2 error", numberText(row.l2)],
      ["max error", numberText(row.max)],
      ["wall time", secsText(row.wall_secs) + (this.chart.per && ` per ${this.chart.per}`)],
      ["simulated", isPositive(row.simulated_secs) ? secsText(row.simulated_secs) : ""],
      ["fastest at this error", fastest],
      ["time / fastest", timesText(point.secs / best.secs)],
      ["on the Pareto front", this.front.includes(point) ? "yes" : "no"],
    ];
    return rows.filter((row) => row[1]);
  }

  leave() {
    tip.hide();
    this.light(null);
    this.drawn?.cursor.replaceChildren();
    this.keys.forEach((key) => { key.value.textContent = ""; });
  }

  point(event) {
    if (!this.drawn) return;
    const { svg, frame, places, errorAt } = this.drawn, corner = svg.getBoundingClientRect();
    const [x, y] = [event.clientX - corner.left, event.clientY - corner.top];
    const apart = (place) => Math.hypot(place.x - x, place.y - y);
    const near = places.reduce((a, b) => a && apart(a) <= apart(b) ? a : b, null);
    if (near && apart(near) < (event.pointerType === "touch" ? 36 : 20)) return this.showPoint(near);
    this.leave();
    if (x > frame.left && x < frame.left + frame.width && y > frame.top && y < frame.top + frame.height) this.showError(errorAt(x));
  }

  // Left and right go along the line of the focused point, up and down to the nearest error of the next method.
  press(event) {
    if (event.key === "Escape") return this.leave();
    const places = this.drawn?.places ?? [], now = places.find((place) => place.element === document.activeElement);
    const next = now && this.neighbour(places, now, event.key);
    if (!next) return;
    event.preventDefault();
    now.element.setAttribute("tabindex", "-1");
    next.element.setAttribute("tabindex", "0");
    next.element.focus();
  }

  neighbour(places, now, key) {
    const along = { ArrowLeft: -1, ArrowRight: 1 }[key], across = { ArrowUp: -1, ArrowDown: 1 }[key];
    if (along) {
      const own = places.filter((place) => place.line === now.line), rightwards = own[0].x <= own.at(-1).x ? 1 : -1;
      return own[own.indexOf(now) + along * rightwards] ?? now;
    }
    if (across) {
      const line = this.shown[(this.shown.indexOf(now.line) + across + this.shown.length) % this.shown.length];
      const apart = (place) => Math.abs(Math.log(place.point.error / now.point.error));
      return places.filter((place) => place.line === line).reduce((a, b) => apart(a) <= apart(b) ? a : b);
    }
    return { Home: places[0], End: places.at(-1) }[key];
  }

  // ---- Table ----

  table() {
    const shown = new Set(this.methods.filter((method) => this.fits(method) && this.isShown(method)).map((method) => method.name));
    const header = ["method", "cells", "time step", "L2 error", "max error", this.time, "simulated", "× the fastest at this error", "state"];
    const rows = this.chart.rows.filter((row) => shown.has(row.method)).map((row) => {
      const failure = failureOf(row, this.norm), best = failure ? null : fastestAt(this.lines, row[this.norm]);
      const state = failure || (this.front.some((point) => point.row === row) ? "on the front" : "");
      const secs = [row.wall_secs, row.simulated_secs].map(secsText), errors = [row.l2, row.max].map((error) => numberText(error));
      const ratio = best ? timesText(row.wall_secs / best.secs) : "–";
      return [row.method, cellsText(row.cells), isPositive(row.dt_secs) ? secsText(row.dt_secs) : "–", ...errors, ...secs, ratio, state];
    });
    return table(`Runs of ${this.chart.title}`, header, rows);
  }
}

const chartCard = (chart, page) => new ChartCard(chart, page).card;
