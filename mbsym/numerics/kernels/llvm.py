"""LLVM text, one line an operation, compiled in the process by llvmlite.

    void name(ptr in, ptr out)                 one state
    void name.many(ptr in, ptr out, i64 m)     m states; arrays of shape (inputs, m) and (outputs, m), row by row
    void name.wide(ptr in, ptr out, i64 m)     the same, as many states at once as a vector register holds

``in`` and ``out`` hold float64, float32 or x86 extended numbers.  Constants are rounded once, from exact fractions.
A product that occurs only in one sum is not rounded before the addition where the machine can do so (fmuladd); nothing
else is contracted or reordered.  Sines and cosines are computed several at once, whether of several angles of one
state or of one angle of several states.  All three functions give the same numbers, to the last bit.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import platform
import struct
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

import llvmlite
import llvmlite.binding as llvm
import numpy as np

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.program import PRODUCT_ROUNDING, ROUNDINGS
from mbsym.expressions.table import Tabulated
from mbsym.numerics.kernels import lookup, sine_cosine, stored
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT32, FLOAT64, Code, Kernel, address_of
from mbsym.numerics.kernels.sine_cosine import splat, vector


@dataclass(frozen=True)
class Scalar:
    """An arithmetic: LLVM's type, the suffix of its functions in libm, NumPy's type."""

    name: str
    type: str
    suffix: str
    dtype: Any

    def constant(self, value: Fraction) -> str:
        """The correctly rounded constant as LLVM reads it.  Raises NoClosedForm beyond the range of the type."""
        return constant(value, self.type)


def constant(value: Fraction, kind: str) -> str:
    """The number of LLVM's type ``kind`` nearest to a fraction.  Raises NoClosedForm beyond the range of the type."""
    if kind == "x86_fp80":
        return _extended(value)
    try:
        number = float(value) if kind == "double" else _nearest_single(value)
    except OverflowError:
        number = float("inf")
    if number in (float("inf"), float("-inf")):
        scalar = {"float": "float32", "double": "float64"}.get(kind, kind)
        raise NoClosedForm("a constant beyond the range of [[scalar]]", scalar=scalar)
    return f"0x{struct.unpack('<Q', struct.pack('<d', number))[0]:016X}"


def _nearest_single(value: Fraction) -> float:
    """The float32 nearest to a fraction, as the float64 with its value; infinite beyond the range.

    Rounding to float64 first could go wrong only half-way between two float32 numbers; there the fraction decides.
    """
    with np.errstate(over="ignore"):
        near = np.float32(float(value))
    if not np.isfinite(near):
        return float("inf")
    exact = abs(Fraction(float(near)) - value)
    for other in (np.nextafter(near, np.float32(-np.inf)), np.nextafter(near, np.float32(np.inf))):
        if np.isfinite(other) and abs(Fraction(float(other)) - value) < exact:
            return float(other)
    return float(near)


def _extended(value: Fraction) -> str:
    """An x86 80-bit constant: sign and exponent in 16 bits, then 64 bits of significand."""
    if value == 0:
        return "0xK00000000000000000000"
    size = abs(value)
    exponent = size.numerator.bit_length() - size.denominator.bit_length()
    if Fraction(2) ** exponent > size:
        exponent -= 1
    exponent = max(exponent, -16382)  # what is smaller loses digits
    significand = round(size / Fraction(2) ** (exponent - 63))
    if significand == 2**64:
        significand, exponent = 2**63, exponent + 1
    if exponent > 16383:
        raise NoClosedForm("a constant beyond the range of extended precision")
    sign = 0x8000 if value < 0 else 0
    biased = exponent + 16383 if significand >= 2**63 else 0
    return f"0xK{sign | biased:04X}{significand:016X}"


SCALARS = {
    FLOAT64: Scalar(FLOAT64, "double", "", np.float64),
    FLOAT32: Scalar(FLOAT32, "float", "f", np.float32),
    EXTENDED: Scalar(EXTENDED, "x86_fp80", "l", np.longdouble),
}

#: Written without a call.
_KINKED = ("abs", "sign")
_ARITHMETIC = {"add": "fadd", "subtract": "fsub", "multiply": "fmul", "divide": "fdiv"}


