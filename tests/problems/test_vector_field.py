"""Equations of motion as polynomial vector fields: laws, and equations written by hand."""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from flint import ctx, fmpq

import mbsym
from mbsym.algebra.failures import NoClosedForm
from mbsym.analysis.invariant import invariant_sets_of
from mbsym.analysis.polynomial import integrals_of, setting
from mbsym.problems.vector_field import vector_field
from mbsym.report.plain_writer import Writer
from mbsym.report.words.integrals_words import sentences


def _field(path):
    loaded = mbsym.load(path)
    known = [x.formula.polynomial for x in loaded.integrals]
    return vector_field(loaded.form, loaded.equations, known), loaded


def test_clebsch_is_the_field_of_the_book():
    (field, transfer), loaded = _field("systems/clebsch-poisson.yaml")
    assert field.variables == ("p", "q", "r", "gamma1", "gamma2", "gamma3")
    N, A, B, C, p, q, r, g1, g2, g3 = map(field.generator, ("N", "A", "B", "C", *field.variables))
    by_hand = [
        (B - C) * B * C * (q * r - N * g2 * g3),
        (C - A) * C * A * (r * p - N * g3 * g1),
        (A - B) * A * B * (p * q - N * g1 * g2),
        *(A * B * C * x for x in (r * g2 - q * g3, p * g3 - r * g1, q * g1 - p * g2)),
    ]
    assert [x * A * B * C for x in field.numerators] == [x * field.denominator for x in by_hand]
    assert field.relations == (g1**2 + g2**2 + g3**2 - 1,)
    fourth = A**2 * p**2 + B**2 * q**2 + C**2 * r**2 - N * (B * C * g1**2 + C * A * g2**2 + A * B * g3**2)
    assert field.derivative(fourth) == 0
    # A sign that is wrong in one equation is seen by the integral.
    wrong = replace(field, numerators=(-field.numerators[0], *field.numerators[1:]))
    assert wrong.derivative(fourth) != 0
    for integral in loaded.integrals:
        top, bottom = transfer.fraction(integral.formula.polynomial)
        assert field.reduced(field.derivative(top)) == 0
        assert not any(bottom.degrees()[k] for k in field.places)
        assert loaded.ring.is_zero(transfer.back(transfer(transfer.back(top))) - transfer.back(top))


@pytest.mark.parametrize("name", ["gyrostat-poisson", "gravity-gradient-quaternion"])
def test_integrals_of_problem_seven_are_kept(name):
    (field, transfer), loaded = _field(f"systems/{name}.yaml")
    for integral in loaded.integrals:
        assert field.reduced(field.derivative(transfer.fraction(integral.formula.polynomial)[0])) == 0


def test_numbers_take_the_place_of_parameters():
    (field, _), _ = _field("systems/clebsch-poisson.yaml")
    there = field.at({"A": 4, "B": 5, "C": fmpq(6)})
    assert there.parameters == tuple(name for name in field.parameters if name not in "ABC")
    N, q, r, g2, g3 = map(there.generator, ("N", "q", "r", "gamma2", "gamma3"))
    assert there.numerators[0] * 4 == -there.denominator * (q * r - N * g2 * g3)
    with pytest.raises(KeyError):
        field.at({"D": 1})
    with pytest.raises(ZeroDivisionError):
        field.at({"A": 0})


