"""The measured trade as CSV and as rows of text."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from io import StringIO
from math import isfinite

from mbsym.model.quantities import marked
from mbsym.numerics.fidelity import RESOLVED, ModelError
from mbsym.numerics.kernels.interface import FLOAT64
from mbsym.numerics.tradeoff import Measured, Tradeoff, duration

COLUMNS = (
    "method", "arithmetic", "tolerance", "step", "error", "drift", "evaluations", "steps", "seconds", "front", "trouble"
)  # fmt: skip
MODEL_COLUMNS = ("model", "neglected", "error", "operations", "evaluations", "seconds", "trouble")


def tradeoff_csv(found: Tradeoff, time: str | None = None) -> str:
    """One row a run; an empty field where there is no number.  ``time`` is the unit of the step, if it is known."""
    return _csv([marked(name, time if name == "step" else "") for name in COLUMNS], (_row(row) for row in found.rows))


def fidelity_csv(rows: Sequence[ModelError]) -> str:
    """One row a model."""
    lines = []
    for row in rows:
        what = (row.variant.label, row.variant.neglected)
        lines.append((*what, _number(row.error), row.operations, row.evaluations, _number(row.seconds), row.trouble))
    return _csv(MODEL_COLUMNS, lines)


def _csv(header: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    stream = StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return stream.getvalue()


def _row(row: Measured) -> tuple[object, ...]:
    candidate, setting = row.candidate, row.candidate.setting
    return (
        candidate.method.traits.name,
        candidate.scalar,
        "" if setting.tolerance is None else f"{setting.tolerance:.0e}",
        "" if setting.step is None else repr(setting.step),
        _number(row.error),
        _number(row.drift),
        row.evaluations,
        row.steps,
        _number(row.seconds),
        "yes" if row.front else "no",
        row.trouble,
    )


def _number(value: float) -> str:
    return f"{value:.17g}" if isfinite(value) else ""


def shown(rows: Sequence[Measured], smallest_judged: float) -> list[tuple[str, ...]]:
    """Cells for the terminal: method (and arithmetic), setting, error, drift, evaluations, steps, time, front."""
    lines: list[tuple[str, ...]] = []
    for row in rows:
        name = row.candidate.method.traits.name
        error = "fails" if row.trouble else _error(row.error, smallest_judged)
        lines.append(
            (
                name if row.candidate.scalar == FLOAT64 else f"{name} {row.candidate.scalar}",
                row.candidate.shown,
                error,
                "" if row.trouble else f"{row.drift:.1e}",
                str(row.evaluations),
                str(row.steps),
                duration(row.seconds),
                "*" if row.front else "",
            )
        )
    return lines


def _error(error: float, smallest_judged: float) -> str:
    """An error that the reference cannot tell from its own is given as a bound."""
    return f"{error:.1e}" if error > smallest_judged else f"< {smallest_judged:.0e}"


def models_shown(rows: Sequence[ModelError]) -> list[tuple[str, ...]]:
    """Cells for the terminal: model, what it neglects, error, operations, time."""
    lines: list[tuple[str, ...]] = []
    for row in rows:
        error = row.trouble if row.trouble else f"{row.error:.1e}" if row.error > RESOLVED else f"< {RESOLVED:.0e}"
        lines.append((row.variant.label, row.variant.neglected, error, str(row.operations), duration(row.seconds)))
    return lines
