"""Arrangements against pictures known by geometry, signs at random points and Euler's law V - E + F = 1 + C."""

from __future__ import annotations

from dataclasses import replace
from random import Random
from typing import Any

import pytest
from flint import fmpq, fmpq_mpoly_ctx

from mbsym.algebra.arrangements import Arrangement, Corner, CornerKind, Region, decompose, decomposition
from mbsym.algebra.arrangements.arrangement import Law, breaches, euler
from mbsym.algebra.arrangements.stacks import Fibre
from mbsym.algebra.failures import TooLargeError
from mbsym.algebra.plane import Box, Budget, decompose_line
from mbsym.algebra.plane.elements import PointField
from mbsym.algebra.plane.numbers import sign

X, Y = (CONTEXT := fmpq_mpoly_ctx.get(["x", "y"])).gens()
BOX = Box(-2, 2, -2, 2)

#: Curves in [-2, 2]^2, with (regions, arcs, corners off the edge) by geometry.
PICTURES = {
    "nothing": ([], 1, 0, 0),
    "a number": ([X * 0 + 3], 1, 0, 0),
    "circle": ([X**2 + Y**2 - 1], 2, 1, 0),
    "empty curve": ([X**2 + Y**2 + 1], 1, 0, 0),
    "isolated point": ([X**2 + Y**2], 1, 0, 1),
    "isolated point and branch": ([Y**2 - X**2 * (X - 1)], 2, 1, 1),
    "cusp": ([Y**2 - X**3], 2, 2, 1),
    "cusp that points upwards": ([X**2 - Y**3], 2, 2, 1),
    "nodes over irrational abscissas": ([9 * Y**2 - (X**2 - 2) ** 2 * (X + 3)], 5, 6, 2),
    "two nodes over each": ([256 * (Y**2 - 1) ** 2 - (X**2 - 2) ** 2 * (X + 3)], 9, 12, 4),
    "cusps over irrational abscissas": ([9 * Y**2 - (X**2 - 2) ** 3], 3, 4, 2),
    "isolated points over irrational abscissas": ([Y**2 + (X**2 - 2) ** 2], 1, 0, 2),
    "triple roots over irrational abscissas": ([Y**3 - X**2 + 2], 2, 1, 0),
    "curves that touch over irrational abscissas": ([Y - (X**2 - 2) ** 2, Y + (X**2 - 2) ** 2], 7, 8, 2),
    "node": ([Y**2 - X**3 - X**2], 3, 3, 1),
    "lemniscate": ([(X**2 + Y**2) ** 2 - 2 * (X**2 - Y**2)], 3, 2, 1),
    "inflection with a vertical tangent": ([Y**3 - X], 2, 1, 0),
    "double line": ([(X - Y) ** 2], 2, 1, 0),
    "two lines": ([X - Y, X + Y], 4, 4, 1),
    "two lines in one polynomial": ([X**2 - Y**2], 4, 4, 1),
    "vertical and horizontal": ([X, Y], 4, 4, 1),
    "two vertical lines, irrational": ([X**2 - 2], 3, 2, 0),
    "irrational lines and a cubic": ([X**2 - 2, Y**3 - X], 6, 7, 2),
    "asymptotes inside the box": ([X * Y - 1], 3, 2, 0),
    "asymptote at an irrational abscissa": ([(X**2 - 2) * Y - 1], 4, 3, 0),
    "circle that touches all edges": ([X**2 + Y**2 - 4], 5, 4, 0),
    "circle outside of the box": ([X**2 + Y**2 - 9], 1, 0, 0),
    "circle that cuts the corners off": ([X**2 + Y**2 - 7], 5, 4, 0),
    "circle that touches the box from outside": ([(X - 3) ** 2 + Y**2 - 1], 1, 0, 0),
    "edges of the box": ([X + 2, Y - 2], 1, 2, 0),
    "two circles and a line": ([X**2 + Y**2 - 1, (X - 1) ** 2 + Y**2 - 1, X - Y], 9, 14, 6),
    "tangent circles": ([X**2 + Y**2 - 1, (X - fmpq(1, 2)) ** 2 + Y**2 - fmpq(1, 4)], 3, 2, 1),
    "concentric circles": ([X**2 + Y**2 - 1, X**2 + Y**2 - 2], 3, 2, 0),
    "three lines through a point": ([X - Y, X + Y, X - 2 * Y], 6, 6, 1),
    "meeting over an irrational abscissa": ([Y - X**2 + 1, Y - 1], 5, 6, 2),
    "tacnode": ([(Y - X**2) * (Y + X**2)], 4, 4, 1),
    "tacnode of an irreducible quartic": ([Y**2 - X**4 * (1 + X)], 3, 3, 1),
    "ramphoid cusp": ([(Y - X**2) ** 2 - X**5], 2, 2, 1),
}


