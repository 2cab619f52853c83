"""The bifurcation diagram: coordinates of equilibria over a parameter, stable solid, unstable dashed, open dotted.

Below stands how many equilibria there are, and how many of them are stable.  It is as wide as a column of a paper.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from mbsym.algebra.plane.numbers import enclosure
from mbsym.formulas.latex import LatexNames
from mbsym.maps.branches_events import Event
from mbsym.maps.branches_result import Branches, Piece
from mbsym.model.quantities import unit_of
from mbsym.model.system import System
from mbsym.report.figures.drawing import pictures
from mbsym.report.language import Language
from mbsym.report.maps.branch_words import EVENTS
from mbsym.report.maps.figure import RESOLUTION, SMALL, TEXT, WIDTH, named
from mbsym.report.unit_text import labelled

#: Inches: the first panel of a coordinate, further ones, the counts, a line of the legend.
FIRST, FURTHER, COUNTS, LINE = 2.1, 1.25, 0.75, 0.155
#: Coordinates that are drawn.
MOST_PANELS = 3

STABLE, UNSTABLE, OPEN = "#225588", "#cc6677", "#777777"
_STYLES: dict[str, Any] = {
    "stable": {"color": STABLE, "linestyle": "-"},
    "unstable": {"color": UNSTABLE, "linestyle": (0, (4, 2))},
    "undecided, or not proved throughout": {"color": OPEN, "linestyle": (0, (1, 1.5))},
}
_MARKS = {
    Event.FOLD: "o",
    Event.PITCHFORK: "^",
    Event.TRANSCRITICAL: "s",
    Event.STEEP: "v",
    Event.ISOLATED: "x",
    Event.DEGENERATE: "D",
}
_DARK = "#1a1a1a"


def branch_figure(system: System, found: Branches, language: Language, formats: Sequence[str]) -> dict[str, bytes]:
    """``branches.svg``, ``branches.pdf`` and ``branches.png``, those that are asked for."""
    ordered = sorted(formats, key=lambda kind: kind != "png")
    return pictures({"branches": lambda: _drawn(system, found, language)}, ordered)


def _drawn(system: System, found: Branches, language: Language) -> Figure:
    shown = found.coordinates[:MOST_PANELS]
    heights = [FIRST, *[FURTHER] * (len(shown) - 1), COUNTS] if shown else [COUNTS]
    used: dict[str, Any] = {}
    figure = Figure(figsize=(WIDTH, sum(heights) + 0.6), dpi=RESOLUTION, layout="constrained")
    panels = figure.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    for axes, name in zip(panels, shown, strict=False):
        _coordinate(axes, system, found, name, used)
    _counts(panels[-1], found, language)
    for axes in panels:
        axes.grid(False)
        axes.tick_params(labelsize=SMALL, length=2.5, width=0.6)
        for side in axes.spines.values():
            side.set_visible(True)
            side.set_linewidth(0.6)
        _lines(axes, found, used)
    panels[-1].set_xlim(float(found.axis.low), float(found.axis.high))
    name = found.axis.name
    panels[-1].set_xlabel(labelled(named(LatexNames([name]), name), unit_of(system, name)), fontsize=TEXT)
    entries = [(handle, language.say(words, "branches of equilibria")) for words, handle in used.items()]
    figure.set_figheight(sum(heights) + 0.6 + LINE * len(entries))
    if entries:
        handles, labels = zip(*entries, strict=True)
        figure.legend(
            handles, labels, loc="outside lower left", fontsize=SMALL, frameon=False, handlelength=2.2,
            labelspacing=0.35, borderaxespad=0.2,
        )  # fmt: skip
    return figure


def _coordinate(axes: Axes, system: System, found: Branches, name: str, used: dict[str, Any]) -> None:
    k = found.coordinates.index(name)
    angular = False
    for piece in found.pieces:
        equilibrium = found.intervals[piece.interval].equilibria[piece.number]
        if equilibrium.coordinates_of or name not in [x.name for x in equilibrium.values]:
            continue
        k = [x.name for x in equilibrium.values].index(name)
        angular = angular or equilibrium.values[k].angle
        kind = style_of(found, piece)
        style = _STYLES[kind]
        used.setdefault(kind, Line2D([], [], linewidth=1.3, **style))
        for xs, ys in _unbroken(piece, k, equilibrium.values[k].angle):
            axes.plot(xs, ys, linewidth=1.3, zorder=2, **style)
    for critical in found.criticals:
        if critical.balance is False:
            continue
        p = float(enclosure(critical.number).mid())
        for one in critical.meetings or ():
            values = {x.name: x for x in one.values}
            event = one.named.event
            if event is Event.REGULAR or one.coordinates_of or name not in values:
                continue
            style = {"linestyle": "none", "marker": _MARKS[event], "markersize": 4, "color": _DARK, "zorder": 3}
            style |= {"markerfacecolor": "white", "markeredgewidth": 0.8}
            used.setdefault(EVENTS[event], Line2D([], [], **style))
            y = values[name].value
            ys = [y, -y] if values[name].angle and abs(abs(y) - math.pi) < 1e-9 else [y]
            axes.plot([p] * len(ys), ys, **style)
    axes.set_ylabel(labelled(named(LatexNames([name]), name), unit_of(system, name)), fontsize=TEXT)
    if angular:
        axes.set_ylim(-math.pi * 1.04, math.pi * 1.04)
        axes.set_yticks([-math.pi, -math.pi / 2, 0, math.pi / 2, math.pi])
        axes.set_yticklabels([r"$-\pi$", r"$-\pi/2$", "0", r"$\pi/2$", r"$\pi$"])
    else:
        axes.yaxis.set_major_locator(MaxNLocator(5))


def style_of(found: Branches, piece: Piece) -> str:
    """How a piece is drawn: only what is proved for the whole interval is solid or dashed."""
    word = found.verdict(piece).word
    if not piece.throughout or word.open:
        return "undecided, or not proved throughout"
    return "stable" if found.verdict(piece).stable else "unstable"


def _unbroken(piece: Piece, k: int, angle: bool) -> Iterator[tuple[list[float], list[float]]]:
    """Points of a piece; angles within half a turn, broken where they leave it, pi drawn on both edges."""
    xs, ys = list(piece.parameter), [q[k] for q in piece.values]
    if not angle:
        yield xs, ys
        return
    turned = [math.remainder(y, 2 * math.pi) for y in ys]
    if all(abs(abs(y) - math.pi) < 1e-6 for y in turned):
        yield xs, [math.pi] * len(xs)
        yield xs, [-math.pi] * len(xs)
        return
    start = 0
    for i in range(1, len(xs) + 1):
        if i == len(xs) or abs(turned[i] - turned[i - 1]) > math.pi:
            yield xs[start:i], turned[start:i]
            start = i


def _counts(axes: Axes, found: Branches, language: Language) -> None:
    top = max((len(one.equilibria) for one in found.intervals), default=1)
    for one in found.intervals:
        low, high = (float(enclosure(x).mid()) for x in (one.low, one.high))
        style = "-" if one.constant else (0, (1, 1.5))
        axes.plot([low, high], [len(one.equilibria)] * 2, color=_DARK, linewidth=1.2, linestyle=style)
        axes.fill_between([low, high], 0, one.stable, color=STABLE, alpha=0.35, linewidth=0)
    axes.set_ylim(0, top * 1.15 + 0.5)
    axes.yaxis.set_major_locator(MaxNLocator(3, integer=True))
    axes.set_ylabel(language.say("equilibria"), fontsize=SMALL)


def _lines(axes: Axes, found: Branches, used: dict[str, Any]) -> None:
    """Where there are infinitely many equilibria at one value: a vertical line."""
    for one in found.criticals:
        if one.continuum:
            style: dict[str, Any] = {"color": _DARK, "linewidth": 0.8, "linestyle": (0, (1, 2))}
            used.setdefault(EVENTS[Event.CONTINUUM], Line2D([], [], **style))
            axes.axvline(float(enclosure(one.number).mid()), zorder=1, **style)
