// The form of the system: everything that belongs to no single body.

import { addFields, quoted, record as inBraces } from "./formentry.js";
import { items } from "./formitems.js";
import { entriesOf, nodeAt, remove, set, single, valueOf, type Action, type Group, type Row, type Section } from "./fields.js";
import type { Field } from "./formkinds.js";
import { limits, linearSystem, smallParameter, tables } from "./formtables.js";
import type { Model } from "./model.js";
import type { Operation, Path } from "./seam.js";

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
  return { prescribed: "rate", given: "of", inputs: "meaning", motion: "value", initial: "position" }[section] ?? "value";
}

interface Column {
  key: string;
  options?: [string, string][];
  formula?: boolean;
}

/** What something is called, in place of its label: another name is one wherever it is used. */
export function nameRow(section: string, name: string, title: string): Row {
  return {
    key: `${section}-${name}-name`,
    label: `Name of ${name} in ${title.toLowerCase()}`,
    value: name,
    set: (typed) => (typed.trim() && typed.trim() !== name ? [{ op: "rename", kind: "parameter", name, to: typed.trim() }] : []),
  };
}

/** Deletes an entry; and where the order counts, moves it up. */
function entryActions(model: Model, path: Path, title: string, before: Path | null): Action[] {
  const name = String(path.at(-1));
  const drop = { words: "×", label: `Delete ${name} from ${title.toLowerCase()}`, act: () => model.change([remove(path)], `${name} deleted`) };
  if (!before) return [drop];
  return [{ words: "↑", label: `Move ${name} up in ${title.toLowerCase()}`, act: () => model.change([{ op: "move", path, before }], `${name} moved up`) }, drop];
}

/** What the names of a section are names of, so that they can be changed there. */
const NAMING = new Set(["parameters", "prescribed", "given", "inputs", "notation", "abbreviations"]);

/** Records by name: parameters, prescribed motions, inputs, the motion, the initial state. */
function records(model: Model, section: string, title: string, columns: Column[], adding: string): Section {
  const list = nodeAt(model, [section]);
  // Parameters may be a list of names alone: a first sign or meaning makes records of them.
  const listed = list?.kind === "sequence" ? (list.children ?? []) : [];
  const names = listed.length > 0 ? listed.map((child) => valueOf(model, child)) : entriesOf(list).map(([name]) => name);
  const isFirst = (key: string) => (value: string) => shortKey(section, value) === key;
  const groups = names.map((name, index): Group => ({
    label: name,
    ...(NAMING.has(section) ? { name: nameRow(section, name, title) } : {}),
    rows: columns.map(({ key, options, formula }) => {
      if (section === "parameters" && key === "value") return parameterValue(model, name);
      return part(model, section, name, key, isFirst(key), { ...(options ? { options } : {}), formula: formula ?? false, placeholder: key, wide: key === "meaning" });
    }),
    actions: listed.length > 0
      ? [{ words: "×", label: `Delete ${name} from ${title.toLowerCase()}`, act: () => model.change([remove([section, index])], `${name} deleted`) }]
      : entryActions(model, [section, name], title, null),
  }));
  return { title, groups, actions: [adder(model, section, title, adding, columns)], closed: names.length === 0 };
}

/** With the parameter, or under `values`, where this description has them. */
function parameterValue(model: Model, name: string): Row {
  const own = part(model, "parameters", name, "value", (value) => shortKey("parameters", value) === "value", { formula: true, placeholder: "value" });
  const apart = nodeAt(model, ["values", name]);
  if (!apart && (own.value !== "" || !nodeAt(model, ["values"]))) return own;
  return { ...single(model, own.key, own.label, ["values", name], { formula: true, placeholder: "value" }) };
}

/** `name: formula` lines; `ordered`: later ones may use earlier ones. */
function formulas(model: Model, section: string, title: string, adding: string, ordered = false): Section {
  return { ...lines(model, [section], title, adding, ordered, NAMING.has(section)), key: title };
}

/** Entries `name: value` at a path. */
export function lines(model: Model, path: Path, title: string, adding: string, ordered = false, naming = false): Section {
  const section = path.join("-");
  const entries = entriesOf(nodeAt(model, path));
  const groups = entries.map(([name], index): Group => ({
    label: name,
    ...(naming ? { name: nameRow(section, name, title) } : {}),
    rows: [single(model, `${section}-${name}`, `${title}: ${name}`, [...path, name], { formula: true, wide: true })],
    actions: entryActions(model, [...path, name], title, ordered && index > 0 ? [...path, entries[index - 1]![0]] : null),
  }));
  const words = path.at(-1) === "speeds" ? "of velocities, linear: x_dot is the velocity of x; omega1, omega2, omega3 are the body's own" : "";
  const fields: Field[] = [
    { key: "name", sort: "text", words: "", optional: false },
    { key: "equals", sort: "formula", words, optional: false },
  ];
  const act = () => addFields(model, `${title}: add ${adding}`, fields, (values) => [{ op: "insert", path: [...path, values.get("name")!], source: values.get("equals")! }]);
  return { title, groups, actions: [{ words: `Add ${adding}`, label: `Add ${adding}`, act }], closed: groups.length === 0 };
}

