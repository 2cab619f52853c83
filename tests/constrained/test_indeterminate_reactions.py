"""Reactions of statically indeterminate joints: what is determined, and what forces in balance add, by hand."""

from __future__ import annotations

from math import cos, sin
from pathlib import Path

import numpy as np
import pytest
from terminal import told

import mbsym
from mbsym.analysis import Analysis
from mbsym.report.code import c_source
from mbsym.report.targets import FORMATS

CASES = Path(__file__).parents[1] / "cases" / "constraints"
FORCE, MOMENT = (0, 1, 2), (3, 4, 5)


def case(name: str, more: str = "") -> Analysis:
    return mbsym.loads((CASES / f"{name}.yaml").read_text(encoding="utf-8") + more, (3, 7))


def test_three_bars() -> None:
    """Three parallel bars carry a coupler: forces along them of (1, -2, 1) are in balance, force and moment.

    So in the joint of a bar the force along it (1) is not determined, the one across it (2) is; out of the plane, where
    a pin may press against others, 3 and moment 2 are not.  What is in balance in the plane is along the bars: in the
    coupler's axes it turns with b, so that of both components one combination is determined.
    """
    coupler, bar = case("par3-react").reactions
    assert coupler.undetermined == (0, 1, 2, 4)
    assert bar.undetermined == (0, 2, 4)
    assert coupler.combinations == bar.combinations == 1
    along = next(one for one in bar.balances if len(one.rows) == 4)
    assert along.components == (0,)
    assert {name.label for name in along.rows} == {f"coincide {k}, component {c}" for k in (1, 2) for c in (1, 2)}


def test_what_is_determined_is_what_the_equations_give() -> None:
    """A bar's force across, by moments about its lower end: (1/12 + 1/4) a'' = -g/2 cos a + (force of the pin) x 1.

    The joint at the foot supplies 1/2 a'' + g cos a less what the pin supplies: R_2 = a''/2 + g cos a - P, P = a''/3 +
    g/2 cos a; so R_2 = a''/6 + g/2 cos a whatever is in balance.  2 a'' = -5/2 g cos a (three bars and the coupler).
    """
    analysis = case("par3-react")
    module: dict[str, object] = {}
    text = FORMATS["python"].render(analysis, (3,))
    assert isinstance(text, str)
    exec(compile(text, "bars", "exec"), module)
    a, g = 0.7, 9.81
    state = np.array([a, a, a, -a, 0, 0, 0, 0])
    found = module["reactions"](0.0, state, {"g": g})  # type: ignore[operator]
    bent = -2.5 * g * cos(a) / 2
    assert found[1][1] == pytest.approx(bent / 6 + g / 2 * cos(a), abs=1e-9)
    assert (
        "not determined by the equations, are h: force 1, force 2, force 3, moment 2; v1: force 1, force 3"
        in " ".join(text.split())
    )
    assert sin(a) > 0


def test_a_wheel_of_an_axle() -> None:
    """Wheels on one axle may push aside against each other, and the road against what holds the axle at its height.

    Sideways (2): not determined, nor its moments about the wheel's other axes, which turn with it (1 and 3); upwards
    (1 and 3 of the force turn with the wheel) neither.  The moment about the axle is.
    """
    (wheel,) = case("segway").reactions
    assert wheel.undetermined == (0, 1, 2, 3, 5)
    assert wheel.combinations == 3


def test_what_is_determined_is_not_questioned() -> None:
    """A pendulum by a rod of fixed length: one row, one multiplier."""
    found = mbsym.loads(
        """
mbsym: 1
name: rod
parameters: {m: positive, l: positive, g: positive}
bodies:
  - {name: point, attached to: 0, connection point: [x, y, 0], coordinates: [x, y], mass: m}
loads: [{uniform gravity: {vector: [0, -g, 0]}}]
constraints: [{distance: {between: [{body: point, point: [0, 0, 0]}, {body: 0, point: [0, 0, 0]}], length: l}}]
reactions: [point]
""",
        (3,),
    ).reactions
    assert [one.balances for one in found] == [()]


def test_every_medium_says_so() -> None:
    analysis = case("par3-react")
    assert "indeterminate" in c_source.header(analysis, ())
    for kind in ("latex", "html", "casadi", "wolfram"):
        assert "indeterminate" in str(FORMATS[kind].render(analysis, (3,))), kind
    assert '"determined_combinations": 1' in str(FORMATS["json"].render(analysis, (3,)))
    lines = " ".join(told(analysis, 3))
    assert "The joint of v1 is statically indeterminate: the equations do not determine R1, R3, L2." in lines
