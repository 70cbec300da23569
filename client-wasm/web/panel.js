// The panel: settings, connected clients and performance figures. It reads the client's state a few times a second.

import { keep, link, parameter } from "./address.js";
import { byId, element, marked, write } from "./elements.js";
import { showPlan } from "./plan.js";
import { showRace } from "./race.js";

const UPDATE_MS = 250;
const HINT_MS = 14_000;
const NOTICE_MS = 5_000;

const LABELS = {
  auto: "Automatic", land: "Ground only", cut: "Alpha test", coverage: "Alpha to coverage", precomputed: "Precomputed orders", weighted: "Weighted blended",
  unculled: "No culling", unoccluded: "No culling behind solids", occluded: "Always culled behind solids", raised: "Wind raised with distance", grids: "Map of the grids", unshadowed: "No shadows of grass",
};

// Displayed name of a choice.
export const label = (name) => LABELS[name] ?? name[0].toUpperCase() + name.slice(1);

// Displayed name of a variant in a comparison, where the names of qualities need a noun.
export const variantLabel = ({ quality }, name) => (quality.includes(name) ? `${label(name)} quality` : label(name));

export class Panel {
  // `client` is the started client; `choices` what it offers; `remember(key, value)` stores a choice for the next visit; `capture` saves pictures and videos.
  constructor(client, choices, { name, remember, capture }) {
    this.client = client;
    this.choices = choices;
    this.remember = remember;
    this.capture = capture;
    this.notice = { text: "", until: 0 };
    byId("name").value = name;
    this.fill(choices);
    byId("quality").value = JSON.parse(client.state()).chosen_quality;
    byId("options").open = ["order", "far", "wind", "show", "compare"].some((key) => parameter(key) !== null);
    this.listen();
    showPlan();
    setInterval(() => this.update(JSON.parse(client.state())), UPDATE_MS);
  }

  // Creates the buttons and the entries of the lists.
  fill({ vehicles, heights, quality, order, far, compared }) {
    byId("vehicles").prepend(...vehicles.map(({ name, label, key }) => vehicleButton(name, label, key)));
    byId("heights").append(...heights.map((height) => {
      const button = element("button", `${height} m`);
      button.type = "button";
      button.dataset.height = height;
      return button;
    }));
    for (const [id, names] of [["quality", quality], ["order", order], ["far", far]]) {
      byId(id).append(...names.map((name) => new Option(label(name), name)));
    }
    for (const id of ["left", "right"]) {
      byId(id).append(...compared.map((name) => new Option(variantLabel(this.choices, name), name)));
    }
  }

  // Shows or hides the panel; while it is hidden, a small button brings it back.
  show(shown) {
    byId("panel").hidden = !shown;
    byId("open").hidden = shown;
  }

  // Shows a hint for new users until they begin.
  hint() {
    const [{ label, key }] = this.choices.vehicles;
    const vehicle = `a ${label.toLowerCase()}`;
    const touch = matchMedia("(pointer: coarse)").matches;
    const hint = byId("hint");
    const text = touch
      ? `The left thumb walks, the right thumb looks. The menu has ${vehicle}.`
      : `Drag to look, \`W\` \`A\` \`S\` \`D\` to walk, \`${key.toUpperCase()}\` for ${vehicle}, \`?\` for all keys.`;
    hint.replaceChildren(marked("span", text, "kbd"));
    hint.hidden = false;
    const gone = () => { hint.hidden = true };
    setTimeout(gone, HINT_MS);
    for (const kind of ["keydown", "pointerdown"]) addEventListener(kind, () => setTimeout(gone, 1500), { once: true });
  }

  // Shows a line for a while.
  notify(text) {
    this.notice = { text, until: performance.now() + NOTICE_MS };
    this.update(JSON.parse(this.client.state()));
  }

  // Shows the length of the video being recorded (s); null if none is.
  recording(seconds) {
    const runs = seconds !== null;
    byId("video").setAttribute("aria-pressed", String(runs));
    write("video-label", runs ? `● ${Math.floor(seconds)} s` : "Video");
  }

  async share() {
    const address = link(JSON.parse(this.client.state()).view);
    try {
      await navigator.clipboard.writeText(address);
      this.notify("Link copied.");
    } catch {
      this.notify(`The browser does not allow copying. This is the link: ${address}`);
    }
  }

  // Shows the hour of the day: the chosen one, or, if that is null, the scene's.
  showHour(hour, sceneHour) {
    const slider = byId("hour");
    const isScenes = hour === null;
    const text = isScenes ? `${clock(sceneHour)}, as in the scene` : clock(hour);
    if (isScenes) slider.value = sceneHour;
    else if (document.activeElement !== slider) slider.value = hour;
    write("clock", text);
    if (slider.getAttribute("aria-valuetext") !== text) slider.setAttribute("aria-valuetext", text);
    byId("scene-hour").disabled = isScenes;
  }