def available(scalar: str) -> bool:
    """Whether this machine computes in that arithmetic."""
    return scalar != EXTENDED or (
        platform.machine().lower() in ("x86_64", "amd64") and np.finfo(np.longdouble).nmant == 63
    )


#: Longer programs are split into functions of ``PART`` operations, for which compilers take more than linear time, and
#: are not searched for operations that could be done side by side, which takes longest and gains some percent; nor is
#: there anything that higher levels of optimisation would find in them in twice the time.
LONG, PART = 4_000, 500


@dataclass(frozen=True)
class Fused:
    """number = +-(a b) +- c with one rounding where the machine can: a product that is used once, in this sum."""

    number: int
    product: int
    factors: tuple[int, int]
    other: int
    minus_product: bool
    minus_other: bool


#: An angle's number with those of its sine and its cosine, where they are wanted.
Angle = tuple[int, int | None, int | None]
#: One instruction, two of them in one, or angles of which none depends on sine or cosine of another.
Step = int | Fused | tuple[Angle, ...]


def function_text(name: str, code: Code, scalar: Scalar) -> str:
    """The LLVM text of ``name`` (one state), without the declarations of library functions."""
    live = code.program.live(code.outputs)
    head = f"define void @{name}(ptr noalias readonly %in, ptr noalias %out) #0 {{"
    form = _Form(code, scalar, 1)
    if len(live) <= LONG:
        return "\n".join([head, *form.body(_steps(code, live, scalar)), *form.stores(), "  ret void", "}", ""])
    parts, calls = _split(name, code, live, scalar, 1)
    return parts + "\n".join([head, *calls, "  ret void", "}", ""])


def wide_text(name: str, code: Code, scalar: Scalar, lanes: int) -> str:
    """The LLVM text of ``name.wide``: ``lanes`` states at once; the last ones overlap those before, m >= lanes."""
    live = code.program.live(code.outputs)
    kind, parts, form = scalar.type, "", _Form(code, scalar, lanes)
    room: list[str] = []
    if len(live) <= LONG:
        body = [*form.body(_steps(code, live, scalar)), *form.stores()]
    else:
        parts, calls = _split(f"{name}.wide", code, live, scalar, lanes)
        room, body = calls[:1], calls[1:]
    lines = [
        f"define void @{name}.wide(ptr noalias readonly %states, ptr noalias %results, i64 %m) #0 {{",
        "entry:",
        *room,
        f"  %last = sub i64 %m, {lanes}",
        "  br label %loop",
        "loop:",
        "  %k = phi i64 [0, %entry], [%next, %loop]",
        f"  %in = getelementptr {kind}, ptr %states, i64 %k",
        f"  %out = getelementptr {kind}, ptr %results, i64 %k",
        *body,
        f"  %due = add i64 %k, {lanes}",
        "  %over = icmp sgt i64 %due, %last",
        "  %next = select i1 %over, i64 %last, i64 %due",
        "  %more = icmp slt i64 %k, %last",
        "  br i1 %more, label %loop, label %done",
        "done:",
        "  ret void",
        "}",
        "",
    ]
    return parts + "\n".join(lines)


def _steps(code: Code, live: Sequence[int], scalar: Scalar) -> list[Step]:
    """The instructions in an order in which sines and cosines of several angles can be computed together.

    The order is that of the program, but where the first sine or cosine comes, all angles that do not depend on its
    like are computed; the same where the first sine or cosine of something that does comes, and so on.
    """
    if scalar.name == EXTENDED:
        return list(live)
    instructions = code.program.instructions
    level: dict[int, int] = {}
    angles_by_level: dict[int, dict[int, list[int | None]]] = {}
    for number in live:
        operation, operands, _ = instructions[number]
        level[number] = max((level[operand] for operand in operands), default=0)
        if operation in ("sin", "cos"):
            slots = angles_by_level.setdefault(level[number], {}).setdefault(operands[0], [None, None])
            slots[operation == "cos"] = number
            level[number] += 1
    steps: list[Step] = []
    done: set[int] = set()
    for number in live:
        if number in done:
            continue
        if instructions[number].operation not in ("sin", "cos"):
            steps.append(number)
            done.add(number)
            continue
        angles = angles_by_level.pop(level[number] - 1)
        needed, reached = [angle for angle in angles if angle not in done], set()
        while needed:
            current = needed.pop()
            if current not in reached:
                reached.add(current)
                needed += [operand for operand in instructions[current].operands if operand not in done]
        steps += sorted(reached)
        steps.append(tuple((angle, sine, cosine) for angle, (sine, cosine) in angles.items()))
        done |= reached | {member for pair in angles.values() for member in pair if member is not None}
    fused = _fused(code, live)
    taken = {fusion.product for fusion in fused.values()}
    return [fused.get(step, step) if isinstance(step, int) else step for step in steps if step not in taken]


