"""Measurements for ``mbsym extremes``: taken, written, summed up."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from mbsym_cli.console import OK, console, printable, status
from mbsym_cli.files import deliver

if TYPE_CHECKING:
    from rich.table import Table

    from mbsym.expressions.tree import Expression
    from mbsym.numerics.extremes.extremes import Extremes
    from mbsym.numerics.scenario import Scenario
    from mbsym.numerics.sequences import Ranking

#: Columns of a table that does not go to a terminal.
WIDE = 400


def measure(
    file: Path, folder: Path, given: Scenario, overrides: dict[str, Expression], seconds: float, quiet: bool
) -> int:
    """The exit code.  Raises Failure where the equations have no program, OSError where nothing can be written."""
    from mbsym.mechanics.variables import ring_of
    from mbsym.numerics.extremes.extremes import extremes
    from mbsym.report.figures.extremes_figure import extremes_figure
    from mbsym.report.runs.extremes_tables import extremes_csv, extremes_json

    with status(quiet) as say:
        found = extremes(given, ring_of(given.system), overrides, seconds, lambda text: say(f"{file.name}: {text}"))
        say(f"{file.name}: drawing")
        texts: dict[str, str | bytes] = {"extremes.csv": extremes_csv(found), "extremes.json": extremes_json(found)}
        texts |= extremes_figure(found, ("svg", "png"))
        deliver(folder, texts, "extremes")
    _print(file, found, folder, list(texts), quiet)
    return OK


def _print(file: Path, found: Extremes, folder: Path, names: Sequence[str], quiet: bool) -> None:
    from rich.console import Console
    from rich.text import Text

    from mbsym.numerics.extremes.extremes_told import sentences
    from mbsym.report.runs.extremes_tables import tables

    out = console()
    if not quiet:
        out.print(Text.assemble((found.system.name, "bold"), (f"  {printable(file)}, {found.seconds:.1f} s", "dim")))
        out.print(
            "  fewest digits kept along each ladder, float64 / float32; * lost by the formula, not by the question"
        )
        for columns, rows in tables(found):
            # Where nobody's screen is the limit, every line is as long as it must be.
            (out if out.is_terminal else Console(width=WIDE, highlight=False)).print(_table(columns, rows))
    for sentence in sentences(found, printable(file)):
        out.print(Text(f"- {sentence}"))
    for reason in found.left_out:
        out.print(Text(f"- left out: {reason}", style="yellow"))
    if not quiet:
        out.print(Text.assemble("  files in ", (printable(folder), "bold"), ": ", ", ".join(names)))


def _table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> Table:
    """Names, verdicts and titles fold where the terminal is narrow; numbers never do."""
    from rich.table import Table

    from mbsym.report.runs.extremes_tables import APPROXIMATION

    shown = Table(box=None, padding=(0, 1), header_style="bold cyan")
    for place, name in enumerate(columns):
        if name in ("extreme", APPROXIMATION):
            shown.add_column(name, overflow="fold")
        else:
            width = max(len(row[place]) for row in rows)
            shown.add_column(name, justify="right", overflow="fold", min_width=width)
    for row in rows:
        shown.add_row(*row)
    return shown


def rank(file: Path, given: Scenario, quiet: bool) -> int:
    """The rotation sequences of each body, by their distance from a singularity; the exit code."""
    from mbsym.numerics.probes import motion_state
    from mbsym.numerics.sequences import rankings

    states = [[float(x) for x in given.state]]
    moving = motion_state(given)
    if moving is not None:
        states.append([float(x) for x in moving])
    with status(quiet) as say:
        found = list(rankings(given, states, lambda text: say(f"{file.name}: {text}")))
    if not found:
        print(f"{printable(file)}: no body is oriented by three turns.")
    for ranking in found:
        _print_ranking(ranking, quiet)
    return OK


def _print_ranking(ranking: Ranking, quiet: bool) -> None:
    from rich.table import Table
    from rich.text import Text

    out = console()
    if ranking.alternatives and not quiet:
        table = Table(box=None, padding=(0, 1), header_style="bold cyan")
        for name in ("sequence", "distance from singularity", "smallest / largest pivot", "operations", "M and f", ""):
            table.add_column(name, justify="right" if name else "left")
        for a in ranking.alternatives:
            own = "in the description" if a.own else ""
            table.add_row(a.text, f"{a.distance:.4f}", f"{a.pivot:.2e}", str(a.operations), str(a.equations), own)
        out.print(table)
    out.print(Text(ranking.sentence, style="bold"))
