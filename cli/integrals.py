"""``mbsym integrals``: all polynomial first integrals up to a weighted degree."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mbsym_cli.console import BAD_INPUT, FAILED, OK, complain, read_description, status
from mbsym_cli.options import Options
from mbsym_cli.section_options import read_axis, read_settings

if TYPE_CHECKING:
    from mbsym.analysis.polynomial import Setting
    from mbsym.maps.section import Axis
    from mbsym.problems.polynomial_integrals import Along, Cases, PolynomialIntegrals, Relations

#: More than any budget of monomials allows.
MOST_DEGREE = 60
MOST_WEIGHT = 12
#: Seconds for ``--cases``.
BUDGET = 60.0


@click.command("integrals")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--degree", "-d", default="4", metavar="N", show_default=True, help="Up to this weighted degree.")
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Put in a number; repeatable.")
@click.option(
    "--weight", "-w", "weights", multiple=True, metavar="NAME=N", help="Weight of a variable, or unit vector."
)
@click.option("--vary", "-v", metavar="NAME=LOW:HIGH", help="At which values of a parameter are there more?")
@click.option("--cases", is_flag=True, help="Under which conditions on parameters are there more?")
@click.option("--budget", metavar="S", help="Seconds after which --cases begins nothing more.  [default: 60]")
@click.option("--relations", is_flag=True, help="Linear invariant relations, with their conditions.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of a table.")
def command(
    file: Path,
    degree: str,
    settings: tuple[str, ...],
    weights: tuple[str, ...],
    vary: str | None,
    cases: bool,
    budget: str | None,
    relations: bool,
    as_json: bool,
) -> None:
    """Find all polynomial first integrals of FILE up to a weighted degree, or prove that there are no others.

    Variables are speeds and unit vectors where FILE declares them (keys 'speeds' and 'orientation'), otherwise rates,
    sines and cosines of angles, and lengths.  Parameters stay symbols, so
    that what is said holds for almost all their values; --set puts in exact numbers, where there may be more.
    A weighted degree counts each variable with its weight: those under which the equations are quasi-homogeneous where
    there are such, otherwise 1, but 2 for unit vectors.

    --vary finds every value of one parameter in an interval at which there are more, also those that hold only where
    another integral is zero; other parameters need numbers.  --cases looks for conditions on the parameters: zeros,
    equalities and a polynomial condition besides, also of gyrostats; families of parameters that the --budget leaves
    out are counted.  --relations lists linear forms f that divide their derivative, so that a motion which begins on
    f = 0 stays there, each with the parameters at which there is such a form.

    Exit codes: 0 found, or proved that there are none; 1 undecided, or the equations are not polynomial; 2 something is
    wrong.

    \b
    Examples:
      mbsym integrals systems/clebsch-poisson.yaml
      mbsym integrals systems/gyrostat-poisson.yaml --degree 6 --set lx=0 --set epsilon=0
      mbsym integrals systems/euler-poisson.yaml -s B=2 -s C=1 -s x0=1 -s y0=0 -s z0=0 -s m=1 -s g=1 --vary A=1:5
      mbsym integrals systems/euler-poisson.yaml --set y0=0 --cases --budget 30
      mbsym integrals systems/euler-poisson.yaml --set y0=0 --relations
    """
    system = read_description(file, unconstrained="integrals", moving="integrals")
    asked = Options()
    most = asked.whole("--degree", degree, 1, MOST_DEGREE)
    values = {} if system is None else read_settings(settings, system, asked)
    given = _weights(weights, asked)
    axis = None if vary is None or system is None else read_axis(vary, "--vary", system, asked)
    if vary is not None and cases:
        asked.complain("--cases", "not-together", "with --vary other parameters are numbers", "choose one of them")
    if axis is not None and axis.name in values:
        asked.complain("--set", "repeated-name", f"'{axis.name}' has an interval and a number", "leave one of them out")
    seconds = BUDGET if budget is None else asked.number("--budget", budget)
    if budget is not None and not cases:
        asked.complain("--budget", "missing-option", "--budget goes with --cases", "add --cases")
    if asked.refused(None if system is None else file) or system is None or most is None or seconds is None:
        sys.exit(BAD_INPUT)
    from mbsym.algebra.failures import Failure, Limit
    from mbsym.analysis import Analysis
    from mbsym.analysis.polynomial import integrals_of, setting
    from mbsym.problems.polynomial_integrals import along, cases_of, linear_relations

    try:
        with status(as_json, f"{file.name}: polynomial integrals"):
            there = setting(Analysis(system), values)
            unknown = [name for name in given if name not in there.field.variables]
            for name in unknown:
                known = ", ".join(there.field.variables)
                asked.complain("--weight", "unknown-name", f"the field has no variable {name}", f"there are {known}")
            _complain_unfit(there, axis, asked)
            if asked.refused(file):
                sys.exit(BAD_INPUT)
            found = integrals_of(there, most, given)
            line = None if axis is None else along(found, axis.low, axis.high)
            positive = [one.name for one in system.parameters if one.sign == "positive"]
            special = cases_of(found, there.kinds, there.known, positive, seconds) if cases else None
            grading, linear = found.grading, None
            if relations:
                linear = linear_relations(there.field, grading.weights, positive, grading.free)
    except ZeroDivisionError as reason:
        complain(file, f"no integrals: {reason}")
        sys.exit(BAD_INPUT)
    except Failure as reason:
        complain(file, f"no integrals: {reason}" + (f"; {reason.remedy}" if reason.limit is Limit.DEGREE else ""))
        sys.exit(BAD_INPUT if reason.limit is Limit.DEGREE else FAILED)
    if as_json:
        from mbsym.report.integrals_json import integrals_json

        click.echo(integrals_json(system, values, there, found, line, special, linear), nl=False)
    else:
        _show(file, system.name, there, found, (line, special, linear))
    sys.exit(OK if found.complete else FAILED)


def _weights(texts: tuple[str, ...], asked: Options) -> dict[str, int]:
    found: dict[str, int] = {}
    for text in texts:
        name, equals, right = (part.strip() for part in text.partition("="))
        if not equals or not name:
            asked.complain("--weight", "bad-assignment", "a variable and its weight are wanted", "for example gamma1=2")
            continue
        weight = asked.whole("--weight", right, 1, MOST_WEIGHT)
        if weight is not None:
            found[name] = weight
    return found


def _complain_unfit(there: Setting, axis: Axis | None, asked: Options) -> None:
    """Of ``--vary``: a parameter that does not occur, or others without numbers."""
    if axis is None:
        return
    if axis.name not in there.field.parameters:
        asked.complain("--vary", "not-there", f"the equations do not depend on {axis.name}", "take another parameter")
    lacking = [name for name in there.field.parameters if name != axis.name]
    if lacking:
        example = " ".join(f"--set {name}=1" for name in lacking[:3]) + (" ..." if len(lacking) > 3 else "")
        asked.complain("--set", "missing-value", f"no number for {', '.join(lacking)}", f"for example {example}")


def _show(
    file: Path,
    name: str,
    there: Setting,
    found: PolynomialIntegrals,
    special: tuple[Along | None, Cases | None, Relations | None],
) -> None:
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
    from mbsym_cli.integrals_cases import along_lines, cases_lines, relation_lines

    line, cases, linear = special
    for heading, lines in (
        ("Special values", None if line is None else along_lines(there, line, found.degree)),
        ("Special cases", None if cases is None else cases_lines(there, cases)),
        ("Linear invariant relations", None if linear is None else relation_lines(there, linear)),
    ):
        if lines is not None:
            out.print(Text.assemble("  ", (heading, "bold cyan")))
            for text in lines:
                out.print(Text(f"    {text}"), soft_wrap=True)
