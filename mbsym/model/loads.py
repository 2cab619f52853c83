"""Loads as frozen dataclasses of parsed expressions, each with what it says of itself.

Whoever wants to know something of a load asks it: between which bodies it acts, on which coordinates, whether it has a
force function, what is left of it where coordinates are held, what its formulas measure.  What it does to a motion
(wrenches, generalised forces, the value of its force function) is in ``mbsym.mechanics.loads.kinds``.
"""

from __future__ import annotations

from collections.abc import Container, Iterator
from dataclasses import dataclass, replace
from typing import ClassVar, NamedTuple, Self

from mbsym.expressions.place import Span
from mbsym.expressions.tree import Expression
from mbsym.model.basics import INERTIAL, Point, Vector, _span, rational
from mbsym.model.units import ACCELERATION, ENERGY, FORCE, LENGTH, NONE, SPEED, TIME, Dimension, times

#: The order of a Newtonian field that is not expanded, and all orders there are.
EXACT = "exact"
GRAVITY_ORDERS: tuple[int | str, ...] = (2, 3, 4, EXACT)


class Measured(NamedTuple):
    """A formula and what it measures: ``dimension`` times that of ``coordinate`` to a power; ``what`` in words."""

    formula: Expression
    dimension: Dimension
    what: str
    coordinate: str = ""
    power: int = 0


class Acting:
    """What any load can be asked; a kind overrides what is different for it."""

    __slots__ = ()

    #: Whether a force function says all that it does.
    conservative: ClassVar[bool] = False
    #: Whether its generalised forces are linear in coordinates and velocities, with constant coefficients.
    linear: ClassVar[bool] = False
    #: Whether its two forces lie on the line between its points, so that only the distance of these matters.
    along_line: ClassVar[bool] = False

    @property
    def written(self) -> Self:
        """As it stands in the file: with speeds and unit vectors where those were written."""
        return self

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The coordinates on which it acts directly."""
        return ()

    @property
    def points(self) -> tuple[Point, ...]:
        """The points of bodies at which it acts."""
        return ()

    @property
    def bodies(self) -> tuple[str, ...] | None:
        """The bodies on which it acts or in whose axes it is given; None: on all, by their places in space.

        A load without any (and not None) is made of formulas in coordinates and velocities and needs no kinematics.
        """
        return tuple(point.body for point in self.points)

    @property
    def given(self) -> tuple[Expression, ...]:
        """The components of a force that the description gives as it is; it may have a potential that nobody named."""
        return ()

    @property
    def damping(self) -> Expression | None:
        """c of a load that takes the power c (rate)^2 from the motion."""
        return None

    @property
    def dissipation_function(self) -> Expression | None:
        """R of a load whose generalised forces are -dR/dq'."""
        return None

    @property
    def rest_position(self) -> tuple[str, Expression] | None:
        """(coordinate, value) where it vanishes."""
        return None

    @property
    def link(self) -> tuple[str, str, str] | None:
        """(body, body, word) of what is drawn between two bodies."""
        return None

    def without(self, held: Container[str]) -> Self | None:
        """What is left of it where some coordinates are held; None for nothing."""
        return None if any(name in held for name in self.coordinates) else self

    def simplified(self) -> Self | None:
        """Without components that are zero at sight, which only cast doubt on the energy; None for nothing."""
        parts = (*self.given, *(x for x in (self.damping, self.dissipation_function) if x is not None))
        return None if parts and all(rational(x) == 0 for x in parts) else self

    def measured(self) -> Iterator[Measured]:
        """Its formulas and what they measure, those of its points apart."""
        return iter(())


class _Free(Acting):
    """A load of free formulas.  Where these hold speeds or unit vectors of bodies it is kept ``as_written``, and stands
    beside as the same load in coordinates and velocities."""

    __slots__ = ()

    as_written: Self | None

    @property
    def written(self) -> Self:
        return self if self.as_written is None else self.as_written


