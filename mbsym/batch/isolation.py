"""One description in a process of its own, with its own budget: whatever it does, it costs its row only."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress
from dataclasses import replace

from mbsym.batch.outcome import Outcome, Row
from mbsym.batch.task import Budget, Finished, Task
from mbsym.batch.transport import MALFORMED, read_finished, task_text
from mbsym.batch.worker import OUT_OF_MEMORY

#: What libraries write before they abort for want of memory: FLINT, C++, LLVM, Python itself.
_MEMORY_WORDS = ("unable to allocate", "bad_alloc", "out of memory", "memoryerror", "cannot allocate memory")

#: So much of what a process wrote before it died is told.
_LAST_WORDS = 300

#: One thread of arithmetic a process: there are as many processes as the machine has work for.
_SINGLE = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


class Processes:
    """Those that run, so that all can be ended at once."""

    def __init__(self) -> None:
        self._running: set[subprocess.Popen[bytes]] = set()
        self._lock = threading.Lock()
        self.closed = False

    def start(self, command: list[str], lifeline: int) -> subprocess.Popen[bytes] | None:
        """A process in a group of its own; None after ``close``."""
        with self._lock:
            if self.closed:
                return None
            process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                env=os.environ | _SINGLE,
                pass_fds=(lifeline,) if os.name == "posix" else (),
                start_new_session=True,
            )
            self._running.add(process)
            return process

    def ended(self, process: subprocess.Popen[bytes]) -> None:
        with self._lock:
            self._running.discard(process)

    def close(self) -> None:
        """Ends those that run, and lets no other one begin."""
        with self._lock:
            self.closed = True
            for process in self._running:
                kill(process)


def isolated(task: Task, budget: Budget, processes: Processes | None = None) -> Finished:
    """What becomes of a description, in a process of its own that ends when its budget is used up, or this one ends.

    The result of ``work`` where the process came to its end; else a row that says what happened to it.
    """
    processes = processes or Processes()
    started = time.monotonic()
    finished = _ran(task, budget, processes)
    return replace(finished, row=replace(finished.row, seconds=time.monotonic() - started))


def _ran(task: Task, budget: Budget, processes: Processes) -> Finished:
    inner, outer = os.pipe()
    try:
        command = [sys.executable, "-P", "-m", "mbsym.batch.worker", str(budget.memory or 0), str(inner)]
        try:
            process = processes.start(command, inner)
        except OSError as error:
            return _failed(task, Outcome.CRASHED, f"its process cannot be started: {error.strerror or error}")
        if process is None:
            return _failed(task, Outcome.INTERRUPTED)
        late = False
        try:
            answer, said = _talked(process, task, budget.seconds)
        except subprocess.TimeoutExpired:
            late = True
            kill(process)
            answer, said = process.communicate()
        finally:
            kill(process)
            process.wait()
            processes.ended(process)
    finally:
        os.close(inner)
        os.close(outer)
    if late:
        return _failed(task, Outcome.TIMEOUT, f"stopped after {budget.seconds:g} s")
    if process.returncode == 0:
        with suppress(*MALFORMED):
            return read_finished(answer)
    if processes.closed:
        return _failed(task, Outcome.INTERRUPTED)
    return _ended(task, budget, process.returncode, said.decode("utf-8", "replace"))


def _talked(process: subprocess.Popen[bytes], task: Task, seconds: float | None) -> tuple[bytes, bytes]:
    return process.communicate(task_text(task).encode(), timeout=seconds)


def _ended(task: Task, budget: Budget, code: int, said: str) -> Finished:
    """Why a process ended without an answer."""
    if code == OUT_OF_MEMORY or any(word in said.lower() for word in _MEMORY_WORDS):
        bound = f"more than {budget.memory // 2**20} MB were wanted" if budget.memory else "the memory was not enough"
        return _failed(task, Outcome.MEMORY, bound)
    if code < 0:
        what = f"its process was ended by {_signal_name(-code)}"
    else:
        what = f"its process ended with code {code}"
    last = said.strip().rpartition("\n")[2][-_LAST_WORDS:]
    return _failed(task, Outcome.CRASHED, f"{what}: {last}" if last else what)


def _failed(task: Task, outcome: Outcome, message: str = "") -> Finished:
    return Finished(Row(task.file, task.folder, outcome, message=message))


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def kill(process: subprocess.Popen[bytes]) -> None:
    """Ends a process with everything that it started."""
    if process.returncode is not None:  # its number may be somebody else's by now
        return
    with suppress(OSError):
        if os.name == "posix":
            os.killpg(process.pid, signal.SIGKILL)
        else:
            process.kill()
