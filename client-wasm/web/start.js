// Starts the client once it is clear that this browser can draw it.
//
// `window.prairie` is where page, client and tests meet:
//   message(kind, detail), clear()   the client shows and clears the messages of messages.js
//   state()                          the client's own account of itself as an object, null before it has started
//   theta(x, z)                      bending angle of the grass there, in the client's mirror (rad)
//   wind(x, y, z)                    wind there, in the client's mirror (m/s)
//   dust(x, y, z)                    concentration of dust there
//   plants()                         checksum of the underbrush in the client's mirror, empty where none grows
//   look([x, y, z], heading, pitch)  puts the free camera somewhere (m, rad)
//   choose(vehicle)                  takes "car", "monster", "helicopter", "sled" or "ball"; "" gives it up
//   draw(time)                       draws one picture for this time (s); settles when it is on the screen
// The address may say ?quality=low|medium|high|ultra, ?name=…, ?panel=0 (nothing above the picture; P brings it), ?paused=1 (draws only when draw() asks).

import { hide, show } from "./messages.js";
import { Panel } from "./panel.js";

const asked = new URLSearchParams(location.search);
const QUALITIES = ["low", "medium", "high", "ultra"];
const NAMES = ["Bluestem", "Bobolink", "Bison", "Clover", "Curlew", "Hare", "Lark", "Lupine", "Meadowlark", "Poppy", "Sage", "Yarrow"];

window.prairie = { message: show, clear: hide, state: () => null };

// Storage may be forbidden; then nothing is remembered.
const remembered = (key) => { try { return localStorage.getItem(`prairie.${key}`) } catch { return null } };
const remember = (key, value) => { try { localStorage.setItem(`prairie.${key}`, value) } catch { /* not remembered */ } };

async function obstacle() {
  if (!window.isSecureContext) return ["insecure"];
  if (!navigator.gpu) return ["unsupported"];
  const adapter = await navigator.gpu.requestAdapter({ powerPreference: "high-performance" });
  return adapter ? [null, adapter.info] : ["no-adapter"];
}

// What a device of this kind draws fluently, unless address or memory say otherwise.
function quality(info) {
  const chosen = [asked.get("quality"), remembered("quality")].find((name) => QUALITIES.includes(name));
  if (chosen) return chosen;
  if (isSoftware(info)) return "low";
  return matchMedia("(pointer: coarse)").matches ? "medium" : "high";
}

const isSoftware = (info) => info.isFallbackAdapter || /swiftshader|llvmpipe|lavapipe|warp|basic render/i.test(adapterName(info));

const adapterName = (info) => [info.description, info.vendor, info.architecture, info.device].filter(Boolean).join(" ");

function name() {
  const given = asked.get("name") || remembered("name") || NAMES[Math.floor(Math.random() * NAMES.length)];
  remember("name", given);
  return given;
}

// Loads and compiles the client, and says how far it is.
async function load() {
  const client = await import("./client_wasm.js");
  const answer = await fetch("client_wasm_bg.wasm");
  if (!answer.ok) throw new Error(`client_wasm_bg.wasm: ${answer.status} ${answer.statusText}`);
  let bytes = 0;
  const count = new TransformStream({
    transform(chunk, onward) {
      bytes += chunk.length;
      show("loading", `${Math.round(bytes / 1024)} KB`);
      onward.enqueue(chunk);
    },
  });
  const headers = { "content-type": "application/wasm" };
  await client.default({ module_or_path: new Response(answer.body.pipeThrough(count), { headers }) });
  return client;
}

const nextFrame = () => new Promise(requestAnimationFrame);

async function begin() {
  const [kind, info] = await obstacle();
  if (kind) return show(kind);
  const client = await load();
  Object.assign(window.prairie, {
    state: () => JSON.parse(client.state()),
    theta: client.theta,
    wind: (x, y, z) => Array.from(client.wind(x, y, z)),
    dust: (x, y, z) => client.dust(x, y, z),
    plants: client.plants,
    look: (eye, heading, pitch) => client.look(Float32Array.from(eye), heading, pitch),
    choose: client.choose,
    draw: async (time) => {
      while (!client.draw(time)) await nextFrame();
      await nextFrame();
    },
  });
  const options = { name: name(), quality: quality(info), paused: asked.get("paused") === "1", adapter: adapterName(info) };
  client.start("view", JSON.stringify(options));
  const panel = new Panel(client, options, remember);
  panel.show((asked.get("panel") ?? remembered("panel") ?? (innerWidth < 640 ? "0" : "1")) !== "0");
  if (asked.get("panel") === "0") document.getElementById("open").hidden = true;
  else panel.hint();
}

begin().catch((error) => show("failed", String(error?.message ?? error)));
