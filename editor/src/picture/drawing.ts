// The system as three.js has it: built once from a picture, moved by the values of its program.

import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  Color,
  DirectionalLight,
  DynamicDrawUsage,
  Group,
  InstancedMesh,
  Line as Path,
  LineBasicMaterial,
  LineSegments,
  Material,
  Matrix4,
  Mesh,
  MeshLambertMaterial,
  Object3D,
  PlaneGeometry,
  Quaternion,
  Scene,
  ShadowMaterial,
  Vector3,
} from "three";

import { Carts, isHeavy, type Ranges } from "./carts.js";
import { level } from "./directions.js";
import { ball, coil, dashpot, globe, head, rod, shapeOf, tube } from "./forms.js";
import type { State } from "./program.js";
import type { Body, Line, Picture, Triple } from "./types.js";

/** Told apart by those who see few colours, too (Okabe and Ito), on light and on dark. */
const COLOURS = [0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9, 0x8c6bb1, 0x999933];
const ARROWS = { gravity: 0x8a8f98, force: 0xc62f2f, torque: 0x7b3fb5 };
const AXES = [0xd0453e, 0x3f9b46, 0x3a6fd8];
/** Ellipsoids that are not to scale are so large, as a part of the extent. */
const SYMBOLIC = 0.16;
const LONGEST_ARROW = 0.34;
/** Paths of at most so many bodies, with so many points. */
const PATHS = 12;

export interface Shown {
  frames: boolean;
  arrows: boolean;
  paths: boolean;
  inertia: boolean;
  names: boolean;
}

/** A wall behind what is plane is so far from it; what is so low is held to stand on the ground. */
const BEHIND = 0.3;
const STANDS = 0.03;

const Z = new Vector3(0, 0, 1);

/** Many things of one geometry, each with a matrix of its own. */
class Many {
  readonly mesh: InstancedMesh;

  constructor(geometry: BufferGeometry, material: Material, count: number) {
    this.mesh = new InstancedMesh(geometry, material, Math.max(1, count));
    this.mesh.count = count;
    this.mesh.instanceMatrix.setUsage(DynamicDrawUsage);
    this.mesh.frustumCulled = false;
    this.mesh.castShadow = true;
  }

  colour(k: number, colour: number): void {
    this.mesh.setColorAt(k, new Color(colour));
  }

  set(k: number, matrix: Matrix4): void {
    this.mesh.setMatrixAt(k, matrix);
  }

  done(): void {
    this.mesh.instanceMatrix.needsUpdate = true;
  }
}

const HIDDEN = new Matrix4().makeScale(0, 0, 0);

export class Drawing {
  readonly scene = new Scene();
  private whole = new Group();
  private inks: LineBasicMaterial[] = [];
  private picture: Picture | null = null;
  private turned: { object: Object3D; body: Body | null }[] = [];
  private solids: { many: Many; body: Body; local: Matrix4; k: number }[] = [];
  private carts: Carts | null = null;
  /** By hinge of a joint on the frame, the way to the wall behind it. */
  private wall: Vector3 | null = null;
  private shadow: Mesh | null = null;
  private rods: Record<Line["kind"], { many: Many; lines: Line[]; thick: number }> | null = null;
  private marks: { hinges: Many; slides: Many; joints: Many; centres: Many } | null = null;
  private pulls: { shafts: Many; heads: Many; seconds: Many } | null = null;
  private frames: LineSegments | null = null;
  private trails: Path[] = [];
  private net: { ground: Group; directions: [Vector3, Vector3]; mesh: number } | null = null;
  private readonly sun = new DirectionalLight(0xffffff, 2.1);
  private largest: Record<string, number> = {};
  private readonly matrix = new Matrix4();
  private readonly other = new Matrix4();
  private readonly from = new Vector3();
  private readonly to = new Vector3();
  private readonly turn = new Quaternion();
  shown: Shown = { names: false, frames: false, arrows: false, paths: true, inertia: false };

