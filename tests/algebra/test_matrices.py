"""Splits of matrices, determinants, adjugates, kernels: by hand, against numpy and scipy."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import Ordering, fmpq, fmpq_mat, fmpq_mpoly_ctx
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse.csgraph import connected_components
from test_ring import new_ring

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.matrices import (
    Operators,
    PrimitiveRows,
    ScalarMatrix,
    adjugate,
    adjugate_at,
    adjugate_slope_at,
    components,
    cramer,
    determinant,
    determinant_by_traces,
    faddeev,
    hurwitz,
    inverted,
    leading_determinants,
    leading_minors,
    null_space,
    null_space_of_rationals,
    reduced_rows,
    skew,
    solved,
    symmetric,
)
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


NUMBERS = Rationals({}, {})


@given(sizes, seeds)
def test_determinants_of_every_route_are_one(n: int, seed: int) -> None:
    """Expansion, Faddeev's recursion and the library; A adj A = det A; A x = b by Cramer's rule."""
    random = np.random.default_rng(seed)
    rows = [[fmpq(int(x)) for x in row] for row in random.integers(-9, 9, (n, n))]
    right = [fmpq(int(x)) for x in random.integers(-9, 9, n)]
    whole, value = fmpq_mat(rows), fmpq_mat(rows).det()
    assert determinant(NUMBERS, rows) == determinant_by_traces(rows, fmpq(0), fmpq(1)) == value
    assert leading_minors(NUMBERS, rows) == list(leading_determinants(fmpq_mat, rows))
    adjoint = adjugate(rows, lambda minor: determinant(NUMBERS, minor))
    unit = [[fmpq(int(i == j)) for j in range(n)] for i in range(n)]
    assert whole * fmpq_mat(adjoint) == fmpq_mat(unit) * value
    found = cramer(NUMBERS, rows, right)
    assert whole * fmpq_mat([[x] for x in found]) == fmpq_mat([[b] for b in right]) * value
    if value != 0:
        assert fmpq_mat(inverted(rows, lambda x: 1 / x, fmpq(0), fmpq(1))) == whole.inv()
        sides = [[b, -b] for b in right]
        assert whole * fmpq_mat(solved(NUMBERS, rows, sides)) == fmpq_mat(sides)


def test_adjugate_of_a_characteristic_matrix_by_hand() -> None:
    """A = (2 1; 1 3): det(s - A) = s^2 - 5 s + 5, adj(s - A) = (s - 3, 1; 1, s - 2), its derivative the unit matrix."""
    rows, units = [[fmpq(2), fmpq(1)], [fmpq(1), fmpq(3)]], (fmpq(0), fmpq(1))
    adjugates, coefficients = faddeev(rows, *units)
    assert coefficients == [5, -5, 1]
    assert adjugates == [[[1, 0], [0, 1]], [[-3, 1], [1, -2]]]
    assert adjugate_at(rows, fmpq(7), *units) == [[4, 1], [1, 5]]
    assert adjugate_slope_at(rows, fmpq(7), *units) == [[1, 0], [0, 1]]
    assert faddeev([], *units) == ([[]], [1])


def test_hurwitz_s_matrix_by_hand() -> None:
    """s^3 + 2 s^2 + 3 s + 4: rows of c_1 c_3 c_5, c_0 c_2 c_4, 0 c_1 c_3."""
    assert hurwitz([1, 2, 3, 4], 0, 3) == [[2, 4, 0], [1, 3, 0], [0, 2, 4]]


def test_kernels_by_hand() -> None:
    """x + 2 y + 3 z = 0, 2 x + 4 y + 7 z = 0: z = 0, x = -2 y."""
    rows = [[fmpq(1), fmpq(2), fmpq(3)], [fmpq(2), fmpq(4), fmpq(7)]]
    assert null_space(NUMBERS, rows, 3) == [[-2, 1, 0]]
    assert reduced_rows(fmpq_mat(rows)) == {0: [1, 2, 0], 2: [0, 0, 1]}
    assert null_space(NUMBERS, [], 2) == [[1, 0], [0, 1]]


@given(st.lists(st.lists(st.integers(-2, 2), min_size=5, max_size=5), max_size=8))
def test_kernels_of_sparse_rows_are_annulled_and_complete(rows: list[list[int]]) -> None:
    sparse = [{column: fmpq(x) for column, x in enumerate(row) if x} for row in rows]
    basis = null_space_of_rationals(sparse, 5)
    assert all(sum(x * y for x, y in zip(row, vector, strict=True)) == 0 for row in rows for vector in basis)
    rank = fmpq_mat(rows).rank() if rows else 0
    assert len(basis) == 5 - rank
    assert not basis or fmpq_mat(basis).rank() == len(basis)


def test_rows_of_polynomials_stay_primitive() -> None:
    """b (a x + b y + z) - a (b x + a y) = (b^2 - a^2) y + b z; the first row without y, by hand, too."""
    context = fmpq_mpoly_ctx.get(["a", "b"], Ordering.lex)
    a, b = context.gens()
    operators = Operators(context.constant(0), context.constant(1))
    held = PrimitiveRows(operators, 10, "too long")
    held.add({0: a, 1: b, 2: a * 0 + 1}, 0)
    left = held.reduced({0: b, 1: a})
    assert left == {1: a**2 - b**2, 2: -b}
    held.add(left, 1)
    # (a^2 - b^2)(a x + b y + z) - b ((a^2 - b^2) y - b z) = a ((a^2 - b^2) x + a z): the factor a is common
    assert held.pivots[0] == {0: a**2 - b**2, 2: a}
    short = PrimitiveRows(operators, 1, "too long")
    short.add({0: a, 1: b}, 0)
    with pytest.raises(NoClosedForm, match="too long"):
        short.reduced({0: b, 1: a})
