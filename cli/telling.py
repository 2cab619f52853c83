"""What a command has found, in the language of the description, and where the files are."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from mbsym.expressions.message import Message
from mbsym.model.system import System
from mbsym.report.content import Block, titled
from mbsym.report.language import Language
from mbsym.report.plain_writer import Writer
from mbsym_cli.console import asked_width, printable, tell

#: Columns of tables in a file or pipe of which nothing is said.
WIDTH = 120


def show(blocks: Iterable[Block], language: str) -> None:
    """Prints them beneath the name of a system."""
    writer = Writer(Language(language), width=(asked_width() or WIDTH) - 2)
    for parts, whole, margin in writer.document(blocks):
        tell("  ", *parts, whole=whole, margin=None if margin is None else margin + 2)


def show_files(folder: Path, names: Iterable[str], language: str) -> None:
    tell(f"  {Language(language).say(Message('files in'))} ", (printable(folder), "bold"), f": {', '.join(names)}")


def told(
    file: Path, system: System, lines: Iterable[tuple[str, str]], folder: Path, names: Iterable[str], after: str = ""
) -> None:
    """Prints lines with titles beneath the name of the system, ``after`` which stands what they are about."""
    about = f": {Language(system.language).say(after)}" if after else ""
    tell((f"{system.name}{about}", "bold"), (f"  {printable(file)}", "dim"))
    show(titled(lines), system.language)
    show_files(folder, names, system.language)
