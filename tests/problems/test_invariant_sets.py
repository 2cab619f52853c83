"""Steady motions and invariant manifolds against the literature and derivations by hand."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import permutations, product

import numpy as np
import pytest
import sympy
from conftest import SHIPPED, derived, filed

import mbsym
from mbsym.problems.invariant_sets import problem
from mbsym.problems.invariant_sets.branches import arena
from mbsym.problems.invariant_sets.problem import invariant_sets
from mbsym.problems.invariant_sets.result import Definiteness, Gap, Kind
from mbsym.problems.vector_field import vector_field
from mbsym.report.language import Language

HEAVY = """
mbsym: 1
name: Heavy body about a fixed point
parameters: {{g: {{sign: positive}}, m: {{sign: positive}}, {parameters}}}
bodies:
  - name: body
    rotation: {{axes: [3, 1, 3], angles: [psi, theta, phi]}}
    mass centre: {centre}
    mass: m
    inertia about: joint
    inertia: {inertia}
    speeds: {{p: omega1, q: omega2, r: omega3}}
    orientation: {{gamma: 3}}
loads:
  - uniform gravity: {{acceleration: g, direction: [0, 0, -1]}}
"""


def _heavy(tmp_path, parameters, centre, inertia):
    signs = ", ".join(f"{name}: {{sign: {'real' if name.endswith('0') else 'positive'}}}" for name in parameters)
    path = filed(tmp_path / "heavy.yaml", HEAVY.format(parameters=signs, centre=centre, inertia=inertia))
    return mbsym.load(path)


def _value(formula, **numbers):
    return Fraction(str(formula.subs(numbers)))


@pytest.fixture(scope="module")
def clebsch():
    return derived(SHIPPED / "clebsch-poisson.yaml").invariant_sets


def test_the_manifolds_of_clebsch_tisserand_brun(clebsch):
    """w_i = u_i gamma_i with u2 u3 = N + sigma A and its like (tests/references/orbit-gyrostat-and-clebsch, 3.2)."""
    (family, *_) = clebsch.families
    found = [one for one in family.sets if one.kind is Kind.MANIFOLD and len(one.free) == 3 and "p" not in one.free]
    one = next(one for one in found if one.free == ("gamma1", "gamma2", "gamma3"))
    assert one.invariant is True
    assert one.real
    assert one.dimension == 2
    # With lambda1^2 = N (1 + 2 A s)(1 + 2 B s)(1 + 2 C s), s = lambda2, sigma = 2 N s: numbers that make it a square.
    numbers = {"A": 4, "B": Fraction(3, 2), "C": 1, "N": 300, "M": 1, "R": 1}
    numbers |= {"lambda1": 180, "lambda2": 1, "lambda3": 0}
    assert numbers["lambda1"] ** 2 == numbers["N"] * 9 * 4 * 3
    u = [_value(value, **numbers, gamma1=1, gamma2=1, gamma3=1) for name, value in one.solved]
    sigma = 2 * numbers["N"]
    assert u[1] * u[2] == 300 + sigma * 4
    assert u[2] * u[0] == 300 + sigma * Fraction(3, 2)
    assert u[0] * u[1] == 300 + sigma
    assert _value(one.relations[0], **numbers) == 0


def test_permanent_rotations_of_clebsch_tisserand_brun(clebsch):
    """A B S^4 + (N (A^2 + B^2 - A C - B C) + W^2 (2 A B - A C - B C + C^2)) S^2 + (A - C)(B - C)(N - W^2)^2."""
    one = next(x for x in clebsch.families[0].sets if "r" in x.free and x.kind is Kind.STEADY)
    ((free, middle, leading),) = one.first.factors
    for A, B, C, N, W in ((4, 5, 6, 2, 3), (5, 7, 3, 1, 4)):
        numbers = {"A": A, "B": B, "C": C, "N": N, "r": W}
        scale = _value(leading, **numbers) / (A * B)
        by_hand = N * (A**2 + B**2 - A * C - B * C) + W**2 * (2 * A * B - A * C - B * C + C**2)
        assert _value(middle, **numbers) == scale * by_hand
        assert _value(free, **numbers) == scale * (A - C) * (B - C) * (N - W**2) ** 2
    assert one.first.zeros == 2
    assert one.first.complete
    assert not one.first.unstable
    assert one.variation.outcome is Definiteness.CONDITIONAL
    assert len(one.variation.chosen) == 1


def test_the_euler_top_about_its_axes(tmp_path):
    """Stable about the axes of the largest and the smallest moment, unstable about the middle one: both, exactly."""
    found = _heavy(tmp_path, "ABC", [0, 0, 0], "[A, B, C]").invariant_sets
    one = next(x for x in found.families[0].sets if x.free == ("r",))
    assert {"p", "q"} == {name for name, _ in one.solved}
    told = {x.relation: x.formula for x in one.variation.positive}
    for A, B, C in ((2, 3, 4), (3, 4, 2), (2, 4, 3), (4, 2, 3)):
        sides = [one.variation.positive, one.variation.negative]
        stable = any(_all_hold(side, A=A, B=B, C=C, r=1) for side in sides if side is not None)
        assert stable == (C not in (sorted((A, B, C))[1],))
        assert _all_hold(one.first.necessary, A=A, B=B, C=C, r=1) == stable
    assert one.gap is Gap.NONE_FOUND
    assert told


def test_the_middle_axis_of_a_given_body(tmp_path):
    """I = (2, 4, 3): about the third axis roots are r/sqrt(8) and -r/sqrt(8), and no combination is definite."""
    found = _heavy(tmp_path, [], [0, 0, 0], "[2, 4, 3]").invariant_sets
    one = next(x for x in found.families[0].sets if x.free == ("r",))
    assert one.variation.outcome is Definiteness.NEVER
    assert not _all_hold(one.first.necessary, r=1)
    assert _all_hold(one.first.necessary, r=0)  # at rest nothing is said against it
    assert one.first.complete
    largest = next(x for x in found.families[0].sets if x.free == ("q",))
    assert _all_hold(largest.first.necessary, q=1)
    assert largest.variation.outcome is Definiteness.CONDITIONAL


def _all_hold(relations, **numbers):
    for one in relations:
        x = _value(one.formula, **numbers)
        if not {">": x > 0, ">=": x >= 0, "!=": x != 0, "=": x == 0}[one.relation]:
            return False
    return True


def test_the_sleeping_top(tmp_path):
    """C^2 r^2 > 4 A m g z0 is necessary and sufficient (Lagrange, Routh)."""
    found = _heavy(tmp_path, ["A", "C", "z0"], "[0, 0, z0]", "[A, A, C]").invariant_sets
    sets = found.families[0].sets
    one = next(x for x in sets if x.free == ("r", "gamma3") and x.variation.chosen)
    numbers = {"A": 2, "C": 1, "g": 10, "m": 1, "z0": Fraction(1, 4), "gamma3": 1}  # the border is r^2 = 20
    for r, stable in ((5, True), (Fraction(9, 2), True), (Fraction(22, 5), False), (1, False)):
        tried = [Fraction(k, 8) for k in range(-40, 41)] + [-Fraction(r) / 4]  # -C r/(2 A)
        sides = [side for side in (one.variation.positive, one.variation.negative) if side is not None]
        holds = any(_all_hold(side, **numbers, r=r, lambda1=x) for side in sides for x in tried)
        assert holds == stable
        assert _all_hold(one.first.necessary, **numbers, r=r) == stable
    # The hanging top is stable at any rate.
    assert _all_hold(one.first.necessary, **numbers | {"gamma3": -1}, r=1)


def test_the_cone_of_staude(tmp_path):
    """Axes of permanent rotation of a heavy body: c . (gamma x I gamma) = 0, w = -lambda1 gamma."""
    found = _heavy(tmp_path, ["A", "B", "C", "x0", "y0", "z0"], "[x0, y0, z0]", "[A, B, C]").invariant_sets
    (one,) = found.families[0].sets
    assert one.kind is Kind.STEADY
    assert one.union == 1
    assert one.invariant is True
    numbers = {
        "A": 3,
        "B": 5,
        "C": 7,
        "x0": 2,
        "y0": 3,
        "z0": 1,
        "g": 1,
        "m": 1,
        "lambda1": 2,
        "gamma3": Fraction(1, 3),
    }
    values = {name: _value(x, **numbers) for name, x in one.solved}
    gamma = [values["gamma1"], values["gamma2"], numbers["gamma3"]]
    spin = [values["p"], values["q"], values["r"]]
    assert spin == [-2 * x for x in gamma]
    c, moments = (2, 3, 1), (3, 5, 7)
    turned = [i * x for i, x in zip(moments, gamma, strict=True)]
    cross = [gamma[1] * turned[2] - gamma[2] * turned[1], gamma[2] * turned[0] - gamma[0] * turned[2]]
    cross.append(gamma[0] * turned[1] - gamma[1] * turned[0])
    assert sum(a * b for a, b in zip(c, cross, strict=True)) == 0
    # Euler's equation: the weight's moment c x gamma m g balances w x I w = lambda1^2 gamma x I gamma.
    moment = [c[1] * gamma[2] - c[2] * gamma[1], c[2] * gamma[0] - c[0] * gamma[2], c[0] * gamma[1] - c[1] * gamma[0]]
    assert [4 * x for x in cross] == [-x for x in moment]
    assert found.generic  # where x0, y0 or z0 vanishes there are others, and that is said


def test_orbital_equilibria_in_quaternions():
    """Lagrange's region: the least moment radial, the largest along the orbit's normal; a branch left aside is told.

    In the region of DeBra and Delp the first approximation is stable by gyroscopic forces: with moments A radial, B
    along the orbit, C along its normal and k1 = (C - A)/B, k3 = (C - B)/A, where k1 > k3, k1 k3 > 0 and
    1 + 3 k1 + k1 k3 > 4 sqrt(k1 k3). At 14, 20, 13: k1 = -1/20, k3 = -1/2, and 0.875 > 0.632.
    """
    found = derived(SHIPPED / "gravity-gradient-quaternion.yaml").invariant_sets
    (family,) = found.families
    assert not found.complete
    assert family.unfinished
    assert all(one.kind is Kind.STEADY and one.invariant is True for one in family.sets)
    numbers = {"omega0": 1, "R": 1, "m": 1}  # nu = omega0^2 R^3 is a relation of the description
    for A, B, C in ((5, 4, 6), (4, 5, 6), (5, 6, 4), (6, 4, 5)):
        for one in family.sets:
            spin = {name: x for name, x in one.solved if name in "pqr" and str(x) != "0"}
            (normal,) = spin  # the axis along the orbit's normal
            sides = [side for side in (one.variation.positive, one.variation.negative) if side is not None]
            if any(_all_hold(side, **numbers, A=A, B=B, C=C) for side in sides):
                assert {"p": A, "q": B, "r": C}[normal] == 6
                assert _all_hold(one.first.necessary, **numbers, A=A, B=B, C=C)
    for one in family.sets:
        (normal,) = [name for name, x in one.solved if name in "pqr" and str(x) != "0"]
        stabilised = 0
        for A, B, C in permutations((14, 20, 13)):
            if {"p": A, "q": B, "r": C}[normal] == 13:
                sides = [side for side in (one.variation.positive, one.variation.negative) if side is not None]
                assert not any(_all_hold(side, **numbers, A=A, B=B, C=C) for side in sides)
                stabilised += _all_hold(one.first.necessary, **numbers, A=A, B=B, C=C)
        assert stabilised == 1  # one of the other two axes is radial
        assert one.gap is Gap.FOUND


@pytest.fixture(scope="module")
def kovalevskaya():
    return derived(SHIPPED / "kovalevskaya.yaml").invariant_sets


def test_pieces_of_the_sets_of_kovalevskayas_top_are_no_defect(kovalevskaya):
    """Zeros of Kovalevskaya's integral, a sum of two squares, are stationary: r = gamma3 = 0 is no set of its own."""
    assert all(one.invariant is not False for family in kovalevskaya.families for one in family.sets)
    assert kovalevskaya.families[0].parts
    assert not kovalevskaya.complete
    zeros = [dict(one.solved) for family in kovalevskaya.families[:2] for one in family.sets]
    assert not any(str(one.get("r")) == "0" == str(one.get("gamma3")) and "gamma2" not in one for one in zeros)


