"""One scenario as codes ready to compile: right-hand side, energy, Jacobian, momenta.

    x = (q, q'),    x' = rhs(t, x) = (q', M^-1 f)
    energy               T - U
    generalised energy   h = q'.dL/dq' - L = T2 - T0 - U    conserved where L is free of t and no other force works

Where nothing is prescribed (T0 = 0) the two are one.  All codes take (t, q, q') and come from one specialised program.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from mbsym.algebra.derivative import gradient, jacobian
from mbsym.algebra.program import Node, Program
from mbsym.algebra.ring import Ring
from mbsym.algebra.stable import stabilised
from mbsym.expressions.table import Curve
from mbsym.mechanics.energy_rate import EnergyRate, energy_rate
from mbsym.mechanics.falling import relative_lagrangian
from mbsym.mechanics.programs import ForwardDynamics, Programs, forward_dynamics, programs, scene_without_accelerations
from mbsym.mechanics.variables import ring_of
from mbsym.model.system import System
from mbsym.numerics.events.features import SLIDING, Features, Polynomial, Standing, features, held, sign_that_holds
from mbsym.numerics.kernels.interface import Cells, Code
from mbsym.numerics.scenario import Scenario, Specialised, bound, substituted

if TYPE_CHECKING:
    from mbsym.mechanics.constraints.dynamics import ConstrainedDynamics
    from mbsym.mechanics.speeds import SpeedForm
    from mbsym.numerics.constrained import Constraints


#: The last scenario whose constraints were listed, and these.
_LISTED: list[tuple[Dynamics, Constraints]] = []


class Dynamics:
    """The codes of a scenario; each is made when it is first asked for.

    With ``apart``, bodies that are welded to others are not lumped into them: more operations for the same motion.
    """

    #: Whether what is integrated are the variables that the description declares (``mbsym.numerics.states``).
    in_states = False

    #: What these are; None of coordinates and their velocities.
    form: SpeedForm | None = None

    #: Parameters that are inputs, behind the state.
    free: tuple[str, ...] = ()

    def __init__(self, scenario: Scenario, ring: Ring | None = None, apart: bool = False) -> None:
        self.scenario = scenario
        self.system: System = scenario.system
        self._own_ring = ring is None
        self.ring = ring if ring is not None else ring_of(self.system)
        self.inputs = ("t", *self.system.coordinates, *self.system.velocities)
        self.size = len(self.system.coordinates)
        self.apart = apart
        self._on_sides: dict[int | None, Frozen] = {}

    @property
    def dimension(self) -> int:
        """How many numbers a state has: q and q', or whatever else stands between the time and the free parameters."""
        return len(self.inputs) - 1 - len(self.free)

    @property
    def fixed_values(self) -> dict[str, Fraction]:
        """The parameters that are numbers here: those that are inputs of the code have no value of their own."""
        return {name: value for name, value in self.scenario.parameters.items() if name not in self.inputs}

    def exactly(self, point: Sequence[Any]) -> Sequence[Any]:
        """(t, q, q') of the model itself beside a point of a run, which has been rounded: it itself."""
        return point

    @cached_property
    def _programs(self) -> Programs:
        # M, f and energies of the tree: what constraints add to them is in ``constraints``.
        return programs(self.system, self.ring, self.apart, open_tree=True)

    @cached_property
    def _specialised(self) -> Specialised:
        return bound(self.scenario)

    def _code(self, nodes: list[Node], thorough: bool = False) -> Code:
        return Code(self._specialised, self.inputs, tuple(stabilised(self._specialised, nodes, thorough)))

    @cached_property
    def constraints(self) -> Constraints | None:
        """The constraints as numbers; None where there are none."""
        if not self.system.constraints:
            return None
        from mbsym.numerics.constrained import Constraints

        for other, found in _LISTED:  # who leads a start to the constraints goes on from another one
            if self._has_rows_of(other):
                return found.from_start(self.scenario)
        found = Constraints(self.scenario, self.ring, self.apart, self.mass_matrix, self.form)
        _LISTED[:] = [(self, found)] if self._own_ring else []
        return found

    def _has_rows_of(self, other: Dynamics) -> bool:
        """Whether the rows of another are these, from wherever its motion begins."""
        mine, its = self.scenario, other.scenario
        return (
            self._own_ring
            and (type(self), self.apart) == (type(other), other.apart)
            and mine.system is its.system
            and mine.parameters == its.parameters
            and mine.prescribed == its.prescribed
        )

    @property
    def is_scleronomic(self) -> bool:
        """Whether no constraint moves by itself: what rests keeps them at all times if it does at one."""
        return self.constraints is None or self.constraints.steady

    def tangent(self, t: float, state: Any) -> Any:
        """An orthonormal basis, in columns, of the changes of a state that constraints allow to first order."""
        return np.eye(len(state)) if self.constraints is None else self.constraints.tangent(t, state)

    @property
    def measured(self) -> Constraints | None:
        """The constraints from which states of a run may stray: those that it is led to, if it is led."""
        return self.constraints

    @property
    def _solved(self) -> ForwardDynamics | ConstrainedDynamics:
        if self.constraints is not None:
            return self.constraints.dynamics
        return forward_dynamics(self.system, self.ring, apart=self.apart)

    @cached_property
    def right_hand_side(self) -> Code:
        """(t, q, q') -> (q', q''), 2n outputs."""
        solution = self._solved
        fresh = self._specialised
        accelerations = substituted(solution.program, solution.accelerations, fresh)
        return self._code([*(fresh.input(name) for name in self.system.velocities), *accelerations])

    @cached_property
    def correction(self) -> Code | None:
        """(t, q, q') -> what leads a state back to the constraints, 2n outputs; None where there are none.

        One more output is how near the rows are to losing their rank: beyond 1 nothing is computed there.
        """
        if self.constraints is None:
            return None
        dynamics = self.constraints.dynamics
        fresh, pivots = self._specialised, dynamics.pivots[self.constraints.size :]
        nodes = [*dynamics.position_correction, *dynamics.velocity_correction, *pivots]
        made = substituted(dynamics.program, nodes, fresh)
        nearness = fresh.zero
        for size, pivot in zip(self.constraints.nearest, made[self.dimension :], strict=True):
            nearness = nearness + fresh.number(size) * fresh.reciprocal(pivot)
        return self._code([*made[: self.dimension], nearness])

    @cached_property
    def multipliers(self) -> Code:
        """(t, q, q') -> lambda of the rows; J^T lambda are the generalised forces of the constraints."""
        assert self.constraints is not None
        dynamics = self.constraints.dynamics
        return self._code(substituted(dynamics.program, dynamics.multipliers, self._specialised))

    @cached_property
    def features(self) -> Features:
        """What is not smooth, or narrow, in the rates."""
        return features(self.right_hand_side)

    @property
    def switches(self) -> Code:
        """(t, q, q') -> what stands under signs and moduli in the rates: where one is 0 they are not smooth."""
        return self.features.switches

    def on_sides(self, sides: tuple[int, ...]) -> Frozen:
        """The same with the signs of its switches held, each -1 or 1, or 0 for one that stays where it changes; of a
        table the piece, counted from 1.

        Until it is asked for with other sides: the code is the same for all that have the same 0, and is so told of
        the sides; whoever runs it asks before every step.
        """
        sliding = sides.index(SLIDING) if SLIDING in sides else None
        if sliding not in self._on_sides:
            self._on_sides[sliding] = Frozen(self, sliding)
        frozen = self._on_sides[sliding]
        frozen.take(sides)
        return frozen

    @cached_property
    def pivots(self) -> Code:
        """(t, q, q') -> the pivots of the factorised mass matrix; one that vanishes means a singular M.

        With constraints those of J M^-1 J^T follow; one of them vanishes where the constraints lose their rank.
        """
        solution = self._solved
        return self._code(substituted(solution.program, solution.pivots, self._specialised))

    @cached_property
    def mass_matrix(self) -> Code:
        """(t, q, q') -> M row by row, n*n outputs."""
        found = self._programs
        nodes = [node for row in found.mass_matrix for node in row]
        return self._code(substituted(found.program, nodes, self._specialised))

    @cached_property
    def forcing(self) -> Code:
        """(t, q, q') -> f, n outputs."""
        return self._code(substituted(self._programs.program, self._programs.forcing, self._specialised))

    @cached_property
    def jacobian(self) -> Code:
        """(t, q, q') -> d rhs / d (q, q') row by row, 4 n*n outputs."""
        rhs, fresh = self.right_hand_side, self._specialised
        states = [fresh.input(name) for name in self.inputs[1:]]
        rows = jacobian(fresh, rhs.outputs, states)
        return self._code([node for row in rows for node in row])

    @cached_property
    def slopes(self) -> Code:
        """(t, q, q') -> d rhs / dt, 2n outputs, and behind them the Jacobian row by row."""
        rhs, fresh = self.right_hand_side, self._specialised
        by_time = jacobian(fresh, rhs.outputs, [fresh.input(self.inputs[0])])
        return Code(fresh, self.inputs, (*(row[0] for row in by_time), *self.jacobian.outputs))

    @property
    def linear(self) -> bool:
        """Whether the right-hand side is linear in the state: no entry of the Jacobian is a function of it."""
        program = self.jacobian.program
        used = (program.instructions[number] for number in program.live(self.jacobian.outputs))
        return all(
            instruction.operation != "input" or str(instruction.payload) not in self.inputs[1:] for instruction in used
        )

    @cached_property
    def _lagrangian(self) -> tuple[Node, Node]:
        """(T, U) in the specialised program; relative to the frames that fall, where there are any."""
        program = Program()
        scene = scene_without_accelerations(self.system, self.ring, program)
        kinetic, force = substituted(program, relative_lagrangian(scene), self._specialised)
        return kinetic, force

    @cached_property
    def momenta(self) -> Code:
        """(t, q, q') -> p = dL/dq', n outputs."""
        kinetic, force = self._lagrangian
        velocities = [self._specialised.input(name) for name in self.system.velocities]
        return self._code(list(gradient(self._specialised, kinetic + force, velocities)))

    @cached_property
    def momentum_rates(self) -> Code:
        """(t, q, q') -> dL/dq, n outputs."""
        kinetic, force = self._lagrangian
        positions = [self._specialised.input(name) for name in self.system.coordinates]
        return self._code(list(gradient(self._specialised, kinetic + force, positions)))

    @cached_property
    def relative_energy(self) -> Code:
        """(t, q, q') -> (h, T) of the Lagrangian relative to the frames that fall: how h changes, in all digits.

        From T2 - T0 - U it differs by what is constant wherever that is, and by the large terms that cancel.
        """
        kinetic, force = self._lagrangian
        return self._code([self._jacobi(kinetic + force, self.momenta.outputs), kinetic], thorough=True)

    @cached_property
    def energies(self) -> Code:
        """(t, q, q') -> (T - U, T2 - T0 - U), T of the motion in inertial space."""
        (energy, kinetic, force), fresh = self._inertial, self._specialised
        lagrangian = kinetic + force
        momenta = gradient(fresh, lagrangian, [fresh.input(name) for name in self.system.velocities])
        return self._code([energy, self._jacobi(lagrangian, momenta)])

    @cached_property
    def integral_slopes(self) -> Code:
        """(t, q, q') -> d (T2 - T0 - U, p) / d (q, q') row by row, (1 + n) 2n outputs."""
        fresh = self._specialised
        states = [fresh.input(name) for name in self.inputs[1:]]
        rows = jacobian(fresh, [self.energies.outputs[1], *self.momenta.outputs], states)
        return self._code([node for row in rows for node in row])

    @cached_property
    def _inertial(self) -> Sequence[Node]:
        """(T - U without the gyrostatic term, T, U) of the motion in inertial space, in the specialised program."""
        _ = self.relative_energy  # always first: roundings hang on the order in which a program is written
        found = self._programs
        nodes = [found.energy, found.kinetic_energy, found.force_function]
        return substituted(found.program, nodes, self._specialised)

    @property
    def _at_rest(self) -> Sequence[Node]:
        """s0 of the speeds u = S q' + s0: nothing moves at these but what is prescribed."""
        return [self._specialised.zero for _ in self.system.velocities]

    @cached_property
    def natural(self) -> bool:
        """Whether T - U and T2 - T0 - U are one: T vanishes at rest, as it does where nothing is prescribed."""
        still = bound(self.scenario)
        still.bound.update(dict.fromkeys(self.system.velocities, still.number(0)))
        nodes = substituted(self._specialised, [self._inertial[1], *self._at_rest], still)
        return all(still.vanishes(x) for x in nodes)

    @cached_property
    def constraint_power(self) -> Code:
        """(t, q, q') -> -lambda_i j_i: what constraints that move add to dh/dt, row by row."""
        assert self.constraints is not None
        rows, still = self.constraints.dynamics, self.constraints.at_rest(bound(self.scenario))
        moving = substituted(rows.program, [row.velocity for row in rows.rows], still)
        fresh = self._specialised
        powers = zip(self.multipliers.outputs, substituted(still, moving, fresh), strict=True)
        return Code(fresh, self.inputs, tuple(-fresh.product(force, speed) for force, speed in powers))

    @cached_property
    def energy_rate(self) -> EnergyRate:
        """dh/dt of the tree before numbers are put in: what constraints that move add is in ``constraint_power``."""
        return energy_rate(self.system, self.ring)

    @cached_property
    def energy_power(self) -> Code:
        """(t, q, q') -> the terms of dh/dt that do not vanish at these numbers, h = T2 - T0 - U."""
        terms = substituted(self.energy_rate.program, self.energy_rate.terms, self._specialised)
        return Code(
            self._specialised, self.inputs, tuple(term for term in terms if not self._specialised.vanishes(term))
        )

    def _jacobi(self, lagrangian: Node, momenta: Sequence[Node]) -> Node:
        """q'.p - L; of speeds sum (u_r - s0_r) p_r - L."""
        fresh = self._specialised
        total = -lagrangian
        for name, drift, momentum in zip(self.system.velocities, self._at_rest, momenta, strict=True):
            total = total + fresh.product(fresh.input(name) - drift, momentum)
        return total


