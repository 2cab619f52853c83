// Results: the parts of the report, filling as they are derived; begun again whenever the text is another one.

import "./results.css";
import { make } from "./elements.js";
import { copying } from "./copying.js";
import { exporting } from "./exporting.js";
import { Job } from "./job.js";
import { mapping } from "./mapping.js";
import type { Model } from "./model.js";
import { released } from "./pressing.js";
import { sanitised } from "./sanitised.js";
import type { Told } from "./seam.js";
import { wordsOf } from "./server.js";

/** Milliseconds after the last change; a text that the server has not looked at for so long is another one. */
const DERIVE_AFTER = 350;
const UNSEEN_AFTER = 400;

/** Why the server ends the jobs of a page that was away for long. */
const ALONE = "nobody is there";

const DERIVED = "All is derived from the text as it stands.";
const EARLIER = "What stands here is of an earlier text.";

/** Open from the beginning: what a reader wants first. */
const OPEN = new Set(["summary", "6"]);

interface Section {
  problem: string;
  title: string;
  state: "derived" | "failed" | "refused";
  seconds: number;
  html: string;
}

interface Problem {
  number: number;
  title: string;
  usual: boolean;
}

/** A section of the page: its words are made when it is opened. */
class Shown {
  readonly element: HTMLDetailsElement;
  private readonly state = make("span", { class: "state" });
  private readonly body = make("div", { class: "report-part" });
  private html: string | null = null;
  private shown: string | null = null;
  /** What is told of its derivation. */
  private took: string | null = null;

  constructor(
    readonly problem: string,
    title: string,
    private readonly follow: (section: string) => void,
  ) {
    this.element = make(
      "details",
      { class: "result", id: `result-${problem}`, open: OPEN.has(problem), toggle: () => this.fill() },
      make("summary", {}, make("span", { class: "title" }, title), this.state),
      this.body,
    );
    this.waits();
  }

  /** What stands there is of an earlier text. */
  waits(): void {
    this.element.classList.add("old");
    this.state.textContent = this.html === null ? "…" : "earlier text …";
  }

  /** It is being derived. */
  begins(): void {
    this.took = null;
    this.waits();
  }

  /** It is of the text as it stands after all. */
  stays(): void {
    if (this.took === null) return;
    this.element.classList.remove("old");
    this.state.textContent = this.took;
  }

  takes(section: Section): void {
    this.html = section.html;
    this.element.classList.remove("old");
    this.element.dataset["state"] = section.state;
    const words = { derived: `${section.seconds.toFixed(2)} s`, refused: "no result", failed: "failed" }[section.state];
    this.state.textContent = this.took = words;
    released(() => this.fill());
  }

  private fill(): void {
    if (!this.element.open || this.html === null || this.html === this.shown) return;
    const unfolded = [...this.body.querySelectorAll("details")].map((one) => one.open);
    this.body.replaceChildren(sanitised(this.html, this.follow));
    this.body.querySelectorAll("details").forEach((one, k) => (one.open = unfolded[k] ?? false));
    for (const formula of this.body.querySelectorAll(".formula[data-latex]")) {
      formula.setAttribute("tabindex", "0");
      formula.setAttribute("role", "group");
      formula.setAttribute("aria-label", "formula, Enter to copy");
    }
    this.shown = this.html;
  }
}

