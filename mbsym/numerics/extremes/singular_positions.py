"""Positions in which constraints lose their rank, as a four-bar's do whose links are in line: searched, then decided.

    f(0, q) = 0,    J(0, q)^T lambda = 0,    lambda^T lambda = 1         (the rows that are kept)

are more equations than unknowns, so that most mechanisms have no such position.  Gauss-Newton steps, damped, start from
random positions of the constraints; what they find is a position in which the rank falls by singular values, to
roundings.  Where all its angles are quarter turns and its other coordinates rational, rank and position are decided
exactly (``proved``).  A search does not show that there are no others.

Source: Gosselin & Angeles, Singularity analysis of closed-loop kinematic chains, IEEE Trans. Robotics Autom. 6 (1990),
281-290, for what such positions are.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import pi
from typing import Any

import numpy as np
from flint import fmpq, fmpq_mat

from mbsym.algebra import rationals
from mbsym.algebra.failures import Failure
from mbsym.algebra.point import Rationals
from mbsym.mechanics.variables import angle_denominators
from mbsym.numerics.constrained import Constraints
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.interface import compiled_kernel
from mbsym.numerics.scenario import Scenario

#: Starts of the search, steps from each, and distinct positions that are kept.
STARTS, STEPS, MOST = 120, 60, 12

#: What a step costs, and what it costs more for the square of the number of unknowns (``planning.prices``).
STEP, UNKNOWNS = 2e-4, 3e-6

#: A residual that counts as zero, and the part of the largest singular value below which one counts as lost.
SETTLED, LOST = 1e-11, 1e-8

#: Coordinates that differ by less are the same; what is no further from a quarter turn or a short fraction is it.
SAME, NEAR = 1e-6, 1e-8

#: Denominators of coordinates that are taken for rational.
SHORT = 1000


@dataclass(frozen=True)
class SingularPosition:
    """``place`` by coordinate; of ``usual`` rows that are independent elsewhere ``rank`` are here.

    ``labels`` are exact values where ``proved``: the position is on the constraints, and the rank is that one, by
    rational arithmetic; else floats.  ``family``: it lies on a curve or surface of such positions.
    """

    place: Mapping[str, float]
    labels: Mapping[str, str]
    exact: Mapping[str, Fraction] | None
    rank: int
    usual: int
    family: bool

    @property
    def proved(self) -> bool:
        return self.exact is not None

    @property
    def text(self) -> str:
        """``q1 = 0, q2 = pi``."""
        return ", ".join(f"{name} = {label}" for name, label in self.labels.items())


@dataclass(frozen=True)
class SingularPositions:
    """What a search from so many ``starts`` found; ``more`` positions than are listed."""

    found: tuple[SingularPosition, ...]
    starts: int
    more: bool
    moving: bool  # rows depend on the time: at t = 0


def singular_positions(scenario: Scenario, sizes: Sequence[float], limit: float) -> SingularPositions | None:
    """Those that a search finds for a cost of about ``limit`` (``planning.prices``); None without constraints.

    ``sizes`` of the coordinates: those that are no angles are begun within twice that.
    """
    constraints = Dynamics(scenario).constraints
    if constraints is None or not constraints.kept:
        return None
    search = Search(scenario, constraints, np.asarray(sizes, dtype=float))
    return search.found(limit)


class Search:
    """Gauss-Newton steps to singular positions, with the time held at ``time`` (0 unless said otherwise).

    ``steps`` counts them.
    """

    time = 0.0
    steps = 0

    def __init__(self, given: Scenario, constraints: Constraints, sizes: Any) -> None:
        self.scenario, self.constraints, self.sizes = given, constraints, sizes
        self.names, self.n = given.system.coordinates, constraints.size
        self.kept = list(constraints.kept)
        self.h = constraints.holonomic
        self.denominators = angle_denominators(given.system)
        self.angular = np.array([name in self.denominators for name in self.names])
        self.scales = np.where(self.angular, 1.0, self.sizes)
        self.source = np.random.default_rng(11)

    def reached(self, state: Any, time: float) -> Any | None:
        """A singular position that is reached from a state at a time, or None."""
        self.time = time
        return self._from(state)

    def falls(self, position: Any, time: float) -> bool:
        """Whether rows become dependent at a position, to roundings."""
        self.time = time
        return self._rank(position) < len(self.kept)

    def difference(self, position: Any, other: Any) -> Any:
        """By how much positions differ, angles by the shorter way, in parts of the coordinates' sizes."""
        return self._wrapped(position - other) / self.scales

    @property
    def spent(self) -> float:
        """What all steps have cost."""
        return self.steps * (STEP + UNKNOWNS * (self.n + len(self.kept)) ** 2)

    def found(self, limit: float) -> SingularPositions:
        places: list[Any] = []
        starts = 0
        for number in range(STARTS):
            if number and self.spent > limit:
                break
            starts += 1
            place = self._from(self._start(number))
            if place is None or any(self._same(place, earlier) for earlier in places):
                continue
            if self._rank(place) < len(self.kept):  # else others take over from the rows that are kept
                places.append(place)
        shown = [position for position in map(self._described, places[:MOST]) if position is not None]
        shown.sort(key=lambda entry: (not entry.proved, [abs(x) for x in entry.place.values()]))
        return SingularPositions(tuple(shown), starts, len(places) > MOST, self._moving())

    def _start(self, number: int) -> Any:
        state = np.array([float(x) for x in self.scenario.state])
        if number:
            spread = np.where(self.angular, pi, 2 * self.sizes)
            state[: self.n] = np.where(self.angular, 0.0, state[: self.n]) + self.source.uniform(-1, 1, self.n) * spread
        return state

    # --- the equations ---

    def _values(self, q: Any) -> tuple[Any, Any]:
        """(f (h, m), J (r, n, m)) at positions in columns."""
        states = np.vstack([q, np.zeros_like(q)])
        values = self.constraints.along(np.full(q.shape[1], self.time), states)
        return values.positions, values.partials[self.kept]

    def _residual(self, x: Any, rows: Any, lengths: Any) -> Any:
        """At unknowns (q, lambda) in columns; ``lengths`` (n,) weigh coordinates, ``rows`` (r,) rows."""
        q, weights = x[: self.n], x[self.n :]
        f, partials = self._values(q)
        scaled = partials * lengths[None, :, None] / rows[:, None, None]
        return np.vstack(
            [f / self._of_positions(rows)[:, None], np.einsum("rnm,rm->nm", scaled, weights), np.sum(weights**2, 0) - 1]
        )

    def _of_positions(self, rows: Any) -> Any:
        """What f is measured by: the rows that are kept have theirs, others the largest."""
        of_positions = np.full(self.h, np.max(rows))
        for size, number in zip(rows, self.kept, strict=True):
            if number < self.h:
                of_positions[number] = size
        return of_positions

    def _slopes(self, x: Any, rows: Any, lengths: Any) -> Any:
        steps = 1e-6 * np.concatenate([lengths, np.ones(len(self.kept))])
        ahead, behind = (x[:, None] + sign * np.diag(steps) for sign in (1, -1))
        change = self._residual(ahead, rows, lengths) - self._residual(behind, rows, lengths)
        return change / (2 * steps)

    def _from(self, state: Any) -> Any | None:
        """A singular position that is reached from a state, or None."""
        with np.errstate(all="ignore"):
            led = self.constraints.led(self.time, state)
            q = (state if led is None else led)[: self.n]
            lengths = self.scales
            _, partials = self._values(q[:, None])
            scaled = partials[:, :, 0] * lengths
            rows = self._lengths[self.kept]
            if not np.all(np.isfinite(scaled)):
                return None
            left = np.linalg.svd((scaled / rows[:, None]).T)[2][-1]
            x, damping = np.concatenate([q, left]), 1e-3
            residual = self._residual(x[:, None], rows, lengths)[:, 0]
            for _ in range(STEPS):
                self.steps += 1
                size = float(np.linalg.norm(residual))
                if not np.isfinite(size):
                    return None
                if size < SETTLED:
                    break
                slopes = self._slopes(x, rows, lengths) * np.concatenate([lengths, np.ones(len(left))])
                if not np.all(np.isfinite(slopes)):
                    return None
                whole = np.vstack([slopes, np.sqrt(damping) * np.eye(len(x))])
                step = np.linalg.lstsq(whole, np.concatenate([-residual, np.zeros(len(x))]), rcond=None)[0]
                moved = x + step * np.concatenate([lengths, np.ones(len(left))])
                new = self._residual(moved[:, None], rows, lengths)[:, 0]
                if np.linalg.norm(new) < size:
                    x, residual, damping = moved, new, max(damping / 10, 1e-16)
                elif (damping := damping * 10) > 1e8:
                    return None
            return self._wrapped(x[: self.n]) if np.linalg.norm(residual) < 1e-9 else None

    def _wrapped(self, q: Any) -> Any:
        """Angles within (-pi d, pi d], d their denominators."""
        wrapped = np.array(q)
        for k, name in enumerate(self.names):
            if self.angular[k]:
                period = 2 * pi * self.denominators[name]
                wrapped[k] -= period * np.ceil(wrapped[k] / period - 0.5 - SAME)
        return wrapped

    def _same(self, position: Any, other: Any) -> bool:
        return bool(np.all(np.abs(self._wrapped(position - other)) < SAME * self.scales))

    # --- what is said of one ---

    def _described(self, q: Any) -> SingularPosition | None:
        """None where the rank does not fall after all."""
        exact = self._decided(q)
        if exact is not None:
            values, labels, rank = exact
        else:
            values, labels = None, {name: f"{x:.9g}" for name, x in zip(self.names, q.tolist(), strict=True)}
            rank = self._rank(q)
        if rank >= len(self.kept):
            return None
        place = dict(zip(self.names, q.tolist(), strict=True))
        return SingularPosition(place, labels, values, rank, len(self.kept), self._family(q, rank))

    def _weighted(self, q: Any, every: bool = False) -> Any:
        """J at a position, or ``every`` row, by the lengths that rows have elsewhere."""
        states = np.concatenate([q, np.zeros(self.n)])
        rows = self.constraints.at(self.time, states).partials * self.scales
        rows = rows / self._lengths[:, None]
        return rows if every else rows[self.kept]

    @cached_property
    def _lengths(self) -> Any:
        """The largest length of every row at the starts."""
        starts = [np.concatenate([self._start(k)[: self.n], np.zeros(self.n)]) for k in range(8)]
        rows = [self.constraints.at(0.0, x).partials * np.where(self.angular, 1.0, self.sizes) for x in starts]
        lengths = np.max(np.nan_to_num(np.linalg.norm(np.array(rows), axis=2)), axis=0)
        return np.where(lengths > 0, lengths, 1.0)

    def _rank(self, q: Any) -> int:
        """Of all rows: where others take over from those that are kept, nothing is lost."""
        sizes = np.linalg.svd(self._weighted(q, every=True), compute_uv=False)
        return int(np.sum(sizes > LOST * max(1.0, sizes[0])))

    def _family(self, q: Any, rank: int) -> bool:
        """Whether the equations leave a direction free, beside those of lambda."""
        lengths = self.scales
        rows = self._lengths[self.kept]
        left = np.linalg.svd(self._weighted(q).T)[2][-1]
        slopes = self._slopes(np.concatenate([q, left]), rows, lengths)
        slopes = slopes * np.concatenate([lengths, np.ones(len(left))])
        sizes = np.linalg.svd(slopes, compute_uv=False)
        free = len(q) + len(left) - int(np.sum(sizes > 1e-6 * sizes[0]))
        return free > len(self.kept) - rank - 1

    def _decided(self, q: Any) -> tuple[dict[str, Fraction], dict[str, str], int] | None:
        """(angles in turns of pi/2 as they stand, labels, rank) by rational arithmetic; None where that is no way."""
        basic: dict[str, tuple[fmpq, fmpq]] = {}
        values: dict[str, Any] = {}
        labels, exact = {}, {}
        for name, x, size in zip(self.names, q.tolist(), self.scales.tolist(), strict=True):
            if name in self.denominators:
                quarters = round(x / (pi / 2))
                if self.denominators[name] != 1 or abs(x - quarters * pi / 2) > NEAR:
                    return None
                sine, cosine = ((0, 1), (1, 0), (0, -1), (-1, 0))[quarters % 4]
                basic[name] = fmpq(sine), fmpq(cosine)
                labels[name] = multiple_of_pi(Fraction(quarters, 2))
                exact[name] = Fraction(quarters, 2)
                continue
            value = Fraction(x).limit_denominator(SHORT)
            if abs(x - value) > NEAR * max(size, abs(x)):
                return None
            values[name] = rationals.exact(value)
            labels[name], exact[name] = str(value), value
        # An angle itself is irrational: only its sine and cosine may be asked for.
        values |= dict.fromkeys(basic, _Irrational()) | {"pi": _Irrational()}
        values |= dict.fromkeys(self.scenario.system.velocities, fmpq(0)) | {"t": fmpq(0)}
        numbers = Rationals({}, self.denominators)
        numbers.basic.update(basic)
        code = self.constraints.code
        try:
            evaluated = code.program.evaluate(code.outputs, values, numbers)
        except (Failure, KeyError, ZeroDivisionError):
            return None
        if any(isinstance(x, _Irrational) for x in evaluated):
            return None
        h, r = self.h, len(self.constraints)
        if any(x != 0 for x in evaluated[:h]):
            return None
        flat = evaluated[h + r :]
        return exact, labels, int(fmpq_mat(r, self.n, flat).rank())

    def _moving(self) -> bool:
        state = np.array([float(x) for x in self.scenario.state])
        values, other = (self.constraints.at(t, state) for t in (0.0, 0.37))
        pairs = ((values.positions, other.positions), (values.partials, other.partials))
        return any(not np.array_equal(a, b) for a, b in pairs)