TODA = """
mbsym: 1
name: Toda's lattice of three particles on a ring
bodies:
  - {name: one, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
  - {name: two, attached to: 0, connection point: [y, 0, 0], mass: 1, coordinates: [y]}
  - {name: three, attached to: 0, connection point: [z, 0, 0], mass: 1, coordinates: [z]}
loads:
  - potential: exp(x - y) + exp(y - z) + exp(z - x)
"""
#: On a line: of the three exponentials two are independent, and the third is 1 over none of them.
OPEN = TODA.replace(" + exp(z - x)", "")
MORSE = """
mbsym: 1
name: a particle between Morse's walls, with the sine of an angle beside
parameters: {m: positive, k: positive, b: positive}
bodies:
  - {name: one, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
  - {name: two, attached to: one, connection point: [0, 0, 0], rotation: {axes: [3, 0, 0], angles: [phi, 0, 0]},
     mass: m, mass centre: [1, 0, 0]}
loads:
  - potential: k*cosh(b*x) + m*cos(phi)
"""
DRIVEN = """
mbsym: 1
name: an oscillator that is driven
parameters: {k: positive, w: positive, a: real, m: positive}
prescribed: {phi: w}
bodies:
  - {name: one, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
loads:
  - spring: {coordinate: x, stiffness: k}
  - generalized force: {x: a*cos(phi)}
"""
#: A speed of its own and an angle: what was refused in speeds.
ROLLED = """
mbsym: 1
name: a sledge on a slope
parameters: {m: positive, J: positive, g: positive}
bodies:
  - name: sledge
    connection point: [x, y, 0]
    rotation: {axes: [3, 0, 0], angles: [phi, 0, 0]}
    coordinates: [x, y, phi]
    mass: m
    inertia about: mass centre
    inertia: [0, 0, J]
    speeds: {v: x_dot*cos(phi) + y_dot*sin(phi), w: -x_dot*sin(phi) + y_dot*cos(phi), r: phi_dot}
loads:
  - uniform gravity: {vector: [g, 0, 0]}
"""
POINT = """
mbsym: 1
name: a point
parameters: {{k: positive, h: positive, a: positive, g: real}}
bodies:
  - {{name: P, attached to: 0, connection point: [{place}], mass: 1, coordinates: [{names}]}}
loads:
  - potential: {potential}
"""
#: Kepler's problem in a uniform field; two centres at rest; a wave whose length is a parameter.
KEPLER = POINT.format(place="x, y, z", names="x, y, z", potential="-k/sqrt(x**2 + y**2 + z**2) + g*z")
CENTRES = POINT.format(
    place="x, y, 0", names="x, y", potential="-k/sqrt((x - a)**2 + y**2) - h/sqrt((x + a)**2 + y**2)"
)
WAVE = POINT.format(place="x, 0, 0", names="x", potential="-k*cos(x/a)")
#: A pendulum that a spring with a length of its own ties to a wall.
TIED = """
mbsym: 1
name: a pendulum on a spring
parameters: {m: positive, l: positive, a: positive, k: positive, s: positive}
bodies:
  - {name: rod, attached to: 0, rotation: {axes: [3], angles: [x]}, mass centre: [l, 0, 0], mass: m}
loads:
  - potential: k*(sqrt(l**2 + a**2 - 2*a*l*cos(x)) - s)**2/2
"""


@pytest.mark.parametrize(
    "text",
    [
        TODA,
        OPEN,
        MORSE,
        DRIVEN,
        ROLLED,
        KEPLER,
        CENTRES,
        WAVE,
        TIED,
        Path("systems/heavy-top.yaml").read_text(),
    ],
)
def test_it_is_the_equations_of_motion(text):
    """M u' = f with u' out of the field, in the ring; g' along a straight line of the configurations, in balls."""
    loaded = mbsym.loads(text)
    ring, equations = loaded.ring, loaded.equations
    field, transfer = vector_field(loaded.form, equations, driven=True)
    n = len(equations.forcing)
    rates, den = [transfer.back(p) for p in field.numerators[:n]], transfer.back(field.denominator)
    for row, f in zip(equations.mass_matrix.polynomials, equations.forcing, strict=True):
        assert ring.is_zero(ring.dot(row, rates) - ring.times(den, f.polynomial))
    for relation in field.relations:
        assert field.reduced(field.derivative(relation)) == 0
        assert ring.evaluate(transfer.back(relation), {x: fmpq(k, 7) for k, x in enumerate(ring.names())}).contains(0)
    if not loaded.system.speeds:
        with ctx.workprec(400):
            state = {name: fmpq(k + 3, 7) for k, name in enumerate(ring.names())}
            step = fmpq(1, 10**40)
            ends = [dict(state), dict(state)]
            for name in loaded.system.coordinates:
                for end, sign in zip(ends, (1, -1), strict=True):
                    end[name] = state[name] + sign * step * state[f"{name}_dot"]
            for item in loaded.system.prescribed:
                for end, sign in zip(ends, (1, -1), strict=True):
                    end[item.name] = state[item.name] + sign * step * state["w"]
            for k, top in zip(transfer.places[len(field.parameters) + n :], field.numerators[n:], strict=True):
                g = ring.context.gen(k)
                slope = (ring.evaluate(g, ends[0]) - ring.evaluate(g, ends[1])) / (2 * step)
                told = ring.evaluate(transfer.back(top), state) / ring.evaluate(den, state)
                assert abs(slope - told) < 1e-30


