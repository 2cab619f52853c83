"""A model at its extremes: how many digits each quantity keeps, where it breaks down, and why.

Ladders of states and parameters (``probes``, ``borders``) times quantities (``digits``): every rung is evaluated by the
compiled kernels in float32 and float64 and by rigorous balls, with the condition of the question beside it.  What is
said in sentences follows from the rows and from nothing else.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

import numpy as np

from mbsym.algebra.failures import Failure, message_of
from mbsym.algebra.program import Program
from mbsym.algebra.ring import Ring
from mbsym.analysis import Analysis
from mbsym.expressions.message import Message
from mbsym.expressions.tree import Expression
from mbsym.mechanics.constraints.dynamics import ConstrainedDynamics, constrained_dynamics
from mbsym.mechanics.falling import falling_frames
from mbsym.mechanics.newton_euler import residuals
from mbsym.mechanics.programs import scene_without_accelerations
from mbsym.model.system import System
from mbsym.numerics.borders import BORDER, Judged, LinearModel
from mbsym.numerics.closing import closed
from mbsym.numerics.compensation import Compensation
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.extremes.singular import RANGE, Singularities, SingularSet, singularities
from mbsym.numerics.extremes.singular_positions import SingularPosition, SingularPositions, singular_positions
from mbsym.numerics.kernels import arrays
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.probes import DISTANCES, RATIO, SINGULAR, Ladder, Probe, SceneUnits, ladders, scene_units
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.trade.digits import Arithmetic, Digits, Quantity, Truth, Watch, measured, quantities

# Extremes of systems with constraints: equations with their rows, and states that satisfy them all.
#
# A rung is led to the constraints by the shortest way (``mbsym.numerics.closing``): after lengths were changed loops
# are closed anew, after velocities were changed they satisfy J q' + j = 0.  A rung that no state of the constraints is
# near to is left out, and told.


#: Directions in which a singular position is left, until one leads along the constraints; how far a rung may be from
#: where it was meant, as a factor.
DIRECTIONS, ABOUT = 12, 4.0

#: Of the positions that were found so many are approached, down to this distance.
MOST_APPROACHED, LEAST = 3, 1e-8


def equations(scenario: Scenario, ring: Ring) -> ConstrainedDynamics | None:
    """The equations with the rows of the scenario's branch; None without constraints."""
    known = Dynamics(scenario, ring).constraints
    return None if known is None else constrained_dynamics(scenario.system, ring, known.chosen)


def on_constraints(ladder: Ladder, left_out: list[str]) -> Ladder | None:
    """The ladder with states on the constraints; None where none of its rungs has one.

    A coordinate that approaches a value keeps that, as far as it can; what is left out is added to ``left_out``.
    """
    moving, arrow, _ = ladder.subject.partition(" -> ")
    fixed = (moving,) if ladder.kind == SINGULAR and arrow else ()
    probes, missing = [], []
    for probe in ladder.probes:
        state = _led(probe.scenario, probe.state, fixed)
        if state is None:
            missing.append(f"{probe.size:.0e}")
        else:
            probes.append(replace(probe, state=state))
    if missing:
        text = "[[ladder]] [[sizes]]: no state of the constraints was found there"
        left_out.append(Message(text, ladder=ladder.title, sizes=", ".join(missing)))
    return replace(ladder, probes=tuple(probes)) if probes else None


def _led(scenario: Scenario, state: tuple[Fraction, ...], fixed: tuple[str, ...] = ()) -> tuple[Fraction, ...] | None:
    n = len(scenario.system.coordinates)
    meant = replace(scenario, positions=state[:n], velocities=state[n:], unstated=())
    try:
        return closed(meant, fixed).scenario.state
    except (Failure, np.linalg.LinAlgError):
        return None


#: Below this part of the largest a kinetic energy of what the constraints allow counts as none.
NO_MASS = 1e-9