class _Irrational:
    """A number that is not looked at; what is computed with it is another one."""

    def _another(self, *others: object) -> _Irrational:
        return self

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __truediv__ = __rtruediv__ = __neg__ = _another
    __pow__ = _another


def multiple_of_pi(turns: Fraction) -> str:
    """``pi/2``, ``-pi``, ``0``, ``2*pi/3``."""
    if not turns:
        return "0"
    top, bottom = turns.numerator, turns.denominator
    sign, top = ("-" if top < 0 else ""), abs(top)
    return sign + ("pi" if top == 1 else f"{top}*pi") + ("" if bottom == 1 else f"/{bottom}")


# Singular positions of constraints that a run's steps went over without being stopped by them.
#
# A step may be longer than the neighbourhood in which a position with dependent rows is felt.  Then nothing ends the
# run and nothing carries it over, and which branch of motion it is on behind is what the step happened to meet.  They
# are found afterwards: where the least singular value of J (each row by its own length) has a minimum between rows or
# steps, a singular position is sought from there (``extremes.singular_positions``), and is one that was gone over if
# the curve through positions and velocities comes to it within ``WITHIN``, in parts of the motion's size.


#: How near the curve comes, and the part of its usual size to which the least singular value has fallen beside it.
WITHIN, FALLEN = 2e-3, 0.5