def _fused(code: Code, live: Sequence[int]) -> dict[int, Fused]:
    """Sums that take in one of their products, by their numbers: if there are two, the later one.

    It is decided here and not by the compiler, so that one state and many states get the same numbers.
    """
    instructions = code.program.instructions
    uses = Counter(operand for number in live for operand in instructions[number].operands)
    uses.update(node.number for node in code.outputs)
    # A product of which the rounding is taken has to be rounded.
    rounded = {instructions[number].operands for number in live if instructions[number].operation == PRODUCT_ROUNDING}
    fuseds = {}
    for number in live:
        operation, operands, _ = instructions[number]
        if operation not in ("add", "subtract"):
            continue
        products = [
            candidate
            for candidate in operands
            if instructions[candidate].operation == "multiply" and uses[candidate] == 1
        ]
        products = [candidate for candidate in products if instructions[candidate].operands not in rounded]
        if products:
            product = max(products)
            first = operands[0] == product
            a, b = instructions[product].operands
            minus, other = operation == "subtract", operands[1 if first else 0]
            fuseds[number] = Fused(number, product, (a, b), other, minus and not first, minus and first)
    return fuseds


def _used(code: Code, step: Step) -> Sequence[int]:
    """What a step needs."""
    if isinstance(step, int):
        return code.program.instructions[step].operands
    if isinstance(step, Fused):
        return (*step.factors, step.other)
    return [angle for angle, *_ in step]


def _results(step: Step) -> list[int]:
    """What a step computes."""
    if isinstance(step, int):
        return [step]
    if isinstance(step, Fused):
        return [step.number]
    return [number for _, sine, cosine in step for number in (sine, cosine) if number is not None]


def _split(name: str, code: Code, live: Sequence[int], scalar: Scalar, lanes: int) -> tuple[str, list[str]]:
    """Parts to be called one after the other, and the calls; what a later part needs goes through memory, %w."""
    instructions = code.program.instructions
    steps = _steps(code, live, scalar)
    parts = [steps[start : start + PART] for start in range(0, len(steps), PART)]
    home = {number: place for place, part in enumerate(parts) for step in part for number in _results(step)}
    needed: list[set[int]] = [set() for _ in parts]
    for place, part in enumerate(parts):
        for step in part:
            needed[place].update(number for number in _used(code, step) if home[number] != place)
    needed[-1].update(node.number for node in code.outputs if home[node.number] != len(parts) - 1)
    cells: dict[int, int] = {}
    for number in sorted(set().union(*needed)):
        if instructions[number].operation != "constant":
            cells[number] = len(cells)
    texts, calls = [], [f"  %w = alloca [{max(len(cells), 1)} x {vector(lanes, scalar.type)}]"]
    for place, part in enumerate(parts):
        form = _Form(code, scalar, lanes, cells)
        lines = [*form.given(sorted(needed[place])), *form.body(part)]
        if place == len(parts) - 1:
            lines += form.stores()
        arguments = "ptr noalias readonly %in, ptr noalias %w, ptr noalias %out, i64 %m"
        texts.append(
            "\n".join([f"define internal void @{name}.{place}({arguments}) #2 {{", *lines, "  ret void", "}", ""])
        )
        m = "%m" if lanes > 1 else "1"
        calls.append(f"  call void @{name}.{place}(ptr %in, ptr %w, ptr %out, i64 {m})")
    return "".join(texts), calls


