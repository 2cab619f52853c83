"""Equidistant times that are numbers only when they are asked for: a million of them take no room."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, overload

import numpy as np


@dataclass(frozen=True)
class Grid:
    """The times k ``spacing`` for k = 0 .. ``count`` - 2, then ``end``; indexed and cut as an array of them is."""

    count: int
    spacing: float
    end: float

    def __len__(self) -> int:
        return self.count

    @overload
    def __getitem__(self, place: int) -> float: ...

    @overload
    def __getitem__(self, place: slice) -> Any: ...

    def __getitem__(self, place: int | slice) -> Any:
        if isinstance(place, slice):
            numbers = np.arange(*place.indices(self.count))
            return np.where(numbers == self.count - 1, self.end, numbers * self.spacing)
        number = range(self.count)[place]
        return self.end if number == self.count - 1 else number * self.spacing
