"""Constraints at the command line: complaints with places and exit code 2, what is refused by name, units."""

from __future__ import annotations

from pathlib import Path

from conftest import filed, invoked

ROOT = Path(__file__).parents[2]

TEXT = """mbsym: 1
name: Wheel
parameters: {m: positive, r: positive}
bodies:
  - {name: wheel, attached to: 0, mass: m, rotation: {axes: [3], angles: [phi]}, connection point: [x, y, 0],
     coordinates: [x, y, phi]}
constraints:
  - relation: x = r*phi
"""


def written(folder: Path, text: str) -> Path:
    return filed(folder / "wheel.yaml", text)


def test_contradictions_end_with_2_and_nothing_written(tmp_path: Path) -> None:
    path = written(tmp_path, TEXT + "  - relation: x = r*phi + 1\n  - relation: y = 0\n")
    for command in (("run", path, "--out", tmp_path / "out"), ("check", path)):
        done = invoked(*command, code=2)
        assert done.stderr.count("error[contradictory-constraints]") == 2
        assert "wheel.yaml:8:5" in done.stderr
        assert "wheel.yaml:9:5" in done.stderr
    assert not (tmp_path / "out").exists()


def test_a_check_counts_coordinates_and_constraints(tmp_path: Path) -> None:
    done = invoked("check", written(tmp_path, TEXT), code=0)
    assert "coordinates (3): x, y, phi; constraints: 1;" in done.stdout
    assert "degree" not in done.stdout


def test_relations_are_put_in_where_a_command_knows_no_others(tmp_path: Path) -> None:
    done = invoked("symmetries", written(tmp_path, TEXT))
    assert (done.exit_code, "for 'symmetries' the relations are put in, and phi left out" in done.stderr) == (0, True)
    rolling = "constraints:\n  - velocity: x_dot = r*phi_dot\n"
    done = invoked("symmetries", written(tmp_path, TEXT.partition("constraints:")[0] + rolling), code=2)
    assert "unless it follows from a relation: then write that, relation: x = r*phi" in " ".join(done.stderr.split())
    assert "wheel.yaml:8:5" in done.stderr


def test_rough_positions_do_where_constraints_lead_them(tmp_path: Path) -> None:
    """The hint's own words are tried: what was missing is given roughly, and the run begins on the constraints."""
    path = written(tmp_path, TEXT.replace("m: positive, r: positive", "m: 1, r: 2"))
    asked = ("simulate", path, "--time", "1", "--format", "csv", "--out", tmp_path / "out", "--set", "phi=1")
    done = invoked(*asked, code=2)
    assert "a position near the one that is meant will do" in " ".join(done.stderr.split())
    done = invoked(*asked, "--set", "x=3", "--set", "y=0")
    assert (done.exit_code, "closest state that does" in done.stdout) == (0, True)


def test_dimensions_of_constraints_are_checked(tmp_path: Path) -> None:
    path = written(tmp_path, TEXT + "  - relation: x = phi\nunits: {x: m, y: m, r: m, phi: rad, m: kg}\n")
    done = invoked("check", path, code=2)
    assert "error[dimension]" in done.stderr
    assert "wheel.yaml:9:" in done.stderr
    assert "set equal" in done.stderr


def test_both_spellings_keep_constraints(tmp_path: Path) -> None:
    for name in ("four-bar", "rolling-disc"):
        out = tmp_path / f"{name}.txt"
        assert invoked("convert", ROOT / "systems" / f"{name}.yaml", "--out", out).exit_code == 0
        assert invoked("check", out).exit_code == 0
        assert "Constraint description (1)" in out.read_text(encoding="utf-8")
