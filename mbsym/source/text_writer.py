"""A System as the plain text of the description editor, with the labels of the paper's Figure 3."""

from __future__ import annotations

from mbsym.expressions.tree import ZERO, text
from mbsym.model.claims import BODY, CLAIMS
from mbsym.model.small import SmallParameter
from mbsym.model.system import Body, Shape, System, Vector
from mbsym.source.grammar import BodyName, Ends, Kind, Named
from mbsym.source.keys import CONSTRAINTS, LOADS
from mbsym.source.shape import Shape as Data
from mbsym.source.shape import (
    assumption_text,
    claim_shape,
    constraint_shape,
    initial_shape,
    input_shape,
    linear_shape,
    load_shape,
    motion_shapes,
    parameter_shape,
    prescribed_shape,
    speed_text,
    table_shape,
)

_ROWS = (0, 1, 2)


def to_text(system: System) -> str:
    """The description of a system as editor text; reading it again gives an equal system."""
    lines = [f"Mechanical system: {_free(system.name)}"]
    if system.description:
        lines.append(f"Description: {_free(system.description)}")
    if system.source:
        lines.append(f"Source: {_free(system.source)}")
    if system.language:
        lines.append(f"Language: {system.language}")
    if system.order:
        lines.append(f"Order: {_braces(list(system.order))}")
    if system.dependent:
        lines.append(f"Dependent: {_braces(list(system.dependent))}")
    if system.reactions:
        places = {body.name: str(number) for number, body in enumerate(system.bodies, start=1)}
        lines.append(f"Reactions: {_braces([places[name] for name in system.reactions])}")
    lines.append(f"Number of bodies: {len(system.bodies)}")
    if system.time_scale is not None:
        lines.append(f"Dimensionless time: {text(system.time_scale)}")
    if system.small is not None:
        lines.append(f"Small parameter: {_small(system.small)}")
    lines += _section("Parameters", {one.name: _record(parameter_shape(one), "sign") for one in system.parameters})
    motions = {one.name: _record(prescribed_shape(one), "rate") for one in system.prescribed}
    lines += _section("Prescribed motions", motions)
    lines += _section("Inputs", {one.name: _record(input_shape(one), "meaning") for one in system.inputs})
    lines += _section("Tables", {one.name: _table(table_shape(one)) for one in system.tables})
    lines += _section("Units", {one.name: one.text for one in system.units.declared})
    numbers = {"0": "0", **{body.name: str(number) for number, body in enumerate(system.bodies, start=1)}}
    for number, body in enumerate(system.bodies, start=1):
        lines += ["", f"Body description ({number})", *_body(body, numbers)]
    if system.linear is not None:
        given = {name: _matrix(shape) for name, shape in linear_shape(system.linear).items()}
        lines += _section("Linear system", given)
    for number, load in enumerate(system.loads, start=1):
        name, shape = load_shape(load)
        lines += ["", f"Load description ({number})", *_of_kind("load", LOADS[name], name, shape, numbers)]
    for number, constraint in enumerate(system.constraints, start=1):
        name, shape = constraint_shape(constraint)
        written = _of_kind("constraint", CONSTRAINTS[name], name, shape, numbers)
        lines += ["", f"Constraint description ({number})", *written]
    lines += _section("Relations", {one.name: text(one.value) for one in system.relations})
    motion = {name: _record(shape, "value") for name, shape in motion_shapes(system).items()}
    lines += _section("Unperturbed motion", motion)
    lines += _section("Notation", {one.name: text(one.value) for one in system.notation})
    lines += _section("Outputs", {one.name: text(one.value) for one in system.outputs})
    if system.assumptions:
        compared = [assumption_text(one.left, one.relation, one.right) for one in system.assumptions]
        lines += ["", "Assumptions", *(f"  {one}" for one in compared)]
    initial = {one.coordinate: _record(initial_shape(one), "position") for one in (*system.initial, *system.start)}
    lines += _section("Initial state", initial)
    limits = {one.coordinate: f"({text(one.lower)}, {text(one.upper)})" for one in system.limits}
    lines += _section("Limits", limits)
    lines += _section("LaTeX symbols", {one.name: one.latex for one in system.symbols})
    lines += _section("Abbreviations", {one.name: text(one.value) for one in system.abbreviations})
    for number, claim in enumerate(system.claims, start=1):
        lines += ["", f"Claim description ({number})", *_claim(claim_shape(claim, system), numbers)]
    return "\n".join(lines) + "\n"


def _small(small: SmallParameter) -> str:
    """``eps``, or ``eps; powers = (e, 1, p2, -1); fast = (x, y)``."""
    parts = [small.name]
    if small.powers:
        parts.append(f"powers = ({', '.join(f'{name}, {power}' for name, power in small.powers)})")
    parts += [f"{key} = ({', '.join(names)})" for key, names in (("fast", small.fast), ("slow", small.slow)) if names]
    parts += [f"leading = {small.leading}"] if small.leading else []
    return "; ".join(parts)


def _section(title: str, entries: dict[str, str]) -> list[str]:
    return ["", title, *(f"  {name} = {value}" for name, value in entries.items())] if entries else []


def _record(shape: Data, first: str) -> str:
    """``positive; value = 2; meaning = length``: the first value stands without its key."""
    if not isinstance(shape, dict):
        return str(shape)
    parts = []
    for index, (key, value) in enumerate(shape.items()):
        written = _free(str(value)) if key == "meaning" else str(value)
        parts.append(written if index == 0 and key == first else f"{key} = {written}")
    return "; ".join(parts)


