"""Fields that are not quasi-homogeneous: the classical gyrostats, each by its formula, and told from neighbours."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from flint import Ordering, fmpq_mpoly_ctx

import mbsym
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.analysis import Analysis
from mbsym.analysis.polynomial import integrals_of, setting
from mbsym.problems.polynomial_integrals.gradings import grading
from mbsym.problems.polynomial_integrals.homogenised import InAnyField, _spanned, homogenised
from mbsym.problems.polynomial_integrals.modular import PRIMES, at_random
from mbsym.problems.polynomial_integrals.search import polynomial_integrals

GYROSTAT = Path(__file__).parents[3] / "systems" / "heavy-gyrostat.yaml"


def special(values, degree, budget=60.0):
    system = mbsym.load(GYROSTAT).system
    there = setting(Analysis(system), values)
    found = integrals_of(there, degree)
    positive = [one.name for one in system.parameters if one.sign == "positive"]
    return there, InAnyField(found, there.kinds, there.known).cases(positive, budget)


def by_condition(found):
    return {frozenset(map(str, one.conditions)): one.special for one in found.cases}


def test_yehias_and_sretenskys_cases():
    """C = 1 and mg = 1, the mass centre on the first axis: A = B = 2 and A = B = 4 are found."""
    _, found = special({"C": 1, "m": 1, "g": 1, "z0": 0}, 4)
    (case,) = [one for one in found.cases if [w for w, _ in one.special.integrals] == [4]]
    assert len(case.conditions) == 2
    assert case.special.complete
    field = case.special.field
    names = {name: field.generator(name) for name in (*field.parameters, *field.variables)}
    h, c, p, q, r = (names[name] for name in ("h", "x0", "p", "q", "r"))
    g1, g2, g3 = (names[f"gamma{k}"] for k in (1, 2, 3))
    # H. M. Yehia, Mech. Res. Commun. 13 (1986): with C = 1 and the rotor's moment h along the third axis.
    book = (p**2 - q**2 - c * g1) ** 2 + (2 * p * q - c * g2) ** 2
    book += 2 * h * (r - h) * (p**2 + q**2) - 4 * h * c * p * g3
    assert field.derivative(book) == 0
    ((_, new),) = case.special.integrals
    assert field.derivative(new) == 0
    # L. N. Sretensky, Dokl. Akad. Nauk SSSR 149 (1963): on the level zero of the area integral.
    (level,) = [one for case in found.cases for one in case.special.levels if len(case.conditions) == 2]
    ((weight, third),) = level.integrals
    assert (weight, level.level.name) == (3, "angular momentum about axis 3")
    (field,) = [case.special.field for case in found.cases if level in case.special.levels]
    area = level.level.polynomial
    names = [field.context.names().index(n) if n in field.context.names() else None for n in area.context().names()]
    images = [field.context.constant(4) if k is None else field.context.gen(k) for k in names]
    assert divmod(field.derivative(third), area.compose(*images, ctx=field.context))[1] == 0
    assert all(one.name in {"generalised energy", "angular momentum about axis 3"} for one in found.usual.generators)


def test_zhukovsky_and_lagrange():
    """(A p)^2 + (B q)^2 + (C r + h)^2 without weight; r where A = B and the mass centre is on the third axis."""
    _, found = special({"x0": 0, "m": 1, "g": 1}, 2)
    told = by_condition(found)
    ((weight, f),) = told[frozenset({"z0"})].integrals
    field = told[frozenset({"z0"})].field
    A, B, C, h, p, q, r = (field.generator(name) for name in ("A", "B", "C", "h", "p", "q", "r"))
    book = (A * p) ** 2 + (B * q) ** 2 + (C * r + h) ** 2 - h**2
    energy = A * p**2 + B * q**2 + C * r**2
    assert weight == 2
    assert f in (book - A * energy, A * energy - book)
    lagrange = [one for key, one in told.items() if len(key) == 1 and "z0" not in key]
    assert [[(w, str(f)) for w, f in one.integrals] for one in lagrange] == [[(1, "r")]]


def test_a_budget_leaves_families_out_and_says_so():
    _, found = special({"x0": 0, "m": 1, "g": 1}, 2, budget=-1.0)
    assert (found.cases, found.families) == ((), 0)
    assert found.left > 0


def test_the_larger_field_is_quasi_homogeneous_and_the_same_at_one():
    there = setting(Analysis(mbsym.load(GYROSTAT).system))
    larger, found = homogenised(there.field, there.kinds)
    assert found.homogeneous
    assert found.weights == (1, 1, 1, 2, 2, 2, 1)
    back = [p.compose(*there.field.context.gens(), there.field.context.constant(1), ctx=there.field.context)
            for p in larger.numerators]  # fmt: skip
    assert tuple(back[:-1]) == there.field.numerators
    assert back[-1] == 0


def test_two_angles_are_refused():
    context = fmpq_mpoly_ctx.get(["k", "u", "s", "c", "x", "y"], Ordering.lex)
    k, u, s, c, x, y = context.gens()
    relations = (s**2 + c**2 - 1, x**2 + y**2 - 1)
    tops = (k * s * x + u, c * u, -s * u, y * u, -x * u)
    field = PolynomialField(context, ("k",), ("u", "s", "c", "x", "y"), tops, context.constant(1), relations)
    kinds = (("u",), ("s", "c"), ("x", "y"))
    usual = polynomial_integrals(field, grading(field, kinds), 1)
    with pytest.raises(NoClosedForm, match="one unit vector or angle"):
        InAnyField(usual, kinds, ()).cases((), 60.0)
    # A wrong sign in Poisson's equations: the length is no integral, and its relation cannot be left out.
    wrong = replace(field, numerators=(tops[0], tops[1], s * u, tops[3], tops[4]), relations=relations[:1])
    with pytest.raises(NoClosedForm, match="one unit vector or angle"):
        InAnyField(polynomial_integrals(wrong, grading(wrong, kinds), 1), kinds, ()).cases((), 60.0)


def line(values, name, low, high, degree, file=GYROSTAT):
    there = setting(Analysis(mbsym.load(file).system), values)
    found = integrals_of(there, degree)
    return there, InAnyField(found, there.kinds, there.known).along(Fraction(low), Fraction(high))


def names_of(field):
    return {name: field.generator(name) for name in (*field.parameters, *field.variables)}


def test_yehias_value_on_a_line():
    """B = 2, C = 1, the mass centre on the first axis, a rotor along the third: A = 2, and no other value."""
    _, found = line({"B": 2, "C": 1, "x0": 1, "z0": 0, "m": 1, "g": 1, "h": 3}, "A", "1/2", 5, 4)
    assert [one.value for one in found.values] == [2]
    assert (found.whole, found.usual, found.undecided, found.irrational) == (True, True, (), ())
    assert found.weights == (1, 1, 1, 2, 2, 2)
    field = found.values[0].field
    p, q, r, g1, g2, g3 = (names_of(field)[name] for name in field.variables)
    book = (p**2 - q**2 - g1) ** 2 + (2 * p * q - g2) ** 2 + 6 * (r - 3) * (p**2 + q**2) - 12 * p * g3
    ((weight, new),) = found.values[0].integrals
    assert (weight, field.derivative(book), field.derivative(new)) == (4, 0, 0)


def test_sretenskys_value_on_a_line():
    """B = 4, C = 1: A = 4, where the area integral is zero; no integral for all its values."""
    _, found = line({"B": 4, "C": 1, "x0": 1, "z0": 0, "m": 1, "g": 1, "h": 1}, "A", 2, 5, 3)
    (one,) = found.values
    (level,) = one.levels
    assert (one.value, one.integrals, level.level.name) == (4, (), "angular momentum about axis 3")
    assert [weight for weight, _ in level.integrals] == [3]


def test_zhukovskys_value_on_a_line():
    """The mass centre at the fixed point: the length of the angular momentum, with the rotor's (Zhukovsky 1885)."""
    numbers = {"A": 1, "B": 2, "C": Fraction(5, 2), "z0": 0, "m": 1, "g": 1, "h": 1}
    _, found = line(numbers, "x0", -1, 1, 2)
    (one,) = found.values
    field = one.field
    p, q, r, *_ = (names_of(field)[name] for name in field.variables)
    ((_, new),) = one.integrals
    length = p**2 + 4 * q**2 + (5 * r / 2 + 1) ** 2
    energy = p**2 + 2 * q**2 + 5 * r**2 / 2
    assert (one.value, divmod(length - energy - 1, new)[1]) == (0, 0)


