"""States of one run at given times, and what they cost in processor time."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import EXTENDED
from mbsym.numerics.methods.interface import Method, Setting, Work


@dataclass(frozen=True)
class Rows:
    """``states`` (2n, m), the work and the processor seconds of the integration, compiling not counted."""

    states: Any
    work: Work
    seconds: float


def rows(method: Method, dynamics: Dynamics, setting: Setting, times: Sequence[float], scalar: str = "float64") -> Rows:
    """The states at increasing times from 0.  Raises Breakdown where they do not reach the last one."""
    run = method.start(dynamics, setting, scalar)
    states = np.empty((len(times), len(run.state)), dtype=np.longdouble if scalar == EXTENDED else float)
    states[0] = run.state
    started = time.thread_time()
    with np.errstate(all="ignore"):
        for place, t in enumerate(times[1:], 1):
            states[place] = run.advance(float(t))
    seconds = time.thread_time() - started
    return Rows(np.ascontiguousarray(states.T), replace(run.work), seconds)
