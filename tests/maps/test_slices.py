"""``mbsym map --z``: slices over three parameters against surfaces and counts known by hand."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import combinations
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from click.testing import Result
from conftest import filed, invoked
from flint import fmpq
from jsonschema import Draft202012Validator

import mbsym
from mbsym.algebra.failures import TooLargeError
from mbsym.maps import slices
from mbsym.maps.result import Lack
from mbsym.maps.section import Axis
from mbsym.maps.slices import Stack, stack
from mbsym.maps.verdicts import Border
from mbsym.problems.stability.words import Word
from mbsym.report.maps.figure import page_names, panels
from mbsym.report.maps.located import Locating
from mbsym.report.schemas import schema
from tests.report.readers import read_latex

HEAD = "mbsym: 1\nname: {name}\nparameters: [{parameters}]\n"

#: x'' + p x' + q x = 0 has roots with (p, q); the surface q = x^2 + y^2 - z is a paraboloid, its slices circles.
BOWL = HEAD.format(name="bowl", parameters="x, y, z") + (
    "linear system:\n  coordinates: [s]\n  M: [[1]]\n  D: [[1]]\n  K: [[z - x**2 - y**2]]\n"
)
#: K has the eigenvalues of [[x + z, y], [y, z - x]]: z +- sqrt(x^2 + y^2), a double cone with its tip at the origin.
CONE = HEAD.format(name="cone", parameters="x, y, z") + (
    "linear system:\n  coordinates: [s, u]\n  M: [[1, 0], [0, 1]]\n  K: [[x + z, y], [y, z - x]]\n"
)
#: Two lines of the slices move with z.
STRIP = HEAD.format(name="strip", parameters="x, y, z") + (
    "linear system:\n  coordinates: [s]\n  M: [[1]]\n  D: [[1]]\n  K: [[(x - z)*({}) + 0*y]]\n"
)


def analysed(text: str, folder: Path) -> Any:
    path = filed(folder / "system.yaml", text)
    return mbsym.load(path)


def stacked(analysis: Any, axes: Any, settings: Any = ()) -> Stack:
    listed = [Axis(name, Fraction(low), Fraction(high)) for name, low, high in axes]
    return stack(analysis, listed, {k: Fraction(v) for k, v in settings})


@cache
def shipped(name: str, axes: Any, settings: Any = ()) -> Stack:
    return stacked(mbsym.load(f"systems/{name}.yaml"), axes, settings)


#: det = lambda^4 + a lambda^2 + b lambda + c: the swallowtail is its discriminant.
SWALLOWTAIL = HEAD.format(name="swallowtail", parameters="a, b, c") + (
    "linear system:\n  coordinates: [s, u]\n  M: [[1, 0], [0, 1]]\n"
    "  D: [[0, b/2], [b/2, 0]]\n  G: [[0, -b/2], [b/2, 0]]\n"
    "  K: [[0, (c - 1)/2], [(c - 1)/2, a]]\n  N: [[0, -(1 + c)/2], [(1 + c)/2, 0]]\n"
)

UNIT = (("x", -2, 2), ("y", -2, 2), ("z", -1, 1))
RIGID = ("gravity-gradient", (("A", 0, 2), ("B", 0, 2), ("C", "9/10", "11/10")))
SATELLITE = ("satellite", (("alpha", -1, 1), ("gamma", 0, 1), ("p1", "1/4", "9/10")), (("p2", "1/5"),))


# --- topology known by hand -------------------------------------------------------------------------------------------


def test_a_bowl_opens_at_its_lowest_point(tmp_path: Path) -> None:
    """K = z - x^2 - y^2 with damping: unstable everywhere for z < 0; stable in a disc for z > 0; at z = 0 a point.

    Real roots become a pair where 4 K = 1, from z = 1/4 on; dissipation is complete, and that circle bounds nothing.
    """
    found = stacked(analysed(BOWL, tmp_path), UNIT)
    assert [one.z for one in found.layers if one.critical] == [0]
    assert found.sound
    looks = [[str(one.word) for one in layer.plane.regions] for layer in found.layers if layer.plane is not None]
    assert looks[0] == looks[1] == [Word.UNSTABLE]
    assert set(looks[2]) == {Word.ASYMPTOTIC, Word.UNSTABLE}
    tip = found.layers[1].plane
    assert tip is not None
    assert [corner.kind for corner in tip.arrangement.corners] == ["isolated"]
    # at the tip K = 0: x'' + x' = 0, stable, which is not what is around it, so that it is a picture of its own
    assert [one.layers for one in found.pictures] == [(0,), (1,), (2,)]


def test_a_double_cone_closes_and_opens(tmp_path: Path) -> None:
    """K is positive definite where z > sqrt(x^2 + y^2), and has negative eigenvalues elsewhere."""
    found = stacked(analysed(CONE, tmp_path), UNIT)
    assert fmpq(0) in [one.z for one in found.layers if one.critical]
    random = Random(3)
    locate = Locating(found)
    for _ in range(60):
        x, y, z = (Fraction(random.randint(-200, 200), 201) for _ in range(3))
        where, verdict = locate(x, y, z)
        radius = x**2 + y**2
        below = 0 if z > 0 and z**2 > radius else 2 if z < 0 and z**2 > radius else 1
        assert where.startswith(("slice", "beside slice"))
        assert (verdict == Word.STABLE) == (below == 0), (x, y, z)
        assert (verdict == Word.UNSTABLE) == (below > 0)


def test_the_swallowtail(tmp_path: Path) -> None:
    """For a < 0 the discriminant curve has two cusps, at c = -a^2/12; for a > 0 none; all of it changes at a = 0.

    How many roots lie to the right, and are real, is counted from floating-point roots at random points.
    """
    found = stacked(analysed(SWALLOWTAIL, tmp_path), (("b", -1, 1), ("c", "-1/2", "1/2"), ("a", -1, "1/2")))
    assert found.sound
    assert fmpq(0) in [one.z for one in found.layers if one.critical]
    b, c, a = found.section.context.gens()
    tail = 16 * a**4 * c - 4 * a**3 * b**2 - 128 * a**2 * c**2 + 144 * a * b**2 * c - 27 * b**4 + 256 * c**3
    curve = next(k for k, p in enumerate(found.boundaries.factors) if p / p.leading_coefficient() == tail / -27)
    for layer in found.layers:
        if layer.plane is None or layer.critical:
            continue
        cusps = [
            one.point.floats()
            for one in layer.plane.arrangement.corners
            if one.kind == "singular" and one.factors == (curve,)
        ]
        assert len(cusps) == (2 if layer.z < 0 else 0)
        assert all(abs(y + float(layer.z) ** 2 / 12) < 1e-9 for _, y in cusps)
        random = Random(4)
        for _ in range(25):
            x, y = (Fraction(random.randint(-499, 499), 499 * k) for k in (1, 2))
            roots = np.roots([1, 0, float(layer.z), float(x), float(y)])
            cell = layer.plane.at(x, y)
            if min(abs(p - q) for p, q in combinations(roots, 2)) < 1e-3 or min(abs(roots.real)) < 1e-6:
                continue
            assert cell is not None
            assert cell.judged is not None
            right = [r for r in roots if r.real > 0]
            assert cell.judged.right == len(right)
            assert cell.judged.real_right == sum(abs(r.imag) < 1e-9 for r in right)


def test_a_slice_at_an_irrational_value_is_exact(tmp_path: Path) -> None:
    """K = (x - z)(x z - 2) is negative between x = z and x = 2/z, and 2^(1/2) (x - 2^(1/2))^2 where they meet."""
    found = stacked(analysed(STRIP.format("x*z - 2"), tmp_path), (("x", 1, 2), ("y", 0, 1), ("z", "5/4", "3/2")))
    assert found.sound
    at = next(one for one in found.layers if not isinstance(one.z, fmpq) and str(one.z.polynomial) == "x^2 + (-2)")
    assert at.plane is not None
    assert {one.word for one in at.plane.regions} == {Word.ASYMPTOTIC}
    on = [
        one
        for one, arc in zip(at.plane.arcs, at.plane.arrangement.arcs, strict=True)
        if one.judged is not None and one.judged.border is Border.ZERO and arc.regions.count(None) == 0
    ]
    assert [one.word for one in on] == [Word.STABLE]  # x'' + x' = 0
    assert all(at.plane.singles_out(one) for one in on)
    for side in (-1, 1):
        beside = found.layers[at.number + side].plane
        assert beside is not None
        assert Word.UNSTABLE in {one.word for one in beside.regions}
    assert any(one.layers == (at.number,) for one in found.pictures)


def test_an_irrational_value_of_a_high_degree_is_told_and_not_looked_at(tmp_path: Path) -> None:
    """The lines x = z and x = z^5 - 1 meet at the root 1.167... of z^5 - z - 1, and nowhere else between 1 and 5/4."""
    found = stacked(analysed(STRIP.format("x - z**5 + 1"), tmp_path), (("x", 1, 2), ("y", 0, 1), ("z", 1, "5/4")))
    at = next(
        one.number
        for one in found.layers
        if not isinstance(one.z, fmpq) and str(one.z.polynomial) == "x^5 + (-1)*x + (-1)"
    )
    assert found.layers[at].lack is Lack.IRRATIONAL
    assert found.layers[at].plane is None
    assert any(at in one.unseen for one in found.pictures)


# --- shipped systems --------------------------------------------------------------------------------------------------


def test_lagranges_regions_at_any_third_moment() -> None:
    """Scaling all moments changes nothing: a verdict at (a C, b C, C) is that at (a, b, 1)."""
    found = shipped(*RIGID)
    assert found.sound
    for z in ("9/10", "19/20", "1", "11/10"):
        locate = Locating(found)
        scale = Fraction(z)
        for a, b in ((Fraction(3, 4), Fraction(1, 2)), (Fraction(9, 8), Fraction(5, 4)), (Fraction(1, 4), Fraction(1))):
            own = locate(a * scale, b * scale, scale)[1]
            assert own == locate(a, b, Fraction(1))[1]


def test_random_points_of_the_satellite_agree_with_counts_of_the_papers_matrices() -> None:
    from tests.maps.test_map import paper_matrices, roots_to_the_right

    found = shipped(*SATELLITE)
    locate = Locating(found)
    random, seen = Random(11), set()
    for _ in range(40):
        alpha, gamma = Fraction(random.randint(-999, 999), 1000), Fraction(random.randint(1, 999), 1000)
        p1 = Fraction(random.randint(251, 900), 1000)
        where, verdict = locate(alpha, gamma, p1)
        counted = [roots_to_the_right(*one) for one in paper_matrices(alpha, gamma, p1, Fraction(1, 5))]
        layer = found.layers[int(where.split(",")[0].split()[-1])]
        if not all(positive for _, positive in counted):
            assert verdict == Lack.MASSLESS
        else:
            assert (verdict == Word.UNSTABLE) == (sum(count for count, _ in counted) > 0)
        if ", region " in where and layer.plane is not None:  # the slice's own region says the same
            region = layer.plane.regions[int(where.rpartition(" ")[2])]
            assert (region.lack.value if region.word is None else region.word.value) == verdict
            seen.add(verdict)
    assert len(seen) >= 3


def test_ziegler_with_vanishing_damping() -> None:
    """For b1 = b2 = b flutter begins at 41/28 + b^2/2, whatever b > 0: no slice near b2 = 0 shows the undamped 2.086.

    So all slices with b2 > 0 are one picture, and the one at b2 = 0 is outside of what the file declares.
    """
    found = shipped("ziegler-damped", (("P", 0, 4), ("b1", 0, 1), ("b2", 0, "1/5")))
    assert found.layers[0].lack is Lack.OUTSIDE
    assert found.ends(found.pictures[0])[2] == 0
    assert len(found.pictures) == 2
    locate = Locating(found)
    for b in (Fraction(1, 1000), Fraction(1, 10), Fraction(3, 20)):
        border = Fraction(41, 28) + b**2 / 2
        assert locate(border - Fraction(1, 10**6), b, b)[1] == Word.ASYMPTOTIC
        assert locate(border + Fraction(1, 10**6), b, b)[1] == Word.UNSTABLE


# --- what must be noticed ---------------------------------------------------------------------------------------------


def test_a_lost_critical_value_is_found(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Without the level z = 0 of the bowl, the second slice does not correspond to the first."""
    whole = slices.critical_levels

    def lossy(*arguments: Any, **options: Any) -> Any:
        line = whole(*arguments, **options)
        only = replace(line.intervals[0], sample=fmpq(-1, 2), ends=(None, None))
        return replace(line, intervals=(only,), zeros=())

    monkeypatch.setattr(slices, "critical_levels", lossy)
    found = stacked(analysed(BOWL, tmp_path), UNIT)
    assert not found.sound
    assert not found.layers[0].confirmed


