"""What bodies look like: boxes, balls, rods.  Drawn, and otherwise without consequence."""

from __future__ import annotations

from mbsym.expressions.message import Message, worded
from mbsym.expressions.tree import Expression
from mbsym.model.system import SHAPES, Rotation, Shape
from mbsym.source.keys import ROTATION, SHAPE
from mbsym.source.placed import Node, Sequence
from mbsym.source.reading import ZERO_VECTOR, Fields, Reading
from mbsym.source.scope import Allowed

_SIZE = Allowed("the size of a shape")
_PLACE = Allowed("the place of a shape")
_ANGLE = Allowed("the angle of a shape")


def read_shapes(node: Node | None, what: str, reading: Reading) -> tuple[Shape, ...]:
    """The shapes of a body, each a mapping with one kind."""
    if node is None:
        return ()
    items = reading.items(node, "'shapes'")
    found = (
        _shape(reading.fields(item, Message("a shape of [[what]]", what=worded(what)), SHAPE), reading)
        for item in items
    )
    return tuple(shape for shape in found if shape is not None)


def _shape(fields: Fields, reading: Reading) -> Shape | None:
    kinds = [kind for kind in SHAPES if fields.get(kind) is not None]
    if len(kinds) != 1:
        if fields.sound:
            message = Message("[[what]] has two kinds" if kinds else "[[what]] has no kind", what=worded(fields.what))
            reading.error("wrong-shape", message, fields.span, Message("one of [[shapes]]", shapes=", ".join(SHAPES)))
        return None
    (kind,) = kinds
    node = fields.get(kind)
    assert node is not None
    at = fields.get("at")
    place = ZERO_VECTOR if at is None else reading.vector(at, _PLACE)
    return Shape(kind, _sizes(kind, node, reading), place, _rotation(fields.get("rotation"), reading))


def _sizes(kind: str, node: Node, reading: Reading) -> tuple[Expression, ...]:
    count = SHAPES[kind]
    items = node.items if isinstance(node, Sequence) else (node,)
    if len(items) != count:
        text = (
            "a [[kind]] has [[count]] sizes, not [[items]]"
            if count > 1
            else "a [[kind]] has [[count]] size, not [[items]]"
        )
        message = Message(text, kind=kind, count=count, items=len(items))
        reading.error("wrong-shape", message, node.span, SHAPE[kind].meaning)
        return ()
    return tuple(reading.expression(item, _SIZE) for item in items)


def _rotation(node: Node | None, reading: Reading) -> Rotation:
    """Turns by constant angles."""
    if node is None:
        return Rotation()
    fields = reading.fields(node, "the rotation of a shape", ROTATION)
    axes_node, angles_node = fields.require("axes"), fields.require("angles")
    if axes_node is None or angles_node is None:
        return Rotation()
    words = [reading.word(item, "a rotation axis", ("0", "1", "2", "3")) for item in reading.items(axes_node, "'axes'")]
    angles = [reading.expression(item, _ANGLE) for item in reading.items(angles_node, "'angles'")]
    if len(words) != len(angles):
        reading.error("wrong-shape", "axes and angles belong together: as many of each", angles_node.span)
        return Rotation()
    turns = [(int(word), angle) for word, angle in zip(words, angles, strict=True) if word not in (None, "0")]
    return Rotation(tuple(axis for axis, _ in turns), tuple(angle for _, angle in turns))
