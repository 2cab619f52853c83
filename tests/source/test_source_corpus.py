"""tests/invalid: wrong descriptions with the expected complaints above the guilty lines.

    #! error[unknown-name] 14-20: unknown name 'thetta' | did you mean 'theta'?
    angles: [psi, thetta]

The columns are those of the underlining, ``file`` stands for a complaint about the whole file; after the colon come
the message and, after a bar, the hint.  A file must give exactly the complaints that stand in it, and a system
if all of them are warnings.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import mbsym.expressions.parser
import mbsym.source
from mbsym.source import read, render

CORPUS = sorted((Path(__file__).parents[1] / "invalid").iterdir())

#: Complaints about files as such, which a text file in the corpus cannot show; test_source_files.py has them.
ELSEWHERE = {"unreadable", "not-utf8", "too-large", "too-many"}
ELSEWHERE |= {"bad-scale", "bad-assignment", "circular", "bad-step"}  # --scale, --reduce


def expectations(text: str) -> tuple[str, list[tuple[int, str]]]:
    """The text without its ``#!`` lines, and for each of them the line that it is about (0: the file)."""
    kept: list[str] = []
    expected: list[tuple[int, str]] = []
    for line in text.split("\n"):
        if line.startswith("#! "):
            about_file = re.match(r"#! \w+\[[\w-]+\] file:", line)
            expected.append((0 if about_file else len(kept) + 1, line))
        else:
            kept.append(line)
    return "\n".join(kept), expected


@pytest.mark.parametrize("path", CORPUS, ids=lambda path: path.name)
def test_exactly_the_complaints_that_stand_in_the_file(path: Path) -> None:
    text, expected = expectations(path.read_text(encoding="utf-8"))
    system, complaints = read(text, path.name)
    found = []
    for item in complaints.sorted():
        span = item.span
        where = "file" if span is None else f"{span.column}-{span.column + span.length - 1}"
        hint = f" | {item.hint}" if item.hint else ""
        written = f"#! {item.severity}[{item.code}] {where}: {item.message}{hint}"
        found.append((0 if span is None else span.line, written))
        assert render(item, text, path.name).count("\n") == (span is not None) * 2 + bool(item.hint)
    assert (system is None) == any(line.startswith("#! error") for _, line in expected)
    assert sorted(found) == sorted(expected)


def test_the_corpus_shows_every_code() -> None:
    sources = [*Path(mbsym.source.__file__).parent.glob("*.py"), Path(mbsym.expressions.parser.__file__)]
    code = r'(?:error|warning|complain|refusal|Complaint|shape_error)\(\s*"([a-z0-9-]+)"'
    used = {found for source in sources for found in re.findall(code, source.read_text(encoding="utf-8"))}
    shown = set(re.findall(r"#! \w+\[([\w-]+)\]", "".join(path.read_text(encoding="utf-8") for path in CORPUS)))
    assert used - shown - ELSEWHERE == set()
    assert len(used) > 40
