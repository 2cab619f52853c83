"""Tables as LLVM text: the piece by a search among the knots, then its polynomial, as in ``mbsym.algebra.lookup``."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from mbsym.expressions.table import Tabulated


def called(name: Tabulated, suffix: str) -> str:
    """The function of a curve in LLVM text."""
    return f'"{name}.{suffix or "d"}"'


def llvm_text(name: Tabulated, kind: str, suffix: str, constant: Callable[[Fraction, str], str]) -> str:
    """A function of one number of LLVM's type ``kind``; ``constant`` writes its numbers."""
    curve = name.curve
    degree = len(curve.polynomials[0])

    def array(what: str, values: list[Fraction]) -> str:
        entries = ", ".join(f"{kind} {constant(value, kind)}" for value in values)
        return f'@"{name}.{suffix}.{what}" = private unnamed_addr constant [{len(values)} x {kind}] [{entries}]'

    rows = [number for base, own in zip(curve.bases, curve.polynomials, strict=True) for number in (base, *own)]
    lines = [
        array("knots", list(curve.knots)),
        array("rows", rows),
        f"define internal {kind} @{called(name, suffix)}({kind} %x) #1 {{",
        "entry:",
        "  br label %search",
        "search:",
        "  %low = phi i64 [0, %entry], [%left, %halve]",
        f"  %high = phi i64 [{len(curve.knots)}, %entry], [%right, %halve]",
        "  %open = icmp ult i64 %low, %high",
        "  br i1 %open, label %halve, label %found",
        "halve:",
        "  %sum = add i64 %low, %high",
        "  %middle = lshr i64 %sum, 1",
        f'  %place = getelementptr {kind}, ptr @"{name}.{suffix}.knots", i64 %middle',
        f"  %knot = load {kind}, ptr %place",
        f"  %behind = fcmp oge {kind} %x, %knot",
        "  %after = add i64 %middle, 1",
        "  %left = select i1 %behind, i64 %after, i64 %low",
        "  %right = select i1 %behind, i64 %high, i64 %middle",
        "  br label %search",
        "found:",
        f"  %start = mul i64 %low, {degree + 1}",
        f'  %row = getelementptr {kind}, ptr @"{name}.{suffix}.rows", i64 %start',
        f"  %base = load {kind}, ptr %row",
        f"  %u = fsub {kind} %x, %base",
    ]
    for power in range(degree):
        lines += [
            f"  %at{power} = getelementptr {kind}, ptr %row, i64 {power + 1}",
            f"  %c{power} = load {kind}, ptr %at{power}",
        ]
    total = f"%c{degree - 1}"
    for power in range(degree - 2, -1, -1):
        lines += [f"  %p{power} = fmul {kind} {total}, %u", f"  %s{power} = fadd {kind} %p{power}, %c{power}"]
        total = f"%s{power}"
    if degree == 1:  # no number has no value
        lines += [f"  %odd = fcmp uno {kind} %x, %x", f"  %all = select i1 %odd, {kind} %x, {kind} {total}"]
        total = "%all"
    return "\n".join([*lines, f"  ret {kind} {total}", "}", ""])
