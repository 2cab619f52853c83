"""``mbsym map`` in boxes: asked for, as a fallback, interrupted, by enclosures; every statement against exact ones."""

from __future__ import annotations

import csv
import json
from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from click.testing import Result
from conftest import invoked
from flint import fmpq
from jsonschema import Draft202012Validator

import mbsym
from mbsym.algebra.failures import Limit, TooLargeError
from mbsym.maps import boxes
from mbsym.maps.boxes import BoxMap, Method, box_map
from mbsym.maps.mapping import Judge
from mbsym.maps.result import Lack, Of
from mbsym.maps.section import Axis
from mbsym.maps.subdivision import ByBoundaries, End
from mbsym.problems.stability.words import Word
from mbsym.report.language import Language
from mbsym.report.schemas import schema
from tests.report.readers import read_latex

LINEAR = """mbsym: 1
name: plane
parameters: {{a: {{sign: {sign}}}, b: {{sign: real}}}}
linear system:
  coordinates: [{coordinates}]
  {damping}
  K: {stiffness}
"""

#: Three coordinates with full matrices: the discriminant in lambda is of degree 30 in a and b.
K3 = "[[a, b, 1 + a], [b, 2 - a, a - b], [1 + a, a - b, b + 3]]"
D3 = "D: [[1 + b, a, b], [a, 2 + a, 1 - b], [b, 1 - b, a]]"


def described(folder: Path, stiffness: str, damping: str = "", sign: str = "real") -> Path:
    path = folder / "system.yaml"
    count = stiffness.count("[") - 1
    coordinates = ", ".join("xyz"[:count])
    path.write_text(LINEAR.format(sign=sign, coordinates=coordinates, stiffness=stiffness, damping=damping))
    return path


def mapped(path: Path, low: int = -1, high: int = 1, **further: Any) -> BoxMap:
    axes = [Axis(name, Fraction(low), Fraction(high)) for name in "ab"]
    return box_map(mbsym.load(path), axes, {}, **further)


def called(path: Path, *words: object, code: int | None = None) -> Result:
    fixed = ["map", str(path), "--x", "a=-1:1", "--y", "b=-1:1", "--out", str(path.parent / "out")]
    return invoked(*fixed, *words, code=code)


def test_what_is_proved_is_true_and_the_rest_is_white(tmp_path: Path) -> None:
    """K = diag(a, b), no damping: no root to the right for a, b > 0, as many as there are negative ones elsewhere.

    Halved 8 times, of 16 x 16 boxes those are white that touch a = 0 or b = 0: 2 * 32 - 4 = 60.
    """
    found = mapped(described(tmp_path, "[[a, 0], [0, b]]"), depth=8)
    assert found.method is Method.BOUNDARIES
    assert found.subdivision.end is End.DONE
    assert found.subdivision.white == fmpq(60, 256)
    for tile in found.subdivision.tiles:
        box = tile.box
        if tile.proved is not None:
            assert tile.proved.word is (Word.STABLE if box.x0 > 0 and box.y0 > 0 else Word.UNSTABLE)
            assert tile.proved.judged is not None
            assert tile.proved.judged.right == (box.x0 < 0) + (box.y0 < 0)
    assert found.check is not None
    assert found.check.holds


