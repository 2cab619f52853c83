"""Every key of a description and what it means: the one table that the reader, its hints and the JSON Schema share."""

from __future__ import annotations

VERSION = "1"

SIGNS = ("real", "positive", "nonnegative", "negative", "nonpositive", "nonzero")

SYSTEM = {
    "mbsym": "version of this format: 1",
    "name": "what the system is called in reports",
    "description": "a sentence or two about it",
    "parameters": "constants: names with a sign word, a number, or {sign, value, meaning}; or a plain list of names",
    "prescribed": "known functions of time with a constant rate: {name: {rate, initial, meaning}} or {name: rate}; "
    "other functions of t may stand in joints",
    "inputs": "known functions of time that are chosen later, for forces and torques: {u: {meaning, unit}}",
    "outputs": "what is measured: {y: theta}, in coordinates, velocities, parameters and inputs",
    "tables": "inputs given by points: {torque: {points: [[0, 0], [1, 2.5]]}}, in loads torque(t) or torque(theta)",
    "bodies": "the bodies and massless frames, each attached to the inertial frame 0 or to an earlier one",
    "linear system": "in place of bodies and loads: the matrices of M x'' + (D + G) x' + (K + N) x = B u",
    "loads": "gravity, springs, dampers, forces: a list of {kind of load: {...}}",
    "constraints": "what ties bodies or coordinates besides the joints: a list of {kind of constraint: {...}}",
    "dependent": "coordinates or speeds that constraints express by the others: [q2, q3]; what is left out is found",
    "reactions": "bodies whose joints' forces and moments are wanted: [hinge]",
    "relations": "parameters that are functions of others, used from problem 4 on: {nu: omega0**2*R**3}",
    "assumptions": "inequalities between parameters and notation, such as alpha > -1",
    "motion": "the unperturbed motion: {coordinate: value} or {coordinate: {value, rate}}; others are 0 at rest, {} is "
    "the rest of all at 0",
    "notation": "own symbols for groups of parameters, in order: later ones may use earlier ones",
    "dimensionless time": "a rate w; problems 5 and 6 then use the time tau = w*t",
    "small parameter": "a parameter in whose powers 'mbsym expand' expands, or {eps: {powers: {e: 1, p2: -1}}}: "
    "e eps and p2/eps stand for e and p2",
    "values": "numerical values of parameters: {l: 2}",
    "initial": "the initial state: {coordinate: position} or {coordinate: {position, velocity}} (velocity 0); "
    "declared variables have values, {p: 0.1, e0: 1}",
    "abbreviations": "a publication's own symbols for use in claims, in order: {c1: mA + mB, ...}",
    "source": "where the system is from: a publication, for the references of reports",
    "latex": "how names are written in LaTeX: {d_Ccm1: 'd_{C1}', phi: '\\phi'}: letters, accents, fonts and an index",
    "order": "in which order subsystems and their coordinates are told, in problems 5 and 6: [theta, psi]",
    "language": "of the LaTeX reports: en, ru or es",
    "units": "units of coordinates, parameters, prescribed motions: {x: m, theta: rad}; every formula is then checked",
    "limits": "least and greatest values of coordinates, for drawing: {q1: [-pi, pi]}; no force keeps them",
    "claims": "formulas and numbers that were printed, to be checked: [{claim: kinetic energy, equals: ...}, ...]",
}

PARAMETER = {
    "sign": f"one of {', '.join(SIGNS)} (or positive: true); when left out, the sign of the value, or real without one",
    "value": "a numerical value, used where numbers are wanted",
    "meaning": "what it is, for reports",
    "unit": "its unit, such as kg*m^2; every formula is then checked for its dimension",
}

PRESCRIBED = {
    "rate": "its constant rate of change",
    "initial": "its value at t = 0 (0 when left out)",
    "meaning": "what it is, for reports",
    "unit": "its unit, such as rad or m",
}

INPUT = {
    "meaning": "what it is, for reports",
    "unit": "its unit, such as N*m or N",
}

SMALL_PARAMETER = {
    "powers": "{e: 1, p2: -1}: in place of e and p2 stand e*eps and p2/eps, with a name eps of its own "
    "(variables may be small, too, for oscillations); when left out, "
    "the small parameter is one of the parameters",
    "fast": "the variables that a slow manifold expresses by the others: [x, y]; found when left out",
    "slow": "variables that are not among the fast ones: [p, q]",
    "leading": "the variable whose oscillation 'mbsym oscillations' follows; found when there is only one",
}

LINEAR_SYSTEM = {
    "coordinates": "names of the coordinates x, in the order of rows and columns",
    "M": "mass matrix, symmetric and positive definite: a list of rows of formulas in parameters, or {file: M.mtx}; "
    "the unit matrix when left out",
    "D": "damping, symmetric; zero when left out, as the others",
    "G": "gyroscopic matrix, skew",
    "C": "in place of D and G: their sum, any square matrix",
    "K": "stiffness, symmetric",
    "N": "circulatory matrix, skew",
    "S": "in place of K and N: their sum, any square matrix",
    "A": "in place of all these: x' = A x, any square matrix",
    "B": "where the inputs act: a row for each coordinate, a column for each of 'inputs'",
}

