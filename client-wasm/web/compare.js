// Side-by-side comparison of two variants of the picture, with a border that is moved by dragging or by keys.

import { byId } from "./elements.js";

const KEYS = { ArrowLeft: -0.02, ArrowDown: -0.02, ArrowRight: 0.02, ArrowUp: 0.02, PageDown: -0.1, PageUp: 0.1, Home: -1, End: 1 };

export class Comparison {
  // `variants` are the names to choose from; `label(name)` is the displayed name; `keep({ compare, at })` stores the comparison in the address.
  constructor(client, { variants, label, keep }) {
    this.client = client;
    this.label = label;
    this.keep = keep;
    this.known = variants;
    this.variants = ["clumps", "shells"];
    this.at = 0.5;
    this.shown = false;
    this.listen();
    this.apply();
  }

  // Restores a comparison from the address, such as "clumps,shells" and "0.5"; ignores unknown names.
  restore(compare, at) {
    const variants = compare?.split(",") ?? [];
    if (variants.length !== 2 || !variants.every((name) => this.known.includes(name))) return;
    const border = at === null || at === "" ? NaN : Number(at);
    if (border >= 0 && border <= 1) this.at = border;
    this.show(variants);
  }

  show(variants) {
    this.variants = variants;
    this.shown = true;
    this.apply();
    this.remember();
  }

  hide() {
    this.shown = false;
    this.apply();
    this.remember();
  }

  // Updates page and client.
  apply() {
    const [left, right] = this.shown ? this.variants : ["", ""];
    this.client.compare(left, right, this.at);
    const border = byId("border");
    border.hidden = !this.shown;
    border.style.left = `${this.at * 100}%`;
    border.setAttribute("aria-valuenow", Math.round(this.at * 100));
    border.setAttribute("aria-valuetext", `${Math.round(this.at * 100)} % ${this.label(this.variants[0])}, then ${this.label(this.variants[1])}`);
    byId("left-name").textContent = this.label(this.variants[0]);
    byId("right-name").textContent = this.label(this.variants[1]);
    byId("comparing").setAttribute("aria-pressed", String(this.shown));
    for (const [index, id] of ["left", "right"].entries()) byId(id).value = this.variants[index];
  }

  remember() {
    this.keep(this.shown ? { compare: this.variants.join(","), at: String(Number(this.at.toFixed(3))) } : { compare: null, at: null });
  }

  move(at) {
    this.at = Math.min(Math.max(at, 0), 1);
    this.apply();
  }

  listen() {
    byId("comparing").addEventListener("click", () => (this.shown ? this.hide() : this.show(this.variants)));
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
