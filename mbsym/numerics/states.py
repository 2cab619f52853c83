"""One scenario in the variables that its description declares: y = (s, u), M u' = f, s' = g(s, u, t).

No angle that unit vectors or a quaternion replace is in it, and so no singular one.  What these satisfy,

    e.e = 1  (quaternion),      e_i.e_j = delta_ij  (unit vectors of one frame),

is kept by the exact flow; after every step a method leads the state back by Newton's step to the nearest one,

    e <- e + (1 - e.e) e/2,      e_i <- e_i - 1/2 sum_j (e_i.e_j - delta_ij) e_j.

Energies are those of ``mbsym.numerics.dynamics``, T2 - T0 - U = sum (u_r - s0_r) dL/du_r - L with u = S q' + s0.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np
from flint import arb, ctx

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import SingularPoint
from mbsym.algebra.matrices import dot
from mbsym.algebra.program import Node, Program
from mbsym.algebra.ring import Ring
from mbsym.expressions.tree import Name
from mbsym.mechanics.energy import gyrostatic_term, kinetic_energy
from mbsym.mechanics.energy_rate import EnergyRate, energy_rate
from mbsym.mechanics.factorisation import solve
from mbsym.mechanics.falling import relative_lagrangian
from mbsym.mechanics.loads.kinds import force_function
from mbsym.mechanics.speed_programs import orthonormal, restoring, speed_program
from mbsym.mechanics.speeds import SpeedForm
from mbsym.mechanics.variables import program_environment, ring_of
from mbsym.model.speeds import Quaternion
from mbsym.model.states import InStates, described, in_states
from mbsym.model.system import Body, System, velocity_name
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.kernels.precise import enclosures
from mbsym.numerics.scenario import PRECISION, Scenario, rounded, substituted


def state_names(system: System) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """(s, u) by name, as a run in the declared variables has them.  Raises Failure."""
    form = SpeedForm(system, ring_of(system))
    return tuple(x.name for x in form.positions), tuple(u.name for u in form.speeds)


def scenario_in_states(scenario: Scenario) -> Scenario:
    """The scenario in (s, u), its initial state from that in coordinates, to ``PRECISION`` bits.  Raises Failure."""
    system = scenario.system
    form = SpeedForm(system, ring_of(system))
    names = tuple(x.name for x in form.positions), tuple(u.name for u in form.speeds)
    n = len(form.positions)
    if scenario.declared:
        seen, state = in_states(system, *names), scenario.declared
        return replace(scenario, system=seen, positions=state[:n], velocities=state[n:], typed={})
    program = Program()
    nodes = form.state_in_coordinates(program)
    values: dict[str, Any] = {"t": Fraction(0)} | dict(scenario.parameters)
    values |= {name: initial for name, (initial, _) in scenario.prescribed.items()}
    values |= dict(zip((*system.coordinates, *system.velocities), scenario.state, strict=True))
    with ctx.workprec(PRECISION + 64):
        values["pi"] = arb.pi()
        balls = enclosures(Code(program, tuple(values), tuple(nodes)), tuple(values.values()), PRECISION + 64)
    state = tuple(rounded(value) for value in balls)
    return replace(scenario, system=in_states(system, *names), positions=state[:n], velocities=state[n:], typed={})


def scenario_in_velocities(scenario: Scenario) -> Scenario:
    """The scenario in (q, q'), of one in (s, u) whose positions are the coordinates.  Raises Failure, SingularPoint."""
    from mbsym.numerics.declared_start import declared_start  # few descriptions have any

    system, values = described(scenario.system), dict(zip(scenario.system.velocities, scenario.velocities, strict=True))
    own = {speed.name: values[speed.name] for speed in system.speeds}
    rates = {name: values.get(velocity_name(name)) for name in system.coordinates}
    known = dict(scenario.parameters) | {name: initial for name, (initial, _) in scenario.prescribed.items()}
    positions = dict(zip(scenario.system.coordinates, scenario.positions, strict=True))
    start = declared_start(system, own, positions, rates, known)
    if start.velocities is None:
        raise SingularPoint("the speeds do not determine the generalised velocities")
    q = tuple(positions[name] for name in system.coordinates)
    return replace(
        scenario, system=system.without_speeds, positions=q, velocities=tuple(map(rounded, start.velocities)), typed={}
    )


class StateDynamics(Dynamics):
    """The codes of a scenario in states; all take (t, s, u)."""

    in_states = True
    form: SpeedForm

    def __init__(self, scenario: Scenario, ring: Ring | None = None) -> None:
        self.described = described(scenario.system)
        super().__init__(scenario, ring if ring is not None else ring_of(self.described))
        self._own_ring = ring is None
        self.form = SpeedForm(self.described, self.ring)

    @cached_property
    def _in_program(self) -> tuple[list[list[Node]], list[Node], list[Node]]:
        """M, f, s' in the specialised program."""
        program, n = speed_program(self.form), len(self.form.speeds)
        nodes = [*(x for row in program.mass_matrix for x in row), *program.forcing, *program.rates]
        made = substituted(program.program, nodes, self._specialised)
        return [made[i * n : (i + 1) * n] for i in range(n)], made[n * n : n * n + n], made[n * n + n :]

    @cached_property
    def _accelerated(self) -> tuple[Sequence[Node], Sequence[Node]]:
        """u' and the pivots of M, and of J M^-1 J^T with constraints.  Raises SingularPoint."""
        if self.constraints is not None:
            dynamics = self.constraints.dynamics
            both = (
                substituted(dynamics.program, x, self._specialised) for x in (dynamics.accelerations, dynamics.pivots)
            )
            return next(both), next(both)
        mass, forcing, _ = self._in_program
        return solve(self._specialised, mass, forcing)

    @cached_property
    def right_hand_side(self) -> Code:
        """(t, s, u) -> (s', u')."""
        return self._code([*self._in_program[2], *self._accelerated[0]])

    @cached_property
    def correction(self) -> Code | None:
        """(t, s, u) -> what leads a state back to lengths of 1, right angles and constraints; None without any.

        A last output is 0, where nothing is singular.
        """
        if self.constraints is not None:
            return super().correction
        fresh, moved = self._specialised, restoring(self._specialised, self.described)
        if not moved:
            return None
        state = self.inputs[1 : 1 + self.dimension]  # what further inputs there are stays
        return Code(fresh, self.inputs, (*(moved.get(name, fresh.zero) for name in state), fresh.zero))

    @cached_property
    def pivots(self) -> Code:
        """(t, s, u) -> the pivots of M."""
        return self._code(list(self._accelerated[1]))

    @cached_property
    def determinant(self) -> Code:
        """(t, s, u) -> the determinant of the speeds by the velocities that they replace."""
        program = Program()
        carry = Carrier(self.form.ring, program, dict(program_environment(self.described, program)))
        return self._code(substituted(program, [carry(self.form.determinant)], self._specialised))

    @cached_property
    def mass_matrix(self) -> Code:
        """(t, s, u) -> M row by row."""
        return self._code([x for row in self._in_program[0] for x in row])

    @cached_property
    def forcing(self) -> Code:
        """(t, s, u) -> f."""
        return self._code(list(self._in_program[1]))

    @cached_property
    def _in_scene(self) -> Sequence[Node]:
        """(T - U without the gyrostatic term, T, U), (T, U) seen from the frames that fall, and s0."""
        form, program = self.form, Program()
        inputs: dict[str, Node] = dict(program_environment(self.described, program))
        scene = form.scene_over(program, inputs)
        carry = Carrier(form.ring, program, inputs)
        kinetic, force = kinetic_energy(scene), force_function(scene)
        nodes = [kinetic - force - gyrostatic_term(scene), kinetic, force, *relative_lagrangian(scene)]
        return substituted(program, [*nodes, *(carry(x) for x in form.drifts)], self._specialised)

    @property
    def _inertial(self) -> Sequence[Node]:
        _ = self.relative_energy  # first, as in coordinates
        return self._in_scene[:3]

    @property
    def _lagrangian(self) -> tuple[Node, Node]:
        return self._in_scene[3], self._in_scene[4]

    @property
    def _at_rest(self) -> Sequence[Node]:
        return self._in_scene[5:]

    def exactly(self, point: Sequence[Any]) -> Sequence[Any]:
        """The point with quaternions of norm 1, and unit vectors at right angles (Gram and Schmidt), as balls."""
        values = dict(zip(self.inputs, map(arb, point), strict=True))
        for vectors in orthonormal(self.described):
            done: list[list[arb]] = []
            for names in vectors:
                vector = [values[name] for name in names]
                for other in done:
                    along = dot(vector, other)
                    vector = [a - along * b for a, b in zip(vector, other, strict=True)]
                length = dot(vector, vector).sqrt()
                done.append([a / length for a in vector])
                values |= dict(zip(names, done[-1], strict=True))
        return [values[name] for name in self.inputs]

    @cached_property
    def energy_rate(self) -> EnergyRate:
        """dh/dt in coordinates and their velocities: h is the same quantity there."""
        return energy_rate(self.plain, self.ring)

    @property
    def plain(self) -> System:
        """The system in coordinates and their velocities."""
        return self.described.without_speeds


def dynamics_of(scenario: Scenario, ring: Ring | None = None, apart: bool = False) -> Dynamics:
    """The codes of a scenario in what it is told in: coordinates and their velocities, or declared variables."""
    if isinstance(scenario.system, InStates):
        return StateDynamics(scenario, ring)
    return Dynamics(scenario, ring, apart)


def norm_drifts(dynamics: StateDynamics, states: Any) -> dict[str, Any]:
    """By name of a quaternion or unit vector how far its products are from 1 and 0 along states (k, m): shape (m,).

    |e.e - 1| of a quaternion; of a unit vector the largest of |e.e - 1| and |e.f| with the others of its body.
    """
    place = {name: i for i, name in enumerate(dynamics.inputs[1:])}
    rows = np.asarray(states)
    drifts: dict[str, Any] = {}
    for body in dynamics.described.bodies:
        vectors = {attitude.name: rows[[place[name] for name in attitude.components]] for attitude in body.orientation}
        for name, vector in vectors.items():
            gaps = [np.sum(vector * other, axis=0) - (other is vector) for other in vectors.values()]
            drifts[name] = np.max(np.abs(np.array(gaps, dtype=float)), axis=0)
    return drifts


def has_quaternions(system: System) -> bool:
    """Whether a body is told by one."""
    return any(isinstance(attitude, Quaternion) for body in system.bodies for attitude in body.orientation)


def in_coordinates(dynamics: StateDynamics, states: Any) -> Any | None:
    """q (n, m) of states (k, m), for places of bodies; None where a joint is not turned by three coordinates by name.

    Where angles are singular they are some that make the same orientation.
    """
    place = {name: i for i, name in enumerate(dynamics.inputs[1:])}
    rows = np.asarray(states, dtype=float)
    values_by_name: dict[str, Any] = {}
    for body in dynamics.described.bodies:
        values_by_name |= {name: rows[place[name]] for name in body.coordinates if name in place}
        if not body.orientation:
            continue
        turns = [(axis - 1, angle) for axis, angle in body.rotation.turns()]
        names = [angle.name for _, angle in turns if isinstance(angle, Name)]
        if len(turns) != 3 or len(names) != 3:
            return None
        values_by_name |= dict(
            zip(names, _angles([axis for axis, _ in turns], _cosines(body, rows, place)), strict=True)
        )
    return np.array([values_by_name[name] for name in dynamics.described.coordinates])


def _cosines(body: Body, rows: Any, place: Mapping[str, int]) -> Any:
    """A (3 x 3 x m), from the axes of a body to those of the frame that it hangs on."""
    vectors = [rows[[place[name] for name in attitude.components]] for attitude in body.orientation]
    if not isinstance(body.orientation[0], Quaternion):
        return np.array(vectors)
    e, v = vectors[0][0], vectors[0][1:]
    cosines = 2 * v[:, None] * v[None, :]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        cosines[i, i] += e * e - np.sum(v * v, axis=0)
        cosines[i, j] -= 2 * e * v[k]
        cosines[j, i] += 2 * e * v[k]
    return cosines


def _angles(axes: Sequence[int], a: Any) -> tuple[Any, Any, Any]:
    """x1, x2, x3 with A = A_i(x1) A_j(x2) A_l(x3); x2 and x3 from what is left when the first turn is undone."""
    i, j, last = axes
    k = 3 - i - j
    sign = 1 if (j - i) % 3 == 1 else -1
    first = np.arctan2(a[j, i], -sign * a[k, i]) if last == i else np.arctan2(-sign * a[j, k], a[k, k])
    s, c = np.sin(first), np.cos(first)
    b = np.array(a)
    b[j], b[k] = c * a[j] + sign * s * a[k], c * a[k] - sign * s * a[j]
    if last == i:
        return first, np.arctan2(-sign * b[k, i], b[i, i]), np.arctan2(-sign * b[j, k], b[j, j])
    return first, np.arctan2(sign * b[i, k], b[k, k]), np.arctan2(sign * b[j, i], b[j, j])
