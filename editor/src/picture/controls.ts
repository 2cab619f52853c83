// Sliders of coordinates, the list of modes, the list of equilibria, and the picture in words.

import { make } from "../elements.js";
import { told } from "./playing.js";
import type { State } from "./program.js";
import type { Coordinate, Equilibria, Modes, Picture } from "./types.js";
import { say } from "./words.js";

export class Sliders {
  readonly element = make("div", { class: "viewer-sliders" });
  private rows: { one: Coordinate; slider: HTMLInputElement; reading: HTMLOutputElement }[] = [];

  constructor(private readonly moved: (name: string, value: number) => void) {}

  build(coordinates: Coordinate[]): void {
    this.rows = coordinates.map((one) => {
      const unit = one.unit ? ` ${one.unit}` : "";
      const label = `${one.name}${unit ? `, ${one.unit}` : ""}`;
      const slider = make("input", {
        type: "range", min: one.minimum, max: one.maximum, step: "any", value: one.value, "aria-label": label,
        title: one.limited ? say("limits of the description: [[low]] to [[high]]", { low: told(one.minimum), high: told(one.maximum) + unit }) : null,
      });
      const reading = make("output", {}, told(one.value) + unit);
      slider.addEventListener("input", () => this.moved(one.name, Number(slider.value)));
      slider.addEventListener("keydown", (event) => {
        const way = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
        if (way === undefined || event.altKey || event.ctrlKey || event.metaKey) return;
        event.preventDefault(); // "any" has no step of its own that keys could take
        slider.value = String(Number(slider.value) + ((event.shiftKey ? 0.1 : 1) * way * (one.maximum - one.minimum)) / 100);
        this.moved(one.name, Number(slider.value));
      });
      return { one, slider, reading };
    });
    this.element.replaceChildren(
      ...this.rows.map(({ one, slider, reading }) =>
        make("label", { class: "viewer-slider" }, make("span", { title: one.name }, one.label), slider, reading)),
    );
  }

  /** A slider that is being dragged is left alone. */
  set(state: State): void {
    for (const { one, slider, reading } of this.rows) {
      const value = state[one.name] ?? 0;
      if (document.activeElement !== slider || !slider.matches(":active")) slider.value = String(shown(one, value));
      const text = told(value) + (one.unit ? ` ${one.unit}` : "");
      if (reading.textContent !== text) reading.textContent = text;
      slider.setAttribute("aria-valuetext", text);
    }
  }
}

/** An angle is brought among those of its slider. */
function shown(one: Coordinate, value: number): number {
  if (one.kind !== "angle" || one.limited) return value;
  const turns = Math.round((value - one.value) / (2 * Math.PI));
  return value - 2 * Math.PI * turns;
}

export function modesList(found: Modes, words: (k: number) => string, choose: (k: number) => void): HTMLElement {
  const buttons = found.modes.map((_, k) => {
    const button = make("button", { type: "button", "aria-pressed": "false", click: () => choose(k) }, `${say("Mode [[number]]", { number: k + 1 })}: ${words(k)}`);
    return make("li", {}, button);
  });
  return make(
    "div",
    { class: "viewer-list" },
    make("p", { class: "viewer-verdict" }, say("Verdict: [[word]]", { word: say(found.verdict.verdict) })),
    ...found.sentences.map((text) => make("p", { class: "viewer-soft" }, text)),
    make("ol", {}, ...buttons),
  );
}

export function equilibriaList(found: Equilibria, choose: (k: number) => void): HTMLElement {
  const items = found.equilibria.map((one, k) => {
    const values = Object.entries(one.texts).map(([name, text]) => `${name} = ${text}`);
    const free = one.free.map((name) => say("[[name]] any", { name }));
    const angles = one.otherAngles ? say("; in other angles of [[bodies]], which no slider shows", { bodies: one.otherAngles }) : "";
    const text = `${one.family ? say("of a family: ") : ""}${[...values, ...free].join(", ") || say("any position")}${angles}`;
    const theorem = one.verdict.theorems.length > 0 ? ` (${one.verdict.theorems.map((name) => say(name)).join(", ")})` : "";
    const button = make("button", { type: "button", "aria-pressed": "false", disabled: one.otherAngles !== "", click: () => choose(k) }, text);
    return make("li", {}, button, make("span", { class: "viewer-verdict" }, `${say(one.verdict.verdict)}${theorem}`));
  });
  const whole = found.complete ? say("The list is complete.") : say("The list may be incomplete.");
  const turning = Object.entries(found.turning).map(([name, rate]) => say("[[name]] turns at [[rate]].", { name, rate: told(rate) }));
  return make(
    "div",
    { class: "viewer-list" },
    ...[whole, ...turning, ...found.remarks.map((x) => `${x}.`)].map((text) => make("p", { class: "viewer-soft" }, text)),
    make("ol", {}, ...items),
  );
}

export function press(list: HTMLElement | null, chosen: number | null): void {
  list?.querySelectorAll("button").forEach((button, k) => button.setAttribute("aria-pressed", String(k === chosen)));
}

/** What the picture and a motion begin with: parameters, coordinates and their velocities. */
export function valuesTable(picture: Picture): HTMLElement {
  const time = picture.units.time;
  const row = (label: string, value: number | null, unit: string, meaning: string) =>
    make("tr", {}, make("th", { scope: "row" }, label), make("td", {}, `${told(value)}${unit ? ` ${unit}` : ""}`), make("td", {}, meaning));
  const given = picture.parameters.map((one) => row(one.label, one.value, one.unit, one.given ? one.meaning : `${say("stands in: no value is given.")} ${one.meaning}`));
  const start = picture.coordinates.flatMap((one) => [
    row(one.label, one.value, one.unit, picture.atZero.includes(one.name) ? say("no initial value is given") : say("initial value")),
    row(`d${one.label}/dt`, one.velocity, time ? `${one.unit || "1"}/${time}` : "", say("initial velocity")),
  ]);
  return make("div", { class: "viewer-words" }, make("table", {}, make("tbody", {}, ...given, ...start)));
}

/** Every body with its place as a table: what the picture shows, for those who do not see it. */
export function inWords(picture: Picture, values: Float64Array): HTMLElement {
  const unit = picture.units.length ? ` [${picture.units.length}]` : "";
  const place = (point: number[]) => point.map((k) => told(values[k])).join(", ");
  const rows = picture.bodies.map((body) => {
    const joint = body.joint.hinges
      .filter((hinge) => hinge.coordinates.length > 0)
      .map((hinge) => `${hinge.slides ? say("slides by") : say("turns by")} ${hinge.coordinates.join(", ")}`)
      .join("; ");
    const looks = body.shapes.length > 0 ? body.shapes.map((x) => say(x.kind)).join(", ") : body.ellipsoid ? say("ellipsoid of inertia") : say("point and lines");
    const cells = [body.parent ?? say("the frame"), joint || say("fixed"), place(body.origin), body.massive ? place(body.centre) : "–", looks];
    return make("tr", {}, make("th", { scope: "row" }, body.name), ...cells.map((text) => make("td", {}, text)));
  });
  const heads = [say("body"), say("on"), say("joint"), say("origin") + unit, say("mass centre") + unit, say("drawn as")];
  return make(
    "div",
    { class: "viewer-words" },
    ...picture.sentences.map((text) => make("p", {}, text)),
    make("table", {}, make("thead", {}, make("tr", {}, ...heads.map((text) => make("th", { scope: "col" }, text)))), make("tbody", {}, ...rows)),
  );
}
