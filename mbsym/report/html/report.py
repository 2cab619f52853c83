"""``report.html``: every result in one file that reads well on a screen and on paper, and asks the network for nothing.

What was found stands first.  Formulas are MathML; long ones are folded away behind their length.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from markupsafe import Markup, escape

from mbsym import __version__
from mbsym.formulas.mathml import MathNames, mathml_names, mi, mo, mtext, power
from mbsym.formulas.names import free_name
from mbsym.formulas.straight_line import Dialect, listing
from mbsym.model.quantities import rate_unit, unit_of
from mbsym.problems import NUMBERS
from mbsym.problems.checks import EXACT, FAILED, NUMERICAL
from mbsym.problems.stability import Stability
from mbsym.problems.stability.spectrum import Spectrum, numbers
from mbsym.problems.stability.word import Word
from mbsym.report.brief import brief
from mbsym.report.canonical import forms_of, upper_brackets
from mbsym.report.code.functions import moving
from mbsym.report.code.programs import programs_of
from mbsym.report.compact import compact
from mbsym.report.conditions import Shown, cases, factors, label_meanings, provided, statements
from mbsym.report.first_order import first_order
from mbsym.report.html import formulas as shown
from mbsym.report.html.description import (
    constraint_in_words,
    expression,
    load_in_words,
    point_of_table,
    speed,
    speed_form,
)
from mbsym.report.html.diagram import diagram
from mbsym.report.html.environment import page
from mbsym.report.html.integrals import of_polynomials, of_symmetries
from mbsym.report.html.motion import asked_motion
from mbsym.report.html.told import longer, told_passages, told_terms
from mbsym.report.inertias import accepted_inertias
from mbsym.report.latex.description import shown_points
from mbsym.report.lengths import COUNTED, PAPER, PAPER_PROGRAM, program_not_printed, withheld
from mbsym.report.sections.invariant_sets import plain
from mbsym.report.sections.small_parameters import told as of_small_parameters
from mbsym.report.sections.stabilisation import decimal, polynomial
from mbsym.report.sections.stability import root_text
from mbsym.report.summary import title_of
from mbsym.report.unit_text import labelled, pretty
from mbsym.report.words.claims import HELD, REFUTED, claim_line, counterexample, repair, titles, together
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
    from mbsym.formulas.formula import Formula
    from mbsym.model.system import System
    from mbsym.problems.constraints import Constraints
    from mbsym.problems.invariant_sets import InvariantSets
    from mbsym.problems.normal_forms import NormalForms
    from mbsym.problems.reactions import Reaction
    from mbsym.problems.reduction import Reduction
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
    printed = _claimed_names(analysis)
    stages = {number: analysis.stage(number) for number in problems}
    found = {number: stage.value for number, stage in stages.items() if stage.failure is None}
    forms = forms_of(analysis, problems)
    long = withheld([*(found[number] for number in COUNTED if number in found), *forms.results], PAPER)
    taken = {str(names[name]) for name in [*system.coordinates, *system.parameter_names]}
    taken |= {str(names[item.name]) for item in system.prescribed}
    taken |= {str(names[item.name]) for item in system.notation}
    known: dict[str, Callable[..., Any]] = {
        **_functions(long),
        "name": lambda name: Markup(str(names[name])),
        "named": lambda items: shown.math(*_separated([str(names[name]) for name in items])),
        "dotted": lambda name: Markup(str(names[name].dotted("˙"))),
        "speed": lambda name: speed(name, names),
        "constant_momentum": lambda name: Markup(str(mathml_names(forms.routh_ring)[name])),
        "momentum": lambda name: Markup(str(mathml_names(forms.hamilton_ring)[name])),
        "momentum_rate": lambda name: Markup(str(mathml_names(forms.hamilton_ring)[name].dotted("˙"))),
        "upper_brackets": upper_brackets,
        "speed_form": lambda one: speed_form(one, names, [body.name for body in system.bodies].index(one.body) + 1),
        "expression": lambda value: expression(value, names),
        "points": lambda value: Markup(
            _points([shown.math(point_of_table(x, y, names)) for x, y in shown_points(value)], len(value))
        ),
        "vector": lambda values: Markup(shown.row([expression(x, names) for x in values])),
        "tensor": lambda rows: Markup(shown.table([[expression(x, names) for x in line] for line in rows])),
        "printed": lambda value: expression(value, printed),
        "printed_name": lambda name: Markup(str(printed[name])),
        "load": lambda value: load_in_words(value, names),
        "unperturbed": lambda: _motion(analysis, names),
        "unit": lambda name: labelled("", unit_of(system, name)),
        "pretty": pretty,
        "constraint_sentences": lambda tied: list(_of_constraints(tied, names)),
        "of_reaction": lambda one: list(_of_reaction(one)),
        "reduction_sentences": lambda about: list(_of_reduction(about, names)),
        "constraint": lambda value: constraint_in_words(value, names),
        "stabilisation_sentences": lambda one: list(_of_stabilisation(one, names)),
        "polynomial_integrals": of_polynomials,
        "polynomial_symmetries": of_symmetries,
        "polynomial_sentences": lambda one: list(_filled(polynomial_sentences(one.found))),
        "normal_form_sentences": lambda one: list(_of_normal_forms(one, names)),
        "invariant_paragraphs": lambda one: list(_of_invariant_sets(one, names)),
        "small_parameter_lines": lambda one: list(_of_small_parameters(one, system, names)),
        "decimal": decimal,
        "claim_groups": lambda: list(together(map(claim_line, analysis.claims))),
    }
    values = dict(
        system=system,
        title_of=title_of,
        rate=labelled("", rate_unit(system)),
        accepted=accepted_inertias(system),
        numbers={"0": 0} | {body.name: k for k, body in enumerate(system.bodies, start=1)},
        found=found,
        problems=[(number, PROBLEMS[number]) for number in ORDER if number in problems],
        failures={number: stage.failure for number, stage in stages.items() if stage.failure is not None},
        code=_code(analysis) if 3 in stages and 3 not in found else None,
        state=analysis.optional("first_order") if system.speeds and 5 in found else None,
        told=compact(analysis, {number: found.get(number) for number in problems}),
        variable=_free_letter("λμσs", taken),
        characteristic="Lambda" if "<mi>Λ</mi>" not in taken else _free_letter("ΔΦPQ", taken),
        factors=factors,
        math_text=lambda words: Markup(mtext(words)),
        provided=provided(found[6].presumed, bool(analysis.system.inputs)) if 6 in found else "",
        decided=_decided,
        **first_order(analysis, found.get(5)),
        DEPENDS=Word.DEPENDS,
        FEEDBACK=FEEDBACK,
        LYAPUNOV=LYAPUNOV,
        forms=forms,
        reactions=analysis.optional("reactions") if system.reactions and 3 in problems else (),
        claims=analysis.claims if whole else (),
        checks=analysis.checks if whole else (),
        brief=brief(analysis, 0.0) if whole else None,
        diagram=diagram(system) if system.bodies else "",
        version=__version__,
        digest=meaning(system),
    )
    return known, values


def _of_constraints(tied: Constraints, names: MathNames) -> Iterator[Markup]:
    """The sentences about constraints, names in MathML."""
    from mbsym.report.words.constraint_words import Writer, sentences

    write = Writer(
        lambda listed: shown.math(*_separated([str(names[name]) for name in listed])),
        speeds=lambda listed: shown.math(*_separated([str(speed(name, names)) for name in listed])),
        condition=_condition,
    )
    yield from _filled(sentences(tied, write))


def _condition(value: Formula, sign: str) -> Markup:
    return shown.math(shown.inline(value), mo("≠" if sign == "!=" else sign), "<mn>0</mn>")


def _of_reaction(one: Reaction) -> Iterator[Markup]:
    """What is not determined of a reaction, formulas in MathML."""
    if not one.balances:
        return
    from mbsym.report.words.constraint_words import Writer, reaction_sentences

    write = Writer(
        lambda listed: escape(", ".join(listed)),
        components=lambda places: shown.math(*_separated([shown.symbol("RL"[k // 3], str(k % 3 + 1)) for k in places])),
        vector=lambda x: shown.math(mo("("), *_separated([shown.inline(y) for y in x]), mo(")")),
    )
    yield from _filled(reaction_sentences(one, write))


def _of_reduction(about: Reduction, names: MathNames) -> Iterator[Markup]:
    """The sentences about what is left of the coordinates, names and formulas in MathML."""
    from mbsym.report.words.constraint_words import Writer, reduction_sentences

    def rates(given: tuple[tuple[str, Formula], ...]) -> Markup:
        return Markup(", ").join(
            shown.math(f"<mover>{names[name]}<mo>˙</mo></mover>", mo("="), shown.inline(x)) for name, x in given
        )

    write = Writer(
        lambda listed: shown.math(*_separated([str(names[name]) for name in listed])),
        rates=rates,
        condition=_condition,
    )
    yield from _filled(reduction_sentences(about, write))


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


def _free_letter(letters: str, taken: Collection[str]) -> str:
    """The first that is the symbol of nothing declared."""
    return next((x for x in letters if mi(x) not in taken), free_name(letters[0] * 2, taken))


def _functions(long: frozenset[int]) -> dict[str, Callable[..., Any]]:
    """What templates write formulas with."""
    return {
        "math": shown.math,
        "symbol": shown.symbol,
        "part_of": shown.part_of,
        "indexed": shown.indexed,
        "mi": lambda name: Markup(mi(name)),
        "mo": lambda sign: Markup(mo(sign)),
        "squared": lambda value: Markup(power(value, "<mn>2</mn>")),
        "line": lambda left, value, right="": shown.line(left, value, long, right),
        "balance": lambda left, right: shown.line(shown.inline(left), right, long),
        "text_line": shown.text_line,
        "components": lambda values: shown.components(values, long),
        "matrix": lambda value: shown.matrix(value, long),
        "entries": shown.entries,
        "zero": shown.zero,
        "polynomial": shown.polynomial,
        "condition": shown.condition,
        "relation": shown.relation,
        "refer": shown.refer,
        "label": shown.label,
        "inline": shown.inline,
        "prose": shown.prose,
        "short": lambda value: value.terms < 60,
        "moving": moving,
        "label_meanings": label_meanings,
        "statements": statements,
        "cases": cases,
        "Shown": Shown,
        "counterexample": lambda value: counterexample(value).replace("for", "For", 1),
        "titles": titles,
        "repair": repair,
        "told_passages": told_passages,
        "told_terms": told_terms,
        "longer": longer,
        "eigenvalues": _eigenvalues,
        "grade": _grade,
    }


def _separated(items: Sequence[str]) -> list[str]:
    comma = '<mo separator="true">,</mo><mspace width="0.3em"/>'
    return [piece for k, item in enumerate(items) for piece in ([comma] if k else []) + [item]]


def _grade(word: str) -> str:
    """good, bad or open: how a verdict or an outcome is coloured; the word itself says it."""
    good = {word.value for word in Word if word.stable} | {EXACT, NUMERICAL, HELD}
    return (
        "good"
        if word in good
        else "bad"
        if word in (Word.UNSTABLE, Word.UNSTABLE_BUT_BORDERS, FAILED, REFUTED)
        else "open"
    )


def _motion(analysis: Analysis, names: MathNames) -> Markup:
    """The unperturbed motion, in formulas that may stand on several lines."""
    items = [(item.coordinate, moving(item.value, item.rate)) for item in analysis.system.motion]
    items += [(one.name, one.held) for one in analysis.system.inputs]
    return Markup(", ").join(shown.math(str(names[name]), mo("="), expression(value, names)) for name, value in items)


def _decided(found: Stability) -> str:
    """How the verdict at given values was found, if it is one: irrational values have enclosures."""
    if found.numerical is None or found.numerical.word == Word.UNDECIDED:
        return ""
    enclosed = any(part.theory.at_point is None for part in found.subsystems)
    return ", decided by rigorous enclosures" if enclosed else ", decided exactly"


def _eigenvalues(spectrum: Spectrum) -> str:
    """``-0.1 ± 2.3i (twice)``, separated by semicolons."""
    return "; ".join(root_text(root).replace("+-", "±").replace("-", "\u2212") for root in numbers(spectrum))


def _claimed_names(analysis: Analysis) -> MathNames:
    """The names of the system, and those of a publication's abbreviations besides."""
    kinds = ("coordinate", "prescribed", "parameter")
    own = ["t", *(g.name for g in analysis.ring.generators if g.kind in kinds)]
    variables = [claim.variable for claim in analysis.system.claims if claim.variable]
    return MathNames([*own, *(item.name for item in analysis.system.abbreviations), *variables])


