"""Every key of a description, what it means and what its value may be: the one table that all who know keys go by."""

from __future__ import annotations

from typing import Any

from mbsym.expressions.message import Message
from mbsym.expressions.place import Span
from mbsym.expressions.table import CUBIC, ENDS, EXTRAPOLATE, HOLD, LINEAR, OUTSIDE_ZERO
from mbsym.expressions.tree import ZERO, Expression, multiply
from mbsym.model.basics import Point, Vector
from mbsym.model.claims import CLAIMS, INITIAL_STATE, MOST_ORDER, NECESSARY, SUFFICIENT
from mbsym.model.constraints import Axis, Coincide, Distance, Parallel, Relation, Rolling, Velocity
from mbsym.model.loads import (
    GRAVITY_ORDERS,
    CoordinateDamper,
    CoordinateSpring,
    ForceFunction,
    GeneralizedForce,
    IsotropicDamper,
    NewtonianGravity,
    PointDamper,
    PointForce,
    PointSpring,
    Rayleigh,
    Torque,
    UniformGravity,
)
from mbsym.model.speeds import QUATERNION
from mbsym.model.system import LANGUAGES, ONE_OF_LANGUAGES, SHAPES
from mbsym.source.grammar import (
    About,
    BodyName,
    Either,
    Ends,
    Equation,
    Figure,
    Flag,
    Formula,
    Index,
    Integer,
    Key,
    Kind,
    Kinds,
    Listed,
    Name,
    Named,
    Nothing,
    Record,
    Same,
    String,
    Text,
    Type,
    Unit,
    Way,
    Word,
)
from mbsym.source.grammar import Vector as ThreeOf
from mbsym.source.scope import DISSIPATION, FORCE, POTENTIAL, Allowed

VERSION = "1"

SIGNS = ("real", "positive", "nonnegative", "negative", "nonpositive", "nonzero")

#: What a joint turns by.
ANGLES, COSINES = "angles", "direction cosines"

#: Where a body's tensor of inertia may be about.
JOINT, MASS_CENTRE = "joint", "mass centre"

#: A linear system has at most so many coordinates, a table so many points (one from a file
#: ``tables.MOST_POINTS``), a symbol so many characters.
MOST_COORDINATES, MAX_POINTS, LONGEST = 30, 500, 80

#: A small parameter stands in at most this power.
MOST_POWER = 6

# --- values that stand in several places ------------------------------------------------------------------------------

_FORMULA, _TEXT, _UNIT, _BODY, _NAME = Formula(), Text(), Unit(), BodyName(), Name()
_COORDINATE = Name("coordinate")
_NAMES = Listed(_NAME, unique=True)
_VECTOR = ThreeOf()
_ROWS = Listed(Listed(_FORMULA, 1, MOST_COORDINATES), 1, MOST_COORDINATES)
_MEANING = Key("what it is, for reports", _TEXT)
_DIGEST = Key("of the file: where it is given, another content is complained about", String())

# --- parameters and functions of time ---------------------------------------------------------------------------------

PARAMETER = {
    "sign": Key(
        f"one of {', '.join(SIGNS)} (or positive: true); when left out, the sign of the value, or real without one",
        Word(SIGNS),
    ),
    "value": Key("a numerical value, used where numbers are wanted"),
    "meaning": _MEANING,
    "unit": Key("its unit, such as kg*m^2; every formula is then checked for its dimension", _UNIT),
}

#: A sign may also be written as ``positive: true``.
SIGN_WORDS = {sign: Key(f"true, short for sign: {sign}", Flag()) for sign in SIGNS}

PRESCRIBED = {
    "rate": Key("its constant rate of change", required=True),
    "initial": Key("its value at t = 0 (0 when left out)"),
    "meaning": _MEANING,
    "unit": Key("its unit, such as rad or m", _UNIT),
}

GIVEN = {
    "of": Key("t: what it is a function of; goes without saying", Word(("t",))),
    "value": Key("its law, such as A*sin(w*t), used where numbers are wanted"),
    "meaning": _MEANING,
    "unit": Key("its unit, such as rad or m", _UNIT),
}

