"""Variational integrators of fixed step for conservative systems: the midpoint rule and its compositions.

The discrete Lagrangian of the midpoint rule (Marsden & West, Discrete mechanics and variational integrators, Acta
Numerica 2001, 2.3),

    L_d(q0, q1) = h L(q_m, v, t0 + h/2),    q_m = (q0 + q1)/2,    v = (q1 - q0)/h,

gives, with p0 = -dL_d/dq0 and p1 = dL_d/dq1, the symplectic map

    L_v(q_m, v) - h/2 L_q(q_m, v) = p0   (solved for v, with q_m = q0 + h v/2),
    q1 = q0 + h v,    p1 = p0 + h L_q(q_m, v).

It holds for any Lagrangian, whatever the coupling of q and q' in the kinetic energy and with time in L.  Momenta of
coordinates that L does not contain are conserved to roundoff.  Symmetric compositions of steps g_1 h, ..., g_s h have
order 4 (Suzuki, 5 stages) and 6 (Yoshida, solution A, 7 stages; Hairer, Lubich & Wanner, Geometric Numerical
Integration, II.4 and V.3).

The equation for v is solved by Newton's method with one Jacobian a step, to roundoff; everything runs in machine code.
q' at the times asked for follows from p = dL/dq'.
"""

from __future__ import annotations

import ctypes
import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from math import isfinite
from typing import Any

import numpy as np
from flint import arb, ctx

from mbsym.algebra.derivative import jacobian
from mbsym.algebra.program import Node
from mbsym.expressions.message import Message
from mbsym.expressions.tree import number
from mbsym.model.substitution import folded, put
from mbsym.model.system import System
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.elimination import factorise, solve
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT64, Code
from mbsym.numerics.kernels.llvm import SCALARS, Library, Scalar, available, compiled
from mbsym.numerics.kernels.writer import INTEGER, POINTER, Function, Value, clock_kind
from mbsym.numerics.methods.interface import Breakdown, Cause, Setting, Traits, Unusable, Work, compiled_kernel, once
from mbsym.numerics.methods.led import refuse
from mbsym.numerics.methods.nested import Nested, hermite
from mbsym.numerics.methods.runge_kutta import MISSED, OPERATIONS_AT_A_TIME
from mbsym.numerics.methods.stepping import Stepping
from mbsym.numerics.methods.tableaux import add_compensated, address, clock_dtype, initial_state
from mbsym.numerics.scenario import PRECISION, Specialised, rounded, substituted

# The midpoint rule's equation as straight-line code, and the machine code that steps with it (``symplectic``).


#: Newton's method needs four or five iterations; more than this and the step is too long.
MOST_ITERATIONS = 40

# Places in the arrays that the machine code and Python share.
START, STEP, LARGEST_RATE = range(3)
ITERATIONS, JACOBIANS, TROUBLE, NUMBER = range(4)
NO_SOLUTION, NOT_FINITE = 1, 2


@dataclass(frozen=True)
class Codes:
    """``newton``: residual and its Jacobian by v; ``residual`` alone; ``force``: L_q.  Inputs (t, h, q0, v, p0)."""

    newton: Code
    residual: Code
    force: Code


def codes(dynamics: Dynamics) -> Codes:
    """The midpoint rule's equation as straight-line code."""
    names = dynamics.system.coordinates
    fresh = Specialised()
    time, step = fresh.input("time"), fresh.input("step")
    positions = [fresh.input(f"q {i}") for i in range(len(names))]
    rates = [fresh.input(f"v {i}") for i in range(len(names))]
    momenta = [fresh.input(f"p {i}") for i in range(len(names))]
    half = fresh.number(Fraction(1, 2))
    middle = half * step
    with ctx.workprec(PRECISION):
        bound: dict[str, Node] = {"pi": fresh.number(rounded(arb.pi())), "t": time + middle}
    for name, velocity, q, v in zip(names, dynamics.system.velocities, positions, rates, strict=True):
        bound[name], bound[velocity] = q + middle * v, v
    fresh.bound = bound
    program = dynamics.momenta.program
    outputs = [*dynamics.momenta.outputs, *dynamics.momentum_rates.outputs]
    nodes = substituted(program, outputs, fresh)
    impulses, forces = nodes[: len(names)], nodes[len(names) :]
    residual = [a - middle * b - p for a, b, p in zip(impulses, forces, momenta, strict=True)]
    rows = jacobian(fresh, residual, rates)
    inputs = ("time", "step", *(f"{letter} {i}" for letter in "qvp" for i in range(len(names))))
    return Codes(
        newton=Code(fresh, inputs, (*residual, *(entry for row in rows for entry in row))),
        residual=Code(fresh, inputs, tuple(residual)),
        force=Code(fresh, inputs, tuple(forces)),
    )