  constructor() {
    const back = new DirectionalLight(0xffffff, 0.5);
    back.position.set(-2, -1, -1.5);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(1024, 1024);
    this.scene.add(new AmbientLight(0xffffff, 1.25), this.sun, this.sun.target, back, this.whole);
  }

  /** Builds everything anew; `values` are those of the `state` at the start, by which arrows are measured, `ranges` how
   * far coordinates go. */
  build(picture: Picture, values: Float64Array, state: State, ranges: Ranges = {}): void {
    this.clear();
    this.picture = picture;
    const e = picture.extent;
    // Many bodies are drawn finer, so that they do not hide each other.
    const fine = Math.min(1, Math.sqrt(10 / Math.max(1, picture.bodies.length)));
    const number = new Map(picture.bodies.map((body, k) => [body.name, COLOURS[k % COLOURS.length]!]));
    const solid = picture.bodies.filter((body) => body.ellipsoid !== null);
    const balls = this.many(globe(solid.length > 12 ? 14 : 24), solid.length, new MeshLambertMaterial({ transparent: true, opacity: 0.7, vertexColors: true }));
    const symbolic = Math.max(0, ...solid.filter((x) => !x.ellipsoid!.trueSize).map((x) => Math.max(...x.ellipsoid!.halfAxes)));
    solid.forEach((body, k) => {
      const { halfAxes, axes, trueSize } = body.ellipsoid!;
      const scale = trueSize ? 1 : (SYMBOLIC * e) / symbolic;
      const local = columns(axes, halfAxes.map((x) => x * scale) as Triple);
      balls.colour(k, number.get(body.name)!);
      this.solids.push({ many: balls, body, local, k });
    });
    for (const body of picture.bodies) {
      for (const shape of body.shapes) {
        this.solid(shapeOf(shape), number.get(body.name)!, body);
      }
    }
    const owner = new Map(picture.bodies.map((body) => [body.name, body]));
    for (const { body, points, closed } of picture.guides) {
      const parent = owner.get(owner.get(body)!.parent ?? "") ?? null;
      this.solid(tube(points, closed, 0.009 * e), 0x9aa2ad, parent);
    }
    this.carts = new Carts(this.whole, picture, values, state, number, ranges);
    const grey = () => new MeshLambertMaterial();
    const lines = (kind: Line["kind"], geometry: BufferGeometry, thick: number) => {
      const own = picture.lines.filter((line) => line.kind === kind && !(kind === "slide" && isHeld(owner.get(line.of))));
      const many = this.many(geometry, own.length, grey());
      own.forEach((line, k) => many.colour(k, number.get(line.of) ?? 0x7d8590));
      return { many, lines: own, thick: thick * e };
    };
    this.rods = {
      body: lines("body", rod(12), 0.016 * fine),
      link: lines("link", rod(12), 0.016 * fine),
      slide: lines("slide", rod(6), 0.004),
      spring: lines("spring", coil(), 0.028),
      damper: lines("damper", dashpot(), 0.02),
      rod: lines("rod", rod(), 0.009),
    };
    const joints = picture.bodies.flatMap((body) => body.joint.hinges.map((hinge) => ({ body, hinge })));
    this.marks = {
      hinges: this.many(rod(16), joints.filter((x) => !x.hinge.slides).length, grey(), 0x5b6470),
      slides: this.many(rod(4), joints.filter((x) => x.hinge.slides).length, grey(), 0x9aa2ad),
      joints: this.many(ball(8), picture.bodies.filter((body) => turnsOf(body) !== 1).length, grey(), 0x5b6470),
      centres: this.many(ball(8), picture.bodies.filter((body) => body.massive).length, grey()),
    };
    picture.bodies.filter((body) => body.massive).forEach((body, k) => {
      this.marks!.centres.colour(k, number.get(body.name)!);
    });
    this.pulls = {
      shafts: this.many(rod(), picture.arrows.length, grey()),
      heads: this.many(head(), picture.arrows.length, grey()),
      seconds: this.many(head(), picture.arrows.filter((arrow) => arrow.of === "torque").length, grey(), ARROWS.torque),
    };
    this.largest = {};
    picture.arrows.forEach((arrow, k) => {
      this.pulls!.shafts.colour(k, ARROWS[arrow.of]);
      this.pulls!.heads.colour(k, ARROWS[arrow.of]);
      this.largest[arrow.of] = Math.max(this.largest[arrow.of] ?? 0, length(values, arrow.along));
    });
    this.whole.add(this.ground(picture, values));
    this.frames = this.segments(picture.bodies.length * 3, true);
    this.whole.add(this.frames);
    this.move(values, state);
  }

