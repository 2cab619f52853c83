"""Maps of what is degenerate: by hand, x'' + K x = 0 and x'' + D x' + K x = 0 with few entries."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from random import Random

import numpy as np
import pytest
from click.testing import Result
from conftest import filed, invoked

import mbsym
from mbsym.algebra.rationals import fraction
from mbsym.maps.mapping import exact_map
from mbsym.maps.result import Map, Of, Shape
from mbsym.maps.section import Axis
from mbsym.maps.verdicts import Border
from mbsym.problems.stability.words import Word
from mbsym.report.maps.located import Locating
from mbsym.studies.map.answer import remarks

HEAD = "mbsym: 1\nname: {}\nparameters: {{a: {{sign: real}}, b: {{sign: real}}}}\nlinear system:\n  coordinates: [x]\n"


def described(folder: Path, stiffness: str, damping: str = "") -> Path:
    path = folder / "system.yaml"
    damped = f"  D: [[{damping}]]\n" if damping else ""
    path.write_text(HEAD.format(folder.name) + damped + f"  K: [[{stiffness}]]\n")
    return path


def mapped(path: Path) -> Map:
    return exact_map(mbsym.load(path), [Axis(name, Fraction(-1), Fraction(1)) for name in "ab"], {})


def called(path: Path) -> Result:
    words = ["map", str(path), "--x", "a=-1:1", "--y", "b=-1:1", "--format", "json,png", "--out", str(path.parent)]
    return invoked(*words)


def test_an_isolated_point(tmp_path: Path) -> None:
    """K = a^2 + b^2 vanishes at one point, a zero root there and imaginary ones everywhere else."""
    found = mapped(described(tmp_path, "a**2 + b**2"))
    assert len(found.regions) == 1
    assert found.regions[0].judged is not None
    assert found.regions[0].judged.right == 0
    point = found.at(Fraction(0), Fraction(0))
    assert point is not None
    assert point.shape is Shape.CORNER
    assert point.judged is not None
    assert point.judged.border is Border.ZERO


def test_a_double_line(tmp_path: Path) -> None:
    """K = (a - b)^2: the same on both sides of a = b, a zero root on it."""
    found = mapped(described(tmp_path, "(a - b)**2"))
    assert len(found.regions) == 2
    assert len({found.look(one) for one in found.regions}) == 1
    on = found.at(Fraction(1, 3), Fraction(1, 3))
    assert on is not None
    assert on.shape is Shape.ARC
    assert on.judged is not None
    assert on.judged.border is Border.ZERO
    assert found.singles_out(on)
    assert not found.separates(on)


def test_a_condition_that_is_an_equality_everywhere(tmp_path: Path) -> None:
    """x'' + x' = 0 has a simple zero root for all a and b: stable everywhere, and nothing depends on the axes."""
    path = described(tmp_path, "0", "1")
    found = mapped(path)
    assert [one.word for one in found.regions] == ["stable"]
    done = called(path)
    assert done.exit_code == 0, done.output
    assert "no condition of stability depends on the axes" in done.stdout


def test_no_point_is_admissible(tmp_path: Path) -> None:
    path = described(tmp_path, "a + b + 10")
    path.write_text(path.read_text() + "assumptions: [a + b > 5]\n")
    done = called(path)
    assert done.exit_code == 0, done.output
    assert "no verdict anywhere" in done.stdout


def test_curves_that_do_not_meet_the_plane_leave_one_region(tmp_path: Path) -> None:
    """K = a + b + 10 > 0 there."""
    found = mapped(described(tmp_path, "a + b + 10"))
    assert len(found.regions) == 1
    assert abs(found.areas[0][0] - 4) < 1e-9


def test_where_a_squared_determinant_vanishes_the_other_roots_are_looked_at(tmp_path: Path) -> None:
    """K = [[b + 1, -2a], [-2a, 0]]: det K = -4a^2; on a = 0 K is diag(b + 1, 0), so b = -1 parts that line.

    Below it lambda^2 = -(b + 1) > 0: one root to the right; above it roots are imaginary and zero, twice: y = c t.
    """
    path = filed(
        tmp_path / "system.yaml", HEAD.format("squared").replace("[x]", "[x, y]") + "  K: [[b+1, -2*a], [-2*a, 0]]\n"
    )
    found = exact_map(
        mbsym.load(path), [Axis("a", Fraction(-2), Fraction(2)), Axis("b", Fraction(-2), Fraction(2))], {}
    )
    below, above = (found.at(Fraction(0), b) for b in (Fraction(-3, 2), Fraction(1, 2)))
    assert below is not None
    assert above is not None
    assert below.judged is not None
    assert above.judged is not None
    assert (below.judged.right, below.judged.degree) == (1, 1)
    assert below.word == "unstable"
    assert (above.judged.right, above.judged.degree) == (0, 0)
    assert above.word == "unstable"
    corner = found.at(Fraction(0), Fraction(-1))
    assert corner is not None
    assert corner.shape is Shape.CORNER


