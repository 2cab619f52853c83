"""What decides the verdict of problem 6 at numbers, as quantities whose signs are read off machine code.

The exact judge (``problems.stability.exact``) looks at the inertia of M, K and D, at which of D, G, N vanish, and at
how many roots of the characteristic polynomial lie on either side of, and on, the imaginary axis.  All of these are
counts of signs:

* inertia: Descartes' rule for the characteristic polynomial of the matrix, exact where all eigenvalues are real;
* roots: the polynomial is split into E(lambda^2), of the factors that are even, and the rest P(lambda).  Sturm's
  sequence of E counts its negative and positive roots lambda^2, Routh's column of P its roots with Re > 0.

So two parameter values where no deciding quantity vanishes and all counts agree have **the same verdict**: it is found
once, exactly, for one of them.  Where a sign is not certain in the face of rounding, or a quantity vanishes, the point
is judged exactly by itself.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from random import Random
from typing import Any

import numpy as np
from flint import fmpq

from mbsym.algebra.base import Algebra, S
from mbsym.algebra.characteristic import Coefficients, Matrix, Polynomial, characteristic_polynomial, factor_in_lambda
from mbsym.algebra.failures import SingularPoint
from mbsym.algebra.matrices import added
from mbsym.algebra.point import Rationals
from mbsym.algebra.program import Program
from mbsym.algebra.running_error import Approximate, RunningErrors, certain_sign
from mbsym.algebra.terms import convolved
from mbsym.numerics.kernels.interface import Code
from mbsym.problems.stability.constant import Constant
from mbsym.problems.stability.linear_form import LinearSystem, is_zero
from mbsym.problems.stability.routh import ignoring_cyclic, momenta_are_constant, only_momenta
from mbsym.sweeps.formula import Horner

#: What is tried where a sequence of remainders ends early for all parameters; the seed of the points where that shows.
SHIFTS, SEED = (0, 1, 2, 3, 5), 20261122
#: So many different keys fit into one whole number.
MOST_IN_A_WORD = 2**62
#: Of a count: the sign of every quantity in a row must be certain.
Rows = tuple[int, ...]


@dataclass(frozen=True)
class Count:
    """Something that is counted from the signs of some outputs: ``kind`` is sign, inertia, routh or sturm."""

    kind: str
    rows: Rows
    further: Rows = ()

    @property
    def radix(self) -> int:
        """Its numbers lie between -1 and so many less 2."""
        return 3 if self.kind == "sign" else len(self.rows) + 2

    def certain(self, signs: Any) -> Any:
        """Where the signs tell what is counted: a mask of shape (m,)."""
        strict = np.all(np.abs(signs[list(self.rows)]) == 1, axis=0)
        if not self.further:
            return strict
        lowest = signs[list(self.further)]  # constant terms of Sturm's sequence, of which only the first must not be 0
        return strict & (np.abs(lowest[0]) == 1) & np.all(np.abs(lowest) <= 1, axis=0)

    def of(self, signs: Any) -> list[Any]:
        """Small whole numbers, each of shape (m,)."""
        first = signs[list(self.rows)]
        match self.kind:
            case "inertia":
                flips = np.array([-1 if k % 2 else 1 for k in range(len(self.rows))]).reshape(-1, 1)
                return [changes(first), changes(first * flips)]
            case "routh":
                return [changes(first)]
            case "sturm":
                return list(real_roots(first, signs[list(self.further)]))
        return [first[0]]


@dataclass(frozen=True)
class Deciding:
    """``code`` gives values, then error bounds, of the quantities at the named inputs; ``counts`` read them."""

    code: Code
    counts: tuple[Count, ...]

    @property
    def quantities(self) -> int:
        return len(self.code.outputs) // 2

    def keys(self, results: Any) -> tuple[Any, Any]:
        """(keys, certain) of what the code's kernel gave, shape (2q, m): of shapes (words, m) and (m,).

        Points with equal keys, both certain, have the same verdict.
        """
        half = self.quantities
        signs = certain_sign(results[:half], results[half:])
        certain = np.ones(results.shape[1], dtype=bool)
        words, room = [np.zeros(results.shape[1], dtype=np.int64)], MOST_IN_A_WORD
        for count in self.counts:
            certain &= count.certain(signs)
            for numbers in count.of(signs):
                if room < count.radix:
                    words.append(np.zeros(results.shape[1], dtype=np.int64))
                    room = MOST_IN_A_WORD
                words[-1] = words[-1] * count.radix + (numbers.astype(np.int64) + 1)
                room //= count.radix
        return np.array(words), certain


def deciding(
    parts: Sequence[LinearSystem],
    further: Sequence[Polynomial],
    names: Sequence[str],
    constant: Constant | None = None,
) -> Deciding:
    """The quantities of all subsystems, whose matrices hold polynomials in the generators ``names`` (in their order).

    ``further``: other polynomials whose signs the verdict depends on.  ``constant``: an irrational number, the last
    generator then.  Raises TooLargeError where a characteristic
    polynomial is too long.
    """
    made = _Made(names, constant)
    for part in parts:
        made.part(part)
    for polynomial in further:
        made.sign(polynomial)
    return made.finished()


class _Made:
    """Quantities, each once."""

    def __init__(self, names: Sequence[str], constant: Constant | None) -> None:
        self.names, self.constant = tuple(names), constant
        self.program = Program()
        self.algebra = RunningErrors(self.program)
        inputs = [self.algebra.input(name) for name in self.names]
        if constant is not None:
            inputs.append(self.algebra.irrational(float(constant.number)))
        self.value = Horner(self.algebra, inputs)
        self.outputs: list[Approximate] = []
        self.counts: list[Count] = []

    def finished(self) -> Deciding:
        values = tuple(x.value for x in self.outputs)
        errors = tuple(self.program.zero if x.error is None else x.error for x in self.outputs)
        return Deciding(Code(self.program, self.names, (*values, *errors)), tuple(dict.fromkeys(self.counts)))

    # --- what is looked at ---

    def part(self, system: LinearSystem) -> None:
        """Everything that the exact judge looks at."""
        for matrix in (system.M, system.kinetic, system.K, system.D):
            if not is_zero(matrix):
                self._inertia(matrix)
        for matrix in (system.D, system.G, system.N):
            self._whether_zero([x for row in matrix for x in row])
        for x in system.turned:
            self.sign(x)
        self._roots(system)
        if not system.cyclic:
            return
        self._whether_zero([x for matrix in (system.D, system.N) for i in system.cyclic for x in matrix[i]])
        self._whether_zero([system.G[i][j] for i in system.cyclic for j in system.cyclic])
        if momenta_are_constant(system) and not only_momenta(system):
            self.part(ignoring_cyclic(system))

    def sign(self, x: Polynomial) -> None:
        """One polynomial's sign, if it has no constant one."""
        if not x.is_constant():
            self._count("sign", [self.value(x)])

    def _whether_zero(self, entries: Sequence[Polynomial]) -> None:
        """Whether all of some entries vanish: the sum of their squares."""
        if any(not x.is_zero() and x.is_constant() for x in entries):
            return
        squares = [self.algebra.times(value, value) for value in map(self.value, entries)]
        total = self.algebra.zero
        for square in squares:
            total = total + square
        if not self.algebra.vanishes(total):
            self._count("sign", [total])

    def _inertia(self, matrix: Matrix) -> None:
        whole = tuple(x if self.constant is None else self.constant.reduced(x) for x in _of_matrix(matrix))
        nonzero = [x for x in whole if not x.is_zero()]
        if not all(x.is_constant() for x in nonzero):
            lowest = next(k for k, x in enumerate(whole) if not x.is_zero())
            if all(not x.is_zero() for x in whole[lowest:]):
                self._count("inertia", [self.value(x) for x in whole[lowest:]])
            else:
                for x in nonzero:
                    self.sign(x)

    def _roots(self, system: LinearSystem) -> None:
        polynomial = characteristic_polynomial(system.M, added(system.D, system.G), added(system.K, system.N))
        if self.constant is not None:
            polynomial = tuple(map(self.constant.reduced, polynomial))
        even, plain = split(polynomial)
        if len(even) > 1:
            shift = _generic(lambda xs, algebra, shift: sturm_ends(xs, algebra, shift)[0], even)
            leading, constant = sturm_ends([self.value(x) for x in even], self.algebra, shift)
            self._count("sturm", leading, constant)
        if len(plain) > 1:
            shift = _generic(routh_column, plain)
            self._count("routh", routh_column([self.value(x) for x in plain], self.algebra, shift))

    # --- how ---

    def _count(self, kind: str, first: Sequence[Approximate], second: Sequence[Approximate] = ()) -> None:
        self.counts.append(Count(kind, tuple(map(self._row, first)), tuple(map(self._row, second))))

    def _row(self, x: Approximate) -> int:
        if x not in self.outputs:
            self.outputs.append(x)
        return self.outputs.index(x)


