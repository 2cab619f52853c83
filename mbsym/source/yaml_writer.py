"""A System as plain data in the order of the format, which both writers spell out, and as YAML.

Mappings are dictionaries, lists are lists, leaves are text; keys that say nothing (no turns, zero vectors) are left
out, so that a written file is as short as a hand-written one.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from typing import Any, Union

from mbsym.expressions.angles import angle_name
from mbsym.expressions.table import HOLD, LINEAR, Table
from mbsym.expressions.tree import ZERO, Expression, Name, Number, substitute, text
from mbsym.model.claims import CLAIMS, INITIAL_STATE, Claim, index_names
from mbsym.model.constraints import Axis, Constraint, as_written
from mbsym.model.inputs import Input
from mbsym.model.linear import MATRICES, LinearModel
from mbsym.model.loads import Load
from mbsym.model.speeds import OMEGA, Speed
from mbsym.model.system import (
    Body,
    Given,
    Inertia,
    InitialValue,
    MotionEntry,
    Parameter,
    Point,
    Prescribed,
    Rotation,
    SmallParameter,
    System,
)
from mbsym.model.system import Shape as Look
from mbsym.source.grammar import Ends, Equation, Formula, Key, Kind, Named, Record, Same, Type
from mbsym.source.grammar import Vector as VectorType
from mbsym.source.keys import CONSTRAINTS, LOADS, VERSION
from mbsym.source.placed import NULL

Shape = Union[str, list["Shape"], dict[str, "Shape"]]  # noqa: UP007 (a quoted name takes no |)

_ZERO_VECTOR = (ZERO, ZERO, ZERO)


def system_shape(system: System) -> dict[str, Shape]:
    """A whole description by its keys, in the order of the format; what says nothing is left out."""
    compared: list[Shape] = [assumption_text(one.left, one.relation, one.right) for one in system.assumptions]
    bodies: list[Shape] = [*map(body_shape, system.bodies, inferred_coordinates(system))]
    shape: dict[str, Shape] = {
        "name": system.name,
        "description": system.description,
        "source": system.source,
        "label": system.label,
        "language": system.language,
        "order": [*system.order],
        "parameters": {one.name: parameter_shape(one) for one in system.parameters},
        "prescribed": {one.name: prescribed_shape(one) for one in system.of_constant_rate},
        "given": {one.name: given_shape(one) for one in system.given},
        "inputs": {one.name: input_shape(one) for one in system.inputs},
        "tables": {one.name: table_shape(one) for one in system.tables},
        "units": {one.name: one.text for one in system.units.declared},
        "bodies": bodies if system.linear is None else [],
        "linear system": {} if system.linear is None else linear_shape(system.linear),
        "loads": [dict([load_shape(load)]) for load in system.loads],
        "constraints": [dict([constraint_shape(one)]) for one in system.constraints],
        "dependent": [*system.dependent],
        "reactions": [*system.reactions],
        "relations": {one.name: text(one.value) for one in system.relations},
        "motion": motion_shapes(system),
        "notation": {one.name: text(one.value) for one in system.notation},
        "outputs": {one.name: text(one.value) for one in system.outputs},
        "assumptions": compared,
        "dimensionless time": "" if system.time_scale is None else text(system.time_scale),
        "small parameter": "" if system.small is None else small_shape(system.small),
        "initial": {value.coordinate: initial_shape(value) for value in (*system.initial, *system.start)},
        "limits": {limit.coordinate: [text(limit.lower), text(limit.upper)] for limit in system.limits},
        "latex": {symbol.name: symbol.latex for symbol in system.symbols},
        "abbreviations": {one.name: text(one.value) for one in system.abbreviations},
        "claims": [claim_shape(claim, system) for claim in system.claims],
    }
    return {key: value for key, value in shape.items() if value or key == "name"}


def vector_shape(vector: Sequence[Expression]) -> list[Shape]:
    return [text(component) for component in vector]


def parameter_shape(parameter: Parameter) -> dict[str, Shape]:
    return {"sign": parameter.sign, **_told("value", parameter.value, parameter.meaning)}


def prescribed_shape(prescribed: Prescribed) -> dict[str, Shape]:
    return {"rate": text(prescribed.rate), **_told("initial", prescribed.initial, prescribed.meaning)}


def given_shape(given: Given) -> dict[str, Shape]:
    return {"of": "t", **_told("value", given.law, given.meaning)}


def _told(key: str, value: Expression | None, meaning: str) -> dict[str, Shape]:
    """What a name is worth, under this key, and what it means, as far as that is said."""
    shape: dict[str, Shape] = {} if value is None else {key: text(value)}
    return shape | ({"meaning": meaning} if meaning else {})


def input_shape(system_input: Input) -> dict[str, Shape]:
    return {"meaning": system_input.meaning} if system_input.meaning else {}


def motion_shapes(system: System) -> dict[str, Shape]:
    """The unperturbed motion of coordinates, and the values at which inputs are held there."""
    shapes = {entry.coordinate: motion_shape(entry) for entry in system.motion}
    return shapes | {
        system_input.name: text(system_input.held) for system_input in system.inputs if system_input.held != ZERO
    }


def small_shape(small: SmallParameter) -> Shape:
    """The name alone where nothing more is said."""
    said: dict[str, Shape] = {}
    if small.powers:
        said["powers"] = {name: str(power) for name, power in small.powers}
    if small.fast:
        said["fast"] = [*small.fast]
    if small.slow:
        said["slow"] = [*small.slow]
    if small.leading:
        said["leading"] = small.leading
    return {small.name: said} if said else small.name


def table_shape(table: Table) -> dict[str, Shape]:
    shape: dict[str, Shape]
    if table.source is not None:
        columns: list[Shape] = [*table.source.columns]
        shape = {"file": table.source.file, "columns": columns, "sha256": table.source.digest}
    else:
        points: list[Shape] = [[text(Number(x)), text(Number(y))] for x, y in table.points]
        shape = {"points": points}
    if table.between != LINEAR:
        shape["between"] = table.between
    if table.outside != HOLD:
        shape["outside"] = table.outside
    return shape


def linear_shape(linear: LinearModel) -> dict[str, Shape]:
    """Coordinates and matrices; those of files by the files' names."""
    names: list[Shape] = [*linear.coordinates]
    shape: dict[str, Shape] = {"coordinates": names}
    for matrix in linear.matrices:
        if matrix.source is not None:
            shape[matrix.key] = {"file": matrix.source.file, "sha256": matrix.source.digest}
        else:
            rows: list[Shape] = [[text(x) for x in row] for row in matrix.rows]
            shape[matrix.key] = rows
    return shape


