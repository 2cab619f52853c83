// Sections of the system's form that are neither lines nor items: matrices, tables, limits, the small parameter.

import { addFields } from "./formentry.js";
import { entriesOf, nodeAt, remove, set, single, valueOf, vector, type Action, type Group, type Section } from "./fields.js";
import type { Field } from "./formkinds.js";
import type { Model } from "./model.js";
import type { Operation, Path } from "./seam.js";
import { names, nameRow } from "./systemform.js";

/** So many numbers have a field each; more stand in one line. */
const MOST_FIELDS = 12;

const wanted = (key: string, sort: Field["sort"] = "text", more: Partial<Field> = {}): Field => ({ key, sort, words: "", optional: false, ...more });

function drop(model: Model, path: Path, label: string): Action {
  return { words: "×", label: `Delete ${label}`, act: () => model.change([remove(path)], `${label} deleted`) };
}

// ---- limits ------------------------------------------------------------------------------------------------------------

export function limits(model: Model): Section {
  const groups = entriesOf(nodeAt(model, ["limits"])).map(([name]): Group => ({
    label: name,
    rows: vector(model, `limits-${name}`, name, ["limits", name], ["least", "greatest"], 2).map((row, index) => ({ ...row, label: `Limits of ${name}: ${index === 0 ? "least" : "greatest"}` })),
    actions: [drop(model, ["limits", name], `limits of ${name}`)],
  }));
  const fields = [wanted("coordinate"), wanted("least", "formula"), wanted("greatest", "formula")];
  const act = () => addFields(model, "Limits: add a coordinate", fields, (values) => [
    { op: "insert", path: ["limits", values.get("coordinate")!], source: `[${values.get("least")!}, ${values.get("greatest")!}]` },
  ]);
  return { title: "Limits", groups, actions: [{ words: "Add limits", label: "Add limits of a coordinate", act }], closed: groups.length === 0 };
}

// ---- the small parameter -----------------------------------------------------------------------------------------------

export function smallParameter(model: Model): Section {
  const root: Path = ["small parameter"];
  const node = nodeAt(model, root);
  const title = "Small parameter";
  if (node?.kind !== "mapping") {
    const groups = node ? [{ label: "Name", rows: [single(model, "small-name", "Small parameter", root)] }] : [];
    const fields = [wanted("name"), wanted("stands in", "text", { optional: true, words: "a parameter or variable that becomes a power of it times itself" }), wanted("power", "text", { optional: true, words: "1, 2, -1 ..." })];
    const act = () => addFields(model, "Small parameter", fields, (values) => {
      const [name, one] = [values.get("name")!, values.get("stands in") ?? ""];
      return [set(root, one ? `{${name}: {powers: {${one}: ${values.get("power") || "1"}}}}` : name)];
    });
    const actions = node ? [] : [{ words: "Add a small parameter", label: "Add a small parameter", act }];
    return { title, groups, actions, closed: !node };
  }
  const groups = entriesOf(node).flatMap(([name]): Group[] => {
    const path: Path = [...root, name];
    const powers = entriesOf(nodeAt(model, [...path, "powers"]));
    const act = () => addFields(model, `Powers of ${name}`, [wanted("name"), wanted("power")], (values) => [{ op: "insert", path: [...path, "powers", values.get("name")!], source: values.get("power")! }]);
    return [
      { label: name, name: nameRow("small", name, title), rows: [], actions: [{ words: "+", label: `Add a power of ${name}`, act }, drop(model, root, `the small parameter ${name}`)] },
      ...powers.map(([one]): Group => ({
        label: `power in ${one}`,
        rows: [single(model, `small-power-${one}`, `Power of ${name} in ${one}`, [...path, "powers", one])],
        actions: powers.length > 1 ? [drop(model, [...path, "powers", one], `the power of ${name} in ${one}`)] : [],
      })),
      names(model, "small-fast", "fast", [...path, "fast"], "Fast variables"),
      names(model, "small-slow", "slow", [...path, "slow"], "Slow variables"),
      { label: "leading", rows: [single(model, "small-leading", "Leading variable", [...path, "leading"], { placeholder: "–" })] },
    ];
  });
  return { title, groups };
}

// ---- tables ------------------------------------------------------------------------------------------------------------

const BETWEEN: [string, string][] = [["", "–"], ["linear", "linear"], ["cubic", "cubic"]];
const OUTSIDE: [string, string][] = [["", "–"], ...["hold", "zero", "extrapolate", "error"].map((word): [string, string] => [word, word])];

export function tables(model: Model): Section {
  const groups = entriesOf(nodeAt(model, ["tables"])).flatMap(([name]) => tableGroups(model, name));
  const fields = [
    wanted("name"),
    wanted("first point", "list", { count: 2, optional: true, words: "argument and value" }),
    wanted("second point", "list", { count: 2, optional: true }),
    wanted("file", "text", { optional: true, words: "in place of points: a file of rows (CSV) beside the description" }),
    wanted("between", "choice", { optional: true, choices: ["linear", "cubic"] }),
  ];
  const act = () => addFields(model, "Tables: add a table", fields, (values) => {
    const points = ["first point", "second point"].map((key) => values.get(key) || "").filter(Boolean);
    const file = values.get("file") || "";
    if (file === "" && points.length < 2) return "a table has two points or more, or a file";
    const between = values.get("between") ? `, between: ${values.get("between")}` : "";
    return [{ op: "insert", path: ["tables", values.get("name")!], source: `{${file ? `file: ${file}` : `points: [${points.join(", ")}]`}${between}}` }];
  });
  return { title: "Tables", groups, actions: [{ words: "Add a table", label: "Add a table", act }], closed: groups.length === 0 };
}

