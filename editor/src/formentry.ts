// Dialogs in which something new is filled in, field by field, before it is put into the description.

import { ask } from "./dialogs.js";
import { make } from "./elements.js";
import type { Field, Kind, Style } from "./formkinds.js";
import type { Model } from "./model.js";
import { declareNew, unknownNames } from "./remedies.js";
import type { Body, Operation } from "./seam.js";
import { FIXED_WORDS } from "./structure.js";
import { AXES } from "./turns.js";

type Input = HTMLInputElement | HTMLSelectElement;

/** In a list between braces commas, colons and brackets would end a value. */
export function quoted(value: string): string {
  return /[,:{}[\]#]|^[&*!|>'"%@`]|^\s|\s$|^[-?]\s/.test(value) && !/^[[{]/.test(value) ? `'${value.replaceAll("'", "''")}'` : value;
}

/** YAML 1.1 takes a bare `on` for true. */
const keyed = (key: string): string => (key === "on" ? '"on"' : key);

export function record(pairs: [key: string, value: string][]): string {
  return `{${pairs.map(([key, value]) => `${keyed(key)}: ${value}`).join(", ")}}`;
}

/** One field as inputs, and what was filled in as it will be written; "" if nothing was. */
interface Filled {
  element: HTMLElement;
  inputs: Input[];
  source: () => string;
}

export function bodyOptions(model: Model): [string, string][] {
  return [["0", FIXED_WORDS], ...(model.understood?.bodies ?? []).map((one): [string, string] => [one.name, one.name])];
}

function text(label: string, placeholder = "", list?: string): HTMLInputElement {
  return make("input", { type: "text", autocomplete: "off", spellcheck: "false", "aria-label": label, placeholder, list });
}

function choice(label: string, options: [string, string][]): HTMLSelectElement {
  return make("select", { "aria-label": label }, ...options.map(([value, words]) => make("option", { value }, words)));
}

const plain = (input: Input): string => input.value.trim();

function listed(inputs: Input[]): string {
  return inputs.every((one) => plain(one) === "") ? "" : `[${inputs.map((one) => quoted(plain(one) || "0")).join(", ")}]`;
}

function several(label: string, count: number): HTMLInputElement[] {
  return Array.from({ length: count }, (_, index) => text(`${label}, ${index + 1}`, "0"));
}

/** The inputs of one field. */
function filled(model: Model, one: Field, label: string): Filled {
  const row = (inputs: Input[], source: () => string): Filled => ({
    inputs,
    source,
    element: make(
      "div",
      { class: "field", ...(inputs.length > 1 ? { role: "group", "aria-label": label } : {}) },
      make("span", { class: "label", "aria-hidden": "true" }, one.optional ? `${label} (optional)` : label),
      make("div", { class: `inputs of-${inputs.length}` }, ...inputs.map((input) => make("span", { class: "one" }, input))),
      make("span", { class: "hint" }, one.words),
    ),
  });
  if (one.sort === "list") {
    const inputs = several(label, one.count ?? 3);
    return row(inputs, () => listed(inputs));
  }
  if (one.sort === "ends") {
    const ends = ["first", "second"].map((which) => {
      const body = choice(`${label}, ${which}: body`, bodyOptions(model));
      return { body, place: several(`${label}, ${which}: ${one.end}`, 3) };
    });
    const source = (): string =>
      `[${ends.map(({ body, place }) => record([["body", quoted(body.value)], [one.end ?? "point", listed(place) || "[0, 0, 0]"]])).join(", ")}]`;
    return row(ends.flatMap(({ body, place }) => [body, ...place]), source);
  }
  if (one.sort === "pairs") {
    const [name, value] = [text(`${label}: coordinate`, "coordinate", "names-of-coordinates"), text(`${label}: formula`, "formula")];
    return row([name, value], () => (plain(name) ? record([[plain(name), quoted(plain(value) || "0")]]) : ""));
  }
  if (one.sort === "turns") {
    const axes = [1, 2, 3].map((index) => choice(`${label}, axis ${index}`, AXES));
    const angles = [1, 2, 3].map((index) => text(`${label}, angle ${index}`, "angle"));
    const source = (): string => {
      const used = axes.map((axis, index) => [plain(axis), plain(angles[index]!)] as const).filter(([axis, angle]) => axis || angle);
      return used.length === 0 ? "" : `{axes: [${used.map(([axis]) => axis || "0").join(", ")}], angles: [${used.map(([, angle]) => quoted(angle || "0")).join(", ")}]}`;
    };
    return row([...axes, ...angles], source);
  }
  if (one.sort === "state") {
    const [word, numbers] = [choice(label, [["", "–"], ["initial", "the initial state"]]), text(`${label}: numbers`, "or numbers, theta: 0.1, psi: 0")];
    return row([word, numbers], () => (plain(numbers) ? `{${plain(numbers).replace(/^\{|\}$/g, "")}}` : plain(word)));
  }
  if (one.sort === "choice" || one.sort === "body") {
    const options = one.sort === "body" ? bodyOptions(model) : (one.choices ?? []).map((word): [string, string] => [word, word]);
    const input = choice(label, one.optional ? [["", "–"], ...options] : options);
    return row([input], () => (plain(input) ? quoted(plain(input)) : ""));
  }
  const input = text(label, "", one.key === "coordinate" || one.key === "of" ? "names-of-coordinates" : undefined);
  return row([input], () => (plain(input) ? quoted(plain(input)) : ""));
}

/** What is filled in beforehand where it is about a body: that body, the second of two, its first coordinate. */
function about(field: Field, inputs: Input[], body: string, coordinate: string): void {
  const bodies = inputs.filter((input) => input instanceof HTMLSelectElement);
  if (field.sort === "body" && !field.optional) bodies[0]!.value = body;
  else if (field.sort === "ends") bodies[1]!.value = body;
  else if (field.key === "coordinate") inputs[0]!.value = coordinate;
}

/** The coordinates of a body, as its form shows them. */
export function coordinatesOf(body: Body | undefined): string[] {
  const one = body?.fields["coordinates"] ?? body?.fields["generalized coordinates"];
  const names = (one?.source ?? one?.derived?.source ?? "").replace(/[[\](){}]/g, "").split(",");
  return names.map((name) => name.trim()).filter(Boolean);
}

/** Coordinates by name, for what is typed. */
function coordinateNames(model: Model): HTMLDataListElement {
  const names = (model.understood?.bodies ?? []).flatMap(coordinatesOf);
  const options = [...new Set(names)].map((value) => make("option", { value }));
  return make("datalist", { id: "names-of-coordinates" }, ...options);
}

/** Asks until it is added or given up; what the server says against it is told beside what was filled in. */
async function entered(model: Model, title: string, content: HTMLElement[], operations: () => Operation[] | string, words: string, next: () => void): Promise<void> {
  const trouble = make("p", { class: "wrong", role: "alert" });
  for (;;) {
    const chosen = await ask(title, [...content, coordinateNames(model), trouble], [
      { words: "Add", value: "add", main: true },
      { words: "Add, then another", value: "next" },
      { words: "Cancel", value: "cancel" },
    ], "cancel");
    if (chosen === "cancel") return;
    const wanted = operations();
    const before = unknownNames(model);
    const outcome = typeof wanted === "string" ? null : await model.change(wanted, words);
    if (outcome?.done) await declareNew(model, before, words);
    trouble.textContent = outcome?.done ? "" : (typeof wanted === "string" ? wanted : (outcome?.complaints[0]?.message ?? "this cannot be done"));
    if (!outcome?.done) continue;
    if (chosen === "add") return;
    next();
  }
}

/** What is kept for the next one: a table of claims is about one thing, from one place. */
const KEPT = new Set(["of", "place", "variable"]);

/** An item of one of several kinds. */
export async function addItem(model: Model, title: string, adding: string, style: Style, kinds: Kind[], insert: (source: string) => Operation[], body?: string): Promise<void> {
  const coordinate = coordinatesOf(model.understood?.bodies.find((one) => one.name === body))[0] ?? "";
  const kind = make("select", { autofocus: true, "aria-label": "Kind" }, ...kinds.map((one, index) => make("option", { value: index }, one.words)));
  const host = make("div", { class: "form entry" });
  let fields: [Field, Filled][] = [];
  const chosen = (): Kind => kinds[Number(kind.value)]!;
  const draw = (): void => {
    const before = new Map(fields.map(([one, own]) => [one.key, own.inputs.map((input) => input.value)]));
    fields = chosen().fields.map((one) => [one, filled(model, one, one.key || chosen().key)]);
    for (const [one, own] of fields) {
      const values = one.key ? before.get(one.key) : undefined;
      if (values?.length === own.inputs.length) own.inputs.forEach((input, index) => (input.value = values[index] ?? input.value));
      else if (body !== undefined) about(one, own.inputs, body, coordinate);
    }
    host.replaceChildren(...fields.map(([, own]) => own.element));
  };
  kind.addEventListener("change", draw);
  draw();
  const source = (): Operation[] | string => {
    const values = fields.map(([one, own]): [Field, string] => [one, own.source()]);
    const missing = values.find(([one, value]) => value === "" && !one.optional);
    if (missing) return `${missing[0].key || chosen().key} is not filled in`;
    const pairs = values.filter(([one, value]) => one.key !== "" && value !== "").map(([one, value]): [string, string] => [one.key, value]);
    const own = values.find(([one]) => one.key === "");
    const { key } = chosen();
    if (style === "flat") return insert(record([["claim", key], ...pairs]));
    if (style === "beside") return insert(record([[key, own?.[1] ?? "0"], ...pairs]));
    return insert(record([[key, own ? own[1] : record(pairs)]]));
  };
  const next = (): void => {
    for (const [one, own] of fields) if (!KEPT.has(one.key)) for (const input of own.inputs) if (input instanceof HTMLInputElement) input.value = "";
  };
  const head = make("div", { class: "field" }, make("span", { class: "label", "aria-hidden": "true" }, "Kind"), make("div", { class: "inputs" }, kind));
  await entered(model, `${title}: add ${adding}`, [make("div", { class: "form entry" }, head), host], source, `added to ${title.toLowerCase()}`, next);
}

/** Something with fields of its own: `operations` of what was filled in, or a sentence why not. */
export async function addFields(model: Model, title: string, fields: Field[], operations: (values: Map<string, string>) => Operation[] | string): Promise<void> {
  const all = fields.map((one): [Field, Filled] => [one, filled(model, one, one.key)]);
  const values = (): Operation[] | string => {
    const missing = all.find(([one, own]) => !one.optional && own.source() === "");
    if (missing) return `${missing[0].key} is not filled in`;
    return operations(new Map(all.map(([one, own]) => [one.key, own.source()])));
  };
  const next = (): void => {
    for (const [, own] of all) for (const input of own.inputs) input.value = "";
  };
  await entered(model, title, [make("div", { class: "form entry" }, ...all.map(([, own]) => own.element))], values, "added", next);
}
