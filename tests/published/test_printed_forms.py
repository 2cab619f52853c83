"""Formulas as papers and textbooks print them: the same terms, not only the same value.

Brackets are multiplied out and waves such as cos(theta1 - theta2) left as they stand (``spread.py``).
"""

from __future__ import annotations

import pytest
from conftest import SHIPPED, derived
from spread import Spread, spread

import mbsym
from mbsym.analysis import Analysis
from mbsym.expressions.tree import text

# --- two tethered satellites: eq. (3) of Fenili & Mazzariol ---

#: The paper tells these through c24, c25, c26, which are products that belong together (references/tethered-satellites,
#: notes 2.2): m2 d_Dcm2 (L1 cos(alpha1 + theta1 - alpha2 - theta2) ... and d_AC cos(alpha2 - theta1 + theta2)).
TOGETHER = (
    "-m2*d_Dcm2*L1*cos(alpha1 + theta1 - alpha2 - theta2)*(alpha1_dot + theta1_dot)*(alpha2_dot + theta2_dot)"
    " - m2*d_Dcm2*d_AC*cos(alpha2 - theta1 + theta2)*theta1_dot*(alpha2_dot + theta2_dot)"
)
#: What eq. (3) has too much, by the references: c18 stands with theta1'(theta1' + alpha1') for theta1' alpha1'.
SLIP = "m_B*L1*d_AC*cos(alpha1)*theta1_dot**2"


@pytest.fixture(scope="module")
def tether() -> Analysis:
    return derived(SHIPPED / "tethered-satellites.yaml")


def printed(tether: Analysis) -> Spread:
    """Eq. (3) with its coefficients c1 ... c30 put in, waves as printed."""
    short: dict[str, Spread] = {}
    for item in tether.system.abbreviations:
        short[item.name] = spread(text(item.value), short)
    short |= {name: spread("0") for name in ("c24", "c25", "c26")}
    claim = next(claim for claim in tether.system.claims if claim.place == "eq. (3)")
    return spread(text(claim.equals), short) + spread(TOGETHER)


def test_the_kinetic_energy_of_the_tether_has_the_terms_that_its_paper_prints(tether):
    ours = spread(tether.energy.kinetic_energy.text())
    assert ours == printed(tether) - spread(SLIP)


def test_its_products_of_sines_and_cosines_are_other_terms(tether):
    """The comparison is one of what is printed: of the same value in products it says no."""
    assert spread(tether.energy.kinetic_energy.text("products")) != printed(tether) - spread(SLIP)


def test_the_slip_of_the_paper_is_seen_in_the_terms(tether):
    assert repr(printed(tether) - spread(tether.energy.kinetic_energy.text())) == repr(spread(SLIP))


# --- double pendulum in absolute angles: Landau & Lifshitz, Mechanics, section 5, problem 1 ---

DOUBLE = """
mbsym: 1
name: Coplanar double pendulum
parameters: {m1: positive, m2: positive, l1: positive, l2: positive, g: positive}
bodies:
  - name: upper
    attached to: 0
    rotation: {axes: [3], angles: [phi1]}
    mass centre: [0, -l1, 0]
    mass: m1
  - name: lower
    attached to: upper
    rotation: {axes: [3], angles: [TURN]}
    connection point: [0, -l1, 0]
    mass centre: [0, -l2, 0]
    mass: m2
    coordinates: [phi2]
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
"""
KINETIC = "(m1 + m2)/2*l1**2*phi1_dot**2 + m2/2*l2**2*phi2_dot**2 + m2*l1*l2*phi1_dot*phi2_dot*cos(phi1 - phi2)"
FORCE_FUNCTION = "(m1 + m2)*g*l1*cos(phi1) + m2*g*l2*cos(phi2)"
#: d/dt dL/dphi' - dL/dphi, by hand.
MASS = (("(m1 + m2)*l1**2", "m2*l1*l2*cos(phi1 - phi2)"), ("m2*l1*l2*cos(phi1 - phi2)", "m2*l2**2"))
FORCING = (
    "-m2*l1*l2*phi2_dot**2*sin(phi1 - phi2) - (m1 + m2)*g*l1*sin(phi1)",
    "m2*l1*l2*phi1_dot**2*sin(phi1 - phi2) - m2*g*l2*sin(phi2)",
)