def test_exponentials_have_one_relation():
    """exp(x - y) exp(y - z) exp(z - x) = 1; on a line there is none; 1/exp is a variable, no denominator."""
    loaded = mbsym.loads(TODA)
    field, _ = vector_field(loaded.form, loaded.equations)
    one, two, three = map(field.generator, ("exp(x - y)", "exp(y - z)", "exp(z - x)"))
    assert field.relations == (one * two * three - 1,)
    loaded = mbsym.loads(OPEN)
    assert vector_field(loaded.form, loaded.equations)[0].relations == ()
    loaded = mbsym.loads(MORSE)
    field, _ = vector_field(loaded.form, loaded.equations)
    up, down = (field.generator(name) for name in field.variables if name.startswith("exp("))
    assert up * down - 1 in field.relations
    assert not any(field.denominator.degrees()[k] for k in field.places if "exp" in field.context.names()[k])


@pytest.mark.parametrize(
    ("potential", "why"),
    [
        ("exp(x) + exp(x + a)", "constant factor"),
        ("exp(6*x) + exp(10*x) + exp(15*x)", "several ways"),
        ("exp(2*x) + exp(3*x) + exp(-2*x)", "several ways"),
        ("x*log(1 + x**2)", "function log"),
        ("sqrt(2)*x**2", "constant sqrt(2) occurs"),
        ("exp(x) + x**2", "exp(x), x are functions of each other"),
        ("exp(x) + exp(a*x)", "functions of each other"),
        ("exp(a)*x**2", "constant exp(a) occurs"),
        ("exp(sqrt(3)*x - y)", "constant sqrt(3) occurs"),
        ("exp(sqrt(3)*x - y) + exp(x)", "constant sqrt(3) occurs"),
        ("exp(t*x)", "the time occurs"),
        ("1/x + exp(x)", "exp(x), x are functions of each other"),
        ("exp(exp(x))", "function exp occurs"),
        (
            "sqrt(x) + sqrt(y) + sqrt(x*y)",
            "sqrt(x*y), sqrt(y), sqrt(x): it is not shown that no product of what stands under these roots is a square",
        ),
        (
            "sqrt(2 - 2*cos(x))",
            "sqrt(2*(1 - cos(x))): it is not shown that no product of what stands under these roots is a square",
        ),
        ("sqrt(1 + sqrt(1 + x**2))", "sqrt(sqrt(x**2 + 1) + 1) occurs"),
        ("sin(x) + cos(a*x)", "functions of each other"),
    ],
)
def test_what_is_left_is_refused_with_its_reason(potential, why):
    text = OPEN.replace("exp(x - y) + exp(y - z)", potential).replace("bodies:", "parameters: {a: real}\nbodies:")
    loaded = mbsym.loads(text)
    with pytest.raises(NoClosedForm, match=re.escape(why)):
        vector_field(loaded.form, loaded.equations)


def test_todas_integrals():
    """Henon (1974): p1 p2 p3 - p1 e^(x2 - x3) - p2 e^(x3 - x1) - p3 e^(x1 - x2), beside momentum and energy."""
    loaded = mbsym.loads(TODA)
    found = loaded.polynomial_integrals.integrals
    assert [(one.weight, one.is_new) for one in found.generators] == [(1, False), (2, False), (3, True)]
    assert found.complete
    field = found.field
    x, y, z, a, b, c = map(field.generator, field.variables)
    henon = x * y * z - x * b - y * c - z * a
    assert field.derivative(henon) == 0
    assert found.generators[-1].polynomial in (henon, -henon)


