"""The dimensions of a whole description: what each place demands, and what then follows for every name."""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Iterable
from fractions import Fraction
from itertools import pairwise

from mbsym.expressions.message import Message
from mbsym.expressions.place import Span
from mbsym.expressions.rates import acceleration_name, velocity_name
from mbsym.expressions.tree import ZERO, Expression, Name
from mbsym.model.claims import CLAIMS, Claim
from mbsym.model.constraints import Coincide, Constraint, Distance, Parallel, Relation, Rolling, Velocity
from mbsym.model.loads import (
    Load,
)
from mbsym.model.momenta import momentum_names
from mbsym.model.speeds import OMEGA
from mbsym.model.system import Body, Point, System, Vector
from mbsym.model.units import (
    BASES,
    ENERGY,
    INERTIA,
    LENGTH,
    MASS,
    MULTIPLES,
    NONE,
    RATE,
    SPEED,
    TIME,
    Declared,
    Dimension,
    Units,
    times,
)
from mbsym.source.reading import Reading
from mbsym.source.units.expressions import Dimensions, Form, Inference
from mbsym.source.units.reading import Unit, unit

_EXACT = 1e-9


#: Claims whose dimension is fixed.  Those in notation and dimensionless time, and those that hold up to a factor, are
#: only asked to add like to like.
_FIXED: dict[str, tuple[Dimension, str]] = {
    "kinetic energy": (ENERGY, "a kinetic energy"),
    "force function": (ENERGY, "a force function"),
    "potential energy": (ENERGY, "a potential energy"),
    "lagrangian": (ENERGY, "a Lagrangian"),
    "hamiltonian": (ENERGY, "a Hamiltonian"),
    "routh function": (ENERGY, "a Routh function"),
    "reduced potential": (ENERGY, "a potential"),
    "angular velocity": (RATE, "an angular velocity"),
    "relative angular velocity": (RATE, "an angular velocity"),
    "direction cosine": (NONE, "a direction cosine"),
    "position": (LENGTH, "a position"),
    "velocity": (SPEED, "a velocity"),
}


def checked_units(system: System, declared: tuple[Declared, ...], reading: Reading) -> Units:
    """The units of a system after every expression in it was checked for its dimension.

    Without declared units nothing is checked, and there are none.
    """
    known = {one.name: found for one in declared if isinstance(found := unit(one.text), Unit)}
    if len(known) < len(declared) or not declared:
        return Units(declared)
    base = _base_units(declared, known, reading)

    def complain(message: str, span: Span | None, hint: str | None) -> None:
        reading.error("dimension", message, span, hint)

    inference = Inference({name: Form(found.dimension) for name, found in known.items()})
    _System(system, Dimensions(inference, _form_of(system), complain)).check()
    names = (*system.coordinates, *system.parameter_names, *(prescribed.name for prescribed in system.prescribed))
    names = (*names, *system.variables, *system.input_names, *(output.name for output in system.outputs))
    more = (*(one.name for one in system.notation), *(abbreviation.name for abbreviation in system.abbreviations))
    follows = ((name, inference.dimension(name)) for name in (*names, *more))
    inferred = tuple((name, found) for name, found in follows if found is not None)
    return Units(declared, inferred, base)


def dimensions_of(
    system: System, complain: Callable[[str, Span | None, str | None], None], forms: dict[str, Form]
) -> Dimensions:
    """The dimensions that follow from the places of a description and from those that are ``given``.

    ``complain`` is told of what is asked afterwards, not of what contradicts itself in the description.
    """
    known = {
        one.name: Form(found.dimension) for one in system.units.declared if isinstance(found := unit(one.text), Unit)
    }
    inference = Inference({**known, **forms})
    _System(system, Dimensions(inference, _form_of(system), lambda *_: None)).check()
    return Dimensions(inference, _form_of(system), complain)


