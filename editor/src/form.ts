// The form: of the selected body as in Figure 3 of the paper, or of the system.

import "./form.css";
import { bodySections } from "./bodyform.js";
import { make } from "./elements.js";
import { Form } from "./fields.js";
import type { Model } from "./model.js";
import { released } from "./pressing.js";
import { systemSections } from "./systemform.js";

export function panel(host: HTMLElement, model: Model): void {
  const bodyHost = make("div", { class: "form", id: "form-body" });
  const systemHost = make("div", { class: "form", id: "form-system", hidden: true });
  const bodyForm = new Form(bodyHost, model, "body");
  const systemForm = new Form(systemHost, model, "system");
  const choices = (["body", "system"] as const).map((which) =>
    make("button", { type: "button", "aria-pressed": String(which === "body"), click: () => choose(which) }, which === "body" ? "Body" : "System"),
  );
  host.append(make("div", { class: "tools form-choice", role: "group", "aria-label": "Form of" }, ...choices), bodyHost, systemHost);

  function choose(which: "body" | "system"): void {
    bodyHost.hidden = which !== "body";
    systemHost.hidden = which !== "system";
    choices.forEach((button, index) => button.setAttribute("aria-pressed", String((index === 0) === (which === "body"))));
    show();
  }

  const nothing = make("p", { class: "hint" }, "No body is selected. Select one in the structure, or add one there.");

  function show(): void {
    const body = model.body(model.selected);
    if (systemHost.hidden) {
      bodyForm.show(body ? bodySections(model, body) : []);
      if (body) nothing.remove();
      else bodyHost.append(nothing);
    } else systemForm.show(systemSections(model));
  }

  let first = true;
  model.on("view", (view) => {
    // A system that is given by its matrices has no bodies to begin with.
    if (first && view.tree?.children?.some((one) => one.path[0] === "linear system")) choose("system");
    else released(show);
    first = false;
  });
  model.on("selection", (name) => (name === null ? show() : choose("body")));
  show();
}
