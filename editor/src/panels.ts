// Where the panels stand: three columns on a wide window, two groups of tabs on a tablet, one on a telephone.

import { make } from "./elements.js";
import type { Model } from "./model.js";
import type { Part } from "./shell.js";

type Mode = "wide" | "medium" | "narrow";

/** Which panels share a column; in a group of tabs one of them is seen. */
const GROUPS: Record<Mode, string[][]> = {
  wide: [],
  medium: [["graph", "form"], ["text", "picture", "results"]],
  narrow: [["graph", "form", "text", "picture", "results"]],
};

const queries = { wide: window.matchMedia("(min-width: 1100px)"), medium: window.matchMedia("(min-width: 640px)") };

function mode(): Mode {
  return queries.wide.matches ? "wide" : queries.medium.matches ? "medium" : "narrow";
}

interface Arranged {
  main: HTMLElement;
  skips: HTMLElement;
  /** Makes a panel seen and gives it the focus. */
  show: (name: string) => void;
}

export function arranged(parts: Part[], model: Model): Arranged {
  const sections = new Map<string, HTMLElement>();
  const failures: unknown[] = [];
  for (const { name, title, panel } of parts) {
    const inside = make("div", { class: `panel-body ${name}-host` });
    const heading = make("h2", { id: `${name}-title` }, title);
    sections.set(name, make("section", { id: name, class: "panel", "aria-labelledby": heading.id, tabindex: -1 }, heading, inside));
    try {
      panel(inside, model);
    } catch (failure) {
      // The others work without it.
      failures.push(failure);
      inside.replaceChildren(make("p", { role: "alert" }, `${title} cannot be shown here: ${String(failure)}`));
    }
  }
  for (const failure of failures) console.error(failure);
  const at = (name: string): HTMLElement => sections.get(name)!;
  const main = make("main", { class: "panels" });
  const left = make("div", { class: "column" }, at("graph"), splitter("rows", "--left-row", "Height of the structure", 48), at("form"));
  const middle = make("div", { class: "column" }, at("text"));
  const right = make("div", { class: "column" }, at("picture"), splitter("rows", "--right-row", "Height of the picture", 58), at("results"));
  main.append(
    left,
    splitter("columns", "--left", "Width of the structure", 26),
    middle,
    splitter("columns", "--middle", "Right edge of the text", 52),
    right,
  );
  const bars = [make("div", { class: "tabs", role: "tablist", "aria-label": "Panels" }), make("div", { class: "tabs", role: "tablist", "aria-label": "More panels" })];
  main.prepend(...bars);
  const seen = new Map<number, string>();

  function arrange(): void {
    const groups = GROUPS[mode()];
    main.dataset["mode"] = mode();
    for (const section of sections.values()) {
      section.hidden = false;
      section.removeAttribute("role");
      delete section.dataset["group"];
    }
    bars.forEach((bar, index) => {
      const group = groups[index];
      bar.hidden = group === undefined;
      bar.replaceChildren();
      if (!group) return;
      const chosen = group.includes(seen.get(index) ?? "") ? seen.get(index)! : group[0]!;
      for (const name of group) {
        const section = at(name);
        section.hidden = name !== chosen;
        section.setAttribute("role", "tabpanel");
        section.dataset["group"] = String(index);
        const title = parts.find((part) => part.name === name)!.title;
        bar.append(
          make(
            "button",
            { type: "button", role: "tab", id: `${name}-tab`, "aria-controls": name, "aria-selected": String(name === chosen), tabindex: name === chosen ? 0 : -1, click: () => choose(name) },
            title,
          ),
        );
      }
    });
    window.dispatchEvent(new Event("resize"));
  }

  function choose(name: string): void {
    const index = GROUPS[mode()].findIndex((group) => group.includes(name));
    if (index >= 0 && seen.get(index) !== name) {
      seen.set(index, name);
      arrange();
    }
  }

  for (const bar of bars) {
    bar.addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      const tabs = [...bar.querySelectorAll<HTMLElement>("[role=tab]")];
      const now = tabs.findIndex((tab) => tab === document.activeElement);
      if (!step || now < 0) return;
      event.preventDefault();
      const next = tabs[(now + step + tabs.length) % tabs.length]!.id;
      choose(next.replace(/-tab$/, ""));
      document.getElementById(next)?.focus();
    });
  }

  function show(name: string): void {
    choose(name);
    const section = at(name);
    if (name === "text") model.editor.focus();
    else (section.querySelector<HTMLElement>('[role="treeitem"][tabindex="0"]') ?? section).focus();
  }

  model.on("goto", () => choose("text"));
  for (const query of Object.values(queries)) query.addEventListener("change", arrange);
  arrange();
  const skips = make(
    "nav",
    { class: "skips", "aria-label": "Go to" },
    ...parts.map(({ name, title }) =>
      make("a", { href: `#${name}`, click: (event: Event) => { event.preventDefault(); show(name); } }, title),
    ),
  );
  return { main, skips, show };
}

const KEPT = "mbsym.sizes";

function kept(): Record<string, number> {
  try {
    return JSON.parse(localStorage.getItem(KEPT) ?? "{}") as Record<string, number>;
  } catch {
    return {};
  }
}

/** A line between two panels that is dragged, or moved with the arrow keys; it writes a length in percent. */
function splitter(kind: "columns" | "rows", variable: string, label: string, preset: number): HTMLElement {
  const known = kept()[variable];
  let value = typeof known === "number" ? Math.min(88, Math.max(12, known)) : preset;
  const upright = kind === "columns";
  const element = make("div", {
    class: `splitter ${kind}`,
    role: "separator",
    tabindex: 0,
    "aria-label": label,
    "aria-orientation": upright ? "vertical" : "horizontal",
    "aria-valuemin": 12,
    "aria-valuemax": 88,
  });
  function set(next: number): void {
    value = Math.min(88, Math.max(12, next));
    document.documentElement.style.setProperty(variable, `${value}%`);
    element.setAttribute("aria-valuenow", String(Math.round(value)));
    try {
      localStorage.setItem(KEPT, JSON.stringify({ ...kept(), [variable]: value }));
    } catch {
      // Not remembered, then.
    }
  }
  element.addEventListener("pointerdown", (event) => {
    element.setPointerCapture(event.pointerId);
    event.preventDefault();
  });
  element.addEventListener("pointermove", (event) => {
    if (!element.hasPointerCapture(event.pointerId)) return;
    const box = element.parentElement!.getBoundingClientRect();
    set(upright ? (100 * (event.clientX - box.left)) / box.width : (100 * (event.clientY - box.top)) / box.height);
  });
  element.addEventListener("pointerup", () => window.dispatchEvent(new Event("resize")));
  element.addEventListener("keydown", (event) => {
    const steps: Record<string, number> = upright ? { ArrowLeft: -2, ArrowRight: 2 } : { ArrowUp: -2, ArrowDown: 2 };
    const step = steps[event.key];
    if (step === undefined) return;
    event.preventDefault();
    set(value + step);
    window.dispatchEvent(new Event("resize"));
  });
  set(value);
  return element;
}
