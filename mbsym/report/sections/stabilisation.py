"""Problem 8, stabilisation: what results.json and reports show of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from msgspec.structs import asdict

from mbsym.expressions.message import worded
from mbsym.expressions.rates import is_velocity
from mbsym.model.system import System
from mbsym.problems.stabilisation import Feedback, Locus, Rank, Stabilisation
from mbsym.report.content import (
    Block,
    Display,
    Heading,
    Relation,
    Rows,
    Said,
    Symbol,
    exact,
    joined,
    named,
    paragraph,
    ragged,
    say,
    speeds,
)
from mbsym.report.documents.results import stabilisation as doc
from mbsym.report.plain import Write
from mbsym.report.sections.stability import verdict_data
from mbsym.report.words.stabilisation_words import ENCLOSED, FEEDBACK, LYAPUNOV, OF_PART, STATES, sentences

if TYPE_CHECKING:
    from mbsym.report.results import Results


def data(found: Stabilisation, system: System, write: Write) -> doc.Stabilisation:
    """The section of results.json."""
    return doc.Stabilisation.from_result(
        found,
        gyroscopic=[
            doc.Gyroscopic(
                coordinates=list(part.coordinates),
                zero_eigenvalues=part.free,
                regions=[
                    doc.Region(
                        where=[doc.Relation(formula=write(x), relation=relation) for x, relation in region.signs],
                        degree=region.degree,
                    )
                    for region in part.regions
                ],
            )
            for part in found.gyroscopic
        ],
        energies=[
            doc.BundleEnergy.from_result(
                part,
                minors=[write(x) for x in part.minors],
                definite_at_values=part.at_values,
                bundle_at_values=None if part.bundle is None else list(map(str, part.bundle)),
            )
            for part in found.energy
        ],
        dissipation=[
            doc.Dissipation.from_result(
                part,
                rank=_rank(part.rank, write),
                undamped=[
                    doc.Undamped(
                        minus_lambda_squared=write(one.square),
                        shape=None if one.shape is None else [write(x) for x in one.shape],
                    )
                    for one in part.motions
                ],
                pervasive_at_values=part.at_values,
            )
            for part in found.dissipation
        ],
        control=[
            doc.Control.from_result(part, rank=_rank(part.rank, write), controllable_at_values=part.at_values)
            for part in found.control
        ],
        least_inputs=[list(one) for one in found.least],
        feedback=None if found.feedback is None else _feedback(found.feedback),
    )


def _rank(found: Rank, write: Write) -> doc.Rank:
    return doc.Rank.from_result(
        found,
        sure=found.certainty.value,
        roots_without=[[write(x) for x in factor] for factor in found.factors],
        lost=None if found.locus is None else _locus(found.locus, write),
    )


def _locus(found: Locus, write: Write) -> doc.Lost:
    return doc.Lost(
        where_one_vanishes=[write(x) for x in found.factors],
        where_all_vanish=[write(x) for x in found.together],
        provided_nonzero=[write(x) for x in found.provided],
    )


def _feedback(found: Feedback) -> doc.Feedback:
    return doc.Feedback(
        states=list(found.states),
        of_part=found.of_part,
        gains=_numbers(found.gains),
        characteristic_polynomial=list(map(str, found.characteristic)),
        **asdict(verdict_data(found.verdict)),
        lyapunov=None if found.lyapunov is None else _numbers(found.lyapunov),
    )


def _numbers(rows: Sequence[Sequence[Fraction]]) -> list[list[str]]:
    return [list(map(str, row)) for row in rows]


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    found: Stabilisation | None = results.found.get(8)
    yield Heading("stabilisation", Said("Problem 8. Stabilisation"))
    yield from results.missing(8)
    if found is None:
        return
    yield paragraph(
        Said(
            "About the linear equations of problem 5, in the time $t$; asymptotic stability and instability carry "
            "over to the equations of motion."
        )
    )
    yield from map(ragged, sentences(found))
    if found.feedback is None:
        return
    states = found.feedback.states
    if found.feedback.of_part:
        places = named([name for name in states if not is_velocity(name)])
        yield paragraph(say(OF_PART, why=worded(found.feedback.of_part), names=places))
    yield paragraph(Said(FEEDBACK if found.feedback.characteristic else ENCLOSED))
    if found.feedback.of_part or 2 * sum(map(is_velocity, states)) < len(states):
        yield paragraph(Said(STATES, {"names": speeds(states)}))
    yield Display(Relation(Symbol("k"), "=", _rows(found.feedback.gains)), "feedback")
    if found.feedback.characteristic:
        told = Said("Characteristic polynomial of the closed loop, coefficients from the constant one on:")
        yield paragraph(told, " ", joined(map(exact, found.feedback.characteristic), ", "), ".")
    if found.feedback.lyapunov is not None:
        yield paragraph(Said(LYAPUNOV))
        yield Display(Relation(Symbol("P"), "=", _rows(found.feedback.lyapunov)), "lyapunov")


def _rows(numbers: Sequence[Sequence[Fraction]]) -> Rows:
    return Rows(tuple(tuple(map(exact, row)) for row in numbers))
