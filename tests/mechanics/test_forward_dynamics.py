"""Forward dynamics as straight-line code: every route against every other, exactly, and operations as claimed."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from conftest import WITH_BODIES
from flint import fmpq, fmpq_mat
from hypothesis import assume, given
from hypothesis import strategies as st
from properties import settings
from random_systems import Description, analysed, orbiting, systems
from test_self_check import PROGRAM, Mistake, failing, failing_without_a_mistake, plant

import mbsym
from mbsym.algebra.failures import Constrained, NotRational, SingularPoint
from mbsym.algebra.point import Rationals
from mbsym.algebra.program import Program
from mbsym.analysis import Analysis
from mbsym.mechanics import articulated, factorisation
from mbsym.mechanics.articulated import bias_forces, forcing
from mbsym.mechanics.articulation import Articulation, articulation
from mbsym.mechanics.factorisation import mass_matrix
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.newton_euler import residuals
from mbsym.mechanics.oracle import Oracle, State
from mbsym.mechanics.programs import ARTICULATED, FACTORISED, accelerated, forward_dynamics, scene_without_accelerations
from mbsym.mechanics.states import rational_states
from mbsym.mechanics.variables import program_environment
from mbsym.model.system import acceleration_name, velocity_name

SHIPPED = WITH_BODIES


def frames_of(analysis: Analysis) -> tuple[Program, Articulation]:
    program = Program()
    inputs = program_environment(analysis.system, program)
    return program, articulation(scene_without_accelerations(analysis.system, analysis.ring, program, inputs))


def by_columns(analysis: Analysis, state: State) -> tuple[list[list[Any]], list[Any]]:
    """M and f at one state by the general Newton-Euler recursion over rational numbers."""
    system, names, zero = analysis.system, analysis.system.coordinates, fmpq(0)
    rest = {velocity_name(name): zero for name in names}
    columns = []
    for moving in names:
        unit = {acceleration_name(name): fmpq(name == moving) for name in names}
        here = Scene(system, state.numbers, {**state.values, **rest, **unit}, analysis.ring, frozen=True)
        columns.append(residuals(here, loads=False))
    still = {acceleration_name(name): zero for name in names}
    coast = residuals(Scene(system, state.numbers, {**state.values, **still}, analysis.ring))
    return [[column[name] for column in columns] for name in names], [-coast[name] for name in names]


def check_routes(analysis: Analysis, states: int = 1) -> None:
    """M, f, and the accelerations of both methods at exact states."""
    system, n = analysis.system, len(analysis.system.coordinates)
    program, frames = frames_of(analysis)
    mass, force = mass_matrix(frames), forcing(frames, bias_forces(frames))
    methods = [FACTORISED, ARTICULATED] if articulated.applies(frames) else [FACTORISED]
    try:
        found = [forward_dynamics(system, analysis.ring, method) for method in methods]
    except SingularPoint:
        found = []
    for state in rational_states(system, analysis.ring, states):
        rows, right = by_columns(analysis, state)
        values = program.evaluate([*(x for row in mass for x in row), *force], state.values, state.numbers)
        assert values[: n * n] == [x for row in rows for x in row]
        assert values[n * n :] == right
        matrix = fmpq_mat(n, n, [x for row in rows for x in row])
        determinant = matrix.det()
        if not found:
            assert determinant == 0
            continue
        for dynamics in found:
            if determinant == 0:
                continue
            nodes = [*dynamics.accelerations, *dynamics.pivots]
            values = dynamics.program.evaluate(nodes, state.values, state.numbers)
            assert fmpq_mat(n, 1, values[:n]) == matrix.solve(fmpq_mat(n, 1, right))
            product = fmpq(1)
            for pivot in values[n:]:
                product *= pivot
            assert product == determinant


@settings(max_examples=40, derandomize=True)
@given(st.one_of(systems(), systems(), orbiting()))
def test_every_route_gives_the_same_accelerations(description: Description) -> None:
    analysis = analysed(description)
    assume(analysis.system.coordinates)
    try:
        check_routes(analysis)
    except (NotRational, ZeroDivisionError):
        assume(False)


CONSTRAINED = [path for path in SHIPPED if "\nconstraints:" in path.read_text(encoding="utf-8")]
#: Roots of independent sums of squares stand in its forces: at no random rational state are both rational.
IRRATIONAL = [path for path in SHIPPED if path.stem == "three-bodies"]
FREE = pytest.mark.parametrize(
    "path", [x for x in SHIPPED if x not in CONSTRAINED and x not in IRRATIONAL], ids=lambda path: path.stem
)


@FREE
def test_shipped_systems(path: Path) -> None:
    check_routes(mbsym.load(path), 2)


@pytest.mark.parametrize("path", IRRATIONAL, ids=lambda path: path.stem)
def test_what_is_left_out_above_has_no_exact_states(path: Path) -> None:
    """Its accelerations are compared in balls, by the self-check of every run."""
    analysis = mbsym.load(path)
    with pytest.raises(NotRational):
        check_routes(analysis, 2)
    assert not any(check.failed for check in analysis.checks)
    assert {"equations of motion", "straight-line program"} <= {check.name for check in analysis.checks}


@pytest.mark.parametrize("path", CONSTRAINED, ids=lambda path: path.stem)
def test_constraints_are_never_left_out(path: Path) -> None:
    analysis = mbsym.load(path)
    with pytest.raises(Constrained):
        forward_dynamics(analysis.system, analysis.ring)


@FREE
def test_accelerations_satisfy_d_alembert(path: Path) -> None:
    """The truth shares nothing but the description with the recursions."""
    analysis = mbsym.load(path)
    dynamics = forward_dynamics(analysis.system, analysis.ring)
    compared = 0
    for state in rational_states(analysis.system, analysis.ring, 3):
        try:
            expected = accelerated(analysis.system, state, analysis.programs)
        except SingularPoint:  # the parameters of a random state need not be those of a body
            continue
        values = dynamics.program.evaluate(dynamics.accelerations, state.values, state.numbers)
        names = [acceleration_name(name) for name in analysis.system.coordinates]
        moving = State(state.numbers, {**state.values, **dict(zip(names, values, strict=True))})
        assert set(Oracle(analysis.system, moving).residuals.values()) == {fmpq(0)}
        assert expected.values == moving.values
        compared += 1
    assert compared


def test_the_mass_matrix_of_the_program_is_lean_and_right_for_absolute_angles() -> None:
    """A planar double pendulum in absolute angles: both coordinates drive the second joint."""
    text = {
        "mbsym": 1,
        "name": "absolute angles",
        "parameters": ["l", "c", "m1", "m2", "J"],
        "bodies": [
            {
                "name": f"link {k}",
                "attached to": "link 1" if k == 2 else 0,
                "rotation": {"axes": [3], "angles": ["q1" if k == 1 else "q2 - q1"]},
                "connection point": ["l" if k == 2 else 0, 0, 0],
                "coordinates": [f"q{k}"],
                "mass centre": ["c", 0, 0],
                "mass": f"m{k}",
                "inertia about": "mass centre",
                "inertia": [0, "J", "J"],
            }
            for k in (1, 2)
        ],
    }
    analysis = analysed(text)
    assert not articulated.applies(frames_of(analysis)[1])
    check_routes(analysis, 3)
    with pytest.raises(ValueError, match="does not apply"):
        forward_dynamics(analysis.system, analysis.ring, ARTICULATED)
    state = next(rational_states(analysis.system, analysis.ring, 1))
    rows, _ = by_columns(analysis, state)
    m1, m2, c, l, J = (state.values[name] for name in ("m1", "m2", "c", "l", "J"))
    sine, cosine = zip(*(state.numbers.basic[name] for name in ("q1", "q2")), strict=True)
    mixed = m2 * l * c * (cosine[0] * cosine[1] + sine[0] * sine[1])
    assert rows == [[m1 * c * c + J + m2 * l * l, mixed], [mixed, m2 * c * c + J]]


# --- gravity ---


@settings(max_examples=25, derandomize=True)
@given(systems(loads=False), st.lists(st.integers(-3, 3), min_size=3, max_size=3))
def test_gravity_as_an_accelerated_base_equals_weights_at_the_mass_centres(
    description: Description, field: list[int]
) -> None:
    description["loads"] = [{"uniform gravity": {"vector": [f"{x}*g" for x in field]}}] if any(field) else []
    analysis = analysed(description)
    assume(analysis.system.coordinates)
    program, frames = frames_of(analysis)
    lean = forcing(frames, bias_forces(frames))
    general = residuals(frames.scene)
    for state in rational_states(analysis.system, analysis.ring, 1):
        nodes = [*lean, *(-general[name] for name in analysis.system.coordinates)]
        values = program.evaluate(nodes, state.values, state.numbers)
        assert values[: len(lean)] == values[len(lean) :]


# --- factorisation ---


def test_a_tree_fills_in_nothing_and_branches_stay_apart() -> None:
    """Featherstone's example: eliminating from the tips, no factor couples two branches."""
    parents = [-1, 0, 1, 1, 3, 0, 5]
    pattern: list[set[int]] = [{k} for k in range(7)]
    for k in range(7):
        j = parents[k]
        while j >= 0:
            pattern[k].add(j)
            pattern[j].add(k)
            j = parents[j]
    assert factorisation.elimination_order(pattern) == (6, 5, 4, 3, 2, 1, 0)
    program = Program()
    rows = [
        [program.input(f"m{min(i, j)}{max(i, j)}") if j in pattern[i] else program.zero for j in range(7)]
        for i in range(7)
    ]
    solution, pivots = factorisation.solve(program, rows, [program.input(f"f{k}") for k in range(7)])
    assert program.operations([*solution, *pivots]) == factorisation.counted(pattern)
    values = {f"m{i}{j}": fmpq(1 + i + 2 * j, 3) + (20 if i == j else 0) for i in range(7) for j in range(7)}
    values |= {f"f{k}": fmpq(k * k - 3, 5) for k in range(7)}
    dense = fmpq_mat(
        7, 7, [values[f"m{min(i, j)}{max(i, j)}"] if j in pattern[i] else fmpq(0) for i in range(7) for j in range(7)]
    )
    found = program.evaluate([*solution, *pivots], values, Rationals({}, {}))
    assert dense * fmpq_mat(7, 1, found[:7]) == fmpq_mat(7, 1, [values[f"f{k}"] for k in range(7)])
    determinant = fmpq(1)
    for pivot in found[7:]:
        determinant *= pivot
    assert determinant == dense.det()


