"""The rows of constraints in speeds u and positions s, over any scalar.

    position      f(s, t)                                       of a holonomic constraint, else None
    velocity      g = J u + j                     = df/dt       where there is an f
    acceleration  gamma = dg/dt at u' = 0,        dg/dt = J u' + gamma
    partials      J, the derivatives of g by the speeds

Positions come from the geometry of the scene, rates from the derivation of the variables (e' = e x omega for unit
vectors); a material point has the velocity V + omega x c, V and omega in speeds: no angle is differentiated where none
is a variable.  J is read off g, which is linear in u.  Rows are those of ``rows``, in the same axes.  Rates and
derivatives are those of polynomials over the ring, and of nodes over a program, where nothing is expanded.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction

from mbsym.algebra.base import Scalar
from mbsym.algebra.derivative import directional, jacobian
from mbsym.algebra.program import Node
from mbsym.algebra.vectors import Vector
from mbsym.mechanics.constraints.rows import Row, RowName, difference, normals, row_names
from mbsym.mechanics.constraints.seen import common_frame
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.speed_programs import SpeedProgram
from mbsym.mechanics.speeds import SpeedForm
from mbsym.model.constraints import Coincide, Constraint, Distance, Parallel, Relation, Rolling, Velocity, as_written
from mbsym.model.system import INERTIAL, Point


def speed_rows(form: SpeedForm, scene: Scene, names: Sequence[RowName]) -> tuple[Row, ...]:
    """The rows of these names over the ring; ``scene`` is that of the form, with bodies.  Raises NoClosedForm."""
    ring = form.ring
    return _rows(scene, names, form.drift, lambda g: tuple(ring.derivative(g, u.name) for u in form.speeds))


def state_rows(
    form: SpeedForm, lowered: SpeedProgram, selected: Sequence[tuple[int, int]] | None = None
) -> tuple[Row, ...]:
    """All rows, or those that are ``selected``, by (constraint, component), as nodes of the program."""
    program, scene, prescribed = lowered.program, lowered.scene, form.system.prescribed
    moving = [program.input(name) for name in (*(x.name for x in form.positions), *(x.name for x in prescribed), "t")]
    ways: list[Node] = [*lowered.rates, *(scene.lower(x.rate) for x in prescribed), program.one]
    speeds = [program.input(u.name) for u in form.speeds]
    names = [row_name for k, x in enumerate(form.system.constraints) for row_name in row_names(k, x)]
    names = [name for name in names if selected is None or (name.constraint, name.component) in selected]
    return _rows(
        scene,
        names,
        lambda x: directional(program, [x], moving, ways)[0],
        lambda g: jacobian(program, [g], speeds)[0],
    )


def _rows(
    scene: Scene,
    names: Sequence[RowName],
    rate: Callable[[Scalar], Scalar],
    slopes: Callable[[Scalar], tuple[Scalar, ...]],
) -> tuple[Row, ...]:
    """``rate`` is d/dt at u' = 0, ``slopes`` are the derivatives by the speeds."""
    reduce, rows = scene.algebra.reduce, []
    for number in dict.fromkeys(name.constraint for name in names):
        constraint = as_written(scene.system.constraints[number])
        holonomic = _positions(scene, constraint)
        velocities = _velocities(scene, constraint) if holonomic is None else [rate(f) for f in holonomic]
        for name in (row_name for row_name in names if row_name.constraint == number):
            k = max(name.component - 1, 0)
            g = reduce(velocities[k])
            rows.append(Row(name, None if holonomic is None else reduce(holonomic[k]), g, rate(g), slopes(g)))
    return tuple(rows)


def _positions(scene: Scene, constraint: Constraint) -> list[Scalar] | None:
    """f of every row; None of a constraint that is given by velocities."""
    algebra = scene.algebra
    match constraint:
        case Coincide(first, second):
            return list(_pair(scene, first, second))
        case Distance(first, second, length):
            apart, long = _pair(scene, first, second), scene.lower(length)
            return [algebra.times(algebra.number(Fraction(1, 2)), apart.dot(apart) - algebra.times(long, long))]
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


def _velocities(scene: Scene, constraint: Constraint) -> list[Scalar]:
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
    moving_body = scene.motions[body].body
    before = moving_body.attached_to
    relative = scene.vector([scene.rate(x) for x in moving_body.connection_point], before)
    if before == INERTIAL:
        return relative
    parent = scene.motions[before]
    return relative + parent.velocity_origin + parent.angular_velocity.cross(scene.motions[body].offset)
