"""Time-periodic first approximations: the monodromy matrix in balls, its multipliers, and what they prove.

    y' = J(t) y,    J(t + T) = J(t),    Phi' = J Phi,    Phi(0) = 1,    M = Phi(T)

J is the Jacobian of the equations on the unperturbed motion, as a program in t.  That it is periodic, and with which T,
is read from the program: t must be in sines and cosines only, of arguments a t + b with rational a.  On each of N steps
the Taylor series of Phi is summed in balls, with Lagrange's remainder: the coefficient of order K + 1 at every time of
the step, from the Jacobian's coefficients over the whole step and from  |Phi - 1| <= exp(|J| h) - 1.  M is their
product, a ball that contains the true matrix; so do its eigenvalues (acb_mat.eig, Rump's and van der Hoeven's methods,
block by block where entries are zero exactly; |mu| <= |M| where they are not isolated).

What follows (Lyapunov 1892; Yakubovich & Starzhinskii, Linear Differential Equations with Periodic Coefficients, 1975):
a multiplier outside the unit circle: unstable, and so is the motion of the whole equations; all inside: asymptotically
stable, likewise.  Where the equations follow from a Lagrangian, mu and 1/conj(mu) are multipliers together: a simple
one whose ball meets the mirror image of no other is on the circle exactly; if all are, the first approximation is
stable, and the whole equations are a critical case, unless they are linear: then simple ones on the circle beside
others inside are stability, too.  Anything else is undecided.  Coordinates
that nothing couples with others are judged by themselves: equal multipliers of two of them are no resonance, and of
one coordinate whose J has a trace without mean they are mu and 1/mu, exp(integral of tr J) being their product; of a
row whose entry has no mean, and that nothing but itself drives, it is 1.  Coordinates that no equation of motion
contains are left out where all is open with them: they may drift.

With constraints the flow takes changes that keep them, C y = 0 with C = [df/dq, 0; dg/dq, J], to such.  y has free
components, and others y_d = -C_d^-1 C_f y_f; of the monodromy matrix M_ff - M_fd C_d^-1 C_f is left, C being periodic.

Irrational numbers of the description are rounded to 256 bits before all this.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from functools import partial
from itertools import accumulate, combinations, product
from math import ceil, gcd, lcm
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import acb, acb_mat, arb, arb_mat, arb_series, ctx
from scipy.linalg import qr
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from mbsym.algebra.derivative import jacobian
from mbsym.algebra.failures import Failure, SingularPoint, message_of
from mbsym.algebra.point import Balls
from mbsym.algebra.program import Node
from mbsym.algebra.rationals import ball
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.kernels.precise import enclosures
from mbsym.numerics.methods.symplectic import without_potential
from mbsym.numerics.probes import motion_state
from mbsym.numerics.scenario import bound, substituted

if TYPE_CHECKING:
    from mbsym.numerics.constrained import Constraints

#: Order of the series, working precision, and how large |J| h and the fastest frequency times h may be on a step.
ORDER, BITS, REACH = 24, 192, Fraction(1, 4)

#: More steps than this, or more coordinates and velocities, are refused.
MOST_STEPS, MOST_STATES = 20_000, 40

#: Accelerations on the unperturbed motion below this are rounding of the description's numbers.
AT_REST = Fraction(1, 10**50)

#: When it is looked whether something is so at all times.
TIMES = (Fraction(0), Fraction(1, 3), Fraction(7, 5), Fraction(29, 7))


class NotPeriodic(Failure):
    """There is no periodic first approximation to judge; the message says why."""


class ConstantCoefficients(NotPeriodic):
    """The coefficients do not depend on the time, perhaps at these values only."""


class Word(Enum):
    """What is proved of the motion."""

    UNSTABLE = "unstable"
    ASYMPTOTICALLY_STABLE = "asymptotically stable"
    #: There are no terms of higher order.
    STABLE = "stable"
    #: Of what is left without coordinates that no equation of motion contains.
    ASYMPTOTIC_BUT_CYCLIC = "asymptotically stable but for a drift of cyclic coordinates"
    STABLE_BUT_CYCLIC = "stable but for a drift of cyclic coordinates"
    STABLE_FIRST_APPROXIMATION = "stable in the first approximation only"
    UNDECIDED = "undecided"


@dataclass(frozen=True)
class Multiplier:
    """A ball that contains a multiplier, and bounds of its absolute value; ``on_circle``: it is 1 exactly."""

    ball: acb
    least: float
    greatest: float
    on_circle: bool


@dataclass(frozen=True)
class Judged:
    """``monodromy`` is a matrix of balls that contains Phi(T); ``simple``: the multipliers' balls of each part of it
    that nothing couples with others are disjoint.

    ``rests`` says whether the unperturbed motion satisfies the equations as a program, or only to 50 digits.
    """

    word: Word
    period: arb
    frequency: Fraction
    names: tuple[str, ...]
    monodromy: arb_mat
    multipliers: tuple[Multiplier, ...]
    simple: bool
    lagrangian: bool
    rests: bool
    steps: int


def judged(dynamics: Dynamics, order: int = ORDER, bits: int = BITS, steady: bool = True) -> Judged:
    """The first approximation of the scenario's system about its unperturbed motion; ``steady``: although it is one at
    all times, where that is not seen of the equations as they are written.

    Raises NotPeriodic where there is none, where its coefficients are constant or not seen to be periodic, or where the
    unperturbed motion is none at these values.
    """
    code, rests = jacobian_on_motion(dynamics)
    frequency = common_frequency(code)
    if not steady and _is_the_same_at_all(code):
        raise ConstantCoefficients(
            "its coefficients are the same at [[count]] times, to 50 digits: problem 6 judges it (mbsym run)",
            count=str(len(TIMES)),
        )
    with ctx.workprec(bits):
        period = 2 * arb.pi() / ball(frequency)
        monodromy, steps = enclosed(code, period, len(dynamics.inputs) - 1, order)
        lagrangian = not without_potential(dynamics.system, dynamics.fixed_values) or (
            dynamics.size == 1 and _without_mean(code, (0, 1))
        )
        names: tuple[str, ...] = (*dynamics.system.coordinates, *dynamics.system.velocities)
        if dynamics.constraints is not None:
            monodromy, names = _allowed(dynamics, dynamics.constraints, monodromy, period, names)
            lagrangian = lagrangian and dynamics.constraints.holonomic == len(dynamics.constraints)
            multipliers, simple = _multipliers(monodromy, lagrangian, lambda _: False)
        else:
            multipliers, simple = _multipliers(monodromy, lagrangian, partial(_without_mean, code))
        word = _word(multipliers, simple, dynamics.linear)
        if word is Word.UNDECIDED and dynamics.constraints is None:
            word = _without_cyclic(dynamics, code, monodromy, lagrangian)
    return Judged(word, period, frequency, names, monodromy, multipliers, simple, lagrangian, rests, steps)


def _allowed(
    dynamics: Dynamics, constraints: Constraints, monodromy: arb_mat, period: arb, names: tuple[str, ...]
) -> tuple[arb_mat, tuple[str, ...]]:
    """What is left of the monodromy matrix on changes that keep the constraints, and the names of these components.

    Raises NotPeriodic where the motion does not satisfy the constraints, or these are not the same after the period.
    """
    n, h, r = constraints.size, constraints.holonomic, len(constraints)
    program, outputs = constraints.code.program, constraints.code.outputs
    slopes = jacobian(program, outputs[h : h + r], [program.input(name) for name in names])
    independent = constraints.kept
    nodes = [
        x for i in independent if i < h for x in (*outputs[h + r + i * n : h + r + (i + 1) * n], *[program.zero] * n)
    ]
    nodes += [x for i in independent for x in slopes[i]]
    code = Code(program, constraints.code.inputs, (*outputs[: h + r], *nodes))
    state = motion_state(dynamics.scenario)
    assert state is not None

    def at(time: arb) -> list[arb]:
        places = [ball(x) + ball(rate) * time for x, rate in zip(state[:n], state[n:], strict=True)]
        evaluated = enclosures(code, (time, *places, *map(ball, state[n:])), BITS)
        if not all(abs(x) < ball(AT_REST) for x in evaluated[: h + r]):
            raise NotPeriodic("the unperturbed motion does not satisfy the constraints at these values")
        return evaluated[h + r :]

    first, last = at(arb(0)), at(period)
    if not all(abs(x - y) < ball(AT_REST) for x, y in zip(first, last, strict=True)):
        raise NotPeriodic("the constraints are not the same after the period of the equations")
    count = len(first) // (2 * n)
    rows = [first[k * 2 * n : (k + 1) * 2 * n] for k in range(count)]
    order = qr(np.array([[float(x.mid()) for x in row] for row in rows]), pivoting=True)[2].tolist()
    tied = sorted(order[:count])
    free = [k for k in range(2 * n) if k not in tied]

    def block(lines: Sequence[Sequence[arb]], columns: Sequence[int]) -> arb_mat:
        return arb_mat(len(lines), len(columns), [line[k] for line in lines for k in columns])

    try:
        following = block(rows, tied).solve(block(rows, free))
    except ZeroDivisionError:
        raise NotPeriodic("the constraints lose their rank on the unperturbed motion") from None
    lines = [monodromy.tolist()[k] for k in free]
    return block(lines, free) - block(lines, tied) * following, tuple(names[k] for k in free)


def _word(multipliers: Sequence[Multiplier], simple: bool, linear: bool) -> Word:
    if any(multiplier.least > 1 for multiplier in multipliers):
        return Word.UNSTABLE
    if all(multiplier.greatest < 1 for multiplier in multipliers):
        return Word.ASYMPTOTICALLY_STABLE
    staying = all(multiplier.on_circle or (linear and multiplier.greatest < 1) for multiplier in multipliers)
    if simple and staying:
        return Word.STABLE if linear else Word.STABLE_FIRST_APPROXIMATION
    return Word.UNDECIDED


def _without_cyclic(dynamics: Dynamics, code: Code, monodromy: arb_mat, lagrangian: bool) -> Word:
    """The word without the coordinates that no equation of motion contains; undecided where all of them are."""
    rhs, n = dynamics.right_hand_side, dynamics.size
    live = {*rhs.program.live(rhs.outputs[n:])}
    cyclic = {i for i, name in enumerate(dynamics.system.coordinates) if rhs.program.input(name).number not in live}
    left = [k for k in range(2 * n) if k not in cyclic]
    if not cyclic:
        return Word.UNDECIDED
    rows = monodromy.tolist()
    rest = arb_mat([[rows[i][j] for j in left] for i in left])
    found = _multipliers(rest, lagrangian, lambda part: _without_mean(code, [left[k] for k in part]))
    words = {Word.ASYMPTOTICALLY_STABLE: Word.ASYMPTOTIC_BUT_CYCLIC, Word.STABLE: Word.STABLE_BUT_CYCLIC}
    return words.get(_word(*found, dynamics.linear), Word.UNDECIDED)


# --- the Jacobian as a program in t ---


def jacobian_on_motion(dynamics: Dynamics) -> tuple[Code, bool]:
    """J(t) row by row, 4 n n outputs, and whether the motion satisfies the equations as a program.

    Raises NotPeriodic where the description has no unperturbed motion, or one that is none at these values.
    """
    state = motion_state(dynamics.scenario)
    if state is None:
        raise NotPeriodic("the description has no unperturbed motion (motion:)")
    n, rhs, jacobian = dynamics.size, dynamics.right_hand_side, dynamics.jacobian
    if dynamics.switches.outputs:
        raise NotPeriodic("the equations hold sign, abs or step, or a table with kinks, whose derivatives jump")
    fresh = bound(dynamics.scenario)
    time = fresh.input("t")
    for place, (name, velocity) in enumerate(zip(dynamics.system.coordinates, dynamics.system.velocities, strict=True)):
        rate = fresh.number(state[n + place])
        fresh.bound[name] = fresh.number(state[place]) + fresh.product(rate, time)
        fresh.bound[velocity] = rate
    try:
        accelerations = substituted(rhs.program, rhs.outputs[n:], fresh)
        entries = substituted(jacobian.program, jacobian.outputs, fresh)
    except SingularPoint as reason:
        text = "the equations are singular on the unperturbed motion: [[why]]"
        raise NotPeriodic(text, why=message_of(reason)) from None
    rests = all(fresh.vanishes(node) for node in accelerations)
    if not rests:
        _require_rest(Code(fresh, ("t",), tuple(accelerations)), dynamics)
    return Code(fresh, ("t",), tuple(entries)), rests


def _is_the_same_at_all(code: Code) -> bool:
    """Whether its values, sums of quotients of sines and cosines of the time, are one at each of some times."""
    with ctx.workprec(2 * BITS):
        first, *others = (enclosures(code, [ball(at)], 2 * BITS) for at in TIMES)
        return all(
            abs(x - y) < ball(AT_REST) * (1 + abs(x)) for other in others for x, y in zip(first, other, strict=True)
        )


def _require_rest(code: Code, dynamics: Dynamics) -> None:
    system = dynamics.system
    following = {*system.coordinates} - {entry.coordinate for entry in system.motion} if system.constraints else ()
    with ctx.workprec(BITS):
        for at in TIMES:
            for name, value in zip(dynamics.system.coordinates, series(code, arb_series([ball(at)])), strict=True):
                size = abs(_coefficient(value, 0))
                if not size < ball(AT_REST):
                    if name in following:
                        raise NotPeriodic(
                            "[[name]] follows the unperturbed motion by constraints on velocities, and not evenly: "
                            "problem 6 judges such motions (mbsym run)",
                            name=name,
                        )
                    raise NotPeriodic(
                        "the unperturbed motion is none at these values: at t = [[time]] [[name]] has the "
                        "acceleration [[size]]",
                        time=f"{float(at):g}",
                        name=name,
                        size=f"{float(size.mid()):.3g}",
                    )


def common_frequency(code: Code) -> Fraction:
    """2 pi/T: the greatest common divisor of the frequencies of all sines and cosines of the time.

    Raises ConstantCoefficients, and NotPeriodic where the time is elsewhere than in sines and cosines.
    """
    program = code.program
    slopes: dict[int, Fraction] = {}
    frequencies: dict[int, frozenset[Fraction]] = {}
    for number in program.live(code.outputs):
        operation, operands, payload = program.instructions[number]
        slope = [slopes[operand] for operand in operands]
        known = frozenset().union(*(frequencies[operand] for operand in operands)) if operands else frozenset()
        match operation:
            case "input" | "constant":
                derivative = Fraction(int(payload == "t"))
            case "add":
                derivative = slope[0] + slope[1]
            case "subtract":
                derivative = slope[0] - slope[1]
            case "negative":
                derivative = -slope[0]
            case "multiply":
                derivative = _product_slope(program.instructions, operands, slope)
            case "sin" | "cos":
                derivative = Fraction(0)
                known = known | ({abs(slope[0])} if slope[0] else set())
            case _:
                derivative = Fraction(0)
                _require_no_time(any(slope))
        slopes[number], frequencies[number] = derivative, known
    _require_no_time(any(slopes[node.number] for node in code.outputs))
    all_of_them = frozenset().union(*(frequencies[node.number] for node in code.outputs))
    if not all_of_them:
        raise ConstantCoefficients("its coefficients are constant: problem 6 judges it (mbsym run)")
    bottom = lcm(*(frequency.denominator for frequency in all_of_them))
    return Fraction(gcd(*(int(frequency * bottom) for frequency in all_of_them)), bottom)


def _product_slope(instructions: Any, operands: Sequence[int], slope: Sequence[Fraction]) -> Fraction:
    for first, second in ((0, 1), (1, 0)):
        factor = instructions[operands[first]].payload
        if isinstance(factor, Fraction):
            return factor * slope[second]
    _require_no_time(any(slope))
    return Fraction(0)


def _require_no_time(there: bool) -> None:
    if there:
        raise NotPeriodic("its coefficients are not periodic: the time is in them otherwise than in sines and cosines")


def _without_mean(code: Code, part: Sequence[int]) -> bool:
    """Whether the trace of that part of J is known to have the mean zero over a period."""
    size = round(len(code.outputs) ** 0.5)
    total: Node = code.program.zero
    for place in part:
        total = total + code.outputs[place * (size + 1)]
    terms = _harmonics(code, total)
    return terms is not None and not any(any(value) for (rate, _), value in terms.items() if not rate)


#: Numbers re + i im, by a and b of the harmonics exp(i (a t + b)) before which they stand.
_Harmonics = dict[tuple[Fraction, Fraction], tuple[Fraction, Fraction]]

#: Sums of more harmonics are not formed.
MOST_HARMONICS = 200


def _harmonics(code: Code, node: Node) -> _Harmonics | None:
    """A program's value as a sum of harmonics of the time, exactly; None where it is none, or a long one."""
    zero, half = Fraction(0), Fraction(1, 2)
    program = code.program
    sums: dict[int, _Harmonics | None] = {}
    linear: dict[int, tuple[Fraction, Fraction] | None] = {}
    for number in program.live((node,)):
        operation, operands, payload = program.instructions[number]
        terms = [sums[operand] for operand in operands]
        forms = [linear[operand] for operand in operands]
        form: tuple[Fraction, Fraction] | None = None
        total: _Harmonics | None = None
        match operation, terms, forms:
            case "constant", _, _:
                assert isinstance(payload, Fraction)
                total, form = {(zero, zero): (payload, zero)}, (zero, payload)
            case "input", _, _ if payload == "t":
                form = Fraction(1), zero
            case "negative", [a], [f]:
                total = None if a is None else {key: (-x, -y) for key, (x, y) in a.items()}
                form = None if f is None else (-f[0], -f[1])
            case (("add" | "subtract"), [a, b], [f, g]):
                sign = 1 if operation == "add" else -1
                if a is not None and b is not None:
                    total = dict(a)
                    for key, (x, y) in b.items():
                        before = total.get(key, (zero, zero))
                        total[key] = before[0] + sign * x, before[1] + sign * y
                if f is not None and g is not None:
                    form = f[0] + sign * g[0], f[1] + sign * g[1]
            case "multiply", [a, b], [f, g]:
                if a is not None and b is not None:
                    total = {}
                    for ((rate, shift), (x, y)), ((other, more), (u, v)) in product(a.items(), b.items()):
                        key = rate + other, shift + more
                        before = total.get(key, (zero, zero))
                        total[key] = before[0] + x * u - y * v, before[1] + x * v + y * u
                if f is not None and g is not None and not (f[0] and g[0]):
                    form = f[0] * g[1] + f[1] * g[0], f[1] * g[1]
            case (("sin" | "cos"), _, [(rate, shift)]):
                parts = ((half, zero), (half, zero)) if operation == "cos" else ((zero, -half), (zero, half))
                total = {}
                for key, (x, y) in zip(((rate, shift), (-rate, -shift)), parts, strict=True):
                    before = total.get(key, (zero, zero))
                    total[key] = before[0] + x, before[1] + y
            case _:
                pass
        sums[number] = total if total is None or len(total) <= MOST_HARMONICS else None
        linear[number] = form
    return sums[node.number]


