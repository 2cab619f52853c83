// What the coordinates are at a moment: of a motion, of a mode, or where sliders have put them.

import type { State } from "./program.js";
import type { Mode, Modes, Motion, Picture } from "./types.js";
import { say } from "./words.js";

/** A motion of so many units of time runs at one a second; a shorter or longer one takes LASTS seconds. */
const AS_IT_IS: [number, number] = [4, 30];
const LASTS = 12;

export class Track {
  readonly end: number;
  /** Units of time a second at speed 1. */
  readonly rate: number;
  private readonly columns: [string, Float64Array][];
  readonly times: Float64Array;

  constructor(readonly motion: Motion) {
    this.times = Float64Array.from(motion.times);
    this.end = this.times.at(-1) ?? 0;
    this.rate = this.end >= AS_IT_IS[0] && this.end <= AS_IT_IS[1] ? 1 : this.end / LASTS;
    const columns = { ...motion.coordinates, ...motion.velocities };
    this.columns = Object.entries(columns).map(([name, values]) => [name, Float64Array.from(values, (x) => x ?? NaN)]);
  }

  /** The place of t among the frames: 3.25 is a quarter of the way from frame 3 to frame 4. */
  place(t: number): number {
    const { times } = this;
    let [low, high] = [0, times.length - 1];
    if (high <= 0 || !(t > times[0]!)) return 0;
    if (t >= times[high]!) return high;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (times[middle]! <= t) low = middle;
      else high = middle;
    }
    return low + (t - times[low]!) / (times[high]! - times[low]!);
  }

  /** Between frames coordinates are joined by straight lines. */
  state(t: number): State {
    const place = this.place(t);
    const k = Math.min(Math.floor(place), this.times.length - 1);
    const part = place - k;
    const found: State = { t };
    for (const [name, values] of this.columns) {
      found[name] = part > 0 ? values[k]! + part * (values[k + 1]! - values[k]!) : values[k]!;
    }
    return found;
  }
}

/** How far the largest coordinate of a mode is moved: radians, or parts of the extent. */
const FAR = { angle: 0.45, length: 0.25, other: 0.5 };
/** A mode that swings is shown with a period of so many seconds at least and at most. */
const PERIODS: [number, number] = [1.2, 4];
/** One that does not swing is shown once in so many seconds. */
const ONCE = 3;

export class Swing {
  private readonly factor: number;
  /** Seconds of the mode that are shown in one. */
  readonly speed: number;
  readonly moved: string[];

  constructor(
    readonly modes: Modes,
    readonly mode: Mode,
    picture: Picture,
  ) {
    this.moved = Object.keys(mode.shape);
    let factor = Infinity;
    for (const one of picture.coordinates) {
      const [re, im] = mode.shape[one.name] ?? [0, 0];
      const size = Math.hypot(re, im);
      if (size > 0) factor = Math.min(factor, (FAR[one.kind] * (one.kind === "length" ? picture.extent : 1)) / size);
    }
    this.factor = Number.isFinite(factor) ? factor : 0;
    const period = mode.imaginary > 0 ? (2 * Math.PI) / mode.imaginary : 0;
    const shown = Math.min(PERIODS[1], Math.max(PERIODS[0], period));
    this.speed = period > 0 ? period / shown : 1;
  }

  /** The base of the modes, all other coordinates where the picture has them. */
  base(start: State): State {
    return { ...start, ...this.modes.base };
  }

  /** Deviations after so many seconds of showing: those that swing go on, the others begin again and again. */
  state(seconds: number, start: State, amplitude: number): State {
    const { mode } = this;
    const found = this.base(start);
    let [cos, sin] = [1, 0];
    if (mode.imaginary > 0) {
      const phase = mode.imaginary * this.speed * seconds;
      [cos, sin] = [Math.cos(phase), Math.sin(phase)];
    } else {
      const part = (seconds % ONCE) / ONCE;
      cos = mode.real < 0 ? Math.exp(-3 * part) : mode.real > 0 ? Math.exp(3 * (part - 1)) : part;
    }
    for (const [name, [re, im]] of Object.entries(mode.shape)) {
      found[name] = (found[name] ?? 0) + amplitude * this.factor * (re * cos - im * sin);
    }
    return found;
  }

  /** How it moves, in words: what is shown and what is true of it. */
  words(unit: string | undefined): string {
    const { mode } = this;
    const time = unit ? ` ${unit}` : "";
    if (mode.imaginary > 0) {
      const ratio = mode.real === 0 ? "0" : told(mode.damping);
      const swings = say("frequency [[frequency]] per [[unit]] ([[rate]] rad per [[unit]]), damping ratio [[ratio]]", {
        frequency: told(mode.frequency), rate: told(mode.imaginary), ratio, unit: unit ?? say("unit of time"),
      });
      return mode.real > 0 ? say("[[swings]], growing", { swings }) : swings;
    }
    if (mode.real === 0) return say("root 0: in the first approximation nothing drives it back");
    const within = { time: told(1 / Math.abs(mode.real)) + time };
    return mode.real < 0 ? say("does not swing: decays by e in [[time]]", within) : say("does not swing: grows by e in [[time]]", within);
  }
}

/** Five digits. */
export function told(value: number | null | undefined): string {
  return value === null || value === undefined || !Number.isFinite(value) ? "–" : String(Number(value.toPrecision(5)));
}
