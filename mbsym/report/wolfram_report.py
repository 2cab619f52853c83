"""``report.wl``: the results as definitions in the Wolfram Language, ready for NDSolve."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from mbsym.expressions.rates import without_velocity
from mbsym.expressions.tree import ZERO, Expression
from mbsym.formulas.formula import Formula
from mbsym.formulas.names import free_name
from mbsym.formulas.straight_line import Dialect, short_listing
from mbsym.formulas.wolfram import (
    WolframNames,
    wolfram_call,
    wolfram_definition,
    wolfram_expression,
    wolfram_names,
    wolfram_number,
    wolfram_text,
)
from mbsym.model.system import System
from mbsym.report.canonical import forms_of
from mbsym.report.code.functions import courses
from mbsym.report.code.programs import programs_of
from mbsym.report.conditions import Statement, provided, statements
from mbsym.report.environment import rendered
from mbsym.report.lengths import COUNTED, FILE, FILE_PROGRAM, formulas, not_printed, program_not_printed, withheld
from mbsym.report.plain_writer import LONGEST, Writer
from mbsym.report.results import contents, results
from mbsym.report.sections.linearisation import first_order

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.analysis.small import SmallParameters

DIALECT = Dialect(call=wolfram_call, number=wolfram_number, tables=True)


def render(analysis: Analysis, problems: Sequence[int]) -> str:
    """The file's text."""
    from mbsym.analysis import PROBLEMS, USUAL_PROBLEMS

    sections = contents(
        results(analysis, problems), Writer(readable=True, longest=LONGEST, file="results.json").document
    )
    names = wolfram_names(analysis.ring)
    stages = {number: analysis.stage(number) for number in problems}
    solved = {number: stage.value for number, stage in stages.items() if stage.failure is None}
    used = {names[name] for name in names.table}
    forms = forms_of(analysis, problems)
    long = withheld([*(solved[number] for number in COUNTED if number in solved), *forms.results], FILE)
    closed = solved.get(3)
    if closed is not None and any(id(x) in long for x in formulas((closed.mass_matrix, closed.forcing))):
        del solved[3]  # equations that are not whole are none: the program takes their place

    def written(value: Formula) -> str:
        if id(value) in long:
            return string(Writer().said(not_printed(value)))
        return wolfram_text(value.ring, value.polynomial)

    return rendered(
        "report.wl.j2",
        {
            "wl": written,
            "rationals": lambda rows: listed(listed(str(x) for x in row) for row in rows),
            "expression": lambda value: wolfram_expression(value, names),
            "list": listed,
            "speed": lambda name: names[name] + "[t]" if name in analysis.system.variables else _rate(name, names),
            "entries": entries,
            "string": string,
            "comment": comment,
            "condition": condition,
            "momentum": lambda name: wolfram_names(forms.hamilton_ring)[name],
            "constant_momentum": lambda name: wolfram_names(forms.routh_ring)[name],
        },
        system=analysis.system,
        names=names,
        found=solved,
        lines={n: [x.text for x in sections[n]()][1:] for n in solved if n not in USUAL_PROBLEMS},
        polynomial_formulas=[x.wolfram() for x in solved[9].formulas] if 9 in solved else [],
        small_parameter_formulas=list(_of_small_parameters(solved[12], analysis.system, names)) if 12 in solved else [],
        forms=forms,
        undetermined=_undetermined(analysis) if 3 in problems else "",
        reactions=(analysis.optional("reactions") or ()) if analysis.system.reactions and 3 in problems else (),
        parts=[PROBLEMS[number] for number in problems],
        failures=[(number, stage.failure) for number, stage in stages.items() if stage.failure is not None],
        code=_code(analysis) if 3 in stages and 3 not in solved else None,
        tables=[wolfram_definition(table) for table in analysis.system.tables],
        prescribed=[(names[name], courses(analysis.system)[name]) for name in _told(analysis.system)],
        lawless=[item.name for item in analysis.system.given if item.law is None],
        statements=statements,
        polynomial=polynomial,
        variable=free_name("\\[Lambda]", used),
        initial=[f"{left} == {wolfram_expression(value, names)}" for left, value in _initial(analysis.system, names)],
        state=_in_order(analysis.system, names),
        numberless=[names[name] for name in _numberless(analysis.system)],
        **first_order(analysis, solved.get(5)),
        provided=provided(solved[6], analysis.optional("equilibrium"), bool(analysis.system.inputs))
        if 6 in solved
        else "",
        checks=analysis.checks,
    )


def _of_small_parameters(small: SmallParameters, system: System, names: WolframNames) -> Iterator[tuple[str, str]]:
    """Definitions: coefficients as {variable, power, formula}, their sums, effective potentials by phase."""
    from mbsym.report.sections.small_parameters import functions
    from mbsym.report.words import oscillation_words
    from mbsym.report.words.expansion_measured import averages
    from mbsym.report.words.expansion_words import coefficients

    if small.slow is not None:
        listed_ones = list(coefficients(small.slow))
        for name, flow in (("slowManifold", False), ("slowFlow", True)):
            selected = ((x.variable + chr(39) * (x.rate - flow), x) for x in listed_ones if x.flow is flow)
            yield name, listed(f"{{{string(label)}, {x.order}, {x.formula.wolfram()}}}" for label, x in selected)
    if small.oscillation is not None:
        terms = (
            f"{{{string(x.variable + chr(39) * x.rate)}, {x.order}, {x.formula.wolfram()}}}"
            for x in oscillation_words.coefficients(small.oscillation)
        )
        yield "periodicSolution", listed(terms)
    for function in functions(small):
        sums = {key: _sum(parts, function.small, names) for key, parts in function.series}
        rate = sums.pop(function.phase, "")
        put = (
            f" /. {wolfram_names(small.oscillation.ring)[function.phase]}[t] -> ({rate})*t"
            if small.oscillation and rate
            else ""
        )
        head, *rest = function.name.split("_")
        yield f"{head}{''.join(map(str.title, rest))}Of", listed(f"{string(k)} -> {x}" for k, x in sums.items()) + put
    potentials = [average.averaged for average in averages(small, system) if average.averaged is not None]
    if potentials:
        yield (
            "effectivePotentials",
            listed(f"{{{string(', '.join(x.phases))}, {x.potential.wolfram()}}}" for x in potentials),
        )


