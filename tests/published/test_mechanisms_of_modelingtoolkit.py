"""Mechanisms whose index reduction failed elsewhere (issues 4111, 4115, 4117, 4471 of ModelingToolkit), against
solutions by hand in independent coordinates: pendulums whose bodies are free and tied, turning over; Furuta's; loops.

https://github.com/SciML/ModelingToolkit.jl/issues
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from conftest import system_of
from scipy.integrate import solve_ivp

from mbsym.numerics.closing import closed
from mbsym.numerics.scenario import scenario
from mbsym.simulation import Request, Simulation, simulate

G = 9.81


def run(text: str, time: float) -> Simulation:
    system = system_of("mbsym: 1\n" + text)
    found = simulate(
        closed(scenario(system)).scenario,
        Request(time=time, samples=2, method="dop853", tolerance=1e-12, estimate=False),
    )
    assert found.ended is None
    return found


def by_hand(rates: Callable[[float, Any], Any], start: list[float], time: float) -> Any:
    """The state at the end."""
    found = solve_ivp(rates, (0, time), start, method="DOP853", rtol=1e-12, atol=1e-13)
    assert found.success
    return found.y[:, -1]


#: A bar of length 2 and mass 1 as a body that is free in the plane, held at its end: it turns over at 7 rad/s.
PENDULUM = f"""name: pendulum
bodies:
  - {{name: bar, attached to: 0, connection point: [x, y, 0], coordinates: [x, y, phi], mass: 1,
     rotation: {{axes: [3], angles: [phi]}}, inertia about: mass centre, inertia: [0, 1/3, 1/3]}}
loads: [{{uniform gravity: {{vector: [0, -{G}, 0]}}}}]
constraints: [{{coincide: [{{body: bar, point: [-1, 0, 0]}}, {{body: 0, point: [0, 0, 0]}}]}}]
initial: {{x: 1, y: 0, phi: {{position: 0, velocity: 7}}}}
"""


def test_a_free_bar_that_is_held_at_its_end_turns_over() -> None:
    """(1 + 1/3) phi'' = -g cos(phi): no Cartesian coordinate stays independent in a whole turn."""
    found = run(PENDULUM, 5.0)
    phi, rate = by_hand(lambda _, y: [y[1], -G * np.cos(y[0]) * 3 / 4], [0.0, 7.0], 5.0)
    assert abs(phi) > 2 * np.pi
    assert found["phi"][-1] == pytest.approx(phi, abs=1e-8)
    assert found["phi_dot"][-1] == pytest.approx(rate, abs=1e-8)
    assert found["x"][-1] == pytest.approx(np.cos(phi), abs=1e-8)


#: Two masses 1 and 2 on rods of 1 and 1/2 without mass, by their places alone.
MASSES = f"""name: two masses
bodies:
  - {{name: one, attached to: 0, connection point: [x1, y1, 0], coordinates: [x1, y1], mass: 1}}
  - {{name: two, attached to: 0, connection point: [x2, y2, 0], coordinates: [x2, y2], mass: 2}}
loads: [{{uniform gravity: {{vector: [0, -{G}, 0]}}}}]
constraints:
  - distance: {{between: [{{body: one, point: [0, 0, 0]}}, {{body: 0, point: [0, 0, 0]}}], length: 1}}
  - distance: {{between: [{{body: two, point: [0, 0, 0]}}, {{body: one, point: [0, 0, 0]}}], length: 1/2}}
initial: {{x1: 1, y1: 0, x2: 1, y2: {{position: -1/2, velocity: 0}}}}
"""


def test_two_masses_by_their_places_are_the_double_pendulum() -> None:
    """Angles a, b from the vertical: 3 a'' + cos(a - b) b'' = -sin(a - b) b'^2 - 3 g sin a, and likewise of b."""

    def rates(_: float, s: Any) -> Any:
        a, b, u, v = s
        c, d = np.cos(a - b), np.sin(a - b)
        mass = np.array([[3, c], [c, 1 / 2]])
        right = np.array([-d * v**2 - 3 * G * np.sin(a), d * u**2 - G * np.sin(b)])
        return [u, v, *np.linalg.solve(mass, right)]

    a, b, *_ = by_hand(rates, [np.pi / 2, 0.0, 0.0, 0.0], 3.0)
    found = run(MASSES, 3.0)
    assert found["x1"][-1] == pytest.approx(np.sin(a), abs=1e-6)
    assert found["y1"][-1] == pytest.approx(-np.cos(a), abs=1e-6)
    assert found["x2"][-1] == pytest.approx(np.sin(a) + np.sin(b) / 2, abs=1e-6)


