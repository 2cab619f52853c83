"""Claims that do not hold: factors, what a difference is compared with, counterexamples, and signs under roots.

Expectations are computed by hand, or at numbers by the plain formulas in the test.
"""

from __future__ import annotations

import json
import math
from fractions import Fraction
from pathlib import Path

import pytest
from conftest import SHIPPED, at_values, compiled_latex, filed, invoked, needs_pdflatex
from test_claims import PENDULUM, analysed, judged

import mbsym
from mbsym.problems.claims import ClaimResult, Outcome
from mbsym.report.latex.report import render as latex
from mbsym.report.results_json import results
from mbsym.report.words.claims import claim_line
from mbsym.source.text_writer import to_text
from mbsym.source.yaml_writer import to_yaml

#: T = m (r'^2 + r^2 phi'^2)/2 and U = mu m / |r|.
KEPLER = """
mbsym: 1
name: Kepler
parameters: {m: positive, mu: positive, s: real, n: negative, q: nonpositive}
bodies:
  - name: planet
    attached to: 0
    rotation: {axes: [3], angles: [phi]}
    connection point: [r*cos(phi), r*sin(phi), 0]
    coordinates: [r, phi]
    mass: m
loads:
  - newtonian gravity: {constant: mu, centre: 0, about: planet, order: exact}
"""
EQUATION = "claim: equation of motion, of: theta, equals: "
#: Two pendulums side by side: the conditions of stability are k1 > 0 and k2 > 0.
SPRINGS = """
mbsym: 1
name: Two springs
parameters: {m: positive, k1: real, k2: real}
bodies:
  - {name: a, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: m}
  - {name: b, attached to: 0, connection point: [y, 0, 0], coordinates: [y], mass: m}
loads:
  - spring: {coordinate: x, stiffness: k1}
  - spring: {coordinate: y, stiffness: k2}
motion: {x: 0, y: 0}
"""


def shown(claim: str, text: str = PENDULUM) -> tuple[str, str, tuple[str, ...]]:
    line = claim_line(judged(claim, text=text))
    return line.word, line.outcome, line.lines


# --- factors ---


def test_a_wrong_factor_never_reads_as_holding() -> None:
    """2 T for T, and the opposite direction cosine: errors; the terminal, results.json and the appendix agree."""
    claims = (
        "claim: kinetic energy, equals: Io*theta_dot**2",
        "claim: direction cosine, of: bob, entry: [2, 1], equals: sin(theta)",
        EQUATION + "theta_ddot + w2*sin(theta)",  # the control: here a factor is immaterial
    )
    analysis = analysed(*claims)
    lines = [claim_line(result) for result in analysis.claims]
    assert [line.outcome for line in lines] == [
        "differs by the factor 2",
        "differs by the factor -1",
        "holds up to a factor: claimed = 1/(m*l**2 + J) times derived",
    ]
    assert [line.word for line in lines] == ["refuted", "refuted", "held"]
    written = results(analysis, range(1, 8))["claims"]
    assert [(one["word"], one["outcome"], one["factor"]) for one in written] == [
        ("refuted", Outcome.SCALED, "2"),
        ("refuted", Outcome.SCALED, "-1"),
        ("held", Outcome.FACTOR, "1/(m*l**2 + J)"),
    ]
    for one in written:
        assert ("holds" in one["outcome"]) == (one["word"] == "held")
    table = latex(analysis, range(1, 8))
    assert r"\textbf{differs by the factor $2$}" in table
    assert table.count("holds up to a factor") == 1