def test_a_lost_boundary_is_caught(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without 3 a = 1 boxes across it are called what their centre is; another point tells, and all verdicts fall."""
    path = described(tmp_path, "[[3*a - 1, 0], [0, b]]")

    class Forgetful(ByBoundaries[Any]):
        def __init__(self, factors: Any, judge: Any) -> None:
            super().__init__([p for p in factors if p.degrees()[0] == 0], judge)

    monkeypatch.setattr(boxes, "ByBoundaries", Forgetful)
    found = mapped(path, depth=8)
    assert found.check is not None
    assert not found.check.holds
    assert {one.lack for one in found.cells} <= {Lack.WITHDRAWN, Lack.UNPROVED}
    assert Lack.WITHDRAWN in {one.lack for one in found.cells}
    done = called(path, "--by", "boxes", "--format", "json", code=1)
    assert "withdrawn, as the map's own check fails in box" in done.output


def test_an_arrangement_that_is_too_large_becomes_boxes(tmp_path: Path) -> None:
    """The command says why, exits with 0, and what it writes agrees with NumPy's eigenvalues at random points."""
    path = described(tmp_path, K3, D3)
    points = tmp_path / "points.csv"
    random = Random(5)
    rows = [(random.randint(-999, 999) / 1000, random.randint(-999, 999) / 1000) for _ in range(200)]
    points.write_text("a,b\n" + "".join(f"{a},{b}\n" for a, b in [*rows, (2, 0)]))
    done = called(path, "--locate", points, "--format", "json,tex", code=0)
    assert "no exact regions: a resultant of degree up to" in done.output
    assert "boxes instead" in done.output
    data = json.loads((tmp_path / "out" / "map.json").read_text())
    Draft202012Validator(schema("map")).validate(data)
    assert data["subdivision"]["because"].startswith("a resultant of degree")
    assert 0 < Fraction(data["subdivision"]["white"]) < 1
    with (tmp_path / "out" / "located.csv").open() as file:
        found = list(csv.DictReader(file))
    assert found[-1]["where"] == "outside of the box"
    told = 0
    for (a, b), row in zip(rows, found[:-1], strict=True):
        if row["where"] == "white box":
            assert row["verdict"] == "nothing is proved"
            continue
        k = np.array([[a, b, 1 + a], [b, 2 - a, a - b], [1 + a, a - b, b + 3]])
        d = np.array([[1 + b, a, b], [a, 2 + a, 1 - b], [b, 1 - b, a]])
        right = np.linalg.eigvals(np.block([[np.zeros((3, 3)), np.eye(3)], [-k, -d]])).real.max()
        assert (row["verdict"] == "unstable") == (right > 0)
        told += 1
    assert told > 40


def test_ctrl_c_keeps_the_boxes_that_are_proved(tmp_path: Path) -> None:
    path = described(tmp_path, "[[a, 0], [0, b]]")

    def watch(word: str, done: int, whole: int) -> None:
        if word == "boxes" and done > 60:
            raise KeyboardInterrupt

    found = mapped(path, watch=watch)
    assert found.interrupted
    assert found.check is None
    assert 0 < found.subdivision.white < 1
    assert sum(tile.box.area for tile in found.subdivision.tiles) == 4
    assert any(one.word is Word.STABLE for one in found.cells)


def test_enclosures_where_boundaries_are_too_large(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Then verdicts may say less: a is declared positive, K = diag(a, b), and D = 1 makes it asymptotically stable."""

    def refused(*_: object) -> None:
        raise TooLargeError("a determinant of many terms", limit=Limit.TERMS)

    monkeypatch.setattr(boxes, "bounded", refused)
    path = described(tmp_path, "[[a, 0], [0, b]]", "D: [[1, 0], [0, 1]]", sign="positive")
    found = mapped(path, depth=8)
    assert found.method is Method.ENCLOSURES
    assert found.because == "a determinant of many terms"
    for tile in found.subdivision.tiles:
        box, proved = tile.box, tile.proved
        if proved is None:
            assert box.x0 <= 0 <= box.x1 or box.y0 <= 0 <= box.y1
        elif box.x1 < 0:
            assert proved.lack is Lack.OUTSIDE
        else:
            assert proved.word is (Word.ASYMPTOTIC if box.y0 > 0 else Word.UNSTABLE)
    with pytest.raises(TooLargeError):
        mapped(path, of=Of.SIGNATURE)
    done = called(path, "--by", "boxes", code=0)
    assert "theorems for enclosures" in done.output


@pytest.mark.parametrize("language", ["en", "ru", "es"])
def test_files_and_words(tmp_path: Path, language: str) -> None:
    called(described(tmp_path, "[[a, 0], [0, b]]"), "--by", "boxes", "--language", language, code=0)
    out = tmp_path / "out"
    assert {x.name for x in out.iterdir() if x.name[0] != "."} == {
        "map.svg",
        "map.pdf",
        "map.png",
        "map.json",
        "map.tex",
    }
    Draft202012Validator(schema("map")).validate(json.loads((out / "map.json").read_text()))
    tex = (out / "map.tex").read_text()
    read_latex("fragments/map.tex", tex)
    word = "white: nothing is proved"
    assert Language(language).say(word) in tex


def test_signature_in_boxes(tmp_path: Path) -> None:
    """K = diag(a, b): as many negative eigenvalues as a and b are negative."""
    found = mapped(described(tmp_path, "[[a, 0], [0, b]]"), depth=6, of=Of.SIGNATURE)
    for tile in found.subdivision.tiles:
        if tile.proved is not None and tile.proved.judged is not None:
            assert tile.proved.judged.degree == (tile.box.x1 < 0) + (tile.box.y1 < 0)


@pytest.mark.parametrize("words", [["--x", "a=-1:1"], ["--x", "a=-1:1", "--y", "b=-1:1", "--z", "c=0:1"]])
def test_boxes_are_of_planes(tmp_path: Path, words: list[str]) -> None:
    path = described(tmp_path, "[[a, 0], [0, b]]")
    done = invoked("map", path, *words, "--by", "boxes", "--out", tmp_path / "out", code=2)
    assert "boxes are of planes" in done.output
    assert not (tmp_path / "out").exists()


def test_files_of_an_interrupted_map_say_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C while regions are judged: what is judged stays, and the files call themselves incomplete."""
    path, calls = described(tmp_path, "[[a, 0], [0, b]]"), []

    def once(self: Any, *rest: Any) -> Any:
        calls.append(rest)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return plain(self, *rest)

    plain = Judge.__call__
    monkeypatch.setattr(Judge, "__call__", once)
    done = called(path, code=130)
    assert "interrupted; what was proved before that is written" in done.output
    data = json.loads((tmp_path / "out" / "map.json").read_text())
    assert data["interrupted"]
    assert data["check"] is None
    assert [one["standing"] for one in data["regions"]] == ["judged"] * 2 + ["not reached"] * 2
    assert "Interrupted: incomplete and not checked" in (tmp_path / "out" / "map.tex").read_text()
