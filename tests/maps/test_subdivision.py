"""Boxes with proved verdicts against the exact ones at their points; what is white is told, and kept apart."""

from __future__ import annotations

from fractions import Fraction
from random import Random
from typing import Any

import pytest
from flint import fmpq, fmpq_mpoly_ctx

import mbsym
from mbsym.algebra.plane import Box
from mbsym.maps.boundaries import boundaries
from mbsym.maps.section import Axis, Section, section
from mbsym.maps.subdivision import ByBoundaries, ByEnclosures, End, Subdivision, about_centre, centre, halves, subdivide
from mbsym.maps.verdicts import verdict_at
from mbsym.problems.stability.words import Word

X, Y = fmpq_mpoly_ctx.get(["x", "y"]).gens()
UNIT = Box(-1, 1, -1, 1)


def made(name: str, axes: dict[str, tuple[str, str]], **settings: Any) -> tuple[Section, Box]:
    listed = [Axis(axis, *map(Fraction, ends)) for axis, ends in axes.items()]
    there = section(mbsym.load(f"systems/{name}.yaml"), listed, {k: Fraction(v) for k, v in settings.items()})
    return there, Box(*(fmpq(x.numerator, x.denominator) for axis in listed for x in (axis.low, axis.high)))


@pytest.fixture(scope="module")
def ziegler() -> tuple[Section, Box]:
    return made("ziegler-damped", {"P": ("0", "5"), "b1": ("0", "1")}, m=1, l=1, k=1, b2="1/10")


def inner(box: Box, source: Random) -> tuple[Any, Any]:
    def between(a: Any, b: Any) -> Any:
        return a + (b - a) * fmpq(source.randint(1, 996), 997)

    return between(box.x0, box.x1), between(box.y0, box.y1)


def test_a_circle_is_left_white_and_its_sides_are_proved() -> None:
    """x^2 + y^2 = 1/2, with the area pi/2: the white boxes cover it, their share falls with the depth."""
    circle = X**2 + Y**2 - fmpq(1, 2)
    shares = []
    for depth in (6, 9, 12):
        found = subdivide(UNIT, ByBoundaries([circle], lambda x, y: bool(circle(x, y) > 0)), depth)
        assert found.end is End.DONE
        assert sum((tile.box.area for tile in found.tiles), start=fmpq(0)) == UNIT.area
        inside = float(sum((tile.box.area for tile in found.tiles if tile.proved is False), start=fmpq(0)))
        assert inside < 1.5708 < inside + float(found.white * UNIT.area)
        shares.append(found.white)
        for tile in found.tiles:
            for _ in range(3):
                point = inner(tile.box, Random(str(tile.box)))
                assert tile.proved is None or tile.proved == (circle(*point) > 0)
    assert shares[0] > shares[1] > shares[2]
    assert shares[2] < fmpq(1, 10)


def test_the_enclosure_about_the_centre_is_exact_at_the_corners() -> None:
    """3 x y - x^2 + 2 on [1, 3] x [0, 2]: c = 3 * 2 - 4 + 2 = 4; moved by u, v: 3 u + 6 v + 3 u v - 4 u - u^2."""
    assert about_centre(3 * X * Y - X**2 + 2, Box(1, 3, 0, 2)) == (4, 1 + 6 + 3 + 1)
    assert halves(Box(0, 1, 0, 4), Box(0, 1, 0, 4))[0] == Box(0, fmpq(1, 2), 0, 4)
    assert halves(Box(0, 1, 0, 4), Box(0, 8, 0, 4))[0] == Box(0, 1, 0, 2)


@pytest.fixture(scope="module")
def proved(ziegler: tuple[Section, Box]) -> Subdivision[Any]:
    there, box = ziegler
    return subdivide(box, ByBoundaries(boundaries(there).factors, lambda x, y: verdict_at(there, (x, y))), depth=11)


def test_boundaries_prove_what_is_true_at_every_point(ziegler: tuple[Section, Box], proved: Subdivision[Any]) -> None:
    there, box = ziegler
    assert proved.white < fmpq(1, 6)
    source = Random(7)
    for _ in range(150):
        point = inner(box, source)
        tile = proved.locate(*point)
        if tile.proved is not None:
            assert tile.proved.verdict.word is verdict_at(there, point).verdict.word
    with pytest.raises(ValueError, match="outside"):
        proved.locate(fmpq(6), fmpq(0))


def test_a_lost_boundary_proves_what_is_false(ziegler: tuple[Section, Box]) -> None:
    """So that the test above can fail: without Hurwitz's curve some box is called what it is not everywhere."""
    there, box = ziegler
    plain = [p for p in boundaries(there).factors if sum(map(int, p.degrees())) < 3]
    wrong = subdivide(box, ByBoundaries(plain, lambda x, y: verdict_at(there, (x, y))), depth=11)
    source, false = Random(7), 0
    for _ in range(150):
        point = inner(box, source)
        tile = wrong.locate(*point)
        false += tile.proved is not None and tile.proved.verdict.word is not verdict_at(there, point).verdict.word
    assert false


def test_enclosures_prove_it_without_boundaries(ziegler: tuple[Section, Box], proved: Subdivision[Any]) -> None:
    there, box = ziegler
    found = subdivide(box, ByEnclosures(there), depth=9)
    words = {tile.proved.word for tile in found.tiles if tile.proved is not None}
    assert words == {Word.ASYMPTOTIC, Word.UNSTABLE}
    assert found.white < fmpq(1, 2)
    for tile in found.tiles:
        other = proved.locate(*centre(tile.box))
        if tile.proved is not None:
            assert tile.proved.word is verdict_at(there, centre(tile.box)).verdict.word
            assert other.proved is None or other.proved.verdict.word is tile.proved.word


def test_interruption_and_budget_keep_what_is_proved() -> None:
    calls = 0

    def judge(x: Any, y: Any) -> str:
        nonlocal calls
        calls += 1
        if calls == 4:
            raise KeyboardInterrupt
        return "proved"

    found = subdivide(UNIT, ByBoundaries([X - fmpq(1, 3)], judge), depth=10)
    assert found.end is End.INTERRUPTED
    assert sum(tile.proved is not None for tile in found.tiles) == 3
    assert sum((tile.box.area for tile in found.tiles), start=fmpq(0)) == UNIT.area
    assert 0 < found.white < 1
    short = subdivide(UNIT, ByBoundaries([X - fmpq(1, 3)], lambda x, y: "proved"), depth=30, most=40)
    assert short.end is End.BUDGET
    assert len(short.tiles) <= 40
    assert sum((tile.box.area for tile in short.tiles), start=fmpq(0)) == UNIT.area
