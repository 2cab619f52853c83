"""Claims: what a printed formula is told, kind by kind; planted errors are found and named exactly."""

from __future__ import annotations

import json
import re
from fractions import Fraction
from pathlib import Path

import pytest
from conftest import SHIPPED, at_values, compiled_latex, invoked, needs_pdflatex

import mbsym
from mbsym.algebra import ring
from mbsym.algebra.failures import Failure
from mbsym.analysis import Analysis
from mbsym.analysis.judging import where_zero
from mbsym.problems.claims import ClaimResult, Outcome
from mbsym.report.latex.report import render as latex
from mbsym.report.results_json import results

#: A physical pendulum: T = (J + m l^2) theta'^2 / 2, U = m g l cos theta, m l^2 + J = Io.
PENDULUM = """
mbsym: 1
name: Pendulum
parameters: {m: positive, l: positive, J: positive, g: positive, k: positive}
bodies:
  - name: bob
    attached to: 0
    rotation: {axes: [3], angles: [theta]}
    mass centre: [0, -l, 0]
    mass: m
    inertia about: mass centre
    inertia: [J, J, J]
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
relations: {k: m*g*l}
motion: {theta: 0}
values: {m: 1, l: 2, J: 0.5, g: 9.81}
initial: {theta: {position: pi/6, velocity: 1.5}}
abbreviations: {Io: J + m*l**2, twice: 2*theta, w2: m*g*l/Io, half: theta/2, T: Io*theta_dot**2/2}
"""


def analysed(*claims: str, text: str = PENDULUM) -> Analysis:
    return mbsym.loads(text + "claims:\n" + "".join(f"  - {{{claim}}}\n" for claim in claims))


def judged(claim: str, text: str = PENDULUM) -> ClaimResult:
    (result,) = analysed(claim, text=text).claims
    return result