MATRIX_FILE = {
    "file": "a file beside the description, or in a folder below: MatrixMarket (.mtx) or NumPy (.npy)",
    "sha256": "of the file: where it is given, another content is complained about",
}

TABLE = {
    "points": "[argument, value], two or more, arguments increasing",
    "file": "in place of points: a file of rows (CSV) beside the description, or in a folder below",
    "columns": "[argument, value]: the two columns of the file, by name or by number from 1 on; [1, 2] when left out",
    "sha256": "of the file: where it is given, another content is complained about",
    "between": "linear, or cubic: the natural spline through the points",
    "outside": "hold: the first or the last value; zero; extrapolate: as the end pieces go on; error: a run ends there",
    "unit": "the unit of its values, such as N*m",
}

BODY = {
    "name": "what the body is called, here and in reports",
    "attached to": "the name of an earlier body, or 0 for the inertial frame; the first body may leave it out",
    "rotation": "the turns that lead from the axes of the previous body to the axes of this one",
    "connection point": "radius vector of O_k in the axes of the previous body; [0, 0, 0] when left out",
    "relative velocity": "derivative of that radius vector; derived when left out, checked when given",
    "mass centre": "radius vector of the mass centre from O_k in the axes of this body; [0, 0, 0] when left out",
    "mass": "required; 0 for a massless frame",
    "inertia about": "joint (the connection point O_k) or mass centre; required with an inertia",
    "inertia": "three principal moments, or three rows of the tensor J of T = w.J w/2 (J13 = -integral of x z dm); or "
    "{tensor, accept: true} for identified values that no body has",
    "gyrostatic moment": "constant angular momentum of rotors inside the body, in its axes: adds h.omega to T",
    "coordinates": "the coordinates that this joint introduces; when left out, the undeclared names used as angles",
    "shapes": "what the body looks like, for drawing: [{box: [a, b, c], at: [0, 0, 0]}, ...]",
    "speeds": "velocities of one's own, linear in generalised velocities: {u: x_dot*cos(phi) + y_dot*sin(phi)}; "
    "omega1, omega2, omega3 are the components of the angular velocity of this body in its own axes: {p: omega1}",
    "orientation": "angles, or unit vectors in the axes of the body along axes of the frame it hangs on: {gamma: 3}, "
    "or direction cosines: {alpha: 1, beta: 2, gamma: 3}; their components are gamma1, gamma2, gamma3; "
    "or a quaternion: {e: quaternion}, e0 its scalar part, e1, e2, e3",
}

#: What a shape holds beside its kind, and the kinds.
SHAPE_PLACE = {
    "at": "its middle, in the axes of the body; [0, 0, 0] when left out",
    "rotation": "the turns that lead from the axes of the body to its own",
}
SHAPE = {
    "box": "three edges",
    "sphere": "the radius",
    "cylinder": "radius, and length along its third axis",
    "capsule": "radius, and length of its straight part along the third axis",
    "ellipsoid": "three half axes",
    **SHAPE_PLACE,
}

INERTIA = {
    "tensor": "three principal moments, or three rows",
    "accept": "true: taken as given although the triangle inequality of its principal moments does not hold",
}

ROTATION = {
    "axes": "numbers of the rotation axes, one to three of 1, 2, 3 in the order of turning; 0 means no rotation",
    "angles": "the angle about each axis",
}

POINT = {
    "body": "the name of a body, or 0 for the inertial frame",
    "point": "radius vector in the axes of that body, from its connection point",
}

LOADS: dict[str, dict[str, str]] = {
    "newtonian gravity": {
        "constant": "gravitational parameter nu of the attracting centre",
        "centre": "the frame whose origin attracts, mostly 0",
        "about": "the frame that carries the attracted bodies; the field is expanded about its origin, on the orbit",
        "order": "2, 3 or 4: order of the expansion (2 when left out); exact: the exact distance of every mass centre",
    },
    "uniform gravity": {
        "vector": "the acceleration in inertial axes, such as [0, -g, 0]",
        "acceleration": "its size, with direction",
        "direction": "a unit vector in inertial axes, with acceleration",
    },
    "spring": {
        "coordinate": "the coordinate that it acts on (linear or torsional)",
        "rest": "the value of the coordinate without force; 0 when left out",
        "between": "instead of a coordinate: two points {body, point}",
        "length": "length without force, between two points",
        "stiffness": "force per displacement",
    },
    "damper": {
        "coordinate": "the coordinate that it acts on",
        "between": "instead of a coordinate: two points {body, point}",
        "coefficient": "force per velocity",
    },
    "isotropic damper": {
        "between": "two points {body, point}",
        "coefficient": "force per relative velocity",
    },
    "rayleigh": {},
    "force function": {},
    "potential": {},
    "generalized force": {},
    "force": {
        "body": "the body that it acts on",
        "point": "where: radius vector in the axes of the body",
        "components": "three components",
        "axes": "in whose axes the components are: a body (the body itself: a follower force) or 0",
    },
    "torque": {
        "body": "the body that it acts on",
        "components": "three components",
        "axes": "in whose axes the components are: a body or 0",
        "reaction on": "the body that feels the opposite torque",
    },
}

