"""Constraints against textbooks: ranks, redundancy, Frobenius, equations without multipliers; planted mistakes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from conftest import system_of

import mbsym
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.analysis.constrained import programs_of
from mbsym.analysis.pipeline import Analysis
from mbsym.formulas.formula import Matrix, column
from mbsym.mechanics.constraints.ranks import eliminated
from mbsym.mechanics.constraints.states import Manifold
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.variables import ring_environment, ring_of
from mbsym.problems.checks import EXACT, FAILED, NUMERICAL
from mbsym.problems.constraints import analysis as analysis_module
from mbsym.problems.constraints.analysis import faults
from mbsym.problems.constraints.checks import check_embedded, check_rows
from mbsym.problems.constraints.integrability import by_program
from mbsym.problems.constraints.motion import Embedded
from mbsym.problems.constraints.result import Constraints

SLEIGH = """
mbsym: 1
name: Chaplygin sleigh
parameters: {m: positive, J: positive, a: positive}
bodies:
  - {name: sleigh, attached to: 0, rotation: {axes: [3], angles: [theta]}, connection point: [x, y, 0],
     mass centre: [a, 0, 0], mass: m, inertia about: mass centre, inertia: [0, 0, J], coordinates: [x, y, theta]}
constraints:
  - velocity: x_dot*sin(theta) - y_dot*cos(theta) = 0
"""

SPHERE = """
mbsym: 1
name: Sphere on a plane
parameters: {m: positive, r: positive, J: positive, g: positive}
bodies:
  - {name: ball, attached to: 0, rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}, connection point: [x, y, z],
     mass: m, inertia about: joint, inertia: [J, J, J], coordinates: [x, y, z, psi, theta, phi]}
loads: [{uniform gravity: {vector: [0, 0, -g]}}]
constraints:
  - relation: z = r
  - rolling: {body: ball, point: [0, 0, -r], axes: 0, on: ground}
"""

PENDULUM = """
mbsym: 1
name: Pendulum in Cartesian coordinates
parameters: {m: positive, l: positive, g: positive}
bodies:
  - {name: bob, attached to: 0, connection point: [x, y, 0], mass: m, coordinates: [x, y]}
loads: [{uniform gravity: {vector: [0, -g, 0]}}]
constraints: [{relation: x**2 + y**2 = l**2}]
"""

FREE = """
mbsym: 1
name: Three coordinates
parameters: {m: positive, a: positive, Om: positive}
prescribed: {s: {rate: Om}}
bodies:
  - {name: a, attached to: 0, connection point: [x, y, z], mass: m, coordinates: [x, y, z]}
