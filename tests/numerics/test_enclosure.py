"""Enclosures of exact solutions: against motions in closed form, and with mistakes planted in every bound."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest
from conftest import dynamics_of
from flint import acb, arb, arb_series, ctx
from hypothesis import given
from hypothesis import strategies as st
from properties import settings

import mbsym
from mbsym.numerics.enclosure import enclose as segments
from mbsym.numerics.enclosure.compare import Certificate, certified
from mbsym.numerics.enclosure.enclose import INTERRUPTED, NO_STEP, OUT_OF_TIME, TOO_DEAR, Enclosure, enclosed
from mbsym.numerics.enclosure.field import Field, Model, Ring, cap
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.trade.trial import trial_of
from mbsym.report.runs.certificate import certificate_lines

LINE = (
    "mbsym: 1\nname: one\nbodies:\n"
    "  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}\n"
)
PLANE = LINE.replace("[x, 0, 0]", "[x, y, 0]").replace("[x]", "[x, y]")
OSCILLATOR = LINE + "loads:\n  - potential: x**2/2\ninitial: {x: 1}\n"
#: x'' = -sin x.
PENDULUM = LINE + "loads:\n  - potential: 1 - cos(x)\ninitial: {x: 2}\n"
#: An ellipse with e = 9/10, from its pericentre: fast there, slow elsewhere.
KEPLER = (
    PLANE + "loads:\n  - potential: -1/sqrt(x**2 + y**2)\ninitial: {x: 1/10, y: {position: 0, velocity: sqrt(19)}}\n"
)
#: x'' = cos(t)^2 is driven through a load that depends on time.
DRIVEN = LINE + "loads:\n  - generalized force: {x: cos(t)**2}\ninitial: {x: 0}\n"
#: x'' = 6 x^2 with x = 1/(1 - t)^2: ends at t = 1.
BLOW_UP = LINE + "loads:\n  - potential: -2*x**3\ninitial: {x: {position: 1, velocity: 2}}\n"


def enclosure_of(text: str, end: float, width: float = 1e-12, **more: Any) -> Enclosure:
    dynamics = dynamics_of(text)
    ones = [1.0] * (2 * dynamics.size)
    state = dynamics.scenario.state
    return enclosed(dynamics.right_hand_side, dynamics.jacobian, state, end, width, ones, **more)


def inside(found: list[arb], exact: list[Any]) -> bool:
    """Whether every ball contains the number, known to 60 digits."""
    with ctx.workprec(240):
        points = [arb(str(value), 1e-50) for value in exact]
        return all(bool(ball.overlaps(point)) for ball, point in zip(found, points, strict=True))


def pendulum(t: float) -> list[Any]:
    """x'' = -sin x from 2 at rest: sin(x/2) = k cd(t), k = sin 1."""
    k = mpmath.sin(1)
    cd, sd = (mpmath.ellipfun(name, t, m=k * k) for name in ("cd", "sd"))
    dn = mpmath.ellipfun("dn", t, m=k * k)
    q = 2 * mpmath.asin(k * cd)
    slope = -(1 - k * k) * sd / dn  # of cd
    return [q, 2 * k * slope / mpmath.sqrt(1 - (k * cd) ** 2)]


def kepler(t: float) -> list[Any]:
    e = mpmath.mpf(9) / 10
    start = t if t < 1 else mpmath.pi if t < 5 else 2 * mpmath.pi
    anomaly = mpmath.findroot(lambda x: x - e * mpmath.sin(x) - t, start, tol=1e-80)
    rate, minor = 1 / (1 - e * mpmath.cos(anomaly)), mpmath.sqrt(1 - e * e)
    cosine, sine = mpmath.cos(anomaly), mpmath.sin(anomaly)
    return [cosine - e, minor * sine, -sine * rate, minor * cosine * rate]


MOTIONS: dict[str, tuple[str, float, Callable[[float], list[Any]]]] = {
    "oscillator": (OSCILLATOR, 30.0, lambda t: [mpmath.cos(t), -mpmath.sin(t)]),
    "pendulum": (PENDULUM, 8.0, pendulum),
    "kepler": (KEPLER, 6.25, kepler),
    "driven": (
        DRIVEN,
        5.0,
        lambda t: [mpmath.mpf(t) ** 2 / 4 + mpmath.sin(t) ** 2 / 4, mpmath.mpf(t) / 2 + mpmath.sin(2 * t) / 4],
    ),
}


@pytest.mark.parametrize("name", MOTIONS)
def test_motions_in_closed_form_lie_in_their_enclosures(name: str) -> None:
    text, end, exact = MOTIONS[name]
    found = enclosure_of(text, end)
    assert found.ended == ""
    with mpmath.workdps(60):
        for t in np.linspace(0, end, 23).tolist():
            assert inside(found.at(t), exact(t)), t
    assert max(float(x.rad()) for x in found.at(end)) <= 1e-12
    # Between two times it holds all that is between them.
    with ctx.workprec(120):
        wide = found.within(0.3 * end, 0.4 * end)
        for t in np.linspace(0.3 * end, 0.4 * end, 9).tolist():
            assert all(ball.overlaps(value) for ball, value in zip(wide, found.at(t), strict=True))


def test_as_narrow_as_asked_for() -> None:
    for width in (1e-6, 1e-15, 1e-40):
        found = enclosure_of(PENDULUM, 6.0, width)
        assert max(float(x.rad()) for x in found.at(6.0)) <= width


def test_sets_of_initial_states_stay_sets() -> None:
    """The oscillator turns a square of states: it must neither be lost nor wrapped 60 times."""
    dynamics = dynamics_of(OSCILLATOR)
    side = arb(0, 1e-6)
    found = enclosed(dynamics.right_hand_side, dynamics.jacobian, [1 + side, side], 60.0, 1e-9, [1.0, 1.0])
    assert found.ended == ""
    radii = [float(x.rad()) for x in found.at(60.0)]
    assert all(1e-6 <= radius < 2e-6 for radius in radii)
    with mpmath.workdps(40):
        for x0, v0 in ((1 + 1e-6, 1e-6), (1 - 1e-6, 1e-6), (1 + 1e-6, -1e-6)):
            turned = [x0 * mpmath.cos(60) + v0 * mpmath.sin(60), -x0 * mpmath.sin(60) + v0 * mpmath.cos(60)]
            assert inside(found.at(60.0), turned)


def test_it_ends_before_a_blow_up_and_says_so() -> None:
    found = enclosure_of(BLOW_UP, 2.0)
    assert found.ended == NO_STEP
    assert 0.9 < found.reached < 1
    with mpmath.workdps(40):
        t = mpmath.mpf(found.reached)
        assert inside(found.at(found.reached), [1 / (1 - t) ** 2, 2 / (1 - t) ** 3])


def test_its_time_its_work_and_ctrl_c_end_it() -> None:
    assert enclosure_of(KEPLER, 6.25, seconds=0.0).ended == OUT_OF_TIME
    one, other = (enclosure_of(KEPLER, 6.25, limit=0.02) for _ in range(2))
    assert one.ended == TOO_DEAR
    assert 0 < one.reached == other.reached < 6.25  # counted, not timed: it ends at the same place

    def stop(t: float) -> None:
        if t > 1:
            raise KeyboardInterrupt

    found = enclosure_of(OSCILLATOR, 30.0, watch=stop)
    assert found.ended == INTERRUPTED
    assert 1 < found.reached < 30
    with mpmath.workdps(40):
        assert inside(found.at(1.0), [mpmath.cos(1), -mpmath.sin(1)])
    with pytest.raises(ValueError, match="enclosed from 0 to"):
        found.at(30.0)


# --- what is left out, planted ---


def contains_truth(name: str) -> bool:
    text, end, exact = MOTIONS[name]
    found = enclosure_of(text, end, 1e-3)
    with mpmath.workdps(60):
        return found.ended == "" and all(inside(found.at(t), exact(t)) for t in np.linspace(0, end, 9).tolist())


def test_a_tail_of_zero_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    assert contains_truth("pendulum")
    monkeypatch.setattr(segments.Disc, "tail", lambda self, step, terms: [arb(0)] * len(self.solutions))
    assert not contains_truth("pendulum")


def test_a_set_that_is_not_carried_along_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Errors of earlier steps must grow with the motion."""
    real = segments._carried
    monkeypatch.setattr(segments, "_carried", lambda t, x, moved, box, least: real(t, x, moved, box * 0, least))
    assert not contains_truth("kepler")


