"""Tables: inputs that were measured or drawn, as points and what is between them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from pathlib import Path, PurePosixPath

from mbsym.expressions.message import Message, worded
from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.place import Span
from mbsym.expressions.table import HOLD, LINEAR, Points, Source, Table
from mbsym.model.system import rational
from mbsym.source.constants import note_unit
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
    note_unit(name, fields, reading)
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

    rows = read_points(reading.folder, scalar.text.strip(), columns)
    for message, hint in rows.complaints:
        reading.error("table-file", message, scalar.span, hint)
    digest_node = fields.get("sha256")
    stated = None if digest_node is None else reading.scalar(digest_node, "'sha256'")
    if stated is not None and rows.digest and stated.text.strip().lower() != rows.digest:
        message = Message(
            "[[file]] is not the file that is meant: its SHA-256 is [[digest]]",
            file=scalar.text.strip(),
            digest=rows.digest,
        )
        reading.error("table-file", message, stated.span, "leave the key out where any content will do")
    return rows.points, Source(scalar.text.strip(), columns, rows.digest)


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
            "[[what]] has 2 to [[most]] points, not [[items]]",
            node.span,
            what=worded(what),
            most=MAX_POINTS,
            items=len(items),
        )
    points = [(point, item.span) for item in items if (point := _point(item, what, reading)) is not None]
    for (earlier, _), (later, span) in pairwise(points):
        if later[0] <= earlier[0]:
            _disordered(earlier, later, span, reading)
    increasing = len(points) == len(items) and all(earlier[0][0] < later[0][0] for earlier, later in pairwise(points))
    return tuple(point for point, _ in points) if increasing else ()


def _disordered(place: Place, later: Place, span: Span, reading: Reading) -> None:
    message = "the arguments of a table increase from point to point"
    hint = "for a jump add a step or a pulse to it" if later[0] == place[0] else "sort the points"
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


# Points of a table from a file of rows: comma-separated, with semicolons or tabs, with or without a line of names.


#: A file has at most so many bytes, a table so many points.
MOST_BYTES, MOST_POINTS = 4_000_000, 20_000

#: So many complaints about a file are shown one by one.
MOST_COMPLAINTS = 8

_NUMBER = re.compile(r"[-+]?(?:\d{1,40}\.?\d{0,40}|\.\d{1,40})(?:[eE][-+]?\d{1,2})?\Z")


@dataclass(frozen=True)
class Rows:
    """``points`` as they stand, or ``complaints`` as (message, hint); ``digest`` is the SHA-256 of the file."""

    points: Points = ()
    complaints: tuple[tuple[str, str | None], ...] = ()
    digest: str = ""


def read_points(folder: Path | None, file: str, columns: tuple[str, str]) -> Rows:
    """The points in two columns, by their names or numbers from 1 on, of a file in a folder."""
    if folder is None:
        hint = "give mbsym this description as a file of its own, or write the points into it"
        return _refused("files beside a description are read with it only: not in a batch, nor beside a text", hint)
    relative = PurePosixPath(file)
    if relative.is_absolute() or ".." in relative.parts or "\\" in file or ":" in file:
        return _refused("a file of points stands beside the description, or in a folder below", "as in data/wind.csv")
    try:
        path = (folder / relative).resolve()
        if not path.is_relative_to(folder.resolve()):
            return _refused("a file of points stands beside the description, or in a folder below", None)
        if not path.is_file():
            return _refused(Message("there is no file [[file]] beside the description", file=ascii_safe(file)), None)
        with path.open("rb") as opened:
            data = opened.read(MOST_BYTES + 1)
    except (OSError, ValueError) as error:
        return _refused(
            Message("[[file]] cannot be read: [[why]]", file=file, why=getattr(error, "strerror", None) or error), None
        )
    if len(data) > MOST_BYTES:
        return _refused(
            Message("[[file]] has more than [[most]] bytes", file=file, most=MOST_BYTES),
            "leave out what the motion does not feel",
        )
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        return _refused(
            Message(
                "[[file]] is no UTF-8 text (line [[count]])",
                file=file,
                count=data.count(bytes([10]), 0, error.start) + 1,
            ),
            None,
        )
    import hashlib  # few descriptions have such a file

    return _read(text, file, columns, hashlib.sha256(data).hexdigest())


def _refused(message: str, hint: str | None) -> Rows:
    return Rows(complaints=((message, hint),))


def _rows(text: str) -> Iterator[tuple[int, list[str]]]:
    """(line, cells), comments and empty lines left out."""
    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1)]
    lines = [(number, line) for number, line in lines if line.strip() and not line.lstrip().startswith("#")]
    separator = next((mark for mark in (";", "\t") if lines and mark in lines[0][1]), ",")
    for number, line in lines:
        yield number, [cell.strip().strip('"').strip() for cell in line.split(separator)]


def _read(text: str, file: str, columns: tuple[str, str], digest: str) -> Rows:
    rows = list(_rows(text))
    if not rows:
        return _refused(Message("[[file]] has no rows", file=file), None)
    head = rows[0][1] if any(not _NUMBER.match(cell) for cell in rows[0][1] if cell) else []
    places = []
    for column in columns:
        place = _place(column, head, len(rows[0][1]))
        if place is None:
            known = (
                Message("its columns are: [[columns]]", columns=", ".join(map(ascii_safe, head[:20])))
                if head
                else "columns count from 1"
            )
            return _refused(
                Message(
                    "[[file]]:[[row]]: there is no column [[column]]",
                    file=file,
                    row=rows[0][0],
                    column=ascii_safe(column),
                ),
                known,
            )
        places.append(place)
    body = rows[1:] if head else rows
    if not 2 <= len(body) <= MOST_POINTS:
        return _refused(
            Message(
                "[[file]] has 2 to [[most]] rows of numbers, not [[count]]",
                file=file,
                most=MOST_POINTS,
                count=len(body),
            ),
            None,
        )
    points, wrong = [], []
    width = len(rows[0][1])
    for number, cells in body:
        if len(cells) != width:
            hint = "numbers have a decimal point" if len(cells) > width else None
            wrong.append(
                (
                    Message(
                        "[[file]]:[[number]]: [[cells]] cells, and [[width]] in the first row",
                        file=file,
                        number=number,
                        cells=len(cells),
                        width=width,
                    ),
                    hint,
                )
            )
            continue
        point = [_value(cells[place]) for place in places]
        first, second = point
        if first is None or second is None:
            where = places[0] if first is None else places[1]
            shown = ascii_safe(cells[where][:40]) if cells[where] else "an empty cell"
            hint = "numbers have a decimal point" if "," in cells[where] else None
            wrong.append(
                (Message("[[file]]:[[number]]: [[shown]] is no number", file=file, number=number, shown=shown), hint)
            )
        else:
            points.append((number, (first, second)))
    for (_, earlier), (number, later) in pairwise(points):
        if later[0] <= earlier[0]:
            message = Message(
                "[[file]]:[[number]]: the arguments of a table increase from row to row", file=file, number=number
            )
            wrong.append(
                (message, "take the mean of rows with one argument" if later[0] == earlier[0] else "sort the rows")
            )
    if len(wrong) > MOST_COMPLAINTS:
        wrong[MOST_COMPLAINTS:] = [
            (Message("[[file]]: and [[more]] more rows like these", file=file, more=len(wrong) - MOST_COMPLAINTS), None)
        ]
    return Rows(() if wrong else tuple(point for _, point in points), tuple(wrong), digest)


def _place(column: str, head: list[str], width: int) -> int | None:
    if column in head:
        return head.index(column)
    return int(column) - 1 if re.fullmatch("[1-9][0-9]?", column) and int(column) <= width else None


def _value(cell: str) -> Fraction | None:
    return Fraction(cell) if _NUMBER.match(cell) else None
