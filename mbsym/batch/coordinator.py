"""A batch: what is up to date is taken, the rest is derived by an executor, every row is told when it is there.

One thread does this; the executor has its own.  Reading and writing files is for the ``Store``, telling for the
``Watcher``.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Protocol

from mbsym.batch.isolation import Processes, isolated
from mbsym.batch.nursery import Nursery, available
from mbsym.batch.outcome import Outcome, Row
from mbsym.batch.transport import Budget, Finished, Task

#: Seconds between two looks at folders that another batch is working on, and at the clock.
TICK = 0.1


@dataclass(frozen=True)
class Place:
    """A description: its path as it was found, and the folder of its files in the batch's."""

    file: str
    folder: str


class Store(Protocol):
    """What is there already, and where results go."""

    def look(self, place: Place) -> Row | Task:
        """The row where it is known without deriving anything, or the task that has to be done."""
        ...

    def take(self, place: Place) -> bool:
        """Reserves the folder for this batch; false while another one has it."""
        ...

    def leave(self, place: Place) -> None:
        """Lets others have it."""
        ...

    def keep(self, task: Task, finished: Finished) -> Row:
        """Writes the files, and gives the row that is true then."""
        ...


class Watcher(Protocol):
    """Who is told what happens."""

    def began(self, file: str) -> None: ...

    def ended(self, row: Row) -> None: ...

    def tick(self) -> None: ...


class Batch:
    """One batch over ``places``.  ``rows`` has what is finished, by file, also after an interruption."""

    def __init__(
        self,
        places: Sequence[Place],
        store: Store,
        watcher: Watcher,
        budget: Budget,
        fail_fast: bool = False,
        strict_claims: bool = False,
    ) -> None:
        self.places = tuple(places)
        self.rows: dict[str, Row] = {}
        self._store, self._watcher, self._budget = store, watcher, budget
        self._fail_fast, self._strict_claims = fail_fast, strict_claims
        self._failed = False

    def run(self, executor: Callable[[int], Executor]) -> None:
        """Until every place has its row.  An executor is made where something has to be derived, for so many tasks.

        Raises KeyboardInterrupt when the batch is stopped: then no process is left, and ``rows`` has every place.
        """
        try:
            waiting = [place for place in self.places if not self._up_to_date(place)]
            if waiting and not self._stopped:
                self._derive(waiting, executor(len(waiting)))
            self._rest(Outcome.SKIPPED)
        finally:
            self._rest(Outcome.INTERRUPTED)

    @property
    def _stopped(self) -> bool:
        return self._failed and self._fail_fast

    def _up_to_date(self, place: Place) -> bool:
        if self._stopped:
            return False
        state = self._store.look(place)
        if isinstance(state, Row):
            self._end(state)
            return True
        return False

    def _derive(self, waiting: list[Place], executor: Executor) -> None:
        running: dict[Future[Finished], tuple[Place, Task]] = {}
        looked = 0.0
        try:
            while running or (waiting and not self._stopped):
                # Folders that another batch has are asked for again, but not all the time.
                if len(running) < executor.width and time.monotonic() - looked >= (TICK if self._all_taken else 0.0):
                    looked = time.monotonic()
                    self._begin(waiting, running, executor)
                self._collect(running)
                self._watcher.tick()
        finally:
            executor.close()
            for place, _ in running.values():
                self._store.leave(place)

    _all_taken = False

    def _begin(
        self, waiting: list[Place], running: dict[Future[Finished], tuple[Place, Task]], executor: Executor
    ) -> None:
        """As many as there is room for, in their order; those that another batch has wait."""
        for place in list(waiting):
            if len(running) >= executor.width or self._stopped:
                return
            if not self._store.take(place):
                continue
            waiting.remove(place)
            state = self._store.look(place)  # the other batch may have done it in the meantime
            if isinstance(state, Row):
                self._store.leave(place)
                self._end(state)
                continue
            running[executor.submit(state, self._budget)] = place, state
            self._watcher.began(place.file)
        self._all_taken = bool(waiting)

    def _collect(self, running: dict[Future[Finished], tuple[Place, Task]]) -> None:
        """What has come to its end, after a moment at most."""
        if not running:
            time.sleep(TICK)
            return
        from concurrent.futures import FIRST_COMPLETED, wait

        done, _ = wait(running, TICK, FIRST_COMPLETED)
        for future in sorted(done, key=lambda completed: running[completed][0].file):
            place, task = running[future]
            try:
                row = self._store.keep(task, self._result(future, task))
            finally:
                del running[future]
                self._store.leave(place)
            self._end(row)

    @staticmethod
    def _result(future: Future[Finished], task: Task) -> Finished:
        try:
            return future.result()
        except Exception as error:  # an executor's own mistake costs a row, too
            message = f"internal error: {type(error).__name__}: {error}".removesuffix(": ")
            return Finished(Row(task.file, task.folder, Outcome.CRASHED, message=message))

    def _end(self, row: Row) -> None:
        row = row.judged(self._strict_claims)
        self.rows[row.file] = row
        self._failed = self._failed or row.outcome.failed
        self._watcher.ended(row)

    def _rest(self, outcome: Outcome) -> None:
        """A row for what has none."""
        for place in self.places:
            if place.file not in self.rows:
                self.rows[place.file] = Row(place.file, place.folder, outcome)


# Several descriptions at once, in the shape of ``concurrent.futures``.


#: From so many tasks on it pays to load everything once.
_WORTH_A_NURSERY = 3


class Executor(Protocol):
    """Where tasks are done: processes of this machine, or many machines.

    A future of a task always has a result: what goes wrong with a description (it has errors, it crashes, it meets its
    budget) is the outcome of its row.  ``width`` is how many tasks are worth being there at once.
    """

    @property
    def width(self) -> int: ...

    def submit(self, task: Task, budget: Budget) -> Future[Finished]:
        """Done some time, within its budget, in a process of its own."""
        ...

    def close(self) -> None:
        """What still runs is killed, what waits is forgotten; returns when no process is left."""
        ...


class Local:
    """Processes of this machine, ``jobs`` at a time; forked from one that has loaded everything, where that pays."""

    def __init__(self, jobs: int, tasks: int = 1, formats: tuple[str, ...] = ()) -> None:
        self._jobs = jobs
        self._threads = ThreadPoolExecutor(jobs, thread_name_prefix="mbsym-batch")
        self._nursery = Nursery(formats) if tasks >= _WORTH_A_NURSERY and available() else None
        self._processes = Processes(self._nursery)

    @property
    def width(self) -> int:
        return self._jobs

    def submit(self, task: Task, budget: Budget) -> Future[Finished]:
        return self._threads.submit(isolated, task, budget, self._processes)

    def close(self) -> None:
        self._processes.close()
        self._threads.shutdown(wait=True, cancel_futures=True)
        if self._nursery is not None:
            self._nursery.close()
