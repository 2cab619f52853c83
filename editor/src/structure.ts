// What can be done to the structure: each asks what it has to and hands an operation to the model.

import { asked, ask, confirmed } from "./dialogs.js";
import { make } from "./elements.js";
import { branch, FIXED } from "./layout.js";
import type { Model } from "./model.js";
import type { Changed, Path, Tie } from "./seam.js";

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
    const name = await asked(`Add a body on ${on}`, "Name", this.freeName("body"), "Add");
    if (name === null) return;
    const outcome = await this.model.change([{ op: "add body", name, to: to === FIXED ? null : to }], `${name} added on ${on}`);
    if (outcome.done) this.show(name);
  }

  async rename(body: string): Promise<void> {
    if (body === FIXED) return this.model.say("the fixed axes have no name of their own");
    const name = await asked(`Rename ${body}`, "Name", body, "Rename");
    if (name === null || name === body) return;
    const outcome = await this.model.change([{ op: "rename body", body, name }], `${body} is called ${name}`);
    if (outcome.done) this.show(name);
  }

  async duplicate(body: string): Promise<void> {
    if (body === FIXED) return this.model.say("the fixed axes cannot be duplicated");
    const before = new Set(this.bodies.map((one) => one.name));
    const count = branch(this.bodies, body).length + 1;
    const outcome = await this.model.change(
      [{ op: "duplicate branch", body }],
      count === 1 ? `${body} duplicated` : `${body} duplicated with what hangs on it: ${count} bodies`,
    );
    const first = this.bodies.find((one) => !before.has(one.name));
    if (outcome.done && first) this.show(first.name);
  }

  /** Names the bodies, loads and constraints that go, and asks. */
  async remove(body: string): Promise<void> {
    if (body === FIXED) return this.model.say("the fixed axes cannot be deleted");
    const going = [body, ...branch(this.bodies, body)];
    const gone = new Set(going);
    const view = this.model.understood;
    const touching = (ties: Tie[]): string[] =>
      ties.filter((tie) => tie.bodies.some((one) => gone.has(one))).map((tie) => tie.name || tie.kind);
    const planned = await this.model
      .request<Changed>("change", { operations: [{ op: "delete branch", body }] })
      .catch(() => null);
    const others = (planned?.taken ?? []).filter(([section]) => !["bodies", "loads", "constraints"].includes(String(section)));
    const [loads, constraints] = [touching(view?.loads ?? []), touching(view?.constraints ?? [])];
    const line = (what: string, names: string[]): HTMLElement | null =>
      names.length === 0 ? null : make("li", {}, make("strong", {}, `${what}: `), names.join(", "));
    const list = make(
      "ul",
      {},
      line(going.length === 1 ? "Body" : `${going.length} bodies`, going),
      line("Loads on them", loads),
      line("Constraints on them", constraints),
      line("What names them", others.map(named)),
    );
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

/** A place for people: "claims 3", "motion theta". */
function named(path: Path): string {
  return path.map((step) => (typeof step === "number" ? String(step + 1) : step)).join(" ");
}
