"""Polynomial vector fields over QQ(parameters): what integrals, invariant sets, normal and slow forms are found on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from flint import fmpq, fmpq_mpoly_ctx

Polynomial = Any  # a flint.fmpq_mpoly: python-flint carries no types
#: Exponents of the variables; numerator and denominator of the number; indices of parameters with their powers.
Term = tuple[tuple[int, ...], int, int, tuple[tuple[int, int], ...]]


@dataclass(frozen=True)
class PolynomialField:
    """x'_i = numerators[i](x) / denominator(x), autonomous.

    Generators of ``context`` are the ``parameters``, then the ``variables``.  ``denominator`` does not vanish where the
    field is regular (it holds det M, and what parameters are divided by).  ``relations`` vanish on all states and are
    kept by the field: the norm of a unit vector less 1, sin^2 + cos^2 - 1.  ``roots``: the parameters that are square
    roots, each with its square in those before it.  ``units``: variables that vanish in no state.
    """

    context: Any
    parameters: tuple[str, ...]
    variables: tuple[str, ...]
    numerators: tuple[Polynomial, ...]
    denominator: Polynomial
    relations: tuple[Polynomial, ...] = ()
    roots: tuple[tuple[str, Polynomial], ...] = ()
    units: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        if tuple(self.context.names()) != (*self.parameters, *self.variables):
            raise ValueError("the generators are the parameters, then the variables")
        if len(self.numerators) != len(self.variables):
            raise ValueError(f"{len(self.variables)} variables, but {len(self.numerators)} derivatives")

    @property
    def places(self) -> range:
        """The indices of the variables among the generators."""
        return range(len(self.parameters), len(self.parameters) + len(self.variables))

    def generator(self, name: str) -> Polynomial:
        return self.context.gen((*self.parameters, *self.variables).index(name))

    def apart(self, p: Polynomial) -> tuple[Term, ...]:
        """The terms of a polynomial, as whoever puts numbers in again and again wants them."""
        count = len(self.parameters)
        return tuple(
            (
                tuple(map(int, monomial[count:])),
                int(c.p),
                int(c.q),
                tuple((k, int(power)) for k, power in enumerate(monomial[:count]) if power),
            )
            for monomial, c in p.to_dict().items()
        )

    @cached_property
    def slopes_apart(self) -> tuple[tuple[Term, ...], ...]:
        """The terms of the numerators."""
        return tuple(self.apart(p) for p in self.numerators)

    def derivative(self, f: Polynomial) -> Polynomial:
        """denominator * df/dt = sum_i numerators[i] df/dx_i."""
        total = self.context.constant(0)
        for place, slope in zip(self.places, self.numerators, strict=True):
            total += f.derivative(place) * slope
        return self._remainder(total, self._squares)

    def reduced(self, f: Polynomial) -> Polynomial:
        """A remainder of f by the relations: of degree 1 at most in what stands first in each, and in square roots.

        Leading monomials, in the variables before the parameters, share no variable and have rational coefficients, so
        it is zero if and only if f is in their ideal.
        """
        return self._remainder(f, [*self._leading[1], *self._squares])

    def _remainder(self, f: Polynomial, divisors: Sequence[Polynomial]) -> Polynomial:
        if not divisors:
            return f
        f = f.project_to_context(self._leading[0])
        for divisor in divisors:
            f = divmod(f, divisor)[1]
        return f.project_to_context(self.context)

    @property
    def are_solved(self) -> bool:
        """Whether leading monomials of the relations are as ``reduced`` wants them."""
        count, taken = len(self.variables), set[int]()
        for relation in self._leading[1]:
            monomial = relation.monomial(0)
            held = {k for k, power in enumerate(monomial) if power}
            if not held or max(held) >= count or held & taken:
                return False
            taken |= held
        return True

    @cached_property
    def _leading(self) -> tuple[Any, list[Polynomial]]:
        """The context with the variables first, square roots after them, and the relations there.

        What stands for a leading monomial holds lower ones only, so that a later division undoes none before it.
        """
        roots = [name for name, _ in self.roots[::-1]]
        free = [name for name in self.parameters if name not in roots]
        context = fmpq_mpoly_ctx.get([*self.variables, *roots, *free], self.context.ordering())
        there = [relation.project_to_context(context) for relation in self.relations]
        return context, sorted(there, key=lambda relation: relation.monomial(0), reverse=True)

    @cached_property
    def _squares(self) -> list[Polynomial]:
        """r^2 - p of every square root r, in the context of ``_leading``, each before those under it."""
        context = self._leading[0]
        names = context.names()
        return [
            context.gen(names.index(name)) ** 2 - square.project_to_context(context)
            for name, square in self.roots[::-1]
        ]

    @cached_property
    def root_places(self) -> list[int]:
        """The indices of the square roots among the generators."""
        return [self.parameters.index(name) for name, _ in self.roots]

    @property
    def free_parameters(self) -> tuple[str, ...]:
        """Those that are no square roots."""
        return tuple(name for name in self.parameters if name not in dict(self.roots))

    def at(self, values: Mapping[str, fmpq | int]) -> PolynomialField:
        """The field with numbers in place of some parameters, which are no generators any more.

        Raises KeyError for a name that is no parameter, ZeroDivisionError where the denominator vanishes.
        """
        unknown = [name for name in values if name not in self.parameters]
        if unknown:
            raise KeyError(unknown[0])
        remaining = [name for name in self.parameters if name not in values]
        context = fmpq_mpoly_ctx.get([*remaining, *self.variables], self.context.ordering())
        images = [
            context.constant(fmpq(values[name]) if isinstance(values[name], int) else values[name])
            if name in values
            else context.gen((*remaining, *self.variables).index(name))
            for name in (*self.parameters, *self.variables)
        ]

        def moved(p: Polynomial) -> Polynomial:
            return p.compose(*images, ctx=context)

        denominator = moved(self.denominator)
        if denominator == 0:
            raise ZeroDivisionError("the denominator of the field vanishes at these values")
        return replace(
            self,
            context=context,
            parameters=tuple(remaining),
            numerators=tuple(map(moved, self.numerators)),
            denominator=denominator,
            relations=tuple(r for r in map(moved, self.relations) if r != 0),
            roots=tuple((name, moved(square)) for name, square in self.roots),
        )


def in_lowest_terms(numerators: Sequence[Polynomial], denominator: Polynomial) -> tuple[list[Polynomial], Polynomial]:
    """Without the factor that all of them share; the leading coefficient of the denominator is 1."""
    common = denominator
    for p in numerators:
        common = common.gcd(p)
        if common.is_constant():
            break
    common = (
        common * (denominator / common).leading_coefficient()
        if not common.is_constant()
        else denominator.leading_coefficient() * (denominator * 0 + 1)
    )
    return [p / common for p in numerators], denominator / common
