"""What is measured at the points of a sweep: columns of numbers, a measure a file.

A measure is made once; then it gives the columns of any points, in threads side by side: the work is done in machine
code and in NumPy, which leave other threads alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

#: More points than this are refused: a picture of so many says no more, and their numbers fill disks.
MOST_POINTS = 1_000_000_000


@dataclass(frozen=True)
class Column:
    """``words`` are what its whole numbers stand for, where they are codes; ``meaning`` says what is in it.

    ``title`` is what figures call it.
    """

    name: str
    meaning: str
    words: tuple[str, ...] = ()
    whole: bool = False
    title: str = ""


class Measure(Protocol):
    """Something of a system at numbers for its parameters."""

    @property
    def columns(self) -> tuple[Column, ...]: ...

    def at(self, points: Any) -> Mapping[str, Any]:
        """Arrays (m,) by the columns' names, for points of shape (names, m)."""
        ...
