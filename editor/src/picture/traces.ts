// Energies and drift of a motion over time, on a small canvas of its own; pressing it goes there.

import { make } from "../elements.js";
import { inks } from "./inks.js";
import { told, type Track } from "./playing.js";
import { say } from "./words.js";

export class Traces {
  readonly element: HTMLElement;
  private readonly canvas = make("canvas", { class: "viewer-trace-canvas", "aria-hidden": "true" });
  private readonly reading = make("p", { class: "viewer-reading" });
  private track: Track | null = null;
  private rows: { values: number[]; colour: "accent" | "warn"; dashed: boolean }[] = [];

  constructor(go: (t: number) => void) {
    this.element = make("div", { class: "viewer-trace" }, this.canvas, this.reading);
    const pressed = (event: PointerEvent) => {
      if (this.track && event.buttons === 1) go((this.track.end * event.offsetX) / Math.max(1, this.canvas.clientWidth));
    };
    this.canvas.addEventListener("pointerdown", pressed);
    this.canvas.addEventListener("pointermove", pressed);
  }

  show(track: Track): void {
    this.track = track;
    const { motion } = track;
    const first = motion.energy[0] ?? 0;
    const numbers = (values: (number | null)[]) => values.map((x) => x ?? NaN);
    this.rows = [
      { values: numbers(motion.kinetic), colour: "accent", dashed: false },
      { values: numbers(motion.energy).map((x) => x - first), colour: "warn", dashed: true },
    ];
  }

  draw(t: number): void {
    const { track, canvas } = this;
    if (!track) return;
    const { motion } = track;
    const k = Math.round(track.place(t));
    const unit = motion.units.energy ? ` ${motion.units.energy}` : "";
    const drift = motion.drift[k];
    this.reading.textContent =
      `${say("kinetic energy (line)")} ${told(motion.kinetic[k])}${unit}, ${say("energy (its change dashed)")} ${told(motion.energy[k])}${unit}, ` +
      `${motion.driftOf} ${drift === null || drift === undefined ? "–" : drift === 0 ? "0" : drift.toExponential(1)}`;
    const ratio = window.devicePixelRatio || 1;
    const [wide, tall] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== Math.round(wide * ratio)) canvas.width = Math.round(wide * ratio);
    if (canvas.height !== Math.round(tall * ratio)) canvas.height = Math.round(tall * ratio);
    const pen = canvas.getContext("2d");
    if (!pen || wide === 0) return;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, wide, tall);
    const ink = inks(this.element, { accent: "#0063a6", warn: "#a84a00", front: "#1d2430" });
    const every = this.rows.flatMap((row) => row.values).filter(Number.isFinite);
    const low = every.reduce((a, b) => Math.min(a, b), Infinity);
    const size = every.reduce((a, b) => Math.max(a, b), -Infinity) - low || 1;
    const x = (time: number) => (wide * time) / (track.end || 1);
    const y = (value: number) => tall - 4 - ((tall - 8) * (value - low)) / size;
    for (const row of this.rows) {
      pen.strokeStyle = ink[row.colour];
      pen.lineWidth = 1.4;
      pen.setLineDash(row.dashed ? [5, 3] : []);
      pen.beginPath();
      row.values.forEach((value, i) => pen.lineTo(x(track.times[i]!), y(value)));
      pen.stroke();
    }
    pen.setLineDash([]);
    pen.strokeStyle = ink.front;
    pen.beginPath();
    pen.moveTo(x(t), 0);
    pen.lineTo(x(t), tall);
    pen.stroke();
  }
}
