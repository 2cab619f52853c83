"""What LaTeX files show: the filters and the values of their templates.

What is printed of a formula, a matrix or a passage is printed once for all files of an analysis.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import TYPE_CHECKING, Any, TypeVar
from weakref import WeakKeyDictionary

from mbsym import __version__
from mbsym.formulas.latex import latex_names
from mbsym.formulas.tree import angles_or
from mbsym.model.quantities import unit_of
from mbsym.report.code.functions import moving
from mbsym.report.compact import compact
from mbsym.report.language import Language
from mbsym.report.latex.description import (
    expression,
)
from mbsym.report.latex.diagram import diagram
from mbsym.report.latex.form import Form, heading, subheading
from mbsym.report.latex.formulas import (
    Measured,
    formula,
    measured_matrix,
)
from mbsym.report.latex.labels import Labels, prefix_of
from mbsym.report.latex.words import escaped, is_cyrillic
from mbsym.report.latex.writer import Writer
from mbsym.report.lengths import COUNTED, PAPER, PAPER_FORMS, withheld
from mbsym.report.references import references
from mbsym.report.results import contents, results
from mbsym.report.unit_text import bracketed
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
        """``function(value, *more)``, called once as long as angles are to be printed the same way."""
        key = function, id(value), angles_or("shorter"), *more
        if key not in self._made:
            self._made[key] = value, function(value, *more)
        found: T = self._made[key][1]
        return found


_PRINTED: WeakKeyDictionary[Analysis, Printed] = WeakKeyDictionary()


def shown(analysis: Analysis, problems: Sequence[int], form: Form) -> tuple[Filters, dict[str, Any]]:
    """The filters and the values for the results of some problems."""
    from mbsym.analysis import PROBLEMS

    system, once = analysis.system, _PRINTED.setdefault(analysis, Printed())
    names = latex_names(analysis.ring)
    tongue = Language(analysis.language or system.language)
    labels = Labels(prefix_of(system.name))
    stages = {number: analysis.stage(number) for number in problems}
    found = {number: stage.value for number, stage in stages.items() if stage.failure is None}
    known = results(analysis, problems)
    long = withheld([found[number] for number in COUNTED if number in found], PAPER)
    long |= withheld(known.forms.forms.results, PAPER_FORMS)
    verdicts = found.get(6)
    cited = references(verdicts, escaped(system.source)) if form is not Form.FRAGMENT else ()
    writer = Writer(names, tongue, labels, form, long, lambda value: once(measured_matrix, value))
    values = {
        "tr": tongue.sentence,
        # No filter: Jinja computes filters of constants when it compiles a template, and keeps what it compiled.
        "eq": labels.equation,
        "heading": lambda key, title: heading(labels, form, key, title),
        "subheading": lambda title: subheading(form, title),
        "wide": form is Form.REPORT,
        "summarised": form is Form.REPORT,
        "prefix": labels.prefix,
        "version": __version__,
        "digest": once(meaning, system),
        "babel": tongue.babel,
        "references": cited,
        "system": system,
        "numbers": {"0": 0} | {body.name: k for k, body in enumerate(system.bodies, start=1)},
        "moving": moving,
        "found": found,
        "told": compact(analysis, {number: found.get(number) for number in problems}),
        "parts": {number: f"latex/{PROBLEMS[number].attribute}.j2" for number in problems},
        "contents": contents(known, writer.document),
        "problems": problems,
        "failures": {number: stage.failure for number, stage in stages.items() if stage.failure is not None},
        "diagram": lambda: diagram(system, names, escaped, tongue.sentence("inertial frame"), form.picture),
        "cyrillic": tongue.name == "ru" or is_cyrillic(system),
    }
    return _filters(analysis, tongue, long, form.widest, lambda value: once(measured_matrix, value)), values


def _filters(analysis: Analysis, tongue: Language, long: frozenset[int], widest: float, measured: Measured) -> Filters:
    """What templates write formulas and words with; the ``long`` formulas are counted."""
    system, names = analysis.system, latex_names(analysis.ring)
    return {
        "tex": escaped,
        "say": tongue.say,
        "name": lambda name: str(names[name]),
        "dotted": lambda name: names[name].accented("dot"),
        "math": lambda value: formula(value, long),
        "expression": lambda value: expression(value, names),
        "unit": lambda name, space="": bracketed(unit_of(system, name), space),
    }
