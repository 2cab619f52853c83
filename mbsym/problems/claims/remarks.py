"""What is said of a claimed condition: codes with data, each of which was computed, and their sentences."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import Enum, auto


class Said(Enum):
    """A code; what stands in brackets are its data."""

    FOLLOWS_FROM_SIGNS = auto()  # (what is known)
    NEVER_HOLDS = auto()  # (what is known)
    IS = auto()  # (condition, whose, note)
    FOLLOWS = auto()  # (labels of conditions)
    UNSTABLE_WITHOUT = auto()
    UNSTABLE_BEYOND = auto()  # but for the case of equality
    UNSTABLE_INSIDE = auto()  # but where another condition is an equality
    FOR_EXPONENTIAL = auto()  # (of which coordinates, "" of all; note)
    GROWS_WITH_EQUALITY = auto()
    STABLE_WITH_EQUALITY = auto()
    STABLE_IN_FIRST_WITH_EQUALITY = auto()
    EQUALITY_OPEN = auto()
    EQUAL_AT_VALUES = auto()  # (verdict)
    GROWTH_LEAVES_OPEN = auto()
    NEVER_STABLE = auto()  # (verdict)
    NOT_NECESSARY = auto()
    NOT_NECESSARY_IN_FIRST = auto()
    NOT_SUFFICIENT = auto()  # (how many conditions of one place)
    WITH_IT = auto()  # (how many, note, verdict)
    FIRST_WITH_IT = auto()  # (how many)
    NOT_PROVED_SUFFICIENT = auto()  # (how many conditions of one place)
    NOT_PROVED_NECESSARY = auto()
    NONE_STABLE = auto()  # (how many were tried where it fails)
    NONE_UNSTABLE = auto()  # (how many were tried where it holds)
    NOT_TRIED = auto()


@dataclass(frozen=True)
class Remark:
    """A code with its data."""

    code: Said
    data: tuple[object, ...] = ()


def said(code: Said, *data: object) -> Remark:
    return Remark(code, data)


def _subject(number: object) -> str:
    return "it" if number == 1 else "the conditions of this place together"


def _is(number: object) -> str:
    return "is" if number == 1 else "are"


_SENTENCES: dict[Said, str | Callable[..., str]] = {
    Said.FOLLOWS_FROM_SIGNS: "it follows from {}".format,
    Said.NEVER_HOLDS: "with {} it never holds".format,
    Said.IS: lambda label, whose, note: f"it is the condition {label} of {whose}{note}",
    Said.FOLLOWS: "it follows from {}".format,
    Said.UNSTABLE_WITHOUT: "without it the motion is unstable",
    Said.UNSTABLE_BEYOND: "without it, but for the case of equality, the motion is unstable",
    Said.UNSTABLE_INSIDE: "without it, but where a condition of problem 6 is an equality, the motion is unstable",
    Said.FOR_EXPONENTIAL: lambda whose, note: (
        f"it is necessary for exponential stability{f' of {whose}' if whose else ''} (all roots to the left){note}"
    ),
    Said.GROWS_WITH_EQUALITY: "with equality solutions grow: the equations are linear",
    Said.STABLE_WITH_EQUALITY: "with equality, too, the motion may be stable",
    Said.STABLE_IN_FIRST_WITH_EQUALITY: "with equality, too, the first approximation may be stable",
    Said.EQUALITY_OPEN: "where it is an equality, nothing is proved in general",
    Said.EQUAL_AT_VALUES: (
        "where it is an equality nothing is proved but at the given values: there the motion is {}".format
    ),
    Said.GROWTH_LEAVES_OPEN: (
        "with equality the first approximation has solutions that grow; whether the motion is stable there, terms of "
        "higher order decide, if there are any"
    ),
    Said.NEVER_STABLE: lambda verdict, borders: (
        f"the motion is {verdict}: as it is stable {'nowhere else' if borders else 'for no parameters'}, any condition "
        "would be necessary, and it says nothing"
    ),
    Said.NOT_NECESSARY: "it is not necessary for stability",
    Said.NOT_NECESSARY_IN_FIRST: "it is not necessary for stability in the first approximation",
    Said.NOT_SUFFICIENT: lambda n: f"{_subject(n)} {_is(n)} not sufficient for stability",
    Said.WITH_IT: lambda n, note, verdict: (
        f"with {'it' if n == 1 else 'the conditions of this place together'}{note} the motion is {verdict}"
    ),
    Said.FIRST_WITH_IT: lambda n: (
        f"in the first approximation {_subject(n)} suffice{'s' if n == 1 else ''}; whether the motion itself is stable "
        "is open"
    ),
    Said.NOT_PROVED_SUFFICIENT: lambda n: f"{_subject(n)} {_is(n)} neither proved sufficient nor refuted",
    Said.NOT_PROVED_NECESSARY: "it is neither proved necessary nor refuted",
    Said.NONE_STABLE: lambda n: (
        f"parameters that were tried where it fails: {n}, at none of them is the motion known to be stable"
    ),
    Said.NONE_UNSTABLE: lambda n: (
        f"parameters that were tried where it holds: {n}, at none of them is the motion known to be unstable"
    ),
    Said.NOT_TRIED: "no parameters could be tried",
}


def sentence(remark: Remark) -> str:
    found = _SENTENCES[remark.code]
    return found if isinstance(found, str) else found(*remark.data)


def words(remarks: Iterable[Remark]) -> str:
    """Their sentences, one after another."""
    return "; ".join(map(sentence, remarks))