def test_delaunays_class_and_that_of_bobylev_and_steklov(kovalevskaya):
    """Of Kovalevskaya's top, P = m g x0, though most branches are left aside.

    Where her integral is zero (N. B. Delaunay 1892), which is stable as a set; q = 0, p constant, P gamma3 = C p r
    (D. K. Bobylev, V. A. Steklov 1896).
    """
    found = kovalevskaya
    at = {"C": 2, "m": 1, "g": 5, "x0": 3, "p": 7, "q": 11, "gamma3": Fraction(1, 2)}
    delaunay = [
        one
        for family in found.families
        for one in family.sets
        if one.dimension == 3 and {name for name, _ in one.solved} == {"gamma1", "gamma2"}
    ]
    (one,) = delaunay
    gamma = {name: _value(x, **at) for name, x in one.solved}
    assert gamma == {"gamma1": Fraction(2 * (7**2 - 11**2), 15), "gamma2": Fraction(2 * 2 * 7 * 11, 15)}
    assert one.invariant is True
    assert one.variation.outcome is Definiteness.STABLE
    bobylev = [one for family in found.families for one in family.sets if ("q", "0") in _texts(one) and one.union == 3]
    (other,) = bobylev
    assert _value(dict(other.solved)["r"], **at) == Fraction(15, 2 * 2 * 7)
    assert ("p", "0") in [(name, str(x)) for name, x in other.motion]


