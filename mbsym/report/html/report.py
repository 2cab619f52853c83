"""``report.html``: every result in one file that reads well on a screen and on paper, and asks the network for nothing.

What was found stands first.  Formulas are MathML; long ones are folded away behind their length.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
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
from mbsym.report.html.integrals import of_polynomials, of_symmetries
from mbsym.report.html.motion import asked_motion
from mbsym.report.html.writer import Writer
from mbsym.report.language import Language
from mbsym.report.lengths import COUNTED, PAPER, withheld
from mbsym.report.results import Section, contents, results
from mbsym.report.sections.invariant_sets import plain
from mbsym.report.sections.small_parameters import told as of_small_parameters
from mbsym.report.sections.stabilisation import decimal, polynomial
from mbsym.report.summary import title_of
from mbsym.report.unit_text import labelled
from mbsym.report.words.expansion_words import Coefficient
from mbsym.report.words.expansion_words import Medium as SmallMedium
from mbsym.report.words.integrals_words import sentences as polynomial_sentences
from mbsym.report.words.invariant_words import Medium as InvariantMedium
from mbsym.report.words.invariant_words import closing, family_title, of_family, of_set, opening, told_families
from mbsym.report.words.normal_form_words import Medium as HigherMedium
from mbsym.report.words.normal_form_words import sentences as higher_sentences
from mbsym.report.words.stabilisation_words import FEEDBACK, LYAPUNOV, Medium, sentences
from mbsym.source.meaning import meaning

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.analysis.small import SmallParameters
    from mbsym.model.system import System
    from mbsym.problems.invariant_sets import InvariantSets
    from mbsym.problems.normal_forms import NormalForms
    from mbsym.problems.stabilisation import Stabilisation

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
        "named": lambda items: shown.math(*_separated([str(names[name]) for name in items])),
        "dotted": lambda name: Markup(str(names[name].dotted("˙"))),
        "speed": lambda name: speed(name, names),
        "expression": lambda value: expression(value, names),
        "tr": lambda text, **gaps: writer.said(Said(text, gaps)),
        "title": lambda number: _title(number, sections, system, writer),
        "unperturbed": lambda: _motion(analysis, names),
        "unit": lambda name: labelled("", unit_of(system, name)),
        "stabilisation_sentences": lambda one: list(_of_stabilisation(one, names)),
        "polynomial_integrals": of_polynomials,
        "polynomial_symmetries": of_symmetries,
        "polynomial_sentences": lambda one: list(_filled(polynomial_sentences(one.found))),
        "normal_form_sentences": lambda one: list(_of_normal_forms(one, names)),
        "invariant_paragraphs": lambda one: list(_of_invariant_sets(one, names)),
        "small_parameter_lines": lambda one: list(_of_small_parameters(one, system, names)),
        "decimal": decimal,
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
        FEEDBACK=FEEDBACK,
        LYAPUNOV=LYAPUNOV,
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


def _of_normal_forms(found: NormalForms, names: MathNames) -> Iterator[Markup]:
    """The sentences of problem 11, names and formulas in MathML."""
    write = HigherMedium(
        names=lambda listed: shown.math(*_separated([str(names[name]) for name in listed])),
        formula=lambda x: shown.math(shown.inline(x)),
        math=lambda plain, _: escape(plain),
        word=lambda text: escape(text),
    )
    for text, values in higher_sentences(found, write):
        yield from _filled([(text, {name: Markup(value) for name, value in values.items()})])


def _of_stabilisation(found: Stabilisation, names: MathNames) -> Iterator[Markup]:
    """The sentences of problem 8, names and formulas in MathML."""
    write = Medium(
        names=lambda listed: shown.math(*_separated([str(names[name]) for name in listed])),
        condition=lambda x, relation: shown.math(shown.inline(x), mo(_SIGNS.get(relation, relation)), "<mn>0</mn>"),
        formula=lambda x: shown.math(shown.inline(x)),
        polynomial=lambda factor: escape(polynomial(factor)),
        square=lambda x: escape("lambda**2 = -(") + shown.math(shown.inline(x)) + ")",
        word=str,
    )
    for text, values in sentences(found, write):  # what stands in gaps is MathML, but for reasons and numbers
        written = {name: Markup(value) if name != "why" else value for name, value in values.items()}
        yield from _filled([(text, written)])


def _of_invariant_sets(found: InvariantSets, names: MathNames) -> Iterator[list[Markup]]:
    """Paragraphs of problem 10, names and formulas in MathML."""
    if found.in_angles:  # names as in the formulas
        names = mathml_names(found.integrals[0][1].ring)
    write = InvariantMedium(
        names=lambda listed: shown.math(*_separated([str(names[name]) for name in listed])),
        condition=lambda x, relation: shown.math(shown.inline(x), mo(_SIGNS.get(relation, relation)), "<mn>0</mn>"),
        value=lambda name, x: shown.math(str(names[name]), mo("="), shown.inline(x)),
        rate=lambda name, x: shown.math(f"<mover>{names[name]}<mo>˙</mo></mover>", mo("="), shown.inline(x)),
        formula=lambda x: shown.math(shown.inline(x)),
        even=lambda factor: escape(plain(found).even(factor)),
        word=lambda word: str(escape(word)),
    )

    def said(told: Iterable[tuple[str, dict[str, object]]]) -> list[Markup]:
        return list(_filled((text, {k: Markup(v) for k, v in values.items()}) for text, values in told))

    yield said(opening(found, write))
    for family in told_families(found):
        title = escape(f"K = {family_title(family, found)}")
        yield [title, *said(of_family(family, write))]
        for k, one in enumerate(family.sets, start=1):
            yield said(of_set(one, k, write))
    yield said(closing(found, write))


def _of_small_parameters(found: SmallParameters, system: System, names: MathNames) -> Iterator[Markup]:
    """The lines of problem 12, names and formulas in MathML."""
    write = SmallMedium(
        names=lambda listed: shown.math(*_separated([str(names[name]) for name in listed])),
        formula=lambda x: shown.math(shown.inline(x)),
        condition=lambda x, relation: shown.math(shown.inline(x), mo(_SIGNS.get(relation, relation)), "<mn>0</mn>"),
        word=lambda word: str(escape(word)),
    )
    for one in of_small_parameters(found, system, write):
        if isinstance(one, list):
            yield from (_coefficient(x, names) for x in one)
        else:
            text, values = one
            yield from _filled([(text, {name: Markup(value) for name, value in values.items()})])


def _coefficient(one: Coefficient, names: MathNames) -> Markup:
    symbol = str(names[one.variable])
    if one.rate:
        symbol = f"<mover>{symbol}<mo>˙</mo></mover>"
    order = f"<mrow><mo>(</mo><mn>{one.order}</mn><mo>)</mo></mrow>"
    return shown.math(f"<msup>{symbol}{order}</msup>", mo("="), shown.inline(one.formula))


_SIGNS = {"!=": "≠", ">=": "≥"}


def _filled(said_ones: Iterable[tuple[str, dict[str, object]]]) -> Iterator[Markup]:
    for text, values in said_ones:
        said = escape(text)
        for name, value in values.items():
            said = said.replace(f"[[{name}]]", escape(value))
        yield said


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
