"""For which parameters there is one integral more: the classical cases, found and told from their neighbours."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from flint import Ordering, fmpq_mpoly_ctx, fmpq_poly

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.problems.polynomial_integrals.excess import Block, Excess, interpolated, rational
from mbsym.problems.polynomial_integrals.families import cases
from mbsym.problems.polynomial_integrals.gradings import grading
from mbsym.problems.polynomial_integrals.levels import levels, on_level
from mbsym.problems.polynomial_integrals.modular import PRIMES, ModularField
from mbsym.problems.polynomial_integrals.search import polynomial_integrals
from mbsym.problems.polynomial_integrals.values import along

SPEEDS, VECTOR = ("p", "q", "r"), ("g1", "g2", "g3")


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def heavy(free, numbers):
    """I w' = I w x w + c x g, g' = g x w, times A B C; ``free`` parameters are symbols."""
    context = fmpq_mpoly_ctx.get([*free, *SPEEDS, *VECTOR], Ordering.lex)
    at = dict(zip((*free, *SPEEDS, *VECTOR), context.gens(), strict=True))
    at |= {name: context.constant(value) for name, value in numbers.items()}
    inertia, c = [at[k] for k in "ABC"], [at[k] for k in ("x0", "y0", "z0")]
    w, g = [at[k] for k in SPEEDS], [at[k] for k in VECTOR]
    spin = [i * x for i, x in zip(inertia, w, strict=True)]
    moment = [a + b for a, b in zip(cross(spin, w), cross(c, g), strict=True)]
    whole = inertia[0] * inertia[1] * inertia[2]
    tops = [m * whole / i for m, i in zip(moment, inertia, strict=True)] + [x * whole for x in cross(g, w)]
    norm = g[0] ** 2 + g[1] ** 2 + g[2] ** 2 - 1
    return PolynomialField(context, tuple(free), (*SPEEDS, *VECTOR), tuple(tops), whole, (norm,)), at


def usual(field, degree=4):
    return polynomial_integrals(field, grading(field, (SPEEDS, VECTOR)), degree)


@pytest.mark.parametrize(
    ("numbers", "expected"),
    [
        # Kovalevskaya: A = 2 C with B = 2, the mass centre on the first axis.
        ({"B": 2, "C": 1, "x0": 1, "y0": 0, "z0": 0}, {Fraction(2): ([4], [])}),
        # Goryachev and Chaplygin: A = 4 C with B = 4, on the level of the area integral, weight 3.
        ({"B": 4, "C": 1, "x0": 1, "y0": 0, "z0": 0}, {Fraction(4): ([], [3])}),
        # Lagrange: A = B, the mass centre on the third axis.
        ({"B": 3, "C": 1, "x0": 0, "y0": 0, "z0": 1}, {Fraction(3): ([1], [])}),
        # None of them.
        ({"B": 3, "C": 1, "x0": 1, "y0": 2, "z0": 0}, {}),
    ],
)
def test_values_of_one_moment_of_inertia(numbers, expected):
    field, _ = heavy(("A",), numbers)
    found = along(usual(field), Fraction(1, 2), Fraction(5))
    told = {
        one.value: ([w for w, _ in one.integrals], [w for level in one.levels for w, _ in level.integrals])
        for one in found.values
    }
    assert told == expected
    assert found.whole
    for one in found.values:
        assert all(one.field.derivative(f) == 0 for _, f in one.integrals)
    outside = along(usual(field), Fraction(5), Fraction(6))
    assert outside.values == ()


def test_goryachev_and_chaplygins_integral_is_the_books():
    field, at = heavy(("x0",), {"A": 4, "B": 4, "C": 1, "y0": 0, "z0": 0})
    found = usual(field)
    area = next(one for one in levels(found) if one.weight == 3)
    ((weight, f),) = on_level(found, area).integrals
    p, q, r = (at[k] for k in SPEEDS)
    book = r * (p**2 + q**2) + at["x0"] * p * at["g3"]
    assert (weight, f) == (3, book)
    assert 4 * field.derivative(book) == at["x0"] * q * field.denominator * area.polynomial
    # On the level of the energy there is none, nor at A = B = 3 C.
    energy = next(one for one in levels(found) if one.weight == 2)
    assert on_level(found, energy).integrals == ()
    assert on_level(found, energy).complete
    other = usual(heavy(("x0",), {"A": 3, "B": 3, "C": 1, "y0": 0, "z0": 0})[0])
    assert all(on_level(other, one).integrals == () and on_level(other, one).complete for one in levels(other))


def test_a_wrong_sign_ends_kovalevskayas_case():
    field, _ = heavy(("A",), {"B": 2, "C": 1, "x0": 1, "y0": 0, "z0": 0})
    wrong = replace(field, numerators=(field.numerators[0], -field.numerators[1], *field.numerators[2:]))
    assert not any(one.value == 2 for one in along(usual(wrong), Fraction(1), Fraction(5)).values)


def test_clebschs_condition_of_kirchhoffs_equations():
    """A. Clebsch, Math. Ann. 3 (1871): (c2 - c3)/a1 + (c3 - c1)/a2 + (c1 - c2)/a3 = 0."""
    names = ("a1", "a2", "a3", "c1", "c2", "c3")
    context = fmpq_mpoly_ctx.get([*names, "M1", "M2", "M3", *VECTOR], Ordering.lex)
    gens = context.gens()
    a, c, m, g = gens[:3], gens[3:6], gens[6:9], gens[9:]
    w = [x * y for x, y in zip(a, m, strict=True)]
    u = [x * y for x, y in zip(c, g, strict=True)]
    tops = [*(x + y for x, y in zip(cross(m, w), cross(g, u), strict=True)), *cross(g, w)]
    field = PolynomialField(context, names, ("M1", "M2", "M3", *VECTOR), tuple(tops), context.constant(1))
    found = cases(polynomial_integrals(field, grading(field, (("M1", "M2", "M3"), VECTOR)), 2), names[:3])
    clebsch = (c[1] - c[2]) * a[1] * a[2] + (c[2] - c[0]) * a[2] * a[0] + (c[0] - c[1]) * a[0] * a[1]
    first = found.cases[0]
    assert [f in (clebsch, -clebsch) for f in first.conditions] == [True]
    assert [weight for weight, _ in first.special.integrals] == [2]
    # Two moments and two masses alike: the third component is kept.
    symmetric = [one for one in found.cases if len(one.conditions) == 2]
    assert [[w for w, _ in one.special.integrals] for one in symmetric] == [[1], [1], [1]]


def test_cases_of_a_body_with_its_mass_centre_on_the_third_axis():
    field, at = heavy(("A", "B", "C", "z0"), {"x0": 0, "y0": 0})
    found = cases(usual(field, 2), ("A", "B", "C"))
    told = {frozenset(map(str, one.conditions)): [w for w, _ in one.special.integrals] for one in found.cases}
    assert told[frozenset({"z0"})] == [2]  # Euler
    lagrange = [w for conditions, w in told.items() if len(conditions) == 1 and "z0" not in conditions]
    assert lagrange == [[1]]
    assert found.unread == 0
    gyrostat = replace(field, numerators=(field.numerators[0] + at["q"], *field.numerators[1:]))
    with pytest.raises(NoClosedForm, match="quasi-homogeneous"):
        cases(usual(gyrostat, 2), ("A", "B", "C"))


def test_irrational_values_are_undecided_and_told():
    """x' = (t^2 - 2) y, y' = 0: y always, x where t^2 = 2."""
    context = fmpq_mpoly_ctx.get(["t", "x", "y"], Ordering.lex)
    t, _, y = context.gens()
    field = PolynomialField(context, ("t",), ("x", "y"), ((t**2 - 2) * y, 0 * y), context.constant(1))
    found = polynomial_integrals(field, grading(field, (("x",), ("y",))), 2)
    line = along(found, Fraction(0), Fraction(2))
    assert (line.values, line.whole) == ((), False)
    # Modulo a prime the zeros may be numbers, which are no small fractions: then no polynomial is told.
    assert line.irrational in ((), (fmpq_poly([-2, 0, 1]),))
    assert along(found, Fraction(2), Fraction(3)).values == ()


def test_interpolation_and_fractions_modulo_a_prime():
    prime = PRIMES[0]
    p = interpolated([(7 + t) ** 3 - 5 for t in range(1, 6)], 7, prime)
    assert [int(p[k]) for k in range(p.degree() + 1)] == [prime - 5, 0, 0, 1]
    assert rational(22 * pow(7, -1, prime) % prime, prime) == Fraction(22, 7)
    assert rational(-3 % prime, prime) == -3


def test_kernels_over_the_rationals_are_those_modulo_the_prime():
    """Two routes; at A = 4 of B = 4 C Chaplygin's is one more on the level of the area integral, elsewhere none is."""
    field, _ = heavy(("A",), {"B": 4, "C": 1, "x0": 1, "y0": 0, "z0": 0})
    excess = Excess(usual(field))
    level = next(k for k, one in enumerate(excess.usual.generators) if one.weight == 3)
    for value in (Fraction(4), Fraction(7, 3)):
        image = value.numerator * pow(value.denominator, -1, PRIMES[0]) % PRIMES[0]
        there = ModularField(field, PRIMES[0], {"A": image})
        for block in excess.blocks:
            exact = excess.exactly(value, block)
            assert exact == excess.dimension(there, block)
            larger = (value, block) == (Fraction(4), Block(3, level))
            assert exact - excess.dimensions[block] == larger


