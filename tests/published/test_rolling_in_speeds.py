"""Speeds together with constraints: Kane's equations of rolling discs, spheres and of a top that is tied to a point."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED, analysed, derived, text_of
from flint import arb

import mbsym
from mbsym.analysis import Unavailable
from mbsym.analysis.pipeline import Analysis
from mbsym.analysis.soundness import complain_of_constraints
from mbsym.expressions.place import Complaints
from mbsym.formulas.formula import Formula
from mbsym.mechanics.constraints import speed_rows
from mbsym.mechanics.rest import given_values
from mbsym.problems.checks import EXACT, FAILED, NUMERICAL
from mbsym.problems.constraints import analysis
from mbsym.source import read

REFERENCES = Path(__file__).parents[1] / "references"


def shipped(name: str) -> Analysis:
    return derived(SHIPPED / f"{name}.yaml")


class AtState:
    """Rates of positions and speeds in double precision, at numbers for positions and independent speeds."""

    def __init__(self, analysis: Analysis, state: Mapping[str, float]) -> None:
        self.analysis = analysis
        self.equations = analysis.equations
        self.tied = self.equations.constraints
        assert self.tied is not None
        self.solved = self.tied.solved
        given = {key: float(value) for key, value in given_values(analysis.system, {}).items()}
        self.values: dict[str, float] = {**dict.fromkeys(analysis.ring.names(), 0.0), **given, **state}
        free = [self.values[key] for key in self.tied.free]
        speeds = self.matrix(self.solved.transformation) @ free + self.column(self.solved.shift)
        self.values |= dict(zip(self.tied.coordinates, speeds, strict=True))

    def __call__(self, formula: Formula) -> float:
        numbers = {key: arb(value) for key, value in self.values.items()}
        return float(self.analysis.ring.evaluate(formula.polynomial, numbers).mid())

    def matrix(self, rows: Any) -> Any:
        return np.array([[self(x) for x in row] for row in rows])

    def column(self, items: Any) -> Any:
        return np.array([self(x) for x in items])

    @property
    def positions(self) -> dict[str, float]:
        return dict(zip(self.equations.positions, self.column(self.equations.rates), strict=True))

    @property
    def speeds(self) -> dict[str, float]:
        embedded = self.equations.embedded
        rates = np.linalg.solve(self.matrix(embedded.mass_matrix), self.column(embedded.forcing))
        whole = self.matrix(self.solved.transformation) @ rates + self.column(self.solved.acceleration_shift)
        return dict(zip(self.tied.coordinates, whole, strict=True))


@pytest.mark.parametrize("case", ["case1", "case2"])
def test_the_disc_has_all_ten_published_rates(case: str) -> None:
    """qd1..qd5 (yaw, lean, spin and the contact), ud1..ud3, and the accelerations of the contact, ud4 and ud5."""
    published = json.loads((REFERENCES / "sympy_rolling_disc.json").read_text(encoding="utf-8"))
    given, wanted = published["parameters"][case], [float(x) for x in published["reference"][case]]
    state = dict(zip(("yaw", "lean", "spin", "x", "y"), map(float, given["q"]), strict=True))
    state |= dict(zip(("u1", "u2", "u3"), map(float, given["u"]), strict=True))
    at = AtState(shipped("rolling-disc-speeds"), state | {key: float(given[key]) for key in "mrg"})
    assert at.tied.dependent == ("x_dot", "y_dot")
    found = [at.positions[key] for key in ("yaw", "lean", "spin", "x", "y")]
    found += [at.speeds[key] for key in ("u1", "u2", "u3", "x_dot", "y_dot")]
    assert found == pytest.approx(wanted, abs=1e-12)


def test_problems_4_to_6_of_the_disc_are_those_in_coordinates() -> None:
    """3 r w^2 > g of the upright disc (Neimark & Fufaev), whatever the speeds are."""
    found, plain = shipped("rolling-disc-speeds"), mbsym.load(SHIPPED / "rolling-disc.yaml", (4, 5, 6))
    conditions = [(str(x), relation) for part in found.stability.subsystems for _, x, relation in part.conditions]
    assert conditions == [("3*r*w**2 - g", ">")]
    assert [str(x) for x in found.linearisation.matrices] == [str(x) for x in plain.linearisation.matrices]


FRAME = "speeds: {p: lean_dot, q: spin_dot + yaw_dot*sin(lean), s: yaw_dot*cos(lean)}"


def in_a_circle() -> Analysis:
    inertia = "    inertia: [m*r**2/4, m*r**2/2, m*r**2/4]\n"
    return analysed(text_of("rolling-disc-in-a-circle", (inertia, f"{inertia}    {FRAME}\n")))


def test_first_approximation_of_the_disc_in_a_circle() -> None:
    """The equations below differentiated at lean L, s = W cos(L), q = W sin(L) + w, p = 0:

    delta p' = (4 g cos(L)/r - W^2)/5 delta lean + 6/5 s delta q + (6/5 q - 2/5 s tan(L)) delta s,
    delta q' = -2/3 s p,   delta s' = (s tan(L) - 2 q) p.
    """
    found = in_a_circle()
    state = found.first_order
    assert state.names == ("lean", "p", "q", "s")
    lean, rate, g, r = 0.4, 3.0, 9.81, 0.5
    numbers = dict.fromkeys(found.ring.names(), arb(0))
    numbers |= {"m": arb(1), "r": arb(r), "g": arb(g), "L": arb(lean), "W": arb(rate)}
    spin = -5 * rate * np.sin(lean) / 6 - 2 * g * np.sin(lean) / (3 * r * rate * np.cos(lean))
    q, s = spin + rate * np.sin(lean), rate * np.cos(lean)
    wanted = [
        [0, 1, 0, 0],
        [(4 * g * np.cos(lean) / r - rate**2) / 5, 0, 6 / 5 * s, 6 / 5 * q - 2 / 5 * s * np.tan(lean)],
        [0, -2 / 3 * s, 0, 0],
        [0, s * np.tan(lean) - 2 * q, 0, 0],
    ]
    a = [[float(found.ring.evaluate(x, numbers).mid()) for x in row] for row in state.A.polynomials]
    assert np.array(a) == pytest.approx(np.array(wanted), abs=1e-12)
    values = [float(found.ring.evaluate(x.polynomial, numbers).mid()) for x in state.values]
    assert values == pytest.approx([lean, 0, q, s], abs=1e-12)
    outcomes = {check.name: check.outcome for check in found.checks}
    assert outcomes["first approximation in speeds"] == EXACT
    assert set(outcomes.values()) <= {EXACT, NUMERICAL}


def test_a_dependent_speed_that_is_not_expressed_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """A gamma without J' u: the embedded forces are wrong, and with them A."""
    monkeypatch.setattr(analysis, "speed_rows", _without_rates(analysis.speed_rows))
    found = in_a_circle()
    assert found.optional("first_order") is not None
    check = found.check("first approximation in speeds")
    assert check is not None
    assert check.outcome == FAILED


