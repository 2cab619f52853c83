"""Kane's equations over the ring: inertia and loads projected on partial velocities with respect to the speeds.

    sum over bodies of  (F_k - F_loads) . dV_Ok/du_r + (N_k - M_loads) . domega_k/du_r  -  sum Q_i dq'_i/du_r  =  0

with F_k, N_k what the motion of body k needs (``newton_euler``), the loads' wrenches on the bodies, and what loads
exert directly on coordinates, Q_i.  For u = q' these are Lagrange's equations; for the components of an angular
velocity Euler's; in general the Boltzmann-Hamel equations.

Source: Kane & Levinson, Dynamics: Theory and Applications (1985), ch. 4 and 6 (F_r + F_r* = 0).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mbsym.algebra.ring import Polynomial
from mbsym.algebra.vectors import Vector
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.interface import Action
from mbsym.mechanics.loads.kinds import KINDS
from mbsym.mechanics.newton_euler import inertia_wrenches
from mbsym.mechanics.speeds import SpeedForm, Variable
from mbsym.model.system import Load

Wrenches = Mapping[str, tuple[Vector, Vector]]


@dataclass(frozen=True)
class Kane:
    """Generalised inertia and active forces with respect to each speed, in the order of the speeds."""

    form: SpeedForm
    scene: Scene

    def inertia(self) -> list[Polynomial]:
        """sum F_k . dV_Ok/du_r + N_k . domega_k/du_r: what the motion needs, in (s, u, u', t)."""
        return self._projected(inertia_wrenches(self.scene))

    def active(self, loads: Sequence[Load]) -> list[Polynomial]:
        """The generalised active forces of loads, in (s, u, t)."""
        return self.of([KINDS[type(load)].action(load, self.scene) for load in loads])

    def of(self, actions: Sequence[Action]) -> list[Polynomial]:
        """The same of what loads do."""
        ring = self.form.ring
        totals = [ring.zero for _ in self.form.speeds]
        for action in actions:
            for wrench in action.wrenches:
                own = self._projected({wrench.body: (wrench.force, wrench.moment)})
                totals = [a + b for a, b in zip(totals, own, strict=True)]
            for name, force in action.generalized.items():
                velocity = self.form.velocity(name)
                for r, u in enumerate(self.form.speeds):
                    totals[r] = totals[r] + ring.times(force, ring.derivative(velocity, u.name))
        return [ring.reduce(x) for x in totals]

    def _partial(self, velocity: Vector, u: Variable) -> Vector:
        """d velocity/du."""
        return velocity.map(lambda x: self.form.ring.derivative(x, u.name))

    def _projected(self, wrenches: Wrenches) -> list[Polynomial]:
        """Forces and moments about the origins of bodies on partial velocities."""
        ring = self.form.ring
        totals = []
        for u in self.form.speeds:
            total = ring.zero
            for name, (force, moment) in wrenches.items():
                motion = self.scene.motions[name]
                along, about = self._partial(motion.velocity_origin, u), self._partial(motion.angular_velocity, u)
                total = total + force.dot(along) + moment.dot(about)
            totals.append(ring.reduce(total))
        return totals