def _generic(sequence: Callable[[Any, Any, int], Sequence[Any]], polynomial: Coefficients) -> int:
    """A shift with which no entry of a sequence vanishes at a random point; the last one tried if there is none."""
    source, numbers = Random(SEED), Rationals({}, {})
    count = polynomial[0].context().nvars()
    for shift in SHIFTS:
        point = [fmpq(source.randint(-999, 999), 1000) for _ in range(count)]
        try:
            if all(x != 0 for x in sequence([fmpq(x(*point)) for x in polynomial], numbers, shift)):
                return shift
        except SingularPoint:
            pass
    return SHIFTS[-1]


def _of_matrix(matrix: Matrix) -> Coefficients:
    """det(x 1 - A), from low to high powers."""
    one = matrix[0][0] * 0 + 1
    size = range(len(matrix))
    unit = tuple(tuple(one if i == j else one * 0 for j in size) for i in size)
    negative = tuple(tuple(-x for x in row) for row in matrix)
    nothing = tuple(tuple(one * 0 for _ in size) for _ in size)
    doubled = characteristic_polynomial(unit, nothing, negative)  # in the square of its variable
    return doubled[::2]


def split(polynomial: Coefficients) -> tuple[Coefficients, Coefficients]:
    """(E, P): E(lambda^2) of the different even factors, P of the other ones; roots 0 are left out, so are constants.

    E is free of squares.  A pair of factors F(lambda), F(-lambda) is one even factor.
    """
    start = next(k for k, x in enumerate(polynomial) if not x.is_zero())
    reduced = polynomial[start:]
    one = reduced[0] * 0 + 1
    if all(x.is_zero() for x in reduced[1::2]):
        return _product([factor for factor, _ in factor_in_lambda(reduced[::2])[1]], one), (one,)
    factors = [factor for factor, _ in factor_in_lambda(reduced)[1]]
    even = [factor[::2] for factor in factors if _is_even(factor)]
    plain = [factor for factor in factors if not _is_even(factor)]
    for factor in list(plain):
        mirrored = tuple(-x if k % 2 else x for k, x in enumerate(factor))
        if factor in plain and any(_same(mirrored, other) for other in plain if other is not factor):
            plain = [x for x in plain if x is not factor and not _same(mirrored, x)]
            even.append(_product([factor, mirrored], one)[::2])
    return _product(even, one), _product(plain, one)


