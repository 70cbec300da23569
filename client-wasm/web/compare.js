// Two ways of drawing side by side, and the border between them, which is dragged or moved by keys.

const KEYS = { ArrowLeft: -0.02, ArrowDown: -0.02, ArrowRight: 0.02, ArrowUp: 0.02, PageDown: -0.1, PageUp: 0.1, Home: -1, End: 1 };

const byId = (id) => document.getElementById(id);

export class Comparison {
  // `label(way)` is a way's name for people; `keep({ compare, at })` keeps what is chosen in the address.
  constructor(client, { ways, label, keep }) {
    this.client = client;
    this.label = label;
    this.keep = keep;
    this.known = ways;
    this.ways = ["clumps", "shells"];
    this.at = 0.5;
    this.shown = false;
    this.listen();
    this.apply();
  }

  // Shows what an address says, such as "clumps,shells" and "0.5"; nothing when it names no two ways.
  restore(ways, at) {
    const asked = ways?.split(",") ?? [];
    if (asked.length !== 2 || !asked.every((way) => this.known.includes(way))) return;
    const share = at === null || at === "" ? NaN : Number(at);
    if (share >= 0 && share <= 1) this.at = share;
    this.show(asked);
  }

  show(ways) {
    this.ways = ways;
    this.shown = true;
    this.apply();
    this.remember();
  }

  hide() {
    this.shown = false;
    this.apply();
    this.remember();
  }

  // Brings page and client to what is chosen.
  apply() {
    const [left, right] = this.shown ? this.ways : ["", ""];
    this.client.compare(left, right, this.at);
    const border = byId("border");
    border.hidden = !this.shown;
    border.style.left = `${this.at * 100}%`;
    border.setAttribute("aria-valuenow", Math.round(this.at * 100));
    border.setAttribute("aria-valuetext", `${Math.round(this.at * 100)} % ${this.label(this.ways[0])}, then ${this.label(this.ways[1])}`);
    byId("left-name").textContent = this.label(this.ways[0]);
    byId("right-name").textContent = this.label(this.ways[1]);
    byId("comparing").setAttribute("aria-pressed", String(this.shown));
    for (const [id, way] of [["left", this.ways[0]], ["right", this.ways[1]]]) byId(id).value = way;
  }

  remember() {
    this.keep(this.shown ? { compare: this.ways.join(","), at: String(Number(this.at.toFixed(3))) } : { compare: null, at: null });
  }

  move(at) {
    this.at = Math.min(Math.max(at, 0), 1);
    this.apply();
  }

  listen() {
    byId("comparing").addEventListener("click", () => (this.shown ? this.hide() : this.show(this.ways)));
    for (const id of ["left", "right"]) {
      byId(id).addEventListener("change", () => this.show([byId("left").value, byId("right").value]));
    }
    const border = byId("border");
    border.addEventListener("pointerdown", (event) => {
      border.setPointerCapture(event.pointerId);
      border.focus();
      event.preventDefault();
    });
    border.addEventListener("pointermove", (event) => {
      if (!border.hasPointerCapture(event.pointerId)) return;
      const { left, width } = border.parentElement.getBoundingClientRect();
      this.move((event.clientX - left) / width);
    });
    for (const end of ["pointerup", "pointercancel"]) border.addEventListener(end, () => this.remember());
    border.addEventListener("keydown", (event) => {
      if (!(event.key in KEYS) || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      this.move(this.at + KEYS[event.key]);
    });
    border.addEventListener("keyup", (event) => event.key in KEYS && this.remember());
  }
}