@pytest.mark.parametrize(
    ("claim", "outcome"),
    [
        ("claim: kinetic energy, equals: Io*theta_dot**2/2", Outcome.EXACT),
        ("claim: kinetic energy, equals: m*l**2*theta_dot**2/2", Outcome.DIFFERS),
        ("claim: force function, equals: m*g*l*cos(theta)", Outcome.EXACT),
        ("claim: potential energy, equals: -m*g*l*cos(theta)", Outcome.EXACT),
        ("claim: potential energy, equals: m*g*l*sin(theta)", Outcome.DIFFERS),
        ("claim: potential energy, equals: m*g*l*(1 - cos(theta))", Outcome.EQUIVALENT),
        ("claim: potential energy, equals: -k*cos(theta)", Outcome.RELATIONS),
        ("claim: potential energy, equals: 2*m*g*l*sin(half)**2, place: half angles", Outcome.EQUIVALENT),
        ("claim: potential energy, equals: -m*g*l*(sqrt((1 + cos(theta))**2) - 1)", Outcome.NUMERICAL),
        ("claim: lagrangian, equals: Io*theta_dot**2/2 + m*g*l*cos(twice/2)", Outcome.EXACT),
        (
            "claim: lagrangian, equals: T + m*g*l*cos(theta) + 3*t*theta_dot*cos(theta) + 3*sin(theta)",
            Outcome.EQUIVALENT,
        ),
        ("claim: lagrangian, equals: T + m*g*l*cos(theta) + 3*t*theta_dot*cos(theta)", Outcome.DIFFERS),
        ("claim: coefficient, of: kinetic energy, at: theta_dot**2, equals: Io/2", Outcome.EXACT),
        ("claim: coefficient, of: kinetic energy, at: theta_dot**2, equals: Io", Outcome.SCALED),
        ("claim: coefficient, of: kinetic energy, at: theta_dot, equals: 0", Outcome.EXACT),
        ("claim: coefficient, of: theta, at: theta_ddot, equals: Io", Outcome.EXACT),
        ("claim: mass matrix, entry: [theta, 1], equals: l**2*m + J", Outcome.EXACT),
        ("claim: mass matrix, entry: [1, 1], equals: l**2*m - J", Outcome.DIFFERS),
        ("claim: linear matrix K, entry: [1, theta], equals: k", Outcome.RELATIONS),
        ("claim: linear matrix G, entry: [1, theta], equals: J", Outcome.DIFFERS),
        ("claim: subsystem matrix M, entry: [theta, theta], equals: Io", Outcome.EXACT),
        ("claim: equation of motion, of: theta, equals: theta_ddot + w2*sin(theta)", Outcome.FACTOR),
        ("claim: equation of motion, of: theta, equals: theta_ddot - w2*sin(theta)", Outcome.DIFFERS),
        ("claim: characteristic polynomial, variable: p, equals: p**2 + w2", Outcome.FACTOR),
        ("claim: characteristic polynomial, variable: p, equals: p**2 + p + w2", Outcome.DIFFERS),
        ("claim: angular velocity, of: bob, component: 3, equals: theta_dot", Outcome.EXACT),
        ("claim: relative angular velocity, of: bob, component: 1, equals: theta_dot", Outcome.DIFFERS),
        ("claim: direction cosine, of: bob, entry: [1, 2], equals: sin(theta)", Outcome.EXACT),
        ("claim: direction cosine, of: bob, entry: [2, 1], equals: sin(theta)", Outcome.SCALED),
        ("claim: position, of: bob, component: 1, equals: l*sin(theta)", Outcome.EXACT),
        ("claim: velocity, of: bob, component: 2, equals: l*theta_dot*sin(theta)", Outcome.EXACT),
        ("claim: velocity, of: bob, component: 2, equals: l*theta_dot*cos(theta)", Outcome.DIFFERS),
        ("claim: first integral, equals: theta_dot**2 - 2*w2*cos(theta)", Outcome.EXACT),
        ("claim: first integral, equals: (theta_dot**2 - 2*w2*cos(theta))**3 + m", Outcome.EXACT),
        ("claim: first integral, equals: Io*theta_dot**2 - 2*k*cos(theta)", Outcome.RELATIONS),
        ("claim: first integral, equals: theta_dot**2 + 2*w2*cos(theta)", Outcome.FAILS),
        ("claim: first integral, equals: m + l", Outcome.FAILS),
        ("claim: condition, that: m*g > 0", Outcome.EXACT),
        ("claim: condition, that: J + m < 0", Outcome.FAILS),
        ("claim: condition, that: J - m > 0", Outcome.FAILS),
        ("claim: value, of: theta_ddot, state: {theta: pi/2}, equals: -4.36", Outcome.DIGITS),
        ("claim: value, of: theta_ddot, state: {theta: pi/2}, equals: 4.36", Outcome.DIFFERS),
        ("claim: value, of: m*l/3, state: initial, equals: 2/3", Outcome.NUMERICAL),
    ],
)  # fmt: skip
def test_every_kind_is_told_apart_from_its_errors(claim: str, outcome: str) -> None:
    assert judged(claim).outcome == outcome


def test_a_difference_is_exactly_that() -> None:
    result = judged("claim: kinetic energy, equals: m*l**2*theta_dot**2/2 + 3*theta_dot")
    assert {(str(part.factor), str(part.difference)) for part in result.parts} == {
        ("theta_dot**2", "-J/2"),
        ("theta_dot", "3"),
    }
    result = judged("claim: characteristic polynomial, variable: p, equals: Io*p**2 + p/3 + k")
    assert [(part.power, str(part.difference)) for part in result.parts] == [(1, "1/3")]
    result = judged("claim: first integral, equals: theta_dot**2 + 2*w2*cos(theta)")
    # dI/dt = 2 theta' theta'' - 2 w2 sin(theta) theta' = -4 w2 sin(theta) theta', and w2 = m g l / (J + m l^2).
    assert str(result.difference) == "-4*m*l*g*theta_dot*sin(theta)/(m*l**2 + J)"


def test_a_factor_matters_only_where_the_quantity_is_not_zero() -> None:
    twice = judged("claim: kinetic energy, equals: Io*theta_dot**2")
    assert (twice.outcome, str(twice.factor), twice.holds, twice.refuted) == (Outcome.SCALED, "2", False, True)
    scaled = judged("claim: mass matrix, entry: [1, 1], equals: m*Io/l**2")
    assert (scaled.outcome, str(scaled.factor), scaled.refuted) == (Outcome.SCALED, "m/l**2", True)
    equation = judged("claim: equation of motion, of: theta, equals: theta_ddot + w2*sin(theta)")
    assert (str(equation.factor), equation.holds, equation.refuted) == ("1/(m*l**2 + J)", True, False)


