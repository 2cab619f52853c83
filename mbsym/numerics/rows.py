"""States of one run at given times, and what they cost in processor time."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.interface import Method, Setting, Work

#: Where within a step, its end included, and how many places in all.
SHARES = np.array([0.17, 0.38, 0.61, 0.83, 1.0])
MOST = 20_000


@dataclass(frozen=True)
class Rows:
    """``states`` (2n, m), the work and the processor seconds of the integration, compiling not counted."""

    states: Any
    work: Work
    seconds: float


def rows(method: Method, dynamics: Dynamics, setting: Setting, times: Any, scalar: str = "float64") -> Rows:
    """The states at increasing times from 0.  Raises Breakdown where they do not reach the last one."""
    run = method.start(dynamics, setting, scalar)
    start = np.array(run.state)[:, np.newaxis]
    started = time.thread_time()
    with np.errstate(all="ignore"):
        states = run.fill(np.asarray(times[1:], dtype=float))
    seconds = time.thread_time() - started
    return Rows(np.ascontiguousarray(np.hstack([start, states])), replace(run.work), seconds)


def places(method: Method, dynamics: Dynamics, setting: Setting, end: float) -> Any:
    """Times from 0 to ``end`` that follow the steps of a run, ``SHARES`` of each inside it; at most about ``MOST``.

    Raises Breakdown where the run does not come to the end.
    """
    run = method.start(dynamics, setting)
    found = [np.zeros(1)]
    with np.errstate(all="ignore"):
        while run.time < end:
            piece = run.step(end)
            found.append(piece.start + SHARES * (piece.end - piece.start))
    times = np.unique(np.append(np.concatenate(found), end))
    times = times[times <= end]
    every = -(-len(times) // MOST)
    return times if every == 1 else np.union1d(times[::every], [end])
