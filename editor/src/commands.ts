// What can be done to the document as a whole, with its button and its keys; and keys that hold everywhere.

import { beginnings } from "./beginning.js";
import { ask } from "./dialogs.js";
import { isTyping, make } from "./elements.js";
import type { Model } from "./model.js";
import type { Format } from "./seam.js";

export interface Command {
  id: string;
  words: string;
  keys?: string;
  /** What stands on its button; none: by keys alone. */
  button?: string;
  label?: () => string;
  enabled?: () => boolean;
  act: () => unknown;
}

export function commandsOf(model: Model): Command[] {
  return [
    { id: "new", words: "Begin anew: from a joint, an example, a text", button: "New", act: () => begin(model) },
    { id: "save", words: "Save", keys: "Ctrl+S", button: "Save", enabled: () => !model.saved, act: () => save(model) },
    { id: "undo", words: "Undo, in every view", keys: "Ctrl+Z", button: "Undo", enabled: () => model.undoable, act: () => model.undo() },
    { id: "redo", words: "Redo", keys: "Ctrl+Shift+Z", button: "Redo", enabled: () => model.redoable, act: () => model.redo() },
    {
      id: "convert",
      words: "Convert between YAML and the plain text of the description editor",
      button: "As text",
      label: () => (model.format === "yaml" ? "As plain text" : "As YAML"),
      act: () => convert(model),
    },
    { id: "keys", words: "Keys", keys: "?", button: "Keys", act: () => showKeys() },
  ];
}

/** The lines in which two texts differ, from the first to the last. */
function difference(theirs: string, ours: string): HTMLElement {
  const [a, b] = [theirs.split("\n"), ours.split("\n")];
  let first = 0;
  while (first < a.length && first < b.length && a[first] === b[first]) first += 1;
  let [endA, endB] = [a.length, b.length];
  while (endA > first && endB > first && a[endA - 1] === b[endB - 1]) [endA, endB] = [endA - 1, endB - 1];
  const lines = (words: string, from: string[]): HTMLElement =>
    make("div", {}, make("h3", {}, words), make("pre", { tabindex: 0 }, from.slice(0, 200).join("\n") || "(nothing)"));
  return make(
    "div",
    { class: "difference" },
    lines(`In the file, lines ${first + 1} to ${endA}`, a.slice(first, endA)),
    lines(`Here, lines ${first + 1} to ${endB}`, b.slice(first, endB)),
  );
}

export async function save(model: Model): Promise<void> {
  const answer = await model.save();
  if (answer.saved) return model.say(`${model.file.name} saved`);
  if (answer.other === null) return;
  const { digest, text } = answer.other;
  if (digest === "") {
    // Taken away meanwhile: nothing is there that would be lost.
    model.fileIsGone();
    if ((await model.save()).saved) model.say(`${model.file.name} saved; it had been deleted or moved away meanwhile`);
    return;
  }
  const choice = await ask(
    "The file was changed by someone else",
    [make("p", {}, `${model.file.name} is no longer what this page last read. Nothing was written.`), difference(text, model.text)],
    [
      { words: "Write mine over it", value: "mine", danger: true },
      { words: "Take theirs", value: "theirs" },
      { words: "Cancel", value: "none", main: true },
    ],
    "none",
  );
  if (choice === "mine") {
    const again = await model.save(true);
    if (again.saved) model.say(`${model.file.name} saved over the other text`);
  } else if (choice === "theirs") {
    model.fileIs(digest, text);
    model.replaceText(text);
    model.say("theirs is here; undo brings the other text back");
  }
}

async function convert(model: Model): Promise<void> {
  const to: Format = model.format === "yaml" ? "text" : "yaml";
  if (await model.convert(to)) model.say(to === "yaml" ? "converted to YAML" : "converted to the plain text of the editor");
}

async function begin(model: Model): Promise<void> {
  const cards = beginnings(model, () => cards.closest("dialog")?.close());
  await ask("Begin anew", [make("p", {}, "The text here is replaced; one undo brings it back."), cards], [{ words: "Cancel", value: null }], null);
}

const KEYS: [string, [string, string][]][] = [
  ["Everywhere", [
    ["Ctrl+S", "save"],
    ["Ctrl+Z, Ctrl+Shift+Z, Ctrl+Y", "undo, redo, in every view"],
    ["F6, Shift+F6", "next panel, panel before"],
    ["Alt+Shift+1 … 5", "structure, form, text, picture, results"],
    ["? or F1", "these keys"],
  ]],
  ["Structure", [
    ["arrows", "up: what it hangs on; down: what hangs on it; left, right: beside it"],
    ["A or Insert", "add a body on this one"],
    ["L", "add a load, on this body"],
    ["C", "add a constraint, of this body"],
    ["F2", "rename"],
    ["D", "duplicate with what hangs on it"],
    ["X, then V", "take the body up, hang it on another one (or drag it there)"],
    ["Delete", "delete with what hangs on it; asks"],
    ["− and +", "fold and unfold what hangs on it"],
    ["Enter", "to the body's form"],
  ]],
  ["Text", [
    ["Ctrl+Space", "what may stand here"],
    ["F8, Ctrl+Shift+M", "next complaint, all complaints"],
    ["Ctrl+F", "search"],
    ["Ctrl+] and Ctrl+[", "indent more, less (Tab leaves the text)"],
    ["Ctrl+Shift+[ and ]", "fold, unfold"],
  ]],
  ["Between panels", [["arrows", "on a line between panels: move it"]]],
];

async function showKeys(): Promise<void> {
  const content = KEYS.flatMap(([title, keys]) => [
    make("h3", {}, title),
    make("dl", { class: "keys" }, ...keys.flatMap(([key, words]) => [make("dt", {}, make("kbd", {}, key)), make("dd", {}, words)])),
  ]);
  await ask("Keys", content, [{ words: "Close", value: null, main: true }], null);
}

export function keysOf(commands: Command[], show: (name: string) => void): void {
  const act = (id: string): void => void commands.find((command) => command.id === id)?.act();
  const panels = ["graph", "form", "text", "picture", "results"];
  document.addEventListener("keydown", (event) => {
    if (document.querySelector("dialog[open]")) return;
    const control = event.ctrlKey || event.metaKey;
    const key = event.key.toLowerCase();
    const typing = isTyping(event.target);
    let done = true;
    if (control && key === "s") act("save");
    else if (control && !typing && key === "z") act(event.shiftKey ? "redo" : "undo");
    else if (control && !typing && key === "y") act("redo");
    else if (event.key === "F1" || (event.key === "?" && !typing && !control)) act("keys");
    else if (event.key === "F6") {
      const here = document.activeElement?.closest("section.panel")?.id ?? "";
      const step = event.shiftKey ? -1 : 1;
      const from = panels.indexOf(here);
      show(panels[(Math.max(from, event.shiftKey ? 0 : -1) + step + panels.length) % panels.length]!);
    } else if (event.altKey && event.shiftKey && /^Digit[1-5]$/.test(event.code)) show(panels[Number(event.code.slice(5)) - 1]!);
    else done = false;
    if (done) event.preventDefault();
  });
}
