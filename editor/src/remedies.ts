// What can be done at once about a complaint in the form: a name that nobody knows becomes a coordinate or a parameter.

import { nodeAt } from "./fields.js";
import type { Model } from "./model.js";
import type { Complaint, Operation, Path, TreeNode } from "./seam.js";
import { list } from "./turns.js";

export interface Remedy {
  words: string;
  act: () => unknown;
}

/** What is positive of a body and of a load. */
const POSITIVE = new Set(["mass", "inertia", "stiffness", "coefficient", "length", "acceleration", "constant", "distance"]);

/** Fields of a body in which a name may be a coordinate. */
const MOVING = new Set(["connection point", "rotation"]);

export function remedies(model: Model, complaint: Complaint, path: Path): Remedy[] {
  const name = (model.understoodText ?? "").slice(complaint.from, complaint.to);
  if (complaint.code !== "unknown-name" || !/^[A-Za-z]\w*$/.test(name)) return [];
  if (/_dot$|_ddot$/.test(name)) return [];
  const found: Remedy[] = [];
  const alone = nodeAt(model, path)?.source?.trim() === name;
  // Pressed when the name has become known meanwhile there is nothing left to do.
  const unknown = (): boolean =>
    (model.understood?.complaints ?? []).some((one) => one.code === complaint.code && model.understoodText?.slice(one.from, one.to) === name);
  const change = (operations: () => Operation[], what: string) => () => model.change(() => (unknown() ? operations() : []), `${name} is ${what} now`);
  if (path[0] === "bodies" && path.length > 3 && MOVING.has(String(path[2]))) {
    found.push({ words: `${name} is a coordinate`, act: change(() => coordinate(model, path.slice(0, 2), name), "a coordinate") });
  }
  found.push({ words: `${name} is a parameter`, act: change(() => parameter(model, name, path, alone), "a parameter") });
  return found;
}

/** What a complaint advises where a parameter is all that its name can be: no slip of the pen, no coordinate. */
const DECLARE = "declare it under 'parameters'";

/** Names that nobody knows and that can only be parameters. */
export function unknownNames(model: Model): Map<string, Complaint> {
  const text = model.understoodText ?? "";
  const found = (model.understood?.complaints ?? []).filter((one) => one.code === "unknown-name" && one.hint === DECLARE);
  return new Map(found.map((one) => [text.slice(one.from, one.to), one] as const).filter(([name]) => /^[A-Za-z]\w*$/.test(name) && !/_dot$|_ddot$/.test(name)));
}

/** Names that something new has brought along become parameters: whoever writes k in a spring means one; `words`: of it. */
export async function declareNew(model: Model, before: Map<string, Complaint>, words: string): Promise<void> {
  const names = [...unknownNames(model)].filter(([name]) => !before.has(name));
  const operations = names.flatMap(([name, complaint]) => {
    const path = pathAt(model.understood?.tree ?? null, complaint.from);
    return parameter(model, name, path, nodeAt(model, path)?.source?.trim() === name);
  });
  if (operations.length === 0) return;
  const list = names.map(([name]) => name).join(", ");
  await model.change(operations, `${words}; ${list} ${names.length === 1 ? "is a parameter" : "are parameters"} now, of the value 1 to begin with`);
}

/** Where in the description a place of the text is. */
function pathAt(node: TreeNode | null, at: number): Path {
  const inner = node?.children?.find((one) => one.from <= at && at < one.to);
  return inner ? pathAt(inner, at) : (node?.path ?? []);
}

/** Those that the body introduces by its angles have to be listed, too, where there is a list. */
function coordinate(model: Model, body: Path, name: string): Operation[] {
  const at: Path = [...body, "coordinates"];
  const known = list(model, at);
  if (nodeAt(model, at)?.kind === "sequence") return known.includes(name) ? [] : [{ op: "insert", path: [...at, known.length], source: name }];
  const derived = model.understood?.bodies.find((one) => one.path.join() === body.join())?.fields["coordinates"]?.derived?.source ?? "";
  const all = derived.replace(/[[\](){}]/g, "").split(",").map((one) => one.trim()).filter(Boolean);
  return [{ op: "set", path: at, source: `[${[...new Set([...all, name])].join(", ")}]` }];
}

/** Positive where it alone is a mass, a length, a stiffness, ...; elsewhere of any sign: which one is nobody's guess. */
function parameter(model: Model, name: string, path: Path, alone: boolean): Operation[] {
  const listed = nodeAt(model, ["parameters"]);
  if (listed?.kind === "sequence") return [{ op: "insert", path: ["parameters", listed.children?.length ?? 0], source: name }];
  const positive = alone && path.some((key) => POSITIVE.has(String(key)));
  return [{ op: "insert", path: ["parameters", name], source: `{sign: ${positive ? "positive" : "real"}, value: 1}` }];
}