INPUT = {
    "meaning": _MEANING,
    "unit": Key("its unit, such as N*m or N", _UNIT),
}

SMALL_PARAMETER = {
    "powers": Key(
        "{e: 1, p2: -1}: in place of e and p2 stand e*eps and p2/eps, with a name eps of its own "
        "(variables may be small, too, for oscillations); when left out, "
        "the small parameter is one of the parameters",
        Named(Integer(-MOST_POWER, MOST_POWER)),
    ),
    "fast": Key("the variables that a slow manifold expresses by the others: [x, y]; found when left out", _NAMES),
    "slow": Key("variables that are not among the fast ones: [p, q]", _NAMES),
    "leading": Key("the variable whose oscillation 'mbsym oscillations' follows; found when there is only one", Name()),
}

# --- files and tables -------------------------------------------------------------------------------------------------

MATRIX_FILE = {
    "file": Key(
        "a file beside the description, or in a folder below: MatrixMarket (.mtx) or NumPy (.npy)",
        String(),
        required=True,
    ),
    "sha256": _DIGEST,
}

_MATRIX = Either((_ROWS, Record(MATRIX_FILE, "A matrix in a file", alone="file")))

LINEAR_SYSTEM = {
    "coordinates": Key(
        "names of the coordinates x, in the order of rows and columns", Listed(_NAME, 1, unique=True), required=True
    ),
    "M": Key(
        "mass matrix, symmetric and positive definite: a list of rows of formulas in parameters, or {file: M.mtx}; "
        "the unit matrix when left out",
        _MATRIX,
    ),
    "D": Key("damping, symmetric; zero when left out, as the others", _MATRIX),
    "G": Key("gyroscopic matrix, skew", _MATRIX),
    "C": Key("in place of D and G: their sum, any square matrix", _MATRIX),
    "K": Key("stiffness, symmetric", _MATRIX),
    "N": Key("circulatory matrix, skew", _MATRIX),
    "S": Key("in place of K and N: their sum, any square matrix", _MATRIX),
    "A": Key("in place of all these: x' = A x, any square matrix", _MATRIX),
    "B": Key("where the inputs act: a row for each coordinate, a column for each of 'inputs'", _MATRIX),
}

TABLE = {
    "points": Key(
        "[argument, value], two or more, arguments increasing", Listed(Listed(Figure(), 2, 2), 2, MAX_POINTS)
    ),
    "file": Key("in place of points: a file of rows (CSV) beside the description, or in a folder below", String()),
    "columns": Key(
        "[argument, value]: the two columns of the file, by name or by number from 1 on; [1, 2] when left out",
        Listed(_UNIT, 2, 2),
    ),
    "sha256": _DIGEST,
    "between": Key("linear, or cubic: the natural spline through the points", Word((LINEAR, CUBIC))),
    "outside": Key(
        "hold: the first or the last value; zero; extrapolate: as the end pieces go on; error: a run ends there",
        Word((HOLD, OUTSIDE_ZERO, EXTRAPOLATE, ENDS)),
    ),
    "unit": Key("the unit of its values, such as N*m", _UNIT),
}

# --- bodies -----------------------------------------------------------------------------------------------------------

ROTATION = {
    "axes": Key(
        "numbers of the rotation axes, one to three of 1, 2, 3 in the order of turning; 0 means no rotation",
        Listed(Word((0, 1, 2, 3)), most=3),
        required=True,
        label="numbers of rotation axes",
    ),
    "angles": Key("the angle about each axis", Listed(_FORMULA, most=3), required=True, label="rotation angles"),
}
_ROTATION = Record(ROTATION, "Its rotation")

_TENSOR: tuple[Type, ...] = (_VECTOR, Listed(_VECTOR, 3, 3))

INERTIA = {
    "tensor": Key("three principal moments, or three rows", Either(_TENSOR), required=True, label="tensor of inertia"),
    "accept": Key(
        "true: taken as given although no body has it: the triangle inequality of its principal moments does not hold, "
        "or about a fixed point they are smaller than those of the mass in its centre",
        Flag(false=True),
        label="accept tensor of inertia",
    ),
}

