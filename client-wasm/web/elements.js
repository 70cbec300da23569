// Building elements without parsing HTML, which the page's policy (Trusted Types) forbids.

export const byId = (id) => document.getElementById(id);

// Sets the text of the element with an id, if it is another.
export function write(id, text) {
  const node = byId(id);
  if (node.textContent !== text) node.textContent = text;
}

// A new element with a text.
export function element(name, text = "", className = "") {
  const node = document.createElement(name);
  node.textContent = text;
  if (className) node.className = className;
  return node;
}

// A new element with a text in which parts between backticks become elements `inner`, such as `code` or `kbd`.
export function marked(name, text, inner) {
  const node = document.createElement(name);
  node.append(...text.split("`").map((part, index) => (index % 2 ? element(inner, part) : part)));
  return node;
}
