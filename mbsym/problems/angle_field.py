"""Lagrange's equations in angles as a polynomial vector field: rates, sines and cosines are the variables.

    s' = c q'/n,   c' = -s q'/n   for s, c of an angle q/n,     det(M) q'' = adj(M) f,     s^2 + c^2 = 1

with positions as variables of their own where the equations contain them besides.  Coordinates on which no equation
depends are left out.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flint import fmpq

from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.matrices import determinant
from mbsym.algebra.polynomial_field import PolynomialField, in_lowest_terms
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.problems.equations import Equations
from mbsym.problems.vector_field import NOTHING, SINGULAR, Transfer, put_in, transfer_of


def in_angles(
    ring: Ring,
    coordinates: Sequence[str],
    equations: Equations,
    also: Sequence[Polynomial] = (),
    images: Mapping[int, Polynomial] = NOTHING,
) -> tuple[PolynomialField, Transfer]:
    """(q', sin, cos, q)' over QQ[parameters], det(M) a part of the denominator, and the way from the ring there.

    ``images`` take the place of dependent parameters.  Raises NoClosedForm where the time, roots or functions
    occur, and where M is singular.
    """
    mass = equations.mass_matrix.polynomials
    forcing = [x.polynomial for x in equations.forcing]
    whole = determinant(ring, mass)
    if ring.vanishes(whole):
        raise NoClosedForm(SINGULAR)
    scaled = [
        determinant(ring, [[*row[:k], f, *row[k + 1 :]] for row, f in zip(mass, forcing, strict=True)])
        for k in range(len(coordinates))
    ]
    whole, *scaled = (put_in(ring, p, images) for p in (whole, *scaled))
    used = set(occurring([whole, *scaled]))
    places: dict[int, str] = {ring.index("velocity", name): f"{name}_dot" for name in coordinates}
    rates = list(scaled)
    relations = []
    for name in coordinates:
        rate = ring.generator("velocity", name)
        if name in ring.angles:
            sine, cosine = ring.index("sine", name), ring.index("cosine", name)
            if used & {sine, cosine}:
                shown = name if ring.angles[name] == 1 else f"{name}/{ring.angles[name]}"
                s, c = ring.context.gen(sine), ring.context.gen(cosine)
                share = fmpq(1, ring.angles[name])
                places |= {sine: f"sin({shown})", cosine: f"cos({shown})"}
                rates += [ring.times(whole, c * rate * share), ring.times(whole, -s * rate * share)]
                relations.append(s**2 + c**2 - 1)
    for name in coordinates:
        index = ring.index("coordinate", name)
        if index in used:
            places[index] = name
            rates.append(ring.times(whole, ring.generator("velocity", name)))
    rates = [ring.reduce(x) for x in rates]
    fractions = [ring.fraction(p) for p in (whole, *rates)]
    held = [factor for _, factors in fractions for factor, _ in factors]
    also = [put_in(ring, x, images) for x in also]
    also = [p for x in also for p in (ring.fraction(x)[0], *(f for f, _ in ring.fraction(x)[1]))]
    transfer = transfer_of(ring, places, [*(p for p, _ in fractions), *held, *relations, *also], images)
    tops, bottoms = zip(*(transfer.fraction(p) for p in (whole, *rates)), strict=True)
    common: Any = bottoms[0]
    for bottom in bottoms[1:]:
        common = common * (bottom / bottom.gcd(common))
    cleared = [top * (common / bottom) for top, bottom in zip(tops, bottoms, strict=True)]
    moved, denominator = in_lowest_terms(cleared[1:], cleared[0])
    field = PolynomialField(
        transfer.context,
        transfer.parameters,
        transfer.variables,
        tuple(moved),
        denominator,
        tuple(transfer(p) for p in relations),
    )
    return field, transfer
