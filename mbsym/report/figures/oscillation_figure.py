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
    system: System, paths: Paths, oscillation: Oscillation, formats: Sequence[str], language: Language | None = None
) -> dict[str, bytes]:
    """``oscillation`` (over time), ``oscillation-planes`` (rates over variables) and ``oscillation-angles``."""
    spoken = language or Language()
    series, simulated = spoken.say(SERIES_LINE), spoken.say(MOTION_LINE)
    values = {"order": oscillation.order, "small": oscillation.small, "value": f"{paths.small:.4g}"}
    title = spoken.say(Message(FIGURE, system=system.name, **values))
    if not paths.angles and paths.no_angles:
        title += "\n" + spoken.say(Message(NO_ANGLES, why=paths.no_angles))
    names = LatexNames(["t", *paths.names, *paths.angles])

    def label(name: str, rate: bool = False) -> str:
        symbol = names[name]
        if "mathtt" in symbol.stem:
            return name + ("'" if rate else "")
        return f"${symbol.accented('dot')}$" if rate else f"${symbol}$"

    def unit(name: str) -> str:
        return labelled("", unit_of(system, name)) if name in system.coordinates or name in system.variables else ""

    def over_time(curves: Sequence[tuple[str, Any, Any]]) -> Figure:
        def draw(axes: Axes, traces: tuple[str, Any, Any]) -> None:
            name, expanded, motion = traces
            axes.plot(paths.times, motion, color=BLUE, label=simulated)
            axes.plot(paths.times, expanded, color=RED, linestyle="--", label=series)
            axes.set_ylabel(label(name) + unit(name))
            axes.set_xlabel(labelled("$t$", time_unit(system)))

        return _page(title, curves, draw)

    def planes() -> Figure:
        def draw(axes: Axes, name: str) -> None:
            for curve, colour, style, caption in (
                (paths.motion[name], BLUE, "-", simulated),
                (paths.series[name], RED, "--", series),
            ):
                axes.plot(*curve, color=colour, linestyle=style, label=caption, linewidth=1.0)
            axes.set_xlabel(label(name) + unit(name))
            axes.set_ylabel(label(name, True))

        return _page(title, paths.names, draw)

    drawings = {
        STEMS[0]: lambda: over_time([(x, paths.series[x][0], paths.motion[x][0]) for x in paths.names]),
        STEMS[1]: planes,
    }
    if paths.angles:
        drawings[STEMS[2]] = lambda: over_time([(x, *both) for x, both in paths.angles.items()])
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
