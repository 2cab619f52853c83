"""The list of relative equilibria in the terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

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
from mbsym.studies.study import Column, Line, Rows, line

#: Longer equations of a family are only counted.
_LONGEST = 100


def lines(system: System, found: Equilibria, permanent: PermanentRotations | None = None) -> Iterator[Line | Rows]:
    """All that was found, and how far the list is complete."""
    angles = {name for body in system.bodies for _, angle in body.rotation.turns() for name in names(angle)}
    for name, rate in found.turning:
        unit = pretty(system.units.rate_of(name))
        moves = "turns" if name in angles else "moves"
        yield line(f"  {name} {moves} at the rate {with_unit(f'{rate:.10g}', unit)}")
    if found.equilibria:
        yield _table(system, found.equilibria)
    if found.singular:
        where = "the coordinates are singular there: equilibria or not is undecided"
        yield line((f"  {counted(len(found.singular), 'more solution', 'more solutions')}, {where}", "bold"))
        yield _table(system, found.singular, judged=False)
    if found.beyond:
        lengths = ", ".join(f"{name} < 0" for name in dict.fromkeys(x for one in found.beyond for x in one.beyond))
        count = counted(len(found.beyond), "more solution", "more solutions")
        where = "with positive lengths the bodies would be at the same places, but other forces would act"
        yield line((f"  {count} with {lengths}, not counted: {where}", "bold"))
        yield _table(system, found.beyond, judged=False)
    for number, family in enumerate(found.families, 1):
        yield from _family(system, number, family)
    yield from _summary(found)
    if permanent is not None:
        yield from _permanent(permanent)


def _table(system: System, listed: Sequence[RelativeEquilibrium], judged: bool = True) -> Rows:
    """A row each; columns that would be empty are left out."""
    names = [name for name in system.coordinates if any(_has(x, name) for x in listed)]
    others = any(x.coordinates_of for x in listed)
    boxes = any(x.proof != "exact" for x in listed)
    columns = [Column("", right=True, style="dim")]
    columns += [Column(labelled(name, unit_of(system, name)), right=True) for name in names]
    columns += [Column("stability"), Column("by", style="dim")] if judged else []
    columns += [Column("proof", style="dim")] if boxes else []
    columns += [Column("angles of", style="dim")] if others else []
    rows = []
    for number, one in enumerate(listed, 1):
        cells: list[str | tuple[str, str]] = [str(number), *(_cell(one, name) for name in names)]
        if judged:
            cells += [(str(one.verdict.word), _colour(one.verdict.word)), one.verdict.theorem]
        cells += [one.proof] if boxes else []
        cells += [one.coordinates_of] if others else []
        rows.append(cells)
    return Rows(columns, rows)


def _has(one: RelativeEquilibrium, name: str) -> bool:
    return name in one.free or any(item.name == name for item in one.values)


def _cell(one: RelativeEquilibrium, name: str) -> str:
    if name in one.free:
        return "any"
    return next((_text(item) for item in one.values if item.name == name), "")


def _text(item: CoordinateValue) -> str:
    return item.text if item.exact or item.text == "0" else f"{item.value:.8g}"


def _family(system: System, number: int, family: EquilibriumFamily) -> Iterator[Line]:
    angles = f"; angles of {family.coordinates_of}" if family.coordinates_of else ""
    title = (
        f"  family {number}: {counted(family.dimension, 'parameter', 'parameters')} ({', '.join(family.free)}){angles}"
    )
    yield line((title, "bold cyan"))
    for equation in family.equations[:12]:
        terms = equation.count(" + ") + equation.count(" - ") + 1
        shown = equation if len(equation) <= _LONGEST else f"(a polynomial of {terms} terms, which --json prints)"
        yield line(f"    {shown} = 0")
    sample = ", ".join(
        f"{item.name} = {with_unit(_text(item), pretty(unit_of(system, item.name)))}" for item in family.sample
    )
    yield line(f"    for example {sample}: {family.verdict.word}")


def _permanent(found: PermanentRotations) -> Iterator[Line]:
    """The family that a steady turn at the description's rate is a member of."""
    yield line((f"permanent rotations about the fixed axis of {found.angle}, at whatever rate", "bold"))
    yield line((f"  g: that axis in the axes of {found.body}, g1**2 + g2**2 + g3**2 = 1", "dim"))
    acts = [found.loaded, found.gyrostatic, found.inertial]
    if found.axes:
        polynomial = "*".join(f"({x})" if len(found.axes) > 1 else x for x in found.axes)
        if len(polynomial) > 3 * _LONGEST:
            polynomial = "(a long polynomial, which --json prints)"
        where = "a one-parameter family, the axes on a cone" if found.family else "necessary for an axis"
        yield line(f"  {where}: {polynomial} = 0")
    elif acts == [False, False, True]:
        yield line("  nothing acts at rest: each axis that satisfies these equations, at any rate")
    elif found.everywhere and not found.gyrostatic:
        yield line("  a two-parameter family: every axis for which these equations give a real rate")
    elif not any(acts):
        yield line("  nothing acts: every axis, at any rate")
    for row in zip(found.constant, found.linear, found.quadratic, strict=True):
        if any(x != "0" for x in row):
            parts = (("", row[0]), ("rate*", row[1]), ("rate**2*", row[2]))
            terms = [f"{front}({x})" if front else x for front, x in parts if x != "0"]
            yield line(f"    {' + '.join(terms)} = 0")
    if found.either and (found.axes or found.everywhere):
        yield line("  one of g and -g carries a rotation, the other none, unless what acts at rest")
        yield line("  or what grows with the square of the rate vanishes at g")


def _summary(found: Equilibria) -> Iterator[Line]:
    count = counted(len(found.equilibria), "relative equilibrium", "relative equilibria")
    words = Counter(one.verdict.word for one in found.equilibria)
    kinds = "; ".join(f"{n} {word}" for word, n in words.items())
    families = f", {counted(len(found.families), 'family', 'families')}" if found.families else ""
    yield line((count + families, "bold"), f": {kinds}" if kinds else "")
    twice = {one.described for one in found.equilibria if one.described > 1}
    if twice:
        times = " or ".join(str(n) for n in sorted(twice))
        yield line((f"  counted as configurations: the coordinates describe one in {times} ways", "dim"))
    if found.charts > 1:
        yield line((f"  singular angles were replaced by others ({found.charts} sets of angles)", "dim"))
    for remark in found.remarks:
        yield line((f"  {remark}", "yellow"))
    if found.complete:
        how = "every one exact" if all(x.proof == "exact" for x in found.equilibria) else "every one proved"
        but = " apart from these" if found.singular or found.beyond else ""
        yield line((f"  the list is complete{but} ({how})", "green"))
    else:
        yield line(("  the list may be incomplete", "bold yellow"))


def _colour(word: Word) -> str:
    """What is neither proved to be stable nor unstable is yellow."""
    return "green" if word.stable else "red" if word is Word.UNSTABLE else "yellow"
