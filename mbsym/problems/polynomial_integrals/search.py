"""All polynomial integrals up to a weighted degree: kernels of d/dt on monomials, less products of what is known."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import permutations
from typing import Any

from flint import nmod_mat

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import Limit, NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.expressions.message import Message
from mbsym.problems.polynomial_integrals import gradings as frames
from mbsym.problems.polynomial_integrals.gradings import Grading, beyond, homogeneous_parts
from mbsym.problems.polynomial_integrals.modular import (
    MOST_MONOMIALS,
    PRIMES,
    SMALLER,
    Exponents,
    ModularField,
    Terms,
    at_random,
    count,
    echelon,
    kernel,
    lifted,
    monomials,
    primitive,
    times,
)
from mbsym.problems.polynomial_integrals.result import FUNCTION, Count, Generator, PolynomialIntegrals

# Whether integrals are independent as functions: the rank of their gradients at a random state modulo a prime.
#
# The rank there is at most that at almost all states: that they are independent is proved by it.  That one depends on
# the others is proved where there cannot be more (the states have n dimensions, a motion that is no rest leaves n - 1
# functions); elsewhere it is verified at the random state.


class Independence:
    """Of integrals that are put one after the other."""

    def __init__(self, there: ModularField, grading: Grading) -> None:
        self.there = there
        free = grading.free or grading.frames  # relations are integrals like others
        self.state = None if there.field.relations and not free else self._anywhere()
        if grading.frames:
            self.state = frames.state(there)
        if self.state is None:
            self.state = self._on_the_relations()
        self.rows: list[list[int]] = []
        related = 0
        if self.state is not None and not free:
            self.rows = [self._gradient(there.terms(relation)) for relation in there.field.relations]
            related = len(self.rows)
        self.most = len(there.field.variables) - related - 1
        self.rank = 0
        self._related = related

    def of(self, f: Terms) -> tuple[bool, Certainty]:
        """Whether f is independent of those before it; it is one of them from now on."""
        if self.state is None:
            return False, Certainty.UNDECIDED
        rows = [*self.rows, self._gradient(f)]
        if nmod_mat(rows, self.there.prime).rank() == len(rows):
            self.rows, self.rank = rows, self.rank + 1
            return True, Certainty.PROVED
        moves = any(self.there.slopes)
        return False, Certainty.PROVED if self.rank == self.most and moves else Certainty.VERIFIED

    def depends(self, f: Terms) -> bool:
        """Whether f adds nothing to the rank of those before it, at the random state."""
        if self.state is None:
            return False
        return bool(nmod_mat([*self.rows, self._gradient(f)], self.there.prime).rank() == len(self.rows))

    def _gradient(self, f: Terms) -> list[int]:
        assert self.state is not None
        return [slope(f, k, self.state, self.there.prime) for k in range(len(self.state))]

    def _anywhere(self) -> list[int]:
        source = random.Random(f"state {self.there.prime}")
        return [source.randrange(1, self.there.prime) for _ in self.there.field.variables]

    def _on_the_relations(self) -> list[int] | None:
        """A state that keeps relations each of which has a variable of its own, alone or as a square; else None."""
        prime, source = self.there.prime, random.Random(f"states {self.there.prime}")
        relations = [self.there.terms(relation) for relation in self.there.field.relations]
        held = [{k for m in f for k, power in enumerate(m) if power} for f in relations]
        own = []
        for f, names in zip(relations, held, strict=True):
            free = [k for k in sorted(names) if sum(k in others for others in held) == 1]
            powers = {k: {m[k] for m in f} for k in free}
            fitting = [k for k in free if powers[k] in ({0, 1}, {0, 2})]
            if not fitting:
                return None
            own.append((fitting[0], max(powers[fitting[0]])))
        if prime % 4 != 3:
            return None
        for _ in range(200):
            state = [source.randrange(1, prime) for _ in self.there.field.variables]
            for f, (k, power) in zip(relations, own, strict=True):
                slope = value({m: c for m, c in f.items() if m[k]}, [*state[:k], 1, *state[k + 1 :]], prime)
                rest = value({m: c for m, c in f.items() if not m[k]}, state, prime)
                image = -rest * pow(slope, -1, prime) % prime if slope else 0
                state[k] = image if power == 1 else pow(image, (prime + 1) // 4, prime)
                if not slope or pow(state[k], power, prime) != image:
                    break
            else:
                return state
        return None


def value(f: Terms, state: list[int], prime: int) -> int:
    """f at a state."""
    total = 0
    for monomial, c in f.items():
        for x, power in zip(state, monomial, strict=True):
            if power:
                c = c * pow(x, power, prime) % prime
        total += c
    return total % prime


def slope(f: Terms, k: int, state: list[int], prime: int) -> int:
    """df/dx_k at a state."""
    part = {(*m[:k], m[k] - 1, *m[k + 1 :]): c * m[k] % prime for m, c in f.items() if m[k]}
    return value(part, state, prime)


#: Products of generators of one weight.
MOST_PRODUCTS = 3000
#: Orders of the variables that are tried to have an integral in few monomials.
MOST_ORDERS = 24


@dataclass(frozen=True)
class Known:
    """An integral, its weight, and itself modulo the prime."""

    polynomial: Any
    weight: int
    name: str
    terms: Terms


def polynomial_integrals(
    field: PolynomialField, grading: Grading, degree: int, known: Sequence[tuple[str, Any]] = ()
) -> PolynomialIntegrals:
    """The generators of weighted degree up to ``degree`` of the ring  {f : df/dt = 0}  over QQ(parameters).

    ``known``: names and polynomials of integrals, which are listed under these names; what is no integral is left out.

    Raises NoClosedForm where a degree needs more monomials than the bounds of ``modular`` allow.
    """
    return Search(field, grading, degree, known, PRIMES[0]).found()


class Search:
    """One run over the weights, modulo one prime."""

    def __init__(
        self, field: PolynomialField, grading: Grading, degree: int, known: Sequence[tuple[str, Any]], prime: int
    ) -> None:
        self.field, self.grading, self.degree = field, grading, degree
        self.modulo = bool(field.relations) and not grading.free and not grading.frames
        self.there: ModularField = at_random(field, prime, f"integrals {degree}")
        self.waiting = self._named(known)
        self.generators: list[Known] = []
        self.counts: list[Count] = []

    def found(self) -> PolynomialIntegrals:
        refuse_too_many(self.field, self.grading, self.degree)
        for weight in range(1, self.degree + 1):
            self._of_weight(weight)
        judged = Independence(self.there, self.grading)
        of_known = Independence(self.there, self.grading)
        for known in self.waiting:
            of_known.of(known.terms)
        listed = []
        for generator in self.generators:
            if not generator.name and of_known.rank and of_known.depends(generator.terms):
                generator = replace(generator, name=FUNCTION)
            independent, sure = judged.of(generator.terms)
            listed.append(Generator(generator.polynomial, generator.weight, generator.name, independent, sure))
        return PolynomialIntegrals(
            self.field, self.grading, self.degree, tuple(listed), tuple(self.counts), judged.rank
        )

    def _of_weight(self, weight: int) -> None:
        columns = list(self._columns(weight))
        most = kernel(self.there, columns, self.modulo)
        products = self.products(weight)
        order = columns
        rows, _ = echelon(products, order, self.there.prime)
        for known in [known for known in self.waiting if known.weight == weight]:
            enlarged, _ = echelon([*rows, known.terms], order, self.there.prime)
            if len(enlarged) > len(rows):
                self.generators.append(known)
                products = [*products, *([known.terms])]
                rows = enlarged
        if len(most) > len(rows):
            for f, terms in self._new(rows, most, columns):
                self.generators.append(Known(f, weight, "", terms))
                rows, _ = echelon([*rows, terms], order, self.there.prime)
        bound = len(most)
        if self.grading.frames:
            rise = self.grading.rise or 0
            bound = max(bound, len(rows) + beyond(self.there, self.grading.weights, rise, weight, rows))
        self.counts.append(Count(weight, len(columns), bound, len(rows)))

    def _columns(self, weight: int) -> Iterator[Exponents]:
        weights = range(weight + 1) if not self.grading.homogeneous or self.modulo else (weight,)
        leading = [exponents for exponents, _ in self.there.rules] if self.modulo else []
        for own_weight in weights:
            for exponents in monomials(self.grading.weights, own_weight):
                if not any(all(a >= b for a, b in zip(exponents, top, strict=True)) for top in leading):
                    yield exponents

    def products(self, weight: int) -> list[Terms]:
        """Products of the generators of that weight (up to it, with 1, where weights are not told apart)."""
        exactly = self.grading.homogeneous and not self.modulo
        pairs = [(generator.weight, generator.terms) for generator in self.generators]
        reduce = self.there.reduced if self.modulo else lambda terms: terms
        return products(pairs, weight, exactly, self.there.prime, len(self.field.variables), reduce)

    def _new(self, rows: list[Terms], most: list[Terms], columns: Sequence[Exponents]) -> Iterator[tuple[Any, Terms]]:
        """What the kernel has beyond the products, each in as few monomials as some order of the variables gives."""
        for terms, leading in sparsest(rows, most, columns, self.there.prime):
            f = None
            with suppress(NoClosedForm):  # too long to be written: the count of this weight stays incomplete
                f = lifted(self.field, list(terms), self.modulo, leading)
            if f is not None:
                yield f, self.there.terms(f)

    def _named(self, known: Sequence[tuple[str, Any]]) -> list[Known]:
        """Homogeneous parts of known integrals without their constants, those of least weight first."""
        field, knowns = self.field, []
        apart = self.grading.homogeneous and not self.modulo
        listed = [(name, f, apart) for name, f in known]
        if self.grading.free:  # norms are integrals by themselves; their constant is no part of them
            listed = [(_length(field, r), r, False) for r in field.relations] + listed
        if self.grading.frames:
            listed = [(_constant_by_itself(field, r), r, False) for r in field.relations] + listed
        for name, f, in_parts in listed:
            f = field.reduced(f) if self.modulo else f
            parts = homogeneous_parts(field, f, self.grading) if in_parts else _whole(field, f, self.grading)
            for weight, part in parts:
                rate = field.derivative(part)
                if weight and (field.reduced(rate) if self.modulo else rate) == 0:
                    part = primitive(field, part)
                    knowns.append(Known(part, weight, name, self.there.terms(part)))
        return sorted(knowns, key=lambda known_part: known_part.weight)


def products(
    generators: Sequence[tuple[int, Terms]],
    weight: int,
    exactly: bool,
    prime: int,
    variables: int,
    reduce: Callable[[Terms], Terms],
) -> list[Terms]:
    """All products of polynomials of given weights: of one weight, or (not ``exactly``) up to it, 1 among them."""
    unit: Terms = {(0,) * variables: 1}
    reached: list[tuple[int, Terms]] = [(0, unit)]
    for own, factor in generators:
        further = []
        for start, terms in reached:
            at, product = start, terms
            further.append((at, product))
            while at + own <= weight:
                at, product = at + own, reduce(times(product, factor, prime))
                further.append((at, product))
        reached = further
        if len(reached) > MOST_PRODUCTS:
            message = Message(
                "the integrals have more than [[most]] products of weight [[weight]]", most=MOST_PRODUCTS, weight=weight
            )
            raise NoClosedForm(message, limit=Limit.DEGREE, remedy=SMALLER)
    return [terms for at, terms in reached if at == weight or not exactly]


def _constant_by_itself(field: PolynomialField, relation: Any) -> str:
    """``length of b``, ``product of b and c``."""
    degrees = relation.degrees()
    names = [name.rstrip("0123456789") for name, k in zip(field.variables, field.places, strict=True) if degrees[k]]
    first, *rest = dict.fromkeys(names)
    return (
        Message("product of [[name]] and [[other]]", name=first, other=rest[0])
        if rest
        else Message("length of [[name]]", name=first)
    )


def _stem(field: PolynomialField, relation: Any) -> str:
    """``gamma`` of a relation between gamma1, gamma2, gamma3."""
    degrees = relation.degrees()
    names = [name for name, k in zip(field.variables, field.places, strict=True) if degrees[k]]
    return names[0].rstrip("0123456789") or names[0]


def _length(field: PolynomialField, relation: Any) -> str:
    """What is constant by itself."""
    degrees = relation.degrees()
    names = [name for name, k in zip(field.variables, field.places, strict=True) if degrees[k]]
    if names[0].startswith(("sin(", "exp(")):
        return Message("identity between [[names]]", names=", ".join(names))
    return Message("length of [[name]]", name=_stem(field, relation))


def _whole(field: PolynomialField, f: Any, grading: Grading) -> list[tuple[int, Any]]:
    """f without its constant, under its largest weight."""
    count = len(field.parameters)
    terms = {m: c for m, c in f.to_dict().items() if any(m[count:])}
    if not terms:
        return []
    return [(max(grading.of([int(a) for a in m[count:]]) for m in terms), field.context.from_dict(terms))]


def sparsest(
    rows: Sequence[Terms], most: Sequence[Terms], columns: Sequence[Exponents], prime: int
) -> list[tuple[Terms, Exponents]]:
    """A complement of the span of ``rows`` in that of ``most``, of few monomials: polynomials and a monomial of each.

    Of each order of the variables the reduced echelon form is a candidate: leading monomials of products do not occur.
    """
    best: list[tuple[Terms, Exponents]] = []
    size = None
    for number, order in enumerate(permutations(range(len(columns[0])))):
        if number == MOST_ORDERS and len(columns[0]) > 4:
            break
        ordered = sorted(columns, key=lambda m: tuple(m[k] for k in _spaced(order, number)), reverse=True)
        known, pivots = echelon(rows, ordered, prime)
        taken = set(pivots)
        left = []
        for f in most:
            rest = dict(f)
            for row, pivot in zip(known, pivots, strict=True):
                c = rest.get(pivot, 0)
                if c:
                    for m, d in row.items():
                        rest[m] = (rest.get(m, 0) - c * d) % prime
            left.append({m: c for m, c in rest.items() if c})
        new, leading = echelon([f for f in left if f], [m for m in ordered if m not in taken], prime)
        total = sum(map(len, new))
        if size is None or total < size:
            size, best = total, list(zip(new, leading, strict=True))
    return best


def _spaced(order: Sequence[int], number: int) -> Sequence[int]:
    """The orders one after the other, each turned once more: the first ones put each variable in front."""
    turn = number % len(order)
    return [*order[turn:], *order[:turn]]


def refuse_too_many(field: PolynomialField, grading: Grading, degree: int) -> None:
    """Raises NoClosedForm where the degree needs more monomials than are looked at."""
    needed = sum(count(grading.weights, weight) for weight in range(degree + 1))
    if needed > MOST_MONOMIALS:
        message = Message(
            "weighted degree [[degree]] has [[needed]] monomials in [[count]] variables, more than [[most]]",
            degree=degree,
            needed=needed,
            count=len(field.variables),
            most=MOST_MONOMIALS,
        )
        raise NoClosedForm(message, limit=Limit.DEGREE, remedy=SMALLER)
