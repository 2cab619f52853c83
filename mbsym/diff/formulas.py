"""Two formulas as text, compared exactly.

Both are parsed (nothing is ever evaluated by Python) and lowered into a ring that holds the names of these two alone.
Where sines, cosines, reciprocals and roots of numbers make up everything that is not polynomial, the ring decides;
behind other roots and functions a difference is proved by an enclosure without zero at a point, equality is left open.
"""

from __future__ import annotations

import random
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import lcm

from flint import arb, ctx

from mbsym.algebra.base import Lowering
from mbsym.algebra.failures import Failure
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.angles import linear_form
from mbsym.expressions.parser import DERIVED, parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.rates import ACCELERATION_ENDING, VELOCITY_ENDING
from mbsym.expressions.table import Table
from mbsym.expressions.tree import Call, Expression, Name, Negative, Operation, rewritten, walk
from mbsym.formulas.formula import Formula

#: Differences of more terms than this are counted, and their first term is told.
MOST_TERMS = 40

#: At so many points a difference is looked at that the ring cannot decide; the precision in bits.
POINTS, BITS = 8, 256

#: Reciprocals, roots and functions that one pair of formulas may hold.
_ADJOINED = 64

#: Adjoined elements behind which a nonzero normal form may hide a zero.
_OPEN = ("root", "function", "sine", "cosine")

_RATES = (ACCELERATION_ENDING, VELOCITY_ENDING)


@dataclass(frozen=True)
class Known:
    """What names mean on both sides: coordinates, the signs of parameters as far as the sides agree, and tables."""

    coordinates: frozenset[str] = frozenset()
    signs: Mapping[str, str] = field(default_factory=dict)
    tables: Mapping[str, Table] = field(default_factory=dict)


@dataclass(frozen=True)
class Comparison:
    """``equal`` is None where it cannot be decided; the values agree then at ``points`` points.

    ``difference`` is b - a in text, ``terms`` its length; of a long one ``first`` is the first term instead.  Without
    any of these the two could not be read as formulas.
    """

    equal: bool | None
    difference: str = ""
    terms: int = 0
    first: str = ""
    points: int = 0


def compared(a: str, b: str, known: Known) -> Comparison:
    """How b differs from a."""
    if a == b:
        return Comparison(True)
    trees = _parsed(a, known.tables), _parsed(b, known.tables)
    if trees[0] is None or trees[1] is None:
        return Comparison(False)
    try:
        return _in_ring(trees[0], trees[1], known)
    except (Failure, ZeroDivisionError):  # no closed form within the bounds, or a division by zero in one of them
        return Comparison(None)


#: How formulas call derivatives of a table: ``derivative(derivative(push))(x)``.
_SLOPE = re.compile(r"((?:derivative\()+)(\w+)(\)+)(?=\()")


def _parsed(text: str, tables: Mapping[str, Table]) -> Expression | None:
    called: dict[str, Table] = dict(tables)
    orders: dict[str, int] = {}

    def one_name(match: re.Match[str]) -> str:
        order = match[1].count("(")
        name = f"{match[2]}__{order}"
        if order == len(match[3]) and match[2] in tables:
            called[name], orders[name] = tables[match[2]], order
        return name

    try:
        text = _SLOPE.sub(one_name, text) if tables else text
        tree = parse_expression(text, Complaints(), lambda start, end: _NOWHERE, bounds=DERIVED, tables=called)
        return _with_slopes(tree, orders) if tree is not None and orders else tree
    except RecursionError:
        return None


def _with_slopes(tree: Expression, orders: Mapping[str, int]) -> Expression:
    """Calls of these names are those of the derivatives of their tables."""
    return rewritten(
        tree,
        lambda x: (
            Call(x.function, _with_slopes(x.argument, orders), table=x.table, order=orders[x.function])
            if isinstance(x, Call) and x.function in orders
            else None
        ),
    )


_NOWHERE = Span(1, 1, 1)