# --- series in balls ---


def series(code: Code, time: arb_series) -> list[Any]:
    """The outputs as power series of balls about ``time``, to as many terms as ``ctx.cap`` allows."""
    inputs: dict[str, Any] = {"t": time}
    return code.program.evaluate(code.outputs, inputs, _PowerSeries(inputs))


class _PowerSeries(Balls):
    """``arb_series`` scalars; no finite numbers where a divisor or what has a kink may vanish, as of balls."""

    def number(self, value: Fraction | int) -> Any:
        return arb_series([ball(value)])

    def reciprocal(self, x: Any) -> Any:
        return arb_series([arb.nan()] * ctx.cap) if _coefficient(x, 0).contains(0) else 1 / x

    def function(self, name: str, x: Any) -> Any:
        if name in ("sign", "abs"):  # pivots of constraints hold them
            first = _coefficient(x, 0)
            sign = arb.nan() if first.contains(0) else arb(1 if first > 0 else -1)
            return arb_series([sign]) if name == "sign" else x * sign
        if name in ("sinh", "cosh", "tanh"):
            up, down = x.exp(), (-x).exp()
            sine, cosine = (up - down) / 2, (up + down) / 2
            return sine if name == "sinh" else cosine if name == "cosh" else sine * self.reciprocal(cosine)
        if name in ("exp", "log", "atan"):
            return getattr(x, name)()
        raise NotPeriodic("[[name]] has no power series here", name=name)


