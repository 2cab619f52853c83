"""model.py of constrained systems against published numbers: accelerations, a trajectory, starts led to constraints."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import mbsym
from mbsym.report.code.python_module import render

ROOT = Path(__file__).parents[2]


@cache
def module_of(name: str) -> ModuleType:
    analysis = mbsym.load(ROOT / "systems" / f"{name}.yaml", (1, 2, 3))
    module = ModuleType(name.replace("-", "_"))
    exec(compile(render(analysis, (1, 2, 3)), name, "exec"), module.__dict__)
    return module


def reference(name: str) -> Any:
    return json.loads((ROOT / "tests" / "references" / f"{name}.json").read_text(encoding="utf-8"))


def test_the_cartesian_pendulum_follows_the_closed_form() -> None:
    """IFToMM A01 at t = 1 and 2, from rest at (-1, 0)."""
    model, wanted = module_of("cartesian-pendulum"), reference("iftomm_a01_pendulum")["reference"]["xy"]
    p = model.complete()
    times, states = model.simulate(2.0, p, samples=3)
    for column, t in enumerate(times):
        if f"{t:g}" in wanted:
            assert states[:2, column] == pytest.approx([float(x) for x in wanted[f"{t:g}"]], abs=1e-8)
    assert max(model.constraint_error(times[-1], states[:, -1], p)) < 1e-8
    # The rod pulls with m (v^2 + g sin)/L inwards: 3 m g sin of the angle below the horizontal, by hand.
    (multiplier,) = model.multipliers(2.0, states[:, -1], p)
    assert -multiplier == pytest.approx(3 * 9.81 * -states[1, -1], rel=1e-7)  # lambda of (r^2 - L^2)/2 is a force per L


def test_the_four_bar_has_the_published_accelerations() -> None:
    model, published = module_of("four-bar"), reference("sympy_four_bar")
    p, start = model.complete(), model.initial_state(model.complete())
    led = model.consistent(start, p)
    assert led[3:] == pytest.approx([float(x) for x in published["parameters"]["u"]], abs=0.3)
    state = [float(x) for key in "qu" for x in published["parameters"][key]]
    assert model.constraint_error(0.0, state, p) == pytest.approx((0, 0), abs=1e-12)
    rates = model.rhs(0.0, state, p)
    assert rates[3:] == pytest.approx([float(x) for x in published["reference"]["accelerations"]], abs=1e-11)
    several = model.rhs(0.0, np.array([state, state]).T, p)
    assert several == pytest.approx(np.array([rates, rates]).T, abs=1e-14)


@pytest.mark.parametrize("case", ["case1", "case2"])
def test_the_rolling_disc_keeps_its_contact_at_rest(case: str) -> None:
    """x and y at the contact follow from the angles' rates, as published; J q'' + gamma = 0."""
    model, published = module_of("rolling-disc"), reference("sympy_rolling_disc")
    yaw, lean, spin, x, y = published["parameters"][case]["q"]
    wanted = [float(value) for value in published["reference"][case]]
    p = model.complete()
    state = np.array([x, y, yaw, lean, spin, *wanted[3:5], *wanted[:3]], dtype=float)
    assert model.constraint_error(0.0, state, p) == pytest.approx((0, 0), abs=1e-13)
    rates = model.rhs(0.0, state, p)
    left = model.constraint_jacobian(state[:5], p) @ rates[5:]
    assert left + model.constraint_acceleration(state[:5], state[5:], p) == pytest.approx([0, 0], abs=1e-12)


def test_a_start_beside_the_constraints_is_led_to_them_or_refused() -> None:
    model = module_of("cartesian-pendulum")
    p = model.complete()
    led = model.consistent([2.0, 0.0, 3.0, 4.0], p)
    assert led == pytest.approx([1, 0, 0, 4])  # the closest place on the circle; the velocity along the rod is lost
    with pytest.raises(RuntimeError, match="no place that keeps the constraints"):
        module_of("four-bar").consistent([0.1, 0.2, 0.3, 0, 0, 0], {**module_of("four-bar").complete(), "l1": 9.0})
    with pytest.raises(np.linalg.LinAlgError):
        model.rhs(0.0, [0.0, 0.0, 0.0, 0.0], p)
