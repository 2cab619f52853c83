"""Problems 5 and 6 of systems given by their matrices: thresholds of the literature, refusals, the second route."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction as F

import pytest
from conftest import SHIPPED, analysed

import mbsym
from mbsym.algebra.failures import GivenByMatrices
from mbsym.analysis import Analysis, Unavailable
from mbsym.problems import given_system
from mbsym.problems.checks import EXACT, NUMERICAL
from mbsym.problems.stability import problem as stability


def given(matrices: str, parameters: str = "{}", more: str = "") -> Analysis:
    text = f"mbsym: 1\nname: Given\nparameters: {parameters}\n{more}\nlinear system: {matrices}\n"
    return analysed(text)


def word(analysis: Analysis, **values: F | int) -> str:
    judge = stability.ExactVerdicts(
        analysis.parameters_scene, analysis.balance, analysis.linearisation, analysis.equilibrium, analysis.signs
    )
    return str(judge({name: F(value) for name, value in values.items()}).word)


@pytest.fixture(scope="module")
def pair() -> Analysis:
    return mbsym.load(SHIPPED / "gyroscopic-pair.yaml")


def test_gyroscopic_stabilisation_begins_at_the_sum_of_the_roots(pair: Analysis) -> None:
    """references/benchmarks/mgk_exact: stable iff g > sqrt(k1) + sqrt(k2); at equality a Jordan block."""
    assert word(pair, k1=1, k2=4, g=F(3001, 1000)) == "stable"
    assert word(pair, k1=1, k2=4, g=F(2999, 1000)) == "unstable"
    assert word(pair, k1=1, k2=4, g=3) == "unstable"


def test_routh_s_mass_ratio() -> None:
    """references/benchmarks/cr3bp: mu = (1 - sqrt(69)/9)/2 = 0.0385208965..."""
    points = mbsym.load(SHIPPED / "triangular-points.yaml")
    (part, beside) = points.stability.subsystems
    (condition,) = (formula for _, formula, _ in part.conditions)
    assert str(condition) == "27*mu**2 - 27*mu + 1"
    assert beside.coordinates == ("z",)
    assert word(points, mu=F(385, 10000)) == "stable"
    assert word(points, mu=F(386, 10000)) == "unstable"


def test_damping_destroys_what_gyroscopic_forces_hold_up() -> None:
    """references/benchmarks/mgk_exact: k = (1, 4), g = 10, d = 1e-3: max Re = 2.678295e-5."""
    damped = given(
        "{coordinates: [x, y], G: [[0, 10], [-10, 0]], K: [[-1, 0], [0, -4]], D: [[d, 0], [0, d]]}",
        "{d: {sign: positive, value: 1e-3}}",
    )
    assert damped.stability.verdict.word == "unstable"
    roots = [root for spectrum in damped.stability.spectra for root in spectrum.roots]
    assert max(float(root.ball.real.mid()) for root in roots) == pytest.approx(2.678295e-5, rel=1e-6)


def test_ziegler_with_a_damping_of_equal_size() -> None:
    """references/benchmarks/ziegler: flutter from p = 41/28 + b**2/2 on."""
    ziegler = given(
        "{coordinates: [q1, q2], M: [[3, 1], [1, 1]], S: [[2 - p, p - 1], [-1, 1]], D: [[2*b, -b], [-b, b]]}",
        "{p: positive, b: positive}",
    )
    assert word(ziegler, p=F(41, 28) + F(1, 200) - F(1, 10**6), b=F(1, 10)) == "asymptotically stable"
    assert word(ziegler, p=F(41, 28) + F(1, 200) + F(1, 10**6), b=F(1, 10)) == "unstable"


def test_given_equations_are_all_there_is() -> None:
    """x = cos t; x = x_0 + v (1 - e^-t): no terms of higher order are presumed of what was given as linear."""
    assert given("{coordinates: [x], K: [[1]]}").stability.verdict.word == "stable"
    assert given("{coordinates: [x], D: [[1]]}").stability.verdict.word == "stable"
    assert given("{coordinates: [x], M: [[1]]}").stability.verdict.word == "unstable"
    assert given("{coordinates: [x], D: [[1]], K: [[1]]}").stability.verdict.word == "asymptotically stable"


def test_matrices_are_split() -> None:
    found = given("{coordinates: [x, y], C: [[1, a], [b, 0]], S: [[0, 2], [0, 1]]}", "{a: real, b: real}").linearisation
    assert str(found.D) == "[[1, (a + b)/2], [(a + b)/2, 0]]"
    assert str(found.G) == "[[0, (a - b)/2], [(b - a)/2, 0]]"
    assert (str(found.K), str(found.N)) == ("[[0, 1], [1, 1]]", "[[0, 1], [-1, 0]]")


def test_what_is_about_bodies_is_refused(pair: Analysis) -> None:
    for name in ("kinematics", "energy", "equations", "integrals", "programs", "hamilton", "equilibria"):
        with pytest.raises(Unavailable, match="given by its matrices"):
            getattr(Analysis(pair.system, (5, 6)), name)
    with pytest.raises(GivenByMatrices, match="given by its matrices"):
        mbsym.simulate(pair, time=1)


def test_a_planted_mistake_is_found(pair: Analysis) -> None:
    scene, found = pair.parameters_scene, pair.linearisation
    assert given_system.check_matrices(scene, found).outcome in (EXACT, NUMERICAL)
    for wrong in (
        replace(found, K=found.M),
        replace(found, G=found.M),
        replace(found, N=found.G, G=found.N),
        replace(found, D=found.K, K=found.D),
    ):
        assert given_system.check_matrices(scene, wrong).failed


def test_relations_are_used_by_both_routes() -> None:
    related = given(
        "{coordinates: [x], K: [[k]], D: [[c]]}", "{w: positive, k: real, c: real}", "relations: {k: w**2, c: k/w}"
    )
    assert (str(related.linearisation.K), str(related.linearisation.D)) == ("[[w**2]]", "[[w]]")
    assert related.checks[0].outcome in (EXACT, NUMERICAL)


def test_results_follow_the_schema(pair: Analysis) -> None:
    from mbsym.report.results_json import results

    found = json.loads(json.dumps(results(pair, pair.problems)))
    assert found["unavailable"] == {}
    assert found["linearisation"]["K"] == [["-k1", "0"], ["0", "-k2"]]
