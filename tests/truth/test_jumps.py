"""The truth suite, jumps and kinks: what is not said of forces that come late, of dry friction and of corners."""

from __future__ import annotations

from math import gamma, sqrt

import pytest

import mbsym
from mbsym.algebra.failures import Failure
from mbsym.analysis import Analysis
from mbsym.numerics.conservation import Standing

PLANE = (
    "mbsym: 1\nname: plane\nbodies:\n"
    "  - {name: p, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}\nloads:\n"
)


def loaded(loads: str, motion: str = "motion: {x: 0, y: 0}\n") -> Analysis:
    return mbsym.loads(PLANE + loads + motion)


#: Momentum along 2 (y) is conserved until the force comes, or on one side of a corner only.
BROKEN = [
    "  - potential: x**2/2\n  - generalized force:\n      y: 3*step(t - 5)\n",
    "  - potential: x**2/2\n  - generalized force:\n      y: 3*pulse(t, 50, 51)\n",
    "  - potential: x**2/2\n  - generalized force:\n      y: step(x - 9)\n",
    "  - potential: x**2/2\n  - generalized force:\n      y: (abs(x) - x)/2\n",
    "  - potential: x**2/2 + (abs(y - 7) + y - 7)\n",
]


@pytest.mark.parametrize("loads", BROKEN)
def test_no_momentum_is_conserved_until_something_comes(loads: str) -> None:
    names = [item.name for item in loaded(loads).integrals]
    assert not any("axis 2" in name or name.endswith(" y") for name in names)


def test_the_energy_of_a_corner_is_conserved() -> None:
    """x'' = -sign x: |x| + v^2/2 is continuous, and constant between corners."""
    analysis = loaded("  - potential: abs(x) + y**2/2\n")
    assert any("energy" in item.name for item in analysis.integrals)


@pytest.mark.parametrize(
    "loads",
    [
        "  - generalized force:\n      x: -sign(x_dot) - x\n",  # a whole interval is at rest
        "  - rayleigh: abs(x_dot)\n  - potential: x**2/2\n",
        "  - potential: abs(x) + y**2/2\n",
        "  - generalized force:\n      x: -step(x)\n",
    ],
)
@pytest.mark.parametrize("number", [5, 6])
def test_nothing_is_linearised_at_a_jump(loads: str, number: int) -> None:
    stage = loaded(loads).stage(number)
    assert stage.failure is not None
    assert "jump" in str(stage.failure) or "kink" in str(stage.failure)


@pytest.mark.parametrize("force", ["-sign(x_dot)", "-x_dot*abs(x_dot) - sign(x)", "step(x - 1) - x/2"])
def test_equilibria_are_not_called_complete_where_forces_jump(force: str) -> None:
    text = (
        "mbsym: 1\nname: line\nbodies:\n"
        "  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}\nloads:\n"
        f"  - potential: x**4/4 - x**2/2\n  - generalized force:\n      x: {force}\n"
    )
    with pytest.raises(Failure, match=r"jump|sign"):
        mbsym.equilibria(mbsym.loads(text))


def test_a_push_that_comes_late_is_no_rest() -> None:
    """y rests until t = 5 and is accelerated then: y = 3 (t - 5)^2/2."""
    text = PLANE + BROKEN[0] + "initial: {x: {position: 1}, y: {position: 0}}\n"
    run = mbsym.simulate(mbsym.loads(text), 10)
    assert run["y"][-1] == pytest.approx(37.5, abs=1e-8)
    assert run.conservation.standing.conserved is not True


#: A ball of mass 1 that bounces on a spring of stiffness 1e10: contacts take pi/1e5, rows are 1.5e-3 apart.
BALL = "  - uniform gravity: {vector: [0, -10, 0]}\n  - generalized force:\n      y: 1e10*(abs(y) - y)/2\n"


@pytest.mark.parametrize("beside", ["", "  - generalized force:\n      x: -x - x**3\n"])
@pytest.mark.parametrize("start", ["x: 0", "x: 1"])
def test_an_energy_that_changes_for_an_instant_only_is_not_conserved(beside: str, start: str) -> None:
    """T - U without what the spring of the wall holds: in the middle of a contact it is all of the energy of the fall.

    Between rows, and there is none in a contact, it is the same as before; alone, beside a coordinate that rests, and
    beside one that is integrated by itself.
    """
    found = mbsym.loads(PLANE + BALL + beside + f"initial: {{{start}, y: 1}}\n")
    run = mbsym.simulate(found, 1, samples=701)
    assert run["y"].min() > -0.02
    assert run.conservation.standing is Standing.CHANGING


@pytest.mark.parametrize("force", ["-sign(x)*sqrt(abs(x))", "-sqrt(abs(x))*x/abs(x)"])
def test_roots_of_what_changes_its_sign_are_passed(force: str) -> None:
    """x'' = -sign(x) sqrt|x| from rest at 1 is at -1 after half a period, 2 B(2/3, 1/2)/sqrt(3), and back after one."""
    half = 2 * gamma(2 / 3) * gamma(1 / 2) / gamma(7 / 6) / sqrt(3)
    text = PLANE + f"  - generalized force:\n      x: {force}\ninitial: {{x: 1, y: 0}}\n"
    for time, place in ((half, -1), (2 * half, 1)):
        assert mbsym.simulate(mbsym.loads(text), time)["x"][-1] == pytest.approx(place, abs=1e-8)


def test_a_velocity_that_turns_under_a_root_turns_once() -> None:
    """x'' = -x - sign(x') sqrt|x'|/10: near the turn x' = -x (t - t0), steps are short, and what rounding of the time
    makes of x' is no second change."""
    force = '"-x - sign(x_dot)*sqrt(abs(x_dot))/10"'
    run = mbsym.simulate(
        mbsym.loads(PLANE + f"  - generalized force:\n      x: {force}\ninitial: {{x: 1, y: 0}}\n"), 5.0
    )
    assert run.trajectory.passed is not None
    assert not run.trajectory.passed.unresolved
    assert len(run.trajectory.passed.switches) == 1
