"""Angles that stand outside sine and cosine, too: every rest is found, none is lost at a multiple root."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from conftest import TESTS

import mbsym
from mbsym.mechanics.rest import given_values
from mbsym.problems.relative_equilibria.equilibria import EXACT, Equilibria, equilibria

TORSION = (TESTS / "cases" / "statements" / "torsion.yaml").read_text(encoding="utf-8")


def at(text: str, within: float = 10.0, **values: str) -> Equilibria:
    system = mbsym.loads(text).system
    return equilibria(system, given_values(system, {name: Fraction(x) for name, x in values.items()}), within)


def roots(k: float, rest: float) -> list[float]:
    """k (x - rest) = sin x by changes of sign; all of them lie within 1/k of the rest."""
    x = np.linspace(rest - 1 / k - 0.01, rest + 1 / k + 0.01, 400_001) + 1e-7 * math.sqrt(2)
    f = k * (x - rest) - np.sin(x)
    return [float(v) for v in x[:-1][np.sign(f[:-1]) != np.sign(f[1:])]]


@pytest.mark.parametrize(
    ("k", "rest"),
    [("1/10", "0"), ("1/100", "0"), ("1", "0"), ("3/2", "0"), ("10", "12"), ("1/7", "pi/2"), ("2", "-40")],
)
def test_every_rest_on_a_torsional_spring_is_listed(k: str, rest: str) -> None:
    found = at(TORSION.replace("stiffness: k", f"stiffness: k, rest: {rest}"), k=k)
    there = math.pi / 2 if rest == "pi/2" else float(rest)
    expected = roots(float(Fraction(k)), there)
    seen = sorted(one.values[0].value for one in found.equilibria)
    assert seen == pytest.approx(expected, abs=1e-3)
    assert found.complete
    for one in found.equilibria:
        slope = float(Fraction(k)) - math.cos(one.values[0].value)  # of the moment that brings it back
        word = one.verdict.word
        assert word == ("stable" if slope > 1e-9 else "unstable") or abs(slope) < 1e-9


def test_the_own_rest_of_a_spring_is_listed_where_it_is_a_multiple_root() -> None:
    """x = sin x: 0 is a root of order 3, which no box proves; the third derivative proves that it is the only one."""
    found = at(TORSION, k="1")
    (one,) = found.equilibria
    assert (one.values[0].value, one.proof) == (0, EXACT)
    assert found.complete
    # The same about an upright that is a quarter turn away.
    leaning = TORSION.replace("[0, -1, 0]", "[1, 0, 0]").replace("stiffness: k", "stiffness: k, rest: -pi/2")
    found = at(leaning, k="1")
    (one,) = found.equilibria
    assert one.values[0].value == pytest.approx(-math.pi / 2)
    assert found.complete


def test_where_nothing_holds_a_coordinate_the_list_is_not_called_complete() -> None:
    """tan x = x has infinitely many roots; with --within 10 those up to 7.73 are listed."""
    text = """
mbsym: 1
name: bead
parameters: {m: 1}
bodies:
  - {name: bead, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
loads:
  - generalized force: {x: sin(x) - x*cos(x)}
"""
    found = at(text)
    seen = sorted(one.values[0].value for one in found.equilibria)
    assert seen == pytest.approx([-7.725252, -4.493409, 0, 4.493409, 7.725252], abs=1e-6)
    assert not found.complete


TWO = """
mbsym: 1
name: two rods on torsional springs
parameters: {k: positive, c: positive}
bodies:
  - {name: lower, attached to: 0, rotation: {axes: [3], angles: [a]}, mass centre: [0, 1, 0], mass: 1}
  - name: upper
    attached to: lower
    connection point: [0, 1, 0]
    rotation: {axes: [3], angles: [b]}
    mass centre: [0, 1, 0]
    mass: 1
loads:
  - uniform gravity: {vector: [0, -1, 0]}
  - spring: {coordinate: a, stiffness: k}
  - spring: {coordinate: b, stiffness: c}
"""


@pytest.mark.parametrize(("k", "c"), [("1/2", "1/3"), ("2", "1/4")])
def test_two_rods_on_springs_by_newton_from_a_grid(k: str, c: str) -> None:
    """k a = 2 sin a + sin(a + b), c b = sin(a + b): |a| <= 3/k, |b| <= 1/c."""
    found = at(TWO, k=k, c=c)
    assert found.complete
    stiff, soft = float(Fraction(k)), float(Fraction(c))
    a, b = (g.ravel() for g in np.meshgrid(*(np.linspace(-x, x, 121) for x in (3 / stiff, 1 / soft))))
    for _ in range(80):
        f = np.array([stiff * a - 2 * np.sin(a) - np.sin(a + b), soft * b - np.sin(a + b)])
        s = np.cos(a + b)
        jacobian = np.array([[stiff - 2 * np.cos(a) - s, -s], [-s, soft - s]])
        change = np.linalg.solve(np.moveaxis(jacobian, 2, 0) + 1e-13 * np.eye(2), f.T[..., None])[..., 0].T
        step = change * np.minimum(1, 0.5 / np.maximum(np.abs(change).max(axis=0), 1e-300))
        a, b = a - step[0], b - step[1]
    done = np.abs(f).max(axis=0) < 1e-11
    expected = {(round(x, 5) + 0.0, round(y, 5) + 0.0) for x, y in zip(a[done], b[done], strict=True)}
    assert {tuple(round(item.value, 5) + 0.0 for item in one.values) for one in found.equilibria} == expected
