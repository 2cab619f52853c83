"""Boxes with exactly one root each: a circle and its lines, whose points of intersection are known."""

from __future__ import annotations

from math import sqrt
from typing import Any

import pytest
from flint import arb

from mbsym.algebra import krawczyk
from mbsym.algebra.krawczyk import pivot_rows

Rows = list[list[Any]]


def circle(b: Any) -> list[Any]:
    return [b[0] * b[0] + b[1] * b[1] - 1]


def along(b: Any) -> Rows:
    return [[2 * b[0], 2 * b[1]]]


@pytest.mark.parametrize("tied", [None, (circle, along)])
def test_a_line_meets_a_circle_twice(tied: Any) -> None:
    """x^2 + y^2 = 1, x = y at (1, 1)/sqrt 2 and (-1, -1)/sqrt 2; and the same where the circle is known to hold."""

    def function(b: Any) -> list[Any]:
        return [*circle(b), b[0] - b[1]]

    def jacobian(b: Any) -> Rows:
        return [*along(b), [1, -1]]

    found = krawczyk.search(function, jacobian, [(-2, 2.1), (-2, 2.2)], 2000, tied=tied)
    assert not found.open_boxes
    corner = arb(1) / arb(2).sqrt()
    for sign in (-1, 1):
        (own,) = [box for box in found.roots if all(x.contains(sign * corner) for x in box)]
        assert all(float(x.rad()) < 0.5 for x in own)
    assert len(found.roots) == 2


@pytest.mark.parametrize(("height", "roots"), [(0.5, 2), (1.0, 0), (1.5, 0)])
def test_a_tangent_is_no_proved_root_and_a_line_beside_the_circle_none(height: float, roots: int) -> None:
    """y = h meets x^2 + y^2 = 1 at x = -+sqrt(1 - h^2); a double root at h = 1 stays open, nothing stays at h = 1.5."""

    def function(b: Any) -> list[Any]:
        return [*circle(b), b[1] - arb(height)]

    def jacobian(b: Any) -> Rows:
        return [*along(b), [0, 1]]

    found = krawczyk.search(function, jacobian, [(-2, 2.1), (-2, 2.2)], 400)
    assert len(found.roots) == roots
    assert bool(found.open_boxes) is (height == 1.0)
    near = krawczyk.certified(function, jacobian, [0.8, 0.6])
    assert (near is not None) is bool(roots)
    assert near is None or near[0].overlaps((1 - arb(height) ** 2).sqrt())


def test_unknowns_that_are_linear_may_be_anything() -> None:
    """x^2 = 2 with z x = 1000: z = 1000/sqrt 2, far outside of the box of x."""
    found = krawczyk.search(
        lambda b: [b[0] * b[0] - 2, b[1] * b[0] - 1000],
        lambda b: [[2 * b[0], arb(0)], [b[1], b[0]]],
        [(0.1, 3)],
        500,
        1,
    )
    assert not found.open_boxes
    ((x, z),) = found.roots
    assert x.contains(arb(2).sqrt())
    assert z.contains(1000 / arb(2).sqrt())


def test_a_step_maps_a_box_without_a_root_beside_itself() -> None:
    """x^2 = 2 over [2, 3]: K([2, 3]) = 2.5 - 4.25/5 + (1 - 2 [2, 3]/5)(-1/2 .. 1/2) is within [1.55, 1.75]."""
    box = (arb(2.5, 0.5),)
    image = krawczyk.step(lambda b: [b[0] * b[0] - 2], lambda b: [[2 * b[0]]], box)
    assert image is not None
    assert not image[0].overlaps(box[0])
    assert arb(1.65, 0.11).contains(image[0])
    assert krawczyk.step(lambda b: [b[0] * b[0]], lambda b: [[2 * b[0]]], (arb(0, 1),)) is None


def test_as_many_rows_as_the_rank() -> None:
    rows = [[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [0.0, 0.0, 1e-9], [1.0, 0.0, sqrt(2)]]
    assert len(pivot_rows(rows)) == 3
    assert len(pivot_rows(rows, 1e-6)) == 2
    assert pivot_rows([[0.0, 0.0]]) == []
    assert pivot_rows([]) == []
