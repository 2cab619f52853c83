"""Carries a polynomial of the ring into any other algebra: generators one by one, then sums of products."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from types import MappingProxyType
from typing import Any

from flint import arb, fmpq

from mbsym.algebra import rationals
from mbsym.algebra.base import Algebra, Scalar
from mbsym.algebra.failures import NoValue
from mbsym.algebra.point import BallsAtRationals, Rationals
from mbsym.algebra.ring import Generator, Polynomial, Ring
from mbsym.expressions.angles import LinearForm
from mbsym.expressions.rates import ENDINGS, acceleration_name, velocity_name


class Carrier:
    """Evaluates ring polynomials in ``algebra``; ``environment`` gives the declared names' values there.

    ``known``: values of generators, by their indices, that are not made of these.
    """

    def __init__(
        self,
        ring: Ring,
        algebra: Algebra,
        environment: Mapping[str, Scalar],
        known: Mapping[int, Scalar] = MappingProxyType({}),
    ) -> None:
        self.ring = ring
        self.algebra = algebra
        self.environment = environment
        self._known: dict[int, Scalar] = dict(known)
        self._powers: dict[tuple[int, int], Scalar] = {}
        self._exact: dict[int, fmpq | None] = {}

    def __call__(self, x: Polynomial) -> Scalar:
        """sum of coefficient * product of powers of generators."""
        algebra = self.algebra
        if not x:  # most entries of a large mass matrix
            return algebra.zero
        if isinstance(algebra, Rationals):
            used = x.degrees()
            self.ring.spend(len(x))
            return x(*(self._generator(k) if used[k] > 0 else algebra.zero for k in range(len(used))))
        if isinstance(algebra, BallsAtRationals):
            return self._enclosed(x, algebra)
        return self.termwise([(c, [(k, int(n)) for k, n in enumerate(monomial) if n]) for monomial, c in x.terms()])

    def termwise(self, terms: Sequence[tuple[fmpq, Sequence[tuple[int, int]]]]) -> Scalar:
        """The sum of terms given as a coefficient and (generator, exponent) pairs."""
        algebra = self.algebra
        self.ring.spend(20 * len(terms))
        total = algebra.zero
        for coefficient, factors in terms:
            term = algebra.number(rationals.fraction(coefficient))
            for index, exponent in factors:
                term = algebra.times(term, self._power(index, exponent))
            total = total + term
        return algebra.reduce(total)

    def _enclosed(self, x: Polynomial, algebra: BallsAtRationals) -> arb:
        """x as q*g + r for an irrational generator g, and so on with q and r, until all that is left is rational.

        No term is looked at one by one: a ring of many generators has long exponent vectors.
        """
        self.ring.spend(2 * len(x))
        degrees = x.degrees()
        values = [fmpq(0)] * len(degrees)
        for k, degree in enumerate(degrees):
            if degree > 0:
                value = self._rational(k, algebra)
                if value is None:
                    quotient, rest = divmod(x, self.ring.context.gen(k))
                    ball = self._generator(k) * self._enclosed(quotient, algebra)
                    return ball + self._enclosed(rest, algebra) if rest else ball
                values[k] = value
        return arb(x(*values))

    def _rational(self, index: int, algebra: BallsAtRationals) -> fmpq | None:
        """The exact value of a generator, or None where only a ball is known."""
        if index not in self._exact:
            self._exact[index] = self._exactly(self.ring.generators[index], algebra)
        return self._exact[index]

    def _exactly(self, g: Generator, algebra: BallsAtRationals) -> fmpq | None:
        if g.kind in ("sine", "cosine") and g.argument is None:
            # the generator is the sine of name/denominator, which is what the half-angle tangent belongs to
            return algebra.basic[g.name][0 if g.kind == "sine" else 1]
        name = g.name + ENDINGS.get(g.kind, "")
        # a name may have been given another value here than at the state
        own = g.argument is None and name in algebra.exact and self.environment.get(name) is algebra.values[name]
        return algebra.exact[name] if own else None

    def _power(self, index: int, exponent: int) -> Scalar:
        key = (index, exponent)
        if key not in self._powers:
            self._powers[key] = self.algebra.power(self._generator(index), exponent)
        return self._powers[key]

    def _generator(self, index: int) -> Scalar:
        if index not in self._known:
            self._known[index] = self._value(self.ring.generators[index])
        return self._known[index]

    def _value(self, g: Generator) -> Any:
        match g.kind:
            case "sine" | "cosine" if g.argument is None:
                form = LinearForm(((g.name, Fraction(1, g.denominator)),))
                return self.algebra.sin_cos(form)[0 if g.kind == "sine" else 1]
            case "reciprocal":
                return self.algebra.reciprocal(self(g.argument))
            case "root":
                return self.algebra.principal_root(self(g.argument))
            case "function":
                return self.algebra.function(g.name, self(g.argument))
            case "velocity":
                return self._named(velocity_name(g.name))
            case "acceleration":
                return self._named(acceleration_name(g.name))
            case "sine" | "cosine":
                return self.algebra.sin_cos_of(self(g.argument))[0 if g.kind == "sine" else 1]
        return self._named(g.name)

    def _named(self, name: str) -> Scalar:
        if name not in self.environment:
            raise NoValue(name)
        return self.environment[name]


def at_rationals(ring: Ring, values: Mapping[str, Any]) -> Carrier:
    """Evaluates exactly where the values are fractions; others have no value there."""
    algebra = Rationals({}, {})
    return Carrier(
        ring, algebra, {name: algebra.number(value) for name, value in values.items() if isinstance(value, Fraction)}
    )
