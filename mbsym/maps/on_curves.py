"""The exact verdict of problem 6 at an exact point of a section: on a curve, at a corner, at an end of an interval.

The judge is that of rational points (``problems.stability.exact``), over the field that the point's coordinates
generate: no number is rounded, and nothing is said by a limit from either side.
"""

from __future__ import annotations

from fractions import Fraction
from random import Random
from typing import Any

from flint import fmpq

from mbsym.algebra.characteristic import characteristic_polynomial
from mbsym.algebra.matrices import added
from mbsym.algebra.plane import AlgebraicNumber, Point
from mbsym.algebra.plane.numbers import sign
from mbsym.algebra.plane.point_field import LineField, PointField
from mbsym.algebra.rationals import fraction
from mbsym.algebra.roots import RootCount, counted, counted_real
from mbsym.maps.constant_points import ConstantPoint
from mbsym.maps.section import Section
from mbsym.maps.verdicts import Border, Judged
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
