"""Polar coordinates: the same places of all bodies at r, theta and at -r, theta + pi.

A length r along a direction that an angle theta turns is a polar coordinate: theta moves nothing at r = 0, where M(q)
is singular, and the states with r < 0 lie beyond that singularity.  With the reflection

    s:  r -> -r,  theta -> theta + pi,  r' -> -r'

they are states with r > 0 described a second time if s leaves the equations of motion as they are
(f_r -> -f_r, f_i -> f_i).  Where it does not, as with the spring law k (r - l0), bodies at the same places would feel
other forces: a description with r < 0 is not the system that is meant.
"""

from __future__ import annotations

from dataclasses import dataclass

from mbsym.algebra.failures import NOT_THERE
from mbsym.algebra.ring import Polynomial
from mbsym.algebra.vectors import axis_vector
from mbsym.mechanics.rest import Rest
from mbsym.model.system import INERTIAL


@dataclass(frozen=True)
class Reflection:
    """``length`` and ``angle`` are polar coordinates; ``same_forces``: the equations of motion do not change."""

    length: str
    angle: str
    same_forces: bool


def reflections(found: Rest) -> tuple[Reflection, ...]:
    """The pairs of polar coordinates of a system, proved in the ring; a length that belongs to two angles once."""
    ring, names = found.ring, found.system.coordinates
    angles = [x for x in names if ring.angles.get(x) == 1]
    made = []
    for length in (x for x in found.constant if x not in ring.angles):
        for angle in angles:
            try:
                if _moves_nothing(found, length, angle) and _same_places(found, length, angle):
                    made.append(Reflection(length, angle, _same_forces(found, length, angle)))
                    break
            except NOT_THERE:
                continue
    return tuple(made)


def reflected(found: Rest, x: Polynomial, length: str, angle: str) -> Polynomial:
    """x at -r, theta + pi, -r'."""
    ring = found.ring
    places = (("coordinate", length), ("velocity", length), ("sine", angle), ("cosine", angle))
    return ring.substitute(x, {ring.index(*place): -ring.generator(*place) for place in places})


def _moves_nothing(found: Rest, length: str, angle: str) -> bool:
    """Whether the row of ``angle`` in the mass matrix vanishes where the length does, and not everywhere."""
    ring = found.ring
    row = found.mass_matrix()[found.system.coordinates.index(angle)]
    zero = {ring.index("coordinate", length): ring.zero}
    return all(ring.substitute(x, dict(zero)).is_zero() for x in row) and any(not x.is_zero() for x in row)


def _same_places(found: Rest, length: str, angle: str) -> bool:
    """Whether no mass centre moves in the reflection, and no body that has an inertia turns."""
    ring, scene = found.ring, found.scene
    for body in found.system.bodies:
        motion = scene.motions[body.name]
        if motion.mass == 0 and motion.inertia is None:
            continue
        seen = list(scene.position(motion.mass_centre, INERTIAL))
        if motion.inertia is not None:
            axes = [axis_vector(ring, k, ring.one, body.name) for k in (1, 2)]
            seen += [x for axis in axes for x in scene.to_axes(axis, INERTIAL)]
        if any(ring.is_zero(reflected(found, x, length, angle) - x) is not True for x in seen):
            return False
    return True


def _same_forces(found: Rest, length: str, angle: str) -> bool:
    signs = {length: -1}
    ring = found.ring
    return all(
        ring.is_zero(reflected(found, f, length, angle) - signs.get(name, 1) * f) is True
        for name, f in zip(found.system.coordinates, found.forcing, strict=True)
    )
