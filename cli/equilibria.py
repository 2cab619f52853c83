"""``mbsym equilibria``: all relative equilibria of a system at numbers, each with its stability."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mbsym_cli.assignments import assignments, contradictions
from mbsym_cli.console import BAD_INPUT, FAILED, OK, OutPath, complain, status
from mbsym_cli.files import folder_for
from mbsym_cli.lacking import missing
from mbsym_cli.options import Options
from mbsym_cli.simulation_inputs import read_held
from mbsym_cli.study import leave, prevented

if TYPE_CHECKING:
    from mbsym.mechanics.rest import Value
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
@click.option("--vary", metavar="NAME=LOW:HIGH", help="Branches over one parameter: counts, bifurcations, stability.")
@click.option(
    "--format", "formats", metavar="LIST", help="With --vary, files to write.  [default: svg,pdf,png,json,tex]"
)
@click.option("--language", metavar="NAME", help="With --vary, of picture and branches.tex: en, ru, es.")
@click.option(
    "--out", "-o", type=OutPath(path_type=Path, file_okay=False), help="With --vary, folder.  [default: reports/NAME]"
)
@click.option("--quiet", "-q", is_flag=True, help="With --vary, print nothing but complaints.")
def command(
    file: Path,
    settings: tuple[str, ...],
    within: str,
    as_json: bool,
    vary: str | None,
    formats: str | None,
    language: str | None,
    out: Path | None,
    quiet: bool,
) -> None:
    """List all relative equilibria of FILE: constant coordinates, steady turns as given, prescribed motions running.

    Needs a number for every parameter, from the description (values:) or from --set, taken exactly.  Where the
    equations are polynomials in sines and cosines the solution is exact; elsewhere each equilibrium is proved to exist
    in a small box.  The list says whether it is complete.  Orientations behind the singularity of the description's
    angles are found with other angles.  Each equilibrium is judged as in problem 6.  For a body about a fixed point the
    axes and rates of all permanent rotations are printed besides (Staude's cone).

    With --vary a parameter runs through an interval: how many equilibria there are between exact critical values,
    where branches fold, cross or split (named by exact derivatives), and how stable each is.  Written are branches.svg,
    branches.pdf, branches.png, branches.json and branches.tex (to \\input).

    Exit codes: 0 listed, 1 they cannot be listed (the reason is given), 2 something is missing or wrong,
    130 interrupted.

    \b
    Examples:
      mbsym equilibria systems/gravity-gradient.yaml
      mbsym equilibria systems/double-pendulum.yaml --set m2=3/2 --json
      mbsym equilibria systems/orbital-gyrostat.yaml --vary h=0:10
    """
    if vary is not None:
        leave(file, lambda: _branches(file, settings, as_json, vary, formats, language, folder_for(file, out), quiet))
    system = read_held(file, "equilibria")
    asked = Options()
    for option, given in (("--format", formats), ("--language", language), ("--out", out), ("--quiet", quiet)):
        if given:
            asked.complain(option, "needs-vary", "files are written of branches only", "add --vary NAME=LOW:HIGH")
    values = {} if system is None else _values(file, system, settings, asked)
    reach = asked.number("--within", within, most=1e6)
    if asked.refused(None if system is None else file) or system is None or reach is None:
        sys.exit(BAD_INPUT)
    from mbsym.algebra.failures import Failure
    from mbsym.analysis.resting import relative_equilibria
    from mbsym.problems.relative_equilibria.permanent_rotations import permanent_rotations

    started = time.perf_counter()
    try:
        with status(False, f"{file.name}: relative equilibria"):
            found = relative_equilibria(system, values, reach)
            permanent = permanent_rotations(system, values)
    except Failure as reason:
        complain(file, f"no equilibria listed: {reason}")
        sys.exit(FAILED)
    if as_json:
        from mbsym.report.maps.equilibria_json import equilibria_json

        click.echo(equilibria_json(system, values, found, permanent), nl=False)
    else:
        from mbsym_cli.equilibria_table import show_equilibria

        show_equilibria(system, found, file, time.perf_counter() - started, permanent)
    sys.exit(OK)


def _branches(
    file: Path,
    settings: tuple[str, ...],
    as_json: bool,
    vary: str,
    formats: str | None,
    language: str | None,
    folder: Path,
    quiet: bool,
) -> int:
    """Reads everything, complains about everything, then follows the branches; the exit code."""
    from mbsym.report.language import LANGUAGES
    from mbsym_cli.equilibria_branches import FORMATS, Request, read_varied, run

    system = read_held(file, "equilibria")
    asked = Options()
    if as_json:
        asked.complain("--json", "with-vary", "branches are written to a file", "use --format json")
    wanted = asked.words("--format", ",".join(FORMATS) if formats is None else formats, FORMATS, "format")
    spoken = "en" if language is None else language
    asked.word("--language", spoken, LANGUAGES, "language")
    axis = None if system is None else read_varied(vary, system, settings, asked)
    varied = "" if axis is None else axis.name
    values = {} if system is None else _values(file, system, settings, asked, varied)
    code = prevented(file, folder, system is not None, asked)
    if code or system is None or axis is None:
        return code or BAD_INPUT
    return run(Request(file, folder, system, axis, values, wanted, spoken, quiet))


def _values(
    file: Path, system: System, settings: tuple[str, ...], asked: Options, varied: str = ""
) -> dict[str, Value]:
    """Exact numbers of the parameters but ``varied``; every complaint joins those of ``asked``."""
    from mbsym.expressions.tree import names as names_in
    from mbsym.expressions.tree import substitute
    from mbsym.mechanics.rest import given_values, missing_values, rational_values
    from mbsym.model.system import rational
    from mbsym.numerics.scenario import Incomplete, Lack, scenario

    assigned = assignments(settings, system, asked)
    known = {item.name: item.value for item in system.parameters if item.value is not None} | dict(assigned.values)
    overrides: dict[str, Value] = {}
    for name, expression in assigned.values.items():
        if name not in system.parameter_names:
            hint = "set parameters only"
            assigned.complain(name, "misplaced-name", "equilibria are what is looked for", asked, hint)
            continue
        whole = substitute(expression, {k: v for k, v in known.items() if k != name})
        value = rational(whole)
        if value is not None:
            overrides[name] = value
        elif varied or names_in(whole):
            hint = f"write for example {name}=3/2"
            assigned.complain(name, "not-rational", "an exact rational number is needed", asked, hint)
        else:
            overrides[name] = whole
    try:
        scenario(system, {name: assigned.values[name] for name in overrides}, state=False)
    except Incomplete as error:
        of_settings = tuple(one for one in error.lack.contradictions if one.name in assigned.texts)
        contradictions(file, Lack((), of_settings), assigned, asked)
    values = given_values(system, overrides)
    if varied:  # the equations are eliminated over QQ
        values = dict(rational_values(values))
    names = [name for name in missing_values(system, values) if name not in assigned.texts and name != varied]
    if names:
        asked.complaints.append(missing(file, names, "rational number" if varied else "number"))
    return {name: value for name, value in values.items() if name != varied}
