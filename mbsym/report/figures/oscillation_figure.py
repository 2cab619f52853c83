"""Figures of a periodic solution: its variables over time, phase planes, angles, each with the motion beside it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mbsym.expressions.message import Message
from mbsym.formulas.latex import LatexNames
from mbsym.model.quantities import time_unit, unit_of
from mbsym.model.system import System
from mbsym.problems.small_parameter.result import Oscillation
from mbsym.report.figures.drawing import BLUE, RED, pictures
from mbsym.report.language import Language
from mbsym.report.unit_text import labelled
from mbsym.report.words.oscillation_words import FIGURE, MOTION_LINE, NO_ANGLES, SERIES_LINE
from mbsym.simulation.oscillation_paths import Paths

COLUMNS = 3
STEMS = ("oscillation", "oscillation-planes", "oscillation-angles")


def oscillation_figures(
    system: System, found: Paths, told: Oscillation, formats: Sequence[str], language: Language | None = None
) -> dict[str, bytes]:
    """``oscillation`` (over time), ``oscillation-planes`` (rates over variables) and ``oscillation-angles``."""
    spoken = language or Language()
    series, simulated = spoken.say(SERIES_LINE), spoken.say(MOTION_LINE)
    values = {"order": told.order, "small": told.small, "value": f"{found.small:.4g}"}
    title = spoken.say(Message(FIGURE, system=system.name, **values))
    if not found.angles and found.no_angles:
        title += "\n" + spoken.say(Message(NO_ANGLES, why=found.no_angles))
    names = LatexNames(["t", *found.names, *found.angles])

    def label(name: str, rate: bool = False) -> str:
        symbol = names[name]
        if "mathtt" in symbol.stem:
            return name + ("'" if rate else "")
        return f"${symbol.accented('dot')}$" if rate else f"${symbol}$"

    def unit(name: str) -> str:
        return labelled("", unit_of(system, name)) if name in system.coordinates or name in system.variables else ""

    def over_time(curves: Sequence[tuple[str, Any, Any]]) -> Figure:
        def draw(axes: Axes, one: tuple[str, Any, Any]) -> None:
            name, expanded, motion = one
            axes.plot(found.times, motion, color=BLUE, label=simulated)
            axes.plot(found.times, expanded, color=RED, linestyle="--", label=series)
            axes.set_ylabel(label(name) + unit(name))
            axes.set_xlabel(labelled("$t$", time_unit(system)))

        return _page(title, curves, draw)

    def planes() -> Figure:
        def draw(axes: Axes, name: str) -> None:
            for curve, colour, style, told in (
                (found.motion[name], BLUE, "-", simulated),
                (found.series[name], RED, "--", series),
            ):
                axes.plot(*curve, color=colour, linestyle=style, label=told, linewidth=1.0)
            axes.set_xlabel(label(name) + unit(name))
            axes.set_ylabel(label(name, True))

        return _page(title, found.names, draw)

    drawings = {
        STEMS[0]: lambda: over_time([(x, found.series[x][0], found.motion[x][0]) for x in found.names]),
        STEMS[1]: planes,
    }
    if found.angles:
        drawings[STEMS[2]] = lambda: over_time([(x, *both) for x, both in found.angles.items()])
    return pictures(drawings, formats)


def _page(title: str, items: Sequence[Any], draw: Callable[[Axes, Any], None]) -> Figure:
    columns = min(COLUMNS, len(items))
    rows = -(-len(items) // columns)
    figure = Figure(figsize=(max(5.0, 3.9 * columns), 0.9 + 2.9 * rows), layout="constrained")
    figure.suptitle(title, fontsize=12, parse_math=False)
    grid = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes, item in zip(grid, items, strict=False):
        draw(axes, item)
    for axes in grid[len(items) :]:
        axes.set_visible(False)
    figure.legend(*grid[0].get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False)
    return figure