@pytest.mark.parametrize(
    ("claim", "factor", "remark"),
    [
        (EQUATION + "(theta_ddot + w2*sin(theta))*cos(theta)", "cos(theta)/(m*l**2 + J)", "where cos(theta) is not 0"),
        (EQUATION + "theta_dot*(theta_ddot + w2*sin(theta))", "theta_dot/(m*l**2 + J)", "where theta_dot is not 0"),
        (EQUATION + "(m - l)*(Io*theta_ddot + m*g*l*sin(theta))", "m - l", "where m - l is not 0"),
        (EQUATION + "-m*(Io*theta_ddot + m*g*l*sin(theta))", "-m", ""),
    ],
)
def test_a_factor_that_may_vanish_is_told(claim: str, factor: str, remark: str) -> None:
    result = judged(claim)
    assert (result.outcome, str(result.factor), result.remark, result.holds) == (
        Outcome.FACTOR,
        factor,
        remark,
        True,
    )


# --- what a difference is compared with ---


@pytest.mark.parametrize(
    ("claim", "factor", "parts"),
    [
        # Divided by Io = J + m l^2 and with the wrong sign: w2 sin - (-w2 sin) = 2 w2 sin too little.
        (EQUATION + "theta_ddot - w2*sin(theta)", "1/(m*l**2 + J)", {"1": "-2*m*l*g*sin(theta)/(m*l**2 + J)"}),
        # The true equation times 1/Io, and 3 theta' too much: nothing else is wrong.
        (EQUATION + "theta_ddot + w2*sin(theta) + 3*theta_dot", "1/(m*l**2 + J)", {"theta_dot": "3"}),
        # Scaled by -2/m.
        (EQUATION + "-2/m*(Io*theta_ddot + m*g*l*sin(theta)) + theta_dot**2", "-2/m", {"theta_dot**2": "1"}),
        # As it stands, only the inertia is wrong: it is not scaled.
        (EQUATION + "m*l**2*theta_ddot + m*g*l*sin(theta)", None, {"theta_ddot": "-J"}),
        (EQUATION + "Io*theta_ddot - m*g*l*sin(theta)", None, {"1": "-2*m*l*g*sin(theta)"}),
    ],
)
def test_a_difference_is_what_is_wrong_and_no_more(claim: str, factor: str | None, parts: dict[str, str]) -> None:
    result = judged(claim)
    assert result.outcome == Outcome.DIFFERS
    assert (None if result.factor is None else str(result.factor)) == factor
    assert {str(part.factor): str(part.difference) for part in result.parts} == parts


def test_a_polynomial_is_compared_with_the_multiple_that_agrees() -> None:
    result = judged("claim: characteristic polynomial, variable: p, equals: p**2 + p/3 + w2")
    assert (result.outcome, str(result.factor)) == (Outcome.DIFFERS, "1/(m*l**2 + J)")
    assert [(part.power, str(part.difference)) for part in result.parts] == [(1, "1/3")]
    line = claim_line(result)
    assert line.outcome == "differs (compared with 1/(m*l**2 + J) times derived)"
    assert line.lines == ("at p**1: claimed - factor*derived = 1/3",)
    # A root too many is no factor that may be dropped.
    assert judged("claim: characteristic polynomial, variable: p, equals: p*(p**2 + w2)").outcome == Outcome.DIFFERS


# --- first integrals ---


def test_a_refuted_integral_shows_its_rate_and_a_state() -> None:
    claim = "claim: first integral, equals: theta_dot**2 + 2*w2*cos(theta)"
    word, outcome, lines = shown(claim)
    assert (word, outcome) == ("refuted", "does not hold")
    # theta'' = -w2 sin(theta), so d/dt (theta'^2 + 2 w2 cos theta) = -4 w2 sin(theta) theta'.
    assert lines[0] == "dI/dt on the equations of motion = -4*m*l*g*theta_dot*sin(theta)/(m*l**2 + J)"
    assert lines[1].startswith("for example at m = 1, l = 2, J = 1/2, g = 981/100, theta = ")
    result = judged(claim)
    assert result.counterexample is not None
    at = {name: float(Fraction(value)) for name, value in result.counterexample.at}
    ((what, value),) = result.counterexample.shows
    w2 = at["m"] * at["g"] * at["l"] / (at["J"] + at["m"] * at["l"] ** 2)
    assert what == "dI/dt"
    assert float(value) == pytest.approx(-4 * w2 * math.sin(at["theta"]) * at["theta_dot"], rel=1e-11)
    assert "det" not in latex(analysed(claim), range(1, 8)).partition("section*{Claims}")[2]
    # The control: the integral itself has neither.
    right = judged("claim: first integral, equals: theta_dot**2 - 2*w2*cos(theta)")
    assert (right.outcome, right.counterexample, right.difference) == (Outcome.EXACT, None, None)


