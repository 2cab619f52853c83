"""Soft and hard borders of maps, against Lyapunov coefficients found by hand.

x'' - (p - q^2) x' + w^2 x + (q - 1/3) x'^3 + s x^2 x' = 0 has imaginary roots on p = q^2, where averaging over
x = r cos(w t) gives  r' = -(3 w^2 (q - 1/3) + s) r^3/8  (Guckenheimer & Holmes, (3.4.11); w^2 = 1 + q^2 here).
"""

from __future__ import annotations

import csv
import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from conftest import invoked
from flint import fmpq
from jsonschema import Draft202012Validator

import mbsym
from mbsym.maps import soft_borders
from mbsym.maps.mapping import exact_map
from mbsym.maps.result import Cell, Map
from mbsym.maps.section import Axis
from mbsym.maps.slices import stack
from mbsym.maps.soft_borders import Missing, Onset
from mbsym.problems.normal_forms.result import Why
from mbsym.report.language import Language
from mbsym.report.maps.figure import lettered, letters
from mbsym.report.maps.words import onset_words
from mbsym.report.schemas import schema
from mbsym.studies.map.answer import borders_of_slices, remarks

TEXT = """
mbsym: 1
name: a border that changes
parameters: {p: {}, q: {}, s: {}}
bodies:
  - {name: one, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - {potential: (1 + q**2)*x**2/2}
  - {generalized force: {x: "(p - q**2 - s*x**2)*x_dot - (q - 1/3)*x_dot**3"}}
motion: {x: 0}
"""


def mapped(text: str, across: str, up: str, low: int = -1, **settings: int | Fraction) -> Map:
    axes = [Axis(name, Fraction(low), Fraction(1)) for name in (across, up)]
    return exact_map(mbsym.loads(text), axes, {k: Fraction(v) for k, v in settings.items()})


def borders(found: Map) -> list[Cell]:
    return [one for one in found.arcs if one.soft is not None]


def told(found: Map) -> set[tuple[Any, Any, Onset]]:
    """All stretches; the lines p = 0 and q = 0, on which the law of the energy depends, divide arcs, too."""
    strata = borders(found)
    assert strata
    assert all(one.soft is not None and one.soft.stretches is not None for one in strata)
    return {(*sorted((x.start, x.end)), x.onset) for one in strata for x in one.soft.stretches}  # type: ignore


@pytest.fixture(scope="module")
def changing() -> Map:
    return mapped(TEXT, "q", "p", s=0)


def test_where_a_border_changes_from_hard_to_soft(changing: Map) -> None:
    assert told(changing) == {(-1, 0, Onset.HARD), (0, fmpq(1, 3), Onset.HARD), (fmpq(1, 3), 1, Onset.SOFT)}
    for arc in borders(changing):
        q = Fraction(str(changing.arrangement.arcs[arc.number].point.x))
        assert arc.soft is not None
        assert float(arc.soft.coefficient) == pytest.approx(float(-3 * (1 + q**2) * (q - Fraction(1, 3)) / 8))
        assert float(arc.soft.frequency) ** 2 == pytest.approx(float(1 + q**2))
    assert onset_words(borders(changing)) == ["soft border in parts, hard in others"]
    assert [Language("ru").say(x) for x in onset_words(borders(changing))] == [
        ("граница частью безопасная, частью опасная")
    ]


def test_the_same_with_the_axes_exchanged() -> None:
    """Two branches over p, of which the lower one is hard: q < 0."""
    ninth = fmpq(1, 9)
    assert told(mapped(TEXT, "p", "q", s=0)) == {(0, 1, Onset.HARD), (0, ninth, Onset.HARD), (ninth, 1, Onset.SOFT)}


@pytest.mark.parametrize(("s", "onset"), [(9, Onset.SOFT), (-9, Onset.HARD)])
def test_a_whole_border(s: int, onset: Onset) -> None:
    """3 (1 + q^2)(q - 1/3) is between -8 and 4 for -1 < q < 1: s decides alone."""
    found = mapped(TEXT, "q", "p", s=s)
    assert told(found) == {(-1, 0, onset), (0, 1, onset)}
    assert onset_words(borders(found)) == [f"{onset} border"]


CIRCLE = TEXT.replace("(p - q**2 -", "(1/16 - (p - 1/2)**2 - (q - 1/2)**2 -")


def test_a_closed_border() -> None:
    """Through points with vertical tangents; 3 (1 + q^2)(q - 1/3) is between -1/2 and 9/4 on it."""
    (arc,) = borders(mapped(CIRCLE, "p", "q", 0, s=3))
    assert arc.soft is not None
    assert arc.soft.stretches is not None
    assert [x.onset for x in arc.soft.stretches] == [Onset.SOFT]


