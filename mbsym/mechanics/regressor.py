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
from typing import Generic

from mbsym.algebra.base import Algebra, S
from mbsym.algebra.vectors import Vector, axis_vector, symmetric_tensor
from mbsym.mechanics.articulation import (
    Articulation,
    Frame,
    MassProperties,
    mass_properties,
    nothing,
    shifted,
    split,
    turned_back,
)
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
        name
        for name, motion in scene.motions.items()
        if motion.inertia is not None or not scene.algebra.vanishes(motion.mass)
    )
    return tuple(Standard(name, kind) for name in weighty for kind in KINDS)


def values(scene: Scene[S]) -> dict[Standard, S]:
    """The parameters that the description gives its bodies."""
    parameter_values = {}
    for standard_parameter in standard_parameters(scene):
        own = mass_properties(scene, standard_parameter.body)
        if standard_parameter.kind == "m":
            parameter_values[standard_parameter] = own.mass
        elif standard_parameter.kind in KINDS[6:9]:
            parameter_values[standard_parameter] = own.first_moment[KINDS.index(standard_parameter.kind) - 6]
        else:
            i, j = _PAIRS[KINDS.index(standard_parameter.kind)]
            parameter_values[standard_parameter] = own.tensor[i][j]
    return {standard: scene.algebra.reduce(value) for standard, value in parameter_values.items()}


#: A parameter of an elementary frame: its number in the articulation, and which of KINDS.
Slot = tuple[int, str]


def regrouped(system: Articulation[S]) -> dict[Standard, dict[Slot, S]]:
    """Each parameter as a combination of parameters of frames that joints can feel, with constant coefficients.

    What a joint does not feel is moved towards the base: of a turn about the axis a the mass, h_a, and Jcc as the
    tensor with Jcc at (b, b) and (c, c); of a slide the tensor; all of what is fixed.  What reaches the ground has no
    effect.
    """
    algebra, combinations = system.algebra, dict[Standard, dict[Slot, S]]()
    for standard_parameter in standard_parameters(system.scene):
        shares = combinations[standard_parameter] = {}
        number = system.frame_of[standard_parameter.body]
        own = _unit(algebra, standard_parameter.kind, system.frames[number].name)
        while number >= 0:
            frame = system.frames[number]
            stays, leaves = _split(algebra, frame, own)
            for kind, x in _parts(stays):
                x = algebra.reduce(x)
                if not algebra.vanishes(x):
                    shares[number, kind] = x
            own = turned_back(algebra, leaves, frame)
            if frame.fixed_offset:
                own = shifted(algebra, own, frame.offset)
            number = frame.parent
    return combinations


def _unit(algebra: Algebra[S], kind: str, frame: str) -> MassProperties[S]:
    none = nothing(algebra, frame)
    if kind == "m":
        return MassProperties(algebra.one, none.first_moment, none.tensor)
    if kind in KINDS[6:9]:
        return MassProperties(
            algebra.zero, axis_vector(algebra, KINDS.index(kind) - 5, algebra.one, frame), none.tensor
        )
    i, j = _PAIRS[KINDS.index(kind)]
    rows = [
        [algebra.one if {k, m} == {i, j} and (k != m or i == j) else algebra.zero for m in range(3)] for k in range(3)
    ]
    return MassProperties(algebra.zero, none.first_moment, symmetric_tensor(algebra, rows, frame))


def _parts(x: MassProperties[S]) -> Iterator[tuple[str, S]]:
    yield from zip(KINDS, (x.tensor[i][j] for i, j in _PAIRS), strict=False)
    yield from zip(KINDS[6:9], x.first_moment, strict=True)
    yield "m", x.mass


def _split(algebra: Algebra[S], frame: Frame[S], own: MassProperties[S]) -> tuple[MassProperties[S], MassProperties[S]]:
    """What stays on a frame, and what its joint does not feel."""
    stays, leaves = split(algebra, frame, own)
    if frame.together or frame.fixed_turn or not frame.fixed_offset:
        return stays, leaves
    assert frame.turn is not None
    a = frame.turn.axis - 1
    b, c = (a + 1) % 3, (a + 2) % 3
    rows, round_ = [list(row) for row in own.tensor], own.tensor[c][c]
    rows[b][b], rows[c][c] = rows[b][b] - round_, algebra.zero
    leaving = [[round_ if i == j != a else algebra.zero for j in range(3)] for i in range(3)]
    return (
        MassProperties(stays.mass, stays.first_moment, symmetric_tensor(algebra, rows, frame.name)),
        MassProperties(leaves.mass, leaves.first_moment, symmetric_tensor(algebra, leaving, frame.name)),
    )


class Energies(Generic[S]):
    """What one unit of a frame's parameter adds to T, and to U of the uniform fields; frame after frame."""

    def __init__(self, system: Articulation[S]) -> None:
        self.system, self.algebra = system, system.algebra
        zero = system.scene.zero(INERTIAL)
        self._base = (zero, zero, -base_acceleration(system.scene), self.algebra.zero)
        self._known: dict[int, tuple[Vector[S], Vector[S], Vector[S], S]] = {}

    def _motion(self, number: int) -> tuple[Vector[S], Vector[S], Vector[S], S]:
        """(V, w, g) in the axes of a frame, and g.r of its origin."""
        if number < 0:
            return self._base
        if number not in self._known:
            frame = self.system.frames[number]
            velocity, spin, down, height = self._motion(frame.parent)
            carried = velocity + spin.cross(frame.offset) + frame.offset_rate
            turned = frame.out(spin)
            if frame.turn is not None:
                turned = turned + axis_vector(self.algebra, frame.turn.axis, frame.turn.rate, frame.name)
            height = height + down.dot(frame.offset)
            self._known[number] = frame.out(carried), turned, frame.out(down), height
        return self._known[number]

    def of(self, slot: Slot) -> tuple[S, S]:
        algebra = self.algebra
        (number, kind), half = slot, algebra.number(Fraction(1, 2))
        velocity, spin, down, height = self._motion(number)
        if kind == "m":
            return algebra.times(half, velocity.dot(velocity)), height
        if kind in KINDS[6:9]:
            k = KINDS.index(kind) - 6
            return velocity.cross(spin)[k], down[k]
        i, j = _PAIRS[KINDS.index(kind)]
        share = algebra.times(spin[i], spin[j])
        return algebra.times(half, share) if i == j else share, algebra.zero


def column(scene: Scene[S], accelerations: Accelerations[S], standard: Standard) -> tuple[S, ...]:
    """The column of Y that belongs to a parameter, at the state and accelerations of the scene's environment."""
    algebra, body = scene.algebra, standard.body
    spin, angular = scene.motions[body].angular_velocity, accelerations.angular[body]
    origin = accelerations.origin[body] + scene.to_axes(base_acceleration(scene), body)
    unit = algebra.one
    force = moment = scene.zero(body)
    if standard.kind == "m":
        force = origin
    elif standard.kind in KINDS[6:9]:
        h = axis_vector(algebra, KINDS.index(standard.kind) - 5, unit, body)
        force = angular.cross(h) + spin.cross(spin.cross(h))
        moment = h.cross(origin)
    else:
        i, j = _PAIRS[KINDS.index(standard.kind)]
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
