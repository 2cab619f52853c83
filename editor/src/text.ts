// The description as text: colours, completion, explanations, complaints in place, the selected body marked.

import { acceptCompletion, autocompletion, closeBrackets, completionKeymap, type CompletionContext, type CompletionResult } from "@codemirror/autocomplete";
import { defaultKeymap, historyKeymap } from "@codemirror/commands";
import { bracketMatching, foldGutter, foldKeymap, indentOnInput, indentUnit } from "@codemirror/language";
import { lintGutter, lintKeymap, setDiagnostics, type Diagnostic } from "@codemirror/lint";
import { highlightSelectionMatches, openSearchPanel, searchKeymap } from "@codemirror/search";
import { Compartment, StateEffect, StateField, type Extension, type Text } from "@codemirror/state";
import { Decoration, drawSelection, EditorView, highlightActiveLine, highlightActiveLineGutter, highlightSpecialChars, hoverTooltip, keymap, lineNumbers, type DecorationSet } from "@codemirror/view";

import { complaintList } from "./complaints.js";
import { coloured, language } from "./language.js";
import { explained } from "./marks.js";
import type { Model } from "./model.js";
import type { Complaint, Completion } from "./seam.js";

const spelled = new Compartment();
const helped = new Compartment();

const KINDS: Record<string, string> = { key: "property", name: "variable", body: "class", function: "function", word: "enum" };

/** The lines of the selected body. */
const marked = StateEffect.define<{ from: number; to: number } | null>();
const selectedLines = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(lines, transaction) {
    let now = lines.map(transaction.changes);
    for (const effect of transaction.effects) {
      if (!effect.is(marked)) continue;
      now = Decoration.none;
      if (effect.value === null) continue;
      const doc = transaction.state.doc;
      const [first, last] = [doc.lineAt(Math.min(effect.value.from, doc.length)), doc.lineAt(Math.min(Math.max(effect.value.from, lastInk(doc, effect.value.to)), doc.length))];
      const all = [];
      for (let line = first.number; line <= last.number; line += 1) {
        all.push(Decoration.line({ class: "cm-selected-body" }).range(doc.line(line).from));
      }
      now = Decoration.set(all);
    }
    return now;
  },
  provide: (field) => EditorView.decorations.from(field),
});

/** The last character of a range that is not blank. */
function lastInk(doc: Text, to: number): number {
  const end = Math.min(to, doc.length);
  const before = doc.sliceString(Math.max(0, end - 2000), end);
  return end - (before.length - before.trimEnd().length) - (before.trimEnd().length > 0 ? 1 : 0);
}

const looks = EditorView.theme({
  "&": { height: "100%", color: "var(--front)", backgroundColor: "var(--back)", fontSize: "13px" },
  "&.cm-focused": { outline: "2px solid var(--focus)", outlineOffset: "-2px" },
  ".cm-scroller": { fontFamily: "var(--mono)", lineHeight: "1.5" },
  ".cm-content": { caretColor: "var(--front)" },
  ".cm-cursor, .cm-dropCursor": { borderLeftColor: "var(--front)" },
  ".cm-gutters": { backgroundColor: "var(--panel)", color: "var(--soft)", border: "none", borderRight: "1px solid var(--line)" },
  ".cm-activeLine": { backgroundColor: "var(--hover)" },
  ".cm-activeLineGutter": { backgroundColor: "var(--hover)", color: "var(--front)" },
  ".cm-selected-body": { boxShadow: "inset 3px 0 0 var(--accent)" },
  "&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground": { backgroundColor: "var(--marked)" },
  ".cm-selectionMatch": { backgroundColor: "var(--marked)" },
  "&.cm-focused .cm-matchingBracket": { backgroundColor: "var(--marked)", outline: "1px solid var(--accent)" },
  ".cm-tooltip": { backgroundColor: "var(--panel)", color: "var(--front)", border: "1px solid var(--line)", borderRadius: "6px", maxWidth: "34rem", boxShadow: "0 4px 16px #0004" },
  ".cm-tooltip .explained": { padding: "0.4rem 0.7rem", font: "14px/1.45 var(--sans)", maxHeight: "18rem", overflow: "auto" },
  ".explained p": { margin: "0.25rem 0" },
  ".explained code, .explained pre": { fontFamily: "var(--mono)", fontSize: "12px", color: "var(--key)" },
  ".cm-tooltip-autocomplete ul li[aria-selected]": { backgroundColor: "var(--accent)", color: "var(--on-accent)" },
  ".cm-completionDetail": { fontStyle: "normal", opacity: "0.75" },
  ".cm-diagnostic": { padding: "0.3rem 0.6rem", font: "14px/1.4 var(--sans)", whiteSpace: "pre-wrap" },
  ".cm-diagnostic-error": { borderLeft: "4px solid var(--error)" },
  ".cm-diagnostic-warning": { borderLeft: "4px solid var(--warn)" },
  ".cm-panels": { backgroundColor: "var(--panel)", color: "var(--front)", borderColor: "var(--line)" },
  ".cm-textfield": { backgroundColor: "var(--back)", color: "var(--front)", border: "1px solid var(--line)" },
  ".cm-button": { backgroundImage: "none", backgroundColor: "var(--hover)", color: "var(--front)", border: "1px solid var(--line)" },
  ".cm-foldPlaceholder": { backgroundColor: "var(--hover)", color: "var(--soft)", border: "none" },
});

