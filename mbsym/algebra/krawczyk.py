"""Roots of n equations in n unknowns, proved to exist and to be unique in a box (Krawczyk's operator over balls).

For a box X with midpoint m, and C close to the inverse of f'(m), let

    K(X) = m - C f(m) + (1 - C f'(X)) (X - m),      f'(X) an enclosure of the Jacobian over X

K(X) inside the interior of X: exactly one root in X.  K(X) and X disjoint: none.  Every root in X lies in K(X).

Source: R. Krawczyk, Newton-Algorithmen zur Bestimmung von Nullstellen mit Fehlerschranken, Computing 4 (1969).
"""

from __future__ import annotations

import math
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
    image = tuple(m - value[i, 0] + offset[i, 0] for i, m in enumerate(middle))
    return image if all(x.is_finite() for x in image) else None


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
            length = max(abs(float(change[i, 0].mid())) / (1 + abs(float(x.mid()))) for i, x in enumerate(centre))
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


def search(
    function: Function,
    jacobian: Jacobian,
    box: Sequence[tuple[float, float]],
    most: int,
    linear: int = 0,
    tied: tuple[Function, Jacobian] | None = None,
) -> Search:
    """All roots in a box, by bisection; after ``most`` boxes the rest is returned as open.

    The equations are linear in ``linear`` further unknowns behind those of the box, which have any values: over a small
    box they follow from the others, where their coefficients are of full rank, and elsewhere the box stays open.
    ``tied``: further equations, fewer than the box has unknowns, in these alone.
    Boxes that touch may share a root on their common side; callers compare the roots.
    """
    pending: list[Box] = [tuple(_interval(arb(low), arb(high)) for low, high in box)]
    roots: list[Box] = []
    undecided: list[Box] = []
    treated, n = 0, len(box)
    while pending:
        treated += 1
        current = pending.pop()
        if treated > most:
            return Search(tuple(roots), (*undecided, *pending, current))
        if tied is not None:
            nearer = _nearer(*tied, current)
            if nearer is None:
                continue
            current = nearer
        whole = (*current, *_linear_part(function, jacobian, current, linear))
        values = function(whole)
        if any(x.is_finite() and not x.contains(0) for x in values):
            continue
        image = step(function, jacobian, whole) if all(x.is_finite() for x in whole) else None
        if image is not None:
            pairs = list(zip(whole, image, strict=True))
            if any(not a.overlaps(b) for a, b in pairs):
                continue
            if all(a.contains_interior(b) for a, b in pairs):
                roots.append(image)
                continue
            if tied is not None:
                narrower = tuple(a.intersection(b) for a, b in pairs[:n])
                shrinks = _width(narrower) < _SHRINKS * _width(current)
                current = narrower
                if shrinks:
                    pending.append(current)
                    continue
        widest = max(range(n), key=lambda k: float(current[k].rad()))
        if float(current[widest].rad()) < _NARROW:
            # What holds of some unknowns alone may have narrowed them to roundings.
            image = None if tied is None else _around(function, jacobian, current, linear)
            if image is None:
                undecided.append(current)
            else:
                roots.append(image)
            continue
        middle, x = arb(current[widest].mid()), current[widest]
        for low, high in ((x.lower(), middle), (middle, x.upper())):
            pending.append((*current[:widest], _interval(low, high), *current[widest + 1 :]))
    return Search(tuple(roots), tuple(undecided))


#: A box that is narrower is not cut further.
_NARROW = 1e-9
#: A box that one step makes narrower than this is not cut before the next.
_SHRINKS = 0.6


def _around(function: Function, jacobian: Jacobian, box: Box, linear: int) -> Box | None:
    """Where the only root is in a box around a narrow one; None where that is not proved."""
    with ctx.workprec(200):
        wider = tuple(arb(x.mid(), 10 * _NARROW) for x in box)
        whole = (*wider, *_linear_part(function, jacobian, wider, linear))
        image = step(function, jacobian, whole) if all(x.is_finite() for x in whole) else None
        proved = image is not None and all(a.contains_interior(b) for a, b in zip(whole, image, strict=True))
        return image if proved else None


def _width(box: Box) -> float:
    return max(float(x.rad()) for x in box)


def _linear_part(function: Function, jacobian: Jacobian, box: Box, linear: int) -> Box:
    """What the unknowns that the equations are linear in can be over a box; all numbers where that is not bounded."""
    if not linear:
        return ()
    anything = (arb(0, "inf"),) * linear
    middle, nothing = tuple(arb(x.mid()) for x in box), (arb(0),) * linear
    chosen = pivot_rows([[float(x.mid()) for x in row[-linear:]] for row in jacobian((*middle, *nothing))])
    if len(chosen) < linear:
        return anything
    values, rows = function((*box, *nothing)), jacobian((*box, *nothing))
    matrix = arb_mat(linear, linear, [x for i in chosen for x in rows[i][-linear:]])
    if not all(x.is_finite() for x in matrix.entries()):
        return anything
    try:
        solution = matrix.solve(arb_mat(linear, 1, [-values[i] for i in chosen]), algorithm="precond").entries()
    except ZeroDivisionError:
        return anything
    # Wider than it has to be, or no image would lie in its interior.
    return tuple(arb(x.mid(), 2 * x.rad()) for x in solution) if all(x.is_finite() for x in solution) else anything


def _nearer(function: Function, jacobian: Jacobian, box: Box) -> Box | None:
    """The part of a box in which equations may hold that are fewer than its unknowns; None where they do not.

    Krawczyk's operator in as many of the unknowns, the others anything in their intervals.
    """
    if any(x.is_finite() and not x.contains(0) for x in function(box)):
        return None
    middle, n = tuple(arb(x.mid()) for x in box), len(box)
    rows = jacobian(middle)
    fewer = len(rows)
    pivots = pivot_rows([[float(row[k].mid()) for row in rows] for k in range(n)])
    inverse = _inverse([[row[k] for k in pivots] for row in rows]) if len(pivots) == fewer else None
    if inverse is None:
        return box
    slopes = inverse * arb_mat(fewer, n, [x for row in jacobian(box) for x in row])
    value = inverse * arb_mat(fewer, 1, list(function(middle)))
    narrower = list(box)
    for i, k in enumerate(pivots):
        image = middle[k] - value[i, 0]
        for j in range(n):
            image = image + (int(j == k) - slopes[i, j]) * (box[j] - middle[j])
        if not image.is_finite():
            return box
        if not image.overlaps(box[k]):
            return None
        narrower[k] = image.intersection(box[k])
    return tuple(narrower)


def pivot_rows(rows: Sequence[Sequence[Any]], least: float = 0.0) -> list[int]:
    """As many rows as the rank, by Gauss's elimination with the largest pivots; what is below ``least`` is zero."""
    left = {i: list(row) for i, row in enumerate(rows)}
    chosen: list[int] = []
    columns = set(range(len(rows[0]) if left else 0))
    while columns and left:
        size, i, k = max((abs(row[k]), i, k) for i, row in left.items() for k in columns)
        if not least < size < math.inf:
            break
        top = left.pop(i)
        columns.discard(k)
        chosen.append(i)
        for row in left.values():
            factor = row[k] / top[k]
            for c in columns:
                row[c] -= factor * top[c]
    return chosen


def _interval(low: Any, high: Any) -> Any:
    return arb(low).union(arb(high))
