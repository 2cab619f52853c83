"""Sine and cosine of several angles at once, as LLVM text without tables and, for usual angles, without branches.

    { <N x double>, <N x double> } sine_cosine.N(<N x double> x)          N = 1: plain numbers

With n the whole number nearest to 2|x|/pi, pi/2 is subtracted n times in three parts (Cody & Waite, Software Manual for
the Elementary Functions, 1980): the products of n < 2^16 with the first two parts of 36 bits are exact, and what the
second subtraction rounds off is kept, so that the remainder r + s is good to some 2^-108 even where x is next to a
multiple of pi/2.  On |r| <= pi/4

    sin(r + s) = r + r^3 P(r^2) + s (1 - r^2/2),     cos(r + s) = 1 - r^2/2 + r^4 Q(r^2) - r s

with the minimax coefficients of fdlibm's k_sin.c and k_cos.c (Sun Microsystems, 1993; |error| < 2^-58); the sums are
arranged for few operations one after the other.  Lanes with |x| > 1e5, infinities and NaN go to the C library.
"""

from __future__ import annotations

import struct
from fractions import Fraction

#: Beyond this the C library computes.
LARGEST_ANGLE = 1e5

#: pi to 50 digits; pi/2 = the sum of parts of 36, 36 and 53 bits.
_PI = Fraction("3.14159265358979323846264338327950288419716939937510")

_SINE = (
    -1.66666666666666324348e-01,
    8.33333333332248946124e-03,
    -1.98412698298579493134e-04,
    2.75573137070700676789e-06,
    -2.50507602534068634195e-08,
    1.58969099521155010221e-10,
)
_COSINE = (
    4.16666666666666019037e-02,
    -1.38888888888741095749e-03,
    2.48015872894767294178e-05,
    -2.75573143513906633035e-07,
    2.08757232129817482790e-09,
    -1.13596475577881948265e-11,
)

#: Added to a number below 2^51 it leaves the nearest whole number in the last bits.
_ROUNDER = 1.5 * 2.0**52


def _parts() -> tuple[float, float, float]:
    rest, parts = _PI / 2, []
    for bits in (35, 71):  # places after the point
        head = Fraction(int(rest * 2**bits), 2**bits)
        parts.append(float(head))
        rest -= head
    return parts[0], parts[1], float(rest)


def vector(lanes: int, kind: str) -> str:
    """LLVM's type of ``lanes`` numbers."""
    return kind if lanes == 1 else f"<{lanes} x {kind}>"


def splat(lanes: int, kind: str, value: str) -> str:
    """A constant in every lane."""
    return value if lanes == 1 else f"<{', '.join([f'{kind} {value}'] * lanes)}>"


def name(lanes: int) -> str:
    return f"sine_cosine.{lanes}"


class _Text:
    """Lines of a function on vectors of float64 numbers; operands are names or constants."""

    def __init__(self, lanes: int) -> None:
        self.lanes = lanes
        self.number, self.whole, self.bit = (vector(lanes, kind) for kind in ("double", "i64", "i1"))
        self.suffix = "f64" if lanes == 1 else f"v{lanes}f64"
        self.lines: list[str] = []

    def _operand(self, value: str | float) -> str:
        if isinstance(value, str):
            return value
        return splat(self.lanes, "double", f"0x{struct.unpack('<Q', struct.pack('<d', value))[0]:016X}")

    def line(self, text: str) -> str:
        local = f"%t{len(self.lines)}"
        self.lines.append(f"  {local} = {text}")
        return local

    def plain(self, operation: str, a: str | float, b: str | float) -> str:
        """Rounded on its own, never contracted."""
        return self.line(f"{operation} {self.number} {self._operand(a)}, {self._operand(b)}")

    def fused(self, a: str | float, b: str | float, c: str | float) -> str:
        """a b + c, with one rounding where that is quick."""
        operands = ", ".join(f"{self.number} {self._operand(x)}" for x in (a, b, c))
        return self.line(f"call {self.number} @llvm.fmuladd.{self.suffix}({operands})")

    def minus(self, a: str) -> str:
        return self.line(f"fneg {self.number} {a}")

    def bits(self, operation: str, a: str, b: int) -> str:
        return self.line(f"{operation} {self.whole} {a}, {splat(self.lanes, 'i64', str(b))}")

    def choose(self, bit: str, yes: str, no: str) -> str:
        return self.line(f"select {self.bit} {bit}, {self.number} {yes}, {self.number} {no}")

    def cast(self, a: str, source: str, target: str) -> str:
        return self.line(f"bitcast {source} {a} to {target}")


