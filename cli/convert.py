"""``mbsym convert``: YAML to the editor's plain text and back."""

from __future__ import annotations

import sys
from contextlib import suppress
from pathlib import Path

import click

from mbsym.source import to_text, to_yaml
from mbsym_cli.console import BAD_INPUT, FAILED, OutPath, complain, printable, read_description
from mbsym_cli.files import write_whole
from mbsym_cli.options import Options


@click.command("convert")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--to", "spelling", type=click.Choice(["yaml", "text"]), help="Default: the other spelling.")
@click.option("--out", type=OutPath(path_type=Path, dir_okay=False), help="Default: standard output.")
def command(file: Path, spelling: str | None, out: Path | None) -> None:
    """Convert a description between YAML and the editor's plain text, without loss.

    Comments are not kept; everything that has a meaning is.

    \b
    Example:
      mbsym convert systems/satellite.yaml --out satellite.txt
    """
    asked = Options()
    if out is not None and _same(out, file):
        asked.complain(
            "--out", "same-file", f"{printable(out)} would replace what it is made of", "comments would be lost"
        )
    if asked.refused(file):
        sys.exit(BAD_INPUT)
    system = read_description(file)
    if system is None:
        sys.exit(BAD_INPUT)
    if spelling is None:
        wanted = out.suffix if out is not None else (".yaml" if file.suffix == ".txt" else ".txt")
        spelling = "text" if wanted == ".txt" else "yaml"
    text = to_text(system) if spelling == "text" else to_yaml(system)
    if out is None:
        click.echo(text.encode(), nl=False)  # a description is UTF-8, whatever the terminal is
        return
    try:
        write_whole(out, text)
    except OSError as error:
        complain(out, f"cannot be written: {error.strerror}")
        sys.exit(FAILED)


def _same(one: Path, other: Path) -> bool:
    with suppress(OSError, ValueError):
        return one.samefile(other)
    return False
