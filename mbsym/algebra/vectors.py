"""Vectors and tensors over any algebra, each with the frame whose axes its components belong to.

The recursions in ``mbsym.mechanics`` read as their formulas with them,

    a + epsilon.cross(r) + omega.cross(omega.cross(r)),        J @ epsilon + omega.cross(J @ omega),

and components in different axes cannot be mixed: the frame is part of a vector's type.  It changes where a turn is
applied (``mbsym.mechanics.frames``), or by name where the axes are parallel.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Generic

from mbsym.algebra.base import Algebra, Components, S

Rows = tuple[Components[S], Components[S], Components[S]]


class FramesDiffer(TypeError):
    """Vectors in the axes of two frames met in one operation: a mistake of the program, not of a description."""

    def __init__(self, left: str, right: str) -> None:
        super().__init__(f"a vector in the axes of {left!r} meets one in the axes of {right!r}")
        self.left, self.right = left, right


class Vector(Generic[S]):
    """Three components in the axes of ``frame``, a name; + - and products with a scalar of the algebra.

    u.dot(v) = u1 v1 + u2 v2 + u3 v3,  u.cross(v) = (u2 v3 - u3 v2, u3 v1 - u1 v3, u1 v2 - u2 v1),  both in the normal
    form of the algebra.  What takes two vectors raises FramesDiffer where their frames do.
    """

    __slots__ = ("algebra", "components", "frame")

    def __init__(self, algebra: Algebra[S], components: Components[S], frame: str) -> None:
        self.algebra = algebra
        self.components = components
        self.frame = frame

    def __repr__(self) -> str:
        return f"Vector({self.components!r} in the axes of {self.frame!r})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Vector) and self.frame == other.frame and self.components == other.components

    def __hash__(self) -> int:
        return hash((self.components, self.frame))

    def __iter__(self) -> Iterator[S]:
        return iter(self.components)

    def __len__(self) -> int:
        return 3

    def __getitem__(self, place: int) -> S:
        return self.components[place]

    def __add__(self, other: Vector[S]) -> Vector[S]:
        if self.frame != other.frame:
            raise FramesDiffer(self.frame, other.frame)
        (a, b, c), (x, y, z) = self.components, other.components
        return Vector(self.algebra, (a + x, b + y, c + z), self.frame)

    def __sub__(self, other: Vector[S]) -> Vector[S]:
        if self.frame != other.frame:
            raise FramesDiffer(self.frame, other.frame)
        (a, b, c), (x, y, z) = self.components, other.components
        return Vector(self.algebra, (a - x, b - y, c - z), self.frame)

    def __neg__(self) -> Vector[S]:
        a, b, c = self.components
        return Vector(self.algebra, (-a, -b, -c), self.frame)

    def __mul__(self, factor: S) -> Vector[S]:
        times, (a, b, c) = self.algebra.times, self.components
        return Vector(self.algebra, (times(factor, a), times(factor, b), times(factor, c)), self.frame)

    def dot(self, other: Vector[S]) -> S:
        if self.frame != other.frame:
            raise FramesDiffer(self.frame, other.frame)
        return self.algebra.dot(self.components, other.components)

    def cross(self, other: Vector[S]) -> Vector[S]:
        if self.frame != other.frame:
            raise FramesDiffer(self.frame, other.frame)
        dot, (a, b, c), (x, y, z) = self.algebra.dot, self.components, other.components
        return Vector(self.algebra, (dot((b, -c), (z, y)), dot((c, -a), (x, z)), dot((a, -b), (y, x))), self.frame)

    def map(self, function: Callable[[S], S]) -> Vector[S]:
        """function(x) of every component, in the same axes; values of the same algebra."""
        a, b, c = self.components
        return Vector(self.algebra, (function(a), function(b), function(c)), self.frame)

    def reduced(self) -> Vector[S]:
        """Every component in the normal form of the algebra."""
        return self.map(self.algebra.reduce)

    def vanishes(self) -> bool:
        """Whether every component is zero as it stands."""
        vanishes, (a, b, c) = self.algebra.vanishes, self.components
        return vanishes(a) and vanishes(b) and vanishes(c)

    def in_parallel(self, frame: str) -> Vector[S]:
        """The same vector in the axes of a frame that are parallel to these."""
        return Vector(self.algebra, self.components, frame)


class Tensor(Generic[S]):
    """A linear map (3 x 3) of vectors in the axes of ``source`` to vectors in those of ``frame``, mostly the same.

    T @ v, the transpose ``T``, sums; ``rows`` and their entries T[i][k] from 0.
    """

    __slots__ = ("algebra", "frame", "rows", "source")

    def __init__(self, algebra: Algebra[S], rows: Rows[S], frame: str, source: str | None = None) -> None:
        self.algebra = algebra
        self.rows = rows
        self.frame = frame
        self.source = frame if source is None else source

    def __repr__(self) -> str:
        return f"Tensor({self.rows!r} from the axes of {self.source!r} to those of {self.frame!r})"

    def __iter__(self) -> Iterator[Components[S]]:
        return iter(self.rows)

    def __len__(self) -> int:
        return 3

    def __getitem__(self, place: int) -> Components[S]:
        return self.rows[place]

    def __matmul__(self, v: Vector[S]) -> Vector[S]:
        if self.source != v.frame:
            raise FramesDiffer(self.source, v.frame)
        dot, (a, b, c), right = self.algebra.dot, self.rows, v.components
        return Vector(self.algebra, (dot(a, right), dot(b, right), dot(c, right)), self.frame)

    def __add__(self, other: Tensor[S]) -> Tensor[S]:
        if self.frame != other.frame or self.source != other.source:
            raise FramesDiffer(self.frame, other.frame)
        sums = [(a + x, b + y, c + z) for (a, b, c), (x, y, z) in zip(self.rows, other.rows, strict=True)]
        return Tensor(self.algebra, (sums[0], sums[1], sums[2]), self.frame, self.source)

    @property
    def T(self) -> Tensor[S]:
        (a, b, c), (d, e, f), (g, h, i) = self.rows
        return Tensor(self.algebra, ((a, d, g), (b, e, h), (c, f, i)), self.source, self.frame)

    def row(self, place: int) -> Vector[S]:
        """Row 0, 1 or 2 as a vector; of a symmetric tensor also the column."""
        return Vector(self.algebra, self.rows[place], self.source)

    def column(self, place: int) -> Vector[S]:
        a, b, c = self.rows
        return Vector(self.algebra, (a[place], b[place], c[place]), self.frame)

    def in_parallel(self, frame: str) -> Tensor[S]:
        """The same tensor of vectors in one frame, in the axes of a frame that are parallel to these."""
        return Tensor(self.algebra, self.rows, frame)


def zero_vector(algebra: Algebra[S], frame: str) -> Vector[S]:
    zero = algebra.zero
    return Vector(algebra, (zero, zero, zero), frame)


def axis_vector(algebra: Algebra[S], axis: int, length: S, frame: str) -> Vector[S]:
    """length * e_axis, axis 1, 2 or 3."""
    zero = algebra.zero
    if axis == 1:
        return Vector(algebra, (length, zero, zero), frame)
    return Vector(algebra, (zero, length, zero) if axis == 2 else (zero, zero, length), frame)


def zero_tensor(algebra: Algebra[S], frame: str) -> Tensor[S]:
    zero = algebra.zero
    row = (zero, zero, zero)
    return Tensor(algebra, (row, row, row), frame)


def tensor_of(algebra: Algebra[S], rows: Sequence[Sequence[S]], frame: str, source: str | None = None) -> Tensor[S]:
    """A tensor from any rows of three."""
    (a, b, c), (d, e, f), (g, h, i) = rows
    return Tensor(algebra, ((a, b, c), (d, e, f), (g, h, i)), frame, source)


def symmetric_tensor(algebra: Algebra[S], rows: Sequence[Sequence[S]], frame: str) -> Tensor[S]:
    """A symmetric tensor from its upper triangle."""
    (a, b, c), (_, d, e), (_, _, f) = rows
    return Tensor(algebra, ((a, b, c), (b, d, e), (c, e, f)), frame)
