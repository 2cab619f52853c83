"""``mbsym integrals --vary`` and ``--cases``: what is printed of special parameters."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.expressions.message import Message, joined
from mbsym.report.words.integrals_words import (
    ANY_LENGTH,
    NOTHING_KNOWN,
    all_values,
    case_title,
    conditions_text,
    level_title,
    no_further,
    undecided_at,
    weights_here,
)

if TYPE_CHECKING:
    from mbsym.analysis.polynomial import Setting
    from mbsym.problems.polynomial_integrals import Along, Cases, PolynomialIntegrals, Special


def along_lines(there: Setting, usual: PolynomialIntegrals, found: Along) -> Iterator[str]:
    """The values, what there is at each, and what is known of the others."""
    if found.weights not in (None, usual.grading.weights):
        yield weights_here(there.field.variables, found.weights or ())
    length = "" if found.weights is None or not there.vectors else ANY_LENGTH
    for one in found.values:
        yield f"{found.name} = {one.value}"
        yield from _special(there, one)
    if not found.values:
        yield no_further(found.name, found.low, found.high)
    yield from undecided_at(found.name, found.undecided, found.irrational)
    without = Message(" that does not contain [[names]]", names=", ".join(usual.aside)) if usual.aside else ""
    if not found.usual:
        yield Message(NOTHING_KNOWN, name=found.name)
        return
    text = (
        "[[all]] of [[name]] from [[low]] to [[high]] with numerator and denominator up to 10^9 there is "
        "no further integral of weight up to [[degree]][[without]] (proved[[length]]); irrational values are undecided."
    )
    if found.whole:
        text = (
            "[[all]] of [[name]] from [[low]] to [[high]], rational or not, there is no further integral of "
            "weight up to [[degree]][[without]] (proved, but for algebraic numbers whose polynomials over the integers "
            "need coefficients beyond 10^9[[length]])."
        )
    ends = {"all": all_values(found.values or found.undecided), "low": found.low, "high": found.high}
    yield Message(text, name=found.name, **ends, degree=usual.degree, without=without, length=length)


def cases_lines(there: Setting, found: Cases) -> Iterator[str]:
    """The cases, and what the list is not."""
    for case in found.cases:
        yield conditions_text(case, lambda p: str(there.formula(p)))
        yield from _special(there, case.special)
    if not found.cases:
        yield Message("no case was found")
    yield Message(
        "Families of parameters searched (some zero, some equal that play the same part): [[count]], with conditions "
        "of degree up to 3 in each. The integrals are proved; that there are no other cases is not.",
        count=found.families,
    )
    if found.left:
        yield Message(
            "Families beyond the budget (--budget): [[count]]; nothing is known of them.",
            count=found.left,
        )
    if found.unread:
        yield Message(
            "Families in which the rank also drops under conditions that were not found: [[count]].",
            count=found.unread,
        )


def _special(there: Setting, one: Special) -> Iterator[str]:
    for weight, f in one.integrals:
        yield joined(("  ", case_title(weight), ": ", there.formula(f)), "")
    for level in one.levels:
        for weight, f in level.integrals:
            yield joined(("  ", level_title(weight, level), ": ", there.formula(f)), "")
