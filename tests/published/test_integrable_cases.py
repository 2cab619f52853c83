"""Integrable cases of the literature: the books' integrals are found, and beside them there are none.

Quartic potentials: A. Ramani, B. Dorizzi, B. Grammaticos, Phys. Rev. Lett. 49 (1982) 1539; J. Hietarinta, Phys. Rep.
147 (1987) 87.  Kirchhoff's equations: A. V. Borisov, I. S. Mamaev, Rigid Body Dynamics (2018), chapter 3.
"""

from __future__ import annotations

from fractions import Fraction

import pytest

import mbsym
from mbsym.analysis.polynomial import integrals_of, setting
from mbsym.problems.polynomial_integrals.levels import levels, on_level

QUARTIC = """
mbsym: 1
name: two coupled quartic oscillators
parameters: {{k: positive}}
bodies:
  - {{name: a, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: 0}}
  - {{name: b, attached to: a, connection point: [0, y, 0], coordinates: [y], mass: 1}}
loads:
  - potential: k*({potential})
"""
#: x^4 + a x^2 y^2 + b y^4: weighted degree of the second integral, and itself for velocities v, w.
CASES = {
    ("x**4 + 6*x**2*y**2 + y**4", 4): lambda k, v, w, x, y: v * w + 4 * k * x * y * (x**2 + y**2),
    ("x**4 + 12*x**2*y**2 + 16*y**4", 5): lambda k, v, w, x, y: (
        v * (v * y - w * x) - 4 * k * x**2 * y * (x**2 + 2 * y**2)
    ),
    ("x**4 + 6*x**2*y**2 + 8*y**4", 8): lambda k, v, w, x, y: (
        v**4
        + 4 * k * x**2 * (x**2 + 6 * y**2) * v**2
        - 16 * k * x**3 * y * v * w
        + 4 * k * x**4 * w**2
        + 4 * k**2 * x**4 * (x**2 + 2 * y**2) ** 2
    ),
}


def _found(text, degree):
    there = setting(mbsym.loads(text))
    return there, integrals_of(there, degree)


@pytest.mark.parametrize(("potential", "degree"), CASES)
def test_quartic_potentials_that_are_integrable(potential, degree):
    there, found = _found(QUARTIC.format(potential=potential), degree)
    book = CASES[potential, degree](*map(there.field.generator, ("k", "x_dot", "y_dot", "x", "y")))
    assert there.field.derivative(book) == 0
    assert (found.independent, found.complete) == (2, True)
    assert book in [sign * one.polynomial for one in found.generators for sign in (1, -1)]
    _, before = _found(QUARTIC.format(potential=potential), degree - 1)
    assert before.complete
    assert not before.new


@pytest.mark.parametrize(
    "potential", ["x**4 + 6*x**2*y**2 + 9*y**4", "x**4 + 11*x**2*y**2 + 16*y**4", "x**4 + x**2*y**2"]
)
def test_beside_them_there_are_none_of_degree_eight(potential):
    _, found = _found(QUARTIC.format(potential=potential), 8)
    assert found.complete
    assert found.independent == 1


def test_the_same_in_other_axes():
    """1 : 12 : 16 in axes turned by the angle of 3, 4, 5, of another scale."""
    turned = QUARTIC.format(potential="(3*x + 4*y)**4 + 12*(3*x + 4*y)**2*(3*y - 4*x)**2 + 16*(3*y - 4*x)**4")
    _, found = _found(turned, 5)
    assert (found.independent, found.complete, [one.weight for one in found.new]) == (2, True, [5])


def kirchhoff(a, b, c):
    """2 H = sum a_i M_i^2 + 2 b_i M_i gamma_i + c_i gamma_i^2,  M' = M x w + gamma x u,  gamma' = gamma x w.

    w = dH/dM = a M + b gamma, u = dH/dgamma = b M + c gamma.  Of a body with the inertia 1/a_i, d = b/a, the torque is
    I w' + w x I w = M x w + gamma x u + d gamma' + w x I w = d (gamma x w) - (d gamma) x w + gamma x u.
    """
    w, g = ("p", "q", "r"), ("gamma1", "gamma2", "gamma3")
    d = [y / x for x, y in zip(a, b, strict=True)]
    u = [f"({b[i] / a[i]})*{w[i]} + ({c[i] - b[i] * d[i]})*{g[i]}" for i in range(3)]

    def component(i):
        j, k = (i + 1) % 3, (i + 2) % 3
        return f"({d[i] - d[j]})*{g[j]}*{w[k]} - ({d[i] - d[k]})*{g[k]}*{w[j]} + {g[j]}*({u[k]}) - {g[k]}*({u[j]})"

    return f"""
mbsym: 1
name: Kirchhoff's equations
bodies:
  - name: body
    rotation: {{axes: [3, 1, 3], angles: [psi, theta, phi]}}
    mass: 0
    inertia about: joint
    inertia: {{tensor: [{", ".join(str(1 / x) for x in a)}], accept: true}}
    speeds: {{p: omega1, q: omega2, r: omega3}}
    orientation: {{gamma: 3}}
loads:
  - torque: {{body: body, axes: body, components: [{", ".join(f'"{component(i)}"' for i in range(3))}]}}
"""


