"""Jobs, each in a process of its own: begun at once, bounded, cancelled by ending the process.

One process waits ready, with everything loaded, so that a job begins without the wait for imports; where the system can
fork (Linux) it comes from one that has loaded them already.  A process that dies costs its job, which fails with words.

A job may be begun ahead of its page (``ahead``): what it tells is kept until a page asks for the very same.

Events are dictionaries: those of ``tasks``, with the ``job`` they belong to, and ``done``, ``failed`` (words),
``cancelled`` (words); exactly one of these three ends a job.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from itertools import count
from multiprocessing.connection import Connection, wait
from multiprocessing.context import BaseContext
from time import monotonic
from typing import Any

from mbsym.batch.isolation import how_it_ended
from mbsym.batch.worker import SINGLE
from mbsym.serving.worker import attend

Event = dict[str, Any]

#: Seconds and bytes that a job may have; so many run at once, and older ones make room.
MOST_SECONDS, MOST_MEMORY, MOST_AT_ONCE = 900.0, 4 * 2**30, 4

#: Whoever has waited so long for a process to be ready does without.
MOST_LOADING = 120.0

_ENDS = ("done", "failed", "cancelled")

_ENVIRONMENT = threading.Lock()


@contextmanager
def _single_threaded() -> Iterator[None]:
    """A process that starts meanwhile inherits ``SINGLE``; one thread at a time, as the environment is everybody's."""
    with _ENVIRONMENT:
        before = {name: os.environ.get(name) for name in SINGLE}
        os.environ.update(SINGLE)
        try:
            yield
        finally:
            for name, value in before.items():
                if value is None:
                    os.environ.pop(name, None)
                else:
                    os.environ[name] = value


def _context() -> BaseContext:
    if sys.platform != "linux":  # elsewhere libraries do not bear to be forked
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["mbsym.serving.warmed"])
    return context


@dataclass(eq=False)
class _Process:
    """A process that is ready, or will be, and our end of its connection."""

    process: Any
    connection: Connection

    def kill(self) -> None:
        with suppress(Exception):
            self.process.kill()

    def bury(self) -> int | None:
        """Its exit code."""
        with suppress(Exception):
            self.connection.close()
        self.process.join(10)
        code: int | None = self.process.exitcode
        with suppress(ValueError):
            self.process.close()
        return code


@dataclass(eq=False)
class _Job:
    name: str
    kind: str
    page: str
    tell: Callable[[Event], None]
    process: _Process | None = None
    over: bool = False
    #: Nothing is loaded yet, so that its process begins by itself instead of waiting for one to be forked from.
    cold: bool = False
    #: What nobody has asked for yet.
    waiting: list[Event] | None = None
    lock: threading.Lock = field(default_factory=threading.Lock)

    def say(self, event: Event) -> None:
        """Nothing after the end."""
        with self.lock:
            if self.over:
                return
            self.over = event["kind"] in _ENDS
            (self.tell if self.waiting is None else self.waiting.append)({"job": self.name, **event})

    def tell_kept(self) -> None:
        """From now on it is told to somebody, what was kept first; of what is being done only the last word."""
        with self.lock:
            events, self.waiting = self.waiting or [], None
            for k, event in enumerate(events):
                if event["kind"] != "progress" or k == len(events) - 1:
                    self.tell(event)

    def end(self, words: str, kind: str = "cancelled") -> None:
        self.say({"kind": kind, "words": words})
        if self.process is not None:
            self.process.kill()


