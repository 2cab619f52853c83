"""Digits against the extreme: one panel for each ladder, a curve for each quantity and arithmetic."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from typing import Any

from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from mbsym.expressions.message import Message
from mbsym.numerics.extremes.extremes import Extremes
from mbsym.numerics.kernels.interface import FLOAT32, FLOAT64
from mbsym.numerics.trade.digits import FEW, FULL
from mbsym.report.figures.drawing import GREY, pictures, spoken

_COLOURS = {
    "mass matrix": "#444444",
    "forcing": "#2e8b57",
    "accelerations": "#b3372f",
    "pivots": "#8e5ea2",
    "energy": "#d9822b",
    "Jacobian": "#1f5fa8",
    "eigenvalues": "#17a2b8",
}
_MATRICES = "#999999"

#: More panels are not readable; ladders along which something is lost come first.
MOST_PANELS = 12


def extremes_figure(extremes: Extremes, formats: Sequence[str]) -> dict[str, bytes]:
    """``extremes.svg`` and ``.png``; solid: float64, dotted: float32."""
    return pictures({"extremes": lambda: _drawn(extremes)}, formats)


def _drawn(extremes: Extremes) -> Figure:
    say = spoken(extremes.system)
    chosen = sorted(extremes.ladders, key=lambda ladder: _least(extremes, ladder))[:MOST_PANELS]
    chosen = [ladder for ladder in extremes.ladders if ladder in chosen]
    columns = min(3, max(1, len(chosen)))
    lines = max(1, ceil(len(chosen) / columns))
    figure = Figure(figsize=(4.3 * columns, 2.7 * lines + 0.9), layout="constrained")
    grid = figure.subplots(lines, columns, squeeze=False, sharey=True)
    seen: dict[str, Any] = {}
    for place, axes in enumerate(grid.flat):
        if place >= len(chosen):
            axes.set_axis_off()
            continue
        kind, subject = chosen[place]
        for quantity in extremes.quantities:
            rows = sorted(extremes.of(kind, subject, quantity), key=lambda row: row.size)
            rows = [row for row in rows if row.digits.bits]
            if not rows:
                continue
            colour = _COLOURS.get(quantity, _MATRICES)
            for scalar, dash in ((FLOAT64, "-"), (FLOAT32, ":")):
                sizes, digits = [row.size for row in rows], [row.digits.digits[scalar] for row in rows]
                (curve,) = axes.plot(sizes, digits, dash, marker=".", markersize=4, color=colour)
                if scalar == FLOAT64:
                    seen.setdefault(quantity if quantity in _COLOURS else "M, D, G, K, N", curve)
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(LogLocator(numticks=8))
        axes.xaxis.set_minor_locator(NullLocator())
        if kind in ("singular", "border of stability", "equilibrium"):
            axes.invert_xaxis()
        axes.set_ylim(-0.5, FULL[FLOAT64] + 0.8)
        axes.axhline(FEW, color=GREY, linewidth=0.8, linestyle="--")
        title = Message("[[parameter]] times", parameter=subject) if kind == "ratio" else subject
        axes.set_title(say(title), loc="left", fontsize=9.5)
        if place % columns == 0:
            axes.set_ylabel(say("digits kept"))
    title = Message("[[name]]: digits kept in float64 (solid) and float32 (dotted)", name=extremes.system.name)
    figure.suptitle(say(title), x=0.01, ha="left")
    if seen:
        figure.legend(
            list(seen.values()), list(map(say, seen)), loc="outside lower center", ncols=8, frameon=False, fontsize=9
        )
    return figure


def _least(extremes: Extremes, ladder: tuple[str, str]) -> float:
    rows = [row for row in extremes.rows if (row.kind, row.subject) == ladder and row.digits.bits]
    return min((row.digits.digits[FLOAT64] for row in rows), default=FULL[FLOAT64])
