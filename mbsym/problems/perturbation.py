"""Self-check of problem 5 (and 7) by disturbing the independent derivation.

Both routes of problem 5 share the unperturbed values, the split into five matrices and the passage to the user's
notation.  Here d'Alembert's principle in inertial axes is evaluated at the unperturbed state with a small disturbance
(dx, dx', dx'') carried along as the first coefficient of a series; what comes out must be

    M dx'' + (D + G) dx' + (K + N) dx - B dv

with M, D, K symmetric and G, N skew, dv a disturbance of the inputs, and the subsystems' matrices, their notation and
time scale undone, must be blocks of these.  First integrals are differentiated along the motion that the straight-line
program gives.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from flint import arb, fmpq

from mbsym.algebra.base import Algebra, Lowering, Scalar
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.point import Balls, Rationals
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message
from mbsym.expressions.tree import ZERO, Expression, add
from mbsym.mechanics.motion import in_step
from mbsym.mechanics.oracle import Oracle, State
from mbsym.mechanics.programs import Programs, accelerated
from mbsym.mechanics.speed_states import in_time
from mbsym.mechanics.states import SEED, Oracles, drawn
from mbsym.mechanics.variables import ring_environment, time_derivative
from mbsym.model.system import System, acceleration_name, velocity_name
from mbsym.problems.checks import Check, Pair, compare
from mbsym.problems.integrals import Integral
from mbsym.problems.linearisation import Linearisation

#: Rates of the motion by coordinates.
Rates = Mapping[str, Polynomial]
NONE: Rates = {}

#: Integrals longer than this are left to their proof.
MOST_TERMS = 3000


@dataclass(frozen=True)
class Dependent:
    """Values of dependent names in independent parameters: relations, solved conditions, the user's notation."""

    parameters: Mapping[str, Polynomial]
    notation: Mapping[str, Polynomial]


def matrix_pairs(
    ring: Ring,
    linear: Linearisation,
    dependent: Dependent,
    state: State,
    direction: Sequence[Sequence[Scalar]],
    pushes: Sequence[Scalar],
    residuals: Mapping[str, Scalar],
) -> list[Pair]:
    """The matrices times a disturbance against the ``residuals`` that it causes, symmetries, and the subsystems."""
    carry = Carrier(ring, state.numbers, state.values)
    matrices = [[[carry(x) for x in row] for row in m.polynomials] for m in linear.matrices]
    gains = [] if linear.B is None else [[carry(x) for x in row] for row in linear.B.polynomials]
    pairs: list[Pair] = []
    mass, damping, gyroscopic, stiffness, circulatory = matrices
    n = len(linear.coordinates)
    for i, name in enumerate(linear.coordinates):
        total = state.numbers.zero
        for j, (shift, speed, push) in enumerate(direction):
            total = total + mass[i][j] * push + (damping[i][j] + gyroscopic[i][j]) * speed
            total = total + (stiffness[i][j] + circulatory[i][j]) * shift
        for k, push in enumerate(pushes):
            total = total - gains[i][k] * push
        pairs.append((Message("equation [[name]]", name=name), total, residuals[name]))
    for symbol, matrix in zip("MDGKN", matrices, strict=True):
        for i in range(n):
            for j in range(i + 1):
                mirrored = -matrix[j][i] if symbol in "GN" else matrix[j][i]
                pairs.append((Message("symmetry of [[symbol]]", symbol=symbol), matrix[i][j], mirrored))
    return pairs + _blocks(ring, linear, dependent, state, matrices)


def _blocks(ring: Ring, linear: Linearisation, dependent: Dependent, state: State, whole: Sequence[Any]) -> list[Pair]:
    """Entries of the subsystems, notation and time scale undone, against those of the whole."""
    carry = Carrier(ring, state.numbers, state.values)
    symbols = {name: carry(value) for name, value in dependent.notation.items()}
    carry = Carrier(ring, state.numbers, {**state.values, **symbols})
    scale = state.numbers.one if linear.time_scale is None else carry(linear.time_scale.polynomial)
    powers = (state.numbers.one, scale, scale, scale * scale, scale * scale)
    blocks: list[Pair] = []
    for part in linear.subsystems:
        places = [linear.coordinates.index(name) for name in part.coordinates]
        own = (part.M, part.D, part.G, part.K, part.N)
        for symbol, block, matrix, power in zip("MDGKN", own, whole, powers, strict=True):
            for i, a in enumerate(places):
                for j, b in enumerate(places):
                    value = carry(block[i, j].polynomial) * power
                    blocks.append(
                        (
                            Message(
                                "[[symbol]] of subsystem [[coordinates]]",
                                symbol=symbol,
                                coordinates=", ".join(part.coordinates),
                            ),
                            value,
                            matrix[a][b],
                        )
                    )
    return blocks


