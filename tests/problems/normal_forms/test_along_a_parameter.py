"""Exceptional values along a parameter: the restricted problem of three bodies, the top, a flutter border by hand."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest
from click.testing import CliRunner
from conftest import SHIPPED, filed
from flint import arb
from jsonschema import Draft202012Validator

import mbsym
from mbsym.analysis.judge import exceptional
from mbsym.analysis.stages import Unavailable
from mbsym.problems.normal_forms.along import NotAlong
from mbsym.problems.normal_forms.expansion import NotExpanded
from mbsym.problems.normal_forms.result import Outcome, Theorem, Why
from mbsym.report.schemas import schema
from mbsym.report.words.exceptional_values import lines
from mbsym_cli.main import main

#: Meyer & Schmidt (1986), Deprit (1967), Markeev (1969), Sokolskii (1975): 27 mu (1 - mu)/4 = w1^2 w2^2.
TRIANGULAR = [
    ("0.010913667677200662890", Outcome.STABLE, Theorem.ARNOLD_MOSER_6),
    ("0.013516016022452526756", Outcome.UNSTABLE, Theorem.FOURTH),
    ("0.024293897142052321666", Outcome.UNSTABLE, Theorem.THIRD),
    ("0.038520896504551397079", Outcome.STABLE, Theorem.EQUAL),
]


def test_triangular_points() -> None:
    one = Fraction(1)
    analysis = mbsym.load(SHIPPED / "three-bodies.yaml")
    found = exceptional(analysis, "mu", (Fraction(0), Fraction(1, 2)), {"a": one, "n": one, "m": one})
    assert [(x.judged.outcome, x.judged.theorem) for x in found.specials] == [x[1:] for x in TRIANGULAR]
    for special, (value, _, _) in zip(found.specials, TRIANGULAR, strict=True):
        assert special.enclosure.str(20, radius=False) == value
    assert [x.judged.outcome for x in found.between] == [Outcome.STABLE] * 4 + [Outcome.UNSTABLE]
    # 36 - 541 p + 644 p^2 with p = 27 mu (1 - mu)/4, divided by 9/4
    assert found.specials[0].polynomial == (16, -1623, 14664, -26082, 13041)


def test_the_sleeping_top_has_no_exception_above_its_border() -> None:
    """C^2 W^2 = 4 A m g l is the border; at w1 = 3 w2 the resonant term is zero, by symmetry.

    At the border it is stable: with both momenta C W the reduced potential (C W)^2 tan^2(th/2)/(2 A) + m g l cos th is
    there ((C W)^2/(48 A) + m g l/24) th^4 + ..., a minimum.
    """
    analysis = mbsym.load(SHIPPED / "heavy-top.yaml")
    values = {name: Fraction(1) for name in ("A", "C", "m", "l", "g")}
    found = exceptional(analysis, "Omega", (Fraction(1), Fraction(3)), values)
    border, *others = found.specials
    assert border.exactly == 2
    assert (border.judged.outcome, border.judged.theorem) == (Outcome.STABLE, Theorem.EQUAL)
    assert found.between[0].judged.outcome is Outcome.UNSTABLE
    assert all(x.judged.outcome is Outcome.STABLE for x in (*found.between[1:], *others))


FLUTTER = """
mbsym: 1
name: van der Pol
parameters: {d: {}, s: {}, k: {}}
bodies:
  - {name: one, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - {potential: k*x**2/2 + x**4/4}
  - {generalized force: {x: "(d**3/3 - d - s*x**2)*x_dot"}}
motion: {x: 0}
"""


@pytest.mark.parametrize(("s", "outcome"), [(1, Outcome.ASYMPTOTIC), (-1, Outcome.UNSTABLE)])
def test_flutter_borders(s: int, outcome: Outcome) -> None:
    """x'' - (d^3/3 - d - s x^2) x' + x + x^3: borders d = 0, +-sqrt(3), all with a = -s/8 (x^3 adds nothing)."""
    values = {"s": Fraction(s), "k": Fraction(1)}
    found = exceptional(mbsym.loads(FLUTTER), "d", (Fraction(-2), Fraction(2)), values)
    assert [x.exactly for x in found.specials] == [None, 0, None]
    for special in found.specials:
        assert special.judged.outcome is outcome
        a = special.judged.coefficient
        assert abs(a + arb(s) / 8) < 1e-30 if isinstance(a, arb) else str(a) == f"{-s}/8"
    stable, unstable = Outcome.ASYMPTOTIC, Outcome.UNSTABLE
    assert [x.judged.outcome for x in found.between] == [stable, unstable, stable, unstable]


def test_a_zero_root_by_its_cubic_term() -> None:
    """Damped (d = 1: -2/3 x'), k through 0: V = x^4/4 there: asymptotically stable."""
    values = {"s": Fraction(1), "d": Fraction(1)}
    found = exceptional(mbsym.loads(FLUTTER), "k", (Fraction(-1), Fraction(1)), values)
    assert [x.exactly for x in found.specials] == [0]
    assert found.specials[0].judged.outcome is Outcome.ASYMPTOTIC
    assert found.specials[0].judged.theorem is Theorem.REDUCTION
    assert [x.judged.outcome for x in found.between] == [Outcome.UNSTABLE, Outcome.ASYMPTOTIC]


def test_where_the_coefficient_vanishes_no_border_is_soft_or_hard() -> None:
    """A pendulum without friction is no focus: a = 0 there, exactly."""
    analysis = mbsym.load(SHIPPED / "simple-pendulum.yaml")
    values = dict.fromkeys(("m", "l", "J", "g"), Fraction(1))
    found = exceptional(analysis, "b", (Fraction(-1), Fraction(1)), values)
    assert [(x.exactly, x.judged.outcome, x.judged.why) for x in found.specials] == [
        (0, Outcome.UNDECIDED, Why.COEFFICIENT_OPEN)
    ]
    assert not any("soft" in line or "hard" in line for line in lines(found))


def test_an_interval_with_a_singular_value_is_refused() -> None:
    """x'' - (d^3/3 - d - s x^2) x' + ... over d: nothing is known beyond a pole."""
    text = FLUTTER.replace("(d**3/3 - d - s*x**2)", "(d - 1/d - s*x**2)")
    values = {"s": Fraction(1), "k": Fraction(1)}
    with pytest.raises(NotAlong, match="singular at d = 0"):
        exceptional(mbsym.loads(text), "d", (Fraction(-2), Fraction(2)), values)
    found = exceptional(mbsym.loads(text), "d", (Fraction(1, 2), Fraction(2)), values)
    assert [x.exactly for x in found.specials] == [1]


def test_a_planted_mistake_is_not_taken_for_a_root() -> None:
    """A wrong coefficient moves the list away from Routh's value: the polynomials are those of the description."""
    text = (SHIPPED / "three-bodies.yaml").read_text(encoding="utf-8").replace("+ mu/sqrt((x", "+ 2*mu/sqrt((x")
    with pytest.raises(Unavailable):
        exceptional(mbsym.loads(text), "mu", (Fraction(0), Fraction(1, 2)), dict.fromkeys("anm", Fraction(1)))


def test_refusals() -> None:
    one, interval = Fraction(1), (Fraction(0), Fraction(1))
    satellite = mbsym.load(SHIPPED / "gravity-gradient.yaml")
    values = {parameter.name: one for parameter in satellite.system.parameters}
    with pytest.raises(NotAlong, match="two frequencies"):
        exceptional(satellite, "A", interval, values)
    with pytest.raises(NotExpanded, match="under constraints only rests"):
        exceptional(mbsym.load(SHIPPED / "rolling-disc.yaml"), "m", interval, {})
    with pytest.raises(NotAlong, match="sum is zero"):
        exceptional(mbsym.load(SHIPPED / "ziegler.yaml"), "P", interval, dict.fromkeys("mlk", one))
    linear = mbsym.loads(
        "mbsym: 1\nname: linear\nparameters: {a: real}\nloads: [potential: a*x**2/2 + y**2]\nmotion: {}\n"
        "bodies: [{name: p, mass: 1, connection point: [x, y, 0], coordinates: [x, y]}]\n"
    )
    with pytest.raises(NotAlong, match="no terms of fourth order"):
        exceptional(linear, "a", interval, {})


def test_the_command(tmp_path: Path) -> None:
    runner = CliRunner()
    done = runner.invoke(main, ["nonlinear", str(SHIPPED / "three-bodies.yaml"), "--vary", "mu=1/100:1/50"])
    assert done.exit_code == 0
    assert "mu = 0.010913667677200662890: stable (Arnold-Moser, order 6)" in done.output
    done = runner.invoke(main, ["nonlinear", str(SHIPPED / "three-bodies.yaml"), "--vary", "mu=1/100:1/50", "--json"])
    assert [one["verdict"] for one in json.loads(done.output)["values"]] == ["stable", "unstable"]
    wrong = ["--set", "b=1", "--set", "a=x", "--json"]
    done = runner.invoke(main, ["nonlinear", str(SHIPPED / "three-bodies.yaml"), *wrong])
    assert done.exit_code == 2
    assert [code in done.output for code in ("unknown-name", "bad-number")] == [True] * 2


def test_without_a_parameter_to_vary_the_values_decide(tmp_path: Path) -> None:
    """27 mu (1 - mu) is 0.27 at mu = 1/100 and 1.28 > 1 at 1/20, where Routh's condition fails."""
    runner, file = CliRunner(), SHIPPED / "three-bodies.yaml"
    assert "the motion is stable (Arnold-Moser)" in runner.invoke(main, ["nonlinear", str(file)]).output
    done = runner.invoke(main, ["nonlinear", str(file), "--set", "mu=1/20"])
    assert (done.exit_code, "the motion is unstable" in done.output) == (0, True)
    done = runner.invoke(main, ["nonlinear", str(file), "--set", "mu=1/20", "--json"])
    content = json.loads(done.output)
    assert [x.message for x in Draft202012Validator(schema("results")).iter_errors(content)] == []
    assert (done.exit_code, content["normal_forms"]["at_values"]["verdict"]) == (0, "unstable")
    for wrong, code in (("mu=-1", "sign-contradiction"), ("nu=1", "unknown-name")):
        done = runner.invoke(main, ["nonlinear", str(file), "--set", wrong])
        assert (done.exit_code, code in done.output) == (2, True)


def test_without_numbers_formulas_are_told_or_the_command_that_gives_them(tmp_path: Path) -> None:
    runner = CliRunner()
    text = (SHIPPED / "three-bodies.yaml").read_text(encoding="utf-8")
    file = filed(tmp_path / "three.yaml", "".join(x for x in text.splitlines(True) if not x.startswith("values:")))
    done = runner.invoke(main, ["nonlinear", str(file)])
    assert done.exit_code == 0
    assert "D4 = " in done.output
    assert "At numbers nothing is said: there are none for mu, a, n, m.  Give them:" in done.output
    command = next(x for x in done.output.splitlines() if "--set mu=NUMBER" in x)
    words = command.replace("NUMBER", "1", 1).replace("mu=1 ", "mu=1/100 ").replace("NUMBER", "1").split()[1:]
    assert "the motion is stable (Arnold-Moser)" in runner.invoke(main, words).output
    text = (SHIPPED / "gravity-gradient.yaml").read_text(encoding="utf-8")
    file.write_text("".join(x for x in text.splitlines(True) if not x.startswith("values:")), encoding="utf-8")
    done = runner.invoke(main, ["nonlinear", str(file)])
    assert (done.exit_code, "missing-value" in done.output, "--set R=1" in done.output) == (2, True, True)
