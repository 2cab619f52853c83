"""Counts at corners and on arcs are held against those of the regions beside them."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest

import mbsym
from mbsym.maps import mapping
from mbsym.maps.check import Mistake
from mbsym.maps.mapping import exact_map
from mbsym.maps.result import Lack, Shape
from mbsym.maps.section import Axis
from mbsym.maps.verdicts import jumps

#: With b2 = 2/23 the discriminant of the follower force has an isolated point in the stable region.
AXES = [Axis("P", Fraction(0), Fraction(4)), Axis("b1", Fraction(0), Fraction(1))]
VALUES = {"b2": Fraction(2, 23)}


def test_more_roots_to_the_right_at_an_isolated_point_are_not_believed(monkeypatch: pytest.MonkeyPatch) -> None:
    analysis = mbsym.load("systems/ziegler-damped.yaml")
    found = exact_map(analysis, AXES, VALUES)
    assert found.check is not None
    assert found.check.holds
    isolated = next(one.id for one in found.arrangement.corners if one.kind == "isolated")
    judged = found.corners[isolated].judged
    assert judged is not None
    assert judged.right == 0
    regions, arcs, corners = ([one.judged for one in part] for part in (found.regions, found.arcs, found.corners))
    assert jumps(found.arrangement, regions, arcs, corners) == ([], [])
    whole = mapping.Judge.judged

    def lying(self: Any, shape: Shape, point: Any, place: Any) -> Any:
        told = whole(self, shape, point, place)
        return replace(told, right=1) if shape is Shape.CORNER and told.right == 0 and told.border is None else told

    monkeypatch.setattr(mapping.Judge, "judged", lying)
    wrong = exact_map(analysis, AXES, VALUES)
    assert wrong.check is not None
    assert {(one.mistake, one.region, one.arc) for one in wrong.check.findings} == {(Mistake.JUMP, None, None)}
    assert isolated in {one.corner for one in wrong.check.findings}
    assert wrong.corners[isolated].lack is Lack.WITHDRAWN
    assert all(one.lack is not Lack.WITHDRAWN for one in (*wrong.regions, *wrong.arcs))


def test_negative_eigenvalues_of_k_on_a_curve_fit_both_sides() -> None:
    found = exact_map(mbsym.load("systems/ziegler-damped.yaml"), AXES, VALUES)
    regions, arcs = ([one.judged for one in part] for part in (found.regions, found.arcs))
    at = next(k for k, one in enumerate(arcs) if one is not None and one.null == 0)
    one = arcs[at]
    assert one is not None
    assert one.degree is not None
    arcs[at] = replace(one, degree=one.degree + 1)
    assert jumps(found.arrangement, regions, arcs, [])[0] == [at]
