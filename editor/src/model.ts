// The one document of the page: its text, what the server understands of it, what is selected, whether it is saved.
//
// The text is the document. Form and graph ask the server which edits of the text an operation means (`change`) and
// those are applied as one transaction of the text's editor, so that one history undoes and redoes across all views.

import { history, invertedEffects, isolateHistory, redo, redoDepth, undo, undoDepth } from "@codemirror/commands";
import { EditorState, StateEffect, StateField, Transaction, type Extension } from "@codemirror/state";
import { EditorView } from "@codemirror/view";

import { isUnbegun } from "./beginning.js";
import { Listeners } from "./listeners.js";
import type { Body, Changed, Complaint, Edit, FileState, Format, Operation, Path, Told, View } from "./seam.js";
import { Away, Refused, get, post, wordsOf } from "./server.js";

/** So long after a key the text is looked at: short, because a look has to be shown within 100 ms of the key. */
const LOOK_AFTER = 15;
const JOURNAL_AFTER = 1000;

/** In which of its two spellings the text is; undone and redone with the conversion that changed it. */
const formatIs = StateEffect.define<Format>();
const spelling = StateField.define<Format>({
  create: () => "yaml",
  update: (format, transaction) =>
    transaction.effects.reduce((last, effect) => (effect.is(formatIs) ? effect.value : last), format),
});
const undoneWithTheText = invertedEffects.of((transaction) =>
  transaction.effects.some((effect) => effect.is(formatIs)) ? [formatIs.of(transaction.startState.field(spelling))] : [],
);

/** Requests that begin a job, which tells of itself by events. */
const JOBS: ReadonlySet<string> = new Set(["derive", "simulate", "equilibria", "modes", "map"]);

interface Hearing {
  /** Fulfilled as soon as events are heard. */
  promise: Promise<void>;
  heard: () => void;
  open: boolean;
}

function hearing(): Hearing {
  let fulfil = (): void => undefined;
  const made: Hearing = {
    promise: new Promise((resolve) => (fulfil = resolve)),
    heard: () => {
      made.open = true;
      fulfil();
    },
    open: false,
  };
  return made;
}

/** "another": a server answers at this address, but with another token; it knows nothing of this page. */
export type Connection = "there" | "away" | "another";

/** What a request that failed says of the server; null for nothing. */
function standing(failure: unknown): Connection | null {
  if (failure instanceof Refused) return failure.status === 404 ? "another" : "there";
  return failure instanceof Away ? "away" : null;
}

export interface Events {
  /** The text is another one. */
  text: string;
  /** The server has looked at the text. */
  view: View;
  /** The selected body, by name; null: none. */
  selection: string | null;
  format: Format;
  /** The file is another than before: written by us or by someone else. */
  file: FileState;
  saved: boolean;
  busy: boolean;
  /** A place of the text is to be shown, with the cursor in it. */
  goto: { from: number; to: number };
  connection: Connection;
  /** The server tells something by itself: of jobs, of the file. */
  told: Told;
  /** A sentence for the status line, also read to those who listen. */
  said: string;
  theme: "light" | "dark";
}

interface Outcome {
  done: boolean;
  complaints: Complaint[];
  select?: Path;
}

export class Model extends Listeners<Events> {
  /** The text's editor; `text.ts` gives it a place and its looks. */
  readonly editor: EditorView;
  /** What the server last understood; null before its first answer. */
  view: View | null = null;
  /** The text that `view` is of. */
  viewed: string | null = null;
  /** The last view with bodies: what graph, form and picture go on showing while a line is half typed. */
  understood: View | null = null;
  /** The text that `understood` is of: its places are counted there. */
  understoodText: string | null = null;
  selected: string | null = null;
  connection: Connection = "there";
  /** It will be asked for the server soon. */
  private waiting = false;
  /** The text as it stands in the file. */
  private stored: string;
  private changedAt: number | null = null;
  private lookTimer: number | undefined;
  private journalTimer: number | undefined;
  private looking: Promise<void> | null = null;
  private pending = 0;
  /** The text that is on its way into the file: the server tells every page of it, this one too. */
  private saving: string | null = null;
  private changes: Promise<unknown> = Promise.resolve();
  private listeningTo: EventSource | null = null;
  /** The last event that was heard: what came after it is told again to who was away. */
  private lastHeard: string;
  /** Whether the journal lacks the last changes. */
  private unkept = false;
  /** Said once: the folder takes no journal. */
  private unkeptSaid = false;
  /** Under this word the jobs of this page are begun: other pages of the file leave them alone. */
  private readonly page = crypto.randomUUID();
  private hearing = hearing();

