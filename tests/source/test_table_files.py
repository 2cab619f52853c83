"""Points of tables from files: what is read, what is complained about and where, and what is never opened."""

from __future__ import annotations

from fractions import Fraction as F
from pathlib import Path

import pytest
from conftest import filed, system_of

from mbsym.source import load, read, to_text, to_yaml
from mbsym.source.tables import MOST_BYTES
from mbsym.source.yaml_writer import meaning

DESCRIPTION = """
mbsym: 1
name: Mast
tables:
  wind: {FIELDS}
bodies:
  - {name: one, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: 2}
loads:
  - generalized force: {x: wind(t)}
"""
ROWS = "# at the mast\ntime; speed; gust\n0; 3.2; 1\n\n0.5; 4; 1\n1.25; -1e-1; 2\n"


def described(folder: Path, fields: str, rows: str | bytes = ROWS) -> Path:
    (folder / "data").mkdir(exist_ok=True)
    (folder / "data/wind.csv").write_bytes(rows if isinstance(rows, bytes) else rows.encode())
    return filed(folder / "mast.yaml", DESCRIPTION.replace("FIELDS", fields))


def complaints(folder: Path, fields: str, rows: str | bytes = ROWS) -> list[tuple[str, str | None]]:
    system, found, _ = load(described(folder, fields, rows))
    assert system is None
    assert all(one.span is not None and one.span.line == 5 for one in found)
    return [(one.message, one.hint) for one in found]


@pytest.mark.parametrize(("columns", "values"), [
    ("[time, speed]", ("3.2", "4", "-0.1")), ("[1, 2]", ("3.2", "4", "-0.1")), ("[time, 3]", ("1", "1", "2")),
])  # fmt: skip
def test_columns_by_name_and_number(tmp_path: Path, columns: str, values: tuple[str, ...]) -> None:
    system = system_of(described(tmp_path, f"file: data/wind.csv, columns: {columns}"))
    assert system.tables[0].points == tuple(zip((F(0), F(1, 2), F(5, 4)), map(F, values), strict=True))


@pytest.mark.parametrize("rows", ["0,1\n2,3\n", "0\t1\n2\t3\n", "\ufeff t , x \r\n0, 1\r\n2, 3\r\n", '"0";"1"\n2;3'])
def test_separators_marks_and_line_ends(tmp_path: Path, rows: str) -> None:
    system = system_of(described(tmp_path, "file: data/wind.csv", rows))
    assert system.tables[0].points == ((0, 1), (2, 3))


def test_every_wrong_row_is_told_with_its_line(tmp_path: Path) -> None:
    rows = "t, x\n0, 1\n1, one\n1.5\n1.2, 3\n1.2, 4\n2, 0,5\n"
    assert complaints(tmp_path, "file: data/wind.csv", rows) == [
        ("data/wind.csv:3: 'one' is no number", None),
        ("data/wind.csv:4: 1 cells, and 2 in the first row", None),
        (
            "data/wind.csv:6: the arguments of a table increase from row to row",
            "take the mean of rows with one argument",
        ),
        ("data/wind.csv:7: 3 cells, and 2 in the first row", "numbers have a decimal point"),
    ]
    rows = "t; x\n0; 1\n1; 2,5\n"
    assert complaints(tmp_path, "file: data/wind.csv", rows) == [
        ("data/wind.csv:3: '2,5' is no number", "numbers have a decimal point")
    ]
    many = complaints(tmp_path, "file: data/wind.csv", "0, 1\n" + "a, \n" * 100)
    assert len(many) == 9
    assert ("data/wind.csv: and 92 more rows like these", None) in many


def test_columns_that_are_not_there(tmp_path: Path) -> None:
    found = complaints(tmp_path, "file: data/wind.csv, columns: [time, sped]")
    assert found == [("data/wind.csv:2: there is no column 'sped'", "its columns are: 'time', 'speed', 'gust'")]
    assert "'columns' must be two columns" in complaints(tmp_path, "file: data/wind.csv, columns: [1]")[0][0]
    both = complaints(tmp_path, "file: data/wind.csv, points: [[0, 0], [1, 1]]")
    assert both[0][0] == "'points' does not go with 'file'"


@pytest.mark.parametrize("file", ["/etc/passwd", "../wind.csv", "data/../../wind.csv", "C:/wind.csv", "data\\wind.csv"])
def test_no_file_elsewhere_is_opened(tmp_path: Path, file: str) -> None:
    (tmp_path / "wind.csv").write_text("0, 1\n1, 2\n")
    (tmp_path / "inside").mkdir()
    found = complaints(tmp_path / "inside", f"file: '{file}'")
    assert found[0][0] == "a file of points stands beside the description, or in a folder below"


def test_a_link_out_of_the_folder_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "inside").mkdir()
    (tmp_path / "secret.csv").write_text("0, 1\n1, 2\n")
    (tmp_path / "inside/link.csv").symlink_to(tmp_path / "secret.csv")
    assert "or in a folder below" in complaints(tmp_path / "inside", "file: link.csv")[0][0]


def test_what_is_too_large_empty_or_no_text(tmp_path: Path) -> None:
    assert "has more than" in complaints(tmp_path, "file: data/wind.csv", b"0, 1\n" * (MOST_BYTES // 5 + 1))[0][0]
    assert complaints(tmp_path, "file: data/wind.csv", "# nothing\n")[0][0] == "data/wind.csv has no rows"
    assert "2 to 20000 rows of numbers, not 1" in complaints(tmp_path, "file: data/wind.csv", "t, x\n0, 1\n")[0][0]
    assert "no UTF-8 text (line 2)" in complaints(tmp_path, "file: data/wind.csv", b"0, 1\n\xff, 2\n")[0][0]
    assert "there is no file 'data'" in complaints(tmp_path, "file: data")[0][0]
    huge = complaints(tmp_path, "file: data/wind.csv", "0, 1\n1, 1e999\n2, " + "9" * 200 + "\n")
    assert [message.rpartition(" is ")[2] for message, _ in huge] == ["no number"] * 2


def test_a_text_alone_has_no_files_beside_it() -> None:
    system, found = read(DESCRIPTION.replace("FIELDS", "file: wind.csv"))
    assert system is None
    assert [one.message.partition(":")[0] for one in found] == ["files beside a description are read with it only"]


def test_the_content_is_part_of_what_is_meant(tmp_path: Path) -> None:
    """Another content is another system: results are not taken for its own, and a stated digest is checked."""
    path = described(tmp_path, "file: data/wind.csv, outside: error, between: cubic")
    system = system_of(path)
    before = meaning(system)
    for written, name in ((to_yaml(system), "again.yaml"), (to_text(system), "again.txt")):
        (tmp_path / name).write_text(written)
        again, found, _ = load(tmp_path / name)
        assert again == system, list(found)
    described(tmp_path, "file: data/wind.csv, outside: error, between: cubic", ROWS.replace("3.2", "3.3"))
    changed = system_of(path)
    assert meaning(changed) != before
    pinned, found, _ = load(tmp_path / "again.yaml")
    assert pinned is None
    assert "is not the file that is meant" in next(one.message for one in found)
