// A picture with everything about it: the canvas, sliders, a motion with its traces, modes, equilibria, and words.

import { Vector3 } from "three";

import { make } from "../elements.js";
import { equilibriaList, inWords, modesList, press, Sliders, valuesTable } from "./controls.js";
import { Journey } from "./journey.js";
import { Swing, told, Track } from "./playing.js";
import { begun, close, Poses, type State } from "./program.js";
import { Stage } from "./stage.js";
import { Traces } from "./traces.js";
import type { Shown } from "./drawing.js";
import type { Coordinate, Equilibria, Modes, Motion, Picture } from "./types.js";
import { say } from "./words.js";
import "./viewer.css";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];
/** Points of a path. */
const PATH = 600;
/** Sliders, traces and words follow a playing motion so often a second. */
const TOLD = 10;

type Playing = { what: "motion"; t: number } | { what: "mode"; k: number; seconds: number } | null;

export class Viewer {
  readonly stage: Stage;
  /** A body was pressed, or none. */
  onSelect: (name: string | null) => void = () => undefined;
  private picture: Picture | null = null;
  private poses: Poses | null = null;
  private state: State = {};
  private touched = false;
  private track: Track | null = null;
  private journey: Journey | null = null;
  private swings: Swing[] = [];
  private equilibria: Equilibria | null = null;
  private playing: Playing = null;
  private going = false;
  private amplitude = 1;
  private lastTold = 0;
  private readonly gone = new Vector3();
  private readonly reduced = matchMedia("(prefers-reduced-motion: reduce)");
  private readonly sliders = new Sliders((name, value) => this.slid(name, value));
  private readonly traces = new Traces((t) => this.go(t));
  private readonly play = make("button", { type: "button", class: "viewer-play", "aria-keyshortcuts": "Space" }, say("Play"));
  private readonly scrub = make("input", { type: "range", min: 0, max: 1, step: "any", value: 0, "aria-label": say("Time") });
  private readonly clock = make("output", { class: "viewer-clock" });
  private readonly speed = make("select", { "aria-label": say("Speed") });
  private readonly bar = make("div", { class: "viewer-bar", hidden: true }, this.play, this.scrub, this.clock, this.speed);
  private readonly said = make("p", { class: "viewer-said", "aria-live": "polite" });
  private readonly sections: Record<"coordinates" | "motion" | "modes" | "equilibria" | "values" | "words", HTMLDetailsElement>;

