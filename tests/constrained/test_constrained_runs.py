"""Systems with constraints in numbers: accelerations of publications, drift, order, starts; planted mistakes."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from math import cos, log2, pi, sin, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

from mbsym.algebra.derivative import gradient
from mbsym.mechanics.constraints import dynamics as equations
from mbsym.model.system import System
from mbsym.numerics.closing import NotClosed, closed
from mbsym.numerics.conservation import Standing
from mbsym.numerics.constrained import drift_of
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels import arrays
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.methods.interface import Cause, Setting, Unusable, compiled_kernel
from mbsym.numerics.methods.table import LED, METHODS
from mbsym.numerics.scenario import Scenario, scenario
from mbsym.simulation import Request, Simulation, simulate
from mbsym.source import read
from mbsym_cli.main import main

REFERENCES = Path(__file__).parents[1] / "references"

FOUR_BAR = """
mbsym: 1
name: Four-bar of SymPy's test
parameters: {l1: 0.13, l2: 0.24, l3: 0.21, l4: 0.34, rho: 997}
bodies:
  - {name: crank, attached to: 0, mass: rho*l2, rotation: {axes: [3], angles: [q1]}, mass centre: [l2/2, 0, 0],
     inertia about: mass centre, inertia: [0, 0, rho*l2**3/12]}
  - {name: coupler, attached to: crank, mass: rho*l3, connection point: [l2, 0, 0],
     rotation: {axes: [3], angles: [q2]}, mass centre: [l3/2, 0, 0],
     inertia about: mass centre, inertia: [0, 0, rho*l3**3/12]}
  - {name: rocker, attached to: coupler, mass: rho*l4, connection point: [l3, 0, 0],
     rotation: {axes: [3], angles: [q3]}, mass centre: [l4/2, 0, 0],
     inertia about: mass centre, inertia: [0, 0, rho*l4**3/12]}
constraints:
  - coincide: [{body: rocker, point: [l4, 0, 0]}, {body: 0, point: [-l1, 0, 0]}]
"""

FOUR_BAR_START = """initial: {q1: {position: 2.1, velocity: 0.2},
  q2: {position: 0.6655470375077588, velocity: -0.17963733938852067},
  q3: {position: 2.527408138024188, velocity: 0.1309060540601612}}
"""

DISC = """
mbsym: 1
name: Rolling disc
parameters: {m: 3.43, r: 0.26, g: 9.81}
bodies:
  - {name: yaw, attached to: 0, mass: 0, connection point: [q4, q5, 0], coordinates: [q4, q5, q1],
     rotation: {axes: [3], angles: [q1]}}
  - {name: lean, attached to: yaw, mass: 0, rotation: {axes: [1], angles: [q2]}}
  - {name: disc, attached to: lean, mass: m, connection point: [0, 0, r], rotation: {axes: [2], angles: [q3]},
     inertia about: mass centre, inertia: [m*r**2/4, m*r**2/2, m*r**2/4]}
loads:
  - uniform gravity: {acceleration: g, direction: [0, 0, -1]}
constraints:
  - rolling: {body: disc, point: [0, 0, -r], axes: lean, "on": ground}
"""

#: A pendulum of length 1 in Cartesian coordinates; k moves its rod.
PENDULUM = """
mbsym: 1
name: Pendulum in Cartesian coordinates
parameters: {m: 1, g: 1, l: 1, k: 0}
bodies:
  - {name: bob, attached to: 0, mass: m, connection point: [x, y, 0], coordinates: [x, y]}
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
constraints:
  - relation: x**2 + y**2 = (l + k*sin(t))**2