def midpoint_text(size: int, fractions: Sequence[Fraction], scalar: Scalar) -> str:
    """``i64 @midpoint(x, carry, guess, clock, count, first, last)``: steps of an interval; how many were made.

    ``x`` holds (q, p), ``guess`` the last two midpoint rates (v, then the one before).
    """
    names = ("x", "carry", "guess", "clock", "count")
    f = Function("midpoint", [(name, POINTER) for name in names] + [("first", INTEGER), ("last", INTEGER)])
    clock = clock_kind(scalar)
    start, step = f.load(clock, f["clock"], START), f.load(clock, f["clock"], STEP)
    with f.repeat(f["last"], f["first"]) as number:
        base = start + number.converted(clock) * step
        past = Fraction(0)
        for place, share in enumerate(fractions):
            # Midpoints lie (g_i + g_i-1) h / 2 apart; v is continued linearly where that is no wild extrapolation.
            previous, earlier = (fractions[(place - back) % len(fractions)] for back in (1, 2))
            ahead, behind = (share + previous) / 2, (previous + earlier) / 2
            slope = ahead / behind if behind and abs(ahead) <= 2 * abs(behind) else Fraction(0)
            times = (base + step * past, step * share, f.number(slope, clock))
            past += share
            trouble = f.call("substep", INTEGER, *(f[name] for name in names), *times)
            f.store(trouble, INTEGER, f["count"], TROUBLE)
            f.leave_if(trouble.compare("!=", 0), number - f["first"])
    f.leave(f["last"] - f["first"])
    return _substep_text(size, scalar) + f.text()


def record_text(size: int, scalar: Scalar) -> str:
    """``i64 @record(x, carry, guess, clock, count, marks, kept, first, last)``: steps up to the numbers in ``marks``.

    At each of them x and carry are kept, 4 n numbers a mark.  Returns the first mark that is not reached.
    """
    names = ("x", "carry", "guess", "clock", "count")
    pointers = [(name, POINTER) for name in (*names, "marks", "kept")]
    f = Function("record", [*pointers, ("first", INTEGER), ("last", INTEGER)])
    kind, count = scalar.type, f["count"]
    with f.repeat(f["last"], f["first"]) as mark:
        number, goal = f.load(INTEGER, count, NUMBER), f.load(INTEGER, f["marks"], mark)
        made = f.call("midpoint", INTEGER, *(f[name] for name in names), number, goal)
        f.store(number + made, INTEGER, count, NUMBER)
        f.leave_if((number + made).compare("<", goal), mark)
        for place, source in enumerate(("x", "carry")):
            with f.repeat(2 * size) as i:
                f.store(f.load(kind, f[source], i), kind, f["kept"], mark * (4 * size) + i + place * 2 * size)
    f.leave(f["last"])
    return f.text()


