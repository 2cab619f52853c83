"""Digits at the extremes: measured against known conditions, borders of stability against published thresholds."""

from __future__ import annotations

import csv
import io
import json
import re
from dataclasses import replace
from fractions import Fraction as F
from math import cos, isfinite, log10, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED, filed, invoked, system_of
from flint import Ordering, arb, ctx, fmpq, fmpq_mpoly_ctx
from jsonschema import Draft202012Validator

import mbsym
from mbsym.algebra.program import Program
from mbsym.algebra.roots import count_roots, rational
from mbsym.analysis import Analysis
from mbsym.expressions.tree import Number
from mbsym.mechanics.variables import ring_of
from mbsym.model.system import System
from mbsym.numerics.borders import BORDER, Judged, LinearModel
from mbsym.numerics.extremes.extremes import LISTED, extremes
from mbsym.numerics.extremes.extremes_told import _onward, sentences
from mbsym.numerics.extremes.singular import singularities
from mbsym.numerics.kernels.interface import FLOAT32, FLOAT64, Code
from mbsym.numerics.probes import RATIO, SINGULAR, ladders, ratios, scaled, scene_units, singular
from mbsym.numerics.scenario import changed, scenario
from mbsym.numerics.sequences import SEQUENCES, angles_of, orientation, rankings
from mbsym.numerics.trade.digits import FULL, Arithmetic, Quantity, Truth, compared, input_names, measured, quantities
from mbsym.problems.stability.exact import verdict_at
from mbsym.problems.stability.linear_form import LinearSystem
from mbsym.problems.stability.verdict import Verdict
from mbsym.problems.stability.words import Word
from mbsym.report.runs.extremes_tables import extremes_csv, extremes_json, tables
from mbsym.report.schemas import schema

ROOT = Path(__file__).parents[2]
HARD = json.loads((ROOT / "tests/references/hard_polynomials.json").read_text())["reference"]


def system(name: str) -> System:
    return system_of(ROOT / "systems" / f"{name}.yaml")


# --- digits ---


def test_digits_of_a_known_error() -> None:
    exact = [arb(1), arb(-4)]
    assert compared([1 + 4e-7, -4.0], exact, FULL[FLOAT64])[0] == pytest.approx(7, abs=0.01)
    assert compared([1 + 4e-7, -4.0], exact, FULL[FLOAT64])[1] == pytest.approx(-log10(4e-7), abs=0.01)
    assert compared([1.0, -4.0], exact, FULL[FLOAT64]) == (FULL[FLOAT64], FULL[FLOAT64])
    assert compared([float("nan"), -4.0], exact, FULL[FLOAT64]) == (0.0, 0.0)


def test_conditions_that_are_known() -> None:
    """theta'' = -(m g l sin(theta) + b theta')/(J + m l^2): M has the condition (|J| + 3 m l^2)/(J + m l^2)."""
    given = scenario(system("simple-pendulum"))
    ring = ring_of(given.system)
    found = quantities(given.system, ring)
    truth = Truth(given.system, found)
    p = {name: float(value) for name, value in given.parameters.items()}
    inertia = p["m"] * p["l"] ** 2
    expected = (p["J"] + 3 * inertia) / (p["J"] + inertia)
    assert truth.condition("mass matrix", given, F(0), given.state) == pytest.approx(expected, rel=1e-12)
    theta = float(given.positions[0])
    # forcing -m g l sin(theta) at rest: three factors, and theta cot(theta)
    expected = 3 + abs(theta * cos(theta) / np.sin(theta))
    assert truth.condition("forcing", given, F(0), given.state) == pytest.approx(expected, rel=1e-12)


def test_a_bad_formula_is_told_from_a_bad_question() -> None:
    """sqrt(1 + x^2) - cos(x) at 1e-6 loses 12 digits that the question (condition 2) does not: nothing rewrites it."""
    given = scenario(system("simple-pendulum"))
    program, names = Program(), input_names(given.system)
    x = program.input("theta")
    bad = program.square_root(program.one + x * x) - program.sin_cos_of(x)[1]
    touchy = program.sin_cos_of(x)[0]
    found = [Quantity("bad", Code(program, names, (bad,))), Quantity("touchy", Code(program, names, (touchy,)))]
    truth = Truth(given.system, found)
    for compiled in (True, False):
        arithmetic = Arithmetic(given, found, compiled)
        small = measured(truth, arithmetic, "bad", given, (F(1, 10**6), F(0)))
        assert small.condition == pytest.approx(2, rel=1e-6)
        assert small.formula < 5
        assert small.verdict == "formula"
        # sin near 710 pi: the argument's rounding is all that is lost
        far = measured(truth, arithmetic, "touchy", given, (F(223053, 100), F(0)))
        assert far.condition > 1e3
        assert far.formula > 15
        assert far.digits[FLOAT64] < 14
        assert far.verdict == "ill-conditioned"


