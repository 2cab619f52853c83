// Where the bodies stand in the graph: a tidy tree, the fixed axes on top.

import { hierarchy, tree } from "d3-hierarchy";

import type { Body } from "./seam.js";

/** The fixed axes, body 0: no body has an empty name. */
export const FIXED = "";

export interface Placed {
  name: string;
  parent: string | null;
  children: string[];
  x: number;
  y: number;
  level: number;
  /** So many bodies are folded away below. */
  hidden: number;
}

export interface Layout {
  nodes: Map<string, Placed>;
  /** From top to bottom, from left to right. */
  order: string[];
  width: number;
  height: number;
}

export const NODE = { width: 148, height: 46, across: 168, down: 80, margin: 16 };

interface Item {
  name: string;
  children: Item[];
  hidden: number;
}

/** Names of the bodies that hang on `name`, directly or not, in the order of the description. */
export function branch(bodies: Body[], name: string): string[] {
  const inside = new Set([name]);
  // A body may stand before the one it hangs on.
  for (let grown = true; grown; ) {
    grown = false;
    for (const body of bodies) {
      if (!inside.has(body.name) && inside.has(body.parent ?? FIXED)) {
        inside.add(body.name);
        grown = true;
      }
    }
  }
  inside.delete(name);
  return bodies.map((body) => body.name).filter((one) => inside.has(one));
}

/** A body that hangs on itself, or on one that does not exist, is drawn on the fixed axes: complaints tell of it. */
function items(bodies: Body[], folded: ReadonlySet<string>): Item {
  const known = new Set(bodies.map((body) => body.name));
  const reached = new Set(branch(bodies, FIXED));
  const root: Item = { name: FIXED, children: [], hidden: 0 };
  const all = new Map<string, Item>([[FIXED, root]]);
  for (const body of bodies) if (!all.has(body.name)) all.set(body.name, { name: body.name, children: [], hidden: 0 });
  const placed = new Set<string>();
  for (const body of bodies) {
    if (placed.has(body.name)) continue;
    placed.add(body.name);
    const parent = body.parent !== null && known.has(body.parent) && reached.has(body.name) ? body.parent : FIXED;
    all.get(parent)!.children.push(all.get(body.name)!);
  }
  for (const name of folded) {
    const item = all.get(name);
    if (!item || item.children.length === 0) continue;
    item.hidden = branch(bodies, name).length;
    item.children = [];
  }
  return root;
}

export function laidOut(bodies: Body[], folded: ReadonlySet<string>): Layout {
  const root = tree<Item>().nodeSize([NODE.across, NODE.down]).separation((a, b) => (a.parent === b.parent ? 1 : 1.15))(
    hierarchy(items(bodies, folded)),
  );
  let [left, right, bottom] = [0, 0, 0];
  root.each((node) => {
    left = Math.min(left, node.x);
    right = Math.max(right, node.x);
    bottom = Math.max(bottom, node.y);
  });
  const nodes = new Map<string, Placed>();
  root.each((node) => {
    nodes.set(node.data.name, {
      name: node.data.name,
      parent: node.parent?.data.name ?? null,
      children: node.children?.map((child) => child.data.name) ?? [],
      x: node.x - left + NODE.width / 2 + NODE.margin,
      y: node.y + NODE.height / 2 + NODE.margin,
      level: node.depth + 1,
      hidden: node.data.hidden,
    });
  });
  return {
    nodes,
    order: [...nodes.keys()],
    width: right - left + NODE.width + 2 * NODE.margin,
    height: bottom + NODE.height + 2 * NODE.margin + 16,
  };
}
