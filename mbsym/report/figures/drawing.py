"""What all figures share: the style, colours, and drawing without a display.

Matplotlib's settings and list of fonts are global: ``styled`` changes them while figures are drawn and puts them back.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from io import BytesIO
from itertools import pairwise
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.font_manager import fontManager
from matplotlib.ticker import LogFormatterMathtext, ScalarFormatter
from matplotlib.transforms import Bbox
from PIL import Image

from mbsym.expressions.message import Message
from mbsym.formulas.latex import LatexNames
from mbsym.model.system import System
from mbsym.report.language import Language

#: A list of fonts that another installation left behind is no news to whoever asked for a figure.
logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)

#: Pixels per inch of a PNG.
RESOLUTION = 150

STYLE: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 10,
    "mathtext.fontset": "dejavusans",
    "axes.titlesize": 11,
    "axes.labelsize": 11,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "axes.formatter.limits": (-3, 4),
    "axes.formatter.useoffset": False,
    "lines.linewidth": 1.2,
    "lines.solid_joinstyle": "round",
    "agg.path.chunksize": 20_000,
    "svg.hashsalt": "mbsym",
    "svg.fonttype": "path",
    "figure.dpi": RESOLUTION,
}

#: More numbers than these are not told beside a picture.
MOST_VALUES = 8

#: Colours of a PNG; lines need no more.
COLOURS = 192

BLUE, RED, GREY = "#1f5fa8", "#b3372f", "#888888"


#: Curves over time are thinned to their extremes in so many intervals.
INTERVALS = 2_000


def thinned(times: Any, values: Any) -> tuple[Any, Any]:
    """The least and the greatest value of each interval, in their order: no oscillation is hidden, none is invented."""
    values = np.asarray(values, dtype=float)
    if len(times) <= 2 * INTERVALS:
        return times, values
    edges = np.linspace(0, len(times), INTERVALS + 1).astype(int)
    selected = {0, len(times) - 1}
    for start, end in pairwise(edges):
        selected |= {start + int(np.argmin(values[start:end])), start + int(np.argmax(values[start:end]))}
    places = np.array(sorted(selected))
    return times[places], values[places]


def spoken(system: System) -> Callable[[str], str]:
    """Words of a figure in the language of the description."""
    return Language(system.language).say


def title_of(system: System, number: int = 1, count: int = 1) -> str:
    """The system's name, and which page of how many this is."""
    name = system.name if len(system.name) <= 70 else system.name[:67] + "..."
    page = Message("page [[number]] of [[count]]", number=number, count=count)
    return f"{name}, {spoken(system)(page)}" if count > 1 else name


def symbol(name: str) -> str:
    """One name as it stands on an axis."""
    return named(LatexNames([name]), name)


def named(names: LatexNames, name: str) -> str:
    """A name on an axis, as a formula where it is one."""
    symbol = names[name]
    return name.replace("$", r"\$") if "mathtt" in symbol.stem else f"${symbol}$"


def equalities(values: Mapping[str, Any], digits: int = 4) -> str:
    """``m = 1, omega = 3.333``: numbers beside symbols, as mathematical text; nothing of too many to be read.

    They are about equal where digits are left out.
    """
    if len(values) > MOST_VALUES:
        return ""
    names = LatexNames(list(values))
    written = []
    for name, value in values.items():
        number = f"{float(value):.{digits}g}"
        written.append(f"{named(names, name)} {'=' if float(number) == float(value) else chr(0x2248)} {number}")
    return ", ".join(written).replace("-", "\u2212")


