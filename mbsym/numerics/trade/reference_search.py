"""The best reference solution over a whole interval that can be had for a given cost (``planning.prices``).

Three ways, each with two solutions that share neither steps nor order, nor method where that is possible; how far they
differ is the error that the reference is said to have.

extrapolation    in 160 bits, twice, with other columns and steps; between its steps an explicit method in extended
                 arithmetic, started anew at each of them, which has to arrive at the next one
explicit         two methods in extended arithmetic that agree
implicit         two methods in float64 that agree, of Rosenbrock's kind and Radau's (stiff scenes)

Two solutions that do not agree are no reference, whatever each of them says of itself.  What a search may cost is
counted work: no clock decides which way is taken.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from math import inf
from typing import Any

import numpy as np
from flint import arb, ctx, fmpq

from mbsym.algebra import rationals
from mbsym.algebra.failures import Defect, Failure
from mbsym.expressions.message import Message, enumerated
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT64
from mbsym.numerics.kernels.llvm import available
from mbsym.numerics.kernels.precise import precise
from mbsym.numerics.methods.interface import Breakdown, Cause, Method, Setting, Unusable
from mbsym.numerics.methods.magnitudes import about
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning.prices import FOLLOWED, LOOKED_AT, Meter, Working, precise_cost
from mbsym.numerics.planning.sizes import scaled, sizes_of_scene
from mbsym.numerics.trade.comparison import SHARES, Ended, compared, filled, uneven

# Reference solutions, against which errors are measured: extrapolation in arithmetic of any precision.
#
# Gragg's modified midpoint rule with n = 2, 4, 6, ... substeps, extrapolated to n -> infinity (Hairer, Norsett &
# Wanner, Solving Ordinary Differential Equations I, II.9), over ``arb`` numbers of ``bits`` bits.  It shares neither
# its formulas nor its arithmetic with the methods that are judged by it.  Its own error is estimated by a second
# solution of lower order with other steps, and is printed with every table.


#: Bits of the arithmetic, and how many columns the extrapolation has (order 2 * COLUMNS).
BITS = 160
COLUMNS = 12

#: Columns where many times are asked for: steps are short then.
FEW_COLUMNS = 8

#: Ways to a reference.
EXTRAPOLATION, EXPLICIT, IMPLICIT = "extrapolation", "explicit", "implicit"


@dataclass(frozen=True)
class Reference:
    """``states`` at ``times``, shape (2n, m), rounded to float64; ``error`` is the estimated error of the solution:

    the largest difference from a second solution, each component relative to ``scale``, shape (2n,).  ``method`` says
    what the two are, ``way`` of which kind, ``cost`` what finding it has cost (``mbsym.numerics.planning.prices``).
    """

    times: Any
    states: Any
    error: float
    seconds: float
    method: str
    scale: Any
    way: str = EXTRAPOLATION
    cost: float = 0.0


class Extrapolation:
    """A solution under way: ``state`` at ``time``, which is a double, so that others can start there."""

    def __init__(self, dynamics: Dynamics, tolerance: float, columns: int, limit: float) -> None:
        self.f = precise(dynamics.right_hand_side, BITS)
        self.time = 0.0
        self.state = [rationals.ball(x) for x in dynamics.scenario.state]
        self.tolerance = tolerance
        self.columns = columns
        self.dynamics, self.limit, self.evaluations = dynamics, limit, 0
        known = about(dynamics, 0.0, self.floats())
        self.unit = float(known.times[0])
        self.step_size = 1e-3 * self.unit
        self.scale = np.maximum(np.abs(self.floats()), 1e-3 * known.sizes[:, 0]).tolist()

    def advance(self, until: float) -> None:
        """Steps up to ``until``; the last one ends there exactly.  Raises Breakdown."""
        while self.time < until:
            self.step(until)

    def step(self, until: float) -> None:
        """One step, which ends at ``until`` at the latest.  Raises Breakdown."""
        while True:
            now = min(self.time + self.step_size, until)
            last, length = now == until, now - self.time
            new, error = self._extrapolated(arb(now) - arb(self.time))
            growth = 0.9 * (self.tolerance / max(error, 1e-300)) ** (1 / (2 * self.columns - 1))
            accepted = error <= self.tolerance
            if not accepted:
                self.step_size = length * min(0.7, max(0.1, growth))
            elif not last or growth < 1:
                self.step_size = length * min(4.0, growth)
            if accepted:
                self.time, self.state = now, new
                self.scale = [max(s, abs(float(x))) for s, x in zip(self.scale, new, strict=True)]
            if not self.step_size > 1e-12 * max(self.unit, self.time):
                raise Breakdown(Cause.BLOW_UP, "the reference solution cannot go on", self.time, self.floats())
            if self.spent > self.limit:
                raise Breakdown(Cause.STEP_LIMIT, "it costs more than it may", self.time, self.floats())
            if accepted:
                return

    @property
    def spent(self) -> float:
        """What it has cost so far (``mbsym.numerics.planning.prices``)."""
        return precise_cost(self.dynamics, self.evaluations)

    def floats(self) -> Any:
        return np.array([float(x) for x in self.state])

    def _extrapolated(self, size: arb) -> tuple[list[arb], float]:
        """Aitken-Neville: T_jk = T_j,k-1 + (T_j,k-1 - T_j-1,k-1) / ((n_j/n_j-k)^2 - 1); and the relative error."""
        slope = self._slope(arb(self.time), self.state)
        rows: list[list[list[arb]]] = []
        for j in range(self.columns):
            n = 2 * (j + 1)
            row = [self._midpoints(size, n, slope)]
            for k in range(1, j + 1):
                ratio = arb(fmpq(n * n, (2 * (j + 1 - k)) ** 2)) - 1
                row.append([(a + (a - b) / ratio).mid() for a, b in zip(row[k - 1], rows[j - 1][k - 1], strict=True)])
            rows.append(row)
        best, second = rows[-1][-1], rows[-1][-2]
        errors = [abs(float(a - b)) / s for a, b, s in zip(best, second, self.scale, strict=True)]
        worst = max(errors) if all(np.isfinite(errors)) else float("inf")
        return best, worst

    def _slope(self, t: arb, x: Sequence[arb]) -> list[arb]:
        self.evaluations += 1
        return self.f([t, *x])

    def _midpoints(self, size: arb, n: int, slope: Sequence[arb]) -> list[arb]:
        """n substeps of the midpoint rule from an Euler start."""
        h = size / n
        before, now = self.state, [(x + h * s).mid() for x, s in zip(self.state, slope, strict=True)]
        double = 2 * h
        for i in range(1, n):
            rate = self._slope(self.time + i * h, now)
            before, now = now, [(x + double * s).mid() for x, s in zip(before, rate, strict=True)]
        return now


def solved_at(dynamics: Dynamics, times: Any, tolerance: float, limit: float) -> Any:
    """The states (2n, m) at increasing times from 0, in the most digits that NumPy has.

    Raises Breakdown where there is no solution, or where it costs more than ``limit`` (kind STEP_LIMIT).
    """
    with ctx.workprec(BITS):
        run = Extrapolation(dynamics, tolerance, FEW_COLUMNS, limit)
        states = [in_doubles(run.state)]
        for t in times[1:]:
            run.advance(float(t))
            states.append(in_doubles(run.state))
    return np.array(states).T


def in_doubles(state: Sequence[arb]) -> Any:
    """The sum of two doubles for each component, as far as NumPy's longest numbers hold it."""
    heads = [float(x) for x in state]
    tails = [float(x - arb(head)) for x, head in zip(state, heads, strict=True)]
    return np.array(heads, np.longdouble) + np.array(tails, np.longdouble)


