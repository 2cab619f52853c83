"""Tables: inputs that were measured or drawn, as points and what is between them."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

from mbsym.expressions.message import Message, worded
from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.place import Span
from mbsym.expressions.table import HOLD, LINEAR, Points, Source, Table
from mbsym.model.system import rational
from mbsym.model.units import Declared
from mbsym.source.keys import MAX_POINTS, TABLE
from mbsym.source.placed import Entry, Node, Sequence
from mbsym.source.reading import Fields, Reading
from mbsym.source.scope import NUMBER

Place = tuple[Fraction, Fraction]


def read_tables(node: Node | None, reading: Reading) -> tuple[Table, ...]:
    """``torque: {points: [[0, 0], [1, 2.5]], between: linear, outside: hold, unit: N*m}``; entered in the scope."""
    tables = []
    for entry in () if node is None else reading.entries(node, "'tables'"):
        declared = reading.scope.declare(entry.key.text, "table", entry.key.span)
        table = _table(entry, reading)
        if declared:
            reading.scope.tables[table.name] = table
            tables.append(table)
    return tuple(tables)


def _table(entry: Entry, reading: Reading) -> Table:
    name = entry.key.text
    what = Message("the table [[name]]", name=ascii_safe(name))
    hint = "write {points: [[0, 0], [1, 2.5]]}"
    fields = reading.fields(entry.value, what, TABLE, hint)
    between, outside = fields.word("between") or LINEAR, fields.word("outside") or HOLD
    unit = fields.get("unit")
    scalar = None if unit is None else reading.scalar(unit, Message("the unit of [[name]]", name=ascii_safe(name)))
    if scalar is not None:
        reading.units.append(Declared(name, scalar.text.strip(), scalar.span))
    source = None
    if fields.get("file") is not None:
        fields.exclude("file", ["points"])
        points, source = _from_file(fields, reading)
    else:
        node = fields.require("points", hint)
        fields.exclude("points", ["columns", "sha256"])
        points = () if node is None else _points(node, what, reading)
    if len(points) < 2:  # something was complained about; this goes on for it
        points = ((Fraction(0), Fraction(0)), (Fraction(1), Fraction(0)))
    return Table(name, points, between, outside, entry.key.span, source)


def _from_file(fields: Fields, reading: Reading) -> tuple[Points, Source | None]:
    """The points of a file, every complaint about it at the place where it is named."""
    node = fields.get("file")
    scalar = None if node is None else reading.scalar(node, "'file'")
    columns = _columns(fields.get("columns"), reading)
    if scalar is None or columns is None:
        return (), None
    from mbsym.source.table_file import read_points  # few descriptions have such a file

    found = read_points(reading.folder, scalar.text.strip(), columns)
    for message, hint in found.complaints:
        reading.error("table-file", message, scalar.span, hint)
    wanted = fields.get("sha256")
    stated = None if wanted is None else reading.scalar(wanted, "'sha256'")
    if stated is not None and found.digest and stated.text.strip().lower() != found.digest:
        message = Message(
            "[[file]] is not the file that is meant: its SHA-256 is [[digest]]",
            file=scalar.text.strip(),
            digest=found.digest,
        )
        reading.error("table-file", message, stated.span, "leave the key out where any content will do")
    return found.points, Source(scalar.text.strip(), columns, found.digest)


def _columns(node: Node | None, reading: Reading) -> tuple[str, str] | None:
    if node is None:
        return "1", "2"
    if not isinstance(node, Sequence) or len(node.items) != 2:
        reading.shape_error(node, "'columns'", "two columns", "write [t, speed], or [1, 3]")
        return None
    first, second = (reading.scalar(item, "a column") for item in node.items)
    return None if first is None or second is None else (first.text.strip(), second.text.strip())


def _points(node: Node, what: str, reading: Reading) -> tuple[Place, ...]:
    """The points, each complained about that is none, or stands in the wrong order."""
    items = reading.items(node, Message("the points of [[what]]", what=worded(what)))
    if isinstance(node, Sequence) and not 2 <= len(items) <= MAX_POINTS:
        reading.error(
            "wrong-shape",
            Message(
                "[[what]] has 2 to [[most]] points, not [[items]]",
                what=worded(what),
                most=MAX_POINTS,
                items=len(items),
            ),
            node.span,
        )
    found = [(point, item.span) for item in items if (point := _point(item, what, reading)) is not None]
    for (one, _), (later, span) in pairwise(found):
        if later[0] <= one[0]:
            _disordered(one, later, span, reading)
    increasing = len(found) == len(items) and all(one[0][0] < later[0][0] for one, later in pairwise(found))
    return tuple(point for point, _ in found) if increasing else ()


def _disordered(one: Place, later: Place, span: Span, reading: Reading) -> None:
    message = "the arguments of a table increase from point to point"
    hint = "for a jump add a step or a pulse to it" if later[0] == one[0] else "sort the points"
    reading.error("table-order", message, span, hint)


def _point(node: Node, what: str, reading: Reading) -> Place | None:
    if not isinstance(node, Sequence) or len(node.items) != 2:
        reading.shape_error(
            node,
            Message("a point of [[what]]", what=worded(what)),
            "two numbers",
            "write [0.5, 2], the argument and the value",
        )
        return None
    numbers = []
    for item in node.items:
        errors = reading.errors
        number = rational(reading.expression(item, NUMBER))
        if number is None and reading.errors == errors:
            reading.error("bad-number", "the numbers of a table are rational", item.span, "write them as decimals")
        numbers.append(number if reading.errors == errors else None)
    first, second = numbers
    return None if first is None or second is None else (first, second)
