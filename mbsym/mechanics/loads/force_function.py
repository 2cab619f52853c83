"""A force function U(q, t), or a potential, given by a formula."""

from __future__ import annotations

from mbsym.algebra.base import S
from mbsym.expressions.tree import differentiate, names
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.interface import Action, Kind
from mbsym.model.loads import ForceFunction


def _force_function(load: ForceFunction, scene: Scene[S]) -> S:
    value = scene.lower(load.expression)
    return -value if load.spelled == "potential" else value


def _force_function_action(load: ForceFunction, scene: Scene[S]) -> Action[S]:
    """Q = dU/dq, differentiated as written."""
    sign = scene.algebra.number(-1 if load.spelled == "potential" else 1)
    forces = {}
    for name in scene.system.coordinates:
        if name in names(load.expression):
            slope = scene.lower(differentiate(load.expression, name))
            forces[name] = scene.algebra.times(sign, slope)
    return Action(generalized=forces)


KIND = Kind(_force_function_action, _force_function)