@contextmanager
def styled() -> Iterator[None]:
    """Drawn inside, figures have our style and matplotlib's own fonts, whatever the user's are."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(STYLE)
        fonts = fontManager.ttflist
        # Every font of every size is looked for among all that are installed, which may be thousands.
        fontManager.ttflist = [font for font in fonts if font.fname.startswith(matplotlib.get_data_path())] or fonts
        try:
            yield
        finally:
            fontManager.ttflist = fonts


def pictures(drawings: Mapping[str, Callable[[], Figure]], formats: Sequence[str]) -> dict[str, bytes]:
    """Every figure in every format, by file name; equal figures give equal bytes (with one version of matplotlib)."""
    images: dict[str, bytes] = {}
    with styled():
        for stem, draw in drawings.items():
            figure = draw()
            images |= saved(stem, figure, formats)
            figure.clear()  # a figure and its axes hold each other
    return images


def saved(stem: str, figure: Figure, formats: Sequence[str]) -> dict[str, bytes]:
    """The bytes of a figure in every format, by file name."""
    canvas = FigureCanvasAgg(figure)
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            _plain_numbers(axis)
    # Arranging takes as long as drawing: once for all formats, and not by savefig, which would draw twice.
    engine = figure.get_layout_engine()
    if engine is not None:
        # Axes that keep their shape end up elsewhere than they are put.
        free = all(axes.get_aspect() == "auto" and axes.get_box_aspect() is None for axes in figure.axes)
        with _measured_once(figure.axes if free else []):
            engine.execute(figure)
        figure.set_layout_engine("none")
    images = {}
    for kind in formats:
        stream = BytesIO()
        if kind == "svg":
            FigureCanvasSVG(figure).print_svg(stream, metadata={"Date": None, "Creator": "mbsym"})
            figure.set_dpi(RESOLUTION)
        elif kind == "pdf":
            from matplotlib.backends.backend_pdf import FigureCanvasPdf  # few ask for it, all would wait

            nothing = dict.fromkeys(("CreationDate", "Producer"))
            FigureCanvasPdf(figure).print_pdf(stream, metadata=nothing | {"Creator": "mbsym"})
            figure.set_dpi(RESOLUTION)
        else:
            canvas.draw()
            _png(np.asarray(canvas.buffer_rgba()), stream)
        images[f"{stem}.{kind}"] = stream.getvalue()
    return images


@contextmanager
def _measured_once(measured: Sequence[Axes]) -> Iterator[None]:
    """How far labels reach beyond axes is measured once; arranging would measure it again after moving them.

    So the places of labels must not depend on the size of the axes.
    """
    for axes in measured:
        axes.get_tightbbox = _Measured(axes)  # type: ignore[method-assign]
    try:
        yield
    finally:
        for axes in measured:
            del axes.get_tightbbox


class _Measured:
    def __init__(self, axes: Axes) -> None:
        self._axes, self._measure = axes, axes.get_tightbbox
        self._beyond: Any = None

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        if self._beyond is None:
            box = self._measure(*arguments, **options)
            if box is None:
                return None
            self._beyond = np.subtract(box.extents, self._axes.bbox.extents)
        return Bbox.from_extents(*np.add(self._axes.bbox.extents, self._beyond))


def _png(pixels: Any, stream: BytesIO) -> None:
    """A PNG with COLOURS colours instead of as many as there are: the file is a third as large."""
    image = Image.fromarray(np.ascontiguousarray(pixels[..., :3]))
    reduced = image.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    reduced.save(stream, "png", compress_level=6, dpi=(RESOLUTION, RESOLUTION))


# --- numbers along axes ---


class _Numbers(ScalarFormatter):
    """Numbers as plain text; only the common power of ten in the corner is a formula.

    Formulas are read by a parser, which takes more time than everything else of a figure.
    """

    def get_offset(self) -> str:
        self.set_useMathText(True)
        try:
            return super().get_offset()
        finally:
            self.set_useMathText(False)


class _Powers(LogFormatterMathtext):
    """Powers of ten as plain text with raised digits."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        power = round(float(np.log10(x))) if x > 0 else 0
        whole = x > 0 and abs(x / 10.0**power - 1) < 1e-9
        return "10" + str(power).translate(_RAISED) if whole else super().__call__(x, pos)


_RAISED = str.maketrans("-0123456789", "\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079")


def _plain_numbers(axis: Any) -> None:
    formatter = axis.get_major_formatter()
    if type(formatter) is ScalarFormatter:
        axis.set_major_formatter(_Numbers())
    elif axis.get_scale() == "log" and isinstance(formatter, LogFormatterMathtext):
        axis.set_major_formatter(_Powers())
