"""``mbsym map``: regions, arcs and corners with their verdicts, located points, files, complaints."""

from __future__ import annotations

import csv
import json
import subprocess
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import pytest
from click.testing import Result
from conftest import SHIPPED, derived, filed, invoked
from flint import fmpq, fmpq_mat
from jsonschema import Draft202012Validator

import mbsym
from mbsym.algebra.roots import count_roots
from mbsym.maps.boundaries import Origin
from mbsym.maps.mapping import exact_map
from mbsym.maps.result import Lack, Map
from mbsym.maps.section import Axis
from mbsym.maps.verdicts import Border
from mbsym.problems.stability.words import Word
from mbsym.report.language import Language
from mbsym.report.maps.located import Locating
from mbsym.report.messages import messages
from mbsym.report.schemas import schema
from tests.conftest import needs_pdflatex
from tests.report.readers import read_latex

SATELLITE = ("satellite", (("alpha", -1, 1), ("gamma", 0, 1)), (("p1", "2/5"), ("p2", "1/5")))
RIGID = ("gravity-gradient", (("A", 0, 2), ("B", 0, 2)), (("C", "1"),))
FOLLOWER = ("ziegler-damped", (("P", 0, 4), ("b1", 0, 1)), ())


@cache
def mapped(name: str, axes: tuple[Any, ...], settings: tuple[Any, ...] = ()) -> Map:
    listed = [Axis(axis, Fraction(low), Fraction(high)) for axis, low, high in axes]
    return exact_map(derived(SHIPPED / f"{name}.yaml"), listed, {k: Fraction(v) for k, v in settings})


def at(found: Map, x: Any, y: Any) -> Any:
    return found.at(Fraction(x), Fraction(y))


# --- against independent models ---------------------------------------------------------------------------------------


def paper_matrices(alpha: Fraction, gamma: Fraction, p1: Fraction, p2: Fraction) -> list[tuple[Any, Any, Any]]:
    """(M, G, K) of Banshchikov & Vetrov's eq. (3) with c = 1, omega0 = 1; a, b, d, f from alpha, gamma, p1, p2.

    alpha = (c - b)/a, gamma = (b - a)/c: a = (1 - gamma)/(1 + alpha), b = a + gamma; f = p2, d = p1 p2.
    """
    a = (1 - gamma) / (1 + alpha)
    b, c, f, d = a + gamma, Fraction(1), p2, p1 * p2
    pitch = ([[c, f], [f, d]], [[0, 0], [0, 0]], [[3 * (b - a), 3 * f], [3 * f, 3 * f]])
    g = c - b - a
    yaw = (
        [[a, 0, 0], [0, b, f], [0, f, d]],
        [[0, g, 0], [-g, 0, 0], [0, 0, 0]],
        [[c - b, 0, 0], [0, 4 * (c - a), 4 * f], [0, 4 * f, 3 * f + d]],
    )
    return [pitch, yaw]


def matrix(rows: Any) -> Any:
    return fmpq_mat([[fmpq(Fraction(x).numerator, Fraction(x).denominator) for x in row] for row in rows])


def roots_to_the_right(m: Any, g: Any, k: Any) -> tuple[int, bool]:
    """(roots with Re > 0, M > 0) of M q'' + G q' + K q = 0, from the first-order matrix."""
    m, g, k = matrix(m), matrix(g), matrix(k)
    n = m.nrows()
    inverse = m.inv()
    first = fmpq_mat(2 * n, 2 * n)
    for i in range(n):
        first[i, n + i] = 1
        for j in range(n):
            first[n + i, j], first[n + i, n + j] = -(inverse * k)[i, j], -(inverse * g)[i, j]
    positive = all(fmpq_mat(s, s, [m[i, j] for i in range(s) for j in range(s)]).det() > 0 for s in range(1, n + 1))
    return count_roots(first.charpoly().coeffs()).right, positive


