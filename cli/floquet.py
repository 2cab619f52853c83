"""``mbsym floquet``: stability of a motion whose first approximation is periodic in time."""

from __future__ import annotations

from pathlib import Path

import click

from mbsym_cli.assignments import given_numbers
from mbsym_cli.console import BAD_INPUT, FAILED, OK, OutPath, status
from mbsym_cli.files import deliver, folder_for
from mbsym_cli.options import Options
from mbsym_cli.simulation_inputs import read_held
from mbsym_cli.study import attempted, leave, prevented
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
    leave(file, lambda: _command(file, folder_for(file, out), settings, quiet))


def _command(file: Path, folder: Path, settings: tuple[str, ...], quiet: bool) -> int:
    """Reads everything, complains about everything, then judges."""
    system = read_held(file, "floquet")
    asked = Options()
    given = None if system is None else given_numbers(file, system, settings, asked)[0]
    code = prevented(file, folder, system is not None, asked)
    if code or given is None:
        return code or BAD_INPUT
    from mbsym.numerics.dynamics import Dynamics
    from mbsym.numerics.orbits.floquet import Judged, NotPeriodic, judged
    from mbsym.report.runs.floquet_files import floquet_json, sentences

    def work() -> Judged:
        with status(quiet, f"{file.name}: enclosing the monodromy matrix"):
            found = judged(Dynamics(given))
        deliver(folder, {"floquet.json": floquet_json(given.system, found)}, "floquet")
        return found

    found = attempted(file, work, {NotPeriodic: "there is no periodic first approximation to judge"})
    if found is None:
        return FAILED
    if not quiet:
        told(file, given.system.name, sentences(found), folder, ["floquet.json"])
    return OK