def _fractions(*numbers):
    return tuple(map(Fraction, numbers))


def _steklov(a, mu):
    """b_1 = mu a_2 a_3,  c_1 = mu^2 a_1 (a_2 - a_3)^2, and so on around (V. A. Steklov, 1893)."""
    around = [(a[i], a[(i + 1) % 3], a[(i + 2) % 3]) for i in range(3)]
    return a, tuple(mu * y * z for _, y, z in around), tuple(mu**2 * x * (y - z) ** 2 for x, y, z in around)


def _lyapunov(d, mu):
    """a = 1, b_i = -mu d_i, c_1 = mu^2 (d_2 - d_3)^2 (A. M. Lyapunov, 1893): Steklov's of a_i = 1 + eps d_i, mu/eps."""
    around = [(d[i], d[(i + 1) % 3], d[(i + 2) % 3]) for i in range(3)]
    return _fractions(1, 1, 1), tuple(-mu * x for x in d), tuple(mu**2 * (y - z) ** 2 for _, y, z in around)


def _clebsch(a, c1, c2):
    """b = 0,  (c_2 - c_3)/a_1 + (c_3 - c_1)/a_2 + (c_1 - c_2)/a_3 = 0  (A. Clebsch, 1870)."""
    c3 = (c2 / a[0] - c1 / a[1] + (c1 - c2) / a[2]) / (1 / a[0] - 1 / a[1])
    return a, _fractions(0, 0, 0), (c1, c2, c3)


HALF = Fraction(1, 2)


@pytest.mark.parametrize(
    ("case", "weight"),
    [
        ((_fractions(2, 2, 3), _fractions(1, 1, 7), _fractions(5, 5, 2)), 1),  # G. Kirchhoff, 1870: M_3
        (_clebsch(_fractions(1, 2, 3), Fraction(0), Fraction(1)), 2),
        (_clebsch(_fractions(3, 5, 4), Fraction(1), Fraction(-2)), 2),
        (_steklov(_fractions(1, 2, 3), HALF), 2),
        (_steklov(_fractions(5, 2, 7), Fraction(-1, 3)), 2),
        (_lyapunov(_fractions(1, 3, 7), HALF), 2),
        (_lyapunov(_fractions(-2, 3, 1), Fraction(2)), 2),
    ],
)
def test_kirchhoffs_cases(case, weight):
    """Beside energy, (M, P) and |P| a fourth one; with one constant changed there is none up to degree four."""
    _, found = _found(kirchhoff(*case), 2)
    assert (found.independent, found.complete) == (4, True)
    assert weight in {one.weight for one in found.generators}
    a, b, c = case
    _, other = _found(kirchhoff(a, b, (c[0] + (1 if weight == 2 else 2), c[1], c[2])), 2)
    assert (other.independent, other.complete) == (3, True)


def test_chaplygins_case_holds_where_the_area_integral_is_zero():
    """a = (1, 1, 2), b = 0, c = (c, -c, 0): (M1^2 - M2^2 + c gamma3^2)^2 + 4 M1^2 M2^2 (S. A. Chaplygin, 1902)."""
    case = _fractions(1, 1, 2), _fractions(0, 0, 0), _fractions(3, -3, 0)
    there, found = _found(kirchhoff(*case), 4)
    assert found.independent == 3
    area = next(one for one in levels(found) if "momentum" in one.name)
    p, q, g3 = map(there.field.generator, ("p", "q", "gamma3"))
    book = (p**2 - q**2 + 3 * g3**2) ** 2 + 4 * p**2 * q**2
    assert [f for _, f in on_level(found, area).integrals] == [book]
    assert there.field.reduced(there.field.derivative(book)) != 0
