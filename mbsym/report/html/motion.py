"""The motion in ``report.html``: integrated only where that was asked for, and told why there is none."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mbsym.expressions.message import Message

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.report.figures.animation_page import Motion
    from mbsym.report.language import Language


def asked_motion(system: System, time: float | None, language: Language) -> tuple[Motion | None, str]:
    """(the motion from 0 to ``time``, "") or (None, why there is none); (None, "") where it was not asked for."""
    if time is None:
        return None, ""
    from mbsym.algebra.failures import Failure, message_of
    from mbsym.numerics.scenario import Incomplete, scenario
    from mbsym.report.figures.animation import animation
    from mbsym.report.figures.animation_page import run_motion
    from mbsym.simulation import Request, simulate
    from mbsym.simulation.request import COORDINATES

    try:
        run = simulate(scenario(system), Request(time, variables=COORDINATES))
    except (Incomplete, Failure) as reason:
        return None, language.say(message_of(reason))
    found = animation(run)
    nothing = language.say(Message("no body has a place that could be drawn"))
    return (None, nothing) if found is None else (run_motion(found, run, language), "")
