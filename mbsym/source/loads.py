"""Loads: one reader for each kind; the table at the end is the list of kinds."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from fractions import Fraction

from mbsym.expressions.parser import ascii_safe, parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.tree import ZERO, Name, Number, multiply
from mbsym.model.loads import (
    EXACT,
    GRAVITY_ORDERS,
    CoordinateDamper,
    CoordinateSpring,
    ForceFunction,
    GeneralizedForce,
    IsotropicDamper,
    Load,
    NewtonianGravity,
    PointDamper,
    PointForce,
    PointSpring,
    Rayleigh,
    Torque,
    UniformGravity,
)
from mbsym.model.system import INERTIAL, Point, Vector, rational
from mbsym.source.bodies import read_body_name
from mbsym.source.keys import ALIASES, LOADS, POINT, UNSUPPORTED
from mbsym.source.placed import Entry, Mapping, Node, Scalar, Sequence
from mbsym.source.reading import MAX_SHOWN, ZERO_VECTOR, Fields, Reading
from mbsym.source.scope import DISSIPATION, FORCE, POTENTIAL, Allowed, closest

#: A kind of load that resembles a known one as much (1: equal) is a slip of the pen.
_MISSPELT = 0.75

#: Other words for loads, and the kind that is meant.
_MEANT = {
    word: meant
    for meant, words in {
        "'isotropic damper'": "isotropic dashpot, isotropic damping, viscous bath",
        "'damper'": "friction, viscous friction, dashpot, damping, viscous damping, viscous damper, linear damper, "
        "torsional damper, rotational damper, shock absorber, drag",
        "'spring'": "elastic, elastic force, elasticity, torsion spring, torsional spring, rotational spring, "
        "linear spring, stiffness",
        "'rayleigh'": "dissipation, dissipation function, dissipative function, rayleigh function, "
        "rayleigh dissipation function",
        "'uniform gravity' or 'newtonian gravity'": "gravity, gravitation, weight, gravitational force, gravity force",
        "'uniform gravity'": "constant gravity, homogeneous gravity, uniform gravitation, earth gravity",
        "'newtonian gravity'": "central gravity, gravity gradient, gravity-gradient, newtonian gravitation, "
        "newtonian field, central field, point gravity",
        "'torque'": "moment, couple, motor, actuator, control torque, moment of force",
        "'force'": "point force, applied force, external force, follower force, thrust, load",
        "'potential'": "potential energy, potential function, energy",
        "'generalized force'": "generalized, control, control force, nonconservative force",
    }.items()
    for word in words.split(", ")
}


@dataclass(slots=True)
class _Load:
    """One load being read: its kind, place and value, and the names of the bodies."""

    kind: str
    span: Span
    value: Node
    bodies: list[str]
    reading: Reading

    def fields(self, hint: str | None = None) -> Fields:
        return self.reading.fields(self.value, f"'{self.kind}'", LOADS[self.kind], hint)

    def body(self, fields: Fields, key: str) -> str:
        node = fields.require(key)
        name = None if node is None else read_body_name(node, f"'{key}'", self.bodies, self.reading)
        return name or INERTIAL

    def moving_body(self, fields: Fields) -> str:
        """The body that a force acts on: any but the inertial frame, on which forces do nothing."""
        name = self.body(fields, "body")
        node = fields.get("body")
        if name == INERTIAL and node is not None and getattr(node, "text", "") == INERTIAL:
            self.reading.error("unknown-body", "a force on the inertial frame 0 does nothing", node.span)
        return name

    def vector(self, fields: Fields, key: str, allowed: Allowed) -> Vector:
        node = fields.require(key)
        return ZERO_VECTOR if node is None else self.reading.vector(node, allowed)


def read_loads(node: Node | None, bodies: list[str], reading: Reading) -> tuple[Load, ...]:
    """Every load of the list, in its order."""
    if node is None:
        return ()
    loads = []
    for item in reading.items(node, "'loads'"):
        load = _read_load(item, bodies, reading)
        if load is not None:
            loads.append(load)
    _check_one_spelling(loads, reading)
    return tuple(loads)


def _read_load(item: Node, bodies: list[str], reading: Reading) -> Load | None:
    if not isinstance(item, Mapping) or len(item.entries) != 1:
        hint = "write '- spring: {coordinate: x, stiffness: k}'"
        reading.error("wrong-shape", "a load is one key, its kind, with its data", item.span, hint)
        return None
    entry: Entry = item.entries[0]
    kind = ALIASES.get(entry.key.text, entry.key.text)
    if kind not in LOADS:
        unsupported = UNSUPPORTED.get(" ".join(kind.lower().split()))
        misspelt = None if unsupported else closest(kind, LOADS, _MISSPELT)
        other = _MEANT.get(" ".join(kind.lower().split()))
        kinds = f"kinds of load are: {', '.join(LOADS)}"
        hint = f"did you mean {other}? The {kinds}" if other else f"the {kinds}"
        hint = f"did you mean '{misspelt}'?" if misspelt else unsupported or hint
        reading.error("unknown-load", f"unknown kind of load {ascii_safe(entry.key.text)}", entry.key.span, hint)
        if misspelt is None:
            return None
        kind = misspelt  # its data are read as if it were, for what else may be wrong with them
    return _READERS[kind](_Load(kind, entry.key.span, entry.value, bodies, reading))


def _check_one_spelling(loads: list[Load], reading: Reading) -> None:
    """A file speaks of force functions or of potentials, never of both: a sign slip would hide between them."""
    spelled = [load for load in loads if isinstance(load, ForceFunction)]
    for load in spelled[1:]:
        if load.spelled != spelled[0].spelled:
            message = f"this file already uses '{spelled[0].spelled}'; U = -potential, so use one of them only"
            reading.error("conflicting-keys", message, load.span)


def _newtonian_gravity(load: _Load) -> Load:
    fields = load.fields()
    constant = fields.required_expression("constant", Allowed("a gravitational constant"))
    errors = load.reading.errors
    centre, about = load.body(fields, "centre"), load.body(fields, "about")
    sound = load.reading.errors == errors and {"about", "centre"} <= fields.found.keys()
    order = _order(load, fields)
    if sound and centre == about and order != EXACT:
        message = "the field is expanded about a point away from the centre"
        hint = f"only with order: {EXACT} the field is not expanded"
        load.reading.error("conflicting-keys", message, fields.key_span("about"), hint)
    return NewtonianGravity(constant, centre, about, order, load.span)


def _order(load: _Load, fields: Fields) -> int | str:
    """The order of the field; 2 when it is left out or wrong."""
    known = {str(order): order for order in GRAVITY_ORDERS}
    node = fields.get("order")
    word = None if node is None else load.reading.word(node, "the order of the field", known)
    return known.get(word or "", 2)


def _uniform_gravity(load: _Load) -> Load:
    fields = load.fields(_vector_hint(load.value))
    if fields.get("vector") is not None:
        fields.exclude("vector", ("acceleration", "direction"))
        return UniformGravity(load.vector(fields, "vector", Allowed("an acceleration")), load.span)
    size = fields.required_expression("acceleration", Allowed("an acceleration"))
    errors = load.reading.errors
    direction = load.vector(fields, "direction", Allowed("a direction"))
    sound = load.reading.errors == errors and "direction" in fields.found
    numbers = [rational(component) for component in direction]
    squares = [number * number for number in numbers if number is not None]
    if sound and len(squares) == 3 and sum(squares, Fraction(0)) != 1:
        hint = "for components of any length use 'vector'"
        load.reading.error("bad-direction", "a direction is a unit vector", fields.found["direction"].value.span, hint)
    return UniformGravity(
        (multiply(size, direction[0]), multiply(size, direction[1]), multiply(size, direction[2])), load.span
    )


def _vector_hint(value: Node) -> str:
    """How to write a gravity that was given as a bare list."""
    texts = [getattr(item, "text", "") for item in value.items] if isinstance(value, Sequence) else []
    vector = ", ".join(texts) if len(texts) == 3 and all(texts) else ""
    if isinstance(value, Scalar):  # the acceleration alone
        size, tree = value.text.strip(), parse_expression(value.text, Complaints(), value.place)
        size = size if isinstance(tree, Name | Number) else f"({size})"
        vector = "" if tree is None else f"0, -{size}, 0"
    return f"write {{vector: [{vector if 0 < len(vector) <= MAX_SHOWN else '0, -9.81, 0'}]}}"


def _coordinate(fields: Fields, reading: Reading) -> str:
    node = fields.get("coordinate")
    scalar = None if node is None else reading.scalar(node, "'coordinate'")
    if scalar is not None:
        reading.scope.check_name(scalar.text, scalar.span, Allowed("'coordinate'", ("coordinate",)))
    return "" if scalar is None else scalar.text


def _between(load: _Load, fields: Fields) -> tuple[Point, Point]:
    node = fields.get("between")
    nowhere = Point(INERTIAL, ZERO_VECTOR)
    items = () if node is None else load.reading.items(node, "'between'")
    if len(items) != 2:
        if node is not None and isinstance(node, Sequence):
            load.reading.error("wrong-shape", "two points are wanted", node.span, "[{body: A, point: [0, 0, 0]}, ...]")
        return nowhere, nowhere
    return _point(load, items[0]), _point(load, items[1])


def _point(load: _Load, node: Node) -> Point:
    fields = load.reading.fields(node, "a point", POINT)
    return Point(load.body(fields, "body"), load.vector(fields, "point", Allowed("a point of a body")))


def _one_of(fields: Fields, reading: Reading) -> str | None:
    """Whether a spring or damper acts on a coordinate or between points."""
    if "between" in fields.found:
        fields.exclude("between", ("coordinate", "rest"))
        return "between"
    if "coordinate" in fields.found:
        fields.exclude("coordinate", ("length",))
        return "coordinate"
    reading.error("missing-key", f"{fields.what} has neither 'coordinate' nor 'between'", fields.span)
    return None


def _spring(load: _Load) -> Load | None:
    fields = load.fields()
    where = _one_of(fields, load.reading)
    stiffness = fields.required_expression("stiffness", Allowed("a stiffness"))
    if where == "coordinate":
        rest = fields.expression("rest", Allowed("a rest position"))
        return CoordinateSpring(_coordinate(fields, load.reading), stiffness, rest or ZERO, load.span)
    if where == "between":
        first, second = _between(load, fields)
        length = fields.required_expression("length", Allowed("a length"))
        return PointSpring(first, second, stiffness, length, load.span)
    return None


def _damper(load: _Load) -> Load | None:
    fields = load.fields()
    errors = load.reading.errors
    where = _one_of(fields, load.reading)
    coefficient = fields.required_expression("coefficient", Allowed("a damping coefficient"))
    if where == "coordinate":
        return CoordinateDamper(_coordinate(fields, load.reading), coefficient, load.span)
    if where == "between":
        first, second = _between(load, fields)
        message = "this damper acts along the line between its points: R = coefficient (rate of the distance)^2 / 2"
        hint = "for R = coefficient |V_1 - V_2|^2 / 2, which this key meant before, write 'isotropic damper'"
        if load.reading.errors == errors and first == second:
            met = "these points are one, and the line between them has no direction"
            load.reading.error("coinciding-points", met, fields.found["between"].value.span)
        load.reading.complaints.warning("damper-along-line", message, fields.key_span("between"), hint)
        return PointDamper(first, second, coefficient, load.span)
    return None


def _isotropic_damper(load: _Load) -> Load:
    fields = load.fields()
    coefficient = fields.required_expression("coefficient", Allowed("a damping coefficient"))
    fields.require("between")
    first, second = _between(load, fields)
    return IsotropicDamper(first, second, coefficient, load.span)


def _rayleigh(load: _Load) -> Load:
    return Rayleigh(load.reading.expression(load.value, DISSIPATION), load.span)


def _force_function(load: _Load) -> Load:
    return ForceFunction(load.reading.expression(load.value, POTENTIAL), load.kind, load.span)


def _spelled_out(entries: list[Entry], coordinates: Collection[str]) -> str:
    """The coordinate of {coordinate: x, ...: force}, as other loads have it; empty for what is none."""
    if len(entries) != 2 or entries[0].key.text != "coordinate" or "coordinate" in coordinates:
        return ""
    value = entries[0].value
    return value.text if isinstance(value, Scalar) and value.text in coordinates else ""


def _generalized_force(load: _Load) -> Load:
    components = []
    entries = list(load.reading.entries(load.value, "'generalized force'"))
    spelled = _spelled_out(entries, load.reading.scope.of_kind("coordinate"))
    if spelled:
        hint = f"the key is the coordinate itself: write {spelled}: and then the force"
        message = f"unknown key '{entries[0].key.text}' of a generalized force"
        load.reading.error("unknown-key", message, entries[0].key.span, hint)
        return GeneralizedForce((), load.span)
    for entry in entries:
        allowed = Allowed("the key of a generalized force", ("coordinate",))
        known = load.reading.scope.check_name(entry.key.text, entry.key.span, allowed)
        value = load.reading.expression(entry.value, FORCE)
        if known:
            components.append((entry.key.text, value))
    return GeneralizedForce(tuple(components), load.span)


def _force(load: _Load) -> Load:
    fields = load.fields()
    point = Point(load.moving_body(fields), load.vector(fields, "point", Allowed("a point of a body")))
    return PointForce(point, load.vector(fields, "components", FORCE), load.body(fields, "axes"), load.span)


def _torque(load: _Load) -> Load:
    fields = load.fields()
    errors = load.reading.errors
    reaction = load.body(fields, "reaction on") if "reaction on" in fields.found else None
    body = load.moving_body(fields)
    if load.reading.errors == errors and reaction is not None and reaction == body:
        load.reading.error("conflicting-keys", "a body does not react on itself", fields.key_span("reaction on"))
    return Torque(body, load.vector(fields, "components", FORCE), load.body(fields, "axes"), reaction, load.span)


_READERS: dict[str, Callable[[_Load], Load | None]] = {
    "newtonian gravity": _newtonian_gravity,
    "uniform gravity": _uniform_gravity,
    "spring": _spring,
    "damper": _damper,
    "isotropic damper": _isotropic_damper,
    "rayleigh": _rayleigh,
    "force function": _force_function,
    "potential": _force_function,
    "generalized force": _generalized_force,
    "force": _force,
    "torque": _torque,
}