#: What a shape holds beside its kind, and the kinds.
SHAPE_PLACE = {
    "at": Key("its middle, in the axes of the body; [0, 0, 0] when left out", _VECTOR),
    "rotation": Key("the turns that lead from the axes of the body to its own", _ROTATION),
}
_SIZES = {
    "box": "three edges",
    "sphere": "the radius",
    "cylinder": "radius, and length along its third axis",
    "capsule": "radius, and length of its straight part along the third axis",
    "ellipsoid": "three half axes",
}
SHAPE = {
    **{
        kind: Key(sizes, _FORMULA if SHAPES[kind] == 1 else Listed(_FORMULA, SHAPES[kind], SHAPES[kind]))
        for kind, sizes in _SIZES.items()
    },
    **SHAPE_PLACE,
}

BODY = {
    "name": Key("what the body is called, here and in reports", BodyName(new=True), required=True),
    "attached to": Key(
        "the name of an earlier body, or 0 for the inertial frame; the first body may leave it out",
        _BODY,
        label="previous body number",
    ),
    "rotation": Key("the turns that lead from the axes of the previous body to the axes of this one", _ROTATION),
    "connection point": Key(
        "radius vector of O_k in the axes of the previous body; [0, 0, 0] when left out",
        _VECTOR,
        label="radius vector of connection point",
    ),
    "relative velocity": Key(
        "derivative of that radius vector; derived when left out, checked when given",
        _VECTOR,
        label="vector of relative linear velocity",
    ),
    "mass centre": Key(
        "radius vector of the mass centre from O_k in the axes of this body; [0, 0, 0] when left out",
        _VECTOR,
        label="radius vector of mass center",
    ),
    "mass": Key("required; 0 for a massless frame", required=True, label="body mass"),
    "inertia about": Key(
        "joint (the connection point O_k) or mass centre; required with an inertia", Word((JOINT, MASS_CENTRE))
    ),
    "inertia": Key(
        "three principal moments, or three rows of the tensor J of T = w.J w/2 (J13 = -integral of x z dm); or "
        "{tensor, accept: true} for identified values that no body has",
        Either((*_TENSOR, Record(INERTIA, "Its inertia, where identified values are to be taken as given"))),
        label="tensor of inertia",
    ),
    "gyrostatic moment": Key(
        "constant angular momentum of rotors inside the body, in its axes: adds h.omega to T", _VECTOR
    ),
    "coordinates": Key(
        "the coordinates that this joint introduces; when left out, the undeclared names used as angles",
        Listed(_COORDINATE),
        label="generalized coordinates",
    ),
    "shapes": Key(
        "what the body looks like, for drawing: [{box: [a, b, c], at: [0, 0, 0]}, ...]",
        Listed(Record(SHAPE, "One of its shapes: a kind and its sizes, and where it is")),
        label="shape",
    ),
    "speeds": Key(
        "velocities of one's own, linear in generalised velocities: {u: x_dot*cos(phi) + y_dot*sin(phi)}; "
        "omega1, omega2, omega3 are the components of the angular velocity of this body in its own axes: {p: omega1}",
        Named(_FORMULA),
    ),
    "orientation": Key(
        "angles, or unit vectors in the axes of the body along axes of the frame it hangs on: {gamma: 3}, "
        "or direction cosines: {alpha: 1, beta: 2, gamma: 3}; their components are gamma1, gamma2, gamma3; "
        "or a quaternion: {e: quaternion}, e0 its scalar part, e1, e2, e3",
        Either((Word((ANGLES, COSINES, QUATERNION)), Named(Word((1, 2, 3, QUATERNION))))),
    ),
}

# --- loads ------------------------------------------------------------------------------------------------------------

POINT = {
    "body": Key("the name of a body, or 0 for the inertial frame", _BODY, required=True),
    "point": Key(
        "radius vector in the axes of that body, from its connection point",
        ThreeOf(Allowed("a point of a body")),
        required=True,
    ),
}
_POINTS = Ends(Record(POINT, "A point of a body", "point", made=Point))