@pytest.mark.parametrize(("p1", "p2"), [("2/5", "1/5"), ("3/5", "1/3")])
def test_the_satellites_map_agrees_with_eigenvalues_of_the_papers_matrices(p1: str, p2: str) -> None:
    found = mapped(SATELLITE[0], SATELLITE[1], (("p1", p1), ("p2", p2)))
    random, seen = Random(20), set()
    for _ in range(150):
        alpha, gamma = Fraction(random.randint(-999, 999), 1000), Fraction(random.randint(1, 999), 1000)
        cell = at(found, alpha, gamma)
        counted = [roots_to_the_right(*one) for one in paper_matrices(alpha, gamma, Fraction(p1), Fraction(p2))]
        if not all(positive for _, positive in counted):
            assert cell.lack is Lack.MASSLESS
            continue
        right = sum(count for count, _ in counted)
        assert cell.judged is not None
        assert cell.judged.right == right
        assert (cell.word is Word.UNSTABLE) == (right > 0)
        seen.add(cell.word)
    assert seen >= {Word.STABLE, Word.UNSTABLE}


def test_lagranges_and_debra_and_delps_regions() -> None:
    """One region each; K is definite in Lagrange's, and has two negative eigenvalues in DeBra & Delp's.

    Verdicts are given exactly where the moments keep the triangle inequalities.
    """
    found = mapped(*RIGID)
    stable = [one for one in found.regions if one.word is Word.STABLE]
    debra_delp = [one for one in found.regions if one.word is Word.GYROSCOPIC]
    assert len(stable) == len(debra_delp) == 1
    assert all(one.judged is not None and one.judged.degree == 2 for one in debra_delp)
    for one in found.regions:
        a, b = found.arrangement.regions[one.number].sample
        triangle = a + b >= 1 and b + 1 >= a and 1 + a >= b
        assert (one.lack is None) == triangle


# --- curves and corners -----------------------------------------------------------------------------------------------


def test_arcs_and_corners_are_judged_where_they_are() -> None:
    """On alpha = 0 a root is zero; on the discriminant a pair coincides, with a Jordan block; both exactly."""
    found = mapped(*SATELLITE)
    kinds: dict[Origin, set[Border | None]] = {}
    for one, arc in zip(found.arcs, found.arrangement.arcs, strict=True):
        for k in arc.factors:
            for condition in found.boundaries.conditions[k]:
                if one.judged is not None and found.separates(one):
                    kinds.setdefault(condition.origin, set()).add(one.judged.border)
    assert kinds[Origin.CONSTANT] == {Border.ZERO}
    assert Border.JORDAN in kinds[Origin.DISCRIMINANT]
    on_axis = at(found, 0, "1/2")
    assert on_axis.shape == "arc"
    assert on_axis.word is Word.UNDECIDED
    crossing = at(found, 0, "1/5")
    assert crossing.shape == "corner"
    assert crossing.judged.border is Border.ZERO


def test_every_place_has_a_verdict_or_a_reason() -> None:
    for found in (mapped(*SATELLITE), mapped(*RIGID), mapped(*FOLLOWER)):
        assert len(found.regions) == len(found.arrangement.regions)
        assert len(found.arcs) == len(found.arrangement.arcs)
        assert len(found.corners) == len(found.arrangement.corners)
        assert all((one.judged is None) != (one.lack is None) for one in found.cells)
        assert not any(one.lack in (Lack.TOO_LARGE, Lack.NOT_REACHED) for one in found.cells)
        assert abs(sum(area for area, _ in found.areas) - float(found.arrangement.box.area)) < 1e-6


def test_flutter_of_the_damped_follower_force_begins_at_41_28ths() -> None:
    """Ziegler's paradox: with b1 = b2 = b it begins at P l/k = 41/28 + b^2/2 (the file's head, from the literature)."""
    found = mapped("ziegler-damped", (("P", 0, 4), ("b1", 0, 1)), (("b2", "1/10"),))
    border = Fraction(41, 28) + Fraction(1, 200)
    beside = Fraction(1, 10**9)
    assert at(found, border - beside, "1/10").word is Word.ASYMPTOTIC
    on = at(found, border, "1/10")
    assert on.shape == "arc"
    assert on.judged.border is Border.IMAGINARY
    over = at(found, border + beside, "1/10")
    assert (over.word, over.judged.right, over.judged.real_right) == (Word.UNSTABLE, 2, 0)


