"""Maps over one parameter: exact numbers against the literature."""

from __future__ import annotations

import csv
import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from conftest import SHIPPED, derived, filed, invoked
from flint import fmpq, fmpz_poly
from jsonschema import Draft202012Validator

import mbsym
from mbsym.maps.mapping import exact_map
from mbsym.maps.result import Lack, Map
from mbsym.maps.section import Axis
from mbsym.maps.verdicts import Border
from mbsym.problems.stability.constant import constant_of
from mbsym.problems.stability.words import Word
from mbsym.report.maps.located import Locating
from mbsym.report.schemas import schema


def mapped(name: str, axis: str, low: Any, high: Any, **settings: Any) -> Map:
    found = Axis(axis, Fraction(low), Fraction(high))
    return exact_map(derived(SHIPPED / f"{name}.yaml"), [found], {k: Fraction(v) for k, v in settings.items()})


def test_rouths_critical_mass_ratio_is_an_exact_root() -> None:
    """27 mu (1 - mu) = 1, from Routh; below it stabilised by gyroscopic forces, above it a pair to the right."""
    found = mapped("triangular-points", "mu", 0, "1/2")
    assert found.section.constant is not None
    assert found.section.constant.text == "sqrt(3)"
    inner = [one for one in found.line.zeros if 0 < float(one.number) < 0.5]
    assert [one.number.polynomial for one in inner] == [fmpz_poly([1, -27, 27])]
    words = [one.word for one in found.regions]
    assert words == [Word.STABLE, Word.UNSTABLE]
    assert found.regions[1].judged is not None
    assert (found.regions[1].judged.right, found.regions[1].judged.real_right) == (2, 0)
    border = found.corners[inner[0].id].judged
    assert border is not None
    assert border.border is Border.JORDAN


def test_the_bicycles_stable_speeds() -> None:
    """Meijaard et al. (2007), section 5.3 and appendix: stable from 4.2923825 to 6.0242620 m/s."""
    found = mapped("bicycle", "v", 4, 7)
    changing = [float(found.line.zeros[one.number].number) for one in found.corners if found.drawn(one)]
    assert changing == pytest.approx([4.29238253634111, 6.02426201538837], abs=1e-13)
    stable = [one for one in found.regions if one.word is not Word.UNSTABLE]
    assert {one.word for one in stable} == {Word.ASYMPTOTIC_BUT_STEADY}
    assert found.at(Fraction(5)) in stable
    below, above = found.at(Fraction(42, 10)), found.at(Fraction(62, 10))
    assert below is not None
    assert below.judged is not None
    assert (below.judged.right, below.judged.real_right) == (2, 0)
    assert above is not None
    assert above.judged is not None
    assert (above.judged.right, above.judged.real_right) == (1, 1)


def test_flutter_on_a_line() -> None:
    """41/28 + b^2/2 with b = 1/10 is rational: the exact number, with an imaginary pair; 0 is not admissible."""
    found = mapped("ziegler-damped", "P", 0, 4)
    where, word = Locating(found)(Fraction(41, 28) + Fraction(1, 200))
    assert where.startswith("point")
    assert word == Word.CRITICAL
    assert Locating(found)(Fraction(0))[1] == Lack.OUTSIDE
    assert Locating(found)(Fraction(5)) == ("outside of the interval", "")
    assert found.check is not None
    assert found.check.holds


def test_sines_and_cosines_of_a_fraction_of_pi_are_exact() -> None:
    """sin(pi/10) = (sqrt(5) - 1)/4 and cos(pi/10)^2 = (5 + sqrt(5))/8, as polynomials in 2 cos(pi/10)."""
    analysis = derived(SHIPPED / "bicycle.yaml")
    ring = analysis.ring
    sine, cosine = (ring.context.gens().index(ring.generator(kind, "lam")) for kind in ("sine", "cosine"))
    found = constant_of(analysis.system, ring, [sine, cosine])
    assert found is not None
    modulus = found.number.modulus
    s, c = found.images[sine], found.images[cosine]
    assert (s * s + c * c - 1) % modulus == 0
    assert (4 * s * s + 2 * s - 1) % modulus == 0
    assert found.number.sign(s) > 0
    assert found.number.sign(c - fmpq(19, 20)) > 0


def test_the_files_of_a_line(tmp_path: Path) -> None:
    points = filed(tmp_path / "points.csv", "mu\n0.01\n0.3\n")
    line = ["map", "systems/triangular-points.yaml", "--x", "mu=0:1/2"]
    words = [*line, "--locate", str(points), "--out", str(tmp_path)]
    done = invoked(*words, code=0)
    assert "at 0.0385208965 (exactly: a root of a polynomial of degree 2" in done.stdout
    content = json.loads((tmp_path / "map.json").read_text())
    assert not list(Draft202012Validator(schema("map")).iter_errors(content))
    assert content["constant"] == "sqrt(3)"
    assert (tmp_path / "map.pdf").read_bytes().startswith(b"%PDF")
    assert r"\mu = 0.0385208965" in (tmp_path / "map.tex").read_text()
    rows = list(csv.DictReader((tmp_path / "located.csv").open()))
    assert [row["verdict"] for row in rows] == [Word.STABLE, Word.UNSTABLE]


@pytest.mark.parametrize(("further", "wanted"), [("+ x**4/4", Word.STABLE), ("- x**4/4", Word.UNSTABLE)])
def test_irrational_borders_are_asked_of_the_nonlinear_system(further: str, wanted: Word) -> None:
    """V = (a^2 - 2) x^2/2 +- x^4/4: at a = +-sqrt(2) the first term is of order four.  a^3 = 2 is no square root."""
    text = """
mbsym: 1
name: border
parameters: {a: {sign: real, value: 0}}
bodies: [{name: p, mass: 1, connection point: [x, 0, 0], coordinates: [x]}]
loads: [potential: (a**2 - 2)*x**2/2 FURTHER]
motion: {x: 0}
""".replace("FURTHER", further)
    axis = Axis("a", Fraction(-3), Fraction(3))
    line = exact_map(mbsym.loads(text), [axis], {})
    verdicts = [cell.nonlinear for cell in line.corners if cell.nonlinear is not None]
    assert [verdict.word for verdict in verdicts] == [wanted, wanted]
    cubic = exact_map(mbsym.loads(text.replace("a**2", "a**3")), [axis], {})
    assert all(cell.nonlinear is None for cell in cubic.corners)
