// The form of one body: Figure 3 of the paper, field by field, and what else a body may have.

import { ask } from "./dialogs.js";
import { make } from "./elements.js";
import { branch } from "./layout.js";
import { entriesOf, nodeAt, remove, set, single, valueOf, vector, type Group, type Row, type Section } from "./fields.js";
import { addFields } from "./formentry.js";
import { items } from "./formitems.js";
import { meaning } from "./formkinds.js";
import { lines } from "./systemform.js";
import type { Model } from "./model.js";
import type { Body, Operation, Path } from "./seam.js";
import { along, SOLIDS } from "./shapes.js";
import { FIXED_WORDS } from "./structure.js";
import { list, turns } from "./turns.js";

function derived(body: Body, key: string): string {
  return body.fields[key]?.derived?.source ?? "";
}

/** Principal moments or the whole tensor, as it is written; which of both is a choice of its own. */
function inertia(model: Model, path: Path): Group[] {
  const whole = nodeAt(model, [...path, "inertia"]);
  const at: Path = whole?.kind === "mapping" ? [...path, "inertia", "tensor"] : [...path, "inertia"];
  const node = nodeAt(model, at);
  const full = node?.kind === "sequence" && node.children?.[0]?.kind === "sequence";
  const about = nodeAt(model, [...path, "inertia about"]);
  const wanted = (): Operation[] => (nodeAt(model, [...path, "inertia about"]) ? [] : [set([...path, "inertia about"], "mass centre")]);
  const groups: Group[] = [
    {
      label: "Inertia about",
      rows: [
        {
          key: "about",
          label: "Inertia about",
          value: valueOf(model, about).replace("center", "centre"),
          options: [["", "–"], ["joint", "joint (connection point)"], ["mass centre", "mass centre"]],
          node: about,
          set: (value) => (value ? [set([...path, "inertia about"], value)] : about ? [remove([...path, "inertia about"])] : []),
        },
      ],
      actions: [
        { words: "Shape…", label: "Inertia of a rod, disc, box, sphere or shell", act: () => helper(model, path, at) },
        {
          words: full ? "Principal" : "Tensor",
          label: full ? "Only the three principal moments" : "All components of the tensor",
          act: () => model.change(() => {
            const rows = full ? [0, 1, 2].map((index) => valueOf(model, nodeAt(model, [...at, index, index])) || "0") : list(model, at);
            const [a, b, c] = [rows[0] ?? "0", rows[1] ?? "0", rows[2] ?? "0"];
            return [set(at, full ? `[${a}, ${b}, ${c}]` : `[[${a}, 0, 0], [0, ${b}, 0], [0, 0, ${c}]]`), ...wanted()];
          }),
        },
      ],
    },
  ];
  if (!full) {
    const rows = vector(model, "inertia", "Principal moment", at).map((row) => ({
      ...row,
      set: (value: string) => {
        const operations = row.set(value);
        return operations.some((one) => one.op === "set") ? [...operations, ...wanted()] : operations;
      },
    }));
    return [...groups, { label: "Principal moments of inertia", rows }];
  }
  for (const line of [0, 1, 2]) {
    const rows = [0, 1, 2].map((column): Row => {
      const own = nodeAt(model, [...at, line, column]);
      return {
        key: `tensor-${line + 1}${column + 1}`,
        label: `Tensor of inertia, row ${line + 1}, column ${column + 1}`,
        value: valueOf(model, own),
        placeholder: "0",
        node: own,
        formula: true,
        // The tensor is symmetric: its two places change together.
        set: (value) => {
          const typed = value.trim() || "0";
          const one = set([...at, line, column], typed);
          return line === column ? [one] : [one, set([...at, column, line], typed)];
        },
      };
    });
    groups.push({ label: line === 0 ? "Tensor of inertia" : `row ${line + 1}`, rows });
  }
  return groups;
}

