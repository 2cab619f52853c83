"""Two solutions compared over the whole interval: laws, and places where a comparison row by row sees nothing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from properties import settings

from mbsym.numerics.methods.interface import Breakdown, Cause
from mbsym.numerics.trade.comparison import Comparison, Ended, compared

END = 8.0


@dataclass
class Piece:
    start: float
    end: float
    known: Callable[[Any], Any]

    def __call__(self, times: Any) -> Any:
        slack = 1e-12 * (self.start + self.end)  # as that of Piece
        assert np.all((times >= self.start - slack) & (times <= self.end + slack)), "a step says nothing about others"
        return self.known(np.asarray(times))


@dataclass
class Known:
    """A solution in closed form that goes in steps of given lengths, one after the other and again."""

    known: Callable[[Any], Any]
    lengths: tuple[float, ...] = (0.1,)
    breaks: float = np.inf
    time: float = 0.0
    made: int = field(default=0)

    @property
    def state(self) -> Any:
        return self.known(np.zeros(1))[:, 0]

    def step(self, until: float | None = None) -> Piece:
        start, self.time = self.time, self.time + self.lengths[self.made % len(self.lengths)]
        self.made += 1
        if self.time > self.breaks:
            raise Breakdown(Cause.BLOW_UP, "planted", self.breaks, self.state)
        return Piece(start, self.time, self.known)

    def fill(self, times: Any) -> Any:
        assert times[0] >= self.time
        self.time = float(times[-1])
        if self.time > self.breaks:
            raise Breakdown(Cause.BLOW_UP, "planted", self.breaks, self.state)
        return self.known(np.asarray(times))


def oscillation(t: Any) -> Any:
    return np.array([np.cos(t), -np.sin(t)])


def plus(what: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """The oscillation with something added to its position."""
    return lambda t: oscillation(t) + np.array([what(t), 0 * t])


def of(first: Known, second: Known, end: float = END, **more: Any) -> Comparison:
    return compared(first, second, end, ("x", "x_dot"), **more)


steps = st.lists(st.sampled_from([0.01, 0.05, 0.3, 1.0, 3.0, 20.0]), min_size=1, max_size=4).map(tuple)


@settings(max_examples=40)
@given(steps, steps, st.sampled_from([3, 40, 4000]))
def test_equal_solutions_do_not_differ_whatever_their_steps(mine: Any, others: Any, most: int) -> None:
    found = of(Known(oscillation, mine), Known(oscillation, others), most=most)
    assert found.largest == found.final == 0
    assert found.parted is None
    assert found.points > 4


@settings(max_examples=40)
@given(steps, steps, st.floats(0.01, 7.9))
def test_a_difference_within_one_step_is_seen(mine: Any, others: Any, place: float) -> None:
    """A bump as long as the step it stands in; it is zero at the ends of every step."""
    edges = np.cumsum(np.resize(mine, 2000))
    after = int(np.searchsorted(edges, place))
    start, until = (float(edges[after - 1]) if after else 0.0), min(float(edges[after]), END)

    def bump(t: Any) -> Any:
        return 1e-6 * np.where((t > start) & (t < until), (t - start) * (until - t) / (until - start) ** 2 * 4, 0.0)

    found = of(Known(plus(bump), mine), Known(oscillation, others))
    assert 0.9e-6 < found.quantities[0].largest < 1.001e-6
    assert start < found.quantities[0].when < until
    assert found.quantities[1].largest == 0


@settings(max_examples=40)
@given(steps, steps)
def test_differences_are_symmetric(mine: Any, others: Any) -> None:
    other = plus(lambda t: 1e-3 * np.sin(3 * t))
    one = of(Known(oscillation, mine), Known(other, others)).quantities
    two = of(Known(other, others), Known(oscillation, mine)).quantities
    assert [(q.largest, q.final, q.when) for q in one] == [(q.largest, q.final, q.when) for q in two]


@settings(max_examples=40)
@given(steps, steps, st.integers(-20, 20), st.integers(-20, 20))
def test_units_of_time_and_length_change_nothing(mine: Any, others: Any, time: int, length: int) -> None:
    """t -> t 2^a, x -> x 2^b: relative differences stay the same to the last bit, absolute ones are scaled."""
    other = plus(lambda t: 1e-3 * np.sin(3 * t))
    long, large = 2.0**time, 2.0**length

    def scaled(known: Callable[[Any], Any], lengths: Any) -> Known:
        size = np.array([[large], [large / long]])
        return Known(lambda t: size * known(t / long), tuple(length * long for length in lengths))

    plain = of(Known(oscillation, mine), Known(other, others))
    found = of(scaled(oscillation, mine), scaled(other, others), END * long)
    assert (found.largest, found.final) == (plain.largest, plain.final)
    for q, was in zip(found.quantities, plain.quantities, strict=True):
        assert (q.when, q.relative) == (was.when * long, was.relative)
    assert found.quantities[0].largest == plain.quantities[0].largest * large


@settings(max_examples=40)
@given(steps, st.integers(2, 200))
def test_rows_asked_for_change_nothing(mine: Any, rows: int) -> None:
    other = plus(lambda t: 1e-3 * np.sin(3 * t))
    times = np.linspace(0, END, rows)
    bare = of(Known(oscillation, mine), Known(other))
    found = of(Known(oscillation, mine), Known(other), shown=(times, oscillation(times)))
    for q, was in zip(found.quantities, bare.quantities, strict=True):
        assert was.largest <= q.largest <= 1.001 * was.largest
        assert (q.final, q.scale) == (was.final, pytest.approx(was.scale, rel=1e-3))


@pytest.mark.parametrize("most", [5, 4000])
def test_whole_periods_hide_nothing(most: int) -> None:
    """Rows at whole periods, where sin(2 pi t) is zero, and the velocity of the reference as well."""
    period = 2 * np.pi
    late = plus(lambda t: 1e-5 * np.sin(t))
    times = period * np.arange(5)
    found = of(Known(late), Known(oscillation), 4 * period, shown=(times, late(times)), most=most)
    assert found.quantities[0].largest == pytest.approx(1e-5, rel=2e-2)
    assert [q.size for q in found.quantities] == pytest.approx([1, 1], rel=1e-2)
    assert found.followed is (most == 4000)


def test_a_wrong_row_is_seen() -> None:
    """A planted lie: the solution is right, and one row that was shown is not."""
    times = np.linspace(0, END, 33)
    states = oscillation(times)
    states[0, 17] += 1e-7
    found = of(Known(oscillation), Known(oscillation), shown=(times, states))
    assert found.quantities[0].largest == pytest.approx(1e-7)
    assert found.quantities[0].when == times[17]


def test_what_rests_is_measured_by_the_scene() -> None:
    """Rounding of a coordinate that rests, beside what the scene would move it by; the floor is told."""

    def resting(t: Any) -> Any:
        return np.array([1e-16 * np.sin(9 * t), 0 * t])

    still = Known(lambda t: np.array([0 * t, 0 * t]))
    found = of(Known(resting), still, usual=lambda times, states: np.array([2.0, 4.0]))
    first, second = found.quantities
    assert (first.rests, first.scale, first.floor) == (True, 2.0, 2e-6)
    assert found.largest == pytest.approx(0.5e-16, rel=1e-2)
    assert second.largest == 0


def test_two_solutions_that_part_are_called_so() -> None:
    """exp(t - 6) is 0.1 at t = 6 - log(10) = 3.70."""
    for most in (4000, 50):
        found = of(Known(plus(lambda t: np.exp(t - 6))), Known(oscillation), most=most)
        assert found.parted == pytest.approx(6 - np.log(10), abs=0.2)
    assert of(Known(plus(lambda t: 0.09 * np.sin(t))), Known(oscillation)).parted is None


def test_long_comparisons_keep_when_the_two_parted() -> None:
    """More stretches than are remembered: neighbours are joined."""
    found = of(Known(plus(lambda t: np.where(t > 5, 0.2, 0.0)), (0.001,)), Known(oscillation))
    assert found.parted == pytest.approx(5, abs=0.02)
    assert len(found.times) < 3000
    assert (found.times[0], found.times[-1]) == (0, END)
    assert np.all(np.diff(found.times) > 0)
    assert found.states == pytest.approx(oscillation(found.times))


@pytest.mark.parametrize("most", [5, 4000])
def test_who_ends_on_the_way_is_told(most: int) -> None:
    for second in (False, True):
        short, whole = Known(oscillation, breaks=3.0), Known(oscillation)
        with pytest.raises(Ended) as ended:
            of(*((whole, short) if second else (short, whole)), most=most)
        assert ended.value.second is second
        assert ended.value.breakdown.kind == Cause.BLOW_UP


def test_no_number_is_an_infinite_difference() -> None:
    found = of(Known(plus(lambda t: np.where(t > 5, np.nan, 0.0))), Known(oscillation))
    assert found.largest == np.inf
    assert found.parted == pytest.approx(5, abs=0.2)


def test_ends_of_steps_between_two_doubles_are_passed() -> None:
    """Steps in extended arithmetic end where no double is."""
    step = np.longdouble(1) / 3
    found = of(
        Known(oscillation, (step, step / 7), time=np.longdouble(0)),
        Known(oscillation, (step / 11,), time=np.longdouble(0)),
    )
    assert found.followed
    assert found.points < 2000
    assert found.largest < 1e-15