def test_where_the_rate_is_too_long_there_is_still_a_state() -> None:
    """Six coordinates: no closed form of M^-1 f; that x_A' is not constant is seen at the state that is told."""
    text = (SHIPPED / "tethered-satellites.yaml").read_text(encoding="utf-8").partition("\nclaims:")[0]
    (result,) = mbsym.loads(text + "\nclaims:\n  - {claim: first integral, equals: x_A_dot}\n", (3,)).claims
    assert (result.outcome, result.difference) == (Outcome.FAILS, None)
    assert result.counterexample is not None
    state = ", ".join(f"{name}: {value}" for name, value in result.counterexample.at)
    rate = dict(result.counterexample.shows)["dI/dt"]
    value = f"{{claim: value, of: x_A_ddot, state: {{{state}}}, equals: {rate}}}"
    (again,) = mbsym.loads(f"{text}\nclaims:\n  - {value}\n", (3,)).claims
    assert again.holds
    assert float(rate) != 0


def test_a_counterexample_keeps_relations_and_given_numbers() -> None:
    """k = m g l: with k in the claim, k is what the relation gives, and the claim holds on it."""
    claim = "claim: first integral, equals: Io*theta_dot**2 {} 2*k*cos(theta)"
    assert judged(claim.format("-")).outcome == Outcome.RELATIONS
    result = judged(claim.format("+"))
    assert result.outcome == Outcome.FAILS
    at = {name: float(Fraction(value)) for name, value in result.counterexample.at}
    k = at["m"] * at["g"] * at["l"]
    # d/dt (Io theta'^2 + 2 k cos) = 2 theta' (Io theta'' - k sin) = -4 k sin(theta) theta'.
    expected = -4 * k * math.sin(at["theta"]) * at["theta_dot"]
    assert float(dict(result.counterexample.shows)["dI/dt"]) == pytest.approx(expected, rel=1e-11)


# --- conditions ---


def conditions(*claims: str, text: str = SPRINGS) -> list[ClaimResult]:
    return list(analysed(*(f"claim: condition, {one}" for one in claims), text=text).claims)


def test_conditions_are_refuted_by_parameters() -> None:
    """Stable exactly for k1 > 0 and k2 > 0."""
    stronger, other = conditions("that: k1 > k2", "that: k1 + k2 > 1")
    for result, fails in ((stronger, lambda a, b: a <= b), (other, lambda a, b: a + b <= 1)):
        assert (result.outcome, result.refuted) == (Outcome.FAILS, True)
        assert result.remark == "it is not necessary for stability"
        at = {name: Fraction(value) for name, value in result.counterexample.at}
        assert at["k1"] > 0
        assert at["k2"] > 0
        assert fails(at["k1"], at["k2"])
    assert dict(stronger.counterexample.shows)["the motion"].startswith("stable")
    line = claim_line(stronger)
    assert (line.word, line.outcome) == ("refuted", "does not hold: it is not necessary for stability")
    assert line.lines[0].startswith("for example at m = ")
    # The controls: conditions that are right, and one that is weaker than what is needed: it follows from both.
    for result in conditions("that: k1 > 0", "as: necessary, that: 3*k2 > 0"):
        assert result.outcome == Outcome.EXACT
    (weaker,) = conditions("as: necessary, that: k1 + k2 > 0")
    assert (weaker.outcome, weaker.refuted, weaker.counterexample) == (Outcome.BORDERS, False, None)
    assert weaker.remark.startswith("it follows from v0 of x and v0 of y")