def _is_even(factor: Coefficients) -> bool:
    return all(x.is_zero() for x in factor[1::2])


def _same(a: Coefficients, b: Coefficients) -> bool:
    """Whether one is a constant times the other."""
    return len(a) == len(b) and all((x * b[-1] - y * a[-1]).is_zero() for x, y in zip(a, b, strict=True))


def _product(factors: Sequence[Coefficients], polynomial: Polynomial) -> Coefficients:
    coefficients: Coefficients = (polynomial,)
    for factor in factors:
        if len(factor) > 1:
            coefficients = tuple(convolved(coefficients, factor))
    return coefficients


def classes(keys: Any, certain: Any) -> Iterator[tuple[tuple[int, ...], Any]]:
    """(key, indices of its points) of every class of points whose signs are certain."""
    at = np.flatnonzero(certain)
    if not len(at):
        return
    if keys.shape[0] == 1:
        distinct, inverse = np.unique(keys[0, at], return_inverse=True)
        distinct = distinct[np.newaxis]
    else:
        distinct, inverse = np.unique(keys[:, at], axis=1, return_inverse=True)
    order = np.argsort(inverse.reshape(-1), kind="stable")
    ends = np.cumsum(np.bincount(inverse.reshape(-1), minlength=distinct.shape[1]))
    for number, members in enumerate(np.split(at[order], ends[:-1])):
        yield tuple(map(int, distinct[:, number])), members