#: An arm of length 1 turns about the vertical; a mass on a rod of 1/2 turns about the arm, or is tied to its end.
ARM = (
    "  - {name: arm, attached to: 0, rotation: {axes: [3], angles: [phi]}, mass: 0, inertia about: joint,"
    " inertia: [0, 0, 2]}"
)
HINGED = (
    "  - {name: rod, attached to: arm, connection point: [1, 0, 0], rotation: {axes: [1], angles: [theta]},"
    " mass centre: [0, 0, 1/2], mass: 1}"
)
FREE = (
    "  - {name: rod, attached to: 0, connection point: [x, y, z], coordinates: [x, y, z, psi, theta],"
    " rotation: {axes: [3, 1], angles: [psi, theta]}, mass centre: [0, 0, 1/2], mass: 1}"
)
TIED = """constraints:
  - coincide: [{body: rod, point: [0, 0, 0]}, {body: arm, point: [1, 0, 0]}]
  - relation: psi = phi
"""


@pytest.mark.parametrize("tied", [False, True], ids=["in joint angles", "free and tied"])
def test_furuta_s_pendulum(tied: bool) -> None:
    """T = (2 + 1 + sin^2(theta)/4) phi'^2/2 - cos(theta) phi' theta'/2 + theta'^2/8,  V = g cos(theta)/2."""

    def rates(_: float, s: Any) -> Any:
        _, theta, w, v = s
        c, d = np.cos(theta), np.sin(theta)
        mass = np.array([[3 + d**2 / 4, -c / 2], [-c / 2, 1 / 4]])
        right = np.array([-d * c * w * v / 2 - d * v**2 / 2, d * c * w**2 / 4 + G * d / 2])
        return [w, v, *np.linalg.solve(mass, right)]

    end = by_hand(rates, [0.3, 0.4, 1.0, 0.0], 2.0)
    start = "x: 0.955336489125606, y: 0.29552020666133955, z: 0, psi: 0.3, " if tied else ""
    text = "\n".join(
        [
            "name: Furuta",
            "bodies:",
            ARM,
            FREE if tied else HINGED,
            f"loads: [{{uniform gravity: {{vector: [0, 0, -{G}]}}}}]",
            *([TIED] if tied else []),
            f"initial: {{{start}phi: {{position: 0.3, velocity: 1}}, theta: {{position: 0.4, velocity: 0}}}}",
        ]
    )
    found = run(text, 2.0)
    assert [found["phi"][-1], found["theta"][-1]] == pytest.approx(end[:2], abs=1e-7)


#: Bars of 1, 2, 3/2 on a ground of 2; the crank turns over in gravity.
LOOP = f"""name: four-bar
bodies:
  - {{name: crank, attached to: 0, rotation: {{axes: [3], angles: [q1]}}, mass centre: [1/2, 0, 0], mass: 1,
     inertia about: mass centre, inertia: [0, 0, 1/12]}}
  - {{name: coupler, attached to: crank, connection point: [1, 0, 0], rotation: {{axes: [3], angles: [q2]}},
     mass centre: [1, 0, 0], mass: 1, inertia about: mass centre, inertia: [0, 0, 1/3]}}
  - {{name: rocker, attached to: 0, connection point: [2, 0, 0], rotation: {{axes: [3], angles: [q3]}},
     mass centre: [3/4, 0, 0], mass: 1, inertia about: mass centre, inertia: [0, 0, 3/16]}}
loads: [{{uniform gravity: {{vector: [0, -{G}, 0]}}}}]
constraints: [{{coincide: [{{body: coupler, point: [2, 0, 0]}}, {{body: rocker, point: [3/2, 0, 0]}}]}}]
dependent: [q2, q3]
initial: {{q1: {{position: 1, velocity: 8}}, q2: -0.6, q3: 1.8}}
"""


