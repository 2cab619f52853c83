// A form as values: groups of labelled inputs, each bound to a place of the document.  Drawn once for a structure and
// then filled, so that focus and what is being typed stay.

import { make } from "./elements.js";
import { formula } from "./mathml.js";
import { remedies, type Remedy } from "./remedies.js";
import type { Model } from "./model.js";
import { released } from "./pressing.js";
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
  /** In place of the label: what it is called, to be changed there. */
  name?: Row;
  actions?: Action[];
  /** What it means, as the schema says it. */
  hint?: string;
  /** A row of a matrix: all of it in one line. */
  matrix?: boolean;
}

export interface Section {
  title: string;
  /** What stays the same while the title counts. */
  key?: string;
  /** Whose fields they are: those of another one are drawn anew. */
  owner?: string;
  /** Worked out only where the section is open, if it is a function. */
  groups: Group[] | (() => Group[]);
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

/** `count` components. Where there is no vector yet the first that is typed makes one; only empty ones delete it. */
export function vector(model: Model, key: string, label: string, path: Path, placeholders: string[] = [], count = 3): Row[] {
  const node = nodeAt(model, path);
  const indices = Array.from({ length: count }, (_, index) => index);
  const parts = node?.kind === "sequence" ? (node.children ?? []) : [];
  return indices.map((index) => ({
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
      if (now?.kind === "sequence" && known.length === indices.length) {
        const after = known.map((old, other) => (other === index ? value : old));
        if (typed.trim() === "" && after.every((one) => one === "0")) return [remove(path)];
        return known[index] === value ? [] : [set([...path, index], value)];
      }
      if (typed.trim() === "") return [];
      return [set(path, `[${indices.map((other) => (other === index ? value : (known[other] ?? "0"))).join(", ")}]`)];
    },
  }));
}

// ---- drawing ---------------------------------------------------------------------------------------------------------

interface Drawn {
  input: HTMLInputElement | HTMLSelectElement;
  note: HTMLElement;
  row: Row;
  shown: string;
  /** What the buttons beneath it do now: places in the text may be others than when they were drawn. */
  remedies: Remedy[];
}

interface Part {
  element: HTMLElement;
  /** What it was drawn for: another one is drawn anew. */
  signature: string;
  /** What its buttons do now. */
  actions: Action[];
}

interface Folded extends Part {
  title: HTMLElement;
  groups: HTMLElement;
  buttons: HTMLElement;
  owner: string | undefined;
}

export class Form {
  private readonly drawn = new Map<string, Drawn>();
  private readonly sections = new Map<string, Folded>();
  private readonly groups = new Map<string, Part>();
  private shown: Section[] = [];

  constructor(
    private readonly host: HTMLElement,
    private readonly model: Model,
    private readonly name: string,
  ) {}

  /** Draws what is new and fills the rest: elements stay, and with them the focus and what is being typed. */
  show(sections: Section[]): void {
    this.shown = sections;
    const before = this.host.contains(document.activeElement) ? document.activeElement : null;
    const place = before ? [...this.host.querySelectorAll(".field")].indexOf(before.closest(".field") ?? before) : -1;
    const groups = new Set<string>();
    const elements = sections.map((section) => this.section(section, groups));
    placed(this.host, elements);
    for (const [key, part] of [...this.groups]) if (!groups.has(key) && !this.isFolded(part.element)) this.groups.delete(key);
    for (const [key, drawn] of this.drawn) if (!this.host.contains(drawn.input)) this.drawn.delete(key);
    if (before && !this.host.contains(document.activeElement)) this.refocus(before, place);
  }

  /** What had the focus was moved, drawn anew, or is gone: then what stands in its place now has it. */
  private refocus(before: Element, place: number): void {
    const same = [...this.host.querySelectorAll<HTMLElement>("input, select, button")].find((one) => one.ariaLabel === before.ariaLabel);
    const fields = [...this.host.querySelectorAll(".field")];
    const near = fields[Math.min(place, fields.length - 1)]?.querySelector<HTMLElement>("input, select, button");
    const found = before.isConnected ? (before as HTMLElement) : (same ?? near);
    found?.focus();
  }

