"""A map is one value, whatever it is over and of: cells with samples, certainty and reasons; one set of writers."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import pytest
from conftest import invoked
from flint import fmpq
from jsonschema import Draft202012Validator

import mbsym
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.plane import Point
from mbsym.maps.boxes import box_map
from mbsym.maps.branches import branches
from mbsym.maps.equilibria_map import equilibria_map
from mbsym.maps.mapping import exact_map
from mbsym.maps.result import Cell, Lack, Map, Shape
from mbsym.maps.section import Axis
from mbsym.maps.slices import Stack, stack
from mbsym.problems.stability.words import Word
from mbsym.report.language import Language
from mbsym.report.maps.figure import map_figure
from mbsym.report.maps.frame import values_lines
from mbsym.report.maps.json import map_json
from mbsym.report.maps.tex import map_tex
from mbsym.report.maps.words import rational_text, share, stem
from mbsym.report.schemas import schema
from mbsym.studies.map.answer import remarks

#: x'' = p x - x^3 + q: one equilibrium, and three where 4 p^3 > 27 q^2.
CUSP = """mbsym: 1
name: cusp
parameters: {p: {sign: real}, q: {sign: real}}
bodies:
  - {name: ball, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: 1}
loads:
  - generalized force: {x: p*x - x**3 + q}
"""

SPRINGS = """mbsym: 1
name: springs
parameters: {a: {sign: real}, b: {sign: real}, c: {sign: positive}}
assumptions: [ASSUMED]
linear system: {coordinates: [x, y], K: [[a, 0], [0, STIFF]]}
"""


def axis(name: str, low: int = -1, high: int = 1) -> Axis:
    return Axis(name, Fraction(low), Fraction(high))


def springs(stiff: str = "b", assumed: str = "c > 0") -> mbsym.Analysis:
    text = SPRINGS.replace("STIFF", stiff).replace("ASSUMED", assumed)
    return mbsym.loads(text)


A, B, C, P, Q = axis("a"), axis("b"), axis("c", 1, 2), axis("p"), axis("q")
ONE = {"b": Fraction(1), "c": Fraction(1)}

KINDS: dict[str, Callable[[], tuple[mbsym.Analysis, Map]]] = {
    "line": lambda: (found := springs(), exact_map(found, [A], ONE)),
    "plane": lambda: (found := springs(), exact_map(found, [A, B], {"c": Fraction(1)})),
    "boxes": lambda: (found := springs(), box_map(found, [A, B], {"c": Fraction(1)}, depth=6)),
    "slices": lambda: (found := springs("b - c"), stack(found, [A, B, C], {})),
    "equilibria": lambda: (found := mbsym.loads(CUSP), equilibria_map(found.system, (P, Q), {}, lambda *_: None)),
    "branches": lambda: (found := mbsym.loads(CUSP), branches(found.system, P, {"q": Fraction(1, 10)})),
}


@pytest.fixture(scope="module", params=KINDS)
def made(request: pytest.FixtureRequest) -> tuple[mbsym.Analysis, Map]:
    return KINDS[request.param]()


def planes(found: Map) -> list[Map]:
    return found.planes if isinstance(found, Stack) else [found]


def coordinates(cell: Cell) -> list[Fraction]:
    point = (cell.sample.x, cell.sample.y) if isinstance(cell.sample, Point) else (cell.sample,)
    return [Fraction(int(x.p), int(x.q)) for x in point if isinstance(x, fmpq)]


def test_a_cell_is_found_at_its_own_sample(made: tuple[mbsym.Analysis, Map]) -> None:
    """Every region's sample is rational, and lies in the region and in no other cell."""
    for plane in planes(made[1]):
        for cell in plane.regions:
            there = plane.at(*coordinates(cell))
            # points of boxes that meet belong to each of them: a sample is a centre
            assert there is cell
        assert sum(area for area, _ in plane.areas) == pytest.approx(plane.whole)


def test_how_surely_a_cell_is_known(made: tuple[mbsym.Analysis, Map]) -> None:
    """Said and lacking exclude each other; a region's verdict or number is proved, an arc's holds at its point."""
    for plane in planes(made[1]):
        for cell in plane.cells:
            assert (cell.said is None) == (cell.lack is not None)
            sure = cell.said is not None and cell.shape is not Shape.ARC
            assert cell.certainty is (Certainty.PROVED if sure else Certainty.UNDECIDED)


def test_the_same_writers_write_every_map(made: tuple[mbsym.Analysis, Map]) -> None:
    analysis, found = made
    files = map_figure(analysis.system, found, Language("es"), ["svg"])
    assert f"{stem(found)}.svg" in files
    kind = stem(found).replace("-", "_")
    data = json.loads(map_json(analysis.system, found))
    assert list(Draft202012Validator(schema(kind)).iter_errors(data)) == []
    tex = map_tex(analysis.system, found, Language("es"))
    assert f"{stem(found)}.pdf" in tex
    assert f"fig:{stem(found)}}}" in tex, "a label of its own"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (fmpq(981, 100), "9.81"),
        (fmpq(2, 5), "2/5"),  # as long as 0.4: as it is
        (fmpq(-1, 100), "-0.01"),
        (fmpq(1, 3), "1/3"),  # no decimal is equal
        (fmpq(10**30 + 1, 10**30), f"{10**30 + 1}/{10**30}"),  # nor is 1
        (fmpq(7), "7"),
    ],
)
def test_numbers_stand_as_people_write_them_and_stay_exact(value: fmpq, text: str) -> None:
    assert rational_text(value) == text
    assert Fraction(text) == Fraction(int(value.p), int(value.q))


