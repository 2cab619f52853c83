"""Periodic motions on what constraints allow.

* A bob on a rod in Cartesian coordinates swings as a pendulum does: with amplitude A the period is 4 K(sin(A/2))
  sqrt(l/g), and of its two multipliers both are 1: the motion itself and its energy.
* A bob on a sphere (a rod in space) at the polar angle A turns steadily at W^2 = g/(l cos A), |e| small about it goes
  up and down with  w^2 = W^2 (1 + 3 cos^2 A):  in the period 2 pi/W two of four multipliers are exp(+-2 pi i w/W).
* A disc rolls in a circle while it leans by a and its axle turns at W.  About the point of contact, with the spin n =
  spin' + W sin a, A = m r^2/4, C = m r^2/2,  W x (0, (C + m r^2) n, A W cos a) is the moment of gravity:

      A W^2 sin a cos a - (C + m r^2) n W cos a = m g r sin a
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.special import ellipk

import mbsym
from mbsym.numerics.orbits.periodic import NotFound

ROD = """
mbsym: 1
name: A bob on a rod
parameters: {m: {value: 2, sign: positive}, l: {value: 0.5, sign: positive}, g: {value: 9.81, sign: positive}}
bodies:
  - {name: bob, attached to: 0, connection point: POINT, coordinates: NAMES, mass: m}
loads: [{uniform gravity: {vector: [0, 0, -g]}}]
constraints:
  - distance: {between: [{body: bob, point: [0, 0, 0]}, {body: 0, point: [0, 0, 0]}], length: l}
"""


def found(tmp_path, point, names, initial, period, **more):
    text = ROD.replace("POINT", point).replace("NAMES", names) + f"initial: {initial}\n"
    (tmp_path / "system.yaml").write_text(text, encoding="utf-8")
    return mbsym.orbit(tmp_path / "system.yaml", period, **more).orbit


def test_a_pendulum_in_cartesian_coordinates(tmp_path):
    """The energy of the guess is kept: at rest at 1 rad, begun beside the rod."""
    x, z = 0.5 * np.sin(1.0), -0.5 * np.cos(1.0)
    orbit = found(tmp_path, "[x, 0, z]", "[x, z]", f"{{x: {x * 1.01}, z: {z * 1.01}}}", 1.4)
    amplitude = np.arctan2(*(np.abs(orbit.state[:2])))
    if np.max(np.abs(orbit.state[2:])) > 1e-9:  # the orbit may be entered anywhere: its height from the energy
        height = orbit.state[1] + 0.5 * np.sum(orbit.state[2:] ** 2) / 9.81
        amplitude = np.arccos(-height / 0.5)
    exact = 4 * ellipk(np.sin(amplitude / 2) ** 2) * np.sqrt(0.5 / 9.81)
    assert orbit.period == pytest.approx(exact, rel=1e-10)
    assert orbit.verified < 1e-11
    assert len(orbit.multipliers) == 2
    assert np.abs(orbit.multipliers - 1) == pytest.approx(np.zeros(2), abs=1e-4)
    assert orbit.trivial == 2


def test_a_bob_that_circles_on_a_sphere(tmp_path):
    angle = 0.7
    turn = np.sqrt(9.81 / (0.5 * np.cos(angle)))
    radius = 0.5 * np.sin(angle)
    initial = f"{{x: {radius}, y: {{position: 0, velocity: {radius * turn}}}, z: {-0.5 * np.cos(angle)}}}"
    orbit = found(tmp_path, "[x, y, z]", "[x, y, z]", initial, 2 * np.pi / turn, keep="period")
    assert orbit.verified < 1e-11
    assert len(orbit.multipliers) == 4
    nutation = turn * np.sqrt(1 + 3 * np.cos(angle) ** 2)
    wanted = np.exp(2j * np.pi * nutation / turn)
    apart = [min(abs(mu - w) for mu in orbit.multipliers) for w in (wanted, np.conj(wanted))]
    assert max(apart) < 1e-6
    assert orbit.determinant == pytest.approx(1, abs=1e-8)  # volumes are kept


def disc(tmp_path, lean, turn, spin):
    text = (Path(__file__).parent / "disc.yaml").read_text(encoding="utf-8")
    text = text.replace("m: positive, r: positive, g: positive, w: real", "m: 2, r: 1/2, g: 9.81, w: 3")
    starts = f"yaw: {{position: 0, velocity: {turn}}}, lean: {{position: {lean}, velocity: 1/100}}"
    text += f"initial: {{x: 0, y: 0, {starts}, spin: {{position: 0, velocity: {spin}}}}}\n"
    (tmp_path / "disc.yaml").write_text(text, encoding="utf-8")
    return tmp_path / "disc.yaml"


def test_a_disc_that_rolls_in_a_circle(tmp_path):
    """Its spin comes back by 4.3 revolutions; lean, speed and turn are steady, as they were not in the guess."""
    found = mbsym.orbit(disc(tmp_path, 0.32, 1, -4.3), 6.28, keep="period", turns={"yaw": 1}, shifted=("spin",))
    orbit, values = found.orbit, dict(zip(found.orbit.names, found.orbit.state, strict=True))
    assert orbit.verified < 1e-10
    assert np.ptp(found.states[orbit.names.index("lean")]) < 1e-9
    lean, turn = values["lean"], values["yaw_dot"]
    spin, r, g = values["spin_dot"] + turn * np.sin(lean), 0.5, 9.81
    weighed = r * r * (turn**2 * np.sin(lean) * np.cos(lean) / 4 - 1.5 * spin * turn * np.cos(lean))
    assert weighed == pytest.approx(g * r * np.sin(lean), rel=1e-9)
    assert orbit.turns[orbit.names.index("spin")] == pytest.approx(values["spin_dot"] * orbit.period, rel=1e-9)


def test_what_the_motion_depends_on_has_to_come_back(tmp_path):
    with pytest.raises(NotFound, match="depends on lean"):
        mbsym.orbit(disc(tmp_path, 0.32, 1, -4.3), 6.28, turns={"yaw": 1}, shifted=("lean",))
