// The panel of the picture: drawn anew when the server has understood another text; motion, modes, equilibria on demand.

import { beginnings } from "./beginning.js";
import { make } from "./elements.js";
import { Job } from "./job.js";
import type { Model } from "./model.js";
import type { Equilibria, Modes, Motion, Picture } from "./picture/types.js";
import { Viewer } from "./picture/viewer.js";
import type { Told } from "./seam.js";
import { wordsOf } from "./server.js";

/** So long after a change of the text it is drawn: sooner it would only flicker. */
const DRAW_AFTER = 150;

const SECTIONS = { motion: "simulate", modes: "modes", equilibria: "equilibria" } as const;
type Section = keyof typeof SECTIONS;

export function panel(host: HTMLElement, model: Model): void {
  const time = make("input", { type: "text", value: "10", size: 5, inputmode: "decimal", "aria-label": "Until t =" });
  const ask = (section: Section, words: string, hint: string) =>
    make("button", { type: "button", title: hint, click: () => void begin(section) }, words);
  const buttons = make(
    "div",
    { class: "picture-asked" },
    make("label", {}, "until t = ", time),
    ask("motion", "Simulate", "Integrate the motion from the initial state"),
    ask("modes", "Modes", "Linear modes about the given motion"),
    ask("equilibria", "Equilibria", "All relative equilibria at the values"),
  );
  const stale = make("p", { class: "picture-stale", role: "status" });
  const place = make("div", { class: "picture-place undrawn" });
  const cards = make("div", {});
  host.replaceChildren(buttons, stale, cards, place);
  const viewer = new Viewer(place);
  viewer.onSelect = (name) => model.select(name);

  let timer = 0;
  let asking: AbortController | null = null;
  let drawn = "";
  /** What the last picture that was asked for is of. */
  let asked: string | null = null;
  /** Fulfilled when what is to be drawn is drawn, or cannot be. */
  let drawing: Promise<void> | null = null;
  let isDrawn = (): void => undefined;
  let wanted = 0;
  const jobs = (Object.keys(SECTIONS) as Section[]).map((section) => [section, new Job(model, (told) => hear(section, told), () => void begin(section))] as const);
  const jobOf = new Map(jobs);

  async function draw(): Promise<void> {
    asking?.abort();
    const own = new AbortController();
    asking = own;
    try {
      const answer = await model.request<Picture & { complaints?: { message: string }[] }>("picture", {}, own.signal);
      if (asking !== own) return;
      if (answer.complaints) {
        stale.textContent = `Not drawn as it stands: ${answer.complaints[0]?.message ?? "see the complaints"}.`;
        return;
      }
      stale.textContent = "";
      // What is only spelled in another way looks the same: sliders and motion stay.
      const now = JSON.stringify(answer);
      if (now === drawn) return;
      drawn = now;
      place.classList.remove("undrawn");
      jobs.forEach(([, job]) => job.forget());
      viewer.show(answer);
      viewer.select(model.selected);
    } catch (failure) {
      if (own.signal.aborted) return;
      asked = null;
      stale.textContent = wordsOf(failure);
    }
  }

  async function begin(section: Section): Promise<void> {
    viewer.note(section, "Being computed …");
    await drawing; // another picture would take what is shown with it
    viewer.note(section, "Being computed …");
    try {
      const body = section === "motion" ? { time: time.value.trim(), set: viewer.moved() } : { set: {} };
      await jobOf.get(section)!.begin(SECTIONS[section], body);
    } catch (failure) {
      viewer.note(section, wordsOf(failure));
    }
  }

  function hear(section: Section, told: Told): void {
    if (told.kind === "motion") viewer.showMotion(told["value"] as Motion);
    else if (told.kind === "modes") viewer.showModes(told["value"] as Modes);
    else if (told.kind === "equilibria") viewer.showEquilibria(told["value"] as Equilibria);
    else if (told.kind === "failed" || told.kind === "cancelled") viewer.note(section, String(told["words"] ?? told.kind));
    else if (told.kind === "progress") viewer.note(section, String(told["words"] ?? "Being computed …"));
  }

  model.on("view", (view) => {
    if (view.unbegun !== cards.hasChildNodes()) cards.replaceChildren(...(view.unbegun ? [beginnings(model)] : []));
    buttons.hidden = place.hidden = view.unbegun === true;
    if (view.unbegun) {
      stale.textContent = "";
      return;
    }
    if (view.content !== null && view.content === asked) return; // a comment is not drawn
    asked = view.content;
    window.clearTimeout(timer);
    drawing ??= new Promise((resolve) => {
      isDrawn = () => {
        drawing = null;
        resolve();
      };
    });
    const mine = (wanted += 1);
    timer = window.setTimeout(() => void draw().finally(() => mine === wanted && isDrawn()), drawn === "" ? 0 : DRAW_AFTER);
  });
  model.on("selection", (name) => viewer.select(name));
  model.on("theme", () => viewer.stage.ink());
}
