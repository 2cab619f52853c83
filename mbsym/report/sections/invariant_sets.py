"""Problem 10, steady motions and invariant manifolds: what results.json and the terminal show of it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from mbsym.formulas.formula import Formula
from mbsym.model.system import System
from mbsym.problems.invariant_sets import (
    FirstApproximation,
    InvariantSets,
    Relation,
    SecondVariation,
    StationarySet,
)
from mbsym.report.documents.results import invariant_sets as doc
from mbsym.report.even_powers import in_even_powers
from mbsym.report.plain import LONGEST, Write
from mbsym.report.words.invariant_words import Medium, closing, family_title, of_family, of_set, opening, told_families
from mbsym.report.words.said import filled

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


def data(found: InvariantSets, system: System, write: Write) -> doc.InvariantSets:
    """The section of results.json."""
    return doc.InvariantSets(
        integrals=[doc.NamedFormula(name=name, formula=str(x)) for name, x in found.integrals],
        left_out=list(found.left_out),
        relations=[str(x) for x in found.relations],
        stand_for=dict(found.written),
        families=[
            doc.Family(
                integrals=list(family.integrals),
                multipliers=list(family.multipliers),
                complete=not (family.unfinished or family.singular or family.parts),
                sets=[_set(one) for one in family.sets],
            )
            for family in found.families
        ],
        provided_nonzero=[str(x) for x in found.generic],
    )


def _set(one: StationarySet) -> doc.InvariantSet:
    stands = one.invariant is True
    return doc.InvariantSet(
        kind=one.kind,
        dimension=one.dimension,
        dimension_of_union=one.union,
        solved={name: str(x) for name, x in one.solved},
        relations=[str(x) for x in one.relations],
        nonzero=[str(x) for x in one.nonzero],
        free=list(one.free),
        multipliers={name: None if x is None else str(x) for name, x in one.multipliers},
        motion={name: str(x) for name, x in one.motion},
        invariant={True: "proved", None: "undecided", False: "failed"}[one.invariant],
        real_point_found=one.real,
        second_variation=None if one.variation is None or not stands else _variation(one.variation),
        first_approximation=None if one.first is None else _first(one.first),
        gap=one.gap.value,
    )


def _variation(found: SecondVariation) -> doc.SecondVariation:
    return doc.SecondVariation(
        outcome=found.outcome,
        size=found.size,
        positive=None if found.positive is None else _relations(found.positive),
        negative=None if found.negative is None else _relations(found.negative),
        for_some_value_of=list(found.chosen),
    )


def _first(found: FirstApproximation) -> doc.FirstApproximation:
    return doc.FirstApproximation(
        zero_roots=found.zeros,
        factors_in_lambda_squared=[[str(x) for x in factor] for factor in found.factors],
        necessary=_relations(found.necessary),
        unstable=found.unstable,
        complete=found.complete,
        roots_left_out=found.left,
    )


def _relations(relations: Sequence[Relation]) -> list[doc.SignCondition]:
    return [
        doc.SignCondition(formula=str(one.formula), relation=one.relation, unless_zero=[str(x) for x in one.unless])
        for one in relations
    ]


def lines(found: InvariantSets, analysis: Analysis) -> Iterator[str]:
    """The lines in the terminal."""
    write = plain(found)
    yield from map(filled, opening(found, write))
    for family in told_families(found):
        yield f"K = {family_title(family, found)}"
        yield from (f"  {filled(said)}" for said in of_family(family, write))
        for k, one in enumerate(family.sets, start=1):
            first, *rest = map(filled, of_set(one, k, write))
            yield f"  {first}"
            yield from (f"    {text}" for text in rest)
    yield from map(filled, closing(found, write))


def plain(found: InvariantSets) -> Medium:
    """Text, with sin(theta) for what is called sin_theta in JSON."""
    images = dict(found.written)
    pattern = re.compile(r"\b(?:" + "|".join(map(re.escape, images)) + r")\b") if images else None

    def told(text: str) -> str:
        return text if pattern is None else pattern.sub(lambda match: images[match[0]], text)

    def short(x: Formula) -> str:
        text = str(x)
        return told(text) if len(text) <= LONGEST else f"({x.terms} terms; see the reports)"

    def rate(name: str) -> str:
        return f"d/dt {images[name]}" if name in images else f"{name}'"

    return Medium(
        names=lambda names: told(", ".join(names)),
        condition=lambda x, relation: f"{short(x)} {relation} 0",
        value=lambda name, x: f"{told(name)} = {short(x)}",
        rate=lambda name, x: f"{rate(name)} = {short(x)}",
        formula=short,
        even=lambda factor: told(_even(factor)),
        word=str,
    )


def _even(factor: Sequence[Formula]) -> str:
    """``A*lambda**4 + (B + C)*lambda**2 + D`` of a polynomial in lambda**2, lowest coefficient first."""
    if any(len(str(x)) > LONGEST for x in factor):
        return f"a polynomial of degree {2 * len(factor) - 2} (see the reports)"
    return in_even_powers([str(x) for x in factor], lambda k: f"lambda**{k}", "*")
