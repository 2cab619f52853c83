// Geometries of unit size, and the one that a shape of the description has.

import {
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  CapsuleGeometry,
  ConeGeometry,
  CylinderGeometry,
  Matrix4,
  SphereGeometry,
} from "three";

import type { Shape } from "./types.js";

/** Along the third axis from 0 to 1, of radius 1. */
export function rod(sides = 8): BufferGeometry {
  return new CylinderGeometry(1, 1, 1, sides).rotateX(Math.PI / 2).translate(0, 0, 0.5);
}

/** The head of an arrow: from 0 to 1 along the third axis, of radius 1. */
export function head(): BufferGeometry {
  return new ConeGeometry(1, 1, 10).rotateX(Math.PI / 2).translate(0, 0, 0.5);
}

export function ball(pieces: number): BufferGeometry {
  return new SphereGeometry(1, pieces, Math.ceil(pieces * 0.66));
}

/** A coil of wire along the third axis from 0 to 1, of radius 1: a spring, as a band of triangles. */
export function coil(turns = 8, pieces = 12): BufferGeometry {
  const places: number[] = [];
  const normals: number[] = [];
  const order: number[] = [];
  const count = turns * pieces;
  for (let k = 0; k <= count; k += 1) {
    const angle = (2 * Math.PI * k) / pieces;
    const along = k / count;
    const [x, y] = [Math.cos(angle), Math.sin(angle)];
    for (const side of [-1, 1]) {
      places.push(x, y, Math.min(1, Math.max(0, along + (side * 0.22) / turns)));
      normals.push(x, y, 0);
    }
    if (k < count) order.push(2 * k, 2 * k + 2, 2 * k + 1, 2 * k + 1, 2 * k + 2, 2 * k + 3);
  }
  const found = new BufferGeometry();
  found.setAttribute("position", new BufferAttribute(new Float32Array(places), 3));
  found.setAttribute("normal", new BufferAttribute(new Float32Array(normals), 3));
  found.setIndex(order);
  return found;
}

/** A shape about its middle, in axes of its own, then placed in those of the body. */
export function shapeOf(shape: Shape): BufferGeometry {
  const [a = 1, b = 1, c = 1] = shape.size;
  const made = (() => {
    switch (shape.kind) {
      case "box":
        return new BoxGeometry(a, b, c);
      case "sphere":
        return new SphereGeometry(a, 28, 18);
      case "ellipsoid":
        return new SphereGeometry(1, 28, 18).scale(a, b, c);
      case "cylinder":
        return new CylinderGeometry(a, a, b, 32).rotateX(Math.PI / 2);
      case "capsule":
        return new CapsuleGeometry(a, b, 6, 24).rotateX(Math.PI / 2);
    }
  })();
  const [first, second, third] = shape.axes;
  const turn = new Matrix4().set(
    first[0], second[0], third[0], shape.at[0],
    first[1], second[1], third[1], shape.at[1],
    first[2], second[2], third[2], shape.at[2],
    0, 0, 0, 1,
  );
  return made.applyMatrix4(turn);
}
