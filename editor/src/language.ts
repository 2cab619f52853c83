// How a description is coloured, in both spellings.

import { yaml } from "@codemirror/lang-yaml";
import { HighlightStyle, StreamLanguage, syntaxHighlighting, type StreamParser } from "@codemirror/language";
import type { Extension } from "@codemirror/state";
import { tags } from "@lezer/highlight";

import type { Format } from "./seam.js";

interface Line {
  /** Inside quotes that go on in the next line. */
  quoted: boolean;
}

/** The plain text of Figure 4: headings, `Label: value`, `name = value; key = value`, lists in brackets. */
const editorText: StreamParser<Line> = {
  name: "mbsym-text",
  startState: () => ({ quoted: false }),
  token(stream, state) {
    if (state.quoted || stream.eat('"')) {
      state.quoted = !stream.match(/^(?:[^"\\]|\\.)*"/);
      if (state.quoted) stream.skipToEnd();
      return "string";
    }
    if (stream.eatSpace()) return null;
    if (stream.eat("#")) {
      stream.skipToEnd();
      return "comment";
    }
    const first = stream.string.slice(0, stream.start).trim() === "";
    if (first && stream.match(/^[\p{L}][\p{L}\d _/-]*(?=:(\s|$))/u)) return "propertyName";
    if (first && stream.indentation() === 0 && stream.match(/^[\p{L}][^:=#]*$/u)) return "heading";
    if (stream.match(/^(?:value|meaning|velocity|position|sign|unit)(?=\s*=)/)) return "keyword";
    if (first && stream.match(/^[\p{L}_][\p{L}\d_]*(?=\s*=)/u)) return "definition";
    if (stream.match(/^\d+(?:\.\d*)?(?:[eE][+-]?\d+)?/)) return "number";
    if (stream.match(/^[\p{L}_][\p{L}\d_]*/u)) return null;
    stream.next();
    return null;
  },
  languageData: { commentTokens: { line: "#" } },
  tokenTable: { definition: tags.definition(tags.variableName) },
};

const colours = HighlightStyle.define([
  { tag: [tags.definition(tags.propertyName), tags.propertyName, tags.definition(tags.variableName)], color: "var(--key)" },
  { tag: tags.heading, color: "var(--key)", fontWeight: "600" },
  { tag: tags.keyword, color: "var(--word)" },
  { tag: [tags.string, tags.special(tags.string), tags.attributeValue], color: "var(--string)" },
  { tag: [tags.number, tags.bool, tags.null], color: "var(--number)" },
  { tag: [tags.lineComment, tags.comment], color: "var(--comment)", fontStyle: "italic" },
  { tag: [tags.separator, tags.punctuation, tags.squareBracket, tags.brace], color: "var(--soft)" },
]);

const spellings: Record<Format, Extension> = { yaml: yaml(), text: StreamLanguage.define(editorText) };

export const coloured = syntaxHighlighting(colours);

export function language(format: Format): Extension {
  return spellings[format];
}
