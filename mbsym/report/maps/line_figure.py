"""The picture of a map over one parameter: a bar of intervals, with the exact numbers at which something changes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from flint import fmpq
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from mbsym.formulas.latex import LatexNames
from mbsym.maps.result import LineMap
from mbsym.model.quantities import unit_of
from mbsym.model.system import System
from mbsym.report.figures.drawing import pictures
from mbsym.report.language import Language
from mbsym.report.maps.figure import RESOLUTION, SMALL, TEXT, WIDTH, hatch_of, look, named, partial
from mbsym.report.maps.words import condition_words, look_words, onset_words, telling
from mbsym.report.unit_text import labelled

#: Inches: the bar, and a line of the legend.
_BAR, _LINE = 0.42, 0.155
_DARK = "#1a1a1a"


def line_figure(system: System, found: LineMap, language: Language, formats: Sequence[str]) -> dict[str, bytes]:
    """``map.svg``, ``map.pdf`` and ``map.png``, those that are asked for."""
    ordered = sorted(formats, key=lambda kind: kind != "png")
    return pictures({"map": lambda: _drawn(system, found, language)}, ordered)


def changes(found: LineMap, language: Language) -> list[tuple[str, float, str]]:
    """(letter, number, condition) of the zeros at which something changes."""
    told = []
    for one, there in zip(found.corners, found.line.zeros, strict=True):
        if found.changes(one):
            conditions = [condition for k in there.factors for condition in found.boundaries.conditions[k]]
            words = condition_words(telling(conditions), found.section, language) + onset_words([one], language)
            x = there.number
            told.append((float(x.p) / float(x.q) if isinstance(x, fmpq) else float(x), words))
    return [("abcdefghijklmnopqrstuvwxyz"[k % 26], x, words) for k, (x, words) in enumerate(told)]


def _drawn(system: System, found: LineMap, language: Language) -> Figure:
    told = changes(found, language)
    entries: list[tuple[Any, str]] = []
    seen: dict[str, Any] = {}
    for one in found.regions:
        seen.setdefault(look_words(found, one, language), look(found, one))
    for words, shown in seen.items():
        entries.append(
            (Patch(facecolor=shown.colour, edgecolor=hatch_of(shown), linewidth=0.3, hatch=shown.hatch or None), words)
        )
    entries += [(letter, f"{x:.6g}   {words}") for letter, x, words in told]
    entries += partial(found, language)
    figure = Figure(figsize=(WIDTH, _BAR + 0.62 + _LINE * len(entries)), dpi=RESOLUTION, layout="constrained")
    axes = figure.subplots()
    axes.grid(False)
    low, high = (float(x.p) / float(x.q) for x in (found.line.low, found.line.high))
    axes.set_xlim(low, high)
    axes.set_ylim(0, 1)
    axes.set_yticks([])
    start = low
    for one, (length, _) in zip(found.regions, found.areas, strict=True):
        shown = look(found, one)
        axes.add_patch(Rectangle((start, 0), length, 1, facecolor=shown.colour, edgecolor="none", zorder=0.5))
        if shown.hatch:
            hatched: dict[str, Any] = {
                "edgecolor": hatch_of(shown),
                "hatch": shown.hatch,
                "linewidth": 0,
                "zorder": 0.6,
            }
            axes.add_patch(Rectangle((start, 0), length, 1, facecolor="none", **hatched))
        start += length
    for side in axes.spines.values():
        side.set_visible(True)
        side.set_linewidth(0.6)
    axes.tick_params(labelsize=SMALL, length=2.5, width=0.6)
    name = found.section.axes[0].name
    axes.set_xlabel(labelled(named(LatexNames([name]), name), unit_of(system, name)), fontsize=TEXT)
    for letter, x, _ in told:
        axes.axvline(x, color=_DARK, linewidth=0.9)
        axes.annotate(
            letter, (x, 1), xytext=(0, 2), textcoords="offset points", fontsize=SMALL, style="italic", ha="center"
        )
    from mbsym.report.maps.figure import Letter

    handles, labels = zip(*entries, strict=True)
    figure.legend(
        handles,
        labels,
        loc="outside lower left",
        fontsize=SMALL,
        frameon=False,
        handlelength=1.6,
        labelspacing=0.35,
        borderaxespad=0.2,
        handler_map={str: Letter()},
    )
    return figure