initial: {x: 3/5, y: -4/5}
"""


def described(text: str) -> System:
    system, complaints = read(text)
    assert system is not None, list(complaints)
    return system


def begun(text: str, **values: float) -> Scenario:
    system = described(text)
    given = {**values}
    found = scenario(system, state=False)
    names = (*system.coordinates, *system.velocities)
    state = [Fraction(given.get(name, float(x))) for name, x in zip(names, found.state, strict=True)]
    n = len(system.coordinates)
    return closed(replace(found, positions=tuple(state[:n]), velocities=tuple(state[n:]))).scenario


def accelerations(found: Scenario) -> dict[str, float]:
    rhs = compiled_kernel(Dynamics(found), "right_hand_side")(np.array([0.0, *map(float, found.state)]))
    names = found.system.coordinates
    return dict(zip(names, rhs[len(names) :].tolist(), strict=True))


def run(text: str, time: float = 5.0, **how: Any) -> Simulation:
    return simulate(begun(text), Request(time=time, **how))


# --- publications ---


def test_four_bar_of_sympy() -> None:
    truth = json.loads((REFERENCES / "sympy_four_bar.json").read_text())["reference"]["accelerations"]
    found = accelerations(begun(FOUR_BAR + FOUR_BAR_START))
    assert list(found.values()) == pytest.approx([float(x) for x in truth], abs=1e-13)


@pytest.mark.parametrize("case", ["case1", "case2"])
def test_rolling_disc_of_sympy(case: str) -> None:
    """u, the angular velocity in the axes of the disc, is R_y(-q3) (q2', q3' + q1' sin q2, q1' cos q2)."""
    known = json.loads((REFERENCES / "sympy_rolling_disc.json").read_text())
    given, truth = known["parameters"][case], [float(x) for x in known["reference"][case]]
    q = {f"q{k}": value for k, value in enumerate(given["q"], 1)}
    rates = {f"q{k}_dot": value for k, value in enumerate(truth[:5], 1)}
    found = begun(DISC, **q, **rates)
    assert [float(x) for x in found.velocities] == pytest.approx([rates[x] for x in found.system.velocities], abs=1e-13)
    a = accelerations(found)
    q1, q2, q3 = (rates[f"q{k}_dot"] for k in (1, 2, 3))
    s, c, s3, c3 = sin(q["q2"]), cos(q["q2"]), sin(q["q3"]), cos(q["q3"])
    spin = np.array([q2, q3 + q1 * s, q1 * c])
    rate = np.array([a["q2"], a["q3"] + a["q1"] * s + q1 * q2 * c, a["q1"] * c - q1 * q2 * s])

    def turned(v: Any) -> Any:
        return np.array([c3 * v[0] - s3 * v[2], v[1], s3 * v[0] + c3 * v[2]])

    assert turned(spin) == pytest.approx(given["u"], abs=1e-12)
    inner = turned(rate) - np.cross([0, q3, 0], turned(spin))
    assert inner == pytest.approx(truth[5:8], abs=1e-12)
    assert [a["q4"], a["q5"]] == pytest.approx(truth[8:], abs=1e-13)


# --- against minimal coordinates ---

MINIMAL = """
mbsym: 1
name: Pendulum
parameters: {m: 1, g: 1, l: 1}
bodies:
  - {name: bob, attached to: 0, mass: m, rotation: {axes: [3], angles: [phi]}, mass centre: [0, -l, 0]}
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
initial: {phi: asin35}
""".replace("asin35", "643501108793284386802809228717/10**30")


@pytest.mark.parametrize("method", ["dop853", "rk45", "rodas5p", "radau", "bdf", "scipy-dop853", "scipy-rk45"])
def test_a_pendulum_in_two_forms(method: str) -> None:
    """By every method the motion is that of the angle, and is on the circle at every row."""
    angle = simulate(scenario(described(MINIMAL)), Request(time=10.0, tolerance=1e-13, samples=57))["phi"]
    found = run(PENDULUM, 10.0, method=method, tolerance=1e-9, samples=57)
    assert found.whole
    assert found["x"] == pytest.approx(np.sin(angle), abs=3e-5 if method == "bdf" else 3e-7)
    assert found.drift is not None
    assert max(found.drift.largest) < 1e-13
    assert np.max(np.abs(found["x"] ** 2 + found["y"] ** 2 - 1)) < 1e-13
    assert found.conservation.standing is Standing.PROVED


@pytest.mark.parametrize(("method", "order"), [("rk4", 4)])
def test_what_is_led_back_keeps_the_order(method: str, order: int) -> None:
    truth = run(PENDULUM, 4.0, method="dop853", tolerance=1e-14).trajectory.states[:, -1]
    errors = []
    for step in (0.04, 0.02, 0.01):
        found = run(PENDULUM, 4.0, method=method, step=step)
        errors.append(float(np.max(np.abs(found.trajectory.states[:, -1] - truth))))
    orders = [log2(a / b) for a, b in pairwise(errors)]
    assert all(order - 0.3 < one < order + 1.3 for one in orders), (errors, orders)


def test_rows_between_steps_are_on_the_constraints_and_so_are_events() -> None:
    """Dense output strays by its own error; rows are led back, the ends of steps and what lies between alike."""
    found = run(PENDULUM, 10.0, tolerance=1e-5, samples=2001)
    assert found.trajectory.work.steps < 60
    assert np.max(np.abs(found["x"] ** 2 + found["y"] ** 2 - 1)) < 1e-12
    places = found.at(np.linspace(0, 10, 333))
    assert np.max(np.abs(places[0] ** 2 + places[1] ** 2 - 1)) < 1e-12


# --- what moves by itself ---


def test_a_rod_that_is_moved_does_work_and_that_is_seen() -> None:
    found = simulate(
        closed(replace_value(scenario(described(PENDULUM)), k=Fraction(1, 10))).scenario, Request(time=6.0)
    )
    assert found.conservation.standing is Standing.CHANGING
    length = 1 + 0.1 * np.sin(found.times)
    assert np.max(np.abs(found["x"] ** 2 + found["y"] ** 2 - length**2)) < 1e-12
    # The energy changes by the work of the rod: lambda of x^2 + y^2 = L^2 times d(L^2)/dt.
    dynamics = found.dynamics
    points = np.vstack([found.times, found.trajectory.states])
    power = compiled_kernel(dynamics, "constraint_power")(points)[0]
    work = np.concatenate(([0.0], np.cumsum((power[1:] + power[:-1]) / 2 * np.diff(found.times))))
    assert np.max(np.abs(found.energy - found.energy[0] - work)) < 1e-4


def replace_value(found: Scenario, **values: Fraction) -> Scenario:
    return replace(found, parameters={**found.parameters, **values})


# --- initial states ---


def test_the_closest_start_is_found() -> None:
    """From (1, -1) the closest point of the circle is (1, -1)/sqrt(2); the velocity keeps its tangential part."""
    given = scenario(
        described(
            PENDULUM.replace("{x: 3/5, y: -4/5}", "{x: {position: 1, velocity: 1}, y: {position: -1, velocity: 0}}")
        )
    )
    found = closed(given)
    assert [float(x) for x in found.scenario.positions] == pytest.approx([1 / sqrt(2), -1 / sqrt(2)], abs=1e-12)
    assert [float(x) for x in found.scenario.velocities] == pytest.approx([0.5, 0.5], abs=1e-12)
    assert found.closest
    assert [move.name for move in found.moves] == ["x", "y", "x_dot", "y_dot"]
    x, y = found.scenario.positions
    assert abs(x * x + y * y - 1) < Fraction(1, 2**200)


def test_a_chain_that_hangs_is_closed_near_where_it_hangs() -> None:
    """Three equal links, nearly in one line, whose end belongs beside the first joint: long steps folded them there.

    A crank turned by q1 leaves a parallelogram, q2 = pi/2 - q1, q3 = pi/2 + q1, of which the middle one in q1 - 0.2,
    pi/2 - q1 - 0.2, pi/2 + q1 - 0.2 has 3 q1 = 0.2 where masses do not weigh.
    """
    link = "mass: 1, mass centre: [0, -1/2, 0], inertia about: mass centre, inertia: [0.08, 0.01, 0.08]"
    text = "mbsym: 1\nname: four-bar\nbodies:\n"
    for k, (on, y) in enumerate(((0, 0), (1, -1), (2, -1)), start=1):
        place = f"connection point: [0, {y}, 0], rotation: {{axes: [3], angles: [q{k}]}}"
        text += f"  - {{name: b{k}, attached to: {on and f'b{on}'}, {place}, {link}}}\n"
    text += "constraints: [{coincide: [{body: 0, point: [1, 0, 0]}, {body: b3, point: [0, -1, 0]}]}]\n"
    found = closed(scenario(described(text + "initial: {q1: 0.2, q2: 0.2, q3: 0.2}\n")))
    q1, q2, q3 = map(float, found.scenario.positions)
    assert found.closest
    assert (q2, q3) == pytest.approx((pi / 2 - q1, pi / 2 + q1))
    assert abs(q1) < 0.5


def test_a_start_on_the_constraints_is_left_as_it_is() -> None:
    given = scenario(described(PENDULUM))
    assert closed(given).scenario == given


def test_fixed_values_stay() -> None:
    given = scenario(described(PENDULUM.replace("3/5", "1/2")))
    found = closed(given, ("x",))
    assert found.scenario.positions[0] == Fraction(1, 2)
    assert float(found.scenario.positions[1]) == pytest.approx(-sqrt(3) / 2, abs=1e-14)
    with pytest.raises(NotClosed, match="fixed: x, y"):
        closed(given, ("x", "y"))


def test_what_cannot_be_closed_tells_the_gap() -> None:
    """Links of 0.24, 0.21 and 0.34 do not reach a point 1 away: stretched out, 0.21 is missing."""
    text = (FOUR_BAR + FOUR_BAR_START).replace("l1: 0.13", "l1: 1")
    with pytest.raises(NotClosed) as caught:
        closed(scenario(described(text)))
    gaps = [gap.size for gap in caught.value.gaps]
    assert np.hypot(*gaps) == pytest.approx(1 - 0.24 - 0.21 - 0.34, rel=1e-3)


def test_a_singular_start_is_named() -> None:
    """Bars of 1, 1 and 2 in line, closed at a distance of 4: the position is determined, the accelerations are not."""
    text = FOUR_BAR.replace(
        "{l1: 0.13, l2: 0.24, l3: 0.21, l4: 0.34, rho: 997}", "{l1: 2, l2: 1, l3: 2, l4: 1, rho: 1}"
    )
    start = f"initial: {{q1: 0, q2: {pi}, q3: 0}}".replace(str(pi), "pi")
    found = simulate(scenario(described(text + start)), Request(time=1.0))
    assert found.ended is not None
    assert found.ended.kind == Cause.SINGULAR_CONSTRAINTS


#: An arm of two links of length 1 whose end is drawn along a line.
DRAWN = """
mbsym: 1
name: arm
parameters: {{g: 9.81}}
bodies:
  - {{name: a, attached to: 0, rotation: {{axes: [3], angles: [q1]}}, mass centre: [1/2, 0, 0], mass: 1,
     inertia about: mass centre, inertia: [0, 1/12, 1/12]}}
  - {{name: b, attached to: a, connection point: [1, 0, 0], rotation: {{axes: [3], angles: [q2]}},
     mass centre: [1/2, 0, 0], mass: 1, inertia about: mass centre, inertia: [0, 1/12, 1/12]}}
