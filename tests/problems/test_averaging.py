"""Effective potentials of shaken systems against Kapitza, Landau and Lifshitz, and Mathieu's equation."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
import sympy
from conftest import invoked, system_of
from jsonschema import Draft202012Validator
from scipy.integrate import solve_ivp

import mbsym
from mbsym.algebra.failures import NoClosedForm
from mbsym.analysis import Analysis
from mbsym.analysis.averaged import averaged_system, averaging_of
from mbsym.report.schemas import schema
from mbsym.report.words.expansion_measured import contradicts
from mbsym.simulation.expanded import average_measured as measured
from mbsym.source import to_yaml

PENDULUM = """
mbsym: 1
name: Shaken pendulum
parameters:
  m: {{sign: positive}}
  l: {{sign: positive}}
  g: {{sign: positive}}
  a: {{sign: positive}}
  W: {{sign: positive}}
  c: {{sign: nonnegative}}
prescribed: {{phi: {{rate: W}}}}
bodies:
  - name: rod
    connection point: {pivot}
    rotation: {{axes: [3], angles: [theta]}}
    mass centre: [0, -l, 0]
    mass: m
loads:
  - uniform gravity: {{acceleration: g, direction: [0, -1, 0]}}
  - {damper}
motion: {{theta: {theta}}}
values: {{m: 1, l: 1, g: 9, a: 1/10, W: 60, c: 0}}
initial: {{theta: 0.3}}
"""


def _number(formula, **values):
    expression = formula.to_sympy()
    return float(expression.subs({symbol: values[symbol.name] for symbol in expression.free_symbols}))


def _shaken(pivot="[0, a*cos(phi), 0]", damper="damper: {coordinate: theta, coefficient: c}", theta="0"):
    return mbsym.loads(PENDULUM.format(pivot=pivot, damper=damper, theta=theta))


@pytest.mark.parametrize(
    ("pivot", "vibrational"),
    [
        ("[0, a*cos(phi), 0]", lambda s, c: s**2),  # Kapitza: m a^2 W^2 sin(theta)^2/4
        ("[a*cos(phi), 0, 0]", lambda s, c: c**2),  # Landau & Lifshitz, section 30, problem 2
        ("[a*cos(phi), a*sin(phi), 0]", lambda s, c: 1.0),  # in a circle: no direction is preferred
    ],
)
def test_the_effective_potential_of_a_shaken_pendulum(pivot, vibrational):
    found = averaging_of(_shaken(pivot), "phi")
    assert found.small == ("a",)
    numbers = {"m": 2, "l": 3, "g": 5, "a": "1/7", "W": 11}

    def value(formula, theta):
        return _number(formula.subs(numbers), theta=theta)

    for theta in (0.3, 1.1, 2.5):
        by_hand = [2 * (11 / 7) ** 2 * vibrational(np.sin(x), np.cos(x)) / 4 for x in (theta, 0.0)]
        shaken = value(found.vibrational, theta) - value(found.vibrational, 0.0)
        assert shaken == pytest.approx(by_hand[0] - by_hand[1], abs=1e-12)
        whole = value(found.potential, theta) - value(found.potential, 0.0)
        assert whole == pytest.approx(shaken - 30 * (np.cos(theta) - 1), abs=1e-12)


@pytest.mark.parametrize(
    ("theta", "shaken_up", "stable"), [("pi", "1/10", True), ("pi", "1/20", False), ("0", "1/10", True)]
)
def test_upright_it_is_stable_where_a2_W2_exceeds_2_g_l(theta, shaken_up, stable):
    """a W = 6 or 3, 2 g l = 18."""
    analysis = _shaken(theta=theta)
    system = averaged_system(analysis.system, averaging_of(analysis, "phi"))
    lines = to_yaml(system).splitlines()
    lines = [f"  a: {{sign: positive, value: {shaken_up}}}" if line.startswith("  a:") else line for line in lines]
    found = mbsym.loads("\n".join(lines)).stability
    assert (found.numerical.word.value == "stable") == stable


@pytest.mark.parametrize(("rate", "stable"), [(1.06, True), (0.94, False)])
def test_mathieus_equation_agrees_near_the_border(rate, stable):
    """theta'' = (g - a W^2 cos(W t)) theta/l: the monodromy matrix, a = l/100, a W = rate sqrt(2 g l)."""
    g, a = 9.0, 0.01
    W = rate * np.sqrt(2 * g) / a

    def field(t, x):
        return [x[1], (g - a * W**2 * np.cos(W * t)) * x[0]]

    period = 2 * np.pi / W
    columns = [solve_ivp(field, (0, period), x, rtol=1e-11, atol=1e-13).y[:, -1] for x in ([1.0, 0.0], [0.0, 1.0])]
    assert (abs(columns[0][0] + columns[1][1]) < 2) == stable
    condition = averaging_of(_shaken(theta="pi"), "phi").potential  # V'' at theta = pi, from the formula
    there = condition.subs({"m": 1, "l": 1, "g": 9, "a": "1/100"})
    curve = [_number(there, theta=x, W=W) for x in (np.pi - 1e-3, np.pi, np.pi + 1e-3)]
    assert (curve[0] - 2 * curve[1] + curve[2] > 0) == stable


def test_the_distance_is_of_first_order():
    analysis = _shaken(theta="pi")
    found = averaging_of(analysis, "phi")
    told = measured(analysis.system, averaged_system(analysis.system, found), found, 3.0)
    assert all(abs(order - 1) < 0.2 for order in told.orders)
    assert not contradicts(told)


def test_a_planted_mistake_is_seen_by_the_measured_order():
    """With the wrong sign of the vibrational potential the distance does not shrink with eps."""
    analysis = _shaken(theta="pi")
    right = averaging_of(analysis, "phi")
    wrong = replace(right, vibrational=-right.vibrational)
    told = measured(analysis.system, averaged_system(analysis.system, wrong), right, 3.0)
    assert all(order < 0.5 for order in told.orders)
    assert contradicts(told)


@pytest.mark.parametrize(
    ("changed", "reason"),
    [
        ({"damper": "generalized force: {theta: -c*theta_dot**3}"}, "not linear in the velocities"),
        ({"damper": "generalized force: {theta: -c*theta_dot*(2 + sin(phi))}"}, "depends on phi"),
        ({"pivot": "[0, l*cos(phi), 0]"}, "small is not plain"),
    ],
)
def test_other_systems_are_refused_with_the_reason(changed, reason):
    with pytest.raises(NoClosedForm, match=reason):
        averaging_of(_shaken(**changed), "phi")


def test_roots_and_quotients_that_the_phase_does_not_enter_are_no_matter():
    """Potential c/(2 + cos theta), c = 2: V'' = 2/9 beside m g l + m a^2 W^2/2 = 9 + 18 at theta = 0, by hand."""
    found = averaging_of(_shaken(damper="potential: 2/(2 + cos(theta)) + sqrt(3 + theta**2)"), "phi")
    theta = 1e-3
    at = [_number(found.potential, m=1, l=1, g=9, a=0.1, W=60, theta=x) for x in (-theta, 0, theta)]
    # sqrt(3 + theta^2) adds 1/sqrt 3
    assert (at[0] - 2 * at[1] + at[2]) / theta**2 == pytest.approx(27 + 2 / 9 + 3**-0.5, rel=1e-5)


TURNING = """
mbsym: 1
name: Shaken pendulum in a turning plane
parameters: {{m: positive, l: positive, g: positive, a: positive, W: positive, n: real}}
prescribed: {{phi: {{rate: W}}, psi: {{rate: {rate}}}}}
bodies:
  - {{name: frame, attached to: 0, rotation: {{axes: [2], angles: [psi]}}, mass: 0}}
  - {{name: rod, attached to: frame, connection point: [0, a*cos(phi), 0], rotation: {{axes: [3], angles: [theta]}},
     mass centre: [0, -l, 0], mass: m}}
