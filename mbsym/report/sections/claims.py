"""What became of the claims."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.problems.claims import ClaimResult, Part
from mbsym.report.content import (
    Beside,
    Block,
    Definitions,
    Display,
    Graded,
    Heading,
    Inline,
    Math,
    Name,
    Notation,
    Phrase,
    Power,
    Relation,
    Said,
    Strong,
    Table,
    TableColumn,
    Text,
    paragraph,
)
from mbsym.report.sections.equations import is_short
from mbsym.report.words.claims import ClaimLine, claim_line, counterexample, grade, names_in, repair, titles, together

if TYPE_CHECKING:
    from mbsym.report.results import Results

_REPAIRS = {"added to": Said("right with this added to"), "taken from": Said("right with this taken from")}


def content(results: Results) -> Iterator[Block]:
    """What reports say; formulas are told in the abbreviations of the publication."""
    claims, system = results.analysis.claims, results.system
    if not claims:
        return
    yield Heading("claims", Said("Claims"))
    yield Beside(names_in(claims, system), tuple(_told(results, claims)))


def _told(results: Results, claims: tuple[ClaimResult, ...]) -> Iterator[Block]:
    yield paragraph(Said("Formulas and numbers as they were printed, compared with what is derived here."))
    abbreviations = results.system.abbreviations
    if abbreviations:
        yield Definitions(Said("Abbreviations"), tuple(Relation(Name(x.name), "=", x.value) for x in abbreviations))
    groups = list(together(map(claim_line, claims)))
    yield Table(
        title=None,
        columns=(TableColumn(Said("place"), 2.6), TableColumn(Said("claim"), 6.2), TableColumn(Said("outcome"), 6.2)),
        rows=tuple(((lines[0].place,), (titles(lines),), _outcome(lines[0])) for lines in groups),
    )
    number = 0
    for result in claims:
        if result.parts or result.difference is not None or result.counterexample is not None:
            number += 1
            yield from _difference(result, number)


def _outcome(line: ClaimLine) -> tuple[Inline, ...]:
    return (Graded(Phrase(line.said), grade(line.word)),)


def _difference(result: ClaimResult, number: int) -> Iterator[Block]:
    """By what a claim differs."""
    claim = result.claim
    about = titles([claim_line(result)])
    title: tuple[Inline, ...] = (Strong(claim.place), ", ", about) if claim.place else (Strong(about),)
    if claim.right is None:
        yield paragraph(*title, ", ", Said("claimed"), ":")
        yield Display(claim.equals, f"claim:{number}")
    else:
        yield paragraph(*title, ":")
    if result.parts or result.difference is not None:
        left: tuple[Math | str, ...] = ()
        if claim.kind == "first integral":
            yield paragraph(Said("On the equations of motion"))
            left = (Notation(r"\frac{\mathrm{d}I}{\mathrm{d}t}"), "=")
        elif result.factor is not None:
            yield paragraph(Said("With the factor"))
            yield Display(Relation(Notation("k"), "=", result.factor))
            yield paragraph(Said("claimed minus $k$ times derived is"))
        else:
            yield paragraph(Said("Claimed minus derived is"))
        for part in result.parts:
            yield from _part(part, claim.variable)
        if not result.parts and result.difference is not None:
            yield Display(Relation(*left, result.difference))
    if result.counterexample is not None:
        yield paragraph(counterexample(result.counterexample))


def _part(part: Part, variable: str) -> Iterator[Block]:
    """A part of a difference, and the abbreviations that would explain it."""
    yield Display(_relation(part, variable))
    for name, change in part.repairs:
        words, formula = repair(part, change)
        yield paragraph(_REPAIRS[words], " ", Name(name), *((":",) if formula is not None else ()))
        if formula is not None:
            yield Display(formula)


def _relation(part: Part, variable: str) -> Relation:
    at: tuple[Math | str, ...] = ()
    if part.power is not None:
        at = (Text(Said("at"), " "), Power(Name(variable), part.power), ":")
    elif part.factor != 1:
        at = (Text(Said("at"), " "), part.factor, ":")
    same = ("=", _same(part.same_as)) if part.same_as else ()
    return Relation(*at, part.difference, *same)


def short_difference(result: ClaimResult) -> Relation | None:
    """Claimed minus derived where that is one short formula: it fits beside the outcome."""
    if result.factor is not None or result.claim.kind == "first integral":
        return None
    if len(result.parts) == 1 and is_short(result.parts[0].difference):
        return _relation(result.parts[0], result.claim.variable)
    if not result.parts and result.difference is not None and is_short(result.difference):
        return Relation(result.difference)
    return None


def _same(words: str) -> Math:
    """``-2*c18``: a number and an abbreviation."""
    number, star, name = words.rpartition("*")
    if star:
        return Relation(Notation(number + r"\,"), Name(name))
    return Relation("-", Name(name[1:])) if name.startswith("-") else Name(name)
