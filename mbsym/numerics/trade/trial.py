"""A trial: one way to integrate one model, how wrong that was, and what it cost.

    (model, method, setting, arithmetic)  ->  (error against a reference, counted work)

``tradeoff`` is a table of trials, ``--accuracy`` takes the cheapest that reaches its target, a model's error is a trial
of another model.  Whoever holds a trial against a reference fills in its error; a trial that does not come to the end
has none, and says why.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from math import inf
from typing import Any, Self

import numpy as np

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import FLOAT64
from mbsym.numerics.methods.interface import Breakdown, Cause, Method, Setting, Work
from mbsym.numerics.planning.prices import cost
from mbsym.numerics.trade.comparison import filled

#: A run with a limit is looked at in so many places, to see whether it costs too much.
LOOKS = 64


@dataclass(frozen=True)
class Candidate:
    """One way to integrate: a method in an arithmetic with a tolerance or a step."""

    method: Method
    scalar: str
    setting: Setting

    @property
    def label(self) -> str:
        """``dop853 1e-09``, ``rk4 h=0.001, float32``."""
        arithmetic = "" if self.scalar == FLOAT64 else f", {self.scalar}"
        return f"{self.method.traits.name} {self.shown}{arithmetic}"

    @property
    def shown(self) -> str:
        """The tolerance or the step."""
        if self.setting.step is not None:
            return f"h={self.setting.step:.3g}"
        decade = f"{self.setting.tolerance:.0e}"
        return decade if float(decade) == self.setting.tolerance else f"{self.setting.tolerance:.3g}"

    @property
    def fineness(self) -> float:
        """The tolerance, or the step."""
        fineness = self.setting.tolerance if self.setting.step is None else self.setting.step
        assert fineness is not None
        return fineness


@dataclass(frozen=True)
class Trial(Candidate):
    """What came of a candidate.

    ``error`` is the largest over all quantities and times of |x_i - reference_i|, each in parts of what it is measured
    by, ``errors`` (k,) the largest of each quantity; infinite, and None, as long as it is held against nothing.
    ``cost`` is that of its counted work (``planning.prices``), by which settings are chosen; ``seconds`` of the
    processor, compiling not counted, are told, and decide nothing.  ``states`` (k, m) are there as long as they are
    needed; ``trouble`` says why a run did not come to the end, as ``ended`` did.
    """

    work: Work
    cost: float = 0.0
    seconds: float = 0.0
    error: float = inf
    errors: Any = None
    states: Any = None
    trouble: str = ""
    ended: Breakdown | None = None

    def whole(self) -> Self:
        """The same.  Raises Breakdown where it did not come to the end."""
        if self.ended is not None:
            raise self.ended
        return self


def trial_of(
    method: Method, dynamics: Dynamics, setting: Setting, times: Any, scalar: str = FLOAT64, limit: float = inf
) -> Trial:
    """The states at increasing times from 0; a run that costs more than ``limit`` is given up.  Raises Unusable."""
    run = method.start(dynamics, setting, scalar)

    def spent() -> float:
        return cost(dynamics, method.traits.name, scalar, run.work)

    def reached(t: float) -> None:
        if t < times[-1] and spent() > limit:
            raise Breakdown(Cause.STEP_LIMIT, "too dear to be measured", t, run.state)

    started = time.thread_time()
    states, ended, trouble = None, None, ""
    try:
        looks = min(LOOKS, len(times) - 1) if limit < inf else 1
        states = np.ascontiguousarray(filled(run, times, looks, reached))
    except Breakdown as breakdown:
        ended, trouble = breakdown, breakdown.told
    seconds = time.thread_time() - started
    work = replace(run.work)
    return Trial(method, scalar, setting, work, spent(), seconds, states=states, trouble=trouble, ended=ended)
