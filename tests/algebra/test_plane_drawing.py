"""Areas against integrals done by hand, polylines against the curves that they follow."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from flint import fmpq, fmpq_mpoly_ctx

from mbsym.algebra.arrangements import areas, decompose, polyline
from mbsym.algebra.plane import Box

X, Y = fmpq_mpoly_ctx.get(["x", "y"]).gens()
BOX = Box(-2, 2, -2, 2)


@pytest.mark.parametrize(
    ("factors", "expected"),
    [
        ([X**2 + Y**2 - 1], [math.pi, 16 - math.pi]),
        ([Y**2 - X**3 - X**2], [8 / 15]),  # the loop: 2 times the integral of -x sqrt(1 + x) over [-1, 0]
        ([(X**2 + Y**2) ** 2 - 2 * (X**2 - Y**2)], [1, 1, 14]),
        ([X * Y - 1], [3 - 2 * math.log(2), 3 - 2 * math.log(2)]),
        ([Y**2 - X**3], [8 - 6 / 5 * 2 ** (5 / 3)]),
        ([X**2 - 2], [4 * (2 - math.sqrt(2)), 8 * math.sqrt(2)]),
    ],
    ids=["circle", "loop", "lemniscate", "hyperbola", "cusp", "lines"],
)
def test_areas(factors: list[object], expected: list[float]) -> None:
    found = areas(decompose(factors, BOX))
    assert math.isclose(sum(area for area, _ in found), 16, abs_tol=1e-9)
    for value in expected:
        assert any(abs(area - value) <= error + 1e-9 and error < 1e-5 for area, error in found), (value, found)


@pytest.mark.parametrize(
    "factors",
    [
        [X**2 + Y**2 - 1],
        [Y**2 - X**3 - X**2, X + fmpq(1, 2)],
        [Y**3 - X, X * Y - fmpq(1, 50)],
        [(X**2 + Y**2) ** 2 - 2 * (X**2 - Y**2)],
        [Y - 40 * X**3 + X],
    ],
    ids=["circle", "node and vertical", "vertical tangent", "lemniscate", "steep"],
)
def test_polylines_follow_their_arcs(factors: list[object]) -> None:
    found = decompose(factors, BOX)
    assert found.arcs
    for arc in found.arcs:
        points = polyline(found, arc, 1e-3)
        polynomial = found.factors[arc.factors[0]]
        slopes = [polynomial.derivative(k) for k in (0, 1)]
        for end, corner in ((0, arc.corners[0]), (-1, arc.corners[1])):
            if corner is not None:
                assert points[end] == pytest.approx(found.corners[corner].point.floats(), abs=1e-12)
        if arc.corners == (None, None):
            assert points[0] == points[-1]
        for a, b in pairwise(points):
            middle = [fmpq(*((p + q) / 2).as_integer_ratio()) for p, q in zip(a, b, strict=True)]
            steepness = math.hypot(*(float(slope(*middle)) for slope in slopes))
            distance = abs(float(polynomial(*middle))) / steepness if steepness > 1e-2 else 0  # to first order
            assert distance < 4 * 4e-3
            assert math.dist(a, b) < 4.1