/** Principal moments of a homogeneous body, put into the form about the mass centre. */
async function helper(model: Model, path: Path, at: Path): Promise<void> {
  const mass = valueOf(model, nodeAt(model, [...path, "mass"])) || "m";
  const kind = make("select", { autofocus: true }, ...SOLIDS.map((solid, index) => make("option", { value: index }, solid.name)));
  // What stretches from its joint to its mass centre mostly does so along its own axis.
  const centre = [0, 1, 2].filter((index) => !["", "0"].includes(valueOf(model, nodeAt(model, [...path, "mass centre", index]))));
  const own = centre.length === 1 ? centre[0]! + 1 : 3;
  const axis = make("select", {}, ...[1, 2, 3].map((one) => make("option", { value: one, selected: one === own }, `axis ${one}`)));
  const sizes = make("div", { class: "sizes-of-shape" });
  const shown = make("output", {});
  const found = (): [string, string, string] => {
    const solid = SOLIDS[Number(kind.value)]!;
    const typed = [...sizes.querySelectorAll("input")].map((input) => input.value.trim() || "0");
    return along(solid.moments(mass, typed), solid.name === "box" ? 3 : Number(axis.value));
  };
  const tell = (): void => {
    shown.textContent = `[${found().join(", ")}], about the mass centre`;
  };
  const draw = (): void => {
    const solid = SOLIDS[Number(kind.value)]!;
    sizes.replaceChildren(...solid.sizes.map(([name, words]) => make("label", {}, words, make("input", { type: "text", value: name, autocomplete: "off", input: tell }))));
    axis.parentElement?.toggleAttribute("hidden", ["box", "sphere", "thin spherical shell"].includes(solid.name));
    tell();
  };
  kind.addEventListener("change", draw);
  axis.addEventListener("change", tell);
  const content = [make("label", {}, "Shape ", kind), make("label", {}, "Its own axis lies along ", axis), sizes, make("p", {}, shown)];
  draw();
  const done = await ask("Inertia of a homogeneous body", content, [
    { words: "Take", value: true, main: true },
    { words: "Cancel", value: false },
  ], false);
  if (!done) return;
  await model.change(() => [set(at, `[${found().join(", ")}]`), set([...path, "inertia about"], "mass centre")], "inertia of a homogeneous body");
}

const ALONG: [string, string][] = [["1", "along axis 1"], ["2", "along axis 2"], ["3", "along axis 3"], ["quaternion", "quaternion"]];

/** Unit vectors and quaternions by name; or one word for all of them. */
function orientation(model: Model, path: Path, owner: string): Section {
  const at: Path = [...path, "orientation"];
  const node = nodeAt(model, at);
  const drop = (name: string) => ({ words: "×", label: `Delete ${name} from orientation`, act: () => model.change([remove([...at, name])], `${name} deleted`) });
  const groups: Group[] = node?.kind === "scalar"
    ? [{ label: "Told by", rows: [single(model, "orientation", "Orientation told by", at, { wide: true })] }]
    : entriesOf(node).map(([name]): Group => ({
        label: name,
        rows: [single(model, `orientation-${name}`, `Orientation: ${name}`, [...at, name], { options: [["", "–"], ...ALONG] })],
        actions: [drop(name)],
      }));
  const act = () => addFields(model, "Orientation: add a vector", [
    { key: "name", sort: "text", words: "a unit vector fixed in the frame before, or a quaternion", optional: false },
    { key: "what", sort: "choice", words: "", optional: false, choices: ALONG.map(([value]) => value) },
  ], (values) => [{ op: "insert", path: [...at, values.get("name")!], source: values.get("what")! }]);
  return { title: "Orientation", owner, groups, actions: [{ words: "Add a vector", label: "Add a vector to orientation", act }], closed: groups.length === 0 };
}

