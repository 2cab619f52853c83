"""Polynomial integrals of Euler's and Poisson's equations, against the integrals of the books."""

from __future__ import annotations

from dataclasses import replace
from math import comb

import pytest
from flint import Ordering, fmpq_mpoly_ctx

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.problems.polynomial_integrals.gradings import grading
from mbsym.problems.polynomial_integrals.modular import PRIMES, count, monomials
from mbsym.problems.polynomial_integrals.search import Search, polynomial_integrals

SPEEDS, VECTOR = ("p", "q", "r"), ("g1", "g2", "g3")


def top(A=None, B=None, C=None, c=(None, None, None), h=(0, 0, 0)):
    """I w' = (I w + h) x w + c x g,  g' = g x w; None is a symbol."""
    numbers = dict(zip(("A", "B", "C", "x0", "y0", "z0"), (A, B, C, *c), strict=True))
    free = tuple(name for name, value in numbers.items() if value is None)
    context = fmpq_mpoly_ctx.get([*free, *SPEEDS, *VECTOR], Ordering.lex)
    at = dict(zip((*free, *SPEEDS, *VECTOR), context.gens(), strict=True))
    at |= {name: context.constant(value) for name, value in numbers.items() if value is not None}
    A, B, C, x, y, z, p, q, r, g1, g2, g3 = (at[n] for n in ("A", "B", "C", "x0", "y0", "z0", *SPEEDS, *VECTOR))
    m = (A * p + h[0], B * q + h[1], C * r + h[2])
    moments = (
        m[1] * r - m[2] * q + y * g3 - z * g2,
        m[2] * p - m[0] * r + z * g1 - x * g3,
        m[0] * q - m[1] * p + x * g2 - y * g1,
    )
    turns = (g2 * r - g3 * q, g3 * p - g1 * r, g1 * q - g2 * p)
    tops = [t * A * B * C / one for t, one in zip(moments, (A, B, C), strict=True)] + [t * A * B * C for t in turns]
    norm = g1**2 + g2**2 + g3**2 - 1
    return PolynomialField(context, free, (*SPEEDS, *VECTOR), tuple(tops), A * B * C, (norm,)), at


def _found(field, degree):
    return polynomial_integrals(field, grading(field, (SPEEDS, VECTOR)), degree)


def test_heavy_top_in_general_has_three():
    """Weights 2, 3, 4; the last two are the area integral and the norm, which no energy is needed for."""
    field, _ = top()
    found = _found(field, 6)
    assert found.grading.weights == (1, 1, 1, 2, 2, 2)
    assert [one.weight for one in found.generators] == [2, 3, 4]
    assert found.complete
    assert found.independent == 3
    assert all(field.derivative(one.polynomial) == 0 for one in found.generators)
    # Products of integrals of weights 2, 3, 4: the coefficients of 1/((1 - x^2)(1 - x^3)(1 - x^4)).
    assert [one.products for one in found.counts] == [0, 1, 1, 2, 1, 3]


@pytest.mark.parametrize(
    ("numbers", "weight", "name"),
    [
        ({"c": (0, 0, 0)}, 2, "Euler"),
        ({"A": 3, "B": 3, "c": (0, 0, None)}, 1, "Lagrange"),
        ({"A": 2, "B": 2, "C": 1, "c": (None, 0, 0)}, 4, "Kovalevskaya"),
    ],
)
def test_classical_cases_have_one_more(numbers, weight, name):
    field, at = top(**numbers)
    found = _found(field, 4)
    fourth = {
        "Euler": lambda: at["A"] ** 2 * at["p"] ** 2 + at["B"] ** 2 * at["q"] ** 2 + at["C"] ** 2 * at["r"] ** 2,
        "Lagrange": lambda: at["r"],
        "Kovalevskaya": lambda: (
            (at["p"] ** 2 - at["q"] ** 2 + at["x0"] * at["g1"]) ** 2
            + (2 * at["p"] * at["q"] + at["x0"] * at["g2"]) ** 2
        ),
    }[name]()
    assert field.derivative(fourth) == 0
    assert found.complete
    # The book's integral is a polynomial in those found: named as known, it leaves the counts what they are.
    again = polynomial_integrals(field, found.grading, 4, [("of the book", fourth)])
    assert [one.weight for one in again.generators if one.name == "of the book"] == [weight]
    assert [one.most for one in again.counts] == [one.products for one in found.counts]


