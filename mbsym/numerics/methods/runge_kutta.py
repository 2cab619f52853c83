"""Explicit Runge-Kutta methods whose loop over steps runs in machine code.

``rk4`` takes fixed steps; ``rk45`` and ``dop853`` choose theirs from an error estimate, with the controller of
Hairer, Norsett & Wanner (Solving Ordinary Differential Equations I, II.4; proportional and integral part, IV.2 of
volume II) and dense output between steps.  Sums over steps are compensated (Kahan), so that a million small steps lose
no more digits than a thousand large ones.

A step of a fixed-step method is shortened so that a whole number of them leads from one time asked for to the next.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, isfinite, log
from typing import Any

import numpy as np

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT32, FLOAT64, Code
from mbsym.numerics.kernels.llvm import SCALARS, Library, Scalar, available, compiled
from mbsym.numerics.kernels.writer import INTEGER, POINTER, Function, Value, clock_kind
from mbsym.numerics.methods.interface import (
    BLOW_UP,
    LARGEST,
    STEP_LIMIT,
    STUCK,
    Breakdown,
    Setting,
    Traits,
    Unusable,
    Work,
)
from mbsym.numerics.methods.kept import compiled_kernel, once
from mbsym.numerics.methods.tableaux import DOP853, RK4, RK45, Row, Tableau

#: Machine code is left after about so many operations, so that Ctrl-C and progress bars work.
OPERATIONS_AT_A_TIME = 20_000_000

#: How much a step may grow or shrink at once, and the safety factor of the controller.  With 3/4 instead of the usual
#: 0.9 hardly a step is rejected: over nine systems and tolerances from 1e-5 to 1e-11 dop853 needs 13 % fewer
#: evaluations to equal error (3 to 21 % by the system), rk45 some 5 %.
GROWTH, SHRINKAGE, SAFETY = 6.0, 0.2, 0.75

#: The exponent of the integral part, by the order of the method.
INTEGRAL = {5: Fraction(4, 100), 8: Fraction(3, 100)}

# Places in the arrays that the machine code and Python share.
TIME, TIME_CARRY, START, STEP, LAST, UNTIL, RELATIVE, ABSOLUTE, PREVIOUS, LONGEST = range(10)
STEPS, REJECTED, EVALUATIONS, FRESH, INFINITE, CAREFUL = range(6)
REACHED, PAUSED, STOPPED = range(3)


class Stages:
    """Text for the stages of a tableau: state ``x``, slopes ``k`` stage by stage, (t, x) of a stage in ``argument``."""

    def __init__(self, function: Function, size: int, scalar: Scalar, apart: bool = False) -> None:
        self.f, self.size, self.scalar, self.apart = function, size, scalar, apart
        self.kind, self.clock = scalar.type, clock_kind(scalar)
        self.argument = function.slot(self.kind, size + 1)

    def slope(self, k: Value, stage: int) -> Value:
        """Where the slopes of a stage begin."""
        return self.f.at(self.kind, k, stage * self.size)

    def combination(self, k: Value, row: Row, i: Value | int) -> Value:
        """sum_j row_j k_j, component i."""
        total: Value | None = None
        for j, weight in enumerate(row):
            if weight:
                term = self.f.number(weight, self.kind) * self.f.load(self.kind, k, i + j * self.size)
                total = term if total is None else total + term
        assert total is not None
        return total

    def evaluate(self, time: Value, result: Value) -> None:
        """f at ``time`` and the states that ``argument`` holds."""
        self.f.store(time.converted(self.kind), self.kind, self.argument)
        self.f.do("rhs", self.argument, result, apart=self.apart)

    def stage(self, x: Value, k: Value, row: Row, number: int, time: Value, step: Value) -> None:
        """k_number = f(t + c h, x + h sum_j row_j k_j)."""
        h = step.converted(self.kind)
        for i in self.f.each(self.size):
            moved = self.f.load(self.kind, x, i) + h * self.combination(k, row, i)
            self.f.store(moved, self.kind, self.argument, i + 1)
        self.evaluate(time + step * sum(row, Fraction(0)), self.slope(k, number))

    def copy(self, source: Value, target: Value) -> None:
        for i in self.f.each(self.size):
            self.f.store(self.f.load(self.kind, source, i), self.kind, target, i)

    def state_argument(self, x: Value) -> None:
        """The argument's states are x."""
        self.copy(x, self.f.at(self.kind, self.argument, 1))


