"""What a shell may complete beside commands, options and files: names that only mbsym knows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import click

Names = Callable[[], Sequence[str]]


def among(names: Names) -> Callable[[click.Context, click.Parameter, str], Any]:
    """For ``shell_complete``: the names that begin as what was typed; they are looked up when a shell asks."""
    return lambda context, parameter, typed: [name for name in names() if name.startswith(typed)]


def examples() -> Sequence[str]:
    """The systems that come with mbsym."""
    from mbsym.source.examples import example_names

    return example_names()
