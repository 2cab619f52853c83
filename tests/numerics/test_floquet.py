"""Periodic first approximations against Mathieu's functions, Kapitza's pendulum and constant coefficients."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED, filed, invoked
from flint import arb, arb_mat, ctx
from jsonschema import Draft202012Validator
from scipy.special import mathieu_a, mathieu_b

import mbsym
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.orbits import floquet
from mbsym.numerics.orbits.floquet import (
    Judged,
    NotPeriodic,
    Word,
    common_frequency,
    enclosed,
    jacobian_on_motion,
    judged,
)
from mbsym.numerics.orbits.variational import Flow
from mbsym.numerics.scenario import scenario
from mbsym.report.schemas import schema
from mbsym.simulation import read_values

FORCED = """
mbsym: 1
name: A particle in a field that changes with time
parameters: {a: real, q: real, d: real}
bodies:
  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - generalized force: {x: FORCE}
motion: {x: 0}
values: {a: 1, q: 0.2, d: 0}
initial: {x: 1}
"""
TRAP = """
mbsym: 1
name: Ion in a quadrupole trap
parameters: {V: positive, nu: positive}
prescribed: {tau: {rate: nu}}
bodies:
  - {name: ion, attached to: 0, connection point: [x, y, z], mass: 1, coordinates: [x, y, z]}
loads:
  - potential: V*cos(tau)*(x**2 + y**2 - 2*z**2)/2
motion: {x: 0, y: 0, z: 0}
values: {V: VOLTAGE, nu: 40}
initial: {x: 0, y: 0, z: 0}
"""
MATHIEU = FORCED.replace("FORCE", "-(a - 2*q*cos(2*t))*x - d*x_dot")
SHAKEN = SHIPPED / "shaken-pendulum.yaml"


def dynamics(text: str | Path, **values: Any) -> Dynamics:
    system = (mbsym.load(text) if isinstance(text, Path) else mbsym.loads(text)).system
    exact = {name: Fraction(value) for name, value in values.items()}
    return Dynamics(scenario(system, read_values(system, exact)))


def verdict(text: str | Path, **values: Any) -> Word:
    return judged(dynamics(text, **values)).word


@pytest.mark.parametrize(
    ("border", "below", "above"),
    [
        (mathieu_a(0, 0.2), Word.UNSTABLE, Word.STABLE),
        (mathieu_b(1, 0.2), Word.STABLE, Word.UNSTABLE),
        (mathieu_a(1, 0.2), Word.UNSTABLE, Word.STABLE),
        (mathieu_b(2, 0.2), Word.STABLE, Word.UNSTABLE),
        (mathieu_a(2, 0.2), Word.UNSTABLE, Word.STABLE),
    ],
)
def test_the_borders_of_ince_and_strutt(border: float, below: Word, above: Word) -> None:
    """x'' + (a - 2 q cos 2t) x = 0 changes its stability at Mathieu's characteristic values, at q = 0.2 to 1e-8."""
    assert verdict(MATHIEU, a=border - 1e-8, q=0.2) is below
    assert verdict(MATHIEU, a=border + 1e-8, q=0.2) is above


@pytest.mark.parametrize(("voltage", "word"), [("363.2", Word.STABLE), ("363.3", Word.UNSTABLE)])
def test_a_quadrupole_trap_has_the_border_of_mathieu_s_equation(voltage: str, word: Word) -> None:
    """Paul's trap without direct voltage: along the axis q = 4 V/(m nu^2), held for q < 0.90805 (a_0(q) = 0).

    The two radial coordinates have equal multipliers; nothing couples them, so that is no resonance.
    """
    assert verdict(TRAP.replace("VOLTAGE", voltage)) is word


def test_equal_multipliers_of_coordinates_that_are_coupled_decide_nothing() -> None:
    """y'' + f(t) y = -x with x'' + f(t) x = 0: driven at its own frequency y grows like t, which is not stable."""
    driven = TRAP.replace("VOLTAGE", "60").replace("motion:", "  - generalized force: {y: -x}\nmotion:")
    assert verdict(driven) is Word.UNDECIDED


def test_nothing_is_left_open_where_there_are_no_terms_of_higher_order() -> None:
    """Mathieu's equation is linear: bounded solutions are stability.  With -x^3 the same multipliers leave it open."""
    cubic = FORCED.replace("FORCE", "-(a - 2*q*cos(2*t))*x - x**3")
    assert verdict(MATHIEU, a=2, q=0.1) is Word.STABLE
    assert verdict(cubic.replace("d: real", "").replace("q: real, ", "q: real").replace(", d: 0", ""), a=2, q=0.1) is (
        Word.STABLE_FIRST_APPROXIMATION
    )


