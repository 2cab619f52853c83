"""Hamilton's and Routh's forms: textbook formulas, brackets by hand, and mistakes that their second routes find."""

import pytest
from conftest import SHIPPED
from test_canonical import formula
from test_self_check import Mistake, plant

import mbsym
from mbsym.analysis import Analysis
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.variables import ring_environment
from mbsym.problems.canonical import rate_along
from mbsym.problems.checks import EXACT, FAILED, NUMERICAL

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


# --- under constraints, and in speeds ---

#: A particle on a sphere, in cylindrical coordinates: psi is cyclic, r follows from z.
ON_A_SPHERE = """
mbsym: 1
name: spherical pendulum in cylindrical coordinates
parameters: {m: positive, l: positive, g: positive}
bodies:
  - {name: point, attached to: 0, connection point: [r*cos(psi), r*sin(psi), z], mass: m, coordinates: [r, psi, z]}
loads: [{uniform gravity: {acceleration: g, direction: [0, 0, -1]}}]
constraints: [{relation: r**2 + z**2 = 2*l*z}]
dependent: [r]
"""

#: A wheel that rolls on a line and carries a pendulum, the rolling as a rate.
WHEEL = """
mbsym: 1
name: wheel with a pendulum
parameters: {m: positive, r: positive, J: positive, k: positive, l: positive, g: positive}
bodies:
  - name: wheel
    attached to: 0
    connection point: [X, 0, 0]
    rotation: {axes: [2], angles: [phi]}
    mass: m
    inertia about: joint
    inertia: [0, J, 0]
    coordinates: [COORDINATES]
  - {name: arm, attached to: 0, connection point: [X, 0, 0], rotation: {axes: [2], angles: [a]}, mass: k,
     mass centre: [0, 0, -l]}
loads: [{uniform gravity: {acceleration: g, direction: [0, 0, -1]}}, {damper: {coordinate: a, coefficient: J}}]
"""


def test_on_a_sphere_both_forms_are_those_of_one_velocity() -> None:
    """r' = h z'/r, h = l - z: T = m/2 ((1 + h^2/r^2) z'^2 + r^2 psi'^2); d/dz along it is d/dz + h/r d/dr."""
    found = asked(ON_A_SPHERE)
    whole, left = found.hamilton, found.routh
    ring = whole.hamiltonian.ring
    assert (whole.speeds, whole.integrable) == (("psi_dot", "z_dot"), True)
    assert whole.hamiltonian == formula(ring, "p_psi**2/(2*m*r**2) + p_z**2/(2*m*(1 + (l - z)**2/r**2)) + m*g*z")
    rate = formula(ring, "-m*g + (z - l)*p_z**2/(m*r**2*(1 + (l - z)**2/r**2)) - (z - l)*p_psi**2/(m*r**4)")
    assert ring.is_zero((whole.rates[1] - rate).polynomial) is True
    assert whole.rates[0].is_zero
    assert (left.ignored, left.coordinates) == (("psi",), ("z",))
    inner = left.function.ring
    assert left.function == formula(inner, "m*(1 + (l - z)**2/r**2)*z_dot**2/2 - p_psi**2/(2*m*r**2) - m*g*z")
    force = formula(inner, "-m*g + (l - z)*p_psi**2/(m*r**4) + m*z_dot**2*((l - z)/r**2 + (l - z)**3/r**4)")
    assert inner.is_zero((left.forcing[0] - force).polynomial) is True
    names = found.brackets.names
    assert {"generalised energy", "momentum of psi"} <= {str(name) for name in names}
    assert found.brackets.in_involution is True


def test_a_rolling_wheel_has_the_function_of_the_coordinates_that_keep_it() -> None:
    tied = asked(ROLLING).hamilton
    plain = asked(WHEEL.replace("X", "r*phi").replace("COORDINATES", "phi")).hamilton
    assert (tied.momenta, tied.integrable) == (("p_phi", "p_a"), True)
    assert str(tied.hamiltonian) == str(plain.hamiltonian)
    assert [*map(str, tied.rates)] == [*map(str, plain.rates)]


def test_in_speeds_the_brackets_are_those_of_lie_and_poisson() -> None:
    """Marsden & Ratiu, Mechanics and Symmetry, 15.10: {m1, m2} = -m3; m' = m x w + gamma x dU/dgamma."""
    found = mbsym.load(SHIPPED / "euler-poisson.yaml").hamilton
    ring, names = found.hamiltonian.ring, ("p_p", "p_q", "p_r")
    assert found.momenta == names
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        assert found.structure[i, j] == -formula(ring, names[k])
    euler = formula(ring, "p_q*p_r/C - p_q*p_r/B + m*g*(z0*gamma2 - y0*gamma3)")
    assert found.rates[0] == euler


