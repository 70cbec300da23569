// The plan of the scene: what is modelled, by which methods, with which errors and costs, and what gives way; and in which detail the run is at present.

import { byId, element, marked } from "./elements.js";

// Time between two looks at the run while the section is open (ms).
const PERIOD_MS = 2000;

// Asks the server for the plan while the section is open, since scene and run change.
export function showPlan() {
  let timer = 0;
  let shown = "";
  const update = async () => {
    clearTimeout(timer);
    if (!byId("plan").open) return;
    try {
      const response = await fetch("/api/plan");
      if (!response.ok) throw new Error(`${response.status} ${response.statusText}`);
      const plan = await response.json();
      showNow(plan.now);
      // What stays the same is not built again, so that text remains selected.
      const text = JSON.stringify({ ...plan, now: null });
      if (text !== shown) fill(plan);
      shown = text;
    } catch (error) {
      shown = "";
      byId("plan-now").replaceChildren();
      byId("plan-parts").replaceChildren(element("p", `The server does not tell its plan: ${error.message}`, "aside"));
    }
    timer = setTimeout(update, PERIOD_MS);
  };
  byId("plan").addEventListener("toggle", update);
}

// The run at present; nothing in a scene whose detail stays as it is.
function showNow({ control, may_set_budget, wind_step_secs, awake_limit, gives_way, decisions }) {
  if (control === null && decisions.length === 0) {
    byId("plan-now").replaceChildren();
    return;
  }
  // A field that somebody is typing into stays.
  if (byId("plan-now").contains(document.activeElement) && document.activeElement.matches("input")) return;
  const lines = [`Wind stepped every ${(1e3 * wind_step_secs).toFixed(0)} ms, at most ${awake_limit} patches awake`];
  if (control !== null) lines.unshift(...controlLines(control));
  if (gives_way.length) lines.push(`Gives way to the load: ${gives_way.join("; ")}`);
  const newest = decisions.slice(-5).reverse().map(({ time_secs, detail, reason }) => `${time_secs.toFixed(1)} s: ${reason} → ${detail}`);
  byId("plan-now").replaceChildren(
    element("h4", "Now"),
    ...lines.map((line) => element("p", line)),
    ...(may_set_budget && control ? [budgetForm(control.budget_ms)] : []),
    ...(newest.length ? [element("h4", "Newest decisions"), list(newest)] : []),
  );
}

function controlLines({ budget_ms, busy_ms, wind_error, wind_tolerance, bend_error_deg, bend_tolerance_deg }) {
  const lines = [`A tick takes ${rounded(busy_ms)} ms of ${rounded(budget_ms)} ms`];
  if (wind_error !== null) lines.push(`Expected error of the wind ${(100 * wind_error).toFixed(2)} % of ${(100 * wind_tolerance).toFixed(2)} %`);
  if (bend_tolerance_deg !== null) lines.push(`Expected error of the bend ${bend_error_deg.toFixed(2)}° of ${bend_tolerance_deg.toFixed(2)}°`);
  return lines;
}

// A number with three digits.
function rounded(number) {
  return String(Number(number.toPrecision(3)));
}

// Sets the time that a tick may take on the server.
function budgetForm(budget_ms) {
  const form = element("form");
  const label = element("label", "Budget of a tick (ms) ", "line");
  const input = element("input");
  Object.assign(input, { type: "number", required: true, min: "0.001", max: "1000", step: "any", value: rounded(budget_ms) });
  label.append(input);
  const outcome = element("p", "", "aside");
  form.append(label, outcome);
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    try {
      const response = await fetch("/api/budget", { method: "POST", body: JSON.stringify({ server_ms: input.valueAsNumber }) });
      outcome.textContent = response.ok ? "" : (await response.json()).error;
      if (response.ok) input.blur();
    } catch (error) {
      outcome.textContent = `The server does not answer: ${error.message}`;
    }
  });
  return form;
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