def test_shared_coordinates_are_eliminated_with_little_fill() -> None:
    """An arrow that points the wrong way: the hub must come last though its number is the highest."""
    pattern = [{k, 5} for k in range(5)] + [set(range(6))]
    order = factorisation.elimination_order(pattern)
    assert order[-1] == 5 or order[-2] == 5
    assert factorisation.counted(pattern) == 5 * 9 + 2


def test_a_matrix_that_is_singular_everywhere_is_refused() -> None:
    program = Program()
    one = program.one
    with pytest.raises(SingularPoint, match="singular"):
        factorisation.solve(program, [[one, one], [one, one]], [one, one])


# --- operations ---


def chain(count: int) -> Analysis:
    """A spatial chain of rotary joints about axes 3, 2, 1, 3, ... with principal inertias."""
    bodies = [
        {
            "name": f"link {k}",
            "attached to": f"link {k - 1}" if k else 0,
            "rotation": {"axes": [3 - k % 3], "angles": [f"q{k}"]},
            "connection point": [0, 0, "l" if k else 0],
            "mass centre": [0, 0, "c"],
            "mass": "m",
            "inertia about": "mass centre",
            "inertia": ["A", "B", "C"],
        }
        for k in range(count)
    ]
    loads = [{"uniform gravity": {"vector": [0, 0, "-g"]}}]
    names = ["l", "c", "m", "A", "B", "C", "g"]
    return analysed({"mbsym": 1, "name": "chain", "parameters": names, "bodies": bodies, "loads": loads}, (1, 2, 3))