def body_shape(body: Body, inferred: tuple[str, ...]) -> dict[str, Shape]:
    """One body; its coordinates are left out where the reader infers exactly them."""
    shape: dict[str, Shape] = {"name": body.name, "attached to": body.attached_to}
    if body.rotation.axes:
        shape["rotation"] = rotation_shape(body.rotation)
    if body.connection_point != _ZERO_VECTOR:
        shape["connection point"] = vector_shape(body.connection_point)
    if body.relative_velocity is not None:
        shape["relative velocity"] = vector_shape(body.relative_velocity)
    if body.mass_centre != _ZERO_VECTOR:
        shape["mass centre"] = vector_shape(body.mass_centre)
    shape["mass"] = text(body.mass)
    if body.inertia is not None:
        shape["inertia about"] = body.inertia.about
        shape["inertia"] = body_inertia_shape(body.inertia)
    if body.gyrostatic_moment is not None:
        shape["gyrostatic moment"] = vector_shape(body.gyrostatic_moment)
    if body.coordinates != inferred:
        shape["coordinates"] = list(body.coordinates)
    if body.speeds:
        shape["speeds"] = {speed.name: speed_text(speed) for speed in body.speeds}
    if body.orientation:
        shape["orientation"] = {part.name: part.word for part in body.orientation}
    if body.shapes:
        shape["shapes"] = [look_shape(look) for look in body.shapes]
    return shape


def speed_text(speed: Speed) -> str:
    """``omega[body][1]`` for a component of an angular velocity, ``omega1`` within a longer form."""
    if speed.component is not None:
        return f"omega[{speed.body}][{speed.component}]"
    return text(substitute(speed.form, {name: Name(f"omega{k}") for k, name in enumerate(OMEGA, start=1)}))


def look_shape(look: Look) -> dict[str, Shape]:
    """``{box: [a, b, c], at: ...}``."""
    sizes: list[Shape] = [text(size) for size in look.size]
    shape: dict[str, Shape] = {look.kind: sizes[0] if len(sizes) == 1 else sizes}
    if look.at != _ZERO_VECTOR:
        shape["at"] = vector_shape(look.at)
    if look.rotation.axes:
        shape["rotation"] = rotation_shape(look.rotation)
    return shape