def _coefficient(value: arb_series, place: int) -> arb:
    return value[place] if place < value.length() else arb(0)


def _matrices(code: Code, time: arb, size: int, count: int) -> list[arb_mat]:
    """Taylor coefficients J_0 ... J_count-1 of J about every time in a ball."""
    entries = series(code, arb_series([time, arb(1)]))
    return [arb_mat(size, size, [_coefficient(entry, k) for entry in entries]) for k in range(count)]


def enclosed(code: Code, period: arb, size: int, order: int = ORDER) -> tuple[arb_mat, int]:
    """(a matrix of balls that contains Phi(T), how many steps were made), at the present working precision."""
    if size > MOST_STATES:
        text = "coordinates and velocities: [[count]], too many; at most [[most]]"
        raise NotPeriodic(text, count=size, most=MOST_STATES)
    cap, ctx.cap = ctx.cap, order + 2
    try:
        steps = _steps(code, period, size)
        step = period / steps
        total = arb_mat(size, size, [int(i == j) for i in range(size) for j in range(size)])
        for number in range(steps):
            total = _one_step(code, number * step, step, size, order) * total
        return total, steps
    finally:
        ctx.cap = cap


def _steps(code: Code, period: arb, size: int) -> int:
    """So many that |J| h is small on each of them."""
    parts, largest = 8, arb(0)
    for part in range(parts):
        (matrix,) = _matrices(code, (period * part / parts).union(period * (part + 1) / parts), size, 1)
        largest = arb.max(largest, _norm(matrix).upper())
    if not largest.is_finite():
        largest = arb(64)
    fastest = max((abs(frequency) for frequency in _frequencies(code)), default=Fraction(0))
    count = ceil(float((period * arb.max(largest, ball(fastest)) / ball(REACH)).upper()))
    if count > MOST_STEPS:
        raise NotPeriodic(
            "steps that a period would take: [[count]], at most [[most]]: frequencies far apart, or a long period",
            count=count,
            most=MOST_STEPS,
        )
    return max(count, 8)


