"""Lyapunov exponents: how fast motions that begin close together part, over a finite time.

    Q_k R_k = Phi(t_k, t_k-1) Q_k-1,      lambda_i(T) = 1/T sum_k log |R_k,ii|

(Benettin, Galgani, Giorgilli & Strelcyn, Meccanica 15 (1980) 9).  These are numbers of a finite time: that a motion is
chaotic is proved by none of them.  The uncertainty is that of the mean, from the slowest cosines of the second half of
the time by Student's distribution (Lazarus, Lewis, Stock & Watson, J. Bus. Econ. Stat. 36 (2018) 541), and how much
farther the mean of that half is from that of the whole time than chance explains (the directions need a while to turn
where they grow most); it knows nothing of what comes later.  The sum of all exponents is checked against the mean
divergence of the equations, which is integrated without any Q or R (Liouville).

With constraints there are as many exponents as dimensions of what they allow: 2n less the independent rows on positions
and on velocities.  Changes keep the constraints, and the divergence is tr(P J), P the projection on such changes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from itertools import pairwise
from typing import Any

import numpy as np

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.interface import Breakdown, compiled_kernel
from mbsym.numerics.methods.magnitudes import about
from mbsym.numerics.orbits.periodic import autonomous
from mbsym.numerics.orbits.variational import Flow

#: Cosines over the second half of the time; Student's factor for 95 % with so many degrees of freedom.
COSINES, STUDENT = 8, 2.306

#: So many intervals at least.
LEAST_INTERVALS = 64

#: A state on constraints that is led back rests where it has not moved by more than this part of its sizes.
RESTS = 1e-12

#: Points of Gauss and Legendre for about every step, for the mean divergence.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(5)


class Parting(Enum):
    """What a largest exponent over a finite time says."""

    POSITIVE = "positive over this time"
    NOT_TOLD_FROM_ZERO = "not told from zero"
    NEGATIVE = "negative over this time"


@dataclass(frozen=True)
class Exponents:
    """``values`` (k,) in decreasing order with their ``uncertainty`` (95 %, statistics only), over ``time``.

    ``history`` (intervals, k) are the exponents up to ``times``.  ``divergence`` is the mean of tr J along the motion
    and ``sum_error`` how far the sum of all exponents is from it; nan where not all were asked for.

    ``linear``: the equations are linear in the state (proved: their Jacobian does not know it), so that all motions
    part alike and none is chaotic; ``planar``: smooth equations and constraints without the time move two variables,
    and no such motion is chaotic (Poincare and Bendixson); ``resting``: the motion is a rest in every digit.
    """

    values: Any
    uncertainty: Any
    times: Any
    history: Any
    divergence: float
    sum_error: float
    time: float
    ended: Breakdown | None = None
    linear: bool = False
    planar: bool = False
    resting: bool = False

    @property
    def falling(self) -> bool:
        """Whether the largest exponent falls about as log(t)/t from half the time to the end, as in regular motion.

        The mean over the second half is then much smaller than over the first.
        """
        return bool(_falling(self.history)[0])

    @property
    def regular(self) -> float:
        """log(T)/T, of the size to which the largest exponent of regular motion falls in the time T."""
        return max(float(np.log(self.time)), 1.0) / self.time

    @property
    def parting(self) -> Parting:
        """The largest exponent beside its uncertainty, and beside log(T)/T to which that of regular motion falls."""
        first, doubt = float(self.values[0]), 3 * float(self.uncertainty[0])
        if first > doubt and first > 3 * self.regular and not self.falling:
            return Parting.POSITIVE
        if first < -doubt and first < -3 * self.regular:
            return Parting.NEGATIVE
        return Parting.NOT_TOLD_FROM_ZERO


def exponents(
    dynamics: Dynamics,
    time: float,
    every: float,
    count: int | None = None,
    tolerance: float = 1e-10,
    watch: Callable[[float], None] = lambda t: None,
) -> Exponents:
    """The ``count`` largest exponents (all of them by default) of the scenario's motion from 0 to ``time``.

    ``every``: how often the columns are made orthogonal again.  A motion that breaks down, or Ctrl-C, ends it early.
    """
    state = np.array([float(x) for x in dynamics.scenario.state])
    basis = dynamics.tangent(0.0, state)
    most = basis.shape[1]
    near = 0.0 if dynamics.constraints is None else RESTS * about(dynamics, 0.0, state).sizes[:, 0]
    flow = Flow(dynamics, tolerance, most if count is None else min(count, most))
    intervals = max(LEAST_INTERVALS, int(np.ceil(time / every)))
    ends = np.linspace(0.0, time, intervals + 1)
    tangents = basis @ _directions(most, flow.columns)
    growth, divergences, ended, resting, first = [], [], None, True, state
    try:
        for start, end in pairwise(ends):
            before = state
            state, tangents = flow.passage(state, float(start), float(end), tangents)
            tangents, triangle = np.linalg.qr(tangents)
            resting = resting and bool(np.all(np.abs(state - first) <= near))
            growth.append(np.log(np.abs(np.diag(triangle))))
            divergences.append((before, float(start), float(end)))
            watch(float(end))
    except Breakdown as breakdown:
        ended = breakdown
    except KeyboardInterrupt:
        ended = Breakdown("interrupted", "stopped by the user", float(ends[len(growth)]), state)
    rates, times = np.array(growth).reshape(len(growth), flow.columns), ends[1 : len(growth) + 1]
    if not len(rates):
        none = np.full(flow.columns, np.nan)
        return Exponents(none, none, times, rates, float("nan"), float("nan"), 0.0, ended)
    # A column is along what grows most of what the columns before it leave: only in the long run that sorts them.
    rates = rates[:, np.argsort(-np.sum(rates, axis=0), kind="stable")]
    history = np.cumsum(rates, axis=0) / times[:, None]
    values = history[-1]
    panels = max(1, flow.run.work.steps // len(rates))
    divergence = _mean_divergence(dynamics, divergences, panels, tolerance)
    error = abs(float(np.sum(values)) - divergence) if flow.columns == most else float("nan")
    doubt, linear = _uncertainty(rates, times, tolerance), dynamics.linear
    doubt = np.where(_falling(history), np.maximum(doubt, abs(values)), doubt)  # what falls as log(t)/t may end at zero
    # What a constraint drives is a variable more, though the rates may hold no time.
    planar = most == 2 and autonomous(dynamics) and dynamics.is_scleronomic
    return Exponents(values, doubt, times, history, divergence, error, float(times[-1]), ended, linear, planar, resting)


def _falling(history: Any) -> Any:
    """Of every exponent whether its mean over the second half is less than half of that over the first."""
    early = history[len(history) // 2 - 1]
    return abs(2 * history[-1] - early) < 0.5 * abs(early)


def _directions(size: int, columns: int) -> Any:
    """Orthogonal directions of which none is special to a system: coordinates may be cyclic, or at rest."""
    return np.linalg.qr(np.random.default_rng(1).normal(size=(size, columns)))[0]


def _uncertainty(rates: Any, times: Any, tolerance: float) -> Any:
    """Half the width of the 95 % interval of the mean over all intervals; nan where these are too few.

        sigma^2 = 1/(B T) sum_j c_j^2,   c_j = sqrt(2/m) sum_i cos(j pi (i + 1/2)/m) r_i,   j = 1 .. B,

    over the m rates r_i of the second half, T in intervals.  What swings quickly, as log |R_ii| does along an orbit,
    cancels in the mean and is hardly in these; blocks would take it for chance.  Of the distance d between the means of
    the second half and of all, chance explains sigma^2: d^2 - sigma^2, where there is more, is due to the beginning.
    With it goes what the tolerance of the steps lets log |R_ii| of an interval err by.
    """
    late, length = rates[len(rates) // 2 :], times[0]
    if len(rates) < LEAST_INTERVALS:
        return np.full(rates.shape[1], np.nan)
    angles = np.pi / len(late) * np.outer(np.arange(1, COSINES + 1), np.arange(len(late)) + 0.5)
    slow = np.sqrt(2 / len(late)) * np.cos(angles) @ late
    variance = np.mean(slow**2, axis=0) / len(rates)
    turning = (np.mean(late, axis=0) - np.mean(rates, axis=0)) ** 2 - variance
    return (np.sqrt(STUDENT**2 * variance + np.maximum(turning, 0)) + tolerance) / length


def _mean_divergence(dynamics: Dynamics, starts: Any, panels: int, tolerance: float) -> float:
    """1/T int tr J dt, the motion integrated once more without changes, by Gauss's formula on parts of every interval.

    It begins where the exponents' own intervals begin: two runs of a chaotic motion part.
    """
    plain, jacobian, size = Flow(dynamics, tolerance, 0), compiled_kernel(dynamics, "jacobian"), 2 * dynamics.size
    middles = (np.arange(panels)[:, None] + (1 + _NODES) / 2).reshape(-1) / panels
    weights = np.tile(_WEIGHTS / 2, panels) / panels
    total = 0.0
    for state, start, end in starts:
        times = start + (end - start) * middles
        states = plain.along(state, start, times)
        rows = jacobian(np.vstack([times, states]))
        if dynamics.constraints is None:
            traces = rows[:: size + 1].sum(axis=0)
        else:
            bases = [dynamics.tangent(t, x) for t, x in zip(times, states.T, strict=True)]
            whole = rows.reshape(size, size, -1)
            traces = np.array([np.sum(b * (whole[:, :, k] @ b)) for k, b in enumerate(bases)])
        total += (end - start) * float(weights @ traces)
    return total / float(starts[-1][2])