@dataclass(frozen=True, slots=True)
class NewtonianGravity(Acting):
    """Newtonian field of a centre, acting on the bodies that the frame ``about`` carries.

    ``constant`` is nu = G M; ``centre`` the frame whose origin attracts (mostly the inertial one).  With ``order`` 2, 3
    or 4 the field is expanded about the origin O1 of ``about`` in (size)/R up to that degree; with ``EXACT`` every mass
    centre has its exact distance (``mbsym.mechanics.loads.newtonian_orders`` defines both), and ``about`` may be the
    centre itself.
    """

    conservative = True

    constant: Expression
    centre: str
    about: str
    order: int | str = 2
    span: Span | None = _span()

    @property
    def bodies(self) -> None:
        return None

    def measured(self) -> Iterator[Measured]:
        yield Measured(self.constant, times(times(LENGTH, LENGTH, 2), TIME, -2), "a gravitational parameter")


@dataclass(frozen=True, slots=True)
class UniformGravity(Acting):
    """``acceleration`` is the vector g in inertial axes, for example (0, -g, 0)."""

    conservative = True

    acceleration: Vector
    span: Span | None = _span()

    @property
    def bodies(self) -> None:
        return None

    def measured(self) -> Iterator[Measured]:
        for x in self.acceleration:
            yield Measured(x, ACCELERATION, "an acceleration")


@dataclass(frozen=True, slots=True)
class CoordinateSpring(Acting):
    """Linear or torsional: potential stiffness (coordinate - rest)^2 / 2."""

    conservative = linear = True

    coordinate: str
    stiffness: Expression
    rest: Expression
    span: Span | None = _span()

    @property
    def coordinates(self) -> tuple[str, ...]:
        return (self.coordinate,)

    @property
    def rest_position(self) -> tuple[str, Expression]:
        return self.coordinate, self.rest

    def measured(self) -> Iterator[Measured]:
        name = self.coordinate
        yield Measured(self.stiffness, ENERGY, f"the stiffness of a spring on '{name}'", name, -2)
        yield Measured(self.rest, NONE, f"'{name}'", name, 1)


@dataclass(frozen=True, slots=True)
class PointSpring(Acting):
    """Between two points: potential stiffness (distance - length)^2 / 2."""

    conservative = along_line = True

    first: Point
    second: Point
    stiffness: Expression
    length: Expression
    span: Span | None = _span()

    @property
    def points(self) -> tuple[Point, Point]:
        return self.first, self.second

    @property
    def link(self) -> tuple[str, str, str]:
        return self.first.body, self.second.body, "spring"

    def measured(self) -> Iterator[Measured]:
        yield Measured(self.stiffness, times(FORCE, LENGTH, -1), "a stiffness")
        yield Measured(self.length, LENGTH, "a length")


@dataclass(frozen=True, slots=True)
class CoordinateDamper(Acting):
    """Rayleigh function coefficient coordinate'^2 / 2."""

    linear = True

    coordinate: str
    coefficient: Expression
    span: Span | None = _span()

    @property
    def coordinates(self) -> tuple[str, ...]:
        return (self.coordinate,)

    @property
    def damping(self) -> Expression:
        return self.coefficient

    def measured(self) -> Iterator[Measured]:
        name = self.coordinate
        yield Measured(self.coefficient, times(ENERGY, TIME), f"the coefficient of a damper on '{name}'", name, -2)


class _BetweenPoints(Acting):
    """A damper between two points."""

    __slots__ = ()

    first: Point
    second: Point
    coefficient: Expression

    @property
    def points(self) -> tuple[Point, Point]:
        return self.first, self.second

    @property
    def damping(self) -> Expression:
        return self.coefficient

    def measured(self) -> Iterator[Measured]:
        yield Measured(self.coefficient, times(FORCE, SPEED, -1), "a damping coefficient")


@dataclass(frozen=True, slots=True)
class PointDamper(_BetweenPoints):
    """Along the line between two points: Rayleigh function coefficient (d distance/dt)^2 / 2."""

    along_line = True

    first: Point
    second: Point
    coefficient: Expression
    span: Span | None = _span()

    @property
    def link(self) -> tuple[str, str, str]:
        return self.first.body, self.second.body, "damper"


@dataclass(frozen=True, slots=True)
class IsotropicDamper(_BetweenPoints):
    """Against all relative motion of two points: Rayleigh function coefficient |V_first - V_second|^2 / 2.

    Its two forces are opposite but not along the line, so that together they are a couple: it does not conserve
    angular momentum, as no pair of points alone can do it (it stands for a joint, a bath, a medium).
    """

    first: Point
    second: Point
    coefficient: Expression
    span: Span | None = _span()

    @property
    def link(self) -> tuple[str, str, str]:
        return self.first.body, self.second.body, "isotropic damper"


