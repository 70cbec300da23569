// The page: filters, their state in the address, and the sections of cards.
//
// The page is one file. The program that writes it puts charts.css in place of STYLE, the scripts in place of SCRIPT in this order:
// charts-data, charts-draw, charts-cards, charts-precision, charts-maps, charts; and last the data in place of DATA, as JSON with every
// < written as \u003c, so that no text of the data can end the element. Format of the data:
//
//   { date: "2026-11-30", about: "machine and versions", is_quick, command,
//     charts: [{ field, problem, error: "quantity (unit)",
//       per: "simulated second" (what one wall_secs is for; may be empty),
//       default: null or a method, or what comes before the last ", " of several,
//       limit: null or { label, points: [[error, secs], ...] } (one point: a horizontal line),
//       rows: [{ method, cells: [x, y, z], dt_secs, l2, max, simulated_secs, wall_secs }, ...] (of a method from coarse to fine) }],
//     maps: [{ field, title, x: { name, values: [middle of each column], logarithmic }, y: { the same for the rows },
//       classes: [{ name, colour: "#rrggbb" }],
//       panels: [{ name, cells: [[class of each y] of each x], theory: [[x, y], ...], measured: [[x, y], ...] }] }],
//     figures: [{ field, name (of the file), title, svg, csv, summary }],
//     limits: [{ field (may be missing), scheme, number, theory, measured }] }
//
// Whatever is missing counts as empty. An error or time that is missing, null, 0 or negative counts as failed.

const FIELDS = ["wind", "bend", "blades", "underbrush", "force-field", "stream", "picture", "shells", "scene"];
const byId = (id) => document.getElementById(id);
const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1).replace("-", " ");

const page = {
  caption: "",
  cards: [],
  // `fields`: shown fields, all if empty; `hidden`: "chart/method"; `tables`: cards shown as tables.
  state: { fields: new Set(), text: "", norm: "l2", front: false, hidden: new Set(), tables: new Set() },

  // Whether a card, or a method of it, passes the field and text filters. Every word must occur in field, title or method.
  matches(item, method) {
    const { fields, text } = this.state;
    if (fields.size && !fields.has(item.field)) return false;
    const words = text.toLowerCase().split(/\s+/).filter(Boolean), own = `${item.field} ${item.title}`.toLowerCase();
    const fits = (more) => words.every((word) => own.includes(word) || more.toLowerCase().includes(word));
    if (fits("")) return true;
    if (method !== undefined) return fits(method);
    const methods = [...(item.rows ?? []).map((row) => row.method ?? `${row.scheme} ${row.number}`), ...(item.panels ?? []).map((panel) => panel.name)];
    return methods.some(fits);
  },

  toggle(name, key) { this.setAll(name, [key], !this.state[name].has(key)); },

  setAll(name, keys, isIn) {
    keys.forEach((key) => isIn ? this.state[name].add(key) : this.state[name].delete(key));
    this.update(keys.length === 1 ? keys[0] : null);
  },

  // Shows the state: controls, cards, address. With the key of one card or method, only that card is drawn again.
  update(key = null) {
    writeControls(this.state);
    writeAddress(this.state);
    // Visibility first: a drawing needs the width of its place.
    this.cards.forEach((shown) => { shown.element.hidden = !this.matches(shown.item); });
    hideEmptySections();
    for (const shown of this.cards.filter((shown) => !shown.element.hidden)) {
      if (key !== null && key !== shown.item.key && !key.startsWith(`${shown.item.key}/`)) continue;
      shown.element.hidden = !shown.refresh(this.state.tables.has(shown.item.key));
    }
    hideEmptySections();
    const count = this.cards.filter((shown) => !shown.element.hidden).length;
    byId("count").textContent = this.cards.length ? `${count} of ${this.cards.length} shown` : "";
    byId("nothing")?.toggleAttribute("hidden", count > 0);
  },
};

function hideEmptySections() {
  for (const section of document.querySelectorAll("main > section")) section.hidden = !section.querySelector(".card:not([hidden])");
}

// ---- State in the address ----

function writeAddress({ fields, text, norm, front, hidden, tables }) {
  const words = new URLSearchParams();
  fields.forEach((field) => words.append("field", field));
  if (text) words.set("text", text);
  if (norm !== "l2") words.set("norm", norm);
  if (front) words.set("front", "1");
  hidden.forEach((key) => words.append("hide", key));
  tables.forEach((key) => words.append("table", key));
  const hash = String(words) ? `#${words}` : "";
  // Some browsers reject frequent changes; the next change includes this one.
  if (hash !== location.hash) try { history.replaceState(null, "", hash || location.pathname + location.search) } catch { /* included in the next change */ }
}

function readAddress() {
  const words = new URLSearchParams(location.hash.slice(1)), known = new Set(page.cards.map((shown) => shown.item.field));
  Object.assign(page.state, {
    fields: new Set(words.getAll("field").filter((field) => known.has(field))), text: words.get("text") ?? "", norm: words.get("norm") === "max" ? "max" : "l2",
    front: words.get("front") === "1", hidden: new Set(words.getAll("hide")), tables: new Set(words.getAll("table")),
  });
}

