// What a new load, constraint or claim begins as. Words in capitals are to be filled in.

export interface Skeleton {
  kind: string;
  source: string;
}

const POINTS = "[{body: BODY, point: [0, 0, 0]}, {body: 0, point: [0, 0, 0]}]";

export const LOADS: Skeleton[] = [
  { kind: "uniform gravity", source: "{uniform gravity: {acceleration: g, direction: [0, -1, 0]}}" },
  { kind: "newtonian gravity", source: "{newtonian gravity: {constant: nu, centre: 0, about: BODY, order: 2}}" },
  { kind: "spring on a coordinate", source: "{spring: {coordinate: COORDINATE, stiffness: k}}" },
  { kind: "spring between points", source: `{spring: {between: ${POINTS}, stiffness: k, length: 0}}` },
  { kind: "damper on a coordinate", source: "{damper: {coordinate: COORDINATE, coefficient: c}}" },
  { kind: "damper between points", source: `{damper: {between: ${POINTS}, coefficient: c}}` },
  { kind: "isotropic damper", source: `{isotropic damper: {between: ${POINTS}, coefficient: c}}` },
  { kind: "force", source: "{force: {body: BODY, point: [0, 0, 0], components: [F, 0, 0], axes: 0}}" },
  { kind: "torque", source: "{torque: {body: BODY, components: [0, 0, M], axes: 0}}" },
  { kind: "generalized force", source: "{generalized force: {COORDINATE: Q}}" },
  { kind: "potential energy", source: "{potential: k*COORDINATE**2/2}" },
  { kind: "force function", source: "{force function: -k*COORDINATE**2/2}" },
  { kind: "dissipation function", source: "{rayleigh: c*COORDINATE_dot**2/2}" },
];

export const CONSTRAINTS: Skeleton[] = [
  { kind: "coincide: two points are one", source: `{coincide: ${POINTS}}` },
  { kind: "parallel: two axes stay parallel", source: "{parallel: [{body: BODY, axis: [0, 0, 1]}, {body: 0, axis: [0, 0, 1]}]}" },
  { kind: "distance: a rod without mass", source: `{distance: {between: ${POINTS}, length: l}}` },
  { kind: "relation between coordinates", source: "{relation: COORDINATE - OTHER = 0}" },
  { kind: "rolling", source: '{rolling: {body: BODY, point: [0, -r, 0], "on": ground}}' },
  { kind: "velocity: linear in velocities", source: "{velocity: COORDINATE_dot = 0}" },
];

export const CLAIMS: Skeleton[] = [
  { kind: "kinetic energy", source: "{claim: kinetic energy, equals: FORMULA, place: eq. (1)}" },
  { kind: "coefficient", source: "{claim: coefficient, of: kinetic energy, at: x_dot**2, equals: FORMULA, place: eq. (1)}" },
  { kind: "direction cosine", source: "{claim: direction cosine, of: BODY, entry: [1, 1], equals: FORMULA, place: Problem 1}" },
  { kind: "angular velocity", source: "{claim: angular velocity, of: BODY, component: 1, equals: FORMULA, place: Problem 1}" },
  { kind: "equation of motion", source: "{claim: equation of motion, of: COORDINATE, equals: FORMULA, place: eq. (1)}" },
  { kind: "entry of a linear matrix", source: "{claim: linear matrix K, entry: [1, 1], equals: FORMULA, place: eq. (1)}" },
  { kind: "entry of a subsystem's matrix", source: "{claim: subsystem matrix M, entry: [1, 1], equals: FORMULA, place: eq. (1)}" },
  { kind: "characteristic polynomial", source: "{claim: characteristic polynomial, of: COORDINATE, variable: lam, equals: FORMULA, place: eq. (1)}" },
  { kind: "condition of stability", source: "{claim: condition, that: FORMULA > 0, place: eq. (1)}" },
  { kind: "first integral", source: "{claim: first integral, equals: FORMULA, place: eq. (1)}" },
];
