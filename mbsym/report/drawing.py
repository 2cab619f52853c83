"""What all figures share: the style, colours, and drawing without a display and without global state."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from io import BytesIO

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

FORMATS = ("svg", "png")

STYLE = {
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
    "savefig.dpi": 150,
}

BLUE, RED, GREY = "#1f5fa8", "#b3372f", "#888888"


def pictures(drawings: Mapping[str, Callable[[], Figure]], formats: Sequence[str]) -> dict[str, bytes]:
    """Every figure in every format, by file name; equal figures give equal bytes (with one version of matplotlib)."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(STYLE)
        return {f"{name}.{kind}": saved(draw(), kind) for name, draw in drawings.items() for kind in formats}


def saved(figure: Figure, kind: str) -> bytes:
    """The bytes of a figure."""
    FigureCanvasAgg(figure)
    stream = BytesIO()
    metadata = {"Date": None, "Creator": "mbsym"} if kind == "svg" else {"Software": "mbsym"}
    figure.savefig(stream, format=kind, metadata=metadata)
    return stream.getvalue()
