"""What is said of a claimed condition: codes with data, each of which was computed, and their sentences."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import Enum, auto

from mbsym.expressions.message import Message, enumerated, joined
from mbsym.expressions.tree import Expression, Name


class Said(Enum):
    """A code; what stands in brackets are its data."""

    FOLLOWS_FROM_SIGNS = auto()  # (what is known)
    NEVER_HOLDS = auto()  # (what is known)
    IS = auto()  # (condition, whose, note)
    FOLLOWS = auto()  # (conditions, or LABELS of each part; note)
    LABELS = auto()  # (labels of conditions, coordinates)
    UNSTABLE_WITHOUT = auto()
    DRIFTS_WITH_EQUALITY = auto()  # along coordinates that are cyclic there only
    UNSTABLE_BEYOND = auto()  # but for the case of equality
    UNSTABLE_INSIDE = auto()  # but where another condition is an equality
    FOR_EXPONENTIAL = auto()  # (of which coordinates, "" of all; note)
    FOR_DECAY = auto()  # (the same, where zero roots split off)
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


def named(coordinates: Iterable[str]) -> Message:
    """Coordinates one after another, each as a name."""
    return joined(map(Name, coordinates), ", ")


def letter(label: str) -> str | Name:
    """The label of a coefficient (v4, a0) as a name; the others are words."""
    return Name(str(label)) if re.fullmatch(r"[av]\d+", label) else label


def _several(singular: str, plural: str) -> Callable[..., str]:
    """By how many conditions of a place there are."""
    return lambda number, *_: singular if number == 1 else plural


#: Sentences with gaps for the data, or what finds one by the data.
_SENTENCES: dict[Said, str | Callable[..., str]] = {
    Said.FOLLOWS_FROM_SIGNS: "it follows from [[1]]",
    Said.NEVER_HOLDS: "with [[1]] it never holds",
    Said.IS: "it is the condition [[1]] of [[2]][[3]]",
    Said.FOLLOWS: "it follows from [[1]][[2]]",
    Said.LABELS: "[[1]] of [[2]]",
    Said.UNSTABLE_WITHOUT: "without it the motion is unstable",
    Said.DRIFTS_WITH_EQUALITY: "with equality coordinates that are cyclic there only drift away, which counts as "
    "unstable",
    Said.UNSTABLE_BEYOND: "without it, but for the case of equality, the motion is unstable",
    Said.UNSTABLE_INSIDE: "without it, but where a condition of problem 6 is an equality, the motion is unstable",
    Said.FOR_EXPONENTIAL: lambda whose, note: (
        "it is necessary for exponential stability of [[1]] (all roots to the left)[[2]]"
        if whose
        else "it is necessary for exponential stability (all roots to the left)[[2]]"
    ),
    Said.FOR_DECAY: lambda whose, note: (
        "it is necessary for all roots of [[1]] but the zero ones to lie to the left[[2]]"
        if whose
        else "it is necessary for all roots but the zero ones to lie to the left[[2]]"
    ),
    Said.GROWS_WITH_EQUALITY: "with equality solutions grow: the equations are linear",
    Said.STABLE_WITH_EQUALITY: "with equality, too, the motion may be stable",
    Said.STABLE_IN_FIRST_WITH_EQUALITY: "with equality, too, the first approximation may be stable",
    Said.EQUALITY_OPEN: "where it is an equality, nothing is proved in general",
    Said.EQUAL_AT_VALUES: (
        "where it is an equality nothing is proved but at the given values: there the motion is [[1]]"
    ),
    Said.GROWTH_LEAVES_OPEN: (
        "with equality the first approximation has solutions that grow; whether the motion is stable there, terms of "
        "higher order decide, if there are any"
    ),
    Said.NEVER_STABLE: lambda verdict, borders: (
        "the motion is [[1]]: but for these any condition would be necessary, and border cases are left open"
        if borders
        else "the motion is [[1]]: as it is stable for no parameters, any condition would be necessary, and it says "
        "nothing"
    ),
    Said.NOT_NECESSARY: "it is not necessary for stability",
    Said.NOT_NECESSARY_IN_FIRST: "it is not necessary for stability in the first approximation",
    Said.NOT_SUFFICIENT: _several(
        "it is not sufficient for stability",
        "the conditions of this place together are not sufficient for stability",
    ),
    Said.WITH_IT: _several(
        "with it[[2]] the motion is [[3]]", "with the conditions of this place together[[2]] the motion is [[3]]"
    ),
    Said.FIRST_WITH_IT: _several(
        "in the first approximation it suffices; whether the motion itself is stable is open",
        "in the first approximation the conditions of this place together suffice; whether the motion itself is stable "
        "is open",
    ),
    Said.NOT_PROVED_SUFFICIENT: _several(
        "it is neither proved sufficient nor refuted",
        "the conditions of this place together are neither proved sufficient nor refuted",
    ),
    Said.NOT_PROVED_NECESSARY: "it is neither proved necessary nor refuted",
    Said.NONE_STABLE: (
        "parameters that were tried where it fails: [[1]], at none of them is the motion known to be stable"
    ),
    Said.NONE_UNSTABLE: (
        "parameters that were tried where it holds: [[1]], at none of them is the motion known to be unstable"
    ),
    Said.NOT_TRIED: "no parameters could be tried",
}


def text(remark: Remark) -> str:
    """Its sentence, with gaps ``[[1]]``, ... for its data."""
    template = _SENTENCES[remark.code]
    return template if isinstance(template, str) else template(*remark.data)


def sentence(remark: Remark) -> Message:
    """Its sentence."""
    template = text(remark)
    return Message(template, **{str(k): _told(x) for k, x in enumerate(remark.data, start=1) if f"[[{k}]]" in template})


def _told(value: object) -> str | Expression:
    if isinstance(value, Remark):
        return sentence(value)
    if isinstance(value, tuple):
        remarks = [sentence(x) for x in value if isinstance(x, Remark)]
        return enumerated(remarks) if remarks else joined(map(_told, value), ", ")
    return value if isinstance(value, str | Expression) else str(value)


def words(remarks: Iterable[Remark]) -> Message:
    """Their sentences, one after another."""
    return joined(map(sentence, remarks), "; ")
