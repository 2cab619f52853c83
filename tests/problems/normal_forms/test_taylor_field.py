"""Taylor fields against expansions by hand."""

from __future__ import annotations

from pathlib import Path

import pytest

import mbsym
from mbsym.algebra.failures import NoClosedForm
from mbsym.problems.normal_forms.dissipative import taylor_field
from mbsym.problems.normal_forms.expansion import expansion

SYSTEMS = Path(__file__).parents[3] / "systems"


def _field(name: str, order: int = 4, cyclic: tuple[str, ...] = ()) -> object:
    analysis = mbsym.load(SYSTEMS / f"{name}.yaml")
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


def test_square_roots_are_refused() -> None:
    with pytest.raises(NoClosedForm, match="square roots"):
        _field("three-bodies")
