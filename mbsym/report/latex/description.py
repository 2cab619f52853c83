"""What stands in a description, in LaTeX as it stands there: expressions and loads."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from fractions import Fraction

from mbsym.expressions.rates import without_velocity
from mbsym.expressions.table import Table
from mbsym.expressions.tree import KINKED, ZERO, Call, Expression, Name, Negative, Number, Operation, children
from mbsym.formulas.latex import LatexNames, Symbol
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
from mbsym.report.language import Language

# --- expressions ---

_FUNCTIONS = {"atan": "arctan", "log": "ln"}


#: A table of more points is shown by so many of its first and of its last.
MOST_LISTED, SHOWN_FIRST = 100, 4


def call(function: str, argument: str) -> str:
    """A function of one argument, known by Python's name."""
    if function == "sqrt":
        return f"\\sqrt{{{argument}}}"
    if function == "abs":
        return f"\\lvert {argument} \\rvert"
    if function in KINKED:
        return f"\\operatorname{{{function}}}({argument})"
    return f"\\{_FUNCTIONS.get(function, function)}({argument})"


def expression(value: Expression, names: LatexNames | _WithSpins) -> str:
    """An expression of the description, as it stands."""
    return _expression(value, names)[0]


class _WithSpins:
    """The names of a system, and the components of the angular velocity of a body: (omega_2)_1."""

    def __init__(self, names: LatexNames, number: int) -> None:
        self.names = names
        self.spins = {name: Symbol(f"(\\omega_{{{number}}})", str(k)) for k, name in enumerate(OMEGA, start=1)}

    def __getitem__(self, name: str) -> Symbol:
        return self.spins.get(name) or self.names[name]


def speed_form(one: Speed, names: LatexNames, number: int) -> str:
    """What a speed is made of; ``number`` is that of its body."""
    return expression(one.form, _WithSpins(names, number))


def speed(name: str, names: LatexNames) -> str:
    """A speed by name: p, or a dotted coordinate."""
    plain = without_velocity(name)
    return str(names[name]) if plain == name else names[plain].accented("dot")


def points(value: Sequence[tuple[Fraction, Fraction]], names: LatexNames) -> str:
    """The points of a table; a line may end behind each.  Of many the first and last."""
    written = [f"({expression(Number(x), names)},\\, {expression(Number(y), names)})" for x, y in shown_points(value)]
    if len(value) > MOST_LISTED:
        written[SHOWN_FIRST:SHOWN_FIRST] = [r"\dots"]
    return ",\\; \\allowbreak ".join(written)


def shown_points(value: Sequence[tuple[Fraction, Fraction]]) -> Sequence[tuple[Fraction, Fraction]]:
    """All of them, or some from either end where there are too many to read."""
    return value if len(value) <= MOST_LISTED else (*value[:SHOWN_FIRST], *value[-SHOWN_FIRST:])


def _expression(value: Expression, names: LatexNames | _WithSpins) -> tuple[str, int]:
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
        case Call(function, argument, table=Table()):
            written = function.replace("_", "\\_")
            return f"\\operatorname{{{written}}}({expression(argument, names)})", 4
        case Call(function):
            return call(function, ", ".join(expression(one, names) for one in children(value))), 4
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


def _bracketed(value: Expression, wanted: int, names: LatexNames | _WithSpins) -> str:
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
    r"U = \sum \Bigl[ \frac{\nu\, m}{R} \penalty0 - \frac{\nu\, m}{R^2}\, e \cdot c \penalty0 + \frac{\nu}{R^3} \Bigl( "
    r"\frac{m}{2} \bigl(3 (e \cdot c)^2 - c \cdot c\bigr) \penalty0 + \frac{1}{2} \operatorname{tr} \Theta_C "
    r"\penalty0 - \frac{3}{2}\, e \cdot \Theta_C\, e \Bigr) \Bigr]"
)

#: The terms that the third and the fourth order add, with x = e.c and y = c.c.
_NEWTONIAN_MORE = {
    3: (
        r"\frac{\nu}{R^4} \Bigl( -\frac{m}{2} (5 x^3 - 3 x y) \penalty0 - \frac{3}{2}\, x \operatorname{tr} \Theta_C "
        r"\penalty0 + \frac{15}{2}\, x\, e \cdot \Theta_C\, e \penalty0 - 3\, e \cdot \Theta_C\, c \Bigr)"
    ),
    4: (
        r"\frac{\nu}{R^5} \Bigl( \frac{m}{8} (35 x^4 - 30 x^2 y + 3 y^2) \penalty0 + \frac{3}{4} (5 x^2 - y) "
        r"\operatorname{tr} \Theta_C \penalty0 - \frac{15}{4} (7 x^2 - y)\, e \cdot \Theta_C\, e "
        r"\penalty0 + 15\, x\, e \cdot \Theta_C\, c "
        r"\penalty0 - \frac{3}{2}\, c \cdot \Theta_C\, c \Bigr)"
    ),
}

