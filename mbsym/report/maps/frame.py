"""What the pictures of maps have in common: a column's width, small axes, numbers above, a legend below."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from textwrap import wrap
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from mbsym.formulas.latex import LatexNames
from mbsym.maps.mapping import float_of
from mbsym.model.quantities import unit_of
from mbsym.model.system import System
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
    return str(x) if _short(x) else f"{float_of(x):.{DIGITS}g}"


def equal(x: Any) -> str:
    """``= 2/5``; where digits are left out it is about equal."""
    return f"{'=' if _short(x) else chr(0x2248)} {number(x)}"


def _short(x: Any) -> bool:
    return not hasattr(x, "polynomial") and len(str(x)) <= LONGEST


def framed(axes: Axes, size: float = SMALL) -> None:
    """The frame and the marks of small axes."""
    axes.grid(False)
    axes.tick_params(labelsize=size, length=2.5, width=0.6)
    for side in axes.spines.values():
        side.set_visible(True)
        side.set_linewidth(0.6)


def axis_label(system: System, name: str) -> str:
    """The name as a formula, with its unit."""
    return labelled(named(LatexNames([name]), name), unit_of(system, name))


def named(names: LatexNames, name: str) -> str:
    """A name on an axis, as a formula where it is one."""
    symbol = names[name]
    return name.replace("$", r"\$") if "mathtt" in symbol.stem else f"${symbol}$"


def legend(figure: Figure, entries: Sequence[tuple[Any, str]]) -> None:
    """(What is shown, what it means) below a figure."""
    if not entries:
        return
    handles, told = zip(*entries, strict=True)
    figure.legend(
        handles, told, loc="outside lower left", fontsize=SMALL, frameon=False, handlelength=1.8, handleheight=1.0,
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
