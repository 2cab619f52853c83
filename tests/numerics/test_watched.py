"""Runs that are watched: events of motions in closed form by every method, the rows unchanged, stops before the end."""

from __future__ import annotations

from math import pi, sin, sqrt
from pathlib import Path

import numpy as np
import pytest
from conftest import OWN, SHIPPED
from scipy.special import ellipk

import mbsym
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.events.events import Watcher
from mbsym.numerics.methods.interface import Cause, Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.scenario import scenario
from mbsym.numerics.watched import Watched
from mbsym.simulation import NoEvent, Request, Simulation, Watch, read_watch, simulate

#: A mathematical pendulum, m = l = g = 1, released at rest from two radians: theta = 0 at K, 3 K, 5 K, ...
PENDULUM = """
mbsym: 1
name: pendulum
bodies:
  - {name: bob, attached to: 0, rotation: {axes: [3], angles: [theta]}, mass centre: [0, -1, 0], mass: 1}
loads:
  - uniform gravity: {acceleration: 1, direction: [0, -1, 0]}
initial: {theta: 2}
"""
QUARTER = float(ellipk(sin(1) ** 2))


def pendulum(time: float, *events: str, **options: object) -> Simulation:
    analysis = mbsym.loads(PENDULUM)
    watch = read_watch(analysis.system, events)
    return simulate(scenario(analysis.system), Request(time, events=watch, estimate=False, **options))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("method", "finest", "allowed"),
    [
        ("dop853", 1e-14, 2e-12),
        ("rk45", 1e-12, 5e-11),
        ("scipy-dop853", 1e-13, 1e-11),
        ("lsoda", 1e-12, 2e-9),
        ("radau", 1e-9, 1e-7),
        ("rodas5p", 1e-12, 2e-9),
        ("bdf", 1e-9, 1e-5),
    ],
)
def test_a_pendulum_passes_its_lowest_point_at_odd_quarter_periods(method: str, finest: float, allowed: float) -> None:
    found = pendulum(30, "theta = 0", method=method, tolerance=finest).events
    assert found is not None
    expected = QUARTER * np.arange(1, 2 * len(found), 2)
    assert len(found) == 7
    assert np.max(np.abs(found.times - expected)) < allowed
    assert list(found.turns) == [-1, 1, -1, 1, -1, 1, -1]


@pytest.mark.parametrize(("method", "step"), [("rk4", 1e-3), ("midpoint6", 1e-2)])
def test_methods_of_fixed_step_are_watched_too(method: str, step: float) -> None:
    found = pendulum(30, "theta = 0", method=method, step=step).events
    assert found is not None
    assert np.max(np.abs(found.times - QUARTER * np.arange(1, 14, 2))) < 1e-9


def test_extended_arithmetic_and_taylor() -> None:
    pytest.importorskip("heyoka")
    for options in ({"method": "taylor", "tolerance": 1e-15}, {"arithmetic": "extended", "tolerance": 1e-17}):
        found = pendulum(30, "theta = 0", **options).events
        assert found is not None
        assert np.max(np.abs(found.times - QUARTER * np.arange(1, 14, 2))) < 2e-13


def test_the_rows_are_those_of_a_run_that_is_not_watched() -> None:
    for method in ("dop853", "radau", "rodas5p", "taylor", "lsoda"):
        if method == "taylor":
            pytest.importorskip("heyoka")
        plain, watched = pendulum(10, method=method), pendulum(10, "theta = 0", method=method)
        # Two runs of SciPy's LSODA that nobody watches differ in the last bit of 2 as well (150 of 150 did).
        scale = {"dop853": 1e-13, "rodas5p": 1e-13, "taylor": 1e-13, "lsoda": 1e-15}.get(method, 0)
        assert np.max(np.abs(plain.trajectory.states - watched.trajectory.states)) <= scale
        assert plain.trajectory.work.steps <= watched.trajectory.work.steps


def test_pericentre_passages_of_an_eccentric_orbit(tmp_path: Path) -> None:
    """e = 0.9: r.v = 0, rising, once a turn; 2 pi apart where a = 1.  The apocentre falls."""
    orbit = (OWN / "kepler.yaml").read_text().replace("2/5", "1/10").replace("velocity: 2", "velocity: sqrt(19)")
    (tmp_path / "orbit.yaml").write_text(orbit)
    found = mbsym.simulate(
        tmp_path / "orbit.yaml",
        100,
        tolerance=1e-14,
        events=["pericentre: x*x_dot + y*y_dot = 0 rising", "apocentre: x*x_dot + y*y_dot = 0 falling"],
        estimate=False,
    ).events
    assert found is not None
    # Started at the pericentre, which counts.
    assert found.of("pericentre") == pytest.approx(2 * pi * np.arange(16), abs=1e-9)
    assert found.of("apocentre") == pytest.approx(pi * np.arange(1, 32, 2), abs=1e-9)
    assert found.of("pericentre")[1] == pytest.approx(2 * pi, abs=2e-12)


