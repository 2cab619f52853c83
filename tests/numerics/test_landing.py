"""Runs over switches and narrow features, by every method, against motions in closed form and independent solutions."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

import mbsym
from mbsym.numerics.accuracy import NoEstimate
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.llvm import kernels
from mbsym.numerics.methods import runge_kutta, sides
from mbsym.numerics.methods.interface import Breakdown, Setting, compiled_kernel, up_to
from mbsym.numerics.methods.landing import LandingRun
from mbsym.numerics.methods.sides import Leaving
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.scenario import scenario

LINE = (
    "mbsym: 1\nname: one\nbodies:\n"
    "  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}\nloads:\n"
)
SPRING = "  - potential: x**2/2\n"
#: For systems with forces of any kind, and how far each may be off at a tolerance of 1e-10 or a step of 0.01.
ALLOWED = {
    "rk4": 2e-8,
    "rk45": 2e-9,
    "dop853": 2e-9,
    "taylor": 2e-9,
    "scipy-dop853": 1e-8,
    "radau": 2e-9,
    "bdf": 1e-6,
    "rodas5p": 2e-9,
}


def described(force: str, more: str = SPRING, start: str = "position: 0") -> str:
    return f"{LINE}{more}  - generalized force:\n      x: {force}\ninitial: {{x: {{{start}}}}}\n"


def run_of(name: str, text: str, **setting: Any) -> LandingRun:
    method = METHODS[name]
    chosen = Setting(None, 0.01) if method.traits.fixed else Setting(1e-10, **setting)
    found = method.start(Dynamics(scenario(mbsym.loads(text).system)), chosen)
    assert isinstance(found, LandingRun)
    return found


@pytest.mark.parametrize("method", ["dop853", "auto"])
def test_steps_between_switches_are_as_long_as_they_may_be(method: str) -> None:
    """x'' = -x + s, s = 1 and -1 in turn for pi/5 each, comes to rest at x = 1 now and then, but for roundings.

    By hand from switch to switch.  It took 10,561 steps: a step that overshot a switch was begun again with a tiny one,
    and what rests on one side was measured by its roundings.
    """
    text = described("sign(sin(5*t))", start="position: 1")
    found = mbsym.simulate(mbsym.loads(text), 20, samples=11, method=method, estimate=False)
    x, v, side, begun, part = 1.0, 0.0, 1.0, 0.0, np.pi / 5
    for end in (*np.arange(1, 32) * part, 20.0):
        c, s, y = np.cos(end - begun), np.sin(end - begun), x - side
        x, v, side, begun = side + y * c + v * s, v * c - y * s, -side, end
    assert found.trajectory.states[:, -1] == pytest.approx([x, v], abs=1e-9)
    assert found.trajectory.work.steps < 400


def push(t: Any) -> Any:
    """x'' = -x + 500 between t = 5 and 5.002, by Duhamel's integral."""
    one, other = (np.where(t > a, 1 - np.cos(t - a), 0.0) for a in (5, 5.002))
    return 500 * (one - other)


def bang(t: Any) -> Any:
    """x'' = -sign x from x = 1: parabolas, a quarter of the period takes sqrt 2."""
    quarter = math.sqrt(2)
    s = np.mod(t, 4 * quarter)
    near = np.where(s < quarter, s, np.where(s < 3 * quarter, s - 2 * quarter, s - 4 * quarter))
    return np.where(np.abs(s - 2 * quarter) <= quarter, -1, 1) * (1 - near**2 / 2)


def rubbed(t: Any) -> Any:
    """x'' = -x - 3/10 sign x' from x = 2: half periods about +-3/10; where |x| < 3/10 at rest it sticks."""
    half = np.minimum(np.floor(t / np.pi), 3).astype(int)
    centre = np.where(half % 2 == 0, 0.3, -0.3)
    amplitude = np.array([1.7, 1.1, 0.5, 0.0])[half]
    return np.where(half == 3, -0.2, centre + np.where(half % 2 == 0, 1, -1) * amplitude * np.cos(t - np.pi * half))


def belt(t: Any) -> Any:
    """x'' = -x - sign(x' - 1/10)/2 from rest: slips, sticks at v = 1/10 until x = 1/2, and slips on."""
    first = math.asin(0.2)
    x1 = 0.5 * (1 - math.cos(first))
    leaves = first + (0.5 - x1) / 0.1
    later = 0.5 + 0.1 * np.sin(t - leaves)
    return np.where(t < first, 0.5 * (1 - np.cos(t)), np.where(t < leaves, x1 + 0.1 * (t - first), later))


def corner(t: Any) -> Any:
    """x'' = -d|x|/dx by a potential: the same as the bang-bang."""
    return bang(t)