def test_the_disc_has_the_equations_of_neimark_and_fufaev() -> None:
    """In the axes of the leaning frame p = lean', q = spin' + yaw' sin(lean), s = yaw' cos(lean), as derived there:

    5/4 p' = 3/2 s q - 1/4 s^2 tan(lean) + g/r sin(lean),   3/2 q' = -s p,   1/4 s' = 1/4 s p tan(lean) - 1/2 p q.
    """
    found = analysed(text_of("rolling-disc-speeds", ("speeds: {u1: omega1, u2: omega2, u3: omega3}", FRAME)))
    source = random.Random(11)
    for _ in range(3):
        lean, p, q, s = (source.uniform(-1, 1) for _ in range(4))
        at = AtState(
            found, {"yaw": 0.7, "spin": 2.1, "lean": lean, "p": p, "q": q, "s": s, "m": 2, "r": 0.5, "g": 9.81}
        )
        embedded = at.equations.embedded
        assert embedded.free == ("p", "q", "s")
        unit = 2 * 0.5**2
        assert at.matrix(embedded.mass_matrix) == pytest.approx(unit * np.diag([5 / 4, 3 / 2, 1 / 4]), abs=1e-13)
        wanted = [
            1.5 * s * q - s**2 * np.tan(lean) / 4 + 9.81 / 0.5 * np.sin(lean),
            -s * p,
            s * p * np.tan(lean) / 4 - p * q / 2,
        ]
        assert at.column(embedded.forcing) == pytest.approx(unit * np.array(wanted), abs=1e-12)


