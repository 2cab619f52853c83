"""Nonholonomic systems whose velocities follow one position along every motion: rolling bodies of revolution.

Truth: a disc rolls straight on stably if and only if 3 r w^2 > g, but for the border (Neimark & Fufaev, Dynamics of
Nonholonomic Systems, chapter V; a thin uniform disc).  By another route: w = w(q) along a motion means that lean comes
back to a value with the opposite rate and with all other velocities as they were.
"""

from __future__ import annotations

import numpy as np
import pytest
from conftest import SHIPPED
from scipy.integrate import solve_ivp
from sympy import Matrix, Symbol, lambdify

import mbsym
from mbsym.problems.constraints.motion import oscillating_position
from mbsym.problems.stability.words import CHAPLYGIN, Because, Word

DISC = (SHIPPED / "rolling-disc.yaml").read_text(encoding="utf-8")


def _disc(load: str = "", values: str = "w: 5") -> str:
    assert "w: 5" in DISC
    return DISC.replace("loads:", f"loads:\n{load}" if load else "loads:").replace("w: 5", values)


@pytest.mark.parametrize(
    ("spin", "word"),
    [(5, Word.STABLE_BUT_CYCLIC), (-5, Word.STABLE_BUT_CYCLIC), (3, Word.UNSTABLE)],  # g/(3 r) = 3.55^2
)
def test_a_disc_that_rolls_straight_on(spin: int, word: Word) -> None:
    system = mbsym.loads(_disc(values=f"w: {spin}"))
    verdict = system.stability.numerical
    assert verdict.word is word
    assert (verdict.theorems == (CHAPLYGIN,)) is (word is Word.STABLE_BUT_CYCLIC)


def test_on_the_border_nothing_is_said() -> None:
    verdict = mbsym.loads(
        _disc(values="w: 1").replace("g: 9.81", "g: 3").replace("r: 0.26", "r: 1")
    ).stability.numerical
    assert verdict.word is Word.UNDECIDED


@pytest.mark.parametrize("name", ["rolling-disc", "rolling-disc-speeds", "rolling-disc-in-a-circle"])
def test_the_motion_does_not_know_our_coordinates(name: str) -> None:
    system = mbsym.load(SHIPPED / f"{name}.yaml")
    verdict = system.stability.numerical
    assert verdict.word is Word.STABLE_BUT_CYCLIC
    assert verdict.because(Because.FOLLOWS_ONE)


BREAKING = [
    "  - damper: {coordinate: lean, coefficient: 1/100}",
    "  - generalized force: {yaw: 100*lean_dot**3}",
    "  - damper: {coordinate: spin, coefficient: 1/100}",
    "  - generalized force: {lean: sin(yaw)/100}",
    "  - generalized force: {spin: lean/100}",
    "  - generalized force: {lean: abs(lean_dot)}",
]


@pytest.mark.parametrize("load", BREAKING)
def test_what_breaks_the_reversal_is_not_claimed(load: str) -> None:
    analysis = mbsym.loads(_disc(load))
    embedded = analysis.equations.embedded
    assert embedded is not None
    assert oscillating_position(analysis.ring, embedded, analysis.system.coordinates) == ""


def test_a_force_that_keeps_the_reversal_leaves_the_disc_stable() -> None:
    """A torque lean' spin'/100 about the vertical is q' A(q, w); gyroscopic, as of a rotor in the disc."""
    verdict = mbsym.loads(_disc("  - generalized force: {yaw: lean_dot*spin_dot/100}")).stability.numerical
    assert verdict.theorems == (CHAPLYGIN,)


#: y'' + y = (a force) beside x and z, z' = y x'.
BESIDE = """mbsym: 1
name: beside
prescribed: {chi: {rate: 3}}
bodies:
  - {name: p, attached to: 0, connection point: [x, y, z], mass: 1, coordinates: [x, y, z]}
loads:
  - potential: y**2/2
  - generalized force: {y: FORCE}
constraints:
  - velocity: z_dot = y*x_dot
motion: {x: {value: 0, rate: 1}}
"""


@pytest.mark.parametrize("force", ["y**2*sin(3*t)", "y**2*sin(chi)"])
def test_a_position_that_knows_the_time_is_no_centre(force: str) -> None:
    """y'' + y = y^2 sin(3 t) is a resonance of third order: by numbers, of any size, disturbances grow."""
    verdict = mbsym.loads(BESIDE.replace("FORCE", force)).stability.numerical
    assert verdict.word is Word.CRITICAL

    def far(_t: float, state: np.ndarray) -> float:
        return float(abs(state[0]) - 0.6)

    far.terminal = True  # type: ignore[attr-defined]
    for small in (0.1, 0.05):
        start = [small * np.cos(1), small * np.sin(1)]
        run = solve_ivp(lambda t, s: [s[1], -s[0] + s[0] ** 2 * np.sin(3 * t)], (0, 300), start, events=far, rtol=1e-9)
        assert run.t_events[0].size


