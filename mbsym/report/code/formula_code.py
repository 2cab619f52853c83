"""Problems 9 to 12 in ``model.py``: a function for each, with every formula of its result by what it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import Failure
from mbsym.algebra.program import Node, Program
from mbsym.algebra.ring import Ring
from mbsym.formulas.formula import Formula
from mbsym.formulas.names import injective
from mbsym.formulas.straight_line import listing
from mbsym.report.code.functions import Functions
from mbsym.report.sections import section_of

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

#: What a formula is, and the formula.
Told = tuple[str, Formula]

#: The problems from here on have their formulas in functions.
FIRST = 9


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
    for number in (number for number in problems if number >= FIRST):
        stage, name = analysis.stage(number), PROBLEMS[number].attribute
        if stage.failure is not None:
            found.append(FormulaFunction(number, name, missing=stage.failure.reason))
            continue
        told = list(section_of(PROBLEMS[number]).formulas(stage.value, analysis.system))
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