def _texts(one):
    return [(name, str(x)) for name, x in one.solved]


def test_a_wrong_sign_in_the_equations_is_seen(monkeypatch):
    """The integrals, and so the sets, are those of other equations: what is not invariant is never called so."""
    loaded = derived(SHIPPED / "clebsch-poisson.yaml")
    known = [x.formula.polynomial for x in loaded.integrals]
    field, transfer = vector_field(loaded.form, loaded.equations, known)
    known = [(x.name, transfer.fraction(x.formula.polynomial)[0]) for x in loaded.integrals]
    signs = {x.name: x.sign for x in loaded.system.parameters}
    further = field.numerators[3] + field.generator("r") * field.generator("gamma3")  # gamma1' with a term too many
    wrong = replace(field, numerators=(*field.numerators[:3], further, *field.numerators[4:]))
    right = invariant_sets(arena(field, known, signs)).families[0].sets
    assert {one.invariant for one in right} == {True}
    planted = invariant_sets(arena(wrong, known, signs)).families[0]
    assert False in {one.invariant for one in planted.sets}
    # Where it is open whether these are integrals at all, such a set may be a piece of another: nothing is said of it.
    monkeypatch.setattr(problem, "_conserved", lambda _: None)
    left_open = invariant_sets(arena(wrong, known, signs)).families[0]
    assert False not in {one.invariant for one in left_open.sets}
    assert left_open.unfinished == planted.unfinished + len(planted.sets) - len(left_open.sets) > planted.unfinished