class _Form:
    """Instructions as lines, for one state or for ``lanes`` of them side by side (rows of inputs are %m apart).

    ``kept`` values have places in %w, for other parts.
    """

    def __init__(self, code: Code, scalar: Scalar, lanes: int, kept: Mapping[int, int] | None = None) -> None:
        self.code, self.scalar, self.lanes, self.kept = code, scalar, lanes, kept or {}
        self.kind = vector(lanes, scalar.type)
        self.values: dict[int, str] = {}
        self.slots = {input_: place for place, input_ in enumerate(code.inputs)}
        self._groups = 0

    def given(self, numbers: Iterable[int]) -> Iterator[str]:
        """Values of other parts."""
        for number in numbers:
            payload = self.code.program.instructions[number].payload
            if isinstance(payload, Fraction):
                self._constant(number, payload)
                continue
            yield f"  %w{number} = getelementptr {self.kind}, ptr %w, i64 {self.kept[number]}"
            yield f"  %v{number} = load {self.kind}, ptr %w{number}"
            self.values[number] = f"%v{number}"

    def body(self, steps: Iterable[Step]) -> Iterator[str]:
        for step in steps:
            if isinstance(step, int):
                yield from self._instruction(step)
            elif isinstance(step, Fused):
                yield from self._sum(step)
            else:
                yield from self._angles(step)
            for number in _results(step):
                if number in self.kept and self.code.program.instructions[number].operation != "constant":
                    yield f"  %k{number} = getelementptr {self.kind}, ptr %w, i64 {self.kept[number]}"
                    yield f"  store {self.kind} {self.values[number]}, ptr %k{number}"

    def stores(self) -> Iterator[str]:
        for place, node in enumerate(self.code.outputs):
            yield from self._address(f"%o{place}", "%out", place)
            yield f"  store {self.kind} {self.values[node.number]}, ptr %o{place}{self._align}"

    @property
    def _align(self) -> str:
        return f", align {self.scalar.dtype().itemsize}" if self.lanes > 1 else ""

    def _address(self, local: str, base: str, row: int) -> Iterator[str]:
        if self.lanes == 1:
            yield f"  {local} = getelementptr {self.kind}, ptr {base}, i64 {row}"
        else:
            yield f"  {local}.at = mul i64 %m, {row}"
            yield f"  {local} = getelementptr {self.scalar.type}, ptr {base}, i64 {local}.at"

    def _constant(self, number: int, payload: Fraction) -> None:
        self.values[number] = splat(self.lanes, self.scalar.type, self.scalar.constant(payload))

    def _instruction(self, number: int) -> Iterator[str]:
        operation, used, payload = self.code.program.instructions[number]
        if operation == "constant":
            assert isinstance(payload, Fraction)
            self._constant(number, payload)
            return
        kind, local = self.kind, f"%v{number}"
        operands = [self.values[operand] for operand in used]
        match operands:
            case [] if payload not in self.slots:
                yield from self._cell(local, address_of(str(payload)))
            case []:
                yield from self._address(f"%p{number}", "%in", self.slots[str(payload)])
                yield f"  {local} = load {kind}, ptr %p{number}{self._align}"
            case [a] if operation == "negative":
                yield f"  {local} = fneg {kind} {a}"
            case [a] if operation in _KINKED:
                yield from self._kinked(operation, local, a)
            case [a] if operation == "sqrt" and self.lanes > 1:
                yield f"  {local} = call {kind} @llvm.sqrt.{suffix(self.scalar, self.lanes)}({kind} {a})"
            case [a] if isinstance(operation, Tabulated):
                yield from self._function(lookup.called(operation, self.scalar.suffix), local, a)
            case [a]:
                yield from self._function(f"{operation}{self.scalar.suffix}", local, a)
            case [a, b] if operation in ROUNDINGS:
                yield from self._rounding(operation, local, a, b)
                if self.scalar.name == EXTENDED:
                    self._constant(number, Fraction(0))
                    return
            case [a, b]:
                yield f"  {local} = {_ARITHMETIC[operation]} {kind} {a}, {b}"
        self.values[number] = local

    def _cell(self, local: str, address: int) -> Iterator[str]:
        """A number from memory, the same for all lanes."""
        scalar_type, before = self.scalar.type, "poison"
        single = local if self.lanes == 1 else f"{local}.s"
        known = single if scalar_type == "double" else f"{local}.d"
        yield f"  {known} = load double, ptr {_IN_MEMORY} (i64 {address} to ptr)"
        if scalar_type != "double":
            change = "fpext" if self.scalar.name == EXTENDED else "fptrunc"
            yield f"  {single} = {change} double {known} to {scalar_type}"
        for lane in range(self.lanes if self.lanes > 1 else 0):
            after = local if lane == self.lanes - 1 else f"{local}.x{lane}"
            yield f"  {after} = insertelement {self.kind} {before}, {scalar_type} {single}, i32 {lane}"
            before = after

    def _rounding(self, operation: str, local: str, a: str, b: str) -> Iterator[str]:
        """(a + b) - fl(a + b) by two-sum, a b - fl(a b) by a fused operation; extended arithmetic does without."""
        kind = self.kind
        if self.scalar.name == EXTENDED:
            return
        if operation == PRODUCT_ROUNDING:
            yield f"  {local}.p = fmul {kind} {a}, {b}"
            yield f"  {local}.n = fneg {kind} {local}.p"
            function = f"llvm.fma.{suffix(self.scalar, self.lanes)}"
            yield f"  {local} = call {kind} @{function}({kind} {a}, {kind} {b}, {kind} {local}.n)"
            return
        yield f"  {local}.s = fadd {kind} {a}, {b}"
        yield f"  {local}.b = fsub {kind} {local}.s, {a}"
        yield f"  {local}.a = fsub {kind} {local}.s, {local}.b"
        yield f"  {local}.e = fsub {kind} {b}, {local}.b"
        yield f"  {local}.d = fsub {kind} {a}, {local}.a"
        yield f"  {local} = fadd {kind} {local}.d, {local}.e"

    def _kinked(self, operation: str, local: str, a: str) -> Iterator[str]:
        """sign: 1, -1, or what it is given, 0 or no number; abs: 0 - a up to 0, which has no sign there."""
        kind, bit = self.kind, vector(self.lanes, "i1")
        zero, one, minus = (
            splat(self.lanes, self.scalar.type, self.scalar.constant(Fraction(value))) for value in (0, 1, -1)
        )
        if operation == "abs":
            yield f"  {local}.m = fsub {kind} {zero}, {a}"
            yield f"  {local}.c = fcmp ole {kind} {a}, {zero}"
            yield f"  {local} = select {bit} {local}.c, {kind} {local}.m, {kind} {a}"
            return
        yield f"  {local}.l = fcmp olt {kind} {a}, {zero}"
        yield f"  {local}.s = select {bit} {local}.l, {kind} {minus}, {kind} {a}"
        yield f"  {local}.g = fcmp ogt {kind} {a}, {zero}"
        yield f"  {local} = select {bit} {local}.g, {kind} {one}, {kind} {local}.s"

    def _sum(self, step: Fused) -> Iterator[str]:
        kind, local = self.kind, f"%v{step.number}"
        a, b, c = (self.values[number] for number in (*step.factors, step.other))
        if step.minus_product:
            yield f"  {local}.a = fneg {kind} {a}"
            a = f"{local}.a"
        if step.minus_other:
            yield f"  {local}.c = fneg {kind} {c}"
            c = f"{local}.c"
        function = f"llvm.fmuladd.{suffix(self.scalar, self.lanes)}"
        yield f"  {local} = call {kind} @{function}({kind} {a}, {kind} {b}, {kind} {c})"
        self.values[step.number] = local

    def _function(self, function: str, local: str, argument: str) -> Iterator[str]:
        """A call of the C library, or one for every lane."""
        scalar_type, kind = self.scalar.type, self.kind
        if self.lanes == 1:
            yield f"  {local} = call {scalar_type} @{function}({scalar_type} {argument}) #1"
            return
        before = "poison"
        for lane in range(self.lanes):
            yield f"  {local}.x{lane} = extractelement {kind} {argument}, i32 {lane}"
            yield f"  {local}.y{lane} = call {scalar_type} @{function}({scalar_type} {local}.x{lane}) #1"
            after = local if lane == self.lanes - 1 else f"{local}.z{lane}"
            yield f"  {after} = insertelement {kind} {before}, {scalar_type} {local}.y{lane}, i32 {lane}"
            before = after

    def _angles(self, step: tuple[Angle, ...]) -> Iterator[str]:
        """One state: angles packed into vectors.  Several states: a vector for each angle."""
        if self.lanes > 1:
            for angle, sine, cosine in step:
                local = f"%g{self._group()}"
                yield from self._pair(local, self.values[angle], self.lanes)
                for number, letter in ((sine, "s"), (cosine, "c")):
                    if number is not None:
                        self.values[number] = f"{local}.{letter}"
            return
        for start in range(0, len(step), MOST_ANGLES):
            chunk = step[start : start + MOST_ANGLES]
            lanes = packed(len(chunk))
            local, kind, scalar_type = f"%g{self._group()}", vector(lanes, self.scalar.type), self.scalar.type
            argument = self.values[chunk[0][0]]
            if lanes > 1:
                argument = "poison"
                for lane in range(lanes):  # what is left over repeats the last one
                    value = self.values[chunk[min(lane, len(chunk) - 1)][0]]
                    yield f"  {local}.x{lane} = insertelement {kind} {argument}, {scalar_type} {value}, i32 {lane}"
                    argument = f"{local}.x{lane}"
            yield from self._pair(local, argument, lanes)
            for lane, (_, sine, cosine) in enumerate(chunk):
                for number, letter in ((sine, "s"), (cosine, "c")):
                    if number is None:
                        continue
                    self.values[number] = f"{local}.{letter}" if lanes == 1 else f"%v{number}"
                    if lanes > 1:
                        yield f"  %v{number} = extractelement {kind} {local}.{letter}, i32 {lane}"

    def _group(self) -> int:
        self._groups += 1
        return self._groups

    def _pair(self, local: str, argument: str, lanes: int) -> Iterator[str]:
        """local.s and local.c: sine and cosine, computed in float64."""
        double, kind = vector(lanes, "double"), vector(lanes, self.scalar.type)
        narrow = self.scalar.name == FLOAT32
        if narrow:
            yield f"  {local}.d = fpext {kind} {argument} to {double}"
            argument = f"{local}.d"
        pair = f"{{ {double}, {double} }}"
        yield f"  {local} = call {pair} @{sine_cosine.name(lanes)}({double} {argument})"
        for place, letter in enumerate("sc"):
            wide = f"{local}.{letter}" + (".d" if narrow else "")
            yield f"  {wide} = extractvalue {pair} {local}, {place}"
            if narrow:
                yield f"  {local}.{letter} = fptrunc {double} {wide} to {kind}"


