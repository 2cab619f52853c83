"""Derivatives of monomials along a polynomial field, modulo a prime: ranks and kernels, and what is lifted from them.

With parameters put in and reduced modulo p, a rank can only become smaller: the kernel over QQ(parameters) has at most
the dimension that is found here, whatever the prime and the values are.  That is what absence is proved by.
"""

from __future__ import annotations

import random
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

from flint import fmpz, nmod_mat

from mbsym.algebra.failures import Limit, NoClosedForm
from mbsym.algebra.matrices import Operators, PrimitiveRows, united
from mbsym.algebra.polynomial_field import PolynomialField, Term
from mbsym.algebra.terms import apart
from mbsym.expressions.message import Message

Exponents = tuple[int, ...]
#: A polynomial in the variables with coefficients modulo a prime.
Terms = dict[Exponents, int]

#: Primes: a rank is found modulo the first, and once more modulo the second where it is a check.
PRIMES = (2**61 - 1, 2**61 - 31)
#: Monomials that are coupled with each other: the matrix of a part is dense.
MOST_COUPLED = 1500
#: Monomials altogether.
MOST_MONOMIALS = 20_000
#: Terms of the derivatives of all monomials: what they take grows with them, in seconds and in memory.
MOST_TERMS = 6_000_000
#: What helps where there are too many.
SMALLER = "ask for a smaller --degree, or put in numbers with --set"


@dataclass(frozen=True)
class ModularField:
    """``field`` with its parameters put in at ``values`` (random where there is none), modulo ``prime``."""

    field: PolynomialField
    prime: int
    values: Mapping[str, int]

    @cached_property
    def slopes(self) -> tuple[tuple[tuple[Exponents, int], ...], ...]:
        """x'_i, times the denominator of the field."""
        return tuple(tuple(self._at(apart).items()) for apart in self.field.slopes_apart)

    def terms(self, p: Any) -> Terms:
        """A polynomial of the field's context at these parameters."""
        return self._at(self.field.apart(p))

    def _at(self, apart: Sequence[Term]) -> Terms:
        prime = self.prime
        numbers = [self.values[name] for name in self.field.parameters]
        terms: dict[Exponents, int] = {}
        for key, numerator, denominator, powers in apart:
            value = numerator if denominator == 1 else numerator * pow(denominator, -1, prime)
            for k, power in powers:
                value = value * (numbers[k] if power == 1 else pow(numbers[k], power, prime)) % prime
            terms[key] = (terms.get(key, 0) + value) % prime
        return {key: value for key, value in terms.items() if value}

    def derivative(self, monomial: Exponents) -> Terms:
        """denominator * d(x^a)/dt."""
        prime = self.prime
        terms: dict[Exponents, int] = {}
        for k, power in enumerate(monomial):
            if not power:
                continue
            base = (*monomial[:k], power - 1, *monomial[k + 1 :])
            for exponents, c in self.slopes[k]:
                key = tuple(map(int.__add__, base, exponents))
                terms[key] = (terms.get(key, 0) + power * c) % prime
        return {key: value for key, value in terms.items() if value}

    @cached_property
    def rules(self) -> tuple[tuple[Exponents, Terms], ...]:
        """Each relation: its leading monomial, and what stands for it.

        Raises NoClosedForm where two leading monomials share a variable: remainders would not be unique then.
        """
        found = []
        for relation in self.field.relations:
            terms = self.terms(relation)
            leading = max(terms)
            inverse = pow(-terms[leading], -1, self.prime)
            found.append((leading, {m: c * inverse % self.prime for m, c in terms.items() if m != leading}))
        if not self.field.are_solved:
            raise NoClosedForm(
                "unit vectors that are perpendicular to each other have relations that are not told apart, but for two "
                "of them in quasi-homogeneous equations"
            )
        return tuple(found)

    def reduced(self, terms: Terms) -> Terms:
        """Modulo the relations."""
        return _reduced(terms, self.rules, self.prime)