def positive_there(scenario: Scenario, where: Singularities, units: SceneUnits) -> tuple[bool | None, ...]:
    """Of every set at which M of the tree is singular, whether M is positive on what the constraints allow.

    At the first of its places, led to the constraints with the coordinates of the set held; None where no state of the
    constraints is found there.  By singular values in float64, lengths and angles in the units of the scene.
    """
    return tuple(_positive(scenario, singular_set, units) for singular_set in where.sets)


def _positive(scenario: Scenario, singular_set: SingularSet, units: SceneUnits) -> bool | None:
    names, n = scenario.system.coordinates, len(scenario.system.coordinates)
    held = tuple(name for name in singular_set.names if name in names)
    if not held or any(name not in names for name in singular_set.names):
        return None
    values = dict(zip(names, scenario.positions, strict=True)) | dict(singular_set.places[0])
    state = _led(scenario, (*(values[name] for name in names), *scenario.velocities), held)
    if state is None:
        return None
    at = np.array([float(x) for x in state])
    dynamics = Dynamics(scenario)
    known = dynamics.constraints
    assert known is not None
    sizes = np.array([float(x) for x in units.sizes])
    masses = arrays.kernel(dynamics.mass_matrix)(np.concatenate(([0.0], at))).reshape(n, n) * np.outer(sizes, sizes)
    rows = known.at(0.0, at).partials * sizes
    lengths = np.linalg.norm(rows, axis=1)
    _, values_, turned = np.linalg.svd(rows / np.where(lengths > 0, lengths, 1.0)[:, None])
    free = turned[int(np.sum(values_ > NO_MASS)) :].T
    if not free.size:
        return True
    # Each direction by the mass that its coordinates have by themselves.
    weights = np.sqrt(np.maximum(np.diag(masses), np.max(np.diag(masses)) * 1e-12))
    masses = masses / np.outer(weights, weights)
    free = np.linalg.qr(weights[:, None] * free)[0]
    energies = np.linalg.eigvalsh(free.T @ masses @ free)
    return bool(energies[0] > NO_MASS * energies[-1])


def approaches(scenario: Scenario, positions: SingularPositions, units: SceneUnits) -> Iterator[Ladder]:
    """One ladder for each of the first positions, along the constraints; none where no way out of it is found."""
    for position in positions.found[:MOST_APPROACHED]:
        probes = _approach(scenario, position, units)
        if probes:
            yield Ladder(SINGULAR, f"distance from {position.text}", tuple(probes))


def _approach(scenario: Scenario, position: SingularPosition, units: SceneUnits) -> list[Probe]:
    names, n = scenario.system.coordinates, len(scenario.system.coordinates)
    place, sizes = np.array([position.place[name] for name in names]), np.array([float(x) for x in units.sizes])
    source = np.random.default_rng(7)
    velocities = scenario.velocities if any(scenario.velocities) else units.velocities
    for _ in range(DIRECTIONS):
        way = source.normal(size=n)
        probes: list[Probe] = []
        for size in (x for x in DISTANCES if x >= LEAST):
            aimed = place + size * sizes * way / np.linalg.norm(way)
            state = _led(scenario, (*map(Fraction, aimed.tolist()), *velocities))
            if state is None:
                continue
            away = float(np.linalg.norm((np.array([float(x) for x in state[:n]]) - place) / sizes))
            if size / ABOUT < away < size * ABOUT:
                probes.append(Probe(size, scenario, state))
                way = _direction(state[:n], place, sizes)
        if len(probes) > 2:
            return probes
    return []


def _direction(position: Any, place: Any, sizes: Any) -> Any:
    return (np.array([float(x) for x in position]) - place) / sizes


#: A quantity is left out where its program is longer than this, linear matrices where they have more terms.
MOST_OPERATIONS = 20_000

#: Steps of polynomial arithmetic that a unit of the budget allows the linear equations.
STEPS_PER_UNIT = 1_000_000

#: Programs with more operations than this for a unit of the budget are not compiled but taken step by step.
COMPILED_PER_UNIT = 1_000

