"""The picture of a Poincare section: a point for every passage, in two axes; further axes beside them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

from matplotlib.figure import Figure

from mbsym.expressions.message import Message
from mbsym.expressions.rates import without_velocity
from mbsym.formulas.latex import LatexNames
from mbsym.model.quantities import unit_of
from mbsym.model.system import System
from mbsym.report.figures.drawing import BLUE, pictures, spoken
from mbsym.report.unit_text import labelled
from mbsym.simulation.watching import Axis, SectionPoints

#: Points beyond this number become pixels of the picture.
MOST_POINTS = 5_000

#: Diameter of a point in printers' points: of few, and of very many.
LARGE, SMALL = 4.0, 0.8


def section_figure(crossings: SectionPoints, system: System, note: str, formats: Sequence[str]) -> dict[str, bytes]:
    """``section.svg`` and others; nothing of a section without points."""
    if not len(crossings.times):
        return {}
    return pictures({"section": lambda: _drawn(crossings, system, note)}, formats)


def _drawn(crossings: SectionPoints, system: System, note: str) -> Figure:
    planes = list(pairwise(range(len(crossings.section.axes))))
    figure = Figure(figsize=(1.4 + 5.4 * len(planes), 5.6), layout="constrained")
    count = len(crossings.times)
    text, condition = "[[name]]: [[condition]], points: [[count]]", crossings.section.condition.text[:60]
    title = spoken(system)(Message(text, name=system.name[:60], condition=condition, count=count))
    figure.suptitle(title + (f"\n{note}" if note else ""), fontsize=12, parse_math=False)
    size = max(SMALL, LARGE * min(1.0, (300 / count) ** 0.5))
    for axes, (across, up) in zip(figure.subplots(1, len(planes), squeeze=False)[0], planes, strict=True):
        axes.plot(
            crossings.points[across],
            crossings.points[up],
            linestyle="none",
            marker="o",
            markersize=size,
            markeredgewidth=0,
            color=BLUE,
            rasterized=count > MOST_POINTS,
        )
        axes.set_xlabel(_label(crossings.section.axes[across], system))
        axes.set_ylabel(_label(crossings.section.axes[up], system), rotation=0, ha="right", va="center")
        _limits(crossings, across, axes.set_xlim)
        _limits(crossings, up, axes.set_ylim)
    return figure


def _limits(crossings: SectionPoints, row: int, limit: Callable[[float, float], object]) -> None:
    """A quantity that stays what it is but for rounding is drawn as a constant."""
    low, high = float(crossings.points[row].min()), float(crossings.points[row].max())
    size = max(abs(low), abs(high))
    if high - low < 1e-9 * size or size == 0:
        room = 0.05 * size or 1.0
        limit(low - room, high + room)


def _label(axis: Axis, system: System) -> str:
    """A name as mathematical text with its unit, anything else as it was written."""
    base = without_velocity(axis.text)
    if base not in system.coordinates:
        return axis.text.replace("$", r"\$")
    symbol = LatexNames(["t", *system.coordinates])[base]
    if "mathtt" in symbol.stem:
        return axis.text
    text = f"${symbol}$" if base == axis.text else f"${symbol.accented('dot')}$"
    return labelled(text, unit_of(system, axis.text))
