"""Claimed numbers: the digits that were printed, those of doubles, and a tolerance that is asked for.

What is claimed comes from the case's own reference, or from Python's doubles and the plain formulas in the test.
"""

from __future__ import annotations

import json
import math
import random
from pathlib import Path

import pytest
from conftest import filed, invoked
from test_claims import PENDULUM, analysed, judged

import mbsym
from mbsym.problems.claims import Outcome
from mbsym.report.words.claims import claim_line
from mbsym.source.schema import json_schema
from mbsym.source.text_writer import to_text
from mbsym.source.yaml_writer import to_yaml

DOUBLE_CASE = Path(__file__).parents[1] / "cases" / "statements" / "claims-from-doubles.yaml"
VALUE = "claim: value, of: m*l/3, state: {m: 1, l: 1}, "  # 1/3


def numbers(text: str) -> list[str]:
    return [line.rpartition("equals: ")[2].rstrip("}") for line in text.splitlines() if "equals: " in line]


def test_numbers_of_a_double_precision_program_hold() -> None:
    """Positions and velocities of three points, printed with the 16 digits of doubles."""
    found = mbsym.load(DOUBLE_CASE).claims
    assert len(found) == 9
    assert {result.outcome for result in found} == {Outcome.DIGITS, Outcome.DOUBLES}
    for result in found:
        digits = len(result.value.lstrip("-").replace("0.", "", 1).replace(".", ""))
        assert digits >= 17  # as many as were printed, and more
        assert result.digits in (15, 16)


@pytest.mark.parametrize("place", [11, 12, 13])
def test_a_wrong_digit_of_a_double_is_found(place: int) -> None:
    """Two units in an earlier digit of every number are more than rounding."""
    text = DOUBLE_CASE.read_text(encoding="utf-8")
    for number in numbers(text):
        at = [k for k, c in enumerate(number) if c.isdigit() and number[: k + 1].strip("-0.")][place - 1]
        digit = (int(number[at]) + 2) % 10
        text = text.replace(f"equals: {number}", f"equals: {number[:at]}{digit}{number[at + 1 :]}")
    assert {result.outcome for result in mbsym.loads(text).claims} == {Outcome.DIFFERS}


def test_what_doubles_make_of_a_formula_holds() -> None:
    """theta'' = -m g l sin(theta)/(J + m l^2) in Python's doubles, at states that are no doubles."""
    source = random.Random(5)
    states = [f"{source.randint(-300, 300)}/100" for _ in range(30)]
    computed = [-1 * 9.81 * 2 * math.sin(eval(state)) / (0.5 + 1 * 2**2) for state in states]
    claim = "claim: value, of: theta_ddot, state: {{theta: {}}}, equals: {!r}"
    pairs = list(zip(states, computed, strict=True))
    found = analysed(*(claim.format(state, value) for state, value in pairs)).claims
    assert {result.outcome for result in found} <= {Outcome.DIGITS, Outcome.DOUBLES}
    wrong = analysed(*(claim.format(state, value * (1 + 1e-13)) for state, value in pairs)).claims
    assert {result.outcome for result in wrong} == {Outcome.DIFFERS}


def test_zero_in_doubles_is_not_quite_zero() -> None:
    assert math.cos(math.pi / 2) == 6.123233995736766e-17
    claim = "claim: velocity, of: bob, component: 1, state: {theta: pi/2, theta_dot: 1, l: 1}, equals: "
    assert judged(claim + "6.123233995736766e-17").outcome == Outcome.DOUBLES
    assert judged(claim + "6.123233995736766e-14").outcome == Outcome.DIFFERS
    assert judged(claim + "6.12e-17").outcome == Outcome.DIFFERS  # three digits are no double's


@pytest.mark.parametrize(
    ("printed", "outcome"),
    [
        ("0.3333333333333333", Outcome.DIGITS),
        ("0.3333333333333332", Outcome.DOUBLES),
        ("0.33333333333334", Outcome.DIFFERS),  # 14 digits
        ("0.333333333333333332", Outcome.DIFFERS),  # 18 digits: from better than doubles
        ("0.33333333333333333333", Outcome.DIGITS),
    ],
)
def test_only_the_digits_of_doubles_are_granted_rounding(printed: str, outcome: str) -> None:
    assert judged(f"{VALUE}equals: {printed}").outcome == outcome


