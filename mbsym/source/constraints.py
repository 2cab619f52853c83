"""What constraints demand beyond the table of their kinds."""

from __future__ import annotations

from mbsym.expressions.tree import differentiate, names, subtract
from mbsym.model.constraints import Coincide, Constraint, Distance, Parallel, Relation, Rolling, Velocity
from mbsym.model.system import INERTIAL, rational
from mbsym.source.identity import vanishes
from mbsym.source.keys import CONSTRAINTS
from mbsym.source.kinds import Item, Section
from mbsym.source.placed import Node
from mbsym.source.reading import Reading

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


def read_constraints(node: Node | None, bodies: list[str], reading: Reading) -> tuple[Constraint, ...]:
    """Every constraint of the list, in its order."""
    return _SECTION.read(node, bodies, reading)


def _apart(item: Item, first: str, second: str, keys: set[str]) -> None:
    """Two different bodies are tied; one body, or a body and its own frame, are not."""
    if keys <= item.sound and first == second:
        called = "the inertial frame" if first == INERTIAL else f"'{first}'"
        message = f"both ends of '{item.name}' are on {called}: that ties nothing"
        item.reading.error("same-body", message, item.span, "name two different bodies")


def _pair(item: Item, made: Coincide | Parallel) -> bool:
    _apart(item, made.first.body, made.second.body, {""})
    return True


def _distance(item: Item, made: Distance) -> bool:
    _apart(item, made.first.body, made.second.body, {"between"})
    value = rational(made.length)
    if "length" in item.sound and value is not None and value <= 0:
        hint = "points that coincide are tied by 'coincide'" if value == 0 else None
        item.value_error("bad-length", "a distance that is kept is positive", "length", hint)
    return True


def _relation(item: Item, made: Relation) -> bool:
    if not set(item.reading.scope.of_kind("coordinate", "unit vector")) & (names(made.left) | names(made.right)):
        message = "this relation holds no coordinate"
        hint = "relations between constants: 'relations'"
        item.reading.error("idle-constraint", message, item.value.span, hint)
    return True


def _velocity(item: Item, made: Velocity) -> bool:
    g = subtract(made.left, made.right)
    speeds = [name for name in sorted(names(g)) if item.reading.scope.kind_of(name) == "velocity"]
    if not speeds:
        hint = "a relation between coordinates alone is a 'relation'"
        item.reading.error("idle-constraint", "this relation holds no velocity", item.value.span, hint)
    for k, name in enumerate(speeds):
        slope = differentiate(g, name)
        for other in speeds[k:]:
            if other in names(slope) and vanishes(differentiate(slope, other)) is not True:
                what = f"'{name}' is not alone in its term" if other == name else f"'{name}' meets '{other}'"
                message = f"this relation is not linear in the velocities: {what}"
                item.reading.error("not-linear", message, item.value.span, "a(q, t)*q_dot + ... + b(q, t) = 0")
                return False
    return True


def _rolling(item: Item, made: Rolling) -> bool:
    _apart(item, made.body, made.on, {"body", "on"})
    return True


_SECTION = Section(
    "constraint",
    CONSTRAINTS,
    "relation: x - r*phi = 0",
    _MEANT,
    {
        "coincide": _pair,
        "parallel": _pair,
        "distance": _distance,
        "relation": _relation,
        "rolling": _rolling,
        "velocity": _velocity,
    },
)