def test_too_many_values_are_refused_before_any_slice(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(slices, "MOST_LEVELS", 1)
    with pytest.raises(TooLargeError, match=r"values of C .* more than 1") as failure:
        stacked(mbsym.load("systems/gravity-gradient.yaml"), RIGID[1])
    assert "smaller interval" in failure.value.remedy


def test_ctrl_c_keeps_the_slices_that_are_done() -> None:
    def watch(what: str, done: int, whole: int) -> None:
        if what.startswith("slice 4 of"):
            raise KeyboardInterrupt

    axes = [Axis(name, Fraction(low), Fraction(high)) for name, low, high in RIGID[1]]
    found = stack(mbsym.load("systems/gravity-gradient.yaml"), axes, {}, watch=watch)
    assert found.interrupted
    reached = [one.lack is not Lack.NOT_REACHED for one in found.layers]
    assert reached == [True] * 3 + [False] * (len(reached) - 3)
    assert any(found.layers[one.shown].lack is Lack.NOT_REACHED for one in found.pictures)


# --- the command ------------------------------------------------------------------------------------------------------


def called(*words: object, code: int | None = None) -> Result:
    return invoked("map", *words, code=code)


def test_the_files_of_slices(tmp_path: Path) -> None:
    points = filed(tmp_path / "points.csv", "C,B,A\n1,1/2,3/4\n19/20,1/2,3/4\n3,1,1\n")
    words = ("--x", "A=0:2", "--y", "B=0:2", "--z", "C=9/10:11/10", "--locate", points, "--out", tmp_path)
    called("systems/gravity-gradient.yaml", *words, "--language", "es", code=0)
    content = json.loads((tmp_path / "map.json").read_text())
    assert not list(Draft202012Validator(schema("map")).iter_errors(content))
    assert list(Draft202012Validator(schema("map")).iter_errors(content | {"slices": [{}]}))
    assert [x["name"] for x in content["axes"]] == ["A", "B", "C"]
    assert [k for x in content["pictures"] for k in x["slices"]] == list(range(len(content["slices"])))
    assert all((x["missing"] is None) == bool(x["regions"]) for x in content["slices"])
    rows = list(csv.DictReader((tmp_path / "located.csv").open()))
    assert rows[0]["where"].startswith("slice ")
    assert rows[1]["where"].startswith("beside slice ")
    assert [x["verdict"] for x in rows] == ["stable", "stable", ""]
    found = shipped(*RIGID)
    assert len(panels(found)) > 3
    for name in page_names(found):
        assert all((tmp_path / f"{name}.{kind}").exists() for kind in ("svg", "pdf", "png"))
    text = (tmp_path / "map.tex").read_text()
    assert r"9/10 \le C \le 11/10" in text
    read_latex("fragments/map.tex", text)


def test_what_does_not_fit_is_complained_of_at_once(tmp_path: Path) -> None:
    file = "systems/gravity-gradient.yaml"
    done = called(file, "--x", "A=0:2", "--z", "D=2:1", "--out", tmp_path, code=2)
    assert "--y" in done.output
    assert "no parameter called 'D'" in done.output
    assert "empty" in done.output
    done = called(file, "--x", "A=0:2", "--y", "B=0:2", "--z", "A=0:1", "--out", tmp_path, code=2)
    assert "'A' is taken for two axes" in done.output
    assert not list(tmp_path.iterdir())
