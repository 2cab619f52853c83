"""Runge-Kutta methods over several members of an ensemble side by side, as LLVM text.

Every lane of a vector register is a member with a time, a step and an error estimate of its own, so that it takes the
steps that it would take alone; what a lane must not do (a rejected step, a member that is done) is masked out.  The
formulas are those of ``mbsym.numerics.methods.marching``, whose stages are used as they are.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import IntEnum
from fractions import Fraction

import numpy as np

from mbsym.numerics.kernels.interface import FLOAT64, Code
from mbsym.numerics.kernels.llvm import (
    ATTRIBUTES,
    SCALARS,
    Library,
    Scalar,
    constant,
    declarations,
    wide_text,
)
from mbsym.numerics.kernels.sine_cosine import splat, vector
from mbsym.numerics.kernels.writer import BIT, INTEGER, POINTER, Function, Number, Value
from mbsym.numerics.methods.marching import estimated, growth, shrinkage
from mbsym.numerics.methods.tableaux import Stages, Tableau, add_compensated

# Writing LLVM functions over several numbers side by side: every value is a vector of ``lanes`` numbers, one a state.
#
# Comparisons give a mask, a bit a lane; ``anywhere`` and ``bit`` tell of masks what branches need to know.


DOUBLE = "double"


class Lanes(Function):
    """A Function whose floating-point values may be vectors of ``lanes`` numbers (of the type ``kind``)."""

    def __init__(self, name: str, arguments: Sequence[tuple[str, str]], lanes: int) -> None:
        super().__init__(name, arguments)
        self.lanes = lanes
        self.kind = self.real = vector(lanes, DOUBLE)
        self.bits = vector(lanes, BIT)

    def mask(self, kind: str) -> str:
        return self.bits if kind == self.kind else BIT

    def number(self, value: Value | Number, kind: str) -> Value:
        if isinstance(value, Value) or kind != self.kind:
            return super().number(value, kind)
        return Value(self, kind, splat(self.lanes, DOUBLE, constant(Fraction(value), DOUBLE)))

    def infinity(self) -> Value:
        """In every lane."""
        return Value(self, self.kind, splat(self.lanes, DOUBLE, "0x7FF0000000000000"))

    def infinity_of_one(self) -> Value:
        """A single number."""
        return Value(self, DOUBLE, "0x7FF0000000000000")

    def select(self, mask: Value, yes: Value | Number, no: Value | Number) -> Value:
        """Lane by lane ``yes`` where the mask is set, else ``no``."""
        first, second = self.number(yes, self.kind), self.number(no, self.kind)
        operands = f"{self.bits} {mask.text}, {self.kind} {first.text}, {self.kind} {second.text}"
        return self.value(self.kind, f"select {operands}")

    def without(self, mask: Value, other: Value) -> Value:
        """mask and not other."""
        ones = splat(self.lanes, BIT, "1")
        return mask & self.value(self.bits, f"xor {self.bits} {other.text}, {ones}")

    def anywhere(self, mask: Value) -> Value:
        """A bit: whether the mask is set in some lane."""
        whole = self.value(f"i{self.lanes}", f"bitcast {self.bits} {mask.text} to i{self.lanes}")
        return self.value(BIT, f"icmp ne i{self.lanes} {whole.text}, 0")

    def bit(self, mask: Value, lane: int) -> Value:
        """The mask in one lane."""
        return self.value(BIT, f"extractelement {self.bits} {mask.text}, i32 {lane}")

    def call(self, name: str, kind: str, *operands: Value) -> Value:
        """A function of the C library, of vectors lane after lane."""
        if kind != self.kind:
            return super().call(name, kind, *operands)
        if name == "sqrt":
            return self.value(kind, f"call {kind} @llvm.sqrt.v{self.lanes}f64({kind} {operands[0].text})")
        return self._lanewise(name, *operands)

    def _lanewise(self, function: str, x: Value) -> Value:
        packed = "poison"
        for lane in range(self.lanes):
            value = self.value(DOUBLE, f"extractelement {self.kind} {x.text}, i32 {lane}")
            result = self.call(function, DOUBLE, value)
            packed = self.value(self.kind, f"insertelement {self.kind} {packed}, double {result.text}, i32 {lane}").text
        return Value(self, self.kind, packed)

    def splatted(self, x: Value) -> Value:
        """One number in every lane."""
        packed = "poison"
        for lane in range(self.lanes):
            packed = self.value(self.kind, f"insertelement {self.kind} {packed}, double {x.text}, i32 {lane}").text
        return Value(self, self.kind, packed)


def wide_scalar(lanes: int) -> Scalar:
    """Vectors of float64 as an arithmetic of their own."""
    return Scalar(FLOAT64, vector(lanes, DOUBLE), "", SCALARS[FLOAT64].dtype)


def library(code: Code, drivers: str, lanes: int) -> Library:
    """The code as ``rhs(in, out)``, rows of ``lanes`` numbers each, with functions that call it."""
    scalar = SCALARS[FLOAT64]
    own = declarations([code], scalar, lanes)
    kind = vector(lanes, DOUBLE)
    declared = [f"declare {kind} @llvm.sqrt.v{lanes}f64({kind})\n"]
    declared += [f"declare double @{name}(double) #1\n" for name in ("exp", "log")]
    called = "define internal void @rhs(ptr noalias %in, ptr noalias %out) #0 {\n"
    called += f"  call void @rhs.wide(ptr %in, ptr %out, i64 {lanes})\n  ret void\n}}\n"
    more = "".join(line for line in declared if line.split("(")[0] not in own)
    text = "\n".join([own, more, wide_text("rhs", code, scalar, lanes), called, drivers, ATTRIBUTES])
    return Library(text, thorough=False)


__all__ = ["DOUBLE", "INTEGER", "Lanes", "library", "wide_scalar"]


#: Rows of ``clock``: a vector each; numbers that all members share.
Clock = IntEnum("Clock", "TIME CARRY START LAST STEP PREVIOUS NEXT STEPS REJECTED FRESH CAREFUL INFINITE DEAD", start=0)
Shared = IntEnum("Shared", "RELATIVE ABSOLUTE LONGEST", start=0)

#: What a driver returns.
DONE, PAUSED = 0, 1

_LEAST = Fraction(4 * float(np.finfo(float).eps))


class _Stages(Stages):
    """Stages whose argument ends in the parameters that are inputs."""

    def __init__(self, function: Lanes, size: int, parameters: int) -> None:
        super().__init__(function, size, wide_scalar(function.lanes))
        self.argument = function.slot(self.kind, size + 1 + parameters)
        for place in range(parameters):
            value = function.load(self.kind, function["p"], place)
            function.store(value, self.kind, self.argument, size + 1 + place)


def rows_of(tableau: Tableau) -> int:
    """How many slopes are kept: the stages, f at the new point, those of dense output."""
    return len(tableau.stages) + 1 + len(tableau.extra)


def fixed_text(tableau: Tableau, size: int, parameters: int, lanes: int) -> str:
    """``i64 @fixed(x, carry, p, shared, count)``: ``count`` steps of all lanes; shared: the first time and the step."""
    names = [(name, POINTER) for name in ("x", "carry", "p", "shared")] + [("count", INTEGER)]
    f = Lanes("fixed", names, lanes)
    s = _Stages(f, size, parameters)
    k = f.slot(s.kind, len(tableau.stages) * size)
    start, step = (f.splatted(f.load(DOUBLE, f["shared"], place)) for place in range(2))
    with f.repeat(f["count"]) as number:
        time = start + f.splatted(number.converted(DOUBLE)) * step
        s.state_argument(f["x"])
        s.evaluate(time, s.slope(k, 0))
        for place, row in enumerate(tableau.stages[1:], 1):
            s.stage(f["x"], k, row, place, time, step)
        for i in f.each(size):
            add_compensated(f, s.kind, f["x"], f["carry"], i, step * s.combination(k, tableau.weights, i))
    f.leave(DONE)
    return f.text()


def adaptive_text(tableau: Tableau, size: int, parameters: int, lanes: int) -> str:
    """``i64 @adaptive(x, carry, old, k, clock, index, p, sizes, shared, times, out, first, last, width, budget)``.

    Fills ``out`` (rows from ``first`` to ``last`` - 1, 2n numbers each, ``width`` numbers apart) with the states at
    ``times``, each lane's in its column; ``index`` says at which row each lane is.  DONE when all lanes are at ``last``
    or dead, PAUSED after ``budget`` attempts.
    """
    pointers = ("x", "carry", "old", "k", "clock", "index", "p", "sizes", "shared", "times", "out")
    whole = ("first", "last", "width", "budget")
    f = Lanes("adaptive", [(name, POINTER) for name in pointers] + [(name, INTEGER) for name in whole], lanes)
    return _Adaptive(f, tableau, size, parameters).text()


class _Adaptive:
    """The parts of the adaptive driver, in the order in which they run."""

    def __init__(self, f: Lanes, tableau: Tableau, size: int, parameters: int) -> None:
        self.f, self.tableau, self.size = f, tableau, size
        self.s = _Stages(f, size, parameters)
        self.kind = f.kind
        self.stages = len(tableau.stages)
        self.terms = f.slot(self.kind, (3 + len(tableau.dense)) * size)
        self.shown = f.slot(self.kind, size)
        self.fresh = f.slot(self.kind, size)
        self.candidate, self.change = f.slot(self.kind, size), f.slot(self.kind, size)
        self.relative, self.absolute, self.longest = (
            f.splatted(f.load(DOUBLE, f["shared"], place))
            for place in (Shared.RELATIVE, Shared.ABSOLUTE, Shared.LONGEST)
        )

    def row(self, place: int) -> Value:
        return self.f.load(self.kind, self.f["clock"], place)

    def set(self, place: int, value: Value | int) -> None:
        self.f.store(value, self.kind, self.f["clock"], place)

    def text(self) -> str:
        f = self.f
        left = f.slot(INTEGER)
        f.store(f["budget"], INTEGER, left)
        for lane in range(f.lanes):
            self._aim(lane)
        again = f.here()
        self._emit()
        active = self.row(Clock.NEXT).compare("<", f.infinity())
        f.leave_if(f.anywhere(active), DONE, unless=True)
        f.leave_if(f.load(INTEGER, left).compare("<=", 0), PAUSED)
        f.add(-1, INTEGER, left)
        self._bury(active, again)
        self._try(active)
        f.jump(again)
        return f.text()

    # --- rows ---

    def _aim(self, lane: int) -> None:
        """The next time at which a lane is shown; none where it is dead or done."""
        f = self.f
        f.store(f.infinity_of_one(), DOUBLE, f["clock"], Clock.NEXT * f.lanes + lane)
        index = f.load(INTEGER, f["index"], lane)
        with (
            f.when(f.load(DOUBLE, f["clock"], Clock.DEAD * f.lanes + lane).compare("<=", 0)),
            f.when(index.compare("<", f["last"])),
        ):
            f.store(f.load(DOUBLE, f["times"], index), DOUBLE, f["clock"], Clock.NEXT * f.lanes + lane)

    def _emit(self) -> None:
        """States at times that steps have reached, by dense output."""
        f = self.f
        due = self.row(Clock.NEXT).compare("<=", self.row(Clock.TIME))
        with f.when(f.anywhere(due)):
            self._prepare()
            more, over = f.here(), f.label()
            due = self.row(Clock.NEXT).compare("<=", self.row(Clock.TIME))
            self._between((self.row(Clock.NEXT) - self.row(Clock.START)) / self.row(Clock.LAST))
            for lane in range(f.lanes):
                with f.when(f.bit(due, lane)):
                    self._write(lane)
            f.branch(f.anywhere(self.row(Clock.NEXT).compare("<=", self.row(Clock.TIME))), more, over)
            f.place(over)

    def _prepare(self) -> None:
        """The terms of dense output of the last step (``Tableau.dense``)."""
        f, s, k, old = self.f, self.s, self.f["k"], self.f["old"]
        h = self.row(Clock.LAST)
        for place, row in enumerate(self.tableau.extra):
            s.stage(old, k, row, self.stages + 1 + place, self.row(Clock.START), h)
        for i in f.each(self.size):
            change = f.load(self.kind, f["x"], i) - f.load(self.kind, old, i)
            first, last = h * f.load(self.kind, k, i), h * f.load(self.kind, k, i + self.stages * self.size)
            terms = [change, first - change, 2 * change - (first + last)]
            terms += [h * s.combination(k, row, i) for row in self.tableau.dense]
            for place, term in enumerate(terms):
                f.store(term, self.kind, self.terms, i + place * self.size)

    def _between(self, share: Value) -> None:
        f = self.f
        rest = 1 - share
        for i in f.each(self.size):
            total: Value | None = None
            for place in reversed(range(len(self.tableau.dense) + 3)):
                term = f.load(self.kind, self.terms, i + place * self.size)
                total = term if total is None else term + total
                total = total * (share if place % 2 == 0 else rest)
            assert total is not None
            f.store(f.load(self.kind, f["old"], i) + total, self.kind, self.shown, i)

    def _write(self, lane: int) -> None:
        f = self.f
        index = f.load(INTEGER, f["index"], lane)
        base = (index - f["first"]) * self.size
        for i in f.each(self.size):
            at = f.number(i, INTEGER) if isinstance(i, int) else i
            value = f.load(DOUBLE, self.shown, at * f.lanes + lane)
            f.store(value, DOUBLE, f["out"], (base + at) * f["width"] + lane)
        f.store(index + 1, INTEGER, f["index"], lane)
        self._aim(lane)

    # --- steps ---

    def _bury(self, active: Value, again: str) -> None:
        """Lanes whose steps have become too small are dead."""
        f = self.f
        step, least = self.row(Clock.STEP), self.row(Clock.TIME).absolute() * _LEAST
        low = f.select(least.compare(">", Fraction(1, 10**200)), least, Fraction(1, 10**200))
        stuck = f.without(active, step.compare(">", low))
        with f.when(f.anywhere(stuck)):
            self.set(Clock.DEAD, f.select(stuck, 1, self.row(Clock.DEAD)))
            self.set(Clock.NEXT, f.select(stuck, f.infinity(), self.row(Clock.NEXT)))
            f.jump(again)
            f.place(f.label())  # what follows is never reached

    def _try(self, active: Value) -> None:
        f, s, k, tableau = self.f, self.s, self.f["k"], self.tableau
        x, time = f["x"], self.row(Clock.TIME)
        step = f.select(active, self.row(Clock.STEP), 0)
        # The last slope of an accepted step is the first of the next; it is copied late: dense output needs both.
        fresh = self.row(Clock.FRESH).compare(">", 0)
        for i in f.each(self.size):
            last, first = f.load(self.kind, k, i + self.stages * self.size), f.load(self.kind, k, i)
            f.store(f.select(fresh, last, first), self.kind, k, i)
        self.set(Clock.FRESH, 0)
        for place, row in enumerate(tableau.stages[1:], 1):
            s.stage(x, k, row, place, time, step)
        for i in f.each(self.size):
            change = step * s.combination(k, tableau.weights, i)
            f.store(change, self.kind, self.change, i)
            f.store(f.load(self.kind, x, i) + change, self.kind, self.candidate, i)
        if tableau.first_same_as_last:
            s.state_argument(self.candidate)
            s.evaluate(time + step, self.fresh)
            self._kept_slope(active)
        error = estimated(f, s, tableau, x, self.candidate, k, step, self.relative, self.absolute)
        good = active & error.compare("<=", 1)
        bad = f.without(active, good)
        with f.when(f.anywhere(bad)):
            self._reject(bad, error, step)
        with f.when(f.anywhere(good)):
            self._accept(good, error, step, time)

    def _kept_slope(self, mask: Value) -> None:
        """f at the new point becomes the last slope of the lanes in the mask."""
        f = self.f
        for i in f.each(self.size):
            place = i + self.stages * self.size
            before = f.load(self.kind, f["k"], place)
            f.store(f.select(mask, f.load(self.kind, self.fresh, i), before), self.kind, f["k"], place)

    def _reject(self, bad: Value, error: Value, step: Value) -> None:
        f = self.f
        shrink, usable = shrinkage(f, self.tableau, error)
        self.set(Clock.STEP, f.select(bad, step * shrink, self.row(Clock.STEP)))
        self.set(Clock.REJECTED, self.row(Clock.REJECTED) + f.select(bad, 1, 0))
        self.set(Clock.INFINITE, f.select(bad, f.select(usable, 0, 1), self.row(Clock.INFINITE)))
        self.set(Clock.CAREFUL, f.select(bad, 1, self.row(Clock.CAREFUL)))

    def _accept(self, good: Value, error: Value, step: Value, time: Value) -> None:
        f, s, x = self.f, self.s, self.f["x"]
        for i in f.each(self.size):
            before, carried = f.load(self.kind, x, i), f.load(self.kind, f["carry"], i)
            f.store(f.select(good, before, f.load(self.kind, f["old"], i)), self.kind, f["old"], i)
            new = add_compensated(f, self.kind, x, f["carry"], i, f.load(self.kind, self.change, i))
            f.store(f.select(good, new, before), self.kind, x, i)
            size, largest = new.absolute(), f.load(self.kind, f["sizes"], i)
            f.store(f.select(good & largest.compare("<", size), size, largest), self.kind, f["sizes"], i)
            f.store(f.select(good, f.load(self.kind, f["carry"], i), carried), self.kind, f["carry"], i)
        self.set(Clock.START, f.select(good, time, self.row(Clock.START)))
        self.set(Clock.LAST, f.select(good, step, self.row(Clock.LAST)))
        carried = self.row(Clock.CARRY)
        new = add_compensated(f, self.kind, f["clock"], f.at(self.kind, f["clock"], Clock.CARRY), Clock.TIME, step)
        self.set(Clock.TIME, f.select(good, new, time))
        self.set(Clock.CARRY, f.select(good, self.row(Clock.CARRY), carried))
        if not self.tableau.first_same_as_last:
            s.state_argument(x)
            s.evaluate(self.row(Clock.TIME), self.fresh)
            self._kept_slope(good)
        self.set(Clock.FRESH, f.select(good, 1, 0))
        self.set(Clock.INFINITE, f.select(good, 0, self.row(Clock.INFINITE)))
        self.set(Clock.STEPS, self.row(Clock.STEPS) + f.select(good, 1, 0))
        self._grow(good, error, step)

    def _grow(self, good: Value, error: Value, step: Value) -> None:
        f = self.f
        careful = self.row(Clock.CAREFUL).compare("!=", 0)
        factor, size = growth(f, self.tableau, error, self.row(Clock.PREVIOUS), careful)
        grown = step * factor
        grown = f.select(grown.compare("<", self.longest), grown, self.longest)
        self.set(Clock.STEP, f.select(good, grown, self.row(Clock.STEP)))
        self.set(Clock.PREVIOUS, f.select(good, size, self.row(Clock.PREVIOUS)))
        self.set(Clock.CAREFUL, f.select(good, 0, self.row(Clock.CAREFUL)))
