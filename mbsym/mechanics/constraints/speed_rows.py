"""The rows of constraints in speeds u and positions s, over the ring.

    position      f(s, t)                                       of a holonomic constraint, else None
    velocity      g = J u + j                     = df/dt       where there is an f
    acceleration  dg/dt = J u' + gamma,           gamma = dg/dt at u' = 0

Positions come from the geometry of the scene, rates from the derivation of the variables (e' = e x omega for unit
vectors); a material point has the velocity V + omega x c, V and omega in speeds: no angle is differentiated where none
is a variable.  J is read off g, which is linear in u.  Rows are those of ``rows``, in the same axes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from mbsym.algebra.ring import Polynomial
from mbsym.algebra.vectors import Vector
from mbsym.mechanics.constraints.rows import RowName, difference, normals
from mbsym.mechanics.constraints.seen import common_frame
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.speeds import SpeedForm
from mbsym.model.constraints import Coincide, Constraint, Distance, Parallel, Relation, Rolling, Velocity
from mbsym.model.system import INERTIAL, Point


@dataclass(frozen=True, slots=True)
class SpeedRow:
    """One scalar constraint: f, g, J by the speeds in their order, gamma."""

    name: RowName
    position: Polynomial | None
    velocity: Polynomial
    partials: tuple[Polynomial, ...]
    gamma: Polynomial


def speed_rows(form: SpeedForm, scene: Scene, names: Sequence[RowName]) -> tuple[SpeedRow, ...]:
    """The rows of these names; ``scene`` is that of the form, with bodies.  Raises NoClosedForm."""
    ring, found = form.ring, []
    for number in dict.fromkeys(name.constraint for name in names):
        constraint = form.system.constraints[number]
        holonomic = _positions(scene, constraint)
        velocities = _velocities(scene, constraint) if holonomic is None else [form.rate(f) for f in holonomic]
        for name in (one for one in names if one.constraint == number):
            k = max(name.component - 1, 0)
            g = ring.reduce(velocities[k])
            found.append(
                SpeedRow(
                    name,
                    None if holonomic is None else ring.reduce(holonomic[k]),
                    g,
                    tuple(ring.derivative(g, u.name) for u in form.speeds),
                    form.drift(g),
                )
            )
    return tuple(found)


def _positions(scene: Scene, constraint: Constraint) -> list[Polynomial] | None:
    """f of every row; None of a constraint that is given by velocities."""
    ring = scene.ring
    match constraint:
        case Coincide(first, second):
            return list(_pair(scene, first, second))
        case Distance(first, second, length):
            apart, long = _pair(scene, first, second), scene.lower(length)
            return [ring.times(ring.number(Fraction(1, 2)), apart.dot(apart) - ring.times(long, long))]
        case Parallel(first, second):
            frame = common_frame(scene, (first.body, second.body))
            other = scene.to_axes(scene.vector(second.direction, second.body), frame)
            own = (scene.vector(normal, first.body) for normal in normals(first.direction))
            return [scene.to_axes(normal, frame).dot(other) for normal in own]
        case Relation(left, right):
            return [scene.lower(difference(left, right))]
    return None


def _pair(scene: Scene, first: Point, second: Point) -> Vector:
    """r_1 - r_2 in the axes of the last frame that carries both."""
    frame = common_frame(scene, (first.body, second.body))
    a, b = (scene.position(scene.vector(x.position, x.body), frame) for x in (first, second))
    return a - b


def _velocities(scene: Scene, constraint: Constraint) -> list[Polynomial]:
    """g of every row of a constraint that is given by velocities."""
    if isinstance(constraint, Velocity):
        return [scene.lower(difference(constraint.left, constraint.right))]
    assert isinstance(constraint, Rolling)
    frame = common_frame(scene, (constraint.body, constraint.on, constraint.axes))
    arm = scene.vector(constraint.contact, constraint.axes)
    slip = _material(scene, constraint.body, arm, frame)
    if constraint.on != INERTIAL:
        centre, base = (scene.position(scene.zero(name), frame) for name in (constraint.body, constraint.on))
        slip = slip - _material(scene, constraint.on, centre + scene.to_axes(arm, frame) - base, frame)
    return list(slip)


def _material(scene: Scene, body: str, arm: Vector, frame: str) -> Vector:
    """V + omega x arm of the material point of a body, in the axes of ``frame``."""
    spin = scene.to_axes(scene.motions[body].angular_velocity, arm.frame)
    return scene.to_axes(_velocity(scene, body), frame) + scene.to_axes(spin.cross(arm), frame)


def _velocity(scene: Scene, body: str) -> Vector:
    """V of a body's origin, in the axes of the body that it is attached to.

    There nothing is turned forth and back: that this is nothing unit vectors do not know by themselves.
    """
    one = scene.motions[body].body
    before = one.attached_to
    relative = scene.vector([scene.rate(x) for x in one.connection_point], before)
    if before == INERTIAL:
        return relative
    parent = scene.motions[before]
    return relative + parent.velocity_origin + parent.angular_velocity.cross(scene.motions[body].offset)
