"""Eigenvalues at numbers against frequencies known otherwise and against floats from the matrices in physical time."""

from __future__ import annotations

import json
import math
from fractions import Fraction
from math import sqrt
from pathlib import Path

import numpy as np
import pytest
from conftest import SHIPPED, invoked

import mbsym
from mbsym.problems.stability.enclosed import RootNumbers, numbers
from mbsym.problems.stability.problem import parameter_values
from mbsym.report.formulas_by_name import root_text
from mbsym.report.targets import TARGETS

#: Descriptions whose values, with their relations, give every parameter a number.
WITH_VALUES = ["dumbbell", "satellite", "heavy-top", "satellite-with-damper", "ziegler-damped", "orbital-gyrostat"]


def test_a_dumbbell_swings_at_the_square_root_of_three_and_at_two() -> None:
    """Pitch and roll of a dumbbell in an orbit with omega0 = 1/1000 (Beletsky)."""
    found = mbsym.load(SHIPPED / "dumbbell.yaml").stability.spectra
    assert [x.coordinates for x in found] == [("alpha",), ("beta",)]
    for spectrum, frequency in zip(found, (sqrt(3), 2), strict=True):
        (pair,) = numbers(spectrum)
        assert pair.real == 0
        assert pair.imaginary == pytest.approx(frequency / 1000, rel=1e-15)


def test_the_turned_spin_is_among_the_eigenvalues() -> None:
    """A steady spin at the rate 1 that is turned in space: +-i, exactly on the axis."""
    found = mbsym.load(SHIPPED / "satellite-with-damper.yaml").stability.spectra
    assert any(x.real == 0 and x.imaginary == 1 for part in found for x in numbers(part))


@pytest.mark.parametrize("name", WITH_VALUES)
def test_floats_from_the_physical_matrices_agree(name: str) -> None:
    """Another route: numpy on M, D + G, K + N of problem 5, in physical time and declared parameters."""
    a = mbsym.load(SHIPPED / f"{name}.yaml")
    linear, spectra = a.linearisation, a.stability.spectra
    values = parameter_values(a.parameters_scene, a.equilibrium)
    assert values is not None
    floats = {x: float(v) for x, v in values.items()}
    m, d, g, k, n = (np.array(x.to_sympy().subs(floats).evalf(30), dtype=float) for x in linear.matrices)
    size = len(m)
    zero, one = np.zeros((size, size)), np.eye(size)
    a_matrix = np.block([[zero, one], [-np.linalg.solve(m, k + n), -np.linalg.solve(m, d + g)]])
    expected = np.linalg.eigvals(a_matrix)
    got = [complex(x) for part in spectra for root in part.roots for x in [root.ball.mid()] * root.multiplicity]
    assert len(got) == len(expected) == 2 * size
    scale = max(abs(expected))
    for x in got:
        assert min(abs(expected - x)) < 1e-6 * scale  # multiple roots are known to half the digits in floats
    for x in expected:
        assert min(abs(np.array(got) - x)) < 1e-6 * scale


def test_texts() -> None:
    assert root_text(RootNumbers(-0.5, 2.0, 1)) == "-0.5 +- 2i"
    assert root_text(RootNumbers(0.0, 2.0, 2)) == "+-2i, +-2i"
    assert root_text(RootNumbers(0.0, 0.0, 4)) == "0, 0, 0, 0"


def test_the_command_tells_them(tmp_path: Path) -> None:
    result = invoked("run", "-v", SHIPPED / "dumbbell.yaml", "--out", tmp_path, code=0)
    assert "Eigenvalues there, in the time t, of alpha: +- 0.00173205 i" in result.output
    told = json.loads((tmp_path / "results.json").read_text())["stability"]["eigenvalues_at_values"]
    assert told[1] == {"coordinates": ["beta"], "roots": [{"real": 0.0, "imaginary": 0.002, "multiplicity": 1}]}
    assert r"$\pm 0.002 \,\mathrm{i}$" in (tmp_path / "report.tex").read_text()


IN_ORBIT = """
mbsym: 1
name: rigid satellite
parameters: {A: positive, B: positive, C: positive, R: positive, mu: positive, n: positive, m: positive}
prescribed: {u: {rate: n}}
bodies:
  - {name: orbit, attached to: 0, rotation: {axes: [3], angles: [u]}, mass: 0}
  - {name: body, attached to: orbit, connection point: [R, 0, 0], rotation: {axes: [3, 2, 1], angles: [a, b, c]},
     mass: m, inertia about: mass centre, inertia: [A, B, C]}
loads:
  - newtonian gravity: {constant: mu, centre: 0, about: body, order: 2}
relations: {n: sqrt(mu/R**3)}
motion: {a: 0, b: 0, c: 0}
values: {A: 1, B: 2, C: 2.5, R: 7000000, mu: MU, m: 1}
"""