def test_the_double_pendulum_in_absolute_angles_is_that_of_the_textbook():
    found = mbsym.loads(DOUBLE.replace("TURN", "phi2 - phi1"))
    assert spread(found.energy.kinetic_energy.text()) == spread(KINETIC)
    assert spread(found.energy.force_function.text()) == spread(FORCE_FUNCTION)
    for i in range(2):
        for j in range(2):
            assert spread(found.equations.mass_matrix[i, j].text()) == spread(MASS[i][j])
        assert spread(found.equations.forcing[i].text()) == spread(FORCING[i])


def test_the_order_of_a_typed_sum_is_kept():
    found = mbsym.loads(DOUBLE.replace("TURN", "phi2 - phi1"))
    assert "cos(phi2 - phi1)" in found.equations.mass_matrix[0, 1].text()
    assert "sin(phi2 - phi1)" in found.equations.forcing[0].text()
    turned = mbsym.loads(DOUBLE.replace("TURN", "-(phi1 - phi2)"))
    assert turned.equations.mass_matrix[0, 1].latex() == r"m_{2} l_{1} l_{2} \cos(\varphi_{2} - \varphi_{1})"


def test_relative_angles_are_added():
    """With the angle in the joint, phi2 from the first rod: gravity turns the second rod by phi1 + phi2."""
    found = mbsym.loads(DOUBLE.replace("TURN", "phi2"))
    assert spread(found.energy.force_function.text()) == spread("(m1 + m2)*g*l1*cos(phi1) + m2*g*l2*cos(phi1 + phi2)")
    assert spread(found.equations.forcing[1].text()) == spread(
        "-m2*l1*l2*phi1_dot**2*sin(phi2) - m2*g*l2*sin(phi1 + phi2)"
    )


# --- double angles ---

HOOP = """
mbsym: 1
name: Bead on a hoop that turns about its vertical diameter
parameters: {m: positive, a: positive, g: positive, Omega: positive, theta0: {sign: real}}
prescribed: {chi: {rate: Omega}}
bodies:
  - name: bead
    attached to: 0
    rotation: {axes: [3, 1], angles: [chi, theta]}
    mass centre: [0, 0, -a]
    mass: m
loads:
  - uniform gravity: {acceleration: g, direction: [0, 0, -1]}
motion: {theta: theta0}
"""


def test_the_condition_of_a_bead_on_a_turning_hoop_has_a_double_angle():
    """V = -m g a cos(theta) - m Omega^2 a^2 sin(theta)^2/2, so V'' = m g a cos(theta) - m Omega^2 a^2 cos(2 theta)."""
    stiffness = mbsym.loads(HOOP).linearisation.K[0, 0]
    assert spread(stiffness.text()) == spread("m*g*a*cos(theta0) - m*Omega**2*a**2*cos(2*theta0)")
    assert "\\cos 2 \\theta_{0}" in stiffness.latex()


def test_moments_of_inertia_have_squares_of_their_own():
    """Routh, Rigid Dynamics II: a body about a fixed point, Euler's angles: 2T = A w1^2 + B w2^2 + C w3^2."""
    found = derived(SHIPPED / "gyrostat.yaml").equations.mass_matrix
    assert spread(found[0, 0].text()) == spread(
        "A*sin(theta)**2*sin(phi)**2 + B*sin(theta)**2*cos(phi)**2 + C*cos(theta)**2"
    )
    assert spread(found[1, 1].text()) == spread("A*cos(phi)**2 + B*sin(phi)**2")
