"""Zero roots are told like imaginary pairs: simple ones leave the first approximation stable, and the motion open.

x'' + x' + k x^3 = 0 and x'' + x' = x y have the roots 0 and -1 of x; what stands beside them decides the word.
"""

from __future__ import annotations

import pytest

import mbsym
from mbsym.problems.stability.words import Because, Word

TEXT = """
mbsym: 1
name: A zero root
parameters: {k: real}
bodies:
  - {name: p, attached to: 0, mass: 1, connection point: [x, y, 0], coordinates: [x, y]}
loads:
  - generalized force: {x: "FX", y: "FY"}
motion: {}
values: {k: 1}
"""


@pytest.mark.parametrize(
    ("fx", "fy", "word"),
    [
        ("-x_dot - k*x**3 + x*y", "-y - y_dot", Word.CRITICAL),  # 0, -1 beside a pair to the left
        ("-x_dot - k*x**3 + x*y", "-4*y + x**2", Word.CRITICAL),  # ... beside +-2 i
        ("-x_dot - k*x**3 + x*y", "y - y_dot", Word.UNSTABLE),  # ... beside a root to the right
        ("-x_dot - k*x**3 + x*y", "-y + 2*y_dot", Word.UNSTABLE),
        ("-k*x**3 + x*y*y_dot", "-y - y_dot", Word.UNDECIDED),  # 0 twice with a block: x = c t
        ("-x_dot - x + y + x*y**2", "-y_dot + x - y", Word.CRITICAL),  # one part: lambda (lambda + 1) (...), K singular
    ],
)
def test_zero_roots_beside_others(fx: str, fy: str, word: Word) -> None:
    found = mbsym.loads(TEXT.replace("FX", fx).replace("FY", fy)).stability
    first = found.before_higher_order or found.numerical
    assert first is not None
    assert first.word is word, first.explanation
    assert found.verdict.word is word, found.verdict.explanation
    if word is Word.CRITICAL:
        assert first.because(Because.ZERO_ROOT)
        assert first.explanation.count("igher order") == 1
