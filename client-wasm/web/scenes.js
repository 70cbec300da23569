// The menu of scenes: a picture and a description of each, and the change to one, which is for everyone on the server.

import { byId, element } from "./elements.js";

export class SceneMenu {
  // `notify(text)` shows a line for a while.
  constructor(notify) {
    this.notify = notify;
    this.dialog = byId("scenes");
    byId("show-scenes").addEventListener("click", () => this.toggle());
    this.dialog.addEventListener("click", (event) => event.target === this.dialog && this.dialog.close());
    byId("scene-list").addEventListener("click", ({ target }) => {
      const button = target.closest("button");
      if (button && button.getAttribute("aria-disabled") !== "true") this.change(button.dataset.scene);
    });
    addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || event.repeat || event.target.closest?.("input, select")) return;
      if (event.key.toLowerCase() !== "o") return;
      event.preventDefault();
      this.toggle();
    });
  }

  toggle() {
    if (this.dialog.open) return this.dialog.close();
    if (byId("prairie").inert) return;
    byId("help").close();
    this.dialog.showModal();
    this.fill();
  }

  // Asks the server for its scenes and shows them.
  async fill() {
    try {
      const response = await running(() => fetch("api/scenes"));
      if (!response.ok) throw new Error(`${response.status} ${response.statusText}`);
      const { running: current, pages_may_change: open, scenes } = await response.json();
      this.say(open
        ? "A scene that you choose is started for everyone on this server. Each has a world of its own."
        : "This server keeps its scene. On a machine of your own, the command in a card starts that one.");
      byId("scene-list").replaceChildren(...scenes.map((scene) => card(scene, scene.name === current, open)));
    } catch (error) {
      this.say(`The server does not list its scenes: ${error.message}`);
    }
  }

  // Starts a scene, and closes the menu when its world is ready.
  async change(name) {
    this.say(`Starting ${name}…`);
    this.freeze(true);
    try {
      const response = await fetch("api/scene", { method: "POST", body: JSON.stringify({ name }) });
      const { error } = await response.json();
      if (error) return this.say(`${error[0].toUpperCase()}${error.slice(1)}.`);
      this.dialog.close();
      this.notify(`The scene is ${name} now.`);
    } catch (error) {
      this.say(`The server does not answer: ${error.message}`);
    } finally {
      this.freeze(false);
    }
  }

  freeze(frozen) {
    for (const button of byId("scene-list").querySelectorAll("button")) button.setAttribute("aria-disabled", String(frozen));
  }

  say(text) {
    byId("scenes-note").textContent = text;
  }
}

// The answer of the running world. That of one that has just stopped is 503, and ends the connection to it.
async function running(ask) {
  const first = await ask();
  return first.status === 503 ? ask() : first;
}

// A scene as a button, or, where the scene cannot be changed, as a text with its command.
function card({ name, summary, methods, picture }, isRunning, open) {
  const card = document.createElement(open ? "button" : "div");
  card.className = "card";
  if (open) Object.assign(card, { type: "button" }).dataset.scene = name;
  if (isRunning) card.setAttribute("aria-current", "true");
  if (picture) {
    const image = new Image(256, 144);
    Object.assign(image, { src: `api/scenes/${encodeURIComponent(name)}/picture`, alt: "", loading: "lazy" });
    card.append(image);
  }
  card.append(element("b", isRunning ? `${name} (running)` : name), element("span", summary));
  for (const method of methods) card.append(element("small", method));
  if (!open && picture) card.append(element("code", `prairie ${name}`));
  const item = document.createElement("li");
  item.append(card);
  return item;
}
