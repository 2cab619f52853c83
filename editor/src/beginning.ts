// Three ways to begin a description: from a joint, from an example, from a text that is pasted.

import { make } from "./elements.js";
import type { Model } from "./model.js";
import type { Format, View } from "./seam.js";
import { wordsOf } from "./server.js";

/** What the server begins with: a joint by its name, an example (null: an empty description), a text. */
type Beginning = { joint: string } | { example: string | null } | { pasted: string };

/** Whether nothing has been described yet: then that there are no bodies is no mistake. */
export function isUnbegun(view: View): boolean {
  const [first, ...more] = view.complaints;
  return view.bodies.length === 0 && first?.code === "no-bodies" && more.every((one) => one.severity !== "error");
}

export async function begin(model: Model, beginning: Beginning, said: string): Promise<boolean> {
  try {
    const found = await model.post<{ text: string; format: Format }>("begin", beginning);
    model.replaceText(found.text, found.format);
    await model.look();
    model.select("joint" in beginning ? "body" : null); // the next one is added on it
    model.say(said);
    return true;
  } catch (failure) {
    model.say(wordsOf(failure));
    return false;
  }
}

/** The cards; `done` is told when one of them has begun a description. */
export function beginnings(model: Model, done: () => void = () => undefined): HTMLElement {
  const start = (beginning: Beginning, said: string) => async () => void ((await begin(model, beginning, said)) && done());
  const joints = (model.file.joints ?? []).filter(({ name }) => name !== "fixed").map(({ name, title }) =>
    make("button", { type: "button", title, click: start({ joint: name }, `one body on a ${name} joint is here; undo takes it back`) }, make("b", {}, name), ` ${title.split(",")[0]}`),
  );
  const select = make("select", { size: 7, "aria-label": "Begin from" }, make("option", { value: "" }, "an empty description"));
  for (const { name, title } of model.file.examples ?? []) select.append(make("option", { value: name }, `${name}: ${title}`));
  select.value = model.file.examples?.[0]?.name ?? "";
  const example = (): Promise<void> =>
    start({ example: select.value || null }, select.value ? `${select.value} is here` : "an empty description is here")();
  select.addEventListener("dblclick", () => void example());
  const pasted = make("textarea", { rows: 4, spellcheck: "false", "aria-label": "A description, a filled-in form, a URDF or MJCF file" });
  return make(
    "div",
    { class: "beginnings" },
    card("From a joint", "One body, all in symbols.", make("div", { class: "joints" }, ...joints)),
    card("From an example", "A published system, or nothing.", select, make("button", { type: "button", click: () => void example() }, "Begin with it")),
    card(
      "From a text",
      "Paste a description, a filled-in form, a URDF or MJCF.",
      pasted,
      make("button", { type: "button", click: () => void start({ pasted: pasted.value }, "what was pasted is here")() }, "Take it"),
    ),
  );
}

function card(title: string, words: string, ...content: HTMLElement[]): HTMLElement {
  return make("section", { class: "card" }, make("h3", {}, title), make("p", {}, words), ...content);
}
