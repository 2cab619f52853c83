"""Formulas in an author's own letters: symbols of the description put in for what they stand for, exactly.

A letter L that stands for N/D is the relation L D - N = 0.  Where that is A v^d + B = 0 with A and B free of a symbol
v, v^d may be written as -B/A, which takes v out of a formula (d = 1) or its high powers; all that cancels is cancelled.
What is left equals the formula by the relations alone: putting the definitions back gives it again, in the ring.
Such steps are taken one by one, the one that leaves least to read first, as long as each leaves less
(``size``: names, numbers, functions, signs, brackets, fractions) by a twentieth at least and brings in neither other
symbols nor denominators, and all of them together save a fifth, or a tenth where nothing is left in the formula of what
the letters are made of.  Letters that were asked for take out a symbol wherever that leaves no denominator.

Which letters there are is said once around all that is written (``letters_as``); printers ask ``lettered``.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from math import prod
from typing import Any
from weakref import WeakKeyDictionary

from mbsym.algebra.base import Lowering
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import Failure
from mbsym.algebra.ring import MOST_DEGREE, Polynomial, Ring
from mbsym.algebra.terms import apart
from mbsym.algebra.tower import MOST_ROOTS, Tower
from mbsym.expressions.rates import ENDINGS
from mbsym.expressions.tree import Call, Expression, names, sign_by_structure, substitute
from mbsym.formulas.shape import length, present
from mbsym.formulas.tree import angles_or

#: Formulas with more terms stay as they are: nobody reads them, and it may take long.
MOST_TERMS = 1000
#: Of formulas with more terms (letters asked for; unasked) a step is tried only where it leaves fewer terms by
#: ``SHORTER``: to see how much there is to read takes far more time than to count terms.
MOST_READ, MOST_READ_UNASKED = 400, 60
#: Candidate terms of products that the steps of one formula may take, by each route; unasked for; and of a formula of
#: so many terms at most.
WORK, WORK_UNASKED, WORK_SHORT, SHORT = 20_000_000, 100_000, 300_000, 12
#: So many of the candidates with the fewest terms are written out, to see which is the shortest to read.
WRITTEN = 8
#: What is left to read at most, as a share of what there was: after one step, and after all of them; after all of them
#: where none of the symbols is left that the letters are made of.
STEP, SHORTER, INSTEAD = Fraction(19, 20), Fraction(4, 5), Fraction(9, 10)
#: With more letters than this that hold declared symbols they are tried one by one only.
MOST_CHAINED = 16
#: Generators beside those of the ring, for what the definitions adjoin.
FURTHER = 24


@dataclass(frozen=True, eq=False)
class Letters:
    """Letters with what they stand for, in order: later ones may hold earlier ones.

    ``requested``: those that are wanted, also where nothing gets shorter, and names that are to stay; None: all of them
    where it does.
    """

    given: tuple[tuple[str, Expression], ...]
    requested: tuple[str, ...] | None = None

    @property
    def wanted(self) -> tuple[str, ...]:
        known = tuple(name for name, _ in self.given)
        return known if self.requested is None else tuple(name for name in self.requested if name in known)

    @property
    def kept(self) -> frozenset[str]:
        """Names that are to stay in formulas."""
        return frozenset(self.requested or ()) - {name for name, _ in self.given}

    def definitions(self, used: Iterable[str]) -> list[tuple[str, Expression]]:
        """Those of the letters in ``used`` and of the letters that they are made of, in order."""
        needed = set(used)
        for name, value in reversed(self.given):
            if name in needed:
                needed |= names(value)
        return [(name, value) for name, value in self.given if name in needed]


_LETTERS: ContextVar[Letters | None] = ContextVar("letters", default=None)
_USED: ContextVar[set[str] | None] = ContextVar("letters used", default=None)


@contextmanager
def letters_as(letters: Letters | None) -> Iterator[set[str]]:
    """Within this block every formula is written in these letters; what is yielded gathers those that were used."""
    used: set[str] = set()
    tokens = _LETTERS.set(letters if letters is not None and letters.wanted else None), _USED.set(used)
    try:
        yield used
    finally:
        _LETTERS.reset(tokens[0])
        _USED.reset(tokens[1])


def letters() -> Letters | None:
    """Those in which formulas are written."""
    return _LETTERS.get()


def lettered(ring: Ring, polynomial: Polynomial) -> tuple[Ring, Polynomial]:
    """The formula as it is to be written: in the letters that were asked for, or as it is."""
    requested = letters()
    if requested is None or isinstance(ring, LetterRing):
        return ring, polynomial
    rewritten = rewriter(ring, requested)(polynomial)
    if rewritten is None:
        return ring, polynomial
    used = _USED.get()
    if used is not None:
        used |= rewritten.used
    return rewritten.ring, rewritten.polynomial


class LetterRing(Ring):
    """The ring ``whole`` with letters besides: ``moving`` ones vary with the state, those in ``fixed`` do not.

    Positive and nonnegative ones among these are known as such: sqrt(w**2) = w.
    """

    shortest = True

    def __init__(self, whole: Ring, moving: Sequence[str], fixed: Mapping[str, Expression]) -> None:
        def of(kind: str) -> list[str]:
            return [g.name for g in whole.generators if g.kind == kind and g.argument is None and g.name != "pi"]

        def parameters(indices: Iterable[int]) -> list[str]:
            return [whole.generators[k].name for k in indices if whole.generators[k].kind == "parameter"]

        signs = dict.fromkeys(parameters(whole._positive), "positive")
        positive = [name for name, value in fixed.items() if sign_by_structure(value, signs) == "positive"]
        roots = [name for name, value in fixed.items() if isinstance(value, Call) and value.function == "sqrt"]
        super().__init__(
            of("coordinate"),
            [*of("prescribed"), *moving],
            [*of("parameter"), *fixed],
            whole.angles,
            positive=[*signs, *positive],
            nonnegative=[*parameters(whole._nonnegative), *roots],
            spare=whole.spare + FURTHER,
            terms=whole.most_terms,
            typed=whole.typed,
        )
        self.whole = whole
        self.letters = (*moving, *fixed)


@dataclass(frozen=True)
class Written:
    """A formula in letters: over ``ring``, which holds them, and which of them are in it."""

    ring: Ring
    polynomial: Polynomial
    used: frozenset[str]


@dataclass(frozen=True)
class _Step:
    """``symbol``**``degree`` = -``rest``/``factor``, by the definition of ``letter``; ``brings`` what it brings in.

    ``given``: as the definition has it, with earlier letters in it.
    """

    letter: str
    symbol: int
    degree: int
    factor: Polynomial
    rest: Polynomial
    brings: frozenset[int]
    given: bool


#: A numerator, and factors of the denominator with their exponents.
_Fraction = tuple[Polynomial, list[tuple[Polynomial, int]]]

_REWRITERS: WeakKeyDictionary[Ring, dict[Letters, Rewriter]] = WeakKeyDictionary()


def rewriter(ring: Ring, letters: Letters) -> Rewriter:
    """Made once for a ring."""
    known = _REWRITERS.setdefault(ring, {})
    if letters not in known:
        known[letters] = Rewriter(ring, letters)
    return known[letters]


class Rewriter:
    """Writes polynomials of a ring in letters, and back."""

    def __init__(self, ring: Ring, letters: Letters) -> None:
        self._known: dict[tuple[int, str], tuple[Polynomial, Written | None]] = {}
        self._equal: dict[int, list[Polynomial]] = {}
        self._last: tuple[_Fraction, list[Any], set[int]] | None = None
        self.letters = letters
        self.work, self.most_read = (WORK, MOST_READ) if letters.requested else (WORK_UNASKED, MOST_READ_UNASKED)
        held = {g.name + ENDINGS.get(g.kind, "") for g in ring.generators if g.argument is None} | {"t", "pi"}
        self.values = self._expanded(letters, held, ring)
        moving = [name for name, value in self.values.items() if not _constant(value, ring)]
        own = {g.name for g in ring.generators if g.kind == "parameter"}
        fixed = {name: value for name, value in self.values.items() if name not in moving and name not in own}
        self.ring = LetterRing(ring, moving, fixed)
        self.named = _named(self.ring)
        self.places = {name: next(iter(occurring([self.named[name]]))) for name in self.values}
        self._read_so(ring, moving)
        self._carry = Carrier(ring, self.ring, self.named)
        self.steps = [step for name in self.values if name in letters.wanted for step in self._steps_of(name)]
        letter = set(self.places.values())
        other = letter - {self.places[name] for name in letters.wanted if name in self.places}
        self.steps = [x for x in self.steps if not x.brings & other and x.symbol not in other]
        given_letters = {x.letter for x in self.steps if x.given}
        self.chained = [
            x
            for x in self.steps
            if (x.given or x.letter not in given_letters) and x.degree == 1 and x.symbol not in letter
        ]
        if len({x.letter for x in self.chained}) > MOST_CHAINED:
            self.chained = []
        self.sharing = Counter(k for name in letters.wanted if name in self.values for k in self._symbols(name))

    @staticmethod
    def _expanded(letters: Letters, held: set[str], ring: Ring) -> dict[str, Expression]:
        """The letters that can be said in the ring's names, by the declared names alone."""
        expressions: dict[str, Expression] = {}
        for name, value in letters.given:
            whole = substitute(value, expressions)
            if names(whole) <= held and (name not in held or ring.has("parameter", name)):
                expressions[name] = whole
        return expressions

    def _read_so(self, ring: Ring, moving: Sequence[str]) -> None:
        """Formulas are collected by p, q and G = p^2 + q^2; r and lambda = (s - 1) r + eta are read like parameters."""
        first = {ring.generators[k].name for k in ring.leading}
        if not first:
            return
        mixed: set[str] = set()
        for name in moving:
            held = names(self.values[name])
            if not held <= first or held & mixed:
                mixed |= {name, *(held & first)}
        kinds = ("coordinate", "prescribed")
        places = {x: self.ring.index(k, x) for x in (*first, *moving) for k in kinds if self.ring.has(k, x)}
        self.ring.resting = frozenset(place for name, place in places.items() if name in mixed)
        self.ring.leading = frozenset(places.values()) - self.ring.resting

    def _symbols(self, name: str) -> set[int]:
        """The generators that a letter is made of."""
        return {k for x in names(self.values[name]) if x in self.named for k in occurring([self.named[x]])}

    def _steps_of(self, name: str) -> Iterator[_Step]:
        """What the definition of a letter allows to write differently, with earlier letters in it and without."""
        expression = dict(self.letters.given)[name]
        seen: list[Polynomial] = []
        for value in (expression, self.values[name]):
            try:
                relations = self._relations(name, value)
            except (Failure, ZeroDivisionError):
                continue
            for relation in relations:
                if relation not in seen:
                    seen.append(relation)
                    yield from self._solved(name, relation, value is expression)

    def _relations(self, name: str, value: Expression) -> list[Polynomial]:
        """letter * Q - P for a quotient P/Q, letter^2 * Q - P for its square root."""
        ring, letter = self.ring, self.named[name]
        held = sorted({*names(value), name})
        if all(ring.has("parameter", x) for x in held):
            # in a field of their own: products in the ring take as many exponents as it has generators
            field = Tower(held)
            try:
                element = Lowering(field, {x: field.parameter(x) for x in held})(value)
            except Failure as failure:
                if failure.limit is not None:
                    raise
            else:
                if max((*element.top.degrees(), *element.bottom.degrees())) > MOST_DEGREE:
                    return []
                if not field.squares:
                    relation = field.parameter(name).top * element.bottom - element.top
                    images = [ring.zero] * MOST_ROOTS + [self.named[x] for x in held]
                    return [relation.compose(*images, ctx=ring.context)]
        with ring.budget(WORK):
            lower = Lowering(ring, self.named)
            relations = [letter - lower(value)]
            if isinstance(value, Call) and value.function == "sqrt":
                relations.append(ring.times(letter, letter) - lower(value.argument))
            return [ring.fraction(x)[0] for x in relations]

    def _solved(self, name: str, relation: Polynomial, given: bool) -> Iterator[_Step]:
        own, held = self.places[name], occurring([relation])
        if own not in held:
            return
        # What both sides of the definition share is zero for no value of the letter alone: it says nothing of others.
        shared = reduce(lambda x, y: x.gcd(y), _powers(self.ring, relation, own).values())
        relation = relation if shared.is_constant() else relation / shared
        held = occurring([relation])
        kept_symbols = {next(iter(occurring([self.named[x]]))) for x in self.letters.kept if x in self.named}
        for symbol in held:
            powers = _powers(self.ring, relation, symbol)
            if symbol in (own, *kept_symbols) or len(powers) != 2 or 0 not in powers:
                continue
            degree = max(powers)
            factor, rest = powers[degree], powers[0]
            if degree > 1 and not factor.is_constant():
                continue
            yield _Step(name, symbol, degree, factor, rest, frozenset(held) - {own, symbol}, given)

    # --- writing -----------------------------------------------------------------------------------------------------

    def __call__(self, polynomial: Polynomial) -> Written | None:
        """The polynomial in letters; None where it stays as it is."""
        angles, polynomial = angles_or("shorter"), self._first(polynomial)
        known = self._known.get((id(polynomial), angles))
        if known is None:  # the polynomial is kept, so that its id stays its own
            known = self._known[id(polynomial), angles] = (polynomial, self._written(polynomial))
        return known[1]

    def _written(self, polynomial: Polynomial) -> Written | None:
        if not self.steps or len(polynomial) > MOST_TERMS or polynomial.is_constant():
            return None
        if not self.letters.requested:
            self.work = WORK_SHORT if len(polynomial) <= SHORT else WORK_UNASKED
        try:
            with self.ring.whole.budget(self.work):
                return self._shortest(polynomial)
        except (Failure, ZeroDivisionError):  # as it is it can be read, too
            return None

    def _shortest(self, polynomial: Polynomial) -> Written | None:
        ring, whole = self.ring, self.ring.whole
        carried = self._carry(polynomial)
        candidates = []
        with suppress(Failure, ZeroDivisionError):
            candidates.append(self._as_one(carried))
        waves = self._waves(carried)
        if len(waves) > 1:
            with suppress(Failure, ZeroDivisionError), ring.budget(self.work):
                coefficients = [(self._as_one(x), x, wave) for wave, x in waves]
                if any(best is not None for best, _, _ in coefficients):
                    terms = (ring.times(x if best is None else best, wave) for best, x, wave in coefficients)
                    candidates.append(sum(terms, start=ring.zero))
        best = min((x for x in candidates if x is not None), key=lambda x: size(ring, x), default=None)
        if best is None:
            return None
        held = ring.held([best])
        used = frozenset(name for name in self.values if self.places[name] in held)
        left = {ring.generators[k].name for k in held}
        instead = not any(ring.generators[k].name in left for name in used for k in self._symbols(name))
        share = INSTEAD if instead else SHORTER
        if not self.letters.requested and size(ring, best) > size(whole, polynomial) * share:
            return None
        return Written(ring, best, used)

    def _waves(self, polynomial: Polynomial) -> list[tuple[Polynomial, Polynomial]]:
        """Of a series in the sine and cosine of one angle the products of these, with the quotients before them."""
        ring = self.ring
        held = {k: ring.generators[k] for k in occurring([polynomial])}
        waves = [k for k, g in held.items() if g.kind in ("sine", "cosine")]
        if len({held[k].name for k in waves}) != 1 or all(g.kind != "reciprocal" for g in held.values()):
            return []
        gens = [ring.context.gen(k) for k in waves]
        return [
            (prod((g**n for g, n in zip(gens, key, strict=True)), start=ring.one), quotient)
            for key, quotient in apart(polynomial, waves).items()
        ]

    def _as_one(self, polynomial: Polynomial) -> Polynomial | None:
        """Over one denominator, by steps that each leave less to read, from the start or from the end of a chain."""
        ring = self.ring
        fraction: _Fraction = ring.fraction(polynomial)
        if len(fraction[0]) > MOST_TERMS or not self._applicable(fraction, self.steps, True):
            return None  # over one denominator it may be long
        routes = [self._improved(fraction)]
        with suppress(Failure, ZeroDivisionError), ring.budget(self.work):
            chain = self._chain(fraction)
            if chain is not None and not (self._long(fraction) and _terms(chain) > _terms(fraction) * SHORTER):
                routes.append(self._improved(chain))
        routes = [x for x in routes if x is not fraction]
        return self._joined(min(routes, key=self._read)) if routes else None

    def _improved(self, fraction: _Fraction) -> _Fraction:
        """What single steps make of it, each of which leaves less to read, or far fewer terms of many."""
        with suppress(Failure), self.ring.budget(self.work):  # what is found within the budget is as good
            if self._long(fraction):
                while (few := min(self._candidates(fraction), key=lambda x: x[0], default=None)) is not None:
                    if few[0] > _terms(fraction) * SHORTER:
                        break
                    fraction = few[1]
                if self._long(fraction):
                    return fraction
            least = self._read(fraction)
            while (tried := self._tried(fraction)) is not None and tried[0] <= least * STEP:
                least, fraction = tried
        return fraction

    def _long(self, fraction: _Fraction) -> bool:
        """Whether to read it would take too long: its terms are counted in place of that."""
        return len(fraction[0]) > self.most_read

    def _read(self, fraction: _Fraction) -> int:
        """How much there is to read of a numerator and its denominator; nothing is adjoined for it."""
        read = size(self.ring, self._first(fraction[0]))
        return read + sum(1 + (n != 1) + size(self.ring, self._first(x)) for x, n in fraction[1])

    def _first(self, polynomial: Polynomial) -> Polynomial:
        """The first that was met of equal polynomials, of which shapes are kept: steps lead to the same ones often."""
        alike = self._equal.setdefault(len(polynomial), [])  # they have no hash
        if polynomial in alike:
            return alike[alike.index(polynomial)]
        alike.append(polynomial)
        return polynomial

    def _chain(self, fraction: _Fraction) -> _Fraction | None:
        """One symbol for each letter that is not made of letters alone: A = a C, B = b C, lz = n C r; None for no step.

        The symbol is one that leaves no denominator, and that few letters hold.  For letters that were asked for, which
        are taken also where nothing gets shorter, there is no other.
        """
        start, gone, taken = self._held(fraction), set[int](), 0
        if self.letters.requested and len(fraction[0]) == 1 and fraction[0].total_degree() == 1 and not fraction[1]:
            return None  # a symbol
        start |= set(self.places.values())
        for name in self.values:
            held = self._held(fraction)
            own = [x for x in self.chained if x.letter == name and x.symbol in held - gone and x.brings <= start]
            if self.letters.requested:
                own = [x for x in own if x.factor.is_constant()]
            if own:
                step = min(own, key=lambda x: (not x.factor.is_constant(), self.sharing[x.symbol]))
                after = self._after(fraction, step)
                if after is not None:
                    fraction, taken = after, taken + 1
                    gone.add(step.symbol)
        return fraction if taken else None

    def _held(self, fraction: _Fraction) -> set[int]:
        """The generators of a fraction, and those in what is adjoined."""
        return self.ring.held([fraction[0], *(x for x, _ in fraction[1])])

    def _applicable(self, fraction: _Fraction, steps: Iterable[_Step], forced: bool = False) -> list[_Step]:
        """Those that have something to do and, unless ``forced``, bring in no other symbol than their letter."""
        held = self._held(fraction)
        return [x for x in steps if x.symbol in held and (forced or x.brings <= held)]

    def _tried(self, fraction: _Fraction) -> tuple[int, _Fraction] | None:
        """(how much there is to read, what is left) by the step that leaves least."""
        fewest = sorted(self._candidates(fraction), key=lambda x: x[0])[:WRITTEN]
        return min(((self._read(x), x) for _, x in fewest), key=lambda x: x[0], default=None)

    def _candidates(self, fraction: _Fraction) -> Iterator[tuple[int, _Fraction]]:
        """(terms, what is left) by each step that leaves neither more terms nor more denominators."""
        most = _terms(fraction)
        for step in self._applicable(fraction, self.steps):
            try:
                after = self._after(fraction, step)
            except (Failure, ZeroDivisionError):
                continue
            if after is not None and len(after[1]) <= len(fraction[1]) and (terms := _terms(after)) <= most:
                yield terms, after

    def _joined(self, fraction: _Fraction) -> Polynomial:
        ring, result = self.ring, fraction[0]
        for factor, exponent in fraction[1]:
            result = ring.times(result, ring.reciprocal(factor) ** exponent)
        return result

    def _after(self, fraction: _Fraction, step: _Step) -> _Fraction | None:
        """The fraction after one step, in lowest terms; None where nothing changes."""
        ring, (degrees, buried) = self.ring, self._looked_at(fraction)
        if step.symbol in buried:
            if step.degree > 1:
                return None
            image = -ring.times(step.rest, ring.reciprocal(step.factor))
            return ring.fraction(ring.substitute(self._joined(fraction), {step.symbol: image}))
        top, above = self._put(fraction[0], step, degrees[0][step.symbol])
        changed, below = top != fraction[0], list[tuple[Polynomial, int]]()
        for (factor, exponent), own in zip(fraction[1], degrees[1:], strict=True):
            other, more = self._put(factor, step, own[step.symbol])
            changed |= other != factor
            above -= more * exponent
            below.append((other, exponent))
        if not changed:
            return None
        if above < 0:
            top = ring.reduce(ring.times(top, step.factor**-above))
        elif above:
            below.append((step.factor, above))
        return self._lowest(top, below)

    def _looked_at(self, fraction: _Fraction) -> tuple[list[Any], set[int]]:
        """The degrees of the numerator and of the factors below, and what stands in adjoined generators: every step is
        tried on one fraction, and a ring has many generators."""
        if self._last is None or self._last[0] is not fraction:
            polynomials = [fraction[0], *(x for x, _ in fraction[1])]
            inside = (self.ring.generators[k].argument for k in occurring(polynomials))
            buried = self.ring.held([x for x in inside if x is not None])
            self._last = fraction, [x.degrees() for x in polynomials], buried
        return self._last[1], self._last[2]

    def _put(self, polynomial: Polynomial, step: _Step, degree: int) -> tuple[Polynomial, int]:
        """(p, k) with polynomial = p/factor**k by the step, of that degree in its symbol."""
        ring, most = self.ring, int(degree) // step.degree
        if most <= 0:
            return polynomial, 0
        powers = _powers(ring, polynomial, step.symbol, int(degree))
        total, symbol = ring.zero, ring.context.gen(step.symbol)
        for power, coefficient in powers.items():
            times, left = divmod(power, step.degree)
            term = ring.times(coefficient, (-step.rest) ** times * step.factor ** (most - times))
            total = total + ring.times(term, symbol**left)
        return ring.reduce(total), most

    def _lowest(self, top: Polynomial, below: Sequence[tuple[Polynomial, int]]) -> _Fraction:
        """In lowest terms, the denominator in irreducible factors without numbers."""
        ring, factors = self.ring, list[tuple[Polynomial, int]]()
        for polynomial, exponent in below:
            if polynomial.is_constant():
                top = top / polynomial.leading_coefficient() ** exponent
                continue
            content, parts = ring.factored(polynomial)
            top = top / content**exponent
            for part, times in parts:
                count = times * exponent + next((n for x, n in factors if x == part), 0)
                factors = [(x, n) for x, n in factors if x != part] + [(part, count)]
        left = []
        for factor, count in factors:
            while count and (quotient := ring.quotient(top, factor)) is not None:
                top, count = quotient, count - 1
            if count:
                left.append((factor, count))
        return top, left

    # --- and back ----------------------------------------------------------------------------------------------------

    def back(self, written: Written) -> Polynomial:
        """With every letter's definition put back, in the ring ``whole``.  Raises what its arithmetic raises."""
        whole = self.ring.whole
        environment: dict[str, Any] = _named(whole)
        lower = Lowering(whole, dict(environment))
        environment |= {name: lower(value) for name, value in self.values.items()}
        return Carrier(self.ring, whole, environment)(written.polynomial)