  constructor(
    public file: FileState,
    extensions: Extension,
    root: Document | ShadowRoot,
  ) {
    super();
    this.stored = file.new ? "" : file.text;
    this.lastHeard = file.told;
    this.editor = new EditorView({
      root,
      state: EditorState.create({
        doc: file.text,
        extensions: [
          history(),
          spelling.init(() => file.format),
          undoneWithTheText,
          // The file's own line ends are kept: CodeMirror counts every line end as one character.
          EditorState.lineSeparator.of("\n"),
          extensions,
          EditorView.updateListener.of((update) => {
            if (update.startState.field(spelling) !== update.state.field(spelling)) this.formatChanged();
            if (update.docChanged) this.textChanged();
          }),
        ],
      }),
    });
  }

  get text(): string {
    return this.editor.state.doc.toString();
  }

  get format(): Format {
    return this.editor.state.field(spelling);
  }

  get saved(): boolean {
    return this.text === this.stored;
  }

  /** Whether an operation is on its way. */
  get busy(): boolean {
    return this.pending > 0;
  }

  /** Fulfilled when all operations that were asked for are done. */
  get idle(): Promise<unknown> {
    return this.changes;
  }

  /** Whether `view` is what the server understands of the text as it is now. */
  get fresh(): boolean {
    return this.viewed === this.text;
  }

  body(name: string | null): Body | null {
    return this.understood?.bodies.find((body) => body.name === name) ?? null;
  }

  select(name: string | null): void {
    if (name === this.selected) return;
    this.selected = name;
    this.tell("selection", name);
  }

  /** Shows a place of the text, the cursor in it. */
  goTo(from: number, to: number = from): void {
    this.tell("goto", { from, to });
  }

  say(words: string): void {
    this.tell("said", words);
  }

  themeChanged(theme: "light" | "dark"): void {
    this.tell("theme", theme);
  }

  // ---- the text --------------------------------------------------------------------------------------------------

  undo(): boolean {
    return undo(this.editor);
  }

  redo(): boolean {
    return redo(this.editor);
  }

  get undoable(): boolean {
    return undoDepth(this.editor.state) > 0;
  }

  get redoable(): boolean {
    return redoDepth(this.editor.state) > 0;
  }

  /** The whole text replaced by another: only what differs is touched, and one undo brings it back. */
  replaceText(text: string, format: Format = this.format): void {
    const old = this.text;
    let from = 0;
    while (from < old.length && from < text.length && old[from] === text[from]) from += 1;
    let [to, end] = [old.length, text.length];
    while (to > from && end > from && old[to - 1] === text[end - 1]) [to, end] = [to - 1, end - 1];
    if (from === to && from === end && format === this.format) return;
    this.apply([{ from, to, insert: text.slice(from, end) }], format === this.format ? [] : [formatIs.of(format)]);
  }

  /** One step of the history, joined with no typing before or after it. */
  private apply(changes: Edit[], effects: StateEffect<Format>[] = []): void {
    const annotations = [Transaction.userEvent.of("input.operation"), isolateHistory.of("full")];
    this.editor.dispatch({ changes, effects, annotations });
  }

  private formatChanged(): void {
    this.tell("format", this.format);
  }

  private textChanged(): void {
    this.changedAt ??= performance.now();
    this.tell("text", this.text);
    this.tell("saved", this.saved);
    window.clearTimeout(this.lookTimer);
    this.lookTimer = window.setTimeout(() => void this.look(), LOOK_AFTER);
    window.clearTimeout(this.journalTimer);
    this.journalTimer = window.setTimeout(() => void this.journal(), JOURNAL_AFTER);
  }

  // ---- the server ------------------------------------------------------------------------------------------------

  /** A request about the text as it is now: `text` and `format` go with it. */
  async request<Answer>(name: string, body: object = {}, signal?: AbortSignal): Promise<Answer> {
    const whole = { text: this.text, format: this.format, ...body };
    if (!JOBS.has(name)) return this.watched(post<Answer>(name, whole, signal));
    // A job that nobody hears is ended after a while.
    await this.hearing.promise;
    return this.watched(post<Answer>(name, { page: this.page, ...whole }, signal));
  }

