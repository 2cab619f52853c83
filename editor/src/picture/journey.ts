// How much room a motion takes, and whether the system runs away in it.

import { Box3, Vector3 } from "three";

import type { Track } from "./playing.js";
import type { Poses } from "./program.js";
import type { Picture } from "./types.js";

const LOOKS = 160;
/** A motion in a ball so many times larger than the system is seen as a whole; in a larger one the eye goes along. */
const WHOLE = 3;

export class Journey {
  /** The system runs away: the eye goes along. */
  readonly away: boolean;
  readonly middle: Vector3;
  readonly extent: number;
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
    for (let k = 0; k <= LOOKS; k += 1) {
      const values = poses.at(track.state((track.end * k) / LOOKS));
      this.centroid(values, middle);
      if (k === 0) this.start.copy(middle);
      for (const body of picture.bodies) {
        for (const point of [body.origin, body.centre]) {
          place.set(values[point[0]]!, values[point[1]]!, values[point[2]]!);
          if (!Number.isFinite(place.lengthSq())) continue;
          box.expandByPoint(place);
          own.expandByPoint(place.sub(middle));
        }
      }
    }
    const home = new Vector3(...picture.middle);
    const radius = box.isEmpty() ? 0 : box.getSize(place).length() / 2;
    const within = own.isEmpty() ? 0 : own.getSize(place).length() / 2;
    this.away = radius > WHOLE * picture.extent && within < radius / 2;
    this.middle = home;
    this.extent = picture.extent;
    if (this.away || box.isEmpty()) return;
    if (box.getCenter(middle).distanceTo(home) + radius <= 1.1 * picture.extent) return;
    box.expandByPoint(home);
    this.middle = box.getCenter(new Vector3());
    this.extent = Math.max(picture.extent, box.getSize(place).length() / 2 + 0.25 * picture.extent);
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
