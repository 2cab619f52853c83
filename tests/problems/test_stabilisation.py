"""Problem 8: degrees of instability, pervasive damping, controllability and feedback, on systems solved by hand."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from fractions import Fraction as F
from typing import Any

import hypothesis
import numpy as np
import pytest
from conftest import SHIPPED, system_of
from flint import fmpq, fmpq_mat
from hypothesis import given
from hypothesis import strategies as st
from jsonschema import Draft202012Validator
from properties import settings
from terminal import told

import mbsym
from mbsym.algebra.certainty import Certainty
from mbsym.analysis import Analysis, Unavailable
from mbsym.problems.checks import EXACT
from mbsym.problems.stabilisation import numbers
from mbsym.problems.stabilisation.checks import check_stabilisation
from mbsym.problems.stabilisation.numbers import AtValues
from mbsym.problems.stabilisation.result import Locus, Stabilisation
from mbsym.report.language import Language
from mbsym.report.plain_writer import Writer
from mbsym.report.results_json import results
from mbsym.report.schemas import schema
from mbsym.report.words.stabilisation_words import FEEDBACK, LYAPUNOV, sentences


def analysed(matrices: str, parameters: str = "{}", more: str = "") -> Analysis:
    text = f"mbsym: 1\nname: Given\nparameters: {parameters}\n{more}\nlinear system: {matrices}\n"
    system = system_of(text)
    return Analysis(system)


def found(matrices: str, parameters: str = "{}", more: str = "") -> Stabilisation:
    analysis = analysed(matrices, parameters, more)
    result = analysis.stabilisation
    check = analysis.check("stabilisation")
    assert check is not None
    assert check.outcome == EXACT, check.detail
    return result


def texts(formulas: Any) -> set[str]:
    return {str(x) for x in formulas}


TWO = "{k1: positive, k2: positive, m1: positive, m2: positive, c: positive, k: positive}"
#: Two masses, each on a spring to the wall, with a spring between them.
PAIR = "coordinates: [x, y], M: [[m1, 0], [0, m2]], K: [[k1 + k, -k], [-k, k2 + k]]"


# --- gyroscopic forces ---


def test_the_degree_of_instability_by_regions() -> None:
    """K = diag(a, b): as many negative eigenvalues as a and b are negative."""
    (part,) = found("{coordinates: [x, y], G: [[0, 1], [-1, 0]], K: [[a, 0], [0, b]]}", "{a: real, b: real}").gyroscopic
    seen = {tuple(sorted((str(x), sign) for x, sign in region.signs)): region.degree for region in part.regions}
    assert seen == {
        (("a", ">"), ("b", ">")): 0,
        (("a", ">"), ("b", "<")): 1,
        (("a", "<"), ("b", ">")): 1,
        (("a", "<"), ("b", "<")): 2,
    }


def test_an_odd_degree_is_beyond_gyroscopic_forces() -> None:
    odd = found("{coordinates: [x, y], G: [[0, 9], [-9, 0]], K: [[-1, 0], [0, 1]]}")
    assert odd.gyroscopic[0].degree == 1
    said = [one.text for one in sentences(odd)]
    assert "It is odd: no gyroscopic forces among [[names]] make the motion stable (Kelvin-Chetaev)." in said


def test_a_free_coordinate_leaves_the_parity_unsaid() -> None:
    """K = diag(0, -1): the theorem asks for det K != 0."""
    free = found("{coordinates: [x, y], G: [[0, 1], [-1, 0]], K: [[0, 0], [0, -1]]}").gyroscopic[0]
    assert (free.degree, free.free) == (1, 1)
    told = sentences(found("{coordinates: [x, y], G: [[0, 1], [-1, 0]], K: [[0, 0], [0, -1]]}"))
    said = " ".join(one.text for one in told)
    assert "Kelvin" not in said


def test_a_matrix_with_a_vanishing_first_minor_is_told_in_another_order() -> None:
    """K = [[0, 1], [1, 2]]: det K = -1, one negative eigenvalue."""
    (part,) = found("{coordinates: [x, y], K: [[0, 1], [1, 2]]}").gyroscopic
    assert part.degree == 1


def test_a_bundle_of_energies_is_definite_where_the_pair_is_stabilised() -> None:
    """Merkin's pair with k = (1, 4): stable from g = 3 on; a definite integral can exist only there."""
    text = "{coordinates: [x, y], G: [[0, g], [-g, 0]], K: [[-1, 0], [0, -4]]}"
    stable = found(text, "{g: {sign: positive, value: 3.01}}").energy[0]
    assert stable.bundle is not None
    assert stable.definite is False
    assert found(text, "{g: {sign: positive, value: 2.99}}").energy[0].bundle is None
    assert found(text, "{g: {sign: positive, value: 3}}").energy[0].bundle is None


