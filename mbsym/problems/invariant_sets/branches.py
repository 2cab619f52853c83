"""What holds on one branch of the equations of stationarity: values, remainders, dimensions."""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import islice, product
from typing import Any

from flint import nmod_mat, nmod_poly

from mbsym.algebra.factors import irreducible_factors, occurring
from mbsym.algebra.failures import Limit, NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.signs import ANY, SIGN_SETS, SIGN_WORDS, Signs
from mbsym.algebra.splitting import Branch, Solved
from mbsym.algebra.terms import apart, coefficients_in, modulo
from mbsym.formulas.formula import Formula

# The ring in which problem 10 works: parameters, multipliers and variables as generators without relations.


#: Families of more integrals than this are not looked at.
MOST_INTEGRALS = 5
#: Variables of fields that are looked at.
MOST_VARIABLES = 12
#: Different factors of denominators in the formulas that are shown.
SPARE = 40


@dataclass(frozen=True)
class Arena:
    """Generators by index in ``ring``; the field x' = numerators/denominator, its integrals and relations there.

    ``floating``: so many multipliers, the last ones, belong to relations that alone make integrals of the others (sines
    and cosines of angles): they are Lagrange's, and need not be constant along a motion.  ``beside``: integrals that K
    does not hold, which are constant all the same.
    """

    ring: Ring
    parameters: tuple[int, ...]
    multipliers: tuple[int, ...]
    variables: tuple[int, ...]
    numerators: tuple[Polynomial, ...]
    denominator: Polynomial
    names: tuple[str, ...]
    integrals: tuple[Polynomial, ...]
    relations: tuple[Polynomial, ...]
    signs: Signs
    floating: int = 0
    beside: tuple[Polynomial, ...] = ()

    @property
    def constant(self) -> tuple[int, ...]:
        """The multipliers that are constant along every motion."""
        return self.multipliers[: len(self.multipliers) - self.floating]

    def name(self, index: int) -> str:
        return self.ring.generators[index].name

    def formula(self, numerator: Polynomial, denominator: Polynomial | None = None) -> Formula:
        """numerator/denominator as a formula."""
        ring = self.ring
        whole = Formula(ring, numerator)
        return whole if denominator is None or denominator == 1 else whole / Formula(ring, denominator)

    def derivative(self, p: Polynomial) -> Polynomial:
        """denominator * dp/dt."""
        total = self.ring.zero
        for index, slope in zip(self.variables, self.numerators, strict=True):
            total += p.derivative(index) * slope
        return total


def identifiers(names: Sequence[str], others: Sequence[str]) -> list[str]:
    """``sin_theta`` for sin(theta): names that may stand in every language that is written."""
    plain_names: list[str] = []
    for name in names:
        plain = re.sub(r"\W+", "_", name).strip("_") if not name.isidentifier() else name
        while plain in (*plain_names, *others):
            plain += "_"
        plain_names.append(plain)
    return plain_names


def arena(
    field: PolynomialField,
    integrals: Sequence[tuple[str, Any]],
    signs: Mapping[str, str],
    assumptions: Sequence[tuple[Any, str]] = (),
    floating: int = 0,
) -> Arena:
    """``integrals``: names and polynomials of the field's context; ``signs``: what is declared of parameters, by name;
    ``assumptions``: polynomials of that context in parameters alone, and their relations to 0.

    Raises NoClosedForm where there are too many variables or integrals.
    """
    if len(integrals) > MOST_INTEGRALS:
        raise NoClosedForm(
            "[[count]] integrals: families of at most [[most]] are looked at", count=len(integrals), most=MOST_INTEGRALS
        )
    if len(field.variables) > MOST_VARIABLES:
        raise NoClosedForm(
            "[[count]] variables: families of integrals of at most [[most]] are looked at",
            count=len(field.variables),
            most=MOST_VARIABLES,
        )
    variables = identifiers(field.variables, field.parameters)
    taken = {*field.parameters, *variables}
    count = min(len(integrals), MOST_INTEGRALS) - 1
    stem = next(
        stem
        for stem in ("lambda", "kappa", "multiplier", "lambda_multiplier")
        if not any(f"{stem}{k + 1}" in taken for k in range(count))
    )
    multipliers = tuple(f"{stem}{k + 1}" for k in range(count))
    every = [*field.parameters, *multipliers, *variables]
    positive = [name for name in field.parameters if signs.get(name) == "positive"]
    ring = Ring((), (), every, {}, positive, spare=SPARE)
    index = {name: ring.index("parameter", name) for name in every}
    moved = [ring.generator("parameter", name) for name in (*field.parameters, *variables)]

    def here(p: Any) -> Polynomial:
        return p.compose(*moved, ctx=ring.context)

    words = ["real"] * len(ring.generators)
    for name in field.parameters:
        words[index[name]] = signs.get(name, "real")
    words[ring.index("parameter", "pi")] = "positive"
    return Arena(
        ring,
        tuple(index[name] for name in field.parameters),
        tuple(index[name] for name in multipliers),
        tuple(index[name] for name in variables),
        tuple(here(p) for p in field.numerators),
        here(field.denominator),
        tuple(name for name, _ in integrals),
        tuple(here(p) for _, p in integrals),
        tuple(here(p) for p in field.relations),
        Signs(ring.context, tuple(words), tuple((here(p), relation) for p, relation in assumptions)),
        floating,
    )


