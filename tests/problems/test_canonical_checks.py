"""Hamilton's and Routh's forms: textbook formulas, brackets by hand, and mistakes that their second routes find."""

import pytest
from conftest import SHIPPED
from test_canonical import formula
from test_self_check import Mistake, plant

import mbsym
from mbsym.analysis import Analysis
from mbsym.problems.checks import EXACT, FAILED

#: Euler's angles 3-1-3 of a heavy symmetric top, the textbook's.
TOP = """
mbsym: 1
name: Lagrange's top
parameters: {A: positive, C: positive, m: positive, l: positive, g: positive}
bodies:
  - name: top
    attached to: 0
    rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}
    mass centre: [0, 0, l]
    mass: m
    inertia about: joint
    inertia: [A, A, C]
loads: [{uniform gravity: {acceleration: g, direction: [0, 0, -1]}}]
"""

#: A planet about a fixed centre, in polar coordinates.
KEPLER = """
mbsym: 1
name: Kepler's problem
parameters: {m: positive, k: positive}
bodies:
  - {name: planet, attached to: 0, connection point: [r*cos(phi), r*sin(phi), 0], mass: m, coordinates: [r, phi]}
loads: [{force function: k/r}]
"""

#: Both angles from the vertical, as textbooks have them.
TWO = """
mbsym: 1
name: double pendulum
parameters: {m1: positive, m2: positive, l1: positive, l2: positive, g: positive}
bodies:
  - name: first
    attached to: 0
    rotation: {axes: [3], angles: [a]}
    mass centre: [0, -l1, 0]
    mass: m1
    coordinates: [a]
  - name: second
    attached to: first
    connection point: [0, -l1, 0]
    rotation: {axes: [3], angles: [b - a]}
    mass centre: [0, -l2, 0]
    mass: m2
    coordinates: [b]
loads: [{uniform gravity: {acceleration: g, direction: [0, -1, 0]}}]
"""

#: A point on an isotropic spring: every component of the angular momentum is kept.
SPRING = """
mbsym: 1
name: isotropic oscillator
parameters: {m: positive, k: positive}
bodies: [{name: point, attached to: 0, connection point: [x, y, z], mass: m, coordinates: [x, y, z]}]
loads: [{potential: k*(x**2 + y**2 + z**2)/2}]
"""


def asked(text: str) -> Analysis:
    analysis = mbsym.loads(text)
    analysis.forms = ("routh", "hamilton")
    return analysis


def test_lagranges_top_as_goldstein_and_landau_have_it() -> None:
    """Goldstein, Classical Mechanics, 5.7; Landau & Lifshitz, section 35: the effective potential of the nutation."""
    found = asked(TOP)
    left, whole = found.routh, found.hamilton.hamiltonian
    assert (left.ignored, left.coordinates) == (("psi", "phi"), ("theta",))
    potential = "(p_psi - p_phi*cos(theta))**2/(2*A*sin(theta)**2) + p_phi**2/(2*C) + m*g*l*cos(theta)"
    ring = left.function.ring
    assert left.reduced_potential == formula(ring, potential)
    assert left.function == formula(ring, f"A*theta_dot**2/2 - ({potential})")
    assert left.linear == (formula(ring, "0"),)
    assert left.ignored_rates[0] == formula(ring, "(p_psi - p_phi*cos(theta))/(A*sin(theta)**2)")
    assert whole == formula(whole.ring, f"p_theta**2/(2*A) + {potential}")


def test_keplers_problem() -> None:
    """Landau & Lifshitz, section 15: U_eff = -k/r + M^2/(2 m r^2)."""
    found = asked(KEPLER).routh
    ring = found.function.ring
    assert found.reduced_potential == formula(ring, "p_phi**2/(2*m*r**2) - k/r")
    assert found.forcing == (formula(ring, "p_phi**2/(m*r**3) - k/r**2"),)


def test_the_double_pendulum_of_textbooks() -> None:
    """H of two point masses, both angles from the vertical (T by hand, M inverted by hand)."""
    whole = asked(TWO).hamilton.hamiltonian
    kinetic = "m2*l2**2*p_a**2 + (m1 + m2)*l1**2*p_b**2 - 2*m2*l1*l2*p_a*p_b*cos(a - b)"
    share = "2*m2*l1**2*l2**2*(m1 + m2*sin(a - b)**2)"
    weight = "(m1 + m2)*g*l1*cos(a) + m2*g*l2*cos(b)"
    ring = whole.ring
    difference = (whole + formula(ring, weight)) * formula(ring, share) - formula(ring, kinetic)
    assert ring.is_zero(difference.polynomial) is True


def test_brackets_of_angular_momenta() -> None:
    """{L1, L2} = L3 and so on, with {q, p} = 1; all commute with H."""
    found = asked(SPRING)
    brackets = found.brackets
    names = ["angular momentum about axis 3", "angular momentum about axis 1", "angular momentum about axis 2"]
    three, one, two = (brackets.names.index(name) for name in names)
    assert brackets.in_involution is False
    assert brackets.formulas[three] == formula(brackets.formulas[three].ring, "x*p_y - y*p_x")
    for i, j, k in ((one, two, three), (two, three, one), (three, one, two)):
        assert brackets.matrix[i, j] == brackets.formulas[k]
        assert brackets.matrix[j, i] == -brackets.formulas[k]
    energy = brackets.names.index("generalised energy")
    assert all(x.is_zero for x in brackets.matrix.rows[energy])