def rotation_shape(rotation: Rotation) -> dict[str, Shape]:
    return {"axes": list(map(str, rotation.axes)), "angles": vector_shape(rotation.angles)}


def body_inertia_shape(inertia: Inertia) -> Shape:
    """The tensor, or ``{tensor: ..., accept: true}``."""
    shape = inertia_shape(inertia)
    return {"tensor": shape, "accept": "true"} if inertia.accepted else shape


def inertia_shape(inertia: Inertia) -> list[Shape]:
    """Three principal moments where the products are zero, else three rows."""
    rows = inertia.tensor
    if all(rows[row][column] == ZERO for row in range(3) for column in range(3) if row != column):
        return [text(rows[index][index]) for index in range(3)]
    return [vector_shape(row) for row in rows]


def inferred_coordinates(system: System) -> list[tuple[str, ...]]:
    """For each body the coordinates that a reader would infer if no body listed its own that it could infer."""
    declared = {"t"} | {parameter.name for parameter in system.parameters}
    declared |= {prescribed.name for prescribed in system.prescribed} | set(system.input_names)
    bare = [
        tuple(dict.fromkeys(name for angle in body.rotation.angles if (name := angle_name(angle)) is not None))
        for body in system.bodies
    ]
    listed = [body.coordinates != names for body, names in zip(system.bodies, bare, strict=True)]
    for body, is_listed in zip(system.bodies, listed, strict=True):
        declared |= set(body.coordinates) if is_listed else set()
    inferred = []
    for names in bare:
        new = tuple(name for name in names if name not in declared)
        declared |= set(new)
        inferred.append(new)
    return inferred


def load_shape(load: Load) -> tuple[str, Shape]:
    """The kind of a load and its data.  Raises TypeError for anything else."""
    return _of_kind(load.written, LOADS)


def constraint_shape(constraint: Constraint) -> tuple[str, Shape]:
    """The kind of a constraint and its data."""
    return _of_kind(as_written(constraint), CONSTRAINTS)


def _of_kind(made: object, kinds: Mapping[str, Kind]) -> tuple[str, Shape]:
    """The way back from what was made of a kind to its keys."""
    for name, kind in kinds.items():
        for way in kind.ways:
            if way.writes(made):
                parts = iter(way.values(made))
                if not way.keys:
                    return name, _of_type(kind.type, _taken(kind.type, parts))
                values = {key: _taken(kind.keys[key].type, parts) for key in way.keys}
                said = {key: value for key, value in values.items() if _says(kind.keys[key], value, values)}
                return name, {key: _of_type(kind.keys[key].type, value) for key, value in said.items()}
    raise TypeError(f"of no known kind: {made!r}")


def _taken(of: Type, parts: Iterator[Any]) -> Any:
    """The value of a key: two ends or sides are two parts."""
    return (next(parts), next(parts)) if isinstance(of, Ends | Equation) else next(parts)


def _says(key: Key, value: Any, values: dict[str, Any]) -> bool:
    """Whether a value has to be written: not where it is nothing, zero, or that of another key all the same."""
    if isinstance(key.default, Same):
        return bool(value != values[key.default.key])
    return key.required or (value is not None and value != ZERO)


def _of_type(of: Type, value: Any) -> Shape:
    match of:
        case Formula():
            return text(value)
        case VectorType():
            return vector_shape(value)
        case Ends(record):
            return [_end(record, end) for end in value]
        case Equation():
            return f"{text(value[0])} = {text(value[1])}"
        case Named(inner):
            return {name: _of_type(inner, named_value) for name, named_value in value}
    return str(value)


def _end(record: Record, end: Point | Axis) -> Shape:
    values = (getattr(end, field.name) for field in fields(end))
    return {name: _of_type(key.type, value) for (name, key), value in zip(record.keys.items(), values, strict=True)}


def motion_shape(entry: MotionEntry) -> Shape:
    if entry.rate == ZERO:
        return text(entry.value)
    return {"value": text(entry.value), "rate": text(entry.rate)}


def initial_shape(entry: InitialValue) -> Shape:
    if entry.velocity is None and entry.position is not None:
        return text(entry.position)
    shape: dict[str, Shape] = {}
    for key, value in (("position", entry.position), ("velocity", entry.velocity)):
        if value is not None:
            shape[key] = text(value)
    return shape


