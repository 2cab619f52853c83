"""The command as a process of its own: what the script ``mbsym`` and ``python -m mbsym_cli`` call."""

from __future__ import annotations

import atexit
import gc
import os
import sys
import threading

#: As shells count Ctrl-C; ``Exit.INTERRUPTED``, which is not there before everything is imported.
INTERRUPTED = 130


def command() -> None:
    """Runs the command that ``sys.argv`` names, and ends the process with its exit code."""
    # Modules and formulas are many small objects and hardly ever cycles: looking for those less often saves time.
    gc.set_threshold(1_000_000, 20, 20)
    # Matrices of mechanisms are small: threads of NumPy's BLAS wait for one another longer than they work.
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    try:
        from mbsym_cli.main import main

        main()
    except SystemExit as ended:
        if ended.code is None or isinstance(ended.code, int):
            _end(ended.code or 0)
        raise
    except KeyboardInterrupt:  # before the command began or after it ended: else it tells what has been written
        print("interrupted", file=sys.stderr)
        sys.exit(INTERRUPTED)


def _end(code: int) -> None:
    """Ends the process; returns where Python has to, because somebody is still at work or looks on.

    Everything is written by now.  What Python does besides is to take down hundreds of thousands of small objects one
    by one, for nobody: a seventh of the time of a usual run.
    """
    watched = sys.getprofile() is not None or sys.gettrace() is not None or sys.flags.interactive
    if watched or threading.active_count() > 1:
        return
    atexit._run_exitfuncs()
    try:
        for stream in (sys.stdout, sys.stderr, sys.__stdout__, sys.__stderr__):
            if stream is not None:
                stream.flush()
    except (OSError, ValueError):  # Python has its own words for that
        return
    os._exit(code & 0xFF)
