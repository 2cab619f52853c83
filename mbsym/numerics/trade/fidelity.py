"""What a simpler model costs in accuracy: the same scenario with less of the mechanics in it.

``variants`` lists the models that a description allows:

* Newtonian gravity of order 2, 3, 4 (where such an expansion converges) and exact;
* without constraints and speeds, the equations linearised about the unperturbed motion,
  x' = x0' + J(t, x0) (x - x0)  with J = d rhs/dx;
* there, too, coordinates that rest taken out (a plane motion of a spatial system), which changes nothing but the cost.

``measured`` integrates each one far more accurately than models differ, and compares it with the most faithful one.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite
from typing import Any

import numpy as np

from mbsym.algebra.failures import Defect, Failure
from mbsym.expressions.message import Message, plainly
from mbsym.model.loads import EXACT, GRAVITY_ORDERS
from mbsym.model.states import InStates
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import FLOAT64
from mbsym.numerics.methods.interface import Method, Setting, Unusable, Work
from mbsym.numerics.planning.models import Model, modelled, orders
from mbsym.numerics.planning.reduced import Reduced, resting
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.separable import completing
from mbsym.numerics.states import dynamics_of
from mbsym.numerics.trade.trial import Trial, trial_of

#: Tolerance at which variants are integrated, and what differences below ``RESOLVED`` mean nothing.
TIGHT, RESOLVED = 1e-13, 1e-11

#: The label of the model that the description gives.
DESCRIBED = Message("as described")

#: Runs timed for each variant, and what they may cost together (``mbsym.numerics.planning.prices``).
REPEATS, MOST = 5, 2.0


@dataclass(frozen=True)
class Variant:
    """A model: ``rank`` orders models of one family by faithfulness (the largest is the most faithful).

    ``taken``: what rests, where that is taken out of the equations.
    """

    label: str
    neglected: str
    dynamics: Dynamics
    rank: int
    taken: Reduced | None = None


@dataclass(frozen=True)
class ModelError(Trial):
    """The error of a model against the most faithful one, and what it costs.

    ``model``, ``neglected`` and ``rank`` are those of its ``Variant``; ``operations`` those of one right-hand side;
    ``seconds`` of the processor the median for the same tolerance.
    """

    model: str = ""
    neglected: str = ""
    rank: int = 0
    operations: int = 0


def variants(scenario: Scenario) -> Iterator[Variant]:
    """Every model of the scenario, the given one first; those that cannot be derived are left out."""
    system = scenario.system
    fields = system.newtonian_fields
    faithful = min((GRAVITY_ORDERS.index(load.order) + 1 for load in fields), default=0)
    yield Variant(DESCRIBED, Message("nothing that the description has"), dynamics_of(scenario), faithful)
    for order in orders(scenario) if fields else ():
        if all(load.order == order for load in fields):
            continue
        dropped = Message("nothing of the field")
        if order != EXACT:
            dropped = Message("terms of the field above order [[order]] in size/R", order=order)
        model = Model(order)
        yield Variant(model.label, dropped, modelled(scenario, model), GRAVITY_ORDERS.index(order) + 1)
    if system.constraints or isinstance(system, InStates):
        return
    if system.motion:
        model, dropped = Model(linear=True), Message("all that is not linear in the deviation")
        yield Variant(model.label, dropped, modelled(scenario, model), -1)
    reduction = resting(scenario)
    if reduction is not None:
        names = ", ".join(reduction.values)
        dropped = Message("[[names]], which rest ([[how]])", names=names, how=reduction.how)
        taken = Reduced(dynamics_of(scenario), reduction, Dynamics(reduction.scenario))
        yield Variant(Message("without [[names]]", names=names), dropped, taken.dynamics, 0, taken)


def measured(
    scenario: Scenario,
    method: Method,
    times: Sequence[float],
    watch: Callable[[str], None] = lambda label: None,
    scale: Any | None = None,
) -> tuple[ModelError, ...]:
    """The error of every variant at ``times`` against the most faithful one, and its cost at a tight tolerance.

    The error is the largest difference over coordinates, velocities and times, each relative to ``scale``, shape (2n,);
    by default its largest value at the times.
    """
    rows = []
    for variant in variants(scenario):
        watch(variant.label)
        try:
            trial = _run(variant, method, times)
        except Exception as raised:  # whatever goes wrong with one model is told of that one
            reason = raised if isinstance(raised, (Failure, Unusable)) else Defect.of(raised)
            trial = Trial(method, FLOAT64, Setting(TIGHT), Work(), trouble=str(reason))
        operations = 0 if trial.states is None and trial.ended is None else variant.dynamics.right_hand_side.operations
        model, neglected, rank = variant.label, variant.neglected, variant.rank
        rows.append(ModelError(**vars(trial), model=model, neglected=neglected, rank=rank, operations=operations))
    solved = [row for row in rows if row.states is not None]
    if not solved:
        return ()
    truth = max(solved, key=lambda row: row.rank).states
    if scale is None:
        size = np.max(np.abs(truth), axis=1)
        scale = np.where(size > 0, size, 1.0)
    scale = np.asarray(scale)[:, np.newaxis]
    return tuple(replace(row, error=_error(row.states, truth, scale), states=None) for row in rows)


def _error(states: Any, truth: Any, scale: Any) -> float:
    largest = inf if states is None else float(np.max(np.abs(states - truth) / scale))
    return largest if isfinite(largest) else inf


def model_advice(models: Sequence[ModelError], target: float) -> str:
    """How far the model that was simulated is from the most faithful one; empty where that is the same or unknown."""
    own = next((row for row in models if row.model == DESCRIBED), None)
    best = max((row for row in models if not row.trouble), key=lambda row: row.rank, default=None)
    if own is None or best is None or best is own or own.trouble or not own.error > RESOLVED:
        return ""
    far, rich = f"{own.error:.1e}", best.model
    text = Message("The model as described is [[error]] away from [[model]]", error=far, model=rich)
    if own.error > target:
        said = "[[what]]: an error of [[target]] is one of its equations, not of the motion."
        return Message(said, what=text, target=plainly(target))
    return Message("[[what]], which adds to the error.", what=text)


def _run(variant: Variant, method: Method, times: Sequence[float]) -> Trial:
    """A run of a variant with the states of the whole system, and the median of the seconds of several."""
    taken, dynamics, inner, runs = variant.taken, variant.dynamics, method, list[Trial]()
    if taken is not None:
        inner, dynamics = completing(taken, method), taken.whole
    while not runs or (not runs[-1].trouble and len(runs) < min(REPEATS, MOST / runs[-1].cost)):
        runs.append(trial_of(inner, dynamics, Setting(TIGHT), times))
    return replace(runs[-1], method=method, seconds=statistics.median(run.seconds for run in runs))
