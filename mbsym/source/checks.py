"""What only the finished parts can show: idle coordinates, false velocities, impossible bodies, broken relations."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from fractions import Fraction
from functools import cache
from typing import Any

from mbsym.expressions.constants import meaningless
from mbsym.expressions.constants import value as value_of
from mbsym.expressions.message import Message, joined
from mbsym.expressions.place import Span
from mbsym.expressions.tree import (
    ONE,
    ZERO,
    Call,
    Derivation,
    Expression,
    Name,
    Number,
    Operation,
    differentiate,
    divide,
    multiply,
    names,
    negative,
    number,
    sign_by_structure,
    subtract,
    text,
)
from mbsym.model.admissibility import (
    ROUNDING,
    body_violation,
    decimal,
    has_negative_energy,
    impossible_alone,
    known_values,
    number_of,
    numeric_tensor,
    numeric_vector,
    offset_violation,
    symbolic_violation,
)
from mbsym.model.assumptions import broken, contradictory
from mbsym.model.substitution import folded
from mbsym.model.system import Body, System, rational, velocity_name
from mbsym.source.bodies import Draft
from mbsym.source.identity import in_floats, vanishes
from mbsym.source.reading import Reading
from mbsym.source.yaml_writer import inertia_shape

#: Relative error of a number that is computed in floats because it has no exact value.
_FLOATS = Fraction(1, 10**12)

#: Directions are the same to so much; angles such as 1.5708 are decimals.
_PARALLEL = 1e-9

#: Roots and sines of the given values are compared in floats: what differs by more is different.
_ROUNDED_ROOTS = Fraction(1, 10**9)

#: Values that differ by less than one part in so many are taken for rounded ones.
_ROUNDED = 1_000


def check_body(system: System, draft: Draft, values: Mapping[str, Fraction], reading: Reading) -> None:
    """Everything that can be decided about one body whose expressions were read without complaint."""
    body = system.bodies[draft.number - 1]
    _check_coordinates(system, body, draft, reading)
    _check_relative_velocity(system, body, draft, reading)
    _check_mass(system, body, draft, values, reading)
    _check_inertia(system, body, draft, values, reading)


# --- coordinates -----------------------------------------------------------------------------------------------------


def _check_coordinates(system: System, body: Body, draft: Draft, reading: Reading) -> None:
    """Each coordinate of a joint turns the joint or moves its connection point."""
    for scalar in draft.coordinates:
        name = scalar.text
        if _moves(body, name):
            continue
        others = [other.name for other in system.bodies if other is not body and _moves(other, name)]
        hint = (
            Message("it moves '[[others]]': list it there", others=others[0])
            if others
            else "use it in an angle or in the connection point"
        )
        reading.error(
            "idle-coordinate", "the coordinate '[[name]]' moves nothing in this joint", scalar.span, hint, name=name
        )


def _moves(body: Body, name: str) -> bool:
    expressions = (*body.rotation.angles, *body.connection_point)
    return any(
        name in names(expression) and vanishes(differentiate(expression, name)) is not True
        for expression in expressions
    )


# --- relative velocity -----------------------------------------------------------------------------------------------


def _check_relative_velocity(system: System, body: Body, draft: Draft, reading: Reading) -> None:
    """A given relative velocity must be the derivative of the radius vector of the connection point."""
    if body.relative_velocity is None:
        return
    rates = _rates(system)
    relations = {relation.name: relation.value for relation in system.relations}
    for index, (expression, radius) in enumerate(zip(body.relative_velocity, body.connection_point, strict=True)):
        derived = Derivation(rates)(radius)
        if vanishes(subtract(expression, derived), relations) is False:
            span = expression.span or draft.fields.key_span("relative velocity")
            message = Message("component [[index]] is not the derivative of the connection point", index=index + 1)
            reading.error(
                "relative-velocity",
                message,
                span,
                _short(Message("the derivative is [[derived]]", derived=text(derived))),
            )


def _short(hint: str, instead: str = "leave the relative velocity out: it is then derived") -> str:
    return hint if len(hint) <= 200 else instead


def _rates(system: System) -> dict[str, Expression]:
    rates: dict[str, Expression] = {name: Name(velocity_name(name)) for name in system.coordinates}
    rates.update({prescribed.name: prescribed.rate for prescribed in system.prescribed})
    return {**rates, "t": ONE}


# --- masses and inertias ---------------------------------------------------------------------------------------------


def _check_mass(system: System, body: Body, draft: Draft, values: Mapping[str, Fraction], reading: Reading) -> None:
    signs = {parameter.name: parameter.sign for parameter in system.parameters}
    value = value_of(body.mass, values)
    if (value is not None and value < 0) or sign_by_structure(body.mass, signs) == "negative":
        reading.error("negative-mass", "this mass is negative", _place(draft, "mass"), _values_hint(body.mass))


def _values_hint(*expressions: Expression) -> str | None:
    return "with the given values and signs" if any(names(expression) for expression in expressions) else None


def _place(draft: Draft, key: str) -> Span:
    return draft.fields.entries[key].value.span


def _check_inertia(system: System, body: Body, draft: Draft, values: Mapping[str, Fraction], reading: Reading) -> None:
    if body.inertia is None:
        return
    span = _place(draft, "inertia")
    signs = {parameter.name: parameter.sign for parameter in system.parameters}
    entries = [entry for row in body.inertia.tensor for entry in row]
    for index in range(3):
        if sign_by_structure(body.inertia.tensor[index][index], signs) == "negative":
            message = Message("the moment of inertia about axis [[index]] is negative", index=index + 1)
            reading.error(
                "bad-inertia",
                Message("no body has this inertia: [[message]]", message=message),
                span,
                _values_hint(*entries),
            )
            return
    alone = impossible_alone(body.inertia.tensor, signs, values)
    if alone is not None:
        _check_single_moment(system, body, alone, values, span, reading)
        return
    if _check_numbers(system, body, values, span, reading) or body.inertia.accepted:
        return
    about_joint = body.inertia.about == "joint"
    doubt = symbolic_violation(body.inertia.tensor, body.mass, body.mass_centre, about_joint, signs)
    if doubt is not None:
        own = symbolic_violation(body.inertia.tensor, body.mass, body.mass_centre, False, signs)
        advice = "with 'inertia about: mass centre' it would be possible" if about_joint and own is None else None
        reading.complaints.warning(
            "impossible-inertia", Message("no body has this inertia: [[doubt]]", doubt=doubt), span, advice
        )


def _check_numbers(system: System, body: Body, values: Mapping[str, Fraction], span: Span, reading: Reading) -> bool:
    """Whether something was said of the numbers: rounding is a warning, more is an error unless it is accepted.

    A body about a fixed point has the kinetic energy w.J_O w/2, which needs no tensor about the mass centre.
    """
    violation = body_violation(body, values)
    if body.inertia is None or violation is None:
        return False
    entries = [entry for row in body.inertia.tensor for entry in row]
    message = Message("no body has this inertia: [[violation]]", violation=violation)
    about = body
    if body.inertia.accepted and body.inertia.about == "joint" and _is_fixed(system, body):
        about = replace(body, inertia=replace(body.inertia, about="mass centre"))
    if body_violation(body, values, ROUNDING) is None:
        warning = Message("no body has exactly this inertia: [[violation]]", violation=violation)
        hint = "taken for rounding, as it is less than a millionth; the numbers are used as they stand"
        reading.complaints.warning("rounded-inertia", warning, span, hint)
    elif has_negative_energy(about, values) and not _is_possible_elsewhere(body, values):
        if body.inertia.accepted:
            message = joined([message, Message("its kinetic energy would be negative")], "; ")
        reading.error("bad-inertia", message, span, _values_hint(*entries))
    elif _is_possible_elsewhere(body, values) and (not body.inertia.accepted or has_negative_energy(about, values)):
        hint = "with 'inertia about: mass centre' it would be possible"
        reading.error("bad-inertia", message, span, hint)
    elif not body.inertia.accepted:
        written = _written(inertia_shape(body.inertia))
        hint = Message("if they were identified, write {tensor: [[written]], accept: true}", written=written)
        if any(names(entry) for entry in entries):
            hint = joined([Message("with the given values"), hint], "; ")
        reading.error(
            "bad-inertia", message, span, _short(hint, "write {tensor: ..., accept: true} if it was identified")
        )
    return True


def _is_fixed(system: System, body: Body) -> bool:
    """Whether the body's connection point rests in space, for sure."""
    moving = {*system.coordinates, *(prescribed.name for prescribed in system.prescribed), "t"}
    bodies = {member.name: member for member in system.bodies}
    for _ in bodies:
        if any(names(x) & moving for x in body.connection_point):
            return False
        if body.attached_to not in bodies:
            return True
        body = bodies[body.attached_to]
        if any(names(angle) & moving for _, angle in body.rotation.turns()):
            return False
    return False


