"""Several descriptions at once, in the shape of ``concurrent.futures``."""

from __future__ import annotations

from concurrent.futures import Future
from typing import Protocol

from mbsym.batch.task import Budget, Finished, Task


class Executor(Protocol):
    """Where tasks are done: processes of this machine, or many machines.

    A future of a task always has a result: what goes wrong with a description (it has errors, it crashes, it meets its
    budget) is the outcome of its row.  ``width`` is how many tasks are worth being there at once.
    """

    width: int

    def submit(self, task: Task, budget: Budget) -> Future[Finished]:
        """Done some time, within its budget, in a process of its own."""
        ...

    def close(self) -> None:
        """What still runs is killed, what waits is forgotten; returns when no process is left."""
        ...
