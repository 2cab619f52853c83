// What the library tells of a picture (mbsym/picture/encode.py, motion.py, modes.py, resting.py). An operand is the
// number of a value of the picture's program.

export type Triple = [number, number, number];

export interface Program {
  inputs: string[];
  constants: (number | null)[];
  steps: [string, ...number[]][];
  tables: { knots: number[]; bases: number[]; pieces: number[][] }[];
}

export interface Coordinate {
  name: string;
  /** With Greek letters and indices. */
  label: string;
  kind: "angle" | "length" | "other";
  unit: string;
  value: number;
  velocity: number;
  minimum: number;
  maximum: number;
  limited: boolean;
}

interface Given {
  name: string;
  label: string;
  value: number | null;
  unit: string;
  meaning: string;
  /** Otherwise a number stands in for one that nobody gave. */
  given: boolean;
}

export interface Shape {
  kind: "box" | "sphere" | "cylinder" | "capsule" | "ellipsoid";
  size: number[];
  at: Triple;
  axes: [Triple, Triple, Triple];
}

export interface Body {
  name: string;
  parent: string | null;
  axes: [Triple, Triple, Triple];
  origin: Triple;
  centre: Triple;
  massive: boolean;
  /** It has no look of its own and only slides, along a straight line in the frame. */
  cart: boolean;
  joint: { hinges: Hinge[]; sprung: string[]; damped: string[] };
  shapes: Shape[];
  ellipsoid: { halfAxes: Triple; axes: [Triple, Triple, Triple]; trueSize: boolean; telling: boolean } | null;
}

export interface Hinge {
  along: Triple;
  coordinates: string[];
  slides: boolean;
  straight: boolean;
}

/** A hoop: points in the axes of the parent of the body that slides along it. */
interface Guide {
  body: string;
  points: Triple[];
  closed: boolean;
}

interface Arrow {
  load: number;
  of: "gravity" | "force" | "torque";
  body: string;
  point: Triple;
  along: Triple;
}

export interface Line {
  kind: "body" | "link" | "slide" | "spring" | "damper" | "rod";
  start: Triple;
  end: Triple;
  of: string;
}

export interface Closure {
  coordinates: string[];
  sizes: number[];
  rows: number[];
  slopes: number[][];
  names: string[];
  tolerance: number;
}

export interface Picture {
  name: string;
  frame: string;
  units: { length?: string; time?: string };
  coordinates: Coordinate[];
  parameters: Given[];
  program: Program;
  bodies: Body[];
  arrows: Arrow[];
  lines: Line[];
  guides: Guide[];
  closure: Closure | null;
  view: { up: Triple; azimuth: number; elevation: number; plane: boolean };
  middle: Triple;
  extent: number;
  /** Coordinates without an initial value. */
  atZero: string[];
  sentences: string[];
}

export interface Motion {
  times: number[];
  coordinates: Record<string, (number | null)[]>;
  velocities: Record<string, (number | null)[]>;
  kinetic: (number | null)[];
  energy: (number | null)[];
  drift: (number | null)[];
  driftOf: string;
  units: { time?: string; energy?: string };
  /** Why it may be wrong. */
  doubts: string[];
  sentences: string[];
}

export interface Verdict {
  verdict: string;
  theorems: string[];
  explanation: string;
}

export interface Mode {
  real: number;
  imaginary: number;
  frequency: number;
  damping: number;
  multiplicity: number;
  fewer: boolean;
  shape: Record<string, [number, number]>;
}

export interface Modes {
  base: Record<string, number>;
  turning: Record<string, number>;
  verdict: Verdict;
  still: string[];
  modes: Mode[];
  sentences: string[];
}

export interface Equilibria {
  equilibria: {
    values: Record<string, number>;
    texts: Record<string, string>;
    free: string[];
    verdict: Verdict;
    proof: string;
    otherAngles: string;
    family: boolean;
  }[];
  complete: boolean;
  remarks: string[];
  turning: Record<string, number>;
}
