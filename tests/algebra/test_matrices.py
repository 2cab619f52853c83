"""Splits of matrices and components of coupled indices, against numpy and scipy."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import fmpq
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse.csgraph import connected_components
from test_ring import new_ring

from mbsym.algebra.matrices import ScalarMatrix, components, skew, symmetric
from mbsym.algebra.point import Rationals
from mbsym.expressions.angles import LinearForm


@given(st.integers(1, 5).flatmap(lambda n: st.lists(st.lists(st.integers(-9, 9), min_size=n, max_size=n), min_size=n,
                                                    max_size=n)))  # fmt: skip
def test_a_matrix_is_the_sum_of_its_parts(rows: list[list[int]]) -> None:
    matrix = over_rationals(rows)
    even, odd = in_floats(symmetric(matrix)), in_floats(skew(matrix))
    assert np.array_equal(even, even.T)
    assert np.array_equal(odd, -odd.T)
    assert np.array_equal(even + odd, np.array(rows, dtype=float))
    assert symmetric(matrix) + skew(matrix) == matrix


def over_rationals(rows: Any) -> ScalarMatrix:
    return ScalarMatrix(Rationals({}, {}), [[fmpq(int(x)) for x in row] for row in rows])


def in_floats(matrix: ScalarMatrix) -> Any:
    return np.array([[float(x) for x in row] for row in matrix])


sizes = st.integers(1, 4)
seeds = st.integers(0, 10**6)


@given(sizes, sizes, sizes, seeds)
def test_products_and_sums_are_numpy_s(n: int, k: int, m: int, seed: int) -> None:
    """Small whole numbers: floats are exact."""
    random = np.random.default_rng(seed)
    a, b, c = (random.integers(-9, 9, shape) for shape in ((n, k), (k, m), (n, k)))
    A, B, C = map(over_rationals, (a, b, c))
    assert np.array_equal(in_floats(A @ B), a @ b)
    assert np.array_equal(in_floats(A + C), a + c)
    assert np.array_equal(in_floats(A - C), a - c)
    assert np.array_equal(in_floats(-A * fmpq(3)), -3 * a)
    assert np.array_equal(in_floats(A.T), a.T)
    assert (A @ B).T == B.T @ A.T
    assert A.shape == (n, k)
    assert A[n - 1, 0] == int(a[n - 1, 0])
    rows, columns = sorted({0, n - 1}), sorted({0, k - 1})
    assert np.array_equal(in_floats(A.cut(rows, columns)), a[np.ix_(rows, columns)])


def test_products_over_the_ring_are_in_normal_form() -> None:
    """R R^T = 1 for a turn: sin^2 + cos^2 = 1 is used."""
    ring = new_ring()
    sine, cosine = ring.sin_cos(LinearForm((("x", Fraction(1)),)))
    R = ScalarMatrix(ring, [[cosine, sine], [-sine, cosine]])
    one = ScalarMatrix.by_entry(ring, 2, 2, lambda i, j: ring.one if i == j else ring.zero)
    assert one == R @ R.T
    assert one == R.T @ R
    assert symmetric(R) == one * cosine


@pytest.mark.parametrize("what", ["+", "-", "@"])
def test_shapes_that_do_not_fit(what: str) -> None:
    wide, tall = over_rationals([[1, 2, 3], [4, 5, 6]]), over_rationals([[1, 2]])
    with pytest.raises(ValueError, match="matrices of 2 x 3 and 1 x 2"):
        {"+": wide.__add__, "-": wide.__sub__, "@": wide.__matmul__}[what](tall)


@st.composite
def graphs(draw: st.DrawFn) -> tuple[int, set[tuple[int, int]]]:
    size = draw(st.integers(1, 8))
    index = st.integers(0, size - 1)
    return size, draw(st.sets(st.tuples(index, index)))


@given(graphs())
def test_components_are_those_of_the_graph(graph: tuple[int, set[tuple[int, int]]]) -> None:
    size, edges = graph
    found = components(size, lambda i, j: (i, j) in edges or (j, i) in edges)
    matrix = np.zeros((size, size))
    for i, j in edges:
        matrix[i, j] = 1
    count, labels = connected_components(matrix, directed=False)
    assert sorted(map(tuple, found)) == sorted(tuple(np.flatnonzero(labels == k)) for k in range(count))
    assert [part[0] for part in found] == sorted(part[0] for part in found)
