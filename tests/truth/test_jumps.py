"""The truth suite, jumps and kinks: what is not said of forces that come late, of dry friction and of corners."""

from __future__ import annotations

from math import cos, gamma, sin, sqrt

import pytest
from conftest import parsed

import mbsym
from mbsym.algebra.failures import Failure
from mbsym.analysis import Analysis
from mbsym.expressions.tree import differentiate
from mbsym.numerics.conservation import Standing
from mbsym.problems.stability.words import Word

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
    names = [item.name for item in loaded(loads).integrals if item.kind != "energy of a part"]
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


SMOOTH = """mbsym: 1
name: on a line
parameters: {m: positive, k: positive, c: positive}
bodies:
  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
loads:
  - potential: POTENTIAL
  - LOAD
motion: {x: 0}
values: {m: 1, k: 1, c: 1}
"""


@pytest.mark.parametrize(
    ("potential", "load", "wanted"),
    [
        ("k*x**2/2 + abs(x)**3", "", Word.STABLE),
        ("k*x**2/2 + abs(x)*x**2", "damper: {coordinate: x, coefficient: c}", Word.ASYMPTOTIC),
        ("abs(x)**3 - k*x**2/2", "", Word.UNSTABLE),
        ("k*x**2/2", "generalized force: {x: -c*sign(x_dot)*x_dot**2}", Word.ASYMPTOTIC),
        ("k*x**2/2", "generalized force: {x: -c*x_dot**2/2*sign(x_dot)}", Word.ASYMPTOTIC),
        ("k*x**2/2", "generalized force: {x: -c*abs(x_dot)*x_dot}", Word.ASYMPTOTIC),
        ("k*x**2/2", "rayleigh: c*abs(x_dot)**3/3", Word.ASYMPTOTIC),
        ("k*x**2/2", "rayleigh: -c*abs(x_dot)**3/3", None),
        # Of one coordinate by the first term of V, which does not know x' (Barbashin, Krasovskii).
        ("k*x**4", "rayleigh: c*abs(x_dot)**3/3", Word.ASYMPTOTIC),
        ("k*x**4", "rayleigh: -c*abs(x_dot)**3/3", Word.UNSTABLE),
        ("k*x**4", "generalized force: {x: -c*abs(x_dot)*x_dot*x**2}", Word.ASYMPTOTIC),
        ("k*x**4", "generalized force: {x: -c*abs(x_dot)*x_dot*x}", Word.UNDECIDED),
        ("k*abs(x)**3", "rayleigh: c*abs(x_dot)**3/3", Word.ASYMPTOTIC),
        ("-k*x**4", "rayleigh: c*abs(x_dot)**3/3", Word.UNSTABLE),
        ("k*x**3", "rayleigh: c*abs(x_dot)**3/3", Word.UNSTABLE),
    ],
)
def test_what_vanishes_with_the_argument_of_a_sign_does_not_jump(
    potential: str, load: str, wanted: Word | None
) -> None:
    """d|x|^3 = 3 x |x| dx and v^2 sign v = v |v|, which have derivatives at 0; of these the energy falls at all v."""
    text = SMOOTH.replace("POTENTIAL", potential).replace("  - LOAD\n", f"  - {load}\n" if load else "")
    verdict = mbsym.loads(text, (4, 5, 6)).stability.numerical
    assert verdict is not None
    assert verdict.word is wanted if wanted else not verdict.stable


@pytest.mark.parametrize("potential", ["k*abs(x)", "k*x*abs(x)"])
def test_what_has_no_second_derivative_has_no_first_approximation(potential: str) -> None:
    with pytest.raises(Failure, match=r"kink|jump"):
        mbsym.loads(SMOOTH.replace("POTENTIAL", potential).replace("  - LOAD\n", ""), (4, 5, 6)).stability  # noqa: B018


@pytest.mark.parametrize(
    "text", ["abs(x - y)**3", "(x - y)**2*abs(x - y)/2", "-abs(x*y)**5/(1 + x**2)", "y*sin(x)*abs(x)**2"]
)
@pytest.mark.parametrize("place", [(0.7, 0.2), (-0.4, 0.3), (0.3, 0.3), (0.0, 0.5)])
def test_slopes_on_both_sides_of_a_kink_and_there(text: str, place: tuple[float, float]) -> None:
    """By central differences; no sign is left."""
    slope = str(differentiate(parsed(text), "x"))
    assert "sign" not in slope
    x, y = place
    above, at, below = (
        eval(formula, {"abs": abs, "sin": sin, "cos": cos, "x": u, "y": y})
        for formula, u in ((text, x + 1e-6), (slope, x), (text, x - 1e-6))
    )
    assert at == pytest.approx((above - below) / 2e-6, abs=1e-7)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("3*sign(x)*x**2", "3*(abs(x)*x)"),
        ("-x*y/2*sign(x)", "-(abs(x)*y)/2"),
        ("sign(x)*abs(x)*sign(y)*y", "x*abs(y)"),
        ("sign(x)*y", "sign(x)*y"),
        ("x/sign(x)", "x/sign(x)"),
        ("sign(x)*(x + y)", "sign(x)*(x + y)"),
    ],
)
def test_a_product_that_is_written_with_a_sign(text: str, said: str) -> None:
    assert str(parsed(text)) == said