def add_compensated(f: Function, kind: str, x: Value, carry: Value, i: Value | int, change: Value) -> Value:
    """x_i + change with the rounding error of the last time put back in (Kahan); returns the new x_i."""
    old = f.load(kind, x, i)
    wanted = change - f.load(kind, carry, i)
    new = old + wanted
    f.store((new - old) - wanted, kind, carry, i)
    f.store(new, kind, x, i)
    return new


def fixed_text(tableau: Tableau, size: int, scalar: Scalar) -> str:
    """``i64 @fixed(x, carry, clock, first, last)``: steps number first to last - 1 of an interval; how many were made.

    Stops early where a component is not finite.  clock: START and STEP.
    """
    arguments = [(name, POINTER) for name in ("x", "carry", "clock")] + [("first", INTEGER), ("last", INTEGER)]
    f = Function("fixed", arguments)
    s = Stages(f, size, scalar)
    k, x, carry = f.slot(s.kind, len(tableau.stages) * size), f.slot(s.kind, size), f.slot(s.kind, size)
    s.copy(f["x"], x)
    s.copy(f["carry"], carry)
    start, step = f.load(s.clock, f["clock"], START), f.load(s.clock, f["clock"], STEP)
    with f.repeat(f["last"], f["first"]) as number:
        time = start + number.converted(s.clock) * step
        s.state_argument(x)
        s.evaluate(time, s.slope(k, 0))
        for place, row in enumerate(tableau.stages[1:], 1):
            s.stage(x, k, row, place, time, step)
        total = f.slot(s.kind)
        f.store(0, s.kind, total)
        h = step.converted(s.kind)
        for i in f.each(size):
            new = add_compensated(f, s.kind, x, carry, i, h * s.combination(k, tableau.weights, i))
            f.store(f.load(s.kind, total) + (new - new), s.kind, total)
        finite, over = f.label(), f.label()
        f.branch(f.load(s.kind, total).compare("<=", 0), finite, over)
        f.place(over)
        s.copy(x, f["x"])
        f.leave(number - f["first"])
        f.place(finite)
    s.copy(x, f["x"])
    s.copy(carry, f["carry"])
    f.leave(f["last"] - f["first"])
    return f.text()


