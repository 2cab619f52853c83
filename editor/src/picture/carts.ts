// Carts on their tracks, and what springs and dampers of coordinates are: drawn by what the coordinate is.

import { BoxGeometry, BufferGeometry, CylinderGeometry, Group, Material, Matrix4, Mesh, MeshLambertMaterial, Vector3 } from "three";

import { coil, dashpot } from "./forms.js";
import { level } from "./directions.js";
import type { State } from "./program.js";
import type { Body, Hinge, Picture, Triple } from "./types.js";

/** Of the extent: half a cart's length, half its height, half its width, its wheels. */
const CART = { long: 0.13, tall: 0.055, wide: 0.075, wheel: 0.032 };
/** Half a track, and how far before the zero of its coordinate a wall stands at least. */
const TRACK = 2.4;
const WALL = 0.55;
const GREY = 0x9aa2ad;

export type Ranges = Record<string, [number, number]>;

/** How far a cart reaches from its middle. */
export const REACH = CART.long + CART.wheel;

/** Whether gravity acts: what only floats has no wheels and no ground. */
export const isHeavy = (picture: Picture): boolean => picture.arrows.some((arrow) => arrow.of === "gravity");

const place = (values: Float64Array, at: Triple): Vector3 => new Vector3(values[at[0]]!, values[at[1]]!, values[at[2]]!);

/** A spring or a damper of a coordinate, from where that is zero, or from a wall, to the body. */
interface Held {
  mesh: Mesh;
  body: Body;
  hinge: Hinge;
  name: string;
  /** From the zero of the coordinate, along it. */
  begin: number;
  /** Before the middle of the body. */
  before: number;
  aside: Vector3;
  thick: number;
}

export class Carts {
  private moving: { object: Group; body: Body; turn: Matrix4 }[] = [];
  private held: Held[] = [];
  private readonly matrix = new Matrix4();

  constructor(
    private readonly whole: Group,
    picture: Picture,
    values: Float64Array,
    state: State,
    colours: Map<string, number>,
    ranges: Ranges,
  ) {
    const e = picture.extent;
    const heavy = isHeavy(picture);
    for (const body of picture.bodies) {
      for (const hinge of body.joint.hinges) {
        const name = hinge.coordinates[0];
        if (!hinge.slides || !hinge.straight || name === undefined) continue;
        const along = place(values, hinge.along).normalize();
        const zero = place(values, body.origin).addScaledVector(place(values, hinge.along), -(state[name] ?? 0));
        const up = upright(along, new Vector3(...picture.view.up));
        const third = new Vector3().crossVectors(along, up);
        const [least] = ranges[name] ?? [0];
        const wall = Math.min(-WALL * e, least - (CART.long + 0.16) * e);
        const kinds = (["sprung", "damped"] as const).filter((kind) => body.joint[kind].includes(name));
        if (body.cart) {
          const wheels = heavy && Math.abs(along.dot(new Vector3(...picture.view.up))) < 1e-6;
          const turn = new Matrix4().makeBasis(along, up, third);
          const object = cart(e, colours.get(body.name) ?? GREY, wheels);
          this.moving.push({ object, body, turn });
          this.whole.add(object);
          this.fixed(turn, zero, new BoxGeometry(2 * TRACK * e, 0.014 * e, 0.2 * e), [0, -(CART.tall + (wheels ? 2 * CART.wheel : 0) + 0.007) * e, 0]);
          if (kinds.length > 0) {
            const low = -(CART.tall + (wheels ? 2 * CART.wheel : 0)) * e;
            const tall = CART.tall * e * 1.8 - low;
            this.fixed(turn, zero, new BoxGeometry(0.03 * e, tall, 0.2 * e), [wall - 0.015 * e, low + tall / 2, 0]);
          }
        }
        kinds.forEach((kind, k) => {
          const mesh = new Mesh<BufferGeometry, Material>(kind === "sprung" ? coil() : dashpot(), new MeshLambertMaterial({ color: GREY }));
          mesh.matrixAutoUpdate = false;
          mesh.castShadow = true;
          this.whole.add(mesh);
          const aside = up.clone().multiplyScalar(kinds.length > 1 ? (k === 0 ? 0.035 : -0.035) * e : 0);
          const [begin, before] = body.cart ? [wall, CART.long * e] : [0, 0];
          this.held.push({ mesh, body, hinge, name, begin, before, aside, thick: (kind === "sprung" ? 0.028 : 0.02) * e });
        });
      }
    }
  }

  private fixed(turn: Matrix4, zero: Vector3, geometry: BufferGeometry, at: Triple): void {
    const found = new Mesh(geometry.translate(...at), new MeshLambertMaterial({ color: GREY }));
    found.matrixAutoUpdate = false;
    found.matrix.copy(turn).setPosition(zero);
    found.receiveShadow = true;
    this.whole.add(found);
  }

  move(values: Float64Array, state: State): void {
    for (const { object, body, turn } of this.moving) {
      object.matrix.copy(turn).setPosition(place(values, body.origin));
      object.matrixWorldNeedsUpdate = true;
    }
    for (const { mesh, body, hinge, name, begin, before, aside, thick } of this.held) {
      const slope = place(values, hinge.along);
      const along = slope.clone().normalize();
      const origin = place(values, body.origin).add(aside);
      const from = origin.clone().addScaledVector(slope, -(state[name] ?? 0)).addScaledVector(along, begin);
      const to = origin.addScaledVector(along, -before);
      const way = to.sub(from);
      const long = way.length();
      mesh.visible = long > 1e-9;
      if (!mesh.visible) continue;
      const [first, second] = level(way.toArray());
      this.matrix.makeBasis(first.multiplyScalar(thick), second.multiplyScalar(thick), way);
      mesh.matrix.copy(this.matrix).setPosition(from);
      mesh.matrixWorldNeedsUpdate = true;
    }
  }
}

function upright(along: Vector3, up: Vector3): Vector3 {
  const found = up.clone().addScaledVector(along, -up.dot(along));
  return found.length() > 1e-6 ? found.normalize() : level(along.toArray())[0];
}

/** A box, on wheels where it rolls: along the first axis, upright along the second. */
function cart(e: number, colour: number, wheels: boolean): Group {
  const found = new Group();
  found.matrixAutoUpdate = false;
  const add = (geometry: BufferGeometry, color: number): void => {
    const mesh = new Mesh(geometry, new MeshLambertMaterial({ color }));
    mesh.castShadow = mesh.receiveShadow = true;
    found.add(mesh);
  };
  add(new BoxGeometry(2 * CART.long * e, 2 * CART.tall * e, 2 * CART.wide * e), colour);
  if (!wheels) return found;
  for (const x of [-0.6, 0.6]) {
    for (const z of [-1, 1]) {
      const wheel = new CylinderGeometry(CART.wheel * e, CART.wheel * e, 0.022 * e, 20).rotateX(Math.PI / 2);
      add(wheel.translate(x * CART.long * e, -(CART.tall + CART.wheel) * e, z * CART.wide * e), 0x3c434d);
    }
  }
  return found;
}