_BETWEEN = Key("two points {body, point}", _POINTS, required=True)
_OF_TWO = Key("instead of a coordinate: two points {body, point}", _POINTS, required=True)
_DAMPING = Formula(Allowed("a damping coefficient"))


def _along(size: Expression, direction: Vector, span: Span) -> UniformGravity:
    return UniformGravity(
        (multiply(size, direction[0]), multiply(size, direction[1]), multiply(size, direction[2])), span
    )


def _at_point(body: str, point: Vector, components: Vector, axes: str, span: Span) -> PointForce:
    return PointForce(Point(body, point), components, axes, span)


def _of_force(load: Any) -> tuple[Any, ...]:
    return load.point.body, load.point.position, load.components, load.axes


LOADS: dict[str, Kind] = {
    "uniform gravity": Kind(
        "the same acceleration everywhere",
        Record(
            {
                "vector": Key(
                    "the acceleration in inertial axes, such as [0, -g, 0]",
                    ThreeOf(Allowed("an acceleration")),
                    required=True,
                ),
                "acceleration": Key("its size, with direction", Formula(Allowed("an acceleration")), required=True),
                "direction": Key(
                    "a unit vector in inertial axes, with acceleration", ThreeOf(Allowed("a direction")), required=True
                ),
            }
        ),
        ways=(
            Way(UniformGravity, ("acceleration", "direction"), "size and direction", make=_along),
            Way(UniformGravity, ("vector",), "as a vector"),
        ),
    ),
    "spring": Kind(
        "on a coordinate or between two points",
        Record(
            {
                "coordinate": Key("the coordinate that it acts on (linear or torsional)", _COORDINATE, required=True),
                "rest": Key(
                    "the value of the coordinate without force; 0 when left out",
                    Formula(Allowed("a rest position")),
                    default=ZERO,
                ),
                "between": _OF_TWO,
                "length": Key("length without force, between two points", Formula(Allowed("a length")), required=True),
                "stiffness": Key("force per displacement", Formula(Allowed("a stiffness")), required=True),
            }
        ),
        ways=(
            Way(CoordinateSpring, ("coordinate", "stiffness", "rest"), "on a coordinate"),
            Way(PointSpring, ("between", "stiffness", "length"), "between points"),
        ),
    ),
    "damper": Kind(
        "viscous, on a coordinate or along the line between two points: R = coefficient rate^2/2, with the rate "
        "of the coordinate or of the distance (which must not be zero, unless the points stay on one axis)",
        Record(
            {
                "coordinate": Key("the coordinate that it acts on", _COORDINATE, required=True),
                "between": _OF_TWO,
                "coefficient": Key("force per velocity", _DAMPING, required=True),
            }
        ),
        ways=(
            Way(CoordinateDamper, ("coordinate", "coefficient"), "on a coordinate"),
            Way(PointDamper, ("between", "coefficient"), "between points"),
        ),
    ),
    "force": Kind(
        "a force on a point of a body",
        Record(
            {
                "body": Key("the body that it acts on", BodyName(moving=True), required=True),
                "point": Key(
                    "where: radius vector in the axes of the body", ThreeOf(Allowed("a point of a body")), required=True
                ),
                "components": Key("three components", ThreeOf(FORCE), required=True),
                "axes": Key(
                    "in whose axes the components are: a body (the body itself: a follower force) or 0",
                    _BODY,
                    required=True,
                ),
            }
        ),
        ways=(Way(PointForce, ("body", "point", "components", "axes"), make=_at_point, parts=_of_force),),
    ),
    "torque": Kind(
        "a torque on a body",
        Record(
            {
                "body": Key("the body that it acts on", BodyName(moving=True), required=True),
                "components": Key("three components", ThreeOf(FORCE), required=True),
                "axes": Key("in whose axes the components are: a body or 0", _BODY, required=True),
                "reaction on": Key("the body that feels the opposite torque", _BODY),
            }
        ),
        ways=(Way(Torque, ("body", "components", "axes", "reaction on")),),
    ),
    "generalized force": Kind(
        "{coordinate: expression in coordinates, velocities or speeds, parameters and t}",
        Named(Formula(FORCE), "coordinate"),
        ways=(Way(GeneralizedForce),),
    ),
    "force function": Kind(
        "a force function U = -potential, added to the Lagrangian",
        Formula(POTENTIAL),
        ways=(Way(ForceFunction, fixed=(("spelled", "force function"),)),),
    ),
    "potential": Kind(
        "a potential energy V, subtracted from the Lagrangian",
        Formula(POTENTIAL),
        ways=(Way(ForceFunction, fixed=(("spelled", "potential"),)),),
    ),
    "isotropic damper": Kind(
        "viscous, against all relative motion of two points: R = coefficient |V_1 - V_2|^2 / 2; not "
        "along the line, so that it makes a couple",
        Record({"between": _BETWEEN, "coefficient": Key("force per relative velocity", _DAMPING, required=True)}),
        ways=(Way(IsotropicDamper, ("between", "coefficient")),),
    ),
    "rayleigh": Kind(
        "a dissipation function R(q, q'), or of speeds; its generalised forces are -dR/dq'",
        Formula(DISSIPATION),
        ways=(Way(Rayleigh),),
    ),
    "newtonian gravity": Kind(
        "Newtonian field of a centre: expanded about a point of the orbit, or exact",
        Record(
            {
                "constant": Key(
                    "gravitational parameter nu of the attracting centre",
                    Formula(Allowed("a gravitational constant")),
                    required=True,
                ),
                "centre": Key("the frame whose origin attracts, mostly 0", _BODY, required=True),
                "about": Key(
                    "the frame that carries the attracted bodies; the field is expanded about its origin, on the orbit",
                    _BODY,
                    required=True,
                ),
                "order": Key(
                    "2, 3 or 4: order of the expansion (2 when left out); exact: the exact distance of every mass "
                    "centre",
                    Word(GRAVITY_ORDERS),
                    default=GRAVITY_ORDERS[0],
                ),
            }
        ),
        ways=(Way(NewtonianGravity, ("constant", "centre", "about", "order")),),
    ),
}

