"""Rests of a four-bar do not depend on its description: angles of joints or of bars, where its loop is cut."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from conftest import system_of

from mbsym.analysis import Analysis
from mbsym.analysis.resting import relative_equilibria
from mbsym.maps.axis import Axis
from mbsym.maps.boxes import box_map
from mbsym.maps.mapping import exact_map
from mbsym.problems.relative_equilibria.equilibria import Equilibria
from mbsym.problems.stability.words import Word

BAR = "mass: 1, inertia about: mass centre, inertia: [0, {0}**2/12, {0}**2/12], mass centre: [{0}/2, 0, 0]"
TURNS = "rotation: {{axes: [3], angles: [{0}]}}"


def bar(name: str, on: str, at: str, angle: str, length: Fraction) -> str:
    parts = (f"name: {name}, attached to: {on}, connection point: [{at}, 0]", TURNS.format(angle), BAR.format(length))
    return f"  - {{{', '.join(parts)}}}\n"


def described(lengths: list[Fraction], how: str, loads: str) -> str:
    """Bars a, b, c over a ground; ``how``: 'joints', 'bars' (their own directions), 'cut' between a and b."""
    a, b, c, d = lengths
    crank, rocker = bar("a", "0", "0, 0", "p", a), bar("c", "0", f"{d}, 0", "s", c)
    coupler, tie = {
        "joints": (
            bar("b", "a", f"{a}, 0", "q", b),
            f"{{body: b, point: [{b}, 0, 0]}}, {{body: c, point: [{c}, 0, 0]}}",
        ),
        "bars": (
            bar("b", "0", f"{a}*cos(p), {a}*sin(p)", "q", b),
            f"{{body: b, point: [{b}, 0, 0]}}, {{body: c, point: [{c}, 0, 0]}}",
        ),
        "cut": (bar("b", "c", f"{c}, 0", "q", b), f"{{body: b, point: [{b}, 0, 0]}}, {{body: a, point: [{a}, 0, 0]}}"),
    }[how]
    bodies = crank + (rocker + coupler if how == "cut" else coupler + rocker)
    return f"mbsym: 1\nname: F\nbodies:\n{bodies}{loads}constraints: [{{coincide: [{tie}]}}]\n"


def places(found: Equilibria) -> set[tuple[float, float, str]]:
    """The crank, the rocker and the verdict; the coupler follows."""
    told = set()
    for one in found.equilibria:
        at = {x.name: x.value for x in one.values}
        told.add((round(at["p"], 6), round(math.remainder(at["s"], 2 * math.pi), 6), str(one.verdict.word)))
    return told


@pytest.mark.parametrize(
    ("seed", "spring"), [(0, ""), (1, ""), (2, ""), (3, "  - spring: {coordinate: p, stiffness: 9}\n")]
)
def test_rests_of_a_four_bar_in_three_descriptions(seed: int, spring: str) -> None:
    """Exact lists under gravity, and with a torsional spring those within the same range of the crank."""
    source = np.random.default_rng(seed)
    while True:
        lengths = [Fraction(int(x), 4) for x in source.integers(3, 13, 4)]
        signs = {sum(x * s for x, s in zip(lengths, (1, i, j, k), strict=True)) for i in (1, -1) for j in (1, -1)
                 for k in (1, -1)}  # fmt: skip
        if 2 * max(lengths) < sum(lengths) and 0 not in signs:  # it can be closed, and is never in line
            break
    gx, gy = (int(x) for x in source.integers(-9, 10, 2))
    loads = f"loads:\n  - uniform gravity: {{vector: [{gx}, {gy}, 0]}}\n{spring}"
    lists = []
    for how in ("joints", "bars", "cut"):
        system = system_of(described(lengths, how, loads))
        lists.append(relative_equilibria(system, {}))
    first, *others = map(places, lists)
    assert len(first) >= 2
    for other in others:
        assert other == first
    if not spring:
        assert all(one.complete for one in lists)
    assert not any("undecided" in remark for one in lists for remark in one.remarks)


BALL_IN_A_BOWL = """
mbsym: 1
name: B
parameters: {r: {value: 1/10, sign: positive}, J: {value: 1/250, sign: positive}, g: {value: 9.81, sign: positive}}
bodies:
  - {name: centre, attached to: 0, connection point: [x, y, z], coordinates: [x, y, z], mass: 1}
  - {name: ball, attached to: centre, rotation: {axes: [1, 2, 3], angles: [a, b, c]}, mass: 0, inertia about: joint,
     inertia: [MOMENTS]SPEEDS}