constraints:
"""


def analysed(text: str) -> Analysis:
    return mbsym.loads(text, (1, 2, 3))


def integrability(*constraints: str) -> tuple[str, tuple[int, ...], Certainty]:
    found = analysed(FREE + "\n".join(f"  - {one}" for one in constraints)).constraints.integrability
    assert found is not None
    return found.word, found.growth, found.certainty


# --- Frobenius, on Pfaffian forms of textbooks ---


@pytest.mark.parametrize(
    ("constraint", "word", "growth"),
    [
        ("velocity: x*x_dot + y*y_dot = 0", "holonomic", (2, 2)),  # x^2 + y^2 is kept
        ("velocity: y*z*x_dot + x*z*y_dot + x*y*z_dot = 0", "holonomic", (2, 2)),  # x y z is kept
        ("velocity: y*x_dot - x*y_dot = 0", "holonomic", (2, 2)),  # x/y: only an integrating factor makes it exact
        ("velocity: z_dot = y*x_dot", "nonholonomic", (2, 3)),  # the contact form
        ("velocity: z_dot = x*y_dot - y*x_dot", "nonholonomic", (2, 3)),  # Heisenberg
        ("velocity: x_dot = Om*sin(s)*a", "holonomic", (3, 3)),  # x + a cos s is kept
        ("velocity: x_dot = y", "nonholonomic", (3, 4)),
        ("velocity: x_dot = a*t", "holonomic", (3, 3)),  # x - a t^2/2 is kept
    ],
)
def test_frobenius_decides_one_form(constraint: str, word: str, growth: tuple[int, ...]) -> None:
    assert integrability(constraint) == (word, growth, Certainty.PROVED)


@pytest.mark.parametrize(
    ("constraint", "exact"),
    [
        ("velocity: y*x_dot = x*y_dot", True),
        ("velocity: z_dot = y*x_dot", False),
        ("velocity: x_dot = Om*sin(s)*a", True),
        ("velocity: x_dot = y", False),  # dx - y dt
    ],
)
def test_a_form_by_itself(constraint: str, exact: bool) -> None:
    (found,) = analysed(FREE + f"  - {constraint}").constraints.alone
    assert found[1] is exact


def test_rows_that_are_not_integrable_by_themselves_may_be_together() -> None:
    """dz = y dx is not, dy = 0 is; both together keep y and z - y x."""
    found = analysed(FREE + "  - velocity: z_dot = y*x_dot\n  - velocity: y_dot = 0").constraints
    assert [decided for _, decided in found.alone] == [False, True]
    assert found.integrability is not None
    assert found.integrability.word == "holonomic"


def test_two_forms_may_be_integrable_together_and_in_part() -> None:
    # dz = y dx alone is not integrable; with dy = 0 it is, and y, z - y x are kept.
    assert integrability("velocity: z_dot = y*x_dot", "velocity: y_dot = 0")[0] == "holonomic"
    text = FREE.replace(
        "[x, y, z], mass: m, coordinates: [x, y, z]}",
        "[x, y, z], mass: m, coordinates: [x, y, z]}\n"
        "  - {name: b, attached to: a, connection point: [w, 0, 0], mass: m, coordinates: [w]}",
    )
    found = analysed(text + "  - velocity: z_dot = y*x_dot\n  - velocity: w_dot = 2*w*x_dot*x").constraints
    assert found.integrability is not None
    # w exp(-x^2) is kept, the contact form keeps nothing: growth 2, 3 in 4 dimensions.
    assert (found.integrability.word, found.integrability.growth[:2], found.integrability.kept) == ("partly", (2, 3), 1)
    assert found.integrability.certainty is not Certainty.UNDECIDED


@pytest.mark.parametrize("text", [SLEIGH, SPHERE, FREE + "  - velocity: z_dot = x*y_dot - y*x_dot"])
def test_brackets_of_programs_span_what_brackets_of_formulas_do(text: str) -> None:
    analysis = analysed(text)
    found, programs = analysis.constraints, programs_of(analysis)
    manifold = Manifold(analysis.system, analysis.ring, programs)
    states = [one.state for one in manifold.states(2)]
    assert by_program(found.coordinates, programs, found.pivots, found.position_rank, states) == found.integrability


def test_programs_say_nothing_where_brackets_do_not_span_all() -> None:
    analysis = analysed(FREE + "  - velocity: y*x_dot = x*y_dot")
    found, programs = analysis.constraints, programs_of(analysis)
    states = [one.state for one in Manifold(analysis.system, analysis.ring, programs).states(2)]
    assert by_program(found.coordinates, programs, found.pivots, found.position_rank, states) is None


def test_the_bicycle_is_nonholonomic() -> None:
    """Its formulas are too long for the ring: brackets of brackets reach all seven dimensions of configurations."""
    found = mbsym.load(Path(__file__).parents[2] / "systems" / "bicycle.yaml", (1,)).constraints
    assert (found.position_rank, found.velocity_rank, len(found.free)) == (1, 5, 3)
    assert found.integrability is not None
    assert (found.integrability.word, found.integrability.growth[-1]) == ("nonholonomic", 7)
    assert found.integrability.certainty is Certainty.PROVED


# --- ranks and counts ---


def test_the_rows_of_a_rolling_sphere_and_what_follows_from_its_height() -> None:
    found = analysed(SPHERE).constraints
    assert (found.position_rank, found.velocity_rank, len(found.free)) == (1, 3, 3)
    (redundant,) = found.redundant
    assert redundant.name.label == "rolling 2, component 3"
    assert [one.label for one in redundant.from_rows] == ["relation 1"]
    assert redundant.certainty is Certainty.PROVED
    assert found.integrability is not None
    # Neimark & Fufaev: the sphere's velocities reach all five dimensions with the first brackets.
    assert (found.integrability.word, found.integrability.growth) == ("nonholonomic", (3, 5))


def test_without_the_height_a_rolling_sphere_keeps_it_all_the_same() -> None:
    """The vertical row z' = 0 is integrable, the others are not: partly, one relation is kept."""
    found = analysed(SPHERE.replace("  - relation: z = r\n", "")).constraints
    assert found.integrability is not None
    assert (found.position_rank, found.velocity_rank) == (0, 3)
    assert (found.integrability.word, found.integrability.kept) == ("partly", 1)


# --- equations without multipliers, against books ---


def polynomials(matrix: Matrix) -> list[list[Polynomial]]:
    return [[x.polynomial for x in row] for row in matrix]


