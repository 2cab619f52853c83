"""The words of maps: what a cell is, which condition a border comes from, why nothing is said."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from typing import Any

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.plane.line import Line
from mbsym.expressions import message
from mbsym.expressions.message import Message, joined, worded
from mbsym.maps.boundaries import Condition, Origin
from mbsym.maps.boxes import BoxMap
from mbsym.maps.branches_events import Event
from mbsym.maps.branches_result import Branches, Doubt, Remark
from mbsym.maps.result import Cell, Counted, Map, Of, Shape
from mbsym.maps.soft_borders import Onset
from mbsym.maps.verdicts import Judged
from mbsym.problems.stability.verdict import Verdict
from mbsym.problems.stability.words import Word
from mbsym.report.content import exact

#: Of several conditions that vanish on one curve, the first says most about it.
_TELLING = (
    *(Origin.CONSTANT, Origin.HURWITZ, Origin.DISCRIMINANT, Origin.STIFFNESS, Origin.RESULTANT),
    Origin.MEETING,
    *(Origin.ASSUMPTION, Origin.INERTIA, Origin.SIGN, Origin.UNDEFINED, Origin.MASS, Origin.LEADING),
    *(Origin.DAMPING, Origin.UNDAMPED, Origin.POTENTIAL, Origin.NOT_GYROSCOPIC, Origin.CYCLIC, Origin.ENERGY),
    Origin.HIGHER_ORDER,
    *(Origin.SINGULAR, Origin.LEAVING),
)

#: Of every file of a map that Ctrl-C ended.
INTERRUPTED = "Interrupted: incomplete and not checked"


def stem(chart: Map) -> str:
    """What the files of a map are called, without their endings."""
    return "branches" if isinstance(chart, Branches) else "equilibria-map" if chart.of is Of.EQUILIBRIA else "map"


def rational_text(x: Any) -> str:
    """A rational number, or what is written instead of one: ``2/5``, but ``9.81`` where the decimal is shorter."""
    fraction = str(x)
    decimal = exact(Fraction(fraction)).text if _RATIONAL.fullmatch(fraction) else fraction
    return decimal if len(decimal) < len(fraction) and "e" not in decimal else fraction


_RATIONAL = re.compile(r"-?\d{1,99}/\d{1,99}")


def telling(conditions: Sequence[Condition], outside: bool = False) -> Condition:
    """The condition that says most about a curve; one that parameters have to keep where it is a border of these."""
    origins = (Origin.ASSUMPTION, Origin.INERTIA, Origin.SIGN, Origin.MASS, Origin.UNDEFINED)
    order = [*origins, *_TELLING] if outside else _TELLING
    return min(conditions, key=lambda condition: order.index(condition.origin))


def condition_words(condition: Condition, chart: Map, named: Callable[[str], str] = str) -> Message:
    """``double root: discriminant (psi, phi, sigma)``; ``named`` writes a coordinate."""
    words = condition.origin.told
    if condition.origin in (Origin.ASSUMPTION, Origin.SIGN, Origin.INERTIA):
        return joined((words, condition.about), ": ") if condition.about else words
    if condition.part is None or chart.section is None or len(chart.section.parts) == 1:
        return words
    names = ", ".join(map(named, chart.section.coordinates[condition.part]))
    return Message("[[words]] ([[names]])", words=words, names=names)


def border_words(chart: Map, k: int, named: Callable[[str], str] = str) -> Message:
    """What a letter of the picture stands for: curve ``k``, or point ``k`` of a line.

    Where drawn borders bound what is not judged it is what parameters have to keep.
    """
    borders, conditions = marked(chart, k)
    sides = [x for border in borders if chart.drawn(border) for x in chart.beside(border) if x is not None]
    condition = telling(conditions, outside=any(x.lack is not None for x in sides))
    return joined((condition_words(condition, chart, named), *onset_words(borders)), ", ")


def marked(chart: Map, k: int) -> tuple[list[Cell], Sequence[Condition]]:
    """The borders that have this letter, and the conditions that are equalities there."""
    if isinstance(chart.ground, Line):
        return [chart.corners[k]], chart.conditions(chart.corners[k])
    return [arc for arc in chart.arcs if k in chart.place(arc).factors], chart.boundaries.conditions[k]


def onset_words(borders: Sequence[Cell]) -> list[Message]:
    """``soft border`` of a curve's arcs or of points where terms of third order decide that on all of them.

    Nothing where one of them is open, or is decided at its point only.
    """
    seen: set[Onset] = set()
    for border in borders:
        if border.soft is not None and border.soft.onset is not Onset.NEITHER:
            stretches = border.soft.stretches
            if border.shape is Shape.ARC and stretches is None:
                return []
            seen |= {border.soft.onset, *(x.onset for x in stretches or ())}
    if not seen or Onset.OPEN in seen:
        return []
    only = next(iter(seen)) if len(seen) == 1 else None
    words = {Onset.SOFT: "soft border", Onset.HARD: "hard border", None: "soft border in parts, hard in others"}
    return [Message(words[only])]


def cell_words(chart: Map, cell: Cell) -> Message:
    """What is said of a cell, for a legend or a table."""
    if (counts := cell.counted) is not None:
        return counted_words(counts, cell.certainty)
    if (judged := cell.judged) is None:
        assert cell.lack is not None
        return cell.lack.told
    return signature_words(judged) if chart.of is Of.SIGNATURE else judged_words(judged)


def counted_words(counts: Counted, certainty: Certainty) -> Message:
    """``24 equilibria, 4 stable``."""
    proved = certainty is Certainty.PROVED
    text = "[[equilibria]], [[stable]] stable"
    if proved and not counts.throughout:
        text = "[[equilibria]], [[stable]] stable at the sample"
    phrase = Message(text, equilibria=message.Counted(counts.count, "equilibrium", "equilibria"), stable=counts.stable)
    if counts.undecided:
        phrase = Message("[[told]], [[undecided]] undecided", told=phrase, undecided=counts.undecided)
    return phrase if proved else Message("[[told]] (at the sample only)", told=phrase)


def judged_words(judged: Judged) -> Message:
    """``unstable: flutter`` or the verdict's word."""
    word = judged.verdict.word
    if word is not Word.UNSTABLE or not judged.right or judged.real_right is None:
        return Message(word)  # unstable by terms of higher order, too
    pairs = judged.right - judged.real_right
    how = "divergence" if not pairs else "divergence and flutter" if judged.real_right else "flutter"
    return joined((Message(word), Message(how)), ": ")


