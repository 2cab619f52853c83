"""The streams and signals of the process, made so that what happens to them costs no results.

Standard output may be closed, full, a pipe whose reader has gone, or a terminal that knows only ASCII: the command
goes on, its reports are written, and its exit code is what it deserves.  A full device is told once, and gives code 1.
SIGTERM and SIGHUP do what Ctrl-C does; the exit code tells them apart as shells do, 128 and the number of the signal.
"""

from __future__ import annotations

import io
import os
import select
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any, TextIO


class Stopped(KeyboardInterrupt):
    """A signal asked the command to end."""


class Outlet(io.RawIOBase):
    """Writes to a file descriptor for as long as that is possible; what comes later is dropped.

    ``refusal`` is the error of a device that took no more; a reader who has gone, or never was, is no error.
    """

    def __init__(self, descriptor: int | None) -> None:
        self.descriptor = descriptor
        self.refusal: OSError | None = None

    def writable(self) -> bool:
        return True

    def fileno(self) -> int:
        if self.descriptor is None:
            raise io.UnsupportedOperation("fileno")
        return self.descriptor

    def isatty(self) -> bool:
        return self.descriptor is not None and os.isatty(self.descriptor)

    def write(self, data: Any) -> int:
        view = memoryview(data)
        if self.descriptor is not None:
            try:
                return self._written(self.descriptor, view)
            except BrokenPipeError:
                self.descriptor = None
            except OSError as error:
                self.descriptor, self.refusal = None, error
        return len(view)

    @staticmethod
    def _written(descriptor: int, view: memoryview) -> int:
        while True:
            try:
                return os.write(descriptor, view)
            except BlockingIOError:  # a pipe that does not wait is waited for
                select.select([], [descriptor], [])


class Streams:
    """Standard output and error of a process, in place of Python's own."""

    def __init__(self) -> None:
        self.out = self._outlet(1, sys.stdout)
        self.error = self._outlet(2, sys.stderr)
        sys.stdout = _text(self.out, sys.stdout)
        sys.stderr = _text(self.error, sys.stderr)

    @staticmethod
    def _outlet(descriptor: int, stream: TextIO | None) -> Outlet:
        if stream is None:  # closed by who called us: the number must not go to a file that is opened later
            with suppress(OSError):
                while (null := os.open(os.devnull, os.O_RDWR)) < descriptor:
                    pass
                if null > descriptor:
                    os.close(null)
            return Outlet(None)
        stream.flush()
        return Outlet(descriptor)

    def refused(self) -> str:
        """What kept standard output from being written, or ""."""
        with suppress(OSError, ValueError):
            sys.stdout.flush()
        return "" if self.out.refusal is None else str(self.out.refusal.strerror)


def _text(outlet: Outlet, like: TextIO | None) -> io.TextIOWrapper:
    """A text stream whose characters always have some spelling."""
    encoding = (like.encoding if like is not None else None) or "utf-8"
    return io.TextIOWrapper(
        io.BufferedWriter(outlet), encoding, "backslashreplace", line_buffering=outlet.isatty(), write_through=False
    )


def own_process() -> bool:
    """Whether the streams are those that the process was started with, and not a caller's."""
    return os.name == "posix" and sys.stdout is sys.__stdout__ and sys.stderr is sys.__stderr__


@contextmanager
def stoppable() -> Iterator[list[int]]:
    """Signals that end a process end it as Ctrl-C does; yields the list of those that came."""
    came: list[int] = []

    def stop(number: int, _: FrameType | None) -> None:
        came.append(number)
        raise Stopped

    if threading.current_thread() is not threading.main_thread():
        yield came
        return
    numbers = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]
    ours = [number for number in numbers if signal.getsignal(number) == signal.SIG_DFL]  # nohup ignores SIGHUP
    for number in ours:
        signal.signal(number, stop)
    try:
        yield came
    finally:
        for number in ours:
            signal.signal(number, signal.SIG_DFL)
