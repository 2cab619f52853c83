"""A simulation to an accuracy: planned, run as planned, and held against an estimate that knows nothing of the plan."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import nullcontext
from dataclasses import replace
from math import isfinite

from mbsym.expressions.message import Message
from mbsym.model.system import System
from mbsym.numerics.accuracy import ErrorEstimate, Lacking, NoEstimate
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning.choice import rates
from mbsym.numerics.planning.models import Model
from mbsym.numerics.planning.plan import ENERGY, INTEGRATION, Accuracy, Bound, Plan
from mbsym.numerics.planning.plan_items import DOUBLED
from mbsym.numerics.planning.planning import FREE, Pins, planned
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.simulate import Rests, begins_in_equilibrium
from mbsym.numerics.states import dynamics_of
from mbsym.simulation.request import Request, wrong_with
from mbsym.simulation.result import Simulation
from mbsym.simulation.run import PLANNING, Recall, Stage, anew, prepared, simulate
from mbsym.simulation.sampling import sample_times

#: A run that its estimate finds too coarse is repeated with so much finer a setting, so many times at most.
FINER, REPEATS = {"tolerance": 0.1, "step": 0.5}, 2

#: Without an estimate for these reasons nothing shows that a run keeps its accuracy.  As fine as any run (FINEST) is no
#: such reason: its errors were measured for the plan.
UNSHOWN = (Lacking.TOO_LONG, Lacking.CUT, Lacking.BREAKS_DOWN, Lacking.INTERRUPTED, Lacking.CONTRADICTED)


def read_accuracy(system: System, accuracy: float | Mapping[str, float]) -> Accuracy:
    """An error for everything, or errors by quantity, for everything else by the name "".

    Raises ValueError with everything that is wrong.
    """
    errors = accuracy if isinstance(accuracy, Mapping) else {"accuracy": accuracy}
    known = ("", *system.coordinates, *system.velocities, ENERGY)
    wrong = [f"there is no quantity {name}" for name in errors if isinstance(accuracy, Mapping) and name not in known]
    wrong += [f"{name}: an error is between 0 and 0.5, not {x}" for name, x in errors.items() if not 0 < x <= 0.5]
    if wrong or not errors:
        raise ValueError("; ".join(wrong) or "no error is given")
    if not isinstance(accuracy, Mapping):
        return Accuracy(float(accuracy))
    return Accuracy(accuracy.get(""), {name: x for name, x in accuracy.items() if name})


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
    recall: Recall = anew,
) -> tuple[Plan, Request]:
    """The plan, measured or recalled, and the request that repeats its run without choosing anything.

    Raises ValueError for a request that cannot be met, Rests where nothing moves (any method, not one that was asked
    for, keeps every accuracy then), Breakdown where the motion does not come to the end, Failure.
    """
    wrong = list(wrong_with(replace(request, method="auto", tolerance=None, step=None)))
    if wrong:
        raise ValueError("; ".join(wrong))
    begun = prepared(scenario, replace(request, model=Model()))[0]
    dynamics = dynamics_of(begun)
    if request.method == "auto" and begins_in_equilibrium(dynamics):
        raise Rests
    frequency = rates(dynamics)[1]
    times = sample_times(replace(request, step=None, store=None), frequency, begun.system)
    pins = replace(pins, whole=request.whole, longest=request.longest)
    plan = recall("plan", scenario, request, (accuracy, pins), lambda: planned(begun, accuracy, times, pins, watch))
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
    recall: Recall = anew,
) -> Simulation:
    """The run of a plan.  Where its own estimate says that the accuracy is missed, a finer one, and a remark.

    A rest is exact without a plan.
    """
    # Who asks for an accuracy asks whether it is kept.
    request = replace(request, estimate=request.estimate is not False)
    try:
        with stage(PLANNING):
            plan, settled = plan_for(scenario, request, accuracy, pins, tried, recall)
    except Rests:
        return simulate(scenario, request, watch, stage, recall)
    run = simulate(scenario, settled, watch, stage, recall)
    for again in range(REPEATS + 1):
        finer = _finer(plan)
        last = again == REPEATS or pins.setting is not None or finer == plan.setting
        missed = _missed(plan, run, 1.0 if last else DOUBLED)
        if not missed:
            break
        if last:
            plan = replace(plan, contradicted=True, remarks=(*plan.remarks, missed))
            break
        missed = Message("[[missed]]: repeated more finely", missed=missed)
        plan = replace(plan, setting=finer, remarks=(*plan.remarks, missed))
        settled = replace(settled, tolerance=plan.setting.tolerance, step=plan.setting.step)
        run = simulate(scenario, settled, watch, stage, recall)
    if isinstance(run.error, NoEstimate) and run.error.why in UNSHOWN:
        plan = replace(plan, unshown=run.error.why)
    plan = replace(plan, bounds=tuple(_proved(bound, run) for bound in _raised(plan, run)))
    return replace(run, plan=plan, chosen=replace(run.chosen, why=Message("chosen for the accuracy asked for")))


def _raised(plan: Plan, simulation: Simulation) -> tuple[Bound, ...]:
    """The bounds; where the run's own estimate is more than what was measured for the plan, that takes its place.

    A single bound for everything is that of the quantity which now has the least room.
    """
    if not isinstance(simulation.error, ErrorEstimate):
        return plan.bounds
    errors = {difference.name: difference.largest / difference.scale for difference in simulation.error.quantities}
    others = {name: error for name, error in errors.items() if name not in plan.accuracy.named}
    bounds = []
    for bound in plan.bounds:
        if bound.quantity in plan.accuracy.named:
            bounds.append(_with_error(bound, errors.get(bound.quantity, 0.0)))
            continue
        worst = max(others, key=lambda name: others[name])
        least = max(bound.integrated, bound.total - bound.integrated)  # what the model alone makes stays of its own
        quantity = worst if others[worst] > least else bound.quantity
        bounds.append(_with_error(replace(bound, quantity=quantity), others[worst]))
    return tuple(bounds)


def _proved(bound: Bound, simulation: Simulation) -> Bound:
    """The bound with what the certificate proves of the run's error at the rows, where all of them are enclosed."""
    names = (*simulation.system.coordinates, *simulation.system.velocities)
    if simulation.certificate is None or not simulation.certificate.whole or bound.quantity not in names:
        return bound
    return replace(bound, proved=simulation.certificate.error_of(names.index(bound.quantity)))


