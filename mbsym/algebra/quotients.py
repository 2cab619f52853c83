"""Quotients of polynomials in lowest terms, and power series of a small parameter with such coefficients.

A series sum_k c_k eps^k carries the order from which on nothing is known (``known``; None: it is exact), so that no
operation tells more coefficients than it has.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from mbsym.algebra.failures import Limit, NoClosedForm
from mbsym.expressions.message import Message

Polynomial = Any  # a flint.fmpq_mpoly: python-flint carries no types

#: Numerators and denominators with more terms are given up.
MOST_TERMS = 20_000


@dataclass(frozen=True)
class Quotient:
    """top/bottom in lowest terms, the leading coefficient of bottom is 1.  Raises NoClosedForm beyond MOST_TERMS."""

    top: Polynomial
    bottom: Polynomial

    @classmethod
    def of(cls, top: Polynomial, bottom: Polynomial | None = None) -> Quotient:
        """Raises ZeroDivisionError for bottom = 0."""
        if bottom is None:
            return cls(top, top.context().constant(1))
        if bottom == 0:
            raise ZeroDivisionError("a quotient with the denominator 0")
        if not bottom.is_constant():
            shared = top.gcd(bottom)
            if not shared.is_constant():
                top, bottom = top / shared, bottom / shared
        unit = bottom.leading_coefficient()
        if unit != 1:
            top, bottom = top / unit, bottom / unit
        if len(top) > MOST_TERMS or len(bottom) > MOST_TERMS:
            raise NoClosedForm(
                Message("a coefficient of the expansion has more than [[most]] terms", most=MOST_TERMS),
                limit=Limit.TERMS,
                remedy=LOWER,
            )
        return cls(top, bottom)

    @property
    def is_zero(self) -> bool:
        return bool(self.top == 0)

    def __add__(self, other: Quotient) -> Quotient:
        if self.bottom == other.bottom:
            return Quotient.of(self.top + other.top, self.bottom)
        return Quotient.of(self.top * other.bottom + other.top * self.bottom, self.bottom * other.bottom)

    def __neg__(self) -> Quotient:
        return Quotient(-self.top, self.bottom)

    def __sub__(self, other: Quotient) -> Quotient:
        return self + -other

    def __mul__(self, other: Quotient) -> Quotient:
        return Quotient.of(self.top * other.top, self.bottom * other.bottom)

    def __truediv__(self, other: Quotient) -> Quotient:
        return Quotient.of(self.top * other.bottom, self.bottom * other.top)

    def derivative(self, place: int) -> Quotient:
        """The derivative by a generator."""
        slope, below = self.top.derivative(place), self.bottom.derivative(place)
        if below == 0:
            return Quotient.of(slope, self.bottom)
        return Quotient.of(slope * self.bottom - self.top * below, self.bottom**2)


LOWER = "ask for a lower --order, or put in numbers with --set"


@dataclass(frozen=True)
class Series:
    """sum_k coefficients[k] eps^k + O(eps^known); exponents may be negative, coefficients are not zero."""

    context: Any
    coefficients: Mapping[int, Quotient] = field(default_factory=dict)
    known: int | None = None

    @classmethod
    def constant(cls, x: Quotient) -> Series:
        return cls(x.top.context(), {} if x.is_zero else {0: x})

    @property
    def lowest(self) -> int | None:
        """The exponent of the first coefficient that is not zero; None where none is known."""
        return min(self.coefficients, default=None)

    @property
    def is_zero(self) -> bool:
        """Whether it is exactly zero."""
        return not self.coefficients and self.known is None

    def coefficient(self, k: int) -> Quotient:
        """Raises IndexError where it is not known."""
        if self.known is not None and k >= self.known:
            raise IndexError(k)
        return self.coefficients.get(k, Quotient.of(self.context.constant(0)))

    def up_to(self, known: int | None) -> Series:
        """The same, with nothing known from this order on."""
        most = _least(self.known, known)
        return Series(self.context, {k: c for k, c in self.coefficients.items() if most is None or k < most}, most)

    def exactly(self) -> Series:
        """The coefficients that are known, as if there were no others."""
        return Series(self.context, self.coefficients)

    def shifted(self, by: int) -> Series:
        """eps^by times this."""
        known = None if self.known is None else self.known + by
        return Series(self.context, {k + by: c for k, c in self.coefficients.items()}, known)

    def __add__(self, other: Series) -> Series:
        total = dict(self.coefficients)
        for k, c in other.coefficients.items():
            total[k] = total[k] + c if k in total else c
        found = Series(self.context, {k: c for k, c in total.items() if not c.is_zero})
        return found.up_to(_least(self.known, other.known))

    def __neg__(self) -> Series:
        return Series(self.context, {k: -c for k, c in self.coefficients.items()}, self.known)

    def __sub__(self, other: Series) -> Series:
        return self + -other

    def __mul__(self, other: Series) -> Series:
        known = _least(_reach(self, other), _reach(other, self))
        total: dict[int, Quotient] = {}
        for k, a in self.coefficients.items():
            for n, b in other.coefficients.items():
                if known is None or k + n < known:
                    c = a * b
                    total[k + n] = total[k + n] + c if k + n in total else c
        return Series(self.context, {k: c for k, c in total.items() if not c.is_zero}, known)

    def __truediv__(self, number: int) -> Series:
        found = {k: Quotient.of(c.top / number, c.bottom) for k, c in self.coefficients.items()}
        return Series(self.context, found, self.known)

    def over(self, other: Series, known: int) -> Series:
        """The quotient up to eps^known, term by term.  Raises ZeroDivisionError where no coefficient of it is known."""
        first = other.lowest
        if first is None:
            raise ZeroDivisionError("a quotient of series with the denominator 0")
        start = self.lowest
        lead = other.coefficients[first]
        reach = _least(
            None if self.known is None else self.known - first,
            None if other.known is None or start is None else start - first + other.known - first,
        )
        reach = known if reach is None else min(reach, known)
        found: dict[int, Quotient] = {}
        for k in range(start - first if start is not None else reach, reach):
            c = self.coefficients.get(k + first, Quotient.of(self.context.constant(0)))
            for n, b in found.items():
                further = other.coefficients.get(k + first - n)
                if further is not None:
                    c = c - b * further
            if not c.is_zero:
                found[k] = c / lead
        return Series(self.context, found, reach)


def _least(a: int | None, b: int | None) -> int | None:
    return b if a is None else a if b is None else min(a, b)


def _reach(a: Series, b: Series) -> int | None:
    """From which order on a * b is not known because a is not."""
    if a.known is None or b.is_zero:
        return None
    start = b.lowest if b.lowest is not None else b.known
    return None if start is None else a.known + start
