// Geometries of unit size, and the one that a shape of the description has.

import {
  BoxGeometry,
  BufferGeometry,
  CapsuleGeometry,
  CatmullRomCurve3,
  ConeGeometry,
  CylinderGeometry,
  Float32BufferAttribute,
  LatheGeometry,
  Matrix4,
  SphereGeometry,
  TubeGeometry,
  Vector2,
  Vector3,
} from "three";

import type { Shape, Triple } from "./types.js";

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

/** A ball on which it is seen that it turns. */
export function globe(pieces: number): BufferGeometry {
  return patched(new SphereGeometry(1, 4 * Math.ceil(pieces / 4), 2 * Math.ceil(pieces / 3)));
}

/** Every other octant a little darker. */
function patched(geometry: BufferGeometry): BufferGeometry {
  const places = geometry.getAttribute("position");
  const shades = Array.from({ length: places.count }, (_, k) => (places.getX(k) * places.getY(k) * (places.getZ(k) || 1) > 0 ? 0.8 : 1));
  geometry.setAttribute("color", new Float32BufferAttribute(shades.flatMap((x) => [x, x, x]), 3));
  return geometry;
}

/** How long a coil is beside its radius when its wire is round. */
const COIL = 9;
const WIRE = 0.16;

/** A coil of wire along the third axis from 0 to 1, of radius 1: a spring, straight at both ends. */
export function coil(turns = 9): BufferGeometry {
  const points = [new Vector3(0, 0, 0), new Vector3(0, 0, 0.06 * COIL)];
  const count = 10 * turns;
  for (let k = 0; k <= count; k += 1) {
    const angle = (2 * Math.PI * turns * k) / count;
    points.push(new Vector3(Math.cos(angle), Math.sin(angle), (0.1 + (0.8 * k) / count) * COIL));
  }
  points.push(new Vector3(0, 0, 0.94 * COIL), new Vector3(0, 0, COIL));
  return new TubeGeometry(new CatmullRomCurve3(points), 3 * count, WIRE, 5).scale(1, 1, 1 / COIL);
}

/** A damper along the third axis from 0 to 1, of radius 1: a rod that goes into a cylinder. */
export function dashpot(): BufferGeometry {
  const profile: [number, number][] = [[0.28, 0], [0.28, 0.3], [1, 0.3], [1, 0.66], [0.28, 0.66], [0.28, 1]];
  return new LatheGeometry(profile.map(([r, z]) => new Vector2(r, z)), 16).rotateX(Math.PI / 2);
}

/** A curve as a tube. */
export function tube(points: Triple[], closed: boolean, radius: number): BufferGeometry {
  const through = (closed ? points.slice(0, -1) : points).map((point) => new Vector3(...point));
  return new TubeGeometry(new CatmullRomCurve3(through, closed), 6 * through.length, radius, 8, closed);
}

/** A shape about its middle, in axes of its own, then placed in those of the body. */
export function shapeOf(shape: Shape): BufferGeometry {
  const [a = 1, b = 1, c = 1] = shape.size;
  const made = (() => {
    switch (shape.kind) {
      case "box":
        return new BoxGeometry(a, b, c);
      case "sphere":
        return globe(28).scale(a, a, a);
      case "ellipsoid":
        return globe(28).scale(a, b, c);
      case "cylinder":
        return patched(new CylinderGeometry(a, a, b, 32).rotateX(Math.PI / 2));
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
