"""What each part of the model costs."""

from __future__ import annotations

from typing import Annotated

from mbsym.report.documents.base import Part, words


class Measure(Part, frozen=True):
    """a measure"""

    quantity: Annotated[str, "what is measured"]
    unit: Annotated[str, "its unit"]
    without: Annotated[float, "without the saving"]
    with_: Annotated[float, "with it"]
    at_least: Annotated[bool, "whether the number without is a lower bound"]


class Saving(Part, frozen=True):
    """one saving"""

    kind: Annotated[str, "its kind"]
    what: Annotated[list[str], "what was left out"]
    why: Annotated[str, "why that is safe, in words"]
    how: Annotated[str, "how that is known: proved, verified numerically, measured, estimated, undecided"]
    standing: Annotated[
        str,
        words("not needed", "needed", "open"),
        "whether this scene needs it: not needed, needed, open (no accuracy to hold it against)",
    ]
    error: Annotated[float | None, "what leaving it out changes of the motion, relative to its size (--accuracy)"]
    tolerable: Annotated[float | None, "what a model may change at the accuracy asked for"]
    measures: Annotated[list[Measure], "what it saved"]


class Ledger(Part, frozen=True):
    """what was left out of the model and what that saved (mbsym run --ledger)"""

    savings: Annotated[list[Saving], "savings"]
    not_measured: Annotated[list[str], "what was not measured, in words"]