def text(lanes: int) -> str:
    """The function ``sine_cosine.N`` and what it needs, except for the declarations."""
    t = _Text(lanes)
    number, whole = t.number, t.whole
    first, second, third = _parts()
    size = t.line(f"call {number} @llvm.fabs.{t.suffix}({number} %x)")
    counted = t.fused(size, float(2 / _PI), _ROUNDER)
    n = t.plain("fsub", counted, _ROUNDER)
    less = t.minus(n)
    once = t.fused(less, first, size)  # exact
    part = t.plain("fmul", n, second)  # exact
    twice = t.plain("fsub", once, part)
    # what that subtraction rounded off (Knuth's two-sum, whichever of the two is larger)
    back = t.plain("fsub", twice, once)
    lost = t.plain("fsub", t.plain("fsub", once, t.plain("fsub", twice, back)), t.plain("fadd", part, back))
    tail = t.fused(less, third, lost)
    r = t.plain("fadd", twice, tail)
    s = t.plain("fadd", t.plain("fsub", twice, r), tail)

    z = t.plain("fmul", r, r)
    zz = t.plain("fmul", z, z)
    cube = t.plain("fmul", z, r)
    high = t.fused(zz, _SINE[5], t.fused(z, _SINE[4], _SINE[3]))
    low = t.fused(z, _SINE[2], _SINE[1])
    series = t.fused(z, t.fused(zz, high, low), _SINE[0])
    correction = t.fused(t.plain("fmul", z, -0.5), s, s)
    sine = t.plain("fadd", r, t.fused(cube, series, correction))

    half = t.plain("fmul", z, 0.5)
    head = t.plain("fsub", 1.0, half)
    rounded = t.plain("fsub", t.plain("fsub", 1.0, head), half)
    high = t.fused(zz, t.fused(z, _COSINE[5], _COSINE[4]), t.fused(z, _COSINE[3], _COSINE[2]))
    low = t.fused(z, _COSINE[1], _COSINE[0])
    correction = t.fused(t.minus(r), s, rounded)
    cosine = t.plain("fadd", head, t.fused(zz, t.fused(zz, high, low), correction))

    # quadrants: 0 (s, c), 1 (c, -s), 2 (-s, -c), 3 (-c, s); sin takes the sign of x too
    turns = t.cast(counted, number, whole)
    odd = t.line(f"icmp ne {whole} {t.bits('and', turns, 1)}, {splat(lanes, 'i64', '0')}")
    a, b = t.choose(odd, cosine, sine), t.choose(odd, sine, cosine)
    above = t.bits("shl", t.bits("and", turns, 2), 62)
    beside = t.bits("shl", t.bits("and", t.bits("add", turns, 1), 2), 62)
    own = t.bits("and", t.cast("%x", number, whole), -(2**63))
    sign = t.line(f"xor {whole} {above}, {own}")
    a = t.cast(t.line(f"xor {whole} {t.cast(a, number, whole)}, {sign}"), whole, number)
    b = t.cast(t.line(f"xor {whole} {t.cast(b, number, whole)}, {beside}"), whole, number)

    far = t.line(f"fcmp ugt {number} {size}, {t._operand(LARGEST_ANGLE)}")
    some = far if lanes == 1 else t.line(f"call i1 @llvm.vector.reduce.or.v{lanes}i1({t.bit} {far})")
    pair = f"{{ {number}, {number} }}"
    lines = [
        _far_text(lanes),
        f"define internal {pair} @{name(lanes)}({number} %x) #3 {{",
        *t.lines,
        f"  br i1 {some}, label %far, label %near, !prof !0",
        "far:",
        f"  %f = call {pair} @{name(lanes)}.far({number} %x)",
        f"  %fa = extractvalue {pair} %f, 0",
        f"  %fb = extractvalue {pair} %f, 1",
        f"  %ga = select {t.bit} {far}, {number} %fa, {number} {a}",
        f"  %gb = select {t.bit} {far}, {number} %fb, {number} {b}",
        "  br label %near",
        "near:",
        f"  %a = phi {number} [{a}, %0], [%ga, %far]",
        f"  %b = phi {number} [{b}, %0], [%gb, %far]",
        f"  %p = insertvalue {pair} poison, {number} %a, 0",
        f"  %q = insertvalue {pair} %p, {number} %b, 1",
        f"  ret {pair} %q",
        "}",
        "",
    ]
    return "\n".join(lines)


def _far_text(lanes: int) -> str:
    """Lane by lane by the C library."""
    number = vector(lanes, "double")
    pair = f"{{ {number}, {number} }}"
    lines = [f"define internal {pair} @{name(lanes)}.far({number} %x) #4 {{"]
    sine, cosine = "poison", "poison"
    for i in range(lanes):
        x = "%x"
        if lanes > 1:
            x = f"%x{i}"
            lines.append(f"  {x} = extractelement {number} %x, i32 {i}")
        lines += [f"  %s{i} = call double @sin(double {x}) #1", f"  %c{i} = call double @cos(double {x}) #1"]
        if lanes > 1:
            lines += [
                f"  %a{i} = insertelement {number} {sine}, double %s{i}, i32 {i}",
                f"  %b{i} = insertelement {number} {cosine}, double %c{i}, i32 {i}",
            ]
            sine, cosine = f"%a{i}", f"%b{i}"
        else:
            sine, cosine = "%s0", "%c0"
    lines += [
        f"  %p = insertvalue {pair} poison, {number} {sine}, 0",
        f"  %q = insertvalue {pair} %p, {number} {cosine}, 1",
        f"  ret {pair} %q",
        "}",
        "",
    ]
    return "\n".join(lines)


def declarations(lanes: int) -> str:
    """Intrinsics of ``sine_cosine.N``; sin and cos of the C library are declared elsewhere."""
    number, suffix = vector(lanes, "double"), "f64" if lanes == 1 else f"v{lanes}f64"
    lines = [
        f"declare {number} @llvm.fabs.{suffix}({number})",
        f"declare {number} @llvm.fmuladd.{suffix}({number}, {number}, {number})",
    ]
    if lanes > 1:
        lines.append(f"declare i1 @llvm.vector.reduce.or.v{lanes}i1(<{lanes} x i1>)")
    return "\n".join([*lines, ""])
