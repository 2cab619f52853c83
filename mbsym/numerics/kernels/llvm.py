"""LLVM text, one line an operation, compiled in the process by llvmlite.

    void name(ptr in, ptr out)                 one state
    void name.many(ptr in, ptr out, i64 m)     m states; arrays of shape (inputs, m) and (outputs, m), row by row

``in`` and ``out`` hold float64, float32 or x86 extended numbers.  Constants are rounded once, from exact fractions.
Multiplications and additions may be contracted (a*b + c with one rounding), nothing else is reordered.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import platform
import struct
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

import llvmlite.binding as llvm
import numpy as np

from mbsym.algebra.base import NoClosedForm
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT32, FLOAT64, Code, Kernel


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
        raise NoClosedForm(f"a constant beyond the range of {kind}")
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
        raise NoClosedForm("a constant beyond the range of x86_fp80")
    sign = 0x8000 if value < 0 else 0
    biased = exponent + 16383 if significand >= 2**63 else 0
    return f"0xK{sign | biased:04X}{significand:016X}"


SCALARS = {
    FLOAT64: Scalar(FLOAT64, "double", "", np.float64),
    FLOAT32: Scalar(FLOAT32, "float", "f", np.float32),
    EXTENDED: Scalar(EXTENDED, "x86_fp80", "l", np.longdouble),
}

_ARITHMETIC = {"add": "fadd", "subtract": "fsub", "multiply": "fmul", "divide": "fdiv"}


def available(scalar: str) -> bool:
    """Whether this machine computes in that arithmetic."""
    return scalar != EXTENDED or (
        platform.machine().lower() in ("x86_64", "amd64") and np.finfo(np.longdouble).nmant == 63
    )


#: Longer programs are split into functions of ``PART`` operations, for which compilers take more than linear time, and
#: are not searched for operations that could be done side by side, which takes longest and gains some percent.
LONG, PART = 4_000, 500


def function_text(name: str, code: Code, scalar: Scalar) -> str:
    """The LLVM text of ``name`` (one state), without the declarations of library functions."""
    live = code.program.live(code.outputs)
    head = f"define void @{name}(ptr noalias readonly %in, ptr noalias %out) #0 {{"
    if len(live) <= LONG:
        lines, values = _body(code, live, scalar, {}, {})
        return "\n".join([head, *lines, *_stores(code, scalar, values), "  ret void", "}", ""])
    return _split(name, head, code, live, scalar)


def _split(name: str, head: str, code: Code, live: list[int], scalar: Scalar) -> str:
    """Parts one after the other; what a later part needs goes through memory."""
    kind, instructions = scalar.type, code.program.instructions
    parts = [live[start : start + PART] for start in range(0, len(live), PART)]
    home = {number: place for place, part in enumerate(parts) for number in part}
    kept: dict[int, int] = {}
    for number in live:
        for operand in instructions[number].operands:
            if home[operand] != home[number] and instructions[operand].operation != "constant":
                kept.setdefault(operand, len(kept))
    last = len(parts) - 1
    for node in code.outputs:
        if home[node.number] != last and instructions[node.number].operation != "constant":
            kept.setdefault(node.number, len(kept))
    texts, main = [], [head, f"  %w = alloca [{max(len(kept), 1)} x {kind}]"]
    for place, part in enumerate(parts):
        arguments = "ptr noalias readonly %in, ptr noalias %w" + (", ptr noalias %out" if place == last else "")
        needed = {operand for number in part for operand in instructions[number].operands if home[operand] != place}
        if place == last:
            needed |= {node.number for node in code.outputs if home[node.number] != last}
        lines, values = _body(code, part, scalar, {number: kept.get(number, -1) for number in sorted(needed)}, kept)
        if place == last:
            lines += _stores(code, scalar, values)
        texts.append(
            "\n".join([f"define internal void @{name}.{place}({arguments}) #2 {{", *lines, "  ret void", "}", ""])
        )
        given = "ptr %in, ptr %w" + (", ptr %out" if place == last else "")
        main.append(f"  call void @{name}.{place}({given})")
    return "".join(texts) + "\n".join([*main, "  ret void", "}", ""])


def _body(
    code: Code, numbers: Iterable[int], scalar: Scalar, given: Mapping[int, int], kept: Mapping[int, int]
) -> tuple[list[str], dict[int, str]]:
    """Lines for the instructions, and where their values are.

    ``given`` values of other parts come from their places in %w (those without a place are constants); values in
    ``kept`` go to theirs.
    """
    kind, instructions = scalar.type, code.program.instructions
    lines: list[str] = []
    slots = {input_: place for place, input_ in enumerate(code.inputs)}
    values: dict[int, str] = {}
    for number, place in given.items():
        payload = instructions[number].payload
        if isinstance(payload, Fraction):
            values[number] = scalar.constant(payload)
            continue
        lines.append(f"  %w{number} = getelementptr {kind}, ptr %w, i64 {place}")
        lines.append(f"  %v{number} = load {kind}, ptr %w{number}")
        values[number] = f"%v{number}"
    for number in numbers:
        instruction = instructions[number]
        if instruction.operation == "constant":
            assert isinstance(instruction.payload, Fraction)
            values[number] = scalar.constant(instruction.payload)
            continue
        local = values[number] = f"%v{number}"
        operands = [values[operand] for operand in instruction.operands]
        match instruction.operation, operands:
            case "input", _:
                place = slots[str(instruction.payload)]
                lines.append(f"  %p{number} = getelementptr {kind}, ptr %in, i64 {place}")
                lines.append(f"  {local} = load {kind}, ptr %p{number}")
            case "negative", [a]:
                lines.append(f"  {local} = fneg {kind} {a}")
            case ("add" | "subtract" | "multiply" | "divide") as operation, [a, b]:
                lines.append(f"  {local} = {_ARITHMETIC[operation]} contract {kind} {a}, {b}")
            case function, [a]:
                lines.append(f"  {local} = call {kind} @{function}{scalar.suffix}({kind} {a}) #1")
        if number in kept:
            lines.append(f"  %k{number} = getelementptr {kind}, ptr %w, i64 {kept[number]}")
            lines.append(f"  store {kind} {local}, ptr %k{number}")
    return lines, values


def _stores(code: Code, scalar: Scalar, values: Mapping[int, str]) -> list[str]:
    lines = []
    for place, node in enumerate(code.outputs):
        lines.append(f"  %o{place} = getelementptr {scalar.type}, ptr %out, i64 {place}")
        lines.append(f"  store {scalar.type} {values[node.number]}, ptr %o{place}")
    return lines


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
    lines.append(f"  call void @{name}(ptr %x, ptr %y)")
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


def declarations(codes: Iterable[Code], scalar: Scalar) -> str:
    """Declarations of the library functions that the codes call."""
    called = set()
    for code in codes:
        for number in code.program.live(code.outputs):
            instruction = code.program.instructions[number]
            if len(instruction.operands) == 1 and instruction.operation != "negative":
                called.add(instruction.operation)
    kind = scalar.type
    return "".join(f"declare {kind} @{name}{scalar.suffix}({kind}) #1\n" for name in sorted(called))


#: No errno, no traps: sin and cos of one argument may be computed together.
ATTRIBUTES = (
    "attributes #0 = { nounwind }\n"
    "attributes #1 = { nounwind willreturn memory(none) }\n"
    "attributes #2 = { noinline nounwind }\n"
    "attributes #3 = { nounwind willreturn memory(none) }\n"
    "attributes #4 = { cold noinline nounwind willreturn memory(none) }\n"
    '!0 = !{!"branch_weights", i32 1, i32 100000}\n'
)


@cache
def _started() -> None:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    library = ctypes.util.find_library("m")
    if library is not None:
        llvm.load_library_permanently(library)


class Library:
    """Compiled functions by name; their machine code lives as long as this object."""

    def __init__(self, text: str, level: int = 2, thorough: bool = True) -> None:
        _started()
        target = llvm.Target.from_default_triple()
        machine = target.create_target_machine(
            cpu=llvm.get_host_cpu_name(), features=llvm.get_host_cpu_features().flatten(), opt=level, jit=True
        )
        module = llvm.parse_assembly(text)
        module.triple = machine.triple
        module.data_layout = str(machine.target_data)
        module.verify()
        options = llvm.create_pipeline_tuning_options(speed_level=level)
        options.slp_vectorization = thorough
        builder = llvm.create_pass_builder(machine, options)
        builder.getModulePassManager().run(module, builder)
        self._engine = llvm.create_mcjit_compiler(module, machine)
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
    longest = max((len(code.program.live(code.outputs)) for code in codes.values()), default=0)
    return Library("\n".join([*parts, more, ATTRIBUTES]), thorough=longest <= LONG)


def kernel(code: Code, scalar: str = FLOAT64) -> Kernel:
    """A Kernel in machine code."""
    return kernels({"f": code}, scalar)["f"]


def kernels(codes: Mapping[str, Code], scalar: str = FLOAT64) -> dict[str, Kernel]:
    """Several kernels compiled together."""
    library = compiled(codes, scalar)
    return {name: _Called(library, name, code, SCALARS[scalar]) for name, code in codes.items()}


class _Called:
    """A compiled code as a function of arrays."""

    def __init__(self, library: Library, name: str, code: Code, scalar: Scalar) -> None:
        self.library, self.code, self.dtype = library, code, scalar.dtype
        pointer = ctypes.c_void_p
        self._one = library.function(name, pointer, pointer)
        self._many = library.function(f"{name}.many", pointer, pointer, ctypes.c_int64)

    def __call__(self, values: Any) -> Any:
        values = np.ascontiguousarray(values, dtype=self.dtype)
        if values.shape[0] != len(self.code.inputs) or values.ndim > 2:
            raise ValueError(f"expected {len(self.code.inputs)} rows, not an array of shape {values.shape}")
        out = np.empty((len(self.code.outputs), *values.shape[1:]), dtype=self.dtype)
        if values.ndim == 1:
            self._one(values.ctypes.data, out.ctypes.data)
        else:
            self._many(values.ctypes.data, out.ctypes.data, values.shape[1])
        return out
