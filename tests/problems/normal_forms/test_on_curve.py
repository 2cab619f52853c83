"""The common root of the even and the odd part of a polynomial, as a fraction of its coefficients."""

from __future__ import annotations

import pytest
from flint import fmpq, fmpq_poly

from mbsym.algebra.failures import SingularPoint
from mbsym.algebra.tower import Element, Tower
from mbsym.problems.normal_forms.exact import _linear, subresultant


def over(tower: Tower, roots: list[int], lead: int = 3) -> list[Element]:
    """lead (mu + r_1)(mu + r_2) ..., low to high."""
    whole = fmpq_poly([lead])
    for r in roots:
        whole *= fmpq_poly([r, 1])
    return [tower.element(fmpq(x)) for x in whole.coeffs()]


@pytest.mark.parametrize(
    ("even", "odd"),
    [([2, 3, 5], [2, 7, 1]), ([2, 3], [2]), ([2, 3], [2, 9]), ([2], [2]), ([2], [2, 4]), ([2, 3, 5, 6], [2, 7])],
)
def test_the_common_root_is_minus_two(even: list[int], odd: list[int]) -> None:
    tower = Tower()
    p, q = over(tower, even), over(tower, odd, -2)
    constant, slope = _linear(tower, p, q)
    assert tower.rational(constant / slope) == 2
    assert subresultant(tower, p, q, 0)[0].is_zero()


def test_the_resultant_is_that_of_the_roots() -> None:
    """p = 3 (mu + 1)(mu + 2), q = -2 (mu + 4): res = 3 q(-1) q(-2) = 3 (-6)(-4)."""
    tower = Tower()
    assert tower.rational(subresultant(tower, over(tower, [1, 2]), over(tower, [4], -2), 0)[0]) == 72


def test_two_common_roots_have_no_slope() -> None:
    tower = Tower()
    p, q = over(tower, [2, 3, 5]), over(tower, [2, 3, 7])
    assert all(x.is_zero() for x in subresultant(tower, p, q, 1))
    with pytest.raises(SingularPoint):
        _linear(tower, p, over(tower, []))
