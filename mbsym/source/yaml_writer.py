"""A System as YAML, in the order and the style in which people write it."""

from __future__ import annotations

import hashlib
import re

from mbsym.expressions.tree import text
from mbsym.model.linear import MATRICES, LinearModel
from mbsym.model.system import System
from mbsym.source.keys import VERSION
from mbsym.source.shape import (
    Shape,
    assumption_text,
    body_shape,
    claim_shape,
    constraint_shape,
    inferred_coordinates,
    initial_shape,
    input_shape,
    linear_shape,
    load_shape,
    motion_shapes,
    parameter_shape,
    prescribed_shape,
    small_shape,
    table_shape,
)

_PLAIN = re.compile(r"[A-Za-z0-9(./-][A-Za-z0-9 _.()*/+'<>=!-]*\Z")
_DANGEROUS_STARTS = ("- ", "---", "...")


def to_yaml(system: System) -> str:
    """The description of a system; reading it again gives an equal system."""
    lines = [f"mbsym: {VERSION}", f"name: {scalar_text(system.name)}"]
    if system.description:
        lines.append(f"description: {scalar_text(system.description)}")
    if system.source:
        lines.append(f"source: {scalar_text(system.source)}")
    if system.label:
        lines.append(f"label: {scalar_text(system.label)}")
    if system.language:
        lines.append(f"language: {system.language}")
    if system.order:
        lines.append(f"order: [{', '.join(system.order)}]")
    lines += _mapping("parameters", {parameter.name: parameter_shape(parameter) for parameter in system.parameters})
    lines += _mapping("prescribed", {prescribed.name: prescribed_shape(prescribed) for prescribed in system.prescribed})
    lines += _mapping("inputs", {one.name: input_shape(one) for one in system.inputs})
    lines += _mapping("tables", {table.name: table_shape(table) for table in system.tables})
    lines += _mapping("units", {one.name: one.text for one in system.units.declared})
    lines += _bodies(system) if system.linear is None else _linear(system.linear)
    lines += _list("loads", [_load(*load_shape(load)) for load in system.loads])
    lines += _list("constraints", [_load(*constraint_shape(constraint)) for constraint in system.constraints])
    if system.dependent:
        lines += ["", f"dependent: [{', '.join(system.dependent)}]"]
    if system.reactions:
        lines += ["", f"reactions: {_flow(list(system.reactions))}"]
    lines += _mapping("relations", {relation.name: text(relation.value) for relation in system.relations})
    lines += _mapping("motion", motion_shapes(system))
    lines += _mapping("notation", {notation.name: text(notation.value) for notation in system.notation})
    lines += _mapping("outputs", {output.name: text(output.value) for output in system.outputs})
    assumptions = [assumption_text(one.left, one.relation, one.right) for one in system.assumptions]
    lines += _list("assumptions", [scalar_text(assumption) for assumption in assumptions])
    if system.time_scale is not None:
        lines += ["", f"dimensionless time: {scalar_text(text(system.time_scale))}"]
    if system.small is not None:
        lines += ["", f"small parameter: {_flow(small_shape(system.small))}"]
    lines += _mapping("initial", {value.coordinate: initial_shape(value) for value in (*system.initial, *system.start)})
    lines += _mapping("limits", {limit.coordinate: [text(limit.lower), text(limit.upper)] for limit in system.limits})
    lines += _mapping("latex", {symbol.name: symbol.latex for symbol in system.symbols})
    lines += _mapping("abbreviations", {one.name: text(one.value) for one in system.abbreviations})
    lines += _list("claims", [_flow(claim_shape(claim, system)) for claim in system.claims])
    return "\n".join(lines) + "\n"


def _mapping(title: str, entries: dict[str, Shape]) -> list[str]:
    if not entries:
        return []
    return ["", f"{title}:", *(f"  {key}: {_flow(value)}" for key, value in entries.items())]


def _list(title: str, items: list[str]) -> list[str]:
    return ["", f"{title}:", *(f"  - {item}" for item in items)] if items else []


def _linear(linear: LinearModel) -> list[str]:
    """Each matrix with a row a line."""
    lines = ["", "linear system:"]
    for key, value in linear_shape(linear).items():
        if key in MATRICES and isinstance(value, list):
            lines += [f"  {key}:", *(f"    - {_flow(row)}" for row in value)]
        else:
            lines.append(f"  {key}: {_flow(value)}")
    return lines


def _bodies(system: System) -> list[str]:
    lines = ["", "bodies:"]
    for number, (body, inferred) in enumerate(zip(system.bodies, inferred_coordinates(system), strict=True)):
        if number:
            lines.append("")
        for index, (key, value) in enumerate(body_shape(body, inferred).items()):
            lines.append(f"  {' ' if index else '-'} {key}: {_flow(value)}")
    return lines


def _load(kind: str, value: Shape) -> str:
    return f"{kind}: {_flow(value)}"


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
    if _PLAIN.match(value) and not value.startswith(_DANGEROUS_STARTS) and value == value.strip() and value != "-":
        return value
    escaped = value.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


# What a description says, as a number: equal for the two spellings, for any order of keys, and for any comments.


def meaning(system: System) -> str:
    """SHA-256, in hexadecimal digits, of the description as ``mbsym convert`` writes it in YAML."""
    return hashlib.sha256(to_yaml(system).encode()).hexdigest()