/** Asks for a name and what belongs to it. */
function adder(model: Model, section: string, title: string, adding: string, columns: Column[]): Action {
  const ofCoordinates = section === "initial" || section === "motion";
  const name = ofCoordinates ? "coordinate" : "name";
  const fields = [
    { key: name, sort: "text" as const, words: "", optional: false },
    ...columns.map(({ key, options, formula }): Field =>
      options
        ? { key, sort: "choice", words: "", optional: true, choices: options.map(([value]) => value).filter(Boolean) }
        : { key, sort: formula ? "formula" : "text", words: "", optional: !(section === "prescribed" && key === "rate") },
    ),
  ];
  const wanted = (values: Map<string, string>): Operation[] => {
    const pairs = columns.map(({ key }): [string, string] => [key, values.get(key) ?? ""]).filter(([, value]) => value !== "");
    const [only] = pairs;
    const short = pairs.length === 1 && only![0] === shortKey(section, only![1]) ? only![1] : null;
    const none = section === "parameters" ? "real" : ofCoordinates ? "0" : "{}";
    return [{ op: "insert", path: [section, values.get(name)!], source: pairs.length === 0 ? none : (short ?? inBraces(pairs)) }];
  };
  return { words: `Add ${adding}`, label: `Add ${adding} to ${title.toLowerCase()}`, act: () => addFields(model, `${title}: add ${adding}`, fields, wanted) };
}

function assumptions(model: Model): Section {
  const found = nodeAt(model, ["assumptions"])?.children ?? [];
  const groups = found.map((_, index): Group => ({
    label: `${index + 1}`,
    rows: [single(model, `assumption-${index}`, `Assumption ${index + 1}`, ["assumptions", index], { wide: true })],
    actions: [{ words: "×", label: `Delete assumption ${index + 1}`, act: () => model.change([remove(["assumptions", index])], "assumption deleted") }],
  }));
  const fields: Field[] = [{ key: "inequality", sort: "text", words: "alpha > -1", optional: false }];
  const act = () => addFields(model, "Add an assumption", fields, (values) => [{ op: "insert", path: ["assumptions", nodeAt(model, ["assumptions"])?.children?.length ?? 0], source: values.get("inequality")! }]);
  return { title: "Assumptions", groups, closed: groups.length === 0, actions: [{ words: "Add an assumption", label: "Add an assumption", act }] };
}

function list(model: Model, key: string, words: string): Group {
  return names(model, `system-${key}`, words, [key]);
}

/** Names in a list, typed with commas between them. */
export function names(model: Model, key: string, words: string, path: Path, label = words): Group {
  const node = nodeAt(model, path);
  const value = node?.kind === "sequence" ? (node.children ?? []).map((child) => valueOf(model, child)).join(", ") : valueOf(model, node);
  const typed = (value: string): Operation[] => {
    const names = value.replace(/^\s*\[|\]\s*$/g, "").trim();
    return names ? [set(path, `[${names}]`)] : nodeAt(model, path) ? [remove(path)] : [];
  };
  return { label: words, rows: [single(model, key, label, path, { value, wide: true, placeholder: "–", set: typed })] };
}

export function systemSections(model: Model): Section[] {
  const line = (key: string, label: string): Group => ({ label, rows: [single(model, `system-${key.replaceAll(" ", "-")}`, label, [key], { wide: true })] });
  const languages = (model.file.languages ?? []).map((one): [string, string] => [one, one]);
  const known = new Set(["mbsym", "name", "description", "source", "dimensionless time", "parameters", "prescribed", "given", "inputs", "values", "bodies", "loads", "constraints", "relations", "notation", "abbreviations", "assumptions", "motion", "initial", "claims", "outputs", "units", "latex", "limits", "tables", "small parameter", "linear system", "dependent", "reactions", "order", "language"]);
  const rest = entriesOf(model.understood?.tree ?? null).filter(([key]) => !known.has(key));
  return [
    { title: "System", groups: [line("name", "Name"), line("description", "Description"), line("source", "Source"), line("dimensionless time", "Dimensionless time")] },
    records(model, "parameters", "Parameters", [{ key: "sign", options: SIGNS }, { key: "value", formula: true }, { key: "meaning" }], "a parameter"),
    records(model, "prescribed", "Prescribed motions", [{ key: "rate", formula: true }, { key: "initial", formula: true }, { key: "meaning" }], "a prescribed motion"),
    records(model, "given", "Functions of time", [{ key: "value", formula: true }, { key: "meaning" }], "a function of time"),
    records(model, "inputs", "Inputs", [{ key: "meaning" }], "an input"),
    ...linearSystem(model),
    tables(model),
    items(model, "loads", ["loads"], "Loads", "a load"),
    items(model, "constraints", ["constraints"], "Constraints", "a constraint"),
    formulas(model, "relations", "Relations", "a relation"),
    records(model, "motion", "Unperturbed motion", [{ key: "value", formula: true }, { key: "rate", formula: true }], "a coordinate"),
    formulas(model, "notation", "Notation", "a symbol", true),
    assumptions(model),
    records(model, "initial", "Initial state", [{ key: "position", formula: true }, { key: "velocity", formula: true }], "a coordinate"),
    formulas(model, "values", "Values", "a value"),
    formulas(model, "abbreviations", "Abbreviations", "an abbreviation", true),
    items(model, "claims", ["claims"], "Claims", "a claim"),
    smallParameter(model),
    limits(model),
    formulas(model, "outputs", "Outputs", "an output"),
    formulas(model, "units", "Units", "a unit"),
    formulas(model, "latex", "Names in LaTeX", "a name in LaTeX"),
    {
      title: "Choices",
      closed: true,
      groups: [
        list(model, "dependent", "Dependent"),
        list(model, "reactions", "Reactions of joints"),
        list(model, "order", "Order"),
        { label: "Language of LaTeX", rows: [single(model, "system-language", "Language of LaTeX", ["language"], { options: [["", "–"], ...languages] })] },
      ],
    },
    ...(rest.length > 0 ? [{ title: "More", closed: true, groups: rest.map(([key]) => line(key, key)) }] : []),
  ];
}
