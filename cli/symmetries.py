"""``mbsym symmetries``: hidden cyclic coordinates and rotations, and their integrals."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mbsym_cli.console import BAD_INPUT, FAILED, OK, complain, read_description, status
from mbsym_cli.options import Options
from mbsym_cli.section_options import read_settings

if TYPE_CHECKING:
    from mbsym.problems.symmetries import Symmetries


@click.command("symmetries")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Put in a number; repeatable.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of a table.")
def command(file: Path, settings: tuple[str, ...], as_json: bool) -> None:
    """Find the symmetries of FILE that its coordinates hide, and their first integrals (Noether).

    Looked for are all fields of degree one in the positions, with a shift of time, that leave the Lagrangian unchanged
    but for the time derivative of a polynomial of degree two in the positions, fields and polynomial free of the time:
    directions are generalised coordinates, or the speeds that FILE declares (then a
    body turning about an axis in itself is one).  Forces without a force function take part.  Parameters stay symbols,
    so that what is said holds for almost all their values; --set puts in exact numbers, where there may be more.

    Each integral is told apart from those of problem 7; dI/dt is formed by substitution once more.

    Exit codes: 0 all of this kind were found, proved; 1 not proved that these are all; 2 something is wrong.

    \b
    Examples:
      mbsym symmetries systems/spherical-pendulum.yaml
      mbsym symmetries systems/euler-poisson.yaml --set A=2 --set B=2 --set x0=0 --set y0=0
      mbsym symmetries systems/cart-pendulum.yaml --json
    """
    system = read_description(file, unconstrained="symmetries")
    asked = Options()
    values = {} if system is None else read_settings(settings, system, asked)
    if asked.refused(None if system is None else file) or system is None:
        sys.exit(BAD_INPUT)
    from mbsym.algebra.failures import Failure, SingularPoint
    from mbsym.analysis import Analysis
    from mbsym.analysis.symmetric import symmetries_of

    try:
        with status(as_json, f"{file.name}: symmetries"):
            found = symmetries_of(Analysis(system), values)
    except SingularPoint as reason:
        complain(file, f"no symmetries: {reason}")
        sys.exit(BAD_INPUT)
    except Failure as reason:
        complain(file, f"no symmetries: {reason}")
        sys.exit(FAILED)
    if as_json:
        from mbsym.report.symmetries_json import symmetries_json

        click.echo(symmetries_json(system, values, found), nl=False)
    else:
        _show(file, system.name, found)
    sys.exit(OK if found.complete else FAILED)


def _show(file: Path, name: str, found: Symmetries) -> None:
    from rich.text import Text

    from mbsym.report.content import Said
    from mbsym.report.plain_writer import Writer
    from mbsym.report.words.symmetry_words import HEADING, field_text, second_route, sentences, title
    from mbsym_cli.console import console, printable

    out = console()
    out.print(Text.assemble((name, "bold"), (f"  {printable(file)}", "dim")))
    out.print(Text.assemble("  ", (Writer().said(Said(HEADING)), "bold cyan")))
    for one in found.symmetries:
        out.print(Text.assemble("    field  ", (field_text(one), "bold" if one.is_new else "")), soft_wrap=True)
        out.print(Text(f"      {one.integral}"), soft_wrap=True)
        out.print(Text(f"      {title(one)}"))
        out.print(Text(f"      {second_route(one)}"))
    for text in map(Writer().said, sentences(found)):
        out.print(Text(f"    {text}"))
