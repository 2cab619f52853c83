"""Sparse polynomials in a few variables over any scalars, everything beyond an order dropped.

What jets are over the ring these are over numbers: enclosures (``acb``), elements of a tower (``mbsym.algebra.tower``),
rationals.  Of a scalar only ``+ - *`` and comparison with 0 are asked.  Normal forms are made of them: products,
derivatives, Poisson brackets, substitution.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from operator import mul
from typing import Any

#: The exponents of a product of powers, one for each variable.
Exponents = tuple[int, ...]
Coefficients = dict[Exponents, Any]


class Space:
    """Polynomials in ``variables`` variables up to degree ``order``; ``zero`` and ``one`` are those of the scalars."""

    def __init__(self, variables: int, order: int, zero: Any, one: Any) -> None:
        self.variables, self.order = variables, order
        self.zero, self.one = zero, one

    def constant(self, value: Any) -> Truncated:
        return Truncated(self, {(0,) * self.variables: value})

    def variable(self, index: int) -> Truncated:
        return Truncated(self, {tuple(int(k == index) for k in range(self.variables)): self.one})

    @property
    def nothing(self) -> Truncated:
        return Truncated(self, {})

    def of(self, terms: Mapping[tuple[int, ...], Any]) -> Truncated:
        """From coefficients by the variables in a product, (0, 0, 3) for x_0^2 x_3, as jets have them."""
        coefficients: Coefficients = {}
        for key, value in terms.items():
            exponents = [0] * self.variables
            for index in key:
                exponents[index] += 1
            coefficients[tuple(exponents)] = value
        return Truncated(self, coefficients)

    def linear(self, row: Iterable[Any]) -> Truncated:
        """sum row_k x_k."""
        return self.of({(k,): value for k, value in enumerate(row)})


class Truncated:
    """sum of ``coefficients`` times products of powers."""

    __slots__ = ("coefficients", "space")

    def __init__(self, space: Space, coefficients: Coefficients) -> None:
        self.space = space
        self.coefficients = {k: v for k, v in coefficients.items() if sum(k) <= space.order and not _is_zero(v)}

    def __add__(self, other: Truncated) -> Truncated:
        total = dict(self.coefficients)
        for key, value in other.coefficients.items():
            total[key] = total[key] + value if key in total else value
        return Truncated(self.space, total)

    def __neg__(self) -> Truncated:
        return Truncated(self.space, {key: -value for key, value in self.coefficients.items()})

    def __sub__(self, other: Truncated) -> Truncated:
        return self + (-other)

    def __mul__(self, other: Truncated) -> Truncated:
        # Exponents are digits of a number while their sums are at most the order: it is quicker to add numbers.
        order, base = self.space.order, self.space.order + 1
        weights = [base**k for k in range(self.space.variables)]
        right = [(sum(map(mul, b, weights)), sum(b), y) for b, y in other.coefficients.items()]
        fitting: dict[int, list[tuple[int, Any]]] = {}
        total: dict[int, Any] = {}
        for a, x in self.coefficients.items():
            first, left = sum(map(mul, a, weights)), order - sum(a)
            if left not in fitting:
                fitting[left] = [(second, y) for second, degree, y in right if degree <= left]
            for second, y in fitting[left]:
                key = first + second
                total[key] = total[key] + x * y if key in total else x * y
        return Truncated(self.space, {tuple(key // w % base for w in weights): x for key, x in total.items()})

    def scaled(self, factor: Any) -> Truncated:
        return Truncated(self.space, {key: value * factor for key, value in self.coefficients.items()})

    def mapped(self, change: Callable[[Any], Any], space: Space) -> Truncated:
        """The same over other scalars."""
        return Truncated(space, {key: change(value) for key, value in self.coefficients.items()})

    def derivative(self, index: int) -> Truncated:
        total: Coefficients = {}
        for key, value in self.coefficients.items():
            if key[index]:
                lower = (*key[:index], key[index] - 1, *key[index + 1 :])
                total[lower] = value * key[index]
        return Truncated(self.space, total)

    def part(self, degree: int) -> Truncated:
        """The terms of one degree."""
        return Truncated(self.space, {k: v for k, v in self.coefficients.items() if sum(k) == degree})

    def beyond(self, degree: int) -> Truncated:
        """The terms of higher degree than that."""
        return Truncated(self.space, {k: v for k, v in self.coefficients.items() if sum(k) > degree})

    def __getitem__(self, key: Exponents) -> Any:
        return self.coefficients.get(key, self.space.zero)

    def depends_on(self, index: int) -> bool:
        return any(key[index] for key in self.coefficients)

    def composed(self, images: Sequence[Truncated]) -> Truncated:
        """With ``images`` for the variables; they may live in another space, in which the result is then."""
        space = images[0].space
        powers = [[space.constant(space.one)] for _ in images]
        partial: dict[Exponents, Truncated] = {}

        def product(key: Exponents, length: int) -> Truncated:
            head = key[:length]
            if head not in partial:
                known = powers[length - 1]
                while len(known) <= key[length - 1]:
                    known.append(known[-1] * images[length - 1])
                before = product(key, length - 1) if length > 1 else space.constant(space.one)
                partial[head] = before * known[key[length - 1]] if key[length - 1] else before
            return partial[head]

        total = space.nothing
        for key, value in self.coefficients.items():
            total = total + product(key, len(key)).scaled(value)
        return total


def _is_zero(x: Any) -> bool:
    known = getattr(x, "is_zero", None)
    return bool(x == 0) if known is None else bool(known())


def bracket(f: Truncated, g: Truncated) -> Truncated:
    """{f, g} = sum_k df/dx_k dg/dy_k - df/dy_k dg/dx_k in the variables x_1 ... x_n, y_1 ... y_n."""
    n, total = f.space.variables // 2, f.space.nothing
    for k in range(n):
        for i, j, sign in ((k, n + k, 1), (n + k, k, -1)):
            if f.depends_on(i) and g.depends_on(j):
                product = f.derivative(i) * g.derivative(j)
                total = total + product if sign > 0 else total - product
    return total


def flow(f: Truncated, generator: Truncated) -> Truncated:
    """f + {f, g} + {{f, g}, g}/2! + ...: what f becomes by the canonical transformation of g, of degree > 2.

    The bracket of terms of degrees a and b > 2 has degree a + b - 2 > a: no term beyond the order comes back.
    """
    total, term, count = f, f, 0
    while term.coefficients:
        count += 1
        term = bracket(term, generator)
        term = Truncated(f.space, {key: value / count for key, value in term.coefficients.items()})
        total = total + term
    return total
