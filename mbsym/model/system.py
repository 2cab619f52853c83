"""What a description means: a system of bodies joined in a tree, as frozen dataclasses of parsed expressions.

Conventions (all of mbsym follows them; the reports state them):

* Direction cosines are passive, v^k = R^jk v^j.  Axes {a1, a2, a3} with angles {x1, x2, x3} mean
  R^jk = C_a3(x3) C_a2(x2) C_a1(x1); the new axes are the rows of R.  Axis number 0 means "no rotation here".
* Body k hangs on body j at its connection point O_k, r^j_Ok in the axes of body j; the mass centre is r^k_Ck in its
  own axes.  Body "0" is the inertial frame.
* An inertia tensor is the symmetric matrix J of T = w.J w / 2, so its products carry the minus sign
  (J13 = -int x z dm).
* L = T + U with the force function U = -potential energy.
* A gyrostatic moment h is the constant angular momentum of symmetric rotors inside a body, in the body's axes.  It
  adds h.omega to T and no coordinate.  T is then Routh's function of the rotors, additive constants dropped: with h_a =
  J_a (omega_a + s') constant for a rotor that spins freely about its axis a (its axial moment J_a is not part of the
  body's tensor), with h_a = J_a s' for one driven at the constant rate s' (J_a is part of it).

Spans point back into the description; they take no part in equality, so two spellings of one system compare equal.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

from mbsym.expressions.guessing import GuessesNames
from mbsym.expressions.place import Span
from mbsym.expressions.rates import acceleration_name as acceleration_name
from mbsym.expressions.rates import derivative_names
from mbsym.expressions.rates import velocity_name as velocity_name
from mbsym.expressions.table import Table
from mbsym.expressions.tree import Expression, Name, names
from mbsym.model.basics import INERTIAL as INERTIAL
from mbsym.model.basics import Point as Point
from mbsym.model.basics import Vector, _span
from mbsym.model.basics import rational as rational
from mbsym.model.claims import Abbreviation, Claim
from mbsym.model.inputs import Input, Output
from mbsym.model.linear import LinearModel
from mbsym.model.loads import Free, Load, NewtonianGravity, UniformGravity
from mbsym.model.speeds import Quaternion, Speed, UnitVector
from mbsym.model.units import Units

if TYPE_CHECKING:
    from mbsym.model.constraints import Constraint


Tensor = tuple[Vector, Vector, Vector]

#: The languages of reports, with what LaTeX's babel calls them; each but the first has its messages in a file.
LANGUAGES = {"en": "", "ru": "russian", "es": "spanish,es-noquoting,es-noshorthands,es-nodecimaldot"}
#: ``en, ru or es``.
ONE_OF_LANGUAGES = " or ".join(", ".join(LANGUAGES).rsplit(", ", 1))


@dataclass(frozen=True, slots=True)
class Parameter:
    """A constant.  ``sign`` is one of real, positive, nonnegative, negative, nonpositive, nonzero."""

    name: str
    sign: str = "real"
    value: Expression | None = None
    meaning: str = ""
    span: Span | None = _span()


@dataclass(frozen=True, slots=True)
class Prescribed:
    """An angle or length that is a known function of time: ``name' = rate`` (a constant), ``name(0) = initial``.

    ``given`` names the free function of time that it is, or is a derivative of, where it is one: no constant but the
    next derivative, by its name, is its rate then.
    """

    name: str
    rate: Expression
    initial: Expression | None = None
    meaning: str = ""
    span: Span | None = _span()
    given: str = ""


#: So many derivatives of a free function of time are quantities that others may depend on: bodies have accelerations.
DERIVATIVES = 2


@dataclass(frozen=True, slots=True)
class Given:
    """A free function of time: a symbol, as its derivatives are; ``law`` is what it is where numbers are wanted."""

    name: str
    law: Expression | None = None
    meaning: str = ""
    span: Span | None = _span()

    @property
    def names(self) -> tuple[str, ...]:
        """a, a', a'': what equations hold of it."""
        return derivative_names(self.name, DERIVATIVES)

    @property
    def chain(self) -> tuple[Prescribed, ...]:
        """a and its derivatives as prescribed quantities, each with the next one for its rate."""
        names_ = derivative_names(self.name, DERIVATIVES + 1)
        return tuple(
            Prescribed(name, Name(rate), None, self.meaning, self.span, self.name) for name, rate in pairwise(names_)
        )