  constructor(readonly host: HTMLElement) {
    this.stage = new Stage((seconds) => this.step(seconds));
    const section = (title: string, open: boolean, ...inside: Node[]) =>
      make("details", { open, class: "viewer-section" }, make("summary", {}, title), ...inside);
    this.sections = {
      coordinates: section(say("Coordinates"), true, this.sliders.element),
      motion: section(say("Motion"), true),
      modes: section(say("Linear modes"), false),
      equilibria: section(say("Equilibria"), false),
      values: section(say("Values"), false),
      words: section(say("In words"), false),
    };
    for (const name of ["motion", "modes", "equilibria"] as const) this.sections[name].hidden = true;
    this.sections.words.addEventListener("toggle", () => this.tell(true));
    for (const speed of SPEEDS) this.speed.append(make("option", { value: speed, selected: speed === 1 }, `${speed}×`));
    this.play.addEventListener("click", () => this.toggle());
    this.scrub.addEventListener("input", () => this.go(Number(this.scrub.value)));
    const eye = this.stage.eye;
    const press = (words: string, label: string, does: () => void) => make("button", { type: "button", "aria-label": label, title: label, click: does }, words);
    const corner = make("div", { class: "viewer-corner" },
      press("+", say("Closer"), () => eye.closer(1.2)), press("−", say("Further"), () => eye.closer(1 / 1.2)), press("⌂", say("First view"), () => eye.reset()));
    if (!this.stage.broken) this.stage.element.append(corner);
    const main = make("div", { class: "viewer-main" }, this.stage.element, this.bar, ...(this.stage.broken ? [] : [this.switches()]), this.said);
    host.replaceChildren(make("div", { class: "viewer" }, main, make("div", { class: "viewer-side" }, ...Object.values(this.sections))));
    if (!this.stage.broken) {
      eye.listen(this.stage.canvas, (x, y) => this.pressed(x, y));
      this.stage.canvas.addEventListener("keydown", (event) => this.key(event));
    }
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.stage.ink());
    this.stage.resize();
  }

  // ---- what is shown -----------------------------------------------------------------------------------------------

  /** Another picture. Coordinates that somebody has moved stay where they are, if they are still there. */
  show(picture: Picture): void {
    const old = this.touched && this.playing === null ? this.state : {};
    this.picture = picture;
    this.poses = new Poses(picture.program);
    this.state = begun(picture);
    for (const one of picture.coordinates) this.state[one.name] = old[one.name] ?? one.value;
    this.stop();
    this.forget();
    this.sliders.build(picture.coordinates);
    this.sections.values.replaceChildren(this.sections.values.firstElementChild!, valuesTable(picture));
    this.stage.drawing.build(picture, Float64Array.from(this.poses.at(begun(picture))), begun(picture));
    this.stage.ink();
    const { values } = this.poses;
    this.stage.name(picture.bodies.map((body) => body.name), (k) => [values, picture.bodies[k]!.centre]);
    this.stage.eye.look(picture);
    this.place();
  }

  /** A motion, played at once unless the reader wants things still. */
  showMotion(motion: Motion): void {
    this.track = new Track(motion);
    this.traces.show(this.track);
    const { atZero = [] } = this.picture ?? {};
    const first = atZero.length ? [say("Begun where the sliders stood; no initial value is given for [[names]].", { names: atZero.join(", ") })] : [];
    const stays = (column: (number | null)[]) => column.every((x) => Math.abs((x ?? NaN) - (column[0] ?? NaN)) < 1e-12);
    if (this.track.times.length > 1 && Object.values(motion.coordinates).every(stays)) {
      first.unshift(say("No coordinate changes in this motion. From elsewhere, or with a velocity, it may be another."));
    }
    const lines = (sentences: string[]) => sentences.map((text) => make("p", { class: "viewer-soft" }, text));
    const how = make("details", { class: "viewer-how" }, make("summary", {}, say("How it was computed")), ...lines(motion.sentences));
    this.fill("motion", this.traces.element, ...lines([...first, ...motion.doubts]), how);
    const { track, poses } = this;
    if (poses && track.times.length > 1) {
      const count = Math.min(PATH, track.times.length);
      this.journey = new Journey(this.picture!, poses, track);
      const start = begun(this.picture!);
      this.stage.drawing.build(this.picture!, Float64Array.from(poses.at(start)), start, this.journey.ranges);
      this.stage.ink();
      this.stage.eye.fit(this.journey.room);
      this.stage.drawing.trace(count, (k) => poses.at(track.state((track.end * k) / (count - 1))));
    }
    this.playing = { what: "motion", t: 0 };
    this.bar.hidden = false;
    this.scrub.max = String(track.end);
    this.run(!this.reduced.matches);
    this.go(0, this.going);
  }

  showModes(modes: Modes): void {
    const { picture } = this;
    if (!picture) return;
    this.swings = modes.modes.map((mode) => new Swing(modes, mode, picture));
    const size = make("input", { type: "range", min: 0, max: 2, step: 0.05, value: 1, "aria-label": say("Amplitude") });
    size.addEventListener("input", () => {
      this.amplitude = Number(size.value);
      this.stage.wanted();
    });
    const words = (k: number) => this.swings[k]!.words(picture.units.time);
    this.fill("modes", modesList(modes, words, (k) => this.showMode(k)), make("label", { class: "viewer-slider" }, make("span", {}, say("Amplitude")), size));
  }

  showEquilibria(found: Equilibria): void {
    this.equilibria = found;
    this.fill("equilibria", equilibriaList(found, (k) => this.showEquilibrium(k)));
  }

  /** Words in place of a section's content: that something is being computed, or why there is nothing. */
  note(section: "motion" | "modes" | "equilibria", text: string): void {
    this.fill(section, make("p", { class: "viewer-soft" }, text));
  }

  select(name: string | null): void {
    const at = this.picture?.bodies.findIndex((body) => body.name === name) ?? -1;
    this.stage.call(at < 0 ? null : at);
  }

  /** Coordinates that sliders have put elsewhere than the description, and those of which it says nothing: what a motion
   * begins with. */
  moved(): Record<string, string> {
    if (!this.picture) return {};
    const state = this.touched && this.playing === null ? this.state : {};
    const value = (one: Coordinate): number => state[one.name] ?? one.value;
    const { coordinates, atZero } = this.picture;
    const at = coordinates.filter((one) => atZero.includes(one.name) || Math.abs(value(one) - one.value) > 1e-12);
    return Object.fromEntries(at.map((one) => [one.name, value(one).toFixed(9)]));
  }

  private fill(section: "motion" | "modes" | "equilibria", ...inside: Node[]): void {
    const details = this.sections[section];
    details.replaceChildren(details.firstElementChild!, ...inside);
    details.hidden = false;
    details.open = true;
  }

  /** What belonged to another picture. */
  private forget(): void {
    this.track = null;
    this.journey = null;
    this.swings = [];
    this.equilibria = null;
    this.stage.drawing.untrace();
    for (const name of ["motion", "modes", "equilibria"] as const) this.sections[name].hidden = true;
  }

  private showMode(k: number): void {
    this.playing = { what: "mode", k, seconds: 0 };
    this.bar.hidden = false;
    press(this.sections.modes, k);
    press(this.sections.equilibria, null);
    const swing = this.swings[k]!;
    const slower = swing.speed === 1 ? "" : swing.speed < 1 ? say(", shown [[times]] times slower", { times: told(1 / swing.speed) }) : say(", shown [[times]] times faster", { times: told(swing.speed) });
    this.say(`${say("Mode [[number]]", { number: k + 1 })}: ${swing.words(this.picture?.units.time)}${slower}.`);
    this.run(true);
  }

  private showEquilibrium(k: number): void {
    const one = this.equilibria!.equilibria[k]!;
    this.stop();
    press(this.sections.equilibria, k);
    Object.assign(this.state, begun(this.picture!), one.values);
    this.touched = true;
    this.place();
    this.say(`${say("Equilibrium [[number]]", { number: k + 1 })}: ${say(one.verdict.verdict)}.`);
  }

  // ---- moving ------------------------------------------------------------------------------------------------------

  /** One frame; whether there will be another. */
  private step(seconds: number): boolean {
    const { playing, picture, poses } = this;
    if (!picture || !poses) return false;
    if (playing?.what === "motion" && this.track) {
      if (this.going) playing.t += seconds * this.track.rate * Number(this.speed.value);
      if (playing.t > this.track.end) playing.t = 0;
      this.state = this.track.state(playing.t);
      this.stage.drawing.until(this.track.end > 0 ? playing.t / this.track.end : 1);
    } else if (playing?.what === "mode") {
      if (this.going) playing.seconds += seconds * Number(this.speed.value);
      const swing = this.swings[playing.k]!;
      this.state = swing.state(playing.seconds, begun(picture), this.amplitude);
      if (picture.closure) close(poses, picture.closure, this.state, swing.moved);
      this.stage.drawing.until(0);
    } else this.stage.drawing.until(this.track ? 1 : 0);
    const values = poses.at(this.state);
    const offset = this.journey && playing?.what === "motion" ? this.journey.offset(values, this.gone) : this.gone.set(0, 0, 0);
    this.stage.eye.follow(offset);
    this.stage.drawing.carry(offset);
    this.stage.drawing.move(values, this.state);
    this.tell(!this.going);
    return this.going;
  }

  private toggle(): void {
    if (!this.playing && this.track) this.playing = { what: "motion", t: 0 };
    if (this.playing) this.run(!this.going);
  }

  private run(on: boolean): void {
    this.going = on;
    this.play.textContent = on ? say("Pause") : say("Play");
    this.play.setAttribute("aria-pressed", String(on));
    this.stage.wanted();
  }

  private stop(): void {
    this.run(false);
    this.playing = null;
    this.bar.hidden = this.track === null;
    press(this.sections.modes, null);
  }

  private go(t: number, going = false): void {
    if (!this.track) return;
    press(this.sections.modes, null);
    this.playing = { what: "motion", t: Math.min(this.track.end, Math.max(0, t)) };
    this.run(going);
  }

  private slid(name: string, value: number): void {
    const { picture, poses } = this;
    if (!picture || !poses) return;
    this.stop();
    press(this.sections.equilibria, null);
    this.touched = true;
    this.state[name] = value;
    const open = picture.closure ? close(poses, picture.closure, this.state, [name]) : [];
    const gaps = { name, value: told(value), constraints: open.join(", ") };
    const unclosed = say("No position near this one keeps the constraints with [[name]] = [[value]]; open: [[constraints]].", gaps);
    this.say(open.length > 0 ? unclosed : "");
    this.place();
  }

  /** Shows the state as it is. */
  private place(): void {
    this.stage.wanted();
    this.tell(true);
  }

  private key(event: KeyboardEvent): void {
    const end = this.track?.end ?? 0;
    const t = this.playing?.what === "motion" ? this.playing.t : 0;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === " ") this.toggle();
    else if (event.key === ",") this.go(t - end / 100);
    else if (event.key === ".") this.go(t + end / 100);
    else if (!this.stage.eye.key(event)) return;
    event.preventDefault();
  }

  private pressed(x: number, y: number): void {
    if (!this.picture || !this.poses) return;
    const found = this.stage.nearest(this.picture, this.poses.values, x, y);
    const name = found === null ? null : this.picture.bodies[found]!.name;
    this.select(name);
    this.onSelect(name);
  }

  // ---- words -------------------------------------------------------------------------------------------------------

  private say(text: string): void {
    if (this.said.textContent !== text) this.said.textContent = text;
  }

  /** Sliders, clock, traces and words; while something plays not at every frame. */
  private tell(now: boolean): void {
    const stamp = performance.now();
    if (!this.picture || !this.poses || (!now && stamp - this.lastTold < 1000 / TOLD)) return;
    this.lastTold = stamp;
    if (this.sections.coordinates.open) this.sliders.set(this.state);
    const time = this.picture.units.time ? ` ${this.picture.units.time}` : "";
    const { playing } = this;
    this.scrub.hidden = playing?.what === "mode";
    if (playing?.what === "motion") {
      this.scrub.value = String(playing.t);
      this.clock.textContent = `t = ${told(playing.t)}${time}`;
      this.scrub.setAttribute("aria-valuetext", this.clock.textContent);
    } else this.clock.textContent = playing ? say("Mode [[number]]", { number: playing.k + 1 }) : "";
    if (this.track && this.sections.motion.open) this.traces.draw(playing?.what === "motion" ? playing.t : 0);
    const { picture } = this;
    // Also while it moves: what stands there is where bodies are now.
    if (this.sections.words.open) {
      const values = this.poses.at(this.state);
      this.sections.words.replaceChildren(this.sections.words.firstElementChild!, inWords(picture, values));
    }
    if (this.going) return;
    const at = picture.coordinates.map((one) => `${one.name} = ${told(this.state[one.name])}${one.unit ? ` ${one.unit}` : ""}`);
    this.stage.canvas.setAttribute("aria-label", `${picture.name}: ${picture.bodies.map((body) => body.name).join(", ")}. ${at.join(", ")}`);
  }

  private switches(): HTMLElement {
    const names: [keyof Shown, string, string][] = [
      ["names", say("Names"), say("Names of bodies")],
      ["frames", say("Axes"), say("Axes of bodies: the first red, the second green, the third blue")],
      ["arrows", say("Forces"), say("Forces and torques of loads")],
      ["paths", say("Paths"), say("Paths of mass centres")],
      ["inertia", say("Inertia"), say("Ellipsoids of inertia, of rods and in the plane, too")],
    ];
    const { shown } = this.stage.drawing;
    return make("div", { class: "viewer-switches", role: "group", "aria-label": say("Shown in the picture") }, ...names.map(([name, text, title]) => {
      const button = make("button", { type: "button", title, "aria-pressed": String(shown[name]) }, text);
      button.addEventListener("click", () => {
        shown[name] = !shown[name];
        button.setAttribute("aria-pressed", String(shown[name]));
        this.stage.wanted();
      });
      return button;
    }));
  }
}