def agrees(found: Arrangement, points: list[tuple[Any, Any]]) -> bool:
    """Whether every point has the signs of the place that it is located at."""
    for x, y in points:
        place, signs = found.locate(x, y), tuple(sign(p(x, y)) for p in found.factors)
        if isinstance(place, Region):
            inside = found.box.x0 < x < found.box.x1 and found.box.y0 < y < found.box.y1
            if place.signs != signs and inside:
                return False
        elif {k for k, s in enumerate(signs) if s == 0} != set(place.factors):
            return False
    return True


def points(source: Random, count: int, box: Box = BOX) -> list[tuple[Any, Any]]:
    def between(a: Any, b: Any) -> Any:
        scale = source.choice((4, 8, 97))
        return a + (b - a) * fmpq(source.randint(0, scale), scale)

    return [(between(box.x0, box.x1), between(box.y0, box.y1)) for _ in range(count)]


@pytest.mark.parametrize("name", PICTURES)
def test_pictures(name: str) -> None:
    factors, regions, arcs, corners = PICTURES[name]
    found = decompose(factors, BOX)
    inner = [corner for corner in found.corners if corner.kind is not CornerKind.EDGE]
    assert (len(found.regions), len(found.arcs), len(inner)) == (regions, arcs, corners)
    assert not breaches(found)
    assert agrees(found, points(Random(name), 40))


def random_curve(source: Random) -> Any:
    a, b, c, d = (fmpq(source.randint(-6, 6), source.choice((1, 2, 3))) for _ in range(4))
    x, y = X - a / 4, Y - b / 4
    return source.choice(
        (
            lambda: c * x + (d or 1) * y,
            lambda: x + c / 5,
            lambda: y - d / 7,
            lambda: x**2 + y**2 - abs(c) / 3,
            lambda: y**2 - x**3,
            lambda: x**2 - y**3 + c * x * y,
            lambda: y**2 - x**3 - c * x**2,
            lambda: x * y - d / 9,
            lambda: (x**2 + y**2) ** 2 - 2 * (x**2 - y**2),
            lambda: (x**2 - 2) * y + c * x,
            lambda: y**3 - y * (c + x) + d / 5 * x**2,
            lambda: x**2 - 3 + c / 2 * y,
        )
    )()


@pytest.mark.parametrize("seed", range(24))
def test_random_products(seed: int) -> None:
    source = Random(seed)
    factors = [random_curve(source) for _ in range(source.randint(2, 4))]
    if seed % 3 == 0:
        factors.append(factors[0] * random_curve(source))
    found = decompose(factors, BOX)
    assert not breaches(found)
    assert agrees(found, points(source, 60))
    for region in found.regions:
        here = found.locate(*region.sample)
        assert isinstance(here, Region)
        assert here.id == region.id


def test_neighbours_across_an_arc_differ_in_the_sign_of_a_simple_curve() -> None:
    found = decompose([X**2 + Y**2 - 1, Y - X**2, X - fmpq(1, 3)], BOX)
    for arc in found.arcs:
        a, b = (found.regions[k].signs for k in arc.regions if k is not None)
        assert {k for k in range(3) if a[k] != b[k]} == set(arc.factors)


def test_exact_points_of_curves_are_located_on_them() -> None:
    found = decompose([X**2 + Y**2 - 1, Y - X], BOX)
    on_circle, crossing_line = found.locate(fmpq(3, 5), fmpq(4, 5)), found.locate(fmpq(1, 3), fmpq(1, 3))
    assert (on_circle.factors, crossing_line.factors) == ((0,), (1,))
    origin = decompose([Y**2 - X**3 - X**2], BOX).locate(fmpq(0), fmpq(0))
    assert isinstance(origin, Corner)
    assert (origin.kind, origin.branches) == (CornerKind.SINGULAR, 4)
    with pytest.raises(ValueError, match="outside"):
        found.locate(fmpq(3), fmpq(0))


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(ValueError, match="identically zero"):
        decompose([X - X], BOX)
    with pytest.raises(ValueError, match="empty box"):
        Box(1, 1, 0, 2)
    with pytest.raises(TooLargeError, match="degree"):
        decompose([Y**9 + X**9 * Y - 1, Y**8 - X**9 - 2], BOX, Budget(degree=100))
    with pytest.raises(TooLargeError, match="cells"):
        decompose([X**2 + Y**2 - 1, X - Y], BOX, Budget(cells=5))


