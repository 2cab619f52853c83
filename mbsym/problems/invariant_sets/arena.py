"""The ring in which problem 10 works: parameters, multipliers and variables as generators without relations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.signs import Signs
from mbsym.formulas.formula import Formula

#: Families of more integrals than this are not looked at.
MOST_INTEGRALS = 5
#: Variables of fields that are looked at.
MOST_VARIABLES = 12
#: Different factors of denominators in the formulas that are shown.
SPARE = 40


@dataclass(frozen=True)
class Arena:
    """Generators by index in ``ring``; the field x' = numerators/denominator, its integrals and relations there."""

    ring: Ring
    parameters: tuple[int, ...]
    multipliers: tuple[int, ...]
    variables: tuple[int, ...]
    numerators: tuple[Polynomial, ...]
    denominator: Polynomial
    names: tuple[str, ...]
    integrals: tuple[Polynomial, ...]
    relations: tuple[Polynomial, ...]
    signs: Signs

    def name(self, index: int) -> str:
        return self.ring.generators[index].name

    def formula(self, numerator: Polynomial, denominator: Polynomial | None = None) -> Formula:
        """numerator/denominator as a formula."""
        ring = self.ring
        whole = Formula(ring, numerator)
        return whole if denominator is None or denominator == 1 else whole / Formula(ring, denominator)

    def derivative(self, p: Polynomial) -> Polynomial:
        """denominator * dp/dt."""
        total = self.ring.zero
        for index, slope in zip(self.variables, self.numerators, strict=True):
            total += p.derivative(index) * slope
        return total


def arena(
    field: PolynomialField,
    integrals: Sequence[tuple[str, Any]],
    signs: Mapping[str, str],
    assumptions: Sequence[tuple[Any, str]] = (),
) -> Arena:
    """``integrals``: names and polynomials of the field's context; ``signs``: what is declared of parameters, by name;
    ``assumptions``: polynomials of that context in parameters alone, and their relations to 0.

    Raises NoClosedForm where there are too many variables.
    """
    if len(field.variables) > MOST_VARIABLES:
        raise NoClosedForm(
            f"{len(field.variables)} variables: families of integrals of at most {MOST_VARIABLES} are looked at"
        )
    taken = {*field.parameters, *field.variables}
    count = min(len(integrals), MOST_INTEGRALS) - 1
    stem = next(
        stem
        for stem in ("lambda", "kappa", "multiplier", "lambda_multiplier")
        if not any(f"{stem}{k + 1}" in taken for k in range(count))
    )
    multipliers = tuple(f"{stem}{k + 1}" for k in range(count))
    every = [*field.parameters, *multipliers, *field.variables]
    positive = [name for name in field.parameters if signs.get(name) == "positive"]
    ring = Ring((), (), every, {}, positive, spare=SPARE)
    index = {name: ring.index("parameter", name) for name in every}
    moved = [ring.generator("parameter", name) for name in (*field.parameters, *field.variables)]

    def here(p: Any) -> Polynomial:
        return p.compose(*moved, ctx=ring.context)

    words = ["real"] * len(ring.generators)
    for name in field.parameters:
        words[index[name]] = signs.get(name, "real")
    words[ring.index("parameter", "pi")] = "positive"
    return Arena(
        ring,
        tuple(index[name] for name in field.parameters),
        tuple(index[name] for name in multipliers),
        tuple(index[name] for name in field.variables),
        tuple(here(p) for p in field.numerators),
        here(field.denominator),
        tuple(name for name, _ in integrals),
        tuple(here(p) for _, p in integrals),
        tuple(here(p) for p in field.relations),
        Signs(ring.context, tuple(words), tuple((here(p), relation) for p, relation in assumptions)),
    )