def adaptive_text(tableau: Tableau, size: int, scalar: Scalar) -> str:
    """``i64 @adaptive(x, carry, old, k, clock, count, budget)``: steps until clock[UNTIL] is reached or passed.

    Returns REACHED, PAUSED (after ``budget`` attempted steps) or STOPPED (the step size has become too small).
    ``old`` is the state before the last step, ``k`` its stages.
    """
    names = ("x", "carry", "old", "k", "clock", "count")
    f = Function("adaptive", [(name, POINTER) for name in names] + [("budget", INTEGER)])
    s = Stages(f, size, scalar)
    x, k, clock, count = f["x"], f["k"], f["clock"], f["count"]
    stages = len(tableau.stages)
    candidate, unchanged = f.slot(s.kind, size), f.slot(s.kind, size)
    left = f.slot(INTEGER)
    f.store(f["budget"], INTEGER, left)
    relative = f.load(s.clock, clock, RELATIVE).converted(s.kind)
    absolute = f.load(s.clock, clock, ABSOLUTE).converted(s.kind)

    again, some, step_now, large, tried, good, bad = (f.label() for _ in range(7))
    f.jump(again)
    f.place(again)
    time = f.load(s.clock, clock, TIME)
    with _leaving(f, time.compare(">=", f.load(s.clock, clock, UNTIL)), REACHED):
        pass
    with _leaving(f, f.load(INTEGER, left).compare("<=", 0), PAUSED):
        pass
    f.store(f.load(INTEGER, left) - 1, INTEGER, left)
    step = f.load(s.clock, clock, STEP)
    least = time.absolute() * (4 * Fraction(float(np.finfo(_dtype(s.clock)).eps)))
    f.branch(step.compare(">", least) & step.compare(">", Fraction(1, 10**200)), large, some)
    f.place(some)
    f.leave(STOPPED)
    f.place(large)
    # The last slope of an accepted step is the first of the next; it is copied late because dense output needs both.
    with f.when(f.load(INTEGER, count, FRESH).compare("!=", 0)):
        s.copy(s.slope(k, stages), s.slope(k, 0))
        f.store(0, INTEGER, count, FRESH)
    f.jump(step_now)
    f.place(step_now)
    for place, row in enumerate(tableau.stages[1:], 1):
        s.stage(x, k, row, place, time, step)
    h = step.converted(s.kind)
    for i in f.each(size):
        change = h * s.combination(k, tableau.weights, i)
        f.store(change, s.kind, unchanged, i)
        f.store(f.load(s.kind, x, i) + change, s.kind, candidate, i)
    if tableau.first_same_as_last:
        s.state_argument(candidate)
        s.evaluate(time + step, s.slope(k, stages))
    error = _error(f, s, tableau, x, candidate, k, step, relative, absolute)
    evaluations = stages - 1 + tableau.first_same_as_last
    f.store(f.load(INTEGER, count, EVALUATIONS) + evaluations, INTEGER, count, EVALUATIONS)
    f.jump(tried)
    f.place(tried)
    f.branch(error.compare("<=", 1), good, bad)

    f.place(bad)
    usable = error.compare("<", Fraction(10) ** 30)
    power = f.call("exp", "double", f.call("log", "double", error) * Fraction(-1, tableau.order)) * Fraction(SAFETY)
    shrink = power.compare(">", Fraction(SHRINKAGE)).choose(power, f.number(Fraction(SHRINKAGE), "double"))
    shrink = usable.choose(shrink, f.number(Fraction(1, 10), "double"))
    f.store(step * shrink.converted(s.clock), s.clock, clock, STEP)
    f.store(f.load(INTEGER, count, REJECTED) + 1, INTEGER, count, REJECTED)
    f.store(usable.choose(f.number(0, INTEGER), f.number(1, INTEGER)), INTEGER, count, INFINITE)
    f.store(1, INTEGER, count, CAREFUL)
    f.jump(again)

    f.place(good)
    for i in f.each(size):
        f.store(f.load(s.kind, x, i), s.kind, f["old"], i)
        add_compensated(f, s.kind, x, f["carry"], i, f.load(s.kind, unchanged, i))
    f.store(time, s.clock, clock, START)
    f.store(step, s.clock, clock, LAST)
    add_compensated(f, s.clock, clock, f.at(s.clock, clock, TIME_CARRY), TIME, step)
    if not tableau.first_same_as_last:
        s.state_argument(x)
        s.evaluate(f.load(s.clock, clock, TIME), s.slope(k, stages))
        f.store(f.load(INTEGER, count, EVALUATIONS) + 1, INTEGER, count, EVALUATIONS)
    f.store(1, INTEGER, count, FRESH)
    f.store(0, INTEGER, count, INFINITE)
    f.store(f.load(INTEGER, count, STEPS) + 1, INTEGER, count, STEPS)
    _grow(f, s, tableau, error, step)
    f.jump(again)
    return f.text()


@contextmanager
def _leaving(f: Function, bit: Value, result: int) -> Iterator[None]:
    """Returns ``result`` if the bit is set."""
    yes, no = f.label(), f.label()
    f.branch(bit, yes, no)
    f.place(yes)
    yield
    f.leave(result)
    f.place(no)


