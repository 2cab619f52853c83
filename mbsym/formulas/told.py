"""Long formulas told through named intermediates: each is defined once, in order, and used by its name from there on.

``Told`` is a value that every target prints: definitions and formulas are formulas of one ring, in which the
intermediates are generators of their own.  ``tell`` makes it from a straight-line program some of whose nodes have
names; nodes without one that several others need get numbered names (z1, z2, ...) where they are long.  Nothing is
lost: ``Told.values`` over the system's ring puts the definitions back.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Generic, TypeVar

from mbsym.algebra.base import Algebra, Scalar
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.factors import occurring
from mbsym.algebra.program import Node, Program
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.tree import reached
from mbsym.formulas.formula import Formula

#: Nodes without a meaning get a name where several others need them and they have at least so many terms.
COMMON_TERMS = 3
#: Two sums whose product may have more terms than this are not multiplied out: the longer one gets a name.
PRODUCT_TERMS = 12
#: A definition that is used once is put in its place if it is no longer than this.
IN_PLACE = 4
#: So is a product of so few symbols, however often it is used.
FEW_SYMBOLS = 2

M = TypeVar("M")
#: Coefficients, and (generator, exponent) of what occurs.
Terms = list[tuple[Any, list[tuple[int, int]]]]


@dataclass(frozen=True)
class Definition(Generic[M]):
    """``name = formula``.  ``name`` is a generator of the ring; ``meaning`` is None for a common factor."""

    name: str
    formula: Formula
    meaning: M | None


@dataclass(frozen=True)
class Told(Generic[M]):
    """``formulas`` over the names that ``definitions`` introduce, in an order in which each uses only earlier ones.

    ``ring`` has the names of the system and those of the intermediates.
    """

    ring: Ring
    definitions: tuple[Definition[M], ...]
    formulas: tuple[Formula, ...]

    @property
    def terms(self) -> int:
        """Terms of all that is written."""
        return sum(x.formula.terms for x in self.definitions) + sum(x.terms for x in self.formulas)

    def wanted(self, formulas: Iterable[Formula], known: Iterable[str] = ()) -> tuple[Definition[M], ...]:
        """The definitions that some formulas need, in order, besides those of names ``known`` before."""
        needs = {self.index(x.name): self.held_by[x.name] for x in self.definitions}
        needed, skipped = reached(needs, self.ring.held([x.polynomial for x in formulas])), set(known)
        return tuple(x for x in self.definitions if self.index(x.name) in needed and x.name not in skipped)

    @cached_property
    def held_by(self) -> dict[str, set[int]]:
        """By name, the generators that each definition holds."""
        return {x.name: self.ring.held([x.formula.polynomial]) for x in self.definitions}

    def index(self, name: str) -> int:
        """The generator of an intermediate."""
        return _index(self.ring, name)

    def values(self, formulas: Sequence[Formula], algebra: Algebra, environment: Mapping[str, Scalar]) -> list[Scalar]:
        """The formulas over any algebra, through the definitions; ``environment`` has values for the other names.

        Over the system's own ring these are the formulas with every definition put back.  Raises what it raises.
        """
        known = dict(environment)
        carry = Carrier(self.ring, algebra, known)  # looks a name up when it is first needed
        for item in self.wanted(formulas):
            known[item.name] = carry.termwise(self._terms(item.formula.polynomial))
        return [carry.termwise(self._terms(x.polynomial)) for x in formulas]

    @cached_property
    def _known_terms(self) -> dict[int, tuple[Polynomial, Terms]]:
        return {}

    def _terms(self, polynomial: Polynomial) -> Terms:
        """The terms without what does not occur in them: the ring has a generator for every name."""
        known = self._known_terms.get(id(polynomial))
        if known is None:
            used = occurring([polynomial])
            terms = [(c, [(k, int(m[k])) for k in used if m[k]]) for m, c in polynomial.terms()]
            known = self._known_terms[id(polynomial)] = (polynomial, terms)  # kept, so that its id stays its own
        return known[1]


def _index(ring: Ring, name: str) -> int:
    return ring.index("prescribed" if ring.has("prescribed", name) else "parameter", name)


#: Makes the ring from the names of the intermediates that vary and of those that are made of constants alone.
RingOf = Callable[[Sequence[str], Sequence[str]], Ring]


def tell(
    program: Program,
    outputs: Sequence[Node],
    named: Mapping[int, tuple[str, M]],
    constants: frozenset[str],
    ring_of: RingOf,
    inputs_of: Callable[[Ring], Mapping[str, Polynomial]],
    common: str = "z",
) -> Told[M]:
    """The outputs told through the nodes that are ``named`` (by their numbers: a name and its meaning).

    ``constants`` are the inputs that do not vary; ``common`` is the stem of the names of common factors.
    Raises NoClosedForm.
    """
    live = program.live(outputs)
    opposite = _opposites(program, live, named.keys())
    varying = _varying(program, live, constants)
    varying |= {opposite[k] for k in live if k in opposite and k in varying}
    shared = _common(program, live, named.keys(), opposite)

    def teller(selected: set[int] | None) -> _Teller[M]:
        names: dict[int, tuple[str, M | None]] = {}
        count = 0
        for number in sorted({*live, *(opposite[k] for k in live if k in opposite)}):
            if number in opposite or (selected is not None and number not in selected):
                continue
            if number in named:
                names[number] = named[number]
            elif number in shared:
                count += 1
                names[number] = (f"{common}{count}", None)
        moving = [name for k, (name, _) in names.items() if k in varying]
        fixed = [name for k, (name, _) in names.items() if k not in varying]
        ring = ring_of(moving, fixed)
        return _Teller(program, outputs, names, opposite, ring, inputs_of(ring))

    # The first telling finds which names save something, the second has those alone, numbered without gaps.
    return teller(teller(None).worth_naming()).told()


def _varying(program: Program, live: Sequence[int], constants: frozenset[str]) -> set[int]:
    """The numbers of nodes that depend on more than constants."""
    varying: set[int] = set()
    for number in live:
        operation, operands, payload = program.instructions[number]
        if (operation == "input" and payload not in constants) or any(k in varying for k in operands):
            varying.add(number)
    return varying


def _opposites(program: Program, live: Sequence[int], named: Collection[int]) -> dict[int, int]:
    """The nodes that are the opposite of one that has, or may get, a name: b - a of a - b, and a of -a.

    Programs move signs outwards, so that a node with a meaning may be needed as its opposite only.
    """
    differences: dict[tuple[int, ...], int] = {}
    opposites: dict[int, int] = {}
    for number in sorted(named):
        operation, operands, _ = program.instructions[number]
        if operation == "subtract":
            if operands[::-1] not in differences:
                differences[operands] = number
        elif operation == "negative" and operands[0] not in named:
            opposites.setdefault(operands[0], number)
    for number in live:
        operation, operands, _ = program.instructions[number]
        if operation == "subtract" and number not in named and number not in opposites:
            other = differences.get(operands[::-1])
            if other is None:
                differences.setdefault(operands, number)
            else:
                opposites[number] = other
    return opposites


def _common(program: Program, live: Sequence[int], named: Collection[int], opposite: Mapping[int, int]) -> set[int]:
    """The numbers of nodes without a meaning that get a name: long and needed several times, or long factors.

    Lengths are estimated from above: nothing is collected.
    """
    uses = Counter(opposite.get(k, k) for number in live for k in program.instructions[number].operands)
    terms: dict[int, int] = {}
    shared: set[int] = set()
    for number in live:
        operation, operands, _ = program.instructions[number]
        if operation == "multiply":
            short, long = sorted(operands, key=lambda k: (terms[k], k))
            if terms[short] > 1 and terms[short] * terms[long] > PRODUCT_TERMS:
                shared.add(opposite.get(long, long))
                terms[long] = 1
        lengths = [terms[k] for k in operands]
        length = 1
        if operation in ("add", "subtract", "negative"):
            length = sum(lengths)
        elif operation == "multiply":
            length = lengths[0] * lengths[1]
        elif operation == "divide":
            length = lengths[0]
        canonical = opposite.get(number, number)
        if canonical in named:
            length = 1
        elif uses[canonical] > 1 and length >= COMMON_TERMS:
            shared.add(canonical)
            length = 1
        terms[number] = length
    return shared


class _Counted:
    """A polynomial, and in how many of its terms each generator occurs; a square counts as two."""

    def __init__(self, polynomial: Polynomial) -> None:
        self.polynomial = polynomial
        monomials = polynomial.monoms()
        self.uses = {k: sum(min(int(m[k]), 2) for m in monomials) for k in occurring([polynomial])}

    def with_images(self, ring: Ring, images: Mapping[int, Polynomial]) -> _Counted:
        """The same where some generators have images; the object itself where none of them occurs."""
        if self.uses.keys().isdisjoint(images):
            return self
        polynomial = self.polynomial
        for index in self.uses.keys() & images.keys():  # one by one is quicker; no image holds what has one
            polynomial = ring.substitute(polynomial, {index: images[index]})
        return _Counted(polynomial)


class _Teller(Generic[M]):
    """Carries a program into a ring in which some of its nodes have names."""

    def __init__(
        self,
        program: Program,
        outputs: Sequence[Node],
        names: Mapping[int, tuple[str, M | None]],
        opposite: Mapping[int, int],
        ring: Ring,
        inputs: Mapping[str, Polynomial],
    ) -> None:
        self.ring, self.names, self.opposite = ring, names, opposite
        #: By generator: the node it stands for, and what that is.
        self.definitions: dict[int, tuple[int, Polynomial]] = {}
        results = program.evaluate(outputs, inputs, ring, self._standing)
        self.formulas = [ring.reduce(x) for x in results]

    def _standing(self, number: int, value: Polynomial) -> Polynomial:
        """The name in the place of a value that has one; what is no longer than a name stays as it is."""
        if number in self.opposite:
            return -self._named(self.opposite[number], -value)
        return self._named(number, value)

    def _named(self, number: int, value: Polynomial) -> Polynomial:
        if number not in self.names:
            return value
        value = self.ring.reduce(value)
        if value.is_constant() or _is_symbol(value):
            return value
        index = _index(self.ring, self.names[number][0])
        self.definitions.setdefault(index, (number, value))
        return self.ring.context.gen(index)

    def worth_naming(self) -> set[int]:
        """The nodes whose names save something; the others are written where they are used."""
        ring = self.ring
        bound = ring.held([g.argument for g in ring.generators if g.argument is not None])
        left = {index: _Counted(value) for index, (_, value) in self.definitions.items()}
        formulas = [_Counted(x) for x in self.formulas]
        while True:
            uses: Counter[int] = Counter()
            for counted in (*formulas, *left.values()):
                uses.update(counted.uses)
            images: dict[int, Polynomial] = {}
            for index in list(left):  # in order: what was put in its place makes the next one longer
                left[index] = left[index].with_images(ring, images)
                if index not in bound and _saves_nothing(left[index].polynomial, uses[index]):
                    images[index] = left.pop(index).polynomial
            if not images:
                return {self.definitions[index][0] for index in left}
            formulas = [x.with_images(ring, images) for x in formulas]

    def told(self) -> Told[M]:
        definitions = []
        for number, value in self.definitions.values():
            name, meaning = self.names[number]
            definitions.append(Definition(name, Formula(self.ring, value), meaning))
        return Told(self.ring, tuple(definitions), tuple(Formula(self.ring, x) for x in self.formulas))


def _is_symbol(polynomial: Polynomial) -> bool:
    """Whether it is +-x of one generator."""
    return len(polynomial) == 1 and sum(polynomial.degrees()) == 1 and abs(polynomial.leading_coefficient()) == 1


def _saves_nothing(value: Polynomial, uses: int) -> bool:
    """Whether a definition is as well put in the place of its name."""
    if uses <= 1:
        return len(value) <= IN_PLACE
    if len(value) > 1:
        return False
    symbols = sum(value.degrees()) + (abs(value.leading_coefficient()) != 1)
    return bool(symbols <= FEW_SYMBOLS)