def _is_possible_elsewhere(body: Body, values: Mapping[str, Fraction]) -> bool:
    """Whether what is impossible about the joint would be possible about the mass centre."""
    if body.inertia is None or body.inertia.about != "joint":
        return False
    return body_violation(replace(body, inertia=replace(body.inertia, about="mass centre")), values, ROUNDING) is None


def _written(shape: object) -> str:
    """A tensor as it stands in YAML."""
    return f"[{', '.join(map(_written, shape))}]" if isinstance(shape, list) else str(shape)


def _check_single_moment(
    system: System, body: Body, alone: int, values: Mapping[str, Fraction], span: Span, reading: Reading
) -> None:
    """Of the only moment that was given no more is asked than its own sign, about the mass centre, too."""
    assert body.inertia is not None
    if not _is_enough(system, body, alone) and not body.inertia.accepted:
        message = Message(
            "no body has this inertia: 0 + 0 is less than the moment of inertia about axis [[alone]]", alone=alone + 1
        )
        hint = _rod_hint(text(body.inertia.tensor[alone][alone]), alone)
        reading.complaints.warning("single-moment", message, span, hint)
    tensor = numeric_tensor(body.inertia.tensor, values)
    mass, centre = number_of(body.mass, values), numeric_vector(body.mass_centre, values)
    if tensor is None or mass is None or centre is None or body.inertia.about != "joint":
        return
    violation = offset_violation(tensor, mass, centre, (alone,), ROUNDING)
    if violation is not None:
        values_hint = _values_hint(*(entry for row in body.inertia.tensor for entry in row))
        reading.error("bad-inertia", "no body has this inertia: [[violation]]", span, values_hint, violation=violation)


