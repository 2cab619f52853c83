"""Lines of words are as wide as COLUMNS asks for; a file or pipe of which nothing is said has one line a statement."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from conftest import SHIPPED, filed, invoked

from mbsym_cli.console import wrapped

WIDTH = 80

COMMANDS = [
    ("run", "bicycle.yaml", "--problems", "1,2,4", "--brief"),
    ("run", "ziegler-damped.yaml", "--problems", "5,6,7"),
    ("symmetries", "double-pendulum.yaml"),
    ("average", "shaken-pendulum.yaml"),
    ("nonlinear", "spring-pendulum.yaml"),
    *(("explain", str(number)) for number in range(1, 13)),
    ("explain",),
    *(
        ("explain", topic)
        for topic in ("claims", "description", "loads", "constraints", "expressions", "abbreviations")
    ),
]


def called(words: tuple[str, ...], folder: Path, columns: str) -> str:
    there = [str(SHIPPED / word) if word.endswith(".yaml") else word for word in words]
    out = ["--out", str(folder / "out"), "--format", "json"] if words[0] == "run" else []
    return invoked(*there, *out, env={"COLUMNS": columns}).output


def is_formula(line: str) -> bool:
    """What is not broken: products and powers, long paths, and the place of a complaint with its line."""
    return max(map(len, line.split())) > WIDTH // 2 or bool(
        re.search(r"\*|\^|^\S+:\d+:\d+: |^ +\d* +\||  [A-Za-z(].* = ", line)
    )


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_no_line_of_words_is_wider_than_asked_for(words: tuple[str, ...], tmp_path: Path) -> None:
    narrow, wide = (called(words, tmp_path / columns, columns) for columns in (str(WIDTH), "1000"))
    assert [line for line in narrow.split("\n") if len(line) > WIDTH and not is_formula(line)] == []
    masked = [re.sub(r"\d+\.\d+\s+s\b|\S*/\S+", "", text) for text in (narrow, wide)]  # seconds, folders
    assert masked[0].split() == masked[1].split()  # nothing is lost


@pytest.mark.parametrize("topic", ["description", "loads", "claims"])
def test_a_table_in_an_explanation_keeps_its_columns(topic: str) -> None:
    """Rows were broken twice, and began in the line of the row before; a key has its meaning beside it or below."""
    narrow, wide = (called(("explain", topic), Path(), columns).split("\n") for columns in (str(WIDTH), "1000"))
    row = re.compile(r"( {4}\w[\w ]*?  +)(?=\S)")
    begun, rows = ([match[1] for match in map(row.match, lines) if match] for lines in (wide, narrow))
    assert len(begun) > 10
    assert rows == begun
    under = [line for line, before in zip(narrow[1:], narrow, strict=False) if row.match(before) and line[:5].isspace()]
    assert under
    assert {len(line) - len(line.lstrip()) for line in under} <= {len(x) for x in begun}


def test_a_pipe_gets_one_line_a_statement(tmp_path: Path) -> None:
    words = ("run", "bicycle.yaml", "--problems", "4")
    assert max(map(len, called(words, tmp_path, "").split("\n"))) > WIDTH


def test_words_are_never_cut() -> None:
    long = "x" * 50
    assert wrapped(f"  {long} {long} a b", 60) == f"  {long}\n    {long} a b"
    assert wrapped(long, 30) == long
    assert wrapped("  short", 30) == "  short"


WRONG = """mbsym: 1
name: P
parameters: {m: positive}
bodies:
  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x], massx: 3}
"""


def test_complaints_are_wrapped_but_what_they_quote(tmp_path: Path) -> None:
    """The hint lists all keys of a body: 150 letters; the line of the file stays as it is, with its underlining."""
    path = filed(tmp_path / "w.yaml", WRONG)
    told = {x: invoked("check", path, env={"COLUMNS": x}).stderr for x in ("60", "")}
    quoted = "   5 |   - {name: p, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x], massx: 3}"
    for text in told.values():
        assert quoted in text.split("\n")
    lines = told["60"].split("\n")
    (hint,) = [k for k, line in enumerate(lines) if line.startswith("  hint: the keys are")]
    assert lines[hint + 1].startswith("    ")
    assert max(len(line) for line in lines[hint:] if str(tmp_path) not in line) <= 60
    (whole,) = [line for line in told[""].split("\n") if line.startswith("  hint: the keys are")]
    assert len(whole) > 120


@pytest.mark.parametrize(
    ("language", "said"),
    [
        ("ru", "верно: P; координаты: x; тела и системы координат: 1"),
        ("es", "correcto: P; coordenadas: x; cuerpos y sistemas de referencia: 1"),
    ],
)
def test_check_speaks_the_language_of_the_description(language: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "p.yaml"
    path.write_text(WRONG.replace(", massx: 3", "").replace("name: P\n", f"name: P\nlanguage: {language}\n"), "utf-8")
    assert invoked("check", path).stdout.endswith(f": {said}\n")
