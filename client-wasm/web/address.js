// The address: what it asks for, and what the page keeps in it, so that whoever opens a copy sees the same.
// The view, #x,y,z,heading,pitch, is kept by the client itself.

// What a link holds, in this order.
const SHARED = ["scene", "quality", "budget", "order", "far", "hour", "compare", "at"];

const asked = new URLSearchParams(location.search);

// What the address asks for under a key; null for nothing.
export const ask = (key) => asked.get(key);

// Keeps values by their keys; null takes one away.
export function keep(values) {
  for (const [key, value] of Object.entries(values)) {
    if (value === null) asked.delete(key);
    else asked.set(key, value);
  }
  const own = [...asked.keys()].filter((key) => !SHARED.includes(key));
  const address = query([...SHARED, ...own]) + location.hash;
  // Some browsers refuse when the address changes often; the next change brings this one along.
  try { history.replaceState(null, "", address) } catch { /* later */ }
}

// The link to what is seen; `view` is x,y,z,heading,pitch.
export const link = (view) => `${location.origin}${location.pathname}${query(SHARED)}#${view}`;

function query(keys) {
  const pairs = keys.filter((key) => asked.has(key)).map((key) => `${key}=${encodeURIComponent(asked.get(key)).replaceAll("%2C", ",")}`);
  return `?${pairs.join("&")}`;
}
