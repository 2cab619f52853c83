"""``mbsym orbit``: a periodic motion near a guess, with its Floquet multipliers."""

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

#: What may be kept while the orbit is sought.
KEPT = ("auto", "energy", "period", "nothing")


@click.command("orbit")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--period", "-T", metavar="T", help="The period, about (2.6, 2*pi).  [required]")
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Replace a value; repeatable.")
@click.option("--keep", metavar=f"[{'|'.join(KEPT)}]", default="auto", show_default=True)
@click.option("--turns", multiple=True, metavar="NAME=N", help="This angle comes back turned by N revolutions.")
@click.option("--out", "-o", type=OutPath(path_type=Path, file_okay=False), help="Folder.  [default: reports/NAME]")
@click.option("--quiet", "-q", is_flag=True, help="Print only what went wrong.")
def command(
    file: Path,
    period: str | None,
    settings: tuple[str, ...],
    keep: str,
    turns: tuple[str, ...],
    out: Path | None,
    quiet: bool,
) -> None:
    """Find a periodic motion of FILE near its initial state and near the period T, by shooting.

    Newton's method with the exact derivative of the flow.  The initial state (initial:, --set) is the guess.  --keep
    says what stays as the guess has it: its energy, the period, or nothing; auto keeps the energy where it is conserved
    and the period where the equations know the time (T must then be a period of theirs).

    Told are the state, the period, how well the motion closes by the method that found it and by another one, and the
    Floquet multipliers with those that are 1 for a reason.  Numbers, no proofs.  Written are orbit.csv (one period) and
    orbit.json.  Exit codes: 0 found, 1 not found or not written, 2 something is missing or wrong, 130 interrupted.

    \b
    Examples:
      mbsym orbit systems/double-pendulum.yaml --period 2.6 --set theta1=0.3 --set theta2=0.12
      mbsym orbit systems/spherical-pendulum.yaml --period 1.57 --turns psi=1 --set psi_dot=4 --set theta=0.9
    """
    leave(file, lambda: _command(file, folder_for(file, out), period, settings, keep, turns, quiet))


def _command(
    file: Path,
    folder: Path,
    period: str | None,
    settings: tuple[str, ...],
    keep: str,
    turns: tuple[str, ...],
    quiet: bool,
) -> int:
    """Reads everything, complains about everything, then searches."""
    system = read_held(file, "orbit")
    asked = Options()
    given = None if system is None else given_numbers(file, system, settings, asked)[0]
    if period is None:
        asked.complain("--period", "missing-option", "about how long a period is is not said", "for example --period 2")
    length = asked.number("--period", period)
    kept = asked.word("--keep", keep, KEPT, "choice")
    turned = {}
    for text in turns:
        name, _, number = text.partition("=")
        if system is not None and name.strip() not in system.coordinates:
            asked.complain(
                "--turns",
                "unknown-name",
                f"there is no coordinate {name!r}",
                f"there are {', '.join(system.coordinates)}",
            )
        whole = asked.whole("--turns", number or "nothing", -1000, 1000)
        turned[name.strip()] = whole or 0
    code = prevented(file, folder, system is not None, asked)
    if code or given is None or length is None or kept is None:
        return code or BAD_INPUT
    from mbsym.numerics.orbits.periodic import NotFound
    from mbsym.report.runs.orbit_files import orbit_csv, orbit_json, sentences
    from mbsym.simulation.motions import PeriodicMotion, find_orbit

    def work() -> PeriodicMotion:
        with status(quiet, f"{file.name}: compiling") as say:
            found = find_orbit(
                given, length, kept, turned, lambda k, size: say(f"{file.name}: step {k}, {size:.1e} left over")
            )
        files.update({"orbit.csv": orbit_csv(found), "orbit.json": orbit_json(found)})
        deliver(folder, files, "orbit")
        return found

    files: dict[str, str | bytes] = {}
    found = attempted(file, work, {NotFound: "no periodic motion was found"})
    if found is None:
        return FAILED
    if not quiet:
        told(file, given.system.name, sentences(found), folder, files)
    return OK