def test_a_degree_is_not_told_of_places_where_a_square_in_the_determinant_vanishes() -> None:
    """K = [1 a; a 0]: det K = -a^2, one negative eigenvalue but where a = 0, with the eigenvalues 1 and 0."""
    (part,) = found("{coordinates: [x, y], K: [[1, a], [a, 0]]}", "{a: real}").gyroscopic
    assert part.degree is None
    assert [([(str(x), how) for x, how in region.signs], region.degree) for region in part.regions] == [
        ([("a", "!=")], 1)
    ]
    (sure,) = found("{coordinates: [x, y], K: [[1, a], [a, 0]]}", "{a: nonzero}").gyroscopic
    assert sure.degree == 1


@pytest.mark.parametrize(
    ("matrix", "sign", "free", "regions"),
    [
        ("[[-a]]", "nonnegative", 0, [("a>", 1)]),  # a = 0: no negative eigenvalue, none where it holds is told of it
        ("[[-a, 0], [0, -1]]", "nonnegative", 0, [("a>", 2)]),  # a = 0: the eigenvalues 0 and -1
        ("[[1, -1], [-1, 1]]", "real", 1, [("", 0)]),  # eigenvalues 0 and 2
        ("[[a, a], [a, a]]", "real", 1, [("a>", 0), ("a<", 1)]),  # eigenvalues 0 and 2 a
        ("[[0, a], [a, 0]]", "nonzero", 0, [("", 1)]),  # eigenvalues a and -a: every order begins with a zero
        ("[[0, 1, 0], [1, 0, 0], [0, 0, 0]]", "real", 1, [("", 1)]),  # 1, -1, 0
        ("[[a, 1], [1, 0]]", "real", 0, [("", 1)]),  # det = -1: whatever the sign of the first minor
        ("[[a, a], [a, 0]]", "real", 0, [("a!=", 1)]),  # det = -a^2
        ("[[a, 1, 0], [1, 0, a], [0, a, -1]]", "real", 0, [("a - 1>", 1), ("a - 1<", 2)]),  # det = 1 - a^3
    ],
)
def test_the_degree_where_K_is_singular_or_its_minors_vanish(matrix: str, sign: str, free: int, regions: Any) -> None:
    """Sylvester's law of inertia; told is nothing of places where K loses rank."""
    n = matrix.count("],") + 1
    gyro = [[(j > i) - (j < i) for j in range(n)] for i in range(n)]
    text = f"{{coordinates: {['x', 'y', 'z'][:n]}, G: {gyro}, K: {matrix}}}"
    (part,) = found(text, f"{{a: {sign}}}").gyroscopic
    told = [("".join(f"{x}{how}" for x, how in region.signs), region.degree) for region in part.regions]
    assert (part.free, told) == (free, regions)
    assert part.degree == (regions[0][1] if regions[0][0] == "" else None)


