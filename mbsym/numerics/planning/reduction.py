"""Coordinates that stay where they start: a spatial system that moves in a plane is integrated in that plane.

Let S be coordinates with q_S' = 0 at the start.  If with q_S held, q_S' = 0, the forcing f_S and the part M_SF of the
mass matrix that couples S to the free coordinates F vanish identically in (q_F, q_F', t), then q_S'' = 0 solves

    M_SS q_S'' + M_SF q_F'' = f_S,

and by uniqueness the motion stays there.  The largest such S is found by dropping, again and again, what is pushed.
Zero is decided in the ring (``proved``); where there is no closed form, at random exact states (``verified``).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import NOT_THERE, Failure
from mbsym.algebra.program import Node
from mbsym.algebra.ring import Ring
from mbsym.expressions.angles import LinearForm, linear_form
from mbsym.expressions.tree import ZERO, Expression, number
from mbsym.mechanics.programs import Programs, programs
from mbsym.mechanics.states import rational_states
from mbsym.mechanics.variables import ring_environment, ring_of
from mbsym.model.substitution import put
from mbsym.model.system import System, acceleration_name, velocity_name
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.specialise import Specialised, substituted

#: So many random exact states must agree where zero is not decided in the ring.
STATES = 3


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
        found = programs(system, ring_of(system))
    except Failure:
        return None
    how = Certainty.PROVED
    while candidates:
        pushed, how = _pushed(scenario, found, candidates)
        if not pushed:
            break
        candidates = {name: value for name, value in candidates.items() if name not in pushed}
    if not candidates or len(candidates) == len(system.coordinates):
        return None
    return Reduction(candidates, how, without(scenario, candidates))


def _candidates(scenario: Scenario) -> dict[str, Expression]:
    """Coordinates that start without velocity, with their positions as the description gives them."""
    found = {}
    for name, position, velocity in zip(
        scenario.system.coordinates, scenario.positions, scenario.velocities, strict=True
    ):
        if velocity == 0:
            form = linear_form(scenario.typed[name]) if name in scenario.typed else None
            exact = form is not None and not form.coefficients
            found[name] = scenario.typed[name] if exact else number(position)
    return found


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


def _pushed(scenario: Scenario, found: Programs, candidates: Mapping[str, Expression]) -> tuple[set[str], Certainty]:
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
            coupling = [found.mass_matrix[i][j] for j, other in enumerate(system.coordinates) if other not in forms]
            for node in (found.forcing[i], *coupling):
                owners.append(name)
                nodes.append(node)
    pushed = set(candidates) - forms.keys()
    left = [
        (name, node)
        for name, node in zip(owners, substituted(found.program, nodes, fresh), strict=True)
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
        for state in rational_states(held(system, candidates), ring, STATES):
            values = fresh.evaluate([node for _, node in left], state.values, state.numbers)
            moved |= {name for (name, _), value in zip(left, values, strict=True) if value != 0}
    except NOT_THERE:
        return {name for name, _ in left}
    return moved


def without(scenario: Scenario, values: Mapping[str, Expression]) -> Scenario:
    """The scenario of the system in which the coordinates are held."""
    kept = [place for place, name in enumerate(scenario.system.coordinates) if name not in values]
    return replace(
        scenario,
        system=held(scenario.system, values),
        positions=tuple(scenario.positions[place] for place in kept),
        velocities=tuple(scenario.velocities[place] for place in kept),
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
        kept = tuple(name for name in body.coordinates if name not in values)
        bodies.append(replace(put(body, images), coordinates=kept))
    loads = [put(left, images) for load in system.loads if (left := load.without(values)) is not None]
    changes: dict[str, Any] = {
        "bodies": tuple(bodies),
        "loads": tuple(loads),
        "motion": tuple(put(e, images) for e in system.motion if e.coordinate not in values),
        "initial": tuple(put(e, images) for e in system.initial if e.coordinate not in values),
        "claims": (),
    }
    return replace(system, **changes)
