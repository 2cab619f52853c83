"""A sweep as a picture: a plane coloured by the measure, a curve, or where drawn points lie.

Of a grid of two names the plane; of one name the curve, or a band of verdicts; of points drawn at random the shares of
verdicts, or the distribution of numbers.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from mbsym.model.system import System
from mbsym.numerics.ensembles.variation import Points
from mbsym.report.figures.drawing import BLUE, GREY, equalities, pictures, spoken, symbol
from mbsym.report.maps.frame import colour_of
from mbsym.sweeps.judged import WORDS
from mbsym.sweeps.points import Column

#: A plane has so many cells on a side at most: more than a picture shows.
MOST_CELLS = 1_600


_NONE: Mapping[str, Any] = {}


def sweep_figure(
    system: System,
    points: Points,
    column: Column,
    values: Any,
    formats: Sequence[str],
    fixed: Mapping[str, Any] = _NONE,
) -> Mapping[str, bytes]:
    """``sweep.svg`` and the like, of the measure's first column; ``values`` of all points, in their order.

    ``fixed``: the numbers of what does not vary, told below the title.
    """

    def drawn() -> Figure:
        wide = len(points.grids) == 2
        figure = Figure(figsize=(6.4, 5.2) if wide else (7, 3.6), layout="constrained")
        axes = figure.subplots()
        axes.grid(visible=not wide)
        if wide:
            _plane(figure, axes, system, points, column, values)
        elif len(points.grids) == 1:
            _line(axes, system, points, column, values)
        else:
            _spread(axes, system, column, values)
        title = f"{system.name}: {_title(system, column)}".replace("$", r"\$")
        figure.suptitle("\n".join(filter(None, (title, equalities(fixed)))), fontsize=11)
        return figure

    if len(points.grids) > 2:
        return {}
    return pictures({"sweep": drawn}, formats)


def _title(system: System, column: Column) -> str:
    return spoken(system)(column.title)


def _plane(figure: Figure, axes: Axes, system: System, points: Points, column: Column, values: Any) -> None:
    (first, second), say = points.grids, spoken(system)
    table = np.reshape(values, (first.count, second.count))
    steps = [-(-count // MOST_CELLS) for count in table.shape]
    table = table[:: steps[0], :: steps[1]].T
    x, y = first.values[:: steps[0]], second.values[:: steps[1]]
    if column.words:
        codes = np.unique(table)
        colours = ListedColormap([colour_of(WORDS[code]) for code in codes])
        ranks = np.searchsorted(codes, table)
        norm = BoundaryNorm(np.arange(len(codes) + 1) - 0.5, len(codes))
        axes.pcolormesh(x, y, ranks, cmap=colours, norm=norm, shading="nearest", rasterized=True)
        patches = [Patch(facecolor=colour_of(WORDS[code]), edgecolor=GREY, label=say(WORDS[code])) for code in codes]
        figure.legend(handles=patches, loc="outside lower center", ncols=2, frameon=False, fontsize=9)
    else:
        shown = axes.pcolormesh(x, y, np.ma.masked_invalid(table), cmap="cividis", shading="nearest", rasterized=True)
        figure.colorbar(shown, ax=axes, label=_title(system, column))
    axes.set_xlabel(symbol(first.name))
    axes.set_ylabel(symbol(second.name))


def _line(axes: Axes, system: System, points: Points, column: Column, values: Any) -> None:
    (grid,) = points.grids
    axes.set_xlabel(symbol(grid.name))
    axes.set_xlim(*sorted((grid.low, grid.high)))
    if not column.words:
        axes.plot(grid.values, values, color=BLUE)
        axes.set_ylabel(_title(system, column))
        return
    edges = np.concatenate([[0], np.flatnonzero(np.diff(values)) + 1, [len(values)]])
    x = grid.values
    borders = [x[0], *((x[k - 1] + x[k]) / 2 for k in edges[1:-1]), x[-1]]
    seen: dict[str, Patch] = {}
    for start, left, right in zip(edges[:-1], borders[:-1], borders[1:], strict=True):
        word = WORDS[values[start]]
        axes.axvspan(left, right, color=colour_of(word), linewidth=0)
        seen.setdefault(word, Patch(facecolor=colour_of(word), edgecolor=GREY, label=spoken(system)(word)))
    axes.set_yticks([])
    axes.legend(handles=list(seen.values()), loc="upper center", bbox_to_anchor=(0.5, -0.25), ncols=2, frameon=False)


def _spread(axes: Axes, system: System, column: Column, values: Any) -> None:
    say = spoken(system)
    if not column.words:
        sound = values[np.isfinite(values)]
        if len(sound):
            axes.hist(sound, bins=min(80, max(5, int(len(sound) ** 0.5))), color=BLUE)
        axes.set_xlabel(_title(system, column))
        axes.set_ylabel(say("points"))
        return
    codes, counts = np.unique(values, return_counts=True)
    order = np.argsort(counts)
    axes.barh(
        [say(WORDS[codes[k]]) for k in order],
        [100 * counts[k] / len(values) for k in order],
        color=[colour_of(WORDS[codes[k]]) for k in order],
        edgecolor=GREY,
    )
    axes.set_xlabel(say("% of the points"))
