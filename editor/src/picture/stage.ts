// The canvas: three's renderer, drawn when something has changed, as finely as the machine keeps up with.

import { BasicShadowMap, Color, PCFShadowMap, SRGBColorSpace, Vector3, WebGLRenderer } from "three";

import { make, makeSvg } from "../elements.js";
import { Eye } from "./camera.js";
import { Drawing } from "./drawing.js";
import { Flat } from "./flat.js";
import { inks } from "./inks.js";
import type { Picture } from "./types.js";
import { say } from "./words.js";

/** Where frames take longer than this, in milliseconds and on the average, they are drawn coarser; shorter than that,
 * finer again. */
const SLOW = 33;
const QUICK = 14;
const COARSEST = 0.5;
/** So many frames make an average. */
const JUDGED = 12;

export class Stage {
  readonly element: HTMLElement;
  readonly canvas = make("canvas", { tabindex: 0, role: "img", class: "viewer-canvas", "aria-label": say("Picture: nothing drawn yet") });
  readonly drawing = new Drawing();
  readonly eye = new Eye(() => this.wanted());
  /** Why nothing can be drawn; "" where it can. */
  readonly broken: string;
  /** Milliseconds of the last frames, in script and in all: for measuring. */
  readonly spent: number[] = [];
  private readonly renderer: WebGLRenderer | Flat | null;
  private readonly corner = makeSvg("svg", { class: "viewer-axes", viewBox: "-40 -40 80 80", "aria-hidden": "true" });
  private labels: HTMLElement[] = [];
  private asked = false;
  private fine = 1;
  private last = 0;
  private called: number | null = null;
  private moving = false;
  private frames = 0;
  private took = 0;
  private quick = 0;

  constructor(private readonly before: (seconds: number) => boolean) {
    let broken = "";
    this.renderer = drawnBy(this.canvas);
    if (!this.renderer) broken = say("This browser draws nothing (neither WebGL nor a flat canvas): positions are told below in words.");
    this.broken = broken;
    this.element = make("div", { class: "viewer-stage" }, broken ? make("p", {}, broken) : this.canvas);
    if (broken) return;
    this.element.append(this.corner);
    new ResizeObserver(() => this.resize()).observe(this.element);
    this.canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    this.canvas.addEventListener("webglcontextrestored", () => this.wanted());
  }

  /** Something has changed: one frame is drawn, however many ask for it. Where nothing can be drawn, time goes on. */
  wanted(): void {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame((stamp) => this.frame(stamp));
  }

  private frame(stamp: number): void {
    this.asked = false;
    const began = performance.now();
    const since = this.last ? Math.min(0.25, (stamp - this.last) / 1000) : 0;
    const going = this.before(this.moving ? since : 0);
    if (!this.renderer) {
      this.moving = going;
      this.last = going ? stamp : 0;
      if (going) this.wanted();
      return;
    }
    if (going && this.moving && since > 0) this.adapt(1000 * since);
    else if (!going && this.fine < 1) {
      this.fine = 1; // what stands still is drawn as finely as can be
      this.resize();
    }
    this.renderer.render(this.drawing.scene, this.eye.camera);
    this.label();
    this.axes();
    this.spent.push(performance.now() - began);
    if (this.spent.length > 240) this.spent.shift();
    this.moving = going;
    this.last = going ? stamp : 0;
    if (going) this.wanted();
  }

  private adapt(took: number): void {
    this.frames += 1;
    this.took += took;
    if (this.frames < JUDGED) return;
    const mean = this.took / this.frames;
    this.frames = this.took = 0;
    this.quick = mean < QUICK ? this.quick + 1 : 0;
    if (mean > SLOW && this.fine > COARSEST) this.fine = Math.max(COARSEST, this.fine * 0.8);
    else if (this.quick >= 10 && this.fine < 1) this.fine = Math.min(1, this.fine * 1.2);
    else return;
    this.quick = 0;
    this.resize();
  }