def size(ring: Ring, polynomial: Polynomial) -> int:
    """How much of a formula there is to read (``shape.length``), what stands under roots and in functions with it."""
    angles = angles_or("shorter")
    held = (ring.generators[k] for k in ring.held([polynomial]))
    inside = [g.argument for g in held if g.argument is not None and g.kind != "reciprocal"]
    return sum(length(ring, present(ring, x, angles)) for x in (polynomial, *inside))


def _terms(fraction: _Fraction) -> int:
    """What is counted to see which of several fractions may be the shortest to read: terms and generators."""
    polynomials = [fraction[0], *(x for x, _ in fraction[1])]
    return sum(map(len, polynomials)) + len(occurring(polynomials))


def _constant(value: Expression, ring: Ring) -> bool:
    """Whether it is made of parameters alone."""
    return all(name == "pi" or ring.has("parameter", name) for name in names(value))


def _powers(ring: Ring, polynomial: Polynomial, index: int, degree: int | None = None) -> Mapping[int, Polynomial]:
    """By exponent of a generator, what stands before that power of it; ``degree``: the highest, where it is known."""
    powers: dict[int, Polynomial] = {}
    power = int(polynomial.degrees()[index]) if degree is None else degree
    while polynomial != 0 and power > 0:
        coefficient = polynomial
        for k in range(power):  # by derivatives: flint hands out the exponents of all generators, which are many
            coefficient = coefficient.derivative(index) / (k + 1)
        if coefficient != 0:
            powers[power] = coefficient
            polynomial = polynomial - coefficient * ring.context.gen(index) ** power
        power -= 1
    return powers if polynomial == 0 else {**powers, 0: polynomial}


def _named(ring: Ring) -> dict[str, Polynomial]:
    """By name, as descriptions have it, the generators that are not adjoined; ``pi`` among them."""
    plain = ("coordinate", "prescribed", "time", "parameter", "velocity", "acceleration")
    return {
        g.name + ENDINGS.get(g.kind, ""): ring.context.gen(k)
        for k, g in enumerate(ring.generators)
        if g.kind in plain and g.argument is None
    }