def test_damping_takes_the_only_integral():
    """A pendulum keeps its energy without damping only, at whatever other value; several angles are refused."""
    numbers = {"m": 1, "l": 1, "J": 1, "g": 1}
    _, found = line(numbers, "b", -1, 1, 2, GYROSTAT.with_name("simple-pendulum.yaml"))
    assert [(one.value, len(one.integrals)) for one in found.values] == [(0, 1)]
    assert found.whole
    numbers = dict.fromkeys(("m1", "m2", "l1", "l2"), 1)
    with pytest.raises(NoClosedForm, match="one unit vector or angle at most"):
        line(numbers, "g", -1, 1, 2, GYROSTAT.with_name("double-pendulum.yaml"))


def test_sretenskys_integral_holds_on_the_level_of_the_area_integral():
    """A = B = 4, C = 1; a neighbour has none, which is proved, and several angles are not looked at."""
    for first, weights in ((4, [3]), (3, [])):
        values = {"A": first, "B": first, "C": 1, "z0": 0}
        there = setting(Analysis(mbsym.load(GYROSTAT).system), values)
        found = InAnyField(integrals_of(there, 3), there.kinds, there.known).zero_levels()
        assert [one.level.name for one in found.levels] == ["generalised energy", "angular momentum about axis 3"]
        assert all(one.complete for one in found.levels)
        assert [w for one in found.levels for w, _ in one.integrals] == weights
    there = setting(Analysis(mbsym.load(GYROSTAT).system), {"A": 4, "B": 4, "C": 1, "z0": 0})
    _, area = InAnyField(integrals_of(there, 3), there.kinds, there.known).zero_levels().levels
    ((_, third),) = area.integrals
    assert divmod(there.field.derivative(third), area.level.polynomial)[1] == 0
    several = setting(Analysis(mbsym.load(GYROSTAT.with_name("double-pendulum.yaml")).system))
    assert InAnyField(integrals_of(several, 1), several.kinds, several.known).zero_levels() is None