def signature_words(judged: Judged) -> Message:
    """``degree of instability 2``; where K is singular, its nullity as well."""
    if judged.degree is None:
        return Message(Word.UNDECIDED)
    phrase = Message("degree of instability [[degree]]", degree=judged.degree)
    return Message("[[told]], null directions [[null]]", told=phrase, null=judged.null) if judged.null else phrase


def row_words(chart: Map, cell: Cell) -> tuple[Message, str]:
    """(``unstable: flutter, 2 roots to the right``, the theorem), for tables."""
    phrase, judged = cell_words(chart, cell), cell.judged
    if judged is None or chart.of is Of.SIGNATURE:
        return phrase, ""
    if judged.right:
        phrase = Message("[[told]], [[roots]] to the right", told=phrase, roots=message.Counted(judged.right, "root"))
    return phrase, joined(map(Message, judged.verdict.theorems), ", ")


def share(value: float) -> str:
    """A part of the area in per cent, never rounded to none or all."""
    percent = 100 * value
    if value in (0, 1):
        return f"{percent:.0f} %"
    return Message("less than 0.01 %") if percent < 0.01 else f"{min(percent, 99.99):.2f} %"


def percent(chart: BoxMap) -> Message:
    """``12.50 % of the area`` are white."""
    return Message("[[share]] of the area", share=share(float(chart.subdivision.white)))


# --- branches of equilibria -------------------------------------------------------------------------------------------

_DOUBTS = {
    Doubt.UNFINISHED: "critical values may be missing, the exact solution is not finished",
    Doubt.THROUGHOUT: "equilibria are singular over a whole interval: critical values may be missing",
    Doubt.STABILITY: "where the stability changes along branches is not all solved",
    Doubt.UNCOUNTED: "the equilibria at a critical value are not all solved",
    Doubt.MISMATCH: "the counts beside a critical value contradict the events there: nothing is claimed of it",
    Doubt.INCOMPLETE: "the list at a sample may be incomplete",
    Doubt.FAMILIES: "at a sample there are infinitely many equilibria, which are not followed",
}

_BORDER = "equilibria at infinity or at a border (a root or denominator is zero, or the mass matrix singular)"
_RANK_LOST = "equilibria in positions in which the constraints are singular"
_CHANGE = "the verdict of a branch changes"
_DIFFER = "the verdicts at the samples on both sides differ"


def event_words(events: Iterable[Event]) -> Message:
    """``2 x fold, pitchfork``."""
    listed = list(events)
    messages = []
    for event in dict.fromkeys(listed):
        words, count = event.told, listed.count(event)
        messages.append(joined((f"{count} x", words)) if count > 1 else words)
    return joined(messages, ", ")


def critical_words(branches: Branches, at: Cell) -> str:
    """What happens at a critical value; "" for nothing that is shown."""
    critical = branches.critical(at)
    if critical.tried:
        return Message("near it the number changes, found by trying")
    if critical.balance is False:
        return Event.DEGENERATE.told
    parts = [event_words(critical.events)] if critical.events else []
    if branches.leaves(at) and not critical.continuum:
        parts.append(Message(_RANK_LOST if critical.rank_lost else _BORDER))
    if branches.verdict_changes(at) and not parts and not branches.count_changes(at):
        parts.append(Message(_CHANGE if branches.certain(at) else _DIFFER))
    if not parts and branches.happens(at):
        parts.append(Event.DEGENERATE.told)
    return joined(parts, ", ") if parts else ""


def remark_words(remark: Remark) -> Message:
    """A sentence of the terminal on what is not proved."""
    phrase = Message(_DOUBTS[remark.doubt])
    return Message("[[told]] ([[about]])", told=phrase, about=worded(remark.about)) if remark.about else phrase


def stable_words(verdicts: Iterable[Verdict | None]) -> str:
    """``2``, or ``2, 1 undecided``: what nothing decides is not silently one of those that are not stable."""
    known = list(verdicts)
    stable = sum(x is not None and x.stable for x in known)
    open_ = sum(x is None or x.word.open for x in known)
    return Message("[[stable]], [[undecided]] undecided", stable=stable, undecided=open_) if open_ else str(stable)