def test_a_derivative_without_its_motion_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """A set near the unstable rest of the pendulum grows like exp(t): with S = 1 it would not."""
    dynamics = dynamics_of(PENDULUM.replace("{x: 2}", "{x: pi}"))
    start = [arb("3.14159265358979", 1e-9), arb(0, 1e-9)]

    def radius() -> float:
        found = enclosed(dynamics.right_hand_side, dynamics.jacobian, start, 5.0, 1e-3, [1.0, 1.0])
        return float(found.at(5.0)[0].rad())

    assert radius() >= 1.4e-9 * np.exp(5) / 2
    real = segments._derivative

    def still(*given: Any) -> Any:
        found, bound = real(*given)
        return found * 0 + segments.unit(2), bound

    monkeypatch.setattr(segments, "_derivative", still)
    assert radius() < 1e-8


@settings(max_examples=60)
@given(
    st.lists(st.floats(-1, 1), min_size=3, max_size=3),
    st.floats(0.05, 0.6),
    st.sampled_from(["exp", "sin", "cos", "reciprocal", "sqrt", "log", "atan", "square"]),
    st.floats(0, 1),
    st.floats(0, 6.28),
)
def test_models_hold_the_values_of_functions_on_their_disc(
    slopes: list[float], radius: float, name: str, part: float, angle: float
) -> None:
    """At any complex time of the disc: polynomial and rest contain the value, computed by itself."""
    with ctx.workprec(120), cap(9):
        coefficients = [arb(1.5), *map(arb, slopes)]
        given_ = Model(Ring(8, radius), arb_series(coefficients))
        found = given_ * given_ if name == "square" else getattr(given_, name)()
        s = acb(part * radius * np.cos(angle), part * radius * np.sin(angle)) * arb("0.999999")
        x = sum((acb(c) * s**k for k, c in enumerate(coefficients)), acb(0))
        true = x * x if name == "square" else 1 / x if name == "reciprocal" else getattr(x, name)()
        value = sum((acb(found.poly[k]) * s**k for k in range(9)), acb(0))
        missed = (value - true).abs_lower()
        assert not missed > found.rest


