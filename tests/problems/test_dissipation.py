"""What loads without a force function do to the energy: proved near the motion and in all orders, or not claimed.

The truth: the power P = -q'.dR/dq' evaluated by sympy at states near the motion, and trajectories by hand-written
equations.
"""

from __future__ import annotations

import itertools
import json
from typing import Any

import numpy as np
import pytest
import sympy
from conftest import TESTS, at_values
from hypothesis import given
from hypothesis import strategies as st
from properties import settings
from scipy.integrate import solve_ivp

import mbsym
from mbsym.analysis import Analysis
from mbsym.analysis.stages import Unavailable
from mbsym.problems.dissipation import EnergyLaw

CASES = TESTS / "cases" / "statements"
CONSERVED, NOT_GROWING, UNKNOWN, GROWS = EnergyLaw

PARAMETERS = {"b": "positive", "n": "nonnegative", "c": "real", "e": "negative", "W": "positive"}


def point(*loads: Any, spring: bool = True, **more: Any) -> Analysis:
    """A unit mass in the plane, held by springs of stiffness 1 and 2."""
    held = [{"spring": {"coordinate": "x", "stiffness": 1}}, {"spring": {"coordinate": "y", "stiffness": 2}}]
    body = {"name": "p", "attached to": 0, "connection point": ["x", "y", 0], "mass": 1, "coordinates": ["x", "y"]}
    description = {"mbsym": 1, "name": "point", "parameters": PARAMETERS, "bodies": [body]}
    description |= {"loads": [*(held if spring else []), *loads], "motion": {"x": 0, "y": 0}} | more
    return mbsym.loads(json.dumps(description))


#: By hand, with b > 0, n >= 0, c real, e < 0, W > 0; P = -q'.dR/dq'.
RAYLEIGH = [
    ("0", CONSERVED),
    ("c*x**2", CONSERVED),  # no velocity: no force
    ("b*x_dot**2/2", NOT_GROWING),
    ("n*x_dot**2/2 + b*y_dot**4", NOT_GROWING),
    ("b*x_dot**2*x**2", NOT_GROWING),
    ("b*(x_dot - y_dot)**2/2", NOT_GROWING),
    ("b*(x_dot - x*y_dot)**4", NOT_GROWING),
    ("b*(x_dot**2 + y_dot**2)**3", NOT_GROWING),
    ("b*x_dot**2 + c*x_dot**3", NOT_GROWING),  # the quadratic part is positive definite where it matters
    ("b*x_dot**2 - W*x_dot**4", NOT_GROWING),
    ("b*x_dot**2 + b*y_dot**2 + c*x_dot**2*y_dot + c*y*x_dot*y_dot", NOT_GROWING),
    ("(b + c*x)*x_dot**2", NOT_GROWING),  # positive on the motion, so near it
    ("b*x_dot**2 + 2*b*x_dot*y_dot + b*y_dot**2", NOT_GROWING),  # a square multiplied out
    ("b*x_dot**2 + 2*b*x_dot*y_dot + 3*b*y_dot**2 + y_dot**4", NOT_GROWING),
    ("-x_dot**4/4", GROWS),
    ("e*x_dot**2", GROWS),
    ("c*x_dot**2", UNKNOWN),
    ("x_dot**3", UNKNOWN),
    ("c*x_dot**4 + b*y_dot**2", UNKNOWN),  # nothing definite holds x_dot**4
    ("b*x*x_dot**2", UNKNOWN),
    ("b*(x_dot + W*y)**4/4", UNKNOWN),  # internal damping of a shaft
    ("b*((x_dot + W*y)**2 + (y_dot - W*x)**2)**2/4", UNKNOWN),
    ("b*x_dot*y", UNKNOWN),
    ("b*x_dot**2 + 3*b*x_dot*y_dot + b*y_dot**2", UNKNOWN),  # indefinite
    ("b*x_dot**2*cos(t)", UNKNOWN),
    ("b*x_dot**2 + t*x_dot**3", UNKNOWN),  # ever less near the motion
]


