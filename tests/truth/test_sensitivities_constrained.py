"""Derivatives of motions with constraints and quaternions, beside those of the same mechanisms told without them."""

from __future__ import annotations

import numpy as np
import pytest
from truth.independent.scenes import LIGHT as FREE
from truth.test_accuracy_constrained import BALL, LIGHT, SLEIGH, sleigh

import mbsym
from mbsym.algebra.failures import Failure


def test_derivatives_are_those_without_the_constraints() -> None:
    """The dependent coordinates follow a(0) from the first moment on: x = -sin a, dx/da(0) = -cos a da/da(0)."""
    one = mbsym.sensitivities(mbsym.loads(FREE), 2, ["a", "b_dot"], samples=21)
    other = mbsym.sensitivities(mbsym.loads(LIGHT), 2, ["a", "b_dot"], samples=21)
    for name in ("a", "b_dot"):
        for quantity in ("a", "b", "a_dot", "b_dot"):
            size = np.max(np.abs(one[quantity, name]))
            assert other[quantity, name] == pytest.approx(one[quantity, name], abs=1e-7 * size)
    a = other.states[0]
    assert other["x", "a"] == pytest.approx(-np.cos(a) * other["a", "a"], abs=1e-8)
    assert other.error < 1e-7


def test_velocities_that_follow_are_part_of_the_derivative() -> None:
    """x'(0) of a sleigh: d theta/d x'(0) by differences of the closed form; y'(0) follows."""
    found = mbsym.sensitivities(mbsym.loads(SLEIGH), 3, ["x_dot"], samples=4)
    from truth import test_accuracy_constrained as told

    h, ends = 1e-5, []
    for v in (0.5 + h, 0.5 - h):
        whole = np.sqrt(v * v + told.RADIUS**2 * 4)
        begun = 0.5 * np.log((whole + v) / (whole - v))
        s = told.AHEAD * whole * 3 / told.RADIUS**2 + begun
        ends.append(2 * told.RADIUS / told.AHEAD * (np.arctan(np.tanh(s / 2)) - np.arctan(np.tanh(begun / 2))))
    assert sleigh([3.0])["theta"][0] == pytest.approx(sum(ends) / 2, rel=1e-8)
    assert found["theta", "x_dot"][-1] == pytest.approx((ends[0] - ends[1]) / (2 * h), rel=1e-7)


def test_derivatives_by_a_speed_of_what_is_told_by_a_quaternion() -> None:
    """x = r q t: dx/dq = r t, dx/dr of the radius is not told by a parameter; e3 = sin(w t/2) s/w by hand."""
    found = mbsym.sensitivities(mbsym.loads(BALL), 2, ["q", "s"], samples=5)
    t, p, q, s = 2.0, 3.0, 1.0, 2.0
    w = np.sqrt(p * p + q * q + s * s)
    assert found["x", "q"][-1] == pytest.approx(0.5 * t, rel=1e-9)
    assert found["y", "q"][-1] == pytest.approx(0.0, abs=1e-9)
    half, by = w * t / 2, s / w
    expected = by * (np.cos(half) * t / 2 * s / w - np.sin(half) * s / w**2) + np.sin(half) / w
    assert found["e3", "s"][-1] == pytest.approx(expected, rel=1e-8)
    assert found.error < 1e-7  # what rests but for rounding is no error


def test_a_component_that_cannot_change_alone_is_refused() -> None:
    """e0 alone has no derivative: the norm of the quaternion would not be 1."""
    with pytest.raises(Failure, match="no motion begins with another e1 alone: the norm squared of e is"):
        mbsym.sensitivities(mbsym.loads(BALL), 1, ["e1"])


def test_a_parameter_at_the_end_of_its_range_is_differentiated_to_one_side() -> None:
    """x'' = -c x' on a line that a constraint holds: x(t) = v (1 - exp(-c t))/c, dx/dc at c = 0 is -v t^2/2."""
    text = """
mbsym: 1
name: a bead on a line
parameters: {c: {value: 0, sign: nonnegative}}
bodies: [{name: p, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}]
loads: [{rayleigh: c*(x_dot**2 + y_dot**2)/2}]
constraints: [{relation: y - 2*x = 0}]
dependent: [y]
initial: {x: {position: 0, velocity: 1}, y: 0}
"""
    found = mbsym.sensitivities(mbsym.loads(text), 2, ["c"], samples=5)
    assert found["x", "c"][-1] == pytest.approx(-2.0, rel=1e-8)
