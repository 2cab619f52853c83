"""The degree of instability of K, region by region, and energies as Lyapunov functions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice, permutations, product

from mbsym.algebra.characteristic import leading_minors
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


def regions(whole: Cleared, stiffness: Rows) -> tuple[Region, ...]:
    """Jacobi's rule: as many negative eigenvalues as changes of sign in 1, Delta_1, ..., Delta_n, none of them zero.

    Rows of zeros are left out.  One region for every choice of signs of the irreducible factors of the minors that is
    not known to be impossible, and where no square in det K vanishes; none where in every order of the coordinates a
    minor vanishes identically, or where there is too much to tell.
    """
    minors = _minors(stiffness)
    if minors is None:
        return ()
    powers = [irreducible_factors(minor) for minor in minors]
    factors: dict[str, Polynomial] = {}
    for _, held in powers:
        for factor, exponent in held:
            if exponent % 2 and whole.known.sign(factor) not in ("positive", "negative"):
                factors.setdefault(str(factor), factor)
    if len(factors) > MOST_FACTORS or any(len(x) > MOST_TERMS for x in factors.values()):
        return ()
    # By continuity the degree is the same wherever det K keeps away from zero: borders of other minors need no word.
    squares = (
        [
            (whole.formula(factor), "!=")
            for factor, exponent in powers[-1][1]
            if exponent % 2 == 0 and str(factor) not in factors and not whole.known.never_zero(factor)
        ]
        if powers
        else []
    )
    found = []
    for choice in product((1, -1), repeat=len(factors)):
        signs = dict(zip(factors, choice, strict=True))
        if _excluded(whole.known, [factors[name] * sign for name, sign in signs.items()]):
            continue
        degree = _changes([_sign(unit, held, signs, whole.known) for unit, held in powers])
        told = tuple((whole.formula(factors[name]), ">" if sign > 0 else "<") for name, sign in signs.items())
        found.append(Region((*told, *squares), degree))
    return tuple(found)


def free_in(stiffness: Rows) -> int:
    """How many rows are zero."""
    return sum(all(x == 0 for x in row) for row in stiffness)


def _minors(stiffness: Rows) -> Sequence[Polynomial] | None:
    """Leading minors of the other rows and columns, in the first order of these in which none of them vanishes."""
    held = [i for i, row in enumerate(stiffness) if any(x != 0 for x in row)]
    for order in islice(permutations(held), MOST_ORDERS):
        try:
            minors = leading_minors([[stiffness[i][j] for j in order] for i in order]) if order else ()
        except TooLargeError:
            return None
        if all(minor != 0 for minor in minors):
            return minors
    return None


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
    given: list[Rows] = [[] if one is None else [list(row) for row in one.polynomials] for one in matrices]
    factor = ring.one
    for x in (x for rows in given for row in rows for x in row):
        for bottom, exponent in ring.fraction(ring.reduce(ring.times(x, factor)))[1]:
            factor = ring.reduce(ring.times(factor, ring.power(bottom, exponent)))
    word = signs.sign(factor)
    further = ring.one if word == "positive" else -ring.one if word == "negative" else factor  # times a square
    whole = [
        [[further * ring.fraction(ring.reduce(ring.times(x, factor)))[0] for x in row] for row in rows]
        for rows in given
    ]
    small, known = in_parameters(ring, whole, signs)
    if not isinstance(small, ParameterRing):
        raise NoClosedForm("the matrices hold roots or functions of parameters")
    return Cleared(tuple([[small.project(x) for x in row] for row in rows] for rows in whole), small, known)