def test_a_rest_that_is_too_small_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """The composition of functions without what lies beyond the degree."""
    with ctx.workprec(120), cap(5):
        given_ = Model(Ring(4, 0.9), arb_series([arb(0), arb(1)]))
        s = acb(0.89)
        found = given_.exp()
        value = sum((acb(found.poly[k]) * s**k for k in range(5)), acb(0))
        missed = float((value - s.exp()).abs_upper())
    assert 1e-4 < missed <= found.rest < 1


# --- beside a run ---


def test_the_error_of_a_run_is_bounded() -> None:
    """Against cos t itself: the proved bound is at least the true error, and not far from it."""
    dynamics = dynamics_of(OSCILLATOR)
    times = np.linspace(0, 20, 41)
    wrong = np.vstack([np.cos(times) + 1e-7 * np.sin(3 * times), -np.sin(times)])
    found = certified(dynamics, times, wrong, 1e-12)
    true = 1e-7 * np.max(np.abs(np.sin(3 * times)))
    assert found.whole
    assert true * (1 - 1e-6) <= found.largest_error <= true * (1 + 1e-6)
    assert np.all(found.radius > 0)
    assert found.width < 1e-12
    with mpmath.workdps(40):
        for k in (0, 7, 40):
            error = abs(mpmath.cos(mpmath.mpf(float(times[k]))) - mpmath.mpf(float(found.centre[0, k])))
            assert error <= found.radius[0, k]


def test_a_disc_knows_the_singularity() -> None:
    """x' = x^2 from 1 has its pole at 1: no disc reaches it, a good one comes close."""
    dynamics = dynamics_of(BLOW_UP)
    with ctx.workprec(100):
        field = Field(dynamics.right_hand_side, dynamics.jacobian, 100)
        coefficients = field.solution(arb(0), [arb(1), arb(2)], 16)
        found = segments.disc(field, arb(0), coefficients, 3.0)
    assert found is not None
    assert 0.4 < found.radius < 1


# --- events ---


def test_events_of_the_exact_solution_are_proved() -> None:
    """cos t = 0 at odd multiples of pi/2, cos t = -1/2 at 2 pi/3 and so on."""
    run = mbsym.simulate(mbsym.loads(OSCILLATOR), 20.0, tolerance=1e-6, certify=1e-12, events=["x = 0", "x = -1/2"])
    assert run.certificate is not None
    assert run.events is not None
    radii, found = run.certificate.passages, run.events
    assert len(found) == 12
    assert all(radius is not None and radius < 1e-3 for radius in radii)
    with mpmath.workdps(30):
        zeros = [mpmath.pi / 2 + k * mpmath.pi for k in range(6)]
        halves = [turn * 2 * mpmath.pi + side * 2 * mpmath.pi / 3 for turn in range(4) for side in (1, -1)]
        for time, which, radius in zip(found.times, found.which, radii, strict=True):
            near = [t for t in (zeros, halves)[which] if abs(t - mpmath.mpf(float(time))) <= radius]
            assert len(near) == 1


def test_events_that_are_none_are_not_proved() -> None:
    """Planted: an event where nothing passes, one in the wrong direction, one that touches."""
    run = mbsym.simulate(mbsym.loads(OSCILLATOR), 3.0, events=["x = 0"])
    assert run.events is not None
    honest = run.events
    found = certified(run.dynamics, run.times, run.trajectory.states, 1e-12, happened=honest)
    assert [radius is not None for radius in found.passages] == [True]
    for change in (
        {"times": honest.times + 1.0},
        {"turns": -honest.turns},
        {"turns": 0 * honest.turns},
    ):
        wrong = replace(honest, **change)
        lied = certified(run.dynamics, run.times, run.trajectory.states, 1e-12, happened=wrong)
        assert lied.passages == (None,)


