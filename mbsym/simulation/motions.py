"""What single motions are like: periodic ones near a guess, and how fast others part from one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.lyapunov import Exponents, exponents
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.periodic import Guess, NotFound, Orbit, autonomous, conserves_energy, periodic_orbit
from mbsym.numerics.scenario import Scenario

#: Rows of a period that are shown, and intervals between orthogonalisations.
ROWS, INTERVALS = 401, 400


@dataclass(frozen=True)
class PeriodicMotion:
    """A periodic motion, and one period of it: ``states`` (2n, m) at ``times``."""

    scenario: Scenario
    orbit: Orbit
    times: Any
    states: Any


def find_orbit(
    scenario: Scenario,
    period: float,
    keep: str = "auto",
    turns: Mapping[str, int] | None = None,
    watch: Callable[[int, float], None] = lambda k, size: None,
) -> PeriodicMotion:
    """The periodic motion near the scenario's initial state and near ``period``, and one period of it.

    ``keep``: energy, period, nothing, or auto (the energy where it is conserved).  Raises NotFound.
    """
    dynamics = Dynamics(scenario)
    conserved = autonomous(dynamics) and conserves_energy(dynamics)
    if keep == "energy" and not conserved:
        raise NotFound("the energy is not known to be conserved, so that it cannot be kept: --keep period or nothing")
    energy = keep in ("energy", "auto") and conserved
    state = np.array([float(x) for x in scenario.state])
    guess = Guess(state, period, dict(turns or {}), keep == "period", energy)
    found: Orbit = periodic_orbit(dynamics, guess, watch=watch)
    times = np.linspace(0.0, found.period, ROWS)
    run = METHODS["dop853"].start(dynamics, Setting(1e-13), initial=found.state)
    return PeriodicMotion(scenario, found, times, np.array(run.fill(times)))


def lyapunov_exponents(
    scenario: Scenario,
    time: float,
    every: float | None = None,
    count: int | None = None,
    tolerance: float = 1e-10,
    watch: Callable[[float], None] = lambda t: None,
) -> Exponents:
    """The exponents of the scenario's motion from 0 to ``time``; see ``mbsym.numerics.lyapunov``."""
    return exponents(Dynamics(scenario), time, every or time / INTERVALS, count, tolerance, watch)
