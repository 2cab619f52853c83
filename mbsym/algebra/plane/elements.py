"""Numbers, polynomials and matrices over an ordered field, with the methods of python-flint's rational ones.

So what is written for ``fmpq``, ``fmpq_poly`` and ``fmpq_mat`` (counts of roots by half-planes, verdicts at rational
points) runs at algebraic points as it stands.  Of the field only sums, products, inverses and signs are asked.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product, zip_longest
from typing import Any, Protocol

from flint import fmpq, fmpq_poly

from mbsym.algebra.base import Algebra
from mbsym.algebra.failures import Limit, TooLargeError
from mbsym.algebra.matrices import echelon, faddeev
from mbsym.algebra.plane.fields import Extension, Over, OverField, Point
from mbsym.algebra.plane.numbers import AlgebraicNumber
from mbsym.algebra.plane.projection import Polynomial, coefficients
from mbsym.algebra.terms import convolved, univariate

#: Up to this degree remainders are taken without inverses.
MOST_PSEUDO = 4


class OrderedField(Protocol):
    """What is asked of a field: values in a form of its own, signs decided exactly."""

    def constant(self, x: Any) -> Any: ...
    def add(self, a: Any, b: Any) -> Any: ...
    def times(self, a: Any, b: Any) -> Any: ...
    def inverse(self, a: Any) -> Any: ...
    def sign(self, a: Any) -> int: ...


@dataclass(frozen=True, eq=False)
class Element:
    """A number of the field."""

    field: OrderedField
    value: Any

    def _other(self, x: Any) -> Any:
        return x.value if isinstance(x, Element) else self.field.constant(fmpq(x))

    def __add__(self, other: Any) -> Element:
        return Element(self.field, self.field.add(self.value, self._other(other)))

    __radd__ = __add__

    def __neg__(self) -> Element:
        return self * -1

    def __sub__(self, other: Any) -> Element:
        return self + other * -1

    def __rsub__(self, other: Any) -> Element:
        return -self + other

    def __mul__(self, other: Any) -> Element:
        return Element(self.field, self.field.times(self.value, self._other(other)))

    __rmul__ = __mul__

    def inverse(self) -> Element:
        """1/x.  Raises ZeroDivisionError for zero."""
        return Element(self.field, self.field.inverse(self.value))

    def __truediv__(self, other: Any) -> Element:
        return self * (other.inverse() if isinstance(other, Element) else 1 / fmpq(other))

    def sign(self) -> int:
        """-1, 0 or 1."""
        return self.field.sign(self.value)

    def __bool__(self) -> bool:
        return self.sign() != 0

    def __eq__(self, other: object) -> bool:
        return (self - other).sign() == 0

    __hash__ = None  # type: ignore[assignment]

    def __gt__(self, other: Any) -> bool:
        return (self - other).sign() > 0

    def __lt__(self, other: Any) -> bool:
        return (self - other).sign() < 0

    def __abs__(self) -> Element:
        return -self if self.sign() < 0 else self


class ElementPolynomial:
    """A polynomial in one variable; coefficients from low to high powers."""

    def __init__(self, coefficients: Sequence[Element]) -> None:
        elements = list(coefficients)
        while elements and not elements[-1]:
            elements.pop()
        self._coefficients = elements

    def coeffs(self) -> list[Element]:
        return list(self._coefficients)

    def degree(self) -> int:
        return len(self._coefficients) - 1

    def length(self) -> int:
        return len(self._coefficients)

    def leading_coefficient(self) -> Element:
        return self._coefficients[-1]

    def __getitem__(self, k: int) -> Any:
        return self._coefficients[k] if k < len(self._coefficients) else fmpq(0)

    def __eq__(self, other: object) -> bool:
        if other == 0:
            return not self._coefficients
        return NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def __neg__(self) -> ElementPolynomial:
        return ElementPolynomial([-c for c in self._coefficients])

    def __truediv__(self, number: Element) -> ElementPolynomial:
        inverse = number.inverse()
        return ElementPolynomial([c * inverse for c in self._coefficients])

    def monic(self) -> ElementPolynomial:
        """Divided by its leading coefficient."""
        return self / self._coefficients[-1] if self._coefficients else self

    def derivative(self) -> ElementPolynomial:
        return ElementPolynomial([c * k for k, c in enumerate(self._coefficients)][1:])

    def __divmod__(self, other: ElementPolynomial) -> tuple[ElementPolynomial, ElementPolynomial]:
        rest, by = self.coeffs(), other.coeffs()
        if not by:
            raise ZeroDivisionError("division by the zero polynomial")
        inverse = by[-1].inverse()
        quotient: list[Element] = []
        while len(rest) >= len(by):
            factor = rest.pop() * inverse
            quotient.append(factor)
            if factor:
                for k, c in enumerate(by[:-1]):
                    at = len(rest) - len(by) + 1 + k
                    rest[at] = rest[at] - factor * c
        return ElementPolynomial(quotient[::-1]), ElementPolynomial(rest)

    def __sub__(self, other: ElementPolynomial) -> ElementPolynomial:
        pairs: Any = zip_longest(self._coefficients, other.coeffs(), fillvalue=fmpq(0))
        return ElementPolynomial([a - b for a, b in pairs])

    def __mul__(self, other: ElementPolynomial) -> ElementPolynomial:
        return ElementPolynomial(convolved(self.coeffs(), other.coeffs()))

    def __mod__(self, other: ElementPolynomial) -> ElementPolynomial:
        """A positive multiple of the remainder, which serves gcds and Sturm's chains alike.

        Of short polynomials without inverses, whose numbers are far longer than those of products.
        """
        if self.degree() > MOST_PSEUDO or other.degree() < 0:
            return divmod(self, other)[1]
        rest, by = self.coeffs(), other.coeffs()
        lead, turned = by[-1], False
        while len(rest) >= len(by):
            factor, turned = rest.pop(), not turned
            rest = [lead * c for c in rest]
            for k, c in enumerate(by[:-1]):
                at = len(rest) - len(by) + 1 + k
                rest[at] = rest[at] - factor * c
        if turned and lead.sign() < 0:
            rest = [-c for c in rest]
        return ElementPolynomial(rest)

    def __floordiv__(self, other: ElementPolynomial) -> ElementPolynomial:
        return divmod(self, other)[0]

    def tidied(self) -> ElementPolynomial:
        """A positive multiple with the leading coefficient 1 or -1; itself where that would need long numbers."""
        return self if self.degree() < MOST_PSEUDO else self / abs(self._coefficients[-1])

    def gcd(self, other: ElementPolynomial) -> ElementPolynomial:
        """The monic greatest common divisor; zero where both are."""
        a, b = self, other
        while b.degree() > 0:
            rest = a % b
            a, b = b, rest if a.degree() <= MOST_PSEUDO else rest.monic()
        if b.degree() == 0:  # a number
            return ElementPolynomial([b[0] * 0 + 1])
        return a.monic()

    def factor_squarefree(self) -> tuple[Any, list[tuple[ElementPolynomial, int]]]:
        """(leading coefficient, [(square-free factor, multiplicity), ...]) by Yun's method, none constant.

        A polynomial that is square-free itself is not made monic.
        """
        if self.degree() < 1:
            return self[0], []
        factors = []
        f = self
        slope = f.derivative()
        common = f.gcd(slope)
        if common.degree() == 0:
            return self.leading_coefficient(), [(f, 1)]
        f = f.monic()
        slope = f.derivative()
        b, c = f // common, slope // common
        multiplicity = 1
        while b.degree() > 0:
            d = c - b.derivative()
            factor = b.gcd(d) if d.degree() >= 0 else b
            if factor.degree() > 0:
                factors.append((factor, multiplicity))
            b, c = b // factor, d // factor
            multiplicity += 1
        return self.leading_coefficient(), factors


class ElementMatrix:
    """A matrix; made as ``fmpq_mat(rows, columns, entries)`` is, of elements and rational numbers."""

    def __init__(self, rows: int, columns: int, entries: Sequence[Any] | None = None) -> None:
        self._size = (rows, columns)
        values = [fmpq(0)] * (rows * columns) if entries is None else list(entries)
        self._rows = [values[i * columns : (i + 1) * columns] for i in range(rows)]

    def nrows(self) -> int:
        return self._size[0]

    def tolist(self) -> list[list[Any]]:
        return [list(row) for row in self._rows]

    def entries(self) -> list[Any]:
        return [x for row in self._rows for x in row]

    def __getitem__(self, key: tuple[int, int]) -> Any:
        return self._rows[key[0]][key[1]]

    def __setitem__(self, key: tuple[int, int], value: Any) -> None:
        self._rows[key[0]][key[1]] = fmpq(value) if isinstance(value, int) else value

    def __add__(self, other: ElementMatrix) -> ElementMatrix:
        return ElementMatrix(*self._size, [a + b for a, b in zip(self.entries(), other.entries(), strict=True)])

    def __mul__(self, other: Any) -> ElementMatrix:
        columns = list(zip(*other.tolist(), strict=True))
        return ElementMatrix(
            self._size[0], len(columns), [_ENTRIES.dot(row, column) for row in self._rows for column in columns]
        )

    def solve(self, right: ElementMatrix) -> ElementMatrix:
        """X with self X = right.  Raises ZeroDivisionError where this is singular."""
        n = self._size[0]
        whole = ElementMatrix(
            n, n + right._size[1], [x for a, b in zip(self._rows, right._rows, strict=True) for x in (*a, *b)]
        )
        reduced, pivots = whole._reduced(n)
        if len(pivots) < n:
            raise ZeroDivisionError("singular matrix")
        return ElementMatrix(n, right._size[1], [x for row in reduced for x in row[n:]])

    def rref(self) -> tuple[ElementMatrix, int]:
        """(reduced row echelon form, rank)"""
        reduced, pivots = self._reduced(self._size[1])
        return ElementMatrix(*self._size, [x for row in reduced for x in row]), len(pivots)

    def rank(self) -> int:
        return self.rref()[1]

    def _reduced(self, columns: int) -> tuple[list[list[Any]], list[int]]:
        """Rows after elimination in the first ``columns``, and the columns of the pivots."""
        return echelon(_ENTRIES, self._rows, columns)

    def charpoly(self) -> ElementPolynomial:
        """det(lambda - A)"""
        return ElementPolynomial(self._faddeev()[1])

    def _faddeev(self) -> tuple[list[list[list[Any]]], list[Any]]:
        """adj(lambda - A) and det(lambda - A): an inverse would cost more than all of these products."""
        zero = self._zero()
        return faddeev([[zero + x for x in row] for row in self._rows], zero, zero + 1)

    def _zero(self) -> Element:
        """Raises TypeError for a matrix of rational numbers."""
        some = next((x for x in self.entries() if isinstance(x, Element)), None)
        if some is None:
            raise TypeError("a matrix of rational numbers")
        return some * 0

    def minpoly(self) -> ElementPolynomial:
        """det(lambda - A) over the common divisor of its adjugate: the least polynomial that A annuls."""
        adjugates, characteristic = self._faddeev()
        common, places = ElementPolynomial([]), range(self._size[0])
        for i, j in product(places, places):
            common = common.gcd(ElementPolynomial([b[i][j] for b in reversed(adjugates)]))
            if common.degree() == 0:
                break
        return ElementPolynomial(characteristic) // common


def _plain_zero(x: Any) -> bool:
    """Whether this is a zero that was never computed with: its products are left out."""
    return not isinstance(x, Element) and x == 0


class _Entries(Algebra[Any]):
    """Elements, and rational numbers among them."""

    zero, one = fmpq(0), fmpq(1)

    def vanishes(self, x: Any) -> bool:
        return _plain_zero(x)

    def reciprocal(self, x: Any) -> Any:
        return x.inverse() if isinstance(x, Element) else 1 / x


_ENTRIES = _Entries()


# The field that the coordinates of an exact point generate, as an ordered field with exact signs.
#
# Over a rational x it is QQ(y), over a rational y it is QQ(x); otherwise QQ(x)[y]/B with a square-free B that has y for
# a root.  Where B turns out to be reducible, by an element that shares a factor with it, it is replaced by its factor
# that vanishes at y (dynamic evaluation: Della Dora, Dicrescenzo & Duval 1985).


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
        return self.reduced(convolved(a, b)) if a and b else []

    def sign(self, a: OverField) -> int:
        signum = self.root.sign(self.reduced(a))
        self._split(a, vanishes=signum == 0)
        return signum

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