def test_a_wrong_connection_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Branches led to the wrong points of fibres: by Euler's law, or before, as a smooth point has two branches."""
    honest = decomposition.connected

    def crooked(*arguments: Any) -> Fibre:
        fibre = honest(*arguments)
        if len(fibre.right) > 3:
            shifted = (*fibre.right[:1], *(max(k - 1, 1) for k in fibre.right[1:-1]), fibre.right[-1])
            object.__setattr__(fibre, "right", shifted)
        return fibre

    monkeypatch.setattr(decomposition, "connected", crooked)
    caught = 0
    for name in ("circle", "node", "two lines", "tangent circles", "lemniscate"):
        try:
            caught += not euler(decompose(PICTURES[name][0], BOX))
        except Exception:
            caught += 1
    assert caught >= 4


T = fmpq_mpoly_ctx.get(["t"]).gens()[0]


def test_line() -> None:
    """(t^2 - 2) t on [-1, 2]: zeros at 0 and sqrt 2; t - 2 at the end, t + 3 nowhere."""
    found = decompose_line([(T**2 - 2) * T, T - 2, T + 3, T**2 - 2], -1, 2)
    assert [zero.factors for zero in found.zeros] == [(0,), (0, 3), (1,)]
    assert [interval.signs for interval in found.intervals] == [(1, -1, 1, -1), (-1, -1, 1, -1), (1, -1, 1, 1)]
    assert [interval.ends for interval in found.intervals] == [(None, 0), (0, 1), (1, 2)]
    assert [found.locate(fmpq(x)) for x in (-1, 0, 1, 2)] == [
        found.intervals[0],
        found.zeros[0],
        found.intervals[1],
        found.zeros[2],
    ]
    assert found.locate(fmpq(3, 2)) is found.intervals[2]


def test_line_with_a_zero_at_its_lower_end() -> None:
    found = decompose_line([T, T**2 + 1], 0, 1)
    assert (len(found.zeros), len(found.intervals)) == (1, 1)
    assert found.locate(fmpq(0)) is found.zeros[0]
    assert found.locate(fmpq(1)) is found.intervals[0]
    assert found.locate(fmpq(1, 3)) is found.intervals[0]
    assert len(decompose_line([], 0, 1).intervals) == 1
    with pytest.raises(ValueError, match="empty"):
        decompose_line([T], 1, 1)
    with pytest.raises(ValueError, match="zero"):
        decompose_line([T - T], 0, 1)


@pytest.mark.parametrize("name", ["circle", "node", "two lines", "tangent circles", "edges of the box"])
def test_planted_mistakes_break_laws(name: str) -> None:
    """A corner, an arc or a region left out, a wrong sign, a wrong polynomial."""
    found = decompose(PICTURES[name][0], BOX)
    assert not breaches(found)

    def laws(**changed: Any) -> set[Law]:
        return {breach.law for breach in breaches(replace(found, **changed))}

    assert Law.EULER in laws(regions=(*found.regions, found.regions[0]))
    assert laws(arcs=found.arcs[:-1])
    for corner in found.corners:
        assert Law.ENDS in laws(corners=tuple(other for other in found.corners if other.id != corner.id))
    if all(None not in arc.regions for arc in found.arcs):
        turned = replace(found.regions[0], signs=tuple(-s for s in found.regions[0].signs))
        assert Law.SIDES in laws(regions=(turned, *found.regions[1:]))
    assert Law.ZEROS in laws(arcs=(replace(found.arcs[0], factors=()), *found.arcs[1:]))


def test_dense_curves_of_high_degree() -> None:
    """Abscissas of degree 42 and 56: simple zeros of discriminants need no arithmetic over fields."""
    source = Random(11)
    for degree in (7, 8):
        dense = sum(
            (fmpq(source.randint(-9, 9)) * X**i * Y**j for i in range(degree + 1) for j in range(degree + 1 - i)),
            start=X * 0,
        )
        found = decompose([dense, X**2 + Y**2 - 2], BOX)
        assert not breaches(found)
        assert agrees(found, points(source, 30))


def test_arithmetic_at_a_cusp_whose_polynomials_are_not_monic() -> None:
    """At the cusps (+-2^(1/2), 2^(1/3)) of (y^3 - 2)^2 = (x^2 - 2)^3, stretched by 3 x: y^3 is 2 there."""
    found = decompose([3 * (X + 3) * ((Y**3 - 2) ** 2 - (X**2 - 2) ** 3) + (X**2 - 2) ** 4], BOX)
    cusps = [one for one in found.corners if one.kind is CornerKind.SINGULAR]
    assert [[round(x, 6) for x in one.point.floats()] for one in cusps] == [[-1.414214, 1.259921], [1.414214, 1.259921]]
    for one in cusps:
        at = PointField(one.point)
        assert at.value(Y**3 - 2).sign() == 0
        assert at.value(Y).inverse() * 2 == at.value(Y**2)
