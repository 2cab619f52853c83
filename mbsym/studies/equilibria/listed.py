"""The list of relative equilibria in the terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from mbsym.expressions.message import Counted, Message, joined
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
from mbsym.problems.stability.words import Because, Word, explanation
from mbsym.report.content import Block, Graded, Inline, Strong, Subheading, Table, aligned, column, paragraph
from mbsym.report.unit_text import labelled, pretty

#: Said of rows: of what is judged at some values only of coordinates that may have any.
_SAMPLED = (Because.ALSO_ELSEWHERE, Because.DIFFERS_ALONG)

#: Longer equations of a family are only counted.
_LONGEST = 100


def lines(system: System, equilibria: Equilibria, permanent: PermanentRotations | None = None) -> Iterator[Block]:
    """How many there are and how far the list is complete, then all that was found."""
    yield from _summary(equilibria)
    if equilibria.equilibria:
        yield from _tables(system, equilibria.equilibria)
        for number, one in enumerate(equilibria.equilibria, 1):
            if sampled := [x for x in one.verdict.reasons if x.code in _SAMPLED]:
                yield paragraph(f"{number}: ", explanation(sampled))
    angles = {name for body in system.bodies for _, angle in body.rotation.turns() for name in names(angle)}
    for name, rate in equilibria.turning:
        value = with_unit(f"{rate:.10g}", pretty(system.units.rate_of(name)))
        text = "[[name]] turns at the rate [[rate]]" if name in angles else "[[name]] moves at the rate [[rate]]"
        yield paragraph(Message(text, name=name, rate=value))
    if equilibria.singular:
        text = "[[solutions]], the coordinates are singular there: equilibria or not is undecided"
        solutions = Counted(len(equilibria.singular), "more solution", "more solutions")
        yield paragraph(Strong(Message(text, solutions=solutions)))
        yield from _tables(system, equilibria.singular, judged=False)
    if equilibria.beyond:
        lengths = ", ".join(
            f"{name} < 0" for name in dict.fromkeys(x for equilibrium in equilibria.beyond for x in equilibrium.beyond)
        )
        text = (
            "[[solutions]] with [[lengths]], not counted: with positive lengths the bodies would be at "
            "the same places, "
            "but other forces would act"
        )
        solutions = Counted(len(equilibria.beyond), "more solution", "more solutions")
        yield paragraph(Strong(Message(text, solutions=solutions, lengths=lengths)))
        yield from _tables(system, equilibria.beyond, judged=False)
    for number, family in enumerate(equilibria.families, 1):
        yield from _family(system, number, family)
    if permanent is not None:
        yield from _permanent(permanent)


def _tables(system: System, listed: Sequence[RelativeEquilibrium], judged: bool = True) -> Iterator[Block]:
    """A table for the coordinates of the description, then one for each other set of angles, whose numbers go on."""
    for others in dict.fromkeys(["", *(x.coordinates_of for x in listed)]):
        rows = {number: x for number, x in enumerate(listed, 1) if x.coordinates_of == others}
        if others:
            text = "where these angles are singular, in others, about the axes of [[body]]:"
            yield paragraph(Message(text, body=others))
        if rows:
            yield _table(system, rows, judged)


def _table(system: System, rows_by_number: Mapping[int, RelativeEquilibrium], judged: bool) -> Table:
    """A row each; columns that would be empty are left out."""
    listed = rows_by_number.values()
    every = (*system.coordinates, *system.velocities)
    names = [name for name in every if any(_has(x, name) for x in listed)]
    boxes = any(x.proof != "exact" for x in listed)
    columns = [column("", right=True), *(column(labelled(name, unit_of(system, name)), right=True) for name in names)]
    columns += [column(Message("stability"), fold=True), column(Message("theorem"), fold=True)] if judged else []
    columns += [column(Message("proof"))] if boxes else []
    rows = []
    for number, equilibrium in rows_by_number.items():
        cells: list[Inline] = [str(number), *(_cell(equilibrium, name) for name in names)]
        if judged:
            word = equilibrium.verdict.word
            cells += [Graded(Message(word), _grade(word)), joined(map(Message, equilibrium.verdict.theorems), ", ")]
        cells += [Message(equilibrium.proof)] if boxes else []
        rows.append(cells)
    return aligned(columns, rows)


def _has(equilibrium: RelativeEquilibrium, name: str) -> bool:
    return name in equilibrium.free or any(item.name == name for item in equilibrium.values)


def _cell(equilibrium: RelativeEquilibrium, name: str) -> str:
    if name in equilibrium.free:
        return Message("any")
    return next((_text(item) for item in equilibrium.values if item.name == name), "")


def _text(item: CoordinateValue) -> str:
    return item.text if item.exact or item.text == "0" else f"{item.value:.8g}"


def _family(system: System, number: int, family: EquilibriumFamily) -> Iterator[Block]:
    text = "family [[number]]: [[parameters]] ([[names]])"
    if family.coordinates_of:
        text = "family [[number]]: [[parameters]] ([[names]]); angles of [[body]]"
    gaps = {"body": family.coordinates_of} if family.coordinates_of else {}
    parameters = Counted(family.dimension, "parameter")
    yield Subheading((Message(text, number=number, parameters=parameters, names=", ".join(family.free), **gaps),))
    for equation in family.equations[:12]:
        yield paragraph("  ", _shortened(equation), " = 0")
    sample = ", ".join(
        f"{item.name} = {with_unit(_text(item), pretty(unit_of(system, item.name)))}" for item in family.sample
    )
    text = "for example [[values]]: [[verdict]]"
    yield paragraph("  ", Message(text, values=sample, verdict=family.verdict.word))


def _shortened(polynomial: str) -> str:
    """A polynomial, or its length where nobody would read it."""
    terms = polynomial.count(" + ") + polynomial.count(" - ") + 1
    message = Message("(a polynomial of [[terms]], which --json prints)", terms=Counted(terms, "term"))
    return polynomial if len(polynomial) <= _LONGEST else message


def _permanent(permanent: PermanentRotations) -> Iterator[Block]:
    """The family that a steady turn at the description's rate is a member of."""
    text = "permanent rotations about the fixed axis of [[angle]], at whatever rate"
    yield Subheading((Message(text, angle=permanent.angle),))
    text = "g: that axis in the axes of [[body]], g1**2 + g2**2 + g3**2 = 1"
    yield paragraph("  ", Message(text, body=permanent.body))
    acts = [permanent.loaded, permanent.gyrostatic, permanent.inertial]
    where = None
    if permanent.axes:
        polynomial = "*".join(f"({x})" if len(permanent.axes) > 1 else x for x in permanent.axes)
        shown = polynomial if len(polynomial) <= 3 * _LONGEST else _shortened(polynomial)
        text = "necessary for an axis: [[polynomial]] = 0"
        if permanent.family:
            text = "a one-parameter family, the axes on a cone: [[polynomial]] = 0"
        where = Message(text, polynomial=shown)
    elif acts == [False, False, True]:
        where = Message("nothing acts at rest: each axis that satisfies these equations, at any rate")
    elif permanent.everywhere and not permanent.gyrostatic:
        where = Message("a two-parameter family: every axis for which these equations give a real rate")
    elif not any(acts):
        where = Message("nothing acts: every axis, at any rate")
    if where is not None:
        yield paragraph("  ", where)
    for row in zip(permanent.constant, permanent.linear, permanent.quadratic, strict=True):
        if any(x != "0" for x in row):
            parts = (("", row[0]), ("rate*", row[1]), ("rate**2*", row[2]))
            terms = [f"{front}({x})" if front else x for front, x in parts if x != "0"]
            yield paragraph(f"    {' + '.join(terms)} = 0")
    if permanent.either and (permanent.axes or permanent.everywhere):
        text = (
            "one of g and -g carries a rotation, the other none, unless what acts at rest or what grows "
            "with the square "
            "of the rate vanishes at g"
        )
        yield paragraph("  ", Message(text))


