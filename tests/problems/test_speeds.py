"""Velocities that are variables: equations as textbooks print them, and planted mistakes that the self-check finds."""

import numpy as np
import pytest
import terminal
from conftest import filed, imported

import mbsym
from mbsym.algebra.vectors import Tensor
from mbsym.problems.checks import EXACT, FAILED
from mbsym.problems.stability.words import Because

#: A heavy gyrostat about a fixed point; what is put after its inertia says how it is told.
GYROSTAT = """
mbsym: 1
name: Heavy gyrostat
parameters: {{A: positive, B: positive, C: positive, m: positive, g: positive, x0: real, y0: real, z0: real, l1: real,
  l2: real, l3: real}}
bodies:
  - name: body
    attached to: 0
    rotation: {{axes: [3, 1, 3], angles: [psi, theta, phi]}}
    mass centre: [x0, y0, z0]
    mass: m
    inertia about: joint
    inertia: [A, B, C]
    gyrostatic moment: [l1, l2, l3]
    {told}
loads:
  - uniform gravity: {{vector: [0, 0, -g]}}
"""
SPEEDS = "speeds: {p: omega1, q: omega2, r: omega3}"
POISSON = SPEEDS + "\n    orientation: {gamma: 3}"

#: Euler's equations of a gyrostat (Zhukovsky), gravity m g gamma downwards: gamma is the third axis of space.
NEEDED = (
    "A*p_dot + (C - B)*q*r + q*l3 - r*l2",
    "B*q_dot + (A - C)*r*p + r*l1 - p*l3",
    "C*r_dot + (B - A)*p*q + p*l2 - q*l1",
)
SUPPLIED = (
    "m*g*(gamma2*z0 - gamma3*y0)",
    "m*g*(gamma3*x0 - gamma1*z0)",
    "m*g*(gamma1*y0 - gamma2*x0)",
)
CHECKED = ("kinematics", "energy", "equations of motion", "straight-line program")


def load(tmp_path, text):
    file = filed(tmp_path / "system.yaml", text)
    return mbsym.load(file)


def expected(analysis, texts):
    from mbsym.expressions.parser import parse_expression
    from mbsym.expressions.place import Complaints, Span
    from mbsym.formulas.formula import Formula

    lower = analysis.parameters_scene.lower
    trees = [parse_expression(one, Complaints(), lambda a, b: Span(1, 1)) for one in texts]
    return [Formula(analysis.ring, lower(tree)) for tree in trees]


def test_euler_and_poisson_equations_as_a_textbook_prints_them(tmp_path):
    found = load(tmp_path, GYROSTAT.format(told=POISSON))
    equations = found.equations
    assert equations.speeds == ("p", "q", "r")
    assert list(equations.needed) == expected(found, NEEDED)
    assert list(equations.supplied) == expected(found, SUPPLIED)
    rates = dict(equations.kinematic)
    poisson = expected(found, ["r*gamma2 - q*gamma3", "p*gamma3 - r*gamma1", "q*gamma1 - p*gamma2"])
    assert [rates["gamma1"], rates["gamma2"], rates["gamma3"]] == poisson
    assert equations.aside == ("alpha1", "alpha2", "alpha3", "beta1", "beta2", "beta3")
    assert str(equations.needed[0]) == "A*p_dot + (C - B)*q*r + l3*q - l2*r"


def test_euler_equations_with_angles(tmp_path):
    found = load(tmp_path, GYROSTAT.format(told=SPEEDS))
    assert [str(x) for x in found.kinematics.body("body").angular_velocity] == ["p", "q", "r"]
    gamma = {"gamma1": "sin(theta)*sin(phi)", "gamma2": "sin(theta)*cos(phi)", "gamma3": "cos(theta)"}
    supplied = []
    for text in SUPPLIED:
        for name, value in gamma.items():
            text = text.replace(name, f"({value})")
        supplied.append(text)
    assert list(found.equations.supplied) == expected(found, supplied)
    assert list(found.equations.needed) == expected(found, NEEDED)
    rates = dict(zip(found.equations.positions, found.equations.rates, strict=True))
    # Euler's kinematic equations, solved (Whittaker, Analytical Dynamics, section 16)
    wanted = {
        "psi": "(p*sin(phi) + q*cos(phi))/sin(theta)",
        "theta": "p*cos(phi) - q*sin(phi)",
        "phi": "r - cos(theta)/sin(theta)*(p*sin(phi) + q*cos(phi))",
    }
    assert [rates[name] for name in wanted] == expected(found, wanted.values())