def test_damping_moves_the_border() -> None:
    """Inside the first tongue |a - 1| < q undamped; with damping d it begins where q > d about (a = 1)."""
    assert verdict(MATHIEU, a=1, q=0.1, d=0.05) is Word.UNSTABLE
    assert verdict(MATHIEU, a=1, q=0.1, d=0.2) is Word.ASYMPTOTICALLY_STABLE
    assert verdict(MATHIEU, a=2, q=0.1, d=-0.01) is Word.UNSTABLE


def test_the_pendulum_of_kapitza() -> None:
    """Upright it is held if h nu > about sqrt(2 g l): nu = 44.3 at h = 0.1, l = 1, to within a few percent."""
    assert verdict(SHAKEN, nu=42) is Word.UNSTABLE
    assert verdict(SHAKEN, nu=47) is Word.STABLE_FIRST_APPROXIMATION
    assert verdict(SHAKEN, nu=47, c=0.1) is Word.ASYMPTOTICALLY_STABLE


def test_the_enclosure_contains_the_flow() -> None:
    """The variational equations integrated in floating point: another program, another method."""
    system = dynamics(MATHIEU, a=3, q=1)
    found: Judged = judged(system)
    period = float(found.period.mid())
    _, phi = Flow(system, 1e-14).passage([0.0, 0.0], 0.0, period)
    for i, row in enumerate(found.monodromy.tolist()):
        for j, entry in enumerate(row):
            assert float(entry.rad()) < 1e-12
            assert abs(float(entry.mid()) - phi[i, j]) < 1e-11 * np.max(np.abs(phi))
    assert found.monodromy.det().contains(1)


def test_nothing_is_said_without_ground() -> None:
    """Coefficients that are constant, not periodic, singular, or jump; a motion that is none."""
    for force, told in (
        ("-a*x", "constant"),
        ("-(a + t*q)*x", "not periodic"),
        ("-(a + q*cos(t**2))*x", "not periodic"),
        ("-a*(x - 1)*(2 + cos(t))", "motion is none"),
        ("-a*x/cos(t)", "may be singular"),
        ("-a*x - q*sign(x_dot)", "sign, abs or step"),  # not "constant": problem 6 has no answer, either
    ):
        with pytest.raises(NotPeriodic, match=told):
            verdict(FORCED.replace("FORCE", force))


@pytest.mark.parametrize(
    ("force", "word"),
    [
        # x' = c exp(-q sin(2 t)/2) stays near 0, x drifts; with a mean of 1/2 x' decays, with -1/2 it grows
        ("-q*cos(2*t)*x_dot", Word.STABLE_BUT_CYCLIC),
        ("-q*cos(2*t)*x_dot - q*sin(2*t)**2*x_dot + q*x_dot/2", Word.STABLE_BUT_CYCLIC),
        ("-(1/2 + q*cos(2*t))*x_dot", Word.STABLE),
        ("(1/2 + q*cos(2*t))*x_dot", Word.UNSTABLE),
        # with x'^3 the rates still decay, and no more is said: of what x comes to rest at nothing is
        ("-(1/2 + q*cos(2*t))*x_dot - x_dot**3", Word.ASYMPTOTIC_BUT_CYCLIC),
        ("-q*cos(2*t)*x_dot - x_dot**3", Word.UNDECIDED),
        # tr J = -q cos(t) has no mean: the product of the multipliers is 1; a mean of 1e-9 is seen, whichever sign
        ("-x/3 - q*cos(t)*x_dot", Word.STABLE),
        ("-x/3 - q*cos(t)**2*x_dot + q*(cos(2*t) + 1)/2*x_dot + q*cos(t)*x_dot", Word.STABLE),
        ("-x/3 - (q*cos(t) + 1e-9)*x_dot", Word.ASYMPTOTICALLY_STABLE),
        ("-x/3 - (q*cos(t) - 1e-9)*x_dot", Word.UNSTABLE),
        ("-x/3 - q*cos(t)*x_dot - x**3", Word.STABLE_FIRST_APPROXIMATION),
        # at x'' + x the first resonance of q cos(2 t) opens: no mean does not make it stable
        ("-x - q*cos(2*t)*x_dot", Word.UNSTABLE),
    ],
)
def test_friction_without_a_mean(force: str, word: Word) -> None:
    assert verdict(FORCED.replace("FORCE", force)) is word


