// The straight-line program of a picture, evaluated in the same order of operations as in the library.

import type { Closure, Picture, Program } from "./types.js";

const OPERATIONS = [
  ..."+-*/",
  ...["neg", "sqrt", "sin", "cos", "exp", "log", "atan", "sinh", "cosh", "tanh", "abs", "sign", "table"],
];

/** Values of the coordinates, of their velocities where loads want them, and of t. */
export type State = Record<string, number>;

export class Poses {
  /** All values of the program; operands are places in it. */
  readonly values: Float64Array;
  private readonly operations: Uint8Array;
  private readonly first: Int32Array;
  private readonly second: Int32Array;
  private readonly start: number;

  constructor(private readonly program: Program) {
    const { inputs, constants, steps } = program;
    this.start = inputs.length + constants.length;
    this.values = new Float64Array(this.start + steps.length);
    constants.forEach((value, k) => (this.values[inputs.length + k] = value ?? NaN));
    this.operations = new Uint8Array(steps.length);
    this.first = new Int32Array(steps.length);
    this.second = new Int32Array(steps.length);
    steps.forEach(([name, a, b], k) => {
      const table = name.startsWith("table ");
      const code = OPERATIONS.indexOf(table ? "table" : name);
      if (code < 0) throw new Error(`a picture with an unknown operation: ${name}`);
      this.operations[k] = code;
      this.first[k] = a ?? 0;
      this.second[k] = table ? Number(name.slice(6)) : (b ?? 0);
    });
  }

  /** Evaluates everything; a name without a value counts as 0. */
  at(state: State): Float64Array {
    const { values, operations, first, second } = this;
    this.program.inputs.forEach((name, k) => (values[k] = state[name] ?? 0));
    for (let k = 0, to = this.start; k < operations.length; k += 1, to += 1) {
      const a = values[first[k]!]!;
      const b = values[second[k]!]!;
      switch (operations[k]) {
        case 0: values[to] = a + b; break;
        case 1: values[to] = a - b; break;
        case 2: values[to] = a * b; break;
        case 3: values[to] = a / b; break;
        case 4: values[to] = -a; break;
        case 5: values[to] = Math.sqrt(a); break;
        case 6: values[to] = Math.sin(a); break;
        case 7: values[to] = Math.cos(a); break;
        case 8: values[to] = Math.exp(a); break;
        case 9: values[to] = Math.log(a); break;
        case 10: values[to] = Math.atan(a); break;
        case 11: values[to] = Math.sinh(a); break;
        case 12: values[to] = Math.cosh(a); break;
        case 13: values[to] = Math.tanh(a); break;
        case 14: values[to] = Math.abs(a); break;
        case 15: values[to] = Math.sign(a); break;
        default: values[to] = this.lookedUp(second[k]!, a);
      }
    }
    return values;
  }

  private lookedUp(table: number, x: number): number {
    const { knots, bases, pieces } = this.program.tables[table]!;
    let piece = 0;
    while (piece < knots.length && knots[piece]! <= x) piece += 1;
    const u = x - bases[piece]!;
    return pieces[piece]!.reduceRight((total, c) => total * u + c, 0);
  }
}

/** The state of the start. */
export function begun(picture: Picture): State {
  const state: State = { t: 0 };
  for (const one of picture.coordinates) {
    state[one.name] = one.value;
    state[`${one.name}_dot`] = one.velocity;
  }
  return state;
}

// ---- loops ---------------------------------------------------------------------------------------------------------

const STEPS = 60;
const LONGEST = 0.5;

/** The rows that are open: |f| above the tolerance, as a part of what the coordinates do to it. */
function openRows(poses: Poses, closure: Closure, state: State, tolerance = closure.tolerance): string[] {
  const values = poses.at(state);
  return closure.names.filter((_, i) => {
    let scale = 0;
    closure.coordinates.forEach((name, k) => {
      scale += Math.abs(values[closure.slopes[i]![k]!]!) * (closure.sizes[k]! + Math.abs(state[name] ?? 0));
    });
    return !(Math.abs(values[closure.rows[i]!]!) <= tolerance * (scale || 1));
  });
}

/** Leads the other coordinates to the constraints; what stays open is answered. `state` is changed. */
export function close(poses: Poses, closure: Closure, state: State, held: readonly string[]): string[] {
  const free = closure.coordinates.map((_, k) => k).filter((k) => !held.includes(closure.coordinates[k]!));
  for (let step = 0; step < STEPS && free.length > 0; step += 1) {
    if (openRows(poses, closure, state, 1e-3 * closure.tolerance).length === 0) break;
    const values = poses.values; // of this state: openRows has just evaluated it
    const slopes = closure.slopes.map((row) => free.map((k) => values[row[k]!]!));
    const change = shortest(slopes, closure.rows.map((k) => -values[k]!));
    if (!change.every(Number.isFinite)) break;
    const far = Math.max(
      ...free.map((k, i) => Math.abs(change[i]!) / (closure.sizes[k]! + Math.abs(state[closure.coordinates[k]!]!))),
    );
    const part = Math.min(1, LONGEST / Math.max(far, 1e-300));
    free.forEach((k, i) => (state[closure.coordinates[k]!]! += part * change[i]!));
  }
  return openRows(poses, closure, state);
}

/** The shortest x with J x = f, nearly: x = J'(J J' + mu)^-1 f, so that dependent rows do no harm. */
function shortest(J: number[][], f: number[]): number[] {
  const n = J.length;
  const A = J.map((row) => J.map((other) => row.reduce((total, x, k) => total + x * other[k]!, 0)));
  const mu = 1e-13 * Math.max(...A.map((row, i) => row[i]!), 1e-300);
  const y = [...f];
  for (let i = 0; i < n; i += 1) A[i]![i]! += mu;
  // Cholesky's factor in the lower half, then two substitutions.
  for (let j = 0; j < n; j += 1) {
    for (let k = 0; k < j; k += 1) for (let i = j; i < n; i += 1) A[i]![j]! -= A[i]![k]! * A[j]![k]!;
    const pivot = Math.sqrt(Math.max(A[j]![j]!, mu));
    for (let i = j; i < n; i += 1) A[i]![j] = i === j ? pivot : A[i]![j]! / pivot;
  }
  for (let i = 0; i < n; i += 1) {
    for (let k = 0; k < i; k += 1) y[i]! -= A[i]![k]! * y[k]!;
    y[i]! /= A[i]![i]!;
  }
  for (let i = n - 1; i >= 0; i -= 1) {
    for (let k = i + 1; k < n; k += 1) y[i]! -= A[k]![i]! * y[k]!;
    y[i]! /= A[i]![i]!;
  }
  return (J[0] ?? []).map((_, k) => J.reduce((total, row, i) => total + row[k]! * y[i]!, 0));
}
