"""The picture of a map: cells coloured by what is said there, borders with letters, a legend in words.

Over one parameter it is a bar, over two a plane, over three small planes on pages, each with the value of the third
parameter at which it is drawn, and between which values it is the same.  It is as wide as a column of a paper; what a
colour tells apart its lightness or a hatch does, too.  Borders at which nothing changes are left out.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from string import ascii_lowercase
from textwrap import fill
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator

from mbsym.algebra.arrangements import Arrangement, polyline
from mbsym.algebra.arrangements.arrangement import Branches as Drawn
from mbsym.algebra.plane.line import Line
from mbsym.formulas.latex import LatexNames
from mbsym.maps.boxes import BoxMap
from mbsym.maps.branches_result import Branches
from mbsym.maps.mapping import float_of
from mbsym.maps.result import Cell, Lack, Map, Of
from mbsym.maps.slices import Picture, Stack, stands_out
from mbsym.model.quantities import unit_of
from mbsym.model.system import System
from mbsym.report.figures.drawing import pictures, symbol
from mbsym.report.language import Language
from mbsym.report.maps.branch_figure import bifurcations
from mbsym.report.maps.frame import (
    DARK,
    EDGE,
    FINE,
    NONE,
    SMALL,
    TEXT,
    WHITE,
    WIDEST,
    Look,
    axis_label,
    equal,
    framed,
    legend,
    look_of_count,
    look_of_degree,
    look_of_roots,
    named,
    number,
    started,
)
from mbsym.report.maps.words import INTERRUPTED, border_words, cell_words, marked, percent, stem
from mbsym.report.unit_text import pretty

XY = tuple[float, float]

#: Inches: what a plane, a bar and a row of small planes take.
PLANE, BAR, ROW = 3.25, 1.04, 1.45
#: Points along a branch over a strip, for what is filled.
NODES = 28
#: Arcs deviate by no more than this part of the box.
TOLERANCE = 4e-4
#: A number is written into a region that is so wide, as a part of the plane, and of a small one.
ROOM, SMALL_ROOM = 0.045, 0.12
#: Letters beside a line of the legend.
MOST_BESIDE = 3
#: Small planes beside each other, and rows of them on one page.
ACROSS, ROWS = 2, 3

_DASHES: Any = (0, (3, 2))


def map_figure(system: System, chart: Map, language: Language, formats: Sequence[str]) -> dict[str, bytes]:
    """``map.svg`` and others (see ``stem``), those that are asked for; of slices ``map-2.svg``, ..., too.

    Nothing where no slice has a map.
    """
    ordered = sorted(formats, key=lambda kind: kind != "png")  # a PNG is drawn before others set their resolution
    if isinstance(chart, Branches):
        return pictures({stem(chart): partial(bifurcations, system, chart, language)}, ordered)
    told, shown, size = lettered(chart), panels(chart), ACROSS * ROWS
    pages = [shown[k : k + size] for k in range(0, len(shown), size)]
    drawings = (partial(_page, system, chart, page, told, language) for page in pages)
    return pictures(dict(zip(page_names(chart), drawings, strict=True)), ordered)


def page_names(chart: Map) -> list[str]:
    """The files without their endings: map, map-2, ..."""
    count, first = -(-len(panels(chart)) // (ACROSS * ROWS)), stem(chart)
    return [first if k == 0 else f"{first}-{k + 1}" for k in range(count)]


def panels(chart: Map) -> list[tuple[Picture | None, Map]]:
    """The map, or the slices that stand for the pictures of a stack."""
    if not isinstance(chart, Stack):
        return [(None, chart)]
    shown = [(picture, chart.layers[picture.shown].plane) for picture in chart.pictures]
    return [(picture, plane) for picture, plane in shown if plane is not None]


def look(chart: Map, cell: Cell) -> Look:
    """Colour and hatch of a region."""
    if (counted := cell.counted) is not None:
        return look_of_count(counted.count, chart.counts, counted.throughout or not counted.stable)
    judged = cell.judged
    if judged is None:
        return WHITE if cell.lack in (Lack.NOT_REACHED, Lack.UNPROVED) else NONE
    if chart.of is Of.SIGNATURE and judged.degree is not None:
        return look_of_degree(judged.degree)
    return look_of_roots(judged.verdict.word, judged.right, judged.real_right)


# --- letters ----------------------------------------------------------------------------------------------------------


def lettered(chart: Map) -> dict[str, str]:
    """A letter for every curve of which an arc is drawn, and every point of a line, by its ``mark_name``."""
    names = dict.fromkeys(mark_name(chart, plane, k) for _, plane in panels(chart) for k in sorted(marks(plane)))
    order = sorted(names, key=lambda name: (not name.isdigit(), int(name) if name.isdigit() else 0))
    return dict(zip(order, letters([axis.name for axis in chart.axes], len(order)), strict=True))


def marks(plane: Map) -> set[int]:
    """The curves, by number, of which an arc is drawn; of a line the points."""
    shown = [border for border in plane.borders if plane.drawn(border)]
    if isinstance(plane.ground, Line):
        return {cell.number for cell in shown}
    return {k for cell in shown for k in plane.place(cell).factors}


def mark_name(chart: Map, plane: Map, k: int) -> str:
    """Its number where it belongs to all slices, its polynomial where it was found in one."""
    whole = isinstance(plane.ground, Line) or k < len(chart.boundaries.factors)
    return str(k) if whole else str(plane.boundaries.factors[k])


def letters(taken: Collection[str], count: int) -> list[str]:
    """So many of a, b, ..., z, a1, ..., none of which is ``taken``: an axis may be called so."""
    named = (f"{letter}{round_ or ''}" for round_ in itertools.count() for letter in ascii_lowercase)
    return list(itertools.islice((name for name in named if name not in taken), count))


# --- a page -----------------------------------------------------------------------------------------------------------


def _page(
    system: System, chart: Map, page: Sequence[tuple[Picture | None, Map]], told: Mapping[str, str], language: Language
) -> Figure:
    small = isinstance(chart, Stack)
    names = [{k: told[mark_name(chart, plane, k)] for k in sorted(marks(plane))} for _, plane in page]
    entries = _entries([(plane, own) for (_, plane), own in zip(page, names, strict=True)], language)
    if any(slice_picture is not None and slice_picture.unseen for slice_picture, _ in page):
        entries.append(("*", language.say("but for single values not looked at")))
    if chart.interrupted:
        entries.append(("!", language.say(INTERRUPTED)))
    rows = -(-len(page) // ACROSS)
    body = ROW * rows + 0.3 if small else BAR if isinstance(chart.ground, Line) else PLANE
    figure = started(body, len(entries), chart.values, near=small)
    grid = figure.subplots(rows, ACROSS if small else 1, squeeze=False)
    for place, axes in enumerate(grid.flat):
        if place >= len(page):
            axes.set_axis_off()
            continue
        picture, plane = page[place]
        _Drawing(axes, system, plane, names[place], FINE if small else SMALL, SMALL_ROOM if small else ROOM).draw()
        if isinstance(chart, Stack) and picture is not None:
            last = place + ACROSS >= len(page)
            axes.set_xlabel(axes.get_xlabel() if last else "", fontsize=TEXT - 1, labelpad=1)
            axes.set_ylabel("" if place % ACROSS else axes.get_ylabel(), fontsize=TEXT - 1, labelpad=1)
            axes.tick_params(labelleft=not place % ACROSS, labelbottom=last)
            axes.xaxis.set_major_locator(MaxNLocator(4))
            axes.yaxis.set_major_locator(MaxNLocator(4))
            axes.set_title(
                title(system, chart, picture), fontsize=SMALL - 0.5, pad=2.5, loc="left", linespacing=1.05
            )  # fmt: skip
    legend(figure, entries)
    return figure


def title(system: System, stack: Stack, picture: Picture) -> str:
    """``C = 7/6`` and, on a second line, between which values the picture is the same."""
    symbol = named(LatexNames([stack.axis.name]), stack.axis.name)
    unit = pretty(unit_of(system, stack.axis.name))
    first = f"{symbol} {equal(stack.layers[picture.shown].z)}" + (f" {unit}" if unit else "")
    if len(picture.layers) == 1 and stack.layers[picture.shown].critical:
        return first
    low, closed_low, high, closed_high = stack.ends(picture)
    relations = ("\u2264" if closed_low else "<", "\u2264" if closed_high else "<")
    star = "*" if picture.unseen else ""
    return f"{first}\n{number(low)} {relations[0]} {symbol} {relations[1]} {number(high)}{star}"


# --- one plane, or one bar --------------------------------------------------------------------------------------------


@dataclass
class _Drawing:
    """A map in axes of a figure; ``letters`` are the letters of its marks, ``size`` that of small text.

    Numbers stand in regions that are wider than ``room``, as a part of the plane.
    """

    axes: Axes
    system: System
    map: Map
    letters: Mapping[int, str]
    size: float
    room: float
    taken: list[XY] = field(default_factory=list)  # where something is written, in parts of the plane

    def draw(self) -> None:
        framed(self.axes, self.size)
        (x0, x1), (y0, y1) = self.span
        self.axes.set_xlim(x0, x1)
        self.axes.set_ylim(y0, y1)
        self.axes.set_xlabel(axis_label(self.system, self.map.axes[0].name), fontsize=TEXT)
        self._fill()
        if isinstance(self.map.ground, Line):
            self.axes.set_yticks([])
            self._points()
            return
        self.axes.xaxis.set_major_locator(MaxNLocator(5))
        self.axes.yaxis.set_major_locator(MaxNLocator(6))
        self.axes.set_ylabel(axis_label(self.system, self.map.axes[1].name), fontsize=TEXT)
        if isinstance(self.map.ground, Arrangement):
            self._arcs()
            self._corners()
            self._numbers()
            self._letters()

    @cached_property
    def span(self) -> tuple[XY, XY]:
        """From where to where the axes go."""
        ground = self.map.ground
        if isinstance(ground, Line):
            return (float_of(ground.low), float_of(ground.high)), (0.0, 1.0)
        box = ground.box
        return (float(box.x0), float(box.x1)), (float(box.y0), float(box.y1))

    @cached_property
    def branches(self) -> Drawn:
        return Drawn(self.map.arrangement)

    @cached_property
    def lines(self) -> dict[int, Sequence[XY]]:
        """The drawn arcs, by number."""
        drawn = [arc for arc in self.map.arcs if self.map.drawn(arc)]
        return {cell.number: polyline(self.map.arrangement, self.map.place(cell), TOLERANCE) for cell in drawn}

    def _fill(self) -> None:
        """All regions of one look at once."""
        paths: dict[Look, list[list[XY]]] = {}
        for cell in self.map.regions:
            paths.setdefault(look(self.map, cell), []).extend(self._rings(cell))
        for seen, rings in paths.items():
            path = Path.make_compound_path(*(Path(ring, closed=True) for ring in (([*x, x[0]]) for x in rings)))
            # an edge of the same colour: no seams between strips
            patch = {"facecolor": seen.colour, "edgecolor": seen.colour, "linewidth": 0.4, "zorder": 0.5}
            self.axes.add_patch(PathPatch(path, **patch))
            if seen.hatch:
                hatch = {"edgecolor": hatch_of(seen), "linewidth": 0, "hatch": seen.hatch, "zorder": 0.6}
                self.axes.add_patch(PathPatch(path, facecolor="none", **hatch))

    def _rings(self, cell: Cell) -> list[list[XY]]:
        """The outline of a region: of an arrangement strip by strip, between the branches below and above."""
        place = self.map.place(cell)
        if isinstance(self.map.ground, Line):
            low = self.span[0][0] + sum(size for size, _ in self.map.areas[: cell.number])
            return [_rectangle(low, low + self.map.areas[cell.number][0], 0, 1)]
        if not isinstance(self.map.ground, Arrangement):
            box = place.box
            return [_rectangle(float(box.x0), float(box.x1), float(box.y0), float(box.y1))]
        rings = []
        for strip, k in place.cells:
            below, above = [], []
            left, right = self.branches.bounds(strip)
            for i in range(NODES + 1):
                t = math.pi * i / NODES
                x, ys = self.branches.at(strip, min(max(t, 1e-3), math.pi - 1e-3))
                x = left if i == 0 else right if i == NODES else x
                below.append((x, ys[k]))
                above.append((x, ys[k + 1]))
            rings.append([*below, *above[::-1]])
        return rings

    def _points(self) -> None:
        """Lines through a bar, each with its letter."""
        for k, letter in self.letters.items():
            x = float_of(self.map.corners[k].sample)
            self.axes.axvline(x, color=DARK, linewidth=0.9)
            self.axes.annotate(
                letter, (x, 1), xytext=(0, 2), textcoords="offset points", fontsize=SMALL, style="italic", ha="center"
            )

    def _arcs(self) -> None:
        for k, line in self.lines.items():
            arc = self.map.arcs[k]
            style: dict[str, Any] = {"color": DARK, "linewidth": 0.8, "linestyle": _DASHES}
            if self.map.separates(arc):
                open_side = any(cell is not None and cell.lack is not None for cell in self.map.beside(arc))
                style = {"color": EDGE if open_side else DARK, "linewidth": 0.7 if open_side else 0.9}
            xs, ys = zip(*line, strict=True)
            self.axes.plot(xs, ys, solid_capstyle="round", zorder=2, **style)

    def _corners(self) -> None:
        """Points in which drawn arcs meet, and those that differ from what is around them."""
        points = []
        for cell, corner in zip(self.map.corners, self.map.arrangement.corners, strict=True):
            meeting = corner.kind != "edge" and sum(k in self.lines for k in corner.arcs) > 2
            if meeting or stands_out(self.map, cell):
                points.append(corner.point.floats())
        if points and self.map.of is not Of.EQUILIBRIA:
            xs, ys = zip(*points, strict=True)
            style: dict[str, Any] = {
                "linestyle": "none",
                "marker": "o",
                "markersize": 2.6,
                "color": DARK,
                "markeredgewidth": 0,
            }
            self.axes.plot(xs, ys, zorder=3, **style)

    def _numbers(self) -> None:
        """Roots to the right, or equilibria and stable ones, in the middle of the widest part of regions with room."""
        (x0, x1), (y0, y1) = self.span
        for cell in self.map.regions:
            text = cell_text(self.map, cell)
            best, place = 0.0, (0.0, 0.0)
            for strip, k in self.map.place(cell).cells if text else ():
                left, right = self.branches.bounds(strip)
                x, ys = self.branches.at(strip, math.pi / 2)
                room = min((right - left) / (x1 - x0), (ys[k + 1] - ys[k]) / (y1 - y0))
                if room > best:
                    best, place = room, (x, (ys[k] + ys[k + 1]) / 2)
            if best <= self.room * (1 if len(text) < 3 else 1.5):
                continue
            self.taken.append(self._unit(place))
            seen = look(self.map, cell)
            behind = {"boxstyle": "round,pad=0.12", "facecolor": seen.colour, "edgecolor": "none"}
            self.axes.text(
                *place, text, fontsize=self.size - (len(text) > 2), color=DARK if seen.light else "white",
                ha="center", va="center", zorder=3, bbox=behind if seen.hatch else None,
                path_effects=[withStroke(linewidth=1.6, foreground=seen.colour)],
            )  # fmt: skip

    def _letters(self) -> None:
        """Each letter once, on an arc of its curve, at a place away from numbers, corners and the letters before it."""
        taken = self.taken
        taken += [
            self._unit(corner.sample.floats()) for corner in self.map.corners if len(self.map.place(corner).arcs) > 2
        ]
        for k, letter in self.letters.items():
            on = [self.lines[cell.number] for cell in marked(self.map, k)[0] if cell.number in self.lines]
            spots = [self._unit(p) for line in on for p in _along(line)]
            inside = [p for p in spots if min(*p, 1 - p[0], 1 - p[1]) > 0.04] or spots
            spot = max(inside, key=lambda p: min((math.dist(p, other) for other in taken), default=1.0))
            taken.append(spot)
            ring = {"boxstyle": "circle,pad=0.16", "facecolor": "white", "edgecolor": DARK, "linewidth": 0.4}
            self.axes.text(
                *spot, letter, transform=self.axes.transAxes, fontsize=self.size, style="italic",
                ha="center", va="center", zorder=4, bbox=ring,
            )  # fmt: skip

    def _unit(self, point: XY) -> XY:
        """As parts of the plane."""
        (x0, x1), (y0, y1) = self.span
        return (point[0] - x0) / (x1 - x0), (point[1] - y0) / (y1 - y0)


def _rectangle(x0: float, x1: float, y0: float, y1: float) -> list[XY]:
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def _along(line: Sequence[XY]) -> list[XY]:
    """Points spread over a polyline, its ends left out."""
    if len(line) == 2:
        (a, b), (c, d) = line
        return [(a + (c - a) * s, b + (d - b) * s) for s in (0.2, 0.35, 0.5, 0.65, 0.8)]
    middle = line[1:-1]
    return list(middle[:: max(1, len(middle) // 24)])


def cell_text(chart: Map, cell: Cell) -> str:
    """What is written into a region: roots to the right; ``24 (4)`` equilibria, of them stable."""
    if (counted := cell.counted) is not None:
        return f"{counted.count} ({counted.stable})"
    return str(cell.right) if chart.of is Of.STABILITY and cell.right else ""


# --- the legend -------------------------------------------------------------------------------------------------------


def hatch_of(seen: Look) -> str:
    """The colour of a hatch."""
    return "#9a9a9a" if seen == NONE else "#5e1830" if seen.hatch == "xxxx" else "#ffffff"


def _entries(shown: Sequence[tuple[Map, Mapping[int, str]]], language: Language) -> list[tuple[Any, str]]:
    """The legend of a map, or of its slices, each with the letters of its marks.

    It says what colours mean, in the order of area (of numbers of equilibria), then what curves are.
    """
    by_words: dict[str, tuple[tuple[float, ...], Look]] = {}
    by_condition: dict[str, list[str]] = {}
    named_letters: set[str] = set()
    dashed = numbered = False
    for chart, told in shown:
        for region, (area, _) in zip(chart.regions, chart.areas, strict=True):
            words = language.say(cell_words(chart, region))
            if isinstance(chart, BoxMap) and region.lack is Lack.UNPROVED:
                words = f"{language.say('white: nothing is proved')} ({language.say(percent(chart))})"
            (before, *_), _ = by_words.get(words, ((0.0,), NONE))
            order: tuple[float, ...] = (before - area,)
            if chart.of is Of.EQUILIBRIA:
                order = (1,) if region.counted is None else (-region.counted.count, -region.counted.stable)
            by_words[words] = order, look(chart, region)
        for k, letter in told.items():
            if letter not in named_letters:  # of slices, the first tells what a curve is
                named_letters.add(letter)
                words = language.say(border_words(chart, k, symbol))
                if isinstance(chart.ground, Line):
                    words = f"{float_of(chart.corners[k].sample):.6g}   {words}"
                by_condition.setdefault(words, []).append(letter)
        if isinstance(chart.ground, Arrangement) and chart.of is Of.STABILITY:
            numbered |= any(cell_text(chart, cell) for cell in chart.regions)
        dashed |= any(chart.drawn(arc) and chart.singles_out(arc) for arc in chart.arcs)
    entries: list[tuple[Any, str]] = []
    for words, (_, seen) in sorted(by_words.items(), key=lambda item: (item[1][1] == WHITE, item[1][0])):
        edge = hatch_of(seen) if seen.hatch or not seen.light else EDGE
        style: dict[str, Any] = {
            "facecolor": seen.colour,
            "edgecolor": edge,
            "linewidth": 0.3,
            "hatch": seen.hatch or None,
        }
        entries.append((Patch(**style), words))
    if numbered:
        entries.append(("2", language.say("number of roots with positive real part")))
    for words, names in by_condition.items():
        handle = ", ".join(names)
        few = len(names) <= MOST_BESIDE  # more letters have no room beside the words
        entries.append((handle if few else "", _filled(words if few else f"{handle}: {words}")))
    if dashed:
        line = Line2D([], [], color=DARK, linewidth=0.8, linestyle=_DASHES)
        entries.append((line, language.say("dashed: another verdict on the curve alone")))
    return entries


def _filled(words: str) -> str:
    """In lines; of a formula only what is seen of it has a width, and none is cut."""
    formulas = iter(re.findall(_FORMULA, words))
    return re.sub("\ue000", lambda _: next(formulas), fill(re.sub(_FORMULA, "\ue000", words), WIDEST))


_FORMULA = r"\$[^$]*\$"