def _with_error(bound: Bound, error: float) -> Bound:
    """The bound with so much more for the integration that it and the arithmetic hold twice the error."""
    known = bound.integrated
    if error <= known:
        return bound
    missing = DOUBLED * error - known
    shares = tuple(
        replace(share, error=share.error + missing) if share.name == INTEGRATION else share for share in bound.shares
    )
    return replace(bound, shares=shares)


def _missed(plan: Plan, simulation: Simulation, times: float) -> str:
    """What the estimate, so many times, says against the plan; empty where it agrees or there is none.

    A plan that does not reach its accuracy promises as many times less.
    """
    if not isinstance(simulation.error, ErrorEstimate):
        return ""
    names = [quantity.name for quantity in simulation.error.quantities]
    bound = plan.bound
    targets = plan.accuracy.targets(names) * max(1.0, bound.total / bound.target)
    for quantity, target in zip(simulation.error.quantities, targets, strict=True):
        error = quantity.largest / quantity.scale
        if isfinite(target) and times * error > target:
            more = Message("which is" if error > target else "and twice that is")
            text = "[[name]] was [[error]] wrong with [[how]] by the estimate of that run, [[more]] more than [[most]]"
            wrong, how = f"{error:.1e}", _shown(plan.setting)
            return Message(text, name=quantity.name, error=wrong, how=how, more=more, most=f"{target:.2g}")
    return ""


def _finer(plan: Plan) -> Setting:
    """A finer setting of the same method; the same where its arithmetic has none."""
    setting = plan.setting
    if setting.step is not None:
        return replace(setting, step=setting.step * FINER["step"])
    assert setting.tolerance is not None
    least = min(setting.tolerance, METHODS[plan.method].traits.finest(plan.scalar))
    return replace(setting, tolerance=float(f"{max(setting.tolerance * FINER['tolerance'], least):.1e}"))


def _shown(setting: Setting) -> str:
    if setting.step is not None:
        return Message("step [[step]]", step=f"{setting.step:g}")
    return Message("tolerance [[tolerance]]", tolerance=f"{setting.tolerance:g}")
