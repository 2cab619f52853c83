"""The words of branches of equilibria: events, what is not proved, and what a picture's legend says."""

from __future__ import annotations

from collections.abc import Iterable

from mbsym.maps.branches_events import Event
from mbsym.maps.branches_result import Branches, Critical, Doubt, Remark
from mbsym.problems.stability.verdict import Verdict
from mbsym.report.language import Language

ENGLISH = Language()

EVENTS = {
    Event.FOLD: "fold",
    Event.STEEP: "vertical tangent",
    Event.TRANSCRITICAL: "transcritical point",
    Event.ISOLATED: "isolated point",
    Event.PITCHFORK: "pitchfork",
    Event.CONTINUUM: "infinitely many equilibria at one value",
    Event.DEGENERATE: "degenerate point, not named",
}

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
_CHANGE = "the verdict of a branch changes"
_DIFFER = "the verdicts at the samples on both sides differ"


def event_words(events: Iterable[Event], language: Language = ENGLISH) -> str:
    """``2 x fold, pitchfork``."""
    listed = list(events)
    told = []
    for event in dict.fromkeys(listed):
        words = language.say(EVENTS[event])
        told.append(f"{listed.count(event)} x {words}" if listed.count(event) > 1 else words)
    return ", ".join(told)


def critical_words(found: Branches, one: Critical, language: Language = ENGLISH) -> str:
    """What happens at a critical value; "" for nothing that is shown."""
    if one.balance is False:
        return language.say(EVENTS[Event.DEGENERATE])
    parts = [event_words(one.events, language)] if one.events else []
    if found.leaves(one) and not one.continuum:
        parts.append(language.say(_BORDER))
    if found.verdict_changes(one) and not parts and not found.count_changes(one):
        parts.append(language.say(_CHANGE if found.certain(one) else _DIFFER))
    if not parts and found.happens(one):
        parts.append(language.say(EVENTS[Event.DEGENERATE]))
    return ", ".join(parts)


def remark_words(one: Remark) -> str:
    """A sentence of the terminal on what is not proved."""
    return _DOUBTS[one.doubt] + (f" ({one.about})" if one.about else "")


def stable_words(verdicts: Iterable[Verdict | None]) -> str:
    """``2``, or ``2, 1 undecided``: what nothing decides is not silently one of those that are not stable."""
    known = list(verdicts)
    stable = sum(x is not None and x.stable for x in known)
    open_ = sum(x is None or x.word.open for x in known)
    return f"{stable}, {open_} undecided" if open_ else f"{stable}"
