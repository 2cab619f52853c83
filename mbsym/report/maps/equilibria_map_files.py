r"""A map of equilibria as a picture, as JSON, and as LaTeX to \input."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator

from mbsym.algebra.arrangements import polyline
from mbsym.algebra.arrangements.drawing import Branches
from mbsym.formulas.latex import LatexNames
from mbsym.maps.equilibria_map import Cell, EquilibriaMap
from mbsym.model.quantities import unit_of
from mbsym.model.system import System
from mbsym.report.documents import branches, parts
from mbsym.report.documents import equilibria_map as doc
from mbsym.report.documents.writer import written
from mbsym.report.figures.drawing import pictures
from mbsym.report.language import Language
from mbsym.report.maps.equilibria_json import coordinate_value
from mbsym.report.maps.equilibria_map_words import ORIGINS, cell_words
from mbsym.report.maps.figure import HEIGHT, NODES, RESOLUTION, SMALL, TEXT, TOLERANCE, WIDTH, named
from mbsym.report.maps.tex import equation, escaped
from mbsym.report.maps.verdict_colours import NONE, Look
from mbsym.report.sections.stability import verdict_data
from mbsym.report.unit_text import labelled
from mbsym.source.meaning import meaning

#: From few equilibria to many: told apart in grey, too.
SHADES = ("#f7fbff", "#d6e6f4", "#abd0e6", "#6aaed6", "#3787c0", "#105ba4", "#08306b")
_DARK = "#1a1a1a"


def equilibria_map_figure(
    system: System, found: EquilibriaMap, language: Language, formats: Sequence[str]
) -> dict[str, bytes]:
    """``equilibria-map.svg``, ``.pdf`` and ``.png``, those that are asked for."""
    ordered = sorted(formats, key=lambda kind: kind != "png")
    return pictures({"equilibria-map": lambda: _drawn(system, found, language)}, ordered)


def look(found: EquilibriaMap, cell: Cell) -> Look:
    """The shade of a count, dotted where stability is the sample's; white and hatched where nothing is counted."""
    if not cell.counted:
        return NONE
    counts = sorted({one.count for one in found.cells if one.counted})
    at = counts.index(cell.count)
    shade = SHADES[round(at * (len(SHADES) - 2) / max(1, len(counts) - 1))] if len(counts) > 1 else SHADES[2]
    return Look(shade, "" if cell.throughout or not cell.stable else "....")


def _drawn(system: System, found: EquilibriaMap, language: Language) -> Figure:
    entries: dict[str, Any] = {}
    order = sorted(found.cells, key=lambda one: (not one.counted, -one.count, -one.stable))
    for cell in order:
        shown = look(found, cell)
        colour = "#ffffff" if shown.hatch and shown != NONE else "#777777"
        patch = Patch(facecolor=shown.colour, edgecolor=colour, linewidth=0.4, hatch=shown.hatch or None)
        entries.setdefault(cell_words(cell, language), patch)
    figure = Figure(figsize=(WIDTH, HEIGHT + 0.35 + 0.155 * len(entries)), dpi=RESOLUTION, layout="constrained")
    axes = figure.subplots()
    box, branches = found.arrangement.box, Branches(found.arrangement)
    axes.grid(False)
    axes.set_xlim(float(box.x0), float(box.x1))
    axes.set_ylim(float(box.y0), float(box.y1))
    axes.xaxis.set_major_locator(MaxNLocator(5))
    axes.yaxis.set_major_locator(MaxNLocator(6))
    axes.tick_params(labelsize=SMALL, length=2.5, width=0.6)
    for spine in axes.spines.values():
        spine.set_visible(True)
        spine.set_linewidth(0.6)
    names = LatexNames([axis.name for axis in found.axes])
    across, up = (labelled(named(names, x.name), unit_of(system, x.name)) for x in found.axes)
    axes.set_xlabel(across, fontsize=TEXT)
    axes.set_ylabel(up, fontsize=TEXT)
    for cell in found.cells:
        _fill(axes, found, branches, cell)
    for arc in found.arrangement.arcs:
        below, above = arc.regions
        if below is None or above is None or found.look(found.cells[below]) == found.look(found.cells[above]):
            continue
        xs, ys = zip(*polyline(found.arrangement, arc, TOLERANCE), strict=True)
        axes.plot(xs, ys, color=_DARK, linewidth=0.9, solid_capstyle="round", zorder=2)
    figure.legend(
        list(entries.values()), list(entries), loc="outside lower left", fontsize=SMALL, frameon=False,
        handlelength=1.6, handleheight=1.0, labelspacing=0.35, borderaxespad=0.2,
    )  # fmt: skip
    return figure


