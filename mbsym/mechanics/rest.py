"""A system at numbers, and the equations of its steady motions.

At a relative equilibrium every coordinate is constant, except those to which the description gives a rate, which turn
steadily; the prescribed quantities go on running.  With M(q) q'' = f(q, q', t) it is a solution of f(q, rates, t) = 0,
under constraints of f + J^T lambda = 0 with phi(q, t) = 0 and J q' + j = 0 for some multipliers lambda.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING

from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.tree import ZERO, Call, Expression, names, number, reached, substitute, walk
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.newton_euler import residuals
from mbsym.mechanics.variables import expressions, ring_environment, ring_of
from mbsym.model.loads import ForceFunction
from mbsym.model.substitution import held, put
from mbsym.model.system import InitialValue, System, acceleration_name, rational, velocity_name

if TYPE_CHECKING:
    from mbsym.mechanics.constraints.rows import Row

#: The number of a parameter: a rational one, or an expression without names (pi/6, sqrt(2)), taken exactly as well.
Value = Fraction | Expression


def given_values(system: System, overrides: Mapping[str, Value]) -> dict[str, Value]:
    """The numbers of a description's parameters, replaced by ``overrides``; relations are not used here."""
    values: dict[str, Value] = {}
    for parameter in system.parameters:
        if parameter.value is not None:
            exact = rational(parameter.value)
            values[parameter.name] = parameter.value if exact is None else exact
    return values | dict(overrides)


def rational_values(values: Mapping[str, Value]) -> dict[str, Fraction]:
    """Those that are rational: what is eliminated over QQ takes no others."""
    return {name: value for name, value in values.items() if isinstance(value, Fraction)}


def missing_values(system: System, values: Mapping[str, Value]) -> tuple[str, ...]:
    """The parameters whose numbers the steady motions need, but which have none; in the order of declaration."""
    dependent = {item.name: names(item.value) for item in system.relations}
    rates = tuple(entry.rate for entry in system.motion)
    own = expressions((system.bodies, held(system).loads, system.prescribed, system.constraints, rates))
    needed = reached(dependent, (name for x in own for name in names(x)))
    return tuple(x for x in system.parameter_names if x in needed and x not in values and x not in dependent)


def at_numbers(system: System, values: Mapping[str, Value], places: bool = False) -> System:
    """The system with numbers in place of its parameters; a relation decides about its own left side.

    Of the unperturbed motion only the rates stay but for ``places``, and where constraints begin.  Raises KeyError
    where a number is missing.
    """
    dependent = {item.name: item.value for item in system.relations}
    numbers: dict[str, Expression] = {
        name: number(value) if isinstance(value, Fraction) else value
        for name, value in values.items()
        if name in system.parameter_names and name not in dependent
    }
    pending = dict(dependent)
    while pending:
        ready = [name for name, value in pending.items() if not names(value) & pending.keys()]
        if not ready:
            raise KeyError(", ".join(pending))
        for name in ready:
            numbers[name] = _folded(substitute(pending.pop(name), numbers))
    turning = system.motion if places else tuple(replace(entry, value=ZERO) for entry in system.motion)
    # Constraints have the rank of the branch on which the description begins.
    on_motion = tuple(InitialValue(entry.coordinate, entry.value, entry.rate) for entry in system.motion)
    begun = (system.initial or on_motion) if system.constraints else ()
    bare = replace(
        held(system), parameters=(), relations=(), assumptions=(), notation=(), initial=begun, motion=turning
    )
    numeric_system: System = put(replace(bare, time_scale=None), numbers)
    return replace(
        numeric_system, loads=tuple(load for x in numeric_system.loads if (load := x.simplified()) is not None)
    )


def _folded(expression: Expression) -> Expression:
    """A rational number where the expression is one."""
    value = rational(expression)
    return expression if value is None else number(value)


#: How names of multipliers begin; no description can use these.
_MULTIPLIER = "multiplier_dot_"
#: Stands for 1/q where q is large.
FARNESS = "farness_dot_"
#: Rows that one constraint has at most.
MOST_ROWS = 3


