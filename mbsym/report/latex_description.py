"""What stands in a description, in LaTeX as it stands there: expressions and loads."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction

from mbsym.expressions.tree import ZERO, Call, Expression, Name, Negative, Number, Operation
from mbsym.formulas.latex import LatexNames
from mbsym.model.system import (
    EXACT,
    INERTIAL,
    CoordinateDamper,
    CoordinateSpring,
    ForceFunction,
    GeneralizedForce,
    IsotropicDamper,
    Load,
    NewtonianGravity,
    Point,
    PointDamper,
    PointForce,
    PointSpring,
    Rayleigh,
    Torque,
    UniformGravity,
)

# --- expressions ---

_FUNCTIONS = {"atan": "arctan", "log": "ln"}


def call(function: str, argument: str) -> str:
    """A function of one argument, known by Python's name."""
    if function == "sqrt":
        return f"\\sqrt{{{argument}}}"
    return f"\\{_FUNCTIONS.get(function, function)}({argument})"


def expression(value: Expression, names: LatexNames) -> str:
    """An expression of the description, as it stands."""
    return _expression(value, names)[0]


def _expression(value: Expression, names: LatexNames) -> tuple[str, int]:
    """(text, precedence): 1 sum, 2 product, 3 power, 4 atom."""
    match value:
        case Number(number):
            return _number(number), 4 if number >= 0 else 1
        case Name("pi"):
            return r"\pi", 4
        case Name(name):
            base, _, dots = name.rpartition("_")
            if dots in ("dot", "ddot") and base:
                return names[base].accented(dots), 4
            return str(names[name]), 4
        case Negative(operand):
            return "-" + _bracketed(operand, 2, names), 1
        case Call(function, argument):
            return call(function, expression(argument, names)), 4
        case Operation("/", left, right):
            return f"\\frac{{{expression(left, names)}}}{{{expression(right, names)}}}", 4
        case Operation("**", base, exponent):
            # Of a fraction the exponent would seem to belong to the denominator.
            return f"{_bracketed(base, 5 if _is_fraction(base) else 4, names)}^{{{expression(exponent, names)}}}", 3
        case Operation("*", Negative(left), right):
            return _expression(Negative(Operation("*", left, right)), names)
        case Operation("*", left, right):
            return f"{_bracketed(left, 2, names)} {_bracketed(right, 2, names)}", 2
        case Operation(sign, left, right):
            return f"{_bracketed(left, 1, names)} {sign} {_bracketed(right, 2 if sign == '-' else 1, names)}", 1
    raise TypeError(f"not an expression: {value!r}")


def _bracketed(value: Expression, wanted: int, names: LatexNames) -> str:
    text, precedence = _expression(value, names)
    return text if precedence >= wanted else f"({text})"


def _is_fraction(value: Expression) -> bool:
    match value:
        case Operation("/"):
            return True
        case Number(number):
            return _number(number).startswith("\\frac")
    return False


def _number(value: Fraction) -> str:
    if value.denominator == 1:
        return str(value.numerator)
    shown = repr(float(value))
    if "e" not in shown and Fraction(shown) == value:
        return shown
    return f"\\frac{{{value.numerator}}}{{{value.denominator}}}"


# --- loads ---

#: The force function of the Newtonian field of second order.
_NEWTONIAN = (
    r"U = \sum \Bigl[ \frac{\nu\, m}{R} - \frac{\nu\, m}{R^2}\, e \cdot c + \frac{\nu}{R^3} \Bigl( "
    r"\frac{m}{2} \bigl(3 (e \cdot c)^2 - c \cdot c\bigr) + \frac{1}{2} \operatorname{tr} \Theta_C "
    r"- \frac{3}{2}\, e \cdot \Theta_C\, e \Bigr) \Bigr]"
)

#: The terms that the third and the fourth order add, with x = e.c and y = c.c.
_NEWTONIAN_MORE = {
    3: (
        r"\frac{\nu}{R^4} \Bigl( -\frac{m}{2} (5 x^3 - 3 x y) - \frac{3}{2}\, x \operatorname{tr} \Theta_C "
        r"+ \frac{15}{2}\, x\, e \cdot \Theta_C\, e - 3\, e \cdot \Theta_C\, c \Bigr)"
    ),
    4: (
        r"\frac{\nu}{R^5} \Bigl( \frac{m}{8} (35 x^4 - 30 x^2 y + 3 y^2) + \frac{3}{4} (5 x^2 - y) \operatorname{tr} "
        r"\Theta_C - \frac{15}{4} (7 x^2 - y)\, e \cdot \Theta_C\, e + 15\, x\, e \cdot \Theta_C\, c "
        r"- \frac{3}{2}\, c \cdot \Theta_C\, c \Bigr)"
    ),
}

#: The force function with exact distances.
_NEWTONIAN_EXACT = (
    r"U = \sum \Bigl[ \frac{\nu\, m}{|r|} + \frac{\nu}{2 |r|^3} \Bigl( \operatorname{tr} \Theta_C "
    r"- 3\, \frac{r \cdot \Theta_C\, r}{|r|^2} \Bigr) \Bigr]"
)


def load_in_words(load: Load, names: LatexNames, escaped: Callable[[str], str]) -> str:
    """A load with its data, and the formula by which it acts."""
    return _Loads(names, escaped).text(load)


