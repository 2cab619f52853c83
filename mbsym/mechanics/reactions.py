"""What a joint transmits to its body: force and moment by the backward Newton-Euler recursion, over any scalar.

    R_k = sum over body k and all beyond it of  (F - loads - constraint forces),    moments about O_k alike,

in the axes of body k.  In them are the bearing's reaction and what is given by the joint's coordinates (a spring, a
damper, a generalised force), not loads that are wrenches on bodies, two neighbours or not.  Constraint forces enter by
their multipliers, M q'' = f + J^T lambda: R = R_0 + sum lambda_i R_i.

===========  ==========================================================================================
coincide     force lambda on the first point, the opposite one on the second
distance     force lambda (r_1 - r_2) on the first point, the opposite one on the second
parallel     moment lambda n x e on the first body (row n . e), the opposite one on the second
rolling      force lambda on the body at the contact, the opposite one on what it rolls on
relation,    no wrench: what they do acts on coordinates, that is in the joints
velocity
===========  ==========================================================================================

Components are those of the frame in which the rows are given (``mbsym.mechanics.constraints.rows``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mbsym.algebra.vectors import Vector, axis_vector
from mbsym.mechanics.constraints.rows import normals
from mbsym.mechanics.constraints.seen import common_frame
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.interface import Action, Wrench
from mbsym.mechanics.loads.kinds import actions
from mbsym.mechanics.newton_euler import inertia_wrenches
from mbsym.model.constraints import Coincide, Distance, Parallel, Rolling
from mbsym.model.system import INERTIAL
from mbsym.model.system import Vector as Expressions

Pair = tuple[Vector, Vector]


@dataclass(frozen=True, slots=True)
class Reaction:
    """Force and moment about O_k that the joint of ``body`` exerts on it, in its axes, without multipliers.

    ``per_multiplier`` has the same of each row asked for, for lambda = 1.
    """

    body: str
    force: Vector
    moment: Vector
    per_multiplier: tuple[Pair, ...]


def reactions(scene: Scene, bodies: Sequence[str], rows: Sequence[tuple[int, int]] = ()) -> tuple[Reaction, ...]:
    """The reactions of joints at the accelerations of the scene; ``rows`` are (constraint, component), from 0 and 1."""
    needed = _transmitted(scene, inertia_wrenches(scene), actions(scene))
    nothing = {name: (scene.zero(name), scene.zero(name)) for name in scene.motions}
    tied = [_transmitted(scene, nothing, [constraint_action(scene, *row)]) for row in rows]
    return tuple(Reaction(name, *needed[name], tuple(transmitted[name] for transmitted in tied)) for name in bodies)


def _transmitted(scene: Scene, wrenches: dict[str, Pair], supplied: Sequence[Action]) -> dict[str, Pair]:
    """What every joint has to transmit, from the tips to the base."""
    need = dict(wrenches)
    for action in supplied:
        for wrench in action.wrenches:
            force, moment = need[wrench.body]
            need[wrench.body] = force - wrench.force, moment - wrench.moment
    for name in reversed(scene.motions):
        motion = scene.motions[name]
        force, moment = need[name]
        parent = motion.body.attached_to
        if parent != INERTIAL:
            carried = scene.back(name, force)
            before = need[parent]
            need[parent] = before[0] + carried, before[1] + (scene.back(name, moment) + motion.offset.cross(carried))
    return need


def constraint_action(scene: Scene, number: int, component: int) -> Action:
    """The wrenches that one row of a constraint exerts at lambda = 1; ``component`` counts from 1 (0: the only one)."""
    constraint = scene.system.constraints[number]
    match constraint:
        case Coincide(first, second):
            frame = common_frame(scene, (first.body, second.body))
            force = axis_vector(scene.algebra, component, scene.algebra.one, frame)
            return _opposite(scene, [(first.body, first.position), (second.body, second.position)], force)
        case Distance(first, second, _):
            frame = common_frame(scene, (first.body, second.body))
            ends = [scene.position(scene.vector(x.position, x.body), frame) for x in (first, second)]
            return _opposite(scene, [(first.body, first.position), (second.body, second.position)], ends[0] - ends[1])
        case Parallel(first, second):
            return _twisting(scene, constraint, component)
        case Rolling():
            return _at_contact(scene, constraint, component)
    return Action()


def _opposite(scene: Scene, ends: Sequence[tuple[str, Expressions]], force: Vector) -> Action:
    """A force on the first point, the opposite one on the second."""
    wrenches = []
    for (body, position), push in zip(ends, (force, -force), strict=True):
        if body != INERTIAL:
            own = scene.to_axes(push, body)
            wrenches.append(Wrench(body, own, scene.vector(position, body).cross(own)))
    return Action(tuple(wrenches))


def _twisting(scene: Scene, constraint: Parallel, component: int) -> Action:
    """The moment n x e: the work of the row n . e along a turn theta of the first body is (theta x n) . e."""
    first, second = constraint.first, constraint.second
    frame = common_frame(scene, (first.body, second.body))
    n = scene.to_axes(scene.vector(normals(first.direction)[component - 1], first.body), frame)
    e = scene.to_axes(scene.vector(second.direction, second.body), frame)
    moment = n.cross(e)
    return Action(
        tuple(
            Wrench(body, scene.zero(body), scene.to_axes(twist, body))
            for body, twist in ((first.body, moment), (second.body, -moment))
            if body != INERTIAL
        )
    )


def _at_contact(scene: Scene, constraint: Rolling, component: int) -> Action:
    frame = common_frame(scene, (constraint.body, constraint.on, constraint.axes))
    force = axis_vector(scene.algebra, component, scene.algebra.one, frame)
    arm = scene.to_axes(scene.vector(constraint.contact, constraint.axes), frame)
    centre = scene.position(scene.zero(constraint.body), frame)
    wrenches = []
    for body, push, lever in (
        (constraint.body, force, arm),
        (constraint.on, -force, None),
    ):
        if body == INERTIAL:
            continue
        if lever is None:
            lever = centre + arm - scene.position(scene.zero(body), frame)
        wrenches.append(Wrench(body, scene.to_axes(push, body), scene.to_axes(lever.cross(push), body)))
    return Action(tuple(wrenches))
