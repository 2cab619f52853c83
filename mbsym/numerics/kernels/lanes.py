"""Writing LLVM functions over several numbers side by side: every value is a vector of ``lanes`` numbers, one a state.

Comparisons give a mask, a bit a lane; ``anywhere`` and ``bit`` tell of masks what branches need to know.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

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
from mbsym.numerics.kernels.writer import BIT, INTEGER, Function, Number, Value

DOUBLE = "double"


class Lanes(Function):
    """A Function whose floating-point values may be vectors of ``lanes`` numbers (of the type ``kind``)."""

    def __init__(self, name: str, arguments: Sequence[tuple[str, str]], lanes: int) -> None:
        super().__init__(name, arguments)
        self.lanes = lanes
        self.kind = vector(lanes, DOUBLE)
        self.mask = vector(lanes, BIT)

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

    def below(self, a: Value, sign: str, b: Value | Number) -> Value:
        """The mask of ``a sign b``; false where one is not a number."""
        ordered = {"<": "olt", "<=": "ole", ">": "ogt", ">=": "oge", "!=": "one"}[sign]
        right = self.number(b, self.kind)
        return self.value(self.mask, f"fcmp {ordered} {self.kind} {a.text}, {right.text}")

    def select(self, mask: Value, yes: Value | Number, no: Value | Number) -> Value:
        """Lane by lane ``yes`` where the mask is set, else ``no``."""
        first, second = self.number(yes, self.kind), self.number(no, self.kind)
        operands = f"{self.mask} {mask.text}, {self.kind} {first.text}, {self.kind} {second.text}"
        return self.value(self.kind, f"select {operands}")

    def without(self, mask: Value, other: Value) -> Value:
        """mask and not other."""
        ones = splat(self.lanes, BIT, "1")
        turned = self.value(self.mask, f"xor {self.mask} {other.text}, {ones}")
        return self.value(self.mask, f"and {self.mask} {mask.text}, {turned.text}")

    def anywhere(self, mask: Value) -> Value:
        """A bit: whether the mask is set in some lane."""
        whole = self.value(f"i{self.lanes}", f"bitcast {self.mask} {mask.text} to i{self.lanes}")
        return self.value(BIT, f"icmp ne i{self.lanes} {whole.text}, 0")

    def bit(self, mask: Value, lane: int) -> Value:
        """The mask in one lane."""
        return self.value(BIT, f"extractelement {self.mask} {mask.text}, i32 {lane}")

    def magnitude(self, x: Value) -> Value:
        """|x| lane by lane."""
        return self.value(self.kind, f"call {self.kind} @llvm.fabs.v{self.lanes}f64({self.kind} {x.text})")

    def root(self, x: Value) -> Value:
        """The square root lane by lane."""
        return self.value(self.kind, f"call {self.kind} @llvm.sqrt.v{self.lanes}f64({self.kind} {x.text})")

    def lanewise(self, function: str, x: Value) -> Value:
        """A function of the C library, lane after lane."""
        found = "poison"
        for lane in range(self.lanes):
            one = self.value(DOUBLE, f"extractelement {self.kind} {x.text}, i32 {lane}")
            result = self.call(function, DOUBLE, one)
            found = self.value(self.kind, f"insertelement {self.kind} {found}, double {result.text}, i32 {lane}").text
        return Value(self, self.kind, found)

    def splatted(self, x: Value) -> Value:
        """One number in every lane."""
        found = "poison"
        for lane in range(self.lanes):
            found = self.value(self.kind, f"insertelement {self.kind} {found}, double {x.text}, i32 {lane}").text
        return Value(self, self.kind, found)


def wide_scalar(lanes: int) -> Scalar:
    """Vectors of float64 as an arithmetic of their own."""
    return Scalar(FLOAT64, vector(lanes, DOUBLE), "", SCALARS[FLOAT64].dtype)


def library(code: Code, drivers: str, lanes: int) -> Library:
    """The code as ``rhs(in, out)``, rows of ``lanes`` numbers each, with functions that call it."""
    scalar = SCALARS[FLOAT64]
    own = declarations([code], scalar, lanes)
    kind = vector(lanes, DOUBLE)
    wanted = [f"declare {kind} @llvm.{name}.v{lanes}f64({kind})\n" for name in ("fabs", "sqrt")]
    wanted += [f"declare double @{name}(double) #1\n" for name in ("exp", "log")]
    called = "define internal void @rhs(ptr noalias %in, ptr noalias %out) #0 {\n"
    called += f"  call void @rhs.wide(ptr %in, ptr %out, i64 {lanes})\n  ret void\n}}\n"
    more = "".join(line for line in wanted if line.split("(")[0] not in own)
    text = "\n".join([own, more, wide_text("rhs", code, scalar, lanes), called, drivers, ATTRIBUTES])
    return Library(text, thorough=False)


__all__ = ["DOUBLE", "INTEGER", "Lanes", "library", "wide_scalar"]