loads: [{uniform gravity: {vector: [0, 0, -g]}}]
constraints:
  - relation: x**2 + y**2 + z**2 = 1/4
  - rolling: {body: ball, point: [2*r*x, 2*r*y, 2*r*z], axes: 0, on: ground}
motion: {x: 0, y: 0, z: PLACE, a: TURN, b: TURN, c: 0}
"""
ALIKE, TILTED, QUATERNION = (
    "J, J, J",
    "2*atan(-1/2)",
    ", speeds: {p: omega1, q: omega2, s: omega3}, orientation: quaternion",
)


def ball(place: str = "-1/2", moments: str = ALIKE, turn: str = "0", speeds: str = "") -> Analysis:
    text = BALL_IN_A_BOWL.replace("PLACE", place).replace("MOMENTS", moments).replace("TURN", turn)
    return Analysis(system_of(text.replace("SPEEDS", speeds)), ())


@pytest.mark.parametrize(("turn", "speeds"), [("0", ""), (TILTED, ""), ("0", QUATERNION)])
def test_a_ball_at_the_bottom_of_a_bowl_rests_stably_however_it_is_turned_and_asked_for(turn: str, speeds: str) -> None:
    """Its energy without rolling has a minimum but for spins; one about the vertical is left: run, map and boxes."""
    analysis = ball(turn=turn, speeds=speeds)
    axes = [Axis("J", Fraction(1, 500), Fraction(1, 100)), Axis("g", Fraction(5), Fraction(15))]
    mapped = exact_map(analysis, axes, {})
    assert {cell.judged.verdict.word for cell in mapped.regions if cell.judged} == {Word.STABLE_BUT_CYCLIC}
    boxes = box_map(analysis, axes, {}).regions
    assert {cell.judged.verdict.word for cell in boxes if cell.judged} == {Word.STABLE_BUT_CYCLIC}
    there = analysis.in_coordinates if speeds else analysis
    assert there.stability.numerical is not None
    assert there.stability.numerical.word is there.stability.verdict.word is Word.STABLE_BUT_CYCLIC


@pytest.mark.parametrize(
    ("place", "moments", "word"), [("1/2", ALIKE, Word.UNSTABLE), ("-1/2", "J, 2*J, 3/2*J", Word.UNDECIDED)]
)
def test_on_top_it_falls_and_of_unequal_moments_nothing_is_said(place: str, moments: str, word: Word) -> None:
    found = exact_map(ball(place, moments, TILTED), [Axis("J", Fraction(1, 500), Fraction(1, 100))], {})
    assert {cell.judged.verdict.word for cell in found.regions if cell.judged} == {word}


FREE_BALL = """
mbsym: 1
name: B
bodies:
  - {name: centre, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: 1}
  - {name: ball, attached to: centre, rotation: {axes: [1, 2, 3], angles: [a, b, c]}, mass: 0, inertia about: joint,
     inertia: [MOMENTS]}
loads: [{potential: 3*x**2/2}]
motion: {x: 0, a: TURN, b: TURN, c: 0}
"""


@pytest.mark.parametrize("turn", ["0", TILTED])
def test_a_free_ball_only_drifts_from_wherever_it_is_turned(turn: str) -> None:
    """In the angle that the first approximation sets apart, too, where a sum of turns moves it alone."""
    verdict = Analysis(system_of(FREE_BALL.replace("MOMENTS", "2, 2, 2").replace("TURN", turn)), ()).stability.verdict
    assert verdict.word is Word.STABLE_BUT_CYCLIC
    other = Analysis(system_of(FREE_BALL.replace("MOMENTS", "2, 3, 4").replace("TURN", turn)), ()).stability.verdict
    assert other.word is not Word.STABLE
