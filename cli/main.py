"""The ``mbsym`` command: one file a sub-command; this one only lists them.

Sub-commands are imported when they are called, so that ``mbsym --help`` does not wait for the algebra.
"""

from __future__ import annotations

import gc
import importlib
import sys
from typing import Any

import click

import mbsym

#: As shells count the signal of Ctrl-C.
INTERRUPTED = 130

#: name -> module of this package that defines ``command``.
COMMANDS = {
    "run": "mbsym_cli.run",
    "simulate": "mbsym_cli.simulate",
    "tradeoff": "mbsym_cli.tradeoff",
    "extremes": "mbsym_cli.extremes",
    "equilibria": "mbsym_cli.equilibria",
    "check": "mbsym_cli.check",
    "convert": "mbsym_cli.convert",
    "schema": "mbsym_cli.schema",
    "explain": "mbsym_cli.explain",
}


class LazyGroup(click.Group):
    """A group whose commands are imported on demand."""

    def list_commands(self, context: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, context: click.Context, name: str) -> click.Command | None:
        if name not in COMMANDS:
            return None
        # Formulas are many small objects and hardly ever cycles: looking for those less often saves time.
        gc.set_threshold(200_000, 20, 20)
        command: click.Command = importlib.import_module(COMMANDS[name]).command
        return command

    def invoke(self, context: click.Context) -> Any:
        """Ctrl-C, wherever it comes, ends with the code that shells count the signal as."""
        try:
            return super().invoke(context)
        except KeyboardInterrupt:
            print("interrupted; what has been written is whole", file=sys.stderr)
            sys.exit(INTERRUPTED)


@click.group(cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(mbsym.__version__, prog_name="mbsym")
def main() -> None:
    """Exact symbolic mechanics of multibody systems from a text description.

    \b
    Example:
      mbsym run systems/satellite.yaml
    """