def test_articulated_bodies_are_linear_and_composite_bodies_quadratic() -> None:
    counts, mass, steps = [], [], (9, 18, 27, 36)  # the axes repeat after three joints
    for count in steps:
        analysis = chain(count)
        counts.append(forward_dynamics(analysis.system, analysis.ring, ARTICULATED).operations[ARTICULATED])
        program, frames = frames_of(analysis)
        rows = mass_matrix(frames)
        mass.append(program.operations([x for row in rows for x in row], analysis.system.parameter_names))
    differences = [later - earlier for earlier, later in pairwise(counts)]
    assert max(differences) - min(differences) <= 0.02 * max(differences), counts
    second = [later - earlier for earlier, later in pairwise([b - a for a, b in pairwise(mass)])]
    assert max(second) - min(second) <= 0.02 * max(second), mass


def test_the_cheaper_method_is_chosen() -> None:
    """A few joints are cheaper with the mass matrix, many without; the bounds are those of columns."""
    methods = []
    for count, most in ((5, 568), (7, 1117), (10, 2339), (20, 10044)):
        analysis = chain(count)
        both = [forward_dynamics(analysis.system, analysis.ring, method) for method in (ARTICULATED, FACTORISED)]
        costs = {dynamics.method: dynamics.operations[dynamics.method] for dynamics in both}
        chosen = forward_dynamics(analysis.system, analysis.ring)
        assert chosen.operations[chosen.method] == min(costs.values()) <= most
        assert costs[chosen.method] == min(costs.values())
        methods.append(chosen.method)
        if not chosen.estimated:
            assert chosen.operations == costs
    assert methods[0] == FACTORISED
    assert methods[-1] == ARTICULATED


