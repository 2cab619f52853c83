"""Kernels modulo a prime: what is left out beforehand, and remainders, against the plain ways to the same."""

from __future__ import annotations

import pytest
from flint import Ordering, fmpq_mpoly_ctx, nmod_mat
from hypothesis import given
from hypothesis import strategies as st

from mbsym.algebra.failures import Limit, NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.problems.polynomial_integrals import modular
from mbsym.problems.polynomial_integrals.modular import ModularField, kernel, kernel_of, matrix_of, null_space, possible

PRIME = 10007

#: Few entries in many rows, as derivatives of monomials have; columns that repeat give kernels.
sparse = st.lists(st.dictionaries(st.tuples(st.integers(0, 9)), st.integers(0, 5), max_size=3), min_size=1, max_size=12)


def _span(vectors, count):
    rows = [[v.get(k, 0) for k in range(count)] for v in vectors]
    if not rows:
        return []
    reduced, rank = nmod_mat(rows, PRIME).rref()
    return [[int(reduced[r, k]) for k in range(count)] for r in range(rank)]


@given(sparse)
def test_a_kernel_is_that_of_the_whole_matrix(images):
    count = len(images)
    whole = [{k: c for k, c in enumerate(v) if c} for v in null_space(matrix_of(images, PRIME))]
    assert _span(kernel_of(images, PRIME), count) == _span(whole, count)


@given(sparse)
def test_what_is_left_out_is_in_no_vector_of_the_kernel(images):
    left = set(possible(images))
    for vector in null_space(matrix_of(images, PRIME)):
        assert {k for k, c in enumerate(vector) if c} <= left


def test_rows_with_one_entry_go_one_after_another():
    """a + b in one row, b in another: b goes, and then a; c has no row, and stays."""
    assert possible([{(0,): 1}, {(0,): 1, (1,): 1}, {}]) == [2]


def _two_circles():
    """x, y and u, v with x^2 + y^2 - 1 and u^2 + v^2 - x y, of which the second leads into the first."""
    context = fmpq_mpoly_ctx.get(["u", "v", "x", "y"], Ordering.lex)
    u, v, x, y = context.gens()
    relations = (u**2 + v**2 - x**2, x**2 + y**2 - 1)
    return PolynomialField(context, (), ("u", "v", "x", "y"), (v, -u, y, -x), context.constant(1), relations)


@given(st.dictionaries(st.tuples(*[st.integers(0, 5)] * 4), st.integers(-4, 4), max_size=6))
def test_remainders_modulo_a_prime_are_the_exact_ones(terms):
    field = _two_circles()
    f = field.context.from_dict(terms)
    there = ModularField(field, PRIME, {})
    assert there.reduced(there.terms(f)) == there.terms(field.reduced(f))


def test_more_terms_than_the_bound_are_refused_by_name(monkeypatch):
    field = _two_circles()
    monkeypatch.setattr(modular, "MOST_TERMS", 3)
    with pytest.raises(NoClosedForm, match="more than 3 terms") as refused:
        kernel(ModularField(field, PRIME, {}), [(2, 0, 0, 0), (0, 2, 1, 0), (1, 1, 0, 0)], True)
    assert refused.value.limit is Limit.TERMS
    assert refused.value.remedy
