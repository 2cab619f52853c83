"""LaTeX files from templates, and ``report.tex``, which stands alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from mbsym.report.environment import rendered
from mbsym.report.latex.abbreviated import abbreviated
from mbsym.report.latex.displays import written_out
from mbsym.report.latex.form import Form, set_apart
from mbsym.report.latex.values import shown
from mbsym.report.latex.words import broken, spared

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


def render(analysis: Analysis, problems: Sequence[int]) -> str:
    """The text of ``report.tex``."""
    return filled("report.tex.j2", analysis, problems, Form.REPORT, figures=analysis.figures)


def filled(template: str, analysis: Analysis, problems: Sequence[int], form: Form, **more: Any) -> str:
    """A template with the results of some problems; ``more`` are values besides."""
    filters, values = shown(analysis, problems, form)
    text = rendered(template, filters, **values, **more)
    if analysis.system.constraints:
        head, begins, rest = text.rpartition("\\begin{document}")  # an appendix has none
        text = head + begins + abbreviated(rest)
    text = text if form is Form.REPORT else written_out(set_apart(text))
    return "\n".join(map(broken, spared(text).split("\n")))
