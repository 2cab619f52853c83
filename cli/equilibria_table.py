"""The list of relative equilibria in the terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from rich.markup import escape
from rich.table import Table
from rich.text import Text

from mbsym.expressions.counting import counted
from mbsym.expressions.tree import names
from mbsym.model.quantities import unit_of, with_unit
from mbsym.model.system import System
from mbsym.problems.relative_equilibria.equilibria import (
    CoordinateValue,
    Equilibria,
    EquilibriumFamily,
    RelativeEquilibrium,
)
from mbsym.problems.relative_equilibria.permanent_rotations import PermanentRotations
from mbsym.problems.stability.word import Word
from mbsym.report.unit_text import labelled, pretty
from mbsym_cli.console import console, printable

#: Longer equations of a family are only counted.
_LONGEST = 100


def show_equilibria(
    system: System, found: Equilibria, file: Path, seconds: float, permanent: PermanentRotations | None = None
) -> None:
    """Prints all that was found, and how far the list is complete."""
    out = console()
    out.print(Text.assemble((system.name, "bold"), (f"  {printable(file)}, {seconds:.2f} s", "dim")))
    angles = {name for body in system.bodies for _, angle in body.rotation.turns() for name in names(angle)}
    for name, rate in found.turning:
        unit = pretty(system.units.rate_of(name))
        moves = "turns" if name in angles else "moves"
        out.print(Text(f"  {name} {moves} at the rate {with_unit(f'{rate:.10g}', unit)}"))
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
        _show_family(system, number, family)
    _show_summary(found)
    if permanent is not None:
        _show_permanent(permanent)


def _table(system: System, listed: Sequence[RelativeEquilibrium], judged: bool = True) -> Table:

    columns = [name for name in system.coordinates if any(_has(x, name) for x in listed)]
    others = any(x.coordinates_of for x in listed)
    boxes = any(x.proof != "exact" for x in listed)
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold cyan")
    table.add_column("", justify="right", style="dim")
    for name in columns:
        table.add_column(escape(labelled(name, unit_of(system, name))), justify="right")
    if judged:
        table.add_column("stability")
        table.add_column("by", style="dim")
    if boxes:
        table.add_column("proof", style="dim")
    if others:
        table.add_column("angles of", style="dim")
    for number, one in enumerate(listed, 1):
        colour = _colour(one.verdict.word)
        cells: list[str | Text] = [str(number), *(_cell(one, name) for name in columns)]
        if judged:
            cells += [Text(str(one.verdict.word), style=colour), one.verdict.theorem]
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


def _show_family(system: System, number: int, family: EquilibriumFamily) -> None:

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
    sample = ", ".join(
        f"{item.name} = {with_unit(_text(item), pretty(unit_of(system, item.name)))}" for item in family.sample
    )
    out.print(Text(f"    for example {sample}: {family.verdict.word}"))


def _show_permanent(found: PermanentRotations) -> None:
    """The family that a steady turn at the description's rate is a member of."""
    out = console()
    out.print(Text(f"permanent rotations about the fixed axis of {found.angle}, at whatever rate", style="bold"))
    out.print(Text(f"  g: that axis in the axes of {found.body}, g1**2 + g2**2 + g3**2 = 1", style="dim"))
    acts = [found.loaded, found.gyrostatic, found.inertial]
    if found.axes:
        polynomial = "*".join(f"({x})" if len(found.axes) > 1 else x for x in found.axes)
        if len(polynomial) > 3 * _LONGEST:
            polynomial = "(a long polynomial, which --json prints)"
        where = "a one-parameter family, the axes on a cone" if found.family else "necessary for an axis"
        out.print(Text(f"  {where}: {polynomial} = 0"))
    elif acts == [False, False, True]:
        out.print(Text("  nothing acts at rest: each axis that satisfies these equations, at any rate"))
    elif found.everywhere and not found.gyrostatic:
        out.print(Text("  a two-parameter family: every axis for which these equations give a real rate"))
    elif not any(acts):
        out.print(Text("  nothing acts: every axis, at any rate"))
    for row in zip(found.constant, found.linear, found.quadratic, strict=True):
        if any(x != "0" for x in row):
            parts = (("", row[0]), ("rate*", row[1]), ("rate**2*", row[2]))
            terms = [f"{front}({x})" if front else x for front, x in parts if x != "0"]
            out.print(Text(f"    {' + '.join(terms)} = 0"))
    if found.either and (found.axes or found.everywhere):
        out.print(Text("  one of g and -g carries a rotation, the other none, unless what acts at rest"))
        out.print(Text("  or what grows with the square of the rate vanishes at g"))


def _show_summary(found: Equilibria) -> None:

    out = console()
    count = counted(len(found.equilibria), "relative equilibrium", "relative equilibria")
    words = Counter(one.verdict.word for one in found.equilibria)
    kinds = "; ".join(f"{n} {word}" for word, n in words.items())
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


def _colour(word: Word) -> str:
    """What is neither proved to be stable nor unstable is yellow."""
    return "green" if word.stable else "red" if word is Word.UNSTABLE else "yellow"
