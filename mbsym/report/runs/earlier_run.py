"""``simulation.json`` and the table beside it read back, for ``mbsym simulate --continue``."""

from __future__ import annotations

import hashlib
import json
import warnings
from collections.abc import Iterator, Mapping
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from mbsym.expressions.message import Counted, Message, worded
from mbsym.model.quantities import marked
from mbsym.model.system import System
from mbsym.numerics.kernels.interface import EXTENDED
from mbsym.numerics.methods.interface import Cause
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning.models import Model, scenario_of
from mbsym.numerics.scenario import Scenario
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


def read_earlier(path: Path, system: System) -> Earlier:
    """The run that a ``simulation.json`` tells of.  Raises Unfit."""
    content = _content(path)
    if content["description_sha256"] != meaning(system):
        raise Unfit("it belongs to another description, or the description has changed since (its hash differs)")
    ended = content["ended"]
    if ended is not None and ended["kind"] not in ("interrupted", Cause.STEP_LIMIT):
        text = "that run ended with [[kind]] at t = [[time]]: there is nothing to go on from"
        raise Unfit(Message(text, kind=worded(str(ended["kind"])), time=str(ended["time"])))
    names = [*system.coordinates, *system.velocities]
    state = content["reached"]["state"]
    if not isinstance(state, dict) or list(state) != names:
        raise Unfit("its last state is not that of these coordinates")
    arithmetic, method = content["arithmetic"], content["method"]["name"]
    if content.get("method_changes"):
        method = _last_method(content["method_changes"], method)
    method = "auto" if method == "parts" else method  # parts by different methods are found again
    if arithmetic not in TOLERANCE or method not in ("auto", *METHODS):
        raise Unfit(Message("there is no method [[method]] in [[arithmetic]]", method=method, arithmetic=arithmetic))
    kind = np.longdouble if arithmetic == EXTENDED else float
    last = np.array([_number(value, kind) for value in state.values()])
    time = _number(content["reached"]["time"], float)
    times, states = _rows(path, content, system, time, last)
    sampling = content["time"]
    spacing = (_number(sampling["to"], float) - _number(sampling["from"], float)) / max(1, int(sampling["samples"]) - 1)
    if len(times) > 2:
        spacing = float(times[1] - times[0])
    if not (spacing > 0 and time > 0):
        raise Unfit("its times are no times")
    tolerance, step = (None if content[key] is None else _number(content[key], float) for key in ("tolerance", "step"))
    values = {**content["parameters"], **content["initial"]}
    exact = {name: _number(value, float) for name, value in values.items()}
    change = content["method"].get("may_change") is True
    model = _model(content, system)
    return Earlier(times, states, spacing, exact, method, tolerance, step, arithmetic, change, model)


def _last_method(changes: Any, first: str) -> str:
    """What a run went by in the end.  Raises Unfit."""
    if first == "parts":
        return first
    last = changes[-1] if isinstance(changes, list) else None
    if not isinstance(last, dict) or not isinstance(last.get("method"), str):
        raise Unfit("it is damaged: its method_changes are none")
    method: str = last["method"]
    return method


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


def _content(path: Path) -> dict[str, Any]:
    """The file as a mapping that has what is needed, whatever its values are."""
    try:
        if path.stat().st_size > LARGEST:
            raise Unfit("it is too large for a simulation.json")
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise Unfit(Message("it cannot be read: [[why]]", why=error.strerror or error)) from None
    except (ValueError, RecursionError):
        raise Unfit("it is no JSON file, or damaged") from None
    required = {"format", "description_sha256", "ended", "time", "reached", "method", "arithmetic", "tolerance", "step"}
    required |= {"parameters", "initial", "files"}
    if not isinstance(content, dict) or not required <= set(content) or content["format"] != 1:
        raise Unfit("it is not a simulation.json of this version of mbsym")
    if not {"table_sha256", "model"} <= set(content):
        raise Unfit('it is damaged, or older than --continue: "table_sha256" and "model" are wanted')
    shapes = {"time": ("from", "to", "samples"), "reached": ("time", "samples", "state"), "method": ("name",)}
    shapes["model"] = ("gravity", "linear", "without")
    for key, inner in shapes.items():
        if not isinstance(content[key], dict) or not set(inner) <= set(content[key]):
            text = 'it is damaged, or older than --continue: [[names]] are wanted under "[[key]]"'
            raise Unfit(Message(text, names=", ".join(inner), key=key))
    ended = content["ended"]
    mappings = all(isinstance(content[key], dict) for key in ("parameters", "initial"))
    counts = all(isinstance(content[key]["samples"], int) for key in ("time", "reached"))
    words = all(isinstance(word, str) for word in (content["method"]["name"], content["arithmetic"]))
    end = ended is None or (isinstance(ended, dict) and {"kind", "time"} <= set(ended))
    if not (mappings and counts and words and end and isinstance(content["files"], list)):
        raise Unfit("it is damaged")
    return content


def _number(value: Any, kind: Any) -> Any:
    """A finite number.  Raises Unfit."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise Unfit("it is damaged: there is no number where there should be one")
    try:
        number = kind(value if isinstance(value, str) else float(value))
    except (ValueError, OverflowError):
        raise Unfit("it is damaged: there is no number where there should be one") from None
    if not isfinite(float(number)):
        raise Unfit("its last state is not finite: there is nothing to go on from")
    return number


def _rows(path: Path, content: Mapping[str, Any], system: System, time: float, last: Any) -> tuple[Any, Any]:
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
    count = content["reached"]["samples"]
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
    if digest != content["table_sha256"]:
        text = "[[file]] beside it has been changed since that run wrote it (its hash differs)"
        raise Unfit(Message(text, file=table.name))
    states[:, -1] = last
    return times, states


def _table(path: Path, content: Mapping[str, Any]) -> tuple[Path, str]:
    """The table beside a simulation.json, and the SHA-256 of what is in it.  Raises Unfit."""
    names = [name for name in content["files"] if name in ("trajectory.csv", "trajectory-partial.csv")]
    if not names:
        raise Unfit("that run wrote no table of rows (--format csv), which the new ones would follow")
    table = path.parent / names[0]
    try:
        with table.open("rb") as stream:
            return table, hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError as error:
        raise Unfit(Message(UNREAD, file=table.name, why=error)) from None


def _model(content: Mapping[str, Any], system: System) -> Model:
    """What was in the equations.  Raises Unfit."""
    model = content["model"]
    gravity, linear, without = model["gravity"], model["linear"], model["without"]
    names = isinstance(without, list) and all(name in system.parameter_names for name in without)
    orders = isinstance(gravity, (int, str, type(None))) and not isinstance(gravity, bool)
    if not (names and orders and isinstance(linear, bool) and gravity in (None, 2, 3, 4, "exact")):
        raise Unfit("it is damaged: its model is none")
    return Model(gravity, linear, tuple(without))
