"""A sweep: chunks of points measured side by side, each kept in a file of its own when it is done.

Which chunks there are follows from the points alone, so that what one run began another one goes on with, on this
machine or on another, and shards i of n divide the work without talking to each other.
"""

from __future__ import annotations

import hashlib
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from fractions import Fraction
from io import BytesIO
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from mbsym.analysis import Analysis
from mbsym.expressions.tree import Expression, number, text
from mbsym.maps.section import Axis, Section, Unfit, section
from mbsym.model.system import System
from mbsym.numerics.ensembles.variation import Points
from mbsym.numerics.scenario import scenario
from mbsym.sweeps.points import Measure

# What a sweep is asked for, as plain data that another machine can read, and the measure that it means.


STABILITY, EIGENVALUES, DAMPING, FREQUENCY = "stability", "eigenvalues", "damping", "frequency"
#: What is measured by name; anything else is a formula.
MEASURES = (STABILITY, EIGENVALUES, DAMPING, FREQUENCY)


@dataclass(frozen=True)
class Asked:
    """``ends``: the interval in which each varied name lies; ``settings``: numbers in place of the description's.

    ``measure`` is one of ``MEASURES``, or "" where ``formula`` is measured: at the parameters, or with a ``time`` along
    the motion.
    """

    points: Points
    ends: Mapping[str, tuple[Fraction, Fraction]]
    settings: Mapping[str, Fraction]
    measure: str
    formula: Expression | None = None
    time: float | None = None

    @property
    def name(self) -> str:
        """What is measured, in words."""
        if self.formula is None:
            return self.measure
        return text(self.formula) if self.time is None else f"simulate:{text(self.formula)} to t = {self.time:.12g}"

    def digest(self, described: str, version: str) -> str:
        """SHA-256 of everything that the numbers follow from: description (its digest), version, request."""
        contents = repr((described, version, self.points, sorted(self.ends.items()), sorted(self.settings.items())))
        return hashlib.sha256((contents + self.name + repr(self.time)).encode()).hexdigest()


def measure_of(system: System, sweep_request: Asked) -> Measure:
    """The measure, derived and compiled.

    Raises Unfit (with all complaints) where the parameters fit no section, Failure where it cannot be derived.
    """
    if sweep_request.time is not None and sweep_request.formula is not None:
        from mbsym.sweeps.roots import SimulatedMeasure

        overrides = {name: number(value) for name, value in sweep_request.settings.items()}
        motion, said = scenario(system, overrides, assumed=False), text(sweep_request.formula)
        return SimulatedMeasure(
            motion, overrides, sweep_request.points.names, sweep_request.formula, said, sweep_request.time
        )
    analysis = Analysis(system)
    axes = [Axis(name, *sweep_request.ends[name]) for name in sweep_request.points.names]
    try:
        map_section = section(analysis, axes, sweep_request.settings)
    except Unfit as unfit:
        if sweep_request.measure != STABILITY or not unfit.irrational:
            raise
        from mbsym.sweeps.judged import SingleVerdicts

        return SingleVerdicts(analysis, axes, sweep_request.settings, unfit)
    if sweep_request.formula is not None:
        from mbsym.sweeps.formula import FormulaMeasure

        return FormulaMeasure(map_section, sweep_request.formula, text(sweep_request.formula))
    if sweep_request.measure == STABILITY:
        from mbsym.sweeps.judged import StabilityMeasure

        return StabilityMeasure(analysis, map_section)
    from mbsym.sweeps import roots

    kinds: dict[str, Callable[[Section, str], Measure]] = {
        EIGENVALUES: roots.RootsMeasure,
        DAMPING: roots.DampingMeasure,
        FREQUENCY: roots.FrequencyMeasure,
    }
    scale = analysis.system.time_scale
    return kinds[sweep_request.measure](
        map_section, "the description's unit of 1/time" if scale is None else text(scale)
    )


#: Points that are measured at once: enough that compiled code dominates, few enough for the caches and for Ctrl-C.
CHUNK = 65_536

