"""Constraints of one scenario as numbers: their rows, which of them are kept, and how far a run strays from them.

    f(t, q) = 0  (holonomic rows, which come first),      g = J(t, q) q' + j(t, q) = 0  (all rows)

All rows are in the equations; which of them follow from others is found by orthogonalisation with pivots (rows measured
by the kinetic energy: J M^-1/2, each of length 1) at the initial position and at positions beside it on the same branch
of the constraints, since a rank may fall at single ones.  Positions count that are on the constraints for certain: off
them rows are independent that are not on them.

    drift of positions    max over rows of |f_i| / sum_k |J_ik| s_k          s_k:  the size of q_k in the motion
    drift of velocities   max over rows of |g_i| / sum_k |J_ik| s'_k         s'_k: that of q'_k

|J_ik| is the largest of the motion, the sum the largest of the rows of one constraint: both drifts are free of units.

In declared variables y = (s, u) with s' = Y u + y0 rows are g = J u + j, ways that a position can go are Y z, and
drifts of positions are measured by df/ds; coordinates and their velocities are the case Y = 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from mbsym.algebra.derivative import jacobian
from mbsym.algebra.program import Node, Program
from mbsym.algebra.ring import Ring
from mbsym.mechanics.constraints.dependence import Dependent, counted_anew, dependent_sets
from mbsym.mechanics.constraints.dynamics import (
    Chosen,
    ConstrainedDynamics,
    Kept,
    conditions,
    conditions_in_states,
    constrained_dynamics,
    empty_rows,
    state_dynamics,
)
from mbsym.mechanics.constraints.rows import Row, RowName
from mbsym.mechanics.speed_programs import restoring
from mbsym.mechanics.speeds import SpeedForm
from mbsym.mechanics.variables import angle_denominators
from mbsym.model.constraints import listed
from mbsym.model.system import velocity_name
from mbsym.numerics.kernels import arrays
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.scenario import Scenario, Specialised, bound, substituted

if TYPE_CHECKING:
    from mbsym.numerics.dynamics import Dynamics

#: A row of length 1 of which others leave no more than this follows from them.
DEPENDENT = 1e-9

#: Between these a row is neither: the position is not on the constraints for certain, or too near to a singular one.
CERTAIN = 1e-6

#: Positions beside the initial one at which the rank is looked at, and how far away, in radians or as parts.
BESIDE, AWAY = 3, 0.05

#: Positions about the start at which rows are measured, each coordinate within its extent.
ABOUT = 5

#: The least eigenvalue of M with ones on its diagonal that is not zero to roundings.
MASSLESS = 1e-13

#: A row of length 1 that is bent by less than this, in the units of the coordinates, follows others all along.
OBSTRUCTED = 1e-3

#: How many times nearer to a singular position than the start states may be computed: S has lost six digits.
NEAREST = 1e6

#: Newton's steps to lengths of 1 after a position was moved by as much as ``AWAY``.
RESTORED = 3

#: A correction of this part of the ``extents`` ends Newton's iteration, or one that falls no more and is at most
#: rounding; so many steps of it at most.
SETTLED, ROUNDED, STEPS = 1e-13, 1e-10, 40


@dataclass(frozen=True)
class Values:
    """At one point: f (h,), g (r,), J (r, n), and df/ds (h, p) of positions: the first rows of J for Y = 1."""

    positions: Any
    velocities: Any
    partials: Any
    gradients: Any


class Flow:
    """How positions s of a scenario in declared variables move: s' = Y u + y0, and s with lengths of 1."""

    def __init__(
        self, form: SpeedForm, program: Program, turned: Sequence[Node], numbers: Specialised, inputs: tuple[str, ...]
    ) -> None:
        self._shape = len(form.positions), len(form.speeds)
        self._turned = arrays.kernel(Code(numbers, inputs, tuple(substituted(program, turned, numbers))))
        moved = restoring(program, form.system)
        nodes = [moved.get(x.name, program.zero) for x in form.positions]
        #: (t, s, u) -> what leads s back to lengths of 1.
        self.restoring = Code(numbers, inputs, tuple(substituted(program, nodes, numbers)))
        self._restored = arrays.kernel(self.restoring)

    def turned(self, t: float, state: Any) -> Any:
        """Y (p, n)."""
        return self._turned(np.concatenate(([t], state))).reshape(self._shape)

    def displaced(self, t: float, state: Any, way: Any) -> Any:
        """The state moved by Y way."""
        moved, p = np.array(state, dtype=float), self._shape[0]
        moved[:p] += self.turned(t, moved) @ way
        for _ in range(RESTORED):
            moved[:p] += self._restored(np.concatenate(([t], moved)))
        return moved


