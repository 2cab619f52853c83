"""The trade of one scenario as a whole: reference, simpler models, ladders of settings, for what the budget pays.

A budget is one of counted work (``mbsym.numerics.planning.prices``), so that the same is measured on every machine.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from mbsym.numerics.closing import begun
from mbsym.numerics.methods.interface import Method
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.states import dynamics_of
from mbsym.numerics.trade import fidelity
from mbsym.numerics.trade.fidelity import ModelError
from mbsym.numerics.trade.reference import IMPLICIT
from mbsym.numerics.trade.reference_search import whole_reference
from mbsym.numerics.trade.tradeoff import Tradeoff, tradeoff

#: The part of the budget that the search for a reference may cost, where nothing is found that much more, and what it
#: may cost in any case.
FOR_REFERENCE, MOST_FOR_REFERENCE, LEAST_FOR_REFERENCE = 0.6, 0.9, 15.0

#: Places at which models are compared; they differ smoothly.
PLACES = 500


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
    """The study from 0 to ``end``, for what ``budget`` pays (some more where that is too little for a reference).

    Of a system with constraints the initial state is the closest one that satisfies them; with speeds these are
    integrated.

    Raises NotClosed, Breakdown where there is no reference solution up to ``end``, Failure where the equations have no
    program.
    """
    scenario = begun(scenario).scenario
    dynamics = dynamics_of(scenario)
    watch("reference solution")
    usual, at_most = (max(LEAST_FOR_REFERENCE, part * budget) for part in (FOR_REFERENCE, MOST_FOR_REFERENCE))
    truth = whole_reference(dynamics, end, usual, watch, at_most)
    models: tuple[ModelError, ...] = ()
    if with_models:
        places = np.unique(np.linspace(0, len(truth.times) - 1, PLACES).astype(int))
        method = METHODS["lsoda" if truth.way == IMPLICIT else "dop853"]
        models = fidelity.measured(scenario, method, truth.times[places].tolist(), watch, truth.scale)
    return Study(tradeoff(dynamics, methods, truth, max(budget - truth.cost, 0.0), watch), models)
