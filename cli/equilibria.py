"""``mbsym equilibria``: all relative equilibria of a system at numbers, each with its stability."""

from __future__ import annotations

import sys
import time
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mbsym_cli.assignments import assignments, contradictions
from mbsym_cli.console import BAD_INPUT, FAILED, OK, complain, status
from mbsym_cli.lacking import missing
from mbsym_cli.options import Options
from mbsym_cli.simulation_inputs import read_held

if TYPE_CHECKING:
    from mbsym.model.system import System


@click.command("equilibria")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Replace a value; repeatable.")
@click.option(
    "--within",
    default="10",
    metavar="X",
    show_default=True,
    help="Where lengths are looked for, if not solved exactly.",
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of a table.")
def command(file: Path, settings: tuple[str, ...], within: str, as_json: bool) -> None:
    """List all relative equilibria of FILE: constant coordinates, steady turns as given, prescribed motions running.

    Needs a number for every parameter, from the description (values:) or from --set, taken exactly.  Where the
    equations are polynomials in sines and cosines the solution is exact; elsewhere each equilibrium is proved to exist
    in a small box.  The list says whether it is complete.  Orientations behind the singularity of the description's
    angles are found with other angles.  Each equilibrium is judged as in problem 6.

    Exit codes: 0 listed, 1 they cannot be listed (the reason is given), 2 something is missing or wrong,
    130 interrupted.

    \b
    Examples:
      mbsym equilibria systems/gravity-gradient.yaml
      mbsym equilibria systems/double-pendulum.yaml --set m2=3/2 --json
    """
    system = read_held(file, "equilibria")
    asked = Options()
    values = {} if system is None else _values(file, system, settings, asked)
    reach = asked.number("--within", within, most=1e6)
    if asked.refused(None if system is None else file) or system is None or reach is None:
        sys.exit(BAD_INPUT)
    from mbsym.algebra.failures import Failure
    from mbsym.analysis import Analysis
    from mbsym.problems.equilibria import equilibria

    started = time.perf_counter()
    try:
        with status(False, f"{file.name}: relative equilibria"):
            found = equilibria(system, values, reach)
            withdrawn = Analysis(system, ()).broken(Analysis.equilibria.stands_on)
        if withdrawn is not None:
            complain(file, f"no equilibria listed: {withdrawn.reason}")
            sys.exit(FAILED)
    except Failure as reason:
        complain(file, f"no equilibria listed: {reason}")
        sys.exit(FAILED)
    if as_json:
        from mbsym.report.equilibria_json import equilibria_json

        click.echo(equilibria_json(system, values, found), nl=False)
    else:
        from mbsym_cli.equilibria_table import show_equilibria

        show_equilibria(system, found, file, time.perf_counter() - started)
    sys.exit(OK)


def _values(file: Path, system: System, settings: tuple[str, ...], asked: Options) -> dict[str, Fraction]:
    """Exact numbers of the parameters; every complaint joins those of ``asked``."""
    from mbsym.expressions.tree import substitute
    from mbsym.mechanics.rest import given_values, missing_values
    from mbsym.model.system import rational
    from mbsym.numerics.scenario import Incomplete, Lack, scenario

    assigned = assignments(settings, system, asked)
    known = {item.name: item.value for item in system.parameters if item.value is not None} | dict(assigned.values)
    overrides: dict[str, Fraction] = {}
    for name, expression in assigned.values.items():
        if name not in system.parameter_names:
            hint = "set parameters only"
            assigned.complain(name, "misplaced-name", "equilibria are what is looked for", asked, hint)
            continue
        value = rational(substitute(expression, {k: v for k, v in known.items() if k != name}))
        if value is None:
            hint = f"write for example {name}=3/2"
            assigned.complain(name, "not-rational", "an exact rational number is needed", asked, hint)
        else:
            overrides[name] = value
    try:
        scenario(system, {name: assigned.values[name] for name in overrides}, state=False)
    except Incomplete as error:
        of_settings = tuple(one for one in error.lack.contradictions if one.name in assigned.texts)
        contradictions(file, Lack((), of_settings), assigned, asked)
    values = given_values(system, overrides)
    names = [name for name in missing_values(system, values) if name not in assigned.texts]
    if names:
        asked.complaints.append(missing(file, names, "number"))
    return values
