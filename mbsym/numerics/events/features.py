"""What is not smooth, or narrow, in the rates of a scenario: found in the program, not by looking at numbers.

    switches   g of every sign(g) and |g|: where g changes its sign the rates jump, or have a kink;
               x of every table f(x): where x passes a knot
    narrow     u of exp(u), whose peaks are where u is greatest, and which becomes a wall where u rises from far below
               0; of tanh u, atan u and cosh u, which turn where u = 0;
               and where u depends on t alone of 1/u and sqrt(u), which are narrow where |u| is least

A step may pass over either without a sign of it: whoever integrates looks at g and u along the step.  Between two
changes of sign the rates are smooth functions, with the signs as constants (``held``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import perm
from typing import Any

from mbsym.algebra.derivative import gradient
from mbsym.algebra.program import Choice, Instruction, Node, Program
from mbsym.expressions.table import Curve, Tabulated
from mbsym.numerics.kernels.interface import Code

#: Where a function of u is narrow: at a greatest u, at u = 0, or at a least |u|.
PEAK, TURN, DIP = "peak", "turn", "dip"
_KINDS = {"exp": PEAK, "tanh": TURN, "atan": TURN, "cosh": TURN, "sinh": TURN, "sqrt": DIP, "divide": DIP}

#: In place of a side of a switch, -1 or 1: the motion stays where it changes.
SLIDING = 0


@dataclass(frozen=True)
class Features:
    """``switches`` and ``narrow`` are (t, q, q') -> g and u; ``kinds`` are those of the latter.

    ``curves`` says of each switch whose argument it is: None for a sign or modulus.
    """

    switches: Code
    curves: tuple[Curve | None, ...]
    narrow: Code
    kinds: tuple[str, ...]

    @property
    def none(self) -> bool:
        """Whether the rates are smooth and have nothing narrow."""
        return not self.switches.outputs and not self.kinds


def features(code: Code) -> Features:
    """What is not smooth, or narrow, in the outputs of a code."""
    program = code.program
    moving = _moving(program, code)
    switches: dict[tuple[int, Curve | None], None] = {}
    narrow: dict[int, str] = {}
    for number in program.live(code.outputs):
        operation, operands, _ = program.instructions[number]
        if operation in ("abs", "sign") and not isinstance(operation, Choice):
            switches[operands[0], None] = None
        elif isinstance(operation, Tabulated):
            switches[operands[0], operation.table.curve] = None
        elif operation in _KINDS:
            below = operands[-1]
            if moving[below] and (_KINDS[operation] != DIP or moving[below] == {"t"}):
                narrow.setdefault(below, _KINDS[operation])
    return Features(
        Code(program, code.inputs, tuple(program.node(number) for number, _ in switches)),
        tuple(curve for _, curve in switches),
        Code(program, code.inputs, tuple(program.node(number) for number in narrow)),
        tuple(narrow.values()),
    )


def _moving(program: Program, code: Code) -> dict[int, set[str]]:
    """The inputs that each live instruction depends on."""
    dependencies: dict[int, set[str]] = {}
    for number in program.live(code.outputs):
        instruction: Instruction = program.instructions[number]
        if instruction.operation == "input":
            dependencies[number] = {str(instruction.payload)}
        else:
            dependencies[number] = set().union(*(dependencies[operand] for operand in instruction.operands))
    return dependencies


@dataclass(frozen=True)
class Polynomial:
    """The piece of a table that is held: its base and its coefficients by rising powers, as nodes."""

    base: Node
    coefficients: tuple[Node, ...]

    def at(self, program: Program, x: Node, order: int) -> Node:
        """Its derivative of that order at x."""
        u, total = program.difference(x, self.base), program.zero
        for power in range(len(self.coefficients) - 1, order - 1, -1):
            own = program.product(program.number(perm(power, order)), self.coefficients[power])
            total = program.plus(program.product(total, u), own)
        return total


#: What stands for sign(g), by the number of g; for a table, by its argument's number and its curve.
Standing = Mapping[int | tuple[int, Curve], Any]


def held(code: Code, standing_for: Standing) -> tuple[Node, ...]:
    """The outputs with what stands for sign(g) in its place, and g times that in place of |g|; a table's polynomial.

    A square root of what g is in stands for that of its absolute value: the same on this side, and finite where a step
    begins to pass over g = 0.
    """
    program = code.program
    values: dict[int, Node] = {}
    changed: set[int] = set()

    def standing(number: int, value: Node) -> Node:
        operation, operands, _ = program.instructions[number]
        if isinstance(operation, Tabulated) and (operands[0], operation.table.curve) in standing_for:
            piece = standing_for[operands[0], operation.table.curve]
            value = piece.at(program, values[operands[0]], operation.curve.order)
        elif operation in ("abs", "sign") and operands[0] in standing_for:
            sign = standing_for[operands[0]]
            value = sign if operation == "sign" else program.product(sign, values[operands[0]])
        elif not changed.isdisjoint(operands):
            if operation == "sqrt":
                value = program.square_root(program.function("abs", values[operands[0]]))
        else:
            values[number] = value
            return value
        changed.add(number)
        values[number] = value
        return value

    # What is held already stands in cells, and a derivative may have them as factors.
    live = map(program.instructions.__getitem__, program.live(code.outputs))
    cells = [str(instruction.payload) for instruction in live if instruction.operation == "input"]
    inputs = {name: program.input(name) for name in (*code.inputs, *cells)}
    return tuple(program.evaluate(code.outputs, inputs, program, standing))


def sign_that_holds(rates: Code, sliding: Node, others: Standing) -> Code:
    """(t, q, q') -> s and (g'(-1) - 2 g'(0) + g'(1))/(g'(1) - g'(-1)), where the one ``sliding`` switch g stays 0,

    with s for its sign,

        g' = g_t + g_x . x' = a + b s = 0,    s = -a/b,

    g' along the motion being linear in s where the second is 0 (Filippov, Differential equations with discontinuous
    righthand sides, 1988, chapter 2; it is Utkin's equivalent control).  ``others`` stands for the
    other switches.
    """
    program = rates.program
    slopes = gradient(program, sliding, [program.input(name) for name in rates.inputs])

    def rate(side: int) -> Node:
        signs = {**others, sliding.number: program.number(side)}
        by_time, *by_state = held(Code(program, rates.inputs, slopes), signs)
        for slope, speed in zip(by_state, held(rates, signs), strict=True):
            by_time = by_time + program.product(slope, speed)
        return by_time

    below, at, above = rate(-1), rate(0), rate(1)
    two = program.number(2)
    sign, curved = (
        program.divide(part, above - below)
        for part in (program.minus(program.product(two, at)), below + above - program.product(two, at))
    )
    return Code(program, rates.inputs, (sign, curved))
