// The page around the panels: what stands where, the menu, the status line, keys that hold everywhere.

import { bannersOf } from "./banners.js";
import { make } from "./elements.js";
import { commandsOf, keysOf, type Command } from "./commands.js";
import { panel as formPanel } from "./form.js";
import { panel as graphPanel } from "./graph.js";
import { Model, opened } from "./model.js";
import { arranged } from "./panels.js";
import { panel as picturePanel } from "./picture.js";
import { panel as resultsPanel } from "./results.js";
import { wordsOf } from "./server.js";
import { statusOf } from "./status.js";
import { extensions, panel as textPanel } from "./text.js";
import { themeOf } from "./theme.js";

export interface Part {
  name: string;
  title: string;
  panel: (host: HTMLElement, model: Model) => void;
}

const PARTS: Part[] = [
  { name: "graph", title: "Structure", panel: graphPanel },
  { name: "form", title: "Body and system", panel: formPanel },
  { name: "text", title: "Text", panel: textPanel },
  { name: "picture", title: "Picture", panel: picturePanel },
  { name: "results", title: "Results", panel: resultsPanel },
];

function header(model: Model, commands: Command[]): HTMLElement {
  const title = make("h1", {}, "mbsym ", make("span", { class: "file-name", title: model.file.path }, model.file.name));
  const buttons = commands
    .filter((command) => command.button)
    .map((command) => {
      const button = make(
        "button",
        {
          type: "button",
          id: `do-${command.id}`,
          title: command.keys ? `${command.words} (${command.keys})` : command.words,
          "aria-keyshortcuts": command.keys?.replaceAll("Ctrl", "Control") ?? null,
          click: () => void command.act(),
        },
        command.button!,
      );
      const enabled = (): void => {
        button.disabled = command.enabled ? !command.enabled() : false;
        button.textContent = typeof command.label === "function" ? command.label() : command.button!;
      };
      for (const event of ["text", "saved", "format", "view"] as const) model.on(event, () => queueMicrotask(enabled));
      enabled();
      return button;
    });
  return make("header", { class: "top" }, title, make("div", { class: "menu", role: "toolbar", "aria-label": "Document" }, ...buttons, themeOf(model)));
}

export async function start(host: HTMLElement): Promise<void> {
  const textPlace = make("div", { class: "text-shadow" });
  const shadow = textPlace.attachShadow({ mode: "open" });
  let model: Model;
  try {
    model = await opened(extensions, shadow);
  } catch (failure) {
    host.replaceChildren(make("p", { class: "waiting", role: "alert" }, wordsOf(failure)));
    return;
  }
  document.title = `${model.file.name} — mbsym`;
  const commands = commandsOf(model);
  const { main, skips, show } = arranged(PARTS, model);
  host.replaceChildren(skips, header(model, commands), bannersOf(model), main, statusOf(model));
  keysOf(commands, show);
  window.addEventListener("beforeunload", (event) => {
    if (!model.saved) event.preventDefault();
  });
  // Whether what is shown is of the text as it is: scripts that drive the page wait for it.
  const root = document.documentElement;
  for (const event of ["text", "view", "busy"] as const) {
    model.on(event, () => (root.dataset["fresh"] = String(model.fresh && !model.busy)));
  }
  const looked = model.look();
  model.listen();
  await looked;
}
