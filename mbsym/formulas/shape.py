"""How a polynomial of the ring is shown: a tree of sums, products and powers, apart from the arithmetic.

The tree is made once per polynomial and every printer walks it.  A polynomial is collected by accelerations and
velocities first, then by coordinates and their sines and cosines; what stands before these monomials, a polynomial in
the parameters, is factored, and collected further where that makes it shorter: ``Jx + m*r*(l + r) + m*l**2/3``.
Rational content and common factors stand in front, reciprocals in denominators.  Sines and cosines of several angles
stand as products, as the ring has them, or as waves of sums of angles where that is shorter (``angle_sums``).

The order is fixed and human: declared order, highest degree first, and no sum starts with a minus sign if it can be
helped.  Factoring is for people; polynomials too long for them are only grouped, which is linear in their length.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cache
from math import lcm, prod
from typing import Any
from weakref import WeakKeyDictionary, proxy

from flint import Ordering, fmpq, fmpq_mpoly_ctx, fmpz_mpoly_ctx

from mbsym.algebra.factors import irreducible_factors, occurring
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.remembered import remembered
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.formulas.tree import (
    Angles,
    Factor,
    Monomial,
    Product,
    Split,
    Sum,
    Terms,
    Wave,
    by,
    leaves,
    obviously_irreducible,
    only_negative,
    powers,
    takes_sign,
    tidy,
    without_common,
)
from mbsym.formulas.waves import WITHIN, Waves

#: Longer polynomials are not factored as a whole: nobody sees the factors, and it may take long.
FACTOR_WHOLE = 60

#: Candidate terms of products (some tenths of a second) that bringing a formula to one denominator may take.
FRACTION_WORK = 500_000

#: The terms of a product that such a denominator may be: with more, no numerator is short.
FRACTION_TERMS = 20_000

FACTOR_MIXED = 24
#: In polynomials longer than this the coefficients of the monomials are not factored either.
FACTOR_COEFFICIENTS = 3000
#: Polynomials in the parameters with up to so many terms are collected by the variable that makes them shortest.
COLLECT = 40
#: Beyond so many terms only the variable that occurs most often is tried.
COLLECT_BEST = 14
#: In polynomials with up to so many terms sin^2 and cos^2 of one angle are weighed against one of them.
COMPARED = 24
#: Of formulas with more terms, so many of the longest coefficients of velocities are tried; if none is shorter in sums
#: of angles, none of the formula is.
PROBED, PROBES = 200, 3
#: The terms of polynomials with more of them are not remembered: they would take more room than the polynomials.
REMEMBERED = 3000
#: A longer polynomial stands in sums of angles if that leaves at most this share of its terms.
WORTH_SUMS = Fraction(3, 4)


def present(ring: Ring, polynomial: Polynomial, angles: Angles = "products") -> Sum:
    """The shape of a polynomial in normal form."""
    return _presenter(ring)(polynomial, angles)


@remembered
def _presenter(ring: Ring) -> Presenter:
    return Presenter(ring)


def terms_read(ring: Ring, polynomial: Polynomial, angles: Angles) -> int:
    """How many terms there are with the angles so, brackets multiplied out."""
    return _presenter(ring).terms_read(polynomial, angles)


def length(ring: Ring, shape: Sum) -> int:
    """How much a reader meets: names, numbers, functions, signs, brackets.  The ring has presented the shape."""
    return _presenter(ring).length(shape)


def printed(
    ring: Ring, polynomial: Polynomial, angles: Angles, language: tuple[str | bool, ...], write: Callable[[Sum], str]
) -> str:
    """The text of a polynomial in a language.  Printed once: several files show the same formula."""
    texts = _PRINTED.setdefault(ring, {})
    known = texts.get((id(polynomial), angles, language))
    if known is None:  # the polynomial is kept with its text, so that its id stays its own
        known = texts[id(polynomial), angles, language] = (polynomial, write(present(ring, polynomial, angles)))
    return known[1]


def forget_printed() -> None:
    """For whoever changes how names are printed; of the ring and of its parts."""
    _PRINTED.clear()


_Text = tuple[int, Angles, tuple[str | bool, ...]]
_PRINTED: WeakKeyDictionary[Ring, dict[_Text, tuple[Polynomial, str]]] = WeakKeyDictionary()

_RECIPROCAL, _VELOCITY = 2, 3
_MOTION = {"velocity": _VELOCITY, "acceleration": 4}
#: The level of derivatives of speeds that are variables of their own.
_SPEED_RATE = 5
_PLACE = ("coordinate", "prescribed", "time", "sine", "cosine")
#: Numbers that order by level, place and exponent: (level, adjoined, declared, within) and, in keys, the exponent.
_PLACES, _EXPONENTS = 1 << 24, 1 << 32
_END = 1 << 512


class Presenter:
    """Makes the shapes of one ring's polynomials, and remembers them."""

    def __init__(self, ring: Ring) -> None:
        self.ring = proxy(ring)  # the table of presenters must not keep its rings alive
        names = [g.name for g in ring.generators if g.kind in ("coordinate", "prescribed", "time", "parameter")]
        self._declared = {name: place for place, name in enumerate(dict.fromkeys([*ring.letters, *names]))}
        self._levels: dict[int, int] = {}
        self._places: dict[int, int] = {}
        self._inverted: dict[int, Polynomial | None] = {}
        self._roots: dict[int, Sum] = {}
        self._arguments: list[Polynomial] = []
        self._pairs: dict[tuple[int, int], int] = {}
        self._shapes: dict[tuple[int, Angles], tuple[Polynomial, Sum]] = {}
        self._read: dict[int, tuple[Polynomial, int, Terms]] = {}
        self._factored: dict[frozenset[Any], Product] = {}
        self._brackets: dict[frozenset[Any], Sum] = {}
        self._slots: dict[tuple[int, int], tuple[int, tuple[Factor, ...]]] = {}
        self._sorting: dict[Monomial, tuple[int, tuple[int, ...]]] = {}
        self._orders: dict[tuple[int | Wave | Sum, bool], tuple[Any, ...]] = {}
        self._negatives: dict[Sum, Sum] = {}
        self._turned: dict[Sum, Sum] = {}  # of the negated bracket, the one that it was made of
        self._ranks: dict[Sum, int] = {}
        self._lengths: dict[Sum, int] = {}
        self._choices: dict[tuple[frozenset[Any], Angles], tuple[int, Terms]] = {}
        self._waves = Waves(self)

    def __call__(self, polynomial: Polynomial, angles: Angles = "products") -> Sum:
        known = self._shapes.get((id(polynomial), angles))
        if known is None:
            # The polynomial is kept with its shape, so that its id stays its own.
            known = self._shapes[id(polynomial), angles] = (polynomial, self._present(polynomial, angles))
        return known[1]

    def _present(self, polynomial: Polynomial, angles: Angles) -> Sum:
        used = occurring([polynomial])
        numerator, under = self._as_fraction(polynomial, used, angles)
        scale, terms = self._terms(numerator)
        if not terms:
            return Sum(())
        if angles == "products":
            return self._shape(scale, terms, under)
        below, joined = self._with_angles(terms, angles)
        if joined is not terms:
            return self._shape(scale * below, joined, under)
        known = self._shapes.get((id(polynomial), "products"))
        if known is None:
            known = self._shapes[id(polynomial), "products"] = (polynomial, self._shape(scale, terms, under))
        return known[1]

    def terms_read(self, polynomial: Polynomial, angles: Angles) -> int:
        if angles == "products":
            return len(polynomial)
        _, terms = self._terms(polynomial)
        return len(self._with_angles(terms, angles)[1])

    def _with_angles(self, terms: Terms, angles: Angles) -> tuple[int, Terms]:
        """(a whole number, the terms times it), sums of angles chosen for each product of velocities by itself."""
        groups: dict[Monomial, Terms] = {}
        for monomial, coefficient in terms.items():
            end = 0
            while end < len(monomial) and self._levels[monomial[end][0]] >= _VELOCITY:
                end += 1
            groups.setdefault(monomial[:end], {})[monomial[end:]] = coefficient
        if angles == "shorter" and len(terms) > PROBED:
            longest = sorted(groups.values(), key=len, reverse=True)[:PROBES]
            if all(self._shorter(tail, angles)[1] is tail for tail in longest):
                return 1, terms
        chosen = [(head, *self._shorter(tail, angles)) for head, tail in groups.items()]
        if all(tail is groups[head] for head, _, tail in chosen):
            return 1, terms
        common = max(below for _, below, _ in chosen)
        return common, {
            head + monomial: coefficient * (common // below)
            for head, below, tail in chosen
            for monomial, coefficient in tail.items()
        }

    def _shorter(self, terms: Terms, angles: Angles) -> tuple[int, Terms]:
        """The terms of one product of velocities, as products of sines and cosines or with waves."""
        if len(terms) < 2:
            return 1, terms
        key = frozenset(terms.items())
        known = self._choices.get((key, angles))
        if known is None:
            known = self._choices[key, angles] = self._chosen(terms, angles)
        return known if known[0] else (1, terms)

    def _chosen(self, terms: Terms, angles: Angles) -> tuple[int, Terms]:
        """The same, (0, {}) for products."""
        sums = self._waves.joined(terms, squares=False)
        if angles == "shorter" and sums is not None and len(terms) > COMPARED:
            sums = sums if len(sums[1]) <= WORTH_SUMS * len(terms) else None
        if angles == "shorter" and len(terms) > COMPARED:
            return sums or (0, {})
        squared = self._waves.joined(terms, squares=True)
        if squared is None or squared == sums:
            return sums or (0, {})
        if angles == "sums":
            return squared
        # sin^2 beside cos^2 of one angle is shorter only where their weights are not shared with other terms.
        usual = sums or (1, terms)
        lengths = [self.length(self._shape(*candidate, [])) for candidate in (usual, squared)]
        return squared if lengths[1] < lengths[0] else sums or (0, {})

    def _shape(self, scale: int, terms: Terms, under: list[Factor]) -> Sum:
        by_terms = self._by_terms(scale, terms) if self.ring.leading and not under else None
        if by_terms is not None and not self.ring.shortest:
            return by_terms
        product = self._product(terms, factored=len(terms) <= FACTOR_COEFFICIENTS)
        product = product._replace(coefficient=product.coefficient / scale)
        if under:
            return Sum((product._replace(under=_ordered(self, [*product.under, *under])),))
        whole = self._opened(product)
        return whole if by_terms is None or self.length(whole) <= self.length(by_terms) else by_terms

    def _by_terms(self, scale: int, terms: Terms) -> Sum | None:
        """What leads is read term by term, without common factors in front; None where nothing does."""
        level = max(self.level(monomial[0][0]) for monomial in terms if monomial) if any(terms) else 0
        if level == _SPEED_RATE:  # A p' + (C - B) q r + l q: first the derivatives, then what is left by itself
            first = {m: c for m, c in terms.items() if m and self.level(m[0][0]) == level}
            rest = {m: c for m, c in terms.items() if m not in first}
            grouped = self._grouped(first, self._at_level(level), True)
            parts = [x._replace(coefficient=x.coefficient / scale) for x in grouped.terms]
            return Sum((*parts, *(self._shape(scale, rest, []).terms if rest else ())))
        if level >= _VELOCITY:  # m l w/2 + l F, not l (m w + 2 F)/2
            grouped = self._grouped(terms, self._at_level(level), True)
            return Sum(tuple(x._replace(coefficient=x.coefficient / scale) for x in grouped.terms))
        return None

    def _as_fraction(
        self, polynomial: Polynomial, used: Sequence[int], angles: Angles
    ) -> tuple[Polynomial, list[Factor]]:
        """One common denominator where that shortens (x/(1 + x), kept as 1 - 1/(1 + x)); else term by term."""
        long = [k for k in used if self._long_reciprocal(k)] if len(polynomial) <= FACTOR_WHOLE else []
        if long and self._terms_of_denominator(polynomial, long) <= FRACTION_TERMS:
            try:
                with self.ring.budget(FRACTION_WORK):
                    numerator, denominators = self.ring.fraction(polynomial)
            except NoClosedForm:  # nothing that gets shorter: term by term it is written all the same
                return polynomial, []
            if len(numerator) < len(polynomial):
                return numerator, [Factor(self(p, angles), exponent) for p, exponent in denominators]
        return polynomial, []

    def _terms_of_denominator(self, polynomial: Polynomial, reciprocals: Sequence[int]) -> int:
        """How many terms the common denominator has at most before they are collected."""
        degrees = polynomial.degrees()
        return prod(len(self._inverse_of(k)) ** int(degrees[k]) for k in reciprocals)  # type: ignore[arg-type]

    def _long_reciprocal(self, index: int) -> bool:
        inner = self._inverse_of(index)
        return inner is not None and len(inner) > 1

    # --- generators ------------------------------------------------------------------------------------------------

    def level(self, index: int) -> int:
        """0 parameters, 1 coordinates and time, 2 reciprocals of parameters, 3 velocities, 4 accelerations.

        Adjoined generators have the level of what they hold.
        """
        if index not in self._levels:
            generator = self.ring.generators[index]
            level = _MOTION.get(generator.kind, 1 if generator.kind in _PLACE else 0)
            if generator.kind == "root":
                self._roots[index] = self._argument(generator.argument)
            if generator.argument is not None:
                level = max([0, *(self.level(k) for k in occurring([generator.argument]))])
                if generator.kind == "reciprocal" and level <= _RECIPROCAL:
                    level = _RECIPROCAL
            elif level == 1 and (self.ring.has("parameter", generator.name) or index in self.ring.resting):
                level = 0
            elif index in self.ring.leading:
                level = _VELOCITY
            elif generator.kind == "velocity" and self.ring.leading and self._leads(generator.name):
                level = _SPEED_RATE
            self._levels[index] = level
        return self._levels[index]

    def _leads(self, name: str) -> bool:
        return self.ring.has("coordinate", name) and self.ring.index("coordinate", name) in self.ring.leading

    def place(self, index: int) -> int:
        """The order in which people read: by level, then as declared; adjoined generators last, the newest first."""
        if index not in self._places:
            g = self.ring.generators[index]
            within = ("sine", "cosine").index(g.kind) + 1 if g.kind in ("sine", "cosine") else 0
            declared = self._declared[g.name] if g.argument is None else _PLACES - index
            self._places[index] = (((5 - self.level(index)) * 2 * _PLACES + declared) * 4 + within) << WITHIN
        return self._places[index]

    def _inverse_of(self, index: int) -> Polynomial | None:
        """What a reciprocal is the reciprocal of; None for other generators."""
        if index not in self._inverted:
            generator = self.ring.generators[index]
            self._inverted[index] = generator.argument if generator.kind == "reciprocal" else None
        return self._inverted[index]

    def _argument(self, polynomial: Polynomial) -> Sum:
        """What stands in a root or a reciprocal: of equal ones one object."""
        if polynomial not in self._arguments:
            self._arguments.append(polynomial)
        return self(self._arguments[self._arguments.index(polynomial)])

    # --- terms -----------------------------------------------------------------------------------------------------

    def _terms(self, polynomial: Polynomial) -> tuple[int, Terms]:
        """(common denominator, terms of what is left)."""
        known = self._read.get(id(polynomial))
        if known is None:
            known = (polynomial, *self._terms_of(polynomial))
            if len(polynomial) <= REMEMBERED:
                self._read[id(polynomial)] = known
        return known[1:]

    def _terms_of(self, polynomial: Polynomial) -> tuple[int, Terms]:
        used = sorted(occurring([polynomial]), key=self.place)
        # In a context of its own: flint hands out all exponents, and the ring has many more generators.
        small = polynomial.project_to_context(
            _context(fmpq_mpoly_ctx, len(used)), {k: place for place, k in enumerate(used)}
        )
        coefficients = small.coeffs()
        tops, bottoms = [int(c.p) for c in coefficients], [int(c.q) for c in coefficients]
        scale = lcm(*bottoms)
        if scale != 1:
            tops = [top * (scale // bottom) for top, bottom in zip(tops, bottoms, strict=True)]
        return scale, {
            tuple([(k, int(e)) for k, e in zip(used, monomial, strict=True) if e]): top
            for monomial, top in zip(small.monoms(), tops, strict=True)
        }

    def _key(self, monomial: Monomial) -> tuple[int, ...]:
        """Sorts as the dense exponents would, highest first."""
        pairs = self._pairs
        try:
            return (*[pairs[pair] for pair in monomial], _END)
        except KeyError:
            for index, exponent in monomial:
                pairs[index, exponent] = self.place(index) * _EXPONENTS - exponent
            return (*[pairs[pair] for pair in monomial], _END)

    def _degree_and_key(self, monomial: Monomial) -> tuple[int, tuple[int, ...]]:
        """Sorts by degree, highest first, then by ``_key``."""
        known = self._sorting.get(monomial)
        if known is None:
            known = self._sorting[monomial] = (-sum([e for _, e in monomial]), self._key(monomial))
        return known

    # --- products --------------------------------------------------------------------------------------------------

    def _product(self, terms: Terms, factored: bool) -> Product:
        """Content and factors in front of what cannot be factored."""
        if len(terms) == 1:
            ((monomial, coefficient),) = terms.items()
            return self._assembled(coefficient, monomial, [], factored)
        key = frozenset(terms.items()) if len(terms) <= FACTOR_WHOLE else None
        known = self._factored.get(key) if key is not None and factored else None
        if known is None:
            known = self._assembled(*self._factors(terms, factored), factored)
            if key is not None and factored:
                self._factored[key] = known
        return known

    def _factors(self, terms: Terms, factored: bool) -> tuple[int, Monomial, list[tuple[Terms, int]]]:
        """Content, monomial, and the other factors with their exponents."""
        content, common, rest = without_common(terms)
        level = self._highest(rest)
        if not factored or len(terms) > (FACTOR_MIXED if level else FACTOR_WHOLE):
            parts = [(rest, 1)]
        else:
            unit, parts = self._irreducible(rest)
            content = content * unit
            if level == 1 and len(parts) > 1:
                content, common, parts = self._sines_restored(content, common, parts)
        if len(parts) > 1:
            parts = sorted(parts, key=lambda item: sorted(map(self._key, item[0])))
        return self._whole_reciprocals(content, common, parts)

    def _irreducible(self, terms: Terms) -> tuple[int, list[tuple[Terms, int]]]:
        """A factorisation of terms without common factor, positive in front."""
        if obviously_irreducible(terms):
            return self._positive(terms)
        # Over the generators that occur: the ring has many more, and flint minds them all.
        used = sorted({k for monomial in terms for k, _ in monomial}, key=self.place)
        context = _context(fmpz_mpoly_ctx, len(used))
        places = {k: place for place, k in enumerate(used)}
        none, dense = [0] * len(used), {}
        for monomial, coefficient in terms.items():
            exponents = none.copy()
            for k, e in monomial:
                exponents[places[k]] = e
            dense[tuple(exponents)] = coefficient
        try:
            unit, factors = irreducible_factors(context.from_dict(dense))
        except NoClosedForm:  # for reading, a sum that has factors is as good
            return 1, [(terms, 1)]
        if len(factors) == 1 and factors[0][1] == 1:
            return self._positive(terms)
        return int(unit), [
            (
                {tuple([(used[i], int(e)) for i, e in enumerate(m) if e]): int(c) for m, c in factor.terms()},
                exponent,
            )
            for factor, exponent in factors
        ]

    def _positive(self, terms: Terms) -> tuple[int, list[tuple[Terms, int]]]:
        """(sign, the terms as one factor, positive in front)."""
        if terms[min(terms, key=self._key)] > 0:
            return 1, [(terms, 1)]
        return -1, [({monomial: -c for monomial, c in terms.items()}, 1)]

    def _sines_restored(
        self, content: int, common: Monomial, parts: list[tuple[Terms, int]]
    ) -> tuple[int, Monomial, list[tuple[Terms, int]]]:
        """(cos x - 1)**n*(cos x + 1)**n is (-1)**n*sin(x)**(2*n)."""
        for index in sorted({k for part, _ in parts for m in part for k, _ in m}, key=self.place):
            if index >= self._waves.first:
                continue
            g = self.ring.generators[index]
            if g.kind != "cosine" or g.argument is not None:
                continue
            minus: Terms = {((index, 1),): 1, (): -1}
            plus: Terms = {((index, 1),): 1, (): 1}
            powers = [next((n for part, n in parts if part == factor), 0) for factor in (minus, plus)]
            both = min(powers)
            if both:
                left = [(factor, n - both) for factor, n in zip((minus, plus), powers, strict=True) if n > both]
                parts = [*(item for item in parts if item[0] not in (minus, plus)), *left]
                content = -content if both % 2 else content
                common = self._joined(common, (self.ring.index("sine", g.name), 2 * both))
        return content, common, parts

    def _whole_reciprocals(
        self, content: int, common: Monomial, brackets: list[tuple[Terms, int]]
    ) -> tuple[int, Monomial, list[tuple[Terms, int]]]:
        """1/R is not taken out of a bracket that holds further powers of it: a/R + b/R^2, not (a + b/R)/R."""
        for index, exponent in common:
            if self.level(index) != _RECIPROCAL:
                continue
            for place, (terms, power) in enumerate(brackets):
                if power == 1 and any(k == index for monomial in terms for k, _ in monomial):
                    brackets[place] = ({self._joined(m, (index, exponent)): c for m, c in terms.items()}, 1)
                    common = tuple(pair for pair in common if pair[0] != index)
                    break
        return content, common, brackets

    def _joined(self, monomial: Monomial, pair: tuple[int, int]) -> Monomial:
        exponents = dict(monomial)
        exponents[pair[0]] = exponents.get(pair[0], 0) + pair[1]
        return tuple((k, exponents[k]) for k in sorted(exponents, key=self.place))

    def _assembled(
        self, coefficient: int, monomial: Monomial, brackets: Sequence[tuple[Terms, int]], factored: bool
    ) -> Product:
        over: list[Factor] = []
        under: list[Factor] = []
        motion: list[Factor] = []
        coordinates: list[Factor] = []
        slots = self._slots
        for pair in monomial:
            slot = slots.get(pair)
            if slot is None:
                slot = slots[pair] = self._slot(*pair)
            place, factors = slot
            (over, motion, coordinates, under)[place].extend(factors)
        over += motion
        over += coordinates
        if not brackets:  # parameters, motion, coordinates: in order
            over, under = self._roots_below(over, under)
            return Product(fmpq(coefficient), tuple(over), _ordered(self, under))
        for terms, exponent in brackets:
            bracket = self._bracket(terms, factored)
            if exponent % 2 and (coefficient < 0 or only_negative(bracket)) and takes_sign(bracket):
                bracket, coefficient = self._negated(bracket), -coefficient
            over.append(Factor(bracket, exponent))
        over, under = self._roots_below(over, under)
        return Product(fmpq(coefficient), _ordered(self, over), _ordered(self, under))

    def _roots_below(self, over: list[Factor], under: list[Factor]) -> tuple[list[Factor], list[Factor]]:
        """x/sqrt(R)^3, not x sqrt(R)/R^2."""
        for root in [f for f in over if f.base in self._roots] if self._roots and under else ():
            inner = tuple(powers(self._roots[root.base], 1))  # type: ignore[index]
            for below in under:
                if inner == (Factor(below.base),):
                    over = [f for f in over if f is not root]
                    lowered = Factor(root.base, 2 * below.exponent - root.exponent)
                    under = [lowered if f is below else f for f in under]
                    break
        return over, under

    def _slot(self, index: int, exponent: int) -> tuple[int, tuple[Factor, ...]]:
        """Where a power stands in a product (0 parameters, 1 motion, 2 coordinates, 3 denominator), and its factors."""
        inverted = self._inverse_of(index)
        if inverted is not None:
            return 3, tuple(powers(self._argument(inverted), exponent))
        level = self.level(index)
        base = index if index < self._waves.first else self._waves[index]
        return (1 if level >= _VELOCITY else 2 if level else 0), (Factor(base, exponent),)

    # --- brackets --------------------------------------------------------------------------------------------------

    def _bracket(self, terms: Terms, factored: bool) -> Sum:
        if len(terms) > FACTOR_WHOLE:
            return self._new_bracket(terms, factored)
        key = frozenset(terms.items())
        if key not in self._brackets:
            self._brackets[key] = self._new_bracket(terms, factored)
        return self._brackets[key]

    def _highest(self, terms: Terms) -> int:
        """The highest level; each monomial begins with its own."""
        levels = self._levels
        return max([levels[monomial[0][0]] for monomial in terms if monomial])

    def _new_bracket(self, terms: Terms, factored: bool) -> Sum:
        level = self._highest(terms)
        if level:
            return self._grouped(terms, self._at_level(level), factored)
        return self._collected(terms) if factored and 2 < len(terms) <= COLLECT else self._plain(terms)

    def _plain(self, terms: Terms) -> Sum:
        ordered = sorted(terms, key=self._key)
        return tidy([self._assembled(terms[monomial], monomial, [], False) for monomial in ordered])

    def _at_level(self, level: int) -> Split:
        """Splits monomials after their generators of that level, the highest they hold."""

        def split(monomial: Monomial) -> tuple[Monomial, Monomial]:
            end = 0
            while end < len(monomial) and self._levels[monomial[end][0]] == level:
                end += 1
            return monomial[:end], monomial[end:]

        return split

    def _grouped(self, terms: Terms, split: Split, factored: bool) -> Sum:
        """Collected by the first parts of the monomials, of highest degree first."""
        groups: dict[Monomial, Terms] = {}
        for monomial, coefficient in terms.items():
            head, tail = split(monomial)
            groups.setdefault(head, {})[tail] = coefficient
        shared: dict[tuple[Any, ...], Terms] = {}
        for head in sorted(groups, key=self._degree_and_key):
            product = self._unsigned(self._product(groups[head], factored))
            shared.setdefault((product.over, product.under), {})[head] = int(product.coefficient.p)
        products: list[Product] = []
        for (over, under), heads in shared.items():
            products += self._shared(over, under, heads, factored)
        return tidy(self._consistent(products))

    def _shared(
        self, over: tuple[Factor, ...], under: tuple[Factor, ...], heads: Terms, factored: bool
    ) -> Sequence[Product]:
        """over/under times the sum of the heads: l*(m + 3*m0)*(sin(phi)*cos(sigma) + cos(phi)*sin(sigma))."""
        if len(heads) > 1 and (over or under):
            return [self._times(self._unsigned(self._product(heads, factored)), over, under)]
        products: list[Product] = []
        for head, coefficient in heads.items():
            if head:
                products.append(self._times(self._assembled(coefficient, head, [], False), over, under))
            else:
                product = self._signed(Product(fmpq(coefficient), over, under))
                products += self._opened(product).terms if abs(coefficient) == 1 else [product]
        return products

    def _times(self, product: Product, over: Sequence[Factor], under: Sequence[Factor]) -> Product:
        over, under = self._roots_below([*over, *product.over], [*under, *product.under])
        return self._signed(Product(product.coefficient, _ordered(self, over), _ordered(self, under)))

    def _unsigned(self, product: Product) -> Product:
        """With brackets as they were before a sign went into them: y - x and x - y are one bracket."""
        coefficient, over = product.coefficient, []
        for factor in product.over:
            original = self._turned.get(factor.base) if isinstance(factor.base, Sum) and factor.exponent % 2 else None
            if original is not None:
                factor, coefficient = Factor(original, factor.exponent), -coefficient
            over.append(factor)
        return Product(coefficient, tuple(over), product.under) if coefficient != product.coefficient else product

    def _consistent(self, products: Sequence[Product]) -> list[Product]:
        """No bracket in one term and its negative in another: (A - B)*x - (A - B)*y."""
        held = {f.base for product in products for f in product.over if isinstance(f.base, Sum)}
        if not held or not self._turned:
            return list(products)
        return [
            self._unsigned(product)
            if any(isinstance(f.base, Sum) and self._turned.get(f.base) in held for f in product.over)
            else product
            for product in products
        ]

    def _opened(self, product: Product) -> Sum:
        """A lone bracket without its brackets, unless its content is worth standing in front."""
        if product.under or len(product.over) != 1:
            return Sum((product,))
        (factor,) = product.over
        if not isinstance(factor.base, Sum) or factor.exponent != 1:
            return Sum((product,))
        content = product.coefficient
        terms = [Product(content * term.coefficient, term.over, term.under) for term in factor.base.terms]
        broken = sum(term.coefficient.q != 1 for term in terms)
        if abs(content.p) != 1 or 2 * broken > len(terms):
            return Sum((product,))
        terms = self._consistent([self._signed(term) for term in terms]) if content < 0 else terms
        inner = [self._opened(term).terms if abs(term.coefficient) == 1 else (term,) for term in terms]
        return tidy([term for opened in inner for term in opened])

    def _signed(self, product: Product) -> Product:
        """With its minus sign in a bracket that has one already."""
        if product.coefficient >= 0:
            return product
        for place, factor in enumerate(product.over):
            if isinstance(factor.base, Sum) and factor.exponent % 2 and takes_sign(factor.base):
                turned = Factor(self._negated(factor.base), factor.exponent)
                return Product(
                    -product.coefficient, (*product.over[:place], turned, *product.over[place + 1 :]), product.under
                )
        return product

    def _collected(self, terms: Terms) -> Sum:
        """Collected by the parameter that leaves the fewest symbols to read."""
        best = self._plain(terms)
        fewest = leaves(best)
        counts = Counter(k for monomial in terms for k, _ in monomial)
        variables = sorted((k for k, count in counts.items() if count > 1), key=self.place)
        if len(terms) > COLLECT_BEST:  # trying all, bracket within bracket, takes a time that grows exponentially
            variables = sorted(variables, key=lambda k: -counts[k])[:1]
        for variable in variables:
            candidate = self._grouped(terms, by(variable), True)
            if leaves(candidate) < fewest:
                best, fewest = candidate, leaves(candidate)
        return best

    def _negated(self, bracket: Sum) -> Sum:
        if bracket not in self._negatives:
            opposite = tidy([Product(-term.coefficient, term.over, term.under) for term in bracket.terms])
            self._negatives[bracket], self._negatives[opposite] = opposite, bracket
            self._turned[opposite] = bracket
        return self._negatives[bracket]

    def rank(self, factor: Factor) -> int:
        """The highest level of anything in a factor."""
        if isinstance(factor.base, int):
            return self.level(factor.base)
        if isinstance(factor.base, Wave):
            return self.level(self._waves.index(factor.base))
        known = self._ranks.get(factor.base)
        if known is None:
            inner = (self.rank(f) for term in factor.base.terms for f in (*term.over, *term.under))
            known = self._ranks[factor.base] = max(inner, default=0)
        return known

    def order(self, factor: Factor, mixed: bool) -> tuple[Any, ...]:
        """Where a factor stands in a product; ``mixed``: beside brackets in which something moves."""
        rank = self.rank(factor)
        if isinstance(factor.base, Sum):
            return (4 if rank else 1,)
        if isinstance(factor.base, Wave):
            return (3 if rank else 0, 0, self.place(self._waves.index(factor.base)))
        if rank >= _VELOCITY:
            return (5 if mixed else 2, -rank, self.place(factor.base))
        return (3 if rank else 0, 0, self.place(factor.base))

    def length(self, shape: Sum) -> int:
        """How much is read: names, numbers, functions, signs; brackets and fractions."""
        if shape not in self._lengths:
            self._lengths[shape] = sum(map(self._length_of_product, shape.terms))
        return self._lengths[shape]

    def _length_of_product(self, product: Product) -> int:
        written = 1 + (abs(product.coefficient.p) != 1) + (product.coefficient.q != 1) + bool(product.under)
        for factor in (*product.over, *product.under):
            written += factor.exponent != 1
            if isinstance(factor.base, Sum):
                written += 1 + self.length(factor.base)
            elif isinstance(factor.base, Wave):
                written += 2 * len(factor.base.angle) + sum(abs(n) != 1 for _, n in factor.base.angle)
            else:
                written += 2 if self.ring.generators[factor.base].kind in ("sine", "cosine") else 1
        return written


@cache
def _context(kind: Any, width: int) -> Any:
    """A context of so many generators."""
    return kind.get([f"y{k}" for k in range(width)], Ordering.lex)


def _ordered(presenter: Presenter, factors: Sequence[Factor]) -> tuple[Factor, ...]:
    """Parameters, then motion, then angles; long brackets in the motion come before what multiplies them."""
    if len(factors) < 2:
        return tuple(factors)
    mixed = False
    for f in factors:
        if isinstance(f.base, Sum) and presenter.rank(f):
            mixed = True
            break
    orders = presenter._orders

    def key(factor: Factor) -> tuple[Any, ...]:
        known = orders.get((factor.base, mixed))
        if known is None:
            known = orders[factor.base, mixed] = presenter.order(factor, mixed)
        return known

    return tuple(sorted(factors, key=key))
