"""The run that others are judged by: the same equations so finely that its own error counts for little.

Tolerances fall by ``APART`` until two runs in a row differ by so little that the finer one, whose error is that
difference times what the last such step brought, is good enough.  Where float64 no longer brings anything, the
arithmetic of more digits goes on.  No step is longer than a part of the whole, lest short events be stepped over twice.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np

from mbsym.numerics.kernels.interface import EXTENDED, FLOAT64
from mbsym.numerics.kernels.llvm import available
from mbsym.numerics.methods.interface import Method, Setting
from mbsym.numerics.planning.pilot import AIM, USUAL_SLOPE, Bench, Trial, finest

#: The ratio of tolerances, what it brings until that is measured, and the least that counts as progress.
APART, USUAL_GAIN, LEAST_GAIN = 1e-2, 0.05, 0.5

#: The error of the reference beside what it judges.
KNOWN = 0.03

#: No step of the reference is longer than this part of the time.
PARTS = 2_000

#: The longest step falls, too: two runs whose steps it rules would else be one and the same.
SHORTER = 0.7

#: A run with fewer steps than so many times the least number is ruled by the longest step.
MOSTLY = 1.2

#: Rounding in extended arithmetic beside that in float64.
MORE_DIGITS = 2.0**-11

#: Runs further apart than this part of the motion tell nothing of how rounding counts.
COARSE = 0.03

#: Beyond so many operations nothing is compiled in extended arithmetic.
LONG = 20_000


@dataclass(frozen=True)
class Yardstick:
    """``quantities`` (2n + 1, m) of the finest run; ``known``: its own error as a part of the targets (rho).

    ``start`` is the tolerance at which rho is about what is aimed at, by the runs on the way.
    """

    quantities: Any
    known: float
    method: str
    scalar: str
    setting: Setting
    cost: float
    start: float


def yardstick(bench: Bench, method: Method, tolerance: float, goal: float) -> Yardstick:
    """A reference for settings that are to reach rho <= ``goal``; the finest that there is where none is good enough.

    Raises Breakdown where a run does not come to the end.
    """
    longest = float(bench.times[-1]) / PARTS
    if bench.longest is not None:  # a longer one would be cut to it in every run, and two of them be one run
        longest = min(longest, bench.longest)
    scalar, last, gain, rounding = FLOAT64, inf, USUAL_GAIN, 0.0
    before = bench.run(method, scalar, Setting(tolerance, longest=longest))
    best = _taken(before, inf, tolerance)
    while True:
        least = finest(method, scalar)
        stalled = last < inf and gain > LEAST_GAIN and last * bench.finest_target < COARSE
        if stalled or tolerance <= 2 * least:
            if scalar == EXTENDED or not _extended(bench, method):
                return best
            # Whatever of the last difference is rounding, grown along the motion, is smaller by the ratio of roundings.
            scalar, last, rounding = EXTENDED, inf, last * MORE_DIGITS if last < inf else inf
            least = finest(method, scalar)
        coarser, tolerance = tolerance, max(tolerance * APART, least)
        longest *= SHORTER
        now = bench.run(method, scalar, Setting(tolerance, longest=longest))
        apart, _ = bench.compared(before.states, now.states)
        gain = apart / last if 0 < last < inf else USUAL_GAIN
        less = max(min(gain, USUAL_GAIN), _ruled(now, longest, bench)) if gain <= LEAST_GAIN else 1.0
        known = max(apart * less, rounding)
        known = max(known, _roundings(scalar) / bench.finest_target)
        if known <= best.known:
            factor = (AIM * goal / apart) ** (1 / USUAL_SLOPE) if apart > 0 else 1.0
            best = _taken(now, known, max(coarser * min(factor, 1e3), least))
        if known <= KNOWN * goal:
            return best
        before, last = now, apart


def _ruled(trial: Trial, longest: float, bench: Bench) -> float:
    """What is left of the last difference where the longest step rules a run, not its tolerance; else 0.

    With steps h and s h, s = ``SHORTER``, and errors C h^p: the finer one has s^p/(1 - s^p) of the difference.
    """
    order = trial.method.traits.order or 1
    if trial.work.steps * longest < MOSTLY * float(bench.times[-1]):
        return float(SHORTER**order / (1 - SHORTER**order))
    return 0.0


def _taken(trial: Trial, known: float, start: float) -> Yardstick:
    name = trial.method.traits.name
    return Yardstick(trial.states, known, name, trial.scalar, trial.setting, trial.cost, float(f"{start:.1e}"))


def _roundings(scalar: str) -> float:
    """The rounding of one number: no run is better."""
    return float(np.finfo(np.longdouble if scalar == EXTENDED else float).eps) / 2


def _extended(bench: Bench, method: Method) -> bool:
    able = EXTENDED in method.traits.scalars and available(EXTENDED)
    return able and bench.dynamics.right_hand_side.operations <= LONG
