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
//   picture()                        a picture of the canvas in its full size: { name, blob }
//   link()                           the link to what is seen
//   choose(vehicle)                  takes "car", "monster", "helicopter", "sled" or "ball"; "" gives it up
//   draw(time)                       draws one picture for this time (s); settles when it is on the screen
// The address may say ?scene=… (that it is a link to), ?quality=auto|low|medium|high|ultra, ?budget=… (ms a frame of automatic quality may take), ?order=…, ?far=…,
// ?hour=… (of the day, 0 to 24, by which the sun stands), ?compare=…,…&at=… (ways of drawing, as client.ways() names them), ?name=…, ?panel=0 (nothing above the picture; P brings it), ?paused=1 (draws only when draw() asks).

import { ask, keep, link } from "./address.js";
import { Capture } from "./capture.js";
import { Comparison } from "./compare.js";
import { hide, show } from "./messages.js";
import { Panel, label } from "./panel.js";

const QUALITIES = ["auto", "low", "medium", "high", "ultra"];
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

const quality = () => [ask("quality"), remembered("quality")].find((name) => QUALITIES.includes(name)) ?? "auto";

// What automatic quality is on a device of this kind: the finest level, the first, and how long a frame may take (ms).
function automatic(info) {
  const wanted = Number(ask("budget"));
  const budget = (usual) => (wanted >= 1 && wanted <= 1000 ? wanted : usual);
  if (isSoftware(info)) return { finest: "medium", level: 0, budget_ms: budget(100) };
  if (matchMedia("(pointer: coarse)").matches) return { finest: "high", level: 1, budget_ms: budget(16.7) };
  return { finest: "ultra", level: 1.5, budget_ms: budget(16.7) };
}

const isSoftware = (info) => info.isFallbackAdapter || /swiftshader|llvmpipe|lavapipe|warp|basic render/i.test(adapterName(info));

const adapterName = (info) => [info.description, info.vendor, info.architecture, info.device].filter(Boolean).join(" ");

function name() {
  const given = ask("name") || remembered("name") || NAMES[Math.floor(Math.random() * NAMES.length)];
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
  const options = {
    name: name(), quality: quality(), automatic: automatic(info), scene: ask("scene"), paused: ask("paused") === "1", adapter: adapterName(info),
  };
  client.start("view", JSON.stringify(options));
  client.set_look(ask("order") ?? "", ask("far") ?? "");
  if (ask("hour")) client.set_hour(Number(ask("hour")));
  const { state } = window.prairie;
  const capture = new Capture(client, document.getElementById("view"), {
    state, tell: (text) => panel.tell(text), filming: (seconds) => panel.filming(seconds),
  });
  const panel = new Panel(client, options, { remember, capture });
  new Comparison(client, { ways: JSON.parse(client.ways()).compared, label, keep }).restore(ask("compare"), ask("at"));
  Object.assign(window.prairie, { picture: () => capture.shoot(), link: () => link(state().view) });
  panel.show((ask("panel") ?? remembered("panel") ?? (innerWidth < 640 ? "0" : "1")) !== "0");
  if (ask("panel") === "0") document.getElementById("open").hidden = true;
  else panel.hint();
}

begin().catch((error) => show("failed", String(error?.message ?? error)));
