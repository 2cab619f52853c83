"""The summary of a run on the terminal."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from mbsym.report.content import say
from mbsym_cli.console import printable, tell

if TYPE_CHECKING:
    from mbsym.report.brief import Brief
    from mbsym.report.content import Facts
    from mbsym.report.plain_writer import Line, Writer

_COLOURS = {"exact": "green", "verified numerically": "green", "FAILED": "bold red"}
_COLOURS |= {"undecided": "yellow", "singular": "yellow"}


def show(lines: Iterable[Line], indent: int = 2) -> None:
    """Lines of a document, so far to the right."""
    for parts, whole, margin in lines:
        tell(" " * indent, *parts, whole=whole, margin=None if margin is None else margin + indent)


def show_finding(
    found: Facts,
    title: str,
    path: Path,
    seconds: float,
    files: Sequence[Path],
    writer: Writer,
    further: Iterable[Line] = (),
    more: bool = False,
) -> None:
    """What was found, each with its name; ``further`` lines; where all of it is, and how ``more`` of it is told."""
    tell((title, "bold"), (f"  {printable(path)}, {seconds:.2f} s", "dim"))
    show((*writer.document([found]), *further))
    if files:
        page = next((x for x in files if x.name == "report.html"), files[0])
        texts = ("[[file]]", "[[file]] (files there: [[count]])")
        if more:
            texts = ("[[file]] (all of it here: -v)", "[[file]] (files there: [[count]]; all of it here: -v)")
        tell(writer.said(say(texts[len(files) > 1], file=printable(page), count=str(len(files)))), indent=2)


def show_brief(found: Brief, name: str, width: int) -> None:
    """A run in one line; columns are as wide as they mostly are."""
    colour = _COLOURS.get(found.worst, "")
    tell(
        (f"{printable(name):<{width}}", "bold"),
        f"  {found.problems:<8}",
        (f"  {found.self_check:<32}", colour),
        f"  {found.claims:<30}",
        (f"{found.seconds:7.2f} s", "dim"),
        (f"  {found.missing}" if found.missing else "", "yellow"),
    )