def _form_of(system: System) -> Callable[[str], Form]:
    """The dimension of a name, that of its rates included."""
    rates = {velocity_name(name): (name, 1) for name in system.coordinates}
    rates |= {acceleration_name(name): (name, 2) for name in system.coordinates}
    rates |= {velocity_name(name): (name, 1) for name in system.variables}
    momenta = {} if system.speeds else {p: q for q, p in momentum_names(system).items()}
    vectors = {name for body in system.bodies for vector in body.orientation for name in vector.components}

    def form(name: str) -> Form:
        if name == "t":
            return Form(TIME)
        if name in OMEGA:
            return Form(RATE)
        if name in momenta:
            return Form(times(ENERGY, TIME, 1), ((momenta[name], Fraction(-1)),))
        name, order = rates.get(name, (name, 0))
        if name in vectors:
            return Form(times(NONE, TIME, -order))
        return Form(times(NONE, TIME, -order), ((name, Fraction(1)),))

    return form


def _base_units(
    declared: tuple[Declared, ...], known: dict[str, Unit], reading: Reading
) -> tuple[tuple[str, str], ...]:
    """What the base units are called; complains about a unit that is no product of those before it.

    With base units of sizes b_i a unit of dimension (d_i) has the size prod b_i^d_i: linear in logarithms, solved by
    elimination; a pure number has size one.
    """
    rows: list[tuple[str, Dimension, float]] = []  # the pivot, with exponent one, and what it stands with
    for one in declared:
        left, size = known[one.name].dimension, math.log(known[one.name].factor)
        for pivot, row, value in rows:
            power = dict(left).get(pivot, Fraction(0))
            left, size = times(left, row, -power), size - float(power) * value
        if left:
            pivot, power = left[0]
            row, value = times(NONE, left, 1 / power), size / float(power)
            rows = [
                (p, times(r, row, -dict(r).get(pivot, Fraction(0))), v - float(dict(r).get(pivot, 0)) * value)
                for p, r, v in rows
            ]
            rows.append((pivot, row, value))
        elif abs(size) > _EXACT:
            reading.error("incoherent-units", *_incoherent(one, known[one.name], math.exp(size)))
    alone = {row[0][0]: math.exp(value) for _, row, value in rows if len(row) == 1}
    return tuple((base, name) for base in BASES if base in alone and (name := _called(base, alone[base])) is not None)


def _incoherent(one: Declared, found: Unit, factor: float) -> tuple[str, Span | None, str]:
    if not found.dimension:
        hint = Message(
            "numbers are taken as they stand: multiply them by [[factor]], and write rad or 1", factor=f"{factor:.6g}"
        )
        return (
            Message("angles are in radians, and pure numbers without a factor: '[[what]]' is neither", what=one.text),
            one.span,
            hint,
        )
    message = Message("'[[what]]' does not belong to the system of units of the names before", what=one.text)
    return (
        message,
        one.span,
        Message(
            "in their units the numbers of '[[name]]' are [[factor]] times as large",
            name=one.name,
            factor=f"{factor:.6g}",
        ),
    )


def _called(base: str, size: float) -> str | None:
    """The name of a multiple of a base unit, if it has one."""
    table = MULTIPLES.get(base, {1: base})
    return next((name for known, name in table.items() if abs(math.log(size / known)) < _EXACT), None)