@pytest.mark.parametrize(
    ("matrices", "why"),
    [
        ("coordinates: [x, y], K: [[1, 0], [0, 2]], N: [[0, 1], [-1, 0]]", "the theorems ask for $N = 0$"),
        ("coordinates: [x, y], A: [[0, 1], [-1, 2]]", "not about equations of first order"),
    ],
)
def test_where_nothing_is_said_the_reason_is_and_nothing_is_called_checked(matrices: str, why: str) -> None:
    analysis = analysed(f"{{{matrices}}}")
    (said,) = sentences(analysis.stabilisation)
    assert why in said.text
    assert analysis.check("stabilisation") is None


def test_signs_that_contradict_each_other_make_no_region() -> None:
    """K = [b+2 -2; -2 b+2] has the eigenvalues b and b + 4: b > 0 > b + 4 and b > 0 > b + 2 do not go together."""
    (part,) = found("{coordinates: [x, y], K: [[b+2, -2], [-2, b+2]], G: [[0, 1], [-1, 0]]}", "{b: real}").gyroscopic
    degrees = {region.degree for region in part.regions}
    assert degrees == {0, 1, 2}


# --- dissipation ---


def test_a_damper_on_one_mass_is_pervasive_through_the_spring() -> None:
    """y at rest with D x' = 0: x' = 0 needs k y' = 0.  Without the spring y is on its own."""
    (part,) = found("{" + PAIR + ", D: [[c, 0], [0, 0]]}", TWO).dissipation
    assert (part.complete, part.semidefinite, part.rank.full, part.rank.certainty) == (
        False,
        True,
        True,
        Certainty.PROVED,
    )
    assert part.rank.locus == Locus()
    loose = found("{" + PAIR + ", D: [[c, 0], [0, 0]]}", TWO.replace("k: positive", "k: real")).dissipation[0]
    assert loose.rank.locus is not None
    assert texts((*loose.rank.locus.factors, *loose.rank.locus.provided)) == {"k"}


def test_a_damper_between_equal_oscillators_leaves_them_moving_together() -> None:
    """D damps x - y: with equal masses and springs (1, 1) moves undamped at lambda^2 = -k/m, exactly."""
    text = "{coordinates: [x, y], M: [[m, 0], [0, m]], K: [[k, 0], [0, k]], D: [[c, -c], [-c, c]]}"
    (part,) = found(text, "{m: positive, k: positive, c: positive}").dissipation
    assert not part.rank.full
    (motion,) = part.motions
    assert str(motion.square) == "k/m"
    assert motion.shape is not None
    assert str(motion.shape[0]) == str(motion.shape[1]) != "0"


def test_where_a_pervasive_damper_loses_its_grip() -> None:
    """The same with masses m1, m2 and springs k1, k2: undamped exactly if k1 m2 = k2 m1."""
    text = "{coordinates: [x, y], M: [[m1, 0], [0, m2]], K: [[k1, 0], [0, k2]], D: [[c, -c], [-c, c]]}"
    (part,) = found(text, TWO.replace(", k: positive", "")).dissipation
    assert part.rank.full
    assert part.rank.locus is not None
    assert texts(part.rank.locus.factors) in (
        {"k1*m2 - m1*k2"},
        {"k1*m2 - k2*m1"},
        {"k2*m1 - k1*m2"},
        {"m1*k2 - k1*m2"},
    )
    assert part.rank.locus.together == ()
    values = "{k1: {value: 2}, k2: {value: 6}, m1: {value: 1}, m2: {value: 3}, c: {value: 1}}"
    assert found(text, values).dissipation[0].at_values is False
    assert found(text, values.replace("6", "5")).dissipation[0].at_values is True


def test_a_uniform_motion_that_is_not_felt() -> None:
    """Two masses with a spring and a damper between them alone drift together; held to the ground by a damper not.

    The drift does not show as a loss of rank off lambda = 0.
    """
    text = "{coordinates: [x, y], K: [[k, -k], [-k, k]], D: [[c, -c], [-c, c]]}"
    (part,) = found(text, "{k: {positive: true, value: 1}, c: {positive: true, value: 1}}").dissipation
    assert part.at_values is False
    assert (part.rank.full, part.rank.certainty) == (False, Certainty.PROVED)
    assert [[str(x) for x in factor] for factor in part.rank.factors] == [["0", "1"]]
    (held,) = found(text.replace("D: [[c, -c]", "D: [[c+1, -c]"), "{k: positive, c: positive}").dissipation
    assert (held.rank.full, held.rank.locus) == (True, Locus())


