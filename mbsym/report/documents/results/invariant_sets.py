"""Problem 10."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta

from mbsym.problems.invariant_sets.result import Definiteness, Kind
from mbsym.report.documents.base import From, Part, words


class NamedFormula(Part, frozen=True):
    """an integral"""

    name: Annotated[str, "its name"]
    formula: Annotated[str, "its formula"]


class SignCondition(Part, frozen=True):
    """a condition"""

    formula: Annotated[str, "what is compared with zero"]
    relation: Annotated[str, words(">", ">=", "!=", "="), "the relation to zero"]
    unless_zero: Annotated[list[str], "where one of these vanishes the condition is not needed", From("unless")]


class SecondVariation(Part, frozen=True):
    """a second variation"""

    outcome: Annotated[Definiteness, "what it says"]
    size: Annotated[int, "number of its variables", Meta(ge=0)]
    positive: Annotated[
        list[SignCondition] | None, "conditions for K to be positive definite; null where that is impossible"
    ]
    negative: Annotated[
        list[SignCondition] | None, "conditions for K to be negative definite; null where that is impossible"
    ]
    for_some_value_of: Annotated[list[str], "free multipliers in the conditions", From("chosen")]


class FirstApproximation(Part, frozen=True):
    """a first approximation"""

    zero_roots: Annotated[int, "how many roots vanish", Meta(ge=0), From("zeros")]
    factors_in_lambda_squared: Annotated[
        list[Annotated[list[str], "a factor"]],
        "factors of the others, coefficients from the constant one on",
        From("factors"),
    ]
    necessary: Annotated[list[SignCondition], "conditions without which the motion is unstable"]
    unstable: Annotated[bool, "whether it is unstable for all parameters"]
    complete: Annotated[bool, "whether all necessary conditions of the first approximation are listed"]
    roots_left_out: Annotated[
        int, "so many roots belong to factors that are not even and are not listed", Meta(ge=0), From("left")
    ]


class InvariantSet(Part, frozen=True):
    """a stationary set of the family"""

    kind: Annotated[Kind, "what moves on it"]
    dimension: Annotated[int, "for fixed multipliers", Meta(ge=0)]
    dimension_of_union: Annotated[int, "of the union over all multipliers", Meta(ge=0), From("union")]
    solved: Annotated[dict[str, str], "variables by name, in terms of what is free"]
    relations: Annotated[list[str], "polynomials that vanish on it besides"]
    nonzero: Annotated[list[str], "what does not vanish on it"]
    free: Annotated[list[str], "variables that are free, but for the relations"]
    multipliers: Annotated[dict[str, str | None], "multipliers by name; null where they are free"]
    motion: Annotated[dict[str, str], "derivatives of the free variables on it"]
    invariant: Annotated[
        str, words("proved", "undecided", "failed"), "how it is known to be invariant", From("invariance")
    ]
    real_point_found: Annotated[
        bool, "whether a real point was found at parameters that the description allows", From("real")
    ]
    second_variation: Annotated[
        SecondVariation | None, "definiteness of K: sufficient conditions of stability", From("proved_variation")
    ]
    first_approximation: Annotated[
        FirstApproximation | None, "roots of the first approximation at a steady motion", From("first")
    ]
    gap: Annotated[
        Literal["found", "none found", "untried"],
        "whether parameters were found at which the necessary conditions hold and the sufficient ones do not",
    ]


class Family(Part, frozen=True):
    """a family"""

    integrals: Annotated[list[str], "names of its integrals"]
    multipliers: Annotated[list[str], "names of its multipliers"]
    complete: Annotated[bool, "whether no branch was left aside"]
    sets: Annotated[list[InvariantSet], "its stationary sets"]


class InvariantSets(Part, frozen=True):
    """problem 10: stationary sets of families of integrals"""

    integrals: Annotated[list[NamedFormula], "what the families are made of"]
    left_out: Annotated[
        list[str], "names of integrals that families do not hold: functions of those that they do, at a random state"
    ]
    relations: Annotated[list[str], "polynomials that vanish on all states"]
    stand_for: Annotated[
        dict[str, str], "variables that stand for something else: sin_theta for sin(theta)", From("written")
    ]
    inputs: Annotated[dict[str, str], "the constant values of the inputs for which all of this is so"]
    families: Annotated[list[Family], "K = first integral + sum multiplier * integral"]
    provided_nonzero: Annotated[
        list[str], "polynomials in the parameters that were taken not to vanish", From("generic")
    ]
