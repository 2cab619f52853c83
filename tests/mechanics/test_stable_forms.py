"""Forms that keep digits: the same values in exact arithmetic, more digits in floating point."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from conftest import SHIPPED, system_of
from flint import arb, ctx, fmpq

from mbsym.algebra.point import Balls, Rationals
from mbsym.algebra.program import Node, Program
from mbsym.algebra.stable import stabilised
from mbsym.expressions.tree import Number
from mbsym.mechanics.energy import kinetic_energy
from mbsym.mechanics.falling import falling_frames, relative_lagrangian
from mbsym.mechanics.loads.kinds import force_function
from mbsym.mechanics.newton_euler import residuals
from mbsym.mechanics.programs import programs, scene_without_accelerations
from mbsym.mechanics.variables import program_environment, ring_of
from mbsym.model.loads import GRAVITY_ORDERS, NewtonianGravity
from mbsym.model.system import System
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.kernels.llvm import kernels
from mbsym.numerics.kernels.precise import enclosures
from mbsym.numerics.scenario import Specialised, scenario, substituted

EPS = 2.0**-53


def system(name: str) -> System:
    return system_of(SHIPPED / f"{name}.yaml")


def errors(code: Code, values: Sequence[float]) -> list[float]:
    """The relative error of every output in float64, against balls at exactly the given values."""
    truth = enclosures(code, [Fraction(x) for x in values], 1500)
    got = kernels({"f": code})["f"](np.array(values, dtype=float))
    found = []
    for approximate, ball in zip(got, truth, strict=True):
        with ctx.workprec(1500):
            error = abs(arb(float(approximate)) - ball) / abs(ball) if not ball.is_zero() else abs(arb(approximate))
        found.append(float(error.mid()))
    return found


# --- single forms ---

Formula = Callable[[Program, dict[str, Node]], Node]


def _versine(p: Program, x: dict[str, Node]) -> Node:
    return p.number(3) - p.number(3) * p.sin_cos_of(x["x"])[1]


def _versine_of_factor(p: Program, x: dict[str, Node]) -> Node:
    return x["y"] * x["z"] - (x["z"] * p.sin_cos_of(x["x"])[1]) * x["y"]


def _two_pendulums(p: Program, x: dict[str, Node]) -> Node:
    return p.number(5) - p.number(2) * p.sin_cos_of(x["x"])[1] - p.number(3) * p.sin_cos_of(x["y"])[1]


def _opposite(p: Program, x: dict[str, Node]) -> Node:
    return p.number(2) + p.number(2) * p.sin_cos_of(x["w"])[1]


def _squares(p: Program, x: dict[str, Node]) -> Node:
    return x["y"] * x["y"] - x["v"] * x["v"]


def _cosines(p: Program, x: dict[str, Node]) -> Node:
    return p.sin_cos_of(x["y"])[1] - p.sin_cos_of(x["v"])[1]


def _sines(p: Program, x: dict[str, Node]) -> Node:
    return x["z"] * p.sin_cos_of(x["y"])[0] - x["z"] * p.sin_cos_of(x["v"])[0]


def _root(p: Program, x: dict[str, Node]) -> Node:
    stretched = p.number(2) + x["x"]
    return p.square_root(stretched * stretched + x["x"] * x["x"]) - p.number(2)


def _strain(p: Program, x: dict[str, Node]) -> Node:
    stretched = p.number(2) + x["x"]
    root = p.square_root(stretched * stretched + x["x"] * x["x"])
    return p.one - p.divide(p.number(2), root)


def _gimbal(p: Program, x: dict[str, Node]) -> Node:
    """(J cos^2 + A sin^2) - (A sin)(A sin)/A, as a pivot arises."""
    s, c = p.sin_cos_of(x["u"])
    return (p.number(5) * c * c + p.number(7) * s * s) - (p.number(7) * s) * s


def _constants(p: Program, x: dict[str, Node]) -> Node:
    big = p.number(10**20)
    return (big + x["x"]) - big


FORMS: list[tuple[str, Formula]] = [
    ("1 - cos x", _versine),
    ("yz - yz cos x", _versine_of_factor),
    ("a + b - a cos x - b cos y, y = x", _two_pendulums),
    ("1 + cos x near pi", _opposite),
    ("y^2 - v^2", _squares),
    ("cos y - cos v", _cosines),
    ("z sin y - z sin v", _sines),
    ("sqrt((L + x)^2 + x^2) - L", _root),
    ("1 - L/sqrt((L + x)^2 + x^2)", _strain),
    ("gimbal", _gimbal),
    ("constants that cancel", _constants),
]
VALUES = {
    "x": 1.1e-6,
    "y": 0.7,
    "z": 3.3,
    "v": 0.7 + 2e-7,
    "w": 3.14159,
    "u": 1.5707961,
}


@pytest.mark.parametrize(("name", "formula"), FORMS, ids=[form[0] for form in FORMS])
def test_a_form_keeps_its_digits_and_its_value(name: str, formula: Formula) -> None:
    program = Program()
    inputs = {key: program.input(key) for key in VALUES}
    if name.endswith("y = x"):
        inputs["y"] = inputs["x"] + inputs["x"]
    plain = formula(program, inputs)
    better = stabilised(program, [plain], thorough=True)[0]
    assert better != plain
    names = tuple(VALUES)
    before, after = [], []
    for place in range(5):  # a plain form can be lucky at one point
        values = [x * (1 + place * 1e-9) for x in VALUES.values()]
        errors_there = (errors(Code(program, names, (node,)), values)[0] for node in (plain, better))
        for found, error in zip((before, after), errors_there, strict=True):
            found.append(error)
    assert max(after) < 8 * EPS
    assert max(before) > 1e-11, "the plain form is the negative control: it loses five digits or more"
    for seed in range(3):
        source = random.Random(seed)
        with ctx.workprec(400):
            exact_values = {key: arb(fmpq(source.randint(1, 99), 37)) for key in VALUES}
            a, b = program.evaluate([plain, better], exact_values, Balls(exact_values))
            assert abs(a - b) < arb(10) ** -90


def test_values_stay_identical_in_exact_arithmetic() -> None:
    """Polynomial and rational forms over rational numbers: equality without tolerance."""
    program = Program()
    x, y, z = (program.input(name) for name in "xyz")
    s, c = program.sin_cos_of(x)
    outputs = [
        (y * y - z * z) * z,
        y * c * c + y * s * s - z,
        y + z - y * s * s,
        y * y * c - c * (z * z),
        program.divide(y * y, z) - program.divide(z * z, z),
    ]
    better = stabilised(program, outputs, thorough=True)
    for seed in range(5):
        source = random.Random(seed)
        values = {name: fmpq(source.randint(1, 50), source.randint(1, 50)) for name in "xyz"}
        numbers = Rationals({"x": fmpq(source.randint(1, 9), 7)}, {"x": 1})
        assert program.evaluate(outputs, values, numbers) == program.evaluate(better, values, numbers)


def test_shared_nodes_stay_shared() -> None:
    """A sum that nothing improves is left alone, whatever else is rewritten."""
    program = Program()
    x, y, z = (program.input(name) for name in "xyz")
    shared = x + y
    outputs = [shared * z, shared + z, (shared - z) * y]
    assert stabilised(program, outputs) == outputs


NAMES = ["double-pendulum", "heavy-top", "gravity-gradient", "spring-pendulum", "satellite"]


@pytest.mark.parametrize("name", NAMES)
def test_programs_keep_their_values_and_do_not_grow(name: str) -> None:
    given = scenario(system(name), state=False)
    dynamics = Dynamics(given)
    found = programs(dynamics.system, dynamics.ring)
    fresh = dynamics.mass_matrix.program
    assert isinstance(fresh, Specialised)
    nodes = [x for row in found.mass_matrix for x in row] + [*found.forcing]
    plain = Code(fresh, dynamics.inputs, tuple(substituted(found.program, nodes, fresh)))
    better = Code(fresh, dynamics.inputs, tuple(stabilised(fresh, plain.outputs)))
    assert better.operations <= 1.02 * plain.operations + 1
    source = random.Random(7)
    values = [Fraction(source.uniform(-1.5, 1.5)) for _ in dynamics.inputs]
    a, b = enclosures(plain, values, 400), enclosures(better, values, 400)
    scale = max(float(abs(x).mid()) for x in a)
    assert max(float(abs(x - y).mid()) for x, y in zip(a, b, strict=True)) < 1e-70 * scale


@pytest.mark.parametrize("name", ["gravity-gradient", "satellite"])
@pytest.mark.parametrize("distance", [1e-4, 1e-9])
def test_accelerations_keep_their_digits_near_the_singularity_of_the_angles(name: str, distance: float) -> None:
    """cos(theta) -> 0: the pivot of psi is J cos^2 theta; as J - J sin^2 theta no digit would be left."""
    dynamics = Dynamics(scenario(system(name)))
    state = [0.0, *(float(x) for x in dynamics.scenario.state)]
    state[dynamics.inputs.index("theta")] = float(np.pi / 2 - distance)
    assert max(errors(dynamics.pivots, state)) < 1e-12
    code = dynamics.right_hand_side
    accelerations = Code(code.program, code.inputs, code.outputs[dynamics.size :])
    truth = [float(x) for x in enclosures(accelerations, [Fraction(x) for x in state], 1500)]
    got = kernels({"f": accelerations})["f"](np.array(state))
    assert np.max(np.abs(got - truth)) < 1e-12 * np.max(np.abs(truth))


# --- frames that fall ---


@pytest.mark.parametrize("order", GRAVITY_ORDERS)
@pytest.mark.parametrize("name", ["satellite", "gravity-gradient"])
def test_a_falling_frame_changes_no_equation(name: str, order: int | str) -> None:
    """Forcing with frame and gravity joined against the Newton-Euler recursion that takes them apart."""
    given = system(name)
    loads = tuple(replace(x, order=order) if isinstance(x, NewtonianGravity) else x for x in given.loads)
    changed = replace(given, loads=loads)
    ring = ring_of(changed)
    joined = programs(changed, ring)
    program = Program()
    inputs = program_environment(changed, program)
    scene = scene_without_accelerations(changed, ring, program, inputs)
    apart = residuals(scene)
    relative, force = relative_lagrangian(scene)
    difference = (relative + force) - (kinetic_energy(scene) + force_function(scene))
    source = random.Random(5)
    with ctx.workprec(600):
        values = {x: arb(fmpq(source.randint(1, 50), source.randint(1, 20))) for x in inputs} | {"pi": arb.pi()}
        values["R"] = arb(fmpq(70_001, 7))
        a = program.evaluate([apart[q] for q in changed.coordinates], values, Balls(values))
        b = joined.program.evaluate(joined.forcing, values, Balls(values))
        scale = max(abs(x).mid() for x in b)
        assert all(abs(x + y) < scale * arb(10) ** -120 for x, y in zip(a, b, strict=True))
        # L differs by d/dt F(q) + const, so its value at rest (frame at rest relative to O1) by a constant only.
        still = dict(values) | {v: arb(0) for v in changed.velocities}
        first = program.evaluate([difference], still, Balls(still))[0]
        moved = dict(still) | {q: arb(fmpq(source.randint(1, 50), 7)) for q in changed.coordinates}
        second = program.evaluate([difference], moved, Balls(moved))[0]
        assert abs(first) > 1
        if name == "gravity-gradient":
            assert abs(first - second) < arb(10) ** -100 * abs(first)


@pytest.mark.parametrize(("radius", "apart_loses"), [(7_000_000, 1e-11), (2 * 10**12, 1e-6)])
def test_a_satellite_keeps_its_digits_on_any_orbit(radius: int, apart_loses: float) -> None:
    """l/R = 3e-7 and 1e-12: the forcing keeps 15 digits where term by term it keeps 9 and 4."""
    values = {"R": Number(Fraction(radius)), "omega0": Number(Fraction(1, 1000))}
    dynamics = Dynamics(scenario(system("satellite"), values))
    program = Program()
    inputs = program_environment(dynamics.system, program)
    apart = residuals(scene_without_accelerations(dynamics.system, dynamics.ring, program, inputs))
    fresh = dynamics.forcing.program
    nodes = substituted(program, [-apart[q] for q in dynamics.system.coordinates], fresh)
    plain = Code(fresh, dynamics.inputs, tuple(nodes))
    positions, velocities = dynamics.scenario.positions, dynamics.scenario.velocities
    state = [1000.0, *map(float, positions), *(float(v) / 1000 for v in velocities)]
    truth = np.array([float(x) for x in enclosures(plain, [Fraction(x) for x in state], 900)])
    scale = np.max(np.abs(truth))
    run = kernels({"plain": plain, "joined": dynamics.forcing})
    worst = {name: np.max(np.abs(kernel(np.array(state)) - truth)) / scale for name, kernel in run.items()}
    assert worst["joined"] < 20 * EPS
    assert worst["plain"] > apart_loses, "the negative control"
    assert dynamics.forcing.operations < plain.operations


def test_only_prescribed_frames_fall() -> None:
    given = system("satellite")
    assert list(falling_frames(given)) == ["orbital frame"]
    loads = tuple(replace(x, about="satellite") if isinstance(x, NewtonianGravity) else x for x in given.loads)
    assert not falling_frames(replace(given, loads=loads))
    assert not falling_frames(system("double-pendulum"))
