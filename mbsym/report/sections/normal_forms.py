"""Problem 11, terms of higher order: what results.json and reports show of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from flint import arb

from mbsym.model.system import System
from mbsym.problems.normal_forms.result import Focus, InSymbols, Judged, NormalForms
from mbsym.report.content import Block, Heading, Said, ragged
from mbsym.report.documents.base import Write
from mbsym.report.documents.results import normal_forms as doc
from mbsym.report.words.normal_form_words import sentences

if TYPE_CHECKING:
    from mbsym.formulas.formula import Formula
    from mbsym.report.results import Results


def data(normal_forms: NormalForms, system: System, write: Write) -> doc.NormalForms:
    """The section of results.json."""
    symbols = normal_forms.in_symbols
    return doc.NormalForms.from_result(
        normal_forms,
        write,
        at_values=None if normal_forms.at_values is None else _judged(normal_forms.at_values),
        two_frequencies=symbols if isinstance(symbols, InSymbols) else None,
        pair=symbols if isinstance(symbols, Focus) else None,
    )


def _judged(normal_form: Judged) -> doc.NormalFormAtValues:
    actions = [(i + 1, j + 1, value) for (i, j), value in normal_form.quadratic]
    return doc.NormalFormAtValues.from_result(
        normal_form, enclosure, actions=actions, resonances=[resonance.vector for resonance in normal_form.resonances]
    )


def enclosure(x: Any) -> str:
    """A number: exactly where it is rational, else its enclosure, ``[mid +/- rad]``."""
    return str(x.str(20)) if isinstance(x, arb) else str(x)


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    yield Heading("normal_forms", Said("Problem 11. Terms of higher order"))
    yield from results.missing(11)
    if 11 in results.by_problem:
        yield from map(ragged, sentences(results.by_problem[11]))


def formulas(normal_forms: NormalForms, system: System) -> Iterator[tuple[str, Formula]]:
    """What each formula is, and the formula: those that model.py has."""
    symbols = normal_forms.in_symbols
    if isinstance(symbols, InSymbols):
        yield "sum of squares of the frequencies", symbols.trace
        yield "product of squares of the frequencies", symbols.product
        yield "discriminant", symbols.discriminant
        yield "D4", symbols.determinant
        yield "D4 vanishes with", symbols.zero
        for vector, formula in symbols.resonances:
            yield f"resonance {':'.join(map(str, vector))} vanishes with", formula
    elif isinstance(symbols, Focus):
        yield "square of the frequency", symbols.square
        yield f"coefficient for the amplitude of {symbols.amplitude_of}", symbols.coefficient
