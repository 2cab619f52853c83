"""Roots of n equations in n unknowns, proved to exist and to be unique in a box (Krawczyk's operator over balls).

For a box X with midpoint m, and C close to the inverse of f'(m), let

    K(X) = m - C f(m) + (1 - C f'(X)) (X - m),      f'(X) an enclosure of the Jacobian over X

K(X) inside the interior of X: exactly one root in X.  K(X) and X disjoint: none.  Every root in X lies in K(X).

Source: R. Krawczyk, Newton-Algorithmen zur Bestimmung von Nullstellen mit Fehlerschranken, Computing 4 (1969).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from flint import arb, arb_mat, ctx

Box = tuple[Any, ...]  # flint.arb
Function = Callable[[Box], Sequence[Any]]
Jacobian = Callable[[Box], Sequence[Sequence[Any]]]


@dataclass(frozen=True)
class Search:
    """``roots``: boxes with exactly one root each.  ``open_boxes``: boxes about which nothing is known."""

    roots: tuple[Box, ...]
    open_boxes: tuple[Box, ...]


def step(function: Function, jacobian: Jacobian, box: Box) -> Box | None:
    """K(box), or None where the Jacobian at the midpoint cannot be inverted."""
    n = len(box)
    middle = tuple(arb(x.mid()) for x in box)
    slope = arb_mat(n, n, [x for row in jacobian(middle) for x in row])
    try:
        inverse = slope.inv()
    except ZeroDivisionError:
        return None
    inverse = arb_mat(n, n, [arb(x.mid()) for x in inverse.entries()])
    value = inverse * arb_mat(n, 1, list(function(middle)))
    spread = arb_mat(n, n, [arb(int(i == j)) for i in range(n) for j in range(n)])
    spread = spread - inverse * arb_mat(n, n, [x for row in jacobian(box) for x in row])
    offset = spread * arb_mat(n, 1, [x - m for x, m in zip(box, middle, strict=True)])
    found = tuple(m - value[i, 0] + offset[i, 0] for i, m in enumerate(middle))
    return found if all(x.is_finite() for x in found) else None


def certified(function: Function, jacobian: Jacobian, start: Sequence[float], bits: int = 200) -> Box | None:
    """A narrow box around a root near ``start``, proved to hold exactly one; None where that fails."""
    keep, ctx.prec = ctx.prec, bits
    try:
        centre: Box = tuple(arb(x) for x in start)
        for _ in range(12):  # Newton's method at the working precision
            moved = step(function, jacobian, centre)
            if moved is None:
                return None
            change = max(abs(float((a - b).mid())) for a, b in zip(moved, centre, strict=True))
            centre = tuple(arb(x.mid()) for x in moved)
            if change < 1e-40:
                break
        for exponent in (-30, -20, -12):
            box = tuple(arb(x.mid(), arb(10) ** exponent) for x in centre)
            image = step(function, jacobian, box)
            if image is not None and all(outer.contains_interior(inner) for outer, inner in zip(box, image, strict=True)):
                return image
        return None
    finally:
        ctx.prec = keep


def search(function: Function, jacobian: Jacobian, box: Sequence[tuple[float, float]], most: int) -> Search:
    """All roots in a box, by bisection; after ``most`` boxes the rest is returned as open.

    Boxes that touch may share a root on their common side; callers compare the roots.
    """
    pending: list[Box] = [tuple(_interval(arb(low), arb(high)) for low, high in box)]
    roots: list[Box] = []
    undecided: list[Box] = []
    treated = 0
    while pending:
        treated += 1
        current = pending.pop()
        if treated > most:
            return Search(tuple(roots), (*undecided, *pending, current))
        values = function(current)
        if any(x.is_finite() and not x.contains(0) for x in values):
            continue
        image = step(function, jacobian, current)
        if image is not None:
            pairs = list(zip(current, image, strict=True))
            if any(not a.overlaps(b) for a, b in pairs):
                continue
            if all(a.contains_interior(b) for a, b in pairs):
                roots.append(image)
                continue
        widest = max(range(len(current)), key=lambda k: float(current[k].rad()))
        if float(current[widest].rad()) < 1e-9:
            undecided.append(current)
            continue
        middle, x = arb(current[widest].mid()), current[widest]
        for low, high in ((x.lower(), middle), (middle, x.upper())):
            pending.append((*current[:widest], _interval(low, high), *current[widest + 1 :]))
    return Search(tuple(roots), tuple(undecided))


def _interval(low: Any, high: Any) -> Any:
    return arb(low).union(arb(high))
