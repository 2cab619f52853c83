"""Special parameters, Darboux polynomials of fields that are not quasi-homogeneous: gyrostats, and their like.

A variable h with h' = 0 of weight 1 makes them so: each term of x'_i is multiplied by the power of h that it lacks (a
gyrostatic moment l becomes l h).  An integral of the larger field is one of the field itself at h = 1.  The converse
holds for integrals that are such for every length of the unit vector; others, that need its length to be 1, are not
looked for: lists of cases are not said to be complete, and that there are no other values is said of any length.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import product
from typing import Any

from flint import fmpq_mpoly_ctx

from mbsym.algebra import rationals
from mbsym.algebra.factors import irreducible_factors
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.problems.polynomial_integrals import result
from mbsym.problems.polynomial_integrals.darboux import darboux_along, darboux_polynomials
from mbsym.problems.polynomial_integrals.families import cases
from mbsym.problems.polynomial_integrals.gradings import Grading, grading
from mbsym.problems.polynomial_integrals.levels import levels, on_level
from mbsym.problems.polynomial_integrals.modular import (
    PRIMES,
    ModularField,
    Terms,
    at_random,
    echelon,
    primitive,
    remainder,
)
from mbsym.problems.polynomial_integrals.other_levels import other_levels
from mbsym.problems.polynomial_integrals.search import polynomial_integrals, products
from mbsym.problems.polynomial_integrals.values import along

#: Weights that are tried for each kind of variables.
MOST_WEIGHT = 2


#: What the name of an integral gets whose constant is left out: where it is zero the integral has another value.
WITHOUT = ", less a constant"


@dataclass(frozen=True)
class ZeroLevels:
    """What holds where an integral is zero, one item for each; ``weights`` as in ``Along``."""

    levels: tuple[result.OnLevel, ...]
    weights: tuple[int, ...] | None


@dataclass(frozen=True)
class InAnyField:
    """What is looked for beside the ``usual`` integrals of a field with at most one relation.

    Where it is not quasi-homogeneous that is done in the larger field: weights are equal within each of ``kinds`` of
    variables, ``known`` are integrals by their names.  Then NoClosedForm is raised where more monomials are coupled
    than the bounds allow.
    """

    usual: result.PolynomialIntegrals
    kinds: Sequence[Sequence[str]]
    known: Sequence[tuple[str, Any]]

    @property
    def _as_it_is(self) -> bool:
        """Whether the field needs no larger one."""
        usual = self.usual
        return usual.grading.homogeneous and (usual.grading.free or not usual.field.relations)

    @cached_property
    def _larger(self) -> result.PolynomialIntegrals | None:
        """The integrals of the larger field; None where its relations are not integrals by their homogeneous parts."""
        field, larger_grading = homogenised(self.usual.field, self.kinds)
        if field.relations and not larger_grading.free:
            return None
        listed = [(result.UNITY, field.generator(field.variables[-1]))]
        for title, f in self.known:
            constant = any(not any(m[len(field.parameters) :]) for m in f.monoms())
            listed.append((title + WITHOUT if constant else title, _filled(field, f, larger_grading.weights)))
        return polynomial_integrals(field, larger_grading, self.usual.degree, listed)

    @property
    def _needed(self) -> result.PolynomialIntegrals:
        """The same where special values are looked for.  Raises NoClosedForm where there are none."""
        if self._larger is None:
            raise NoClosedForm(
                "special values are looked for where there is one unit vector or angle at most, no root, and where no "
                "constraint ties positions"
            )
        return self._larger

    def cases(self, positive: Sequence[str], budget: float) -> result.Cases:
        """``cases``; raises NoClosedForm where relations of the larger field are not homogeneous, too."""
        if self._as_it_is:
            return cases(self.usual, positive, budget)
        larger = self._needed
        special, down = cases(larger, positive, budget), _Down(larger)
        return replace(special, usual=self.usual, cases=tuple(down.case(case) for case in special.cases))

    def along(self, low: Fraction, high: Fraction) -> result.Along:
        """``along``; raises what that raises, and NoClosedForm as ``cases`` does."""
        if self._as_it_is:
            return along(self.usual, low, high)
        larger = self._needed
        listing, down = along(larger, low, high), _Down(larger)
        values = [_new_at_one(larger, value, down) for value in listing.values]
        fresh = tuple(value for value in values if value.integrals or value.levels)
        return replace(listing, values=fresh, weights=larger.grading.weights[:-1])

    def zero_levels(self) -> ZeroLevels | None:
        """``on_level`` for all ``levels``; None of fields with other relations, which are not looked at.

        In the larger field integrals that are products are left out: one factor may be zero alone.
        """
        usual = self.usual
        if self._as_it_is:
            return ZeroLevels(tuple(on_level(usual, level) for level in levels(usual)), None)
        larger = self._larger
        if larger is None:
            return None
        down, there = _Down(larger), at_random(usual.field, PRIMES[0], "levels at one")
        pairs = [(one.weight, there.terms(down.polynomial(one.polynomial))) for one in larger.generators]
        pairs = [(weight, terms) for weight, terms in pairs if any(any(m) for m in terms)]  # that of the constant is 1
        on_levels = []
        for one in filter(_irreducible, levels(larger)):
            at = on_level(larger, one)
            zero = there.terms(down.polynomial(one.polynomial))
            fresh = [
                (w, f)
                for w, f in ((w, primitive(usual.field, down.polynomial(f))) for w, f in at.integrals)
                if not _spanned(there, there.terms(f), zero, pairs, usual.degree)
            ]
            on_levels.append(result.OnLevel(down.generator(one), tuple(fresh), at.counts))
        return ZeroLevels(tuple(on_levels), larger.grading.weights[:-1])

    def other_levels(self) -> result.OtherLevels | None:
        """``other_levels``; None of fields with other relations, which are not looked at."""
        usual, lengths = self.usual, [generator for generator in self.usual.generators if generator.by_itself]
        if self._as_it_is:  # where the weight of a length is beyond the degree there is nothing for any length
            return other_levels(usual, lengths[0] if lengths else None)
        larger = self._larger
        if larger is None:
            return None
        (unity,) = [generator for generator in larger.generators if generator.name == result.UNITY]
        outcome, down = other_levels(larger, unity), _Down(larger)
        return replace(outcome, levels=tuple(map(down.other, outcome.levels)), weights=larger.grading.weights[:-1])

    def darboux(self) -> result.DarbouxPolynomials:
        """``darboux_polynomials``; of fields with other relations that they were not looked for."""
        larger = None if self._as_it_is else self._larger
        return darboux_polynomials(self.usual) if larger is None else _Down(larger).darboux(darboux_polynomials(larger))

    def darboux_along(self, low: Fraction, high: Fraction) -> result.DarbouxAlong:
        """``darboux_along``; of fields with other relations that nothing was looked for.  Raises what that raises."""
        larger = None if self._as_it_is else self._larger
        if larger is None:
            return darboux_along(self.usual, low, high)
        listing, down = darboux_along(larger, low, high), _Down(larger)
        return replace(
            listing,
            general=down.darboux(listing.general),
            values=tuple(
                replace(value, field=down.field(value.field), polynomials=tuple(map(down.factor, value.polynomials)))
                for value in listing.values
            ),
            square=tuple(map(down.polynomial, listing.square)),
        )


def _new_at_one(larger: result.PolynomialIntegrals, raised: result.Special, down: _Down) -> result.Special:
    """What was found at a value, without what becomes a polynomial in the integrals in general where h is 1."""
    value = raised.field.context.constant(rationals.exact(raised.value) if raised.value is not None else 0)
    images = [value, *raised.field.context.gens()]
    special = down.special(raised)
    there = at_random(special.field, PRIMES[0], "values at one")
    general = [down.polynomial(f.polynomial.compose(*images, ctx=raised.field.context)) for f in larger.generators]
    pairs = [(f.weight, there.terms(p)) for f, p in zip(larger.generators, general, strict=True)]
    pairs = [(weight, terms) for weight, terms in pairs if any(any(m) for m in terms)]
    fresh = tuple(
        (w, f) for w, f in special.integrals if not _spanned(there, there.terms(f), None, pairs, larger.degree)
    )
    pairs += [(w, there.terms(f)) for w, f in fresh]
    on = []
    for own, level in zip(raised.levels, special.levels, strict=True):
        zero = there.terms(general[larger.generators.index(own.level)])
        left = [(w, f) for w, f in level.integrals if not _spanned(there, there.terms(f), zero, pairs, larger.degree)]
        if left:
            on.append(replace(level, integrals=tuple(left)))
    return replace(special, integrals=fresh, levels=tuple(on))


def _irreducible(generator: result.Generator) -> bool:
    """Whether a polynomial is no product over QQ of others; numbers do not count."""
    return sum(power for _, power in irreducible_factors(generator.polynomial)[1]) == 1


def _spanned(
    there: ModularField, f: Terms, zero: Terms | None, pairs: Sequence[tuple[int, Terms]], degree: int
) -> bool:
    """Whether f is a polynomial in integrals (modulo ``zero``): of products up to twice the degree."""

    def reduce(terms: Terms) -> Terms:
        return terms if zero is None else remainder(terms, zero, there.prime)

    rows = [
        reduce(terms) for terms in products(pairs, 2 * degree, False, there.prime, len(there.field.variables), reduce)
    ]
    columns = sorted({m for row in (*rows, f) for m in row} | set(reduce(f)), reverse=True)
    before, _ = echelon(rows, columns, there.prime)
    return len(echelon([*before, reduce(f)], columns, there.prime)[0]) == len(before)


def homogenised(field: PolynomialField, kinds: Sequence[Sequence[str]]) -> tuple[PolynomialField, Grading]:
    """The field with one variable more, and weights equal within each of ``kinds``: those that need the fewest powers.

    The relations stay as they are.
    """
    count = len(field.parameters)
    best: tuple[tuple[int, int], tuple[int, ...]] | None = None
    for choice in product(range(1, MOST_WEIGHT + 1), repeat=len(kinds)):
        by_name = {name: weight for kind, weight in zip(kinds, choice, strict=True) for name in kind}
        weights = tuple(by_name[name] for name in field.variables)
        rises = [
            sum(w * int(a) for w, a in zip(weights, m[count:], strict=True)) - own
            for p, own in zip(field.numerators, weights, strict=True)
            for m in p.monoms()
        ]
        rank = (sum(max(rises) - rise for rise in rises), sum(choice))
        if best is None or rank < best[0]:
            best = rank, weights
    if best is None:
        raise NoClosedForm("there are no variables")
    weights = best[1]
    name = result.UNITY
    while name in (*field.parameters, *field.variables):
        name += "_"
    context = fmpq_mpoly_ctx.get([*field.context.names(), name], field.context.ordering())
    larger = replace(
        field,
        context=context,
        variables=(*field.variables, name),
        numerators=(*(context.constant(0) for _ in field.numerators), context.constant(0)),
        denominator=_up(context, field.denominator),
        relations=tuple(_up(context, r) for r in field.relations),
    )
    numerators = _raised(larger, field.numerators, weights)
    larger = replace(larger, numerators=(*numerators, context.constant(0)))
    larger_grading = grading(larger, [*kinds, (name,)], (*weights, 1))
    return larger, larger_grading


def _up(context: Any, p: Any) -> Any:
    return context.from_dict({(*m, 0): c for m, c in p.to_dict().items()})


def _raised(field: PolynomialField, numerators: Sequence[Any], weights: Sequence[int]) -> list[Any]:
    """Every term of x'_i times the power of the last variable that it lacks."""
    count = len(field.parameters)

    def weight(m: Sequence[Any]) -> int:
        return sum(w * int(a) for w, a in zip(weights, m[count:], strict=True))

    rise = max(weight(m) - own for p, own in zip(numerators, weights, strict=True) for m in p.monoms())
    return [
        field.context.from_dict({(*m, rise - weight(m) + own): c for m, c in p.to_dict().items()})
        for p, own in zip(numerators, weights, strict=True)
    ]