  /** A solid that moves with a body, or stands in the frame. */
  private solid(geometry: BufferGeometry, color: number, body: Body | null): void {
    const object = new Mesh(geometry, new MeshLambertMaterial({ color, vertexColors: geometry.hasAttribute("color") }));
    object.castShadow = object.receiveShadow = true;
    object.matrixAutoUpdate = false;
    this.whole.add(object);
    this.turned.push({ object, body });
  }

  private many(geometry: BufferGeometry, count: number, material: Material, colour?: number): Many {
    const found = new Many(geometry, material, count);
    if (colour !== undefined && material instanceof MeshLambertMaterial) material.color.set(colour);
    this.whole.add(found.mesh);
    return found;
  }

  /** Moves everything to where the values of the state say. */
  move(values: Float64Array, state: State): void {
    const { picture, rods, marks, pulls } = this;
    if (!picture || !rods || !marks || !pulls) return;
    const e = picture.extent;
    const fine = Math.min(1, Math.sqrt(10 / Math.max(1, picture.bodies.length)));
    this.carts?.move(values, state);
    for (const { object, body } of this.turned) {
      if (!body) continue;
      pose(this.matrix, values, body.axes, body.origin);
      object.matrix.copy(this.matrix);
      object.matrixWorldNeedsUpdate = true;
    }
    for (const { many, body, local, k } of this.solids) {
      if (this.shown.inertia || body.ellipsoid!.telling) many.set(k, pose(this.matrix, values, body.axes, body.centre).multiply(local));
      else many.set(k, HIDDEN);
    }
    for (const { many, lines, thick } of Object.values(rods)) {
      lines.forEach((line, k) => many.set(k, this.between(values, line.start, line.end, thick)));
    }
    let [hinges, slides, joints, centres] = [0, 0, 0, 0];
    for (const body of picture.bodies) {
      this.from.set(values[body.origin[0]]!, values[body.origin[1]]!, values[body.origin[2]]!);
      const turns = turnsOf(body);
      if (turns !== 1) {
        const size = turns === 0 ? 0 : 0.024 * fine;
        marks.joints.set(joints++, this.other.makeScale(size * e, size * e, size * e).setPosition(this.from));
      }
      for (const hinge of body.joint.hinges) {
        this.to.set(values[hinge.along[0]]!, values[hinge.along[1]]!, values[hinge.along[2]]!).normalize();
        const held = !hinge.slides && body.parent === null ? this.wall : null;
        const [wide, long] = hinge.slides ? [0.02, 0.1] : [0.021 * fine, 0.075];
        const seen = hinge.slides ? hinge.straight && !isHeld(body) && sliding(body) === 1 : turns <= 1;
        const many = hinge.slides ? marks.slides : marks.hinges;
        const place = hinge.slides ? slides++ : hinges++;
        const moves = hinge.coordinates.length > 0;
        if (seen && moves && held) many.set(place, this.along(this.from.clone().addScaledVector(held, -0.04 / BEHIND), held.clone().normalize(), wide * e, held.length() + 0.04 * e, false));
        else many.set(place, seen && moves ? this.along(this.from, this.to, wide * e, long * e, true) : HIDDEN);
      }
      if (body.massive) {
        this.from.set(values[body.centre[0]]!, values[body.centre[1]]!, values[body.centre[2]]!);
        const size = body.cart ? 0 : (body.ellipsoid || body.shapes.length > 0 ? 0.022 : 0.05) * e * fine;
        marks.centres.set(centres++, this.other.makeScale(size, size, size).setPosition(this.from));
      }
    }
    let torques = 0;
    picture.arrows.forEach((arrow, k) => this.pull(values, arrow, k, arrow.of === "torque" ? torques++ : null));
    for (const many of [...this.solids.map((x) => x.many), ...Object.values(rods).map((x) => x.many)]) many.done();
    for (const many of [...Object.values(marks), ...Object.values(pulls)]) many.done();
    this.moveFrames(values);
  }