def test_a_closed_border_that_changes() -> None:
    """q = 1/3 on the circle: (p - 1/2)^2 = 1/16 - 1/36 = 5/144; hard below."""
    (arc,) = borders(mapped(CIRCLE, "p", "q", 0, s=0))
    assert arc.soft is not None
    assert arc.soft.stretches is not None
    ends = sorted({round(float(x.start), 9) for x in arc.soft.stretches if not hasattr(x.start, "p")})
    assert ends == [round(0.5 - 5**0.5 / 12, 9), round(0.5 + 5**0.5 / 12, 9)]
    assert {x.onset for x in arc.soft.stretches} == {Onset.SOFT, Onset.HARD}


def test_a_coefficient_with_a_double_zero_leaves_one_point_out() -> None:
    """(q - 1/3)^2 in place of q - 1/3: soft on both sides, and nothing is said at q = 1/3."""
    found = mapped(TEXT.replace("(q - 1/3)*x_dot", "(q - 1/3)**2*x_dot"), "q", "p", s=0)
    assert told(found) == {(-1, 0, Onset.SOFT), (0, fmpq(1, 3), Onset.SOFT), (fmpq(1, 3), 1, Onset.SOFT)}


def test_a_linear_border_is_neither() -> None:
    """Without any term of third order a = 0 on the whole arc."""
    found = borders(mapped(TEXT.replace("(q - 1/3)*x_dot**3", "0*x_dot**3"), "q", "p", s=0))
    assert {(x.soft.onset, x.soft.why) for x in found if x.soft} == {(Onset.OPEN, Why.COEFFICIENT_OPEN)}
    assert onset_words(found) == []


def test_two_pairs_at_once_are_left_open() -> None:
    """A second oscillator of another frequency with the same damping: no theorem about one pair applies."""
    text = TEXT.replace("connection point: [x, 0, 0]", "connection point: [x, y, 0]")
    text = text.replace("coordinates: [x]", "coordinates: [x, y]").replace("x**2/2}", "x**2/2 + 2*y**2}")
    text = text.replace('x_dot**3"}', 'x_dot**3", y: (p - q**2 - s*y**2)*y_dot}').replace("{x: 0}", "{x: 0, y: 0}")
    found = borders(mapped(text, "q", "p", s=1))
    assert {(x.soft.onset, x.soft.why) for x in found if x.soft} == {(Onset.OPEN, Why.MORE_PAIRS)}


MATRICES = """mbsym: 1
name: m
parameters: {p: {}, q: {}}
linear system: {coordinates: [x], M: [[1]], D: [[q**2 - p]], K: [[1]]}
"""
SPRINGS = TEXT.replace("(p - q**2 - s*x**2)*x_dot - (q - 1/3)*x_dot**3", "(p - q**2)*x_dot").replace(", s: {}", "")


@pytest.mark.parametrize("text", [MATRICES, SPRINGS])
def test_exactly_linear_equations_have_no_terms_of_third_order(text: str) -> None:
    """There are none that could be called not at hand, whether bodies or matrices are given."""
    found = borders(mapped(text, "q", "p"))
    assert {(x.soft.onset, x.soft.why) for x in found if x.soft} == {(Onset.NEITHER, Missing.LINEAR)}