def _given_motion(system: System) -> dict[str, tuple[Expression, Expression]]:
    """(value, rate) of every coordinate, read from the description once more."""
    motion: dict[str, tuple[Expression, Expression]] = dict.fromkeys(system.coordinates, (ZERO, ZERO))
    return motion | {entry.coordinate: (entry.value, entry.rate) for entry in system.motion}


def has_rational_states(system: System, ring: Ring, dependent: Dependent, rates: Rates = NONE) -> bool:
    """Whether all sines can be rational: no coordinate rests elsewhere, no angle is determined by others.

    ``rates`` of the motion are those that the description does not name.
    """
    if in_step(ring, {**_rates(system, ring, dependent), **rates}):
        return False
    at_zero = all(value == ZERO for value, _ in _given_motion(system).values())
    at_zero = at_zero and not any(system_input.name in ring.angles for system_input in system.inputs)
    return at_zero and not dependent.parameters.keys() & ring.angles.keys()


def _rates(system: System, ring: Ring, dependent: Dependent) -> dict[str, Polynomial]:
    """The given rates, of what is prescribed, too.

    Zero is zero, however that is written (-0, w - w, a parameter that is related to 0).
    """
    lower = Lowering(ring, ring_environment(system, ring))
    images = {ring.index("parameter", name): value for name, value in dependent.parameters.items()}
    expressions = {name: rate for name, (_, rate) in _given_motion(system).items()}
    expressions |= {prescribed.name: prescribed.rate for prescribed in system.prescribed}
    return {name: ring.substitute(lower(rate), images) for name, rate in expressions.items()}


def unperturbed_state(system: System, ring: Ring, dependent: Dependent, balls: bool, turning: Rates = NONE) -> State:
    """The motion at random values of the parameters; ``turning`` are rates that it does not name."""
    source = random.Random(SEED)
    kind: Any = arb if balls else fmpq
    values: dict[str, Scalar] = {name: kind(value) for name, value in drawn(system, ring, source).items()}
    values["pi"] = arb.pi() if balls else fmpq(355, 113)
    motion = _given_motion(system)
    tangents = {name: fmpq(source.randint(1, 9), source.randint(1, 9)) for name in ring.angles}
    rates = _rates(system, ring, dependent)
    at_rest = [name for name in system.coordinates if rates[name].is_zero() and name not in turning]
    numbers: Algebra
    if balls:
        numbers = Balls(values)  # reads the values below as they are filled in
    else:
        numbers = Rationals(tangents | {name: fmpq(0) for name in at_rest if name in tangents}, ring.angles)
    carry = Carrier(ring, numbers, dict(values))
    values |= {name: carry(value) for name, value in dependent.parameters.items()}
    lower = Lowering(numbers, dict(values))
    values |= {system_input.name: lower(system_input.held) for system_input in system.inputs}
    running = {item.name: (item.initial or ZERO, item.rate) for item in system.of_constant_rate}
    running |= {name: motion[name] for name in system.coordinates if not rates[name].is_zero()}
    for name, (value, rate) in running.items():  # sines and cosines of rational states are any, whatever the time
        values[name] = lower(value) + lower(rate) * values["t"]
    for name, x in turning.items():
        if not ring.dependencies(x, system.coordinates):  # else the motion is not steady, and any place is as good
            values[name] = lower(motion[name][0]) + carry(x) * values["t"]
    for name, (value, rate) in motion.items():
        if name in at_rest:
            values[name] = lower(value)
        speed = time_derivative(value, system)
        values[velocity_name(name)] = lower(add(rate, speed))
        values[acceleration_name(name)] = lower(time_derivative(speed, system))
    return State(numbers, values)


def check_integrals(truth: Oracles, programs: Programs, first_integrals: Sequence[Integral]) -> Check:
    """dI/dt along the motion, by series in time with the accelerations of the straight-line program."""
    short = [item for item in first_integrals if item.formula.terms <= MOST_TERMS]

    def pairs(oracle: Oracle) -> list[Pair]:
        state = accelerated(truth.system, oracle.state, programs)
        carry = in_time(truth.ring, Oracle(truth.system, state))
        return [(item.name, carry(item.formula.polynomial).b, state.numbers.zero) for item in short]

    return compare(truth, "first integrals", ("dI/dt along the motion", "zero"), pairs, states=1)
