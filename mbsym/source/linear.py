"""``linear system``: coordinates and matrices in place of bodies and loads."""

from __future__ import annotations

from mbsym.expressions.message import Message
from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.tree import ZERO, Expression, Number
from mbsym.model.linear import MATRICES, PARTS, GivenMatrix, LinearModel, MatrixFile, Rows
from mbsym.source.keys import LINEAR_SYSTEM, MATRIX_FILE, MOST_COORDINATES
from mbsym.source.placed import Mapping, Node, Sequence
from mbsym.source.reading import Fields, Reading, comma_hint
from mbsym.source.scope import Allowed

#: What describes bodies, and has no meaning beside matrices.
OF_BODIES = (
    *("bodies", "loads", "constraints", "dependent", "reactions", "prescribed", "given", "tables", "motion", "initial"),
    *("limits", "outputs"),
)

ENTRY = Allowed("an entry of a matrix", ("parameter",))


def declare_linear(node: Node | None, whole: Fields, reading: Reading) -> tuple[Fields, tuple[str, ...]] | None:
    """The keys of a linear system and its coordinates, which are declared; None where the description has bodies."""
    if node is None:
        return None
    for key in OF_BODIES:
        if key in whole.entries:
            message = Message(
                "[[key]] does not go with a 'linear system', which is given by its matrices", key=ascii_safe(key)
            )
            reading.error("conflicting-keys", message, whole.key_span(key), "leave one of them out")
    hint = "write {coordinates: [x, y], K: [[k1, 0], [0, k2]]}"
    fields = reading.fields(node, "a linear system", LINEAR_SYSTEM, hint)
    names, coordinates = fields.require("coordinates", hint), []
    items = () if names is None else reading.items(names, "'coordinates'")
    if names is not None and isinstance(names, Sequence) and not 1 <= len(items) <= MOST_COORDINATES:
        message = Message(
            "a linear system has 1 to [[most]] coordinates, not [[items]]", most=MOST_COORDINATES, items=len(items)
        )
        reading.error("wrong-shape", message, names.span)
    for item in items:
        scalar = reading.scalar(item, "a coordinate")
        if scalar is not None and reading.scope.declare(scalar.text, "coordinate", scalar.span):
            coordinates.append(scalar.text)
    return fields, tuple(coordinates)


def read_linear(fields: Fields, coordinates: tuple[str, ...], inputs: int, reading: Reading) -> LinearModel:
    """The matrices, with every complaint about their shapes; ``inputs`` is how many columns B has."""
    for whole, parts in PARTS.items():
        if whole in fields.entries:
            fields.exclude(whole, parts)
    if fields.sound and not {*MATRICES} - {"B"} & {*fields.entries}:
        hint = "stiffness K, damping D, gyroscopic G, ...: K: [[k1, 0], [0, k2]]"
        reading.error("missing-key", "a linear system without matrices: x'' = 0", fields.span, hint)
    matrices, rows = [], len(coordinates)
    for key in MATRICES:
        node = fields.get(key)
        if node is not None and rows:
            matrix = _matrix(key, node, (rows, inputs if key == "B" else rows), reading)
            if matrix is not None:
                matrices.append(matrix)
    if "B" in fields.entries and not inputs:
        reading.error("idle-inputs", "B has no inputs: there are none", fields.key_span("B"), "declare 'inputs: [u]'")
    elif inputs and "B" not in fields.entries:
        message = "the inputs act nowhere: there is no B"
        reading.error("missing-key", message, fields.span, "the equations are M x'' + ... = B u, B: [[1], [0]]")
    return LinearModel(coordinates, tuple(matrices), fields.span)


def _matrix(key: str, node: Node, shape: tuple[int, int], reading: Reading) -> GivenMatrix | None:
    """One matrix of a shape, or None where something was complained about."""
    what = Message("the matrix [[key]]", key=key)
    if isinstance(node, Mapping):
        return _from_file(key, node, shape, reading)
    if not isinstance(node, Sequence):
        reading.shape_error(
            node,
            what,
            "a list of rows",
            Message("write [[[[row]]], ...], or {file: [[key]].mtx}", row=_zeros(shape[1]), key=key),
        )
        return None
    errors, (height, width) = reading.errors, shape
    items = reading.items(node, what)
    if len(items) != height:
        message = Message(
            "[[what]] has [[height]] rows, one for each coordinate, not [[items]]",
            what=what,
            height=height,
            items=len(items),
        )
        flat = items and not any(isinstance(item, Sequence) for item in items)
        hint = "a matrix is a list of rows: [[a, b], [c, d]]" if flat else None
        reading.error("wrong-shape", message, node.span, hint)
        return None
    rows: list[tuple[Expression, ...]] = []
    spans = []
    for number, item in enumerate(items, 1):
        if not isinstance(item, Sequence):
            reading.shape_error(
                item,
                Message("row [[number]] of [[what]]", number=number, what=what),
                "a list",
                Message("write [[[row]]]", row=_zeros(width)),
            )
            continue
        if len(item.items) != width:
            of = "one for each input" if key == "B" else "one for each coordinate"
            message = Message(
                "row [[number]] of [[what]] has [[width]] entries, [[of]], not [[items]]",
                number=number,
                what=what,
                width=width,
                of=of,
                items=len(item.items),
            )
            reading.error("wrong-shape", message, item.span, comma_hint(item.items, width))
            continue
        rows.append(tuple(reading.expression(cell, ENTRY) for cell in item.items))
        spans.append(tuple(cell.span for cell in item.items))
    return GivenMatrix(key, tuple(rows), None, node.span, tuple(spans)) if reading.errors == errors else None


def _zeros(count: int) -> str:
    return ", ".join(["0"] * min(count, 4)) + (", ..." if count > 4 else "")


def _from_file(key: str, node: Node, shape: tuple[int, int], reading: Reading) -> GivenMatrix | None:
    """``{file: K.mtx, sha256: ...}``."""
    fields = reading.fields(
        node, Message("the matrix [[key]]", key=key), MATRIX_FILE, Message("write {file: [[key]].mtx}", key=key)
    )
    named = fields.require("file")
    scalar = None if named is None else reading.scalar(named, "'file'")
    if scalar is None:
        return None
    from mbsym.source.matrix_file import Unreadable, read_matrix  # few descriptions have such a file

    file = scalar.text.strip()
    try:
        read = read_matrix(reading.folder, file, MOST_COORDINATES)
    except Unreadable as why:
        reading.error("matrix-file", why.message, scalar.span, why.hint)
        return None
    stated = fields.get("sha256")
    expected = None if stated is None else reading.scalar(stated, "'sha256'")
    if expected is not None and expected.text.strip().lower() != read.digest:
        message = Message(
            "[[file]] is not the file that is meant: its SHA-256 is [[digest]]", file=file, digest=read.digest
        )
        reading.error("matrix-file", message, expected.span, "leave the key out where any content will do")
        return None
    size = (len(read.rows), len(read.rows[0]))
    if size != shape:
        message = Message(
            "[[file]] holds a matrix of [[found]] x [[found2]], and [[key]] is [[rows]] x [[columns]] here",
            file=file,
            found=size[0],
            found2=size[1],
            key=key,
            rows=shape[0],
            columns=shape[1],
        )
        reading.error("wrong-shape", message, scalar.span)
        return None
    rows: Rows = tuple(tuple(Number(x) if x else ZERO for x in row) for row in read.rows)
    spans = tuple((scalar.span,) * shape[1] for _ in rows)
    return GivenMatrix(key, rows, MatrixFile(file, read.digest), node.span, spans)
