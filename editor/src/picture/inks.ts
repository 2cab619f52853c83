// Colours of the page as numbers: what a custom property comes to (light-dark() and all), asked of the browser.

import { make } from "../elements.js";

export function inks<Name extends string>(host: HTMLElement, names: Record<Name, string>): Record<Name, string> {
  const probe = make("span", { hidden: true });
  host.append(probe);
  const found = {} as Record<Name, string>;
  for (const name of Object.keys(names) as Name[]) {
    probe.style.color = `var(--${name}, ${names[name]})`;
    found[name] = getComputedStyle(probe).color;
  }
  probe.remove();
  return found;
}