@dataclass(frozen=True, slots=True)
class Rotation:
    """Rotation axis numbers (1, 2, 3; 0 for none) and the angle about each, in the order of turning.

    Readers drop the unused turns, so that {3, 0, 0} and {3} are equal.
    """

    axes: tuple[int, ...] = ()
    angles: tuple[Expression, ...] = ()

    def turns(self) -> Iterator[tuple[int, Expression]]:
        """(axis, angle) for each turn that there is."""
        return ((axis, angle) for axis, angle in zip(self.axes, self.angles, strict=True) if axis)


@dataclass(frozen=True, slots=True)
class Inertia:
    """A tensor about the connection point (``about = "joint"``) or about the ``"mass centre"``.

    ``accepted``: taken as given although its principal moments may break the triangle inequality, as those of
    identified models do.
    """

    about: str
    tensor: Tensor
    accepted: bool = False
    span: Span | None = _span()


@dataclass(frozen=True, slots=True)
class Shape:
    """What a body looks like, for drawing only: ``kind`` of SHAPES with its sizes, in axes of its own on the body.

    ``at`` is its middle and ``rotation`` leads to its axes, both from the axes of the body.
    """

    kind: str
    size: tuple[Expression, ...]
    at: Vector
    rotation: Rotation = Rotation()


#: Kind -> how many sizes: edges of a box; radius; radius and length along the third axis; half axes.
SHAPES = {"box": 3, "sphere": 1, "cylinder": 2, "capsule": 2, "ellipsoid": 3}


@dataclass(frozen=True, slots=True)
class Limit:
    """The least and the greatest value of a coordinate, for drawing and reports: no force keeps it between them."""

    coordinate: str
    lower: Expression
    upper: Expression
    span: Span | None = _span()


@dataclass(frozen=True, slots=True)
class Body:
    """One body (or massless frame) and its joint to the body it is attached to.

    ``relative_velocity`` is V^j_Ok as the description gives it (it must equal the derivative of the radius vector),
    or None where it is left to be derived.  ``coordinates`` are the generalised coordinates that this joint
    introduces, in the order in which they count.  ``gyrostatic_moment`` is h in the axes of the body, None where it is
    zero.  ``speeds`` take the place of generalised velocities; with unit vectors of ``orientation`` the axes of the
    body are told by these, and its angles are no variables of the equations.
    """

    name: str
    attached_to: str
    rotation: Rotation
    connection_point: Vector
    relative_velocity: Vector | None
    mass_centre: Vector
    mass: Expression
    inertia: Inertia | None
    coordinates: tuple[str, ...]
    gyrostatic_moment: Vector | None = None
    shapes: tuple[Shape, ...] = ()
    speeds: tuple[Speed, ...] = ()
    orientation: tuple[UnitVector | Quaternion, ...] = ()
    span: Span | None = _span()

    @property
    def own_angles(self) -> tuple[str, ...]:
        """The coordinates of its joint that turn it."""
        turning = {name for _, angle in self.rotation.turns() for name in names(angle)}
        return tuple(name for name in self.coordinates if name in turning)


@dataclass(frozen=True, slots=True)
class Relation:
    """``name = value`` between constants; used from problem 4 on (problems 1 to 3 keep the declared names)."""

    name: str
    value: Expression
    span: Span | None = _span()


@dataclass(frozen=True, slots=True)
class Assumption:
    """``left relation right`` with relation one of < <= > >= !=, between parameters and notation."""

    left: Expression
    relation: str
    right: Expression
    span: Span | None = _span()


@dataclass(frozen=True, slots=True)
class MotionEntry:
    """The unperturbed motion of one coordinate: value + rate * t."""

    coordinate: str
    value: Expression
    rate: Expression
    span: Span | None = _span()


