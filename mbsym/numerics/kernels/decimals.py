"""Tables of float64 as text, digit for digit what ``%.17g`` gives, in machine code.

A number v = m 2^e with 2^52 <= m < 2^53 has the 17 digits

    N = round(v 10^(16 - X)),    10^X <= v < 10^(X + 1),

and m times a power of ten of 128 bits, rounded down, gives v 10^(16 - X) but for less than 2^-63: only where that is so
close to half a unit that its rounding could go either way, and for infinities, subnormal numbers and what is no number,
does C's own conversion decide, as Python's ``%`` has it.  So every digit is right.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from math import inf, nextafter
from typing import Any

import numpy as np

from mbsym.numerics.kernels.llvm import ATTRIBUTES, Library
from mbsym.numerics.kernels.writer import INTEGER, POINTER, Function, Value

#: A number takes at most so many bytes, its separator included: -1.2345678901234567e-300, and what is copied beyond.
ROOM = 40

#: Tables with fewer numbers are not worth compiling for.
MANY = 100_000

#: Powers of ten 10^p in the table: p from LEAST to LEAST + POWERS - 1, for 16 - X.
LEAST, POWERS = -293, 620

WIDE = "i192"


def powers() -> tuple[Any, Any, Any]:
    """(P, s, d): floor(10^p 2^s) in [2^127, 2^128) as two words each, low one first; s; and 10^(16 - p), rounded up."""
    words, shifts = np.zeros((POWERS, 2), np.uint64), np.zeros(POWERS, np.int64)
    for place in range(POWERS):
        power = LEAST + place
        above, below = 10 ** max(power, 0), 10 ** max(-power, 0)
        shift = 127 - (above.bit_length() - below.bit_length())
        quotient = _scaled(above, below, shift)
        if quotient >> 128:
            shift -= 1
        elif not quotient >> 127:
            shift += 1
        quotient = _scaled(above, below, shift)
        words[place], shifts[place] = (quotient & (2**64 - 1), quotient >> 64), shift
    return words, shifts, np.array([_decade(16 - LEAST - place) for place in range(POWERS)])


def _decade(power: int) -> float:
    """The least float64 that is not below 10^power."""
    near = float(f"1e{power}")
    exact = Fraction(10) ** power
    return near if near == inf or Fraction(near) >= exact else nextafter(near, inf)


def _scaled(above: int, below: int, shift: int) -> int:
    """floor(above / below 2^shift)."""
    return (above << shift) // below if shift >= 0 else above // (below << -shift)


def text() -> str:
    """``i64 @decimals(table, out, powers, shifts, decades, pairs, reached, first, last, columns, stride)``.

    Rows first to last - 1 of a table, column c of row r at table[c stride + r], as lines; returns how many bytes they
    take.  Stops before a row with a number that it must leave to others; reached[0] is that row.
    """
    pointers = ("table", "out", "powers", "shifts", "decades", "pairs", "reached")
    numbers = ("first", "last", "columns", "stride")
    f = Function("decimals", [*((name, POINTER) for name in pointers), *((name, INTEGER) for name in numbers)])
    put, value, digits = f.slot(INTEGER), f.slot(INTEGER), f.slot("i8", 64)
    f.store(0, INTEGER, put)
    f.store(0, INTEGER, value)
    stalled = f.label()
    f.store(f["first"], INTEGER, f["reached"])
    with f.repeat(f["last"], f["first"]) as row:
        with f.repeat(f["columns"]) as column:
            _number(f, f.load("double", f["table"], column * f["stride"] + row), put, digits, stalled)
            end = f.load(INTEGER, put)
            over = (column + 1).compare("==", f["columns"])
            _byte(f, over.choose(f.number(10, INTEGER), f.number(44, INTEGER)), f["out"], end)
            f.store(end + 1, INTEGER, put)
        f.store(f.load(INTEGER, put), INTEGER, value)
        f.store(row + 1, INTEGER, f["reached"])
    f.leave(f.load(INTEGER, put))
    f.place(stalled)
    f.leave(f.load(INTEGER, value))
    return f.text()


def _number(f: Function, x: Value, put: Value, digits: Value, stalled: str) -> None:
    """Writes one number; ``put`` is where, and then behind it."""
    out = f["out"]
    bits = f.value(INTEGER, f"bitcast double {x.text} to i64")
    negative = bits.compare("<", 0)
    with f.when(negative):
        _byte(f, f.number(45, INTEGER), out, f.load(INTEGER, put))
        f.store(f.load(INTEGER, put) + 1, INTEGER, put)
    size = _and(f, bits, 2**63 - 1)
    some, nothing, done = f.label(), f.label(), f.label()
    f.branch(size.compare("==", 0), nothing, some)
    f.place(nothing)
    _byte(f, f.number(48, INTEGER), out, f.load(INTEGER, put))
    f.store(f.load(INTEGER, put) + 1, INTEGER, put)
    f.jump(done)
    f.place(some)
    biased = _shifted(f, size, 52)
    _unless(f, biased.compare(">", 0) & biased.compare("<", 2047), stalled)
    mantissa = _and(f, size, 2**52 - 1) + 2**52
    exponent = biased - 1075
    value = f.value("double", f"bitcast i64 {size.text} to double")
    estimate = _right(f, (exponent + 52) * 78913, 18)
    above = f.load("double", f["decades"], 15 - LEAST - estimate)  # 10^(estimate + 1)
    power = value.compare(">=", above).choose(estimate + 1, estimate)
    number = _digits(f, mantissa, exponent, power, stalled)
    count = _spread(f, number, digits)
    _layout(f, power, count, digits, put)
    f.jump(done)
    f.place(done)


def _digits(f: Function, mantissa: Value, exponent: Value, power: Value, stalled: str) -> Value:
    """N for 10^power <= v < 10^(power + 1)."""
    place = 16 - LEAST - power
    low, high = (f.load(INTEGER, f["powers"], place * 2 + word) for word in (0, 1))
    wide = [f.value(WIDE, f"zext i64 {word.text} to {WIDE}") for word in (low, high, mantissa)]
    moved = f.value(WIDE, f"shl {WIDE} {wide[1].text}, 64")
    ten = f.value(WIDE, f"or {WIDE} {moved.text}, {wide[0].text}")
    product = f.value(WIDE, f"mul {WIDE} {ten.text}, {wide[2].text}")
    shift = f.load(INTEGER, f["shifts"], place) - exponent - 64
    distance = f.value(WIDE, f"zext i64 {shift.text} to {WIDE}")
    scaled = f.value(WIDE, f"lshr {WIDE} {product.text}, {distance.text}")
    fraction = f.value(INTEGER, f"trunc {WIDE} {scaled.text} to i64")
    upper = f.value(WIDE, f"lshr {WIDE} {scaled.text}, 64")
    whole = f.value(INTEGER, f"trunc {WIDE} {upper.text} to i64")
    # As signed numbers fractions from one half on are negative, and the greatest below one half are next to 2^63.
    _unless(f, fraction.compare("<", 2**63 - 4) & (fraction + (2**63 - 1)).compare("!=", -1), stalled)
    number = fraction.compare("<", 0).choose(whole + 1, whole)
    _unless(f, number.compare(">=", 10**16) & number.compare("<", 10**17), stalled)
    return number


def _spread(f: Function, number: Value, digits: Value) -> Value:
    """The 17 digits of a number as bytes; how many there are but for zeros at the end."""
    rest = number
    for place in range(15, 0, -2):
        quotient = f.value(INTEGER, f"udiv i64 {rest.text}, 100")
        pair = rest - quotient * 100
        two = f.load("i16", f["pairs"], pair)
        f.store(two, "i16", f.at("i8", digits, place))
        rest = quotient
    _byte(f, rest + 48, digits, f.number(0, INTEGER))
    count = f.slot(INTEGER)
    f.store(17, INTEGER, count)
    again, less, done = f.label(), f.label(), f.label()
    f.jump(again)
    f.place(again)
    last = f.load(INTEGER, count) - 1
    byte = f.load("i8", digits, last)
    f.branch(f.value("i1", f"icmp eq i8 {byte.text}, 48"), less, done)
    f.place(less)
    f.store(last, INTEGER, count)
    f.jump(again)
    f.place(done)
    return f.load(INTEGER, count)


def _layout(f: Function, power: Value, count: Value, digits: Value, put: Value) -> None:
    """The digits with point and exponent, as %g has them."""
    out, start = f["out"], f.load(INTEGER, put)
    plain, scientific, small, large, done = (f.label() for _ in range(5))
    f.branch(power.compare(">=", -4) & power.compare("<", 17), plain, scientific)
    f.place(plain)
    f.branch(power.compare("<", 0), small, large)

    f.place(small)
    f.store(f.number(int.from_bytes(b"0.000000", "little"), INTEGER), INTEGER, f.at("i8", out, start))
    behind = start + 1 - power
    _copied(f, digits, out, behind)
    f.store(behind + count, INTEGER, put)
    f.jump(done)

    f.place(large)
    _copied(f, digits, out, start)
    f.store(start + power + 1, INTEGER, put)
    with f.when(count.compare(">", power + 1)):
        _copied(f, f.at("i8", digits, power + 1), out, start + power + 2)
        _byte(f, f.number(46, INTEGER), out, start + power + 1)
        f.store(start + count + 1, INTEGER, put)
    f.jump(done)

    f.place(scientific)
    _copied(f, digits, out, start)
    f.store(start + 1, INTEGER, put)
    with f.when(count.compare(">", 1)):
        _copied(f, f.at("i8", digits, 1), out, start + 2)
        _byte(f, f.number(46, INTEGER), out, start + 1)
        f.store(start + count + 1, INTEGER, put)
    end = f.load(INTEGER, put)
    _byte(f, f.number(101, INTEGER), out, end)
    _byte(f, power.compare("<", 0).choose(f.number(45, INTEGER), f.number(43, INTEGER)), out, end + 1)
    size = power.compare("<", 0).choose(0 - power, power)
    hundreds = f.value(INTEGER, f"udiv i64 {size.text}, 100")
    f.store(end + 2, INTEGER, put)
    with f.when(hundreds.compare(">", 0)):
        _byte(f, hundreds + 48, out, end + 2)
        f.store(end + 3, INTEGER, put)
    two = f.load("i16", f["pairs"], size - hundreds * 100)
    last = f.load(INTEGER, put)
    f.store(two, "i16", f.at("i8", out, last))
    f.store(last + 2, INTEGER, put)
    f.jump(done)
    f.place(done)


def _byte(f: Function, value: Value, base: Value, place: Value) -> None:
    f.store(f.value("i8", f"trunc i64 {value.text} to i8"), "i8", base, place)


def _copied(f: Function, digits: Value, out: Value, place: Value) -> None:
    """24 bytes, of which the last ones mean nothing."""
    taken = f.value(WIDE, f"load {WIDE}, ptr {digits.text}, align 1")
    f.lines.append(f"  store {WIDE} {taken.text}, ptr {f.at('i8', out, place).text}, align 1")


def _and(f: Function, value: Value, mask: int) -> Value:
    return f.value(INTEGER, f"and i64 {value.text}, {mask}")


def _shifted(f: Function, value: Value, bits: int) -> Value:
    return f.value(INTEGER, f"lshr i64 {value.text}, {bits}")


def _right(f: Function, value: Value, bits: int) -> Value:
    return f.value(INTEGER, f"ashr i64 {value.text}, {bits}")


def _unless(f: Function, fine: Value, stalled: str) -> None:
    good = f.label()
    f.branch(fine, good, stalled)
    f.place(good)


@cache
def _writer() -> tuple[Library, Callable[..., int], tuple[Any, ...]]:
    """The compiled function and the tables that it needs."""
    library = Library(text() + ATTRIBUTES, level=1)
    pointer, whole = ctypes.c_void_p, ctypes.c_int64
    function = library.function("decimals", *[pointer] * 7, *[whole] * 4, result=whole)
    pairs = np.frombuffer("".join(f"{k:02}" for k in range(100)).encode(), np.uint8).copy()
    return library, function, (*powers(), pairs)


def lines(table: Any) -> str:
    """The rows of ``table``, an array (columns, rows) of float64, as lines of numbers that read back exactly."""
    table = np.ascontiguousarray(table, dtype=float)
    columns, rows = table.shape
    line = ",".join(["%.17g"] * columns) + "\n"
    if not columns or not rows:
        return "\n" * rows
    _, function, tables = _writer()
    out, reached = np.empty(rows * columns * ROOM + ROOM, np.uint8), np.zeros(1, np.int64)
    addresses = (table.ctypes.data, out.ctypes.data, *(array.ctypes.data for array in tables), reached.ctypes.data)
    pieces, row = [], 0
    while row < rows:
        size = function(*addresses, row, rows, columns, rows)
        pieces.append(out[:size].tobytes().decode("ascii"))
        row = int(reached[0])
        if row < rows:
            pieces.append(line % tuple(table[:, row].tolist()))
            row += 1
    return "".join(pieces)
