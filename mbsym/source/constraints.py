"""Constraints: one reader for each kind; the table at the end is the list of kinds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.place import Span
from mbsym.expressions.tree import ZERO, Expression, differentiate, names, subtract
from mbsym.model.constraints import Axis, Coincide, Constraint, Distance, Parallel, Relation, Rolling, Velocity
from mbsym.model.system import INERTIAL, Point, Vector, rational
from mbsym.source.bodies import read_body_name
from mbsym.source.identity import vanishes
from mbsym.source.keys import AXIS, CONSTRAINTS, POINT
from mbsym.source.placed import Mapping, Node, Scalar, Sequence
from mbsym.source.reading import ZERO_VECTOR, Fields, Reading
from mbsym.source.scope import Allowed, closest

#: Where a contact may be, what a length may hold, and the two sorts of relations.
CONTACT = Allowed("a point of contact", ("coordinate", "prescribed", "parameter", "time"))
LENGTH = Allowed("a distance that is kept", ("prescribed", "parameter", "time"))
HOLONOMIC = Allowed("a relation between coordinates", ("coordinate", "prescribed", "parameter", "time"))
IN_VELOCITIES = Allowed("a relation between velocities", ("coordinate", "velocity", "prescribed", "parameter", "time"))

#: A kind of constraint that resembles a known one as much (1: equal) is a slip of the pen.
_MISSPELT = 0.75

#: Other words for the inertial frame, where no body is called so.
_GROUND = "ground"

#: Other words for kinds of constraints.
_MEANT = {
    word: meant
    for meant, words in {
        "'coincide'": "point, points, coincident, spherical, ball joint, spherical joint, loop, closure, cut joint, "
        "pin, same point",
        "'coincide' and 'parallel' (a hinge is made of both)": "hinge, revolute, revolute joint, universal, "
        "universal joint, cylindrical, cylindrical joint",
        "'distance'": "rod, link, length, rigid link, massless rod",
        "'relation'": "holonomic, equation, gear, coordinate relation, geometric",
        "'rolling'": "roll, rolling without slipping, no slip, pure rolling, contact",
        "'velocity'": "nonholonomic, velocities, pfaffian, knife edge, no side slip, skate",
    }.items()
    for word in words.split(", ")
}


@dataclass(slots=True)
class _One:
    """One constraint being read: its kind, place and value, and the names of the bodies."""

    kind: str
    span: Span
    value: Node
    bodies: list[str]
    reading: Reading

    def body(self, fields: Fields, key: str) -> str:
        node = fields.require(key)
        return INERTIAL if node is None else self.named(node, f"'{key}'")

    def named(self, node: Node, what: str) -> str:
        """A body by its name; ``ground`` is the inertial frame where no body is called so."""
        if isinstance(node, Scalar) and node.text.strip() == _GROUND and _GROUND not in self.bodies:
            return INERTIAL
        return read_body_name(node, what, self.bodies, self.reading) or INERTIAL

    def pair(self, node: Node | None, what: str, hint: str) -> tuple[Node, Node] | None:
        """The two items of a list of two."""
        items = self.reading.items(node, f"'{what}'") if node is not None else ()
        if len(items) == 2:
            return items[0], items[1]
        if isinstance(node, Sequence):
            self.reading.error("wrong-shape", f"'{what}' wants two items, not {len(items)}", node.span, hint)
        return None

    def point(self, node: Node) -> Point:
        fields = self.reading.fields(node, "a point", POINT)
        position = fields.require("point")
        vector = ZERO_VECTOR if position is None else self.reading.vector(position, Allowed("a point of a body"))
        return Point(self.body(fields, "body"), vector)

    def axis(self, node: Node) -> Axis:
        fields = self.reading.fields(node, "an axis", AXIS)
        found = fields.require("axis")
        errors = self.reading.errors
        vector = ZERO_VECTOR if found is None else self.reading.vector(found, Allowed("an axis of a body"))
        if found is not None and self.reading.errors == errors and _is_nothing(vector):
            self.reading.error("bad-direction", "an axis has a direction: this one is zero", found.span)
        return Axis(self.body(fields, "body"), vector)

    def apart(self, first: str, second: str, sound: bool) -> None:
        """Two different bodies are tied; one body, or a body and its own frame, are not."""
        if sound and first == second:
            message = f"both ends of '{self.kind}' are on {_called(first)}: that ties nothing"
            self.reading.error("same-body", message, self.span, "name two different bodies")

    def equation(self, allowed: Allowed, example: str) -> tuple[Expression, Expression] | None:
        """``left = right``; without an equals sign the expression is meant to be zero, and that is complained about."""
        scalar = self.reading.scalar(self.value, f"'{self.kind}'")
        if scalar is None:
            return None
        text = scalar.text.replace("==", " =")  # one sign for one equation, every place kept
        signs = [k for k, character in enumerate(text) if character == "="]
        if len(signs) != 1:
            how = "no '='" if not signs else "more than one '='"
            message = f"a {self.kind} is one equation, and this has {how}"
            self.reading.error("bad-equation", message, scalar.span, f"write for example {example}")
            return None
        whole = Scalar(text, scalar.span, scalar.literal)
        sides = [whole.part(0, signs[0]), whole.part(signs[0] + 1, len(text))]
        errors = self.reading.errors
        left, right = (self.reading.expression(side, allowed) for side in sides)
        return (left, right) if self.reading.errors == errors else None


def read_constraints(node: Node | None, bodies: list[str], reading: Reading) -> tuple[Constraint, ...]:
    """Every constraint of the list, in its order."""
    if node is None:
        return ()
    found = (_read(item, bodies, reading) for item in reading.items(node, "'constraints'"))
    return tuple(one for one in found if one is not None)


def _read(item: Node, bodies: list[str], reading: Reading) -> Constraint | None:
    if not isinstance(item, Mapping) or len(item.entries) != 1:
        hint = "write '- relation: x - r*phi = 0'"
        reading.error("wrong-shape", "a constraint is one key, its kind, with its data", item.span, hint)
        return None
    entry = item.entries[0]
    kind = entry.key.text
    if kind not in CONSTRAINTS:
        word = " ".join(kind.lower().replace("_", " ").split())
        misspelt, other = closest(kind, CONSTRAINTS, _MISSPELT), _MEANT.get(word)
        kinds = f"kinds of constraint are: {', '.join(CONSTRAINTS)}"
        hint = f"did you mean {other}? The {kinds}" if other else f"the {kinds}"
        hint = f"did you mean '{misspelt}'?" if misspelt else hint
        reading.error("unknown-constraint", f"unknown kind of constraint {ascii_safe(kind)}", entry.key.span, hint)
        if misspelt is None:
            return None
        kind = misspelt
    return _READERS[kind](_One(kind, entry.key.span, entry.value, bodies, reading))


def _coincide(one: _One) -> Constraint | None:
    pair = one.pair(one.value, "coincide", "[{body: A, point: [0, 0, 0]}, {body: B, point: [0, 0, 0]}]")
    if pair is None:
        return None
    errors = one.reading.errors
    first, second = one.point(pair[0]), one.point(pair[1])
    one.apart(first.body, second.body, one.reading.errors == errors)
    return Coincide(first, second, one.span)


def _parallel(one: _One) -> Constraint | None:
    pair = one.pair(one.value, "parallel", "[{body: A, axis: [0, 0, 1]}, {body: B, axis: [0, 0, 1]}]")
    if pair is None:
        return None
    errors = one.reading.errors
    first, second = one.axis(pair[0]), one.axis(pair[1])
    one.apart(first.body, second.body, one.reading.errors == errors)
    return Parallel(first, second, one.span)


def _distance(one: _One) -> Constraint | None:
    fields = one.reading.fields(one.value, "'distance'", CONSTRAINTS["distance"])
    errors = one.reading.errors
    pair = one.pair(fields.require("between"), "between", "[{body: A, point: [0, 0, 0]}, {body: B, point: [0, 0, 0]}]")
    length = fields.required_expression("length", LENGTH)
    if pair is None:
        return None
    first, second = one.point(pair[0]), one.point(pair[1])
    one.apart(first.body, second.body, one.reading.errors == errors)
    value, node = rational(length), fields.get("length")
    if one.reading.errors == errors and value is not None and value <= 0 and node is not None:
        hint = "points that coincide are tied by 'coincide'" if value == 0 else None
        one.reading.error("bad-length", "a distance that is kept is positive", node.span, hint)
    return Distance(first, second, length, one.span)


def _relation(one: _One) -> Constraint | None:
    sides = one.equation(HOLONOMIC, "x - r*phi = 0")
    if sides is None:
        return None
    held = set(one.reading.scope.of_kind("coordinate")) & (names(sides[0]) | names(sides[1]))
    if not held:
        message = "this relation holds no coordinate"
        one.reading.error("idle-constraint", message, one.value.span, "relations between constants: 'relations'")
    return Relation(*sides, one.span)


def _velocity(one: _One) -> Constraint | None:
    sides = one.equation(IN_VELOCITIES, "x_dot*sin(theta) - y_dot*cos(theta) = 0")
    if sides is None:
        return None
    g = subtract(*sides)
    speeds = [name for name in sorted(names(g)) if one.reading.scope.kind_of(name) == "velocity"]
    if not speeds:
        hint = "a relation between coordinates alone is a 'relation'"
        one.reading.error("idle-constraint", "this relation holds no velocity", one.value.span, hint)
    for k, name in enumerate(speeds):
        slope = differentiate(g, name)
        for other in speeds[k:]:
            if other in names(slope) and vanishes(differentiate(slope, other)) is not True:
                what = f"'{name}' is not alone in its term" if other == name else f"'{name}' meets '{other}'"
                message = f"this relation is not linear in the velocities: {what}"
                one.reading.error("not-linear", message, one.value.span, "a(q, t)*q_dot + ... + b(q, t) = 0")
                return None
    return Velocity(*sides, one.span)


def _rolling(one: _One) -> Constraint | None:
    fields = one.reading.fields(one.value, "'rolling'", CONSTRAINTS["rolling"])
    errors = one.reading.errors
    body, node = one.body(fields, "body"), fields.require("point")
    contact = ZERO_VECTOR if node is None else one.reading.vector(node, CONTACT)
    axes = one.body(fields, "axes") if "axes" in fields.found else body
    on = one.body(fields, "on")
    one.apart(body, on, one.reading.errors == errors)
    return Rolling(body, contact, axes, on, one.span)


def _is_nothing(vector: Vector) -> bool:
    return all(component == ZERO or rational(component) == 0 for component in vector)


def _called(body: str) -> str:
    return "the inertial frame" if body == INERTIAL else f"'{body}'"


_READERS: dict[str, Callable[[_One], Constraint | None]] = {
    "coincide": _coincide,
    "parallel": _parallel,
    "distance": _distance,
    "relation": _relation,
    "rolling": _rolling,
    "velocity": _velocity,
}