#: What is counted, with the seconds that it takes on a usual machine, about (``planning.prices``): a quantity on
#: a rung, and one of its operations in balls; an operation that is compiled, or made ready to be taken step by step; an
#: entry of the linear equations' matrices on a rung.
QUANTITY, IN_BALLS = 2e-4, 2.5e-7
COMPILED, STEPWISE = 2.5e-4, 2e-5
ENTRY = 7e-4

#: Eigenvalues of larger linear systems are not enclosed.
MOST_ENCLOSED = 12

#: The part of the budget in which positions are sought in which constraints lose their rank.
SEARCH = 0.15

#: So many names are listed where the budget was short.
LISTED = 8


@dataclass(frozen=True)
class Row:
    """One quantity on one rung."""

    kind: str
    subject: str
    size: float
    quantity: str
    digits: Digits


@dataclass(frozen=True)
class VerdictRow:
    """The verdict on one rung, exact and by floats."""

    kind: str
    subject: str
    size: float
    judged: Judged


@dataclass(frozen=True)
class Compensated:
    """The accelerations on one rung are computed with pairs, as simulations do there; ``kind`` is empty as given."""

    kind: str
    subject: str
    size: float
    compensation: Compensation


@dataclass(frozen=True)
class Extremes:
    """All rows in the order measured; ``left_out`` says what was not, and why.

    ``falling`` is there where a frame falls in a Newtonian field.  ``eigenvalues`` are balls (``flint.acb``) that hold
    those of the first approximation at the given ``values`` of the parameters, each with its multiplicity; none where
    there is no first approximation or a value is irrational.  With constraints, ``positions`` are those in which they
    lose their rank, ``positive`` says of every singular set of M whether M is positive on what they allow there.
    """

    system: System
    rows: tuple[Row, ...]
    verdicts: tuple[VerdictRow, ...]
    left_out: tuple[str, ...]
    seconds: float
    falling: Falling | None = None
    singularities: Singularities | None = None
    compensated: tuple[Compensated, ...] = ()
    eigenvalues: tuple[Any, ...] = ()
    values: Mapping[str, Fraction] = field(default_factory=dict)
    positions: SingularPositions | None = None
    positive: tuple[bool | None, ...] = ()

    @property
    def ladders(self) -> tuple[tuple[str, str], ...]:
        """(kind, subject) of every ladder."""
        measured_ = [(row.kind, row.subject) for row in self.rows]
        return tuple(dict.fromkeys([*measured_, *((row.kind, row.subject) for row in self.verdicts)]))

    @property
    def quantities(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(row.quantity for row in self.rows))

    def of(self, kind: str, subject: str, quantity: str) -> tuple[Row, ...]:
        """One quantity along one ladder, in the order of the rungs."""
        return tuple(r for r in self.rows if (r.kind, r.subject, r.quantity) == (kind, subject, quantity))


def extremes(
    scenario: Scenario,
    ring: Ring,
    overrides: dict[str, Expression],
    budget: float = 60.0,
    watch: Watch = lambda text: None,
) -> Extremes:
    """Everything that applies to a scenario, as far as ``budget`` goes: counted work, about as many
    seconds on a usual machine, and the same rows on every one.

    With constraints every state is one of theirs.  Raises NoClosedForm or SingularPoint where the equations have no
    program at all, NotClosed where no state satisfies the constraints.
    """
    started = time.perf_counter()
    left_out: list[str] = []
    watch("programs")
    scenario = closed(scenario).scenario
    found = _quantities(scenario, ring, left_out)
    truth = Truth(scenario.system, found)
    units = scene_units(scenario, truth)
    watch("singular configurations")
    where = _singularities(scenario, units, left_out)
    positions: SingularPositions | None = None
    positive: tuple[bool | None, ...] = ()
    left = budget
    if scenario.system.constraints:
        watch("positions in which constraints lose their rank")
        positions = singular_positions(scenario, [float(x) for x in units.sizes], SEARCH * budget)
        positive = positive_there(scenario, where, units)
        left -= SEARCH * budget
    watch("linear equations")
    linear = _linear(scenario, budget, left_out)
    watch("kernels")
    compiled = _operations(found) <= COMPILED_PER_UNIT * budget
    rungs = _Rungs(scenario, Arithmetic(scenario, found, compiled), truth, linear, left)
    late = []
    for ladder in _all(scenario, overrides, found, linear, where, units, positions):
        watch(ladder.title)
        if positions is not None and not rungs.late and not ladder.subject.startswith("distance from "):
            led = on_constraints(ladder, left_out)
            if led is None:
                continue
            ladder = led
        if not rungs.climb(ladder):
            late.append(ladder.title)
    if late:
        shown = late if len(late) <= LISTED + 1 else [*late[:LISTED], f"and {len(late) - LISTED} more"]
        left_out.append(Message("beyond the budget, raise --budget: [[what]]", what=", ".join(shown)))
    joined = falling(scenario, ring, found, truth)
    seconds = time.perf_counter() - started
    enclosed = _enclosed(scenario, linear)
    rows, verdicts, values = tuple(rungs.rows), tuple(rungs.verdicts), dict(scenario.parameters)
    pairs, omitted = tuple(rungs.compensated), tuple(left_out)
    return Extremes(
        scenario.system, rows, verdicts, omitted, seconds, joined, where, pairs, enclosed, values, positions, positive
    )


