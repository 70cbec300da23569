// The plan of the scene: what is modelled, by which methods, with which errors and costs, and what gives way.

import { byId, element, marked } from "./elements.js";

// Asks the server for the plan each time the section is opened, since the scene may have changed.
export function showPlan() {
  byId("plan").addEventListener("toggle", async () => {
    if (!byId("plan").open) return;
    try {
      const response = await fetch("/api/plan");
      if (!response.ok) throw new Error(`${response.status} ${response.statusText}`);
      fill(await response.json());
    } catch (error) {
      byId("plan-parts").replaceChildren(element("p", `The server does not tell its plan: ${error.message}`, "aside"));
    }
  });
}

function fill({ is_planned, rows, left_out, not_planned, conflicts, sources }) {
  const parts = rows.flatMap(({ part, method, error, server_ms_per_tick, planned }) => [
    element("h4", part),
    marked("p", method, "code"),
    marked("p", `Error: ${error}`, "code"),
    ...(server_ms_per_tick === null ? [] : [element("p", `Cost: ${server_ms_per_tick.toPrecision(3)} ms per tick`)]),
    ...(planned.length ? [marked("p", `Planned: ${planned.join(", ")}`, "code")] : []),
  ]);
  const lists = [["Gives way", conflicts], ["Left out", left_out], ["Not planned", is_planned ? not_planned : []], ["Sources", sources]];
  byId("plan-parts").replaceChildren(...parts, ...lists.filter(([, lines]) => lines.length).flatMap(([title, lines]) => [element("h4", title), list(lines)]));
}

function list(lines) {
  const list = document.createElement("ul");
  list.append(...lines.map((line) => marked("li", line, "code")));
  return list;
}
