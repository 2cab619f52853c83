"""The field that the coordinates of an exact point generate, as an ordered field with exact signs.

Over a rational x it is QQ(y), over a rational y it is QQ(x); otherwise QQ(x)[y]/B with a square-free B that has y for a
root.  Where B turns out to be reducible, by an element that shares a factor with it, it is replaced by its factor that
vanishes at y (dynamic evaluation: Della Dora, Dicrescenzo & Duval 1985).
"""

from __future__ import annotations

from typing import Any

from flint import fmpq, fmpq_poly

from mbsym.algebra.failures import Limit, TooLargeError
from mbsym.algebra.plane.elements import Element, ElementMatrix
from mbsym.algebra.plane.fields import Extension, Over, OverField
from mbsym.algebra.plane.numbers import AlgebraicNumber
from mbsym.algebra.plane.points import Point
from mbsym.algebra.plane.projection import Polynomial, coefficients
from mbsym.algebra.terms import univariate

#: Number fields of a higher degree are left alone: arithmetic in them takes minutes.
MOST_DEGREE = 48


#: At one point inverses may take so much work, degree^3 times bits: some seconds.
MOST_WORK = 400_000_000


class _Purse:
    """What inverses at one point have cost so far."""

    def __init__(self) -> None:
        self.spent = 0

    def pay(self, degree: int, a: Any) -> None:
        """Raises TooLargeError where the inverse of a would be too much."""
        bits = int(a.denom()).bit_length() + max((int(c).bit_length() for c in a.numer().coeffs()), default=0)
        self.spent += degree**3 * bits
        if self.spent > MOST_WORK:
            raise TooLargeError(
                "arithmetic at a point in a number field of degree [[degree]]", degree=degree, limit=Limit.WORK
            )


def _affordable(degree: int) -> None:
    if degree > MOST_DEGREE:
        raise TooLargeError("a point in a number field of degree [[degree]]", degree=degree, limit=Limit.DEGREE)


def _degree(x: Any) -> int:
    return 1 if isinstance(x, fmpq) else int(x.polynomial.degree())


class SimpleField:
    """QQ(alpha): values are ``fmpq_poly`` in alpha."""

    def __init__(self, alpha: AlgebraicNumber) -> None:
        self.alpha, self.modulus = alpha, alpha.modulus
        self._extension, self._purse = Extension(alpha), _Purse()

    def constant(self, x: Any) -> Any:
        return fmpq_poly([x])

    def add(self, a: Any, b: Any) -> Any:
        return a + b

    def times(self, a: Any, b: Any) -> Any:
        return a * b % self.modulus

    def inverse(self, a: Any) -> Any:
        self._purse.pay(self.modulus.degree(), a)
        return self._extension.inverse(a)

    def sign(self, a: Any) -> int:
        return self.alpha.sign(a)