@pytest.mark.parametrize("force", ["y_dot**2", "1 - exp(y_dot**2)", "y**2*y_dot**2 - y**3"])
def test_an_even_force_leaves_a_centre(force: str) -> None:
    assert mbsym.loads(BESIDE.replace("FORCE", force)).stability.numerical.theorems == (CHAPLYGIN,)


@pytest.mark.parametrize("force", ["y_dot**3", "sqrt(1 + y_dot**3) - 1", "exp(y_dot**3) - 1", "sin(y_dot)**3"])
def test_an_odd_force_leaves_none(force: str) -> None:
    """Here the energy grows by y'^4, or so."""
    verdict = mbsym.loads(BESIDE.replace("FORCE", force)).stability.numerical
    assert verdict.word is Word.CRITICAL


def test_a_position_that_moves_on_is_no_centre() -> None:
    """q' = v, v' = w1, w1' = v w2, w2' = -v w1 + v w1^2 sin(3 q): the imaginary roots are of w, in resonance with q."""
    text = """mbsym: 1
name: moving
bodies:
  - {name: p, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
  - {name: q, attached to: 0, connection point: [0, 0, q], mass: 1, coordinates: [q]}
  - {name: s, attached to: 0, connection point: [0, 0, s], mass: 0, coordinates: [s]}
loads:
  - generalized force: {q: x_dot, x: q_dot*y_dot, y: -q_dot*x_dot + q_dot*x_dot**2*sin(3*q)}
constraints:
  - velocity: s_dot = x_dot*sin(q)
motion: {q: {value: 0, rate: 1}}
"""
    assert mbsym.loads(text).stability.numerical.word is Word.CRITICAL

    def far(_t: float, state: np.ndarray) -> float:
        return float(np.hypot(*state[2:]) - 0.5)

    far.terminal = True  # type: ignore[attr-defined]
    for small in (0.05, 0.02):
        start = [0, 1, small * np.cos(1), small * np.sin(1)]
        run = solve_ivp(
            lambda _t, s: [s[1], s[2], s[1] * s[3], -s[1] * s[2] + s[1] * s[2] ** 2 * np.sin(3 * s[0])],
            (0, 500), start, events=far, rtol=1e-9, atol=1e-12,
        )  # fmt: skip
        assert run.t_events[0].size


@pytest.mark.parametrize(("load", "returns"), [("", True), (BREAKING[0], False), (BREAKING[1], False)])
def test_velocities_are_functions_of_the_lean_along_a_motion(load: str, returns: bool) -> None:
    analysis = mbsym.loads(_disc(load))
    embedded = analysis.equations.embedded
    assert embedded is not None
    matrix, forcing = embedded.mass_matrix.to_sympy(), Matrix([x.to_sympy() for x in embedded.forcing])
    by_name = {x.name: x for x in matrix.free_symbols | forcing.free_symbols}
    numbers = {by_name[name]: x for name, x in {"m": 3.43, "r": 0.26, "g": 9.81}.items()}
    state = [by_name.get(name, Symbol(name)) for name in ("lean", "yaw_dot", "lean_dot", "spin_dot")]
    rates = lambdify(state, [matrix.subs(numbers), forcing.subs(numbers)], "numpy")

    def flow(_t: float, state: np.ndarray) -> np.ndarray:
        mass, force = rates(*state)
        return np.concatenate([state[2:3], np.linalg.solve(mass, np.ravel(force))])

    start = np.array([0.1, 0.3, 0.2, 5.0])

    def back(_t: float, state: np.ndarray) -> float:
        return float(state[0] - start[0])

    back.direction = -1  # type: ignore[attr-defined]
    back.terminal = True  # type: ignore[attr-defined]
    run = solve_ivp(flow, (0, 5), start, events=back, rtol=1e-11, atol=1e-12)
    end = run.y_events[0][0]
    mirrored = start * [1, 1, -1, 1]
    assert bool(np.abs(end - mirrored).max() < 1e-8) == returns


def test_of_velocities_beside_no_oscillation_is_told() -> None:
    """A skate runs straight on: x'' = -x' a' tan a, and a, which x' follows, turns away."""
    text = """mbsym: 1
name: skate
bodies:
  - {name: p, rotation: {axes: [3], angles: [a]}, connection point: [x, y, 0], coordinates: [x, y, a], mass: 1,
     inertia about: mass centre, inertia: [1, 1, 1]}
constraints: [velocity: x_dot*sin(a) = y_dot*cos(a)]
motion: {x: {value: 0, rate: 1}}
"""
    analysis = mbsym.loads(text)
    verdicts = [part.theory.verdict for part in analysis.stability.subsystems]
    assert verdicts[0].because(Because.FOLLOWING)
    assert not any(verdict.because(Because.FOLLOWS_ONE) for verdict in verdicts)
    assert analysis.stability.numerical.word is Word.UNDECIDED