def _frequencies(code: Code) -> list[Fraction]:
    """Slopes of arguments of sines and cosines that are linear in t alone."""
    program = code.program
    frequencies = []
    for number in program.live(code.outputs):
        operation, operands, _ = program.instructions[number]
        if operation in ("sin", "cos"):
            inner = program.instructions[operands[0]]
            factors = [program.instructions[operand].payload for operand in inner.operands]
            frequencies += (
                [factor for factor in factors if isinstance(factor, Fraction)] if inner.operation == "multiply" else []
            )
    return frequencies


def _norm(matrix: arb_mat) -> arb:
    """The greatest sum of absolute values of a row."""
    rows = [sum((abs(entry) for entry in row), arb(0)) for row in matrix.tolist()]
    total = rows[0]
    for row in rows[1:]:
        total = arb.max(total, row)
    return total


def _one_step(code: Code, start: arb, step: arb, size: int, order: int) -> arb_mat:
    """Phi(start + step, start): the series about the start, and its remainder."""
    identity = arb_mat(size, size, [int(i == j) for i in range(size) for j in range(size)])
    terms = _coefficients(_matrices(code, start, size, order + 1), identity, order)
    total, power = identity, arb(1)
    for term in terms[1:]:
        power = power * step
        total = total + term * power
    return total + remainder(code, start, step, size, order) * (power * step)


