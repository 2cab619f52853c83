"""Expressions put in for names, everywhere in a description or a part of it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from fractions import Fraction
from typing import Any

from mbsym.expressions.message import Message
from mbsym.expressions.rates import velocity_name, without_velocity
from mbsym.expressions.tree import (
    ONE,
    ZERO,
    Call,
    Derivation,
    Expression,
    Name,
    Negative,
    Number,
    Operation,
    add,
    differentiate,
    divide,
    is_number,
    multiply,
    names,
    negative,
    number,
    power,
    rewritten,
    sign_by_structure,
    substitute,
    subtract,
)
from mbsym.model.constraints import Relation
from mbsym.model.inputs import Input
from mbsym.model.loads import CoordinateDamper, CoordinateSpring, ForceFunction, GeneralizedForce, Load, Rayleigh
from mbsym.model.speeds import OMEGA, UnitVector
from mbsym.model.system import Body, MotionEntry, Parameter, System, Vector, rational

_EXPRESSIONS = (Number, Name, Negative, Operation, Call)
_FOLDING = {"+": add, "-": subtract, "*": multiply}

Replacing = Callable[[Expression, Mapping[str, Expression]], Expression]


def put(part: Any, images: Mapping[str, Expression], replaced: Replacing = substitute) -> Any:
    """A part of a system with names replaced in every expression; what does not change is the same object."""
    if isinstance(part, _EXPRESSIONS):
        return replaced(part, images) if names(part) & images.keys() else part
    if isinstance(part, tuple):
        return tuple(put(item, images, replaced) for item in part)
    if is_dataclass(part) and not isinstance(part, type):
        inner = {item.name: getattr(part, item.name) for item in fields(part) if item.name != "span"}
        changed = {name: new for name, old in inner.items() if (new := put(old, images, replaced)) is not old}
        return replace(part, **changed) if changed else part
    return part


def folded(expression: Expression, images: Mapping[str, Expression]) -> Expression:
    """The expression with names replaced, products with 0 and 1, sums with 0, x/1 and powers of 1 left out.

    A quotient keeps its divisor: 0/x is not 0 at x = 0.
    """
    if not names(expression) & images.keys():
        return expression
    match expression:
        case Name(name):
            return images[name]
        case Negative(operand):
            return negative(folded(operand, images))
        case Operation(operator, left, right) if operator in _FOLDING:
            return _FOLDING[operator](folded(left, images), folded(right, images))
        case Operation("/", left, right):
            below = folded(right, images)
            return folded(left, images) if is_number(below, 1) else Operation("/", folded(left, images), below)
        case Operation("**", base, exponent) if is_number(folded(base, images), 1) and not names(exponent):
            return Number(Fraction(1))
    return substitute(expression, images)


# A system with expressions in place of its free functions of time.


def with_laws(system: System, laws: Mapping[str, Expression] | None = None) -> System:
    """The system with laws in place of its free functions of time, their exact derivatives in place of these.

    ``laws`` go before those of the description; a function that has none stays.
    """
    return with_images(system, images_of_laws(system, laws or {}))


def with_images(system: System, images: Mapping[str, Expression]) -> System:
    """The same of what ``images_of_laws`` gives."""
    if not images:
        return system
    free = replace(
        system,
        given=tuple(item for item in system.given if item.name not in images),
        prescribed=tuple(item for item in system.prescribed if item.given not in images),
    )
    told: System = put(free, images, folded)
    loads = (in_coordinates(load.written, system) for load in told.loads)
    return replace(told, loads=tuple(load for x in loads if (load := x.simplified()) is not None))


def images_of_laws(system: System, laws: Mapping[str, Expression]) -> dict[str, Expression]:
    """What free functions of time and their derivatives are: by ``laws``, else by those of the description."""
    rate = Derivation({"t": ONE} | {item.name: item.rate for item in system.of_constant_rate})
    images: dict[str, Expression] = {}
    for item in system.given:
        value = laws.get(item.name, item.law)
        for name in item.names if value is not None else ():
            assert value is not None
            images[name], value = value, rate(value)
    return images


def lacking_law(name: str) -> tuple[Message, Message]:
    """What is said where a free function of time has no law, and what to do."""
    hint = Message("say what it is under 'given': [[entry]]", entry=f"{name}: {{of: t, value: sin(t)}}")
    return Message("the function of time [[name]] has no law", name=name), hint


# A system with expressions in place of its inputs.


def driven(system: System, laws: Mapping[str, Expression]) -> System:
    """The system whose inputs are the given expressions, in the state, parameters and t; others keep ``held``.

    It has no inputs and no outputs.  Loads that vanish are left out: zero forces would only cast doubt on the energy.
    """
    if not system.inputs:
        return replace(system, outputs=()) if system.outputs else system
    images = {signal.name: laws.get(signal.name, signal.held) for signal in system.inputs}
    loads = (in_coordinates(put(load.written, images, folded), system) for load in system.loads)
    remaining = tuple(load for substituted in loads if (load := substituted.simplified()) is not None)
    return replace(system, loads=remaining, inputs=(), outputs=())


def held(system: System) -> System:
    """The system whose inputs keep the constant values of the unperturbed motion: the one problems 4 to 6 judge."""
    return driven(system, {})


def with_held(inputs: tuple[Input, ...], values: Mapping[str, Expression]) -> tuple[Input, ...]:
    """The inputs with their constant values on the unperturbed motion, where these are given."""
    return tuple(replace(signal, held=values.get(signal.name, ZERO)) for signal in inputs)


# Speeds and unit vectors in coordinates and velocities.


def in_coordinates(load: Load, system: System) -> Load:
    """A load of speeds and unit vectors as one of coordinates and velocities, with what was written beside.

    e = C_a3 C_a2 C_a1 e_axis;  u = S q' + s0.
    """
    images = speeds_in_coordinates(held_names(load), system)
    return replace(put(load, images, folded), as_written=load) if images else load


def held_names(load: object) -> set[str]:
    """The coordinates in a load, by name or in an expression, velocities among them."""
    held: set[str] = set()
    pending: list[object] = [load]
    while pending:
        part = pending.pop()
        if isinstance(part, str):
            held.add(without_velocity(part))
        elif isinstance(part, tuple):
            pending.extend(part)
        elif is_dataclass(part):
            pending.extend(getattr(part, field.name) for field in fields(part) if field.name != "span")
    return held


def speeds_in_coordinates(held: Collection[str], system: System) -> dict[str, Expression]:
    """The speeds and the components of unit vectors that are ``held``, in coordinates and velocities."""
    images = _in_angles(held, system.bodies)
    for speed in system.speeds:
        if speed.name in held:
            spin = angular_velocity(system, speed.body) if speed.turns else ()
            images[speed.name] = substitute(speed.form, dict(zip(OMEGA, spin, strict=False)))
    return images


def _in_angles(held: Collection[str], bodies: Sequence[Body]) -> dict[str, Expression]:
    """The unit vectors that are ``held`` by their components, as functions of angles."""
    images = dict[str, Expression]()
    for body in bodies:
        for vector in body.orientation:
            if isinstance(vector, UnitVector) and {*vector.components} & {*held}:
                columns: list[Expression] = [ONE if axis == vector.axis else ZERO for axis in (1, 2, 3)]
                for axis, angle in body.rotation.turns():
                    columns = _turned(columns, axis, angle)
                images |= dict(zip(vector.components, columns, strict=True))
    return images


def angular_velocity(system: System, body: str) -> Vector:
    """omega of a body in its own axes, as expressions:  w <- C_a(x) w + x' e_a  turn by turn."""
    spin: list[Expression] = [ZERO, ZERO, ZERO]
    for name in system.path(body)[1:]:
        for axis, angle in system.body(name).rotation.turns():
            spin = _turned(spin, axis, angle)
            for coordinate in system.coordinates:
                slope = differentiate(angle, coordinate)
                spin[axis - 1] = add(spin[axis - 1], multiply(slope, Name(velocity_name(coordinate))))
            for item in system.prescribed:
                spin[axis - 1] = add(spin[axis - 1], multiply(differentiate(angle, item.name), item.rate))
            spin[axis - 1] = add(spin[axis - 1], differentiate(angle, "t"))
    return spin[0], spin[1], spin[2]


