"""Matrices in files beside a description: MatrixMarket (.mtx) and NumPy (.npy), as exact numbers.

Decimal text stands for itself (0.1 is 1/10), a binary floating point number for the dyadic number that it is.

Sources: the MatrixMarket exchange formats (NIST, R. Boisvert et al. 1996); the NPY format (numpy.lib.format).
"""

from __future__ import annotations

import hashlib
import io
import math
import re
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path, PurePosixPath
from typing import Any

from mbsym.expressions.message import Message
from mbsym.expressions.parser import ascii_safe

#: A file has at most so many bytes.
MOST_BYTES = 4_000_000

Numbers = tuple[tuple[Fraction, ...], ...]

_NUMBER = re.compile(r"[-+]?(?:\d{1,40}\.?\d{0,40}|\.\d{1,40})(?:[eEdD][-+]?\d{1,3})?\Z")
_WHOLE = re.compile(r"\d{1,7}\Z")

_BESIDE = "a file of a matrix stands beside the description, or in a folder below"


class Unreadable(Exception):
    """Why there is no matrix, a message with its gaps, and what to do about it."""

    def __init__(self, message: str, remedy: str = "", **gaps: object) -> None:
        self.message, self.hint = Message(message, **gaps), remedy or None
        super().__init__(self.message)


@dataclass(frozen=True)
class Read:
    """The numbers, row by row, and the SHA-256 of the file."""

    rows: Numbers
    digest: str


def read_matrix(folder: Path | None, file: str, most: int) -> Read:
    """The matrix in a file of a folder, of at most ``most`` rows and columns.  Raises Unreadable."""
    data = _bytes(folder, file)
    ending = PurePosixPath(file).suffix.lower()
    if ending == ".npy":
        rows = _from_numpy(data, file, most)
    elif ending in (".mtx", ".mm"):
        rows = _from_market(data, file, most)
    else:
        raise Unreadable(
            "[[file]] is no file of a matrix", file=_plain(file), remedy="MatrixMarket (.mtx) and NumPy (.npy) are read"
        )
    return Read(rows, hashlib.sha256(data).hexdigest())


def _plain(file: str) -> str:
    """The name of a file without quotes, what is not ASCII in it escaped."""
    return ascii_safe(file)[1:-1]


