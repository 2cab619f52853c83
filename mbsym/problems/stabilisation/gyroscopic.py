"""The degree of instability of K, region by region, and energies as Lyapunov functions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement, islice, permutations, product

from mbsym.algebra.characteristic import determinant, leading_minors
from mbsym.algebra.factors import irreducible_factors
from mbsym.algebra.failures import NoClosedForm, TooLargeError
from mbsym.algebra.ring import ParameterRing, Polynomial, Ring
from mbsym.algebra.signs import ContradictionError, Signs
from mbsym.formulas.formula import Formula, Matrix
from mbsym.problems.stabilisation.result import Region
from mbsym.problems.stability.problem import in_parameters

#: Regions are told for so many factors whose signs are open; longer factors are not told.
MOST_FACTORS, MOST_TERMS = 3, 60
#: So many orders of the coordinates are tried.
MOST_ORDERS = 24


def regions(whole: Cleared, stiffness: Rows) -> tuple[tuple[Region, ...], int]:
    """Where K has how many negative eigenvalues, and how many of its eigenvalues vanish for all parameters.

    Jacobi's rule: as many negative ones as changes of sign in 1, Delta_1, ..., Delta_r, none of them zero, r the rank
    of K.  One region for every choice of signs of the irreducible factors of Delta_r that is not known to be
    impossible, and where no square in it vanishes; of other minors only where they decide.  None where there is too
    much to tell.
    """
    minors = _minors(stiffness)
    if minors is None:
        return (), 0
    powers = [irreducible_factors(minor) for minor in minors]
    factors: dict[str, Polynomial] = {}
    for _, held in reversed(powers):
        for factor, exponent in held:
            if exponent % 2 and whole.known.sign(factor) not in ("positive", "negative"):
                factors.setdefault(str(factor), factor)
    if len(factors) > MOST_FACTORS or any(len(x) > MOST_TERMS for x in factors.values()):
        return (), 0
    # By continuity the degree is the same wherever Delta_r keeps away from zero: borders of other minors need no word.
    last = powers[-1][1] if powers else ()
    squares = [x for x, exponent in last if exponent % 2 == 0 and not whole.known.never_zero(x)]
    deciding = sum(str(factor) in factors for factor, exponent in last if exponent % 2)
    degrees: dict[tuple[int, ...], dict[tuple[int, ...], int]] = {}
    for choice in product((1, -1), repeat=len(factors)):
        signs = dict(zip(factors, choice, strict=True))
        if not _excluded(whole.known, [factors[name] * sign for name, sign in signs.items()]):
            degree = _changes([_sign(unit, held, signs, whole.known) for unit, held in powers])
            degrees.setdefault(choice[:deciding], {})[choice] = degree
    merged = []
    for outer, inner in degrees.items():
        for choice, degree in inner.items() if len(set(inner.values())) > 1 else [(outer, next(iter(inner.values())))]:
            signed = list(zip(factors.values(), choice, strict=False))
            nonzero = [(x, "!=") for x in squares if all(x != y for y, _ in signed)]
            where = [(whole.formula(x), how) for x, how in (*((x, ">" if s > 0 else "<") for x, s in signed), *nonzero)]
            merged.append(Region(tuple(where), degree))
    return tuple(merged), len(stiffness) - len(minors)


def _minors(stiffness: Rows) -> Sequence[Polynomial] | None:
    """Leading minors up to the rank, none of them zero, in the first order of the coordinates, or else the first
    combination of them, that has such."""
    held = [i for i, row in enumerate(stiffness) if any(x != 0 for x in row)]
    if not held:
        return ()
    n = len(held)
    orders = ([[int(i == j) for j in order] for i in range(n)] for order in islice(permutations(range(n)), MOST_ORDERS))
    for turn in (*orders, *([[(j + c) ** (i + 1) for j in range(n)] for i in range(n)] for c in (1, 2))):
        half = [[sum(w * stiffness[held[i]][j] for i, w in enumerate(row) if w) for j in held] for row in turn]
        turned = [[sum(w * row[j] for j, w in enumerate(other) if w) for other in turn] for row in half]
        try:
            minors = leading_minors(turned)
            rank = next((k for k, minor in enumerate(minors) if minor == 0), n)
            if rank and (rank == n or _bordered_vanish(turned, rank)):
                return minors[:rank]
        except TooLargeError:
            return None
    return None


def _bordered_vanish(matrix: Rows, rank: int) -> bool:
    """Whether the symmetric matrix has this rank, its leading minor of this order being no zero."""
    pairs = combinations_with_replacement(range(rank, len(matrix)), 2)
    blocks = ([[*row[:rank], row[j]] for row in (*matrix[:rank], matrix[i])] for i, j in pairs)
    return all(determinant(block) == 0 for block in blocks)


def _sign(unit: object, held: Sequence[tuple[Polynomial, int]], signs: dict[str, int], known: Signs) -> int:
    value = 1 if unit > 0 else -1  # type: ignore[operator]
    for factor, exponent in held:
        if exponent % 2:
            value *= signs[str(factor)] if str(factor) in signs else (1 if known.sign(factor) == "positive" else -1)
    return value


def _changes(signs: Sequence[int]) -> int:
    return sum(a != b for a, b in zip((1, *signs), signs, strict=False))


def _excluded(known: Signs, positive: Sequence[Polynomial]) -> bool:
    """Whether it is known that not all of these are positive."""
    for k, x in enumerate(positive):
        others = [(y, ">") for j, y in enumerate(positive) if j != k]
        try:
            if known.assuming(others).sign(x) in ("negative", "nonpositive", "zero"):
                return True
        except ContradictionError:  # the others alone leave no parameters
            return True
    return False


# Matrices as polynomials in parameters alone: multiplied by something positive that clears their denominators.


Rows = Sequence[Sequence[Polynomial]]


@dataclass(frozen=True)
class Cleared:
    """``matrices`` times one factor, positive wherever the formulas make sense, over ``ring``; ``known`` there."""

    matrices: tuple[Rows, ...]
    ring: ParameterRing
    known: Signs

    def formula(self, x: Polynomial) -> Formula:
        return Formula(self.ring.whole, self.ring.lift(x))


def cleared(ring: Ring, matrices: Sequence[Matrix | None], signs: Signs) -> Cleared:
    """The matrices (None: without columns) over parameters.  Raises NoClosedForm where roots or functions occur."""
    polynomials: list[Rows] = [
        [] if matrix is None else [list(row) for row in matrix.polynomials] for matrix in matrices
    ]
    factor = ring.one
    for x in (x for rows in polynomials for row in rows for x in row):
        for bottom, exponent in ring.fraction(ring.reduce(ring.times(x, factor)))[1]:
            factor = ring.reduce(ring.times(factor, ring.power(bottom, exponent)))
    word = signs.sign(factor)
    further = ring.one if word == "positive" else -ring.one if word == "negative" else factor  # times a square
    whole = [
        [[further * ring.fraction(ring.reduce(ring.times(x, factor)))[0] for x in row] for row in rows]
        for rows in polynomials
    ]
    small, known = in_parameters(ring, whole, signs)
    if not isinstance(small, ParameterRing):
        raise NoClosedForm("the matrices hold roots or functions of parameters")
    return Cleared(tuple([[small.project(x) for x in row] for row in rows] for rows in whole), small, known)