class Frozen(Dynamics):
    """A scenario's dynamics with the signs of its switches held: smooth, and right on that side of every switch.

    The signs stand in ``cells``; that of the switch number ``sliding`` is what keeps it at 0.  Behind them stand, for
    each table, the base and the coefficients of the piece, every number as a sum of two.
    """

    def __init__(self, whole: Dynamics, sliding: int | None) -> None:
        super().__init__(whole.scenario, whole.ring, whole.apart)
        self.whole, self.sliding = whole, sliding
        curves = whole.features.curves
        self._lengths = [0 if curve is None else 2 * (1 + len(curve.polynomials[0])) for curve in curves]
        self.cells = Cells(len(curves) + sum(self._lengths))
        self.inputs, self.size, self.free = whole.inputs, whole.size, whole.free  # a state may go on behind (q, q')
        self.in_states = whole.in_states
        # One program: what stands under a sign is known by its number there.
        self.__dict__["_specialised"] = whole._specialised
        if not whole.in_states:
            self.__dict__["_programs"] = whole._programs
        self.__dict__["constraints"] = whole.constraints
        if whole.in_states:
            self.form = whole.form
            self.__dict__["correction"], self.__dict__["pivots"] = whole.correction, whole.pivots

    def take(self, sides: Sequence[int]) -> None:
        """These sides from now on."""
        values, place = self.cells.values, len(sides)
        values[:place] = sides
        for side, curve, length in zip(sides, self.whole.features.curves, self._lengths, strict=True):
            if curve is not None:
                values[place : place + length] = _in_pairs(curve)[side - 1]
            place += length

    def _code(self, nodes: list[Node], thorough: bool = False) -> Code:
        code = super()._code(nodes, thorough)
        return Code(code.program, code.inputs, held(code, self._signs))

    @cached_property
    def right_hand_side(self) -> Code:
        """(t, q, q') -> (q', q'') on this side of every switch."""
        code = self.whole.right_hand_side
        return Code(code.program, code.inputs, held(code, self._signs))

    @cached_property
    def mass_matrix(self) -> Code:
        """(t, q, q') -> M row by row, on this side of every switch."""
        code = self.whole.mass_matrix
        return Code(code.program, code.inputs, held(code, self._signs))

    @cached_property
    def holding(self) -> Code:
        """(t, q, q') -> (s, 0 where that is a solution); see ``sign_that_holds``."""
        assert self.sliding is not None
        others, node = dict(self._held), self.whole.switches.outputs[self.sliding]
        del others[node.number]
        return sign_that_holds(self.whole.right_hand_side, node, others)

    @cached_property
    def _signs(self) -> Standing:
        signs = dict(self._held)
        if self.sliding is not None:
            signs[self.whole.switches.outputs[self.sliding].number] = self.holding.outputs[0]
        return signs

    @property
    def _held(self) -> dict[int | tuple[int, Curve], Any]:
        """The signs as they stand in memory, by the numbers of the switches, and the pieces of tables."""
        outputs, program = self.whole.switches.outputs, self._specialised
        read = [program.input(name) for name in self.cells.names]
        found: dict[int | tuple[int, Curve], Any] = {}
        place = len(outputs)
        for node, sign, curve, length in zip(
            outputs, read[:place], self.whole.features.curves, self._lengths, strict=True
        ):
            if curve is None:
                found[node.number] = sign
                continue
            pairs = read[place : place + length]
            base, *own = (program.plus(high, low) for high, low in zip(pairs[::2], pairs[1::2], strict=True))
            found[node.number, curve] = Polynomial(base, tuple(own))
            place += length
        return found


@lru_cache(64)
def _in_pairs(curve: Curve) -> Any:
    """Base and coefficients of every piece, shape (n + 1, 2 (degree + 2)), each number as high and low."""
    rows = []
    for base, polynomial in zip(curve.bases, curve.polynomials, strict=True):
        highs = [(value, float(value)) for value in (base, *polynomial)]
        rows.append([part for value, high in highs for part in (high, float(value - Fraction(high)))])
    return np.array(rows)
