"""How far from zero coordinates can be at rest: bounds that the equations themselves prove.

A torsional spring's moment k (q - q0) grows beyond everything that sines and cosines can set against it.  In an
equation with the terms  a q^n  and others  c q^j y,  j < n, |y| <= 1 or bounded before,  every root has

    |q| <= max(1, sum |c| bound(y) / |a|),      without the 1 where n = 1
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flint import arb, arb_mat, ctx

from mbsym.algebra.ring import Polynomial, Ring

#: Of the balls in which bounds are sought.
BITS = 128
#: Generators whose values lie in [-1, 1].
_BOUNDED_FUNCTIONS = ("tanh",)

#: A sum of terms: powers of the generators (pi is a number) and their coefficients in balls.
_Terms = dict[tuple[int, ...], Any]


def reach(ring: Ring, equations: Sequence[Polynomial], plain: Sequence[str]) -> dict[str, float]:
    """{q: b} such that |q| <= b at every common root of ``equations``, for those of ``plain`` that are bounded.

    ``plain`` are coordinates that occur outside sine and cosine.  Coordinates that are coupled linearly are taken
    apart first: with f = L q + (the rest), the equations L^-1 f are looked at, too.
    """
    at = {name: ring.index("coordinate", name) for name in plain}
    with ctx.workprec(BITS):
        sums = [_terms(ring, x) for x in equations]
        candidates = [*sums, *_decoupled(sums, list(at.values()))]
        known: dict[int, Any] = {}
        growing = True
        while growing:
            growing = False
            for k in at.values():
                if k in known:
                    continue
                bounds = [b for x in candidates if (b := _bound(ring, x, k, known)) is not None]
                if bounds:
                    known[k], growing = min(bounds, key=float), True
        return {name: float(known[k].upper()) * (1 + 1e-12) for name, k in at.items() if k in known}


def _terms(ring: Ring, x: Polynomial) -> _Terms:
    found: _Terms = {}
    for monomial, coefficient in x.terms():
        powers, value = list(monomial), arb(coefficient)
        for k, e in enumerate(powers):
            if e and ring.generators[k].kind == "parameter" and ring.generators[k].name == "pi":
                value, powers[k] = value * arb.pi() ** int(e), 0
        key = tuple(int(e) for e in powers)
        found[key] = found.get(key, arb(0)) + value
    return found


def _decoupled(sums: Sequence[_Terms], unknowns: Sequence[int]) -> list[_Terms]:
    """L^-1 f for as many equations f as unknowns whose linear parts L can be inverted; else nothing."""
    if not sums or not unknowns:
        return []
    size = len(next(iter(sums[0])))
    units = [tuple(int(i == k) for i in range(size)) for k in unknowns]
    rows = [x for x in sums if any(unit in x for unit in units)]
    if len(rows) != len(unknowns):
        return []
    try:
        inverse = arb_mat([[x.get(unit, arb(0)) for unit in units] for x in rows]).inv()
    except ZeroDivisionError:
        return []
    found = []
    for i in range(len(rows)):
        total: _Terms = {}
        for j, x in enumerate(rows):
            for key, value in x.items():
                total[key] = total.get(key, arb(0)) + inverse[i, j] * value
        for j, unit in enumerate(units):
            total[unit] = arb(int(i == j))
        found.append({key: value for key, value in total.items() if not value.is_zero()})
    return found


def _bound(ring: Ring, x: _Terms, unknown: int, known: Mapping[int, Any]) -> Any:
    """The bound that one equation proves for one coordinate, as a ball; None where it proves none."""
    degree = max(key[unknown] for key in x)
    top = [key for key in x if key[unknown] == degree]
    if degree == 0 or len(top) != 1 or sum(top[0]) != degree or not abs(x[top[0]]) > 0:
        return None
    total = arb(0)
    for key, value in x.items():
        if key == top[0]:
            continue
        size = abs(value)
        for k, e in enumerate(key):
            if e and k != unknown:
                largest = known.get(k) or _largest(ring, k)
                if largest is None:
                    return None
                size = size * largest**e
        total = total + size
    ratio = arb((total / abs(x[top[0]])).upper())
    return ratio if degree == 1 else ratio.max(arb(1))


def _largest(ring: Ring, index: int) -> Any:
    g = ring.generators[index]
    if g.kind in ("sine", "cosine") or (g.kind == "function" and g.name in _BOUNDED_FUNCTIONS):
        return arb(1)
    return None
