"""``mbsym examples``: lists the systems that come with mbsym, and copies them."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from mbsym.expressions.message import Message
from mbsym.source.examples import example_names
from mbsym.studies.study import Exit
from mbsym_cli.console import OutPath, among, complain, printable
from mbsym_cli.options import Options


@click.command("examples")
@click.argument("names", nargs=-1, metavar="[NAME]...", shell_complete=among(example_names))
@click.option("--all", "every", is_flag=True, help="Copy all of them.")
@click.option("-o", "--out", type=OutPath(path_type=Path), default=".", help="Folder to copy to.  [default: this one]")
def command(names: tuple[str, ...], every: bool, out: Path) -> None:
    """List the systems that come with mbsym; with NAMEs, copy their descriptions.

    A file that is there already is not replaced without --force.

    \b
    Examples:
      mbsym examples
      mbsym examples double-pendulum satellite --out systems
    """
    known = example_names()
    if not names and not every:
        _list(known)
        return
    options = Options()
    chosen = known if every else tuple(options.word("NAME", name, known, "example") for name in names)
    targets = {name: out / f"{name}.yaml" for name in chosen if name is not None}
    for path in targets.values():
        options.unwritten("NAME", path)
    if options.refused():
        sys.exit(Exit.BAD_INPUT)
    sys.exit(max([Exit.OK, *(_copy(name, path) for name, path in targets.items())]))


def _list(names: tuple[str, ...]) -> None:
    """Name, title and size of every example."""
    from mbsym.source import read
    from mbsym.source.examples import example_text

    width = max(map(len, names))
    for name in names:
        system, _ = read(example_text(name), f"{name}.yaml")
        assert system is not None
        freedom = len(system.coordinates)
        click.echo(f"{name:<{width}}  {freedom} degree{'s' if freedom > 1 else ' '} of freedom  {system.name}")
    click.echo("\ncopy one:  mbsym examples NAME      begin a new one:  mbsym new NAME --like EXAMPLE")


def _copy(name: str, path: Path) -> int:
    from mbsym.source.examples import example_text
    from mbsym_cli.files import write_whole

    try:
        write_whole(path, example_text(name))
    except OSError as error:
        complain(path, Message("cannot be written: [[why]]", why=error.strerror))
        return Exit.FAILED
    click.echo(printable(path))
    return Exit.OK