@dataclass(frozen=True)
class Rest:
    """A system at numbers, in its ring: f(q, q', t) and M(q), and f on the steady motions.

    ``turning`` are the coordinates that have a rate; ``rates`` the velocities of all; ``rows`` those of constraints.
    """

    system: System
    ring: Ring
    scene: Scene
    forcing: tuple[Polynomial, ...]
    at_rest: tuple[Polynomial, ...]
    rates: Mapping[int, Polynomial]
    turning: tuple[str, ...]
    rows: tuple[Row, ...] = ()

    @property
    def kept(self) -> list[Polynomial]:
        """What constraints demand of a steady motion: phi(q, t) = 0, J q' + j = 0."""
        demanded = [y for row in self.rows for y in (row.position, row.velocity) if y is not None]
        return [self.ring.reduce(self.ring.substitute(x, dict(self.rates))) for x in demanded]

    @property
    def multipliers(self) -> tuple[str, ...]:
        """The names of the multipliers in ``balanced``, one for each row."""
        return tuple(f"{_MULTIPLIER}{k}" for k in range(len(self.rows)))

    @property
    def balanced(self) -> list[Polynomial]:
        """f + J^T lambda, with multipliers by their names."""
        ring, still = self.ring, dict(self.rates)
        polynomials = list(self.at_rest)
        for row, name in zip(self.rows, self.multipliers, strict=True):
            for i, x in enumerate(row.partials):
                polynomials[i] = polynomials[i] + ring.times(
                    ring.substitute(x, still), ring.generator("prescribed", name)
                )
        return polynomials

    @property
    def tied_in_motion(self) -> tuple[str, ...]:
        """What moves and is tied by constraints; then coordinates without a rate need not be constant."""
        ring, names = self.ring, self.system.coordinates
        moving = [*self.turning, *(item.name for item in self.system.prescribed), "t"]
        tied = []
        for row in self.rows:
            parts = [*([] if row.position is None else [row.position]), *row.partials]
            tied += [name for x in parts for name in ring.dependencies(x, moving)]
            tied += [name for name in self.turning if not row.partials[names.index(name)].is_zero()]
            tied += [str(row.name.label)] if not ring.at_rest(row.velocity).is_zero() else []
        return tuple(dict.fromkeys(tied))

    @property
    def constant(self) -> tuple[str, ...]:
        return tuple(name for name in self.system.coordinates if name not in self.turning)

    def mass_matrix(self) -> list[list[Polynomial]]:
        """M (n x n): Newton-Euler residuals at q' = 0 and unit accelerations, without loads; made once."""
        return self._mass_matrix

    @cached_property
    def _mass_matrix(self) -> list[list[Polynomial]]:
        ring, system = self.ring, self.system
        coordinates = system.coordinates
        columns = []
        for moving in coordinates:
            environment = ring_environment(system, ring)
            for name in coordinates:
                environment[velocity_name(name)] = ring.zero
                environment[acceleration_name(name)] = ring.one if name == moving else ring.zero
            column = residuals(Scene(system, ring, environment, ring, frozen=True), loads=False)
            columns.append([column[name] for name in coordinates])
        n = range(len(coordinates))
        return [[columns[j][i] for j in n] for i in n]


def rest(system: System) -> Rest:
    """The equations of the steady motions of a system without parameters (``at_numbers``).

    Raises NoClosedForm or SingularPoint.
    """
    multipliers = tuple(f"{_MULTIPLIER}{k}" for k in range(MOST_ROWS * len(system.constraints)))
    multipliers += (FARNESS,) * bool(multipliers)
    ring = ring_of(system, moving=multipliers)
    environment = ring_environment(system, ring)
    for name in system.coordinates:
        environment[acceleration_name(name)] = ring.zero
    scene = Scene(system, ring, environment, ring)
    equations = residuals(scene)
    for load in (x for x in system.loads if isinstance(x, ForceFunction)):
        for node in walk(load.expression):
            if isinstance(node, Call) and node.function == "log":  # its derivative does not know where it is real
                scene.lower(node)
    rates = {ring.index("velocity", name): ring.zero for name in system.coordinates}
    turning = []
    for entry in system.motion:
        rate = scene.lower(entry.rate)
        rates[ring.index("velocity", entry.coordinate)] = rate
        if not rate.is_zero():
            turning.append(entry.coordinate)
    forcing = tuple(-equations[name] for name in system.coordinates)
    at_rest = tuple(ring.substitute(x, dict(rates)) for x in forcing)
    rows: tuple[Row, ...] = ()
    if system.constraints:
        from mbsym.mechanics.constraints.rows import joined_rows, said_rows  # most systems have none

        rows = joined_rows(ring, said_rows(scene))
    return Rest(system, ring, scene, forcing, at_rest, rates, tuple(turning), rows)