#: Y = sqrt(3) y makes it Toda's lattice: M. Henon, Integrals of the Toda lattice, Phys. Rev. B 9 (1974).
HENON = POINT.format(
    place="x, y, 0", names="x, y", potential="(exp(2*x + 2*sqrt(3)*y) + exp(2*x - 2*sqrt(3)*y) + exp(-4*x))/24"
)


def test_todas_third_integral_in_henons_form():
    """8 x'(x'^2 - 3 y'^2) + ..., Henon's I, here with x and y the other way round, in the field of sqrt(3)."""
    found, field = _integrals(HENON)
    s, u, v, a, b, c = map(field.generator, ("sqrt(3)", *field.variables))
    assert field.relations == (a * b * c - 1,)
    by_hand = 8 * v * (v**2 - 3 * u**2) - s * (a - b) * u + (a + b - 2 * c) * v
    assert field.derivative(by_hand) == 0
    assert field.derivative(by_hand + 2 * s * (a - b) * u) != 0  # the other root of 3 is another system
    (new,) = found.new
    assert new.polynomial in (by_hand, -by_hand)
    assert found.complete
    assert (found.independent, field.free_parameters) == (2, ())


@pytest.mark.parametrize(("number", "count"), [("2", 0), ("3", 1), ("5", 0), ("12", 0), ("3/4", 0), ("27/9", 1)])
def test_of_other_numbers_in_the_place_of_3_there_is_no_third_integral(number, count):
    """Of exponents v_i there is none where some 2 v_i v_j/v_i^2 is no integer (M. Adler and P. van Moerbeke, 1982)."""
    found, _ = _integrals(HENON.replace("sqrt(3)", f"sqrt({number})"))
    assert (found.complete, len(found.new)) == (True, count)


def test_roots_of_numbers_are_independent():
    """Two oscillators, sqrt(2) and sqrt(3) in their springs, with x and y turned by 45 degrees: both energies."""
    potential = "sqrt(2)*(x + y)**2 + sqrt(3)*(x - y)**2 + (x + y)**4"
    found, field = _integrals(POINT.format(place="x, y, 0", names="x, y", potential=potential))
    two, three, u, v, x, y = map(field.generator, ("sqrt(2)", "sqrt(3)", *field.variables))
    energies = [(u + v) ** 2 / 4 + two * (x + y) ** 2 + (x + y) ** 4, (u - v) ** 2 / 4 + three * (x - y) ** 2]
    assert all(field.derivative(one) == 0 for one in energies)
    assert (found.complete, len(found.generators), found.independent) == (True, 1, 1)  # the other is of degree 4
    assert [f.polynomial in (4 * energies[1], -4 * energies[1]) for f in found.generators] == [True]


@pytest.mark.parametrize(
    ("potential", "variables"),
    [
        ("cosh(x) + cosh(y)", ["exp(x)", "exp(-x)", "exp(y)", "exp(-y)"]),
        ("cosh(x) + cosh(2*x) + y**2", ["exp(x)", "exp(-x)"]),
        ("exp(x) + exp(y) + exp(x + y) + exp(x - y) + exp(2*x)", ["exp(x)", "exp(y)", "exp(-y)"]),
    ],
)
def test_exponents_that_span_a_lattice_are_told_by_a_basis(potential, variables):
    """Of separate parts the energies are kept, and nothing that was none becomes an integral."""
    text = POINT.format(place="x, y, 0", names="x, y", potential=potential)
    loaded = mbsym.loads(text)
    field, transfer = vector_field(loaded.form, loaded.equations)
    assert [name for name in field.variables if name.startswith("exp(")] == variables
    pairs = [(name, f"exp(-{name[4:]}") for name in variables if f"exp(-{name[4:]}" in variables]
    assert list(field.relations) == [field.generator(a) * field.generator(b) - 1 for a, b in pairs]
    top, bottom = transfer.fraction(loaded.integrals[0].formula.polynomial)
    assert bottom.is_constant()
    assert field.reduced(field.derivative(top)) == 0


def _integrals(text, values=None):
    there = setting(mbsym.loads(text), values, driven=True)
    return integrals_of(there, 3), there.field


