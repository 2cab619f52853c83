"""The motion in ``report.html``: integrated only where that was asked for, and told why there is none."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.report.figures.animation_page import Motion

_ASKED: ContextVar[float | None] = ContextVar("animate", default=None)


@contextmanager
def animated(time: float | None) -> Iterator[None]:
    """Within this block pages show the motion from 0 to ``time``; None: no page does, and nothing is integrated."""
    token = _ASKED.set(time)
    try:
        yield
    finally:
        _ASKED.reset(token)


def asked_motion(system: System) -> tuple[Motion | None, str]:
    """(the motion, "") or (None, why there is none); (None, "") where it was not asked for."""
    time = _ASKED.get()
    if time is None:
        return None, ""
    from mbsym.algebra.failures import Failure
    from mbsym.numerics.scenario import Incomplete, scenario
    from mbsym.report.figures.animation import animation
    from mbsym.report.figures.animation_page import run_motion
    from mbsym.simulation import Request, simulate
    from mbsym.simulation.request import COORDINATES

    try:
        run = simulate(scenario(system), Request(time, variables=COORDINATES))
    except (Incomplete, Failure) as reason:
        return None, str(reason)
    found = animation(run)
    return (None, "no body has a place that could be drawn") if found is None else (run_motion(found, run), "")