export function panel(host: HTMLElement, model: Model): void {
  const known = ((model.file as unknown as { problems?: Problem[] }).problems ?? []) as Problem[];
  const status = make("p", { class: "deriving", role: "status" });
  const live = make("input", { type: "checkbox", id: "derive-live", checked: true });
  const cancel = make("button", { type: "button", id: "derive-cancel", click: () => void stop() }, "Stop");
  const now = make("button", { type: "button", id: "derive-now", click: () => void begin() }, "Derive");
  const boxes = known.map((problem) => {
    const box = make("input", { type: "checkbox", value: String(problem.number), checked: problem.usual, change: () => void begin() });
    return { problem, box, label: make("label", {}, box, ` ${problem.number} ${problem.title}`) };
  });
  const sections = make("div", { class: "sections" });
  host.replaceChildren(
    make("div", { class: "tools" }, now, cancel, make("label", { for: "derive-live" }, live, " as the text changes")),
    make("details", { class: "chosen" }, make("summary", {}, "Problems"), make("div", { class: "boxes" }, ...boxes.map((x) => x.label))),
    status,
    sections,
    mapping(model),
    exporting(model),
  );
  copying(sections, model);

  const shown = new Map<string, Shown>();
  const job = new Job(model, hear, () => void begin());
  let asked = 0;
  /** What the sections are of, or will be as soon as they come: a text, and what it says. */
  let derived: string | null = null;
  let content: string | null = null;
  let old = false;
  /** How the last derivation ended. */
  let outcome = "";
  let timer = 0;
  let unseen = 0;
  cancel.disabled = true;

  function follow(section: string): void {
    const found = shown.get(section.replace(/^problem-/, ""))?.element;
    if (!found) return;
    found.open = true;
    found.scrollIntoView({ block: "start" });
    found.querySelector("summary")?.focus();
  }

  function over(words: string): void {
    cancel.disabled = true;
    outcome = words;
    if (derived !== null) status.textContent = current() ? words : EARLIER;
  }

  async function stop(): Promise<void> {
    window.clearTimeout(timer);
    await job.stop();
  }

  const sayOf = (text: string): string | null => (model.viewed === text ? (model.view?.content ?? null) : null);

  /** Whether the sections are of the text as it stands, but for its comments. */
  function current(): boolean {
    if (derived !== null && content === null) content = sayOf(derived);
    return derived !== null && (derived === model.text || (content !== null && content === sayOf(model.text)));
  }

  function compare(): void {
    window.clearTimeout(unseen);
    if (derived === null) return;
    if (old === current()) {
      old = !old;
      for (const one of shown.values()) old ? one.waits() : one.stays();
    }
    if (!job.runs) status.textContent = old ? EARLIER : outcome;
  }

  async function begin(): Promise<void> {
    window.clearTimeout(timer);
    asked += 1;
    const text = model.text;
    const problems = boxes.filter((x) => x.box.checked).map((x) => x.problem.number);
    try {
      status.textContent = "Begun …";
      const usual = boxes.every((x) => x.box.checked === x.problem.usual);
      await job.begin("derive", usual || problems.length === 0 ? {} : { problems }, () => {
        [derived, content, old] = [text, sayOf(text), false];
        cancel.disabled = false;
      });
      compare();
    } catch (failure) {
      over("");
      derived = null; // whatever stands there: it is begun again with the next look
      status.textContent = wordsOf(failure);
    }
  }

  function planned(plan: [string, string][]): void {
    const kept: HTMLElement[] = [];
    for (const [problem, title] of plan) {
      let one = shown.get(problem);
      if (one === undefined) shown.set(problem, (one = new Shown(problem, title, follow)));
      else one.begins();
      kept.push(one.element);
    }
    for (const problem of [...shown.keys()]) if (!plan.some(([x]) => x === problem)) shown.delete(problem);
    // Moved only where the order is another one: what is being read stays where it is.
    if (kept.some((element, k) => sections.children[k] !== element) || sections.children.length !== kept.length) {
      sections.replaceChildren(...kept);
    }
  }

  function hear(told: Told): void {
    if (told.kind === "plan") planned(told["sections"] as [string, string][]);
    else if (told.kind === "section") {
      const section = told as unknown as Section;
      shown.get(section.problem)?.takes(section);
    } else if (told.kind === "progress") {
      const [done, of] = [told["done"], told["of"]];
      status.textContent = `${String(told["words"])} …${typeof of === "number" ? ` (${String(done)} of ${of})` : ""}`;
    } else if (told.kind === "done") over(DERIVED);
    else if (told.kind === "failed") over(`Nothing more was derived: ${String(told["words"])}.`);
    else if (told.kind === "cancelled" && told["words"] === ALONE) void begin();
    else if (told.kind === "cancelled") over(`Stopped: ${String(told["words"])}.`);
  }

  model.on("text", () => {
    window.clearTimeout(unseen);
    unseen = window.setTimeout(compare, UNSEEN_AFTER);
  });
  model.on("view", (view) => {
    window.clearTimeout(timer);
    if (!model.fresh) return; // typed on meanwhile: another look follows
    compare();
    if (!live.checked || current()) return;
    if (view.complaints.some((one) => one.severity === "error")) {
      if (job.runs) {
        void stop();
        derived = null;
      }
      status.textContent = shown.size > 0 ? `Waiting: the text has mistakes. ${EARLIER}` : "Waiting: the text has mistakes.";
      return;
    }
    if (view.unbegun || (view.bodies.length === 0 && view.complaints.length > 0)) return;
    if (asked === 0) return void begin(); // nobody types yet
    timer = window.setTimeout(() => void begin(), DERIVE_AFTER);
  });
  live.addEventListener("change", () => {
    if (live.checked) void begin();
  });
}
