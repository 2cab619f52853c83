"""Quaternions and unit vectors integrated beside constraints, held against Newton and Euler (``tests/free_bodies.py``).

Rows, with c in body axes and u = R c the arm in space:

    coincide     r + u - (r2 + u2):  v + R (w x c)
    distance     (d.d - L(t)^2)/2 with d = r + u - P:  d.(v + R w x c) - L L'
    rolling      v + (R w) x a with an arm a: constant in space (ball), or -rho (g - (g.n) n)/|..| (disc with axis n)
"""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import mbsym
from mbsym.numerics.closing import closed
from mbsym.numerics.conservation import Standing
from mbsym.numerics.kernels import arrays
from mbsym.numerics.methods.interface import Cause
from mbsym.numerics.scenario import Incomplete, scenario
from mbsym.numerics.states import StateDynamics, scenario_in_states
from mbsym.report.code import c_source
from mbsym.report.code.identifiers import prefix_of
from mbsym.report.targets import FORMATS
from mbsym.simulation import read_values
from tests.constrained.test_flow_on_the_manifold import numbers
from tests.free_bodies import Rows, cosines, motion, point
from tests.mechanisms import BALL, TORUS, rolling_ball, rolling_torus

COMPILER = shutil.which("cc")


def run(tmp_path: Path, text: str, time: float) -> Any:
    (tmp_path / "system.yaml").write_text(text, encoding="utf-8")
    found = mbsym.simulate(tmp_path / "system.yaml", time=time, samples=41, tolerance=1e-12)
    assert found.trajectory.whole
    return found


def column(found: Any, name: str) -> Any:
    return found.trajectory.states[found.dynamics.inputs[1:].index(name)]


def same_attitude(found: Any, names: str, e: Any, bound: float = 1e-8) -> None:
    own = np.array([column(found, f"{names}{k}") for k in range(4)])
    for a, b in zip(own.T, e.T, strict=True):
        assert cosines(a) == pytest.approx(cosines(b), abs=bound)


def kept(found: Any, bound: float = 1e-10) -> None:
    """Both drifts of the constraints, the norms, and the energy where it is known to be constant."""
    from mbsym.numerics.states import norm_drifts

    assert max(found.drift.largest) < bound
    assert all(np.max(x) < bound for x in norm_drifts(found.dynamics, found.trajectory.states).values())


@pytest.mark.parametrize(
    "initial",
    [
        "initial: {x: 0, y: 0, e0: 1, e1: 0, e2: 0, e3: 0, p: -1, q: 0.3, s: 2}",  # the pole of the angles
        "initial: {x: 0, y: 0, psi: 0, theta: {position: 1, velocity: -1}, phi: {position: 0, velocity: 0.000001}}",
    ],
)
def test_chaplygins_sphere_passes_every_attitude(tmp_path: Path, initial: str) -> None:
    """Through theta = 0, where the angles of the joint are singular: refused, or wrong in the third digit, before."""
    found = run(tmp_path, BALL + initial, 6)
    first = found.trajectory.states[:, 0]
    names = found.dynamics.inputs[1:]
    e, w = (np.array([first[names.index(x)] for x in group]) for group in (("e0", "e1", "e2", "e3"), "pqs"))
    v = -np.cross(cosines(e) @ w, [0, 0, -0.5])
    wanted = motion([2], [np.array([0.1, 0.15, 0.22])], rolling_ball, np.r_[0, 0, 0.5, e, v, w], found.trajectory.times)
    assert np.array([column(found, x) for x in "xy"]) == pytest.approx(wanted[:2], abs=1e-9)
    assert np.array([column(found, x) for x in "pqs"]) == pytest.approx(wanted[10:13], abs=1e-9)
    same_attitude(found, "e", wanted[3:7])
    kept(found)
    assert found.conservation.standing is Standing.PROVED
    w = np.array(
        [column(found, x) for x in "pqs"]
    )  # T = (m r^2 |w_h|^2 + w.I w)/2 of the ball, w_h its horizontal part
    spun = np.array([cosines(x) @ y for x, y in zip(wanted[3:7].T, w.T, strict=True)])
    kinetic = 0.5 * (2 * 0.25 * np.sum(spun[:, :2] ** 2, axis=1) + np.array([0.1, 0.15, 0.22]) @ w**2)
    assert np.ptp(kinetic) < 1e-10 * kinetic[0]