def test_a_fall_to_the_centre_is_stopped_before_it_is_singular(tmp_path: Path) -> None:
    """From rest at r = 1: t(r) = (sqrt(r (1 - r)) + acos(sqrt r)) / sqrt 2."""
    fall = (
        (OWN / "kepler.yaml").read_text().replace("position: 2/5", "position: 1").replace("velocity: 2", "velocity: 0")
    )
    (tmp_path / "fall.yaml").write_text(fall)
    plain = mbsym.simulate(tmp_path / "fall.yaml", 2)
    assert not plain.whole
    run = mbsym.simulate(tmp_path / "fall.yaml", 2, stop="x < 1/10", tolerance=1e-13)
    assert run.whole
    r = 0.1
    expected = (sqrt(r * (1 - r)) + np.arccos(sqrt(r))) / sqrt(2)
    assert run.times[-1] == pytest.approx(expected, abs=1e-12)
    assert run["x"][-1] == pytest.approx(0.1, abs=1e-14)
    assert run.events is not None
    assert run.events.ended is not None
    assert np.all(np.diff(run.times) > 0)
    assert run.error.largest < 1e-9


def test_a_stop_between_two_rows_and_one_after_the_end() -> None:
    analysis = mbsym.loads(PENDULUM)
    for time, ends in ((1.2 * QUARTER, True), (0.999 * QUARTER, False)):
        watch = read_watch(analysis.system, (), ["theta = 0"])
        run = simulate(scenario(analysis.system), Request(time, samples=3, events=watch))
        assert run.whole
        assert run.times[-1] == pytest.approx(QUARTER if ends else time, abs=1e-9)
        assert run.events is not None
        assert (run.events.ended is not None) == ends
        assert len(run.events) == ends


def test_a_run_that_breaks_down_keeps_its_events() -> None:
    run = pendulum(1000, "theta = 0", step_limit=100)
    assert run.ended is not None
    assert run.ended.kind == Cause.STEP_LIMIT
    assert run.events is not None
    assert len(run.events) == np.sum(np.arange(1, 999, 2) * QUARTER <= run.times[-1])


def test_coordinates_that_rest_are_watched_in_whole_states() -> None:
    """theta of the spherical pendulum alone moves; the condition names what was taken out as well."""
    path = SHIPPED / "spherical-pendulum.yaml"
    name, other = mbsym.load(path, ()).system.coordinates
    run = mbsym.simulate(path, 5, events=[f"{name}_dot = 0", f"{other}_dot = 0"], estimate=False)
    assert run.events is not None
    assert run.events.states.shape[0] == 4


def test_a_restart_that_is_dropped_is_caught() -> None:
    """The control: a motion between events that is integrated on from where it was, not from the step's start."""
    dynamics = Dynamics(scenario(mbsym.loads(PENDULUM).system))
    watch = read_watch(dynamics.system, ["theta = 0"])

    class Forgetful(Watcher):
        def __init__(self, dynamics, events, tolerance, flow):  # type: ignore[no-untyped-def]
            first: list[float] = []

            def wrong(piece, time):  # type: ignore[no-untyped-def]
                state = flow(piece, time)
                first.append(time)
                return state if len(first) < 2 else state * 1.001

            super().__init__(dynamics, events, tolerance, wrong)

    from mbsym.numerics.events.surfaces import event

    events = [event(dynamics, condition) for condition in watch.events]
    errors = []
    for kind in (Watcher, Forgetful):
        method = Watched(METHODS["dop853"], dynamics, events, kind)
        method.start(dynamics, Setting(1e-12)).fill([0.0, 30.0])
        states = method.occurrences(30.0).states
        energy = states[1] ** 2 / 2 - np.cos(states[0])
        errors.append(np.max(np.abs(energy + np.cos(2))))
    assert errors[0] < 1e-10 < 1e-4 < errors[1]


def test_what_cannot_be_watched_is_said_at_once() -> None:
    system = mbsym.loads(PENDULUM).system
    with pytest.raises(ValueError, match=r"phi.*one of = < >.*axes"):
        read_watch(system, ["phi = 0"], ["theta"], None, "theta")
    with pytest.raises(NoEvent, match="no value"):
        pendulum(1, "theta**(1/3) = 0")
    assert not Watch()
    found = read_watch(system, (), (), "t = 0 mod 1/2", "theta mod 2*pi, theta_dot, energy")
    run = simulate(scenario(system), Request(5, events=found))
    assert run.section is not None
    assert run.section.points.shape == (3, 11)
    assert run.section.points[2] == pytest.approx(-np.cos(2), abs=1e-9)
