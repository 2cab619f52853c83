"""Oscillations about motions whose coefficients are no rational numbers: L4, and a conical pendulum at any angle."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

import mbsym
from mbsym.algebra.failures import NoClosedForm
from mbsym.analysis.oscillating import oscillating
from mbsym.report.words.oscillation_words import measured_sentences
from mbsym.simulation.oscillating import measured_orders

BODIES = Path(__file__).parents[3] / "systems" / "three-bodies.yaml"
CONE = """
mbsym: 1
name: a conical pendulum
parameters: {m: positive, g: positive, l: positive, theta0: positive, w: positive}
bodies:
  - {name: arm, rotation: {axes: [3, 1, 0], angles: [psi, theta, 0]}, mass: m, mass centre: [0, 0, -l]}
loads:
  - uniform gravity: {vector: [0, 0, -g]}
relations: {g: l*w**2*cos(theta0)}
motion: {psi: {rate: w}, theta: theta0}
values: {m: 1, l: 1, w: 1, theta0: 1}
initial: {theta: 1.1, psi: {position: 0, velocity: 1}}
"""


@pytest.mark.parametrize(("which", "sign"), [(1, -1), (2, 1)])
def test_frequencies_about_l4_are_rouths(which, sign):
    """w^4 - w^2 + 27/4 mu (1 - mu) = 0 in units of n; the long-period family stands first.  Measured against runs."""
    analysis = mbsym.load(BODIES)
    found = oscillating(analysis, 1, leading="x", which=which)
    square = found.formula(found.oscillation.frequency * found.oscillation.frequency)
    n, mu = 1.0, 0.01
    routh = (1 + sign * (1 - 27 * mu * (1 - mu)) ** 0.5) / 2
    assert float(square.to_sympy().subs({"n": n, "mu": mu})) == pytest.approx(routh, rel=1e-12)
    assert found.oscillation.verified
    measured = measured_orders(analysis.system, found)
    assert all(order is not None and order > 1.9 for order in measured.orders)


def test_numbers_under_roots_are_those_of_duffing():
    """x'' + w^2 x + e h x^3 = 0: phase' = w + 3 e h a^2/(8 w) - 15 e^2 h^2 a^4/(256 w^3), w^2 = sqrt(2), h = sqrt(3).

    Of x = a cos(phase) + ... with a the amplitude of the first harmonic; of the value at the phase 0 it is -21 for -15.
    """
    text = """