Columns = Mapping[str, Any]


@dataclass(frozen=True)
class Chunk:
    """The points number ``start`` to ``stop`` - 1."""

    number: int
    start: int
    stop: int


def chunks(count: int, size: int = CHUNK) -> tuple[Chunk, ...]:
    """All chunks of so many points."""
    return tuple(Chunk(k, start, min(start + size, count)) for k, start in enumerate(range(0, count, size)))


def shard(every: Sequence[Chunk], number: int, of: int) -> tuple[Chunk, ...]:
    """Every ``of``-th chunk, the first of them number ``number`` (from 1)."""
    return tuple(every[number - 1 :: of])


class Executor(Protocol):
    """Where chunks are measured; ``width`` is how many are worth being there at once."""

    @property
    def width(self) -> int: ...

    def submit(self, chunk: Chunk) -> Future[Columns]: ...

    def close(self) -> None: ...


class Threads:
    """This process: ``jobs`` chunks at a time."""

    def __init__(self, measure: Callable[[], Measure], points: Points, jobs: int) -> None:
        self.width = 2 * jobs
        self._measure, self._points = measure, points
        self._pool = ThreadPoolExecutor(jobs, thread_name_prefix="mbsym-sweep")

    def submit(self, chunk: Chunk) -> Future[Columns]:
        return self._pool.submit(self._work, chunk)

    def _work(self, chunk: Chunk) -> Columns:
        return self._measure().at(self._points.part(chunk.start, chunk.stop))

    def close(self) -> None:
        self._pool.shutdown(wait=True, cancel_futures=True)


class Store(Protocol):
    """Where finished chunks are kept."""

    def load(self, chunk: Chunk) -> Columns | None: ...

    def save(self, chunk: Chunk, columns: Columns) -> None: ...


def measured(wanted_chunks: Sequence[Chunk], executor: Executor, store: Store) -> Iterator[Chunk]:
    """Measures what is not kept yet; yields every chunk when it is kept."""
    pending: dict[Future[Columns], Chunk] = {}
    waiting = iter(wanted_chunks)
    following = next(waiting, None)
    while following is not None or pending:
        while following is not None and len(pending) < executor.width:
            if store.load(following) is not None:
                yield following
            else:
                pending[executor.submit(following)] = following
            following = next(waiting, None)
        if not pending:
            continue
        done, _ = wait(pending, return_when=FIRST_COMPLETED)
        for future in done:
            chunk = pending.pop(future)
            store.save(chunk, future.result())
            yield chunk


# Where a sweep keeps its finished chunks: a file each, named by what they follow from.
#
#     chunks/<16 digits of the SHA-256 of description, request and version>-<number>.npz
#
# A file is whole or not there.  Another description, request or version has other names, so nothing stale is ever read.


class Folder:
    """The chunks of one sweep in ``folder/chunks``; ``write`` writes a file that is whole or not there."""

    def __init__(
        self, folder: Path, digest: str, columns: tuple[str, ...], write: Callable[[Path, bytes], object]
    ) -> None:
        self.folder, self.digest, self.columns, self.write = folder / "chunks", digest[:16], columns, write

    def path(self, chunk: Chunk) -> Path:
        return self.folder / f"{self.digest}-{chunk.number:06d}.npz"

    def load(self, chunk: Chunk) -> Mapping[str, Any] | None:
        """The columns; None where they are not there, or are not what they should be."""
        try:
            with np.load(self.path(chunk), allow_pickle=False) as stored:
                columns = {name: stored[name] for name in self.columns}
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
            return None
        if any(values.shape != (chunk.stop - chunk.start,) for values in columns.values()):
            return None
        return columns

    def save(self, chunk: Chunk, columns: Mapping[str, Any]) -> None:
        stream = BytesIO()
        np.savez_compressed(stream, **{name: columns[name] for name in self.columns})
        self.write(self.path(chunk), stream.getvalue())
