// Questions and lists in front of the page: the browser's own modal dialogs, which keep the focus and know Escape.

import { make } from "./elements.js";

let counted = 0;

export interface Choice<Value> {
  words: string;
  value: Value;
  main?: boolean;
  danger?: boolean;
}

/** Shows `content` with one button for each choice; Escape answers `otherwise`. */
export function ask<Value>(
  title: string,
  content: (Node | string)[],
  choices: Choice<Value>[],
  otherwise: Value,
): Promise<Value> {
  counted += 1;
  const heading = make("h2", { id: `dialog-${counted}` }, title);
  const body = make("div", { class: "dialog-body" }, ...content);
  const buttons = make("div", { class: "dialog-buttons" });
  const form = make("form", { method: "dialog" }, heading, body, buttons);
  const dialog = make("dialog", { "aria-labelledby": heading.id }, form);
  const before = document.activeElement;
  return new Promise((resolve) => {
    let answer = otherwise;
    for (const choice of choices) {
      const kind = choice.danger ? "danger" : choice.main ? "main" : "plain";
      const button = make("button", { type: choice.main ? "submit" : "button", class: kind }, choice.words);
      button.addEventListener("click", (event) => {
        event.preventDefault();
        answer = choice.value;
        dialog.close();
      });
      buttons.append(button);
    }
    // Chromium hands Enter in a field to the first submit button: the main choice.
    dialog.addEventListener("close", () => {
      dialog.remove();
      if (before instanceof HTMLElement || before instanceof SVGElement) before.focus();
      resolve(answer);
    });
    // In a list it would open the list (the space bar and Alt with an arrow do): there it means the same.
    form.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" || !(event.target instanceof HTMLSelectElement) || event.target.matches(":open")) return;
      event.preventDefault();
      buttons.querySelector<HTMLButtonElement>("button[type=submit]")?.click();
    });
    document.body.append(dialog);
    dialog.showModal();
    const first = dialog.querySelector<HTMLElement>("[autofocus], input, select, button.main");
    first?.focus();
    if (first instanceof HTMLInputElement) first.select();
  });
}

export async function confirmed(title: string, content: (Node | string)[], words: string): Promise<boolean> {
  return ask(title, content, [
    { words, value: true, main: true },
    { words: "Cancel", value: false },
  ], false);
}

/** One line of text; null where it is given up. */
export async function asked(title: string, label: string, value: string, words = "OK"): Promise<string | null> {
  const input = make("input", { type: "text", value, autocomplete: "off", spellcheck: "false", autofocus: true });
  const done = await confirmed(title, [make("label", {}, label, " ", input)], words);
  const typed = input.value.trim();
  return done && typed !== "" ? typed : null;
}