def test_sufficient_conditions_of_one_place_count_together() -> None:
    alone, *both = conditions(
        "as: sufficient, that: k1 > 0, place: one",
        "as: sufficient, that: k1 > 0, place: two",
        "as: sufficient, that: k2 > 0, place: two",
    )
    assert (alone.outcome, alone.remark) == (Outcome.FAILS, "it is not sufficient for stability")
    at = {name: Fraction(value) for name, value in alone.counterexample.at}
    assert at["k1"] > 0 > at["k2"]
    assert dict(alone.counterexample.shows)["the motion"].startswith("unstable")
    assert [result.outcome for result in both] == [Outcome.EXACT, Outcome.EXACT]
    (stronger,) = conditions("as: sufficient, that: k1 > 1 - k2*0")
    assert stronger.refuted
    # Stronger than needed is no error in a sufficient condition, and an error in a necessary one.
    text = SPRINGS.replace("k2: real", "k2: positive")
    assert conditions("as: sufficient, that: k1 > k2", text=text)[0].outcome == Outcome.EXACT
    assert conditions("as: necessary, that: k1 > k2", text=text)[0].outcome == Outcome.FAILS


def test_a_counterexample_is_a_body_and_keeps_assumptions() -> None:
    """In orbit C < A + B for every body: C < 3*A + 3*B cannot be refuted by moments that no body has."""
    path = SHIPPED / "gravity-gradient.yaml"
    text = path.read_text(encoding="utf-8").replace("assumptions:\n  - A + B > C\n  - B + C > A\n  - C + A > B\n", "")
    assert "assumptions" not in text
    fine, wrong = conditions("that: A + B >= C", "that: C > 7*A", text=text)
    assert not fine.refuted
    values = {name: Fraction(value) for name, value in wrong.counterexample.at}
    assert values["A"] + values["B"] >= values["C"]
    assert values["nu"] == values["omega0"] ** 2 * values["R"] ** 3
    verdict = at_values(path, **dict(wrong.counterexample.at)).stability.numerical
    assert verdict is not None
    assert verdict.word.startswith("stable")


def test_a_motion_stable_in_first_approximation_only_is_told_as_that() -> None:
    """K > 0 is sufficient, not necessary: gyroscopic forces stabilise without it in the first approximation."""
    text = (SHIPPED / "orbital-gyrostat.yaml").read_text(encoding="utf-8").partition("\nclaims:")[0]
    (necessary,) = conditions("as: necessary, that: B - A + h > 0", text=text)
    assert necessary.outcome == Outcome.FAILS
    assert necessary.remark == "it is not necessary for stability in the first approximation"
    assert dict(necessary.counterexample.shows)["the motion"] == "gyroscopically stabilised only"
    (either,) = conditions("that: B - A + h > 0", text=text)
    assert either.outcome == Outcome.EXACT


def test_the_role_of_a_condition_is_written_and_read() -> None:
    analysis = analysed("claim: condition, as: sufficient, that: J > m")
    for written in (to_yaml(analysis.system), to_text(analysis.system)):
        assert [claim.role for claim in mbsym.loads(written).system.claims] == ["sufficient"]
    with pytest.raises(Exception, match="role of a condition"):
        analysed("claim: condition, as: nice, that: J > m")
    with pytest.raises(Exception, match="'as'"):
        analysed("claim: kinetic energy, as: necessary, equals: 0")


# --- signs under roots ---


