"""A linear form where a polynomial p in the parameters vanishes: one parameter is solved for, the rest judged as ever.

Let p = c1 x + c0 be irreducible, x a parameter and c1 != 0 whatever the others are.  On p = 0 x = -c0/c1, and the
matrices times an even power of c1, positive, are polynomials in the other parameters: a linear form like any other, of
which the signs are known that were known of x.  Where p has no such parameter nothing is claimed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from mbsym.algebra.characteristic import Matrix, Polynomial
from mbsym.algebra.factors import irreducible_factors, occurring
from mbsym.algebra.failures import Failure
from mbsym.algebra.signs import ContradictionError, Signs
from mbsym.algebra.terms import with_quotient
from mbsym.problems.stability.linear_form import LinearSystem
from mbsym.problems.stability.verdict import Verdict, depends, weakest

#: (polynomial, relation to 0)
Fact = tuple[Polynomial, str]
Judge = Callable[[LinearSystem, Signs], Verdict]

#: Matrices with more terms are not put in.
MOST_TERMS = 400

#: What a declared sign says of x.
_OF_WORD = {"positive": (1, ">"), "nonnegative": (1, ">="), "negative": (-1, ">"), "nonpositive": (-1, ">=")}


def where_zero(
    system: LinearSystem, signs: Signs, p: Polynomial, judge: Judge, further: Sequence[Fact] = ()
) -> Verdict | None:
    """What is true of the form wherever p vanishes and ``further`` is so; None where nothing is known.

    Nothing is known, either, where there are no such parameters.  A factor of p that cannot vanish is left out.
    """
    entries = [x for matrix in system.matrices for row in matrix for x in row]
    if signs.normal is not None or p == 0 or p.is_constant() or sum(map(len, entries)) > MOST_TERMS:
        return None
    verdicts: list[Verdict] = []
    try:
        for factor, _ in irreducible_factors(p)[1]:
            if not signs.never_zero(factor):
                there = _where_irreducible(system, signs, factor, judge, further)
                if there is None:
                    return None
                verdicts.append(there)
    except Failure:
        return None
    if not verdicts:
        return None
    alike = len({verdict.word for verdict in verdicts}) == 1 or all(verdict.stable for verdict in verdicts)
    return weakest(verdicts) if alike else depends()


def _where_irreducible(
    system: LinearSystem, signs: Signs, p: Polynomial, judge: Judge, further: Sequence[Fact]
) -> Verdict | None:
    degrees = p.degrees()
    for k in occurring([p]):
        slope = p.derivative(k)
        if degrees[k] != 1 or k in signs.numbers or not signs.never_zero(slope):
            continue
        try:
            return judge(*_solved(system, signs, k, slope, p - slope * p.context().gen(k), further))
        except ContradictionError:
            return None
    return None


def _solved(
    system: LinearSystem, signs: Signs, k: int, slope: Polynomial, rest: Polynomial, further: Sequence[Fact]
) -> tuple[LinearSystem, Signs]:
    """The form and the signs with x = -rest/slope, x the generator k."""

    def put(x: Polynomial, power: int) -> Polynomial:
        return _put(x, k, slope, rest, power)

    def even(*of: Polynomial) -> int:
        degree = max(int(x.degrees()[k]) if x != 0 else 0 for x in of)
        return degree + degree % 2

    power = even(*(x for matrix in system.matrices for row in matrix for x in row))
    m, d, g, stiff, n = (tuple(tuple(put(x, power) for x in row) for row in matrix) for matrix in system.matrices)
    turned = tuple(put(x, even(*system.turned)) for x in system.turned)
    shifts: Matrix = tuple(tuple(put(x, even(*row)) for x in row) for row in system.shifts)
    there = replace(system, M=m, D=d, G=g, K=stiff, N=n, turned=turned, shifts=shifts)
    held = [(put(x, even(x)), relation) for x, relation in (*signs.assumptions, *further)]
    if signs.words[k] in _OF_WORD:
        sign, relation = _OF_WORD[signs.words[k]]
        held.append((-sign * rest * slope, relation))
    elif signs.words[k] == "nonzero":
        held.append((rest, "!="))
    return there, Signs(signs.context, signs.words, tuple(held), signs.normal, signs.numbers)


def _put(x: Polynomial, k: int, slope: Polynomial, rest: Polynomial, power: int) -> Polynomial:
    """x times slope^power, with -rest/slope in place of the generator k."""
    return with_quotient(x, k, -rest, slope, power)