#: Minima that are looked into; samples of the curve beside one.
MOST_HALVINGS, FINE = 12, 400


def stepped_over(dynamics: Dynamics, times: Any, states: Any, known: Sequence[float]) -> tuple[float, ...]:
    """The times at which a run, with rows as dense as its steps, went over a singular position.

    ``states`` (2n, m) at ``times``; ``known`` are times of those over which the motion was carried.  Times are good to
    the distance of rows where the constraints move by themselves: positions are sought with the time held.  In declared
    variables the least singular value itself has to fall to ``WITHIN`` on the curve.
    """
    constraints = dynamics.constraints
    if constraints is None or not constraints.kept or len(times) < 4:
        return ()
    states = np.asarray(states, dtype=float)
    n = constraints.size
    sizes = np.max(np.abs(states[:n]), axis=1)
    search = None if dynamics.in_states else Search(dynamics.scenario, constraints, np.where(sizes > 0, sizes, 1.0))
    scales = np.ones(n) if search is None else search.scales
    least = _least(constraints, scales, times, states)
    usual = float(np.median(least))
    inner = (
        np.flatnonzero((least[1:-1] <= least[:-2]) & (least[1:-1] <= least[2:]) & (least[1:-1] < FALLEN * usual)) + 1
    )
    passed: list[float] = []
    for k in sorted(inner.tolist(), key=lambda k: float(least[k]))[:MOST_HALVINGS]:
        span = slice(max(0, k - 1), min(len(times), k + 2))
        if any(times[span][0] <= moment <= times[span][-1] for moment in known):
            continue
        if search is None:
            time = _fallen(dynamics, times[span], states[:, span], WITHIN * usual)
        else:
            time = _met(search, times[span], states[:, span], times[k])
        if time is not None:
            passed.append(time)
    return tuple(sorted(passed))


