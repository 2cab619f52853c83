"""Linear invariant relations of the heavy rigid body: Hess and Appelrot's, and none where the books have none."""

from __future__ import annotations

from dataclasses import replace

from flint import Ordering, fmpq_mpoly_ctx

from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.problems.polynomial_integrals.relations import divides, linear_relations

WEIGHTS = (1, 1, 1, 2, 2, 2)
NAMES = ("p", "q", "r", "g1", "g2", "g3")


def body(free, numbers):
    """Euler's and Poisson's equations times A B C."""
    context = fmpq_mpoly_ctx.get([*free, *NAMES], Ordering.lex)
    at = dict(zip((*free, *NAMES), context.gens(), strict=True))
    at |= {name: context.constant(value) for name, value in numbers.items()}
    A, B, C, x0, y0, z0, p, q, r, g1, g2, g3 = (at[k] for k in ("A", "B", "C", "x0", "y0", "z0", *NAMES))
    tops = (
        B * C * ((B - C) * q * r + y0 * g3 - z0 * g2),
        C * A * ((C - A) * r * p + z0 * g1 - x0 * g3),
        A * B * ((A - B) * p * q + x0 * g2 - y0 * g1),
        *(A * B * C * x for x in (r * g2 - q * g3, p * g3 - r * g1, q * g1 - p * g2)),
    )
    return PolynomialField(context, tuple(free), NAMES, tops, A * B * C), at


def test_hess_and_appelrots_case():
    """W. Hess (1890): y0 = 0 and x0^2 A (B - C) = z0^2 C (A - B) give A x0 p + C z0 r = 0."""
    field, at = body(("A", "B", "C", "x0", "z0"), {"y0": 0})
    found = linear_relations(field, WEIGHTS, "ABC")
    A, B, C, x0, z0 = (at[k] for k in ("A", "B", "C", "x0", "z0"))
    hess = A * x0 * at["p"] + C * z0 * at["r"]
    condition = x0**2 * A * (B - C) - z0**2 * C * (A - B)
    (one,) = [x for x in found.relations if x.polynomial == hess]
    assert [p in (condition, -condition) for p in one.conditions] == [True]
    assert divides(field, hess, (condition,))
    assert not divides(field, hess, ())
    assert not divides(field, hess + at["q"], (condition,))
    # Lagrange's axis, an integral: the mass centre on the third axis, A = B.
    assert any(x.polynomial == at["r"] and set(map(str, x.conditions)) == {"x0", "A - B"} for x in found.relations)


def test_at_numbers_there_is_hess_relation_or_proved_none():
    # x0^2 A (B - C) = z0^2 C (A - B) with A, B, C = 6, 4, 1:  18 x0^2 = 2 z0^2, z0 = 3 x0.
    field, at = body((), {"A": 6, "B": 4, "C": 1, "x0": 1, "y0": 0, "z0": 3})
    found = linear_relations(field, WEIGHTS, ())
    assert [x.polynomial for x in found.relations] == [2 * at["p"] + at["r"]]  # 6 p + 3 r
    for numbers in ({"z0": 2}, {"A": 7}, {"y0": 1}):
        other, _ = body((), {"A": 6, "B": 4, "C": 1, "x0": 1, "y0": 0, "z0": 3} | numbers)
        none = linear_relations(other, WEIGHTS, ())
        assert (none.relations, none.complete) == ((), True)


def test_a_wrong_sign_leaves_no_relation():
    field, _ = body((), {"A": 6, "B": 4, "C": 1, "x0": 1, "y0": 0, "z0": 3})
    wrong = replace(field, numerators=(-field.numerators[0], *field.numerators[1:]))
    assert linear_relations(wrong, WEIGHTS, ()).relations == ()


def test_roots_of_parameters_are_not_followed_and_that_is_told():
    """Euler's body: sqrt(A (A - B)) p + sqrt(C (B - C)) r divides its derivative, with coefficients that are roots."""
    field, _ = body(("A", "B", "C"), {"x0": 0, "y0": 0, "z0": 0})
    assert not linear_relations(field, WEIGHTS, "ABC").complete