def test_a_lost_boundary_is_found_and_its_verdicts_are_withdrawn(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Without the Hurwitz minor of the follower force one region has two verdicts: the check finds it."""
    from mbsym.maps import mapping

    whole = mapping.boundaries

    def lossy(*arguments: Any) -> Any:
        found = whole(*arguments)
        kept = [k for k, x in enumerate(found.conditions) if all(one.origin is not Origin.HURWITZ for one in x)]
        assert len(kept) < len(found.factors)
        factors, conditions = (tuple(x[k] for k in kept) for x in (found.factors, found.conditions))
        return replace(found, factors=factors, conditions=conditions)

    monkeypatch.setattr(mapping, "boundaries", lossy)
    done = called("systems/ziegler-damped.yaml", "--x", "P=0:4", "--y", "b1=0:1", "--format", "json", "--out", tmp_path)
    assert done.exit_code == 1
    assert "the map's own check fails in region" in done.stderr
    content = json.loads((tmp_path / "map.json").read_text())
    assert not list(Draft202012Validator(schema("map")).iter_errors(content))
    assert any(x["standing"] == Lack.WITHDRAWN for x in content["regions"])
    assert all(x["stability"] is None for x in content["regions"] if x["standing"] == Lack.WITHDRAWN)


def test_ctrl_c_keeps_what_is_proved() -> None:
    """Interrupted at the sixth verdict: five are there, the rest says that it was not reached."""
    analysis = derived(SHIPPED / "ziegler-damped.yaml")

    def watch(what: str, done: int, whole: int) -> None:
        if what == "verdicts" and done == 5:
            raise KeyboardInterrupt

    axes = [Axis("P", Fraction(0), Fraction(4)), Axis("b1", Fraction(0), Fraction(1))]
    found = exact_map(analysis, axes, {}, watch=watch)
    assert found.interrupted
    assert [one.lack is Lack.NOT_REACHED for one in found.cells][:6] == [False] * 5 + [True]
    assert found.check is None


# --- the command ------------------------------------------------------------------------------------------------------


def called(*words: object, code: int | None = None) -> Result:
    return invoked("map", *words, code=code)


WORDS_OF_SATELLITE = ("systems/satellite.yaml", "--x", "alpha=-1:1", "--y", "gamma=0:1", "-s", "p1=2/5", "-s", "p2=1/5")


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder: Path = tmp_path_factory.mktemp("map")
    points = filed(folder / "points.csv", "name,gamma,alpha\none,0.5,1/2\ntwo,1/2,0\nthree,0.2,0\nfour,3,0\n")
    done = called(*WORDS_OF_SATELLITE, "--out", folder, "--locate", points, code=0)
    assert "Lagrange-Dirichlet, Routh" in done.stdout
    return folder


def test_the_files_of_a_map(written: Path) -> None:
    names = {"map.svg", "map.pdf", "map.png", "map.json", "map.tex", "located.csv"}
    assert {x.name for x in written.iterdir()} >= names
    content = json.loads((written / "map.json").read_text())
    assert not list(Draft202012Validator(schema("map")).iter_errors(content))
    assert list(Draft202012Validator(schema("map")).iter_errors(content | {"interupted": True}))
    assert [x["name"] for x in content["axes"]] == ["alpha", "gamma"]
    assert content["values"] == {"p1": "2/5", "p2": "1/5"}
    text = (written / "map.tex").read_text()
    assert r"\includegraphics[width=\columnwidth]{map.pdf}" in text
    assert r"13 \alpha + 17 \gamma - 4 = 0$ \quad (zero root: constant term ($\psi$, $\varphi$, $\sigma$))" in text
    assert text.count("{") == text.count("}")


@needs_pdflatex
def test_the_tex_of_a_map_compiles(written: Path, tmp_path: Path) -> None:
    """With graphicx alone, into somebody else's document, which stands in another folder."""
    read_latex("fragments/map.tex", (written / "map.tex").read_text())
    head = r"\documentclass[twocolumn]{article}\usepackage{graphicx}\graphicspath{{maps/}}\begin{document}"
    (tmp_path / "paper.tex").write_text(head + r"\input{maps/map.tex}\end{document}")
    (tmp_path / "maps").mkdir()
    for name in ("map.tex", "map.pdf"):
        (tmp_path / "maps" / name).write_bytes((written / name).read_bytes())
    words = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "paper.tex"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stdout[-2000:]


def test_located_points(written: Path) -> None:
    rows = list(csv.DictReader((written / "located.csv").open()))
    assert list(rows[0]) == ["name", "gamma", "alpha", "where", "verdict", "border"]
    assert [row["verdict"] for row in rows] == ["stable", "undecided", "undecided", ""]
    assert [row["where"].split()[0] for row in rows] == ["region", "arc", "corner", "outside"]
    found = mapped(*SATELLITE)
    assert Locating(found)(Fraction(1, 2), Fraction(1, 2)) == (rows[0]["where"], "stable")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--x", "alpa=0:1", "--y", "gamma=0:1"), ["there is no parameter called 'alpa'"]),
        (("--x", "alpha=1:0", "--y", "gamma=0:0"), ["the interval from 1 to 0 is empty", "from 0 to 0 is empty"]),
        (("--x", "alpha=0:1", "--y", "alpha=0:1", "-s", "p1=1"), ["'alpha' is taken for two axes"]),
        (("--x", "alpha=0:1", "--y", "gamma=0:1", "-s", "alpha=1"), ["'alpha' has an interval and a number"]),
        (("--x", "alpha=0:1", "--y", "gamma=0:1"), ["no number for p2, p1"]),
        (("--x", "alpha=0:1", "--y", "nu=0:1", "-s", "p1=x"), ["a rational number is wanted"]),
        (("--x", "R=1:2", "--y", "nu=0:1"), ["nu follows from other parameters: nu = omega0**2*R**3"]),
        (("--x", "alpha", "--y", "gamma=0:1:2"), ["'alpha' gives no interval", "'gamma=0:1:2' gives no interval"]),
        (
            ("--x", "alpha=0:1", "--y", "gamma=0:1", "--of", "foo", "--format", "gif"),
            ["no map 'foo'", "no format 'gif'"],
        ),
        (("--x", "alpha=2:3", "--y", "gamma=0:1", "-s", "p1=-1", "-s", "p2=1"), ["p1 > 0"]),
    ],
)
def test_what_is_wrong_is_said_at_once(words: tuple[str, ...], said: list[str], tmp_path: Path) -> None:
    done = called("systems/satellite.yaml", *words, "--out", tmp_path / "out", code=2)
    for piece in said:
        assert piece in done.stderr
    assert not (tmp_path / "out").exists()


