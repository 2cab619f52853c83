"""Taylor fields against expansions by hand."""

from __future__ import annotations

from conftest import SHIPPED

import mbsym
from mbsym.problems.normal_forms.dissipative import taylor_field
from mbsym.problems.normal_forms.expansion import expansion


def _field(name: str, order: int = 4, cyclic: tuple[str, ...] = ()) -> object:
    analysis = mbsym.load(SHIPPED / f"{name}.yaml")
    return taylor_field(expansion(analysis.parameters_scene, analysis.system, analysis.equilibrium, order, cyclic))


def test_a_pendulum() -> None:
    """(m l^2 + J) theta'' = -b theta' - m g l (theta - theta^3/6)."""
    found = _field("simple-pendulum")
    assert found.variables == ("theta", "theta_dot")
    g = {name: found.generator(name) for name in (*found.parameters, *found.variables)}
    mass = g["m"] * g["l"] ** 2 + g["J"]
    sine = g["theta"] - g["theta"] ** 3 / 6
    assert found.numerators[0] * mass == g["theta_dot"] * mass * found.denominator
    needed = -g["b"] * g["theta_dot"] - g["m"] * g["g"] * g["l"] * sine
    assert found.numerators[1] * mass == needed * found.denominator
    wrong = -g["b"] * g["theta_dot"] + g["m"] * g["g"] * g["l"] * sine
    assert found.numerators[1] * mass != wrong * found.denominator


def test_a_spring_pendulum_keeps_its_energy_to_the_order() -> None:
    """H = m (r'^2 + r^2 theta'^2)/2 - m g r cos theta + k (r - l0)^2/2 about r = l0 + m g/k: dH/dt = O(5)."""
    found = _field("spring-pendulum")
    g = {name: found.generator(name) for name in (*found.parameters, *found.variables)}
    m, k = g["m"], g["k"]
    rest = g["l0"] * k + m * g["g"]  # k r at rest
    r = rest + k * g["r"]
    theta = g["theta"]
    cosine = 1 - theta**2 / 2 + theta**4 / 24
    # 2 k^2 H
    energy = m * (k**2 * g["r_dot"] ** 2 + r**2 * g["theta_dot"] ** 2) - 2 * m * g["g"] * k * r * cosine
    energy += k * (r - g["l0"] * k) ** 2
    rate = found.derivative(energy)
    first = len(found.parameters)
    assert not rate.is_zero()
    assert all(sum(monomial[first:]) > 4 for monomial in rate.monoms())


def test_square_roots_are_constants_with_their_squares() -> None:
    """About L4 the coefficients hold sqrt(3): U_xy = 3 sqrt(3)/4 (1 - 2 mu), in x'' - 2 n y' = n^2 (3/4 x + U_xy y)."""
    found = _field("three-bodies")
    (name, square), *others = found.roots
    assert (others, square) == ([], 3)
    g = {x: found.generator(x) for x in (*found.parameters, *found.variables)}
    linear = g["n"] ** 2 * (3 * g["x"] / 4 + 3 * g[name] / 4 * (1 - 2 * g["mu"]) * g["y"]) + 2 * g["n"] * g["y_dot"]
    told = found.numerators[found.variables.index("x_dot")] - linear * found.denominator
    first = len(found.parameters)
    assert all(sum(monomial[first:]) > 1 for monomial in told.monoms())
