"""Straight-line programs: hash-consed nodes, folded constants, and liveness from the requested outputs backwards.

Closed formulas grow exponentially with the number of joints, the program grows linearly or quadratically; numbers
therefore always come from here.  A node is an operation on earlier nodes; equal nodes are one node.  Signs are moved
outwards (``a*(-b)`` is ``-(a*b)``) so that more nodes turn out equal.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from fractions import Fraction
from math import isqrt
from operator import add, mul, sub
from typing import Any, NamedTuple

from mbsym.algebra.base import Algebra
from mbsym.algebra.failures import NoClosedForm, NoValue, SingularPoint
from mbsym.expressions.angles import LinearForm
from mbsym.expressions.rates import is_velocity
from mbsym.expressions.table import Tabulated

#: Constants are read as floating-point numbers in the end, which have no greater powers of 2.
MOST_BITS = 1_000

#: Of so many sets of outputs a program remembers what they need.
MOST_REMEMBERED = 16

#: What rounding takes away, exactly: 0 over every exact algebra (``mbsym.algebra.compensated``).
SUM_ROUNDING, PRODUCT_ROUNDING = "rounding of sum", "rounding of product"
ROUNDINGS = (SUM_ROUNDING, PRODUCT_ROUNDING)


class Choice(str):
    """A sign that only chooses between two ways to one result: where it changes, nothing jumps."""


_CHOICE = Choice("sign")

#: What the scalars' own operators do.
_JOINED: dict[str, Callable[[Any, Any], Any]] = {"multiply": mul, "add": add, "subtract": sub}


class Node:
    """One value of a program: ``number`` in the program's list of instructions."""

    __slots__ = ("number", "program")

    def __init__(self, program: Program, number: int) -> None:
        self.program, self.number = program, number

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Node) and self.number == other.number and self.program is other.program

    def __hash__(self) -> int:
        return hash((id(self.program), self.number))

    def __add__(self, other: Node) -> Node:
        return self.program.plus(self, other)

    def __sub__(self, other: Node) -> Node:
        return self.program.difference(self, other)

    def __mul__(self, other: Node) -> Node:
        return self.program.product(self, other)

    def __neg__(self) -> Node:
        return self.program.minus(self)


class Instruction(NamedTuple):
    """``operation`` is input, constant, add, subtract, multiply, negative, divide or a function's name (``Tabulated``).

    ``operands`` are numbers of earlier instructions; ``payload`` is an input's name or a constant's value.
    """

    operation: str
    operands: tuple[int, ...] = ()
    payload: str | Fraction | None = None


