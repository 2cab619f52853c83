"""Claims about constrained systems and about matrices in speeds: right ones hold, a wrong one of each kind is refuted.

By hand.  Pendulum at x^2 + y^2 = L^2: M q'' = f + J^T lambda with lambda eliminated is y x'' - x y'' = g x, and
x x'' + y y'' + x'^2 + y'^2 = 0 is the constraint alone; about (0, -L) x'' + g x/L = 0.  Sleigh (Neimark & Fufaev,
ch. II): with x' sin = y' cos the velocity of the mass centre has the square x'^2 + y'^2 + a^2 theta'^2, and
(J + m a^2) theta'' + m a theta' (x' cos + y' sin) = 0.  Disc (ch. III): upright, stable for w^2 > g/(3 r).
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import mbsym
from mbsym.problems.claims import ClaimResult, Outcome

ROOT = Path(__file__).parents[2]
SHIPPED = ROOT / "systems"


def judged(name: str, *claims: str) -> list[ClaimResult]:
    text = (SHIPPED / f"{name}.yaml").read_text(encoding="utf-8").partition("\nclaims:")[0]
    lines = "".join(f"  - {{claim: {one}}}\n" for one in claims)
    analysis = mbsym.loads(f"{text}\nclaims:\n{lines}")
    found = list(analysis.claims)
    assert not analysis.defects
    return found


def refuted(results: list[ClaimResult]) -> list[bool]:
    return [result.refuted for result in results]


def test_quantities_hold_in_general_or_on_the_constraints() -> None:
    results = judged(
        "cartesian-pendulum",
        "kinetic energy, equals: m*(x_dot**2 + y_dot**2)/2",
        "kinetic energy, equals: m*y_dot**2*(1 + y**2/x**2)/2",  # x x' = -y y'
        "potential energy, equals: m*g*y*(x**2 + y**2)/L**2",  # the length is kept
        "position, of: particle, component: 2, equals: y",
        "mass matrix, entry: [x, x], equals: m",
    )
    assert [result.outcome for result in results] == [
        Outcome.EXACT,
        Outcome.EXACT,
        Outcome.NUMERICAL,
        Outcome.EXACT,
        Outcome.EXACT,
    ]
    assert [bool(result.remark) for result in results] == [False, True, True, False, False]
    wrong = judged(
        "cartesian-pendulum",
        "kinetic energy, equals: m*(x_dot**2 + 2*y_dot**2)/2",
        "kinetic energy, equals: m*y_dot**2*(1 + x**2/y**2)/2",
        "potential energy, equals: m*g*y*(x**2 - y**2)/L**2",
        "position, of: particle, component: 2, equals: x",
        "mass matrix, entry: [x, x], equals: m + 1",
    )
    assert all(refuted(wrong))


def test_equations_vanish_along_every_motion() -> None:
    equation = "equation of motion, of: x, equals:"
    right, signs, alone, wrong_alone, nothing = judged(
        "cartesian-pendulum",
        f"{equation} x_ddot*y - y_ddot*x - g*x",
        f"{equation} x_ddot*y - y_ddot*x + g*x",
        f"{equation} x_ddot*x + y_ddot*y + x_dot**2 + y_dot**2",
        f"{equation} x_ddot*x + y_ddot*y - x_dot**2 + y_dot**2",
        f"{equation} x - x",
    )
    assert (right.outcome, alone.outcome) == (
        Outcome.EXACT,
        Outcome.EXACT,
    )  # linear in accelerations: proved in the ring
    assert "constraints alone" in alone.remark
    assert not right.remark.startswith("it follows")
    assert [signs.outcome, wrong_alone.outcome, nothing.outcome] == [
        Outcome.FAILS,
        Outcome.FAILS,
        Outcome.UNDECIDED,
    ]
    assert signs.counterexample is not None
    yaw, other = judged(
        "chaplygin-sleigh",
        "equation of motion, of: theta, equals: (J + m*a**2)*theta_ddot + m*a*theta_dot*(x_dot*cos(theta)"
        " + y_dot*sin(theta))",
        "equation of motion, of: theta, equals: (J + m*a**2)*theta_ddot - m*a*theta_dot*(x_dot*cos(theta)"
        " + y_dot*sin(theta))",
    )
    assert (yaw.outcome, other.outcome) == (Outcome.EXACT, Outcome.FAILS)


def test_integrals_are_kept_with_the_constraint_forces() -> None:
    energy, wrong, tied = judged(
        "chaplygin-sleigh",
        "first integral, equals: m*(x_dot**2 + y_dot**2) + (J + m*a**2)*theta_dot**2",
        "first integral, equals: m*(x_dot**2 + y_dot**2) + J*theta_dot**2",
        "first integral, equals: x_dot*sin(theta) - y_dot*cos(theta)",
    )
    assert [energy.outcome, wrong.outcome, tied.outcome] == [Outcome.EXACT, Outcome.FAILS, Outcome.FAILS]
    assert wrong.counterexample is not None
    assert "contains none" in tied.remark
    # A momentum that the open tree keeps, and the constrained body does not.
    (momentum,) = judged("chaplygin-sleigh", "first integral, equals: m*x_dot - m*a*sin(theta)*theta_dot")
    assert momentum.refuted


def test_the_first_approximation_has_rows_of_independent_coordinates() -> None:
    results = judged(
        "cartesian-pendulum",
        "linear matrix M, entry: [x, x], equals: m",
        "linear matrix K, entry: [x, x], equals: m*g/L",
        "characteristic polynomial, variable: s, equals: s**2 + g/L",
        "linear matrix K, entry: [x, x], equals: 2*m*g/L",
        "characteristic polynomial, variable: s, equals: s**2 - g/L",
        "linear matrix K, entry: [y, y], equals: m*g/L",
    )
    assert [result.holds for result in results] == [True, True, True, False, False, False]
    assert refuted(results) == [False, False, False, True, True, False]
    assert "not among the coordinates" in results[-1].remark


def test_conditions_are_those_of_problem_6_or_refuted_at_exact_parameters() -> None:
    results = judged(
        "rolling-disc",
        "condition, that: w**2 > g/(3*r)",
        "condition, as: necessary, that: w**2 > g/(4*r)",
        "condition, as: sufficient, that: w**2 > g/(4*r)",
        "condition, as: sufficient, that: g > 0",
        "condition, as: sufficient, that: w**2 > g/r",
    )
    # Without w^2 > g/(4 r), with equality even, w^2 < g/(3 r): the disc falls.
    assert [result.outcome for result in results] == [
        Outcome.EXACT,
        Outcome.EXACT,
        Outcome.FAILS,
        Outcome.FAILS,
        Outcome.EXACT,
    ]
    assert results[2].counterexample is not None
    assert ("the motion", "unstable (Lyapunov's first method)") in results[2].counterexample.shows
    (necessary,) = judged("cartesian-pendulum", "condition, as: necessary, that: g > L")
    assert necessary.refuted


def test_numbers_of_the_four_bar_are_those_published() -> None:
    published = json.loads((ROOT / "tests" / "references" / "sympy_four_bar.json").read_text(encoding="utf-8"))
    names = [*(f"q{k}" for k in (1, 2, 3)), *(f"q{k}_dot" for k in (1, 2, 3))]
    values = [*published["parameters"]["q"], *published["parameters"]["u"]]
    state = ", ".join(f"{name}: {value}" for name, value in zip(names, values, strict=True))
    accelerations = published["reference"]["accelerations"]
    claims = [
        f"value, of: q{k}_ddot, state: {{{state}}}, equals: {x}, digits: 11" for k, x in enumerate(accelerations, 1)
    ]
    off = f"value, of: q1_ddot, state: {{{state}}}, equals: 0.0048759"
    beside = f"value, of: q1_ddot, state: {{{state.replace('q1: 2.1', 'q1: 2.2')}}}, equals: 0.0048758"
    *right, wrong, inconsistent = judged("four-bar", *claims, off, beside)
    assert all(result.holds for result in right)
    assert wrong.refuted
    assert inconsistent.outcome == Outcome.UNDECIDED
    assert "does not keep" in inconsistent.remark
    (rough,) = judged("four-bar", f"value, of: q1_ddot, state: {{{state}}}, equals: 0.0048758")
    assert rough.outcome == Outcome.DIGITS


def test_matrices_in_speeds_are_those_in_coordinates() -> None:
    """Euler's equations about a permanent rotation: gravity-gradient satellite, Hughes (1986), section 9.2."""
    results = judged(
        "gravity-gradient-quaternion",
        "linear matrix K, entry: [theta, theta], equals: 3*omega0**2*(A - B)",
        "linear matrix K, entry: [theta, theta], equals: 3*omega0**2*(B - A)",
        "linear matrix K, entry: [p, p], equals: 3*omega0**2*(A - B)",
        "characteristic polynomial, of: theta, variable: s, equals: s**2*C + 3*omega0**2*(A - B)",
        "characteristic polynomial, of: theta, variable: s, equals: s**2*C - 3*omega0**2*(A - B)",
    )
    assert [result.holds for result in results] == [True, False, False, True, False]
    assert refuted(results) == [False, True, False, False, True]