class TowerField:
    """QQ(alpha)[y]/B: values are polynomials in y of lower degree than B over QQ(alpha)."""

    def __init__(self, root: Over) -> None:
        self.root, self.over, self._purse = root, root.over, _Purse()

    def constant(self, x: Any) -> OverField:
        return [] if x == 0 else [fmpq_poly([x])]

    def reduced(self, a: OverField) -> OverField:
        a = self.over.trimmed(a)
        return a if len(a) < len(self.root.polynomial) else self.over.divided(a, self.root.polynomial)[1]

    def add(self, a: OverField, b: OverField) -> OverField:
        if len(a) < len(b):
            a, b = b, a
        return self.over.trimmed([x + b[k] if k < len(b) else x for k, x in enumerate(a)])

    def times(self, a: OverField, b: OverField) -> OverField:
        if not a or not b:
            return []
        product = [fmpq_poly([0])] * (len(a) + len(b) - 1)
        for i, x in enumerate(a):
            for j, y in enumerate(b):
                product[i + j] = product[i + j] + x * y
        return self.reduced(product)

    def sign(self, a: OverField) -> int:
        found = self.root.sign(self.reduced(a))
        self._split(a, vanishes=found == 0)
        return found

    def _split(self, a: OverField, vanishes: bool) -> None:
        """Keeps the factor of B that a shows to be enough."""
        if not vanishes or not (a := self.reduced(a)):
            return
        common = self.over.gcd(self.root.polynomial, a)
        if 1 < len(common) < len(self.root.polynomial):
            self.root.restrict(common)

    def inverse(self, a: OverField) -> OverField:
        """Extended Euclid; a factor shared with B is divided out of B first, as it does not vanish at y."""
        if self.sign(a) == 0:
            raise ZeroDivisionError("division by zero in a number field")
        a = self.reduced(a)
        while len(common := self.over.gcd(self.root.polynomial, a)) > 1:
            self.root.restrict(self.over.monic(self.over.divided(self.root.polynomial, common)[0]))
            a = self.reduced(a)
        over = self.over
        # s a = r modulo B for both rows of the scheme
        r0, r1 = self.root.polynomial, a
        s0: OverField = []
        s1: OverField = [fmpq_poly([1])]
        while len(r1) > 1:
            self._purse.pay(over.modulus.degree(), r1[-1])
            unit = over.inverse(r1[-1])
            monic = over.trimmed([x * unit for x in r1])
            quotient, rest = over.divided(r0, monic)
            quotient = over.trimmed([x * unit for x in quotient])
            r0, r1 = r1, rest
            product = self.times(quotient, s1)
            s0, s1 = s1, self.add(s0, [-x for x in product])
        self._purse.pay(over.modulus.degree(), r1[0])
        unit = over.inverse(r1[0])
        return over.trimmed([x * unit for x in s1])


class PointField:
    """Values of polynomials in x and y at a point that is not rational, with matrices and polynomials over them."""

    matrix = ElementMatrix

    def __init__(self, point: Point) -> None:
        """Raises TooLargeError beyond ``MOST_DEGREE``, ValueError for a rational point."""
        if point.rational:
            raise ValueError("a rational point has the rational numbers for its field")
        self.point = point
        x, y = point.x, point.y
        _affordable(_degree(x))
        if isinstance(y, Over):
            y.shrink()
            y.restrict(y.over.monic(y.polynomial))
        _affordable(_degree(x) * (len(y.polynomial) - 1 if isinstance(y, Over) else _degree(y)))
        self._field: SimpleField | TowerField
        if isinstance(y, Over) and len(y.polynomial) > 2:
            self._field = TowerField(y)
        else:
            self._field = SimpleField(y if isinstance(x, fmpq) else x)

    def settled(self, p: Polynomial) -> Polynomial:
        """p, or 0 where it vanishes at the point."""
        return p if p == 0 or self.value(p) else p * 0

    def value(self, p: Polynomial) -> Element:
        """p(x, y)"""
        x, y, field = self.point.x, self.point.y, self._field
        in_y = coefficients(p, 1)
        if isinstance(field, TowerField):
            return Element(field, field.reduced(list(in_y)))
        if isinstance(x, fmpq):
            return Element(field, fmpq_poly([c(x) for c in in_y]) % field.modulus)
        ordinate = fmpq_poly([y]) if isinstance(y, fmpq) else -y.polynomial[0]
        total = fmpq_poly([0])
        for c in reversed(in_y):
            total = (total * ordinate + c) % field.modulus
        return Element(field, total)


class LineField:
    """The same for polynomials in one generator at an algebraic number."""

    matrix = ElementMatrix

    def __init__(self, number: AlgebraicNumber) -> None:
        self._field = SimpleField(number)

    def settled(self, p: Polynomial) -> Polynomial:
        """p, or 0 where it vanishes at the number."""
        return p if p == 0 or self.value(p) else p * 0

    def value(self, p: Polynomial) -> Element:
        """p(x)"""
        return Element(self._field, univariate(p) % self._field.modulus)
