"""What LaTeX files show: the filters and the values of their templates.

What is printed of a formula, a matrix or a passage is printed once for all files of an analysis.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeVar
from weakref import WeakKeyDictionary

from mbsym import __version__
from mbsym.expressions.rates import acceleration_name, velocity_name
from mbsym.formulas.latex import LatexNames, latex_names
from mbsym.formulas.names import free_name
from mbsym.formulas.straight_line import Dialect, listing
from mbsym.formulas.tree import angles_or
from mbsym.model.quantities import rate_unit, unit_of
from mbsym.model.system import System
from mbsym.problems.integrals import ENERGY
from mbsym.problems.stability import Stability
from mbsym.problems.stability.word import Word
from mbsym.report.canonical import Forms, forms_of, upper_brackets
from mbsym.report.code.functions import moving
from mbsym.report.code.programs import programs_of
from mbsym.report.compact import compact
from mbsym.report.conditions import Shown, cases, factors, label_meanings, provided, statements
from mbsym.report.first_order import first_order
from mbsym.report.inertias import accepted_inertias
from mbsym.report.language import Language
from mbsym.report.latex.description import (
    call,
    constraint_in_words,
    expression,
    load_in_words,
    points,
    speed,
    speed_form,
)
from mbsym.report.latex.diagram import diagram
from mbsym.report.latex.form import Form, heading, subheading
from mbsym.report.latex.formulas import (
    Measured,
    condition,
    displays,
    eigenvalues,
    entries,
    formula,
    index,
    matrix,
    measured_matrix,
    polynomial,
    row,
    tensor,
)
from mbsym.report.latex.integrals import of_integrals, of_list, of_symmetries, weights_of
from mbsym.report.latex.invariant import of_invariant_sets
from mbsym.report.latex.labels import Labels, prefix_of
from mbsym.report.latex.normal_forms import of_normal_forms
from mbsym.report.latex.references import keys_of, references, theorems_named
from mbsym.report.latex.small import of_small_parameters
from mbsym.report.latex.stabilisation import of_stabilisation, rational_matrix, rational_row
from mbsym.report.latex.told import packed, paragraphs
from mbsym.report.latex.words import RELATIONS, displayed, escaped, is_cyrillic, label, prose, refer
from mbsym.report.lengths import COUNTED, PAPER, PAPER_FORMS, PAPER_PROGRAM, program_not_printed, withheld
from mbsym.report.unit_text import bracketed
from mbsym.report.words.claims import claim_line, counterexample, repair, titles, together
from mbsym.report.words.integrals_words import OPENING
from mbsym.report.words.stabilisation_words import FEEDBACK, LYAPUNOV
from mbsym.source.meaning import meaning

if TYPE_CHECKING:
    from types import ModuleType

    from mbsym.analysis import Analysis
    from mbsym.problems.constraints import Constraints
    from mbsym.problems.reactions import Reaction
    from mbsym.problems.reduction import Reduction
    from mbsym.report.canonical_denominators import Denominators

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
    forms, denominators = _forms(analysis, problems)
    long = withheld([found[number] for number in COUNTED if number in found], PAPER)
    long |= withheld(forms.results, PAPER_FORMS)
    taken = {str(names[name]) for name in [*system.coordinates, *system.parameter_names]}
    taken |= {str(names[item.name]) for item in system.prescribed} | {str(names[item.name]) for item in system.notation}
    verdicts = found.get(6)
    cited = references(verdicts, escaped(system.source)) if form is not Form.FRAGMENT else ()
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
        "literature": _literature(verdicts, tongue) if form is Form.REPORT else [],
        "system": system,
        "accepted": accepted_inertias(system),
        "numbers": {"0": 0} | {body.name: k for k, body in enumerate(system.bodies, start=1)},
        "moving": moving,
        "found": found,
        "told": compact(analysis, {number: found.get(number) for number in problems}),
        "parts": [f"latex/{PROBLEMS[number].attribute}.j2" for number in problems],
        "problems": problems,
        "failures": {number: stage.failure for number, stage in stages.items() if stage.failure is not None},
        "code": _code(analysis, names) if 3 in stages and 3 not in found else None,
        "constraint_sentences": lambda tied: _of_constraints(tied, names, tongue),
        "reduction_sentences": lambda about: _of_reduction(about, names, tongue),
        "stabilisation_sentences": lambda one: of_stabilisation(one, names, tongue),
        "polynomial_integrals": lambda one: of_integrals(one, tongue),
        "polynomial_weights": lambda one: weights_of(one),
        "polynomial_sentences": lambda one: of_list(one, tongue),
        "polynomial_symmetries": lambda one: of_symmetries(one, tongue),
        "OPENING": OPENING,
        "normal_form_sentences": lambda one: of_normal_forms(one, names, tongue),
        "invariant_paragraphs": lambda one: of_invariant_sets(one, names, tongue),
        "small_parameter_lines": lambda one: of_small_parameters(one, system, names, tongue),
        "FEEDBACK": FEEDBACK,
        "LYAPUNOV": LYAPUNOV,
        "of_reaction": lambda one: _of_reaction(one, names, tongue),
        "constraint_label": lambda name: constraint_words().label(name, _writer(names, tongue)),
        "reactions": analysis.optional("reactions") if system.reactions and 3 in problems else (),
        "forms": forms,
        "denominators": denominators,
        "label_meanings": label_meanings,
        "statements": statements,
        "cases": cases,
        "Shown": Shown,
        "rate": bracketed(rate_unit(system), "\\;\\penalty0 "),
        "relations": RELATIONS,
        "variable": "\\lambda" if "\\lambda" not in taken else free_name("\\hat{\\lambda}", taken),
        "characteristic": "\\Lambda" if "\\Lambda" not in taken else free_name("\\hat{\\Lambda}", taken),
        "factors": factors,
        "provided": "" if verdicts is None else provided(verdicts.presumed, bool(system.inputs)),
        **first_order(analysis, found.get(5)),
        "DEPENDS": Word.DEPENDS,
        "ENERGY": ENERGY,
        "decided": decided,
        "state": analysis.optional("first_order") if system.speeds and 5 in found else None,
        "claims": analysis.claims,
        "outcomes": Counter(claim_line(result).word for result in analysis.claims),
        "repair": repair,
        "checks": analysis.checks,
        "diagram": lambda: diagram(system, names, escaped, tongue.sentence("inertial frame"), form.picture),
        "cyrillic": tongue.name == "ru" or is_cyrillic(system),
    }
    filters = _filters(analysis, tongue, long, form.widest, lambda value: once(measured_matrix, value))
    return filters | _momenta(forms), values


def _forms(analysis: Analysis, problems: Sequence[int]) -> tuple[Forms, Denominators | None]:
    """Routh's and Hamilton's forms as they are printed: long denominators have names."""
    forms = forms_of(analysis, problems)
    if not forms.results:
        return forms, None
    from mbsym.report.canonical_denominators import with_names

    denominators = with_names(forms, analysis.system)
    return denominators.forms, denominators


def _momenta(forms: Forms) -> Filters:
    """What templates write momenta with, which the rings of the forms have besides."""
    return {
        "constant_momentum": lambda name: str(latex_names(forms.routh_ring)[name]),
        "momentum": lambda name: str(latex_names(forms.hamilton_ring)[name]),
        "momentum_rate": lambda name: latex_names(forms.hamilton_ring)[name].accented("dot"),
        "upper_brackets": upper_brackets,
    }


def _filters(analysis: Analysis, tongue: Language, long: frozenset[int], widest: float, measured: Measured) -> Filters:
    """What templates write formulas and words with; the ``long`` formulas are counted."""
    system, names, printed = analysis.system, latex_names(analysis.ring), claimed_names(analysis)
    return {
        "tex": escaped,
        "rational_matrix": rational_matrix,
        "rational_row": rational_row,
        "say": tongue.say,
        "theorem": lambda name: escaped(tongue.say(name)),
        "name": lambda name: str(names[name]),
        "dotted": lambda name: names[name].accented("dot"),
        "speed": lambda name: speed(name, names),
        "speed_form": lambda one: speed_form(one, names, _number_of(system, one.body)),
        "math": lambda value: formula(value, long),
        "expression": lambda value: expression(value, names),
        "points": lambda value: points(value, names),
        "unit": lambda name, space="": bracketed(unit_of(system, name), space),
        "matrix": lambda value: matrix(value, long, widest, measured),
        "tensor": lambda value: tensor(value, names, widest),
        "row": lambda values: row(values, long, widest),
        "entries": entries,
        "sum": polynomial,
        "condition": condition,
        "eigenvalues": eigenvalues,
        "label": lambda words: label(words, tongue.say),
        "refer": lambda reference: refer(reference, tongue.say),
        "load": lambda value: displayed(load_in_words(value, names, escaped, tongue)),
        "constraint": lambda value: constraint_in_words(value, names, escaped, tongue),
        "index": index,
        "displays": lambda part, k: displays(part, k, widest, measured),
        "prose": prose,
        "claim_line": claim_line,
        "counterexample": lambda found: counterexample(found).replace("for", "For", 1),
        "together": together,
        "titles": titles,
        "printed": lambda value: expression(value, printed),
        "printed_name": lambda name: str(printed[name]),
        "same": lambda words: same(words, printed),
        "paragraphs": lambda item: paragraphs(
            item.system.told, item.passages, lambda words: escaped(tongue.say(words))
        ),
        "packed": lambda value, symbol, key: packed(entries(value, True), symbol, key),
        "zero": lambda values: all(x.is_zero for x in values),
    }


def _number_of(system: System, body: str) -> int:
    return next(k for k, one in enumerate(system.bodies, start=1) if one.name == body)


def constraint_words() -> ModuleType:
    """The module that says what is known of constraints; few systems have any."""
    from mbsym.report.words import constraint_words as words

    return words


def _of_constraints(tied: Constraints, names: LatexNames, tongue: Language) -> list[str]:
    said = constraint_words().sentences(tied, _writer(names, tongue))
    return [tongue.sentence(text, **values) for text, values in said]


def _of_reaction(one: Reaction, names: LatexNames, tongue: Language) -> list[str]:
    if not one.balances:
        return []
    said = constraint_words().reaction_sentences(one, _writer(names, tongue))
    return [tongue.sentence(text, **values) for text, values in said]


def _of_reduction(about: Reduction, names: LatexNames, tongue: Language) -> list[str]:
    said = constraint_words().reduction_sentences(about, _writer(names, tongue))
    return [tongue.sentence(text, **values) for text, values in said]


def _writer(names: LatexNames, tongue: Language) -> Any:
    return constraint_words().Writer(
        lambda listed: "$" + ",\\, ".join(str(names[name]) for name in listed) + "$",
        lambda word: escaped(tongue.say(word)),
        lambda rates: ", ".join(f"${names[name].accented('dot')} = {formula(x)}$" for name, x in rates),
        lambda value, sign: f"${formula(value)} {chr(92) + 'neq' if sign == '!=' else sign} 0$",
        lambda listed: "$" + ",\\, ".join(speed(name, names) for name in listed) + "$",
        lambda places: "$" + ",\\, ".join(f"{'RL'[k // 3]}_{k % 3 + 1}" for k in places) + "$",
        lambda x: "$(" + ",\\, ".join(map(formula, x)) + ")$",
    )


def _literature(found: Stability | None, tongue: Language) -> list[tuple[str, str]]:
    """(name, keys) of each theorem that problem 6 names."""
    named = [] if found is None else dict.fromkeys(theorems_named(found))
    return [(escaped(tongue.say(name)), ",".join(keys_of(name))) for name in named if keys_of(name)]


def decided(found: Stability) -> str:
    """How the verdict at given values was found, if it is one: irrational values have enclosures."""
    if found.numerical is None or found.numerical.word == Word.UNDECIDED:
        return ""
    enclosed = any(part.theory.at_point is None for part in found.subsystems)
    return ", decided by rigorous enclosures" if enclosed else ", decided exactly"


def claimed_names(analysis: Analysis) -> LatexNames:
    """The names of the system, and those of a publication's abbreviations besides."""
    kinds = ("coordinate", "prescribed", "parameter")
    own = ["t", *(g.name for g in analysis.ring.generators if g.kind in kinds)]
    variables = [claim.variable for claim in analysis.system.claims if claim.variable]
    given = {one.name: one.latex for one in analysis.system.symbols}
    return LatexNames([*own, *(item.name for item in analysis.system.abbreviations), *variables], given)


