"""How a motion answers to changes of its initial state and of parameters, along the whole of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mbsym.expressions.tree import Expression
from mbsym.model.system import System
from mbsym.numerics.methods.interface import Breakdown, Method, Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.orbits.variational import Variational, sensitive, split
from mbsym.numerics.planning.sizes import scaled, sizes_of_scene
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.simulate import integrated
from mbsym.numerics.states import dynamics_of
from mbsym.simulation.request import TOLERANCE, Request
from mbsym.simulation.run import prepared
from mbsym.simulation.sampling import SAMPLES, sample_times

#: The derivatives are integrated once more with a tolerance so many times smaller (a step half as long).
FINER = 100

#: Below this tolerance nothing is finer.
FINEST = 1e-13


@dataclass(frozen=True)
class Sensitivities:
    """``states`` (2n, m) at ``times`` and their derivatives ``values`` (k, 2n, m) by ``names``.

    ``error`` is the largest difference from a finer integration, relative to each derivative's largest size; nan where
    it was not estimated.  ``ended`` says why they end early.
    """

    system: System
    names: tuple[str, ...]
    times: Any
    states: Any
    values: Any
    method: str
    error: float
    ended: Breakdown | None

    @property
    def quantities(self) -> tuple[str, ...]:
        """Coordinates and velocities."""
        return (*self.system.coordinates, *self.system.velocities)

    def __getitem__(self, pair: tuple[str, str]) -> Any:
        """d quantity / d name along the motion, shape (m,): ``found["theta1", "m1"]``."""
        quantity, name = pair
        return self.values[self.names.index(name), self.quantities.index(quantity)]


def sensitivities(
    scenario: Scenario, request: Request, names: Sequence[str], overrides: Mapping[str, Expression] | None = None
) -> Sensitivities:
    """The derivatives by ``names``; integrated by the method asked for, by dop853 where it is ``auto``.

    Raises ValueError for names by which nothing can be differentiated, Failure where there is no program.
    """
    scenario = prepared(scenario, request)[0]
    augmented = sensitive(scenario, names, overrides, request.fixed)
    name = request.method if request.method not in ("auto", "midpoint", "midpoint4", "midpoint6") else "dop853"
    method = METHODS[name]
    step = request.step if method.traits.fixed else None
    tolerance = None if step is not None else request.tolerance or TOLERANCE["float64"]
    times = sample_times(request, 0.0, scenario.system)
    if request.every is None and request.samples is None and step is None:
        times = np.linspace(0.0, request.time, SAMPLES)
    setting = Setting(tolerance, step, request.step_limit, request.longest)
    found = integrated(augmented, method, setting, times)
    states, values = split(found.states, len(scenario.state))
    error = _error(augmented, method, setting, found) if found.breakdown is None else float("nan")
    return Sensitivities(scenario.system, tuple(names), found.times, states, values, name, error, found.breakdown)


def _error(augmented: Variational, method: Method, setting: Setting, found: Any) -> float:
    if setting.tolerance is not None and setting.tolerance < FINEST:
        return float("nan")
    finer = Setting(
        None if setting.tolerance is None else setting.tolerance / FINER,
        None if setting.step is None else setting.step / 2,
        4 * setting.step_limit,
        setting.longest,
    )
    better = integrated(augmented, method, finer, found.times)
    if better.breakdown is not None:
        return float("nan")
    states, values = split(better.states, len(augmented.states))
    differences = np.max(np.abs(values - split(found.states, len(states))[1]), axis=2)
    own = np.max(np.abs(values), axis=2)
    # What rests but for rounding answers by rounding: it is measured by what the others' answers come to.
    scene = sizes_of_scene(dynamics_of(augmented.base.scenario), found.times, states)
    sizes = scaled(np.max(np.abs(states), axis=1), scene)
    usual = sizes * np.max(own / sizes, axis=1, keepdims=True)
    return float(np.max(differences / scaled(own, usual, differences), initial=0.0))