#: A prime over which generic points are looked for, and how often.
PRIME = (1 << 31) - 1
ATTEMPTS = 40
#: Degrees in what is eliminated of two polynomials.
MOST_ELIMINATED = 4
#: Numbers that are put in for unknowns of which equations leave a few.
MOST_CASES = 8
#: Longer polynomials are not reduced further.
MOST_TERMS = 3_000


@dataclass(frozen=True)
class Rule:
    """An equation of degree ``degree`` in a generator, whose leading coefficient there is ``leading``."""

    generator: int
    degree: int
    leading: Polynomial
    equation: Polynomial

    def top(self, p: Polynomial, power: int) -> Polynomial:
        """The coefficient of generator^power in p."""
        return apart(p, (self.generator,)).get((power,), p.context().constant(0))

    def applied(self, p: Polynomial) -> Polynomial:
        """p times a power of ``leading``, of a lower degree in the generator than the equation."""
        g = p.context().gen(self.generator)
        if p == 0:
            return p
        while (power := p.degrees()[self.generator]) >= self.degree:
            p = self.leading * p - self.top(p, power) * g ** (power - self.degree) * self.equation
            if len(p) > MOST_TERMS:
                raise NoClosedForm("a polynomial of [[count]] terms", count=len(p), limit=Limit.TERMS)
        return p


