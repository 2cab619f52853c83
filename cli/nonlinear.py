"""``mbsym nonlinear``: what terms of higher order decide, at values or along one parameter."""

from __future__ import annotations

import sys
import time
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mbsym_cli.console import BAD_INPUT, FAILED, INTERRUPTED, OK, complain, read_description, status
from mbsym_cli.lacking import missing
from mbsym_cli.nonlinear_at import at_values, check_settings
from mbsym_cli.options import Options
from mbsym_cli.section_options import distinct, read_axis, read_settings

if TYPE_CHECKING:
    from mbsym.model.system import System


@click.command("nonlinear")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Replace a value; repeatable.")
@click.option("--vary", "-v", "axis", metavar="NAME=LOW:HIGH", help="The parameter, and its open interval.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON; without --vary that of problem 11.")
def command(file: Path, settings: tuple[str, ...], axis: str | None, as_json: bool) -> None:
    """List the values of a parameter at which terms of higher order of FILE decide otherwise than beside them.

    Without --vary: what they decide at the values, and in parameters where there are formulas.

    Between two of them one verdict holds.  Each is the root of a polynomial: a resonance of order 3 or 4 of two
    frequencies, a zero of Arnold's determinant D4, a border of the first approximation; with applied forces a border at
    which a pair of roots becomes imaginary (soft or hard, by Lyapunov's coefficient) or a root zero.  The theorems are
    those of problem 11 ('mbsym explain 11'), which 'mbsym run --problems 11' tells at the values of the description.

    Along a parameter every other one needs a rational number, from the description (values:) or from --set.

    Exit codes: 0 listed, 1 they cannot be listed (the reason is given), 2 something is missing or wrong,
    130 interrupted.

    \b
    Examples:
      mbsym nonlinear systems/three-bodies.yaml --set mu=1/50 --json
      mbsym nonlinear systems/three-bodies.yaml --vary mu=0:1/2
      mbsym nonlinear systems/ziegler-damped.yaml --vary P=0:10 --set b2=1/5 --json
    """
    system = read_description(file, unconstrained="nonlinear")
    asked = Options()
    axis_read, numbers = None, {}
    if system is not None:
        if axis is not None:
            axis_read = read_axis(axis, "--vary", system, asked)
        numbers = read_settings(settings, system, asked)
        check_settings(system, numbers, asked)
        distinct([] if axis_read is None else [axis_read], numbers, asked)
        if axis_read is not None and not asked.complaints:
            numbers = _numbers(file, system, numbers, axis_read.name, asked)
    if asked.refused(None if system is None else file) or system is None:
        sys.exit(BAD_INPUT)
    if axis_read is None:
        sys.exit(at_values(file, system, numbers, as_json))
    from mbsym.algebra.failures import Failure
    from mbsym.analysis import Analysis
    from mbsym.analysis.exceptional import exceptional

    started = time.perf_counter()
    try:
        with status(False, f"{file.name}: normal forms along {axis_read.name}"):
            found = exceptional(Analysis(system), axis_read.name, (axis_read.low, axis_read.high), numbers)
    except Failure as reason:
        complain(file, f"no values listed: {reason}")
        sys.exit(FAILED)
    except KeyboardInterrupt:
        complain(file, "interrupted")
        sys.exit(INTERRUPTED)
    _show(system, found, file, time.perf_counter() - started, as_json)
    sys.exit(OK)


def _numbers(
    file: Path, system: System, given: dict[str, Fraction], varied: str, asked: Options
) -> dict[str, Fraction]:
    """The numbers of all parameters but the varied one; what has none is one of the complaints."""
    from mbsym.mechanics.rest import given_values, missing_values, rational_values

    values = rational_values(given_values(system, given))
    names = [name for name in missing_values(system, values) if name != varied]
    if names:
        asked.complaints.append(missing(file, names, "rational number"))
    return {name: value for name, value in values.items() if name != varied}


def _show(system: System, found: Any, file: Path, seconds: float, as_json: bool) -> None:
    if as_json:
        from mbsym.report.words.exceptional_values import as_text

        click.echo(as_text(system, found), nl=False)
        return
    from rich.text import Text

    from mbsym.report.words.exceptional_values import lines
    from mbsym_cli.console import console, printable

    out = console()
    told = (f"  {printable(file)}, {seconds:.2f} s", "dim")
    out.print(Text.assemble((system.name, "bold"), told))
    for line in lines(found):
        out.print(Text(f"  {line}"))