TIED = """
mbsym: 1
name: A top on a rod without mass whose length is given
parameters: {m: {value: 2, sign: positive}, g: {value: 9.81, sign: positive}}
bodies:
  - {name: centre, attached to: 0, connection point: [x, y, z], coordinates: [x, y, z], mass: 0}
  - {name: top, attached to: centre, rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}, mass: m,
     inertia about: mass centre, inertia: [0.1, 0.15, 0.22], speeds: {p: omega1, q: omega2, s: omega3},
     orientation: {e: quaternion}}
loads: [{uniform gravity: {vector: [0, 0, -g]}}]
constraints:
  - CONSTRAINT
initial: {x: 0.02, y: 0.01, z: -0.48, e0: 1, e1: 0, e2: 0, e3: 0, p: 1, q: -0.5, s: 3}
"""


def point_of_top(bodies: list[Any], t: Any) -> tuple[Any, Any]:
    return point(bodies, 0, [0.1, 0, 0.5]), 0.0


def length(t: Any) -> tuple[Any, Any]:
    """L, L'."""
    return 0.7 + 0.1 * np.sin(2 * t), 0.2 * np.cos(2 * t)


def rod_of_top(bodies: list[Any], t: Any) -> tuple[Any, Any]:
    c, (r, R), (long, grows) = np.array([0.1, 0, 0.2]), bodies[0], length(t)
    return (r + R @ c - [0, 0, 0.4])[None] @ point(bodies, 0, c), -long * grows


@pytest.mark.parametrize(
    ("constraint", "rows"),
    [
        ("coincide: [{body: top, point: [0.1, 0, 0.5]}, {body: 0, point: [0, 0, 0]}]", point_of_top),
        ("distance: {between: [{body: top, point: [0.1, 0, 0.2]}, {body: 0, point: [0, 0, 0.4]}], "
         "length: 0.7 + 0.1*sin(2*t)}", rod_of_top),
    ],
)  # fmt: skip
def test_a_top_that_is_tied_begins_at_the_pole_and_off_its_constraint(
    tmp_path: Path, constraint: str, rows: Rows
) -> None:
    """The state given is not on the constraint: it is led there in the declared variables, the quaternion included."""
    found = run(tmp_path, TIED.replace("CONSTRAINT", constraint), 4)
    first, names = found.trajectory.states[:, 0], found.dynamics.inputs[1:]
    at = [names.index(x) for x in ("x", "y", "z", "e0", "e1", "e2", "e3", "x_dot", "y_dot", "z_dot", *"pqs")]
    assert found.closed.moves
    J, _ = rows([(first[at[:3]], cosines(first[at[3:7]]))], 0.0)
    moved = J @ np.r_[first[at[7:10]], first[at[10:]]]
    assert moved == pytest.approx(length(0)[0] * length(0)[1] if len(moved) == 1 else 0, abs=1e-12)
    wanted = motion([2], [np.array([0.1, 0.15, 0.22])], rows, first[at], found.trajectory.times)
    assert np.array([column(found, x) for x in "xyz"]) == pytest.approx(wanted[:3], abs=1e-8)
    assert np.array([column(found, x) for x in "pqs"]) == pytest.approx(wanted[10:13], abs=1e-7)
    same_attitude(found, "e", wanted[3:7])
    kept(found)
    constant = found.conservation.standing in (Standing.PROVED, Standing.VERIFIED)
    assert constant == constraint.startswith("coincide")  # a rod that grows does work
    assert not constant or found.conservation.change < 1e-10


