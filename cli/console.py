"""What the commands share: reading descriptions, printing complaints, the two consoles, exit codes."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from mbsym.source import load, render

if TYPE_CHECKING:
    from rich.console import Console

    from mbsym.model.system import System

#: Exit codes: everything held; a result failed its self-check, or is missing; the input is wrong.
OK, FAILED, BAD_INPUT = 0, 1, 2

#: A simulation ended early and what it had was kept; the user stopped it (as shells count the signal).
BROKEN_DOWN, INTERRUPTED = 3, 130


@cache
def console(stderr: bool = False) -> Console:
    """rich's console; plain text where the output is no terminal."""
    from rich.console import Console

    terminal = (sys.stderr if stderr else sys.stdout).isatty()
    return Console(stderr=stderr, highlight=False, soft_wrap=not terminal, width=None if terminal else 120)


@contextmanager
def status(quiet: bool, text: str = "") -> Iterator[Callable[[str], None]]:
    """A spinner on standard error that says what is being done; nothing where it is no terminal."""
    if quiet or not sys.stderr.isatty():
        yield lambda text: None
        return
    with console(stderr=True).status(text) as spinner:
        yield lambda text: spinner.update(text)


def read_description(path: Path) -> System | None:
    """The system of a file, or None after printing every complaint on standard error."""
    system, complaints, text = load(path)
    for complaint in complaints.sorted():
        print(render(complaint, text, str(path)), file=sys.stderr)
    errors = len(complaints.errors)
    if errors:
        print(f"{path}: {counted(errors, 'error', 'errors')}; nothing was written.", file=sys.stderr)
    return system


def counted(n: int, one: str, many: str) -> str:
    """``1 body``, ``4 bodies``."""
    return f"{n} {one if n == 1 else many}"