def _turned(v: Sequence[Expression], axis: int, angle: Expression) -> list[Expression]:
    """C_a(x) v."""
    i, j = axis % 3, (axis + 1) % 3
    s, c = Call("sin", angle), Call("cos", angle)
    turned = list(v)
    turned[i] = add(multiply(c, v[i]), multiply(s, v[j]))
    turned[j] = add(multiply(c, v[j]), negative(multiply(s, v[i])))
    return turned


# A system with expressions in place of coordinates that its relations give.


def without_explicit_relations(system: System) -> System:
    """The same motions in fewer coordinates: a relation c s = f(q), c a number or a parameter of known sign, gives s.

    Generalised forces go with the displacements that are left, Q_q + Q_s ds/dq.  Relations that hold prescribed
    quantities or t stay, and all that are not so.  Inputs are at their values; claims and other things that tell of the
    coordinates are left out, but for what abbreviates formulas and the initial values of coordinates that are left.
    """
    if any(isinstance(constraint, Relation) for constraint in system.constraints):
        alone = replace(_motions_alone(system), initial=system.begun, dependent=system.dependent)
        system = replace(alone, abbreviations=system.abbreviations, notation=system.notation)
    while (explicit := _explicit(system)) is not None:
        relation, name, value = explicit
        remaining = tuple(constraint for constraint in system.constraints if constraint is not relation)
        free = [coordinate for coordinate in system.coordinates if coordinate != name]
        system = _told_by(replace(system, constraints=remaining), name, value, free)
    return replace(system, dependent=()) if system.dependent else system


