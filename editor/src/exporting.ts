// Reports written beside the file, as `mbsym run` writes them.

import { make } from "./elements.js";
import type { Model } from "./model.js";
import { wordsOf } from "./server.js";

export function exporting(model: Model): HTMLElement {
  const formats = (model.file as unknown as { formats?: { name: string; title: string }[] }).formats ?? [];
  const format = make("select", { id: "export-format" }, ...formats.map((x) => make("option", { value: x.name }, `${x.name}: ${x.title}`)));
  const language = make("select", { id: "export-language" }, make("option", { value: "" }, "as described"), ...model.file.languages.map((x) => make("option", { value: x }, x)));
  const said = make("p", { role: "status", class: "exported" });
  const button = make("button", { type: "button", id: "export", click: () => void write() }, "Write the report");

  async function write(): Promise<void> {
    button.disabled = true;
    said.textContent = "Being derived and written …";
    try {
      const answer = await model.request<{ files: string[]; words: string[] }>("export", { to: format.value, language: language.value });
      said.textContent = [`Written: ${answer.files.join(", ")}`, ...answer.words].join(". ");
    } catch (failure) {
      said.textContent = wordsOf(failure);
    }
    button.disabled = false;
  }

  return make(
    "details",
    { class: "exporting" },
    make("summary", {}, "Reports as files"),
    make("div", { class: "row" }, make("label", { for: "export-format" }, "Format "), format),
    make("div", { class: "row" }, make("label", { for: "export-language" }, "Language of LaTeX "), language, button),
    said,
  );
}
