"""For which parameters are there more integrals: small families of parameters, and a condition within each.

Families put some parameters to zero and some equal to others.  In each, from the most general to the most special,

* more integrals at random parameters modulo a prime are a case of their own;
* otherwise, along random lines in the family, the values at which the rank drops are points of a hypersurface F = 0;
  a polynomial of low degree through sufficiently many of them is found modulo the prime and lifted to QQ.

A case stands in the result when its integrals have been found over QQ(parameters) with its conditions put in, and
proved.  Points at which a more general case has as many integrals are no new case.  The list of cases is not proved to
be complete: hypersurfaces of higher degree, and sets of lower dimension that are no such family, are not looked for.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, product
from math import comb, inf
from typing import Any

from flint import fmpq_mpoly_ctx, nmod_mat

from mbsym.algebra import rationals
from mbsym.algebra.factors import irreducible_factors
from mbsym.algebra.failures import Limit, NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField, in_lowest_terms
from mbsym.expressions.message import Message
from mbsym.problems.polynomial_integrals.excess import Block, Excess, Line, dropped, larger, rational, roots
from mbsym.problems.polynomial_integrals.modular import PRIMES, ModularField, monomials, primitive
from mbsym.problems.polynomial_integrals.result import Case, Cases, PolynomialIntegrals
from mbsym.problems.polynomial_integrals.values import special_of

#: Families that are looked at; the degree of F; the lines that are drawn for one F.
MOST_FAMILIES, MOST_DEGREE, MOST_LINES = 300, 3, 150
#: What a column of a matrix costs, with its share of all that is done with it: about so many seconds.
COLUMN = 1.2e-5
#: Up to so many, those with equalities among real parameters are looked at, too. Of Euler's and Poisson's 75 families
#: 35 would be of this kind (x0 = y0, which turning the axes gives) and take as long again as all others.
FEW_FAMILIES = 40


@dataclass(frozen=True)
class Family:
    """``zero`` parameters, and those that equal an earlier one: ``equal`` = pairs (name, the earlier one)."""

    zero: tuple[str, ...]
    equal: tuple[tuple[str, str], ...]

    def put(self, values: dict[str, int]) -> dict[str, int]:
        completed = dict(values) | dict.fromkeys(self.zero, 0)
        return completed | {name: completed[other] for name, other in self.equal}

    @property
    def bound(self) -> frozenset[str]:
        return frozenset((*self.zero, *(name for name, _ in self.equal)))


def families(field: PolynomialField, positive: Sequence[str]) -> Iterator[Family]:
    """Every choice of zeros among parameters that are not positive, and of equalities among those that are.

    Equal to each other are put those that occur with the same exponents, as moments of inertia do.  Then come, where
    they are not too many, equalities among parameters that are not positive.
    """
    able = [name for name in field.parameters if name not in positive]
    parts, others = _alike(field, positive), _alike(field, able)
    listed: list[Family] = []
    further: list[Family] = []
    for count in range(len(able) + 1):
        for zero in combinations(able, count):
            left = [[name for name in part if name not in zero] for part in others]
            for equal in product(*map(_partitions, parts)):
                listed.append(Family(zero, sum(equal, ())))
                if len(further) <= FEW_FAMILIES:
                    among = (sum(groups, ()) for groups in product(*map(_partitions, left)))
                    further += [Family(zero, listed[-1].equal + pairs) for pairs in among if pairs]
            if len(listed) > 4 * MOST_FAMILIES:
                break
    yield from sorted(listed, key=_size)
    if len(listed) + len(further) <= FEW_FAMILIES:
        yield from sorted(further, key=_size)


def _size(family: Family) -> tuple[int, int]:
    return len(family.zero) + len(family.equal), len(family.zero)


def _alike(field: PolynomialField, names: Sequence[str]) -> list[list[str]]:
    """Parameters by the part that they play; of those that occur as a product only, the first."""
    terms = [m for p in field.numerators for m in p.monoms()]
    columns: dict[tuple[int, ...], str] = {}
    for k, name in enumerate(field.parameters):
        if name in names:
            columns.setdefault(tuple(int(m[k]) for m in terms), name)
    parts: dict[tuple[int, ...], list[str]] = {}
    for column, name in columns.items():
        parts.setdefault(tuple(sorted(set(column))), []).append(name)
    return list(parts.values())


def _partitions(names: Sequence[str]) -> list[tuple[tuple[str, str], ...]]:
    partitions: list[tuple[tuple[str, str], ...]] = [()]
    for k, name in enumerate(names):
        further = []
        for partition in partitions:
            taken = {a for a, _ in partition}
            further += [(*partition, (name, other)) for other in names[:k] if other not in taken]
        partitions += further
    return partitions


def cases(usual: PolynomialIntegrals, positive: Sequence[str], budget: float = inf) -> Cases:
    """The families and hypersurfaces in them on which there are more integrals than ``usual``, each proved.

    No further family is begun when what was looked at has cost ``budget``: counted work, about as many seconds on a
    usual machine, so that the same families are looked at on every one.

    Raises NoClosedForm where the field is not quasi-homogeneous, or where there are too many families.
    """
    field = usual.field
    if not usual.grading.homogeneous or (field.relations and not usual.grading.free):
        raise NoClosedForm("special parameters are looked for where equations are quasi-homogeneous; these are not")
    listed = list(families(field, positive))
    if len(listed) > MOST_FAMILIES:
        message = Message(
            "[[count]] parameters have more than [[most]] families", count=len(field.parameters), most=MOST_FAMILIES
        )
        raise NoClosedForm(message, limit=Limit.WORK, remedy="put in numbers with --set, zeros above all")
    return _Search(usual, positive).found(listed, budget)


class _Search:
    def __init__(self, usual: PolynomialIntegrals, positive: Sequence[str]) -> None:
        self.usual, self.positive = usual, positive
        self.field, self.prime = usual.field, PRIMES[0]
        self.excess = Excess(usual)
        self.known: list[tuple[Case, tuple[int, ...]]] = []
        self.unread = 0
        self.source = random.Random("families")

    def found(self, listed: Sequence[Family], budget: float) -> Cases:
        done = 0
        for family in listed:
            if self.excess.columns * COLUMN > budget:
                break
            done += 1
            there = self._somewhere(family)
            if there is None:
                continue
            signature = self.excess.signature(there)
            below = self._implied(there)
            if larger(signature, below):
                self._add(family, None, signature)
            self._hypersurfaces(family, signature)
        return Cases(self.usual, tuple(case for case, _ in self.known), done, self.unread, len(listed) - done)

    def _somewhere(self, family: Family) -> ModularField | None:
        values = {name: self.source.randrange(1, self.prime) for name in self.field.parameters}
        there = ModularField(self.field, self.prime, family.put(values))
        return there if there.terms(self.field.denominator) else None

    def _implied(self, there: ModularField) -> tuple[int, ...]:
        """The largest excess of cases that this point belongs to."""
        most = self.excess.nothing
        for case, signature in self.known:
            if not any(there.terms(p) for p in case.conditions):
                most = tuple(map(max, most, signature))
        return most

    def _hypersurfaces(self, family: Family, usual: tuple[int, ...]) -> None:
        free = [name for name in self.field.parameters if name not in family.bound]
        if not free:
            return
        points: dict[tuple[int, ...], list[ModularField]] = {}
        read: set[tuple[int, ...]] = set()
        blocks: Sequence[Block] = self.excess.blocks
        self._blocks: list[Block] = []
        degrees = {comb(len(free) + k, k) + 1: k for k in range(1, MOST_DEGREE + 1)}
        for line in range(MOST_LINES):
            for there, signature in self._on_a_line(family, usual, blocks):
                those = points.setdefault(signature, [])
                those.append(there)
                if signature not in read and len(those) in degrees:
                    conditions = self._through(free, those, degrees[len(those)])
                    if conditions or len(those) == max(degrees):
                        read.add(signature)
                        self.unread += not conditions
                    for f in conditions:
                        self._add(family, f, signature)
            if read.issuperset(points) and (points or line):  # a second look: zeros may have been in no prime field
                return
            blocks = self._blocks or blocks  # those that drop are enough
        self.unread += len(points.keys() - read)

    def _on_a_line(
        self, family: Family, usual: tuple[int, ...], blocks: Sequence[Block]
    ) -> list[tuple[ModularField, tuple[int, ...]]]:
        """Points on a random line at which one of the blocks drops, and there is more than in general."""

        def ends() -> dict[str, int]:
            return family.put({name: self.source.randrange(1, self.prime) for name in self.field.parameters})

        line = Line(self.field, self.prime, ends(), ends())
        zeros: dict[int, Block] = {}
        for block in blocks:
            g = dropped(line, self.excess.build(block), self.excess.extra(block))
            for root, _ in roots(g):
                zeros.setdefault(root, block)
        points = []
        for root in sorted(zeros):
            there = line.at(root)
            if there.terms(self.field.denominator):
                signature = self.excess.signature(there)
                if larger(signature, tuple(map(max, usual, self._implied(there)))):
                    points.append((there, signature))
                    if zeros[root] not in self._blocks:
                        self._blocks.append(zeros[root])
        return points

    def _through(self, free: Sequence[str], those: Sequence[ModularField], degree: int) -> list[Any]:
        """The irreducible factors of the polynomial of a degree in the free parameters that has all points as zeros."""
        exponents = [m for k in range(degree + 1) for m in monomials((1,) * len(free), k)]
        numbers = [[there.values[name] for name in free] for there in those]
        rows = [[_value(m, number, self.prime) for m in exponents] for number in numbers]
        basis, nullity = nmod_mat(rows, self.prime).nullspace()
        return self._lifted(free, exponents, [int(basis[k, 0]) for k in range(len(exponents))]) if nullity == 1 else []

    def _lifted(self, free: Sequence[str], exponents: Sequence[Sequence[int]], vector: Sequence[int]) -> list[Any]:
        first = next(x for x in vector if x)
        inverse = pow(first, -1, self.prime)
        names = self.field.context.names()
        terms = {}
        for m, x in zip(exponents, vector, strict=True):
            c = rational(x * inverse % self.prime, self.prime)
            if c is None or max(abs(c.numerator), c.denominator) > 10**6:
                return []
            powers = dict(zip(free, m, strict=True))
            terms[tuple(powers.get(name, 0) for name in names)] = rationals.exact(c)
        return [f for f, _ in irreducible_factors(self.field.context.from_dict(terms))[1] if not f.is_constant()]

    def _add(self, family: Family, f: Any | None, signature: tuple[int, ...]) -> None:
        """The case with its integrals, if there are parameters of the declared signs and the integrals are found."""
        field = self.field
        conditions = [field.generator(name) for name in family.zero]
        conditions += [field.generator(name) - field.generator(other) for name, other in family.equal]
        if f is not None:
            if not self._possible(f):
                return
            conditions.append(f)
        images, context = _images(field, family, f)
        if images is None or context is None:
            self.unread += 1
            return
        put = [_composed(p, images, context) for p in (field.denominator, *field.numerators)]
        most = max(power for _, power in put)
        bottom = images.bottom if images.chosen >= 0 else context.constant(1)
        cleared = [top * bottom ** (most - power) for top, power in put]
        if cleared[0] == 0:
            return
        numerators, denominator = in_lowest_terms(cleared[1:], cleared[0])
        left = tuple(name for name in context.names() if name in field.parameters)
        relations = tuple(_composed(p, images, context)[0] for p in field.relations)
        here = PolynomialField(context, left, field.variables, tuple(numerators), denominator, relations)
        known = [
            (str(k), primitive(here, _composed(generator.polynomial, images, context)[0]))
            for k, generator in enumerate(self.usual.generators)
        ]
        special = special_of(self.usual, here, known, None)
        if special is None:
            self.unread += 1
            return
        self.known.append((Case(tuple(conditions), special), signature))

    def _possible(self, f: Any) -> bool:
        """Whether f may vanish where parameters that are declared positive are."""
        names = self.field.context.names()
        signs = set()
        for m, c in f.to_dict().items():
            if any(power % 2 and name not in self.positive for name, power in zip(names, m, strict=True)):
                return True
            signs.add(c > 0)
        return len(signs) > 1


def _value(exponents: Sequence[int], numbers: Sequence[int], prime: int) -> int:
    value = 1
    for x, power in zip(numbers, exponents, strict=True):
        value = value * pow(x, power, prime) % prime
    return value


@dataclass(frozen=True)
class Images:
    """What stands for every generator: ``places``, None for those that are top/bottom."""

    places: list[Any]
    top: Any
    bottom: Any
    chosen: int


def _images(field: PolynomialField, family: Family, f: Any | None) -> tuple[Images | None, Any]:
    """What stands for every generator, where one parameter, number k, is top/bottom: None where f is linear in none."""
    names = list(field.context.names())
    chosen = None
    if f is not None:
        degrees = f.degrees()
        able = [k for k in range(len(field.parameters)) if degrees[k] == 1]
        if not able:
            return None, None
        chosen = min(able, key=lambda k: (len(f.derivative(k)), -k))
    gone = set(family.bound) | ({names[chosen]} if chosen is not None else set())
    remaining = [name for name in names if name not in gone]
    context = fmpq_mpoly_ctx.get(remaining, field.context.ordering())
    equal = dict(family.equal)

    def plain(name: str) -> Any:
        if name in family.zero:
            return context.constant(0)
        while name in equal:
            name = equal[name]
        return context.gen(remaining.index(name)) if name in remaining else None

    images = [plain(name) for name in names]
    if f is None or chosen is None:
        return Images(images, None, None, -1), context
    filled = [context.constant(0) if x is None else x for x in images]
    slope = f.derivative(chosen).compose(*filled, ctx=context)
    rest = f.compose(*filled, ctx=context)  # the chosen one is put to zero here
    for k, name in enumerate(names):
        while name in equal:
            name = equal[name]
        if name == names[chosen]:
            images[k] = None
    return Images(images, -rest, slope, chosen), context


def _composed(p: Any, images: Images, context: Any) -> tuple[Any, int]:
    """p with the images put in, times the ``bottom`` to the power that is returned."""
    places = images.places
    if images.chosen < 0:
        return p.compose(*places, ctx=context), 0
    missing = [k for k, x in enumerate(places) if x is None]
    parts: dict[int, dict[tuple[int, ...], Any]] = {}
    for m, c in p.to_dict().items():
        power = sum(int(m[k]) for k in missing)
        left = tuple(0 if k in missing else a for k, a in enumerate(m))
        table = parts.setdefault(power, {})
        table[left] = table.get(left, 0) + c
    most = max(parts, default=0)
    filled = [context.constant(1) if x is None else x for x in places]
    total = context.constant(0)
    for power, terms in parts.items():
        total += (
            p.context().from_dict(terms).compose(*filled, ctx=context)
            * images.top**power
            * images.bottom ** (most - power)
        )
    return total, most