def suffix(scalar: Scalar, lanes: int) -> str:
    """What LLVM puts behind the names of intrinsics."""
    return (f"v{lanes}" if lanes > 1 else "") + ("f32" if scalar.name == FLOAT32 else "f64")


#: After so many states (in calls with many) code for several at once is compiled: about what the compiling costs.
WIDE = 500_000

#: Angles of one state that are computed together.
MOST_ANGLES = 4


def packed(angles: int) -> int:
    """Lanes for so many angles: 1, 2 or 4."""
    return 4 if angles > 2 else angles


@cache
def lanes_of(scalar: str) -> int:
    """States side by side: as many as fill a vector register; 1 where there are none for this arithmetic."""
    if scalar == EXTENDED:
        return 1
    return (32 if llvm.get_host_cpu_features().get("avx2") else 16) // SCALARS[scalar].dtype().itemsize


def many_text(name: str, code: Code, scalar: Scalar) -> str:
    """``name.many``: a loop over m states that gathers and scatters columns."""
    kind, inputs, outputs = scalar.type, len(code.inputs), len(code.outputs)
    lines = [
        f"define void @{name}.many(ptr noalias readonly %in, ptr noalias %out, i64 %m) #0 {{",
        "entry:",
        f"  %x = alloca [{max(inputs, 1)} x {kind}]",
        f"  %y = alloca [{max(outputs, 1)} x {kind}]",
        "  %some = icmp sgt i64 %m, 0",
        "  br i1 %some, label %loop, label %done",
        "loop:",
        "  %k = phi i64 [0, %entry], [%next, %loop]",
    ]
    for i in range(inputs):
        lines += [
            f"  %ia{i} = mul i64 %m, {i}",
            f"  %ib{i} = add i64 %ia{i}, %k",
            f"  %ic{i} = getelementptr {kind}, ptr %in, i64 %ib{i}",
            f"  %id{i} = load {kind}, ptr %ic{i}",
            f"  %ie{i} = getelementptr {kind}, ptr %x, i64 {i}",
            f"  store {kind} %id{i}, ptr %ie{i}",
        ]
    lines.append(f"  call void @{name}(ptr %x, ptr %y) #2")
    for i in range(outputs):
        lines += [
            f"  %oa{i} = getelementptr {kind}, ptr %y, i64 {i}",
            f"  %ob{i} = load {kind}, ptr %oa{i}",
            f"  %oc{i} = mul i64 %m, {i}",
            f"  %od{i} = add i64 %oc{i}, %k",
            f"  %oe{i} = getelementptr {kind}, ptr %out, i64 %od{i}",
            f"  store {kind} %ob{i}, ptr %oe{i}",
        ]
    lines += [
        "  %next = add i64 %k, 1",
        "  %more = icmp slt i64 %next, %m",
        "  br i1 %more, label %loop, label %done",
        "done:",
        "  ret void",
        "}",
        "",
    ]
    return "\n".join(lines)


