"""Where rotation angles are singular, and other angles that are regular there.

Three turns {a1, a2, a3} cannot tell orientations apart where the third axis of turning falls on the first:
cos x2 = 0 for three different axes, sin x2 = 0 for {a, b, a}.  There body axis a3 lies along the previous body's axis
a1.  The sequence {a2, a1, a3}, respectively {b, c, a}, is singular elsewhere, so the two together cover every
orientation: the first where it is regular, the second only where body axis a3 lies along axis a1.

Where the first angle runs at a constant rate (a spin about an axis fixed in the previous body), it has to stay the
first: {a1, a3, a2}, respectively {a1, a2, c}, is regular there, and what the body sees of axis a1 is the configuration.

Two turns {a1, a2} of a body without twist (a thin rod, a point mass: nothing depends on a turn about a body axis g) are
the same with the third turn left out; only the direction of g matters then.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from itertools import pairwise, product
from typing import Any

from mbsym.algebra.failures import Failure
from mbsym.algebra.ring import Polynomial
from mbsym.expressions.tree import Name, names
from mbsym.mechanics.frames import axis_vector, back, direction_cosines, forward
from mbsym.mechanics.rest import Rest, rest
from mbsym.mechanics.variables import expressions
from mbsym.model.system import Body, Rotation, System, velocity_name

#: No more joints than this are described in two ways: every one doubles the number of charts.
MOST_JOINTS = 4


@dataclass(frozen=True)
class Joint:
    """A joint whose angles can be replaced: ``axes`` a1, a2, a3; ``angles`` the two or three coordinates.

    ``direction_only``: only the direction of body axis a3 matters (no third turn, or one that runs at a constant rate).
    ``spinning``: the first angle runs at a constant rate, so that only the direction of axis a1 in the body matters.
    """

    body: str
    axes: tuple[int, int, int]
    angles: tuple[str, ...]
    direction_only: bool
    spinning: bool = False

    @property
    def proper(self) -> bool:
        """Three turns about different axes (the other kind repeats the first)."""
        return self.axes[0] != self.axes[2]

    @property
    def other_axes(self) -> tuple[int, int, int]:
        first, second, third = self.axes
        if self.spinning:
            return (first, third, second) if self.proper else (first, second, 6 - first - second)
        if self.proper:
            return second, first, third
        return second, 6 - first - second, third

    @property
    def singular_kind(self) -> str:
        """The generator of the second angle that vanishes where the angles are singular."""
        return "cosine" if self.proper else "sine"


@dataclass(frozen=True)
class Chart:
    """One description of the configurations: the system with some joints' angles replaced.

    Only configurations with ``nonzero`` != 0 and ``restrictions`` = 0 are to be looked for in it, so that the charts of
    a system have no configuration in common.
    """

    found: Rest
    joints: tuple[Joint, ...]
    replaced: tuple[bool, ...]
    nonzero: tuple[Polynomial, ...]
    restrictions: tuple[Polynomial, ...]

    @property
    def label(self) -> str:
        """``satellite {3, 2, 1}`` for each replaced joint."""
        parts = []
        for joint, other in zip(self.joints, self.replaced, strict=True):
            if other:
                axes = joint.other_axes[: len(joint.angles)]
                parts.append(f"{joint.body} {{{', '.join(map(str, axes))}}}")
        return ", ".join(parts)


def joints(system: System, turning: Sequence[str]) -> tuple[Joint, ...]:
    """The joints whose angles occur nowhere else, so that they may be replaced by others."""
    found = []
    for body in system.bodies:
        turns = list(body.rotation.turns())
        angles = [angle.name for _, angle in turns if isinstance(angle, Name) and angle.name in system.coordinates]
        axes = [axis for axis, _ in turns]
        distinct = len(set(angles)) == len(turns) and all(a != b for a, b in pairwise(axes))
        if len(turns) not in (2, 3) or not distinct:
            continue
        steady = [name in turning for name in angles]
        spinning = steady == [True, False, False]
        if (any(steady[:2]) and not spinning) or _used_elsewhere(system, body, angles):
            continue
        if len(turns) == 3:
            found.append(Joint(body.name, (axes[0], axes[1], axes[2]), tuple(angles), steady[2], spinning))
            continue
        for third in (6 - axes[0] - axes[1], axes[0]):
            if _has_no_twist(system, body, third):
                found.append(Joint(body.name, (axes[0], axes[1], third), tuple(angles), True))
                break
    return tuple(found[:MOST_JOINTS])


def _used_elsewhere(system: System, body: Body, angles: Sequence[str]) -> bool:
    """Whether an angle or its velocity is named anywhere but in the rotation of its body."""
    watched = {*angles, *map(velocity_name, angles)}
    others = [replace(x, rotation=Rotation()) if x is body else x for x in system.bodies]
    parts = (tuple(others), system.loads, system.prescribed)
    in_formulas = any(names(x) & watched for x in expressions(parts))
    return in_formulas or any(word in watched for word in _words(system.loads))


def _words(part: Any) -> list[str]:
    """The texts that a part of a system holds, names of coordinates among them."""
    if isinstance(part, str):
        return [part]
    if isinstance(part, tuple):
        return [word for item in part for word in _words(item)]
    if is_dataclass(part) and not isinstance(part, (type, Name)):
        return [w for item in fields(part) if item.name != "span" for w in _words(getattr(part, item.name))]
    return []


def _has_no_twist(system: System, body: Body, axis: int) -> bool:
    """Whether a further turn of the body about one of its axes changes neither T nor any force: proved in the ring."""
    extra = "twist"
    while extra in system.coordinates or any(extra in names(x) for x in expressions(system)):
        extra += "_"
    rotation = Rotation((*body.rotation.axes, axis), (*body.rotation.angles, Name(extra)))
    turned = replace(body, rotation=rotation, coordinates=(*body.coordinates, extra))
    wider = replace(system, bodies=tuple(turned if x is body else x for x in system.bodies))
    try:
        found = rest(wider)
        place = wider.coordinates.index(extra)
        # A force fixed in the body does no work in the twist, but it turns with it.
        if not found.forcing[place].is_zero() or any(found.ring.dependencies(f, (extra,)) for f in found.forcing):
            return False
        row = found.mass_matrix()[place]
    except Failure:
        return False
    return all(x.is_zero() for x in row)


def charts(first: Rest) -> tuple[Chart, ...]:
    """Charts that together cover every configuration once (but for what cannot be replaced)."""
    replaceable = joints(first.system, first.turning)
    found = []
    for choice in product((False, True), repeat=len(replaceable)):
        current = rest(_with_other_angles(first.system, replaceable, choice)) if any(choice) else first
        nonzero: list[Polynomial] = []
        restrictions: list[Polynomial] = []
        for joint, other in zip(replaceable, choice, strict=True):
            if other:
                seen = rows(current, joint)
                across = [k for k in (0, 1, 2) if k != (joint.axes[2] if joint.spinning else joint.axes[0]) - 1]
                first_axis, last_axis = joint.axes[0] - 1, joint.axes[2] - 1
                restrictions += [seen[k][first_axis] if joint.spinning else seen[last_axis][k] for k in across]
            else:
                nonzero.append(current.ring.generator(joint.singular_kind, joint.angles[1]))
        found.append(Chart(current, replaceable, choice, tuple(nonzero), tuple(restrictions)))
    return tuple(found)


def _with_other_angles(system: System, replaceable: Sequence[Joint], choice: Sequence[bool]) -> System:
    changed = {}
    for joint, other in zip(replaceable, choice, strict=True):
        if other:
            angles = tuple(Name(name) for name in joint.angles)
            changed[joint.body] = Rotation(joint.other_axes[: len(angles)], angles)
    bodies = (replace(x, rotation=changed[x.name]) if x.name in changed else x for x in system.bodies)
    return replace(system, bodies=tuple(bodies))


def rows(found: Rest, joint: Joint) -> tuple[tuple[Polynomial, ...], ...]:
    """The body's axes in components of the previous body: the rows of R."""
    return direction_cosines(found.ring, found.scene.motions[joint.body].turns)