def test_wrong_points_are_told_line_by_line(tmp_path: Path) -> None:
    points = filed(tmp_path / "points.csv", "alpha,gamma\n1,x\n1\n1/0,1e9999\n")
    done = called(*WORDS_OF_SATELLITE, "--out", tmp_path / "out", "--locate", points, code=2)
    assert ":2: " in done.stderr
    assert ":3: " in done.stderr
    assert done.stderr.count(":4: ") == 2
    assert not (tmp_path / "out").exists()
    points.write_text("alpha,where\n")
    done = called(*WORDS_OF_SATELLITE, "--out", tmp_path / "out", "--locate", points)
    assert "there is no column 'gamma'" in done.stderr
    assert "the column 'where' would be written a second time" in done.stderr


# --- words ------------------------------------------------------------------------------------------------------------


def test_the_words_of_a_map_are_there_in_every_language() -> None:
    wanted = {one.told for one in (*Lack, *Origin)}
    for name in ("ru", "es"):
        assert {("", text) for text in wanted} <= set(messages(name)), name
        assert Language(name).say(Word.STABLE) != Word.STABLE


def test_one_moment_of_inertia_alone_is_that_of_plane_motion() -> None:
    """The snakeboard's bodies have a moment about the vertical only: no triangle inequality is asked of them."""
    found = exact_map(mbsym.load("systems/snakeboard.yaml"), [Axis("m", Fraction(1), Fraction(2))], {})
    assert all(one.lack is None for one in found.regions)
    assert not found.admissibility.left_out
