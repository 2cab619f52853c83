"""Mistakes planted where constrained systems are expanded: the multipliers of the self-check find each of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from conftest import SHIPPED

import mbsym
from mbsym.analysis import approximation
from mbsym.mechanics import expansion
from mbsym.problems.checks import FAILED


def _without_slopes(original: Callable[..., Any]) -> Callable[..., Any]:
    """Y_x forgotten: only J on the motion is used."""
    return lambda *_: {}


def _without_rates(original: Callable[..., Any]) -> Callable[..., Any]:
    """J' q' forgotten: what accelerations take from velocities."""

    def wrong(scene: Any, row: Any, key: str, places: range, forms: Any) -> Any:
        return {} if key == "h" and places.start > 0 else original(scene, row, key, places, forms)

    return wrong


def _one_sign(original: Callable[..., Any]) -> Callable[..., Any]:
    """The dependent deviations with the other sign."""
    return lambda form: form


MISTAKES = [
    ("bicycle", expansion, "_bent", _without_slopes),
    ("cartesian-pendulum", expansion, "_bent", _without_slopes),
    ("bicycle", expansion, "_substituted", _without_rates),
    ("rolling-disc", expansion, "_negative", _one_sign),
    ("bicycle", expansion, "_negative", _one_sign),
]


@pytest.mark.parametrize(("name", "module", "function", "mistake"), MISTAKES)
def test_a_mistake_is_found(
    monkeypatch: pytest.MonkeyPatch, name: str, module: Any, function: str, mistake: Callable[..., Any]
) -> None:
    monkeypatch.setattr(module, function, mistake(getattr(module, function)))
    analysis = mbsym.load(SHIPPED / f"{name}.yaml")
    found = analysis.check("perturbed motion")
    assert found is not None
    assert found.outcome == FAILED


def test_forces_of_the_constraints_matter(monkeypatch: pytest.MonkeyPatch) -> None:
    """A sign of the projected forcing: problem 4's own check is the one that finds it, where there is any force."""
    original = approximation.projected

    def wrong(scene: Any, found: Any) -> Any:
        right = original(scene, found)
        return replace(right, constant=tuple(x + scene.ring.one for x in right.constant))

    monkeypatch.setattr(approximation, "projected", wrong)
    analysis = mbsym.load(SHIPPED / "cartesian-pendulum.yaml")
    with pytest.raises(mbsym.analysis.Unavailable):
        _ = analysis.equilibrium
