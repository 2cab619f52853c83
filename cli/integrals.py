"""``mbsym integrals``: all polynomial first integrals up to a weighted degree."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mbsym_cli.console import BAD_INPUT, FAILED, OK, complain, read_description, status
from mbsym_cli.options import Options
from mbsym_cli.section_options import read_settings

if TYPE_CHECKING:
    from mbsym.analysis.polynomial import Setting
    from mbsym.problems.polynomial_integrals import PolynomialIntegrals

#: More than any budget of monomials allows.
MOST_DEGREE = 60
MOST_WEIGHT = 12


@click.command("integrals")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--degree", "-d", default="4", metavar="N", show_default=True, help="Up to this weighted degree.")
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Put in a number; repeatable.")
@click.option(
    "--weight", "-w", "weights", multiple=True, metavar="NAME=N", help="Weight of a variable, or unit vector."
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of a table.")
def command(file: Path, degree: str, settings: tuple[str, ...], weights: tuple[str, ...], as_json: bool) -> None:
    """Find all polynomial first integrals of FILE up to a weighted degree, or prove that there are no others.

    FILE has its equations in speeds and unit vectors (keys 'speeds' and 'orientation').  Parameters stay symbols, so
    that what is said holds for almost all their values; --set puts in exact numbers, where there may be more.
    A weighted degree counts each variable with its weight: those under which the equations are quasi-homogeneous where
    there are such, otherwise 1 for speeds and 2 for the rest.

    Exit codes: 0 found, or proved that there are none; 1 undecided, or the equations are not polynomial; 2 something is
    wrong.

    \b
    Examples:
      mbsym integrals systems/clebsch-poisson.yaml
      mbsym integrals systems/gyrostat-poisson.yaml --degree 6 --set lx=0 --set epsilon=0
    """
    system = read_description(file, unconstrained="integrals", moving="integrals")
    asked = Options()
    most = asked.whole("--degree", degree, 1, MOST_DEGREE)
    values = {} if system is None else read_settings(settings, system, asked)
    given = _weights(weights, asked)
    if asked.refused(None if system is None else file) or system is None or most is None:
        sys.exit(BAD_INPUT)
    from mbsym.algebra.failures import Failure, Limit
    from mbsym.analysis import Analysis
    from mbsym.analysis.polynomial import integrals_of, setting

    try:
        with status(as_json, f"{file.name}: polynomial integrals"):
            there = setting(Analysis(system), values)
            unknown = [name for name in given if name not in there.field.variables]
            for name in unknown:
                known = ", ".join(there.field.variables)
                asked.complain("--weight", "unknown-name", f"the field has no variable {name}", f"there are {known}")
            if asked.refused(file):
                sys.exit(BAD_INPUT)
            found = integrals_of(there, most, given)
    except ZeroDivisionError as reason:
        complain(file, f"no integrals: {reason}")
        sys.exit(BAD_INPUT)
    except Failure as reason:
        complain(file, f"no integrals: {reason}" + (f"; {reason.remedy}" if reason.remedy else ""))
        sys.exit(BAD_INPUT if reason.limit is Limit.DEGREE else FAILED)
    if as_json:
        from mbsym.report.integrals_json import integrals_json

        click.echo(integrals_json(system, values, there, found), nl=False)
    else:
        _show(file, system.name, there, found)
    sys.exit(OK if found.complete else FAILED)


def _weights(texts: tuple[str, ...], asked: Options) -> dict[str, int]:
    found: dict[str, int] = {}
    for text in texts:
        name, equals, right = (part.strip() for part in text.partition("="))
        if not equals or not name.isidentifier():
            asked.complain("--weight", "bad-assignment", "a variable and its weight are wanted", "for example gamma1=2")
            continue
        weight = asked.whole("--weight", right, 1, MOST_WEIGHT)
        if weight is not None:
            found[name] = weight
    return found


def _show(file: Path, name: str, there: Setting, found: PolynomialIntegrals) -> None:
    from rich.text import Text

    from mbsym.report.integrals_words import HEADING, sentences, title, weights
    from mbsym.report.said import filled
    from mbsym_cli.console import console, printable

    out = console()
    out.print(Text.assemble((name, "bold"), (f"  {printable(file)}", "dim")))
    uniform = "quasi-homogeneous" if found.grading.homogeneous else "not quasi-homogeneous"
    out.print(Text(f"  weights {weights(found)}; the equations are {uniform} under them"))
    out.print(Text.assemble("  ", (filled((HEADING, {"degree": found.degree})), "bold cyan")))
    for one in found.generators:
        out.print(Text.assemble(f"    weight {one.weight}  ", (title(one), "bold" if one.is_new else "")))
        out.print(Text(f"      {there.formula(one.polynomial)}"), soft_wrap=True)
    for said in sentences(found):
        out.print(Text(f"    {filled(said)}"))
