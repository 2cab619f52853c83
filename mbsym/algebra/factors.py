"""Factors of polynomials: one door to the number library, whose refusals are failures like any other."""

from __future__ import annotations

from typing import Any

from flint import fmpq_mpoly, fmpq_mpoly_ctx, fmpz_mpoly

from mbsym.algebra.failures import Limit, NoClosedForm

Polynomial = Any  # of flint: python-flint carries no types


def irreducible_factors(p: Polynomial) -> tuple[Any, list[tuple[Polynomial, int]]]:
    """(unit, [(irreducible factor, exponent), ...]) with p = unit * product of factor^exponent; p is not zero.

    Raises NoClosedForm where the number library refuses.
    """
    try:
        unit, powers = _factored_among_its_own(p) if isinstance(p, fmpq_mpoly) else _factored(p)
        return unit, [(factor, int(exponent)) for factor, exponent in powers]
    except (ArithmeticError, ValueError, RuntimeError) as error:
        reason = f"a polynomial cannot be factored: {type(error).__name__}: {error}"
        raise NoClosedForm(reason, limit=Limit.FACTORS) from error


def _factored_among_its_own(p: Polynomial) -> tuple[Any, list[tuple[Polynomial, int]]]:
    """In a context of the generators that occur in p, and back: a wide one makes the library some ten times slower.

    The generators keep their order, and so do terms and factors.
    """
    whole = p.context()
    used = [k for k, degree in enumerate(p.degrees()) if degree > 0]
    if not used or len(used) == whole.nvars():
        return _factored(p)
    names = whole.names()
    unit, powers = _factored(p.project_to_context(fmpq_mpoly_ctx.get([names[k] for k in used], whole.ordering())))
    own = [whole.gen(k) for k in used]
    return unit, [(factor.compose(*own, ctx=whole), exponent) for factor, exponent in powers]


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
