"""``mbsym integrals --vary`` and ``--cases``: what is printed of special parameters."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.expressions.message import Message, joined
from mbsym.report.words.integrals_words import (
    ANY_LENGTH,
    BUT_FOR_ALGEBRAIC,
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


def along_lines(there: Setting, usual: PolynomialIntegrals, along: Along) -> Iterator[str]:
    """The values, what there is at each, and what is known of the others."""
    if along.weights not in (None, usual.grading.weights):
        yield weights_here(there.field.variables, along.weights or ())
    length = "" if along.weights is None or not there.vectors else ANY_LENGTH
    for special in along.values:
        yield f"{along.name} = {special.value}"
        yield from _special(there, special)
    if not along.values:
        yield no_further(along.name, along.low, along.high)
    yield from undecided_at(along.name, along.undecided, along.irrational)
    without = Message(" that does not contain [[names]]", names=", ".join(usual.aside)) if usual.aside else ""
    if not along.usual:
        yield Message(NOTHING_KNOWN, name=along.name)
        return
    text = (
        "[[all]] of [[name]] from [[low]] to [[high]] with numerator and denominator up to 10^9 there is no further "
        "integral of weight up to [[degree]][[without]] (proved[[length]]); irrational values are undecided."
    )
    ends: dict[str, object] = {"low": along.low, "high": along.high}
    if along.whole:
        text = (
            "[[all]] of [[name]] from [[low]] to [[high]], rational or not, there is no further integral of weight up "
            "to [[degree]][[without]] ([[how]][[length]])."
        )
        ends["how"] = BUT_FOR_ALGEBRAIC
    ends["all"] = all_values(along.values or along.undecided)
    yield Message(text, name=along.name, **ends, degree=usual.degree, without=without, length=length)


def cases_lines(there: Setting, cases: Cases) -> Iterator[str]:
    """The cases, and what the list is not."""
    for case in cases.cases:
        yield conditions_text(case, lambda p: str(there.formula(p)))
        yield from _special(there, case.special)
    if not cases.cases:
        yield Message("no case was found")
    yield Message(
        "Families of parameters searched (some zero, some equal that play the same part): [[count]], with conditions "
        "of degree up to 3 in each. The integrals are proved; that there are no other cases is not.",
        count=cases.families,
    )
    if cases.left:
        yield Message("Families beyond the budget (--budget): [[count]]; nothing is known of them.", count=cases.left)
    if cases.unread:
        yield Message(
            "Families in which the rank also drops under conditions that were not found: [[count]].", count=cases.unread
        )


def _special(there: Setting, special: Special) -> Iterator[str]:
    for weight, f in special.integrals:
        yield joined(("  ", case_title(weight), ": ", there.formula(f)), "")
    for level in special.levels:
        for weight, f in level.integrals:
            yield joined(("  ", level_title(weight, level), ": ", there.formula(f)), "")
