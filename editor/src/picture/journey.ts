// How much room a motion takes, and whether the system runs away in it.

import { Box3, Vector3 } from "three";

import { type Ranges, REACH } from "./carts.js";
import type { Track } from "./playing.js";
import type { Poses } from "./program.js";
import type { Body, Picture } from "./types.js";

const LOOKS = 160;
/** A motion in a ball so many times larger than the system is seen as a whole; in a larger one the eye goes along. */
const WHOLE = 3;
/** There is room for so many times its size. */
const FAR = 5;

export class Journey {
  /** The system runs away: the eye goes along. */
  readonly away: boolean;
  /** Where there has to be room for it; nothing for what runs away. */
  room: Vector3[] = [];
  /** How far each coordinate goes. */
  readonly ranges: Ranges = {};
  private readonly start = new Vector3();

  constructor(
    private readonly picture: Picture,
    poses: Poses,
    track: Track,
  ) {
    const box = new Box3();
    const own = new Box3(); // as its middle sees it
    const place = new Vector3();
    const middle = new Vector3();
    const home = new Vector3(...picture.middle);
    for (let k = 0; k <= LOOKS; k += 1) {
      const state = track.state((track.end * k) / LOOKS);
      const values = poses.at(state);
      for (const { name } of picture.coordinates) {
        const [low, high] = this.ranges[name] ?? [Infinity, -Infinity];
        this.ranges[name] = [Math.min(low, state[name] ?? 0), Math.max(high, state[name] ?? 0)];
      }
      this.centroid(values, middle);
      if (k === 0) this.start.copy(middle);
      for (const body of picture.bodies) {
        for (const point of [body.origin, body.centre]) {
          place.set(values[point[0]]!, values[point[1]]!, values[point[2]]!);
          if (!Number.isFinite(place.lengthSq())) continue;
          box.expandByPoint(place);
          // What grows without end is seen until it leaves.
          if (place.distanceTo(home) < FAR * picture.extent) this.room.push(...around(place, reach(body, picture.extent)));
          own.expandByPoint(place.sub(middle));
        }
      }
    }
    const radius = box.isEmpty() ? 0 : box.getSize(place).length() / 2;
    const within = own.isEmpty() ? 0 : own.getSize(place).length() / 2;
    this.away = radius > WHOLE * picture.extent && within < radius / 2;
    if (this.away || radius < 0.02 * picture.extent) this.room = [];
    else this.room.push(...this.standing(poses.at(track.state(0))));
  }

  /** Ends of lines and points of hoops that bodies do not tell. */
  private standing(values: Float64Array): Vector3[] {
    const { picture } = this;
    const found = picture.lines.flatMap((line) => [line.start, line.end]).map((at) => new Vector3(...at.map((k) => values[k]!)));
    for (const guide of picture.guides) {
      const own = picture.bodies.find((body) => body.name === guide.body)!;
      const parent = picture.bodies.find((body) => body.name === own.parent);
      const middle = new Vector3(...(parent?.origin.map((k) => values[k]!) ?? [0, 0, 0]));
      const far = Math.max(...guide.points.map((point) => Math.hypot(...point)));
      found.push(...around(middle, far));
    }
    return found.filter((point) => Number.isFinite(point.lengthSq()));
  }

  /** How far the system is from where it began, as a whole. */
  offset(values: Float64Array, to: Vector3): Vector3 {
    return this.away ? this.centroid(values, to).sub(this.start) : to.set(0, 0, 0);
  }

  private centroid(values: Float64Array, to: Vector3): Vector3 {
    to.set(0, 0, 0);
    const massive = this.picture.bodies.filter((body) => body.massive);
    const bodies = massive.length > 0 ? massive : this.picture.bodies;
    for (const { centre } of bodies) {
      const [x, y, z] = centre.map((k) => values[k]!) as [number, number, number];
      if (Number.isFinite(x + y + z)) to.add(new Vector3(x, y, z).divideScalar(bodies.length));
    }
    return to;
  }
}

/** How far a body is drawn about its points. */
function reach(body: Body, extent: number): number {
  const shapes = body.shapes.map((shape) => Math.hypot(...shape.at) + Math.hypot(...shape.size));
  const ellipsoid = body.ellipsoid?.trueSize && body.ellipsoid.telling ? body.ellipsoid.halfAxes : [];
  return Math.max((body.cart ? REACH : 0.06) * extent, ...shapes, ...ellipsoid);
}

function around(point: Vector3, far: number): Vector3[] {
  return [0, 1, 2].flatMap((k) => [-far, far].map((x) => point.clone().setComponent(k, point.getComponent(k) + x)));
}
