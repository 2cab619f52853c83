"""What all figures share: the style, colours, and drawing without a display and without global state."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from io import BytesIO
from typing import Any

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

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
    "axes.formatter.use_mathtext": True,
    "lines.linewidth": 1.2,
    "lines.solid_joinstyle": "round",
    "agg.path.chunksize": 20_000,
    "svg.hashsalt": "mbsym",
    "svg.fonttype": "path",
    "savefig.dpi": 150,
}

#: Colours of a PNG; lines need no more.
COLOURS = 192

BLUE, RED, GREY = "#1f5fa8", "#b3372f", "#888888"


@contextmanager
def styled() -> Iterator[None]:
    """Drawn inside, figures have our style, whatever the user's is."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(STYLE)
        yield


def pictures(drawings: Mapping[str, Callable[[], Figure]], formats: Sequence[str]) -> dict[str, bytes]:
    """Every figure in every format, by file name; equal figures give equal bytes (with one version of matplotlib)."""
    with styled():
        return {
            name: content for stem, draw in drawings.items() for name, content in saved(stem, draw(), formats).items()
        }


def saved(stem: str, figure: Figure, formats: Sequence[str]) -> dict[str, bytes]:
    """The bytes of a figure in every format, by file name."""
    FigureCanvasAgg(figure)
    # Arranging takes longer than drawing: once for all formats.
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    found = {}
    for kind in formats:
        stream = BytesIO()
        metadata = {"Date": None, "Creator": "mbsym"} if kind == "svg" else {"Software": "mbsym"}
        figure.savefig(stream, format=kind, metadata=metadata)
        found[f"{stem}.{kind}"] = _with_palette(stream) if kind == "png" else stream.getvalue()
    return found


def _with_palette(stream: BytesIO) -> bytes:
    """A PNG with COLOURS colours instead of as many as there are: the file is a third as large."""
    smaller = BytesIO()
    with Image.open(stream) as image:
        reduced = image.convert("RGB").quantize(COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
        reduced.save(smaller, "png", optimize=True, dpi=image.info.get("dpi"))
    return smaller.getvalue()
