"""Stacks of slices: surfaces whose level curves change at values known by hand."""

from __future__ import annotations

from typing import Any, NamedTuple

import pytest
from flint import fmpq, fmpq_mpoly_ctx

from mbsym.algebra.arrangements import Arrangement, critical_levels, decompose
from mbsym.algebra.arrangements.arrangement import breaches
from mbsym.algebra.arrangements.space import alike, flattened, levels_of
from mbsym.algebra.failures import TooLargeError
from mbsym.algebra.plane import Box, Budget

X, Y, Z = fmpq_mpoly_ctx.get(["x", "y", "z"]).gens()
BOX = Box(-2, 2, -2, 2)


class Slice(NamedTuple):
    """No arrangement at an irrational z; ``alike``: it is that of the last value before that is not critical."""

    z: Any
    critical: bool
    arrangement: Arrangement | None
    alike: bool


def sliced(factors: list[Any], low: Any, high: Any) -> list[Slice]:
    """At all critical values of z, and at one value between any two."""
    plane = fmpq_mpoly_ctx.get(("x", "y"))
    slices, last = [], None
    for z, critical in levels_of(critical_levels(factors, BOX, low, high)):
        found = None
        if isinstance(z, fmpq):
            flat = [flattened(p, z, plane) for p in factors]
            found = decompose([p if p != 0 else plane.constant(1) for p in flat], BOX)
        slices.append(Slice(z, critical, found, found is not None and last is not None and alike(found, last)))
        last = last if critical else found
    return slices


@pytest.mark.parametrize(
    ("factors", "ends", "values", "regions"),
    [
        ([X**2 + Y**2 + Z**2 - 1], (-2, 2), [-1, 1], [1, 2, 1]),
        # y^2 = x^3 + x^2 - z: the right side has its minimum 0 at x = 0 and its maximum 4/27 at x = -2/3.
        ([Y**2 - X**3 - X**2 + Z], (fmpq(-1, 10), fmpq(1, 5)), [0, fmpq(4, 27)], None),
        ([X * Y - Z], (-1, 1), [0], [3, 3]),
        ([Y - Z * X], (-3, 3), [-1, 1], [2, 2, 2]),
        ([X - Z, Y - X], (-1, 1), [], [4]),
        ([X**2 - 2 * Z**2, X - Y], (fmpq(1, 10), 1), [], [6]),
        ([Z - fmpq(1, 3), X], (0, 1), [fmpq(1, 3)], [2, 2]),
    ],
    ids=["sphere", "oval", "hyperbola", "turning line", "moving line", "two lines", "a level"],
)
def test_levels(factors: list[Any], ends: tuple[Any, Any], values: list[Any], regions: list[int] | None) -> None:
    slices = sliced(factors, *ends)
    critical = [one.z for one in slices if one.critical]
    for value in values:
        assert fmpq(value) in critical
    between = [one for one in slices if not one.critical]
    assert len(between) >= len(values) + 1
    assert all(one.arrangement is not None and not breaches(one.arrangement) for one in between)
    if regions is not None:
        counts = [len(one.arrangement.regions) for one in between if one.arrangement is not None]
        assert [n for k, n in enumerate(counts) if k == 0 or n != counts[k - 1]] == [
            n for k, n in enumerate(regions) if k == 0 or n != regions[k - 1]
        ]


def test_slices_at_critical_values_show_the_degenerate_picture() -> None:
    slices = sliced([X**2 + Y**2 + Z**2 - 1], -2, 2)
    at = next(one for one in slices if one.z == 1)
    assert at.arrangement is not None
    assert [corner.kind for corner in at.arrangement.corners] == ["isolated"]
    assert not at.alike
    irrational = sliced([X**2 + Y**2 + Z**2 - 2], 0, 2)
    assert [one.arrangement is None for one in irrational if one.critical] == [True]


def test_between_critical_values_the_picture_stays() -> None:
    """At random values the arrangement has the shape of the slice that stands for its interval."""
    factors = [Y**2 - X**3 - X**2 + Z, X + Y - Z]
    line = critical_levels(factors, BOX, -1, 1)
    plane = fmpq_mpoly_ctx.get(("x", "y"))
    x, y = plane.gens()

    def shape(z: Any) -> tuple[Any, ...]:
        found = decompose([p.compose(x, y, plane.constant(z), ctx=plane) for p in factors], BOX)
        return (
            sorted(region.signs for region in found.regions),
            sorted(arc.factors for arc in found.arcs),
            sorted((corner.kind, corner.branches, corner.factors) for corner in found.corners),
        )

    for interval in line.intervals:
        a, b = (
            float(line.zeros[k].number) if k is not None else end
            for k, end in zip(interval.ends, (-1.0, 1.0), strict=True)
        )
        for share in (0.13, 0.89):
            value = fmpq(*(a + (b - a) * share).as_integer_ratio())
            assert line.locate(value) is interval
            assert shape(value) == shape(interval.sample)


def test_levels_at_which_nothing_is_seen() -> None:
    """One of two circles apart moves past the other: the picture stays.  A line that passes a circle: it does not."""
    slices = sliced([(X - 1) ** 2 + (Y - Z) ** 2 - fmpq(1, 4), (X + 1) ** 2 + Y**2 - fmpq(1, 4)], -1, 1)
    assert all(one.alike for one in slices[1:] if one.arrangement is not None)
    moving = sliced([X**2 + Y**2 - 1, Y - Z], fmpq(-3, 2), fmpq(3, 2))
    seen = [one for one in moving if not one.critical and not one.alike]
    assert [len(one.arrangement.regions) for one in seen if one.arrangement is not None] == [3, 4, 3]


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(TooLargeError, match="degree"):
        critical_levels([Y**5 + X**7 * Z - 1, Y**4 * Z**3 - X**5], BOX, 0, 1, Budget(degree=20))
    with pytest.raises(ValueError, match="zero"):
        critical_levels([X - X], BOX, 0, 1)
    assert len(sliced([], 0, 1)) == 1
