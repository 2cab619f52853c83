"""Averages over an ellipse, over several phases, and of traps beside Mathieu's exact borders; formulas by hand."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from conftest import filed, invoked
from scipy.special import mathieu_a, mathieu_b

import mbsym
from mbsym.algebra.failures import NoClosedForm
from mbsym.analysis import Analysis
from mbsym.analysis.averaged import averaged_system, averaging_of
from mbsym.expressions.tree import number
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.orbits.floquet import Word, judged
from mbsym.numerics.scenario import scenario
from mbsym.report.words.expansion_measured import contradicts
from mbsym.simulation.expanded import average_measured as measured

PENDULUM = """
mbsym: 1
name: pendulum on a moving pivot
parameters: {{m: positive, l: positive, g: positive, a: positive, b: positive, nu: positive, om: positive}}
prescribed: {{phi: {{rate: nu}}, psi: {{rate: om}}}}
bodies:
  - name: rod
    connection point: {pivot}
    rotation: {{axes: [3], angles: [theta]}}
    mass centre: [0, -l, 0]
    mass: m
loads:
  - uniform gravity: {{acceleration: g, direction: [0, -1, 0]}}
motion: {{theta: 0}}
values: {{m: 1, l: 1, g: 9.81, a: 0.05, b: 0.03, nu: 200, om: {om}}}
initial: {{theta: 0.3}}
"""
NUMBERS = {"m": 2, "l": 3, "g": 5, "a": 0.7, "b": 0.3, "nu": 11.0, "om": 17.0}


def _pendulum(pivot, om=283):
    text = PENDULUM.format(pivot=pivot, om=om)
    if "psi" not in pivot:
        text = text.replace(", psi: {rate: om}", "").replace(", om: positive", "").replace(f", om: {om}", "")
    return mbsym.loads(text)


def _value(formula, **values):
    expression = formula.to_sympy()
    return float(expression.subs({symbol: values[symbol.name] for symbol in expression.free_symbols}))


@pytest.mark.parametrize(
    ("pivot", "phases", "square"),
    [
        # the component of the pivot's velocity across the rod, (cos theta, sin theta), in the square's mean
        (
            "[b*sin(phi), a*cos(phi), 0]",
            "phi",
            lambda n, s, c: n["nu"] ** 2 * (n["a"] ** 2 * s**2 + n["b"] ** 2 * c**2),
        ),
        ("[b*cos(phi), a*cos(phi), 0]", "phi", lambda n, s, c: n["nu"] ** 2 * (n["a"] * s + n["b"] * c) ** 2),
        (
            "[b*sin(psi), a*cos(phi), 0]",
            ("phi", "psi"),
            lambda n, s, c: (n["a"] * n["nu"] * s) ** 2 + (n["b"] * n["om"] * c) ** 2,
        ),
        (
            "[b*sin(psi), a*cos(phi) + b*cos(2*psi), 0]",
            ("phi", "psi"),
            lambda n, s, c: (n["a"] * n["nu"] * s) ** 2 + (n["b"] * n["om"] * c) ** 2 + (2 * n["b"] * n["om"] * s) ** 2,
        ),
    ],
)
def test_kapitzas_pendulum_on_an_ellipse_and_on_lissajous_figures(pivot, phases, square):
    found = averaging_of(_pendulum(pivot), phases)
    assert dict(found.orders) == {"a": 1, "b": 1}

    def vibrational(theta):
        return _value(found.vibrational, **NUMBERS, theta=theta)

    def by_hand(theta):
        return NUMBERS["m"] * square(NUMBERS, np.sin(theta), np.cos(theta)) / 4

    for theta in (0.4, 1.3, 2.9):  # a constant is left out
        assert vibrational(theta) - vibrational(0.1) == pytest.approx(by_hand(theta) - by_hand(0.1))


@pytest.mark.parametrize(("a", "stable"), [("2/100", False), ("8/100", True)])
def test_upright_an_ellipse_holds_where_a2_less_b2_is_enough(a, stable):
    """(a^2 - b^2) nu^2 > 2 g l, here  a^2 > 9/10^4 + 19.62/4 10^4:  a > 0.0373."""
    text = PENDULUM.format(pivot="[b*sin(phi), a*cos(phi), 0]", om=1).replace(", psi: {rate: om}", "")
    text = text.replace(", om: positive", "").replace(", om: 1", "").replace("theta: 0}\nvalues", "theta: pi}\nvalues")
    loaded = mbsym.loads(text.replace("a: 0.05", f"a: {a}"))
    system = averaged_system(loaded.system, averaging_of(loaded, "phi"))
    assert Analysis(system, (6,)).stability.numerical.word.stable is stable


def test_the_distance_over_two_phases_is_of_first_order():
    loaded = _pendulum("[b*sin(psi), a*cos(phi), 0]")
    found = averaging_of(loaded, ("phi", "psi"))
    told = measured(loaded.system, averaged_system(loaded.system, found), found)
    assert all(abs(order - 1) < 0.25 for order in told.orders)
    assert not contradicts(told)


POINT = """
mbsym: 1
name: a point that is driven by a product of phases
parameters: {{m: positive, v: positive, nu: positive, om: positive}}
prescribed: {{phi: {{rate: nu}}, psi: {{rate: om}}}}
bodies:
  - {{name: P, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: m}}
loads:
  - potential: v*{waves}*x**2/2
