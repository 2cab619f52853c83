"""Parts of ``report.html`` one by one, as fragments for a page that fills while results are derived.

A fragment is what the same part of the report is, word for word, and its formulas carry what other programs read
(``html.formulas.spellings``).  Everything that comes from a description is escaped.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from mbsym.report.html.environment import fragment
from mbsym.report.html.report import context, title_in

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

#: What a report shows beside problems, with the titles that it gives them.
PARTS = {
    "summary": "What was found",
    "system": "The system",
    "claims": "Claims",
    "checks": "Self-check",
    "conventions": "Conventions",
}


def title(analysis: Analysis, part: str | int) -> str:
    """As the report has it: ``Problem 6. Stability``, ``The system``."""
    return str(title_in(analysis, part if isinstance(part, int) else PARTS[part]))


def part_html(analysis: Analysis, part: str | int, problems: Sequence[int]) -> str:
    """A part, or a problem by its number, told beside the results of ``problems``.

    Raises KeyError for a part that there is not.
    """
    if isinstance(part, str) and part not in PARTS:
        raise KeyError(part)
    known, values = context(analysis, problems, part in ("summary", "claims", "checks"), spelled=True)
    return fragment("part.html.j2", known, part=part, **values)
