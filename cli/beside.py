"""Part of a run's work in a copy of this process, beside it: a run keeps two cores busy, not one.

The copy is made once what both halves need is derived (``fork``), so that nothing is derived twice and nothing but the
finished half is handed over.  It is help, nothing more: where the copy cannot be made, fails, meets a defect or is
killed, the work is done here, as if there had been no help.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import Any, TypeVar

from mbsym_cli.console import DEFECTS, paused

T = TypeVar("T")

#: A process that holds more than so many bytes is not copied: the copy would soon hold as much of its own.
MOST_MEMORY = 2 * 10**9

_BLOCK = 1 << 20


class Beside:
    """Whether there is help: only for a command in a process of its own (``mbsym_cli.main``)."""

    allowed = False


def helped() -> bool:
    """Whether a copy of this process would have a core of its own, and nobody minds it."""
    if not (Beside.allowed and sys.platform == "linux" and threading.active_count() == 1):
        return False
    if sys.getprofile() is not None or sys.gettrace() is not None:  # somebody wants to see all of it
        return False
    import resource

    held = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    cores = len(os.sched_getaffinity(0))
    return cores > 1 and _running() <= cores and held < MOST_MEMORY


def _running() -> int:
    """How many threads of this machine want a core now, this one among them; 1 where that is not told."""
    with suppress(OSError, ValueError, IndexError):
        return int(Path("/proc/loadavg").read_text().split()[3].partition("/")[0])
    return 1


@contextmanager
def beside(work: Callable[[], T], sound: Callable[[T], bool]) -> Iterator[Callable[[], T]]:
    """``work()`` begins in a copy of this process where there is help; yields what waits for its value.

    What is yielded calls ``work`` here where no copy has come to its end with a ``sound`` value.  Such a value must be
    made of what ``pickle`` knows.  Leaving early ends the copy.
    """
    copy = _copied(work, sound)
    if copy is None:
        yield work
        return
    with copy:

        def value() -> T:
            available, made = copy.value()
            return made if available else work()

        yield value


def _copied(work: Callable[[], Any], sound: Callable[[Any], bool]) -> _Copy | None:
    with paused(), suppress(OSError):  # of a fork
        if helped():
            return _Copy(work, sound)
    return None


class _Copy:
    """A forked process that computes one value and sends it through a pipe."""

    def __init__(self, work: Callable[[], Any], sound: Callable[[Any], bool]) -> None:
        self._answer, answer = os.pipe()
        try:
            self._process = os.fork()
        except OSError:
            os.close(self._answer)
            os.close(answer)
            raise
        if self._process == 0:
            _compute(work, sound, answer)
        os.close(answer)

    def value(self) -> tuple[bool, Any]:
        """(whether the copy came to its end, the value)."""
        received = bytearray()
        with suppress(OSError):
            while block := os.read(self._answer, _BLOCK):
                received += block
        if not received.endswith(b"."):  # the last byte of a pickle
            return False, None
        import pickle

        try:
            return True, pickle.loads(received)
        except Exception:  # written by ourselves, but cut short
            return False, None

    def __enter__(self) -> _Copy:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        os.close(self._answer)
        with suppress(OSError):
            os.kill(self._process, signal.SIGKILL)
        with suppress(OSError):
            os.waitpid(self._process, 0)


def _compute(work: Callable[[], Any], sound: Callable[[Any], bool], answer: int) -> None:
    """The copy's whole life.  It says nothing, and leaves everything that it shares with its original as it is."""
    import pickle

    code = 1
    try:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            if callable(signal.getsignal(number)):  # nohup's SIGHUP stays ignored
                signal.signal(number, signal.SIG_DFL)
        contained = len(DEFECTS.errors)
        value = work()
        if sound(value) and len(DEFECTS.errors) == contained:
            made = memoryview(pickle.dumps(value, pickle.HIGHEST_PROTOCOL))
            while made:
                made = made[os.write(answer, made) :]
            code = 0
    except BaseException:  # the original does it itself, and tells what is to be told
        pass
    finally:
        os._exit(code)
