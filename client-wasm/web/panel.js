// The panel: what the visitor chooses, who is here, and how fast things go. It reads the client's own state a few times a second.

import { ask, keep, link } from "./address.js";

const byId = (id) => document.getElementById(id);
const UPDATE_MS = 250;
const HINT_MS = 14_000;
const TOLD_MS = 5_000;

const LABELS = {
  land: "Land alone", clumps: "Clumps", shells: "Shells",
  cut: "Cut out", coverage: "Coverage", sorted: "Sorted", precomputed: "Eight orders", weighted: "Weighted",
  unculled: "Nothing culled",
  low: "Low detail", medium: "Medium detail", high: "High detail", ultra: "Ultra detail",
};

// A way's name for people.
export const label = (way) => LABELS[way] ?? way;

export class Panel {
  // `client` is the started client; `remember(key, value)` keeps a choice for the next visit; `capture` takes pictures and films.
  constructor(client, { name, quality }, { remember, capture }) {
    this.client = client;
    this.remember = remember;
    this.capture = capture;
    this.told = { text: "", until: 0 };
    byId("name").value = name;
    byId("quality").value = quality;
    const { order, far, compared } = JSON.parse(client.ways());
    for (const [id, ways] of [["order", order], ["far", far], ["left", compared], ["right", compared]]) {
      byId(id).append(...ways.map((way) => new Option(label(way), way)));
    }
    if (ask("hour")) {
      byId("hour").value = ask("hour");
      this.clock(Number(ask("hour")));
    }
    byId("ways").open = ["order", "far", "compare"].some((key) => ask(key) !== null);
    this.listen();
    setInterval(() => this.update(JSON.parse(client.state())), UPDATE_MS);
  }

  // Shows or hides the panel; hidden, a small button brings it back.
  show(shown) {
    byId("panel").hidden = !shown;
    byId("open").hidden = shown;
  }

  // Says once how to begin, until the visitor does.
  hint() {
    const touch = matchMedia("(pointer: coarse)").matches;
    const hint = byId("hint");
    hint.innerHTML = touch
      ? "Left thumb walks, right thumb looks. The menu has a car."
      : "Drag to look, <kbd>W</kbd> <kbd>A</kbd> <kbd>S</kbd> <kbd>D</kbd> to walk, <kbd>C</kbd> for a car, <kbd>?</kbd> for all keys.";
    hint.hidden = false;
    const gone = () => { hint.hidden = true };
    setTimeout(gone, HINT_MS);
    for (const kind of ["keydown", "pointerdown"]) addEventListener(kind, () => setTimeout(gone, 1500), { once: true });
  }

  // Says a line for a while.
  tell(text) {
    this.told = { text, until: performance.now() + TOLD_MS };
    this.update(JSON.parse(this.client.state()));
  }

  // Shows how long a film has run (s), or that there is none: null.
  filming(seconds) {
    const runs = seconds !== null;
    byId("film").setAttribute("aria-pressed", String(runs));
    write("film-label", runs ? `● ${Math.floor(seconds)} s` : "Film");
  }

  async share() {
    const address = link(JSON.parse(this.client.state()).view);
    try {
      await navigator.clipboard.writeText(address);
      this.tell("Link copied.");
    } catch {
      this.tell(`The browser lets no page copy; this is the link: ${address}`);
    }
  }

  // Says which hour the sun stands at; null where the scene has it.
  clock(hour) {
    const text = () => `${Math.floor(hour)}:${String(Math.round((hour % 1) * 60)).padStart(2, "0")}`;
    byId("clock").textContent = hour === null ? "the scene’s" : text();
    byId("scene-hour").disabled = hour === null;
  }

  toggle(shown = byId("panel").hidden) {
    this.show(shown);
    this.remember("panel", shown ? "1" : "0");
  }

  help() {
    const help = byId("help");
    if (help.open) help.close();
    else help.showModal();
  }

