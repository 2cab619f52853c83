// Loads, constraints, claims and shapes in the form: each item with the fields of its kind.

import { addFields, addItem, bodyOptions } from "./formentry.js";
import { entriesOf, nodeAt, remove, set, single, valueOf, vector, type Action, type Group, type Row, type Section } from "./fields.js";
import { sortOf, type Field, type Kind, type Sort } from "./formkinds.js";
import type { Model } from "./model.js";
import type { Operation, Path, TreeNode } from "./seam.js";
import { turns } from "./turns.js";

/** Where the value of a field stands in an item. */
function placeOf(item: Path, sort: Sort, kind: Kind, key: string): Path {
  if (sort.style === "flat") return [...item, key];
  if (key === "") return [...item, kind.key];
  return sort.style === "beside" ? [...item, key] : [...item, kind.key, key];
}

/** The kind of an item as it is written, and the keys that it has. */
function kindOf(model: Model, sort: Sort, item: TreeNode): [Kind, string[]] | null {
  const entries = entriesOf(item);
  if (sort.style === "flat") {
    const word = valueOf(model, nodeAt(model, [...item.path, "claim"])).toLowerCase();
    const kind = sort.kinds.find((one) => one.key.toLowerCase() === word);
    return kind ? [kind, entries.map(([key]) => key)] : null;
  }
  if (sort.style === "beside") {
    const kind = sort.kinds.find((one) => entries.some(([key]) => key === one.key));
    return kind ? [kind, entries.map(([key]) => key)] : null;
  }
  const [first] = entries;
  if (!first || entries.length > 1) return null;
  const keys = entriesOf(first[1]).map(([key]) => key);
  const ways = sort.kinds.filter((one) => one.key === first[0]);
  const fits = (one: Kind): number => one.fields.filter((field) => keys.includes(field.key)).length;
  const [best] = ways.toSorted((a, b) => fits(b) - fits(a));
  return best ? [best, keys] : null;
}

/** The rows of one field; two ends take a group each. */
function groupsOf(model: Model, key: string, label: string, path: Path, field: Field): Group[] {
  const words = field.key || label;
  const note = `${label}: ${words}`;
  if (field.sort === "list") return [{ label: words, rows: vector(model, key, note, path, [], field.count ?? 3) }];
  if (field.sort === "ends") {
    return ["first", "second"].map((which, index): Group => ({ label: field.key ? `${words}, ${which}` : which, rows: endRows(model, `${key}-${which}`, `${note}, ${which}`, path, index, field.end ?? "point") }));
  }
  if (field.sort === "pairs") {
    const found = entriesOf(nodeAt(model, path));
    return found.map(([name]): Group => ({
      label: name,
      rows: [single(model, `${key}-${name}`, `${label}: ${name}`, [...path, name], { formula: true, wide: true })],
      actions: found.length > 1 ? [{ words: "×", label: `Delete ${name} of ${label}`, act: () => model.change([remove([...path, name])]) }] : [],
    }));
  }
  if (field.sort === "turns") return turns(model, path.slice(0, -1), `${key}-`, `${label}: `);
  if (field.sort === "state") return stateGroups(model, key, label, path, words);
  if (field.sort === "choice" || field.sort === "body") {
    const options = field.sort === "body" ? bodyOptions(model) : (field.choices ?? []).map((one): [string, string] => [one, one]);
    const now = valueOf(model, nodeAt(model, path));
    const unknown = now !== "" && !options.some(([value]) => value === now);
    const all: [string, string][] = [["", "–"], ...(unknown ? [[now, now] as [string, string]] : []), ...options];
    return [{ label: words, rows: [single(model, key, note, path, { options: all })] }];
  }
  return [{ label: words, rows: [single(model, key, note, path, { wide: true, formula: field.sort === "formula", placeholder: field.optional ? "–" : "" })] }];
}

/** "initial", or values by name. */
function stateGroups(model: Model, key: string, label: string, path: Path, words: string): Group[] {
  const node = nodeAt(model, path);
  const fields: Field[] = [
    { key: "name", sort: "text", words: "", optional: false },
    { key: "number", sort: "formula", words: "", optional: false },
  ];
  const add = (values: Map<string, string>): Operation[] => {
    const [name, number] = [values.get("name")!, values.get("number")!];
    return nodeAt(model, path)?.kind === "mapping" ? [{ op: "insert", path: [...path, name], source: number }] : [set(path, `{${name}: ${number}}`)];
  };
  const plus: Action = { words: "+", label: `Add a number to ${words} of ${label}`, act: () => addFields(model, `${label}: ${words}`, fields, add) };
  const found = entriesOf(node);
  if (found.length === 0) {
    return [{ label: words, rows: [single(model, key, `${label}: ${words}`, path, { options: [["", "–"], ["initial", "the initial state"]] })], actions: [plus] }];
  }
  return found.map(([name], index): Group => ({
    label: `${words}: ${name}`,
    rows: [single(model, `${key}-${name}`, `${label}: ${words}, ${name}`, [...path, name], { formula: true })],
    actions: [
      { words: "×", label: `Delete ${name} from ${words} of ${label}`, act: () => model.change([remove(found.length > 1 ? [...path, name] : path)]) },
      ...(index === found.length - 1 ? [plus] : []),
    ],
  }));
}

