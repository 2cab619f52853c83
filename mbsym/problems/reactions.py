"""Reactions in joints: what the joint of a body transmits to it, as formulas in q, q', q'' and the multipliers.

    R = R_0(q, q', q'', t) + sum lambda_i R_i(q, t)

force and moment about the connection point O_k, in the axes of the body (``mbsym.mechanics.reactions``).

The second route releases the joint: with six more coordinates there (three displacements, three turns) d'Alembert's
principle in inertial axes gives, along each of them at rest, the force or moment that the joint had to supply.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from mbsym.algebra.evaluate import Carrier
from mbsym.expressions.tree import ZERO, Name, add
from mbsym.formulas.formula import Column, column
from mbsym.formulas.notebook import Shown
from mbsym.mechanics import reactions as recursion
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.oracle import Oracle, State
from mbsym.mechanics.states import Oracles
from mbsym.model.system import Body, Rotation, System, acceleration_name, velocity_name
from mbsym.problems.checks import Check, Pair, compare

if TYPE_CHECKING:
    from mbsym.mechanics.constraints.programs import ConstrainedPrograms
    from mbsym.problems.constraints.result import Constraints

D_ALEMBERT = "d'Alembert's principle with the joint released"


@dataclass(frozen=True, repr=False)
class Reaction(Shown):
    """Of one joint; ``per_multiplier`` has (force, moment) for lambda = 1 of each independent row."""

    body: str
    force: Column
    moment: Column
    per_multiplier: tuple[tuple[Column, Column], ...]

    @property
    def terms(self) -> int:
        """Terms of all its formulas."""
        return sum(x.terms for x in (*self.force, *self.moment))


def reactions(scene: Scene, tied: Constraints | None) -> tuple[Reaction, ...]:
    """The reactions that the description asks for (scene over the ring).  Raises NoClosedForm."""
    ring = scene.ring
    rows = [] if tied is None else [(tied.names[i].constraint, tied.names[i].component) for i in tied.independent]
    found = recursion.reactions(scene, scene.system.reactions, rows)
    return tuple(
        Reaction(
            one.body,
            column(ring, [ring.reduce(x) for x in one.force]),
            column(ring, [ring.reduce(x) for x in one.moment]),
            tuple(
                (column(ring, [ring.reduce(x) for x in force]), column(ring, [ring.reduce(x) for x in moment]))
                for force, moment in one.per_multiplier
            ),
        )
        for one in found
    )


def released(system: System, body: str) -> tuple[System, tuple[str, ...]]:
    """The system with six more coordinates in a joint: along the axes before it, and about them."""
    own = system.body(body)
    taken = {*system.coordinates, *system.parameter_names}
    stem = "release"
    while any(name.startswith(stem) for name in taken):
        stem += "d"
    names = tuple(f"{stem}{k}" for k in range(1, 7))
    x, y, z = (add(r, Name(name)) for r, name in zip(own.connection_point, names, strict=False))
    gap = Body(
        name=f"{body} released",
        attached_to=own.attached_to,
        rotation=Rotation((1, 2, 3), tuple(map(Name, names[3:]))),
        connection_point=(x, y, z),
        relative_velocity=None,
        mass_centre=(ZERO, ZERO, ZERO),
        mass=ZERO,
        inertia=None,
        coordinates=names,
    )
    loose = replace(own, attached_to=gap.name, connection_point=(ZERO, ZERO, ZERO), relative_velocity=None)
    place = system.bodies.index(own)
    # Coordinates of the connection point now move the released frame; nobody asks which body lists them.
    return replace(system, bodies=(*system.bodies[:place], gap, loose, *system.bodies[place + 1 :])), names


def check_reactions(
    truth: Oracles, found: Sequence[Reaction], tied: Constraints | None, programs: ConstrainedPrograms | None
) -> Check:
    """Forces and moments by the recursion against what the released joint would have to be held with.

    With constraints at states that keep them: points that coincide are one only there.
    """
    system, ring = truth.system, truth.ring
    routes = ("Newton-Euler recursion", D_ALEMBERT)

    def at(state: State) -> list[Pair]:
        return [pair for one in found for pair in _pairs(system, ring, one, state, tied)]

    if tied is None or programs is None:
        return compare(truth, "reactions", routes, lambda oracle: at(oracle.state), states=2)
    from mbsym.problems.constraints.checks import compared_on_manifold

    return compared_on_manifold("reactions", routes, system, ring, programs, lambda one: at(one.state))


def _pairs(system: System, ring: Any, one: Reaction, state: State, tied: Constraints | None) -> list[Pair]:
    loose, names = released(system, one.body)
    numbers, zero = state.numbers, state.numbers.zero
    held = {**state.values}
    for name in names:
        held |= {name: zero, velocity_name(name): zero, acceleration_name(name): zero}
    oracle = Oracle(loose, State(_with_zero_angles(numbers, names[3:]), held))
    axes = oracle.moving.axes
    before = axes[system.body(one.body).attached_to]
    own = axes[one.body]
    carry = Carrier(ring, numbers, state.values)
    compared: list[Pair] = []
    along: list[tuple[str, Any, list[Any]]] = [("", None, [oracle.residuals[name] for name in names])]
    if tied is not None:
        from mbsym.mechanics.constraints.oracle import oracle_rows

        rows = oracle_rows(loose, oracle.state)
        places = [loose.coordinates.index(name) for name in names]
        for k, i in enumerate(tied.independent):
            row = tied.names[i]
            partials = rows[row.constraint][max(row.component - 1, 0)].partials
            along.append((f" per {row.label}", k, [-partials[place] for place in places]))
    for label, k, values in along:
        force, moment = (one.force, one.moment) if k is None else one.per_multiplier[k]
        for what, mine, released_ in (("force", force, values[:3]), ("moment", moment, values[3:])):
            inertial = [sum((before[i][j].a * released_[j] for j in range(3)), zero) for i in range(3)]
            for c in range(3):
                theirs = sum((own[i][c].a * inertial[i] for i in range(3)), zero)
                compared.append(
                    (f"{what} {c + 1} in the joint of {one.body}{label}", carry(mine[c].polynomial), theirs)
                )
    return compared


def _with_zero_angles(numbers: Any, names: Sequence[str]) -> Any:
    """The same numbers, in which the angles of the release are zero."""
    from copy import copy

    changed = copy(numbers)
    if hasattr(numbers, "basic"):
        changed.basic = {**numbers.basic, **dict.fromkeys(names, (numbers.zero, numbers.one))}
        changed.denominators = {**numbers.denominators, **dict.fromkeys(names, 1)}
    if hasattr(numbers, "values"):
        changed.values = {**numbers.values, **dict.fromkeys(names, numbers.zero)}
    return changed
