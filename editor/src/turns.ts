// Turns: numbers of axes and angles, of a joint or of a shape.

import { nodeAt, remove, set, valueOf, type Group, type Row } from "./fields.js";
import type { Model } from "./model.js";
import type { Operation, Path } from "./seam.js";

export const AXES: [string, string][] = [["", "–"], ["0", "0"], ["1", "1"], ["2", "2"], ["3", "3"]];

/** The items of a list as a person would say them; none where there is no list. */
export function list(model: Model, path: Path): string[] {
  return (nodeAt(model, path)?.children ?? []).map((child) => valueOf(model, child));
}

/** Up to three turns of what stands at a path: number of the axis, angle; `before` keys and `whose` words. Both lists are written together, or the one place that changes. */
export function turns(model: Model, path: Path, before = "", whose = ""): Group[] {
  const [axesPath, anglesPath] = [[...path, "rotation", "axes"], [...path, "rotation", "angles"]];
  const turn = (index: number): Row[] => {
    const change = (which: "axes" | "angles") => (typed: string): Operation[] => {
      const axes = list(model, axesPath);
      const angles = list(model, anglesPath);
      const both = axes.length > 0 && angles.length > 0;
      const value = typed.trim() || "0";
      const own = which === "axes" ? axes : angles;
      if (both && index < own.length && value !== "") {
        const after = own.map((old, other) => (other === index ? value : old));
        const others = which === "axes" ? angles : axes;
        if (after.every((one) => one === "0") && others.every((one) => one === "0")) return [remove([...path, "rotation"])];
        return own[index] === value ? [] : [set([...path, "rotation", which, index], value)];
      }
      if (typed.trim() === "") return [];
      const length = Math.max(3, axes.length, angles.length);
      const filled = (known: string[], mine: boolean): string =>
        Array.from({ length }, (_, other) => (mine && other === index ? value : (known[other] ?? "0"))).join(", ");
      const [newAxes, newAngles] = [filled(axes, which === "axes"), filled(angles, which === "angles")];
      if (!nodeAt(model, [...path, "rotation"])) return [set([...path, "rotation"], `{axes: [${newAxes}], angles: [${newAngles}]}`)];
      return [set(axesPath, `[${newAxes}]`), set(anglesPath, `[${newAngles}]`)];
    };
    const [axesNode, anglesNode] = [nodeAt(model, [...axesPath, index]), nodeAt(model, [...anglesPath, index])];
    return [
      { key: `${before}axis-${index + 1}`, label: `${whose}Rotation axis ${index + 1}`, value: valueOf(model, axesNode), options: AXES, node: axesNode, set: change("axes") },
      { key: `${before}angle-${index + 1}`, label: `${whose}Rotation angle ${index + 1}`, value: valueOf(model, anglesNode), placeholder: "0", formula: true, node: anglesNode, set: change("angles") },
    ];
  };
  const all = [0, 1, 2].map(turn);
  return [
    { label: "Numbers of rotation axes", rows: all.map(([axis]) => axis!) },
    { label: "Rotation angles", rows: all.map(([, angle]) => angle!) },
  ];
}