mbsym: 1
name: Duffing's oscillator with roots
parameters: {e: positive}
small parameter: e
bodies:
  - {name: P, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - potential: sqrt(2)*x**2/2 + e*sqrt(3)*x**4/4
"""
    found = oscillating(mbsym.loads(text), 2)
    w, a = 2**0.25, 0.3
    rates = (found.oscillation.frequency, *found.oscillation.corrections)  # the latter in units of the former
    told = [float(found.formula(x).to_sympy().subs(found.symbols["#amplitude"], a).evalf(20)) for x in rates]
    assert told == pytest.approx([w, 3 * 3**0.5 * a**2 / (8 * w**2), -21 * 3 * a**4 / (256 * w**4)], rel=1e-12)
    assert found.oscillation.verified


def test_the_conical_pendulum_sways_with_its_known_frequency():
    """w sqrt(1 + 3 cos^2 theta0) (E. T. Whittaker, section 93); psi' answers by the constant momentum:

    sin^2 theta psi' is constant, so that in first order  psi' = -2 w cos(theta0)/sin(theta0) a cos(phase).
    """
    analysis = mbsym.loads(CONE)
    found = oscillating(analysis, 2)
    letters = {"w": 1.5, "theta0": 0.7, found.symbols["#amplitude"]: 0.3}

    def number(x):
        return float(found.formula(x).to_sympy().subs(letters))

    from math import cos, sin

    assert number(found.oscillation.frequency) == pytest.approx(1.5 * (1 + 3 * cos(0.7) ** 2) ** 0.5, rel=1e-12)
    turning = found.oscillation.series[found.oscillation.names.index("psi_dot")][0].waves
    assert set(turning) == {1}
    assert number(turning[1][0]) == pytest.approx(-2 * 1.5 * cos(0.7) / sin(0.7) * 0.3, rel=1e-12)
    assert number(turning[1][1]) == 0
    measured = measured_orders(analysis.system, found)  # against runs at eps/2, eps/4, ...: of order 3
    assert all(order is not None and order > 2.9 for order in measured.orders)


def test_a_root_whose_sign_is_lost_is_refused():
    """sqrt(k^2 - 2 k + 2) is sqrt(5) at k = 3 and 1 at k = 1, both positive; with k = j^2 + 1 it would need a sign."""
    text = """
mbsym: 1
name: a spring that pulls sideways
parameters: {m: positive, k: positive, b: real}
bodies:
  - {name: one, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
loads:
  - potential: sqrt(b)*x**2*k/2 + x**4
motion: {x: 0}
"""
    analysis = mbsym.loads(text)
    at = oscillating(analysis, 1, {"b": Fraction(4)})
    assert str(at.formula(at.oscillation.frequency * at.oscillation.frequency)) == "2*k/m"
    with pytest.raises(NoClosedForm, match="does not oscillate"):
        oscillating(mbsym.loads(text.replace("sqrt(b)", "-sqrt(b)")), 1, {"b": Fraction(4)})


TIED = """
mbsym: 1
name: a pendulum that a spring with a length of its own ties to a wall
parameters: {m: positive, l: positive, a: positive, k: positive, s: positive}
bodies:
  - {name: rod, attached to: 0, rotation: {axes: [3], angles: [x]}, mass centre: [l, 0, 0], mass: m}
loads:
  - potential: k*(sqrt(l**2 + a**2 - 2*a*l*cos(x)) - s)**2/2
motion: {x: 0}
"""


@pytest.mark.parametrize("longer", ["l", "a"])
def test_the_root_of_a_square_is_not_negative(longer):
    """V = k (r - s)^2/2, r = |l - a| + a l x^2/(2 |l - a|) + ...: m l^2 w^2 = k a l (|l - a| - s)/|l - a|."""
    with pytest.raises(NoClosedForm, match="either sign"):
        oscillating(mbsym.loads(TIED), 1)
    shorter = "al".replace(longer, "")
    at = oscillating(mbsym.loads(TIED + f"assumptions: [{longer} > {shorter}]\n"), 1)
    ring = at.ring
    m, l, a, k, s = (ring.generator("parameter", name) for name in "mlaks")
    size = l - a if longer == "l" else a - l
    square = at.formula(at.oscillation.frequency * at.oscillation.frequency).polynomial
    assert ring.is_zero(ring.times(square, m * l * size) - a * k * (size - s))


LINEAR = """
mbsym: 1
name: two springs
parameters: {k: positive}
bodies: [{name: a, attached to: 0, connection point: [x, y, 0], coordinates: [x, y], mass: 1}]
loads: [{spring: {coordinate: x, stiffness: k}}, {spring: {coordinate: y, stiffness: 4*k}}NONLINEAR]
motion: {x: 0, y: 0}
values: {k: 1}
initial: {x: 1, y: 1}
"""


@pytest.mark.parametrize(("nonlinear", "rounding"), [("", True), (", {potential: x**4}", False)])
def test_errors_that_are_rounding_fall_like_no_power(nonlinear, rounding):
    """x = a cos(sqrt(k) t) is the whole solution: nothing is left that could fall; with x^4 there is more in x."""
    analysis = mbsym.loads(LINEAR.replace("NONLINEAR", nonlinear))
    found = oscillating(analysis, 2, leading="x")
    measured = measured_orders(analysis.system, found)
    orders = dict(zip(measured.names, measured.orders, strict=True))
    assert (orders["x"] is None) is rounding
    assert orders["y"] is None  # nothing drives it
    lines = [one.text for one in measured_sentences(found, measured)]
    assert any("no more than rounding" in one for one in lines)
    assert any("fall like its powers" in one for one in lines) is not rounding
