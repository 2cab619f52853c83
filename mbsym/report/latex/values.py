"""What LaTeX files show: the filters and the values of their templates.

What is printed of a formula, a matrix or a passage is printed once for all files of an analysis.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import TYPE_CHECKING, Any, TypeVar
from weakref import WeakKeyDictionary

from mbsym import __version__
from mbsym.formulas.latex import latex_names
from mbsym.formulas.letters import letters
from mbsym.formulas.tree import angles_or
from mbsym.report.content import Said, Verbatim
from mbsym.report.language import Language
from mbsym.report.latex.diagram import diagram
from mbsym.report.latex.form import Form, heading
from mbsym.report.latex.formulas import measured_matrix
from mbsym.report.latex.labels import Labels, prefix_of
from mbsym.report.latex.words import escaped, is_cyrillic
from mbsym.report.latex.writer import Writer
from mbsym.report.lengths import COUNTED, PAPER, PAPER_FORMS, withheld
from mbsym.report.references import references
from mbsym.report.results import contents, results
from mbsym.source.meaning import meaning

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

T = TypeVar("T")
Filters = dict[str, Callable[..., Any]]


class Printed:
    """Texts by what they are made of, which is kept with them, so that its identity stays its own."""

    def __init__(self) -> None:
        self._made: dict[tuple[Any, ...], tuple[Any, Any]] = {}

    def __call__(self, function: Callable[..., T], value: Any, *more: Hashable) -> T:
        """``function(value, *more)``, called once as long as formulas are to be printed the same way."""
        key = function, id(value), angles_or("shorter"), letters(), *more
        if key not in self._made:
            self._made[key] = value, function(value, *more)
        found: T = self._made[key][1]
        return found


_PRINTED: WeakKeyDictionary[Analysis, Printed] = WeakKeyDictionary()


def shown(analysis: Analysis, problems: Sequence[int], form: Form) -> tuple[Filters, dict[str, Any]]:
    """The filters and the values for the results of some problems."""
    system, once = analysis.system, _PRINTED.setdefault(analysis, Printed())
    names = latex_names(analysis.ring)
    tongue = Language(analysis.language or system.language)
    labels = Labels(prefix_of(system.name))
    known = results(analysis, problems)
    long = withheld([known.found[number] for number in COUNTED if number in known.found], PAPER)
    long |= withheld(known.forms.forms.results, PAPER_FORMS)
    cited = references(known.found.get(6), escaped(system.source)) if form is not Form.FRAGMENT else ()
    writer = Writer(names, tongue, labels, form, long, lambda value: once(measured_matrix, value))
    values = {
        "tr": lambda text, **gaps: writer.said(Said(text, gaps)),
        "verbatim": Verbatim,
        # No filter: Jinja computes filters of constants when it compiles a template, and keeps what it compiled.
        "heading": lambda key, title: heading(labels, form, key, title),
        "wide": form is Form.REPORT,
        "prefix": labels.prefix,
        "version": __version__,
        "digest": once(meaning, system),
        "babel": tongue.babel,
        "references": cited,
        "system": system,
        "contents": contents(known, writer.document),
        "problems": problems,
        "diagram": lambda: diagram(system, names, escaped, tongue.say("inertial frame"), form.picture),
        "cyrillic": tongue.name == "ru" or is_cyrillic(system),
    }
    return {"tex": escaped}, values