def _substep_text(size: int, scalar: Scalar) -> str:
    """``i64 @substep(x, carry, guess, clock, count, time, h, slope)``: one midpoint step; 0, or what went wrong."""
    kind, clock = scalar.type, clock_kind(scalar)
    names = ("x", "carry", "guess", "clock", "count")
    f = Function("substep", [(name, POINTER) for name in names] + [(name, clock) for name in ("time", "h", "slope")])
    x, guess, count, h = f["x"], f["guess"], f["count"], f["h"]
    argument = f.slot(kind, 2 + 3 * size)
    result = f.slot(kind, size + size * size)
    change, largest, before, total = f.slot(kind), f.slot(kind), f.slot(kind), f.slot(kind)
    rounds = f.slot(INTEGER)
    rates = f.at(kind, argument, 2 + size)
    matrix = f.at(kind, result, size)
    eps = Fraction(float(np.finfo(scalar.dtype).eps))

    f.store(f["time"].converted(kind), kind, argument, 0)
    f.store(h.converted(kind), kind, argument, 1)
    slope = f["slope"].converted(kind)
    with f.repeat(size) as i:
        f.store(f.load(kind, x, i), kind, argument, i + 2)
        f.store(f.load(kind, x, i + size), kind, argument, i + (2 + 2 * size))
        latest = f.load(kind, guess, i)
        f.store(latest + (latest - f.load(kind, guess, i + size)) * slope, kind, rates, i)
    f.do("newton", argument, result)
    f.add(1, INTEGER, count, JACOBIANS)
    # Its symmetric part is M - O(h^2), positive definite for every step that is not far too long.
    factorise(f, kind, matrix, size)
    f.store(0, INTEGER, rounds)
    f.store(Fraction(10) ** 30, kind, before)
    done, more = f.label(), f.label()
    again = f.here()
    solve(f, kind, matrix, result, size)
    f.store(0, kind, change)
    f.store(f.load(clock, f["clock"], LARGEST_RATE).converted(kind), kind, largest)
    with f.repeat(size) as i:
        correction = f.load(kind, result, i)
        v = f.load(kind, rates, i) - correction
        f.store(v, kind, rates, i)
        _raise_to(f, kind, change, correction.absolute())
        _raise_to(f, kind, largest, v.absolute())
    f.store(f.load(kind, largest).converted(clock), clock, f["clock"], LARGEST_RATE)
    moved, scale = f.load(kind, change), f.load(kind, largest)
    f.add(1, INTEGER, rounds)
    f.add(1, INTEGER, count, ITERATIONS)
    # As small as can be, or small and no longer decreasing: roundoff has been reached.
    small = moved.compare("<=", scale * (eps / 4))
    still = moved.compare("<=", scale * (eps * 4096)) & moved.compare(">=", f.load(kind, before) * Fraction(1, 4))
    f.store(moved, kind, before)
    f.branch(small | still, done, more)
    f.place(more)
    f.leave_if(f.load(INTEGER, rounds).compare(">=", MOST_ITERATIONS), NO_SOLUTION)
    f.do("residual", argument, result)
    f.jump(again)

    f.place(done)
    f.do("force", argument, result)
    width = h.converted(kind)
    f.store(0, kind, total)
    with f.repeat(size) as i:
        v = f.load(kind, rates, i)
        f.store(f.load(kind, guess, i), kind, guess, i + size)
        f.store(v, kind, guess, i)
        q = add_compensated(f, kind, x, f["carry"], i, width * v)
        p = add_compensated(f, kind, x, f["carry"], i + size, width * f.load(kind, result, i))
        f.add((q - q) + (p - p), kind, total)
    finite = f.load(kind, total).compare("<=", 0)
    f.leave(finite.choose(f.number(0, INTEGER), f.number(NOT_FINITE, INTEGER)))
    return f.text()


def _raise_to(f: Function, kind: str, place: Value, value: Value) -> None:
    """place <- max(place, value)."""
    now = f.load(kind, place)
    f.store(value.compare(">", now).choose(value, now), kind, place)


