"""What is told into a file or a pipe is what rich would have written there."""

from __future__ import annotations

import io
import sys

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from rich.console import Console
from rich.text import Text

from mbsym_cli.console import tell, wrapped

#: Without control characters: a tab goes on from how wide things are, which plain text does not know.
WORDS = st.text(st.characters(exclude_categories=["Cs", "Cc"]), max_size=40)


def by_rich(parts: list[str], indent: int) -> str:
    out = io.StringIO()
    console = Console(file=out, highlight=False, soft_wrap=True, width=120)
    text = Text.assemble(*parts)
    if indent:
        text = Text(" " * indent) + text
    console.print(text)
    return out.getvalue()


def told(parts: list[str], indent: int) -> str:
    out, before = io.StringIO(), sys.stdout
    sys.stdout = out
    try:
        tell(*[(part, "bold") if k % 2 else part for k, part in enumerate(parts)], indent=indent)
    finally:
        sys.stdout = before
    return out.getvalue()


@given(st.lists(WORDS, min_size=1, max_size=3), st.integers(0, 6))
@example(["[bold]no markup[/bold] :smile:", "tab\tand\x07bell", "x" * 300], 4)
@example(["углы φ, ψ; ½", "", "  "], 0)
@example(["two\nlines\tapart"], 2)
def test_plain_lines(parts: list[str], indent: int) -> None:
    assert told(parts, indent) == by_rich(parts, indent)


def test_colours_where_they_are_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    from mbsym_cli.console import console

    console.cache_clear()
    try:
        assert "\x1b[1m" in told(["a", "b"], 0)
    finally:
        console.cache_clear()


@pytest.mark.parametrize(
    ("line", "width", "end", "begin"),
    [
        ("stable if alpha > 0, (alpha + gamma) (p1 + 3) - 4 p2 (alpha + 1) > 0", 62, "- 4 p2", "(alpha + 1)"),
        ("x (alpha + beta + gamma + delta + epsilon + zeta + eta)", 30, "+ gamma", "+ delta"),
    ],
)
def test_lines_are_broken_outside_of_brackets_if_that_is_near(line: str, width: int, end: str, begin: str) -> None:
    """In the second nothing outside is."""
    first, second, *_ = wrapped(line, width).split("\n")
    assert first.endswith(end)
    assert second.strip().startswith(begin)
    assert len(first) <= width
