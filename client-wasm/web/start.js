// Starts the client, if this browser can run it.
//
// `window.prairie` is the interface between page, client and tests:
//   message(kind, detail), clear()   shows and hides a status message of messages.js; called by the client
//   panicked(report)                 ends the page with a message; called by the client
//   halt()                           stops the client for good
//   panic(reason)                    makes the client panic, to try the message
//   state()                          state of the client as an object; null before it has started
//   theta(x, z)                      bending angle of the grass at a point in the mirror shown (rad)
//   wind(x, y, z)                    wind at a point in the mirror shown (m/s)
//   dust(x, y, z)                    dust concentration at a point in the mirror shown
//   plants()                         checksum of the underbrush in the client's mirror; empty if there is none
//   look([x, y, z], heading, pitch)  moves the free camera (m, rad)
//   picture()                        picture of the canvas at full size: { name, blob }
//   link()                           link to the current picture
//   sound()                          what is played as sound, for tests
//   look_back(secs)                  shows the world of some seconds ago, at which time stands still; 0 is the present
//   run_past(runs)                   lets time go on from the moment shown, or stand still
//   live()                           shows the present again
//   choose(vehicle)                  takes a vehicle by its name, such as "car"; "" gives it up
//   predict(enabled)                 predicts the own vehicle, or shows it as the server has it
//   draw(time)                       draws one frame at this animation time (s); resolves when it is on the screen
// The README lists the parameters of the address.

import { keep, link, parameter } from "./address.js";
import { Capture } from "./capture.js";
import { Comparison } from "./compare.js";
import { byId } from "./elements.js";
import { fillHelp } from "./help.js";
import { show } from "./messages.js";
import { Panel, variantLabel } from "./panel.js";
import { context } from "./report.js";
import { SceneMenu } from "./scenes.js";
import { Sound } from "./sound.js";
import { TimeBar } from "./time_bar.js";

const NAMES = ["Bluestem", "Bobolink", "Bison", "Clover", "Curlew", "Hare", "Lark", "Lupine", "Meadowlark", "Poppy", "Sage", "Yarrow"];

// Storage may be blocked; then nothing is remembered.
const remembered = (key) => { try { return localStorage.getItem(`prairie.${key}`) } catch { return null } };
const remember = (key, value) => { try { localStorage.setItem(`prairie.${key}`, value) } catch { /* storage is blocked */ } };

// Kind of the status message that explains why this browser cannot run the client, or null and the adapter's description.
async function obstacle() {
  if (!window.isSecureContext) return ["insecure"];
  if (!navigator.gpu) return ["unsupported"];
  const adapter = await navigator.gpu.requestAdapter({ powerPreference: "high-performance" });
  return adapter ? [null, adapter.info] : ["no-adapter"];
}

// Kind of device, which decides what automatic quality means.
const device = (info) => ({
  is_software: isSoftware(info),
  is_touch: matchMedia("(pointer: coarse)").matches,
  budget_ms: Number(parameter("budget")) || null,
});

const isSoftware = (info) => Boolean(info.isFallbackAdapter) || /swiftshader|llvmpipe|lavapipe|warp|basic render/i.test(adapterName(info));

const adapterName = (info) => [info.description, info.vendor, info.architecture, info.device].filter(Boolean).join(" ");

function name() {
  const given = parameter("name") || remembered("name") || NAMES[Math.floor(Math.random() * NAMES.length)];
  remember("name", given);
  return given;
}

// Fraction of the start that is done when the client is loaded. The client reports the rest.
const LOADED = 0.5;

// Loads and compiles the client, and shows the progress.
async function load() {
  const fetched = fetch("prairie_client_bg.wasm");
  const client = await import("./prairie_client.js");
  const response = await fetched;
  if (!response.ok) throw new Error(`prairie_client_bg.wasm: ${response.status} ${response.statusText}`);
  const total = Number(response.headers.get("x-uncompressed-length"));
  let bytes = 0;
  const count = new TransformStream({
    transform(chunk, onward) {
      bytes += chunk.length;
      show("loading", `${kilobytes(bytes)}${total ? ` of ${kilobytes(total)}` : ""} KB`, total ? LOADED * bytes / total : null);
      onward.enqueue(chunk);
    },
  });
  const headers = { "content-type": "application/wasm" };
  await client.default({ module_or_path: new Response(response.body.pipeThrough(count), { headers }) });
  return client;
}

const kilobytes = (bytes) => Math.round(bytes / 1024);

const nextFrame = () => new Promise(requestAnimationFrame);

async function begin() {
  const [kind, info] = await obstacle();
  if (kind) return show(kind);
  context.adapter = adapterName(info);
  document.documentElement.classList.toggle("software", isSoftware(info));
  const client = await load();
  Object.assign(window.prairie, {
    halt: client.halt,
    panic: (reason) => setTimeout(() => client.panic(String(reason))),
    state: () => JSON.parse(client.state()),
    theta: client.theta,
    wind: (x, y, z) => Array.from(client.wind(x, y, z)),
    wind_tick: client.wind_tick,
    bend: (x, z) => Array.from(client.bend(x, z)),
    dust: (x, y, z) => client.dust(x, y, z),
    plants: client.plants,
    look: (eye, heading, pitch) => client.set_camera(Float32Array.from(eye), heading, pitch),
    look_back: client.look_back,
    run_past: client.run_past,
    live: client.live,
    choose: client.choose,
    predict: client.predict,
    draw: async (time) => {
      while (!client.draw(time)) await nextFrame();
      await nextFrame();
    },
  });
  const options = {
    name: name(), qualities: [parameter("quality"), remembered("quality")], device: device(info),
    scene: parameter("scene"), paused: parameter("paused") === "1", predicts: parameter("predict") !== "0", adapter: adapterName(info),
  };
  client.start("view", JSON.stringify(options));
  client.set_options(parameter("order") ?? "", parameter("far") ?? "");
  client.raise_far_wind(parameter("wind") === "raised");
  client.show_grids(parameter("show") === "grids");
  client.cast_grass_shadows(parameter("shadows") !== "off");
  if (parameter("hour")) client.set_hour(Number(parameter("hour")));
  const { state } = window.prairie;
  const capture = new Capture(client, byId("view"), {
    state, notify: (text) => panel.notify(text), recording: (seconds) => panel.recording(seconds),
  });
  const choices = JSON.parse(client.choices());
  fillHelp(choices);
  const panel = new Panel(client, choices, { name: options.name, remember, capture });
  new Comparison(client, { variants: choices.compared, label: (name) => variantLabel(choices, name), keep }).restore(parameter("compare"), parameter("at"));
  const sound = new Sound(() => JSON.parse(client.hear()), {
    volume: remembered("volume"), remember, notify: (text) => panel.notify(text),
  });
  new SceneMenu((text) => panel.notify(text));
  new TimeBar(client, parameter("panel") !== "0");
  Object.assign(window.prairie, { picture: () => capture.shoot(), link: () => link(state().view), sound: () => sound.report() });
  panel.show((parameter("panel") ?? remembered("panel") ?? (innerWidth < 640 ? "0" : "1")) !== "0");
  if (parameter("panel") === "0") byId("open").hidden = true;
  else panel.hint();
}

// An error ends the page: see errors.js.
begin();
