"""``mbsym integrals``: all polynomial first integrals up to a weighted degree."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from mbsym_cli.console import BAD_INPUT, FAILED, OK, complain, read_description, status
from mbsym_cli.integrals_request import complain_unfit, read_request
from mbsym_cli.options import Options


@click.command("integrals")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--degree", "-d", default="4", metavar="N", show_default=True, help="Up to this weighted degree.")
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Put in a number; repeatable.")
@click.option(
    "--weight", "-w", "weights", multiple=True, metavar="NAME=N", help="Weight of a variable, or unit vector."
)
@click.option("--vary", "-v", metavar="NAME=LOW:HIGH", help="At which values of a parameter are there more?")
@click.option("--cases", is_flag=True, help="Under which conditions on parameters are there more?")
@click.option("--budget", metavar="S", help="Counted work, worth some S seconds, that --cases may take.  [default: 60]")
@click.option("--relations", is_flag=True, help="Invariant relations f = 0, and integrals where another one is zero.")
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
    A weighted degree counts each variable with its weight: rates, sines, cosines and lengths with 1, speeds and unit
    vectors with those under which the equations are quasi-homogeneous where there are such, otherwise 1 and 2;
    --weight gives others.  Positions that the equations do not contain are no variables, which is said.

    --vary finds every value of one parameter in an interval at which there are more, also those that hold only where
    another integral is zero; other parameters need numbers.  --cases looks for conditions on the parameters: zeros,
    equalities and a polynomial condition besides, also of gyrostats; families of parameters that the --budget leaves
    out are counted.  --relations lists polynomials f that divide their derivative, so that a motion which begins on
    f = 0 stays there: linear forms, each with the parameters at which there is such a form, and those up to the degree
    for almost all parameters; and integrals that hold only where another one is zero.  --vary and --relations together
    find the values at which there are more polynomials f.

    Exit codes: 0 found, or proved that there are none; 1 undecided, or the equations are not polynomial; 2 something is
    wrong.

    \b
    Examples:
      mbsym integrals systems/clebsch-poisson.yaml
      mbsym integrals systems/gyrostat-poisson.yaml --degree 6 --set lx=0 --set epsilon=0
      mbsym integrals systems/euler-poisson.yaml -s B=2 -s C=1 -s x0=1 -s y0=0 -s z0=0 -s m=1 -s g=1 --vary A=1:5
      mbsym integrals systems/euler-poisson.yaml --set y0=0 --cases --budget 30
      mbsym integrals systems/euler-poisson.yaml --set y0=0 --relations
      mbsym integrals systems/goryachev-chaplygin.yaml --relations
      mbsym integrals euler-poisson.yaml -d 1 -s A=6 -s C=3 -s x0=1 -s y0=0 -s z0=1 -s m=1 -s g=1 -v B=1:5 --relations
    """
    system = read_description(file, unconstrained="integrals", moving="integrals")
    asked = Options()
    request = read_request(system, asked, degree, settings, weights, vary, cases, budget)
    if asked.refused(None if system is None else file) or system is None or request is None:
        sys.exit(BAD_INPUT)
    from mbsym.algebra.failures import Failure, Limit
    from mbsym.analysis import Analysis
    from mbsym.analysis.invariant_relations import invariant_relations, special_relations
    from mbsym.analysis.polynomial import allowed, integrals_of, setting
    from mbsym.problems.polynomial_integrals import along_of, cases_of

    try:
        with status(as_json, f"{file.name}: polynomial integrals"):
            analysis = Analysis(system)
            there = setting(analysis, request.values)
            complain_unfit(there, request, asked)
            if asked.refused(file):
                sys.exit(BAD_INPUT)
            found = integrals_of(there, request.degree, request.weights)
            axis = request.axis
            line = None if axis is None else along_of(found, there.kinds, there.known, axis.low, axis.high)
            positive = [one.name for one in system.parameters if one.sign == "positive"]
            special = cases_of(found, there.kinds, there.known, positive, request.budget) if cases else None
            special = special and allowed(analysis, there, request.values, special)
            invariant = invariant_relations(there, found, positive) if relations else None
            at = special_relations(there, found, axis.low, axis.high) if relations and axis is not None else None
    except ZeroDivisionError as reason:
        complain(file, f"no integrals: {reason}")
        sys.exit(BAD_INPUT)
    except Failure as reason:
        complain(file, f"no integrals: {reason}" + (f"; {reason.remedy}" if reason.limit is Limit.DEGREE else ""))
        sys.exit(BAD_INPUT if reason.limit is Limit.DEGREE else FAILED)
    if as_json:
        from mbsym.report.integrals_json import integrals_json

        click.echo(integrals_json(system, request.values, there, found, line, special, invariant, at), nl=False)
    else:
        from mbsym_cli.integrals_shown import Further, show

        show(file, system.name, there, found, Further(line, special, invariant, at))
    sys.exit(OK if found.complete else FAILED)
