"""The Newton-Euler recursion over any scalar: generalised forces that a given motion needs.

Forwards, in each body's axes (turn by turn alpha <- C alpha + x'' e + omega x x' e):

    a_Ok = R (a_Oj + alpha_j x r + omega_j x (omega_j x r) + 2 omega_j x r' + r'')
    F_k  = m (a_Ok + alpha x c + omega x (omega x c))
    N_k  = Theta_O alpha + omega x (Theta_O omega + h) + m c x a_Ok        (h: gyrostatic moment)

and backwards: the joint must supply what the body and everything beyond it need less what the loads supply.  Its
projections on the joint's partial velocities are the residuals  M q'' - forcing.
"""

from __future__ import annotations

from mbsym.algebra.base import Scalar, Vector
from mbsym.expressions.tree import differentiate, names
from mbsym.mechanics.frames import axis_vector, back, forward, turn_back, turn_forward
from mbsym.mechanics.kinematics import BodyMotion, Scene
from mbsym.mechanics.loads.interface import Action
from mbsym.mechanics.loads.kinds import actions
from mbsym.model.system import INERTIAL


class _Accelerations:
    """alpha_k and a_Ok of every body, in its axes."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        zero = scene.algebra.zero_vector
        self.angular: dict[str, Vector] = {INERTIAL: zero}
        self.origin: dict[str, Vector] = {INERTIAL: zero}
        self.spin: dict[str, Vector] = {INERTIAL: zero}
        for name, motion in scene.motions.items():
            self._step(name, motion)

    def _step(self, name: str, motion: BodyMotion) -> None:
        algebra, parent = self.scene.algebra, motion.body.attached_to
        spin, angular = self.spin[parent], self.angular[parent]
        first = [self.scene.rate(x) for x in motion.body.connection_point]
        relative_velocity = self.scene.lower.vector(first)
        second = self.scene.lower.vector([self.scene.rate(x) for x in first])
        at = algebra.add(self.origin[parent], algebra.cross(angular, motion.offset))
        at = algebra.add(at, algebra.cross(spin, algebra.cross(spin, motion.offset)))
        at = algebra.add(at, algebra.scale(algebra.number(2), algebra.cross(spin, relative_velocity)))
        self.origin[name] = forward(algebra, motion.turns, algebra.add(at, second))
        for turn in motion.turns:
            rate = axis_vector(algebra, turn.axis, turn.rate)
            spin = turn_forward(algebra, turn, spin)
            angular = algebra.add(turn_forward(algebra, turn, angular), algebra.cross(spin, rate))
            angular = algebra.add(angular, axis_vector(algebra, turn.axis, turn.second_rate))
            spin = algebra.add(spin, rate)
        self.spin[name], self.angular[name] = spin, angular


def origin_acceleration(scene: Scene, body: str) -> Vector:
    """a_Ok of one body, in its axes."""
    return _Accelerations(scene).origin[body]


def _inertia_wrench(scene: Scene, motion: BodyMotion, angular: Vector, origin: Vector) -> tuple[Vector, Vector]:
    """(F, N): the rate of momentum, and of angular momentum referred to O_k."""
    algebra = scene.algebra
    spin, centre = motion.angular_velocity, motion.mass_centre
    force, moment = algebra.zero_vector, algebra.zero_vector
    about_joint = motion.body.inertia is not None and motion.body.inertia.about == "joint"
    if not algebra.vanishes(motion.mass):
        about_origin = algebra.add(algebra.cross(angular, centre), algebra.cross(spin, algebra.cross(spin, centre)))
        at_centre = algebra.add(origin, about_origin)
        force = algebra.scale(motion.mass, at_centre)
        lever = origin if about_joint else at_centre
        moment = algebra.cross(centre, algebra.scale(motion.mass, lever))
    if motion.inertia is not None:
        moment = algebra.add(moment, algebra.apply(motion.inertia, angular))
        moment = algebra.add(moment, algebra.cross(spin, algebra.apply(motion.inertia, spin)))
    if motion.gyrostatic_moment is not None:
        moment = algebra.add(moment, algebra.cross(spin, motion.gyrostatic_moment))
    return force, moment


class _Joints:
    """Forces and moments that the joints must supply, body by body, and their projections on the coordinates."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        zero = scene.algebra.zero_vector
        self.force: dict[str, Vector] = dict.fromkeys(scene.motions, zero)
        self.moment: dict[str, Vector] = dict.fromkeys(scene.motions, zero)
        self.totals: dict[str, Scalar] = dict.fromkeys(scene.system.coordinates, scene.algebra.zero)

    def need(self, body: str, force: Vector, moment: Vector) -> None:
        self.force[body] = self.scene.algebra.add(self.force[body], force)
        self.moment[body] = self.scene.algebra.add(self.moment[body], moment)

    def supply(self, action: Action) -> None:
        algebra = self.scene.algebra
        for name, value in action.generalized.items():
            self.totals[name] = self.totals[name] - value
        for wrench in action.wrenches:
            self.force[wrench.body] = algebra.subtract(self.force[wrench.body], wrench.force)
            self.moment[wrench.body] = algebra.subtract(self.moment[wrench.body], wrench.moment)

    def projections(self) -> dict[str, Scalar]:
        """The backward recursion, from the tips to the base."""
        algebra = self.scene.algebra
        for name in reversed(self.scene.motions):
            motion = self.scene.motions[name]
            force, moment = self.force[name], self.moment[name]
            carried = back(algebra, motion.turns, force)
            self._project(motion, carried, moment)
            if motion.body.attached_to != INERTIAL:
                twist = algebra.add(back(algebra, motion.turns, moment), algebra.cross(motion.offset, carried))
                self.need(motion.body.attached_to, carried, twist)
        return {name: algebra.reduce(value) for name, value in self.totals.items()}

    def _project(self, motion: BodyMotion, carried: Vector, moment: Vector) -> None:
        """moment . (dx/dq) e_axis for each turn, force . dr/dq for a moving connection point."""
        algebra, lower, totals = self.scene.algebra, self.scene.lower, self.totals
        for turn in reversed(motion.turns):
            for name in names(turn.angle) & totals.keys():
                share = algebra.times(moment[turn.axis - 1], lower(differentiate(turn.angle, name)))
                totals[name] = totals[name] + share
            moment = turn_back(algebra, turn, moment)
        for component, expression in zip(carried, motion.body.connection_point, strict=True):
            for name in names(expression) & totals.keys():
                share = algebra.times(component, lower(differentiate(expression, name)))
                totals[name] = totals[name] + share


def residuals(scene: Scene, loads: bool = True) -> dict[str, Scalar]:
    """M q'' - forcing for every coordinate, at the state and accelerations of the scene's environment.

    With ``loads`` false the loads are left out: what remains is the inertia part alone.
    """
    joints = _Joints(scene)
    accelerations = _Accelerations(scene)
    for name, motion in scene.motions.items():
        joints.need(name, *_inertia_wrench(scene, motion, accelerations.angular[name], accelerations.origin[name]))
    for action in actions(scene) if loads else []:
        joints.supply(action)
    return joints.projections()


def applied_forces(scene: Scene) -> dict[str, Scalar]:
    """The generalised forces of the loads that have no force function, by projection on the joints."""
    joints = _Joints(scene)
    for action in actions(scene, potential=False):
        joints.supply(action)
    return {name: -value for name, value in joints.projections().items()}