motion: {{x: 0}}
values: {{m: 1, v: 400, nu: 90, om: {om}}}
initial: {{x: 1}}
"""


@pytest.mark.parametrize(
    ("waves", "by_hand"),
    [
        # W = v x^2/4 (sin(phi + psi)/(nu + om) + sin(phi - psi)/(nu - om)), V = <(dW/dx)^2>/(2 m)
        ("cos(phi)*cos(psi)", lambda n, o: (1 / (n + o) ** 2 + 1 / (n - o) ** 2) / 16),
        ("sin(phi)*cos(psi)", lambda n, o: (1 / (n + o) ** 2 + 1 / (n - o) ** 2) / 16),
        ("sin(phi)*sin(psi)", lambda n, o: (1 / (n + o) ** 2 + 1 / (n - o) ** 2) / 16),
        ("cos(2*phi)*sin(psi)", lambda n, o: (1 / (2 * n + o) ** 2 + 1 / (2 * n - o) ** 2) / 16),
        ("(cos(phi) + sin(psi))", lambda n, o: (1 / n**2 + 1 / o**2) / 4),
        ("cos(phi + psi)", lambda n, o: 1 / (4 * (n + o) ** 2)),
    ],
)
def test_products_of_phases_by_hand(waves, by_hand):
    found = averaging_of(mbsym.loads(POINT.format(waves=waves, om=37)), ("phi", "psi"), {"v": -1})
    at = _value(found.vibrational, m=2.0, v=3.0, nu=11.0, om=17.0, x=1.0)
    assert at == pytest.approx(9 / 2 * by_hand(11.0, 17.0))


def test_phases_that_do_not_turn_independently_are_refused():
    """cos(phi) cos(psi) of one rate has the mean 1/2 cos(phi_0 - psi_0): it is not of zero mean."""
    with pytest.raises(NoClosedForm, match="do not turn independently"):
        averaging_of(mbsym.loads(POINT.format(waves="cos(phi)*cos(psi)", om=90)), ("phi", "psi"), {"v": -1})


def test_the_command_takes_several_phases(tmp_path):
    path = filed(tmp_path / "pendulum.yaml", PENDULUM.format(pivot="[b*sin(psi), a*cos(phi), 0]", om=283))
    done = invoked("average", path, "--phase", "phi", "--phase", "psi", code=0)
    assert "Averaged over the phases phi, psi." in done.output
    invoked("average", path, code=2)


#: In x the coefficients of Mathieu's equation, phi = 2 tau:  a = 4 u/(m nu^2),  q = 2 v/(m nu^2).
TRAP = """
mbsym: 1
name: a trap
parameters: {{m: positive, u: real, v: positive, nu: positive, wc: real}}
prescribed: {{phi: {{rate: nu}}}}
bodies:
  - {{name: a, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: {mass}}}
{more}
loads:
  - potential: (u + v*cos(phi))*({square})/2
{loads}
motion: {motion}
values: {{m: 1, nu: 2, u: {u}, v: {v}, wc: {wc}}}
"""


def _paul(a, q):
    u, v = (Fraction(round(x * 10**12), 10**12) for x in (a, 2 * q))  # m nu^2 = 4
    return mbsym.loads(
        TRAP.format(mass="m", more="", square="x**2", loads="", motion="{x: 0}", u=u, v=v, wc=0)
    )  # fmt: skip


def _penning(a, q, wc):
    """In axes that turn at wc/2 it is Paul's with  u + m wc^2/4  for u."""
    u, v = (Fraction(round(x * 10**12), 10**12) for x in (a - wc**2 / 4, 2 * q))
    return mbsym.loads(
        TRAP.format(
            mass=0,
            more="  - {name: b, attached to: a, connection point: [0, y, 0], coordinates: [y], mass: m}",
            square="x**2 + y**2",
            loads="  - generalized force: {x: m*wc*y_dot, y: -m*wc*x_dot}",
            motion="{x: 0, y: 0}",
            u=u, v=v, wc=Fraction(wc),
        )
    )  # fmt: skip


def _averaged_word(loaded):
    system = averaged_system(loaded.system, averaging_of(loaded, "phi", {"v": -1}))
    return Analysis(system, (6,)).stability.numerical.word


def _exact_word(loaded):
    return judged(Dynamics(scenario(loaded.system, {name: number(0) for name in loaded.system.coordinates}))).word


@pytest.mark.parametrize("trap", [_paul, lambda a, q: _penning(a, q, 0.5)])
def test_traps_have_the_averaged_border_beside_mathieus(trap):
    """a = -q^2/2 by averaging, Mathieu's a_0 = -q^2/2 + 7 q^4/128 - ...: between them the average may be wrong."""
    q = 0.4
    exact, average = float(mathieu_a(0, q)), -(q**2) / 2
    assert exact - average == pytest.approx(7 * q**4 / 128, rel=0.1)
    middle = (exact + average) / 2
    for a, held, stays in ((average - 1e-3, False, False), (middle, True, False), (exact + 1e-3, True, True)):
        loaded = trap(a, q)
        assert _averaged_word(loaded).stable is held
        assert (_exact_word(loaded) is not Word.UNSTABLE) is stays


def test_without_a_constant_field_a_trap_holds_up_to_mathieus_border():
    """a = 0: the effective potential holds always, the trap where q < 0.908046, at b_1(q) = 0."""
    border = 0.9080463
    assert float(mathieu_b(1, border)) == pytest.approx(0, abs=1e-6)
    for q, stays in ((0.9, True), (0.92, False)):
        loaded = _paul(0, q)
        assert _averaged_word(loaded).stable
        assert (_exact_word(loaded) is not Word.UNSTABLE) is stays
