"""Motions that are prescribed: their accelerations act on the first approximation, and may make it time-dependent.

The truth comes from the linear equations written by hand, whose Floquet multipliers are integrated numerically.
"""

from __future__ import annotations

import json
from collections.abc import Callable

import numpy as np
import pytest
from conftest import TESTS, Exact, at_values
from scipy.integrate import solve_ivp

import mbsym
from mbsym.analysis import Analysis, Unavailable
from mbsym.model.system import rational

CASES = TESTS / "cases" / "statements"
KAPITZA = {"kap_hang_resonant": 1, "kap_up_stable": -1}


def multiplier(damping: float, stiffness: Callable[[float], float], period: float) -> float:
    """The largest |Floquet multiplier| of x'' + damping x' + stiffness(t) x = 0."""
    columns = []
    for start in ((1.0, 0.0), (0.0, 1.0)):
        run = solve_ivp(
            lambda t, y: [y[1], -damping * y[1] - stiffness(t) * y[0]], (0, period), start, rtol=1e-10, atol=1e-12
        )
        columns.append(run.y[:, -1])
    return float(max(abs(np.linalg.eigvals(np.array(columns).T))))


@pytest.mark.parametrize(("name", "below", "above"), [("kap_hang_resonant", 2.3, 2.4), ("kap_up_stable", 0.99, 0.9999)])
def test_a_vibrating_pivot_gives_a_periodic_stiffness_and_no_autonomous_theorem(
    name: str, below: float, above: float
) -> None:
    """By hand: m l^2 th'' + b th' + s m l (g - s' a om^2 cos chi) th = 0, s = 1 hanging and -1 standing up."""
    analysis, side = mbsym.load(CASES / f"{name}.yaml"), KAPITZA[name]
    found, exact = analysis.first_approximation, Exact(analysis)
    assert found.M[0, 0] == exact("m*l**2")
    assert found.D[0, 0] == exact("b")
    assert found.K[0, 0] == exact(f"{side}*m*l*(g - a*om**2*cos(chi))")
    assert [(entry.matrix, entry.row, entry.column, entry.among) for entry in found.varying] == [
        ("K", "th", "th", ("chi",))
    ]
    m, length, g, a, om, b = (value_of(analysis, name) for name in ("m", "l", "g", "a", "om", "b"))
    largest = multiplier(
        b / (m * length**2), lambda t: side * (g - a * om**2 * np.cos(om * t)) / length, 2 * np.pi / om
    )
    assert below < largest < above  # the hanging one is unstable and the upper one stable
    assert analysis.stage(5).value == found  # with its coefficients; no theorem is about them
    failure = analysis.stage(6).failure
    assert failure is not None
    assert failure.short == "time-dependent"
    assert "vary with chi" in failure.reason
    with pytest.raises(Unavailable):
        _ = analysis.stability
    assert not [check for check in analysis.checks if check.failed]


def value_of(analysis: Analysis, name: str) -> float:
    [value] = [rational(parameter.value) for parameter in analysis.system.parameters if parameter.name == name]
    assert value is not None
    return float(value)


def test_a_lift_in_constant_acceleration_has_a_constant_stiffness() -> None:
    """By hand: m l^2 th'' + m l (g + a) th = 0: unstable at a = -20, g = 10; the matrices are constant."""
    analysis = mbsym.load(CASES / "lift.yaml")
    assert analysis.linearisation.varying == ()
    assert analysis.linearisation.K[0, 0] == Exact(analysis)("m*l*(g + a)")
    verdict = analysis.stability.numerical
    assert verdict is not None
    assert str(verdict.word) == "unstable"
    risen = at_values(CASES / "lift.yaml", a=5).stability
    assert risen.numerical is not None
    assert str(risen.numerical.word) != "unstable"
    [root] = [x for x in risen.spectra[0].roots if x.ball.imag > 0]
    assert abs(complex(root.ball) - 1j * np.sqrt(15)) < 1e-12


def test_equilibria_of_a_falling_lift_turn_over() -> None:
    """At a = -20, g = 10 what hangs is unstable and what stands is not."""
    found = mbsym.load(CASES / "lift.yaml").equilibria.equilibria
    words = {round(float(item.values[0].value), 6): str(item.verdict.word) for item in found}
    assert words.pop(0.0) == "unstable"
    [standing] = words.values()
    assert standing not in ("unstable", "asymptotically stable", "undecided")


def test_equilibria_on_a_vibrating_pivot_are_not_judged() -> None:
    found = mbsym.load(CASES / "kap_up_stable.yaml").equilibria.equilibria
    assert {str(item.verdict.word) for item in found} == {"undecided"}


def loaded(**description: object) -> Analysis:
    return mbsym.loads(json.dumps({"mbsym": 1, "name": "driven"} | description))