@pytest.mark.parametrize(("dissipation", "law"), RAYLEIGH)
def test_the_law_of_the_energy_under_a_dissipation_function(dissipation: str, law: EnergyLaw) -> None:
    assert point({"rayleigh": dissipation}).balance.law is law


@pytest.mark.parametrize(
    ("loads", "law"),
    [
        ([{"damper": {"coordinate": "x", "coefficient": "n"}}], NOT_GROWING),
        ([{"damper": {"coordinate": "x", "coefficient": "c"}}], UNKNOWN),
        ([{"damper": {"coordinate": "x", "coefficient": "e"}}], GROWS),
        ([{"damper": {"coordinate": "x", "coefficient": "b"}}, {"rayleigh": "c*x_dot**4"}], NOT_GROWING),
        ([{"damper": {"coordinate": "x", "coefficient": "n"}}, {"rayleigh": "c*x_dot**4"}], UNKNOWN),
        ([{"generalized force": {"x": "-b*x_dot", "y": "-y_dot**3"}}], NOT_GROWING),
        ([{"generalized force": {"x": "W*y_dot", "y": "-W*x_dot"}}], CONSERVED),
        ([{"generalized force": {"x": "W*y", "y": "-W*x"}}], UNKNOWN),
        ([{"generalized force": {"x": "x_dot**3"}}], GROWS),
        ([{"force": {"body": "p", "point": [0, 0, 0], "components": ["c", 0, 0], "axes": 0}}], CONSERVED),
        ([{"force": {"body": "p", "point": [0, 0, 0], "components": ["c*y", 0, 0], "axes": 0}}], UNKNOWN),
        ([{"force": {"body": "p", "point": [0, 0, 0], "components": [0, 0, 0], "axes": 0}}], CONSERVED),
        ([{"potential": "c*x**4*cos(t)"}], UNKNOWN),
    ],
)
def test_the_law_of_the_energy_under_other_loads(loads: list[Any], law: EnergyLaw) -> None:
    assert point(*loads).balance.law is law


TERMS = ["x_dot**2", "y_dot**2", "x_dot*y_dot", "x_dot**4", "x_dot**3", "(x_dot - 2*y_dot)**2", "(x_dot + y_dot)**4"]
TERMS += ["x*x_dot**2", "x**2*y_dot**2", "(1 + x)*y_dot**2", "x_dot**2*y_dot**2", "(x_dot + y)**2", "y*x_dot*y_dot"]


@settings(max_examples=60, derandomize=True)
@given(st.lists(st.tuples(st.integers(-2, 3), st.sampled_from(TERMS)), min_size=1, max_size=4))
def test_what_is_proved_of_the_power_holds_near_the_motion(terms: list[tuple[int, str]]) -> None:
    text = " + ".join(f"{number}*{term}" for number, term in terms)
    law = point({"rayleigh": text}).balance.law
    symbols = sympy.symbols("x y x_dot y_dot")
    _, _, u, v = symbols
    function = sympy.sympify(text, locals=dict(zip(("x", "y", "x_dot", "y_dot"), symbols, strict=True)))
    power = sympy.lambdify(symbols, -u * function.diff(u) - v * function.diff(v), "numpy")
    scales = np.random.default_rng(1).normal(size=(400, 4)) * 10.0 ** np.random.default_rng(2).uniform(-4, -2, (400, 4))
    values = np.array([power(*row) for row in scales])
    if law is CONSERVED:
        assert np.all(values == 0)
    elif law is NOT_GROWING:
        assert np.all(values <= 1e-30)
    elif law is GROWS:
        assert np.all(values >= -1e-30)
        assert np.any(values > 0)


# --- verdicts ---


def words(analysis: Analysis) -> set[str]:
    stability = analysis.stability
    return {str(v.word) for v in (stability.verdict, stability.numerical) if v is not None}


