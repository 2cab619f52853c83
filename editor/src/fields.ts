// A form as values: groups of labelled inputs, each bound to a place of the document.  Drawn once for a structure and
// then filled, so that focus and what is being typed stay.

import { make } from "./elements.js";
import { formula } from "./mathml.js";
import type { Model } from "./model.js";
import type { Complaint, Operation, Path, TreeNode } from "./seam.js";

export interface Row {
  /** Unique in the form: also the end of the input's id. */
  key: string;
  /** What the input is called, alone: groups may show less. */
  label: string;
  value: string;
  placeholder?: string;
  options?: [value: string, words: string][];
  /** Where complaints about it stand. */
  node?: TreeNode | null;
  /** Whether what is typed is a formula, shown as one while it is typed. */
  formula?: boolean;
  wide?: boolean;
  /** What typing `value` means. */
  set: (value: string) => Operation[];
}

export interface Action {
  words: string;
  label: string;
  act: () => unknown;
}

export interface Group {
  label: string;
  rows: Row[];
  actions?: Action[];
}

export interface Section {
  title: string;
  groups: Group[];
  actions?: Action[];
  closed?: boolean;
}

// ---- the tree of the document ----------------------------------------------------------------------------------------

export function nodeAt(model: Model, path: Path): TreeNode | null {
  let node: TreeNode | null = model.understood?.tree ?? null;
  for (const step of path) {
    node = node?.children?.find((child) => String(child.path.at(-1)) === String(step)) ?? null;
    if (!node) return null;
  }
  return node;
}

/** A value as a person would say it: without the quotes of YAML, folded lines joined. */
export function said(spelled: string): string {
  const text = spelled.trim();
  if (text.startsWith("'") && text.endsWith("'") && text.length > 1) return text.slice(1, -1).replaceAll("''", "'");
  if (text.startsWith('"') && text.endsWith('"') && text.length > 1) {
    try {
      return String(JSON.parse(text.replaceAll("\n", " ")));
    } catch {
      return text;
    }
  }
  if (/^[>|][+-]?\d?\s*\n/.test(text)) return text.slice(text.indexOf("\n")).replace(/\s*\n\s*/g, " ").trim();
  return text.replace(/\s*\n\s*/g, " ");
}

export function valueOf(model: Model, node: TreeNode | null): string {
  if (!node) return "";
  if (node.kind === "scalar") return said(node.source ?? "");
  return (model.understoodText ?? "").slice(node.from, node.to).replace(/\s*\n\s*/g, " ");
}

/** The entries of a mapping, in order: key and value. */
export function entriesOf(node: TreeNode | null): [string, TreeNode][] {
  return node?.kind === "mapping" ? (node.children ?? []).map((child) => [String(child.path.at(-1)), child]) : [];
}

export const set = (path: Path, source: string): Operation => ({ op: "set", path, source });
export const remove = (path: Path): Operation => ({ op: "delete", path });

/** One value at a path: empty deletes it. */
export function single(model: Model, key: string, label: string, path: Path, more: Partial<Row> = {}): Row {
  const node = nodeAt(model, path);
  return {
    key,
    label,
    value: valueOf(model, node),
    node,
    set: (value) => (value.trim() !== "" ? [set(path, value.trim())] : nodeAt(model, path) ? [remove(path)] : []),
    ...more,
  };
}

/** Three components. Where there is no vector yet the first that is typed makes one; three empty ones delete it. */
export function vector(model: Model, key: string, label: string, path: Path, placeholders: string[] = ["0", "0", "0"]): Row[] {
  const node = nodeAt(model, path);
  const parts = node?.kind === "sequence" ? (node.children ?? []) : [];
  return [0, 1, 2].map((index) => ({
    key: `${key}-${index + 1}`,
    label: `${label}, ${index + 1}`,
    value: valueOf(model, parts[index] ?? null),
    placeholder: placeholders[index] ?? "0",
    node: parts[index] ?? (index === 0 ? node : null),
    formula: true,
    set: (typed) => {
      const now = nodeAt(model, path);
      const known = now?.kind === "sequence" ? (now.children ?? []).map((child) => valueOf(model, child)) : [];
      const value = typed.trim() || "0";
      if (now?.kind === "sequence" && known.length === 3) {
        const after = known.map((old, other) => (other === index ? value : old));
        if (typed.trim() === "" && after.every((one) => one === "0")) return [remove(path)];
        return known[index] === value ? [] : [set([...path, index], value)];
      }
      if (typed.trim() === "") return [];
      return [set(path, `[${[0, 1, 2].map((other) => (other === index ? value : (known[other] ?? "0"))).join(", ")}]`)];
    },
  }));
}

// ---- drawing ---------------------------------------------------------------------------------------------------------

interface Drawn {
  input: HTMLInputElement | HTMLSelectElement;
  note: HTMLElement;
  row: Row;
  shown: string;
}

export class Form {
  private readonly drawn = new Map<string, Drawn>();
  private signature = "";

  constructor(
    private readonly host: HTMLElement,
    private readonly model: Model,
    private readonly name: string,
  ) {}