#: Places at which a reference is known, at least, and twice as many at most where its steps are many.
PLACES = 4_000

#: The local errors of the two extrapolations, and of the explicit method between their steps.
FINE, ROUGH, BETWEEN = 1e-24, 1e-21, 1e-19

#: At every so many steps of the first extrapolation the second one is held against it.
EVERY = 4

#: Two solutions that differ by more than this are no reference.
AGREE = 1e-3

#: Nothing is given up as too slow before it has cost so much.
SOME = 1.0

#: No step of an explicit or implicit reference is longer than this part of the whole.
PARTS = 2_000

#: Where switches and narrow loads are looked for in every step, steps are few, and dear.
FEW_PARTS = 100

#: Why there is none yet.
TOO_DEAR = "it costs more than it may"

#: Why there is no reference although solutions came to the end.
DISAGREE = "no two solutions agree"

#: Why there is none where the program is at fault.
BROKEN = "no way to a reference worked"


def whole_reference(
    dynamics: Dynamics,
    end: float,
    budget: float,
    watch: Callable[[str], None] = lambda text: None,
    at_most: float | None = None,
) -> Reference:
    """A solution over the whole interval, known at thousands of places, for about what ``budget`` allows.

    Where that is too little for any way, the explicit one goes on up to ``at_most`` in all.  Raises Breakdown where the
    solution does not exist up to the end, where none is found for that (kind STEP_LIMIT), or where no two solutions
    agree (kind DISAGREE).  A way that ends in an exception that nobody foresaw is none (``Defect`` tells of it); where
    no other is left, the Breakdown says so (kind BROKEN).
    """
    started, spent = time.perf_counter(), 0.0
    failed: Breakdown | None = None
    limits = [*((way, share, budget) for way, share in WAYS), (_explicit, 1.0, at_most or budget)]
    # Steps in many bits know nothing of switches, and would pass what is narrow: others end, or are short, there.
    if not dynamics.features.none:
        limits = [(way, share, limit) for way, share, limit in limits if way is not _extrapolated]
    for way, share, limit in limits:
        left = limit - spent
        if left <= 0 or (failed is not None and failed.kind == DISAGREE):
            continue
        if way is _extrapolated and dynamics.switches.outputs:
            continue  # its steps do not land at switches: it would end at the first and call that a blow-up
        search = _Search(dynamics, end, share * left, watch)
        try:
            reference = way(search)
        except Breakdown as reason:
            if way is _extrapolated and reason.kind != Cause.STEP_LIMIT:
                if dynamics.constraints is None:
                    raise
                continue  # where constraints lose their rank the motion goes on, and others carry it over
            failed = reason if failed is None or reason.time > failed.time or reason.kind == DISAGREE else failed
        except Failure:
            raise
        except Exception as error:
            failed = failed or Breakdown(BROKEN, str(Defect.of(error)), 0.0)
        else:
            return replace(reference, seconds=time.perf_counter() - started, cost=spent + search.spent)
        finally:
            spent += search.spent
    raise failed or Breakdown(Cause.STEP_LIMIT, TOO_DEAR, 0.0)


