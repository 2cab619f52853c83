"""The process of one description: ``python -m mbsym.batch.worker MEMORY LIFELINE``.

A task comes on standard input, what became of it goes to standard output, both pickled.  MEMORY is a bound in bytes, or
0; LIFELINE the number of a pipe whose other end the batch holds: when the batch is gone, however it went, this process
ends, too.
"""

from __future__ import annotations

import os
import pickle
import sys
import traceback
from contextlib import suppress
from typing import NoReturn

#: The exit code of a process that met its bound on memory.
OUT_OF_MEMORY = 75

#: One thread of arithmetic a process: there are as many processes as the machine has work for.
SINGLE = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

#: What a process derives once to have everything at hand.
PENDULUM = """\
mbsym: 1
name: pendulum
parameters: {m: positive, l: positive, g: positive}
bodies:
  - {name: bob, attached to: 0, rotation: {axes: [3], angles: [x]}, mass centre: [0, -l, 0], mass: m,
     inertia about: mass centre, inertia: [0, 0, 0]}
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
motion: {x: 0}
"""


def main() -> None:
    memory, lifeline = map(int, sys.argv[1:])
    answer = os.dup(1)
    os.dup2(2, 1)  # what a library prints must not come between
    attend(memory, lifeline, answer)


def attend(memory: int, lifeline: int, answer: int) -> NoReturn:
    """Reads a task from handle 0, writes what became of it to ``answer``, and ends the process."""
    code = 1
    try:
        hang_on(lifeline)
        bounded(memory)
        from mbsym.batch.work import work

        with open(0, "rb", closefd=False) as task, open(answer, "wb") as out:
            pickle.dump(work(pickle.load(task)), out)
        code = 0
    except MemoryError:
        code = OUT_OF_MEMORY
    except BaseException:
        traceback.print_exc()
        sys.stderr.flush()
    # What is left is to take down what was built up, for nobody.
    os._exit(code)


def bounded(memory: int) -> None:
    """No more than so many bytes, where the system has such a bound; and no core dumps."""
    try:
        import resource
    except ImportError:
        return
    with suppress(ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if memory:
        # The data segment: what is allocated.  The whole address space would count libraries that are only mapped.
        with suppress(ValueError, OSError):
            resource.setrlimit(resource.RLIMIT_DATA if sys.platform == "linux" else resource.RLIMIT_AS, (memory,) * 2)


def hang_on(lifeline: int) -> None:
    """A signal that ends this process comes from the system itself when the other end is closed.

    A thread that waits would have to wait for the algebra, too, which does not let others run while it multiplies.
    """
    try:
        import fcntl
        import select
        import signal

        signal.signal(signal.SIGIO, signal.SIG_DFL)
        fcntl.fcntl(lifeline, fcntl.F_SETOWN, os.getpid())
        fcntl.fcntl(lifeline, fcntl.F_SETFL, fcntl.fcntl(lifeline, fcntl.F_GETFL) | os.O_ASYNC)
        gone, _, _ = select.select([lifeline], [], [], 0)
    except (ImportError, AttributeError, OSError, ValueError):
        return
    if gone:  # it was closed before anybody listened
        os._exit(1)


if __name__ == "__main__":
    main()