def remainder(code: Code, start: arb, step: arb, size: int, order: int) -> arb_mat:
    """Balls that contain the coefficients of order + 1 of Phi about every time of the step (Lagrange)."""
    whole = start.union(start + step)
    jets = _matrices(code, whole, size, order + 1)
    growth = ((_norm(jets[0]) * step).exp() - 1).upper()
    around = arb(0, growth)
    reached = _reached(jets[0])
    near = [arb(int(i == j)) + (around if reached[i, j] else 0) for i in range(size) for j in range(size)]
    enclosure = _coefficients(jets, arb_mat(size, size, near), order + 1)[-1]
    if not all(entry.is_finite() for row in enclosure.tolist() for entry in row):
        raise NotPeriodic("the equations may be singular on the unperturbed motion: no bound over a step was found")
    return enclosure


def _reached(slopes: arb_mat) -> np.ndarray:
    """Where Phi has entries that may differ from those of 1: i, j with a chain of entries of J from j to i."""
    rows = np.array([[not x.is_zero() for x in row] for row in slopes.tolist()])
    reachable, longer = rows, rows @ rows | rows
    while (longer != reachable).any():
        reachable, longer = longer, longer @ longer | longer
    return reachable


def _coefficients(jets: Sequence[arb_mat], first: arb_mat, count: int) -> list[arb_mat]:
    """Phi_0 ... Phi_count of Phi' = J Phi:  (k + 1) Phi_k+1 = sum_i J_i Phi_k-i."""
    coefficients = [first]
    for k in range(count):
        total = jets[0] * coefficients[k]
        for i in range(1, k + 1):
            total = total + jets[i] * coefficients[k - i]
        coefficients.append(total * (arb(1) / (k + 1)))
    return coefficients