def same(words: str, names: LatexNames) -> str:
    """``-2*c18``: a number and an abbreviation."""
    number, star, name = words.rpartition("*")
    sign = "-" if not star and name.startswith("-") else ""
    bare = str(names[name.removeprefix("-")])
    return f"{number}\\, {bare}" if star else sign + bare


def _exact(value: Fraction) -> str:
    return str(value) if value.denominator == 1 else f"\\tfrac{{{value.numerator}}}{{{value.denominator}}}"


DIALECT = Dialect(call=call, local=lambda count: f"s_{{{count}}}", number=_exact, times=r"\,")


def _code(analysis: Analysis, names: LatexNames) -> Any:
    """Mass matrix and forcing as a straight-line program; None if there is none."""
    system, (programs, _) = analysis.system, programs_of(analysis)
    if programs is None:
        return None
    symbols = {name: str(names[name]) for name in programs.environment if name != "pi"} | {"pi": r"\pi"}
    for name in system.coordinates:
        symbols[velocity_name(name)] = names[name].accented("dot")
        symbols[acceleration_name(name)] = names[name].accented("ddot")
    n = len(system.coordinates)
    upper = [(i, j) for i in range(n) for j in range(i, n)]
    nodes = [programs.mass_matrix[i][j] for i, j in upper]
    body = listing(programs.program, [*nodes, *programs.forcing], symbols, DIALECT)
    if len(body.assignments) > PAPER_PROGRAM:
        return [f"\\text{{({program_not_printed(len(body.assignments))})}}"]
    comma = "," if n > 9 else ""
    lines = [f"{name} = {text}" for name, text in body.assignments]
    lines += [f"M_{{{i + 1}{comma}{j + 1}}} = {text}" for (i, j), text in zip(upper, body.results, strict=False)]
    lines += [f"f_{{{i + 1}}} = {text}" for i, text in enumerate(_tail(body.results, len(upper)))]
    return lines


def _tail(items: Iterable[str], start: int) -> list[str]:
    return list(items)[start:]
