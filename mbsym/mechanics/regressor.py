"""What each of a body's ten inertial parameters does: to T and U, and to the generalised forces.

Of a body: mass m, first moment h = m c, tensor J about the origin O of its axes (J12, J13, J23 as in  T = w.J w/2).
T and U are linear in them, and so are the generalised forces that a motion needs, tau = Y theta:

    T = m V.V/2 + h.(V x w) + w.J w/2,      U = m g.r + h.g,      F = m a + A h,  N = h x a + J alpha + w x J w

with a the acceleration of O less g, A h = alpha x h + w x (w x h), all in the axes of the body.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from mbsym.algebra.base import S
from mbsym.algebra.vectors import Vector, axis_vector
from mbsym.mechanics.articulation import mass_properties
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import base_acceleration
from mbsym.mechanics.newton_euler import Accelerations, Joints
from mbsym.model.system import INERTIAL

#: The ten parameters of a body, in the order in which base parameters are chosen among them.
KINDS = ("Jxx", "Jxy", "Jxz", "Jyy", "Jyz", "Jzz", "hx", "hy", "hz", "m")
_PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))


@dataclass(frozen=True, slots=True)
class Standard:
    """One of a body's parameters; ``kind`` is one of KINDS."""

    body: str
    kind: str


def standard_parameters(scene: Scene[S]) -> tuple[Standard, ...]:
    """Ten of each body that has mass or inertia, body by body."""
    weighty = (
        name for name, one in scene.motions.items() if one.inertia is not None or not scene.algebra.vanishes(one.mass)
    )
    return tuple(Standard(name, kind) for name in weighty for kind in KINDS)


def values(scene: Scene[S]) -> dict[Standard, S]:
    """The parameters that the description gives its bodies."""
    found = {}
    for one in standard_parameters(scene):
        own = mass_properties(scene, one.body)
        if one.kind == "m":
            found[one] = own.mass
        elif one.kind in KINDS[6:9]:
            found[one] = own.first_moment[KINDS.index(one.kind) - 6]
        else:
            i, j = _PAIRS[KINDS.index(one.kind)]
            found[one] = own.tensor[i][j]
    return {one: scene.algebra.reduce(value) for one, value in found.items()}


def energies(scene: Scene[S]) -> Iterator[tuple[Standard, S, S]]:
    """Each parameter with what one unit of it adds to T, and to U of the uniform fields."""
    algebra = scene.algebra
    half, down = algebra.number(Fraction(1, 2)), -base_acceleration(scene)
    for body in dict.fromkeys(one.body for one in standard_parameters(scene)):
        motion = scene.motions[body]
        velocity, spin = motion.velocity_origin, motion.angular_velocity
        lever, weight = velocity.cross(spin), scene.to_axes(down, body)
        for kind, (i, j) in zip(KINDS, _PAIRS, strict=False):
            share = algebra.times(spin[i], spin[j])
            yield Standard(body, kind), algebra.times(half, share) if i == j else share, algebra.zero
        for k in range(3):
            yield Standard(body, KINDS[6 + k]), lever[k], weight[k]
        height = scene.position(scene.zero(body), INERTIAL).dot(down)
        yield Standard(body, "m"), algebra.times(half, velocity.dot(velocity)), height


def column(scene: Scene[S], found: Accelerations[S], one: Standard) -> tuple[S, ...]:
    """The column of Y that belongs to a parameter, at the state and accelerations of the scene's environment."""
    algebra, body = scene.algebra, one.body
    spin, angular = scene.motions[body].angular_velocity, found.angular[body]
    origin = found.origin[body] + scene.to_axes(base_acceleration(scene), body)
    unit = algebra.one
    force = moment = scene.zero(body)
    if one.kind == "m":
        force = origin
    elif one.kind in KINDS[6:9]:
        h = axis_vector(algebra, KINDS.index(one.kind) - 5, unit, body)
        force = angular.cross(h) + spin.cross(spin.cross(h))
        moment = h.cross(origin)
    else:
        i, j = _PAIRS[KINDS.index(one.kind)]
        moment = _swapped(scene, angular, i, j) + spin.cross(_swapped(scene, spin, i, j))
    joints = Joints(scene)
    joints.need(body, force, moment)
    needed = joints.projections()
    return tuple(needed[name] for name in scene.system.coordinates)


def _swapped(scene: Scene[S], v: Vector[S], i: int, j: int) -> Vector[S]:
    """J v for the tensor with ones at (i, j) and (j, i)."""
    parts = [scene.algebra.zero] * 3
    parts[i] = v[j]
    if i != j:
        parts[j] = v[i]
    return Vector(scene.algebra, (parts[0], parts[1], parts[2]), v.frame)