def displaced(system: System, name: str, direction: Mapping[str, Fraction]) -> System:
    """The same motions with the coordinate ``name`` along a direction: q_i + c_i q_name in place of every other q_i."""
    system = _motions_alone(system)
    values = {entry.coordinate: (entry.value, entry.rate) for entry in system.motion}
    still = ZERO, ZERO
    for coordinate, c in direction.items():
        if c and coordinate != name:
            along = multiply(number(c), Name(name))
            pairs = zip(values.get(coordinate, still), values.get(name, still), strict=True)
            value, rate = (subtract(x, multiply(number(c), y)) for x, y in pairs)
            others = tuple(entry for entry in system.motion if entry.coordinate != coordinate)
            system = _told_by(system, coordinate, add(Name(coordinate), along), system.coordinates)
            system = replace(system, motion=(*others, MotionEntry(coordinate, value, rate)))
    return system


def told_by(system: System, name: str, value: Expression) -> System:
    """The motions of the other coordinates, with a value of theirs, of parameters and prescribed ones in its place."""
    return _told_by(_motions_alone(system), name, value, [x for x in system.coordinates if x != name])


def on_one_side(system: System, name: str, side: int) -> System:
    """The system where a coordinate has one sign, +1 or -1: abs and sign of it and of its multiples put in."""

    def one_sided(part: Expression) -> Expression | None:
        match part:
            case Call("abs" | "sign" as function, argument) if (slope := _multiple(argument, name)) is not None:
                turn = number(Fraction(side if slope > 0 else -side))
                return multiply(turn, argument) if function == "abs" else turn
        return None

    return put(_motions_alone(system), {name: Name(name)}, lambda expression, _: rewritten(expression, one_sided))


def _multiple(expression: Expression, name: str) -> Fraction | None:
    """c of c name, a number other than 0; None of others."""
    slope = folded(differentiate(expression, name), {name: ZERO})
    linear = is_number(folded(expression, {name: ZERO}), 0) and not names(differentiate(expression, name))
    return slope.value if linear and isinstance(slope, Number) and slope.value else None


def beside_rest(system: System, names: Sequence[str]) -> System:
    """The motions of the coordinates ``names`` alone, while the others rest where they begin."""
    system = _motions_alone(system)
    begun = {entry.coordinate: entry.value for entry in system.motion}
    for name in (coordinate for coordinate in system.coordinates if coordinate not in names):
        system = told_by(system, name, begun.get(name, ZERO))
    return system


