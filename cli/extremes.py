"""``mbsym extremes``: how many digits each quantity keeps at the extremes, and where the model breaks down."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mbsym_cli.assignments import given_numbers
from mbsym_cli.console import BAD_INPUT, FAILED, INTERRUPTED, OK, complain, console, printable, read_description, status
from mbsym_cli.files import deliver, folder_for, obstacle
from mbsym_cli.options import Options

if TYPE_CHECKING:
    from rich.table import Table

    from mbsym.expressions.tree import Expression
    from mbsym.numerics.extremes import Extremes
    from mbsym.numerics.scenario import Scenario
    from mbsym.numerics.sequences import Ranking


#: Columns of a table that does not go to a terminal.
WIDE = 400


@click.command("extremes")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Replace a value; repeatable.")
@click.option("--sequences", is_flag=True, help="Rank the 12 rotation sequences of each body instead.")
@click.option("--budget", default="60", show_default=True, metavar="S", help="About so many seconds at most.")
@click.option("--out", "-o", type=click.Path(path_type=Path, file_okay=False), help="Folder.  [default: reports/NAME]")
@click.option("--quiet", "-q", is_flag=True, help="Print only the sentences.")
def command(file: Path, settings: tuple[str, ...], sequences: bool, budget: str, out: Path | None, quiet: bool) -> None:
    """Measure how many digits each quantity of FILE keeps at the extremes, and where the model breaks down.

    Extremes are: states near the singularities of the chosen angles, rates from 1e-8 to 1e8, states near the
    unperturbed motion, every positive parameter times 1e-12 to 1e12, and parameters at a border of stability.  Mass
    matrix, forcing, accelerations, pivots, energy, Jacobian, linear matrices and eigenvalues are evaluated in float32,
    float64 and in rigorous balls; the condition tells what no formula could keep.  Verdicts of stability are exact, or
    "undecided".

    Written are extremes.csv, extremes.json and extremes.svg/.png.  Exit codes: 0 done, 1 files could not be written,
    2 something is missing or wrong, 130 interrupted.

    \b
    Examples:
      mbsym extremes systems/satellite.yaml --set R=7000000 --set omega0=1/1000
      mbsym extremes systems/heavy-top.yaml --sequences
    """
    folder = folder_for(file, out)
    try:
        sys.exit(_command(file, folder, settings, sequences, budget, quiet))
    except KeyboardInterrupt:
        complain(file, "interrupted")
        sys.exit(INTERRUPTED)


def _command(file: Path, folder: Path, settings: Sequence[str], sequences: bool, budget: str, quiet: bool) -> int:
    """Reads everything, complains about everything, then measures."""
    from mbsym.algebra.failures import Failure

    system = read_description(file)
    asked = Options()
    given, overrides = (None, {}) if system is None else given_numbers(file, system, settings, asked)
    seconds = asked.number("--budget", budget)
    if asked.refused(None if system is None else file) or given is None or seconds is None:
        return BAD_INPUT
    reason = "" if sequences else obstacle(folder)
    if reason:
        complain(file, f"the results cannot be written: {reason}")
        return FAILED
    try:
        if sequences:
            return _rank(file, given, quiet)
        return _measure(file, folder, given, dict(overrides), seconds, quiet)
    except Failure as error:
        complain(file, f"the equations have no program: {error}")
    except OSError as error:
        complain(file, f"the results cannot be written: {error}")
    return FAILED


def _measure(
    file: Path, folder: Path, given: Scenario, overrides: dict[str, Expression], seconds: float, quiet: bool
) -> int:
    from mbsym.mechanics.variables import ring_of
    from mbsym.numerics.extremes import extremes
    from mbsym.report.extremes_figure import extremes_figure
    from mbsym.report.extremes_tables import extremes_csv, extremes_json

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

    from mbsym.numerics.extremes import sentences
    from mbsym.problems.stability.sentences import short
    from mbsym.report.extremes_tables import tables

    out = console()
    if not quiet:
        out.print(Text.assemble((found.system.name, "bold"), (f"  {printable(file)}, {found.seconds:.1f} s", "dim")))
        out.print(
            "  fewest digits kept along each ladder, float64 / float32; * lost by the formula, not by the question"
        )
        for columns, rows in tables(found):
            # Where nobody's screen is the limit, every line is as long as it must be.
            (out if out.is_terminal else Console(width=WIDE, highlight=False)).print(_table(columns, rows))
    for sentence in sentences(found, short):
        out.print(Text(f"- {sentence}"))
    for reason in found.left_out:
        out.print(Text(f"- left out: {reason}", style="yellow"))
    if not quiet:
        out.print(Text.assemble("  files in ", (printable(folder), "bold"), ": ", ", ".join(names)))


def _table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> Table:
    """Names, verdicts and titles fold where the terminal is narrow; numbers never do."""
    from rich.table import Table

    shown = Table(box=None, padding=(0, 1), header_style="bold cyan")
    for place, name in enumerate(columns):
        if name in ("extreme", "stability"):
            shown.add_column(name, overflow="fold")
        else:
            width = max(len(row[place]) for row in rows)
            shown.add_column(name, justify="right", overflow="fold", min_width=width)
    for row in rows:
        shown.add_row(*row)
    return shown


def _rank(file: Path, given: Scenario, quiet: bool) -> int:
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
