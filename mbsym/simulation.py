"""A simulation from a description to a result: method, times and error estimate are settled here.

    x' = rhs(t, x),   x = (q, q'),   from the initial state at t = 0 to ``time``

``simulate`` chooses what was not asked for (method, samples), leaves out of the integration what provably rests,
integrates, says of every energy and first integral how far it is known to be constant and how far the run keeps it, and
estimates the error of the run by a better one.  Nothing is printed or written; what is said about a result is said
where it is shown.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from fractions import Fraction
from math import ceil, isfinite, pi
from typing import TYPE_CHECKING, Any

import numpy as np

from mbsym.analysis import Analysis, Unavailable
from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.tree import Expression, names, number
from mbsym.model.system import System
from mbsym.numerics import simulate as integration
from mbsym.numerics.accuracy import ErrorEstimate, Lacking, NoEstimate, contradicted, estimated
from mbsym.numerics.choice import choose, rates
from mbsym.numerics.columns import columns, most_rows
from mbsym.numerics.conservation import Conservation, Standing, confronted, energy_standing, standing, visited
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.invariants import invariants, values
from mbsym.numerics.methods.interface import Breakdown, Method, Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.reduced import Reduced, reduced
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.sizes import kinetic_between

if TYPE_CHECKING:
    from mbsym.numerics.simulate import Trajectory

#: Unless asked for otherwise: the local error, and samples (more of them where the motion is fast).
TOLERANCE = {"float64": 1e-10, "float32": 1e-5, "extended": 1e-14}
SAMPLES, MOST_SAMPLES, SAMPLES_A_PERIOD = 2001, 20_001, 100

#: The error of a run shorter than this many seconds is estimated without being asked for.
SOON_DONE = 2.0

#: What ``simulate`` is doing, for whoever watches.
COMPILING, INTEGRATING, ESTIMATING = "compiling", "integrating", "estimating"


@dataclass(frozen=True)
class Request:
    """What is asked for.

    ``samples`` rows from 0 to ``time``, or one ``every`` so often (by default as many as the motion needs); a method's
    name or ``auto``; a ``tolerance`` or, for methods of fixed step, a ``step``; ``invariants``: first integrals as
    well; ``estimate``: whether the error is estimated (None: if the run was short); ``whole``: what rests is
    integrated, too.
    """

    time: float
    samples: int | None = None
    every: float | None = None
    method: str = "auto"
    tolerance: float | None = None
    step: float | None = None
    arithmetic: str = "float64"
    step_limit: int = 10_000_000
    invariants: bool = False
    estimate: bool | None = None
    whole: bool = False


@dataclass(frozen=True)
class Chosen:
    """Everything settled before the first step; ``frequency`` is the greatest at the initial state, in rad per time.

    ``resting`` are the coordinates that rest; where that is proved, ``method`` integrates the others only.
    """

    method: Method
    why: str
    measured: str
    setting: Setting
    times: Any
    frequency: float
    resting: Reduced | None = None

    def completed(self, method: Method) -> Method:
        """Another method that integrates the same coordinates."""
        return method if self.resting is None or not self.resting.proved else self.resting.method(method)


@dataclass(frozen=True)
class Kept:
    """A first integral along a run: its column, its values (m,), how far it is conserved, its unit if that is known."""

    column: str
    values: Any
    conservation: Conservation
    unit: str | None = None


@dataclass(frozen=True)
class Simulation:
    """The result of ``simulate``.

    ``energy`` (T - U) and ``generalized_energy`` (T2 - T0 - U) are one quantity where nothing is prescribed;
    ``conservation`` is that of the latter and ``energy_conservation`` that of the former.
    """

    scenario: Scenario
    dynamics: Dynamics
    request: Request
    chosen: Chosen
    trajectory: Trajectory
    conservation: Conservation
    energy_conservation: Conservation
    invariants: tuple[Kept, ...]
    error: ErrorEstimate | NoEstimate
    no_invariants: str = ""

    @property
    def system(self) -> System:
        """What was simulated."""
        return self.scenario.system

    @property
    def times(self) -> Any:
        """The times of the samples, shape (m,)."""
        return self.trajectory.times

    @property
    def coordinates(self) -> Any:
        """q(t), shape (n, m), in the order of ``system.coordinates``."""
        return self.trajectory.states[: self.dynamics.size]

    @property
    def velocities(self) -> Any:
        """q'(t), shape (n, m)."""
        return self.trajectory.states[self.dynamics.size :]

    @property
    def energy(self) -> Any:
        """T - U, shape (m,)."""
        return self.trajectory.energy

    @property
    def generalized_energy(self) -> Any:
        """T2 - T0 - U, shape (m,)."""
        return self.trajectory.generalized_energy

    @property
    def method(self) -> str:
        """The name of the method."""
        return self.chosen.method.traits.name

    @property
    def why(self) -> str:
        """Why this method."""
        return self.chosen.why

    @property
    def arithmetic(self) -> str:
        """float64, float32 or extended."""
        return self.request.arithmetic

    @property
    def whole(self) -> bool:
        """Whether it reached the time asked for."""
        return self.trajectory.whole

    @property
    def ended(self) -> Breakdown | None:
        """Why it ended early."""
        return self.trajectory.breakdown

    def __getitem__(self, name: str) -> Any:
        """The samples of a coordinate, a velocity (``theta_dot``), a first integral's column, or ``t``; shape (m,).

        Raises KeyError for any other name.
        """
        if name == "t":
            return self.times
        rows = (*self.system.coordinates, *self.system.velocities)
        if name in rows:
            return self.trajectory.states[rows.index(name)]
        for kept in self.invariants:
            if kept.column == name:
                return kept.values
        raise KeyError(name)