def test_definiteness_agrees_with_eigenvalues(clebsch):
    """The second variation on the tangent space of the integrals, by hand and in floating point, at random points."""
    chance = np.random.default_rng(5)
    compared = 0
    for one in clebsch.families[0].sets:
        if one.kind is not Kind.STEADY or one.variation.outcome is not Definiteness.CONDITIONAL:
            continue
        for _ in range(40):
            numbers = {name: Fraction(int(chance.integers(2, 30)), 7) for name in ("A", "B", "C", "N", "R", "M")}
            numbers |= {name: Fraction(int(chance.integers(-20, 20)), 9) or Fraction(1, 3) for name in one.free}
            numbers |= {name: Fraction(int(chance.choice((-1, 1)))) for name in one.free if name.startswith("gamma")}
            numbers |= {name: Fraction(int(chance.integers(-20, 20)), 8) for name, x in one.multipliers if x is None}
            numbers |= {name: _value(x, **numbers) for name, x in one.multipliers if x is not None}
            numbers |= {name: _value(x, **numbers) for name, x in one.solved}
            x = np.array([float(numbers[name]) for name in ("p", "q", "r", "gamma1", "gamma2", "gamma3")])
            N, A = float(numbers["N"]), np.array([float(numbers[name]) for name in "ABC"])
            others = np.array([A[1] * A[2], A[2] * A[0], A[0] * A[1]])
            zero = np.zeros((3, 3))
            energy = np.diag([*A, *(N * A)])
            area = np.block([[zero, np.diag(A)], [np.diag(A), zero]])
            fourth = 2 * np.diag([*A**2, *(-N * others)])
            norm = 2 * np.diag([0, 0, 0, 1, 1, 1])
            by_name = {"generalised energy": energy, "fourth integral": fourth, "geometry": norm}
            forms = [by_name.get(name, area) for name in clebsch.families[0].integrals]
            weights = [1.0, *(float(numbers[name]) for name in clebsch.families[0].multipliers)]
            whole = sum(w * form for w, form in zip(weights, forms, strict=True))
            assert np.allclose(whole @ x, 0, atol=1e-9 * np.abs(whole).max())  # grad K = 0
            _, singular, rows = np.linalg.svd(np.array([form @ x for form in forms]))
            tangent = rows[np.sum(singular > 1e-9 * singular[0]) :].T
            eigenvalues = np.linalg.eigvalsh(tangent.T @ whole @ tangent)
            if np.abs(eigenvalues).min() < 1e-6 * np.abs(eigenvalues).max():
                continue
            compared += 1
            for side, sign in ((one.variation.positive, 1), (one.variation.negative, -1)):
                assert (side is not None and _all_hold(side, **numbers)) == bool((sign * eigenvalues > 0).all())
    assert compared > 60


