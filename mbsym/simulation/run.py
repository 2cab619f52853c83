"""A simulation from a description to a result: method, times and error estimate are settled here.

    x' = rhs(t, x),   x = (q, q'),   from the initial state at t = 0 to ``time``

``simulate`` chooses what was not asked for (method, samples), leaves out of the integration what provably rests,
integrates, says of every energy and first integral how far it is known to be constant and how far the run keeps it, and
estimates the error of the run by a better one.  Nothing is printed or written; what is said about a result is said
where it is shown.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from mbsym.expressions.message import Message
from mbsym.model.states import described, in_states
from mbsym.numerics import simulate as integration
from mbsym.numerics.accuracy import ErrorEstimate, Lacking, NoEstimate, contradicted, estimated
from mbsym.numerics.closing import Closed, begun, moves, moving, shown
from mbsym.numerics.columns import columns
from mbsym.numerics.conservation import (
    Conservation,
    Measure,
    Standing,
    along,
    between_switches,
    confronted,
    energy_standing,
    invariants,
    standing,
    values,
    visited,
)
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.extremes.singular_positions import stepped_over
from mbsym.numerics.methods.interface import Method, Unusable
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning.models import LinearisedDynamics, droppable, linearised, scenario_of
from mbsym.numerics.planning.prices import cost
from mbsym.numerics.planning.reduced import reduced
from mbsym.numerics.planning.sizes import kinetic_between, kinetic_rounding
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.states import dynamics_of, state_names
from mbsym.numerics.tangent import on_tangent
from mbsym.numerics.watched import between_rows, nearest_to_singular
from mbsym.simulation.request import DECLARED, Request, wrong_with
from mbsym.simulation.result import Chosen, FollowedIntegral, Simulation
from mbsym.simulation.sampling import NOTHING_MOVES, chosen_for
from mbsym.simulation.watching import Watching

if TYPE_CHECKING:
    from mbsym.algebra.ring import Ring
    from mbsym.analysis import Analysis
    from mbsym.model.system import System
    from mbsym.numerics.constrained import Drift
    from mbsym.numerics.simulate import Trajectory


#: The error of a run that costs less (``mbsym.numerics.planning.prices``) is estimated without being asked for.
SOON_DONE = 2.0

#: That estimate may cost so much, or so many times as much as the run.
LEAST, AT_MOST = 5.0, 4.0

#: What ``simulate`` is doing, for whoever watches.
COMPILING, INTEGRATING, ESTIMATING, CERTIFYING = "compiling", "integrating", "estimating", "certifying"
PLANNING = "planning"

#: Is told what is being done, for as long as it takes.
Stage = Callable[[str], AbstractContextManager[object]]

T = TypeVar("T")


class Recall(Protocol):
    """``measure()``, or what an earlier command measured: ``what``, of the same scenario, request and ``how``."""

    def __call__(self, what: str, scenario: Scenario, request: Request, how: object, measure: Callable[[], T]) -> T: ...


def anew(what: str, scenario: Scenario, request: Request, how: object, measure: Callable[[], T]) -> T:
    """Nothing was measured before."""
    return measure()


def simulate(
    scenario: Scenario,
    request: Request,
    watch: Callable[[float], None] = lambda t: None,
    stage: Stage = lambda what: nullcontext(),
    recall: Recall = anew,
) -> Simulation:
    """Integrates a scenario; its error is estimated, or recalled.

    What ends a run early (a blow-up, a singular mass matrix, a step limit, Ctrl-C) is part of the result.  Raises
    ValueError for a request that cannot be met (NoEvent: a condition without a value), Unusable where the method asked
    for does not apply, Failure where there is no program for the equations, or a division by zero in them at these
    values, NotAnalytic where a certificate is asked for and the equations have no power series.
    """
    wrong = list(wrong_with(request))
    if wrong:
        raise ValueError("; ".join(wrong))
    original = scenario
    scenario, closed = prepared(scenario, request)
    with stage(COMPILING):
        analysis = _analysis(scenario) if request.invariants else None
        integrals, missing = _integrals(analysis, scenario)
        ring = analysis.ring if analysis is not None and not missing else None
        dynamics = _dynamics(scenario, ring, request)
        if request.certify is not None:
            from mbsym.numerics.enclosure.compare import analytic  # few ask for an enclosure

            analytic(dynamics)
        resting = None if request.model.linear else reduced(dynamics)
        chosen = chosen_for(dynamics, request, None if request.whole else resting)
        watching = Watching(dynamics, chosen.method, request.events) if request.events else None
    method = chosen.method if watching is None else watching.method
    with stage(INTEGRATING):
        motion = _trajectory(dynamics, method, chosen, request, watch, integrals)
    happened = None
    if watching is not None:
        motion, happened = watching.happened(motion)
    between = motion.between or kinetic_between(dynamics, motion, chosen.completed)
    begin = float(motion.times[0]), motion.states[:, 0]
    motion = replace(motion, between=between, rounding=kinetic_rounding(dynamics, *begin))
    error: ErrorEstimate | NoEstimate = NoEstimate(Lacking.NOT_ASKED if motion.whole else Lacking.NOT_WHOLE)
    with stage(ESTIMATING):
        held = resting.names if resting is not None and resting.proved else ()
        dense = between_rows(dynamics, motion, chosen.method, request.arithmetic)
        pivot = nearest_to_singular(dynamics, motion, dense, chosen.method, request.arithmetic)
        motion, dense = replace(motion, least_pivot=pivot), replace(dense, least_pivot=pivot)
        both = energies(dynamics, dense, held)
        followed = kept_integrals(dynamics, motion, integrals, held, dense)
        own = cost(dynamics, motion.method, request.arithmetic, motion.work)
        if chosen.why == NOTHING_MOVES:
            error = NoEstimate(Lacking.NOTHING)
        elif motion.whole and (request.estimate or (request.estimate is None and own < SOON_DONE)):
            limit = inf if request.estimate else max(LEAST, AT_MOST * own)
            how = dynamics, motion, chosen.method, request.arithmetic, chosen.completed, limit
            known = recall if request.estimate else anew  # to look for a short one takes longer than to make it
            error = known("estimate", original, request, None, lambda: estimated(*how))
    if both[0].standing is Standing.PROVED and contradicted(error, both[0].change):
        error = NoEstimate(Lacking.CONTRADICTED)
    certificate = None
    if request.certify is not None:
        from mbsym.numerics.enclosure.compare import certified

        with stage(CERTIFYING):
            seen = None if happened is None else happened.occurrences
            certification = (request.certify, request.certify_seconds, request.certify_limit)
            certificate = certified(dynamics, motion.times, motion.states, *certification, watch, seen)
    return Simulation(
        *(scenario, dynamics, request, chosen, motion, *both, followed, error, missing),
        *(certificate, happened, original, None, closed),
        None if closed is None else drift_along(dynamics, motion),
        () if dynamics.constraints is None else stepped_over(dynamics, dense.times, dense.states, motion.work.singular),
    )


def prepared(scenario: Scenario, request: Request) -> tuple[Scenario, Closed | None]:
    """The scenario in the variables of its run, of the request's model, on its constraints; and how it was led there.

    A model that leaves out what constraints and speeds do not hold begins where the whole one does.  Raises as
    ``simulate``.
    """
    system, model = scenario.system, request.model
    later = set(model.without) <= set(droppable(system))
    scenario = scenario if later else scenario_of(scenario, model)
    refuse_in_run(system, request)
    closed = begun(scenario, request.fixed, request.variables == DECLARED)
    closed = moving(closed) if system.constraints else closed
    whole = scenario_of(closed.scenario, model) if later else closed.scenario
    if model.linear:
        whole = on_tangent(whole, request.fixed)
    if not system.constraints:
        return whole, None
    if model.linear:
        given = shown(scenario, request.variables == DECLARED)
        closed = replace(closed, scenario=whole, moves=moves(given, whole))
    return whole, closed


def runs_in_states(system: System, request: Request) -> bool:
    """Whether a run integrates the variables that a description declares."""
    return bool(system.speeds) and request.variables == DECLARED


def integrated_system(system: System, variables: str = DECLARED) -> System:
    """The system with the variables of a run in the place of coordinates and velocities.  Raises Failure."""
    if not system.speeds or variables != DECLARED:
        return system
    return in_states(system, *state_names(system))


def refuse_in_run(system: System, request: Request) -> None:
    """With speeds, raises Unusable for a method that does not know them."""
    if not runs_in_states(system, request):
        return
    if request.method in METHODS and METHODS[request.method].traits.conservative:
        text = "[[method]] integrates coordinates and their velocities only; this system has speeds"
        raise Unusable(Message(text, method=request.method))


def _dynamics(scenario: Scenario, ring: Ring | None, request: Request) -> Dynamics:
    return linearised(scenario, ring) if request.model.linear else dynamics_of(scenario, ring, request.whole)


def drift_along(dynamics: Dynamics, trajectory: integration.Trajectory) -> Drift | None:
    """How far the rows of a run stray from the constraints."""
    from mbsym.numerics.constrained import drift_of

    return drift_of(dynamics, trajectory.times, trajectory.states)


def _trajectory(
    dynamics: Dynamics,
    method: Method,
    chosen: Chosen,
    request: Request,
    watch: Callable[[float], None],
    integrals: tuple[Any, ...],
) -> integration.Trajectory:
    """The run; its rows in memory, or in the file that the request has for them."""
    if request.streams and request.store is not None and dynamics.constraints is None and not dynamics.in_states:
        from mbsym.numerics.streamed import streamed

        known = invariants(dynamics, integrals, columns(dynamics.system, dynamics.natural))
        way = (chosen.setting, chosen.times, request.store, request.arithmetic, watch)
        return streamed(dynamics, method, *way, along(known))
    before = None if request.earlier is None else request.earlier.states
    return integration.simulate(dynamics, method, chosen.setting, chosen.times, request.arithmetic, watch, before)


def _analysis(scenario: Scenario) -> Analysis:
    from mbsym.analysis import Analysis  # few runs ask for it

    return Analysis(described(scenario.system), (7,))


def _integrals(analysis: Analysis | None, scenario: Scenario) -> tuple[tuple[Any, ...], str]:
    """The first integrals of problem 7 but for the energy, those found besides at these numbers; why there are none."""
    if analysis is None:
        return (), ""
    from mbsym.analysis import Unavailable
    from mbsym.analysis.found import found_integrals
    from mbsym.problems.integrals import ENERGY

    try:
        known = tuple(item for item in analysis.integrals if item.kind != ENERGY)
        integrals = (*known, *found_integrals(analysis, scenario.parameters))
        return integrals, "" if integrals else "none is known beside the energy, which is watched in every run"
    except Unavailable as reason:
        return (), str(reason)


# How far a run keeps its energies and first integrals, and how it is known that they are constant.


def energies(dynamics: Dynamics, trajectory: Trajectory, held: Collection[str]) -> tuple[Conservation, Conservation]:
    """Of T2 - T0 - U, and of T - U; the coordinates ``held`` provably rest."""
    points = _seen(trajectory, "change", trajectory.change)
    scale, near = trajectory.energy_scale, _near(trajectory)
    if isinstance(dynamics, LinearisedDynamics):
        # The energy is that of the whole system, the motion that of the linear equations: no theorem joins them.
        known, doubt = standing(dynamics, dynamics.relative_energy, 0, points, held, near)
    else:
        known, doubt = energy_standing(dynamics, points, scale / max(float(trajectory.times[-1]), 1e-300), held, near)
    moving = Measure.KINETIC if trajectory.largest_kinetic else Measure.INITIAL
    measure = moving if moving is Measure.KINETIC or trajectory.generalized_energy[0] else Measure.UNIT
    if dynamics.natural:
        same = confronted("energy", known, trajectory.change, scale, doubt, measure)
        return same, same
    generalized = confronted("generalised energy", known, trajectory.change, scale, doubt, measure)
    known, doubt = standing(dynamics, dynamics.energies, 0, _seen(trajectory, "energy", trajectory.energy), held, near)
    return generalized, confronted("energy", known, trajectory.energy, scale, doubt, measure)


def _seen(motion: Trajectory, name: str, values: Any) -> Any:
    """States of a run at which a quantity changes most, and others: among all rows, where these are some of them."""
    return visited(motion.times, motion.states, values) if motion.table is None else motion.table.visited[name]


def _near(trajectory: Trajectory) -> list[list[float]]:
    """States beside the motion, where something acts for less than the distance of two rows."""
    met = trajectory.passed
    return [] if met is None else between_switches(trajectory.times, trajectory.states, met.switches, met.inside)


def kept_integrals(
    dynamics: Dynamics, trajectory: Trajectory, integrals: tuple[Any, ...], held: Collection[str], dense: Trajectory
) -> tuple[FollowedIntegral, ...]:
    """First integrals at the rows of ``trajectory``; judged along ``dense``, the same run with places between its rows.

    One that is not proved is looked at where the run goes.
    """
    if not integrals:
        return ()
    known = invariants(dynamics, integrals, columns(dynamics.system, dynamics.natural))
    shown, seen = (list(values(known, run.times, run.states)) for run in (trajectory, dense))
    followed = []
    for item, (column, _), (course, size) in zip(known, shown, seen, strict=True):
        state, doubt = Standing.PROVED, None
        if not item.proved or isinstance(dynamics, LinearisedDynamics):
            state, doubt = standing(dynamics, item.code, 0, _seen(dense, item.column, course), held, _near(dense))
        followed.append(
            FollowedIntegral(
                item.column, column, confronted(item.name, state, course, size, doubt, Measure.TERMS), item.unit
            )
        )
    return tuple(followed)
