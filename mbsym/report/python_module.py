"""``model.py``: one self-contained module, numpy only, its code taken from the straight-line program."""

from __future__ import annotations

import builtins
import keyword
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from textwrap import fill
from typing import TYPE_CHECKING

from mbsym.algebra.base import Lowering
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.program import Node, Program
from mbsym.expressions.tree import ZERO, Expression, Name, add, multiply, text
from mbsym.formulas.names import injective
from mbsym.mechanics.variables import program_environment
from mbsym.model.system import Prescribed, System, rational
from mbsym.problems.linearisation import Linearisation
from mbsym.report.environment import rendered
from mbsym.report.straight_line import Dialect, Listing, listing, programs_of

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

#: What the module itself calls something.
RESERVED = {
    *keyword.kwlist, *dir(builtins), "np", "Mapping", "q", "qd", "p", "t", "x", "M", "D", "G", "K", "N", "f", "n",
    "result", "velocities", "accelerations", "annotations", "COORDINATES", "PARAMETERS", "DEFAULTS", "mass_matrix",
    "forcing", "rhs", "energy", "linear_matrices",
}  # fmt: skip

_NUMPY = {"atan": "arctan"}
DIALECT = Dialect(
    call=lambda function, argument: f"np.{_NUMPY.get(function, function)}({argument})",
    local=lambda count: f"s{count}",
    angle=lambda function, name: f"{function}_{name}",
)


@dataclass(frozen=True)
class Function:
    """A function's body: which names it unpacks, its assignments, and what it stores."""

    coordinates: tuple[tuple[int, str], ...]
    velocities: tuple[tuple[int, str], ...]
    parameters: tuple[tuple[int, str], ...]
    assignments: tuple[tuple[str, str], ...]
    results: tuple[str, ...]


def render(analysis: Analysis, problems: Sequence[int]) -> str:
    """The module's text."""
    system, (code, no_code) = analysis.system, programs_of(analysis)
    writer = _Module(system)
    n = len(system.coordinates)
    upper = [(i, j) for i in range(n) for j in range(i, n)]
    linear = analysis.stage(5) if 5 in problems else None
    matrices = None
    if linear is not None and linear.failure is None:
        matrices = writer.linear(analysis, linear.value)
    return rendered(
        "model.py.j2",
        {},
        system=system,
        title=plain(system.name),
        description=fill(plain(system.description), 110),
        n=n,
        defaults=[(item.name, _default(item.value)) for item in system.parameters],
        meanings=[(item.name, plain(item.meaning)) for item in system.parameters if item.meaning],
        relations=[(item.name, text(item.value)) for item in system.relations],
        prescribed=[(item.name, text(prescribed_value(item))) for item in system.prescribed],
        no_code=plain(no_code),
        upper=upper,
        mass=code and writer.function(code.program, [code.mass_matrix[i][j] for i, j in upper]),
        forcing=code and writer.function(code.program, code.forcing),
        energy=code and writer.function(code.program, [code.energy]),
        linear=matrices,
        unavailable="" if linear is None or linear.failure is None else plain(linear.failure.reason),
    )


def plain(words: str) -> str:
    """Text that may stand in a docstring or a comment."""
    return " ".join(words.replace("\\", "/").replace('"', "'").split())


def prescribed_value(item: Prescribed) -> Expression:
    """initial + rate*t."""
    return moving(item.initial, item.rate)


def moving(initial: Expression | None, rate: Expression) -> Expression:
    """initial + rate*t."""
    return add(initial or ZERO, multiply(rate, Name("t")))


def _default(value: Expression | None) -> str:
    """A number as Python reads it, or None: nothing is made up."""
    if value is None:
        return "None"
    number = rational(value)
    if number is None:
        program = Program()
        node = Lowering(program, {"pi": program.input("pi")})(value)
        return listing(program, [node], {"pi": "np.pi"}, DIALECT).results[0]
    return str(number.numerator) if number.denominator == 1 else _decimal(number)


def _decimal(number: Fraction) -> str:
    shown = repr(float(number))
    return shown if Fraction(shown) == number else f"{number.numerator} / {number.denominator}"


class _Module:
    """Turns nodes of a program into function bodies with names that Python lets us use."""

    def __init__(self, system: System) -> None:
        self.system = system
        names = [*system.coordinates, *system.velocities, *system.parameter_names]
        names += [item.name for item in system.prescribed]
        reserved = RESERVED
        self.names = injective(names, lambda name: name + "_" if name in reserved else name, taken=reserved)
        self.names |= {"t": "t", "pi": "np.pi"}

    def function(self, program: Program, outputs: Iterable[Node]) -> Function:
        """A body for the outputs, prescribed quantities computed from the time first."""
        body = listing(program, outputs, self.names, DIALECT, RESERVED)
        driven = self._prescribed(set(body.inputs), {name for name, _ in body.assignments})
        used = {*body.inputs, *driven.inputs}
        system = self.system
        return Function(
            coordinates=self._unpacked(system.coordinates, used),
            velocities=self._unpacked(system.velocities, used),
            parameters=self._unpacked(system.parameter_names, used),
            assignments=(*driven.assignments, *body.assignments),
            results=body.results,
        )

    def _unpacked(self, names: Sequence[str], used: set[str]) -> tuple[tuple[int, str], ...]:
        return tuple((place, self.names[name]) for place, name in enumerate(names) if name in used)

    def _prescribed(self, used: set[str], taken: set[str]) -> Listing:
        """x = initial + rate*t for the prescribed quantities that occur."""
        program = Program()
        lower = Lowering(program, program_environment(self.system, program))
        wanted = [item for item in self.system.prescribed if item.name in used]
        values = [lower(prescribed_value(item)) for item in wanted]
        found = listing(program, values, self.names, DIALECT, RESERVED | taken)
        named = tuple((self.names[item.name], x) for item, x in zip(wanted, found.results, strict=True))
        return Listing((*found.assignments, *named), (), found.inputs)

    def linear(self, analysis: Analysis, found: Linearisation) -> tuple[Function, list[tuple[str, int, int]]]:
        """M, D, G, K, N entry by entry, zeros left out."""
        program = Program()
        carry = Carrier(analysis.ring, program, program_environment(self.system, program))
        places, nodes = [], []
        for name, matrix in zip("MDGKN", found.matrices, strict=True):
            for i, row in enumerate(matrix):
                for j, entry in enumerate(row):
                    if not entry.is_zero:
                        places.append((name, i, j))
                        nodes.append(carry(entry.polynomial))
        return self.function(program, nodes), places
