// Cards: a chart, map, figure or table of limits with its title, buttons, table view, tooltips and keyboard control.
// Texts of the data enter the page as text nodes and attributes only.

// HTML element; `props` are attributes, except `text`, `on` (event handlers) and attributes that are false or null, which are left out.
function html(tag, props = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(props)) {
    if (name === "text") element.textContent = value;
    else if (name === "on") Object.entries(value).forEach(([event, act]) => element.addEventListener(event, act));
    else if (value !== false && value !== null && value !== undefined) element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children);
  return element;
}

const theme = () => matchMedia("(prefers-color-scheme: dark)").matches ? DARK : LIGHT;
const fileName = (card, end) => [card.field, card.name || card.title].join("-").toLowerCase().replace(/[^\p{L}\p{N}]+/gu, "-").replace(/^-|-$/g, "") + end;

function download(name, type, text) {
  const link = html("a", { href: URL.createObjectURL(new Blob([text], { type })), download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

const saveSvg = (card, svg) => download(fileName(card, ".svg"), "image/svg+xml", typeof svg === "string" ? svg : new XMLSerializer().serializeToString(svg));

// The one tooltip of the page.
const tip = {
  element: document.getElementById("tip"),
  // Shows name and value of each row beside a place in the window, on the left if `isLeft` and there is room.
  show(title, rows, x, y, isLeft) {
    const terms = rows.filter((row) => row[1]).flatMap(([name, value]) => [html("dt", { text: name }), html("dd", { text: value })]);
    this.element.replaceChildren(html("strong", { text: title }), html("dl", {}, ...terms));
    this.element.hidden = false;
    const { offsetWidth: width, offsetHeight: height } = this.element, view = document.documentElement;
    const isNarrow = view.clientWidth < 560, isHigh = y + 24 < view.clientHeight - height;
    this.element.classList.toggle("docked", isNarrow);
    if (isNarrow) { // At the bottom of the window, or at its top if the place is down there.
      Object.assign(this.element.style, { left: "", top: isHigh ? "auto" : "8px", bottom: isHigh ? "8px" : "auto" });
      return;
    }
    this.element.style.bottom = "";
    const hasRoom = [x + 16 + width < view.clientWidth - 8, x - 16 - width > 8];
    const left = hasRoom[0] && !(isLeft && hasRoom[1]) ? x + 16 : x - 16 - width;
    const below = y + 16 + height < view.clientHeight - 8;
    this.element.style.left = `${Math.max(8, Math.min(left, view.clientWidth - width - 8)) + scrollX}px`;
    this.element.style.top = `${Math.max(8, below ? y + 16 : y - 16 - height) + scrollY}px`;
  },
  hide() { this.element.hidden = true; },
};

// The drawing that shows a tooltip or cursor, and the function that removes them.
const active = {
  plot: null,
  leave: null,
  set(plot, leave) {
    if (this.plot !== plot) this.leave?.();
    Object.assign(this, { plot, leave });
  },
};
document.addEventListener("pointerdown", (event) => { if (!active.plot?.contains(event.target)) active.leave?.(); });

const live = (text) => { document.getElementById("live").textContent = text; };

// Table with a header line; cells that start with a number are aligned right.
function table(caption, header, rows) {
  const most = 1000, isNumeric = (value) => /^[−-]?[\d–]/.test(value);
  const look = (value, n) => n && isNumeric(value) ? "number" : /^failed/.test(value) ? "failed" : null;
  const cell = (value, n) => html(n ? "td" : "th", { text: value, scope: n ? null : "row", class: look(value, n) });
  const line = (row) => html("tr", {}, ...row.map(cell));
  const body = html("tbody", {}, ...rows.slice(0, most).map(line));
  const heading = (name, n) => html("th", { text: name, scope: "col", class: look(rows[0]?.[n] ?? "", n) });
  const head = html("thead", {}, html("tr", {}, ...header.map(heading)));
  const note = rows.length > most ? [html("p", { class: "note", text: `The first ${most} of ${rows.length} rows; the CSV has all.` })] : [];
  const built = html("table", {}, html("caption", { class: "unseen", text: caption }), head, body);
  return html("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": caption }, built, ...note);
}

// Card with title and buttons. `parts` has `subtitle`, `csv()`, `svg()` (each may be missing), `view` (the drawing) and `table()`.
function card(item, parts, page) {
  const toggle = html("button", { type: "button", "aria-pressed": "false", text: "Table", on: { click: () => page.toggle("tables", item.key) } });
  const button = (text, click) => {
    const name = `Download ${text} of ${item.title}`;
    return html("button", { type: "button", class: text.toLowerCase(), text, title: name, "aria-label": name, on: { click } });
  };
  const tools = html("div", { class: "tools" });
  if (parts.table) tools.append(toggle);
  if (parts.csv) tools.append(button("CSV", () => download(fileName(item, ".csv"), "text/csv", parts.csv())));
  if (parts.svg) tools.append(button("SVG", () => saveSvg(item, parts.svg())));
  toggle.setAttribute("aria-label", `Table of ${item.title}`);
  const heading = html("h3", { text: item.title || "Untitled", id: `title-${item.n}` });
  const asTable = html("div", { hidden: true }), note = html("p", { class: "note faint" });
  const subtitle = parts.subtitle ? [html("p", { class: "faint sub", text: parts.subtitle })] : [];
  const head = html("div", { class: "head" }, html("div", {}, heading, ...subtitle), tools);
  const element = html("article", { class: "card", "aria-labelledby": `title-${item.n}` }, head, parts.view, asTable, note);
  // Shows the drawing or the table of the present state. Each card has its own `update`, which returns false if the filters leave nothing to show.
  const self = { item, element, note, update() {} };
  self.refresh = (isTable) => {
    toggle.setAttribute("aria-pressed", String(isTable));
    parts.view.hidden = Boolean(parts.table) && isTable;
    asTable.hidden = !parts.view.hidden;
    const isEmpty = self.update() === false;
    asTable.replaceChildren(...parts.view.hidden ? [parts.table()].flat() : []);
    return !isEmpty;
  };
  return self;
}

// Draws again when the width of an element changes.
function onWidth(element, draw) {
  let width = 0;
  new ResizeObserver(() => {
    if (element.clientWidth > 0 && Math.abs(element.clientWidth - width) > 1) draw(width = element.clientWidth);
  }).observe(element);
}