@dataclass(frozen=True, slots=True)
class Notation:
    """A user's own symbol for a group of parameters: ``alpha = (c - b)/a``.  Later ones may use earlier ones."""

    name: str
    value: Expression
    span: Span | None = _span()


@dataclass(frozen=True, slots=True)
class InitialValue:
    """The initial state of one coordinate, for simulation."""

    coordinate: str
    position: Expression | None = None
    velocity: Expression | None = None
    span: Span | None = _span()


@dataclass(frozen=True, slots=True)
class WrittenSymbol:
    """A name as LaTeX: ``latex`` holds symbols, indices, accents and fonts only, as the readers saw to."""

    name: str
    latex: str
    span: Span | None = _span()


@dataclass(frozen=True, repr=False)  # without slots: what is asked for in every loop is remembered
class System(GuessesNames):
    """A whole description.

    ``time_scale`` (a rate) makes time dimensionless in problems 5 and 6: tau = time_scale * t.  ``source`` says where
    the system is from; ``label`` what LaTeX labels have of it in them ("": its name); ``symbols`` how names are written
    in LaTeX, ``language`` in which language ("" is English), ``order`` in which order the subsystems of problems 5 and
    6 are told: by these coordinates, then by the others.
    ``reactions`` are the bodies whose joints' forces and moments are wanted.
    ``start`` are initial values of declared variables, speeds and components of unit vectors and quaternions, as
    ``initial`` are of coordinates.
    ``dependent`` are the coordinates that the constraints express by the others; empty where that is left to mbsym.
    ``small`` is the parameter in whose powers expansions are made.
    ``prescribed`` holds the ``chain`` of each free function of time that is ``given``, too.
    ``linear`` holds the matrices of a system that is given by these; it has no bodies then.
    """

    name: str
    parameters: tuple[Parameter, ...]
    bodies: tuple[Body, ...]
    description: str = ""
    prescribed: tuple[Prescribed, ...] = ()
    given: tuple[Given, ...] = ()
    loads: tuple[Load, ...] = ()
    relations: tuple[Relation, ...] = ()
    assumptions: tuple[Assumption, ...] = ()
    motion: tuple[MotionEntry, ...] = ()
    notation: tuple[Notation, ...] = ()
    time_scale: Expression | None = None
    initial: tuple[InitialValue, ...] = ()
    start: tuple[InitialValue, ...] = ()
    abbreviations: tuple[Abbreviation, ...] = ()
    claims: tuple[Claim, ...] = ()
    units: Units = Units()
    limits: tuple[Limit, ...] = ()
    source: str = ""
    label: str = ""
    symbols: tuple[WrittenSymbol, ...] = ()
    language: str = ""
    order: tuple[str, ...] = ()
    tables: tuple[Table, ...] = ()
    constraints: tuple[Constraint, ...] = ()
    dependent: tuple[str, ...] = ()
    dependent_span: Span | None = _span()
    reactions: tuple[str, ...] = ()
    inputs: tuple[Input, ...] = ()
    outputs: tuple[Output, ...] = ()
    linear: LinearModel | None = None
    small: SmallParameter | None = None

    def __repr__(self) -> str:
        return f"System({self.name!r}, {len(self.bodies)} bodies, coordinates {', '.join(self.coordinates) or 'none'})"

    @cached_property
    def coordinates(self) -> tuple[str, ...]:
        """The generalised coordinates q, body by body: the order of every vector and matrix."""
        if self.linear is not None:
            return self.linear.coordinates
        return tuple(name for body in self.bodies for name in body.coordinates)

    @cached_property
    def velocities(self) -> tuple[str, ...]:
        return tuple(velocity_name(name) for name in self.coordinates)

    @property
    def speeds(self) -> tuple[Speed, ...]:
        """The velocities that the description declares; none where they are the derivatives of the coordinates."""
        return tuple(speed for body in self.bodies for speed in body.speeds)

    @property
    def variables(self) -> tuple[str, ...]:
        """The names of speeds and components of unit vectors and quaternions: what the state holds besides q and q'."""
        vectors = (name for body in self.bodies for vector in body.orientation for name in vector.components)
        return (*vectors, *(speed.name for speed in self.speeds))

    @property
    def begun(self) -> tuple[InitialValue, ...]:
        """The initial values of coordinates as generated code takes them, velocities that are left out being zero.

        None where values of declared variables are given: coordinates and velocities would follow from these.
        """
        return () if self.start else self.initial

    @property
    def without_speeds(self) -> System:
        """The same system in generalised coordinates and their derivatives; claims and abbreviations left out."""
        bodies = tuple(replace(body, speeds=(), orientation=()) for body in self.bodies)
        loads = tuple(replace(x, as_written=None) if isinstance(x, Free) else x for x in self.loads)
        named = {*self.coordinates}  # a dependent speed is none of the coordinates'
        dependent = tuple(name for name in self.dependent if name in named)
        return replace(self, bodies=bodies, loads=loads, claims=(), abbreviations=(), dependent=dependent)

    @property
    def claimable(self) -> tuple[str, ...]:
        """What equations and rows of matrices are called by in claims."""
        return (*self.coordinates, *self.variables)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        return tuple(parameter.name for parameter in self.parameters)

    @property
    def input_names(self) -> tuple[str, ...]:
        return tuple(signal.name for signal in self.inputs)

    @property
    def of_constant_rate(self) -> tuple[Prescribed, ...]:
        """What is prescribed by the description: all but free functions of time and their derivatives."""
        return tuple(item for item in self.prescribed if not item.given)

    @property
    def last_derivatives(self) -> tuple[str, ...]:
        """The rates of the last derivatives of free functions of time: nothing depends on them, and none has a rate."""
        return tuple(derivative_names(item.name, DERIVATIVES + 1)[-1] for item in self.given)

    @property
    def newtonian_fields(self) -> tuple[NewtonianGravity, ...]:
        return tuple(load for load in self.loads if isinstance(load, NewtonianGravity))

    @property
    def uniform_fields(self) -> tuple[UniformGravity, ...]:
        return tuple(load for load in self.loads if isinstance(load, UniformGravity))

    def with_field_order(self, order: int | str) -> System:
        """The same with its Newtonian fields expanded to an order, or exact."""
        loads = tuple(replace(x, order=order) if isinstance(x, NewtonianGravity) else x for x in self.loads)
        return replace(self, loads=loads)

    def body(self, name: str) -> Body:
        """The body of that name.  Raises KeyError where there is none."""
        return self._named[name]

    @cached_property
    def _named(self) -> dict[str, Body]:
        return {body.name: body for body in reversed(self.bodies)}

    def path(self, name: str) -> tuple[str, ...]:
        """From the inertial frame to a body: ("0", ..., name)."""
        path = [name]
        while path[-1] != INERTIAL:
            path.append(self.body(path[-1]).attached_to)
        return tuple(reversed(path))


