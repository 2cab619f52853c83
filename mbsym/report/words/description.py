"""A description told: bodies, loads and constraints with their data, as content."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from mbsym.expressions.tree import ZERO, Expression, Negative, Number, Operation
from mbsym.expressions.tree import Name as Variable
from mbsym.model.constraints import Coincide, Constraint, Distance, Parallel, Relation, Rolling, Velocity, as_written
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
from mbsym.model.system import INERTIAL, Point, Vector
from mbsym.report import content
from mbsym.report.content import (
    Block,
    Display,
    Emphasis,
    Entry,
    Inline,
    Listed,
    Name,
    Notation,
    Paragraph,
    Said,
    Symbol,
    paragraph,
    say,
)


def frame(name: str) -> Inline:
    """A body by its name, or the inertial frame."""
    return Said("the inertial reference frame") if name == INERTIAL else Emphasis(name)


def vector(values: Vector) -> Listed:
    """(x, y, z)."""
    return Listed(tuple(values), brackets=True)


def point(value: Point) -> Said:
    """A point by its place in a body."""
    return say("the point $[[place]]$ of [[frame]]", place=vector(value.position), frame=frame(value.body))


# --- loads ------------------------------------------------------------------------------------------------------------


def load(value: Load) -> tuple[Block, ...]:
    """A load with its data, and the formula by which it acts."""
    if isinstance(value, NewtonianGravity):
        return tuple(_newtonian(value))
    return (Paragraph(tuple(_load(value.written))),)


def _load(value: Load) -> Iterator[Inline]:
    match value:
        case UniformGravity(acceleration):
            text = "Uniform gravity, $g = [[g]]$ in inertial axes: $U = \\sum m\\, g \\cdot r_C$."
            yield say(text, g=vector(acceleration))
        case CoordinateSpring(coordinate, stiffness, rest):
            text = "Spring of $[[q]]$, stiffness $[[k]]$, rest at $[[rest]]$: $[[u]]$."
            energy = _energy(stiffness, Variable(coordinate), rest)
            yield say(text, q=Name(coordinate), k=stiffness, rest=rest, u=energy)
        case PointSpring(first, second, stiffness, length):
            text = (
                "Spring between [[first]] and [[second]], stiffness $[[k]]$, natural length $[[length]]$: $[[u]]$ "
                "with the distance $d$."
            )
            energy, ends = _energy(stiffness, Variable("d"), length), {"first": point(first), "second": point(second)}
            yield say(text, **ends, k=stiffness, length=length, u=energy)
        case CoordinateDamper(coordinate, coefficient):
            text = "Damper of $[[q]]$, coefficient $[[c]]$: dissipation function $[[r]]$."
            yield say(text, q=Name(coordinate), c=coefficient, r=_dissipation(coefficient, f"{coordinate}_dot"))
        case PointDamper(first, second, coefficient):
            text = (
                "Damper along the line between [[first]] and [[second]], coefficient $[[c]]$: dissipation function "
                "$[[r]]$ with the distance $d$."
            )
            ends = {"first": point(first), "second": point(second)}
            yield say(text, **ends, c=coefficient, r=_dissipation(coefficient, "d_dot"))
        case IsotropicDamper(first, second, coefficient):
            text = (
                "Isotropic damper between [[first]] and [[second]], coefficient $[[c]]$: dissipation function "
                "$[[r]]$ with their relative velocity $v$."
            )
            ends = {"first": point(first), "second": point(second)}
            yield say(text, **ends, c=coefficient, r=_dissipation(coefficient, "v"))
        case ForceFunction(written, spelled):
            potential = spelled == "potential"
            title, left = ("Potential", Notation("-U")) if potential else ("Force function", Symbol("U"))
            yield from (Said(title), ": ", content.Relation(left, "=", written), ".")
        case Rayleigh(written):
            yield from (Said("Dissipation function"), ": ", content.Relation(Symbol("R"), "=", written), ".")
        case GeneralizedForce(components):
            yield from (Said("Generalised forces" if len(components) > 1 else "Generalised force"), ": ")
            forces = [content.Relation(Entry(Symbol("Q"), Name(name)), "=", x) for name, x in components]
            yield from separated(forces)
            yield "."
        case PointForce(at, components, axes):
            text = "Force $[[force]]$ in the axes of [[axes]], at [[point]]."
            yield say(text, force=vector(components), axes=frame(axes), point=point(at))
        case Torque(body, components, axes, reaction_on):
            data: dict[str, Inline] = {"torque": vector(components), "axes": frame(axes), "body": frame(body)}
            if reaction_on is None:
                yield Said("Torque $[[torque]]$ in the axes of [[axes]], on [[body]].", data)
            else:
                text = "Torque $[[torque]]$ in the axes of [[axes]], on [[body]]; the opposite one on [[other]]."
                yield Said(text, data | {"other": frame(reaction_on)})


def _energy(stiffness: Expression, at: Expression, rest: Expression) -> content.Relation:
    """U = -1/2 k (q - rest)^2."""
    stretched = at if rest == ZERO else Operation("-", at, rest)
    return content.Relation(Symbol("U"), "=", Negative(_half_square(stiffness, stretched)))


def _dissipation(coefficient: Expression, velocity: str) -> content.Relation:
    """R = 1/2 c v^2."""
    return content.Relation(Symbol("R"), "=", _half_square(coefficient, Variable(velocity)))


def _half_square(factor: Expression, base: Expression) -> Expression:
    half = Operation("/", Number(Fraction(1)), Number(Fraction(2)))
    return Operation("*", Operation("*", half, factor), Operation("**", base, Number(Fraction(2))))


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


def _newtonian(value: NewtonianGravity) -> Iterator[Block]:
    constant, nu = value.constant, Symbol("nu")
    inlines: dict[str, Inline] = {
        "centre": frame(value.centre),
        "nu": nu if constant == Variable("nu") else content.Relation(nu, "=", constant),
    }
    if value.order == EXACT:
        text = "Newtonian field of a centre at the origin of [[centre]], with $[[nu]]$ and exact distances:"
        yield paragraph(Said(text, inlines))
        yield Display(Notation(_NEWTONIAN_EXACT))
        text = (
            "over the bodies that [[about]] carries, with $r$ the mass centre seen from the attracting centre and "
            "$\\Theta_C$ the inertia about the mass centre (MacCullagh's formula: exact for point masses; of an "
            "extended body the third and higher moments are dropped)."
        )
        yield paragraph(say(text, about=frame(value.about)))
        return
    order = int(value.order)
    text = (
        "Newtonian field of a centre at the origin of [[centre]], approximate, with $[[nu]]$, expanded to order "
        "[[order]] about the origin $O$ of [[about]]:"
    )
    yield paragraph(Said(text, inlines | {"order": str(order), "about": frame(value.about)}))
    yield Display(Notation(_NEWTONIAN))
    for degree, terms in _NEWTONIAN_MORE.items():
        if degree <= order:
            yield Display(Notation(f"{{}} + \\sum {terms}"))
    symbols = ", $x = e \\cdot c$, $y = c \\cdot c$" if order > 2 else ""
    text = (
        "over the bodies that this frame carries, with $R$ the distance of $O$ from the centre, $e$ the unit vector "
        "from the centre to $O$, $c$ the mass centre seen from $O$[[symbols]] and $\\Theta_C$ the inertia about the "
        "mass centre."
    )
    yield paragraph(say(text, symbols=Said(symbols)))


# --- constraints ------------------------------------------------------------------------------------------------------


def constraint(written: Constraint) -> Said:
    """A constraint with its data.  Raises TypeError for what is none."""
    value = as_written(written)
    match value:
        case Coincide(first, second):
            text = "Two points coincide: [[first]] and [[second]]."
            return say(text, first=point(first), second=point(second))
        case Parallel(first, second):
            return say(
                "Two axes are parallel: [[first]] of [[body]] and [[second]] of [[other]].",
                first=vector(first.direction),
                body=frame(first.body),
                second=vector(second.direction),
                other=frame(second.body),
            )
        case Distance(first, second, length):
            text = "Two points keep the distance [[length]]: [[first]] and [[second]]."
            return say(text, first=point(first), second=point(second), length=length)
        case Rolling(body, contact, axes, on):
            return say(
                "Rolling without slipping of [[body]] on [[on]]: the contact is at [[contact]] from the connection "
                "point, in the axes of [[axes]].",
                body=frame(body),
                on=frame(on),
                contact=vector(contact),
                axes=frame(axes),
            )
        case Relation(left, right):
            return say("Relation between coordinates: [[equation]].", equation=content.Relation(left, "=", right))
        case Velocity(left, right):
            return say("Relation between velocities: [[equation]].", equation=content.Relation(left, "=", right))
    raise TypeError(f"not a constraint: {value!r}")


def separated(items: Sequence[Inline], sign: str = ", ") -> Iterator[Inline]:
    """The items with a sign between them."""
    for k, item in enumerate(items):
        if k:
            yield sign
        yield item