def _filled(field: PolynomialField, f: Any, weights: Sequence[int]) -> Any:
    """f, over the smaller field, made homogeneous; its constant left out."""
    count = len(field.parameters)
    terms = {m: c for m, c in f.to_dict().items() if any(m[count:])}
    of = {m: sum(w * int(a) for w, a in zip(weights, m[count:], strict=False)) for m in terms}
    most = max(of.values(), default=0)
    return field.context.from_dict({(*m, most - of[m]): c for m, c in terms.items()})


class _Down:
    """What was found at h = 1."""

    def __init__(self, larger: result.PolynomialIntegrals) -> None:
        self.name = larger.field.variables[-1]

    def case(self, one: result.Case) -> result.Case:
        return result.Case(tuple(map(self.polynomial, one.conditions)), self.special(one.special))

    def field(self, field: PolynomialField) -> PolynomialField:
        return replace(
            field,
            context=self._context(field.context),
            variables=field.variables[:-1],
            numerators=tuple(map(self.polynomial, field.numerators[:-1])),
            denominator=self.polynomial(field.denominator),
            relations=tuple(map(self.polynomial, field.relations)),
        )

    def darboux(self, original: result.DarbouxPolynomials) -> result.DarbouxPolynomials:
        return replace(
            original,
            weights=original.weights[:-1],
            polynomials=tuple(map(self.factor, original.polynomials)),
            counts=tuple(replace(count, cofactor=self.polynomial(count.cofactor)) for count in original.counts),
        )

    def other(self, other_level: result.OtherLevel) -> result.OtherLevel:
        values = tuple(
            replace(x, integrals=tuple((w, self.polynomial(f)) for w, f in x.integrals)) for x in other_level.values
        )
        return replace(other_level, level=self.generator(other_level.level), values=values)

    def factor(self, polynomial: result.DarbouxPolynomial) -> result.DarbouxPolynomial:
        return replace(
            polynomial, polynomial=self.polynomial(polynomial.polynomial), cofactor=self.polynomial(polynomial.cofactor)
        )

    def special(self, one: result.Special) -> result.Special:
        smaller = self.field(one.field)
        write: Callable[[Any], Any] = lambda f: primitive(smaller, self.polynomial(f))  # noqa: E731
        levels = tuple(
            result.OnLevel(self.generator(level.level), tuple((w, write(f)) for w, f in level.integrals), level.counts)
            for level in one.levels
        )
        return replace(one, field=smaller, integrals=tuple((w, write(f)) for w, f in one.integrals), levels=levels)

    def generator(self, one: result.Generator) -> result.Generator:
        return replace(one, polynomial=self.polynomial(one.polynomial))

    def polynomial(self, p: Any) -> Any:
        context = p.context()
        smaller = self._context(context)
        images = [smaller.constant(1) if n == self.name else smaller.gen(k) for k, n in enumerate(context.names())]
        return p.compose(*images, ctx=smaller)

    def _context(self, context: Any) -> Any:
        return fmpq_mpoly_ctx.get([n for n in context.names() if n != self.name], context.ordering())
