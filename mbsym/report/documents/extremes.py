"""``extremes.json`` of ``mbsym extremes``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any

from msgspec import UNSET, UnsetType

from mbsym.problems.stability.words import Word
from mbsym.report.documents.base import From, Head, Part, words
from mbsym.report.documents.parts import TheoremName

if TYPE_CHECKING:
    from mbsym.numerics.extremes.singular import Value


def _labels(values: Sequence[Value]) -> list[str]:
    return [value.label for value in values]


def _rounded(digits: Any) -> Any:
    return {name: round(x, 2) for name, x in digits.items()} if isinstance(digits, Mapping) else round(digits, 2)


class Set(Part, frozen=True):
    """one set, whatever the coordinates are that it does not name"""

    names: Annotated[list[str], "the coordinates that decide"]
    values: Annotated[
        list[str], "values of the one coordinate, exact where they are multiples of pi or rational", From(by=_labels)
    ]
    equation: Annotated[str, "a factor of det M that vanishes there"]
    places: Annotated[list[dict[str, float]], "points of the set"]
    finite: Annotated[bool, "of several coordinates: there are no other points"]
    fails: Annotated[
        str, words("coordinates", "model", "coordinates and model", "not told apart"), "what fails there", From("kind")
    ]
    joint: Annotated[str, "the body two of whose turns are about one axis there, or empty"]
    proved: Annotated[bool, "whether that is proved, not found by a search"]


class Singular(Part, frozen=True):
    """configurations at which the mass matrix is singular; null where they could not be sought"""

    complete: Annotated[bool, "proved that there are no others, coordinates within their ranges"]
    how: Annotated[str, "what proves it, or what was searched instead"]
    ranges: Annotated[
        dict[str, float], "largest absolute values of coordinates that were looked at, where it depends on them"
    ]
    undecided: Annotated[list[str], "factors of det M of which it is not known whether they vanish"]
    sets: Annotated[list[Set], "singular sets"]


class SingularPosition(Part, frozen=True):
    place: Annotated[dict[str, float], "values of the coordinates"]
    labels: Annotated[dict[str, str], "the same as text, exact where that is proved"]
    rank: Annotated[int, "rows that are independent there"]
    usual: Annotated[int, "rows that are independent elsewhere"]
    proved: Annotated[bool, "whether position and rank are decided by rational arithmetic, not to roundings"]
    family: Annotated[bool, "whether there are others next to it, as singular values tell"]


class SingularPositions(Part, frozen=True):
    """positions in which constraints lose their rank, as a search found them; only with constraints"""

    starts: Annotated[int, "random positions that the search began from"]
    more: Annotated[bool, "whether more were found than are listed"]
    found: Annotated[list[SingularPosition], "the positions"]


class Eigenvalue(Part, frozen=True):
    """an eigenvalue, within radius of the number given, in each part"""

    real: Annotated[float, "real part"]
    imaginary: Annotated[float, "imaginary part"]
    radius: Annotated[float, "how far the true parts may lie from those before they were rounded to doubles"]


class Compensated(Part, frozen=True):
    """one rung, or the given values (subject empty)"""

    subject: Annotated[str, "the parameter that is extreme, or empty"]
    size: Annotated[float, "the factor"]
    operations_in_pairs: Annotated[int, "how many operations", From("compensation.sensitive")]
    digits_without: Annotated[
        float, "fewest digits of the plain kernel at the states looked at", From("compensation.before", _rounded)
    ]
    digits_with: Annotated[float, "fewest digits of the kernel that is used", From("compensation.after", _rounded)]
    cost: Annotated[
        float, "operations, as a multiple of the plain kernel's", From("compensation.cost", lambda cost: round(cost, 3))
    ]


class Row(Part, frozen=True):
    """one quantity on one rung of a ladder"""

    kind: Annotated[str, "the kind of ladder"]
    subject: Annotated[str, "what is extreme"]
    size: Annotated[float, "how extreme"]
    quantity: Annotated[str, "the quantity"]
    digits: Annotated[dict[str, float], "correct digits, by arithmetic", From("digits.digits", _rounded)]
    digits_of_worst_entry: Annotated[dict[str, float], "correct digits, by arithmetic", From("digits.worst", _rounded)]
    formula_digits: Annotated[
        float, "digits that the formula loses beyond the question, float64", From("digits.formula", _rounded)
    ]
    condition: Annotated[float | None, "condition of the question; null where it is infinite", From("digits.condition")]
    verdict: Annotated[str, "what loses the digits: question, formula, none", From("digits.verdict")]
    bits: Annotated[int, "precision of the reference", From("digits.bits")]


class StabilityAt(Part, frozen=True):
    """a verdict of the first approximation on one rung"""

    kind: Annotated[str, "the kind of ladder"]
    subject: Annotated[str, "what is extreme"]
    size: Annotated[float, "how extreme"]
    exact: Annotated[Word, "the exact verdict", From("judged.exact.word")]
    theorems: Annotated[list[TheoremName], "the theorems that prove it", From("judged.exact.theorems")]
    floats: Annotated[dict[str, str], "what eigenvalues in an arithmetic say", From("judged.floats")]
    floats_wrong: Annotated[dict[str, bool], "whether that is wrong"]


class Extremes(Head, frozen=True, kw_only=True):
    """How many digits each quantity keeps at extremes."""

    sentences: Annotated[list[str], "what follows from the rows, in sentences"]
    left_out: Annotated[list[str], "what was not measured, and why, in sentences"]
    singular: Singular | None
    eigenvalues: Annotated[
        list[Eigenvalue],
        "of the first approximation at the given values, with multiplicity; empty where they were not enclosed",
    ]
    compensated: Annotated[
        list[Compensated], "where float64 kernels carry operations of the accelerations in pairs of numbers"
    ]
    rows: Annotated[list[Row], "measurements"]
    stability: Annotated[list[StabilityAt], "verdicts"]
    singular_positions: Annotated[SingularPositions | UnsetType, From("positions")] = UNSET