def test_a_planted_sign_in_the_constraint_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without gamma in the accelerations a right number is no longer confirmed."""
    from mbsym.mechanics.constraints import programs

    columns = programs.columns
    monkeypatch.setattr(
        programs, "columns", lambda rows: (*(found := columns(rows))[:3], tuple(-x for x in found[3]), found[4])
    )
    state = "x: 0.6, y: -0.8, x_dot: 0.8, y_dot: 0.6, L: 1, m: 1, g: 10"
    (result,) = judged("cartesian-pendulum", f"value, of: x_ddot, state: {{{state}}}, equals: -5.4")
    assert not result.holds


def test_a_number_of_the_pendulum_by_hand() -> None:
    """x'' = lambda x, y'' = lambda y - g with lambda = (g y - v^2)/L^2 = -9: x'' = -5.4."""
    state = "x: 0.6, y: -0.8, x_dot: 0.8, y_dot: 0.6, L: 1, m: 1, g: 10"
    (result,) = judged("cartesian-pendulum", f"value, of: x_ddot, state: {{{state}}}, equals: -5.4")
    assert result.outcome == Outcome.DIGITS


WHEEL = """mbsym: 1
name: a wheel on a line
parameters: {r: positive, J: positive}
bodies:
  - {name: w, attached to: 0, connection point: [x, r, 0], rotation: {axes: [3], angles: [f]}, coordinates: [x, f],
     mass: 1, inertia about: mass centre, inertia: [J, J, J]}
constraints:
  - velocity: x_dot + r*f_dot = 0
claims:
  - {claim: first integral, equals: x + r*f}
  - {claim: first integral, equals: x + 2*r*f}
"""

LIGHT = """mbsym: 1
name: two sledges without mass, each on a damper, joined by a spring
parameters: {c: positive, k: positive}
bodies:
  - {name: p, attached to: 0, mass: 0, connection point: [x, 0, 0], coordinates: [x]}
  - {name: q, attached to: 0, mass: 0, connection point: [y, 0, 0], coordinates: [y]}
loads:
  - damper: {coordinate: x, coefficient: c}
  - damper: {coordinate: y, coefficient: c}
  - potential: k*(x - y)**2/2
claims:
  - {claim: first integral, equals: x + y}
"""


def test_integrals_without_velocities() -> None:
    """x + r f of a wheel that rolls on a line, and x + y of c x' = -k (x - y), c y' = k (x - y), are constant."""
    assert [one.outcome for one in mbsym.loads(WHEEL).claims] == [Outcome.EXACT, Outcome.FAILS]
    assert [one.outcome for one in mbsym.loads(LIGHT).claims] == [Outcome.UNDECIDED]
