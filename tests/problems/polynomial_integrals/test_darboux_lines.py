"""Values of a parameter with further Darboux polynomials: those known of Lorenz's, Rabinovich's and Euler's equations.

Lorenz' x' = s (y - x), y' = w x - y - x z, z' = x y - b z:  M. Kus, J. Phys. A 16 (1983) L689, lists six f with their
K (all that there are: J. Llibre & X. Zhang, J. Math. Phys. 43 (2002) 1622).  Rabinovich's
x' = h y - n1 x + y z, y' = h x - n2 y - x z, z' = x y - n3 z:  by hand,  (x^2 + y^2 - 4 h z)' = -2 n (...) where
n1 = n2 = n, n3 = 2 n,  and  (x^2 - y^2 - 2 z^2)' = -2 n (...)  where all three are n.
"""

from __future__ import annotations

from fractions import Fraction
from math import exp

import pytest
from flint import Ordering, fmpq, fmpq_mpoly_ctx

import mbsym
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.analysis import polynomial
from mbsym.problems.polynomial_integrals.darboux import darboux_along
from mbsym.problems.polynomial_integrals.gradings import grading
from mbsym.problems.polynomial_integrals.homogenised import InAnyField
from mbsym.problems.polynomial_integrals.search import polynomial_integrals

KINDS = (("x", "y", "z"),)


def field_of(names, write):
    context = fmpq_mpoly_ctx.get([*names, "x", "y", "z"], Ordering.lex)
    return PolynomialField(context, names, ("x", "y", "z"), tuple(write(context.gens())), context.constant(1))


def lorenz(sign=1, **values):
    def write(gens):
        s, w, b, x, y, z = gens
        return s * (y - x), w * x - y - x * z, sign * x * y - b * z

    numbers = {name: Fraction(v) for name, v in values.items()}
    return field_of(("s", "w", "b"), write).at({name: fmpq(v.numerator, v.denominator) for name, v in numbers.items()})


def rabinovich(**values):
    def write(gens):
        h, n1, n2, n3, x, y, z = gens
        return h * y - n1 * x + y * z, h * x - n2 * y - x * z, x * y - n3 * z

    return field_of(("h", "n1", "n2", "n3"), write).at({name: fmpq(v) for name, v in values.items()})


def along(field, low, high, degree):
    usual = polynomial_integrals(field, grading(field, KINDS), degree)
    return InAnyField(usual, KINDS, ()).darboux_along(Fraction(low), Fraction(high))


#: Parameters, the one that is varied, the interval, the degree: at a value f up to a factor, and K.
KNOWN = [
    (
        {"s": 1, "w": 0},
        "b",
        (-5, 5),
        4,
        {
            1: (lambda x, y, z: y**2 + z**2, -2),
            2: (lambda x, y, z: x**2 - 2 * z, -2),
            4: (lambda x, y, z: 4 * z + y**2 - 2 * x * y + x**2 * z - x**4 / 4, -4),
        },
    ),
    (
        {"s": Fraction(1, 3), "w": 2},
        "b",
        (-1, 1),
        4,
        {
            0: (lambda x, y, z: -2 * x**2 + y**2 / 3 + 2 * x * y / 3 + x**2 * z - 3 * x**4 / 4, Fraction(-4, 3)),
            Fraction(2, 3): (lambda x, y, z: x**2 - 2 * z / 3, Fraction(-2, 3)),
        },
    ),
    ({"s": 1, "w": 3}, "b", (0, Fraction(3, 2)), 2, {1: (lambda x, y, z: -3 * x**2 + y**2 + z**2, -2)}),
    # b = 6 s - 2, w = 2 s - 1 where w varies: the eigenvalues at the origin move with the root of 1 + 8 w.
    (
        {"s": 2, "b": 10},
        "w",
        (0, 5),
        4,
        {3: (lambda x, y, z: 9 * x**2 / 2 + 2 * y**2 - 6 * x * y - x**4 / 8 + x**2 * z, -8)},
    ),
]


@pytest.mark.parametrize(("numbers", "name", "interval", "degree", "known"), KNOWN)
def test_all_that_are_known_of_lorenz_equations_are_found(numbers, name, interval, degree, known):
    field = lorenz(**numbers)
    found = along(field, *interval, degree)
    assert [one.value for one in found.values] == sorted(map(Fraction, known))
    assert found.complete
    for one in found.values:
        write, cofactor = known[one.value]
        (f,) = one.polynomials
        context = one.field.context
        expected = write(*context.gens())
        assert f.polynomial * (expected.leading_coefficient() / f.polynomial.leading_coefficient()) == expected
        assert f.cofactor == context.constant(fmpq(Fraction(cofactor).numerator, Fraction(cofactor).denominator))


