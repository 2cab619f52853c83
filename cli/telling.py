"""What a command has found, in lines with titles, and where the files are."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from mbsym_cli.console import console, printable


def told(file: Path, title: str, lines: Iterable[tuple[str, str]], folder: Path, names: Iterable[str]) -> None:
    """Prints it; a line whose title is ``warning`` stands out."""
    from rich.text import Text

    out = console()
    out.print(Text.assemble((title, "bold"), (f"  {printable(file)}", "dim")))
    for name, text in lines:
        style = "yellow" if name == "warning" else "bold cyan"
        out.print(Text.assemble("  ", (f"{name:<9} ", style), text))
    out.print(Text.assemble("  files in ", (printable(folder), "bold"), f": {', '.join(names)}"))
