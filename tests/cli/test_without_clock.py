"""No output depends on elapsed time: not where clocks jump ahead by 100 s at every look, not beside a busy process.

Masked are measured seconds, which are information, and what is told of them: in the lines of the terminal a number
followed by s, ms, µs or "a second" (``MEASURED``), in files what ``unmeasured`` takes out.  All else is compared byte
by byte.
"""

from __future__ import annotations

import ast
import csv
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from io import StringIO
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]

#: One measured duration in the lines of the terminal, with the blanks that fill its column; and a line of the ledger.
MEASURED = re.compile(r" *\b[0-9][0-9.]*(?:e[-+]?\d+)? (?:s|ms|µs|a second)\b")
SECONDS = re.compile(r"^ *seconds of .*\n", re.MULTILINE)

#: Commands, each in a folder of its own.
COMMANDS: dict[str, str] = {
    "switches": "simulate systems/stick-slip.yaml --time 5 --format csv --out out",
    "accuracy": "simulate systems/simple-pendulum.yaml --accuracy 1e-6 --time 5 --format csv --out out",
    "equilibria": "equilibria systems/simple-pendulum.yaml",
    "extremes": "extremes systems/simple-pendulum.yaml --budget 0.05 --out out",
    "positions": "extremes systems/four-bar.yaml --budget 0.3 --out out",
    "tradeoff": "tradeoff systems/simple-pendulum.yaml --time 2 --budget 1 --methods dop853 --quiet --out out",
    "ledger": "run systems/double-pendulum.yaml --problems 2,5 --ledger --format json --out out",
    "cases": "integrals systems/henon-heiles.yaml --cases --budget 0.3",
    "certificate": "simulate systems/simple-pendulum.yaml --time 2 --certify 1e-10 --format csv --out out",
    "exponents": "lyapunov systems/double-pendulum.yaml --time 20 --out out",
    "ensemble": "simulate systems/simple-pendulum.yaml --time 2 --vary theta=0.1:1:20 --format csv --out out",
    "constrained": "simulate systems/cartesian-pendulum.yaml --time 1 --accuracy 1e-5 --format csv --out out",
}

#: Those that are run beside a busy process, too.
BUSY = ("switches", "accuracy", "extremes", "tradeoff", "certificate", "exponents", "ensemble", "constrained")

#: What is told only where a budget of theirs has cut something: the budgets above are small on purpose.
CUT = {"extremes": "beyond the budget", "positions": "found from 3 starts", "cases": "Families beyond the budget"}

#: Runs commands in one process, whose clocks are those of the first argument; prints what each came to.
PROGRAM = """
import json, sys, time
if sys.argv[1] == "jumping":
    from itertools import count
    for name in ("perf_counter", "monotonic", "time", "process_time", "thread_time"):
        steps, real = count(), getattr(time, name)
        setattr(time, name, lambda steps=steps, real=real: real() + 100.0 * next(steps))
import os
from pathlib import Path
from click.testing import CliRunner
from mbsym_cli.main import main
told = {}
for name, words in json.loads(sys.argv[2]).items():
    Path(name).mkdir()
    Path(name, "systems").symlink_to(Path(sys.argv[3], "systems"))
    os.chdir(name)
    done = CliRunner().invoke(main, words.split())
    told[name] = {"code": done.exit_code, "terminal": done.output}
    os.chdir("..")
print(json.dumps(told))
"""


@contextmanager
def started(folder: Path, clocks: str, seed: str, commands: Mapping[str, str]) -> Iterator[subprocess.Popen[str]]:
    folder.mkdir()
    environment = {**os.environ, "PYTHONHASHSEED": seed, "COLUMNS": "300", "NO_COLOR": "1"}
    words = [sys.executable, "-c", PROGRAM, clocks, json.dumps(commands), str(ROOT)]
    pipe = subprocess.PIPE
    with subprocess.Popen(words, cwd=folder, env=environment, stdout=pipe, stderr=pipe, text=True) as process:
        try:
            yield process
        finally:
            process.kill()


def ended(folder: Path, process: subprocess.Popen[str]) -> dict[str, dict[str, Any]]:
    """What every command prints, and all files that it writes."""
    out, errors = process.communicate(timeout=300)
    assert process.returncode == 0, errors
    told: dict[str, dict[str, Any]] = json.loads(out.splitlines()[-1])
    for name, one in told.items():
        assert one["code"] == 0, one["terminal"]
        paths = [path for path in sorted((folder / name / "out").rglob("*")) if path.is_file()]
        files = {path.name: path.read_bytes() for path in paths}
        told[name] = unmeasured(name, one["terminal"], files)
    return told


