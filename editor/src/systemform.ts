// The form of the system: everything that belongs to no single body.

import { ask } from "./dialogs.js";
import { make } from "./elements.js";
import { entriesOf, nodeAt, remove, set, single, valueOf, type Group, type Row, type Section } from "./fields.js";
import type { Model } from "./model.js";
import type { Path, TreeNode } from "./seam.js";
import { CLAIMS, CONSTRAINTS, LOADS, type Skeleton } from "./skeletons.js";

const SIGNS: [string, string][] = [
  ["", "–"],
  ...["real", "positive", "nonnegative", "negative", "nonpositive", "nonzero"].map((word): [string, string] => [word, word]),
];

/** A named part of a record `name: {key: value}` that may be written shorter: `name: value` stands for `first`. */
function part(model: Model, section: string, name: string, key: string, first: (value: string) => boolean, more: Partial<Row> = {}): Row {
  const path: Path = [section, name];
  const record = nodeAt(model, path);
  const short = record?.kind === "scalar" ? valueOf(model, record) : null;
  const inside = record?.kind === "mapping" ? nodeAt(model, [...path, key]) : null;
  return {
    key: `${section}-${name}-${key}`,
    label: `${name}: ${key}`,
    value: short === null ? valueOf(model, inside) : short !== "" && first(short) ? short : "",
    node: inside ?? (short !== null ? record : null),
    set: (typed) => {
      const now = nodeAt(model, path);
      const value = typed.trim();
      if (now?.kind === "mapping") {
        if (value !== "") return [set([...path, key], value)];
        return nodeAt(model, [...path, key]) ? [remove([...path, key])] : [];
      }
      const old = valueOf(model, now);
      const kept = old !== "" && !first(old) ? shortKey(section, old) : null;
      if (value === "") return kept === null && old !== "" ? [set(path, "{}")] : [];
      return [set(path, kept === null || kept === key ? `{${key}: ${quoted(value)}}` : `{${kept}: ${quoted(old)}, ${key}: ${quoted(value)}}`)];
    },
    ...more,
  };
}

/** What a single word or number under a name means. */
function shortKey(section: string, value: string): string {
  if (section === "parameters") return /^[-+\d.]/.test(value) ? "value" : SIGNS.some(([sign]) => sign === value) ? "sign" : "meaning";
  return { prescribed: "rate", inputs: "meaning", motion: "value", initial: "position" }[section] ?? "value";
}

