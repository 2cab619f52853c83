"""What loads demand beyond the table of their kinds."""

from __future__ import annotations

from fractions import Fraction

from mbsym.expressions.message import Message
from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaints
from mbsym.expressions.tree import Name, Number
from mbsym.model.loads import EXACT, ForceFunction, Load, NewtonianGravity, PointDamper, Torque, UniformGravity
from mbsym.model.system import rational
from mbsym.source.keys import LOADS
from mbsym.source.kinds import Item, Section
from mbsym.source.placed import Node, Scalar, Sequence
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
        hint = "for R = coefficient |V_1 - V_2|^2 / 2, which this key meant before, write 'isotropic damper'"
        if "between" in item.sound and load.first == load.second:
            met = "these points are one, and the line between them has no direction"
            item.value_error("coinciding-points", met, "between")
        item.warning("damper-along-line", message, "between", hint)
    return True


def _torque(item: Item, load: Torque) -> bool:
    if {"body", "reaction on"} <= item.sound and load.reaction_on == load.body:
        item.key_error("conflicting-keys", "a body does not react on itself", "reaction on")
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
)
