"""A dissipation function R(q, q') given by a formula."""

from __future__ import annotations

from mbsym.algebra.base import S
from mbsym.expressions.tree import differentiate, names, sticks, without_tables
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.interface import Action, Kind
from mbsym.model.loads import Rayleigh
from mbsym.model.system import velocity_name


def _rayleigh_action(load: Rayleigh, scene: Scene[S]) -> Action[S]:
    """Q = -dR/dq'.  A kink of R in a velocity is dry friction, which holds there: its table becomes moduli."""
    present = names(load.expression)
    potential = without_tables(load.expression, sticks)
    forces = {
        name: -scene.lower(differentiate(potential, velocity_name(name)))
        for name in scene.system.coordinates
        if velocity_name(name) in present
    }
    return Action(generalized=forces)


KIND = Kind(_rayleigh_action)