/** In a list between braces commas, colons and brackets would end a value. */
export function quoted(value: string): string {
  return /[,:{}[\]#]|^[&*!|>'"%@`]|^\s|\s$|^[-?]\s/.test(value) && !/^[[{]/.test(value) ? `'${value.replaceAll("'", "''")}'` : value;
}

interface Column {
  key: string;
  options?: [string, string][];
  formula?: boolean;
}

/** Records by name: parameters, prescribed motions, inputs, the motion, the initial state. */
function records(model: Model, section: string, title: string, columns: Column[], names: string[], adding: string): Section {
  const isFirst = (key: string) => (value: string) => shortKey(section, value) === key;
  const groups = names.map((name): Group => ({
    label: name,
    rows: columns.map(({ key, options, formula }) => {
      if (section === "parameters" && key === "value") return parameterValue(model, name);
      return part(model, section, name, key, isFirst(key), { ...(options ? { options } : {}), formula: formula ?? false, placeholder: key, wide: key === "meaning" });
    }),
    actions: nodeAt(model, [section, name]) ? [{ words: "×", label: `Delete ${name} from ${title.toLowerCase()}`, act: () => model.change([remove([section, name])], `${name} deleted`) }] : [],
  }));
  return { title, groups, actions: [adder(model, section, title, adding)], closed: names.length === 0 };
}

/** With the parameter, or under `values`, where this description has them. */
function parameterValue(model: Model, name: string): Row {
  const own = part(model, "parameters", name, "value", (value) => shortKey("parameters", value) === "value", { formula: true, placeholder: "value" });
  const apart = nodeAt(model, ["values", name]);
  if (!apart && (own.value !== "" || !nodeAt(model, ["values"]))) return own;
  return { ...single(model, own.key, own.label, ["values", name], { formula: true, placeholder: "value" }) };
}

/** `name: formula` lines. */
function formulas(model: Model, section: string, title: string, adding: string): Section {
  const groups = entriesOf(nodeAt(model, [section])).map(([name]): Group => ({
    label: name,
    rows: [single(model, `${section}-${name}`, `${title}: ${name}`, [section, name], { formula: true, wide: true })],
    actions: [{ words: "×", label: `Delete ${name} from ${title.toLowerCase()}`, act: () => model.change([remove([section, name])], `${name} deleted`) }],
  }));
  return { title, groups, actions: [adder(model, section, title, adding)], closed: groups.length === 0 };
}

/** Asks for a name and a first value. */
function adder(model: Model, section: string, title: string, adding: string) {
  return {
    words: `Add ${adding}`,
    label: `Add ${adding}`,
    act: async () => {
      const name = make("input", { type: "text", autofocus: true, autocomplete: "off" });
      const value = make("input", { type: "text", autocomplete: "off" });
      const record = !["relations", "notation", "abbreviations", "values", "outputs", "units"].includes(section);
      const done = await ask(`${title}: add ${adding}`, [make("label", {}, "Name ", name), make("label", {}, record ? `First value (${shortKey(section, "1")})` : "Equals", value)], [
        { words: "Add", value: true, main: true },
        { words: "Cancel", value: false },
      ], false);
      if (!done || name.value.trim() === "") return;
      const first = value.value.trim();
      const source = first !== "" ? first : section === "parameters" ? "real" : section === "initial" || section === "motion" ? "0" : "";
      if (source === "") return model.say(`${name.value.trim()} needs a value`);
      await model.change([{ op: "insert", path: [section, name.value.trim()], source }], `${name.value.trim()} added to ${title.toLowerCase()}`);
    },
  };
}

/** Loads, constraints, claims: each item with its own keys, as they are written. */
function items(model: Model, section: string, title: string, adding: string, skeletons: Skeleton[]): Section {
  const found = nodeAt(model, [section])?.children ?? [];
  const groups = found.flatMap((item, index) => itemGroups(model, section, item, index));
  return {
    title: found.length > 0 ? `${title} (${found.length})` : title,
    groups,
    actions: [{ words: `Add ${adding}`, label: `Add ${adding}`, act: () => addItem(model, section, title, adding, skeletons) }],
    closed: found.length === 0 || section === "claims",
  };
}

function itemGroups(model: Model, section: string, item: TreeNode, index: number): Group[] {
  const path: Path = [section, index];
  const drop = { words: "×", label: `Delete number ${index + 1} of ${section}`, act: () => model.change([remove(path)], `number ${index + 1} of ${section} deleted`) };
  const label = `${index + 1}`;
  if (item.kind !== "mapping") return [{ label, rows: [single(model, `${section}-${index}`, `${section} ${index + 1}`, path, { wide: true })], actions: [drop] }];
  const rows = entriesOf(item).flatMap(([key, value]): [string, Path][] =>
    value.kind === "mapping" && section !== "claims" ? entriesOf(value).map(([inner]): [string, Path] => [`${key}: ${inner}`, [...path, key, inner]]) : [[key, [...path, key]]],
  );
  return rows.map(([words, at], row): Group => ({
    label: row === 0 ? `${label}. ${words}` : words,
    rows: [single(model, `${section}-${index}-${words}`, `${section} ${index + 1}: ${words}`, at, { wide: true })],
    actions: row === 0 ? [drop] : [],
  }));
}

async function addItem(model: Model, section: string, title: string, adding: string, skeletons: Skeleton[]): Promise<void> {
  const kind = make("select", { autofocus: true }, ...skeletons.map((one, index) => make("option", { value: index }, one.kind)));
  const source = make("input", { type: "text", autocomplete: "off", spellcheck: "false", value: skeletons[0]!.source });
  kind.addEventListener("change", () => {
    source.value = skeletons[Number(kind.value)]!.source;
  });
  const done = await ask(`${title}: add ${adding}`, [
    make("label", {}, "Kind ", kind),
    make("label", {}, "As it will be written ", source),
    make("p", { class: "hint" }, "The names in capitals stand for what has to be filled in, here or in the form."),
  ], [
    { words: "Add", value: true, main: true },
    { words: "Cancel", value: false },
  ], false);
  if (!done || source.value.trim() === "") return;
  const length = nodeAt(model, [section])?.children?.length ?? 0;
  await model.change([{ op: "insert", path: [section, length], source: source.value.trim() }], `added to ${title.toLowerCase()}`);
}

function assumptions(model: Model): Section {
  const found = nodeAt(model, ["assumptions"])?.children ?? [];
  const groups = found.map((_, index): Group => ({
    label: `${index + 1}`,
    rows: [single(model, `assumption-${index}`, `Assumption ${index + 1}`, ["assumptions", index], { wide: true })],
    actions: [{ words: "×", label: `Delete assumption ${index + 1}`, act: () => model.change([remove(["assumptions", index])], "assumption deleted") }],
  }));
  return {
    title: "Assumptions",
    groups,
    closed: groups.length === 0,
    actions: [{ words: "Add an assumption", label: "Add an assumption", act: async () => {
      const input = make("input", { type: "text", autofocus: true, autocomplete: "off", placeholder: "alpha > -1" });
      const done = await ask("Add an assumption", [make("label", {}, "Inequality ", input)], [{ words: "Add", value: true, main: true }, { words: "Cancel", value: false }], false);
      if (!done || !input.value.trim()) return;
      const length = nodeAt(model, ["assumptions"])?.children?.length ?? 0;
      await model.change([{ op: "insert", path: ["assumptions", length], source: input.value.trim() }], "assumption added");
    } }],
  };
}

export function systemSections(model: Model): Section[] {
  const names = (section: string): string[] => entriesOf(nodeAt(model, [section])).map(([name]) => name);
  const line = (key: string, label: string): Group => ({ label, rows: [single(model, `system-${key.replaceAll(" ", "-")}`, label, [key], { wide: true })] });
  const listed = nodeAt(model, ["parameters"]);
  const parameters = listed?.kind === "sequence" ? [] : names("parameters");
  const known = new Set(["mbsym", "name", "description", "source", "dimensionless time", "parameters", "prescribed", "inputs", "values", "bodies", "loads", "constraints", "relations", "notation", "abbreviations", "assumptions", "motion", "initial", "claims"]);
  const rest = entriesOf(model.understood?.tree ?? null).filter(([key]) => !known.has(key));
  return [
    { title: "System", groups: [line("name", "Name"), line("description", "Description"), line("source", "Source"), line("dimensionless time", "Dimensionless time")] },
    records(model, "parameters", "Parameters", [{ key: "sign", options: SIGNS }, { key: "value", formula: true }, { key: "meaning" }], parameters, "a parameter"),
    records(model, "prescribed", "Prescribed motions", [{ key: "rate", formula: true }, { key: "initial", formula: true }, { key: "meaning" }], names("prescribed"), "a prescribed motion"),
    records(model, "inputs", "Inputs", [{ key: "meaning" }], names("inputs"), "an input"),
    items(model, "loads", "Loads", "a load", LOADS),
    items(model, "constraints", "Constraints", "a constraint", CONSTRAINTS),
    formulas(model, "relations", "Relations", "a relation"),
    records(model, "motion", "Unperturbed motion", [{ key: "value", formula: true }, { key: "rate", formula: true }], names("motion"), "a coordinate"),
    formulas(model, "notation", "Notation", "a symbol"),
    assumptions(model),
    records(model, "initial", "Initial state", [{ key: "position", formula: true }, { key: "velocity", formula: true }], names("initial"), "a coordinate"),
    formulas(model, "values", "Values", "a value"),
    formulas(model, "abbreviations", "Abbreviations", "an abbreviation"),
    items(model, "claims", "Claims", "a claim", CLAIMS),
    ...(rest.length > 0 ? [{ title: "More", closed: true, groups: rest.map(([key]) => line(key, key)) }] : []),
  ];
}
