// The page's address: its parameters, and the settings stored in it, so that a copied link shows the same picture.
// The client itself stores the view, #x,y,z,heading,pitch.

// Parameters of a shared link, in this order.
const SHARED = ["scene", "quality", "budget", "order", "far", "wind", "show", "hour", "compare", "at"];

const parameters = new URLSearchParams(location.search);

// Parameter of the address; null if it is absent.
export const parameter = (key) => parameters.get(key);

// Stores parameters in the address; null removes one.
export function keep(values) {
  for (const [key, value] of Object.entries(values)) {
    if (value === null) parameters.delete(key);
    else parameters.set(key, value);
  }
  const own = [...parameters.keys()].filter((key) => !SHARED.includes(key));
  const address = query([...SHARED, ...own]) + location.hash;
  // Some browsers reject frequent changes; the next change includes this one.
  try { history.replaceState(null, "", address) } catch { /* included in the next change */ }
}

// Link to the current picture; `view` is x,y,z,heading,pitch.
export const link = (view) => `${location.origin}${location.pathname}${query(SHARED)}#${view}`;

function query(keys) {
  const pairs = keys.filter((key) => parameters.has(key)).map((key) => `${key}=${encodeURIComponent(parameters.get(key)).replaceAll("%2C", ",")}`);
  return `?${pairs.join("&")}`;
}
