"""One frozen ``Target`` per kind of file.  A target says which problems it can show, so that only those are derived."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


@dataclass(frozen=True)
class Target:
    """``needs``: the problems whose results the file can hold; of these it shows the ones that were asked for."""

    name: str
    filename: str
    needs: tuple[int, ...]
    title: str
    text: Callable[[Analysis, Sequence[int]], str]

    def render(self, analysis: Analysis, problems: Sequence[int]) -> str:
        """The file's whole text: the same bytes for the same description, whenever and wherever it is made."""
        return self.text(analysis, tuple(number for number in sorted(set(problems)) if number in self.needs))


# The writers are imported when they are used: each brings its own share of Jinja templates and printers.


def _latex(analysis: Analysis, problems: Sequence[int]) -> str:
    from mbsym.report.latex_report import render

    return render(analysis, problems)


def _wolfram(analysis: Analysis, problems: Sequence[int]) -> str:
    from mbsym.report.wolfram_report import render

    return render(analysis, problems)


def _python(analysis: Analysis, problems: Sequence[int]) -> str:
    from mbsym.report.python_module import render

    return render(analysis, problems)


def _json(analysis: Analysis, problems: Sequence[int]) -> str:
    from mbsym.report.results_json import render

    return render(analysis, problems)


_ALL = (1, 2, 3, 4, 5, 6, 7)

TARGETS = {
    target.name: target
    for target in (
        Target("latex", "report.tex", _ALL, "an appendix for pdflatex", _latex),
        Target("wolfram", "report.wl", _ALL, "definitions in the Wolfram Language", _wolfram),
        Target("python", "model.py", (5,), "a numpy module of the equations, from the straight-line program", _python),
        Target("json", "results.json", _ALL, "every result as text in Python syntax", _json),
    )
}
