// Results: the parts of the report, filling as they are derived; begun again whenever the text is another one.

import "./results.css";
import { make } from "./elements.js";
import { copying } from "./copying.js";
import { exporting } from "./exporting.js";
import { mapping } from "./mapping.js";
import type { Model } from "./model.js";
import { sanitised } from "./sanitised.js";
import type { Told } from "./seam.js";

/** Milliseconds after the last change; and after which a job of which nothing was heard is begun again. */
const DERIVE_AFTER = 350;
const UNHEARD_AFTER = 4000;

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

  takes(section: Section): void {
    this.html = section.html;
    this.element.classList.remove("old");
    this.element.dataset["state"] = section.state;
    const words = { derived: `${section.seconds.toFixed(2)} s`, refused: "no result", failed: "failed" }[section.state];
    this.state.textContent = words;
    this.fill();
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
  const page = crypto.randomUUID();
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
    mapping(model, page),
    exporting(model),
  );
  copying(sections, model);

  const shown = new Map<string, Shown>();
  let job: string | null = null;
  let heard = false;
  let asked = 0;
  let early: Told[] = [];
  let derived: string | null = null;
  let timer = 0;
  cancel.disabled = true;

  function follow(section: string): void {
    const found = shown.get(section.replace(/^problem-/, ""))?.element;
    if (!found) return;
    found.open = true;
    found.scrollIntoView({ block: "start" });
    found.querySelector("summary")?.focus();
  }

  function over(words: string): void {
    job = null;
    cancel.disabled = true;
    status.textContent = words;
  }

  async function stop(): Promise<void> {
    window.clearTimeout(timer);
    if (job !== null) await model.post("cancel", { job }).catch(() => undefined);
  }

  async function begin(): Promise<void> {
    window.clearTimeout(timer);
    const mine = (asked += 1);
    const text = model.text;
    const problems = boxes.filter((x) => x.box.checked).map((x) => x.problem.number);
    try {
      status.textContent = "Begun …";
      early = [];
      const usual = boxes.every((x) => x.box.checked === x.problem.usual);
      const answer = await model.request<{ job: string }>("derive", { page, ...(usual || problems.length === 0 ? {} : { problems }) });
      if (mine !== asked) return;
      job = answer.job;
      derived = text;
      heard = false;
      cancel.disabled = false;
      early.filter((told) => told.job === job).forEach(hear);
      early = [];
      window.setTimeout(() => {
        if (mine === asked && job === answer.job && !heard) void begin();
      }, UNHEARD_AFTER);
    } catch (failure) {
      if (mine === asked) over(failure instanceof Error ? failure.message : String(failure));
    }
  }

  function planned(plan: [string, string][]): void {
    const kept: HTMLElement[] = [];
    for (const [problem, title] of plan) {
      let one = shown.get(problem);
      if (one === undefined) shown.set(problem, (one = new Shown(problem, title, follow)));
      else one.waits();
      kept.push(one.element);
    }
    for (const problem of [...shown.keys()]) if (!plan.some(([x]) => x === problem)) shown.delete(problem);
    // Moved only where the order is another one: what is being read stays where it is.
    if (kept.some((element, k) => sections.children[k] !== element) || sections.children.length !== kept.length) {
      sections.replaceChildren(...kept);
    }
  }

  function hear(told: Told): void {
    if (told.job === undefined) return;
    if (told.job !== job) {
      early = [...early.slice(-40), told];
      return;
    }
    heard = true;
    if (told.kind === "plan") planned(told["sections"] as [string, string][]);
    else if (told.kind === "section") {
      const section = told as unknown as Section;
      shown.get(section.problem)?.takes(section);
    } else if (told.kind === "progress") {
      const [done, of] = [told["done"], told["of"]];
      status.textContent = `${String(told["words"])} …${typeof of === "number" ? ` (${String(done)} of ${of})` : ""}`;
    } else if (told.kind === "done") over(derived === model.text ? "All is derived from the text as it stands." : EARLIER);
    else if (told.kind === "failed") over(`Nothing more was derived: ${String(told["words"])}.`);
    else if (told.kind === "cancelled") over(`Stopped: ${String(told["words"])}.`);
  }

  model.on("told", hear);
  model.on("text", () => {
    if (derived === null || derived === model.text) return;
    derived = null;
    for (const one of shown.values()) one.waits();
    if (job === null) status.textContent = EARLIER;
  });
  model.on("view", (view) => {
    if (!live.checked || model.text === derived) return;
    window.clearTimeout(timer);
    if (view.complaints.some((one) => one.severity === "error")) {
      void stop();
      status.textContent = shown.size > 0 ? `Waiting: the text has mistakes. ${EARLIER}` : "Waiting: the text has mistakes.";
      return;
    }
    if (view.bodies.length === 0 && view.complaints.length > 0) return;
    timer = window.setTimeout(() => void begin(), DERIVE_AFTER);
  });
  live.addEventListener("change", () => {
    if (live.checked) void begin();
  });
  model.on("connection", (state) => {
    if (state === "there" && job !== null) void begin();
  });
}