def test_float32_and_float64_agree_with_balls_where_nothing_is_extreme() -> None:
    given = scenario(system("satellite"))
    found = quantities(given.system, ring_of(given.system))
    truth = Truth(given.system, found)
    arithmetic = Arithmetic(given, found)
    for q in found:
        digits = measured(truth, arithmetic, q.name, given, given.state)
        assert digits.verdict == "full", q.name
        assert digits.digits[FLOAT64] > 14
        assert digits.digits[FLOAT32] > 5.5


# --- probes ---


@pytest.mark.parametrize(
    ("name", "subjects"),
    [
        ("gravity-gradient", {"theta -> pi/2", "theta -> -pi/2"}),
        ("heavy-top", {"beta -> pi/2", "beta -> -pi/2"}),
        ("satellite", {"theta -> pi/2", "theta -> -pi/2", "sigma -> pi/2", "sigma -> -pi/2"}),
        ("spherical-pendulum", {"theta -> 0", "theta -> pi"}),
        ("spring-pendulum", {"r -> 0"}),
        ("double-pendulum", set()),
    ],
)
def test_singularities_of_the_coordinates_are_found(name: str, subjects: set[str]) -> None:
    given = scenario(system(name))
    found = quantities(given.system, ring_of(given.system), with_jacobian=False)
    units = scene_units(given, Truth(given.system, found))
    assert {ladder.subject for ladder in singular(given, singularities(given, {}), units)} == subjects


def test_scaling_a_parameter_moves_what_depends_on_it() -> None:
    given = scenario(system("satellite"))
    there = scaled(given, {}, "R", F(10) ** 6)
    assert there.parameters["R"] == given.parameters["R"] * 10**6
    assert there.parameters["nu"] == there.parameters["omega0"] ** 2 * there.parameters["R"] ** 3
    assert there.state == given.state


def test_ratios_leave_out_what_does_not_matter() -> None:
    given = scenario(system("satellite"))
    found = quantities(given.system, ring_of(given.system), with_jacobian=False)
    units = scene_units(given, Truth(given.system, found))
    every = ladders(given, {}, found, singularities(given, {}), units)
    subjects = {x.subject for x in every if x.kind == RATIO}
    assert subjects == {"R", "omega0", "m", "m0", "l", "r", "Jx", "Jy", "Jz"}  # M2 plays no part: O1 is prescribed


# --- borders of stability ---


def border(name: str, parameter: str, **values: F) -> list[tuple[float, str]]:
    """(value, words below/above) of the border of one parameter, and every verdict next to it."""
    overrides = {key: Number(value) for key, value in values.items()}
    given = scenario(system(name), overrides)
    model = LinearModel(Analysis(given.system))
    found = []
    for ladder in model.borders(given, dict(overrides)):
        if ladder.subject.startswith(f"{parameter} -> "):
            for probe in ladder.probes:
                judged = model.judged(probe.scenario)
                found.append((float(probe.scenario.parameters[parameter]), judged.exact.word))
    return found


def test_ziegler_with_vanishing_damping() -> None:
    """With b1 = b2 = b flutter begins at P l/k = 41/28 + b^2/2 (Kirillov & Verhulst): 1.464 even for b = 1e-8."""
    small = F(1, 10**8)
    rows = border("ziegler-damped", "P", b1=small, b2=small)
    threshold = 41 / 28 + 1e-16 / 2
    assert rows
    for value, word in rows:
        assert word == ("asymptotically stable" if value < threshold else "unstable")
    assert min(abs(value - threshold) for value, _ in rows) < 1e-13