@pytest.mark.parametrize(
    ("printed", "outcome", "right"),
    [
        ("1.66173165676", Outcome.DIGITS, 12),
        ("1.66", Outcome.DIGITS, 3),
        ("1.7", Outcome.DIGITS, 2),
        ("2", Outcome.DIGITS, 1),
        ("0.2e1", Outcome.DIGITS, 1),
        ("1.67", Outcome.DIFFERS, 2),
        ("1.8", Outcome.DIFFERS, 1),
        ("1.660", Outcome.DIFFERS, 3),
        ("-1.66", Outcome.DIFFERS, 0),
        ("-5.4", Outcome.DIFFERS, 0),
        ("16.6", Outcome.DIFFERS, 0),
    ],
)
def test_numbers_hold_to_the_digits_printed(printed: str, outcome: str, right: int) -> None:
    text = PENDULUM.replace("m: 1,", "m: 1.66173165676349,")
    result = judged(f"claim: value, of: m, state: initial, equals: {printed}", text=text)
    assert (result.outcome, result.digits) == (outcome, right)


def test_states_are_initial_or_given() -> None:
    # l theta' cos(theta) with l = 2: at the initial state 3 cos(pi/6), else what is not named is zero.
    assert judged("claim: velocity, of: bob, component: 1, state: initial, equals: 2.598").outcome == Outcome.DIGITS
    assert (
        judged("claim: velocity, of: bob, component: 1, state: {theta_dot: 1.5}, equals: 3.0").outcome == Outcome.DIGITS
    )
    assert judged("claim: velocity, of: bob, component: 1, state: {theta: 0.1}, equals: 0").outcome == Outcome.DIGITS
    assert (
        judged("claim: velocity, of: bob, component: 1, state: {theta_dot: 1, l: 7}, equals: 7.00").outcome
        == Outcome.DIGITS
    )


def test_what_cannot_be_derived_is_undecided_with_the_reason() -> None:
    text = PENDULUM.replace("g: 9.81", "")
    missing = judged("claim: value, of: g, state: initial, equals: 1", text=text)
    assert (missing.outcome, missing.remark) == (Outcome.UNDECIDED, "no number is given for g")
    text = PENDULUM.replace("motion: {theta: 0}\n", "")
    unmoved = judged("claim: linear matrix K, entry: [1, 1], equals: m", text=text)
    assert unmoved.outcome == Outcome.UNDECIDED
    assert "unperturbed motion" in unmoved.remark
    assert not unmoved.holds
    assert not unmoved.refuted


def test_claims_change_no_result() -> None:
    """Also where they need sines of half angles, or reciprocals, that the system itself does not hold."""
    plain = results(mbsym.loads(PENDULUM), range(1, 8))
    claiming = analysed(
        "claim: potential energy, equals: 2*m*g*l*sin(half)**2",
        "claim: first integral, equals: theta_dot**2/(1 + J) + sqrt(1 + sin(theta/3)**2)/l",
        "claim: mass matrix, entry: [1, 1], equals: exp(m)*sin(m/5)",
    )
    first = claiming.claims  # before everything else
    found = results(claiming, range(1, 8))
    assert len(found.pop("claims")) == 3
    assert found == plain
    assert [result.outcome for result in first] == [Outcome.EQUIVALENT, Outcome.FAILS, Outcome.DIFFERS]


def test_abbreviations_may_be_angles_or_values_and_use_earlier_ones() -> None:
    text = PENDULUM.replace(
        "half: theta/2", "half: theta/2, third: half - theta/6, all: 2*half + third - twice/6, c: cos(all)"
    )
    assert judged("claim: potential energy, equals: -m*g*l*c", text=text).outcome == Outcome.EXACT
    assert judged("claim: potential energy, equals: -m*g*l*cos(3*third)", text=text).outcome == Outcome.EXACT
    assert judged("claim: potential energy, equals: -m*g*l*cos(3*half)", text=text).outcome == Outcome.DIFFERS