def at_random(field: PolynomialField, prime: int, seed: str = "") -> ModularField:
    """The field at parameters modulo ``prime`` at which its denominator does not vanish.

    Where it has square roots of numbers, modulo the first prime from there down (3 modulo 4) that has them, too.
    """
    source = random.Random(f"{seed} {prime}")
    squares = {name: int(square.leading_coefficient()) for name, square in field.roots}
    while any(pow(square, (prime - 1) // 2, prime) != 1 for square in squares.values()):
        prime = next(p for p in range(prime - 4 + (3 - prime) % 4, 2, -4) if fmpz(p).is_prime())
    roots = {name: pow(square, (prime + 1) // 4, prime) for name, square in squares.items()}
    for _ in range(20):
        numbers = {name: source.randrange(1, prime) for name in field.free_parameters} | roots
        modular_field = ModularField(field, prime, numbers)
        if modular_field.terms(field.denominator):
            return modular_field
    raise NoClosedForm("the equations divide by what vanishes at these values")


def _reduced(terms: Terms, rules: Sequence[tuple[Exponents, Terms]], prime: int) -> Terms:
    """Without multiples of the leading monomials of ``rules``."""
    known = [([(k, power) for k, power in enumerate(leading) if power], leading, tail) for leading, tail in rules]

    def rule(monomial: Exponents) -> tuple[Exponents, Terms] | None:
        for places, leading, tail in known:
            for k, power in places:
                if monomial[k] < power:
                    break
            else:
                return leading, tail
        return None

    todo = {monomial: c for monomial, c in terms.items() if rule(monomial)}
    if not todo:
        return terms
    done = {monomial: c for monomial, c in terms.items() if monomial not in todo}
    while todo:
        monomial, c = todo.popitem()
        rewriting = rule(monomial)
        if rewriting is None:
            done[monomial] = (done.get(monomial, 0) + c) % prime
        elif c:
            rest = tuple(map(int.__sub__, monomial, rewriting[0]))
            for m, d in rewriting[1].items():
                key = tuple(map(int.__add__, rest, m))
                todo[key] = (todo.get(key, 0) + c * d) % prime
    return {m: c for m, c in done.items() if c}


def times(a: Terms, b: Terms, prime: int) -> Terms:
    """The product."""
    terms: Terms = {}
    for m, c in a.items():
        for n, d in b.items():
            key = tuple(map(int.__add__, m, n))
            terms[key] = (terms.get(key, 0) + c * d) % prime
    return {m: c for m, c in terms.items() if c}


def remainder(f: Terms, level: Terms, prime: int) -> Terms:
    """f modulo a homogeneous polynomial: without multiples of its leading monomial."""
    leading = max(level)
    inverse = pow(-level[leading], -1, prime)
    return _reduced(f, [(leading, {m: c * inverse % prime for m, c in level.items() if m != leading})], prime)


@lru_cache(maxsize=64)
def monomials(weights: tuple[int, ...], weight: int) -> tuple[Exponents, ...]:
    """Every x^a with sum a_i weights_i = weight, those of the last variable first."""
    return tuple(_monomials(weights, weight))


def _monomials(weights: tuple[int, ...], weight: int) -> Iterator[Exponents]:
    if not weights:
        if weight == 0:
            yield ()
        return
    for power in range(weight // weights[0] + 1):
        for rest in _monomials(weights[1:], weight - power * weights[0]):
            yield (power, *rest)


def count(weights: Sequence[int], weight: int) -> int:
    """How many monomials of that weight there are, without making them."""
    numbers = [1] + [0] * weight
    for own_weight in weights:
        for k in range(own_weight, weight + 1):
            numbers[k] += numbers[k - own_weight]
    return numbers[weight]


def kernel(there: ModularField, columns: Sequence[Exponents], modulo: bool) -> list[Terms]:
    """A basis of the f on these monomials with  df/dt = 0  (``modulo`` the relations), over the prime field.

    Raises NoClosedForm where more monomials are coupled than ``MOST_COUPLED``, or derivatives have more terms than
    ``MOST_TERMS``.
    """
    images = []
    terms = 0
    for column in columns:
        image = there.derivative(column)
        images.append(there.reduced(image) if modulo else image)
        terms += len(images[-1])
        if terms > MOST_TERMS:
            message = Message(
                "the derivatives of [[count]] monomials have more than [[most]] terms",
                count=len(columns),
                most=MOST_TERMS,
            )
            raise NoClosedForm(message, limit=Limit.TERMS, remedy=SMALLER)
    return [{columns[k]: c for k, c in vector.items()} for vector in kernel_of(images, there.prime)]


def kernel_of(images: Sequence[Terms], prime: int) -> list[dict[int, int]]:
    """A basis of the combinations of ``images`` that are zero: coefficients by the places of the images.

    Raises NoClosedForm where more of them are coupled than ``MOST_COUPLED``.
    """
    basis: list[dict[int, int]] = []
    left = possible(images)
    for part in coupled([images[k] for k in left]):
        part = [left[k] for k in part]
        if len(part) > MOST_COUPLED:
            message = Message(
                "[[count]] monomials are coupled with each other, more than [[most]]",
                count=len(part),
                most=MOST_COUPLED,
            )
            raise NoClosedForm(message, limit=Limit.DEGREE, remedy=SMALLER)
        matrix = matrix_of([images[k] for k in part], prime)
        for vector in null_space(matrix):
            basis.append({part[k]: c for k, c in enumerate(vector) if c})
    return basis


def possible(images: Sequence[Terms]) -> list[int]:
    """Indices of the columns whose coefficient need not be zero: a row with a single entry says that its column's is,
    and without that column other rows may have a single one.  The kernel stays what it is; most of a matrix goes."""
    entries: defaultdict[Exponents, int] = defaultdict(int)
    places: defaultdict[Exponents, int] = defaultdict(int)  # the sum of the columns that are left: of one, its index
    for k, image in enumerate(images):
        for row, value in image.items():
            if value:
                entries[row] += 1
                places[row] += k
    single = [row for row, number in entries.items() if number == 1]
    left = dict.fromkeys(range(len(images)))
    while single:
        row = single.pop()
        if entries[row] != 1:
            continue
        k = places[row]
        del left[k]
        for other, value in images[k].items():
            if value:
                entries[other] -= 1
                places[other] -= k
                if entries[other] == 1:
                    single.append(other)
    return list(left)


def coupled(images: Sequence[Terms]) -> list[list[int]]:
    """Indices of columns that share rows, directly or through others: the matrix falls into such parts."""
    sharing: defaultdict[Exponents, list[int]] = defaultdict(list)
    for k, image in enumerate(images):
        for row in image:
            sharing[row].append(k)
    return sorted(map(sorted, united([*([k] for k in range(len(images))), *sharing.values()])))


def matrix_of(images: Sequence[Terms], prime: int) -> Any:
    """Columns are the images, rows the monomials in them."""
    rows = {key: k for k, key in enumerate(dict.fromkeys(key for image in images for key in image))}
    table = [[0] * len(images) for _ in range(max(1, len(rows)))]
    for k, image in enumerate(images):
        for key, value in image.items():
            table[rows[key]][k] = value
    return nmod_mat(table, prime)


def null_space(matrix: Any) -> list[list[int]]:
    """A basis, each vector with 1 in a place where the others have 0."""
    basis, nullity = matrix.nullspace()
    return [[int(basis[r, k]) for r in range(basis.nrows())] for k in range(nullity)]


def echelon(rows: Sequence[Terms], order: Sequence[Exponents], prime: int) -> tuple[list[Terms], list[Exponents]]:
    """The reduced echelon form of polynomials with respect to an order of monomials, and its pivots."""
    if not rows:
        return [], []
    matrix = nmod_mat([[row.get(exponents, 0) for exponents in order] for row in rows], prime)
    reduced, rank = matrix.rref()
    reduced_rows, pivots = [], []
    for r in range(rank):
        values = [int(reduced[r, k]) for k in range(len(order))]
        reduced_rows.append({exponents: c for exponents, c in zip(order, values, strict=True) if c})
        pivots.append(next(exponents for exponents, c in zip(order, values, strict=True) if c))
    return reduced_rows, pivots


# From a kernel modulo a prime to polynomials over QQ(parameters): the few monomials that occur, solved exactly.
#
# The image modulo a prime tells which monomials an integral is made of.  On these alone  sum c_a d(x^a)/dt = 0  is a
# small linear system over QQ[parameters]; it is solved by elimination with rows kept primitive.  What comes out is put
# into the field once more: an identity, whatever the prime was.


#: Monomials of an integral that is lifted, and terms of one entry while that is done.
MOST_SUPPORT, MOST_ENTRY = 120, 4000


def lifted(
    field: PolynomialField,
    support: Sequence[Exponents],
    modulo: bool,
    leading: Exponents,
    level: Any = None,
    cofactor: Sequence[Exponents] = (),
    factor: Any = None,
) -> Any | None:
    """The polynomial on these monomials with  df/dt = 0, primitive over ZZ[parameters], if it is one up to a factor.

    ``leading``: a monomial that occurs in it.  With a ``level`` V it is  df/dt = K V, K on the monomials ``cofactor``.
    With a ``factor`` K, a polynomial, it is  df/dt = K f.
    None where there is none (or more than one that has ``leading``).  Raises NoClosedForm where it outgrows its bounds.
    """
    if len(support) > MOST_SUPPORT:
        message = Message(
            "an integral has [[count]] monomials, more than [[most]]", count=len(support), most=MOST_SUPPORT
        )
        raise NoClosedForm(message, limit=Limit.TERMS, remedy=SMALLER)
    order = [exponents for exponents in support if exponents != leading]
    one = field.context.constant(1)
    scalars = [one]  # a basis over the rational functions of the other parameters
    for place in field.root_places:
        scalars += [scalar * field.context.gen(place) for scalar in scalars]
    columns = [monomial(field, column) * scalar for column in order for scalar in scalars]
    columns.append(monomial(field, leading))
    images = [field.derivative(column) for column in columns]
    if factor is not None:
        images = [image - factor * column for image, column in zip(images, columns, strict=True)]
    if modulo:
        images = [field.reduced(image) for image in images]
    multiples = [monomial(field, exponents) * level for exponents in cofactor]
    equations = _equations(field, [*images[:-1], *multiples, images[-1]])
    solved = _eliminated(field, equations, len(columns) - 1 + len(multiples))
    if solved is None:
        return None
    tops, bottoms = solved
    common = one
    for bottom in bottoms:
        common = common * (bottom / bottom.gcd(common))
    total = common * columns[-1]
    for column, top, bottom in zip(columns[:-1], tops, bottoms, strict=False):  # those of the cofactor follow
        total -= top * (common / bottom) * column
    polynomial = primitive(field, total)
    rate = field.derivative(polynomial)
    if factor is not None:
        return polynomial if rate == factor * polynomial else None
    if level is not None:  # the level is primitive over the parameters: by Gauss' lemma it divides there, too
        return polynomial if divmod(rate, level)[1] == 0 else None
    return polynomial if (field.reduced(rate) if modulo else rate) == 0 else None


def monomial(field: PolynomialField, exponents: Sequence[int]) -> Any:
    """x^a in the field's context."""
    return field.context.from_dict({(*(0,) * len(field.parameters), *exponents): 1})


def coefficients(field: PolynomialField, f: Any) -> dict[Exponents, Any]:
    """Polynomials in the parameters, by the monomials in the variables that they belong to."""
    return apart(f, field.places)


def primitive(field: PolynomialField, f: Any) -> Any:
    """Without the factor in the parameters that all coefficients share; integers without one; the leading one > 0."""
    parts = list(coefficients(field, f).values())
    if not parts:
        return f
    common = field.context.constant(0)
    for part in parts:
        common = common.gcd(part)
        if common.is_constant():
            break
    found = f if common.is_constant() else f / common
    numbers = list(found.to_dict().values())
    bottom = numbers[0].q
    for c in numbers[1:]:
        bottom = bottom * (c.q // bottom.gcd(c.q))
    top = numbers[0].p * (bottom // numbers[0].q)
    for c in numbers[1:]:
        top = top.gcd(c.p * (bottom // c.q))
    scaled = found * bottom / top
    return -scaled if scaled.leading_coefficient() < 0 else scaled


def _equations(field: PolynomialField, images: Sequence[Any]) -> list[dict[int, Any]]:
    """sum_k c_k images_k = 0, coefficient by coefficient; short ones first."""
    rows: dict[Exponents, dict[int, Any]] = {}
    for k, image in enumerate(images):
        for key, c in apart(image, [*field.root_places, *field.places]).items():
            rows.setdefault(key, {})[k] = c
    return sorted(rows.values(), key=lambda row: (len(row), sum(len(x) for x in row.values())))


def _eliminated(
    field: PolynomialField, rows: list[dict[int, Any]], unknowns: int
) -> tuple[list[Any], list[Any]] | None:
    """c_k = tops_k / bottoms_k  with the last unknown -1; None where they are not determined, or contradict."""
    zero, one = field.context.constant(0), field.context.constant(1)
    held = PrimitiveRows(Operators(zero, one), MOST_ENTRY, "the coefficients of an integral are too long", SMALLER)
    for equation in rows:
        row = held.reduced(equation)
        left = [k for k in row if k < unknowns]
        if left:
            held.add(row, min(left, key=lambda j: (len(row[j]), j)))
        elif row:
            return None
    pivots = held.pivots
    if len(pivots) < unknowns:
        return None
    tops, bottoms = [], []
    for k in range(unknowns):
        top, bottom = pivots[k].get(unknowns, zero), pivots[k][k]
        common = top.gcd(bottom) if top != 0 else bottom
        tops.append(top / common if top != 0 else zero)
        bottoms.append(bottom / common if top != 0 else one)
    return tops, bottoms