# --- constraints ------------------------------------------------------------------------------------------------------

_ON = BodyName(ground=True)

AXIS = {
    "body": Key("the name of a body, or 0 for the inertial frame", _BODY, required=True),
    "axis": Key(
        "a direction that is fixed in that body, in its axes, of any length: [0, 0, 1]",
        ThreeOf(Allowed("an axis of a body"), direction=True),
        required=True,
    ),
}

#: What tells where bodies are.
_PLACED = ("coordinate", "unit vector", "prescribed", "parameter", "time")

CONSTRAINTS: dict[str, Kind] = {
    "coincide": Kind(
        "two points {body, point} that are one: a cut joint, planar or spatial", _POINTS, ways=(Way(Coincide),)
    ),
    "parallel": Kind(
        "two axes {body, axis} that stay parallel; with 'coincide' they make a hinge",
        Ends(Record(AXIS, "An axis of a body", "axis", made=Axis)),
        ways=(Way(Parallel),),
    ),
    "distance": Kind(
        "two points that keep their distance: a rod without mass",
        Record(
            {
                "between": _BETWEEN,
                "length": Key(
                    "the distance that they keep, constant or a function of t",
                    Formula(Allowed("a distance that is kept", ("prescribed", "parameter", "time"))),
                    required=True,
                ),
            }
        ),
        ways=(Way(Distance, ("between", "length")),),
    ),
    "relation": Kind(
        "an equation between coordinates (and t): x - r*phi = 0",
        Equation(
            Allowed("a relation between coordinates", _PLACED),
            "x - r*phi = 0",
        ),
        ways=(Way(Relation, parts=lambda made: (made.left, made.right)),),
    ),
    "rolling": Kind(
        "the material points of two bodies at their contact have the same velocity",
        Record(
            {
                "body": Key("the body that rolls", _ON, required=True),
                "point": Key(
                    "the contact: radius vector from the connection point of the body; may hold coordinates and "
                    "components of unit vectors",
                    ThreeOf(Allowed("a point of contact", _PLACED)),
                    required=True,
                ),
                "axes": Key(
                    "in whose axes the contact is given: a body or 0; the body itself when left out",
                    _ON,
                    default=Same("body"),
                ),
                "on": Key("the body that it rolls on; 0 or ground for the inertial frame", _ON, required=True),
            }
        ),
        ways=(
            Way(
                Rolling,
                ("body", "point", "axes", "on"),
                parts=lambda made: (made.body, made.contact, made.axes, made.on),
            ),
        ),
    ),
    "velocity": Kind(
        "an equation that is linear in velocities: x_dot*sin(theta) - y_dot*cos(theta) = 0",
        Equation(
            Allowed("a relation between velocities", ("velocity", "speed", *_PLACED)),
            "x_dot*sin(theta) - y_dot*cos(theta) = 0",
        ),
        ways=(Way(Velocity, parts=lambda made: (made.left, made.right)),),
    ),
}