/** What the text's editor is made with, before there is a model. */
export const extensions: Extension = [
  lineNumbers(),
  foldGutter(),
  lintGutter(),
  highlightActiveLine(),
  highlightActiveLineGutter(),
  drawSelection(),
  // What would not be seen, or turns what is written around it, is shown as what it is.
  highlightSpecialChars(),
  EditorView.lineWrapping,
  indentOnInput(),
  indentUnit.of("  "),
  bracketMatching(),
  closeBrackets(),
  highlightSelectionMatches(),
  selectedLines,
  coloured,
  looks,
  spelled.of([]),
  helped.of([]),
  EditorView.contentAttributes.of({ "aria-label": "The description as text", spellcheck: "false" }),
  // Tab leaves the text as everywhere on the page; Control-] and [ indent.
  keymap.of([
    { key: "Tab", run: acceptCompletion },
    { key: "Mod-f", run: openSearchPanel },
    ...completionKeymap,
    ...lintKeymap,
    ...searchKeymap,
    ...historyKeymap,
    ...foldKeymap,
    ...defaultKeymap,
  ]),
];

function completion(model: Model) {
  return async (context: CompletionContext): Promise<CompletionResult | null> => {
    const before = context.matchBefore(/[\p{L}\d_]+/u);
    const opening = context.matchBefore(/(?:[:,[{=-] ?|\n *)$/);
    if (!context.explicit && !before && !opening) return null;
    const answer = await model.request<Completion>("complete", { offset: context.pos }).catch(() => null);
    if (answer === null || context.aborted || answer.items.length === 0) return null;
    return {
      from: answer.from,
      validFor: /^[\p{L}\d_]*$/u,
      options: answer.items.map((item) => ({
        label: item.label,
        type: KINDS[item.kind] ?? "text",
        detail: item.detail,
        apply: item.insert,
        ...(item.documentation ? { info: () => explained(item.documentation) } : {}),
      })),
    };
  };
}

function hover(model: Model): Extension {
  return hoverTooltip(async (_view, offset) => {
    const answer = await model.request<{ from: number; to: number; markdown: string } | null>("hover", { offset }).catch(() => null);
    if (!answer?.markdown) return null;
    return { pos: answer.from, end: answer.to, above: true, create: () => ({ dom: explained(answer.markdown) }) };
  });
}

/** At least one character wide, and inside the text as it is now: otherwise there is nothing to point at. */
function diagnostic(complaint: Complaint, length: number): Diagnostic {
  const from = Math.max(0, Math.min(complaint.from, length));
  return {
    from,
    to: Math.max(from, Math.min(Math.max(complaint.to, from + 1), length)),
    severity: complaint.severity === "error" ? "error" : "warning",
    message: complaint.hint ? `${complaint.message}\n${complaint.hint}` : complaint.message,
    source: complaint.code,
  };
}

export function panel(host: HTMLElement, model: Model): void {
  const editor = model.editor;
  const place = document.createElement("div");
  place.className = "text-place";
  // Its styles are adopted by this shadow root: nothing inline, as the page's security policy asks.
  (editor.root as ShadowRoot).append(editor.dom);
  place.append((editor.root as ShadowRoot).host);
  host.append(place, complaintList(model, (complaint) => show(complaint.from, complaint.to)));

  function show(from: number, to = from): void {
    const length = editor.state.doc.length;
    editor.dispatch({
      selection: { anchor: Math.min(from, length), head: Math.min(to, length) },
      effects: EditorView.scrollIntoView(Math.min(from, length), { y: "center" }),
    });
    editor.focus();
  }

  const spell = (): void =>
    editor.dispatch({ effects: [spelled.reconfigure(language(model.format))] });
  spell();
  editor.dispatch({
    effects: helped.reconfigure([autocompletion({ override: [completion(model)] }), hover(model), cursorSelects(model)]),
  });

  // While the listeners of a transaction are told another cannot begin.
  model.on("format", () => queueMicrotask(spell));
  model.on("view", (view) => {
    if (!model.fresh) return;
    const length = editor.state.doc.length;
    editor.dispatch(setDiagnostics(editor.state, view.complaints.map((one) => diagnostic(one, length))));
    mark(false);
  });
  model.on("selection", () => mark(!editor.hasFocus));
  model.on("goto", ({ from, to }) => show(from, to));

  function mark(scroll: boolean): void {
    const body = model.fresh ? model.body(model.selected) : null;
    if (model.selected !== null && body === null) return;
    editor.dispatch({
      effects: [
        marked.of(body && { from: body.from, to: body.to }),
        ...(scroll && body ? [EditorView.scrollIntoView(body.from, { y: "start", yMargin: 24 })] : []),
      ],
    });
  }
}

/** The body in which the cursor stands is the selected one. */
function cursorSelects(model: Model): Extension {
  return EditorView.updateListener.of((update) => {
    if (!update.selectionSet || update.docChanged || !update.view.hasFocus || !model.fresh) return;
    const at = update.state.selection.main.head;
    const body = model.view?.bodies.find((one) => one.from <= at && at <= one.to);
    if (body) queueMicrotask(() => model.select(body.name));
  });
}
