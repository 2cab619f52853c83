"""What several files hold."""

from __future__ import annotations

from typing import Annotated, Any

from flint import fmpq
from msgspec import Meta

from mbsym.problems.stability.words import THEOREMS, Because, HigherOrder, Word
from mbsym.report.documents.base import ASIDE, SHA256, From, Named, Part, Write, or_null, words


class Counted(Part, frozen=True):
    """a formula that is not written out"""

    terms: Annotated[int, "terms of the expanded normal form", Meta(ge=1)]
    sha256: Annotated[str, "digest of the normal form: equal ones mean equal formulas", SHA256]


Formula = Annotated[
    Annotated[str, Meta(min_length=1)] | Counted,
    "An exact formula in Python syntax with the declared names; theta_dot is a velocity, theta_ddot an acceleration. "
    "Of a formula that is too long to be written out, its length and a digest of its normal form.",
    Named("formula"),
]

TheoremName = Annotated[
    str,
    words(*(theorem.name for theorem in THEOREMS), *(theorem.value for theorem in HigherOrder if theorem.value)),
    "a theorem of stability, by its name",
]


class Reason(Part, frozen=True):
    """a reason"""

    code: Annotated[str, words(Because), "what the reason is"]
    data: Annotated[
        list[str | int],
        "the numbers, names and formulas that it is about, in the order of the sentence",
        From(by=lambda data: [x if isinstance(x, int) else str(x) for x in data]),
    ]


class Verdict(Part, frozen=True):
    """its stability"""

    verdict: Annotated[Word, "what is proved of the motion, in the words of every output", From("word")]
    theorems: Annotated[list[TheoremName], "the theorems that prove it; none where none applies"]
    reasons: Annotated[list[Reason], "why, as codes with data"]
    explanation: Annotated[str, "the reasons in sentences", ASIDE]


class Axis(Part, frozen=True):
    """an axis"""

    name: Annotated[str, "a parameter; in maps that may be a symbol of the notation"]
    low: Annotated[str, "exact lower end"]
    high: Annotated[str, "exact upper end"]


class Number(Part, frozen=True):
    """an exact number"""

    @classmethod
    def from_result(cls, source: Any, write: Write = str, /, **fields: Any) -> Number:
        """A rational number as text, an algebraic one by its minimal polynomial and an interval with no other root."""
        from mbsym.algebra.plane.numbers import AlgebraicNumber, enclosure

        if isinstance(source, fmpq):
            return cls(exact=str(source), polynomial=None, between=None, number=float(enclosure(source).mid()))
        polynomial = [str(c) for c in source.polynomial.coeffs()] if isinstance(source, AlgebraicNumber) else None
        between = [str(source.low), str(source.high)]
        return cls(exact=None, polynomial=polynomial, between=between, number=float(source.enclosure(64).mid()))

    exact: Annotated[str | None, "the number where it is rational; null where it is irrational"]
    polynomial: Annotated[
        list[str] | None,
        "of an algebraic number: integer coefficients of its minimal polynomial, from low to high powers; nothing "
        "where it is rational, or given over the field of the other coordinate",
    ]
    between: Annotated[list[str] | None, "of an algebraic number: rational ends of an interval with this root alone"]
    number: Annotated[float, "the number in double precision"]


class CoordinateValue(Part, frozen=True):
    """a coordinate's value"""

    name: Annotated[str, "the coordinate"]
    value: Annotated[str, "the value as text: exact where exact is true", From("text")]
    exact: Annotated[bool, "whether the text is exact"]
    number: Annotated[float, "the value as a double", From("value")]


Coordinates = Annotated[list[CoordinateValue], "constant coordinates", From("values")]
AnglesOf = Annotated[
    str | None, "the body whose other angles these are; null for the description's own", From("coordinates_of", or_null)
]
