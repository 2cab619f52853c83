"""Chunks of a sweep measured by the workers of a Dask scheduler.

A worker gets the description and the request as plain data, derives the measure once, and sends back columns.
"""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import Future
from functools import lru_cache
from typing import Any

from mbsym.batch.cluster import Connection
from mbsym.batch.digests import derivation
from mbsym.model.system import System
from mbsym.source import read, to_yaml
from mbsym.sweeps.points import Measure
from mbsym.sweeps.sweep import Asked, Chunk, Columns, measure_of


class Workers:
    """An executor of chunks.  Raises NoCluster where there is no cluster."""

    def __init__(self, address: str, jobs: int, system: System, asked: Asked) -> None:
        self._there = Connection(address, jobs)
        self._text, self._asked = to_yaml(system), asked

    @property
    def width(self) -> int:
        return self._there.width

    def submit(self, chunk: Chunk) -> Future[Columns]:
        future: Future[Columns] = self._there.executor.submit(at_worker, self._text, self._asked, chunk, derivation())
        return future

    def close(self) -> None:
        self._there.close()


def at_worker(description: str, request: Asked, chunk: Chunk, version: str) -> Mapping[str, Any]:
    """The columns of a chunk.  Raises RuntimeError where this worker is of another version."""
    if derivation() != version:
        raise RuntimeError("a worker has another version of mbsym")
    points = request.points.part(chunk.start, chunk.stop)
    return dict(_measure(description, repr(request), _Held(request)).at(points))


class _Held:
    """A request that equals every other one: what tells them apart is its text."""

    def __init__(self, asked: Asked) -> None:
        self.asked = asked

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Held)

    def __hash__(self) -> int:
        return 0


@lru_cache(maxsize=4)
def _measure(description: str, request: str, held: _Held) -> Measure:
    system, complaints = read(description)
    if system is None:
        raise RuntimeError(f"the description does not survive the journey: {complaints.sorted()[0].message}")
    return measure_of(system, held.asked)
