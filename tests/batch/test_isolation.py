"""A description that runs away or crashes costs its row only; a batch that is killed loses nothing finished."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest
from batches import ENDLESS, QUICK, batch, cached, chain, command, files_of, folder_of, needs_posix, outcomes, pendulum
from batches import summary as read_summary

pytestmark = needs_posix

#: Longer than anything here takes on a busy machine.
PATIENCE = 60.0


def descendants(process: subprocess.Popen[str]) -> list[tuple[int, int, str]]:
    """Everything that a batch has started, as the system lists it: number, generation, command."""
    done = subprocess.run(["ps", "-A", "-o", "pid=,ppid=,args="], capture_output=True, text=True, check=True)
    listed = [
        (int(pid), int(parent), args) for pid, parent, args in (x.split(None, 2) for x in done.stdout.splitlines())
    ]
    found, generation = [], {process.pid}
    for age in (1, 2, 3):
        born = [(pid, age, args) for pid, parent, args in listed if parent in generation]
        found, generation = found + born, {pid for pid, _, _ in born}
    return found


def children(process: subprocess.Popen[str]) -> list[int]:
    """The processes of descriptions: begun by the batch itself, or by a nurse in the nursery."""
    every = descendants(process)
    return [pid for pid, age, args in every if (age == 1 and "mbsym.batch.worker" in args) or age == 3]


def runs(pid: int) -> bool:
    """Whether a process is there and has not ended."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def until(condition: Callable[[], object]) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, "it never came to that"
        time.sleep(0.02)


@contextmanager
def started(*arguments: object, cwd: Path) -> Iterator[subprocess.Popen[str]]:
    """A batch that runs in the background."""
    with subprocess.Popen(
        command(*arguments), cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        try:
            yield process
        finally:
            with suppress(OSError):
                process.kill()


def test_a_budget_that_is_met_costs_a_row(tmp_path: Path) -> None:
    """The chain ends in FLINT's own abort for want of memory, or never."""
    folder_of(tmp_path / "in", a=pendulum(), big=chain(14), z=pendulum("Z"))
    done = batch("in", "-o", "out", *QUICK, *ENDLESS, "--timeout", "3", "--memory", "4000", cwd=tmp_path, code=4)
    assert outcomes(tmp_path / "out") == {"a": "derived", "big": "timeout", "z": "derived"}
    assert "stopped after 3 s" in done.stdout
    done = batch("in", "-o", "out", *QUICK, *ENDLESS, "--memory", "160", cwd=tmp_path, code=4)
    assert outcomes(tmp_path / "out") == {"a": "derived", "big": "out of memory", "z": "derived"}
    assert "more than 160 MB" in done.stdout
    assert cached(tmp_path / "out") == {"a": True, "big": False, "z": True}  # a met budget is no result
    assert not (tmp_path / "out" / "big").exists()


@pytest.mark.parametrize(("number", "more"), [(signal.SIGSEGV, "xy"), (signal.SIGKILL, "x")])
def test_a_crash_costs_a_row(tmp_path: Path, number: signal.Signals, more: str) -> None:
    """From three descriptions on they are forked."""
    folder_of(tmp_path / "in", big=chain(14), **{name: pendulum(name) for name in more})
    with started("in", "-o", "out", *QUICK, *ENDLESS, "--jobs", "1", cwd=tmp_path) as process:
        until(lambda: children(process))
        os.kill(children(process)[0], number)
        out, _ = process.communicate(timeout=PATIENCE)
    assert process.returncode == 1
    assert outcomes(tmp_path / "out") == {"big": "crashed", **dict.fromkeys(more, "derived")}
    assert f"its process was ended by {number.name}" in out


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_batch_that_is_stopped_keeps_what_is_finished(tmp_path: Path, number: signal.Signals, code: int) -> None:
    folder_of(tmp_path / "in", a=pendulum(), big=chain(14), z=pendulum("Z"))
    with started("in", "-o", "out", *QUICK, *ENDLESS, "--jobs", "1", cwd=tmp_path) as process:
        until(lambda: (tmp_path / "out" / "a" / "outcome.json").exists() and children(process))
        left = [pid for pid, _, _ in descendants(process)]
        process.send_signal(number)
        _, said = process.communicate(timeout=PATIENCE)
    assert process.returncode == code
    assert "interrupted; what was finished is kept" in said
    assert outcomes(tmp_path / "out") == {"a": "derived", "big": "interrupted", "z": "interrupted"}
    assert read_summary(tmp_path / "out")["exit_code"] == 130
    assert not any(map(runs, left))


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="no /proc")
def test_a_batch_that_is_killed_goes_on_where_it_was(tmp_path: Path) -> None:
    """And takes its processes with it, though nobody could tell them."""
    folder_of(tmp_path / "in", a=pendulum(), big=chain(14), z=pendulum("Z"))
    with started("in", "-o", "out", *QUICK, *ENDLESS, "--jobs", "1", cwd=tmp_path) as process:
        until(lambda: (tmp_path / "out" / "a" / "outcome.json").exists() and children(process))
        left = [pid for pid, _, _ in descendants(process)]
        assert len(left) >= 3  # the nursery, a nurse and the process that derives
        time.sleep(1.0)  # into the algebra, which lets no other thread run
        process.kill()
        process.wait()
        until(lambda: not any(map(runs, left)))
    (tmp_path / "in" / "big.yaml").unlink()
    batch("in", "-o", "out", *QUICK, *ENDLESS, cwd=tmp_path)
    assert cached(tmp_path / "out") == {"a": True, "z": False}