LOOP = """
mbsym: 1
name: A loop of two spatial links
parameters: {g: {value: 9.81, sign: positive}}
bodies:
  - {name: one, attached to: 0, rotation: {axes: [3, 1, 3], angles: [a1, a2, a3]}, mass: 1, mass centre: [0.25, 0, 0],
     inertia about: mass centre, inertia: [0.05, 0.1, 0.12], speeds: {p: omega1, q: omega2, s: omega3},
     orientation: {e: quaternion}}
  - {name: two, attached to: one, connection point: [0.5, 0, 0], rotation: {axes: [3, 1, 3], angles: [b1, b2, b3]},
     mass: 1.5, mass centre: [0.3, 0, 0], inertia about: mass centre, inertia: [0.06, 0.11, 0.14],
     speeds: {u: omega1, v: omega2, w: omega3}, orientation: {ORIENTATION}}
loads: [{uniform gravity: {vector: [0, 0, -g]}}]
constraints:
  - coincide: [{body: two, point: [0.6, 0, 0]}, {body: 0, point: [0.3, 0.4, 0.1]}]
initial: {a1: 0.4, a2: 0.3, a3: 0.7, b1: 2, b2: 0.5, b3: {position: 0.1, velocity: 2}}
"""


def two_links(bodies: list[Any], t: Any) -> tuple[Any, Any]:
    """Nine rows: one's end at the origin, the joint between them, two's end at a point of the ground."""
    joint = point(bodies, 0, [0.25, 0, 0]) - point(bodies, 1, [-0.3, 0, 0])
    return np.vstack([point(bodies, 0, [-0.25, 0, 0]), joint, point(bodies, 1, [0.3, 0, 0])]), 0.0


@pytest.mark.parametrize("orientation", ["f: quaternion", "alpha: 1, beta: 2, gamma: 3"])
def test_a_loop_of_bodies_told_by_quaternions_and_unit_vectors(tmp_path: Path, orientation: str) -> None:
    """Two spherical joints and a third that closes: three velocities are free of six, in speeds of two bodies."""
    found = run(tmp_path, LOOP.replace("ORIENTATION", orientation), 3)
    states, names = found.trajectory.states, found.dynamics.inputs[1:]
    assert states.shape[0] == (14 if "f" in orientation[:1] else 19)

    def get(group: Any) -> Any:
        return np.array([states[names.index(x)] for x in group])

    e = get(["e0", "e1", "e2", "e3"])
    if "f" in orientation[:1]:
        turned = np.array([cosines(x) for x in get(["f0", "f1", "f2", "f3"]).T])
    else:  # the axes of the first body in the axes of the second
        turned = np.array([get([f"{x}{k}" for x in ("alpha", "beta", "gamma")]).T for k in (1, 2, 3)])
        turned = np.transpose(turned, (1, 2, 0))
    first = np.array([cosines(x) for x in e.T])
    second = first @ turned
    w1, w2 = get("pqs"), get("uvw")
    joint = first @ np.array([0.5, 0, 0])
    assert joint + second @ np.array([0.6, 0, 0]) == pytest.approx(np.tile([0.3, 0.4, 0.1], (len(joint), 1)), abs=1e-10)
    c1, c2 = np.array([0.25, 0, 0]), np.array([0.3, 0, 0])
    v1 = first[0] @ np.cross(w1[:, 0], c1)
    v2 = 2 * v1 + second[0] @ np.cross(w2[:, 0], c2)
    from scipy.spatial.transform import Rotation

    f = Rotation.from_matrix(second[0]).as_quat()[[3, 0, 1, 2]]
    start = np.r_[first[0] @ c1, e[:, 0], v1, w1[:, 0], joint[0] + second[0] @ c2, f, v2, w2[:, 0]]
    inertias = [np.array([0.05, 0.1, 0.12]), np.array([0.06, 0.11, 0.14])]
    wanted = motion([1, 1.5], inertias, two_links, start, found.trajectory.times)
    assert w1 == pytest.approx(wanted[10:13], abs=1e-7)
    assert w2 == pytest.approx(wanted[23:26], abs=1e-7)
    kept(found)


