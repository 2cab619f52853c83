"""Enclosures of motions with constraints and quaternions hold the closed forms, to more digits than a float has."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest
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