loads:
  - uniform gravity: {{acceleration: g, direction: [0, -1, 0]}}
motion: {{theta: 0}}
values: {{m: 1, l: 1, g: 9, a: 1/10, W: 60, n: 2}}
initial: {{theta: 0.3}}
"""


@pytest.mark.parametrize("rate", ["2", "n"])
def test_a_slow_prescribed_turning_is_not_counted_twice(rate):
    """V = m (-g l cos(theta) + a^2 W^2 sin(theta)^2/4 - l^2 n^2 sin(theta)^2/2), by hand.

    At theta = 0 the square of the frequency is g/l + a^2 W^2/(2 l^2) - n^2 = 9 + 18 - 4 = 23; with the centrifugal
    potential twice it would be 19, and the distance to the motion itself would not shrink.
    """
    analysis = mbsym.loads(TURNING.format(rate=rate))
    found = averaging_of(analysis, "phi")
    at = {"m": 1, "l": 1, "g": 9, "a": 0.1, "W": 60, "n": 2}
    values = [_number(found.vibrational, **at, theta=x) for x in (0.2, 0.7)]
    assert values[1] - values[0] == pytest.approx(9 * (np.sin(0.7) ** 2 - np.sin(0.2) ** 2))
    slow = averaged_system(analysis.system, found)
    assert _number(Analysis(slow).linearisation.K[0, 0], **at) == pytest.approx(23)
    assert measured(analysis.system, slow, found, time=3).orders[-1] > 0.8


def test_gyroscopic_terms_that_are_there_without_shaking_stay():
    """A bead on a turning table that is shaken: a^2 W^2 m/4 holds no x, y: sqrt(k/m) +- n = 3 +- 1/2 remain."""
    analysis = mbsym.loads(
        """