def _table(shape: dict[str, Data]) -> str:
    """``((0, 0), (1, 2.5)); between = cubic``, or ``file = wind.csv; columns = (1, 3)``."""
    if "points" not in shape:
        return _record({key: _value(value) for key, value in shape.items()}, "points")
    points = shape["points"]
    assert isinstance(points, list)
    return _record({**shape, "points": f"({', '.join(_value(point) for point in points)})"}, "points")


def _matrix(shape: Data) -> str:
    """``((a, b), (c, d))``, or ``file = K.mtx; sha256 = ...``; of coordinates ``(x, y)``."""
    if isinstance(shape, list):
        return f"({', '.join(_value(row) for row in shape)})"
    return _record(shape, "")


def _free(value: str) -> str:
    """Text for people: in double quotes where it could be taken for something else."""
    if value and value == value.strip() and not any(mark in value for mark in ';"#\\'):
        return value
    escaped = value.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _body(body: Body, numbers: dict[str, str]) -> list[str]:
    """All labels of Figure 3, zeros included, as the editor shows them."""
    axes = [str(axis) for axis in body.rotation.axes]
    angles = [text(angle) for angle in body.rotation.angles]
    unused = ["0"] * (3 - len(axes))
    lines = [
        f"  Name: {body.name}",
        f"  Previous body number: {numbers[body.attached_to]}",
        f"  Body mass: {text(body.mass)}",
        f"  Radius vector of connection point: {_vector(body.connection_point)}",
        f"  Radius vector of mass center: {_vector(body.mass_centre)}",
    ]
    if body.relative_velocity is not None:
        lines.append(f"  Vector of relative linear velocity: {_vector(body.relative_velocity)}")
    lines += [
        f"  Numbers of rotation axes: {_braces(axes + unused)}",
        f"  Rotation angles: {_braces(angles + unused)}",
    ]
    if body.inertia is not None:
        lines.append(f"  Inertia about: {body.inertia.about}")
    rows = body.inertia.tensor if body.inertia is not None else ((ZERO,) * 3,) * 3
    lines.append("  Tensor of inertia:")
    lines += [f"    {text(rows[row][0])}, {text(rows[row][1])}, {text(rows[row][2])}" for row in _ROWS]
    if body.inertia is not None and body.inertia.accepted:
        lines.append("  Accept tensor of inertia: true")
    if body.gyrostatic_moment is not None:
        lines.append(f"  Gyrostatic moment: {_vector(body.gyrostatic_moment)}")
    lines.append(f"  Generalized coordinates: {_braces(list(body.coordinates))}")
    if body.speeds:
        lines.append("  Speeds: " + "; ".join(f"{one.name} = {speed_text(one)}" for one in body.speeds))
    if body.orientation:
        lines.append("  Orientation: " + "; ".join(f"{one.name} = {one.word}" for one in body.orientation))
    return [*lines, *(f"  Shape: {_look(one)}" for one in body.shapes)]


def _look(look: Shape) -> str:
    """``box = (a, b, c); at = (x, y, z); axes = {3}; angles = {pi/2}``."""
    sizes = [text(size) for size in look.size]
    parts = [f"{look.kind} = {sizes[0] if len(sizes) == 1 else '(' + ', '.join(sizes) + ')'}"]
    if look.at != (ZERO,) * 3:
        parts.append(f"at = {_vector(look.at)}")
    if look.rotation.axes:
        parts.append(f"axes = {_braces([str(axis) for axis in look.rotation.axes])}")
        parts.append(f"angles = {_braces([text(angle) for angle in look.rotation.angles])}")
    return "; ".join(parts)


def _vector(vector: Vector) -> str:
    return "(" + ", ".join(text(component) for component in vector) + ")"


def _braces(items: list[str]) -> str:
    return "{" + ", ".join(items) + "}"


def _of_kind(what: str, kind: Kind, name: str, shape: Data, numbers: dict[str, str]) -> list[str]:
    lines = [f"  Type of {what}: {name}"]
    if isinstance(kind.type, Ends):
        return [*lines, *_ends(shape, numbers)]
    if not isinstance(shape, dict):
        return [*lines, f"  Expression: {shape}"]
    for key, value in shape.items():
        if isinstance(kind.type, Named):
            lines.append(f"  {key} = {value}")
        elif isinstance(kind.keys[key].type, Ends):
            lines += _ends(value, numbers)
        else:
            numbered = isinstance(kind.keys[key].type, BodyName)
            lines.append(f"  {key.capitalize()}: {numbers[str(value)] if numbered else _value(value)}")
    return lines


def _claim(shape: dict[str, Data], numbers: dict[str, str]) -> list[str]:
    """One label a line; a body is named by its number, a state is a record."""
    lines = []
    about_body = CLAIMS[str(shape["claim"])].of == BODY
    for key, value in shape.items():
        if isinstance(value, dict):
            written = "; ".join(f"{name} = {number}" for name, number in value.items())
        elif key == "of" and about_body:
            written = numbers[str(value)]
        else:
            written = _free(str(value)) if key == "place" else _value(value)
        lines.append(f"  {key.capitalize()}: {written}")
    return lines


def _ends(ends: Data, numbers: dict[str, str]) -> list[str]:
    assert isinstance(ends, list)
    lines = []
    for which, end in zip(("First", "Second"), ends, strict=True):
        assert isinstance(end, dict)
        for key, value in end.items():
            lines.append(f"  {which} {key}: {numbers[str(value)] if key == 'body' else _value(value)}")
    return lines


def _value(value: Data) -> str:
    return f"({', '.join(str(item) for item in value)})" if isinstance(value, list) else str(value)