def test_a_root_has_its_square_and_its_reciprocal():
    """r' = (x x' + ...)/r, as r/(x^2 + ...) is 1/r: no denominator; where the leading coefficient is none, p is one."""
    loaded = mbsym.loads(KEPLER)
    field, _ = vector_field(loaded.form, loaded.equations)
    r, w = (field.generator(f"{x}x**2 + y**2 + z**2)") for x in ("sqrt(", "1/("))
    x, y, z = map(field.generator, "xyz")
    assert field.relations == (r**2 - x**2 - y**2 - z**2, w * (x**2 + y**2 + z**2) - 1)
    assert field.denominator.is_constant()
    assert field.reduced(r**3 * w) == r
    loaded = mbsym.loads(TIED)
    field, _ = vector_field(loaded.form, loaded.equations)
    l, a, r, c = map(field.generator, ("l", "a", field.variables[1], "cos(x)"))
    assert field.reduced(r**2) == l**2 + a**2 - 2 * a * l * c
    assert len(field.relations) == 2


def test_laplaces_vector_and_what_a_uniform_field_leaves_of_it():
    """v x L - k r/|r| (P. S. Laplace); with g: its z component + g (x^2 + y^2)/2 (P. J. Redmond, 1964), no other."""
    found, field = _integrals(KEPLER, {"g": Fraction(0)})
    k, u, v, w, r, x, y, z, inverse = map(field.generator, ("k", *field.variables))
    components = [
        v * (x * v - y * u) - w * (z * u - x * w) - k * x * r * inverse,
        w * (y * w - z * v) - u * (x * v - y * u) - k * y * r * inverse,
        u * (z * u - x * w) - v * (y * w - z * v) - k * z * r * inverse,
    ]
    assert all(field.reduced(field.derivative(one)) == 0 for one in components)
    new = [one.polynomial for one in found.new]
    assert found.complete
    assert all(any(one in (f, -f) for f in new) for one in components)
    assert (found.independent, len(new)) == (5, 5)  # problem 7, for any g, has the energy and L_z
    found, field = _integrals(KEPLER)
    k, g, u, v, w, r, x, y, z, inverse = map(field.generator, ("k", "g", *field.variables))
    by_hand = 2 * (u * (z * u - x * w) - v * (y * w - z * v) - k * z * r * inverse) - g * (x**2 + y**2)
    assert found.complete
    assert [one.polynomial in (by_hand, -by_hand) for one in found.new] == [True]


def test_two_centres_keep_eulers_integral():
    """(r1 x v)(r2 x v) - 2 a (k (x - a)/r1 - h (x + a)/r2), (L. Euler, 1760); another sign is refuted."""
    loaded = mbsym.loads(CENTRES)
    field, _ = vector_field(loaded.form, loaded.equations)
    k, h, a, u, v, x, y = map(field.generator, ("k", "h", "a", "x_dot", "y_dot", "x", "y"))
    near, far = (field.generator(f"sqrt(x**2 + y**2 {sign} 2*a*x + a**2)") for sign in "-+")
    for sign in (1, -1):
        turning = ((x - a) * v - y * u) * ((x + a) * v - y * u)
        top = turning * near * far - 2 * a * (k * (x - a) * far - sign * h * (x + a) * near)
        bottom = near * far
        rate = field.reduced(field.derivative(top) * bottom - top * field.derivative(bottom))
        assert (rate == 0) is (sign == 1)
    assert field.reduced(near**2 - far**2) == -4 * a * x


