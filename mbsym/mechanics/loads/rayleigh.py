"""A dissipation function R(q, q') given by a formula, or R(q, u), whose force on a speed u is -dR/du."""

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
    rates = {name: velocity_name(name) for name in scene.system.coordinates}
    rates |= {one.name: one.name for one in scene.system.speeds if scene.in_speeds}
    forces = {name: -scene.lower(differentiate(potential, rate)) for name, rate in rates.items() if rate in present}
    return Action(generalized=forces)


KIND = Kind(_rayleigh_action)
