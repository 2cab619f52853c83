"""What the terminal shows of a problem, line by line, and its formulas as Python reads them."""

from __future__ import annotations

import re

from mbsym.analysis import Analysis
from mbsym.report.language import Language
from mbsym.report.plain_writer import LONGEST, Writer
from mbsym.report.results import contents, results


def told(analysis: Analysis, key: int | str, language: str = "", longest: int = LONGEST) -> list[str]:
    """The lines below the heading of a problem, of the claims or of the self-check, as ``mbsym run -v`` prints them."""
    known = results(analysis, (key,) if isinstance(key, int) else analysis.problems)
    writer = Writer(Language(language), readable=True, longest=longest, file="report.html")
    return [line.text for line in contents(known, writer.document)[key]()][1:]


def python(text: str) -> str:
    """``2 m l^2 (a + b)`` as ``2*m*l**2*(a + b)``."""
    return re.sub(r"(?<=[\w)']) (?=[\w(])", "*", text).replace("^", "**")