/** A body and a vector in its axes. */
function endRows(model: Model, key: string, label: string, path: Path, index: number, end: "point" | "axis"): Row[] {
  // Where the pair is missing the first that is typed makes all of it.
  const whole = (operations: Operation[], own: string): Operation[] => {
    if (nodeAt(model, [...path, index]) || operations.length === 0) return operations;
    const other = `{body: 0, ${end}: [0, 0, 0]}`;
    return [set(path, index === 0 ? `[${own}, ${other}]` : `[${other}, ${own}]`)];
  };
  const body = single(model, `${key}-body`, `${label}: body`, [...path, index, "body"], { options: bodyOptions(model) });
  const rows = vector(model, key, `${label}: ${end}`, [...path, index, end]);
  return [
    { ...body, set: (value) => whole(body.set(value), `{body: ${value}, ${end}: [0, 0, 0]}`) },
    ...rows.map((row, place) => ({
      ...row,
      set: (value: string) => whole(row.set(value), `{body: 0, ${end}: [${[0, 1, 2].map((one) => (one === place ? value : "0")).join(", ")}]}`),
    })),
  ];
}

function itemGroups(model: Model, section: string, where: Path, sort: Sort, item: TreeNode, index: number): Group[] {
  const path: Path = [...where, index];
  const key = `${section}-${index}`;
  const words = `${section.replace(/s$/, "")} ${index + 1}`;
  const actions: Action[] = [{ words: "×", label: `Delete ${words}`, act: () => model.change([remove(path)], `${words} deleted`) }];
  if (index > 0) {
    actions.unshift({ words: "↑", label: `Move ${words} up`, act: () => model.change([{ op: "move", path, before: [...where, index - 1] }], `${words} moved up`) });
  }
  const found = kindOf(model, sort, item);
  if (!found) return [{ label: `${index + 1}`, rows: [single(model, key, words, path, { wide: true })], actions }];
  const [kind, present] = found;
  const known = new Set(kind.fields.map((field) => field.key));
  const others = sort.kinds.filter((one) => one.key === kind.key).flatMap((one) => one.fields);
  const shown = [...kind.fields, ...others.filter((field) => present.includes(field.key) && !known.has(field.key))];
  const head: Group =
    sort.style === "flat"
      ? { label: `${index + 1}`, rows: [single(model, key, `${words}: kind`, [...path, "claim"], { options: sort.kinds.map((one) => [one.key, one.words]), wide: true })], actions }
      : { label: `${index + 1}. ${kind.words}`, rows: [], actions };
  const groups = shown.flatMap((field) => groupsOf(model, `${key}-${field.key.replaceAll(" ", "-")}`, words, placeOf(path, sort, kind, field.key), field));
  if (kind.fields[0]?.sort === "pairs") {
    const place = placeOf(path, sort, kind, "");
    head.actions = [{ words: "+", label: `Add a coordinate to ${words}`, act: () => addPair(model, words, place) }, ...actions];
  }
  return [head, ...groups];
}

async function addPair(model: Model, words: string, path: Path): Promise<void> {
  const fields: Field[] = [
    { key: "coordinate", sort: "text", words: "", optional: false },
    { key: "formula", sort: "formula", words: "", optional: false },
  ];
  await addFields(model, words, fields, (values) => [{ op: "insert", path: [...path, values.get("coordinate")!], source: values.get("formula")! }]);
}

/** Asks for an item at the end of a list; `body` is the one that it is rather about. */
export function addTo(model: Model, section: string, where: Path, title: string, adding: string, body?: string): Promise<void> {
  const { style, kinds } = sortOf(model, section);
  const insert = (source: string): Operation[] => [{ op: "insert", path: [...where, nodeAt(model, where)?.children?.length ?? 0], source }];
  return addItem(model, title, adding, style, kinds, insert, body);
}

/** A section of items: `section` says of which sort, `where` the list stands. */
export function items(model: Model, section: string, where: Path, title: string, adding: string, more: Partial<Section> = {}): Section {
  const list = nodeAt(model, where);
  const found = list?.kind === "sequence" ? (list.children ?? []) : [];
  const sort = sortOf(model, section);
  return {
    title: found.length > 0 ? `${title} (${found.length})` : title,
    key: title,
    groups: () => found.flatMap((item, index) => itemGroups(model, section, where, sort, item, index)),
    actions: [{ words: `Add ${adding}`, label: `Add ${adding}`, act: () => addTo(model, section, where, title, adding) }],
    closed: found.length === 0 || section === "claims",
    ...more,
  };
}
