// Light or dark: as the system says, unless it is chosen here.

import { make } from "./elements.js";
import type { Model } from "./model.js";

const KEPT = "mbsym.theme";
const WORDS = { system: "System colours", light: "Light", dark: "Dark" } as const;
type Choice = keyof typeof WORDS;

const dark = window.matchMedia("(prefers-color-scheme: dark)");

function kept(): Choice {
  try {
    const found = localStorage.getItem(KEPT);
    return found === "light" || found === "dark" ? found : "system";
  } catch {
    return "system";
  }
}

function currentTheme(): "light" | "dark" {
  const chosen = document.documentElement.dataset["theme"];
  return chosen === "light" || chosen === "dark" ? chosen : dark.matches ? "dark" : "light";
}

export function themeOf(model: Model): HTMLElement {
  const select = make("select", { "aria-label": "Colours", id: "theme" });
  for (const [value, words] of Object.entries(WORDS)) select.append(make("option", { value }, words));
  function set(choice: Choice): void {
    if (choice === "system") delete document.documentElement.dataset["theme"];
    else document.documentElement.dataset["theme"] = choice;
    model.themeChanged(currentTheme());
  }
  select.value = kept();
  set(kept());
  select.addEventListener("change", () => {
    try {
      localStorage.setItem(KEPT, select.value);
    } catch {
      // Not remembered, then.
    }
    set(select.value as Choice);
  });
  dark.addEventListener("change", () => model.themeChanged(currentTheme()));
  return select;
}
