"""Counts of roots by signs agree with the exact counts, wherever no sign vanishes."""

from __future__ import annotations

import numpy as np
from flint import fmpq, fmpq_poly
from hypothesis import given
from hypothesis import strategies as st
from properties import settings

from mbsym.algebra.failures import SingularPoint
from mbsym.algebra.point import Rationals
from mbsym.algebra.roots import count_roots
from mbsym.sweeps.deciding import changes, real_roots, routh_column, sturm_ends

NUMBERS = Rationals({}, {})
COEFFICIENTS = st.lists(st.integers(-9, 9), min_size=2, max_size=8).filter(lambda cs: cs[-1] != 0 and cs[0] != 0)


def signs(values: list[fmpq]) -> np.ndarray:
    return np.array([[int(x > 0) - int(x < 0)] for x in values])


@settings(max_examples=200)
@given(COEFFICIENTS, st.integers(0, 3))
def test_rouths_column_counts_the_roots_on_the_right(cs: list[int], shift: int) -> None:
    numbers = [fmpq(c) for c in cs]
    try:
        column = signs(routh_column(numbers, NUMBERS, shift))
    except SingularPoint:
        return
    if np.all(column != 0):
        assert changes(column)[0] == count_roots(numbers).right


@settings(max_examples=200)
@given(COEFFICIENTS, st.integers(0, 3))
def test_sturms_ends_count_the_real_roots(cs: list[int], shift: int) -> None:
    numbers = [fmpq(c) for c in cs]
    if len(cs) < 3:
        return
    try:
        leading, constant = map(signs, sturm_ends(numbers, NUMBERS, shift))
    except SingularPoint:
        return
    if np.any(leading == 0):
        return
    negative, positive = real_roots(leading, constant)
    polynomial = fmpq_poly(numbers)
    real = [root for root, _ in polynomial.complex_roots() if root.imag == 0]
    assert (negative[0], positive[0]) == (sum(root.real < 0 for root in real), sum(root.real > 0 for root in real))


def test_a_shift_helps_where_the_sequence_of_q_ends_early() -> None:
    cubic = [fmpq(1), fmpq(0), fmpq(0), fmpq(1)]  # w^3 + 1: one real root, -1
    leading, constant = map(signs, sturm_ends(cubic, NUMBERS, 2))
    assert np.all(leading != 0)
    assert [int(x[0]) for x in real_roots(leading, constant)] == [1, 0]


def test_zeros_are_passed_over() -> None:
    assert changes(np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])).tolist() == [1, 1]
