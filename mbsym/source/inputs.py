"""Inputs and outputs: names that forces hold and whose values are chosen later, and what is measured."""

from __future__ import annotations

from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.tree import Expression
from mbsym.model.inputs import Input, Output
from mbsym.model.system import MotionEntry
from mbsym.source.constants import note_unit
from mbsym.source.keys import INPUT
from mbsym.source.placed import Entry, Node, Scalar, Sequence
from mbsym.source.reading import Reading
from mbsym.source.scope import Allowed

#: A system has at most so many inputs, and so many outputs: each is a column of B, or a row of C.
MAX_INPUTS = 200

OUTPUT = Allowed("an output", ("coordinate", "velocity", "prescribed", "parameter", "input"))


def read_inputs(node: Node | None, reading: Reading) -> tuple[Input, ...]:
    """``u1: {meaning: torque of the wheel, unit: N*m}`` or ``u1: torque of the wheel``, or a list of names."""
    if node is None:
        return ()
    if isinstance(node, Sequence):
        found = [one for item in reading.items(node, "'inputs'") if (one := _listed(item, reading)) is not None]
    else:
        found = [one for entry in reading.entries(node, "'inputs'") if (one := _input(entry, reading)) is not None]
    _bound(len(found), "inputs", node, reading)
    return tuple(found)


def _listed(item: Node, reading: Reading) -> Input | None:
    scalar = reading.scalar(item, "an input")
    if scalar is None or not reading.scope.declare(scalar.text, "input", scalar.span):
        return None
    return Input(scalar.text, span=scalar.span)


def _input(entry: Entry, reading: Reading) -> Input | None:
    name, meaning = entry.key.text, ""
    declared = reading.scope.declare(name, "input", entry.key.span)
    if isinstance(entry.value, Scalar):
        if entry.value.text.strip():
            meaning = reading.free_text(entry.value, f"the meaning of the input {ascii_safe(name)}")
    else:
        fields = reading.fields(entry.value, f"the input {ascii_safe(name)}", INPUT)
        note_unit(name, fields, reading)
        meaning = fields.text("meaning")
    return Input(name, meaning, span=entry.key.span) if declared else None


def read_outputs(node: Node | None, reading: Reading) -> tuple[Output, ...]:
    """``y1: theta``: expressions in coordinates, velocities, parameters, prescribed motions and inputs."""
    found = []
    for entry in () if node is None else reading.entries(node, "'outputs'"):
        errors = reading.errors
        value = reading.expression(entry.value, OUTPUT)
        declared = reading.scope.declare(entry.key.text, "output", entry.key.span)
        if declared and reading.errors == errors:
            found.append(Output(entry.key.text, value, entry.key.span))
    if node is not None:
        _bound(len(found), "outputs", node, reading)
    return tuple(found)


def _bound(count: int, what: str, node: Node, reading: Reading) -> None:
    if count > MAX_INPUTS:
        reading.error("too-large", f"a system has at most {MAX_INPUTS} {what}, not {count}", node.span)


def held_values(motion: tuple[MotionEntry, ...], reading: Reading) -> dict[str, Expression]:
    """What ``motion`` says of inputs; complains about one that is to change there."""
    return {entry.coordinate: entry.value for entry in motion if reading.scope.kinds.get(entry.coordinate) == "input"}
