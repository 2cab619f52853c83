// The complaints as a list beneath the text: each is a button that leads to its place.

import { make } from "./elements.js";
import type { Model } from "./model.js";
import { released } from "./pressing.js";
import type { Complaint, View } from "./seam.js";

/** "2 mistakes, 1 warning"; what the status line says, too. */
export function counted(complaints: Complaint[]): string {
  const errors = complaints.filter((one) => one.severity === "error").length;
  const warnings = complaints.length - errors;
  const parts = [];
  if (errors > 0) parts.push(errors === 1 ? "1 mistake" : `${errors} mistakes`);
  if (warnings > 0) parts.push(warnings === 1 ? "1 warning" : `${warnings} warnings`);
  return parts.join(", ") || "no complaints";
}

export function complaintList(model: Model, go: (complaint: Complaint) => void): HTMLElement {
  const words = make("span", { role: "status" }, "");
  const list = make("ol", {});
  const details = make("details", { class: "complaints", open: true }, make("summary", {}, words), list);

  function shown(view: View): void {
    details.hidden = view.complaints.length === 0;
    words.textContent = counted(view.complaints);
    list.replaceChildren(
      ...view.complaints.map((one) =>
        make(
          "li",
          {},
          make(
            "button",
            { type: "button", class: `complaint ${one.severity}`, click: () => go(one) },
            make("span", { class: "place" }, `${one.line}:${one.column}`),
            make("span", { class: "severity" }, one.severity === "error" ? "mistake" : "warning"),
            make("span", { class: "message" }, one.message, one.hint ? make("span", { class: "hint" }, ` ${one.hint}`) : null),
          ),
        ),
      ),
    );
  }
  let told = "";
  model.on("view", (view) => {
    // What says the same stays: a button may have the focus, or be pressed.
    const now = JSON.stringify(view.complaints);
    if (now === told) return;
    told = now;
    released(() => shown(view));
  });
  details.hidden = true;
  return details;
}
