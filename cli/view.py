"""``mbsym view``: a system in three dimensions, as one page."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mbsym_cli.assignments import assignments, contradictions, given_numbers
from mbsym_cli.console import BAD_INPUT, FAILED, OK, OutPath, complain, printable, read_description
from mbsym_cli.files import deliver, folder_for, obstacle, write_whole
from mbsym_cli.options import Options
from mbsym_cli.progress import progress
from mbsym_cli.study import attempted, leave

if TYPE_CHECKING:
    from mbsym.expressions.tree import Expression
    from mbsym.model.system import System


@dataclass(frozen=True)
class Wanted:
    """What the page is to show."""

    system: System
    overrides: Mapping[str, Expression]
    time: float | None
    modes: bool
    equilibria: bool


@click.command("view")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--time", "-t", "end", metavar="T", help="Show the motion until T, too (20, 4*pi).")
@click.option("--modes", is_flag=True, help="Show the linear modes about the given motion, with its verdict.")
@click.option("--equilibria", is_flag=True, help="List the relative equilibria to click through, with their verdicts.")
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Replace a value; repeatable.")
@click.option("--out", "-o", type=OutPath(path_type=Path, dir_okay=False), help="Default: reports/NAME/view.html")
@click.option("--quiet", "-q", is_flag=True, help="Print only what went wrong.")
def command(
    file: Path,
    end: str | None,
    modes: bool,
    equilibria: bool,
    settings: tuple[str, ...],
    out: Path | None,
    quiet: bool,
) -> None:
    """Write FILE's system in three dimensions as one self-contained page, with sliders for its coordinates.

    Bodies with their shapes, or the ellipsoids of their inertia; joints, mass centres, forces.  The page works without
    network and server, for talks and supplements of papers.  Values that are missing are stood in for, and told so, if
    no motion is asked for.

    Exit codes: 0 written, 1 not written (the reason is given), 2 something is missing or wrong, 130 interrupted.

    \b
    Examples:
      mbsym view systems/double-pendulum.yaml --time 10 --modes
      mbsym view systems/satellite.yaml -o satellite.html
    """
    leave(file, lambda: _command(file, out, end, (modes, equilibria), settings, quiet))


def _command(
    file: Path, out: Path | None, end: str | None, further: tuple[bool, bool], settings: tuple[str, ...], quiet: bool
) -> int:
    """Reads everything, complains about everything, then computes and writes."""
    from mbsym.numerics.scenario import Incomplete

    system = read_description(file, moving="view")
    asked = Options()
    time = None if end is None else asked.time(end)
    overrides: Mapping[str, Expression] = {}
    if system is not None and end is not None:
        overrides = given_numbers(file, system, settings, asked)[1]
    elif system is not None:
        overrides = _without_run(file, system, settings, asked)
    asked.unwritten("--out", out)
    if asked.refused(None if system is None else file) or system is None:
        return BAD_INPUT
    reason = "" if out is not None else obstacle(folder_for(file, None))
    if reason:
        complain(file, f"the page cannot be written: {reason}")
        return FAILED
    wanted = Wanted(system, overrides, time, *further)
    made = attempted(file, lambda: _made(file, wanted, quiet), {Incomplete: "cannot be drawn"})
    if made is None:
        return FAILED
    text, said = made
    there = out or folder_for(file, None) / "view.html"
    try:
        if out is None:
            deliver(there.parent, {there.name: text}, "view")
        else:
            write_whole(out, text)
    except OSError as error:
        complain(there, f"cannot be written: {error.strerror}")
        return FAILED
    if not quiet:
        for line in said:
            click.echo(printable(line))
        click.echo(f"{printable(there)}: {len(text) / 1e6:.1f} MB, opens in a browser without network")
    return OK


def _without_run(file: Path, system: System, settings: tuple[str, ...], asked: Options) -> Mapping[str, Expression]:
    """What --set says; values that contradict each other are complained of, missing ones are not."""
    from mbsym.numerics.scenario import Incomplete, Lack, scenario

    assigned = assignments(settings, system, asked)
    try:
        scenario(system, dict(assigned.values), state=False)
    except Incomplete as error:
        contradictions(file, Lack((), error.lack.contradictions), assigned, asked)
    return assigned.values


def _made(file: Path, wanted: Wanted, quiet: bool) -> tuple[str, list[str]]:
    """The page, and what is to be said of it."""
    from mbsym.report.viewer.page import viewed

    with progress(quiet or wanted.time is None, file.name, wanted.time or 1.0) as watch:
        return viewed(wanted.system, wanted.overrides, wanted.time, wanted.modes, wanted.equilibria, watch)