def test_a_hundred_joints_are_emitted_without_the_mass_matrix() -> None:
    analysis = chain(100)
    dynamics = forward_dynamics(analysis.system, analysis.ring)
    assert dynamics.method == ARTICULATED
    assert dynamics.estimated == {FACTORISED}
    assert dynamics.operations[FACTORISED] > dynamics.operations[ARTICULATED]
    assert len(dynamics.program.instructions) < 400 * 100


def test_operations_of_parameters_alone_are_free() -> None:
    program = Program()
    a, b, x = (program.input(name) for name in "abx")
    node = (a * b + program.number(2)) * x + a
    assert program.operations([node]) == 4
    assert program.operations([node], ["a", "b"]) == 2
    assert program.operations([node], ["a"]) == 4
    assert program.operations([node], ["a", "b", "x"]) == 0


# --- planted mistakes ---

MISTAKES = [
    ("mechanics.factorisation:_Composite._climb", " + frame.offset.cross(force)", ""),
    ("mechanics.articulation:turned_symmetric", "p - across", "p + across"),
    ("mechanics.articulation:shifted", "- mixed", "+ mixed"),
    ("mechanics.articulation:shifted", "twice = h + moved", "twice = h + h"),
    ("mechanics.articulation:split", "algebra.zero, Vector", "own.mass, Vector"),
    ("mechanics.articulated:_w_tensor", "p[0][1] - c", "p[0][1] + c"),
    ("mechanics.articulated:_rotational", "tensor[k][k] - tensor[j][j]", "tensor[j][j] - tensor[k][k]"),
    ("mechanics.articulated:_moved", "algebra.number(2)", "algebra.number(1)"),
    ("mechanics.loads.kinds:base_acceleration", "base - field", "base + field"),
]


@pytest.mark.parametrize(("where", "right", "wrong"), MISTAKES)
def test_mistakes_in_the_lean_recursions_fail_the_self_check(
    monkeypatch: pytest.MonkeyPatch, where: str, right: str, wrong: str
) -> None:
    assert PROGRAM not in failing_without_a_mistake("machine")
    plant(monkeypatch, Mistake("", where, right, wrong, "machine", (PROGRAM,)))
    assert PROGRAM in failing("machine")


ARTICULATED_MISTAKES = [
    ("mechanics.articulated:_shifted", "new[j][j]", "old[j][j]"),
    ("mechanics.articulated:_turned_general", "mixed - r", "mixed + r"),
    ("mechanics.articulated:_less", "- mul(u[i], v[j])", "+ mul(u[i], v[j])"),
    ("mechanics.articulated:_Articulated._inwards", " + frame.offset.cross(force)", ""),
    ("mechanics.articulated:_Articulated._outwards", " + angular.cross(frame.offset)", ""),
    ("mechanics.factorisation:Elimination.backward", "value - factor * scalars[i]", "value + factor * scalars[i]"),
]


@pytest.mark.parametrize(("where", "right", "wrong"), ARTICULATED_MISTAKES)
def test_mistakes_in_the_solution_are_caught(
    monkeypatch: pytest.MonkeyPatch, where: str, right: str, wrong: str
) -> None:
    plant(monkeypatch, Mistake("", where, right, wrong, "", ()))
    with pytest.raises(AssertionError):
        check_routes(mbsym.load(next(path for path in SHIPPED if path.stem == "spatial-arm")), 3)