@pytest.mark.parametrize(
    ("force", "law"),
    [
        # Q(q, 0) = -d(x^4 - x^2 y^2 + y^4)/dq joins the energy; the rest is friction
        ({"x": "2*x*y**2 - 4*x**3 - b*x_dot", "y": "2*x**2*y - 4*y**3 - y_dot*x_dot**2"}, NOT_GROWING),
        ({"x": "-b*x - W*x**3 - b*x_dot*abs(x_dot)"}, NOT_GROWING),
        ({"x": "-b*x + y_dot", "y": "c*y**3 - x_dot"}, CONSERVED),  # a potential and gyroscopic forces in one
        ({"x": "-b*x + x_dot**3"}, GROWS),
        ({"x": "y - x_dot**3", "y": "-x - y_dot**3"}, UNKNOWN),  # Q(q, 0) turns round: no potential
        ({"x": "-x*sin(t) - b*x_dot"}, UNKNOWN),
    ],
    ids=str,
)
def test_what_a_force_holds_at_rest_joins_the_energy(force: dict[str, str], law: EnergyLaw) -> None:
    assert point({"generalized force": force}, spring=False).balance.law is law


@pytest.mark.parametrize("name", ["s_ray_subcrit_border", "s_ray_quartic_neg", "s_rotdamp_cubic", "s_coast_neg"])
def test_energy_that_may_grow_makes_nothing_stable(name: str) -> None:
    analysis = mbsym.load(CASES / f"{name}.yaml")
    assert not {word for word in words(analysis) if word.startswith(("stable;", "asymptotically"))}
    assert "stable" not in words(analysis)


def test_the_same_functions_with_the_other_sign_make_it_asymptotically_stable() -> None:
    """x'' + x = b x'^3: b > 0 grows; b < 0 dissipates, E' = b x'^4, and nothing but rest keeps x' = 0."""
    case = CASES / "s_ray_subcrit_border.yaml"
    there = Analysis(mbsym.loads(case.read_text().replace("b: positive", "b: real")).system)
    assert there.balance.law is UNKNOWN
    loaded = mbsym.loads(case.read_text().replace("b: positive", "b: real").replace("b: 1", "b: -1"))
    assert loaded.stability.numerical is not None
    assert (str(loaded.stability.numerical.word), loaded.stability.numerical.theorem) == (
        "asymptotically stable",
        "Barbashin-Krasovskii",
    )
    assert str(at_values(case, a=1).stability.numerical.word) == "asymptotically stable"


@pytest.mark.parametrize(
    ("force", "grows"),
    [
        (lambda x, v: np.array([v[0] ** 3, 0 * v[0]]), True),  # s_ray_quartic_neg, s_ray_subcrit_border
        (lambda x, v: -rotating(x, v, 2.0), True),  # s_rotdamp_cubic, W = 2
        (lambda x, v: np.array([-(v[0] ** 3), 0 * v[0]]), False),
    ],
)
def test_trajectories_of_the_cases(force: Any, grows: bool) -> None:
    """The truth of the cases above, integrated from the equations as they are written there."""

    def rate(t: float, s: Any) -> Any:
        x, v = s[:2], s[2:]
        return [*v, *(force(x, v) - x)]

    run = solve_ivp(rate, (0, 40), [0.1, 0, 0, 0.1], rtol=1e-9, atol=1e-12)
    energies = np.sum(run.y**2, axis=0) / 2
    assert (energies[-1] > 1.005 * energies[0]) is np.True_ if grows else energies[-1] <= energies[0]


def rotating(x: Any, v: Any, w: float) -> Any:
    """The gradient of ((x' + W y)^2 + (y' - W x)^2)^2/4 in the velocities."""
    relative = np.array([v[0] + w * x[1], v[1] - w * x[0]])
    return np.dot(relative, relative) * relative


