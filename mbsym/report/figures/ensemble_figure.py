"""Fan charts: how the members of an ensemble are spread over time, a panel a coordinate or velocity.

Median as a line; bands hold the middle 50 % and 90 % of the members; thin lines are the least and the greatest.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation

from mbsym.model.quantities import time_unit
from mbsym.numerics.ensembles.ensemble import QUANTILES, Ensemble
from mbsym.report.figures.drawing import BLUE, GREY, RED, pictures
from mbsym.report.figures.figures import HISTORY_ROWS, coordinate_labels
from mbsym.report.unit_text import labelled


def fan_charts(found: Ensemble, formats: Sequence[str]) -> dict[str, bytes]:
    """``fan.svg`` and ``.png``; further pages, ``fan-2.svg``, where there are many coordinates."""
    system = found.members.dynamics.system
    names = system.coordinates
    count = -(-len(names) // HISTORY_ROWS)
    images: dict[str, bytes] = {}
    for page in range(count):
        part = range(page * len(names) // count, (page + 1) * len(names) // count)
        stem = "fan" + (f"-{page + 1}" if page else "")
        images |= pictures({stem: lambda part=part: _page(found, part)}, formats)  # type: ignore[misc]
    return images


def _page(found: Ensemble, part: range) -> Figure:
    system = found.members.dynamics.system
    positions, velocities = coordinate_labels(system, "\n")
    figure = Figure(figsize=(10, 1.4 + 1.9 * len(part)), layout="constrained")
    axes = figure.subplots(len(part), 2, squeeze=False, sharex=True)
    lost = f", {len(found.fates)} ended early" if found.fates else ""
    varied = ", ".join(found.members.names)
    title = f"{system.name}: {found.count} members{lost}, {varied} varied"
    figure.suptitle(title if len(title) <= 100 else title[:97] + "...", fontsize=12, parse_math=False)
    drawn: dict[str, Any] = {}
    left = ScaledTranslation(-0.6, 0, figure.dpi_scale_trans)
    for row, place in zip(axes, part, strict=True):
        name = system.coordinates[place]
        for side, (axis, label) in enumerate(zip(row, (positions[name], velocities[name]), strict=True)):
            drawn |= _fan(axis, found, place + side * len(system.coordinates))
            axis.set_ylabel(label, rotation=0, ha="right", va="center", labelpad=8, fontsize=13)
            axis.yaxis.set_label_coords(0, 0.5, axis.transAxes + left)
    for axis in axes[-1]:
        axis.set_xlabel(labelled("$t$", time_unit(system)))
        if found.times[-1] > 0:
            axis.set_xlim(0, found.times[-1])
    figure.legend(list(drawn.values()), list(drawn), loc="outside lower center", ncols=5, frameon=False, fontsize=9)
    return figure


def _fan(axis: Any, found: Ensemble, place: int) -> dict[str, Any]:
    """A panel, and its curves by name."""
    spread, times = found.statistics, found.times
    rows = {chance: row[:, place] for chance, row in zip(QUANTILES, spread.quantiles, strict=True)}
    wide = axis.fill_between(times, rows[0.05], rows[0.95], color=BLUE, alpha=0.18, linewidth=0)
    narrow = axis.fill_between(times, rows[0.25], rows[0.75], color=BLUE, alpha=0.30, linewidth=0)
    (median,) = axis.plot(times, rows[0.5], color=BLUE)
    (mean,) = axis.plot(times, spread.mean[:, place], color=RED, linewidth=0.9, linestyle="--")
    (ends,) = axis.plot(times, spread.least[:, place], color=GREY, linewidth=0.6)
    axis.plot(times, spread.greatest[:, place], color=GREY, linewidth=0.6)
    return {"median": median, "mean": mean, "middle 50 %": narrow, "middle 90 %": wide, "least and greatest": ends}
