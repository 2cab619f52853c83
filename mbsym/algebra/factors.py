"""Factors of polynomials: one door to the number library, whose refusals are failures like any other."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import reduce
from itertools import compress, count
from typing import Any

from flint import fmpq, fmpq_mpoly, fmpq_mpoly_ctx, fmpz_mpoly

from mbsym.algebra.failures import Limit, NoClosedForm
from mbsym.expressions.message import Message

Polynomial = Any  # of flint: python-flint carries no types


def irreducible_factors(p: Polynomial) -> tuple[Any, list[tuple[Polynomial, int]]]:
    """(unit, [(irreducible factor, exponent), ...]) with p = unit * product of factor^exponent; p is not zero.

    Raises NoClosedForm where the number library refuses.
    """
    try:
        unit, powers = _factored_among_its_own(p) if isinstance(p, fmpq_mpoly | fmpz_mpoly) else _factored(p)
        return unit, [(factor, int(exponent)) for factor, exponent in powers]
    except (ArithmeticError, ValueError, RuntimeError) as error:
        reason = Message("a polynomial cannot be factored: [[name]]: [[why]]", name=type(error).__name__, why=error)
        raise NoClosedForm(reason, limit=Limit.FACTORS) from error


def _factored_among_its_own(p: Polynomial) -> tuple[Any, list[tuple[Polynomial, int]]]:
    """In a context of the generators that occur in p, and back: a wide one makes the library some ten times slower.

    The generators keep their order, and so do terms and factors.
    """
    if len(p) > LONGEST_KNOWN:
        return _factored_anew(p)
    if len(_KNOWN) > MOST_KNOWN:
        _KNOWN.clear()
    alike, answers = _KNOWN.setdefault((p.context(), len(p)), ([], []))  # polynomials have no hash
    if p in alike:
        return answers[alike.index(p)]
    alike.append(p)
    answers.append(_factored_anew(p))
    del alike[:-MOST_ALIKE], answers[:-MOST_ALIKE]
    return answers[-1]


_Factors = tuple[Any, list[tuple[Polynomial, int]]]

#: Polynomials whose factors were asked for before, and these, by context and length: formulas are told in several media
#: and tried in several letters, so that four of five questions are old ones.  Long polynomials hardly ever are.
_KNOWN: dict[tuple[Any, int], tuple[list[Polynomial], list[_Factors]]] = {}
MOST_KNOWN, MOST_ALIKE, LONGEST_KNOWN = 500, 200, 200


def _factored_anew(p: Polynomial) -> _Factors:
    whole = p.context()
    used = [k for k, degree in enumerate(p.degrees()) if degree > 0]
    if not used:
        return _factored(p)
    own = p
    if len(used) < whole.nvars():
        names = whole.names()
        own = p.project_to_context(type(whole).get([names[k] for k in used], whole.ordering()))
    if _is_irreducible(own):
        unit = content(p)
        return unit, [(p / unit, 1)]
    unit, powers = _factored(own)
    if own is p:
        return unit, powers
    places = [whole.gen(k) for k in used]
    return unit, [(factor.compose(*places, ctx=whole), exponent) for factor, exponent in powers]


def _is_irreducible(p: Polynomial) -> bool:
    """Whether p = a x + b in one of its generators, with a and b without a common factor: sufficient, quickly seen.

    A factor of such a polynomial either does not hold x, and divides a and b, or its cofactor does.
    """
    for k, degree in enumerate(p.degrees()):
        if degree == 1:
            slope = p.derivative(k)
            return bool(slope.is_constant() or slope.gcd(p - slope * p.context().gen(k)).is_constant())
    return False


def content(p: Polynomial) -> Any:
    """The number by which p has to be divided to be primitive, with whole coefficients and a positive leading one."""
    coefficients = p.coeffs()
    divisor = abs(common_divisor(coefficients))
    return divisor if coefficients[0] > 0 else -divisor


def common_divisor(values: Sequence[Any]) -> Any:
    """The greatest one of numbers or polynomials, of which there is one at least."""
    return reduce(lambda x, y: x.gcd(y), values)


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


def rational_ratio(x: Any, y: Any) -> Any:
    """x / y where that is a rational number, else None."""
    if len(x) != len(y) or x.is_zero() or x.monomial(0) != y.monomial(0):
        return None
    ratio = x.coefficient(0) / y.coefficient(0)
    return ratio if x == y * ratio else None


def square_apart(x: Polynomial) -> tuple[Polynomial, Polynomial]:
    """(g, h) with x = g^2 h, h without square factors but numbers; g of either sign."""
    unit = x.context().constant(1)
    content, factors = x.factor_squarefree()
    top, bottom = abs(content.p).isqrt(), content.q.isqrt()
    whole = content >= 0 and top * top == content.p and bottom * bottom == content.q
    outside, inside = (unit * fmpq(top, bottom), unit) if whole else (unit, unit * content)
    for factor, exponent in factors:
        outside = outside * factor ** (int(exponent) // 2)
        inside = inside * factor ** (int(exponent) % 2)
    return outside, inside


def square_root_of(x: Polynomial) -> Polynomial | None:
    """The polynomial whose square x is, of either sign; None where there is none."""
    outside, inside = square_apart(x)
    return outside if inside == 1 else None


# Which generators stand in polynomials.


def occurring(polynomials: Iterable[Polynomial]) -> list[int]:
    """Positions of the generators that stand plainly in at least one of the polynomials, in order.

    What an adjoined generator is made of (the argument of a root or a function) is not looked into.
    """
    positions: set[int] = set()
    for x in polynomials:
        if x:  # else all degrees are -1
            positions.update(compress(count(), x.degrees()))
    return sorted(positions)
