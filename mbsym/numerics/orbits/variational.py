"""Variational equations: how a motion answers to small changes of its initial state and of its parameters.

    x' = f(t, x, p),    y' = J(t, x) y + df/dp,    J = df/dx,    y = dx/dc

``c`` is an initial value (then y(0) is a unit vector and df/dp is missing) or a parameter (then y(0) = dx(0)/dp, which
vanishes unless the initial state is made of it).  The matrix Phi of all initial values has Phi' = J Phi, Phi(0) = 1.
Derivatives are those of the straight-line program, exact, and share its instructions.  A ``Variational`` is a Dynamics
of its own: every method integrates it like any other, with the error of y under control as that of x.

Sources: Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I, I.14; Griewank & Walther, Evaluating
Derivatives, 2nd ed. 2008, chapter 3.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from mbsym.algebra.base import Lowering
from mbsym.algebra.derivative import directional, gradient, jacobian
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.program import Node, Program
from mbsym.expressions.tree import Expression
from mbsym.mechanics.constraints.refusal import refuse_constraints
from mbsym.model.states import described
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.ensembles.parametrised import Parametrised, parametrised
from mbsym.numerics.kernels import arrays
from mbsym.numerics.kernels.interface import FLOAT64, Code
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.methods.led import lead
from mbsym.numerics.methods.magnitudes import about
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.scenario import Names, Scenario, Specialised, bound, substituted


@dataclass(frozen=True)
class Direction:
    """A direction of change: its name, y(0) of 2n numbers, and the ``parameter`` whose change it is, if it is one."""

    name: str
    initial: tuple[Fraction, ...]
    parameter: str | None = None


@dataclass(frozen=True)
class Extended(Scenario):
    """A scenario whose state goes on behind (q, q')."""

    further: tuple[Fraction, ...] = ()

    @property
    def state(self) -> tuple[Fraction, ...]:
        """(q, q', y) at t = 0."""
        return (*self.positions, *self.velocities, *self.further)


def extended(scenario: Scenario, further: Sequence[Fraction]) -> Extended:
    """The scenario with a longer state."""
    known = {field.name: getattr(scenario, field.name) for field in fields(Scenario)}
    return Extended(**known, further=tuple(further))


class Variational(Dynamics):
    """The motion of ``base`` with ``directions`` of change: a state (x, y_1, ..., y_k) of 2n (1 + k) numbers.

    ``base`` may be ``Parametrised``; its free parameters have the scenario's values here.

    Raises NoClosedForm where the rates are not smooth: the columns would miss what the jumps do to them.
    """

    def __init__(self, base: Dynamics, directions: Sequence[Direction]) -> None:
        if base.switches.outputs:
            raise NoClosedForm(
                "the variational equations of rates with switches (sign, abs, kinks of tables): they miss what these do"
            )
        further = [value for direction in directions for value in direction.initial]
        super().__init__(extended(base.scenario, further), base.ring)
        self.base, self.directions = base, tuple(directions)
        self.states = (*self.system.coordinates, *self.system.velocities)
        self.inputs = ("t", *self.states, *(f"{name}~{k}" for k in range(len(directions)) for name in self.states))
        self.size = len(self.system.coordinates) * (1 + len(self.directions))
        # Its flow leaves constraints alone: states and columns are led back where a passage ends (``flow``).
        self.__dict__["constraints"] = None

    @cached_property
    def _specialised(self) -> Specialised:
        return bound(self.scenario)

    @cached_property
    def pivots(self) -> Code:
        """Those of the motion's own matrices."""
        return self._of_motion(self.base.pivots)

    @cached_property
    def mass_matrix(self) -> Code:
        """That of the motion itself."""
        return self._of_motion(self.base.mass_matrix)

    def _of_motion(self, code: Code) -> Code:
        outputs = substituted(code.program, code.outputs, self._specialised)
        return Code(self._specialised, self.inputs, tuple(outputs))

    @cached_property
    def right_hand_side(self) -> Code:
        """(t, x, y_1, ..., y_k) -> (f, J y_1 + df/dp_1, ...), by sweeps or by the whole J, whichever costs less."""
        rhs = self.base.right_hand_side
        program = rhs.program
        inputs = [program.input(name) for name in self.states]
        offsets = [self._offset(program, rhs.outputs, direction) for direction in self.directions]
        tangents = [[program.input(f"{name}~{k}") for name in self.states] for k in range(len(self.directions))]
        swept = [directional(program, rhs.outputs, inputs, tangent) for tangent in tangents]
        choices = [swept]
        if len(tangents) > 1:
            matrix = jacobian(program, rhs.outputs, inputs)
            choices.append([_applied(program, matrix, tangent) for tangent in tangents])
        candidates = []
        for columns in choices:
            nodes = list(rhs.outputs)
            for column, offset in zip(columns, offsets, strict=True):
                nodes += [a + b for a, b in zip(column, offset, strict=True)]
            candidates.append(nodes)
        cheapest = min(candidates, key=program.operations)
        return Code(self._specialised, self.inputs, tuple(substituted(program, cheapest, self._specialised)))

    def _offset(self, program: Program, outputs: Sequence[Node], direction: Direction) -> Sequence[Node]:
        """df/dp, zeros for an initial value."""
        if direction.parameter is None:
            return [program.zero] * len(outputs)
        (by,) = [program.input(direction.parameter)]
        return directional(program, outputs, [by], [program.one])


def require_smooth(dynamics: Dynamics) -> None:
    """Raises NoClosedForm where signs, moduli or steps are in the rates."""
    if dynamics.switches.outputs:
        raise NoClosedForm("derivatives of rates with switches (sign, abs, kinks of tables): they miss what these do")


def _applied(program: Program, matrix: Sequence[Sequence[Node]], vector: Sequence[Node]) -> tuple[Node, ...]:
    """matrix times vector."""
    rows = []
    for row in matrix:
        total = program.zero
        for a, b in zip(row, vector, strict=True):
            total = total + program.product(a, b)
        rows.append(total)
    return tuple(rows)


def units(dynamics: Dynamics) -> tuple[Direction, ...]:
    """The directions of all initial values: y_1 ... y_2n are the columns of Phi."""
    names = (*dynamics.system.coordinates, *dynamics.system.velocities)
    return tuple(_unit(name, names) for name in names)


def _unit(name: str, names: Sequence[str]) -> Direction:
    return Direction(name, tuple(Fraction(int(name == other)) for other in names))


def sensitive(
    scenario: Scenario,
    quantities: Sequence[str],
    overrides: Mapping[str, Expression] | None = None,
    fixed: Sequence[str] = (),
) -> Variational:
    """The motion with its derivatives by ``quantities`` names: of parameters, of coordinates and velocities at t = 0.

    What follows from a parameter (relations, prescribed motions, an initial state made of it) is part of its
    derivative; and where there are constraints, what initial values have to follow, with those ``fixed`` that are.  Of
    declared variables and coordinates that stand for them both may be wanted.

    Raises ValueError for a name that is neither, or for a parameter that itself follows from others.
    """
    system = scenario.system
    plain = described(system)
    states = (*system.coordinates, *system.velocities)
    variables = {*states, *plain.coordinates, *plain.velocities, *plain.variables}
    following = {relation.name for relation in system.relations}
    for name in quantities:
        if name not in variables and name not in system.parameter_names:
            raise ValueError(f"there is nothing called {name} to differentiate by")
        if name in following:
            raise ValueError(f"{name} follows from other parameters: differentiate by those")
    free = tuple(name for name in quantities if name not in variables)
    base = parametrised(scenario, free, overrides, fixed)
    fitted = system.constraints or base.in_states
    directions = []
    for name in quantities:
        if fitted:
            directions.append(Direction(name, base.column(name), name if name in free else None))
        elif name in states:
            directions.append(_unit(name, states))
        else:
            directions.append(Direction(name, start_column(base, name), name))
    return Variational(base, directions)


def start_column(base: Parametrised, name: str) -> tuple[Fraction, ...]:
    """dx(0)/dc, rounded to the program's precision."""
    code = base.start
    program, fresh = code.program, bound(base.scenario)
    nodes = [gradient(program, output, [program.input(name)])[0] for output in code.outputs]
    states = dict(zip(code.inputs[len(base.free) :], base.scenario.state, strict=True))
    fresh.bound.update({key: fresh.number(value) for key, value in states.items()})
    values = []
    for node in substituted(program, nodes, fresh):
        value = fresh.instructions[node.number].payload
        if not isinstance(value, Fraction):
            raise ValueError(f"the initial state's derivative by {name} is no number")
        values.append(value)
    return tuple(values)


def split(states: Any, size: int) -> tuple[Any, Any]:
    """(x, y) of a variational state: arrays of shapes (2n, ...) and (k, 2n, ...); ``size`` is 2n."""
    values = np.asarray(states)
    return values[:size], values[size:].reshape(-1, size, *values.shape[1:])


# The flow of a system and its derivative: x(t), Phi(t) with Phi' = J Phi, from any state, over and over.
#
# Compiled once; every passage starts the same machine code at another state.
#
# With constraints the accelerations keep J q' + j, and f with it, whatever they are: the flow of the open tree's states
# takes states on the constraints to such, and changes that keep them to such.  Roundings and errors of steps are taken
# out at the end of every passage: the state is led back, and columns lose what is across to ``tangent``.


#: The error of a step of x and of Phi, relative and absolute.
TOLERANCE = 1e-12


class Flow:
    """Passages of ``dynamics`` with as many columns of change as are wanted (2n of them by default).

    Integrated by dop853, or by another method of ``METHODS`` that chooses its steps.
    """

    def __init__(
        self,
        dynamics: Dynamics,
        tolerance: float = TOLERANCE,
        columns: int | None = None,
        method: str = "dop853",
        scalar: str = FLOAT64,
        step_limit: int = 10_000_000,
    ) -> None:
        self.dynamics = dynamics
        self.size = 2 * dynamics.size
        directions: tuple[Direction, ...] = units(dynamics)[: self.size if columns is None else columns]
        self.columns = len(directions)
        self._lead = lead(dynamics) if dynamics.constraints is not None and directions else None
        augmented = Variational(dynamics, directions) if directions else dynamics
        self.tolerance = tolerance
        self.run = METHODS[method].start(augmented, Setting(tolerance, step_limit=step_limit), scalar)

    def led(self, state: Any) -> Any:
        """The state on the constraints at t = 0."""
        return state if self._lead is None else self._lead(0.0, state)

    def passage(self, state: Any, start: float, end: float, tangents: Any | None = None) -> tuple[Any, Any]:
        """(x(end), y(end)) from x(start) = ``state`` and y(start) = ``tangents``, the first unit vectors by default.

        Shapes (2n,) and (2n, columns).  Raises Breakdown.
        """
        if tangents is None:
            tangents = np.eye(self.size, self.columns)
        self.run.restart(start, np.concatenate([np.asarray(state), np.asarray(tangents).T.reshape(-1)]))
        values = np.array(self.run.advance(end)) if end > start else np.array(self.run.state)
        state, columns = values[: self.size], values[self.size :].reshape(self.columns, self.size).T
        if self._lead is not None:
            state = self._lead(end, state)
            basis = self.dynamics.tangent(end, state)
            columns = basis @ (basis.T @ columns)
        return state, columns

    def along(self, state: Any, start: float, times: Any) -> Any:
        """x at increasing times, shape (2n, m), from x(start) = ``state``; for a flow without columns."""
        self.run.restart(start, np.asarray(state))
        return self.run.fill(times)


# Gradients by the adjoint equations: one number at the end by all parameters and all initial values at once.
#
#     G(x(T), p),    lambda' = -J^T lambda,    lambda(T) = dG/dx,
#     dG/dp = (dG/dp)(T) + int_0^T lambda^T df/dp dt + lambda(0)^T dx(0)/dp,    dG/dx(0) = lambda(0)
#
# The right-hand sides J^T lambda and lambda^T df/dp are one reverse sweep over the program of lambda^T f, whatever the
# number of parameters.  They are integrated backwards between checkpoints, where the state is taken up again from the
# forward run; how far a state that was followed backwards is from the next checkpoint is measured and told.
#
# Source: Cao, Li, Petzold & Serban, SIAM J. Sci. Comput. 24 (2003) 1076.


#: Pieces into which the time is cut.
CHECKPOINTS = 32


@dataclass(frozen=True)
class Gradient:
    """G at the end and its derivatives by name; ``mismatch`` is the largest distance of a state followed backwards from
    the checkpoint that it should meet, as part of the state's size."""

    value: float
    by: Mapping[str, float]
    mismatch: float


class Adjoint(Dynamics):
    """(x, lambda, g)' in the time s = T - t:  x' = -f,  lambda' = J^T lambda,  g' = lambda^T df/dp."""

    def __init__(self, base: Parametrised, time: Fraction) -> None:
        self.base, self.end = base, time
        self.count = len(base.free) + len(base.free) % 2  # states come in pairs
        n = 2 * base.size
        super().__init__(extended(base.scenario, [Fraction(0)] * (n + self.count)), base.ring)
        self.states = (*self.system.coordinates, *self.system.velocities)
        multipliers = tuple(f"{name}~adjoint" for name in self.states)
        sums = tuple(f"sum~{k}" for k in range(self.count))
        self.inputs = ("t", *self.states, *multipliers, *sums)
        self.size = base.size * 2 + self.count // 2

    @cached_property
    def right_hand_side(self) -> Code:
        """One reverse sweep over lambda^T f."""
        rhs = self.base.right_hand_side
        program = rhs.program
        product = program.zero
        for name, output in zip(self.states, rhs.outputs, strict=True):
            product = product + program.product(program.input(f"{name}~adjoint"), output)
        inputs = [program.input(name) for name in (*self.states, *self.base.free)]
        slopes = gradient(program, product, inputs)
        nodes = [*(-output for output in rhs.outputs), *slopes]
        nodes += [program.zero] * (self.count - len(self.base.free))
        fresh = bound(self.scenario)
        fresh.bound["t"] = fresh.difference(fresh.number(self.end), fresh.input("t"))
        return Code(fresh, self.inputs, tuple(substituted(program, nodes, fresh)))


def gradient_at_end(
    scenario: Scenario,
    functional: Expression,
    names: Sequence[str],
    time: float,
    overrides: Mapping[str, Expression] | None = None,
    tolerance: float = 1e-11,
) -> Gradient:
    """d G/d name by parameters and initial values; G is an expression in coordinates, velocities and parameters.

    Raises Breakdown where the motion ends early, Failure where there is no program.
    """
    refuse_constraints(scenario.system, "gradients")
    system = scenario.system
    states = (*system.coordinates, *system.velocities)
    free = [name for name in names if name not in states]
    base = Parametrised(scenario, free, overrides)
    require_smooth(base)
    n = len(states)
    plain = Dynamics(scenario)
    forward = METHODS["dop853"].start(plain, Setting(tolerance))
    times = np.linspace(0.0, time, CHECKPOINTS + 1)
    motion = np.array(forward.fill(times))
    sizes = np.maximum(about(plain, 0.0, motion[:, 0]).sizes[:, 0], np.max(np.abs(motion), axis=1))
    value, slopes = _functional(base, functional, motion[:, -1])
    adjoint = Adjoint(base, Fraction(time))
    state = np.concatenate([motion[:, -1], slopes[:n], np.zeros(adjoint.count)])
    run = METHODS["dop853"].start(adjoint, Setting(tolerance), initial=state, at=0.0)
    mismatch = 0.0
    for place in range(CHECKPOINTS, 0, -1):
        state[:n] = motion[:, place]
        run.restart(float(time - times[place]), state)
        state = np.array(run.advance(float(time - times[place - 1])))
        mismatch = max(mismatch, float(np.max(np.abs(state[:n] - motion[:, place - 1]) / sizes)))
    multipliers, sums = state[n : 2 * n], state[2 * n :]
    by = {}
    for name in names:
        if name in states:
            by[name] = float(multipliers[states.index(name)])
        else:
            place = free.index(name)
            start = np.array([float(x) for x in start_column(base, name)])
            by[name] = float(slopes[n + place] + sums[place] + multipliers @ start)
    return Gradient(value, by, mismatch)


def _functional(base: Parametrised, functional: Expression, end: Any) -> tuple[float, Any]:
    """G and its derivatives by (x, p) at the end."""
    program = base.right_hand_side.program
    output = Lowering(program, Names(program))(functional)
    names = (*base.system.coordinates, *base.system.velocities, *base.free)
    slopes = gradient(program, output, [program.input(name) for name in names])
    values = np.concatenate([end, [float(base.scenario.parameters[name]) for name in base.free]])
    outputs = arrays.kernel(Code(program, names, (output, *slopes)))(values)
    return float(outputs[0]), outputs[1:]
