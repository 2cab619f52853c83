"""``simulation.json`` and the table beside it read back, for ``mbsym simulate --continue``."""

from __future__ import annotations

import hashlib
import re
import warnings
from collections.abc import Iterator
from math import isfinite
from pathlib import Path
from typing import Any, Literal

import msgspec
import numpy as np

from mbsym.expressions.message import Counted, Message, worded
from mbsym.model.quantities import marked
from mbsym.model.states import described
from mbsym.model.system import System
from mbsym.numerics.kernels.interface import EXTENDED
from mbsym.numerics.methods.interface import Cause
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning.models import Model, scenario_of
from mbsym.numerics.scenario import Scenario
from mbsym.report.documents import simulation as doc
from mbsym.report.runs.trajectory_csv import column_units
from mbsym.simulation.request import TOLERANCE, Earlier
from mbsym.source.yaml_writer import meaning

#: No file of this kind is larger.
LARGEST = 20_000_000


#: What is said of the table beside a file.
UNREAD = "[[file]] beside it cannot be read: [[why]]"


class Unfit(Exception):
    """A file that no run can go on from, and why: a message."""

    def __init__(self, reason: str) -> None:
        self.reason = worded(reason)
        super().__init__(str(reason))


class _Content(msgspec.Struct, frozen=True):
    """What of a file is needed."""

    format: Literal[1]
    description_sha256: str
    ended: doc.Ended | None
    time: doc.TimeSpan
    reached: doc.Reached
    method: doc.MethodUsed
    arithmetic: str
    tolerance: float | str | None
    step: float | str | None
    parameters: dict[str, float | str]
    initial: dict[str, float | str]
    files: list[str]
    table_sha256: str | None
    model: doc.Model
    method_changes: list[doc.MethodChange] = []


def read_earlier(path: Path, system: System) -> Earlier:
    """The run that a ``simulation.json`` tells of, in the variables of the system.  Raises Unfit."""
    content = _content(path)
    if content.description_sha256 != meaning(described(system)):
        raise Unfit("it belongs to another description, or the description has changed since (its hash differs)")
    ended, state = content.ended, content.reached.state
    if ended is not None and ended.kind not in ("interrupted", Cause.STEP_LIMIT):
        text = "that run ended with [[kind]] at t = [[time]]: there is nothing to go on from"
        raise Unfit(Message(text, kind=worded(ended.kind), time=str(ended.time)))
    if list(state) != [*system.coordinates, *system.velocities]:
        raise Unfit("its last state is not that of these coordinates")
    arithmetic, method = content.arithmetic, content.method.name
    if content.method_changes and method != "parts":
        method = content.method_changes[-1].method
    method = "auto" if method == "parts" else method  # parts by different methods are found again
    if arithmetic not in TOLERANCE or method not in ("auto", *METHODS):
        raise Unfit(Message("there is no method [[method]] in [[arithmetic]]", method=method, arithmetic=arithmetic))
    kind = np.longdouble if arithmetic == EXTENDED else float
    last = np.array([_number(value, kind) for value in state.values()])
    time = _number(content.reached.time)
    times, states = _rows(path, content, system, time, last)
    spacing = (content.time.to - content.time.from_) / max(1, content.time.samples - 1)
    if len(times) > 2:
        spacing = float(times[1] - times[0])
    if not (spacing > 0 and time > 0):
        raise Unfit("its times are no times")
    tolerance, step = (None if x is None else _number(x) for x in (content.tolerance, content.step))
    exact = {name: _number(value) for name, value in (content.parameters | content.initial).items()}
    model = Model(content.model.gravity, content.model.linear, tuple(content.model.without))
    if model.gravity not in (None, 2, 3, 4, "exact") or not {*model.without} <= {*system.parameter_names}:
        raise Unfit("it is damaged: its model is none")
    change = content.method.may_change
    return Earlier(times, states, spacing, exact, method, tolerance, step, arithmetic, change, model)