@pytest.mark.parametrize(
    ("name", "reason"), [("cart-pole", "cyclic are p, but"), ("cart-pendulum", "cyclic are x, but")]
)
def test_a_force_on_a_cyclic_coordinate_is_named(name: str, reason: str) -> None:
    failure = mbsym.load(SHIPPED / f"{name}.yaml").stage_of("routh").failure
    assert (failure.code, failure.reason.startswith(reason)) == ("nothing-ignored", True)


def test_nothing_is_left_of_a_free_point() -> None:
    failure = asked(SPRING.split("loads")[0]).stage_of("routh").failure
    assert failure.reason == "all coordinates are cyclic, so that no other is left"


def test_constraints_are_refused_by_name() -> None:
    failure = mbsym.load(SHIPPED / "chaplygin-sleigh.yaml").stage_of("hamilton").failure
    assert failure.code == "constraints"
    assert "velocity" in failure.reason


# --- planted mistakes ---

CANONICAL, ROUTH, BRACKETS = "canonical equations", "Routh's equations", "Poisson brackets"
#: A cart on a moving floor and a pendulum on a motor, with dampers: A1, A0 and Q are there.
DRIVEN = """
mbsym: 1
name: driven
parameters: {m1: positive, m2: positive, l: positive, b: positive, g: positive, Omega: real}
prescribed: {chi: Omega}
bodies:
  - {name: cart, attached to: 0, connection point: [x + l*sin(chi), 0, 0], mass: m1, coordinates: [x]}
  - name: arm
    attached to: cart
    rotation: {axes: [3], angles: [q + chi]}
    mass centre: [0, -l, 0]
    mass: m2
    coordinates: [q]
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
  - damper: {coordinate: x, coefficient: b}
  - rayleigh: b*(x_dot - q_dot)**2/2
"""

#: A pendulum that swings on a turning shaft, beside its axis; the shaft's angle is cyclic and coupled.
SHAFT = """
mbsym: 1
name: shaft
parameters: {C: positive, m: positive, l: positive, d: positive, b: positive, g: positive}
bodies:
  - name: shaft
    attached to: 0
    rotation: {axes: [3], angles: [phi]}
    mass: 0
    inertia about: joint
    inertia: [0, 0, C]
  - name: arm
    attached to: shaft
    connection point: [l, 0, 0]
    rotation: {axes: [1], angles: [q]}
    mass centre: [0, 0, -d]
    mass: m
    inertia about: mass centre
    inertia: [C, 2*C, 3*C]
loads:
  - uniform gravity: {acceleration: g, direction: [0, 0, -1]}
  - damper: {coordinate: q, coefficient: b}
"""
SYSTEMS = {"driven": DRIVEN, "shaft": SHAFT, "spring": SPRING, "top": TOP}


def outcomes(name: str) -> dict[str, str]:
    analysis = mbsym.loads(SYSTEMS[name], (3, 7))
    analysis.forms = ("routh", "hamilton")
    return {check.name: check.outcome for check in analysis.checks}


def failing(name: str) -> set[str]:
    return {check for check, outcome in outcomes(name).items() if outcome == FAILED}


HAMILTON, LEFT = "problems.canonical:hamilton", "problems.canonical:routh"
MISTAKES = [
    Mistake("the sign of A1", HAMILTON, "p - a for", "p + a for", "driven", (CANONICAL,)),
    Mistake("a third for a half", HAMILTON, "Fraction(1, 2)", "Fraction(1, 3)", "driven", (CANONICAL,)),
    Mistake("the sign of A0", HAMILTON, "- energy.A0.polynomial", "+ energy.A0.polynomial", "driven", (CANONICAL,)),
    Mistake(
        "forces at other speeds",
        HAMILTON,
        "substitute(applied[name], back)",
        "reduce(applied[name])",
        "driven",
        (CANONICAL,),
    ),
    Mistake(
        "the sign of dH/dq",
        HAMILTON,
        "- ring.derivative(whole, name)",
        "+ ring.derivative(whole, name)",
        "top",
        (CANONICAL,),
    ),
    Mistake(
        "the sign of the coupling",
        LEFT,
        "b - ring.substitute(p, at_rest)",
        "b + ring.substitute(p, at_rest)",
        "shaft",
        (ROUTH,),
    ),
    Mistake("beta c' added", LEFT, "lagrangian - sum(", "lagrangian + sum(", "top", (ROUTH,)),
    Mistake(
        "a forgotten convective term", LEFT, "force - _convective(scene, ring, slope, left)", "force", "shaft", (ROUTH,)
    ),
    Mistake(
        "the sign of W",
        LEFT,
        "-ring.substitute(function, rest_of)",
        "ring.substitute(function, rest_of)",
        "top",
        (ROUTH,),
    ),
    Mistake(
        "velocities of integrals",
        "problems.canonical:brackets",
        "canonical.velocities, strict",
        "canonical.velocities[::-1], strict",
        "spring",
        (BRACKETS,),
    ),
]


@pytest.mark.parametrize("name", SYSTEMS)
def test_without_a_mistake_all_is_exact(name: str) -> None:
    """And everything that a mistake is to be found by is compared."""
    found = outcomes(name)
    assert {check for mistake in MISTAKES if mistake.system == name for check in mistake.caught} <= found.keys()
    assert set(found.values()) == {EXACT}


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda mistake: mistake.what)
def test_a_planted_mistake_is_found(mistake: Mistake, monkeypatch: pytest.MonkeyPatch) -> None:
    plant(monkeypatch, mistake)
    assert set(mistake.caught) <= failing(mistake.system)
