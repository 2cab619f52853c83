"""The sign of a polynomial under the assumptions about its parameters, always with a proof.

A sign is a set of possibilities, a subset of {-1, 0, 1}; the words are names of such sets::

    positive {1}   nonnegative {0, 1}   nonzero {-1, 1}   nonpositive {-1, 0}   negative {-1}   unknown {-1, 0, 1}

Signs multiply and add as sets, every piece of evidence is intersected with the others, and no evidence is numeric but
rigorous enclosures of numbers.  So an answer may be weaker than the truth (``unknown``), never wrong.  The search stops
early where exact sample points that satisfy the assumptions show that nothing stronger can be proved.  The evidence,
from cheap to dear:

* **value**: p holds nothing but numbers, such as sqrt(3) - 1, and its enclosure excludes zero;
* **terms**: p = sum of terms, each with a known sign ("all coefficients of one sign"; numbers such as 4 - pi enclosed);
* **assumptions**: p = sum c_i m_i a_i + rest, with assumptions a_i, numbers c_i and monomials m_i of known sign;
* **square**: p = A x^2 + B x + C with B^2 - 4 A C < 0 has the sign of A, and so on within the discriminant;
* **bounds**: a < x, x < b or both are used up by x = a + u, x = b - u, x = (a + b u)/(1 + u) with u > 0, and the
  question is asked again for the numerator.

``condition(p)`` reduces a requirement p > 0 with the same means: factors of known sign are dropped and even powers
turn into side conditions f != 0.

Polynomials are ``fmpq_mpoly`` of python-flint over the rationals in the generators of one context.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from operator import le, sub
from random import Random
from typing import Any

from flint import arb, ctx, fmpq

from mbsym.algebra.factors import irreducible_factors, occurring
from mbsym.algebra.failures import Failure, NoClosedForm
from mbsym.algebra.terms import coefficients_in

Polynomial = Any  # a flint.fmpq_mpoly: python-flint carries no types
SignSet = frozenset[int]

SIGN_SETS: dict[str, SignSet] = {
    "positive": frozenset({1}),
    "nonnegative": frozenset({0, 1}),
    "negative": frozenset({-1}),
    "nonpositive": frozenset({-1, 0}),
    "zero": frozenset({0}),
    "nonzero": frozenset({-1, 1}),
    "real": frozenset({-1, 0, 1}),
}
SIGN_WORDS: dict[SignSet, str] = {signs: word for word, signs in SIGN_SETS.items()} | {SIGN_SETS["real"]: "unknown"}
RELATIONS: dict[str, SignSet] = {">": SIGN_SETS["positive"], ">=": SIGN_SETS["nonnegative"], "!=": SIGN_SETS["nonzero"]}

ANY, ZERO, POSITIVE = SIGN_SETS["real"], SIGN_SETS["zero"], SIGN_SETS["positive"]

#: Polynomials with more terms are judged by their terms alone: the dearer evidence would cost more than it gives.
MOST_TERMS = 120
#: ... and with more terms than this they are not even factored.
MOST_FACTORED = 4000
#: Sample points, and attempts to find them.
WITNESSES, ATTEMPTS = 24, 200
#: Working precision of enclosures of numbers.
_NUMBER_BITS = 256
#: Where they are sought between the bounds; signs change near the ends rather than in the middle.
SHARES = tuple(fmpq(k, 64) for k in (1, 2, 8, 20, 32, 44, 56, 62, 63))
#: Assumptions of more terms are not divided by what is asked about.
MOST_DIVIDED = 12
#: Squares that are completed within one another.
SQUARES = 2

#: Of more terms than this the factors of a discriminant cost more than sample points.
LONG = 15
#: Steps of the search for a combination of assumptions, per question: as asked, and after a change of variables.
MOST_STEPS, MOST_STEPS_CHANGED = 60, 8


def _sign(number: Any) -> int:
    return (number > 0) - (number < 0)


@cache
def _product(left: SignSet, right: SignSet) -> SignSet:
    return frozenset(a * b for a in left for b in right)


@cache
def _sum(left: SignSet, right: SignSet) -> SignSet:
    return frozenset(s for a in left for b in right for s in ((a or b,) if a * b >= 0 else (-1, 0, 1)))


def sign_of_product(left: str, right: str) -> str:
    """The word for the sign of a product, from those of its factors, all as ``Signs.sign`` says them."""
    return SIGN_WORDS[_product(SIGN_SETS.get(left, ANY), SIGN_SETS.get(right, ANY))]


def _power(base: SignSet, exponent: int) -> SignSet:
    return frozenset(s**exponent for s in base)


class ContradictionError(Failure, ValueError):
    """The assumptions exclude every value of the parameters (or the evidence is in conflict)."""

    code = "contradictory-assumptions"


@dataclass(frozen=True)
class Condition:
    """What is left of a requirement after everything known has been used.

    * ``always`` and ``never``: decided; ``polynomial`` is 1 or -1.
    * ``inequality``: ``polynomial`` > 0, the product of ``factors`` (irreducible, primitive, integer coefficients),
      and each of ``nonzero`` != 0.
    * ``nonzero``: only the side conditions are left; ``polynomial`` is 1.
    * ``unwritten``: too large to be written out (made by those who found it so); open.
    """

    kind: str
    polynomial: Polynomial
    factors: tuple[Polynomial, ...] = ()
    nonzero: tuple[Polynomial, ...] = ()


@dataclass(frozen=True)
class _Change:
    """x = (numerator)/(denominator) in terms of a new positive or nonnegative generator that takes the place of x."""

    generator: int
    target: Signs
    substitute: Callable[[Polynomial], Polynomial]
    ends: tuple[Any, ...]  # values of x that the change leaves out and that the assumptions allow


@dataclass(frozen=True)
class Signs:
    """What is known: a sign word per generator of ``context``, and ``assumptions`` (polynomial, relation to 0).

    Words: positive, nonnegative, negative, nonpositive, nonzero, real.  Relations: ``>``, ``>=``, ``!=``.
    Raises ``ValueError`` for anything else, ``ContradictionError`` (a ValueError) when no parameters are possible as
    far as that is noticed.  ``normal`` brings polynomials to normal form where generators obey relations
    (sqrt(2)^2 = 2): without it "sqrt(2)^2 - 2 > 0" would look like a condition.  ``numbers`` are the enclosures of
    those generators that are constants.
    """

    context: Any
    words: tuple[str, ...]
    assumptions: tuple[tuple[Polynomial, str], ...] = ()
    normal: Callable[[Polynomial], Polynomial] | None = None
    #: Enclosures of the generators that are numbers (sqrt(2), sin(3/10)), by index.
    numbers: Mapping[int, arb] = field(default_factory=dict, compare=False, repr=False)

    def __post_init__(self) -> None:
        if len(self.words) != self.context.nvars():
            raise ValueError(f"{self.context.nvars()} generators, but {len(self.words)} sign words")
        for word in self.words:
            if word not in SIGN_SETS:
                raise ValueError(f"no such sign: {word!r}; known are {', '.join(SIGN_SETS)}")
        for _, relation in self.assumptions:
            if relation not in RELATIONS:
                raise ValueError(f"no such relation: {relation!r}; known are {', '.join(RELATIONS)}")

    # -- questions ----------------------------------------------------------------------------------------------

    def sign(self, p: Polynomial) -> str:
        """``positive``, ``negative``, ``zero``, ``nonnegative``, ``nonpositive``, ``nonzero`` or ``unknown``."""
        return SIGN_WORDS[self._possible(self.normalised(p), -1)]

    def never_zero(self, p: Polynomial) -> bool:
        """Whether p != 0 is known: positive, negative or nonzero."""
        return 0 not in self._possible(self.normalised(p), -1)

    def normalised(self, p: Polynomial) -> Polynomial:
        """p in normal form."""
        return p if self.normal is None else self.normal(p)

    def condition(self, p: Polynomial) -> Condition:
        """The requirement p > 0, reduced."""
        p = self.normalised(p)
        if p == 0:
            return self._decided(False)
        unit, powers = _factored(p)
        direction = _sign(unit)
        polynomials: list[Polynomial] = []
        nonzero: list[Polynomial] = []
        for factor, exponent in powers:
            signs = self._possible(factor, -1)
            odd = exponent % 2 == 1
            if -1 not in signs or 1 not in signs:  # the sign is known, but the factor may vanish
                direction *= -1 if odd and -1 in signs else 1
                if 0 in signs:
                    nonzero.append(_normal(factor)[0])
            elif not odd:
                if 0 in signs:
                    nonzero.append(_normal(factor)[0])
            else:
                normal, flip = _normal(factor)
                direction *= flip
                polynomials.append(normal)
        nonzero = self.apart(nonzero)
        if not polynomials:
            return self._decided(direction > 0, tuple(nonzero))
        if direction < 0:
            polynomials[-1] = -polynomials[-1]
        product = self.context.constant(1)
        for factor in polynomials:
            product *= factor
        if len(polynomials) > 1:  # an assumption may be about the product
            overall = self._as_a_whole(product, ANY, -1)
            if 1 not in overall:
                return self._decided(False)
            if overall == POSITIVE:
                return self._decided(True, tuple(nonzero))
        return Condition("inequality", product, tuple(polynomials), tuple(nonzero))

    def nonzero_condition(self, p: Polynomial) -> Condition:
        """The requirement p != 0, reduced to the factors that may vanish."""
        p = self.normalised(p)
        if p == 0:
            return self._decided(False)
        factors = [_normal(f)[0] for f, _ in _factored(p)[1] if 0 in self._possible(f, -1)]
        return self._decided(True, tuple(self.apart(factors)))

    def apart(self, nonzero: Sequence[Polynomial]) -> list[Polynomial]:
        """Those of the factors that may vanish where the others do not.

        A sum of squares such as (p - 2 A c w)^2 + A^2 w^2 (1 - c^2) is positive where 1 - c^2 is.
        """
        polynomials = list(nonzero)
        for factor in sorted(nonzero, key=len, reverse=True):
            others = [x for x in polynomials if x is not factor and len(x) <= MOST_TERMS]
            facts = [(x, ">") if -1 not in self._possible(x, -1) else (-x, ">") for x in others if self._one_sided(x)]
            try:
                if facts and len(factor) <= MOST_TERMS and self.assuming(facts).never_zero(factor):
                    polynomials = [x for x in polynomials if x is not factor]
            except ContradictionError:  # the others cannot all differ from zero: that is for them to say
                continue
        return polynomials

    def _one_sided(self, p: Polynomial) -> bool:
        signs = self._possible(p, -1)
        return -1 not in signs or 1 not in signs

    def assuming(self, more: Iterable[tuple[Polynomial, str]]) -> Signs:
        """The same knowledge with further assumptions."""
        more = tuple(more)
        if not more:
            return self
        known = Signs(self.context, self.words, (*self.assumptions, *more), self.normal, self.numbers)
        return known if self.normal is not None else _shared(known)

    def _decided(self, answer: bool, nonzero: tuple[Polynomial, ...] = ()) -> Condition:
        one = self.context.constant(1)
        if not answer:
            return Condition("never", -one)
        return Condition("nonzero" if nonzero else "always", one, (), nonzero)

    # -- evidence -----------------------------------------------------------------------------------------------

    @cached_property
    def _generator_signs(self) -> tuple[SignSet, ...]:
        """Of each generator: what its word says, and what is assumed of it alone (c != 0 of c >= 0 is c > 0)."""
        signs = [SIGN_SETS[word] for word in self.words]
        for polynomial, relation in self.assumptions:
            if len(polynomial) == 1 and polynomial.total_degree() == 1:
                (generator,), unit = occurring([polynomial]), polynomial.leading_coefficient()
                signs[generator] = (
                    signs[generator] & _product(RELATIONS[relation], frozenset({_sign(unit)})) or signs[generator]
                )
        return tuple(signs)

    @cached_property
    def _known(self) -> tuple[tuple[Polynomial, SignSet], ...]:
        """The assumptions with factors of known constant sign divided out; numbers are checked and dropped."""
        known = []
        for polynomial, relation in self.assumptions:
            allowed = RELATIONS[relation]
            if polynomial.is_constant():
                if _sign(polynomial.leading_coefficient() if polynomial != 0 else 0) not in allowed:
                    raise ContradictionError("an assumption about the parameters is false whatever their values")
                continue
            unit, powers = _factored(polynomial)
            rest, direction = self.context.constant(1), _sign(unit)
            for factor, exponent in powers:
                signs = _power(self._by_terms(factor), exponent)
                if signs in (SIGN_SETS["positive"], SIGN_SETS["negative"]):
                    direction *= min(signs)
                else:
                    rest *= factor**exponent
            if not rest.is_constant():
                known.append((rest, _product(allowed, frozenset({direction}))))
        return tuple(known)

    @cached_property
    def _known_terms(self) -> tuple[tuple[Polynomial, SignSet, tuple[Any, ...]], ...]:
        return tuple((polynomial, allowed, tuple(polynomial.terms())) for polynomial, allowed in self._known)

    @cached_property
    def emptiness(self) -> dict[Any, Any]:
        """What has been decided of sets of parameters with this knowledge (``semialgebraic``)."""
        return {}

    @cached_property
    def _found(self) -> dict[tuple[str, int], SignSet]:
        return {}

    def _possible(self, p: Polynomial, after: int) -> SignSet:
        """The possible signs of p; changes of variables only for generators beyond ``after``."""
        if p == 0:
            return ZERO
        if len(p) > MOST_TERMS:  # its text would take longer than it saves
            return self._by_factors(p, after)
        key = str(p), after
        if key not in self._found:
            self._found[key] = self._by_factors(p, after)
        return self._found[key]

    def _by_factors(self, p: Polynomial, after: int) -> SignSet:
        unit, powers = _factored(p)
        result = frozenset({_sign(unit)})
        for factor, exponent in powers:
            result = _product(result, _power(self._irreducible(factor, after), exponent))
        if len(result) > 1 and len(powers) > 1:
            result = self._as_a_whole(p, result, after)
        return self._consistent(result)

    def _as_a_whole(self, p: Polynomial, result: SignSet, after: int) -> SignSet:
        """An assumption may be about a product whose factors have unknown signs."""
        if after >= 0:
            return result & self._by_assumptions(p, after)
        small, q = self._restricted(p)
        return result if result == small._observed(q) else result & small._by_assumptions(q, after)

    @cached_property
    def _answers(self) -> dict[tuple[str, int], SignSet]:
        return {}

    def _irreducible(self, p: Polynomial, after: int) -> SignSet:
        number = self._by_value(p)
        if number is not None:
            return number
        if len(p) > MOST_TERMS:
            return self._by_terms(p)
        key = str(p), after
        if key not in self._answers:
            small, q = self._restricted(p) if after < 0 else (self, p)
            self._answers[key] = small._search(q, after)
        return self._answers[key]

    def _by_value(self, p: Polynomial) -> SignSet | None:
        """The sign of a number, where its enclosure excludes zero; None for what has parameters or may be zero."""
        used = occurring([p]) if self.numbers else []
        return self._enclosed(p.terms(), used) if used and all(k in self.numbers for k in used) else None

    def _enclosed(self, terms: Iterable[tuple[tuple[int, ...], Any]], used: Sequence[int]) -> SignSet | None:
        """The sign of the sum of terms in the numbers ``used``; None where its enclosure holds zero."""
        with ctx.workprec(_NUMBER_BITS):
            total = arb(0)
            for exponents, coefficient in terms:
                term = arb(coefficient)
                for k in used:
                    for _ in range(int(exponents[k])):
                        term = term * self.numbers[k]
                total = total + term
            return None if total.contains(0) or not total.is_finite() else frozenset({1 if total > 0 else -1})

    @cached_property
    def _restrictions(self) -> dict[tuple[int, ...], Signs]:
        return {}

    def _restricted(self, p: Polynomial) -> tuple[Signs, Polynomial]:
        """The same question with only the generators that occur in p or in the assumptions: contexts can be wide."""
        used = tuple(sorted(self._assumed.union(occurring([p]))))
        if len(used) == len(self.words):
            return self, p
        if used not in self._restrictions:
            names = self.context.names()
            context = type(self.context).get([names[i] for i in used], self.context.ordering())
            words = tuple(self.words[i] for i in used)
            assumptions = tuple((a.project_to_context(context), relation) for a, relation in self.assumptions)
            numbers = {at: self.numbers[k] for at, k in enumerate(used) if k in self.numbers}
            self._restrictions[used] = _shared(Signs(context, words, assumptions, numbers=numbers))
        small = self._restrictions[used]
        return small, p.project_to_context(small.context)

    @cached_property
    def _assumed(self) -> frozenset[int]:
        """The generators that occur in the assumptions."""
        return frozenset(occurring(a for a, _ in self.assumptions))

    def _search(self, p: Polynomial, after: int) -> SignSet:
        result = self._by_terms(p)
        if len(result) == 1:
            return result
        # The question as asked has witnesses, and a long one: made anew for each change they cost more than they save.
        # Those of numbers such as pi are no values of theirs.
        points = self.witnesses if (after < 0 or len(p) > LONG) and not self._numbers_in(p) else ()
        least = frozenset(_sign(p(*point)) for point in points)
        if result != least:
            result &= self._by_assumptions(p, after)
        if len(result) > 1 and result != least:
            result &= self._by_square(p, points)
        for change in self._changes:
            if len(result) == 1 or result == least:
                break
            if change.generator > after and p.degrees()[change.generator]:
                result &= self._by_change(p, change)
        return self._consistent(result)

    @staticmethod
    def _consistent(result: SignSet) -> SignSet:
        if not result:
            raise ContradictionError("the assumptions about the parameters contradict each other")
        return result

    @cached_property
    def _monomials(self) -> dict[tuple[int, ...], SignSet]:
        return {}

    def _monomial(self, exponents: tuple[int, ...]) -> SignSet:
        result = self._monomials.get(exponents)
        if result is None:
            result = POSITIVE
            for signs, exponent in zip(self._generator_signs, exponents, strict=True):
                if exponent:
                    result = _product(result, _power(signs, exponent))
            self._monomials[exponents] = result
        return result

    def _term(self, exponents: tuple[int, ...], coefficient: Any) -> SignSet:
        return _product(self._monomial(exponents), frozenset({_sign(coefficient)}))

    def _by_terms(self, p: Polynomial) -> SignSet:
        result = ZERO
        for signs in self._signs_of_terms(p):
            result = _sum(result, signs)
            if result == ANY:
                break
        return result

    def _signs_of_terms(self, p: Polynomial) -> Iterator[SignSet]:
        """Signs of the terms; terms that differ in numbers alone are one: 4 a - pi a has the sign of a."""
        used = self._numbers_in(p)
        if not used:
            # Of many terms a few tell that the sign is open.
            terms = p.terms() if len(p) <= LONG else ((p.monomial(k), p.coefficient(k)) for k in range(len(p)))
            yield from (self._term(*term) for term in terms)
            return
        groups: dict[tuple[int, ...], list[tuple[tuple[int, ...], Any]]] = {}
        for exponents, coefficient in p.terms():
            groups.setdefault(tuple(0 if k in used else n for k, n in enumerate(exponents)), []).append(
                (exponents, coefficient)
            )
        for exponents, terms in groups.items():
            value = self._enclosed(terms, used)
            if value is not None:
                yield _product(self._monomial(exponents), value)
            else:
                yield from (self._term(*term) for term in terms)

    def _numbers_in(self, p: Polynomial) -> list[int]:
        """The generators in p that are numbers."""
        return [k for k in occurring([p]) if k in self.numbers] if self.numbers else []

    def _by_assumptions(self, p: Polynomial, after: int) -> SignSet:
        """p = sum c m a + rest: look for a combination that shows p >= 0 (or > 0), and one that shows p <= 0."""
        if not self._known or len(p) > MOST_TERMS:
            return ANY
        result = ANY
        for polynomial, allowed in self._known:  # equality up to a number, the only use of "!= 0"
            ratio = p.leading_coefficient() / polynomial.leading_coefficient()
            if p == polynomial * ratio:
                result &= _product(allowed, frozenset({_sign(ratio)}))
            if len(result) > 1:
                result &= self._by_quotient(p, polynomial, allowed)
        for target in (1, -1):
            if len(result) > 1:
                steps = iter(range(MOST_STEPS if after < 0 else MOST_STEPS_CHANGED))
                result &= self._combination(p, target, 3 if after < 0 else 2, steps)
        return result

    def _by_quotient(self, p: Polynomial, known: Polynomial, allowed: SignSet) -> SignSet:
        """known = q p + r, so that q p has the sign of known - r: from a c - b^2 > 0 and c > 0 follows a > 0."""
        if p.is_constant() or len(known) > MOST_DIVIDED or not all(map(le, p.degrees(), known.degrees())):
            return ANY
        quotient, remainder = divmod(known, p)
        if quotient == 0:
            return ANY
        factor = self._told(quotient)
        product = _sum(allowed, frozenset(-s for s in self._told(remainder)))
        if len(factor) != 1 or 0 in factor or product == ANY:
            return ANY
        return _product(product, factor)

    def _told(self, p: Polynomial) -> SignSet:
        """Signs by factors, of each by its terms or as it is assumed."""
        if p == 0:
            return ZERO
        unit, powers = _factored(p)
        result = frozenset({_sign(unit)})
        for factor, exponent in powers:
            signs = self._by_terms(factor)
            for polynomial, allowed in self._known:
                ratio = factor.leading_coefficient() / polynomial.leading_coefficient()
                if factor == polynomial * ratio:
                    signs &= _product(allowed, frozenset({_sign(ratio)}))
            result = _product(result, _power(signs, exponent))
        return result

    def _combination(self, p: Polynomial, target: int, depth: int, steps: Iterator[int]) -> SignSet:
        """The signs of p by a combination all of whose parts are >= 0 (target 1) or <= 0 (-1); ANY when none is found.

        Every term that may have the wrong sign must be taken up by some assumption, so it is enough to look at one.
        """
        permitted = frozenset({0, target})
        wrong = next((term for term in p.terms() if not self._term(*term) <= permitted), None)
        if wrong is None:
            return self._by_terms(p)
        if depth == 0:
            return ANY
        for polynomial, allowed, terms in self._known_terms:
            for exponents, coefficient in terms:
                quotient = tuple(map(sub, wrong[0], exponents))
                if min(quotient) < 0:
                    continue
                ratio = wrong[1] / coefficient
                part = _product(_product(self._monomial(quotient), frozenset({_sign(ratio)})), allowed)
                if not part <= permitted:
                    continue
                if next(steps, None) is None:
                    return ANY  # out of steps
                rest = p - polynomial * self.context.from_dict({quotient: ratio})
                rest_signs = self._combination(rest, target, depth - 1, steps)
                if rest_signs != ANY:
                    return _sum(part, rest_signs)
        return ANY

    def _by_square(self, p: Polynomial, points: tuple[tuple[Any, ...], ...], depth: int = SQUARES) -> SignSet:
        """A x^2 + B x + C: negative discriminant means the sign of A, a nonpositive one with A > 0 means >= 0.

        The discriminant of a sum of several squares is minus such a sum in fewer generators.  Where it is positive at
        one of the ``points``, which satisfy the assumptions, nothing is asked of it.
        """
        result = ANY
        for generator, degree in enumerate(p.degrees()):
            if degree != 2 or len(result) == 1:
                continue
            c, b, a = coefficients_in(p, generator)
            if any(b(*point) ** 2 > 4 * a(*point) * c(*point) for point in points):
                continue
            discriminant = self._plain(b * b - 4 * a * c, points, depth)
            leading = self._plain(a, points, depth)
            if discriminant == frozenset({-1}):
                result &= leading - ZERO or ANY
            elif 1 not in discriminant and len(leading) == 1 and 0 not in leading:
                result &= leading | ZERO
        return result

    def _plain(self, p: Polynomial, points: tuple[tuple[Any, ...], ...], depth: int) -> SignSet:
        """Signs by factors and terms, and so many squares within."""
        if p == 0:
            return ZERO
        unit, powers = _factored(p)
        result = frozenset({_sign(unit)})
        for factor, exponent in powers:
            signs = self._by_terms(factor)
            if depth and len(signs) > 1 and len(factor) <= MOST_TERMS:
                signs &= self._by_square(factor, points, depth - 1)
            result = _product(result, _power(signs, exponent))
        return result

    # -- witnesses ----------------------------------------------------------------------------------------------

    def _observed(self, p: Polynomial) -> SignSet:
        return frozenset(_sign(p(*point)) for point in self.witnesses)

    @cached_property
    def witnesses(self) -> tuple[tuple[Any, ...], ...]:
        """Some rational points that satisfy the assumptions, a value for each generator; the same ones every time.

        They mean nothing where generators are no free parameters.
        """
        random, points = Random(1), []
        bounds = [self._bounds(generator) for generator in range(self.context.nvars())]
        places = [[_between(lower, upper, share) for share in SHARES] for lower, upper in bounds]
        # What bounds one generator holds at all these points, where there is something between its bounds.
        apart = [k for k, (lower, upper) in enumerate(bounds) if not (lower and upper) or lower[0] < upper[0]]
        others = [
            (p, RELATIONS[relation])
            for p, relation in self.assumptions
            if not any(_is_bound(p, generator, relation) for generator in apart)
        ]
        for _ in range(ATTEMPTS):
            point = tuple(random.choice(values) for values in places)
            if all(_sign(p(*point)) in allowed for p, allowed in others):
                points.append(point)
                if len(points) == WITNESSES:
                    break
        return tuple(points)

    # -- changes of variables -----------------------------------------------------------------------------------

    def _by_change(self, p: Polynomial, change: _Change) -> SignSet:
        transformed = change.substitute(p)
        if len(transformed) > MOST_TERMS:
            return ANY
        result = change.target._possible(transformed, change.generator)
        for end in change.ends:
            if result == ANY:
                break
            result |= self._possible(_at(p, change.generator, end), change.generator)
        return result

    @cached_property
    def _changes(self) -> tuple[_Change, ...]:
        changes = (self._change(generator) for generator in range(self.context.nvars()))
        return tuple(change for change in changes if change is not None)

    def _change(self, generator: int) -> _Change | None:
        """The change of variables that uses up the bounds of one generator; None when its sign word says it all."""
        lower, upper = self._bounds(generator)
        if lower is None and upper is None:
            return None
        if upper is None and lower is not None and lower[0] == 0:
            return None
        if lower is None and upper is not None and upper[0] == 0:
            return None
        u, one = self.context.gen(generator), self.context.constant(1)
        ends: tuple[Any, ...] = ()
        word = "positive"
        if lower is not None and upper is not None:
            if lower[0] > upper[0] or (lower[0] == upper[0] and (lower[1] or upper[1])):
                raise ContradictionError("the assumptions leave no value for a parameter: they contradict each other")
            numerator, denominator = lower[0] + upper[0] * u, 1 + u
            ends = tuple(value for value, strict in (lower, upper) if not strict)
        elif lower is not None:
            numerator, denominator = lower[0] + u, one
            word = "positive" if lower[1] else "nonnegative"
        elif upper is not None:
            numerator, denominator = upper[0] - u, one
            word = "positive" if upper[1] else "nonnegative"

        def substitute(p: Polynomial) -> Polynomial:
            coefficients = coefficients_in(p, generator)
            powers = [one]
            for _ in coefficients[1:]:
                powers.append(powers[-1] * denominator)
            result = coefficients[-1]
            for coefficient, power in zip(reversed(coefficients[:-1]), powers[1:], strict=True):
                result = result * numerator + coefficient * power
            return result

        words = (*self.words[:generator], word, *self.words[generator + 1 :])
        assumptions = tuple(
            (substitute(polynomial), relation)
            for polynomial, relation in self.assumptions
            if not _is_bound(polynomial, generator, relation)
        )
        numbers = {k: value for k, value in self.numbers.items() if k != generator}
        return _Change(generator, Signs(self.context, words, assumptions, numbers=numbers), substitute, ends)

    def _bounds(self, generator: int) -> tuple[tuple[Any, bool] | None, tuple[Any, bool] | None]:
        """The best numeric bounds (value, strict) of a generator from below and from above."""
        signs = self._generator_signs[generator]
        below, above = [], []
        if -1 not in signs:
            below.append((fmpq(0), 0 not in signs))
        if 1 not in signs:
            above.append((fmpq(0), 0 not in signs))
        for polynomial, relation in self.assumptions:
            if _is_bound(polynomial, generator, relation):
                constant, slope = (c.leading_coefficient() if c != 0 else fmpq(0) for c in _ends(polynomial, generator))
                (below if slope > 0 else above).append((-constant / slope, relation == ">"))
        least = max(below, default=None)
        most = min(above, key=lambda bound: (bound[0], not bound[1]), default=None)
        return self._strictly(generator, least), self._strictly(generator, most)

    def _strictly(self, generator: int, bound: tuple[Any, bool] | None) -> tuple[Any, bool] | None:
        """A bound, strict if an assumption excludes equality: 1 - c^2 > 0 excludes c = 1."""
        if bound is None or bound[1]:
            return bound
        excluded = any(
            0 not in RELATIONS[relation] and p.degrees()[generator] and _at(p, generator, bound[0]) == 0
            for p, relation in self.assumptions
            if p != 0 and len(p) <= MOST_TERMS
        )
        return bound[0], excluded


def conditions(requirements: Iterable[Condition]) -> tuple[Condition, ...]:
    """A list of requirements that must all hold, without the decided-true, the repeated and the implied ones.

    A product is implied when each of its factors is required to be positive by itself; a side condition f != 0, when
    f > 0 or f < 0 is required.  One ``never`` makes the whole list ``never``.
    """
    kept_conditions: list[Condition] = []
    for requirement in requirements:
        if requirement.kind == "never":
            return (requirement,)
        if requirement.kind != "always" and not any(_same(requirement, other) for other in kept_conditions):
            kept_conditions.append(requirement)
    single = [c.polynomial for c in kept_conditions if len(c.factors) == 1]
    result: list[Condition] = []
    for requirement in kept_conditions:
        factors = requirement.factors
        if len(factors) > 1 and all(any(f == s for s in single) for f in factors):
            factors = ()
        nonzero = tuple(
            f
            for f in requirement.nonzero
            if not any(f in (g, -g) for c in kept_conditions for g in c.factors if c.factors)
        )
        if not factors and not nonzero:
            continue
        if (factors, nonzero) == (requirement.factors, requirement.nonzero):
            result.append(requirement)
        elif factors:
            result.append(Condition("inequality", requirement.polynomial, factors, nonzero))
        else:
            result.append(Condition("nonzero", requirement.polynomial * 0 + 1, (), nonzero))
    return tuple(c for i, c in enumerate(result) if not any(_same(c, other) for other in result[:i]))


def _factored(p: Polynomial) -> tuple[Any, list[tuple[Polynomial, int]]]:
    """(unit, [(factor, exponent), ...]); what is too long or cannot be factored counts as one factor."""
    if len(p) > MOST_FACTORED:
        return fmpq(1), [(p, 1)]
    try:
        return irreducible_factors(p)
    except NoClosedForm:
        return fmpq(1), [(p, 1)]


#: What was found out under the same assumptions in the same few generators, whoever asked.
_SHARED: dict[tuple[Any, ...], Signs] = {}
_MOST_SHARED = 2048


def _shared(known: Signs) -> Signs:
    """The first knowledge with this content, with everything that has been proved from it."""
    assumptions = tuple((str(p), relation) for p, relation in known.assumptions)
    numbers = tuple((k, str(value.mid().man_exp())) for k, value in known.numbers.items())
    key = (known.context.names(), known.context.ordering(), known.words, assumptions, numbers)
    if key not in _SHARED:
        if len(_SHARED) >= _MOST_SHARED:
            _SHARED.clear()
        _SHARED[key] = known
    return _SHARED[key]


def _same(left: Condition, right: Condition) -> bool:
    return left.polynomial == right.polynomial and left.nonzero == right.nonzero


def _at(p: Polynomial, generator: int, value: Any) -> Polynomial:
    result = p * 0
    for coefficient in reversed(coefficients_in(p, generator)):
        result = result * value + coefficient
    return result


def _normal(factor: Polynomial) -> tuple[Polynomial, int]:
    """The factor or its negative, whichever has more positive terms (then: a positive leading one), and the sign."""
    balance = 2 * sum(map(fmpq(0).__lt__, factor.coeffs())) - len(factor) or _sign(factor.leading_coefficient())
    return (factor, 1) if balance > 0 else (-factor, -1)


def _between(lower: tuple[Any, bool] | None, upper: tuple[Any, bool] | None, t: Any) -> Any:
    """A number strictly within the bounds for 0 < t < 1; never 0 without bounds (t = 1/2 gives 1/8)."""
    if lower is not None and upper is not None:
        return lower[0] + (upper[0] - lower[0]) * t
    if lower is not None:
        return lower[0] + t / (1 - t)
    if upper is not None:
        return upper[0] - t / (1 - t)
    return (t - fmpq(1, 2)) / (t * (1 - t)) if 2 * t != 1 else fmpq(1, 8)


def _is_bound(polynomial: Polynomial, generator: int, relation: str) -> bool:
    degrees = polynomial.degrees() if polynomial != 0 else ()
    return relation != "!=" and sum(degrees) == 1 and degrees[generator] == 1


def _ends(polynomial: Polynomial, generator: int) -> tuple[Polynomial, Polynomial]:
    constant, slope = coefficients_in(polynomial, generator)
    return constant, slope
