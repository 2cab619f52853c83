// What can be done to the structure: each asks what it has to and hands an operation to the model.

import { asked, ask, confirmed } from "./dialogs.js";
import { make } from "./elements.js";
import { nodeAt, valueOf } from "./fields.js";
import { addTo } from "./formitems.js";
import { branch, FIXED } from "./layout.js";
import type { Model } from "./model.js";
import type { Changed, Joint, Operation, Path } from "./seam.js";
import { wordsOf } from "./server.js";

/** The name of the fixed axes for people. */
export const FIXED_WORDS = "fixed axes (0)";

export class Structure {
  constructor(
    private readonly model: Model,
    /** Shows and selects a body once it is there. */
    private readonly show: (name: string) => void,
  ) {}

  private get bodies() {
    return this.model.understood?.bodies ?? [];
  }

  private freeName(begin: string): string {
    const known = new Set(this.bodies.map((body) => body.name));
    let number = this.bodies.length + 1;
    while (known.has(`${begin} ${number}`)) number += 1;
    return `${begin} ${number}`;
  }

  async add(to: string): Promise<void> {
    const on = to === FIXED ? FIXED_WORDS : to;
    const body = await askedBody(`Add a body on ${on}`, this.freeName("body"), this.model.file.joints ?? []);
    if (body === null) return;
    const { name } = body;
    const outcome = await this.model.change([{ op: "add body", ...body, to: to === FIXED ? null : to }], `${name} added on ${on}`);
    if (outcome.done) this.show(name);
  }

  addLoad(body: string): Promise<void> {
    return addTo(this.model, "loads", ["loads"], "Loads", "a load", body === FIXED ? undefined : body);
  }

  addConstraint(body: string): Promise<void> {
    return addTo(this.model, "constraints", ["constraints"], "Constraints", "a constraint", body === FIXED ? undefined : body);
  }

  async rename(body: string): Promise<void> {
    if (body === FIXED) return this.model.say("the fixed axes have no name of their own");
    const name = await asked(`Rename ${body}`, "Name", body, "Rename");
    if (name === null || name === body) return;
    const outcome = await this.model.change([{ op: "rename body", body, name }], `${body} is called ${name}`);
    if (outcome.done) this.show(name);
  }

  /** Loads, constraints, motion and initial state go along; where something cannot, it is said before. */
  async duplicate(body: string): Promise<void> {
    if (body === FIXED) return this.model.say("the fixed axes cannot be duplicated");
    const copied = [body, ...branch(this.bodies, body)];
    const planned = await this.planned({ op: "duplicate branch", body });
    if (!planned) return;
    if (planned.left?.length) {
      const list = [
        line(copied.length === 1 ? "Body" : `${copied.length} bodies`, copied),
        ...this.told("Copied with it: ", planned.taken ?? []),
        ...this.told("Not copied: ", planned.left),
      ];
      const said = "The copy has names and coordinates of its own. What is not copied stays as it is, about the first alone:";
      if (!(await confirmed(`Duplicate ${body}?`, [make("p", {}, said), make("ul", {}, ...list)], "Duplicate"))) return;
    }
    const before = new Set(this.bodies.map((one) => one.name));
    const along = this.grouped(planned.taken ?? []).map(([section, names]) => `${section} ${names.join(", ")}`);
    const what = copied.length === 1 ? `${body} duplicated` : `${body} duplicated with what hangs on it: ${copied.length} bodies`;
    const outcome = await this.model.change([{ op: "duplicate branch", body }], [what, ...along].join("; "));
    const first = this.bodies.find((one) => !before.has(one.name));
    if (outcome.done && first) this.show(first.name);
  }

  /** What an operation would come to; null where it is refused, which is said. */
  private async planned(operation: Operation): Promise<Changed | null> {
    await this.model.idle;
    let answer: Changed;
    try {
      answer = await this.model.request<Changed>("change", { operations: [operation] });
    } catch (failure) {
      this.model.say(wordsOf(failure));
      return null;
    }
    if (answer.edits) return answer;
    this.model.say(answer.complaints?.map((one) => one.message).join("; ") || "this cannot be done here");
    return null;
  }

  /** Names the bodies, and all that goes since it names them, and asks. */
  async remove(body: string): Promise<void> {
    if (body === FIXED) return this.model.say("the fixed axes cannot be deleted");
    const going = [body, ...branch(this.bodies, body)];
    const planned = await this.planned({ op: "delete branch", body });
    if (!planned) return;
    const list = make("ul", {}, line(going.length === 1 ? "Body" : `${going.length} bodies`, going), ...this.told("", planned.taken ?? []));
    const done = await confirmed(
      `Delete ${body}?`,
      [make("p", {}, "This goes; one undo brings it back:"), list],
      going.length === 1 ? "Delete" : `Delete ${going.length} bodies`,
    );
    if (!done) return;
    const parent = this.bodies.find((one) => one.name === body)?.parent ?? FIXED;
    const outcome = await this.model.change([{ op: "delete branch", body }], `${going.join(", ")} deleted`);
    if (outcome.done) this.show(parent);
  }

