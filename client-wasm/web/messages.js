// What the page says when there is something to say instead of, or above, the prairie.
// A message has a tone: `wait` and `stop` cover the page, `strip` leaves the last picture in sight.

// The start of the scene that runs here, whatever the address says.
function elsewhere() {
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
    text: "Browsers draw with WebGPU only on https addresses and on this very machine. Ask whoever runs the server for one of these:",
    items: [
      "On the machine of the server, open <code>http://localhost:PORT</code>.",
      "From other machines, start the server with <code>--tls self</code> and open its <code>https://</code> address.",
    ],
  },
  unsupported: {
    tone: "stop",
    title: "This browser has no WebGPU",
    text: "The prairie is drawn with WebGPU. Open this address in one of these:",
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
    text: "This browser knows WebGPU, but no driver that it trusts.",
    items: [
      "Update the graphics driver, and turn hardware acceleration on in the browser's settings.",
      "Chrome and Chromium list what is off, and why, on <code>chrome://gpu</code>.",
      "Linux: start the browser with <code>--enable-unsafe-webgpu --enable-features=Vulkan</code>.",
    ],
    button: RELOAD,
  },
  loading: { tone: "wait", title: "The prairie is waking up", text: "Loading the client…" },
  connecting: { tone: "wait", title: "The prairie is waking up", text: "Connecting to the server…" },
  preparing: { tone: "wait", title: "The prairie is waking up", text: "Nearly there." },
  full: { tone: "wait", title: "The prairie is full", text: "Every place on this server is taken. This page tries again by itself." },
  "server-gone": { tone: "strip", title: "The server is gone", text: "Trying again until it is back…" },
  version: {
    tone: "stop",
    title: "The server has moved on",
    text: "This page and the server speak different versions of the protocol. Reload to get the page that belongs to the server.",
    button: RELOAD,
  },
  refused: { tone: "stop", title: "The server closed this connection", text: "It gave the reason below.", button: RELOAD },
  "other-scene": {
    tone: "stop",
    title: "This link is to another scene",
    text: null,
    button: ["Look at what runs here", elsewhere],
  },
  limits: {
    tone: "stop",
    title: "This graphics device is too small",
    text: "Not even the coarsest picture fits into what it allows:",
    items: [
      "Update the graphics driver, and turn hardware acceleration on in the browser's settings.",
      "A machine with another graphics card, or another browser on this one, may allow more.",
    ],
    button: RELOAD,
  },
  "device-back": { tone: "strip", title: "The graphics device was lost", text: "Starting it again…" },
  "device-lost": {
    tone: "stop",
    title: "The graphics device is gone",
    text: "It was lost four times, each within two minutes of the one before: the driver was reset, or the browser took it away.",
    button: RELOAD,
  },
  failed: { tone: "stop", title: "The client stopped", text: "It cannot go on; the line below says why.", button: RELOAD },
};

const place = document.getElementById("message");

// Shows the message of this kind, with a plain-text detail of the moment below its text, or as its text where it has none.
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
  place.dataset.kind = kind;
  place.dataset.tone = tone;
  place.replaceChildren(section);
  place.hidden = false;
}

export function hide() {
  place.hidden = true;
  delete place.dataset.kind;
  place.replaceChildren();
}

function element(name, text = "", className = "") {
  const node = document.createElement(name);
  node.textContent = text;
  node.className = className;
  return node;
}
