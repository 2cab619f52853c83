"""Many motions of one description: what varies becomes members, which are integrated side by side."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mbsym.expressions.tree import Expression
from mbsym.numerics.ensembles.ensemble import Ensemble, ensemble
from mbsym.numerics.ensembles.parametrised import parametrised
from mbsym.numerics.ensembles.variation import RANDOM, Variation, drawn, members
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.scenario import Scenario
from mbsym.simulation.request import TOLERANCE, Request
from mbsym.simulation.run import prepared
from mbsym.simulation.sampling import sample_times

#: Unless asked for otherwise: rows of the statistics.
SAMPLES = 201


@dataclass(frozen=True)
class Spread:
    """What is asked of an ensemble: a simulation (explicit methods only; ``auto`` means dop853), and what varies."""

    request: Request
    variations: Sequence[Variation]
    members: int | None = None
    seed: int = 1
    sampling: str = RANDOM


def simulate_many(
    scenario: Scenario,
    spread: Spread,
    overrides: Mapping[str, Expression] | None = None,
    threads: int | None = None,
    watch: Callable[[float], None] = lambda t: None,
) -> Ensemble:
    """The members' motions from 0 to ``time``, summed up at every sample.

    Raises Unvaried for what cannot be varied, Failure where there is no program for the equations.
    """
    request, system = spread.request, scenario.system
    begun = prepared(scenario, request)[0]
    values = drawn(system, spread.variations, spread.members, spread.seed, spread.sampling)
    names = [variation.name for variation in spread.variations]
    free = [name for name in names if name in system.parameter_names]
    population = members(parametrised(begun, free, overrides, request.fixed), names, values)
    method = "dop853" if request.method == "auto" else request.method
    fixed = request.step is not None
    tolerance = None if fixed else request.tolerance or TOLERANCE["float64"]
    setting = Setting(tolerance, request.step, request.step_limit, request.longest)
    return ensemble(population, method, setting, _times(request, begun), threads, watch)


def _times(request: Request, scenario: Scenario) -> Any:
    if request.every is None and request.samples is None and request.step is None:
        return np.linspace(0.0, request.time, SAMPLES)
    return sample_times(request, 0.0, scenario.system)