def _in_ring(a: Expression, b: Expression, known: Known) -> Comparison:
    ring, environment = _ring((a, b), known)
    lower = Lowering(ring, environment)
    difference = ring.reduce(lower(_balanced(b)) - lower(_balanced(a)))
    if ring.is_zero(difference):
        return Comparison(True)
    degrees = difference.degrees()
    if any(degrees[k] > 0 and g.kind in _OPEN for k, g in enumerate(ring.generators[: ring.spare])):
        apart, points = _numerically(ring, difference, known.signs)
        if not apart:
            return Comparison(None, points=points)
    terms = len(difference)
    if terms <= MOST_TERMS:
        return Comparison(False, str(Formula(ring, difference)), terms)
    monomial, coefficient = next(iter(difference.terms()))
    first = ring.context.from_dict({tuple(map(int, monomial)): coefficient})
    return Comparison(False, "", terms, str(Formula(ring, first)))


def _balanced(tree: Expression) -> Expression:
    """The same with long sums halved again and again: one by one, thousands of terms take millions of steps."""
    terms: list[Expression] = []
    while isinstance(tree, Operation) and tree.operator in ("+", "-"):
        terms.append(tree.right if tree.operator == "+" else Negative(tree.right))
        tree = tree.left
    terms.append(tree)
    while len(terms) > 1:
        pairs = [Operation("+", b, a) for a, b in zip(terms[::2], terms[1::2], strict=False)]
        terms = [*pairs, *(terms[-1:] if len(terms) % 2 else [])]
    return terms[0]


def _numerically(ring: Ring, x: Polynomial, signs: Mapping[str, str]) -> tuple[bool, int]:
    """Whether an enclosure at some point excludes zero; at how many points it has zero in it."""
    source, met = random.Random(1), 0
    with ctx.workprec(BITS):
        for _ in range(POINTS):
            values = {name: arb(source.randint(1, 99)) / 64 for name in ring.names()}
            values |= {name: -values[name] for name in values if signs.get(name) in ("negative", "nonpositive")}
            try:
                value = ring.evaluate(x, values)
            except ZeroDivisionError:
                continue
            if not value.is_finite():
                continue
            if not value.contains(0):
                return True, met
            met += 1
    return False, met


def _ring(trees: Sequence[Expression], known: Known) -> tuple[Ring, dict[str, Polynomial]]:
    """A ring of the names that occur, and each name's generator."""
    occurring = sorted({node.name for node in _nodes(trees) if isinstance(node, Name)} - {"pi", "t"})
    coordinates = {name for name in occurring if name in known.coordinates}
    rates: dict[str, tuple[str, str]] = {}
    for name in occurring:
        for suffix, kind in zip(_RATES, ("acceleration", "velocity"), strict=True):
            if name.endswith(suffix) and name.removesuffix(suffix) in known.coordinates:
                rates[name] = kind, name.removesuffix(suffix)
                coordinates.add(name.removesuffix(suffix))
                break
    order = {name: k for k, name in enumerate(known.signs)}  # formulas are printed in the order of the declarations
    parameters = [name for name in occurring if name not in coordinates and name not in rates]
    parameters.sort(key=lambda name: order.get(name, len(order)))
    positive = [name for name in parameters if known.signs.get(name) == "positive"]
    nonnegative = [name for name in parameters if known.signs.get(name) == "nonnegative"]
    angles = {name: whole for name, whole in sorted(_angles(trees).items()) if name not in rates}
    ring = Ring(sorted(coordinates), [], parameters, angles, positive, nonnegative, _ADJOINED)
    environment = {name: ring.generator("parameter", name) for name in (*parameters, "pi")}
    environment |= {name: ring.generator("coordinate", name) for name in coordinates}
    environment |= {name: ring.generator(*place) for name, place in rates.items()}
    return ring, environment | {"t": ring.generator("time", "t")}


def _nodes(trees: Sequence[Expression]) -> Iterator[Expression]:
    for tree in trees:
        yield from walk(tree)


def _angles(trees: Sequence[Expression]) -> dict[str, int]:
    """The names under sines and cosines, each with the common denominator of its coefficients there."""
    angles: dict[str, int] = {}
    for node in _nodes(trees):
        if isinstance(node, Call) and node.function in ("sin", "cos", "tan"):
            form = linear_form(node.argument)
            for name, coefficient in form.coefficients if form is not None else ():
                if not name.endswith(_RATES):
                    angles[name] = lcm(angles.get(name, 1), coefficient.denominator)
    return angles