CASES: dict[str, tuple[str, Callable[[Any], Any], float]] = {
    "a push of 2 ms": (described("500*pulse(t, 5, 5.002)"), push, 20),
    "bang-bang": (described("-sign(x)", "", "position: 1"), bang, 30),
    "dry friction": (described("-0.3*sign(x_dot)", SPRING, "position: 2"), rubbed, 20),
    "stick and slip": (described("-sign(x_dot - 1/10)/2"), belt, 11),
    "a potential with a kink": (described("0*x", "  - potential: abs(x)\n", "position: 1"), corner, 30),
}


@pytest.mark.parametrize("name", ALLOWED)
@pytest.mark.parametrize("case", CASES)
def test_every_method_keeps_its_order_over_switches(case: str, name: str) -> None:
    text, exact, end = CASES[case]
    if name == "bdf" and case not in ("a push of 2 ms", "dry friction"):
        pytest.skip("of first order after every restart, which bends no curve away from a switch")
    run = run_of(name, text)
    times = np.linspace(0, end, 400)[1:]
    assert np.max(np.abs(run.fill(times)[0] - exact(times))) < ALLOWED[name]


def test_steps_end_at_switches() -> None:
    run = run_of("dop853", CASES["a push of 2 ms"][0])
    run.advance(20.0)
    assert run.passed.switches == pytest.approx([5, 5.002], abs=1e-14)
    run = run_of("rk45", CASES["bang-bang"][0])
    run.advance(30.0)
    quarter = math.sqrt(2)
    assert run.passed.switches == pytest.approx([quarter * k for k in range(1, 22, 2)], abs=1e-10)


#: A load beside the spring, from rest, and the width that it has.
NARROW = {
    "100*exp(-((t - 5.3)/0.001)**2)": 0.001,
    "100*(tanh((t - 5.3)/0.001) - tanh((t - 5.304)/0.001))": 0.001,
    "100/(1 + ((t - 5.3)/0.0005)**2)": 0.0005,
    "30*exp(-((t - 7)/0.0002)**2)": 0.0002,
}


@pytest.mark.parametrize("name", ["dop853", "rk45", "radau", "rodas5p", "taylor"])
@pytest.mark.parametrize("load", NARROW)
def test_a_narrow_load_is_not_stepped_over(load: str, name: str) -> None:
    """Against Duhamel's integral x(T) = integral of sin(T - t) F(t)."""
    run, end = run_of(name, described(load)), 12.0
    written = load.replace("exp", "math.exp").replace("tanh", "math.tanh")
    centre = 7 if "(t - 7)" in load else 5.302
    points = [centre + k * NARROW[load] for k in (-40, -10, -4, 0, 4, 10, 40)]

    def slope(t: float) -> float:
        force: float = eval(written, {"math": math, "t": t})
        return math.sin(end - t) * force

    exact = quad(slope, 0, end, points=points, limit=2000, epsabs=1e-13, epsrel=1e-13)[0]
    assert abs(exact) > 1e-4
    assert run.advance(end)[0] == pytest.approx(exact, abs=1e-8)


@pytest.mark.parametrize("name", ["dop853", "radau", "rodas5p", "taylor"])
def test_a_wall_is_not_stepped_through(name: str) -> None:
    """x'' = exp(-1000 x): by the energy v^2/2 + exp(-1000 x)/1000, and by the solution written by hand."""
    text = described("exp(-1000*x)", "", "position: 1/2, velocity: -1")
    state = run_of(name, text).advance(2.0)
    assert state[1] == pytest.approx(1, abs=1e-9)
    found = solve_ivp(
        lambda t, y: [y[1], math.exp(-1000 * y[0])], (0, 2), [0.5, -1], method="Radau", rtol=1e-12, atol=1e-13,
        max_step=1e-3,
    )  # fmt: skip
    assert state[0] == pytest.approx(found.y[0, -1], abs=2e-8)


def test_fixed_steps_pass_a_narrow_load_and_say_so() -> None:
    run = run_of("rk4", described("100*exp(-((t - 5.3)/0.001)**2)"))
    run.advance(20.0)
    assert {(round(one.time, 9), round(one.width, 9)) for one in run.passed.narrow} == {(5.3, 0.001)}
    assert not any(one.followed for one in run.passed.narrow)
    adaptive = run_of("dop853", described("100*exp(-((t - 5.3)/0.001)**2)"))
    adaptive.advance(20.0)
    assert [one.followed for one in adaptive.passed.narrow] == [True]


def test_a_motion_that_two_frictions_would_hold_ends_by_name() -> None:
    """Both velocities would stick at once, which one sign cannot tell: no endless loop, no guess."""
    text = (
        "mbsym: 1\nname: two\nbodies:\n"
        "  - {name: p, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}\nloads:\n"
        "  - generalized force:\n      x: -sign(x_dot)\n      y: -sign(y_dot)\n"
        "initial: {x: {position: 0, velocity: 1}, y: {position: 0, velocity: 2}}\n"
    )
    run = run_of("dop853", text)
    with pytest.raises(Breakdown, match="hold at once") as found:
        run.advance(5.0)
    assert found.value.kind == sides.SWITCHING
    assert found.value.time == pytest.approx(2)