@dataclass(frozen=True)
class Place:
    """A branch in its arena, the relations between the variables among its remaining equations."""

    arena: Arena
    branch: Branch
    #: The equations among those that remain which come from the relations between the variables.
    geometric: tuple[Polynomial, ...] = ()

    def never_zero(self, p: Polynomial) -> bool:
        """Whether p vanishes nowhere on the branch.

        It is divided by, its square there vanishes nowhere, or it has no real zeros in common with an equation.
        """
        square, never = self.shortened(p * p), self.arena.signs.never_zero
        if any(q in (p, -p) for q in self._divisors) or (square != 0 and never(square)):
            return True
        for r in self.branch.remaining:
            for g in occurring([p]):
                if 0 < r.degrees()[g] <= MOST_ELIMINATED and len(p) * len(r) <= MOST_ELIMINATED**4:
                    shared = p.resultant(r, g)
                    if shared != 0 and never(shared):
                        return True
        return False

    def sign(self, p: Polynomial) -> str:
        """Of p on the branch: one of ``algebra.signs``, in all its ``cases``."""
        words = {self.arena.signs.sign(images(p)) for images in self.cases}
        return SIGN_WORDS[frozenset().union(*(SIGN_SETS.get(word, ANY) for word in words))]

    @cached_property
    def cases(self) -> tuple[Callable[[Polynomial], Polynomial], ...]:
        """What puts in numbers for unknowns of which an equation such as (cos - 1)(cos + 1) = 0 leaves a few."""
        ring, values = self.arena.ring, {}
        for p in self.branch.remaining:
            factors = [f for f, _ in irreducible_factors(p)[1]]
            held = {g for f in factors for g in occurring([f])}
            if len(held) == 1 and all(f.total_degree() == 1 for f in factors):
                (g,) = held
                x = ring.context.gen(g)
                values[g] = [x - f / f.leading_coefficient() for f in factors]
        gens = ring.context.gens()
        every = [dict(zip(values, some, strict=True)) for some in islice(product(*values.values()), MOST_CASES + 1)]
        if len(every) > MOST_CASES:
            every = [{}]
        return tuple(
            partial(_put, images=[at.get(g, x) for g, x in enumerate(gens)]) if at else _as_it_is for at in every
        )

    @cached_property
    def _divisors(self) -> tuple[Polynomial, ...]:
        """Irreducible polynomials that stand in denominators on the branch."""
        divisors: list[Polynomial] = []
        for p in (*(s.denominator for s in self.branch.solved), self.fraction(self.arena.denominator)[0]):
            divisors += [f for f, _ in irreducible_factors(p)[1] if f not in divisors] if p != 0 else []
        return tuple(divisors)

    @cached_property
    def divided_by(self) -> tuple[Polynomial, ...]:
        """Those of them that do not hold parameters alone."""
        unknown = (*self.arena.multipliers, *self.arena.variables)
        return tuple(f for f in self._divisors if any(f.degrees()[g] > 0 for g in unknown))

    def fixes(self, multiplier: int) -> bool:
        """Whether the state, or what remains, depends on a free multiplier."""
        held = [s for s in self.branch.solved if s.unknown in self.arena.variables]
        polynomials = [p for s in held for p in (s.numerator, s.denominator)]
        return any(p.degrees()[multiplier] > 0 for p in (*polynomials, *self.branch.remaining))

    @cached_property
    def solved(self) -> dict[int, Solved]:
        return {s.unknown: s for s in self.branch.solved}

    @cached_property
    def free_variables(self) -> tuple[int, ...]:
        return tuple(k for k in self.arena.variables if k not in self.solved)

    @cached_property
    def free_multipliers(self) -> tuple[int, ...]:
        return tuple(k for k in self.arena.multipliers if k not in self.solved)

    @cached_property
    def rules(self) -> tuple[Rule, ...]:
        """One for each remaining equation: leading coefficients that are numbers first, then later generators."""
        found: list[Rule] = []
        taken: set[int] = set()
        unknown = (*self.arena.multipliers, *self.arena.variables)
        for p in self.branch.remaining:
            degrees = p.degrees()
            candidates = []
            for rank, g in enumerate(reversed(unknown)):
                if degrees[g] and g not in taken:
                    rule = Rule(g, degrees[g], p.context().constant(1), p)
                    leading = rule.top(p, degrees[g])
                    candidates.append(((not leading.is_constant(), degrees[g], rank), replace(rule, leading=leading)))
            if not candidates:
                continue
            rule = min(candidates, key=lambda item: item[0])[1]
            if rule.leading.is_constant():
                rule = replace(rule, leading=p.context().constant(1), equation=p / rule.leading.leading_coefficient())
            found.append(rule)
            taken.add(rule.generator)
        return tuple(found)

    @cached_property
    def exact_rules(self) -> tuple[Rule, ...]:
        return tuple(rule for rule in self.rules if rule.leading.is_constant())

    def shortened(self, p: Polynomial) -> Polynomial:
        """The same value on the branch, powers taken out by the equations whose leading coefficients are numbers."""
        for _ in range(1 + len(self.exact_rules)):
            before = p
            for rule in self.exact_rules:
                p = rule.applied(p)
            if p == before:
                break
        return p

    def fraction(self, p: Polynomial) -> tuple[Polynomial, Polynomial]:
        """(P, Q), p = P/Q on the branch, without a common factor."""
        top, bottom = p, p.context().constant(1)
        for s in self.branch.solved:
            degree = top.degrees()[s.unknown]
            if degree > 0:
                top = Branch((s,)).numerator(top)
                bottom *= s.denominator**degree
        top = self.shortened(top)
        if top == 0:
            return top, p.context().constant(1)
        common = top.gcd(bottom)
        return top / common, bottom / common

    def vanishes(self, p: Polynomial) -> bool | None:
        """Whether p is zero on the branch; None where that was not decided.

        A value that is not zero at a point modulo a prime decides, and so does a remainder of zero.
        """
        if self.point is not None and evaluate(p, self.point) != 0:
            return False
        try:
            top = self.shortened(self.branch.numerator(p))
            for rule in self.rules * len(self.rules):
                top = rule.applied(top)
        except NoClosedForm:
            return None
        return True if top == 0 else None

    def or_zero(self, p: Polynomial) -> Polynomial:
        """Zero for what vanishes on the branch, though no equation with a number in front takes it out."""
        return p * 0 if self.vanishes(p) is True else p

    @cached_property
    def point(self) -> dict[int, int] | None:
        """A point of the branch over the field of ``PRIME`` elements, by generator; None where none was found."""
        chance = random.Random(len(self.branch.remaining) * 7919 + 17)
        generators = (*self.arena.parameters, *self.arena.multipliers, *self.arena.variables)
        for _ in range(ATTEMPTS):
            values = {g: chance.randrange(2, PRIME) for g in generators}
            point = self._completed(values, chance)
            if point is not None:
                return point
        return None

    def _completed(self, values: dict[int, int], chance: random.Random) -> dict[int, int] | None:
        pending = list(self.rules)
        unset = {rule.generator for rule in pending}
        while pending:
            ready = next((r for r in pending if not self._others(r, unset)), None)
            if ready is None:
                return None
            roots = _roots(ready.equation, ready.generator, values)
            if not roots:
                return None
            values[ready.generator] = chance.choice(roots)
            unset.discard(ready.generator)
            pending.remove(ready)
        for s in self.branch.solved:
            bottom = evaluate(s.denominator, values)
            if bottom == 0:
                return None
            values[s.unknown] = evaluate(s.numerator, values) * pow(bottom, -1, PRIME) % PRIME
        if any(evaluate(p, values) == 0 for p in self.branch.nonzero):
            return None
        return None if any(evaluate(p, values) != 0 for p in self.branch.remaining) else values

    def _others(self, rule: Rule, unset: set[int]) -> bool:
        degrees = rule.equation.degrees()
        return any(degrees[g] for g in unset if g != rule.generator)

    @cached_property
    def dimensions(self) -> tuple[int, int] | None:
        """(for fixed multipliers, of the union over all multipliers), at a generic point; None where none was found."""
        point = self.point
        if point is None:
            return None
        arena = self.arena
        unknown = (*arena.multipliers, *arena.variables)
        rows = [[evaluate(p.derivative(g), point) for g in unknown] for p in self.branch.remaining]
        for s in self.branch.solved:
            p = s.denominator * arena.ring.context.gen(s.unknown) - s.numerator
            rows.append([evaluate(p.derivative(g), point) for g in unknown])
        m, constant = len(arena.multipliers), len(arena.constant)
        whole = len(unknown) - rank(rows)
        fixed = len(unknown) - rank([*rows, *([int(j == i) for j in range(len(unknown))] for i in range(constant))])
        moving = len(unknown) - rank(
            [*rows, *([int(j == m + i) for j in range(len(unknown))] for i in range(len(unknown) - m))]
        )
        return fixed, whole - moving


def _put(p: Polynomial, images: Sequence[Polynomial]) -> Polynomial:
    return p.compose(*images, ctx=p.context())


def _as_it_is(p: Polynomial) -> Polynomial:
    return p


def evaluate(p: Polynomial, values: Mapping[int, int]) -> int:
    """p modulo ``PRIME``."""
    return modulo(p, values, PRIME)


def rank(rows: Sequence[Sequence[int]]) -> int:
    """Over the field of ``PRIME`` elements."""
    if not rows:
        return 0
    return int(nmod_mat(len(rows), len(rows[0]), [x % PRIME for row in rows for x in row], PRIME).rank())


def _roots(p: Polynomial, generator: int, values: Mapping[int, int]) -> list[int]:
    polynomial: Any = nmod_poly([evaluate(c, values) for c in coefficients_in(p, generator)], PRIME)
    if polynomial.degree() < 1:
        return []
    return [
        int(-factor[0] * pow(int(factor[1]), -1, PRIME)) % PRIME
        for factor, _ in polynomial.factor()[1]
        if factor.degree() == 1
    ]
