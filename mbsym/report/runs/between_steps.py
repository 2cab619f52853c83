"""What is said of switches and narrow features on the way of a run: for the terminal and for ``simulation.json``."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.expressions.tree import text
from mbsym.numerics.events.surfaces import source_of
from mbsym.numerics.methods.passed import Narrow, Passed
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
        narrow=[doc.Narrow(time=one.time, width=one.width, step=one.step) for one in passed.narrow],
        unresolved=[float(t) for t in passed.unresolved],
    )


def switch_line(passed: Passed | None) -> str:
    """``2, at t = 5 and 5.002: a step ends at each``; empty where nothing was switched."""
    if passed is None or not passed.switches:
        return ""
    times = [f"{float(t):.9g}" for t in passed.switches[:SHOWN]]
    more = ", ..." if len(passed.switches) > SHOWN else ""
    return f"{len(passed.switches)}, at t = {', '.join(times)}{more}: a step ends at each"


def passed_over(run: Simulation, file: str) -> Iterator[str]:
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
        yield (
            f"in the step at t = {passed.unresolved[0]:.6g} changes of side follow one another too quickly to be told "
            f"apart: {_command(run, file, run.trajectory.setting.step or 1e-3)}"
        )


def _told(run: Simulation, one: Narrow, file: str) -> str:
    found = None if one.place is None else source_of(run.dynamics, one.place)
    what = "a load" if found is None else f"{text(found)}"
    where = "" if found is None or found.span is None else f" (line {found.span.line}, column {found.span.column})"
    return (
        f"{what}{where} changes within {one.width:.2g} at t = {one.time:.6g}, and a step of {one.step:.2g} passed it: "
        f"{_command(run, file, one.width / 4)}"
    )


def _command(run: Simulation, file: str, step: float) -> str:
    """The command once more, with steps that are short enough."""
    option = "--step" if run.trajectory.setting.step is not None else "--max-step"
    method = f" --method {run.method}" if run.request.method != "auto" else ""
    return f"mbsym simulate {file} --time {run.request.time:g}{method} {option} {step:.2g}"
