"""The Newton-Euler recursion over any scalar: generalised forces that a given motion needs.

Forwards, in each body's axes (turn by turn alpha <- C alpha + x'' e + omega x x' e):

    a_Ok = R (a_Oj + alpha_j x r + omega_j x (omega_j x r) + 2 omega_j x r' + r'')
    F_k  = m (a_Ok + alpha x c + omega x (omega x c))
    N_k  = Theta_O alpha + omega x (Theta_O omega + h) + m c x a_Ok        (h: gyrostatic moment)

and backwards: the joint must supply what the body and everything beyond it need less what the loads supply.  Its
projections on the joint's partial velocities are the residuals  M q'' - forcing.

``bias_forces`` is a second recursion for what kernels are made of, q'' = 0, and stays beside this one: it needs 2017
operations for the right-hand sides of the shipped systems where this one needs 2305, and 229 instead of 338 for the arm
of six joints (``tests/mechanics/test_two_recursions.py``).  This one takes any q'', and angular velocities and
accelerations that are given as such (speeds, reactions, inverse dynamics); the self-check compares both with
d'Alembert's principle.
"""

from __future__ import annotations

from typing import Generic

from mbsym.algebra.base import S
from mbsym.algebra.vectors import Vector, axis_vector
from mbsym.expressions.tree import differentiate, names
from mbsym.mechanics.frames import forward
from mbsym.mechanics.kinematics import BodyMotion, Scene
from mbsym.mechanics.loads.interface import Action
from mbsym.mechanics.loads.kinds import actions
from mbsym.model.system import INERTIAL


class Accelerations(Generic[S]):
    """alpha_k and a_Ok of every body, in its axes."""

    def __init__(self, scene: Scene[S]) -> None:
        self.scene = scene
        zero = scene.zero(INERTIAL)
        self.angular: dict[str, Vector[S]] = {INERTIAL: zero}
        self.origin: dict[str, Vector[S]] = {INERTIAL: zero}
        self.spin: dict[str, Vector[S]] = {INERTIAL: zero}
        for name, motion in scene.motions.items():
            self._step(name, motion)

    def _step(self, name: str, motion: BodyMotion[S]) -> None:
        scene, parent = self.scene, motion.body.attached_to
        algebra, r = scene.algebra, motion.offset
        spin, angular = self.spin[parent], self.angular[parent]
        first = [scene.rate(x) for x in motion.body.connection_point]
        relative_velocity = scene.vector(first, parent)
        second = scene.vector([scene.rate(x) for x in first], parent)
        at = self.origin[parent] + angular.cross(r)
        at = at + spin.cross(spin.cross(r))
        two = algebra.number(2)
        at = at + spin.cross(relative_velocity) * two
        self.origin[name] = forward(motion.turns, at + second, name)
        rotation = scene.given.get(name)
        if rotation is not None:
            self.spin[name], self.angular[name] = rotation.angular_velocity, rotation.angular_acceleration
            return
        for turn in motion.turns:
            rate = axis_vector(algebra, turn.axis, turn.rate, turn.frame)
            spin = turn.out(spin)
            angular = turn.out(angular) + spin.cross(rate)
            angular = angular + axis_vector(algebra, turn.axis, turn.second_rate, turn.frame)
            spin = spin + rate
        self.spin[name], self.angular[name] = spin.in_parallel(name), angular.in_parallel(name)


def origin_acceleration(scene: Scene[S], body: str) -> Vector[S]:
    """a_Ok of one body, in its axes."""
    return Accelerations(scene).origin[body]