def test_where_wheels_roll_the_energy_stays_and_brackets_fall() -> None:
    """van der Schaft & Maschke (1994): Jacobi's identity holds if and only if the constraints are integrable."""
    found = mbsym.load(SHIPPED / "snakeboard.yaml")
    canonical = found.hamilton
    ring, system = canonical.hamiltonian.ring, found.system
    scene = Scene(system, ring, ring_environment(system, ring), ring, bodies=False)
    assert canonical.integrable is False
    assert ring.is_zero(rate_along(canonical, scene, canonical.hamiltonian.polynomial)) is True
    assert "violate Jacobi's identity" in found.stage_of("brackets").failure.reason
    assert found.stage_of("routh").failure.code == "nothing-ignored"


@pytest.mark.parametrize("name", ["four-bar", "snakeboard", "rolling-disc-speeds", "gravity-gradient-quaternion"])
def test_the_general_forms_pass_their_second_route(name: str) -> None:
    analysis = mbsym.load(SHIPPED / f"{name}.yaml", (3,))
    analysis.forms = ("hamilton",)
    assert {check.name: check.outcome for check in analysis.checks}[CANONICAL] == EXACT


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
ROLLING = WHEEL.replace("X", "x").replace("COORDINATES", "x, phi") + "constraints: [{velocity: x_dot = r*phi_dot}]\n"
PUSHED = ROLLING.replace("loads: [", "loads: [{generalized force: {x: -k*x_dot}}, ")
SYSTEMS = {"driven": DRIVEN, "shaft": SHAFT, "spring": SPRING, "top": TOP, "sphere": ON_A_SPHERE, "pushed": PUSHED}


def outcomes(name: str) -> dict[str, str]:
    analysis = mbsym.loads(SYSTEMS[name], (3, 7))
    analysis.forms = ("routh", "hamilton")
    return {check.name: check.outcome for check in analysis.checks}


def failing(name: str) -> set[str]:
    return {check for check, outcome in outcomes(name).items() if outcome == FAILED}


HAMILTON, LEFT = "problems.canonical:hamilton", "problems.canonical:routh"
MISTAKES = [
    Mistake("the sign of A1", HAMILTON, "p - carry(own", "p + carry(own", "driven", (CANONICAL,)),
    Mistake("a third for a half", HAMILTON, "Fraction(1, 2)", "Fraction(1, 3)", "driven", (CANONICAL,)),
    Mistake(
        "the sign of A0",
        HAMILTON,
        "- carry(own.at_rest(own.kinetic))",
        "+ carry(own.at_rest(own.kinetic))",
        "driven",
        (CANONICAL,),
    ),
    Mistake(
        "forces at other speeds",
        HAMILTON,
        "ring.substitute(x, along) - found.along",
        "x - found.along",
        "driven",
        (CANONICAL,),
    ),
    Mistake(
        "the sign of dH/dq",
        HAMILTON,
        "- found.along(whole, k)",
        "+ found.along(whole, k)",
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
        "a forgotten convective term",
        LEFT,
        "slope(function, name) - rate",
        "slope(function, name)",
        "shaft",
        (ROUTH,),
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
        "dependent coordinates at rest",
        LEFT,
        "moving_as.items()",
        "((x, y if x in free else ring.zero) for x, y in moving_as.items())",
        "sphere",
        (ROUTH,),
    ),
    Mistake(
        "slopes of independent coordinates alone",
        "problems.canonical:Hamilton.along",
        "if row[k]]",
        "if row[k] and s != 'r']",
        "sphere",
        (CANONICAL,),
    ),
    Mistake(
        "forces on dependent coordinates forgotten",
        HAMILTON,
        "acting[name])) for",
        "acting[name])) * (name != 'x') for",
        "pushed",
        (CANONICAL,),
    ),
    Mistake(
        "velocities of integrals",
        "problems.canonical:brackets",
        "canonical.speeds, slopes,",
        "canonical.speeds, slopes[::-1],",
        "spring",
        (BRACKETS,),
    ),
]


@pytest.mark.parametrize("name", SYSTEMS)
def test_without_a_mistake_all_is_exact(name: str) -> None:
    """And everything that a mistake is to be found by is compared."""
    found = outcomes(name)
    assert {check for mistake in MISTAKES if mistake.system == name for check in mistake.caught} <= found.keys()
    on_a_sphere = {NUMERICAL} if name == "sphere" else set()  # its states are no rational numbers
    assert set(found.values()) == {EXACT} | on_a_sphere


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda mistake: mistake.what)
def test_a_planted_mistake_is_found(mistake: Mistake, monkeypatch: pytest.MonkeyPatch) -> None:
    plant(monkeypatch, mistake)
    assert set(mistake.caught) <= failing(mistake.system)
