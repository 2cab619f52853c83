"""The trade of one scenario as a whole: reference, ladders of settings, simpler models."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from mbsym.numerics import fidelity
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.fidelity import ModelError
from mbsym.numerics.methods.interface import Method
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.reference import reference
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.sizes import motion_sizes
from mbsym.numerics.tradeoff import Tradeoff, tradeoff

#: Solutions are compared at these 64ths of the time: unevenly, for whole periods show little of an error.
PLACES = (0, 7, 13, 22, 30, 37, 45, 54, 64)

#: The reference may take so many seconds, or as many as the budget has.
LEAST_FOR_REFERENCE = 30.0


@dataclass(frozen=True)
class Study:
    """What accuracy costs, and what simpler models cost in accuracy (none where that was not asked for)."""

    trade: Tradeoff
    models: tuple[ModelError, ...]


def studied(
    scenario: Scenario,
    methods: Sequence[Method],
    end: float,
    budget: float,
    with_models: bool,
    watch: Callable[[str], None] = lambda text: None,
) -> Study:
    """The study from 0 to ``end``, in about ``budget`` seconds beside those of the reference.

    Raises Breakdown where there is no reference solution up to ``end``, Failure where the equations have no program.
    """
    times = [end * place / PLACES[-1] for place in PLACES]
    dynamics = Dynamics(scenario)
    watch("reference solution")
    sizes = motion_sizes(dynamics, end)
    truth = reference(
        dynamics,
        times,
        budget=max(LEAST_FOR_REFERENCE, budget),
        watch=lambda t: watch(f"reference solution, t = {t:.4g} of {end:g}"),
        scale=sizes,
    )
    trade = tradeoff(dynamics, methods, truth, budget, watch)
    models: tuple[ModelError, ...] = ()
    if with_models and not trade.interrupted:
        models = fidelity.measured(scenario, METHODS["dop853"], times, watch, sizes)
    return Study(trade, models)