@pytest.mark.parametrize("tube", [0.0, 0.1])
def test_a_rolling_wheel_told_by_unit_vectors(tmp_path: Path, tube: float) -> None:
    """A disc, and a torus, upright at the pole of the angles; the contact is a function of the vertical in body axes.

    The relation of the height follows from the vertical row of rolling: of its four rows three are independent.
    """
    found = run(tmp_path, TORUS.replace("TUBE", str(tube)), 4)
    assert len(found.dynamics.constraints) == 4
    assert found.dynamics.constraints.rank == 3
    first, names = found.trajectory.states[:, 0], found.dynamics.inputs[1:]
    at = [names.index(x) for x in ("x", "y", "z", "x_dot", "y_dot", "z_dot", *"pqs")]
    x, y = first[at[:3]], first[at[3:]]
    assert x[2] == pytest.approx(0.4 + tube, abs=1e-14)
    wanted = motion(
        [1.5], [np.array([0.06, 0.12, 0.06])], rolling_torus(tube), np.r_[x, 1, 0, 0, 0, y], found.trajectory.times
    )
    assert np.array([column(found, x) for x in "xyz"]) == pytest.approx(wanted[:3], abs=1e-8)
    assert np.array([column(found, x) for x in "pqs"]) == pytest.approx(wanted[10:13], abs=1e-7)
    attitude = np.array([[column(found, f"{x}{k}") for k in (1, 2, 3)] for x in ("alpha", "beta", "gamma")])
    for own, e in zip(np.moveaxis(attitude, 2, 0), wanted[3:7].T, strict=True):
        assert own == pytest.approx(cosines(e), abs=1e-8)
    kept(found)
    assert found.conservation.standing is Standing.PROVED
    assert found.conservation.change < 1e-10


def test_model_py_integrates_the_ball_from_the_pole() -> None:
    """``speed_simulate`` from theta = 0, against the reference; there it had no code in speeds beside constraints."""
    module: dict[str, Any] = {}
    exec(str(FORMATS["python"].render(mbsym.loads(BALL, (3,)), (3,))), module)
    e, w = np.array([1.0, 0, 0, 0]), np.array([-1.0, 0.3, 2.0])
    v = -np.cross(w, [0, 0, -0.5])
    numbers = module["complete"]()
    times, found = module["speed_simulate"](6.0, numbers, np.r_[0, 0, e, 0, 0, w], samples=41)  # v is led to the rows
    wanted = motion([2], [np.array([0.1, 0.15, 0.22])], rolling_ball, np.r_[0, 0, 0.5, e, v, w], times)
    names = (*module["POSITIONS"], *module["SPEEDS"])
    led = found[:, 0] - np.r_[0, 0, e, v[:2], w]
    # The shortest way to the rows, measured by M, also turns the ball: it is begun where it was led to.
    start = dict(zip(names, found[:, 0], strict=True))
    assert abs(start["x_dot"] - 0.5 * start["q"]) < 1e-12
    assert abs(start["y_dot"] + 0.5 * start["p"]) < 1e-12
    assert np.max(np.abs(led)) > 0.01
    times, found = module["speed_simulate"](6.0, numbers, np.r_[0, 0, e, v[:2], w], samples=41)
    assert found[:2] == pytest.approx(wanted[:2], abs=1e-8)
    assert found[8:] == pytest.approx(wanted[10:13], abs=1e-8)


