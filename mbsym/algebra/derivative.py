"""Exact derivatives of straight-line programs, as further nodes of the same program.

For every operation y = f(a, b) the local partial derivatives are known; the chain rule collects them

    forwards    dy/dx = df/da da/dx + df/db db/dx            one sweep for each input x,
    backwards   dz/da += dz/dy df/da                         one sweep for each output z

(Griewank & Walther, Evaluating Derivatives, 2nd ed. 2008, chapter 3).  What does not depend on the
inputs, or does not reach the outputs, takes no operation, and hash-consing shares what the sweeps have in common.  The
derivative of a sign is 0, off its jump.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from mbsym.algebra.program import Node, Program
from mbsym.expressions.table import Tabulated

#: Partial derivatives of an operation by its operands; None stands for 1, and the bool says whether the sign is minus.
_Factor = tuple[Node | None, bool]


def gradient(program: Program, output: Node, inputs: Sequence[Node]) -> tuple[Node, ...]:
    """(d output / d x for x in inputs), by one sweep backwards; the inputs are taken as independent of each other."""
    return _Sweeps(program, [output], inputs).backwards(0)


def jacobian(program: Program, outputs: Sequence[Node], inputs: Sequence[Node]) -> tuple[tuple[Node, ...], ...]:
    """Row i holds d outputs[i] / d x for x in inputs, by sweeps forwards or backwards, whichever costs less.

    The operations are counted from the dependences between nodes, before either is written down.
    """
    sweeps = _Sweeps(program, outputs, inputs)
    forwards, backwards = sweeps.costs()
    if backwards <= forwards:
        return tuple(sweeps.backwards(place) for place in range(len(outputs)))
    columns = [sweeps.forwards(place) for place in range(len(inputs))]
    return tuple(tuple(column[i] for column in columns) for i in range(len(outputs)))


def directional(
    program: Program, outputs: Sequence[Node], inputs: Sequence[Node], direction: Sequence[Node]
) -> tuple[Node, ...]:
    """(sum_x d output / d x v_x for output in outputs): the derivatives along ``direction``, by one sweep forwards."""
    return _Sweeps(program, outputs, inputs).along(direction)


class _Sweeps:
    """The part of a program that lies between some inputs and some outputs."""

    def __init__(self, program: Program, outputs: Sequence[Node], inputs: Sequence[Node]) -> None:
        self.program = program
        self.outputs = tuple(outputs)
        self.inputs = tuple(inputs)
        self.live = program.live(outputs)
        #: By number of instruction, a bit for each input it depends on; inputs do not depend on what made them.
        self.needs: dict[int, int] = {}
        seeds: dict[int, int] = {}
        for place, node in enumerate(self.inputs):
            seeds[node.number] = seeds.get(node.number, 0) | 1 << place
        self.seeds = seeds
        for number in self.live:
            mask = seeds.get(number)
            if mask is None:
                mask = 0
                for operand in program.instructions[number].operands:
                    mask |= self.needs[operand]
            self.needs[number] = mask
        self._factors: dict[int, tuple[_Factor, ...]] = {}

    def _active(self, number: int) -> bool:
        """Whether derivatives pass through this instruction."""
        return bool(self.needs[number]) and number not in self.seeds

    def costs(self) -> tuple[int, int]:
        """About how many operations all sweeps take: forwards, backwards."""
        serves: dict[int, int] = dict.fromkeys(self.live, 0)
        for place, node in enumerate(self.outputs):
            serves[node.number] |= 1 << place
        ahead = behind = 0
        for number in reversed(self.live):
            if not self._active(number):
                continue
            operation, operands, _ = self.program.instructions[number]
            reaching = [operand for operand in operands if self.needs[operand]]
            for operand in reaching:
                serves[operand] |= serves[number]
            each = 0 if operation in ("add", "subtract", "negative") else 1
            for operand in reaching:
                ahead += each * self.needs[operand].bit_count()
                behind += (each + 1) * serves[number].bit_count()
            if len(reaching) == 2:
                ahead += (self.needs[reaching[0]] & self.needs[reaching[1]]).bit_count()
        return ahead, behind

    # --- sweeps ---

    def backwards(self, place: int) -> tuple[Node, ...]:
        """The derivatives of one output by all inputs."""
        program = self.program
        output = self.outputs[place].number
        adjoints: dict[int, Node] = {output: program.one}
        numbers = self.live if len(self.outputs) == 1 else program.live([self.outputs[place]])
        for number in reversed(numbers):
            adjoint = adjoints.get(number)
            if adjoint is None or not self._active(number):
                continue
            operands = program.instructions[number].operands
            for operand, factor in zip(operands, self._partials(number), strict=True):
                if self.needs[operand]:
                    share = self._scaled(adjoint, factor)
                    known = adjoints.get(operand)
                    adjoints[operand] = share if known is None else known + share
        zero: Node = program.zero
        return tuple(adjoints.get(node.number, zero) for node in self.inputs)

    def forwards(self, place: int) -> tuple[Node, ...]:
        """The derivatives of all outputs by one input."""
        return self._tangents({self.inputs[place].number: self.program.one}, 1 << place)

    def along(self, direction: Sequence[Node]) -> tuple[Node, ...]:
        """The derivatives of all outputs along a direction, which has a node for each input."""
        seeds = {node.number: value for node, value in zip(self.inputs, direction, strict=True)}
        return self._tangents(seeds, (1 << len(self.inputs)) - 1)

    def _tangents(self, seeds: Mapping[int, Node], bits: int) -> tuple[Node, ...]:
        program = self.program
        tangents: dict[int, Node] = {}
        for number in self.live:
            if not self.needs[number] & bits:
                continue
            if number in self.seeds:
                tangents[number] = seeds[number]
                continue
            total = program.zero
            operands = program.instructions[number].operands
            for operand, factor in zip(operands, self._partials(number), strict=True):
                if operand in tangents:
                    total = total + self._scaled(tangents[operand], factor)
            tangents[number] = total
        zero: Node = program.zero
        return tuple(tangents.get(node.number, zero) for node in self.outputs)

    def _scaled(self, value: Node, factor: _Factor) -> Node:
        node, minus = factor
        scaled = value if node is None else value * node  # a reciprocal serves many: no division here
        return -scaled if minus else scaled

    def _partials(self, number: int) -> tuple[_Factor, ...]:
        known = self._factors.get(number)
        if known is None:
            known = self._factors[number] = self._local(number)
        return known

    def _local(self, number: int) -> tuple[_Factor, ...]:
        """The partial derivatives of one instruction by its operands."""
        program = self.program
        value = program.node(number)
        operation, operands, _ = program.instructions[number]
        match operation, [program.node(operand) for operand in operands]:
            case "add", _:
                return (None, False), (None, False)
            case "subtract", _:
                return (None, False), (None, True)
            case "negative", _:
                return ((None, True),)
            case "multiply", [a, b]:
                return (b, False), (a, False)
            case "divide", [_, b]:
                # One reciprocal serves both operands and all sweeps.
                inverse = program.reciprocal(b)
                by_b = value * inverse if self.needs[operands[1]] else program.zero
                return (inverse, False), (by_b, True)
            case "sqrt", _:
                return ((program.divide(program.number(Fraction(1, 2)), value), False),)
            case "sin", [a]:
                return ((program.sin_cos_of(a)[1], False),)
            case "cos", [a]:
                return ((program.sin_cos_of(a)[0], True),)
            case "exp", _:
                return ((value, False),)
            case "log", [a]:
                return ((program.reciprocal(a), False),)
            case "atan", [a]:
                return ((program.reciprocal(program.one + a * a), False),)
            case "sinh", [a]:
                return ((program.function("cosh", a), False),)
            case "cosh", [a]:
                return ((program.function("sinh", a), False),)
            case "tanh", _:
                return ((program.one - value * value, False),)
            case "abs", [a]:
                return ((program.function("sign", a), False),)
            case "sign", _:
                return ((program.zero, False),)  # off the jump, where states are
            case Tabulated() as name, [a]:
                return ((program.function(name.slope, a), False),)
        raise ValueError(f"no derivative is known for {operation}")
