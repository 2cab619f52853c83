// The markdown of explanations, as elements: paragraphs, lists, `code`, **strong**.  Everything else stays text.

import { make } from "./elements.js";

function inline(host: HTMLElement, words: string): void {
  for (const part of words.split(/(`[^`\n]+`|\*\*[^*\n]+\*\*)/)) {
    if (part.startsWith("`") && part.endsWith("`") && part.length > 2) host.append(make("code", {}, part.slice(1, -1)));
    else if (part.startsWith("**") && part.endsWith("**") && part.length > 4) {
      host.append(make("strong", {}, part.slice(2, -2)));
    } else if (part !== "") host.append(part);
  }
}

export function explained(markdown: string): HTMLElement {
  const host = make("div", { class: "explained" });
  let fenced: HTMLElement | null = null;
  for (const block of markdown.split("\n")) {
    if (block.trimStart().startsWith("```")) {
      if (fenced === null) host.append((fenced = make("pre")));
      else fenced = null;
    } else if (fenced !== null) fenced.append(`${block}\n`);
    else if (/^\s*[-*] /.test(block)) {
      const item = make("div", { class: "item" });
      inline(item, `• ${block.replace(/^\s*[-*] /, "")}`);
      host.append(item);
    } else if (block.trim() !== "") {
      const paragraph = make("p");
      inline(paragraph, block.replace(/^#+ /, ""));
      host.append(paragraph);
    }
  }
  return host;
}