def _motions_alone(system: System) -> System:
    """Without what only tells of coordinates, inputs at their values."""
    system = replace(held(system), claims=(), abbreviations=(), notation=(), outputs=(), reactions=())
    return replace(system, initial=(), start=(), limits=(), order=(), dependent=())


def _explicit(system: System) -> tuple[Relation, str, Expression] | None:
    """A relation, a coordinate and what that is by it; None where there is none."""
    signs = {parameter.name: parameter.sign for parameter in system.parameters}
    still = {*system.coordinates, *signs}
    for relation in system.constraints:
        if not isinstance(relation, Relation) or not names(relation.left) | names(relation.right) <= still:
            continue
        zero = subtract(relation.left, relation.right)
        begun = {entry.coordinate for entry in system.initial}
        place = {name: k for k, name in enumerate(system.coordinates)}
        rank = {name: (name not in system.dependent, name in begun, -k) for name, k in place.items()}
        for name in sorted(place, key=rank.__getitem__):
            slope = differentiate(zero, name)
            if not names(slope) & {*system.coordinates} and sign_by_structure(slope, signs) is not None:
                return relation, name, divide(negative(folded(zero, {name: ZERO})), slope)
    return None


def _told_by(system: System, name: str, value: Expression, free: Sequence[str]) -> System:
    """The system in the coordinates ``free``, with the value of another one, or of one of them, put in everywhere."""
    running = {item.name: item.rate for item in system.prescribed}
    rate = Derivation(running | {free_name: Name(velocity_name(free_name)) for free_name in free})(value)
    images = {name: value, velocity_name(name): rate}

    def acting(load: Load) -> Load:
        match load:
            case CoordinateSpring(coordinate, stiffness, rest) if coordinate == name:
                square = power(subtract(value, rest), number(2))
                return ForceFunction(negative(divide(multiply(stiffness, square), number(2))))
            case CoordinateDamper(coordinate, coefficient) if coordinate == name:
                return Rayleigh(divide(multiply(coefficient, power(rate, number(2))), number(2)))
            case GeneralizedForce(components):
                forces = dict.fromkeys(free, ZERO) | {
                    free_name: force for free_name, force in components if free_name != name
                }
                for free_name in free:
                    forces[free_name] = add(
                        forces[free_name], multiply(dict(components).get(name, ZERO), differentiate(value, free_name))
                    )
                return GeneralizedForce(tuple(forces.items()))
        return load

    bodies = tuple(
        replace(
            body,
            coordinates=tuple(free_name for free_name in body.coordinates if free_name in free),
            relative_velocity=None,
        )
        for body in system.bodies
    )
    there = replace(
        system,
        bodies=bodies,
        loads=tuple(simplified for load in system.loads if (simplified := acting(load).simplified()) is not None),
        motion=tuple(entry for entry in system.motion if entry.coordinate in free),
        initial=tuple(entry for entry in system.initial if entry.coordinate in free),
    )
    return put(there, images, folded)


def with_free_rates(system: System) -> System:
    """Rates of the unperturbed motion that are numbers, not 0, as parameters of these values; itself where none is.

    Steady motions at other rates are a family then, whose members differ in parameters.  Parameters of rates that may
    vanish, and do not at the values, are called nonzero.
    """
    free = {x.coordinate: x.rate for x in system.motion if not names(x.rate) and x.rate != ZERO}
    motion = (replace(x, rate=Name(_RATE + x.coordinate)) if x.coordinate in free else x for x in system.motion)
    rates = (Parameter(_RATE + name, "nonzero", rate) for name, rate in free.items())
    moving = {name for x in system.motion for name in names(x.rate)}
    known = (
        replace(x, sign="nonzero") if x.name in moving and x.sign == "real" and rational(x.value) else x
        for x in system.parameters
    )
    freed = replace(system, motion=tuple(motion), parameters=(*known, *rates))
    return system if freed == system else freed


#: How names of parameters begin that are rates; none that is declared has this ending of velocities inside.
_RATE = "rate_dot_"