  /** A torque has two heads, as in books. */
  private pull(values: Float64Array, arrow: Picture["arrows"][number], k: number, torque: number | null): void {
    const { shafts, heads, seconds } = this.pulls!;
    const e = this.picture!.extent;
    const size = length(values, arrow.along);
    const largest = this.largest[arrow.of] || size;
    const long = LONGEST_ARROW * e * Math.min(2, size / largest);
    if (!this.shown.arrows || !(long > 0.004 * e)) {
      heads.set(k, HIDDEN);
      shafts.set(k, HIDDEN);
      if (torque !== null) seconds.set(torque, HIDDEN);
      return;
    }
    this.from.set(values[arrow.point[0]]!, values[arrow.point[1]]!, values[arrow.point[2]]!);
    this.to.set(values[arrow.along[0]]!, values[arrow.along[1]]!, values[arrow.along[2]]!).divideScalar(size);
    const tip = Math.min(0.07 * e, 0.6 * long);
    shafts.set(k, this.along(this.from, this.to, 0.006 * e, long - tip, false));
    const end = this.from.clone().addScaledVector(this.to, long - tip);
    heads.set(k, this.along(end, this.to, 0.02 * e, tip, false));
    if (torque === null) return;
    end.addScaledVector(this.to, -0.6 * tip);
    seconds.set(torque, this.along(end, this.to, 0.02 * e, tip, false));
  }

  private between(values: Float64Array, start: Triple, end: Triple, thick: number): Matrix4 {
    this.from.set(values[start[0]]!, values[start[1]]!, values[start[2]]!);
    this.to.set(values[end[0]]!, values[end[1]]!, values[end[2]]!).sub(this.from);
    const long = this.to.length();
    if (!(long > 0)) return HIDDEN;
    return this.along(this.from, this.to.divideScalar(long), thick, long, false);
  }

  /** Unit geometries along the third axis, laid from a point (or about it) in a direction. */
  private along(from: Vector3, direction: Vector3, thick: number, long: number, about: boolean): Matrix4 {
    this.turn.setFromUnitVectors(Z, direction);
    const place = about ? from.clone().addScaledVector(direction, -long / 2) : from;
    return this.matrix.compose(place, this.turn, new Vector3(thick, thick, long));
  }

  private moveFrames(values: Float64Array): void {
    const { frames, picture } = this;
    if (!frames || !picture) return;
    frames.visible = this.shown.frames;
    if (!frames.visible) return;
    const places = frames.geometry.getAttribute("position") as BufferAttribute;
    const long = 0.16 * picture.extent;
    picture.bodies.forEach((body, b) => {
      body.axes.forEach((axis, i) => {
        const at = 2 * (3 * b + i);
        const [x, y, z] = body.origin.map((k) => values[k]!) as Triple;
        places.setXYZ(at, x, y, z);
        places.setXYZ(at + 1, x + long * values[axis[0]]!, y + long * values[axis[1]]!, z + long * values[axis[2]]!);
      });
    });
    places.needsUpdate = true;
  }