class _Rungs:
    """Takes measurements, one rung after another, until they have cost ``limit``."""

    def __init__(
        self, given: Scenario, usual: Arithmetic, truth: Truth, linear: LinearModel | None, limit: float
    ) -> None:
        self.scenario, self.usual, self.truth, self.linear, self.limit = given, usual, truth, linear, limit
        self.spent = _operations(usual.quantities) * (COMPILED if usual.compiled else STEPWISE)
        self.quantities = usual.quantities
        self.lean = tuple(q for q in self.quantities if q.name != "Jacobian")
        self.rows: list[Row] = []
        self.verdicts: list[VerdictRow] = []
        self.compensated = [Compensated("", "", 1.0, rate) for rate in _rates(usual)]

    @property
    def late(self) -> bool:
        return self.spent > self.limit

    def climb(self, ladder: Ladder) -> bool:
        """Whether the budget was enough for every rung."""
        for probe in ladder.probes:
            if self.late:
                return False
            if ladder.kind != BORDER:
                self._state(ladder, probe)
            if self.linear is not None and ladder.kind in (BORDER, RATIO):
                self._linear(ladder, probe, self.linear)
        return True

    def _state(self, ladder: Ladder, probe: Probe) -> None:
        usual = probe.scenario is self.scenario
        try:
            arithmetic = self.usual if usual else Arithmetic(probe.scenario, self.lean, compiled=False)
        except Failure:  # a division by zero in the parameters alone: nothing to evaluate
            return
        if not usual:
            place = (ladder.kind, ladder.subject, probe.size)
            self.compensated += [Compensated(*place, rate) for rate in _rates(arithmetic)]
            self.spent += STEPWISE * _operations(self.lean)
        for q in self.quantities if usual else self.lean:
            self.spent += QUANTITY + IN_BALLS * q.code.operations * self.truth.evaluations
            digits = measured(self.truth, arithmetic, q.name, probe.scenario, probe.state)
            self.rows.append(Row(ladder.kind, ladder.subject, probe.size, q.name, digits))

    def _linear(self, ladder: Ladder, probe: Probe, linear: LinearModel) -> None:
        place = (ladder.kind, ladder.subject, probe.size)
        balls = IN_BALLS * linear.operations * (len(linear.names) + 1)
        self.spent += ENTRY * (2 + linear.size**2) + balls
        self.rows += [Row(*place, name, digits) for name, digits in linear.digits(probe.scenario).items()]
        if probe.assumed:
            self.verdicts.append(VerdictRow(*place, linear.judged(probe.scenario)))


def _operations(found: Sequence[Quantity]) -> int:
    return sum(q.code.operations for q in found)


def _enclosed(scenario: Scenario, linear: LinearModel | None) -> tuple[Any, ...]:
    """The eigenvalues at the given values; nothing where they are too many to be worth it."""
    if linear is None or linear.size > MOST_ENCLOSED:
        return ()
    return tuple(linear.exact_eigenvalues(scenario) or ())