class MidpointRun(Stepping):
    """Steps of one length in (q, p); states between them by the polynomial that fits q, q' and q'' at both ends."""

    def __init__(
        self, dynamics: Dynamics, method: Symplectic, setting: Setting, scalar: str, initial: Any, at: float
    ) -> None:
        if setting.step is None or not (isfinite(setting.step) and setting.step > 0):
            raise Unusable(Message("[[name]] needs a step (--step)", name=method.name))
        self.limit = setting.step_limit
        n = self.n = dynamics.size
        chosen = SCALARS[scalar]
        self.dtype, self._clock_type = chosen.dtype, clock_dtype(clock_kind(chosen))
        self._library = library = _driver(dynamics, method, scalar)
        pointer, whole = ctypes.c_void_p, ctypes.c_int64
        self._midpoint = library.function("midpoint", *[pointer] * 5, whole, whole, result=whole)
        self._record = library.function("record", *[pointer] * 7, whole, whole, result=whole)
        self._kernels = {
            name: compiled_kernel(dynamics, name, scalar) for name in ("momenta", "mass_matrix", "right_hand_side")
        }
        self.step_length = self._clock_type(setting.step)
        self.work = Work()
        self.x, self.carry, self.guess = (np.zeros(2 * n, self.dtype) for _ in range(3))
        self.clock = np.zeros(3, self._clock_type)
        self.count = np.zeros(4, np.int64)
        arrays = (self.x, self.carry, self.guess, self.clock, self.count)
        self._pointers = tuple(address(array) for array in arrays)
        operations = 10 * dynamics.right_hand_side.operations + n**3 + 100
        self._at_once = max(1, OPERATIONS_AT_A_TIME // (len(method.fractions) * operations))
        self.restart(at, initial)

    def restart(self, time: float, state: Any) -> None:
        """Go on from another state."""
        n = self.n
        values = np.array(state, self.dtype)
        self._rebased(time, self.step_length)
        self.x[:n], self.x[n:] = values[:n], self._kernels["momenta"](np.concatenate(([self.dtype(time)], values)))
        self.carry[:] = 0
        self.guess[:n] = self.guess[n:] = values[n:]
        self._before: tuple[Any, Any] | None = None
        self.time, self.state = self.reached, values

    def _rebased(self, time: Any, length: Any) -> None:
        """Steps of a length are counted from here."""
        self.clock[START], self.clock[STEP], self.count[NUMBER] = time, length, 0

    @property
    def reached(self) -> Any:
        """The end of the last step."""
        end = self.clock[START] + self._clock_type(self.count[NUMBER]) * self.clock[STEP]
        return end if self._clock_type is np.longdouble else float(end)

    @property
    def end(self) -> Any:
        """The state there; as it was given, before the first step."""
        if self._before is None:
            return self.state
        return self._shown(np.array([self.reached]), self.x[:, None])[:, 0]

    def curve(self) -> Callable[[Any], Any]:
        """The polynomial of the last step."""
        if self._before is None:
            state = np.array(self.state)
            return lambda times: np.repeat(state[:, None], len(times), axis=1)
        (start, stored), end = self._before, self.reached
        times = np.array([start, end])
        return self._between(times, np.column_stack((stored, np.concatenate((self.x, self.carry)))), [0], [1])

    def _between(self, times: Any, stored: Any, begin: Any, end: Any) -> Nested:
        """Dense output between pairs of ``times`` at which (x, carry) is ``stored``."""
        n = self.n
        shown = self._shown(times, stored[: 2 * n])
        with np.errstate(all="ignore"):
            rates = self._kernels["right_hand_side"](np.vstack([times.astype(self.dtype), shown]))
            length = (times[end] - times[begin]).astype(self.dtype)
            change = shown[:, end] - shown[:, begin]
            change[:n] -= stored[2 * n : 3 * n, end] - stored[2 * n : 3 * n, begin]
            terms = hermite(length, change, rates[:, begin], rates[:, end])
        return Nested(times[begin], times[end] - times[begin], times[end], shown[:, begin], shown[:, end], terms)

    def one(self, until: float | None = None) -> None:
        """A step of the length asked for; a shorter one where it would lead beyond ``until``."""
        now = self.reached
        room = np.inf if until is None else until - now
        before = now, np.concatenate((self.x, self.carry))
        if room > self.clock[STEP] * (1 + MISSED):
            self._march(int(self.count[NUMBER]) + 1)
        else:
            self._rebased(now, room)
            try:
                self._march(1)
                self._rebased(until, self.step_length)
            except Breakdown:
                self._rebased(now, self.step_length)
                raise
        self._before = before

    def _number(self, times: Any) -> Any:
        """The steps at whose ends, or in which, times lie."""
        passed = (np.asarray(times) - self.clock[START]) / self.clock[STEP]
        return np.maximum(np.ceil(passed - MISSED), 0).astype(np.int64)

    def far(self, until: float) -> None:
        """Steps until ``until`` is reached or passed; the last one keeps its ends."""
        goal = int(self._number(until))
        if goal > self.count[NUMBER]:
            self._march(goal - 1)
            self.one()

    def _march(self, goal: int) -> None:
        """Steps up to a number."""
        while self.count[NUMBER] < goal:
            first = int(self.count[NUMBER])
            if self.work.steps >= self.limit:
                raise self.work.too_many(self.reached, self.end)
            before = self.x.copy()
            last = min(goal, first + min(self._at_once, self.limit - self.work.steps))
            self._counted(first, self._midpoint(*self._pointers, first, last))
            if self.count[NUMBER] < last:
                self._fail(before)

    def _counted(self, first: int, made: int) -> None:
        self.count[NUMBER] = first + made
        self.work.steps += made
        self.work.evaluations, self.work.jacobians = int(self.count[ITERATIONS]), int(self.count[JACOBIANS])

    def advance(self, until: float) -> Any:
        """The state at ``until``: a row."""
        return self.fill(np.array([until]))[:, 0]

    def fill(self, times: Any) -> Any:
        """The states (2n, m) at m increasing times: steps in machine code, what is shown of them all at once."""
        at = np.asarray(times, dtype=self._clock_type)
        if not len(at):
            return np.empty((2 * self.n, 0), self.dtype)
        number = self._number(at)
        early = int(np.searchsorted(number, self.count[NUMBER], side="right"))  # rows of the step that is made already
        head = self.states(at[:early]) if early else np.empty((2 * self.n, 0), self.dtype)
        if early < len(at):
            states = np.hstack((head, self._later(at[early:], number[early:], head)))
        else:
            states = head
        self.time, self.state = times[-1], states[:, -1].copy()
        return states

    def _later(self, at: Any, number: Any, head: Any) -> Any:
        """Rows that steps must be made for; raises Breakdown with ``head`` and those that there are."""
        exact = self.clock[START] + number.astype(self._clock_type) * self.clock[STEP] == at
        marks = np.unique(np.concatenate((number, number[~exact] - 1, number[-1:] - 1)))
        stored = np.empty((len(marks), 4 * self.n), self.dtype)
        moments = self.clock[START] + marks.astype(self._clock_type) * self.clock[STEP]
        trouble = None
        try:
            self._marked(marks, stored)
            self._before = moments[-2], stored[-2].copy()
        except Breakdown as reason:
            trouble = reason
        whole = int(np.searchsorted(number, self.count[NUMBER], side="right"))
        rows = self._rows(at[:whole], exact[:whole], number[:whole], marks, moments, stored.T)
        if trouble is not None:
            trouble.filled = np.hstack((head, rows))
            raise trouble
        return rows

    def _marked(self, marks: Any, stored: Any) -> None:
        """Steps to the numbers in ``marks``, at each of which (x, carry) is kept."""
        pointers = (*self._pointers, address(marks), address(stored))
        done = 0
        while done < len(marks):
            first = int(self.count[NUMBER])
            near = first + min(self._at_once, self.limit - self.work.steps)
            last = int(np.searchsorted(marks, near, side="right"))
            if last <= done:
                self._march(min(int(marks[done]), first + self._at_once))
                continue
            before = self.x.copy()
            done = self._record(*pointers, done, last)
            self._counted(first, int(self.count[NUMBER]) - first)
            if done < last:
                self._fail(before)

    def _rows(self, at: Any, exact: Any, number: Any, marks: Any, moments: Any, stored: Any) -> Any:
        """States at times of which ``number`` is the step that they lie in, or end."""
        rows = np.empty((2 * self.n, len(at)), self.dtype)
        ends = np.searchsorted(marks, number)
        rows[:, exact] = self._shown(moments[ends[exact]], stored[: 2 * self.n, ends[exact]])
        if not np.all(exact):
            used = slice(0, int(ends[-1]) + 1)
            begins, between = np.searchsorted(marks, number[~exact] - 1), ends[~exact]
            rows[:, ~exact] = self._between(moments[used], stored[:, used], begins, between)(at[~exact])
        return rows

    def _fail(self, before: Any) -> None:
        now = float(self.reached)
        finite = bool(np.all(np.isfinite(self.x)))
        known = self._shown(np.array([self.reached]), self.x[:, None])[:, 0] if finite else None
        state = known if known is not None else np.where(np.isfinite(before), before, 0.0)
        if self.count[TROUBLE] == NOT_FINITE or not finite:
            raise Breakdown(Cause.BLOW_UP, "a value is no longer finite", now, state)
        message = Message(
            "the implicit equation has no solution within [[count]] iterations; h = [[step]] is too long",
            count=MOST_ITERATIONS,
            step=f"{float(self.clock[STEP]):.3g}",
        )
        raise Breakdown(Cause.STUCK, message, now, state)

    def _shown(self, times: Any, x: Any) -> Any:
        """(q, q') in columns of (q, p) in columns: M q' = p - p at q' = 0."""
        n, m = self.n, len(times)
        still = np.vstack([times.astype(self.dtype), x[:n], np.zeros((n, m), self.dtype)])
        with np.errstate(all="ignore"):
            matrices = np.ascontiguousarray(self._kernels["mass_matrix"](still).T).reshape(m, n, n)
            moments = (x[n:] - self._kernels["momenta"](still)).T[:, :, None]
            rates = _solved(matrices, moments).astype(self.dtype)
            if self.dtype is np.longdouble:  # two steps of refinement give the digits that float64 lacks
                for _ in range(2):
                    rates = rates + _solved(matrices, moments - matrices @ rates)
        return np.vstack([x[:n], rates[:, :, 0].T])


def _solved(matrices: Any, vectors: Any) -> Any:
    """M^-1 v for each of them, in float64; not a number where M is singular."""
    matrices, vectors = matrices.astype(float), vectors.astype(float)
    try:
        return np.linalg.solve(matrices, vectors)
    except np.linalg.LinAlgError:
        solutions = np.full(vectors.shape, np.nan)
        for place, (matrix, vector) in enumerate(zip(matrices, vectors, strict=True)):
            with suppress(np.linalg.LinAlgError):
                solutions[place] = np.linalg.solve(matrix, vector)
        return solutions


def _driver(dynamics: Dynamics, method: Symplectic, scalar: str) -> Library:
    def make() -> Library:
        midpoint_codes = once(dynamics, "midpoint codes", lambda: codes(dynamics))
        chosen = SCALARS[scalar]
        text = midpoint_text(dynamics.size, method.fractions, chosen) + record_text(dynamics.size, chosen)
        named = {"newton": midpoint_codes.newton, "residual": midpoint_codes.residual, "force": midpoint_codes.force}
        return compiled(named, scalar, text, many=False)

    return once(dynamics, ("midpoint", method.name, scalar), make)


def without_potential(system: System, values: Mapping[str, Fraction]) -> tuple[str, ...]:
    """The loads that have no force function, in words; those that vanish at values of parameters are none of them."""
    images = {name: number(value) for name, value in values.items()}
    acting = (load for load in system.loads if not load.conservative and put(load, images, folded).simplified())
    return tuple(dict.fromkeys(re.sub(r"(?<=[a-z])(?=[A-Z])", " ", type(load).__name__).lower() for load in acting))


def unsuited(system: System, values: Mapping[str, Fraction]) -> Message | None:
    """Why a method that takes its forces from a potential does not suit a system; None where it does."""
    loads = without_potential(system, values)
    words = "for conservative systems only, and these loads are given without a potential: [[loads]]"
    return Message(words, loads=", ".join(loads)) if loads else None


@dataclass(frozen=True)
class Symplectic:
    """The midpoint rule composed of steps of the given fractions of h."""

    name: str
    title: str
    order: int
    fractions: tuple[Fraction, ...]

    @property
    def traits(self) -> Traits:
        return Traits(
            name=self.name,
            title=self.title,
            order=self.order,
            fixed=True,
            scalars=(FLOAT64, EXTENDED),
            implicit=True,
            conservative=True,
            led=False,
        )

    def start(
        self, dynamics: Dynamics, setting: Setting, scalar: str = FLOAT64, initial: Any = None, at: float = 0.0
    ) -> MidpointRun:
        """A run in (q, p).  Raises Unusable where a load has no force function, and with constraints."""
        refuse(dynamics, self.name)
        if (reason := unsuited(dynamics.system, dynamics.fixed_values)) is not None:
            raise Unusable(reason, self.name)
        if not available(scalar) or scalar not in self.traits.scalars:
            raise Unusable(Message("[[name]] does not run in [[scalar]] here", name=self.name, scalar=scalar))
        state = initial_state(dynamics, SCALARS[scalar].dtype) if initial is None else initial
        return MidpointRun(dynamics, self, setting, scalar, state, at)


def _suzuki() -> tuple[Fraction, ...]:
    """g = 1/(4 - 4^(1/3)), to the precision of constants: (g, g, 1 - 4g, g, g)."""
    with ctx.workprec(PRECISION + 64):
        g = rounded(1 / (4 - arb(4).root(3)))
    return (g, g, 1 - 4 * g, g, g)


def _yoshida() -> tuple[Fraction, ...]:
    """Solution A of H. Yoshida, Physics Letters A 150 (1990) 262, order 6; the middle one makes the sum 1."""
    digits = ("0.78451361047755726382", "0.23557321335935813368", "-1.17767998417887100695")
    outer = tuple(Fraction(value) for value in digits)
    return (*outer, 1 - 2 * sum(outer, Fraction(0)), *outer[::-1])


METHODS = (
    Symplectic("midpoint", Message("variational midpoint rule"), 2, (Fraction(1),)),
    Symplectic("midpoint4", Message("variational midpoint rule, composed to order 4"), 4, _suzuki()),
    Symplectic("midpoint6", Message("variational midpoint rule, composed to order 6"), 6, _yoshida()),
)
