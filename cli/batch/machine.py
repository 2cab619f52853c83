"""What this machine has for a batch."""

from __future__ import annotations

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
