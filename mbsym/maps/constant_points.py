"""Exact points of a plane beside an irrational constant c: fields and signs of polynomials p(x, y, c).

What is rational among x and y is put in, and so is y where it is a rational function of an algebraic x; polynomials in
one or two algebraic numbers are left, as at points without a constant.  Three algebraic numbers of which none is a
function of the others are left alone.
"""

from __future__ import annotations

from typing import Any

from flint import Ordering, fmpq, fmpq_mpoly_ctx

from mbsym.algebra.failures import Limit, TooLargeError
from mbsym.algebra.plane import AlgebraicNumber, Point
from mbsym.algebra.plane.elements import ElementMatrix
from mbsym.algebra.plane.fields import Over
from mbsym.algebra.plane.line import univariate
from mbsym.algebra.plane.numbers import sign
from mbsym.algebra.plane.point_field import LineField, PointField
from mbsym.problems.stability.constant import Constant

#: The degree of the field of an algebraic coordinate and the constant, beyond which no verdict is sought there.
MOST_DEGREE = 16

_ONE = fmpq_mpoly_ctx.get(("constant",), Ordering.lex)
_TWO = fmpq_mpoly_ctx.get(("coordinate", "constant"), Ordering.lex)


class ConstantPoint:
    """The point (x, y, c).

    Raises TooLargeError where x, y and c are three algebraic numbers, or of too high a degree together.
    """

    matrix = ElementMatrix

    def __init__(self, point: Point, constant: Constant) -> None:
        x, y = point.x, point.y
        if isinstance(y, Over):
            y.shrink()
        self.point, self.constant = point, constant
        self._beside: Point | None = None
        if point.rational:
            self._places = (_ONE.constant(x), _ONE.constant(y), _ONE.gen(0))
            self._field: LineField | PointField = LineField(constant.number)
            return
        coordinate, c = _TWO.gens()
        if isinstance(x, fmpq):
            self._places, free = (_TWO.constant(x), coordinate, c), y
        elif isinstance(y, fmpq):
            self._places, free = (coordinate, _TWO.constant(y), c), x
        elif len(y.polynomial) == 2:
            powers = enumerate((-y.polynomial[0]).coeffs())
            self._places = (coordinate, sum((coordinate**k * a for k, a in powers), _TWO.constant(0)), c)
            free = x
        else:
            raise TooLargeError("a point with three irrational numbers", limit=Limit.DEGREE)
        if int(free.polynomial.degree()) * int(constant.number.polynomial.degree()) > MOST_DEGREE:
            raise TooLargeError("a point in a number field of a high degree", limit=Limit.DEGREE)
        self._beside = constant.beside(free)
        self._field = PointField(self._beside)

    @property
    def signs(self) -> tuple[int, int]:
        """Of x and y."""
        plane = fmpq_mpoly_ctx.get(("x", "y"), Ordering.lex)
        x, y = (self.point.sign(g) for g in plane.gens())
        return x, y

    def sign(self, p: Any) -> int:
        """The sign of p(x, y, c), exactly."""
        flat = self._flat(p)
        if self._beside is not None:
            return self._beside.sign(flat)
        over = univariate(flat)
        return sign(over[0]) if over.degree() < 1 else self.constant.number.sign(over)

    def value(self, p: Any) -> Any:
        """p(x, y, c) in the field of the point."""
        return self._field.value(self._flat(p))

    def settled(self, p: Any) -> Any:
        """p, or 0 where it vanishes there."""
        return p if p == 0 or self.value(p) else p * 0

    def _flat(self, p: Any) -> Any:
        context = self._places[0].context()
        return p.compose(*self._places, ctx=context) if p != 0 else context.constant(0)


def beside(point: Any, constant: Constant | None) -> Any:
    """What stands for a point of a plane or a line beside a constant; the point itself without one.

    Raises TooLargeError where that is not known how to be looked at.
    """
    if constant is None:
        return point
    if isinstance(point, Point):
        return ConstantPoint(point, constant)
    if isinstance(point, AlgebraicNumber) and (
        int(point.polynomial.degree()) * int(constant.number.polynomial.degree()) > MOST_DEGREE
    ):
        raise TooLargeError("a point in a number field of a high degree", limit=Limit.DEGREE)
    return constant.beside(point)
