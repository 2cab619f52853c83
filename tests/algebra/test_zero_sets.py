"""Real zeros of polynomials in angles and coordinates: against zeros that are known by hand, and by counting signs."""

from __future__ import annotations

import itertools
from fractions import Fraction as F
from math import acos, cos, pi, sin
from typing import Any

import pytest
from flint import fmpq_mat
from hypothesis import given
from hypothesis import strategies as st
from properties import settings

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.matrices import determinant
from mbsym.algebra.ring import Ring
from mbsym.algebra.zeros_in_boxes import EXACT, SIGNS, zero_sets

RING = Ring(["a", "b", "x", "h"], [], [], {"a": 1, "b": 1, "h": 2}, spare=4)
S, C = RING.generator("sine", "a"), RING.generator("cosine", "a")
S2, C2 = RING.generator("sine", "b"), RING.generator("cosine", "b")
X = RING.generator("coordinate", "x")


def number(value: F | int) -> Any:
    return RING.number(value)


def found(p: Any) -> Any:
    return zero_sets(RING, [RING.reduce(p)], {"x": F(10)})


def turns(p: Any) -> set[F]:
    """Values as parts of pi; every one of them is known exactly."""
    result = found(p)
    assert result.complete
    values = [zero.turns for one in result.sets for zero in one.zeros]
    assert None not in values
    return set(values)


@pytest.mark.parametrize(
    ("p", "expected"),
    [
        (S * S, {0, 1}),
        (C * C, {F(1, 2), F(-1, 2)}),
        (number(2) * C - number(1), {F(1, 3), F(-1, 3)}),
        (number(4) * C * C - number(3), {F(1, 6), F(-1, 6), F(5, 6), F(-5, 6)}),
        (number(2) * S * S - number(1), {F(1, 4), F(-1, 4), F(3, 4), F(-3, 4)}),
        (S + C, {F(-1, 4), F(3, 4)}),
        (number(1) + S, {F(-1, 2)}),
        (number(1) + C, {1}),
    ],
)
def test_known_angles(p: Any, expected: set[F]) -> None:
    assert turns(p) == expected


def test_an_angle_that_is_no_fraction_of_pi() -> None:
    (one,) = found(number(3) * C - number(1)).sets
    assert sorted(float(zero.ball.mid()) for zero in one.zeros) == pytest.approx([-acos(1 / 3), acos(1 / 3)])
    assert all(zero.turns is None for zero in one.zeros)


def test_half_angles_have_twice_the_period() -> None:
    """cos(h/2) = 0 at h = pi and -pi, which differ by half the period 4 pi."""
    assert turns(RING.generator("cosine", "h")) == {1, -1}


@pytest.mark.parametrize("ratio", [F(1, 10**12), F(1), F(10**12)])
def test_the_double_pendulum_is_nowhere_singular(ratio: F) -> None:
    """det M = l1^2 l2^2 m2 (m1 + m2 sin^2 theta2)."""
    result = found(number(1) + number(ratio) * S2 * S2)
    assert result.complete
    assert not result.sets
    assert len(result.nowhere) == 1


def test_isolated_points_curves_and_nothing() -> None:
    touching = found(S * S + S2 * S2)
    (one,) = touching.sets
    assert touching.complete
    assert one.known == EXACT
    assert one.isolated
    corners = {(round(float(p["a"].mid()) / pi), round(float(p["b"].mid()) / pi)) for p in one.points}
    assert corners == {(0, 0), (0, 1), (1, 0), (1, 1)}
    (crossing,) = found(number(1) + number(2) * S * C2).sets
    assert crossing.known == SIGNS
    (point,) = crossing.points
    assert 1 + 2 * sin(float(point["a"].mid())) * cos(float(point["b"].mid())) == pytest.approx(0, abs=1e-14)
    nothing = found(number(2) + C * C2)
    assert nothing.complete
    assert not nothing.sets
    assert found(number(3) + C * C2 + X * X).bounded == ("x",)


def test_a_difference_of_angles_is_one_angle() -> None:
    """2 + cos(a - b) has no zero, 1 - cos^2(a - b) vanishes on two curves: no search in two dimensions is needed."""
    difference = C * C2 + S * S2
    assert not found(number(2) + difference).sets
    sets = found(number(1) - difference * difference).sets
    points = [p for one in sets for p in one.points]
    assert sorted(round(abs(sin(float(p["a"].mid()) - float(p["b"].mid()))), 12) for p in points) == [0, 0]
    assert not any(one.isolated for one in sets)


def test_a_coordinate_has_all_its_roots() -> None:
    (zero,) = (zero for one in found(number(7) * X - number(3)).sets for zero in one.zeros)
    assert zero.rational == F(3, 7)
    roots = [zero for one in found(X * X - number(2)).sets for zero in one.zeros]
    assert sorted(float(zero.ball.mid()) for zero in roots) == pytest.approx([-(2**0.5), 2**0.5])
    assert not found(X * X + number(1)).sets


def test_what_is_no_polynomial_is_refused() -> None:
    root = RING.square_root(number(2) + X * X)
    with pytest.raises(NoClosedForm):
        found(root + X)


@settings(max_examples=60)
@given(st.lists(st.integers(-4, 4), min_size=5, max_size=5))
def test_zeros_in_one_angle_are_those_that_signs_show(c: list[int]) -> None:
    """p = c0 + c1 s + c2 c + c3 s c + c4 c^2: wherever the sign changes on a fine grid a zero is listed nearby."""
    p = RING.reduce(number(c[0]) + c[1] * S + c[2] * C + c[3] * S * C + c[4] * C * C)

    def value(a: float) -> float:
        return c[0] + c[1] * sin(a) + c[2] * cos(a) + c[3] * sin(a) * cos(a) + c[4] * cos(a) ** 2

    if p.is_constant():
        return
    listed = [float(zero.ball.mid()) for one in found(p).sets for zero in one.zeros]
    assert all(abs(value(a)) < 1e-12 for a in listed)
    grid = [-pi + 0.011 + 2 * pi * k / 400 for k in range(401)]
    for a, b in itertools.pairwise(grid):
        if value(a) * value(b) < 0:
            assert any(a <= z + 2 * pi * k <= b for z in listed for k in (0, 1)), (c, a)


@given(st.lists(st.integers(-5, 5), min_size=16, max_size=16))
@settings(max_examples=40)
def test_determinants(entries: list[int]) -> None:
    rows = [[number(x) for x in entries[4 * i : 4 * i + 4]] for i in range(4)]
    assert determinant(RING, rows) == number(F(str(fmpq_mat(4, 4, entries).det())))
