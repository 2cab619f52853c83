"""The process of a job: loads the library, waits for one task, tells what becomes of it, and ends.

What it tells goes through its connection as dictionaries: ``kind`` and what belongs to it (``jobs`` has the list).
When the server is gone, however it went, the process ends, too.
"""

from __future__ import annotations

import os
import sys
import time
import traceback
from base64 import b64encode
from collections.abc import Iterator, Mapping
from contextlib import suppress
from fractions import Fraction
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING, Any

from markupsafe import escape

from mbsym.algebra.failures import Failure
from mbsym.algebra.parts import missing
from mbsym.batch.worker import OUT_OF_MEMORY, PENDULUM, bounded, hang_on
from mbsym.source import read

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.model.system import System

#: Tasks that fill a page by and by.
PATIENT = ("derive", "export", "map")


def warm() -> None:
    """Loads what every job needs, and has used it once."""

    with suppress(Exception):
        for _ in perform({"kind": "derive", "text": PENDULUM, "name": "pendulum.yaml", "problems": [1, 3, 6]}):
            pass
        for _ in perform({"kind": "picture", "text": PENDULUM, "name": "pendulum.yaml"}):
            pass


def attend(connection: Connection, memory: int, cold: bool = False) -> None:
    """What a process does; never returns.  A ``cold`` one has its task already, and loads what that needs."""
    code = 1
    try:
        if not cold and "mbsym.serving.warmed" not in sys.modules:  # else it was forked from one that is warm
            warm()
        connection.send({"kind": "ready"})
        task: dict[str, Any] = connection.recv()
        _step_back(task)
        hang_on(connection.fileno())
        bounded(memory)

        for message in perform(task):
            connection.send(message)
        connection.send({"kind": "done"})
        code = 0
    except MemoryError:
        code = OUT_OF_MEMORY
    except (EOFError, ConnectionError, KeyboardInterrupt):
        code = 0  # nobody listens any more
    except BaseException as error:
        traceback.print_exc()
        with suppress(Exception):
            connection.send({"kind": "failed", "words": f"internal error: {type(error).__name__}: {error}"})
            code = 0
    finally:
        with suppress(Exception):
            sys.stdout.flush()
            sys.stderr.flush()
        # What is left is to take down what was built up, for nobody.
        os._exit(code)


def _step_back(task: dict[str, Any]) -> None:
    """What takes long lets what somebody waits for go first: the picture, the motion."""
    if task.get("kind") in PATIENT and hasattr(os, "nice"):
        with suppress(OSError):
            os.nice(10)


# What a job does, in a process of its own: a generator of what there is to tell, section by section.


Message = dict[str, Any]
Task = Mapping[str, Any]


class Refused(Exception):
    """With words that say why a job cannot be done."""


def perform(task: Task) -> Iterator[Message]:
    """What a task leads to.  A failure that was foreseen is told as the last message; a defect is raised."""
    from mbsym.analysis.stages import Unavailable
    from mbsym.numerics.scenario import Incomplete

    try:
        yield from _KINDS[task["kind"]](task, _system(task))
    except (Refused, Failure, Unavailable, Incomplete, ValueError, ArithmeticError) as error:
        yield {"kind": "failed", "words": str(error) or type(error).__name__}
    except ModuleNotFoundError as error:
        if not missing(error):
            raise
        yield {"kind": "failed", "words": f"{missing(error)} is not installed"}


def _system(task: Task) -> System:
    from mbsym.analysis.soundness import complain

    folder = Path(task["folder"]) if task.get("folder") else None
    system, complaints = read(task["text"], task["name"], folder)
    if system is not None and not complaints.errors:
        complain(system, complaints)
    if system is None or complaints.errors:
        first = next(iter(complaints.errors), None)
        raise Refused("the description has mistakes" + (f": {first.message}" if first else ""))
    return system


def _rational(value: object, words: str) -> Fraction:
    """Raises Refused, with these words."""
    try:
        return Fraction(str(value))
    except (ValueError, ZeroDivisionError) as error:
        raise Refused(words) from error


