"""What stands in a description, in HTML as it stands there: expressions in MathML, loads in words."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from markupsafe import Markup, escape

from mbsym.expressions.rates import without_velocity
from mbsym.expressions.tree import ZERO, Call, Expression, Name, Negative, Number, Operation, children
from mbsym.formulas.mathml import (
    APPLY,
    TIMES,
    MathNames,
    bracketed,
    fraction,
    mi,
    mn,
    mo,
    power,
    row,
    sign,
)
from mbsym.model.constraints import Constraint
from mbsym.model.loads import (
    EXACT,
    CoordinateDamper,
    CoordinateSpring,
    ForceFunction,
    GeneralizedForce,
    IsotropicDamper,
    Load,
    NewtonianGravity,
    PointDamper,
    PointForce,
    PointSpring,
    Rayleigh,
    Torque,
    UniformGravity,
)
from mbsym.model.speeds import OMEGA, Speed
from mbsym.model.system import INERTIAL, Point

_FUNCTIONS = {"atan": "arctan", "log": "ln"}
_DOTS = {"dot": "˙", "ddot": "¨"}


# --- expressions ------------------------------------------------------------------------------------------------------


def expression(value: Expression, names: MathNames | _WithSpins) -> Markup:
    """An expression of the description as MathML, as it stands."""
    return Markup(_expression(value, names)[0])


class _WithSpins:
    """The names of a system, and the components of the angular velocity of a body: (omega_2)_1."""

    def __init__(self, names: MathNames, number: int) -> None:
        self.names = names
        self.spins = {
            name: Markup(
                f"<msub><mrow><mo>(</mo><msub><mi>ω</mi><mn>{number}</mn></msub><mo>)</mo></mrow><mn>{k}</mn></msub>"
            )
            for k, name in enumerate(OMEGA, start=1)
        }

    def __getitem__(self, name: str) -> Any:
        return self.spins.get(name) or self.names[name]


def speed_form(one: Speed, names: MathNames, number: int) -> Markup:
    """What a speed is made of; ``number`` is that of its body."""
    return expression(one.form, _WithSpins(names, number))


def speed(name: str, names: MathNames) -> Markup:
    """A speed by name: p, or a dotted coordinate."""
    plain = without_velocity(name)
    return Markup(str(names[name]) if plain == name else str(names[plain].dotted("˙")))


def point_of_table(x: Fraction, y: Fraction, names: MathNames) -> str:
    """(x, y)."""
    return bracketed(f"{expression(Number(x), names)}{mo(',')}{expression(Number(y), names)}")


def _expression(value: Expression, names: MathNames | _WithSpins) -> tuple[str, int]:
    """(MathML, precedence): 1 sum, 2 product, 3 power, 4 atom."""
    match value:
        case Number(number):
            return _number(number), 4 if number >= 0 else 1
        case Name("pi"):
            return mi("π"), 4
        case Name(name):
            base, _, dots = name.rpartition("_")
            return str(names[base].dotted(_DOTS[dots]) if dots in _DOTS and base else names[name]), 4
        case Negative(operand):
            return sign("\u2212") + _bracketed(operand, 2, names), 1
        case Call("sqrt", argument):
            return f"<msqrt>{expression(argument, names)}</msqrt>", 4
        case Call("abs", argument):
            return f"<mrow>{mo('|')}{expression(argument, names)}{mo('|')}</mrow>", 4
        case Call(function):
            inner = bracketed(mo(",").join(expression(one, names) for one in children(value)))
            return f"<mrow>{mi(_FUNCTIONS.get(function, function))}{APPLY}{inner}</mrow>", 4
        case Operation("/", left, right):
            return fraction(expression(left, names), expression(right, names)), 4
        case Operation("**", base, exponent):
            # Of a fraction the exponent would seem to belong to the denominator.
            return power(_bracketed(base, 5 if _is_fraction(base) else 4, names), expression(exponent, names)), 3
        case Operation("*", Negative(left), right):
            return _expression(Negative(Operation("*", left, right)), names)
        case Operation("*", left, right):
            return _bracketed(left, 2, names) + TIMES + _bracketed(right, 2, names), 2
        case Operation(operator, left, right):
            shown = mo("\u2212" if operator == "-" else operator)
            return _bracketed(left, 1, names) + shown + _bracketed(right, 2 if operator == "-" else 1, names), 1
    raise TypeError(f"not an expression: {value!r}")


def _bracketed(value: Expression, wanted: int, names: MathNames | _WithSpins) -> str:
    text, precedence = _expression(value, names)
    return text if precedence >= wanted else bracketed(text)


def _is_fraction(value: Expression) -> bool:
    match value:
        case Operation("/"):
            return True
        case Number(number):
            return "<mfrac>" in _number(number)
    return False


def _number(value: Fraction) -> str:
    before = sign("\u2212") if value < 0 else ""
    if value.denominator == 1:
        return before + mn(abs(value.numerator))
    shown = repr(abs(float(value)))
    if "e" not in shown and Fraction(shown) == abs(value):
        return before + mn(shown)
    return before + fraction(mn(abs(value.numerator)), mn(value.denominator))


# --- loads ------------------------------------------------------------------------------------------------------------


def load_in_words(load: Load, names: MathNames) -> Markup:
    """A load with its data, and the formula by which it acts where that is short."""
    return _Loads(names).text(load)


def constraint_in_words(constraint: Constraint, names: MathNames) -> Markup:
    """A constraint with its data."""
    from mbsym.report.constraint_description import Medium, described

    write = _Loads(names)
    medium = Medium(
        lambda left, right: _math(expression(left, names), mo("="), expression(right, names)),
        write.math,
        lambda value: _math(write.vector(value)),
        write.frame,
        write.point,
    )
    said, values = described(constraint, medium)
    text = escape(said)
    for name, value in values.items():
        text = text.replace(f"[[{name}]]", escape(value))
    return text


class _Loads:
    def __init__(self, names: MathNames) -> None:
        self.names = names

    def text(self, load: Load) -> Markup:
        """What acts, between what, with which data."""
        match load:
            case UniformGravity(acceleration):
                return _words("Uniform gravity, {} in inertial axes.", self.equal("g", self.vector(acceleration)))
            case NewtonianGravity(constant, centre, about, order):
                return self.newtonian(constant, centre, about, order)
            case CoordinateSpring(coordinate, stiffness, rest):
                u = self.quadratic(stiffness, self.stretched(str(self.names[coordinate]), rest), "U", "\u2212")
                said = "Spring of {}, stiffness {}, rest at {}: {}."
                return _words(said, self.coordinate(coordinate), self.math(stiffness), self.math(rest), u)
            case PointSpring(first, second, stiffness, length):
                u = self.quadratic(stiffness, self.stretched(mi("d"), length), "U", "\u2212")
                said = "Spring between {} and {}, stiffness {}, natural length {}: {} with the distance {}."
                ends = self.point(first), self.point(second)
                return _words(said, *ends, self.math(stiffness), self.math(length), u, _math(mi("d")))
            case CoordinateDamper(coordinate, coefficient):
                r = self.quadratic(coefficient, str(self.names[coordinate].dotted("˙")), "R", "")
                said = "Damper of {}, coefficient {}: dissipation function {}."
                return _words(said, self.coordinate(coordinate), self.math(coefficient), r)
            case PointDamper(first, second, coefficient):
                r = self.quadratic(coefficient, f'<mover accent="true">{mi("d")}<mo>˙</mo></mover>', "R", "")
                ends = self.point(first), self.point(second)
                said = "Damper along the line between {} and {}, coefficient {}: dissipation function {} with the "
                return _words(said + "distance {}.", *ends, self.math(coefficient), r, _math(mi("d")))
            case IsotropicDamper(first, second, coefficient):
                r = self.quadratic(coefficient, mi("v"), "R", "")
                data = self.point(first), self.point(second), self.math(coefficient)
                said = (
                    "Isotropic damper between {} and {}, coefficient {}: dissipation function {} with their relative "
                )
                return _words(said + "velocity {}.", *data, r, _math(mi("v")))
            case ForceFunction(spelled=spelled, written=value):
                before = sign("\u2212") if spelled == "potential" else ""
                left = _math(before, mi("U"), mo("="), expression(value, self.names))
                return _words("{}: {}.", spelled.capitalize(), left)
            case Rayleigh(value):
                return _words("Dissipation function: {}.", self.equal("R", expression(value, self.names)))
            case GeneralizedForce(components):
                forces = [
                    _math(f"<msub>{mi('Q')}{self.names[name]}</msub>", mo("="), expression(value, self.names))
                    for name, value in components
                ]
                return _words("Generalised force{}: {}.", "s" if len(forces) > 1 else "", Markup(", ").join(forces))
            case PointForce(point, components, axes):
                force = _math(self.vector(components))
                return _words("Force {} in the axes of {}, at {}.", force, self.frame(axes), self.point(point))
            case Torque(body, components, axes, reaction_on):
                torque = _math(self.vector(components)), self.frame(axes), self.frame(body)
                if reaction_on is None:
                    return _words("Torque {} in the axes of {}, on {}.", *torque)
                opposite = self.frame(reaction_on)
                return _words("Torque {} in the axes of {}, on {}; the opposite one on {}.", *torque, opposite)

    def newtonian(self, constant: Expression, centre: str, about: str, order: int | str) -> Markup:
        nu = str(expression(constant, self.names))
        given = _math(nu) if nu == mi("ν") else _math(mi("ν"), mo("="), nu)
        data = self.frame(centre), given
        if order == EXACT:
            said = "Newtonian field of a centre at the origin of {}, with {} and exact distances of the mass centres "
            said += "(MacCullagh's formula for extended bodies), on the bodies that {} carries."
            return _words(said, *data, self.frame(about))
        said = "Newtonian field of a centre at the origin of {}, with {}, approximate: expanded to order {} about the "
        return _words(said + "origin of {}, on the bodies that this frame carries.", *data, order, self.frame(about))

    def math(self, value: Expression) -> Markup:
        return _math(expression(value, self.names))

    def equal(self, name: str, right: str) -> Markup:
        return _math(mi(name), mo("="), right)

    def coordinate(self, name: str) -> Markup:
        return _math(str(self.names[name]))

    def stretched(self, what: str, rest: Expression) -> str:
        return what if rest == ZERO else bracketed(what + mo("\u2212") + _bracketed(rest, 2, self.names))

    def quadratic(self, coefficient: Expression, what: str, name: str, before: str) -> Markup:
        """name = -1/2 coefficient what^2."""
        half = (sign(before) if before else "") + fraction(mn(1), mn(2))
        square = power(what, mn(2))
        return _math(mi(name), mo("="), half, TIMES, _bracketed(coefficient, 2, self.names), TIMES, square)

    def vector(self, values: Sequence[Expression]) -> str:
        return row([expression(x, self.names) for x in values])

    def frame(self, name: str) -> Markup:
        return Markup("the inertial frame") if name == INERTIAL else Markup("<i>{}</i>").format(name)

    def point(self, point: Point) -> Markup:
        return _words("the point {} of {}", _math(self.vector(point.position)), self.frame(point.body))


def _math(*parts: str) -> Markup:
    return Markup(f"<math>{''.join(parts)}</math>")


def _words(said: str, *data: object) -> Markup:
    """A sentence of ours with data: what is no markup is escaped."""
    return Markup(said).format(*map(escape, data))