# --- multipliers ---


def _multipliers(
    monodromy: arb_mat, lagrangian: bool, keeps_area: Callable[[Sequence[int]], bool]
) -> tuple[tuple[Multiplier, ...], bool]:
    """The multipliers, and whether those of each part that nothing couples with others are simple."""
    parts = _parts(monodromy, "weak")
    balls = [[ball for block in _diagonal_blocks(monodromy, part) for ball in _eigenvalues(block)] for part in parts]
    simple = not any(first.overlaps(other) for own in balls for first, other in combinations(own, 2))
    every = [ball for own in balls for ball in own]
    multipliers: list[Multiplier] = []
    for part, own in zip(parts, balls, strict=True):
        mirrored, fixed = len(part) == 2 and keeps_area(part), _fixed(monodromy, part, keeps_area)
        for place, root in enumerate(own):
            size, alone = abs(root), (mirrored and _alone(own, place)) or place in fixed
            on_circle = size == 1 or alone or (lagrangian and _alone(every, len(multipliers)))
            multipliers.append(Multiplier(root, float(size.lower()), float(size.upper()), on_circle))
    return tuple(sorted(multipliers, key=lambda multiplier: -multiplier.greatest)), simple


def _fixed(monodromy: arb_mat, part: Sequence[int], keeps_area: Callable[[Sequence[int]], bool]) -> set[int]:
    """Places, among the multipliers of a part, of those that are 1 exactly: of single rows whose entry has no mean."""
    members = [group for group in _parts(monodromy, "strong") if group[0] in part]
    places = accumulate((len(group) for group in members), initial=0)
    return {place for place, group in zip(places, members, strict=False) if len(group) == 1 and keeps_area(group)}


