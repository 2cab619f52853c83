// What the server and the page say to each other, as types. Offsets count UTF-16 code units, as JavaScript does.

export type Format = "yaml" | "text";
export type Path = (string | number)[];

export interface Complaint {
  severity: "error" | "warning";
  code: string;
  message: string;
  hint: string | null;
  from: number;
  to: number;
  line: number;
  column: number;
}

export interface TreeNode {
  kind: "mapping" | "sequence" | "scalar";
  path: Path;
  from: number;
  to: number;
  key?: { from: number; to: number };
  source?: string;
  children?: TreeNode[];
}

export interface Field {
  path: Path;
  /** As spelled in the text; null: not written. */
  source: string | null;
  from: number | null;
  to: number | null;
  mathml: string | null;
  /** What is understood where the field is left empty. */
  derived: { source: string; mathml: string | null } | null;
}

export interface Body {
  name: string;
  path: Path;
  /** null: the fixed axes, body 0. */
  parent: string | null;
  from: number;
  to: number;
  fields: Record<string, Field>;
}

/** A load or a constraint: it acts on bodies, or ties them. */
export interface Tie {
  name: string;
  kind: string;
  path: Path;
  bodies: string[];
  from: number;
  to: number;
}

export interface View {
  name: string;
  format: Format;
  tree: TreeNode | null;
  bodies: Body[];
  constraints: Tie[];
  loads: Tie[];
  complaints: Complaint[];
  /** The same where only comments and blanks differ; null while the text has mistakes. */
  content: string | null;
  /** Nothing has been described yet, which is no mistake. */
  unbegun?: boolean;
  [section: string]: unknown;
}

type NamedKind = "parameter" | "coordinate" | "constraint" | "load" | "input";

export type Operation =
  | { op: "set"; path: Path; source: string }
  | { op: "insert"; path: Path; source: string }
  | { op: "delete"; path: Path }
  | { op: "move"; path: Path; before: Path | null }
  | { op: "add body"; name: string; to: string | null; joint?: string; axis?: number }
  | { op: "rename body"; body: string; name: string }
  | { op: "reattach"; body: string; to: string | null }
  | { op: "duplicate branch"; body: string }
  | { op: "delete branch"; body: string }
  | { op: "rename"; kind: NamedKind; name: string; to: string };

export interface Edit {
  from: number;
  to: number;
  insert: string;
}

export interface Changed {
  edits?: Edit[];
  select?: Path;
  /** What goes, too, because it names what is deleted; or is copied with a branch. */
  taken?: Path[];
  /** What names a branch that is copied and is not copied itself. */
  left?: Path[];
  complaints?: Complaint[];
}

export interface FileState {
  name: string;
  path: string;
  format: Format;
  text: string;
  digest: string;
  new: boolean;
  journal: { text: string; written: string } | null;
  version: string;
  schema: unknown;
  /** Kind of claim -> what its "of" names, and its keys. */
  claims: Record<string, { of: string; keys: string[] }>;
  functions: unknown[];
  languages: string[];
  /** The last event that was told before the file was read. */
  told: string;
  examples?: { name: string; title: string }[];
  joints?: Joint[];
}

/** How a body may move on what carries it; `axis`: about or along one axis, whichever. */
export interface Joint {
  name: string;
  title: string;
  axis: boolean;
}

interface CompletionItem {
  label: string;
  kind: string;
  detail: string;
  insert: string;
  documentation: string;
}

export interface Completion {
  from: number;
  items: CompletionItem[];
}

/** Everything the server tells by itself: of jobs, and of the file; "lost": something was told that cannot be told again. */
export interface Told {
  kind: string;
  job?: string;
  [key: string]: unknown;
}
