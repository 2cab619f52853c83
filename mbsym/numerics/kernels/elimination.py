"""Text for linear equations in machine code: L U factors in place, and solutions by them."""

from __future__ import annotations

from mbsym.numerics.kernels.writer import INTEGER, Function, Value


def factorise(f: Function, kind: str, matrix: Value, size: int, exchanged: Value | None = None) -> None:
    """matrix (row by row) <- its L U factors, L with ones on its diagonal.

    With ``exchanged``, room for ``size`` whole numbers, row k changes places with row exchanged[k] before it
    eliminates: the one whose entry is largest.  Without, rows stay, as is right where the symmetric part is positive
    definite.
    """
    with f.repeat(size) as k:
        if exchanged is not None:
            _exchange(f, kind, matrix, size, k, exchanged)
        inverse = 1 / f.load(kind, matrix, k * (size + 1))
        with f.repeat(size, k + 1) as i:
            factor = f.load(kind, matrix, i * size + k) * inverse
            f.store(factor, kind, matrix, i * size + k)
            with f.repeat(size, k + 1) as j:
                entry = f.load(kind, matrix, i * size + j) - factor * f.load(kind, matrix, k * size + j)
                f.store(entry, kind, matrix, i * size + j)


def _exchange(f: Function, kind: str, matrix: Value, size: int, k: Value, exchanged: Value) -> None:
    """The row from k on whose entry in column k is largest comes to k."""
    largest = f.slot(kind)
    f.store(f.load(kind, matrix, k * (size + 1)).absolute(), kind, largest)
    f.store(k, INTEGER, exchanged, k)
    with f.repeat(size, k + 1) as i:
        entry = f.load(kind, matrix, i * size + k).absolute()
        with f.when(entry.compare(">", f.load(kind, largest))):
            f.store(entry, kind, largest)
            f.store(i, INTEGER, exchanged, k)
    row = f.load(INTEGER, exchanged, k)
    with f.when(row.compare("!=", k)), f.repeat(size) as j:
        _swap(f, kind, matrix, k * size + j, row * size + j)


def _swap(f: Function, kind: str, array: Value, value: Value, other: Value) -> None:
    first, second = f.load(kind, array, value), f.load(kind, array, other)
    f.store(second, kind, array, value)
    f.store(first, kind, array, other)


def solve(f: Function, kind: str, matrix: Value, vector: Value, size: int, exchanged: Value | None = None) -> None:
    """vector <- (L U)^-1 vector, its rows ``exchanged`` as those of the matrix were."""
    if exchanged is not None:
        with f.repeat(size) as k:
            _swap(f, kind, vector, k, f.load(INTEGER, exchanged, k))
    with f.repeat(size) as i, f.repeat(i) as j:
        entry = f.load(kind, vector, i) - f.load(kind, matrix, i * size + j) * f.load(kind, vector, j)
        f.store(entry, kind, vector, i)
    with f.repeat(size) as back:
        i = (size - 1) - back
        with f.repeat(size, i + 1) as j:
            entry = f.load(kind, vector, i) - f.load(kind, matrix, i * size + j) * f.load(kind, vector, j)
            f.store(entry, kind, vector, i)
        f.store(f.load(kind, vector, i) / f.load(kind, matrix, i * (size + 1)), kind, vector, i)