def declarations(codes: Iterable[Code], scalar: Scalar, lanes: int = 1) -> str:
    """What the codes call, for one state or several: declarations of library functions, sine and cosine."""
    called, counts, fused, exactly = set(), set(), False, False
    for code in codes:
        live = code.program.live(code.outputs)
        for number in live:
            instruction = code.program.instructions[number]
            exactly = exactly or instruction.operation == PRODUCT_ROUNDING
            if len(instruction.operands) == 1 and instruction.operation not in ("negative", *_KINKED):
                called.add(instruction.operation)
        for step in _steps(code, live, scalar):
            if isinstance(step, tuple):
                whole, rest = divmod(len(step), MOST_ANGLES)
                counts |= {lanes} if lanes > 1 else {packed(rest)} - {0} | ({MOST_ANGLES} if whole else set())
            fused = fused or isinstance(step, Fused)
    kind, lines = vector(lanes, scalar.type), []
    if fused and not (counts and kind in {vector(count, "double") for count in counts}):
        lines.append(f"declare {kind} @llvm.fmuladd.{suffix(scalar, lanes)}({kind}, {kind}, {kind})\n")
    if exactly and scalar.name != EXTENDED:
        lines.append(f"declare {kind} @llvm.fma.{suffix(scalar, lanes)}({kind}, {kind}, {kind})\n")
    if counts:
        called -= {"sin", "cos"}
        lines.append("declare double @sin(double) #1\ndeclare double @cos(double) #1\n")
        lines += [sine_cosine.declarations(count) + sine_cosine.text(count) for count in sorted(counts)]
    if lanes > 1 and "sqrt" in called:
        called.remove("sqrt")
        lines.append(f"declare {kind} @llvm.sqrt.{suffix(scalar, lanes)}({kind})\n")
    scalar_type = scalar.type
    for name in sorted(called):
        if isinstance(name, Tabulated):
            lines.append(lookup.llvm_text(name, scalar_type, scalar.suffix, constant))
        else:
            lines.append(f"declare {scalar_type} @{name}{scalar.suffix}({scalar_type}) #1\n")
    return "".join(lines)


