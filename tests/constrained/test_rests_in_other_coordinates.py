"""Rests of a four-bar do not depend on its description: angles of joints or of bars, where its loop is cut."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from conftest import system_of

from mbsym.analysis.resting import relative_equilibria
from mbsym.problems.relative_equilibria.equilibria import Equilibria

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
