// Starts the client once it is clear that this browser can draw it.
//
// `window.prairie` is where page and client meet:
//   message(kind, detail), clear()   the client shows and clears the messages of messages.js
//   state()                          the client's own state as an object, for the panel and for tests

import { hide, show } from "./messages.js";

window.prairie = { message: show, clear: hide, state: () => null };

async function obstacle() {
  if (!window.isSecureContext) return "insecure";
  if (!navigator.gpu) return "unsupported";
  if (!(await navigator.gpu.requestAdapter())) return "no-adapter";
  return null;
}

async function begin() {
  const kind = await obstacle();
  if (kind) return show(kind);
  show("connecting");
  const client = await import("./client_wasm.js");
  await client.default();
  window.prairie.state = () => JSON.parse(client.state());
  await client.start("view");
}

begin().catch((error) => show("failed", String(error?.message ?? error)));
