"""What is the same at all states is no first integral: the momentum of a coordinate without inertia is zero.

By hand: a mass on a spring carries a massless point q at b from it.  T = m x'^2/2, U = -k x^2/2 hold no b and no b', so
p_b = dT/db' = 0 identically.  Where q has a mass M, p_b = M (x' + b') is an integral.
"""

from __future__ import annotations

import pytest

import mbsym
from mbsym.algebra.failures import NoClosedForm
from mbsym.analysis.polynomial import setting
from mbsym.problems.integrals import by_structure

CARRIED = """
mbsym: 1
name: carried
parameters: {{k: positive, m: positive}}
bodies:
  - {{name: p, attached to: 0, mass: m, connection point: [x, y, 0], coordinates: [x, y]}}
  - {{name: q, attached to: p, mass: {mass}, connection point: [b, 0, 0], coordinates: [b]}}
loads:
  - potential: k*(x**2 + y**2)/2
{further}
motion: {{x: 0, y: 0, b: 0}}
"""
CONSTRAINED = "constraints: [{velocity: x_dot = 2*y_dot}]"


@pytest.mark.parametrize("further", ["", CONSTRAINED])
def test_a_momentum_that_is_zero_is_not_listed(further: str) -> None:
    found = mbsym.loads(CARRIED.format(mass="0", further=further))
    apart = [] if further else ["energy of x"]  # x and y are oscillators apart
    assert [one.name for one in found.integrals] == ["generalised energy", *apart]


def test_a_momentum_of_something_is_listed() -> None:
    found = mbsym.loads(CARRIED.format(mass="3", further=""))
    assert "momentum of b" in [one.name for one in found.integrals]


def test_what_is_known_by_structure_leaves_it_out_too() -> None:
    lists = []
    for mass in ("0", "3"):
        a = mbsym.loads(CARRIED.format(mass=mass, further=""))
        lists.append(by_structure(a.system, a.programs))
    assert lists == [("the energy T - U",), ("the energy T - U", "the momentum of b")]


def test_problem_9_says_that_the_mass_matrix_is_singular() -> None:
    """It used to end in a division by zero."""
    with pytest.raises(NoClosedForm, match="the mass matrix is singular"):
        setting(mbsym.loads(CARRIED.format(mass="0", further="")))
