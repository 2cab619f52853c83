"""A run of very many rows: they go to a file as they come, and what is said about them is accumulated.

``streamed`` gives a Trajectory of some of the rows (for figures, and for whoever asks for states), with the whole of
them behind it.  Among the shown ones are the first, the last, and all at which something is largest or least: what is
said of those is what would be said of all.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, BinaryIO

import numpy as np

from mbsym.numerics.conservation import EVENLY, LARGEST_CHANGES
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import EXTENDED
from mbsym.numerics.methods.interface import Breakdown, Cause, Method, Setting, up_to
from mbsym.numerics.simulate import Trajectory, allowed_apart, fallen, followed, raw_energies

#: (t, q, q') in columns -> further quantities by name, each of shape (m,).
Further = Callable[[Any], Mapping[str, Any]]


@dataclass(frozen=True)
class Table:
    """All rows of a run: ``count`` of them, with ``scale`` for the drift; ``visited`` are, by quantity, the states
    (t, q, q') at which it changes most from one row to the next, and others evenly along the run."""

    dynamics: Dynamics
    stored: Stored
    plain: bool
    scale: float
    further: Further
    visited: Mapping[str, Any]

    @property
    def count(self) -> int:
        """How many rows there are."""
        return self.stored.count

    def blocks(self) -> Iterator[tuple[Any, Mapping[str, Any]]]:
        """((t, q, q') in columns, energies and further quantities by name), a block of rows after the other."""
        first = self.stored.rows(0, 1)
        for _, rows in self.stored.blocks():
            yield from [_quantities(self.dynamics, rows, first, self.plain, self.scale, self.further)]


def streamed(
    dynamics: Dynamics,
    method: Method,
    setting: Setting,
    times: Any,
    stream: BinaryIO,
    scalar: str = "float64",
    watch: Callable[[float], None] = lambda t: None,
    further: Further = lambda points: {},
) -> Trajectory:
    """The same as ``simulate``, with the rows in ``stream`` and some of them in the trajectory.

    Raises OSError where the file has no room for them.
    """
    rows = _Recorder(dynamics, stream, scalar)
    ending = followed(dynamics, method, setting, times, rows, scalar, watch, most=BLOCK)
    table, places = _table(dynamics, rows, further)
    shown = rows.stored.at(places)
    size = 1 + 2 * dynamics.size
    quantities = _quantities(dynamics, shown, rows.stored.rows(0, 1), table.plain, table.scale, lambda points: {})[1]
    natural = dynamics.natural
    return Trajectory(
        system=dynamics.system,
        method=method.traits.name,
        setting=setting,
        times=shown[0].astype(float),
        states=np.ascontiguousarray(shown[1:size]),
        energy=quantities["energy"],
        generalized_energy=quantities["energy"] if natural else quantities["generalized_energy"],
        change=quantities["change"],
        kinetic=shown[size + 1],
        between=rows.kinetic,
        table=table,
        **(vars(ending) | {"passed": up_to(ending.passed, float(shown[0, -1]))}),
    )


class _Recorder:
    """Rows with their energies, to a file; the largest kinetic energy, and the largest of all energies."""

    def __init__(self, dynamics: Dynamics, stream: BinaryIO, scalar: str) -> None:
        self._dynamics, self._scalar = dynamics, scalar
        width = 1 + 2 * dynamics.size + (2 if dynamics.natural else 4)
        self.stored = Stored(stream, width, np.longdouble if scalar == EXTENDED else float)
        self.kinetic = self.largest = 0.0

    @property
    def count(self) -> int:
        return self.stored.count

    def keep(self, times: Any, rows: Any) -> None:
        if not rows.shape[1]:
            return
        points = np.vstack([times, rows])
        raw = raw_energies(self._dynamics, points, self._scalar)
        defined = np.all(np.isfinite(raw.astype(float)), axis=0)
        count = len(defined) if np.all(defined) else max(int(np.argmin(defined)), 0 if self.count else 1)
        fine = np.abs(raw[:, :count][:, defined[:count]]).astype(float)
        self.kinetic = max(self.kinetic, float(np.max(fine[1], initial=0.0)))
        self.largest = max(self.largest, float(np.max(fine[1:], initial=0.0)))
        self.stored.append(np.vstack([points, raw])[:, :count])
        if not np.all(defined):
            first = int(np.argmin(defined))
            message = "the energy is no real number from here on: a root or a logarithm has left its domain"
            raise Breakdown(Cause.UNDEFINED, message, points[0, first], rows[:, first])

    def past(self) -> Any:
        places = _evenly(self.count, SHOWN)
        return self.stored.at(places)[: 1 + 2 * self._dynamics.size].astype(float)


@dataclass
class _Steps:
    """The rows after which a quantity changes most, and the one at which it is farthest from its first value."""

    first: float | None = None
    last: float = 0.0
    farthest: tuple[float, int] = (-1.0, 0)
    largest: list[tuple[float, int]] = field(default_factory=list)

    def see(self, start: int, values: Any) -> None:
        """The values from row ``start`` on."""
        values = np.asarray(values, dtype=float)
        if self.first is None:
            self.first = self.last = float(values[0])
        with np.errstate(all="ignore"):
            away = np.nan_to_num(np.abs(values - self.first), nan=-1.0)
            steps = np.abs(np.diff(values, prepend=self.last))
        steps = np.where(np.isfinite(steps), steps, 0.0)
        place = int(np.argmax(away))
        if away[place] > self.farthest[0]:
            self.farthest = float(away[place]), start + place
        own = np.argsort(-steps, kind="stable")[:LARGEST_CHANGES]
        candidates = self.largest + [(float(steps[k]), start + int(k) - 1) for k in own if start + k > 0]
        self.largest = sorted(candidates, key=lambda change: (-change[0], change[1]))[:LARGEST_CHANGES]
        self.last = float(values[-1])

    def places(self, count: int) -> list[int]:
        """As ``conservation.visited`` chooses them."""
        return sorted({*_evenly(count, EVENLY), *(place + side for _, place in self.largest for side in (0, 1))})


def _table(dynamics: Dynamics, rows: _Recorder, further: Further) -> tuple[Table, list[int]]:
    """The table, and the numbers of the rows that are shown."""
    stored, size = rows.stored, 1 + 2 * dynamics.size
    first = stored.rows(0, 1)
    plain = not dynamics.natural and _apart(stored, size) > allowed_apart(rows.kinetic, rows.largest)
    scale = rows.kinetic or abs(float(first[-1 if not dynamics.natural else size, 0])) or 1.0
    steps: dict[str, _Steps] = {}
    kinetic, pivot = (-1.0, 0), (np.inf, 0)
    for start, block in stored.blocks():
        points, quantities = _quantities(dynamics, block, first, plain, scale, further)
        for name, values in quantities.items():
            steps.setdefault(name, _Steps()).see(start, values)
        highest = int(np.argmax(np.abs(block[size + 1])))
        kinetic = max(kinetic, (float(abs(block[size + 1, highest])), start + highest), key=lambda extreme: extreme[0])
        left = fallen(dynamics, points.astype(float), first[:size, 0].astype(float))
        pivot = min(pivot, (float(np.min(left)), start + int(np.argmin(left))), key=lambda extreme: extreme[0])
    visited = {name: stored.at(step.places(stored.count))[:size].astype(float) for name, step in steps.items()}
    places = {*_evenly(stored.count, SHOWN), kinetic[1], pivot[1], *(step.farthest[1] for step in steps.values())}
    return Table(dynamics, stored, plain, scale, further, visited), sorted(places)


def _apart(stored: Stored, size: int) -> float:
    """The largest difference of h - h(0) in the two frames."""
    first = stored.rows(0, 1)
    apart = 0.0
    for _, block in stored.blocks():
        change = block - first
        apart = max(apart, float(np.max(np.abs(change[-1] - change[size]), initial=0.0)))
    return apart


def _quantities(
    dynamics: Dynamics, rows: Any, first: Any, plain: bool, scale: float, further: Further
) -> tuple[Any, dict[str, Any]]:
    """((t, q, q'), energies, their change, the drift and further quantities by name) of stored rows."""
    size = 1 + 2 * dynamics.size
    points, energies = rows[:size], rows[size:]
    change = energies[0] - first[size] if not plain else energies[-1] - first[-1]
    quantities = {"energy": energies[0 if dynamics.natural else 2], "change": change, "relative_drift": change / scale}
    if not dynamics.natural:
        quantities["generalized_energy"] = energies[3]
    return points, quantities | dict(further(points))


def _evenly(count: int, most: int) -> list[int]:
    """At most so many rows, the first and the last among them."""
    places: list[int] = np.linspace(0, count - 1, min(count, most)).astype(int).tolist()
    return places


# The rows of a run in a file, block by block: a run of many rows takes no more memory than one of few.
#
# A column holds t, q, q', then the energies (``mbsym.numerics.simulate.raw_energies``), as they are in memory; whoever
# opens the file closes it, and nobody else reads it.


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
