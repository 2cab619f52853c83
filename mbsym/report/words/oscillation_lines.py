"""A periodic solution in powers of a small parameter as lines of text."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mbsym.analysis.oscillating import Oscillating
from mbsym.report.content import say
from mbsym.report.plain_writer import Writer
from mbsym.report.words.oscillation_words import DRIFTS, RATE, SOLUTION, measured_sentences, sentences
from mbsym.simulation.oscillating import MeasuredOrders

#: A line, and whether it is a heading.
Line = tuple[str, bool]


def lines(told: Oscillating, measured: MeasuredOrders | str) -> Iterator[Line]:
    """The series harmonic by harmonic, the rate of the phase, drifting variables, and what is said of them."""
    found = told.found
    small = found.small
    for name, power in found.powers:
        yield f"  {name} stands for {name} {small}" + (f"^{power}" if power != 1 else ""), False
    yield "  " + Writer().said(say(SOLUTION, order=str(found.order), small=small, leading=found.leading)), True
    for variable, series in zip(found.names, found.series, strict=True):
        yield from _sum(variable, [_term(small, n, told.written(one)) for n, one in enumerate(series)])
    yield f"  {RATE}", True
    rate = [_term(small, n, str(told.formula(x))) for n, x in enumerate(found.corrections, start=1)]
    yield from _sum(f"{told.phase}' / ({told.formula(found.frequency)})", ["1", *rate])
    if found.drifts:
        yield f"  {DRIFTS}", True
    for drift in found.drifts:
        rates = [_term(small, n, str(told.formula(x))) for n, x in enumerate(drift.rates)]
        waves = [_term(small, n, told.written(x)) for n, x in enumerate(drift.waves)]
        yield from _sum(drift.variable, [*(f"t*({x})" for x in rates if x), *waves])
    for said in (*sentences(told, drifts=True), *measured_sentences(told, measured)):
        yield f"    {Writer().said(said)}", False


def _sum(name: str, terms: Sequence[str]) -> Iterator[Line]:
    yield f"    {name} =", False
    kept = [x for x in terms if x] or ["0"]
    for k, term in enumerate(kept):
        yield f"      {'+ ' if k else ''}{term}", False


def _term(small: str, order: int, text: str) -> str:
    if text == "0" or order == 0:
        return "" if text == "0" else text
    return f"{small} ({text})" if order == 1 else f"{small}^{order} ({text})"
