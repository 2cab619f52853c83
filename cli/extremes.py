"""``mbsym extremes``: how many digits each quantity keeps at the extremes, and where the model breaks down."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import click

from mbsym_cli.assignments import given_numbers
from mbsym_cli.console import BAD_INPUT, FAILED, INTERRUPTED, OutPath, complain, reason_of
from mbsym_cli.extremes_run import measure, rank
from mbsym_cli.files import folder_for, obstacle
from mbsym_cli.options import Options
from mbsym_cli.simulation_closing import begun_from
from mbsym_cli.simulation_inputs import read_held


@click.command("extremes")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Replace a value; repeatable.")
@click.option("--sequences", is_flag=True, help="Rank the 12 rotation sequences of each body instead.")
@click.option("--budget", default="60", show_default=True, metavar="S", help="Counted work, worth some S seconds.")
@click.option("--out", "-o", type=OutPath(path_type=Path, file_okay=False), help="Folder.  [default: reports/NAME]")
@click.option("--quiet", "-q", is_flag=True, help="Print only the sentences.")
def command(file: Path, settings: tuple[str, ...], sequences: bool, budget: str, out: Path | None, quiet: bool) -> None:
    """Measure how many digits each quantity of FILE keeps at the extremes, and where the model breaks down.

    Extremes are: states near singular configurations (they are found: factors of det M and their real zeros, and it is
    told whether the coordinates fail there or the model), rates 1e-8 to 1e8 times the usual, states near the
    unperturbed motion, every positive parameter times 1e-12 to 1e12, and parameters at a border of stability.  Nothing
    depends on the units of the description, but for the range of float32.  Mass matrix, forcing, accelerations, pivots,
    energy, Jacobian, linear matrices and eigenvalues are evaluated in float32, float64 and in rigorous balls; the
    condition tells what no formula could keep.  Verdicts of stability are exact, or "undecided"; eigenvalues at the
    given values are enclosed.  With constraints every state is led to them, and positions are sought in which they lose
    their rank (links in line).

    Written are extremes.csv, extremes.json and extremes.svg/.png.  Exit codes: 0 done, 1 files could not be written,
    2 something is missing or wrong, 3 no state satisfies the constraints, 130 interrupted.

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

    system = read_held(file, "extremes", constrained=not sequences)
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
            return rank(file, given, quiet)
        begun = begun_from(file, given, with_models=False)
        if isinstance(begun, int):
            return begun
        return measure(file, folder, begun, dict(overrides), seconds, quiet)
    except Failure as error:
        complain(file, f"the equations have no program: {error}")
    except OSError as error:
        complain(file, f"the results cannot be written: {reason_of(error)}")
    return FAILED
