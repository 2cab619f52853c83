"""Enclosures of motions with constraints and quaternions hold the closed forms, to more digits than a float has."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from conftest import invoked
from scipy.integrate import solve_ivp
from truth.test_accuracy_constrained import BALL, SLEIGH

import mbsym


def sleigh(t: Any) -> dict[str, Any]:
    """As in ``test_accuracy_constrained``: theta = (2 k/a)(atan(tanh(s/2)) - ...), w = (V/k)/cosh s, in 40 digits."""
    a, v, k = mpmath.mpf("0.3"), mpmath.mpf("0.5"), mpmath.sqrt(mpmath.mpf("0.59"))
    whole = mpmath.sqrt(v * v + 4 * k * k)
    begun = mpmath.log((whole + v) / (whole - v)) / 2
    s = a * whole * t / k**2 + begun
    theta = 2 * k / a * (mpmath.atan(mpmath.tanh(s / 2)) - mpmath.atan(mpmath.tanh(begun / 2)))
    speed = whole * mpmath.tanh(s)
    along = {"x_dot": speed * mpmath.cos(theta), "y_dot": speed * mpmath.sin(theta)}
    return {"theta": theta, "theta_dot": whole / k / mpmath.cosh(s), **along}


def ball(t: Any) -> dict[str, Any]:
    """e(t) = (cos(w t/2), sin(w t/2) omega/w), x = r omega_y t, y = -r omega_x t."""
    w = mpmath.sqrt(14)
    e = {f"e{k + 1}": mpmath.sin(w * t / 2) * part / w for k, part in enumerate((3, 1, 2))}
    return {"e0": mpmath.cos(w * t / 2), **e, "x": t / 2, "y": -3 * t / 2}


@pytest.mark.parametrize(("text", "truth"), [(SLEIGH, sleigh), (BALL, ball)], ids=["sleigh", "ball"])
def test_the_enclosure_holds_the_exact_solution(text: str, truth: Any) -> None:
    found = mbsym.simulate(mbsym.loads(text), 1, samples=6, certify=1e-12)
    proof = found.certificate
    assert proof is not None
    assert proof.whole
    assert proof.narrow
    names = (*found.system.coordinates, *found.system.velocities)
    with mpmath.workdps(40):
        for k, t in enumerate(found.times.tolist()):
            for name, value in truth(mpmath.mpf(t)).items():
                i = names.index(name)
                apart = abs(value - mpmath.mpf(float(proof.centre[i, k])))
                assert apart <= mpmath.mpf(float(proof.radius[i, k]))
                assert abs(value - mpmath.mpf(float(found.trajectory.states[i, k]))) <= proof.error[i, k]
    assert float(np.max(proof.radius)) < 1e-11  # a state that is wrong by 1e-11 is not in it


def test_a_plan_says_what_is_proved_of_its_run() -> None:
    found = mbsym.simulate(mbsym.loads(SLEIGH), 1, samples=6, accuracy=1e-8, certify=1e-10)
    assert found.plan is not None
    proved = found.plan.bound.proved
    assert proved is not None
    assert proved <= found.plan.bound.total


THREE_BARS = Path(__file__).parents[1] / "cases" / "constraints" / "par3.yaml"


def test_a_third_bar_that_follows_is_named_and_the_hint_works(tmp_path: Path) -> None:
    """Three uprights of m l^2/3 and a beam that does not turn: 2 a'' = -5/2 g cos(a), the same for all bars."""
    text = THREE_BARS.read_text(encoding="utf-8")
    asked = ("--time", "0.1", "--certify", "1e-9", "--out", tmp_path / "out")
    done = invoked("simulate", THREE_BARS, *asked, code=2)
    assert "coincide 2, component 2: this follows from other constraints" in done.stderr
    assert "relation: a = b  for a second 'coincide'" in done.stderr
    head, second = text.index("  - coincide: [{body: h, point: [2, 0, 0]}"), text.index("motion:")
    found = mbsym.simulate(
        mbsym.loads(f"{text[:head]}  - relation: a2 = a1\n{text[second:]}"), 0.1, samples=2, certify=1e-9
    )
    proof = found.certificate
    assert proof is not None
    assert proof.whole
    swing = solve_ivp(
        lambda t, x: [x[1], -1.25 * 9.81 * np.cos(x[0])], [0, 0.1], [-0.1, 0.0], rtol=1e-12, atol=1e-13
    ).y[0, -1]
    for name, sign in (("a0", 1), ("a1", 1), ("a2", 1), ("b", -1)):
        i = found.system.coordinates.index(name)
        assert abs(sign * swing - proof.centre[i, -1]) < 1e-10
        assert proof.radius[i, -1] < 1e-9