# Numbers of which the signs count roots, over any algebra: for generic polynomials, whose sequences do not end early.
#
# * ``routh_column``: the first column of Routh's array of p; p has as many roots with Re > 0 as it has changes of sign.
# * ``sturm_ends``: (leading coefficients, constant terms) of Sturm's sequence of Q; with the degrees they give the
#   changes of sign at -infinity, 0 and +infinity, hence how many different roots are negative, and positive.
#
# A leading entry that vanishes means a root on a border, or an unlucky sequence: then the signs say nothing here
# (``mbsym.algebra.roots`` counts there).


def routh_column(coefficients: Sequence[S], algebra: Algebra[S], shift: int = 0) -> list[S]:
    """The first column of Routh's array of (lambda + shift) p, of p itself for 0; coefficients from low to high powers.

    A positive shift adds one root on the left.  Raises SingularPoint at a pivot 0.
    """
    plain = list(coefficients)
    if shift:
        s = algebra.number(shift)
        plain = [*(algebra.times(s, x) for x in plain), algebra.zero]
        plain = [plain[0], *(a + b for a, b in zip(plain[1:], coefficients, strict=True))]
    falling = list(reversed(plain))
    upper, lower = falling[::2], falling[1::2]
    column = [upper[0]]
    while lower:
        column.append(lower[0])
        ratio = algebra.times(upper[0], algebra.reciprocal(lower[0]))
        following = [
            upper[j] - algebra.times(ratio, lower[j]) if j < len(lower) else upper[j] for j in range(1, len(upper))
        ]
        upper, lower = lower, following
    return column


def sturm_ends(coefficients: Sequence[S], algebra: Algebra[S], shift: int = 0) -> tuple[list[S], list[S]]:
    """Leading and constant coefficients of Q, R, -rem(Q, R), ...; coefficients from low to high powers.

    R is Q', or with a shift Q' (w + shift)^2 modulo Q: that counts the same roots, by a sequence that does not end
    early where that of Q' does (Q = w^3 + c).  Raises SingularPoint at a leading coefficient 0.
    """
    first = list(coefficients)
    second = [algebra.times(algebra.number(k), first[k]) for k in range(1, len(first))]
    for _ in range(2 if shift else 0):
        s = algebra.number(shift)
        longer = [algebra.zero, *second]
        for k, x in enumerate(second):
            longer[k] = longer[k] + algebra.times(s, x)
        ratio = algebra.times(longer[-1], algebra.reciprocal(first[-1]))
        second = [x - algebra.times(ratio, y) for x, y in zip(longer[:-1], first[:-1], strict=True)]
    leading, constant = [first[-1], second[-1]], [first[0], second[0]]
    while len(second) > 1:
        inverse = algebra.reciprocal(second[-1])
        rest = list(first)
        for shifted in (1, 0):  # the degree falls by one at every step of a generic sequence
            ratio = algebra.times(rest[-1], inverse)
            rest = [
                x - algebra.times(ratio, second[k - shifted]) if 0 <= k - shifted < len(second) else x
                for k, x in enumerate(rest[:-1])
            ]
        first, second = second, [-x for x in rest]
        leading.append(second[-1])
        constant.append(second[0])
    return leading, constant


def changes(signs: Any) -> Any:
    """Changes of sign down each column of an array (n + 1, m) of -1, 0, 1; zeros are passed over.  Shape (m,)."""
    if not np.all(signs):
        signs = signs.copy()
        for k in range(1, len(signs)):
            signs[k] = np.where(signs[k] == 0, signs[k - 1], signs[k])
        for k in range(len(signs) - 2, -1, -1):
            signs[k] = np.where(signs[k] == 0, signs[k + 1], signs[k])
    return np.sum(signs[1:] * signs[:-1] < 0, axis=0)


def real_roots(leading: Any, constant: Any) -> tuple[Any, Any]:
    """(negative, positive): how many different roots of Q lie there, by the signs of Sturm's ends, shape (n + 1, m).

    Of the leading coefficients and of Q's own constant term none may be 0.
    """
    degree = leading.shape[0] - 1
    parity = np.array([-1 if (degree - k) % 2 else 1 for k in range(degree + 1)]).reshape(-1, 1)
    below, here, above = (changes(x) for x in (leading * parity, constant, leading))
    return below - here, here - above
