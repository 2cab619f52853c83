"""The exact ring: QQ[parameters][q', q''][sin q, cos q, q] modulo sin^2 + cos^2 = 1, with a derivation as a table.

Scalars are raw ``fmpq_mpoly`` of python-flint: arithmetic on them is where the speed is, so no wrapper stands
between.  Normal forms are taken after products of vectors, not after every addition.

What is not polynomial is adjoined as a spare generator with a relation: a reciprocal (x * x_inverse = 1), a root
(rho^2 = p), a function (its derivative is known).  Generators are ordered so that in the lexicographic order the term
to be eliminated leads its relation: adjoined ones first (the latest before the earlier ones it may depend on), then
sines before cosines.  For reciprocals the normal form is not always unique; ``is_zero`` therefore clears
denominators before it decides.

A description may come from anyone, so every step that can grow is bounded before it is taken: products by their
candidate terms and bytes, reductions and substitutions by what they can expand to, multiples of angles, degrees and
the integers under roots by their size, and everything together by a count of work.  Counts decide, never a clock, so
that a result does not depend on the machine.
"""

from __future__ import annotations

import random
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from math import comb
from typing import Any

from flint import Ordering, arb, ctx, fmpq, fmpq_mpoly_ctx, fmpz, fmpz_poly
from flint.utils.flint_exceptions import DomainError

from mbsym.algebra import rationals
from mbsym.algebra.base import Algebra
from mbsym.algebra.factors import irreducible_factors, occurring, rational_ratio
from mbsym.algebra.failures import Limit, NoClosedForm, SingularPoint
from mbsym.algebra.point import enclosed
from mbsym.expressions.angles import LinearForm
from mbsym.expressions.rates import ENDINGS, acceleration_name, velocity_name
from mbsym.expressions.table import Tabulated

Polynomial = Any

#: Products with more candidate terms than this, and polynomials longer than the term budget, have "no closed form".
PRODUCT_BUDGET = 40_000_000
TERM_BUDGET = 60_000

#: A product that may need more bytes than this is not begun: a library that runs out of memory ends the process.
MEMORY_BUDGET = 1_500_000_000
#: One formula may take so many bytes at the usual term budget: a term holds the exponents of all generators, and a ring
#: of 200 coordinates has a thousand of them.
FORMULA_BUDGET = 24_000_000
#: Candidate terms (and what costs as much) of everything that is done in one ring together, at the usual term budget.
WORK_BUDGET = 300_000_000
#: Below so many candidate terms a product, reduction or substitution is not looked at more closely.
SMALL = 20_000
#: Up to so many terms the total degree is had for less than the degrees in all generators.
_FEW = 8
#: The degree in one generator: powers of powers grow far beyond any formula without growing in terms.
MOST_DEGREE = 1_000
#: sin and cos of n*x are polynomials of degree n in sin and cos of x.
MOST_MULTIPLE = 256
#: Coefficients have at most so many bits (some 3000 digits).
MOST_COEFFICIENT_BITS = 10_000
#: What is factored, and what greatest common divisors are taken of: so many terms.
MOST_FACTORED = 20_000
#: Integers under a root are factored: so many bits may remain when the small primes are out.
MOST_BITS = 120
_SMALL_PRIMES = 2_000
#: sin and cos of 2*pi/7 and 3*pi/7 are made of those of pi/7; a higher multiple is a constant of its own.
_MOST_OF_A_NAMED_ANGLE = 3
#: cos(pi/n) obeys its minimal polynomial, of degree at most n - 1, up to this n.
_MOST_RELATED = 24
#: Working precision at which the signs of constants are read off.
_CONSTANT_BITS = 256


@dataclass(frozen=True, slots=True)
class Generator:
    """What one generator of the ring stands for.

    ``kind`` is one of parameter, coordinate, velocity, acceleration, prescribed, time, sine, cosine, reciprocal, root,
    function.  ``name`` is the declared name; for sines and cosines the angle is ``name / denominator`` (or, for an
    angle that is no single name, ``argument``).  Adjoined generators keep the polynomial they are the reciprocal, root
    or function of in ``argument``.
    """

    kind: str
    name: str
    denominator: int = 1
    argument: Polynomial = None

    @property
    def kinked(self) -> bool:
        """Whether it is a sign, modulus or table, which is not analytic."""
        return self.kind == "function" and (self.name in ("abs", "sign") or isinstance(self.name, Tabulated))


@dataclass(slots=True)
class Spent:
    """The work that a block did, once it is left."""

    work: int = 0


