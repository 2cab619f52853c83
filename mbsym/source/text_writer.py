"""A System as the plain text of the description editor, with the labels of the paper's Figure 3."""

from __future__ import annotations

from collections.abc import Mapping

from mbsym.expressions.tree import ZERO, text
from mbsym.model.system import Body, Shape, System, Vector
from mbsym.source.labels import SECTIONS
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
    small_shape,
    speed_text,
    table_shape,
)
from mbsym.source.text_data import BLOCKS, block, entry, free, names_keys, small, title_shown

_ROWS = (0, 1, 2)


def to_text(system: System) -> str:
    """The description of a system as editor text; reading it again gives an equal system."""
    lines = [f"Mechanical system: {free(system.name)}"]
    if system.description:
        lines.append(f"Description: {free(system.description)}")
    if system.source:
        lines.append(f"Source: {free(system.source)}")
    if system.label:
        lines.append(f"Label: {free(system.label)}")
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
        lines.append(f"Small parameter: {small(small_shape(system.small))}")
    lines += _section("parameters", {parameter.name: parameter_shape(parameter) for parameter in system.parameters})
    lines += _section("prescribed", {prescribed.name: prescribed_shape(prescribed) for prescribed in system.prescribed})
    lines += _section("inputs", {one.name: input_shape(one) for one in system.inputs})
    lines += _section("tables", {table.name: table_shape(table) for table in system.tables})
    lines += _section("units", {one.name: one.text for one in system.units.declared})
    numbers = {body.name: str(number) for number, body in enumerate(system.bodies, start=1)}
    for number, body in enumerate(system.bodies, start=1):
        lines += ["", f"Body description ({number})", *_body(body, numbers)]
    if system.linear is not None:
        lines += _section("linear system", linear_shape(system.linear))
    lines += _blocks("loads", [dict([load_shape(load)]) for load in system.loads], numbers)
    lines += _blocks("constraints", [dict([constraint_shape(one)]) for one in system.constraints], numbers)
    lines += _section("relations", {relation.name: text(relation.value) for relation in system.relations})
    lines += _section("motion", motion_shapes(system))
    lines += _section("notation", {notation.name: text(notation.value) for notation in system.notation})
    lines += _section("outputs", {output.name: text(output.value) for output in system.outputs})
    if system.assumptions:
        compared = [assumption_text(one.left, one.relation, one.right) for one in system.assumptions]
        lines += ["", "Assumptions", *(f"  {one}" for one in compared)]
    lines += _section("initial", {value.coordinate: initial_shape(value) for value in (*system.initial, *system.start)})
    lines += _section("limits", {limit.coordinate: [text(limit.lower), text(limit.upper)] for limit in system.limits})
    lines += _section("latex", {symbol.name: symbol.latex for symbol in system.symbols})
    lines += _section("abbreviations", {one.name: text(one.value) for one in system.abbreviations})
    lines += _blocks("claims", [claim_shape(claim, system) for claim in system.claims], numbers)
    return "\n".join(lines) + "\n"


def _section(key: str, shapes: Mapping[str, Data]) -> list[str]:
    """The lines ``name = value`` below the title of a section; a record that says one thing stands without its key."""
    if not shapes:
        return []
    title, first = next((title, first) for title, (one, first) in SECTIONS.items() if one == key)
    lines = ["", title_shown(title)]
    for name, shape in shapes.items():
        alone = isinstance(shape, dict) and list(shape) == [first]
        value = shape[first] if alone and isinstance(shape, dict) and first is not None else shape
        lines.append(f"  {name} = {entry(key, value, first)}")
    return lines


def _blocks(section: str, shapes: list[Data], numbers: dict[str, str]) -> list[str]:
    """Loads, constraints, claims."""
    lines = []
    for number, shape in enumerate(shapes, start=1):
        lines += ["", f"{BLOCKS[section]} description ({number})"]
        between = " =" if isinstance(shape, dict) and names_keys(next(iter(shape))) else ":"
        for place, (label, value) in enumerate(block(section, shape, numbers)):
            lines.append(f"  {label}{between} {value}" if place else f"  {label.capitalize()}: {value}")
    return lines


def _body(body: Body, numbers: dict[str, str]) -> list[str]:
    """All labels of Figure 3, zeros included, as the editor shows them."""
    axes = [str(axis) for axis in body.rotation.axes]
    angles = [text(angle) for angle in body.rotation.angles]
    unused = ["0"] * (3 - len(axes))
    lines = [
        f"  Name: {body.name}",
        f"  Previous body number: {numbers.get(body.attached_to, body.attached_to)}",
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
        lines.append("  Speeds: " + "; ".join(f"{speed.name} = {speed_text(speed)}" for speed in body.speeds))
    if body.orientation:
        lines.append("  Orientation: " + "; ".join(f"{one.name} = {one.word}" for one in body.orientation))
    return [*lines, *(f"  Shape: {_look(shape)}" for shape in body.shapes)]


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