loads: [{{uniform gravity: {{vector: [0, -g, 0]}}}}]
constraints: [{{relation: "cos(q1) + cos(q1 + q2) = {reach}"}}]
initial: {{q1: 0.5, q2: -1.5}}
"""


@pytest.mark.parametrize("method", ["rk45", "radau", "rk4"])
def test_what_is_drawn_to_full_stretch_ends_there_and_is_called_so(method: str) -> None:
    """The reach 1 + t/2 is the arm's length of 2 at t = 2; nothing is nearer to the end than the last sample."""
    finely = {"step": 1e-3} if method == "rk4" else {"tolerance": 1e-9}
    given = closed(scenario(described(DRAWN.format(reach="1 + t/2")))).scenario
    found = simulate(given, Request(time=4.0, method=method, estimate=False, **finely))  # type: ignore[arg-type]
    assert found.ended is not None
    assert found.ended.kind == Cause.OUT_OF_REACH
    assert found.ended.time == pytest.approx(2, abs=5e-3)


def test_a_reach_that_only_touches_full_stretch_is_a_singular_position() -> None:
    """1 + t/2 - t^2/16 has its maximum of 2 at t = 4: there are positions behind it."""
    given = closed(scenario(described(DRAWN.format(reach="1 + t/2 - t**2/16")))).scenario
    found = simulate(given, Request(time=8.0, method="rk45", tolerance=1e-9, estimate=False))
    assert found.ended is not None
    assert found.ended.kind == Cause.SINGULAR_CONSTRAINTS


