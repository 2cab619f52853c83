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
    middle = tuple(arb(x.mid()) for x in box)
    inverse = _inverse(jacobian(middle))
    return None if inverse is None else _image(function, jacobian, box, middle, inverse)


def _inverse(rows: Sequence[Sequence[Any]]) -> Any:
    """A matrix of exact numbers close to the inverse, or None."""
    n = len(rows)
    try:
        inverse = arb_mat(n, n, [x for row in rows for x in row]).inv()
    except ZeroDivisionError:
        return None
    if not all(x.is_finite() for x in inverse.entries()):
        return None
    return arb_mat(n, n, [arb(x.mid()) for x in inverse.entries()])


def _image(function: Function, jacobian: Jacobian, box: Box, middle: Box, inverse: Any) -> Box | None:
    n = len(box)
    value = inverse * arb_mat(n, 1, list(function(middle)))
    spread = arb_mat(n, n, [arb(int(i == j)) for i in range(n) for j in range(n)])
    spread = spread - inverse * arb_mat(n, n, [x for row in jacobian(box) for x in row])
    offset = spread * arb_mat(n, 1, [x - m for x, m in zip(box, middle, strict=True)])
    found = tuple(m - value[i, 0] + offset[i, 0] for i, m in enumerate(middle))
    return found if all(x.is_finite() for x in found) else None


def certified(function: Function, jacobian: Jacobian, start: Sequence[float], bits: int = 200) -> Box | None:
    """A narrow box around a root near ``start``, proved to hold exactly one; None where that fails.

    The iteration keeps the Jacobian's first inverse: a start that is good to 8 digits gains 8 digits a step.
    """
    n = len(start)
    with ctx.workprec(bits):
        centre: Box = tuple(arb(x) for x in start)
        inverse = _inverse(jacobian(centre))
        for turn in range(40):
            if inverse is None:
                return None
            change = inverse * arb_mat(n, 1, list(function(centre)))
            length = max(abs(float(change[i, 0].mid())) for i in range(n))
            if not length < 10:
                return None
            centre = tuple(arb((x - change[i, 0]).mid()) for i, x in enumerate(centre))
            if length < 1e-40:
                break
            if length > 1e-3 or turn % 8 == 7:  # too far away, or too slow: a new inverse
                inverse = _inverse(jacobian(centre))
        for exponent in (-30, -20, -12):
            box = tuple(arb(x.mid(), arb(10) ** exponent) for x in centre)
            image = None if inverse is None else _image(function, jacobian, box, centre, inverse)
            if image is not None and all(a.contains_interior(b) for a, b in zip(box, image, strict=True)):
                return image
        return None


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