@dataclass
class _Search:
    """What is sought, what it may cost, and who is told; ``before`` is what solutions cost that are there already."""

    dynamics: Dynamics
    end: float
    limit: float
    watch: Callable[[str], None]
    before: float = 0.0
    meter: Callable[[], float] = field(default=float)

    @property
    def names(self) -> tuple[str, ...]:
        return (*self.dynamics.system.coordinates, *self.dynamics.system.velocities)

    @property
    def longest(self) -> float:
        """No step of an explicit or implicit reference is longer."""
        return self.end / (PARTS if self.dynamics.features.none else FEW_PARTS)

    @property
    def spent(self) -> float:
        """What all solutions cost so far."""
        return self.before + self.meter()

    def reached(self, t: float) -> None:
        """Tells, and raises Breakdown where the limit is spent, or will be long before the end."""
        self.watch(f"reference solution, t = {t:.4g} of {self.end:g}")
        spent, allowed = self.meter(), self.limit - self.before
        far_too_long = 4.0 if spent < allowed / 2 else 1.5
        some = max(allowed / 4, SOME)
        later = spent - 2 * FOLLOWED * LOOKED_AT  # steps are looked at in the beginning only
        if spent > allowed or (spent > some and later * self.end > far_too_long * allowed * t):
            raise Breakdown(Cause.STEP_LIMIT, TOO_DEAR, t)

    def next(self, meter: Callable[[], float]) -> None:
        """Begins another solution from 0 to the end, which costs what ``meter`` shows."""
        self.before, self.meter = self.spent, meter

    def next_of(self, runs: Sequence[tuple[Working, str, str]], looked_at: bool = False) -> None:
        """The same for runs, with the names of their methods and arithmetics."""
        meter = Meter(self.dynamics, looked_at)
        meter.start(runs)
        self.next(lambda: meter.spent)

    def usual(self, times: Any, states: Any) -> Any:
        return sizes_of_scene(self.dynamics, times, states)

    def finished(self, times: Any, states: Any, differences: Any, method: str, way: str) -> Reference:
        """With ``differences`` (2n,) from a second solution, each relative to its scale then."""
        states = np.asarray(states, dtype=float)
        places = np.unique(np.linspace(0, len(times) - 1, 1000).astype(int))
        scale = scaled(np.max(np.abs(states), axis=1), self.usual(times[places], states[:, places]), differences)
        error = float(np.max(differences / scale))
        if not error < AGREE:
            why = Message("[[methods]] differ by [[error]]", methods=method, error=f"{error:.1e}")
            raise Breakdown(DISAGREE, why, self.end, states[:, -1])
        return Reference(times, states, error, 0.0, method, scale, way)


# --- extrapolation in many bits ---


def _extrapolated(search: _Search) -> Reference:
    with ctx.workprec(BITS):
        times, exact = _knots(search)
        differences = _second(search, times, exact)
        knots = np.array([in_doubles(state) for state in exact]).T
    places, states, missed = _between(search, np.array(times), knots)
    message = Message("extrapolation, [[bits]] bits", bits=BITS)
    return search.finished(places, states, np.maximum(differences, missed), message, EXTRAPOLATION)


def _knots(search: _Search) -> tuple[list[float], list[list[arb]]]:
    """The steps of the first extrapolation."""
    run = Extrapolation(search.dynamics, FINE, COLUMNS, inf)
    search.next(lambda: precise_cost(search.dynamics, run.evaluations))
    times, states = [0.0], [list(run.state)]
    while run.time < search.end:
        run.step(search.end)
        times.append(run.time)
        states.append(list(run.state))
        search.reached(run.time)
    return times, states