def test_definiteness_where_values_have_denominators():
    """A steady motion of Kovalevskaya's top with r = x0 m g gamma3/(C p): projected Hessians by SymPy, at numbers."""
    found = derived(SHIPPED / "kovalevskaya.yaml").invariant_sets
    family = found.families[0]
    one = next(x for x in family.sets if x.kind is Kind.STEADY and {"p", "gamma3"} == set(x.free))
    state = sympy.symbols("p q r gamma1 gamma2 gamma3")
    formulas = {name: x.to_sympy() for name, x in found.integrals}
    symbols = sorted(set().union(*(formulas[name].free_symbols for name in family.integrals)), key=str)
    first = [[sympy.lambdify(symbols, sympy.diff(formulas[x], s)) for s in state] for x in family.integrals]
    second = [
        [[sympy.lambdify(symbols, sympy.diff(formulas[x], s, t)) for t in state] for s in state]
        for x in family.integrals
    ]
    compared = set()
    for gamma3 in (Fraction(4, 5), Fraction(-4, 5)):
        for free in [Fraction(k, 40) for k in range(-60, 61, 7)]:
            # C^2 p^4 + (x0 m g gamma3)^2 = (x0 m g)^2
            numbers = {"C": 3, "x0": 5, "m": 1, "g": 1, "p": 1, "gamma3": gamma3, "lambda1": free}
            numbers |= {name: _value(x, **numbers) for name, x in one.solved}
            numbers |= {name: _value(x, **numbers) for name, x in one.multipliers if x is not None}
            at = [Fraction(str(numbers[str(x)])) for x in symbols]
            factors = [1, *(Fraction(str(numbers[name])) for name in family.multipliers)]
            rows = [[one_of(*at) for one_of in row] for row in first]
            assert all(sum(c * row[k] for c, row in zip(factors, rows, strict=True)) == 0 for k in range(6))  # exactly
            gradients = np.array(rows, dtype=float)
            hessian = sum(
                float(c) * np.array([[f(*at) for f in row] for row in table], dtype=float)
                for c, table in zip(factors, second, strict=True)
            )
            _, singular, rows = np.linalg.svd(gradients)
            tangent = rows[np.sum(singular > 1e-9 * singular[0]) :].T
            eigenvalues = np.linalg.eigvalsh(tangent.T @ hessian @ tangent)
            if np.abs(eigenvalues).min() < 1e-6 * np.abs(eigenvalues).max():
                continue
            for side, sign in ((one.variation.positive, 1), (one.variation.negative, -1)):
                definite = bool((sign * eigenvalues > 0).all())
                assert (side is not None and _all_hold(side, **numbers)) == definite
                compared.add(definite)
    assert False in compared


def test_an_integral_without_its_denominator_is_named_a_multiple():
    """C = A B/(A + B): H and the area integral have that denominator; what is shown is A + B times them."""
    text = (SHIPPED / "clebsch-poisson.yaml").read_text(encoding="utf-8").split("values:")[0]
    found = mbsym.loads(text.replace("bodies:", "relations: {C: A*B/(A + B)}\nbodies:", 1)).invariant_sets
    names = [name for name, _ in found.integrals]
    assert names[:2] == [
        "generalised energy, but for a constant factor (its denominator is left out)",
        "angular momentum about axis 3, but for a constant factor (its denominator is left out)",
    ]
    assert str(found.integrals[1][1]) == "A*p*gamma1*(A + B) + B*(q*gamma2*(A + B) + A*r*gamma3)"
    assert Language("ru").say(names[1]).endswith("с точностью до постоянного множителя (знаменатель опущен)")


def test_a_saddle_is_not_called_degenerate():
    """Henon's and Heiles's: V_xx = A + 2 a y = 0 there, but V_xx V_yy - V_xy^2 = -4 a^2 x^2 is not zero."""
    (family,) = derived(SHIPPED / "henon-heiles.yaml").invariant_sets.families
    (saddles,) = [one for one in family.sets if dict(one.solved).keys() >= {"y"} and len(one.relations) == 1]
    assert saddles.variation.outcome is Definiteness.NEVER