def test_points_of_numbers_of_equilibria(tmp_path: Path) -> None:
    """At p = 3/4, q = 0: x = 0 and +-sqrt(3)/2, the outer two stable; 4 p^3 = 27 q^2 at (3/4, 1/4)."""
    (tmp_path / "cusp.yaml").write_text(CUSP)
    (tmp_path / "points.csv").write_text("p,q\n3/4,0\n-1/2,1/2\n3/4,1/4\n3,0\n")
    words = ["map", tmp_path / "cusp.yaml", "--of", "equilibria", "--x", "p=-1:1", "--y", "q=-1:1", "--format", "json"]
    words += ["--locate", tmp_path / "points.csv", "--out", tmp_path / "out"]
    invoked(*words, code=0)
    rows = list(csv.DictReader(io.StringIO((tmp_path / "out" / "located.csv").read_text())))
    assert [row["verdict"] for row in rows] == ["3 equilibria, 2 stable", "1 equilibrium, 1 stable", "not counted", ""]
    assert [row["where"].split()[0] for row in rows] == ["region", "region", "arc", "outside"]


def test_a_curve_that_alone_is_admissible_is_drawn() -> None:
    """a^2 <= 0 holds at a = 0 only, where K = diag(0, b): a verdict there, none beside it."""
    found = exact_map(springs(assumed="a**2 <= 0"), [A, B], {"c": Fraction(1)})
    assert {one.lack for one in found.regions} == {Lack.OUTSIDE}
    drawn = [one for one in found.arcs if found.drawn(one)]
    assert drawn
    assert all(one.judged is not None and found.place(one).factors for one in drawn)
    assert all(found.at(Fraction(0), Fraction(b, 2)) in drawn for b in (-1, 1))


def test_a_share_that_is_not_all_is_not_called_all() -> None:
    assert [share(x) for x in (0, 1e-9, 0.5, 0.99999, 1)] == ["0 %", "less than 0.01 %", "50.00 %", "99.99 %", "100 %"]


def test_numbers_that_were_put_in_stand_above_the_picture() -> None:
    """Each once, in lines of a column's width; long fractions by their first digits, which are no equality."""
    lines = values_lines({"p1": Fraction(2, 5), "gamma": Fraction(1, 3), "k": Fraction(123456789, 1000000)})
    assert lines == ["$p_{1}$ = 2/5, $\\gamma$ = 1/3, $k$ \u2248 123.5"]
    many = values_lines({f"c{k}": Fraction(k) for k in range(40)})
    assert len(many) > 2
    assert sum(line.count(" = ") for line in many) == 40
    assert all(line.endswith(",") for line in many[:-1])
    assert not many[-1].endswith(",")


OSCILLATOR = """mbsym: 1
name: oscillator
parameters: {p: {sign: real}, s: {sign: real}}
bodies:
  - {name: one, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - generalized force: {x: FORCE}
motion: {x: 0}
"""

#: A force, an axis, other numbers: what is said where the first approximation is open.
DECIDED: dict[str, tuple[Axis, dict[str, Fraction], set[Word]]] = {
    # x^4/4 is the energy at p = 0, a minimum
    "-p*x - x**3 + 0*s": (P, {"s": Fraction(0)}, {Word.STABLE}),
    # r' = (1 - 3) s r^3/8 for all s > 0, though the energy both falls and grows; s < 0 is outside of the interval
    "-x + s*x**2*x_dot - s*x_dot**3 + 0*p": (axis("s", 1, 2), {"p": Fraction(0)}, {Word.ASYMPTOTIC}),
    "-x - s*x**2*x_dot + s*x_dot**3 + 0*p": (axis("s", 1, 2), {"p": Fraction(0)}, {Word.UNSTABLE}),
}


@pytest.mark.parametrize(
    ("force", "words"),
    [
        # E' = -s x'^4 and s x'^4: asymptotic for s > 0 and unstable for s < 0, or the other way round; E' = 0 at s = 0
        ("-x - s*x_dot**3 + 0*p", [Word.UNSTABLE, Word.STABLE, Word.ASYMPTOTIC]),
        ("-x + s*x_dot**3 + 0*p", [Word.ASYMPTOTIC, Word.STABLE, Word.UNSTABLE]),
        # the energy both falls and grows: open on the cells
        ("-x + s*x**2*x_dot - s*x_dot**3 + 0*p", [Word.CRITICAL, Word.STABLE, Word.CRITICAL]),
    ],
)
def test_an_energy_that_varies_decides_whole_cells(force: str, words: list[Word]) -> None:
    found = exact_map(mbsym.loads(OSCILLATOR.replace("FORCE", force)), [axis("s", -1, 1)], {"p": Fraction(0)})
    cells = [found.at(Fraction(s)) for s in (Fraction(-1, 2), 0, Fraction(1, 2))]
    assert [None if cell is None else cell.word for cell in cells] == words


@pytest.mark.parametrize("force", DECIDED)
def test_terms_of_higher_order_are_asked_at_samples(force: str) -> None:
    """Word by word what a run says at the sample; of the cell around it nothing more is said than before."""
    along, given, words = DECIDED[force]
    found = exact_map(mbsym.loads(OSCILLATOR.replace("FORCE", force)), [along], given)
    further = [one for one in found.cells if one.nonlinear is not None]
    assert {one.nonlinear.word for one in further if one.nonlinear is not None} == words
    assert all(one.word is not None and (one.word.open or one.word is Word.STABLE) for one in further)
    assert any("at the exact point alone" in text for text in remarks(found))
    data = json.loads(map_json(mbsym.loads(OSCILLATOR.replace("FORCE", force)).system, found))
    assert list(Draft202012Validator(schema("map")).iter_errors(data)) == []
    told = {x["nonlinear"]["verdict"] for x in (*data["regions"], *data["corners"]) if "nonlinear" in x}
    assert told == {word.value for word in words}
