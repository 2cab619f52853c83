"""Narrow features within a step: what is passed over by a bound would have been passed over by looking for it."""

from __future__ import annotations

import numpy as np
import pytest

from mbsym.numerics.crossings import NODES, nodes, series
from mbsym.numerics.features import DIP, PEAK, TURN
from mbsym.numerics.methods import narrow


def found(kind: str, values: object) -> list[tuple[float, float]]:
    return narrow._places(kind, 0.0, 2.0, values)


def steps() -> list[object]:
    """u over steps of all kinds: far from the feature, through it, along its border, of every size."""
    chance = np.random.default_rng(7)
    s = nodes(-1.0, 1.0)
    made = []
    for _ in range(4000):
        degree = int(chance.integers(1, 6))
        shape = np.polynomial.chebyshev.chebval(s, chance.normal(size=degree + 1) / np.arange(1, degree + 2))
        made.append(10.0 ** chance.uniform(-2, 3) * (shape + chance.normal()) - chance.choice([0.0, narrow.SMALL]))
    return made


@pytest.mark.parametrize("kind", [PEAK, DIP, TURN])
def test_what_is_far_is_far(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    given = steps()
    quick = [found(kind, values) for values in given]
    assert sum(map(bool, quick)) > 100
    passed = [narrow._is_far(kind, float(c[0]), float(np.sum(np.abs(c[1:])))) for c in map(series, given)]
    assert sum(passed) > 300
    monkeypatch.setattr(narrow, "_is_far", lambda *_: False)
    assert quick == [found(kind, values) for values in given]


@pytest.mark.parametrize("kind", [PEAK, DIP, TURN])
def test_a_bound_that_reaches_too_far_is_noticed(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The control: half of the coefficients are no bound."""
    right = narrow._is_far
    given = steps()
    known = [found(kind, values) for values in given]
    monkeypatch.setattr(narrow, "_is_far", lambda kind, middle, most: right(kind, middle, 0.5 * most))
    assert known != [found(kind, values) for values in given]


def test_a_peak_in_the_middle_of_a_step_is_found() -> None:
    """exp(-(1000 (t - 1))^2): greatest at 1, of width 1/1000."""
    values = -((1000 * (nodes(0.0, 2.0) - 1)) ** 2)
    assert len(values) == NODES
    assert found(PEAK, values) == [pytest.approx((1.0, 0.001), rel=1e-9)]
