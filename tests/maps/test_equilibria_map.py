"""``mbsym map --of equilibria``: numbers of equilibria over planes against discriminants known by hand."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from random import Random

import pytest
from click.testing import Result
from conftest import SHIPPED, filed, invoked
from jsonschema import Draft202012Validator

import mbsym
import mbsym.maps.equilibria_map as module
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import NoClosedForm
from mbsym.maps.boundaries import Boundaries, Origin
from mbsym.maps.equilibria_map import EquilibriaMap, equilibria_map
from mbsym.maps.mapping import unwatched
from mbsym.maps.result import Cell, Counted, Lack
from mbsym.maps.section import Axis
from mbsym.mechanics.rest import given_values
from mbsym.report.documents.branches import STANDINGS
from mbsym.report.messages import messages
from mbsym.report.schemas import schema
from tests.report.readers import read_latex

BALL = """mbsym: 1
name: ball
parameters: {{p: {{sign: real}}, q: {{sign: real}}}}
bodies:
  - {{name: ball, attached to: 0, connection point: [x, {second}, 0], coordinates: [{names}], mass: 1}}
loads:
  - generalized force: {{{forces}}}
"""


def ball(folder: Path, f: str, g: str = "") -> Path:
    forces = f'x: "{f}"' + (f', y: "{g}"' if g else "")
    return filed(folder / "ball.yaml", BALL.format(second="y" if g else "0", names="x, y" if g else "x", forces=forces))


def mapped(path: Path, x: tuple[str, str, str], y: tuple[str, str, str]) -> EquilibriaMap:
    system = mbsym.load(path, ()).system
    axes = tuple(Axis(name, Fraction(low), Fraction(high)) for name, low, high in (x, y))
    return equilibria_map(system, (axes[0], axes[1]), given_values(system, {}), lambda *words: None)


def counts_at(found: EquilibriaMap, x: Fraction, y: Fraction) -> tuple[int, int]:
    cell = found.at(x, y)
    assert cell is not None
    assert cell.certainty is Certainty.PROVED
    return counted(cell).count, counted(cell).stable


def counted(cell: Cell) -> Counted:
    assert cell.counted is not None
    return cell.counted


UNIT = ("p", "-1", "1"), ("q", "-1", "1")


def test_a_cusp(tmp_path: Path) -> None:
    found = mapped(ball(tmp_path, "p*x - x**3 + q"), *UNIT)
    assert [str(p) for p in found.arrangement.factors] == ["4*p^3 - 27*q^2"]
    source = Random(1)
    for _ in range(50):
        p, q = (Fraction(source.randint(-999, 999), 1000) for _ in range(2))
        assert counts_at(found, p, q) == ((3, 2) if 4 * p**3 > 27 * q**2 else (1, 1))
    known = [counted(cell) for cell in found.regions]
    assert all(one.throughout and one.confirmed == one.count for one in known)


def test_roots_that_come_from_infinity(tmp_path: Path) -> None:
    found = mapped(ball(tmp_path, "p*x**2 + x + q"), *UNIT)  # discriminant 1 - 4 p q; at p = 0 one root is at infinity
    origins = [tuple(x.origin for x in of) for of in found.boundaries.conditions]
    assert {str(p): of for p, of in zip(found.arrangement.factors, origins, strict=True)} == {
        "4*p*q - 1": (Origin.SINGULAR,),
        "p": (Origin.LEAVING,),
    }
    source = Random(2)
    for _ in range(30):
        p, q = (Fraction(source.randint(1, 999) * source.choice((-1, 1)), 1000) for _ in range(2))
        assert counts_at(found, p, q)[0] == (2 if 4 * p * q < 1 else 0)


def test_two_unknowns(tmp_path: Path) -> None:
    # y = q x: x (p - q^2 - x^2) = 0
    found = mapped(ball(tmp_path, "p*x - x**3 - q*y", "q*x - y"), *UNIT)
    source = Random(3)
    for _ in range(30):
        p, q = (Fraction(source.randint(1, 999) * source.choice((-1, 1)), 1000) for _ in range(2))
        assert counts_at(found, p, q)[0] == (3 if p > q**2 else 1)


def test_singular_everywhere_is_no_proof(tmp_path: Path) -> None:
    found = mapped(ball(tmp_path, "x**2*(x - p - 2*q)"), *UNIT)
    assert found.unfinished
    assert {(cell.certainty, cell.lack) for cell in found.regions} == {(Certainty.UNDECIDED, None)}
    assert not any(counted(cell).throughout for cell in found.regions)


def test_infinitely_many_are_not_counted(tmp_path: Path) -> None:
    found = mapped(ball(tmp_path, "(p + 3)*x + y*(q + 3)", "(p + 3)*x + y*(q + 3)"), *UNIT)
    assert {cell.lack for cell in found.regions} == {Lack.FAMILIES}


def test_the_gyrostat_has_eight_to_twenty_four() -> None:
    """B, C = 5, 3: pairs end where |h| = |B - A|, 4 |B - A|, B - C, 4 (B - C); A = C apart (Sarychev & Mirer)."""
    found = mapped(SHIPPED / "orbital-gyrostat.yaml", ("h", "1/2", "9"), ("A", "6", "7"))
    a = Fraction(13, 2)
    for h in map(Fraction, ("3/5", "7/4", "5", "7", "17/2")):
        expected = 24 - 4 * sum(h > x for x in (a - 5, 2, 4 * (a - 5), 8))
        assert counts_at(found, h, Fraction(13, 2))[0] == expected


# --- planted mistakes -------------------------------------------------------------------------------------------------


def test_a_lost_curve_is_found_by_another_point(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_curves", lambda parts: (Boundaries((), (), ()), ()))
    path = ball(tmp_path, "p - x**2 + 0*q")
    done = [mapped(path, ("p", "-1", "1"), ("q", str(-k), "1")) for k in range(1, 5)]
    assert Lack.WITHDRAWN in {cell.lack for one in done for cell in one.cells}


def test_a_lost_equilibrium_is_found_by_newton(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "many_starts", lambda system, values: 4)
    found = mapped(ball(tmp_path, "p*x - x**3 + q"), *UNIT)
    assert {cell.lack for cell in found.regions} == {Lack.WITHDRAWN}
    done = invoke(ball(tmp_path, "p*x - x**3 + q"), "--x", "p=-1:1", "--y", "q=-1:1", "-o", tmp_path / "o", code=1)
    assert "withdrawn" in done.output


# --- the command ------------------------------------------------------------------------------------------------------


def invoke(path: Path, *words: object, code: int | None = None) -> Result:
    return invoked("map", path, "--of", "equilibria", *words, code=code)


def test_files_follow_their_schema(tmp_path: Path) -> None:
    path = ball(tmp_path, "p*x - x**3 + q")
    invoke(path, "--x", "p=-1:1", "--y", "q=-1:1", "--out", tmp_path / "out", "--language", "es", code=0)
    folder = tmp_path / "out"
    data = json.loads((folder / "equilibria-map.json").read_text())
    assert list(Draft202012Validator(schema("equilibria_map")).iter_errors(data)) == []
    assert sorted((x["count"], x["stable"]) for x in data["regions"]) == [(1, 1), (3, 2)]
    text = (folder / "equilibria-map.tex").read_text()
    read_latex("fragments/equilibria-map.tex", text)
    assert "equilibrios" in text
    assert all((folder / f"equilibria-map.{kind}").stat().st_size > 3000 for kind in ("svg", "pdf", "png"))


@pytest.mark.parametrize(
    ("words", "code"),
    [
        (["--x", "h=0:1"], "missing-option"),
        (["--x", "h=0:1", "--y", "A=2:3", "--z", "B=1:2"], "not-of-equilibria"),
        (["--x", "h=1:0", "--y", "h2=0:1"], "given-by-relation"),
        (["--x", "A=-1:1", "--y", "B=-2:-1"], "against-sign"),
        (["--x", "h=0:1", "--y", "A=2:3", "--set", "h2=1"], "given-by-relation"),
    ],
)
def test_what_does_not_fit_is_complained_about(words: list[str], code: str, tmp_path: Path) -> None:
    done = invoke(SHIPPED / "orbital-gyrostat.yaml", *words, "--out", tmp_path / "out", code=2)
    assert code in done.output
    assert not (tmp_path / "out").exists()


def test_options_of_maps_of_one_motion_are_refused_by_name(tmp_path: Path) -> None:
    words = ["--x", "h=0:1", "--y", "A=2:3", "--z", "B=1:2", "--by", "boxes"]
    done = invoke(SHIPPED / "orbital-gyrostat.yaml", *words, "--out", tmp_path / "out", code=2)
    lines = done.output.splitlines()
    guilty = [line.partition(":")[0] for line in lines if "error[not-of-equilibria]" in line]
    assert guilty == ["--z", "--by boxes"]
    assert sum("error[" in line for line in lines) == 2
    assert sum("hint: leave it out" in line for line in lines) == 2


def test_what_is_no_polynomial_is_refused(tmp_path: Path) -> None:
    done = invoke(ball(tmp_path, "p + q - exp(x)"), "--x", "p=0:1", "--y", "q=0:1", "--out", tmp_path / "out", code=1)
    assert "exp" in done.output


def test_every_word_is_translated() -> None:
    for language in ("ru", "es"):
        assert {("", one.told) for one in (*Lack, *Origin)} <= messages(language).keys()
    told = schema("equilibria_map")["properties"]["regions"]["items"]["properties"]["standing"]["enum"]
    assert told == [str(one) for one in STANDINGS]


def test_a_parameter_under_a_cosine_has_no_map() -> None:
    """x (cos(a) + c - 3/2) + 4 x^3 = 0: one rest or three by the sign of the bracket, no polynomial in a."""
    system = mbsym.loads(
        "mbsym: 1\nname: fork\nparameters: {a: real, c: real}\n"
        "bodies: [{name: p, attached to: 0, mass: 1, connection point: [x, 0, 0], coordinates: [x]}]\n"
        "loads: [force function: -(cos(a) + c - 3/2)*x**2/2 - x**4]\nmotion: {}\n"
    ).system
    with pytest.raises(NoClosedForm, match="a stands in"):
        equilibria_map(
            system, (Axis("a", Fraction(0), Fraction(2)), Axis("c", Fraction(0), Fraction(2))), {}, unwatched
        )
