"""The rows of a run in a file, block by block: a run of many rows takes no more memory than one of few.

A column holds t, q, q', then the energies (``mbsym.numerics.simulate.raw_energies``), as they are in memory; whoever
opens the file closes it, and nobody else reads it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, BinaryIO

import numpy as np

#: Rows in memory at a time, and how many are shown of a run that has more of them.
BLOCK, SHOWN = 8192, 20_001


class Stored:
    """``width`` numbers a row; arrays of it have rows in columns, of shape (width, k)."""

    def __init__(self, stream: BinaryIO, width: int, kind: Any) -> None:
        self._stream, self.width, self.kind = stream, width, np.dtype(kind)
        self.count = 0

    def append(self, block: Any) -> None:
        """Further rows.  Raises OSError where there is no room."""
        self._stream.seek(self.count * self._bytes)
        self._stream.write(np.ascontiguousarray(block.T, dtype=self.kind).data)
        self.count += block.shape[1]

    def rows(self, start: int, stop: int) -> Any:
        """Rows ``start`` to ``stop`` - 1."""
        self._stream.seek(start * self._bytes)
        data = self._stream.read((stop - start) * self._bytes)
        return np.ascontiguousarray(np.frombuffer(data, self.kind).reshape(-1, self.width).T)

    def at(self, places: Sequence[int]) -> Any:
        """The rows with these numbers."""
        return np.hstack([self.rows(place, place + 1) for place in places])

    def blocks(self) -> Iterator[tuple[int, Any]]:
        """(number of the first row, rows), one after the other."""
        for start in range(0, self.count, BLOCK):
            yield start, self.rows(start, min(start + BLOCK, self.count))

    @property
    def _bytes(self) -> int:
        return self.width * self.kind.itemsize