def test_a_cyclic_coordinate_has_the_multiplier_one_twice() -> None:
    """phi' = p, p' = 0: a Jordan block of 1, exact; Lagrange's top beside it has four simple ones on the circle."""
    found = judged(dynamics(SHIPPED / "heavy-top.yaml"))
    ones = [one for one in found.multipliers if one.ball.contains(1)]
    assert [one.ball == 1 for one in ones] == [True, True]
    assert len(found.multipliers) == 6
    assert all(one.on_circle for one in found.multipliers)
    assert not found.simple
    assert found.word is Word.UNDECIDED  # z = v t


def test_multipliers_that_are_not_isolated_are_bounded() -> None:
    """A full matrix with a Jordan block of 2: no ball is small, and all contain it."""
    into = arb_mat(3, 3, [1, 1, 0, 1, 2, 1, 3, 0, 1])
    with ctx.workprec(floquet.BITS):
        matrix = into * arb_mat(3, 3, [2, 1, 0, 0, 2, 0, 0, 0, 0.5]) * into.inv()
        found, simple = floquet._multipliers(matrix, True, lambda part: True)
    assert not simple
    for exact in (2, 2, 0.5):
        assert any(one.ball.contains(exact) for one in found)
    assert all(one.greatest >= 2 and one.least < 1 and not one.on_circle for one in found)


def test_periods_are_read_from_the_program() -> None:
    code, rests = jacobian_on_motion(dynamics(FORCED.replace("FORCE", "-(a + q*cos(3*t/2) + q*exp(sin(t + 1)))*x")))
    assert rests
    assert common_frequency(code) == Fraction(1, 2)


def low_order(order: int) -> tuple[arb_mat, arb_mat]:
    """The monodromy matrix with so few terms that the remainder counts, and a good one."""
    code, _ = jacobian_on_motion(dynamics(MATHIEU, a=3, q=1))
    with ctx.workprec(192):
        period = arb.pi()
        return enclosed(code, period, 2, order)[0], enclosed(code, period, 2)[0]


def test_the_remainder_is_what_makes_it_an_enclosure(monkeypatch: pytest.MonkeyPatch) -> None:
    coarse, good = low_order(3)
    assert coarse.overlaps(good)
    assert all(a.contains(b) for a, b in zip(coarse.entries(), good.entries(), strict=True))
    monkeypatch.setattr(floquet, "remainder", lambda code, start, step, size, order: arb_mat(size, size))
    coarse, _ = low_order(3)
    assert not coarse.overlaps(good)


def test_a_transposed_jacobian_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    matrices = floquet._matrices
    monkeypatch.setattr(floquet, "_matrices", lambda *given: [one.transpose() for one in matrices(*given)])
    with pytest.raises(AssertionError):
        test_the_enclosure_contains_the_flow()


def test_the_command(tmp_path: Path) -> None:
    done = invoked("floquet", SHAKEN, "--out", tmp_path, code=0)
    assert "of the motion itself that proves nothing" in done.output
    content = json.loads((tmp_path / "floquet.json").read_text())
    Draft202012Validator(schema("floquet")).validate(content)
    assert content["verdict"] == "stable_first_approximation"
    assert content["frequency"] == "60"
    done = invoked("floquet", SHIPPED / "double-pendulum.yaml", "--out", tmp_path, code=1)
    assert "constant" in done.output


def test_constant_at_these_values_only(tmp_path: Path) -> None:
    """Where q = 0 problem 6 knows the coefficients as varying in symbols; with the relation that is told it judges."""
    path = tmp_path / "mathieu.yaml"
    text = """mbsym: 1
name: damped Mathieu
parameters: {d: nonnegative, a: real, q: real}
prescribed: {phi: 1}
bodies:
  - {name: p, attached to: 0, mass: 1, connection point: [x, 0, 0], coordinates: [x]}
loads:
  - generalized force: {x: "-(a + q*cos(2*phi))*x - d*x_dot"}
motion: {x: 0}
"""
    path.write_text(f"{text}values: {{d: 0, a: 1, q: 0}}\n")
    done = invoked("floquet", path, code=1)
    assert "with 'relations: {q: 0}' in place of these values" in " ".join(done.output.split())
    path.write_text(f"{text}values: {{d: 0, a: 1}}\nrelations: {{q: 0}}\n")
    assert mbsym.load(path).stability.numerical.word == "stable"


def test_no_initial_state_is_asked_for(tmp_path: Path) -> None:
    """It is the unperturbed motion that is judged."""
    path = filed(tmp_path / "mathieu.yaml", MATHIEU.replace("initial: {x: 1}\n", ""))
    invoked("floquet", path, "--out", tmp_path / "out", code=0)
    assert mbsym.floquet(path).word is verdict(MATHIEU)