def _error(
    f: Function,
    s: Stages,
    tableau: Tableau,
    x: Value,
    new: Value,
    k: Value,
    step: Value,
    relative: Value,
    absolute: Value,
) -> Value:
    """The estimated error of a step, 1 where it is just tolerable.

    One estimate e:  h |e|;  two, as in DOP853:  h e5^2 / sqrt(e5^2 + e3^2/100)  (root mean squares, scaled).
    """
    totals = [f.slot("double") for _ in tableau.errors]
    for total in totals:
        f.store(0, "double", total)
    for i in f.each(size := s.size):
        before, after = f.load(s.kind, x, i).absolute(), f.load(s.kind, new, i).absolute()
        scale = absolute + relative * before.compare("<", after).choose(after, before)
        inverse = 1 / scale
        for total, row in zip(totals, tableau.errors, strict=True):
            one = (s.combination(k, row, i) * inverse).converted("double")
            f.store(f.load("double", total) + one * one, "double", total)
    squares = [f.load("double", total) for total in totals]
    h = step.converted("double").absolute()
    if len(squares) == 1:
        return h * f.call("sqrt", "double", squares[0] / size)
    bottom = (squares[0] + squares[1] * Fraction(1, 100)) * size
    nothing = bottom.compare("<=", 0)
    root = f.call("sqrt", "double", nothing.choose(f.number(1, "double"), bottom))
    return h * squares[0] / root


def _grow(f: Function, s: Stages, tableau: Tableau, error: Value, step: Value) -> None:
    """h <- h min(6, max(1/5, 3/4 err^-a before^b)) with a = 1/q - 3b/4; no growth right after a rejected step."""
    clock, count = f["clock"], f["count"]
    integral = INTEGRAL[tableau.order]
    alpha = Fraction(1, tableau.order) - integral * Fraction(3, 4)
    floor = f.number(Fraction(1, 10**10), "double")
    seen = error.compare(">", floor).choose(error, floor)
    size = f.call("log", "double", seen)
    before = f.load(s.clock, clock, PREVIOUS).converted("double")
    factor = f.call("exp", "double", before * integral - size * alpha) * Fraction(SAFETY)
    most = f.load(INTEGER, count, CAREFUL).compare("!=", 0)
    limit = most.choose(f.number(1, "double"), f.number(Fraction(GROWTH), "double"))
    factor = factor.compare("<", limit).choose(factor, limit)
    least = f.number(Fraction(SHRINKAGE), "double")
    factor = factor.compare(">", least).choose(factor, least)
    grown = step * factor.converted(s.clock)
    longest = f.load(s.clock, clock, LONGEST)
    f.store(grown.compare("<", longest).choose(grown, longest), s.clock, clock, STEP)
    lower = f.number(Fraction(log(1e-4)), "double")
    kept = size.compare(">", lower).choose(size, lower)
    f.store(kept.converted(s.clock), s.clock, clock, PREVIOUS)
    f.store(0, INTEGER, count, CAREFUL)


def dense_text(tableau: Tableau, size: int, scalar: Scalar) -> str:
    """Dense output of the last step.

    ``i64 @prepare(x, old, k, terms, clock)`` computes the terms F, ``i64 @between(old, terms, share, out)`` their sum.
    """
    f = Function("prepare", [(name, POINTER) for name in ("x", "old", "k", "terms", "clock")])
    s = Stages(f, size, scalar, apart=True)  # once an output: not worth compiling over and over
    k, stages = f["k"], len(tableau.stages)
    time, step = f.load(s.clock, f["clock"], START), f.load(s.clock, f["clock"], LAST)
    for place, row in enumerate(tableau.extra):
        s.stage(f["old"], k, row, stages + 1 + place, time, step)
    h = step.converted(s.kind)
    for i in f.each(size):
        change = f.load(s.kind, f["x"], i) - f.load(s.kind, f["old"], i)
        first, last = h * f.load(s.kind, k, i), h * f.load(s.kind, k, i + stages * size)
        terms = [change, first - change, 2 * change - (first + last)]
        terms += [h * s.combination(k, row, i) for row in tableau.dense]
        for place, term in enumerate(terms):
            f.store(term, s.kind, f["terms"], i + place * size)
    f.leave(0)
    g = Function("between", [(name, POINTER) for name in ("old", "terms", "share", "out")])
    kind = s.kind
    share = g.load(kind, g["share"])
    rest = 1 - share
    for i in g.each(size):
        total: Value | None = None
        for place in reversed(range(len(tableau.dense) + 3)):
            term = g.load(kind, g["terms"], i + place * size)
            total = term if total is None else term + total
            total = total * (share if place % 2 == 0 else rest)
        assert total is not None
        g.store(g.load(kind, g["old"], i) + total, kind, g["out"], i)
    g.leave(0)
    return f.text() + g.text()