  private segments(count: number, coloured: boolean): LineSegments {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(6 * count), 3));
    if (coloured) {
      const colours = Array.from({ length: count }, (_, k) => new Color(AXES[k % 3]!)).flatMap((c) => [c.r, c.g, c.b, c.r, c.g, c.b]);
      geometry.setAttribute("color", new BufferAttribute(new Float32Array(colours), 3));
    }
    const material = new LineBasicMaterial(coloured ? { vertexColors: true } : {});
    if (!coloured) this.inks.push(material);
    const found = new LineSegments(geometry, material);
    found.frustumCulled = false;
    return found;
  }

  /** A faint net that takes the shadows: a wall behind what is plane, else the ground, below the system or at the height
   * on which it stands; its meshes are 1, 2 or 5 times a power of ten. */
  private ground(picture: Picture, values: Float64Array): Group {
    const { up, plane } = picture.view;
    const e = picture.extent;
    const least = 0.25 * e;
    const ten = 10 ** Math.floor(Math.log10(least));
    const mesh = least / ten > 5 ? 10 * ten : least / ten > 2 ? 5 * ten : 2 * ten;
    const count = Math.max(2, Math.ceil((2.6 * e) / mesh));
    const above = new Vector3(...up);
    const azimuth = (picture.view.azimuth * Math.PI) / 180;
    const [ahead, aside] = level(up);
    const towards = ahead.clone().multiplyScalar(Math.cos(azimuth)).addScaledVector(aside, Math.sin(azimuth));
    const normal = plane ? towards : above;
    const centre = new Vector3(...picture.middle);
    const heights = picture.bodies.flatMap((body) => [body.origin, body.centre]).map((at) => this.from.set(values[at[0]]!, values[at[1]]!, values[at[2]]!).dot(above));
    const stands = picture.frame === "0" && Math.min(...heights) > -STANDS * e && centre.dot(above) > -0.2 * e && isHeavy(picture);
    const height = plane ? centre.dot(normal) - BEHIND * e : stands ? 0 : centre.dot(above) - 1.08 * e;
    this.wall = plane && picture.frame === "0" ? normal.clone().multiplyScalar(-BEHIND * e) : null;
    const middle = centre.addScaledVector(normal, height - centre.dot(normal));
    const [first, second] = level(normal.toArray());
    for (const direction of [first, second]) middle.addScaledVector(direction, Math.round(middle.dot(direction) / mesh) * mesh - middle.dot(direction));
    const lines = this.segments(2 * (2 * count + 1), false);
    const places = lines.geometry.getAttribute("position") as BufferAttribute;
    let at = 0;
    for (const [a, b] of [[first, second], [second, first]] as const) {
      for (let k = -count; k <= count; k += 1) {
        for (const side of [-1, 1]) {
          const p = middle.clone().addScaledVector(a, k * mesh).addScaledVector(b, side * count * mesh);
          places.setXYZ(at, p.x, p.y, p.z);
          at += 1;
        }
      }
    }
    lines.renderOrder = -2;
    this.shadow = new Mesh(new PlaneGeometry(2 * count * mesh, 2 * count * mesh), new ShadowMaterial({ opacity: 0.2 }));
    this.shadow.receiveShadow = true;
    this.shadow.renderOrder = -1;
    this.shadow.quaternion.setFromUnitVectors(Z, normal);
    this.shadow.position.copy(middle).addScaledVector(normal, -0.002 * e);
    const ground = new Group();
    ground.add(lines, this.shadow);
    this.net = { ground, directions: [first, second], mesh };
    // From above, from the left, and from where the eye is.
    const right = new Vector3().crossVectors(above, towards);
    const light = above.clone().multiplyScalar(plane ? 1.1 : 2.2).addScaledVector(right, -0.7).addScaledVector(towards, plane ? 1.6 : 1);
    this.sun.userData["way"] = light.normalize().multiplyScalar(6 * e);
    const { camera } = this.sun.shadow;
    const room = 1.9 * e;
    Object.assign(camera, { left: -room, right: room, top: room, bottom: -room, near: 0.5 * e, far: 14 * e });
    camera.updateProjectionMatrix();
    this.sun.shadow.normalBias = 0.004 * e;
    this.carry(new Vector3());
    return ground;
  }

  /** Light and net go along with what runs away, the net by whole meshes. */
  carry(offset: Vector3): void {
    if (!this.net || !this.picture) return;
    const { ground, directions, mesh } = this.net;
    ground.position.set(0, 0, 0);
    for (const direction of directions) ground.position.addScaledVector(direction, Math.round(offset.dot(direction) / mesh) * mesh);
    this.sun.target.position.set(...this.picture.middle).add(offset);
    this.sun.position.copy(this.sun.target.position).add(this.sun.userData["way"] as Vector3);
  }

  /** The paths of mass centres: `at(k)` gives the values of the k-th of `count` moments. */
  trace(count: number, at: (k: number) => Float64Array): void {
    this.untrace();
    const massive = this.picture?.bodies.map((body, k) => ({ body, k })).filter((x) => x.body.massive).slice(0, PATHS) ?? [];
    const places = massive.map(() => new Float32Array(3 * count));
    for (let m = 0; m < count; m += 1) {
      const values = at(m);
      massive.forEach(({ body }, i) => body.centre.forEach((k, c) => (places[i]![3 * m + c] = values[k]!)));
    }
    massive.forEach(({ k }, i) => {
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new BufferAttribute(places[i]!, 3));
      const path = new Path(geometry, new LineBasicMaterial({ color: COLOURS[k % COLOURS.length]! }));
      path.frustumCulled = false;
      this.trails.push(path);
      this.whole.add(path);
    });
  }

  /** Paths up to a part of the way. */
  until(part: number): void {
    for (const path of this.trails) {
      path.visible = this.shown.paths;
      const count = path.geometry.getAttribute("position").count;
      path.geometry.setDrawRange(0, Math.max(0, Math.ceil(part * count)));
    }
  }

  untrace(): void {
    for (const path of this.trails) {
      this.whole.remove(path);
      path.geometry.dispose();
      (path.material as Material).dispose();
    }
    this.trails = [];
  }

  ink(colour: string, dark: boolean): void {
    for (const material of this.inks) material.color.set(colour);
    if (this.shadow) (this.shadow.material as ShadowMaterial).opacity = dark ? 0.55 : 0.18;
  }

  private clear(): void {
    this.untrace();
    this.whole.traverse((object) => {
      if (object instanceof Mesh || object instanceof LineSegments) {
        object.geometry.dispose();
        (object.material as Material).dispose();
        if (object instanceof InstancedMesh) object.dispose();
      }
    });
    this.whole.clear();
    this.turned = [];
    this.solids = [];
    this.inks = [];
  }
}