class Constraints:
    """The rows of a scenario that say something, and the equations with those of them that are independent.

    ``places`` are the positions p of a state, ``size`` its velocities n.
    """

    def __init__(
        self, scenario: Scenario, ring: Ring, apart: bool, masses: Code, form: SpeedForm | None = None
    ) -> None:
        self._scenario, self._ring, self._apart, self._form = scenario, ring, apart, form
        system = scenario.system
        self.places, self.size = len(system.coordinates), len(system.velocities)
        self.inputs = ("t", *system.coordinates, *system.velocities)
        equations = conditions(system, ring) if form is None else conditions_in_states(form)
        self.flow = (
            None if form is None else Flow(form, equations.program, equations.turned, bound(scenario), self.inputs)
        )
        self._at_rest, self._rest_program = equations.at_rest, equations.program
        self._listed(scenario, equations.program, equations.rows)
        # A row that seems to say nothing at some place is looked at in the ring, which is dearer.
        source = np.random.default_rng(3)
        place = self.at(0.3, source.uniform(0.3, 0.9, self.places + self.size))
        nothing = np.max(np.abs(place.partials), axis=1) <= 1e-10 * self.slopes(np.abs(place.partials), 1.0)
        empty = empty_rows(system, ring, [row for row, none in zip(equations.rows, nothing, strict=True) if none], form)
        if empty:
            self._listed(scenario, equations.program, [row for row in equations.rows if row.name not in empty])
        self._masses = arrays.kernel(masses)

    def from_start(self, scenario: Scenario) -> Constraints:
        """The same rows from another initial state; nothing is kept of what was found about this one."""
        other = copy(self)
        other._scenario = scenario
        for name, kind in vars(Constraints).items():
            if isinstance(kind, cached_property):
                other.__dict__.pop(name, None)
        return other

    def _listed(self, scenario: Scenario, program: Program, rows: Sequence[Row]) -> None:
        self.names: tuple[RowName, ...] = tuple(row.name for row in rows)
        self.holonomic = sum(name.holonomic for name in self.names)
        positions = [row.position for row in rows if row.position is not None]
        nodes = [*positions, *(row.velocity for row in rows), *(slope for row in rows for slope in row.partials)]
        if self._form is not None:
            names = [program.input(x.name) for x in self._form.positions]
            nodes += [slope for row in jacobian(program, positions, names) for slope in row]
        numbers = bound(scenario)
        self.code = Code(numbers, self.inputs, tuple(substituted(program, nodes, numbers)))
        self._kernel = arrays.kernel(self.code)

    def __len__(self) -> int:
        return len(self.names)

    def at(self, t: float, state: Any) -> Values:
        """f, g and J at one state (q, q')."""
        return self._parted(self._kernel(np.concatenate(([t], np.asarray(state, dtype=float)))))

    def along(self, times: Any, states: Any) -> Values:
        """f (h, m), g (r, m), J (r, n, m) at states in columns."""
        return self._parted(self._kernel(np.vstack([times, np.asarray(states, dtype=float)])))

    def _parted(self, values: Any) -> Values:
        h, r, n = self.holonomic, len(self.names), self.size
        partials = values[h + r : h + r + r * n].reshape(r, n, *values.shape[1:])
        gradients = partials[:h]
        if self._form is not None:
            gradients = values[h + r + r * n :].reshape(h, self.places, *values.shape[1:])
        return Values(values[:h], values[h : h + r], partials, gradients)

    # --- ways that a position can go ---

    def displaced(self, t: float, state: Any, way: Any) -> Any:
        """The state with its position moved by Y way (n,)."""
        moved = np.array(state, dtype=float)
        if self.flow is not None:
            return self.flow.displaced(t, moved, way)
        moved[: self.places] += way
        return moved

    def turned(self, t: float, state: Any, way: Any) -> Any:
        """Y way (p,)."""
        return way if self.flow is None else self.flow.turned(t, state) @ way

    def towards(self, t: float, state: Any, goal: Any) -> Any:
        """The way (n,) of least squares from the position of a state to that of another."""
        way = np.asarray(goal, dtype=float)[: self.places] - state[: self.places]
        return way if self.flow is None else np.linalg.lstsq(self.flow.turned(t, state), way, rcond=None)[0]

    def extents(self, state: Any) -> Any:
        """What ways are measured by (n,), whatever the units: of angles and of speeds that no position has for its own

            s_i = max(1, |q_i|),      of others      s_i = max(|q_i|, max_j sqrt(M_jj/M_ii)),  j of the former

        so that what is at 0 has the size that gives it as much inertia as a turn by 1; without such j it is the largest
        |q_j| that counts for 1.  Where nothing tells a size it is that of the largest other one, or 1.
        """
        state = np.asarray(state, dtype=float)
        own = np.array([0.0 if place is None else abs(state[place]) for place in self.own_places])
        turns = np.array([place is None or place in self._bounded for place in self.own_places], dtype=bool)
        inertia = self._inertia(state)
        usual = np.max(np.where(turns, inertia, 0.0), initial=0.0) or np.max(own * inertia, initial=0.0)
        sizes = np.where(turns, np.maximum(own, 1.0), np.maximum(own, _shares(usual, inertia)))
        return np.where(sizes > 0, sizes, np.max(sizes[~turns], initial=0.0) or 1.0)

    def sizes(self, state: Any) -> Any:
        """What a state is measured by (p + n,): positions by ``extents``, components of length 1 by 1, velocities by
        max(|v_i|, max_j |v_j| sqrt(M_jj/M_ii))."""
        position_sizes, velocities = np.ones(self.places), np.abs(np.asarray(state, dtype=float)[self.places :])
        for place, extent in zip(self.own_places, self.extents(state), strict=True):
            if place is not None:
                position_sizes[place] = extent
        inertia = self._inertia(state)
        usual = np.max(velocities * inertia, initial=0.0)
        return np.concatenate([position_sizes, np.maximum(velocities, _shares(usual, inertia))])

    def _inertia(self, state: Any) -> Any:
        """sqrt(M_ii) (n,), 0 where it is no number."""
        masses = self._masses(np.concatenate(([0.0], np.asarray(state, dtype=float))))[:: self.size + 1]
        return np.sqrt(np.where(np.isfinite(masses), np.maximum(masses, 0.0), 0.0))

    @cached_property
    def _bounded(self) -> frozenset[int]:
        """Places of angles."""
        angles = angle_denominators(self._scenario.system)
        return frozenset(place for place, name in enumerate(self._scenario.system.coordinates) if name in angles)

    @cached_property
    def own_places(self) -> tuple[int | None, ...]:
        """For every velocity the position that is its own, which no other moves; None where there is none."""
        system = self._scenario.system
        own = {velocity_name(name): place for place, name in enumerate(system.coordinates)}
        return tuple(own.get(name) for name in system.velocities)

    def at_rest(self, program: Specialised) -> Specialised:
        """The program with velocities at which nothing moves but what is prescribed: 0, or the drifts s0 of speeds."""
        system = self._scenario.system
        values = substituted(self._rest_program, self._at_rest, program) if self._at_rest else []
        values = values or [program.number(0)] * self.size
        program.bound.update(zip(system.velocities, values, strict=True))
        return program

    def slopes(self, partials: Any, sizes: Any) -> Any:
        """What rows are measured by: sum_k |J_ik| s_k, the largest of the rows that belong to one constraint.

        ``partials`` are |J| of shape (r, n), all rows or the first of them.
        """
        own = np.sum(partials * sizes, axis=1)
        numbers = np.array([name.constraint for name in self.names[: len(own)]])
        return np.array([np.max(own[numbers == number]) for number in numbers])

    def weights(self, t: float, state: Any) -> Any:
        """M^-1/2 as the inverse of a triangular root C of M = C C^T, transposed: q = weights y has M-length |y|.

        Where M is not positive definite, what moves no mass has the least mass there is.
        """
        n = self.size
        masses = self._masses(np.concatenate(([t], np.asarray(state, dtype=float)))).reshape(n, n)
        try:
            return np.linalg.inv(np.linalg.cholesky(masses)).T
        except np.linalg.LinAlgError:
            values, vectors = np.linalg.eigh(masses)
            positive = values[values > 1e-12 * values[-1]]
            return vectors / np.sqrt(np.maximum(values, positive[0] if len(positive) else 1.0))

    @cached_property
    def _start(self) -> Any:
        return np.array([float(x) for x in self._scenario.state])

    @cached_property
    def _ranked(self) -> list[tuple[list[int], Any]]:
        """(independent rows, all rows) at the positions that are looked at, where most are independent."""
        candidates = [(rows := self._of_length_one(0.0, place), self._orthogonalised(rows)[0]) for place in self.near]
        rank = max(len(independent) for _, independent in candidates)
        return [(independent, rows) for rows, independent in candidates if len(independent) == rank]

    @cached_property
    def kept(self) -> tuple[int, ...]:
        """The numbers of rows that are independent beside the start, in increasing order: as many as the rank."""
        return tuple(sorted(self._ranked[0][0]))

    @property
    def rank(self) -> int:
        """Rows that are independent on this branch of the constraints, but for singular positions."""
        return len(self.kept)

    def dependent(self, count: int) -> tuple[Dependent, ...]:
        """Those of the first ``count`` rows that follow from others, in sets that hang together."""
        relations: list[set[int]] = []
        independent = [i for i in self._ranked[0][0] if i < count]
        for found, rows in self._ranked:
            own = [i for i in found if i < count]
            for i in (i for i in range(count) if i not in own):
                parts = np.linalg.lstsq(rows[own].T, rows[i], rcond=None)[0]
                relations.append({i, *(k for k, part in zip(own, parts, strict=True) if abs(part) > CERTAIN)})
        return dependent_sets(relations, independent)

    @cached_property
    def chosen(self) -> Chosen:
        """All rows, and which follow from others; of too many that hang together the independent ones alone."""
        sets = self.dependent(len(self.names)), self.dependent(self.holonomic)
        rows, counted = counted_anew(range(len(self.names)), self.kept, *sets)
        usual = self.usual if sets[0] else {}
        kept = tuple((self.names[k].constraint, self.names[k].component) for k in rows)
        return Chosen(kept, counted[0], counted[1], usual)

    @cached_property
    def usual(self) -> dict[Kept, Fraction]:
        """S_ii of single rows at the median of positions about the start, whatever these keep; as powers of 2."""
        source, state = np.random.default_rng(11), np.array([float(x) for x in self._scenario.state])
        ways = [source.uniform(-1, 1, self.size) * self.extents(state) for _ in range(ABOUT)]
        with np.errstate(all="ignore"):
            places = [self.displaced(0.0, state, way) for way in ways]
            rows = [self.at(0.0, place).partials @ self.weights(0.0, place) for place in places]
        found: dict[Kept, Fraction] = {}
        for name, sizes in zip(self.names, np.transpose([np.sum(row**2, axis=1) for row in rows]), strict=True):
            positive = sizes[np.isfinite(sizes) & (sizes > 0)]
            if not name.component and len(positive):
                found[name.constraint, 0] = Fraction(2) ** round(float(np.log2(np.median(positive))))
        return found

    @property
    def redundant(self) -> tuple[RowName, ...]:
        """The rows that follow from others, as far as positions near the initial one tell."""
        return tuple(name for number, name in enumerate(self.names) if number not in self.kept)

    @property
    def freedom(self) -> int:
        """Velocities that remain free: coordinates less independent rows."""
        return self.size - len(self.kept)

    @cached_property
    def more_is_held(self) -> bool:
        """Whether the initial position is ``obstructed``: less moves than the rank tells."""
        return self.obstructed(self._start)

    def obstructed(self, state: Any) -> bool:
        """Whether the rows stop at second order what they allow: y J = 0 and  y (dJ/dq z) z != 0,  J z = 0.

        J q'' = -(dJ/dq q') q' has no solution then for q' = z.  Where J has a constant rank on the configurations near
        by there are no such z.  By differences, along some z; False of rows that move by themselves.
        """
        count, n, source = len(self.names), self.size, np.random.default_rng(7)
        if not self.steady:
            return False
        sizes, small = self.extents(state), AWAY / 10
        rows = self.at(0.0, state).partials * sizes
        # A row may vanish in passing, but for roundings: then it is measured by what it is beside the position.
        beside = self.at(0.0, self.displaced(0.0, state, AWAY * sizes * source.choice((-1, 1), n))).partials * sizes
        lengths = _positive(np.maximum(*(np.linalg.norm(x, axis=1) for x in (rows, AWAY * beside))))
        left, values, right = np.linalg.svd(rows / lengths[:, None])
        rank = int(np.sum(values > DEPENDENT * values[0]))
        if rank in (count, n):
            return False
        for _ in range(BESIDE):
            way = right[rank:].T @ source.normal(size=n - rank)
            step = small * sizes * way / np.max(np.abs(way))
            ahead, behind = (self.at(0.0, self.displaced(0.0, state, sign * step)).partials for sign in (1, -1))
            bent = (ahead - behind) @ step / lengths / (2 * small**2)
            if np.linalg.norm(left[:, rank:].T @ bent) > OBSTRUCTED:
                return True
        return False

    def independent(self, t: float, state: Any) -> list[int]:
        """Rows that are independent at a position: holonomic ones first, of them the most independent one next."""
        return self._orthogonalised(self._of_length_one(t, state))[0]

    def _of_length_one(self, t: float, state: Any) -> Any:
        """J M^-1/2, each row of length 1, or 0 where it vanishes beside those of its constraint."""
        rows = self.at(t, state).partials @ self.weights(t, state)
        lengths = np.linalg.norm(rows, axis=1)
        normalised = rows / np.where(lengths > 0, lengths, 1.0)[:, None]
        normalised[lengths <= DEPENDENT * self.slopes(lengths[:, None], 1.0)] = 0.0
        return normalised

    def _orthogonalised(self, left: Any) -> tuple[list[int], float]:
        """Of rows of length 1 the independent ones, and what others leave at least of one of them."""
        independent, least = [], 1.0
        for group in (range(self.holonomic), range(self.holonomic, len(self.names))):
            open_ = list(group)
            while open_:
                sizes = np.linalg.norm(left[open_], axis=1)
                # Of rows that are as good as each other the first one, whatever the roundings.
                place = int(np.argmax(sizes >= 0.5 * np.max(sizes)))
                if sizes[place] <= DEPENDENT:
                    break
                least = min(least, float(sizes[place]))
                number = open_.pop(place)
                independent.append(number)
                direction = left[number] / np.linalg.norm(left[number])
                for _ in range(2):  # twice is enough
                    left = left - np.outer(left @ direction, direction)
        return independent, least

    @cached_property
    def near(self) -> list[Any]:
        """The initial position and some beside it to which the constraints let it move: on its way, if it has one."""
        state = self._start
        source, n, places = np.random.default_rng(5), self.size, [state]
        velocities = state[self.places :]
        weights = self.weights(0.0, state)
        rows = self.at(0.0, state).partials
        for _ in range(BESIDE):
            sizes = AWAY * source.uniform(0.5, 1.0, n) * self.extents(state)
            way = sizes * source.choice((-1, 1), n)
            if self.holonomic and np.any(velocities):  # where branches meet the velocity tells which it is
                way = velocities * np.min(sizes) / np.max(np.abs(velocities)) * source.choice((-1, 1))
            elif self.holonomic:  # else any way that all rows allow
                way -= weights @ np.linalg.lstsq(rows @ weights, rows @ way, rcond=CERTAIN)[0]
            place = self.led(0.0, self.displaced(0.0, state, way))
            if place is not None and self._orthogonalised(self._of_length_one(0.0, place))[1] > CERTAIN:
                places.append(place)
        return places

    def led(self, t: float, state: Any) -> Any | None:
        """A state whose position is led to the constraints by Newton's method, each step the shortest; None if not."""
        n, iterate, before = self.size, np.array(state, dtype=float), np.inf
        for _ in range(STEPS):
            values, weights = self.at(t, iterate), self.weights(t, iterate)
            if not np.all(np.isfinite(values.partials)) or not np.all(np.isfinite(weights)):
                return None
            rows = values.partials[: self.holonomic] @ weights
            step = weights @ np.linalg.lstsq(rows, -values.positions, rcond=1e-10)[0] if self.holonomic else np.zeros(n)
            iterate = self.displaced(t, iterate, step)
            size = float(np.max(np.abs(step) / self.extents(iterate), initial=0.0))
            if size <= SETTLED or before / 2 <= size <= ROUNDED:
                return iterate
            before = size
        return None

    @cached_property
    def dynamics(self) -> ConstrainedDynamics:
        """The equations with all rows."""
        if self._form is not None:
            return state_dynamics(self._form, self.chosen, self._massless)
        return constrained_dynamics(self._scenario.system, self._ring, self.chosen, self._apart, self._massless)

    @property
    def _massless(self) -> bool:
        """Whether M is singular at the initial position or beside it, and the rows hold what moves no mass there.

        Or singular everywhere there, whatever the rows hold.
        """
        regular = False
        for place in self.near:
            masses = self._masses(np.concatenate(([0.0], place))).reshape(self.size, self.size)
            sizes = np.sqrt(np.diag(masses))
            held = sizes > 0
            scaled = masses / np.outer(np.where(held, sizes, 1.0), np.where(held, sizes, 1.0))
            if np.linalg.eigvalsh(scaled)[0] > MASSLESS:
                regular = True
                continue
            rows = self.at(0.0, place).partials / np.where(held, sizes, 1.0)
            rows = rows / _positive(np.linalg.norm(rows, axis=1))[:, None]
            if np.linalg.eigvalsh(scaled + rows.T @ rows)[0] > CERTAIN:
                return True
        return not regular

    @cached_property
    def nearest(self) -> tuple[Fraction, ...]:
        """Parts of the pivots of S, whose sum of quotients with them says how near a singular position is.

        sum_i s_i / pivot_i grows like 1/sigma^2 towards one, with s_i the largest S_ii at positions near the start; it
        is measured by NEAREST times its value at the start.
        """
        dynamics = self.dynamics
        rows = [self.at(0.0, x).partials @ self.weights(0.0, x) for x in self.near]
        lengths = np.max([np.sum(row**2, axis=1) for row in rows], axis=0)
        numbers_of = [self.names.index(row.name) for row in dynamics.rows]
        sizes = np.array([max(lengths[numbers_of[k]] for k in owners) for owners in dynamics.owners])
        pivots = substituted(dynamics.program, dynamics.pivots[self.size :], numbers := bound(self._scenario))
        values = arrays.kernel(Code(numbers, self.inputs, tuple(pivots)))(np.concatenate(([0.0], self._start)))
        with np.errstate(all="ignore"):
            usual = float(np.sum(sizes / values))
        limit = NEAREST * (usual if np.isfinite(usual) and usual > self.rank else self.rank)
        return tuple(Fraction(float(size / limit)) for size in sizes)

    @cached_property
    def steady(self) -> bool:
        """Whether J q' = 0 on all of them: no row moves by itself, so that constraint forces do no work."""
        h, r = self.holonomic, len(self.names)
        program = self.at_rest(bound(self._scenario))
        nodes = substituted(self.code.program, self.code.outputs[h : h + r], program)
        return all(map(program.vanishes, nodes))

    @cached_property
    def _tangent_rows(self) -> Any:
        h, r = self.holonomic, len(self.names)
        program, velocities = self.code.program, self.code.outputs[h : h + r]
        rows = jacobian(program, velocities, [program.input(name) for name in self.inputs[1:]])
        return arrays.kernel(Code(program, self.inputs, tuple(x for row in rows for x in row)))

    def tangent(self, t: float, state: Any) -> Any:
        """An orthonormal basis (p + n, k) of the changes of a state that keep f = 0 and g = 0, to first order.

        Of dependent rows as many count as are independent on this branch.
        """
        width, r = self.places + self.size, len(self.names)
        values = self.at(t, state)
        above = np.hstack([values.gradients, np.zeros((self.holonomic, self.size))])
        below = self._tangent_rows(np.concatenate(([t], state))).reshape(r, width)
        rank = self.rank + len([i for i in self.kept if i < self.holonomic])
        rows = np.vstack([above, below])
        rows = rows / _positive(np.linalg.norm(rows, axis=1))[:, None]
        return np.linalg.svd(rows)[2][rank:].T

    def told(self) -> str:
        """``coincide 1, rolling 2``."""
        return listed(self._scenario.system.constraints)