  /** A request that is not about the text: cancel, save. */
  post<Answer>(name: string, body: object): Promise<Answer> {
    return this.watched(post<Answer>(name, body));
  }

  private async watched<Answer>(asked: Promise<Answer>): Promise<Answer> {
    try {
      const answer = await asked;
      this.connected("there");
      return answer;
    } catch (failure) {
      this.connected(standing(failure));
      throw failure;
    }
  }

  private connected(connection: Connection | null): void {
    if (connection === null || connection === this.connection) return;
    this.connection = connection;
    this.tell("connection", connection);
    if (connection === "there" && this.listeningTo?.readyState === EventSource.CLOSED) this.listen();
    if (connection === "there") {
      void this.look();
      if (this.unkept) void this.journal();
    } else if (!this.waiting) this.waitForServer();
  }

  /** A server that was stopped may come back at the same address, with the same token or not. */
  private waitForServer(): void {
    this.waiting = true;
    window.setTimeout(() => {
      this.waiting = false;
      if (this.connection === "there") return;
      get("digest").then(
        () => this.connected("there"),
        (failure: unknown) => {
          this.connected(standing(failure));
          if (!this.waiting) this.waitForServer();
        },
      );
    }, 2000);
  }

  /**
   * Asks the server what the text means; done when that is known of the text as it is. One question at a time: who types
   * faster than the server answers must not pile up work there.
   */
  async look(): Promise<void> {
    window.clearTimeout(this.lookTimer);
    if (this.looking) {
      await this.looking;
      return this.fresh ? undefined : this.look();
    }
    this.looking = this.lookNow();
    await this.looking;
  }

  private async lookNow(): Promise<void> {
    const text = this.text;
    const begun = this.changedAt ?? performance.now();
    this.changedAt = null;
    try {
      const view = await this.request<View>("look");
      this.looking = null;
      view.unbegun = isUnbegun(view);
      if (view.unbegun) view.complaints = view.complaints.filter((one) => one.severity !== "error");
      this.view = view;
      this.viewed = text;
      // A text in the other spelling was put in: it says so itself.
      if (view.format !== this.format && text === this.text) {
        this.editor.dispatch({ effects: formatIs.of(view.format), annotations: Transaction.addToHistory.of(false) });
      }
      // Half a line that is no YAML takes whole sections away for a moment: what was understood before is shown on.
      const broken = view.tree === null || view.complaints.some((one) => one.code === "syntax");
      if (!broken || this.understood === null || view.bodies.length >= this.understood.bodies.length) {
        this.understood = view;
        this.understoodText = text;
      }
      if (this.selected !== null && !this.body(this.selected)) this.select(null);
      this.tell("view", view);
      // From the first key that this look is about until everything is told: read by the tests.
      performance.measure("mbsym:look", { start: begun, end: performance.now() });
    } catch (failure) {
      if (!(failure instanceof Away)) this.say(wordsOf(failure));
    } finally {
      this.looking = null;
    }
  }

  /** Waits until the server has looked at the text as it is. */
  async looked(): Promise<View | null> {
    if (!this.fresh) await this.look();
    return this.fresh ? this.view : null;
  }

  /**
   * Does what form and graph ask for, as one step of the history. One after the other: each is asked about the text that
   * the one before has left; operations that depend on the view are given as a function. Where the server complains
   * nothing is done, and it is said.
   */
  change(operations: Operation[] | (() => Operation[]), words?: string): Promise<Outcome> {
    this.pending += 1;
    this.tell("busy", true);
    const next = this.changes
      .then(() => this.changeNow(operations, words))
      .finally(() => {
        this.pending -= 1;
        this.tell("busy", this.busy);
      });
    this.changes = next.catch(() => undefined);
    return next;
  }