#: The force function with exact distances.
_NEWTONIAN_EXACT = (
    r"U = \sum \Bigl[ \frac{\nu\, m}{|r|} \penalty0 + \frac{\nu}{2 |r|^3} \Bigl( \operatorname{tr} \Theta_C "
    r"\penalty0 - 3\, \frac{r \cdot \Theta_C\, r}{|r|^2} \Bigr) \Bigr]"
)


def load_in_words(load: Load, names: LatexNames, escaped: Callable[[str], str], language: Language) -> str:
    """A load with its data, and the formula by which it acts."""
    return _Loads(names, escaped, language).text(load)


#: A formula of a sentence that is written with more characters may be broken.
LONGEST_IN_LINE = 160


def constraint_in_words(
    constraint: Constraint, names: LatexNames, escaped: Callable[[str], str], language: Language
) -> str:
    """A constraint with its data."""
    from mbsym.report.constraint_description import Medium, described

    write = _Loads(names, escaped, language)
    medium = Medium(
        lambda left, right: _breakable(f"{write.math(left)} = {write.math(right)}"),
        lambda value: _breakable(write.math(value)),
        lambda value: _breakable(write.vector(value)),
        write.frame,
        write.point,
    )
    said, values = described(constraint, medium)
    return language.sentence(said, **values)


def _breakable(formula: str) -> str:
    """A formula in the line; a long one may be broken before a sign, a factor in brackets and after a comma."""
    if len(formula) <= LONGEST_IN_LINE:
        return f"${formula}$"
    parts, depth = [], 0
    for piece in re.split(r"(\\[{}]|[{}]| [+-] |,\\; ?| \(| \\cos| \\sin)", formula):
        depth += (piece == "{") - (piece == "}")
        if depth == 0 and piece.startswith(" "):
            piece = f" \\penalty0{piece}"
        elif depth == 0 and piece.startswith(","):
            piece = f"{piece}\\penalty0 "
        parts.append(piece)
    return f"${''.join(parts)}$"


