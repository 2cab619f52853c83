"""The names of a trajectory's columns, and how many rows of them make a table of a bearable size."""

from __future__ import annotations

from mbsym.model.system import System

#: A table in memory has at most so many numbers, and one in a file, where they take 25 bytes each at most.
MOST_NUMBERS, MOST_IN_FILE = 10_000_000, 2_000_000_000


def columns(system: System, natural: bool = True) -> tuple[str, ...]:
    """``t``, coordinates, velocities, ``energy`` (T - U), ``generalized_energy`` (T2 - T0 - U) where that is another
    quantity (not ``natural``), and ``relative_drift``; a coordinate called ``energy`` keeps its name."""
    own = ["t", *system.coordinates, *system.velocities]
    more = ("energy", "relative_drift") if natural else ("energy", "generalized_energy", "relative_drift")
    # No declared name ends in an underscore.
    return (*own, *(name + "_" if name in own else name for name in more))


def most_rows(system: System, more: int = 0) -> int:
    """How many rows fit into a table in memory, with so many columns more."""
    return MOST_NUMBERS // (len(columns(system, natural=False)) + more)


def most_rows_in_file(system: System) -> int:
    """How many rows a table has that goes to its file part by part."""
    return MOST_IN_FILE // len(columns(system, natural=False))