def test_the_sleigh_of_chaplygin() -> None:
    """With v = x' cos + y' sin:  v' = a theta'^2,  (J + m a^2) theta'' = -m a v theta'  (Neimark & Fufaev)."""
    analysis = analysed(SLEIGH + "dependent: [y]\n")
    embedded, ring = analysis.equations.embedded, analysis.ring
    assert embedded is not None
    cosine = ring.generator("cosine", "theta")
    speed, rate = ring.generator("velocity", "x"), ring.generator("velocity", "theta")
    m, a, moment = (ring.generator("parameter", name) for name in ("m", "a", "J"))
    matrix, forcing = polynomials(embedded.mass_matrix), [x.polynomial for x in embedded.forcing]
    # On the constraint x' = v cos theta: x'' = v' cos - v sin theta' and m v' = m a theta'^2.
    inverse = ring.reciprocal(cosine)
    v = ring.reduce(speed * inverse)
    acceleration = a * rate**2 * cosine - v * ring.generator("sine", "theta") * rate
    assert ring.is_zero(matrix[0][0] * acceleration - forcing[0]) is True
    assert ring.is_zero(matrix[0][1]) is True
    assert ring.is_zero(matrix[1][1] - (moment + m * a**2)) is True
    assert ring.is_zero(forcing[1] + m * a * v * rate) is True


def test_the_pendulum_in_cartesian_coordinates_is_the_pendulum() -> None:
    """With x = l sin q, y = -l cos q:  M u' = f for u = x' is q'' = -(g/l) sin q."""
    embedded, ring = (analysis := analysed(PENDULUM)).equations.embedded, analysis.ring
    assert embedded is not None
    x, y, u = ring.generator("coordinate", "x"), ring.generator("coordinate", "y"), ring.generator("velocity", "x")
    length, g = (ring.generator("parameter", name) for name in ("l", "g"))
    # q' = -u/y, and so x'' = -(g/l)(x/l)(-y) - (u/y)^2 x, on x^2 + y^2 = l^2.
    inverse = ring.reciprocal(y)
    acceleration = ring.reciprocal(length) ** 2 * g * x * y - u**2 * inverse**2 * x
    residual = embedded.mass_matrix[0, 0].polynomial * acceleration - embedded.forcing[0].polynomial
    on_circle = ring.substitute(
        ring.reduce(residual), {ring.index("coordinate", "x"): ring.square_root(length**2 - y**2)}
    )
    assert ring.is_zero(on_circle) is True


def test_a_sphere_rolls_on_a_plane_with_a_constant_spin() -> None:
    """omega is constant in inertial axes (no friction of rolling): T restricted is homogeneous and nothing works."""
    analysis = analysed(SPHERE)
    outcomes = {check.name: check.outcome for check in analysis.checks}
    assert outcomes["constraints"] == outcomes["constrained motion"] == EXACT
    embedded, ring = analysis.equations.embedded, analysis.ring
    assert embedded is not None
    sine, cosine = ring.generator("sine", "theta"), ring.generator("cosine", "theta")
    psi, theta, phi = (ring.generator("velocity", name) for name in ("psi", "theta", "phi"))
    # psi' + phi' cos theta, the vertical spin, is constant:  J (psi'' + phi'' cos) = J phi' theta' sin.
    row, right = [x.polynomial for x in next(iter(embedded.mass_matrix))], embedded.forcing[0].polynomial
    moment = ring.generator("parameter", "J")
    assert ring.is_zero(row[0] - moment) is True
    assert ring.is_zero(row[2] - moment * cosine) is True
    assert ring.is_zero(right - moment * phi * theta * sine) is True
    assert psi


# --- the self-check, and planted mistakes ---


def checks(analysis: Analysis, tied: Constraints, embedded: Embedded) -> tuple[str, str]:
    programs = programs_of(analysis)
    return (
        check_rows(analysis.form, tied, programs).outcome,
        check_embedded(analysis.form, tied, embedded, programs).outcome,
    )


def with_entry(ring: Ring, values: Any, k: int, change: Callable[[Polynomial], Polynomial]) -> Any:
    changed = [x.polynomial for x in values]
    changed[k] = change(changed[k])
    return column(ring, changed)