@pytest.mark.parametrize(
    ("claim", "outcome", "where"),
    [
        ("equation of motion, of: r, equals: m*(r_ddot - r*phi_dot**2 + mu/r**2)", Outcome.EXACT, "r > 0"),
        ("equation of motion, of: r, equals: r_ddot - r*phi_dot**2 + mu/r**2", Outcome.FACTOR, "r > 0"),
        ("equation of motion, of: r, equals: r_ddot - r*phi_dot**2 - mu/r**2", Outcome.DIFFERS, ""),
        ("equation of motion, of: r, equals: r_ddot - r*phi_dot**2 + mu/r**3", Outcome.DIFFERS, ""),
        ("equation of motion, of: r, equals: r_ddot - r*phi_dot**2 + mu*r/sqrt(r**2)**3", Outcome.FACTOR, ""),
        ("equation of motion, of: phi, equals: r*phi_ddot + 2*r_dot*phi_dot", Outcome.FACTOR, ""),
        ("force function, equals: mu*m/r", Outcome.EXACT, "r > 0"),
        ("force function, equals: -mu*m/r", Outcome.DIFFERS, ""),  # true for r < 0 only: a wrong sign
        ("first integral, equals: r_dot**2 + r**2*phi_dot**2 - 2*mu/r", Outcome.EXACT, "r > 0"),
        ("first integral, equals: r_dot**2 + r**2*phi_dot**2 - 2*mu/sqrt(r**2)", Outcome.EXACT, ""),
        ("first integral, equals: r_dot**2 + r**2*phi_dot**2 - 4*mu/r", Outcome.FAILS, ""),
        ("first integral, equals: r**2*phi_dot", Outcome.EXACT, ""),
        ("coefficient, of: kinetic energy, at: r_dot**2, equals: m/2*sqrt(s**2)/s", Outcome.EXACT, "s > 0"),
        ("coefficient, of: kinetic energy, at: r_dot**2, equals: -m/2*sqrt(n**2)/n", Outcome.EXACT, ""),
        ("coefficient, of: kinetic energy, at: r_dot**2, equals: m/2*sqrt(n**2)/n", Outcome.SCALED, ""),  # by -1
        ("coefficient, of: kinetic energy, at: r_dot**2, equals: m/2*sqrt(exp(s)**2)/exp(s)", Outcome.EXACT, ""),
    ],
)  # fmt: skip
def test_what_holds_for_one_sign_is_told_to(claim: str, outcome: str, where: str) -> None:
    result = judged(f"claim: {claim}", text=KEPLER)
    assert result.outcome == outcome
    name = where.partition(" ")[0]
    assert result.where == (f"for {where} (it does not for {name} < 0)" if where else "")


def test_the_restriction_is_in_every_report(tmp_path: Path) -> None:
    path = filed(tmp_path / "kepler.yaml", KEPLER + "claims:\n  - {claim: force function, equals: mu*m/r}\n")
    words = ["run", "-v", str(path), "--out", str(tmp_path / "out"), "--problems", "1-3", "--format", "json,latex"]
    done = invoked(*words)
    assert "force function | holds exactly for r > 0 (it does not for r < 0)" in done.stdout
    (written,) = json.loads((tmp_path / "out" / "results.json").read_text(encoding="utf-8"))["claims"]
    assert (written["word"], written["where"]) == ("held", "for r > 0 (it does not for r < 0)")
    assert "holds exactly for r" in (tmp_path / "out" / "report.tex").read_text(encoding="utf-8")


# --- the appendix ---


@needs_pdflatex
def test_the_appendix_with_refuted_claims_compiles(tmp_path: Path) -> None:
    analysis = analysed(
        EQUATION + "theta_ddot - w2*sin(theta) + 3*theta_dot, place: eq. (2) & 50 %",
        "claim: characteristic polynomial, variable: lam, equals: lam**2 + lam + w2",
        "claim: first integral, equals: theta_dot*cos(theta)",
        "claim: condition, that: J - m > 0, place: 'p. 5, #3'",
        "claim: kinetic energy, equals: Io*theta_dot**2",
    )
    assert "Overfull" not in compiled_latex(latex(analysis, range(1, 8)), tmp_path)


def test_parameters_that_follow_keep_their_declared_signs() -> None:
    """k1 = a - b is declared positive: no counterexample has a < b."""
    text = SPRINGS.replace(
        "k1: real, k2: real}", "k1: positive, k2: positive, a: positive, b: positive}\nrelations: {k1: a - b}"
    )
    assert not conditions("as: sufficient, that: a > 0", text=text)[0].refuted