@dataclass(frozen=True, slots=True)
class ForceFunction(_Free):
    """A free force function U(q, t), added to L; a ``potential`` in the description is stored as U = -potential.

    ``spelled`` remembers which of the two the description used ("force function" or "potential") and is only for
    writing it back; ``expression`` is what stands in the file.
    """

    conservative = True

    expression: Expression
    spelled: str = "force function"
    span: Span | None = _span()
    as_written: ForceFunction | None = None

    def measured(self) -> Iterator[Measured]:
        yield Measured(self.expression, ENERGY, f"a {self.spelled}")


@dataclass(frozen=True, slots=True)
class Rayleigh(_Free):
    """A free dissipation function R(q, q'); its generalised forces are -dR/dq'."""

    expression: Expression
    span: Span | None = _span()
    as_written: Rayleigh | None = None

    @property
    def dissipation_function(self) -> Expression:
        return self.expression

    def measured(self) -> Iterator[Measured]:
        yield Measured(self.expression, times(ENERGY, TIME, -1), "a dissipation function")


@dataclass(frozen=True, slots=True)
class GeneralizedForce(_Free):
    """Q for some coordinates, as expressions in coordinates, velocities, parameters and t."""

    components: tuple[tuple[str, Expression], ...]
    span: Span | None = _span()
    as_written: GeneralizedForce | None = None

    @property
    def coordinates(self) -> tuple[str, ...]:
        return tuple(name for name, _ in self.components)

    @property
    def given(self) -> tuple[Expression, ...]:
        return tuple(force for _, force in self.components)

    def without(self, held: Container[str]) -> Self | None:
        remaining = tuple((name, force) for name, force in self.components if name not in held)
        written = None if self.as_written is None else self.as_written.without(held)
        return replace(self, components=remaining, as_written=written) if remaining else None

    def simplified(self) -> Self | None:
        remaining = tuple((name, force) for name, force in self.components if rational(force) != 0)
        written = None if self.as_written is None else self.as_written.simplified()
        return replace(self, components=remaining, as_written=written) if remaining else None

    def measured(self) -> Iterator[Measured]:
        for name, force in self.components:
            yield Measured(force, ENERGY, f"the generalised force of '{name}'", name, -1)


@dataclass(frozen=True, slots=True)
class PointForce(_Free):
    """A force on a point of a body, with components in the axes of ``axes`` (the body itself: a follower force)."""

    point: Point
    components: Vector
    axes: str
    span: Span | None = _span()
    as_written: PointForce | None = None

    @property
    def points(self) -> tuple[Point]:
        return (self.point,)

    @property
    def bodies(self) -> tuple[str, ...]:
        return self.point.body, self.axes

    @property
    def given(self) -> Vector:
        return self.components

    def measured(self) -> Iterator[Measured]:
        for x in self.components:
            yield Measured(x, FORCE, "a force")


@dataclass(frozen=True, slots=True)
class Torque(_Free):
    """A torque on a body, with components in the axes of ``axes``; ``reaction_on`` feels the opposite one."""

    body: str
    components: Vector
    axes: str
    reaction_on: str | None = None
    span: Span | None = _span()
    as_written: Torque | None = None

    @property
    def bodies(self) -> tuple[str, ...]:
        """What the reaction acts on moves by itself only where it is no frame at rest."""
        other = (self.reaction_on,) if self.reaction_on not in (None, INERTIAL) else ()
        return self.body, self.axes, *other

    @property
    def given(self) -> Vector:
        return self.components

    @property
    def link(self) -> tuple[str, str, str] | None:
        return None if self.reaction_on is None else (self.reaction_on, self.body, "torque")

    def measured(self) -> Iterator[Measured]:
        for x in self.components:
            yield Measured(x, ENERGY, "a torque")


#: What is made of formulas that may hold speeds and unit vectors.
Free = ForceFunction | Rayleigh | GeneralizedForce | PointForce | Torque
Load = (
    NewtonianGravity
    | UniformGravity
    | CoordinateSpring
    | PointSpring
    | CoordinateDamper
    | PointDamper
    | IsotropicDamper
    | Free
)
