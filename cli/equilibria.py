"""``mbsym equilibria``: all relative equilibria of a system at numbers, each with its stability."""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mbsym_cli.assignments import assignments, contradictions
from mbsym_cli.console import BAD_INPUT, FAILED, OK, complain, console, counted, printable, read_description, status
from mbsym_cli.lacking import missing
from mbsym_cli.options import Options

if TYPE_CHECKING:
    from rich.table import Table

    from mbsym.model.system import System
    from mbsym.problems.equilibria import CoordinateValue, Equilibria, EquilibriumFamily, RelativeEquilibrium

#: How the first word of a verdict is coloured.
_COLOURS = {"asymptotically": "green", "stable": "green", "gyroscopically": "yellow", "unstable": "red"}

#: Longer equations of a family are only counted.
_LONGEST = 100


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

    Exit codes: 0 listed, 1 the equations outgrew their budget, 2 something is missing or wrong,
    130 interrupted.

    \b
    Examples:
      mbsym equilibria systems/gravity-gradient.yaml
      mbsym equilibria systems/double-pendulum.yaml --set m2=3/2 --json
    """
    system = read_description(file)
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
        _show(system, found, file, time.perf_counter() - started)
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


# --- the table -------------------------------------------------------------------------------------------------------


def _show(system: System, found: Equilibria, file: Path, seconds: float) -> None:
    from rich.text import Text

    out = console()
    out.print(Text.assemble((system.name, "bold"), (f"  {printable(file)}, {seconds:.2f} s", "dim")))
    for name, rate in found.turning:
        out.print(Text(f"  {name} turns at the rate {rate:.10g}"))
    if found.equilibria:
        out.print(_table(system, found.equilibria))
    if found.singular:
        where = "the coordinates are singular there: equilibria or not is undecided"
        out.print(Text(f"  {counted(len(found.singular), 'more solution', 'more solutions')}, {where}", style="bold"))
        out.print(_table(system, found.singular, judged=False))
    if found.beyond:
        lengths = ", ".join(f"{name} < 0" for name in dict.fromkeys(x for one in found.beyond for x in one.beyond))
        count = counted(len(found.beyond), "more solution", "more solutions")
        where = "with positive lengths the bodies would be at the same places, but other forces would act"
        out.print(Text(f"  {count} with {lengths}, not counted: {where}", style="bold"))
        out.print(_table(system, found.beyond, judged=False))
    for number, family in enumerate(found.families, 1):
        _show_family(number, family)
    _show_summary(found)


def _table(system: System, listed: Sequence[RelativeEquilibrium], judged: bool = True) -> Table:
    from rich.table import Table
    from rich.text import Text

    from mbsym.problems.stability.sentences import short

    columns = [name for name in system.coordinates if any(_has(x, name) for x in listed)]
    others = any(x.coordinates_of for x in listed)
    boxes = any(x.proof != "exact" for x in listed)
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold cyan")
    table.add_column("", justify="right", style="dim")
    for name in columns:
        table.add_column(name, justify="right")
    if judged:
        table.add_column("stability")
        table.add_column("by", style="dim")
    if boxes:
        table.add_column("proof", style="dim")
    if others:
        table.add_column("angles of", style="dim")
    for number, one in enumerate(listed, 1):
        colour = _COLOURS.get(one.verdict.word.split(" ")[0], "yellow")
        cells: list[str | Text] = [str(number), *(_cell(one, name) for name in columns)]
        if judged:
            cells += [Text(short(one.verdict.word), style=colour), one.verdict.theorem]
        cells += [one.proof] if boxes else []
        cells += [one.coordinates_of] if others else []
        table.add_row(*cells)
    return table


def _has(one: RelativeEquilibrium, name: str) -> bool:
    return name in one.free or any(item.name == name for item in one.values)


def _cell(one: RelativeEquilibrium, name: str) -> str:
    if name in one.free:
        return "any"
    return next((_text(item) for item in one.values if item.name == name), "")


def _text(item: CoordinateValue) -> str:
    return item.text if item.exact or item.text == "0" else f"{item.value:.8g}"


def _show_family(number: int, family: EquilibriumFamily) -> None:
    from rich.text import Text

    from mbsym.problems.stability.sentences import short

    out = console()
    angles = f"; angles of {family.coordinates_of}" if family.coordinates_of else ""
    title = (
        f"  family {number}: {counted(family.dimension, 'parameter', 'parameters')} ({', '.join(family.free)}){angles}"
    )
    out.print(Text(title, style="bold cyan"))
    for equation in family.equations[:12]:
        terms = equation.count(" + ") + equation.count(" - ") + 1
        shown = equation if len(equation) <= _LONGEST else f"(a polynomial of {terms} terms, which --json prints)"
        out.print(Text(f"    {shown} = 0"))
    sample = ", ".join(f"{item.name} = {_text(item)}" for item in family.sample)
    out.print(Text(f"    for example {sample}: {short(family.verdict.word)}"))


def _show_summary(found: Equilibria) -> None:
    from rich.text import Text

    from mbsym.problems.stability.sentences import short

    out = console()
    count = counted(len(found.equilibria), "relative equilibrium", "relative equilibria")
    words = Counter(one.verdict.word for one in found.equilibria)
    kinds = "; ".join(f"{n} {short(word)}" for word, n in words.items())
    families = f", {counted(len(found.families), 'family', 'families')}" if found.families else ""
    out.print(Text.assemble((count + families, "bold"), f": {kinds}" if kinds else ""))
    twice = {one.described for one in found.equilibria if one.described > 1}
    if twice:
        times = " or ".join(str(n) for n in sorted(twice))
        out.print(Text(f"  counted as configurations: the coordinates describe one in {times} ways", style="dim"))
    if found.charts > 1:
        out.print(Text(f"  singular angles were replaced by others ({found.charts} sets of angles)", style="dim"))
    for remark in found.remarks:
        out.print(Text(f"  {remark}", style="yellow"))
    if found.complete:
        how = "every one exact" if all(x.proof == "exact" for x in found.equilibria) else "every one proved"
        but = " apart from these" if found.singular or found.beyond else ""
        out.print(Text(f"  the list is complete{but} ({how})", style="green"))
    else:
        out.print(Text("  the list may be incomplete", style="bold yellow"))
