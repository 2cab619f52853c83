"""Writing LLVM functions: values with the usual operators, loops, branches.

A ``Function`` collects text; a ``Value`` is a number that it computes.  Local variables live in ``slots`` (memory on
the stack), which the optimiser turns into registers.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction

from mbsym.numerics.kernels.llvm import Scalar, constant

INTEGER, BIT, POINTER = "i64", "i1", "ptr"
_WIDTH = {"float": 32, "double": 64, "x86_fp80": 80}
_FLOAT = {"+": "fadd contract", "-": "fsub contract", "*": "fmul contract", "/": "fdiv contract"}
_WHOLE = {"+": "add", "-": "sub", "*": "mul"}
#: Comparisons that are false where an operand is not a number.
_ORDERED = {"<": "olt", "<=": "ole", ">": "ogt", ">=": "oge", "==": "oeq", "!=": "one"}
_SIGNED = {"<": "slt", "<=": "sle", ">": "sgt", ">=": "sge", "==": "eq", "!=": "ne"}

#: Loops of so few rounds are written out.
WRITTEN_OUT = 16

Number = int | float | Fraction


@dataclass(frozen=True)
class Value:
    """A number of LLVM's type ``kind`` in a function."""

    function: Function
    kind: str
    text: str

    def _joined(self, sign: str, other: Value | Number, turned: bool = False) -> Value:
        right = self.function.number(other, self.kind)
        a, b = (right, self) if turned else (self, right)
        operation = _WHOLE[sign] if self.kind == INTEGER else _FLOAT[sign]
        return self.function.value(self.kind, f"{operation} {self.kind} {a.text}, {b.text}")

    def __add__(self, other: Value | Number) -> Value:
        return self._joined("+", other)

    def __sub__(self, other: Value | Number) -> Value:
        return self._joined("-", other)

    def __mul__(self, other: Value | Number) -> Value:
        return self._joined("*", other)

    def __truediv__(self, other: Value | Number) -> Value:
        return self._joined("/", other)

    __radd__, __rmul__ = __add__, __mul__

    def __rsub__(self, other: Number) -> Value:
        return self._joined("-", other, turned=True)

    def __rtruediv__(self, other: Number) -> Value:
        return self._joined("/", other, turned=True)

    def compare(self, sign: str, other: Value | Number) -> Value:
        """A bit; comparisons of floating-point numbers are false where one is not a number."""
        right = self.function.number(other, self.kind)
        operation = f"icmp {_SIGNED[sign]}" if self.kind == INTEGER else f"fcmp {_ORDERED[sign]}"
        return self.function.value(self.function.mask(self.kind), f"{operation} {self.kind} {self.text}, {right.text}")

    def __or__(self, other: Value) -> Value:
        return self.function.value(self.kind, f"or {self.kind} {self.text}, {other.text}")

    def __and__(self, other: Value) -> Value:
        return self.function.value(self.kind, f"and {self.kind} {self.text}, {other.text}")

    def choose(self, yes: Value, no: Value) -> Value:
        """``yes`` where this bit is set, else ``no``."""
        condition = f"{self.kind} {self.text}"
        return self.function.value(yes.kind, f"select {condition}, {yes.kind} {yes.text}, {no.kind} {no.text}")

    def absolute(self) -> Value:
        return (self.compare("<", 0)).choose(0 - self, self)

    def converted(self, kind: str) -> Value:
        """The number in another floating-point type; whole numbers become floating-point ones."""
        if kind == self.kind or self.kind.startswith("<"):
            return self
        if self.kind == INTEGER:
            return self.function.value(kind, f"sitofp i64 {self.text} to {kind}")
        operation = "fpext" if _WIDTH[kind] > _WIDTH[self.kind] else "fptrunc"
        return self.function.value(kind, f"{operation} {self.kind} {self.text} to {kind}")