def test_conditions_are_found_among_those_of_problem_6() -> None:
    text = (SHIPPED / "gravity-gradient.yaml").read_text(encoding="utf-8")
    assert "claims:" not in text
    conditions = [item for part in mbsym.loads(text).stability.subsystems for item in part.conditions if item[2] == ">"]
    assert conditions
    label, formula, _ = conditions[0]
    for that, outcome in (
        (f"{formula} > 0", Outcome.EXACT),
        (f"0 < 7*({formula})", Outcome.EXACT),
        (f"{formula} < 0", Outcome.FAILS),
    ):
        (result,) = mbsym.loads(f'{text}\nclaims:\n  - {{claim: condition, that: "{that}"}}\n').claims
        assert result.outcome == outcome, that
        assert (label in result.remark) == (outcome == Outcome.EXACT)


def test_a_condition_that_is_not_necessary_gets_a_counterexample() -> None:
    path = SHIPPED / "gravity-gradient.yaml"
    text = path.read_text(encoding="utf-8")
    (result,) = mbsym.loads(f"{text}\nclaims:\n  - {{claim: condition, that: C > 7*A}}\n").claims
    assert (result.outcome, result.refuted) == (Outcome.FAILS, True)
    assert "not necessary" in result.remark
    assert result.counterexample is not None
    values = dict(result.counterexample.at)
    assert Fraction(values["C"]) <= 7 * Fraction(values["A"])
    # What the example says is true: at these parameters problem 6 finds no instability.
    verdict = at_values(path, **values).stability.numerical
    assert verdict is not None
    assert verdict.word.startswith(("stable", "gyroscopically")), verdict


def test_the_printed_formulas_of_the_satellite_hold() -> None:
    analysis = mbsym.load(SHIPPED / "satellite.yaml")
    assert len(analysis.claims) == 44
    assert {result.outcome for result in analysis.claims} == {Outcome.EXACT}
    text = (SHIPPED / "satellite.yaml").read_text(encoding="utf-8")
    for right, wrong, about in (
        ("equals: 3*f + d,", "equals: 3*f - d,", "subsystem matrix K [sigma, sigma]"),
        ("equals: c - b - a,", "equals: a + b - c,", "subsystem matrix G [psi, phi]"),
        ("(alpha + 8)*p2)", "(alpha + 7)*p2)", "characteristic polynomial of psi"),
        ("sin(theta)*cos(phi)*sin(psi))", "sin(theta)*cos(phi)*cos(psi))", "angular velocity of satellite [2]"),
    ):
        assert text.count(right) == 1
        found = mbsym.loads(text.replace(right, wrong), (1, 5)).claims
        assert about in [result.title for result in found if result.refuted], about


# --- reports and the command line ---


def test_a_refuted_claim_is_a_finding_unless_claims_are_strict(tmp_path: Path) -> None:
    good, bad = tmp_path / "good.yaml", tmp_path / "bad.yaml"
    good.write_text(PENDULUM + "claims:\n  - {claim: kinetic energy, equals: Io*theta_dot**2/2}\n")
    bad.write_text(PENDULUM + "claims:\n  - {claim: kinetic energy, equals: J*theta_dot**2/2, place: eq. (9)}\n")
    for path, strict, code in ((good, False, 0), (good, True, 0), (bad, False, 0), (bad, True, 1)):
        words = ["run", path, "--out", tmp_path / "out", "--format", "json", "--problems", "2"]
        done = invoked(*words, *(["--strict-claims"] if strict else []))
        assert done.exit_code == code, (path, strict, done.output)
        assert ("CLAIM DOES NOT HOLD: eq. (9): kinetic energy: differs" in done.stderr) == (code == 1)
    done = invoked("run", bad, "--out", tmp_path / "out", "--format", "json", "--problems", "2")
    # J theta'^2/2 beside (J + m l^2) theta'^2/2
    told = r"Claims +1 refuted\n +eq\. \(9\), kinetic energy: differs; claimed minus derived: at theta'\^2: -m l\^2/2\n"
    assert re.search(told, done.stdout)
    done = invoked("run", bad, "--out", tmp_path / "out", "--format", "json", "--problems", "2", "-v")
    assert "Claimed minus derived is" in done.stdout
    assert "at theta'^2: -m l^2/2" in done.stdout
    found = json.loads((tmp_path / "out" / "results.json").read_text())["claims"]
    assert found[0]["word"] == "refuted"
    assert found[0]["parts"] == [{"of": "theta_dot**2", "difference": "-m*l**2/2", "same_as": "", "repairs": []}]


