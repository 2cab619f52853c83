"""Ensembles against runs of their members alone, against closed forms, and planted mistakes."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED

import mbsym
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.ensembles import side_by_side
from mbsym.numerics.ensembles.ensemble import QUANTILES, Ensemble, ensemble, statistics
from mbsym.numerics.ensembles.parametrised import Parametrised
from mbsym.numerics.ensembles.variation import SOBOL, Draw, Grid, Unvaried, drawn, members
from mbsym.numerics.methods.interface import Cause, Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.scenario import scenario
from mbsym.numerics.simulate import integrated
from mbsym.report.runs.ensemble_tables import sentences
from mbsym.simulation import read_values

PARTICLE = """
mbsym: 1
name: Particle
parameters: {m: positive, k: real, w: positive}
relations: {k: m*w**2}
bodies:
  - {name: b, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
loads:
  - LOAD
values: {m: 2, w: 3}
initial: {x: 0.5}
"""
SPRING = PARTICLE.replace("LOAD", "spring: {coordinate: x, stiffness: k}")
AWAY = PARTICLE.replace("LOAD", "generalized force: {x: k*x**3}")


def read(text: str) -> Any:
    return mbsym.loads(text).system


def run(given: Any, variations: Sequence[Grid | Draw], times: Any, count: int | None = None, **more: Any) -> Ensemble:
    names = [one.name for one in variations]
    free = [name for name in names if name in given.parameter_names]
    found = members(Parametrised(scenario(given), free), names, drawn(given, variations, count))
    setting = Setting(None, 1e-3) if more.get("method") == "rk4" else Setting(1e-10, step_limit=3000)
    return ensemble(found, more.get("method", "dop853"), setting, times, more.get("threads"))


def alone(given: Any, found: Ensemble, member: int) -> Any:
    """The states of a member run by itself."""
    values = {
        name: Fraction(float(row[member])) for name, row in zip(found.members.names, found.members.values, strict=True)
    }
    dynamics = Dynamics(scenario(given, read_values(given, values)))
    return integrated(dynamics, METHODS[found.method], found.setting, found.times)


@pytest.mark.parametrize("method", ["dop853", "rk45", "rk4"])
def test_a_member_is_what_it_is_alone(method: str) -> None:
    given = mbsym.load(SHIPPED / "double-pendulum.yaml").system
    found = run(given, [Grid("theta1", 0.1, 1.5, 3), Grid("m1", 1, 3, 3)], np.linspace(0, 4, 9), method=method)
    assert found.count == 9
    assert not found.fates
    for member in (0, 5, 8):
        own = alone(given, found, member)
        assert np.max(np.abs(own.states[:, -1] - found.final[:, member])) < 1e-11
    everybody = np.array([alone(given, found, member).states for member in range(9)])  # (m, 2n, T)
    spread = found.statistics
    assert np.max(np.abs(spread.mean - everybody.mean(axis=0).T)) < 1e-11
    assert np.max(np.abs(spread.deviation - everybody.std(axis=0, ddof=1).T)) < 1e-11
    assert np.max(np.abs(spread.quantiles - np.quantile(everybody, QUANTILES, axis=0).transpose(0, 2, 1))) < 1e-11


def test_it_makes_no_difference_how_many_threads_there_are_or_into_which_blocks_times_fall() -> None:
    given = mbsym.load(SHIPPED / "double-pendulum.yaml").system
    grid, times = [Grid("theta1", 0.1, 2.5, 37)], np.linspace(0, 5, 41)
    first = run(given, grid, times, threads=1)
    second = run(given, grid, times, threads=3)
    assert np.array_equal(first.final, second.final)
    found = first.members
    made = side_by_side.compiled(found.dynamics, side_by_side.TABLEAUX["dop853"])
    whole, pieces = (side_by_side.SideBySide(made, Setting(1e-10), found.starts, found.parameters) for _ in range(2))
    together = whole.block(times[1:])
    apart = np.concatenate([pieces.block(times[a : a + 3]) for a in range(1, 41, 3)])
    assert np.array_equal(together, apart)


def test_parameters_and_what_follows_from_them() -> None:
    """x = cos(w t)/2 with k = m w^2 by its relation."""
    times = np.linspace(0, 3, 16)
    found = run(read(SPRING), [Grid("w", 1, 5, 33)], times)
    expected = 0.5 * np.cos(np.outer(times, np.linspace(1, 5, 33)))
    assert np.max(np.abs(found.statistics.mean[:, 0] - expected.mean(axis=1))) < 1e-9
    assert np.max(np.abs(found.statistics.least[:, 0] - expected.min(axis=1))) < 1e-9
    assert found.compared.largest < 1e-7


def test_normal_initial_states_stay_normal_where_the_motion_is_linear() -> None:
    """x(0) = N(0.3, 0.01), x = x(0) cos(3 t): mean and deviation turn with it."""
    times = np.linspace(0, 2, 11)
    found = run(read(SPRING), [Draw("x", "normal", 0.3, 0.01)], times, 4000)
    start = found.members.values[0]
    assert abs(start.mean() - 0.3) < 4 * 0.01 / np.sqrt(4000)
    assert abs(start.std() - 0.01) < 4 * 0.01 / np.sqrt(8000)
    turned = np.cos(3 * times)
    assert np.max(np.abs(found.statistics.mean[:, 0] - start.mean() * turned)) < 1e-9
    assert np.max(np.abs(found.statistics.deviation[:, 0] - start.std(ddof=1) * np.abs(turned))) < 1e-9


def test_draws_are_the_same_for_the_same_seed_and_fill_the_range() -> None:
    given = read(SPRING)
    draws = [Draw("x", "uniform", -1, 1), Draw("x_dot", "uniform", 0, 2)]
    assert np.array_equal(drawn(given, draws, 100, 7), drawn(given, draws, 100, 7))
    assert not np.array_equal(drawn(given, draws, 100, 7), drawn(given, draws, 100, 8))
    assert np.array_equal(drawn(given, draws, 200, 7)[:, :100], drawn(given, draws, 100, 7))
    even = drawn(given, draws, 256, 1, SOBOL)
    assert np.all(np.histogram(even[0], 16, (-1, 1))[0] == 16)


def test_members_that_blow_up_are_counted_and_named() -> None:
    """x'' = k x^3/m with x(0) = a runs away after 1.854.../(a w) (a complete elliptic integral); x = 0 rests."""
    times = np.linspace(0, 2, 21)
    found = run(read(AWAY), [Grid("x", 0, 0.5, 11)], times)
    ends = 1.8540746773013719 / (3 * np.linspace(0, 0.5, 11)[1:])
    expected = [member for member, end in enumerate(ends, 1) if end < 2]
    assert [fate.member for fate in found.fates] == expected
    assert {fate.kind for fate in found.fates} == {Cause.BLOW_UP}
    for fate in found.fates:
        assert abs(fate.time - ends[fate.member - 1]) < 0.1
    alive = [11 - sum(end <= t for end in ends) for t in times]
    assert list(found.statistics.alive) == alive
    assert np.all(np.isnan(found.final[:, expected]))


def test_statistics_of_those_who_live() -> None:
    states = np.array([[[1.0, 2.0, np.nan, 6.0]], [[np.nan, np.nan, np.nan, 3.0]], [[np.nan] * 4]])
    found = statistics(states)
    assert list(found.alive) == [3, 1, 0]
    assert found.mean[0, 0] == 3.0
    assert found.deviation[0, 0] == pytest.approx(np.sqrt(7))
    assert (found.least[0, 0], found.greatest[0, 0], found.quantiles[2, 0, 0]) == (1.0, 6.0, 2.0)
    assert np.isnan(found.deviation[1, 0])
    assert np.isnan(found.mean[2, 0])
    assert np.isnan(found.greatest[2, 0])


def test_everything_that_is_wrong_is_said() -> None:
    given = read(SPRING)
    with pytest.raises(Unvaried) as refused:
        drawn(given, [Grid("k", 1, 2, 3), Draw("y", "normal", 0, -1), Grid("w", 1, 2, 10**7)], 5)
    told = str(refused.value)
    for part in (
        "k follows from",
        "nothing called 'y'",
        "deviation of y must be positive",
        "do not go together",
        "too many",
    ):
        assert part in told
    with pytest.raises(Unvaried, match="declared positive"):
        run(given, [Grid("m", -1, 1, 3)], [0.0, 1.0])


# --- planted mistakes ---


def test_a_dropped_member_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        side_by_side,
        "_grouped",
        lambda rows, lanes: np.roll(rows, 1, axis=1).reshape(len(rows), -1, lanes).transpose(1, 0, 2),
    )
    with pytest.raises(AssertionError):
        test_parameters_and_what_follows_from_them_in_order()


def test_parameters_and_what_follows_from_them_in_order() -> None:
    given = read(SPRING)
    found = run(given, [Grid("w", 1, 5, 9)], [0.0, 1.3])
    expected = 0.5 * np.cos(1.3 * np.linspace(1, 5, 9))
    assert np.max(np.abs(found.final[0] - expected)) < 1e-9


def test_a_slope_that_is_not_handed_on_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    from mbsym.numerics.ensembles.ensemble_text import _Adaptive

    monkeypatch.setattr(_Adaptive, "_kept_slope", lambda self, mask: None)
    with pytest.raises(AssertionError):
        test_parameters_and_what_follows_from_them_in_order()


def test_a_load_that_every_member_passes_is_told() -> None:
    """A push of 0.1 ms between steps of 1 ms: each member misses it, and the spread says so; steps of an error estimate
    are made short beside it, and nothing is said."""
    text = (
        "mbsym: 1\nname: pushed\nbodies:\n"
        "  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}\nloads:\n"
        "  - potential: x**2/2\n  - generalized force:\n      x: 9000*exp(-((t - 1.0005)/0.0001)**2)\ninitial: {x: 1}\n"
    )
    varied, times = [Grid("x", 1, 2, 3)], np.linspace(0, 2, 5)
    told = dict(sentences(run(read(text), varied, times, method="rk4")))
    assert "changes within 3.3e-05 at t = 1.000" in told["warning"]
    assert "so in 3 members" in told["warning"]
    assert "warning" not in dict(sentences(run(read(text), varied, times)))