def _is_enough(system: System, body: Body, index: int) -> bool:
    """Whether the moment about one axis is all that matters: the body never turns about any other direction.

    The axis is followed from the body up to the inertial frame: what turns there must turn about it.  Fixed turns
    bring it into other axes, q about axis 3 and then pi/2 about axis 1 turns the body about its axis 2.  A Newtonian
    field acts on the other moments, too.
    """
    if system.newtonian_fields:
        return False
    moving = {*system.coordinates, *(prescribed.name for prescribed in system.prescribed), "t"}
    bodies = {member.name: member for member in system.bodies}
    direction: list[float] | None = [float(k == index) for k in range(3)]  # in the axes after the turn; None: unknown
    part, passed = body, 0
    while passed <= len(bodies):
        for axis, angle in reversed(list(part.rotation.turns())):
            along = direction is not None and abs(abs(direction[axis - 1]) - 1) < _PARALLEL
            if along:
                continue
            if names(angle) & moving:
                return False
            fixed = in_floats(angle, {})
            direction = None if direction is None or fixed is None else _turned_back(direction, axis, fixed)
        if part.attached_to not in bodies:
            return True
        part, passed = bodies[part.attached_to], passed + 1
    return False


def _turned_back(v: list[float], axis: int, angle: float) -> list[float]:
    """C_a(x)^T v: components before a turn about an axis from those after it."""
    first, second = axis % 3, (axis + 1) % 3
    rotated = list(v)
    rotated[first] = math.cos(angle) * v[first] - math.sin(angle) * v[second]
    rotated[second] = math.sin(angle) * v[first] + math.cos(angle) * v[second]
    return rotated


def _rod_hint(moment: str, axis: int) -> str:
    """A body with the wanted moment about an axis, which is as good where it turns about this axis only."""
    along = 0 if axis else 1
    rod = ", ".join("0" if index == along else moment for index in range(3))
    matter = Message(
        "in planar motion, turning about axis [[axis]] only, the other moments do not matter", axis=axis + 1
    )
    return _short(
        Message("[[[rod]]] is a thin rod along axis [[along]]; [[matter]]", rod=rod, along=along + 1, matter=matter),
        matter,
    )


# --- the whole -------------------------------------------------------------------------------------------------------


def check_system(system: System, reading: Reading) -> None:
    """Relations must agree with the values that are given for both sides; assumptions should hold for them."""
    _check_given(system, reading)
    _check_relation_values(system, reading)
    _check_assumption_values(system, reading)
    _check_degrees(system, reading)
    if not reading.errors:  # else a misspelt use would be complained about twice
        _check_use(system, reading)


