"""The process of a job: loads the library, waits for one task, tells what becomes of it, and ends.

What it tells goes through its connection as dictionaries: ``kind`` and what belongs to it (``jobs`` has the list).
When the server is gone, however it went, the process ends, too.
"""

from __future__ import annotations

import os
import sys
import traceback
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import Any

#: Exit codes: the memory that a job may have was not enough.
OUT_OF_MEMORY = 75

#: Tasks that fill a page by and by.
PATIENT = ("derive", "export", "map")

_WARMING = """\
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


def warm() -> None:
    """Loads what every job needs, and has used it once."""
    from mbsym.serving.tasks import perform

    with suppress(Exception):
        for _ in perform({"kind": "derive", "text": _WARMING, "name": "pendulum.yaml", "problems": [1, 3, 6]}):
            pass
        for _ in perform({"kind": "picture", "text": _WARMING, "name": "pendulum.yaml"}):
            pass


def attend(connection: Connection, memory: int, cold: bool = False) -> None:
    """What a process does; never returns.  A ``cold`` one has its task already, and loads what that needs."""
    code = 1
    try:
        if not cold and "mbsym.serving.warmed" not in sys.modules:  # else it was forked from one that is warm
            warm()
        connection.send({"kind": "ready"})
        task: dict[str, Any] = connection.recv()
        _step_back(task)
        _hang_on(connection.fileno())
        _bound(memory)
        from mbsym.serving.tasks import perform

        for message in perform(task):
            connection.send(message)
        connection.send({"kind": "done"})
        code = 0
    except MemoryError:
        code = OUT_OF_MEMORY
    except (EOFError, ConnectionError, KeyboardInterrupt):
        code = 0  # nobody listens any more
    except BaseException as error:
        traceback.print_exc()
        with suppress(Exception):
            connection.send({"kind": "failed", "words": f"internal error: {type(error).__name__}: {error}"})
            code = 0
    finally:
        with suppress(Exception):
            sys.stdout.flush()
            sys.stderr.flush()
        # What is left is to take down what was built up, for nobody.
        os._exit(code)


def _step_back(task: dict[str, Any]) -> None:
    """What takes long lets what somebody waits for go first: the picture, the motion."""
    if task.get("kind") in PATIENT and hasattr(os, "nice"):
        with suppress(OSError):
            os.nice(10)


def _bound(memory: int) -> None:
    """No more than so many bytes, where the system has such a bound; and no core dumps."""
    try:
        import resource
    except ImportError:
        return
    with suppress(ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    with suppress(ValueError, OSError):
        kind = resource.RLIMIT_DATA if sys.platform == "linux" else resource.RLIMIT_AS
        resource.setrlimit(kind, (memory, memory))


def _hang_on(handle: int) -> None:
    """A signal that ends this process comes from the system itself when the other end is closed, also amid algebra
    that does not let threads run."""
    try:
        import fcntl
        import select
        import signal

        signal.signal(signal.SIGIO, signal.SIG_DFL)
        fcntl.fcntl(handle, fcntl.F_SETOWN, os.getpid())
        fcntl.fcntl(handle, fcntl.F_SETFL, fcntl.fcntl(handle, fcntl.F_GETFL) | os.O_ASYNC)
        gone = select.select([handle], [], [], 0)[0]
    except (ImportError, AttributeError, OSError, ValueError):
        return
    if gone:
        os._exit(1)