def read_values(system: System, given: Mapping[str, Expression | Fraction | float | str]) -> dict[str, Expression]:
    """Values by name as expressions: numbers, or text such as ``pi/6`` made of numbers, pi and parameters.

    A name is that of a parameter, a coordinate (its initial position) or ``<coordinate>_dot`` (its initial velocity).
    Raises ValueError with everything that is wrong.
    """
    known = (*system.parameter_names, *system.coordinates, *system.velocities)
    found: dict[str, Expression] = {}
    wrong = [f"there is nothing called {name} to set" for name in given if name not in known]
    for name, value in given.items():
        complaints = Complaints()
        if isinstance(value, str):
            read = parse_expression(value, complaints, lambda start, end: Span(1, start + 1, max(1, end - start)))
            unknown = sorted(names(read) - {*system.parameter_names, "pi"}) if read is not None else []
            wrong += [f"{name} = {value}: {item.message}" for item in complaints.items]
            wrong += [f"{name} = {value}: unknown name {other}" for other in unknown]
            if read is not None:
                found[name] = read
        elif isinstance(value, (int, float, Fraction)):
            if not isfinite(value):
                wrong.append(f"{name} = {value} is no number")
            else:
                found[name] = number(Fraction(value))
        else:
            found[name] = value
    if wrong:
        raise ValueError("; ".join(wrong))
    return found


def _wrong(request: Request) -> Iterator[str]:
    """What cannot be done."""
    positive = {"time": request.time, "every": request.every, "tolerance": request.tolerance, "step": request.step}
    for name, value in positive.items():
        if value is not None and not (isfinite(value) and value > 0):
            yield f"{name} must be positive, not {value}"
    if request.samples is not None and request.samples < 2:
        yield f"samples must be 2 at least, not {request.samples}"
    if request.samples is not None and request.every is not None:
        yield "samples and every exclude each other"
    if request.step_limit < 1:
        yield f"step_limit must be 1 at least, not {request.step_limit}"
    if request.arithmetic not in TOLERANCE:
        yield f"there is no arithmetic {request.arithmetic}: choose from {', '.join(TOLERANCE)}"
    if request.method != "auto" and request.method not in METHODS:
        yield f"there is no method {request.method}: choose from auto, {', '.join(METHODS)}"
        return
    fixed = request.method != "auto" and METHODS[request.method].traits.fixed
    if fixed and request.step is None:
        yield f"{request.method} takes steps of one length: give a step"
    if not fixed and request.step is not None:
        yield f"{request.method} chooses its steps by a tolerance, not by a step"
    if fixed and request.tolerance is not None:
        yield f"{request.method} takes steps of one length, no tolerance"


#: Is told what is being done, for as long as it takes.
Stage = Callable[[str], AbstractContextManager[object]]


def simulate(
    scenario: Scenario,
    request: Request,
    watch: Callable[[float], None] = lambda t: None,
    stage: Stage = lambda what: nullcontext(),
) -> Simulation:
    """Integrates a scenario.

    What ends a run early (a blow-up, a singular mass matrix, a step limit, Ctrl-C) is part of the result.  Raises
    ValueError for a request that cannot be met, Unusable where the method asked for does not apply, Failure where there
    is no program for the equations, or a division by zero in them at these values.
    """
    wrong = list(_wrong(request))
    if wrong:
        raise ValueError("; ".join(wrong))
    with stage(COMPILING):
        analysis = Analysis(scenario.system, (7,)) if request.invariants else None
        integrals, missing = _integrals(analysis)
        dynamics = Dynamics(scenario, analysis.ring) if analysis is not None and not missing else Dynamics(scenario)
        resting = reduced(dynamics)
        chosen = _chosen(dynamics, request, None if request.whole else resting)
    with stage(INTEGRATING):
        found = integration.simulate(dynamics, chosen.method, chosen.setting, chosen.times, request.arithmetic, watch)
    found = replace(found, between=kinetic_between(dynamics, found, chosen.completed))
    error: ErrorEstimate | NoEstimate = NoEstimate(Lacking.NOT_ASKED if found.whole else Lacking.NOT_WHOLE)
    with stage(ESTIMATING):
        held = resting.names if resting is not None and resting.proved else ()
        energies = _energies(dynamics, found, held)
        kept = _kept(dynamics, found, integrals, held)
        if found.whole and (request.estimate or (request.estimate is None and found.seconds < SOON_DONE)):
            error = estimated(dynamics, found, chosen.method, request.arithmetic, chosen.completed)
    if energies[0].standing is Standing.PROVED and contradicted(error, energies[0].change):
        error = NoEstimate(Lacking.CONTRADICTED)
    return Simulation(scenario, dynamics, request, chosen, found, *energies, kept, error, missing)


