"""The midpoint rule's equation as straight-line code, and the machine code that steps with it (``symplectic``)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from flint import arb, ctx

from mbsym.algebra.derivative import jacobian
from mbsym.algebra.program import Node
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.kernels.llvm import Scalar
from mbsym.numerics.kernels.writer import INTEGER, POINTER, Function, Value, clock_kind
from mbsym.numerics.methods.tableaux import add_compensated
from mbsym.numerics.scenario import PRECISION, rounded
from mbsym.numerics.specialise import Specialised, substituted

#: Newton's method needs four or five iterations; more than this and the step is too long.
MOST_ITERATIONS = 40

# Places in the arrays that the machine code and Python share.
START, STEP, LARGEST_RATE = range(3)
ITERATIONS, JACOBIANS, TROUBLE, NUMBER = range(4)
NO_SOLUTION, NOT_FINITE = 1, 2


@dataclass(frozen=True)
class Codes:
    """``newton``: residual and its Jacobian by v; ``residual`` alone; ``force``: L_q.  Inputs (t, h, q0, v, p0)."""

    newton: Code
    residual: Code
    force: Code


def codes(dynamics: Dynamics) -> Codes:
    """The midpoint rule's equation as straight-line code."""
    names = dynamics.system.coordinates
    fresh = Specialised()
    time, step = fresh.input("time"), fresh.input("step")
    positions = [fresh.input(f"q {i}") for i in range(len(names))]
    rates = [fresh.input(f"v {i}") for i in range(len(names))]
    momenta = [fresh.input(f"p {i}") for i in range(len(names))]
    half = fresh.number(Fraction(1, 2))
    middle = half * step
    with ctx.workprec(PRECISION):
        bound: dict[str, Node] = {"pi": fresh.number(rounded(arb.pi())), "t": time + middle}
    for name, velocity, q, v in zip(names, dynamics.system.velocities, positions, rates, strict=True):
        bound[name], bound[velocity] = q + middle * v, v
    fresh.bound = bound
    program = dynamics.momenta.program
    outputs = [*dynamics.momenta.outputs, *dynamics.momentum_rates.outputs]
    found = substituted(program, outputs, fresh)
    impulses, forces = found[: len(names)], found[len(names) :]
    residual = [a - middle * b - p for a, b, p in zip(impulses, forces, momenta, strict=True)]
    rows = jacobian(fresh, residual, rates)
    inputs = ("time", "step", *(f"{letter} {i}" for letter in "qvp" for i in range(len(names))))
    return Codes(
        newton=Code(fresh, inputs, (*residual, *(entry for row in rows for entry in row))),
        residual=Code(fresh, inputs, tuple(residual)),
        force=Code(fresh, inputs, tuple(forces)),
    )


def midpoint_text(size: int, fractions: Sequence[Fraction], scalar: Scalar) -> str:
    """``i64 @midpoint(x, carry, guess, clock, count, first, last)``: steps of an interval; how many were made.

    ``x`` holds (q, p), ``guess`` the last two midpoint rates (v, then the one before).
    """
    names = ("x", "carry", "guess", "clock", "count")
    f = Function("midpoint", [(name, POINTER) for name in names] + [("first", INTEGER), ("last", INTEGER)])
    clock = clock_kind(scalar)
    start, step = f.load(clock, f["clock"], START), f.load(clock, f["clock"], STEP)
    with f.repeat(f["last"], f["first"]) as number:
        base = start + number.converted(clock) * step
        past = Fraction(0)
        for place, share in enumerate(fractions):
            # Midpoints lie (g_i + g_i-1) h / 2 apart; v is continued linearly where that is no wild extrapolation.
            previous, earlier = (fractions[(place - back) % len(fractions)] for back in (1, 2))
            ahead, behind = (share + previous) / 2, (previous + earlier) / 2
            slope = ahead / behind if behind and abs(ahead) <= 2 * abs(behind) else Fraction(0)
            times = (base + step * past, step * share, f.number(slope, clock))
            past += share
            trouble = f.call("substep", INTEGER, *(f[name] for name in names), *times)
            good, bad = f.label(), f.label()
            f.branch(trouble.compare("==", 0), good, bad)
            f.place(bad)
            f.store(trouble, INTEGER, f["count"], TROUBLE)
            f.leave(number - f["first"])
            f.place(good)
    f.leave(f["last"] - f["first"])
    return _substep_text(size, scalar) + f.text()


def record_text(size: int, scalar: Scalar) -> str:
    """``i64 @record(x, carry, guess, clock, count, marks, kept, first, last)``: steps up to the numbers in ``marks``.

    At each of them x and carry are kept, 4 n numbers a mark.  Returns the first mark that is not reached.
    """
    names = ("x", "carry", "guess", "clock", "count")
    pointers = [(name, POINTER) for name in (*names, "marks", "kept")]
    f = Function("record", [*pointers, ("first", INTEGER), ("last", INTEGER)])
    kind, count = scalar.type, f["count"]
    with f.repeat(f["last"], f["first"]) as mark:
        number, goal = f.load(INTEGER, count, NUMBER), f.load(INTEGER, f["marks"], mark)
        made = f.call("midpoint", INTEGER, *(f[name] for name in names), number, goal)
        f.store(number + made, INTEGER, count, NUMBER)
        good, bad = f.label(), f.label()
        f.branch((number + made).compare("<", goal), bad, good)
        f.place(bad)
        f.leave(mark)
        f.place(good)
        for place, source in enumerate(("x", "carry")):
            with f.repeat(2 * size) as i:
                f.store(f.load(kind, f[source], i), kind, f["kept"], mark * (4 * size) + i + place * 2 * size)
    f.leave(f["last"])
    return f.text()