def _second(search: _Search, times: list[float], states: list[list[arb]]) -> Any:
    """Largest |x_i - y_i| of an extrapolation with fewer columns, larger errors, and so with other steps."""
    run = Extrapolation(search.dynamics, ROUGH, COLUMNS - 3, inf)
    search.next(lambda: precise_cost(search.dynamics, run.evaluations))
    worst = np.zeros(len(states[0]))
    for place in sorted({*range(EVERY, len(times), EVERY), len(times) - 1}):
        run.advance(times[place])
        search.reached(run.time)
        worst = np.maximum(worst, [abs(float(x - y)) for x, y in zip(run.state, states[place], strict=True)])
    return worst


def _between(search: _Search, times: Any, knots: Any) -> tuple[Any, Any, Any]:
    """(places, states there, by how much the explicit method misses the next knot, (2n,))."""
    scalar = EXTENDED if available(EXTENDED) else FLOAT64
    run = METHODS["dop853"].start(search.dynamics, Setting(BETWEEN, longest=search.end / PARTS), scalar)
    search.next_of([(run, "dop853", scalar)])
    inside = max(len(SHARES), -(-PLACES // (len(times) - 1)))
    places, states, missed = [times[:1]], [knots[:, :1]], np.zeros(len(knots))
    for k in range(len(times) - 1):
        run.restart(float(times[k]), knots[:, k].astype(np.longdouble if scalar == EXTENDED else float))
        instants = np.append(uneven(times[k], times[k + 1], inside), times[k + 1])
        found = run.fill(instants)
        with np.errstate(all="ignore"):
            missed = np.maximum(missed, np.abs(found[:, -1] - knots[:, k + 1]).astype(float))
        found[:, -1] = knots[:, k + 1]
        places.append(instants)
        states.append(found)
        search.reached(float(times[k + 1]))
    return np.concatenate(places), np.hstack(states), np.where(np.isfinite(missed), missed, np.inf)


# --- two methods that agree ---


def _explicit(search: _Search) -> Reference:
    scalar = EXTENDED if available(EXTENDED) else FLOAT64
    longest = search.longest
    first = METHODS["dop853"], Setting(1e-18, longest=longest)
    for name, tolerance in (("taylor", 1e-18), ("rk45", 1e-13)):
        try:
            return _agreeing(search, first, (METHODS[name], Setting(tolerance, longest=longest)), scalar, EXPLICIT)
        except Unusable:
            continue
    raise Breakdown(Cause.STEP_LIMIT, "no second method", 0.0)


def _implicit(search: _Search) -> Reference:
    longest = search.longest
    failed: Breakdown | None = None
    for tolerance in (1e-12, 1e-9):
        first, second = ((METHODS[name], Setting(tolerance, longest=longest)) for name in ("rodas5p", "radau"))
        try:
            return _agreeing(search, first, second, FLOAT64, IMPLICIT)
        except Breakdown as reason:
            failed = reason
    assert failed is not None
    raise failed


def _agreeing(search: _Search, first: _Way, second: _Way, scalar: str, way: str) -> Reference:
    """The first of two methods as a reference, by how far the second one differs over the whole interval."""
    (method, fine), (other, rough) = first, second
    try:
        with np.errstate(all="ignore"):
            run, beside = (m.start(search.dynamics, setting, scalar) for m, setting in (first, second))
            names = (method.traits.name, other.traits.name)
            search.next_of([(run, names[0], scalar), (beside, names[1], scalar)], looked_at=True)
            comparison = compared(beside, run, search.end, search.names, search.usual, watch=search.reached)
            places = np.union1d(comparison.times, uneven(0.0, search.end, PLACES))
            states, beside = (_filled(search, m, s, scalar, places) for m, s in (first, second))
            missed = np.max(np.abs(states - beside), axis=1).astype(float)
    except Ended as ended:
        raise ended.breakdown from None
    differences = np.maximum(missed, [q.largest for q in comparison.quantities])
    text = "[[methods]] in [[scalar]], tolerances [[tolerances]]"
    methods, scalars = enumerated((method.traits.name, other.traits.name)), Message(scalar)
    message = Message(text, methods=methods, scalar=scalars, tolerances=f"{fine.tolerance:g}, {rough.tolerance:g}")
    return search.finished(places, states, differences, message, way)


_Way = tuple[Method, Setting]


def _filled(search: _Search, method: Method, setting: Setting, scalar: str, places: Any) -> Any:
    """The states (2n, m) of a run from the first of the places on."""
    run = method.start(search.dynamics, setting, scalar)
    search.next_of([(run, method.traits.name, scalar)])
    return filled(run, places, 64, search.reached)


#: The ways, and the part of what is left which each of them may cost.
WAYS = ((_extrapolated, 0.35), (_explicit, 0.85), (_implicit, 1.0))