def _summary(equilibria: Equilibria) -> Iterator[Block]:
    if equilibria.everywhere:
        yield from (paragraph(Strong(remark)) for remark in equilibria.remarks)
        return
    count = Counted(len(equilibria.equilibria), "relative equilibrium", "relative equilibria")
    words = Counter(equilibrium.verdict.word for equilibrium in equilibria.equilibria)
    kinds = joined((joined((str(n), Message(word))) for word, n in words.items()), "; ")
    counts = [count, *([Counted(len(equilibria.families), "family", "families")] if equilibria.families else [])]
    yield paragraph(Strong(joined(counts, ", ")), *([": ", kinds] if words else []))
    exact = all(x.proof == "exact" for x in equilibria.equilibria)
    if equilibria.complete and (equilibria.singular or equilibria.beyond):
        text = "the list is complete apart from the solutions below that are not counted ([[how]])"
        how = Message("every one exact") if exact else Message("every one proved")
        yield paragraph(Graded(Message(text, how=how), "good"))
    elif equilibria.complete:
        how = Message("every one exact") if exact else Message("every one proved")
        yield paragraph(Graded(Message("the list is complete ([[how]])", how=how), "good"))
    else:
        yield paragraph(Graded(Message("the list may be incomplete"), "open"))
    for remark in equilibria.remarks:
        yield paragraph(Graded(remark, "open"))
    twice = sorted({equilibrium.described for equilibrium in equilibria.equilibria if equilibrium.described > 1})
    if twice:
        text = "counted as configurations: the coordinates describe one in [[ways]] ways"
        yield paragraph(Message(text, ways="/".join(map(str, twice))))
    if equilibria.charts > 1 and not any(equilibrium.coordinates_of for equilibrium in equilibria.equilibria):
        text = "singular angles were replaced by others ([[count]] sets of angles)"
        yield paragraph(Message(text, count=equilibria.charts))


def _grade(word: Word) -> str:
    """What is neither proved to be stable nor unstable is open."""
    return "good" if word.stable else "bad" if word is Word.UNSTABLE else "open"