mbsym: 1
name: Bead on a table
parameters: {m: positive, k: positive, a: positive, W: positive, n: positive}
prescribed: {phi: {rate: W}, psi: {rate: n}}
bodies:
  - {name: table, attached to: 0, connection point: [a*cos(phi), 0, 0], rotation: {axes: [3], angles: [psi]}, mass: 0}
  - {name: bead, attached to: table, connection point: [x, y, 0], mass: m, coordinates: [x, y]}
loads:
  - potential: k*(x**2+y**2)/2
motion: {x: 0, y: 0}
values: {m: 1, k: 9, a: 1/10, W: 60, n: 1/2}
"""
    )
    found = averaging_of(analysis, "phi")
    assert found.vibrational.is_zero
    assert str(found.potential) == "(k - m*n**2)*(x**2 + y**2)/2"
    assert averaged_system(analysis.system, found).prescribed[0].name == "psi"


@pytest.mark.parametrize(
    ("load", "reason"),
    [
        ("potential: c*theta*cos(phi)", "U depends on phi also where a = 0"),
        ("generalized force: {theta: c*a*W*theta_dot}", "products of what is small and the rate"),
    ],
)
def test_loads_that_the_averaged_description_would_lose_are_refused(load, reason):
    with pytest.raises(NoClosedForm, match=reason):
        averaging_of(_shaken(damper=load), "phi", ("a",))


def test_a_stiffness_of_the_order_of_the_shaking_is_kept():
    """Potential c a W theta^2/2: of order eps^0, without the phase; V'' = m g l + m a^2 W^2/2 + c a W."""
    analysis = _shaken(damper="potential: 3*a*W*theta**2/2")
    slow = averaged_system(analysis.system, averaging_of(analysis, "phi", ("a",)))
    assert _number(Analysis(slow).linearisation.K[0, 0], m=1, l=1, g=9, a=0.1, W=60) == pytest.approx(9 + 18 + 18)


def test_a_force_of_the_order_of_the_shaking_is_kept():
    """The force c a W = 6 c on theta is of order eps^0, without the phase: V = ... - 6 c theta, its slope at 0."""
    found = averaging_of(_shaken(damper="generalized force: {theta: c*a*W}"), "phi", ("a",)).potential
    at = [_number(found, m=1, l=1, g=9, a=0.1, W=60, c=2, theta=x) for x in (-1e-4, 1e-4)]
    assert (at[1] - at[0]) / 2e-4 == pytest.approx(-12)


@pytest.mark.parametrize(
    ("pivot", "reason"),
    [
        ("[0, a*phi, 0]", "no sine or cosine of phi"),
        ("[0, a*exp(cos(phi)), 0]", "phi in a denominator, root or function"),
    ],
)
def test_a_phase_that_is_not_averaged_is_refused(pivot, reason):
    with pytest.raises(NoClosedForm, match=reason):
        averaging_of(_shaken(pivot=pivot), "phi")


def test_more_has_to_be_small_where_terms_grow():
    with pytest.raises(NoClosedForm, match="grows with the rate"):
        averaging_of(_shaken(), "phi", ("c",))


def test_the_command(tmp_path):
    out = tmp_path / "averaged.yaml"
    done = invoked("average", "systems/shaken-pendulum.yaml", "--out", out, code=0)
    assert "h^2 nu^2 - 2 l g > 0" in done.output
    assert "The averaged motion, not the motion itself, by problem 6" in done.output
    system = system_of(out.read_text())
    assert system.prescribed == ()
    refused = invoked("average", "systems/double-pendulum.yaml", "--small", "q", "--time", "x", code=2)
    assert {"--phase", "--small", "--time"} <= {line.split(":")[0] for line in refused.output.splitlines()}


def test_the_command_without_a_motion(tmp_path):
    path = tmp_path / "shaken.yaml"
    text = PENDULUM.format(pivot="[0, a*cos(phi), 0]", damper="damper: {coordinate: theta, coefficient: c}", theta="0")
    path.write_text(text.replace("motion: {theta: 0}\n", ""))
    done = invoked("average", path, "--time", "0.1", code=0)
    told = (
        "Of the stability of the averaged motion there is no result: the description gives no unperturbed motion (add"
    )
    assert told in " ".join(done.output.split())
    assert "NoResult" not in done.output


def test_a_second_phase_of_the_same_rate_is_refused():
    """Two phases that go together: what psi does would be held as constant in the averages over phi."""
    text = PENDULUM.format(
        pivot="[0, a*cos(phi) + a*cos(psi), 0]", damper="damper: {coordinate: theta, coefficient: c}", theta="0"
    )
    both = mbsym.loads(text.replace("phi: {rate: W}", "phi: {rate: W}, psi: {rate: 2*W}"))
    with pytest.raises(NoClosedForm, match="psi is as fast as phi"):
        averaging_of(both, "phi")


@pytest.mark.parametrize("relation", ["a: l/c", "W: c/a", "g: c*W"])
def test_relations_that_tie_what_is_small_or_large_are_refused(relation):
    """With g = c W gravity would be of order 1/eps, and the effective potential another one."""
    text = PENDULUM.format(pivot="[0, a*cos(phi), 0]", damper="damper: {coordinate: theta, coefficient: 0}", theta="0")
    text = text.replace("values: {m: 1, l: 1, g: 9, a: 1/10, W: 60, c: 0}", "").replace(
        "c: {sign: nonnegative}", "c: positive"
    )
    tied = mbsym.loads(text.replace("motion:", f"relations: {{{relation}}}\nmotion:"))
    with pytest.raises(NoClosedForm, match="is tied by the relation"):
        averaging_of(tied, "phi")


def test_kapitza_s_potential_as_json():
    """m h^2 nu^2 sin(theta)^2/4 and the weight, m g l cos(theta), but for constants (Landau and Lifshitz, 30)."""
    done = invoked("average", "systems/shaken-pendulum.yaml", "--json", "--time", "1", code=0)
    found = json.loads(done.stdout)
    assert list(Draft202012Validator(schema("average")).iter_errors(found)) == []
    theta, added = sympy.Symbol("theta"), sympy.sympify("m*h**2*nu**2*sin(theta)**2/4")
    for key, by_hand in (("vibrational", added), ("potential", added + sympy.sympify("m*g*l*cos(theta)"))):
        assert sympy.simplify(sympy.diff(sympy.sympify(found[key]) - by_hand, theta)) == 0
    assert found["phases"] == ["phi"]
    assert found["rates"] == ["nu"]
    assert found["orders"] == {"h": 1}
    assert found["averaged_motion_at_values"] == "stable"  # upside down: h^2 nu^2 = 36 > 2 g l
    assert len(found["measured"]["distances"]) == len(found["measured"]["parts"])
