"""The ledger of a run on the terminal: a table where it is wide enough, hanging lines elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from mbsym_cli.console import console, indented

if TYPE_CHECKING:
    from mbsym.report.runs.ledger import LedgerLine

#: A table of three columns of sentences needs so many characters.
WIDE = 100

_COLOURS = {
    "proved": "green",
    "verified numerically": "green",
    "measured": "green",
    "estimated": "yellow",
    "undecided": "yellow",
}

#: By what follows of a line; an accuracy is that of --accuracy and --until.
_TITLES = {
    "not needed": "ledger: left out because this scene does not need it",
    "open": "ledger: left out; whether this scene needs it depends on the accuracy (--accuracy X --until T)",
    "needed": "ledger: left out although this scene needs it at this accuracy",
}


def show_ledger(lines: Sequence[LedgerLine], unmeasured: Sequence[str]) -> None:
    """What was left out, why that is safe, what it saved; apart, what nobody knows to be safe, and what is not."""
    out = console()
    for standing, title in _TITLES.items():
        own = [line for line in lines if line.standing == standing]
        if own or standing == "not needed":
            out.print(Text(f"  {title}", style="bold red" if standing == "needed" else "bold cyan"))
            _show(own)
    if unmeasured:
        indented(Text(f"not measured, beyond the budget: {', '.join(unmeasured)}", style="yellow"), 4)


def _show(lines: Sequence[LedgerLine]) -> None:
    out = console()
    if not lines:
        out.print("    nothing")
    elif out.is_terminal and out.width >= WIDE:
        out.print(Padding(_table(lines), (0, 0, 0, 4)))
    else:
        for line in lines:
            indented(Text.assemble((line.kind, "bold"), f": {line.what}"), 4)
            indented(_why(line), 6)
            for text in line.saved:
                indented(Text(text), 6)


def _table(lines: Sequence[LedgerLine]) -> Table:
    table = Table(box=None, padding=(0, 2, 1, 0), header_style="bold")
    table.add_column("left out", ratio=3)
    table.add_column("why", ratio=4)
    table.add_column("with it, and without it", ratio=4)
    for line in lines:
        left = Text.assemble((line.kind, "bold"), f"\n{line.what}")
        table.add_row(left, _why(line), Text("\n".join(line.saved)))
    return table


def _why(line: LedgerLine) -> Text:
    return Text.assemble(f"{line.why} ", (f"({line.how})", _COLOURS[line.how]))