# --- states and claims ------------------------------------------------------------------------------------------------

MOTION = {
    "value": Key("value of the coordinate at t = 0"),
    "rate": Key("its constant rate; 0 when left out"),
}

INITIAL = {
    "position": Key("value of the coordinate"),
    "velocity": Key("value of its derivative"),
}

CLAIM = {
    "claim": Key(
        "what is claimed: kinetic energy, coefficient, mass matrix, first integral, ...",
        Word(tuple(CLAIMS)),
        required=True,
    ),
    "of": Key("the coordinate, body, quantity or (for a value) expression that it is about", About()),
    "entry": Key("row and column, numbers from 1 or coordinates: [theta, delta]", Listed(Index(), 2, 2)),
    "component": Key("number of an axis, 1 to 3", Word((1, 2, 3))),
    "at": Key(
        "the product of velocities whose coefficient is claimed: x_dot*phi_dot (1/2*c*x_dot**2 has c/2 at x_dot**2)"
    ),
    "variable": Key("the symbol of the characteristic polynomial", Name(own=True)),
    "order": Key(
        "of an expansion: the power of the small parameter whose coefficient is claimed", Integer(0, MOST_ORDER)
    ),
    "that": Key("the inequality that is claimed, for a condition", Equation()),
    "as": Key(
        "of a condition: necessary, or sufficient (those of one place together); either when left out",
        Word((NECESSARY, SUFFICIENT)),
    ),
    "equals": Key("the formula or number as it was printed"),
    "tolerance": Key(
        "of a number at a state: how far it may be off, instead of half a unit of its last place", Figure()
    ),
    "digits": Key("the same: how many digits of a number count, from the first that is not zero", Integer(1)),
    "state": Key(
        "'initial' or {name: number}: the claim is about numbers at this state, to the digits printed",
        Either((Word((INITIAL_STATE,)), Named(_FORMULA))),
    ),
    "place": Key("where it was printed: eq. (3)", _TEXT),
}

# --- the whole --------------------------------------------------------------------------------------------------------