#: No errno, no traps: sin and cos of one argument may be computed together.
ATTRIBUTES = (
    "attributes #0 = { nounwind }\n"
    "attributes #1 = { nounwind willreturn memory(none) }\n"
    "attributes #2 = { noinline nounwind }\n"
    "attributes #3 = { nounwind willreturn memory(none) }\n"
    "attributes #4 = { cold noinline nounwind willreturn memory(none) }\n"
    '!0 = !{!"branch_weights", i32 1, i32 100000}\n'
)


#: To be counted up when ``Library`` does something else with a text than before.
_PASSES = "1"

#: How a text says an address in the memory of this process.
_IN_MEMORY = "inttoptr"


@cache
def _started() -> None:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    library = ctypes.util.find_library("m")
    if library is not None:
        llvm.load_library_permanently(library)


class Library:
    """Compiled functions by name; their machine code lives as long as this object, and is kept for other processes."""

    def __init__(self, text: str, level: int = 2, thorough: bool = True) -> None:
        _started()
        target, cpu = llvm.Target.from_default_triple(), llvm.get_host_cpu_name()
        features = llvm.get_host_cpu_features().flatten()
        machine = target.create_target_machine(cpu=cpu, features=features, opt=level, jit=True)
        versions = (_PASSES, llvmlite.__version__, *map(str, llvm.llvm_version_info))
        key = stored.key_of([*versions, machine.triple, cpu, features, str(level), str(thorough), text])
        lasting = _IN_MEMORY not in text  # addresses are this process's own
        code = stored.load(key) if lasting else None
        module = llvm.parse_assembly(text if code is None else "")
        module.triple = machine.triple
        module.data_layout = str(machine.target_data)
        if code is None:
            module.verify()
            options = llvm.create_pipeline_tuning_options(speed_level=level)
            options.slp_vectorization = thorough
            builder = llvm.create_pass_builder(machine, options)
            builder.getModulePassManager().run(module, builder)
        self._engine = llvm.create_mcjit_compiler(module, machine)
        if code is not None:
            self._engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        elif lasting:
            self._engine.set_object_cache(lambda _, made: stored.keep(key, made))
        self._engine.finalize_object()

    def function(self, name: str, *arguments: Any, result: Any = None) -> Callable[..., Any]:
        """A ctypes function; the library must outlive it."""
        return ctypes.CFUNCTYPE(result, *arguments)(self._engine.get_function_address(name))