def _dtype(kind: str) -> Any:
    return np.longdouble if kind == "x86_fp80" else np.float64


def mathematics(code: Code, scalar: Scalar) -> str:
    """Declarations that the drivers need and the code has not made already."""
    own = {code.program.instructions[number].operation for number in code.program.live(code.outputs)}
    missing = [name for name in ("exp", "log", "sqrt") if not (name in own and scalar.type == "double")]
    return "".join(f"declare double @{name}(double) #1\n" for name in missing)


def driver(dynamics: Dynamics, tableau: Tableau, scalar: str) -> Library:
    """The compiled method on the compiled right-hand side."""

    def make() -> Library:
        chosen, code = SCALARS[scalar], dynamics.right_hand_side
        size = 2 * dynamics.size
        if tableau.errors:
            text = mathematics(code, chosen) + adaptive_text(tableau, size, chosen) + dense_text(tableau, size, chosen)
        else:
            text = fixed_text(tableau, size, chosen)
        return compiled({"rhs": code}, scalar, text, many=False)

    return once(dynamics, ("runge-kutta", tableau.name, scalar), make)


def aligned(shape: int | tuple[int, ...], dtype: Any) -> Any:
    """Zeros that begin a cache line: a vector register filled from two lines, one just written, takes twice as long."""
    count, width = int(np.prod(shape)), np.dtype(dtype).itemsize
    room = np.zeros(count * width + 64, np.uint8)
    first = -address(room) % 64
    return room[first : first + count * width].view(dtype).reshape(shape)


def address(array: Any) -> int:
    found: int = array.ctypes.data
    return found


class _Arrays:
    """What runs of either kind share: state, its carried rounding errors, the clock."""

    def __init__(self, dynamics: Dynamics, setting: Setting, scalar: str) -> None:
        chosen = SCALARS[scalar]
        self.size = 2 * dynamics.size
        self.dtype, self.clock_type = chosen.dtype, _dtype(clock_kind(chosen))
        self.x, self.carry = aligned(self.size, self.dtype), aligned(self.size, self.dtype)
        self.x[:] = initial_state(dynamics, self.dtype)
        self.clock = aligned(10, self.clock_type)
        self.work = Work()
        self.time = 0.0
        self.state = self.x.copy()
        self.limit = setting.step_limit

    def fail(self, kind: str, message: str, time: float, state: Any) -> Breakdown:
        return Breakdown(kind, message, float(time), np.array(state, dtype=float))


def initial_state(dynamics: Dynamics, dtype: Any) -> Any:
    """The scenario's state, correctly rounded."""
    return np.array([exact_number(x, dtype) for x in dynamics.scenario.state], dtype)


def exact_number(value: Fraction, dtype: Any) -> Any:
    """A fraction as a number of NumPy's type (float64, float32, longdouble), correctly rounded or nearly so."""
    head = float(value)
    if dtype is np.longdouble:
        return np.longdouble(head) + np.longdouble(float(value - Fraction(head)))
    return head if dtype is np.float64 else dtype(head)


