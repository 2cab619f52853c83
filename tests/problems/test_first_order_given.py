"""x' = A x, given by its matrix: verdicts by roots alone, against determinants and eigenvalues by hand."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

import mbsym
from mbsym.maps.mapping import exact_map
from mbsym.maps.section import Axis
from mbsym.problems.stability.words import Word
from mbsym.report.maps.located import Locating
from mbsym.source import read, to_yaml

TEXT = """
mbsym: 1
name: First order
parameters: {{a: {{sign: real}}, b: {{sign: real}}}}
linear system:
  coordinates: [{coordinates}]
  A: {A}
values: {{a: {a}, b: {b}}}
"""


def _analysis(A="[[a, 1], [-1, b]]", a="-1", b="-1/2", coordinates="x, y"):
    return mbsym.loads(TEXT.format(A=A, a=a, b=b, coordinates=coordinates))


@pytest.mark.parametrize(
    ("a", "b", "word"),
    [
        ("-1", "-1/2", Word.ASYMPTOTIC),
        ("1/2", "-1", Word.ASYMPTOTIC),
        ("1", "1/2", Word.UNSTABLE),
        ("2", "-3", Word.UNSTABLE),  # trace < 0, det < 0
        ("1/2", "-1/2", Word.STABLE),  # a simple pair +-i sqrt(3)/2: x' = A x is all there is
        ("1", "-1", Word.UNSTABLE),  # a double zero root with a Jordan block: grows like t
        ("2", "-1/2", Word.UNSTABLE),  # a zero root beside 3/2
        ("-2", "1/2", Word.STABLE),  # a simple zero root beside -3/2
        ("sqrt(2)", "-sqrt(3)", Word.UNSTABLE),  # det = 1 - sqrt(6) < 0
    ],
)
def test_verdicts_by_trace_and_determinant(a, b, word):
    found = _analysis(a=a, b=b).stability
    assert found.numerical.word is word, found.numerical


def test_the_characteristic_polynomial_is_that_of_A():
    (part,) = _analysis().stability.subsystems
    numbers = {"a": Fraction(3, 7), "b": Fraction(-5, 3)}
    told = [float(Fraction(str(x.subs(numbers)))) for x in part.characteristic]
    A = np.array([[3 / 7, 1], [-1, -5 / 3]])
    assert np.allclose(np.array(told[::-1]) / told[-1], np.poly(A))


def test_the_map_agrees_with_eigenvalues_at_random_points():
    axes = [Axis(name, Fraction(-2), Fraction(2)) for name in "ab"]
    found = exact_map(_analysis(), axes, {})
    chance = np.random.default_rng(7)
    for a, b in chance.integers(-199, 200, size=(60, 2)):
        values = np.linalg.eigvals(np.array([[a / 100, 1], [-1, b / 100]])).real
        if min(abs(values)) < 1e-9:
            continue
        _, verdict = Locating(found)(Fraction(int(a), 100), Fraction(int(b), 100))
        assert verdict.startswith("asymptotically stable") == bool(max(values) < 0)


def test_nothing_is_said_of_energy():
    """A symmetric A is no stiffness: degrees of instability and Kelvin-Chetaev's theorems are about M, D, G, K."""
    found = _analysis(A="[[a, 1], [1, b]]").stabilisation
    assert found.gyroscopic == ()
    assert found.energy == ()
    assert found.dissipation == ()


def test_A_goes_with_no_other_matrix_and_is_written_again():
    text = TEXT.format(A="[[a, 1], [-1, b]]", a=1, b=2, coordinates="x, y")
    wrong, complaints = read(text.replace("  A:", "  M: [[1, 0], [0, 1]]\n  A:"))
    assert wrong is None
    assert any("'M' does not go with 'A'" in one.message for one in complaints)
    system, _ = read(text)
    again, _ = read(to_yaml(system))
    assert again.linear == system.linear
