"""What is compared with 0 is told without positive numbers as factors, also where letters bring them in."""

import pytest

import mbsym
from mbsym.report.content import Relation
from mbsym.report.letters import in_letters

TEXT = """
mbsym: 1
name: Two moments and a mass
parameters: {A: positive, B: positive, m: positive, l: positive}
abbreviations: {a: B + m*l**2/3}
bodies: [{name: p, mass: 1, connection point: [x, 0, 0], coordinates: [x]}]
loads: [{potential: "(3*A - 3*B - m*l**2)*x**2"}]
motion: {x: 0}
"""


@pytest.fixture(scope="module")
def stiffness():
    system = mbsym.loads(TEXT)
    return system.system, system.linearisation.K[0, 0]


@pytest.mark.parametrize("sign", [">", "<", ">=", "<=", "!="])
def test_a_condition_has_no_numeric_factor(stiffness, sign):
    _, k = stiffness
    left, relation, zero = Relation(k, sign, 0).told
    assert (str(left), relation, zero) == ("3*A - 3*B - m*l**2", sign, 0)


def test_letters_bring_none_in(stiffness):
    """3 A - 3 B - m l^2 is 3 (A - a)."""
    system, k = stiffness
    with in_letters(system, ("a",)):
        assert Relation(k, ">", 0).told[0].text() == "A - a"
        assert Relation(k / 7, ">", 0).told[0].text() == "A - a"
        assert Relation(-k, ">", 0).told[0].text() == "a - A"  # a sign is no factor to be left out


@pytest.mark.parametrize("parts", [("=", 0), (">", 1)])
def test_what_is_no_condition_stays(stiffness, parts):
    _, k = stiffness
    assert Relation(k, *parts).told == (k, *parts)
