"""Other rotation sequences of a spinning body, in which the same steady motion may have a steady first approximation.

A body that turns steadily about one axis of its joint, its other angles being zero, stands the same way whatever the
order of the turns, and about whichever axes the others are.  The deviations do not: small angles that follow the spin
turn with it, those that come before it stay behind, and with a body that is not symmetric the coefficients then vary
with time; with two turns about one axis the angles are singular there, at rest, too.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import permutations

from mbsym.expressions.angles import angle_name
from mbsym.expressions.tree import ZERO, Expression, names
from mbsym.mechanics.motion import motion_values
from mbsym.mechanics.variables import expressions
from mbsym.model.system import Body, Rotation, System, velocity_name


@dataclass(frozen=True)
class Reordered:
    """``system`` with the turns of one body in another order; ``axes`` and ``angles`` are the new sequence."""

    system: System
    body: str
    axes: tuple[int, ...]
    angles: tuple[str, ...]


def rotation_orders(system: System) -> Iterator[Reordered]:
    """The other sequences of every joint that spins about one axis, those first in which the spin comes first.

    The joint's angles must be coordinates that occur nowhere else, in no constraint either, at rest at zero but for the
    one that spins; all of them may rest where two turns are about one axis.
    """
    for body in system.bodies:
        spin = _spin(system, body)
        if spin is None:
            continue
        for order in _orders(body, spin):
            axes = tuple(axis for axis, _ in order)
            turned = replace(body, rotation=Rotation(axes, tuple(angle for _, angle in order)))
            bodies = tuple(turned if other is body else other for other in system.bodies)
            angles = tuple(str(angle_name(angle)) for _, angle in order)
            yield Reordered(replace(system, bodies=bodies), body.name, axes, angles)


def _orders(body: Body, spin: str) -> list[tuple[tuple[int, Expression], ...]]:
    """The turns in other orders; about the three different axes where one of them occurs twice.

    What spins, or the first turn at rest, keeps its axis.
    """
    turns = declared = tuple(zip(body.rotation.axes, body.rotation.angles, strict=True))
    if len({axis for axis, _ in turns}) < len(turns) == 3:
        first = next(turn for turn in turns if angle_name(turn[1]) == spin)
        others = [angle for _, angle in turns if angle_name(angle) != spin]
        left = [axis for axis in (1, 2, 3) if axis != first[0]]
        turns = (first, *zip(left, others, strict=True))
    orders = [order for order in permutations(turns) if order != declared]
    return sorted(orders, key=lambda order: [angle_name(angle) for _, angle in order].index(spin))


def _spin(system: System, body: Body) -> str | None:
    """The only angle of a joint that turns steadily, the others being zero; None where it is not so.

    The first angle where all are zero at rest and two turns are about one axis.
    """
    angles = [angle_name(angle) for angle in body.rotation.angles]
    if len(angles) < 2 or not {*angles} <= {*body.coordinates} or len({*angles}) < len(angles):
        return None
    own = {name for name in angles if name is not None}
    hidden = own | {velocity_name(name) for name in own}
    bodies = (replace(other, rotation=Rotation((), ())) if other is body else other for other in system.bodies)
    elsewhere = (*bodies, *system.loads, *system.constraints)
    if any(hidden & names(x) for part in elsewhere for x in expressions(part)):
        return None
    if any(own & {*load.coordinates} for load in system.loads):  # a spring on an angle is one of this sequence
        return None
    motion = motion_values(system)
    spinning = [name for name in own if motion[name][1] != ZERO]
    at_zero = all(motion[name][0] == ZERO for name in own if name not in spinning)
    if not spinning and len({*body.rotation.axes}) < len(angles):
        spinning = [name for name in angles[:1] if name is not None]
    return spinning[0] if len(spinning) == 1 and at_zero else None
