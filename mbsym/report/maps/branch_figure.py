"""The bifurcation diagram: coordinates of equilibria over a parameter, stable solid, unstable dashed, open dotted.

Below stands how many equilibria there are, and how many of them are stable.  It is as wide as a column of a paper.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from mbsym.algebra.certainty import Certainty
from mbsym.maps.branches_events import Event
from mbsym.maps.branches_result import Branches, Piece
from mbsym.maps.mapping import float_of
from mbsym.model.system import System
from mbsym.report.language import Language
from mbsym.report.maps.frame import DARK, LINE, SMALL, TEXT, axis_label, framed, legend, started
from mbsym.report.maps.words import INTERRUPTED

#: Inches: the first panel of a coordinate, further ones, the counts.
FIRST, FURTHER, COUNTS = 2.1, 1.25, 0.75
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


def bifurcations(system: System, branches: Branches, language: Language) -> Figure:
    """Branches coordinate by coordinate, and how many there are."""
    shown = branches.coordinates[:MOST_PANELS]
    heights = [FIRST, *[FURTHER] * (len(shown) - 1), COUNTS] if shown else [COUNTS]
    used: dict[str, Any] = {}
    figure = started(sum(heights) + 0.6, 0, branches.values)
    panels = figure.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    for axes, name in zip(panels, shown, strict=False):
        _coordinate(axes, system, branches, name, used)
    _counts(panels[-1], branches, language)
    for axes in panels:
        framed(axes)
        _lines(axes, branches, used)
    panels[-1].set_xlim(float(branches.axes[0].low), float(branches.axes[0].high))
    panels[-1].set_xlabel(axis_label(system, branches.axes[0].name), fontsize=TEXT)
    entries = [(handle, language.say(words, "branches of equilibria")) for words, handle in used.items()]
    if branches.interrupted:
        entries.append(("!", language.say(INTERRUPTED)))
    figure.set_figheight(figure.get_figheight() + LINE * len(entries))
    legend(figure, entries)
    return figure


def _coordinate(axes: Axes, system: System, branches: Branches, name: str, used: dict[str, Any]) -> None:
    k = branches.coordinates.index(name)
    angular = False
    for piece in branches.pieces:
        equilibrium = branches.equilibria(branches.regions[piece.interval])[piece.number]
        if equilibrium.coordinates_of or name not in [x.name for x in equilibrium.values]:
            continue
        k = [x.name for x in equilibrium.values].index(name)
        angular = angular or equilibrium.values[k].angle
        kind = style_of(branches, piece)
        style = _STYLES[kind]
        used.setdefault(kind, Line2D([], [], linewidth=1.3, **style))
        for xs, ys in _unbroken(piece, k, equilibrium.values[k].angle):
            axes.plot(xs, ys, linewidth=1.3, zorder=2, **style)
    for critical in branches.criticals:
        there = branches.critical(critical)
        p = float_of(critical.sample)
        for meeting in (there.meetings or ()) if there.balance is not False else ():
            values = {x.name: x for x in meeting.values}
            event = meeting.named.event
            if event is Event.REGULAR or meeting.coordinates_of or name not in values:
                continue
            style = {"linestyle": "none", "marker": _MARKS[event], "markersize": 4, "color": DARK, "zorder": 3}
            style |= {"markerfacecolor": "white", "markeredgewidth": 0.8}
            used.setdefault(event.told, Line2D([], [], **style))
            y = values[name].value
            ys = [y, -y] if values[name].angle and abs(abs(y) - math.pi) < 1e-9 else [y]
            axes.plot([p] * len(ys), ys, **style)
    axes.set_ylabel(axis_label(system, name), fontsize=TEXT)
    if angular:
        axes.set_ylim(-math.pi * 1.04, math.pi * 1.04)
        axes.set_yticks([-math.pi, -math.pi / 2, 0, math.pi / 2, math.pi])
        axes.set_yticklabels([r"$-\pi$", r"$-\pi/2$", "0", r"$\pi/2$", r"$\pi$"])
    else:
        axes.yaxis.set_major_locator(MaxNLocator(5))


def style_of(branches: Branches, piece: Piece) -> str:
    """How a piece is drawn: only what is proved for the whole interval is solid or dashed."""
    word = branches.verdict(piece).word
    if not piece.throughout or word.open:
        return "undecided, or not proved throughout"
    return "stable" if branches.verdict(piece).stable else "unstable"


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


def _counts(axes: Axes, branches: Branches, language: Language) -> None:
    counts = [(interval, interval.counted) for interval in branches.intervals if interval.counted is not None]
    for cell, counted in counts:
        low, high = map(float_of, branches.ends(cell))
        style = "-" if cell.certainty is Certainty.PROVED else (0, (1, 1.5))
        axes.plot([low, high], [counted.count] * 2, color=DARK, linewidth=1.2, linestyle=style)
        axes.fill_between([low, high], 0, counted.stable, color=STABLE, alpha=0.35, linewidth=0)
    axes.set_ylim(0, max((counted.count for _, counted in counts), default=1) * 1.15 + 0.5)
    axes.yaxis.set_major_locator(MaxNLocator(3, integer=True))
    axes.set_ylabel(language.say("equilibria"), fontsize=SMALL)


def _lines(axes: Axes, branches: Branches, used: dict[str, Any]) -> None:
    """Where there are infinitely many equilibria at one value: a vertical line."""
    for critical in branches.criticals:
        if branches.critical(critical).continuum:
            style: dict[str, Any] = {"color": DARK, "linewidth": 0.8, "linestyle": (0, (1, 2))}
            used.setdefault(Event.CONTINUUM.told, Line2D([], [], **style))
            axes.axvline(float_of(critical.sample), zorder=1, **style)
