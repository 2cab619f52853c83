"""A bar over simulated time, or over whatever is counted."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from mbsym_cli.console import console


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