def _rates(arithmetic: Arithmetic) -> list[Compensation]:
    """What was done to the accelerations; pivots follow them."""
    return [compensation for name, compensation in arithmetic.compensations.items() if name == "accelerations"]


def _all(
    scenario: Scenario,
    overrides: dict[str, Expression],
    found: Sequence[Quantity],
    linear: LinearModel | None,
    where: Singularities,
    units: SceneUnits,
    positions: SingularPositions | None = None,
) -> Iterator[Ladder]:
    """Ladders that need no new kernels come first."""
    if positions is not None:
        yield from approaches(scenario, positions, units)
    bordering = linear is not None
    for ladder in ladders(scenario, overrides, found, where, units):
        if bordering and linear is not None and ladder.kind == RATIO:
            yield from linear.borders(scenario, overrides)
            bordering = False
        yield ladder


def _quantities(scenario: Scenario, ring: Ring, left_out: list[str]) -> tuple[Quantity, ...]:
    available = quantities(scenario.system, ring, solved=equations(scenario, ring))
    kept_quantities = tuple(q for q in available if q.code.operations <= MOST_OPERATIONS)
    left_out += [
        f"{q.name}: {q.code.operations} operations are too many here" for q in available if q not in kept_quantities
    ]
    return kept_quantities


def _singularities(scenario: Scenario, units: SceneUnits, left_out: list[str]) -> Singularities:
    """At the scenario's numbers; nothing where the system has no ring."""
    ranges = {name: RANGE * size for name, size in zip(scenario.system.coordinates, units.sizes, strict=True)}
    try:
        return singularities(scenario, ranges)
    except Failure as reason:
        left_out.append(Message("singular configurations: [[why]]", why=message_of(reason)))
        return Singularities((), False, "", {})


def _linear(scenario: Scenario, budget: float, left_out: list[str]) -> LinearModel | None:
    what = "linear equations, eigenvalues and verdicts"
    if scenario.system.constraints:
        left_out.append(Message("[[what]]: those of systems with constraints are not measured", what=what))
        return None
    analysis = Analysis(scenario.system)
    analysis.ring.limit_work(int(budget * STEPS_PER_UNIT))
    try:
        terms = sum(len(x) for matrix in analysis.autonomous.matrices for row in matrix.polynomials for x in row)
        if terms > MOST_OPERATIONS:
            left_out.append(Message("[[what]]: [[terms]] terms are too many here", what=what, terms=terms))
            return None
        return LinearModel(analysis)
    except Failure as reason:
        left_out.append(Message("[[what]]: [[why]]", what=what, why=reason.reason))
        return None


# --- frames that fall ---


@dataclass(frozen=True)
class Falling:
    """Digits of the forcing in float64, the bodies at rest in the given positions and the frames some way along.

    ``apart``: with gravity and the acceleration of the ``frames`` taken separately; ``joined``: as it is done here.
    """

    frames: tuple[str, ...]
    apart: float
    joined: float


def falling(scenario: Scenario, ring: Ring, found: Sequence[Quantity], truth: Truth) -> Falling | None:
    """None where no frame falls, or the forcing has no tight enclosure."""
    frames = tuple(falling_frames(scenario.system))
    usual = next((q for q in found if q.name == "forcing"), None)
    if not frames or usual is None:
        return None
    program = Program()
    scene = scene_without_accelerations(scenario.system, ring, program)
    nodes = tuple(-x for x in residuals(scene).values())
    apart = Quantity("forcing", Code(program, usual.code.inputs, nodes))
    rates = [rate for _, rate in scenario.prescribed.values() if rate]
    time_ = 1 / rates[0] if rates else Fraction(1)
    state = (*scenario.positions, *(Fraction(0) for _ in scenario.velocities))
    digits = [
        measured(truth, Arithmetic(scenario, [q], compiled=False), "forcing", scenario, state, time_)
        for q in (apart, usual)
    ]
    if not digits[0].bits:
        return None
    return Falling(frames, digits[0].formula, digits[1].formula)