def _bytes(folder: Path | None, file: str) -> bytes:
    if folder is None:
        hint = "give mbsym this description as a file of its own, or write the matrix into it"
        raise Unreadable(
            "files beside a description are read with it only: not in a batch, nor beside a text", remedy=hint
        )
    relative = PurePosixPath(file)
    if relative.is_absolute() or ".." in relative.parts or "\\" in file or ":" in file:
        raise Unreadable(_BESIDE, remedy="as in data/K.mtx")
    try:
        path = (folder / relative).resolve()
        if not path.is_relative_to(folder.resolve()):
            raise Unreadable(_BESIDE)
        if not path.is_file():
            raise Unreadable("there is no file [[file]] beside the description", file=_plain(file))
        with path.open("rb") as opened:
            data = opened.read(MOST_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise Unreadable("[[file]] cannot be read: [[reason]]", file=_plain(file), reason=reason) from error
    if len(data) > MOST_BYTES:
        raise Unreadable(
            "[[file]] has more than [[most]] bytes",
            file=_plain(file),
            most=MOST_BYTES,
            remedy="reduce the model before",
        )
    return data


def _sized(rows: int, columns: int, file: str, most: int) -> None:
    if not (1 <= rows <= most and 1 <= columns <= most):
        text = "[[file]] holds a matrix of [[rows]] x [[columns]], and 1 to [[most]] rows and columns are read"
        hint = "reduce the model before" if max(rows, columns) > most else ""
        raise Unreadable(text, file=_plain(file), rows=rows, columns=columns, most=most, remedy=hint)


# --- MatrixMarket ---


def _from_market(data: bytes, file: str, most: int) -> Numbers:
    name = _plain(file)
    try:
        lines = data.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise Unreadable("[[name]] is no UTF-8 text", name=name) from error
    head = lines[0].lower().split() if lines else []
    if len(head) != 5 or head[:2] != ["%%matrixmarket", "matrix"]:
        raise Unreadable(
            "[[name]]:1: no MatrixMarket header", name=name, remedy="%%MatrixMarket matrix array real general"
        )
    layout, kind, symmetry = head[2:]
    known = {"array", "coordinate"}, {"real", "integer"}, {"general", "symmetric", "skew-symmetric"}
    for word, words in zip((layout, kind, symmetry), known, strict=True):
        if word not in words:
            raise Unreadable(
                "[[name]]:1: [[word]] is not read",
                name=name,
                word=ascii_safe(word),
                remedy=Message("one of: [[words]]", words=", ".join(sorted(words))),
            )
    body = [(number, line.split()) for number, line in enumerate(lines, 1) if line.strip() and line[0] != "%"]
    if not body:
        raise Unreadable("[[name]] has no line of sizes", name=name)
    place, sizes = body[0]
    size_count = 2 if layout == "array" else 3
    if len(sizes) != size_count or not all(map(_WHOLE.match, sizes)):
        raise Unreadable(
            "[[name]]:[[place]]: the line of sizes holds [[wanted]] whole numbers",
            name=name,
            place=place,
            wanted=size_count,
        )
    rows, columns = int(sizes[0]), int(sizes[1])
    _sized(rows, columns, file, most)
    if symmetry != "general" and rows != columns:
        raise Unreadable(
            "[[name]]:[[place]]: a [[symmetry]] matrix is square, not [[rows]] x [[columns]]",
            name=name,
            place=place,
            symmetry=symmetry,
            rows=rows,
            columns=columns,
        )
    matrix = [[Fraction(0)] * columns for _ in range(rows)]
    if layout == "array":
        entries = _listed(body[1:], name, symmetry, rows, columns)
    else:
        entries = _placed(body[1:], int(sizes[2]), name, rows, columns)
    seen = set()
    for number, i, j, value in entries:
        if (i, j) in seen or (symmetry != "general" and (j, i) in seen):
            raise Unreadable(
                "[[name]]:[[number]]: the entry [[i]], [[j]] is given twice", name=name, number=number, i=i + 1, j=j + 1
            )
        seen.add((i, j))
        matrix[i][j] = value
        if symmetry != "general" and i != j:
            matrix[j][i] = value if symmetry == "symmetric" else -value
        if symmetry == "skew-symmetric" and i == j and value:
            raise Unreadable("[[name]]:[[number]]: the diagonal of a skew matrix is zero", name=name, number=number)
    return tuple(map(tuple, matrix))


_Entries = list[tuple[int, int, int, Fraction]]


def _listed(body: list[tuple[int, list[str]]], name: str, symmetry: str, rows: int, columns: int) -> _Entries:
    """The entries of an array, column by column; of symmetric ones the lower triangle."""
    low = {"general": lambda j: 0, "symmetric": lambda j: j, "skew-symmetric": lambda j: j + 1}[symmetry]
    places = [(i, j) for j in range(columns) for i in range(low(j), rows)]
    values = [(number, cell) for number, cells in body for cell in cells]
    if len(values) != len(places):
        raise Unreadable(
            "[[name]] holds [[values]] entries, and [[places]] are announced",
            name=name,
            values=len(values),
            places=len(places),
        )
    return [(number, i, j, _number(cell, name, number)) for (number, cell), (i, j) in zip(values, places, strict=True)]


def _placed(body: list[tuple[int, list[str]]], count: int, name: str, rows: int, columns: int) -> _Entries:
    if len(body) != count:
        raise Unreadable(
            "[[name]] holds [[body]] entries, and [[count]] are announced", name=name, body=len(body), count=count
        )
    entries = []
    for number, cells in body:
        if len(cells) != 3 or not _WHOLE.match(cells[0]) or not _WHOLE.match(cells[1]):
            raise Unreadable("[[name]]:[[number]]: an entry is a row, a column and a value", name=name, number=number)
        i, j = int(cells[0]), int(cells[1])
        if not (1 <= i <= rows and 1 <= j <= columns):
            raise Unreadable(
                "[[name]]:[[number]]: there is no entry [[i]], [[j]] in a matrix of [[rows]] x [[columns]]",
                name=name,
                number=number,
                i=i,
                j=j,
                rows=rows,
                columns=columns,
            )
        entries.append((number, i - 1, j - 1, _number(cells[2], name, number)))
    return entries


def _number(cell: str, name: str, line: int) -> Fraction:
    if not _NUMBER.match(cell):
        hint = "numbers have a decimal point" if "," in cell else ""
        raise Unreadable(
            "[[name]]:[[line]]: [[cell]] is no number", name=name, line=line, cell=ascii_safe(cell[:40]), remedy=hint
        )
    return Fraction(re.sub("[dD]", "e", cell))


# --- NumPy ---


def _from_numpy(data: bytes, file: str, most: int) -> Numbers:
    """The header is looked at before anything is made of what it announces."""
    from numpy.lib import format as npy

    name, opened = _plain(file), io.BytesIO(data)
    try:
        version = npy.read_magic(opened)
        if version not in ((1, 0), (2, 0)):
            raise Unreadable(
                "[[name]] has version [[major]].[[minor]] of the format, and 1.0 and 2.0 are read",
                name=name,
                major=version[0],
                minor=version[1],
            )
        head = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
        shape, by_columns, kind = head(opened)
    except Unreadable:
        raise
    except Exception as error:
        raise Unreadable("[[name]] is no NumPy file", name=name, remedy="save it with numpy.save") from error
    if kind.hasobject or kind.kind not in "fiu" or kind.itemsize > 8:
        raise Unreadable(
            "[[name]] holds [[kind]], and real numbers of up to 8 bytes are read",
            name=name,
            kind=kind,
            remedy="save it as float64",
        )
    if len(shape) != 2:
        raise Unreadable(
            "[[name]] holds an array of [[count]] dimensions, and a matrix has 2", name=name, count=len(shape)
        )
    rows, columns = shape
    _sized(rows, columns, file, most)
    if len(data) - opened.tell() != rows * columns * kind.itemsize:
        raise Unreadable("[[name]] is not as long as its header says", name=name)
    return _exact(data[opened.tell() :], kind, shape, by_columns, name)


def _exact(data: bytes, kind: Any, shape: tuple[int, int], by_columns: bool, name: str) -> Numbers:
    import numpy as np

    values = np.frombuffer(data, dtype=kind).reshape(shape, order="F" if by_columns else "C").tolist()
    for i, row in enumerate(values, 1):
        for j, x in enumerate(row, 1):
            if not math.isfinite(x):
                raise Unreadable(
                    "[[name]]: the entry [[i]], [[j]] is [[written]], no number", name=name, i=i, j=j, written=x
                )
    return tuple(tuple(Fraction(x) for x in row) for row in values)