class _Loads:
    def __init__(self, names: LatexNames, escaped: Callable[[str], str], language: Language) -> None:
        self.names = names
        self.escaped = escaped
        self.tr = language.sentence

    def text(self, load: Load) -> str:
        tr = self.tr
        match load:
            case UniformGravity(acceleration):
                g = self.vector(acceleration)
                return tr("Uniform gravity, $g = [[g]]$ in inertial axes: $U = \\sum m\\, g \\cdot r_C$.", g=g)
            case NewtonianGravity(constant, centre, about, order):
                return self.newtonian(constant, centre, about, order)
            case CoordinateSpring(coordinate, stiffness, rest):
                q = str(self.names[coordinate])
                stretched = q if rest == ZERO else f"({q} - {_bracketed(rest, 2, self.names)})"
                return tr(
                    "Spring of $[[q]]$, stiffness $[[k]]$, rest at $[[rest]]$: $[[u]]$.",
                    q=q,
                    k=self.math(stiffness),
                    rest=self.math(rest),
                    u=f"U = -\\tfrac{{1}}{{2}}\\, {_bracketed(stiffness, 2, self.names)}\\, {stretched}^2",
                )
            case PointSpring(first, second, stiffness, length):
                stretched = "d^2" if length == ZERO else f"(d - {_bracketed(length, 2, self.names)})^2"
                return tr(
                    "Spring between [[first]] and [[second]], stiffness $[[k]]$, natural length $[[length]]$: $[[u]]$ "
                    "with the distance $d$.",
                    first=self.point(first),
                    second=self.point(second),
                    k=self.math(stiffness),
                    length=self.math(length),
                    u=f"U = -\\tfrac{{1}}{{2}}\\, {_bracketed(stiffness, 2, self.names)}\\, {stretched}",
                )
            case CoordinateDamper(coordinate, coefficient):
                velocity = self.names[coordinate].accented("dot")
                return tr(
                    "Damper of $[[q]]$, coefficient $[[c]]$: dissipation function $[[r]]$.",
                    q=self.names[coordinate],
                    c=self.math(coefficient),
                    r=f"\\tfrac{{1}}{{2}}\\, {_bracketed(coefficient, 2, self.names)}\\, {velocity}^2",
                )
            case PointDamper(first, second, coefficient):
                return tr(
                    "Damper along the line between [[first]] and [[second]], coefficient $[[c]]$: dissipation function "
                    "$[[r]]$ with the distance $d$.",
                    first=self.point(first),
                    second=self.point(second),
                    c=self.math(coefficient),
                    r=f"\\tfrac{{1}}{{2}}\\, {_bracketed(coefficient, 2, self.names)}\\, \\dot{{d}}^2",
                )
            case IsotropicDamper(first, second, coefficient):
                return tr(
                    "Isotropic damper between [[first]] and [[second]], coefficient $[[c]]$: dissipation function "
                    "$[[r]]$ with their relative velocity $v$.",
                    first=self.point(first),
                    second=self.point(second),
                    c=self.math(coefficient),
                    r=f"\\tfrac{{1}}{{2}}\\, {_bracketed(coefficient, 2, self.names)}\\, v^2",
                )
            case ForceFunction(spelled=spelled, written=value):
                sign = "-" if spelled == "potential" else ""
                return f"{tr(spelled.capitalize())}: ${sign}U = {self.math(value)}$."
            case Rayleigh(value):
                return f"{tr('Dissipation function')}: ${self.math(value)}$."
            case GeneralizedForce(components):
                forces = [f"$Q_{{{self.names[name]}}} = {self.math(value)}$" for name, value in components]
                return f"{tr('Generalised forces' if len(forces) > 1 else 'Generalised force')}: {', '.join(forces)}."
            case PointForce(point, components, axes):
                return tr(
                    "Force $[[force]]$ in the axes of [[axes]], at [[point]].",
                    force=self.vector(components),
                    axes=self.frame(axes),
                    point=self.point(point),
                )
            case Torque(body, components, axes, reaction_on):
                torque = {"torque": self.vector(components), "axes": self.frame(axes), "body": self.frame(body)}
                if reaction_on is None:
                    return tr("Torque $[[torque]]$ in the axes of [[axes]], on [[body]].", **torque)
                return tr(
                    "Torque $[[torque]]$ in the axes of [[axes]], on [[body]]; the opposite one on [[other]].",
                    **torque,
                    other=self.frame(reaction_on),
                )

    def newtonian(self, constant: Expression, centre: str, about: str, order: int | str) -> str:
        nu = self.math(constant)
        given = {
            "centre": self.frame(centre),
            "nu": "\\nu" if nu == "\\nu" else f"\\nu = {nu}",
            "about": self.frame(about),
        }
        if order == EXACT:
            return self.tr(
                "Newtonian field of a centre at the origin of [[centre]], with $[[nu]]$ and exact distances: "
                "\\[ [[formula]] \\] over the bodies that [[about]] carries, with $r$ the mass centre seen from the "
                "attracting centre and $\\Theta_C$ the inertia about the mass centre (MacCullagh's formula: exact for "
                "point masses; of an extended body the third and higher moments are dropped).",
                **given,
                formula=_NEWTONIAN_EXACT,
            )
        more = [text for degree, text in _NEWTONIAN_MORE.items() if degree <= int(order)]
        return self.tr(
            "Newtonian field of a centre at the origin of [[centre]], approximate, with $[[nu]]$, expanded to order "
            "[[order]] about the origin $O$ of [[about]]: \\[ [[formula]] \\] over the bodies that this frame carries, "
            "with $R$ the distance of $O$ from the centre, $e$ the unit vector from the centre to $O$, $c$ the mass "
            "centre seen from $O$[[symbols]] and $\\Theta_C$ the inertia about the mass centre.",
            **given,
            order=order,
            formula=_NEWTONIAN + "".join(f" \\] \\[ {{}} + \\sum {text}" for text in more),
            symbols=", $x = e \\cdot c$, $y = c \\cdot c$" if more else "",
        )

    def math(self, value: Expression) -> str:
        return expression(value, self.names)

    def vector(self, values: Sequence[Expression]) -> str:
        return "(" + ",\\; ".join(map(self.math, values)) + ")"

    def frame(self, name: str) -> str:
        return self.tr("the inertial frame") if name == INERTIAL else f"\\textit{{{self.escaped(name)}}}"

    def point(self, point: Point) -> str:
        return self.tr(
            "the point $[[place]]$ of [[frame]]", place=self.vector(point.position), frame=self.frame(point.body)
        )