def test_a_border_of_a_condition_is_told() -> None:
    for weak, strict in (("k1 >= 0", "k1 > 0"), ("0 <= k1", "0 < k1")):
        border, inside = conditions(f"that: {weak}", f"that: {strict}")
        assert border.outcome == inside.outcome == Outcome.EXACT
        assert border.remark.endswith(", but for the case of equality")
        assert "equality" not in inside.remark


def test_what_always_holds_is_not_sufficient_for_that() -> None:
    """U = -k x^4 is a hill; the first approximation does not see it, the nonlinear system is looked into."""
    hill = SPRINGS.partition("  - {name: b")[0].replace("k1: real, k2: real", "k: positive")
    hill += "loads:\n  - potential: -k*x**4\nmotion: {x: 0}\n"
    (result,) = conditions("as: sufficient, that: k > 0", text=hill)
    assert (result.outcome, result.holds) == (Outcome.FAILS, False)
    assert dict(result.counterexample.shows)["the motion"] == "unstable (converse of Lagrange-Dirichlet)"


def test_denominators_count_by_their_signs() -> None:
    """k1/a^2 > 0 is k1 > 0 wherever it makes sense; k1/a > 0 is not."""
    text = SPRINGS.replace("k2: real}", "k2: real, a: real}")
    even, odd = conditions("that: k1/a**2 > 0", "that: k1/a > 0", text=text)
    assert (even.outcome, odd.outcome) == (Outcome.EXACT, Outcome.FAILS)


def test_only_sufficient_conditions_of_a_place_count_together() -> None:
    one, other = conditions("as: sufficient, that: k1 > 0, place: two", "as: necessary, that: k2 > 0, place: two")
    assert (one.outcome, other.outcome) == (Outcome.FAILS, Outcome.EXACT)


TURNTABLE = """
mbsym: 1
name: Particle on a turntable
parameters: {m: positive, k1: real, k2: real, w: positive}
prescribed: {chi: w}
bodies:
  - {name: table, attached to: 0, rotation: {axes: [3], angles: [chi]}, mass: 0}
  - {name: p, attached to: table, connection point: [x, y, 0], coordinates: [x, y], mass: m}
loads:
  - spring: {coordinate: x, stiffness: k1}
  - spring: {coordinate: y, stiffness: k2}
motion: {x: 0, y: 0}
values: {m: 1, k1: 1, k2: 1, w: 2}
"""


def test_a_firm_counterexample_is_preferred() -> None:
    """k1, k2 > m w^2: a minimum; for k1 = k2 < m w^2 the linear equations of the turning frame have simple pairs."""
    firm, weak = conditions("as: necessary, that: k1 > 1000", "as: necessary, that: k1 > m*w**2", text=TURNTABLE)
    assert firm.remark == "it is not necessary for stability"
    assert weak.remark == "it is not necessary for stability"


DRIVEN = """
mbsym: 1
name: Driven
parameters: {m: positive, k: positive, F: positive}
bodies:
  - {name: a, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: m}
loads:
  - spring: {coordinate: x, stiffness: k}
  - generalized force: {x: F*cos(t)}
"""


def test_the_time_is_told_where_it_matters() -> None:
    """dI/dt = F cos(t) x'."""
    driven = judged("claim: first integral, equals: m*x_dot**2/2 + k*x**2/2", text=DRIVEN)
    assert dict(driven.counterexample.at)["t"] == "0"
    free = judged("claim: first integral, equals: m*x_dot**2/2 - k*x**2/2", text=DRIVEN.partition("  - gener")[0])
    assert "t" not in dict(free.counterexample.at)


def test_a_polynomial_is_compared_by_its_highest_power() -> None:
    """Io p^2 + m g l times 2 or times 3 would do equally well."""
    result = judged("claim: characteristic polynomial, variable: p, equals: 2*Io*p**2 + 3*m*g*l")
    assert (result.outcome, str(result.factor)) == (Outcome.DIFFERS, "2")
    assert [(part.power, str(part.difference)) for part in result.parts] == [(0, "m*l*g")]