@pytest.mark.skipif(COMPILER is None, reason="no C compiler")
@pytest.mark.parametrize("text", [TORUS.replace("TUBE", "0.1"), LOOP.replace("ORIENTATION", "f: quaternion")])
def test_c_and_python_have_the_rates_of_runs(tmp_path: Path, text: str) -> None:
    """At a state beside the constraints, where rows that follow from others (the torus) do not follow."""
    analysis = mbsym.loads(text, (3,))
    (tmp_path / "model.c").write_text(c_source.render(analysis, (3,)), encoding="utf-8")
    (tmp_path / "model.h").write_text(c_source.header(analysis, (3,)), encoding="utf-8")
    command = [str(COMPILER), "-std=c99", "-Wall", "-Wextra", "-Werror", "-O1", "-shared", "-fPIC"]
    subprocess.run([*command, "-o", "model.so", "model.c", "-lm"], cwd=tmp_path, check=True)
    library, prefix = ctypes.CDLL(str(tmp_path / "model.so")), prefix_of(analysis.system.name)
    module: dict[str, Any] = {}
    exec(str(FORMATS["python"].render(analysis, (3,))), module)
    dynamics = StateDynamics(closed(scenario_in_states(scenario(analysis.system, declared=True))).scenario)
    state = np.array([float(x) for x in dynamics.scenario.state])
    state = state + 1e-3 * np.random.default_rng(1).normal(size=len(state))
    rates = arrays.kernel(dynamics.right_hand_side)(np.r_[0.0, state])
    numbers = module["complete"]()
    assert module["speed_rhs"](0.0, state, numbers) == pytest.approx(rates, rel=1e-9, abs=1e-9)
    kind, count = ctypes.c_double * len(state), len(analysis.system.parameter_names)
    found = kind()
    defaults = ctypes.byref((ctypes.c_double * count).in_dll(library, f"{prefix}_defaults"))
    assert library[f"{prefix}_speed_right_hand_side"](ctypes.c_double(0), kind(*state), defaults, found) == 0
    assert list(found) == pytest.approx(rates, rel=1e-9, abs=1e-9)
    led, restored = kind(*state), state
    library[f"{prefix}_speed_restore"].restype = None
    for _ in range(6):
        library[f"{prefix}_speed_restore"](ctypes.c_double(0), led, defaults)
        restored = module["speed_restored"](restored, numbers)
    assert list(led) == pytest.approx(restored, abs=1e-12)
    values = dynamics.constraints.at(0.0, restored)
    assert np.max(np.abs([*values.positions, *values.velocities])) < 1e-12


def test_the_energy_of_a_long_constrained_system_is_proved_by_its_multipliers() -> None:
    """dH/dt = (u - s0).J^T lambda = -lambda.g(s0), g(s0) the rows at rest: 0 on the ground, not on a belt that runs.

    Equations without multipliers are too long to be tried here: "none in closed form" was told of the torus.
    """
    text = TORUS.replace("TUBE", "0.1")
    ground, belt = "on: ground", "{name: belt, attached to: 0, connection point: [v*t, 0, 0], mass: 0}"
    found = [x for x in mbsym.loads(text, (7,)).integrals if x.kind != "unit vectors"]
    assert [(x.name, x.status) for x in found] == [("generalised energy", "proved")]
    text = text.replace(ground, "on: belt").replace("bodies:\n", f"bodies:\n  - {belt}\n")
    text = text.replace("parameters: {", "parameters: {v: positive, ")
    assert "generalised energy" not in [x.name for x in mbsym.loads(text, (7,)).integrals]


#: A knife edge under the connection point, the mass centre a = 1/3 before it, a moment 1:
#: u' = a w^2,  (1/2 + a^2) w' = 1 - a u w,  h' = w.
SLEIGH = """\
mbsym: 1
name: sleigh
bodies:
  - name: sleigh
    attached to: 0
    connection point: [x, y, 0]
    rotation: {axes: [3], angles: [h]}
    coordinates: [x, y, h]
    mass: 1
    mass centre: [1/3, 0, 0]
    inertia about: mass centre
    inertia: [1/2, 1/2, 1/2]
    speeds: {w: omega3, u: x_dot*cos(h) + y_dot*sin(h)}
constraints: [velocity: x_dot*sin(h) = y_dot*cos(h)]
loads: [generalized force: {h: 1}]
initial: {x: 0, y: 0, h: HEADING, w: 1, u: 1}
"""