# --- units, and what was asked for ---

#: A pendulum on a spring, 35 g, 40 N/m, 250 mm, in units of length, mass and time, each a part of the SI's.
SPRING = """
mbsym: 1
name: A pendulum on a spring
parameters: {{m: positive, k: positive, l: positive, g: positive}}
bodies:
  - name: b
    attached to: 0
    connection point: [r*sin(th), -r*cos(th), 0]
    mass: m
    coordinates: [r, th]
loads:
  - uniform gravity: {{vector: [0, -g, 0]}}
  - spring: {{coordinate: r, stiffness: k, rest: l}}
values: {{m: 0.035/({mass}), k: 40*({time})**2/({mass}), l: 0.25/({length}), g: 9.81*({time})**2/({length})}}
initial: {{r: 0.265/({length}), th: 0.7}}
"""


@pytest.mark.parametrize(
    ("length", "mass", "time"), [("1/1000", "1/1000", "1"), ("1/1000", "1/1000", "1/1000"), ("1/1000000", "1", "60")]
)
def test_an_enclosure_is_no_matter_of_units(length: str, mass: str, time: str) -> None:
    """As many bits, as many steps, as narrow: 131 bits were taken in millimetres and grams where metres took 75."""

    here, there = spring_in("1", "1", "1"), spring_in(length, mass, time)
    assert (there.enclosure.bits, len(there.enclosure.segments)) == (here.enclosure.bits, len(here.enclosure.segments))
    assert there.known == pytest.approx(here.known, rel=0.01)
    assert here.narrow


@cache
def spring_in(length: str, mass: str, time: str) -> Certificate:
    dynamics = dynamics_of(SPRING.format(length=length, mass=mass, time=time))
    times = np.linspace(0, 0.25 / float(Fraction(time)), 11)
    return certified(dynamics, times, trial_of(METHODS["dop853"], dynamics, Setting(1e-12), times).states, 1e-12)


#: x'' = x from (1, -1): x = exp(-t), and what a ball is wide by at first has grown by exp(40), 2.4e17, at t = 40.
FALLING = LINE + "loads:\n  - potential: -x**2/2\ninitial: {x: {position: 1, velocity: -1}}\n"


def test_a_width_that_is_not_reached_is_told_with_what_is_in_its_way() -> None:
    """57 bits make it to the end with 1e-7; as many as the width asked for needs cost too much."""
    dynamics = dynamics_of(FALLING)
    times = np.linspace(0, 40, 21)
    states = np.vstack([np.exp(-times), -np.exp(-times)])
    found = certified(dynamics, times, states, 1e-10, limit=0.08)
    assert found.whole
    assert found.enclosure.cut == TOO_DEAR
    assert 1e-10 < found.known < 1e-5
    assert not found.narrow
    lines = list(certificate_lines(found, dynamics.system, len(times)))
    assert "that is wider than the 1e-10 that was asked for: it takes more work than it may" in lines[2]
    paid = certified(dynamics, times, states, 1e-10)
    assert paid.narrow
    assert paid.enclosure.cut == ""
    assert not any("wider" in line for line in certificate_lines(paid, dynamics.system, len(times)))
    assert np.all(found.radius >= paid.radius)


def test_a_width_between_the_digits_of_a_table_is_one_of_the_enclosure() -> None:
    dynamics = dynamics_of(OSCILLATOR)
    times = np.linspace(0, 5, 11)
    found = certified(dynamics, times, np.vstack([np.cos(times), -np.sin(times)]), 1e-30)
    assert found.narrow
    assert found.known <= 1e-30 < 1e-17 < found.width
    (told,) = (line for line in certificate_lines(found, dynamics.system, len(times)) if "in the digits of a" in line)
    assert "e-16 in the digits of a table)" in told


def test_what_rests_but_for_rounding_is_measured_by_the_motion() -> None:
    """y rests; a run that has 1e-17 there does not ask for 1e-27 to be proved.

    The velocity that carries the energy of x is 1, and x has a range of 2 at a speed of 1: so far it would take y.
    """
    dynamics = dynamics_of(PLANE + "loads:\n  - potential: x**2/2 + y**2/2\ninitial: {x: 1, y: 0}\n")
    times = np.linspace(0, 5, 301)
    rest = 1e-17 * np.cos(7 * times)
    found = certified(dynamics, times, np.vstack([np.cos(times), rest, -np.sin(times), rest]), 1e-10)
    assert found.scale == pytest.approx([1, 2, 1, 1], rel=0.01)