def test_two_damped_coordinates_with_a_discriminant_of_degree_17(tmp_path: Path) -> None:
    """Greatest common divisors over fields of degree 22 made this run for minutes; counts at a third point of each
    region are those of NumPy's eigenvalues, where these are not near the axis."""
    rows = "[[-a+2*b+1, a-2*b-b**2], [a-2*b-b**2, 0]]"
    path = filed(
        tmp_path / "system.yaml",
        "mbsym: 1\nname: plane\nparameters: {a: {sign: real}, b: {sign: real}}\nlinear system:\n"
        f"  coordinates: [x, y]\n  M: [[1, 0], [0, 1]]\n  D: {rows}\n  K: [[a+b, 0], [0, -b-1]]\n",
    )
    found = exact_map(mbsym.load(path), [Axis(name, Fraction(-2), Fraction(2)) for name in "ab"], {})
    assert found.check is not None
    assert found.check.holds
    assert all(one.judged is not None for one in (*found.regions, *found.arcs))
    random, told = Random(3), 0
    for _ in range(300):
        a, b = (Fraction(random.randint(-1999, 1999), 1000) for _ in "ab")
        d, k = [[-a + 2 * b + 1, a - 2 * b - b**2], [a - 2 * b - b**2, 0]], [[a + b, 0], [0, -b - 1]]
        first = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.array(k, float), -np.array(d, float)]])
        roots = np.linalg.eigvals(first).real
        if min(abs(roots)) > 1e-6:
            there = found.at(a, b)
            assert there is not None
            assert there.judged is not None
            assert there.judged.right == sum(roots > 0)
            told += 1
    assert told > 250


def test_the_signature_of_a_diagonal_stiffness(tmp_path: Path) -> None:
    """K = diag(a, b): its negative eigenvalues are the negative ones of a and b; on a = 0 or b = 0 one vanishes."""
    path = filed(
        tmp_path / "system.yaml", HEAD.format("signature").replace("[x]", "[x, y]") + "  K: [[a, 0], [0, b]]\n"
    )
    axes = [Axis(name, Fraction(-1), Fraction(1)) for name in "ab"]
    found = exact_map(mbsym.load(path), axes, {}, Of.SIGNATURE)
    for a in (Fraction(-1, 2), Fraction(0), Fraction(1, 2)):
        for b in (Fraction(-1, 3), Fraction(0), Fraction(1, 3)):
            there = found.at(a, b)
            assert there is not None
            assert there.judged is not None
            assert (there.judged.degree, there.judged.null) == ((a < 0) + (b < 0), (a == 0) + (b == 0))
    assert len({found.look(one) for one in found.regions}) == 3
    assert all(found.separates(one) or None in found.beside(one) for one in found.arcs)
    words = ["map", str(path), "--x", "a=-1:1", "--y", "b=-1:1", "--of", "signature", "--out", str(tmp_path / "out")]
    done = invoked(*words, code=0)
    for count in (0, 1, 2):
        assert f"degree of instability {count}" in done.stdout
    data = json.loads((tmp_path / "out" / "map.json").read_text())
    assert data["of"] == "signature"
    assert sorted(one["negative_eigenvalues_of_K"] for one in data["regions"]) == [0, 1, 1, 2]


def test_one_axis_is_absent_from_the_conditions(tmp_path: Path) -> None:
    """K = a: the line a = 0, whatever b is; and K = 1: one region, no line."""
    found = mapped(described(tmp_path, "a"))
    assert (len(found.regions), len(found.arcs)) == (2, 1)
    assert [one.judged and one.judged.right for one in found.regions] == [1, 0]
    found = mapped(described(tmp_path, "1"))
    assert (len(found.regions), len(found.arcs), len(found.corners)) == (1, 0, 0)
    done = called(tmp_path / "system.yaml")
    assert done.exit_code == 0, done.output
    assert "no condition of stability depends on the axes" in done.stdout


def test_a_region_without_inner_points(tmp_path: Path) -> None:
    """D = 1, K = -(a - b)^2: unstable everywhere but on a = b, where x'' + x' = 0 is stable."""
    found = mapped(described(tmp_path, "-(a - b)**2", "1"))
    assert {one.word for one in found.regions} == {"unstable"}
    on = found.at(Fraction(1, 3), Fraction(1, 3))
    assert on is not None
    assert on.word == "stable"
    assert found.singles_out(on)


