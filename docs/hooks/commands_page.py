"""The end of the page on commands, from their own help texts."""

from __future__ import annotations

import click
from in_markdown import fenced

from mbsym_cli.main import COMMANDS, main

_HEAD = """\
## Every option

All that there is to say of each, as `mbsym explain COMMAND` prints it; `--help` tells what a screen holds.
[Completion of commands and options](../howto/editor.md#shell-completion) can be had for bash, zsh and fish.
"""


def tail() -> str:
    """It in Markdown."""
    parts = [_HEAD, fenced(_help(main, "mbsym"))]
    for name, listed in COMMANDS.items():
        parts += [
            f"### mbsym {name}\n",
            f"{listed.does}\n",
            fenced(_help(main.get_command(_context(), name), f"mbsym {name}")),
        ]
    return "\n".join(parts)


def _context() -> click.Context:
    return click.Context(main, info_name="mbsym", **main.context_settings, terminal_width=100)


def _help(command: click.Command, name: str) -> str:
    context = click.Context(command, info_name=name, **main.context_settings, terminal_width=100)
    return command.get_help(context)
