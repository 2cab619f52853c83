"""Problem 10, steady motions and invariant manifolds: what results.json and reports show of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.model.system import System
from mbsym.problems.invariant_sets.result import InvariantSets, StationarySet
from mbsym.report.content import Block, Heading, Phrase, Said, ragged
from mbsym.report.documents.base import Write
from mbsym.report.documents.results import invariant_sets as doc
from mbsym.report.words.invariant_words import closing, family_title, of_family, of_set, opening, ring_of, told_families

if TYPE_CHECKING:
    from mbsym.formulas.formula import Formula
    from mbsym.report.results import Results


def data(invariant_sets: InvariantSets, system: System, write: Write) -> doc.InvariantSets:
    """The section of results.json."""
    return doc.InvariantSets.from_result(invariant_sets)


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    yield Heading("invariant-sets", Said("Problem 10. Steady motions and invariant manifolds"))
    yield from results.missing(10)
    if 10 not in results.by_problem:
        return
    sets: InvariantSets = results.by_problem[10]
    yield ragged(*opening(sets))
    for family in told_families(sets):
        yield ragged(Phrase((family_title(family, sets), ":")), *of_family(family))
        for k, stationary_set in enumerate(family.sets, start=1):
            yield ragged(*of_set(stationary_set, k, ring_of(sets)))
    if sets.generic:
        yield ragged(*closing(sets))


def formulas(invariant_sets: InvariantSets, system: System) -> Iterator[tuple[str, Formula]]:
    """What each formula is, and the formula: those that model.py has."""
    for k, (name, formula) in enumerate(invariant_sets.integrals):
        yield f"V{k}, {name}", formula
    for k, formula in enumerate(invariant_sets.relations, start=1):
        yield f"relation {k}, zero", formula
    for f, family in enumerate(invariant_sets.families, start=1):
        for k, stationary_set in enumerate(family.sets, start=1):
            yield from ((f"family {f}, set {k}: {key}", formula) for key, formula in _formulas_of_set(stationary_set))


def _formulas_of_set(locus: StationarySet) -> Iterator[tuple[str, Formula]]:
    yield from locus.solved
    for k, formula in enumerate(locus.relations, start=1):
        yield f"equation {k}, zero", formula
    for name, value in locus.multipliers:
        if value is not None:
            yield f"multiplier {name}", value
    yield from ((f"{name}'", formula) for name, formula in locus.motion)
    if locus.variation is not None:
        for word, relations in (("positive", locus.variation.positive), ("negative", locus.variation.negative)):
            for k, each in enumerate(relations or (), start=1):
                yield f"second variation {word} {k}, {each.relation} 0", each.formula
    if locus.first is not None:
        for k, each in enumerate(locus.first.necessary, start=1):
            yield f"necessary {k}, {each.relation} 0", each.formula
