"""What this machine has for a batch."""

from __future__ import annotations

import hashlib
import os
from contextlib import suppress
from pathlib import Path

#: Of the memory that there is, a batch takes so much, in eighths; the rest is for everybody else.
_EIGHTHS = 7

#: Bounds of groups of processes, as containers have them.
_GROUP_BOUNDS = (Path("/sys/fs/cgroup/memory.max"), Path("/sys/fs/cgroup/memory/memory.limit_in_bytes"))


def processors() -> int:
    """How many processors this process may use."""
    with suppress(AttributeError, OSError):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def shared_memory(jobs: int) -> int | None:
    """What one of ``jobs`` processes may have, in bytes, so that all of them fit; None where that is not known."""
    try:
        bounds = [os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")]
    except (AttributeError, ValueError, OSError):
        return None
    for file in _GROUP_BOUNDS:
        with suppress(OSError, ValueError):
            bounds.append(int(file.read_text()))
    return min(bounds) * _EIGHTHS // 8 // jobs


def memory_is_bounded() -> bool:
    """Whether a process can be given a bound on its memory here."""
    try:
        import resource  # noqa: F401
    except ImportError:
        return False
    return True


# Two batches in one folder: what one is deriving, the other waits for and takes over.
#
# One hidden file in the folder is locked at one place for each description.  The system forgets the locks of a process
# that has ended, however it did.  Where there are no such locks, both derive; files are delivered whole all the same.


#: The file; nothing is ever written into it.
NAME = ".mbsym-lock"


class Locks:
    """Those that this process has in one folder.  No two threads may use them."""

    def __init__(self, folder: Path) -> None:
        self._file = folder / NAME
        self._handle: int | None = None

    def take(self, name: str) -> bool:
        """Whether it is ours now; false while another process has it."""
        try:
            import fcntl
        except ImportError:
            return True
        try:
            if self._handle is None:
                self._file.parent.mkdir(parents=True, exist_ok=True)
                self._handle = os.open(self._file, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
            fcntl.lockf(self._handle, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, _place(name))
        except (BlockingIOError, PermissionError):  # the two ways in which systems say that another one has it
            return False
        except OSError:  # no locks on this file system, or no room for the file: writing will tell
            return True
        return True

    def leave(self, name: str) -> None:
        if self._handle is not None:
            import fcntl

            with suppress(OSError):
                fcntl.lockf(self._handle, fcntl.LOCK_UN, 1, _place(name))


def _place(name: str) -> int:
    """A place of its own in the file, below 2^62, which is more than a file can be long."""
    return int.from_bytes(hashlib.sha256(name.encode(errors="surrogateescape")).digest()[:8], "big") >> 2