class Program(Algebra[Node]):
    """An algebra whose scalars record what is done with them."""

    def __init__(self) -> None:
        self.instructions: list[Instruction] = []
        self._known: dict[tuple[str, tuple[int, ...], str | Fraction | None], Node] = {}
        self._whole: dict[int, Node] = {}  # whole numbers, which occur most often
        self._values: list[Fraction | None] = []  # of constants, by number
        self._opposites: list[Node | None] = []  # a where the node is -a, by number
        self._minus: dict[int, Node] = {}  # of constants, by number
        self._live: dict[tuple[int, ...], list[int]] = {}  # what outputs need, by their numbers
        self._angles: dict[int, LinearForm | None] = {}  # linear forms, by number
        self.zero = self.number(0)
        self.one = self.number(1)

    def __hash__(self) -> int:
        return id(self)

    def __eq__(self, other: object) -> bool:
        return self is other

    # --- building ----------------------------------------------------------------------------------------------------

    def _node(self, operation: str, operands: tuple[int, ...] = (), payload: str | Fraction | None = None) -> Node:
        known = self._known.get((operation, operands, payload))
        if known is None:
            instruction = Instruction(operation, operands, payload)
            known = self._known[instruction] = Node(self, len(self.instructions))
            self.instructions.append(instruction)
            self._values.append(payload if operation == "constant" else None)  # type: ignore[arg-type]
            self._opposites.append(None)
        return known

    def number(self, value: Fraction | int) -> Node:
        """A constant.  Raises NoClosedForm beyond the range of floating point."""
        if isinstance(value, int) and value in self._whole:
            return self._whole[value]
        exact = Fraction(value)
        longest = max(exact.numerator.bit_length(), exact.denominator.bit_length())
        if longest > MOST_BITS:
            raise NoClosedForm(
                "a number of [[digits]] digits, beyond the range of floating point", digits=int(longest * 0.30103)
            )
        node = self._node("constant", (), exact)
        if isinstance(value, int):
            self._whole[value] = node
        return node

    def node(self, number: int) -> Node:
        """The value of an instruction."""
        return Node(self, number)

    def input(self, name: str) -> Node:
        return self._node("input", (), name)

    def _constant(self, node: Node) -> Fraction | None:
        return self._values[node.number]

    def _negated(self, node: Node) -> Node | None:
        """a where node is -a."""
        return self._opposites[node.number]

    def vanishes(self, x: Node) -> bool:
        return x.number == 0  # the constant 0 is the first instruction of every program

    def minus(self, a: Node) -> Node:
        inner = self._opposites[a.number] or self._minus.get(a.number)
        if inner is not None:
            return inner
        value = self._values[a.number]
        if value is not None:
            return self._minus.setdefault(a.number, self.number(-value))
        instruction = self.instructions[a.number]
        if instruction.operation == "subtract":
            return self._node("subtract", instruction.operands[::-1])
        negative = self._node("negative", (a.number,))
        self._opposites[negative.number] = a
        return negative

    def plus(self, a: Node, b: Node) -> Node:
        i, j = a.number, b.number
        if i == 0:
            return b
        if j == 0:
            return a
        x, y = self._values[i], self._values[j]
        if x is not None and y is not None:
            return self.number(x + y)
        minus_a, minus_b = self._opposites[i], self._opposites[j]
        if minus_b is not None:
            if minus_a is not None:
                return self.minus(self.plus(minus_a, minus_b))
            return self._difference(a, minus_b)
        if minus_a is not None:
            return self._difference(b, minus_a)
        return self._node("add", (i, j) if i < j else (j, i))

    def _difference(self, a: Node, b: Node) -> Node:
        return self.zero if a.number == b.number else self._node("subtract", (a.number, b.number))

    def difference(self, a: Node, b: Node) -> Node:
        """a - b, without an instruction for -b."""
        i, j = a.number, b.number
        if j == 0:
            return a
        if self._values[j] is None and self._opposites[j] is None and self._opposites[i] is None and i != 0:
            return self._difference(a, b)
        return self.plus(a, self.minus(b))

    def product(self, a: Node, b: Node) -> Node:
        i, j = a.number, b.number
        if i == 0 or j == 0:
            return self.zero
        x, y = self._values[i], self._values[j]
        if x is not None or y is not None:
            if x is not None and y is not None:
                return self.number(x * y)
            value, other = (x, b) if x is not None else (y, a)
            assert value is not None
            if value == 1 or value == -1:
                return other if value == 1 else self.minus(other)
            if value < 0:
                return self.minus(self.product(self.number(-value), other))
        minus_a, minus_b = self._opposites[i], self._opposites[j]
        if minus_a is not None or minus_b is not None:
            inner = self.product(a if minus_a is None else minus_a, b if minus_b is None else minus_b)
            return self.minus(inner) if (minus_a is None) != (minus_b is None) else inner
        return self._node("multiply", (i, j) if i < j else (j, i))

    def divide(self, a: Node, b: Node) -> Node:
        """a/b.  Raises SingularPoint where b is the constant 0."""
        y = self._constant(b)
        if y == 0:
            raise SingularPoint("division by zero")
        if y is not None:
            return self.product(a, self.number(1 / y))
        if self.vanishes(a):
            return a
        return self._node("divide", (a.number, b.number))

    def times(self, a: Node, b: Node) -> Node:
        """a*b; a product with a reciprocal is one division."""
        for x, y in ((a, b), (b, a)):
            operation, operands, _ = self.instructions[y.number]
            if operation == "divide" and operands[0] == self.one.number:
                return self.divide(x, Node(self, operands[1]))
        return self.product(a, b)

    def reciprocal(self, x: Node) -> Node:
        return self.divide(self.one, x)

    def square_root(self, x: Node) -> Node:
        value = self._constant(x)
        if value is not None and value >= 0:
            top, bottom = _root(value.numerator), _root(value.denominator)
            if top is not None and bottom is not None:
                return self.number(Fraction(top, bottom))
        return self._node("sqrt", (x.number,))

    def function(self, name: str, x: Node) -> Node:
        value = self._constant(x)
        if value is not None and name in ("abs", "sign"):
            return self.number(abs(value) if name == "abs" else (value > 0) - (value < 0))
        if isinstance(name, Tabulated) and (value is not None or name.curve.constant is not None):
            return self.number(name.curve(value or Fraction(0)))
        if name in ("abs", "sign"):  # of x and -x one is taken, so that both have one switch
            inner, difference = self._opposites[x.number], self.instructions[x.number]
            if inner is None and difference.operation == "subtract" and difference.operands[0] > difference.operands[1]:
                inner = self._node("subtract", difference.operands[::-1])
            if inner is not None:
                node = self._node(name, (inner.number,))
                return node if name == "abs" else self.minus(node)
        return self._node(name, (x.number,))

    def exceeds(self, a: Node, b: Node) -> Node:
        """1 where a > b, 0 where a < b (1/2 where they are equal), for choices that do not change the result."""
        if a == b:
            return self.number(Fraction(1, 2))
        half = self.number(Fraction(1, 2))
        return half + half * self.function(_CHOICE, a - b)

    def rounding(self, operation: str, a: Node, b: Node) -> Node:
        """What rounding takes away from a sum or a product (``mbsym.algebra.compensated``): 0 in exact arithmetic.

        Signs are moved outwards as they are from the sum or product itself.
        """
        if self._constant(a) is not None and self._constant(b) is not None:
            return self.zero
        minus_a, minus_b = self._opposite(a), self._opposite(b)
        if operation == PRODUCT_ROUNDING and (minus_a is not None or minus_b is not None):
            inner = self.rounding(operation, a if minus_a is None else minus_a, b if minus_b is None else minus_b)
            return self.minus(inner) if (minus_a is None) != (minus_b is None) else inner
        i, j = a.number, b.number
        if i == 0 or j == 0:
            return self.zero
        return self._node(operation, (i, j) if i < j else (j, i))

    def _opposite(self, node: Node) -> Node | None:
        """-a where a is negative as it is written."""
        value = self._constant(node)
        if value is not None:
            return self.number(-value) if value < 0 else None
        return self._opposites[node.number]

    def sin_cos(self, angle: LinearForm) -> tuple[Node, Node]:
        turns = angle.turns % 2
        if not angle.coefficients and turns.denominator in (1, 2):
            s, c = ((0, 1), (1, 0), (0, -1), (-1, 0))[int(turns * 2)]
            return self.number(s), self.number(c)
        total = self.zero
        for name, coefficient in angle.coefficients:
            total = total + self.number(coefficient) * self.input(name)
        if turns:
            total = total + self.number(turns) * self.input("pi")
        inner = self._negated(total)
        if inner is not None:
            return -self._node("sin", (inner.number,)), self._node("cos", (inner.number,))
        return self._node("sin", (total.number,)), self._node("cos", (total.number,))

    def sin_cos_of(self, argument: Node) -> tuple[Node, Node]:
        return self._node("sin", (argument.number,)), self._node("cos", (argument.number,))

    # --- using -------------------------------------------------------------------------------------------------------

    def live(self, outputs: Iterable[Node]) -> list[int]:
        """The numbers of the instructions that the outputs need, in order."""
        targets = tuple(node.number for node in outputs)
        known = self._live.get(targets)
        if known is None:  # instructions never change: what is known of them stays true
            needed, instructions = set(targets), self.instructions
            pending = list(needed)
            while pending:
                for operand in instructions[pending.pop()].operands:
                    if operand not in needed:
                        needed.add(operand)
                        pending.append(operand)
            if len(self._live) >= MOST_REMEMBERED:
                del self._live[next(iter(self._live))]
            known = self._live[targets] = sorted(needed)
        return known.copy()

    def operations(self, outputs: Iterable[Node], known_inputs: Collection[str] = ()) -> int:
        """How many arithmetic operations the outputs cost; what depends only on the inputs ``known_inputs`` is free.

        With the constants of a system given, this is what one more state costs: the rest is computed once.
        """
        counted = 0
        steady: set[int] = set()
        for number in self.live(outputs):
            operation, operands, payload = self.instructions[number]
            if operation == "constant" or (operation == "input" and payload in known_inputs):
                steady.add(number)
            elif operation != "input":
                if known_inputs and all(operand in steady for operand in operands):
                    steady.add(number)
                else:
                    counted += 1
        return counted

    def again(self, operation: str, operands: Sequence[Node]) -> Node:
        """An instruction's operation on other operands, with all that is known of sums, products and angles."""
        match operation, operands:
            case "add", [a, b]:
                return self.plus(a, b)
            case "subtract", [a, b]:
                return self.difference(a, b)
            case "multiply", [a, b]:
                return self.product(a, b)
            case "divide", [a, b]:
                return self.divide(a, b)
            case "negative", [a]:
                return self.minus(a)
            case "sqrt", [a]:
                return self.square_root(a)
            case ("sin" | "cos") as which, [a]:
                return self.sin_cos_of(a)[which == "cos"]
            case name, [a]:
                return self.function(name, a)
        raise ValueError(f"no such operation: {operation}")

    def evaluate(
        self,
        outputs: Sequence[Node],
        inputs: Mapping[str, Any],
        algebra: Algebra,
        standing: Callable[[int, Any], Any] | None = None,
    ) -> list[Any]:
        """The outputs over any algebra whose scalars divide through ``algebra.reciprocal``.

        Sines and cosines of inputs are looked up through ``algebra.sin_cos`` of their linear form, so that exact
        rational states stay exact.  ``standing`` is given the number and the value of every instruction and says what
        stands in its place from there on.  Raises NoValue for an input without a value, and what the algebra raises.
        """
        values: dict[int, Any] = {}
        turned: dict[int, Any] = {}  # sine and cosine, by their argument
        for number in self.live(outputs):
            operation, operands, payload = self.instructions[number]
            if (joined := _JOINED.get(operation)) is not None:
                value = joined(values[operands[0]], values[operands[1]])
            elif len(operands) == 2:
                value = self._joined(operation, values[operands[0]], values[operands[1]], algebra)
            elif operation in ("sin", "cos"):
                if (argument := operands[0]) not in turned:
                    angle = self._angle(argument)
                    turned[argument] = algebra.sin_cos_of(values[argument]) if angle is None else algebra.sin_cos(angle)
                value = turned[argument][operation == "cos"]
            elif operands:
                value = self._changed(operation, values[operands[0]], algebra)
            elif operation == "constant":
                assert isinstance(payload, Fraction)
                value = algebra.number(payload)
            else:
                try:
                    value = inputs[str(payload)]
                except KeyError:
                    raise NoValue(str(payload)) from None
            values[number] = value if standing is None else standing(number, value)
        return [values[node.number] for node in outputs]

    @staticmethod
    def _joined(operation: str, a: Any, b: Any, algebra: Algebra) -> Any:
        if operation == "divide":
            return algebra.times(a, algebra.reciprocal(b))
        if operation in ROUNDINGS:
            return algebra.zero
        raise ValueError(f"no such operation: {operation}")

    @staticmethod
    def _changed(operation: str, a: Any, algebra: Algebra) -> Any:
        match operation:
            case "negative":
                return -a
            case "sqrt":
                return algebra.square_root(a)
        return algebra.function(operation, a)

    def _angle(self, number: int) -> LinearForm | None:
        """The linear form in inputs that an instruction computes, or None."""
        if number not in self._angles:
            self._angles[number] = self._linear(number)
        return self._angles[number]

    def _linear(self, number: int) -> LinearForm | None:
        instruction = self.instructions[number]
        match instruction.operation:
            case "input" if instruction.payload == "pi":
                return LinearForm(turns=Fraction(1))
            case "input" if is_velocity(str(instruction.payload)):
                return None  # a velocity is no angle: its sine is that of a plain value
            case "input":
                return LinearForm(((str(instruction.payload), Fraction(1)),))
            case "negative":
                inner = self._angle(instruction.operands[0])
                return None if inner is None else inner.scaled(Fraction(-1))
            case "add" | "subtract":
                a, b = (self._angle(operand) for operand in instruction.operands)
                if a is None or b is None:
                    return None
                return a + b.scaled(Fraction(1 if instruction.operation == "add" else -1))
            case "multiply":
                for first, second in (instruction.operands, instruction.operands[::-1]):
                    factor = self.instructions[first].payload
                    form = self._angle(second)
                    if isinstance(factor, Fraction) and form is not None:
                        return form.scaled(factor)
        return None


def _root(n: int) -> int | None:
    root = isqrt(n)
    return root if root * root == n else None