def test_a_charge_damped_along_one_axis_drifts_only_without_a_field() -> None:
    """x'' + g y' + d x' = 0, y'' - g x' = 0: x' = 0 at all times needs g y' = 0."""
    text = "{coordinates: [x, y], G: [[0, g], [-g, 0]], D: [[d, 0], [0, 0]]}"
    (part,) = found(text, "{g: {value: 0}, d: {positive: true, value: 1}}").dissipation
    assert part.at_values is False
    assert part.rank.full
    assert part.rank.locus is not None
    assert texts((*part.rank.locus.factors, *part.rank.locus.provided)) == {"g"}
    (part,) = found(text, "{g: {value: 2}, d: {positive: true, value: 1}}").dissipation
    assert part.at_values is True


def test_a_drift_that_leans_on_a_spring_is_told_with_its_condition() -> None:
    """x = -g v/b, y = v t solve x'' + g y' + b x = 0, y'' = g x'; where b = 0 nothing but rest has x' = 0."""
    result = found("{coordinates: [x, y], G: [[0, g], [-g, 0]], K: [[b, 0], [0, 0]], D: [[1, 0], [0, 0]]}",
                   "{g: positive, b: real}")  # fmt: skip
    (part,) = result.dissipation
    assert not part.rank.full
    assert [[str(x) for x in factor] for factor in part.rank.factors] == [["0", "1"]]
    said = [one.text for one in sentences(result)]
    assert "This is about parameters with [[where]]." in said


def test_where_springs_vanish_what_is_not_felt_drifts() -> None:
    """K = -a [1 1; 1 0]: where a = 0 the motion (1, -1) t is not felt by D = [1 1; 1 1]."""
    text = "{coordinates: [x, y], K: [[-a, -a], [-a, 0]], D: [[1, 1], [1, 1]]}"
    (part,) = found(text, "{a: {sign: real, value: 0}}").dissipation
    assert part.at_values is False
    assert part.rank.locus is not None
    assert texts((*part.rank.locus.factors, *part.rank.locus.provided)) == {"a"}


def test_damping_that_may_feed_is_not_called_dissipation() -> None:
    told = sentences(found("{coordinates: [x, y], K: [[1, 2], [2, 5]], D: [[a, 0], [0, 0]]}", "{a: real}"))
    said = [one.text for one in told]
    assert "That $D$ is positive semidefinite for [[names]] is not known." in said
    assert not any(text.startswith("Where it is felt") for text in said)


# --- control ---


def test_one_force_on_two_masses() -> None:
    """Force on x: y is reached through k only."""
    text = "{" + PAIR + ", B: [[1], [0]]}"
    whole = found(text, TWO.replace("k: positive", "k: real").replace("c: positive, ", ""), "inputs: [u]").control[0]
    assert whole.rank.full
    assert whole.rank.locus is not None
    assert texts((*whole.rank.locus.factors, *whole.rank.locus.provided)) == {"k"}


def test_a_force_between_equal_oscillators_does_not_move_their_centre() -> None:
    text = "{coordinates: [x, y], M: [[m, 0], [0, m]], K: [[k, 0], [0, k]], B: [[1, 0], [-1, 1]]}"
    whole = found(text, "{m: {value: 1}, k: {value: 2}}", "inputs: [u, v]")
    assert whole.control[0].rank.full
    assert whole.least == (("u", "v"),)
    single = found(text.replace("[[1, 0], [-1, 1]]", "[[1], [-1]]"), "{m: {value: 1}, k: {value: 2}}", "inputs: [u]")
    (factor,) = single.control[0].rank.factors
    assert [str(x) for x in factor] in (["k", "0", "m"], ["k/m", "0", "1"])
    assert single.control[0].at_values is False
    assert single.control[0].stabilisable_at_values is False
    assert single.feedback is None
    assert "out of reach" in single.no_feedback