  private async changeNow(wanted: Operation[] | (() => Operation[]), words?: string): Promise<Outcome> {
    // Worked out only now, of what the changes before have left.
    if (typeof wanted === "function") await this.looked();
    const operations = typeof wanted === "function" ? wanted() : wanted;
    if (operations.length === 0) return { done: true, complaints: [] };
    for (let attempt = 0; attempt < 3; attempt += 1) {
      const text = this.text;
      let answer: Changed;
      try {
        answer = await this.request<Changed>("change", { operations });
      } catch (failure) {
        this.say(wordsOf(failure));
        return { done: false, complaints: [] };
      }
      // Typed on meanwhile: the places in the answer are of another text.
      if (text !== this.text) continue;
      if (!answer.edits) {
        const complaints = answer.complaints ?? [];
        this.say(complaints.map((one) => one.message).join("; ") || "this cannot be done here");
        return { done: false, complaints };
      }
      if (answer.edits.length > 0) this.apply(answer.edits);
      await this.look();
      if (words) this.say(words);
      return { done: true, complaints: [], ...(answer.select ? { select: answer.select } : {}) };
    }
    this.say("the text changes faster than the operation can be made");
    return { done: false, complaints: [] };
  }

  // ---- the file --------------------------------------------------------------------------------------------------

  /** What the file holds was changed by someone else: it is remembered, the text here stays. */
  fileIs(digest: string, text: string): void {
    this.file = { ...this.file, digest, new: false };
    this.stored = text;
    this.tell("file", this.file);
    this.tell("saved", this.saved);
  }

  /** The file was taken away: what stands here is nowhere else, and is saved as a new one. */
  fileIsGone(): void {
    this.file = { ...this.file, digest: "", new: true };
    this.stored = "";
    this.tell("file", this.file);
    this.tell("saved", this.saved);
    void this.journal();
  }

  get beingSaved(): string | null {
    return this.saving;
  }

  /** Saves; `force` writes over what someone else has written. Another text in the file is answered, not overwritten. */
  async save(force = false): Promise<{ saved: true } | { saved: false; other: { digest: string; text: string } | null }> {
    const text = this.text;
    this.saving = text;
    try {
      const answer = await this.post<{ digest: string }>("save", { text, digest: this.file.digest, ...(force ? { force } : {}) });
      this.file = { ...this.file, digest: answer.digest, new: false, journal: null };
      this.stored = text;
      this.tell("file", this.file);
      this.tell("saved", this.saved);
      return { saved: true };
    } catch (failure) {
      if (failure instanceof Refused && failure.status === 409) {
        return { saved: false, other: { digest: String(failure.body["digest"]), text: String(failure.body["text"]) } };
      }
      this.say(wordsOf(failure));
      return { saved: false, other: null };
    } finally {
      this.saving = null;
    }
  }

  private async journal(): Promise<void> {
    this.unkept = true;
    try {
      await this.post("journal", { text: this.text, digest: this.file.digest });
      this.unkept = this.unkeptSaid = false;
    } catch (failure) {
      // That the server is away is told elsewhere, and it is tried again when it is back.
      if (!(failure instanceof Refused) || this.unkeptSaid) return;
      this.unkeptSaid = true;
      this.say(`what is not saved is kept in this page only: ${failure.message}`);
    }
  }

  /** The same description in the other spelling; refused while it has mistakes. */
  async convert(to: Format): Promise<boolean> {
    try {
      const answer = await this.request<{ text: string }>("convert", { to });
      this.replaceText(answer.text, to);
      await this.look();
      return true;
    } catch (failure) {
      this.say(wordsOf(failure));
      return false;
    }
  }

  /** Begins to listen to what the server tells by itself. */
  listen(): void {
    this.listeningTo?.close();
    const source = new EventSource(`api/events?after=${encodeURIComponent(this.lastHeard)}`);
    this.listeningTo = source;
    source.onmessage = (event) => {
      this.lastHeard = event.lastEventId;
      try {
        this.tell("told", JSON.parse(String(event.data)) as Told);
      } catch (failure) {
        console.error(failure);
      }
    };
    source.onopen = () => {
      this.hearing.heard();
      this.connected("there");
    };
    source.onerror = () => {
      // Those who wait already go on waiting: the next opening is theirs, too.
      if (this.hearing.open) this.hearing = hearing();
      this.connected("away");
    };
  }
}

/** The model of the page, once the server has said which file it is about. */
export async function opened(extensions: Extension, root: Document | ShadowRoot): Promise<Model> {
  return new Model(await get<FileState>("file"), extensions, root);
}