@dataclass(frozen=True)
class Drift:
    """How far states stray from constraints: ``positions`` (m,) and ``velocities`` (m,), see the module.

    ``worst`` names the rows of the largest drift of either, None where there is no such row.
    """

    positions: Any
    velocities: Any
    worst: tuple[RowName | None, RowName | None]

    @property
    def largest(self) -> tuple[float, float]:
        """The largest drift of positions, and that of velocities."""
        return float(np.max(self.positions, initial=0.0)), float(np.max(self.velocities, initial=0.0))


def drift(constraints: Constraints, times: Any, states: Any, sizes: Any) -> Drift:
    """The drift at states (p + n, m); ``sizes`` (p + n,) is what positions and velocities are measured by."""
    p = constraints.places
    values = constraints.along(times, states)
    placed, largest = (np.max(np.abs(x), axis=2) for x in (values.gradients, values.partials))
    scales = constraints.slopes(placed, sizes[:p]), constraints.slopes(largest, sizes[p:])
    names = constraints.names
    parts = [
        np.abs(values.positions) / _positive(scales[0])[:, None],
        np.abs(values.velocities) / _positive(scales[1])[:, None],
    ]
    worst = [names[int(np.argmax(np.max(part, axis=1)))] if len(part) else None for part in parts]
    drifts = [np.max(part, axis=0) if len(part) else np.zeros(len(times)) for part in parts]
    return Drift(drifts[0], drifts[1], (worst[0], worst[1]))


def _shares(usual: float, inertia: Any) -> Any:
    """usual/sqrt(M_ii), 0 of what has no mass."""
    return np.where(inertia > 0, usual / _positive(inertia), 0.0)


def _positive(scales: Any) -> Any:
    return np.where(scales > 0, scales, 1.0)


def drift_of(dynamics: Dynamics, times: Any, states: Any) -> Drift | None:
    """The drift along a run, measured by its own sizes; None without constraints."""
    if dynamics.measured is None:
        return None
    from mbsym.numerics.planning.sizes import scaled, sizes_of_scene

    states = np.asarray(states, dtype=float)
    own = np.max(np.abs(states), axis=1)
    return drift(dynamics.measured, times, states, scaled(own, sizes_of_scene(dynamics, times, states)))


def labels(names: Sequence[RowName]) -> str:
    """Rows by their names, for sentences."""
    return "; ".join(name.label for name in names)