@pytest.mark.parametrize("text", [SLEIGH, SPHERE])
def test_planted_mistakes_are_found(text: str) -> None:
    analysis = analysed(text)
    ring, found = analysis.ring, analysis.equations
    tied, embedded = found.constraints, found.embedded
    assert tied is not None
    assert tied.solved is not None
    assert embedded is not None
    assert checks(analysis, tied, embedded) == (EXACT, EXACT)
    k = len(tied.names) - 2 if len(tied.names) > 1 else 0
    # A forgotten J' q': gamma = 0.
    forgotten = replace(tied, acceleration=with_entry(ring, tied.acceleration, k, lambda _: ring.zero))
    assert checks(analysis, forgotten, embedded)[0] == FAILED
    # The same in the accelerations of the embedding.
    place = next(i for i, x in enumerate(tied.solved.acceleration_shift) if not x.is_zero)
    lost = replace(
        tied,
        solved=replace(
            tied.solved, acceleration_shift=with_entry(ring, tied.solved.acceleration_shift, place, lambda _: ring.zero)
        ),
    )
    assert checks(analysis, lost, embedded)[1] == FAILED
    # A sign in J, a sign in Y, a sign in the right-hand side.
    rows = polynomials(tied.jacobian)
    column_ = next(j for j, x in enumerate(rows[k]) if x)
    rows[k][column_] = -rows[k][column_]
    assert checks(analysis, replace(tied, jacobian=Matrix.of(ring, rows)), embedded)[0] == FAILED
    basis = polynomials(tied.solved.transformation)
    i, j = next((i, j) for i, row in enumerate(basis) for j, x in enumerate(row) if x and not x.is_constant())
    basis[i][j] = -basis[i][j]
    assert checks(
        analysis, replace(tied, solved=replace(tied.solved, transformation=Matrix.of(ring, basis))), embedded
    ) == (FAILED, FAILED)
    first = next(i for i, x in enumerate(embedded.forcing) if not x.is_zero)
    turned = replace(embedded, forcing=with_entry(ring, embedded.forcing, first, lambda x: -x))
    assert checks(analysis, tied, turned)[1] == FAILED


def test_a_forgotten_shift_is_found() -> None:
    """j of x' + ... = j(q, t): without it velocities do not keep the constraint."""
    analysis = analysed(FREE + "  - velocity: x_dot = y*z_dot + Om*sin(s)*a")
    tied, ring = analysis.equations.constraints, analysis.ring
    assert tied is not None
    assert tied.velocity[0].polynomial
    wrong = replace(
        tied,
        velocity=column(
            ring, [ring.substitute(tied.velocity[0].polynomial, {ring.index("parameter", "Om"): ring.zero})]
        ),
    )
    assert analysis.equations.embedded is not None
    assert checks(analysis, tied, analysis.equations.embedded) == (EXACT, EXACT)
    assert checks(analysis, wrong, analysis.equations.embedded)[0] == FAILED


def test_where_places_are_irrational_enclosures_are_compared() -> None:
    outcomes = {check.name: check.outcome for check in analysed(PENDULUM).checks}
    assert outcomes["constraints"] == outcomes["constrained motion"] == NUMERICAL


# --- what cannot be meant ---


def complaints(*constraints: str, more: str = "") -> str:
    with pytest.raises(mbsym.DescriptionError) as refused:
        analysed(FREE + "\n".join(f"  - {one}" for one in constraints) + f"\n{more}")
    return str(refused.value)


def test_constraints_that_contradict_are_complained_about_with_places() -> None:
    told = complaints("relation: x + y = a", "relation: x + y - 1 = a", "relation: z = 0")
    assert "<string>:9:5: error[contradictory-constraints]" in told
    assert "<string>:10:5: error[contradictory-constraints]" in told
    assert ":11:" not in told
    told = complaints("relation: x = a", "velocity: x_dot = Om*a")
    assert "<string>:10:5: error[contradictory-constraints]: this contradicts the other constraints" in told


def test_what_nothing_moves_is_complained_about() -> None:
    told = complaints("distance: {between: [{body: a, point: [1, 0, 0]}, {body: a, point: [0, 0, 0]}], length: 1}")
    assert "error[same-body]" in told
    rigid = FREE.replace(
        "constraints:", "  - {name: b, attached to: a, mass: m, connection point: [1, 0, 0]}\nconstraints:"
    )
    with pytest.raises(mbsym.DescriptionError, match="10:5: error\\[rigid-constraint\\]"):
        analysed(rigid + "  - coincide: [{body: a, point: [1, 0, 0]}, {body: b, point: [0, 0, 0]}]")