def test_what_is_out_of_reach_may_decay_by_itself() -> None:
    text = "{coordinates: [x, y], D: [[0, 0], [0, 1]], K: [[-1, 0], [0, 1]], B: [[1], [0]]}"
    got = found(text, "{}", "inputs: [u]")
    assert got.control[0].at_values is False
    assert got.control[0].stabilisable_at_values is True
    assert got.feedback is not None
    assert got.feedback.verdict.word == "asymptotically stable"


def test_the_cart_pole_is_controllable_everywhere_and_held_by_its_feedback() -> None:
    """Astrom & Murray, example 7.2: reachable; J, m l^2, M > 0.  The closed loop counted by another route."""
    analysis = mbsym.load(SHIPPED / "cart-pole.yaml", (8,))
    got = analysis.stabilisation
    assert got.control[0].rank.full
    assert got.control[0].rank.locus == Locus()
    assert got.least == (("F",),)
    assert got.feedback is not None
    assert got.feedback.lyapunov is not None
    space = analysis.state_space
    values = {p.name: p.value for p in analysis.system.parameters}
    import numpy as np

    def at(matrix: Any) -> Any:
        given = {name: float(x.value) for name, x in values.items()}  # type: ignore[union-attr]
        return np.array([[float(eval(str(x), {}, given)) for x in row] for row in matrix])

    closed = at(space.A) - at(space.B) @ np.array([[float(x) for x in row] for row in got.feedback.gains])
    assert np.linalg.eigvals(closed).real.max() < 0
    p = np.array([[float(x) for x in row] for row in got.feedback.lyapunov])
    assert np.linalg.eigvalsh(p).min() > 0
    assert np.linalg.eigvalsh(p @ closed + closed.T @ p).max() < 0


def test_parts_that_one_input_cannot_tell_apart() -> None:
    """Hautus over the whole: two equal oscillators and one force on each at once; each alone is controllable."""
    text = "{coordinates: [x, y], K: [[k, 0], [0, k]], B: [[1], [1]]}"
    whole, *parts = found(text, "{k: {sign: positive, value: 1}}", "inputs: [u]").control
    assert not whole.rank.full
    assert whole.at_values is False
    assert [one.rank.full for one in parts] == [True, True]


def test_three_masses_and_the_resonances_that_one_force_misses() -> None:
    """Three oscillators with squared frequencies a, b, c, one force on all: lost exactly where two are equal."""
    text = "{coordinates: [x, y, z], K: [[a, 0, 0], [0, b, 0], [0, 0, c]], B: [[1], [1], [1]]}"
    (whole, *_) = found(text, "{a: real, b: real, c: real}", "inputs: [u]").control
    assert whole.rank.full
    assert whole.rank.locus is not None
    assert {x.lstrip("-") for x in texts(whole.rank.locus.factors)} in ({"a - b", "a - c", "b - c"},)


# --- numbers: two routes, and planted mistakes ---


def chain(n: int, at: int) -> AtValues:
    """n unit masses in a row between walls, a force on number ``at``."""

    def entry(i: int, j: int) -> int:
        return 2 if i == j else -1 if abs(i - j) == 1 else 0

    unit = [fmpq(int(i == j)) for i in range(n) for j in range(n)]
    stiff = fmpq_mat(n, n, [entry(i, j) for i in range(n) for j in range(n)])
    return AtValues(fmpq_mat(n, n, unit), fmpq_mat(n, n), stiff, fmpq_mat(n, 1, [int(i == at) for i in range(n)]))


