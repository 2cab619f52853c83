"""Code from a straight-line program: one assignment per instruction, what is used once written in its place.

Code is made from here, never from expanded formulas: it is short, and it computes what the self-check has checked.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain

from mbsym.algebra.base import Lowering
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.program import Instruction, Node, Program
from mbsym.expressions.table import Tabulated
from mbsym.expressions.tree import MOST_WRITTEN_OUT, Name, slope_written_out, written_out
from mbsym.formulas.tree import writable

#: Longer expressions are given a name even if they are used only once.
WIDTH = 60

_SUM, _PRODUCT, _ATOM = 1, 2, 3


@dataclass(frozen=True)
class Dialect:
    """How a language writes what differs between languages.

    ``call`` applies a function, known by Python's name; ``local`` is the k-th local name; ``angle`` names the sine or
    cosine of a name, if the language has a nice way.  ``tables``: whether ``call`` can write those.
    """

    call: Callable[[str, str], str] = lambda function, argument: f"{function}({argument})"
    local: Callable[[int], str] = lambda count: f"s{count}"
    number: Callable[[Fraction], str] = str
    times: str = "*"
    angle: Callable[[str, str], str] | None = None
    tables: bool = False


def angle_name(function: str, name: str) -> str:
    """``sin_theta``."""
    return f"{function}_{name}"


@dataclass(frozen=True)
class Listing:
    """``assignments`` in order, and the outputs as expressions in them; ``inputs`` that occur, in order."""

    assignments: tuple[tuple[str, str], ...]
    results: tuple[str, ...]
    inputs: tuple[str, ...]


def listing(
    program: Program,
    outputs: Iterable[Node],
    names: Mapping[str, str],
    dialect: Dialect,
    taken: Collection[str] = (),
    inline: bool = False,
) -> Listing:
    """Straight-line code for the outputs; ``names`` renames the inputs, locals avoid them and ``taken``.

    With ``inline`` there are no assignments: what is used twice is written twice.  Raises NoClosedForm for a table that
    the language cannot have.
    """
    nodes = list(outputs)
    if not dialect.tables:
        program, nodes = unfolded(program, nodes)
    return _Writer(program, nodes, names, dialect, {*taken, *names.values()}).listing(inline)


def short_listing(
    program: Program, outputs: Iterable[Node], names: Mapping[str, str], dialect: Dialect, most: int
) -> Listing | None:
    """The same, or None where it has more than ``most`` assignments: long programs are not written to see that."""
    outputs = list(outputs)
    uses = _uses(program, outputs)
    leaves = ("input", "constant")
    shared = sum(count > 1 and program.instructions[k].operation not in leaves for k, count in uses.items())
    if shared > most:
        return None
    program_listing = listing(program, outputs, names, dialect)
    return None if len(program_listing.assignments) > most else program_listing


def _uses(program: Program, outputs: Iterable[Node]) -> Counter[int]:
    """How often the value of each instruction is used."""
    outputs = list(outputs)
    uses = Counter(chain.from_iterable(program.instructions[k].operands for k in program.live(outputs)))
    uses.update(node.number for node in outputs)
    return uses


class _Writer:
    def __init__(
        self, program: Program, outputs: list[Node], names: Mapping[str, str], dialect: Dialect, used: set[str]
    ) -> None:
        self.program = program
        self.outputs = outputs
        self.names = names
        self.dialect = dialect
        self.used = used
        self.live = program.live(outputs)
        self.written: dict[int, tuple[str, int]] = {}
        self.assignments: list[tuple[str, str]] = []
        self._count = 0
        #: Of operations on two: the sign, what both sides have to be, what comes of it.
        self._signs = {
            "add": (" + ", _SUM, _SUM, _SUM),
            "subtract": (" - ", _SUM, _PRODUCT, _SUM),
            "multiply": (dialect.times, _PRODUCT, _ATOM, _PRODUCT),
            "divide": ("/", _PRODUCT, _ATOM, _PRODUCT),
        }

    def listing(self, inline: bool) -> Listing:
        uses, inputs = _uses(self.program, self.outputs), []
        instructions, signs, written = self.program.instructions, self._signs, self.written
        for number in self.live:
            instruction = instructions[number]
            operation, operands, _ = instruction
            known = signs.get(operation)
            if known is not None:  # nearly all are of this kind, and there may be hundreds of thousands
                sign, left, right, precedence = known
                (a, first), (b, second) = written[operands[0]], written[operands[1]]
                text = f"{a if first >= left else f'({a})'}{sign}{b if second >= right else f'({b})'}"
            else:
                text, precedence = self._text(instruction)
            if operation == "input":
                inputs.append(str(instruction.payload))
            elif not inline and operation != "constant" and (uses[number] > 1 or len(text) > WIDTH):
                name = self._fresh(instruction)
                self.assignments.append((name, text))
                text, precedence = name, _ATOM
            written[number] = text, precedence
        results = tuple(self.written[node.number][0] for node in self.outputs)
        return Listing(tuple(self.assignments), results, tuple(inputs))

    def _fresh(self, instruction: Instruction) -> str:
        """A local name: ``cos_theta`` where that says it, else the next number."""
        if self.dialect.angle is not None and instruction.operation in ("sin", "cos"):
            argument = self.written[instruction.operands[0]][0]
            name = self.dialect.angle(instruction.operation, argument)
            if argument in self.names.values() and name not in self.used:
                self.used.add(name)
                return name
        while True:
            self._count += 1
            name = self.dialect.local(self._count)
            if name not in self.used:
                return name

    def _text(self, instruction: Instruction) -> tuple[str, int]:
        """Whatever is no operation on two, and how tightly it binds."""
        match instruction.operation, instruction.payload, instruction.operands:
            case "input", str(name), _:
                return self.names[name], _ATOM
            case "constant", Fraction() as value, _:
                writable(value.numerator, value.denominator)
                whole = value.denominator == 1 and value >= 0
                return self.dialect.number(value), _ATOM if whole else _SUM if value < 0 else _PRODUCT
            case "negative", _, (a,):
                return f"-{self._operand(a, _PRODUCT)}", _SUM
            case function, _, (a,):
                return self.dialect.call(function, self._operand(a, _SUM)), _ATOM
        raise ValueError(f"no such operation: {instruction.operation}")

    def _operand(self, number: int, required: int) -> str:
        text, precedence = self.written[number]
        return text if precedence >= required else f"({text})"


class WithoutTables(Program):
    """A program in which f(x) of a table is a sum over its knots; see ``written_out``."""

    def function(self, name: str, x: Node) -> Node:
        """Raises NoClosedForm for a table of many points."""
        if not isinstance(name, Tabulated) or name.curve.constant is not None:
            return super().function(name, x)
        table, count = name.table, len(name.table.points)
        if count > MOST_WRITTEN_OUT:
            raise NoClosedForm(
                "the table [[table]] has [[count]] points: there it is written out by moduli, up to [[most]]",
                table=table.name,
                count=count,
                most=MOST_WRITTEN_OUT,
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