export function bodySections(model: Model, body: Body): Section[] {
  const { path } = body;
  const bodies = model.understood?.bodies ?? [];
  const below = new Set([body.name, ...branch(bodies, body.name)]);
  const parents: [string, string][] = [["0", FIXED_WORDS], ...bodies.filter((one) => !below.has(one.name)).map((one): [string, string] => [one.name, one.name])];
  const general: Group[] = [
    {
      label: "Name",
      rows: [{ key: "name", label: "Name", value: body.name, node: nodeAt(model, [...path, "name"]), wide: true,
        set: (name) => (name.trim() ? [{ op: "rename body", body: body.name, name: name.trim() }] : []) }],
    },
    {
      label: "Previous body",
      rows: [{ key: "parent", label: "Previous body", value: body.parent ?? "0", options: parents, node: nodeAt(model, [...path, "attached to"]),
        set: (to) => [{ op: "reattach", body: body.name, to: to === "0" ? null : to }] }],
    },
    ...turns(model, path),
    { label: "Connection point", rows: vector(model, "point", "Connection point", [...path, "connection point"]) },
    { label: "Relative velocity", rows: vector(model, "velocity", "Relative velocity", [...path, "relative velocity"], components(derived(body, "relative velocity"))) },
    { label: "Mass", rows: [single(model, "mass", "Mass", [...path, "mass"], { formula: true })] },
    { label: "Mass centre", rows: vector(model, "centre", "Mass centre", [...path, "mass centre"]) },
    ...inertia(model, path),
    { label: "Gyrostatic moment", rows: vector(model, "gyro", "Gyrostatic moment", [...path, "gyrostatic moment"]) },
    {
      label: "Coordinates",
      rows: [single(model, "coordinates", "Generalized coordinates", [...path, "coordinates"], {
        value: list(model, [...path, "coordinates"]).join(", "),
        placeholder: components(derived(body, "coordinates")).join(", "),
        wide: true,
        set: (value) => {
          const at: Path = [...path, "coordinates"];
          if (value.trim() === "") return nodeAt(model, at) ? [remove(at)] : [];
          return [set(at, `[${value.replace(/^\s*\[|\]\s*$/g, "").trim()}]`)];
        },
      })],
    },
  ];
  const shown = new Set(["name", "attached to", "rotation", "connection point", "relative velocity", "mass", "mass centre", "mass center", "inertia about", "inertia at", "inertia", "gyrostatic moment", "gyrostatic momentum", "coordinates", "shapes", "speeds", "orientation"]);
  const others = entriesOf(nodeAt(model, path)).filter(([key]) => !shown.has(key));
  const owner = body.name;
  const sections: Section[] = [
    { title: `Body ${bodies.indexOf(body) + 1}: ${body.name}`, key: "body", owner, groups: general.map((group) => ({ ...group, hint: group.hint ?? meaning(model, MEANING[group.label] ?? "") })) },
    { ...lines(model, [...path, "speeds"], "Speeds", "a speed"), owner },
    orientation(model, path, owner),
    items(model, "shapes", [...path, "shapes"], "Shapes", "a shape", { owner }),
  ];
  if (others.length > 0) {
    sections.push({ title: "More of this body", owner, groups: others.map(([key]) => ({ label: key, rows: [single(model, `more-${key}`, key, [...path, key], { wide: true })] })) });
  }
  return sections;
}

/** Groups of the form and the keys of a description that they stand for. */
const MEANING: Record<string, string> = {
  Name: "name",
  "Previous body": "attached to",
  "Numbers of rotation axes": "rotation",
  "Rotation angles": "rotation",
  "Connection point": "connection point",
  "Relative velocity": "relative velocity",
  Mass: "mass",
  "Mass centre": "mass centre",
  "Inertia about": "inertia about",
  "Principal moments of inertia": "inertia",
  "Tensor of inertia": "inertia",
  "Gyrostatic moment": "gyrostatic moment",
  Coordinates: "coordinates",
};

/** What stands between brackets, cut at the outermost commas. */
function components(source: string): string[] {
  const inside = source.trim().replace(/^[[({]/, "").replace(/[\])}]$/, "");
  const parts: string[] = [];
  let [depth, part] = [0, ""];
  for (const character of inside) {
    if ("([{".includes(character)) depth += 1;
    if (")]}".includes(character)) depth -= 1;
    if (character === "," && depth === 0) {
      parts.push(part.trim());
      part = "";
    } else part += character;
  }
  return part.trim() || parts.length > 0 ? [...parts, part.trim()] : [];
}