  /** What goes or comes with bodies, by section. */
  private told(begin: string, paths: Path[]): HTMLElement[] {
    return this.grouped(paths).map(([section, names]) => {
      const on = section === "loads" || section === "constraints" ? " on them" : "";
      return line(begin ? `${begin}${section}` : `${section[0]!.toUpperCase()}${section.slice(1)}${on}`, names);
    });
  }

  /** Places by section, in the words of a person: "claims", ["3 (kinetic energy)", "4"]. */
  private grouped(paths: Path[]): [string, string[]][] {
    const found = new Map<string, string[]>();
    for (const path of paths) found.set(String(path[0]), [...(found.get(String(path[0])) ?? []), this.called(path)]);
    return [...found];
  }

  private called(path: Path): string {
    const [view, last] = [this.model.understood, path[1]];
    const tie = [...(view?.loads ?? []), ...(view?.constraints ?? [])].find((one) => one.path.join() === path.join());
    if (tie || typeof last !== "number") return tie?.name || String(last ?? "all of it");
    if (path[0] === "bodies" && path.length > 2) return `${path[2]} of ${view?.bodies[last]?.name ?? String(last + 1)}`;
    const item = nodeAt(this.model, path);
    const kind = valueOf(this.model, nodeAt(this.model, [...path, "claim"]));
    return item?.kind === "scalar" ? valueOf(this.model, item) : kind ? `${last + 1} (${kind})` : String(last + 1);
  }

  canCarry(body: string, to: string): boolean {
    return body !== FIXED && body !== to && !branch(this.bodies, body).includes(to);
  }

  async reattach(body: string, to: string): Promise<void> {
    const on = to === FIXED ? FIXED_WORDS : to;
    if (!this.canCarry(body, to)) return this.model.say(`${body || FIXED_WORDS} cannot hang on ${on}: that hangs on it, or is it`);
    const outcome = await this.model.change([{ op: "reattach", body, to: to === FIXED ? null : to }], `${body} hangs on ${on}`);
    if (outcome.done) this.show(body);
  }

  /** Reattaching without dragging. */
  async askReattach(body: string): Promise<void> {
    if (body === FIXED) return this.model.say("the fixed axes hang on nothing");
    const parent = this.bodies.find((one) => one.name === body)?.parent ?? FIXED;
    const select = make("select", {});
    for (const name of [FIXED, ...this.bodies.map((one) => one.name)]) {
      if (!this.canCarry(body, name)) continue;
      select.append(make("option", { value: name, selected: name === parent }, name === FIXED ? FIXED_WORDS : name));
    }
    const done = await ask(`Attach ${body} to another body`, [make("label", {}, "Attached to ", select)], [
      { words: "Attach", value: true, main: true },
      { words: "Cancel", value: false },
    ], false);
    if (done && select.value !== parent) await this.reattach(body, select.value);
  }
}

function line(what: string, names: string[]): HTMLElement {
  return make("li", {}, make("strong", {}, `${what}: `), names.join(", "));
}

/** Name of a new body, its joint and axis unless it is described by hand; null where it is given up. */
async function askedBody(title: string, free: string, joints: Joint[]): Promise<{ name: string; joint?: string; axis?: number } | null> {
  const name = make("input", { type: "text", value: free, autocomplete: "off", spellcheck: "false", autofocus: true });
  const joint = make("select", {}, ...joints.map((one) => make("option", { value: one.name }, `${one.name}: ${one.title.split(",")[0]}`)), make("option", { value: "" }, "none yet: all by hand"));
  const axis = make("select", {}, ...["3", "1", "2"].map((one) => make("option", { value: one }, one)));
  const asksAxis = () => {
    axis.disabled = !joints.find((one) => one.name === joint.value)?.axis;
    axis.value = joint.value === "slider" ? "1" : "3"; // in the plane of the paper at first, or out of it
  };
  joint.addEventListener("change", asksAxis);
  asksAxis();
  const rows = [make("label", {}, "Name ", name), make("label", {}, "Joint ", joint), make("label", {}, "Axis ", axis)];
  const done = await confirmed(title, rows, "Add");
  const typed = name.value.trim();
  if (!done || typed === "") return null;
  return joint.value ? { name: typed, joint: joint.value, axis: Number(axis.value) } : { name: typed };
}
