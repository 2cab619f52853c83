"""Leading minors: expansion and elimination give the same, and neither runs for minutes."""

from __future__ import annotations

import random

import pytest
from flint import Ordering, fmpq, fmpq_mpoly_ctx

import mbsym
from mbsym.algebra import characteristic
from mbsym.algebra.characteristic import MOST_EXPANDED, leading_minors
from mbsym.algebra.failures import TooLargeError

CONTEXT = fmpq_mpoly_ctx.get(["x", "y"], Ordering.lex)
X, Y = CONTEXT.gens()


def constant(value):
    return CONTEXT.constant(value)


def test_minors_of_min_i_j_are_one():
    """The matrix min(i, j) is L L^T with L full of ones: every leading minor is 1."""
    n = 40
    assert all(x == 1 for x in leading_minors([[constant(1 + min(i, j)) for j in range(n)] for i in range(n)]))


def test_minors_of_a_chain_of_springs():
    """x on the diagonal, -1 beside it: D_k = x D_(k-1) - D_(k-2), Chebyshev's polynomials of the second kind."""
    n = 12
    rows = [[X if i == j else constant(-1 if abs(i - j) == 1 else 0) for j in range(n)] for i in range(n)]
    before, now = constant(1), X
    for minor in leading_minors(rows):
        assert minor == now
        before, now = now, X * now - before


@pytest.mark.parametrize("n", [MOST_EXPANDED + 1, MOST_EXPANDED + 3])
def test_elimination_agrees_with_expansion(n):
    source = random.Random(n)
    rows = [[constant(fmpq(source.randint(-9, 9), 7)) + source.randint(-2, 2) * X for _ in range(n)] for _ in range(n)]
    assert leading_minors(rows) == characteristic._expanded(rows, 10**9)


def test_a_vanishing_minor_on_the_way():
    """Elimination has no pivot there: 0 1; 1 0 in the corner of a unit matrix."""
    n = MOST_EXPANDED + 2
    rows = [[constant(1 if {i, j} == {0, 1} or (i == j and i > 1) else 0) for j in range(n)] for i in range(n)]
    assert [int(str(x)) for x in leading_minors(rows)] == [0] + [-1] * (n - 1)


def test_large_matrices_in_several_letters_are_refused():
    source = random.Random(20)
    rows = [[source.randint(1, 9) * X + source.randint(1, 9) * Y for _ in range(20)] for _ in range(20)]
    with pytest.raises(TooLargeError, match="order 20"):
        leading_minors(rows)


def test_a_chain_of_sixteen_pendulums_is_stable():
    """Hanging: the potential energy has its minimum there (Lagrange-Dirichlet)."""
    bodies = [
        f"  - {{name: b{k}, attached to: {'0' if k == 1 else f'b{k - 1}'}, rotation: {{axes: [3], angles: [q{k}]}},"
        f" connection point: [0, {-1 if k > 1 else 0}, 0], mass centre: [0, -1, 0], mass: {k}}}"
        for k in range(1, 17)
    ]
    gravity = "loads:\n  - uniform gravity: {acceleration: 9.81, direction: [0, -1, 0]}\nmotion: {q1: 0}\n"
    found = mbsym.loads("\n".join(["mbsym: 1", "name: chain", "bodies:", *bodies, gravity])).stability
    assert found.verdict.word.value == "stable"