class Jobs:
    """``tell`` gets every event, from any thread."""

    def __init__(self, tell: Callable[[Event], None], seconds: float = MOST_SECONDS, memory: int = MOST_MEMORY) -> None:
        self._tell, self._seconds, self._memory = tell, seconds, memory
        self._context = _context()
        self._running: dict[str, _Job] = {}
        self._ahead: tuple[dict[str, Any], _Job] | None = None
        self._spare: _Process | None = None
        self._lock = threading.Lock()
        self._spare_lock = threading.Lock()
        self._numbers = count(1)
        self._closed = False

    def warm(self) -> None:
        """Has a process ready.  Takes as long as the imports: not for an event loop."""
        with self._spare_lock:
            if self._spare is None and not self._closed:
                with suppress(OSError):
                    self._spare = self._started()

    def ahead(self, task: Mapping[str, Any]) -> None:
        """Begins what a page will ask for; the first task of its kind that is another one ends it."""
        job = _Job(str(next(self._numbers)), str(task["kind"]), "", self._tell, cold=True, waiting=[])
        with self._lock:
            if self._closed or self._ahead is not None:
                return
            self._ahead = dict(task), job
            self._running[job.name] = job
        self._attended(job, task)

    def _found_ahead(self, task: Mapping[str, Any]) -> _Job | None:
        """The job that was begun ahead where it is this one; where it is of another text it ends."""
        if self._ahead is None or self._ahead[0]["kind"] != task["kind"]:
            return None
        (begun_task, job), self._ahead = self._ahead, None
        if begun_task == dict(task) and not (job.waiting and job.waiting[-1]["kind"] == "cancelled"):
            return job
        threading.Thread(target=job.end, args=("another text is asked for",), daemon=True).start()
        return None

    def begin(self, task: Mapping[str, Any], page: str = "", tell: Callable[[Event], None] | None = None) -> str:
        """The name of a job that has begun.

        An older one of the same kind and ``page`` is cancelled; so is the oldest of all where too many run.  Its events
        go to ``tell`` where there is one, and then it is nobody's to replace.
        """
        job = _Job(str(next(self._numbers)), str(task["kind"]), page, tell or self._tell)
        with self._lock:
            if self._closed:
                job.say({"kind": "cancelled", "words": "the server ends"})
                return job.name
            begun = self._found_ahead(task) if tell is None else None
            if begun is not None:
                job, job.page = begun, page
            own = [x for x in self._running.values() if x.tell is self._tell and x is not job]
            old = [x for x in own if tell is None and (x.kind, x.page) == (job.kind, page)]
            others = [x for x in own if x not in old] if tell is None else []
            if begun is None:
                self._running[job.name] = job
        for previous in old:
            previous.end("begun again")
        for other in others[: max(0, len(others) + 1 - MOST_AT_ONCE)]:
            other.end("it made room for another")
        if begun is None:
            self._attended(job, task)
        else:
            job.tell_kept()
        return job.name

    def cancel(self, name: str) -> bool:
        """Whether there was such a job."""
        with self._lock:
            job = self._running.get(name)
        if job is None:
            return False
        job.end("cancelled")
        return True

    def cancel_all(self, words: str) -> None:
        """Those that tell everybody."""
        with self._lock:
            left = [x for x in self._running.values() if x.tell is self._tell]
        for job in left:
            job.end(words)

    def result(
        self, task: Mapping[str, Any], page: str = "", seconds: float = 60.0, begun: Callable[[str], None] | None = None
    ) -> Event:
        """What a job of one message tells: that, or its failure.  Waits; not for an event loop.

        ``begun`` is told the name of the job, by which it can be cancelled.
        """
        events: list[Event] = []
        over = threading.Event()

        def heard(event: Event) -> None:
            if event["kind"] not in ("done", "progress"):
                events.append(event)
            if event["kind"] in _ENDS:
                over.set()

        name = self.begin(task, page, heard)
        if begun is not None:
            begun(name)
        if not over.wait(seconds):
            self.cancel(name)
            return {"kind": "failed", "words": f"stopped after {seconds:g} s"}
        return events[-1] if events else {"kind": "failed", "words": "its process told nothing"}

    def close(self) -> None:
        """Ends all of them."""
        with self._lock:
            self._closed = True
            left = list(self._running.values())
        for job in left:
            job.end("the server ends")
        with self._spare_lock:
            spare, self._spare = self._spare, None
        if spare is not None:
            spare.kill()
            spare.bury()

    # --- one job, in a thread that waits for it -----------------------------------------------------------------------

    def _attended(self, job: _Job, task: Mapping[str, Any]) -> None:
        threading.Thread(target=self._attend, args=(job, dict(task)), daemon=True, name=f"job {job.name}").start()

    def _attend(self, job: _Job, task: dict[str, Any]) -> None:
        try:
            job.process = process = self._started(cold=True) if job.cold else self._taken()
        except Exception as error:  # as few processes as the system has left, or an interpreter that cannot be found
            words = getattr(error, "strerror", None) or str(error) or type(error).__name__
            job.say({"kind": "failed", "words": f"no process can be started: {words}"})
            self._forget(job)
            return
        try:
            if job.over:  # cancelled before it began
                process.kill()
            self._heard(job, process, task)
        except Exception as error:
            job.say({"kind": "failed", "words": f"internal error: {type(error).__name__}: {error}"})
        finally:
            process.kill()
            code = process.bury()
            job.say({"kind": "failed", "words": str(how_it_ended(code, self._memory))})
            self._forget(job)

    def _heard(self, job: _Job, process: _Process, task: dict[str, Any]) -> None:
        """Hands over the task, and tells what is told until the process has ended or time is up."""
        connection = process.connection
        try:
            connection.send(task)
            seconds, words = MOST_LOADING, "its process was not ready after"
            end = monotonic() + seconds
            while not job.over:
                if not wait([connection], max(0.0, end - monotonic())):
                    job.end(f"{words} {seconds:g} s", "failed")
                    return
                message = connection.recv()
                if message["kind"] == "ready":
                    seconds, words = self._seconds, "stopped after"
                    end = monotonic() + seconds
                else:
                    job.say(message)
        except (EOFError, OSError):  # it has ended; its code says why
            return

    def _forget(self, job: _Job) -> None:
        with self._lock:
            self._running.pop(job.name, None)

    # --- processes ----------------------------------------------------------------------------------------------------

    def _taken(self) -> _Process:
        """The one that waits, and another in its place soon; raises OSError where there can be none."""
        with self._spare_lock:
            process, self._spare = self._spare, None
        if process is not None and not process.process.is_alive():
            process.bury()
            process = None
        taken = process or self._started()
        threading.Thread(target=self.warm, daemon=True, name="spare").start()
        return taken

    def _started(self, cold: bool = False) -> _Process:
        context = multiprocessing.get_context("spawn") if cold else self._context
        ours, theirs = multiprocessing.Pipe()
        try:
            process = context.Process(target=attend, args=(theirs, self._memory, cold), daemon=True)  # type: ignore[attr-defined]
            with _single_threaded():
                process.start()
        except BaseException:
            ours.close()
            raise
        finally:
            theirs.close()
        return _Process(process, ours)
