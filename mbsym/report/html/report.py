"""``report.html``: every result in one file that reads well on a screen and on paper, and asks the network for nothing.

What was found stands first.  Formulas are MathML; long ones are folded away behind their length.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from markupsafe import Markup, escape

from mbsym import __version__
from mbsym.formulas.mathml import MathNames, mathml_names, mi, mo
from mbsym.model.quantities import unit_of
from mbsym.problems import NUMBERS
from mbsym.report.code.functions import moving
from mbsym.report.compact import compact
from mbsym.report.content import Said
from mbsym.report.html import formulas as shown
from mbsym.report.html.description import (
    expression,
    speed,
)
from mbsym.report.html.diagram import diagram
from mbsym.report.html.environment import page
from mbsym.report.html.motion import asked_motion
from mbsym.report.html.writer import Writer
from mbsym.report.language import Language
from mbsym.report.lengths import COUNTED, PAPER, withheld
from mbsym.report.results import Section, contents, results
from mbsym.report.summary import title_of
from mbsym.report.unit_text import labelled
from mbsym.source.meaning import meaning

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.model.system import System

#: The order of the sections: as a reader wants them, as in report.tex.
ORDER = tuple(NUMBERS)


def render(analysis: Analysis, problems: Sequence[int]) -> str:
    """The file's text."""
    motion, no_motion = asked_motion(analysis.system)
    scripts = ("report.js", "motion.js") if motion is not None else ("report.js",)
    known, values = context(analysis, problems)
    return page("report.html.j2", known, scripts, motion=motion, no_motion=no_motion, **values)


def context(
    analysis: Analysis, problems: Sequence[int], whole: bool = True
) -> tuple[dict[str, Callable[..., Any]], dict[str, Any]]:
    """What templates about these problems may call, and what they tell.

    Not the ``whole`` is what a problem's own template needs: claims and checks, which are about all of them, are left.
    """
    from mbsym.analysis import PROBLEMS

    system = analysis.system
    names = mathml_names(analysis.ring)
    stages = {number: analysis.stage(number) for number in problems}
    found = {number: stage.value for number, stage in stages.items() if stage.failure is None}
    about = results(analysis, problems)
    long = withheld([*(found[number] for number in COUNTED if number in found), *about.forms.forms.results], PAPER)
    writer = Writer(names, Language(analysis.language or system.language), long)
    sections = contents(about, writer.document)
    known: dict[str, Callable[..., Any]] = {
        **_functions(long),
        "name": lambda name: Markup(str(names[name])),
        "dotted": lambda name: Markup(str(names[name].dotted("˙"))),
        "speed": lambda name: speed(name, names),
        "expression": lambda value: expression(value, names),
        "tr": lambda text, **gaps: writer.said(Said(text, gaps)),
        "title": lambda number: _title(number, sections, system, writer),
        "unperturbed": lambda: _motion(analysis, names),
        "unit": lambda name: labelled("", unit_of(system, name)),
    }
    values = dict[str, Any](
        system=system,
        title_of=title_of,
        numbers={"0": 0} | {body.name: k for k, body in enumerate(system.bodies, start=1)},
        found=found,
        problems=[(number, PROBLEMS[number]) for number in ORDER if number in problems],
        contents=sections,
        language=writer.language.name,
        failures={number: stage.failure for number, stage in stages.items() if stage.failure is not None},
        told=compact(analysis, {number: found.get(number) for number in problems}),
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
    return _title(part, contents(results(analysis, (part,)), writer.document), analysis.system, writer)


def _title(part: int | str, sections: Mapping[int | str, Section[Markup]], system: System, writer: Writer) -> Markup:
    if part in sections:
        return writer.said(sections[part].title)
    words = title_of(system, int(part))
    return escape(f"Problem {part}. {words[:1].upper()}{words[1:]}")


def _functions(long: frozenset[int]) -> dict[str, Callable[..., Any]]:
    """What templates write formulas with."""
    return {
        "math": shown.math,
        "symbol": shown.symbol,
        "indexed": shown.indexed,
        "mi": lambda name: Markup(mi(name)),
        "mo": lambda sign: Markup(mo(sign)),
        "line": lambda left, value, right="": shown.line(left, value, long, right),
        "text_line": shown.text_line,
        "inline": shown.inline,
        "moving": moving,
    }


def _separated(items: Sequence[str]) -> list[str]:
    comma = '<mo separator="true">,</mo><mspace width="0.3em"/>'
    return [piece for k, item in enumerate(items) for piece in ([comma] if k else []) + [item]]


def _motion(analysis: Analysis, names: MathNames) -> Markup:
    """The unperturbed motion, in formulas that may stand on several lines."""
    items = [(item.coordinate, moving(item.value, item.rate)) for item in analysis.system.motion]
    items += [(one.name, one.held) for one in analysis.system.inputs]
    return Markup(", ").join(shown.math(str(names[name]), mo("="), expression(value, names)) for name, value in items)