def _parts(matrix: arb_mat, connection: str) -> list[list[int]]:
    """Rows by the entries that are not zero exactly: what is connected, whichever way (weak) or both ways (strong)."""
    pattern = csr_array([[int(not entry.is_zero()) for entry in row] for row in matrix.tolist()])
    count, of = connected_components(pattern, connection=connection)
    return [[i for i in range(matrix.nrows()) if of[i] == k] for k in range(count)]


def _diagonal_blocks(matrix: arb_mat, part: Sequence[int]) -> list[acb_mat]:
    """Diagonal blocks of a block triangular form of a part, by the entries that are zero exactly.

    A cyclic coordinate and its rate, z' = v and v' = 0, have a Jordan block of the multiplier 1 for ever, which no
    precision takes apart; as blocks of one row they are exact.
    """
    rows = matrix.tolist()
    members = [group for group in _parts(matrix, "strong") if group[0] in part]
    return [acb_mat([[acb(rows[i][j]) for j in member] for i in member]) for member in members]


def _eigenvalues(block: acb_mat) -> list[acb]:
    """Balls that contain the eigenvalues of a block, as often as these are multiple: from small ones to no more than
    |mu| <= the greatest sum of absolute values in a row, where neither single ones nor clusters are isolated."""
    for multiple in (False, True):
        try:
            return list(block.eig(multiple=multiple))
        except (ValueError, ArithmeticError):
            continue
    radius = max((sum((abs(entry) for entry in row), arb(0)).upper() for row in block.tolist()), key=float)
    around = arb(0, radius)
    return [acb(around, around)] * block.nrows()


def _alone(balls: Sequence[acb], place: int) -> bool:
    """Whether a multiplier is a simple one, and its mirror image 1/conj(mu) can be no other than itself."""
    multiplier = balls[place]
    if multiplier.contains(0):
        return False
    mirrored = 1 / multiplier.conjugate()
    return not any(
        multiplier.overlaps(other) or mirrored.overlaps(other) for k, other in enumerate(balls) if k != place
    )
