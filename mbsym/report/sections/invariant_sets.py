"""Problem 10, steady motions and invariant manifolds: what results.json and reports show of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from mbsym.model.system import System
from mbsym.problems.invariant_sets import (
    FirstApproximation,
    InvariantSets,
    Relation,
    SecondVariation,
    StationarySet,
)
from mbsym.report.content import Block, Heading, Phrase, Said, ragged
from mbsym.report.documents.results import invariant_sets as doc
from mbsym.report.plain import Write
from mbsym.report.words.invariant_words import (
    closing,
    family_title,
    of_family,
    of_set,
    opening,
    ring_of,
    told_families,
)

if TYPE_CHECKING:
    from mbsym.formulas.formula import Formula
    from mbsym.report.results import Results


def data(found: InvariantSets, system: System, write: Write) -> doc.InvariantSets:
    """The section of results.json."""
    return doc.InvariantSets(
        integrals=[doc.NamedFormula(name=name, formula=str(x)) for name, x in found.integrals],
        left_out=list(found.left_out),
        relations=[str(x) for x in found.relations],
        stand_for=dict(found.written),
        families=[
            doc.Family.from_result(
                family,
                complete=not (family.unfinished or family.singular or family.parts),
                sets=[_set(one) for one in family.sets],
            )
            for family in found.families
        ],
        provided_nonzero=[str(x) for x in found.generic],
    )


def _set(one: StationarySet) -> doc.InvariantSet:
    stands = one.invariant is True
    return doc.InvariantSet.from_result(
        one,
        dimension_of_union=one.union,
        solved={name: str(x) for name, x in one.solved},
        relations=[str(x) for x in one.relations],
        nonzero=[str(x) for x in one.nonzero],
        multipliers={name: None if x is None else str(x) for name, x in one.multipliers},
        motion={name: str(x) for name, x in one.motion},
        invariant={True: "proved", None: "undecided", False: "failed"}[one.invariant],
        real_point_found=one.real,
        second_variation=None if one.variation is None or not stands else _variation(one.variation),
        first_approximation=None if one.first is None else _first(one.first),
        gap=one.gap.value,
    )


def _variation(found: SecondVariation) -> doc.SecondVariation:
    return doc.SecondVariation.from_result(
        found,
        positive=None if found.positive is None else _relations(found.positive),
        negative=None if found.negative is None else _relations(found.negative),
        for_some_value_of=list(found.chosen),
    )


def _first(found: FirstApproximation) -> doc.FirstApproximation:
    return doc.FirstApproximation.from_result(
        found,
        zero_roots=found.zeros,
        factors_in_lambda_squared=[[str(x) for x in factor] for factor in found.factors],
        necessary=_relations(found.necessary),
        roots_left_out=found.left,
    )


def _relations(relations: Sequence[Relation]) -> list[doc.SignCondition]:
    return [
        doc.SignCondition(formula=str(one.formula), relation=one.relation, unless_zero=[str(x) for x in one.unless])
        for one in relations
    ]


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    yield Heading("invariant-sets", Said("Problem 10. Steady motions and invariant manifolds"))
    yield from results.missing(10)
    if 10 not in results.found:
        return
    found: InvariantSets = results.found[10]
    yield ragged(*opening(found))
    for family in told_families(found):
        yield ragged(Phrase((family_title(family, found), ":")), *of_family(family))
        for k, one in enumerate(family.sets, start=1):
            yield ragged(*of_set(one, k, ring_of(found)))
    if found.generic:
        yield ragged(*closing(found))


def formulas(found: InvariantSets, system: System) -> Iterator[tuple[str, Formula]]:
    """What each formula is, and the formula: those that model.py has."""
    for k, (name, formula) in enumerate(found.integrals):
        yield f"V{k}, {name}", formula
    for k, formula in enumerate(found.relations, start=1):
        yield f"relation {k}, zero", formula
    for f, family in enumerate(found.families, start=1):
        for k, one in enumerate(family.sets, start=1):
            yield from ((f"family {f}, set {k}: {key}", formula) for key, formula in _formulas_of_set(one))


def _formulas_of_set(one: StationarySet) -> Iterator[tuple[str, Formula]]:
    yield from one.solved
    for k, formula in enumerate(one.relations, start=1):
        yield f"equation {k}, zero", formula
    for name, value in one.multipliers:
        if value is not None:
            yield f"multiplier {name}", value
    yield from ((f"{name}'", formula) for name, formula in one.motion)
    if one.variation is not None:
        for word, relations in (("positive", one.variation.positive), ("negative", one.variation.negative)):
            for k, each in enumerate(relations or (), start=1):
                yield f"second variation {word} {k}, {each.relation} 0", each.formula
    if one.first is not None:
        for k, each in enumerate(one.first.necessary, start=1):
            yield f"necessary {k}, {each.relation} 0", each.formula