def _inertia_wrench(
    scene: Scene[S], motion: BodyMotion[S], angular: Vector[S], origin: Vector[S]
) -> tuple[Vector[S], Vector[S]]:
    """(F, N): the rate of momentum, and of angular momentum referred to O_k."""
    algebra, inertia = scene.algebra, motion.inertia
    spin, centre = motion.angular_velocity, motion.mass_centre
    force = moment = scene.zero(motion.body.name)
    about_joint = motion.body.inertia is not None and motion.body.inertia.about == "joint"
    if not algebra.vanishes(motion.mass):
        at_centre = origin + (angular.cross(centre) + spin.cross(spin.cross(centre)))
        force = at_centre * motion.mass
        lever = origin if about_joint else at_centre
        moment = centre.cross(lever * motion.mass)
    if inertia is not None:
        moment = moment + inertia @ angular
        moment = moment + spin.cross(inertia @ spin)
    if motion.gyrostatic_moment is not None:
        moment = moment + spin.cross(motion.gyrostatic_moment)
    return force, moment


def inertia_wrenches(scene: Scene[S]) -> dict[str, tuple[Vector[S], Vector[S]]]:
    """(F, N) of every body, in its axes: what its motion needs, the moment about O_k."""
    accelerations = Accelerations(scene)
    return {
        name: _inertia_wrench(scene, motion, accelerations.angular[name], accelerations.origin[name])
        for name, motion in scene.motions.items()
    }


class Joints(Generic[S]):
    """Forces and moments that the joints must supply, body by body, and their projections on the coordinates."""

    def __init__(self, scene: Scene[S]) -> None:
        self.scene = scene
        self.force: dict[str, Vector[S]] = {name: scene.zero(name) for name in scene.motions}
        self.moment = dict(self.force)
        self.totals: dict[str, S] = dict.fromkeys(scene.system.coordinates, scene.algebra.zero)

    def need(self, body: str, force: Vector[S], moment: Vector[S]) -> None:
        self.force[body] = self.force[body] + force
        self.moment[body] = self.moment[body] + moment

    def supply(self, action: Action[S]) -> None:
        for name, value in action.generalized.items():
            self.totals[name] = self.totals[name] - value
        for wrench in action.wrenches:
            self.force[wrench.body] = self.force[wrench.body] - wrench.force
            self.moment[wrench.body] = self.moment[wrench.body] - wrench.moment

    def projections(self) -> dict[str, S]:
        """The backward recursion, from the tips to the base."""
        scene = self.scene
        for name in reversed(scene.motions):
            motion = scene.motions[name]
            force, moment = self.force[name], self.moment[name]
            carried = scene.back(name, force)
            self._project(motion, carried, moment)
            if motion.body.attached_to != INERTIAL:
                twist = scene.back(name, moment) + motion.offset.cross(carried)
                self.need(motion.body.attached_to, carried, twist)
        return {name: scene.algebra.reduce(value) for name, value in self.totals.items()}

    def _project(self, motion: BodyMotion[S], carried: Vector[S], moment: Vector[S]) -> None:
        """moment . (dx/dq) e_axis for each turn, force . dr/dq for a moving connection point."""
        algebra, lower, totals = self.scene.algebra, self.scene.lower, self.totals
        for turn in reversed(motion.turns):
            for name in names(turn.angle) & totals.keys():
                share = algebra.times(moment[turn.axis - 1], lower(differentiate(turn.angle, name)))
                totals[name] = totals[name] + share
            moment = turn.back(moment)
        for component, expression in zip(carried, motion.body.connection_point, strict=True):
            for name in names(expression) & totals.keys():
                share = algebra.times(component, lower(differentiate(expression, name)))
                totals[name] = totals[name] + share


def residuals(scene: Scene[S], loads: bool = True) -> dict[str, S]:
    """M q'' - forcing for every coordinate, at the state and accelerations of the scene's environment.

    With ``loads`` false the loads are left out: what remains is the inertia part alone.
    """
    joints = Joints(scene)
    for name, wrench in inertia_wrenches(scene).items():
        joints.need(name, *wrench)
    for action in actions(scene) if loads else []:
        joints.supply(action)
    return joints.projections()


def applied_forces(scene: Scene[S]) -> dict[str, S]:
    """The generalised forces of the loads that have no force function, by projection on the joints."""
    joints = Joints(scene)
    for action in actions(scene, potential=False):
        joints.supply(action)
    return {name: -value for name, value in joints.projections().items()}
