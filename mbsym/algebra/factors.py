"""Factors of polynomials: one door to the number library, whose refusals are failures like any other."""

from __future__ import annotations

from typing import Any

from flint import fmpq_mpoly_ctx, fmpz_mpoly

from mbsym.algebra.failures import Limit, NoClosedForm

Polynomial = Any  # of flint: python-flint carries no types


def irreducible_factors(p: Polynomial) -> tuple[Any, list[tuple[Polynomial, int]]]:
    """(unit, [(irreducible factor, exponent), ...]) with p = unit * product of factor^exponent; p is not zero.

    Raises NoClosedForm where the number library refuses.
    """
    try:
        unit, powers = _factored(p)
        return unit, [(factor, int(exponent)) for factor, exponent in powers]
    except (ArithmeticError, ValueError, RuntimeError) as error:
        reason = f"a polynomial cannot be factored: {type(error).__name__}: {error}"
        raise NoClosedForm(reason, limit=Limit.FACTORS) from error


def _factored(p: Polynomial) -> tuple[Any, list[tuple[Polynomial, int]]]:
    try:
        unit, powers = p.factor()
        return unit, powers
    except OverflowError:
        # python-flint 0.9 puts factors over the integers in order by machine integers.  Over the rationals they come
        # out the same: primitive with integer coefficients, as Gauss's lemma lets them.
        if not isinstance(p, fmpz_mpoly):
            raise
    whole = p.context()
    unit, powers = fmpq_mpoly_ctx.get(whole.names(), whole.ordering()).from_dict(p.to_dict()).factor()
    back = [({monomial: c.p for monomial, c in factor.to_dict().items()}, exponent) for factor, exponent in powers]
    return unit.p, [(whole.from_dict(terms), exponent) for terms, exponent in back]
