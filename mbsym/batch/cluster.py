"""Descriptions derived by many machines: an executor over a Dask scheduler.

A worker does what a process of this machine would do, with the same budget in a process of its own, and sends back the
same values; files are written here.  What a lost worker had begun is begun again by another one.
"""

from __future__ import annotations

import asyncio
import logging
import uuid
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from mbsym.batch.digests import derivation
from mbsym.batch.isolation import Processes, isolated
from mbsym.batch.outcome import Outcome, Row
from mbsym.batch.transport import Budget, Finished, Task
from mbsym.expressions.message import Message

if TYPE_CHECKING:
    from concurrent.futures import Future

#: A scheduler is waited for so many seconds, and its first worker so many.
CONNECT, FIRST_WORKER = 15.0, 120.0

#: For each worker there is so much to do that it need not wait for the next.
_AHEAD = 2

#: The word for a cluster of processes on this machine.
LOCAL = "local"


class NoCluster(Exception):
    """There is no cluster to work on; ``reason`` says why and what to do."""

    def __init__(self, reason: Message) -> None:
        self.reason = reason
        super().__init__(str(reason))


class Connection:
    """The workers of a Dask scheduler at ``address`` (``tcp://host:8786``); ``local`` starts ``jobs`` of them here.

    Raises NoCluster where there is none, where no worker comes, or where workers have another version of mbsym.
    """

    def __init__(self, address: str, jobs: int) -> None:
        distributed = _distributed()
        logging.getLogger("distributed").setLevel(logging.CRITICAL)  # what is lost is told in rows
        self._own = None
        try:
            if address != LOCAL:
                _speak_with(distributed, address)
            else:
                self._own = distributed.LocalCluster(
                    n_workers=jobs, threads_per_worker=1, dashboard_address=None, host="127.0.0.1"
                )
            self.client = distributed.Client(self._own or address, timeout=CONNECT, set_as_default=False)
        except (OSError, ValueError, ImportError) as error:  # connection refused, no such address, no TLS
            raise NoCluster(
                Message("no scheduler answers at [[address]]: [[why]]", address=address, why=_first_line(error))
            ) from error
        try:
            self.client.wait_for_workers(1, timeout=FIRST_WORKER)
            self._check_versions()
        except BaseException as error:
            self.close()
            if isinstance(error, TimeoutError):
                text = "the scheduler at [[address]] has no worker; start one: dask worker [[address]]"
                raise NoCluster(Message(text, address=address)) from None
            raise
        # Its futures are those of concurrent.futures; a deterministic mistake is not repeated, a lost worker's task is.
        self.executor = self.client.get_executor(pure=False, retries=0)

    @property
    def width(self) -> int:
        """How many tasks are worth being there: workers come and go."""
        with suppress(Exception):
            return max(1, _AHEAD * sum(self.client.nthreads().values()))
        return 1

    def close(self) -> None:
        with suppress(Exception):
            self.client.close()
        if self._own is not None:
            with suppress(Exception):
                self._own.close()

    def _check_versions(self) -> None:
        own_version = derivation()
        for worker, worker_version in self.client.run(derivation).items():
            if worker_version != own_version:
                text = "the worker [[worker]] has another version of mbsym: install the same there and here"
                raise NoCluster(Message(text, worker=worker))


class Cluster:
    """Descriptions derived by the workers of a ``Connection``."""

    def __init__(self, address: str, jobs: int) -> None:
        self._there = Connection(address, jobs)
        self._token = uuid.uuid4().hex

    @property
    def width(self) -> int:
        return self._there.width

    def submit(self, task: Task, budget: Budget) -> Future[Finished]:
        from concurrent.futures import Future

        future: Future[Finished] = Future()
        there = self._there.executor.submit(at_worker, task, budget, derivation(), self._token)

        def pass_on(done: Future[Finished]) -> None:
            future.set_result(_finished(done, task))

        there.add_done_callback(pass_on)
        return future

    def close(self) -> None:
        with suppress(Exception):
            self._there.client.run(end, self._token)
        self._there.close()


def _distributed() -> Any:
    try:
        import distributed
    except ImportError:
        raise NoCluster(Message("Dask is needed: pip install 'mbsym[cluster]'")) from None
    return distributed


def _speak_with(distributed: Any, address: str) -> None:
    """Raises NoCluster where something else answers, OSError where nothing does, ValueError for no address.

    A client that fails later leaves threads behind, and takes what a server of another kind says for the length of a
    message, for which it has no memory.
    """

    async def spoken() -> None:
        secured = distributed.security.Security().get_connection_args("client")
        comm = await distributed.comm.connect(address, timeout=CONNECT, **secured)
        await comm.close()

    try:
        asyncio.run(spoken())
    except (OSError, ValueError, ImportError):
        raise
    except (Exception, MemoryError) as error:
        text = "what answers at [[address]] is no Dask scheduler of this version"
        raise NoCluster(Message(text, address=address)) from error


def _first_line(error: BaseException) -> str:
    return (str(error).strip() or type(error).__name__).split("\n")[0]


def _finished(done: Future[Finished], task: Task) -> Finished:
    """What came back, or a row that says why nothing did."""
    try:
        return done.result()
    except Exception as error:
        if type(error).__name__ == "KilledWorker":
            message = "so many workers were lost over it that the scheduler gave it up"  # how many is its own setting
        elif type(error).__name__ in ("CancelledError", "FutureCancelledError"):
            return Finished(Row(task.file, task.folder, Outcome.INTERRUPTED))
        else:
            message = f"the cluster gave it back: {type(error).__name__}: {_first_line(error)}"
        return Finished(Row(task.file, task.folder, Outcome.CRASHED, message=message))


# --- what a worker does -----------------------------------------------------------------------------------------------

#: The processes of each batch that this worker works for.
_RUNNING: dict[str, Processes] = {}


def at_worker(task: Task, budget: Budget, version: str, token: str) -> Finished:
    """What becomes of a task.  Raises RuntimeError where this worker is of another version."""
    if derivation() != version:
        raise RuntimeError("a worker has another version of mbsym")
    processes = _RUNNING.setdefault(token, Processes())
    return isolated(task, budget, processes)


def end(token: str) -> None:
    """Ends what runs here for a batch that is over."""
    processes = _RUNNING.pop(token, None)
    if processes is not None:
        processes.close()
