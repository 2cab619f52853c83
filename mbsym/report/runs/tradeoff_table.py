"""The measured trade as CSV, as JSON and as rows of text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf, isfinite
from typing import Any

from mbsym.expressions.message import Message, duration, joined, worded
from mbsym.model.quantities import marked
from mbsym.model.system import System
from mbsym.numerics.kernels.interface import FLOAT64
from mbsym.numerics.trade.fidelity import RESOLVED, ModelError
from mbsym.numerics.trade.tradeoff import Measured, Study, Tradeoff
from mbsym.report.documents import tradeoff as doc
from mbsym.report.documents.base import file_of
from mbsym.report.runs.trajectory_csv import shortest, text_table

COLUMNS = (
    "method", "arithmetic", "tolerance", "step", "error", "drift", "evaluations", "steps", "seconds", "cost", "front",
    "trouble",
)  # fmt: skip
#: Behind ``drift``, where there are constraints.
STRAYED = ("constraint_drift", "constraint_velocity_drift")
MODEL_COLUMNS = ("model", "neglected", "error", "operations", "evaluations", "seconds", "trouble")


def tradeoff_csv(tradeoff: Tradeoff, time: str | None = None) -> str:
    """One row a run; an empty field where there is no number.  ``time`` is the unit of the step, if it is known."""
    tied = constrained(tradeoff.rows)
    names = _with_strayed(COLUMNS, STRAYED if tied else ())
    return text_table(
        [marked(name, time if name == "step" else "") for name in names], (_row(row, tied) for row in tradeoff.rows)
    )


def tradeoff_json(system: System, found: Study, sentence: str, time: float, target: float, budget: float) -> str:
    """``tradeoff.json``: the same with what was asked, and the recommendation."""
    trade = found.trade
    return file_of(
        doc.Tradeoff,
        system,
        trade,
        time=time,
        target=target,
        budget=budget,
        models=found.models,
        recommended=trade.cheapest(target) if target >= trade.smallest_judged else None,
        sentence=sentence,
    )


def constrained(rows: Sequence[Measured]) -> bool:
    """Whether drifts from constraints are among what was measured."""
    return any(row.strayed is not None for row in rows)


def _with_strayed(cells: Sequence[object], strayed: Sequence[object]) -> list[Any]:
    """``strayed`` behind the column ``drift``."""
    place = COLUMNS.index("drift") + 1
    return [*cells[:place], *strayed, *cells[place:]]


def fidelity_csv(rows: Sequence[ModelError]) -> str:
    """One row a model."""
    lines = []
    for row in rows:
        what = (row.model, row.neglected)
        lines.append(
            (*what, _number(row.error), row.operations, row.work.evaluations, _number(row.seconds), row.trouble)
        )
    return text_table(MODEL_COLUMNS, lines)


def _row(row: Measured, tied: bool) -> Sequence[object]:
    setting = row.setting
    cells = (
        row.method.traits.name,
        row.scalar,
        "" if setting.tolerance is None else f"{setting.tolerance:.0e}",
        "" if setting.step is None else repr(setting.step),
        _number(row.error),
        _number(row.drift),
        row.work.evaluations,
        row.work.steps,
        _number(row.seconds),
        _number(row.cost),
        "yes" if row.front else "no",
        row.trouble,
    )
    strayed = row.strayed if row.strayed is not None else (inf, inf)
    return _with_strayed(cells, [_number(x) for x in strayed] if tied else ())


def _number(value: float) -> str:
    return shortest(value) if isfinite(value) else ""


def compared(tradeoffs: Sequence[tuple[str, Tradeoff, float]]) -> list[tuple[str, ...]]:
    """Cells for the terminal, a line a scene (name, what was measured, target): what reaches the target in least time.

    Where nothing does it is the most accurate setting; nothing is said of a scene of which no run came to the end.
    """
    lines = []
    for name, trade, target in tradeoffs:
        best = trade.cheapest(target) if target >= trade.smallest_judged else None
        row = best or min(trade.rows, key=lambda run: run.error, default=None)
        if row is None or not isfinite(row.error):
            lines.append((name, *[""] * 7, Message("no")))
            continue
        method, setting, error, _, *rest = shown([replace(row, strayed=None)], trade.smallest_judged)[0]
        lines.append((name, method, setting, error, *rest[:-1], Message("no") if best is None else Message("yes")))
    return lines


def shown(rows: Sequence[Measured], smallest_judged: float) -> list[tuple[str, ...]]:
    """Cells for the terminal: method (and arithmetic), setting, error, drift, evaluations, steps, time, cost, front.

    Where there are constraints, the larger of its two drifts from them stands behind the drift of the energy.
    """
    lines: list[tuple[str, ...]] = []
    tied = constrained(rows)
    for row in rows:
        name = row.method.traits.name
        error = Message("fails") if row.trouble else _error(row.error, smallest_judged)
        lines.append(
            (
                name if row.scalar == FLOAT64 else joined([name, worded(row.scalar)]),
                row.shown,
                error,
                "" if row.trouble else f"{row.drift:.1e}",
                *(["" if row.strayed is None else f"{max(row.strayed):.1e}"] if tied else []),
                str(row.work.evaluations),
                str(row.work.steps),
                duration(row.seconds),
                f"{row.cost:.2g}",
                "*" if row.front else "",
            )
        )
    return lines


def _error(error: float, smallest_judged: float) -> str:
    """An error that the reference cannot tell from its own is given as a bound."""
    return f"{error:.1e}" if error > smallest_judged else f"< {smallest_judged:.1e}"


def models_shown(rows: Sequence[ModelError]) -> list[tuple[str, ...]]:
    """Cells for the terminal: model, what it neglects, error, operations, time."""
    lines: list[tuple[str, ...]] = []
    for row in rows:
        error = (
            worded(row.trouble) if row.trouble else f"{row.error:.1e}" if row.error > RESOLVED else f"< {RESOLVED:.0e}"
        )
        lines.append((row.model, row.neglected, error, str(row.operations), duration(row.seconds)))
    return lines