class _System:
    """Walks through a system and says what each place holds."""

    def __init__(self, system: System, dimensions: Dimensions) -> None:
        self.system = system
        self.dimensions = dimensions

    def expect(self, expression: Expression | None, wanted: Dimension | Form, what: str) -> None:
        if expression is not None:
            form = wanted if isinstance(wanted, Form) else Form(wanted)
            self.dimensions.expect(expression, form, what)

    def vector(self, vector: Vector | None, dimension: Dimension, what: str) -> None:
        for component in vector or ():
            self.expect(component, dimension, what)

    def of(self, name: str) -> Form:
        return self.dimensions.name_form(name)

    def check(self) -> None:
        system = self.system
        for motion in system.prescribed:
            self.expect(
                motion.rate, self.of(motion.name).times(Form(RATE)), Message("the rate of '[[name]]'", name=motion.name)
            )
            self.expect(motion.initial, self.of(motion.name), f"'{motion.name}'")
        for body in system.bodies:
            self.body(body)
        for load in system.loads:
            self.load(load)
        for constraint in system.constraints:
            self.constraint(constraint)
        for one in system.inputs:
            self.expect(one.held, self.of(one.name), f"'{one.name}'")
        for output in system.outputs:
            self.expect(output.value, self.of(output.name), f"'{output.name}'")
        for relation in system.relations:
            self.expect(relation.value, self.of(relation.name), f"'{relation.name}'")
        for symbol in system.notation:
            self.expect(symbol.value, self.of(symbol.name), f"'{symbol.name}'")
        for abbreviation in system.abbreviations:
            self.expect(abbreviation.value, self.of(abbreviation.name), f"'{abbreviation.name}'")
        for assumption in system.assumptions:
            self.dimensions.alike(assumption.left, assumption.right, "compared")
        for limit in system.limits:
            self.expect(limit.lower, self.of(limit.coordinate), f"'{limit.coordinate}'")
            self.expect(limit.upper, self.of(limit.coordinate), f"'{limit.coordinate}'")
        for entry in system.motion:
            self.expect(entry.value, self.of(entry.coordinate), f"'{entry.coordinate}'")
            self.expect(
                entry.rate,
                self.of(entry.coordinate).times(Form(RATE)),
                Message("the rate of '[[coordinate]]'", coordinate=entry.coordinate),
            )
        self.expect(system.time_scale, RATE, "the rate of dimensionless time")
        for claim in system.claims:
            check_claim(claim, self.dimensions, system.time_scale is not None, system.variables)

    def body(self, body: Body) -> None:
        for angle in body.rotation.angles:
            self.expect(angle, NONE, "a rotation angle")
        self.vector(body.connection_point, LENGTH, "a connection point")
        self.vector(body.relative_velocity, SPEED, "a relative velocity")
        self.vector(body.mass_centre, LENGTH, "a mass centre")
        self.expect(body.mass, MASS, "a mass")
        for row in body.inertia.tensor if body.inertia else ():
            self.vector(row, INERTIA, "a moment of inertia")
        self.vector(body.gyrostatic_moment, times(INERTIA, RATE), "a gyrostatic moment")
        for speed in body.speeds:
            self.expect(speed.form, self.of(speed.name), f"'{speed.name}'")
        for shape in body.shapes:
            self.vector(shape.at, LENGTH, "a place")
            for size in shape.size:
                self.expect(size, LENGTH, "a size")

    def load(self, load: Load) -> None:
        self.points(load.points)
        for formula, dimension, what, coordinate, power in load.measured():
            wanted = Form(dimension).times(self.of(coordinate), power) if coordinate else dimension
            self.expect(formula, wanted, what)

    def constraint(self, constraint: Constraint) -> None:
        match constraint:
            case Coincide(first, second):
                self.points((first, second))
            case Parallel(one, other):
                for axis in (one, other):
                    self.alike(axis.direction)
            case Distance(first, second, length):
                self.points((first, second))
                self.expect(length, LENGTH, "a distance that is kept")
            case Rolling(contact=contact):
                self.vector(contact, LENGTH, "a point of contact")
            case Relation(left, right) | Velocity(left, right):
                self.dimensions.alike(left, right, "set equal")

    def alike(self, vector: Vector) -> None:
        """Components that are not 0 have one dimension, whatever it is."""
        present = [component for component in vector if component != ZERO]
        for first, second in pairwise(present):
            self.dimensions.alike(first, second, "components of one axis")

    def points(self, points: Iterable[Point]) -> None:
        for point in points:
            self.vector(point.position, LENGTH, "a point")


def check_claim(claim: Claim, dimensions: Dimensions, scaled: bool, variables: Container[str]) -> None:
    """Complains where what was printed cannot be the quantity that it is said to be; ``scaled``: time is a number.

    ``variables`` are the speeds and components, whose first derivative is their acceleration.
    """
    if claim.right is not None:
        dimensions.alike(claim.equals, claim.right, "compared")
    elif claim.kind in _FIXED:
        wanted, what = _FIXED[claim.kind]
        dimensions.expect(claim.equals, Form(wanted), what)
    elif claim.kind == "acceleration":
        rate = Name(velocity_name(claim.of) if claim.of in variables else acceleration_name(claim.of))
        dimensions.alike(rate, claim.equals, "equal")
    elif claim.of_expression is not None and not CLAIMS[claim.kind].order:
        dimensions.alike(claim.of_expression, claim.equals, "equal")
    elif claim.kind in CLAIMS:
        dimensions.with_name(claim.variable, Form() if scaled else Form(RATE)).of(claim.equals)
