"""Quotients of polynomials in lowest terms, and power series of a small parameter with such coefficients.

A series sum_k c_k eps^k carries the order from which on nothing is known (``known``; None: it is exact), so that no
operation tells more coefficients than it has.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from mbsym.algebra.failures import Limit, NoClosedForm
from mbsym.algebra.terms import apart

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
                "a coefficient of the expansion has more than [[most]] terms",
                most=MOST_TERMS,
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
        series = Series(self.context, {k: c for k, c in total.items() if not c.is_zero})
        return series.up_to(_least(self.known, other.known))

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
        quotients = {k: Quotient.of(c.top / number, c.bottom) for k, c in self.coefficients.items()}
        return Series(self.context, quotients, self.known)

    def derivative(self, place: int) -> Series:
        """The derivative by a generator."""
        slopes = {k: c.derivative(place) for k, c in self.coefficients.items()}
        return Series(self.context, {k: c for k, c in slopes.items() if not c.is_zero}, self.known)

    def over(self, other: Series, known: int | None) -> Series:
        """The quotient up to eps^known, term by term; by one term it is exact.

        Raises ZeroDivisionError where no coefficient of it is known, NoClosedForm where it has no end.
        """
        first = other.lowest
        if first is None:
            raise ZeroDivisionError("a quotient of series with the denominator 0")
        if other.known is None and len(other.coefficients) == 1:
            quotients = {k - first: c / other.coefficients[first] for k, c in self.coefficients.items()}
            return Series(self.context, quotients, None if self.known is None else self.known - first).up_to(known)
        if known is None:
            raise NoClosedForm("a quotient of series has no end: say up to which order it is wanted")
        start = self.lowest
        lead = other.coefficients[first]
        reach = _least(
            None if self.known is None else self.known - first,
            None if other.known is None or start is None else start - first + other.known - first,
        )
        reach = known if reach is None else min(reach, known)
        quotients = {}
        for k in range(start - first if start is not None else reach, reach):
            c = self.coefficients.get(k + first, Quotient.of(self.context.constant(0)))
            for n, b in quotients.items():
                further = other.coefficients.get(k + first - n)
                if further is not None:
                    c = c - b * further
            if not c.is_zero:
                quotients[k] = c / lead
        return Series(self.context, quotients, reach)


class Composition:
    """Polynomials and series with series in place of the generators at ``places``."""

    def __init__(self, context: Any, places: Sequence[int]) -> None:
        self.context, self.places = context, list(places)
        self._sorted: dict[int, tuple[Mapping[int, Polynomial], dict[tuple[int, ...], Series]]] = {}

    def __call__(self, p: Mapping[int, Polynomial], functions: Sequence[Series], known: int | None) -> Series:
        """sum_k p_k(s, functions) eps^k up to eps^known."""
        total = Series(self.context, {}, known)
        if known is not None and p:  # coefficients beyond are not needed: they would be long
            functions = [function.up_to(known - min(0, *p)) for function in functions]
        powers: dict[tuple[int, int], Series] = {}
        for exponents, factor in self._parts(p).items():
            term = factor
            for place, exponent in enumerate(exponents):
                if exponent:
                    term = (term * self._power(place, exponent, functions, powers)).up_to(known)
            total = total + term
        return total

    def of(self, x: Series, functions: Sequence[Series], known: int | None) -> Series:
        """x(s, functions, eps) up to eps^known."""
        known = _least(x.known, known)
        total = Series(self.context, {}, known)
        shares: list[tuple[Polynomial, dict[int, Polynomial]]] = []
        for k, c in x.coefficients.items():
            tops = next((tops for bottom, tops in shares if bottom == c.bottom), None)
            if tops is None:
                shares.append((c.bottom, tops := {}))
            tops[k] = c.top
        for bottom, tops in shares:
            held = any(bottom.degrees()[place] > 0 for place in self.places)
            below = self({0: bottom}, functions, known) if held else Series.constant(Quotient.of(bottom))
            total = total + self(tops, functions, known).over(below, known)
        return total

    def _power(
        self, place: int, exponent: int, functions: Sequence[Series], powers: dict[tuple[int, int], Series]
    ) -> Series:
        if exponent == 1:
            return functions[place]
        if (place, exponent) not in powers:
            powers[place, exponent] = self._power(place, exponent - 1, functions, powers) * functions[place]
        return powers[place, exponent]

    def _parts(self, p: Mapping[int, Polynomial]) -> dict[tuple[int, ...], Series]:
        """Exponents of the fast variables -> coefficient, free of them."""
        if id(p) in self._sorted:
            return self._sorted[id(p)][1]
        parts: dict[tuple[int, ...], dict[int, Quotient]] = {}
        for k, q in p.items():
            for exponents, part in apart(q, self.places).items():
                parts.setdefault(exponents, {})[k] = Quotient.of(part)
        series_by_exponents = {exponents: Series(self.context, graded) for exponents, graded in parts.items()}
        self._sorted[id(p)] = p, series_by_exponents  # held: its identity is not used again
        return series_by_exponents


def _least(a: int | None, b: int | None) -> int | None:
    return b if a is None else a if b is None else min(a, b)


def _reach(a: Series, b: Series) -> int | None:
    """From which order on a * b is not known because a is not."""
    if a.known is None or b.is_zero:
        return None
    start = b.lowest if b.lowest is not None else b.known
    return None if start is None else a.known + start