def test_the_derived_value_has_more_digits_than_the_claim() -> None:
    wrong = claim_line(judged(f"{VALUE}equals: 0.33333333333333333334"))
    assert wrong.outcome == (
        "differs: claimed 0.33333333333333333334, derived 0.3333333333333333333333, 19 of 20 digits right"
    )
    short = claim_line(judged(f"{VALUE}equals: 0.34"))
    assert short.outcome == "differs: claimed 0.34, derived 0.333333333333, 1 of 2 digits right"


@pytest.mark.parametrize("number", ["0", "-0", "0e1", "0.0", "0.00e1"])
def test_a_bare_zero_means_zero(number: str) -> None:
    """1/3 is neither 0 nor 0.0 (+- 0.05); what vanishes is all of them."""
    assert judged(f"{VALUE}equals: {number}").outcome == Outcome.DIFFERS
    assert (
        judged(f"claim: velocity, of: bob, component: 1, state: {{theta: 0.1}}, equals: {number}").outcome
        == Outcome.DIGITS
    )
    assert judged(f"claim: value, of: m*l/100, state: {{m: 1, l: 1}}, equals: {number}").outcome == (
        Outcome.DIGITS if "." in number else Outcome.DIFFERS  # 0.01 is 0.0, but it is not 0
    )


@pytest.mark.parametrize(
    ("claim", "outcome"),
    [
        ("equals: 0.333, tolerance: 0.0004", Outcome.TOLERANCE),
        ("equals: 0.333, tolerance: 0.0003", Outcome.DIFFERS),
        ("equals: 1/3, tolerance: 1e-30", Outcome.TOLERANCE),
        ("equals: 0.3333339999, digits: 6", Outcome.DIFFERS),
        ("equals: 0.3333329999, digits: 6", Outcome.TOLERANCE),
        ("equals: 0.333333999, digits: 5", Outcome.TOLERANCE),
        ("equals: 0.3333333333333333, digits: 20", Outcome.DIFFERS),
        ("equals: 0, digits: 3", Outcome.UNDECIDED),
        ("equals: 0, tolerance: 1", Outcome.TOLERANCE),
    ],
)
def test_a_claim_may_say_how_exact_it_is_meant(claim: str, outcome: str) -> None:
    assert judged(VALUE + claim).outcome == outcome


def test_tolerances_are_written_and_read(tmp_path: Path) -> None:
    analysis = analysed(f"{VALUE}equals: 0.333, tolerance: 4e-4", f"{VALUE}equals: 0.333334, digits: 5")
    for written in (to_yaml(analysis.system), to_text(analysis.system)):
        claims = mbsym.loads(written).system.claims
        assert [claim.digits for claim in claims] == [0, 5]
        assert claims == analysis.system.claims
    assert {"tolerance", "digits"} <= json_schema()["$defs"]["claim"]["properties"].keys()
    explained = invoked("explain", "claims").stdout
    assert "tolerance  of a number at a state" in explained
    path = filed(tmp_path / "p.yaml", PENDULUM + f"claims:\n  - {{{VALUE}equals: 0.333, tolerance: 4e-4}}\n")
    words = ["run", str(path), "--out", str(tmp_path / "out"), "--problems", "1", "--format", "json", "-v"]
    done = invoked(*words)
    assert "holds within the tolerance (0.333333333333): 0.0004" in done.stdout
    (told,) = json.loads((tmp_path / "out" / "results.json").read_text(encoding="utf-8"))["claims"]
    assert (told["word"], told["outcome"]) == ("held", "holds within the tolerance")


@pytest.mark.parametrize(
    ("claim", "complaint"),
    [
        (f"{VALUE}equals: 1, tolerance: 0", "a tolerance is a positive number"),
        (f"{VALUE}equals: 1, tolerance: m", "'m'"),
        (f"{VALUE}equals: 1, digits: 2.5", "no number of digits"),
        (f"{VALUE}equals: 1, digits: 3, tolerance: 1", "'digits' does not go with 'tolerance'"),
        ("claim: kinetic energy, equals: 1, digits: 3", "'digits' is about numbers at a state"),
        ("claim: first integral, equals: theta_dot, tolerance: 3", "'tolerance' does not go with"),
    ],
)
def test_bad_tolerances_are_refused(claim: str, complaint: str) -> None:
    with pytest.raises(mbsym.DescriptionError, match=complaint.replace("'", ".")):
        analysed(claim)
