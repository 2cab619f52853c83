"""Lines of words are as wide as COLUMNS asks for; a file or pipe of which nothing is said has one line a statement."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from click.testing import CliRunner

from mbsym_cli.console import wrapped
from mbsym_cli.main import main

SYSTEMS = Path(__file__).parents[2] / "systems"
WIDTH = 80

COMMANDS = [
    ("run", "bicycle.yaml", "--problems", "1,2,4", "--brief"),
    ("run", "ziegler-damped.yaml", "--problems", "5,6,7"),
    ("symmetries", "double-pendulum.yaml"),
    ("average", "shaken-pendulum.yaml"),
    ("nonlinear", "spring-pendulum.yaml"),
    *(("explain", str(number)) for number in range(1, 13)),
    ("explain",),
    ("explain", "claims"),
]


def called(words: tuple[str, ...], folder: Path, columns: str) -> str:
    there = [str(SYSTEMS / word) if word.endswith(".yaml") else word for word in words]
    out = ["--out", str(folder / "out"), "--format", "json"] if words[0] == "run" else []
    return CliRunner().invoke(main, [*there, *out], env={"COLUMNS": columns}).output


def is_formula(line: str) -> bool:
    """What is not broken: products and powers, long paths, and the place of a complaint with its line."""
    return max(map(len, line.split())) > WIDTH // 2 or bool(
        re.search(r"\*|\^|^\S+:\d+:\d+: |^ +\d* +\||  [A-Za-z(].* = ", line)
    )


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_no_line_of_words_is_wider_than_asked_for(words: tuple[str, ...], tmp_path: Path) -> None:
    narrow, wide = (called(words, tmp_path / columns, columns) for columns in (str(WIDTH), "1000"))
    assert [line for line in narrow.split("\n") if len(line) > WIDTH and not is_formula(line)] == []
    masked = [re.sub(r"\d\.\d+ s\b|\S*/\S+", "", text) for text in (narrow, wide)]  # seconds, folders
    assert masked[0].split() == masked[1].split()  # nothing is lost


def test_a_pipe_gets_one_line_a_statement(tmp_path: Path) -> None:
    words = ("run", "bicycle.yaml", "--problems", "4")
    assert max(map(len, called(words, tmp_path, "").split("\n"))) > WIDTH


def test_words_are_never_cut() -> None:
    long = "x" * 50
    assert wrapped(f"  {long} {long} a b", 60) == f"  {long}\n    {long} a b"
    assert wrapped(long, 30) == long
    assert wrapped("  short", 30) == "  short"
