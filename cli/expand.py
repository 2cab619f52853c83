"""``mbsym expand``: the slow integral manifold of a system with a small parameter."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mbsym_cli.console import BAD_INPUT, FAILED, OK, complain, read_description, status
from mbsym_cli.options import Options
from mbsym_cli.section_options import read_settings

if TYPE_CHECKING:
    from mbsym.algebra.quotients import Series
    from mbsym.analysis.expanding import Expansion
    from mbsym.simulation.expanded import Measured

MOST_ORDER = 8


@click.command("expand")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--order", "-n", default="2", metavar="N", show_default=True, help="Up to this power.")
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Put in a number; repeatable.")
@click.option("--time", metavar="T", help="How long the motions are compared.  [default: found from the flow]")
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of a table.")
def command(file: Path, order: str, settings: tuple[str, ...], time: str | None, as_json: bool) -> None:
    """Expand the slow integral manifold of FILE in powers of its small parameter, exactly.

    FILE names the parameter ('small parameter: eps') and has its equations in speeds (key 'speeds').  Fast variables
    are found, or declared under that key.  The functions that express them by the slow ones, and the flow on the
    manifold, are found by comparing coefficients and put into the equations; about the unperturbed motion it is said
    whether the manifold attracts, and what the flow on it needs for asymptotic stability.  Where the description gives
    numbers and an initial state, the flow is compared with a simulation of all equations at eps, eps/2 and eps/4, and
    the order of its error is measured.

    Exit codes: 0 found and checked; 1 there is none, or none was found within the budget; 2 something is wrong.

    \b
    Examples:
      mbsym expand systems/satellite-with-damper-slow.yaml --order 3
      mbsym expand systems/satellite-with-damper-slow.yaml --set rho=0 --json
    """
    system = read_description(file, unconstrained="expand", moving="expand")
    asked = Options()
    most = asked.whole("--order", order, 1, MOST_ORDER)
    span = asked.number("--time", time, most=1e9)
    values = {} if system is None else read_settings(settings, system, asked)
    if system is not None:
        small = system.small
        if small is None:
            asked.complain(
                "FILE", "missing-key", "the description names no small parameter", "add 'small parameter: eps'"
            )
        for name in values if small is not None else ():
            if name == small.name or name in dict(small.powers):
                asked.complain("--set", "bad-assignment", f"{name} belongs to the small parameter: it stays a symbol")
    if asked.refused(None if system is None else file) or system is None or most is None:
        sys.exit(BAD_INPUT)
    from mbsym.algebra.failures import Failure
    from mbsym.analysis import Analysis
    from mbsym.analysis.expanding import expansion

    try:
        with status(as_json, f"{file.name}: slow manifold"):
            found = expansion(Analysis(system), most, values)
    except ZeroDivisionError as reason:
        complain(file, f"no expansion: {reason}")
        sys.exit(BAD_INPUT)
    except Failure as reason:
        complain(file, f"no expansion: {reason}" + (f"; {reason.remedy}" if reason.remedy else ""))
        sys.exit(FAILED)
    from mbsym.report.words.expansion_measured import measured_or_why

    with status(as_json, f"{file.name}: measuring"):
        told = measured_or_why(system, found, span, values)
    if as_json:
        from mbsym.report.expansion_json import expansion_json

        click.echo(expansion_json(system, values, found, told), nl=False)
    else:
        _show(file, system.name, found, told)
    sys.exit(OK)


MANIFOLD = "Slow integral manifold up to order [[order]] of [[small]]"
FLOW = "The flow on it, up to order [[order]]"


def _show(file: Path, name: str, found: Expansion, told: Measured | str) -> None:
    from rich.text import Text

    from mbsym.report.content import say
    from mbsym.report.plain_writer import Writer
    from mbsym.report.words.expansion_words import of_measured, sentences
    from mbsym_cli.console import console, printable

    out, write = console(), Writer()
    manifold = found.manifold
    small = manifold.field.small
    out.print(Text.assemble((name, "bold"), (f"  {printable(file)}", "dim")))
    for parameter, power in manifold.field.powers:
        out.print(Text(f"  {parameter} stands for {parameter} {small}^{power}"))
    for heading, names, series, mark in (
        (say(MANIFOLD, order=str(manifold.order), small=small), manifold.fast, manifold.functions, ""),
        (say(FLOW, order=str(manifold.order)), manifold.slow, manifold.flow, "'"),
    ):
        out.print(Text.assemble("  ", (write.said(heading), "bold cyan")))
        for variable, one in zip(names, series, strict=True):
            out.print(Text(f"    {variable}{mark} ="))
            for line in _lines(found, small, one):
                out.print(Text(f"      {line}"), soft_wrap=True)
    for said in (*sentences(found), *of_measured(small, told)):
        out.print(Text(f"    {write.said(said)}"))


def _lines(found: Expansion, small: str, one: Series) -> list[str]:
    lines: list[str] = []
    for k in sorted(one.coefficients):
        factor = "" if k == 0 else f"{small} " if k == 1 else f"{small}^{k} "
        lines.append(f"{'+ ' if lines else ''}{factor}({found.formula(one.coefficients[k])})")
    return lines or ["0"]
