"""The picture of a map over three axes: small multiples on pages of a column's width.

A curve has one letter in all of them.  Above each stands the value of the third axis at which it is drawn, and between
which values it is the same.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flint import fmpq
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.ticker import MaxNLocator

from mbsym.formulas.latex import LatexNames
from mbsym.maps.result import PlaneMap
from mbsym.maps.slices import Picture, Stack
from mbsym.model.quantities import unit_of
from mbsym.model.system import System
from mbsym.report.figures.drawing import pictures
from mbsym.report.language import Language
from mbsym.report.maps.figure import (
    RESOLUTION,
    SMALL,
    TEXT,
    WIDTH,
    draw_plane,
    drawn_curves,
    entries_of,
    labels,
    legend,
    letters,
    named,
)
from mbsym.report.unit_text import pretty

#: Panels beside each other, and rows of them on one page.
ACROSS, ROWS = 2, 3
#: Inches: of a row of panels, and of a line of the legend.
_ROW, _LINE = 1.45, 0.155
#: Points: numbers and letters in panels.
_FINE = 5.5
#: Regions as wide as this part of a panel have room for a number.
_ROOM = 0.12
#: Digits of irrational values.
_DIGITS = 4


def slice_figure(system: System, found: Stack, language: Language, formats: Sequence[str]) -> dict[str, bytes]:
    """``map.svg``, ``map-2.svg``, ... and the same of ``pdf`` and ``png``, those that are asked for.

    Nothing where no slice has a map.
    """
    ordered = sorted(formats, key=lambda kind: kind != "png")
    shown = panels(found)
    letters = letters_of(found)
    pages = [shown[k : k + ACROSS * ROWS] for k in range(0, len(shown), ACROSS * ROWS)]
    drawings = {
        stem: lambda page=page: _page(system, found, page, letters, language)
        for stem, page in zip(page_names(found), pages, strict=True)
    }
    return pictures(drawings, ordered)


def page_names(found: Stack) -> list[str]:
    """The files without their endings: map, map-2, ..."""
    count = -(-len(panels(found)) // (ACROSS * ROWS))
    return ["map" if k == 0 else f"map-{k + 1}" for k in range(count)]


def panels(found: Stack) -> list[tuple[Picture, PlaneMap]]:
    """The pictures that there are maps of."""
    shown = [(one, found.layers[one.shown].plane) for one in found.pictures]
    return [(one, plane) for one, plane in shown if plane is not None]


def letters_of(found: Stack) -> dict[str, str]:
    """A letter for every curve that is drawn in one of the pictures, by its name in ``curve_name``."""
    names: dict[str, None] = {}
    for _, plane in panels(found):
        names |= dict.fromkeys(curve_name(found, plane, k) for k in sorted(drawn_curves(plane)))
    order = sorted(names, key=lambda name: (not name.isdigit(), int(name) if name.isdigit() else 0))
    taken = [*(axis.name for axis in found.section.axes), found.axis.name]
    return dict(zip(order, letters(taken, len(order)), strict=True))


def curve_name(found: Stack, plane: PlaneMap, k: int) -> str:
    """Its number where it belongs to all slices, its polynomial where it was found in one."""
    return str(k) if k < len(found.boundaries.factors) else str(plane.boundaries.factors[k])


def _page(
    system: System,
    found: Stack,
    page: Sequence[tuple[Picture, PlaneMap]],
    letters: Mapping[str, str],
    language: Language,
) -> Figure:
    told = [{k: letters[curve_name(found, plane, k)] for k in sorted(drawn_curves(plane))} for _, plane in page]
    entries = entries_of([(plane, own) for (_, plane), own in zip(page, told, strict=True)], language)
    if any(one.unseen for one, _ in page):
        entries.append(("*", language.say("but for single values not looked at")))
    rows = -(-len(page) // ACROSS)
    size = (WIDTH, _ROW * rows + 0.3 + _LINE * len(entries))
    near = ConstrainedLayoutEngine(w_pad=0.02, h_pad=0.02, wspace=0.03, hspace=0.03)
    figure = Figure(figsize=size, dpi=RESOLUTION, layout=near)
    grid = figure.subplots(rows, ACROSS, squeeze=False)
    across, up = labels(system, page[0][1])
    for place, axes in enumerate(grid.flat):
        if place >= len(page):
            axes.set_axis_off()
            continue
        picture, plane = page[place]
        draw_plane(axes, system, plane, told[place], _FINE, _ROOM)
        last = place + ACROSS >= len(page)
        axes.set_xlabel(across if last else "", fontsize=TEXT - 1, labelpad=1)
        axes.set_ylabel("" if place % ACROSS else up, fontsize=TEXT - 1, labelpad=1)
        axes.tick_params(labelleft=not place % ACROSS, labelbottom=last)
        _framed(axes, title(system, found, picture))
    legend(figure, entries)
    return figure


def _framed(axes: Axes, text: str) -> None:
    axes.xaxis.set_major_locator(MaxNLocator(4))
    axes.yaxis.set_major_locator(MaxNLocator(4))
    axes.set_title(text, fontsize=SMALL - 0.5, pad=2.5, loc="left", linespacing=1.05)


def title(system: System, found: Stack, picture: Picture) -> str:
    r"""``C = 1/2`` and below it ``0 < C < 0.798``; the first line alone where the picture is at one value only."""
    name = named(LatexNames([found.axis.name]), found.axis.name)
    unit = pretty(unit_of(system, found.axis.name))
    ending = f" {unit}" if unit else ""
    first = f"{name} = {value(found.layers[picture.shown].z)}{ending}"
    low, closed_low, high, closed_high = found.ends(picture)
    if len(picture.layers) == 1 and found.layers[picture.shown].critical:
        return first
    relations = ("\u2264" if closed_low else "<", "\u2264" if closed_high else "<")
    star = "*" if picture.unseen else ""
    return f"{first}\n{value(low)} {relations[0]} {name} {relations[1]} {value(high)}{star}"


def value(x: Any) -> str:
    """A rational number as it is where it is short, the first digits of another."""
    if isinstance(x, fmpq):
        told = str(x)
        return told if len(told) <= 2 * _DIGITS else f"{float(x.p) / float(x.q):.{_DIGITS}g}"
    return f"{float(x):.{_DIGITS}g}"