def features(found: Rest, joint: Joint) -> tuple[Polynomial, ...]:
    """Direction cosines that tell the joint's steady configurations apart, whatever the angles."""
    seen = rows(found, joint)
    if joint.direction_only:
        return seen[joint.axes[2] - 1]
    if joint.spinning:
        return tuple(row[joint.axes[0] - 1] for row in seen)
    return tuple(x for row in seen for x in row)


def moments(found: Rest, joint: Joint) -> tuple[Polynomial, ...]:
    """The moment that three angles stand for, in the axes of the body and in those of the previous one.

    With the unit vectors w_i of the turns,  f_i = w_i . tau,  so
    tau = [f1 (w2 x w3) + f2 (w3 x w1) + f3 (w1 x w2)] / w1.(w2 x w3),
    and f and tau vanish together where the angles are regular.  Components for which the division does not come out are
    left out; they say nothing that f does not say, only more shortly.
    """
    ring, turns = found.ring, found.scene.motions[joint.body].turns
    if len(joint.angles) != 3 or len(turns) != 3 or joint.direction_only or joint.spinning:
        return ()
    axes = [axis_vector(ring, turn.axis, ring.one) for turn in turns]
    f = [found.at_rest[found.system.coordinates.index(name)] for name in joint.angles]
    parts: list[Polynomial] = []
    for w in (
        [forward(ring, turns[k + 1 :], axis) for k, axis in enumerate(axes)],
        [back(ring, turns[:k], axis) for k, axis in enumerate(axes)],
    ):
        total = ring.zero_vector
        for k in range(3):
            total = ring.add(total, ring.scale(f[k], ring.cross(w[(k + 1) % 3], w[(k + 2) % 3])))
        volume = ring.dot(w[0], ring.cross(w[1], w[2]))
        square = ring.reduce(volume * volume)
        quotients = [ring.quotient(ring.reduce(ring.times(x, volume)), square) for x in total]
        parts += [x for x in quotients if x is not None]
    return tuple(parts)
