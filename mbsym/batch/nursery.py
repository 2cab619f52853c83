"""Processes for many descriptions without the wait for imports: one has loaded the algebra, and forks for each of them.

    batch -> nursery -> nurse -> worker

The nursery derives nothing but one pendulum, to have everything at hand.  A nurse waits for its worker and tells how it
ended; so whatever a worker does, it does to itself.  The batch ends a worker by letting go of its lifeline.

Only on Linux: elsewhere libraries do not bear to be forked, or there is no such thing.
"""

from __future__ import annotations

import gc
import os
import pickle
import select
import signal
import socket
import subprocess
import sys
import tempfile
import threading
from contextlib import suppress
from typing import IO

from mbsym.batch.transport import BatchOptions, Task
from mbsym.batch.worker import PENDULUM, SINGLE, attend

#: A worker gets: its task, where the answer goes, where complaints go, its lifeline; its nurse, where to report.
_HANDLES = 5

#: Seconds after which nobody waits for the imports any more.
_MOST_LOADING = 60.0


def available() -> bool:
    return sys.platform == "linux" and hasattr(socket, "send_fds")


class Nursery:
    """The batch's side.  No two threads may call ``begin`` at once."""

    def __init__(self, formats: tuple[str, ...]) -> None:
        self._ready = False
        self._line, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-m", "mbsym.batch.nursery", str(theirs.fileno()), *formats],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                env=os.environ | SINGLE,
                pass_fds=(theirs.fileno(),),
                start_new_session=True,
            )

    def begin(self, task: Task, memory: int | None) -> Forked:
        """A worker for a task, once everything is loaded.  Raises OSError where the nursery is gone."""
        if not self._ready:
            self._line.settimeout(_MOST_LOADING)
            if not self._line.recv(1):
                raise ConnectionResetError("the nursery is gone")
            self._line.settimeout(None)
            self._ready = True
        return Forked(self._line, task, memory)

    @property
    def lives(self) -> bool:
        return self._process.poll() is None

    def close(self) -> None:
        self._line.close()
        with suppress(OSError):
            self._process.kill()
        self._process.wait()


class Forked:
    """A worker of the nursery, in the hands of the batch."""

    def __init__(self, line: socket.socket, task: Task, memory: int | None) -> None:
        self._lock = threading.Lock()
        self._answer = tempfile.TemporaryFile()  # noqa: SIM115 (both are closed with this)
        self._said = tempfile.TemporaryFile()  # noqa: SIM115
        inner, self._lifeline = os.pipe()
        self._report, report = os.pipe()
        self._closed = False
        try:
            with tempfile.TemporaryFile() as content:
                pickle.dump(task, content)
                content.seek(0)
                handles = [content.fileno(), self._answer.fileno(), self._said.fileno(), inner, report]
                socket.send_fds(line, [str(memory or 0).encode()], handles)
        except BaseException:
            self.kill()
            self._leave()
            raise
        finally:
            os.close(inner)
            os.close(report)

    def talk(self, seconds: float | None) -> tuple[int | None, bytes, bytes] | None:
        """How the worker ended, its answer and its complaints; None where it was late, and is ended.

        Its exit code is None where nobody knows it.
        """
        waiting = select.poll()  # handles can have numbers that are too large for select
        waiting.register(self._report, select.POLLIN)
        ready = waiting.poll(None if seconds is None else seconds * 1000)
        if not ready:
            self.kill()
        code = os.read(self._report, 32)  # at the latest when the nurse has gone
        try:
            return (int(code) if code else None, _whole(self._answer), _whole(self._said)) if ready else None
        finally:
            self.kill()
            self._leave()

    def kill(self) -> None:
        """Lets go of the lifeline."""
        with self._lock:
            if not self._closed:
                self._closed = True
                os.close(self._lifeline)

    def _leave(self) -> None:
        os.close(self._report)
        self._answer.close()
        self._said.close()


def _whole(file: IO[bytes]) -> bytes:
    file.seek(0)
    return file.read()


# --- the nursery's side -----------------------------------------------------------------------------------------------


def main() -> None:
    line = socket.socket(fileno=int(sys.argv[1]))
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nurses need no burial
    with suppress(Exception):  # whoever comes will see it again
        from mbsym.batch.work import work

        work(Task("pendulum.yaml", "", PENDULUM.encode(), BatchOptions(tuple(sys.argv[2:]))))
    line.send(b"!")
    gc.collect()
    gc.freeze()  # what is there stays: nobody looks at it again, so that it stays shared
    while True:
        data, handles, _, _ = socket.recv_fds(line, 64, _HANDLES)
        if not data:  # the batch has gone
            os._exit(0)
        with suppress(OSError):  # of a fork; nobody reports then
            if os.fork() == 0:
                try:
                    line.close()
                    _nurse(int(data), *handles)
                finally:
                    os._exit(1)
        for handle in handles:
            os.close(handle)


def _nurse(memory: int, task: int, answer: int, said: int, lifeline: int, report: int) -> None:
    os.setsid()
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    worker = os.fork()
    if worker == 0:
        os.close(report)
        os.dup2(task, 0)
        os.dup2(said, 1)
        os.dup2(said, 2)
        attend(memory, lifeline, answer)
    for handle in (task, answer, said, lifeline):
        os.close(handle)
    _, status = os.waitpid(worker, 0)
    os.write(report, str(os.waitstatus_to_exitcode(status)).encode())


if __name__ == "__main__":
    main()