@pytest.mark.parametrize(("n", "at", "reached"), [(2, 0, 4), (3, 0, 6), (3, 1, 4), (5, 2, 6), (5, 1, 8)])
def test_kalman_s_rank_counts_the_modes_without_a_node(n: int, at: int, reached: int) -> None:
    """Mode j has sin(pi j (at + 1)/(n + 1)) at the force: zero where (n + 1) divides j (at + 1)."""
    there = chain(n, at)
    nodes = sum((j * (at + 1)) % (n + 1) == 0 for j in range(1, n + 1))
    assert reached == 2 * (n - nodes)
    assert numbers.kalman_rank(there.state, there.gain(there.inputs)) == reached
    assert numbers.unreached(there.state, there.gain(there.inputs)).degree() == 2 * nodes


def test_a_lyapunov_function_is_proved_or_refused() -> None:
    damped = AtValues(*(fmpq_mat(1, 1, [x]) for x in (1, 3, 2)), None).state  # type: ignore[call-arg]
    assert numbers.lyapunov_function(damped) is not None
    unit = fmpq_mat(2, 2, [1, 0, 0, 1])
    assert not numbers.proves_decay(unit, damped)  # its rate is not definite
    assert not numbers.proves_decay(-unit, damped)
    grown = AtValues(*(fmpq_mat(1, 1, [x]) for x in (1, -3, 2)), None).state  # type: ignore[call-arg]
    assert numbers.lyapunov_function(grown) is None


def test_planted_mistakes_are_found() -> None:
    analysis = analysed("{" + PAIR + ", D: [[c, 0], [0, 0]], B: [[1], [0]]}", TWO, "inputs: [u]")
    right = analysis.stabilisation
    scene, linear = analysis.parameters_scene, analysis.judgeable

    def told(wrong: Stabilisation) -> str:
        check = check_stabilisation(scene, linear, wrong)
        assert check is not None
        return check.detail

    (turn,), (damped,), (control,) = right.gyroscopic, right.dissipation, right.control
    assert "degree" in told(
        replace(right, gyroscopic=(replace(turn, regions=tuple(replace(x, degree=1) for x in turn.regions)),))
    )
    assert "pervasive" in told(replace(right, dissipation=(replace(damped, rank=replace(damped.rank, full=False)),)))
    assert "control" in told(replace(right, control=(replace(control, rank=replace(control.rank, full=False)),)))


def test_it_is_refused_where_there_is_no_motion() -> None:
    for name in ("gyrostat-poisson", "four-bar"):
        with pytest.raises(Unavailable, match="no unperturbed motion"):
            _ = mbsym.load(SHIPPED / f"{name}.yaml").stabilisation


def test_theorems_about_energy_are_not_told_of_constraints_in_velocities() -> None:
    """Chaplygin's sleigh keeps its energy, and its turning decays or grows with v: its D is no dissipation."""
    found = mbsym.load(SHIPPED / "chaplygin-sleigh.yaml").stabilisation
    assert found.nonholonomic
    assert (found.gyroscopic, found.energy, found.dissipation) == ((), (), ())


def test_roots_of_parameters_are_no_mistake() -> None:
    points = mbsym.load(SHIPPED / "triangular-points.yaml")
    assert points.stabilisation.gyroscopic[0].regions == ()
    assert points.stabilisation.gyroscopic[1].degree == 0
    assert points.check("stabilisation") is None


# --- what is written ---


@pytest.fixture(scope="module")
def pole() -> Analysis:
    return mbsym.load(SHIPPED / "cart-pole.yaml", (8,))


def test_results_follow_the_schema(pole: Analysis) -> None:
    validator = Draft202012Validator(schema("results"))
    for analysis in (pole, analysed("{" + PAIR + ", D: [[c, 0], [0, 0]]}", TWO)):
        written = json.loads(json.dumps(results(analysis, analysis.problems)))
        assert list(validator.iter_errors(written)) == []
        assert "stabilisation" in written
    assert F(written["stabilisation"]["gyroscopic"][0]["zero_eigenvalues"]) == 0