/** The coordinates that slide a body. */
function sliding(body: Body): number {
  return body.joint.hinges.filter((hinge) => hinge.slides).length;
}

/** Whether something else shows along what a body slides: a track, a spring, a damper. */
function isHeld(body: Body | undefined): boolean {
  if (!body) return false;
  const tied = [...body.joint.sprung, ...body.joint.damped];
  return body.cart || body.joint.hinges.some((hinge) => hinge.slides && hinge.coordinates.some((name) => tied.includes(name)));
}

/** The angles about which a joint turns; one that turns about a single axis is drawn as its hinge. */
function turnsOf(body: Body): number {
  return body.joint.hinges.filter((hinge) => !hinge.slides && hinge.coordinates.length > 0).length;
}

function length(values: Float64Array, along: Triple): number {
  const found = Math.hypot(values[along[0]]!, values[along[1]]!, values[along[2]]!);
  return Number.isFinite(found) ? found : 0;
}

/** Body axes in rows as the columns of a matrix: it takes points of the body to the frame. */
function pose(to: Matrix4, v: Float64Array, [a, b, c]: Body["axes"], o: Triple): Matrix4 {
  return to.set(
    v[a[0]]!, v[b[0]]!, v[c[0]]!, v[o[0]]!,
    v[a[1]]!, v[b[1]]!, v[c[1]]!, v[o[1]]!,
    v[a[2]]!, v[b[2]]!, v[c[2]]!, v[o[2]]!,
    0, 0, 0, 1,
  );
}

function columns([a, b, c]: [Triple, Triple, Triple], scale: Triple): Matrix4 {
  const [x, y, z] = scale;
  return new Matrix4().set(
    x * a[0], y * b[0], z * c[0], 0,
    x * a[1], y * b[1], z * c[1], 0,
    x * a[2], y * b[2], z * c[2], 0,
    0, 0, 0, 1,
  );
}
