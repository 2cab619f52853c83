"""A new description, commented, that runs as it is: what ``mbsym new`` writes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from mbsym.expressions.parser import ascii_safe
from mbsym.source.yaml_writer import scalar_text as quoted

#: Joint -> (axes of its rotations, what it lets move along its first axis, in words).
JOINTS: dict[str, tuple[tuple[int, ...], tuple[int, ...], str]] = {
    "hinge": ((3,), (), "one rotation, about the third axis"),
    "cardan": ((3, 1), (), "two rotations, about the third and then the first axis"),
    "ball": ((2, 3, 1), (), "three rotations"),
    "slider": ((), (1,), "one translation, along the first axis"),
    "free": ((2, 3, 1), (1, 2, 3), "three translations and three rotations"),
    "fixed": ((), (), "nothing moves"),
}

#: Joints of one coordinate, about or along any axis.
ONE_AXIS = tuple(name for name, (turns, slides, _) in JOINTS.items() if len(turns) + len(slides) == 1)

_AXES = (1, 2, 3)


@dataclass(frozen=True)
class NewBody:
    """A body of a new description: its name, the body that carries it (None: the ground), its joint of JOINTS.

    ``axis``: about or along which a joint of one coordinate lets it move; None: that of JOINTS.
    """

    name: str
    carrier: str | None = None
    joint: str = "hinge"
    axis: int | None = None

    @property
    def axes(self) -> tuple[int, ...]:
        """Of its rotations."""
        return self._chosen(JOINTS[self.joint][0])

    @property
    def slides(self) -> tuple[int, ...]:
        """The axes along which it moves."""
        return self._chosen(JOINTS[self.joint][1])

    def _chosen(self, axes: tuple[int, ...]) -> tuple[int, ...]:
        return (self.axis,) if self.axis is not None and self.joint in ONE_AXIS and axes else axes


def starter(title: str, bodies: Sequence[NewBody], gravity: bool = True) -> str:
    """A commented description in YAML of bodies with symbols for everything, and numbers so that it can be simulated.

    Body k has mass m_k and, where it turns, its mass centre at the distance l_k below its joint and principal moments
    of inertia about the mass centre; coordinates q_k1, q_k2, ...; the next body hangs at the distance d_k below the
    joint of its carrier, on one that never turns at the joint itself.
    Raises ValueError for an unknown joint, or a carrier that does not stand before its body.
    """
    _check(bodies)
    parameters = _parameters(bodies, gravity)
    return "\n".join(
        [
            "# A description for mbsym.  What follows # is a comment; every formula may hold symbols.",
            "# Derive and write reports:  mbsym run FILE        What can stand here:  mbsym explain",
            "mbsym: 1",
            f"name: {quoted(title)}",
            "description: Replace this by a sentence on the system, and how its coordinates are measured.",
            "",
            "# Constants.  A sign lets more be decided: positive, nonnegative, negative, nonpositive, nonzero, real.",
            "parameters:",
            *(
                f"  {name}: {{sign: positive, meaning: {quoted(parameter.meaning)}}}"
                for name, parameter in parameters.items()
            ),
            "",
            "# Bodies in a tree, each attached to an earlier one (0: the inertial frame).  Vectors are written in axes",
            "# 1, 2, 3: a connection point in those of the carrier, a mass centre in those of the body.",
            "bodies:",
            *(line for number, body in enumerate(bodies, 1) for line in _body(number, body, bodies)),
            *(_gravity() if gravity else []),
            "",
            "# The motion about which the equations are linearised and its stability is judged.",
            "motion:",
            *(f"  {name}: 0" for name in _coordinates(bodies)),
            "",
            "# Numbers, for simulations only; results stay in symbols.",
            f"values: {{{', '.join(f'{name}: {parameter.value}' for name, parameter in parameters.items())}}}",
            f"initial: {{{', '.join(f'{name}: {value}' for name, value in _initial(bodies).items())}}}",
            "",
        ]
    )


def _check(bodies: Iterable[NewBody]) -> None:
    known: set[str | None] = {None}
    for body in bodies:
        if body.joint not in JOINTS:
            raise ValueError(f"there is no joint {ascii_safe(body.joint)}")
        if body.carrier not in known:
            raise ValueError(f"{ascii_safe(str(body.carrier))} does not stand before {ascii_safe(body.name)}")
        known.add(body.name)


def _parameters(bodies: Sequence[NewBody], gravity: bool) -> dict[str, NewParameter]:
    parameters: dict[str, NewParameter] = {}
    carriers, turning = {body.carrier for body in bodies}, _turning(bodies)
    for number, body in enumerate(bodies, 1):
        parameters |= parameters_of(number, body, body.name in turning)
        if body.name in carriers & turning:
            parameters[f"d{number}"] = NewParameter(f"distance from the joint of {body.name} to the next one", "1")
    return parameters | ({"g": NewParameter("acceleration of gravity", "9.81")} if gravity else {})


@dataclass(frozen=True)
class NewParameter:
    """What a positive parameter of a new description means, and a number for simulations."""

    meaning: str
    value: str


def parameters_of(number: int, body: NewBody, turns: bool = True) -> dict[str, NewParameter]:
    """Mass, distance to the mass centre, principal moments of inertia of a body; of one that never turns its mass.

    The numbers are those of a slender body of 1 kg, its mass centre 0.5 m below its joint.
    """
    mass = {f"m{number}": NewParameter(f"mass of {body.name}", "1")}
    if not turns:
        return mass
    distance = NewParameter(f"distance from the joint of {body.name} to its mass centre", "0.5")
    moments = {
        f"J{number}{axis}": NewParameter(f"moment of inertia of {body.name}, axis {axis}", value)
        for axis, value in zip(_AXES, ("0.08", "0.01", "0.08"), strict=True)
    }
    return {**mass, f"l{number}": distance, **moments}


def _turning(bodies: Sequence[NewBody]) -> set[str]:
    """The bodies that turn, by themselves or with their carriers."""
    turning: set[str] = set()
    for body in bodies:
        if body.axes or body.carrier in turning:
            turning.add(body.name)
    return turning


def coordinates_of(number: int, body: NewBody) -> list[str]:
    """The translations and the rotations that the joint allows."""
    return [*_translations(number, body), *_rotations(number, body)]


def on_its_joint(number: int, body: NewBody, below: str = "0", turns: bool = True) -> dict[str, Any]:
    """The keys of a body from its joint on, which is ``below`` that of the carrier (0: where that is).

    The mass centre is at the distance l below the joint, for a hinge about the second axis beside it.  Of a body that
    never turns neither this nor its moments of inertia are in the equations: it has a mass alone.
    """
    angles, point = _rotations(number, body), ["0", f"-{below}" if below != "0" else "0", "0"]
    for axis, name in zip(body.slides, _translations(number, body), strict=True):
        point[axis - 1] = name if point[axis - 1] == "0" else f"{name} - {below}"
    keys: dict[str, Any] = {}
    if angles:
        keys["rotation"] = {"axes": list(map(str, body.axes)), "angles": angles}
    if point != ["0", "0", "0"]:
        keys["connection point"] = point
    keys["mass"] = f"m{number}"
    if turns:
        beside = body.axes == (2,)
        keys["mass centre"] = [f"l{number}", "0", "0"] if beside else ["0", f"-l{number}", "0"]
        keys["inertia about"], keys["inertia"] = "mass centre", [f"J{number}{axis}" for axis in _AXES]
    return {**keys, "coordinates": coordinates_of(number, body)}


def _rotations(number: int, body: NewBody) -> list[str]:
    return [f"q{number}{index}" for index in range(1, len(body.axes) + 1)]


def _translations(number: int, body: NewBody) -> list[str]:
    return [f"x{number}{axis}" for axis in body.slides]


def _coordinates(bodies: Sequence[NewBody]) -> list[str]:
    return [name for k, body in enumerate(bodies, 1) for name in coordinates_of(k, body)]


#: What is said beside a key.
_COMMENTS = {"inertia about": "or: joint", "inertia": "or three rows of a symmetric matrix"}


def _body(number: int, body: NewBody, bodies: Sequence[NewBody]) -> list[str]:
    comment = f"{body.joint}: {JOINTS[body.joint][2]}"
    lines = [f"  - name: {quoted(body.name)}", f"    attached to: {quoted(body.carrier) if body.carrier else 0}"]
    turning = _turning(bodies)
    carrier = next(
        (k for k, other in enumerate(bodies, 1) if other.name == body.carrier and other.name in turning), None
    )
    data = on_its_joint(number, body, "0" if carrier is None else f"d{carrier}", body.name in turning)
    comments = {**_COMMENTS, "rotation": comment}
    if "rotation" not in data:
        lines[0] += f" # {comment}"
    for key, value in data.items():
        lines.append(f"    {key}: {_flow(value)}" + (f" # {comments[key]}" if key in comments else ""))
    return [*lines, ""]


def _flow(value: Any) -> str:
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key}: {_flow(entry)}' for key, entry in value.items())}}}"
    return f"[{', '.join(value)}]" if isinstance(value, list) else value


def _gravity() -> list[str]:
    return [
        "# Forces: 'mbsym explain loads' lists springs, dampers, forces, torques, gravity of a centre, ...",
        "loads:",
        "  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}",
    ]


def _initial(bodies: Sequence[NewBody]) -> dict[str, str]:
    initial: dict[str, str] = {}
    for number, body in enumerate(bodies, 1):
        initial |= initial_of(number, body)
    return initial


def initial_of(number: int, body: NewBody) -> dict[str, str]:
    """Somewhere away from rest, so that a simulation moves: rotations, or translations where there are none."""
    names = _rotations(number, body) or _translations(number, body)
    return {name: f"0.{index % 9 + 1}" for index, name in enumerate(names, 1)}