def test_calogeros_particles_keep_a_cubic_integral():
    """p1 p2 p3 - g (p1/(x2 - x3)^2 + ...) of 1/(xi - xj)^2: J. Moser, Adv. Math. 16 (1975); another sign is refuted.

    Of w = 1/(x - y), u = 1/(y - z), v = 1/(x - z) positions are no variables: w u - (w + u) v = 0.
    """
    text = POINT.format(place="x, y, z", names="x, y, z", potential="g/(x - y)**2 + g/(y - z)**2 + g/(z - x)**2")
    found, field = _integrals(text)
    assert set(field.variables) == {"x_dot", "y_dot", "z_dot", "1/(x - y)", "1/(y - z)", "1/(x - z)"}
    g, p, q, r = map(field.generator, ("g", "x_dot", "y_dot", "z_dot"))
    w, u, v = (field.generator(f"1/({pair})") for pair in ("x - y", "y - z", "x - z"))
    assert [field.reduced(w * u - w * v - u * v)] == [0]
    for sign in (1, -1):
        moser = p * q * r - sign * g * (p * u**2 + q * v**2 + r * w**2)
        assert (field.reduced(field.derivative(moser)) == 0) is (sign == 1)
    assert (found.complete, found.independent, [one.weight for one in found.generators]) == (True, 3, [1, 2, 3])


def test_positions_that_are_divided_by():
    """Winternitz and others (1967): k (x^2 + y^2) + a/x^2 + b/y^2 has three independent ones; one is by hand."""
    potential = "k*(x**2 + y**2) + a/x**2 + h/y**2"
    text = POINT.format(place="x, y, 0", names="x, y", potential=potential).replace("a: positive", "a: real")
    there = setting(mbsym.loads(text), driven=True)
    found, field = integrals_of(there, 4), there.field
    a, h, u, v, x, y, p, q = map(field.generator, ("a", "h", "x_dot", "y_dot", "x", "y", "1/x", "1/y"))
    assert (list(field.relations), field.units) == ([x * p - 1, y * q - 1], {"1/x", "1/y"})
    turning = (x * v - y * u) ** 2 + 2 * (a * y**2 * p**2 + h * x**2 * q**2)
    assert field.reduced(field.derivative(turning)) == 0
    assert (found.complete, found.independent) == (True, 3)
    assert found.rational == ()


@pytest.mark.parametrize(
    ("potential", "outside"),
    [
        ("1/x**2 + 2/y**2", "x, y"),  # (x y' - y x')^2 + 2 (y^2/x^2 + 2 x^2/y^2) is one
        ("1/x**2 + 2/y**2 + x**2", "y"),
        ("exp(x) + y**2", "x"),
        ("x**2 + y**2 + 1/x**2 + 2/y**2", ""),
        ("1/(x**2 + y**2)", ""),
    ],
)
def test_positions_that_stand_in_variables_alone_are_told(potential, outside):
    """A list up to a degree is not one of polynomials in x where 1/x is a variable, and x is none."""
    found, _ = _integrals(POINT.format(place="x, y, 0", names="x, y", potential=potential))
    told = [Writer().said(sentence) for sentence in sentences(found)]
    text = f"Integrals that hold {outside} outside of these variables are not looked for."
    assert [x for x in told if "outside of" in x] == ([text] if outside else [])


@pytest.mark.parametrize(
    "potential",
    [
        "1/(x - y)**2 + 1/(y - z)**2 + 1/(z - x)**2 + x**2 + y**2 + z**2",  # reciprocals share their positions
        "1/x + 1/(x - a)",  # functions of each other
        "1/(exp(x) + 1)",
    ],
)
def test_where_reciprocals_are_no_variables_they_are_denominators(potential):
    """As without: the energy is a quotient, and nothing is denied beyond what is said."""
    text = POINT.format(place="x, y, z", names="x, y, z", potential=potential)
    there = setting(mbsym.loads(text), driven=True)
    assert not any(name.startswith("1/") for name in there.field.variables)
    assert there.rational


def test_what_constraints_tie_is_no_reciprocal_by_itself():
    """On a sphere 1/z is tied to x and y: without that relation integrals on it would be denied."""
    text = POINT.format(place="x, y, z", names="x, y, z", potential="k*x**2 + h*y**2 + g*z")
    text += "constraints:\n  - relation: x**2 + y**2 + z**2 = 1\ndependent: [z]\n"
    field = setting(mbsym.loads(text), driven=True).field
    x, y, z = map(field.generator, "xyz")
    assert field.relations == (x**2 + y**2 + z**2 - 1,)


