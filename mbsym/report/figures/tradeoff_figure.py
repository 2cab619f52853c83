"""The work-precision figure: seconds against error, a curve for each method and arithmetic."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import isfinite
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from mbsym.expressions.message import Message, plainly
from mbsym.model.quantities import time_unit, with_unit
from mbsym.model.system import System
from mbsym.numerics.trade.fidelity import RESOLVED, ModelError
from mbsym.numerics.trade.tradeoff import Measured, Tradeoff
from mbsym.report.figures.drawing import GREY, RED, pictures, spoken
from mbsym.report.unit_text import pretty

#: Dark and light colours, and markers: what looks alike in the one differs in the other.
_COLOURS = (
    *("#1f5fa8", "#d9822b", "#2e8b57", "#8e5ea2", "#17a2b8", "#8c564b", "#c2478f"),
    *("#444444", "#e8b98a", "#8ccba0", "#c0a0d8", "#a8a8a8", "#e89ac8", "#7fb0e8"),
)
_MARKS = ("o", "D", "v", "P", "X", "*", "<", ">")
#: Arithmetic: the line, and the inside of the marker.
_DASHES: dict[str, Any] = {"float64": "-", "float32": (0, (1, 1.6)), "extended": (0, (5, 2))}
_INSIDE = {"float64": "full", "float32": "none", "extended": "left"}

#: Errors beyond this are no solutions and are not drawn.
WORST = 10.0

OLIVE = "#777700"


def work_precision(
    system: System,
    until: float,
    tradeoff: Tradeoff,
    target: float,
    models: Sequence[ModelError],
    formats: Sequence[str],
) -> dict[str, bytes]:
    """``work-precision.svg`` and ``.png``: what each digit costs; errors of simpler models as vertical lines.

    ``until`` is the last time of the runs.  None where no run came to the end, in time or at all.
    """
    if not any(row.error < WORST for row in tradeoff.rows):
        return {}
    return pictures({"work-precision": lambda: _drawn(system, until, tradeoff, target, models)}, formats)


def _drawn(system: System, until: float, tradeoff: Tradeoff, target: float, models: Sequence[ModelError]) -> Figure:
    say = spoken(system)
    figure = Figure(figsize=(9.6, 6.0), layout="constrained")
    axes = figure.subplots()
    ladders: dict[tuple[str, str], list[Measured]] = {}
    for row in tradeoff.rows:
        if isfinite(row.error) and row.error < WORST:
            ladders.setdefault((row.method.traits.name, row.scalar), []).append(row)
    styles = _styles(dict.fromkeys(name for name, _ in ladders))
    for (name, scalar), rows in ladders.items():
        label = name if scalar == "float64" else f"{name}, {say(scalar)}"
        axes.plot(
            [max(row.error, 1e-17) for row in rows],
            [row.seconds for row in rows],
            linestyle=_DASHES[scalar],
            marker=styles[name][1],
            fillstyle=_INSIDE[scalar],
            markersize=4.5,
            color=styles[name][0],
            label=label,
        )
    front = sorted((row for row in tradeoff.rows if row.front and row.error < WORST), key=lambda row: row.error)
    axes.plot(
        [max(row.error, 1e-17) for row in front],
        [row.seconds for row in front],
        color="#000000",
        linewidth=5,
        alpha=0.12,
        solid_capstyle="round",
        label=say("front"),
        zorder=1,
    )
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.invert_xaxis()
    axes.xaxis.set_major_locator(LogLocator(numticks=12))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set_xlabel(say("error against the reference (smaller to the right)"))
    axes.set_ylabel(say("seconds of integration"))
    last = with_unit(f"{until:g}", pretty(time_unit(system)))
    axes.set_title(f"{system.name}, {say(Message('t = 0 to [[last]]', last=last))}", loc="left")
    _line(axes, target, RED, say(Message("target [[error]]", error=plainly(target))))
    finest = min((row.error for row in tradeoff.rows), default=1.0)
    if tradeoff.smallest_judged > finest / 100:
        _line(axes, tradeoff.smallest_judged, GREY, say("limit of the reference"))
    for model in (row for row in models if RESOLVED < row.error < WORST):
        _line(axes, model.error, OLIVE, say(Message("model [[label]]", label=model.model)))
    # Patterns of lines need some length to be told apart.
    figure.legend(loc="outside right upper", frameon=False, fontsize=9, handlelength=3.4)
    return figure


def _styles(methods: Iterable[str]) -> dict[str, tuple[str, str]]:
    """A colour and a marker for each method, no pair of them twice (up to 56 methods)."""
    return {name: (_COLOURS[i % len(_COLOURS)], _MARKS[i % len(_MARKS)]) for i, name in enumerate(methods)}


def _line(axes: Axes, error: float, colour: str, text: str) -> None:
    axes.axvline(error, color=colour, linewidth=1, linestyle="-.", zorder=0)
    axes.text(
        error,
        0.99,
        text,
        rotation=90,
        color=colour,
        fontsize=8,
        va="top",
        ha="center",
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0},
        transform=axes.get_xaxis_transform(),
    )
