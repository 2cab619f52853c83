// A job of the server, as a panel follows it: the one that was begun last, with what it tells until it ends.

import type { Model } from "./model.js";
import type { Told } from "./seam.js";

export class Job {
  private name: string | null = null;
  /** So many were asked for. */
  private count = 0;
  /** What was told of jobs before the name was known: the answer to a request may be overtaken. */
  private early: Told[] = [];

  /** `hear` gets what the job tells, at its end when it is over; `again`: something that it told is lost. */
  constructor(
    private readonly model: Model,
    private readonly hear: (told: Told) => void,
    again: () => void,
  ) {
    model.on("told", (told) => {
      if (told.kind === "lost" && this.name !== null) again();
      if (told.job === undefined) return;
      if (told.job === this.name) this.told(told);
      else this.early = [...this.early.slice(-40), told];
    });
  }

  get runs(): boolean {
    return this.name !== null;
  }

  /** Raises what the request does; `begun` is called before anything is heard, but where another one was asked for meanwhile. */
  async begin(kind: string, body: object, begun: () => void = () => undefined): Promise<void> {
    const mine = (this.count += 1);
    this.early = [];
    try {
      const { job } = await this.model.request<{ job: string }>(kind, body);
      if (mine !== this.count) return;
      this.name = job;
    } catch (failure) {
      if (mine !== this.count) return;
      this.name = null;
      throw failure;
    }
    begun();
    const before = this.early.filter((told) => told.job === this.name);
    this.early = [];
    before.forEach((told) => this.told(told));
  }

  /** Nothing is heard of it any more. */
  forget(): void {
    this.name = null;
  }

  async stop(): Promise<void> {
    if (this.name !== null) await this.model.post("cancel", { job: this.name }).catch(() => undefined);
  }

  private told(told: Told): void {
    if (["done", "failed", "cancelled"].includes(told.kind)) this.name = null;
    this.hear(told);
  }
}
