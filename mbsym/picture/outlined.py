"""What a solid looks like on paper: its outline, and the edges and arcs of it that are seen.

    outlined(kind, size, middle, rows, look) -> (outline, edges)

``rows`` are the axes of the solid, ``look`` the directions to the right, upwards and towards the eye.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import cos, hypot, pi, sin, sqrt

from mbsym.picture.looking import combined, dot
from mbsym.picture.values import Numbers, Rows

#: Pieces of a whole circle.
PIECES = 24

Place = tuple[float, float]


def outlined(
    kind: str, size: Sequence[float], middle: Numbers, rows: Sequence[Numbers], look: Rows
) -> tuple[tuple[Place, ...], tuple[tuple[Place, ...], ...]]:
    """See the module; ``kind`` and ``size`` are those of a shape of the description."""

    def flat(place: Numbers) -> Place:
        return dot(look[0], place), dot(look[1], place)

    def there(*components: float) -> Numbers:
        return combined((1.0, *components), (middle, *rows))

    if kind == "box":
        corners = [there(*(s * x / 2 for s, x in zip(signs, size, strict=True))) for signs in _CORNERS]
        corner = max(_CORNERS, key=lambda signs: sum(s * dot(look[2], row) for s, row in zip(signs, rows, strict=True)))
        edges = []
        for k in range(3):
            other = tuple(-s if i == k else s for i, s in enumerate(corner))
            first, second = (
                flat(there(*(s * x / 2 for s, x in zip(signs, size, strict=True)))) for signs in (corner, other)
            )
            edges.append((first, second))
        return hull(map(flat, corners)), tuple(edges)
    if kind in ("sphere", "ellipsoid"):
        half = tuple(size) * 3 if kind == "sphere" else tuple(size)
        return _ellipse(half, middle, rows, look), tuple(_fronts(half, middle, rows, look, kind == "sphere"))
    radius, length = size
    tops = [there(0.0, 0.0, sign * length / 2) for sign in (1, -1)]
    if kind == "capsule":
        balls = [_ellipse((radius,) * 3, end, rows, look) for end in tops]
        return hull(place for ball in balls for place in ball), ()
    rims = [
        [
            flat(combined((1.0, radius * cos(a), radius * sin(a)), (end, rows[0], rows[1])))
            for a in (2 * pi * k / PIECES for k in range(PIECES + 1))
        ]
        for end in tops
    ]
    near = 0 if dot(look[2], rows[2]) > 0 else 1
    seen = abs(dot(look[2], rows[2])) > 1e-6
    return hull(place for rim in rims for place in rim), (tuple(rims[near]),) if seen else ()


_CORNERS = [(a, b, c) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]


def _ellipse(half: Sequence[float], middle: Numbers, rows: Sequence[Numbers], look: Rows) -> tuple[Place, ...]:
    """The outline of an ellipsoid: S = sum of a_i^2 p_i p_i^T, p_i the axes on the paper; L (cos, sin), L L^T = S."""
    p = [(a * dot(look[0], row), a * dot(look[1], row)) for a, row in zip(half, rows, strict=True)]
    xx, xy, yy = sum(x * x for x, _ in p), sum(x * y for x, y in p), sum(y * y for _, y in p)
    a = sqrt(xx)
    b = xy / a if a else 0.0
    c = sqrt(max(yy - b * b, 0.0))
    x, y = dot(look[0], middle), dot(look[1], middle)
    turns = [2 * pi * k / PIECES for k in range(PIECES)]
    return tuple((x + a * cos(t), y + b * cos(t) + c * sin(t)) for t in turns)


def _fronts(
    half: Sequence[float], middle: Numbers, rows: Sequence[Numbers], look: Rows, sphere: bool
) -> Iterable[tuple[Place, ...]]:
    """The near halves of the ellipses in the planes of symmetry; of a sphere the one about its third axis.

    A point r of the surface is seen where n . e > 0, n = sum (r_i / a_i^2) e_i.
    """
    for p, q in ((0, 1),) if sphere else ((0, 1), (1, 2), (2, 0)):
        u, v = dot(look[2], rows[p]) / half[p], dot(look[2], rows[q]) / half[q]
        if hypot(u, v) * max(half) < 0.02:
            continue  # seen as its whole
        # cos t u + sin t v > 0: half a turn about the direction (u, v)
        begin = pi / 2
        size = hypot(u, v)
        c, s = u / size, v / size
        arc = []
        for k in range(PIECES // 2 + 1):
            t = begin - 2 * pi * k / PIECES
            x, y = c * cos(t) - s * sin(t), s * cos(t) + c * sin(t)
            place = combined((1.0, half[p] * x, half[q] * y), (middle, rows[p], rows[q]))
            arc.append((dot(look[0], place), dot(look[1], place)))
        yield tuple(arc)


def hull(places: Iterable[Place]) -> tuple[Place, ...]:
    """The convex hull, counter-clockwise (Andrew's chains)."""
    ordered = sorted(set(places))
    if len(ordered) < 3:
        return tuple(ordered)

    def chain(points: Iterable[Place]) -> list[Place]:
        corners: list[Place] = []
        for x, y in points:
            while len(corners) > 1:
                (a, b), (c, d) = corners[-2], corners[-1]
                if (c - a) * (y - b) - (d - b) * (x - a) > 0:
                    break
                corners.pop()
            corners.append((x, y))
        return corners[:-1]

    return tuple(chain(ordered) + chain(reversed(ordered)))
