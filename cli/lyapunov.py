"""``mbsym lyapunov``: how fast neighbouring motions part."""

from __future__ import annotations

from pathlib import Path

import click

from mbsym_cli.assignments import given_numbers
from mbsym_cli.console import BAD_INPUT, BROKEN_DOWN, FAILED, INTERRUPTED, OK, OutPath, complain
from mbsym_cli.files import deliver, folder_for
from mbsym_cli.options import Options
from mbsym_cli.progress import progress
from mbsym_cli.simulation_inputs import read_held
from mbsym_cli.study import attempted, leave, prevented
from mbsym_cli.telling import told


@click.command("lyapunov")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--time", "-t", "end", metavar="T", help="Over so long (1000, 200*pi).  [required]")
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Replace a value; repeatable.")
@click.option("--count", metavar="N", help="How many exponents.  [default: all, two for each coordinate]")
@click.option("--every", metavar="DT", help="Make directions orthogonal so often.  [default: a 400th of the time]")
@click.option("--tolerance", metavar="X", default="1e-10", show_default=True, help="Error of one step.")
@click.option("--out", "-o", type=OutPath(path_type=Path, file_okay=False), help="Folder.  [default: reports/NAME]")
@click.option("--quiet", "-q", is_flag=True, help="Print only what went wrong.")
def command(
    file: Path,
    end: str | None,
    settings: tuple[str, ...],
    count: str | None,
    every: str | None,
    tolerance: str,
    out: Path | None,
    quiet: bool,
) -> None:
    """Measure the Lyapunov exponents of FILE's motion over the time T.

    Exponents of a finite time, with the statistical uncertainty of their means; no number proves a motion chaotic or
    regular.  Where all are asked for their sum is checked against the mean divergence of the equations.

    Written are lyapunov.csv (the exponents up to each time), lyapunov.svg/.png and lyapunov.json.  Exit codes: 0 done,
    1 not written, 2 something is missing or wrong, 3 ended early, 130 interrupted.

    \b
    Examples:
      mbsym lyapunov systems/double-pendulum.yaml --time 500 --set theta1=2 --count 1
      mbsym lyapunov systems/spring-pendulum.yaml --time 1000
    """
    leave(file, lambda: _command(file, folder_for(file, out), end, settings, (count, every, tolerance), quiet))


def _command(
    file: Path,
    folder: Path,
    end: str | None,
    settings: tuple[str, ...],
    texts: tuple[str | None, str | None, str],
    quiet: bool,
) -> int:
    """Reads everything, complains about everything, then measures."""
    system = read_held(file, "lyapunov")
    asked = Options()
    given = None if system is None else given_numbers(file, system, settings, asked)[0]
    time = asked.time(end)
    count = asked.whole("--count", texts[0], 1, 10**6 if system is None else 2 * len(system.coordinates))
    every, tolerance = asked.number("--every", texts[1]), asked.number("--tolerance", texts[2], 1e-14, 1e-2)
    if time is not None and every is not None:
        _check_intervals(every, time, asked)
    code = prevented(file, folder, system is not None, asked)
    if code or given is None or time is None or tolerance is None:
        return code or BAD_INPUT
    from mbsym.numerics.orbits.lyapunov import Exponents
    from mbsym.report.runs.lyapunov_files import lyapunov_csv, lyapunov_figure, lyapunov_json, sentences
    from mbsym.simulation.motions import lyapunov_exponents

    def work() -> Exponents:
        with progress(quiet, file.name, time) as watch:
            found = lyapunov_exponents(given, time, every, count, tolerance, watch)
        files["lyapunov.csv"] = lyapunov_csv(found)
        files.update(lyapunov_figure(given.system, found, ("svg", "png")) if len(found.times) > 1 else {})
        files["lyapunov.json"] = lyapunov_json(given.system, found)
        deliver(folder, files, "lyapunov")
        return found

    files: dict[str, str | bytes] = {}
    found = attempted(file, work)
    if found is None:
        return FAILED
    if not quiet:
        told(file, given.system.name, sentences(found), folder, files)
    if found.ended is not None:
        complain(file, f"ended early: {found.ended}")
        return INTERRUPTED if found.ended.kind == "interrupted" else BROKEN_DOWN
    return OK


def _check_intervals(every: float, time: float, asked: Options) -> None:
    """Complains of too many intervals, and of too few for the statistics of means."""
    from mbsym.numerics.orbits.lyapunov import LEAST_INTERVALS

    if time / every > 1e6:
        asked.complain("--every", "too-large", f"{time / every:.3g} intervals are too many", "at most a million")
    if time / every < LEAST_INTERVALS * (1 - 1e-12):
        told = (
            f"--every {every:g} goes with a --time of {LEAST_INTERVALS * every:g} and more: {LEAST_INTERVALS} intervals"
        )
        hint = f"at most {time / LEAST_INTERVALS:.3g} here; with fewer nothing can be said of the uncertainty"
        asked.complain("--every", "too-large", told, hint)
