"""What a run keeps constant, how that is known, and how far the run itself agrees.

    dh/dt = sum_i q'_i Q_i - dL/dt (explicit)              generalised energy (``mbsym.mechanics.energy``)
    dI/dt = dI/dt(explicit) + dI/dq . q' + dI/dq' . q''    any other quantity

A rate that vanishes identically in the ring is a proof.  Else it is looked at in balls of many bits at states that the
run visits, among them those between which the quantity changes most: one ball without zero in it, and the quantity is
not conserved; where all of them hold zero it is verified numerically along this run, unless the run changes it.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from fractions import Fraction
from itertools import pairwise
from random import Random
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import arb, ctx

from mbsym.algebra import rationals
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.derivative import gradient
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import Failure
from mbsym.algebra.program import Node
from mbsym.mechanics.energy_rate import EnergyRate
from mbsym.mechanics.variables import ring_environment, ring_of
from mbsym.model.quantities import integral_unit
from mbsym.model.states import described
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels import arrays
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.kernels.llvm import kernels
from mbsym.numerics.kernels.precise import enclosures
from mbsym.numerics.methods.magnitudes import about
from mbsym.numerics.scenario import PRECISION

if TYPE_CHECKING:
    from mbsym.problems.integrals import Integral

#: Bits of the balls, and what counts as zero beside the terms that cancel.
BITS = 256
NOTHING = arb(2) ** -120

#: Visited states looked at: those at the largest changes, as many evenly along the run, and some beside the start.
LARGEST_CHANGES, EVENLY, BESIDE = 4, 4, 2

#: So many states between switches that no row lies between.
MOST_BETWEEN = 8

#: A run that changes a quantity by more than this part of its scale contradicts whatever states have said.
CONTRADICTION = 1e-3

#: A rate on constraints, in parts of its terms: beyond the first it is one, up to the second it is none.
SEEN, UNSEEN = 1e-6, 1e-10

#: States of a run at which it is looked how errors sway an energy.
LOOKED_AT = 200

#: Steps of polynomial arithmetic that a proof may cost.
PROOF_STEPS = 1_000_000


class Standing(StrEnum):
    """How far it is known that a quantity is constant along the motion."""

    PROVED = "proved"
    VERIFIED = "verified numerically along this run"
    CHANGING = "not conserved"
    UNDECIDED = "undecided"

    @property
    def conserved(self) -> bool | None:
        """True or False where that is known, None where it is not."""
        return None if self is Standing.UNDECIDED else self is not Standing.CHANGING


class Doubt(StrEnum):
    """Why nothing is decided."""

    CONTRADICTED = "its rate vanishes at the states looked at, and yet the run changes it"
    NOT_FINITE = "its rate has no value, or no narrow enclosure, at the states looked at"
    TINY = "its rate is tiny beside its terms, but larger than roundings"
    NO_VALUES = "it has no finite value along this run"
    NO_MOTION = "the run ends where it begins"


class Measure(StrEnum):
    """What a ``scale`` is."""

    KINETIC = "the largest kinetic energy"
    INITIAL = "its value at first"
    UNIT = "its unit"
    TERMS = "the size of its terms"


@dataclass(frozen=True)
class Conservation:
    """Whether ``quantity`` is conserved, and ``change``: the largest |I(t) - I(0)| of the run over ``scale``."""

    quantity: str
    standing: Standing
    change: float
    scale: float
    doubt: Doubt | None = None
    measure: Measure = Measure.KINETIC

    @property
    def broken(self) -> bool:
        """The quantity is constant, and the run does not keep it: its numbers are wrong there."""
        return self.standing is Standing.PROVED and not self.change <= CONTRADICTION


def confronted(
    quantity: str,
    standing: Standing,
    values: Any,
    scale: float,
    doubt: Doubt | None = None,
    measure: Measure = Measure.KINETIC,
) -> Conservation:
    """A standing held against the values along the run: nothing that is not proved stands against them."""
    if not len(values) or not np.all(np.isfinite(np.asarray(values, dtype=float))):
        return Conservation(quantity, Standing.UNDECIDED, float("nan"), scale, Doubt.NO_VALUES, measure)
    change = float(np.max(np.abs(values - values[0]))) / scale
    doubt = doubt if standing is Standing.UNDECIDED else None
    conservation = Conservation(quantity, standing, change, scale, doubt, measure)
    if standing is Standing.VERIFIED and len(values) < 2:
        return replace(conservation, standing=Standing.UNDECIDED, doubt=Doubt.NO_MOTION)
    if standing is Standing.VERIFIED and not change <= CONTRADICTION:
        return replace(conservation, standing=Standing.UNDECIDED, doubt=Doubt.CONTRADICTED)
    return conservation


def swayed(code: Code, place: int, points: Any, errors: Sequence[float]) -> float:
    """What errors e (d,) of a state make at most of an output I of code along a run:  max sum_i |I(x + e_i) - I(x)|.

    ``points`` are (t, x) in columns (1 + d, m), of which ``LOOKED_AT`` are looked at.
    """
    chosen = np.unique(np.linspace(0, points.shape[1] - 1, LOOKED_AT).astype(int))
    here = np.asarray(points, dtype=float)[:, chosen]
    value = arrays.kernel(Code(code.program, code.inputs, (code.outputs[place],)))
    with np.errstate(all="ignore"):
        known, total = value(here)[0], np.zeros(len(chosen))
        for k, error in enumerate(errors, start=1):
            beside = here.copy()
            beside[k] += error
            total += np.abs(value(beside)[0] - known)
    return float(np.max(total[np.isfinite(total)], initial=0.0))


# --- rates ---


def energy_standing(
    dynamics: Dynamics, points: Any, worth: float = 0.0, held: Collection[str] = (), near: Any = ()
) -> tuple[Standing, Doubt | None]:
    """Whether T2 - T0 - U is conserved; ``points`` are (t, q, q') of visited states, in columns; ``near`` of others.

    ``held`` are the coordinates that provably rest in this motion: nothing is said about motions in which they do not.

    A power is zero where its ball holds zero and is narrow beside its terms, or beside ``worth`` (an energy over the
    time of the run).  The balls are of the formula itself, so one without zero is a power, however small.
    """
    rate = dynamics.energy_rate
    if dynamics.in_states:
        proved = dynamics.is_scleronomic and (not rate.terms or _vanishes(dynamics, rate))
        return (Standing.PROVED, None) if proved else standing(dynamics, dynamics.relative_energy, 0, points, (), near)
    if not dynamics.is_scleronomic:
        return on_constraints(dynamics, [*dynamics.energy_power.outputs, *dynamics.constraint_power.outputs], points)
    if not rate.terms or not dynamics.energy_power.outputs or _vanishes(dynamics, rate):
        return Standing.PROVED, None
    if dynamics.constraints is not None:
        return on_constraints(dynamics, dynamics.energy_power.outputs, points)
    return judged(
        dynamics, lambda state: _power(dynamics, rate, state), points, worth, rounded=False, held=held, near=near
    )


def _power(dynamics: Dynamics, rate: EnergyRate, state: Sequence[float]) -> list[arb]:
    """The terms of dh/dt at (t, q, q'), from the parameters themselves: as balls, where their values are rounded."""
    scenario = dynamics.scenario
    balls = {name: _ball(value) for name, value in scenario.parameters.items()} | {"pi": arb.pi()}
    for name, (initial, speed) in scenario.prescribed.items():
        balls[name] = _ball(initial) + _ball(speed) * arb(state[0])
    balls |= dict(zip(dynamics.inputs, map(arb, state), strict=True))
    return enclosures(Code(rate.program, tuple(balls), rate.terms), tuple(balls.values()), BITS)


def _ball(value: Fraction) -> arb:
    """A value; with its rounding, where it looks rounded."""
    middle = rationals.ball(value)
    rounded = value.denominator.bit_length() >= PRECISION // 2
    return arb(middle.mid(), (abs(middle) * arb(2) ** (2 - PRECISION)).upper()) if rounded else middle


def _vanishes(dynamics: Dynamics, rate: EnergyRate) -> bool:
    """Whether dh/dt is zero in the ring, for all values of the parameters."""
    system = described(dynamics.system).without_speeds
    ring = ring_of(system)
    ring.limit_work(PROOF_STEPS)
    try:
        terms = rate.program.evaluate(rate.terms, ring_environment(system, ring), ring)
        return ring.is_zero(ring.reduce(sum(terms, ring.zero))) is True
    except Failure:
        return False


def standing(
    dynamics: Dynamics, code: Code, output: int, points: Any, held: Collection[str] = (), near: Any = ()
) -> tuple[Standing, Doubt | None]:
    """Whether one output of a code over (t, q, q') is constant along the motion, in which ``held`` provably rest."""
    rhs = dynamics.right_hand_side
    program = code.program
    slopes = gradient(program, code.outputs[output], [program.input(name) for name in dynamics.inputs])
    moving = zip(slopes[1:], rhs.outputs, strict=True)
    terms = [slopes[0], *(program.product(slope, rate) for slope, rate in moving)]
    if dynamics.constraints is not None:
        return on_constraints(dynamics, terms, points)
    whole, exactly = Code(program, dynamics.inputs, tuple(terms)), dynamics.exactly
    return judged(
        dynamics, lambda state: enclosures(whole, exactly(state), BITS), points, 0.0, rounded=True, held=held, near=near
    )


def on_constraints(dynamics: Dynamics, terms: Sequence[Node], points: Any) -> tuple[Standing, Doubt | None]:
    """Whether the sum of the terms vanishes at states of a run, which are on the constraints but for roundings.

    Beside them, where balls would look, such a sum need not vanish: it is held against the size of its terms instead.
    """
    program = dynamics.right_hand_side.program
    with np.errstate(all="ignore"):
        parts = arrays.kernel(Code(program, dynamics.inputs, tuple(terms)))(np.asarray(points, dtype=float))
    if not np.all(np.isfinite(parts)):
        return Standing.UNDECIDED, Doubt.NOT_FINITE
    rate, size = float(np.max(np.abs(np.sum(parts, axis=0)))), float(np.max(np.sum(np.abs(parts), axis=0)))
    if rate > SEEN * size:
        return Standing.CHANGING, None
    return (Standing.VERIFIED, None) if rate <= UNSEEN * size else (Standing.UNDECIDED, Doubt.TINY)


def judged(
    dynamics: Dynamics,
    terms: Callable[[Sequence[float]], list[arb]],
    points: Any,
    worth: float,
    rounded: bool,
    held: Collection[str] = (),
    near: Any = (),
) -> tuple[Standing, Doubt | None]:
    """Whether the sum of the terms vanishes at visited states, at those ``near`` them and some beside the start, in
    balls.

    ``rounded``: the terms hold rounded constants, which explain a sum that is tiny beside them.
    """
    seen = [[float(x) for x in state] for state in np.asarray(points, dtype=float).T]
    decided = 0
    for place, state in enumerate(
        [*seen, *(list(map(float, neighbour)) for neighbour in near), *_beside(dynamics, held)]
    ):
        with ctx.workprec(BITS):
            parts = terms(state)
            if not all(term.is_finite() for term in parts):
                continue
            total, size = sum(parts, arb(0)), sum((abs(term) for term in parts), arb(0))
            if not total.contains(0):
                if not rounded or abs(total) > NOTHING * size:
                    return Standing.CHANGING, None
                vanishes = True
            else:
                vanishes = size.is_zero() or bool(total.rad() <= NOTHING * max(size.upper(), arb(worth)))
            decided += vanishes and place < len(seen)
    enough = decided >= min(EVENLY, len(seen))
    return (Standing.VERIFIED, None) if enough else (Standing.UNDECIDED, Doubt.NOT_FINITE)


def _beside(dynamics: Dynamics, held: Collection[str]) -> list[list[float]]:
    """States near the initial one: dyadic numbers, so that lengths stay lengths and roots stay real; ``held`` rest."""
    random = Random(1)
    start = [float(x) for x in dynamics.scenario.state]
    sizes = 2.0 ** np.floor(np.log2(about(dynamics, 0.0, start).sizes[:, 0]))
    names = dynamics.system.coordinates
    free = [True] * len(start) if dynamics.in_states else [name not in held for name in names] * 2
    neighbours = []
    for _ in range(BESIDE):
        time, *parts = random.randint(0, 1024) / 256, *(random.randint(-64, 64) / 256 for _ in start)
        moved = [x + part * (size + abs(x)) * k for x, part, size, k in zip(start, parts, sizes, free, strict=True)]
        neighbours.append([time, *moved])
    return neighbours


def between_switches(
    times: Any, states: Any, switches: Sequence[float], inside: Sequence[tuple[float, Any]]
) -> list[list[float]]:
    """(t, q, q') between switches that follow each other within one distance of rows: what acts there alone is seen in
    no row.  The states lie on straight lines between those of the rows, beside the motion.

    A straight line need not lead to where the motion was (into a wall that it bounces off): there are also the states
    ``inside`` steps on each side of the switches, in which what is not known of them is as in the rows.
    """
    rows = np.asarray(states, dtype=float)
    points: list[list[float]] = []
    for time, state in inside:
        if times[0] <= time <= times[-1]:
            beside = [float(np.interp(time, times, row)) for row in rows]
            points.append([time, *(b if np.isnan(x) else float(x) for x, b in zip(state, beside, strict=True))])
    for earlier, later in pairwise(switches):
        row = int(np.searchsorted(times, earlier))
        if 0 < row < len(times) and later <= times[row] and len(points) < MOST_BETWEEN + len(inside):
            middle = 0.5 * (earlier + later)
            share = (middle - times[row - 1]) / (times[row] - times[row - 1])
            state = np.asarray(states[:, row - 1], float) * (1 - share) + np.asarray(states[:, row], float) * share
            points.append([float(middle), *map(float, state)])
    return points


def visited(times: Any, states: Any, values: Any) -> Any:
    """(t, q, q') in columns: states of a run at which a quantity changes most, and others evenly along it."""
    count = len(times)
    places = set(np.linspace(0, count - 1, min(EVENLY, count)).astype(int).tolist())
    with np.errstate(all="ignore"):
        steps = np.abs(np.diff(np.asarray(values, dtype=float)))
    steps = np.where(np.isfinite(steps), steps, 0.0)
    largest: Sequence[int] = np.argsort(-steps, kind="stable")[:LARGEST_CHANGES].tolist()
    places |= {place + side for place in largest for side in (0, 1)}
    chosen = sorted(places)
    return np.vstack([times, np.asarray(states, dtype=float)])[:, chosen]


# First integrals of problem 7 along a trajectory: their values, and by what their changes are measured.


@dataclass(frozen=True)
class Invariant:
    """A first integral of problem 7 as a code over (t, q, q'): the integral I, then dI/dq' . q' part by part.

    The parts say how large a change counts as one: an integral that is zero is the difference of large terms.
    ``unit`` is None where it is not known.
    """

    name: str
    column: str
    proved: bool
    code: Code
    unit: str | None = None


def invariants(dynamics: Dynamics, integrals: Sequence[Integral], known: Sequence[str] = ()) -> tuple[Invariant, ...]:
    """First integrals with the scenario's numbers put in; those without numbers there are left out.

    ``known`` are column names that are taken.
    """
    if not integrals:
        return ()
    from mbsym.problems.integrals import identifiers

    program = dynamics.right_hand_side.program
    system, ring = dynamics.system, dynamics.ring
    declared = [*system.parameter_names, *(item.name for item in system.prescribed), *dynamics.inputs, "pi"]
    environment = {name: program.input(name) for name in declared}
    numeric: list[Invariant] = []
    taken = set(known)
    for integral in integrals:
        try:
            node = Carrier(ring, program, environment)(integral.formula.polynomial)
        except Failure:
            continue
        (column,) = identifiers([integral], taken)
        taken.add(column)
        velocities = [program.input(name) for name in system.velocities]
        slopes = gradient(program, node, velocities)
        parts = (program.product(slope, velocity) for slope, velocity in zip(slopes, velocities, strict=True))
        code = Code(program, dynamics.inputs, (node, *parts))
        unit = integral_unit(system, integral.kind, integral.of)
        numeric.append(Invariant(integral.name, column, integral.status is Certainty.PROVED, code, unit))
    return tuple(numeric)


def along(known: Sequence[Invariant]) -> Callable[[Any], dict[str, Any]]:
    """Of (t, q, q') in columns the values of first integrals, by the names of their columns."""
    compiled = kernels({item.column: item.code for item in known})
    return lambda points: {name: kernel(np.asarray(points, dtype=float))[0] for name, kernel in compiled.items()}


def values(known: Sequence[Invariant], times: Any, states: Any) -> list[tuple[Any, float]]:
    """(I along a trajectory, what its changes are measured by): the largest sum of the sizes of its parts."""
    if not known:
        return []
    compiled = kernels({f"f{i}": item.code for i, item in enumerate(known)})
    points = np.vstack([times, np.asarray(states, dtype=float)])
    histories = []
    for i in range(len(known)):
        rows = compiled[f"f{i}"](points)
        size = float(np.max(np.sum(np.abs(rows[1:]), axis=0))) or float(np.max(np.abs(rows[0]))) or 1.0
        histories.append((rows[0], size))
    return histories