@pytest.mark.parametrize("name", ["rolling-disc-speeds", "rolling-sphere-speeds"])
def test_the_self_check_holds(name: str) -> None:
    outcomes = {check.name: check.outcome for check in shipped(name).checks}
    assert outcomes["constraints"] == outcomes["constrained motion"] == outcomes["first integrals"] == EXACT
    assert set(outcomes.values()) == {EXACT}


def test_the_sphere_keeps_its_angular_velocity() -> None:
    """Neimark & Fufaev: omega is constant, and so are its components in the sphere, as omega x omega = 0."""
    found = shipped("rolling-sphere-speeds")
    names = {x.name for x in found.integrals}
    along = {f"linear momentum along axis {k}" for k in (1, 2)}  # m x', m y', as they are called in coordinates, too
    assert {"generalised energy", "dT/dp", "dT/dq", "dT/ds"} | along <= names
    assert {x.status for x in found.integrals} == {"proved"}
    # The velocity of the centre is omega x r e_3 = r (omega . beta, -omega . alpha): alpha, beta the axes of the plane.
    state = {"alpha1": 0.6, "alpha2": 0.8, "beta1": -0.8, "beta2": 0.6, "gamma3": 1.0, "p": 0.3, "q": -0.7, "s": 1.1}
    at = AtState(found, state)
    turned = (0.6 * 0.3 + 0.8 * -0.7, -0.8 * 0.3 + 0.6 * -0.7)
    assert [at.values["x_dot"], at.values["y_dot"]] == pytest.approx([0.5 * turned[1], -0.5 * turned[0]], abs=1e-14)
    assert list(at.speeds.values()) == pytest.approx([0] * 5, abs=1e-14)


SPEEDS = ("coordinates: [x, y, alpha, beta, gamma]", "speeds: {p: omega1, q: omega2, u: omega3}")


def turntable(rate: str = "Omega") -> Analysis:
    """The sphere on the turntable with its angular velocity for speeds, x and y those of a body of their own."""
    return analysed(
        text_of(
            "turntable-sphere",
            ("  - name: sphere\n    attached to: 0\n    connection point: [x, y, r]\n",
             "  - {name: centre, attached to: 0, connection point: [x, y, r], coordinates: [x, y], mass: m}\n"
             "  - name: sphere\n    attached to: centre\n"),
            ("    mass: m\n    inertia about: joint", "    mass: 0\n    inertia about: joint"),
            ("    coordinates: [x, y, alpha, beta, gamma]\n",
             "    speeds: {p: omega1, q: omega2, u: omega3}\n    orientation: direction cosines\n"),
            ("axes: 0, on: table", "axes: centre, on: table"),
            ("dependent: [alpha, beta]", "dependent: [p, q]"),
            ("motion: {x: 0, y: 0, alpha: 0, beta: 0, gamma: {rate: s}}\n", ""),
            ("chi: {rate: Omega}", f"chi: {{rate: {rate}}}"),
        )
    )  # fmt: skip


def test_the_sphere_on_a_turntable_circles_in_speeds_too() -> None:
    """V' = 2/7 Omega k x V for J = 2/5 m r^2; the dependent speeds are p and q, as the description asks."""
    found = turntable()
    source = random.Random(5)
    turn = np.linalg.qr(np.array([[source.uniform(-1, 1) for _ in range(3)] for _ in range(3)]))[0]
    turn = turn * np.sign(np.linalg.det(turn))
    names = [f"{word}_a" if word in ("alpha", "beta", "gamma") else word for word in ("alpha", "beta", "gamma")]
    vectors = [one.components for body in found.system.bodies for one in body.orientation]
    assert len(vectors) == len(names)
    state = {key: float(x) for row, axis in zip(vectors, turn, strict=True) for key, x in zip(row, axis, strict=True)}
    state |= {"x_dot": 0.3, "y_dot": -0.8, "u": 0.4, "x": 0.2, "y": 0.7, "J": 0.4 * 0.1**2}
    at = AtState(found, state)
    assert set(at.tied.dependent) == {"p", "q"}
    rate = 2 / 7 * at.values["Omega"]
    assert [at.speeds["x_dot"], at.speeds["y_dot"]] == pytest.approx([0.8 * rate, 0.3 * rate], abs=1e-12)
    outcomes = {check.name: check.outcome for check in found.checks}
    assert set(outcomes.values()) <= {EXACT, NUMERICAL}
    assert "generalised energy" not in {x.name for x in found.integrals}  # the table does work