@pytest.mark.parametrize("told", [SPEEDS, POISSON])
def test_the_second_routes_agree(tmp_path, told):
    found = load(tmp_path, GYROSTAT.format(told=told))
    for problem in (1, 2, 3):
        assert found.stage(problem).failure is None
    assert [found.check(name).outcome for name in CHECKED] == [EXACT] * 4


PLATE = """
mbsym: 1
name: A plate on a plane, velocities along its own axes
parameters: {m: positive, J: positive, X: real, Y: real}
prescribed: {chi: {rate: X}}
bodies:
  - name: plate
    attached to: 0
    rotation: {axes: [3], angles: [phi]}
    connection point: [x, y, 0]
    coordinates: [x, y, phi]
    mass: m
    inertia about: mass centre
    inertia: [0, 0, J]
    speeds: {u: x_dot*cos(phi) + y_dot*sin(phi), v: y_dot*cos(phi) - x_dot*sin(phi)}
loads:
  - force: {body: plate, point: [0, 0, 0], components: [X, Y, 0], axes: plate}
  - generalized force: {x: chi}
"""


def test_velocities_along_moving_axes(tmp_path):
    """m (u' - v r) = X, m (v' + u r) = Y, J r' = 0 with r = phi' (any book on ships); a force along x projects."""
    found = load(tmp_path, PLATE)
    equations = found.equations
    assert (equations.speeds, equations.speed_rates) == (("u", "v", "phi_dot"), ("u_dot", "v_dot", "phi_ddot"))
    assert list(equations.needed) == expected(found, ["m*(u_dot - v*phi_dot)", "m*(v_dot + u*phi_dot)", "J*phi_ddot"])
    assert list(equations.supplied) == expected(found, ["X + chi*cos(phi)", "Y - chi*sin(phi)", "0"])
    rates = dict(zip(equations.positions, equations.rates, strict=True))
    assert [rates["x"], rates["y"]] == expected(found, ["u*cos(phi) - v*sin(phi)", "u*sin(phi) + v*cos(phi)"])
    assert [found.check(name).outcome for name in CHECKED] == [EXACT] * 4


CARRIED = """
mbsym: 1
name: A rotor on a body that is told by unit vectors, on a carrier that turns as prescribed
parameters: {A: positive, B: positive, C: positive, J: positive, I: positive, m: positive, d: real, W: real,
  g: positive}
prescribed: {chi: {rate: W}}
bodies:
  - {name: carrier, attached to: 0, rotation: {axes: [2], angles: [chi]}, connection point: [s, 0, 0],
     coordinates: [s], mass: m, speeds: {w: s_dot + W*s}}
  - name: body
    attached to: carrier
    rotation: {axes: [1, 2, 3], angles: [a, b, c]}
    mass: m
    mass centre: [0, 0, d]
    inertia about: joint
    inertia: [A, B, C]
    speeds: {p: omega1, q: omega2, r: omega3}
    orientation: direction cosines
  - name: rotor
    attached to: body
    rotation: {axes: [1], angles: [phi]}
    connection point: [d, 0, 0]
    mass: m
    inertia about: mass centre
    inertia: [J, I, I]
    speeds: {n: omega1}
loads:
  - uniform gravity: {vector: [0, -g, 0]}
  - damper: {coordinate: phi, coefficient: d**2}
"""


def test_bodies_on_bodies_and_prescribed_motion(tmp_path):
    """Nothing here is in any book: d'Alembert's principle is the judge."""
    found = load(tmp_path, CARRIED)
    assert found.equations.speeds == ("w", "p", "q", "r", "n")
    assert str(dict(zip(found.equations.positions, found.equations.rates, strict=True))["phi"]) == "n - p"
    assert [found.check(name).outcome for name in CHECKED] == [EXACT] * 4


def broken(monkeypatch, target, change):
    module, _, name = target.rpartition(".")
    from importlib import import_module

    parts = module.split(":")
    owner = import_module(f"mbsym.{parts[0]}")
    for part in parts[1:]:
        owner = getattr(owner, part)
    monkeypatch.setattr(owner, name, change(getattr(owner, name)))


