"""Reactions in joints: what the joint of a body transmits to it, as formulas in q, q', q'' and the multipliers.

    R = R_0(q, q', q'', t) + sum lambda_i R_i(q, t)

force and moment about the connection point O_k, in the axes of the body (``mbsym.mechanics.reactions``).

Forces of constraints may be in balance with each other, J^T y = 0 with y not 0 (a third bar, two pins on one axis, a
row that says 0 = 0 for a planar loop): then lambda + mu y are multipliers for any mu, and what is determined of R are
those combinations of its components to which no y adds anything,

    R + mu sum y_i R_i.

The second route releases the joint: with six more coordinates there (three displacements, three turns) d'Alembert's
principle in inertial axes gives, along each of them at rest, the force or moment that the joint had to supply.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from flint import ctx

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import Failure
from mbsym.algebra.matrices import determinant
from mbsym.algebra.ring import Polynomial
from mbsym.algebra.vectors import Vector
from mbsym.expressions.message import Message
from mbsym.expressions.tree import ZERO, Name, add
from mbsym.formulas.formula import Column, Shown, column
from mbsym.mechanics import reactions as recursion
from mbsym.mechanics.constraints.ranks import eliminated, is_certain
from mbsym.mechanics.constraints.rows import RowName
from mbsym.mechanics.constraints.states import PRECISION, Manifold
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.oracle import Oracle, State
from mbsym.mechanics.states import Oracles
from mbsym.model.system import Body, Rotation, System, acceleration_name, velocity_name
from mbsym.problems.checks import Check, Pair, compare

if TYPE_CHECKING:
    from mbsym.mechanics.constraints.programs import ConstrainedPrograms
    from mbsym.problems.constraints.result import Constraints

#: At so many states on the constraints is looked what forces in balance add; formulas of more terms are not written.
STATES, MOST_TERMS = 3, 24

D_ALEMBERT = "d'Alembert's principle with the joint released"


@dataclass(frozen=True, repr=False)
class Balance(Shown):
    """Forces of ``rows`` that are in balance with each other, and the ``components`` of a reaction that they change.

    ``added`` is what they add with the factor 1, force and moment; None where the formulas would be long.
    """

    rows: tuple[RowName, ...]
    components: tuple[int, ...]
    added: tuple[Column, Column] | None


@dataclass(frozen=True, repr=False)
class Reaction(Shown):
    """Of one joint; ``per_multiplier`` has (force, moment) for lambda = 1 of each independent row.

    Formulas are those without forces of the other rows.  ``balances`` add to them: the joint is statically
    indeterminate where there are any, and ``combinations`` is how many combinations of its ``undetermined`` components
    are determined all the same.
    """

    counted = ("force", "moment")

    body: str
    force: Column
    moment: Column
    per_multiplier: tuple[tuple[Column, Column], ...]
    balances: tuple[Balance, ...] = ()
    combinations: int = 0

    @property
    def undetermined(self) -> tuple[int, ...]:
        """Components that are not determined: 0, 1, 2 of the force, 3, 4, 5 of the moment."""
        return tuple(sorted({k for balance in self.balances for k in balance.components}))


def reactions(scene: Scene, tied: Constraints, programs: ConstrainedPrograms) -> tuple[Reaction, ...]:
    """The reactions that the description asks for (scene over the ring).  Raises NoClosedForm."""
    own = [tied.names[i] for i in tied.independent]
    others = [name for name in _all_rows(scene) if name not in own]
    rows = [(name.constraint, name.component) for name in (*own, *others)]
    unbalanced = [_reaction(scene, reaction) for reaction in recursion.reactions(scene, scene.system.reactions, rows)]
    balanced = _Balances(scene, tied, programs, (*own, *others))
    return tuple(
        replace(reaction, per_multiplier=reaction.per_multiplier[: len(own)], **balanced.of(reaction.per_multiplier))
        for reaction in unbalanced
    )


def _reaction(scene: Scene, reaction: recursion.Reaction) -> Reaction:
    def reduced(x: Vector) -> Column:
        return column(scene.ring, [scene.ring.reduce(y) for y in x])

    parts = tuple((reduced(force), reduced(moment)) for force, moment in reaction.per_multiplier)
    return Reaction(reaction.body, reduced(reaction.force), reduced(reaction.moment), parts)


def _all_rows(scene: Scene) -> list[RowName]:
    """Those that say nothing of the coordinates, too: the joints of a planar loop may press against each other."""
    from mbsym.mechanics.constraints.rows import constraint_rows

    return [row.name for row in constraint_rows(scene)]


class _Balances:
    """The y with J^T y = 0, one for each row that is not independent, and what they add to reactions."""

    def __init__(self, scene: Scene, tied: Constraints, programs: ConstrainedPrograms, rows: Sequence[RowName]) -> None:
        self.ring, self.tied, self.rows = scene.ring, tied, tuple(rows)
        with ctx.workprec(PRECISION):
            self.states = list(Manifold(scene.system.without_speeds, scene.ring, programs).states(STATES))
            jacobian = [x for row in programs.jacobian for x in row]
            n = len(scene.system.coordinates)
            values = [
                programs.tree.program.evaluate(jacobian, point.state.values, point.state.numbers)
                for point in self.states
            ]
        places = {name: i for i, name in enumerate(programs.names)}
        self.tables = [
            {name: flat[i * n : (i + 1) * n] for name, i in places.items()} for flat in values
        ]  # J by rows at every state
        follow = {redundant.name: redundant.from_rows for redundant in tied.redundant}
        self.sets = [(name, *follow.get(name, ())) for name in rows[len(tied.independent) :]]

    def of(self, parts: Sequence[tuple[Column, Column]]) -> dict[str, Any]:
        """``balances`` and ``combinations`` of one joint, by what every row adds to it for lambda = 1."""
        added = {
            name: [x.polynomial for x in (*force, *moment)]
            for name, (force, moment) in zip(self.rows, parts, strict=True)
        }
        with ctx.workprec(PRECISION):
            per_state: list[list[list[Any]]] = [[] for _ in self.states]
            balances = []
            for names in self.sets:
                changes = [self._added(k, names, added) for k in range(len(self.states))]
                components = tuple(c for c in range(6) if any(is_certain(change[c]) for change in changes))
                if components:
                    balances.append(Balance(names, components, self._formulas(names, added, components)))
                    for table, change in zip(per_state, changes, strict=True):
                        table.append([change[c] for c in range(6)])
            rank = max((eliminated(table, range(6)).rank for table in per_state), default=0)
        undetermined = {c for balance in balances for c in balance.components}
        return {"balances": tuple(balances), "combinations": len(undetermined) - rank}

    def _added(self, k: int, names: Sequence[RowName], added: Mapping[RowName, Sequence[Polynomial]]) -> list[Any]:
        """sum y_i R_i at a state, with y = 1 for the first row."""
        state, table = self.states[k].state, self.tables[k]
        carry = Carrier(self.ring, state.numbers, state.values)
        total = [carry(x) for x in added[names[0]]]
        if len(names) > 1:
            rows = [[*(table[name][c] for name in names[1:]), table[names[0]][c]] for c in range(len(table[names[0]]))]
            done = eliminated(rows, range(len(names) - 1))
            for i, column_ in done.pivots:
                factor = done.rows[i][len(names) - 1]
                own = [carry(x) for x in added[names[1 + column_]]]
                total = [x - factor * y for x, y in zip(total, own, strict=True)]
        return total

    def _formulas(
        self, names: Sequence[RowName], added: Mapping[RowName, Sequence[Polynomial]], components: Sequence[int]
    ) -> tuple[Column, Column] | None:
        """The same with y by minors of J, which have no denominators; None where that is long."""
        ring = self.ring
        try:
            weights = self._minors(names)
            total = []
            for c in range(6):
                whole = ring.dot(weights, [added[name][c] for name in names]) if c in components else ring.zero
                total.append(ring.reduce(whole))
        except (Failure, ZeroDivisionError, StopIteration):
            return None
        if sum(map(len, total)) > MOST_TERMS or not any(total):
            return None
        return column(ring, total[:3]), column(ring, total[3:])

    def _minors(self, names: Sequence[RowName]) -> list[Polynomial]:
        ring, tied = self.ring, self.tied
        if len(names) == 1:
            return [ring.one]
        numbers = [tied.names.index(name) for name in names]
        table = self.tables[0]
        done = eliminated([table[name] for name in names[1:]], range(len(table[names[0]])))
        if tied.in_speeds or done.rank < len(names) - 1:
            raise StopIteration
        rows = [[tied.jacobian[i, k].polynomial for k in sorted(done.columns)] for i in numbers]
        minors = [determinant(ring, rows[:k] + rows[k + 1 :]) for k in range(len(rows))]
        common = ring.zero
        for x in minors:
            common = ring.common_factor(common, x)
        quotients = [x if common.is_constant() else divmod(x, common)[0] for x in minors]
        return [-x if k % 2 else x for k, x in enumerate(quotients)]


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
    truth: Oracles, listed: Sequence[Reaction], tied: Constraints, programs: ConstrainedPrograms
) -> Check:
    """Forces and moments by the recursion against what the released joint would have to be held with.

    With constraints at states that keep them: points that coincide are one only there.
    """
    system, ring = truth.system, truth.ring
    routes = ("Newton-Euler recursion", D_ALEMBERT)

    def at(state: State) -> list[Pair]:
        return [pair for reaction in listed for pair in _pairs(system, ring, reaction, state, tied)]

    if not tied.names:
        return compare(truth, "reactions", routes, lambda oracle: at(oracle.state), states=2)
    from mbsym.mechanics.speeds import SpeedForm
    from mbsym.problems.constraints.checks import compared_on_manifold

    return compared_on_manifold("reactions", routes, SpeedForm(system, ring), programs, lambda point: at(point.state))


def _pairs(system: System, ring: Any, reaction: Reaction, state: State, tied: Constraints) -> list[Pair]:
    loose, names = released(system, reaction.body)
    numbers, zero = state.numbers, state.numbers.zero
    held = {**state.values}
    for name in names:
        held |= {name: zero, velocity_name(name): zero, acceleration_name(name): zero}
    oracle = Oracle(loose, State(_with_zero_angles(numbers, names[3:]), held))
    axes = oracle.moving.axes
    before = axes[system.body(reaction.body).attached_to]
    own = axes[reaction.body]
    carry = Carrier(ring, numbers, state.values)
    compared: list[Pair] = []
    along: list[tuple[str, Any, list[Any]]] = [("", None, [oracle.residuals[name] for name in names])]
    if tied.names:
        from mbsym.mechanics.constraints.oracle import oracle_rows

        rows = oracle_rows(loose, oracle.state)
        places = [loose.coordinates.index(name) for name in names]
        for k, i in enumerate(tied.independent):
            row = tied.names[i]
            partials = rows[row.constraint][max(row.component - 1, 0)].partials
            along.append((row.label, k, [-partials[place] for place in places]))
    for label, k, values in along:
        force, moment = (reaction.force, reaction.moment) if k is None else reaction.per_multiplier[k]
        for what, mine, released_ in ((Message("force"), force, values[:3]), (Message("moment"), moment, values[3:])):
            inertial = [sum((before[i][j].a * released_[j] for j in range(3)), zero) for i in range(3)]
            for c in range(3):
                theirs = sum((own[i][c].a * inertial[i] for i in range(3)), zero)
                name = Message(
                    "[[what]] [[number]] in the joint of [[body]]", what=what, number=c + 1, body=reaction.body
                )
                name = Message("[[name]] per [[label]]", name=name, label=label) if label else name
                compared.append((name, carry(mine[c].polynomial), theirs))
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
