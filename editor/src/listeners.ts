// Who wants to be told of what.

export class Listeners<Events extends object> {
  private readonly all = new Map<keyof Events, Set<(value: never) => void>>();

  /** Calls `listener` whenever `event` happens; what is returned ends that. */
  on<Kind extends keyof Events>(event: Kind, listener: (value: Events[Kind]) => void): () => void {
    const known = this.all.get(event) ?? new Set();
    this.all.set(event, known);
    known.add(listener as (value: never) => void);
    return () => known.delete(listener as (value: never) => void);
  }

  protected tell<Kind extends keyof Events>(event: Kind, value: Events[Kind]): void {
    for (const listener of [...(this.all.get(event) ?? [])]) {
      try {
        (listener as (value: Events[Kind]) => void)(value);
      } catch (failure) {
        // One panel that fails must not keep the others from being told.
        console.error(failure);
      }
    }
  }
}
