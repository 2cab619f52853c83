"""Problem 8, stabilisation: what results.json and reports show of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from mbsym.expressions.message import worded
from mbsym.expressions.rates import is_velocity
from mbsym.model.system import System
from mbsym.problems.stabilisation.result import Stabilisation
from mbsym.report.content import (
    Block,
    Display,
    Heading,
    Relation,
    Rows,
    Said,
    Symbol,
    exact,
    named,
    paragraph,
    ragged,
    say,
    speeds,
)
from mbsym.report.documents.base import Write
from mbsym.report.documents.results import stabilisation as doc
from mbsym.report.sections.stability import verdict_data
from mbsym.report.words.stabilisation_words import ENCLOSED, FEEDBACK, LYAPUNOV, OF_PART, STATES, sentences

if TYPE_CHECKING:
    from mbsym.report.results import Results


def data(stabilisation: Stabilisation, system: System, write: Write) -> doc.Stabilisation:
    """The section of results.json."""
    law = stabilisation.feedback
    feedback = None if law is None else doc.Feedback.from_result(law, **verdict_data(law.verdict))
    return doc.Stabilisation.from_result(stabilisation, write, feedback=feedback)


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    stabilisation: Stabilisation | None = results.by_problem.get(8)
    yield Heading("stabilisation", Said("Problem 8. Stabilisation"))
    yield from results.missing(8)
    if stabilisation is None:
        return
    yield paragraph(
        Said(
            "About the linear equations of problem 5, in the time $t$; asymptotic stability and instability carry "
            "over to the equations of motion."
        )
    )
    yield from map(ragged, sentences(stabilisation))
    if stabilisation.feedback is None:
        return
    states = stabilisation.feedback.states
    if stabilisation.feedback.of_part:
        places = named([name for name in states if not is_velocity(name)])
        yield paragraph(say(OF_PART, why=worded(stabilisation.feedback.of_part), names=places))
    yield paragraph(Said(FEEDBACK if stabilisation.feedback.characteristic else ENCLOSED))
    if stabilisation.feedback.of_part or 2 * sum(map(is_velocity, states)) < len(states):
        yield paragraph(Said(STATES, {"names": speeds(states)}))
    yield Display(Relation(Symbol("k"), "=", _rows(stabilisation.feedback.gains)), "feedback")
    if stabilisation.feedback.lyapunov is not None:
        yield paragraph(Said(LYAPUNOV))
        yield Display(Relation(Symbol("P"), "=", _rows(stabilisation.feedback.lyapunov)), "lyapunov")


def _rows(numbers: Sequence[Sequence[Fraction]]) -> Rows:
    return Rows(tuple(tuple(map(exact, row)) for row in numbers))
