"""``mbsym tradeoff``: measures what accuracy costs for one system on this machine."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import click

from mbsym_cli.assignments import given_numbers
from mbsym_cli.console import BAD_INPUT, FAILED, INTERRUPTED, OutPath, complain, reason_of
from mbsym_cli.files import folder_for, obstacle
from mbsym_cli.options import Options
from mbsym_cli.simulation_inputs import read_held
from mbsym_cli.tradeoff_run import Request, run

#: Accuracy is asked for between these.
FINEST, COARSEST = 1e-15, 0.1


@click.command("tradeoff")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--time", "-t", "end", metavar="T", help="Simulate from 0 to T (60, 2*pi).  [required]")
@click.option("--target", default="1e-9", show_default=True, metavar="X", help="The error that is good enough.")
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Replace a value; repeatable.")
@click.option("--methods", "-m", default="all", show_default=True, help="Some of them, separated by commas.")
@click.option(
    "--budget",
    default="60",
    show_default=True,
    metavar="S",
    help="Work worth so many seconds on a usual machine, counted, not timed; less than 30 may be too little.",
)
@click.option("--fidelity/--no-fidelity", default=True, show_default=True, help="Compare simpler models too.")
@click.option("--all-rows", is_flag=True, help="Print every run, not only those on the front and near the target.")
@click.option("--out", "-o", type=OutPath(path_type=Path, file_okay=False), help="Folder.  [default: reports/NAME]")
@click.option("--quiet", "-q", is_flag=True, help="Print only the recommendation.")
def command(
    file: Path,
    end: str | None,
    target: str,
    settings: tuple[str, ...],
    methods: str,
    budget: str,
    fidelity: bool,
    all_rows: bool,
    out: Path | None,
    quiet: bool,
) -> None:
    """Measure what accuracy costs when FILE is simulated from 0 to T, on this machine.

    Every method climbs a ladder of tolerances or steps, in every arithmetic it knows; its error is measured over the
    whole interval against a reference solution, whose own error is printed: an extrapolation in 160 bits, or, where
    that takes too long, one of two methods in extended arithmetic that agree, or of two implicit ones.  Simpler models
    (gravity of lower order, linearised equations, coordinates that rest taken out) are compared with the most faithful
    one.

    Written are tradeoff.csv, fidelity.csv and work-precision.svg/.png; Ctrl-C keeps what was measured in files named
    ...-partial.  Exit codes: 0 done, 1 files could not be written, 2 something is missing or wrong, 3 there is no
    solution up to T, 130 interrupted.

    \b
    Example:
      mbsym tradeoff systems/double-pendulum.yaml --time 60 --target 1e-9
    """
    folder = folder_for(file, out)
    texts = {"--time": end, "--target": target, "--methods": methods, "--budget": budget}
    try:
        sys.exit(_command(file, folder, settings, texts, Request(0, 0, 0, fidelity, all_rows, quiet)))
    except KeyboardInterrupt:
        complain(file, "interrupted")
        sys.exit(INTERRUPTED)


def _command(
    file: Path, folder: Path, settings: Sequence[str], texts: Mapping[str, str | None], request: Request
) -> int:
    """Reads everything, complains about everything, then measures."""
    from mbsym.numerics.methods.table import METHODS

    system = read_held(file, "tradeoff", constrained=True)
    asked = Options()
    given = None if system is None else given_numbers(file, system, settings, asked)[0]
    end = asked.time(texts["--time"])
    target = asked.number("--target", texts["--target"], FINEST, COARSEST)
    names = asked.words("--methods", texts["--methods"] or "", tuple(METHODS), "method", every="all")
    budget = asked.number("--budget", texts["--budget"])
    if asked.refused(None if system is None else file) or given is None:
        return BAD_INPUT
    request = replace(request, end=end or 0.0, target=target or 0.0, budget=budget or 0.0)
    reason = obstacle(folder)
    if reason:
        complain(file, f"the results cannot be written: {reason}")
        return FAILED
    try:
        return run(file, folder, given, [METHODS[name] for name in names], request)
    except OSError as error:
        complain(file, f"the results cannot be written: {reason_of(error)}")
    return FAILED