function tableGroups(model: Model, name: string): Group[] {
  const path: Path = ["tables", name];
  const points = nodeAt(model, [...path, "points"]);
  const found = points?.kind === "sequence" ? (points.children ?? []) : [];
  const row = (key: string, options?: [string, string][]): Group => ({ label: key, rows: [single(model, `tables-${name}-${key}`, `Table ${name}: ${key}`, [...path, key], options ? { options } : { wide: true, placeholder: "–" })] });
  const act = () => addFields(model, `Table ${name}: add a point`, [wanted("argument", "formula"), wanted("value", "formula")], (values) => [
    { op: "insert", path: [...path, "points", nodeAt(model, [...path, "points"])?.children?.length ?? 0], source: `[${values.get("argument")!}, ${values.get("value")!}]` },
  ]);
  const each = found.length <= MOST_FIELDS;
  const pairs = found.map((_, index): Group => ({
    label: `point ${index + 1}`,
    rows: ["argument", "value"].map((what, column) => single(model, `tables-${name}-${index}-${what}`, `Table ${name}, point ${index + 1}: ${what}`, [...path, "points", index, column], { formula: true })),
    actions: found.length > 2 ? [drop(model, [...path, "points", index], `point ${index + 1} of ${name}`)] : [],
  }));
  return [
    { label: name, name: nameRow("tables", name, "Tables"), rows: [], actions: [...(found.length > 0 ? [{ words: "+", label: `Add a point to ${name}`, act }] : []), drop(model, path, `table ${name}`)] },
    ...(found.length === 0 ? [row("file"), row("columns"), row("sha256")] : each ? pairs : [row("points")]),
    row("between", BETWEEN),
    row("outside", OUTSIDE),
    row("unit"),
  ];
}

// ---- a system given by its matrices --------------------------------------------------------------------------------------

const MATRICES: [string, string][] = [["M", "mass"], ["D", "damping"], ["G", "gyroscopic"], ["C", "velocities, D + G"], ["K", "stiffness"], ["N", "circulatory"], ["S", "positions, K + N"], ["A", "x' = A x"], ["B", "inputs"]];

const [SYMMETRIC, SKEW] = [["M", "D", "K"], ["G", "N"]];

function negated(formula: string): string {
  if (formula === "0") return formula;
  if (/^-[\w.*/]+$/.test(formula)) return formula.slice(1);
  return /^[\w.*/]+$/.test(formula) ? `-${formula}` : `-(${formula})`;
}

export function linearSystem(model: Model): Section[] {
  const root: Path = ["linear system"];
  const node = nodeAt(model, root);
  if (!node) return [];
  const count = nodeAt(model, [...root, "coordinates"])?.children?.length ?? 0;
  const present = MATRICES.filter(([key]) => nodeAt(model, [...root, key]));
  const absent = MATRICES.filter(([key]) => !nodeAt(model, [...root, key]));
  const zero = (key: string): string => {
    const columns = key === "B" ? Math.max(1, entriesOf(nodeAt(model, ["inputs"])).length) : count;
    const entry = (row: number, column: number): string => (key === "M" && row === column ? "1" : "0");
    return `[${Array.from({ length: count }, (_, row) => `[${Array.from({ length: columns }, (_, column) => entry(row, column)).join(", ")}]`).join(", ")}]`;
  };
  const act = () => addFields(model, "Linear system: add a matrix", [wanted("matrix", "choice", { choices: absent.map(([key]) => key), words: absent.map(([key, words]) => `${key}: ${words}`).join("; ") })], (values): Operation[] => [
    { op: "insert", path: [...root, values.get("matrix")!], source: zero(values.get("matrix")!) },
  ]);
  const groups = [names(model, "linear-coordinates", "Coordinates", [...root, "coordinates"]), ...present.flatMap(([key, words]) => matrixGroups(model, [...root, key], key, words))];
  return [{ title: "Linear system", groups, actions: absent.length > 0 ? [{ words: "Add a matrix", label: "Add a matrix", act }] : [] }];
}

function matrixGroups(model: Model, path: Path, key: string, words: string): Group[] {
  const node = nodeAt(model, path);
  const rows = node?.kind === "sequence" ? (node.children ?? []) : [];
  const actions = [drop(model, path, `the matrix ${key}`)];
  const columns = rows[0]?.kind === "sequence" ? (rows[0].children?.length ?? 0) : 0;
  if (columns === 0 || columns > 6 || rows.some((row) => row.children?.length !== columns)) {
    return [{ label: `${key}: ${words}`, rows: [single(model, `linear-${key}`, `Matrix ${key}`, path, { wide: true, value: valueOf(model, node) })], actions }];
  }
  return rows.map((_, row): Group => ({
    label: row === 0 ? `${key}: ${words}` : `row ${row + 1}`,
    matrix: true,
    rows: Array.from({ length: columns }, (_, column) => ({
      ...single(model, `linear-${key}-${row + 1}-${column + 1}`, `Matrix ${key}, row ${row + 1}, column ${column + 1}`, [...path, row, column], { formula: true }),
      set: (typed: string) => {
        const value = typed.trim() || "0";
        const [one, other] = [set([...path, row, column], value), [...path, column, row]];
        // What belongs together changes together.
        if (row === column || !(SYMMETRIC.includes(key) || SKEW.includes(key))) return [one];
        return [one, set(other, SKEW.includes(key) ? negated(value) : value)];
      },
    })),
    ...(row === 0 ? { actions } : {}),
  }));
}