def test_velocities_that_were_left_out_follow_from_those_that_are_given() -> None:
    """The crank turns at 0.2, as it was said to; the others follow to the digits of SymPy's test."""
    text = FOUR_BAR + "initial: {q1: {position: 2.1, velocity: 0.2}, q2: 0.6655470375077588, q3: 2.527408138024188}"
    found = closed(scenario(described(text)))
    assert found.given_stays
    assert found.follow
    truth = json.loads((REFERENCES / "sympy_four_bar.json").read_text())["parameters"]["u"]
    assert [float(x) for x in found.scenario.velocities] == pytest.approx([float(x) for x in truth], abs=1e-12)


PARALLELOGRAM = """
mbsym: 1
name: parallelogram in one line
bodies:
  - {name: left, attached to: 0, rotation: {axes: [3], angles: [a]}, mass centre: [1, 0, 0], mass: 1}
  - {name: right, attached to: 0, connection point: [2, 0, 0], rotation: {axes: [3], angles: [b]},
     mass centre: [1, 0, 0], mass: 1}
  - {name: rod, attached to: left, connection point: [1, 0, 0], rotation: {axes: [3], angles: [c]},
     mass centre: [1, 0, 0], mass: 1, inertia about: mass centre, inertia: [0, 1, 1]}
constraints:
  - coincide: [{body: rod, point: [2, 0, 0]}, {body: right, point: [1, 0, 0]}]
"""


