"""Verdicts over two names where an irrational number stands among the coefficients."""

from __future__ import annotations

from fractions import Fraction as F

import numpy as np
import pytest

import mbsym
from mbsym.maps.section import Axis, Unfit, section
from mbsym.numerics.ensembles.variation import Grid, Points
from mbsym.sweeps.judged import EXACT, RIGHT, VERDICT, WORDS, SingleVerdicts, StabilityMeasure
from mbsym.sweeps.sweep import Asked, measure_of

TEXT = """
mbsym: 1
name: First order
parameters: {a: {}, b: {}}
linear system: {coordinates: [x, y], A: [[a, sqrt(2)], [-1, b]]}
"""


def test_trace_and_determinant_decide() -> None:
    """x' = a x + sqrt(2) y, y' = -x + b y: asymptotically stable iff a + b < 0 and a b + sqrt(2) > 0."""
    analysis = mbsym.loads(TEXT)
    measure = StabilityMeasure(analysis, section(analysis, [Axis(name, F(-3), F(3)) for name in "ab"], {}))
    points = np.random.default_rng(2).uniform(-3, 3, (2, 4_000))
    found = measure.at(points)
    words = [WORDS[code] for code in found[VERDICT.name]]
    assert {*words} == {"asymptotically stable", "unstable"}
    assert found[EXACT.name].sum() < 10
    for (a, b), word, right in zip(points.T, words, found[RIGHT.name], strict=True):
        trace, determinant = a + b, a * b + np.sqrt(2)
        wanted = 1 if determinant < 0 else 0 if trace < 0 else 2
        assert right == wanted
        assert (word == "unstable") == (wanted > 0)


def test_beside_the_border_points_are_judged_singly_and_right() -> None:
    """On b = -1 the determinant is sqrt(2) - a: floats on both sides of sqrt(2), told apart by squares of rationals.

    The trace a - 1 is positive there, so that det > 0 has two roots to the right, det < 0 one; a = 1 is a border.
    """
    analysis = mbsym.loads(TEXT)
    measure = StabilityMeasure(analysis, section(analysis, [Axis(name, F(-3), F(3)) for name in "ab"], {}))
    near = float(np.sqrt(2))
    places = [near, float(np.nextafter(near, 2)), float(np.nextafter(near, 1)), 1.0]
    found = measure.at(np.array([places, [-1.0] * 4]))
    wanted = [2 if F(a) ** 2 < 2 else 1 for a in places[:3]]
    assert set(wanted) == {1, 2}
    assert found[RIGHT.name][:3].tolist() == wanted
    assert found[EXACT.name].all()
    assert WORDS[found[VERDICT.name][3]] == "stable"  # +-i sqrt(sqrt(2) - 1), and x' = A x is all there is


def test_points_at_an_angle_are_judged_one_by_one() -> None:
    """x'' + (cos(a) + c - 3/2) x = 0: stable where the bracket is positive, whatever a is in the description."""
    text = "mbsym: 1\nname: s\nparameters: {a: {value: pi/3}, c: 1}\nlinear system: {coordinates: [x], M: [[1]], "
    system = mbsym.loads(text + "K: [[cos(a) + c - 3/2]]}\n").system
    points = Points((Grid("a", 0.0, 3.0, 13), Grid("c", 0.5, 2.0, 7)))
    ends = {"a": (F(0), F(3)), "c": (F(1, 2), F(2))}
    measure = measure_of(system, Asked(points, ends, {}, "stability"))
    assert isinstance(measure, SingleVerdicts)
    there = points.part(0, points.count)
    words = [WORDS[code] for code in measure.at(there)[VERDICT.name]]
    for (a, c), word in zip(there.T, words, strict=True):
        stiffness = np.cos(a) + c - 1.5
        assert word == ("stable" if stiffness >= 0 else "unstable") or stiffness == 0
    with pytest.raises(Unfit):
        measure_of(system, Asked(points, ends, {}, "eigenvalues"))