def test_a_wrong_formula_is_not_believed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both routes have to agree at every sample: with the sign of one turned only the point is told."""
    right = soft_borders._Along.sign
    monkeypatch.setattr(soft_borders._Along, "sign", lambda self, x, y: -right(self, x, y))
    found = borders(mapped(TEXT, "q", "p", s=9))
    assert {(x.soft.onset, x.soft.stretches) for x in found if x.soft} == {(Onset.SOFT, None)}
    assert onset_words(found) == []


def test_a_zero_of_a_line() -> None:
    """p = q^2 with q = 1/2: a = -(3 * 5/4 * 1/6)/8 = -5/64."""
    settings = {"q": Fraction(1, 2), "s": Fraction(0)}
    found = exact_map(mbsym.loads(TEXT), [Axis("p", Fraction(-1), Fraction(1))], settings)
    (zero,) = [one for one in found.corners if one.soft is not None]
    assert zero.soft is not None
    assert zero.soft.onset is Onset.SOFT
    assert float(zero.soft.coefficient) == pytest.approx(-5 / 64, rel=1e-12)


def test_what_is_written(tmp_path: Path) -> None:
    """map.json by its schema, located.csv at points of the arc, the terminal."""
    (tmp_path / "changing.yaml").write_text(TEXT)
    (tmp_path / "points.csv").write_text("q,p\n1/2,1/4\n0,0\n1/3,1/9\n0,1/2\n")
    words = ["map", str(tmp_path / "changing.yaml"), "--x", "q=-1:1", "--y", "p=-1:1", "-s", "s=0"]
    words += ["--format", "json,tex", "--locate", str(tmp_path / "points.csv"), "-o", str(tmp_path / "out")]
    done = invoked(*words, code=0)
    content = json.loads((tmp_path / "out" / "map.json").read_text())
    assert not list(Draft202012Validator(schema("map")).iter_errors(content))
    along = [x for one in content["arcs"] if one["soft_or_hard"] for x in one["soft_or_hard"]["along"]]
    ends = [("-1", "0", "hard"), ("0", "1/3", "hard"), ("1/3", "1", "soft")]
    assert sorted((x["from"]["exact"], x["to"]["exact"], x["onset"]) for x in along) == sorted(ends)
    rows = list(csv.DictReader((tmp_path / "out" / "located.csv").open()))
    assert [row["border"] for row in rows] == ["soft", "hard", "open", ""]
    assert "hard for q from 0 to 0.333333; soft for q from 0.333333 to 1" in " ".join(done.stdout.split())
    assert "soft border in parts, hard in others" in (tmp_path / "out" / "map.tex").read_text()


# --- where stability is not lost ---

TOUCHING = """
mbsym: 1
name: a pair that touches the axis
parameters: {p: {}, q: {}, k: {}}
bodies:
  - {name: one, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - {potential: x**2/2 + y**2}
  - {generalized force: {x: -DAMPING*x_dot - k*x_dot**3, y: -BESIDE*y_dot}}
motion: {x: 0, y: 0}
"""


@pytest.mark.parametrize("damping", ["-(p**2)", "p**2"])
def test_a_pair_that_only_touches_the_axis_is_no_border(damping: str) -> None:
    """Damped, driven on both sides of p = 0."""
    why, text = Missing.NO_LOSS, TOUCHING.replace("-DAMPING", damping).replace("BESIDE", "1")
    found = exact_map(mbsym.loads(text), [Axis("p", Fraction(-1), Fraction(1))], {"q": Fraction(0), "k": Fraction(1)})
    (zero,) = [one for one in found.corners if one.soft is not None]
    assert zero.soft is not None
    assert (zero.soft.onset, zero.soft.why) == (Onset.NEITHER, why)
    assert onset_words([zero]) == []
    plane = mapped(text, "p", "q", k=1)
    assert {(x.soft.onset, x.soft.why) for x in borders(plane) if x.soft} == {(Onset.NEITHER, why)}


def test_an_isolated_point_has_one_region_around_it() -> None:
    """x is damped by (p - 1/3)^2 + (q - 1/5)^2, so everywhere but at a point: nothing is lost there."""
    text = TOUCHING.replace("-DAMPING", "-((p - 1/3)**2 + (q - 1/5)**2)").replace("BESIDE", "1")
    plane = mapped(text, "p", "q", k=1)
    (point,) = [one for one in plane.corners if plane.place(one).kind == "isolated"]
    assert point.soft is not None
    assert (point.soft.onset, point.soft.why) == (Onset.NEITHER, Missing.NO_LOSS)


def test_a_border_between_two_unstable_cells_is_none() -> None:
    """x is driven for p > 0, y for q > 0: at p = 0 stability is lost for q < 0 alone, and so with p and q exchanged."""
    text = TOUCHING.replace("-DAMPING", "p").replace("-BESIDE", "q")
    plane = mapped(text, "p", "q", k=1)
    assert len(borders(plane)) == 2
    for arc in plane.arcs:
        there = arc.sample
        sides = {x.right for x in plane.beside(arc) if x is not None}
        if arc.soft is not None:
            assert sides == {0, 2}, there
        else:
            assert 0 not in sides or len(sides) == 1, there
    assert Why.MORE_PAIRS in {one.soft.why for one in plane.corners if one.soft is not None}  # at p = q = 0


def test_a_border_at_the_end_of_a_line_has_one_side() -> None:
    settings = {"q": Fraction(1, 2), "s": Fraction(0)}
    found = exact_map(mbsym.loads(TEXT), [Axis("p", Fraction(1, 4), Fraction(1))], settings)
    assert {one.soft.why for one in found.corners if one.soft is not None} <= {Missing.ONE_SIDE}


def test_borders_of_slices() -> None:
    """p = q^2 + z^2 - 2: critical is z = sqrt(2), irrational, where the parabola touches the axis p = 0."""
    text = TEXT.replace("(p - q**2 -", "(p - q**2 - z**2 + 2 -").replace("s: {}", "s: {}, z: {}")
    axes = [Axis(name, Fraction(-1), Fraction(1)) for name in ("q", "p")]
    found = stack(mbsym.loads(text), [*axes, Axis("z", Fraction(4, 3), Fraction(3, 2))], {"s": Fraction(9)})
    planes = [one.plane for one in found.layers if one.plane is not None]
    seen = {(one.critical, x.soft.onset) for one in found.layers if one.plane for x in one.plane.arcs if x.soft}
    assert seen == {(True, Onset.SOFT), (False, Onset.SOFT)}
    assert any("of slices: soft" in line for line in borders_of_slices(planes))


VERTICAL = """
mbsym: 1
name: soft but near one point
parameters: {a: real, b: real, c: real}
bodies:
  - {name: one, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - spring: {coordinate: x, stiffness: 1}
  - generalized force: {x: "-a*x_dot - (4*b**2 - c)*x**2*x_dot + x**4*x_dot"}
motion: {x: 0}
"""


def test_a_border_along_the_second_axis_is_told_whole() -> None:
    """r' = -(a/2) r - (4 b^2 - c) r^3/8 + ... on a = 0: with c = 1/100 hard for |b| < 1/20 only; the point at which the
    arc is judged, b = 0, once spoke for all of it."""
    found = mapped(VERTICAL, "a", "b", c=Fraction(1, 100))
    (one,) = borders(found)
    assert one.soft is not None
    assert one.soft.stretches is not None
    twentieth = fmpq(1, 20)
    assert [(x.start, x.end, x.onset, x.axis) for x in one.soft.stretches] == [
        (fmpq(-1), -twentieth, Onset.SOFT, 1),
        (-twentieth, twentieth, Onset.HARD, 1),
        (twentieth, fmpq(1), Onset.SOFT, 1),
    ]
    (line,) = [x for x in remarks(found) if x.startswith("imaginary pair")]
    assert line.endswith("soft for b from -1 to -0.05; hard for b from -0.05 to 0.05; soft for b from 0.05 to 1")


def test_a_zero_of_the_coefficient_at_one_point_leaves_the_arc_decided() -> None:
    """With c = 0 the coefficient -b^2/2 vanishes at b = 0 alone: soft on both sides of it, where the energy falls."""
    found = mapped(VERTICAL, "a", "b", c=0)
    assert told(found) == {(fmpq(-1), fmpq(0), Onset.SOFT), (fmpq(0), fmpq(1), Onset.SOFT)}
    turned = borders(mapped(VERTICAL.replace("4*b**2 - c", "c - 4*b**2"), "b", "a", c=0))
    stretches = [x for one in turned if one.soft is not None for x in one.soft.stretches or ()]
    assert {x.onset for x in stretches} == {Onset.HARD}
    assert {x.axis for x in stretches} == {0}


UNCHANGED = """
mbsym: 1
name: gyroscopic forces beside complete damping change no verdict
parameters: {a: real, b: real, d: real}
bodies:
  - {name: one, mass: 1, connection point: [x, y, 0], coordinates: [x, y]}
loads:
  - potential: (x**2 + 2*y**2)/2
  - damper: {coordinate: x, coefficient: d}
  - damper: {coordinate: y, coefficient: d}
  - generalized force: {x: (a - b)*y_dot, y: -(a - b)*x_dot}
motion: {}
"""


def test_regions_that_no_change_of_verdict_separates_are_counted_as_one() -> None:
    """K > 0 and D > 0: asymptotically stable whatever G is (Kelvin-Chetaev), on the line G = 0 as well."""
    found = mapped(UNCHANGED, "a", "b", d=1)
    assert len(found.regions) == 2
    assert found.together == (0, 0)
    assert any("also of curves at which no verdict changes" in x for x in remarks(found))
    # Without damping the motion is stable on both sides and on the line: one; with d over an axis: d = 0 separates.
    assert len({*mapped(UNCHANGED, "a", "b", d=0).together}) == 1
    across = mapped(UNCHANGED, "d", "a", b=0)
    words = {across.regions[k].word for k in across.together}
    assert len({*across.together}) == len(words) == 2


def test_a_curve_is_not_called_what_an_axis_is_called() -> None:
    assert letters(["a", "b"], 3) == ["c", "d", "e"]
    assert letters([], 27)[-2:] == ["z", "a1"]
    found = mapped(VERTICAL, "a", "b", c=Fraction(1, 100))
    assert not {"a", "b"} & {*lettered(found).values()}
