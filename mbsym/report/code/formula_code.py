"""Problems 9 to 12 in ``model.py``: a function for each, with every formula of its result by what it is."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import Failure
from mbsym.algebra.program import Node, Program
from mbsym.algebra.ring import Ring
from mbsym.analysis.small import SmallParameters
from mbsym.formulas.formula import Formula
from mbsym.formulas.names import injective
from mbsym.formulas.straight_line import listing
from mbsym.model.system import System
from mbsym.problems.invariant_sets import InvariantSets, StationarySet
from mbsym.problems.normal_forms import Focus, InSymbols, NormalForms
from mbsym.problems.polynomial_integrals import Polynomials
from mbsym.report.code.functions import Functions
from mbsym.report.words import oscillation_words
from mbsym.report.words.expansion_measured import averages
from mbsym.report.words.expansion_words import coefficients
from mbsym.report.words.integrals_words import level_title, title
from mbsym.report.words.symmetry_words import field_text

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

#: What a formula is, and the formula.
Told = tuple[str, Formula]


@dataclass(frozen=True)
class FormulaFunction:
    """A function of a module: ``unpacked`` are declared names and what the code calls them, ``results`` by what they
    are.  ``missing``: why there is none.
    """

    number: int
    name: str
    unpacked: tuple[tuple[str, str], ...] = ()
    assignments: tuple[tuple[str, str], ...] = ()
    results: tuple[tuple[str, str], ...] = ()
    missing: str = ""


def formula_functions(analysis: Analysis, problems: Sequence[int], writer: Functions) -> list[FormulaFunction]:
    """Of those problems that are asked for and have formulas."""
    from mbsym.analysis import PROBLEMS

    found = []
    for number in (number for number in problems if number in FORMULAS):
        stage, name = analysis.stage(number), PROBLEMS[number].attribute
        if stage.failure is not None:
            found.append(FormulaFunction(number, name, missing=stage.failure.reason))
            continue
        told = list(FORMULAS[number](stage.value, analysis.system))
        if not told:
            continue
        try:
            found.append(_function(number, name, told, writer))
        except Failure as reason:
            found.append(FormulaFunction(number, name, missing=str(reason)))
    return found


def _function(number: int, name: str, told: Sequence[Told], writer: Functions) -> FormulaFunction:
    program = Program()
    carriers: dict[int, Carrier] = {}
    nodes: list[Node] = []
    names: dict[str, None] = {}
    for _, formula in told:
        ring: Ring = formula.ring
        if id(ring) not in carriers:
            names |= dict.fromkeys(ring.names())
            environment = {x: program.input(x) for x in (*ring.names(), "t", "pi")}
            carriers[id(ring)] = Carrier(ring, program, environment)
        nodes.append(carriers[id(ring)](formula.polynomial))
    own = [x for x in names if x not in writer.names]
    called = writer.names | injective(own, _plain, taken={*writer.names.values(), *writer.reserved})
    body = listing(program, nodes, called, writer.dialect, writer.reserved)
    unpacked = tuple((x, called[x]) for x in body.inputs if x != "pi")
    keys = [key for key, _ in told]
    assert len(set(keys)) == len(keys), keys
    return FormulaFunction(number, name, unpacked, body.assignments, tuple(zip(keys, body.results, strict=True)))


def _plain(name: str) -> str:
    return name


def _of_polynomials(found: Polynomials) -> Iterator[Told]:
    for k, (one, formula) in enumerate(zip(found.found.generators, found.formulas, strict=True), start=1):
        yield f"{k}. {title(one)}, weight {one.weight}", formula
    k = len(found.formulas)
    for level, formulas in zip(found.levels, found.on_levels, strict=True):
        for (weight, _), formula in zip(level.integrals, formulas, strict=True):
            k += 1
            yield f"{k}. {level_title(weight, level)}", formula
    for symmetry in () if found.symmetries is None else found.symmetries.symmetries:
        if not symmetry.name:
            k += 1
            yield f"{k}. integral of the symmetry {field_text(symmetry)}", symmetry.integral


def _of_invariant_sets(found: InvariantSets) -> Iterator[Told]:
    for k, (name, formula) in enumerate(found.integrals):
        yield f"V{k}, {name}", formula
    for k, formula in enumerate(found.relations, start=1):
        yield f"relation {k}, zero", formula
    for f, family in enumerate(found.families, start=1):
        for k, one in enumerate(family.sets, start=1):
            yield from ((f"family {f}, set {k}: {key}", formula) for key, formula in _of_set(one))


def _of_set(one: StationarySet) -> Iterator[Told]:
    yield from one.solved
    for k, formula in enumerate(one.relations, start=1):
        yield f"equation {k}, zero", formula
    for name, value in one.multipliers:
        if value is not None:
            yield f"multiplier {name}", value
    yield from ((f"{name}'", formula) for name, formula in one.motion)
    if one.variation is not None:
        for word, relations in (("positive", one.variation.positive), ("negative", one.variation.negative)):
            for k, each in enumerate(relations or (), start=1):
                yield f"second variation {word} {k}, {each.relation} 0", each.formula
    if one.first is not None:
        for k, each in enumerate(one.first.necessary, start=1):
            yield f"necessary {k}, {each.relation} 0", each.formula


def _of_normal_forms(found: NormalForms) -> Iterator[Told]:
    symbols = found.in_symbols
    if isinstance(symbols, InSymbols):
        yield "sum of squares of the frequencies", symbols.trace
        yield "product of squares of the frequencies", symbols.product
        yield "discriminant", symbols.discriminant
        yield "D4", symbols.determinant
        yield "D4 vanishes with", symbols.zero
        for vector, formula in symbols.resonances:
            yield f"resonance {':'.join(map(str, vector))} vanishes with", formula
    elif isinstance(symbols, Focus):
        yield "square of the frequency", symbols.square
        yield f"coefficient for the amplitude of {symbols.amplitude_of}", symbols.coefficient


def _of_small_parameters(found: SmallParameters, system: System) -> Iterator[Told]:
    if found.slow is not None:
        for one in coefficients(found.slow):
            yield f"{one.variable}{chr(39) if one.rate else ''}, order {one.order}", one.formula
    if found.oscillation is not None:
        for one in oscillation_words.coefficients(found.oscillation):
            yield f"periodic solution: {one.variable}{chr(39) if one.rate else ''}, order {one.order}", one.formula
    for each in averages(found, system):
        if each.found is not None:
            over = f"averaged over {each.found.phase} ({each.found.scaling})"
            yield f"effective potential, {over}", each.found.potential
            yield f"what the fast phase adds, {over}", each.found.vibrational


FORMULAS: Mapping[int, Callable[[Any, System], Iterable[Told]]] = {
    9: lambda found, _: _of_polynomials(found),
    10: lambda found, _: _of_invariant_sets(found),
    11: lambda found, _: _of_normal_forms(found),
    12: _of_small_parameters,
}