class _Loads:
    def __init__(self, names: LatexNames, escaped: Callable[[str], str]) -> None:
        self.names = names
        self.escaped = escaped

    def text(self, load: Load) -> str:
        match load:
            case UniformGravity(acceleration):
                g = self.vector(acceleration)
                return f"Uniform gravity, $g = {g}$ in inertial axes: $U = \\sum m\\, g \\cdot r_C$."
            case NewtonianGravity(constant, centre, about, order):
                return self.newtonian(constant, centre, about, order)
            case CoordinateSpring(coordinate, stiffness, rest):
                q = str(self.names[coordinate])
                stretched = q if rest == ZERO else f"({q} - {_bracketed(rest, 2, self.names)})"
                u = f"U = -\\tfrac{{1}}{{2}}\\, {_bracketed(stiffness, 2, self.names)}\\, {stretched}^2"
                return f"Spring of ${q}$, stiffness ${self.math(stiffness)}$, rest at ${self.math(rest)}$: ${u}$."
            case PointSpring(first, second, stiffness, length):
                stretched = "d^2" if length == ZERO else f"(d - {_bracketed(length, 2, self.names)})^2"
                u = f"U = -\\tfrac{{1}}{{2}}\\, {_bracketed(stiffness, 2, self.names)}\\, {stretched}"
                return (
                    f"Spring between {self.point(first)} and {self.point(second)}, stiffness ${self.math(stiffness)}$, "
                    f"natural length ${self.math(length)}$: ${u}$ with the distance $d$."
                )
            case CoordinateDamper(coordinate, coefficient):
                velocity = self.names[coordinate].accented("dot")
                r = f"\\tfrac{{1}}{{2}}\\, {_bracketed(coefficient, 2, self.names)}\\, {velocity}^2"
                c = self.math(coefficient)
                return f"Damper of ${self.names[coordinate]}$, coefficient ${c}$: dissipation function ${r}$."
            case PointDamper(first, second, coefficient):
                r = f"\\tfrac{{1}}{{2}}\\, {_bracketed(coefficient, 2, self.names)}\\, \\dot{{d}}^2"
                return (
                    f"Damper along the line between {self.point(first)} and {self.point(second)}, coefficient "
                    f"${self.math(coefficient)}$: dissipation function ${r}$ with the distance $d$."
                )
            case IsotropicDamper(first, second, coefficient):
                r = f"\\tfrac{{1}}{{2}}\\, {_bracketed(coefficient, 2, self.names)}\\, v^2"
                return (
                    f"Isotropic damper between {self.point(first)} and {self.point(second)}, coefficient "
                    f"${self.math(coefficient)}$: dissipation function ${r}$ with their relative velocity $v$."
                )
            case ForceFunction(value, spelled):
                sign = "-" if spelled == "potential" else ""
                return f"{spelled.capitalize()}: ${sign}U = {self.math(value)}$."
            case Rayleigh(value):
                return f"Dissipation function: ${self.math(value)}$."
            case GeneralizedForce(components):
                forces = [f"$Q_{{{self.names[name]}}} = {self.math(value)}$" for name, value in components]
                return f"Generalised force{'s' if len(forces) > 1 else ''}: {', '.join(forces)}."
            case PointForce(point, components, axes):
                where = f"in the axes of {self.frame(axes)}, at {self.point(point)}"
                return f"Force ${self.vector(components)}$ {where}."
            case Torque(body, components, axes, reaction_on):
                opposite = "" if reaction_on is None else f"; the opposite one on {self.frame(reaction_on)}"
                where = f"in the axes of {self.frame(axes)}, on {self.frame(body)}"
                return f"Torque ${self.vector(components)}$ {where}{opposite}."

    def newtonian(self, constant: Expression, centre: str, about: str, order: int | str) -> str:
        nu = self.math(constant)
        given = "\\nu" if nu == "\\nu" else f"\\nu = {nu}"
        field = f"Newtonian field of a centre at the origin of {self.frame(centre)}"
        if order == EXACT:
            return (
                f"{field}, with ${given}$ and exact distances: \\[ {_NEWTONIAN_EXACT} \\] over the bodies that "
                f"{self.frame(about)} carries, with $r$ the mass centre seen from the attracting centre and "
                "$\\Theta_C$ the inertia about the mass centre (MacCullagh's formula: exact for point masses; of an "
                "extended body the third and higher moments are dropped)."
            )
        more = [text for degree, text in _NEWTONIAN_MORE.items() if degree <= int(order)]
        formula = "".join(f" \\] \\[ {{}} + \\sum {text}" for text in more)
        symbols = ", $x = e \\cdot c$, $y = c \\cdot c$" if more else ""
        return (
            f"{field}, approximate, with "
            f"${given}$, expanded to order {order} about the origin $O$ of "
            f"{self.frame(about)}: \\[ {_NEWTONIAN}{formula} \\] over the bodies that this frame carries, with $R$ the "
            "distance of $O$ from the centre, $e$ the unit vector from the centre to $O$, $c$ the mass centre "
            f"seen from $O${symbols} and $\\Theta_C$ the inertia about the mass centre."
        )

    def math(self, value: Expression) -> str:
        return expression(value, self.names)

    def vector(self, values: Sequence[Expression]) -> str:
        return "(" + ",\\; ".join(map(self.math, values)) + ")"

    def frame(self, name: str) -> str:
        return "the inertial frame" if name == INERTIAL else f"\\textit{{{self.escaped(name)}}}"

    def point(self, point: Point) -> str:
        return f"the point ${self.vector(point.position)}$ of {self.frame(point.body)}"
