"""What is said of switches and narrow features on the way of a run: for the terminal and for ``simulation.json``."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.expressions.message import Message
from mbsym.expressions.tree import text
from mbsym.numerics.events.surfaces import source_of
from mbsym.numerics.methods.interface import Narrow, Passed
from mbsym.report.documents import simulation as doc

if TYPE_CHECKING:
    from mbsym.simulation import Simulation

#: So many times are shown.
SHOWN = 4


def between_steps_json(passed: Passed | None) -> doc.BetweenSteps | None:
    """Times of switches, narrow features with the steps that passed them."""
    if passed is None:
        return None
    return doc.BetweenSteps(
        switches=[float(t) for t in passed.switches],
        narrow=[doc.Narrow.from_result(one) for one in passed.narrow],
        unresolved=[float(t) for t in passed.unresolved],
    )


def switch_line(passed: Passed | None) -> Message | None:
    """``2, at t = 5 and 5.002: a step ends at each``; None where nothing was switched."""
    if passed is None or not passed.switches:
        return None
    times = [f"{float(t):.9g}" for t in passed.switches[:SHOWN]] + ["..."] * (len(passed.switches) > SHOWN)
    text = "[[count]], at t = [[times]]: a step ends at each"
    return Message(text, count=len(passed.switches), times=", ".join(times))


def passed_over(run: Simulation, file: str) -> Iterator[Message]:
    """A sentence for every function that steps were too long for, where it stands, and the command that helps."""
    passed = run.trajectory.passed
    if passed is None:
        return
    seen: set[int | None] = set()
    for one in passed.narrow:
        if one.followed or one.place in seen:
            continue
        seen.add(one.place)
        yield _told(run, one, file)
    if passed.unresolved:
        words = (
            "in the step at t = [[time]] changes of side follow one another too quickly to be told apart: [[command]]"
        )
        command = _command(run, file, run.trajectory.setting.step or 1e-3)
        yield Message(words, time=f"{passed.unresolved[0]:.6g}", command=command)


def _told(run: Simulation, one: Narrow, file: str) -> Message:
    found = None if one.place is None else source_of(run.dynamics, one.place)
    what = Message("a load") if found is None else text(found)
    if found is not None and found.span is not None:
        where = "[[what]] (line [[line]], column [[column]])"
        what = Message(where, what=what, line=found.span.line, column=found.span.column)
    words = "[[what]] changes within [[width]] at t = [[time]], and a step of [[step]] passed it: [[command]]"
    width, time, step = f"{one.width:.2g}", f"{one.time:.6g}", f"{one.step:.2g}"
    return Message(words, what=what, width=width, time=time, step=step, command=_command(run, file, one.width / 4))


def _command(run: Simulation, file: str, step: float) -> str:
    """The command once more, with steps that are short enough."""
    option = "--step" if run.trajectory.setting.step is not None else "--max-step"
    method = f" --method {run.method}" if run.request.method != "auto" else ""
    return f"mbsym simulate {file} --time {run.request.time:g}{method} {option} {step:.2g}"