def test_a_loop_of_four_bars_turns_over_as_its_crank_alone_says() -> None:
    """h = T + V with all places as functions of the crank's angle: the time of a turn is an integral."""

    def places(q: float) -> Any:
        """Angles of coupler and rocker in space: two circles that meet, above the ground's line."""
        pin = np.array([np.cos(q), np.sin(q)])
        way = np.array([2.0, 0.0]) - pin
        d = np.hypot(*way)
        along = (d**2 + 4 - 2.25) / (2 * d)
        across = np.sqrt(4 - along**2)
        end = pin + (along * way + across * np.array([-way[1], way[0]])) / d
        return np.arctan2(*(end - pin)[::-1]), np.arctan2(*(end - [2.0, 0.0])[::-1])

    def energies(q: float) -> tuple[float, float]:
        """T/q1'^2 and V; rates of the other angles by the velocities of the pin that both carry."""
        b, c = places(q)
        rows = np.array([[-2 * np.sin(b), 1.5 * np.sin(c)], [2 * np.cos(b), -1.5 * np.cos(c)]])
        u, v = np.linalg.solve(rows, [np.sin(q), -np.cos(q)])
        middle = np.array([-np.sin(q) - np.sin(b) * u, np.cos(q) + np.cos(b) * u])
        inertia = 1 / 3 + middle @ middle + u**2 / 3 + 0.75 * v**2
        return inertia / 2, G * (np.sin(q) / 2 + np.sin(q) + np.sin(b) + 0.75 * np.sin(c))

    kinetic, potential = energies(1.0)
    whole = kinetic * 64 + potential

    def rate(_: float, q: Any) -> Any:
        kinetic, potential = energies(q[0])
        return [np.sqrt((whole - potential) / kinetic)]

    found = run(LOOP, 2.0)
    (crank,) = by_hand(rate, [1.0], 2.0)
    assert crank > 1 + 2 * np.pi
    assert found["q1"][-1] == pytest.approx(crank, abs=1e-8)
    coupler, rocker = places(crank)
    assert np.sin(found["q1"][-1] + found["q2"][-1] - coupler) == pytest.approx(0, abs=1e-8)
    assert np.sin(found["q3"][-1] - rocker) == pytest.approx(0, abs=1e-8)


# --- the mechanisms of these issues ---

#: 4115: a rod without mass and a body at its end, told by its place and direction.
PLANAR = """mbsym: 1
name: planar pendulum
bodies:
  - {name: body, attached to: 0, connection point: [x, y, 0], rotation: {axes: [3], angles: [phi]}, mass: 1,
     inertia about: mass centre, inertia: [0, 0, 1/10], coordinates: [x, y, phi]}
loads: [{uniform gravity: {vector: [0, -9.807, 0]}}]
constraints: [{coincide: [{body: body, point: [-1, 0, 0]}, {body: 0, point: [0, 0, 0]}]}]
initial: {x: 1, y: 0, phi: 0}
"""

#: 4471: the same with a second mass, whose own place is tied to the end of the rod.
TWO_MASSES = """mbsym: 1
name: planar pendulum with two masses
bodies:
  - {name: rod, attached to: 0, connection point: [x, y, 0], rotation: {axes: [3], angles: [phi]}, mass: 1,
     inertia about: mass centre, inertia: [0, 0, 1/12], coordinates: [x, y, phi]}
  - {name: bob, attached to: 0, connection point: [u, v, 0], mass: 2, coordinates: [u, v]}
loads: [{uniform gravity: {vector: [0, -9.807, 0]}}]
constraints:
  - coincide: [{body: rod, point: [-1/2, 0, 0]}, {body: 0, point: [0, 0, 0]}]
  - coincide: [{body: rod, point: [1/2, 0, 0]}, {body: bob, point: [0, 0, 0]}]
initial: {x: 1/2, y: 0, phi: 0, u: 1, v: 0}
"""

#: 4111: Furuta's pendulum, its tip a body of its own.
ROTARY = """mbsym: 1
name: Furuta pendulum
bodies:
  - {name: arm, attached to: 0, rotation: {axes: [2], angles: [phi]}, mass centre: [0, 0, 3/10], mass: 1/10,
     inertia about: mass centre, inertia: [3/1000, 3/1000, 0]}
  - {name: rod, attached to: arm, connection point: [0, 0, 6/10], rotation: {axes: [3], angles: [theta]},
     mass centre: [0, 3/10, 0], mass: 1/10, inertia about: mass centre, inertia: [3/1000, 0, 3/1000]}
  - {name: tip, attached to: 0, connection point: [x, y, z], mass: 3/10, coordinates: [x, y, z]}
loads:
  - uniform gravity: {vector: [0, -9.81, 0]}
  - damper: {coordinate: phi, coefficient: 7/100}
  - damper: {coordinate: theta, coefficient: 7/100}
constraints: [{coincide: [{body: rod, point: [0, 6/10, 0]}, {body: tip, point: [0, 0, 0]}]}]
initial: {phi: 0, theta: 1/10, x: -6/10*sin(1/10), y: 6/10*cos(1/10), z: 6/10}
"""

