"""Splits of matrices and components of coupled indices, against numpy and scipy."""

from __future__ import annotations

import numpy as np
from flint import fmpq
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse.csgraph import connected_components

from mbsym.algebra.matrices import components, skew_part, symmetric_part
from mbsym.algebra.point import Rationals


@given(st.integers(1, 5).flatmap(lambda n: st.lists(st.lists(st.integers(-9, 9), min_size=n, max_size=n), min_size=n,
                                                    max_size=n)))  # fmt: skip
def test_a_matrix_is_the_sum_of_its_parts(rows: list[list[int]]) -> None:
    numbers, given_rows = Rationals({}, {}), [[fmpq(x) for x in row] for row in rows]
    symmetric = np.array([[float(x) for x in row] for row in symmetric_part(numbers, given_rows)])
    skew = np.array([[float(x) for x in row] for row in skew_part(numbers, given_rows)])
    assert np.array_equal(symmetric, symmetric.T)
    assert np.array_equal(skew, -skew.T)
    assert np.array_equal(symmetric + skew, np.array(rows, dtype=float))


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