TOP = """
mbsym: 1
name: A body tied to a point
parameters: {m: positive, l: positive, g: positive, A: positive, C: positive}
bodies:
  - {name: place, attached to: 0, connection point: [x, y, z], coordinates: [x, y, z], mass: 0}
  - name: top
    attached to: place
    rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}
    mass: m
    inertia about: mass centre
    inertia: [A, A, C]
    speeds: {p: omega1, q: omega2, r: omega3}
    orientation: ORIENTATION
loads:
  - uniform gravity: {vector: [0, 0, -g]}
constraints:
  - coincide: [{body: top, point: [0, 0, -l]}, {body: 0, point: [0, 0, 0]}]
dependent: [x, y, z]
"""


@pytest.mark.parametrize("orientation", ["angles", "direction cosines", "quaternion"])
def test_a_top_that_is_tied_to_a_point_has_eulers_equations(orientation: str) -> None:
    """(A + m l^2) p' + (C - A - m l^2) q r = m g l gamma_2,  (A + m l^2) q' - (C - A - m l^2) p r = -m g l gamma_1,
    C r' = 0: three coordinates tied, and their velocities expressed.
    """
    found = analysed(TOP.replace("ORIENTATION", orientation))
    tied = found.constraints
    assert (tied.position_rank, tied.dependent, tied.free) == (3, ("x_dot", "y_dot", "z_dot"), ("p", "q", "r"))
    m, l, g, a, c = 1.5, 0.4, 9.81, 0.2, 0.1
    state = {"m": m, "l": l, "g": g, "A": a, "C": c, "p": 0.3, "q": -0.7, "r": 1.1}
    psi, theta, phi = 0.4, 0.9, -0.5
    angles = {"psi": psi, "theta": theta, "phi": phi}
    third = [np.sin(theta) * np.sin(phi), np.sin(theta) * np.cos(phi), np.cos(theta)]  # the vertical in body axes
    first = [
        np.cos(psi) * np.cos(phi) - np.cos(theta) * np.sin(psi) * np.sin(phi),
        -np.cos(psi) * np.sin(phi) - np.cos(theta) * np.sin(psi) * np.cos(phi),
        np.sin(theta) * np.sin(psi),
    ]
    second = np.cross(third, first)
    if orientation == "angles":
        state |= angles
    elif orientation == "quaternion":
        half, plus, minus = theta / 2, (psi + phi) / 2, (psi - phi) / 2
        parts = np.cos(half) * np.cos(plus), np.sin(half) * np.cos(minus), np.sin(half) * np.sin(minus)
        state |= dict(zip(("e0", "e1", "e2", "e3"), (*parts, np.cos(half) * np.sin(plus)), strict=True))
    else:
        for word, axis in zip(("alpha", "beta", "gamma"), (first, second, third), strict=True):
            state |= {f"{word}{k}": float(x) for k, x in enumerate(axis, start=1)}
    state |= dict(zip("xyz", (l * np.array([first[2], second[2], third[2]])).tolist(), strict=True))
    at = AtState(found, state)
    whole, weight = a + m * l**2, m * g * l
    wanted = [
        (weight * third[1] - (c - whole) * -0.7 * 1.1) / whole,
        (-weight * third[0] + (c - whole) * 0.3 * 1.1) / whole,
        0.0,
    ]
    assert [at.speeds[key] for key in "pqr"] == pytest.approx(wanted, abs=1e-12)
    outcomes = {check.name: check.outcome for check in found.checks}
    known = NUMERICAL if orientation == "quaternion" else EXACT
    assert outcomes["constraints"] == outcomes["constrained motion"] == known
    spin = "momentum of phi" if orientation == "angles" else "dT/dr"  # C r, by either name
    assert {"generalised energy", spin} <= {x.name for x in found.integrals}


# --- planted mistakes ---


def _other_sign(original: Callable[..., Any]) -> Callable[..., Any]:
    """Rolling with - omega x c."""
    return lambda scene, body, arm, frame: original(scene, body, -arm, frame)


