"""What the pictures of maps have in common: a column's width, small axes, numbers above, a legend below."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from textwrap import wrap
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from mbsym.formulas.latex import LatexNames
from mbsym.maps.mapping import float_of
from mbsym.model.quantities import unit_of
from mbsym.model.system import System
from mbsym.problems.stability.words import Word
from mbsym.report.figures.drawing import named, symbol
from mbsym.report.maps.words import rational_text
from mbsym.report.unit_text import labelled

#: Inches: the width of a column, a line of the legend.
WIDTH, LINE = 3.4, 0.155
#: Points: of text, of small text, and of that in small planes.
TEXT, SMALL, FINE = 8, 7, 5.5
#: Pixels per inch: lines are thin.
RESOLUTION = 300
#: Characters in a line of the legend.
WIDEST = 52
#: Longer numbers are rounded in pictures, to so many digits.
LONGEST, DIGITS = 8, 4

DARK, EDGE = "#1a1a1a", "#777777"


def started(body: float, entries: int, values: Mapping[str, Any], near: bool = False) -> Figure:
    """An empty figure of a column's width, with the numbers that were put in above it."""
    lines = values_lines(values)
    engine = ConstrainedLayoutEngine(w_pad=0.02, h_pad=0.02, wspace=0.03, hspace=0.03)
    figure = Figure(
        figsize=(WIDTH, body + LINE * (entries + len(lines))), dpi=RESOLUTION,
        layout=engine if near else "constrained",
    )  # fmt: skip
    if lines:
        figure.suptitle("\n".join(lines), fontsize=SMALL, linespacing=1.1)
    return figure


def values_lines(values: Mapping[str, Any]) -> list[str]:
    """``p_1 = 2/5, p_2 = 1/5``: the numbers that were put in, in lines of a column's width."""
    names = LatexNames(list(values))
    # as long as they are written, for where lines end; names are formulas
    plain = [f"{name}\u00a0=\u00a0{number(x)}," for name, x in values.items()]
    shown = [f"{named(names, name)} {equal(x)}" for name, x in values.items()]
    taken, lines = iter(shown), []
    for line in wrap(" ".join(plain), WIDEST + 8, break_long_words=False, break_on_hyphens=False):
        lines.append(", ".join(itertools.islice(taken, line.count(","))))
    return [*(f"{line}," for line in lines[:-1]), *lines[-1:]]


def number(x: Any) -> str:
    """A rational number as it is where it is short, the first digits of another."""
    return rational_text(x) if _short(x) else f"{float_of(x):.{DIGITS}g}"


def equal(x: Any) -> str:
    """``= 2/5``; where digits are left out it is about equal."""
    return f"{'=' if _short(x) else chr(0x2248)} {number(x)}"


def _short(x: Any) -> bool:
    return not hasattr(x, "polynomial") and len(rational_text(x)) <= LONGEST


def framed(axes: Axes, size: float = SMALL) -> None:
    """The frame and the marks of small axes."""
    axes.grid(False)
    axes.tick_params(labelsize=size, length=2.5, width=0.6)
    for side in axes.spines.values():
        side.set_visible(True)
        side.set_linewidth(0.6)


def axis_label(system: System, name: str) -> str:
    """The name as a formula, with its unit."""
    return labelled(symbol(name), unit_of(system, name))


def legend(figure: Figure, entries: Sequence[tuple[Any, str]]) -> None:
    """(What is shown, what it means) below a figure."""
    if not entries:
        return
    handles, labels = zip(*entries, strict=True)
    figure.legend(
        handles, labels, loc="outside lower left", fontsize=SMALL, frameon=False, handlelength=1.8, handleheight=1.0,
        labelspacing=0.35, borderaxespad=0.2, handler_map={str: Letter()},
    )  # fmt: skip


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


# How verdicts are coloured in maps and sweeps: one look for one word, wherever it is drawn.


@dataclass(frozen=True)
class Look:
    """``hatch`` is one of matplotlib's patterns, or nothing."""

    colour: str
    hatch: str = ""

    @property
    def light(self) -> bool:
        """Whether dark text is read upon it."""
        red, green, blue = (int(self.colour[k : k + 2], 16) for k in (1, 3, 5))
        return 0.299 * red + 0.587 * green + 0.114 * blue > 150


#: By the word of the verdict.
LOOKS: dict[str, Look] = {
    Word.ASYMPTOTIC: Look("#225588"),
    Word.ASYMPTOTIC_BUT_TURNED: Look("#225588", "."),
    Word.ASYMPTOTIC_BUT_CYCLIC: Look("#225588", "-"),
    Word.ASYMPTOTIC_BUT_STEADY: Look("#225588", "|"),
    Word.STABLE: Look("#4f93c9"),
    Word.STABLE_BUT_CYCLIC: Look("#4f93c9", "-"),
    Word.GYROSCOPIC: Look("#b5ddf0"),
    Word.CRITICAL: Look("#e8d99a"),
    Word.UNDECIDED: Look("#c4c4c4"),
    Word.DEPENDS: Look("#c4c4c4", "x"),
    Word.UNSTABLE: Look("#cc6677"),
    Word.UNSTABLE_BUT_BORDERS: Look("#cc6677", "x"),
}

#: Of unstable motions whose roots to the right are counted: pairs alone, real roots beside pairs.
FLUTTER, BOTH = Look("#882255"), Look("#cc6677", "xxxx")
#: By Poincare's degree of instability, from 0 on; the last for what is beyond.
DEGREES = (Look("#4f93c9"), Look("#ddcc77"), Look("#cc6677"), Look("#882255"), Look("#44222f"))

#: Where no verdict is given: outside what was assumed, or where formulas divide by zero.
NONE = Look("#ffffff", "///")
#: Where nothing is proved, or was looked at: as the paper is.
WHITE = Look("#ffffff")

#: From few equilibria to many: told apart in grey, too.
SHADES = ("#f7fbff", "#d6e6f4", "#abd0e6", "#6aaed6", "#3787c0", "#105ba4", "#08306b")


def look_of_roots(word: str, right: int | None, real: int | None) -> Look:
    """The look of a verdict where the roots to the right are known: ``right`` of them, ``real`` of which are real."""
    if word != Word.UNSTABLE or not right or real == right or real is None:
        return look_of(word)
    return BOTH if real else FLUTTER


def look_of_degree(degree: int) -> Look:
    """The look of a degree of instability."""
    return DEGREES[min(degree, len(DEGREES) - 1)]


def look_of_count(count: int, counts: Collection[int], throughout: bool) -> Look:
    """The shade of a number of equilibria among all ``counts``, dotted where stability is the sample's."""
    at, last = sorted(counts).index(count), len(counts) - 1
    shade = SHADES[round(at * (len(SHADES) - 2) / last)] if last else SHADES[2]
    return Look(shade, "" if throughout else "....")


def look_of(word: str) -> Look:
    """The look of a verdict's word, that of ``NONE`` for anything else."""
    return LOOKS.get(word, NONE)


def colour_of(word: str) -> str:
    """The colour alone."""
    return look_of(word).colour
