// The eye: an azimuth and an elevation about "up", a zoom, a place that is looked at. Mouse, touch and keys.

import { PerspectiveCamera, Vector3 } from "three";

import { level } from "./directions.js";
import type { Picture } from "./types.js";

const FIELD = 30;
/** What is to be seen is seen with so much room about it. */
const MARGIN = 1.12;

/** Points of a ball. */
function about(middle: Vector3, radius: number): Vector3[] {
  const ways = [-1, 0, 1].flatMap((x) => [-1, 0, 1].flatMap((y) => [-1, 0, 1].map((z) => new Vector3(x, y, z))));
  return ways.filter((way) => way.lengthSq() > 0).map((way) => way.normalize().multiplyScalar(radius).add(middle));
}

export class Eye {
  readonly camera = new PerspectiveCamera(FIELD, 1, 0.01, 1000);
  private up = new Vector3(0, 0, 1);
  private home = { azimuth: 0, elevation: 0, middle: new Vector3(), extent: 1, room: [] as Vector3[] };
  private azimuth = 0;
  private elevation = 0;
  private zoom = 1;
  private target = new Vector3();
  private touched = false;
  /** How far a system that runs away has carried the eye along. */
  private readonly carried = new Vector3();

  constructor(private readonly changed: () => void) {}

  /** Looks at another picture; an eye that somebody has moved stays where it is while the system is of like size. */
  look(picture: Picture): void {
    const { up, azimuth, elevation } = picture.view;
    this.up = new Vector3(...up).normalize();
    const before = this.home;
    const middle = new Vector3(...picture.middle);
    this.home = { azimuth, elevation, middle, extent: picture.extent, room: about(middle, picture.extent) };
    const ratio = picture.extent / before.extent;
    if (!this.touched || ratio > 3 || ratio < 1 / 3) this.reset();
    else this.place();
  }

  reset(): void {
    this.touched = false;
    this.azimuth = this.home.azimuth;
    this.elevation = this.home.elevation;
    this.zoom = 1;
    this.target.copy(this.home.middle).add(this.carried);
    this.place();
  }

  /** All of the points in sight at the first look, in the middle. */
  fit(room: Vector3[]): void {
    if (room.length === 0) return;
    const [right, above] = this.directions(this.home);
    const middle = this.home.middle.clone();
    for (const direction of [right, above]) {
      const along = room.map((point) => point.dot(direction));
      middle.addScaledVector(direction, (Math.min(...along) + Math.max(...along)) / 2 - middle.dot(direction));
    }
    this.home = { ...this.home, middle, room };
    if (!this.touched) this.reset();
    else this.place();
  }

  /** Goes along with what runs away. */
  follow(offset: Vector3): void {
    if (this.carried.equals(offset)) return;
    this.target.add(offset).sub(this.carried);
    this.carried.copy(offset);
    this.place();
  }

  resize(wide: number, tall: number): void {
    this.camera.aspect = wide / Math.max(1, tall);
    this.place();
  }

  turn(across: number, upwards: number): void {
    this.touched = true;
    this.azimuth -= across;
    this.elevation = Math.max(-89.9, Math.min(89.9, this.elevation + upwards));
    this.place();
  }

  closer(factor: number): void {
    this.touched = true;
    this.zoom = Math.max(0.05, Math.min(200, this.zoom * factor));
    this.place();
  }

