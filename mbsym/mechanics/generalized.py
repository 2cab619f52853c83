"""Generalised forces of wrenches through partial velocities, in the ring.

Q_i = sum over bodies of  F . dV_O/dq'_i + M . domega/dq'_i
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from mbsym.algebra.ring import Polynomial, Ring
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import KINDS, actions
from mbsym.model.loads import Load


def generalized_forces(scene: Scene, loads: Sequence[Load] | None = None) -> dict[str, Polynomial]:
    """Q_i, for every coordinate, of some loads; else of those that have no force function.

    The scene's algebra is the ring.
    """
    ring = scene.algebra
    assert isinstance(ring, Ring)
    totals = dict.fromkeys(scene.system.coordinates, ring.zero)
    acting = actions(scene, potential=False) if loads is None else [KINDS[type(x)].action(x, scene) for x in loads]
    for action in acting:
        for name, force in action.generalized.items():
            totals[name] = totals[name] + force
        for wrench in action.wrenches:
            motion = scene.motions[wrench.body]
            for name in totals:
                along = partial(ring.velocity_derivative, name=name)
                velocity, spin = motion.velocity_origin.map(along), motion.angular_velocity.map(along)
                power = wrench.force.dot(velocity) + wrench.moment.dot(spin)
                totals[name] = totals[name] + power
    return {name: ring.reduce(value) for name, value in totals.items()}
