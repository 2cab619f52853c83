"""At which times a trajectory is shown."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, pi
from typing import Any, overload

import numpy as np

from mbsym.model.system import System
from mbsym.numerics.columns import most_rows
from mbsym.simulation.request import Request

#: Rows unless asked for otherwise (more of them where the motion is fast), and rows a period of the fastest motion.
SAMPLES, MOST_SAMPLES, SAMPLES_A_PERIOD = 2001, 20_001, 100


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


def sample_times(request: Request, frequency: float, system: System) -> Any:
    """Times from 0 to the end, the end included: a hundred a period of the fastest oscillation, within bounds."""
    if request.earlier is not None:
        further = request.earlier.further(request.time, request.every, request.samples)
        return np.concatenate((request.earlier.times, further))
    if request.streams and request.rows is not None:
        rows = request.rows
        return Grid(rows, request.every or request.time / (rows - 1), request.time)
    if request.every is not None:
        times = np.arange(ceil(request.time / request.every * (1 - 1e-12)) + 1) * request.every
        times[-1] = request.time
        return times
    if request.samples is not None:
        return np.linspace(0.0, request.time, request.samples)
    wanted = SAMPLES_A_PERIOD * frequency * request.time / (2 * pi)
    fitting = min(max(SAMPLES, int(min(wanted, MOST_SAMPLES))), MOST_SAMPLES, most_rows(system))
    if request.step is None:
        return np.linspace(0.0, request.time, fitting)
    # A polynomial knows less than a method of fixed step: rows stand at whole numbers of steps, and at the end.
    steps = max(1, ceil(request.time / request.step * (1 - 1e-12)))
    apart = max(1, ceil(steps / (fitting - 1)))
    return np.append(np.arange(0, steps, apart) * request.step, request.time)
