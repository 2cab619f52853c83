"""One study for ``mbsym tradeoff``: measured, written, summed up."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from mbsym_cli.console import BROKEN_DOWN, INTERRUPTED, OK, complain, console, printable, status
from mbsym_cli.files import deliver
from mbsym_cli.simulation_closing import begun_from

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.numerics.methods.interface import Breakdown, Method
    from mbsym.numerics.scenario import Scenario
    from mbsym.numerics.trade.trade_study import Study
    from mbsym.numerics.trade.tradeoff import Measured

#: How columns are aligned that do not end on the right.
SIDES = {"method": "left", "setting": "left", "front": "center"}


@dataclass(frozen=True)
class Request:
    """What was asked for, numbers read."""

    end: float
    target: float
    budget: float
    fidelity: bool
    every_row: bool
    quiet: bool


def run(file: Path, folder: Path, found: Scenario, methods: Sequence[Method], request: Request) -> int:
    """The exit code.  Raises OSError where the results cannot be written."""
    from mbsym.algebra.failures import Failure
    from mbsym.numerics.methods.interface import Breakdown
    from mbsym.numerics.trade.trade_study import studied

    begun = begun_from(file, found, request.fidelity)
    if isinstance(begun, int):
        return begun
    with status(request.quiet) as say:

        def watch(text: str) -> None:
            say(f"{file.name}: {text}")

        try:
            study = studied(begun, methods, request.end, request.budget, request.fidelity, watch)
        except Breakdown as error:
            complain(file, _without_reference(error, request))
            return BROKEN_DOWN
        except Failure as error:
            complain(file, f"the equations have no program: {error}")
            return BROKEN_DOWN
        watch("drawing")
        paths = [] if not study.trade.rows else _write(folder, found.system, study, request)
    if study.trade.rows:
        _print(file, found.system, study, request, paths)
    if study.trade.interrupted:
        kept = f"; what was measured is kept in {printable(paths[0].parent)}" if study.trade.rows else ""
        complain(file, f"interrupted{kept}")
        return INTERRUPTED
    return OK


def _without_reference(error: Breakdown, request: Request) -> str:
    """A solution that ends is one thing, one that takes too long another."""
    from mbsym.numerics.methods.interface import STEP_LIMIT
    from mbsym.numerics.trade.reference_search import DISAGREE

    if error.kind == DISAGREE:
        why = f"no two solutions agree, {error.message}: the motion may be chaotic over such a time"
        return f"there is no reference solution up to t = {request.end:g}: {why}; a shorter --time helps"
    if error.kind != STEP_LIMIT:
        return f"there is no reference solution up to t = {request.end:g}: {error}"
    reached = f"the budget ended at t = {error.time:.3g}; a shorter --time or a larger --budget helps"
    return f"no reference solution up to t = {request.end:g} was found: {reached}"


def _write(folder: Path, system: System, study: Study, request: Request) -> list[Path]:
    from mbsym.model.quantities import time_unit, with_unit
    from mbsym.report.figures.tradeoff_figure import work_precision
    from mbsym.report.runs.tradeoff_table import fidelity_csv, tradeoff_csv
    from mbsym.report.unit_text import pretty

    trade, models = study.trade, study.models
    mark = "-partial" if trade.interrupted else ""
    texts: dict[str, str | bytes] = {f"tradeoff{mark}.csv": tradeoff_csv(trade, time_unit(system))}
    if models:
        texts["fidelity.csv"] = fidelity_csv(models)
    title = f"{system.name}, t = 0 to {with_unit(f'{request.end:g}', pretty(time_unit(system)))}"
    pictures = work_precision(trade, request.target, title, models, ("svg", "png"))
    texts |= {name.replace(".", f"{mark}."): content for name, content in pictures.items()}
    return deliver(folder, texts, "tradeoff")


def _print(file: Path, system: System, study: Study, request: Request, paths: list[Path]) -> None:
    from rich.table import Table
    from rich.text import Text

    from mbsym.numerics.trade.fidelity import model_advice
    from mbsym.numerics.trade.tradeoff import advice
    from mbsym.report.runs.tradeoff_table import constrained, models_shown, shown

    out, trade, models = console(), study.trade, study.models
    advised = f"{advice(trade, request.target)} {model_advice(models, request.target)}".rstrip()
    if request.quiet:
        print(advised)
        return
    out.print(Text.assemble((system.name, "bold"), (f"  {printable(file)}, t = 0 to {request.end:g}", "dim")))
    truth = trade.reference
    out.print(
        f"  reference: {truth.method}, estimated error {truth.error:.1e}, {truth.seconds:.1f} s; "
        f"errors below {trade.smallest_judged:.0e} are not told apart"
    )
    rows = trade.rows if request.every_row else [row for row in trade.rows if row.front or _near(row, request.target)]
    table = Table(box=None, padding=(0, 1), header_style="bold cyan")
    strayed = ("constraints",) if constrained(rows) else ()
    for name in ("method", "setting", "error", "drift", *strayed, "evaluations", "steps", "time", "front"):
        side = SIDES.get(name, "right")
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
    out.print(Text(advised, style="bold"))
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
