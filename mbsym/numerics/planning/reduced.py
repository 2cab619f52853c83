"""Integration in fewer coordinates: what provably rests is taken out, and put back into every state that is shown.

Coordinates S with q_S'' = 0 while they rest (``planning.reduction``) are constants of the motion: the free ones
are integrated in the system in which q_S is held, and a whole state is

    q_F(t), q_F'(t) as integrated,      q_S(t) = q_S(0),      q_S'(t) = 0.

Energy, pivots of the mass matrix and states at a breakdown are those of the whole system.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from random import Random
from typing import Any

import numpy as np

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import NOT_THERE, Failure
from mbsym.algebra.program import Node
from mbsym.algebra.ring import Ring
from mbsym.expressions.angles import LinearForm, linear_form
from mbsym.expressions.tree import ZERO, Expression, number
from mbsym.mechanics.programs import Programs, programs
from mbsym.mechanics.states import SEED, rational_states
from mbsym.mechanics.variables import ring_environment, ring_of
from mbsym.model.substitution import put
from mbsym.model.system import System, acceleration_name, velocity_name
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.interface import compiled_kernel
from mbsym.numerics.scenario import Scenario, Specialised, substituted

# Coordinates that stay where they start: a spatial system that moves in a plane is integrated in that plane.
#
# Let S be coordinates with q_S' = 0 at the start.  If with q_S held, q_S' = 0, the forcing f_S and the part M_SF of the
# mass matrix that couples S to the free coordinates F vanish identically in (q_F, q_F', t), then q_S'' = 0 solves
#
#     M_SS q_S'' + M_SF q_F'' = f_S,
#
# and by uniqueness the motion stays there.  The largest such S is found by dropping, again and again, what is pushed.
# Zero is decided in the ring (``proved``); where there is no closed form, at random exact states (``verified``).


#: So many random exact states must agree where zero is not decided in the ring.
FEWEST_STATES = 3


@dataclass(frozen=True)
class Reduction:
    """``values`` of the coordinates that rest, how that is known, and the scenario without them."""

    values: Mapping[str, Expression]
    how: Certainty
    scenario: Scenario

    def expanded(self, whole: Scenario) -> tuple[tuple[int, ...], tuple[Fraction, ...]]:
        """Where the free coordinates and velocities stand in the whole state, and the whole state at the start."""
        names = whole.system.coordinates
        free = [place for place, name in enumerate(names) if name not in self.values]
        return (*free, *(len(names) + place for place in free)), whole.state


def resting(scenario: Scenario, among: Collection[str] | None = None) -> Reduction | None:
    """The largest set of coordinates that provably rest in this scenario, or None where there is none.

    ``among`` names those worth looking at (all, by default).  Parameters keep their symbols unless their value here is
    zero, so the statement holds for other numbers as well.
    """
    system = scenario.system
    candidates = {name: x for name, x in _candidates(scenario).items() if among is None or name in among}
    if not candidates or len(system.coordinates) < 2:
        return None
    try:
        equations = programs(system, ring_of(system))
    except Failure:
        return None
    how = Certainty.PROVED
    while candidates:
        pushed, how = _pushed(scenario, equations, candidates)
        if not pushed:
            break
        candidates = {name: value for name, value in candidates.items() if name not in pushed}
    if not candidates or len(candidates) == len(system.coordinates):
        return None
    return Reduction(candidates, how, without(scenario, candidates))


def _candidates(scenario: Scenario) -> dict[str, Expression]:
    """Coordinates that start without velocity, with their positions as the description gives them."""
    candidates = {}
    for name, position, velocity in zip(
        scenario.system.coordinates, scenario.positions, scenario.velocities, strict=True
    ):
        if velocity == 0:
            form = linear_form(scenario.typed[name]) if name in scenario.typed else None
            exact = form is not None and not form.coefficients
            candidates[name] = scenario.typed[name] if exact else number(position)
    return candidates


class _Held(Specialised):
    """A program in which some coordinates are held, multiples of pi exactly."""

    def __init__(self, forms: Mapping[str, LinearForm]) -> None:
        super().__init__()
        self.forms = forms
        for name, form in forms.items():
            self.bound[name] = self.number(form.constant) + self.number(form.turns) * self.input("pi")
            self.bound[velocity_name(name)] = self.zero

    def sin_cos(self, angle: LinearForm) -> tuple[Node, Node]:
        total = LinearForm(turns=angle.turns)
        for name, coefficient in angle.coefficients:
            form = self.forms.get(name, LinearForm(((name, Fraction(1)),)))
            total = total + form.scaled(coefficient)
        if not total.constant:
            return super().sin_cos(total)
        return super().sin_cos_of(self._sum(total))

    def _sum(self, form: LinearForm) -> Node:
        total = self.number(form.constant)
        for name, coefficient in form.coefficients:
            total = total + self.number(coefficient) * self.input(name)
        return total + self.number(form.turns) * self.input("pi") if form.turns else total


def _pushed(
    scenario: Scenario, equations: Programs, candidates: Mapping[str, Expression]
) -> tuple[set[str], Certainty]:
    """The candidates whose forcing or coupling does not vanish, and how zero was decided."""
    system = scenario.system
    forms = {name: form for name, value in candidates.items() if (form := linear_form(value)) is not None}
    fresh = _Held(forms)
    for name, value in scenario.parameters.items():
        if value == 0:
            fresh.bound[name] = fresh.zero
    owners: list[str] = []
    nodes: list[Node] = []
    for i, name in enumerate(system.coordinates):
        if name in forms:
            coupling = [equations.mass_matrix[i][j] for j, other in enumerate(system.coordinates) if other not in forms]
            for node in (equations.forcing[i], *coupling):
                owners.append(name)
                nodes.append(node)
    pushed = set(candidates) - forms.keys()
    left = [
        (name, node)
        for name, node in zip(owners, substituted(equations.program, nodes, fresh), strict=True)
        if not fresh.vanishes(node)
    ]
    if not left:
        return pushed, Certainty.PROVED
    ring = ring_of(held(system, candidates))
    try:
        values = fresh.evaluate([node for _, node in left], ring_environment(held(system, candidates), ring), ring)
        how = Certainty.PROVED
        moved = {name for (name, _), value in zip(left, values, strict=True) if not ring.reduce(value).is_zero()}
    except NOT_THERE:
        how = Certainty.VERIFIED
        moved = _moved_somewhere(system, candidates, fresh, left, ring)
    return pushed | moved, how


def _moved_somewhere(
    system: System, candidates: Mapping[str, Expression], fresh: _Held, left: list[tuple[str, Node]], ring: Ring
) -> set[str]:
    """Those whose values are not zero at every one of some random exact states; all of them where that fails."""
    moved: set[str] = set()
    if ring.kinked:  # what vanishes at some states may come later
        return set(candidates)
    try:
        for state in rational_states(held(system, candidates), ring, FEWEST_STATES):
            values = fresh.evaluate([node for _, node in left], state.values, state.numbers)
            moved |= {name for (name, _), value in zip(left, values, strict=True) if value != 0}
    except NOT_THERE:
        return {name for name, _ in left}
    return moved


def without(scenario: Scenario, values: Mapping[str, Expression]) -> Scenario:
    """The scenario of the system in which the coordinates are held."""
    remaining = [place for place, name in enumerate(scenario.system.coordinates) if name not in values]
    return replace(
        scenario,
        system=held(scenario.system, values),
        positions=tuple(scenario.positions[place] for place in remaining),
        velocities=tuple(scenario.velocities[place] for place in remaining),
    )


def held(system: System, values: Mapping[str, Expression]) -> System:
    """The system with q_i = values[i] (and q_i' = 0) put in everywhere and those coordinates taken out.

    Forces on a coordinate that is held do no work and are left out with it.  Whether the coordinates stay where they
    are held is another question (``resting``); claims about the whole system are dropped.
    """
    images: dict[str, Expression] = {}
    for name, value in values.items():
        images |= {name: value, velocity_name(name): ZERO, acceleration_name(name): ZERO}
    bodies = []
    for body in system.bodies:
        remaining = tuple(name for name in body.coordinates if name not in values)
        bodies.append(replace(put(body, images), coordinates=remaining))
    loads = [put(left, images) for load in system.loads if (left := load.without(values)) is not None]
    changes: dict[str, Any] = {
        "bodies": tuple(bodies),
        "loads": tuple(loads),
        "motion": tuple(put(e, images) for e in system.motion if e.coordinate not in values),
        "initial": tuple(put(e, images) for e in system.initial if e.coordinate not in values),
        "claims": (),
    }
    return replace(system, **changes)


#: A coordinate that is accelerated by more than this part of the greatest acceleration is pushed.
PUSHED = 1e-7

#: Random states at which accelerations are looked at before anything is proved.
STATES = 4


@dataclass(frozen=True)
class Reduced:
    """Coordinates of ``whole`` that rest, and the ``dynamics`` without them."""

    whole: Dynamics
    reduction: Reduction
    dynamics: Dynamics

    @property
    def names(self) -> tuple[str, ...]:
        """The coordinates that rest."""
        return tuple(self.reduction.values)

    @property
    def proved(self) -> bool:
        """Whether it is a theorem that they rest; only then may they be taken out."""
        return self.reduction.how is Certainty.PROVED

    @property
    def operations(self) -> tuple[int, int]:
        """What one right-hand side costs: of the whole system, and without the coordinates that rest."""
        return self.whole.right_hand_side.operations, self.dynamics.right_hand_side.operations


def reduced(dynamics: Dynamics) -> Reduced | None:
    """The largest set of coordinates that rest in this scenario taken out; None where all may move.

    Accelerations at some states tell first what is pushed, so that nothing is proved where nothing rests.
    """
    if all(dynamics.scenario.velocities) or dynamics.size < 2 or dynamics.constraints is not None or dynamics.in_states:
        return None
    try:
        unpushed = _unpushed(dynamics)
        reduction = resting(dynamics.scenario, among=unpushed) if unpushed else None
        if reduction is None:
            return None
        smaller = Reduced(dynamics, reduction, Dynamics(reduction.scenario))
        # Where what is left moves no mass, the whole system says when and where.
        assert smaller.dynamics.right_hand_side is not None
        return smaller
    except Failure:
        return None


def _unpushed(dynamics: Dynamics) -> Collection[str]:
    """Coordinates that start without velocity and are not accelerated at random states in which they all rest.

    A set that rests identically is never lost: with its members held their accelerations vanish at every state.
    """
    n, scenario = dynamics.size, dynamics.scenario
    rhs = compiled_kernel(dynamics, "right_hand_side")
    start = np.array([float(x) for x in scenario.state])
    source = Random(SEED)
    uniform = [[source.uniform(-1, 1) for _ in range(STATES)] for _ in range(2 * n)]
    moved = np.array(uniform) * (0.5 + np.abs(start[:, None]))
    moved[:, 0] = 0.0
    times = np.array([0.0, *(source.random() for _ in range(STATES - 1))])
    resting_now = np.array([velocity == 0 for velocity in scenario.velocities])
    while np.any(resting_now):
        held = np.concatenate((resting_now, resting_now))
        states = start[:, None] + np.where(held[:, None], 0.0, moved)
        with np.errstate(all="ignore"):
            accelerations = np.abs(rhs(np.vstack([times, states]))[n:])
        finite = accelerations[:, np.all(np.isfinite(accelerations), axis=0)]
        pushed = np.max(finite, axis=1, initial=0.0) > PUSHED * np.max(finite, initial=0.0)
        if not np.any(pushed & resting_now):
            break
        resting_now &= ~pushed
    return [name for name, rests in zip(scenario.system.coordinates, resting_now, strict=True) if rests]
