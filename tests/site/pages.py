"""What a page of the documentation asks a reader to do, step by step."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
#: The page whose commands stand for themselves: they are run one by one, in the clone, by tests/cli/test_readme.py.
COMMANDS = "reference/commands.md"

_BLOCK = re.compile(r"^(?P<indent> *)```(?P<head>.*)\n(?P<text>(?:.*\n)*?)(?P=indent)```$", re.MULTILINE)
_MEASURED = re.compile(r"\b[0-9.]+ s\b")


@dataclass(frozen=True)
class Block:
    """A fenced block: its language, its title or "", its text without indentation, and the line of its page."""

    language: str
    title: str
    text: str
    line: int


def pages() -> list[str]:
    return sorted(path.relative_to(DOCS).as_posix() for path in DOCS.rglob("*.md"))


def blocks(text: str) -> list[Block]:
    """Every fenced block of a page, in order."""
    found = []
    for match in _BLOCK.finditer(text):
        words = match["head"].split(maxsplit=1)
        title = re.search(r'title="([^"]*)"', match["head"])
        indent = len(match["indent"])
        body = "".join(line[indent:] if line.strip() else line for line in match["text"].splitlines(keepends=True))
        line = text.count("\n", 0, match.start()) + 1
        found.append(Block(words[0] if words else "", title[1] if title else "", body, line))
    return found


def differs(shown: str, printed: str) -> str:
    """The first line of a page that was not printed there, or "".

    Lines stand in the order of the page, next to each other unless ``...`` stands between; of a line that ends with
    ``...`` its beginning; measured seconds may differ.
    """
    lines = [_comparable(line) for line in printed.splitlines()]
    place, gap = 0, False
    for line in shown.splitlines():
        if line.strip() == "...":
            gap = True
            continue
        wanted = _comparable(line)
        start = wanted.removesuffix("...")
        found = next(
            (k for k in range(place, len(lines)) if lines[k] == wanted or _begins(lines[k], wanted, start)), -1
        )
        if found < 0 or (found != place and not gap):
            return line
        place, gap = found + 1, False
    return "" if gap or place == len(lines) else f"and nothing after it; there is: {lines[place]}"


def _begins(line: str, wanted: str, start: str) -> bool:
    return start != wanted and line.startswith(start)


def _comparable(line: str) -> str:
    return _MEASURED.sub("0 s", line).rstrip()
