"""Self-check of problems 4 and 5 of constrained systems: multipliers at a disturbed state, no null space, no expansion.

At random parameter values the unperturbed state is disturbed within the constraints, the dependent parts of the
disturbance found by solving the rows f, J q' + j and their rates as they come out at the state.  There d'Alembert's
principle in inertial axes gives the residuals r = M q'' - f of the open tree; multipliers are determined by the
dependent equations, J_D^T lambda = r_D, all carried to first order, and

    r_I - J_I^T lambda  =  (-f_I) + (A eta' + B eta + C x)

must be what problems 4 and 5 say, part by part.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from typing import Any

from mbsym.algebra.base import Scalar
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import SingularPoint
from mbsym.algebra.ring import Ring
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Formula
from mbsym.mechanics.constraints.ranks import eliminated
from mbsym.mechanics.constraints.rows import Row, constraint_rows
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.oracle import Dual, FirstOrder, Oracle, State
from mbsym.mechanics.states import SEED
from mbsym.model.system import System, acceleration_name, velocity_name
from mbsym.problems.checks import D_ALEMBERT, Check, NoMotionThere, Pair, agreement, decide
from mbsym.problems.linearisation import Linearisation, Reduction
from mbsym.problems.perturbation import Dependent, has_rational_states, matrix_pairs, unperturbed_state


def _route(about: Reduction) -> Message:
    return Message("[[principle]], with multipliers", principle=D_ALEMBERT) if about.ties else Message(D_ALEMBERT)


def check_motion(
    system: System, ring: Ring, residuals: Sequence[Formula], about: Reduction, dependent: Dependent
) -> Check:
    """Problem 4: ``residuals`` are those of the constraints and, last, of the equations of the independent speeds."""

    def pairs(balls: bool) -> list[Pair]:
        place = _Disturbed(system, ring, about, dependent, balls)
        own = residuals[len(residuals) - len(about.speeds) :]
        carry = Carrier(ring, place.state.numbers, place.state.values)
        free = place.free_residuals()
        named = zip(about.speeds, own, strict=True)
        compared = [(Message("equation [[name]]", name=name), -carry(x.polynomial), free[name].a) for name, x in named]
        satisfied = all(x.is_zero for x in residuals[: len(residuals) - len(about.speeds)])
        zero = place.state.numbers.zero
        return compared + [
            (Message("[[label]] on the motion", label=label), x, zero) for label, x in place.left_over if satisfied
        ]

    exact = has_rational_states(system, ring, dependent, about.rates_by_name)
    return decide("equilibrium", ("Newton-Euler recursion on the motion", _route(about)), exact, pairs)


def check_perturbed_motion(system: System, ring: Ring, linear: Linearisation, dependent: Dependent) -> Check:
    """Problem 5; undecided where a condition of problem 4 is solved for no parameter."""
    about = linear.about

    def pairs(balls: bool) -> list[Pair]:
        place = _Disturbed(system, ring, about, dependent, balls)
        if any(agreement(x, place.state.numbers.zero) is False for _, x in place.left_over):
            raise NoMotionThere
        free = place.free_residuals()
        rows = {name: free[name].b for name in about.speeds}
        rows |= dict.fromkeys(about.following, place.state.numbers.zero)  # their velocities follow from the rows
        direction = [place.direction[name] for name in about.about]
        return matrix_pairs(ring, linear, dependent, place.state, direction, place.pushes, rows)

    exact = has_rational_states(system, ring, dependent, about.rates_by_name)
    return decide(
        "perturbed motion",
        ("matrices of the first approximation", Message("[[principle]], disturbed", principle=_route(about))),
        exact,
        pairs,
    )


class _Disturbed:
    """The unperturbed ``state``, and the disturbance: ``direction`` (dx, dx', dx'') of every coordinate, ``pushes``."""

    def __init__(self, system: System, ring: Ring, about: Reduction, dependent: Dependent, balls: bool) -> None:
        self.system, self.ring, self.about = system, ring, about
        self.state = unperturbed_state(system, ring, dependent, balls, about.rates_by_name)
        numbers = self.state.numbers
        carry = Carrier(ring, numbers, self.state.values)
        values = dict(self.state.values)
        values |= {velocity_name(name): carry(rate.polynomial) for name, rate in about.rates}
        source = random.Random(SEED + 1)
        number = numbers.number
        parts = {name: [number(source.randint(1, 9)) for _ in range(3)] for name in system.coordinates}
        for name in about.dependent_coordinates:
            parts[name][0] = numbers.zero
        for name in about.dependent_speeds:
            parts[name][1] = parts[name][2] = numbers.zero
        self.pushes = [number(source.randint(1, 9)) for _ in system.inputs]
        self.state = State(numbers, values)
        self.direction: Mapping[str, Any] = parts
        self.rows = self._follow(values, parts)
        moving, speeds = self._places(about.dependent_speeds), [row.velocity.a for row in self.rows]
        missing, rest = _eliminated(self.rows, moving, speeds)
        #: What the velocities of the motion leave of each constraint: by how much a dependent one is wrong, and the
        #: rows that determine none.
        self.left_over = [
            (Message("the velocity of [[name]]", name=system.coordinates[i]), x) for i, x in missing.items()
        ]
        self.left_over += [(self.rows[k].name.label, x) for k, x in rest]

    def _follow(self, values: dict[str, Scalar], parts: dict[str, list[Any]]) -> tuple[Row, ...]:
        """The dependent parts, from the rows, one order of derivatives after another.

        The rows that it returns have all but accelerations of the disturbance.
        """
        about, zero = self.about, self.state.numbers.zero
        at, moving = self._places(about.dependent_coordinates), self._places(about.dependent_speeds)
        rows = [row for row in self._rows() if row.position is not None]
        places = [row.position.b for row in rows if row.position is not None]
        if about.leaf:  # deviations on the leaf are displacements that the velocity constraints allow
            rows = list(self._rows())
            places = [self._along(row, parts) for row in rows]
        for i, x in _eliminated(rows, at, places)[0].items():
            parts[self.system.coordinates[i]][0] = -x
        every = self._rows()
        for i, x in _eliminated(every, moving, [row.velocity.b for row in every])[0].items():
            parts[self.system.coordinates[i]][1] = -x
        unmoved = _eliminated(every, moving, [row.acceleration.a for row in every])[0]
        with_motion = {entry.coordinate for entry in self.system.motion}
        for i, x in unmoved.items():
            if self.system.coordinates[i] not in with_motion:
                key = acceleration_name(self.system.coordinates[i])
                values[key] = values.get(key, zero) - x
        every = self._rows()
        for i, x in _eliminated(every, moving, [row.acceleration.b for row in every])[0].items():
            parts[self.system.coordinates[i]][2] = -x
        return every

    def _along(self, row: Row, parts: Mapping[str, Sequence[Any]]) -> Any:
        """J x of the row, x the disturbance of the coordinates."""
        total = self.state.numbers.zero
        for partial, name in zip(row.partials, self.system.coordinates, strict=True):
            total = total + partial.a * parts[name][0]
        return total

    def _places(self, names: Sequence[str]) -> list[int]:
        return [self.system.coordinates.index(name) for name in names]

    @property
    def _disturbed(self) -> State:
        zero = self.state.numbers.zero
        values = {name: Dual(value, zero) for name, value in self.state.values.items()}
        for name, (shift, speed, push) in self.direction.items():
            for key, part in ((name, shift), (velocity_name(name), speed), (acceleration_name(name), push)):
                values[key] = Dual(self.state.values[key], part)
        for name, push in zip(self.system.input_names, self.pushes, strict=True):
            values[name] = Dual(self.state.values[name], push)
        return State(FirstOrder(self.state.numbers, values), values)

    def _rows(self) -> tuple[Row, ...]:
        state = self._disturbed
        return constraint_rows(Scene(self.system, state.numbers, dict(state.values), self.ring))

    def free_residuals(self) -> dict[str, Dual]:
        """r_I - J_I^T lambda to first order, by the names of the independent speeds."""
        names, about = self.system.coordinates, self.about
        needed = Oracle(self.system, self._disturbed).residuals
        columns, rows = self._places(about.dependent_speeds), self.rows
        # J_D^T lambda = r_D in two orders: the constant part, then what the slopes of J leave of the first-order one.
        first = _multipliers(rows, columns, [needed[names[i]].a for i in columns])
        rest = []
        for i in columns:
            value = needed[names[i]].b
            for k, force in first.items():
                value = value - rows[k].partials[i].b * force
            rest.append(value)
        second = _multipliers(rows, columns, rest)
        duals = {}
        for name in about.speeds:
            i = names.index(name)
            a, b = needed[name].a, needed[name].b
            for k, force in first.items():
                partial = rows[k].partials[i]
                a = a - partial.a * force
                b = b - partial.b * force - partial.a * second[k]
            duals[name] = Dual(a, b)
        return duals


def _eliminated(
    rows: Sequence[Row], columns: Sequence[int], values: Sequence[Scalar]
) -> tuple[dict[int, Scalar], list[tuple[int, Scalar]]]:
    """y with J_columns y = values by chosen rows, by columns; and what the other rows leave over, by their numbers."""
    lines = [[*(row.partials[i].a for i in columns), value] for row, value in zip(rows, values, strict=True)]
    solution, rest = _solved(lines, len(columns))
    return {columns[place]: y for place, y in solution.items()}, rest


def _multipliers(rows: Sequence[Row], columns: Sequence[int], values: Sequence[Scalar]) -> dict[int, Scalar]:
    """lambda with J_columns^T lambda = values, by the numbers of as many rows."""
    lines = [[*(row.partials[i].a for row in rows), value] for i, value in zip(columns, values, strict=True)]
    return _solved(lines, len(columns))[0]


def _solved(lines: Sequence[Sequence[Scalar]], rank: int) -> tuple[dict[int, Scalar], list[tuple[int, Scalar]]]:
    """x with A x = b of lines [A | b], by columns with a pivot; and what other lines leave over.

    Raises SingularPoint where the rank of A is not this.
    """
    table = eliminated(lines, range(len(lines[0]) - 1 if lines else 0))
    if table.rank != rank:
        raise SingularPoint("the constraints do not determine the dependent quantities")
    solution = {column: table.rows[k][-1] for k, column in table.pivots}
    pivots = {k for k, _ in table.pivots}
    return solution, [(k, row[-1]) for k, row in enumerate(table.rows) if k not in pivots]
