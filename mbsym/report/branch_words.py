"""The words of branches of equilibria: events, what is not proved, and what a picture's legend says."""

from __future__ import annotations

from collections.abc import Iterable

from mbsym.expressions.counting import counted
from mbsym.maps.branches_events import Event
from mbsym.maps.branches_result import Branches, Critical, Doubt, Remark
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

_RUSSIAN = {
    EVENTS[Event.FOLD]: "складка",
    EVENTS[Event.STEEP]: "вертикальная касательная",
    EVENTS[Event.TRANSCRITICAL]: "транскритическая точка",
    EVENTS[Event.ISOLATED]: "изолированная точка",
    EVENTS[Event.PITCHFORK]: "вилка",
    EVENTS[Event.CONTINUUM]: "бесконечно много равновесий при одном значении",
    EVENTS[Event.DEGENERATE]: "вырожденная точка, без названия",
    _BORDER: "равновесия на бесконечности или на границе (корень или знаменатель нуль, либо матрица масс вырождена)",
    _CHANGE: "вывод об устойчивости ветви меняется",
    _DIFFER: "выводы в пробных точках по обе стороны различны",
    "stable": "устойчивые",
    "unstable": "неустойчивые",
    "undecided, or not proved throughout": "не решено или доказано не всюду",
    "Relative equilibria of": "Относительные равновесия:",
    "equilibria": "равновесий",
    "Critical values:": "Критические значения:",
    "Numbers of equilibria:": "Числа равновесий:",
    "of them stable": "из них устойчивых",
    "not proved to be constant": "постоянство не доказано",
}

_SPANISH = {
    EVENTS[Event.FOLD]: "pliegue",
    EVENTS[Event.STEEP]: "tangente vertical",
    EVENTS[Event.TRANSCRITICAL]: "punto transcrítico",
    EVENTS[Event.ISOLATED]: "punto aislado",
    EVENTS[Event.PITCHFORK]: "horquilla",
    EVENTS[Event.CONTINUUM]: "infinitos equilibrios en un solo valor",
    EVENTS[Event.DEGENERATE]: "punto degenerado, sin nombre",
    _BORDER: "equilibrios en el infinito o en un borde (raíz o denominador nulo, o matriz de masas singular)",
    _CHANGE: "cambia el veredicto de una rama",
    _DIFFER: "los veredictos en las muestras de ambos lados difieren",
    "stable": "estables",
    "unstable": "inestables",
    "undecided, or not proved throughout": "indeciso, o no demostrado en todo el intervalo",
    "Relative equilibria of": "Equilibrios relativos de",
    "equilibria": "equilibrios",
    "Critical values:": "Valores críticos:",
    "Numbers of equilibria:": "Números de equilibrios:",
    "of them stable": "de ellos estables",
    "not proved to be constant": "no se ha demostrado que sea constante",
}

WORDS = {"ru": _RUSSIAN, "es": _SPANISH}


def say(language: Language, english: str) -> str:
    """A phrase of branches in a language."""
    return WORDS.get(language.name, {}).get(english, english)


def event_words(events: Iterable[Event], language: Language = ENGLISH) -> str:
    """``2 x fold, pitchfork``."""
    listed = list(events)
    told = []
    for event in dict.fromkeys(listed):
        words = say(language, EVENTS[event])
        told.append(f"{listed.count(event)} x {words}" if listed.count(event) > 1 else words)
    return ", ".join(told)


def critical_words(found: Branches, one: Critical, language: Language = ENGLISH) -> str:
    """What happens at a critical value; "" for nothing that is shown."""
    if one.balance is False:
        return say(language, EVENTS[Event.DEGENERATE])
    parts = [event_words(one.events, language)] if one.events else []
    if found.leaves(one) and not one.continuum:
        parts.append(say(language, _BORDER))
    if found.verdict_changes(one) and not parts and not found.count_changes(one):
        parts.append(say(language, _CHANGE if found.certain(one) else _DIFFER))
    if not parts and found.happens(one):
        parts.append(say(language, EVENTS[Event.DEGENERATE]))
    return ", ".join(parts)


def remark_words(one: Remark) -> str:
    """A sentence of the terminal on what is not proved."""
    return _DOUBTS[one.doubt] + (f" ({one.about})" if one.about else "")


def count_words(count: int, stable: int) -> str:
    """``4 equilibria, 2 stable``."""
    return f"{counted(count, 'equilibrium', 'equilibria')}, {stable} stable"
