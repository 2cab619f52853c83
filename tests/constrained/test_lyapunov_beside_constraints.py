"""Lyapunov exponents on what constraints allow, where they are known.

* A bob on a rod in Cartesian coordinates, upside down: theta'' = (g/l) theta, exponents +-sqrt(g/l), two of four.
* A car that pulls a light trailer straight ahead: of 2*4 - 2 dimensions four are shifts and steady motions, the others
  decay with th'' = -(m a v/(J + m a^2)) th' and ps' = -(v/d) ps.
* A double pendulum in Cartesian coordinates is the one in angles: the sums of exponents vanish, and the largest ones of
  a small, regular motion are not told from zero.
* A pendulum whose weight depends on where a slider is, which a constraint drives: th'' = -g (1 + a cos w t) sin th, in
  rates without t.
"""

from __future__ import annotations

import numpy as np
import pytest

import mbsym
from mbsym.numerics.orbits.lyapunov import Parting

ROD = """
mbsym: 1
name: A bob on a rod
parameters: {m: {value: 2, sign: positive}, l: {value: 0.5, sign: positive}, g: {value: 9.81, sign: positive}}
bodies:
  - {name: bob, attached to: 0, connection point: [x, 0, z], coordinates: [x, z], mass: m}
loads: [{uniform gravity: {vector: [0, 0, -g]}}]
constraints:
  - distance: {between: [{body: bob, point: [0, 0, 0]}, {body: 0, point: [0, 0, 0]}], length: l}
initial: {x: 0, z: 0.5}
"""

TRAILER = """
mbsym: 1
name: A car with a light trailer
parameters: {m: {value: 2, sign: positive}, J: {value: 0.5, sign: positive}, a: {value: 0.3, sign: positive},
             d: {value: 0.5, sign: nonzero}, v: {value: 1, sign: real}}
bodies:
  - {name: car, attached to: 0, connection point: [x, y, 0], rotation: {axes: [3], angles: [th]},
     mass centre: [a, 0, 0], mass: m, inertia about: mass centre, inertia: [J/2, J/2, J], coordinates: [x, y, th]}
  - {name: trailer, attached to: car, rotation: {axes: [3], angles: [ps]}, mass: 0}
constraints:
  - velocity: x_dot*sin(th) - y_dot*cos(th) = 0
  - velocity: -x_dot*sin(th + ps) + y_dot*cos(th + ps) - d*(th_dot + ps_dot) = 0
initial: {x: {position: 0, velocity: 1}, y: 0, th: 0, ps: 0}
"""

DOUBLE = """
mbsym: 1
name: A double pendulum in Cartesian coordinates
parameters: {m: {value: 1, sign: positive}, g: {value: 9.81, sign: positive}}
bodies:
  - {name: one, attached to: 0, connection point: [x, 0, z], coordinates: [x, z], mass: m}
  - {name: two, attached to: 0, connection point: [u, 0, w], coordinates: [u, w], mass: m}
loads: [{uniform gravity: {vector: [0, 0, -g]}}]
constraints:
  - distance: {between: [{body: one, point: [0, 0, 0]}, {body: 0, point: [0, 0, 0]}], length: 1}
  - distance: {between: [{body: one, point: [0, 0, 0]}, {body: two, point: [0, 0, 0]}], length: 1}
initial: {x: 1, z: 0.01, u: 2, w: 0}
"""

DRIVEN = """
mbsym: 1
name: A pendulum under a driven slider
parameters: {m: {value: 1, sign: positive}, g: {value: 1, sign: positive}, a: {value: 1.5, sign: real},
             w: {value: 2, sign: positive}}
prescribed: {chi: {rate: w}}
bodies:
  - {name: slider, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: m}
  - {name: bob, attached to: 0, rotation: {axes: [3], angles: [theta]}, mass centre: [0, -1, 0], mass: m}
loads: [{potential: -g*(1 + a*cos(x))*cos(theta)}]
constraints: [{relation: x - chi = 0}]
initial: {theta: 1, x: 0}
"""


def measured(tmp_path, text, **request):
    (tmp_path / "system.yaml").write_text(text, encoding="utf-8")
    return mbsym.lyapunov(tmp_path / "system.yaml", **request)


def test_a_rod_upside_down(tmp_path):
    """The tangent map is exp of a constant matrix: the exponents differ from sqrt(g/l) by what is left of log / T."""
    found = measured(tmp_path, ROD, time=40.0)
    rate = np.sqrt(9.81 / 0.5)
    assert found.values == pytest.approx([rate, -rate], abs=0.05)
    late = (found.history[-1, 0] * found.times[-1] - found.history[200, 0] * found.times[200]) / (
        found.times[-1] - found.times[200]
    )
    assert late == pytest.approx(rate, rel=1e-8)
    assert found.sum_error < 1e-9
    assert found.resting
    assert found.parting is Parting.POSITIVE


def test_a_car_that_pulls_a_trailer(tmp_path):
    found = measured(tmp_path, TRAILER, time=60.0)
    assert len(found.values) == 6
    decay = 2 * 0.3 / (0.5 + 2 * 0.3**2)
    assert found.values[:4] == pytest.approx(np.zeros(4), abs=0.25)  # log(T)/T
    rates = np.diff(found.history * found.times[:, None], axis=0)[200:].sum(axis=0) / (
        found.times[-1] - found.times[200]
    )
    assert rates[4:] == pytest.approx([-decay, -1 / 0.5], rel=1e-6)
    assert found.sum_error < 1e-8
    assert found.divergence == pytest.approx(-decay - 2, rel=1e-8)


def test_a_double_pendulum_in_cartesian_coordinates(tmp_path):
    """Its initial state is led to the rods; volumes are kept: of four exponents the sum is 0."""
    found = measured(tmp_path, DOUBLE, time=40.0, tolerance=1e-11)
    assert len(found.values) == 4
    assert found.sum_error < 1e-6
    assert found.values[0] == pytest.approx(-found.values[3], abs=0.25)
    assert found.values[0] > 0.4  # thrown from level: chaotic


def test_a_constraint_that_drives_is_a_time_in_the_equations(tmp_path):
    """Two variables, as those of the pendulum itself: with the slider on a spring they would be four, driven three."""
    found = measured(tmp_path, DRIVEN, time=60.0)
    assert len(found.values) == 2
    assert not found.planar
    assert measured(tmp_path, ROD, time=5.0).planar
