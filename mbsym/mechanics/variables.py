"""The names a system's formulas are made of, and the ring and environments they give rise to."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import fields, is_dataclass
from fractions import Fraction
from math import lcm
from typing import Any

from mbsym.algebra.base import Lowering, Scalar
from mbsym.algebra.failures import NoClosedForm, NoLaw
from mbsym.algebra.program import Program
from mbsym.algebra.ring import TERM_BUDGET, Polynomial, Ring
from mbsym.expressions.angles import LinearForm, linear_form
from mbsym.expressions.rates import is_rate
from mbsym.expressions.tree import (
    ONE,
    ZERO,
    Call,
    Expression,
    Name,
    Negative,
    Number,
    Operation,
    add,
    children,
    differentiate,
    divide,
    multiply,
    names,
    number,
    sticks,
    substitute,
    walk,
)
from mbsym.model.loads import EXACT
from mbsym.model.speeds import Quaternion
from mbsym.model.substitution import lacking_law, with_laws
from mbsym.model.system import System, acceleration_name, velocity_name

#: The sines and cosines of so many constant angles have places in the ring.
MOST_CONSTANT_ANGLES = 256

_NODES = (Number, Name, Negative, Operation, Call)


#: What a system holds besides its mechanics: expressions there take no part in it.
_ASIDE = ("span", "claims", "abbreviations")


def expressions(part: Any) -> Iterator[Expression]:
    """Every expression held by a system or a part of it; of a system without its claims."""
    if isinstance(part, _NODES):
        yield part
    elif isinstance(part, tuple):
        for item in part:
            yield from expressions(item)
    elif is_dataclass(part):
        for field in fields(part):
            if field.name not in _ASIDE:
                yield from expressions(getattr(part, field.name))


def time_derivative(expression: Expression, system: System, frozen: bool = False) -> Expression:
    """d/dt: sum over q of (d/dq) q' + (d/dq') q'', over prescribed quantities of (d/dx) rate, and d/dt itself.

    With ``frozen`` the prescribed quantities and t stand still: only the coordinates move.
    """
    total: Expression = ZERO
    present = _names(expression)
    if not present:
        return total
    rates: dict[str, Expression] = {}
    if not frozen:
        rates = {"t": ONE} | {item.name: item.rate for item in system.prescribed}
    for name, velocity in zip(system.coordinates, system.velocities, strict=True):
        if name in present:
            rates[name] = Name(velocity)
        if velocity in present:
            rates[velocity] = Name(acceleration_name(name))
    for name in sorted(present & rates.keys()):
        total = add(total, multiply(differentiate(expression, name), rates[name]))
    return total


def rate_of(
    ring: Ring,
    lower: Lowering[Polynomial],
    system: System,
    x: Polynomial,
    rates: Iterable[tuple[str, Polynomial]] = (),
) -> Polynomial:
    """dx/dt: sum of rate dx/d(name) over the ``rates`` and what is prescribed, and dx/dt itself; others stand still."""
    if any(ring.depends_on(x, name) for name in system.last_derivatives):
        raise NoClosedForm("a derivative of a free function of time beyond those that there are names for")
    total = ring.derivative(x, "t")
    for name, rate in (*rates, *((item.name, lower(item.rate)) for item in system.prescribed)):
        total = total + ring.times(rate, ring.derivative(x, name))
    return ring.reduce(total)


def settled(system: System) -> System:
    """The system with the laws of the description put in.  Raises NoLaw where a free function of time has none."""
    told = with_laws(system)
    if told.given:
        message, hint = lacking_law(told.given[0].name)
        raise NoLaw(message, remedy=hint)
    return told


def _names(expression: Expression) -> set[str]:
    """The names that occur; a part shared by many parents is looked at once."""
    occurring: set[str] = set()
    seen: set[int] = set()
    pending = [expression]
    while pending:
        node = pending.pop()
        if id(node) not in seen:
            seen.add(id(node))
            pending.extend(children(node))
            if isinstance(node, Name):
                occurring.add(node.name)
    return occurring


def angle_denominators(system: System, arguments: Iterable[Expression] = ()) -> dict[str, int]:
    """The names under sin and cos anywhere, each with the common denominator of its coefficients there.

    ``arguments`` are further angles.

    A coordinate's unperturbed value takes the coordinate's place, so its names count with the same coefficients.
    """
    denominators: dict[str, int] = {}
    at_rest = {entry.coordinate: entry.value for entry in system.motion}
    at_rest |= {signal.name: signal.held for signal in system.inputs}

    def note(argument: Expression) -> None:
        form = linear_form(argument)
        if form is None:
            return
        for name, coefficient in form.coefficients:
            denominators[name] = lcm(denominators.get(name, 1), coefficient.denominator)
            if name in at_rest:
                inner = linear_form(at_rest[name])
                for other, factor in inner.coefficients if inner is not None else ():
                    denominators[other] = lcm(denominators.get(other, 1), (factor * coefficient).denominator)

    for argument in (*angles_of(system), *arguments):
        note(argument)
    for relation in reversed(system.relations):  # what an angle is related to stands under its sine then
        form = linear_form(relation.value)
        if relation.name in denominators and form is not None and not form.constant:
            for other, factor in form.coefficients:
                denominators[other] = lcm(
                    denominators.get(other, 1), (factor / denominators[relation.name]).denominator
                )
    driven = (*(item.name for item in system.prescribed), *system.input_names)
    declared = [*system.coordinates, *driven, *system.parameter_names, "t"]
    return {name: denominators[name] for name in declared if name in denominators}


def angles_of(system: System) -> Iterator[Expression]:
    """Every angle of a joint, and every argument of a sine, cosine or tangent."""
    for body in system.bodies:
        for _, angle in body.rotation.turns():
            yield angle
    for expression in expressions(system):
        for node in walk(expression):
            if isinstance(node, Call) and node.function in ("sin", "cos", "tan"):
                yield node.argument


def half_angles(system: System) -> list[Expression]:
    """Half of every angle on the unperturbed motion of bodies told by quaternions, but for those that are 0 or turn."""
    values = {entry.coordinate: entry.value for entry in system.motion if entry.rate == ZERO}
    zeros = dict.fromkeys(system.coordinates, ZERO) if values else {}
    turning = {entry.coordinate for entry in system.motion if entry.rate != ZERO}
    halves = []
    for body in system.bodies if zeros else ():
        if any(isinstance(vector, Quaternion) for vector in body.orientation):
            for _, angle in body.rotation.turns():
                value = substitute(angle, zeros | values)
                if value != ZERO and not names(angle) & turning:
                    halves.append(divide(value, number(2)))
    return halves


def constant_angles(system: System, arguments: Iterable[Expression] = ()) -> set[tuple[Fraction, Fraction]]:
    """The different constants (turns, radians), turns*pi + radians, that the angles of a system contain.

    Those that an unperturbed motion brings are among them; multiples of pi/2, whose sines are whole numbers, are not.
    """
    values = (*(entry.value for entry in system.motion), *(signal.held for signal in system.inputs))
    forms = (linear_form(x) for x in (*angles_of(system), *arguments, *values))
    constants = {(form.turns % 2, form.constant) for form in forms if form is not None}
    return {(turns, radians) for turns, radians in constants if radians or turns.denominator > 2}


def has_linear_angles(system: System) -> bool:
    """Whether every angle is a number, or a linear form in names: no rates, no number that is no multiple of pi."""
    return all(map(_is_plain, map(linear_form, angles_of(system))))


def _is_plain(form: LinearForm | None) -> bool:
    if form is None or (form.constant and form.coefficients):
        return False
    return not any(is_rate(name) for name, _ in form.coefficients)


def ring_of(
    system: System,
    terms: int = TERM_BUDGET,
    arguments: Iterable[Expression] = (),
    moving: Sequence[str] = (),
    fixed: Sequence[str] = (),
) -> Ring:
    """The exact ring of a system, with the user's notation among its parameters.

    ``arguments`` are angles under sin and cos besides those of the system; ``moving`` and ``fixed`` names of further
    quantities, those that vary with the state and those that do not.
    """
    arguments = (*arguments, *half_angles(system))
    adjunctions = 12 + 4 * len(system.loads)
    # Every mass centre has a distance of its own in the exact field, and on the unperturbed motion another one.
    exact = sum(field.order == EXACT for field in system.newtonian_fields)
    adjunctions += 4 * exact * sum(body.mass != ZERO or body.inertia is not None for body in system.bodies)
    for expression in (*expressions(system), *expressions(system.claims), *expressions(system.abbreviations)):
        for node in walk(expression):
            adjunctions += 2 * _own_generators(node) * _may_adjoin(node)
    adjunctions += 4 * len(system.speeds)
    ring = Ring(
        [*system.coordinates, *system.variables],
        [*(item.name for item in system.prescribed), *system.last_derivatives, *system.input_names, *moving],
        [*system.parameter_names, *(item.name for item in system.notation), *fixed],
        angle_denominators(system, arguments),
        positive=[parameter.name for parameter in system.parameters if parameter.sign == "positive"],
        nonnegative=[parameter.name for parameter in system.parameters if parameter.sign == "nonnegative"],
        spare=min(adjunctions, 64) + 2 * min(len(constant_angles(system, arguments)), MOST_CONSTANT_ANGLES),
        terms=terms,
        typed=[form.coefficients for form in map(linear_form, angles_of(system)) if form is not None],
    )
    if system.speeds:
        ring.leading = frozenset(ring.index("coordinate", speed.name) for speed in system.speeds)
    ring.assumed += _assumed(system, ring)
    return ring


#: An assumption that takes more to be written out opens no roots.
ASSUMPTION_WORK = 100_000


def _assumed(system: System, ring: Ring) -> Iterator[Any]:
    """What is declared or assumed to be positive, as polynomials: sqrt((a - b)**2) is b - a under a < b."""
    yield from (
        -ring.generator("parameter", parameter.name) for parameter in system.parameters if parameter.sign == "negative"
    )
    lower = Lowering(ring, ring_environment(system, ring))
    for assumption in system.assumptions:
        if assumption.relation in ("<", ">") and all(map(_is_polynomial, (assumption.left, assumption.right))):
            try:
                with ring.budget(ASSUMPTION_WORK):
                    gap = lower(assumption.left) - lower(assumption.right)
            except NoClosedForm:
                continue
            yield gap if assumption.relation == ">" else -gap


def _is_whole(power: Expression) -> bool:
    return isinstance(power, Number) and power.value.denominator == 1 and power.value > 0


def _is_polynomial(expression: Expression) -> bool:
    """Whether it needs no generator of its own."""
    return all(
        not isinstance(node, Call)
        and not (isinstance(node, Operation) and node.operator == "/" and names(node.right))
        and not (isinstance(node, Operation) and node.operator == "**" and not _is_whole(node.right))
        for node in walk(expression)
    )


def _own_generators(node: Expression) -> int:
    """A function has one; a table one for each derivative, and a modulus for each point where it is written out."""
    if not isinstance(node, Call) or node.table is None:
        return 1
    if sticks(node):
        return len(node.table.points)
    return 2 + max(node.table.curve.smoothness, 0) + 2 * node.table.jumps


def _may_adjoin(node: Expression) -> bool:
    """Whether an operation may need a generator of its own; sines and cosines of linear forms the ring has anyway.

    Every generator makes all arithmetic slower, so what cannot need one is not counted.
    """
    match node:
        case Call("sin" | "cos", argument):
            return linear_form(argument) is None
        case Operation("/", _, divisor):
            form = linear_form(divisor)
            return form is None or not form.is_constant
        case Operation("**", _, exponent):
            form = linear_form(exponent)
            return form is None or not form.is_constant or form.constant < 0 or form.constant.denominator > 1
    return isinstance(node, Call)


def ring_environment(system: System, ring: Ring) -> dict[str, Scalar]:
    """Every name as its generator."""
    environment = {name: ring.generator("parameter", name) for name in system.parameter_names}
    environment |= {item.name: ring.generator("parameter", item.name) for item in system.notation}
    environment |= {item.name: ring.generator("prescribed", item.name) for item in system.prescribed}
    driven = (*system.last_derivatives, *system.input_names)
    environment |= {name: ring.generator("prescribed", name) for name in driven}
    for name in system.coordinates:
        environment[name] = ring.generator("coordinate", name)
        environment[velocity_name(name)] = ring.generator("velocity", name)
        environment[acceleration_name(name)] = ring.generator("acceleration", name)
    for name in system.variables:
        environment[name] = ring.generator("coordinate", name)
        environment[velocity_name(name)] = ring.generator("velocity", name)
    environment["t"] = ring.generator("time", "t")
    environment["pi"] = ring.generator("parameter", "pi")
    return environment


def program_environment(system: System, program: Program) -> dict[str, Scalar]:
    """Every name as an input of a straight-line program."""
    driven = (*(item.name for item in system.prescribed), *system.last_derivatives, *system.input_names)
    names_ = [*system.parameter_names, *driven, "t", "pi"]
    for name in system.variables:
        names_ += [name, velocity_name(name)]
    for name in system.coordinates:
        names_ += [name, velocity_name(name), acceleration_name(name)]
    return {name: program.input(name) for name in names_}
