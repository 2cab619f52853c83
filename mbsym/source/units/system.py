"""Dimensions of expressions and of whole descriptions.

What is added or compared must be alike, what a function takes must be a number.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Iterable
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import pairwise

from mbsym.expressions.message import Message
from mbsym.expressions.place import Span
from mbsym.expressions.rates import acceleration_name, velocity_name
from mbsym.expressions.table import Table
from mbsym.expressions.tree import ZERO, Call, Expression, Name, Negative, Number, Operation, names, text
from mbsym.model.claims import CLAIMS, Claim
from mbsym.model.constraints import Coincide, Constraint, Distance, Parallel, Relation, Rolling, Velocity
from mbsym.model.loads import Load
from mbsym.model.momenta import momentum_names
from mbsym.model.speeds import OMEGA
from mbsym.model.system import Body, Point, System, Vector, rational
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
    written,
)
from mbsym.source.reading import Reading
from mbsym.source.units.reading import Unit, unit

_MOST = 40

#: Said instead of exponents.
_NAMED = {NONE: "a pure number", MASS: "a mass (kg)", LENGTH: "a length (m)", TIME: "a time (s)"}

Complain = Callable[[str, Span | None, str | None], None]


@dataclass
class Dimensions:
    """Reads expressions; complains where dimensions do not agree."""

    inference: Inference
    name_form: Callable[[str], Form]
    complain: Complain
    fresh: int = 0

    def with_name(self, name: str, form: Form) -> Dimensions:
        """The same with one more name, the variable of a polynomial; "" is no name."""
        known = self.name_form
        return replace(self, name_form=lambda other: form if other == name else known(other)) if name else self

    def expect(self, expression: Expression, expected: Form, what: str) -> None:
        """An expression must have a dimension.  A number alone may stand for anything, in the units of the rest."""
        if not names(expression):
            return
        form = self.of(expression)
        if form is not None and not self.inference.equate(form, expected):
            message = Message(
                "[[shown]] is [[told]], and [[what]] is [[told2]]",
                shown=_shown(expression),
                told=self.told(form),
                what=what,
                told2=self.told(expected),
            )
            self.complain(message, _place(expression), None)

    def alike(self, left: Expression, right: Expression, how: str) -> None:
        """Two expressions must have the same dimension; a number alone goes with anything."""
        form, other = (self.of(side) if names(side) else None for side in (left, right))
        if form is not None and other is not None and not self.inference.equate(form, other):
            self.complain(self._apart(left, form, right, other, how), _place(right) or _place(left), None)

    def of(self, expression: Expression) -> Form | None:
        """The dimension; None of a zero, which goes with every one."""
        match expression:
            case Number(value):
                return None if value == 0 else Form()
            case Name(name):
                return Form() if name == "pi" else self.name_form(name)
            case Negative(operand):
                return self.of(operand)
            case Call(name, argument, table=Table()):  # the numbers in it have one dimension each, whatever they are
                inner = self.of(argument)
                if inner is not None:
                    self._tabulated(name, argument, inner)
                return self.name_form(name)
            case Call("sqrt", argument):
                inner = self.of(argument)
                return None if inner is None else inner.to_the(Fraction(1, 2))
            case Call("abs", argument):
                return self.of(argument)
            case Call("sign" | "step", argument):
                self.of(argument)
                return Form()
            case Call("pulse", argument, more=(start, end)):
                self._sum(Operation("-", argument, start, expression.span), argument, start)
                self._sum(Operation("-", argument, end, expression.span), argument, end)
                return Form()
            case Call(function, argument):
                self._number(
                    argument,
                    Message("[[function]] takes a pure number, such as an angle in radians", function=function),
                )
                return Form()
            case Operation("**", base, exponent):
                return self._power(base, exponent)
            case Operation("*", left, right):
                return self._product(left, right, 1)
            case Operation("/", left, right):
                return self._product(left, right, -1)
            case Operation(_, left, right):
                return self._sum(expression, left, right)
        raise TypeError(expression)

    def _tabulated(self, name: str, argument: Expression, argument_form: Form) -> None:
        """All arguments of a table have one dimension."""
        form = self.name_form(Message("the argument of [[name]]", name=name))
        if not self.inference.equate(argument_form, form):
            message = Message(
                "[[shown]] is [[told]], and the argument of [[name]] is [[told2]]",
                shown=_shown(argument),
                told=self.told(argument_form),
                name=name,
                told2=self.told(form),
            )
            self.complain(message, _place(argument), None)

    def _product(self, left: Expression, right: Expression, power: int) -> Form | None:
        form, other = self.of(left), self.of(right)
        return None if form is None or other is None else form.times(other, power)

    def _power(self, base: Expression, exponent: Expression) -> Form | None:
        inner, power = self.of(base), rational(exponent)
        if power is not None:
            return Form() if power == 0 else None if inner is None else inner.to_the(power)
        self._number(exponent, "an exponent is a pure number")
        self._number(base, "what has a symbol for its exponent is a pure number")
        return Form()

    def _sum(self, whole: Operation, left: Expression, right: Expression) -> Form | None:
        form, other = self.of(left), self.of(right)
        if form is None or other is None:
            return other if form is None else form
        if self.inference.equate(form, other):
            return form
        how = "added" if whole.operator == "+" else "subtracted"
        message = self._apart(left, form, right, other, how)
        number = next((side for side in (left, right) if not names(side)), None)
        hint = None if number is None else "give the number a name and a unit under 'parameters'"
        self.complain(message, _place(right) or whole.span, hint)
        self.fresh += 1
        return Form(NONE, ((f" {self.fresh}", Fraction(1)),))  # one complaint about it is enough

    def _number(self, expression: Expression, rule: str) -> None:
        form = self.of(expression)
        if form is not None and not self.inference.equate(form, Form()):
            message = Message(
                "[[shown]] is [[told]]; [[rule]]", shown=_shown(expression), told=self.told(form), rule=rule
            )
            self.complain(message, _place(expression), None)

    def _apart(self, left: Expression, form: Form, right: Expression, other: Form, how: str) -> Message:
        """That two expressions have different dimensions, and so cannot be added, compared, ..."""
        return Message(
            "[[shown]] is [[told]], [[shown2]] is [[told2]]: they cannot be [[how]]",
            shown=_shown(left),
            told=self.told(form),
            shown2=_shown(right),
            told2=self.told(other),
            how=how,
        )

    def told(self, form: Form) -> str:
        """A dimension in words and SI units."""
        known = self.inference.reduced(form)
        unknown = " times ".join(f"[{name}]" + ("" if power == 1 else f"^{power}") for name, power in known.unknown)
        base = in_words(known.known)
        return (
            base
            if not unknown
            else unknown
            if not known.known
            else Message("[[base]] times [[unknown]]", base=base, unknown=unknown)
        )


def in_words(dimension: Dimension) -> str:
    """``a length (m)``, ``kg*m^2/s^2``, ``a pure number``."""
    return _NAMED.get(dimension) or written(times(NONE, dimension))


def _shown(expression: Expression) -> str:
    written_out = text(expression)
    return f"'{written_out}'" if len(written_out) <= _MOST else f"'{written_out[:_MOST]}...'"


def _place(expression: Expression) -> Span | None:
    """The place of an expression: its own, or that of its first part that has one."""
    if expression.span is not None:
        return expression.span
    match expression:
        case Negative(operand) | Call(_, operand):
            return _place(operand)
        case Operation(_, left, right):
            return _place(left) or _place(right)
    return None


# Dimensions as unknowns: every sum, equation and place of a description says something linear of their exponents.
#
# A ``Form`` is a known dimension times powers of the unknown dimensions of names.  ``Inference`` solves the equations
# as they come, by elimination over the rationals; one that contradicts those before is a slip.


@dataclass(frozen=True, slots=True)
class Form:
    """``known`` times the product of the dimensions of names to the powers of ``unknown``."""

    known: Dimension = NONE
    unknown: tuple[tuple[str, Fraction], ...] = ()

    def times(self, other: Form, power: Fraction | int = 1) -> Form:
        powers = dict(self.unknown)
        for name, exponent in other.unknown:
            powers[name] = powers.get(name, Fraction(0)) + exponent * power
        unknown = tuple((name, exponent) for name, exponent in sorted(powers.items()) if exponent)
        return Form(times(self.known, other.known, power), unknown)

    def to_the(self, power: Fraction | int) -> Form:
        return Form().times(self, power)

    @property
    def is_number(self) -> bool:
        """Whether it is known to be without dimension."""
        return not self.known and not self.unknown


@dataclass
class Inference:
    """What is known of the dimensions of names so far."""

    solved: dict[str, Form] = field(default_factory=dict)

    def reduced(self, form: Form) -> Form:
        """A form with everything put in that is known."""
        while True:
            name = next((name for name, _ in form.unknown if name in self.solved), None)
            if name is None:
                return form
            power = dict(form.unknown)[name]
            rest = Form(form.known, tuple(unknown for unknown in form.unknown if unknown[0] != name))
            form = rest.times(self.solved[name], power)

    def equate(self, left: Form, right: Form) -> bool:
        """Takes ``left = right`` for true; False, and nothing is taken, where that contradicts what is known."""
        difference = self.reduced(left.times(right, -1))
        if not difference.unknown:
            return not difference.known
        name, power = difference.unknown[0]
        rest = Form(difference.known, difference.unknown[1:])
        self.solved[name] = rest.to_the(-1 / power)
        return True

    def dimension(self, name: str) -> Dimension | None:
        """The dimension of a name, if it follows."""
        form = self.reduced(Form(NONE, ((name, Fraction(1)),)))
        return None if form.unknown else form.known


# The dimensions of a whole description: what each place demands, and what then follows for every name.


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
    known = {
        declaration.name: known_unit
        for declaration in declared
        if isinstance(known_unit := unit(declaration.text), Unit)
    }
    if len(known) < len(declared) or not declared:
        return Units(declared)
    base = _base_units(declared, known, reading)

    def complain(message: str, span: Span | None, hint: str | None) -> None:
        reading.error("dimension", message, span, hint)

    inference = Inference({name: Form(known_unit.dimension) for name, known_unit in known.items()})
    _System(system, Dimensions(inference, _form_of(system), complain)).check()
    names = (*system.coordinates, *system.parameter_names, *(prescribed.name for prescribed in system.prescribed))
    names = (*names, *system.variables, *system.input_names, *(output.name for output in system.outputs))
    more = (
        *(notation.name for notation in system.notation),
        *(abbreviation.name for abbreviation in system.abbreviations),
    )
    follows = ((name, inference.dimension(name)) for name in (*names, *more))
    inferred = tuple((name, dimension) for name, dimension in follows if dimension is not None)
    return Units(declared, inferred, base)


def dimensions_of(
    system: System, complain: Callable[[str, Span | None, str | None], None], forms: dict[str, Form]
) -> Dimensions:
    """The dimensions that follow from the places of a description and from those that are ``given``.

    ``complain`` is told of what is asked afterwards, not of what contradicts itself in the description.
    """
    known = {
        declaration.name: Form(known_unit.dimension)
        for declaration in system.units.declared
        if isinstance(known_unit := unit(declaration.text), Unit)
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
    for declaration in declared:
        left, size = known[declaration.name].dimension, math.log(known[declaration.name].factor)
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
            reading.error("incoherent-units", *_incoherent(declaration, known[declaration.name], math.exp(size)))
    alone = {row[0][0]: math.exp(value) for _, row, value in rows if len(row) == 1}
    return tuple((base, name) for base in BASES if base in alone and (name := _called(base, alone[base])) is not None)


def _incoherent(declaration: Declared, known_unit: Unit, factor: float) -> tuple[str, Span | None, str]:
    if not known_unit.dimension:
        hint = Message(
            "numbers are taken as they stand: multiply them by [[factor]], and write rad or 1", factor=f"{factor:.6g}"
        )
        return (
            Message(
                "angles are in radians, and pure numbers without a factor: '[[what]]' is neither", what=declaration.text
            ),
            declaration.span,
            hint,
        )
    message = Message("'[[what]]' does not belong to the system of units of the names before", what=declaration.text)
    return (
        message,
        declaration.span,
        Message(
            "in their units the numbers of '[[name]]' are [[factor]] times as large",
            name=declaration.name,
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

    def expect(self, expression: Expression | None, dimension: Dimension | Form, what: str) -> None:
        if expression is not None:
            form = dimension if isinstance(dimension, Form) else Form(dimension)
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
        for function in system.given:
            self.expect(function.law, self.of(function.name), f"'{function.name}'")
        for body in system.bodies:
            self.body(body)
        for load in system.loads:
            self.load(load)
        for constraint in system.constraints:
            self.constraint(constraint)
        for system_input in system.inputs:
            self.expect(system_input.held, self.of(system_input.name), f"'{system_input.name}'")
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
            expected = Form(dimension).times(self.of(coordinate), power) if coordinate else dimension
            self.expect(formula, expected, what)

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
        dimension, what = _FIXED[claim.kind]
        dimensions.expect(claim.equals, Form(dimension), what)
    elif claim.kind == "acceleration":
        rate = Name(velocity_name(claim.of) if claim.of in variables else acceleration_name(claim.of))
        dimensions.alike(rate, claim.equals, "equal")
    elif claim.of_expression is not None and not CLAIMS[claim.kind].order:
        dimensions.alike(claim.of_expression, claim.equals, "equal")
    elif claim.kind in CLAIMS:
        dimensions.with_name(claim.variable, Form() if scaled else Form(RATE)).of(claim.equals)
