"""What is proposed where a description has no unperturbed motion, or one whose first approximation varies with time."""

from __future__ import annotations

import sys
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

sys.path.append(str(Path(__file__).parents[1] / "bench"))
import chains

import mbsym
from mbsym.analysis import approximation
from mbsym.analysis.approximation import regular_at_zero
from mbsym.analysis.pipeline import Analysis
from mbsym.analysis.stages import Unavailable
from mbsym.expressions.tree import Number
from mbsym.model.system import MotionEntry, System

PARTICLE = """
mbsym: 1
name: particle
parameters: {{k: positive, a: positive, b: real}}
bodies:
  - {{name: p, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}}
loads:
  - potential: {potential}
"""


def system(potential: str) -> System:
    return mbsym.loads(PARTICLE.format(potential=potential)).system


@pytest.mark.parametrize(
    ("potential", "regular"),
    [
        ("-k/sqrt(x**2 + y**2)", False),
        ("k*sqrt(x**2 + y**2)", False),  # finite at 0, without a derivative there
        ("k*(x**2 + y**2)**(3/2)", False),
        ("k*log(x + y)", False),
        ("k/(a - a*cos(x))", False),
        ("-k/sqrt(x**2 + y**2 + a**2)", True),
        ("k/(x - a) + y**2", True),
        ("k*x**2/a + y**4", True),
        ("sqrt(k/a)*x*y + b*y", True),
    ],
)
def test_where_the_origin_is_singular(potential: str, regular: bool) -> None:
    assert regular_at_zero(system(potential)) is regular


@pytest.mark.parametrize(("potential", "proposed"), [("-k/sqrt(x**2 + y**2)", False), ("k*x**2 + y**2", True)])
def test_only_a_motion_that_can_be_looked_at_is_proposed(potential: str, proposed: bool) -> None:
    """The motion that is proposed, taken, gives a first approximation."""
    text = PARTICLE.format(potential=potential)
    with pytest.raises(Unavailable) as told:
        mbsym.loads(text).stability  # noqa: B018
    hint = "motion: {x: 0, y: 0}"
    assert (hint in str(told.value)) is proposed
    taken = mbsym.loads(f"{text}{hint}\n")
    if proposed:
        assert taken.linearisation.K is not None
    else:
        assert "singular" in str(told.value)
        with pytest.raises(Unavailable):
            taken.linearisation  # noqa: B018


PIVOT = """
mbsym: 1
name: pendulum on a moving pivot
parameters: {{m: positive, l: positive, g: positive, h: positive, nu: positive}}
prescribed: {{phi: {{rate: nu}}}}
bodies:
  - {{name: rod, attached to: 0, connection point: [0, {height}, 0], rotation: {{axes: [3], angles: [theta]}},
     mass centre: [0, l, 0], mass: m}}
loads:
  - uniform gravity: {{acceleration: g, direction: [0, -1, 0]}}
motion: {{theta: 0}}
"""


@pytest.mark.parametrize(("height", "periodic"), [("h*cos(phi)", True), ("h*phi**3", False)])
def test_floquet_is_named_where_coefficients_may_be_periodic(height: str, periodic: bool) -> None:
    with pytest.raises(Unavailable) as told:
        mbsym.loads(PIVOT.format(height=height)).stability  # noqa: B018
    assert "time-dependent" in str(told.value)
    assert ("mbsym floquet FILE" in str(told.value)) is periodic


def test_rest_is_looked_at_without_products_of_deviations_where_nothing_is_singular(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A chain of n bodies has n**2 of them in every formula."""
    orders: list[int] = []
    expand = approximation.over_jets

    def counted(scene: Any, base: Any, whole: Any = None, order: int = 1) -> Any:
        orders.append(order)
        return expand(scene, base, whole, order)

    monkeypatch.setattr(approximation, "over_jets", counted)
    text = chains.description(chains.chain(8, full=False))
    with pytest.raises(Unavailable) as told:
        mbsym.loads(text).stability  # noqa: B018
    assert "motion: {q1: 0, q2: 0" in str(told.value)
    assert 2 not in orders


@pytest.mark.parametrize("name", ["clebsch", "double-pendulum", "euler-poisson", "four-bar", "heavy-top", "kirchhoff"])
def test_a_proposed_motion_is_one_in_the_variables_of_the_description(name: str) -> None:
    """Angles about the axes 3, 1, 3 are singular at zero: what is at rest there tells nothing of unit vectors."""
    system = replace(mbsym.load(Path(__file__).parents[2] / f"systems/{name}.yaml").system, motion=(), claims=())
    with pytest.raises(Unavailable) as told:
        Analysis(system).stability  # noqa: B018
    if "add for example" in str(told.value):
        resting = tuple(MotionEntry(q, Number(Fraction(0)), Number(Fraction(0))) for q in system.coordinates)
        assert Analysis(replace(system, motion=resting)).equilibrium.satisfied
