"""What all kinds of savings share: the model as it is, the building of counterfactuals, and a bound on both."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, TypeVar

from flint import arb

from mbsym.algebra.failures import Failure, NoClosedForm
from mbsym.algebra.point import Balls
from mbsym.algebra.program import Node
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.analysis import Analysis
from mbsym.expressions.message import Message
from mbsym.expressions.tree import Expression, Name
from mbsym.formulas.names import free_name
from mbsym.mechanics.energy import kinetic_energy
from mbsym.mechanics.kinematics import over_ring
from mbsym.mechanics.programs import ForwardDynamics, constants, forward_dynamics
from mbsym.mechanics.variables import ring_of
from mbsym.model.system import Body, Parameter, System
from mbsym.numerics.ledger.entry import COUNT, OPERATIONS, SECONDS, TERMS, Measure
from mbsym.numerics.scenario import Incomplete, Scenario, scenario

#: What all counterfactuals together may cost (``planning.prices``), and steps of polynomial arithmetic that one
#: may take.
BUDGET, WORK = 20.0, 20_000_000

#: What an instruction that is written costs, and a step of polynomial arithmetic.
INSTRUCTION, STEP = 1e-5, 2e-7

#: What is built faster than this is built again, so many times at most, and the shortest time counts.
SOON, REPEATS = 0.2, 5

Made = TypeVar("Made")


class TooDear(Exception):
    """The next counterfactual would cost more than is left."""


@dataclass(frozen=True)
class Counted:
    """Terms of something derived (None: not finished), steps of polynomial arithmetic, and seconds."""

    terms: int | None
    steps: int
    seconds: float

    def measures(self, here: Counted, of: str) -> tuple[Measure, ...]:
        """This counterfactual against what was derived ``here``, which was finished."""
        assert here.terms is not None
        text = Message("seconds of deriving [[what]]", what=of)
        seconds = Measure(text, SECONDS, self.seconds, here.seconds, self.terms is None)
        if self.terms is None:
            text = Message("steps of polynomial arithmetic for [[what]]", what=of)
            return Measure(text, COUNT, self.steps, here.steps, True), seconds
        return Measure(Message("terms of [[what]]", what=of), TERMS, self.terms, here.terms), seconds


@dataclass(frozen=True)
class AccuracyGoal:
    """An ``accuracy`` (relative, of every coordinate and velocity) that a motion from 0 to ``time`` is to have."""

    accuracy: float
    time: float


class Work:
    """The model of an analysis and its counterfactuals."""

    def __init__(self, analysis: Analysis, budget: float = BUDGET, goal: AccuracyGoal | None = None) -> None:
        self.analysis = analysis
        self.goal = goal
        self.system = analysis.system
        self._budget, self._spent = budget, 0.0
        self._rings: list[Ring] = []

    # --- numbers ---

    @cached_property
    def scenario(self) -> Scenario | None:
        """Parameters and initial state, if every one of them has a number."""
        try:
            return scenario(self.system)
        except Incomplete:
            return None

    @cached_property
    def numbers(self) -> Scenario | None:
        """Parameters only; the state is then zero where none is given."""
        try:
            return scenario(self.system, state=False)
        except Incomplete:
            return None

    # --- programs ---

    @cached_property
    def cost(self) -> tuple[ForwardDynamics, float]:
        """The accelerations, and the seconds that writing their program takes."""
        return self.timed(lambda: forward_dynamics(self.system, ring_of(self.system)))

    @property
    def price(self) -> float:
        """What writing a program like that costs."""
        return INSTRUCTION * len(self.forward.program.instructions)

    @property
    def forward(self) -> ForwardDynamics:
        """The accelerations as they are computed."""
        return self.cost[0]

    @cached_property
    def given(self) -> frozenset[str]:
        """The inputs that do not change with the state."""
        return constants(self.system)

    def operations(self, outputs: Collection[Node]) -> int:
        """Operations of one more state, in the program of ``forward``."""
        return self.forward.program.operations(outputs, self.given)

    def accelerations_at(self, values: Mapping[str, arb]) -> list[arb]:
        """q'' at numbers for all inputs."""
        accelerations: list[arb] = self.forward.program.evaluate(self.forward.accelerations, values, Balls(values))
        return accelerations

    def right_hand_sides(self, other: System, changing: Collection[str] = ()) -> tuple[Measure, ...]:
        """The accelerations of another system against those of this one: operations, and seconds of building them.

        ``changing`` are parameters of the other system that count as if they changed with the state.
        """
        here, seconds = self.operations(self.forward.accelerations), self.cost[1]
        self.begin(self.price)
        dynamics, spent = self.timed(lambda: forward_dynamics(other, ring_of(other)))
        there = dynamics.program.operations(dynamics.accelerations, constants(other) - set(changing))
        return (
            Measure("operations of q'' for one state", OPERATIONS, there, here),
            Measure("seconds of writing the program of q''", SECONDS, spent, seconds),
        )

    # --- closed formulas ---

    @cached_property
    def bounded(self) -> Analysis:
        """A fresh analysis of the same system for what the run itself did not derive."""
        return self.fresh(self.system)

    def fresh(self, system: System) -> Analysis:
        analysis = Analysis(system, (), self.analysis.terms, suggests=False)
        analysis.ring.limit_work(WORK)
        self._rings.append(analysis.ring)
        return analysis

    def result(self, stage: str) -> Any:
        """A result of the run, or of a bounded analysis where the run did not need it; None where there is none."""
        source = self.analysis if stage in self.analysis.derived else self.bounded
        try:
            return getattr(source, stage)
        except Failure:
            return None

    def kinetic_energy(self, system: System) -> Counted:
        """T in the ring, within the budgets."""
        (terms, steps), seconds = self.timed(lambda: self._kinetic_energy(system))
        self._spent += STEP * steps
        return Counted(terms, steps, seconds)

    def _kinetic_energy(self, system: System) -> tuple[int | None, int]:
        ring = ring_of(system, self.analysis.terms)
        ring.limit_work(WORK)
        try:
            return len(kinetic_energy(over_ring(system, ring))), ring.work
        except NoClosedForm:
            return None, ring.work

    @cached_property
    def own_kinetic_energy(self) -> Counted:
        return self.kinetic_energy(self.system)

    def kinetic_energies(self, other: System) -> tuple[Measure, ...]:
        """T of another system against T of this one; nothing where this one has no closed form."""
        here = self.own_kinetic_energy
        if here.terms is None:
            return ()
        self.require(STEP * here.steps)
        return self.kinetic_energy(other).measures(here, "T")

    # --- bounds ---

    @property
    def spent(self) -> float:
        """What all counterfactuals have cost: no clock decides which of them there are."""
        return self._spent + STEP * sum(ring.work for ring in self._rings)

    def require(self, price: float) -> None:
        """Raises TooDear unless something that costs about twice the price may still be begun."""
        if self.spent + 2 * price > self._budget:
            raise TooDear

    def begin(self, price: float) -> None:
        """The same of something whose price is spent then."""
        self.require(price)
        self._spent += price

    def timed(self, build: Callable[[], Made]) -> tuple[Made, float]:
        """What is built, and the processor seconds that took: the least of several times where it is soon done."""
        best, total = float("inf"), 0.0
        for _ in range(REPEATS):
            started = time.thread_time()
            built = build()
            spent = time.thread_time() - started
            best, total = min(best, spent), total + spent
            if total > SOON:
                break
        return built, best


# --- counterfactual systems ---


class Symbols:
    """Fresh parameters for a counterfactual system."""

    def __init__(self, system: System) -> None:
        moving = (*system.coordinates, *system.velocities, *(item.name for item in system.prescribed))
        moving = (*moving, *system.input_names)
        self._taken = [*system.parameter_names, *moving, *(item.name for item in system.notation)]
        self.made: list[Parameter] = []

    def __call__(self, like: str) -> Expression:
        name = free_name(like, self._taken)
        self._taken.append(name)
        self.made.append(Parameter(name, "positive"))
        return Name(name)

    @property
    def names(self) -> frozenset[str]:
        return frozenset(item.name for item in self.made)


def changed_bodies(system: System, change: Callable[[Body], Body], symbols: Symbols) -> System:
    """The system with other bodies and the fresh parameters that they use."""
    bodies = tuple(change(body) for body in system.bodies)
    return replace(system, bodies=bodies, parameters=(*system.parameters, *symbols.made), claims=())


def moving_names(system: System) -> frozenset[str]:
    """Everything that changes with the state or the time."""
    driven = (*(item.name for item in system.prescribed), *system.input_names)
    return frozenset((*system.coordinates, *system.velocities, *driven, "t"))


def holds(ring: Ring, x: Polynomial, name: str) -> bool:
    """Whether a parameter occurs in a polynomial: plainly, under sin and cos, or inside what is adjoined."""
    held = (ring.generators[k] for k in ring.held([x]))
    return any(g.name == name and g.kind in ("parameter", "sine", "cosine") for g in held)