def transposed(cosines):
    """R^T, as if it led where R leads."""
    return Tensor(cosines.algebra, cosines.T.rows, cosines.frame, cosines.source)


MISTAKES = {
    "the loads count twice": (
        "mechanics.kane:Kane.of",
        lambda old: lambda self, actions: [2 * x for x in old(self, actions)],
    ),
    "Y' is forgotten": ("mechanics.speeds:SpeedForm.drift", lambda old: lambda self, x: self.ring.zero),
    "Poisson's equations turn the wrong way": (
        "mechanics.speeds:SpeedForm.rates",
        lambda old: property(lambda self: {k: -x if k[-1] in "123" else x for k, x in old.func(self).items()}),
    ),
    "the direction cosines are transposed": (
        "mechanics.speeds.direction_cosines_of",
        lambda old: lambda *given: transposed(old(*given)),
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_planted_mistakes_are_found(tmp_path, monkeypatch, mistake):
    broken(monkeypatch, *MISTAKES[mistake])
    text = PLATE if "Y'" in mistake else CARRIED
    found = load(tmp_path, text)
    for problem in (1, 2, 3):
        found.stage(problem)
    outcomes = [found.check(name).outcome for name in ("kinematics", "equations of motion") if found.check(name)]
    assert FAILED in outcomes


def test_deviations_are_told_in_coordinates_where_these_are_regular(tmp_path):
    """The spinning top stands upright: axes 3, 1, 3 are singular there, 1, 2, 3 are not; the verdict is Lagrange's.

    Of a symmetric one, which may stand so whatever its numbers, the verdict is had in other angles.
    """
    upright = "motion: {psi: 0, theta: 0, phi: {rate: w}}\n"
    text = GYROSTAT.format(told=SPEEDS).replace("m: positive,", "m: positive, w: positive,") + upright
    found = load(tmp_path, text)
    for problem in (4, 5, 6):
        assert found.stage(problem).failure.code == "singular-angles"
    symmetric = text.replace("[x0, y0, z0]", "[0, 0, z0]").replace("inertia: [A, B, C]", "inertia: [A, A, C]")
    symmetric = load(tmp_path, symmetric.replace("    gyrostatic moment: [l1, l2, l3]\n", ""))
    assert symmetric.stage(4).failure.code == "singular-angles"
    assert symmetric.stability.verdict.because(Because.OTHER_ANGLES)
    assert any("udged in other angles" in line for line in terminal.told(symmetric, 6))
    for told in (SPEEDS, POISSON):
        top = GYROSTAT.format(told=told).replace("axes: [3, 1, 3]", "axes: [1, 2, 3]")
        top = top.replace("[x0, y0, z0]", "[0, 0, z0]").replace("inertia: [A, B, C]", "inertia: [A, A, C]")
        top = top.replace("    gyrostatic moment: [l1, l2, l3]\n", "").replace(
            "m: positive,", "m: positive, w: positive,"
        )
        found = load(tmp_path, top + upright)
        assert found.equilibrium.satisfied
        (fast,) = [x for x in found.stability.subsystems if set(x.coordinates) == {"psi", "theta"}]
        slow = expected(found, ["C**2*w**2 - 4*A*m*g*z0"])[0]  # any book on the sleeping top
        assert str(slow.polynomial) in [str(x.condition.polynomial) for x in fast.theory.requirements]
        assert [found.check(name).outcome for name in ("equilibrium", "linearisation", "perturbed motion")] == [
            EXACT
        ] * 3


def test_a_motion_that_is_none_is_refused(tmp_path):
    found = load(tmp_path, GYROSTAT.format(told=POISSON) + "motion: {theta: {value: pi/2}}\n")
    assert not found.equilibrium.satisfied


def test_what_does_not_know_speeds_says_so(tmp_path):
    found = load(tmp_path, GYROSTAT.format(told=SPEEDS))
    assert found.stage_of("told").failure.code == "speeds"


def module_of(found, tmp_path):
    """model.py, imported."""
    from mbsym.report.code.python_module import render

    return imported(filed(tmp_path / "model.py", render(found, (3,))))


@pytest.mark.parametrize("text", [GYROSTAT.format(told=SPEEDS), GYROSTAT.format(told=POISSON), CARRIED])
def test_the_generated_module_gives_the_same_motion_in_speeds(tmp_path, text):
    """d speed_state(x)/dt along rhs, by differences, is speed_rhs: the two right-hand sides share no recursion."""
    module = module_of(load(tmp_path, text), tmp_path)
    rng = np.random.default_rng(7)
    p = dict(zip(module.PARAMETERS, rng.uniform(0.5, 1.5, len(module.PARAMETERS)), strict=True))
    x, t, h = rng.uniform(0.3, 1.2, 2 * len(module.COORDINATES)), 0.7, 1e-5
    rate = module.rhs(t, x, p)
    ahead, behind = (module.speed_state(x + sign * h * rate, p, t + sign * h) for sign in (1, -1))
    y = module.speed_state(x, p, t)
    assert y.shape == (len(module.POSITIONS) + len(module.SPEEDS),)
    assert np.allclose(module.speed_rhs(t, y, p), (ahead - behind) / (2 * h), rtol=1e-7, atol=1e-8)


def test_unit_vectors_pass_where_angles_are_singular(tmp_path):
    """theta = 0: the axes 3, 1, 3 are singular there, and Euler's equations know nothing of it."""
    module = module_of(load(tmp_path, GYROSTAT.format(told=POISSON)), tmp_path)
    p = dict.fromkeys(module.PARAMETERS, 1.0) | {"A": 2.0, "B": 3.0, "C": 4.0}
    y = np.array([1.0, 0, 0, 0, 1.0, 0, 0, 0, 1.0, 0.1, 0.2, 0.3])
    rates = module.speed_rhs(0.0, y, p)
    assert np.allclose(rates[6:9], [-0.2, 0.1, 0.0])
    assert rates[9] == pytest.approx((-(4 - 3) * 0.2 * 0.3 - 0.2 + 0.3 + 1.0 * (0 - 1.0)) / 2)


def test_a_planted_mistake_in_the_program_is_found(tmp_path, monkeypatch):
    from mbsym.mechanics import speed_programs

    old = speed_programs._pairs
    monkeypatch.setattr(speed_programs, "_pairs", lambda *given: old(*given)[:5])  # a moment is lost
    found = load(tmp_path, GYROSTAT.format(told=POISSON))
    assert found.stage(3).failure is None
    assert found.check("straight-line program").outcome == FAILED


INPUT = """
mbsym: 1
name: A torque along an axis of the body
parameters: {A: positive, B: positive, C: positive}
inputs: {M1: {meaning: torque}}
bodies:
  - name: body
    attached to: 0
    rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}
    mass: 0
    inertia about: joint
    inertia: [A, B, C]
    speeds: {p: omega1, q: omega2, r: omega3}
    orientation: {gamma: 3}
loads:
  - torque: {body: body, components: [M1, 0, 0], axes: body}
motion: {theta: {value: pi/4}}
"""


def test_an_input_is_supplied_and_conserves_nothing(tmp_path):
    """A p' + (C - B) q r = M1; no energy, no momentum; x' = A x alone would hide what the input does."""
    found = load(tmp_path, INPUT)
    assert list(found.equations.supplied) == expected(found, ["M1", "0", "0"])
    assert found.equations.kinematic == []
    assert found.integrals == ()
    assert "inputs" in found.stage_of("first_order").failure.reason
    assert [found.check(name).outcome for name in CHECKED] == [EXACT] * 4


def test_a_chain_that_begins_where_all_its_angles_are_singular_keeps_its_budget():
    """At 3-1-3 angles of 0 no choice of the velocities that speeds replace is regular: not all are tried for one."""
    bodies = []
    for k in range(5):
        turn = f"rotation: {{axes: [3, 1, 3], angles: [a{k}, b{k}, c{k}]}}, coordinates: [a{k}, b{k}, c{k}]"
        own = f", speeds: {{p{k}: omega1, q{k}: omega2, r{k}: omega3}}" if k > 2 else ""
        bodies.append(f"  - {{name: B{k}, attached to: {f'B{k - 1}' if k else 0}, {turn}, mass: 1{own}}}\n")
    start = ", ".join(f"{name}{k}: 0" for k in range(5) for name in "abc")
    analysis = mbsym.loads("mbsym: 1\nname: Chain\nbodies:\n" + "".join(bodies) + f"initial: {{{start}}}\n")
    assert {one.name for one in analysis.form.speeds} >= {f"{name}{k}_dot" for k in range(3) for name in "abc"}
    assert analysis.ring.work < analysis.ring.work_budget / 10
