"""A simulation to an accuracy: planned, run as planned, and held against an estimate that knows nothing of the plan."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import nullcontext
from dataclasses import replace
from math import isfinite

from mbsym.model.system import System
from mbsym.numerics.accuracy import ErrorEstimate
from mbsym.numerics.choice import rates
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.models import Model
from mbsym.numerics.plan import ENERGY, Accuracy, Plan
from mbsym.numerics.planning import FREE, Pins, planned
from mbsym.numerics.scenario import Scenario
from mbsym.simulation.request import Request, wrong_with
from mbsym.simulation.result import Simulation
from mbsym.simulation.run import Stage, simulate
from mbsym.simulation.sampling import sample_times

#: What is being done, for whoever watches.
PLANNING = "planning"

#: A run that its estimate finds too coarse is repeated with so much finer a setting, so many times at most.
FINER, REPEATS = {"tolerance": 0.1, "step": 0.5}, 2


def read_accuracy(system: System, given: float | Mapping[str, float]) -> Accuracy:
    """An error for everything, or errors by quantity.  Raises ValueError with everything that is wrong."""
    errors = given if isinstance(given, Mapping) else {"accuracy": given}
    known = (*system.coordinates, *system.velocities, ENERGY)
    wrong = [f"there is no quantity {name}" for name in errors if isinstance(given, Mapping) and name not in known]
    wrong += [f"{name}: an error is between 0 and 0.5, not {x}" for name, x in errors.items() if not 0 < x <= 0.5]
    if wrong or not errors:
        raise ValueError("; ".join(wrong) or "no error is given")
    return Accuracy(None, dict(given)) if isinstance(given, Mapping) else Accuracy(float(given))


def settled_by(request: Request) -> Pins:
    """What a request settles by itself; float64, which it has by default, settles nothing."""
    return Pins(
        model=None if request.model == Model() else request.model,
        method=None if request.method == "auto" else request.method,
        tolerance=request.tolerance,
        step=request.step,
        scalar=None if request.arithmetic == "float64" else request.arithmetic,
    )


def plan_for(
    scenario: Scenario,
    request: Request,
    accuracy: Accuracy,
    pins: Pins = FREE,
    watch: Callable[[str], None] = lambda text: None,
) -> tuple[Plan, Request]:
    """The plan, and the request that repeats its run without choosing anything.

    Raises ValueError for a request that cannot be met, Breakdown where the motion does not come to the end, Failure.
    """
    wrong = list(wrong_with(replace(request, method="auto", tolerance=None, step=None)))
    if wrong:
        raise ValueError("; ".join(wrong))
    frequency = rates(Dynamics(scenario))[1]
    times = sample_times(replace(request, step=None), frequency, scenario.system)
    plan = planned(scenario, accuracy, times, replace(pins, whole=request.whole, longest=request.longest), watch)
    rows = None if request.every is not None else len(times)
    settled = replace(
        request,
        samples=rows,
        method=plan.method,
        tolerance=plan.setting.tolerance,
        step=plan.setting.step,
        arithmetic=plan.scalar,
        model=plan.model,
    )
    return plan, settled


def simulate_accurately(
    scenario: Scenario,
    request: Request,
    accuracy: Accuracy,
    pins: Pins = FREE,
    watch: Callable[[float], None] = lambda t: None,
    stage: Stage = lambda what: nullcontext(),
    tried: Callable[[str], None] = lambda text: None,
) -> Simulation:
    """The run of a plan.  Where its own estimate says that the accuracy is missed, a finer one, and a remark."""
    with stage(PLANNING):
        plan, settled = plan_for(scenario, request, accuracy, pins, tried)
    found = simulate(scenario, settled, watch, stage)
    for again in range(REPEATS + 1):
        missed = _missed(plan, found)
        if not missed:
            break
        if again == REPEATS or pins.setting is not None:
            plan = replace(plan, contradicted=True, remarks=(*plan.remarks, missed))
            break
        missed += ": repeated more finely"
        plan = replace(plan, setting=_finer(plan.setting), remarks=(*plan.remarks, missed))
        settled = replace(settled, tolerance=plan.setting.tolerance, step=plan.setting.step)
        found = simulate(scenario, settled, watch, stage)
    return replace(found, plan=plan, chosen=replace(found.chosen, why="chosen for the accuracy asked for"))


def _missed(plan: Plan, found: Simulation) -> str:
    """What the estimate says against the plan; empty where it agrees or there is none.

    A plan that does not reach its accuracy promises as many times less.
    """
    if not isinstance(found.error, ErrorEstimate):
        return ""
    names = [quantity.name for quantity in found.error.quantities]
    bound = plan.bound
    targets = plan.accuracy.targets(names) * max(1.0, bound.total / bound.target)
    for quantity, target in zip(found.error.quantities, targets, strict=True):
        error = quantity.largest / quantity.scale
        if isfinite(target) and error > target:
            return (
                f"{quantity.name} was {error:.1e} wrong with {_shown(plan.setting)} by the estimate of that run, which "
                f"is more than {target:.0e}"
            )
    return ""


def _finer(setting: Setting) -> Setting:
    if setting.step is not None:
        return replace(setting, step=setting.step * FINER["step"])
    assert setting.tolerance is not None
    return replace(setting, tolerance=setting.tolerance * FINER["tolerance"])


def _shown(setting: Setting) -> str:
    return f"steps of {setting.step:g}" if setting.step is not None else f"tolerance {setting.tolerance:g}"