def test_every_sentence_has_its_translations(pole: Analysis) -> None:
    said = {one.text for one in sentences(pole.stabilisation)} | {FEEDBACK, LYAPUNOV}
    loose = TWO.replace("k: positive", "k: real").replace("c: positive, ", "")
    together = "{coordinates: [x, y], M: [[m, 0], [0, m]], K: [[k, 0], [0, k]], D: [[1, -1], [-1, 1]]}"
    for more in (
        found("{coordinates: [x, y], G: [[0, 10], [-10, 0]], K: [[-1, 0], [0, -4]]}"),
        found(together, "{m: positive, k: positive}"),
        found("{" + PAIR + ", B: [[1], [0]]}", loose, "inputs: [u]"),
    ):
        said |= {one.text for one in sentences(more)}
    for name in ("ru", "es"):
        language = Language(name)
        for english in said:
            assert language.sentence(english) != english, english


def test_the_terminal_tells_the_gains(pole: Analysis) -> None:
    (line,) = [text for text in told(pole, 8) if text.startswith("  k = ")]
    gains = [Fraction(x) for x in line.removeprefix("  k = [ ").removesuffix(" ]").split()]
    assert gains == list(pole.stabilisation.feedback.gains[0])


def test_many_coordinates_are_told_to_be_many() -> None:
    n = 14
    rows = [[2 if i == j else -1 if abs(i - j) == 1 else 0 for j in range(n)] for i in range(n)]
    names = ", ".join(f"x{i}" for i in range(n))
    half = [[int(i == j and i < n // 2) for j in range(n)] for i in range(n)]
    whole = f"{{coordinates: [{names}], K: {rows}, D: {half}, B: {[[int(i == 0)] for i in range(n)]}}}"
    got = analysed(whole, "{}", "inputs: [u]").stabilisation
    assert got.feedback is None
    assert got.no_feedback == "there are more than 12 coordinates"
    assert got.control[0].rank.certainty is Certainty.UNDECIDED


def test_parameters_that_a_condition_ties_are_not_called_independent() -> None:
    """p^2 + w^2 = k^2 is linear in none of them, and K = k is not independent of the others there."""
    text = """
mbsym: 1
name: Tied
parameters: {k: real, p: real, w: real}
bodies: [{name: one, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: 1}]
loads: [{generalized force: {x: p**2 + w**2 - k**2 - x*k}}]
motion: {x: 0}
"""
    with pytest.raises(Unavailable, match="conditions that were not solved"):
        _ = mbsym.loads(text).stabilisation


# --- parts ---

PARTS = """
mbsym: 1
name: two particles that know nothing of each other
parameters: {a: positive, g: real, s: real}
bodies:
  - {name: p, mass: 1, connection point: [x, y, 0], coordinates: [x, y]}
  - {name: q, attached to: 0, mass: 1, connection point: [z, w, 0], coordinates: [z, w]}
loads:
  - potential: (x**2 + 2*y**2)/2 + (z**2 - 2*w**2)/2
  - damper: {coordinate: x, coefficient: a}
  - damper: {coordinate: z, coefficient: s}
  - generalized force: {x: g*y_dot, y: -g*x_dot}
motion: {}
values: {a: 1, g: 1, s: 1}
"""


def test_what_is_said_of_a_part_names_it() -> None:
    """D is felt by x and y, and w is not damped at all; gyroscopic forces between y and w could hold up what falls."""
    said = sentences(mbsym.loads(PARTS, (5, 6, 8)).stabilisation)
    about_parts = (
        "It is odd",
        "It is even",
        "Where it is felt",
        "At the given values $D$",
        "That $D$",
        "$D$ is",
        "Every motion",
    )
    told = [one for one in said if one.text.startswith(about_parts)]
    assert {Writer().inline(one.gaps["names"]) for one in told} == {"x, y", "z", "w"}
    assert all("[[names]]" in one.text for one in told)


def test_what_is_not_known_is_not_told_as_false() -> None:
    """D = s is positive, zero or negative; D = [1 0; 0 -1] is no dissipation, proved."""
    told = results(mbsym.loads(PARTS, (5, 6, 8)), (8,))["stabilisation"]["dissipation"]
    assert {tuple(part["coordinates"]): (part["complete"], part["semidefinite"]) for part in told} == {
        ("x", "y"): (False, True),
        ("z",): (None, None),
    }
    (part,) = found("{coordinates: [x, y], K: [[1, 2], [2, 5]], D: [[1, 0], [0, -1]]}", "{a: real}").dissipation
    assert (part.complete, part.semidefinite) == (False, False)
    feeding = found("{coordinates: [x, y], K: [[1, 2], [2, 5]], D: [[1, 0], [0, -1]]}")
    said = [one.text for one in sentences(feeding)]
    assert "$D$ is not positive semidefinite for [[names]] (proved)." in said


HILL = """
mbsym: 1
name: hill
parameters: {a: positive, b: positive, c: positive}
bodies:
  - {name: p, mass: 1, connection point: [x, y, z], coordinates: [x, y, z]}
loads:
  - potential: V
motion: {}
"""


@pytest.mark.parametrize(
    ("potential", "words"), [("-a*x**2 - b*y**2 + c*z**2", "even"), ("-a*x**2 - b*y**2 - c*z**2", "odd")]
)
def test_parts_of_odd_degree_are_told_what_gyroscopic_forces_between_them_can_do(potential: str, words: str) -> None:
    """On a hill x'' + g y' = a x, y'' - g x' = b y is stable for g > sqrt(a) + sqrt(b) (Thomson and Tait): a degree of
    one along x and one along y does not mean that no gyroscopic forces help; of three directions it does."""
    found = mbsym.loads(HILL.replace("V", potential)).stabilisation
    told = [x.text for x in sentences(found)]
    assert sum("no gyroscopic forces among" in x for x in told) == (2 if words == "even" else 3)
    (together,) = [x for x in told if "together" in x]
    assert words in together


@given(st.data())
@settings(40)
def test_the_degree_of_instability_does_not_know_the_coordinates(data: st.DataObject) -> None:
    """K told in q = P y, P of integers and regular: the same regions' degrees hold, by eigenvalues at numbers (NumPy).

    Of singular K, indefinite ones, and such whose leading minors vanish.
    """
    n = data.draw(st.integers(1, 3))
    entries = st.sampled_from(["0", "1", "-1", "2", "a", "-a", "a - 1", "a**2"])
    rows = [["0"] * n for _ in range(n)]
    for i in range(n):
        for j in range(i + 1):
            rows[i][j] = rows[j][i] = data.draw(entries)
    change = np.array(data.draw(st.lists(st.lists(st.integers(-1, 2), min_size=n, max_size=n), min_size=n, max_size=n)))
    hypothesis.assume(abs(np.linalg.det(change)) > 0.5)
    turned = [
        [
            " + ".join(f"({change[k][i] * change[m][j]})*({rows[k][m]})" for k in range(n) for m in range(n))
            for j in range(n)
        ]
        for i in range(n)
    ]
    names = ["x", "y", "z"][:n]
    for stiffness in (rows, turned):
        quoted = json.dumps(stiffness)
        mass = json.dumps((change.T @ change).tolist() if stiffness is turned else np.eye(n).tolist())
        for part in found(f"{{coordinates: {names}, M: {mass}, K: {quoted}}}", "{a: real}").gyroscopic:
            at = [names.index(name) for name in part.coordinates]
            for a in (-2.5, -0.5, 0.0, 0.5, 1.0, 1.5, 3.0):
                whole = np.array([[eval(x, {"a": a}) for x in row] for row in stiffness], dtype=float)
                roots = np.linalg.eigvalsh(whole[np.ix_(at, at)])
                for region in part.regions:
                    held = [(at_value(x, a), how) for x, how in region.signs]
                    if all({">": x > 0, "<": x < 0, "!=": x != 0}[how] for x, how in held):
                        assert sum(roots < -1e-9) == region.degree
                        assert sum(abs(roots) < 1e-9) == part.free


def at_value(formula: Any, a: float) -> float:
    return float(formula.to_sympy().subs({"a": a}))