#: A point on a turning table (prescribed angle), held by a spring: x'' - 2 w y' + (k/m - w^2) x = 0, and so for y.
TABLE = {
    "parameters": {"m": "positive", "k": "positive", "w": "real"},
    "prescribed": {"chi": "w"},
    "bodies": [
        {"name": "table", "attached to": 0, "rotation": {"axes": [3], "angles": ["chi"]}, "mass": 0},
        {
            "name": "p",
            "attached to": "table",
            "connection point": ["x", "y", 0],
            "mass": "m",
            "coordinates": ["x", "y"],
        },
    ],
    "loads": [{"potential": "k*(x**2 + y**2)/2"}],
    "motion": {"x": 0, "y": 0},
}


def test_a_frame_that_turns_uniformly_leaves_constant_coefficients() -> None:
    found, exact = (analysis := loaded(**TABLE)).linearisation, Exact(analysis)
    assert [found.K[i, j] for i in range(2) for j in range(2)] == [
        exact(x) for x in ("k - m*w**2", "0", "0", "k - m*w**2")
    ]
    assert (found.G[0, 1], found.G[1, 0]) == (exact("-2*m*w"), exact("2*m*w"))
    assert found.D[0, 0].is_zero
    assert found.varying == ()


@pytest.mark.parametrize(
    ("point", "stiffness", "among"),
    [
        (["s", 0, 0], "m*g", ()),  # steady: nothing but gravity
        ([0, "c*s**2/2", 0], "m*(g + c*v**2)", ()),
        ([0, "c*s**3/6", 0], "m*(g + c*v**2*s)", ("s",)),
        ([0, "c*sin(s)", 0], "m*(g - c*v**2*sin(s))", ("s",)),
        ([0, "s + c*exp(s)", 0], "m*(g + c*v**2*exp(s))", ("s",)),
    ],
)
def test_the_vertical_acceleration_of_the_pivot_adds_to_gravity(
    point: list[object], stiffness: str, among: tuple[str, ...]
) -> None:
    """A pendulum of length 1, s' = v: K = m (g + d^2 y/dt^2)."""
    rod = {"name": "rod", "attached to": 0, "rotation": {"axes": [3], "angles": ["q"]}, "connection point": point}
    analysis = loaded(
        parameters={"m": "positive", "g": "positive", "c": "real", "v": "real"},
        prescribed={"s": "v"},
        bodies=[rod | {"mass centre": [0, -1, 0], "mass": "m"}],
        loads=[{"uniform gravity": {"vector": [0, "-g", 0]}}],
        motion={"q": 0},
    )
    found = analysis.first_approximation
    assert found.K[0, 0] == Exact(analysis)(stiffness)
    assert tuple(name for entry in found.varying for name in entry.among) == among
    assert [check for check in analysis.checks if check.failed] == []


def test_a_length_that_is_prescribed_damps_or_drives() -> None:
    """d/dt (m s^2 th') + m g s th = 0 with s' = v: M' = 2 m s v stands beside the velocity."""
    rod = {"name": "rod", "attached to": 0, "rotation": {"axes": [3], "angles": ["q"]}, "mass": "m"}
    analysis = loaded(
        parameters={"m": "positive", "g": "positive", "v": "real"},
        prescribed={"s": "v"},
        bodies=[
            rod | {"mass": 0},
            {"name": "bob", "attached to": "rod", "connection point": [0, "-s", 0], "mass": "m"},
        ],
        loads=[{"uniform gravity": {"vector": [0, "-g", 0]}}],
        motion={"q": 0},
    )
    found, exact = analysis.first_approximation, Exact(analysis)
    assert (found.M[0, 0], found.D[0, 0], found.K[0, 0]) == (exact("m*s**2"), exact("2*m*s*v"), exact("m*g*s"))
    assert {entry.matrix for entry in found.varying} == {"M", "D", "K"}
    assert analysis.stage(6).failure is not None


def oscillator(force: str, stiffness: int = 1, **more: object) -> Analysis:
    """x'' + stiffness x + x' = force."""
    body = {"name": "p", "connection point": ["x", 0, 0], "mass": 1, "coordinates": ["x"]}
    loads = [{"potential": f"({stiffness})*x**2/2"}, {"generalized force": {"x": f"-x_dot + {force}"}}]
    return loaded(bodies=[body], loads=loads, motion={"x": 0}, **more)


def farthest(force: Callable[[float, float], float], stiffness: int) -> float:
    """The largest |x| in 0 < t < 3 of x'' + x' + stiffness x = force(t, x) from x = 0.01 at rest."""
    blown = lambda t, y: abs(y[0]) - 1  # noqa: E731
    blown.terminal = True  # type: ignore[attr-defined]
    run = solve_ivp(
        lambda t, y: [y[1], -y[1] - stiffness * y[0] + force(t, y[0])],
        (0, 3),
        (0.01, 0),
        events=blown,
        rtol=1e-9,
        atol=1e-12,
    )
    return float(max(abs(run.y[0])))


