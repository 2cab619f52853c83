"""Which operations of a kernel lose digits that another way of computing keeps, and whether it pays.

An operation k with value v_k is rounded by a relative u; that moves output i by at most

    c_ik = u |df_i/dv_k v_k|,     in parts of s_i = max(|f_i|, 1e-3 of its largest at the states looked at)

(one reverse sweep over the program for all outputs, with values of 300 bits).  Operations with c_ik beyond
``SENSITIVE`` are carried as pairs (``mbsym.algebra.compensated``).  That is kept where it is measured to be better:
both kernels against balls of 300 bits, at the initial state and at others about it.

Most scenes lose nothing: balls of as many bits as a float64 has see that first.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import cos, inf, isfinite, log10, sin
from typing import Any

import numpy as np
from flint import ctx

from mbsym.algebra import rationals
from mbsym.algebra.compensated import compensated
from mbsym.algebra.failures import Failure
from mbsym.algebra.point import Balls
from mbsym.algebra.program import Program
from mbsym.mechanics.variables import angle_denominators
from mbsym.model.states import InStates
from mbsym.model.system import velocity_name
from mbsym.numerics.kernels.arrays import stepwise
from mbsym.numerics.kernels.interface import FLOAT64, Code, place_of, value_of
from mbsym.numerics.scenario import Scenario

#: The unit roundoff of float64, and digits of it.
UNIT, FULL = 2.0**-53, 15.95

#: Parts of an output that a loss may be before it is looked at (a bound), and an operation's share that makes it
#: sensitive.
WORTH_LOOKING, SENSITIVE = 1e-9, 2e-14

#: An output is measured by itself, but at least by this part of its largest value at the states.
SMALL = 1e-3

#: A kernel that keeps so many digits is good enough; otherwise so many have to be gained.
ENOUGH, GAIN = 11.0, 1.0

#: Longer programs are not looked at, nor those with other operations than these.
MOST_OPERATIONS = 30_000
CARRIED = {"input", "constant", "add", "subtract", "negative", "multiply", "divide", "sqrt", "sin", "cos"}

BITS = 300


@dataclass(frozen=True)
class Compensation:
    """A kernel with some operations in pairs: what it keeps and costs, against the plain one.

    ``before`` and ``after`` are the fewest digits of any output at the states looked at, ``sensitive`` counts
    operations, ``cost`` is the ratio of operations.
    """

    code: Code
    before: float
    after: float
    sensitive: int
    cost: float


def states_about(scenario: Scenario, inputs: Sequence[str]) -> list[list[float]] | None:
    """Values of the inputs (t, q, q') at the start and at two places about it, where everything moves.

    Positions are shifted by parts of a radian or of themselves, velocities by parts of the largest there is.
    None for inputs that a scenario does not have.
    """
    system = scenario.system
    if isinstance(system, InStates):
        return None
    state = map(float, (*scenario.positions, *scenario.velocities))
    start = dict(zip((*system.coordinates, *system.velocities), state, strict=True)) | {"t": 0.0}
    start |= {name: value_of(name) for name in inputs if place_of(name) is not None}
    if any(name not in start for name in inputs):
        return None
    angles = angle_denominators(system)
    fastest = max((abs(float(x)) for x in scenario.velocities), default=0.0)
    rate = fastest or max((abs(float(x)) for _, x in scenario.prescribed.values()), default=0.0) or 1.0
    states = []
    for turn in (0, 1, 2):
        moved = dict(start)
        for k, name in enumerate(system.coordinates):
            size = 1.0 if name in angles else abs(start[name]) or 1.0
            part = 0.61 * turn * (1 + 0.37 * k)
            moved[name] += size * part
            moved[velocity_name(name)] += size * rate * part * 0.7
        states.append([moved[name] for name in inputs])
    return states


def compensation(code: Code, states: Sequence[Sequence[float]], outputs: Sequence[int]) -> Compensation | None:
    """A better kernel for a code, judged by its ``outputs``; None where there is nothing to gain."""
    program = code.program
    live = program.live(code.outputs)
    if len(live) > MOST_OPERATIONS:
        return None
    output_numbers = [code.outputs[i].number for i in outputs]
    if any(program.instructions[number].operation not in CARRIED for number in live):
        return None
    try:
        if _bounded([_values(code, live, state, 53) for state in states], output_numbers):
            return None
        looked = [_values(code, live, state) for state in states]
    except Failure:
        return None
    values = [known for known in looked if known is not None]
    if not values:
        return None
    chosen = _sensitive(program, live, values, output_numbers)
    if not chosen:
        return None
    better = Code(program, code.inputs, tuple(compensated(program, code.outputs, chosen)))
    usable = [state for state, known in zip(states, looked, strict=True) if known is not None]
    before, after = (_digits(candidate, usable, values, output_numbers, outputs) for candidate in (code, better))
    if before >= ENOUGH or after < before + GAIN:
        return None
    return Compensation(better, before, after, len(chosen), better.operations / max(1, code.operations))


def compensated_code(scenario: Scenario, code: Code, outputs: Sequence[int]) -> Compensation | None:
    """``compensation`` at the states about a scenario's start."""
    states = states_about(scenario, code.inputs)
    return None if states is None else compensation(code, states, outputs)


def _bounded(looked: Sequence[Mapping[int, Any] | None], output_numbers: Sequence[int]) -> bool:
    """Whether balls show every output to keep its digits at all states."""
    for k in output_numbers:
        balls = [known[k] for known in looked if known is not None]
        sizes = [abs(float(x.mid())) for x in balls]
        least = SMALL * max(sizes, default=0.0)
        wide = (float(x.rad()) > WORTH_LOOKING * max(size, least) for x, size in zip(balls, sizes, strict=True))
        if len(balls) < len(looked) or any(wide):
            return False
    return True


def _values(code: Code, live: Sequence[int], state: Sequence[float], bits: int = BITS) -> dict[int, Any] | None:
    """Every instruction's value as a ball; None where one is not finite."""
    program = code.program
    with ctx.workprec(bits):
        inputs = {name: _ball(x) for name, x in zip(code.inputs, state, strict=True)}
        nodes = [program.node(number) for number in live]
        balls = program.evaluate(nodes, inputs, Balls(inputs))
        if not all(x.is_finite() for x in balls):
            return None
        return dict(zip(live, balls, strict=True))


def _ball(x: float) -> Any:
    exact = Fraction(x)
    return rationals.ball(exact)


def _sensitive(
    program: Program, live: Sequence[int], values: Sequence[Mapping[int, Any]], output_numbers: Sequence[int]
) -> set[int]:
    """Operations whose rounding moves an output by more than ``SENSITIVE`` parts of its size."""
    chosen: set[int] = set()
    floats = [{number: float(x.mid()) for number, x in known.items()} for known in values]
    largest = {output: max(abs(known[output]) for known in floats) for output in output_numbers}
    moved = [output for output in dict.fromkeys(output_numbers) if largest[output] > 0]
    for known in floats:
        allowed = SENSITIVE * np.array([max(abs(known[output]), SMALL * largest[output]) for output in moved])
        for number, slopes in _slopes(program, live, known, moved):
            if number not in chosen and (UNIT * np.abs(slopes * known[number]) > allowed).any():
                chosen.add(number)
    return {number for number in chosen if program.instructions[number].operation not in ("input", "negative")}


def _slopes(
    program: Program, live: Sequence[int], v: Mapping[int, float], outputs: Sequence[int]
) -> Iterator[tuple[int, Any]]:
    """df/dv_k of all outputs, an array for every instruction that any depends on, in one way backwards."""
    own = {output: place for place, output in enumerate(outputs)}
    adjoints: dict[int, Any] = {}
    with np.errstate(all="ignore"):
        for number in reversed(live):
            slopes = adjoints.pop(number, None)
            if number in own:
                slopes = np.zeros(len(outputs)) if slopes is None else slopes
                slopes[own[number]] += 1.0
            if slopes is None:
                continue
            yield number, slopes
            operation, operands, _ = program.instructions[number]
            for operand, inner in zip(operands, _partials(operation, [v[k] for k in operands], v[number]), strict=True):
                part = slopes * inner if isfinite(inner) else np.where(slopes, slopes * inner, 0.0)
                adjoints[operand] = adjoints[operand] + part if operand in adjoints else part


def _partials(operation: str, x: Sequence[float], value: float) -> tuple[float, ...]:
    match operation:
        case "add":
            return (1.0, 1.0)
        case "subtract":
            return (1.0, -1.0)
        case "negative":
            return (-1.0,)
        case "multiply":
            return (x[1], x[0])
        case "divide":
            return (1 / x[1], -value / x[1]) if x[1] else (0.0, 0.0)
        case "sqrt":
            return (0.5 / value if value else 0.0,)
        case "sin":
            return (cos(x[0]),)
        case "cos":
            return (-sin(x[0]),)
    return tuple(0.0 for _ in x)  # functions are not carried further


def _digits(
    code: Code,
    states: Sequence[Sequence[float]],
    values: Sequence[Mapping[int, Any]],
    output_numbers: Sequence[int],
    outputs: Sequence[int],
) -> float:
    """The fewest digits of any output at any of the states."""
    run, fewest = stepwise(code, FLOAT64), FULL
    largest = {k: max(abs(float(known[k].mid())) for known in values) for k in output_numbers}
    for state, known in zip(states, values, strict=True):
        with np.errstate(all="ignore"):
            computed = np.asarray(run(np.array(state)), dtype=float)
        for i, k in zip(outputs, output_numbers, strict=True):
            size = max(abs(float(known[k].mid())), SMALL * largest[k])
            error = _apart(float(computed[i]), known[k]) / size if size > 0 else 0.0
            fewest = min(fewest, -log10(error) if 0 < error < inf else (FULL if error == 0 else 0.0))
    return max(0.0, fewest)


def _apart(value: float, exact: Any) -> float:
    if not isfinite(value):
        return inf
    with ctx.workprec(BITS):
        return float(abs(_ball(value) - exact).mid())
