// Status messages of the page.
// A message has a tone: `wait` and `stop` cover the page, `strip` leaves the last picture visible.

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
    title: "This address is not a secure one",
    text: "Browsers allow WebGPU only on https addresses and on localhost. Ask the operator of the server for one of these:",
    items: [
      "On the server's own machine, open <code>http://localhost:PORT</code>.",
      "From other machines, start the server with <code>--tls self</code> and open its <code>https://</code> address.",
    ],
  },
  unsupported: {
    tone: "stop",
    title: "This browser has no WebGPU",
    text: "Prairie needs WebGPU. Open this address in one of these browsers:",
    items: [
      "Chrome or Edge 113 or newer on Windows, macOS and ChromeOS; Android from 121.",
      "Firefox 141 or newer on Windows, 145 on macOS with Apple silicon.",
      "Safari 26 or newer.",
      "Linux: Chromium or Chrome started with <code>--enable-unsafe-webgpu --enable-features=Vulkan</code>, or Firefox Nightly.",
    ],
  },
  "no-adapter": {
    tone: "stop",
    title: "WebGPU found no graphics adapter",
    text: "This browser supports WebGPU, but accepts none of the installed graphics drivers.",
    items: [
      "Update the graphics driver, and turn on hardware acceleration in the browser's settings.",
      "Chrome and Chromium list disabled features, with reasons, on <code>chrome://gpu</code>.",
      "Linux: start the browser with <code>--enable-unsafe-webgpu --enable-features=Vulkan</code>.",
    ],
    button: RELOAD,
  },
  loading: { tone: "wait", title: "Starting Prairie", text: "Loading the client…" },
  connecting: { tone: "wait", title: "Starting Prairie", text: "Connecting to the server…" },
  preparing: { tone: "wait", title: "Starting Prairie", text: "Almost ready." },
  full: { tone: "wait", title: "The server is full", text: "All client slots of this server are taken. This page keeps trying." },
  "server-gone": { tone: "strip", title: "Connection to the server lost", text: "Reconnecting…" },
  version: {
    tone: "stop",
    title: "This page is outdated",
    text: "This page and the server use different versions of the protocol. Reload to get the server's version.",
    button: RELOAD,
  },
  refused: { tone: "stop", title: "The server closed this connection", text: "The reason is below.", button: RELOAD },
  "other-scene": {
    tone: "stop",
    title: "This link is to another scene",
    text: null,
    button: ["Open the server's scene", openServerScene],
  },
  limits: {
    tone: "stop",
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
    title: "The graphics device keeps failing",
    text: "It was lost four times in a row, each within two minutes of the previous one: the driver was reset, or the browser withdrew the device.",
    button: RELOAD,
  },
  failed: { tone: "stop", title: "The client stopped", text: "The reason is below.", button: RELOAD },
};

const container = document.getElementById("message");

// Shows a message. `detail` is plain text below the message's own text, or instead of it if it has none.
export function show(kind, detail = "") {
  const { tone, title, text, items = [], button } = MESSAGES[kind] ?? MESSAGES.failed;
  const section = document.createElement("section");
  section.append(element("h1", title), element("p", text ?? detail));
  if (items.length) {
    const list = element("ul");
    list.innerHTML = items.map((item) => `<li>${item.replace("PORT", location.port || "8080")}</li>`).join("");
    section.append(list);
  }
  if (detail && text !== null) section.append(element("p", detail, "detail"));
  if (button) {
    const [label, act] = button;
    const press = element("button", label);
    press.addEventListener("click", act);
    section.append(press);
  }
  container.dataset.kind = kind;
  container.dataset.tone = tone;
  container.replaceChildren(section);
  container.hidden = false;
}

export function hide() {
  container.hidden = true;
  delete container.dataset.kind;
  container.replaceChildren();
}

function element(name, text = "", className = "") {
  const node = document.createElement(name);
  node.textContent = text;
  node.className = className;
  return node;
}
