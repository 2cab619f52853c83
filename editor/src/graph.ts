// The interconnection of the bodies as a graph (Figure 1 of the paper): a tree with the fixed axes on top, constraints
// as dashed edges, loads as badges.  A tree to those who listen, with spatial arrow keys.

import "./graph.css";
import { make, makeSvg } from "./elements.js";
import { coordinatesOf } from "./formentry.js";
import { FIXED, laidOut, NODE, type Layout, type Placed } from "./layout.js";
import type { Model } from "./model.js";
import { released } from "./pressing.js";
import type { Body, Tie } from "./seam.js";
import { FIXED_WORDS, Structure } from "./structure.js";

const DRAG_FROM = 5;

class Graph {
  private readonly structure: Structure;
  private readonly edges = makeSvg("svg", { class: "edges", "aria-hidden": "true" });
  private readonly tree = make("div", { role: "tree", "aria-label": "Bodies, by what they hang on", class: "tree" });
  private readonly sheet: HTMLElement;
  private readonly scroller: HTMLElement;
  private readonly hint = make("p", { class: "hint" });
  private readonly elements = new Map<string, HTMLElement>();
  private readonly folded = new Set<string>();
  private layout: Layout = laidOut([], new Set());
  private current = FIXED;
  private carried: string | null = null;
  private zoom = 1;
  /** A body that is to have the focus as soon as it is drawn. */
  private awaited: string | null = null;

  constructor(
    host: HTMLElement,
    private readonly model: Model,
  ) {
    this.structure = new Structure(model, (name) => this.await(name));
    this.sheet = make("div", { class: "sheet" }, this.edges, this.tree);
    this.scroller = make("div", { class: "graph-scroller" }, this.sheet);
    // In the row of the tools: above the graph they would cover a body.
    const top = make("div", { class: "graph-tools" }, this.tools(), this.sizes());
    host.append(top, this.scroller, this.hint);
    this.tree.addEventListener("keydown", (event) => this.key(event));
    this.scroller.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    model.on("view", () => released(() => this.draw()));
    model.on("selection", (name) => this.selected(name));
    this.draw();
  }

  private tools(): HTMLElement {
    return make(
      "div",
      { class: "tools", role: "toolbar", "aria-label": "Structure" },
      tool("Add body", "A", "Add a body on the selected one", () => this.structure.add(this.current)),
      tool("Add load", "L", "Add a load, on the selected body", () => this.structure.addLoad(this.current)),
      tool("Add constraint", "C", "Add a constraint, of the selected body", () => this.structure.addConstraint(this.current)),
      tool("Rename", "F2", "Rename the selected body", () => this.structure.rename(this.current)),
      tool("Duplicate", "D", "Duplicate the selected body and what hangs on it", () => this.structure.duplicate(this.current)),
      tool("Attach to", "X, V", "Hang the selected body on another one", () => this.structure.askReattach(this.current)),
      tool("Delete", "Delete", "Delete the selected body and what hangs on it", () => this.structure.remove(this.current)),
    );
  }

  private sizes(): HTMLElement {
    return make(
      "div",
      { class: "tools sizes", role: "toolbar", "aria-label": "Size of the structure" },
      tool("−", "", "Smaller", () => this.zoomTo(this.zoom / 1.25)),
      tool("+", "", "Larger", () => this.zoomTo(this.zoom * 1.25)),
      tool("Fit", "", "All bodies at once", () => this.fit()),
    );
  }

  // ---- drawing -----------------------------------------------------------------------------------------------------

  private get bodies(): Body[] {
    return this.model.understood?.bodies ?? [];
  }

  private draw(): void {
    for (const name of [...this.folded]) if (!this.bodies.some((body) => body.name === name)) this.folded.delete(name);
    this.layout = laidOut(this.bodies, this.folded);
    if (!this.layout.nodes.has(this.current)) this.current = FIXED;
    const focused = this.tree.contains(document.activeElement);
    for (const [name, element] of this.elements) {
      if (this.layout.nodes.has(name)) continue;
      element.remove();
      this.elements.delete(name);
    }
    for (const placed of this.layout.nodes.values()) this.drawNode(placed);
    // The order of the elements is the order in which the tree is read.
    let last: Element | null = null;
    for (const name of this.layout.order) {
      const element = this.elements.get(name)!;
      if (element.previousElementSibling !== last) this.tree.insertBefore(element, last ? last.nextSibling : this.tree.firstChild);
      last = element;
    }
    this.drawEdges();
    this.zoomTo(this.zoom);
    const matrices = this.model.understood?.tree?.children?.some((one) => one.path[0] === "linear system");
    const none = matrices ? "No bodies: this system is given by its matrices." : "No bodies yet: “Add body” hangs the first one on the fixed axes.";
    this.hint.textContent = this.bodies.length === 0 ? none : "";
    this.hint.hidden = this.bodies.length > 0;
    if (this.awaited !== null && this.layout.nodes.has(this.awaited)) {
      const name = this.awaited;
      this.awaited = null;
      this.go(name);
    } else if (focused && !this.tree.contains(document.activeElement)) this.elements.get(this.current)?.focus();
    this.mark();
  }

