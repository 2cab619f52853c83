"""From a kernel modulo a prime to polynomials over QQ(parameters): the few monomials that occur, solved exactly.

The image modulo a prime tells which monomials an integral is made of.  On these alone  sum c_a d(x^a)/dt = 0  is a
small linear system over QQ[parameters]; it is solved by elimination with rows kept primitive.  What comes out is put
into the field once more: an identity, whatever the prime was.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mbsym.algebra.failures import Limit, NoClosedForm
from mbsym.algebra.matrices import Operators, PrimitiveRows
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.algebra.terms import apart
from mbsym.expressions.message import Message
from mbsym.problems.polynomial_integrals.modular import SMALLER, Exponents

#: Monomials of an integral that is lifted, and terms of one entry while that is done.
MOST_SUPPORT, MOST_ENTRY = 120, 4000


def lifted(
    field: PolynomialField,
    support: Sequence[Exponents],
    modulo: bool,
    leading: Exponents,
    level: Any = None,
    cofactor: Sequence[Exponents] = (),
    factor: Any = None,
) -> Any | None:
    """The polynomial on these monomials with  df/dt = 0, primitive over ZZ[parameters], if it is one up to a factor.

    ``leading``: a monomial that occurs in it.  With a ``level`` V it is  df/dt = K V, K on the monomials ``cofactor``.
    With a ``factor`` K, a polynomial, it is  df/dt = K f.
    None where there is none (or more than one that has ``leading``).  Raises NoClosedForm where it outgrows its bounds.
    """
    if len(support) > MOST_SUPPORT:
        message = Message(
            "an integral has [[count]] monomials, more than [[most]]",
            count=len(support),
            most=MOST_SUPPORT,
        )
        raise NoClosedForm(message, limit=Limit.TERMS, remedy=SMALLER)
    order = [one for one in support if one != leading]
    columns = [*order, leading]
    images = [field.derivative(monomial(field, column)) for column in columns]
    if factor is not None:
        images = [image - factor * monomial(field, column) for image, column in zip(images, columns, strict=True)]
    if modulo:
        images = [field.reduced(image) for image in images]
    multiples = [monomial(field, one) * level for one in cofactor]
    equations = _equations(field, [*images[:-1], *multiples, images[-1]])
    solved = _eliminated(field, equations, len(order) + len(multiples))
    if solved is None:
        return None
    tops, bottoms = solved
    common = field.context.constant(1)
    for bottom in bottoms:
        common = common * (bottom / bottom.gcd(common))
    total = common * monomial(field, leading)
    for one, top, bottom in zip(order, tops, bottoms, strict=False):  # those of the cofactor follow
        total -= top * (common / bottom) * monomial(field, one)
    found = primitive(field, total)
    rate = field.derivative(found)
    if factor is not None:
        return found if rate == factor * found else None
    if level is not None:  # the level is primitive over the parameters: by Gauss' lemma it divides there, too
        return found if divmod(rate, level)[1] == 0 else None
    return found if (field.reduced(rate) if modulo else rate) == 0 else None


def monomial(field: PolynomialField, exponents: Sequence[int]) -> Any:
    """x^a in the field's context."""
    return field.context.from_dict({(*(0,) * len(field.parameters), *exponents): 1})


def coefficients(field: PolynomialField, f: Any) -> dict[Exponents, Any]:
    """Polynomials in the parameters, by the monomials in the variables that they belong to."""
    return apart(f, field.places)


def primitive(field: PolynomialField, f: Any) -> Any:
    """Without the factor in the parameters that all coefficients share; integers without one; the leading one > 0."""
    parts = list(coefficients(field, f).values())
    if not parts:
        return f
    common = field.context.constant(0)
    for part in parts:
        common = common.gcd(part)
        if common.is_constant():
            break
    found = f if common.is_constant() else f / common
    numbers = list(found.to_dict().values())
    bottom = numbers[0].q
    for c in numbers[1:]:
        bottom = bottom * (c.q // bottom.gcd(c.q))
    top = numbers[0].p * (bottom // numbers[0].q)
    for c in numbers[1:]:
        top = top.gcd(c.p * (bottom // c.q))
    scaled = found * bottom / top
    return -scaled if scaled.leading_coefficient() < 0 else scaled


def _equations(field: PolynomialField, images: Sequence[Any]) -> list[dict[int, Any]]:
    """sum_k c_k images_k = 0, coefficient by coefficient; short ones first."""
    rows: dict[Exponents, dict[int, Any]] = {}
    for k, image in enumerate(images):
        for key, c in coefficients(field, image).items():
            rows.setdefault(key, {})[k] = c
    return sorted(rows.values(), key=lambda row: (len(row), sum(len(x) for x in row.values())))


def _eliminated(
    field: PolynomialField, rows: list[dict[int, Any]], unknowns: int
) -> tuple[list[Any], list[Any]] | None:
    """c_k = tops_k / bottoms_k  with the last unknown -1; None where they are not determined, or contradict."""
    zero, one = field.context.constant(0), field.context.constant(1)
    held = PrimitiveRows(Operators(zero, one), MOST_ENTRY, "the coefficients of an integral are too long", SMALLER)
    for equation in rows:
        row = held.reduced(equation)
        left = [k for k in row if k < unknowns]
        if left:
            held.add(row, min(left, key=lambda j: (len(row[j]), j)))
        elif row:
            return None
    pivots = held.pivots
    if len(pivots) < unknowns:
        return None
    tops, bottoms = [], []
    for k in range(unknowns):
        top, bottom = pivots[k].get(unknowns, zero), pivots[k][k]
        common = top.gcd(bottom) if top != 0 else bottom
        tops.append(top / common if top != 0 else zero)
        bottoms.append(bottom / common if top != 0 else one)
    return tops, bottoms
