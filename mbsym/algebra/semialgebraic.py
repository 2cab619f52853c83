"""Sets of parameters given by polynomial inequalities: unions of pieces, each a list of conditions that all hold.

Whether a set is empty is decided by, from cheap to dear:

* ``Signs``: a condition whose opposite follows from the others;
* one parameter left: the zeros of all polynomials, and a number between any two neighbouring ones;
* equations linear in a parameter: it is eliminated; p >= 0 is p > 0 or p = 0;
* strict inequalities in a few parameters: a number in every open cell of a cylindrical decomposition, whose projection
  needs leading coefficients, discriminants and resultants only (McCallum 1993; Strzebonski 2000);

or it is left open: an answer is exact, or none.  Parts of a piece that share no parameter are decided one by one.

Polynomials are ``fmpq_mpoly`` in generators that are free parameters; where others occur (roots, functions, constants)
only ``Signs`` are asked.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import partial
from itertools import combinations, pairwise
from typing import Any

from flint import fmpq, fmpq_poly

from mbsym.algebra.factors import irreducible_factors, occurring
from mbsym.algebra.failures import Failure, Limit, TooLargeError
from mbsym.algebra.plane.numbers import (
    AlgebraicNumber,
    Number,
    ascending,
    between_simply,
    number,
    primitive,
    roots_between,
    sign,
)
from mbsym.algebra.signs import MOST_TERMS, RELATIONS, ContradictionError, Polynomial, Signs
from mbsym.algebra.terms import coefficients_in, univariate

#: Pieces of a set, parameters and degree of what is decomposed, cells and branches that are looked at.
MOST_PIECES, MOST_PARAMETERS, MOST_DEGREE, MOST_CELLS, MOST_BRANCHES = 200, 4, 24, 2_000, 60
#: Conditions with more terms in all, and more conditions, are not searched.
MOST_TERMS_SEARCHED, MOST_SEARCHED = 60, 12
#: Of more conditions at once, and of longer ones, it is not asked whether one contradicts the others.
MOST_COMPARED, MOST_TERMS_COMPARED = 8, 40

_NEGATED = {">": (">=", -1), ">=": (">", -1), "=": ("!=", 1), "!=": ("=", 1)}
_TURNED = {"<": ">", "<=": ">="}
_ALLOWED = RELATIONS | {"=": frozenset({0})}
#: What the words of ``Signs`` mean, as relations to 0; of the negative ones for the opposite.
_OF_WORD = {"positive": (1, ">"), "nonnegative": (1, ">="), "negative": (-1, ">"), "nonpositive": (-1, ">=")}


class Emptiness(Enum):
    """What is known of a set."""

    EMPTY = "empty"
    INHABITED = "not empty"
    OPEN = "not decided"


@dataclass(frozen=True)
class Atom:
    """``polynomial`` ``relation`` 0, with one of > >= = !=."""

    polynomial: Polynomial
    relation: str

    def __hash__(self) -> int:
        """Polynomials have none; they may have a million terms, and are compared quicker than written."""
        terms = len(self.polynomial)
        return hash((terms, self.polynomial.monomial(0) if terms else (), self.relation))

    @property
    def constant(self) -> bool:
        return len(self.polynomial) <= 1 and bool(self.polynomial.is_constant())

    @property
    def rank(self) -> tuple[str, str]:
        """Its place in a piece; where that is too long to be searched the order is no matter."""
        return (str(self.polynomial) if len(self.polynomial) <= MOST_TERMS_SEARCHED else ""), self.relation

    def negated(self) -> Atom:
        relation, factor = _NEGATED[self.relation]
        return Atom(self.polynomial * factor, relation)


def atom(polynomial: Polynomial, relation: str) -> Atom:
    """The condition, with < and <= turned round."""
    return Atom(-polynomial, _TURNED[relation]) if relation in _TURNED else Atom(polynomial, relation)


Piece = tuple[Atom, ...]


@dataclass(frozen=True)
class ParameterSet:
    """The union of its ``pieces``; operations raise TooLargeError where these are too many."""

    pieces: tuple[Piece, ...]

    def __or__(self, other: ParameterSet) -> ParameterSet:
        return _of((*self.pieces, *other.pieces))

    def __and__(self, other: ParameterSet) -> ParameterSet:
        return _of((*piece, *two) for piece in self.pieces for two in other.pieces)

    def complement(self) -> ParameterSet:
        parameter_set = EVERYTHING
        for piece in self.pieces:
            parameter_set = parameter_set & ParameterSet(tuple((condition.negated(),) for condition in piece))
        return parameter_set

    def inner(self) -> ParameterSet:
        """A set that has inner points where this one has, and that is empty where it has none."""
        return ParameterSet(
            tuple(
                tuple(
                    Atom(condition.polynomial, ">")
                    if condition.relation == ">=" and condition.polynomial != 0
                    else condition
                    for condition in piece
                )
                for piece in self.pieces
                if not any(condition.relation == "=" and condition.polynomial != 0 for condition in piece)
            )
        )

    def witness(self, signs: Signs) -> tuple[Emptiness, Mapping[int, Any] | None]:
        """Whether no parameters with these signs and assumptions are in it, and rational values of parameters that are.

        Values are by generator, where some were found; others are free.
        """
        for point in _points(signs):
            if self.holds(point):
                return Emptiness.INHABITED, dict(enumerate(point))
        answer = Emptiness.EMPTY
        for piece in self.pieces:
            emptiness, at = _decided(piece, signs)
            if emptiness is Emptiness.INHABITED:
                return emptiness, at
            answer = emptiness if emptiness is Emptiness.OPEN else answer
        return answer, None

    def is_empty(self, signs: Signs) -> bool:
        """Whether it is proved that no parameters are in it."""
        if any(self.holds(point) for point in _points(signs)):
            return False
        return all(_decided(piece, signs)[0] is Emptiness.EMPTY for piece in self.pieces)

    def holds(self, point: Sequence[Any]) -> bool:
        """Whether a point, with a value for each generator, is in it."""
        return any(
            all(_holds(condition.polynomial(*point), condition.relation) for condition in piece)
            for piece in self.pieces
        )


def _of(pieces: Iterable[Piece]) -> ParameterSet:
    kept_pieces: dict[frozenset[Atom], Piece] = {}
    for piece in pieces:
        plain: dict[Atom, None] = {}
        for condition in piece:
            if not condition.constant:
                plain[condition] = None
            elif not _holds(_number(condition.polynomial), condition.relation):
                break
        else:
            kept_pieces.setdefault(frozenset(plain), tuple(plain))
        if len(kept_pieces) > MOST_PIECES:
            raise TooLargeError("a set of parameters in too many pieces", limit=Limit.WORK)
    return ParameterSet(tuple(kept_pieces.values()))


EVERYTHING, NOTHING = ParameterSet(((),)), ParameterSet(())


def where(*atoms: Atom) -> ParameterSet:
    """The set in which all of these hold."""
    return _of([atoms])


def _points(signs: Signs) -> tuple[tuple[Any, ...], ...]:
    """Some points that keep what is known, where all generators are free parameters."""
    return () if signs.numbers or signs.normal is not None else signs.witnesses


def _number(p: Polynomial) -> Any:
    return p.leading_coefficient() if p != 0 else fmpq(0)


def _holds(value: Any, relation: str) -> bool:
    return sign(value) in _ALLOWED[relation]


# --- one piece ---


def _decided(piece: Piece, signs: Signs) -> tuple[Emptiness, Mapping[int, Any] | None]:
    """Each piece is decided once for the same knowledge, whatever the order of its conditions."""
    known, key = signs.emptiness, frozenset(piece)
    if key not in known:
        known[key] = _decide(tuple(sorted(dict.fromkeys(piece), key=lambda condition: condition.rank)), signs)
    return known[key]


def _decide(piece: Piece, signs: Signs) -> tuple[Emptiness, Mapping[int, Any] | None]:
    piece = tuple(Atom(signs.normalised(condition.polynomial), condition.relation) for condition in piece)
    if _excluded(piece, signs):
        return Emptiness.EMPTY, None
    used = set(occurring(condition.polynomial for condition in piece))
    if signs.numbers or signs.normal is not None:
        return Emptiness.OPEN, None
    related = list(_related(signs, used))
    whole = [*piece, *related, *_words(signs, used)]
    if sum(len(condition.polynomial) for condition in piece) > MOST_TERMS_SEARCHED or len(piece) > MOST_SEARCHED:
        return Emptiness.OPEN, None
    for chosen, complete in (
        (whole, True),
        ([*piece, *_words(signs, set(occurring(x.polynomial for x in piece)))], False),
    ):
        try:
            point = _Search(signs).solve(chosen)
        except (Failure, _OutOfBudget):
            continue
        if point is None:
            return Emptiness.EMPTY, None
        if complete:
            return Emptiness.INHABITED, point
    return Emptiness.OPEN, None


def _excluded(piece: Piece, signs: Signs) -> bool:
    """Whether the opposite of a condition follows from the others."""
    short = sorted(piece, key=lambda condition: len(condition.polynomial))[:MOST_COMPARED]
    short = [condition for condition in short if len(condition.polynomial) <= MOST_TERMS_COMPARED]
    try:
        for k, condition in enumerate(short):
            others = [x for j, other in enumerate(short) if j != k for x in _assumed(other)]
            word = signs.assuming(others).sign(condition.polynomial)
            if not _SETS[word] & _ALLOWED[condition.relation]:
                return True
    except ContradictionError:
        return True
    return False


_SETS: dict[str, frozenset[int]] = {
    "positive": frozenset({1}),
    "nonnegative": frozenset({0, 1}),
    "zero": frozenset({0}),
    "nonzero": frozenset({-1, 1}),
    "nonpositive": frozenset({-1, 0}),
    "negative": frozenset({-1}),
    "unknown": frozenset({-1, 0, 1}),
}


def _assumed(condition: Atom) -> Iterator[tuple[Polynomial, str]]:
    if condition.relation == "=":
        yield condition.polynomial, ">="
        yield -condition.polynomial, ">="
    else:
        yield condition.polynomial, condition.relation


def _related(signs: Signs, used: set[int]) -> Iterator[Atom]:
    """The assumptions about the parameters that occur, and those about what these bring in; they join ``used``."""
    left = list(signs.assumptions)
    while True:
        related = [x for x in left if used & set(occurring([x[0]]))]
        if not related:
            return
        left = [x for x in left if not any(x is y for y in related)]
        for polynomial, relation in related:
            used.update(occurring([polynomial]))
            yield Atom(polynomial, relation)


def _words(signs: Signs, used: Iterable[int]) -> Iterator[Atom]:
    """The declared signs of the parameters that occur."""
    for k in used:
        x, word = signs.context.gen(k), signs.words[k]
        if word in _OF_WORD:
            factor, relation = _OF_WORD[word]
            yield Atom(x * factor, relation)
        elif word == "nonzero":
            yield Atom(x, "!=")
        elif word == "zero":
            yield Atom(x, "=")


class _OutOfBudget(Exception):
    """Left open."""


class _Search:
    """Parameters at which conditions hold."""

    def __init__(self, signs: Signs) -> None:
        self.context = signs.context
        self.branches, self.cells = MOST_BRANCHES, MOST_CELLS

    def solve(self, atoms: Sequence[Atom]) -> dict[int, Any] | None:
        """Values of parameters (numbers, exact), or None where there are none.  Raises _OutOfBudget."""
        self.branches -= 1
        if self.branches < 0:
            raise _OutOfBudget
        kept_atoms: dict[Atom, None] = {}
        for condition in atoms:
            if not condition.constant:
                kept_atoms[condition] = None
            elif not _holds(_number(condition.polynomial), condition.relation):
                return None
        point: dict[int, Any] = {}
        open_ones = False
        for part in sorted(_components(list(kept_atoms)), key=lambda part: len(_variables(part))):
            try:
                there = self._component(part)
            except _OutOfBudget:
                open_ones = True
                continue
            if there is None:
                return None
            point |= there
        if open_ones:
            raise _OutOfBudget
        return point

    def _component(self, atoms: list[Atom]) -> dict[int, Any] | None:
        variables = _variables(atoms)
        if len(variables) == 1:
            return self._on_line(atoms, variables[0])
        for k, one in enumerate(atoms):
            if one.relation == "=":
                return self._with_equation(one, [x for j, x in enumerate(atoms) if j != k])
        weak = next((k for k, one in enumerate(atoms) if one.relation == ">="), None)
        if weak is None:
            return self._in_cells(atoms, variables)
        rest, p = [x for j, x in enumerate(atoms) if j != weak], atoms[weak].polynomial
        return self._first(partial(self.solve, [Atom(p, relation), *rest]) for relation in (">", "="))

    def _first(self, searches: Iterable[Callable[[], dict[int, Any] | None]]) -> dict[int, Any] | None:
        """What the first search with a result finds; left open if one that ran out of budget might have found more."""
        left_open = False
        for search in searches:
            try:
                point = search()
            except _OutOfBudget:
                left_open = True
                continue
            if point is not None:
                return point
        if left_open:
            raise _OutOfBudget
        return None

    # --- one parameter ---

    def _on_line(self, atoms: list[Atom], x: int) -> dict[int, Any] | None:
        polynomials = [univariate(condition.polynomial, x) for condition in atoms]
        zeros = _zeros(polynomials)
        for value in (*_between(zeros), *zeros):
            self._cell()
            if all(_holds_there(p, value, condition.relation) for p, condition in zip(polynomials, atoms, strict=True)):
                return {x: value}
        return None

    # --- equations ---

    def _with_equation(self, equation: Atom, rest: list[Atom]) -> dict[int, Any] | None:
        return self._first(partial(self._on_zeros, f, rest) for f, _ in irreducible_factors(equation.polynomial)[1])

    def _on_zeros(self, factor: Polynomial, rest: list[Atom]) -> dict[int, Any] | None:
        """Where an irreducible factor vanishes: a parameter that it is linear in is eliminated."""
        degrees = factor.degrees()
        linear = [k for k, d in enumerate(degrees) if d == 1]
        if not linear:
            return self._on_irrational_zeros(factor, rest)
        x = min(linear, key=lambda k: len(coefficients_in(factor, k)[1]))
        c, b = coefficients_in(factor, x)
        there = [Atom(_substituted(condition.polynomial, x, -c, b), condition.relation) for condition in rest]
        if not b.is_constant():
            there.append(Atom(b, "!="))
        left_open = False
        try:
            on_zeros = self.solve(there)
        except _OutOfBudget:
            on_zeros, left_open = None, True
        if on_zeros is not None:
            on_zeros = {k: fmpq(1) for k in occurring([c, b])} | on_zeros
            value = _value(-c, on_zeros, self.context) / _value(b, on_zeros, self.context)
            return on_zeros | {x: value}
        if not b.is_constant():
            on_zeros = self.solve([Atom(b, "="), Atom(c, "="), *rest])
        if on_zeros is None and left_open:
            raise _OutOfBudget
        return on_zeros

    def _on_irrational_zeros(self, factor: Polynomial, rest: list[Atom]) -> dict[int, Any] | None:
        """Nowhere, where no parameters keep the rest, or the factor has one parameter and no zeros; else left open."""
        used = occurring([factor])
        alone = [condition for condition in rest if occurring([condition.polynomial]) == used]
        if len(used) == 1 and self._on_line([Atom(factor, "="), *alone], used[0]) is None:
            return None
        if self.solve(rest) is None:
            return None
        raise _OutOfBudget

    # --- strict inequalities ---

    def _in_cells(self, atoms: list[Atom], variables: list[int]) -> dict[int, Any] | None:
        """Open conditions: f != 0 takes nothing away from an open set that is not empty."""
        if len(variables) > MOST_PARAMETERS:
            raise _OutOfBudget
        strict = [condition for condition in atoms if condition.relation == ">"]
        in_cells = self._cells(strict, _ordered(strict, variables))
        if in_cells is None:
            return None
        apart = [condition.polynomial for condition in atoms if condition.relation == "!="]
        if any(_value(p, in_cells, self.context) == 0 for p in apart):
            return self._moved(in_cells, strict, apart)
        return in_cells

    def _moved(self, point: dict[int, Any], strict: Sequence[Atom], apart: Sequence[Polynomial]) -> dict[int, Any]:
        """A point near by that is on no surface f = 0."""
        for power in range(4, 40):
            moved = {k: v + fmpq(2 * j + 1, 1 << power) for j, (k, v) in enumerate(sorted(point.items()))}
            inside = all(_value(condition.polynomial, moved, self.context) > 0 for condition in strict)
            if inside and all(_value(p, moved, self.context) != 0 for p in apart):
                return moved
        raise _OutOfBudget

    def _cells(self, strict: Sequence[Atom], order: Sequence[int]) -> dict[int, Any] | None:
        levels = [_irreducible([condition.polynomial for condition in strict])]
        for x in order[:-1]:
            levels.append(_projected(levels[-1], x))
        stages = list(zip(reversed(order), reversed(levels), strict=True))

        def lifted(at: int, values: dict[int, Any]) -> dict[int, Any] | None:
            if at == len(stages):
                return values
            x, factors = stages[at]
            zeros = _zeros([univariate(_put_in(f, values, self.context), x) for f in factors])
            for value in _between(zeros):
                self._cell()
                there = values | {x: value}
                if all(_not_broken(condition.polynomial, there, self.context) for condition in strict):
                    point = lifted(at + 1, there)
                    if point is not None:
                        return point
            return None

        return lifted(0, {})

    def _cell(self) -> None:
        self.cells -= 1
        if self.cells < 0:
            raise _OutOfBudget


def _variables(atoms: Sequence[Atom]) -> list[int]:
    return occurring(condition.polynomial for condition in atoms)


def _components(atoms: list[Atom]) -> list[list[Atom]]:
    """Conditions that share parameters, together."""
    parts: list[tuple[set[int], list[Atom]]] = []
    for condition in atoms:
        used, joined = set(occurring([condition.polynomial])), [condition]
        apart = []
        for other, held in parts:
            if other & used:
                used |= other
                joined = [*held, *joined]
            else:
                apart.append((other, held))
        parts = [*apart, (used, joined)]
    return [held for _, held in parts]


def _zeros(polynomials: Sequence[fmpq_poly]) -> list[Number]:
    """All real zeros, in their order."""
    factors: dict[str, Any] = {}
    for p in polynomials:
        if p.degree() > 0:
            if p.degree() > MOST_DEGREE:
                raise _OutOfBudget
            for factor, _ in primitive(p).factor()[1]:
                factors[str(factor)] = factor
    numbers: list[Number] = []
    for factor in factors.values():
        if factor.degree() == 1:
            numbers.append(fmpq(-factor[0], factor[1]))
        elif factor.degree() > 1:
            bound = fmpq(2) + max(abs(fmpq(c, factor.leading_coefficient())) for c in factor.coeffs())
            numbers += map(number, roots_between(factor, -bound, bound))
    return list(ascending(numbers))


def _between(zeros: Sequence[Number]) -> Iterator[Any]:
    """A rational number in each open interval between neighbouring zeros, and beyond the outer ones."""
    if not zeros:
        yield fmpq(1)
        return
    low = zeros[0] if isinstance(zeros[0], fmpq) else zeros[0].low
    high = zeros[-1] if isinstance(zeros[-1], fmpq) else zeros[-1].high
    yield fmpq(high.floor()) + 1
    for a, b in pairwise(zeros):
        yield between_simply(a, b)
    yield fmpq(low.ceil()) - 1


def _holds_there(p: fmpq_poly, value: Number, relation: str) -> bool:
    return (value.sign(p) if isinstance(value, AlgebraicNumber) else sign(p(value))) in _ALLOWED[relation]


def _substituted(p: Polynomial, x: int, top: Polynomial, bottom: Polynomial) -> Polynomial:
    """p at x = top/bottom times an even power of bottom, or p where x does not occur."""
    coefficients = coefficients_in(p, x)
    degree = len(coefficients) - 1
    if not degree:
        return p
    total, power = p * 0, p * 0 + 1
    for k in range(degree, -1, -1):
        total = total * top + coefficients[k] * power
        power = power * bottom
    return total * bottom if degree % 2 else total


def _put_in(p: Polynomial, values: Mapping[int, Any], context: Any) -> Polynomial:
    if not values:
        return p
    if any(not isinstance(v, fmpq) for v in values.values()):
        raise _OutOfBudget
    names = context.names()
    return p.subs({names[k]: v for k, v in values.items()})


def _value(p: Polynomial, values: Mapping[int, Any], context: Any) -> Any:
    """The value; parameters that nothing is asked of count as 1."""
    there = _put_in(p, values, context)
    if there.is_constant():
        return _number(there)
    return _number(_put_in(there, {k: fmpq(1) for k in occurring([there])}, context))


def _not_broken(p: Polynomial, values: Mapping[int, Any], context: Any) -> bool:
    """Whether p > 0, or not all of its parameters have values."""
    if not set(occurring([p])) <= values.keys():
        return True
    return bool(_number(_put_in(p, values, context)) > 0)


def _irreducible(polynomials: Iterable[Polynomial]) -> list[Polynomial]:
    factors: dict[str, Polynomial] = {}
    for p in polynomials:
        if p.is_constant():
            continue
        for factor, _ in irreducible_factors(p)[1]:
            factors[str(factor)] = factor
    return list(factors.values())


def _projected(factors: Sequence[Polynomial], x: int) -> list[Polynomial]:
    """Where none of these vanishes the factors have as many real zeros in x, apart from each other, all along."""
    there = [f for f in factors if f.degrees()[x]]
    name = factors[0].context().names()[x] if factors else ""
    made = [f for f in factors if not f.degrees()[x]]
    for f in there:
        made.append(coefficients_in(f, x)[-1])
        if f.degrees()[x] > 1:
            _affordable(f, f, x)
            made.append(f.discriminant(name))
    for f, g in combinations(there, 2):
        _affordable(f, g, x)
        made.append(f.resultant(g, name))
    return _irreducible(made)


def _affordable(f: Polynomial, g: Polynomial, x: int) -> None:
    """Raises _OutOfBudget where a resultant would be of a high degree."""
    if len(f) * len(g) > MOST_TERMS * MOST_TERMS // 4:
        raise _OutOfBudget
    if f.degrees()[x] * g.total_degree() + g.degrees()[x] * f.total_degree() > 2 * MOST_DEGREE:
        raise _OutOfBudget


def _ordered(strict: Sequence[Atom], variables: list[int]) -> list[int]:
    """The parameters in the order in which they are projected away: of low degree first."""
    polynomials = [condition.polynomial for condition in strict]

    def weight(x: int) -> tuple[int, int]:
        degrees = [p.degrees()[x] for p in polynomials]
        return max(degrees, default=0), sum(degrees)

    return sorted(variables, key=weight)
