"""``mbsym oscillations``: periodic solutions in powers of a small parameter, by Lindstedt and Poincare."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mbsym_cli.console import BAD_INPUT, FAILED, OK, OutPath, complain, read_description, status
from mbsym_cli.files import folder_for
from mbsym_cli.options import Options
from mbsym_cli.oscillation_files import FORMATS, Drawing, check, drawn, symbols
from mbsym_cli.section_options import read_settings

if TYPE_CHECKING:
    from mbsym.analysis.oscillating import Oscillating
    from mbsym.simulation.oscillating import MeasuredOrders

MOST_ORDER = 6


@click.command("oscillations")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--order", "-n", default="2", metavar="N", show_default=True, help="Up to this power.")
@click.option("--of", "leading", metavar="NAME", help="The variable whose oscillation leads, where there are several.")
@click.option("--frequency", default="1", metavar="K", help="Of several that it shares with others, the K-th.")
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Put in a number; repeatable.")
@click.option("--format", "formats", metavar="LIST", help="Draw figures: svg, pdf, png.")
@click.option("--language", metavar="NAME", help="Of figures: en, ru, es.")
@click.option("--out", "-o", type=OutPath(path_type=Path, file_okay=False), help="Folder.  [default: reports/NAME]")
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of text.")
def command(
    file: Path,
    order: str,
    leading: str | None,
    frequency: str,
    settings: tuple[str, ...],
    formats: str | None,
    language: str | None,
    out: Path | None,
    as_json: bool,
) -> None:
    """Find periodic motions of FILE near those of its linear part, in powers of a small parameter, exactly.

    The method of Poincare and Lindstedt: frequencies are corrected so that no secular terms remain; where that is
    possible for some amplitudes only, or not at all, that is told.  FILE names the small parameter ('small parameter:
    eps', or powers of it in parameters and variables); without it, the deviations from the unperturbed motion are
    small, of order eps.  Coefficients hold the parameters, the amplitude and the values that stay constant without
    eps; resonances that were divided by are listed, and what is left out.

    The series are put into the equations exactly.  Where FILE has numbers, their error is measured against runs at
    parts of eps.  Figures show the series and a simulation from the same state over three periods: oscillation (over
    time), oscillation-planes (each variable and its rate), and oscillation-angles where FILE has speeds.

    Exit codes: 0 found and checked; 1 there is no such solution, or none was found within the budget; 2 something is
    wrong.

    \b
    Examples:
      mbsym oscillations systems/spring-pendulum.yaml --of theta
      mbsym oscillations systems/double-pendulum.yaml --of theta1 --frequency 2
      mbsym oscillations systems/gyrostat-fast.yaml --order 2
      mbsym oscillations systems/gyrostat-fast.yaml --set lx=0 --json
      mbsym oscillations systems/gyrostat-fast.yaml --format png --out figures
    """
    from mbsym.report.language import LANGUAGES

    system = read_description(file, unconstrained="oscillations", moving="oscillations")
    asked = Options()
    most = asked.whole("--order", order, 1, MOST_ORDER)
    which = asked.whole("--frequency", frequency, 1, 99)
    values = {} if system is None else read_settings(settings, system, asked, symbols(system))
    if system is not None:
        check(system, leading, values, asked)
    kinds = () if formats is None else asked.words("--format", formats, FORMATS, "format")
    for option, given in (("--out", out), ("--language", language)):
        if given is not None and formats is None:
            asked.complain(option, "wrong-use", "nothing is written without --format", "add --format png")
    spoken = asked.word("--language", language or "en", LANGUAGES, "language")
    stop = asked.refused(None if system is None else file)
    if stop or system is None or most is None or kinds is None or which is None:
        sys.exit(BAD_INPUT)
    from mbsym.algebra.failures import Failure
    from mbsym.analysis import Analysis
    from mbsym.analysis.oscillating import oscillating
    from mbsym.report.words.expansion_measured import orders_or_why

    try:
        with status(as_json, f"{file.name}: oscillations"):
            found = oscillating(Analysis(system), most, values, leading or "", which)
    except ZeroDivisionError as reason:
        complain(file, f"no periodic solution: {reason}")
        sys.exit(BAD_INPUT)
    except Failure as reason:
        complain(file, f"no expansion: {reason}" + (f"; {reason.remedy}" if reason.remedy else ""))
        sys.exit(FAILED)
    with status(as_json, f"{file.name}: measuring"):
        measured = orders_or_why(system, found, values)
    if as_json:
        from mbsym.report.oscillation_json import oscillations_json

        click.echo(oscillations_json(system, values, found, measured), nl=False)
    else:
        _show(file, system.name, found, measured)
    if not kinds or spoken is None:
        sys.exit(OK)
    sys.exit(drawn(Drawing(file, folder_for(file, out), system, values, kinds, spoken, as_json), found))


def _show(file: Path, name: str, told: Oscillating, measured: MeasuredOrders | str) -> None:
    from rich.text import Text

    from mbsym.report.words.oscillation_lines import lines
    from mbsym_cli.console import console, printable

    out = console()
    out.print(Text.assemble((name, "bold"), (f"  {printable(file)}", "dim")))
    for line, heading in lines(told, measured):
        out.print(Text(line, "bold cyan" if heading else ""), soft_wrap=line.startswith("      "))
