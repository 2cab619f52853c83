"""Linear relations between formulas with coefficients in the field of the parameters, fraction-free."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from math import prod

from mbsym.algebra.factors import occurring, rational_ratio
from mbsym.algebra.matrices import PrimitiveRows
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.terms import grouped

#: Terms of one entry while that is solved.
MOST_ENTRY = 2000

Key = tuple[int, ...]

#: The kinds of generators that are no constants, and whose functions are none.
MOVING = ("coordinate", "prescribed", "time")
PLAIN = ("coordinate", "velocity", "parameter")
#: Roots of which all products are looked at.
MOST_ROOTS = 6


def kernel(ring: Ring, *lists: Sequence[Polynomial]) -> list[dict[int, Polynomial]]:
    """A basis of the c with  sum_k c_k columns_k = 0 for every list, as polynomials in the parameters, primitive.

    Coefficients of equal monomials in everything but parameters are compared: where formulas have other normal forms
    than these the basis may lack some.  Free are the last columns.  Raises NoClosedForm beyond the bounds.
    """
    rows: dict[tuple[int, Key], dict[int, Polynomial]] = {}
    for number, columns in enumerate(lists):
        for k, column in enumerate(_cleared(ring, columns)):
            for key, c in coefficients(ring, column).items():
                rows.setdefault((number, key), {})[k] = c
    held = PrimitiveRows(ring, MOST_ENTRY, "the coefficients of a symmetry are too long")
    for row in sorted(rows.values(), key=lambda row: (len(row), sum(len(x) for x in row.values()))):
        left = held.reduced(row)
        if left:
            held.add(left, min(left))
    return [_vector(ring, held.pivots, k) for k in range(len(lists[0])) if k not in held.pivots]


def coefficients(ring: Ring, x: Polynomial) -> dict[Key, Polynomial]:
    """Polynomials in what does not change with the state or the time, by the powers of all other generators."""
    moving = {g.name for g in ring.generators if g.kind in MOVING}
    degrees = x.degrees()
    fixed = [d > 0 and not ring.dependencies(ring.context.gen(k), moving) for k, d in enumerate(degrees)]
    for k, g in enumerate(ring.generators[: len(fixed)]):
        fixed[k] = fixed[k] and g.kind not in (*MOVING, "velocity", "acceleration")
    moved = [k for k, constant in enumerate(fixed) if not constant]
    return grouped(x, lambda m: tuple(0 if constant else int(a) for a, constant in zip(m, fixed, strict=True)), moved)


def independent(ring: Ring, columns: Sequence[Polynomial]) -> bool:
    """Whether the monomials in the columns are linearly independent functions: then ``kernel`` lacks nothing.

    That is known where nothing is adjoined but sines and cosines of coordinates, and roots of polynomials in plain
    generators and cosines of which no product is a square: then each root doubles the field.  (With the sines a product
    becomes a square if and only if it is one times some 1 - cos^2: a factor other than 1 - cos and 1 + cos forbids it.)
    """
    radicands = []
    used: set[int] = set()
    for column in _cleared(ring, columns):
        used |= {k for k, degree in enumerate(column.degrees()) if degree > 0}
    for k in used:
        g = ring.generators[k]
        if g.kind in PLAIN or (g.kind in ("sine", "cosine") and g.name in ring.angles):
            continue
        inner = None if g.kind != "root" or g.argument is None else g.argument
        if inner is None or any(
            d > 0 and g.kind not in PLAIN and not (g.kind == "cosine" and g.name in ring.angles)
            for g, d in zip(ring.generators, inner.degrees(), strict=True)
        ):
            return False
        radicands.append(inner)
    if len(radicands) > MOST_ROOTS:
        return False
    for count in range(1, len(radicands) + 1):
        for chosen in combinations(radicands, count):
            _, factors = prod(chosen, start=ring.one).factor()
            if all(power % 2 == 0 or _is_of_a_half_angle(ring, factor) for factor, power in factors):
                return False
    return True


def _is_of_a_half_angle(ring: Ring, factor: Polynomial) -> bool:
    """Whether it is 1 - cos or 1 + cos but for a constant: twice the square of the sine or cosine of half the angle."""
    held = occurring([factor])
    if len(held) != 1 or ring.generators[held[0]].kind != "cosine":
        return False
    return any(rational_ratio(factor, ring.one + sign * ring.context.gen(held[0])) is not None for sign in (1, -1))


def _cleared(ring: Ring, columns: Sequence[Polynomial]) -> list[Polynomial]:
    """All of them times what they divide by."""
    fractions = [ring.fraction(x) for x in columns]
    common: list[tuple[Polynomial, int]] = []
    for _, factors in fractions:
        for factor, power in factors:
            place = next((k for k, (present, _) in enumerate(common) if present == factor), None)
            if place is None:
                common.append((factor, power))
            else:
                common[place] = (factor, max(power, common[place][1]))
    polynomials = []
    for top, factors in fractions:
        for factor, power in common:
            own = next((e for present, e in factors if present == factor), 0)
            for _ in range(power - own):
                top = ring.times(top, factor)
        polynomials.append(ring.reduce(top))
    return polynomials


def _vector(ring: Ring, pivots: dict[int, dict[int, Polynomial]], free: int) -> dict[int, Polynomial]:
    """The solution with 1 in the place ``free`` and 0 in the other free places, times its denominators."""
    involved = {k: row for k, row in pivots.items() if free in row}
    common = ring.one
    for k, row in involved.items():
        common = common * (row[k] / row[k].gcd(common))
    solution = {k: ring.reduce(-row[free] * (common / row[k])) for k, row in involved.items()} | {
        free: ring.reduce(common)
    }
    shared = solution[free]
    for c in solution.values():
        shared = shared.gcd(c)
    scale = shared * (solution[free] / shared).leading_coefficient()
    return {k: c / scale for k, c in solution.items()}
