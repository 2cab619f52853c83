"""Loads given by a formula: force functions, dissipation functions, generalised forces."""

from __future__ import annotations

from mbsym.algebra.base import Scalar
from mbsym.expressions.tree import differentiate, names, sticks, without_tables
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.interface import Action, Kind
from mbsym.model.system import ForceFunction, GeneralizedForce, Rayleigh, velocity_name


def _force_function(load: ForceFunction, scene: Scene) -> Scalar:
    value = scene.lower(load.expression)
    return -value if load.spelled == "potential" else value


def _force_function_action(load: ForceFunction, scene: Scene) -> Action:
    """Q = dU/dq, differentiated as written."""
    sign = scene.algebra.number(-1 if load.spelled == "potential" else 1)
    forces = {}
    for name in scene.system.coordinates:
        if name in names(load.expression):
            slope = scene.lower(differentiate(load.expression, name))
            forces[name] = scene.algebra.times(sign, slope)
    return Action(generalized=forces)


FORCE_FUNCTION = Kind(_force_function_action, _force_function)


def _rayleigh_action(load: Rayleigh, scene: Scene) -> Action:
    """Q = -dR/dq'.  A kink of R in a velocity is dry friction, which holds there: its table becomes moduli."""
    present = names(load.expression)
    potential = without_tables(load.expression, sticks)
    forces = {
        name: -scene.lower(differentiate(potential, velocity_name(name)))
        for name in scene.system.coordinates
        if velocity_name(name) in present
    }
    return Action(generalized=forces)


RAYLEIGH = Kind(_rayleigh_action)


def _generalized_action(load: GeneralizedForce, scene: Scene) -> Action:
    return Action(generalized={name: scene.lower(value) for name, value in load.components})


GENERALIZED = Kind(_generalized_action)
