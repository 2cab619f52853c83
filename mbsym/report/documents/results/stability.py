"""Problem 6."""

from __future__ import annotations

from typing import Annotated

from msgspec import UNSET, Meta, UnsetType

from mbsym.problems.stability.requirements import Method, Place
from mbsym.problems.stability.words import Word
from mbsym.report.documents.base import From, Part, counted_from, told_apart_by, words
from mbsym.report.documents.parts import Formula, TheoremName, Verdict


class Statement(Part, frozen=True):
    """formula relation 0"""

    label: Annotated[str, "its name: v2, discriminant, minor 1 of K"]
    formula: Annotated[Formula | None, "what stands in relation to 0; null where it is too long to be written out"]
    relation: Annotated[str, words(">", ">=", "<", "<=", "!="), "how the formula stands to 0"]
    never: Annotated[bool, "whether it is known that it cannot hold"]


class InCoefficients(Part, frozen=True):
    """a long condition in the coefficients of the characteristic polynomial (or of a factor of it): its sign is that
    of the formula
    """

    formula: Annotated[str, "what stands in the same relation to 0"]
    coefficients: Annotated[dict[str, str], "each coefficient of it by its name: v4 at lambda^4, a3 at lambda^3"]


class Condition(Statement, frozen=True, kw_only=True):
    """a condition of stability: formula relation 0"""

    in_coefficients: InCoefficients | UnsetType = UNSET
    place: Annotated[
        str,
        words(Place),
        "what follows where it fails: necessary (but for the case of equality: unstable), first (necessary in the "
        "first approximation), exponential (necessary for exponential stability: all roots to the left; at the border "
        "the motion may still be asymptotically stable), sufficient (nothing), method (this method decides nothing "
        "then), harmless (nothing: a vanishing discriminant of a potential system), strictly (necessary: with equality "
        "the motion is unstable, too), beside (with equality, the other conditions holding, the motion is unstable), "
        "equality (with equality, the other conditions holding, the motion is stable, too), merely (with equality, the "
        "other conditions holding, the motion is stable, but not asymptotically)",
    ]


class Listed(Part, frozen=True):
    """a condition of the list"""

    listed: Annotated[str, "its label there"]
    relation: Annotated[str, words(">", ">=", "<", "<=", "!="), "how its formula stands to 0 here"]


class Case(Part, frozen=True):
    """if all of all_of and, unless it is empty, one of any_of hold: the verdict"""

    all_of: Annotated[
        list[
            Annotated[
                Listed | Statement,
                "a condition of a case: one of the list by its label, with its relation to 0 here, or one of its own",
            ]
        ],
        "conditions that all hold",
    ]
    any_of: Annotated[
        list[
            Annotated[
                Listed | Statement,
                "a condition of a case: one of the list by its label, with its relation to 0 here, or one of its own",
            ]
        ],
        "conditions of which one holds",
    ]
    otherwise: Annotated[bool, "whether nothing is required but that the cases before do not apply"]
    verdict: Annotated[Word, "what is proved then", From("word")]
    theorems: Annotated[list[TheoremName], "the theorems that prove it"]


class StabilitySubsystem(Verdict, frozen=True):
    """a decoupled part"""

    coordinates: Annotated[list[str], "its coordinates"]
    variable: Annotated[str, "the variable of its characteristic polynomial"]
    characteristic_polynomial: Annotated[
        list[Formula], "coefficients, that of the zeroth power first", counted_from(0), From("characteristic")
    ]
    method: Annotated[
        str,
        words(Method),
        "even: all squares of roots real, negative, simple; hurwitz: all roots to the left (Lienard-Chipart); none",
        From("theory.method"),
    ]
    conditions: Annotated[list[Condition], "conditions that are not known to hold", told_apart_by("label")]
    cases: Annotated[list[Case], "read in order, like if and elif"]


class Root(Part, frozen=True):
    """a root, or with an imaginary part a pair of conjugates"""

    real: Annotated[float, "real part"]
    imaginary: Annotated[float, "imaginary part, not negative"]
    multiplicity: Annotated[int, "multiplicity", Meta(ge=1)]


class Spectrum(Part, frozen=True):
    """of one decoupled part"""

    coordinates: Annotated[list[str], "its coordinates"]
    roots: Annotated[list[Root], "its roots"]


class Stability(Verdict, frozen=True):
    """problem 6"""

    at_values: Annotated[
        Verdict | None, "the verdict at the description's values; null where it has none", From("numerical")
    ]
    subsystems: Annotated[list[StabilitySubsystem], "decoupled parts", told_apart_by("coordinates")]
    eigenvalues_at_values: Annotated[
        list[Spectrum], "eigenvalues at the description's values, as doubles", told_apart_by("coordinates")
    ]
