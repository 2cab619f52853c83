"""``mbsym convert``: YAML to the editor's plain text and back."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from mbsym.source import to_text, to_yaml
from mbsym_cli.console import BAD_INPUT, read_description
from mbsym_cli.files import write_whole
from mbsym_cli.options import Options


@click.command("convert")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--to", "spelling", type=click.Choice(["yaml", "text"]), help="Default: the other spelling.")
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), help="Default: standard output.")
def command(file: Path, spelling: str | None, out: Path | None) -> None:
    """Convert a description between YAML and the editor's plain text, without loss.

    Comments are not kept; everything that has a meaning is.

    \b
    Example:
      mbsym convert systems/satellite.yaml --out satellite.txt
    """
    asked = Options()
    if out is not None and out.exists() and file.exists() and out.samefile(file):
        asked.complain("--out", "same-file", f"{out} would replace what it is made of", "comments would be lost")
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
        click.echo(text, nl=False)
        return
    try:
        write_whole(out, text)
    except OSError as error:
        click.echo(f"{out}: cannot be written: {error.strerror}", err=True)
        sys.exit(BAD_INPUT)