def by_hand(heading: float, times: Any) -> Any:
    def rates(t: float, z: Any) -> list[float]:
        _, _, h, w, u = z
        return [u * np.cos(h), u * np.sin(h), w, (1 - u * w / 3) / (1 / 2 + 1 / 9), w * w / 3]

    found = solve_ivp(rates, (0, times[-1]), [0, 0, heading, 1, 1], "DOP853", times, rtol=1e-12, atol=1e-13)
    return found.y


@pytest.mark.parametrize(
    ("heading", "rate"), [("0", "y_dot"), ("pi/2", "x_dot"), ("3*pi/2", "x_dot"), ("0.3", "y_dot")]
)
def test_beside_a_forward_speed_a_velocity_is_kept_that_does_not_depend_on_it_at_the_start(
    heading: str, rate: str
) -> None:
    found = mbsym.loads(SLEIGH.replace("HEADING", heading), (3,))
    assert [u.name for u in found.form.speeds] == ["w", "u", rate]


@pytest.mark.parametrize(("heading", "ahead"), [("0", "x"), ("pi/2", "y"), ("3*pi/2", "y")])
def test_a_sleigh_along_an_axis_is_linearised_in_speeds_as_in_coordinates(heading: str, ahead: str) -> None:
    """Without the moment it goes straight ahead, along whichever axis: the root is -u a/(1/2 + a^2) = -6/11.

    What is solved for beside the constraint is regular on the motion.
    """
    text = SLEIGH.replace("HEADING", "0").replace("loads: [generalized force: {h: 1}]\n", "")
    u = -1 if heading == "3*pi/2" else 1
    text += f"motion: {{{ahead}: {{rate: {u}}}, h: {heading}}}\n"
    plain = text.replace("    speeds: {w: omega3, u: x_dot*cos(h) + y_dot*sin(h)}\n", "").replace("w: 1, u: 1", "")
    found = mbsym.loads(text, (5,))
    for form in (found.first_order, found.state_space, mbsym.loads(plain, (5,)).state_space):
        assert min(np.linalg.eigvals(numbers(form.A.polynomials)).real) == pytest.approx(-6 / 11)


def of_sleigh(heading: str, **how: Any) -> Any:
    analysis = mbsym.loads(SLEIGH.replace("HEADING", heading), (3,))
    return mbsym.simulate(analysis, 8.0, tolerance=1e-12, samples=17, estimate=False, **how)


@pytest.mark.parametrize(("heading", "angle"), [("0.3", 0.3), ("pi/2", np.pi / 2)])
def test_a_run_in_coordinates_begins_with_the_speeds_that_are_given(heading: str, angle: float) -> None:
    run = of_sleigh(heading, variables="coordinates")
    assert run.ended is None
    assert run.trajectory.states[:3].astype(float) == pytest.approx(by_hand(angle, run.trajectory.times)[:3], abs=1e-9)


def test_speeds_that_become_dependent_are_called_that() -> None:
    """With y_dot beside u at h = pi/2, or at an odd multiple of it: one that a run steps over is no end."""
    run = of_sleigh("0.3")
    assert run.ended.kind == Cause.SINGULAR_SPEEDS
    at = by_hand(0.3, [0.0, run.ended.time])
    assert np.cos(at[2, -1]) == pytest.approx(0, abs=1e-3)


@pytest.mark.parametrize("values", [{"h": "pi/2"}, {"h": "-pi/2"}])
def test_a_start_in_which_speeds_are_dependent_is_refused(values: dict[str, str]) -> None:
    system = mbsym.loads(SLEIGH.replace("HEADING", "0"), (3,)).system
    with pytest.raises(Incomplete, match="do not follow from u, w"):
        scenario(system, read_values(system, values), declared=True)
