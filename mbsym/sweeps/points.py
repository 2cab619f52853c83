"""The parameter values of a sweep, of which any stretch can be had by itself: chunks are made where they are used.

A grid takes every combination of equally spaced values, ends included, the last name varying fastest.  Draws are joint:
NumPy's PCG64 or Sobol's sequence (scrambled, SciPy); the points are the same for the same seed, however they are cut.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import prod
from typing import Any, Protocol

import numpy as np

from mbsym.numerics.ensembles.variation import RANDOM, SOBOL, Draw, Grid, Variation

#: More points than this are refused: a picture of so many says no more, and their numbers fill disks.
MOST_POINTS = 1_000_000_000


@dataclass(frozen=True)
class Points:
    """``variations`` are all grids, or all draws with ``members`` points in all."""

    variations: tuple[Variation, ...]
    members: int = 0
    seed: int = 1
    sampling: str = RANDOM

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(variation.name for variation in self.variations)

    @property
    def grids(self) -> tuple[Grid, ...]:
        """The axes of a grid; nothing where points are drawn."""
        return tuple(variation for variation in self.variations if isinstance(variation, Grid))

    @cached_property
    def count(self) -> int:
        return prod(grid.count for grid in self.grids) if self.grids else self.members

    def part(self, start: int, stop: int) -> Any:
        """The points number ``start`` to ``stop`` - 1, shape (names, stop - start)."""
        if self.grids:
            places = np.unravel_index(np.arange(start, stop), [grid.count for grid in self.grids])
            return np.array([grid.values[place] for grid, place in zip(self.grids, places, strict=True)])
        chances = self._chances(start, stop)
        draws = [variation for variation in self.variations if isinstance(variation, Draw)]
        return np.array([draw.at(row) for draw, row in zip(draws, chances, strict=True)])

    def _chances(self, start: int, stop: int) -> Any:
        """Points of the unit cube, shape (names, stop - start)."""
        count = len(self.variations)
        if self.sampling == SOBOL:
            import warnings

            from scipy.stats import qmc

            sequence = qmc.Sobol(count, scramble=True, rng=self.seed)
            if start:
                sequence.fast_forward(start)
            with warnings.catch_warnings():  # that a number of points is no power of 2 costs some evenness, no more
                warnings.simplefilter("ignore", UserWarning)
                return sequence.random(stop - start).T
        bits = np.random.PCG64(self.seed)
        bits.advance(start * count)
        return np.random.Generator(bits).random((stop - start, count)).T


# What is measured at the points of a sweep: columns of numbers, a measure a file.
#
# A measure is made once; then it gives the columns of any points, in threads side by side: the work is done in machine
# code and in NumPy, which leave other threads alone.


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