@pytest.mark.parametrize(("angle", "follow"), [(0, False), (1, True)])
def test_where_a_parallelogram_branches_no_velocity_follows_from_another(angle: int, follow: bool) -> None:
    """In line a' + 2 (a' + c') = b' is all that is demanded: b' = 1 of the parallelogram, -3 of the other branch."""
    given = f"initial: {{a: {{position: {angle}, velocity: 1}}, b: {angle}, c: {-angle}}}"
    found = closed(scenario(described(PARALLELOGRAM + given)))
    assert found.given_stays
    assert found.follow is follow
    if follow:
        assert [float(x) for x in found.scenario.velocities] == pytest.approx([1, 1, -1], abs=1e-12)


def test_coordinates_called_dependent_are_fitted_to_the_others() -> None:
    text = PENDULUM.replace("initial: {x: 3/5, y: -4/5}", "dependent: [y]\ninitial: {x: 1/2, y: -1}")
    assert [float(x) for x in closed(scenario(described(text))).scenario.positions] == pytest.approx(
        [0.5, -sqrt(3) / 2], abs=1e-15
    )


def test_a_run_goes_on_from_the_state_that_it_began_with(tmp_path: Path) -> None:
    """That is not the one in the description, and is found again."""
    text = PENDULUM.replace("3/5", "1/2")
    assert called(tmp_path, text).exit_code == 0
    earlier = tmp_path / "out" / "simulation.json"
    words = ["simulate", tmp_path / "s.yaml", "--time", 2, "--out", tmp_path / "on", "-f", "csv", "--continue", earlier]
    result = CliRunner().invoke(main, [str(word) for word in words])
    assert result.exit_code == 0, result.output
    last = (tmp_path / "on" / "trajectory.csv").read_text().splitlines()[-1].split(",")
    assert float(last[0]) == 2
    assert float(last[1]) ** 2 + float(last[2]) ** 2 == pytest.approx(1, abs=1e-13)