def test_a_kernel_of_signs_is_what_the_text_says() -> None:
    dynamics = Dynamics(scenario(mbsym.loads(CASES["stick and slip"][0]).system))
    assert len(dynamics.switches.outputs) == 1
    assert dynamics.features.kinds == ()
    smooth = Dynamics(scenario(mbsym.load("systems/double-pendulum.yaml", ()).system))
    assert smooth.features.none


# --- planted mistakes ---


def test_a_dropped_switch_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Leaving, "first", lambda self, piece, sides: (piece.end, ()))
    for case in ("a push of 2 ms", "bang-bang", "dry friction"):
        with pytest.raises(Breakdown, match="a switch was missed"):
            run_of("dop853", CASES[case][0]).advance(10.0)


def test_a_switch_at_the_wrong_time_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    right = Leaving._polished
    monkeypatch.setattr(Leaving, "_polished", lambda *arguments: right(*arguments) + 1e-3)
    run = mbsym.simulate(mbsym.loads(CASES["bang-bang"][0]), 10, method="dop853", estimate=True)
    assert not run.whole or isinstance(run.error, NoEstimate) or run.error.largest > 1e-6


def test_a_feature_that_is_not_looked_for_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The better run takes no step longer than a two thousandth of the whole."""
    monkeypatch.setattr(LandingRun, "_window", lambda self, piece: None)
    run = mbsym.simulate(mbsym.loads(described("100*exp(-((t - 5.3)/0.02)**2)")), 20, method="taylor", estimate=True)
    assert isinstance(run.error, NoEstimate) or run.error.largest > 1e-3


def test_all_sides_of_switches_share_one_compiled_kernel(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    whole = runge_kutta.compiled
    monkeypatch.setattr(runge_kutta, "compiled", lambda *given, **more: made.append(1) or whole(*given, **more))
    text = described("500*pulse(t, 5, 5 + 1/500) + step(t - 7) - step(t - 8) - 3*sign(x - 100)")
    run = run_of("dop853", text)
    times = np.linspace(0.0, 6.9, 24)[1:]
    states = run.fill(times)
    assert len(made) == 1
    # -3 sign(x - 100) is 3 here: x'' = 3 - x and the push.
    assert np.max(np.abs(states[0] - push(times) - 3 * (1 - np.cos(times)))) < 2e-8
    passed = up_to(run.passed, 6.9)  # the last step may end at the switch behind
    assert passed is not None
    assert len(passed.switches) == 2


@pytest.mark.parametrize("scalar", ["float64", "float32", "extended"])
def test_signs_are_read_from_memory_by_every_kernel(scalar: str) -> None:
    dynamics = Dynamics(scenario(mbsym.loads(described("-2*abs(x) + 5*sign(x_dot)", more="")).system))
    points = np.array([[0.0] * 9, np.linspace(1, 3, 9), np.linspace(4, 6, 9)])
    held = compiled_kernel(dynamics.on_sides((1, 1)), "right_hand_side", scalar)
    wide = kernels({"f": dynamics.on_sides((1, 1)).right_hand_side}, scalar, wide=True)["f"]
    signs = [node.number for node in dynamics.switches.outputs]
    program = dynamics.switches.program
    of_x = next(k for k, number in enumerate(signs) if program.instructions[number].payload == "x")
    for by_x in (-1, 1):
        for by_speed in (-1, 1):
            dynamics.on_sides((by_x, by_speed) if of_x == 0 else (by_speed, by_x))
            exact = -2 * by_x * points[1] + 5 * by_speed  # |x| is sign(x) x with the sign that is held
            for found in (held(points), wide(points), held(points[:, 3])[:, None]):
                expected = exact if found.shape[1] > 1 else exact[3:4]
                assert np.allclose(found[1].astype(float), expected, rtol=1e-6, atol=0)


def test_time_for_compiling_is_no_time_of_the_run() -> None:
    run = run_of("dop853", described("-3/10*sign(x_dot)", start="position: 2"))
    run.advance(4.0)
    assert run.work.compiling > 0


def test_short_floats_of_a_method_end_no_run_at_a_switch_between_them() -> None:
    """A Taylor series in float32 that looks for the wall of a contact: its steps end at short floats.

    What it lands on may be nearer than one of them: the nearest stands for the switch, and the run goes on, in place of
    trying for ever, to what float64 finds.
    """
    pytest.importorskip("heyoka")
    from truth.independent.scenes import SCENES

    scene = next(scene for scene in SCENES if scene.name == "contact")
    given = scenario(mbsym.loads(scene.text).system)
    run = METHODS["taylor"].start(Dynamics(given), Setting(1e-2), "float32")
    times = np.linspace(0.0, scene.time, 1001)
    exact = METHODS["dop853"].start(Dynamics(given), Setting(1e-10)).fill(times[1:])
    assert np.max(np.abs(run.fill(times[1:])[0] - exact[0])) < 1e-2


def rubbed_spring(t: Any) -> Any:
    """x'' = -4 x - sign x', from rest at 5.3: each half period pi/2 the amplitude loses 1/2.

    In the k-th one x = (-1)^k (1/4 + (5.3 - k/2 - 1/4) cos 2 (t - k pi/2)).
    """
    k = np.floor(t / (math.pi / 2))
    return (-1.0) ** k * (0.25 + (5.05 - 0.5 * k) * np.cos(2 * (t - k * math.pi / 2)))


def test_rows_between_a_switch_and_the_nearest_short_float_belong_to_the_step_that_begins_there() -> None:
    """3 pi/2 lies between short floats 5e-7 apart: a series that begins at the nearest one begins at the switch."""
    pytest.importorskip("heyoka")
    text = described("-sign(x_dot)", "  - potential: 2*x**2\n", "position: 5.3")
    run = METHODS["taylor"].start(Dynamics(scenario(mbsym.loads(text).system)), Setting(1e-6), "float32")
    turns = [k * math.pi / 2 + np.linspace(-3e-7, 3e-7, 25) for k in range(1, 5)]
    times = np.unique(np.concatenate([np.linspace(0, 7.5, 300)[1:], *turns]))
    assert np.max(np.abs(run.fill(times)[0] - rubbed_spring(times))) < 3e-5


def soft_and_hard(t: float) -> float:
    """x'' = -x where x > 0, -10000 x where x < 0, from x = 1: half cosines of periods pi and pi/100 in turns."""
    s = math.fmod(t, 1.01 * math.pi)
    if s <= math.pi / 2:
        return math.cos(s)
    if s <= 0.51 * math.pi:
        return -math.sin(100 * (s - math.pi / 2)) / 100
    return math.cos(s - 1.01 * math.pi)


@pytest.mark.parametrize("name", ["dop853", "rk45"])
@pytest.mark.parametrize("size", [1, 10**6])
def test_coarse_steps_beside_a_switch_pass_it(name: str, size: int) -> None:
    """A coarse step ends beside the switch; the next one, made for the other side, is hardly longer than roundings."""
    text = described("-x*(1 + 9999*(1 - sign(x))/2)", more="", start=f"position: {size}")
    for tolerance in (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8):
        run = METHODS[name].start(Dynamics(scenario(mbsym.loads(text).system)), Setting(tolerance))
        worst = 0.0
        while run.time < 10:
            run.step(10)
            worst = max(worst, abs(run.state[0] / size - soft_and_hard(run.time)))
        assert worst <= 10 * tolerance
        assert run.work.steps < 1000


@pytest.mark.parametrize("length", [-12, -9, 6])
@pytest.mark.parametrize("frequency", [-6, 0, 6])
def test_dry_friction_and_contact_do_not_depend_on_units(length: int, frequency: int) -> None:
    """Powers of ten: runs over nanometres, or years, passed switches by, and told nothing of it."""
    unit, square, w = f"10**({length})", f"10**({2 * frequency})", 10.0**frequency
    rub = f"-{square}*{unit}*3/10*sign(x_dot)", rubbed, 2, f"{square}*x**2/2"
    wall = f"-{square}*x*(1 + 9999*(1 - sign(x))/2)", np.vectorize(soft_and_hard), 1, "0*x"
    for force, truth, start, potential in (rub, wall):
        text = described(force, f"  - potential: {potential}\n", f"position: {start}*{unit}")
        found = mbsym.simulate(mbsym.loads(text), 12 / w, samples=61, estimate=False)
        assert np.max(np.abs(found["x"] / 10.0**length - truth(found.times * w))) < 1e-8


def test_switches_in_more_digits_are_told_in_json() -> None:
    """x'' + 4 x = -sign x' from 5.3 turns at k pi/2; times of extended arithmetic have more digits than JSON's."""
    from mbsym.report.runs.simulation_json import simulation_json

    text = described("-sign(x_dot)", "  - potential: 2*x**2\n", "position: 5.3")
    found = mbsym.simulate(mbsym.loads(text), 5, samples=11, arithmetic="extended", estimate=False)
    assert found.trajectory.passed.switches[:3] == pytest.approx([k * math.pi / 2 for k in (1, 2, 3)], abs=1e-9)
    assert '"arithmetic": "extended"' in simulation_json(found, [])