SHELL = """
mbsym: 1
name: charged particle above a shell of rests
parameters: {m: positive, k: real, w: real, c: real}
bodies:
- {name: a, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: 0}
- {name: b, attached to: a, connection point: [0, y, 0], coordinates: [y], mass: 0}
- {name: p, attached to: b, connection point: [0, 0, z], coordinates: [z], mass: m}
loads:
- potential: k*(x**2 + y**2 + z**2)/2 + c*(x**2 + y**2 + z**2)**2
- generalized force: {x: m*w*y_dot, y: -m*w*x_dot}
motion: {}
"""


def test_at_a_saddle_it_is_not_a_square_that_has_to_be_negative():
    """There V_xx = 0, V_xy = 2 a x: the squares of the roots have the product -4 a^2 x^2; only x = 0 is left."""
    (family,) = derived(SHIPPED / "henon-heiles.yaml").invariant_sets.families
    (saddles,) = [one for one in family.sets if dict(one.solved).keys() >= {"y"} and len(one.relations) == 1]
    assert [(str(one.formula), one.relation) for one in saddles.first.necessary if one.relation != ">="] == [("x", "=")]
    assert not any(str(one.formula).startswith("-") for one in saddles.first.necessary if one.relation == ">=")


def test_conditions_that_a_set_fulfils_by_itself_are_not_told():
    """At rests of the double pendulum with unit weights each necessary condition is violated by one of them, at least.

    What is m2 (l1 + l2)^2 + m1 (l1 - l2)^2 where cos theta2 = 1 never is.
    """
    (family,) = derived(SHIPPED / "double-pendulum.yaml").invariant_sets.families
    (rests,) = family.sets
    assert rests.first.necessary
    for one in rests.first.necessary:
        places = [
            {"cos_theta1": c1, "cos_theta2": c2, "m1": m1, "m2": 1, "l1": 1, "l2": l2, "g": 1}
            for c1, c2, m1, l2 in product((1, -1), (1, -1), (1, 9), (1, 3))
        ]
        assert not all(_all_hold([replace(one, unless=())], sin_theta1=0, sin_theta2=0, **at) for at in places)


def test_a_sign_that_the_set_itself_excludes_is_not_offered(clebsch):
    """N (2 A l + 1)(2 B l + 1)(2 C l + 1) = lambda1^2 is not negative: the three factors are not all negative."""
    (family, *_) = clebsch.families
    (one,) = [x for x in family.sets if x.kind is Kind.MANIFOLD and x.free == ("gamma1", "gamma2", "gamma3")]
    assert one.variation.positive is not None
    assert one.variation.negative is None


def test_what_vanishes_on_a_set_alone_is_zero_there():
    """Rests fill the sphere 4 c r^2 + k = 0: two roots are zero, V'' = 8 c r r^T has two null directions."""
    (family,) = [one for one in mbsym.loads(SHELL).invariant_sets.families if len(one.integrals) > 1]
    (rests,) = [one for one in family.sets if one.kind is Kind.STEADY and one.dimension == 2]
    assert rests.variation.outcome is Definiteness.DEGENERATE
    assert rests.first.zeros == 2
    assert [len(factor) for factor in rests.first.factors] == [3]
    assert all(not one.unless for one in rests.first.necessary)
    assert rests.real


def test_inputs_keep_their_values_on_the_unperturbed_motion(tmp_path):
    """A free body under a moment u about its third axis, which is zero: Euler's permanent rotations."""
    text = HEAVY[: HEAVY.index("    orientation")]
    text = text.format(parameters="A: positive, B: positive, C: positive", centre="[0, 0, 0]", inertia="[A, B, C]")
    text += "loads: [{torque: {body: body, axes: body, components: [0, 0, u]}}]\ninputs: {u: {meaning: wheel}}\n"
    found = mbsym.load(filed(tmp_path / "driven.yaml", text), problems=()).invariant_sets
    assert found.inputs == (("u", "0"),)
    about = {
        tuple(name for name, value in one.solved if str(value) == "0")
        for family in found.families
        for one in family.sets
        if len(one.free) == 1
    }
    assert about == {("p", "q"), ("p", "r"), ("q", "r")}
