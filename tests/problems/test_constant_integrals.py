"""What is the same at all states is no first integral: the momentum of a coordinate without inertia is zero.

By hand: a mass on a spring carries a massless point q at b from it.  T = m x'^2/2, U = -k x^2/2 hold no b and no b', so
p_b = dT/db' = 0 identically.  Where q has a mass M, p_b = M (x' + b') is an integral.
"""

from __future__ import annotations

import pytest
from conftest import SHIPPED

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


def test_integrals_that_follow_with_factors_of_parameters_are_not_listed() -> None:
    """A ball rolls: y' = -r w1, so that J w1 - m r y' = -(m r + J/r) y' says what m y' says."""
    found = mbsym.load(SHIPPED / "rolling-sphere-speeds.yaml", (7,)).integrals
    momenta = [one.name for one in found if one.kind in ("linear momentum", "angular momentum")]
    assert momenta == ["linear momentum along axis 1", "linear momentum along axis 2", "angular momentum about axis 3"]


BALL = """
mbsym: 1
name: ball
parameters: {m: positive, r: positive, J: positive}
bodies:
  - {name: ball, attached to: 0, connection point: [x, y, r], rotation: {axes: [3, 1, 3], angles: [a, b, c]},
     coordinates: [x, y, a, b, c], orientation: {e: quaternion}, speeds: {p: omega1, q: omega2, s: omega3}, mass: m,
     inertia about: mass centre, inertia: [J, J, J]}
constraints: [rolling: {body: ball, point: [0, 0, -r], axes: 0, on: ground}]
"""


def test_momenta_do_not_carry_the_norm_of_a_quaternion() -> None:
    """m x' e.e^2 is m x', as e.e = 1: what constraints and turned axes multiply by is divided out."""
    formulas = {one.name: str(one.formula) for one in mbsym.loads(BALL, (7,)).integrals}
    assert formulas["linear momentum along axis 1"] == "m*x_dot"
    assert formulas["linear momentum along axis 2"] == "m*y_dot"
    assert "norm of e" in formulas


FREE = """
mbsym: 1
name: free
parameters: {{m: positive, a: positive, b: positive, c: positive}}
bodies:
  - {{name: frame, attached to: 0, mass: 0, rotation: {{axes: [3], angles: ["{angle}"]}}}}
  - {{name: one, attached to: frame, connection point: ["{x}", y, 0], mass: m, coordinates: [x, y]}}
"""


@pytest.mark.parametrize(
    ("angle", "x"),
    [("0", "(a - 2*b + c)*x"), ("a", "x"), ("pi/3", "x"), ("1", "x"), ("0", "pi*x"), ("0", "sqrt(a)*x"), ("0", "x")],
)
def test_integrals_of_a_free_particle_are_told_once(angle: str, x: str) -> None:
    """m x' cos(a) - m y' sin(a) along an inertial axis follows from m x' and m y', as do energies of x and of y."""
    found = mbsym.loads(FREE.format(angle=angle, x=x), (7,)).integrals
    assert [(one.kind, one.of) for one in found] == [
        ("generalised energy", "time"),
        ("cyclic momentum", "x"),
        ("cyclic momentum", "y"),
        ("angular momentum", "3"),
    ]
