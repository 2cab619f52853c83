// Formulas copied for LaTeX, Wolfram and Python: what the server has spelled, from the formula that was pointed at.

import { make } from "./elements.js";
import type { Model } from "./model.js";

const LANGUAGES: [string, string][] = [
  ["latex", "LaTeX"],
  ["wolfram", "Wolfram"],
  ["python", "Python"],
];

/** A click on a formula, or Enter on one with the focus, offers what it can be copied as; Escape takes it away. */
export function copying(host: HTMLElement, model: Model): void {
  let bar: HTMLElement | null = null;
  let marked: Element | null = null;

  function close(): void {
    bar?.remove();
    marked?.classList.remove("to-copy");
    [bar, marked] = [null, null];
  }

  function offer(formula: Element, focus: boolean): void {
    close();
    marked = formula;
    formula.classList.add("to-copy");
    const buttons = LANGUAGES.map(([key, words]) => {
      const text = formula.getAttribute(`data-${key}`);
      return make("button", { type: "button", disabled: text === null, click: () => void copy(text ?? "", words) }, words);
    });
    bar = make("div", { class: "copy-bar", role: "toolbar", "aria-label": "Copy the formula as" }, make("span", {}, "Copy as"), ...buttons);
    (formula.closest(".formula, p, li, dd, td, th") ?? formula).after(bar);
    if (focus) buttons[0]?.focus();
  }

  async function copy(text: string, words: string): Promise<void> {
    const back = marked;
    try {
      await navigator.clipboard.writeText(text);
      model.say(`copied as ${words}`);
    } catch {
      model.say("the browser does not let it be copied");
    }
    close();
    if (back instanceof HTMLElement) back.focus();
  }

  host.addEventListener("click", (event) => {
    const target = event.target;
    if (!(target instanceof Element) || bar?.contains(target)) return;
    const formula = target.closest("[data-latex]");
    if (formula !== null && window.getSelection()?.isCollapsed !== false) offer(formula, false);
    else close();
  });
  host.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && bar !== null) {
      const back = marked;
      close();
      if (back instanceof HTMLElement) back.focus();
      event.stopPropagation();
    } else if (event.key === "Enter" && event.target instanceof Element && event.target.matches("[data-latex]")) {
      event.preventDefault();
      offer(event.target, true);
    }
  });
}