def test_a_value_at_which_known_integrals_coincide_is_found():
    """x' = y' = 0 of weight 1, z' = x: f = x and x + t y are two but at t = 0, where y is one more: no kernel grows."""
    context = fmpq_mpoly_ctx.get(["t", "x", "y", "z"], Ordering.lex)
    t, x, y, _ = context.gens()
    zero = context.constant(0)
    field = PolynomialField(context, ("t",), ("x", "y", "z"), (zero, zero, x), context.constant(1))
    weights = grading(field, (("x", "y", "z"),))
    found = polynomial_integrals(field, weights, 1, [("first", x), ("second", x + t * y)])
    assert [one.name for one in found.generators] == ["first", "second"]
    line = along(found, Fraction(-1), Fraction(1))
    assert [(one.value, [w for w, _ in one.integrals]) for one in line.values] == [(Fraction(0), [1])]


def test_without_a_complete_list_nothing_is_proved_of_other_values():
    field, _ = heavy(("A",), {"B": 2, "C": 1, "x0": 1, "y0": 0, "z0": 0})
    found = usual(field)
    lacking = replace(found, generators=found.generators[1:])
    line = along(lacking, Fraction(3), Fraction(4))
    assert (line.usual, line.whole) == (False, False)


def test_long_products_of_zeros_leave_irrational_values_open():
    """x' = (t - 10^5)(t - 10^5 - 1) y: heights of zeros multiply to beyond 10^9, unless jumps are seen."""
    context = fmpq_mpoly_ctx.get(["t", "x", "y"], Ordering.lex)
    t, _, y = context.gens()
    high = 10**5
    tops = ((t - high) * (t - high - 1) * y, 0 * y)
    field = PolynomialField(context, ("t",), ("x", "y"), tops, context.constant(1))
    found = polynomial_integrals(field, grading(field, (("x",), ("y",))), 1)
    line = along(found, Fraction(0), Fraction(2 * high))
    assert [one.value for one in line.values] == [high, high + 1]
    assert line.whole  # each kernel over QQ is larger by one: both factors are accounted for
    blind = pytest.MonkeyPatch()
    with blind.context() as patch:
        patch.setattr(Excess, "exactly", lambda self, value, block: None)
        assert not along(found, Fraction(0), Fraction(2 * high)).whole
