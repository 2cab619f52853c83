import type { Model } from "./model.js";

export const extensions = [];

export function panel(host: HTMLElement, model: Model): void {
  const shadow = host.attachShadow({ mode: "open" });
  shadow.append(model.editor.dom);
  model.editor.setRoot(shadow);
}