  show(sections: Section[]): void {
    const signature = JSON.stringify(
      sections.map((section) => [section.title, section.groups.map((group) => [group.label, group.rows.map((row) => [row.key, row.options])])]),
    );
    if (signature !== this.signature) this.build(sections);
    this.signature = signature;
    for (const section of sections) for (const group of section.groups) for (const row of group.rows) this.fill(row);
  }

  private build(sections: Section[]): void {
    const before = this.host.contains(document.activeElement) ? document.activeElement?.id : null;
    const open = new Map([...this.host.querySelectorAll("details")].map((one) => [one.dataset["title"], one.open]));
    this.drawn.clear();
    this.host.replaceChildren(
      ...sections.map((section) =>
        make(
          "details",
          { "data-title": section.title, open: open.get(section.title) ?? !section.closed },
          make("summary", {}, section.title),
          ...section.groups.map((group) => this.group(group)),
          section.actions ? make("div", { class: "actions" }, ...section.actions.map(button)) : null,
        ),
      ),
    );
    if (before) document.getElementById(before)?.focus();
  }

  private group(group: Group): HTMLElement {
    const inputs = group.rows.map((row) => this.input(row));
    const id = group.rows[0] ? `${this.name}-${group.rows[0].key}` : null;
    const label = group.rows.length === 1 ? make("label", { for: id }, group.label) : make("span", { class: "label" }, group.label);
    const attributes = group.rows.length > 1 ? { role: "group", "aria-label": group.label } : {};
    return make(
      "div",
      { class: "field", ...attributes },
      label,
      make("div", { class: `inputs of-${Math.min(4, group.rows.length)}` }, ...inputs, ...(group.actions ?? []).map(button)),
    );
  }

  private input(row: Row): HTMLElement {
    const id = `${this.name}-${row.key}`;
    const attributes = { id, "aria-label": row.label, "aria-describedby": `${id}-note` };
    const input = row.options
      ? make("select", attributes, ...row.options.map(([value, words]) => make("option", { value }, words)))
      : make("input", { ...attributes, type: "text", autocomplete: "off", spellcheck: "false" });
    const note = make("span", { class: "note", id: `${id}-note` });
    const drawn: Drawn = { input, note, row, shown: "" };
    this.drawn.set(row.key, drawn);
    input.addEventListener("change", () => {
      const value = input.value;
      if (value === drawn.shown) return;
      drawn.shown = value;
      void this.model.change(() => drawn.row.set(value), `${drawn.row.label}: ${value || "left out"}`).then((outcome) => {
        if (!outcome.done) this.tell(drawn, outcome.complaints[0]?.message ?? "this cannot be done");
      });
    });
    if (!row.options) {
      input.addEventListener("input", () => this.preview(drawn));
      input.addEventListener("focus", () => this.preview(drawn));
      input.addEventListener("keydown", ((event: KeyboardEvent) => {
        if (event.key !== "Escape" || input.value === drawn.shown) return;
        input.value = drawn.shown;
        this.preview(drawn);
      }) as EventListener);
      input.addEventListener("blur", () => this.complain(drawn));
    }
    return make("span", { class: row.wide ? "one wide" : "one" }, input, note);
  }

  private fill(row: Row): void {
    const drawn = this.drawn.get(row.key);
    if (!drawn) return;
    drawn.row = row;
    const { input } = drawn;
    if (input instanceof HTMLInputElement) input.placeholder = row.placeholder ?? "";
    // What is being typed stays.
    if (input.value === drawn.shown || document.activeElement !== input) {
      const changed = input.value !== row.value;
      input.value = row.value;
      drawn.shown = row.value;
      // Reached by Tab just before: typing still replaces all of it.
      if (changed && document.activeElement === input && input instanceof HTMLInputElement) input.select();
    }
    this.complain(drawn);
  }

  private complaintsOf(node: TreeNode | null | undefined): Complaint[] {
    if (!node || !this.model.fresh) return [];
    const from = node.key?.from ?? node.from;
    return (this.model.view?.complaints ?? []).filter((one) => one.from >= from && one.from <= node.to);
  }

  private complain(drawn: Drawn): void {
    const [complaint] = this.complaintsOf(drawn.row.node);
    if (complaint) this.tell(drawn, complaint.message);
    else {
      drawn.input.removeAttribute("aria-invalid");
      if (document.activeElement !== drawn.input) drawn.note.replaceChildren();
    }
  }

  private tell(drawn: Drawn, words: string): void {
    drawn.input.setAttribute("aria-invalid", "true");
    drawn.note.replaceChildren(make("span", { class: "wrong" }, words));
  }

  /** What is typed, as a formula. */
  private async preview(drawn: Drawn): Promise<void> {
    const source = drawn.input.value.trim();
    if (!drawn.row.formula || drawn.input.getAttribute("aria-invalid")) return;
    if (source === "" || /^[\w.]*$/.test(source)) return drawn.note.replaceChildren();
    const answer = await this.model.request<{ mathml?: string }>("formula", { source }).catch(() => null);
    if (drawn.input.value.trim() !== source || document.activeElement !== drawn.input) return;
    const shown = answer?.mathml ? formula(answer.mathml) : null;
    drawn.note.replaceChildren(...(shown ? [shown] : []));
  }
}

function button(action: Action): HTMLElement {
  return make("button", { type: "button", "aria-label": action.label, title: action.label, click: () => void action.act() }, action.words);
}
