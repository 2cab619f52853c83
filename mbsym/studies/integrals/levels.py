"""``mbsym integrals --relations``: what is printed of integrals where another one has a value that is not zero."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.expressions.message import Message
from mbsym.report.words.integrals_words import ALMOST, ANY_LENGTH, BUT_FOR_ALGEBRAIC, NOT_LOOKED_FOR, title

if TYPE_CHECKING:
    from mbsym.analysis.polynomial import Setting
    from mbsym.problems.polynomial_integrals import OtherLevel, OtherLevels


def other_lines(there: Setting, other_levels: OtherLevels | None) -> Iterator[str]:
    """What holds on single levels, and what is known of all others."""
    if other_levels is None:
        yield NOT_LOOKED_FOR
        return
    for level in other_levels.levels:
        yield from _of(there, other_levels, level)
    if not other_levels.levels:
        yield Message("There is no integral in the list whose values could be looked at.")


def _of(there: Setting, other_levels: OtherLevels, other: OtherLevel) -> Iterator[str]:
    that = Message("the integral of weight [[weight]] ([[name]])", weight=other.level.weight, name=title(other.level))
    power = other.power
    value = that if power == 1 else Message("the power [[power]] of [[integral]]", power=power, integral=that)
    vectors = bool(there.field.relations) and (not other_levels.fixed or other_levels.weights is not None)
    if not other.looked:
        yield Message("where [[integral]] is not zero there may be others: not found within the budget.", integral=that)
        return
    for at in other.values:
        for weight, f in at.integrals:
            yield Message(
                "where [[integral]] is [[value]], one of weight [[weight]]: [[formula]]",
                integral=value,
                value=at.value,
                weight=weight,
                formula=there.formula(f),
            )
        if not at.complete:
            yield Message("  where it is [[value]] there may be others: not found within the budget", value=at.value)
    for number in other.undecided:
        text = "whether there are others where [[integral]] is [[value]] is undecided"
        yield Message(text, integral=value, value=number)
    for p in other.irrational:
        text = "undecided where [[integral]] is a zero c of [[polynomial]]"
        yield Message(text, integral=value, polynomial=str(p).replace("x", "c"))
    if not other.complete:
        yield Message(
            "where [[integral]] is not zero there may be others at almost all of its values: those are integrals that "
            "hold everywhere, of higher weight or not found, with this value put in.",
            integral=that,
        )
        return
    if other.drops:
        text = "where [[integral]] has single values, other than zero, there may be others: put in numbers with --set."
        yield Message(text, integral=that)
        return
    known = {
        "integral": that,
        "degree": other_levels.degree,
        "almost": ALMOST if there.field.parameters else "",
        "length": ANY_LENGTH if vectors else "",
    }
    text = (
        "where [[integral]] is not zero there is none beyond those that hold everywhere of weight up to "
        "[[degree]][[almost]] ([[how]][[length]])."
    )
    if not other.by_rank:
        known["how"] = Message("proved")
    elif there.field.parameters:
        known["how"] = Message("verified at random parameters modulo a prime")
    elif other.whole:
        known["how"] = BUT_FOR_ALGEBRAIC
    else:
        known["integral"] = value
        text = (
            "where [[integral]] has any other rational value but zero, with numerator and denominator up to 10^9, "
            "there is none beyond those that hold everywhere of weight up to [[degree]][[almost]] (proved[[length]]); "
            "other irrational values are undecided."
        )
    yield Message(text, **known)
