"""How wrong a run is: its difference from a better one, quantity by quantity.

    error_i = max over the samples of |x_i - better_i|,      relative to scale_i = max over the whole run of |better_i|

The better run differs in more than name: in an arithmetic of more digits, by another method, or by a tolerance ten
times smaller at least; two runs that come down to the same settings are never compared.  It takes no step longer than a
two thousandth of the whole, so that short events are not stepped over twice.

What a quantity is relative to is settled by the scene where it rests but for rounding (``mbsym.numerics.sizes``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any

import numpy as np

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT64
from mbsym.numerics.kernels.llvm import SCALARS, available
from mbsym.numerics.methods.interface import STEP_LIMIT, Method, Setting, Unusable
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.simulate import Integrated, Trajectory, integrated
from mbsym.numerics.sizes import AFFORDABLE, GRID, MANY, scaled, usual_sizes

#: The better run's tolerance beside the run's own, and how much smaller it has to be where nothing else differs.
TIGHTER, LEAST_RATIO = 1e-2, 0.1

#: The tolerance held against steps of fixed length.
AGAINST_FIXED = 1e-15

#: No step of the better run is longer than this part of the whole time.
PARTS = 2_000

#: Nothing new is compiled for a right-hand side with more operations.
LONG = 20_000

#: A relative tolerance below this many roundings is not taken by the methods themselves.
LEAST_ROUNDINGS, LEAST_OF_SCIPY = 4.0, 2.3e-14  # in units of eps; rtol


class Lacking(Enum):
    """Why there is no estimate."""

    NOT_ASKED = "none was asked for"
    NOT_WHOLE = "the run ended early"
    FINEST = "no better run can be had: this one is as fine as the arithmetic, and no finer arithmetic is there"
    TOO_LONG = "a better run takes too long"
    BREAKS_DOWN = "a better run breaks down on the way; this one may have stepped over a singularity"
    INTERRUPTED = "interrupted"
    CONTRADICTED = "the energy, which is conserved, drifts by far more than the difference from a better run"


@dataclass(frozen=True)
class Against:
    """The better run: its method, arithmetic and setting."""

    method: str
    scalar: str
    setting: Setting


@dataclass(frozen=True)
class QuantityError:
    """Absolute errors of one coordinate or velocity: at the end and at worst; ``size`` its own, ``scale`` it is by."""

    name: str
    final: float
    largest: float
    size: float
    scale: float

    @property
    def rests(self) -> bool:
        """Its own size is nothing to measure by."""
        return self.size < self.scale


@dataclass(frozen=True)
class ErrorEstimate:
    """Differences from a better run over ``samples`` times from 0 to ``end``; ``rounding`` is that of one number."""

    against: Against
    quantities: tuple[QuantityError, ...]
    samples: int
    end: float
    rounding: float

    @property
    def final(self) -> float:
        """The largest relative error at the end; no run is better than the rounding of one number."""
        return max(self.rounding, *(q.final / q.scale for q in self.quantities))

    @property
    def largest(self) -> float:
        """The largest relative error over all samples."""
        return max(self.rounding, *(q.largest / q.scale for q in self.quantities))


@dataclass(frozen=True)
class NoEstimate:
    """There is no estimate, and why."""

    why: Lacking


def estimated(
    dynamics: Dynamics,
    found: Trajectory,
    method: Method,
    scalar: str,
    completed: Callable[[Method], Method] = lambda method: method,
) -> ErrorEstimate | NoEstimate:
    """The error of a run of ``method``, whose setting and times ``found`` holds, by a better one.

    ``completed`` makes of another method one that integrates the same coordinates and shows whole states.
    """
    if not found.whole:
        return NoEstimate(Lacking.NOT_WHOLE)
    times, end = found.times, float(found.times[-1])
    finer: Any = times if len(times) >= MANY else np.union1d(times, np.linspace(0.0, end, GRID))
    why = Lacking.FINEST
    for better, kind, setting in _candidates(dynamics, found, method, scalar, completed):
        try:
            run = integrated(dynamics, better, setting, finer, kind)
        except Unusable:
            continue
        if run.interrupted:
            return NoEstimate(Lacking.INTERRUPTED)
        if not run.whole:
            if run.breakdown is not None and run.breakdown.kind != STEP_LIMIT:
                return NoEstimate(Lacking.BREAKS_DOWN)
            why = Lacking.TOO_LONG
            continue
        against = Against(better.traits.name, kind, setting)
        errors = tuple(_differences(dynamics, found, run))
        return ErrorEstimate(against, errors, len(times), end, _rounding(scalar))
    return NoEstimate(why)


def _candidates(
    dynamics: Dynamics,
    found: Trajectory,
    method: Method,
    scalar: str,
    completed: Callable[[Method], Method],
) -> Iterator[tuple[Method, str, Setting]]:
    """Runs that are better, the best of them first."""
    setting, end = found.setting, float(found.times[-1])
    name, operations = method.traits.name, max(1, dynamics.right_hand_side.operations)
    limit, longest = max(20_000, AFFORDABLE // (14 * operations)), end / PARTS
    explicit = completed(METHODS["dop853"])
    wanted = AGAINST_FIXED if setting.tolerance is None else setting.tolerance * TIGHTER
    more = [kind for kind in (EXTENDED, FLOAT64) if available(kind) and _rounding(kind) < _rounding(scalar)]
    if more and operations <= LONG:
        # Explicit steps in more digits; where stability asks for too many of them, the limit ends it.
        yield explicit, more[0], Setting(max(wanted, 40 * _rounding(more[0])), None, limit, longest)
    if setting.step is not None:
        yield (
            method,
            scalar,
            replace(setting, step=min(setting.step / 4, longest), step_limit=max(4 * limit, 8 * found.work.steps)),
        )
        return
    own = _taken(name, scalar, setting.tolerance or 0.0)
    if _taken(name, scalar, wanted) <= LEAST_RATIO * own:
        yield method, scalar, Setting(wanted, None, setting.step_limit, longest)
    elif _taken("dop853", scalar, wanted) <= LEAST_RATIO * own:
        yield explicit, scalar, Setting(wanted, None, limit, longest)


def _rounding(scalar: str) -> float:
    return float(np.finfo(SCALARS[scalar].dtype).eps) / 2


def _taken(name: str, scalar: str, tolerance: float) -> float:
    """The relative tolerance that a method takes where one is asked for."""
    roundings = LEAST_ROUNDINGS * 2 * _rounding(scalar)
    return max(tolerance, roundings if name in ("dop853", "rk45", "taylor") else LEAST_OF_SCIPY)


def _differences(dynamics: Dynamics, found: Trajectory, better: Integrated) -> Iterator[QuantityError]:
    """Row by row, at the times of ``found``."""
    places = np.searchsorted(better.times, found.times)
    sizes = np.max(np.abs(better.states), axis=1).astype(float)
    scales = scaled(sizes, usual_sizes(dynamics, found.times, found.states, found.largest_kinetic))
    with np.errstate(all="ignore"):
        errors = np.abs(found.states - better.states[:, places]).astype(float)
    names = (*dynamics.system.coordinates, *dynamics.system.velocities)
    for name, row, size, scale in zip(names, errors, sizes, scales, strict=True):
        yield QuantityError(name, float(row[-1]), float(np.max(row)), float(size), float(scale))


def contradicted(estimate: ErrorEstimate | NoEstimate, drift: float) -> bool:
    """Whether a conserved energy drifts by more than a run of this error could let it."""
    return isinstance(estimate, ErrorEstimate) and drift > 1e-2 and drift > 1e3 * estimate.largest
