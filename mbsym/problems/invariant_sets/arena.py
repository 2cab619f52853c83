"""The ring in which problem 10 works: parameters, multipliers and variables as generators without relations."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.signs import Signs
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Formula

#: Families of more integrals than this are not looked at.
MOST_INTEGRALS = 5
#: Variables of fields that are looked at.
MOST_VARIABLES = 12
#: Different factors of denominators in the formulas that are shown.
SPARE = 40


@dataclass(frozen=True)
class Arena:
    """Generators by index in ``ring``; the field x' = numerators/denominator, its integrals and relations there.

    ``floating``: so many multipliers, the last ones, belong to relations that alone make integrals of the others (sines
    and cosines of angles): they are Lagrange's, and need not be constant along a motion.  ``beside``: integrals that K
    does not hold, which are constant all the same.
    """

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
    floating: int = 0
    beside: tuple[Polynomial, ...] = ()

    @property
    def constant(self) -> tuple[int, ...]:
        """The multipliers that are constant along every motion."""
        return self.multipliers[: len(self.multipliers) - self.floating]

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


def identifiers(names: Sequence[str], others: Sequence[str]) -> list[str]:
    """``sin_theta`` for sin(theta): names that may stand in every language that is written."""
    found: list[str] = []
    for name in names:
        plain = re.sub(r"\W+", "_", name).strip("_") if not name.isidentifier() else name
        while plain in (*found, *others):
            plain += "_"
        found.append(plain)
    return found


def arena(
    field: PolynomialField,
    integrals: Sequence[tuple[str, Any]],
    signs: Mapping[str, str],
    assumptions: Sequence[tuple[Any, str]] = (),
    floating: int = 0,
) -> Arena:
    """``integrals``: names and polynomials of the field's context; ``signs``: what is declared of parameters, by name;
    ``assumptions``: polynomials of that context in parameters alone, and their relations to 0.

    Raises NoClosedForm where there are too many variables or integrals.
    """
    if len(integrals) > MOST_INTEGRALS:
        raise NoClosedForm(
            Message(
                "[[count]] integrals: families of at most [[most]] are looked at",
                count=len(integrals),
                most=MOST_INTEGRALS,
            )
        )
    if len(field.variables) > MOST_VARIABLES:
        raise NoClosedForm(
            Message(
                "[[count]] variables: families of integrals of at most [[most]] are looked at",
                count=len(field.variables),
                most=MOST_VARIABLES,
            )
        )
    variables = identifiers(field.variables, field.parameters)
    taken = {*field.parameters, *variables}
    count = min(len(integrals), MOST_INTEGRALS) - 1
    stem = next(
        stem
        for stem in ("lambda", "kappa", "multiplier", "lambda_multiplier")
        if not any(f"{stem}{k + 1}" in taken for k in range(count))
    )
    multipliers = tuple(f"{stem}{k + 1}" for k in range(count))
    every = [*field.parameters, *multipliers, *variables]
    positive = [name for name in field.parameters if signs.get(name) == "positive"]
    ring = Ring((), (), every, {}, positive, spare=SPARE)
    index = {name: ring.index("parameter", name) for name in every}
    moved = [ring.generator("parameter", name) for name in (*field.parameters, *variables)]

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
        tuple(index[name] for name in variables),
        tuple(here(p) for p in field.numerators),
        here(field.denominator),
        tuple(name for name, _ in integrals),
        tuple(here(p) for _, p in integrals),
        tuple(here(p) for p in field.relations),
        Signs(ring.context, tuple(words), tuple((here(p), relation) for p, relation in assumptions)),
        floating,
    )