// ---- Controls ----

function writeControls({ fields, text, norm, front }) {
  byId("fields").querySelectorAll("button").forEach((chip) => chip.setAttribute("aria-pressed", String(chip.value ? fields.has(chip.value) : !fields.size)));
  if (byId("text").value !== text) byId("text").value = text;
  document.querySelectorAll("input[name=norm]").forEach((radio) => { radio.checked = radio.value === norm; });
  byId("front").checked = front;
}

function connectControls(fields) {
  const { state } = page;
  const chip = (value, text, count) => html("button", {
    type: "button", value, on: {
      click: () => {
        if (!value) state.fields.clear();
        else if (!state.fields.delete(value)) state.fields.add(value);
        page.update();
      },
    },
  }, text, html("small", { text: ` ${count}` }));
  const count = (field) => page.cards.filter((shown) => shown.item.field === field).length;
  byId("fields").append(chip("", "All", page.cards.length), ...fields.map((field) => chip(field, capital(field), count(field))));
  let typing = 0;
  byId("text").addEventListener("input", (event) => {
    state.text = event.target.value;
    clearTimeout(typing);
    typing = setTimeout(() => page.update(), 120);
  });
  document.querySelectorAll("input[name=norm]").forEach((radio) => radio.addEventListener("change", () => { state.norm = radio.value; page.update(); }));
  byId("front").addEventListener("change", (event) => { state.front = event.target.checked; page.update(); });
  byId("filters").addEventListener("submit", (event) => event.preventDefault());
  byId("filters").addEventListener("reset", (event) => { event.preventDefault(); reset(); });
  byId("skip").addEventListener("click", (event) => { event.preventDefault(); byId("charts-list").focus(); });
  addEventListener("hashchange", () => { readAddress(); page.update(); });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => page.update());
}

function reset() {
  Object.assign(page.state, { text: "", norm: "l2", front: false });
  ["fields", "hidden", "tables"].forEach((name) => page.state[name].clear());
  page.update();
}

// ---- Page ----

// Items with a key that is the same in the next page of the same problems: field/title, numbered where it occurs twice.
function keyed(items) {
  const seen = new Map();
  items.forEach((item, n) => {
    const key = `${item.field}/${item.title}`, count = (seen.get(key) ?? 0) + 1;
    seen.set(key, count);
    Object.assign(item, { n, key: count > 1 ? `${key} (${count})` : key });
  });
  return items;
}

function dateText(date) {
  const day = /^\d{4}-\d{2}-\d{2}$/.test(date) ? new Date(`${date}T12:00:00Z`) : null;
  return day && !isNaN(day) ? day.toLocaleDateString("en-GB", { day: "numeric", month: "long", year: "numeric", timeZone: "UTC" }) : date;
}

function sentence(...lines) { byId("charts-list").append(html("div", { class: "card empty" }, ...lines)); }

function start() {
  const data = readData(byId("charts").textContent);
  const command = html("code", { text: "prairie chart --out DIR" });
  if (!data) {
    ["filters", "reading"].forEach((id) => { byId(id).hidden = true; });
    return sentence(html("p", {}, "The data of this page cannot be read. Make it again with ", command, "."));
  }
  const limits = [...new Set(data.limits.map((row) => row.field))].map((field) => ({
    kind: "limits", field, title: "Stability limits, theory and measured", rows: data.limits.filter((row) => row.field === field),
  }));
  const items = keyed([...data.charts, ...data.maps, ...limits, ...data.figures]);
  byId("about").textContent = [dateText(data.date), data.about, data.command && `made with: ${data.command}`].filter(Boolean).join(" · ");
  byId("quick").hidden = !data.isQuick;
  if (!items.length) {
    ["filters", "reading"].forEach((id) => { byId(id).hidden = true; });
    return sentence(html("h2", { text: "No charts yet" }), html("p", {}, "Measure the methods and write this page with ", command, "."));
  }
  page.caption = [data.date, data.about, data.isQuick ? "quick run" : ""].filter(Boolean).join(" · ");
  const make = { chart: chartCard, map: mapCard, limits: limitsCard, figure: figureCard };
  page.cards = items.map((item) => make[item.kind](item, page));
  const order = (field) => (FIELDS.indexOf(field) + FIELDS.length + 1) % (FIELDS.length + 1);
  const fields = [...new Set(items.map((item) => item.field))].sort((a, b) => order(a) - order(b));
  const section = (field, n) => {
    const cards = page.cards.filter((shown) => shown.item.field === field).map((shown) => shown.element);
    return html("section", { "aria-labelledby": `field-${n}` }, html("h2", { id: `field-${n}`, text: capital(field) }), ...cards);
  };
  byId("charts-list").append(...fields.map(section));
  const again = html("button", { type: "button", text: "Reset the filters", on: { click: reset } });
  byId("charts-list").append(html("p", { id: "nothing", class: "card empty", hidden: true }, "No chart matches these filters. ", again));
  connectControls(fields);
  readAddress();
  page.update();
}

start();
