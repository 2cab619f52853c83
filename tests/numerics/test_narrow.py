"""Narrow features within a step: what is passed over by a bound would have been passed over by looking for it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from mbsym.numerics.events.features import DIP, PEAK, TURN
from mbsym.numerics.methods import sides as narrow


class Step:
    """A motion of nothing from t = 0 to 2."""

    start, end = 0.0, 2.0

    def __call__(self, times: Any) -> Any:
        return np.zeros((2, len(times)))


def found(kind: str, shape: Callable[[Any], Any]) -> list[tuple[float, float, int]]:
    """What a u(t) does narrowly."""
    return narrow.met([kind], lambda points: shape(points[0])[None], Step())  # type: ignore[arg-type]


def steps() -> list[Callable[[Any], Any]]:
    """u over steps of all kinds: far from a feature, through it, along its border, of every size."""
    chance = np.random.default_rng(7)
    made = []
    for _ in range(4000):
        degree = int(chance.integers(1, 6))
        coefficients = 10.0 ** chance.uniform(-2, 3) * chance.normal(size=degree + 1) / np.arange(1, degree + 2)
        coefficients[0] -= chance.choice([0.0, narrow.SMALL])
        made.append(np.polynomial.chebyshev.Chebyshev(coefficients, domain=[0, 2]))
    return made


@pytest.mark.parametrize("kind", [PEAK, DIP, TURN])
def test_what_is_plain_is_plain(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    given, verdicts, right = steps(), [], narrow._is_plain
    monkeypatch.setattr(narrow, "_is_plain", lambda *of: verdicts.append(right(*of)) or verdicts[-1])
    quick = [found(kind, u) for u in given]
    assert verdicts.count(True) > 300
    assert sum(map(bool, quick)) > 100
    monkeypatch.setattr(narrow, "_is_plain", lambda *_: False)
    assert quick == [found(kind, u) for u in given]


@pytest.mark.parametrize(("kind", "bound"), [(PEAK, 0), (PEAK, 1), (PEAK, 2), (DIP, 0), (DIP, 2), (TURN, 0), (TURN, 1)])
def test_a_bound_that_is_none_is_noticed(kind: str, bound: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The control: a third of each bound that a kind uses."""
    given = steps()
    known = [found(kind, u) for u in given]
    wrong = narrow._BOUNDS.copy()
    wrong[bound] /= 3
    monkeypatch.setattr(narrow, "_BOUNDS", wrong)
    assert known != [found(kind, u) for u in given]


def test_a_peak_in_the_middle_of_a_step_is_found() -> None:
    """exp(-(1000 (t - 1))^2): greatest at 1, of width 1/1000."""
    assert found(PEAK, lambda t: -((1000 * (t - 1)) ** 2)) == [pytest.approx((1.0, 0.001, 0), rel=1e-9)]