  private isFolded(element: HTMLElement): boolean {
    return element.closest("details")?.open === false;
  }

  private section(section: Section, seen: Set<string>): HTMLElement {
    const key = section.key ?? section.title;
    const folded = this.sections.get(key) ?? this.folded(key, section);
    if (folded.owner !== section.owner) {
      for (const known of [...this.groups.keys()]) if (known.startsWith(`${key}|`)) this.groups.delete(known);
      folded.groups.replaceChildren();
      folded.owner = section.owner;
    }
    if (folded.title.textContent !== section.title) folded.title.textContent = section.title;
    folded.actions = section.actions ?? [];
    const labels = folded.actions.map((one) => one.label).join("|");
    if (labels !== folded.signature) folded.buttons.replaceChildren(...buttons(folded));
    folded.buttons.hidden = folded.actions.length === 0;
    folded.signature = labels;
    if ((folded.element as HTMLDetailsElement).open) {
      const groups = typeof section.groups === "function" ? section.groups() : section.groups;
      placed(folded.groups, groups.map((group) => this.groupOf(key, group, seen)));
      for (const group of groups) for (const row of rowsOf(group)) this.fill(row);
    }
    return folded.element;
  }

  private folded(key: string, section: Section): Folded {
    const title = make("summary", {}, section.title);
    const [groups, actions] = [make("div", {}), make("div", { class: "actions" })];
    const element = make("details", { "data-title": key, open: !section.closed }, title, groups, actions);
    element.addEventListener("toggle", () => element.open && this.show(this.shown));
    const made: Folded = { element, title, groups, buttons: actions, signature: "", actions: [], owner: section.owner };
    this.sections.set(key, made);
    return made;
  }

  private groupOf(section: string, group: Group, seen: Set<string>): HTMLElement {
    const rows = rowsOf(group).map((row) => [row.key, row.label, row.options]);
    const signature = JSON.stringify([group.label, rows, (group.actions ?? []).map((one) => [one.words, one.label])]);
    const key = `${section}|${signature}`;
    const known = this.groups.get(key) ?? this.group(group, signature);
    known.actions = group.actions ?? [];
    this.groups.set(key, known);
    seen.add(key);
    return known.element;
  }

  private group(group: Group, signature: string): Part {
    const part: Part = { element: make("div", {}), signature, actions: group.actions ?? [] };
    const name = group.name ? make("span", { class: "one" }, ...this.input(group.name)) : null;
    const rows = group.rows.map((row) => this.input(row));
    const inputs = group.rows.map((row, index) => make("span", { class: row.wide ? "one wide" : "one" }, rows[index]![0]));
    const id = group.rows[0] ? `${this.name}-${group.rows[0].key}` : null;
    const label = name ?? (group.rows.length === 1 ? make("label", { for: id }, group.label) : make("span", { class: "label" }, group.label));
    const attributes = group.rows.length > 1 || name ? { role: "group", "aria-label": group.label } : {};
    part.element = make(
      "div",
      { class: "field", title: group.hint, ...attributes },
      label,
      make("div", { class: group.matrix ? "inputs of-matrix" : `inputs of-${Math.min(4, group.rows.length)}` }, ...inputs, ...buttons(part)),
      // Beneath all of them: a third of a narrow panel is too narrow for a sentence or a formula.
      make("div", { class: "notes" }, ...rows.map(([, note]) => note)),
    );
    return part;
  }