  private ties(list: Tie[] | undefined, name: string): Tie[] {
    const known = this.layout.nodes;
    return (list ?? []).filter((tie) => {
      const on = tie.bodies.filter((body) => known.has(body) && body !== FIXED);
      return name === FIXED ? on.length === 0 : on.includes(name);
    });
  }

  private drawNode(placed: Placed): void {
    const { name } = placed;
    let element = this.elements.get(name);
    if (!element) {
      element = make("div", { role: "treeitem", class: name === FIXED ? "body fixed" : "body", tabindex: -1 });
      element.addEventListener("pointerdown", (event) => this.pressed(event, name));
      element.addEventListener("dblclick", () => void this.structure.rename(name));
      element.addEventListener("focus", () => this.reached(name));
      this.elements.set(name, element);
    }
    const body = this.bodies.find((one) => one.name === name);
    const coordinates = coordinatesOf(body).join(", ");
    const loads = this.ties(this.model.understood?.loads, name);
    const constraints = this.ties(this.model.understood?.constraints, name);
    const number = name === FIXED ? 0 : this.bodies.findIndex((one) => one.name === name) + 1;
    element.replaceChildren(
      make("span", { class: "number" }, String(number)),
      make("span", { class: "name", title: name || FIXED_WORDS }, name || "fixed axes"),
      make("span", { class: "coordinates" }, coordinates),
      make(
        "span",
        { class: "badges" },
        ...loads.map((tie) => this.badge(tie, "load")),
        ...(name === FIXED ? constraints.map((tie) => this.badge(tie, "constraint")) : []),
        placed.hidden > 0 ? make("span", { class: "badge folded" }, `+${placed.hidden}`) : null,
      ),
    );
    const told = [
      name === FIXED ? FIXED_WORDS : `${name}, body ${number} on ${placed.parent || FIXED_WORDS}`,
      coordinates ? `coordinates ${coordinates}` : null,
      loads.length > 0 ? `loads: ${loads.map((tie) => tie.name || tie.kind).join(", ")}` : null,
      constraints.length > 0 ? `constraints: ${constraints.map((tie) => tie.name || tie.kind).join(", ")}` : null,
      placed.hidden > 0 ? `${placed.hidden} bodies folded` : null,
    ];
    element.setAttribute("aria-label", told.filter(Boolean).join("; "));
    element.setAttribute("aria-level", String(placed.level));
    const siblings = placed.parent === null ? [name] : this.layout.nodes.get(placed.parent)!.children;
    element.setAttribute("aria-posinset", String(siblings.indexOf(name) + 1));
    element.setAttribute("aria-setsize", String(siblings.length));
    if (placed.children.length > 0 || placed.hidden > 0) element.setAttribute("aria-expanded", String(placed.hidden === 0));
    else element.removeAttribute("aria-expanded");
    element.style.transform = `translate(${placed.x - NODE.width / 2}px, ${placed.y - NODE.height / 2}px)`;
    if (element.parentNode !== this.tree) this.tree.append(element);
  }

  /** Leads to the place of a load or constraint in the text. */
  private badge(tie: Tie, kind: string): HTMLElement {
    const badge = make("span", { class: `badge ${kind}`, title: `${tie.kind}${tie.name ? ` ${tie.name}` : ""}: show it in the text` }, tie.name || tie.kind);
    badge.addEventListener("pointerdown", (event) => event.stopPropagation());
    badge.addEventListener("click", (event) => {
      event.stopPropagation();
      // Pressed before a look and let go after it: its place may be another one by now.
      const ties = [...(this.model.understood?.loads ?? []), ...(this.model.understood?.constraints ?? [])];
      const now = ties.find((one) => one.path.join() === tie.path.join());
      if (this.model.fresh && now) this.model.goTo(now.from, now.to);
    });
    return badge;
  }