def changed(earlier: Earlier, scenario: Scenario) -> Iterator[str]:
    """What has another value now in the model of the earlier run, a phrase each."""
    values, scenario = earlier.values, scenario_of(scenario, earlier.model)
    system = scenario.system
    now = {name: float(value) for name, value in scenario.parameters.items()}
    now |= {name: float(x) for name, x in zip([*system.coordinates, *system.velocities], scenario.state, strict=True)}
    for name in dict.fromkeys([*values, *now]):
        before, after = values.get(name), now.get(name)
        if before != after:
            yield Message("[[name]] was [[before]] and is [[after]]", name=name, before=before, after=after)


def _content(path: Path) -> _Content:
    """What is needed of the file.  Raises Unfit."""
    try:
        if path.stat().st_size > LARGEST:
            raise Unfit("it is too large for a simulation.json")
        content = msgspec.json.decode(path.read_bytes())
    except OSError as error:
        raise Unfit(Message("it cannot be read: [[why]]", why=error.strerror or error)) from None
    except (ValueError, RecursionError):
        raise Unfit("it is no JSON file, or damaged") from None
    if not isinstance(content, dict) or content.get("format") != 1:
        raise Unfit("it is not a simulation.json of this version of mbsym")
    try:
        return msgspec.convert(content, _Content)
    except msgspec.ValidationError as error:  # "... missing required field `time` - at `$.reached`"
        found = (re.search(pattern, str(error)) for pattern in (r"`\$\.?([^`]+)`", r"field `(\w+)`"))
        place = ".".join(match[1] for match in found if match)
        raise Unfit(Message("it is damaged, or older than --continue: [[place]]", place=place)) from None


def _number(value: float | str, kind: Any = float) -> Any:
    """A finite number.  Raises Unfit."""
    try:
        number = kind(value)
    except ValueError:
        raise Unfit("it is damaged: there is no number where there should be one") from None
    if not isfinite(float(number)):
        raise Unfit("its last state is not finite: there is nothing to go on from")
    return number


def _rows(path: Path, content: _Content, system: System, time: float, last: Any) -> tuple[Any, Any]:
    """(times, states) of the table beside it.  Raises Unfit where there is none, or another one."""
    table, digest = _table(path, content)
    size = 1 + len(last)
    expected = [marked(name, unit) for name, unit in column_units(system).items()][:size]
    try:
        with table.open(encoding="utf-8") as stream:
            header = stream.readline().rstrip("\n").split(",")[:size]
            with warnings.catch_warnings(action="ignore"):  # of an empty table
                columns = np.loadtxt(stream, delimiter=",", usecols=range(size), ndmin=2).T
    except (OSError, ValueError) as error:
        raise Unfit(Message(UNREAD, file=table.name, why=error)) from None
    count = content.reached.samples
    if len(header) < size or header != expected or columns.shape != (size, count):
        text = "[[file]] beside it is not the table of that run ([[count]] are wanted)"
        raise Unfit(Message(text, file=table.name, count=Counted(count, "row")))
    times, states = columns[0], columns[1:].astype(last.dtype)
    if (
        times[0]
        or times[-1] != time
        or not np.array_equal(columns[1:, -1], last.astype(float))
        or not np.all(np.diff(times) > 0)
    ):
        text = "[[file]] beside it does not end where that run did: one of the two has been changed"
        raise Unfit(Message(text, file=table.name))
    if digest != content.table_sha256:
        text = "[[file]] beside it has been changed since that run wrote it (its hash differs)"
        raise Unfit(Message(text, file=table.name))
    states[:, -1] = last
    return times, states


def _table(path: Path, content: _Content) -> tuple[Path, str]:
    """The table beside a simulation.json, and the SHA-256 of what is in it.  Raises Unfit."""
    names = [name for name in content.files if name in ("trajectory.csv", "trajectory-partial.csv")]
    if not names:
        raise Unfit("that run wrote no table of rows (--format csv), which the new ones would follow")
    table = path.parent / names[0]
    try:
        with table.open("rb") as stream:
            return table, hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError as error:
        raise Unfit(Message(UNREAD, file=table.name, why=error)) from None