def compiled(codes: Mapping[str, Code], scalar: str = FLOAT64, more: str = "", many: bool = True) -> Library:
    """A library of the codes (``name`` and ``name.many`` each) and of further LLVM text that may call them."""
    chosen = SCALARS[scalar]
    parts = [declarations(codes.values(), chosen)]
    for name, code in codes.items():
        parts.append(function_text(name, code, chosen))
        if many:
            parts.append(many_text(name, code, chosen))
    short = max((len(code.program.live(code.outputs)) for code in codes.values()), default=0) <= LONG
    return Library("\n".join([*parts, more, ATTRIBUTES]), level=2 if short else 1, thorough=short)


def kernel(code: Code, scalar: str = FLOAT64) -> Kernel:
    """A Kernel in machine code."""
    return kernels({"f": code}, scalar)["f"]


def kernels(codes: Mapping[str, Code], scalar: str = FLOAT64, wide: bool = False) -> dict[str, Kernel]:
    """Several kernels compiled together; ``wide``: also, at once, for several states side by side."""
    library = compiled(codes, scalar)
    return {name: _Called(library, name, code, SCALARS[scalar], wide) for name, code in codes.items()}


def compiled_wide(name: str, code: Code, scalar: str) -> Library:
    """A library with ``name.wide``."""
    chosen, lanes = SCALARS[scalar], lanes_of(scalar)
    parts = [declarations([code], chosen, lanes), wide_text(name, code, chosen, lanes), ATTRIBUTES]
    return Library("\n".join(parts), thorough=False)


class _Called:
    """A compiled code as a function of arrays; several states at once when many of them have been asked for.

    It makes no difference to the results, which are equal to the last bit.
    """

    def __init__(self, library: Library, name: str, code: Code, scalar: Scalar, wide: bool) -> None:
        self.library, self.name, self.code, self.scalar, self.dtype = library, name, code, scalar, scalar.dtype
        pointer, whole = ctypes.c_void_p, ctypes.c_int64
        self._one = library.function(name, pointer, pointer)
        self._many = library.function(f"{name}.many", pointer, pointer, whole)
        self._lanes = lanes_of(scalar.name)
        self._states = 0
        self._wide: Callable[..., Any] | None = None
        if wide:
            self._widen()

    def _widen(self) -> None:
        if self._lanes > 1:
            self.wide_library = compiled_wide(self.name, self.code, self.scalar.name)
            pointer = ctypes.c_void_p
            self._wide = self.wide_library.function(f"{self.name}.wide", pointer, pointer, ctypes.c_int64)

    def __call__(self, values: Any) -> Any:
        values = np.ascontiguousarray(values, dtype=self.dtype)
        if values.shape[0] != len(self.code.inputs) or values.ndim > 2:
            raise ValueError(f"expected {len(self.code.inputs)} rows, not an array of shape {values.shape}")
        out = np.empty((len(self.code.outputs), *values.shape[1:]), dtype=self.dtype)
        if values.ndim == 1:
            self._one(values.ctypes.data, out.ctypes.data)
            return out
        count = values.shape[1]
        self._states += count
        if self._wide is None and self._states >= WIDE:
            self._widen()
        run = self._many if self._wide is None or count < self._lanes else self._wide
        run(values.ctypes.data, out.ctypes.data, count)
        return out