  private drawEdges(): void {
    const { nodes, width, height } = this.layout;
    for (const element of [this.sheet, this.edges]) {
      element.style.width = `${width}px`;
      element.style.height = `${height}px`;
    }
    this.edges.replaceChildren();
    for (const { parent, x, y } of nodes.values()) {
      if (parent === null) continue;
      const above = nodes.get(parent)!;
      const [from, to] = [above.y + NODE.height / 2, y - NODE.height / 2];
      const middle = (from + to) / 2 + 8;
      this.edges.append(makeSvg("path", { class: "joint", d: `M${above.x},${from} C${above.x},${middle} ${x},${middle} ${x},${to}` }));
    }
    for (const tie of this.model.understood?.constraints ?? []) this.drawConstraint(tie);
  }

  /** Between the bodies that it ties; one that ties a single body ties it to the fixed axes. */
  private drawConstraint(tie: Tie): void {
    const known = tie.bodies.map((name) => this.layout.nodes.get(name) ?? this.layout.nodes.get(FIXED)!);
    const ends = known.length === 1 ? [this.layout.nodes.get(FIXED)!, known[0]!] : known;
    for (let index = 1; index < ends.length; index += 1) {
      const [a, b] = [ends[index - 1]!, ends[index]!];
      if (a === b) continue;
      // On the right of both, so that it does not lie on the tree's own edges.
      const side = Math.max(a.x, b.x) + NODE.width / 2;
      const bow = side + 26;
      const [ax, bx] = [a.x + NODE.width / 2, b.x + NODE.width / 2];
      this.edges.append(makeSvg("path", { class: "constraint", d: `M${ax},${a.y} C${bow},${a.y} ${bow},${b.y} ${bx},${b.y}` }));
      const label = makeSvg("text", { class: "constraint-name", x: side - 2, y: (a.y + b.y) / 2 - 3, "text-anchor": "end" }, tie.name || tie.kind);
      this.edges.append(label);
    }
  }

  // ---- where one is ------------------------------------------------------------------------------------------------

  private mark(): void {
    for (const [name, element] of this.elements) {
      element.tabIndex = name === this.current ? 0 : -1;
      element.setAttribute("aria-selected", String(name === (this.model.selected ?? FIXED)));
      element.classList.toggle("carried", name === this.carried);
    }
  }

  private reached(name: string): void {
    this.current = name;
    this.model.select(name === FIXED ? null : name);
    this.mark();
  }

  private selected(name: string | null): void {
    const wanted = name ?? FIXED;
    if (!this.layout.nodes.has(wanted)) return;
    this.current = wanted;
    this.mark();
    this.elements.get(wanted)?.scrollIntoView({ block: "nearest", inline: "nearest" });
  }

  private go(name: string | undefined): void {
    if (name === undefined || !this.elements.has(name)) return;
    this.elements.get(name)!.focus({ preventScroll: true });
    this.elements.get(name)!.scrollIntoView({ block: "nearest", inline: "nearest" });
  }

  private await(name: string): void {
    this.awaited = name;
    this.draw();
  }

  private fold(name: string, away: boolean): void {
    if (name === FIXED) return;
    if (away) this.folded.add(name);
    else this.folded.delete(name);
    this.draw();
  }

