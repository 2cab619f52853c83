"""What commands that study one motion have in common: what keeps them from beginning, what may end them.

``orbit``, ``floquet``, ``lyapunov`` and the ensembles and derivatives of ``simulate`` read their own options and have
their own words; files, failures and Ctrl-C are told alike.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NoReturn, TypeVar

from mbsym_cli.console import BAD_INPUT, FAILED, INTERRUPTED, OK, complain, reason_of
from mbsym_cli.files import obstacle
from mbsym_cli.options import Options

Found = TypeVar("Found")


def leave(file: Path, command: Callable[[], int]) -> NoReturn:
    """Ends the process with the command's exit code, or with that of Ctrl-C, which leaves nothing written."""
    try:
        sys.exit(command())
    except KeyboardInterrupt:
        complain(file, "interrupted; nothing was written")
        sys.exit(INTERRUPTED)


def prevented(file: Path, folder: Path, read: bool, asked: Options) -> int:
    """The exit code where options are wrong (``read``: the description is not) or nothing can be written; else 0."""
    if asked.refused(file if read else None) or not read:
        return BAD_INPUT
    reason = obstacle(folder)
    if reason:
        complain(file, f"the results cannot be written: {reason}")
        return FAILED
    return OK


def attempted(
    file: Path,
    work: Callable[[], Found],
    expected: Mapping[type[Exception], str] | None = None,
    equations: str = "these equations",
    results: str = "results",
) -> Found | None:
    """What ``work`` finds and writes; None where it fails, and a word about why.

    ``expected`` are failures of its own, with what to say before their message.
    """
    from mbsym.algebra.failures import Failure

    own = dict(expected or {})
    try:
        return work()
    except tuple(own) as error:
        before = next(text for kind, text in own.items() if isinstance(error, kind))
        complain(file, f"{before}: {error}")
    except Failure as error:
        complain(file, f"error[no-program]: there is no program for {equations}: {error}")
    except OSError as error:
        complain(file, f"the {results} cannot be written: {reason_of(error)}")
    return None
