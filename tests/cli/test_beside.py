"""Work beside the process: the same value whatever becomes of the copy, and nothing is left behind."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from conftest import invoked

from mbsym_cli import beside as module
from mbsym_cli.beside import Beside, beside, helped
from mbsym_cli.console import DEFECTS

ROOT = Path(__file__).parents[2]
PENDULUM = ROOT / "systems" / "double-pendulum.yaml"

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes are copied on Linux only")


@pytest.fixture(autouse=True)
def _help(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(module, "helped", lambda: True)
    before = children()
    yield
    assert children() <= before  # every copy has been waited for; a browser of other tests may stay


def children() -> set[int]:
    """Processes begun by this one that run or wait to be waited for."""
    listed = (path.read_text() for path in Path("/proc/self/task").glob("*/children"))
    return {int(one) for text in listed for one in text.split()}


def always(_: Any) -> bool:
    return True


def test_a_large_value_of_another_process() -> None:
    with beside(lambda: (os.getpid(), "x" * 10**6), always) as value:
        process, text = value()
    assert process != os.getpid()
    assert text == "x" * 10**6


def fails() -> int:
    raise ValueError("lost")


def is_killed() -> int:
    os.kill(os.getpid(), signal.SIGKILL)
    return 0


def meets_a_defect() -> int:
    DEFECTS.errors.append(ValueError("contained"))
    return os.getpid()


@pytest.mark.parametrize("spoilt", [fails, is_killed, meets_a_defect, lambda: (os.getpid(), lambda: 0)])
def test_what_the_copy_cannot_do_is_done_here(spoilt: Any) -> None:
    """It raises, is killed, meets a defect that has to be told here, has a value that cannot be sent."""
    here = os.getpid()
    with beside(lambda: "here" if os.getpid() == here else spoilt(), always) as value:
        assert value() == "here"


def test_an_unsound_value_is_not_taken() -> None:
    here = os.getpid()
    with beside(os.getpid, lambda process: process == here) as value:
        assert value() == here


def test_an_answer_cut_short_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    here, write = os.getpid(), os.write

    def half(handle: int, data: Any) -> int:
        write(handle, bytes(data)[: len(data) // 2])
        os._exit(0)

    monkeypatch.setattr(module.os, "write", half)
    with beside(os.getpid, always) as value:
        assert value() == here


def test_no_copy_without_leave(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "helped", helped)
    monkeypatch.setattr(Beside, "allowed", False)
    with beside(os.getpid, always) as value:
        assert value() == os.getpid()


def test_no_copy_of_a_process_with_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    """A lock that another thread holds would be held for ever in the copy."""
    monkeypatch.setattr(Beside, "allowed", True)
    done = threading.Event()
    other = threading.Thread(target=done.wait)
    other.start()
    try:
        assert not helped()
    finally:
        done.set()
        other.join()


def test_leaving_early_ends_the_copy() -> None:
    started = time.monotonic()
    with pytest.raises(KeyboardInterrupt), beside(lambda: time.sleep(60), always):
        raise KeyboardInterrupt
    assert time.monotonic() - started < 30


def test_a_run_with_help_writes_the_same_bytes(tmp_path: Path) -> None:
    """As a process of its own, which has help where there are two cores, and within this one, which has none."""
    alone, helped_ = tmp_path / "alone", tmp_path / "helped"
    done = invoked("run", PENDULUM, "--quiet", "--out", alone)
    assert (done.exit_code, done.stderr) == (0, "")
    subprocess.run([sys.executable, "-m", "mbsym_cli", "run", PENDULUM, "--quiet", "--out", helped_], check=True)
    files = sorted(path.relative_to(alone) for path in alone.rglob("*") if path.is_file())
    assert len(files) >= 20
    assert files == sorted(path.relative_to(helped_) for path in helped_.rglob("*") if path.is_file())
    assert all((alone / file).read_bytes() == (helped_ / file).read_bytes() for file in files)


@pytest.mark.parametrize(("running", "cores", "wanted"), [(1, 2, True), (2, 2, True), (3, 2, False), (1, 1, False)])
def test_help_only_where_a_core_is_idle(
    running: int, cores: int, wanted: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Beside, "allowed", True)
    monkeypatch.setattr(module, "_running", lambda: running)
    monkeypatch.setattr(module.os, "sched_getaffinity", lambda _: set(range(cores)))
    monkeypatch.setattr(module.threading, "active_count", lambda: 1)
    assert helped() is wanted


def test_no_help_for_a_process_that_holds_much(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Beside, "allowed", True)
    monkeypatch.setattr(module, "_running", lambda: 1)
    monkeypatch.setattr(module.os, "sched_getaffinity", lambda _: {0, 1})
    monkeypatch.setattr(module.threading, "active_count", lambda: 1)
    assert helped()
    monkeypatch.setattr(module, "MOST_MEMORY", 10**6)
    assert not helped()
