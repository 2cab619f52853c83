"""Values at which a description divides by zero: no verdict is given there, by problem 6 or 11."""

from __future__ import annotations

import pytest

import mbsym

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
    assert (found.stability.numerical is not None) is judged
    assert (found.normal_forms.at_values is not None) is judged


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