def test_kovalevskayas_integral_is_found_in_few_monomials():
    field, at = top(A=2, B=2, C=1, c=(None, 0, 0))
    (new,) = [one.polynomial for one in _found(field, 4).generators if one.weight == 4 and len(one.polynomial) > 3]
    book = (at["p"] ** 2 - at["q"] ** 2 + at["x0"] * at["g1"]) ** 2 + (2 * at["p"] * at["q"] + at["x0"] * at["g2"]) ** 2
    assert len(new) <= len(book)
    # Goryachev and Chaplygin's case has no integral but on a level: none of degree 3 or 4 in all.
    chaplygin, _ = top(A=4, B=4, C=1, c=(None, 0, 0))
    assert [one.weight for one in _found(chaplygin, 5).generators] == [2, 3, 4]


def test_gyrostats_are_not_quasi_homogeneous():
    """Zhukovsky's integral where there is no weight; none beyond the known where there is."""
    field, at = top(A=3, B=5, C=7, c=(0, 0, 0), h=(1, 2, 3))
    found = _found(field, 4)
    assert not found.grading.homogeneous
    book = (3 * at["p"] + 1) ** 2 + (5 * at["q"] + 2) ** 2 + (7 * at["r"] + 3) ** 2
    again = polynomial_integrals(field, found.grading, 4, [("of the book", book)])
    assert "of the book" in [one.name for one in again.generators]
    assert found.complete
    assert found.independent == 3
    heavy, _ = top(A=3, B=5, C=7, c=(2, 3, 1), h=(1, 2, 3))
    assert [one.weight for one in _found(heavy, 4).generators] == [2, 3]


def test_absence_is_the_same_modulo_another_prime():
    field, _ = top(A=3, B=5, C=7, c=(2, 3, 1))
    weights = grading(field, (SPEEDS, VECTOR))
    first, second = (Search(field, weights, 8, (), prime).found() for prime in PRIMES)
    assert first.counts == second.counts
    assert first.complete


def test_one_that_is_planted_is_found():
    """x' = a x y, y' = -y (a x + z), z' = z y  keeps x + y + z (and z^a/x, no polynomial); a term more ends it."""
    context = fmpq_mpoly_ctx.get(["a", "x", "y", "z"], Ordering.lex)
    a, x, y, z = context.gens()
    field = PolynomialField(
        context, ("a",), ("x", "y", "z"), (a * x * y, -a * y * x - y * z, z * y), context.constant(1)
    )
    found = polynomial_integrals(field, grading(field, (("x", "y", "z"),)), 5)
    assert [str(one.polynomial) for one in found.generators] == ["x + y + z"]
    assert found.complete
    wrong = replace(field, numerators=(field.numerators[0] + x, *field.numerators[1:]))
    assert polynomial_integrals(wrong, found.grading, 5).generators == ()


def test_what_depends_on_the_others_is_told():
    """x' = y, y' = -x, z' = w, w' = -z: four integrals of degree two, three of them independent."""
    context = fmpq_mpoly_ctx.get(["x", "y", "z", "w"], Ordering.lex)
    x, y, z, w = context.gens()
    field = PolynomialField(context, (), ("x", "y", "z", "w"), (y, -x, w, -z), context.constant(1))
    found = polynomial_integrals(field, grading(field, (("x", "y", "z", "w"),)), 4)
    assert [one.weight for one in found.generators] == [2, 2, 2, 2]
    assert sum(one.independent for one in found.generators) == found.independent == 3
    assert found.generators[3].certainty is Certainty.PROVED
    assert found.complete


def test_degrees_that_no_budget_allows_are_refused():
    field, _ = top()
    with pytest.raises(NoClosedForm, match="monomials"):
        _found(field, 60)
    assert count((1, 1, 2), 6) == len(list(monomials((1, 1, 2), 6)))
    assert count((1,) * 6, 4) == comb(9, 4)
