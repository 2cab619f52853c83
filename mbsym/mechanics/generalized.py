"""Generalised forces of wrenches through partial velocities, in the ring.

Q_i = sum over bodies of  F . dV_O/dq'_i + M . domega/dq'_i
"""

from __future__ import annotations

from mbsym.algebra.ring import Polynomial, Ring
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import actions


def generalized_forces(scene: Scene) -> dict[str, Polynomial]:
    """Q_i, for every coordinate, of the loads that have no force function; the scene's algebra is the ring."""
    ring = scene.algebra
    assert isinstance(ring, Ring)
    totals = dict.fromkeys(scene.system.coordinates, ring.zero)
    for action in actions(scene, potential=False):
        for name, force in action.generalized.items():
            totals[name] = totals[name] + force
        for wrench in action.wrenches:
            motion = scene.motions[wrench.body]
            for name in totals:
                velocity = [ring.velocity_derivative(x, name) for x in motion.velocity_origin]
                spin = [ring.velocity_derivative(x, name) for x in motion.angular_velocity]
                power = ring.dot(wrench.force, velocity) + ring.dot(wrench.moment, spin)
                totals[name] = totals[name] + power
    return {name: ring.reduce(value) for name, value in totals.items()}
