"""The characteristic polynomial det(lambda^2 M + lambda C + K) and the polynomials that decide about its roots.

A polynomial in lambda (or in mu = lambda^2) is a tuple of coefficients from low to high powers; a coefficient is an
``fmpq_mpoly`` in the parameters, all of one context.  Matrices are tuples of rows.

Determinants are sums of products (minors of the first rows, each computed once), without division: with symbolic,
mostly sparse entries that is faster than elimination, whose intermediate entries swell.  Large matrices of numbers, or
in one generator, are eliminated without fractions.  The work is counted beforehand, and ``TooLargeError`` is raised
instead of running for minutes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from mbsym.algebra import matrices
from mbsym.algebra.factors import irreducible_factors, occurring
from mbsym.algebra.failures import TooLargeError
from mbsym.algebra.matrices import Operators
from mbsym.expressions.message import Message

Polynomial = Any  # a flint.fmpq_mpoly: python-flint carries no types
Coefficients = tuple[Polynomial, ...]
Matrix = Sequence[Sequence[Polynomial]]

#: Products of terms that one determinant may cost (about a second): what is larger nobody reads.
BUDGET = 4_000_000

#: What an operation costs besides its terms, in products of terms.
OVERHEAD = 15
#: Larger matrices of numbers, or in one generator, are eliminated; expansion looks at up to 2^n sets of columns.
MOST_EXPANDED = 8

#: Terms of a characteristic polynomial that is still factored and judged in symbols.
LONGEST = 12_000


def leading_minors(matrix: Matrix, budget: int = BUDGET) -> tuple[Polynomial, ...]:
    """The determinants of the upper left 1x1, 2x2, ..., n x n blocks.

    Raises ValueError unless square, n >= 1; TooLargeError where it would take more than ``budget`` products of terms.
    """
    n = len(matrix)
    if n == 0 or any(len(row) != n for row in matrix):
        raise ValueError("a square matrix with at least one row is needed")
    if n > MOST_EXPANDED and _generators(matrix) <= 1:
        polynomials = _eliminated(matrix, budget)
        if polynomials is not None:
            return polynomials
    return _expanded(matrix, budget)


def _expanded(matrix: Matrix, budget: int) -> tuple[Polynomial, ...]:
    """By expansion along the rows, without division."""
    return tuple(matrices.leading_minors(_Counted(matrix, budget), matrix))


class _Counted(Operators[Polynomial]):
    """Polynomials; products of terms are counted.  Raises TooLargeError beyond the budget."""

    def __init__(self, matrix: Matrix, budget: int) -> None:
        zero = matrix[0][0] * 0
        super().__init__(zero, zero + 1)
        self._order, self._left = len(matrix), budget
        self._minor, self._words = zero, 1

    def times(self, a: Polynomial, b: Polynomial) -> Polynomial:
        """An entry by a minor; one minor after another is asked for."""
        if b is not self._minor:
            self._minor, self._words = b, _words(b)
        self.spend(len(b) * len(a) * self._words)
        return b * a

    def spend(self, work: int) -> None:
        self._left -= OVERHEAD + work
        if self._left < 0:
            raise TooLargeError("a determinant of order [[order]] with too many terms", order=self._order)


def _eliminated(matrix: Matrix, budget: int) -> tuple[Polynomial, ...] | None:
    """By elimination without fractions (Bareiss): n^3/3 exact divisions; None where a leading minor vanishes."""
    n = len(matrix)
    rows = [list(row) for row in matrix]
    algebra = _Counted(matrix, budget)
    previous = algebra.one
    for k in range(n):
        pivot = rows[k][k]
        if pivot == 0:
            return None
        for i in range(k + 1, n):
            for j in range(k + 1, n):
                a, b, c = rows[i][j], rows[i][k], rows[k][j]
                algebra.spend((len(a) * len(pivot) + len(b) * len(c)) * _words(pivot))
                rows[i][j] = (a * pivot - b * c) / previous
        previous = pivot
    return tuple(rows[k][k] for k in range(n))


def _generators(matrix: Matrix) -> int:
    """How many generators the entries contain."""
    return len(occurring(x for row in matrix for x in row))


def _words(x: Polynomial) -> int:
    """The length of a coefficient, one of many, in units of some machine words."""
    if x == 0:
        return 1
    number = x.leading_coefficient()
    return 1 + (int(number.p).bit_length() + int(number.q).bit_length()) // 256


def determinant(matrix: Matrix, budget: int = BUDGET) -> Polynomial:
    """det of a square matrix, without division."""
    return leading_minors(matrix, budget)[-1]


def adjugate(matrix: Matrix) -> list[list[Polynomial]]:
    """adj A of a square matrix with at least one row, without division."""
    one = matrix[0][0] * 0 + 1
    return matrices.adjugate(matrix, lambda rows: determinant(rows) if rows else one)


def characteristic_polynomial(m: Matrix, c: Matrix, k: Matrix) -> Coefficients:
    """det(lambda^2 M + lambda C + K), 2n + 1 coefficients from low to high (zeros included).

    Raises ValueError for matrices of other shapes, TooLargeError where the polynomial has too many terms.
    """
    n = len(m)
    if n == 0 or any(len(rows) != n or any(len(row) != n for row in rows) for rows in (m, c, k)):
        raise ValueError("M, C and K must be square matrices of one size")
    lam = _Variable(m[0][0].context())
    value = determinant(_pencil(lam, m, c, k))
    if len(value) > LONGEST:
        raise TooLargeError("a characteristic polynomial of [[count]] terms", count=len(value))
    return lam.coefficients(value, 2 * n)


def is_semisimple(m: Matrix, c: Matrix, k: Matrix, factor: Coefficients, multiplicity: int) -> bool:
    """Whether the roots of an irreducible ``factor`` of det(lambda^2 M + lambda C + K) have no Jordan blocks.

    Exact, for all parameters with distinct simple factors: factor^multiplicity divides the determinant, and the last
    invariant factor of the pencil, det / gcd(first minors), has it only once if and only if factor^(multiplicity-1)
    divides that gcd.
    """
    n = len(m)
    if multiplicity == 1:
        return True
    if n == 1:
        return False
    lam = _Variable(m[0][0].context())
    pencil = _pencil(lam, m, c, k)
    needed = lam.assemble(factor) ** (multiplicity - 1)
    for i in range(n):
        for j in range(n):
            if divmod(determinant(matrices.without(pencil, i, j)), needed)[1] != 0:
                return False
    return True


def first_minors(m: Matrix, c: Matrix, k: Matrix) -> Iterator[Coefficients]:
    """The minors of order n - 1 of lambda^2 M + lambda C + K that are not zero, from low to high powers; n > 1.

    Where one of them does not vanish at a root, the kernel there has one dimension: a multiple root has a Jordan block.
    """
    lam = _Variable(m[0][0].context())
    pencil, n = _pencil(lam, m, c, k), len(m)
    for i in range(n):
        for j in range(n):
            minor = trimmed(lam.coefficients(determinant(matrices.without(pencil, i, j)), 2 * n - 2))
            if minor[-1] != 0:
                yield minor


def _pencil(lam: _Variable, m: Matrix, c: Matrix, k: Matrix) -> list[list[Polynomial]]:
    n = range(len(m))
    return [[lam.assemble((k[i][j], c[i][j], m[i][j])) for j in n] for i in n]


def primitive(coefficients: Sequence[Polynomial]) -> tuple[Coefficients, Polynomial]:
    """(primitive part, removed factor): coefficients = removed * primitive part.

    The primitive part has coprime coefficients, with integers of greatest common divisor 1; the removed factor has a
    positive leading coefficient.  Raises ValueError for the zero polynomial.
    """
    common = coefficients[0] * 0
    for coefficient in coefficients:
        common = common.gcd(coefficient)
    if common == 0:
        raise ValueError("the polynomial is zero")
    quotients = [coefficient / common for coefficient in coefficients]
    numbers = [number for quotient in quotients for number in quotient.coeffs()]
    content = rational_content(numbers)
    return tuple(quotient / content for quotient in quotients), common * content


def factor_in_lambda(coefficients: Sequence[Polynomial]) -> tuple[Polynomial, list[tuple[Coefficients, int]]]:
    """(factor free of lambda, [(irreducible factor, multiplicity), ...]) over the rationals with the parameters.

    The product is the given polynomial.  Factors are sorted by degree, then by their text: the order is stable.
    """
    lam = _Variable(coefficients[0].context())
    unit, powers = irreducible_factors(lam.assemble(coefficients))
    rest = coefficients[0] * 0 + unit
    factors = []
    for factor, multiplicity in powers:
        degree = lam.degree(factor)
        cs = lam.coefficients(factor, degree)
        if degree == 0:
            rest *= cs[0] ** multiplicity
        else:
            factors.append((cs, multiplicity))
    factors.sort(key=lambda item: (len(item[0]), [str(c) for c in item[0]]))
    return rest, factors


def trimmed(coefficients: Sequence[Polynomial]) -> Coefficients:
    """Without vanishing leading coefficients (at least one coefficient stays)."""
    end = len(coefficients)
    while end > 1 and coefficients[end - 1] == 0:
        end -= 1
    return tuple(coefficients[:end])


def discriminant(coefficients: Sequence[Polynomial]) -> Polynomial:
    """a_n^(2n-2) prod (x_i - x_j)^2 over i < j; 1 for degree 1.  Raises ValueError for a constant."""
    return subdiscriminants(coefficients)[-1]


def subdiscriminants(coefficients: Sequence[Polynomial]) -> tuple[Polynomial, ...]:
    """D_1, ..., D_n with D_k = a_n^(2k-2) * sum over k-subsets of the roots of prod (x_i - x_j)^2.

    Over the reals all roots are real and simple if and only if all D_k > 0 (D_1 = n always is); D_n is the
    discriminant.  The D_k are, up to a_n^2, the lower right minors of the Bezoutian of p and p', which equals
    V^T V up to a triangular congruence (V: the Vandermonde matrix of the roots).  Raises ValueError for a constant.
    """
    p = trimmed(coefficients)
    n = len(p) - 1
    if n < 1:
        raise ValueError("a polynomial of degree 1 at least is needed")
    derivative = tuple(p[i] * i for i in range(1, n + 1))
    bezoutian = _bezoutian(p, (*derivative, p[0] * 0))
    reverse = [row[::-1] for row in bezoutian[::-1]]
    square = p[n] * p[n]
    return tuple(minor / square for minor in leading_minors(reverse))


def resultant(left: Sequence[Polynomial], right: Sequence[Polynomial]) -> Polynomial:
    """Vanishes exactly where two polynomials in lambda have a common root (or both leading coefficients vanish).

    Raises TooLargeError where it would have too many terms.
    """
    terms = [sum(len(c) for c in p if c != 0) for p in (left, right)]
    if terms[0] ** (len(right) - 1) * terms[1] ** (len(left) - 1) > BUDGET**2:
        raise TooLargeError("a resultant with too many terms")
    lam = _Variable(left[0].context())
    value = lam.assemble(left).resultant(lam.assemble(right), lam.name)
    return lam.coefficients(value, 0)[0]


def hurwitz_minors(coefficients: Sequence[Polynomial]) -> tuple[Polynomial, ...]:
    """Delta_1, ..., Delta_n of a_n lambda^n + ... + a_0: leading minors of H_ij = a_(n - 2j + i), i, j = 1..n.

    Raises ValueError for a constant.
    """
    p = trimmed(coefficients)
    n = len(p) - 1
    if n < 1:
        raise ValueError("a polynomial of degree 1 at least is needed")
    return leading_minors(matrices.hurwitz(p[::-1], p[0] * 0, n))


def lienard_chipart(coefficients: Sequence[Polynomial]) -> tuple[tuple[str, Polynomial], ...]:
    """(label, polynomial): all roots have Re < 0 if and only if all of them are > 0, given a_n > 0.

    Lienard and Chipart: every coefficient, and of the Hurwitz minors only Delta_(n-1), Delta_(n-3), ... (from
    Delta_2 on; Delta_1 is a coefficient).  Labels: ``a0`` ... ``an``, ``Hurwitz minor k``.
    """
    p = trimmed(coefficients)
    n = len(p) - 1
    result = [(f"a{i}", p[i]) for i in range(n, -1, -1)]
    if n >= 3:
        # Delta_1 .. Delta_(n-1) do not involve the last row and column, so they come from a smaller matrix.
        minors = leading_minors(matrices.hurwitz(p[::-1], p[0] * 0, n - 1))
        result += [(Message("Hurwitz minor [[k]]", k=k), minors[k - 1]) for k in range(n - 1, 1, -2)]
    return tuple(result)


def _bezoutian(p: Coefficients, q: Coefficients) -> list[list[Polynomial]]:
    """B with (p(x) q(y) - p(y) q(x))/(x - y) = sum B_ij x^i y^j; p and q of equal length n + 1, B is n x n."""
    n = len(p) - 1
    zero = p[0] * 0
    if sum(map(len, p)) * sum(map(len, q)) > BUDGET:
        raise TooLargeError("a discriminant with too many terms")
    b = [[zero] * n for _ in range(n)]
    for i in range(n):
        for j in range(i, n):
            # B_ij = (p_(j+1) q_i - p_i q_(j+1)) + B_(i-1)(j+1)
            entry = p[j + 1] * q[i] - p[i] * q[j + 1]
            if i > 0 and j + 1 < n:
                entry += b[i - 1][j + 1]
            b[i][j] = b[j][i] = entry
    return b


def rational_content(numbers: Sequence[Any]) -> Any:
    """The positive rational c for which numbers / c are integers without a common divisor."""
    numerator, denominator = 0, 1
    for number in numbers:
        numerator = number.p.gcd(numerator) if numerator else abs(number.p)
        denominator = number.q * denominator / number.q.gcd(denominator) if denominator != 1 else number.q
    return (numbers[0] * 0 + numerator) / denominator


class _Variable:
    """One generator more than a context has: the way between lists of coefficients and polynomials in lambda."""

    def __init__(self, context: Any) -> None:
        names = context.names()
        self.name = "lambda"
        while self.name in names:
            self.name += "_"
        self.small = context
        self.large = context.append_gens(self.name)
        self.index = context.nvars()

    def assemble(self, coefficients: Sequence[Polynomial]) -> Polynomial:
        terms = {}
        for power, coefficient in enumerate(coefficients):
            for exponents, number in coefficient.to_dict().items():
                terms[(*exponents, power)] = number
        return self.large.from_dict(terms)

    def degree(self, p: Polynomial) -> int:
        return int(p.degrees()[self.index]) if p != 0 else 0

    def coefficients(self, p: Polynomial, degree: int) -> Coefficients:
        tables: list[dict[tuple[int, ...], Any]] = [{} for _ in range(degree + 1)]
        for exponents, number in p.terms():
            tables[exponents[self.index]][exponents[:-1]] = number
        return tuple(self.small.from_dict(table) for table in tables)
