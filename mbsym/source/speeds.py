"""Speeds, unit vectors and quaternions: their names, their forms, whether the generalised velocities follow."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from functools import partial

from mbsym.expressions.message import Message
from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.place import Span
from mbsym.expressions.rates import without_velocity
from mbsym.expressions.tree import (
    ZERO,
    Expression,
    Name,
    differentiate,
    names,
    substitute,
)
from mbsym.model.constraints import Constraint, Relation, Rolling, Velocity, as_written
from mbsym.model.speeds import OMEGA, QUATERNION, Quaternion, Speed, UnitVector
from mbsym.model.substitution import angular_velocity, folded, held_names, speeds_in_coordinates
from mbsym.model.system import INERTIAL, Body, System, velocity_name
from mbsym.source import placed
from mbsym.source.bodies import Draft, read_body_name
from mbsym.source.identity import independent, vanishes
from mbsym.source.keys import ANGLES, COSINES
from mbsym.source.placed import Node
from mbsym.source.reading import Reading
from mbsym.source.scope import Allowed

#: How a body's own angular velocity is written in the form of a speed.
OWN = ("omega1", "omega2", "omega3")
MAX_SPEEDS = 6

_COMPONENT = re.compile(r"\s*omega\[(.*)\]\s*\[\s*([123])\s*\]\s*\Z", re.DOTALL)
_FORM = Allowed("a speed", ("coordinate", "velocity", "prescribed", "parameter", "time"))
_AXES = {"1": 1, "2": 2, "3": 3, QUATERNION: 0}


def declare_speeds(draft: Draft, reading: Reading) -> None:
    """The first pass: the names of speeds and of the components of unit vectors and quaternions."""
    draft.orientation = _orientation(draft.fields.get("orientation"), reading)
    node = draft.fields.get("speeds")
    if node is None:
        return
    entries = list(reading.entries(node, "'speeds'", "{p: omega1, q: omega2, r: omega3}"))
    if len(entries) > MAX_SPEEDS:
        reading.error("too-large", Message("a body has at most [[most]] speeds", most=MAX_SPEEDS), node.span)
        return
    for entry in entries:
        if reading.scope.declare(entry.key.text, "speed", entry.key.span):
            draft.speeds.append((entry.key, entry.value))


def _orientation(node: Node | None, reading: Reading) -> tuple[UnitVector | Quaternion, ...]:
    if node is None:
        return ()
    errors = reading.errors
    if not isinstance(node, placed.Mapping):
        word = reading.word(node, "'orientation'", (ANGLES, COSINES, QUATERNION))
        if word == QUATERNION:
            return _quaternion(_free(Quaternion, "e", (), reading), node.span, reading)
        if word != COSINES:
            return ()
        unit_vectors = _unnamed([], node.span, reading, asked=True)
    else:
        unit_vectors = []
        entries = list(reading.entries(node, "'orientation'"))
        for entry in entries:
            axis = reading.word(entry.value, "the axis of a unit vector", _AXES)
            if axis == QUATERNION and len(entries) > 1:
                message = "a quaternion tells the whole orientation: nothing stands beside it"
                reading.error("orientation", message, entry.key.span, "{[[what]]: quaternion}", what=entry.key.text)
            elif axis == QUATERNION:
                return _quaternion(entry.key.text, entry.key.span, reading)
            elif axis is not None:
                unit_vectors.append(UnitVector(entry.key.text, _AXES[axis], entry.key.span))
        unit_vectors += _unnamed(unit_vectors, node.span, reading, asked=False)
    axes: set[int] = set()
    sound: list[UnitVector] = []
    for vector in unit_vectors:
        assert vector.span is not None
        if vector.axis in axes:
            reading.error("repeated-key", "a second unit vector along axis [[axis]]", vector.span, axis=vector.axis)
            continue
        axes.add(vector.axis)
        declared = [reading.scope.declare(name, "unit vector", vector.span) for name in vector.components]
        if all(declared):
            sound.append(vector)
    sound.sort(key=lambda vector: vector.axis)
    return tuple(sound) if reading.errors == errors else ()


def _quaternion(name: str, span: Span, reading: Reading) -> tuple[Quaternion, ...]:
    """The quaternion of that name; none where a component cannot be called so."""
    quaternion = Quaternion(name, span)
    declared = [reading.scope.declare(component, "quaternion", span) for component in quaternion.components]
    return (quaternion,) if all(declared) else ()


def _unnamed(named: Sequence[UnitVector], span: Span, reading: Reading, asked: bool) -> list[UnitVector]:
    """The unit vectors that nobody named: the place of a body is told by all three."""
    unit_vectors: list[UnitVector] = []
    axes, words = {unit_vector.axis for unit_vector in named}, {unit_vector.name for unit_vector in named}
    for axis, word in enumerate(("alpha", "beta", "gamma"), start=1):
        if axis not in axes:
            make = partial(UnitVector, axis=axis)
            unit_vectors.append(UnitVector(_free(make, word, words, reading), axis, span, asked))
    return unit_vectors


def _free(make: Callable[[str], UnitVector | Quaternion], word: str, taken: Collection[str], reading: Reading) -> str:
    """The word, with a letter behind it where components of that name are declared already."""
    for name in (word, *(f"{word}_{letter}" for letter in "abcdefgh")):
        if name not in taken and not any(component in reading.scope.kinds for component in make(name).components):
            return name
    return word


def read_speeds(draft: Draft, drafts: Sequence[Draft], reading: Reading) -> tuple[Speed, ...]:
    """The second pass: the forms."""
    speeds = []
    for key, value in draft.speeds:
        errors = reading.errors
        body, form = _form(value, draft, drafts, reading)
        if reading.errors == errors:
            speeds.append(Speed(key.text, form, body, key.span))
    return tuple(speeds)


def _form(node: Node, draft: Draft, drafts: Sequence[Draft], reading: Reading) -> tuple[str, Expression]:
    """The body whose angular velocity may stand in a form, and the form."""
    scalar = reading.scalar(node, "a speed")
    match = None if scalar is None else _COMPONENT.match(scalar.text)
    if scalar is not None and match is not None:
        name = scalar.part(*match.span(1))
        body = read_body_name(name, "a speed", [other.name for other in drafts], reading)
        if body == INERTIAL:
            reading.error("unknown-body", "the inertial frame does not turn", name.span)
        return body or draft.name, Name(OMEGA[int(match.group(2)) - 1], scalar.span)
    kinds = reading.scope.kinds
    added = [name for name in OWN if name not in kinds]
    kinds.update(dict.fromkeys(added, "velocity"))
    form = reading.expression(node, _FORM) if scalar is not None else ZERO
    for own in added:
        del kinds[own]
    return draft.name, substitute(form, {own: Name(OMEGA[k]) for k, own in enumerate(OWN) if own in added})


# --- what only the whole shows ---------------------------------------------------------------------------------------


def check_speeds(system: System, drafts: Sequence[Draft], reading: Reading) -> None:
    """Every speed is linear in the generalised velocities, and these follow from the speeds; unit vectors suffice.

    The rank is that of random elements of a prime field: full, it is proved; a deficient one is by accident with a
    probability of about 1e-30.
    """
    if not system.speeds and not any(body.orientation for body in system.bodies):
        return
    errors = reading.errors
    rows: list[list[Expression]] = []
    ordered = _ordered(system)
    for speed in system.speeds:
        assert speed.span is not None
        row = _row(system, speed, ordered)
        if row is None:
            message = Message("'[[name]]' is not linear in the velocities", name=speed.name)
            reading.error("not-linear", message, speed.span, "a sum of velocities with coefficients in coordinates")
            continue
        if not any(vanishes(x) is not True for x in row):
            hint = "write velocities such as x_dot, or omega1, omega2, omega3 of this body"
            reading.error("no-velocity", Message("'[[name]]' contains no velocity", name=speed.name), speed.span, hint)
            continue
        rows.append(row)
        if reading.errors == errors and len(independent(rows)) < len(rows):
            others = ", ".join(earlier.name for earlier in system.speeds[: len(rows) - 1])
            reading.error(
                "dependent-speeds",
                "'[[name]]' follows from [[others]]: the generalised velocities cannot be found from them",
                speed.span,
                "there are [[count]] generalised velocities; speeds are independent of each other",
                name=speed.name,
                others=others,
                count=len(ordered),
            )
    for body, draft in zip(system.bodies, drafts, strict=True):
        if body.orientation:
            _check_orientation(system, body, draft, reading)


def _ordered(system: System) -> list[str]:
    """The coordinates, those of bodies with speeds first: their velocities are replaced before those of others."""
    first = [name for body in system.bodies if body.speeds for name in body.coordinates]
    return [*first, *(name for name in system.coordinates if name not in first)]


def _row(system: System, speed: Speed, ordered: Sequence[str]) -> list[Expression] | None:
    """The coefficients of the generalised velocities; None where the form is not linear in them."""
    form = speed.form
    if speed.turns:
        spin = angular_velocity(system, speed.body)
        form = substitute(form, dict(zip(OMEGA, spin, strict=True)))
    row = [differentiate(form, velocity_name(name)) for name in ordered]
    for slope in row:
        for name in ordered:
            curved = velocity_name(name) in names(slope) and differentiate(slope, velocity_name(name))
            if curved and vanishes(curved) is not True:
                return None
    return row


def constraint_in_coordinates(constraint: Constraint, system: System) -> Constraint:
    """The same of a relation, between velocities, too, and of a point of contact."""
    if isinstance(constraint, Relation | Velocity):
        written: tuple[Expression, ...] = (constraint.left, constraint.right)
    elif isinstance(constraint, Rolling):
        written = constraint.contact
    else:
        return constraint
    images = speeds_in_coordinates({name for x in written for name in names(x)}, system)
    if not images:
        return constraint
    made = [folded(x, images) for x in written]
    if isinstance(constraint, Rolling):
        return replace(constraint, contact=(made[0], made[1], made[2]), in_vectors=written)
    return replace(constraint, left=made[0], right=made[1], in_vectors=written)


def _check_orientation(system: System, body: Body, draft: Draft, reading: Reading) -> None:
    """A body that is turned by three angles of its own, which stand nowhere else, and has all three components of its
    angular velocity as speeds."""
    span = draft.fields.key_span("orientation")
    whole = isinstance(body.orientation[0], Quaternion)
    what = Message("a quaternion" if whole else "unit vectors")
    turns = Message("a quaternion turns with the body" if whole else "unit vectors turn with the body")
    own = {*body.own_angles}
    if len(own) != 3:
        message = Message("this joint has not three angles of its own: [[what]] would be more than it needs", what=what)
        reading.error("orientation", message, span, "leave 'orientation' out")
        return
    components = {speed.component for speed in system.speeds if speed.body == body.name}
    if not {1, 2, 3} <= components:
        hint = "speeds: {p: omega1, q: omega2, r: omega3}"
        reading.error("orientation", Message("[[turns]]: its angular velocity is wanted", turns=turns), span, hint)
    used = {name: place for name, place in _uses(system, body) if name in own}
    for name, place in used.items():
        message = Message(
            "the angle '[[name]]' stands in [[place]]: [[what]] cannot take its place",
            name=name,
            place=place,
            what=what,
        )
        hint = "leave 'orientation' out"
        if place == _LOAD:
            hint += ", or write the load as a force or torque"
            hint += "" if whole else ", or as a potential of the unit vectors"
        reading.error("orientation", message, span, hint)


#: Where an angle may stand: in a load on coordinates, and in one that is a force or torque on bodies already.
_LOAD, _FORCE = "a load", "a load on bodies"


def _uses(system: System, body: Body) -> list[tuple[str, str]]:
    """Names in other places than the angles of a body's joint, with these places."""
    uses = [(name, _FORCE if load.bodies else _LOAD) for load in system.loads for name in held_names(load.written)]
    uses += [(name, "a constraint") for constraint in system.constraints for name in held_names(as_written(constraint))]
    uses += [(name, "its connection point") for x in body.connection_point for name in names(x)]
    for other in system.bodies:
        if other is not body:
            place = Message("the joint of [[name]]", name=ascii_safe(other.name))
            expressions = (*other.rotation.angles, *other.connection_point)
            uses += [(name, place) for x in expressions for name in names(x)]
        for speed in other.speeds:
            held = {without_velocity(name) for name in names(speed.form)}
            uses += [(name, Message("the speed '[[name]]'", name=speed.name)) for name in held]
    return uses
