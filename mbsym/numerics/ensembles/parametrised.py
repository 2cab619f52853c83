"""The codes of a scenario in which some parameters stay inputs: one program for all values of them.

    x' = rhs(t, x, p),    x(0) = start(p)

What follows from a free parameter through relations, what is prescribed through it and an initial state that is made of
it move with it.  All codes take (t, q, q', p).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING

from mbsym.algebra.base import Lowering
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.program import Node
from mbsym.expressions.tree import Expression, names, number, reached
from mbsym.model.states import InStates, described
from mbsym.model.system import System, velocity_name
from mbsym.numerics.closing import begun, closed, fitted, shown
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.scenario import Incomplete, Names, Scenario, Specialised, bound, exact, initial_values
from mbsym.numerics.scenario import scenario as scenario_of_run
from mbsym.numerics.states import StateDynamics, dynamics_of, scenario_in_states

if TYPE_CHECKING:
    from mbsym.numerics.constrained import Constraints


#: Differences of order 4: f' = sum of weight f(c + offset h)/(12 h); and h, a part of c or of 1.
CENTRAL = {-2: 1, -1: -8, 1: 8, 2: -1}
FORWARD = {0: -25, 1: 48, 2: -36, 3: 16, 4: -3}
STEP = Fraction(1, 2**14)


class Parametrised(Dynamics):
    """The codes of a scenario with the parameters ``free`` as inputs behind (t, q, q').

    Of one in declared variables it is ``ParametrisedStates``: see ``parametrised``.

    ``overrides`` are those of which the scenario was made: an initial state may be an expression in free parameters.
    ``fixed`` are initial values that stay while others are fitted to constraints.  Which rows of constraints follow
    from others is told at the scenario's own values: ``keeps`` says of which scenarios that is true.
    """

    def __init__(
        self,
        scenario: Scenario,
        free: Sequence[str],
        overrides: Mapping[str, Expression] | None = None,
        fixed: Sequence[str] = (),
    ) -> None:
        super().__init__(scenario)
        self.free = tuple(free)
        self.overrides, self.fixed = dict(overrides or {}), tuple(fixed)
        self.inputs = (*self.inputs, *self.free)

    @cached_property
    def constraints(self) -> Constraints | None:
        """At the scenario's own values."""
        return dynamics_of(self.scenario, self.ring).constraints

    @cached_property
    def _specialised(self) -> Specialised:
        return released(self.scenario, self.free)

    @cached_property
    def start(self) -> Code:
        """(p, x) -> (q, q') at t = 0; names of x that the overrides or the description give by p follow p.

        ``x`` are the coordinates and velocities: an initial value that is no expression in ``p`` is that input.
        """
        fresh = released(self.scenario, self.free)
        lowering = Lowering(fresh, Names(fresh))
        moving = {*self.free, *dependent(self.system, self.free)}
        outputs: dict[str, Node] = {}
        for name, entry in initial_values(self.system, self.overrides).items():
            for place, expression in ((name, entry.position), (velocity_name(name), entry.velocity)):
                follows = expression is not None and bool(names(expression) & moving)
                outputs[place] = lowering(expression) if expression is not None and follows else fresh.input(place)
        order = (*self.system.coordinates, *self.system.velocities)
        return Code(fresh, (*self.free, *order), tuple(outputs[name] for name in order))

    def begun(self, values: Mapping[str, Expression]) -> Scenario:
        """The scenario of a run of its own with ``values`` in the place of others.  Raises Incomplete, Failure."""
        return begun(self._given(values), self.fixed, self.in_states).scenario

    def keeps(self, other: Scenario) -> bool:
        """Whether of another scenario's constraints the same rows follow from the same others."""
        own, theirs = self.constraints, dynamics_of(other, self.ring).constraints
        return own is None or (theirs is not None and theirs.chosen == own.chosen)

    def _given(self, values: Mapping[str, Expression]) -> Scenario:
        """Where the description gives velocities of coordinates, the other speeds stay beside another speed."""
        system, own = described(self.system), self.overrides | dict(values)
        speeds = {name: own[name] for speed in system.speeds if self.in_states and (name := speed.name) in values}
        rest = {name: x for name, x in own.items() if name not in speeds}
        if speeds and not (usual := scenario_of_run(system, rest, declared=True)).declared:
            seen = scenario_in_states(usual)
            names_ = (*seen.system.coordinates, *seen.system.velocities)
            taken = {name: exact(x, usual.parameters) for name, x in speeds.items()}
            state = tuple(taken.get(name, x) for name, x in zip(names_, seen.state, strict=True))
            return replace(usual, declared=state)
        return scenario_of_run(system, own, declared=self.in_states)

    def column(self, name: str) -> tuple[Fraction, ...]:
        """dx(0)/dc: of an initial value or a parameter c, through everything that follows from it and constraints.

        By differences of order 4 of states in many bits, each fitted to constraints from the state at c; to one side
        where c has no room on the other.  Raises Failure.
        """
        plain = self._given({})
        scenario = fitted(plain, self.in_states)
        numbers = dict(scenario.parameters)
        for version in (plain, scenario, shown(scenario, self.in_states)):
            numbers |= dict(zip((*version.system.coordinates, *version.system.velocities), version.state, strict=True))
        scenario = fitted(self._given({name: number(numbers[name])}), self.in_states)  # in the variables of ``state``
        center = closed(scenario, self.fixed).scenario
        step = STEP * max(Fraction(1), abs(numbers[name]))
        p = len(scenario.positions)

        def state(offset: int) -> tuple[Fraction, ...]:
            moved = fitted(self._given({name: number(numbers[name] + offset * step)}), self.in_states)
            here = tuple(x + a - b for x, a, b in zip(center.state, moved.state, scenario.state, strict=True))
            begun = replace(moved, positions=here[:p], velocities=here[p:])
            return shown(closed(begun, self.fixed).scenario, self.in_states).state

        def slope(weights: Mapping[int, int]) -> tuple[Fraction, ...]:
            known = [(state(offset), weight) for offset, weight in weights.items()]
            whole = zip(*([weight * x for x in values] for values, weight in known), strict=True)
            return tuple(sum(parts, Fraction(0)) / (12 * step) for parts in whole)

        for sides in (CENTRAL, FORWARD, {-offset: -weight for offset, weight in FORWARD.items()}):
            try:
                return slope(sides)
            except Incomplete as reason:
                why = str(reason)
        raise NoClosedForm("no motion begins with another [[name]] alone: [[why]]", name=name, why=why)

    @cached_property
    def parameters(self) -> Code:
        """(p) -> all parameters that move with p, themselves first, then those of ``dependent``."""
        fresh = released(self.scenario, self.free)
        moving = (*self.free, *dependent(self.system, self.free))
        return Code(fresh, self.free, tuple(fresh.input(name) for name in moving))


class ParametrisedStates(Parametrised, StateDynamics):
    """The same in declared variables."""


def parametrised(
    scenario: Scenario,
    free: Sequence[str],
    overrides: Mapping[str, Expression] | None = None,
    fixed: Sequence[str] = (),
) -> Parametrised:
    """The codes of a scenario, in what it is told in, with some parameters as inputs."""
    kind = ParametrisedStates if isinstance(scenario.system, InStates) else Parametrised
    return kind(scenario, free, overrides, fixed)


def dependent(system: System, free: Iterable[str]) -> tuple[str, ...]:
    """The parameters that follow from some others through relations, in an order in which they can be computed."""
    given, ordered = set(free), list[str]()
    needs = {relation.name: names(relation.value) for relation in system.relations}
    waiting = [name for name in needs if name not in given and reached(needs, needs[name]) & given]
    while waiting:
        ready = [name for name in waiting if not needs[name] & set(waiting)]
        ordered += ready or waiting
        waiting = [name for name in waiting if name not in ordered]
    return tuple(ordered)


def released(scenario: Scenario, free: Sequence[str]) -> Specialised:
    """An empty program in which all parameters but the free ones, and what follows from them, are numbers."""
    fresh, system = bound(scenario), scenario.system
    for name in free:
        del fresh.bound[name]
    values = {relation.name: relation.value for relation in system.relations}
    lowering = Lowering(fresh, Names(fresh))
    moving = set(free)
    for name in dependent(system, free):
        fresh.bound[name] = lowering(values[name])
        moving.add(name)
    for item in system.prescribed:
        expressions = [item.rate] if item.initial is None else [item.rate, item.initial]
        if any(names(expression) & moving for expression in expressions):
            initial = fresh.zero if item.initial is None else lowering(item.initial)
            fresh.bound[item.name] = initial + fresh.product(lowering(item.rate), fresh.input("t"))
    return fresh
