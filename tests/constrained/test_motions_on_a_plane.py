"""Linkages whose positions are a plane of their coordinates: parallelograms move as one coordinate does."""

from __future__ import annotations

import pytest
from conftest import analysed

from mbsym.algebra.failures import Failure
from mbsym.analysis import Analysis
from mbsym.analysis.constrained import on_a_plane
from mbsym.problems.stability.words import Word

#: Roberval's balance (1669): plates at the ends of two parallel beams, loads wherever on them.
ROBERVAL = """
mbsym: 1
name: R
parameters: {h: positive, l: positive, e: real, d: real, m: positive, g: positive}
bodies:
  - {name: top, attached to: 0, connection point: [0, h, 0], rotation: {axes: [3], angles: [q]}, mass: 1,
     mass centre: [0, CENTRE, 0], inertia about: mass centre, inertia: [0, 1, 1]}
  - {name: bottom, attached to: 0, rotation: {axes: [3], angles: [p]}, mass: 1, inertia about: mass centre,
     inertia: [0, 1, 1]}
  - {name: right, attached to: top, connection point: [l, 0, 0], rotation: {axes: [3], angles: [u]}, mass: m,
     mass centre: [e, 0, 0]}
  - {name: left, attached to: top, connection point: [-l, 0, 0], rotation: {axes: [3], angles: [v]}, mass: m,
     mass centre: [d, 0, 0]}
loads: [{uniform gravity: {vector: [0, -g, 0]}}]
constraints:
  - coincide: [{body: right, point: [0, -h, 0]}, {body: bottom, point: [BELOW, 0, 0]}]
  - coincide: [{body: left, point: [0, -h, 0]}, {body: bottom, point: [-BELOW, 0, 0]}]
motion: {q: 0, p: 0, u: 0, v: 0}
values: {h: 2/5, l: 1/2, e: 3/10, d: 1/10, m: 2, g: 9.81}
"""


@pytest.mark.parametrize(
    ("centre", "word"), [("0", Word.STABLE_BUT_CYCLIC), ("-1/5", Word.STABLE), ("1/5", Word.UNSTABLE)]
)
def test_roberval_s_balance_is_indifferent_wherever_its_loads_lie(centre: str, word: Word) -> None:
    """The plates do not turn, so that their heights add up to a constant, and T = (2 + 2 m l^2) q'^2/2."""
    found = analysed(ROBERVAL.replace("CENTRE", centre).replace("BELOW", "l")).stability
    assert found.verdict.word is word
    assert found.numerical is not None
    assert found.numerical.word is word


FOUR_BAR = """
mbsym: 1
name: P
bodies:
  - {name: A, attached to: 0, rotation: {axes: [3], angles: [a]}, mass: 1, inertia about: joint, inertia: [0, 1, 1]}
  - {name: B, attached to: A, connection point: [1, 0, 0], rotation: {axes: [3], angles: [b]}, mass: 0}
  - {name: C, attached to: 0, connection point: [GROUND, 0, 0], rotation: {axes: [3], angles: [c]}, mass: 1,
     inertia about: joint, inertia: [0, 1, 1]}
constraints: [{coincide: [{body: B, point: [1, 0, 0]}, {body: C, point: [1, 0, 0]}]}]
motion: {MOTION}
"""


def four_bar(ground: str, motion: str) -> Analysis:
    return analysed(FOUR_BAR.replace("GROUND", ground).replace("MOTION", motion))


@pytest.mark.parametrize("place", ["pi/2", "pi/3", "1", "2*atan(1/3)"])
def test_a_rhombus_is_on_a_plane_but_not_where_its_links_are_in_line(place: str) -> None:
    """There it may become a kite folded upon itself: c - a is free as well."""
    there = on_a_plane(four_bar("1", f"a: {place}, b: -({place}), c: {place}"))
    assert there is not None
    assert there.coordinates == ("c",)
    assert not there.constraints
    with pytest.raises(Failure):
        on_a_plane(four_bar("1", "a: 0, b: 0, c: 0"))


def test_a_trapezium_has_a_tangent_of_numbers_and_is_on_no_plane() -> None:
    """Where it is symmetric, a' = c' = -b'/2; it does not stay so."""
    analysis = four_bar("2", "a: pi/3, b: -pi/3, c: 2*pi/3")
    assert on_a_plane(analysis) is None
    assert analysis.equilibrium.satisfied