def test_killed_at_any_moment(tmp_path: Path) -> None:
    """Killed again and again, whenever that is: what is finished in the end is what one undisturbed batch gives."""
    names = {f"s{number}": pendulum(f"System {number}") for number in range(4)}
    folder_of(tmp_path / "in", **names)
    done: set[str] = set()
    for moment in (0.5, 0.7, 0.9):
        with started("in", "-o", "out", *QUICK, cwd=tmp_path) as process:
            time.sleep(moment)
            process.kill()
        now = {path.parent.name for path in tmp_path.glob("out/*/outcome.json")}
        assert done <= now
        done = now
    batch("in", "-o", "out", *QUICK, cwd=tmp_path)
    assert {name for name, kept in cached(tmp_path / "out").items() if kept} >= done
    batch("in", "-o", "fresh", *QUICK, cwd=tmp_path)
    assert files_of(tmp_path / "out") == files_of(tmp_path / "fresh")


def test_two_batches_in_one_folder(tmp_path: Path) -> None:
    """Each description is derived once; both have all results in the end."""
    folder_of(tmp_path / "in", **{f"s{number}": pendulum(f"System {number}") for number in range(5)})
    with (
        started("in", "-o", "out", *QUICK, "--jobs", "1", cwd=tmp_path) as one,
        started("in", "-o", "out", *QUICK, "--jobs", "1", cwd=tmp_path) as other,
    ):
        said = [process.communicate(timeout=PATIENCE)[0] for process in (one, other)]
    assert [one.returncode, other.returncode] == [0, 0]
    lines = [line for text in said for line in text.splitlines() if line.startswith("[")]
    assert len(lines) == 10
    assert sum("derived" in line for line in lines) == 5
    assert sum("up to date" in line for line in lines) == 5


def test_a_batch_takes_over_from_one_that_was_killed(tmp_path: Path) -> None:
    """It waits while the other one lives, and not a moment longer."""
    folder_of(tmp_path / "in", a=chain(14))
    arguments = ("in", "-o", "out", *QUICK)
    with started(*arguments, *ENDLESS, cwd=tmp_path) as holder:
        until(lambda: children(holder))
        folder_of(tmp_path / "in", a=pendulum())
        with started(*arguments, cwd=tmp_path) as waiting:
            time.sleep(1.0)
            assert not children(waiting)
            assert waiting.poll() is None
            holder.kill()
            waiting.communicate(timeout=PATIENCE)
    assert waiting.returncode == 0
    assert outcomes(tmp_path / "out") == {"a": "derived"}


def test_fail_fast_begins_nothing_new(tmp_path: Path) -> None:
    wrong = pendulum().replace("mass: m", "mass: mm")
    folder_of(tmp_path / "in", a=wrong, b=pendulum(), c=pendulum("C"))
    batch("in", "-o", "out", *QUICK, "--fail-fast", "--jobs", "1", cwd=tmp_path, code=2)
    assert outcomes(tmp_path / "out") == {"a": "description errors", "b": "skipped", "c": "skipped"}
    batch("in", "-o", "out", *QUICK, "--jobs", "1", cwd=tmp_path, code=2)
    assert outcomes(tmp_path / "out") == {"a": "description errors", "b": "derived", "c": "derived"}
