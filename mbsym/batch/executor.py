"""Several descriptions at once, in the shape of ``concurrent.futures``."""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor
from typing import Protocol

from mbsym.batch.isolation import Processes, isolated
from mbsym.batch.nursery import Nursery, available
from mbsym.batch.task import Budget, Finished, Task

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