def test_along_a_trajectory_f_decays_as_its_cofactor_says():
    """Numbers beside the algebra: Runge's and Kutta's steps of Lorenz' equations at s = 2, w = 3, b = 10."""
    found = along(lorenz(s=2, w=3), 9, 11, 4)
    (f,) = found.values[0].polynomials
    terms = [(float(Fraction(int(c.p), int(c.q))), m) for m, c in f.polynomial.to_dict().items()]

    def value(p):
        return sum(c * p[0] ** int(m[0]) * p[1] ** int(m[1]) * p[2] ** int(m[2]) for c, m in terms)

    def slope(p):
        x, y, z = p
        return 2 * (y - x), 3 * x - y - x * z, x * y - 10 * z

    def moved(p, k, h):
        return [a + h * b for a, b in zip(p, k, strict=True)]

    point, h = [1.0, -2.0, 0.5], 1e-3
    start = value(point)
    for _ in range(500):
        a = slope(point)
        b = slope(moved(point, a, h / 2))
        c = slope(moved(point, b, h / 2))
        d = slope(moved(point, c, h))
        point = [p + h / 6 * (i + 2 * j + 2 * k + n) for p, i, j, k, n in zip(point, a, b, c, d, strict=True)]
    assert value(point) == pytest.approx(start * exp(-8 * 0.5), rel=1e-8)


def test_a_planted_error_is_not_covered():
    """With z' = -x y - b z the f of Lorenz' equations are none, and x^2 + 2 s z takes the place of x^2 - 2 s z."""
    found = along(lorenz(sign=-1, s=1, w=0), -5, 5, 2)
    told = {one.value: [str(f.polynomial) for f in one.polynomials] for one in found.values}
    assert told[Fraction(2)] == ["x^2 + 2*z"]
    assert "y^2 + z^2" not in told.get(Fraction(1), [])


@pytest.mark.parametrize("value", [Fraction(1, 2), 3, Fraction(7, 2), 5])
def test_at_values_that_are_not_listed_the_search_at_numbers_finds_none(value):
    field = lorenz(s=1, w=0, b=value)
    assert InAnyField(polynomial_integrals(field, grading(field, KINDS), 4), KINDS, ()).darboux().polynomials == ()


def test_rabinovichs_values_are_found():
    """n1 = n2 = 1, h = 3: n3 = 2 and x^2 + y^2 - 12 z; n3 = 1 and x^2 - y^2 - 2 z^2."""
    found = along(rabinovich(h=3, n1=1, n2=1), Fraction(1, 2), 4, 2)
    told = {one.value: [str(f.polynomial) for f in one.polynomials] for one in found.values}
    assert told == {Fraction(1): ["x^2 - y^2 - 2*z^2"], Fraction(2): ["x^2 + y^2 - 12*z"]}
    assert found.complete


def test_roots_that_become_rational_at_infinitely_many_values_are_told():
    """x' = y, y' = t x: y - sqrt(t) x wherever t is a square, which no list of values holds."""
    context = fmpq_mpoly_ctx.get(["t", "x", "y"], Ordering.lex)
    t, x, y = context.gens()
    field = PolynomialField(context, ("t",), ("x", "y"), (y, t * x), context.constant(1))
    usual = polynomial_integrals(field, grading(field, (("x", "y"),)), 1)
    found = darboux_along(usual, Fraction(1, 2), Fraction(5))
    assert [str(p) for p in found.square] == ["4*t"]
    assert not found.complete


def test_the_value_of_hess_and_appelrot_is_found(request):
    """x0^2 A (B - C) = z0^2 C (A - B): 6 (B - 3) = 3 (6 - B) with x0 = z0, B = 4, where K is rational of a sudden."""
    system = mbsym.load(request.config.rootpath / "systems/euler-poisson.yaml")
    numbers = {"A": 6, "C": 3, "x0": 1, "y0": 0, "z0": 1, "m": 1, "g": 1}
    there = polynomial.setting(system, {name: Fraction(x) for name, x in numbers.items()})
    found = InAnyField(polynomial.integrals_of(there, 1), there.kinds, there.known).darboux_along(
        Fraction(1), Fraction(5)
    )
    assert [(one.value, [str(f.polynomial) for f in one.polynomials]) for one in found.values] == [
        (Fraction(4), ["2*p + r"])
    ]
    assert found.complete