def test_a_root_of_a_unit_vector_is_refused():
    """On the sphere gamma1^2 + gamma2^2 = (1 - gamma3)(1 + gamma3): what is no square there is not looked at."""
    text = Path("systems/kirchhoff.yaml").read_text().split("values:")[0]
    loaded = mbsym.loads(
        text.replace("(k1*gamma1**2 + k2*gamma2**2 + k3*gamma3**2)/2", "(k1 + k2 + k3)*sqrt(2 + gamma1)")
    )
    with pytest.raises(NoClosedForm, match=r"sqrt\(gamma1 \+ 2\) occurs"):
        vector_field(loaded.form, loaded.equations)


def test_a_spring_with_a_length_of_its_own_leaves_the_energy():
    """m l^2 x'^2/2 + k (r - s)^2/2 with r^2 = l^2 + a^2 - 2 a l cos x, and nothing else up to degree 3."""
    found, field = _integrals(TIED)
    m, l, a, k, s, v, r, c = map(field.generator, ("m", "l", "a", "k", "s", "x_dot", field.variables[1], "cos(x)"))
    (one,) = found.generators
    assert found.complete
    assert one.polynomial in (sign * (m * l**2 * v**2 - 2 * k * (a * l * c + s * r)) for sign in (1, -1))


def test_a_driven_oscillator_has_the_energy_of_its_difference_from_the_forced_motion():
    """X = a cos(phi)/(k - m w^2): m (x' - X')^2 + k (x - X)^2, times (k - m w^2)^2, is a polynomial in them all."""
    loaded = mbsym.loads(DRIVEN)
    found = loaded.polynomial_integrals.integrals
    (new,) = found.new
    field = found.field
    k, w, a, m, v, s, c, x = map(field.generator, ("k", "w", "a", "m", "x_dot", "sin(phi)", "cos(phi)", "x"))
    d = k - m * w**2
    by_hand = m * (d * v + a * w * s) ** 2 + k * (d * x - a * c) ** 2
    assert field.derivative(by_hand) == 0
    assert by_hand - d * new.polynomial == m * w**2 * a**2 * (s**2 + c**2)


def test_in_speeds_an_angle_is_a_pair():
    """m (v' - r w) = m g cos(phi): the field of ROLLED by hand."""
    loaded = mbsym.loads(ROLLED)
    field, _ = vector_field(loaded.form, loaded.equations)
    assert field.variables == ("v", "w", "r", "sin(phi)", "cos(phi)")
    g, v, w, r, s, c = map(field.generator, ("g", *field.variables))
    by_hand = [r * w + g * c, -r * v - g * s, 0 * r, r * c, -r * s]
    assert [p - q * field.denominator for p, q in zip(field.numerators, by_hand, strict=True)] == [0] * 5


def test_problem_ten_takes_no_exponentials_and_no_roots():
    """grad K in e = exp(x) and x apart would have no zero where there is an equilibrium."""
    analysis = mbsym.loads(TODA)
    with pytest.raises(NoClosedForm, match=r"exp\(x - y\)"):
        invariant_sets_of(analysis)
    with pytest.raises(NoClosedForm, match=r"sqrt\(x\*\*2 \+ y\*\*2 \+ z\*\*2\)"):
        invariant_sets_of(mbsym.loads(KEPLER))
    with pytest.raises(NoClosedForm, match=r"sin\(phi\), cos\(phi\)"):
        invariant_sets_of(mbsym.loads(ROLLED))


def test_problem_ten_takes_no_angle_beside_its_sine():
    """At rest k (phi - a) + sin phi = 0; phi = a with sin phi = 0, which grad K in both apart gives, is none."""
    text = """
mbsym: 1
name: a pendulum on a torsion spring
parameters: {k: positive, a: positive}
bodies:
  - {name: one, attached to: 0, rotation: {axes: [3, 0, 0], angles: [phi, 0, 0]}, mass: 0, inertia about: joint,
     inertia: [0, 0, 1]}
loads:
  - potential: k*(phi - a)**2/2 - cos(phi)
"""
    with pytest.raises(NoClosedForm, match=r"phi, sin\(phi\) are functions of each other"):
        invariant_sets_of(mbsym.loads(text))
