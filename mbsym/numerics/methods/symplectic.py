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
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, isfinite
from typing import Any

import numpy as np
from flint import arb, ctx

from mbsym.algebra.derivative import jacobian
from mbsym.algebra.program import Node
from mbsym.mechanics.loads.kinds import KINDS
from mbsym.model.system import System
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT64, Code
from mbsym.numerics.kernels.llvm import SCALARS, Library, Scalar, available, compiled
from mbsym.numerics.kernels.writer import INTEGER, POINTER, Function, Value, clock_kind
from mbsym.numerics.methods.interface import (
    BLOW_UP,
    STEP_LIMIT,
    STUCK,
    Breakdown,
    Setting,
    Traits,
    Unusable,
    Work,
)
from mbsym.numerics.methods.kept import compiled_kernel, once
from mbsym.numerics.methods.runge_kutta import OPERATIONS_AT_A_TIME, add_compensated, address, initial_state
from mbsym.numerics.scenario import PRECISION, rounded
from mbsym.numerics.specialise import Specialised, substituted

#: Newton's method needs four or five iterations; more than this and the step is too long.
MOST_ITERATIONS = 40

START, STEP, LARGEST_RATE = range(3)
ITERATIONS, JACOBIANS, TROUBLE = range(3)
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
    found = substituted(program, outputs, fresh)
    impulses, forces = found[: len(names)], found[len(names) :]
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
            good, bad = f.label(), f.label()
            f.branch(trouble.compare("==", 0), good, bad)
            f.place(bad)
            f.store(trouble, INTEGER, f["count"], TROUBLE)
            f.leave(number - f["first"])
            f.place(good)
    f.leave(f["last"] - f["first"])
    return _substep_text(size, scalar) + f.text()


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
    f.store(f.load(INTEGER, count, JACOBIANS) + 1, INTEGER, count, JACOBIANS)
    _factorise(f, kind, matrix, size)
    f.store(0, INTEGER, rounds)
    f.store(Fraction(10) ** 30, kind, before)
    again, done, more, failed, next_one = (f.label() for _ in range(5))
    f.jump(again)

    f.place(again)
    _solve(f, kind, matrix, result, size)
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
    f.store(f.load(INTEGER, rounds) + 1, INTEGER, rounds)
    f.store(f.load(INTEGER, count, ITERATIONS) + 1, INTEGER, count, ITERATIONS)
    # As small as can be, or small and no longer decreasing: roundoff has been reached.
    small = moved.compare("<=", scale * (eps / 4))
    still = moved.compare("<=", scale * (eps * 4096)) & moved.compare(">=", f.load(kind, before) * Fraction(1, 4))
    f.store(moved, kind, before)
    f.branch(small | still, done, more)
    f.place(more)
    f.branch(f.load(INTEGER, rounds).compare(">=", MOST_ITERATIONS), failed, next_one)
    f.place(next_one)
    f.do("residual", argument, result)
    f.jump(again)
    f.place(failed)
    f.leave(NO_SOLUTION)

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
        f.store(f.load(kind, total) + ((q - q) + (p - p)), kind, total)
    finite = f.load(kind, total).compare("<=", 0)
    f.leave(finite.choose(f.number(0, INTEGER), f.number(NOT_FINITE, INTEGER)))
    return f.text()


def _raise_to(f: Function, kind: str, place: Value, value: Value) -> None:
    """place <- max(place, value)."""
    now = f.load(kind, place)
    f.store(value.compare(">", now).choose(value, now), kind, place)


def _factorise(f: Function, kind: str, matrix: Value, size: int) -> None:
    """matrix <- its L U factors.

    No pivots are exchanged: the symmetric part of the matrix is M - O(h^2), which is positive definite for every step
    that is not far too long.
    """
    with f.repeat(size) as k:
        inverse = 1 / f.load(kind, matrix, k * (size + 1))
        with f.repeat(size, k + 1) as i:
            factor = f.load(kind, matrix, i * size + k) * inverse
            f.store(factor, kind, matrix, i * size + k)
            with f.repeat(size, k + 1) as j:
                entry = f.load(kind, matrix, i * size + j) - factor * f.load(kind, matrix, k * size + j)
                f.store(entry, kind, matrix, i * size + j)


def _solve(f: Function, kind: str, matrix: Value, vector: Value, size: int) -> None:
    """vector <- (L U)^-1 vector."""
    with f.repeat(size) as i, f.repeat(i) as j:
        entry = f.load(kind, vector, i) - f.load(kind, matrix, i * size + j) * f.load(kind, vector, j)
        f.store(entry, kind, vector, i)
    with f.repeat(size) as back:
        i = (size - 1) - back
        with f.repeat(size, i + 1) as j:
            entry = f.load(kind, vector, i) - f.load(kind, matrix, i * size + j) * f.load(kind, vector, j)
            f.store(entry, kind, vector, i)
        f.store(f.load(kind, vector, i) / f.load(kind, matrix, i * (size + 1)), kind, vector, i)