#: 4117: a rhombus of four bars on one pivot, with dampers.
RHOMBUS = """mbsym: 1
name: four bars on a pivot
bodies:
  - {name: b1, attached to: 0, rotation: {axes: [3], angles: [q1]}, mass centre: [3/4, 0, 0], mass: 1,
     inertia about: mass centre, inertia: [0, 0, 3/16]}
  - {name: b2, attached to: b1, connection point: [3/2, 0, 0], rotation: {axes: [3], angles: [q2]},
     mass centre: [0, 3/4, 0], mass: 1, inertia about: mass centre, inertia: [0, 0, 3/16]}
  - {name: b3, attached to: b2, connection point: [0, 3/2, 0], rotation: {axes: [3], angles: [q3]},
     mass centre: [-3/4, 0, 0], mass: 1, inertia about: mass centre, inertia: [0, 0, 3/16]}
  - {name: b4, attached to: 0, rotation: {axes: [3], angles: [q5]}, mass centre: [0, 3/4, 0], mass: 1,
     inertia about: mass centre, inertia: [0, 0, 3/16]}
loads:
  - uniform gravity: {vector: [0, -9.81, 0]}
  - damper: {coordinate: q1, coefficient: 1/10}
  - damper: {coordinate: q2, coefficient: 1/10}
constraints: [{coincide: [{body: b3, point: [-3/2, 0, 0]}, {body: b4, point: [0, 3/2, 0]}]}]
initial: {q1: 1/10, q2: 0, q3: 0, q5: 1/10}
"""


def _swinging(inertia: float, moment: float) -> Any:
    """I phi'' = -moment cos phi, from the horizontal."""
    return lambda _, x: [x[1], -moment / inertia * np.cos(x[0])]


def _furuta(_: float, x: Any) -> Any:
    """T = (P + R sin^2 theta) phi'^2/2 - Q cos theta phi' theta' + R theta'^2/2, V = W cos theta: rods and tip by hand.

    P = m a^2/3 + (m + M) a^2, Q = (m/2 + M) a l, R = (m/3 + M) l^2, W = (m/2 + M) l g with a = l = 0.6.
    """
    _phi, theta, p, q = x
    m, big, a, damping = 0.1, 0.3, 0.6, 0.07
    sine, cosine = np.sin(theta), np.cos(theta)
    P, Q, R = (m / 3 + m + big) * a**2, (m / 2 + big) * a**2, (m / 3 + big) * a**2
    mass = [[P + R * sine**2, -Q * cosine], [-Q * cosine, R]]
    right = [
        -2 * R * sine * cosine * p * q - Q * sine * q**2 - damping * p,
        R * sine * cosine * p**2 + (m / 2 + big) * a * 9.81 * sine - damping * q,
    ]
    return [p, q, *np.linalg.solve(mass, right)]


def _rhombus(_: float, x: Any) -> Any:
    """T = m l^2 (5/6 (a'^2 + b'^2) - sin(b - a) a' b'), V = 2 m g l (sin a + cos b).

    b1 and b3 are along a, b2 and b4 along b; the second damper is between b1 and b2.
    """
    a, b, p, q = x
    size, damping = 1.5, 0.1 / 1.5**2
    c, k = -np.sin(b - a), np.cos(b - a)
    right = [
        k * q**2 - 2 * 9.81 / size * np.cos(a) - damping * (p - (q - p)),
        -k * p**2 + 2 * 9.81 / size * np.sin(b) - damping * (q - p),
    ]
    return [p, q, *np.linalg.solve([[5 / 3, c], [c, 5 / 3]], right)]


@pytest.mark.parametrize(
    ("text", "rates", "start", "end", "angles"),
    [
        (PLANAR, _swinging(1.1, 9.807), (0, 0), 3, ("phi",)),
        (TWO_MASSES, _swinging(1 / 3 + 2, 9.807 * 2.5), (0, 0), 10, ("phi",)),
        (ROTARY, _furuta, (0, 0.1, 0, 0), 5, ("phi", "theta")),
        (RHOMBUS, _rhombus, (0.1, 0.1, 0, 0), 10, ("q1", "q5")),
    ],
    ids=["4115", "4471", "4111", "4117"],
)
def test_what_fails_elsewhere_moves_as_by_hand(
    text: str, rates: Any, start: tuple[float, ...], end: float, angles: tuple[str, ...]
) -> None:
    """Two positions of the pendulums have x = 0 or y = 0, where Cartesian states are singular."""
    wanted = solve_ivp(rates, (0, end), start, "DOP853", rtol=1e-13, atol=1e-14, t_eval=np.linspace(0, end, 41))
    found = simulate(scenario(system_of(text)), Request(end, tolerance=1e-12, samples=41, estimate=False))
    assert found.whole
    for place, name in enumerate(angles):
        assert found[name] == pytest.approx(wanted.y[place], abs=5e-9)
        assert found[f"{name}_dot"] == pytest.approx(wanted.y[place + len(angles)], abs=5e-8)