DIALECT = Dialect(
    call=lambda function, argument: f"{function}({argument})",
    local=lambda count: f"s{count}",
    number=lambda value: str(Fraction(value)),
)


def _code(analysis: Analysis) -> list[str] | None:
    """Mass matrix and forcing as a straight-line program; None if there is none."""
    system, (programs, _) = analysis.system, programs_of(analysis)
    if programs is None:
        return None
    n = len(system.coordinates)
    upper = [(i, j) for i in range(n) for j in range(i, n)]
    nodes = [programs.mass_matrix[i][j] for i, j in upper]
    same = {name: name for name in programs.environment}
    body = listing(programs.program, [*nodes, *programs.forcing], same, DIALECT)
    if len(body.assignments) > PAPER_PROGRAM:
        return [f"({program_not_printed(len(body.assignments))})"]
    lines = [f"{name} = {text}" for name, text in body.assignments]
    lines += [f"M[{i + 1}, {j + 1}] = {text}" for (i, j), text in zip(upper, body.results, strict=False)]
    return lines + [f"f[{i + 1}] = {text}" for i, text in enumerate(body.results[len(upper) :])]


def _points(written: list[str], count: int) -> str:
    """The points of a table; of many the first and the last."""
    half = len(written) // 2
    return ", ".join(written if len(written) == count else [*written[:half], "\u2026", *written[half:]])