  listen() {
    byId("open").addEventListener("click", () => this.toggle(true));
    byId("close").addEventListener("click", () => this.toggle(false));
    byId("ask").addEventListener("click", () => this.help());
    byId("help").addEventListener("click", (event) => event.target === event.currentTarget && event.currentTarget.close());
    byId("vehicles").addEventListener("click", (event) => this.pressed(event, "vehicle", (name) => this.client.choose(name)));
    byId("heights").addEventListener("click", (event) => this.pressed(event, "height", (metres) => this.client.set_height(Number(metres))));
    byId("quality").addEventListener("change", ({ target }) => {
      this.client.set_quality(target.value);
      this.remember("quality", target.value);
      keep({ quality: target.value });
    });
    for (const id of ["order", "far"]) {
      byId(id).addEventListener("change", ({ target }) => {
        this.client.set_look(byId("order").value, byId("far").value);
        keep({ [id]: target.value });
      });
    }
    byId("hour").addEventListener("input", ({ target }) => {
      this.client.set_hour(Number(target.value));
      this.clock(Number(target.value));
      keep({ hour: target.value });
    });
    byId("scene-hour").addEventListener("click", ({ detail }) => {
      this.client.set_hour(-1);
      this.clock(null);
      keep({ hour: null });
      // Out of use, the button keeps no focus: whoever came by keyboard goes on at the slider.
      byId(detail > 0 ? "view" : "hour").focus();
    });
    byId("shoot").addEventListener("click", () => this.capture.picture());
    byId("film").addEventListener("click", () => this.capture.film());
    byId("share").addEventListener("click", () => this.share());
    byId("name").addEventListener("change", ({ target }) => {
      this.client.set_name(target.value.trim());
      this.remember("name", target.value.trim());
    });
    byId("name").addEventListener("keydown", ({ key }) => key === "Enter" && byId("view").focus());
    for (const button of document.querySelectorAll("[data-rise]")) {
      button.addEventListener("pointerdown", () => this.client.hold_rise(Number(button.dataset.rise)));
      for (const end of ["pointerup", "pointercancel", "pointerleave"]) button.addEventListener(end, () => this.client.hold_rise(0));
    }
    addEventListener("keydown", (event) => this.key(event));
    this.giveKeysBack();
  }

  // What a pointer does in the panel gives the keys back to the prairie; whoever walks the panel by keyboard stays in it.
  giveKeysBack() {
    const panel = byId("panel");
    let byPointer = false;
    panel.addEventListener("pointerdown", () => { byPointer = true });
    panel.addEventListener("keydown", () => { byPointer = false });
    panel.addEventListener("click", ({ detail, target }) => {
      if (detail > 0 && target.closest("button:not(#ask), summary, [type=range]")) byId("view").focus();
    });
    panel.addEventListener("change", ({ target }) => {
      if (byPointer && target.matches("select, [type=range]")) byId("view").focus();
    });
  }

  pressed(event, key, act) {
    const button = event.target.closest("button");
    if (!button) return;
    act(button.dataset[key]);
    if (matchMedia("(max-width: 640px)").matches) this.show(false);
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.closest?.("input, select")) return;
    const once = event.repeat ? "" : event.key.toLowerCase();
    if (event.key === "?" || event.key === "F1") this.help();
    else if (once === "p") this.toggle();
    else if (once === "k") this.capture.picture();
    else if (once === "v") this.capture.film();
    else return;
    event.preventDefault();
  }

  update(state) {
    if (!state) return;
    const driven = state.vehicle ?? state.wanted ?? "";
    for (const button of byId("vehicles").children) button.setAttribute("aria-pressed", String(button.dataset.vehicle === driven));
    write("scene", state.scene ?? "");
    write("count", state.peers.length > 1 ? String(state.peers.length) : "");
    if (state.eye && ask("scene") !== state.scene_name) keep({ scene: state.scene_name });
    for (const id of ["order", "far"]) if (document.activeElement !== byId(id)) byId(id).value = state[id];
    write("work", state.cpu_ms === null ? "–" : `CPU ${state.cpu_ms.toFixed(1)} · GPU ${state.gpu_ms.toFixed(1)} ms`);
    write("detail", state.automatic ? `level ${state.level.toFixed(1)} of 3, aim ${state.budget_ms.toFixed(0)} ms` : state.quality);
    byId("fallback").hidden = !state.fallbacks.length;
    write("fallback", state.fallbacks.join(" "));
    write("frame", state.resting ? "at rest" : state.frame_ms ? `${state.frame_ms.toFixed(state.frame_ms < 100 ? 1 : 0)} ms · ${state.fps.toFixed(state.fps < 10 ? 1 : 0)}/s` : "–");
    write("stream", `${rate(state.bytes_per_s)}`);
    write("latency", state.latency_ms === null ? "–" : `${state.latency_ms.toFixed(state.latency_ms < 10 ? 1 : 0)} ms`);
    this.people(state.peers);
    const notice = state.notice ?? (performance.now() < this.told.until ? this.told.text : "");
    byId("notice").hidden = !notice;
    write("notice", notice);
  }

  people(peers) {
    const now = JSON.stringify(peers);
    if (now === this.peersShown) return;
    this.peersShown = now;
    byId("peers").replaceChildren(...peers.map(({ client, name, vehicle, me }) => {
      const item = document.createElement("li");
      item.style.setProperty("--hue", (client * 137.5) % 360);
      item.append(me ? `${name} (you)` : name);
      const doing = document.createElement("span");
      doing.textContent = vehicle ?? "looking";
      item.append(doing);
      return item;
    }));
  }
}

function write(id, text) {
  const node = byId(id);
  if (node.textContent !== text) node.textContent = text;
}

function rate(bytesPerSecond) {
  if (bytesPerSecond < 1000) return `${Math.round(bytesPerSecond)} B/s`;
  if (bytesPerSecond < 1e6) return `${(bytesPerSecond / 1000).toFixed(bytesPerSecond < 1e5 ? 1 : 0)} kB/s`;
  return `${(bytesPerSecond / 1e6).toFixed(2)} MB/s`;
}
