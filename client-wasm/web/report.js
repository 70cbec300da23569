// Reports errors of this page to the server, which writes them to its log with `--report`, and discards them without.

// Maximum number of reports of one page, and maximum length of their text (UTF-16 units; the server accepts 4096 bytes).
const LIMIT = 5;
const LENGTH = 1300;

const sent = new Set();

// Details that each report adds to the error.
export const context = { adapter: "" };

export function report(kind, text) {
  const adapter = context.adapter && `\nadapter: ${context.adapter}`;
  const body = `${kind}: ${text}`.slice(0, LENGTH - adapter.length) + adapter;
  if (sent.size >= LIMIT || sent.has(body)) return;
  sent.add(body);
  fetch("/report", { method: "POST", body, keepalive: true }).catch(() => { /* the server is gone, too */ });
}