  // Shows or hides the panel, and moves the focus if it would be lost.
  toggle(shown = byId("panel").hidden) {
    const focused = document.activeElement;
    this.show(shown);
    this.remember("panel", shown ? "1" : "0");
    if (focused === byId("open")) byId("close").focus();
    else if (focused === byId("close")) byId("open").focus();
    else if (byId("panel").contains(focused)) byId("view").focus();
  }

  // Shows or hides the map of the grass grids.
  toggleGrids() {
    const shown = !JSON.parse(this.client.state()).grids;
    this.client.show_grids(shown);
    keep({ show: shown ? "grids" : null });
    this.update(JSON.parse(this.client.state()));
  }

  // Raises the wind on far plants with distance, or not.
  toggleRaised() {
    const raised = !JSON.parse(this.client.state()).raised;
    this.client.raise_far_wind(raised);
    keep({ wind: raised ? "raised" : null });
    this.update(JSON.parse(this.client.state()));
  }

  // Lets grass cast shadows, or not.
  toggleShadows() {
    const casts = !JSON.parse(this.client.state()).shadows;
    this.client.cast_grass_shadows(casts);
    keep({ shadows: casts ? null : "off" });
    this.update(JSON.parse(this.client.state()));
  }

  // Enters or leaves full screen.
  fullScreen() {
    if (!document.fullscreenEnabled) return this.notify("This browser has no full screen for pages.");
    const change = document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen();
    change.catch(({ message }) => this.notify(`No full screen: ${message}`));
  }

  help() {
    const help = byId("help");
    byId("scenes").close();
    if (help.open) help.close();
    else help.showModal();
  }