def test_sleeping_top() -> None:
    """Omega^2 > 4 A m g l/C^2 (Maievskii): gyroscopic stabilisation, lost where two frequencies meet."""
    rows = border("heavy-top", "Omega")
    threshold = sqrt(4 * 0.3 * 9.81 * 0.5) / 0.1
    assert rows
    for value, word in rows:
        assert word == ("unstable" if value < threshold else "gyroscopically stabilised only")


def test_floats_are_wrong_where_frequencies_meet() -> None:
    """Next to a double eigenvalue float64 sees growth of 1e-8 where there is none; the exact verdict holds."""
    given = scenario(system("heavy-top"))
    model = LinearModel(Analysis(given.system))
    ladder = next(x for x in model.borders(given, {}) if x.subject.startswith("Omega") and x.subject.endswith("above"))
    nearest = ladder.probes[-1].scenario
    judged = model.judged(nearest)
    assert judged.exact.word == "gyroscopically stabilised only"
    assert judged.floats[FLOAT64] == Word.UNSTABLE
    assert judged.wrong(FLOAT64)
    digits = model.digits(nearest)["eigenvalues"]
    assert digits.digits[FLOAT64] < 11
    assert digits.condition > 1e5


def constant_system(m: Any, d: Any, g: Any, k: Any) -> LinearSystem:
    context = fmpq_mpoly_ctx.get(["x"], Ordering.degrevlex)
    n = len(m)
    rows = [tuple(tuple(context.constant(rational(e)) for e in row) for row in x) for x in (m, d, g, k)]
    zero = tuple(tuple(context.constant(0) for _ in range(n)) for _ in range(n))
    return LinearSystem(*rows, zero, conservative=True)


ONE = [[1, 0], [0, 1]]
NOTHING = [[0, 0], [0, 0]]


@pytest.mark.parametrize("exponent", [4, 8, 12, 14, 30])
def test_krein_collision(exponent: int) -> None:
    """x'' + g y' - k1 x = 0, y'' - g x' - k2 y = 0 is stable iff g > sqrt k1 + sqrt k2; k = (1, 4), border 3."""
    for sign, expected in ((1, "gyroscopically stabilised only"), (-1, Word.UNSTABLE)):
        g = 3 + sign * F(1, 10**exponent)
        found = verdict_at(constant_system(ONE, NOTHING, [[0, g], [-g, 0]], [[-1, 0], [0, -4]]), {})
        assert found.verdict.word == expected
    on_it = verdict_at(constant_system(ONE, NOTHING, [[0, 3], [-3, 0]], [[-1, 0], [0, -4]]), {})
    assert on_it.verdict.word == Word.UNDECIDED
    assert on_it.roots.imaginary_multiplicity == 2
    damped = [[F(1, 1000), 0], [0, F(1, 1000)]]
    kelvin = verdict_at(constant_system(ONE, damped, [[0, 10], [-10, 0]], [[-1, 0], [0, -4]]), {})
    assert kelvin.verdict.word == Word.UNSTABLE