class Ring(Algebra[Polynomial]):
    """One context per system.

    coordinates, prescribed, parameters: declared names, disjoint.  angles: the names that stand under sin and cos,
    each with the common denominator of its coefficients there (sin(q/2) makes it 2).  positive: the parameters known to
    be positive (a root of their squares is taken exactly).  nonnegative: those that may be zero besides.  spare: how
    many generators may be adjoined.  terms: the budget of terms a formula may have; beyond it NoClosedForm is raised.
    typed: the sums of angles (coefficients by name, as in ``LinearForm``) as they stand in the description.
    """

    #: Generators by which formulas are collected before others when they are shown.
    leading: frozenset[int] = frozenset()
    #: Generators that are read like parameters.
    resting: frozenset[int] = frozenset()
    #: Whether formulas that are collected so have their common factors in front where that is shorter to read.
    shortest = False
    #: Names that are read before others of their kind.
    letters: tuple[str, ...] = ()

    def __init__(
        self,
        coordinates: Sequence[str],
        prescribed: Sequence[str],
        parameters: Sequence[str],
        angles: Mapping[str, int],
        positive: Iterable[str] = (),
        nonnegative: Iterable[str] = (),
        spare: int = 8,
        terms: int = TERM_BUDGET,
        typed: Iterable[tuple[tuple[str, Fraction], ...]] = (),
    ) -> None:
        self.work, self.work_budget = 0, WORK_BUDGET * max(1, terms // TERM_BUDGET)
        self.spare = spare
        layout: list[Generator] = [Generator("spare", f"#{spare - 1 - k}") for k in range(spare)]
        layout += [Generator("acceleration", name) for name in coordinates]
        layout += [Generator("velocity", name) for name in coordinates]
        layout += [Generator("sine", name, angles[name]) for name in angles]
        layout += [Generator("cosine", name, angles[name]) for name in angles]
        layout += [Generator("coordinate", name) for name in coordinates]
        layout += [Generator("prescribed", name) for name in prescribed]
        layout += [Generator("time", "t"), Generator("parameter", "pi")]
        layout += [Generator("parameter", name) for name in parameters]
        self.generators = layout
        self.context = fmpq_mpoly_ctx.get([f"x{k}" for k in range(len(layout))], Ordering.lex)
        self._gens = self.context.gens()
        self._index = {(g.kind, g.name): k for k, g in enumerate(layout)}
        self._free = spare - 1
        self.zero = self.context.constant(0)
        self.one = self.context.constant(1)
        self.most_terms = min(terms, FORMULA_BUDGET * max(terms, TERM_BUDGET) // TERM_BUDGET // term_bytes(len(layout)))
        self._overhead = 20 + len(layout) // 3  # what an operation costs before it looks at the second term
        self._positive = {self._index["parameter", name] for name in positive if ("parameter", name) in self._index}
        self._nonnegative = self._positive | {
            self._index["parameter", name] for name in nonnegative if ("parameter", name) in self._index
        }
        self.assumed: list[Polynomial] = []  # what is known to be positive besides
        self._independent: set[int] = set()  # nested roots whose normal forms are unique
        self._jumps: dict[int, set[str]] = {}  # signs, and what they move with: they have no derivatives
        self._relations: list[tuple[tuple[tuple[int, int], ...], Polynomial]] = []
        self._derivatives: dict[str, dict[int, Polynomial]] = {}
        self.angles = dict(angles)
        self.typed = frozenset(typed)
        self._declare_angles()

    def _declare_angles(self) -> None:
        moving = {g.name for g in self.generators if g.kind in ("coordinate", "prescribed", "time")}
        for name in sorted(moving):
            kind = "coordinate" if ("coordinate", name) in self._index else "prescribed"
            index = self._index["time", "t"] if name == "t" else self._index[kind, name]
            self._derivatives[name] = {index: self.one}
            if kind == "coordinate":  # loads may hold functions of velocities: exp(q'), which the chain rule must reach
                self._derivatives[velocity_name(name)] = {self._index["velocity", name]: self.one}
        for name, denominator in self.angles.items():
            s, c = self._index["sine", name], self._index["cosine", name]
            self._relate(((s, 2),), self._gens[s] ** 2 + self._gens[c] ** 2 - 1)
            if name in moving:
                factor = fmpq(1, denominator)
                self._derivatives[name] |= {s: self._gens[c] * factor, c: -self._gens[s] * factor}

    def _relate(self, leading: tuple[tuple[int, int], ...], relation: Polynomial) -> None:
        """Later relations stand first: they may bring in what the earlier ones reduce."""
        self._relations.insert(0, (leading, relation))

    # --- scalars ---------------------------------------------------------------------------------------------------

    def number(self, value: Fraction | int) -> Polynomial:
        value = Fraction(value)
        return self.context.constant(rationals.exact(value))

    def generator(self, kind: str, name: str) -> Polynomial:
        return self._gens[self._index[kind, name]]

    def index(self, kind: str, name: str) -> int:
        return self._index[kind, name]

    def has(self, kind: str, name: str) -> bool:
        return (kind, name) in self._index

    def given(self, values: Mapping[str, Any]) -> dict[int, Polynomial]:
        """The parameters whose values are rational, by their generators, with these."""
        exact = ((name, x) for name, x in values.items() if isinstance(x, Fraction) and self.has("parameter", name))
        return {self.index("parameter", name): self.number(x) for name, x in exact}

    def at_rest(self, x: Polynomial) -> Polynomial:
        """x where all velocities are zero."""
        return self.substitute(x, {k: self.zero for k, g in enumerate(self.generators) if g.kind == "velocity"})

    # --- bounds ------------------------------------------------------------------------------------------------------

    def limit_work(self, most: int) -> None:
        """Lowers the budget of work to ``most`` candidate terms, if it is not lower already."""
        self.work_budget = min(self.work_budget, most)

    @contextmanager
    def budget(self, most: int) -> Iterator[Spent]:
        """Within this block at most so much work is done, counted by itself; what follows is not charged with it."""
        work, limit, spent = self.work, self.work_budget, Spent()
        self.work, self.work_budget = 0, max(most, 0)
        try:
            yield spent
        finally:
            spent.work = self.work
            self.work, self.work_budget = work, limit

    def spend(self, work: int) -> None:
        """Counts work, in candidate terms of products.  Raises NoClosedForm when the budget is used up."""
        self.work += work
        if self.work > self.work_budget:
            raise NoClosedForm(
                "more than [[most]] steps of polynomial arithmetic in all",
                most=self.work_budget,
                limit=Limit.WORK,
            )

    def times(self, a: Polynomial, b: Polynomial) -> Polynomial:
        candidates = len(a) * len(b)
        if candidates > SMALL:
            self.spend(candidates * _check_product(a, b))
        self.work += candidates + self._overhead
        return a * b

    def _check(self, x: Polynomial) -> None:
        if len(x) > self.most_terms:
            raise NoClosedForm(
                "[[count]] terms are beyond the budget of [[most]]",
                count=len(x),
                most=self.most_terms,
                limit=Limit.TERMS,
            )

    def factored(self, x: Polynomial) -> tuple[Any, list[tuple[Polynomial, int]]]:
        """The content of x and its irreducible factors with their exponents, if x is not too long to be factored."""
        if len(x) > MOST_FACTORED:
            raise NoClosedForm(
                "a denominator or root of [[count]] terms: at most [[most]] are factored",
                count=len(x),
                most=MOST_FACTORED,
                limit=Limit.FACTORS,
            )
        self._check(x)
        self.spend(100 * len(x))
        return irreducible_factors(x)

    def common_factor(self, a: Polynomial, b: Polynomial) -> Polynomial:
        """The greatest common divisor; 1, which divides both as well, where they are too long for it."""
        if a.is_zero() or b.is_zero():
            return a + b
        if a.is_constant() or b.is_constant() or max(len(a), len(b)) > MOST_FACTORED:
            return self.one
        self.spend(100 * (len(a) + len(b)))
        return a.gcd(b)

    def lowest_terms(self, x: Polynomial, y: Polynomial) -> tuple[Polynomial, Polynomial]:
        """x and y without what they share, as far as that is found."""
        common = self.common_factor(x, y)
        top, bottom = self.quotient(x, common), self.quotient(y, common)
        return (x, y) if top is None or bottom is None else (top, bottom)

    def vanishes(self, x: Polynomial) -> bool:
        return bool(x.is_zero())

    # --- normal form -------------------------------------------------------------------------------------------------

    def reduce(self, x: Polynomial) -> Polynomial:
        """Normal form: each relation's leading term eliminated, sin^2 -> 1 - cos^2 among them."""
        if not x:
            return x
        if len(x) <= _FEW and (degree := x.total_degree()) <= 1:  # no relation has a leading term like that
            if degree:
                self.spend(len(x) + 8 * self._overhead)
            _check_number(x.leading_coefficient())
            return x
        self._check(x)
        self.spend(len(x) + 8 * self._overhead)
        degrees = x.degrees()
        if max(degrees) > MOST_DEGREE:
            raise NoClosedForm(
                "a formula of degree [[degree]]: at most [[most]] is supported",
                degree=_size(int(max(degrees))),
                most=MOST_DEGREE,
                limit=Limit.DEGREE,
            )
        _check_number(x.leading_coefficient())
        again = True
        while again:
            again = False
            for leading, relation in self._relations:
                for k, d in leading:
                    if degrees[k] < d:
                        break
                else:
                    reduced = self._remainder(x, degrees, leading, relation)
                    if reduced != x:
                        x, degrees, again = reduced, reduced.degrees(), len(self._relations) > len(self.angles)
        return x

    def _remainder(
        self, x: Polynomial, degrees: Sequence[int], leading: Sequence[tuple[int, int]], relation: Polynomial
    ) -> Polynomial:
        """x modulo a relation; step by step where a division at one stroke might grow beyond the budgets.

        The leading term to the power e is replaced by up to comb(e + tail - 1, e) products of the relation's other
        terms.
        """
        highest = min(int(degrees[k]) // d for k, d in leading)
        tail = len(relation) - 1
        growth = comb(highest + tail - 1, highest) if highest + tail < 64 else 2**64
        if len(x) * growth <= 100 * SMALL:
            self.work += len(x) * growth
            return divmod(x, relation)[1]
        exponents = [0] * len(degrees)
        for k, d in leading:
            exponents[k] = d
        lead = self.context.term(exp_vec=tuple(exponents))
        rest = lead - relation / relation.leading_coefficient()
        while highest:
            quotient, remainder = divmod(x, lead**highest)
            if quotient.is_zero():
                highest -= 1
                continue
            x = self.times(self.times(quotient, rest), lead ** (highest - 1)) + remainder
            self._check(x)
            self.spend(len(x))
        return x

    # --- angles ------------------------------------------------------------------------------------------------------

    def sin_cos(self, angle: LinearForm) -> tuple[Polynomial, Polynomial]:
        sine, cosine = self._constant_angle(angle.turns)
        for name, coefficient in angle.coefficients:
            if not coefficient:
                continue
            multiple = coefficient * self.angles.get(name, 0)  # 0: no sine or cosine of it was foreseen
            if multiple.denominator != 1 or not multiple:
                raise NoClosedForm(
                    "sin and cos of [[coefficient]]*[[name]] were not foreseen", coefficient=coefficient, name=name
                )
            s, c = self.multiple_angle(self.generator("sine", name), self.generator("cosine", name), int(multiple))
            sine, cosine = self.sum_of_angles(sine, cosine, s, c)
        return self.reduce(sine), self.reduce(cosine)

    def adds_constant(self, angle: LinearForm) -> bool:
        """Where the sines and cosines of all its names were foreseen."""
        multiples = [coefficient * self.angles.get(name, 0) for name, coefficient in angle.coefficients]
        return bool(multiples) and all(multiple and multiple.denominator == 1 for multiple in multiples)

    def sum_of_angles(
        self, s: Polynomial, c: Polynomial, other_s: Polynomial, other_c: Polynomial
    ) -> tuple[Polynomial, Polynomial]:
        """sin and cos of a sum of two angles, not reduced."""
        sine = self.times(s, other_c) + self.times(c, other_s)
        return sine, self.times(c, other_c) - self.times(s, other_s)

    def multiple_angle(self, s: Polynomial, c: Polynomial, n: int) -> tuple[Polynomial, Polynomial]:
        """sin(n x) and cos(n x) from s = sin x and c = cos x, by doubling."""
        if abs(n) > MOST_MULTIPLE:
            raise NoClosedForm(
                "sin and cos of [[n]] times an angle: at most [[most]] times is supported",
                n=_size(n),
                most=MOST_MULTIPLE,
            )
        sine, cosine = self.zero, self.one
        for digit in f"{abs(n):b}":
            sine, cosine = map(self.reduce, self.sum_of_angles(sine, cosine, sine, cosine))
            if digit == "1":
                sine, cosine = map(self.reduce, self.sum_of_angles(sine, cosine, s, c))
        return (-sine if n < 0 else sine), cosine

    def _constant_angle(self, turns: Fraction) -> tuple[Polynomial, Polynomial]:
        """sin and cos of turns*pi: made of square roots for pi/4, pi/5, pi/6, pi/8, pi/10, pi/12 and their multiples.

        Other fractions of pi are named constants: sin(pi/7) and cos(pi/7), related by s^2 + c^2 = 1.
        """
        turns = turns % 2
        if turns >= 1:
            s, c = self._constant_angle(turns - 1)
            return -s, -c
        if turns > Fraction(1, 2):
            s, c = self._constant_angle(1 - turns)
            return s, -c
        if turns == 0:
            return self.zero, self.one
        made = {4: self._eighth_turn, 5: self._tenth_turn, 6: self._twelfth_turn, 8: self._sixteenth_turn}
        made |= {10: self._twentieth_turn, 12: self._twenty_fourth_turn}
        if turns.denominator in (1, 2, 3, *made):
            if turns > Fraction(1, 4):
                s, c = self._constant_angle(Fraction(1, 2) - turns)
                return c, s
            return made[turns.denominator]()  # up to pi/4 their numerators are 1
        several = turns.numerator if turns.numerator <= _MOST_OF_A_NAMED_ANGLE else 1
        step = turns / several
        angle = self.generator("parameter", "pi") * rationals.exact(step)
        known = self._adjoined("sine", angle) is not None
        s, c = self._own_angle(angle)
        if not known and step.numerator == 1:
            self._relate_cosine(c, step.denominator)
        return self.multiple_angle(s, c, several)

    def _relate_cosine(self, c: Polynomial, n: int) -> None:
        """The minimal polynomial of 2 cos(pi/n), where it is short: 8 c^3 - 4 c^2 - 4 c + 1 = 0 for n = 7."""
        if n > _MOST_RELATED:
            return
        minimal, relation = fmpz_poly.cos_minpoly(2 * n), self.zero
        for exponent, coefficient in enumerate(minimal.coeffs()):
            relation = relation + (2 * c) ** exponent * fmpq(coefficient)
        index = next(k for k, degree in enumerate(c.degrees()) if degree > 0)
        self._relate(((index, minimal.degree()),), relation)

    def _eighth_turn(self) -> tuple[Polynomial, Polynomial]:
        """pi/4: sin = cos = sqrt(2)/2."""
        return (self.square_root(self.number(2)) * fmpq(1, 2),) * 2

    def _twelfth_turn(self) -> tuple[Polynomial, Polynomial]:
        """pi/6: sin = 1/2, cos = sqrt(3)/2."""
        return self.number(Fraction(1, 2)), self.square_root(self.number(3)) * fmpq(1, 2)

    def _twenty_fourth_turn(self) -> tuple[Polynomial, Polynomial]:
        """pi/12: sin = (sqrt(6) - sqrt(2))/4, cos = (sqrt(6) + sqrt(2))/4."""
        two, three = self.square_root(self.number(2)), self.square_root(self.number(3))
        six = self.times(two, three)
        return (six - two) * fmpq(1, 4), (six + two) * fmpq(1, 4)

    def _sixteenth_turn(self) -> tuple[Polynomial, Polynomial]:
        """pi/8: cos = sqrt(2 + sqrt(2))/2, sin = (sqrt(2) - 1) cos."""
        two = self.square_root(self.number(2))
        cosine = self._cyclic_root(two + 2) * fmpq(1, 2)
        return self.times(two - 1, cosine), cosine

    def _tenth_turn(self) -> tuple[Polynomial, Polynomial]:
        """pi/5: sin = sqrt(10 - 2 sqrt(5))/4, cos = (1 + sqrt(5))/4."""
        five = self.square_root(self.number(5))
        return self._cyclic_root(10 - 2 * five) * fmpq(1, 4), (five + 1) * fmpq(1, 4)

    def _twentieth_turn(self) -> tuple[Polynomial, Polynomial]:
        """pi/10: sin = (sqrt(5) - 1)/4, cos = sqrt(10 + 2 sqrt(5))/4 = sqrt(10 - 2 sqrt(5)) (1 + sqrt(5))/8."""
        five = self.square_root(self.number(5))
        return (five - 1) * fmpq(1, 4), self.times(self._cyclic_root(10 - 2 * five), five + 1) * fmpq(1, 8)

    def _cyclic_root(self, radicand: Polynomial) -> Polynomial:
        """sqrt(2 + sqrt(2)) or sqrt(10 - 2 sqrt(5)), whose independence of all other square roots is known.

        Each generates a field that is cyclic of degree 4 over the rationals and has one quadratic subfield, with
        sqrt(2) or sqrt(5).  So the two are disjoint, and with roots of primes they have in common only sqrt(2) and
        sqrt(5) (nothing else of a group Z4 x Z4 is elementary): a normal form in all of them vanishes only as zero.
        """
        root = self._root(radicand)
        index = next(k for k, degree in enumerate(root.degrees()) if degree > 0)
        self._independent.add(index)
        self._positive.add(index)
        return root

    def sin_cos_of(self, argument: Polynomial) -> tuple[Polynomial, Polynomial]:
        """sin and cos of whatever stands under them; what is a multiple of pi after all (w x at x = pi/w) is known."""
        form = None if argument.is_zero() else self._foreseen(argument)
        return self._own_angle(argument) if form is None else self.sin_cos(form)

    def _own_angle(self, argument: Polynomial) -> tuple[Polynomial, Polynomial]:
        """An angle of its own, such as ``Omega*t`` or ``7/10``: two adjoined generators with the chain rule."""
        if argument.is_zero():
            return self.zero, self.one
        constant = self.constant_value(argument)
        if constant is not None and constant < 0:
            s, c = self._own_angle(-argument)
            return -s, c
        if parts := self._arc_tangents(argument):
            return self._with_arc_tangents(argument, parts)
        index = self._adjoined("sine", argument)
        if index is None:
            c = self._adjoin("cosine", argument)
            index = s = self._adjoin("sine", argument)  # adjoined later, so that it leads s^2 + c^2 - 1
            self._relate(((s, 2),), self._gens[s] ** 2 + self._gens[c] ** 2 - 1)
            if constant is not None:
                with ctx.workprec(_CONSTANT_BITS):
                    self._positive |= {k for k, x in ((s, constant.sin()), (c, constant.cos())) if x > 0}
            for name in self._derivatives:
                inner = self.derivative(argument, name)
                if not inner.is_zero():
                    self._derivatives[name] |= {
                        s: self.times(self._gens[c], inner),
                        c: -self.times(self._gens[s], inner),
                    }
        return self._gens[index], self._gens[index + 1]

    def _arc_tangents(self, angle: Polynomial) -> list[tuple[int, int]]:
        """(generator of atan x, n) for every n atan x, n a whole number, that an angle is a sum of."""
        arc_tangents = []
        for monomial, coefficient in angle.terms():
            present = [k for k, exponent in enumerate(monomial) if exponent]
            if len(present) == 1 and monomial[present[0]] == 1 and int(coefficient.q) == 1:
                g = self.generators[present[0]]
                if g.kind == "function" and g.name == "atan":
                    arc_tangents.append((present[0], int(coefficient.p)))
        return arc_tangents

    def _with_arc_tangents(self, angle: Polynomial, parts: Sequence[tuple[int, int]]) -> tuple[Polynomial, Polynomial]:
        """sin and cos by the addition theorems and  cos(atan x) = 1/sqrt(1 + x^2),  sin(atan x) = x/sqrt(1 + x^2)."""
        rest = angle
        for index, n in parts:
            rest = rest - self._gens[index] * n
        form = self._foreseen(rest)
        sine, cosine = self.sin_cos_of(rest) if form is None else self.sin_cos(form)
        for index, n in parts:
            top, denominators = self.fraction(self.generators[index].argument)
            bottom = self.one
            for factor, exponent in denominators:
                bottom = self.times(bottom, self._power(factor, exponent))
            if not self.is_positive(bottom):  # |bottom| would be needed
                top, bottom = self.generators[index].argument, self.one
            square = self.reduce(self.times(top, top) + self.times(bottom, bottom))
            inverse = self.times(self.square_root(square), self.reciprocal(square))
            s, c = self.multiple_angle(self.times(top, inverse), self.times(bottom, inverse), n)
            sine, cosine = self.sum_of_angles(sine, cosine, s, c)
        return self.reduce(sine), self.reduce(cosine)

    def _foreseen(self, angle: Polynomial) -> LinearForm | None:
        """An angle that is made of multiples of pi and of names whose sines are there; None for any other."""
        coefficients, turns = [], Fraction(0)
        for monomial, coefficient in angle.terms():
            present = [k for k, exponent in enumerate(monomial) if exponent]
            if len(present) != 1 or monomial[present[0]] != 1:
                return None
            g, factor = self.generators[present[0]], rationals.fraction(coefficient)
            if g.name == "pi":
                turns = factor
            elif g.argument is None and g.kind in ("coordinate", "prescribed", "parameter") and g.name in self.angles:
                coefficients.append((g.name, factor))
            else:
                return None
        form = LinearForm(tuple(coefficients), turns)
        whole = (factor * self.angles[name] for name, factor in coefficients)
        return form if all(multiple.denominator == 1 for multiple in whole) else None

    def constant_value(self, x: Polynomial) -> arb | None:
        """An enclosure of what is a number (made of numbers, pi, and roots, sines ... of such), or None."""
        try:
            with ctx.workprec(_CONSTANT_BITS):
                return self.evaluate(x, {})
        except KeyError:  # it has a name without a value: it is no constant
            return None

    # --- adjoined elements -------------------------------------------------------------------------------------------

    @property
    def adjoined(self) -> int:
        """How many reciprocals, roots and functions there are so far."""
        return self.spare - 1 - self._free

    def _adjoin(self, kind: str, argument: Polynomial, name: str = "") -> int:
        if self._free < 0:
            raise NoClosedForm(
                "more than [[most]] reciprocals, roots and functions", most=self.spare, limit=Limit.FUNCTIONS
            )
        index = self._free
        self._free -= 1
        self.generators[index] = Generator(kind, name or f"#{index}", 1, argument)
        return index

    def _adjoined(self, kind: str, argument: Polynomial, name: str = "") -> int | None:
        for index in range(self._free + 1, self.spare):
            known = self.generators[index]
            if known.kind == kind and (not name or known.name == name) and known.argument == argument:
                return index
        return None

    def _chain(self, index: int, outer: Polynomial, argument: Polynomial) -> None:
        """d generator = outer * d argument, for every variable."""
        for name in self._derivatives:
            inner = self.derivative(argument, name)
            if not inner.is_zero():
                self._derivatives[name][index] = self.reduce(self.times(outer, inner))

    def reciprocal(self, x: Polynomial) -> Polynomial:
        """1/x, one adjoined generator for each irreducible factor of x.

        Raises SingularPoint if x is zero.
        """
        x = self.reduce(x)
        if x.is_zero():
            raise SingularPoint("division by zero")
        content, factors = self.factored(x)
        result = self.context.constant(1 / content)
        for factor, exponent in factors:
            result = self.times(result, self._power(self._reciprocal_of_factor(factor), exponent))
        return self.reduce(result)

    def _reciprocal_of_factor(self, factor: Polynomial) -> Polynomial:
        inverse = self._inverse_of_adjoined(factor)
        if inverse is not None:
            return inverse
        index = self._adjoined("reciprocal", factor)
        if index is None:
            index = self._adjoin("reciprocal", factor)
            generator = self._gens[index]
            leading = tuple((k, e) for k, e in enumerate(factor.monomial(0)) if e)
            self._relate((*leading, (index, 1)), self.times(factor, generator) - 1)
            self._chain(index, -(generator**2), factor)
            if self.is_positive(factor):
                self._positive.add(index)
        return self._gens[index]

    def _inverse_of_adjoined(self, factor: Polynomial) -> Polynomial | None:
        """1/(1/p) = p and 1/sqrt(p) = sqrt(p)/p need no generator of their own."""
        for index in range(self._free + 1, self.spare):
            if factor == self._gens[index]:
                known = self.generators[index]
                if known.kind == "reciprocal":
                    return known.argument
                if known.kind == "root":
                    return self.times(self._gens[index], self.reciprocal(known.argument))
        return None

    def _power(self, x: Polynomial, exponent: int) -> Polynomial:
        """x**exponent, not reduced: powers of a monomial at once, others product by product within the budgets."""
        if len(x) <= 1:
            return x**exponent
        result = self.one
        for _ in range(exponent):
            result = self.times(result, x)
            self._check(result)
        return result

    def square_root(self, x: Polynomial) -> Polynomial:
        """sqrt(x): squares of positive factors come out exactly, the rest is adjoined with rho^2 = rest."""
        x = self.reduce(x)
        if x.is_zero():
            return self.zero
        content, factors = self.factored(x)
        outside, inside, numbers = self.one, self.one, rationals.fraction(content)
        for factor, exponent in factors:
            size = (
                factor if self.is_positive(factor) else -factor if self.assumed and self.is_positive(-factor) else None
            )
            if size is not None:
                outside = self.times(outside, self._power(size, exponent // 2))
                exponent = exponent % 2
            inside = self.times(inside, self._power(factor, exponent))
        rational, radicand = _square_part(abs(numbers))
        outside = outside * self.number(rational)
        if inside.is_constant():
            if numbers < 0:
                raise SingularPoint("the square root of a negative number")
            for prime in _primes(radicand):
                outside = self.times(outside, self._root(self.number(prime)))
            return self.reduce(outside)
        sign = -1 if numbers < 0 else 1
        return self.reduce(self.times(outside, self._root(inside * (sign * radicand))))

    def _root(self, radicand: Polynomial) -> Polynomial:
        index = self._adjoined("root", radicand)
        if index is None:
            index = self._adjoin("root", radicand)
            root = self._gens[index]
            self._relate(((index, 2),), root**2 - radicand)
            if any(not self.derivative(radicand, name).is_zero() for name in self._derivatives):
                self._chain(index, self.times(root, self.reciprocal(radicand)) * fmpq(1, 2), radicand)
        return self._gens[index]

    def function(self, name: str, x: Polynomial) -> Polynomial:
        """exp and log and their kin, as adjoined generators whose derivatives are the textbook's."""
        if name in ("sinh", "cosh", "tanh"):
            up = self.function("exp", x)
            down = self.function("exp", -x)
            half = fmpq(1, 2)
            sinh, cosh = (up - down) * half, (up + down) * half
            return {"sinh": sinh, "cosh": cosh}.get(name) or self.ratio(sinh, cosh)
        if name in ("abs", "sign"):
            return self._absolute(x) if name == "abs" else self._sign(x)
        if isinstance(name, Tabulated):
            return self._tabulated(name, x)
        if x.is_zero() and name in ("exp", "atan"):
            return self.one if name == "exp" else self.zero
        if x.is_one() and name == "log":
            return self.zero
        if name == "exp" and self._adjoined("function", -x, "exp") is not None:
            return self.reciprocal(self.function("exp", -x))
        index = self._adjoined("function", x, name)
        if index is None:
            index = self._adjoin("function", x, name)
            moving = any(not self.derivative(x, variable).is_zero() for variable in self._derivatives)
            if moving:
                outer = {
                    "exp": lambda: self._gens[index],
                    "log": lambda: self.reciprocal(x),
                    "atan": lambda: self.reciprocal(self.one + self.times(x, x)),
                }[name]()
                self._chain(index, outer, x)
        return self._gens[index]

    def _sign(self, x: Polynomial) -> Polynomial:
        """sign(x), adjoined where x may have either sign; it has no derivative, for nobody says where x vanishes.

        Nothing is said about sign(0), which formulas meet at rest only: dry friction holds with any force there up to a
        bound.  There is no relation s^2 = 1 either, which is wrong at the jump.  Raises NoClosedForm for x = 0.
        """
        x, constant = self.reduce(x), self.constant_value(x)
        if x.is_zero():
            raise NoClosedForm("a sign at its jump: the sign of 0")
        if self.is_positive(x) or (constant is not None and constant > 0):
            return self.one
        if self.is_positive(-x) or (constant is not None and constant < 0):
            return -self.one
        if x.leading_coefficient() < 0:
            return -self._sign(-x)
        index = self._adjoined("function", x, "sign")
        if index is None:
            index = self._adjoin("function", x, "sign")
            self._jumps[index] = {name for name in self._derivatives if not self.derivative(x, name).is_zero()}
        return self._gens[index]

    def _tabulated(self, name: Tabulated, x: Polynomial) -> Polynomial:
        """A curve at x, adjoined; its derivative is the next curve, until one jumps, which has none.

        Nothing is said about its values: what vanishes for these points only is not known to vanish.
        """
        x = self.reduce(x)
        if x.is_constant() or name.curve.constant is not None:
            at = x.leading_coefficient() if x.is_constant() and x else fmpq(0)
            return self.number(name.curve(rationals.fraction(at)))
        index = self._adjoined("function", x, name)
        if index is None:
            moving = {variable for variable in self._derivatives if not self.derivative(x, variable).is_zero()}
            smooth = name.curve.smoothness >= 0
            outer = self._tabulated(name.slope, x) if moving and smooth else self.zero
            index = self._adjoin("function", x, name)
            if moving and smooth:
                self._chain(index, outer, x)
            elif moving:
                self._jumps[index] = moving
        return self._gens[index]

    @property
    def kinked(self) -> bool:
        """Whether formulas hold a sign, modulus or table that may have either side: they may vanish on one side alone,
        so that no number of states shows that they vanish.
        """
        return any(g.kinked for g in self.generators[: self.spare])

    def _absolute(self, x: Polynomial) -> Polynomial:
        """|x| with |x|^2 = x^2 and d|x| = sign(x) dx."""
        x = self.reduce(x)
        if x.is_zero():
            return x
        if x.leading_coefficient() < 0:
            x = -x
        constant = self.constant_value(x)
        if self.is_positive(x) or (constant is not None and constant > 0):
            return x
        if constant is not None and constant < 0:
            return -x
        index = self._adjoined("function", x, "abs")
        if index is None:
            moving = any(not self.derivative(x, name).is_zero() for name in self._derivatives)
            outer = self._sign(x) if moving else self.zero
            index = self._adjoin("function", x, "abs")
            self._relate(((index, 2),), self._gens[index] ** 2 - self.times(x, x))
            if moving:
                self._chain(index, outer, x)
        return self._gens[index]

    def is_positive(self, x: Polynomial) -> bool:
        """Whether x is a sum of terms that are not negative, one of them positive: sufficient, never wrong.

        Or a positive multiple of something that is assumed to be positive.
        """
        nonnegative = self._nonnegative | self._positive
        return (
            all(
                coefficient > 0 and all(k in nonnegative or e % 2 == 0 for k, e in enumerate(monomial) if e)
                for monomial, coefficient in x.terms()
            )
            and any(all(k in self._positive for k, e in enumerate(monomial) if e) for monomial in x.monoms())
        ) or any((ratio := rational_ratio(x, assumption)) is not None and ratio > 0 for assumption in self.assumed)

    # --- derivation --------------------------------------------------------------------------------------------------

    def derivative(self, x: Polynomial, name: str) -> Polynomial:
        """Partial derivative with respect to a coordinate, a prescribed quantity or t, chain rule included.

        Raises NoClosedForm for what jumps there.
        """
        slopes = self._derivatives[name]
        if len(slopes) == 1 and not self._jumps:  # nothing but the variable itself holds it
            return x.derivative(*slopes)
        total = self.zero
        degrees = x.degrees()
        if any(degrees[index] > 0 and name in moving for index, moving in self._jumps.items()):
            raise NoClosedForm("the derivative of a function with a jump")
        for index, inner in slopes.items():
            if degrees[index] > 0:
                total = total + self.times(x.derivative(index), inner)
        return self.reduce(total)

    def velocity_derivative(self, x: Polynomial, name: str) -> Polynomial:
        """Partial derivative with respect to the velocity of a coordinate."""
        return self.derivative(x, velocity_name(name))

    def held(self, polynomials: Iterable[Polynomial]) -> set[int]:
        """The generators of polynomials, and those in what the adjoined ones among them hold."""
        pending, generators = list(occurring(polynomials)), set[int]()
        while pending:
            index = pending.pop()
            if index not in generators:
                generators.add(index)
                argument = self.generators[index].argument
                pending += [] if argument is None else occurring([argument])
        return generators

    def depends_on(self, x: Polynomial, name: str) -> bool:
        """Whether a coordinate, a prescribed quantity or t occurs (plainly, under sin and cos, or adjoined)."""
        return bool(self.dependencies(x, (name,)))

    def dependencies(self, x: Polynomial, names: Iterable[str]) -> tuple[str, ...]:
        """Which of the names x depends on."""
        if x.is_constant():
            return ()
        degrees = x.degrees()
        jumping = [moving for index, moving in self._jumps.items() if degrees[index] > 0]
        return tuple(
            name
            for name in names
            if any(degrees[index] > 0 for index in self._derivatives[name]) or any(name in moving for moving in jumping)
        )

    # --- substitution ------------------------------------------------------------------------------------------------

    def substitute(self, x: Polynomial, values: Mapping[int, Polynomial]) -> Polynomial:
        """Generators replaced by polynomials, adjoined ones rebuilt from their arguments at the new place.

        Raises SingularPoint where a reciprocal's argument vanishes there.
        """
        return self._substitute(x, dict(values))

    def _substitute(self, x: Polynomial, images: dict[int, Polynomial]) -> Polynomial:
        degrees = x.degrees()
        for index in range(self.spare - 1, self._free, -1):
            if degrees[index] > 0 and index not in images:
                images[index] = self._moved(index, images)
        touched = [index for index in images if degrees[index] > 0]
        constant = [index for index in touched if images[index].is_constant()]
        for index in constant:  # the remainder modulo g - number puts the number for g, faster than a composition
            x = divmod(x, self._gens[index] - images[index])[1]
        touched = [index for index in touched if index not in constant and x.degrees()[index] > 0]
        if not touched:
            return self.reduce(x) if constant else x
        if len(touched) == 1 and x.degrees()[touched[0]] == 1:  # rings of many generators compose slowly
            generator, slope = self._gens[touched[0]], x.derivative(touched[0])
            rest = x - self.times(slope, generator)
            return self.reduce(rest + self.times(slope, images[touched[0]]))
        full = list(self._gens)
        for index in touched:
            full[index] = images[index]
        self._check_substitution(x, touched, images)
        return self.reduce(x.compose(*full))

    def _check_substitution(self, x: Polynomial, touched: Sequence[int], images: Mapping[int, Polynomial]) -> None:
        """Raises NoClosedForm if the substituted polynomial may be too long or of too high a degree."""
        self.spend(len(x) + 40 * self._overhead)
        degrees = x.degrees()
        grown, terms, powers = 0, len(x), 1
        for index in touched:
            degree, length = int(degrees[index]), len(images[index])
            grown = max(grown, degree * max(0, *map(int, images[index].degrees())))
            powers *= comb(degree + length - 1, degree) if degree + length < 64 or length == 1 else 2**64
        if grown > MOST_DEGREE:
            raise NoClosedForm(
                "a substitution makes a formula of degree [[grown]]: up to [[most]] is supported",
                grown=_size(grown),
                most=MOST_DEGREE,
            )
        if terms * powers <= SMALL:
            return
        spans = [0 if k in images else max(0, int(degree)) for k, degree in enumerate(degrees)]
        for index in touched:
            for k, degree in enumerate(images[index].degrees()):
                spans[k] += int(degrees[index]) * max(0, int(degree))
        dense = 1
        for span in spans:
            dense = min(dense * (1 + span), 2**64)
        candidates, each = min(terms * powers, terms * dense), _bytes(x, max(spans))
        if candidates > PRODUCT_BUDGET or min(candidates, dense) * each > MEMORY_BUDGET:  # the same again, term by term
            self.spend(10 * terms)
            lengths = [(index, len(images[index])) for index in touched]
            candidates = sum(min(dense, _expanded(monomial, lengths)) for monomial in x.monoms())
        if candidates > PRODUCT_BUDGET or min(candidates, dense) * each > MEMORY_BUDGET:
            raise NoClosedForm(
                "a substitution into [[terms]] terms may lead to [[candidates]]",
                terms=terms,
                candidates=_size(candidates),
                limit=Limit.WORK,
            )
        self.spend(candidates)

    def _moved(self, index: int, images: dict[int, Polynomial]) -> Polynomial:
        known = self.generators[index]
        argument = self._substitute(known.argument, images)
        if argument == known.argument:
            return self._gens[index]
        if known.kind == "reciprocal":
            return self.reciprocal(argument)
        if known.kind == "root":
            return self.square_root(argument)
        if known.kind == "function":
            return self.function(known.name, argument)
        return self.sin_cos_of(argument)[0 if known.kind == "sine" else 1]

    # --- zero test ---------------------------------------------------------------------------------------------------

    def fraction(
        self, x: Polynomial, retained: Collection[int] = ()
    ) -> tuple[Polynomial, list[tuple[Polynomial, int]]]:
        """(numerator, [(factor, exponent), ...]) with x = numerator / product: reciprocals cleared, gcds removed.

        Reciprocals that are ``retained`` stay in the numerator.
        """
        denominators: list[tuple[Polynomial, int]] = []
        x = self.reduce(x)
        degrees = x.degrees()
        for index in range(self._free + 1, self.spare):
            known = self.generators[index]
            degree = int(degrees[index])
            if known.kind != "reciprocal" or degree <= 0 or index in retained:
                continue
            x = self.reduce(self._cleared(x, index, degree, known.argument))
            while degree and x and (quotient := self.quotient(x, known.argument)) is not None:
                x, degree = quotient, degree - 1
            if degree:
                denominators.append((known.argument, degree))
            degrees = x.degrees()
        return x, denominators

    def _cleared(self, x: Polynomial, index: int, degree: int, argument: Polynomial) -> Polynomial:
        """x * argument**degree, where the generator of that index is 1/argument: Horner's scheme."""
        parts: list[dict[tuple[int, ...], Any]] = [{} for _ in range(degree + 1)]
        for monomial, coefficient in x.terms():
            exponents = list(monomial)
            power, exponents[index] = int(exponents[index]), 0
            parts[power][tuple(exponents)] = coefficient
        total = self.zero
        for part in parts:
            total = self.times(total, argument) + self.context.from_dict(part)
            self._check(total)
        return total

    def quotient(self, x: Polynomial, y: Polynomial) -> Polynomial | None:
        """x/y if that is a polynomial: decided without a remainder, which could be longer than both."""
        if len(x) < 1 or any(a < b for a, b in zip(x.degrees(), y.degrees(), strict=True)):
            return None if len(x) else x
        self.spend(len(x) + len(y))
        try:
            return x / y
        except DomainError:
            return None

    def is_number(self, x: Polynomial) -> bool:
        """Whether x holds nothing but sines, roots and functions of numbers."""
        held = (self.generators[k] for k in occurring([x]))
        return all(g.argument is not None and g.argument.is_constant() for g in held)

    def is_zero(self, x: Polynomial) -> bool | None:
        """True (proved zero), False (proved different from zero), or None where this ring cannot decide.

        Sines, cosines, reciprocals and roots of primes (and of 2 + sqrt(2), 10 - 2 sqrt(5)) are decided algebraically.
        Behind other adjoined elements, sines of constants among them,
        (sqrt((1 + cos x)^2), log(exp x), sin(x + 1)) a nonzero normal form may hide a zero: there only balls at random
        points prove "nonzero".
        """
        numerator, _ = self.fraction(x)
        if numerator.is_zero():
            return True
        degrees = numerator.degrees()
        adjoined = [(k, g) for k, g in enumerate(self.generators[: self.spare]) if degrees[k] > 0]
        if all(k in self._independent or (g.kind == "root" and g.argument.is_constant()) for k, g in adjoined):
            return False
        return False if self._nonzero_at_random(numerator) else None

    def _nonzero_at_random(self, x: Polynomial) -> bool:
        """Whether a ball at some random point excludes zero."""
        source = random.Random(20240229)
        free = {g.name for k, g in enumerate(self.generators) if k not in self._nonnegative}
        with ctx.workprec(400):
            for attempt in range(8 if self.kinked else 4):
                values = {name: fmpq(source.randint(1, 99), 64) for name in self.names()}
                if attempt > 3:  # beyond kinks formulas are others
                    signs = {name: source.choice((1, -1)) for name in values if name in free}
                    values |= {name: sign * values[name] for name, sign in signs.items()}
                value = self.evaluate(x, values)
                if not value.contains(0) and value.is_finite():
                    return True
        return False

    def names(self) -> list[str]:
        """The keys that ``evaluate`` wants: declared names and ``<name>_dot``, ``<name>_ddot``."""
        plain = ("coordinate", "prescribed", "time", "parameter", "velocity", "acceleration")
        return [g.name + ENDINGS.get(g.kind, "") for g in self.generators if g.kind in plain and g.name != "pi"]

    def evaluate(self, x: Polynomial, values: Mapping[str, Any]) -> Any:
        """The value as a ball (``arb``, working precision ``flint.ctx.prec``) at numbers for all names."""
        return _Evaluation(self, values)(x)


class ParameterRing(Ring):
    """The part of a ring that holds only some parameters: short exponent vectors, no relations.

    What concerns parameters alone (conditions, discriminants) is an order of magnitude faster here.  ``indices`` are
    generators of ``whole``, all of kind parameter; ``project`` carries polynomials over.
    """

    def __init__(self, whole: Ring, indices: Sequence[int]) -> None:
        if any(whole.generators[k].kind != "parameter" for k in indices):
            raise ValueError("only parameters can be split off")
        self.whole = whole
        self.most_terms = whole.most_terms
        self.work, self.work_budget, self._overhead = whole.work, whole.work_budget, 20
        self.spare, self._free = 0, -1
        self.indices = tuple(indices)
        self.generators = [whole.generators[k] for k in indices]
        self.context = fmpq_mpoly_ctx.get([f"x{k}" for k in indices], Ordering.lex)
        self._gens = self.context.gens()
        self._index = {(g.kind, g.name): k for k, g in enumerate(self.generators)}
        self.zero, self.one = self.context.constant(0), self.context.constant(1)
        self._positive = {self.indices.index(k) for k in whole._positive if k in self.indices}
        self._nonnegative = {self.indices.index(k) for k in whole._nonnegative if k in self.indices}
        self._relations, self._derivatives, self.angles, self._independent = [], {}, {}, set()
        self.assumed = [self.project(x) for x in whole.assumed if set(occurring([x])) <= set(self.indices)]
        self._jumps = {}
        self.typed = frozenset()

    def project(self, x: Polynomial) -> Polynomial:
        """A polynomial of the whole ring in these parameters only."""
        return x.project_to_context(self.context)

    def lift(self, x: Polynomial) -> Polynomial:
        """A polynomial of this ring in the whole ring."""
        return x.project_to_context(self.whole.context)


class _Evaluation:
    """Evaluates polynomials at ball values of the declared names; generators are computed on demand."""

    def __init__(self, ring: Ring, values: Mapping[str, Any]) -> None:
        self.ring = ring
        self.values = values
        self.known: dict[int, Any] = {}

    def __call__(self, x: Polynomial) -> Any:
        total = arb(0)
        used = occurring([x])
        base = {k: self.generator(k) for k in used}
        for monomial, coefficient in x.terms():
            term = arb(coefficient)
            for k in used:
                if monomial[k]:
                    term *= _ball_power(base[k], int(monomial[k]))
            total += term
        return total

    def generator(self, index: int) -> Any:
        if index not in self.known:
            self.known[index] = self._value(self.ring.generators[index])
        return self.known[index]

    def _value(self, g: Generator) -> Any:
        match g.kind:
            case "sine" | "cosine":
                inner = self(g.argument) if g.argument is not None else arb(self.values[g.name]) / g.denominator
                return inner.sin() if g.kind == "sine" else inner.cos()
            case "reciprocal":
                return 1 / self(g.argument)
            case "root":
                return self(g.argument).sqrt()
            case "function":
                return enclosed(g.name, self(g.argument))
            case "velocity":
                return arb(self.values[velocity_name(g.name)])
            case "acceleration":
                return arb(self.values[acceleration_name(g.name)])
        return arb.pi() if g.name == "pi" else arb(self.values[g.name])


def _ball_power(base: Any, exponent: int) -> Any:
    """By squaring: the library's own power goes through the logarithm, which a ball around 0 does not have."""
    result = base if exponent & 1 else arb(1)
    while exponent := exponent >> 1:
        base = base * base
        if exponent & 1:
            result = result * base
    return result


def _check_product(a: Polynomial, b: Polynomial) -> int:
    """The work of one candidate term of a*b, counted by the size of the coefficients.

    Raises NoClosedForm if the product takes too much time or memory.
    """
    candidates = len(a) * len(b)
    if candidates > PRODUCT_BUDGET:
        raise NoClosedForm(
            "a product of [[count]] by [[other]] terms is beyond the budget",
            count=len(a),
            other=len(b),
            limit=Limit.TERMS,
        )
    spans = [max(0, int(d)) + max(0, int(e)) for d, e in zip(a.degrees(), b.degrees(), strict=True)]
    dense = 1
    for span in spans:
        dense = min(dense * (1 + span), candidates)
    first, second = _words(a), _words(b)
    if dense * (_bytes(a, max(spans)) + 8 * (first + second)) > MEMORY_BUDGET:
        raise NoClosedForm(
            "a product of [[count]] by [[other]] terms may need too much memory",
            count=len(a),
            other=len(b),
            limit=Limit.MEMORY,
        )
    return 1 + first * second // 64


def _expanded(monomial: Sequence[int], lengths: Sequence[tuple[int, int]]) -> int:
    """How many terms a monomial becomes when generators are replaced by polynomials of these lengths."""
    total = 1
    for index, length in lengths:
        degree = int(monomial[index])
        if degree and length != 1:
            total *= comb(degree + length - 1, degree) if degree + length < 64 else 2**64
    return total


def _check_number(value: fmpq) -> None:
    """Raises NoClosedForm for a coefficient that nobody could read."""
    bits = int(value.p).bit_length() + int(value.q).bit_length()
    if bits > MOST_COEFFICIENT_BITS:
        raise NoClosedForm(
            "a formula with a number of [[digits]] digits",
            digits=int(bits * 0.30103),
            limit=Limit.DIGITS,
        )


def _bytes(x: Polynomial, degree: int) -> int:
    return term_bytes(x.context().nvars(), degree)


def term_bytes(generators: int, degree: int = 1) -> int:
    """The bytes of one term: exponents are packed into words, at least eight bits each."""
    bits = max(8, degree.bit_length() + 1)
    return 16 + 8 * -(-generators // max(1, 64 // bits))


def _words(x: Polynomial) -> int:
    """The length of a coefficient in machine words, judged by a few of them."""
    places = {0, len(x) // 3, len(x) // 2, len(x) - 1}
    sample = [x.coefficient(k) for k in places]
    return max((int(c.p).bit_length() + int(c.q).bit_length()) // 64 for c in sample)


def _size(value: int | Fraction) -> str:
    """A number for a message: long ones in powers of ten."""
    whole = abs(int(value))
    if whole < 10**15:
        return str(value) if Fraction(value).denominator < 10**15 else "a long fraction"
    return f"about 10**{int(whole.bit_length() * 0.30103)}"


def _square_part(value: Fraction) -> tuple[Fraction, int]:
    """(r, n) with value = r^2 n, n a square-free integer."""
    whole = value.numerator * value.denominator
    outside, inside = 1, 1
    for prime in _primes(whole, distinct=False):
        if inside % prime == 0:
            inside, outside = inside // prime, outside * prime
        else:
            inside *= prime
    return Fraction(outside, value.denominator), inside


def _primes(n: int, distinct: bool = True) -> list[int]:
    """The prime factors of n.  Raises NoClosedForm where they are out of reach."""
    primes: list[int] = []
    for factor, exponent in fmpz(n).factor(trial_limit=_SMALL_PRIMES):
        parts = [(factor, 1)]
        if not factor.is_probable_prime():
            root = factor.isqrt()
            if root * root == factor and root.is_probable_prime():
                parts = [(root, 2)]
            elif int(factor).bit_length() > MOST_BITS:
                digits = int(int(factor).bit_length() * 0.30103) + 1
                raise NoClosedForm(
                    "the square root of a number whose [[digits]] digits cannot be factored",
                    digits=digits,
                    limit=Limit.DIGITS,
                )
            else:
                parts = [(p, int(e)) for p, e in factor.factor()]
        primes += [int(p) for p, e in parts for _ in range(1 if distinct else e * int(exponent))]
    return primes
