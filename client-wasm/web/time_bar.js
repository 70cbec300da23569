// The time bar: looks back at the last minutes, which the client records, while the others drive on.

import { byId } from "./elements.js";

const UPDATE_MS = 250;
// Time recorded before the bar appears (s).
const SHORTEST_SECS = 5;
const KEY_STEPS = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -10, PageUp: 10 };

export class TimeBar {
  // `client` is the started client; `isWanted` is false where the page shows no controls.
  constructor(client, isWanted) {
    Object.assign(this, { client, isWanted, isDragged: false });
    this.listen();
    setInterval(() => this.update(), UPDATE_MS);
  }

  state() {
    return JSON.parse(this.client.state());
  }

  // Goes on or back by some seconds.
  step(secs) {
    const { behind_secs: behind, recorded_secs: recorded } = this.state();
    this.lookBack(Math.min(behind - secs, recorded));
  }

  // Shows the world of some seconds ago; 0 or less is the present.
  lookBack(secs) {
    this.client.look_back(secs);
    this.update();
  }

  live() {
    this.client.live();
    this.update();
  }

  // Stops time, or lets it go on.
  toggle() {
    this.client.run_past(!this.state().is_playing);
    this.update();
  }

  listen() {
    const slider = byId("moment");
    slider.addEventListener("input", () => {
      this.isDragged = true;
      this.lookBack(-Number(slider.value));
    });
    slider.addEventListener("change", () => { this.isDragged = false });
    slider.addEventListener("keydown", (event) => {
      if (!(event.key in KEY_STEPS) || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      this.step(KEY_STEPS[event.key]);
    });
    byId("run").addEventListener("click", () => this.toggle());
    byId("live").addEventListener("click", () => this.live());
    // After pointer input the keys drive again; keyboard users stay in the bar.
    byId("time-bar").addEventListener("click", ({ detail }) => detail > 0 && byId("view").focus());
    // A message that covers the page leaves it inert.
    addEventListener("keydown", (event) => byId("prairie").inert || this.key(event));
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.closest?.("input:not(#moment), select, dialog")) return;
    const once = event.repeat ? "" : event.key.toLowerCase();
    if (event.key === ",") this.step(-1);
    else if (event.key === ".") this.step(1);
    else if (once === "t") this.toggle();
    else if (once === "r") this.live();
    else return;
    event.preventDefault();
  }

  update() {
    const state = this.state();
    if (!state) return;
    const bar = byId("time-bar");
    const isShown = this.isWanted && (state.recorded_secs >= SHORTEST_SECS || !state.is_live);
    if (!isShown && bar.contains(document.activeElement)) byId("view").focus();
    bar.hidden = !isShown;
    if (isShown) this.show(state);
  }

  show({ is_live: isLive, is_playing: isPlaying, recorded_secs: recorded, behind_secs: behind }) {
    const slider = byId("moment");
    const text = isLive ? "now" : `${Math.round(behind)} s ago`;
    if (!this.isDragged) {
      slider.min = -Math.floor(Math.max(recorded, behind));
      slider.value = -behind;
    }
    if (slider.getAttribute("aria-valuetext") !== text) slider.setAttribute("aria-valuetext", text);
    write("ago", text);
    write("run", isPlaying ? "❚❚" : "▶\uFE0E");
    const action = isPlaying ? "Stop time" : "Let time go on";
    if (byId("run").getAttribute("aria-label") !== action) byId("run").setAttribute("aria-label", action);
    byId("run").title = `${action} (T)`;
    byId("live").setAttribute("aria-pressed", String(isLive));
  }
}

function write(id, text) {
  const node = byId(id);
  if (node.textContent !== text) node.textContent = text;
}
