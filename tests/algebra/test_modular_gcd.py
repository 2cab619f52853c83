"""Common divisors over number fields by finite rings, against products known beforehand, and their bounds."""

from __future__ import annotations

from random import Random
from typing import Any

import pytest
from flint import fmpq, fmpq_poly, fmpz_poly

from mbsym.algebra.failures import TooLargeError
from mbsym.algebra.plane.fields import Extension, common_divisor, divides, proved_coprime
from mbsym.algebra.plane.numbers import AlgebraicNumber, number, roots_between


def field_of(*coefficients: int) -> Extension:
    p = fmpz_poly(list(coefficients))
    found = number(roots_between(p, fmpq(0), fmpq(5))[0])
    assert isinstance(found, AlgebraicNumber)
    return Extension(found)


#: x^4 - 10 x^2 + 1 has sqrt 3 - sqrt 2 for its least positive root, and is reducible modulo every prime.
SPLIT = field_of(1, 0, -10, 0, 1)


def some(random: Random, degree: int) -> list[Any]:
    row = [fmpq_poly([fmpq(random.randint(-9, 9), random.randint(1, 9)) for _ in range(4)]) for _ in range(degree)]
    return [*row, fmpq_poly([1])]


def times(field: Extension, a: list[Any], b: list[Any]) -> list[Any]:
    product = [fmpq_poly([0])] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            product[i + j] = (product[i + j] + x * y) % field.modulus
    return product


@pytest.mark.parametrize("degree", [0, 1, 3])
def test_the_common_factor_of_two_products(degree: int) -> None:
    """gcd(g u, g v) = g where u = y^2 - 7 and v = y^2 - 5, which have no common root."""
    g = some(Random(degree), degree)
    u, v = ([fmpq_poly([-c]), fmpq_poly([0]), fmpq_poly([1])] for c in (7, 5))
    found = common_divisor(SPLIT.modulus, times(SPLIT, g, u), times(SPLIT, g, v))
    assert found == [x % SPLIT.modulus for x in g]


def test_roots_that_the_field_has() -> None:
    """alpha = sqrt 3 - sqrt 2 has alpha^3 = 9 sqrt 3 - 11 sqrt 2, so sqrt 2 = (9 alpha - alpha^3)/2."""
    alpha, one = fmpq_poly([0, 1]), fmpq_poly([1])
    line = [(alpha**3 - 9 * alpha) / 2, one]
    assert common_divisor(SPLIT.modulus, [-2 * one, 0 * one, one], line) == line
    assert not proved_coprime(SPLIT.modulus, [-2 * one, 0 * one, one], line)
    assert proved_coprime(SPLIT.modulus, [-7 * one, 0 * one, one], line)


def test_a_wrong_divisor_is_not_taken_for_one() -> None:
    line = [fmpq_poly([1, 2]), fmpq_poly([1])]
    whole = times(SPLIT, line, some(Random(7), 2))
    assert divides(SPLIT.modulus, line, whole)
    whole[0] += fmpq(1, 10**30)
    assert not divides(SPLIT.modulus, line, whole)


def test_long_coefficients_are_refused() -> None:
    """y - 1/3^5000 divides both, and has longer numbers than any prime that is tried."""
    line = [fmpq_poly([fmpq(1, 3**5000)]), fmpq_poly([1])]
    with pytest.raises(TooLargeError, match="a common divisor of polynomials of degrees 2 and 3"):
        common_divisor(SPLIT.modulus, times(SPLIT, line, some(Random(1), 1)), times(SPLIT, line, some(Random(2), 2)))


def test_common_roots_of_even_polynomials_come_in_orbits() -> None:
    """y^4 - 5 y^2 + 6 and y^4 - 2 y^2 - 3: y = +-sqrt 3; with y + 2 as a factor of both there is no such symmetry."""
    one = fmpq_poly([1])
    a, b = ([one * c for c in row] for row in ((6, 0, -5, 0, 1), (-3, 0, -2, 0, 1)))
    found = SPLIT.common_roots(a, b)
    assert found is not None
    real, count = found
    assert count == 2
    assert [round(float(x), 6) for x in real] == [-1.732051, 1.732051]
    line = [one * 2, one]
    assert SPLIT.common_roots(times(SPLIT, a, line), times(SPLIT, b, line)) is None


def test_double_roots() -> None:
    """(y - 1)^2 (y^2 - 3): 1 twice, +-sqrt 3 once; (y^2 + 1)^2 (y - 1): two double ones, none of them real."""
    one = fmpq_poly([1])
    doubles, simple, count = SPLIT.double_roots([one * c for c in (-3, 6, -2, -2, 1)]) or ([], [], 0)
    assert (count, [float(x) for x in doubles]) == (1, [1.0])
    assert [round(float(x), 6) for x in simple] == [-1.732051, 1.732051]
    doubles, simple, count = SPLIT.double_roots([one * c for c in (-1, 1, -2, 2, -1, 1)]) or ([], [], 0)
    assert (count, doubles, [float(x) for x in simple]) == (2, [], [1.0])
    assert SPLIT.double_roots([one * c for c in (-1, 3, -3, 1)]) is None  # (y - 1)^3
