"""What `tradeoff` tells of itself: a lost energy is no error, what was spent, who climbs first, what failed."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import dynamics_of, filed, invoked

from mbsym.numerics.methods.interface import Breakdown, Setting, Work
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning.prices import FOLLOWED, cost
from mbsym.numerics.trade import reference_search
from mbsym.numerics.trade.comparison import compared
from mbsym.numerics.trade.reference_search import BROKEN, whole_reference
from mbsym.numerics.trade.tradeoff import FIRST, tradeoff
from mbsym.numerics.trade.trial import trial_of

OSCILLATOR = """
mbsym: 1
name: Oscillator with damping
parameters: {m: positive, k: positive, c: positive}
bodies:
  - name: b
    attached to: 0
    connection point: [x, 0, 0]
    mass: m
    coordinates: [x]
loads:
  - spring: {coordinate: x, stiffness: k}
  - damper: {coordinate: x, coefficient: c}
values: {m: 1, k: 1, c: 1/2}
initial: {x: 1}
"""


def test_the_energy_that_a_damper_takes_is_no_error_of_a_method() -> None:
    """x'' + x'/2 + x = 0 loses nearly all of its energy 1/2 in 20 units of time; no method errs by that.

    A method that is right to 1e-10 has the energy x'^2/2 + x^2/2 right to 2e-10 of its size, about.  Planted: one that
    is wrong by a thousandth is seen in the energy, too.
    """
    dynamics = dynamics_of(OSCILLATOR)
    truth = whole_reference(dynamics, 20.0, 60.0)
    found = tradeoff(dynamics, [METHODS["dop853"], METHODS["rk4"]], truth, budget=4.0)
    exact = [row for row in found.rows if row.error < 1e-10]
    assert exact
    assert all(row.drift < 1e-9 for row in exact)
    wrong = [row for row in found.rows if 1e-3 < row.error < 1e-1]
    assert wrong
    assert all(row.drift > 1e-4 for row in wrong)


def test_the_method_that_a_run_takes_climbs_first_and_every_row_says_what_it_cost() -> None:
    dynamics = dynamics_of(OSCILLATOR)
    truth = whole_reference(dynamics, 20.0, 60.0)
    labels: list[str] = []
    found = tradeoff(dynamics, [METHODS["rk4"], METHODS["rk45"], METHODS["dop853"]], truth, 4.0, labels.append)
    assert labels[0].startswith("dop853")
    assert [row.method.traits.name for row in found.rows][:1] == ["rk4"]  # the table keeps its order
    assert all(row.cost > 0 for row in found.rows)
    assert sum(row.cost for row in found.rows) == pytest.approx(found.spent)
    first = sum(row.cost for row in found.rows if row.label.startswith("dop853") and "," not in row.label)
    assert first <= FIRST * 4.0 + 1.0


def test_a_trial_that_ended_early_is_remembered_as_it_was() -> None:
    """x'' = 2 x^3 from x = x' = 1 is 1/(1 - t)."""
    text = OSCILLATOR.replace("initial: {x: 1}", "initial: {x: {position: 1, velocity: 1}}")
    text = text.replace("spring: {coordinate: x, stiffness: k}", "generalized force: {x: 2*m*x**3 + 0*k}")
    text = text.replace("c: 1/2", "c: 0").replace("c: positive", "c: nonnegative")
    trial = trial_of(METHODS["dop853"], dynamics_of(text), Setting(1e-9), [0.0, 2.0])
    again = pickle.loads(pickle.dumps(trial))
    assert trial.ended is not None
    assert again.trouble == trial.trouble == str(again.ended)
    with pytest.raises(Breakdown, match="blow-up"):
        again.whole()


def test_a_way_to_a_reference_that_fails_as_nobody_foresaw_is_no_end_of_the_study(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def broken(*_: Any) -> Any:
        raise ZeroDivisionError("planted")

    monkeypatch.setattr(reference_search, "_knots", broken)
    truth = whole_reference(dynamics_of(OSCILLATOR), 5.0, 10.0)
    assert truth.way == reference_search.EXPLICIT
    monkeypatch.setattr(reference_search, "_agreeing", broken)
    with pytest.raises(Breakdown) as told:
        whole_reference(dynamics_of(OSCILLATOR), 5.0, 10.0)
    assert told.value.kind == BROKEN
    path = filed(tmp_path / "oscillator.yaml", OSCILLATOR)
    found = invoked("tradeoff", path, "--time", "5", "--out", tmp_path, code=3)
    assert "internal error" in found.output
    assert "planted" in found.output
    assert "Traceback" not in found.output


TWO_RATES = """
mbsym: 1
name: Two parts, one fast and damped
parameters: {a: positive, b: positive}
bodies:
  - {name: p, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - generalized force: {x: -a*x, y: -b*y - y_dot}
values: {a: 1, b: 1000000}
initial: {x: 1, y: 1}
"""


def test_a_search_is_asked_often_whether_it_may_go_on() -> None:
    """3200 periods in 20 units of time, of which nobody asks about one step after the other.

    Between two looks at the meter lie 1/2000 of the time at most where steps are many: an implicit method in the dark
    for 1/32 of it spent minutes that nobody had allowed.
    """
    dynamics = dynamics_of(TWO_RATES)
    reached: list[float] = []

    class Enough(Exception):
        pass

    def watch(t: float) -> None:
        reached.append(t)
        if t > 10:
            raise Enough

    first, second = (METHODS["rk45"].start(dynamics, Setting(tolerance)) for tolerance in (1e-3, 1e-4))
    with pytest.raises(Enough):
        compared(first, second, 20.0, ("x", "y", "x_dot", "y_dot"), watch=watch)
    beyond = [t for t in reached if t > 1]
    assert max(np.diff(beyond)) < 20 / 1000


def test_steps_that_nobody_looks_at_are_not_priced_as_if_somebody_did() -> None:
    dynamics = dynamics_of(TWO_RATES)
    few, many = (Work(evaluations=12 * n, steps=n) for n in (FOLLOWED, 100 * FOLLOWED))
    price = [cost(dynamics, "dop853", "float64", work, looked_at=True) for work in (few, many)]
    plain = [cost(dynamics, "dop853", "float64", work) for work in (few, many)]
    assert price[1] - plain[1] == pytest.approx(price[0] - plain[0])