def _check_use(system: System, reading: Reading) -> None:
    """Every parameter and prescribed motion occurs somewhere outside of its own declaration."""
    used = {relation.name for relation in system.relations}
    declared_alone = replace(system, prescribed=system.of_constant_rate)
    used |= set(_occurring([getattr(declared_alone, field.name) for field in fields(system)]))
    declared = [(Message("parameter"), parameter.name, parameter.span) for parameter in system.parameters]
    declared += [(Message("prescribed motion"), item.name, item.span) for item in system.of_constant_rate]
    if system.linear is None:  # whose B has a column for each
        felt = set(_occurring(system.loads))
        declared += [
            (Message("input"), system_input.name, system_input.span)
            for system_input in system.inputs
            if system_input.name not in felt
        ]
    for function in system.given:
        if used.isdisjoint(function.names):
            declared.append((Message("function of time"), function.name, function.span))
    for what, name, span in declared:
        if name not in used or what == "input":
            message = Message("the [[what]] '[[name]]' is used nowhere", what=what, name=name)
            reading.complaints.warning("unused-name", message, span, "leave it out, or put it where it belongs")


def in_formulas(system: System) -> frozenset[str]:
    """The names that formulas of bodies, loads, constraints, prescribed motions and relations hold."""
    held = (system.bodies, system.loads, system.constraints, system.prescribed, system.relations, system.linear)
    return frozenset(_occurring(held)) | {relation.name for relation in system.relations}


def _occurring(value: Any) -> Iterator[str]:
    """The names in all expressions that a value holds."""
    return (node.name for node in _nodes(value) if isinstance(node, Name))


def _nodes(value: Any) -> Iterator[Name | Call | Operation]:
    """The names, functions and operations in all expressions that a value holds."""
    if isinstance(value, Name | Call | Operation):
        yield value
    if isinstance(value, tuple | list):
        for item in value:
            yield from _nodes(item)
    elif not isinstance(value, Name):
        for name in _field_names(value.__class__):
            yield from _nodes(getattr(value, name))


@cache
def _field_names(kind: Any) -> tuple[str, ...]:
    """The fields of a dataclass; of what is none, nothing."""
    return tuple(field.name for field in fields(kind)) if is_dataclass(kind) else ()


def _check_given(system: System, reading: Reading) -> None:
    """With the given values of parameters, relations, initial values and limits are numbers, too."""
    known: dict[str, Any] = {}
    for parameter in system.parameters:
        value = None if parameter.value is None else value_of(parameter.value)
        if value is not None:
            known[parameter.name] = value
    for _ in system.relations:  # in whatever order they stand
        for relation in system.relations:
            value = value_of(relation.value, known) if relation.name not in known else None
            if value is not None:
                known[relation.name] = value
    held = [relation.value for relation in system.relations]
    held += [
        initial_value
        for entry in (*system.initial, *system.start)
        for initial_value in (entry.position, entry.velocity)
        if initial_value
    ]
    held += [bound for limit in system.limits for bound in (limit.lower, limit.upper)]
    held += [prescribed.initial for prescribed in system.prescribed if prescribed.initial]
    for expression in held:
        if not names(expression) or not names(expression) <= known.keys():
            continue  # without names it has been judged where it stands
        if (nothing := meaningless(expression, known)) is not None:
            node, why = nothing
            reading.error("no-number", "with the given values this is no real number: [[why]]", node.span, why=why)
    _check_roots(system, known, reading)


_OF_NEGATIVE = Message("with the given signs this is no real number: its argument is negative")


def _check_roots(system: System, known: Mapping[str, Any], reading: Reading) -> None:
    """Roots and logarithms of constants are real, by the signs of the parameters and by their values.

    So are those that hold coordinates, on the unperturbed motion.
    """
    signs = {parameter.name: parameter.sign for parameter in system.parameters}
    rest = {} if system.constraints or not system.motion else dict.fromkeys(system.coordinates, ZERO)
    places = rest | {entry.coordinate: entry.value for entry in system.motion}
    for entry in system.motion:
        if entry.rate != ZERO:
            del places[entry.coordinate]
    held = (system.bodies, system.loads, system.constraints, system.linear, system.relations, system.assumptions)
    roots: dict[Span | None, tuple[Expression, Expression]] = {}
    for node in _nodes(held):
        if isinstance(node, Call) and node.function in ("sqrt", "log"):
            roots[node.span] = node, node.argument
        elif isinstance(node, Operation) and node.operator == "**" and not _is_whole(node.right):
            roots[node.span] = node, node.left
    for span, (root, argument) in roots.items():
        if not names(root):
            continue  # it has been judged where it stands
        if sign_by_structure(argument, signs) == "negative":
            reading.error("no-number", _OF_NEGATIVE, span, "change the argument, or the signs that are declared")
        elif names(root) <= known.keys() and (nothing := meaningless(root, known)) is not None and nothing[0] is root:
            message = Message("with the given values this is no real number: [[why]]", why=nothing[1])
            reading.error("no-number", message, span)
        elif moved := sorted(names(argument) & places.keys()):
            there = folded(argument, places)
            value = value_of(there, known)
            if sign_by_structure(there, signs) == "negative" or (value is not None and value < 0):
                where = ", ".join(f"{name} = {text(places[name])}" for name in moved)
                sentence = "on the motion this is no real number: its argument is negative at [[where]]"
                message = Message(sentence, where=where)
                reading.error("no-number", message, span, "give a motion, or values, for which it is positive")


