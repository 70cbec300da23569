// The race: the own lap, the start light, and the standings.

import { byId, element, write } from "./elements.js";

let shown = "";

// Shows the race of the client's state; hides it in a scene without one.
export function showRace(race) {
  byId("race").hidden = race === null;
  if (race === null) return;
  showLight(race.light);
  const own = race.standings.find(({ me }) => me);
  const lap = own?.lap_secs ?? null;
  write("lap", lap === null ? "–" : `${own.laps + 1} of ${race.laps} · ${time(lap)}`);
  write("gate", gateName(own?.next_gate ?? 0, race.gates) + gap(own?.gap_secs ?? null));
  write("last-lap", time(own?.last_secs ?? null));
  write("best-lap", time(own?.best_secs ?? null));
  byId("false-start").hidden = !own?.false_start;
  showStandings(race.standings);
}

// Shows the start light and the time until it turns green; hides it in a race without one.
function showLight(light) {
  byId("start-light").hidden = light === null;
  if (light === null) return;
  const wait = `${Math.ceil(light.until_green_secs)} s`;
  byId("start-light").dataset.color = light.color;
  write("start-light", { red: wait, amber: `Ready · ${wait}`, green: "Go" }[light.color]);
}

function gateName(gate, gates) {
  return gate === 0 ? "start and finish" : `${gate} of ${gates - 1}`;
}

function showStandings(standings) {
  const rows = standings.map(({ client, name, me, best_secs, race_secs }) => ({ client, name, me, best_secs, race_secs }));
  const now = JSON.stringify(rows);
  if (now === shown) return;
  shown = now;
  byId("standings").replaceChildren(...rows.map(({ client, name, me, best_secs, race_secs }) => {
    const item = document.createElement("li");
    item.style.setProperty("--hue", (client * 137.5) % 360);
    const text = me ? `${name} (you)` : name;
    item.append(element("b", text), element("span", race_secs === null ? time(best_secs) : `race ${time(race_secs)}`));
    item.title = `${text}: best lap ${time(best_secs)}, best race ${time(race_secs)}`;
    return item;
  }));
}

// Seconds ahead of (−) or behind (+) the best lap at the gate passed last.
function gap(secs) {
  return secs === null ? "" : ` (${secs < 0 ? "−" : "+"}${Math.abs(secs).toFixed(2)} s)`;
}

// A duration in minutes, seconds and hundredths.
function time(secs) {
  if (secs === null) return "–";
  const hundredths = Math.round(secs * 100);
  const minutes = Math.floor(hundredths / 6000);
  const rest = ((hundredths % 6000) / 100).toFixed(2);
  return minutes === 0 ? `${rest} s` : `${minutes}:${rest.padStart(5, "0")}`;
}
