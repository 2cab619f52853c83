"""``mbsym nonlinear --vary`` says at an exceptional value what ``mbsym run`` says there.

Derived by hand.  Van der Pol's oscillator at mu = 0 is x'' + x = 0, whose energy is definite: stable.  Jeffcott's
rotor z'' + (ce + ci) z' + (1 - i ci W) z = 0 with ce = ci = 1 has at W = 2 the roots i and -2 - i, each
simple, and its equations are linear: stable.
"""

from __future__ import annotations

import json
from fractions import Fraction

import pytest
from conftest import STATEMENTS

import mbsym
from mbsym.analysis.judge import exceptional
from mbsym.report.words.exceptional_values import as_text, lines


@pytest.mark.parametrize(
    ("name", "parameter", "interval", "others", "value", "theorem"),
    [
        ("van_der_pol_at_rest", "mu", (-1, 1), {}, "0", "Lagrange-Dirichlet"),
        ("jeffcott", "W", (0, 4), {"ce": 1, "ci": 1}, "2", "theory of linear equations"),
    ],
)
def test_what_an_energy_decides_is_not_left_open(
    name: str, parameter: str, interval: tuple[int, int], others: dict[str, int], value: str, theorem: str
) -> None:
    analysis = mbsym.load(STATEMENTS / f"{name}.yaml")
    numbers = {key: Fraction(number) for key, number in others.items()}
    found = exceptional(analysis, parameter, (Fraction(interval[0]), Fraction(interval[1])), numbers)
    told = list(lines(found))
    assert f"{parameter} = {value}: stable ({theorem})" in told
    assert not any("rate 0 times" in line for line in told)
    (special,) = json.loads(as_text(analysis.system, found))["values"]
    assert (special["verdict"], special["theorem"], special["reason"]) == ("stable", theorem, "")