def test_a_factor_that_may_be_infinite_is_told() -> None:
    result = judged(EQUATION + "(Io*theta_ddot + m*g*l*sin(theta))/cos(theta)")
    assert (result.outcome, result.remark) == (Outcome.FACTOR, "where cos(theta) is not 0")


@pytest.mark.parametrize(
    ("ratio", "outcome", "where"),
    [
        (
            "s*sqrt(1/s**2)",
            Outcome.NUMERICAL,
            "for s > 0 (it does not for s < 0)",
        ),  # under a root, in a reciprocal
        (
            "sqrt(s**2)/s*sqrt(r**2)/r",
            Outcome.EXACT,
            "for r > 0, s > 0 (it need not with other signs)",
        ),  # also for both < 0
        ("(sqrt(s**2)/s + sqrt(r**2)/r)/2", Outcome.EXACT, "for r > 0, s > 0 (it need not with other signs)"),
        ("(-sqrt(q**2)/q)", Outcome.EXACT, ""),  # q <= 0
    ],
)
def test_signs_under_roots_that_are_harder(ratio: str, outcome: str, where: str) -> None:
    result = judged(f"claim: coefficient, of: kinetic energy, at: r_dot**2, equals: m/2*{ratio}", text=KEPLER)
    assert (result.outcome, result.where) == (outcome, where)


@pytest.mark.parametrize(
    ("claim", "outcome", "where"),
    [
        ("kinetic energy, equals: Io*theta_dot*sqrt(theta_dot**2)/2", Outcome.EXACT, "theta_dot"),
        ("potential energy, equals: -m*g*l*sqrt(cos(theta)**2)", Outcome.EXACT, "cos(theta)"),
        ("potential energy, equals: -m*g*l*sqrt(1 - sin(theta)**2)", Outcome.EXACT, "cos(theta)"),
        (
            "direction cosine, of: bob, entry: [1, 2], equals: sqrt(1 - cos(theta)**2)",
            Outcome.NUMERICAL,
            "sin(theta)",
        ),
        (
            "direction cosine, of: bob, entry: [1, 2], equals: sin(atan(tan(theta)))",
            Outcome.NUMERICAL,
            "cos(theta)",
        ),
        ("direction cosine, of: bob, entry: [1, 2], equals: sin(sqrt(theta**2))", Outcome.NUMERICAL, "theta"),
        ("angular velocity, of: bob, component: 3, equals: sqrt(theta_dot**2)", Outcome.EXACT, "theta_dot"),
        ("angular velocity, of: bob, component: 3, equals: -sqrt(theta_dot**2)", Outcome.DIFFERS, ""),
        (
            "equation of motion, of: theta, equals: theta_ddot + w2*sqrt(sin(theta)**2)",
            Outcome.NUMERICAL,
            "sin(theta)",
        ),
        ("direction cosine, of: bob, entry: [1, 1], equals: sqrt(cos(theta)**2 + 1e-30)", Outcome.DIFFERS, ""),
    ],
)
def test_velocities_and_sines_have_signs_too(claim: str, outcome: str, where: str) -> None:
    """True where the root is that of a positive quantity; a nutation angle may be meant, a velocity hardly."""
    result = judged(f"claim: {claim}")
    expected = f"for {where} > 0 (it does not for {where} < 0)" if where else ""
    assert (result.outcome, result.where) == (outcome, expected)


@pytest.mark.parametrize(
    ("integral", "remark"),
    [
        ("sqrt(theta_dot**2)/theta_dot", "it is a constant, whatever the motion"),
        ("sqrt(theta_dot**2) - theta_dot", "it is a constant for theta_dot > 0, whatever the motion"),
        ("exp(theta_dot)*exp(-theta_dot) + m", "it contains no velocity"),
    ],
)
def test_a_number_is_no_integral(integral: str, remark: str) -> None:
    result = judged(f"claim: first integral, equals: {integral}")
    assert (result.outcome, result.remark) == (Outcome.FAILS, remark)


