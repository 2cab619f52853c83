"""Function bodies in any language, from nodes of a program: names unpacked, assignments, results."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass

from mbsym.algebra.base import Lowering
from mbsym.algebra.program import Node, Program
from mbsym.expressions.table import Tabulated
from mbsym.expressions.tree import ZERO, Expression, Name, add, multiply
from mbsym.formulas.names import injective
from mbsym.formulas.straight_line import Dialect, Listing, listing
from mbsym.mechanics.variables import program_environment
from mbsym.model.inputs import force_names
from mbsym.model.system import Prescribed, System, acceleration_name
from mbsym.report.code.lookups import identifiers


@dataclass(frozen=True)
class Function:
    """A function's body: which names it unpacks, its assignments, and what it stores."""

    coordinates: tuple[tuple[int, str], ...]
    velocities: tuple[tuple[int, str], ...]
    parameters: tuple[tuple[int, str], ...]
    assignments: tuple[tuple[str, str], ...]
    results: tuple[str, ...]
    time: bool = False
    inputs: tuple[tuple[int, str], ...] = ()
    accelerations: tuple[tuple[int, str], ...] = ()
    forces: tuple[tuple[int, str], ...] = ()


def prescribed_value(item: Prescribed) -> Expression:
    """initial + rate*t."""
    return moving(item.initial, item.rate)


def moving(initial: Expression | None, rate: Expression) -> Expression:
    """initial + rate*t."""
    return add(initial or ZERO, multiply(rate, Name("t")))


def words_of_inputs(system: System) -> frozenset[str]:
    """What generated code calls inputs, where there are any: no name of the description is one of these."""
    return frozenset(("u", "INPUTS", "Inputs", "HELD", "B", "input_matrix", "held")) if system.inputs else frozenset()


class Functions:
    """Turns nodes of a program into function bodies with names that the language lets us use.

    ``propose`` turns a declared name into one of the language, ``pi`` is how the language writes that number.
    """

    def __init__(
        self, system: System, dialect: Dialect, reserved: Collection[str], propose: Callable[[str], str], pi: str
    ) -> None:
        self.system, self.dialect, self.reserved = system, dialect, frozenset(reserved) | words_of_inputs(system)
        if dialect.tables:
            self.reserved |= identifiers(system)
        self.tables: dict[Tabulated, None] = {}  # that are called
        names = [*system.coordinates, *system.velocities, *system.parameter_names]
        names += [*(item.name for item in system.prescribed), *system.input_names, *system.variables]
        names += [*map(acceleration_name, system.coordinates), *force_names(system)]
        self.names = injective(names, propose, taken=self.reserved) | {"t": "t", "pi": pi}

    def function(self, program: Program, outputs: Iterable[Node]) -> Function:
        """A body for the outputs, prescribed quantities computed from the time first."""
        outputs = list(outputs)
        if self.dialect.tables:
            called = (program.instructions[number].operation for number in program.live(outputs))
            self.tables |= {name: None for name in called if isinstance(name, Tabulated)}
        body = listing(program, outputs, self.names, self.dialect, self.reserved)
        driven = self._prescribed(set(body.inputs), {name for name, _ in body.assignments})
        used = {*body.inputs, *driven.inputs}
        system = self.system
        return Function(
            coordinates=self._unpacked(system.coordinates, used),
            velocities=self._unpacked(system.velocities, used),
            parameters=self._unpacked(system.parameter_names, used),
            assignments=(*driven.assignments, *body.assignments),
            results=body.results,
            time="t" in used,
            inputs=self._unpacked(system.input_names, used),
            accelerations=self._unpacked(tuple(map(acceleration_name, system.coordinates)), used),
            forces=self._unpacked(force_names(system), used),
        )

    def expression(self, value: Expression) -> str:
        """A value of the description as one expression in the names of the language."""
        program = Program()
        node = Lowering(program, program_environment(self.system, program))(value)
        return listing(program, [node], self.names, self.dialect, inline=True).results[0]

    def _unpacked(self, names: Sequence[str], used: set[str]) -> tuple[tuple[int, str], ...]:
        return tuple((place, self.names[name]) for place, name in enumerate(names) if name in used)

    def _prescribed(self, used: set[str], taken: set[str]) -> Listing:
        """x = initial + rate*t for the prescribed quantities that occur."""
        program = Program()
        lower = Lowering(program, program_environment(self.system, program))
        wanted = [item for item in self.system.prescribed if item.name in used]
        values = [lower(prescribed_value(item)) for item in wanted]
        found = listing(program, values, self.names, self.dialect, self.reserved | taken)
        named = tuple((self.names[item.name], x) for item, x in zip(wanted, found.results, strict=True))
        return Listing((*found.assignments, *named), (), found.inputs)