@pytest.mark.parametrize(("inertia", "word"), [("1", "stable"), ("5/2", "unstable")])
def test_irrational_values_have_a_verdict_and_eigenvalues(inertia: str, word: str) -> None:
    """In a circular orbit of irrational rate n pitch is n sqrt(3 (B - A)/C) (Lagrange: stable for C > B > A)."""
    text = IN_ORBIT.replace("MU", "3.986e14").replace("A: 1,", f"A: {inertia},")
    found = mbsym.loads(text).stability
    assert found.numerical is not None
    assert found.numerical.word == word
    pitch = next(x for x in found.spectra if x.coordinates == ("a",))
    squared = 3.986e14 / 7e6**3 * 3 * (2 - float(Fraction(inertia))) / 2.5
    size = sqrt(abs(squared))
    expected = [complex(0, size)] if squared > 0 else [complex(-size), complex(size)]
    assert [complex(x.real, x.imaginary) for x in numbers(pitch)] == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(("value", "frequency"), [("sqrt(2)", 2**0.25), ("pi/6", sqrt(math.pi / 6))])
def test_a_stiffness_may_be_irrational(value: str, frequency: float) -> None:
    text = f"""
mbsym: 1
name: oscillator
parameters: {{m: 1, k: {value}}}
bodies:
  - {{name: p, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}}
loads:
  - spring: {{coordinate: x, stiffness: k}}
motion: {{x: 0}}
"""
    found = mbsym.loads(text).stability
    assert found.numerical is not None
    assert found.numerical.word == "stable"
    ((pair,),) = (numbers(x) for x in found.spectra)
    assert pair.imaginary == pytest.approx(frequency, rel=1e-15)


OSCILLATOR = """
mbsym: 1
name: Oscillator
parameters: {{m: 1, k: {k}, d: {d}}}
bodies:
  - {{name: block, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}}
loads:
  - spring: {{coordinate: x, stiffness: k}}
  - damper: {{coordinate: x, coefficient: d}}
motion: {{x: 0}}
"""


@pytest.mark.parametrize(
    ("k", "d", "roots", "written"),
    [
        (-4, 0, [(-2, 0, 1), (2, 0, 1)], "$-2$, $2$"),
        (5, 2, [(-1, 2, 1)], r"$-1 \pm 2 \,\mathrm{i}$"),
        (1, 2, [(-1, 0, 2)], r"$-1$ $(2\times)$"),
        ("2.5e-7**2", 0, [(0, 2.5e-7, 1)], r"$\pm 2.5 \cdot 10^{-7} \,\mathrm{i}$"),
    ],
)
def test_real_roots_and_dampings_are_told(
    k: int | str, d: int, roots: list[tuple[float, float, int]], written: str
) -> None:
    """lambda^2 + d lambda + k = 0, by hand."""
    analysis = mbsym.loads(OSCILLATOR.format(k=k, d=d))
    (found,) = analysis.stability.spectra
    told = [(x.real, x.imaginary, x.multiplicity) for x in numbers(found)]
    assert told == [pytest.approx(root, rel=1e-15) for root in roots]
    assert f"of $x$: {written}." in " ".join(TARGETS["latex"].render(analysis, (6,)).split())


SHAFT = """
mbsym: 1
name: Shaft
parameters: {{m: 1, b: {b}}}
bodies:
  - {{name: p, attached to: 0, connection point: [x, y, 0], coordinates: [x, y], mass: m}}
loads:
  - generalized force: {{x: -x_dot + b*y_dot - {c}*x + 2*y, y: -y_dot - b*x_dot - {c}*y - 2*x}}
motion: {{x: 0, y: 0}}
"""


@pytest.mark.parametrize("b", [3, -3])
def test_eigenvalues_where_a_matrix_is_irrational(b: int) -> None:
    """z = x + i y: lambda^2 + (1 + i b) lambda + sqrt(2) + 2 i = 0, and the conjugates."""
    (found,) = mbsym.loads(SHAFT.format(b=b, c="sqrt(2)")).stability.spectra
    expected = sorted((z.real, abs(z.imag)) for z in np.roots([1, 1 + 1j * b, 2**0.5 + 2j]))
    assert sorted((x.real, x.imaginary) for x in numbers(found)) == [pytest.approx(z, rel=1e-12) for z in expected]