@pytest.mark.parametrize("name", METHODS)
def test_methods_that_are_said_to_keep_to_constraints_do(name: str) -> None:
    """And no others begin: the hint that names them is made of what each method says of itself."""
    dynamics = Dynamics(closed(scenario(described(PENDULUM))).scenario)
    setting = Setting(step=0.01) if METHODS[name].traits.fixed else Setting(1e-9)
    if name not in LED:
        with pytest.raises(Unusable, match="constraints are not kept to"):
            METHODS[name].start(dynamics, setting)
        return
    try:
        run = METHODS[name].start(dynamics, setting)
    except Unusable as reason:
        pytest.skip(str(reason))  # an optional package
    run.advance(1.0)
    x, y = run.state[:2]
    assert x**2 + y**2 == pytest.approx(1, abs=1e-13)


def test_tradeoff_tells_from_where_it_begins_and_what_does_not_apply(tmp_path: Path) -> None:
    (tmp_path / "s.yaml").write_text(PENDULUM.replace("3/5", "1/2"), encoding="utf-8")
    words = ["tradeoff", tmp_path / "s.yaml", "--time", 2, "--all-rows", "--budget", 20, "--out", tmp_path / "out"]
    result = CliRunner().invoke(main, [str(word) for word in [*words, "--methods", "rk4,rk45,lsoda"]])
    assert result.exit_code == 0, result.output
    assert "what was given does not satisfy the constraints" in result.stderr
    assert "lsoda: not used: constraints are not kept to" in result.stdout
    assert "measured order" in result.stdout


def test_links_that_close_in_one_line_only_are_not_called_open(tmp_path: Path) -> None:
    """Two links of lengths 1 and 2 between points 3 apart: J loses its rank in the one position there is."""
    text = """
mbsym: 1
name: Stretched
parameters: {m: 1}
bodies:
  - {name: one, attached to: 0, rotation: {axes: [3], angles: [a]}, mass: m, inertia about: joint, inertia: [1, 1, 1]}
  - {name: two, attached to: one, connection point: [1, 0, 0], rotation: {axes: [3], angles: [b]}, mass: m,
     inertia about: joint, inertia: [1, 1, 1]}
constraints:
  - coincide: [{body: two, point: [2, 0, 0]}, {body: 0, point: [3, 0, 0]}]
initial: {a: 1, b: 1}
"""
    with pytest.raises(NotClosed, match="only to roundings") as caught:
        closed(scenario(described(text)))
    assert caught.value.singular
    result = called(tmp_path, text)
    assert result.exit_code == 3
    assert "start elsewhere" in result.stderr
    with pytest.raises(NotClosed, match="cannot be closed") as caught:
        closed(scenario(described(text.replace("[3, 0, 0]}]", "[3.0001, 0, 0]}]"))))
    assert not caught.value.singular


# --- redundant rows ---


def test_rows_that_follow_from_others_are_named_and_do_no_harm() -> None:
    """The same rod twice, in other words: one row is left out, the motion is the same."""
    twice = PENDULUM.replace(
        "initial:",
        "  - distance: {between: [{body: bob, point: [0, 0, 0]}, {body: 0, point: [0, 0, 0]}], length: l}\ninitial:",
    )
    plain, doubled = run(PENDULUM, 5.0, samples=31), run(twice, 5.0, samples=31)
    known = doubled.dynamics.constraints
    assert known is not None
    assert len(known.redundant) == 1
    assert known.freedom == 1
    assert doubled["x"] == pytest.approx(plain["x"], abs=1e-9)


def test_constraints_that_contradict_each_other_are_not_closed() -> None:
    other = PENDULUM.replace("initial:", "  - relation: x**2 + y**2 = 2*l**2\ninitial:")
    with pytest.raises(NotClosed, match="relation"):
        closed(scenario(described(other)))


