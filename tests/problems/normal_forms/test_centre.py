"""Centre manifolds: published coefficients, and ones found by hand."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import acb, arb

import mbsym
from mbsym.algebra.tower import Element, Tower
from mbsym.algebra.truncated import Space, Truncated
from mbsym.problems.normal_forms.exact import on_pair, on_zero


def _size(x: acb) -> float:
    return float(abs(x).mid())


def _space(m: int) -> tuple[Space, list[Truncated]]:
    space = Space(m, 3, acb(0), acb(1))
    return space, [space.variable(k) for k in range(m)]


@pytest.mark.parametrize(
    ("damping", "expected"),
    [("rayleigh", Fraction(-3, 8) * 4), ("hard", Fraction(3, 8) * 4), ("van der Pol", Fraction(-1, 8))],
)
def test_guckenheimer_and_holmes(damping: str, expected: Fraction) -> None:
    """x'' + g + w^2 x = 0 with w = 2: g = x'^3: -3 w^2/8; g = -x'^3: 3 w^2/8; g = x^2 x': -1/8."""
    _, (x, v) = _space(2)
    g = {"rayleigh": v * v * v, "hard": -(v * v * v), "van der Pol": x * x * v}[damping]
    found = on_pair([v, -x.scaled(acb(4)) - g], acb(0, 2), lambda z: 1 / z, _size)
    a = (found.cubic / (4 * found.lengths[0])).real
    assert abs(a - arb(expected.numerator) / expected.denominator) < 1e-12


def test_the_same_exactly_in_the_frequency() -> None:
    tower = Tower(("w",))
    w = tower.parameter("w")
    root = tower.square_root(-(w * w))
    space = Space(2, 3, tower.zero, tower.one)
    x, v = space.variable(0), space.variable(1)
    found = on_pair([v, -x.scaled(w * w) - v * v * v], root, tower.reciprocal, lambda z: float(not z.is_zero()))
    a = found.cubic / (found.lengths[0] * 4)
    assert a == w * w * tower.number(Fraction(-3, 8))


def test_quadratic_terms_and_other_roots_count() -> None:
    """Lorenz-like: x' = -y, y' = x + x z, z' = -z + x^2: a = 1/20 by hand.

    z = A + B cos 2t + C sin 2t for x = r cos t, y = r sin t:  z' + z = r^2 (1 + cos 2t)/2 gives A = r^2/2,
    B = r^2/10, C = r^2/5.  r' = <sin t x z> = r <sin t cos t (A + B cos 2t + C sin 2t)> = r C/4 = r^3/20.
    """
    _, (x, y, z) = _space(3)
    found = on_pair([-y, x + x * z, x * x - z], acb(0, 1), lambda s: 1 / s, _size)
    assert abs((found.cubic / (4 * found.lengths[0])).real - arb(1) / 20) < 1e-12


def _nonzero(x: Element) -> float:
    return float(not x.is_zero())


def _coefficient(tower: Tower, field: list[Truncated], root: Element) -> Element:
    found = on_pair(field, root, tower.reciprocal, _nonzero)
    real = (found.cubic + tower.conjugate(found.cubic, tower.places(root.top)[0])) / 2
    return real / (found.lengths[0] * 4)


def test_a_feedback_control_system() -> None:
    """x' = y, y' = z, z' = x^2 - x - b y - z/b: Kuznetsov, Elements of Applied Bifurcation Theory, example 5.4.

    l_1 = -w^3 (1 + 8 w^6)/((1 + 4 w^6)(1 + w^6)), w^2 = b, for q = (1, i w, -w^2): a = w l_1/4.
    """
    tower = Tower(("b",))
    b, one = tower.parameter("b"), tower.one
    space = Space(3, 3, tower.zero, one)
    x, y, z = map(space.variable, range(3))
    field = [y, z, x * x - x - y.scaled(b) - z.scaled(one / b)]
    cube = b * b * b
    published = -(b * b * (one + cube * 8)) / ((one + cube * 4) * (one + cube) * 4)
    assert _coefficient(tower, field, tower.square_root(-b)) == published


def test_watts_governor() -> None:
    """x'' = z^2 sin x cos x - sin x - eps x', z' = al (cos x - be), eps = 2 al be^(3/2) (Pontryagin's border).

    J. Sotomayor, L. F. Mello & D. C. Braga, Bifurcation analysis of the Watt governor system (arXiv math/0606230): the
    sign of the first coefficient is that of  -(3 + (al^2 - 5) be^2 + al^4 be^6),  quoted second-hand; the positive
    factor was found here.  be = r^2, sin and cos expanded about cos x = be, z = be^(-1/2).
    """
    tower = Tower(("al", "r"))
    al, r, one = tower.parameter("al"), tower.parameter("r"), tower.one
    be = r * r
    s = tower.square_root(one - be * be)
    space = Space(3, 3, tower.zero, one)
    u, y, v = map(space.variable, range(3))
    number, constant = tower.number, space.constant
    square, cube = u * u, u * u * u
    half, sixth = number(Fraction(1, 2)), number(Fraction(1, 6))
    sine = constant(s) + u.scaled(be) - square.scaled(s * half) - cube.scaled(be * sixth)
    cosine = constant(be) - u.scaled(s) - square.scaled(be * half) + cube.scaled(s * sixth)
    z = constant(one / r) + v
    field = [y, z * z * sine * cosine - sine - y.scaled(al * be * r * 2), (cosine - constant(be)).scaled(al)]
    root = tower.square_root(-(one - be * be) / be)
    a2, b2 = al * al, be * be
    bracket = one * 3 + (a2 - 5) * b2 + a2 * a2 * b2 * b2 * b2
    ratio = _coefficient(tower, field, root) / bracket
    positive = al * r * r * r * (one - b2) / ((one - b2 + a2 * b2 * b2) * (one - b2 + a2 * b2 * b2 * 4))
    assert ratio == -positive / 8


def test_one_zero_root() -> None:
    """x' = x y, y' = -y + k x^2: y = k x^2 + ..., x' = k x^3; x' = x^2 + ...: a2 = 1."""
    for k in (2, -3):
        _, (x, y) = _space(2)
        found = on_zero([x * y, (x * x).scaled(acb(k)) - y], lambda s: 1 / s, _size)
        length = found.lengths[0]
        assert abs(found.quadratic) < 1e-12
        assert abs(found.cubic / (length * length) - k) < 1e-12
    _, (x, y) = _space(2)
    found = on_zero([x * x + y * y, -y], lambda s: 1 / s, _size)
    assert abs(found.quadratic / found.lengths[0] - 1) < 1e-12


@pytest.mark.parametrize("square", ["1", "2", "a**2", "(a - b)**2"])
def test_two_real_roots_of_opposite_signs_are_no_frequency(square):
    """x'' + x' + x = 0 beside y'' = square y: the sum of two roots is zero, but they are real; nothing breaks down."""
    analysis = mbsym.loads(
        "mbsym: 1\nname: saddle\nparameters: {a: real, b: real}\nbodies:\n"
        "  - {name: p, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}\n"
        f"loads:\n  - potential: x**2/2 - ({square})*y**2/2\n  - rayleigh: x_dot**2/2\nmotion: {{x: 0, y: 0}}\n"
    )
    assert analysis.normal_forms.in_symbols is None
