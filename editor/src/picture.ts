import type { Model } from "./model.js";

export function panel(host: HTMLElement, model: Model): void {
  model.on("view", () => undefined);
  host.replaceChildren();
}