  private input(row: Row): [HTMLElement, HTMLElement] {
    const id = `${this.name}-${row.key}`;
    const attributes = { id, "aria-label": row.label, "aria-describedby": `${id}-note` };
    const input = row.options
      ? make("select", attributes, ...row.options.map(([value, words]) => make("option", { value }, words)))
      : make("input", { ...attributes, type: "text", autocomplete: "off", spellcheck: "false" });
    const note = make("span", { class: "note", id: `${id}-note` });
    const drawn: Drawn = { input, note, row, shown: "", remedies: [] };
    this.drawn.set(row.key, drawn);
    input.addEventListener("change", () => {
      const value = input.value;
      if (value === drawn.shown) return;
      drawn.shown = value;
      void this.model.change(() => drawn.row.set(value), `${drawn.row.label}: ${value || "left out"}`).then((outcome) => {
        if (!outcome.done) return this.tell(drawn, outcome.complaints[0] ?? { message: "this cannot be done", hint: null });
        const [complaint] = this.complaintsOf(drawn.row.node);
        if (complaint) this.model.say(`${drawn.row.label}: ${complaint.message}`);
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
      input.addEventListener("blur", () => released(() => this.complain(drawn)));
    }
    return [input, note];
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
    if (complaint) this.tell(drawn, complaint);
    else {
      drawn.input.removeAttribute("aria-invalid");
      // A formula that is being typed stays shown; what was wrong does not.
      if (document.activeElement !== drawn.input || drawn.note.querySelector(".wrong")) drawn.note.replaceChildren();
    }
  }

  private tell(drawn: Drawn, complaint: Pick<Complaint, "message" | "hint"> | Complaint): void {
    drawn.input.setAttribute("aria-invalid", "true");
    const found = "code" in complaint ? remedies(this.model, complaint, drawn.row.node?.path ?? []) : [];
    drawn.remedies = found;
    const told = JSON.stringify([complaint.message, complaint.hint, found.map((one) => one.words)]);
    if (drawn.note.dataset["told"] === told && drawn.note.querySelector(".wrong")) return; // a button there may have the focus
    drawn.note.dataset["told"] = told;
    const act = (index: number): void => {
      drawn.input.focus(); // the button goes with the complaint
      void drawn.remedies[index]?.act();
    };
    const buttons = found.map((one, index) => make("button", { type: "button", click: () => act(index) }, one.words));
    // The remedies say it, but for a slip of the pen.
    const hint = complaint.hint && (found.length === 0 || complaint.hint.startsWith("did you mean")) ? make("span", { class: "way-out" }, ` ${complaint.hint}`) : null;
    drawn.note.replaceChildren(make("span", { class: "wrong" }, complaint.message), hint ?? "", ...buttons);
    if (document.activeElement === drawn.input) drawn.note.scrollIntoView({ block: "nearest" }); // it may begin below the fold
  }

  /** What is typed, as a formula. */
  private async preview(drawn: Drawn): Promise<void> {
    const source = drawn.input.value.trim();
    if (!drawn.row.formula || drawn.input.getAttribute("aria-invalid")) return;
    if (source === "" || /^[\w.]*$/.test(source)) return drawn.note.replaceChildren();
    const answer = await this.model.request<{ mathml?: string }>("formula", { source }).catch(() => null);
    if (drawn.input.value.trim() !== source || document.activeElement !== drawn.input) return;
    if (drawn.input.getAttribute("aria-invalid")) return; // a complaint came first: it stays, and so do its buttons
    const shown = answer?.mathml ? formula(answer.mathml) : null;
    drawn.note.replaceChildren(...(shown ? [shown] : []));
  }
}

const rowsOf = (group: Group): Row[] => (group.name ? [group.name, ...group.rows] : group.rows);

/** Buttons that do what the part says when they are pressed. */
function buttons(part: Part): HTMLElement[] {
  return part.actions.map((action, index) =>
    make("button", { type: "button", "aria-label": action.label, title: action.label, click: () => void part.actions[index]?.act() }, action.words),
  );
}

/** Exactly these children, in this order; what stays is not moved, so that it keeps the focus. */
function placed(host: HTMLElement, children: HTMLElement[]): void {
  const wanted = new Set<Element>(children);
  for (const child of [...host.children]) if (!wanted.has(child)) child.remove();
  children.forEach((child, index) => {
    if (host.children[index] !== child) host.insertBefore(child, host.children[index] ?? null);
  });
}
