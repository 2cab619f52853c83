"""A map in boxes: its picture, its JSON, its LaTeX, and where given points lie."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from flint import fmpq
from matplotlib.collections import PatchCollection
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle
from matplotlib.ticker import MaxNLocator

from mbsym.expressions.counting import counted
from mbsym.formulas.latex import LatexNames
from mbsym.maps.boxes import BoxMap
from mbsym.maps.result import Of, Stratum
from mbsym.model.quantities import unit_of
from mbsym.model.system import System
from mbsym.report.documents import map as doc
from mbsym.report.documents.writer import written
from mbsym.report.figures.drawing import pictures
from mbsym.report.language import Language
from mbsym.report.maps.figure import HEIGHT, RESOLUTION, SMALL, TEXT, WIDTH, hatch_of, legend, look, named, partial
from mbsym.report.maps.json import check_data, head, judged_data
from mbsym.report.maps.located import VERDICT, WHERE, Points
from mbsym.report.maps.tex import caption_of, escaped, figure_lines
from mbsym.report.maps.verdict_colours import Look
from mbsym.report.maps.words import judged_words, look_words, signature_words
from mbsym.report.unit_text import labelled

#: What is not proved is left as the paper is, with a grey edge in the legend.
WHITE = Look("#ffffff")


def share(value: Any) -> str:
    """A part of the area in per cent, never rounded to none or all."""
    percent = 100 * float(value)
    if value == 0 or value == 1:
        return f"{percent:.0f} %"
    return "less than 0.01 %" if percent < 0.01 else f"{min(percent, 99.99):.2f} %"


def box_figure(system: System, found: BoxMap, language: Language, formats: Sequence[str]) -> dict[str, bytes]:
    """``map.svg``, ``map.pdf`` and ``map.png``, those that are asked for."""
    ordered = sorted(formats, key=lambda kind: kind != "png")
    return pictures({"map": lambda: _drawn(system, found, language)}, ordered)


def _drawn(system: System, found: BoxMap, language: Language) -> Figure:
    groups: dict[str, tuple[Look, list[Rectangle], float]] = {}
    for tile in found.tiles:
        if tile.proved is None:
            continue
        words = look_words(found, tile.proved, language)
        seen, boxes, area = groups.get(words, (look(found, tile.proved), [], 0.0))
        box = tile.box
        corner, size = (float(box.x0), float(box.y0)), (float(box.x1 - box.x0), float(box.y1 - box.y0))
        boxes.append(Rectangle(corner, *size))
        groups[words] = seen, boxes, area + float(box.area)
    ordered = sorted(groups.items(), key=lambda item: -item[1][2])
    entries: list[tuple[Any, str]] = []
    for words, (seen, _, _) in ordered:
        patch = Patch(facecolor=seen.colour, edgecolor=hatch_of(seen), linewidth=0.3, hatch=seen.hatch or None)
        entries.append((patch, words))
    if found.subdivision.white:
        words = f"{language.say('white: nothing is proved')} ({percent(found, language)})"
        entries.append((Patch(facecolor="#ffffff", edgecolor="#777777", linewidth=0.4), words))
    entries += partial(found, language)
    figure = Figure(figsize=(WIDTH, HEIGHT + 0.35 + 0.155 * len(entries)), dpi=RESOLUTION, layout="constrained")
    axes = figure.subplots()
    axes.grid(False)
    whole = found.subdivision.box
    axes.set_xlim(float(whole.x0), float(whole.x1))
    axes.set_ylim(float(whole.y0), float(whole.y1))
    axes.xaxis.set_major_locator(MaxNLocator(5))
    axes.yaxis.set_major_locator(MaxNLocator(6))
    for spine in axes.spines.values():
        spine.set_visible(True)
        spine.set_linewidth(0.6)
    axes.tick_params(labelsize=SMALL, length=2.5, width=0.6)
    names = LatexNames([axis.name for axis in found.section.axes])
    across, up = (labelled(named(names, x.name), unit_of(system, x.name)) for x in found.section.axes)
    axes.set_xlabel(across, fontsize=TEXT)
    axes.set_ylabel(up, fontsize=TEXT)
    for _, (seen, boxes, _) in ordered:
        # an edge of the same colour: no seams between boxes
        axes.add_collection(
            PatchCollection(boxes, facecolor=seen.colour, edgecolor=seen.colour, linewidth=0.3, zorder=0.5)
        )
        if seen.hatch:
            hatched = PatchCollection(boxes, facecolor="none", edgecolor=hatch_of(seen), linewidth=0, zorder=0.6)
            hatched.set_hatch(seen.hatch)
            axes.add_collection(hatched)
    legend(figure, entries)
    return figure


def percent(found: BoxMap, language: Language) -> str:
    """``12.50 % of the area``."""
    told = share(found.subdivision.white).replace("less than", language.say("less than"))
    return f"{told} {language.say('of the area')}"


def box_json(system: System, found: BoxMap) -> str:
    """map.json: each statement once, and the boxes with the numbers of theirs; exact edges."""
    statements: list[doc.Statement] = []
    places: dict[tuple[object, ...], int] = {}
    boxes = []
    for tile in found.tiles:
        at = None
        if tile.proved is not None:
            broken = tuple(x.condition.about for x in tile.proved.broken)
            judged = tile.proved.judged
            key = (*tile.proved.kind, broken, judged and judged.null)
            if key not in places:
                places[key] = len(statements)
                statements.append(judged_data(tile.proved))
            at = places[key]
        edges = [str(x) for x in (tile.box.x0, tile.box.x1, tile.box.y0, tile.box.y1)]
        boxes.append(doc.Box(edges=edges, statement=at))
    data = doc.Map(
        **head(system, found),
        interrupted=found.interrupted,
        check=check_data(found.check),
        regions=[],
        arcs=[],
        corners=[],
        subdivision=doc.Subdivision(
            because=found.because or None,
            method=found.method,
            end=found.subdivision.end,
            white=str(found.subdivision.white),
            statements=statements,
            boxes=boxes,
        ),
    )
    return written(data)


def box_tex(system: System, found: BoxMap, language: Language) -> str:
    """Needs graphicx; the picture is map.pdf in the same folder."""
    names = LatexNames([axis.name for axis in found.section.axes])
    axes = ", ".join(f"${names[axis.name]}$" for axis in found.section.axes)
    told = f" {language.say('Every coloured box is proved as a whole')}"
    if found.subdivision.white:
        told += f"; {language.say('white: nothing is proved')} ({escaped(percent(found, language))})"
    return "\n".join(figure_lines("map.pdf", caption_of(system, found, f"({axes})", language) + told + ".")) + "\n"


def box_located(points: Points, found: BoxMap) -> str:
    """The rows with the columns ``where`` (a box) and ``verdict``; of a white box there is none."""
    out = io.StringIO(newline="")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow((*points.header, WHERE, VERDICT))
    for row, values in zip(points.rows, points.values, strict=True):
        writer.writerow((*row, *located_in(found, *values)))
    return out.getvalue()


def located_in(found: BoxMap, x: Fraction, y: Fraction) -> tuple[str, str]:
    """(``box 3``, verdict or why there is none)."""
    at = fmpq(x.numerator, x.denominator), fmpq(y.numerator, y.denominator)
    if at not in found.subdivision.box:
        return "outside of the box", ""
    tile = found.subdivision.locate(*at)
    if tile.proved is None:
        return "white box", "nothing is proved"
    word = tile.proved.word
    return f"box {tile.proved.number}", tile.proved.standing.value if word is None else word.value


def row_of(found: BoxMap, stratum: Stratum) -> tuple[str, str]:
    """(verdict, theorem) for a table."""
    judged = stratum.judged
    if judged is None:
        return look_words(found, stratum), ""
    if found.of is Of.SIGNATURE:
        return signature_words(judged), ""
    told = judged_words(judged)
    return (f"{told}, {counted(judged.right, 'root')} to the right" if judged.right else told), judged.verdict.theorem
