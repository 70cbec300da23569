// Last resort: an uncaught error, an unhandled rejection or a script that does not load ends the page with a message, and is reported to the server.
// This script runs before the others, so that it also reports theirs.

import { hide, show } from "./messages.js";
import { report } from "./report.js";

window.prairie = { message: show, clear: hide, state: () => null, halt: () => {}, panicked: (text) => end("panicked", text) };

let hasEnded = false;

function end(kind, text, details = text) {
  // A panic is followed by an error of the WebAssembly that it aborts.
  if (hasEnded) return;
  hasEnded = true;
  window.prairie.halt();
  report(kind, details);
  show(kind, text);
}

function endWith(error) {
  const text = String(error?.message ?? error);
  end("error", text, error?.stack ? `${text}\n${error.stack}` : text);
}

// Errors of files do not bubble, hence the capturing listener.
addEventListener("error", ({ target, filename, error, message }) => {
  if (target instanceof HTMLScriptElement) end("error", `${target.src} did not load.`);
  // Extensions and scripts that a browser injects share the page's window; their file is another origin's, or none.
  else if (target === window && (filename.startsWith(location.origin) || filename.startsWith("wasm:"))) endWith(error ?? message);
}, true);

addEventListener("unhandledrejection", ({ reason }) => {
  if (!reason?.stack || reason.stack.includes(location.origin) || reason.stack.includes("wasm")) endWith(reason);
});
