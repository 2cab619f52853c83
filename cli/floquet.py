"""``mbsym floquet``: stability of a motion whose first approximation is periodic in time."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from mbsym_cli.assignments import given_numbers
from mbsym_cli.console import BAD_INPUT, FAILED, INTERRUPTED, OK, OutPath, complain, status
from mbsym_cli.files import deliver, folder_for, obstacle
from mbsym_cli.options import Options
from mbsym_cli.simulation_inputs import read_held
from mbsym_cli.telling import told


@click.command("floquet")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Replace a value; repeatable.")
@click.option("--out", "-o", type=OutPath(path_type=Path, file_okay=False), help="Folder.  [default: reports/NAME]")
@click.option("--quiet", "-q", is_flag=True, help="Print only what went wrong.")
def command(file: Path, settings: tuple[str, ...], out: Path | None, quiet: bool) -> None:
    """Judge the stability of FILE's unperturbed motion where its first approximation is periodic in time.

    Problem 6 is about constant coefficients; this is for periodic ones (a pendulum whose pivot shakes, Mathieu's
    equation).  The period is read from the equations, the monodromy matrix is enclosed in balls with proved remainders,
    and what its multipliers prove is said: unstable, asymptotically stable, stable in the first approximation only, or
    undecided.

    Written is floquet.json.  Exit codes: 0 judged (undecided, too), 1 there is nothing to judge or it was not written,
    2 something is missing or wrong, 130 interrupted.

    \b
    Example:
      mbsym floquet systems/shaken-pendulum.yaml --set nu=50
    """
    try:
        sys.exit(_command(file, folder_for(file, out), settings, quiet))
    except KeyboardInterrupt:
        complain(file, "interrupted; nothing was written")
        sys.exit(INTERRUPTED)


def _command(file: Path, folder: Path, settings: tuple[str, ...], quiet: bool) -> int:
    """Reads everything, complains about everything, then judges."""
    system = read_held(file, "floquet")
    asked = Options()
    given = None if system is None else given_numbers(file, system, settings, asked)[0]
    if asked.refused(None if system is None else file) or given is None:
        return BAD_INPUT
    reason = obstacle(folder)
    if reason:
        complain(file, f"the results cannot be written: {reason}")
        return FAILED
    from mbsym.algebra.failures import Failure
    from mbsym.numerics.dynamics import Dynamics
    from mbsym.numerics.floquet import NotPeriodic, judged
    from mbsym.report.floquet_files import floquet_json, sentences

    try:
        with status(quiet, f"{file.name}: enclosing the monodromy matrix"):
            found = judged(Dynamics(given))
        deliver(folder, {"floquet.json": floquet_json(given.system, found)}, "floquet")
    except NotPeriodic as error:
        complain(file, f"there is no periodic first approximation to judge: {error}")
        return FAILED
    except Failure as error:
        complain(file, f"error[no-program]: there is no program for these equations: {error}")
        return FAILED
    except OSError as error:
        complain(file, f"the results cannot be written: {error}")
        return FAILED
    if not quiet:
        told(file, given.system.name, sentences(found), folder, ["floquet.json"])
    return OK
