import { Vector3 } from "three";

import type { Triple } from "./types.js";

/** Level directions from which azimuths count, right-handed with "up": as mbsym/report/animation.py has them. */
export function level(up: Triple): [Vector3, Vector3] {
  const third = new Vector3(...up).normalize();
  const sizes = [third.x, third.y, third.z].map(Math.abs);
  const least = sizes.indexOf(Math.min(...sizes));
  const most = sizes.indexOf(Math.max(...sizes));
  const first = new Vector3().setComponent(least === most ? (most + 1) % 3 : least, 1);
  first.addScaledVector(third, -first.dot(third)).normalize();
  return [first, new Vector3().crossVectors(third, first)];
}
