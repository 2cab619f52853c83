"""A model at its extremes: how many digits each quantity keeps, where it breaks down, and why.

Ladders of states and parameters (``probes``, ``borders``) times quantities (``digits``): every rung is evaluated by the
compiled kernels in float32 and float64 and by rigorous balls, with the condition of the question beside it.  What is
said in sentences follows from the rows and from nothing else.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from mbsym.algebra.failures import Failure, message_of
from mbsym.algebra.program import Program
from mbsym.algebra.ring import Ring
from mbsym.analysis import Analysis
from mbsym.expressions.message import Message
from mbsym.expressions.tree import Expression
from mbsym.mechanics.falling import falling_frames
from mbsym.mechanics.newton_euler import residuals
from mbsym.mechanics.programs import scene_without_accelerations
from mbsym.mechanics.variables import program_environment
from mbsym.model.system import System
from mbsym.numerics.borders import BORDER, Judged, LinearModel
from mbsym.numerics.closing import closed
from mbsym.numerics.compensation import Compensation
from mbsym.numerics.extremes.extremes_constrained import approaches, equations, on_constraints, positive_there
from mbsym.numerics.extremes.singular import RANGE, Singularities, singularities
from mbsym.numerics.extremes.singular_positions import SingularPositions, singular_positions
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.probes import RATIO, Ladder, Probe, ladders
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.scene_units import SceneUnits, scene_units
from mbsym.numerics.trade.digits import Arithmetic, Digits, Quantity, Truth, Watch, measured, quantities

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
    found: Digits


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
    found: Compensation


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
    given: Scenario,
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
    given = closed(given).scenario
    found = _quantities(given, ring, left_out)
    truth = Truth(given.system, found)
    units = scene_units(given, truth)
    watch("singular configurations")
    where = _singularities(given, units, left_out)
    positions: SingularPositions | None = None
    positive: tuple[bool | None, ...] = ()
    left = budget
    if given.system.constraints:
        watch("positions in which constraints lose their rank")
        positions = singular_positions(given, [float(x) for x in units.sizes], SEARCH * budget)
        positive = positive_there(given, where, units)
        left -= SEARCH * budget
    watch("linear equations")
    linear = _linear(given, budget, left_out)
    watch("kernels")
    compiled = _operations(found) <= COMPILED_PER_UNIT * budget
    rungs = _Rungs(given, Arithmetic(given, found, compiled), truth, linear, left)
    late = []
    for ladder in _all(given, overrides, found, linear, where, units, positions):
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
    joined = falling(given, ring, found, truth)
    seconds = time.perf_counter() - started
    enclosed = _enclosed(given, linear)
    rows, verdicts, values = tuple(rungs.rows), tuple(rungs.verdicts), dict(given.parameters)
    pairs, omitted = tuple(rungs.compensated), tuple(left_out)
    return Extremes(
        given.system, rows, verdicts, omitted, seconds, joined, where, pairs, enclosed, values, positions, positive
    )


class _Rungs:
    """Takes measurements, one rung after another, until they have cost ``limit``."""

    def __init__(
        self, given: Scenario, usual: Arithmetic, truth: Truth, linear: LinearModel | None, limit: float
    ) -> None:
        self.given, self.usual, self.truth, self.linear, self.limit = given, usual, truth, linear, limit
        self.spent = _operations(usual.found) * (COMPILED if usual.compiled else STEPWISE)
        self.found = usual.found
        self.lean = tuple(q for q in self.found if q.name != "Jacobian")
        self.rows: list[Row] = []
        self.verdicts: list[VerdictRow] = []
        self.compensated = [Compensated("", "", 1.0, one) for one in _rates(usual)]

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
        usual = probe.scenario is self.given
        try:
            arithmetic = self.usual if usual else Arithmetic(probe.scenario, self.lean, compiled=False)
        except Failure:  # a division by zero in the parameters alone: nothing to evaluate
            return
        if not usual:
            place = (ladder.kind, ladder.subject, probe.size)
            self.compensated += [Compensated(*place, one) for one in _rates(arithmetic)]
            self.spent += STEPWISE * _operations(self.lean)
        for q in self.found if usual else self.lean:
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


def _enclosed(given: Scenario, linear: LinearModel | None) -> tuple[Any, ...]:
    """The eigenvalues at the given values; nothing where they are too many to be worth it."""
    if linear is None or linear.size > MOST_ENCLOSED:
        return ()
    return tuple(linear.exact_eigenvalues(given) or ())


def _rates(arithmetic: Arithmetic) -> list[Compensation]:
    """What was done to the accelerations; pivots follow them."""
    return [one for name, one in arithmetic.compensations.items() if name == "accelerations"]


def _all(
    given: Scenario,
    overrides: dict[str, Expression],
    found: Sequence[Quantity],
    linear: LinearModel | None,
    where: Singularities,
    units: SceneUnits,
    positions: SingularPositions | None = None,
) -> Iterator[Ladder]:
    """Ladders that need no new kernels come first."""
    if positions is not None:
        yield from approaches(given, positions, units)
    bordering = linear is not None
    for ladder in ladders(given, overrides, found, where, units):
        if bordering and linear is not None and ladder.kind == RATIO:
            yield from linear.borders(given, overrides)
            bordering = False
        yield ladder


def _quantities(given: Scenario, ring: Ring, left_out: list[str]) -> tuple[Quantity, ...]:
    found = quantities(given.system, ring, solved=equations(given, ring))
    kept = tuple(q for q in found if q.code.operations <= MOST_OPERATIONS)
    left_out += [f"{q.name}: {q.code.operations} operations are too many here" for q in found if q not in kept]
    return kept


def _singularities(given: Scenario, units: SceneUnits, left_out: list[str]) -> Singularities:
    """At the scenario's numbers; nothing where the system has no ring."""
    ranges = {name: RANGE * size for name, size in zip(given.system.coordinates, units.sizes, strict=True)}
    try:
        return singularities(given, ranges)
    except Failure as reason:
        left_out.append(Message("singular configurations: [[why]]", why=message_of(reason)))
        return Singularities((), False, "", {})


def _linear(given: Scenario, budget: float, left_out: list[str]) -> LinearModel | None:
    what = "linear equations, eigenvalues and verdicts"
    if given.system.constraints:
        left_out.append(Message("[[what]]: those of systems with constraints are not measured", what=what))
        return None
    analysis = Analysis(given.system)
    analysis.ring.limit_work(int(budget * STEPS_PER_UNIT))
    try:
        terms = sum(len(x) for matrix in analysis.linearisation.matrices for row in matrix.polynomials for x in row)
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


def falling(given: Scenario, ring: Ring, found: Sequence[Quantity], truth: Truth) -> Falling | None:
    """None where no frame falls, or the forcing has no tight enclosure."""
    frames = tuple(falling_frames(given.system))
    usual = next((q for q in found if q.name == "forcing"), None)
    if not frames or usual is None:
        return None
    program = Program()
    scene = scene_without_accelerations(given.system, ring, program, program_environment(given.system, program))
    nodes = tuple(-x for x in residuals(scene).values())
    apart = Quantity("forcing", Code(program, usual.code.inputs, nodes))
    rates = [rate for _, rate in given.prescribed.values() if rate]
    time_ = 1 / rates[0] if rates else Fraction(1)
    state = (*given.positions, *(Fraction(0) for _ in given.velocities))
    digits = [
        measured(truth, Arithmetic(given, [q], compiled=False), "forcing", given, state, time_) for q in (apart, usual)
    ]
    if not digits[0].bits:
        return None
    return Falling(frames, digits[0].formula, digits[1].formula)