def claim_shape(claim: Claim, system: System) -> dict[str, Shape]:
    """One claim; rows and columns are named by their coordinates."""
    kind = CLAIMS[claim.kind]
    shape: dict[str, Shape] = {"claim": claim.kind}
    if claim.of or claim.of_expression is not None:
        shape["of"] = claim.of if claim.of_expression is None else text(claim.of_expression)
    if claim.entry:
        names = index_names(kind, system)
        indices: list[Shape] = [
            str(k) if kind.axes else counted[k - 1] for k, counted in zip(claim.entry, names, strict=True)
        ]
        shape["component" if kind.entry == 1 else "entry"] = indices[0] if kind.entry == 1 else indices
    if claim.at is not None:
        shape["at"] = text(claim.at)
    if claim.variable:
        shape["variable"] = claim.variable
    if kind.order:
        shape["order"] = str(claim.order)
    if claim.at_initial:
        shape["state"] = INITIAL_STATE
    elif claim.state:
        shape["state"] = {name: text(value) for name, value in claim.state}
    if claim.right is None:
        shape["equals"] = claim.printed or text(claim.equals)
    else:
        shape["that"] = assumption_text(claim.equals, claim.relation, claim.right)
    if claim.tolerance is not None:
        shape["tolerance"] = text(claim.tolerance)
    if claim.digits:
        shape["digits"] = str(claim.digits)
    if claim.role:
        shape["as"] = claim.role
    if claim.place:
        shape["place"] = claim.place
    return shape


def assumption_text(left: Expression, relation: str, right: Expression) -> str:
    return f"{text(left)} {relation} {text(right)}"


# The data in the style in which people write YAML.


_PLAIN = re.compile(r"[A-Za-z0-9(./-][A-Za-z0-9 _.()*/+'<>=!-]*\Z")
_DANGEROUS_STARTS = ("- ", "---", "...")


#: What stands in one line at the head of a file, and in one line further below.
_HEAD = ("name", "description", "source", "label", "language", "order")
_LINES = ("dependent", "reactions", "dimensionless time", "small parameter")


def to_yaml(system: System) -> str:
    """The description of a system; reading it again gives an equal system."""
    lines = [f"mbsym: {VERSION}"]
    for key, value in system_shape(system).items():
        lines += [f"{key}: {_flow(value)}"] if key in _HEAD else ["", *_part(key, value)]
    return "\n".join(lines) + "\n"


def _part(key: str, value: Shape) -> Iterator[str]:
    """The lines of a key with what it holds."""
    if key in _LINES:
        yield f"{key}: {_flow(value)}"
        return
    yield f"{key}:"
    if isinstance(value, dict):
        for name, one in value.items():
            if name in MATRICES and key == "linear system" and isinstance(one, list):  # each matrix with a row a line
                yield from (f"  {name}:", *(f"    - {_flow(row)}" for row in one))
            else:
                yield f"  {name}: {_flow(one)}"
        return
    for number, item in enumerate(value):
        if key == "bodies" and isinstance(item, dict):
            yield from [""] if number else []
            yield from (f"  {' ' if k else '-'} {name}: {_flow(one)}" for k, (name, one) in enumerate(item.items()))
        elif key in ("loads", "constraints") and isinstance(item, dict):
            yield from (f"  - {kind}: {_flow(one)}" for kind, one in item.items())
        else:
            yield f"  - {_flow(item)}"


def _flow(value: Shape) -> str:
    match value:
        case dict():
            return "{" + ", ".join(f"{_key(key)}: {_flow(item)}" for key, item in value.items()) + "}"
        case list():
            return "[" + ", ".join(_flow(item) for item in value) + "]"
    return scalar_text(value)


def _key(key: str) -> str:
    """YAML 1.1 readers take a bare ``on`` for true."""
    return '"on"' if key == "on" else key


def scalar_text(value: str) -> str:
    """Plain where every YAML reader agrees on it, else in double quotes."""
    plain = _PLAIN.match(value) and not value.startswith(_DANGEROUS_STARTS) and value == value.strip()
    if plain and value not in ("-", *NULL):
        return value
    escaped = value.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


# What a description says, as a number: equal for the two spellings, for any order of keys, and for any comments.


def meaning(system: System) -> str:
    """SHA-256, in hexadecimal digits, of the description as ``mbsym convert`` writes it in YAML."""
    from hashlib import sha256  # whoever only checks a description needs none

    return sha256(to_yaml(system).encode()).hexdigest()
