"""What became of claims."""

from __future__ import annotations

from typing import Annotated

from msgspec import UNSET, Meta, UnsetType

from mbsym.model.claims import CLAIMS
from mbsym.problems.claims.result import Outcome
from mbsym.report.documents.base import From, Part, words
from mbsym.report.documents.parts import Formula


class Counterexample(Part, frozen=True):
    """numbers that refute it"""

    at: Annotated[dict[str, str], "exact values of names"]
    shows: Annotated[dict[str, str], "what comes out there, by name"]


class Repair(Part, frozen=True):
    """an abbreviation with which the claim would be right"""

    abbreviation: Annotated[str, "its name"]
    add: Annotated[Formula, "what has to be added to it"]


class ClaimPart(Part, frozen=True):
    """a part of the difference"""

    of: Annotated[Formula, "the product of velocities, or the power of the variable, that it belongs to"]
    difference: Annotated[Formula, "the difference there"]
    same_as: Annotated[str, "the abbreviation that the difference is; empty where it is none"]
    repairs: Annotated[list[Repair], "abbreviations with which the claim would be right"]


class Claim(Part, frozen=True):
    """a claim of the description and what became of it"""

    kind: Annotated[str, words(*CLAIMS), "what is claimed", From("claim.kind")]
    of: Annotated[str, "the coordinate, body or quantity it is about; empty where there is none", From("claim.of")]
    entry: Annotated[list[Annotated[int, Meta(ge=1)]], "indices, counted from 1", From("claim.entry")]
    place: Annotated[str, "where it is printed"]
    title: Annotated[str, "what it is about, in words"]
    word: Annotated[str, words("held", "refuted", "undecided"), "the outcome in one word"]
    outcome: Annotated[str, words(*(x.value for x in Outcome)), "the outcome"]
    role: Annotated[
        str | UnsetType,
        words("necessary", "sufficient"),
        "what a condition is said to be of stability, if it is said",
        From("claim.role"),
    ] = UNSET
    claimed: Annotated[Formula | UnsetType, "what is claimed, as it is printed"] = UNSET
    derived: Annotated[Formula | UnsetType, "what is derived", From()] = UNSET
    difference: Annotated[Formula | UnsetType, "by what they differ; difference_is says which difference", From()] = (
        UNSET
    )
    difference_is: Annotated[
        str | UnsetType,
        words("claimed - derived", "claimed - factor*derived", "dI/dt on the equations of motion"),
        "what the difference is",
    ] = UNSET
    factor: Annotated[
        Formula | UnsetType,
        "claimed/derived where one is a multiple of the other; else the factor of difference_is",
        From(),
    ] = UNSET
    value: Annotated[str | UnsetType, "the derived number, to more digits than the claim has", From()] = UNSET
    digits_right: Annotated[int | UnsetType, "digits of the printed number that hold", Meta(ge=0), From("digits")] = (
        UNSET
    )
    digits_printed: Annotated[int | UnsetType, "digits that it has", Meta(ge=0), From("printed_digits")] = UNSET
    remark: Annotated[str | UnsetType, "what else there is to say, in a sentence", From()] = UNSET
    where: Annotated[str | UnsetType, "the signs to which the outcome is restricted", From()] = UNSET
    counterexample: Annotated[Counterexample | UnsetType, From()] = UNSET
    parts: Annotated[list[ClaimPart] | UnsetType, "the difference taken apart"] = UNSET
