"""Values at which a description divides by zero: no verdict is given there, by problem 6 or 11."""

from __future__ import annotations

from fractions import Fraction

import pytest
from terminal import told

import mbsym
from mbsym.analysis.judge import Judge
from mbsym.problems.normal_forms.result import Outcome, Why
from mbsym.problems.stability.words import Because, Word
from mbsym.report.words.normal_form_words import REASONS

#: U = -x^2/2 - x^4/(b - 4): its first approximation knows nothing of the pole.
POLE = """
mbsym: 1
name: A spring with a pole
parameters: {{b: {{sign: real, value: {b}}}}}
bodies:
  - {{name: one, attached to: 0, coordinates: [x], connection point: [x, 0, 0], mass: 1}}
loads:
  - force function: -x**2/2 - x**4/(b - 4)
motion: {{x: 0}}
"""


@pytest.mark.parametrize(("b", "judged"), [(5, True), (4, False), (3, True)])
def test_at_a_pole_of_the_description_there_is_no_verdict(b, judged):
    found = mbsym.loads(POLE.format(b=b))
    numerical, higher = found.stability.numerical, found.normal_forms.at_values
    assert (numerical.word is not Word.UNDECIDED) is judged
    assert (higher.outcome is not Outcome.UNDECIDED) is judged
    if not judged:
        why = "The description divides by b - 4 there, which is 0: there is no motion to be judged."
        assert numerical.explanation == why
        assert not found.stability.spectra
        assert higher.why is Why.POLE
        assert any(f"At the given values of the parameters: undecided. {why}" in line for line in told(found, 6))
        assert REASONS[Why.POLE] in told(found, 11)
        for name in ("ru", "es"):
            lines = [line for line in told(found, 6, name) if "b - 4" in line]
            assert lines
            assert not any("divides by" in line for line in lines)


def test_a_pole_of_what_is_derived_is_none_of_the_description():
    """D4 of two oscillators has the divisor 4 a - b; where it is zero the motion is there, and stable (definite)."""
    text = (
        POLE.format(b=4)
        .replace("x**4/(b - 4)", "b*y**2/2 - x**2*y")
        .replace(
            "loads:", "  - {name: two, attached to: 0, coordinates: [y], connection point: [y, 0, 0], mass: 1}\nloads:"
        )
    )
    found = mbsym.loads(text.replace("motion: {x: 0}", "motion: {x: 0, y: 0}"))
    assert found.normal_forms.at_values is not None
    assert found.stability.numerical.word.stable


ROD = """
mbsym: 1
name: bead on a turning rod
parameters: {m: positive, k: positive, a: positive, w: positive}
prescribed: {f: w}
bodies:
  - {name: rod, rotation: {axes: [3], angles: [f]}, mass: 0}
  - {name: bead, attached to: rod, mass: m, connection point: [r, 0, 0], coordinates: [r]}
loads:
  - spring: {coordinate: r, stiffness: k, rest: a}
motion: {r: k*a/(k - m*w**2)}
values: {m: 1, k: 1, a: 1, w: 1}
"""


def test_where_the_motion_has_a_pole_there_is_none_to_be_judged():
    """m r'' + (k - m w^2) r = k a has no rest at k = m w^2, and its first approximation knows nothing of that."""
    found = mbsym.loads(ROD)
    assert found.stability.numerical.word is Word.UNDECIDED
    assert found.stability.numerical.because(Because.POLE)
    assert not found.stability.spectra
    assert Judge(found)({"m": Fraction(2), "k": Fraction(8), "a": Fraction(1), "w": Fraction(2)}).because(Because.POLE)
    assert mbsym.loads(ROD.replace("w: 1}", "w: 1/2}")).stability.numerical.word is Word.STABLE