def with_values(system: System, overrides: Mapping[str, Expression]) -> System:
    """The description with these values of parameters; what its relations give follows from them."""
    stale = overruled(system, overrides)
    parameters = tuple(
        replace(item, value=overrides.get(item.name, None if item.name in stale else item.value))
        for item in system.parameters
    )
    return replace(system, parameters=parameters)


def overruled(system: System, overrides: Iterable[str]) -> set[str]:
    """Parameters that a relation gives and that are made of what is overridden: their own values no longer hold."""
    overridden, dependents = {*overrides}, set[str]()
    for _ in system.relations:
        dependents |= {
            x.name for x in system.relations if x.name not in overridden and names(x.value) & (overridden | dependents)
        }
    return dependents


# A small parameter: what is expanded in its powers, and which variables are fast, which oscillates.


@dataclass(frozen=True)
class SmallParameter:
    """``name`` is a parameter, or with ``powers`` a name of its own: each P there, a parameter or
    a variable, stands for P name^power.

    ``fast`` are the variables that a slow manifold expresses by the others (empty: they are found), ``slow`` those
    that are not among them.  ``leading`` is the variable whose oscillation a periodic solution belongs to ("": it is
    found).
    """

    name: str
    powers: tuple[tuple[str, int], ...] = ()
    fast: tuple[str, ...] = ()
    slow: tuple[str, ...] = ()
    leading: str = ""
    span: Span | None = field(default=None, compare=False, repr=False)
