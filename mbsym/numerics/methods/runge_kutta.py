"""Runge-Kutta methods whose loop over steps runs in machine code: explicit ones, and of Rosenbrock's kind.

``rk4`` takes fixed steps; ``rk45``, ``dop853`` and, for stiff systems, ``rodas5p`` choose theirs from an error
estimate, with the controller of Hairer, Norsett & Wanner (Solving Ordinary Differential Equations I, II.4; proportional
and integral part, IV.2 of volume II).  Sums over steps are compensated (Kahan), so that a million small steps lose no
more digits than a thousand large ones.  Times between the ends of steps come from dense output, in machine code as
well: rows cost a polynomial each, however many there are.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isfinite, log
from typing import Any

import numpy as np

from mbsym.expressions.message import Message
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT32, FLOAT64, Code
from mbsym.numerics.kernels.llvm import SCALARS, Library, Scalar, available, compiled
from mbsym.numerics.kernels.writer import INTEGER, POINTER, Function, Value, clock_kind
from mbsym.numerics.methods.interface import (
    Breakdown,
    Cause,
    Setting,
    Traits,
    Unusable,
    Work,
    code_of,
    compiled_kernel,
    once,
)
from mbsym.numerics.methods.led import nearly_singular
from mbsym.numerics.methods.magnitudes import counted, first_steps, magnitudes, variables
from mbsym.numerics.methods.marching import ARGUMENTS, adaptive_text, fixed_text
from mbsym.numerics.methods.nested import Nested
from mbsym.numerics.methods.stepping import Stepping
from mbsym.numerics.methods.tableaux import (
    DOP853,
    RK4,
    RK45,
    RODAS5P,
    Clock,
    Count,
    Reply,
    Rosenbrock,
    Stages,
    Tableau,
    address,
    aligned,
    clock_dtype,
    initial_state,
)

# Machine code for dense output: the terms of the last step, and rows of states at as many times as are asked for.
#
# With s the fraction of a step of length h,
#
#     x(s) = x + s (F0 + (1 - s) (F1 + s (F2 + (1 - s) (F3 + ...)))),
#     F0 = x_new - x,   F1 = h f_old - F0,   F2 = 2 F0 - h (f_old + f_new).
#
# Further terms are those of the tableau; where it has none (steps of one length) they fit q, q' and q'' at both ends,
#
#     q:   F3 = h^2 q''_old / 2 + F1 - F2,   F4 = h^2 q''_new / 2 + F1 + 2 F2 - F3,
#     q':  F3 = 30 ((q_new - q)/h - q'_old - F0/2 - F1/6 - F2/12),                        so that q' = dq/dt,
#
# with an error of order h^6 in q and h^5 in q'.  Where the states are no pairs of q and q', there are no further terms:
# the cubic that fits x and x' at both ends, with an error of order h^4.


def dense_text(tableau: Tableau | Rosenbrock, size: int, scalar: Scalar, pairs: bool = True) -> str:
    """``@prepare``, ``@rows`` and ``@fill``; see there.  ``pairs``: the states are (q, q')."""
    if isinstance(tableau, Rosenbrock):
        prepared = _prepare_linear_text(tableau, size, scalar)
    else:
        prepare = _prepare_text if tableau.errors else _prepare_fixed_text if pairs else _prepare_cubic_text
        prepared = prepare(tableau, size, scalar)
    return prepared + _rows_text(tableau.terms, size, scalar) + _fill_text(scalar)


def _prepare_text(tableau: Tableau, size: int, scalar: Scalar) -> str:
    """``i64 @prepare(x, old, k, terms, clock, count)``: the terms F of the last step."""
    f = Function("prepare", [(name, POINTER) for name in ("x", "old", "k", "terms", "clock", "count")])
    s = Stages(f, size, scalar, apart=True)  # once a step at most: not worth compiling over and over
    k, stages = f["k"], len(tableau.stages)
    time, step = f.load(s.clock, f["clock"], Clock.START), f.load(s.clock, f["clock"], Clock.LAST)
    for place, row in enumerate(tableau.extra):
        s.stage(f["old"], k, row, stages + 1 + place, time, step)
    h = step.converted(s.kind)
    for i in f.each(size):
        change = f.load(s.kind, f["x"], i) - f.load(s.kind, f["old"], i)
        first, last = h * f.load(s.kind, k, i), h * f.load(s.kind, k, i + stages * size)
        terms = [change, first - change, 2 * change - (first + last)]
        terms += [h * s.combination(k, row, i) for row in tableau.dense]
        _keep(f, s, terms, i)
    _count(f, len(tableau.extra))
    f.leave(0)
    return f.text()


def _prepare_linear_text(tableau: Rosenbrock, size: int, scalar: Scalar) -> str:
    """The same of what linear equations gave: nothing is evaluated."""
    f = Function("prepare", [(name, POINTER) for name in ("x", "old", "k", "terms", "clock", "count")])
    s = Stages(f, size, scalar)
    for i in f.each(size):
        change = f.load(s.kind, f["x"], i) - f.load(s.kind, f["old"], i)
        _keep(f, s, [change, *(s.combination(f["k"], row, i) for row in tableau.dense)], i)
    _count(f, 0)
    f.leave(0)
    return f.text()


def _slope_at_the_end(tableau: Tableau, size: int, scalar: Scalar) -> tuple[Function, Stages, Value]:
    """The same as far as the slopes at the end of a step of one length, and h."""
    f = Function("prepare", [(name, POINTER) for name in ("x", "old", "k", "terms", "clock", "count")])
    s = Stages(f, size, scalar, apart=True)
    step = f.load(s.clock, f["clock"], Clock.LAST)
    s.state_argument(f["x"])
    s.evaluate(f.load(s.clock, f["clock"], Clock.TIME), s.slope(f["k"], len(tableau.stages)))
    f.store(1, INTEGER, f["count"], Count.FRESH)
    return f, s, step.converted(s.kind)


def _prepare_fixed_text(tableau: Tableau, size: int, scalar: Scalar) -> str:
    """The same for steps of one length; the slopes at the end, found here, begin the next step."""
    f, s, h = _slope_at_the_end(tableau, size, scalar)
    k, stages, half = f["k"], len(tableau.stages), size // 2
    for i in f.each(half):
        place, speed = i, i + half

        def slopes(row: Value | int) -> tuple[Value, Value, Value]:
            begin, end = h * f.load(s.kind, k, row), h * f.load(s.kind, k, row + stages * size)
            return f.load(s.kind, k, row + (stages + 1) * size), begin, end

        change, begin, end = slopes(place)
        faster, pushed, pushed_last = slopes(speed)
        first, second = begin - change, 2 * change - (begin + end)
        third = h * pushed * Fraction(1, 2) + first - second
        fourth = h * pushed_last * Fraction(1, 2) + first + 2 * second - third
        _keep(f, s, [change, first, second, third, fourth], place)
        first, second = pushed - faster, 2 * faster - (pushed + pushed_last)
        missing = change / h - f.load(s.kind, f["old"], speed) - faster * Fraction(1, 2)
        third = 30 * (missing - first * Fraction(1, 6) - second * Fraction(1, 12))
        _keep(f, s, [faster, first, second, third, f.number(0, s.kind)], speed)
    _count(f, 1)
    f.leave(0)
    return f.text()


def _prepare_cubic_text(tableau: Tableau, size: int, scalar: Scalar) -> str:
    """The same for states that are no pairs."""
    f, s, h = _slope_at_the_end(tableau, size, scalar)
    k, stages = f["k"], len(tableau.stages)
    for i in f.each(size):
        begin, end = h * f.load(s.kind, k, i), h * f.load(s.kind, k, i + stages * size)
        change = f.load(s.kind, k, i + (stages + 1) * size)
        nothing = f.number(0, s.kind)
        _keep(f, s, [change, begin - change, 2 * change - (begin + end), nothing, nothing], i)
    _count(f, 1)
    f.leave(0)
    return f.text()


def _keep(f: Function, s: Stages, terms: list[Value], i: Value | int) -> None:
    for place, term in enumerate(terms):
        f.store(term, s.kind, f["terms"], i + place * s.size)


def _count(f: Function, evaluations: int) -> None:
    f.add(evaluations, INTEGER, f["count"], Count.EVALUATIONS)
    f.store(f.load(INTEGER, f["count"], Count.STEPS), INTEGER, f["count"], Count.PREPARED)


def _rows_text(terms: int, size: int, scalar: Scalar) -> str:
    """``i64 @rows(x, old, terms, clock, times, out, first, last, stride)``: states at times[first:last] of one step.

    Component i of the state at times[r] goes to out[i stride + r].
    """
    pointers = [(name, POINTER) for name in ("x", "old", "terms", "clock", "times", "out")]
    f = Function("rows", [*pointers, *((name, INTEGER) for name in ("first", "last", "stride"))])
    s = Stages(f, size, scalar)
    kind, clock = s.kind, s.clock
    start, length, end = (f.load(clock, f["clock"], place) for place in (Clock.START, Clock.LAST, Clock.TIME))
    inverse = 1 / length
    with f.repeat(size) as i:
        begin, arrived = f.load(kind, f["old"], i), f.load(kind, f["x"], i)
        known = [f.load(kind, f["terms"], i + place * size) for place in range(terms)]
        row = f.at(kind, f["out"], i * f["stride"])
        with f.repeat(f["last"], f["first"]) as r:
            time = f.load(clock, f["times"], r)
            share = ((time - start) * inverse).converted(kind)
            rest = 1 - share
            total: Value | None = None
            for place in reversed(range(terms)):
                total = known[place] if total is None else known[place] + total
                total = total * (share if place % 2 == 0 else rest)
            assert total is not None
            f.store(time.compare("==", end).choose(arrived, begin + total), kind, row, r)
    f.leave(0)
    return f.text()


def _fill_text(scalar: Scalar) -> str:
    """``i64 @fill(x, carry, old, k, clock, count, sizes, terms, times, out, first, last, stride)``: rows, and steps
    for them.

    Returns the number of the first row that is not filled; where that is not ``last``, count[REPLY] says why.
    """
    pointers = [(name, POINTER) for name in (*ARGUMENTS, "terms", "times", "out")]
    f = Function("fill", [*pointers, *((name, INTEGER) for name in ("first", "last", "stride"))])
    clock = Stages(f, 0, scalar).clock
    times, count, last = f["times"], f["count"], f["last"]
    row, end = f.slot(INTEGER), f.slot(INTEGER)
    f.store(f["first"], INTEGER, row)
    slack = f.load(clock, f["clock"], Clock.SLACK)
    reached, stopped, write_rows = (f.label() for _ in range(3))
    again = f.here()
    now = f.load(INTEGER, row)
    f.leave_if(now.compare(">=", last), last)
    f.store(f.load(clock, times, now) - slack, clock, f["clock"], Clock.UNTIL)
    reply = f.call("march", INTEGER, *(f[name] for name in ARGUMENTS))
    f.branch(reply.compare("==", Reply.REACHED), reached, stopped)
    f.place(stopped)
    f.store(reply, INTEGER, count, Count.REPLY)
    f.leave(now)
    f.place(reached)
    with f.when(f.load(INTEGER, count, Count.PREPARED).compare("!=", f.load(INTEGER, count, Count.STEPS))):
        prepared = ("x", "old", "k", "terms", "clock", "count")
        f.call("prepare", INTEGER, *(f[name] for name in prepared))
    f.store(now + 1, INTEGER, end)
    more, one_more = f.label(), f.label()
    check = f.here()
    upto = f.load(INTEGER, end)
    f.branch(upto.compare("<", last), more, write_rows)
    f.place(more)
    within = (f.load(clock, times, upto) - slack).compare("<=", f.load(clock, f["clock"], Clock.TIME))
    f.branch(within, one_more, write_rows)
    f.place(one_more)
    f.store(upto + 1, INTEGER, end)
    f.jump(check)
    f.place(write_rows)
    arguments = [f[name] for name in ("x", "old", "terms", "clock", "times", "out")]
    f.call("rows", INTEGER, *arguments, now, f.load(INTEGER, end), f["stride"])
    f.store(f.load(INTEGER, end), INTEGER, row)
    f.jump(again)
    return f.text()


#: Machine code is left after about so many operations, so that Ctrl-C and progress bars work.
OPERATIONS_AT_A_TIME = 20_000_000

#: Their matrix and its factors stand on the stack.
MOST_EQUATIONS = 200

#: A time that a step of fixed length misses by less than this part of the length needs no further step.
MISSED = 1e-9


def mathematics(codes: Iterable[Code], scalar: Scalar) -> str:
    """Declarations that the drivers need and the codes have not made already."""
    own = {code.program.instructions[number].operation for code in codes for number in code.program.live(code.outputs)}
    missing = [name for name in ("exp", "log", "sqrt") if not (name in own and scalar.type == "double")]
    return "".join(f"declare double @{name}(double) #1\n" for name in missing)


def driver(dynamics: Dynamics, tableau: Tableau | Rosenbrock, scalar: str) -> Library:
    """The compiled method on the compiled right-hand side."""

    def make() -> Library:
        chosen, code = SCALARS[scalar], code_of(dynamics, "right_hand_side", scalar)
        size = dynamics.dimension
        codes, constrained = {"rhs": code}, dynamics.correction is not None
        if constrained:
            codes["correct"] = code_of(dynamics, "correction", scalar)
        if isinstance(tableau, Rosenbrock):
            codes["slopes"] = code_of(dynamics, "slopes", scalar)
        if isinstance(tableau, Tableau) and not tableau.errors:
            text = fixed_text(tableau, size, chosen, constrained)
        else:
            text = adaptive_text(tableau, size, chosen, constrained)
        text += dense_text(tableau, size, chosen, pairs=not dynamics.in_states)
        if tableau.errors:
            text = mathematics(codes.values(), chosen) + text
        return compiled(codes, scalar, text, many=False)

    return once(dynamics, ("runge-kutta", tableau.name, scalar), make)


class CompiledRun(Stepping):
    """Steps and rows in machine code: what runs of either kind share."""

    def __init__(self, dynamics: Dynamics, tableau: Tableau | Rosenbrock, setting: Setting, scalar: str) -> None:
        chosen = SCALARS[scalar]
        size = self.size = dynamics.dimension
        self.tableau, self.limit = tableau, setting.step_limit
        self.dtype, self.clock_type = chosen.dtype, clock_dtype(clock_kind(chosen))
        self._library = library = driver(dynamics, tableau, scalar)
        pointer, whole = ctypes.c_void_p, ctypes.c_int64
        self._march = library.function("march", *[pointer] * 7, result=whole)
        self._prepare = library.function("prepare", *[pointer] * 6, result=whole)
        self._fill = library.function("fill", *[pointer] * 10, whole, whole, whole, result=whole)
        self.x, self.carry, self.old, self.sizes = (aligned(size, self.dtype) for _ in range(4))
        rows = len(tableau.stages) + 2 + len(tableau.extra)
        self.k = aligned((rows, size), self.dtype)
        self.terms = aligned((tableau.terms, size), self.dtype)
        self.clock = aligned(12, self.clock_type)
        self.count = aligned(12, np.int64)
        arrays = (self.x, self.carry, self.old, self.k, self.clock, self.count, self.sizes)
        self._pointers = tuple(address(array) for array in arrays)
        for_terms = (self.x, self.old, self.k, self.terms, self.clock, self.count)
        self._for_terms = tuple(address(array) for array in for_terms)
        self.work = Work()
        operations = rows * (dynamics.right_hand_side.operations + 10)
        if isinstance(tableau, Rosenbrock):
            operations += dynamics.slopes.operations + size**3 + 2 * rows * size**2
        self._at_once = max(1, OPERATIONS_AT_A_TIME // operations)

    def restart(self, time: float, state: Any) -> None:
        """Go on from another state."""
        self.x[:] = self.old[:] = state
        self.carry[:] = 0
        self.terms[:] = 0
        clock, count = self.clock, self.count
        clock[Clock.TIME] = clock[Clock.START] = clock[Clock.BASE] = time
        clock[Clock.TIME_CARRY], clock[Clock.LAST] = 0, 1
        count[Count.SINGULARLY] = 0
        count[Count.FRESH] = count[Count.INFINITE] = count[Count.CAREFUL] = count[Count.NUMBER] = 0
        count[Count.PREPARED] = count[Count.STEPS]
        self.time, self.state = self.reached, self.x.copy()

    def saved(self) -> tuple[Any, ...]:
        """All that the next steps depend on, for ``undo``."""
        return (*(array.copy() for array in self._memory), self.time, np.array(self.state), self.work.steps,
                self.work.rejected)  # fmt: skip

    def undo(self, saved: tuple[Any, ...]) -> None:
        """Back to where ``saved`` was asked for; evaluations since then have been made and stay counted."""
        *arrays, self.time, self.state, self.work.steps, self.work.rejected = saved
        for array, before in zip(self._memory, arrays, strict=True):
            array[...] = before

    @property
    def _memory(self) -> tuple[Any, ...]:
        return self.x, self.carry, self.old, self.k, self.terms, self.clock, self.count, self.sizes

    @property
    def reached(self) -> Any:
        """The end of the last step: a float, or a longdouble where the run is extended."""
        return self.clock[Clock.TIME] if self.clock_type is np.longdouble else float(self.clock[Clock.TIME])

    @property
    def end(self) -> Any:
        """The state there."""
        return self.x

    def curve(self) -> Callable[[Any], Any]:
        """Dense output of the last step, from the terms that machine code computes."""
        if self.count[Count.PREPARED] != self.count[Count.STEPS]:
            self._prepare(*self._for_terms)
            self._counted()
        start, length, reached = (self.clock[place] for place in (Clock.START, Clock.LAST, Clock.TIME))
        before, arrived = self.old.copy()[:, None], self.x.copy()[:, None]
        return Nested(start, length, reached, before, arrived, self.terms.copy()[:, :, None])

    def far(self, until: float) -> None:
        """Steps until ``until`` is reached or passed."""
        self.clock[Clock.UNTIL] = until - self.clock[Clock.SLACK]
        while self.clock[Clock.TIME] < self.clock[Clock.UNTIL]:
            self._allow(self._at_once)
            self._judge(self._march(*self._pointers))

    def one(self, until: float | None = None) -> None:
        """One step that is accepted."""
        before = self.count[Count.STEPS]
        self.clock[Clock.UNTIL] = np.inf
        while self.count[Count.STEPS] == before:
            self._allow(1)
            self._judge(self._march(*self._pointers))

    def advance(self, until: float) -> Any:
        """The state at ``until``: a row."""
        return self.fill(np.array([until]))[:, 0]

    def fill(self, times: Any) -> Any:
        """The states (2n, m) at m increasing times, steps and rows alike in machine code."""
        at = np.ascontiguousarray(times, dtype=self.clock_type)
        states = np.empty((self.size, len(at)), self.dtype)
        done = 0
        try:
            while done < len(at):
                done = self.stretch(at, states, done, self._at_once)
                self.settle(done == len(at))
        except Breakdown as trouble:
            trouble.filled = states[:, :done]
            raise
        if done:
            self.time, self.state = times[-1], states[:, -1].copy()
        return states

    def stretch(self, at: Any, states: Any, done: int, attempts: int) -> int:
        """Fills columns of ``states`` from number ``done`` on, by so many attempted steps; how many are filled then."""
        if at[done] - self.clock[Clock.SLACK] > self.clock[Clock.TIME]:
            self._allow(attempts)
        pointers = (*self._pointers, address(self.terms), address(at), address(states))
        done = self._fill(*pointers, done, len(at), len(at))
        self._counted()
        return done

    def settle(self, whole: bool) -> None:
        """Raises the Breakdown that ended a stretch, if one did; ``whole`` says that all rows are filled."""
        self._judge(Reply.REACHED if whole else int(self.count[Count.REPLY]))

    def some(self, until: float, attempts: int) -> None:
        """Steps towards ``until``, at most so many attempts."""
        self.clock[Clock.UNTIL] = until - self.clock[Clock.SLACK]
        if self.clock[Clock.TIME] < self.clock[Clock.UNTIL]:
            self._allow(attempts)
            self._judge(self._march(*self._pointers))

    def _allow(self, attempts: int) -> None:
        """So many steps may be tried before machine code is left, as far as the limit allows any."""
        left = self.limit - self.work.steps - self.work.rejected
        if left <= 0:
            raise self.work.too_many(self.clock[Clock.TIME], self.x)
        self.count[Count.LEFT] = min(attempts, left)

    def _judge(self, reply: int) -> None:
        self._counted()
        if reply == Reply.STOPPED:
            raise nearly_singular(self.clock[Clock.TIME], self.x) if self.count[Count.SINGULARLY] else self._stopped()

    def _stopped(self) -> Breakdown:
        """Why machine code could not go on."""
        raise NotImplementedError

    def _counted(self) -> None:
        work, count = self.work, self.count
        work.steps, work.rejected = int(count[Count.STEPS]), int(count[Count.REJECTED])
        work.evaluations += int(count[Count.EVALUATIONS])
        work.jacobians += int(count[Count.JACOBIANS])
        count[Count.EVALUATIONS] = count[Count.JACOBIANS] = 0


class FixedRun(CompiledRun):
    """Steps of one length; times between them come from the polynomial that fits q, q' and q'' at both ends."""

    def __init__(
        self, dynamics: Dynamics, tableau: Tableau, setting: Setting, scalar: str, initial: Any, at: float
    ) -> None:
        if setting.step is None or not (isfinite(setting.step) and setting.step > 0):
            raise Unusable(Message("[[name]] needs a step (--step)", name=tableau.name))
        super().__init__(dynamics, tableau, setting, scalar)
        self.step_length = self.clock_type(setting.step)
        self.clock[Clock.STEP], self.clock[Clock.SLACK] = self.step_length, self.step_length * MISSED
        self.restart(at, initial)

    def one(self, until: float | None = None) -> None:
        """A step of the length asked for; a shorter one where it would lead beyond ``until``."""
        clock = self.clock
        room = np.inf if until is None else until - clock[Clock.TIME]
        if room > clock[Clock.STEP] + clock[Clock.SLACK]:
            super().one()
            return
        self._rebased(clock[Clock.TIME], room)
        try:
            super().one()
            clock[Clock.TIME] = until
        finally:
            self._rebased(clock[Clock.TIME], self.step_length)

    def _rebased(self, time: Any, length: Any) -> None:
        """Steps of a length are counted from here."""
        self.clock[Clock.BASE], self.clock[Clock.STEP], self.count[Count.NUMBER] = time, length, 0

    def _stopped(self) -> Breakdown:
        known = np.where(np.isfinite(self.old), self.old, 0.0)
        return Breakdown(Cause.BLOW_UP, "a value is no longer finite", self.clock[Clock.TIME], known)


class AdaptiveRun(CompiledRun):
    """Steps chosen by the error estimate."""

    def __init__(
        self,
        dynamics: Dynamics,
        tableau: Tableau | Rosenbrock,
        setting: Setting,
        scalar: str,
        initial: Any,
        at: float,
    ) -> None:
        super().__init__(dynamics, tableau, setting, scalar)
        tolerance = setting.tolerance if setting.tolerance is not None else 1e-9
        smallest = 4 * float(np.finfo(self.dtype).eps)
        self.clock[Clock.RELATIVE], self.clock[Clock.ABSOLUTE] = max(tolerance, smallest), tolerance
        self.clock[Clock.LONGEST] = 1e30 if setting.longest is None else setting.longest
        self._dynamics = dynamics
        self._rates = counted(compiled_kernel(dynamics, "right_hand_side", scalar), self.work)
        self._kinds = variables(dynamics)
        self.restart(at, initial)

    def restart(self, time: float, state: Any) -> None:
        """Go on from another state, with a step found anew."""
        super().restart(time, state)
        self.clock[Clock.PREVIOUS] = log(1e-4)
        absolute, relative = float(self.clock[Clock.ABSOLUTE]), float(self.clock[Clock.RELATIVE])
        begin, state = np.array([time], self.dtype), self.x[:, None].copy()
        self._magnitudes = magnitudes(self._rates, self._kinds, begin, state)
        floor = self._magnitudes.floor(absolute, float(np.finfo(self.dtype).eps))[:, 0]
        self.sizes[:] = np.maximum(np.abs(self.x), floor)
        order = self.tableau.order
        steps, slopes = first_steps(self._rates, order, self._magnitudes, begin, state, absolute, relative)
        self.k[self.tableau.begin] = slopes[:, 0]
        self.clock[Clock.STEP] = min(float(steps[0]), float(self.clock[Clock.LONGEST]))

    def lengthen(self, length: float) -> None:
        """The next step is tried with this length, where that of a beginning is shorter."""
        clock = self.clock
        clock[Clock.STEP] = min(max(float(clock[Clock.STEP]), length), float(clock[Clock.LONGEST]))

    def one(self, until: float | None = None) -> None:
        """One step that is accepted; where ``until`` shortens it, the next one is as long as it would have been."""
        clock = self.clock
        room = np.inf if until is None else until - clock[Clock.TIME]
        length = clock[Clock.STEP]
        if length < room:
            if 2 * length > room:
                clock[Clock.STEP] = room / 2  # rather two of a length than one that is tiny
            super().one()
            return
        assert until is not None
        least = 8 * np.finfo(self.clock_type).eps * max(abs(clock[Clock.TIME]), abs(until))
        if room <= least:
            self._over(until)
            return
        clock[Clock.STEP] = room
        super().one()
        if clock[Clock.LAST] == room:
            clock[Clock.TIME], clock[Clock.TIME_CARRY] = until, 0
            clock[Clock.STEP] = max(clock[Clock.STEP], length)

    def _over(self, until: float) -> None:
        """To a time that is no further than roundings: the state is the same."""
        self.old[:], self.terms[:] = self.x, 0
        self.clock[Clock.START], self.clock[Clock.TIME], self.clock[Clock.TIME_CARRY] = self.clock[Clock.TIME], until, 0
        self.clock[Clock.LAST] = 1
        self.count[Count.PREPARED] = self.count[Count.STEPS]

    def _stopped(self) -> Breakdown:
        slopes = np.abs(self.k[self.tableau.begin])
        if self._magnitudes.outgrown(self.x, slopes):
            fastest = float(np.max(slopes, initial=0.0))
            text = "values or rates grow too large to go on (largest rate [[rate]])"
            message = Message(text, rate=f"{fastest:.2g}")
            return Breakdown(Cause.BLOW_UP, message, self.clock[Clock.TIME], self.x)
        message = Message("step [[step]]", step=f"{float(self.clock[Clock.STEP]):.2g}")
        if self.count[Count.INFINITE] and isinstance(self.tableau, Rosenbrock):
            slopes = compiled_kernel(self._dynamics, "slopes")(np.concatenate([[self.clock[Clock.TIME]], self.x]))
            if not np.all(np.isfinite(slopes)):
                text = "[[method]] needs the derivatives of the rates, and not all of them are finite here"
                message = Message(text, method=self.tableau.name)
                return Breakdown(Cause.NOT_SMOOTH, message, self.clock[Clock.TIME], self.x)
        if self.count[Count.INFINITE]:
            message = Message("the rates just ahead are not finite")
        return Breakdown(Cause.STUCK, message, self.clock[Clock.TIME], self.x)


@dataclass(frozen=True)
class RungeKutta:
    """A method given by its tableau."""

    tableau: Tableau | Rosenbrock

    @property
    def traits(self) -> Traits:
        tableau, implicit = self.tableau, isinstance(self.tableau, Rosenbrock)
        return Traits(
            name=tableau.name,
            title=Message("[[method]], compiled", method=Message(tableau.title)),
            order=tableau.order,
            fixed=not tableau.errors,
            scalars=(FLOAT64,) if implicit else (FLOAT64, FLOAT32, EXTENDED),  # its coefficients have 16 digits
            implicit=implicit,
        )

    def start(
        self, dynamics: Dynamics, setting: Setting, scalar: str = FLOAT64, initial: Any = None, at: float = 0.0
    ) -> FixedRun | AdaptiveRun:
        """A run of compiled steps.

        Raises Unusable for an arithmetic that this machine or the method lacks, without a step where it needs one, and
        for linear equations that are too many.
        """
        tableau, name = self.tableau, self.tableau.name
        if scalar not in self.traits.scalars:
            raise Unusable(Message("[[name]] runs in float64 only", name=name))
        if not available(scalar):
            raise Unusable(Message("this machine has no [[scalar]] arithmetic", scalar=scalar))
        state = initial_state(dynamics, SCALARS[scalar].dtype) if initial is None else initial
        if isinstance(tableau, Tableau) and not tableau.errors:
            return FixedRun(dynamics, tableau, setting, scalar, state, at)
        if isinstance(tableau, Rosenbrock) and dynamics.dimension > MOST_EQUATIONS:
            text = "[[name]] solves up to [[most]] linear equations; here are [[count]]"
            raise Unusable(Message(text, name=name, most=MOST_EQUATIONS, count=dynamics.dimension))
        return AdaptiveRun(dynamics, tableau, setting, scalar, state, at)


METHODS: Sequence[RungeKutta] = tuple(RungeKutta(tableau) for tableau in (RK4, RK45, DOP853, RODAS5P))