def test_a_free_coordinate_that_a_force_of_higher_order_drives_does_not_coast() -> None:
    """x'' = x'^3 runs away; x'' = -x'^3 and x'' = 0 do not."""
    for load in ({"rayleigh": "-x_dot**4/4"}, {"generalized force": {"x": "x_dot**3"}}):
        analysis = point(load, spring=False)
        assert analysis.balance.driven == ("x",)
        assert "undecided" in words(analysis)
    free = point(spring=False)
    assert free.balance.ignorable == ("x", "y")
    assert free.balance.driven == ()
    assert all(word.startswith("stable but for a drift") for word in words(free))


def test_a_force_that_holds_a_cyclic_coordinate_takes_it_off_the_cyclic_ones() -> None:
    """x'' = -x^3: L does not contain x, but the force does.  x'^2/2 + x^4/4 keeps x near 0; x'' = x^3 runs away."""
    for force, at_numbers in (("-x**3", "stable but for a drift of cyclic coordinates"), ("x**3", "unstable")):
        analysis = point({"generalized force": {"x": force}}, spring=False)
        assert analysis.energy.cyclic == ("x", "y")
        assert analysis.balance.ignorable == ("y",)
        assert str(analysis.stability.verdict.word) == "undecided"
        assert analysis.stability.numerical is not None
        assert str(analysis.stability.numerical.word) == at_numbers


def test_numbers_decide_what_letters_leave_open() -> None:
    values = {"b": 1, "n": 1, "e": -1, "W": 1}
    for c, law in ((2, NOT_GROWING), (-2, GROWS), (0, CONSERVED)):
        analysis = point({"rayleigh": "c*x_dot**4"}, values=values | {"c": c})
        assert analysis.balance.law is UNKNOWN
        found = analysis.stability.numerical
        assert found is not None
        assert (str(found.word) == "stable") is (law is not GROWS)


# --- motions that run by themselves ---

SHAFT = {
    "mbsym": 1,
    "name": "shaft",
    "parameters": {"C": "positive", "m": "positive", "k": "positive", "b": "positive", "W": "real"},
    "bodies": [
        {"name": "shaft", "attached to": 0, "rotation": {"axes": [3], "angles": ["psi"]}, "mass": 0}
        | {"inertia about": "joint", "inertia": [0, 0, "C"]},
        {"name": "bead", "attached to": "shaft", "connection point": [0, 0, "z"], "mass": "m", "coordinates": ["z"]},
    ],
    "motion": {"psi": {"value": 0, "rate": "W"}, "z": 0},
}
SPRING = {"spring": {"coordinate": "z", "stiffness": "k"}}


@pytest.mark.parametrize(
    ("load", "law"),
    [
        ({"rayleigh": "b*z_dot**4"}, NOT_GROWING),
        ({"rayleigh": "b*(psi_dot - W)**4"}, UNKNOWN),  # the momentum of the shaft is not constant
        ({"damper": {"coordinate": "psi", "coefficient": "b"}}, UNKNOWN),
        ({"potential": "b*z**4*(2 + cos(psi))"}, UNKNOWN),  # the spin is felt as a time
        ({"damper": {"between": [{"body": "shaft"}, {"body": "bead"}], "coefficient": "b"}}, NOT_GROWING),
        ({"damper": {"between": [{"body": 0, "point": [1, 0, 0]}, {"body": "bead", "point": [1, 0, 0]}]}}, UNKNOWN),
    ],
)
def test_a_steady_spin_must_not_be_felt(load: dict[str, Any], law: EnergyLaw) -> None:
    load = json.loads(json.dumps(load))
    if "damper" in load and "between" in load["damper"]:
        load["damper"].setdefault("coefficient", "b")
        for end in load["damper"]["between"]:
            end.setdefault("point", [0, 0, 1] if end["body"] == "shaft" else [0, 0, 0])
    assert mbsym.loads(json.dumps(SHAFT | {"loads": [SPRING, load]})).balance.law is law