def test_terms_of_higher_order_that_grow_with_time_leave_no_theorem() -> None:
    """x'' + x' + x = x^3 exp(10 t) leaves 0, all roots to the left; with -x for x it stays, one to the right.

    After s = x exp(5 t) the cubic term is autonomous and not small: the linear theorems need it small at all times.
    """
    assert farthest(lambda t, x: x**3 * np.exp(10 * t), 1) > 0.9
    assert farthest(lambda t, x: -(x**3) * np.exp(10 * t), -1) < 0.02
    for analysis in (oscillator("x**3*exp(10*t)"), oscillator("-x**3*exp(10*t)", -1), oscillator("x**3*t")):
        assert analysis.linearisation.varying == ()
        failure = analysis.stage(6).failure
        assert failure is not None
        assert (failure.short, "vary with t " in failure.reason) == ("time-dependent", True)
        with pytest.raises(Unavailable):
            _ = analysis.stability


@pytest.mark.parametrize(
    ("force", "more"),
    [
        ("x**3*sin(3*t)", {}),
        ("x**2*cos(chi)", {"prescribed": {"chi": 2}}),
        ("x**3*(t - t)", {}),
    ],
)
def test_terms_of_higher_order_that_swing_with_time_are_small_at_all_times_alike(
    force: str, more: dict[str, object]
) -> None:
    assert str(oscillator(force, **more).stability.verdict.word) == "asymptotically stable"
    assert str(oscillator(force, -1, **more).stability.verdict.word) == "unstable"


@pytest.mark.parametrize(("sign", "decided"), [("positive", True), ("negative", False), ("real", False)])
def test_a_dimensionless_time_that_may_run_backwards_leaves_no_verdict(sign: str, decided: bool) -> None:
    """x'' + x' + x = 0 decays, whatever w of tau = w t is; in tau it grows where w < 0."""
    analysis = oscillator("0*x", parameters={"w": sign}, **{"dimensionless time": "w"})
    if decided:
        assert str(analysis.stability.verdict.word) == "asymptotically stable"
        return
    failure = analysis.stage(6).failure
    assert failure is not None
    assert failure.code == "time-scale-sign"
    undamped = loaded(**TABLE | {"dimensionless time": "w"})  # its spectrum is the same backwards
    assert undamped.stage(6).failure is None


DRAGGED = """
mbsym: 1
name: A block dragged by a spring whose end moves evenly
parameters: {k: positive, v: positive, m: positive, c: positive}
PRESCRIBED
bodies:
  - {name: block, attached to: 0, mass: m, connection point: [x, 0, 0], coordinates: [x]}
loads:
  - potential: POTENTIAL
  - damper: {coordinate: x, coefficient: c}
motion: {x: {value: START, rate: v}}
"""


@pytest.mark.parametrize(
    ("potential", "prescribed", "start", "condition"),
    [
        ("k*(x - v*t)**2/2", "", "-c*v/k", ""),
        ("k*(x - v*t)**2/2 + k*(x - v*t)**4", "", "0", "-v*c"),
        ("k*(x - chi)**2/2", "prescribed: {chi: v}", "-c*v/k", ""),
        ("k*(x - chi)**2/2", "prescribed: {chi: v}", "0", "-v*c"),
    ],
)
def test_what_does_not_vary_along_the_motion_is_not_called_varying(potential, prescribed, start, condition) -> None:
    """m x'' + c x' + k (x - v t) = 0 has x = v t - c v/k, no other one: m y'' + c y' + k y = 0 about it.

    With x = v t a force c v is left over, which never vanishes: that motion does not exist.
    """
    text = DRAGGED.replace("PRESCRIBED", prescribed).replace("POTENTIAL", potential).replace("START", start)
    found = mbsym.loads(text)
    assert found.equilibrium.unsteady == ()
    assert [str(x) for x in found.equilibrium.impossible] == ([condition] if condition else [])
    if not condition:
        assert (str(found.linearisation.K), str(found.linearisation.D)) == ("[[k]]", "[[c]]")
        assert found.stability.verdict.word == "asymptotically stable"
        assert not any(check.failed for check in found.checks)


def test_what_varies_along_the_motion_is_still_called_varying() -> None:
    """k (x - 2 v t): the spring's end runs away from the block."""
    text = DRAGGED.replace("PRESCRIBED", "").replace("START", "0")
    assert mbsym.loads(text.replace("POTENTIAL", "k*(x - 2*v*t)**2/2")).equilibrium.unsteady == ("x", "t")