class FixedRun(_Arrays):
    """Steps of one length, shortened so that they end at the times asked for."""

    def __init__(self, dynamics: Dynamics, tableau: Tableau, setting: Setting, scalar: str) -> None:
        super().__init__(dynamics, setting, scalar)
        if setting.step is None or not (isfinite(setting.step) and setting.step > 0):
            raise Unusable(f"{tableau.name} needs a step (--step)")
        self.step = setting.step
        self.stages = len(tableau.stages)
        library = driver(dynamics, tableau, scalar)
        self._library = library
        pointer, whole = ctypes.c_void_p, ctypes.c_int64
        self._fixed = library.function("fixed", pointer, pointer, pointer, whole, whole, result=whole)
        self._pointers = tuple(address(array) for array in (self.x, self.carry, self.clock))
        self._at_once = max(1, OPERATIONS_AT_A_TIME // (self.stages * (dynamics.right_hand_side.operations + 10)))

    def advance(self, until: float) -> Any:
        length = until - self.time
        if length <= 0:
            return self.state
        count = max(1, ceil(length / self.step * (1 - 1e-9)))
        step = self.clock_type(length) / count
        self.clock[START], self.clock[STEP] = self.time, step
        done = 0
        while done < count:
            if self.work.steps >= self.limit:
                now = self.time + done * float(step)
                raise self.fail(STEP_LIMIT, f"{self.work.steps} steps", now, self.x)
            last = min(count, done + min(self._at_once, self.limit - self.work.steps))
            before = self.x.copy()
            made = self._fixed(*self._pointers, done, last)
            self.work.steps += made
            self.work.evaluations += self.stages * made
            if made < last - done:
                now = self.time + (done + made) * float(step)
                known = np.isfinite(before)
                raise self.fail(BLOW_UP, "a value is no longer finite", now, np.where(known, before, 0.0))
            done = last
        self.time = until
        self.state = self.x.copy()
        return self.state


class AdaptiveRun(_Arrays):
    """Steps chosen by the error estimate; times between steps come from dense output."""

    def __init__(self, dynamics: Dynamics, tableau: Tableau, setting: Setting, scalar: str) -> None:
        super().__init__(dynamics, setting, scalar)
        self.tableau = tableau
        library = driver(dynamics, tableau, scalar)
        pointer, whole = ctypes.c_void_p, ctypes.c_int64
        self._adaptive = library.function("adaptive", *[pointer] * 6, whole, result=whole)
        self._prepare = library.function("prepare", *[pointer] * 5, result=whole)
        self._between = library.function("between", *[pointer] * 4, result=whole)
        self._library = library
        rows = len(tableau.stages) + 1 + len(tableau.extra)
        self.old = aligned(self.size, self.dtype)
        self.old[:] = self.x
        self.k = aligned((rows, self.size), self.dtype)
        self.terms = aligned((3 + len(tableau.dense), self.size), self.dtype)
        self.count = aligned(6, np.int64)
        self.share = np.zeros(1, self.dtype)
        self.out = np.zeros(self.size, self.dtype)
        arrays = (self.x, self.carry, self.old, self.k, self.clock, self.count)
        self._pointers = tuple(address(array) for array in arrays)
        self._for_terms = tuple(address(array) for array in (self.x, self.old, self.k, self.terms, self.clock))
        self._for_state = tuple(address(array) for array in (self.old, self.terms, self.share, self.out))
        self._prepared = -1
        tolerance = setting.tolerance if setting.tolerance is not None else 1e-9
        smallest = 4 * float(np.finfo(self.dtype).eps)
        self.clock[RELATIVE], self.clock[ABSOLUTE] = max(tolerance, smallest), tolerance
        self.clock[PREVIOUS] = log(1e-4)
        f = compiled_kernel(dynamics, "right_hand_side", scalar)
        self.clock[LONGEST] = 1e30 if setting.longest is None else setting.longest
        first = self._first_step(f, max(tolerance, smallest), tolerance)
        self.clock[STEP] = min(first, float(self.clock[LONGEST]))
        self._at_once = max(1, OPERATIONS_AT_A_TIME // (rows * (dynamics.right_hand_side.operations + 10)))

    def _first_step(self, f: Any, relative: float, absolute: float) -> float:
        """Hairer, Norsett & Wanner, II.4, starting step size."""

        def size(values: Any) -> float:
            return float(np.sqrt(np.mean((values / scale) ** 2))) if self.size else 0.0

        with np.errstate(all="ignore"):
            scale = absolute + np.abs(self.x) * relative
            slope = self.k[0] = f(np.concatenate(([self.dtype(0)], self.x)))
            position, speed = size(self.x), size(slope)
            if not isfinite(speed):
                return 1e-6
            first = 1e-6 if position < 1e-5 or speed < 1e-5 else max(0.01 * position / speed, 1e-100)
            there = f(np.concatenate(([self.dtype(first)], self.x + self.dtype(first) * slope)))
            bend = size(there - slope) / first
            self.work.evaluations += 2
            if not isfinite(bend):
                return 1e-6
            largest = max(speed, bend)
            second = max(1e-6, first * 1e-3) if largest <= 1e-15 else (0.01 / largest) ** (1 / self.tableau.order)
            return float(min(100 * first, second))

    def advance(self, until: float) -> Any:
        self.clock[UNTIL] = until
        while True:
            left = self.limit - self.work.steps - self.work.rejected
            if left <= 0 and self.clock[TIME] < until:
                raise self.fail(STEP_LIMIT, f"{self.work.steps} steps", self.clock[TIME], self.x)
            reply = self._adaptive(*self._pointers, min(self._at_once, max(left, 1)))
            self._counted()
            if reply == REACHED:
                break
            if reply == STOPPED:
                size = float(np.max(np.abs(self.x), initial=0.0))
                steep = float(np.max(np.abs(self.k[0]), initial=0.0))
                if self.count[INFINITE] or not size < LARGEST or not steep < LARGEST:
                    message = f"values or rates grow too large to go on (largest rate {steep:.2g})"
                    raise self.fail(BLOW_UP, message, self.clock[TIME], self.x)
                raise self.fail(STUCK, f"step {float(self.clock[STEP]):.2g}", self.clock[TIME], self.x)
        self.time = until
        self.state = self._at(until)
        return self.state

    def _counted(self) -> None:
        work, count = self.work, self.count
        work.steps, work.rejected = int(count[STEPS]), int(count[REJECTED])
        work.evaluations += int(count[EVALUATIONS])
        count[EVALUATIONS] = 0

    def _at(self, until: float) -> Any:
        if self.clock[TIME] == until or not self.count[STEPS]:
            return self.x.copy()
        if self._prepared != self.count[STEPS]:
            self._prepare(*self._for_terms)
            self.work.evaluations += len(self.tableau.extra)
            self._prepared = int(self.count[STEPS])
        self.share[0] = (self.clock_type(until) - self.clock[START]) / self.clock[LAST]
        self._between(*self._for_state)
        return self.out.copy()


@dataclass(frozen=True)
class RungeKutta:
    """A method given by its tableau."""

    tableau: Tableau

    @property
    def traits(self) -> Traits:
        tableau = self.tableau
        scalars = (FLOAT64, FLOAT32, EXTENDED)
        return Traits(
            name=tableau.name,
            title=f"{tableau.title}, compiled",
            order=tableau.order,
            fixed=not tableau.errors,
            scalars=scalars,
        )

    def start(self, dynamics: Dynamics, setting: Setting, scalar: str = FLOAT64) -> FixedRun | AdaptiveRun:
        """A run of compiled steps.  Raises Unusable for an arithmetic that this machine lacks, or without a step."""
        if not available(scalar):
            raise Unusable(f"this machine has no {scalar} arithmetic")
        run = AdaptiveRun if self.tableau.errors else FixedRun
        return run(dynamics, self.tableau, setting, scalar)


METHODS: Sequence[RungeKutta] = tuple(RungeKutta(tableau) for tableau in (RK4, RK45, DOP853))
