"""One description in a process of its own, with its own budget: whatever it does, it costs its row only."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Protocol

from mbsym.batch.outcome import Outcome, Row
from mbsym.batch.transport import Budget, Finished, Task
from mbsym.batch.worker import OUT_OF_MEMORY, SINGLE
from mbsym.expressions.message import Message, joined

if TYPE_CHECKING:
    from mbsym.batch.nursery import Nursery

#: What libraries write before they abort for want of memory: FLINT, C++, LLVM, Python itself.
_MEMORY_WORDS = ("unable to allocate", "bad_alloc", "out of memory", "memoryerror", "cannot allocate memory")

#: So much of what a process wrote before it died is told.
_LAST_WORDS = 300


class Running(Protocol):
    """A process with its task."""

    def talk(self, seconds: float | None) -> tuple[int | None, bytes, bytes] | None:
        """How it ended, its answer and its complaints; None where it was late, and is ended."""
        ...

    def kill(self) -> None:
        """Ends it."""
        ...


class Fresh:
    """A process that begins with nothing loaded."""

    def __init__(self, task: Task, memory: int | None) -> None:
        self._task = task
        inner, self._lifeline = os.pipe()
        try:
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-m", "mbsym.batch.worker", str(memory or 0), str(inner)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                env=os.environ | SINGLE,
                pass_fds=(inner,) if os.name == "posix" else (),
                start_new_session=True,
            )
        except BaseException:
            os.close(self._lifeline)
            raise
        finally:
            os.close(inner)

    def talk(self, seconds: float | None) -> tuple[int | None, bytes, bytes] | None:
        try:
            answer, said = self._process.communicate(pickle.dumps(self._task), timeout=seconds)
        except subprocess.TimeoutExpired:
            self.kill()
            self._process.communicate()
            return None
        finally:
            self.kill()
            self._process.wait()
            os.close(self._lifeline)
        return self._process.returncode, answer, said

    def kill(self) -> None:
        """With everything that it started."""
        if self._process.returncode is not None:  # its number may be somebody else's by now
            return
        with suppress(OSError):
            if os.name == "posix":
                os.killpg(self._process.pid, signal.SIGKILL)
            else:
                self._process.kill()


class Processes:
    """Those that run, so that all can be ended at once; from a ``nursery`` where there is one."""

    def __init__(self, nursery: Nursery | None = None) -> None:
        self._nursery = nursery
        self._running: set[Running] = set()
        self._lock = threading.Lock()
        self.closed = False

    def start(self, task: Task, memory: int | None) -> Running | None:
        """A process for a task; None after ``close``.  Raises OSError where there can be none."""
        with self._lock:
            if self.closed:
                return None
            running: Running | None = None
            if self._nursery is not None and self._nursery.lives:
                with suppress(OSError):
                    running = self._nursery.begin(task, memory)
            running = running or Fresh(task, memory)
            self._running.add(running)
            return running

    def ended(self, running: Running) -> None:
        with self._lock:
            self._running.discard(running)

    def close(self) -> None:
        """Ends those that run, and lets no other one begin."""
        with self._lock:
            self.closed = True
            for running in self._running:
                running.kill()


def isolated(task: Task, budget: Budget, processes: Processes | None = None) -> Finished:
    """What becomes of a description, in a process of its own that ends when its budget is used up, or this one ends.

    The result of ``work`` where the process came to its end; else a row that says what happened to it.
    """
    processes = processes or Processes()
    started = time.monotonic()
    finished = _ran(task, budget, processes)
    return replace(finished, row=replace(finished.row, seconds=time.monotonic() - started))


def _ran(task: Task, budget: Budget, processes: Processes) -> Finished:
    try:
        running = processes.start(task, budget.memory)
    except OSError as error:
        return _failed(
            task, Outcome.CRASHED, Message("its process cannot be started: [[why]]", why=error.strerror or error)
        )
    if running is None:
        return _failed(task, Outcome.INTERRUPTED)
    try:
        ended = running.talk(budget.seconds)
    finally:
        processes.ended(running)
    if ended is None:
        return _failed(task, Outcome.TIMEOUT, Message("stopped after [[seconds]] s", seconds=f"{budget.seconds:g}"))
    code, answer, said = ended
    if code == 0:
        with suppress(Exception):  # whatever stands there is no answer
            finished: Finished = pickle.loads(answer)
            return finished
    if processes.closed:
        return _failed(task, Outcome.INTERRUPTED)
    return _ended(task, budget, code, said.decode("utf-8", "replace"))


def _ended(task: Task, budget: Budget, code: int | None, said: str) -> Finished:
    """Why a process ended without an answer."""
    if any(word in said.lower() for word in _MEMORY_WORDS):
        code = OUT_OF_MEMORY
    what = how_it_ended(code, budget.memory)
    if code == OUT_OF_MEMORY:
        return _failed(task, Outcome.MEMORY, what)
    last = said.strip().rpartition("\n")[2][-_LAST_WORDS:]
    return _failed(task, Outcome.CRASHED, joined((what, last), ": ") if last else what)


def how_it_ended(code: int | None, memory: int | None) -> Message:
    """What the exit code of a worker says, None where nobody knows it."""
    if code == OUT_OF_MEMORY:
        if memory:
            return Message("more than [[count]] MB were wanted", count=memory // 2**20)
        return Message("the memory was not enough")
    if code is None:
        return Message("its process is gone")
    if code < 0:
        return Message("its process was ended by [[signal]]", signal=_signal_name(-code))
    return Message("its process ended with code [[code]]", code=code)


def _failed(task: Task, outcome: Outcome, message: str = "") -> Finished:
    return Finished(Row(task.file, task.folder, outcome, message=message))


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"