def unmeasured(name: str, terminal: str, files: dict[str, Any]) -> dict[str, Any]:
    """Without seconds and what is told of them: the front and the advice of ``tradeoff``, its pictures, digests."""
    shown = {"terminal": MEASURED.sub(" ?", SECONDS.sub("", terminal))}
    if name not in ("tradeoff", "ledger"):
        return shown | files
    if name == "tradeoff":
        shown = {}
    for file, content in files.items():
        if file.endswith(".csv"):
            rows = list(csv.DictReader(StringIO(content.decode())))
            rows = [row for row in rows if row.get("unit") != "seconds"]
            shown[file] = [{k: x for k, x in row.items() if k not in ("seconds", "front")} for row in rows]
        if file == "results.json":
            shown[file] = json.loads(content)
            for saving in shown[file]["ledger"]["savings"]:
                saving["measures"] = [one for one in saving["measures"] if one["unit"] != "seconds"]
    return shown | dict.fromkeys(files.keys() - shown.keys())


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> list[dict[str, dict[str, Any]]]:
    """Plain clocks, and clocks that jump; side by side, with other hashes."""
    folder = tmp_path_factory.mktemp("clocks")
    plain, jumping = folder / "plain", folder / "jumping"
    with started(plain, "plain", "1", COMMANDS) as one, started(jumping, "jumping", "2", COMMANDS) as other:
        return [ended(plain, one), ended(jumping, other)]


def test_clocks_decide_nothing(both: list[dict[str, dict[str, Any]]]) -> None:
    plain, jumping = both
    for name in COMMANDS:
        assert jumping[name] == plain[name], name
    for name in ("switches", "accuracy"):
        assert "about" in plain[name]["terminal"]
        assert "not estimated" not in plain[name]["terminal"]
    for name, words in CUT.items():
        assert words in plain[name]["terminal"], name
    assert len(plain["tradeoff"]["tradeoff.csv"]) > 10


def test_beside_a_busy_process_the_same_comes_out(both: list[dict[str, dict[str, Any]]], tmp_path: Path) -> None:
    """Every core has a process that does nothing but count, and the run has what is left."""
    commands = {name: COMMANDS[name] for name in BUSY}
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(os.cpu_count() or 1)]
    try:
        with started(tmp_path / "busy", "plain", "3", commands) as process:
            found = ended(tmp_path / "busy", process)
    finally:
        for one in busy:
            one.kill()
            one.wait()
    for name in BUSY:
        assert found[name] == both[0][name], name


# --- who may look at a clock ---

TOLD = "seconds that are told, and decide nothing"
SHOWN = "how long a command took, on its last line"
PROGRESS = "how often progress is shown"
ASKED = "a bound in seconds that a person asks for or that keeps a service alive; what it cuts is told"
STALE = "how old a file is that a killed process left behind"

#: Every module that reads a clock or waits for a time, and why its results do not depend on that.
READS = {
    **dict.fromkeys(["trade.reference_search", "trade.trial", "ensembles.ensemble", "extremes.extremes"], TOLD),
    **dict.fromkeys(["simulate", "planning.planning", "ledger.table", "methods.landing"], TOLD),
    "ledger.work": f"{TOLD}; how often a timing is repeated for its least value",
    "enclosure.enclose": ASKED,
}
READS = {f"numerics.{name}": why for name, why in READS.items()} | {
    "analysis.stages": TOLD,
    "serving.worker": TOLD,
    "report.exports.fmu": "how long a compiler may take, which is told",
    **dict.fromkeys(["serving.jobs", "serving.guard", "serving.server", "serving.application"], ASKED),
    **dict.fromkeys(["batch.isolation", "batch.nursery", "batch.cluster"], ASKED),
    "serving.events": "how often a page is told that it is still listened to",
    "batch.coordinator": "how often further work is taken",
    "serving.storage": f"{STALE}; when something was saved",
    **dict.fromkeys(["study", "batch.run"], SHOWN),
    **dict.fromkeys(["console", "batch.table"], PROGRESS),
    "watch": "how often a file is looked at",
    "files": STALE,
}

#: What reads a clock, or waits for one.
CLOCKS = {"time", "perf_counter", "monotonic", "process_time", "thread_time", "sleep"}
CLOCKS |= {f"{name}_ns" for name in CLOCKS}
WAITS = {"timeout", "timeout_at", "settimeout", "setitimer", "alarm", "wait_for", "call_later"}


def reads_a_clock(text: str) -> bool:
    if not any(word in text for word in ("time", "alarm", "wait_for", "call_later", "today")):
        return False
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom) and node.module == "time":
            return True
        if isinstance(node, ast.Attribute):
            owner = node.value.id if isinstance(node.value, ast.Name) else ""
            if (owner == "time" and node.attr in CLOCKS) or (owner in ("datetime", "date") and node.attr in _NOW):
                return True
        if isinstance(node, ast.Call):
            called = node.func
            name = called.attr if isinstance(called, ast.Attribute) else getattr(called, "id", "")
            waits = name[:1].islower() and any(word.arg == "timeout" for word in node.keywords)  # no value that is kept
            if name in WAITS or waits:
                return True
    return False


_NOW = ("now", "utcnow", "today")


def test_who_reads_a_clock_is_written_down_with_the_reason() -> None:
    """A module that is not listed may not; one that is listed and does not is struck off."""
    found = set()
    for folder in (ROOT / "mbsym", ROOT / "cli"):
        for path in folder.rglob("*.py"):
            if reads_a_clock(path.read_text("utf-8")):
                found.add(".".join(path.relative_to(folder).with_suffix("").parts))
    assert found == READS.keys()
    assert reads_a_clock("import time\nwhile time.perf_counter() < end: pass")
    assert reads_a_clock("from time import monotonic as now")
    assert not reads_a_clock("time = 3\ntime.sum()")