# --- planted mistakes ---


def strayed(found: Simulation, truth: Simulation) -> float:
    return float(np.max(np.abs(found.trajectory.states - truth.trajectory.states)))


def unbalanced(dynamics: Dynamics) -> float:
    """The largest |dg/dt| along the accelerations, beside its terms, at a state beside the constraints.

    A second route to J' q' + j': the rows g are differentiated by t, q, q' as they stand, no recursion gives them.
    """
    known = dynamics.constraints
    assert known is not None
    h, r = known.holonomic, len(known)
    code = known.code
    inputs = [code.program.input(name) for name in code.inputs]
    slopes = [x for g in code.outputs[h : h + r] for x in gradient(code.program, g, inputs)]
    point = np.array([0.2, *map(float, dynamics.scenario.state)]) + 0.1 * np.cos(np.arange(len(inputs)))
    values = arrays.kernel(Code(code.program, code.inputs, tuple(slopes)))(point).reshape(r, -1)
    rates = np.concatenate(([1.0], compiled_kernel(dynamics, "right_hand_side")(point)))
    return float(np.max(np.abs(values @ rates) / np.sum(np.abs(values * rates), axis=1)))


MOVED = PENDULUM.replace("k: 0", "k: 1/10")


@pytest.mark.parametrize("text", [FOUR_BAR + FOUR_BAR_START, DISC, PENDULUM, MOVED])
def test_accelerations_satisfy_the_second_derivative(text: str) -> None:
    assert unbalanced(Dynamics(begun(text))) < 1e-12