def _least(constraints: Any, scales: Any, times: Any, states: Any) -> Any:
    """Of all rows, each of length 1, the singular value that falls to zero where their rank does, at every time."""
    rows = constraints.along(times, states).partials * scales[None, :, None]
    lengths = np.linalg.norm(rows, axis=1)
    rows = rows / np.maximum(np.max(lengths, axis=1), 1e-300)[:, None, None]
    return np.linalg.svd(np.moveaxis(rows, 2, 0), compute_uv=False)[:, constraints.rank - 1]


def _fallen(dynamics: Dynamics, times: Any, states: Any, least: float) -> float | None:
    """When the least singular value falls to ``least`` on the curve through states and their rates; None if never."""
    from scipy.interpolate import CubicHermiteSpline

    assert dynamics.constraints is not None
    rates = compiled_kernel(dynamics, "right_hand_side")(np.vstack([times, states]))
    at = np.linspace(times[0], times[-1], FINE)
    singular_values = _least(
        dynamics.constraints,
        np.ones(dynamics.constraints.size),
        at,
        CubicHermiteSpline(times, states, rates, axis=1)(at),
    )
    best = int(np.argmin(singular_values))
    return float(at[best]) if singular_values[best] <= least else None


def _met(search: Search, times: Any, states: Any, middle: float) -> float | None:
    """When the curve comes within ``WITHIN`` of a singular position that is found from it; None if it does not."""
    from scipy.interpolate import CubicHermiteSpline  # half of the time that importing numbers took

    n = len(states) // 2
    curve = CubicHermiteSpline(times, states[:n], states[n:], axis=1)
    at = np.linspace(times[0], times[-1], FINE)
    places = curve(at)
    start = np.concatenate([curve(middle), np.zeros(n)])
    position = search.reached(start, float(middle))
    if position is None or not search.falls(position, float(middle)):
        return None
    apart = np.array([np.linalg.norm(search.difference(place, position)) for place in places.T])
    best = int(np.argmin(apart))
    # Between two samples the curve is a straight line for this purpose.
    step = np.max(np.linalg.norm(np.diff(places, axis=1) / search.scales[:, None], axis=0))
    return float(at[best]) if apart[best] <= WITHIN + step else None