def _sum(parts: Iterable[tuple[int, Formula]], small: str, names: WolframNames) -> str:
    from mbsym.report.words.expansion_words import sum_of_powers

    written = names[small] if small in names.table else small
    return sum_of_powers(((k, x.wolfram()) for k, x in parts), written, "^")


def _rate(velocity: str, names: WolframNames) -> str:
    """``x'[t]`` for ``x_dot``."""
    return f"{names[without_velocity(velocity)]}'[t]"


def _initial(system: System, names: WolframNames) -> Iterator[tuple[str, Expression]]:
    """The state at t = 0 as simulations take it: velocities that are left out are zero, positions are not made up."""
    for item in system.begun:
        if item.position is not None:
            yield f"{names[item.coordinate]}[0]", item.position
        yield f"{names[item.coordinate]}'[0]", ZERO if item.velocity is None else item.velocity


def _in_order(system: System, names: WolframNames) -> list[str]:
    """q(0) and q'(0) in the order of the coordinates, zero for what is not given."""
    values = {item.coordinate: item for item in system.begun}
    places = [values[name].position if name in values else None for name in system.coordinates]
    rates = [values[name].velocity if name in values else None for name in system.coordinates]
    return [wolfram_expression(ZERO if value is None else value, names) for value in places + rates]


def _numberless(system: System) -> Iterator[str]:
    """Parameters and coordinates without a number, which NDSolve would need."""
    related = {relation.name for relation in system.relations}
    yield from (item.name for item in system.parameters if item.value is None and item.name not in related)
    placed = {item.coordinate for item in system.begun if item.position is not None}
    yield from (name for name in system.coordinates if name not in placed)


def entries(items: Iterable[str], break_: str) -> str:
    """Entries of a row, on one line if they are short."""
    written = list(items)
    return (", " if sum(map(len, written)) < 100 else "," + break_).join(written)


def string(words: str) -> str:
    """A string literal, in ASCII."""
    escaped = words.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(map(_ascii, escaped)) + '"'


def _ascii(character: str) -> str:
    if " " <= character <= "~":
        return character
    return f"\\:{ord(character):04x}" if ord(character) < 0x10000 else "?"


def comment(words: str) -> str:
    """Text that may stand in a comment."""
    plain = "".join(c if " " <= c <= "~" else "?" for c in " ".join(words.split()))
    return plain.replace("(*", "( *").replace("*)", "* )")


def listed(items: Iterable[str], between: str = ", ") -> str:
    return "{" + between.join(items) + "}"


def condition(statement: Statement) -> str:
    """An inequality, or a string that says why there is none."""
    if statement.formula is None:
        return string(f"{statement.label} {statement.relation} 0: {statement.note}")
    return f"{statement.formula.wolfram()} {statement.relation} 0"


def polynomial(coefficients: Sequence[Formula], variable: str) -> str:
    """sum of coefficient*variable^k, highest power first; the coefficients stay factored."""
    written = []
    for power, coefficient in reversed(list(enumerate(coefficients))):
        if not coefficient.is_zero:
            factor = f"({coefficient.wolfram()})"
            written.append(factor if power == 0 else f"{factor}*{variable}^{power}")
    return " + ".join(written) or "0"


def _told(system: System) -> list[str]:
    """What is prescribed by a formula; derivatives are left to Wolfram."""
    known = [item.name for item in system.given if item.law is not None]
    return [*(item.name for item in system.of_constant_rate), *known]


def _code(analysis: Analysis) -> dict[str, Any] | None:
    """Mass matrix and forcing as straight-line code over plain symbols; None if there is none."""
    system, (programs, _) = analysis.system, programs_of(analysis)
    if programs is None:
        return None
    names = wolfram_names(analysis.ring)
    inputs = {name: names[name] for name in programs.environment}
    nodes = [*(x for row in programs.mass_matrix for x in row), *programs.forcing]
    n = len(system.coordinates)
    body = short_listing(programs.program, nodes, inputs, DIALECT, FILE_PROGRAM)
    if body is None:
        return {"omitted": Writer().said(program_not_printed(programs.program, nodes))}
    known = {item.name: wolfram_expression(courses(system)[item.name], names) for item in system.of_constant_rate}
    for function in system.given:
        known |= {name: f"{names[function.name]}{chr(39) * k}[t]" for k, name in enumerate(function.names)}
    return {
        "positions": [names[name] for name in system.coordinates],
        "velocities": [names[name] for name in system.velocities],
        "body": body,
        "locals": [name for name, _ in body.assignments],
        "prescribed": {names[name]: value for name, value in known.items() if name in body.inputs},
        "mass": [body.results[i * n : (i + 1) * n] for i in range(n)],
        "forcing": body.results[n * n :],
        "omitted": "",
    }


def _undetermined(analysis: Analysis) -> str:
    if not (analysis.system.reactions and analysis.system.constraints):
        return ""
    from mbsym.report.code.model_code import undetermined  # few descriptions ask for reactions

    return undetermined(analysis).replace("*)", "* )")
