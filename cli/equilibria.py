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

from mbsym_cli.assignments import assignments
from mbsym_cli.console import BAD_INPUT, FAILED, OK, console, counted, read_description

if TYPE_CHECKING:
    from rich.table import Table

    from mbsym.model.system import System
    from mbsym.problems.equilibria import CoordinateValue, Equilibria, EquilibriumFamily, RelativeEquilibrium

#: How the first word of a verdict is coloured.
_COLOURS = {"asymptotically": "green", "stable": "green", "gyroscopically": "yellow", "unstable": "red"}

#: Verdicts that would not fit into a table.
_SHORTER = {
    "stable with respect to the other variables; the cyclic coordinates drift": "stable (cyclic drift)",
    "asymptotically stable with respect to the other variables; the cyclic coordinates drift": (
        "asymptotically stable (cyclic drift)"
    ),
    "stable in first approximation only, critical": "critical (first approximation)",
}
#: Longer equations of a family are cut; --json has them whole.
_LONGEST = 100


@click.command("equilibria")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Replace a value; repeatable.")
@click.option("--within", default=10.0, show_default=True, help="Where lengths are looked for, if not solved exactly.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of a table.")
def command(file: Path, settings: tuple[str, ...], within: float, as_json: bool) -> None:
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
    if system is None:
        sys.exit(BAD_INPUT)
    values = _values(file, system, settings)
    if values is None:
        sys.exit(BAD_INPUT)
    if not 0 < within <= 1e6:
        raise click.BadParameter("a positive length, at most 1e6", param_hint="--within")
    from mbsym.algebra.base import NoClosedForm, SingularPoint
    from mbsym.problems.equilibria import equilibria

    started = time.perf_counter()
    try:
        with console(stderr=True).status(f"{file.name}: relative equilibria"):
            found = equilibria(system, values, within)
    except (NoClosedForm, SingularPoint) as reason:
        print(f"{file}: no equilibria listed: {reason}", file=sys.stderr)
        sys.exit(FAILED)
    if as_json:
        from mbsym.report.equilibria_json import equilibria_json

        click.echo(equilibria_json(system, values, found), nl=False)
    else:
        _show(system, found, file, time.perf_counter() - started)
    sys.exit(OK)


def _values(file: Path, system: System, settings: tuple[str, ...]) -> dict[str, Fraction] | None:
    """Exact numbers of the parameters, or None after every complaint."""
    from mbsym.expressions.tree import substitute
    from mbsym.mechanics.rest import given_values, missing_values
    from mbsym.model.system import rational

    given, complaints = assignments(settings, system)
    for name in given:
        if name not in system.parameter_names:
            complaints.append(
                f"--set {name}: error[misplaced-name]: equilibria are what is looked for; set parameters only"
            )
    signs = {item.name: item.sign for item in system.parameters}
    overrides: dict[str, Fraction] = {}
    if not complaints:
        known = {item.name: item.value for item in system.parameters if item.value is not None} | given
        for name, expression in given.items():
            value = rational(substitute(expression, {k: v for k, v in known.items() if k != name}))
            if value is None:
                complaints.append(
                    f"--set {name}: error[not-rational]: an exact rational number is needed, for example 3/2"
                )
            elif not _agrees(value, signs[name]):
                complaints.append(f"--set {name}: error[sign-contradiction]: '{name}' is declared {signs[name]}")
            else:
                overrides[name] = value
    for line in complaints:
        print(line, file=sys.stderr)
    if complaints:
        return None
    values = given_values(system, overrides)
    missing = missing_values(system, values)
    if missing:
        print(f"{file}: error[missing-value]: no number for {', '.join(missing)}", file=sys.stderr)
        example = " ".join(f"--set {name}=1" for name in missing[:3]) + (" ..." if len(missing) > 3 else "")
        print(f"  hint: {example}, or in the file  values: {{{missing[0]}: 1, ...}}", file=sys.stderr)
        return None
    return values


def _agrees(value: Fraction, sign: str) -> bool:
    return {
        "positive": value > 0,
        "nonnegative": value >= 0,
        "negative": value < 0,
        "nonpositive": value <= 0,
        "nonzero": value != 0,
    }.get(sign, True)


# --- the table -------------------------------------------------------------------------------------------------------


def _show(system: System, found: Equilibria, file: Path, seconds: float) -> None:
    from rich.text import Text

    out = console()
    out.print(Text.assemble((system.name, "bold"), (f"  {file}, {seconds:.2f} s", "dim")))
    for name, rate in found.turning:
        out.print(Text(f"  {name} turns at the rate {rate:.10g}"))
    if found.equilibria:
        out.print(_table(system, found.equilibria))
    if found.singular:
        where = "the coordinates are singular there: equilibria or not is undecided"
        out.print(Text(f"  {counted(len(found.singular), 'more solution', 'more solutions')}, {where}", style="bold"))
        out.print(_table(system, found.singular, judged=False))
    for number, family in enumerate(found.families, 1):
        _show_family(number, family)
    _show_summary(found)


def _table(system: System, listed: Sequence[RelativeEquilibrium], judged: bool = True) -> Table:
    from rich.table import Table
    from rich.text import Text

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
            cells += [Text(_SHORTER.get(one.verdict.word, one.verdict.word), style=colour), one.verdict.theorem]
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

    out = console()
    angles = f"; angles of {family.coordinates_of}" if family.coordinates_of else ""
    title = (
        f"  family {number}: {counted(family.dimension, 'parameter', 'parameters')} ({', '.join(family.free)}){angles}"
    )
    out.print(Text(title, style="bold cyan"))
    for equation in family.equations[:12]:
        shown = equation if len(equation) <= _LONGEST else f"{equation[:_LONGEST]} ..."
        out.print(Text(f"    {shown} = 0"))
    sample = ", ".join(f"{item.name} = {_text(item)}" for item in family.sample)
    out.print(Text(f"    for example {sample}: {family.verdict.word}"))


def _show_summary(found: Equilibria) -> None:
    from rich.text import Text

    out = console()
    count = counted(len(found.equilibria), "relative equilibrium", "relative equilibria")
    words = Counter(one.verdict.word for one in found.equilibria)
    kinds = "; ".join(f"{n} {_SHORTER.get(word, word)}" for word, n in words.items())
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
        but = " apart from these" if found.singular else ""
        out.print(Text(f"  the list is complete{but} ({how})", style="green"))
    else:
        out.print(Text("  the list may be incomplete", style="bold yellow"))
