"""Problem 8, stabilisation: what results.json and the terminal show of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from msgspec.structs import asdict

from mbsym.formulas.formula import Formula
from mbsym.model.system import System
from mbsym.problems.stabilisation import Feedback, Locus, Rank, Stabilisation
from mbsym.report.documents.results import stabilisation as doc
from mbsym.report.plain import LONGEST, Write
from mbsym.report.sections.stability import verdict_data
from mbsym.report.words.said import filled
from mbsym.report.words.stabilisation_words import FEEDBACK, LYAPUNOV, Medium, sentences

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


def data(found: Stabilisation, system: System, write: Write) -> doc.Stabilisation:
    """The section of results.json."""
    return doc.Stabilisation(
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
            doc.BundleEnergy(
                coordinates=list(part.coordinates),
                conserved=part.conserved,
                definite=part.definite,
                minors=[write(x) for x in part.minors],
                definite_at_values=part.at_values,
                bundle_at_values=None if part.bundle is None else list(map(str, part.bundle)),
            )
            for part in found.energy
        ],
        dissipation=[
            doc.Dissipation(
                coordinates=list(part.coordinates),
                complete=part.complete,
                semidefinite=part.semidefinite,
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
            doc.Control(
                coordinates=list(part.coordinates),
                inputs=list(part.inputs),
                rank=_rank(part.rank, write),
                controllable_at_values=part.at_values,
                stabilisable_at_values=part.stabilisable_at_values,
            )
            for part in found.control
        ],
        least_inputs=[list(one) for one in found.least],
        feedback=None if found.feedback is None else _feedback(found.feedback),
        no_feedback=found.no_feedback,
    )


def _rank(found: Rank, write: Write) -> doc.Rank:
    return doc.Rank(
        full=found.full,
        sure=found.certainty.value,
        roots_without=[[write(x) for x in factor] for factor in found.factors],
        lost=None if found.locus is None else _locus(found.locus, write),
        why_not=found.why_not,
    )


def _locus(found: Locus, write: Write) -> doc.Lost:
    return doc.Lost(
        where_one_vanishes=[write(x) for x in found.factors],
        where_all_vanish=[write(x) for x in found.together],
        provided_nonzero=[write(x) for x in found.provided],
    )


def _feedback(found: Feedback) -> doc.Feedback:
    return doc.Feedback(
        gains=_numbers(found.gains),
        characteristic_polynomial=list(map(str, found.characteristic)),
        **asdict(verdict_data(found.verdict)),
        lyapunov=None if found.lyapunov is None else _numbers(found.lyapunov),
    )


def _numbers(rows: Sequence[Sequence[Fraction]]) -> list[list[str]]:
    return [list(map(str, row)) for row in rows]


def lines(found: Stabilisation, analysis: Analysis) -> Iterator[str]:
    """The lines in the terminal."""
    yield from map(filled, sentences(found, PLAIN))
    if found.feedback is not None:
        yield FEEDBACK
        for name, row in zip(analysis.system.input_names, found.feedback.gains, strict=True):
            yield f"  k of {name}: ({', '.join(map(decimal, row))})"
        if found.feedback.lyapunov is not None:
            yield LYAPUNOV


def decimal(x: Fraction) -> str:
    """A number that was rounded to some decimal digits, as it is."""
    return f"{float(x):.12g}"


def _short(text: str, formula: Formula) -> str:
    return text if len(text) <= LONGEST else f"({formula.terms} terms; see the reports)"


def polynomial(factor: Sequence[Formula]) -> str:
    """``lambda**2 + k/m``, highest power first."""
    powers = [f"lambda**{k}" if k > 1 else "lambda" if k else "" for k in range(len(factor))]
    written = []
    for x, power in reversed(list(zip(factor, powers, strict=True))):
        if x.is_zero:
            continue
        text = _short(str(x), x)
        written.append(power if power and text == "1" else f"({text})*{power}" if power else text)
    return " + ".join(written)


PLAIN = Medium(
    names=", ".join,
    condition=lambda x, relation: f"{_short(str(x), x)} {relation} 0",
    formula=lambda x: _short(str(x), x),
    polynomial=polynomial,
    square=lambda x: f"lambda**2 = -({_short(str(x), x)})",
    word=str,
)
