"""The exact verdict of problem 6 at an exact point of a section: on a curve, at a corner, at an end of an interval.

The judge is that of rational points (``problems.stability.exact``), over the field that the point's coordinates
generate: no number is rounded, and nothing is said by a limit from either side.
"""

from __future__ import annotations

from fractions import Fraction
from random import Random
from typing import Any

from flint import Ordering, fmpq, fmpq_mpoly_ctx

from mbsym.algebra.characteristic import characteristic_polynomial
from mbsym.algebra.failures import Limit, TooLargeError
from mbsym.algebra.matrices import added
from mbsym.algebra.plane import AlgebraicNumber, Point
from mbsym.algebra.plane.elements import ElementMatrix
from mbsym.algebra.plane.fields import Over
from mbsym.algebra.plane.line import univariate
from mbsym.algebra.plane.numbers import sign
from mbsym.algebra.plane.point_field import LineField, PointField
from mbsym.algebra.rationals import fraction
from mbsym.algebra.roots import RootCount, counted, counted_real
from mbsym.maps.section import Section
from mbsym.maps.verdicts import Border, Judged
from mbsym.problems.stability.constant import Constant
from mbsym.problems.stability.exact import ExactPoint, PointVerdict, RationalPoint, evaluated, inertia, verdict_over
from mbsym.problems.stability.linear_form import LinearSystem, is_zero
from mbsym.problems.stability.reasons import Because
from mbsym.problems.stability.state_matrix import state_matrix
from mbsym.problems.stability.verdict import combine

#: Random points at which roots are counted to know how many imaginary ones a part has everywhere.
_TRIALS = 3

#: A Point (two axes), a flint.fmpq or an AlgebraicNumber (one axis); with a constant what ``constant_points`` makes.
Place = Any

#: Which kind is told of a point where parts, or roots of one, are of several.
_ORDER = (Border.MASS, Border.ZERO, Border.JORDAN, Border.SEMISIMPLE, Border.IMAGINARY)


class ExactVerdicts:
    """Verdicts at exact points of a section of one or two axes; what does not depend on the point is found once."""

    def __init__(self, section: Section) -> None:
        self.section = section
        self._usual = [_usual(part) for part in section.parts]

    def __call__(self, place: Place) -> Judged:
        """The verdict, the counts and the kind of border at the point."""
        at, signs = _field(place), _signs(place)
        parts, one_energy = self.section.judged(signs)
        found = [verdict_over(part, at) for part in parts]
        verdict = combine((one.verdict for one in found), one_energy)
        signature = [inertia(evaluated(part.K, at)) for part in parts]
        right: int | None = None
        real: int | None = None
        if all(one.roots is not None for one in found):
            right = sum(one.roots.right for one in found if one.roots is not None)
            real = sum(_real(one) for one in found)
        kinds = {_border(part, one, usual, at) for part, one, usual in zip(parts, found, self._usual, strict=True)}
        border = next((kind for kind in _ORDER if kind in kinds), None)
        return Judged(verdict, right, real, sum(x[2] for x in signature), sum(x[1] for x in signature), border)


def _field(place: Place) -> ExactPoint:
    if isinstance(place, ConstantPoint):
        return place
    if isinstance(place, Point):
        if not place.rational:
            return PointField(place)
        return RationalPoint({0: fraction(place.x), 1: fraction(place.y)})
    return LineField(place) if isinstance(place, AlgebraicNumber) else RationalPoint({0: fraction(place)})


def _signs(place: Place) -> tuple[int, ...]:
    if isinstance(place, ConstantPoint):
        return place.signs
    numbers = (place.x, place.y) if isinstance(place, Point) else (place,)
    return tuple(sign(x) if isinstance(x, fmpq) else x.compare(fmpq(0)) for x in numbers)


def _real(found: PointVerdict) -> int:
    """Real roots to the right."""
    if found.roots is None or not found.roots.right:
        return 0
    return counted_real(found.polynomial)[2]


def _usual(part: LinearSystem) -> tuple[int, int]:
    """(zero roots, imaginary roots) that a part has at most points.

    The power of lambda that divides the determinant is exact; the other is the least count at some random points, and
    used only to leave out what is nothing special.
    """
    polynomial = characteristic_polynomial(part.M, added(part.D, part.G), added(part.K, part.N))
    zeros = next((k for k, c in enumerate(polynomial) if c != 0), 0)
    if is_zero(part.D) and is_zero(part.N) and part.nonholonomic is None:
        return zeros, 2 * part.size
    source, least = Random(20261122), 2 * part.size
    for _ in range(_TRIALS):
        point = {k: Fraction(source.randint(-999, 999), 997) for k in range(part.M[0][0].context().nvars())}
        roots = verdict_over(part, RationalPoint(point)).roots
        least = min(least, roots.imaginary if roots is not None else least)
    return zeros, least


def _border(part: LinearSystem, found: PointVerdict, usual: tuple[int, int], at: ExactPoint) -> Border | None:
    roots = found.roots
    if roots is None:
        return Border.MASS
    if roots.zero > usual[0]:
        return Border.ZERO
    if roots.imaginary_multiplicity > 1:
        return Border.JORDAN if _has_block(part, found, roots, at) else Border.SEMISIMPLE
    return Border.IMAGINARY if roots.imaginary > usual[1] else None


def _has_block(part: LinearSystem, found: PointVerdict, roots: RootCount, at: ExactPoint) -> bool:
    """Whether a multiple imaginary root has a Jordan block."""
    if found.verdict.stable and not roots.right:
        return False
    if found.verdict.because(Because.JORDAN_BLOCK) and roots.zero < 2:
        return True
    m, d, g, k, n = (evaluated(matrix, at) for matrix in part.matrices)
    a = state_matrix(at.matrix, m.tolist(), (d + g).tolist(), (k + n).tolist(), part.following)
    return counted(a.minpoly()).imaginary_multiplicity > 1


# Exact points of a plane beside an irrational constant c: fields and signs of polynomials p(x, y, c).
#
# What is rational among x and y is put in, and so is y where it is a rational function of an algebraic x; polynomials
# in one or two algebraic numbers are left, as at points without a constant.  Three algebraic numbers of which none is
# a function of the others are left alone.


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
