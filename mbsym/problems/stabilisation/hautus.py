"""Hautus' test in symbols: where  [ P(lambda), B ],  P = lambda^2 M + lambda C + S,  loses rank.

With W spanning the vectors w.B = 0 it is lost at lambda exactly if W^T P(lambda) has not full row rank there: its
maximal minors g_1, g_2, ... have a common root.  So

* it is lost for all parameters exactly if the g_k have a common factor in lambda;
* else at the parameters at which they have a common root: Res(g_1, sum t^(k-2) g_k) = 0 for all t, as the resultant is
  a power of the leading coefficient of g_1 times prod over its roots of sum t^(k-2) g_k(root).

W has polynomial entries, a minor beta of B being divided out of none of them: all is said where beta does not vanish.

Sources: M. L. J. Hautus, Indag. Math. 31 (1969) 443-448; A. J. Laub & W. F. Arnold, IEEE Trans. AC 29 (1984) 163-165
(second-order form).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from math import comb, prod
from typing import Any

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.characteristic import _Variable, determinant, resultant
from mbsym.algebra.factors import common_divisor, irreducible_factors
from mbsym.algebra.failures import TooLargeError
from mbsym.algebra.ring import Polynomial
from mbsym.algebra.signs import Signs
from mbsym.problems.stabilisation.gyroscopic import Cleared, Rows
from mbsym.problems.stabilisation.result import Locus, Rank

#: So many maximal minors are formed, of so many rows at most.
MOST_MINORS, MOST_ROWS = 60, 6
#: So many blocks of B are looked at for one that is not singular.
MOST_BLOCKS = 5_000
#: Terms of a minor whose roots are still compared with those of others.
MOST_TERMS = 3_000


def rank_of(whole: Cleared, mass: Rows, rates: Rows, places: Rows, inputs: Rows, rest: bool = True) -> Rank:
    """The test for matrices over ``whole.ring``; without ``rest`` roots lambda = 0 do not count.

    Raises TooLargeError.
    """
    size = len(mass)
    beta, annihilating = annihilator(inputs, whole.known, size)
    provided = tuple(whole.formula(x) for x in _open_factors(beta, whole.known))
    if not annihilating:
        return Rank(True, Certainty.PROVED, (), Locus((), (), provided))
    variable = _Variable(whole.ring.context)
    rows = [
        [variable.assemble([sum((w[k] * part[k][j] for k in range(size)), whole.ring.zero) for part in parts])
         for j in range(size)]
        for w in annihilating
        for parts in [(places, rates, mass)]
    ]  # fmt: skip
    minors = _maximal_minors(rows, variable)
    if not minors:
        return Rank(False, Certainty.PROVED, (), None, "the inputs do not even enter")
    common = common_divisor(minors)
    in_lambda, free = _split(common, variable)
    if not rest:
        in_lambda = [x for x in in_lambda if x != variable.large.gen(variable.index)]
    if in_lambda:
        factors = tuple(
            tuple(whole.formula(c) for c in variable.coefficients(x, variable.degree(x))) for x in in_lambda
        )
        return Rank(False, Certainty.PROVED, factors, Locus((), (), provided))
    quotients = [divmod(maximal_minor, common)[0] for maximal_minor in minors]
    if not rest:
        quotients = [_without_zero_roots(x, variable) for x in quotients]
    spare = [x for x in free if whole.known.never_zero(x) is False and not _divides(x, beta)]
    locus = _locus(whole, quotients, variable, spare, provided)
    return Rank(True, Certainty.PROVED, (), locus, "" if locus is not None else "the formulas outgrew their budget")


def annihilator(inputs: Rows, known: Signs, size: int) -> tuple[Polynomial, Rows]:
    """(beta, W): beta a minor of B of full rank r, W the n - r rows  beta e_k - (combination of the pivot rows)."""
    zero = known.context.constant(0)
    unit = [[zero + (1 if i == j else 0) for j in range(size)] for i in range(size)]
    width = len(inputs[0]) if inputs and inputs[0] else 0
    # Minors with a row or a column of zeros vanish: of thirty coordinates with one damper a single one is left.
    lines = [i for i in range(size) if width and any(x != 0 for x in inputs[i])]
    across = [j for j in range(width) if any(inputs[i][j] != 0 for i in lines)]
    for rank in range(min(len(lines), len(across)), 0, -1):
        if comb(len(lines), rank) * comb(len(across), rank) > MOST_BLOCKS:
            raise TooLargeError("too many minors")
        best: tuple[int, Polynomial, tuple[int, ...], tuple[int, ...]] | None = None
        for at in combinations(lines, rank):
            for columns in combinations(across, rank):
                minor = determinant([[inputs[i][j] for j in columns] for i in at])
                if minor == 0:
                    continue
                weight = (0 if known.never_zero(minor) else 1_000) + len(minor)
                if best is None or weight < best[0]:
                    best = weight, minor, at, columns
        if best is None:
            continue
        _, minor, at, columns = best
        block = [[inputs[i][j] for j in columns] for i in at]
        annihilating = []
        for k in (k for k in range(size) if k not in at):
            row = [x * minor for x in unit[k]]
            for place, i in enumerate(at):  # Cramer: the combination of pivot rows that gives row k of B
                swapped = [list(line) for line in block]
                swapped[place] = [inputs[k][j] for j in columns]
                coefficient = determinant(swapped)
                row = [x - coefficient * y for x, y in zip(row, unit[i], strict=True)]
            annihilating.append(row)
        return minor, annihilating
    return zero + 1, unit


def _maximal_minors(rows: list[list[Any]], variable: _Variable) -> list[Any]:
    height, width = len(rows), len(rows[0])
    if height > MOST_ROWS:
        raise TooLargeError("too many coordinates without an input of their own")
    choices = list(combinations(range(width), height))
    if len(choices) > MOST_MINORS:
        raise TooLargeError("too many minors")
    maximal_minors = []
    for columns in choices:
        minor = determinant([[row[j] for j in columns] for row in rows])
        if minor == 0:
            continue
        if len(minor) > MOST_TERMS:
            raise TooLargeError("minors with too many terms")
        maximal_minors.append(minor)
    return maximal_minors


def _split(p: Any, variable: _Variable) -> tuple[list[Any], list[Polynomial]]:
    """The irreducible factors that hold lambda, and those that do not (in parameters)."""
    held, free = [], []
    for factor, _ in irreducible_factors(p)[1]:
        if variable.degree(factor):
            held.append(factor)
        else:
            free.append(variable.coefficients(factor, 0)[0])
    return held, free


def _without_zero_roots(p: Any, variable: _Variable) -> Any:
    gen = variable.large.gen(variable.index)
    while p != 0:
        quotient, left = divmod(p, gen)
        if left != 0:
            break
        p = quotient
    return p


def _divides(x: Polynomial, y: Polynomial) -> bool:
    return y != 0 and bool(divmod(y, x)[1] == 0)


def _open_factors(x: Polynomial, known: Signs) -> list[Polynomial]:
    """The irreducible factors that are not known to keep away from zero."""
    if x == 0 or x.is_constant():
        return []
    return [factor for factor, _ in irreducible_factors(x)[1] if not known.never_zero(factor)]


def _locus(
    whole: Cleared, minors: Sequence[Any], variable: _Variable, spare: Sequence[Polynomial], provided: tuple[Any, ...]
) -> Locus | None:
    """Where minors without a common factor have a common root all the same; None where that is too large to write."""
    lost = {str(x): x for x in spare}
    polynomials = [variable.coefficients(x, variable.degree(x)) for x in minors]
    free = [p[0] for p in polynomials if len(p) == 1]
    if any(whole.known.never_zero(x) for x in free):
        return Locus(tuple(whole.formula(x) for x in lost.values()), (), provided)
    base = min(polynomials, key=lambda p: (not whole.known.never_zero(p[-1]), len(p), sum(map(len, p))))
    others = [p for p in polynomials if p is not base]
    lead = tuple(whole.formula(x) for x in _open_factors(base[-1], whole.known))
    try:
        values = _in_t(base, others, whole)
    except TooLargeError:
        return None
    common = common_divisor(values)
    for factor in _open_factors(common, whole.known):
        lost.setdefault(str(factor), factor)
    # What vanishes together, beside what is lost anyhow; numbers, powers and positive factors say nothing of where.
    left = [divmod(x, common)[0] for x in values]
    open_ = [
        [open_factor for open_factor in _open_factors(x, whole.known) if str(open_factor) not in lost] for x in left
    ]
    simple = [x if x == 0 else prod(factors, start=x * 0 + 1) for x, factors in zip(left, open_, strict=True)]
    together = () if any(x == 1 for x in simple) else tuple({str(x): x for x in simple}.values())
    return Locus(
        tuple(whole.formula(x) for x in lost.values()),
        tuple(whole.formula(x) for x in together),
        tuple({str(x): x for x in (*provided, *lead)}.values()),
    )


def _in_t(base: Sequence[Polynomial], others: Sequence[Sequence[Polynomial]], whole: Cleared) -> list[Polynomial]:
    """The coefficients in t of Res(base, sum t^k others_k) that are not zero."""
    if not others:  # one minor: its roots are those at which rank is lost, and it has none left
        return [base[-1] * 0 + 1] if len(base) == 1 else [base[-1] * 0]
    if len(others) == 1:
        return [resultant(base, others[0])]
    t = _Variable(whole.ring.context)
    degree = max(map(len, others))
    mixed = [t.assemble([other[k] if k < len(other) else other[0] * 0 for other in others]) for k in range(degree)]
    lifted = [t.assemble([c]) for c in base]
    value = resultant(lifted, mixed)
    return [c for c in t.coefficients(value, t.degree(value)) if c != 0] or [base[-1] * 0]