#: What the kinds of load that hold an expression, or free keys, mean; the others are described by their keys.
LOAD_MEANINGS = {
    "newtonian gravity": "Newtonian field of a centre: expanded about a point of the orbit, or exact",
    "uniform gravity": "the same acceleration everywhere",
    "spring": "on a coordinate or between two points",
    "damper": "viscous, on a coordinate or along the line between two points: R = coefficient rate^2/2, with the rate "
    "of the coordinate or of the distance (which must not be zero, unless the points stay on one axis)",
    "isotropic damper": "viscous, against all relative motion of two points: R = coefficient |V_1 - V_2|^2 / 2; not "
    "along the line, so that it makes a couple",
    "rayleigh": "a dissipation function R(q, q'); its generalised forces are -dR/dq'",
    "force function": "a force function U = -potential, added to the Lagrangian",
    "potential": "a potential energy V, subtracted from the Lagrangian",
    "generalized force": "{coordinate: expression in coordinates, velocities, parameters and t}",
    "force": "a force on a point of a body",
    "torque": "a torque on a body",
}

AXIS = {
    "body": "the name of a body, or 0 for the inertial frame",
    "axis": "a direction that is fixed in that body, in its axes, of any length: [0, 0, 1]",
}

CONSTRAINTS: dict[str, dict[str, str]] = {
    "coincide": {},
    "parallel": {},
    "distance": {
        "between": "two points {body, point}",
        "length": "the distance that they keep, constant or a function of t",
    },
    "relation": {},
    "rolling": {
        "body": "the body that rolls",
        "point": "the contact: radius vector from the connection point of the body; may hold coordinates",
        "axes": "in whose axes the contact is given: a body or 0; the body itself when left out",
        "on": "the body that it rolls on; 0 or ground for the inertial frame",
    },
    "velocity": {},
}

#: What the kinds of constraint mean.
CONSTRAINT_MEANINGS = {
    "coincide": "two points {body, point} that are one: a cut joint, planar or spatial",
    "parallel": "two axes {body, axis} that stay parallel; with 'coincide' they make a hinge",
    "distance": "two points that keep their distance: a rod without mass",
    "relation": "an equation between coordinates (and t): x - r*phi = 0",
    "rolling": "the material points of two bodies at their contact have the same velocity",
    "velocity": "an equation that is linear in velocities: x_dot*sin(theta) - y_dot*cos(theta) = 0",
}

MOTION = {
    "value": "value of the coordinate at t = 0",
    "rate": "its constant rate; 0 when left out",
}

INITIAL = {
    "position": "value of the coordinate",
    "velocity": "value of its derivative",
}

CLAIM = {
    "claim": "what is claimed: kinetic energy, coefficient, mass matrix, first integral, ...",
    "of": "the coordinate, body, quantity or (for a value) expression that it is about",
    "entry": "row and column, numbers from 1 or coordinates: [theta, delta]",
    "component": "number of an axis, 1 to 3",
    "at": "the product of velocities whose coefficient is claimed: x_dot*phi_dot (1/2*c*x_dot**2 has c/2 at x_dot**2)",
    "variable": "the symbol of the characteristic polynomial",
    "order": "of an expansion: the power of the small parameter whose coefficient is claimed",
    "that": "the inequality that is claimed, for a condition",
    "as": "of a condition: necessary, or sufficient (those of one place together); either when left out",
    "equals": "the formula or number as it was printed",
    "tolerance": "of a number at a state: how far it may be off, instead of half a unit of its last place",
    "digits": "the same: how many digits of a number count, from the first that is not zero",
    "state": "'initial' or {name: number}: the claim is about numbers at this state, to the digits printed",
    "place": "where it was printed: eq. (3)",
}

#: Other spellings of keys.
ALIASES = {
    "mass center": "mass centre",
    "center": "centre",
    "generalised force": "generalized force",
    "inertia at": "inertia about",
    "gyrostatic momentum": "gyrostatic moment",
    "dimensionless_time": "dimensionless time",
}

#: What other programs have and this one has not: no slip of the pen for something else.
_LOOPS = "loops are closed under 'constraints': - coincide: [{body: A, point: [0, 0, 0]}, {body: B, point: [0, 0, 0]}]"
_LISTS = "all constraints are one list, 'constraints': coincide, parallel, distance, relation, rolling, velocity"
_JOINTS = "a joint is described in its body: 'attached to', 'rotation', 'connection point', 'coordinates'"
UNSUPPORTED = {
    **dict.fromkeys(("constraint", "holonomic constraints", "nonholonomic constraints"), _LISTS),
    **dict.fromkeys(("loop", "loops", "closed loop", "closed loops", "loop closure", "loop closures"), _LOOPS),
    **dict.fromkeys(("kinematic loop", "kinematic loops", "cut joint", "cut joints", "closure"), _LOOPS),
    **dict.fromkeys(("joint", "joints"), f"{_JOINTS}; {_LOOPS}"),
}