def _fill(axes: Axes, found: EquilibriaMap, branches: Branches, cell: Cell) -> None:
    """A region, strip by strip, with its numbers in its widest part: all, and stable ones in brackets."""
    shown = look(found, cell)
    box = found.arrangement.box
    vertices: list[tuple[float, float]] = []
    codes: list[Any] = []
    best, place = 0.0, (0.0, 0.0)
    for strip, k in found.arrangement.regions[cell.number].cells:
        below, above = [], []
        left, right = branches.bounds(strip)
        for i in range(NODES + 1):
            t = math.pi * i / NODES
            x, ys = branches.at(strip, min(max(t, 1e-3), math.pi - 1e-3))
            x = left if i == 0 else right if i == NODES else x
            below.append((x, ys[k]))
            above.append((x, ys[k + 1]))
        ring = [*below, *above[::-1]]
        vertices += [*ring, ring[0]]
        codes += [Path.MOVETO, *[Path.LINETO] * (len(ring) - 1), Path.CLOSEPOLY]
        x, ys = branches.at(strip, math.pi / 2)
        room = min((right - left) / float(box.x1 - box.x0), (ys[k + 1] - ys[k]) / float(box.y1 - box.y0))
        if room > best:
            best, place = room, (x, (ys[k] + ys[k + 1]) / 2)
    path = Path(vertices, codes)
    axes.add_patch(PathPatch(path, facecolor=shown.colour, edgecolor=shown.colour, linewidth=0.4, zorder=0.5))
    if shown.hatch:
        colour = "#9a9a9a" if shown == NONE else "#ffffff"
        hatched = PathPatch(path, facecolor="none", edgecolor=colour, linewidth=0, hatch=shown.hatch, zorder=0.6)
        axes.add_patch(hatched)
    if cell.counted and best > 0.07:
        dark = SHADES.index(shown.colour) > 3
        halo = [withStroke(linewidth=1.4, foreground=shown.colour)]
        axes.text(
            *place, f"{cell.count} ({cell.stable})", fontsize=SMALL - 1, color="white" if dark else _DARK,
            ha="center", va="center", path_effects=halo, zorder=3,
        )  # fmt: skip


def equilibria_map_json(system: System, found: EquilibriaMap) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    data = doc.EquilibriaMap(
        system=system.name,
        description_sha256=meaning(system),
        axes=[parts.Axis(name=x.name, low=str(x.low), high=str(x.high)) for x in found.axes],
        values={name: str(value) for name, value in sorted(found.given.items())},
        interrupted=found.interrupted,
        unfinished=list(found.unfinished),
        curves=[
            doc.Curve(number=k, polynomial=str(p), origins=list(of))
            for k, (p, of) in enumerate(zip(found.arrangement.factors, found.origins, strict=True))
        ],
        regions=[
            doc.Region(
                number=one.number,
                sample=[str(x) for x in one.sample],
                standing=one.standing,
                count=one.count if one.counted else None,
                stable=one.stable if one.counted else None,
                stable_throughout=one.throughout,
                found_by_newton_elsewhere=one.confirmed,
                area=area,
                equilibria=[
                    branches.Equilibrium(
                        coordinates=[coordinate_value(x) for x in there.values],
                        angles_of=there.coordinates_of or None,
                        stability=verdict_data(there.verdict),
                    )
                    for there in one.equilibria
                ],
            )
            for one, (area, _) in zip(found.cells, found.areas, strict=True)
        ],
    )
    return written(data)


def equilibria_map_tex(system: System, found: EquilibriaMap, language: Language) -> str:
    """Needs graphicx; the picture is equilibria-map.pdf in the same folder."""
    names = LatexNames([axis.name for axis in found.axes])
    fixed = LatexNames(list(found.given))
    axes = ", ".join(f"${names[axis.name]}$" for axis in found.axes)
    values = ", ".join(f"${fixed[key]} = {value}$" for key, value in found.given.items())
    head = language.say("Numbers of relative equilibria of")
    caption = f"{head} {escaped(system.name)}: ({axes})" + (f"; {values}" if values else "")
    lines = [
        "% needs \\usepackage{graphicx}; written by mbsym map --of equilibria",
        r"\begin{figure}",
        r"\centering",
        r"\includegraphics[width=\columnwidth]{equilibria-map.pdf}",
        rf"\caption{{{caption}.}}",
        r"\end{figure}",
    ]
    if found.arrangement.factors:
        lines += ["", r"\noindent " + language.say("The curves of the map:"), r"\begin{itemize}"]
        for p, of in zip(found.arrangement.factors, found.origins, strict=True):
            lines.append(rf"\item {equation(p, names, language)} \quad ({escaped(language.say(ORIGINS[of[0]]))})")
        lines.append(r"\end{itemize}")
    return "\n".join(lines) + "\n"