def test_a_multiple_on_the_level_is_no_integral_of_its_own():
    """x' = 0, y' = x: y is one where x = 0; x y + y and y^2 + 3 x are none besides."""
    context = fmpq_mpoly_ctx.get(["x", "y"], Ordering.lex)
    x, y = context.gens()
    there = at_random(PolynomialField(context, (), ("x", "y"), (0 * x, x), context.constant(1)), PRIMES[0], "test")
    terms = there.terms
    assert _spanned(there, terms(x * y + y), terms(x), [(1, terms(y))], 2)
    assert _spanned(there, terms(y**2 + 3 * x), terms(x), [(1, terms(y))], 2)
    assert not _spanned(there, terms(y), terms(x), [(2, terms(y**2))], 2)
    assert _spanned(there, terms(y**2 + y), None, [(1, terms(y))], 2)
    assert not _spanned(there, terms(y + x), None, [(1, terms(y))], 2)


def test_what_follows_on_a_level_is_not_told_again():
    """A spring pendulum without weight keeps r^2 theta_dot; on a level of the energy its square has other forms."""
    numbers = {"m": 1, "k": 1, "l0": 1}
    there, found = line(numbers, "g", -1, 1, 4, GYROSTAT.with_name("spring-pendulum.yaml"))
    (one,) = found.values
    assert (one.value, one.levels, found.whole) == (0, (), True)
    assert [str(there.formula(f)) for _, f in one.integrals] == ["theta_dot*r**2"]
    levels = InAnyField(integrals_of(there, 4), there.kinds, there.known).zero_levels()
    assert [level.level.name for level in levels.levels] == ["generalised energy, less a constant"]