# --- results ----------------------------------------------------------------------------------------------------------


def _derive(task: Task, system: System) -> Iterator[Message]:
    from mbsym.report.html.report import title
    from mbsym.report.whole_run import analysis_of

    analysis = analysis_of(system, task.get("problems") or None, ("html",))
    analysis.language, problems = task.get("language") or "", analysis.problems
    yield {"kind": "plan", "sections": [[str(x), title(analysis, x)] for x in _plan(analysis)]}
    yield _section(analysis, "system", ())
    done: list[int] = []
    sent: dict[int, Any] = {}
    for number in problems:
        yield {"kind": "progress", "words": title(analysis, number), "done": len(done), "of": len(problems)}
        sent[number] = analysis.stage(number).failure
        done.append(number)
        yield _section(analysis, number, tuple(done))
    if system.claims:
        yield {"kind": "progress", "words": "claims", "done": len(done), "of": len(problems)}
        yield _section(analysis, "claims", problems)
    yield {"kind": "progress", "words": "self-check", "done": len(done), "of": len(problems)}
    if analysis.checks:
        yield _section(analysis, "checks", problems)
    for number in problems:  # what a failed check supported is withdrawn
        if analysis.stage(number).failure is not sent[number]:
            yield _section(analysis, number, problems)
    yield _section(analysis, "summary", problems)


def _plan(analysis: Analysis) -> list[str | int]:
    return ["summary", "system", *analysis.problems, *(["claims"] if analysis.system.claims else []), "checks"]


def _section(analysis: Analysis, part: str | int, problems: tuple[int, ...]) -> Message:
    from mbsym.report.html.report import part_html, title

    started, state = time.perf_counter(), "derived"
    if isinstance(part, int):
        failure = analysis.stage(part).failure
        state = "derived" if failure is None else "failed" if failure.error is not None else "refused"
    try:
        html = part_html(analysis, part, problems)
    except MemoryError:
        raise
    except Exception as error:  # a template that fails costs its section
        html, state = str(escape(f"It cannot be shown: {type(error).__name__}: {error}")), "failed"
    seconds = time.perf_counter() - started
    if isinstance(part, int):
        seconds += analysis.stage(part).seconds
    return {
        "kind": "section",
        "problem": str(part),
        "title": title(analysis, part),
        "state": state,
        "seconds": round(seconds, 3),
        "html": html,
    }


def _export(task: Task, system: System) -> Iterator[Message]:
    """All files of the formats asked for, as ``mbsym run`` makes them."""
    from mbsym.report.targets import FORMATS
    from mbsym.report.whole_run import analysis_of, lost, silent, whole_run

    formats = [name for name in task["formats"] if name in FORMATS]
    analysis = analysis_of(system, task.get("problems") or None, formats)
    analysis.language = task.get("language") or ""
    files = whole_run(analysis, formats, silent)
    words = [f"{where}: {failure.reason}" for where, failure in lost(analysis, files)]
    words += [f"self-check failed: {check.name}: {check.detail}" for check in analysis.checks if check.failed]
    yield {
        "kind": "files",
        "files": {file.filename: file.text for file in files if file.text is not None},
        "gone": [file.filename for file in files if file.text is None],
        "words": words,
    }


# --- the picture ------------------------------------------------------------------------------------------------------


def _picture(task: Task, system: System) -> Iterator[Message]:
    from mbsym.picture import as_json, picture
    from mbsym.simulation.request import read_values

    yield {"kind": "picture", "value": as_json(picture(system, read_values(system, task.get("set") or {})))}


def _hover(task: Task, system: System) -> Iterator[Message]:
    """What a word means, derived quantities included."""
    from mbsym.analysis import Analysis
    from mbsym.editing import explanation
    from mbsym.serving.looking import word_at

    line, column, start, end = word_at(task["text"], task["offset"])
    markdown = explanation(task["text"], line, column, Analysis(system))
    value = None if markdown is None else {"from": start, "to": end, "markdown": markdown}
    yield {"kind": "hover", "value": value}


