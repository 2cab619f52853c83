"""What the machine code of Runge-Kutta methods is written with: stages of a tableau, compensated sums, places."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.llvm import Scalar
from mbsym.numerics.kernels.writer import Function, Value, clock_kind
from mbsym.numerics.methods.tableaux import Row

# Places in the arrays that the machine code and Python share.
TIME, TIME_CARRY, START, STEP, LAST, UNTIL, RELATIVE, ABSOLUTE, PREVIOUS, LONGEST, BASE, SLACK = range(12)
STEPS, REJECTED, EVALUATIONS, FRESH, INFINITE, CAREFUL, LEFT, NUMBER, PREPARED, REPLY, SINGULARLY = range(11)
REACHED, PAUSED, STOPPED = range(3)


def clock_dtype(kind: str) -> Any:
    """NumPy's type of LLVM's type of a clock."""
    return np.longdouble if kind == "x86_fp80" else np.float64


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


def aligned(shape: int | tuple[int, ...], dtype: Any) -> Any:
    """Zeros that begin a cache line: a vector register filled from two lines, one just written, takes twice as long."""
    count, width = int(np.prod(shape)), np.dtype(dtype).itemsize
    room = np.zeros(count * width + 64, np.uint8)
    first = -address(room) % 64
    return room[first : first + count * width].view(dtype).reshape(shape)


def address(array: Any) -> int:
    found: int = array.ctypes.data
    return found


def initial_state(dynamics: Dynamics, dtype: Any) -> Any:
    """The scenario's state, correctly rounded."""
    return np.array([exact_number(x, dtype) for x in dynamics.scenario.state], dtype)


def exact_number(value: Fraction, dtype: Any) -> Any:
    """A fraction as a number of NumPy's type (float64, float32, longdouble), correctly rounded or nearly so."""
    head = float(value)
    if dtype is np.longdouble:
        return np.longdouble(head) + np.longdouble(float(value - Fraction(head)))
    return head if dtype is np.float64 else dtype(head)
