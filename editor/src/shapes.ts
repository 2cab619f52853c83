// Principal moments of inertia of homogeneous bodies about their mass centre, as formulas to be put into the form.
// The formulas are those of every table (L. D. Landau, E. M. Lifshitz, Mechanics, section 32, problem 2).

interface Solid {
  name: string;
  /** The names of its sizes, with what they are. */
  sizes: [name: string, words: string][];
  /** About its own three axes; the third is the one of symmetry. */
  moments: (mass: string, sizes: string[]) => [string, string, string];
}

/** A sum as a factor needs brackets; a name or a number does not. */
function bracketed(formula: string): string {
  const text = formula.trim();
  return /^[\p{L}\d_.]+$/u.test(text) ? text : `(${text})`;
}

const square = (size: string): string => `${bracketed(size)}**2`;
const raw = (factor: string, mass: string, ...parts: string[]): string => `${bracketed(mass)}*${parts.join("*")}${factor}`;

export const SOLIDS: Solid[] = [
  {
    name: "thin rod",
    sizes: [["l", "length"]],
    moments: (m, [l]) => [raw("/12", m, square(l!)), raw("/12", m, square(l!)), "0"],
  },
  {
    name: "thin disc",
    sizes: [["r", "radius"]],
    moments: (m, [r]) => [raw("/4", m, square(r!)), raw("/4", m, square(r!)), raw("/2", m, square(r!))],
  },
  {
    name: "cylinder",
    sizes: [["r", "radius"], ["h", "height"]],
    moments: (m, [r, h]) => {
      const across = raw("/12", m, `(3*${square(r!)} + ${square(h!)})`);
      return [across, across, raw("/2", m, square(r!))];
    },
  },
  {
    name: "box",
    sizes: [["a", "edge along 1"], ["b", "edge along 2"], ["c", "edge along 3"]],
    moments: (m, [a, b, c]) => {
      const of = (x: string, y: string): string => raw("/12", m, `(${square(x)} + ${square(y)})`);
      return [of(b!, c!), of(a!, c!), of(a!, b!)];
    },
  },
  {
    name: "sphere",
    sizes: [["r", "radius"]],
    moments: (m, [r]) => {
      const one = `2*${bracketed(m)}*${square(r!)}/5`;
      return [one, one, one];
    },
  },
  {
    name: "thin spherical shell",
    sizes: [["r", "radius"]],
    moments: (m, [r]) => {
      const one = `2*${bracketed(m)}*${square(r!)}/3`;
      return [one, one, one];
    },
  },
];

/** The moments with the body's third axis put along `axis` of the body; a box's edges are along the body's own. */
export function along(moments: [string, string, string], axis: number): [string, string, string] {
  const [first, second, third] = moments;
  return axis === 1 ? [third, second, first] : axis === 2 ? [first, third, second] : moments;
}
