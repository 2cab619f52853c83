"""Planes of systems whose matrices hold sines and roots of the axes, against conditions by hand."""

from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path
from random import Random

import pytest
from click.testing import Result
from conftest import filed, invoked

import mbsym
from mbsym.maps.boxes import BoxMap, Method, box_map
from mbsym.maps.result import Lack, Of
from mbsym.maps.section import Axis, Fault, Unfit
from mbsym.problems.stability.words import Word

TEXT = """mbsym: 1
name: plane
parameters: {{a: {{sign: {sign}}}, b: {{sign: real}}, c: {{sign: real}}}}
linear system:
  coordinates: [x, y]
  D: [[1, 0], [0, 1]]
  K: {stiffness}
"""


def described(folder: Path, stiffness: str, sign: str = "real") -> Path:
    return filed(folder / "system.yaml", TEXT.format(stiffness=stiffness, sign=sign))


def mapped(path: Path, low: int, high: int, depth: int = 8, of: Of = Of.STABILITY) -> BoxMap:
    axes = [Axis("a", Fraction(low), Fraction(high)), Axis("b", Fraction(-1), Fraction(1))]
    return box_map(mbsym.load(path), axes, {}, of, depth=depth)


def called(path: Path, *words: str, code: int | None = None) -> Result:
    return invoked("map", path, *words, "--out", path.parent / "out", code=code)


def test_sines_of_the_axes(tmp_path: Path) -> None:
    """D = 1, K = [[cos a + b, sin b], [sin b, 1]]: asymptotically stable where cos a + b > sin(b)^2, else unstable."""
    found = mapped(described(tmp_path, "[[cos(a) + b, sin(b)], [sin(b), 1]]"), -3, 3)
    assert found.method is Method.ENCLOSURES
    assert "cos(a), sin(b)" in found.because
    assert found.check is not None
    assert found.check.holds
    assert found.check.points > 100
    assert float(found.subdivision.white) < 0.4
    random, words = Random(1), set()
    for tile in found.subdivision.tiles:
        if tile.proved is None:
            continue
        words.add(tile.proved.word)
        for _ in range(5):
            a = random.uniform(float(tile.box.x0), float(tile.box.x1))
            b = random.uniform(float(tile.box.y0), float(tile.box.y1))
            margin = math.cos(a) + b - math.sin(b) ** 2
            assert tile.proved.word is (Word.ASYMPTOTIC if margin > 0 else Word.UNSTABLE)
    assert words == {Word.ASYMPTOTIC, Word.UNSTABLE}


def test_roots_that_are_not_real_are_no_statement(tmp_path: Path) -> None:
    """K = diag(sqrt(a) - 1/2, 1): unstable for 0 <= a < 1/4, stable beyond, and nothing is said for a < 0."""
    found = mapped(described(tmp_path, "[[sqrt(a) - 1/2, 0], [0, 1]]"), -1, 1)
    for tile in found.subdivision.tiles:
        if tile.box.x0 < 0:
            assert tile.proved is None
        elif tile.proved is not None:
            assert tile.proved.word is (Word.ASYMPTOTIC if float(tile.box.x0) >= 0.25 else Word.UNSTABLE)
    assert any(tile.proved is not None for tile in found.subdivision.tiles)


def test_declared_signs_are_kept(tmp_path: Path) -> None:
    found = mapped(described(tmp_path, "[[exp(a) + b, 0], [0, 1]]", "positive"), -1, 1)
    outside = [tile for tile in found.subdivision.tiles if tile.proved and tile.proved.lack is Lack.OUTSIDE]
    assert outside
    assert all(tile.box.x1 <= 0 for tile in outside)
    assert all(tile.proved is None or tile.box.x1 <= 0 or tile.box.x0 >= 0 for tile in found.subdivision.tiles)


def test_a_wrong_enclosure_is_caught(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Boxes that are enclosed as if they were their lower left quarter are called what they are not everywhere."""
    from mbsym.algebra.plane import Box
    from mbsym.maps import boxes

    plain = boxes.IrrationalSection.verdict

    def shrunk(self: boxes.IrrationalSection, box: Box) -> object:
        small = Box(box.x0, (63 * box.x0 + box.x1) / 64, box.y0, (63 * box.y0 + box.y1) / 64)
        return plain(self, small)

    monkeypatch.setattr(boxes.IrrationalSection, "verdict", shrunk)
    found = mapped(described(tmp_path, "[[cos(a) + b, sin(b)], [sin(b), 1]]"), -3, 3)
    assert found.check is not None
    assert not found.check.holds
    assert all(one.judged is None for one in found.cells)


def test_the_command_and_what_it_refuses(tmp_path: Path) -> None:
    path = described(tmp_path, "[[cos(a) + b, 0], [0, 1]]")
    done = called(path, "--x", "a=-1:1", "--y", "b=-1:1", "--format", "json", code=0)
    assert "the matrices hold what is no fraction of polynomials: cos(a); boxes instead" in done.output
    for words in (["--x", "a=-1:1"], ["--x", "a=-1:1", "--y", "b=-1:1", "--of", "signature"]):
        done = called(path, *words, code=2)
        assert "no rational number" in done.output
    done = called(described(tmp_path, "[[cos(a) + b*c, 0], [0, 1]]"), "--x", "a=-1:1", "--y", "b=-1:1", code=2)
    with pytest.raises(Unfit) as failure:
        mapped(path, -1, 1)
    assert [(one.fault, one.name) for one in failure.value.complaints] == [(Fault.MISSING, "c")]
