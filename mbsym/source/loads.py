"""What loads and constraints demand beyond the table of their kinds."""

from __future__ import annotations

from fractions import Fraction

from mbsym.expressions.message import Message
from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaints
from mbsym.expressions.tree import Name, Number, differentiate, names, subtract
from mbsym.model.constraints import Coincide, Constraint, Distance, Parallel, Relation, Rolling, Velocity
from mbsym.model.loads import EXACT, ForceFunction, Load, NewtonianGravity, PointDamper, Torque, UniformGravity
from mbsym.model.system import INERTIAL, rational
from mbsym.source.identity import vanishes
from mbsym.source.keys import CONSTRAINTS, LOADS
from mbsym.source.kinds import Item, Section
from mbsym.source.placed import Mapping, Node, Scalar, Sequence
from mbsym.source.reading import MAX_SHOWN, Reading

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


def read_loads(node: Node | None, bodies: list[str], reading: Reading) -> tuple[Load, ...]:
    """Every load of the list, in its order."""
    loads = _SECTION.read(node, bodies, reading)
    _check_one_spelling(loads, reading)
    return loads


def _check_one_spelling(loads: tuple[Load, ...], reading: Reading) -> None:
    """A file speaks of force functions or of potentials, never of both: a sign slip would hide between them."""
    spelled = [load for load in loads if isinstance(load, ForceFunction)]
    for load in spelled[1:]:
        if load.spelled != spelled[0].spelled:
            message = Message(
                "this file already uses '[[spelled]]'; U = -potential, so use one of them only",
                spelled=spelled[0].spelled,
            )
            reading.error("conflicting-keys", message, load.span)


def _newtonian_gravity(item: Item, load: NewtonianGravity) -> bool:
    if {"about", "centre"} <= item.sound and load.centre == load.about and load.order != EXACT:
        message = "the field is expanded about a point away from the centre"
        item.key_error(
            "conflicting-keys",
            message,
            "about",
            Message("only with order: [[order]] the field is not expanded", order=EXACT),
        )
    return True


def _uniform_gravity(item: Item, load: UniformGravity) -> bool:
    squares = [x * x for x in map(rational, item.values.get("direction", ())) if x is not None]
    if "direction" in item.sound and len(squares) == 3 and sum(squares, Fraction(0)) != 1:
        hint = "for components of any length use 'vector'"
        item.value_error("bad-direction", "a direction is a unit vector", "direction", hint)
    return True


def _vector_hint(value: Node) -> str:
    """How to write a gravity that was given as a bare list."""
    texts = [getattr(item, "text", "") for item in value.items] if isinstance(value, Sequence) else []
    vector = ", ".join(texts) if len(texts) == 3 and all(texts) else ""
    if isinstance(value, Scalar):  # the acceleration alone
        size, tree = value.text.strip(), parse_expression(value.text, Complaints(), value.place)
        size = size if isinstance(tree, Name | Number) else f"({size})"
        vector = "" if tree is None else f"0, -{size}, 0"
    return Message("write {vector: [[[written]]]}", written=vector if 0 < len(vector) <= MAX_SHOWN else "0, -9.81, 0")


def _damper(item: Item, load: Load) -> bool:
    if isinstance(load, PointDamper):
        message = "this damper acts along the line between its points: R = coefficient (rate of the distance)^2 / 2"
        hint = "for R = coefficient |V_1 - V_2|^2 / 2 write 'isotropic damper'"
        if "between" in item.sound and load.first == load.second:
            met = "these points are one, and the line between them has no direction"
            item.value_error("coinciding-points", met, "between")
        item.warning("damper-along-line", message, "between", hint)
    return True


def _torque(item: Item, load: Torque) -> bool:
    if {"body", "reaction on"} <= item.sound and load.reaction_on == load.body:
        item.key_error("conflicting-keys", "a body does not react on itself", "reaction on")
    return True


def _of_a_coordinate(item: Item) -> bool:
    """Whether {coordinate: x, ...: f} stands there, as springs have it: the generalised force f of x is meant."""
    entries = {entry.key.text: entry for entry in item.value.entries} if isinstance(item.value, Mapping) else {}
    name = getattr(entries["coordinate"].value, "text", "") if "coordinate" in entries else ""
    if name not in item.reading.scope.of_kind("coordinate"):
        return False
    others = [getattr(entry.value, "text", "") for key, entry in entries.items() if key != "coordinate"]
    force = others[0] if len(others) == 1 and 0 < len(others[0]) <= MAX_SHOWN else "F"
    message = Message("a [[name]] acts on a body; on a coordinate it is a 'generalized force'", name=item.name)
    hint = Message("write '- [[example]]'", example=f"generalized force: {{{name}: {force}}}")
    item.reading.error("unknown-key", message, entries["coordinate"].key.span, hint)
    return True


_SECTION = Section(
    "load",
    LOADS,
    "spring: {coordinate: x, stiffness: k}",
    _MEANT,
    {
        "newtonian gravity": _newtonian_gravity,
        "uniform gravity": _uniform_gravity,
        "damper": _damper,
        "torque": _torque,
    },
    {"uniform gravity": _vector_hint},
    {"force": _of_a_coordinate, "torque": _of_a_coordinate},
)


# What constraints demand beyond the table of their kinds.


#: Other words for kinds of constraints.
_constraints_MEANT = {
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
    return _constraints_SECTION.read(node, bodies, reading)


def _apart(item: Item, first: str, second: str, keys: set[str]) -> None:
    """Two different bodies are tied; one body, or a body and its own frame, are not."""
    if keys <= item.sound and first == second:
        called = "the inertial frame" if first == INERTIAL else f"'{first}'"
        message = Message("both ends of '[[name]]' are on [[body]]: that ties nothing", name=item.name, body=called)
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
    speeds = [name for name in sorted(names(g)) if item.reading.scope.kind_of(name) in ("velocity", "speed")]
    if not speeds:
        hint = "a relation between coordinates alone is a 'relation'"
        item.reading.error("idle-constraint", "this relation holds no velocity", item.value.span, hint)
    for k, name in enumerate(speeds):
        slope = differentiate(g, name)
        for other in speeds[k:]:
            if other in names(slope) and vanishes(differentiate(slope, other)) is not True:
                what = (
                    Message("'[[name]]' is not alone in its term", name=name)
                    if other == name
                    else Message("'[[name]]' meets '[[other]]'", name=name, other=other)
                )
                message = Message("this relation is not linear in the velocities: [[what]]", what=what)
                item.reading.error("not-linear", message, item.value.span, "a(q, t)*q_dot + ... + b(q, t) = 0")
                return False
    return True


def _rolling(item: Item, made: Rolling) -> bool:
    _apart(item, made.body, made.on, {"body", "on"})
    return True


def _as_equation(text: str) -> str | None:
    """The constraint that a bare formula or equation is: one in coordinates, or one in velocities."""
    sides = text.split("=")
    if len(text) > MAX_SHOWN or len(sides) > 2 or any(parse_expression(x, Complaints()) is None for x in sides):
        return None
    kind = "velocity" if "_dot" in text else "relation"
    return f"{kind}: {text}" if len(sides) == 2 else f"{kind}: {text} = 0"


_constraints_SECTION = Section(
    "constraint",
    CONSTRAINTS,
    "relation: x - r*phi = 0",
    _constraints_MEANT,
    {
        "coincide": _pair,
        "parallel": _pair,
        "distance": _distance,
        "relation": _relation,
        "rolling": _rolling,
        "velocity": _velocity,
    },
    bare=_as_equation,
)
