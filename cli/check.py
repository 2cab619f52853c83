"""``mbsym check``: validates descriptions without deriving anything."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from mbsym_cli.console import BAD_INPUT, OK, counted, printable, read_description
from mbsym_cli.options import Options


@click.command("check")
@click.argument("files", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="FILE...")
def command(files: tuple[Path, ...]) -> None:
    """Validate descriptions, those in folders too, without deriving anything.

    Prints every complaint with its place; the exit code is 2 if there is an error.

    \b
    Example:
      mbsym check systems/*.yaml
    """
    asked = Options()
    paths = asked.descriptions(files)
    if asked.refused():
        sys.exit(BAD_INPUT)
    worst = OK
    for path in paths:
        system = read_description(path)
        if system is None:
            worst = BAD_INPUT
            continue
        bodies = counted(len(system.bodies), "body", "bodies")
        freedom = counted(len(system.coordinates), "degree of freedom", "degrees of freedom")
        print(f"{printable(path)}: ok: {system.name}; {bodies}, {freedom} ({', '.join(system.coordinates)})")
    sys.exit(worst)
