"""A trajectory as plain CSV: one line of names, then numbers that read back exactly (``%.17g``); no comments.

Columns: ``t``, the coordinates, ``<name>_dot``, ``energy`` (h = q'.dL/dq' - L), ``relative_drift`` ((h - h(0)) over the
largest kinetic energy), then whatever else was asked for.  A trajectory that ends early is told by its file's name and
by ``simulation.json``, not by anything in the table: whoever reads it with default options gets numbers only.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mbsym.model.system import System
from mbsym.numerics.simulate import Trajectory

#: A table has at most so many numbers.
MOST_NUMBERS = 10_000_000

#: Rows turned into text at a time: numbers of Python take more room than those of an array.
BLOCK = 10_000


def columns(system: System) -> tuple[str, ...]:
    """The names of the columns; a coordinate called ``energy`` keeps its name."""
    own = ["t", *system.coordinates, *system.velocities]
    # No declared name ends in an underscore.
    return (*own, *(name + "_" if name in own else name for name in ("energy", "relative_drift")))


def most_rows(system: System, more: int = 0) -> int:
    """How many rows fit into a table of a bearable size."""
    return MOST_NUMBERS // (len(columns(system)) + more)


def trajectory_csv(found: Trajectory, more: Mapping[str, Any] | None = None) -> str:
    """The file's text; ``more`` maps names of further columns to their values, of shape (m,)."""
    further = dict(more or {})
    table = np.vstack([found.times, found.states, found.energy, found.drift, *further.values()])
    return written([*columns(found.system), *further], table.astype(float).T)


def written(names: Sequence[str], rows: Any) -> str:
    """A header and rows of numbers."""
    line = ",".join(["%.17g"] * len(names))
    pieces = [",".join(names)]
    for start in range(0, len(rows), BLOCK):
        pieces.append("\n".join(line % tuple(row) for row in rows[start : start + BLOCK].tolist()))
    return "\n".join([*pieces, ""])