SYSTEM = {
    "mbsym": Key("version of this format: 1", Word((int(VERSION),)), required=True),
    "name": Key("what the system is called in reports", _TEXT, required=True, label="mechanical system"),
    "description": Key("a sentence or two about it", _TEXT),
    "parameters": Key(
        "constants: names with a sign word, a number, or {sign, value, meaning}; or a plain list of names",
        Either(
            (
                Named(
                    Either(
                        (Word(SIGNS), _FORMULA, Record({**PARAMETER, **SIGN_WORDS}, "A parameter", alone="sign")),
                        "parameter",
                    ),
                ),
                _NAMES,
            )
        ),
    ),
    "prescribed": Key(
        "known functions of time with a constant rate: {name: {rate, initial, meaning}} or {name: rate}; "
        "formulas in t may stand in joints, too",
        Named(Either((_FORMULA, Record(PRESCRIBED, "A prescribed quantity", alone="rate")))),
        label="prescribed motions",
    ),
    "given": Key(
        "free functions of time: {a: {of: t}}; a, a_dot and a_ddot stay symbols, in joints as in loads",
        Named(Record(GIVEN, "A free function of time", alone="of")),
        label="given functions of time",
    ),
    "inputs": Key(
        "known functions of time that are chosen later, for forces and torques: {u: {meaning, unit}}",
        Either((Named(Either((_TEXT, Nothing(), Record(INPUT, "An input", alone="meaning")))), _NAMES)),
    ),
    "outputs": Key("what is measured: {y: theta}, in coordinates, velocities, parameters and inputs", Named(_FORMULA)),
    "tables": Key(
        "inputs given by points: {torque: {points: [[0, 0], [1, 2.5]]}}, in loads torque(t) or torque(theta)",
        Named(Record(TABLE, "A table", alone="points", one_of=("points", "file"))),
    ),
    "bodies": Key(
        "the bodies and massless frames, each attached to the inertial frame 0 or to an earlier one",
        Listed(Record(BODY, "A body", "body"), 1),
    ),
    "linear system": Key(
        "in place of bodies and loads: the matrices of M x'' + (D + G) x' + (K + N) x = B u",
        Record(LINEAR_SYSTEM, "A linear system"),
    ),
    "loads": Key("gravity, springs, dampers, forces: a list of {kind of load: {...}}", Listed(Kinds(LOADS, "load"))),
    "constraints": Key(
        "what ties bodies or coordinates besides the joints: a list of {kind of constraint: {...}}",
        Listed(Kinds(CONSTRAINTS, "constraint")),
    ),
    "dependent": Key(
        "coordinates or speeds that constraints express by the others: [q2, q3]; what is left out is found", _NAMES
    ),
    "reactions": Key("bodies whose joints' forces and moments are wanted: [hinge]", Listed(_BODY, unique=True)),
    "relations": Key(
        "parameters that are functions of others, used from problem 4 on: {nu: omega0**2*R**3}", Named(_FORMULA)
    ),
    "assumptions": Key("inequalities between parameters and notation, such as alpha > -1", Listed(Equation())),
    "motion": Key(
        "the unperturbed motion: {coordinate: value} or {coordinate: {value, rate}}; others are 0 at rest, {} is "
        "the rest of all at 0",
        Named(
            Either((_FORMULA, Record(MOTION, "The unperturbed motion of a coordinate", alone="value"))), "coordinate"
        ),
        label="unperturbed motion",
    ),
    "notation": Key("own symbols for groups of parameters, in order: later ones may use earlier ones", Named(_FORMULA)),
    "dimensionless time": Key("a rate w; problems 5 and 6 then use the time tau = w*t"),
    "small parameter": Key(
        "a parameter in whose powers 'mbsym expand' expands, or {eps: {powers: {e: 1, p2: -1}}}: "
        "e eps and p2/eps stand for e and p2",
        Either((_NAME, Named(Record(SMALL_PARAMETER, "A small parameter"), one=True))),
    ),
    "values": Key("numerical values of parameters: {l: 2}", Named(_FORMULA)),
    "initial": Key(
        "the initial state: {coordinate: position} or {coordinate: {position, velocity}} (velocity 0); "
        "declared variables have values, {p: 0.1, e0: 1}",
        Named(Either((_FORMULA, Record(INITIAL, "The initial state of a coordinate", alone="position"))), "coordinate"),
        label="initial state",
    ),
    "abbreviations": Key(
        "an author's own symbols for claims and results, in order: {c1: mA + mB, ...}", Named(_FORMULA)
    ),
    "source": Key("where the system is from: a publication, for the references of reports", _TEXT),
    "label": Key("what labels in LaTeX have of this system in them, in place of its name: mbsym:LABEL:eq:M", _TEXT),
    "latex": Key(
        "how names are written in LaTeX: {d_Ccm1: 'd_{C1}', phi: '\\phi'}: letters, accents, fonts and an index",
        Named(String(LONGEST)),
        label="latex symbols",
    ),
    "order": Key("in which order subsystems and their coordinates are told, in problems 5 and 6: [theta, psi]", _NAMES),
    "language": Key(f"of the reports: {ONE_OF_LANGUAGES}", Word(tuple(LANGUAGES))),
    "units": Key(
        "units of coordinates, parameters, prescribed motions: {x: m, theta: rad}; every formula is then checked",
        Named(_UNIT, "coordinate"),
    ),
    "limits": Key(
        "least and greatest values of coordinates, for drawing: {q1: [-pi, pi]}; no force keeps them",
        Named(Listed(_FORMULA, 2, 2), "coordinate"),
    ),
    "claims": Key(
        "formulas and numbers that were printed, to be checked: [{claim: kinetic energy, equals: ...}, ...]",
        Listed(Record(CLAIM, called="claim")),
    ),
}

