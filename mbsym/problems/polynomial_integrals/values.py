"""At which values of one parameter there are more integrals: where the rank drops, each value looked at exactly.

Along the line of a parameter t, with numbers for the others, every value (also irrational) with a further integral is a
zero of the minors' common divisor G.  Modulo the prime, G divides g.  If each zero of g is a rational number at which
the kernel is larger by as much as the zero is multiple, G has no other zero, unless its polynomial modulo the prime is
a power of what is known, or a number: then it has coefficients of the size of the prime.  So the list is proved to be
complete but for algebraic numbers whose polynomials need coefficients beyond 10^9.  Otherwise it is for rational
numbers of numerators and denominators up to 10^9: these are told apart modulo the prime.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import isqrt
from typing import Any

from flint import fmpq, fmpq_poly

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.problems.polynomial_integrals.drops import Line, dropped, others, rational, roots
from mbsym.problems.polynomial_integrals.excess import Excess, larger
from mbsym.problems.polynomial_integrals.levels import levels, on_level
from mbsym.problems.polynomial_integrals.modular import PRIMES, ModularField
from mbsym.problems.polynomial_integrals.result import Along, OnLevel, PolynomialIntegrals, Special
from mbsym.problems.polynomial_integrals.search import polynomial_integrals

#: Values with larger numerators or denominators are not told apart modulo the prime.
LARGEST = isqrt(PRIMES[0] // 2)


def along(usual: PolynomialIntegrals, low: Fraction, high: Fraction) -> Along:
    """The values in  low <= t <= high  of the field's only parameter at which there are more integrals than ``usual``.

    Raises ValueError where the field has not one parameter, NoClosedForm where it has no weights or takes too much.
    """
    field = usual.field
    if len(field.parameters) != 1:
        raise ValueError(f"one parameter is wanted, not {len(field.parameters)}")
    if not usual.grading.homogeneous or (field.relations and not usual.grading.free):
        raise NoClosedForm("special values are looked for where equations are quasi-homogeneous; these are not")
    (name,) = field.parameters
    prime = PRIMES[0]
    line = Line(field, prime, {name: 0}, {name: 1})
    excess = Excess(usual)
    candidates: dict[Fraction, None] = {}
    irrational: list[Any] = []
    whole = True
    for block in excess.blocks:
        g = dropped(line, excess.build(block), excess.extra(block))
        for root, power in roots(g):
            there = ModularField(field, prime, {name: root})
            if not there.terms(field.denominator):
                continue
            value = rational(root, prime)
            if value is None:
                whole = False
                continue
            candidates[value] = None
            whole = whole and excess.dimension(there, block) - excess.dimensions[block] == power
        for factor in others(g):
            whole = False
            lifted = _lifted(factor)
            if lifted is not None and lifted not in irrational and _meets(lifted, low, high):
                irrational.append(lifted)
    found = []
    for value in sorted(one for one in candidates if low <= one <= high):
        there = ModularField(field, prime, {name: value.numerator * pow(value.denominator, -1, prime) % prime})
        if larger(excess.signature(there), excess.nothing):
            special = at_value(usual, name, value)
            if special is not None:
                found.append(special)
    return Along(name, low, high, tuple(found), tuple(irrational), whole)


def at_value(usual: PolynomialIntegrals, name: str, value: Fraction) -> Special | None:
    """What there is at a value beyond what there is in general; None where that is nothing."""
    field = usual.field.at({name: fmpq(value.numerator, value.denominator)})
    image = field.context.constant(fmpq(value.numerator, value.denominator))
    images = [image, *field.context.gens()]
    known = [(str(k), one.polynomial.compose(*images, ctx=field.context)) for k, one in enumerate(usual.generators)]
    return special_of(usual, field, known, value)


def special_of(
    usual: PolynomialIntegrals, field: PolynomialField, known: Sequence[tuple[str, Any]], value: Fraction | None
) -> Special | None:
    """The new integrals of a field that is a special case, ``known`` those of the usual one by their numbers."""
    here = polynomial_integrals(field, usual.grading, usual.degree, known)
    new = tuple((one.weight, one.polynomial) for one in here.generators if not one.name)
    named = {one.name: one for one in here.generators}
    on: list[OnLevel] = []
    for one in levels(usual):
        k = usual.generators.index(one)
        if str(k) in named:
            there = on_level(here, named[str(k)])
            if len(there.integrals) > len(on_level(usual, one).integrals):
                on.append(OnLevel(one, there.integrals, there.counts))
    return Special(value, field, new, tuple(on), here.complete) if new or on else None


def _lifted(factor: Any) -> fmpq_poly | None:
    """The polynomial over QQ with small coefficients that it is the image of, leading coefficient 1."""
    prime = factor.modulus()
    top = int(factor[factor.degree()])
    inverse = pow(top, -1, prime)
    numbers = [rational(int(factor[k]) * inverse % prime, prime) for k in range(factor.degree() + 1)]
    if any(x is None or max(abs(x.numerator), x.denominator) > 10**6 for x in numbers):
        return None
    return fmpq_poly([fmpq(x.numerator, x.denominator) for x in numbers if x is not None])


def _meets(p: fmpq_poly, low: Fraction, high: Fraction) -> bool:
    """Whether a polynomial may have a zero in the interval: signs at the ends and at the enclosed real zeros."""
    found: Any = p.complex_roots()  # pairs of a zero and its multiplicity
    for root, _ in found:
        if root.imag.contains(0):
            real = root.real
            if not (real < low.numerator / low.denominator or real > high.numerator / high.denominator):
                return True
    return False
