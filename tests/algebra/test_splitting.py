"""Polynomial equations taken apart: no solution is lost, none is counted twice."""

from __future__ import annotations

from itertools import product

import pytest
from flint import Ordering, fmpq, fmpq_mpoly_ctx
from hypothesis import given
from hypothesis import strategies as st
from properties import settings

from mbsym.algebra.splitting import SplitLimits, exchanged, split

CONTEXT = fmpq_mpoly_ctx.get(["a", "x", "y", "z"], Ordering.degrevlex)
A, X, Y, Z = CONTEXT.gens()


def _at(p, point):
    return p.compose(*map(CONTEXT.constant, point), ctx=CONTEXT)


def _holds(branch, point):
    """Whether a point lies on a branch, its denominators included."""
    for s in branch.solved:
        if _at(s.denominator, point) == 0 or _at(s.denominator * CONTEXT.gen(s.unknown) - s.numerator, point) != 0:
            return False
    return all(_at(p, point) == 0 for p in branch.remaining) and all(_at(p, point) != 0 for p in branch.nonzero)


_coefficients = st.integers(-2, 2)
_linear = st.builds(lambda a, b, c, d: a * X + b * Y + c * Z + d, *[_coefficients] * 4)
_factor = st.one_of(_linear, st.builds(lambda p, q, a: p * q + a * A, _linear, _linear, _coefficients))


@given(st.lists(st.builds(lambda p, q: p * q, _factor, _linear), min_size=1, max_size=3))
@settings(max_examples=60)
def test_every_solution_lies_on_exactly_one_branch(equations):
    found = split(equations, (1, 2, 3), limits=SplitLimits(branches=400))
    if found.unfinished:
        return
    a = fmpq(5, 7)  # a value at which no generic polynomial of such small coefficients vanishes
    assert all(_at(p, (a, 0, 0, 0)) != 0 for p in found.generic)
    for values in product([fmpq(k) for k in range(-2, 3)] + [fmpq(1, 2)], repeat=3):
        point = (a, *values)
        solves = all(_at(p, point) == 0 for p in equations)
        assert sum(_holds(branch, point) for branch in found.branches) == solves


def test_parameters_that_were_divided_by_are_listed_unless_they_never_vanish():
    assert split([A * X - 1], (1, 2, 3)).generic == (A,)
    assert split([A * X - 1], (1, 2, 3), never_zero=lambda p: p == A).generic == ()


def test_equations_without_solutions_have_no_branch():
    assert split([X * Y - 1, X], (1, 2, 3)).branches == ()


def test_a_budget_that_ends_is_told():
    cubes = [X**3 + Y**2 + Z, X * Y * Z - 1, (X - Y) * (Y - Z) * (Z - X)]
    assert split(cubes, (1, 2, 3), limits=SplitLimits(branches=1)).unfinished


def test_unknowns_change_places():
    (branch,) = split([A * X - Y], (1,), never_zero=lambda p: p == A).branches
    (solved,) = branch.solved
    other = exchanged(branch, solved, 2, (CONTEXT.constant(-1), CONTEXT.constant(1)))
    assert [(s.unknown, s.numerator / s.denominator) for s in other.solved] == [(2, A * X)]


@pytest.mark.parametrize("equations", [[X - X], []])
def test_no_equation_leaves_everything_free(equations):
    (branch,) = split(equations, (1, 2, 3)).branches
    assert branch.solved == ()
    assert branch.remaining == ()
