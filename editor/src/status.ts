// The line at the bottom: how the text stands, whether it is saved, and the last thing that happened.

import { counted } from "./complaints.js";
import { make } from "./elements.js";
import type { Model } from "./model.js";

export function statusOf(model: Model): HTMLElement {
  const complaints = make("span", { id: "complaint-count" }, "not looked at yet");
  const saved = make("span", { id: "saved" });
  const format = make("span", { id: "format" });
  const said = make("span", { id: "said", role: "status", "aria-live": "polite" });
  const connection = make("span", { id: "connection" });

  const tellSaved = (): void => {
    saved.textContent = model.file.new && model.text === "" ? "nothing written yet" : model.saved ? "saved" : "not saved";
    saved.classList.toggle("unsaved", !model.saved);
    document.title = `${model.saved ? "" : "• "}${model.file.name} — mbsym`;
  };
  const tellFormat = (): void => {
    format.textContent = model.format === "yaml" ? "YAML" : "editor text";
  };
  model.on("view", (view) => {
    complaints.textContent = counted(view.complaints);
    complaints.classList.toggle("wrong", view.complaints.some((one) => one.severity === "error"));
  });
  model.on("saved", tellSaved);
  model.on("file", tellSaved);
  model.on("format", tellFormat);
  model.on("said", (words) => {
    said.textContent = words;
  });
  model.on("connection", (state) => {
    connection.textContent = state === "there" ? "" : state === "away" ? "server away" : "another server";
  });
  tellSaved();
  tellFormat();
  return make("footer", { class: "status" }, complaints, saved, format, said, connection, make("span", { class: "version" }, `mbsym ${model.file.version}`));
}
