"""What is said of a claimed condition: codes with data, each of which was computed, and their sentences."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from enum import member, unique
from typing import Any

from mbsym.expressions.message import Code, Message, enumerated, joined
from mbsym.expressions.tree import Expression, Name


def _several(singular: str, plural: str) -> Any:
    """By how many conditions of a place there are."""
    return member(lambda number, *_: singular if number == 1 else plural)


def _whether(datum: int, one: str, other: str) -> Any:
    """The first where that datum is not empty, and true."""
    return member(lambda *data: one if data[datum] else other)


@unique
class Said(Code):
    """A code; what stands in brackets are its data."""

    FOLLOWS_FROM_SIGNS = "it follows from [[1]]"  # (what is known)
    NEVER_HOLDS = "with [[1]] it never holds"  # (what is known)
    IS = "it is the condition [[1]] of [[2]][[3]]"  # (condition, whose, note)
    FOLLOWS = "it follows from [[1]][[2]]"  # (conditions, or LABELS of each part; note)
    LABELS = "[[1]] of [[2]]"  # (labels of conditions, coordinates)
    UNSTABLE_WITHOUT = "without it the motion is unstable"
    DRIFTS_WITH_EQUALITY = "with equality coordinates that are cyclic there only drift away, which counts as unstable"
    UNSTABLE_BEYOND = "without it, but for the case of equality, the motion is unstable"
    UNSTABLE_INSIDE = "without it, but where a condition of problem 6 is an equality, the motion is unstable"
    FOR_EXPONENTIAL = _whether(  # (of which coordinates, "" of all; note)
        0,
        "it is necessary for exponential stability of [[1]] (all roots to the left)[[2]]",
        "it is necessary for exponential stability (all roots to the left)[[2]]",
    )
    FOR_DECAY = _whether(  # (the same, where zero roots split off)
        0,
        "it is necessary for all roots of [[1]] but the zero ones to lie to the left[[2]]",
        "it is necessary for all roots but the zero ones to lie to the left[[2]]",
    )
    GROWS_WITH_EQUALITY = "with equality solutions grow: the equations are linear"
    STABLE_WITH_EQUALITY = "with equality, too, the motion may be stable"
    STABLE_IN_FIRST_WITH_EQUALITY = "with equality, too, the first approximation may be stable"
    EQUALITY_OPEN = "where it is an equality, nothing is proved in general"
    EQUAL_AT_VALUES = (  # (verdict)
        "where it is an equality nothing is proved but at the given values: there the motion is [[1]]"
    )
    GROWTH_LEAVES_OPEN = (
        "with equality the first approximation has solutions that grow; whether the motion is stable there, terms of "
        "higher order decide, if there are any"
    )
    NEVER_STABLE = _whether(  # (verdict, whether border cases are open)
        1,
        "the motion is [[1]]: but for these any condition would be necessary, and border cases are left open",
        "the motion is [[1]]: as it is stable for no parameters, any condition would be necessary, and it says nothing",
    )
    NOT_NECESSARY = "it is not necessary for stability"
    NOT_NECESSARY_IN_FIRST = "it is not necessary for stability in the first approximation"
    NOT_SUFFICIENT = _several(
        "it is not sufficient for stability",
        "the conditions of this place together are not sufficient for stability",
    )  # (how many conditions of one place)
    WITH_IT = _several(
        "with it[[2]] the motion is [[3]]", "with the conditions of this place together[[2]] the motion is [[3]]"
    )  # (how many, note, verdict)
    FIRST_WITH_IT = _several(
        "in the first approximation it suffices; whether the motion itself is stable is open",
        "in the first approximation the conditions of this place together suffice; whether the motion itself is stable "
        "is open",
    )  # (how many)
    NOT_PROVED_SUFFICIENT = _several(
        "it is neither proved sufficient nor refuted",
        "the conditions of this place together are neither proved sufficient nor refuted",
    )  # (how many conditions of one place)
    NOT_PROVED_NECESSARY = "it is neither proved necessary nor refuted"
    NONE_STABLE = (  # (how many were tried where it fails)
        "parameters that were tried where it fails: [[1]], at none of them is the motion known to be stable"
    )
    NONE_UNSTABLE = (  # (how many were tried where it holds)
        "parameters that were tried where it holds: [[1]], at none of them is the motion known to be unstable"
    )
    NOT_TRIED = "no parameters could be tried"


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


def sentence(remark: Remark) -> Message:
    """Its sentence."""
    return remark.code.said(*remark.data, told=_told)


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
