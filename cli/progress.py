"""What is being done, on standard error: words with a bar, or a bar over simulated time or whatever is counted."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from mbsym.studies.study import Watch, unwatched
from mbsym_cli.console import console, printable


@contextmanager
def progress(quiet: bool, name: str, end: float, what: str = "t") -> Iterator[Callable[[float], None]]:
    """On standard error; nothing where that is no terminal.  ``what`` is counted: the time, unless it is said."""
    if quiet or not sys.stderr.isatty():
        yield lambda t: None
        return
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    bar = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TextColumn(what + " = {task.completed:.4g}"),
        TimeRemainingColumn(),
        console=console(stderr=True),
        transient=True,
    )
    with bar:
        task = bar.add_task(name, total=end)
        shown = 0.0

        def watch(t: float) -> None:
            nonlocal shown
            now = time.monotonic()
            if now - shown > 0.05:
                shown = now
                bar.update(task, completed=t)

        yield watch


@contextmanager
def watching(quiet: bool, name: str) -> Iterator[Watch]:
    """What a study is doing, and a bar that fills where that is counted; nothing where there is no terminal."""
    if quiet or not sys.stderr.isatty():
        yield unwatched
        return
    from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    words = TextColumn("{task.description}", markup=False)
    bar = Progress(
        SpinnerColumn(), words, BarColumn(), TimeElapsedColumn(), console=console(stderr=True), transient=True
    )
    with bar:
        task = bar.add_task(printable(name), total=None)
        said, shown = "", 0.0

        def watch(text: str, done: float = 0.0, whole: float = 0.0) -> None:
            nonlocal said, shown
            now = time.monotonic()
            if text != said or now - shown > 0.05:
                said, shown = text, now
                told = f"{printable(name)}: {printable(text)}" if text else printable(name)
                bar.update(task, description=told, completed=done, total=whole or None)

        yield watch
