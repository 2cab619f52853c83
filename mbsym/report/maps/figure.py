"""The picture of a map: regions coloured by verdict, smooth arcs labelled by the condition they come from, corners.

It is as wide as a column of a paper, its legend is in words, and what is told apart by a colour is told apart by its
lightness or a hatch, too.  Arcs at which nothing changes are left out.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Mapping, Sequence
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

from mbsym.algebra.arrangements import polyline
from mbsym.algebra.arrangements.drawing import Branches
from mbsym.formulas.latex import LatexNames
from mbsym.maps.result import Of, PlaneMap, Shown, Standing, Stratum
from mbsym.maps.seen import drawn, stands_out
from mbsym.model.quantities import unit_of
from mbsym.model.system import System
from mbsym.report.figures.drawing import pictures
from mbsym.report.language import Language
from mbsym.report.maps.verdict_colours import NONE, Look, look_of_degree, look_of_roots
from mbsym.report.maps.words import INTERRUPTED, arcs_of, condition_words, look_words, onset_words, telling
from mbsym.report.unit_text import labelled

XY = tuple[float, float]

#: Inches: the width of a column, and the height of the plane.
WIDTH, HEIGHT = 3.4, 2.9
#: Points.
TEXT, SMALL = 8, 7
#: Pixels per inch: lines are thin.
RESOLUTION = 300
#: Points along a branch over a strip, for what is filled.
NODES = 28
#: Arcs deviate by no more than this part of the box.
TOLERANCE = 4e-4

#: A number is written into a region that is so wide, as a part of the plane.
ROOM = 0.045

#: Letters in a line of the legend.
WIDEST = 52

_DARK, _EDGE = "#1a1a1a", "#777777"
_DASHES: Any = (0, (3, 2))


def map_figure(system: System, found: PlaneMap, language: Language, formats: Sequence[str]) -> dict[str, bytes]:
    """``map.svg``, ``map.pdf`` and ``map.png``, those that are asked for."""
    ordered = sorted(formats, key=lambda kind: kind != "png")  # a PNG is drawn before others set their resolution
    return pictures({"map": lambda: _drawn(system, found, language)}, ordered)


def look(found: Shown, stratum: Stratum) -> Look:
    """Colour and hatch of a region."""
    judged = stratum.judged
    if judged is None:
        return NONE if stratum.standing is not Standing.NOT_REACHED else Look("#ffffff")
    if found.of is Of.SIGNATURE and judged.degree is not None:
        return look_of_degree(judged.degree)
    return look_of_roots(judged.verdict.word, judged.right, judged.real_right)


def _drawn(system: System, found: PlaneMap, language: Language) -> Figure:
    told = lettered(found)
    entries = _entries(found, told, language)
    height = HEIGHT + 0.35 + 0.155 * len(entries)
    figure = Figure(figsize=(WIDTH, height), dpi=RESOLUTION, layout="constrained")
    axes = figure.subplots()
    draw_plane(axes, system, found, told)
    legend(figure, entries)
    return figure


def legend(figure: Figure, entries: Sequence[tuple[Any, str]]) -> None:
    """(What is shown, what it means) below a figure."""
    handles, told = zip(*entries, strict=True)
    figure.legend(
        handles,
        told,
        loc="outside lower left",
        fontsize=SMALL,
        frameon=False,
        handlelength=1.6,
        handleheight=1.0,
        labelspacing=0.35,
        borderaxespad=0.2,
        handler_map={str: Letter()},
    )


def draw_plane(
    axes: Axes, system: System, found: PlaneMap, told: Mapping[int, str], size: float = SMALL, room: float = ROOM
) -> None:
    """A map in axes of a figure; ``told`` are the letters of its curves, ``size`` that of small text.

    Numbers stand in regions that are wider than ``room``, as a part of the plane.
    """
    box = found.arrangement.box
    axes.grid(False)
    axes.set_xlim(float(box.x0), float(box.x1))
    axes.set_ylim(float(box.y0), float(box.y1))
    axes.xaxis.set_major_locator(MaxNLocator(5))
    axes.yaxis.set_major_locator(MaxNLocator(6))
    for side in ("top", "right"):
        axes.spines[side].set_visible(True)
    axes.tick_params(labelsize=size, length=2.5, width=0.6)
    for spine in axes.spines.values():
        spine.set_linewidth(0.6)
    across, up = labels(system, found)
    axes.set_xlabel(across, fontsize=TEXT)
    axes.set_ylabel(up, fontsize=TEXT)
    branches = Branches(found.arrangement)
    for stratum in found.regions:
        _fill(axes, found, branches, stratum)
    lines = {one.number: polyline(found.arrangement, there, TOLERANCE) for one, there in _arcs(found)}
    for stratum, _ in _arcs(found):
        style = _style(found, stratum)
        if style:
            xs, ys = zip(*lines[stratum.number], strict=True)
            axes.plot(xs, ys, solid_capstyle="round", **style)
    _corners(axes, found)
    _numbers(axes, found, branches, size, room)
    _letters(axes, found, told, lines, size)


def labels(system: System, found: PlaneMap) -> tuple[str, str]:
    """What stands along the axes."""
    names = LatexNames([axis.name for axis in found.section.axes])
    across, up = (labelled(named(names, x.name), unit_of(system, x.name)) for x in found.section.axes)
    return across, up


def named(names: LatexNames, name: str) -> str:
    """A name on an axis, as a formula where it is one."""
    symbol = names[name]
    return name.replace("$", r"\$") if "mathtt" in symbol.stem else f"${symbol}$"


def _arcs(found: PlaneMap) -> list[tuple[Stratum, Any]]:
    return list(zip(found.arcs, found.arrangement.arcs, strict=True))


def _fill(axes: Axes, found: PlaneMap, branches: Branches, stratum: Stratum) -> None:
    """A region, strip by strip: between the branches below and above."""
    shown = look(found, stratum)
    vertices: list[XY] = []
    codes: list[Any] = []
    for strip, cell in found.arrangement.regions[stratum.number].cells:
        below, above = [], []
        left, right = branches.bounds(strip)
        for k in range(NODES + 1):
            t = math.pi * k / NODES
            x, ys = branches.at(strip, min(max(t, 1e-3), math.pi - 1e-3))
            x = left if k == 0 else right if k == NODES else x
            below.append((x, ys[cell]))
            above.append((x, ys[cell + 1]))
        ring = [*below, *above[::-1]]
        vertices += [*ring, ring[0]]
        codes += [Path.MOVETO, *[Path.LINETO] * (len(ring) - 1), Path.CLOSEPOLY]
    path = Path(vertices, codes)
    # an edge of the same colour: no seams between strips
    axes.add_patch(PathPatch(path, facecolor=shown.colour, edgecolor=shown.colour, linewidth=0.4, zorder=0.5))
    if shown.hatch:
        hatched = PathPatch(
            path, facecolor="none", edgecolor=hatch_of(shown), linewidth=0, hatch=shown.hatch, zorder=0.6
        )
        axes.add_patch(hatched)


def hatch_of(shown: Look) -> str:
    """The colour of a hatch."""
    return "#9a9a9a" if shown == NONE else "#5e1830" if shown.hatch == "xxxx" else "#ffffff"


def _style(found: PlaneMap, arc: Stratum) -> dict[str, Any] | None:
    """How an arc is drawn; None where nothing changes at it."""
    if not drawn(found, arc):
        return None
    if found.separates(arc):
        open_side = any(one is not None and one.judged is None for one in found.beside(arc))
        return {"color": _EDGE if open_side else _DARK, "linewidth": 0.7 if open_side else 0.9, "zorder": 2}
    return {"color": _DARK, "linewidth": 0.8, "linestyle": _DASHES, "zorder": 2}


def _corners(axes: Axes, found: PlaneMap) -> None:
    """Points in which drawn arcs meet, and those that differ from what is around them."""
    points = []
    for stratum, corner in zip(found.corners, found.arrangement.corners, strict=True):
        lines = [k for k in corner.arcs if drawn(found, found.arcs[k])]
        inside = corner.kind != "edge"
        if (inside and len(lines) > 2) or stands_out(found, stratum):
            points.append(corner.point.floats())
    if points:
        xs, ys = zip(*points, strict=True)
        axes.plot(xs, ys, linestyle="none", marker="o", markersize=2.6, color=_DARK, markeredgewidth=0, zorder=3)


def lettered(found: PlaneMap) -> dict[int, str]:
    """A letter for every curve (by its number) of which an arc is drawn, in the order in which they are listed."""
    curves = sorted(drawn_curves(found))
    return dict(zip(curves, letters([axis.name for axis in found.section.axes], len(curves)), strict=True))


def drawn_curves(found: PlaneMap) -> set[int]:
    """The curves, by number, of which an arc is drawn."""
    return {k for one, there in _arcs(found) if _style(found, one) for k in there.factors}


def letters(taken: Collection[str], count: int) -> list[str]:
    """So many of a, b, ..., z, a1, ..., none of which is ``taken``: an axis may be called so."""
    named = (f"{letter}{round_ or ''}" for round_ in itertools.count() for letter in ascii_lowercase)
    return list(itertools.islice((name for name in named if name not in taken), count))


def _letters(
    axes: Axes, found: PlaneMap, told: Mapping[int, str], lines: Mapping[int, Sequence[XY]], points: float
) -> None:
    """Each letter once, on the longest arc of its curve, at a place away from the letters before it."""
    box = found.arrangement.box
    size = float(box.x1 - box.x0), float(box.y1 - box.y0)
    start = float(box.x0), float(box.y0)
    taken: list[XY] = []
    taken += [_unit(one.point.floats(), start, size) for one in found.arrangement.corners if len(one.arcs) > 2]
    for k, letter in told.items():
        on = [lines[one.number] for one, there in _arcs(found) if k in there.factors and _style(found, one)]
        places = [_unit(p, start, size) for line in on for p in _along(line)]
        inside = [p for p in places if min(*p, 1 - p[0], 1 - p[1]) > 0.04] or places
        place = max(inside, key=lambda p: min((math.dist(p, other) for other in taken), default=1.0))
        taken.append(place)
        axes.text(
            start[0] + place[0] * size[0],
            start[1] + place[1] * size[1],
            letter,
            fontsize=points,
            style="italic",
            ha="center",
            va="center",
            zorder=4,
            bbox={"boxstyle": "circle,pad=0.16", "facecolor": "white", "edgecolor": _DARK, "linewidth": 0.4},
        )


def _unit(point: XY, start: XY, size: XY) -> XY:
    return (point[0] - start[0]) / size[0], (point[1] - start[1]) / size[1]


def _along(line: Sequence[XY]) -> list[XY]:
    """Points spread over a polyline, its ends left out."""
    if len(line) == 2:
        (a, b), (c, d) = line
        return [(a + (c - a) * s, b + (d - b) * s) for s in (0.2, 0.35, 0.5, 0.65, 0.8)]
    middle = line[1:-1]
    return list(middle[:: max(1, len(middle) // 24)])


def _numbers(axes: Axes, found: PlaneMap, branches: Branches, points: float, least: float) -> None:
    """How many roots lie to the right, in the middle of the widest part of every unstable region with room for it."""
    if found.of is not Of.STABILITY:
        return
    box = found.arrangement.box
    width, height = float(box.x1 - box.x0), float(box.y1 - box.y0)
    for stratum in found.regions:
        if stratum.judged is None or not stratum.judged.right:
            continue
        best, place = 0.0, (0.0, 0.0)
        for strip, cell in found.arrangement.regions[stratum.number].cells:
            left, right = branches.bounds(strip)
            x, ys = branches.at(strip, math.pi / 2)
            room = min((right - left) / width, (ys[cell + 1] - ys[cell]) / height)
            if room > best:
                best, place = room, (x, (ys[cell] + ys[cell + 1]) / 2)
        if best > least:
            halo = [withStroke(linewidth=1.6, foreground=look(found, stratum).colour)]
            told = str(stratum.judged.right)
            axes.text(
                *place, told, fontsize=points, color="white", ha="center", va="center", path_effects=halo, zorder=3
            )


def _entries(found: PlaneMap, told: Mapping[int, str], language: Language) -> list[tuple[Any, str]]:
    return [*entries_of([(found, told)], language), *partial(found, language)]


def partial(found: Shown, language: Language) -> list[tuple[Any, str]]:
    """What a legend says of a map that was interrupted."""
    return [("!", language.say(INTERRUPTED))] if found.partial else []


def entries_of(shown: Sequence[tuple[PlaneMap, Mapping[int, str]]], language: Language) -> list[tuple[Any, str]]:
    """The legend of maps of one section or of its slices, each with the letters of its curves.

    It says what colours mean, in the order of area, then what curves are.
    """
    by_words: dict[str, tuple[float, Look]] = {}
    by_condition: dict[str, list[str]] = {}
    named_letters: set[str] = set()
    dashed = counted = False
    for found, told in shown:
        for one, (area, _) in zip(found.regions, found.areas, strict=True):
            words = look_words(found, one, language)
            by_words[words] = (by_words.get(words, (0.0, NONE))[0] + area, look(found, one))
        for k, letter in told.items():
            if letter not in named_letters:  # of slices, the first tells what a curve is
                named_letters.add(letter)
                condition = telling(found.boundaries.conditions[k], _borders_open(found, k))
                words = condition_words(condition, found.section, language)
                words += onset_words(arcs_of(found, k), language)
                by_condition.setdefault(words, []).append(letter)
        counted |= found.of is Of.STABILITY and any(x.judged is not None and x.judged.right for x in found.regions)
        dashed |= any(found.singles_out(arc) and _style(found, arc) for arc in found.arcs)
    entries: list[tuple[Any, str]] = []
    for words, (_, seen) in sorted(by_words.items(), key=lambda item: -item[1][0]):
        patch = Patch(facecolor=seen.colour, edgecolor=hatch_of(seen), linewidth=0.3, hatch=seen.hatch or None)
        entries.append((patch, words))
    if counted:
        entries.append(("2", language.say("number of roots with positive real part")))
    entries += [(", ".join(names), fill(words, WIDEST)) for words, names in by_condition.items()]
    if dashed:
        line = Line2D([], [], color=_DARK, linewidth=0.8, linestyle=_DASHES)
        entries.append((line, language.say("dashed: another verdict on the curve alone")))
    return entries


def _borders_open(found: PlaneMap, curve: int) -> bool:
    """Whether a drawn arc of a curve borders on parameters without a verdict."""
    lines = [arc for arc, there in _arcs(found) if curve in there.factors and _style(found, arc)]
    return any(side is not None and side.judged is None for arc in lines for side in found.beside(arc))


class Letter:
    """A letter in a circle, as in the plane, for a legend's handle."""

    def legend_artist(self, legend: Any, handle: str, fontsize: float, box: Any) -> Any:
        from matplotlib.text import Text

        text = Text(
            x=box.xdescent + box.width / 2,
            y=box.height / 2 - box.ydescent,
            text=handle,
            fontsize=SMALL - 1,
            style="italic",
            ha="center",
            va="center_baseline",
        )
        box.add_artist(text)
        return text
