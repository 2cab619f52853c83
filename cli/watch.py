"""``mbsym watch``: derives a description again whenever it is saved.

No study: it calls ``mbsym run`` again and again, each time in a process of its own.
"""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from mbsym.studies import run
from mbsym.studies.request import fields_of, words_typed
from mbsym.studies.study import Exit
from mbsym_cli.console import OutPath, complain
from mbsym_cli.requests import option_of

#: Seconds between two looks at the file, and after which a file that is being saved has settled.
PERIOD = 0.2

Stamp = tuple[int, int]


@click.command("watch")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("-o", "--out", type=OutPath(path_type=Path), help="As for run.")
@click.option("--simulate", "seconds", metavar="T", help="Simulate from 0 to T as well.")
@click.pass_context
def command(context: click.Context, file: Path, out: Path | None, seconds: str | None, **texts: Any) -> None:
    """Derive FILE as run does, with its options, now and whenever it is saved; Ctrl-C ends it.

    A derivation that is under way when the file changes is given up and begun again.

    \b
    Examples:
      mbsym watch pendulum.yaml
      mbsym watch pendulum.yaml --format html --brief
    """
    if not file.is_file():
        complain(file, "there is no such file")
        sys.exit(Exit.BAD_INPUT)
    typed = {x: y for x, y in texts.items() if context.get_parameter_source(x) is ParameterSource.COMMANDLINE}
    typed |= {} if out is None else {"out": out}
    commands = [["run", str(file), *words_typed(run.Command, typed)]]
    if seconds is not None:
        commands.append(["simulate", str(file), "--time", seconds])
    try:
        _watch(file, commands)
    except KeyboardInterrupt:
        sys.exit(Exit.INTERRUPTED)


command.params[1:1] = [option_of(field) for field in fields_of(run.Command)]


def _watch(file: Path, commands: list[list[str]]) -> None:
    """Endless; each round ends when the file has changed since it began."""
    while True:
        stamp = _settled(file)
        changed = any(_ran(file, stamp, command) for command in commands)
        if not changed:
            complain(file, "waiting for changes; Ctrl-C ends")
        while _stamp(file) in (stamp, None):
            time.sleep(PERIOD)


def _ran(file: Path, stamp: Stamp, command: list[str]) -> bool:
    """Runs one command to its end, or until the file changes: whether it did."""
    child = subprocess.Popen([sys.executable, "-m", "mbsym_cli", *command])
    try:
        while child.poll() is None:
            if _stamp(file) not in (stamp, None):
                return True
            time.sleep(PERIOD / 4)
    finally:
        if child.poll() is None:
            child.terminate()
            child.wait()
    return False


def _stamp(file: Path) -> Stamp | None:
    """When a file was written and how long it is; None while an editor exchanges it."""
    try:
        status = file.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size


def _settled(file: Path) -> Stamp:
    """The stamp of a file that has not changed for a moment."""
    last = _stamp(file)
    while True:
        time.sleep(PERIOD / 2)
        now = _stamp(file)
        if now is not None and now == last:
            return now
        last = now