def test_what_planar_motion_keeps_is_to_be_left_out() -> None:
    """Axes of two bars of a planar linkage are parallel anyway; without the row it is the linkage that was meant."""
    bar = "rotation: {axes: [3], angles: [ANGLE]}, mass: m, mass centre: [1, 0, 0]"
    bars = f"  - {{name: b, attached to: a, {bar}}}\n  - {{name: c, attached to: 0, {bar}}}\nconstraints:"
    bars = bars.replace("ANGLE", "q1", 1).replace("ANGLE", "q2", 1)
    text = (
        FREE.replace("constraints:", bars) + "  - parallel: [{body: b, axis: [0, 0, 1]}, {body: c, axis: [0, 0, 1]}]\n"
    )
    with pytest.raises(mbsym.DescriptionError) as refused:
        analysed(text)
    assert "error[rigid-constraint]" in str(refused.value)
    assert "hint: leave it out: it holds wherever they are" in str(refused.value)
    tied = "  - relation: q1 = q2\n"
    assert analysed(text[: text.index("  - parallel")] + tied).constraints.position_rank == 1


def test_a_dependent_set_must_be_right() -> None:
    assert "1 of 3 velocities depends on the others, and 'dependent' names 2" in complaints(
        "relation: x = y", more="dependent: [x, y]"
    )
    told = complaints("relation: x = y", more="dependent: [z]")
    assert "10:1: error[dependent-set]: the constraints cannot be solved for the velocities of z" in told
    assert "hint: for example dependent: [y]" in told
    assert analysed(FREE + "  - relation: x = y\ndependent: [x]").constraints.dependent == ("x",)


def test_lengths_that_must_agree_are_told() -> None:
    found = analysed(FREE + "  - relation: x = a\n  - relation: x = Om*a").constraints
    assert (found.position_rank, found.demanded.count) == (1, 1)


def test_loops_apart_are_solved_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    """Twelve four-bars: two of three columns in each, not twenty-four of thirty-six, of which there are 10^9."""
    bodies, ties = [], []
    bar = "  - {{name: {0}, attached to: {1}, connection point: [{2}, 0, 0], "
    bar += "rotation: {{axes: [3], angles: [{3}]}}, mass: 1}}"
    for k in range(12):
        bodies += [
            bar.format(f"A{k}", 0, 9 * k, f"p{k}"),
            bar.format(f"B{k}", f"A{k}", 1, f"q{k}"),
            bar.format(f"C{k}", 0, 9 * k + 2, f"r{k}"),
        ]
        ties.append(f"  - coincide: [{{body: B{k}, point: [2, 0, 0]}}, {{body: C{k}, point: [3/2, 0, 0]}}]")
    system = system_of("\n".join(["mbsym: 1", "name: loops", "bodies:", *bodies, "constraints:", *ties]))
    tried = 0
    plain = analysis_module.eliminated

    def counted(*given: Any) -> Any:
        nonlocal tried
        tried += 1
        assert tried < 200
        return plain(*given)

    monkeypatch.setattr(analysis_module, "eliminated", counted)
    ring = ring_of(system)
    assert faults(Scene(system, ring, ring_environment(system, ring), ring)) == ()


def test_rows_with_few_entries_are_eliminated_in_few_products() -> None:
    """n loops that do not touch one another, x_k + 2 y_k = 0, 3 x_k + 4 y_k = 5 z_k: as many products each, however
    many there are.

    By hand: 3 quotients make the first row's pivot 1 (all 3 n columns are divided), its 2 entries go off the second;
    then 3 n quotients more, whose 2 entries go off the first.
    """
    products = 0

    class Counted(Fraction):
        def __mul__(self, other: Any) -> Counted:
            nonlocal products
            products += 1
            return Counted(Fraction(self) * Fraction(other))

        def __sub__(self, other: Any) -> Counted:
            return Counted(Fraction(self) - Fraction(other))

        def __truediv__(self, other: Any) -> Counted:
            return Counted(Fraction(self) / Fraction(other))

    for loops in (1, 8):
        products = 0
        rows = [[Counted(0)] * 3 * loops for _ in range(2 * loops)]
        for k in range(loops):
            rows[2 * k][3 * k : 3 * k + 2] = [Counted(1), Counted(2)]
            rows[2 * k + 1][3 * k : 3 * k + 3] = [Counted(3), Counted(4), Counted(-5)]
        done = eliminated(rows, range(3 * loops))
        assert products == 4 * loops
        assert done.columns == tuple(column for k in range(loops) for column in (3 * k, 3 * k + 1))
        assert done.rows[2 * loops - 2][3 * loops - 3 :] == (1, 0, -5)  # x = 5 z, y = -5/2 z
        assert done.rows[2 * loops - 1][3 * loops - 3 :] == (0, 1, Fraction(5, 2))


# --- what does not know constraints says so ---


def test_what_does_not_know_constraints_has_no_result() -> None:
    analysis = mbsym.loads(PENDULUM)
    stage = analysis.stage_of("programs")
    assert stage.failure is not None
    assert "relation 1" in stage.failure.reason