  listen() {
    byId("open").addEventListener("click", () => this.toggle(true));
    byId("close").addEventListener("click", () => this.toggle(false));
    byId("show-help").addEventListener("click", () => this.help());
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
        this.client.set_options(byId("order").value, byId("far").value);
        keep({ [id]: target.value });
      });
    }
    byId("grids").addEventListener("click", () => this.toggleGrids());
    byId("raised").addEventListener("click", () => this.toggleRaised());
    byId("shadows").addEventListener("click", () => this.toggleShadows());
    byId("hour").addEventListener("input", ({ target }) => {
      this.client.set_hour(Number(target.value));
      this.showHour(Number(target.value), null);
      keep({ hour: target.value });
    });
    byId("scene-hour").addEventListener("click", ({ detail }) => {
      this.client.set_hour(-1);
      keep({ hour: null });
      this.update(JSON.parse(this.client.state()));
      // A disabled button loses the focus: keyboard users continue at the slider.
      byId(detail > 0 ? "view" : "hour").focus();
    });
    byId("shoot").addEventListener("click", () => this.capture.picture());
    byId("video").addEventListener("click", () => this.capture.video());
    byId("share").addEventListener("click", () => this.share());
    byId("full-screen").hidden = !document.fullscreenEnabled;
    byId("full-screen").addEventListener("click", () => this.fullScreen());
    document.addEventListener("fullscreenchange", () => {
      byId("full-screen").setAttribute("aria-pressed", String(document.fullscreenElement !== null));
    });
    byId("name").addEventListener("change", ({ target }) => {
      this.client.set_name(target.value.trim());
      this.remember("name", target.value.trim());
    });
    byId("name").addEventListener("keydown", ({ key }) => key === "Enter" && byId("view").focus());
    for (const button of document.querySelectorAll("[data-rise]")) {
      const hold = () => this.client.hold_rise(Number(button.dataset.rise));
      button.addEventListener("pointerdown", hold);
      button.addEventListener("keydown", ({ key }) => (key === " " || key === "Enter") && hold());
      for (const end of ["pointerup", "pointercancel", "pointerleave", "keyup", "blur"]) button.addEventListener(end, () => this.client.hold_rise(0));
    }
    // A message that covers the page leaves it inert.
    addEventListener("keydown", (event) => byId("prairie").inert || this.key(event));
    this.returnFocus();
    showFocus(byId("view"));
  }

  // Returns the keyboard focus to the canvas after pointer input in the panel; keyboard users stay in the panel.
  returnFocus() {
    const panel = byId("panel");
    let byPointer = false;
    panel.addEventListener("pointerdown", () => { byPointer = true });
    panel.addEventListener("keydown", () => { byPointer = false });
    panel.addEventListener("click", ({ detail, target }) => {
      if (detail > 0 && target.closest("button:not(#show-help, #show-scenes), summary, [type=range]")) byId("view").focus();
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
    else if (once === "g") this.toggleGrids();
    else if (once === "k") this.capture.picture();
    else if (once === "v") this.capture.video();
    else if (once === "x") this.fullScreen();
    else return;
    event.preventDefault();
  }

  update(state) {
    if (!state) return;
    const vehicle = state.vehicle ?? state.wanted ?? "";
    for (const button of byId("vehicles").children) button.setAttribute("aria-pressed", String(button.dataset.vehicle === vehicle));
    write("scene", state.scene ?? "");
    write("count", state.peers.length > 1 ? String(state.peers.length) : "");
    if (state.eye && parameter("scene") !== state.scene_name) keep({ scene: state.scene_name });
    for (const id of ["order", "far"]) if (document.activeElement !== byId(id)) byId(id).value = state[id];
    for (const id of ["grids", "raised", "shadows"]) byId(id).setAttribute("aria-pressed", String(state[id]));
    // Without a device, such as between its loss and its replacement, there is no GPU time.
    write("work", state.cpu_ms === null || state.gpu_ms === null ? "–" : `CPU ${state.cpu_ms.toFixed(1)} · GPU ${state.gpu_ms.toFixed(1)} ms`);
    write("detail", state.automatic ? `${state.level.toFixed(1)} of ${Number(state.highest_level.toFixed(1))} · target ${state.budget_ms.toFixed(0)} ms` : state.quality);
    write("resolution", state.rendered_px ? state.rendered_px.join(" × ") : "–");
    byId("fallback").hidden = !state.fallbacks.length;
    write("fallback", state.fallbacks.join(" "));
    write("frame", state.resting ? "idle" : state.frame_ms ? `${state.frame_ms.toFixed(state.frame_ms < 100 ? 1 : 0)} ms · ${state.fps.toFixed(state.fps < 10 ? 1 : 0)}/s` : "–");
    write("stream", `${rate(state.bytes_per_s)}`);
    if (state.scene_hour !== null) this.showHour(state.hour, state.scene_hour);
    write("grass", state.replica ? `simulated here, ${(100 * state.replica_share).toFixed(1)} % of the time` : "from the server");
    write("start", startTimes(state));
    write("latency", state.latency_ms === null ? "–" : `${state.latency_ms.toFixed(state.latency_ms < 10 ? 1 : 0)} ms`);
    write("input", state.input_to_picture_ms === null ? "–" : inputLatency(state));
    this.showPeers(state.peers);
    showRace(state.race);
    const notice = state.notice ?? (performance.now() < this.notice.until ? this.notice.text : "");
    byId("notice").hidden = !notice;
    write("notice", notice);
  }

  showPeers(peers) {
    const now = JSON.stringify(peers);
    if (now === this.peersShown) return;
    this.peersShown = now;
    byId("peers").replaceChildren(...peers.map(({ client, name, vehicle, me }) => {
      const item = document.createElement("li");
      item.style.setProperty("--hue", (client * 137.5) % 360);
      const text = me ? `${name} (you)` : name;
      item.append(element("b", text), element("span", vehicle ?? "looking"));
      // A long name is cut off.
      item.title = text;
      return item;
    }));
  }
}

// Marks the canvas while it has the focus from the Tab key. With `:focus-visible` alone, the frame would also appear when someone clicks and then drives.
function showFocus(canvas) {
  let byTab = false;
  addEventListener("keydown", ({ key }) => { if (key === "Tab") byTab = true }, true);
  addEventListener("pointerdown", () => { byTab = false }, true);
  canvas.addEventListener("focus", () => canvas.classList.toggle("by-key", byTab));
}

function vehicleButton(name, label, key) {
  const button = element("button", `${label} `);
  button.type = "button";
  button.dataset.vehicle = name;
  button.setAttribute("aria-pressed", "false");
  button.append(element("kbd", key.toUpperCase()));
  return button;
}

// Times from an input to the picture and to the server's pose.
function inputLatency({ input_to_picture_ms: picture, input_to_server_ms: server }) {
  return `picture ${picture.toFixed(0)}${server === null ? "" : ` · server ${server.toFixed(0)}`} ms`;
}

// Times from opening the page to the first picture and to the whole one.
function startTimes({ first_picture_secs: first, complete_picture_secs: whole }) {
  if (first === null) return "–";
  return `picture ${first.toFixed(1)} · all ${whole === null ? "…" : whole.toFixed(1)} s`;
}

// An hour of the day as hours and minutes.
function clock(hour) {
  const minutes = Math.round(hour * 60);
  return `${Math.floor(minutes / 60)}:${String(minutes % 60).padStart(2, "0")}`;
}

function rate(bytesPerSecond) {
  if (bytesPerSecond < 1000) return `${Math.round(bytesPerSecond)} B/s`;
  if (bytesPerSecond < 1e6) return `${(bytesPerSecond / 1000).toFixed(bytesPerSecond < 1e5 ? 1 : 0)} kB/s`;
  return `${(bytesPerSecond / 1e6).toFixed(2)} MB/s`;
}