def _simulate(task: Task, system: System) -> Iterator[Message]:
    from mbsym.picture import picture
    from mbsym.report.viewer.motion import motion, motion_json
    from mbsym.simulation import Request
    from mbsym.simulation.request import read_values

    overrides = read_values(system, task.get("set") or {})
    until = _rational(task["time"], "the time is a number above 0")
    if not 0 < until <= sys.float_info.max:
        raise Refused("the time is a number above 0")
    yield {"kind": "progress", "words": "the equations are integrated"}
    request = Request(time=float(until), method=str(task.get("method") or "auto"))
    solved_motion = motion(system, request, overrides)
    velocity_names = [name for name in picture(system, overrides).program.inputs if name.endswith("_dot")]
    yield {"kind": "motion", "value": motion_json(solved_motion, velocity_names)}


def _equilibria(task: Task, system: System) -> Iterator[Message]:
    from mbsym.report.viewer.page import at_rest, at_rest_json

    yield {"kind": "progress", "words": "relative equilibria are looked for"}
    yield {"kind": "equilibria", "value": at_rest_json(at_rest(system, _numbers(task)))}


def _modes(task: Task, system: System) -> Iterator[Message]:
    from mbsym.analysis import Analysis
    from mbsym.expressions.tree import number
    from mbsym.model.system import with_values
    from mbsym.numerics.scenario import contradictions_of
    from mbsym.report.viewer.modes import modes, modes_json

    values = {name: number(value) for name, value in _numbers(task).items()}
    wrong = [f"there is no parameter called {name}" for name in values if name not in system.parameter_names]
    wrong = wrong or [contradiction.text for contradiction in contradictions_of(system, values)]
    if wrong:
        raise Refused("; ".join(wrong))
    yield {"kind": "modes", "value": modes_json(modes(Analysis(with_values(system, values), (4, 5, 6))))}


def _numbers(task: Task) -> dict[str, Fraction]:
    values = task.get("set") or {}
    return {name: _rational(x, f"{name}: a rational number is wanted, as 2/5 or 0.4") for name, x in values.items()}


# --- maps -------------------------------------------------------------------------------------------------------------


def _map(task: Task, system: System) -> Iterator[Message]:
    """``x`` and ``y`` are {name, low, high}; without y a line of verdicts."""
    from mbsym.analysis import Analysis
    from mbsym.maps.mapping import exact_map
    from mbsym.maps.section import Axis, usable
    from mbsym.report.language import Language
    from mbsym.report.maps.figure import map_figure

    axes = []
    for key in ("x", "y"):
        if not task.get(key):
            continue
        name = str(task[key].get("name", ""))
        if name not in usable(system):
            raise Refused(f"there is no parameter called {name}")
        refusal = f"{name}: the ends of its range are rational numbers, as 2/5 or 0.4"
        ends = [_rational(task[key].get(end, ""), refusal) for end in ("low", "high")]
        if ends[0] >= ends[1]:
            raise Refused(f"{name}: the range from {ends[0]} to {ends[1]} is empty")
        axes.append(Axis(name, *ends))
    if len(axes) == 2 and axes[0].name == axes[1].name:
        raise Refused(f"{name} is on both axes")
    if not axes:
        raise Refused("a map has an axis or two")
    yield {"kind": "progress", "words": "the plane is divided" if len(axes) == 2 else "the line is divided"}
    analysis, settings, language = Analysis(system), _numbers(task), Language(task.get("language") or "")
    verdict_map = exact_map(analysis, axes, settings)
    image = next(iter(map_figure(system, verdict_map, language, ("png",)).values()))
    words = []
    if verdict_map.check is not None and not verdict_map.check.holds:
        words = [f"withdrawn, as the map's own check fails: {flaw.mistake}" for flaw in verdict_map.check.findings[:20]]
    yield {"kind": "map", "image": f"data:image/png;base64,{b64encode(image).decode()}", "words": words}


_KINDS = {
    "derive": _derive,
    "export": _export,
    "hover": _hover,
    "picture": _picture,
    "simulate": _simulate,
    "equilibria": _equilibria,
    "modes": _modes,
    "map": _map,
}