def _substep_text(size: int, scalar: Scalar) -> str:
    """``i64 @substep(x, carry, guess, clock, count, time, h, slope)``: one midpoint step; 0, or what went wrong."""
    kind, clock = scalar.type, clock_kind(scalar)
    names = ("x", "carry", "guess", "clock", "count")
    f = Function("substep", [(name, POINTER) for name in names] + [(name, clock) for name in ("time", "h", "slope")])
    x, guess, count, h = f["x"], f["guess"], f["count"], f["h"]
    argument = f.slot(kind, 2 + 3 * size)
    result = f.slot(kind, size + size * size)
    change, largest, before, total = f.slot(kind), f.slot(kind), f.slot(kind), f.slot(kind)
    rounds = f.slot(INTEGER)
    rates = f.at(kind, argument, 2 + size)
    matrix = f.at(kind, result, size)
    eps = Fraction(float(np.finfo(scalar.dtype).eps))

    f.store(f["time"].converted(kind), kind, argument, 0)
    f.store(h.converted(kind), kind, argument, 1)
    slope = f["slope"].converted(kind)
    with f.repeat(size) as i:
        f.store(f.load(kind, x, i), kind, argument, i + 2)
        f.store(f.load(kind, x, i + size), kind, argument, i + (2 + 2 * size))
        latest = f.load(kind, guess, i)
        f.store(latest + (latest - f.load(kind, guess, i + size)) * slope, kind, rates, i)
    f.do("newton", argument, result)
    f.store(f.load(INTEGER, count, JACOBIANS) + 1, INTEGER, count, JACOBIANS)
    _factorise(f, kind, matrix, size)
    f.store(0, INTEGER, rounds)
    f.store(Fraction(10) ** 30, kind, before)
    again, done, more, failed, next_one = (f.label() for _ in range(5))
    f.jump(again)

    f.place(again)
    _solve(f, kind, matrix, result, size)
    f.store(0, kind, change)
    f.store(f.load(clock, f["clock"], LARGEST_RATE).converted(kind), kind, largest)
    with f.repeat(size) as i:
        correction = f.load(kind, result, i)
        v = f.load(kind, rates, i) - correction
        f.store(v, kind, rates, i)
        _raise_to(f, kind, change, correction.absolute())
        _raise_to(f, kind, largest, v.absolute())
    f.store(f.load(kind, largest).converted(clock), clock, f["clock"], LARGEST_RATE)
    moved, scale = f.load(kind, change), f.load(kind, largest)
    f.store(f.load(INTEGER, rounds) + 1, INTEGER, rounds)
    f.store(f.load(INTEGER, count, ITERATIONS) + 1, INTEGER, count, ITERATIONS)
    # As small as can be, or small and no longer decreasing: roundoff has been reached.
    small = moved.compare("<=", scale * (eps / 4))
    still = moved.compare("<=", scale * (eps * 4096)) & moved.compare(">=", f.load(kind, before) * Fraction(1, 4))
    f.store(moved, kind, before)
    f.branch(small | still, done, more)
    f.place(more)
    f.branch(f.load(INTEGER, rounds).compare(">=", MOST_ITERATIONS), failed, next_one)
    f.place(next_one)
    f.do("residual", argument, result)
    f.jump(again)
    f.place(failed)
    f.leave(NO_SOLUTION)

    f.place(done)
    f.do("force", argument, result)
    width = h.converted(kind)
    f.store(0, kind, total)
    with f.repeat(size) as i:
        v = f.load(kind, rates, i)
        f.store(f.load(kind, guess, i), kind, guess, i + size)
        f.store(v, kind, guess, i)
        q = add_compensated(f, kind, x, f["carry"], i, width * v)
        p = add_compensated(f, kind, x, f["carry"], i + size, width * f.load(kind, result, i))
        f.store(f.load(kind, total) + ((q - q) + (p - p)), kind, total)
    finite = f.load(kind, total).compare("<=", 0)
    f.leave(finite.choose(f.number(0, INTEGER), f.number(NOT_FINITE, INTEGER)))
    return f.text()


def _raise_to(f: Function, kind: str, place: Value, value: Value) -> None:
    """place <- max(place, value)."""
    now = f.load(kind, place)
    f.store(value.compare(">", now).choose(value, now), kind, place)


def _factorise(f: Function, kind: str, matrix: Value, size: int) -> None:
    """matrix <- its L U factors.

    No pivots are exchanged: the symmetric part of the matrix is M - O(h^2), which is positive definite for every step
    that is not far too long.
    """
    with f.repeat(size) as k:
        inverse = 1 / f.load(kind, matrix, k * (size + 1))
        with f.repeat(size, k + 1) as i:
            factor = f.load(kind, matrix, i * size + k) * inverse
            f.store(factor, kind, matrix, i * size + k)
            with f.repeat(size, k + 1) as j:
                entry = f.load(kind, matrix, i * size + j) - factor * f.load(kind, matrix, k * size + j)
                f.store(entry, kind, matrix, i * size + j)


def _solve(f: Function, kind: str, matrix: Value, vector: Value, size: int) -> None:
    """vector <- (L U)^-1 vector."""
    with f.repeat(size) as i, f.repeat(i) as j:
        entry = f.load(kind, vector, i) - f.load(kind, matrix, i * size + j) * f.load(kind, vector, j)
        f.store(entry, kind, vector, i)
    with f.repeat(size) as back:
        i = (size - 1) - back
        with f.repeat(size, i + 1) as j:
            entry = f.load(kind, vector, i) - f.load(kind, matrix, i * size + j) * f.load(kind, vector, j)
            f.store(entry, kind, vector, i)
        f.store(f.load(kind, vector, i) / f.load(kind, matrix, i * (size + 1)), kind, vector, i)