#: A whole description: bodies with loads, or matrices.
DESCRIPTION = Record(SYSTEM, "A description", one_of=("bodies", "linear system"))

#: Other spellings of keys, and of words.
ALIASES = {
    "mass center": "mass centre",
    "center of mass": "mass centre",
    "centre of mass": "mass centre",
    "center": "centre",
    "generalised force": "generalized force",
    "inertia at": "inertia about",
    "gyrostatic momentum": "gyrostatic moment",
    "dimensionless_time": "dimensionless time",
}


def spellings(key: str) -> list[str]:
    """The other spellings of a key or word."""
    return [other for other, canonical in ALIASES.items() if canonical == key]


#: Keys as others call them: complained about, and read as what is meant where that can stand.
MEANT: dict[str, str] = {
    **dict.fromkeys(("translation", "position", "offset", "displacement", "location", "origin"), "connection point"),
    **dict.fromkeys(("parent", "parent body", "previous body", "connected to"), "attached to"),
    **dict.fromkeys(("com", "cog", "centre of gravity", "center of gravity"), "mass centre"),
    **dict.fromkeys(("moment of inertia", "moments of inertia", "inertia tensor"), "inertia"),
    **dict.fromkeys(("initial conditions", "initial state", "initial values", "states"), "initial"),
    **dict.fromkeys(("equilibrium", "operating point", "unperturbed motion"), "motion"),
    "title": "name",
}

#: What other programs write, and what is written here: no slip of the pen for something else.
_LOOPS = Message(
    "loops are closed under 'constraints': - coincide: [{body: A, point: [0, 0, 0]}, {body: B, point: [0, 0, 0]}]"
)
_LISTS = Message(
    "all constraints are one list, 'constraints': coincide, parallel, distance, relation, rolling, velocity"
)
_JOINTS = Message(
    "a joint is described in its body: rotation: {axes: [3], angles: [theta]} for a hinge, 'connection point', "
    "'coordinates'; [[loops]]",
    loops=_LOOPS,
)
_LOADS = Message(
    "forces and torques are one list, 'loads': - force: {body: A, point: [0, 0, 0], components: [F, 0, 0]}"
)
_GRAVITY = Message("gravity is one of the 'loads': - uniform gravity: {vector: [0, -g, 0]}")
_SPRINGS = Message("springs and dampers are 'loads': - spring: {coordinate: x, stiffness: k}")
_PARAMETERS = Message("constants are 'parameters', and their numbers 'values'")
_COORDINATES = Message("coordinates are named in the body that they move: 'coordinates: [x, theta]'")
UNSUPPORTED: dict[str, Message] = {
    **dict.fromkeys(("constraint", "holonomic constraints", "nonholonomic constraints"), _LISTS),
    **dict.fromkeys(("loop", "loops", "closed loop", "closed loops", "loop closure", "loop closures"), _LOOPS),
    **dict.fromkeys(("kinematic loop", "kinematic loops", "cut joint", "cut joints", "closure"), _LOOPS),
    **dict.fromkeys(("joint", "joints"), _JOINTS),
    **dict.fromkeys(("force", "forces", "torque", "torques", "moments", "actuators", "motors"), _LOADS),
    **dict.fromkeys(("gravity", "gravitation", "gravity vector"), _GRAVITY),
    **dict.fromkeys(("spring", "springs", "damper", "dampers", "damping"), _SPRINGS),
    **dict.fromkeys(("constants", "constant", "params", "param"), _PARAMETERS),
    **dict.fromkeys(("coords", "coordinates", "generalized coordinates", "dof", "degrees of freedom"), _COORDINATES),
    **dict.fromkeys(("links", "link", "parts", "elements"), Message("links and other parts are 'bodies'")),
}
