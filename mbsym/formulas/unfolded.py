"""Programs whose tables are written out by moduli, for languages without tables."""

from __future__ import annotations

from collections.abc import Sequence

from mbsym.algebra.base import Lowering
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.program import Node, Program
from mbsym.expressions.message import Message
from mbsym.expressions.table import Tabulated
from mbsym.expressions.tree import MOST_WRITTEN_OUT, Name, slope_written_out, written_out


class WithoutTables(Program):
    """A program in which f(x) of a table is a sum over its knots; see ``written_out``."""

    def function(self, name: str, x: Node) -> Node:
        """Raises NoClosedForm for a table of many points."""
        if not isinstance(name, Tabulated) or name.curve.constant is not None:
            return super().function(name, x)
        table, count = name.table, len(name.table.points)
        if count > MOST_WRITTEN_OUT:
            raise NoClosedForm(
                Message(
                    "the table [[table]] has [[count]] points: there it is written out by moduli, up to [[most]]",
                    table=table.name,
                    count=count,
                    most=MOST_WRITTEN_OUT,
                )
            )
        at = Name("x")
        expression = slope_written_out(name.curve, at) if name.curve.order else written_out(table, at, whole=False)
        return Lowering(self, {"x": x})(expression)


def unfolded(program: Program, outputs: Sequence[Node]) -> tuple[Program, list[Node]]:
    """The same outputs in a program without tables; the program itself where it has none."""
    if not any(isinstance(program.instructions[number].operation, Tabulated) for number in program.live(outputs)):
        return program, list(outputs)
    fresh = WithoutTables()
    inputs = {
        str(program.instructions[number].payload): fresh.input(str(program.instructions[number].payload))
        for number in program.live(outputs)
        if program.instructions[number].operation == "input"
    }
    return fresh, program.evaluate(outputs, inputs, fresh)