def _integrals(analysis: Analysis | None) -> tuple[tuple[Any, ...], str]:
    """The first integrals of problem 7 but for the energy, and why there are none."""
    if analysis is None:
        return (), ""
    from mbsym.problems.integrals import ENERGY

    try:
        return tuple(item for item in analysis.integrals if item.kind != ENERGY), ""
    except Unavailable as reason:
        return (), str(reason)


# --- choosing ---


def _chosen(dynamics: Dynamics, request: Request, resting: Reduced | None) -> Chosen:
    taken = resting if resting is not None and resting.proved else None
    whole = dynamics if taken is None else taken.dynamics
    tolerance = request.tolerance or TOLERANCE[request.arithmetic]
    if request.method == "auto":
        choice = choose(whole, tolerance, request.time, request.arithmetic)
        method, why, measured, frequency = choice.method, choice.why, choice.measured, choice.frequency
    else:
        method, why, measured, frequency = METHODS[request.method], "as asked for", "", rates(whole)[1]
    setting = Setting(None if method.traits.fixed else tolerance, request.step, request.step_limit)
    if taken is not None:
        method = taken.method(method)
    times = sample_times(request, frequency, dynamics.system)
    return Chosen(method, why, measured, setting, times, frequency, resting)


def sample_times(request: Request, frequency: float, system: System) -> Any:
    """Times from 0 to the end, the end included: a hundred a period of the fastest oscillation, within bounds."""
    if request.every is not None:
        times = np.arange(ceil(request.time / request.every * (1 - 1e-12)) + 1) * request.every
        times[-1] = request.time
        return times
    if request.samples is not None:
        return np.linspace(0.0, request.time, request.samples)
    wanted = SAMPLES_A_PERIOD * frequency * request.time / (2 * pi)
    fitting = min(max(SAMPLES, int(min(wanted, MOST_SAMPLES))), MOST_SAMPLES, most_rows(system))
    if request.step is None:
        return np.linspace(0.0, request.time, fitting)
    # A method of fixed step knows nothing between its steps: rows stand at whole numbers of them, and at the end.
    steps = max(1, ceil(request.time / request.step * (1 - 1e-12)))
    apart = max(1, ceil(steps / (fitting - 1)))
    return np.append(np.arange(0, steps, apart) * request.step, request.time)


# --- what a run keeps ---


def _energies(dynamics: Dynamics, found: Trajectory, held: Collection[str]) -> tuple[Conservation, Conservation]:
    """Of T2 - T0 - U, and of T - U; the coordinates ``held`` provably rest."""
    points = visited(found.times, found.states, found.change)
    scale = found.energy_scale
    known, doubt = energy_standing(dynamics, points, scale / max(float(found.times[-1]), 1e-300), held)
    if dynamics.natural:
        same = confronted("energy", known, found.change, scale, doubt)
        return same, same
    generalized = confronted("generalised energy", known, found.change, scale, doubt)
    known, doubt = standing(dynamics, dynamics.energies, 0, visited(found.times, found.states, found.energy), held)
    return generalized, confronted("energy", known, found.energy, scale, doubt)


def _kept(dynamics: Dynamics, found: Trajectory, integrals: tuple[Any, ...], held: Collection[str]) -> tuple[Kept, ...]:
    """First integrals along the run; one that is not proved is looked at where the run goes."""
    known = invariants(dynamics, integrals, columns(dynamics.system, dynamics.natural)) if integrals else ()
    kept = []
    for item, (column, size) in zip(known, values(known, found.times, found.states), strict=True):
        state, doubt = Standing.PROVED, None
        if not item.proved:
            state, doubt = standing(dynamics, item.code, 0, visited(found.times, found.states, column), held)
        kept.append(Kept(item.column, column, confronted(item.name, state, column, size, doubt), item.unit))
    return tuple(kept)
