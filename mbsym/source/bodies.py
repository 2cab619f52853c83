"""Bodies: names and attachments, rotations, vectors, mass, inertia, coordinates."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from fractions import Fraction

from mbsym.expressions.angles import angle_name
from mbsym.expressions.message import Message, worded
from mbsym.expressions.parser import ascii_safe, parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.tree import CONSTANTS, ZERO, Expression, Name, is_number, subtract, walk
from mbsym.model.admissibility import ROUNDING
from mbsym.model.speeds import Quaternion, UnitVector
from mbsym.model.system import INERTIAL, SHAPES, Body, Inertia, Rotation, Shape, Tensor, Vector, rational
from mbsym.source.identity import vanishes
from mbsym.source.keys import BODY, INERTIA, MASS_CENTRE, ROTATION, SHAPE
from mbsym.source.placed import Mapping, Node, Scalar, Sequence, TooManyComplaints
from mbsym.source.reading import ZERO_VECTOR, Fields, Reading, comma_hint
from mbsym.source.scope import ANGLE, RADIUS, VELOCITY, Allowed, closest, did_you_mean, listed, slip_of, why_no_name

MAX_BODIES = 250
MAX_COORDINATES = 6
MAX_BODY_NAME = 80

#: To 40 digits, enough for any decimal that somebody writes.
_PI = Fraction(31415926535897932384626433832795028841972, 10**40)

_BODY_NAME = re.compile(r"[^\W\d_][\w ./-]*\Z")


@dataclass(slots=True)
class Draft:
    """A body whose name and coordinates are known and whose expressions are still to be read."""

    number: int
    name: str
    name_span: Span
    fields: Fields
    coordinates: list[Scalar]
    whole: bool = True  # False: a coordinate was forgotten, or its list cannot be read
    speeds: list[tuple[Scalar, Node]] = field(default_factory=list)
    orientation: tuple[UnitVector | Quaternion, ...] = ()


def draft_bodies(node: Node | None, reading: Reading) -> list[Draft]:
    """The first pass: names of bodies and coordinates, so that expressions may refer to any of them.

    Raises TooManyComplaints where there are more than MAX_BODIES.
    """
    if node is None:
        return []
    items = reading.items(node, "'bodies'")
    if len(items) > MAX_BODIES:
        message = Message("a system has at most [[most]] bodies, not [[items]]", most=MAX_BODIES, items=len(items))
        reading.error("too-large", message, node.span)
        raise TooManyComplaints  # without them every name would be unknown
    if not items and isinstance(node, Sequence):
        reading.error("no-bodies", "there are no bodies", node.span, "each has a name and a mass")
    drafts = [_draft(number, item, reading) for number, item in enumerate(items, start=1)]
    _check_repeated(drafts, reading)
    for draft in drafts:
        _declare_listed(draft, reading)
    slips: set[str] = set()
    for draft in drafts:
        _declare_inferred(draft, slips, reading)
    constant = _constant(drafts) if reading.scope.by_use is not None else set()
    for draft in drafts:
        _assume_forgotten(draft, constant, reading)
    return drafts


def _draft(number: int, node: Node, reading: Reading) -> Draft:
    fields = reading.fields(node, Message("body [[number]]", number=number), BODY)
    name_node = fields.require("name")
    scalar = None if name_node is None else reading.scalar(name_node, "the name of a body")
    if scalar is None:
        return Draft(number, f"body {number}", node.span, fields, [])
    name = " ".join(scalar.text.split())
    if not is_body_name(name):
        hint = "letters, digits, blanks and . / _ -, beginning with a letter"
        reading.error("bad-name", Message("a body cannot be called [[name]]", name=ascii_safe(name)), scalar.span, hint)
        name = name if name != INERTIAL else f"body {number}"  # what is attached to 0 is attached to the ground
    fields.what = Message("body [[name]]", name=ascii_safe(name))
    return Draft(number, name, scalar.span, fields, [])


def is_body_name(name: str) -> bool:
    """Whether a body may be called so."""
    return _BODY_NAME.match(name) is not None and len(name) <= MAX_BODY_NAME


def _check_repeated(drafts: list[Draft], reading: Reading) -> None:
    seen: set[str] = set()
    for draft in drafts:
        if draft.name in seen:
            reading.error(
                "repeated-name",
                Message("a second body called [[name]]", name=ascii_safe(draft.name)),
                draft.name_span,
                Message("each body has a name of its own: write [[name]] 2", name=draft.name),
            )
        seen.add(draft.name)


def _declare_listed(draft: Draft, reading: Reading) -> None:
    node = draft.fields.get("coordinates")
    if node is None:
        return
    items = reading.lone_or_items(node, "'coordinates'")
    if len(items) > MAX_COORDINATES:
        reading.error("too-large", "a joint introduces at most [[most]] coordinates", node.span, most=MAX_COORDINATES)
        return
    for item in items:
        scalar = reading.scalar(item, "a coordinate")
        if scalar is not None and reading.scope.declare(scalar.text, "coordinate", scalar.span):
            draft.coordinates.append(scalar)


def _declare_inferred(draft: Draft, slips: set[str], reading: Reading) -> None:
    """Without a list, the undeclared names that stand alone as angles are the coordinates of the joint.

    ``slips`` collects those that resemble other names too much.
    """
    if draft.fields.get("coordinates") is not None:
        return
    for item in _angles(draft)[:MAX_COORDINATES]:
        name = _bare_name(item)
        if name is not None and name not in reading.scope.kinds and why_no_name(name) is None:
            slip = slip_of(name, [kind for kind in reading.scope.kinds if kind not in slips])
            if slip is not None:
                slips.add(name)
                message = Message("the undeclared angle '[[name]]' becomes a coordinate of its own", name=name)
                hint = Message(
                    "did you mean '[[other]]'? If not, add '[[coordinates]]' to this body",
                    other=slip,
                    coordinates=_listed_coordinates(name, draft),
                )
                reading.complaints.warning("resembling-name", message, item.span, hint)
            reading.scope.declare(name, "coordinate", item.span)
            draft.coordinates.append(Scalar(name, item.span, literal=False))


def _angles(draft: Draft) -> tuple[Node, ...]:
    """The angles of a joint as they stand in the file, misspelt keys and single values included."""
    rotation = draft.fields.get("rotation")
    for entry in rotation.entries if isinstance(rotation, Mapping) else ():
        if closest(entry.key.text, ROTATION) == "angles":
            return entry.value.items if isinstance(entry.value, Sequence) else (entry.value,)
    return ()


def _constant(drafts: list[Draft]) -> set[str]:
    """The names in masses, mass centres and inertias, where no coordinate may stand."""
    nodes = [draft.fields.get(key) for draft in drafts for key in ("mass", "mass centre", "inertia")]
    return {symbol.name for node in nodes for symbol in _names(node)}


def _names(node: Node | None) -> Iterator[Name]:
    """The names in a formula, or in all those of a list."""
    for item in node.items if isinstance(node, Sequence) else ():
        yield from _names(item)
    tree = parse_expression(node.text, Complaints(), node.place) if isinstance(node, Scalar) else None
    for symbol in walk(tree) if tree is not None else ():
        if isinstance(symbol, Name):
            yield symbol


def _assume_forgotten(draft: Draft, constant: Collection[str], reading: Reading) -> None:
    """Undeclared names that place a body are most likely coordinates that nobody listed: said once, then read so.

    Not those that are ``constant``.
    """
    listed, scope = draft.fields.get("coordinates"), reading.scope
    if scope.by_use is not None and isinstance(listed, Sequence):
        return  # what is not in the list is a parameter by its use
    point = draft.fields.get("connection point")
    for node in (*_angles(draft), *(point.items if isinstance(point, Sequence) else ())):
        for symbol in _names(node):
            if symbol.name in (*CONSTANTS, *scope.assumed, *constant) or why_no_name(symbol.name):
                continue
            close = did_you_mean(symbol.name, scope.of_kind(*RADIUS.kinds))
            if scope.kind_of(symbol.name) is not None or (close and isinstance(listed, Sequence)):
                continue
            if listed is None or isinstance(listed, (Scalar, Sequence)):
                reading.error(
                    "unknown-name",
                    Message("unknown name '[[name]]'", name=symbol.name),
                    symbol.span,
                    _coordinate_hint(symbol, draft, close),
                )
            scope.assumed.add(symbol.name)
            draft.coordinates.append(Scalar(symbol.name, symbol.span or node.span, literal=False))
            draft.whole = False


def _coordinate_hint(name: Name, draft: Draft, close: str | None) -> str:
    together = ", ".join([*(scalar.text for scalar in draft.coordinates), name.name])
    is_there = draft.fields.get("coordinates") is not None
    text = "write '[[coordinates]]' in this body" if is_there else "add '[[coordinates]]' to this body"
    way = Message(text, coordinates=_listed_coordinates(together, draft))
    if close:
        return Message("[[other]] If it is a coordinate of its own, [[listed]]", other=close, listed=way)
    return Message("if it is a coordinate, [[listed]]; if it is a parameter, declare it under 'parameters'", listed=way)


def _listed_coordinates(names: str, draft: Draft) -> str:
    return f"Generalized coordinates: {names}" if draft.fields.reading.labelled else f"coordinates: [{names}]"


def _bare_name(node: Node) -> str | None:
    tree = parse_expression(node.text, Complaints(), node.place) if isinstance(node, Scalar) else None
    return angle_name(tree)


def read_body(draft: Draft, drafts: list[Draft], reading: Reading) -> Body:
    """The second pass: everything about one body."""
    fields = draft.fields
    mass = fields.required_expression(
        "mass", Allowed("a mass"), "write mass: m with the mass for m, or mass: 0 for a massless frame"
    )
    return Body(
        name=draft.name,
        attached_to=_attached_to(draft, drafts, reading),
        rotation=_rotation(fields.get("rotation"), draft, reading),
        connection_point=_vector(fields, "connection point", RADIUS) or ZERO_VECTOR,
        relative_velocity=_vector(fields, "relative velocity", VELOCITY),
        mass_centre=_vector(fields, "mass centre", Allowed("a mass centre")) or ZERO_VECTOR,
        mass=mass,
        inertia=_inertia(fields, reading),
        coordinates=tuple(scalar.text for scalar in draft.coordinates),
        gyrostatic_moment=_gyrostatic_moment(fields),
        shapes=read_shapes(fields.get("shapes"), fields.what, reading),
        span=draft.name_span,
    )


def _vector(fields: Fields, key: str, allowed: Allowed) -> Vector | None:
    node = fields.get(key)
    return None if node is None else fields.reading.vector(node, allowed)


def _gyrostatic_moment(fields: Fields) -> Vector | None:
    """Constants only; three zeros are no moment at all."""
    moment = _vector(fields, "gyrostatic moment", Allowed("a gyrostatic moment"))
    return None if moment is None or all(is_number(component, 0) for component in moment) else moment


def _attached_to(draft: Draft, drafts: list[Draft], reading: Reading) -> str:
    """The name of an earlier body, or the inertial frame; only the first body may leave it unsaid."""
    node = draft.fields.get("attached to")
    if node is None:
        if draft.number > 1:
            draft.fields.require("attached to", "an earlier body, or 0 for the inertial frame")
        return INERTIAL
    earlier = list(dict.fromkeys(other.name for other in drafts[: draft.number - 1]))
    name = read_body_name(node, "'attached to'", [other.name for other in drafts], reading, earlier)
    later = {other.name for other in drafts[draft.number - 1 :]} - {*earlier}
    if name is None or name not in later:
        return name or INERTIAL
    assert isinstance(node, Scalar)
    _complain_of_order(draft, name, drafts, node.span, reading)
    return INERTIAL


def _complain_of_order(draft: Draft, name: str, drafts: list[Draft], span: Span, reading: Reading) -> None:
    parents = {other.name: other.fields.get("attached to") for other in drafts}
    chain = [draft.name]
    while name in parents and name not in chain:
        chain.append(name)
        parent = parents[name]
        name = parent.text if isinstance(parent, Scalar) else INERTIAL
    if name == draft.name:
        circle = " -> ".join([*chain[:6], draft.name])
        message = Message("bodies are attached in a circle: [[bodies]]", bodies=circle)
        reading.error("cyclic-bodies", message, span, "one of them hangs on the inertial frame 0")
    else:
        hint = Message(
            "put body [[chain]] before [[name]]",
            chain=ascii_safe(chain[-1] if len(chain) < 2 else chain[1]),
            name=ascii_safe(draft.name),
        )
        reading.error("body-order", "a body is attached to an earlier body; this one comes later", span, hint)


#: What the inertial frame is called elsewhere.
GROUNDS = {"ground", "world", "base", "earth", "floor", "fixed", "inertial", "inertial frame", "origin", "none"}


def read_body_name(
    node: Node, what: str, known: list[str], reading: Reading, possible: list[str] | None = None
) -> str | None:
    """The name of a known body, or "0"; a hint names the ``possible`` ones (by default all that are known)."""
    scalar = reading.scalar(node, what)
    if scalar is None:
        return None
    name = " ".join(scalar.text.split())
    if name == INERTIAL or name in known:
        return name
    named = known if possible is None else possible
    which = "the bodies are" if possible is None else "the bodies before this one are"
    elsewhere = name.lower() in GROUNDS
    hint = did_you_mean(name, named) or listed(which, [INERTIAL, *named[:8]])
    hint = Message("the inertial frame is called 0") if elsewhere else hint
    reading.error("unknown-body", Message("there is no body [[name]]", name=ascii_safe(name)), scalar.span, hint)
    return INERTIAL if elsewhere else None


def _rotation(node: Node | None, draft: Draft, reading: Reading) -> Rotation:
    """The turns that there are: axes numbered 0 are dropped, so that {3, 0, 0} and {3} are the same rotation."""
    if node is None:
        return Rotation()
    fields = reading.fields(node, Message("the rotation of [[what]]", what=worded(draft.fields.what)), ROTATION)
    axes_node, angles_node = fields.require("axes"), fields.require("angles")
    if axes_node is None or angles_node is None:
        return Rotation()
    errors = reading.errors
    axis_items, angle_items = reading.lone_or_items(axes_node, "'axes'"), reading.lone_or_items(angles_node, "'angles'")
    listed = reading.errors == errors
    axes = [_axis(item, reading) for item in axis_items]
    angles = [reading.expression(item, ANGLE) for item in angle_items]
    if len(axes) > 3:
        reading.error("wrong-shape", "a joint has at most three rotation axes", axes_node.span, "add a massless body")
    if len(angles) != len(axes):
        message = Message(
            "each axis has its angle: [[axes]] wanted, not [[angles]]", axes=len(axes), angles=len(angles)
        )
        if listed:
            reading.error("wrong-shape", message, angles_node.span, comma_hint(angle_items, len(axes)))
        return Rotation()
    for axis, angle, item in zip(axes, angles, angle_items, strict=True):
        if axis == 0 and not is_number(angle, 0):
            hint = "the axis that it turns about is 1, 2 or 3"
            reading.error("bad-axis", "axis 0 means no rotation, so its angle is 0", item.span, hint)
    for angle, item in zip(angles, angle_items, strict=True):
        _check_rounded(angle, item, reading)
    turns = [(axis, angle) for axis, angle in zip(axes, angles, strict=True) if axis and not is_number(angle, 0)]
    return Rotation(tuple(axis for axis, _ in turns), tuple(angle for _, angle in turns))


def _check_rounded(angle: Expression, item: Node, reading: Reading) -> None:
    """A decimal number such as 1.5708 is an angle of its own, with formulas of its own: pi/2 was meant, most likely."""
    value = rational(angle)
    if value is None or not isinstance(item, Scalar):
        return
    digits = next((n for n in range(3, 31) if (value * 10**n).denominator == 1), None)
    twelfths = round(abs(value) * 12 / _PI)
    if digits is None or not 0 < twelfths <= 24 or (digits == 3 and twelfths % 6) or (twelfths % 2 and twelfths % 3):
        return
    exact = twelfths * _PI / 12 * 10**digits
    if abs(value) * 10**digits in (round(exact), int(exact)):
        share = Fraction(twelfths, 12)
        written = ("" if share.numerator == 1 else f"{share.numerator}*") + "pi"
        written += "" if share.denominator == 1 else f"/{share.denominator}"
        written = f"-{written}" if value < 0 else written
        message = Message("this angle is [[written]] rounded, and is taken as it stands", written=written)
        hint = Message("write [[written]]: the formulas become much shorter", written=written)
        reading.complaints.warning("rounded-angle", message, item.span, hint)


def _axis(node: Node, reading: Reading) -> int | None:
    """The number of an axis, or None after a complaint."""
    scalar = reading.scalar(node, "a rotation axis")
    if scalar is None:
        return None
    if scalar.text in ("0", "1", "2", "3"):
        return int(scalar.text)
    hint = "for the opposite sense, turn by the negative angle" if scalar.text.startswith("-") else None
    if scalar.text.lower() in ("x", "y", "z"):
        hint = Message(
            "write [[index]]: the axes x, y, z are numbered 1, 2, 3", index="xyz".index(scalar.text.lower()) + 1
        )
    reading.error(
        "bad-axis", "rotation axes are 1, 2, 3 or 0, not [[what]]", scalar.span, hint, what=ascii_safe(scalar.text)
    )
    return None


def _inertia(fields: Fields, reading: Reading) -> Inertia | None:
    """The tensor and its point; a tensor of zeros is no inertia at all."""
    node, about = fields.get("inertia"), fields.word("inertia about")
    if node is None:
        if about:
            fields.require("inertia")
        return None
    node, accepted = _accepted(node, fields, reading)
    tensor = _tensor(node, reading)
    if all(is_number(entry, 0) for row in tensor for entry in row):
        return None
    if fields.get("inertia about") is None:
        hint = "'inertia about: joint' (the connection point) or 'inertia about: mass centre'"
        reading.error("inertia-point", "it is not said about which point", fields.key_span("inertia"), hint)
    return Inertia(about or MASS_CENTRE, tensor, accepted, fields.key_span("inertia"))


def _accepted(node: Node, fields: Fields, reading: Reading) -> tuple[Node, bool]:
    """The tensor alone, and whether ``{tensor: ..., accept: true}`` says to take it as given."""
    if not isinstance(node, Mapping):
        return node, False
    inertia = reading.fields(node, Message("the inertia of [[what]]", what=worded(fields.what)), INERTIA)
    tensor, accept = inertia.require("tensor"), inertia.get("accept")
    word = None if accept is None else reading.word(accept, "'accept'", ("true", "false"))
    return tensor or Sequence(tuple(Scalar("0", node.span, literal=False) for _ in range(3)), node.span), word == "true"


def _tensor(node: Node, reading: Reading) -> Tensor:
    """Three principal moments, or three rows of a symmetric matrix."""
    allowed = Allowed("a tensor of inertia")
    items = reading.triple(node, "an inertia (three principal moments or three rows)", alike=True)
    if items is None:
        return ZERO_VECTOR, ZERO_VECTOR, ZERO_VECTOR
    if not any(isinstance(item, Sequence) for item in items):
        first, second, third = reading.vector(node, allowed)
        return (first, ZERO, ZERO), (ZERO, second, ZERO), (ZERO, ZERO, third)
    errors = reading.errors
    rows = [reading.vector(item, allowed) for item in items]
    for row in range(3):
        for column in range(row):
            below = items[row]
            difference = subtract(rows[row][column], rows[column][row])
            if reading.errors == errors and vanishes(difference) is False:
                assert isinstance(below, Sequence)
                entries = Message("[[row]],[[column]] and [[column]],[[row]]", row=row + 1, column=column + 1)
                message = Message("a tensor of inertia is symmetric: entries [[entries]] differ", entries=entries)
                if _is_rounding(difference, rows[column][row]):
                    hint = Message(
                        "taken for rounding, as it is less than a millionth; [[column]],[[row]] is used for both",
                        column=column + 1,
                        row=row + 1,
                    )
                    reading.complaints.warning("rounded-inertia", message, below.items[column].span, hint)
                    rows[row] = _with(rows[row], column, rows[column][row])
                else:
                    reading.error("asymmetric-inertia", message, below.items[column].span)
    return rows[0], rows[1], rows[2]


def _is_rounding(difference: Expression, entry: Expression) -> bool:
    """Whether two numbers differ by less than the rounding of decimals."""
    between, size = rational(difference), rational(entry)
    return between is not None and size is not None and abs(between) <= ROUNDING * abs(size)


def _with(vector: Vector, index: int, component: Expression) -> Vector:
    first, second, third = (component if k == index else old for k, old in enumerate(vector))
    return first, second, third


# What bodies look like: boxes, balls, rods.  Drawn, and otherwise without consequence.


_SIZE = Allowed("the size of a shape")
_PLACE = Allowed("the place of a shape")
_ANGLE = Allowed("the angle of a shape")


def read_shapes(node: Node | None, what: str, reading: Reading) -> tuple[Shape, ...]:
    """The shapes of a body, each a mapping with one kind."""
    if node is None:
        return ()
    items = reading.items(node, "'shapes'")
    shapes = (
        _shape(reading.fields(item, Message("a shape of [[what]]", what=worded(what)), SHAPE), reading)
        for item in items
    )
    return tuple(shape for shape in shapes if shape is not None)


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
    return Shape(kind, _sizes(kind, node, reading), place, _shape_rotation(fields.get("rotation"), reading))


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


def _shape_rotation(node: Node | None, reading: Reading) -> Rotation:
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