  /** Moves the picture by parts of its height. */
  pan(across: number, upwards: number): void {
    this.touched = true;
    const seen = (2 * this.home.extent) / this.zoom;
    this.camera.updateMatrixWorld();
    const right = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
    const above = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 1);
    this.target.addScaledVector(right, -across * seen).addScaledVector(above, -upwards * seen);
    this.place();
  }

  /** To the right, upwards and towards the eye. */
  private directions({ azimuth, elevation }: { azimuth: number; elevation: number }): [Vector3, Vector3, Vector3] {
    const { up } = this;
    const [first, second] = level([up.x, up.y, up.z]);
    const a = (azimuth * Math.PI) / 180;
    const e = (Math.max(-89.9, Math.min(89.9, elevation)) * Math.PI) / 180;
    const towards = new Vector3()
      .addScaledVector(first, Math.cos(e) * Math.cos(a))
      .addScaledVector(second, Math.cos(e) * Math.sin(a))
      .addScaledVector(up, Math.sin(e));
    const right = new Vector3().crossVectors(up, towards).normalize();
    return [right, new Vector3().crossVectors(towards, right), towards];
  }

  /** From so far all that there has to be room for is seen. */
  private distance(): number {
    const { room, middle } = this.home;
    const [right, above, towards] = this.directions(this.home);
    const tall = Math.tan((FIELD * Math.PI) / 360);
    const wide = tall * this.camera.aspect;
    const arm = new Vector3();
    const far = room.map((point) => {
      arm.copy(point).sub(middle);
      return MARGIN * Math.max(Math.abs(arm.dot(right)) / wide, Math.abs(arm.dot(above)) / tall) + arm.dot(towards);
    });
    return Math.max(0.5 * this.home.extent, ...far);
  }

  private place(): void {
    const { up } = this;
    const [, , towards] = this.directions({ azimuth: this.azimuth, elevation: this.elevation });
    const far = this.distance() / this.zoom;
    this.camera.up.copy(up);
    this.camera.position.copy(this.target).addScaledVector(towards, far);
    this.camera.near = Math.max(far - 8 * this.home.extent, far / 100);
    this.camera.far = far + 12 * this.home.extent;
    this.camera.lookAt(this.target);
    this.camera.updateProjectionMatrix();
    this.changed();
  }

  /** Listens to a canvas; `clicked` is told of presses that move nothing. */
  listen(canvas: HTMLCanvasElement, clicked: (x: number, y: number) => void): void {
    const held = new Map<number, PointerEvent>();
    let far = 0;
    canvas.addEventListener("pointerdown", (event) => {
      held.set(event.pointerId, event);
      far = 0;
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = held.get(event.pointerId);
      if (!before) return;
      const [x, y] = [event.clientX - before.clientX, event.clientY - before.clientY];
      far += Math.hypot(x, y);
      if (held.size === 1) {
        if (event.buttons !== 1 || event.shiftKey) this.pan(x / canvas.clientHeight, -y / canvas.clientHeight);
        else this.turn(x * 0.4, y * 0.4);
      } else if (held.size === 2) {
        const other = [...held.values()].find((one) => one.pointerId !== event.pointerId)!;
        const apart = (one: PointerEvent) => Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY);
        if (apart(before) > 0) this.closer(apart(event) / apart(before));
        this.pan(x / 2 / canvas.clientHeight, -y / 2 / canvas.clientHeight);
      }
      held.set(event.pointerId, event);
    });
    for (const name of ["pointerup", "pointercancel"] as const) {
      canvas.addEventListener(name, (event) => {
        if (held.delete(event.pointerId) && name === "pointerup" && far < 4) clicked(event.offsetX, event.offsetY);
      });
    }
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this.closer(Math.exp(-event.deltaY / (event.deltaMode === 0 ? 500 : 20)));
      },
      { passive: false },
    );
  }

  /** Does what a key means; false where it means nothing to the eye. */
  key(event: KeyboardEvent): boolean {
    if (event.ctrlKey || event.metaKey || event.altKey) return false;
    const across = { ArrowLeft: -1, ArrowRight: 1 }[event.key] ?? 0;
    const upwards = { ArrowUp: 1, ArrowDown: -1 }[event.key] ?? 0;
    if (across || upwards) {
      if (event.shiftKey) this.pan(across * 0.04, upwards * 0.04);
      else this.turn(-across * 5, upwards * 5);
    } else if (event.key === "+" || event.key === "=") this.closer(1.15);
    else if (event.key === "-") this.closer(1 / 1.15);
    else if (event.key === "0") this.reset();
    else return false;
    return true;
  }
}
