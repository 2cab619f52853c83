"""Maps against references: borders and verdicts that publications or derivations by hand give."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import pytest
from flint import fmpq

import mbsym
from mbsym.algebra.arrangements import Arrangement, decompose
from mbsym.algebra.plane import Box, Point
from mbsym.maps.boundaries import boundaries
from mbsym.maps.check import ExactVerdicts
from mbsym.maps.section import Axis, Section, section
from mbsym.maps.verdicts import Border, Judged
from mbsym.problems.stability.words import Because, Word


@dataclass
class Drawn:
    section: Section
    found: Arrangement
    judge: ExactVerdicts

    def at(self, x: Any, y: Any) -> Judged:
        """The verdict at a rational point, wherever it lies."""
        return self.judge(Point(fmpq(*Fraction(x).as_integer_ratio()), fmpq(*Fraction(y).as_integer_ratio())))

    def zeros(self) -> list[Any]:
        return list(self.section.context.gens())


def drawn(name: str, axes: dict[str, tuple[str, str]], **settings: Any) -> Drawn:
    listed = [Axis(axis, *map(Fraction, ends)) for axis, ends in axes.items()]
    there = section(mbsym.load(f"systems/{name}.yaml"), listed, {k: Fraction(v) for k, v in settings.items()})
    box = Box(*(fmpq(x.numerator, x.denominator) for axis in listed for x in (axis.low, axis.high)))
    return Drawn(there, decompose(boundaries(there).factors, box), ExactVerdicts(there))


def monic(p: Any) -> str:
    return str(p / p.leading_coefficient())


@pytest.fixture(scope="module")
def damper() -> Drawn:
    """references/satellite-with-damper, 1.3 to 1.5: e = 1/20, dc = 2/5, omega = 1; sets S, U, V, D have p2 = 20."""
    axes = {"Lambda": ("-2", "2"), "p2": ("0", "25")}
    return drawn("satellite-with-damper", axes, e="1/20", dc="2/5", omega=1, s="3/5", rho=0, A=1, b0=1, Ja=1)


def test_the_exact_hurwitz_border_of_the_spin_with_a_damper(damper: Drawn) -> None:
    """D3 = e dc^2 lambda (lambda + omega) (lambda - omega)^2 and a4 = lambda (lambda p2 - e omega^3)."""
    rate, stiffness = damper.zeros()
    found = {monic(p) for p in damper.found.factors}
    assert {monic(p) for p in (rate, rate + 1, rate - 1, rate * stiffness - fmpq(1, 20))} <= found
    for region in damper.found.regions:
        x, y = region.sample
        inside = x * (x + 1) > 0 and x != 1 and x * (x * y - fmpq(1, 20)) > 0
        word = damper.at(Fraction(int(x.p), int(x.q)), Fraction(int(y.p), int(y.q))).verdict.word
        assert word is (Word.ASYMPTOTIC_BUT_TURNED if inside else Word.UNSTABLE)


def test_the_sets_of_the_reference(damper: Drawn) -> None:
    """S decays, U: one pair to the right, V: one real root; D: +-i exactly, beside the turned spin's own pair."""
    stable, unstable = damper.at("3/5", 20), damper.at("-2/5", 20)
    divergent, degenerate = damper.at("1/1000", 20), damper.at(1, 20)
    assert stable.verdict.word is Word.ASYMPTOTIC_BUT_TURNED
    assert (unstable.right, unstable.real_right) == (2, 0)
    assert (divergent.right, divergent.real_right) == (1, 1)
    assert (degenerate.right, degenerate.border) == (0, Border.SEMISIMPLE)
    assert not degenerate.verdict.word.asymptotic


def test_without_angular_momentum_tilts_grow(damper: Drawn) -> None:
    """lambda + omega = H/A = 0: the pair +-i omega of P is that of the turned spin, with Jordan blocks.

    P = (S^2 + 1) (S^2 + dc S + p2 - e (S^2 - 1)) there; nothing holds the axis of a body that has no angular momentum.
    """
    for stiffness in (1, 20):
        judged = damper.at(-1, stiffness)
        assert judged.border is Border.JORDAN
        assert judged.verdict.word is Word.UNDECIDED
        assert judged.verdict.because(Because.JORDAN_BLOCK)


def test_the_sleeping_top() -> None:
    """mgk_exact: C^2 Omega^2 > 4 A m g l; with A = m = g = 1, C = 1/2 the parabola Omega^2 = 16 l."""
    top = drawn("heavy-top", {"Omega": ("1", "5"), "l": ("1/16", "2")}, A=1, C="1/2", m=1, g=1)
    rate, length = top.zeros()
    assert monic(rate**2 - 16 * length) in {monic(p) for p in top.found.factors}
    for region in top.found.regions:
        x, y = region.sample
        judged = top.judge(Point(x, y))
        assert (judged.right == 0) == (x**2 > 16 * y)
    curve = next(arc for arc in top.found.arcs if arc.point.sign(rate**2 - 16 * length) == 0)
    assert top.judge(curve.point).border is Border.JORDAN
    assert top.judge(curve.point).verdict.word is Word.UNDECIDED


def test_lagrange_and_debra_delp_regions() -> None:
    """gravity_gradient: pitch needs B < A (Lagrange: B < A < C stable, by energy; the other one gyroscopically)."""
    found = drawn("gravity-gradient", {"A": ("1/10", "3"), "B": ("1/10", "3")}, R=1, omega0=1, m=1, C=1)
    words: dict[Word, list[Any]] = {}
    for region in found.found.regions:
        words.setdefault(found.judge(Point(*region.sample)).verdict.word, []).append(region)
    for region in words[Word.STABLE]:
        roll, yaw = region.sample
        assert yaw < roll < 1
    assert len(words[Word.GYROSCOPIC]) == 1
    roll, yaw = words[Word.GYROSCOPIC][0].sample
    # Necessary for both: 1 + 3 k1 + k1 k3 > 4 sqrt(k1 k3), k1 k3 > 0, here with both ratios negative.
    first, third = (1 - yaw) / roll, (1 - roll) / yaw
    assert first < 0
    assert third < 0
    assert 1 + 3 * first + first * third > 0
    assert (1 + 3 * first + first * third) ** 2 > 16 * first * third
    samples = {
        (Fraction(4, 5), Fraction(3, 5)): Word.STABLE,
        (Fraction(5, 4), Fraction(3, 4)): Word.UNSTABLE,
        (Fraction(20, 13), Fraction(18, 13)): Word.UNSTABLE,
        (Fraction(25, 3), Fraction(95, 12)): Word.UNSTABLE,
        (Fraction(25, 24), Fraction(33, 32)): Word.GYROSCOPIC,
    }
    for (roll, yaw), word in samples.items():
        assert found.at(roll, yaw).verdict.word is word
