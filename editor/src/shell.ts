// The page around the panels: what stands where, the menu, the status line, keys that hold everywhere.

import { panel as formPanel } from "./form.js";
import { panel as graphPanel } from "./graph.js";
import { make } from "./elements.js";
import { Model, opened } from "./model.js";
import { panel as picturePanel } from "./picture.js";
import { panel as resultsPanel } from "./results.js";
import { extensions, panel as textPanel } from "./text.js";

type Panel = (host: HTMLElement, model: Model) => void;

export const PANELS: { name: string; title: string; panel: Panel }[] = [
  { name: "graph", title: "Structure", panel: graphPanel },
  { name: "form", title: "Body and system", panel: formPanel },
  { name: "text", title: "Text", panel: textPanel },
  { name: "picture", title: "Picture", panel: picturePanel },
  { name: "results", title: "Results", panel: resultsPanel },
];

export async function start(host: HTMLElement): Promise<void> {
  const model = await opened(extensions, document);
  const main = make("main", { class: "panels" });
  for (const { name, title, panel } of PANELS) {
    const inside = make("div", { class: `panel-body ${name}-host` });
    const heading = make("h2", { id: `${name}-title` }, title);
    main.append(make("section", { id: name, class: "panel", "aria-labelledby": heading.id, tabindex: -1 }, heading, inside));
    panel(inside, model);
  }
  host.replaceChildren(main);
  model.listen();
  await model.look();
}