class MidpointRun:
    """Steps of one length, shortened so that they end at the times asked for."""

    def __init__(self, dynamics: Dynamics, method: Symplectic, setting: Setting, scalar: str) -> None:
        if setting.step is None or not (isfinite(setting.step) and setting.step > 0):
            raise Unusable(f"{method.name} needs a step (--step)")
        self.dynamics, self.step, self.limit, self.scalar = dynamics, setting.step, setting.step_limit, scalar
        n = self.n = dynamics.size
        chosen = SCALARS[scalar]
        self.dtype = chosen.dtype
        self._library = library = _driver(dynamics, method, scalar)
        pointer, whole = ctypes.c_void_p, ctypes.c_int64
        self._midpoint = library.function("midpoint", *[pointer] * 5, whole, whole, result=whole)
        self.state = initial_state(dynamics, self.dtype)
        self.time = 0.0
        self.work = Work()
        self._momenta = compiled_kernel(dynamics, "momenta", scalar)
        self._mass = compiled_kernel(dynamics, "mass_matrix", scalar)
        momenta = self._momenta(np.concatenate(([self.dtype(0)], self.state)))
        self.x = np.concatenate((self.state[:n], momenta))
        self.carry = np.zeros(2 * n, self.dtype)
        self.guess = np.concatenate((self.state[n:], self.state[n:]))
        self._clock_type: Any = np.longdouble if clock_kind(chosen) == "x86_fp80" else np.float64
        self.clock = np.zeros(3, self._clock_type)
        self.count = np.zeros(3, np.int64)
        arrays = (self.x, self.carry, self.guess, self.clock, self.count)
        self._pointers = tuple(address(array) for array in arrays)
        code = dynamics.right_hand_side
        self._stages = len(method.fractions)
        self._at_once = max(1, OPERATIONS_AT_A_TIME // (self._stages * (10 * code.operations + n**3 + 100)))

    def advance(self, until: float) -> Any:
        length = until - self.time
        if length <= 0:
            return self.state
        count = max(1, ceil(length / self.step * (1 - 1e-9)))
        step: Any = self._clock_type(length) / count
        self.clock[START], self.clock[STEP] = self.time, step
        done = 0
        while done < count:
            now = self.time + done * float(step)
            if self.work.steps >= self.limit:
                raise Breakdown(STEP_LIMIT, f"{self.work.steps} steps", now, self._state(now))
            before = self.x.copy()
            last = min(count, done + min(self._at_once, self.limit - self.work.steps))
            made = self._midpoint(*self._pointers, done, last)
            self.work.steps += made
            self.work.evaluations, self.work.jacobians = int(self.count[0]), int(self.count[1])
            if made < last - done:
                now += made * float(step)
                self._fail(now, float(step), before)
            done = last
        self.time = until
        self.state = self._state(until)
        return self.state

    def _fail(self, now: float, step: float, before: Any) -> None:
        finite = bool(np.all(np.isfinite(self.x)))
        state = self._state(now) if finite else np.where(np.isfinite(before), before, 0.0)
        if self.count[TROUBLE] == NOT_FINITE or not finite:
            raise Breakdown(BLOW_UP, "a value is no longer finite", now, np.array(state, dtype=float))
        message = (
            f"the implicit equation has no solution within {MOST_ITERATIONS} iterations; h = {step:.3g} is too long"
        )
        raise Breakdown(STUCK, message, now, np.array(state, dtype=float))

    def _state(self, time: float) -> Any:
        """(q, q') with M q' = p - p at q' = 0."""
        n = self.n
        still = np.concatenate(([self.dtype(time)], self.x[:n], np.zeros(n, self.dtype)))
        matrix = self._mass(still).reshape(n, n)
        moments = self.x[n:] - self._momenta(still)
        with np.errstate(all="ignore"):
            try:
                rates = np.linalg.solve(matrix.astype(float), moments.astype(float)).astype(self.dtype)
                if self.dtype is np.longdouble:  # one step of refinement gives the digits that float64 lacks
                    for _ in range(2):
                        defect = (moments - matrix @ rates).astype(float)
                        rates = rates + np.linalg.solve(matrix.astype(float), defect)
            except np.linalg.LinAlgError:
                rates = np.full(n, np.nan, self.dtype)
        return np.concatenate((self.x[:n], rates))


def _driver(dynamics: Dynamics, method: Symplectic, scalar: str) -> Library:
    def make() -> Library:
        found = once(dynamics, "midpoint codes", lambda: codes(dynamics))
        text = midpoint_text(dynamics.size, method.fractions, SCALARS[scalar])
        named = {"newton": found.newton, "residual": found.residual, "force": found.force}
        return compiled(named, scalar, text, many=False)

    return once(dynamics, ("midpoint", method.name, scalar), make)


def without_potential(system: System) -> tuple[str, ...]:
    """The loads that have no force function, in words."""
    found = []
    for load in system.loads:
        if KINDS[type(load)].force_function is None:
            words = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", type(load).__name__).lower()
            found.append(words)
    return tuple(dict.fromkeys(found))


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
        )

    def start(self, dynamics: Dynamics, setting: Setting, scalar: str = FLOAT64) -> MidpointRun:
        """A run in (q, p).  Raises Unusable where a load has no force function."""
        loads = without_potential(dynamics.system)
        if loads:
            raise Unusable(
                f"{self.name} is for conservative systems; these loads have no potential: {', '.join(loads)}"
            )
        if not available(scalar) or scalar not in self.traits.scalars:
            raise Unusable(f"{self.name} does not run in {scalar} here")
        return MidpointRun(dynamics, self, setting, scalar)


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
    Symplectic("midpoint", "variational midpoint rule", 2, (Fraction(1),)),
    Symplectic("midpoint4", "variational midpoint rule, composed to order 4", 4, _suzuki()),
    Symplectic("midpoint6", "variational midpoint rule, composed to order 6", 6, _yoshida()),
)