  // ---- keys --------------------------------------------------------------------------------------------------------

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const here = this.layout.nodes.get(this.current)!;
    const level = this.layout.order.filter((name) => this.layout.nodes.get(name)!.level === here.level);
    const beside = (step: number): string | undefined => level[level.indexOf(here.name) + step];
    const acts: Record<string, () => unknown> = {
      ArrowUp: () => this.go(here.parent ?? undefined),
      ArrowDown: () => this.go(here.children[0]),
      ArrowLeft: () => this.go(beside(-1)),
      ArrowRight: () => this.go(beside(1)),
      Home: () => this.go(FIXED),
      End: () => this.go(this.layout.order.at(-1)),
      "-": () => this.fold(here.name, true),
      "+": () => this.fold(here.name, false),
      Enter: () => document.querySelector<HTMLElement>("#form-body input")?.focus(),
      Insert: () => this.structure.add(here.name),
      a: () => this.structure.add(here.name),
      l: () => this.structure.addLoad(here.name),
      c: () => this.structure.addConstraint(here.name),
      F2: () => this.structure.rename(here.name),
      Delete: () => this.structure.remove(here.name),
      d: () => this.structure.duplicate(here.name),
      x: () => this.carry(here.name),
      v: () => this.drop(here.name),
      Escape: () => this.carry(null),
    };
    const act = acts[event.key] ?? acts[event.key.toLowerCase()];
    if (!act) return;
    event.preventDefault();
    event.stopPropagation();
    void act();
  }

  private carry(name: string | null): void {
    if (name === FIXED) return this.model.say("the fixed axes hang on nothing");
    if (name === null && this.carried === null) return;
    this.carried = name;
    this.model.say(name === null ? "nothing is carried" : `${name} is carried: V on another body hangs it there, Escape gives up`);
    this.mark();
  }

  private drop(on: string): void {
    if (this.carried === null) return this.model.say("nothing is carried: X on a body takes it up");
    const body = this.carried;
    this.carried = null;
    void this.structure.reattach(body, on);
  }

  // ---- the pointer -------------------------------------------------------------------------------------------------

  private pressed(event: PointerEvent, name: string): void {
    if (event.button !== 0 || name === FIXED) return;
    const [x0, y0] = [event.clientX, event.clientY];
    const listening = new AbortController();
    const always = { signal: listening.signal, capture: true };
    let ghost: HTMLElement | null = null;
    let over: HTMLElement | null = null;
    let scrolling: number | undefined;
    const target = (at: PointerEvent): [string, HTMLElement] | null => {
      const found = document.elementFromPoint(at.clientX, at.clientY)?.closest<HTMLElement>("[role=treeitem]");
      const entry = [...this.elements].find(([, one]) => one === found);
      return entry && this.structure.canCarry(name, entry[0]) ? entry : null;
    };
    const moved = (at: PointerEvent): void => {
      if (ghost === null) {
        if (Math.hypot(at.clientX - x0, at.clientY - y0) < DRAG_FROM) return;
        ghost = make("div", { class: "body ghost", "aria-hidden": "true" }, make("span", { class: "name" }, name));
        document.body.append(ghost);
      }
      ghost.style.transform = `translate(${at.clientX + 8}px, ${at.clientY + 8}px)`;
      over?.classList.remove("over");
      over = target(at)?.[1] ?? null;
      over?.classList.add("over");
      window.clearInterval(scrolling);
      const [down, right] = this.edge(at);
      if (down !== 0 || right !== 0) scrolling = window.setInterval(() => this.scroller.scrollBy(right, down), 16);
    };
    const ended = (at: PointerEvent | null): void => {
      listening.abort();
      window.clearInterval(scrolling);
      over?.classList.remove("over");
      const found = ghost !== null && at !== null ? target(at) : null;
      ghost?.remove();
      if (found) void this.structure.reattach(name, found[0]);
    };
    // Heard on the document: the first move may already be over another body.
    document.addEventListener("pointermove", moved, always);
    document.addEventListener("pointerup", ended, always);
    document.addEventListener("pointercancel", () => ended(null), always);
    document.addEventListener("keydown", (at) => at.key === "Escape" && ended(null), always);
  }

  /** How fast the graph scrolls while a body is dragged near its border: down, right. */
  private edge(at: PointerEvent): [number, number] {
    const box = this.scroller.getBoundingClientRect();
    const near = (low: number, high: number, place: number): number => (place < low + 24 ? -8 : place > high - 24 ? 8 : 0);
    return [near(box.top, box.bottom, at.clientY), near(box.left, box.right, at.clientX)];
  }

  // ---- how large ---------------------------------------------------------------------------------------------------

  private zoomTo(zoom: number): void {
    this.zoom = Math.min(2, Math.max(0.25, zoom));
    this.sheet.style.zoom = String(this.zoom);
  }

  private fit(): void {
    const { clientWidth, clientHeight } = this.scroller;
    this.zoomTo(Math.min(1, clientWidth / this.layout.width, clientHeight / this.layout.height));
  }

  private wheel(event: WheelEvent): void {
    if (!event.ctrlKey) return;
    event.preventDefault();
    this.zoomTo(this.zoom * Math.exp(-event.deltaY / 500));
  }
}

function tool(words: string, key: string, title: string, act: () => unknown): HTMLElement {
  const named = key ? `${title} (${key})` : title;
  return make("button", { type: "button", title: named, "aria-label": words.length === 1 ? title : null, click: () => void act() }, words);
}

export function panel(host: HTMLElement, model: Model): void {
  new Graph(host, model);
}
