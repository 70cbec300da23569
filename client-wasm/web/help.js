// Rows of the help dialog that depend on the client's choices.

import { byId, marked } from "./elements.js";

const keys = (names) => names.map((name) => `\`${name}\``).join(" ");
const list = (items) => items.join(", ");

// Fills the rows from the client's vehicles and camera heights.
export function fillHelp({ vehicles, heights }) {
  const named = vehicles.map(({ label }) => `a ${label.toLowerCase()}`);
  const flying = vehicles.filter(({ flies }) => flies).map(({ label }) => label.toLowerCase());
  const arrows = vehicles.filter(({ arrow }) => arrow).map(({ arrow, label }) => `${arrow} ${label.toLowerCase()}`);
  row("help-vehicles", keys(vehicles.map(({ key }) => key.toUpperCase())), `take ${list(named)}`);
  const jumping = vehicles.filter(({ jumps }) => jumps).map(({ label }) => label.toLowerCase());
  row("help-rise", null, `${list(flying)}: up, down; ${list(jumping)}: jump, run; all others: brake`);
  row("help-heights", keys(heights.map((_, index) => index + 1)), `view from ${list(heights)} m`);
  row("help-dpad", null, `${list(arrows)}, ↓ get out`);
}

function row(id, head, text) {
  const row = byId(id);
  if (head !== null) row.querySelector("th").replaceChildren(marked("span", head, "kbd"));
  row.querySelector("td").textContent = text;
}