def test_a_dashpot_to_a_moved_point_takes_power_from_the_drive() -> None:
    """In axes that turn by a prescribed angle a dashpot to the ground is circulatory; along the axis it is not."""
    table = {"name": "table", "attached to": 0, "rotation": {"axes": [3], "angles": ["chi"]}, "mass": 0}
    body = {"name": "p", "attached to": "table", "connection point": ["x", 0, "z"], "mass": 1}
    for ends, law in itertools.product(((0, "p"), ("table", "p")), (None,)):
        damper = {"between": [{"body": end, "point": [1, 0, 2]} for end in ends], "coefficient": "b"}
        description = {
            "mbsym": 1,
            "name": "turntable",
            "parameters": {"b": "positive", "w": "real"},
            "prescribed": {"chi": "w"},
            "bodies": [table, body | {"coordinates": ["x", "z"]}],
            "loads": [{"damper": damper}],
            "motion": {"x": 0, "z": 0},
        }
        law = mbsym.loads(json.dumps(description)).balance.law
        assert law is (UNKNOWN if 0 in ends else NOT_GROWING)


DRAG = "-x_dot*sqrt(x_dot**2 + y_dot**2)"


@pytest.mark.parametrize(
    ("force", "law", "word"),
    [
        ({"x": "-n*x_dot*abs(x_dot)"}, NOT_GROWING, "stable"),
        ({"x": DRAG, "y": DRAG.replace("-x_dot*", "-y_dot*")}, NOT_GROWING, "stable"),
        ({"x": "b*x_dot*abs(x_dot)"}, GROWS, "stable in first approximation only"),
        ({"x": "-c*x_dot*abs(x_dot)"}, UNKNOWN, "stable in first approximation only"),
        ({"x": "-b*x_dot - b*x_dot*abs(x_dot)", "y": "-b*y_dot"}, NOT_GROWING, "asymptotically stable"),
        ({"x": "b*x_dot - b*x_dot*abs(x_dot)"}, UNKNOWN, "unstable"),
    ],
)
def test_drag_that_grows_with_the_square_of_the_speed(force: dict[str, str], law: EnergyLaw, word: str) -> None:
    """u |u| is of second order, so that the first approximation does not feel it."""
    found = point({"generalized force": force})
    assert found.balance.law is law
    assert found.stability.verdict.word.value == word


@pytest.mark.parametrize("force", ["-b*abs(x_dot)", "-b*abs(x)", "b*abs(x_dot) - b*abs(x)", "sqrt(x**2 + x*y + y**2)"])
def test_a_force_with_a_kink_has_no_first_approximation(force: str) -> None:
    with pytest.raises(Unavailable, match="kink"):
        point({"generalized force": {"x": force}}).stability  # noqa: B018
    with pytest.raises(Unavailable, match="kink"):
        point({"generalized force": {"x": force}}, constraints=[{"velocity": "x_dot = 2*y_dot"}]).linearisation  # noqa: B018


@pytest.mark.parametrize(
    ("row", "law"),
    [
        ("x_dot = y", UNKNOWN),  # the force that keeps it has the power lambda y
        ("x_dot = y_dot", NOT_GROWING),
        ("x_dot = y_dot + W", NOT_GROWING),  # of deviations
    ],
)
def test_what_ties_a_velocity_to_a_place_does_work(row: str, law: EnergyLaw) -> None:
    """m y'' + b y' + 2 y = 0 beside x' = y, whose constraint force is x'' + x: d/dt (T + V) = -b y'^2 + (y' + x) y."""
    moved = {"motion": {"x": {"rate": "W"}, "y": 0}} if "W" in row else {}
    loads = [{"generalized force": {"y": "-b*y_dot"}}]
    found = point(*loads, spring="W" not in row, constraints=[{"velocity": row}], **moved)
    assert found.balance.law is law
    assert "Lagrange" not in " ".join(map(str, found.stability.verdict.theorems)) or law is NOT_GROWING