@pytest.mark.parametrize("text", [FOUR_BAR + FOUR_BAR_START, DISC, PENDULUM, MOVED])
def test_a_forgotten_term_is_seen(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without J' q' + j' rows are led back all the same, and a motion looks sound: the second route shows it."""
    rows = equations.constraint_rows

    def forgetful(scene: Any, kept: Any = None) -> Any:
        return tuple(replace(row, acceleration=scene.algebra.zero) for row in rows(scene, kept))

    monkeypatch.setattr(equations, "constraint_rows", forgetful)
    assert unbalanced(Dynamics(begun(text))) > 1e-3


def test_a_forgotten_term_strays(monkeypatch: pytest.MonkeyPatch) -> None:
    truth = run(PENDULUM, 5.0, samples=31)
    rows = equations.constraint_rows

    def forgetful(scene: Any, kept: Any = None) -> Any:
        return tuple(replace(row, acceleration=scene.algebra.zero) for row in rows(scene, kept))

    monkeypatch.setattr(equations, "constraint_rows", forgetful)
    assert strayed(run(PENDULUM, 5.0, samples=31), truth) > 1e-2


def test_a_wrong_sign_is_seen() -> None:
    truth = run(FOUR_BAR + FOUR_BAR_START, 5.0, samples=31)
    other = FOUR_BAR.replace("point: [-l1, 0, 0]", "point: [l1, 0, 0]")
    system = described(other + FOUR_BAR_START)
    found = closed(scenario(system))
    assert max(abs(move.found - move.given) for move in found.moves) > 0.1  # told to whoever gave a consistent start
    assert truth.closed is not None
    assert not truth.closed.moves


# --- the command ---


def called(tmp_path: Path, text: str, *arguments: object) -> Result:
    (tmp_path / "s.yaml").write_text(text, encoding="utf-8")
    words = ["simulate", tmp_path / "s.yaml", "--time", 1, "--out", tmp_path / "out", "-f", "csv", *arguments]
    return CliRunner().invoke(main, [str(word) for word in words])


def test_the_table_has_the_drift_and_the_summary_tells_it(tmp_path: Path) -> None:
    result = called(tmp_path, FOUR_BAR + FOUR_BAR_START, "-v")
    assert result.exit_code == 0, result.output
    assert "independent constraint rows: 2; free velocities: 1 of 3" in result.stdout
    assert "the initial state satisfies the constraints" in result.stdout
    header = (tmp_path / "out" / "trajectory.csv").read_text().splitlines()[0]
    assert header.endswith("energy,relative_drift,constraint_drift,constraint_velocity_drift")
    told = json.loads((tmp_path / "out" / "simulation.json").read_text())["constraints"]
    assert told["free_velocities"] == 1
    assert 0 <= told["drift"]["positions"] < 1e-13


def test_an_inconsistent_start_is_told_or_refused(tmp_path: Path) -> None:
    text = PENDULUM.replace("3/5", "1/2")
    result = called(tmp_path, text)
    assert result.exit_code == 0
    assert "what was given does not satisfy the constraints" in result.stdout
    assert "instead of 0.5" in result.stdout
    result = called(tmp_path, text, "--fixed", "x,y")
    assert result.exit_code == 2
    assert "fixed: x, y" in result.stderr
    assert "gap of relation 1 (line 10)" in result.stderr
    result = called(tmp_path, text, "--fixed", "z")
    assert result.exit_code == 2
    assert "there is nothing called 'z' to be fixed" in result.stderr


def test_an_open_loop_ends_with_the_closest_configuration(tmp_path: Path) -> None:
    result = called(tmp_path, (FOUR_BAR + FOUR_BAR_START).replace("l1: 0.13", "l1: 1"))
    assert result.exit_code == 3
    assert "closest found: q1 = " in result.stderr
    assert not (tmp_path / "out").exists()


def test_what_does_not_know_constraints_refuses_by_name(tmp_path: Path) -> None:
    result = called(tmp_path, FOUR_BAR + FOUR_BAR_START, "--method", "lsoda")
    assert result.exit_code == 2, result.output
    assert "constraints" in result.stderr
    assert not (tmp_path / "out").exists()


def test_drift_is_seen_where_nothing_leads_back() -> None:
    """Index 1 alone strays, as it does in the literature: the column is not zero by construction."""
    found = begun(PENDULUM)
    dynamics = Dynamics(found)
    dynamics.__dict__["correction"] = None
    bare = METHODS["rk4"].start(dynamics, Setting(step=0.05))
    times = np.linspace(0, 20, 101)
    states = np.column_stack([bare.state, bare.fill(times[1:])])
    drift = drift_of(dynamics, times, states)
    assert drift is not None
    assert 1e-9 < drift.largest[0] < 1e-2
    assert drift.largest[0] > 1e3 * max(run(PENDULUM, 20.0, method="rk4", step=0.05).drift.largest)  # type: ignore[union-attr]


@pytest.mark.parametrize("unit", [1, 1000, 10**9])
def test_the_largest_moves_are_told_first_in_any_unit_of_length(unit: int) -> None:
    """A point on a wheel of 10 mm, which is led from 2 mm aside of it.

    x = L cos a: x moves by a good part of its size, a by little; beside 1 + |x| metres x is nothing.
    """
    length, inertia, start = (str(Fraction(*x) * unit**n) for x, n in (((1, 100), 1), ((1, 10**4), 2), ((8, 1000), 1)))
    text = f"""
mbsym: 1
name: point on a wheel
bodies:
  - {{name: wheel, attached to: 0, rotation: {{axes: [3], angles: [a]}}, mass: 0, inertia about: joint,
     inertia: [0, 0, {inertia}], coordinates: [a]}}
  - {{name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}}
constraints: [{{relation: x = {length}*cos(a)}}]
initial: {{a: 1, x: {start}}}
"""
    from mbsym.report.runs.constrained_run_words import start_lines

    system, _ = read(text)
    assert system is not None
    moves = closed(scenario(system)).moves
    parts = {move.name: move.part for move in moves}
    assert parts["x"] > parts["a"] > 0
    shown = [str(text).split(" = ")[0] for text in start_lines(closed(scenario(system)), system)][1:]
    assert shown == sorted(parts, key=lambda name: -parts[name])
