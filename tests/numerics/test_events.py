"""Events against motions in closed form: when they happen to rounding, none missed, none invented, in order."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import replace
from math import acos, asin, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from conftest import filed

import mbsym
from mbsym.expressions.condition import Condition, parse_condition
from mbsym.expressions.place import Complaints, Span
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.events.events import Occurrences, Watcher
from mbsym.numerics.events.surfaces import Action, Direction, event, known_names
from mbsym.numerics.methods.interface import Piece
from mbsym.numerics.scenario import scenario
from mbsym_cli.main import main

OSCILLATOR = """
mbsym: 1
name: oscillator
parameters: {m: positive, k: positive, p: positive}
bodies:
  - {name: b, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
loads:
  - spring: {coordinate: x, stiffness: k}
values: {m: 1, k: 1, p: 2}
initial: {x: {position: 0, velocity: 1}}
"""

State = Callable[[Any], Any]


def exact(motion: State, start: float, end: float) -> Piece:
    """A step of a motion that is known."""
    return Piece(start, end, motion)


@pytest.fixture(scope="module")
def oscillator() -> Dynamics:
    return Dynamics(scenario(mbsym.loads(OSCILLATOR).system))


def sine(times: Any) -> Any:
    """x(t) = sin t."""
    return np.array([np.sin(times), np.cos(times)])


def condition(dynamics: Dynamics, text: str) -> Condition:
    complaints = Complaints()
    found = parse_condition(text, known_names(dynamics.system), complaints, lambda a, b: Span(1, a + 1, b - a))
    assert found is not None, complaints.items
    return found


def watched(
    dynamics: Dynamics,
    texts: Sequence[str],
    motion: State,
    borders: Sequence[float],
    stop: Sequence[str] = (),
    tolerance: float = 1e-13,
) -> Occurrences:
    """What happens along an exact motion that is shown in steps."""
    events = [event(dynamics, condition(dynamics, text)) for text in texts]
    events += [event(dynamics, condition(dynamics, text), Action.STOP) for text in stop]
    watcher = Watcher(dynamics, events, tolerance, lambda piece, time: motion(np.array([time]))[:, 0])
    watcher.begin(motion(np.array([borders[0]]))[:, 0], borders[0])
    for start, end in itertools.pairwise(borders):
        if watcher.see(exact(motion, start, end)):
            break
    return watcher.finish(borders[-1])


STEPS = np.linspace(0, 40, 37)


def test_zeros_of_a_sine_to_rounding_the_start_included(oscillator: Dynamics) -> None:
    found = watched(oscillator, ["x = 0"], sine, STEPS)
    expected = np.arange(0, 40, pi)
    assert len(found) == len(expected)
    assert np.max(np.abs(found.times - expected)) < 1e-14
    assert list(found.turns[:4]) == [1, -1, 1, -1]
    assert np.max(np.abs(found.states[0])) < 1e-14


def test_directions(oscillator: Dynamics) -> None:
    found = watched(oscillator, ["x = 1/2 rising", "x = 1/2 falling", "x > 1/2", "low: x < 1/2"], sine, STEPS)
    up, down = np.arange(asin(0.5), 40, 2 * pi), np.arange(pi - asin(0.5), 40, 2 * pi)
    for name, expected in (("x = 1/2 rising", up), ("x = 1/2 falling", down), ("x > 1/2", up), ("low", down)):
        assert found.of(name) == pytest.approx(expected, abs=1e-13)
    assert np.all(np.diff(found.times) >= 0)


def test_an_event_in_the_wrong_direction_is_another_event(oscillator: Dynamics) -> None:
    """The control: were directions ignored, or turned round, the test above could not hold."""
    first = event(oscillator, condition(oscillator, "x = 1/2 rising"))
    wrong = replace(first, direction=Direction.FALLING)
    watcher = Watcher(oscillator, [wrong], 1e-13, lambda piece, time: sine(np.array([time]))[:, 0])
    watcher.see(exact(sine, 0.0, 6.0))
    times = watcher.finish(6.0).times
    assert abs(times[0] - asin(0.5)) > 1
    assert times[0] == pytest.approx(pi - asin(0.5), abs=1e-13)


def test_many_passages_within_one_step(oscillator: Dynamics) -> None:
    """One step over three periods: 48 sign changes of cos(8 t), none missed."""
    found = watched(oscillator, ["cos(8*t) = 0"], sine, [0.0, 6 * pi + 0.1])
    expected = (np.arange(1, 49) - 0.5) * pi / 8
    assert found.times == pytest.approx(expected, abs=1e-12)


def test_a_pair_of_passages_between_equal_signs_at_the_ends_of_a_step(oscillator: Dynamics) -> None:
    """x passes 0.999999 twice within a part of a step at whose ends, and in most of which, it is below."""
    level = 0.999999
    found = watched(oscillator, ["x = 999999/10**6"], sine, [0.0, 3.0])
    assert found.times == pytest.approx([asin(level), pi - asin(level)], abs=1e-12)
    assert list(found.turns) == [1, -1]


def test_grazing_is_said_to_be_grazing(oscillator: Dynamics) -> None:
    found = watched(oscillator, ["x = 1", "x > 1"], sine, STEPS)
    assert set(found.turns) == {0}
    assert set(found.which) == {0}
    assert found.times == pytest.approx(np.arange(pi / 2, 40, 2 * pi), abs=1e-6)
    assert len(watched(oscillator, ["x = 1 + 10**(-9)"], sine, STEPS)) == 0
    near = watched(oscillator, ["x = 1 - 10**(-9)"], sine, STEPS)
    assert set(near.turns) == {-1, 1}
    assert len(near) == 14
    assert near.times[0] == pytest.approx(acos(-1) / 2 - acos(1 - 1e-9), abs=1e-9)


def test_a_quantity_that_stays_at_zero_is_undecided_not_an_event(oscillator: Dynamics) -> None:
    found = watched(oscillator, ["energy = 1/2", "x - x = 0", "x = 2"], sine, STEPS)
    assert len(found) == 0
    assert [one.name for one in found.undecided] == ["energy = 1/2", "x - x = 0"]


def test_simultaneous_events_are_in_the_order_of_the_options(oscillator: Dynamics) -> None:
    found = watched(oscillator, ["x = 1/2", "2*x = 1", "x_dot = sqrt(3)/2"], sine, [0.0, 1.5])
    assert found.times == pytest.approx([pi / 6] * 3, abs=1e-14)
    assert sorted(found.which) == [0, 1, 2]


def test_modulo_a_period(oscillator: Dynamics) -> None:
    def turning(times: Any) -> Any:
        return np.array([7.0 * times, np.full_like(times, 7.0)])

    def backwards(times: Any) -> Any:
        return np.array([-7.0 * times, np.full_like(times, -7.0)])

    once = watched(oscillator, ["x = pi/2"], turning, STEPS)
    assert once.times == pytest.approx([pi / 14], abs=1e-14)
    rising = watched(oscillator, ["x = pi/2 mod 2*pi rising"], turning, STEPS)
    assert rising.times == pytest.approx((pi / 2 + 2 * pi * np.arange(len(rising))) / 7, abs=1e-13)
    assert len(rising) == 45
    assert set(rising.turns) == {1}
    assert len(watched(oscillator, ["x = pi/2 mod 2*pi rising"], backwards, STEPS)) == 0
    stroboscope = watched(oscillator, ["t = 0 mod p"], turning, STEPS)
    assert stroboscope.times == pytest.approx(2 * np.arange(21), abs=1e-12)


def test_stop_ends_it_and_nothing_later_is_kept(oscillator: Dynamics) -> None:
    found = watched(oscillator, ["x = 0", "x = -1/2"], sine, STEPS, stop=["x < -1/4"])
    assert found.ended is not None
    assert found.ended.time == pytest.approx(pi + asin(0.25), abs=1e-14)
    assert found.times == pytest.approx([0, pi, pi + asin(0.25)], abs=1e-14)


def test_what_holds_at_the_start_stops_there_and_a_start_on_the_surface_does_not(oscillator: Dynamics) -> None:
    at_once = watched(oscillator, [], sine, STEPS, stop=["x < 1/4"])
    assert at_once.ended is not None
    assert at_once.ended.time == 0
    later = watched(oscillator, [], sine, STEPS, stop=["x = 0"])
    assert later.ended is not None
    assert later.ended.time == pytest.approx(pi, abs=1e-14)
    equal = watched(oscillator, [], sine, STEPS, stop=["x <= 0"])
    assert equal.ended is not None
    assert equal.ended.time == 0
    below = watched(oscillator, [], sine, STEPS, stop=["x < 0"])
    assert below.ended is not None
    assert below.ended.time == pytest.approx(pi, abs=1e-14)


def test_thousands_of_events(oscillator: Dynamics) -> None:
    borders = np.linspace(0, 20_000, 12_001)
    found = watched(oscillator, ["x = 0"], sine, borders)
    assert len(found) == 6367
    assert np.max(np.abs(found.times - pi * np.arange(6367))) < 1e-11


def test_a_jump_and_a_kink_are_found(oscillator: Dynamics) -> None:
    found = watched(oscillator, ["sqrt(x**2) = 1/2", "(x - 1/4)/sqrt((x - 1/4)**2) = 0"], sine, [0.0, 3.0])
    assert found.of("sqrt(x**2) = 1/2") == pytest.approx([pi / 6, 5 * pi / 6], abs=1e-12)
    jumps = found.of("(x - 1/4)/sqrt((x - 1/4)**2) = 0")
    assert jumps == pytest.approx([asin(0.25), pi - asin(0.25)], abs=1e-4)


def test_an_error_of_the_dense_output_is_polished_away(oscillator: Dynamics) -> None:
    """Between its ends a step is wrong by 1e-6; the motion from its start is not."""

    def wrong(times: Any) -> Any:
        return sine(times) + 1e-6 * np.sin(times * pi / 3) ** 2

    events = [event(oscillator, condition(oscillator, "x = 1/2"))]
    for right in (True, False):
        flow = sine if right else wrong
        watcher = Watcher(oscillator, events, 1e-7, lambda piece, time, flow=flow: flow(np.array([time]))[:, 0])
        for k in range(4):
            watcher.see(exact(wrong, 3.0 * k, 3.0 * k + 3))
        error = np.abs(watcher.finish(12.0).times - [pi / 6, 5 * pi / 6, 13 * pi / 6, 17 * pi / 6])
        assert (np.max(error) < 1e-13) if right else (np.max(error) > 1e-7)


def test_an_event_at_the_end_counts(oscillator: Dynamics) -> None:
    found = watched(oscillator, ["x = 0"], sine, [0.0, 2.0, pi])
    assert found.times == pytest.approx([0, pi], abs=1e-15)
    assert list(found.turns) == [1, -1]


def test_what_stops_at_once_or_does_not_is_told(tmp_path: Path) -> None:
    """x = cos t: x <= 1 holds at the start, x = 1 is met there and touched later, which stops nothing."""
    path = filed(tmp_path / "oscillator.yaml", COSINE)
    told = " ".join(invoked(path, "x <= 1", tmp_path).split())
    assert "stopped at t = 0 by x <= 1" in told
    assert "breaks down" not in told
    told = " ".join(invoked(path, "x = 1", tmp_path).split())
    assert "touching, or at the start, it stops nothing" in told


COSINE = """
mbsym: 1
name: Oscillator
bodies: [{name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}]
loads: [{spring: {coordinate: x, stiffness: 1}}]
initial: {x: 1}
"""


def invoked(path: Path, stop: str, folder: Path) -> str:
    done = CliRunner().invoke(
        main, ["simulate", str(path), "--time", "7", "--stop", stop, "--out", str(folder / "out")]
    )
    assert done.exit_code == 0, done.output
    return done.output