def test_a_located_point_of_an_arc_is_judged_at_itself(tmp_path: Path) -> None:
    """K = a, D = 1: on a = 0 a root is zero. With another verdict planted on the arc, its points keep their own."""
    found = mapped(described(tmp_path, "a", "1"))
    own = Locating(found)(Fraction(0), Fraction(1, 3))
    planted = replace(found, arcs=tuple(replace(one, said=found.regions[1].judged) for one in found.arcs))
    assert Locating(planted)(Fraction(0), Fraction(1, 3)) == own
    assert own == ("arc 0", "stable")


QUARTIC = """mbsym: 1
name: quartic
parameters: {a: real, b: real, c: nonnegative}
bodies:
  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - potential: POTENTIAL
  - damper: {coordinate: x, coefficient: c}
motion: {x: 0}
"""


@pytest.mark.parametrize(
    ("potential", "damping", "stable"),
    [
        ("x**4", 0, lambda _a, _b: True),
        ("a*x**4 + b*x**6", 0, lambda a, _b: a > 0),
        ("a*b*x**4 + x**5", 0, lambda a, b: a * b > 0),
        ("(a**2 + b**2 - 1/2)*(1 - cos(x**2))", 0, lambda a, b: a**2 + b**2 > 1 / 2),
        ("a*b*x**4 + x**5", 1, lambda a, b: a * b > 0),
        ("x**3 + a*x**4", 0, lambda _a, _b: False),
    ],
)
def test_a_potential_of_higher_order_bounds_regions(
    potential: str, damping: int, stable: Callable[[Fraction, Fraction], bool]
) -> None:
    """V = c x^n + ...: stable where n is even and c > 0, else unstable; asymptotically if damped, x' = -V'(x)."""
    analysis = mbsym.loads(QUARTIC.replace("POTENTIAL", potential))
    axes = [Axis(name, Fraction(-1), Fraction(1)) for name in "ab"]
    found = exact_map(analysis, axes, {"c": Fraction(damping)})
    staying = Word.ASYMPTOTIC if damping else Word.STABLE
    for a in (Fraction(-5, 7), Fraction(-1, 3), Fraction(2, 7), Fraction(4, 5)):
        for b in (Fraction(-4, 5), Fraction(-1, 7), Fraction(1, 3), Fraction(6, 7)):
            there = found.at(a, b)
            assert there is not None
            assert there.word is (staying if stable(a, b) else Word.UNSTABLE)
    alone = exact_map(analysis, axes[:1], {"b": Fraction(1, 2), "c": Fraction(damping)})
    numbers = [(x.word, fraction(x.sample)) for x in alone.regions]
    assert all(word is (staying if stable(a, Fraction(1, 2)) else Word.UNSTABLE) for word, a in numbers)


def test_slices_of_it_are_alike(tmp_path: Path) -> None:
    path = filed(tmp_path / "system.yaml", QUARTIC.replace("POTENTIAL", "(a - c)*x**4 + b*x**6"))
    words = ["map", str(path), "--x", "a=-1:1", "--y", "b=-1:1", "--z", "c=1/4:1/2", "--out", str(tmp_path / "out")]
    done = invoked(*words, code=0)
    assert "undecided" not in done.stdout


def test_what_only_terms_of_higher_order_decide_is_not_denied() -> None:
    """V = a x^4 + b y^4: the first approximation knows neither, the nonlinear system depends on both."""
    text = QUARTIC.replace("x, 0, 0", "x, y, 0").replace("[x]", "[x, y]").replace("POTENTIAL", "a*x**4 + b*y**4")
    axes = [Axis(name, Fraction(-1), Fraction(1)) for name in "ab"]
    told = " ".join(remarks(exact_map(mbsym.loads(text), axes, {"c": Fraction(0)})))
    assert "terms of higher order may" in told


@pytest.mark.parametrize(("damping", "stable"), [(0, "stable"), (1, "asymptotically stable")])
def test_a_sweep_says_the_same(tmp_path: Path, damping: int, stable: str) -> None:
    """V = a x^4 + b x^6: as a run and a map say, not undecided; on the border a = 0 by the sign of b."""
    path = tmp_path / "system.yaml"
    text = QUARTIC.replace("POTENTIAL", "a*x**4 + b*x**6")
    path.write_text(text + f"values: {{a: 1, b: 1, c: {damping}}}\n")
    words = ["sweep", str(path), "--vary", "a=-1:1:5", "--vary", "b=-1:1:5", "--out", str(tmp_path / "out")]
    invoked(*words, "--format", "csv", code=0)
    rows = [row.split(",") for row in (tmp_path / "out" / "sweep.csv").read_text().splitlines()]
    a, b, verdict = (rows[0].index(name) for name in ("a", "b", "verdict"))
    first_terms = {tuple(row): float(row[a]) or float(row[b]) for row in rows[1:]}
    assert len(first_terms) == 25
    for row, first_term in first_terms.items():
        if first_term:  # x'' + c x' = 0 is another question
            assert row[verdict] == (stable if first_term > 0 else "unstable")
