"""``mbsym check``: validates descriptions without deriving anything."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from mbsym.expressions.counting import counted
from mbsym_cli.console import BAD_INPUT, FAILED, OK, defect, printable, read_description
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
        try:
            worst = max(worst, _check(path))
        except Exception as error:  # a defect of ours must not cost the rest of the batch
            defect(error, path)
            worst = max(worst, FAILED)
    sys.exit(worst)


def _check(path: Path) -> int:
    system = read_description(path)
    if system is None:
        return BAD_INPUT
    bodies = counted(len(system.bodies), "body", "bodies")
    freedom = counted(len(system.coordinates), "degree of freedom", "degrees of freedom")
    print(f"{printable(path)}: ok: {system.name}; {bodies}, {freedom} ({', '.join(system.coordinates)})")
    return OK