def test_explain_lists_the_kinds_of_claim() -> None:
    done = invoked("explain", "claims", code=0)
    assert "first integral" in done.stdout
    assert "difference = claimed - derived" in done.stdout


@needs_pdflatex
def test_the_appendix_with_claims_compiles(tmp_path: Path) -> None:
    analysis = analysed(
        "claim: kinetic energy, equals: J*theta_dot**2/2 + w2, place: eq. (1) & 50 %",
        "claim: characteristic polynomial, variable: lam, equals: lam**2 + lam + w2",
        "claim: first integral, equals: theta_dot**2 + 2*w2*cos(theta)",
        "claim: lagrangian, equals: Io*theta_dot**2/2 + m*g*l*cos(half*2) + theta_dot",
        "claim: value, of: theta_ddot, state: initial, equals: 1.23",
        "claim: condition, that: J - m > 0",
    )
    assert "Overfull" not in compiled_latex(latex(analysis, range(1, 8)), tmp_path)


# --- hostile ---


def test_growing_abbreviations_end_in_a_reason_and_cost_the_others_nothing() -> None:
    powers = ", ".join(["a0: 1 + m + theta_dot", *(f"a{k}: a{k - 1}**2" for k in range(1, 60))])
    sums = ", ".join(["b0: theta", *(f"b{k}: b{k - 1} + b{k - 1}" for k in range(1, 60))])
    text = PENDULUM.replace("Io: J", f"{powers}, {sums}, Io: J")
    found = analysed(
        "claim: kinetic energy, equals: a59",
        "claim: potential energy, equals: cos(b59)",
        "claim: first integral, equals: (a5 + sin(b8))**60",
        "claim: kinetic energy, equals: Io*theta_dot**2/2",
        text=text,
    )
    assert [result.outcome for result in found.claims[:2]] == [Outcome.UNDECIDED, Outcome.UNDECIDED]
    assert found.claims[3].outcome == Outcome.EXACT
    assert found.energy.cyclic == ()
    assert all(result.remark for result in found.claims if result.outcome == Outcome.UNDECIDED)


def test_many_costly_claims_are_bounded_together(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sixteen of them fit into what all claims may cost together, at a quarter of the usual budget."""
    monkeypatch.setattr(ring, "WORK_BUDGET", ring.WORK_BUDGET // 4)
    claim = "claim: first integral, equals: (theta_dot + cos(theta) + m + l + J + g)**16"
    found = analysed(*[claim] * 60)
    outcomes = [result.outcome for result in found.claims]
    judged = outcomes.index(Outcome.UNDECIDED)
    assert 1 < judged < 40
    assert outcomes == [Outcome.FAILS] * judged + [Outcome.UNDECIDED] * (60 - judged)
    assert found.ring.work < found.ring.work_budget
    assert str(found.energy.kinetic_energy) == "(m*l**2 + J)*theta_dot**2/2"


TURNED = """
mbsym: 1
name: on a turning table
parameters: {k: positive, W: positive, c: positive}
prescribed: {phi: {rate: W}}
bodies:
  - {name: table, attached to: 0, rotation: {axes: [3], angles: [phi]}, mass: 0}
  - {name: p, attached to: table, mass: 1, connection point: [x, y, 0], coordinates: [x, y]}
loads:
  - potential: k*(x**2 + y**2)/2
  - rayleigh: c*(x_dot**2 + y_dot**2)/2
motion: {x: 0, y: 0}
"""


def test_what_is_asked_where_a_condition_is_an_equality_is_charged() -> None:
    """At k = W^2 another description is derived, z'' + 2 i W z' + c z' = 0, with a ring of its own."""
    found = mbsym.loads(TURNED)
    whole = found.ring
    border = whole.generator("parameter", "k") - whole.generator("parameter", "W") ** 2
    with whole.budget(whole.work_budget) as spent:
        verdict = where_zero(found, border)
    assert verdict is not None
    assert verdict.stable
    assert spent.work > 1000
    with pytest.raises(Failure, match="steps of polynomial arithmetic"), whole.budget(spent.work // 2):
        where_zero(found, border)
