"""Zeros of a function within an interval: all of them, however they lie, and no others."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbsym.numerics.events.crossings import Sign, free_of_zeros, nodes, passages, resolved, series

BLUR = 1e-13


def found(g: Callable[[Any], Any], *ends: float, blur: float = BLUR) -> list[tuple[float, int]]:
    """(time, turn) of every passage over adjoining intervals."""
    sign, met = Sign(), []
    for a, b in itertools.pairwise(ends):
        passed, sign, _ = passages(series(g(nodes(a, b))), sign, blur)
        met += [(a + 0.5 * (one.place + 1) * (b - a), one.turn) for one in passed]
    return met


def test_every_zero_of_a_polynomial_is_found_however_many_there_are_in_one_interval() -> None:
    roots = np.array([0.1, 0.11, 0.3, 0.55, 0.7, 0.9, 0.97])
    met = found(lambda t: np.prod([t - root for root in roots], axis=0), 0, 1)
    assert np.allclose([time for time, _ in met], roots, rtol=0, atol=1e-11)
    assert [turn for _, turn in met] == [1, -1, 1, -1, 1, -1, 1]


@given(st.lists(st.floats(-0.99, 0.99), min_size=0, max_size=6), st.floats(0.5, 2))
def test_the_passages_of_a_random_polynomial_are_its_roots(places: list[float], factor: float) -> None:
    roots = sorted(places)
    apart = np.diff([-1, *roots, 1])
    if np.min(apart) < 0.02:
        return  # tested below: what is nearly double
    met = found(lambda t: factor * np.prod([np.ones_like(t), *(t - root for root in roots)], axis=0), -1, 1, blur=1e-15)
    assert np.allclose([time for time, _ in met], roots, rtol=0, atol=1e-8)


def test_a_zero_at_the_border_of_two_intervals_is_found_once() -> None:
    assert found(np.sin, 1, np.pi, 5) == [(pytest.approx(np.pi, abs=1e-15), -1)]
    assert found(lambda t: t - 1, 0, 1, 2) == [(1.0, 1)]


def test_a_double_zero_touches_and_one_beside_it_passes() -> None:
    assert found(lambda t: (t - 1) ** 2 * (1.5 - t), 0, 2) == [
        (pytest.approx(1, abs=1e-7), 0),
        (pytest.approx(1.5, abs=1e-14), -1),
    ]


def test_two_zeros_further_apart_than_the_blur_are_two() -> None:
    both = found(lambda t: (t - 1) ** 2 - 1e-8, 0, 3)
    assert [time for time, _ in both] == [pytest.approx(0.9999, abs=1e-11), pytest.approx(1.0001, abs=1e-11)]
    assert found(lambda t: (t - 1) ** 2 - 1e-8, 0, 3, blur=2e-8) == [(pytest.approx(1, abs=1e-7), 0)]


def test_an_inflection_passes_and_a_start_at_zero_counts() -> None:
    assert found(lambda t: (t - 1) ** 3, 0, 3) == [(pytest.approx(1, abs=1e-4), 1)]
    assert found(np.sin, 0, 2) == [(0.0, 1)]
    assert found(np.cos, 0, 1) == []


def test_what_is_said_to_be_free_of_zeros_has_none() -> None:
    generator = np.random.default_rng(3)
    for _ in range(300):
        coefficients = generator.normal(size=9) * 0.5 ** np.arange(9) + np.array([generator.normal() * 2, *[0] * 8])
        known = series(np.polynomial.chebyshev.chebval(nodes(-1, 1), coefficients))
        if free_of_zeros(known):
            assert not np.any(np.diff(np.sign(np.polynomial.chebyshev.chebval(np.linspace(-1, 1, 2001), coefficients))))


def test_a_kink_is_not_resolved_and_a_smooth_function_is() -> None:
    assert resolved(series(np.exp(nodes(0, 1))))
    assert not resolved(series(np.abs(nodes(0, 1) - 0.3)))