def test_clohessy_wiltshire() -> None:
    """x'' - 2 n y' - 3 n^2 x = 0, y'' + 2 n x' = 0, z'' + n^2 z = 0: a double zero root, the drift along the orbit."""
    n = F(1, 900)
    system_ = constant_system(
        [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
        [[0] * 3] * 3,
        [[0, -2 * n, 0], [2 * n, 0, 0], [0, 0, 0]],
        [[-3 * n * n, 0, 0], [0, 0, 0], [0, 0, n * n]],
    )
    found = verdict_at(system_, {})
    assert found.verdict.word == Word.UNDECIDED
    assert (found.roots.zero, found.roots.imaginary, found.roots.right) == (2, 4, 0)


@pytest.mark.parametrize("case", HARD["routh"], ids=lambda case: case["why"] if "why" in case else str(case["coeffs"]))
def test_hard_polynomials(case: dict[str, Any]) -> None:
    found = count_roots(case["coeffs"][::-1])
    assert (found.right, found.imaginary) == (case["rhp"], case["imag"])
    if case["coeffs"] == [1, 0, 2, 0, 1]:
        assert found.imaginary_multiplicity == 2


def test_what_counts_as_a_wrong_verdict() -> None:
    def wrong(exact: str, said: str) -> bool:
        return Judged(Verdict(exact), {FLOAT64: said}).wrong(FLOAT64)

    assert wrong("unstable", "no growth seen")
    assert wrong("stable", "unstable")
    assert wrong("stable", "asymptotically stable")
    assert not wrong("undecided", "unstable")
    assert not wrong("unstable", "unstable")
    assert not wrong("stable", "no growth seen")
    assert not wrong("asymptotically stable", "no growth seen")


# --- the whole ---


@pytest.fixture(scope="module")
def whole() -> Any:
    given = scenario(system("gravity-gradient"))
    return extremes(given, ring_of(given.system), {}, budget=120)


def test_what_the_budget_leaves_out_is_said() -> None:
    """Without any time only the quantities are set up, and every ladder is named, as far as a line holds."""
    given = scenario(system("gravity-gradient"))
    found = extremes(given, ring_of(given.system), {}, budget=0)
    assert not found.rows
    assert not found.verdicts
    linear, late = found.left_out
    assert linear.startswith("linear equations, eigenvalues and verdicts:")
    assert "theta -> pi/2, theta -> -pi/2, rates" in late
    assert late.count(" times") == 5  # R, omega0, A, B and C; m drops out, and nu = R^3 omega0^2


def test_every_row_is_known_and_bounded(whole: Any) -> None:
    assert {row.quantity for row in whole.rows} >= {
        "mass matrix", "forcing", "accelerations", "pivots", "energy", "Jacobian", "M", "G", "K", "eigenvalues",
    }  # fmt: skip
    for row in whole.rows:
        assert row.digits.bits, (row.subject, row.quantity)
        for scalar, full in FULL.items():
            assert 0 <= row.digits.digits[scalar] <= full
        assert isfinite(row.digits.norm)


def test_near_the_singular_angle_only_the_question_costs_digits(whole: Any) -> None:
    """The accelerations grow like 1/distance: condition 1/distance, and float64 keeps 16 - log10(condition) digits."""
    rows = whole.of(SINGULAR, "theta -> pi/2", "accelerations")
    assert len(rows) == 13
    for row in rows:
        assert 0.1 / row.size < row.digits.condition < 100 / row.size
        assert row.digits.formula > 14
        assert row.digits.digits[FLOAT64] > FULL[FLOAT64] - log10(row.digits.condition) - 1
    assert rows[-1].digits.digits[FLOAT64] < 4
    assert rows[-1].digits.digits[FLOAT32] == 0


def test_borders_of_the_rigid_satellite(whole: Any) -> None:
    """A = 12, B = 9, C = 15: Lagrange's region C > A > B ends at A = B and at C = A."""
    found = {row.subject: row.judged.exact.word for row in whole.verdicts if row.kind == BORDER}
    assert found["A -> 9 from below"] == Word.UNSTABLE
    assert found["A -> 9 from above"] == "stable"
    assert found["C -> 12 from below"] == Word.UNSTABLE
    assert found["C -> 12 from above"] == "stable"


def test_sentences_and_tables_follow_the_rows(whole: Any) -> None:
    text = "\n".join(sentences(whole))
    assert (
        "The mass matrix is singular where theta = pi/2 or -pi/2, whatever else is: there the coordinates fail" in text
    )
    assert "The mass matrix is nowhere else singular: proved by" in text
    assert "A -> 9: a border of the first approximation, unstable below and stable above" in text
    rows = list(csv.reader(io.StringIO(extremes_csv(whole))))
    verdicts = {line["subject"]: line for line in csv.DictReader(io.StringIO(extremes_csv(whole)))}
    assert verdicts["A -> 9 from above"]["quantity"] == "stability"
    assert verdicts["A -> 9 from above"]["verdict"] == "stable"
    assert verdicts["A -> 9 from below"]["verdict"] == "unstable"
    assert len(rows) == 1 + len(whole.rows) + len(whole.verdicts)
    content = json.loads(extremes_json(whole))
    assert list(Draft202012Validator(schema("extremes")).iter_errors(content)) == []
    assert list(Draft202012Validator(schema("extremes")).iter_errors(content | {"rows": [{}]}))
    assert content["sentences"]
    assert len(content["rows"]) == len(whole.rows)
    shown = list(tables(whole))
    assert [columns[0] for columns, _ in shown] == ["extreme", "extreme"]


def told(text: str) -> tuple[Any, list[str]]:
    given = scenario(mbsym.loads(text).system)
    found = extremes(given, ring_of(given.system), {}, budget=60)
    return found, list(sentences(found, "arm.yaml"))


ELBOW = """
mbsym: 1
name: A massless elbow
bodies:
  - {name: upper, attached to: 0, rotation: {axes: [3], angles: [a]}, mass: 0}
  - {name: lower, attached to: upper, rotation: {axes: [3], angles: [b]}, connection point: [1, 0, 0],
     mass centre: [2, 0, 0], mass: 1}
initial: {a: 1, b: 1}
"""


def test_the_model_is_told_from_its_coordinates(whole: Any) -> None:
    """Stretched, a massless elbow moves without moving mass: no other coordinates are advised there."""
    found, lines = told(ELBOW)
    (line,) = (line for line in lines if "is singular where" in line)
    assert line.startswith("The mass matrix is singular where b = 0 or pi, whatever else is: there the model fails")
    assert "--sequences" not in "".join(lines)
    (advised,) = (line for line in sentences(whole, "sat.yaml") if "is singular where" in line)
    assert advised.endswith("mbsym extremes sat.yaml --sequences.")
    content = json.loads(extremes_json(found))
    assert list(Draft202012Validator(schema("extremes")).iter_errors(content)) == []
    assert [one["fails"] for one in content["singular"]["sets"]] == ["model"]
    assert content["singular"]["complete"]


def test_a_search_is_not_called_a_proof(whole: Any) -> None:
    searched = replace(whole.singularities, sets=(), complete=False, how="multiples of pi/12")
    text = "\n".join(sentences(replace(whole, singularities=searched)))
    assert "No singular configuration was found, which is no proof; searched were multiples of pi/12." in text
    assert "proved" not in text.split("Rates")[0]


@pytest.mark.parametrize("ratio", ["1", "1e-12", "1e12"])
def test_eigenvalues_are_enclosed(ratio: str) -> None:
    """The double pendulum at rest, by hand: l1 l2 m1 w^4 - (m1 + m2) g (l1 + l2) w^2 + (m1 + m2) g^2 = 0, w^2 > 0."""
    given = scenario(system("double-pendulum"), {"m1": Number(F(ratio))})
    found = extremes(given, ring_of(given.system), {}, budget=0.001)
    found = replace(found, eigenvalues=tuple(LinearModel(Analysis(given.system)).exact_eigenvalues(given) or ()))
    m1, g = F(ratio), F(981, 100)
    with ctx.workprec(300):
        a, b, c = (arb(fmpq(x.numerator, x.denominator)) for x in (m1, (m1 + 1) * g * 2, (m1 + 1) * g * g))
        root = (b * b - 4 * a * c).sqrt()
        squares = [(b - root) / (2 * a), (b + root) / (2 * a)]
        upper = sorted((x.imag for x in found.eigenvalues if x.imag > 0), key=lambda x: float(x.mid()))
        assert len(upper) == 2
        for x, square in zip(upper, squares, strict=True):
            assert (x * x).overlaps(square)
            assert x.rel_accuracy_bits() > 150
    assert "in proved enclosures" in "\n".join(sentences(found))


def test_advice_ends_in_a_command(whole: Any) -> None:
    """Where a formula loses digits, the parameter's exact value stands in the command."""
    given = scenario(system("double-pendulum"))
    lines = list(sentences(extremes(given, ring_of(given.system), {}, budget=60), "two.yaml"))
    (line,) = (line for line in lines if line.startswith("l2 times"))
    assert line.endswith("mbsym extremes two.yaml --set l2=1000000000000.")


# --- sequences ---


def test_angles_of_every_sequence() -> None:
    source = np.random.default_rng(1)
    for axes in SEQUENCES:
        r = orientation(axes, source.uniform(-3, 3, 3))
        assert abs(np.linalg.det(r) - 1) < 1e-12
        for other in SEQUENCES:
            assert np.allclose(orientation(other, angles_of(other, r)), r, atol=1e-12)


def test_sequences_are_ranked_by_distance() -> None:
    given = scenario(system("gravity-gradient"))
    states = [[1e-3, 1.5, 2e-3, 0, 0, 0]]  # theta near pi/2: the sequence 2, 3, 1 is nearly singular there
    (ranking,) = rankings(given, states, lambda text: None)
    by_axes = {a.text: a for a in ranking.alternatives}
    assert len(by_axes) == 12
    assert by_axes["231"].own
    assert by_axes["231"].distance == pytest.approx(cos(1.5), rel=1e-9)
    best = ranking.alternatives[0]
    assert best.distance > 0.9
    assert not best.own
    assert by_axes["231"].pivot < 0.02 < best.pivot
    assert "231" in ranking.sentence
    assert best.text in ranking.sentence


# --- the command ---


def test_the_command_writes_everything(tmp_path: Path) -> None:
    done = invoked("extremes", ROOT / "systems/simple-pendulum.yaml", "--out", tmp_path, code=0)
    names = {"extremes.csv", "extremes.json", "extremes.svg", "extremes.png", ".mbsym.json"}
    assert {path.name for path in tmp_path.iterdir()} == names
    assert "Rates from 1e-8 to 1e8" in done.output


@pytest.mark.parametrize("width", [80, 110])
def test_numbers_stay_whole_on_a_narrow_terminal(whole: Any, width: int) -> None:
    """A table that is too wide goes on beneath, with the names of its rows in front again."""
    from mbsym.report.plain_writer import Writer
    from mbsym.studies.extremes import digits

    for columns, rows in tables(whole):
        lines = [line.text for line in Writer(width=width).block(digits(columns, rows))]
        assert max(map(len, lines)) <= width
        for row in rows:
            cells = [cell for cell in row[1 : len(columns) - (columns[-1] == "first approximation")] if cell]
            assert all(any(re.search(rf"(^|\s){re.escape(cell)}(\s|$)", line) for line in lines) for cell in cells)


def test_without_a_terminal_every_row_is_one_line(tmp_path: Path) -> None:
    done = invoked("extremes", ROOT / "systems/simple-pendulum.yaml", "--out", tmp_path)
    rows = [line for line in done.output.splitlines() if "times 1e-12 to 1e12" in line]
    assert rows
    assert all(re.search(r"\d+\*? / \d+", line) for line in rows)
    assert "…" not in done.output


def test_missing_values_are_listed(tmp_path: Path) -> None:
    text = (ROOT / "systems/simple-pendulum.yaml").read_text(encoding="utf-8")
    bare = filed(
        tmp_path / "bare.yaml", "".join(x for x in text.splitlines(True) if not x.startswith(("values:", "initial:")))
    )
    done = invoked("extremes", bare, "--out", tmp_path / "out", "--set", "g=9", code=2)
    assert "no value for m, l, J, b, theta (its initial position)" in done.output
    assert not (tmp_path / "out").exists()


def test_a_wrong_budget_is_refused(tmp_path: Path) -> None:
    done = invoked(
        "extremes", ROOT / "systems/simple-pendulum.yaml", "--out", tmp_path, "--budget", "0", "--set", "x=1"
    )
    assert done.exit_code == 2
    assert "2 errors" in done.output


def test_sequences_on_the_command_line() -> None:
    done = invoked("extremes", ROOT / "systems/gravity-gradient.yaml", "--sequences", code=0)
    assert "is best" in done.output
    assert "in the description" in done.output
    none = invoked("extremes", ROOT / "systems/double-pendulum.yaml", "--sequences", code=0)
    assert "no body" in none.output


def subjects(text: str, name: str) -> list[str]:
    given = scenario(mbsym.loads(text).system)
    model = LinearModel(Analysis(given.system))
    return [x.subject for x in model.borders(given, {}) if x.subject.startswith(f"{name} -> ")]


PAIR = """
mbsym: 1
name: Two oscillators and a damper between them
parameters: {m: 1, k1: 1, k2: 1, d: 1}
bodies:
  - {name: p, attached to: 0, connection point: [x, y, 0], coordinates: [x, y], mass: m}
loads:
  - spring: {coordinate: x, stiffness: k1}
  - spring: {coordinate: y, stiffness: k2}
  - rayleigh: d*(x_dot - y_dot)**2/2
motion: {x: 0, y: 0}
initial: {x: 1, y: 0}
"""
INSIDE = """
mbsym: 1
name: One way
parameters: {m: 1, k: 1, a: 6/5, c: 1, h: 1497/997 - 6/5}
bodies:
  - {name: p, attached to: 0, connection point: [x, y, 0], coordinates: [x, y], mass: m}
loads:
  - generalized force: {x: -(k - a)*x - c*y, y: -h*y}
motion: {x: 0, y: 0}
initial: {x: 1, y: 0}
"""


def test_a_single_point_is_no_border() -> None:
    """PAIR: without friction only where k1 = k2, in the mode x = y; asymptotically stable on both sides of that.

    INSIDE: lambda^2 = a - k or -h: unstable for k < a; they coincide at k = a + h, 3/2 times the first trial.
    """
    assert mbsym.loads(PAIR).stability.numerical.word.startswith("stable")
    assert subjects(PAIR, "k1") == []
    assert subjects(INSIDE, "k") == ["k -> 1.2 from below", "k -> 1.2 from above"]


def test_late_ladders_beyond_a_line_are_counted() -> None:
    given = scenario(mbsym.load(SHIPPED / "satellite.yaml").system)
    ring = ring_of(given.system)
    late = extremes(given, ring, {}, budget=0).left_out[-1].partition(": ")[2].split(", ")
    every = quantities(given.system, ring)
    units = scene_units(given, Truth(given.system, every))
    number = len(list(ladders(given, {}, every, singularities(given, {}), units)))
    assert number > LISTED + 1 == len(late)
    assert late[-1] == f"and {number - LISTED} more"


# --- conditions without units ---


def test_the_condition_of_eigenvalues_has_no_unit() -> None:
    """m = 1, K = diag(k, 3 k), M = [[1, 1], [1, 1 + e^2]]: lambda^2 = -k/m times a function of e, of degree -2 near 0.

    So an eigenvalue moves by at most (1/2 + 1/2 + 1) of the parts by which m, k and e do; what float64 loses where it
    forms 1 + e^2 is the formula's.  And other units of length and mass change nothing.
    """
    path = Path(__file__).parents[1] / "cases" / "statements" / "nearsing.yaml"
    given = scenario(mbsym.load(path).system)
    model = LinearModel(Analysis(given.system))
    found = model.digits(given)["eigenvalues"]
    assert found.condition == pytest.approx(2, rel=1e-3)
    assert found.digits[FLOAT64] < 6
    assert found.verdict == "formula"
    grams = model.digits(changed(given, m=given.parameters["m"] * 1000, k=given.parameters["k"] * 1000))["eigenvalues"]
    assert grams.condition == pytest.approx(found.condition, rel=1e-9)


def test_values_beyond_assumptions_have_digits_and_no_verdict() -> None:
    """A times 1e12 breaks B + C > A: numbers do not care, and a verdict might stand on the assumption."""
    given = scenario(system("gravity-gradient"))
    every = quantities(given.system, ring_of(given.system))
    probes = list(ratios(given, {}, every, scene_units(given, Truth(given.system, every))))
    own = {probe.size: probe.assumed for ladder in probes if ladder.subject == "A" for probe in ladder.probes}
    assert own == {1e-12: False, 1e-6: False, 1e6: False, 1e12: False}
    assert all(probe.assumed for ladder in probes if ladder.subject == "R" for probe in ladder.probes)


def test_places_where_something_is_lost() -> None:
    assert _onward([1e-2, 1e-4, 1e-6], [1e-4, 1e-6]) == "from 1e-04 on"
    assert _onward([1e-2, 1e-4, 1e-6], [1e-4]) == "at 1e-04"
    assert _onward([1e-2, 1e-4, 1e-6], [1e-2, 1e-6]) == "at 1e-02, 1e-06"


def test_a_ladder_that_was_cut_short_is_not_said_to_be_whole(whole: Any) -> None:
    """Two rungs of four: the sentence names the two, and a border is as near as it was looked at on both sides."""
    kept = [row for row in whole.rows if not (row.kind == RATIO and row.size < 1)]
    said = "\n".join(sentences(replace(whole, rows=tuple(kept))))
    assert "times 1e+06, 1e+12: float64 keeps" in said
    assert "1e-12" not in "\n".join(line for line in said.splitlines() if "of everything" in line)
    borders = [row for row in whole.verdicts if not (row.subject == "A -> 9 from above" and row.size < 1e-6)]
    said = "\n".join(sentences(replace(whole, verdicts=tuple(borders))))
    assert (
        "A -> 9: a border of the first approximation, unstable below and stable above, "
        "decided exactly down to a distance of 1e-06" in said
    )
