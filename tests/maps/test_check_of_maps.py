"""What is planted in a map is found by its own check: a lost boundary, a wrong sign, verdict, corner or arc."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import pytest
from flint import fmpq

import mbsym
from mbsym.algebra.arrangements import Arrangement, decompose
from mbsym.algebra.plane import Box, Point, decompose_line
from mbsym.maps.boundaries import boundaries
from mbsym.maps.check import Check, ExactVerdicts, Mistake, check
from mbsym.maps.mapping import exact_map
from mbsym.maps.section import Axis, Section, section
from mbsym.maps.verdicts import Judged
from mbsym.problems.stability.words import Word

MAPS = {
    "satellite": ({"alpha": ("-1", "1"), "gamma": ("-1", "1")}, {"p1": "2/5", "p2": "1/5"}),
    "ziegler-damped": ({"P": ("0", "5"), "b1": ("0", "1")}, {"m": 1, "l": 1, "k": 1, "b2": "1/10"}),
    "gravity-gradient": ({"A": ("1/10", "3"), "B": ("1/10", "3")}, {"R": 1, "omega0": 1, "m": 1, "C": 1}),
}


@dataclass
class Map:
    section: Section
    found: Arrangement
    judge: ExactVerdicts

    def of(self, found: Arrangement) -> tuple[list[Judged], list[Judged]]:
        """The verdicts of regions and arcs."""
        regions = [self.judge(Point(*region.sample)) for region in found.regions]
        return regions, [self.judge(arc.point) for arc in found.arcs]

    def checked(self, found: Arrangement) -> Check:
        return check(self.section, found, *self.of(found))


@pytest.fixture(scope="module", params=MAPS)
def drawn(request: pytest.FixtureRequest) -> Map:
    axes, settings = MAPS[request.param]
    listed = [Axis(name, *map(Fraction, ends)) for name, ends in axes.items()]
    made = section(
        mbsym.load(f"systems/{request.param}.yaml"), listed, {name: Fraction(x) for name, x in settings.items()}
    )
    ends = [fmpq(x.numerator, x.denominator) for axis in listed for x in (axis.low, axis.high)]
    return Map(made, decompose(boundaries(made).factors, Box(*ends)), ExactVerdicts(made))


def told(judged: Judged) -> tuple[Any, ...]:
    return judged.verdict.word, judged.right, judged.degree, judged.null


def test_a_right_map_holds(drawn: Map) -> None:
    found = drawn.checked(drawn.found)
    assert found.holds
    assert found.points >= 96
    assert found.arcs == len(drawn.found.arcs)
    assert found.enclosed == found.points


def test_a_lost_boundary_is_found_wherever_it_parts_verdicts(drawn: Map) -> None:
    regions, _ = drawn.of(drawn.found)
    parting = {
        arc.factors[0]
        for arc in drawn.found.arcs
        if len(arc.factors) == 1
        and None not in arc.regions
        and told(regions[arc.regions[0]]) != told(regions[arc.regions[1]])
    }
    assert parting
    for lost in parting:
        kept = [p for k, p in enumerate(drawn.found.factors) if k != lost]
        findings = drawn.checked(decompose(kept, drawn.found.box)).findings
        assert {one.mistake for one in findings} & {Mistake.VERDICT, Mistake.COUNT}, lost
        assert any(one.mistake is Mistake.BALLS for one in findings), lost


def test_planted_mistakes_are_found(drawn: Map) -> None:
    found = drawn.found
    if len(found.regions) > 12:
        pytest.skip("the small maps show it")
    regions, arcs = drawn.of(found)

    def mistakes(**changed: Any) -> set[Mistake]:
        given = {"decomposition": found, "regions": regions, "arcs": arcs} | changed
        return {one.mistake for one in check(drawn.section, **given).findings}

    wrong = replace(found.regions[0], signs=tuple(-s for s in found.regions[0].signs))
    assert mistakes(decomposition=replace(found, regions=(wrong, *found.regions[1:]))) >= {Mistake.SIGNS, Mistake.LAW}
    assert Mistake.LAW in mistakes(decomposition=replace(found, corners=found.corners[:-1]))
    assert Mistake.LAW in mistakes(decomposition=replace(found, arcs=found.arcs[:-1]), arcs=arcs[:-1])
    other = next(judged for judged in regions if judged.verdict.word is not regions[0].verdict.word)
    assert Mistake.VERDICT in mistakes(regions=[other, *regions[1:]])
    at = next(k for k, judged in enumerate(arcs) if judged.verdict.word is not regions[0].verdict.word)
    assert Mistake.VERDICT in mistakes(arcs=[*arcs[:at], regions[0], *arcs[at + 1 :]])
    miscounted = replace(regions[0], right=(regions[0].right or 0) + 2)
    assert {Mistake.COUNT, Mistake.BALLS} <= mistakes(regions=[miscounted, *regions[1:]])


def test_a_line() -> None:
    """The sleeping top with A = m = l = g = 1, C = 1/2: C^2 Omega^2 > 4 A m g l, so from Omega = 4 on."""
    made = section(
        mbsym.load("systems/heavy-top.yaml"),
        [Axis("Omega", Fraction(0), Fraction(10))],
        {"A": Fraction(1), "C": Fraction(1, 2), "m": Fraction(1), "g": Fraction(1), "l": Fraction(1)},
    )
    judge = ExactVerdicts(made)
    factors = boundaries(made).factors
    found = decompose_line(factors, 0, 10)
    inner = [zero.number for zero in found.zeros if zero.number not in (0, 10)]
    assert inner == [4]
    verdicts = [judge(interval.sample) for interval in found.intervals]
    assert verdicts[0].verdict.word is Word.UNSTABLE
    assert verdicts[1].right == 0
    assert check(made, found, verdicts).holds
    lost = decompose_line([p for p in factors if p(fmpq(4)) != 0], 0, 10)
    assert not check(made, lost, [judge(interval.sample) for interval in lost.intervals]).holds


@pytest.mark.parametrize(
    ("name", "axis", "low", "high", "settings"),
    [("rolling-disc", "w", "1/10", "1/2", "mrg"), ("chaplygin-sleigh", "v", 1, 2, "")],
)
def test_balls_confirm_counts_where_zero_roots_have_blocks(
    name: str, axis: str, low: Any, high: Any, settings: str
) -> None:
    """Idle coordinates, whose roots are zero in blocks, do not keep balls from deciding the others: at every point."""
    values = dict.fromkeys(settings, Fraction(1))
    found = exact_map(mbsym.load(f"systems/{name}.yaml"), [Axis(axis, Fraction(low), Fraction(high))], values)
    assert found.check is not None
    assert found.check.holds
    assert found.check.enclosed == found.check.points > 90


def test_a_wrong_count_beside_zero_roots_is_excluded_by_balls() -> None:
    """The disc falls where w^2 < g/(3 r): with no root to the right planted there, balls exclude that."""
    values = dict.fromkeys("mrg", Fraction(1))
    found = exact_map(mbsym.load("systems/rolling-disc.yaml"), [Axis("w", Fraction(1, 10), Fraction(1, 2))], values)
    planted = [replace(one.judged, right=0) if one.judged else None for one in found.regions]
    wrong = check(found.section, found.line, planted)
    assert Mistake.BALLS in {one.mistake for one in wrong.findings}