  resize(): void {
    const wide = Math.max(1, this.element.clientWidth);
    const tall = Math.max(1, this.element.clientHeight);
    if (!this.renderer) return;
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1) * this.fine);
    this.renderer.setSize(wide, tall, false);
    this.eye.resize(wide, tall);
    // Changing the size empties the canvas: it is filled again at once.
    this.renderer.render(this.drawing.scene, this.eye.camera);
  }

  ink(): void {
    const found = inks(this.element, { line: "#c9ced6", back: "#ffffff" });
    const back = new Color(found.back);
    this.drawing.ink(found.line, back.getHSL({ h: 0, s: 0, l: 0 }).l < 0.4);
    this.drawing.scene.background = back;
    this.wanted();
  }

  /** The body nearest to a place of the canvas, if one is near. */
  nearest(picture: Picture, values: Float64Array, x: number, y: number): number | null {
    let [found, least] = [null as number | null, 28];
    picture.bodies.forEach((body, k) => {
      for (const point of [body.centre, body.origin]) {
        const [px, py] = this.projected(values, point);
        const far = Math.hypot(px - x, py - y);
        if (far < least) [found, least] = [k, far];
      }
    });
    return found;
  }

  private projected(values: Float64Array, point: [number, number, number]): [number, number] {
    const place = new Vector3(...(point.map((k) => values[k]!) as [number, number, number])).project(this.eye.camera);
    return [((place.x + 1) / 2) * this.element.clientWidth, ((1 - place.y) / 2) * this.element.clientHeight];
  }

  /** Bodies with their names, and where they are, looked up at every frame. */
  name(names: string[], place: (body: number) => [Float64Array, [number, number, number]]): void {
    this.labels.forEach((label) => label.remove());
    this.called = null;
    this.labels = names.map((name) => make("div", { class: "viewer-name", "aria-hidden": "true", hidden: true }, name));
    this.element.append(...this.labels);
    this.place = place;
  }

  /** A name beside a body: that which was pressed. */
  call(body: number | null): void {
    this.called = body;
    this.wanted();
  }

  private place: ((body: number) => [Float64Array, [number, number, number]]) | null = null;

  private label(): void {
    this.labels.forEach((label, k) => {
      label.hidden = k !== this.called && !this.drawing.shown.names;
      if (label.hidden || !this.place) return;
      const [x, y] = this.projected(...this.place(k));
      label.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
    });
  }

  /** The directions of the axes of the frame, in a corner. */
  private axes(): void {
    const turn = this.eye.camera.quaternion.clone().invert();
    this.corner.replaceChildren(
      ...[0, 1, 2].flatMap((k) => {
        const way = new Vector3().setComponent(k, 1).applyQuaternion(turn);
        if (Math.hypot(way.x, way.y) < 0.1) return []; // it points at the eye, or away
        const at = (far: number) => [far * way.x, -far * way.y] as const;
        const [[x, y], [u, v]] = [at(24), at(33)];
        return [makeSvg("line", { x1: 0, y1: 0, x2: x, y2: y }), makeSvg("text", { x: u, y: v }, String(k + 1))];
      }),
    );
  }
}

/** What draws on a canvas: a graphics card, or the processor where there is none. */
function drawnBy(canvas: HTMLCanvasElement): WebGLRenderer | Flat | null {
  try {
    if (!document.createElement("canvas").getContext("webgl2")) return new Flat(canvas);
    const found = new WebGLRenderer({ canvas, antialias: !inSoftware(), powerPreference: "high-performance" });
    found.outputColorSpace = SRGBColorSpace;
    found.shadowMap.enabled = true;
    found.shadowMap.type = inSoftware() ? BasicShadowMap : PCFShadowMap;
    return found;
  } catch {
    return null;
  }
}

/** Whether triangles are filled by the processor: smooth edges would cost most of the time there. */
function inSoftware(): boolean {
  const probe = document.createElement("canvas").getContext("webgl2");
  const known = probe?.getExtension("WEBGL_debug_renderer_info");
  const name = probe && known ? String(probe.getParameter(known.UNMASKED_RENDERER_WEBGL)) : "";
  probe?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}
