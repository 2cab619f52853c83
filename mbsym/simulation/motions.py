"""What single motions are like: periodic ones near a guess, and how fast others part from one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaints
from mbsym.expressions.tree import Expression, names
from mbsym.model.system import System
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.interface import Breakdown, Method, Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.orbits.lyapunov import Exponents, exponents
from mbsym.numerics.orbits.periodic import Guess, NotFound, Orbit, autonomous, conserves_energy, periodic_orbit
from mbsym.numerics.orbits.variational import Gradient, Variational, gradient_at_end, sensitive, split
from mbsym.numerics.planning.sizes import scaled, sizes_of_scene
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.scenario import scenario as scenario_of
from mbsym.numerics.simulate import integrated
from mbsym.numerics.states import dynamics_of
from mbsym.simulation.request import TOLERANCE, Request
from mbsym.simulation.run import prepared
from mbsym.simulation.sampling import SAMPLES, sample_times

#: Rows of a period that are shown, the first one twice, and intervals between orthogonalisations.
ROWS, INTERVALS = 421, 400

#: A motion runs through itself so many times in its period if it differs by less, as part of its extent, and of its
#: size, that of what rests but for roundings being what the scene would move it by.
REPEATED, ROUNDED, AT_MOST = 1e-7, 1e-10, 12


@dataclass(frozen=True)
class PeriodicMotion:
    """A periodic motion, and one period of it: ``states`` (2n, m) at ``times``, measured by ``sizes`` (2n,)."""

    scenario: Scenario
    orbit: Orbit
    times: Any
    states: Any
    sizes: Any

    @property
    def repeats(self) -> int:
        """How many times the motion runs through itself in its period: the most of 2 to ``AT_MOST`` that is seen, or 1.

        The rows are compared with those a part of the period later, so parts that do not divide them are not looked at.
        """
        extent = np.ptp(self.states, axis=1)[:, None]
        bound = REPEATED * extent + ROUNDED * self.sizes[:, None]
        revolutions = np.round(self.orbit.turns / (2 * np.pi))
        for n in range(AT_MOST, 1, -1):
            later, rest = divmod(ROWS - 1, n)
            if rest or np.any(revolutions % n):
                continue
            moved = self.states[:, later:] - self.states[:, :-later] - (self.orbit.turns / n)[:, None]
            if np.all(np.abs(moved) <= bound):
                return n
        return 1


def find_orbit(
    scenario: Scenario,
    period: float,
    keep: str = "auto",
    turns: Mapping[str, int] | None = None,
    watch: Callable[[int, float], None] = lambda k, size: None,
    shifted: Sequence[str] = (),
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
    guess = Guess(state, period, dict(turns or {}), tuple(shifted), keep == "period", energy)
    orbit: Orbit = periodic_orbit(dynamics, guess, watch=watch)
    times = np.linspace(0.0, orbit.period, ROWS)
    run = METHODS["dop853"].start(dynamics, Setting(1e-13), initial=orbit.state)
    states = np.array(run.fill(times))
    sizes = scaled(np.max(np.abs(states), axis=1), sizes_of_scene(dynamics, times, states))
    return PeriodicMotion(scenario, orbit, times, states, sizes)


def lyapunov_exponents(
    scenario: Scenario,
    time: float,
    every: float | None = None,
    count: int | None = None,
    tolerance: float = 1e-10,
    watch: Callable[[float], None] = lambda t: None,
) -> Exponents:
    """The exponents of the scenario's motion from 0 to ``time``; see ``mbsym.numerics.orbits.lyapunov``."""
    return exponents(Dynamics(scenario), time, every or time / INTERVALS, count, tolerance, watch)


def gradient_of(
    system: System, values: Mapping[str, Expression], functional: str, variables: Sequence[str], time: float
) -> Gradient:
    """See ``mbsym.numerics.orbits.variational``; raises ValueError for what cannot be read or differentiated by."""
    complaints = Complaints()
    tree = parse_expression(functional, complaints)
    known = {*system.coordinates, *system.velocities, *system.parameter_names, "pi"}
    wrong = [item.message for item in complaints.items]
    wrong += [f"unknown name {name}" for name in sorted((names(tree) if tree is not None else set()) - known)]
    following = {relation.name for relation in system.relations}
    wrong += [f"there is nothing called {name} to differentiate by" for name in variables if name not in known - {"pi"}]
    wrong += [f"{name} follows from other parameters" for name in variables if name in following]
    if wrong or tree is None:
        raise ValueError("; ".join(wrong))
    return gradient_at_end(scenario_of(system, values), tree, variables, time, values)


# How a motion answers to changes of its initial state and of parameters, along the whole of it.


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
    automatic = request.method == "auto" or METHODS[request.method].traits.conservative
    name = "dop853" if automatic else request.method
    method = METHODS[name]
    step = request.step if method.traits.fixed else None
    tolerance = None if step is not None else request.tolerance or TOLERANCE["float64"]
    times = sample_times(request, 0.0, scenario.system)
    if request.every is None and request.samples is None and step is None:
        times = np.linspace(0.0, request.time, SAMPLES)
    setting = Setting(tolerance, step, request.step_limit, request.longest)
    solution = integrated(augmented, method, setting, times)
    states, values = split(solution.states, len(scenario.state))
    error = _error(augmented, method, setting, solution) if solution.breakdown is None else float("nan")
    return Sensitivities(scenario.system, tuple(names), solution.times, states, values, name, error, solution.breakdown)


def _error(augmented: Variational, method: Method, setting: Setting, solution: Any) -> float:
    if setting.tolerance is not None and setting.tolerance < FINEST:
        return float("nan")
    finer = Setting(
        None if setting.tolerance is None else setting.tolerance / FINER,
        None if setting.step is None else setting.step / 2,
        4 * setting.step_limit,
        setting.longest,
    )
    better = integrated(augmented, method, finer, solution.times)
    if better.breakdown is not None:
        return float("nan")
    states, values = split(better.states, len(augmented.states))
    differences = np.max(np.abs(values - split(solution.states, len(states))[1]), axis=2)
    own = np.max(np.abs(values), axis=2)
    # What rests but for rounding answers by rounding: it is measured by what the others' answers come to.
    scene = sizes_of_scene(dynamics_of(augmented.base.scenario), solution.times, states)
    sizes = scaled(np.max(np.abs(states), axis=1), scene)
    usual = sizes * np.max(own / sizes, axis=1, keepdims=True)
    return float(np.max(differences / scaled(own, usual, differences), initial=0.0))
