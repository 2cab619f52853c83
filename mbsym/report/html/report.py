"""``report.html``: every result in one file that reads well on a screen and on paper, and asks the network for nothing.

What was found stands first.  Formulas are MathML; long ones are folded away behind their length.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from mbsym import __version__
from mbsym.formulas.mathml import mathml_names
from mbsym.problems import NUMBERS
from mbsym.report.content import Said
from mbsym.report.html.diagram import diagram
from mbsym.report.html.environment import page
from mbsym.report.html.motion import asked_motion
from mbsym.report.html.writer import Writer
from mbsym.report.language import Language
from mbsym.report.lengths import COUNTED, PAPER, withheld
from mbsym.report.results import contents, results
from mbsym.source.meaning import meaning

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

#: The order of the sections: as a reader wants them, as in report.tex.
ORDER = tuple(NUMBERS)


def render(analysis: Analysis, problems: Sequence[int]) -> str:
    """The file's text."""
    motion, no_motion = asked_motion(
        analysis.system, analysis.animate, Language(analysis.language or analysis.system.language)
    )
    scripts = ("report.js", "motion.js") if motion is not None else ("report.js",)
    known, values = context(analysis, problems)
    return page("report.html.j2", known, scripts, motion=motion, no_motion=no_motion, **values)


def context(
    analysis: Analysis, problems: Sequence[int], whole: bool = True, spelled: bool = False
) -> tuple[dict[str, Callable[..., Any]], dict[str, Any]]:
    """What templates about these problems may call, and what they tell.

    Not the ``whole`` is what a problem's own template needs: claims and checks, which are about all of them, are left.
    ``spelled``: formulas carry what other programs read.
    """
    system = analysis.system
    names = mathml_names(analysis.ring)
    about = results(analysis, problems)
    counted = [about.found[number] for number in COUNTED if number in about.found]
    long = withheld([*counted, *about.forms.forms.results], PAPER)
    writer = Writer(names, Language(analysis.language or system.language), long, spelled)
    sections = contents(about, writer.document)
    known: dict[str, Callable[..., Any]] = {
        "tr": lambda text, **gaps: writer.said(Said(text, gaps)),
        "title": lambda number: writer.said(sections[number].title),
    }
    values = dict[str, Any](
        system=system,
        problems=[number for number in ORDER if number in problems],
        contents=sections,
        language=writer.language.name,
        claims=analysis.claims if whole else (),
        checks=analysis.checks if whole else (),
        diagram=diagram(system) if system.bodies else "",
        version=__version__,
        digest=meaning(system),
    )
    return known, values


def title_in(analysis: Analysis, part: int | str) -> Markup:
    """The title of a problem, by its number, or a word of ours, in the language of the report."""
    language = Language(analysis.language or analysis.system.language)
    writer = Writer(mathml_names(analysis.ring), language)
    if isinstance(part, str):
        return writer.said(Said(part))
    return writer.said(contents(results(analysis, (part,)), writer.document)[part].title)
