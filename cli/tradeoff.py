"""``mbsym tradeoff``: measures what accuracy costs for one system on this machine."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mbsym_cli.assignments import given_numbers
from mbsym_cli.console import (
    BAD_INPUT,
    BROKEN_DOWN,
    FAILED,
    INTERRUPTED,
    OK,
    complain,
    console,
    printable,
    read_description,
    status,
)
from mbsym_cli.files import deliver, folder_for, obstacle
from mbsym_cli.options import Options

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.numerics.fidelity import ModelError
    from mbsym.numerics.methods.interface import Method
    from mbsym.numerics.scenario import Scenario
    from mbsym.numerics.tradeoff import Measured, Tradeoff

FORMATS = ("csv", "svg", "png")

#: Accuracy is asked for between these.
FINEST, COARSEST = 1e-15, 0.1

#: Times at which solutions are compared, the start included.
SAMPLES = 9


@dataclass(frozen=True)
class Request:
    """What was asked for, numbers read."""

    end: float
    target: float
    budget: float
    fidelity: bool
    every_row: bool
    quiet: bool


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
    help="About so many seconds of measuring; the reference takes up to 30, or as many, beside.",
)
@click.option("--fidelity/--no-fidelity", default=True, show_default=True, help="Compare simpler models too.")
@click.option("--all-rows", is_flag=True, help="Print every run, not only those on the front and near the target.")
@click.option("--out", "-o", type=click.Path(path_type=Path, file_okay=False), help="Folder.  [default: reports/NAME]")
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

    Every method climbs a ladder of tolerances or steps, in every arithmetic it knows; its error is measured against a
    reference solution of another method in 160 bits, whose own error is printed.  Simpler models (gravity of lower
    order, linearised equations, coordinates that rest taken out) are compared with the most faithful one.

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

    system = read_description(file)
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
        return _measure(file, folder, given, [METHODS[name] for name in names], request)
    except OSError as error:
        complain(file, f"the results cannot be written: {error}")
    return FAILED


def _measure(file: Path, folder: Path, found: Scenario, methods: list[Method], request: Request) -> int:
    import numpy as np

    from mbsym.algebra.failures import Failure
    from mbsym.numerics import fidelity
    from mbsym.numerics.dynamics import Dynamics
    from mbsym.numerics.methods.interface import Breakdown
    from mbsym.numerics.methods.table import METHODS
    from mbsym.numerics.reference import reference
    from mbsym.numerics.tradeoff import tradeoff

    times = [float(t) for t in np.linspace(0.0, request.end, SAMPLES)]
    with status(request.quiet) as say:
        try:
            dynamics = Dynamics(found)
            say(f"{file.name}: reference solution")
            truth = reference(
                dynamics,
                times,
                budget=max(30.0, request.budget),
                watch=lambda t: say(f"{file.name}: reference solution, t = {t:.4g} of {request.end:g}"),
            )
            trade = tradeoff(dynamics, methods, truth, request.budget, lambda label: say(f"{file.name}: {label}"))
            models: tuple[ModelError, ...] = ()
            if request.fidelity and not trade.interrupted:
                models = fidelity.measured(found, METHODS["dop853"], times, lambda label: say(f"{file.name}: {label}"))
        except Breakdown as error:
            complain(file, f"there is no reference solution up to t = {request.end:g}: {error}")
            return BROKEN_DOWN
        except Failure as error:
            complain(file, f"the equations have no program: {error}")
            return BROKEN_DOWN
        say(f"{file.name}: drawing")
        paths = [] if not trade.rows else _write(folder, found.system, trade, models, request)
    if trade.rows:
        _print(file, found.system, trade, models, request, paths)
    if trade.interrupted:
        kept = f"; what was measured is kept in {printable(paths[0].parent)}" if trade.rows else ""
        complain(file, f"interrupted{kept}")
        return INTERRUPTED
    return OK


def _write(
    folder: Path, system: System, trade: Tradeoff, models: tuple[ModelError, ...], request: Request
) -> list[Path]:
    from mbsym.report.tradeoff_figure import work_precision
    from mbsym.report.tradeoff_table import fidelity_csv, tradeoff_csv

    mark = "-partial" if trade.interrupted else ""
    texts: dict[str, str | bytes] = {f"tradeoff{mark}.csv": tradeoff_csv(trade)}
    if models:
        texts["fidelity.csv"] = fidelity_csv(models)
    title = f"{system.name}, t = 0 to {request.end:g}"
    pictures = work_precision(trade, request.target, title, models, ("svg", "png"))
    texts |= {name.replace(".", f"{mark}."): content for name, content in pictures.items()}
    return deliver(folder, texts, "tradeoff")


def _print(
    file: Path, system: System, trade: Tradeoff, models: tuple[ModelError, ...], request: Request, paths: list[Path]
) -> None:
    from rich.table import Table
    from rich.text import Text

    from mbsym.numerics.tradeoff import advice
    from mbsym.report.tradeoff_table import models_shown, shown

    out = console()
    if request.quiet:
        print(advice(trade, request.target))
        return
    out.print(Text.assemble((system.name, "bold"), (f"  {printable(file)}, t = 0 to {request.end:g}", "dim")))
    truth = trade.reference
    out.print(
        f"  reference: {truth.method}, estimated error {truth.error:.1e}, {truth.seconds:.1f} s; "
        f"errors below {trade.smallest_judged:.0e} are not told apart"
    )
    rows = trade.rows if request.every_row else [row for row in trade.rows if row.front or _near(row, request.target)]
    table = Table(box=None, padding=(0, 1), header_style="bold cyan")
    for name, side in zip(
        ("method", "setting", "error", "drift", "evaluations", "steps", "time", "front"),
        ("left", "left", "right", "right", "right", "right", "right", "center"),
        strict=True,
    ):
        table.add_column(name, justify=side, no_wrap=True)  # type: ignore[arg-type]
    for line in shown(rows, trade.smallest_judged):
        table.add_row(*line, style="" if line[-1] else "dim")
    out.print(table)
    for order in trade.orders:
        if order.pairs > 1:
            out.print(
                f"  {order.method}, {order.scalar}: measured order {order.measured:.2f}, nominal {order.nominal} "
                f"(from {order.pairs} halvings of the step)"
            )
    for name, reason in trade.unusable:
        out.print(Text(f"  {name}: not used: {reason}", style="yellow"))
    if models:
        _print_models(models_shown(models))
    out.print(Text(advice(trade, request.target), style="bold"))
    out.print(
        Text.assemble("  files in ", (printable(paths[0].parent), "bold"), ": ", ", ".join(p.name for p in paths))
    )


def _near(row: Measured, target: float) -> bool:
    return target / 10 < row.error < target * 10


def _print_models(lines: list[tuple[str, ...]]) -> None:
    from rich.table import Table

    table = Table(box=None, padding=(0, 1), header_style="bold cyan")
    for name, side in (
        ("model", "left"),
        ("what it neglects", "left"),
        ("error", "right"),
        ("operations", "right"),
        ("time", "right"),
    ):
        table.add_column(name, justify=side)  # type: ignore[arg-type]
    for line in lines:
        table.add_row(*line)
    console().print(table)
