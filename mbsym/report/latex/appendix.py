r"""``appendix.tex`` and ``fragments/*.tex``: what anyone may ``\input`` into a document of his own.

They have no preamble, define nothing, need amsmath alone (a diagram TikZ, too), and their labels begin with
``mbsym:NAME:``.  Formulas are broken by TeX, for whatever width the column has; matrices are written as such where a
narrow column holds them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from mbsym.report.latex.labels import Form, free_prefix, labels, with_prefix
from mbsym.report.latex.report import filled

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


def render(analysis: Analysis, problems: Sequence[int]) -> str:
    """The text of ``appendix.tex``."""
    return filled("appendix.tex.j2", analysis, problems, Form.APPENDIX)


def fragment(analysis: Analysis, problems: Sequence[int], name: str, title: str, number: int | None = None) -> str:
    """The text of ``fragments/NAME.tex``."""
    part = name if number is None else number
    return filled("fragment.tex.j2", analysis, problems, Form.FRAGMENT, title=title, part=part)


def joined(appendices: Sequence[str]) -> str:
    """The appendices of several systems as one: a section each, in their order, with labels that differ.

    Two systems of one name keep their labels apart by a number: ``mbsym:pendulum-2:``.
    """
    taken: set[str] = set()
    parts = []
    for text in appendices:
        prefix = next((":".join(label.split(":")[:2]) + ":" for label in labels(text)), "")
        free = free_prefix(prefix, taken)
        taken.add(free)
        parts.append(with_prefix(text, prefix, free) if prefix and free != prefix else text)
    return "\n\n".join(part.strip() + "\n" for part in parts)
