"""Steady motions whose velocities constraints tie: closed formulas, the bicycle's circles, and where there are none."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import mbsym
from mbsym.analysis.resting import relative_equilibria
from mbsym.mechanics.rest import Value, given_values
from mbsym.problems.relative_equilibria.equilibria import Equilibria
from mbsym.problems.stability.words import Word
from mbsym.source import read

SYSTEMS = Path(__file__).parent.parent.parent / "systems"


def listed(text: str, **values: Value) -> Equilibria:
    system, complaints = read(text)
    assert system is not None, list(complaints)
    return relative_equilibria(system, given_values(system, values))


def shipped(name: str, *changes: tuple[str, str]) -> str:
    text = (SYSTEMS / f"{name}.yaml").read_text(encoding="utf-8")
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def column(equilibria: Equilibria, name: str) -> list[float]:
    return sorted(x.value for each in equilibria.equilibria for x in each.values if x.name == name)


@pytest.mark.parametrize(("yaw", "spin"), [(2.0, -4.609204094), (3.0, 2.0), (1.0, -40.0), (6.0, 1.0)])
def test_all_circles_of_a_rolling_disc(yaw: float, spin: float) -> None:
    """Moments about the contact, with the disc's m r^2/4 and m r^2/2 (Neimark & Fufaev, chapter III), times 4/(m r):

    6 r w W cos L + 5 r W^2 sin L cos L + 4 g sin L = 0.
    """
    r, g, w = 0.5, 9.81, spin
    angles = np.linspace(-math.pi, math.pi, 20_001) + 1e-5
    moment = 6 * r * w * yaw * np.cos(angles) + (5 * r * yaw**2 * np.cos(angles) + 4 * g) * np.sin(angles)
    roots = angles[:-1][moment[:-1] * moment[1:] < 0]
    text = shipped("rolling-disc-in-a-circle", ("w: {sign: real, meaning: spin}", f"w: {{value: {spin}}}"))
    text = text.replace("relations: {w: -5*W*sin(L)/6 - 2*g*sin(L)/(3*r*W*cos(L))}\n", "").replace(
        "value: 2,", f"value: {yaw},"
    )
    found = listed(text)
    assert found.complete
    assert column(found, "lean") == pytest.approx(list(roots), abs=1e-3)


def test_the_disc_of_the_description_is_among_them() -> None:
    """And it is judged as problem 6 does, by another route: a first approximation in the coordinates."""
    found = listed(shipped("rolling-disc-in-a-circle"))
    described = next(x for x in found.equilibria if x.values[0].text == "pi/6")
    judged = mbsym.load(SYSTEMS / "rolling-disc-in-a-circle.yaml").stability.numerical
    assert judged is not None
    assert described.verdict.word is judged.word is Word.STABLE_BUT_CYCLIC


@pytest.mark.parametrize(("w", "word"), [(5, Word.STABLE_BUT_CYCLIC), (1, Word.UNSTABLE)])
def test_an_upright_disc_needs_its_critical_spin(w: int, word: Word) -> None:
    """w^2 > g/(3 r) = 12.6 (Neimark & Fufaev, chapter V); below the ground, lean = pi, it is a pendulum and hangs."""
    found = listed(shipped("rolling-disc", ("w: 5}", f"w: {w}}}")))
    words = {x.values[0].text: x.verdict.word for x in found.equilibria}
    assert words == {"0": word, "pi": Word.STABLE_BUT_CYCLIC}


SLOPE = (("vector: [0, 0, -g]", "vector: [3, 0, -4]"), ("g: {sign: positive, meaning", "g: {value: 4, meaning"))


def test_on_a_slope_a_disc_rolls_steadily_along_horizontal_lines_alone() -> None:
    """Gravity (3, 0, -4): its plane upright, tan lean = -+3/4, along y or against it; downhill it rolls ever faster."""
    text = shipped("rolling-disc", *SLOPE).replace("g: 9.81, ", "")
    places = {tuple(round(x.value, 6) for x in each.values) for each in listed(text).equilibria}
    lean = math.atan2(3, 4)
    expected = {
        (math.pi / 2, -lean),
        (math.pi / 2, math.pi - lean),
        (-math.pi / 2, lean),
        (-math.pi / 2, lean - math.pi),
    }
    assert places == {tuple(round(x, 6) for x in place) for place in expected}
    downhill = text.replace("motion: {lean: 0,", "motion: {yaw: 0, lean: 0,").replace("angles: [yaw]", "angles: [yaw]")
    fixed = downhill.replace("constraints:\n", "constraints:\n  - relation: yaw = 0\n")
    assert listed(fixed).equilibria == ()


def test_a_snakeboard_circles_with_its_trucks_turned() -> None:
    """y' = 0 and l theta' = -v tan phi at theta = 0, for every phi: a family; straight on where theta is to rest."""
    told = listed(shipped("snakeboard", ("motion: {x: {rate: v}, theta: 0,", "motion: {x: {rate: v},")))
    (family,) = told.families
    place = {x.name: x.value for x in family.sample}
    assert family.dimension == 1
    assert place["theta_dot"] == pytest.approx(-math.tan(place["phi"]) / 0.2)
    assert place["y_dot"] == 0
    assert column(listed(shipped("snakeboard")), "phi") == pytest.approx([0, math.pi])
    table = mbsym.equilibria(SYSTEMS / "snakeboard.yaml").table
    assert list(table["y_dot"]) == [0, 0]


@pytest.mark.parametrize(("driven", "rate"), [("a", "w"), ("b", "2*w")])
def test_a_governor_behind_a_gear(driven: str, rate: str) -> None:
    """b = 2 a, cos q = g/(l b'^2) = 10/16 where b' = 4, whichever of them is given."""
    text = f"""
mbsym: 1
name: Governor
parameters: {{w: {{value: 2}}}}
bodies:
  - {{name: wheel, attached to: 0, rotation: {{axes: [3], angles: [a]}}, mass: 0, inertia about: joint,
     inertia: [0, 0, 2]}}
  - {{name: shaft, attached to: 0, rotation: {{axes: [3], angles: [b]}}, mass: 0, inertia about: joint,
     inertia: [0, 0, 1]}}
  - {{name: arm, attached to: shaft, rotation: {{axes: [2], angles: [q]}}, mass: 1, mass centre: [0, 0, -1],
     inertia about: mass centre, inertia: [0, 0, 0]}}
loads: [{{uniform gravity: {{vector: [0, 0, -10]}}}}]
constraints: [{{relation: b = 2*a}}]
motion: {{{driven}: {{rate: {rate}}}, q: 0}}
"""
    found = listed(text)
    words = {round(x.values[-1].value, 6): x.verdict.word for x in found.equilibria}
    q = round(math.acos(10 / 16), 6)
    up, down = Word.UNSTABLE, Word.STABLE_BUT_CYCLIC
    assert words == {q: down, -q: down, 0: up, round(math.pi, 6): up}


AXLE = """
mbsym: 1
name: Axle
parameters:
  {a: {value: 0.1}, b: {value: 1/3}, r: {value: 1/4}, w: {value: W_LEFT}, u: {value: W_RIGHT}}
bodies:
  - name: frame
    attached to: 0
    connection point: [x, y, r]
    rotation: {axes: [3], angles: [theta]}
    mass centre: FORWARDS
    mass: 2
    inertia about: mass centre
    inertia: [1/2, 1/2, 1/2]
    coordinates: [x, y, theta]
  - {name: left, attached to: frame, connection point: LEFT, rotation: {axes: [TURNED], angles: [p]}, mass: 1,
     inertia about: mass centre, inertia: INERTIA}
  - {name: right, attached to: frame, connection point: RIGHT, rotation: {axes: [TURNED], angles: [q]}, mass: 1,
     inertia about: mass centre, inertia: INERTIA}
constraints:
  - rolling: {body: left, point: [0, 0, -r], axes: frame, on: ground}
  - rolling: {body: right, point: [0, 0, -r], axes: frame, on: ground}
motion: {p: {rate: ROLL*w}, q: {rate: ROLL*u}}
"""


@pytest.mark.parametrize(
    "axle",
    [
        {"FORWARDS": "[a, 0, 0]", "LEFT": "[0, b, 0]", "RIGHT": "[0, -b, 0]", "TURNED": "2", "ROLL": "1",
         "INERTIA": "[1/16, 1/8, 1/16]"},
        {"FORWARDS": "[0, a, 0]", "LEFT": "[-b, 0, 0]", "RIGHT": "[b, 0, 0]", "TURNED": "1", "ROLL": "-1",
         "INERTIA": "[1/8, 1/16, 1/16]"},
    ],
)  # fmt: skip
@pytest.mark.parametrize(
    ("rates", "words"),
    [((2, 2), {Word.ASYMPTOTIC_BUT_STEADY}), ((-2, -2), {Word.UNSTABLE}), ((2, 3), set()), ((-2, 2), set())],
)
def test_two_wheels_on_an_axle(axle: dict[str, str], rates: tuple[int, int], words: set[Word]) -> None:
    """v' = a W^2 and I W' = -m a v W, W = (u - w) r/(2 b): straight on alone, as a sleigh, whichever axis is forwards.

    At theta = 0 other rows are independent along the one axis than along the other.
    """
    text = AXLE.replace("W_LEFT", str(rates[0])).replace("W_RIGHT", str(rates[1]))
    for word, entry in axle.items():
        text = text.replace(word, entry)
    found = listed(text)
    assert found.complete
    assert {x.verdict.word for x in found.equilibria} == words


def test_of_a_sleigh_that_moves_no_position_is_told_to_be_one_of_rest() -> None:
    for v, rests in ((1, False), (0, True)):
        found = listed(shipped("chaplygin-sleigh", ("a: 0.3, v: 1", f"a: 0.3, v: {v}")))
        assert ("every position is an equilibrium" in found.remarks) is rests


def test_a_ball_that_circles_in_a_vertical_cylinder() -> None:
    """At constant height J W s = -m g r for its spin s about the outward normal (Neimark & Fufaev, chapter II).

    About the vertical it turns at -W l/r, by the arm at W less; gamma is the angle about the axis of the sum.
    """
    J, W, l, r, mg = 1 / 250, 3, 1 / 2, 1 / 10, 9.81
    spin = math.hypot(mg * r / (J * W), W * l / r + W)
    found = listed(f"""
mbsym: 1
name: Ball
bodies:
  - {{name: arm, attached to: 0, rotation: {{axes: [3], angles: [phi]}}, mass: 0, connection point: [0, 0, z],
     coordinates: [phi, z]}}
  - name: ball
    attached to: arm
    connection point: [{l}, 0, 0]
    rotation: {{axes: [1, 2, 3], angles: [alpha, beta, gamma]}}
    mass: 1
    inertia about: joint
    inertia: [{J}, {J}, {J}]
loads: [uniform gravity: {{vector: [0, 0, -{mg}]}}]
constraints: [rolling: {{body: ball, point: [{r}, 0, 0], axes: arm, on: ground}}]
motion: {{phi: {{rate: {W}}}}}
""")
    axis = math.asin(mg * r / (J * W) / spin)
    assert sorted(map(abs, column(found, "gamma_dot"))) == pytest.approx([spin] * 4)
    assert sorted(map(math.sin, column(found, "beta"))) == pytest.approx([-math.sin(axis)] * 2 + [math.sin(axis)] * 2)


def test_the_circles_of_the_bicycle() -> None:
    """Hands-free circular motions (Basu-Mandal et al. 2007), of which a part with the handlebar reversed is stable.

    Each is one: integrated for a second by the compiled equations with all rows, lean and steer stay.
    """
    path = SYSTEMS / "bicycle.yaml"
    system = mbsym.load(path).system
    found = relative_equilibria(system, given_values(system, {}))
    rows = [({x.name: x.value for x in each.values}, each.verdict.word) for each in found.equilibria]
    straight = next(
        word for place, word in rows if abs(place["roll"]) + abs(place["steer"]) < 1e-9 > abs(place["pitch"])
    )
    assert straight is Word.ASYMPTOTIC_BUT_STEADY  # between weave at 4.29 and capsize at 6.02
    turning = [(place, word) for place, word in rows if abs(place["yaw_dot"]) > 1]
    forward = [word for place, word in turning if abs(place["steer"]) < 1]
    assert forward == [Word.UNSTABLE, Word.UNSTABLE]
    assert Word.ASYMPTOTIC_BUT_STEADY in {word for place, word in turning if abs(place["steer"]) > 2}
    assert not found.complete
    for place, _ in turning:
        state = {
            "x": 0, "x_dot": 5, "y": 0, "yaw": 0, "yaw_dot": place["yaw_dot"], "roll": place["roll"],
            "steer": place["steer"], "pitch": place["pitch"], "rear_dot": -5 / 0.3, "front_dot": place["front_dot"],
        }  # fmt: skip
        run = mbsym.simulate(path, time=1.0, values=state)
        for name in ("roll", "steer"):
            assert np.ptp(run.coordinates[system.coordinates.index(name)]) < 1e-6