def _is_whole(exponent: Expression) -> bool:
    return isinstance(exponent, Number) and exponent.value.denominator == 1


def _check_relation_values(system: System, reading: Reading) -> None:
    values = known_values(system)
    for relation in system.relations:
        left, right, error = values.get(relation.name), number_of(relation.value, values), Fraction(0)
        if right is None:  # a root, a sine
            about = in_floats(relation.value, {name: number(value) for name, value in values.items()})
            if about is not None:
                right, error = Fraction(about), _FLOATS * abs(Fraction(about))
        if left is None or right is None or abs(left - right) <= error:
            continue
        message = Message(
            "the given values break this relation: [[left]] is not [[right]]",
            left=decimal(left),
            right=decimal(right),
        )
        if abs(left - right) > abs(right) / _ROUNDED:
            reading.error("conflicting-values", message, relation.span)
        else:
            reading.complaints.warning("rounded-value", message, relation.span, "leave the value of the left side out")


def _check_assumption_values(system: System, reading: Reading) -> None:
    """The given values keep every assumption, and some values can keep them all."""
    roots = {parameter.name: parameter.value for parameter in system.parameters if parameter.value is not None}

    def about(expression: Expression, known: Mapping[str, Fraction]) -> Fraction | None:
        value = in_floats(expression, roots | {name: number(value) for name, value in known.items()})
        return None if value is None else Fraction(value)

    values = known_values(system)
    exactly = list(broken(system, values))
    rounded = [violation for violation in broken(system, values, _ROUNDED_ROOTS, about) if violation not in exactly]
    seen = set()
    for assumption, left, right in (*exactly, *rounded):
        if assumption in seen:
            continue
        seen.add(assumption)
        message = Message(
            "the given values break this assumption: [[left]] [[relation]] [[right]]",
            left=decimal(left),
            relation=assumption.relation,
            right=decimal(right),
        )
        reading.error("broken-assumption", message, assumption.span, "change the values, or leave the assumption out")
    if (against := contradictory(system)) is not None:
        contradiction = "no values of the parameters keep this assumption and those before it"
        hint = "declared signs and relations count as well"
        reading.error("contradictory-assumptions", contradiction, against.span, hint)


def _check_degrees(system: System, reading: Reading) -> None:
    """Angles of rotation that are multiples of 10 or 15, more than a turn in radians: degrees most likely."""
    angles = (angle for body in system.bodies for _, angle in body.rotation.turns())
    turned = {angle.name for angle in angles if isinstance(angle, Name)}  # of x/R, x is a length
    places = [(x.coordinate, x.position, x.span) for x in system.initial]
    for name, written, span in [*places, *((x.coordinate, x.value, x.span) for x in system.motion)]:
        value = None if written is None else rational(written)
        if name not in turned or value is None or span is None or not 10 <= abs(value) <= 360:
            continue
        if value % 10 and value % 15:
            continue
        share = Fraction(abs(value), 180)
        half_turns = multiply(number(share.numerator), Name("pi"))
        signed = negative(half_turns) if value < 0 else half_turns
        message = Message(
            "'[[name]]' is an angle in radians: [[value]] are [[turns]] turns",
            name=name,
            value=str(value),
            turns=f"{float(value) / math.tau:.3g}",
        )
        meant = text(divide(signed, number(share.denominator)))
        hint = Message("for [[value]] degrees write [[written]]", value=str(value), written=meant)
        reading.complaints.warning("angle-in-degrees", message, span, hint)