class Function:
    """``define i64 @name(arguments)``; pointers do not overlap.  ``arguments`` maps names to LLVM types.

    ``real`` is the type of error estimates and of what follows from them.
    """

    real = "double"

    def __init__(self, name: str, arguments: Sequence[tuple[str, str]]) -> None:
        shown = ", ".join(f"ptr noalias %{arg}" if kind == POINTER else f"{kind} %{arg}" for arg, kind in arguments)
        self.head = f"define i64 @{name}({shown}) #0 {{\nentry:"
        self.arguments = {arg: Value(self, kind, f"%{arg}") for arg, kind in arguments}
        self.slots: list[str] = []
        self.lines: list[str] = []
        self._count = 0

    def __getitem__(self, argument: str) -> Value:
        return self.arguments[argument]

    def _fresh(self, prefix: str = "v") -> str:
        self._count += 1
        return f"{prefix}{self._count}"

    # --- values ------------------------------------------------------------------------------------------------------

    def value(self, kind: str, text: str) -> Value:
        name = f"%{self._fresh()}"
        self.lines.append(f"  {name} = {text}")
        return Value(self, kind, name)

    def number(self, value: Value | Number, kind: str) -> Value:
        if isinstance(value, Value):
            return value
        return Value(self, kind, str(int(value)) if kind == INTEGER else constant(Fraction(value), kind))

    def mask(self, kind: str) -> str:
        """The type of comparisons of numbers of a type."""
        return BIT

    def call(self, name: str, kind: str, *operands: Value) -> Value:
        return self.value(kind, f"call {kind} @{name}({', '.join(f'{x.kind} {x.text}' for x in operands)})")

    def do(self, name: str, *operands: Value, apart: bool = False) -> None:
        """A call of a function without result; ``apart``: its text is not put in place of the call."""
        end = " noinline" if apart else ""
        self.lines.append(f"  call void @{name}({', '.join(f'{x.kind} {x.text}' for x in operands)}){end}")

    # --- memory ------------------------------------------------------------------------------------------------------

    def slot(self, kind: str, count: int = 1) -> Value:
        """Room on the stack."""
        name = f"%{self._fresh('s')}"
        self.slots.append(f"  {name} = alloca [{max(count, 1)} x {kind}], align 64")
        return Value(self, POINTER, name)

    def at(self, kind: str, base: Value, index: Value | int) -> Value:
        """The address of an entry."""
        place = self.number(index, INTEGER)
        return self.value(POINTER, f"getelementptr inbounds {kind}, ptr {base.text}, i64 {place.text}")

    def load(self, kind: str, base: Value, index: Value | int = 0) -> Value:
        return self.value(kind, f"load {kind}, ptr {self.at(kind, base, index).text}")

    def store(self, value: Value | Number, kind: str, base: Value, index: Value | int = 0) -> None:
        operand = self.number(value, kind)
        self.lines.append(f"  store {kind} {operand.text}, ptr {self.at(kind, base, index).text}")

    # --- control -----------------------------------------------------------------------------------------------------

    def label(self) -> str:
        return self._fresh("l")

    def jump(self, label: str) -> None:
        self.lines.append(f"  br label %{label}")

    def branch(self, bit: Value, yes: str, no: str) -> None:
        self.lines.append(f"  br i1 {bit.text}, label %{yes}, label %{no}")

    def place(self, label: str) -> None:
        """What is written next starts at the label."""
        self.lines.append(f"{label}:")

    def here(self) -> str:
        """A label for what is written next."""
        label = self.label()
        self.jump(label)
        self.place(label)
        return label

    def add(self, change: Value | int, kind: str, place: Value, index: Value | int = 0) -> None:
        """The number there grows."""
        self.store(self.load(kind, place, index) + change, kind, place, index)

    @contextmanager
    def repeat(self, count: Value | int, start: Value | int = 0) -> Iterator[Value]:
        """The body for start, start + 1, ..., count - 1."""
        index = self.slot(INTEGER)
        self.store(self.number(start, INTEGER), INTEGER, index)
        body, done = self.label(), self.label()
        test = self.here()
        now = self.load(INTEGER, index)
        self.branch(now.compare("<", count), body, done)
        self.place(body)
        yield now
        self.store(now + 1, INTEGER, index)
        self.jump(test)
        self.place(done)

    def each(self, count: int) -> Iterator[Value | int]:
        """The body for 0, ..., count - 1: a loop, or written out if there are few."""
        if count <= WRITTEN_OUT:
            yield from range(count)
        else:
            with self.repeat(count) as index:
                yield index

    @contextmanager
    def when(self, bit: Value) -> Iterator[None]:
        """The body if the bit is set."""
        yes, after = self.label(), self.label()
        self.branch(bit, yes, after)
        self.place(yes)
        yield
        self.jump(after)
        self.place(after)

    def leave_if(self, bit: Value, result: Value | int, unless: bool = False) -> None:
        """Returns the result if the bit is set, or ``unless`` it is."""
        out, on = self.label(), self.label()
        self.branch(bit, *((on, out) if unless else (out, on)))
        self.place(out)
        self.leave(result)
        self.place(on)

    def leave(self, result: Value | int) -> None:
        self.lines.append(f"  ret i64 {self.number(result, INTEGER).text}")

    def text(self) -> str:
        first = self.label()
        return "\n".join([self.head, *self.slots, f"  br label %{first}", f"{first}:", *self.lines, "}", ""])


def clock_kind(scalar: Scalar) -> str:
    """Times are kept in float64 at least, whatever the arithmetic of the states."""
    return "double" if scalar.type == "float" else scalar.type
