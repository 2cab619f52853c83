"""Centre manifolds: published coefficients, and ones found by hand."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import acb, arb

from mbsym.algebra.tower import Tower
from mbsym.algebra.truncated import Space, Truncated
from mbsym.problems.normal_forms.centre import on_pair, on_zero


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
