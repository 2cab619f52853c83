"""Numbers that compiled code reads from memory whenever it runs: one kernel serves all their values.

In a program each is an input by a name of its own, which no description can have; it is no input of the kernel.
"""

from __future__ import annotations

from itertools import count
from weakref import WeakValueDictionary

import numpy as np

_ALL: WeakValueDictionary[str, Cells] = WeakValueDictionary()
_NUMBERS = count()


class Cells:
    """``values`` (float64) in memory, which must outlive the code that reads them; ``names`` of them in programs."""

    def __init__(self, size: int) -> None:
        self.values = np.zeros(size)
        number = next(_NUMBERS)
        self.names = tuple(f"cell {number}.{place}" for place in range(size))
        _ALL.update(dict.fromkeys(self.names, self))


def place_of(name: str) -> int | None:
    """Which of its cells a name is; None for the name of anything else."""
    cells = _ALL.get(name)
    return None if cells is None else cells.names.index(name)


def value_of(name: str) -> float:
    """What stands in a cell now.  Raises KeyError for other names."""
    cells = _ALL[name]
    return float(cells.values[cells.names.index(name)])


def address_of(name: str) -> int:
    """Where a cell is.  Raises KeyError for other names."""
    cells = _ALL[name]
    address: int = cells.values.ctypes.data
    return address + cells.names.index(name) * cells.values.itemsize
