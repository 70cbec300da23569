// Status messages of the page.
// A message has a tone: `wait` and `stop` cover the page, `strip` leaves the last picture visible. One that `ends` the page is never replaced. One that is
// `reported` is an error, which the server's log gets.

import { byId, element, marked } from "./elements.js";
import { report } from "./report.js";
import { CHECKED, isLinux, support } from "./support.js";

// Opens the server's own scene instead of the one in the address.
function openServerScene() {
  const here = new URL(location.href);
  here.hash = "";
  here.searchParams.delete("scene");
  history.replaceState(null, "", here);
  location.reload();
}

const RELOAD = ["Reload", () => location.reload()];

const MESSAGES = {
  insecure: {
    tone: "stop",
    reported: true,
    title: "This address is not a secure one",
    text: "Browsers allow WebGPU only on https addresses and on localhost. Ask the operator of the server for one of these:",
    items: [
      `On the server's own machine, open \`http://localhost:${location.port || 80}\`.`,
      "From other machines, start the server with `--tls self` and open its `https://` address.",
    ],
  },
  unsupported: {
    tone: "stop",
    reported: true,
    title: "This browser has no WebGPU",
    text: "Prairie draws with WebGPU. Open this address in one of these browsers:",
    items: support(),
    note: `Checked in ${CHECKED}. A newer browser may be enough, even if it is not in the list.`,
  },
  "no-adapter": {
    tone: "stop",
    reported: true,
    title: "WebGPU found no graphics adapter",
    text: "This browser supports WebGPU, but accepts none of the installed graphics drivers.",
    items: [
      "Update the graphics driver, and turn on hardware acceleration in the browser's settings.",
      "Chrome and Chromium list disabled features, with reasons, on `chrome://gpu`.",
      ...(isLinux() ? ["Start Chrome or Chromium with `--enable-unsafe-webgpu` `--enable-features=Vulkan`."] : []),
    ],
    button: RELOAD,
  },
  loading: { tone: "wait", title: "Starting Prairie", text: "Loading the client…" },
  connecting: { tone: "wait", title: "Starting Prairie", text: "Connecting to the server…" },
  preparing: { tone: "wait", title: "Starting Prairie", text: "Almost ready." },
  adding: { tone: "strip", title: "Adding to the picture", text: "" },
  full: { tone: "wait", title: "The server is full", text: "There is no room for another client. This page keeps trying." },
  "server-gone": { tone: "strip", title: "Connection to the server lost", text: "Reconnecting…" },
  version: {
    tone: "stop",
    title: "This page is outdated",
    text: "This page and the server use different versions of the protocol. Reload to get the server's version.",
    button: RELOAD,
  },
  refused: { tone: "stop", reported: true, title: "The server closed this connection", text: "The reason is below.", button: RELOAD },
  "other-scene": {
    tone: "stop",
    title: "This link is to another scene",
    text: null,
    button: ["Open the server's scene", openServerScene],
  },
  limits: {
    tone: "stop",
    reported: true,
    title: "The limits of this graphics device are too low",
    text: "Even the lowest quality exceeds them:",
    items: [
      "Update the graphics driver, and turn on hardware acceleration in the browser's settings.",
      "Another browser, or a machine with another graphics card, may have higher limits.",
    ],
    button: RELOAD,
  },
  "device-back": { tone: "strip", title: "The graphics device was lost", text: "Restarting it…" },
  "device-lost": {
    tone: "stop",
    reported: true,
    title: "The graphics device keeps failing",
    text: "It was lost four times in a row, each within two minutes of the previous one: the driver was reset, or the browser withdrew the device.",
    button: RELOAD,
  },
  failed: { tone: "stop", reported: true, title: "The client stopped", text: "The reason is below.", button: RELOAD },
  panicked: {
    tone: "stop",
    ends: true,
    title: "Prairie has stopped: this is a bug",
    text: "The client met a state that its authors thought impossible. Reload the page to go on; the view is kept. If it happens again, please report the lines below.",
    button: RELOAD,
  },
  error: {
    tone: "stop",
    ends: true,
    title: "The page has stopped because of an error",
    text: "Reload the page to go on; the view is kept. If it happens again, please report the line below.",
    button: RELOAD,
  },
};

const container = byId("message");
const page = byId("prairie");
let hasEnded = false;
// The element that had the focus before a message covered the page.
let focused = null;

// Shows a message. `detail` is plain text below the message's own text, or instead of it if it has none; `progress` is a fraction, or null if unknown.
export function show(kind, detail = "", progress = null) {
  if (hasEnded) return;
  const message = MESSAGES[kind] ?? MESSAGES.failed;
  hasEnded = Boolean(message.ends);
  if (message.reported) report(kind, detail);
  // A message that only gets another detail stays, so that screen readers do not read all of it again.
  if (container.dataset.kind !== kind) build(kind, message);
  write(container.querySelector(".detail"), detail);
  const bar = container.querySelector("progress");
  if (bar && progress !== null) bar.value = progress;
  else bar?.removeAttribute("value");
}

export function hide() {
  if (hasEnded) return;
  container.hidden = true;
  delete container.dataset.kind;
  container.replaceChildren();
  uncover();
}

function build(kind, { tone, title, text, items = [], note, button }) {
  const section = document.createElement("section");
  const heading = element("h1", title);
  section.append(heading);
  if (text !== null) section.append(element("p", text));
  if (items.length) {
    const list = document.createElement("ul");
    list.append(...items.map(listItem));
    section.append(list);
  }
  if (note) section.append(element("p", note, "note"));
  if (tone === "wait") section.append(progressBar(title));
  section.append(element("p", "", text === null ? "detail main" : "detail"));
  const press = button && element("button", button[0]);
  if (press) {
    press.type = "button";
    press.addEventListener("click", button[1]);
    section.append(press);
  }
  Object.assign(container.dataset, { kind, tone });
  container.replaceChildren(section);
  container.hidden = false;
  if (tone === "strip") return uncover();
  cover();
  if (tone === "stop") {
    heading.tabIndex = -1;
    (press ?? heading).focus();
  }
}

// An item is a text, or a pair of a term and a text.
function listItem(item) {
  if (typeof item === "string") return marked("li", item, "code");
  const [term, text] = item;
  const node = marked("li", text, "code");
  node.prepend(element("b", `${term}: `));
  return node;
}

function progressBar(label) {
  const bar = document.createElement("progress");
  bar.setAttribute("aria-label", label);
  return bar;
}

// Takes everything below the message out of the reach of keyboard and screen reader.
function cover() {
  if (!page.inert) focused = document.activeElement;
  for (const id of ["help", "scenes"]) byId(id).close();
  page.inert = true;
}

function uncover() {
  if (!page.inert) return;
  page.inert = false;
  if (page.contains(focused)) focused.focus();
}

function write(node, text) {
  if (node.textContent !== text) node.textContent = text;
}
