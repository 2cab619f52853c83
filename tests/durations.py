"""What cases cost, in seconds of processor: ``durations.json`` has all that cost more than ``SLOW``, as last measured.

They get the mark ``slow``: ``make test`` leaves them to ``make test-all``.  Nobody marks by hand.  A case that is slow
and not recorded is named at the end of a run; ``pytest --record-durations tests/some/test_file.py`` measures again the
functions that it runs.  Counted is the whole tree of processes: a busy machine makes nothing slow.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from zlib import crc32

import pytest

FILE = Path(__file__).with_suffix(".json")

#: Seconds of processor that no case of ``make test`` is to take.
SLOW = 0.8

#: Who first asks for what many share pays for it, and who that is changes: so many times ``SLOW`` are not only that.
CLEARLY = 3

RECORDED: dict[str, float] = json.loads(FILE.read_text(encoding="utf-8"))

_measured: dict[str, float] = {}
_began = pytest.StashKey[float]()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--record-durations", action="store_true", help=f"write what takes long into tests/{FILE.name}")
    parser.addoption("--part", metavar="K/N", help="the K-th of N parts of what is chosen; by names")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    for item in items:
        if item.nodeid in RECORDED:
            item.add_marker("slow")
    if part := config.getoption("part"):
        k, n = map(int, part.split("/"))
        others = [item for item in items if crc32(item.nodeid.encode()) % n != k % n]
        items[:] = [item for item in items if crc32(item.nodeid.encode()) % n == k % n]
        config.hook.pytest_deselected(items=others)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    item.stash[_began] = processor_time()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Iterator[None]:
    report: Any = yield
    if report.when == "teardown":
        report.user_properties.append(("processor", processor_time() - item.stash[_began]))
    return report


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Told to every process that runs tests, and to the one that started them, which alone writes."""
    if report.when == "teardown":
        _measured[report.nodeid] = dict(report.user_properties)["processor"]


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    if config.getoption("record_durations"):
        FILE.write_text(written(updated(RECORDED, _measured)), encoding="utf-8")
        return
    new = {name: cost for name, cost in _measured.items() if name not in RECORDED and cost > CLEARLY * SLOW}
    if new:
        terminalreporter.section("slow, and not recorded as such (pytest --record-durations)")
    for name in sorted(new, key=lambda name: -new[name]):
        terminalreporter.line(f"{new[name]:.1f} s of processor  {name}")


def updated(recorded: dict[str, float], measured: dict[str, float]) -> dict[str, float]:
    """What is slow after some functions were measured again, all cases of each."""
    functions = {name.partition("[")[0] for name in measured}
    kept = {name: cost for name, cost in recorded.items() if name.partition("[")[0] not in functions}
    return kept | {name: round(cost, 1) for name, cost in measured.items() if cost > SLOW}


def written(durations: dict[str, float]) -> str:
    return json.dumps(durations, indent=0, sort_keys=True, ensure_ascii=False) + "\n"


def processor_time() -> float:
    """Seconds that this process has used and all that it started: those that still run and, by whom waited for them,
    those that have ended.  Where nobody tells (``/proc`` is Linux's), this one and those that it has waited for."""
    own = sum(os.times()[:4])
    if not Path("/proc/self/task").exists():
        return own
    ticks = os.sysconf("SC_CLK_TCK")
    return own + sum(_ticks_of(child) for child in _children(os.getpid())) / ticks


def _ticks_of(process: int) -> int:
    try:
        fields = Path(f"/proc/{process}/stat").read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()
    except OSError:  # it has just ended
        return 0
    return sum(map(int, fields[11:15])) + sum(map(_ticks_of, _children(process)))


def _children(process: int) -> Iterator[int]:
    try:
        for thread in os.listdir(f"/proc/{process}/task"):
            with open(f"/proc/{process}/task/{thread}/children", encoding="ascii") as children:
                yield from map(int, children.read().split())
    except OSError:
        return