@pytest.mark.parametrize(
    ("claim", "outcome"),
    [
        ("kinetic energy, equals: T + 3*theta_dot", Outcome.DIFFERS),
        ("kinetic energy, equals: T + m", Outcome.DIFFERS),
        ("potential energy, equals: m - m*g*l*cos(theta)", Outcome.EQUIVALENT),
        ("potential energy, equals: t**2 - m*g*l*cos(theta)", Outcome.EQUIVALENT),
        ("potential energy, equals: theta_dot*theta - m*g*l*cos(theta)", Outcome.DIFFERS),
        ("force function, equals: m*g*l*cos(theta) + t*theta_dot + theta", Outcome.DIFFERS),
        ("lagrangian, equals: T + m*g*l*cos(theta) + t*theta_dot + theta", Outcome.EQUIVALENT),
    ],
)
def test_only_a_lagrangian_is_one_with_a_total_derivative_added(claim: str, outcome: str) -> None:
    """dF(q, t)/dt is no kinetic energy and no potential, though the equations of motion are the same."""
    result = judged(f"claim: {claim}")
    assert result.outcome == outcome
    word, said, _ = shown(f"claim: {claim}")
    assert word == ("held" if outcome == Outcome.EQUIVALENT else "refuted")
    assert "the equations of motion are the same" in said or "by a constant" in said


def test_a_factor_may_hold_velocities() -> None:
    """An equation times theta' sin(theta) says the same wherever that is not zero."""
    result = judged(EQUATION + "(theta_ddot + w2*sin(theta))*sin(theta)*theta_dot")
    assert (result.outcome, result.remark) == (Outcome.FACTOR, "where sin(theta) and theta_dot are not 0")


def test_an_integral_that_is_huge_at_some_states_is_not_refuted_by_them() -> None:
    """z'' = -g - c z'/m: (z' + m g/c) exp(c t/m) is constant, at whatever size; with exp(2 c t/m) it is not."""
    lines = "".join(f"  - {{claim: first integral, equals: (z_dot + m*g/c)*exp({n}*c*t/m)}}\n" for n in (1, 2))
    found = mbsym.loads(
        "mbsym: 1\nname: fall in a turning frame\n"
        "parameters: {m: positive, g: positive, c: nonnegative, W: real}\nprescribed: {chi: {rate: W}}\nbodies:\n"
        "  - {name: f, attached to: 0, rotation: {axes: [3], angles: [chi]}, mass: 0}\n"
        "  - {name: p, attached to: f, mass: m, connection point: [x, y, z], coordinates: [x, y, z]}\n"
        "loads:\n  - uniform gravity: {vector: [0, 0, -g]}\n  - damper: {coordinate: z, coefficient: c}\n"
        f"claims:\n{lines}"
    ).claims
    assert [one.outcome for one in found] == [Outcome.EXACT, Outcome.FAILS]


def test_an_integral_is_refuted_where_numbers_are_tied_by_a_relation() -> None:
    """A bead on a hoop whose weight is what lets it rest at theta0: no numbers to show are found, and yet it fails."""
    (result,) = mbsym.loads(
        "mbsym: 1\nname: bead\nparameters: {m: positive, R: positive, g: positive, W: positive, a: positive}\n"
        "prescribed: {psi: {rate: W}}\nbodies:\n"
        "  - {name: hoop, attached to: 0, mass: 0, rotation: {axes: [3], angles: [psi]}}\n"
        "  - {name: bead, attached to: hoop, mass: m, coordinates: [q], connection point: [R*sin(q), 0, -R*cos(q)]}\n"
        "loads:\n  - uniform gravity: {acceleration: g, direction: [0, 0, -1]}\n"
        "motion: {q: a}\nrelations: {g: R*W**2*cos(a)}\n"
        "claims:\n  - {claim: first integral, equals: R*q_dot**2/2 - R*W**2*sin(q)**2/2 + g*cos(q)}\n"
    ).claims
    assert result.outcome == Outcome.FAILS
