"""Antiderivatives of elements of the ring, and potentials of fields of them, where they have a closed form there.

W with dW/dx = F is looked for as a combination, with rational numbers, of monomials: those of F with the powers of x,
of the sine and cosine of x and of what is adjoined to the ring and depends on x raised or lowered by one, then those
that their derivatives bring in.  It is linear algebra over the rationals, and what is found is proved by
differentiation; where nothing is found there may be a closed form all the same.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import product
from typing import Any

from flint import fmpq_mat

from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import Failure
from mbsym.algebra.matrices import reduced_rows
from mbsym.algebra.ring import Polynomial, Ring

#: Longer functions are left alone; so many monomials are tried, in so many rounds.
MOST_TERMS, MOST_TRIED, ROUNDS = 60, 400, 4

Exponents = tuple[int, ...]


def potential(ring: Ring, field: Sequence[Polynomial], names: Sequence[str]) -> Polynomial | None:
    """W with dW/d(name) = F for every name and component of a field; None where none was found."""
    total = ring.zero
    for name, component in zip(names, field, strict=True):
        rest = ring.reduce(component - ring.derivative(total, name))
        integral = antiderivative(ring, rest, name)
        if integral is None:
            return None
        total = ring.reduce(total + integral)
    exact = (
        ring.is_zero(component - ring.derivative(total, name)) for name, component in zip(names, field, strict=True)
    )
    return total if all(exact) else None


def antiderivative(ring: Ring, x: Polynomial, name: str) -> Polynomial | None:
    """W with dW/d(name) = x, without a constant of integration; None where none was found."""
    if x.is_zero():
        return x
    if len(x) > MOST_TERMS:
        return None
    try:
        found = _found(ring, x, name, ring.one)
        if found is not None:
            return found
        for rate in _rates(ring, x, name):  # of sin(w x), by that of w sin(w x)
            found = _found(ring, x, name, rate)
            if found is not None:
                return ring.reduce(ring.times(found, ring.reciprocal(rate)))
        return None
    except Failure:
        return None


def _rates(ring: Ring, x: Polynomial, name: str) -> list[Polynomial]:
    """The positive constants w of functions of w x + ... in x, each once."""
    arguments = (ring.generators[k].argument for k in sorted(occurring([x])))
    slopes = [ring.derivative(argument, name) for argument in arguments if argument is not None]
    rates: list[Polynomial] = []
    for slope in slopes:
        if ring.is_positive(slope) and not slope.is_constant() and not ring.depends_on(slope, name):
            rates += [] if slope in rates else [slope]
    return rates


def _found(ring: Ring, x: Polynomial, name: str, rate: Polynomial) -> Polynomial | None:
    """W with dW/d(name) = rate x."""
    place = ring.index("coordinate", name)
    tried: dict[Exponents, Polynomial] = {}
    frontier = _exponents(x)
    for _ in range(ROUNDS):
        moving = {k for k in _used(ring, [x, *tried.values()]) if ring.depends_on(ring.context.gen(k), name)}
        new = {neighbour for monomial in frontier for neighbour in _neighbours(monomial, {place} | moving)} - {*tried}
        if not new or len(tried) + len(new) > MOST_TRIED:
            return None
        for monomial in new:
            tried[monomial] = ring.derivative(ring.reduce(ring.context.from_dict({monomial: 1})), name)
        solved = _solved(ring, ring.reduce(ring.times(x, rate)), tried)
        if solved is not None:
            return solved
        frontier = {exponent for slope in tried.values() for exponent in _exponents(slope)}
    return None


def _used(ring: Ring, formulas: Iterable[Polynomial]) -> list[int]:
    positions = set(occurring(formulas))
    for k in tuple(positions):  # a sine with its cosine
        g = ring.generators[k]
        if g.kind not in ("sine", "cosine"):
            continue
        if g.argument is None:
            positions |= {ring.index(kind, g.name) for kind in ("sine", "cosine")}
        else:  # adjoined in pairs, the sine first
            positions.add(k + 1 if g.kind == "sine" else k - 1)
    return sorted(positions)


def _exponents(x: Polynomial) -> set[Exponents]:
    return {tuple(map(int, monomial)) for monomial in x.monoms()}


def _neighbours(monomial: Exponents, moving: set[int]) -> Iterable[Exponents]:
    """The monomial with the powers of what moves raised, lowered or left; at most two of them changed."""
    order = sorted(moving)
    for change in product((0, 1, -1), repeat=len(order)):
        if sum(map(bool, change)) > 2:
            continue
        made = list(monomial)
        for k, step in zip(order, change, strict=True):
            made[k] += step
        if min(made) >= 0:
            yield tuple(made)


def _solved(ring: Ring, x: Polynomial, tried: dict[Exponents, Polynomial]) -> Polynomial | None:
    """The combination of monomials whose derivative is x; None where there is none among them."""
    columns = [(monomial, slope.to_dict()) for monomial, slope in tried.items() if not slope.is_zero()]
    target = x.to_dict()
    rows = sorted({key for _, column in columns for key in column} | {*target})
    if not {*target} <= {key for _, column in columns for key in column}:
        return None
    table: list[list[Any]] = [[column.get(key, 0) for _, column in columns] + [target.get(key, 0)] for key in rows]
    combination = ring.zero
    for pivot, line in reduced_rows(fmpq_mat(table)).items():
        if pivot == len(columns):
            return None
        if line[-1] != 0:
            combination = combination + ring.context.from_dict({columns[pivot][0]: line[-1]})
    return ring.reduce(combination)