def _without_rates(original: Callable[..., Any]) -> Callable[..., Any]:
    """J' u forgotten."""

    def wrong(*arguments: Any) -> Any:
        rows = original(*arguments)
        return tuple(replace(x, acceleration=x.acceleration.context().constant(0)) for x in rows)

    return wrong


@pytest.mark.parametrize(
    ("module", "function", "mistake", "check"),
    [
        (speed_rows, "_material", _other_sign, "constraints"),
        (analysis, "speed_rows", _without_rates, "constraints"),
        (analysis, "speed_rows", _without_rates, "constrained motion"),
    ],
)
def test_a_mistake_is_found(
    monkeypatch: pytest.MonkeyPatch, module: Any, function: str, mistake: Callable[..., Any], check: str
) -> None:
    monkeypatch.setattr(module, function, mistake(getattr(module, function)))
    analysis = mbsym.load(SHIPPED / "rolling-disc-speeds.yaml", (3, 7))
    analysis.stage(3)
    found = analysis.check(check)
    assert found is not None
    assert found.outcome == FAILED
    with pytest.raises(Unavailable, match="withdrawn"):  # what is said of conserved quantities falls
        _ = analysis.integrals


# --- what is refused, and complaints ---


def test_what_does_not_know_both_refuses_by_name() -> None:
    found = shipped("rolling-disc-speeds")
    with pytest.raises(Unavailable) as reason:
        _ = found.programs
    assert "constraints are not taken into account here yet (rolling 1)" in str(reason.value)


def test_there_is_no_first_approximation_where_speeds_turn_with_the_body() -> None:
    with pytest.raises(Unavailable, match="not steady in speeds and positions: they vary with spin"):
        _ = shipped("rolling-disc-speeds").first_order
    top = TOP.replace("ORIENTATION", "angles").replace("[3, 1, 3]", "[1, 2, 3]") + "motion: {z: l}\n"
    with pytest.raises(Unavailable, match="constraints tie positions: their deviations are not free"):
        _ = analysed(top).first_order


def complaints_of(text: str) -> list[tuple[str, str]]:
    system, complaints = read(text)
    if system is not None:
        complaints = Complaints()
        complain_of_constraints(system, complaints)
    return [(one.code, one.message) for one in complaints]


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        ("dependent: [x, y]", "dependent: [u1, u2, u3]", "dependent-set"),
        ("dependent: [x, y]", "dependent: [x, x_dot]", "misplaced-name"),
        ("dependent: [x, y]", "dependent: [x, u4]", "unknown-name"),
        ("dependent: [x, y]", "  - velocity: x_dot = 1\n  - velocity: x_dot = 2", "contradictory-constraints"),
        ("dependent: [x, y]", "  - coincide: [{body: leaning, point: [r, 0, 0]}, {body: yawed, point: [r, 0, 0]}]",
         "rigid-constraint"),
        ("on: ground", "on: table", "unknown-body"),
    ],
)  # fmt: skip
def test_complaints_about_constraints_hold_with_speeds(old: str, new: str, code: str) -> None:
    found = complaints_of(text_of("rolling-disc-speeds", (old, new)))
    assert code in {one for one, _ in found}, found


def test_speeds_that_no_constraint_determines_are_named() -> None:
    """x and y of the turntable's sphere follow from p and q; u, the spin about the body's own axis, does not."""
    text = text_of("rolling-sphere-speeds", ("dependent: [x, y]", "dependent: [x, p]"))
    assert complaints_of(text) == []
    second = (
        "\n  - {name: other, attached to: 0, rotation: {axes: [3], angles: [far]}, mass: 1, speeds: {n: far_dot}}\n"
    )
    text = text.replace("\nloads:", second + "\nloads:").replace("dependent: [x, p]", "dependent: [x, n]")
    ((code, message),) = complaints_of(text)
    assert code == "dependent-set"
    assert message == "the constraints cannot be solved for the speeds x_dot, n"


def test_an_angle_that_unit_vectors_replace_stands_in_no_constraint() -> None:
    text = text_of("rolling-sphere-speeds", ("dependent: [x, y]", "  - velocity: psi_dot = 0"))
    assert (
        "orientation",
        "the angle 'psi' stands in a constraint: unit vectors cannot take its place",
    ) in complaints_of(text)
