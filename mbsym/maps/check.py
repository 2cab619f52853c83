"""A map checked by another route: more random rational points in every cell, judged without boundary polynomials.

In every cell of every stack (a region is made of several) a random rational point is taken, or several where there are
few cells (spread by Halton's sequence), and there

* the exact judge has to give the verdict and the counts that the region has: a boundary that was lost, or a region
  joined wrongly, shows in another verdict;
* eigenvalues of the numbers' own pencil, enclosed in balls, have to allow the counts: neither the characteristic
  polynomial nor Sturm's chains nor any condition takes part;
* the signs of the boundary polynomials have to be those of the region, and as many branches as in the whole strip to
  lie over the abscissa.

On every arc a second exact point has to have the verdict of the arc. The laws of arrangements (``arrangements.laws``)
are checked besides: Euler's finds corners that were missed. What continuity demands of counts on arcs and at corners
(``continuity``) is the check of corners.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction
from functools import cached_property
from random import Random
from typing import Any

from flint import Ordering, acb_mat, arb, arb_mat, arb_poly, ctx, fmpq, fmpq_mat, fmpq_mpoly_ctx

from mbsym.algebra import rationals
from mbsym.algebra.arrangements.arrangement import Arc, Arrangement, Breach, Piece, breaches, sample_of
from mbsym.algebra.arrangements.stacks import column
from mbsym.algebra.characteristic import characteristic_polynomial
from mbsym.algebra.failures import Limit, TooLargeError
from mbsym.algebra.matrices import added
from mbsym.algebra.plane import AlgebraicNumber
from mbsym.algebra.plane.elements import ElementMatrix, LineField, PointField
from mbsym.algebra.plane.fields import Over, Point
from mbsym.algebra.plane.line import Line
from mbsym.algebra.plane.numbers import Rational, between_simply, high, low, sign, simplest
from mbsym.algebra.plane.projection import nothing
from mbsym.algebra.rationals import fraction
from mbsym.algebra.roots import RootCount, counted, counted_real
from mbsym.algebra.terms import univariate
from mbsym.maps.section import Section
from mbsym.maps.verdicts import Border, Judged, jumps, verdict_at
from mbsym.problems.stability.constant import Constant
from mbsym.problems.stability.enclosed import eigenvalues, on_axis, spectrum
from mbsym.problems.stability.exact import (
    ExactPoint,
    PointVerdict,
    RationalPoint,
    evaluated,
    inertia,
    state_at,
    verdict_over,
)
from mbsym.problems.stability.linear_form import LinearSystem, Matrix, is_zero, state_matrix
from mbsym.problems.stability.verdict import Verdict
from mbsym.problems.stability.words import Because, Word

# The exact verdict of problem 6 at an exact point of a section: on a curve, at a corner, at an end of an interval.
#
# The judge is that of rational points (``problems.stability.exact``), over the field that the point's coordinates
# generate: no number is rounded, and nothing is said by a limit from either side.


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
        verdicts = [verdict_over(part, at) for part in parts]
        verdict = self.section.whole((point_verdict.verdict for point_verdict in verdicts), one_energy)
        signature = [inertia(evaluated(part.K, at)) for part in parts]
        right: int | None = None
        real: int | None = None
        if all(point_verdict.roots is not None for point_verdict in verdicts):
            right = sum(point_verdict.roots.right for point_verdict in verdicts if point_verdict.roots is not None)
            real = sum(_real(point_verdict) for point_verdict in verdicts)
        kinds = {_border(part, word, usual, at) for part, word, usual in zip(parts, verdicts, self._usual, strict=True)}
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


def _real(point_verdict: PointVerdict) -> int:
    """Real roots to the right."""
    if point_verdict.roots is None or not point_verdict.roots.right:
        return 0
    return counted_real(point_verdict.polynomial)[2]


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


def _border(part: LinearSystem, point_verdict: PointVerdict, usual: tuple[int, int], at: ExactPoint) -> Border | None:
    roots = point_verdict.roots
    if roots is None:
        return Border.MASS
    if roots.zero > usual[0]:
        return Border.ZERO
    if roots.imaginary_multiplicity > 1:
        return Border.JORDAN if _has_block(part, point_verdict, roots, at) else Border.SEMISIMPLE
    return Border.IMAGINARY if roots.imaginary > usual[1] else None


def _has_block(part: LinearSystem, point_verdict: PointVerdict, roots: RootCount, at: ExactPoint) -> bool:
    """Whether a multiple imaginary root has a Jordan block."""
    if point_verdict.verdict.stable and not roots.right:
        return False
    if point_verdict.verdict.because(Because.JORDAN_BLOCK) and roots.zero < 2:
        return True
    return counted(state_at(part, at).minpoly()).imaginary_multiplicity > 1


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


#: In maps of few cells every cell is tried more than once, until so many points are.
FEWEST = 96
#: Binary digits of the enclosures; where they leave a count open, twice as many, up to the second number.
BITS, MOST_BITS = 128, 1024


class Mistake(StrEnum):
    """What does not agree."""

    VERDICT = "another verdict at a second point"
    COUNT = "other counts of roots or eigenvalues at a second point"
    BALLS = "counts that enclosures of the eigenvalues exclude"
    SIGNS = "other signs of the boundary polynomials at a second point"
    BRANCHES = "another number of branches over a second abscissa"
    LAW = "a law of arrangements"
    JUMP = "counts on a curve that continuity excludes"


@dataclass(frozen=True)
class Finding:
    """A disagreement in a region, on an arc or at a corner, at about ``near``; of a law, ``breach`` says which."""

    mistake: Mistake
    region: int | None = None
    arc: int | None = None
    near: tuple[float, ...] = ()
    breach: Breach | None = None
    corner: int | None = None


@dataclass(frozen=True)
class Check:
    """``points`` were tried in cells, ``arcs`` on arcs; at ``enclosed`` of the points balls decided all counts."""

    points: int
    arcs: int
    enclosed: int
    findings: tuple[Finding, ...]

    @property
    def holds(self) -> bool:
        return not self.findings


Verdicts = Sequence[Judged | None]  # None: no verdict is asked for there


def check(
    section: Section,
    decomposition: Arrangement | Line,
    regions: Verdicts,
    arcs: Verdicts = (),
    corners: Verdicts = (),
    seed: int = 20261122,
    progress: Callable[[str, int, int], None] = nothing,
) -> Check:
    """Every cell of a map by another route; ``regions``, ``arcs``, ``corners`` are verdicts that are to be confirmed.

    Of a line the regions are its intervals, the corners its zeros.
    """
    checking = _Checking(section, Random(seed))
    doubted = jumps(decomposition, regions, arcs, corners)
    checking.findings += [Finding(Mistake.JUMP, arc=k) for k in doubted[0]]
    checking.findings += [Finding(Mistake.JUMP, corner=k) for k in doubted[1]]
    if isinstance(decomposition, Line):
        count = len(decomposition.intervals)
        for at, interval in enumerate(decomposition.intervals * (1 + FEWEST // count)):
            progress("check", at, max(FEWEST, count))
            first, last = interval.ends
            below = decomposition.low if first is None else decomposition.zeros[first].number
            above = decomposition.high if last is None else decomposition.zeros[last].number
            x = checking.between(below, above, checking.share(2, at // count, (at % count, 0)))
            checking.region(interval.id, regions[interval.id], (x,), interval.signs, decomposition.factors)
        return checking.result()
    checking.findings += [Finding(Mistake.LAW, arc=x.arc, breach=x) for x in breaches(decomposition)]
    cells = sum(len(each.sections) - 1 for each in decomposition.columns)
    strips = [*range(len(decomposition.columns))] * (1 + FEWEST // cells)
    for at, strip in enumerate(strips):
        progress("check", at, len(strips))
        checking.strip(decomposition, strip, regions, at // len(decomposition.columns))
    for arc, judged in zip(decomposition.arcs, arcs, strict=False):
        if judged is not None:
            checking.arc(decomposition, arc, judged)
    progress("check", len(strips), len(strips))
    return checking.result()


def check_boxes(
    section: Section,
    tried: Sequence[tuple[int, Judged, tuple[Rational, Rational]]],
    verdict: Callable[[Rational, Rational], Verdict] | None = None,
    seed: int = 20261123,
    progress: Callable[[str, int, int], None] = nothing,
) -> Check:
    """(number, verdict, a point) of boxes: the exact verdict at the point, and balls, have to allow the box's one.

    Where a box's counts are not known its verdict may say less than that of a point; unstable and not must not mix.
    ``verdict`` gives the one at a point where the section has no matrices; where it is undecided nothing is compared.
    """
    checking = _Checking(section, Random(seed))
    for at, (number, judged, point) in enumerate(tried):
        progress("check", at, len(tried))
        there = checking.at(point) if verdict is None else verdict(*point)
        if there.word is not Word.UNDECIDED or judged.right is not None:
            checking.box(number, judged, point, there)
    return checking.result()


class _Checking:
    def __init__(self, section: Section, source: Random) -> None:
        self.section, self.source = section, source
        self.findings: list[Finding] = []
        self.points = self.arcs = self.enclosed = 0
        self._starts: dict[tuple[int, int, int], int] = {}

    def result(self) -> Check:
        return Check(self.points, self.arcs, self.enclosed, tuple(self.findings))

    def share(self, base: int, at: int, key: tuple[int, int]) -> Rational:
        """Element ``at`` of a sequence that fills (0, 1) evenly from a random start, which belongs to a ``key``."""
        start = self._starts.setdefault((base, *key), self.source.randint(1, 996))
        numerator, weight = 0, 1
        while at:
            weight *= base
            numerator, at = numerator * base + at % base, at // base
        whole = (fmpq(numerator, weight) * 997).floor()
        return fmpq((start + int(whole) - 1) % 996 + 1, 997)

    def between(self, below: Any, above: Any, share: Rational) -> Rational:
        """A rational number strictly between two exact ones."""
        between_simply(below, above)  # their intervals do not touch any more
        a, b = high(below), low(above)
        # The ends may have thousands of digits, which nothing computed from them should inherit.
        x, slack = a + (b - a) * share, (b - a) * min(share, 1 - share) / 64
        return simplest(x - slack, x + slack)

    def strip(self, arrangement: Arrangement, strip: int, regions: Verdicts, at: int) -> None:
        """A point in each cell of a strip, over one abscissa, for the time ``at``."""
        left, right = (arrangement.fibres[strip + k].abscissa.x for k in (0, 1))
        x = self.between(left, right, self.share(2, at, (strip, -1)))
        there = column(arrangement.curves, arrangement.box, x)
        expected = arrangement.columns[strip].sections
        if [section.curve for section in there.sections] != [section.curve for section in expected]:
            self.findings.append(Finding(Mistake.BRANCHES, near=(float(x),)))
            return
        for cell in range(len(expected) - 1):
            y = self.between(there.sections[cell].y, there.sections[cell + 1].y, self.share(3, at, (strip, cell)))
            region = arrangement.places.cells[strip, cell]
            self.region(region, regions[region], (x, y), arrangement.regions[region].signs, arrangement.factors)

    def region(
        self,
        number: int,
        judged: Judged | None,
        point: tuple[Rational, ...],
        signs: tuple[int, ...],
        factors: Sequence[Any],
    ) -> None:
        """One more point of a region or interval."""
        self.points += 1
        wrong: list[Mistake] = []
        if tuple(sign(p(*point)) for p in factors) != signs:
            wrong.append(Mistake.SIGNS)
        if judged is not None:
            wrong += _differences(self._judged(point), judged)
            agrees, decided = self._enclosed(point, judged)
            self.enclosed += decided
            if not agrees:
                wrong.append(Mistake.BALLS)
        near = tuple(map(float, point))
        self.findings += [Finding(mistake, region=number, near=near) for mistake in wrong]

    def at(self, point: tuple[Rational, Rational]) -> Verdict:
        return self._judged(point).verdict

    def box(self, number: int, judged: Judged, point: tuple[Rational, Rational], there: Verdict) -> None:
        """A point of a box; findings count it as a region."""
        if judged.right is not None:
            self.region(number, judged, point, (), ())
            return
        self.points += 1
        if (there.word is Word.UNSTABLE) != (judged.verdict.word is Word.UNSTABLE):
            self.findings.append(Finding(Mistake.VERDICT, region=number, near=tuple(map(float, point))))

    def arc(self, arrangement: Arrangement, arc: Arc, judged: Judged) -> None:
        """A second exact point of an arc."""
        point = self._second(arrangement, arc, self.source.choice(arc.pieces))
        try:
            there = self._exact(beside(point, self.section.constant))
        except TooLargeError:  # not counted among those tried
            return
        self.arcs += 1
        wrong = _differences(there, judged)
        self.findings += [Finding(mistake, arc=arc.id, near=point.floats()) for mistake in wrong]

    @cached_property
    def _exact(self) -> ExactVerdicts:
        return ExactVerdicts(self.section)

    def _judged(self, point: tuple[Rational, ...]) -> Judged:
        """The exact verdict at a rational point."""
        constant = self.section.constant
        if constant is None:
            return verdict_at(self.section, point)
        return self._exact(beside(Point(*point) if len(point) > 1 else point[0], constant))

    def _second(self, arrangement: Arrangement, arc: Arc, piece: Piece) -> Point:
        fibre = arrangement.fibres[piece.strip]
        if piece.vertical:
            below, above = (fibre.points[piece.section + k].y for k in (0, 1))
            return Point(fibre.abscissa.x, self.between(below, above, fmpq(1, 3)))
        x = self.between(fibre.abscissa.x, arrangement.fibres[piece.strip + 1].abscissa.x, fmpq(1, 4))
        return Point(x, sample_of(column(arrangement.curves, arrangement.box, x).sections[piece.section].y))

    def _enclosed(self, point: tuple[Rational, ...], judged: Judged) -> tuple[bool, bool]:
        """(whether balls allow the counts, whether they decide them)"""
        bits = BITS
        known: list[tuple[Range, Range]] = []
        while len(known) < len(self.section.parts):
            if bits > MOST_BITS:
                return True, False
            with ctx.workprec(bits):
                ranges = [_counted(part, point, self.section.constant, bits) for part in self.section.parts]
            known = [bounds for bounds in ranges if bounds is not None]
            bits *= 2
        agrees, decided = True, True
        for k, value in enumerate((judged.right, judged.degree)):
            least, most = sum(bounds[k][0] for bounds in known), sum(bounds[k][1] for bounds in known)
            agrees &= value is None or least <= value <= most
            decided &= least == most
        return agrees, decided


def _differences(there: Judged, judged: Judged) -> list[Mistake]:
    """How a verdict at a second point differs."""
    wrong = []
    if there.verdict.word is not judged.verdict.word:
        wrong.append(Mistake.VERDICT)
    counts = [(side.right, side.real_right, side.degree, side.null) for side in (there, judged)]
    if counts[0] != counts[1]:
        wrong.append(Mistake.COUNT)
    return wrong


Range = tuple[int, int]


def _counted(
    part: LinearSystem, point: Sequence[Rational], constant: Constant | None, bits: int
) -> tuple[Range, Range] | None:
    """((least, most) roots to the right, the same of negative eigenvalues of K) of a part, by balls.

    None where eigenvalues cannot be enclosed.
    """
    m, d, g, k, n = (_in_balls(matrix, point, constant, bits) for matrix in part.matrices)
    try:
        if constant is None:
            roots, simple = _nonzero_roots(part, point)
        else:
            roots, simple = eigenvalues(m.tolist(), (d + g).tolist(), (k + n).tolist(), part.following)
    except ZeroDivisionError:
        return None
    stiffness = _spectrum(k)
    if roots is None or stiffness is None:
        return None
    least, most = sum(bool(x.real > 0) for x in roots), sum(not x.real < 0 for x in roots)
    symmetric = part.nonholonomic is None and all(x == 0 for rows in (d, n) for x in rows.entries())  # exactly zero
    if symmetric and simple:
        most -= sum(1 for x in roots if x.real.contains(0) and on_axis(x, roots))
    negative = sum(bool(x < 0) for x in stiffness)
    null = [x for x in stiffness if x.contains(0)]
    known = constant is None and len(null) == part.size - _rank(part.K, point)
    return (least, most), (negative, negative if known else sum(not x > 0 for x in stiffness))


def _nonzero_roots(part: LinearSystem, point: Sequence[Rational]) -> tuple[list[Any] | None, bool]:
    """(balls around the roots that are not zero at a rational point, whether they are isolated from each other).

    They are the eigenvalues of A, an N x N matrix, on the image of A^N, of which a basis B is found exactly:
    those of X with A B = B X.
    """
    at = RationalPoint({k: rationals.fraction(x) for k, x in enumerate(point)})
    m, d, g, k, n = (evaluated(matrix, at) for matrix in part.matrices)
    first = state_matrix(fmpq_mat, m.tolist(), (d + g).tolist(), (k + n).tolist(), part.following)
    power = first
    for _ in range(first.nrows() - 1):
        power = power * first
    rows, rank = power.transpose().rref()
    if not rank:
        return [], True
    basis = fmpq_mat(rows.tolist()[:rank]).transpose()
    turned = basis.transpose()
    return spectrum(acb_mat((turned * basis).solve(turned * first * basis)))


def _rank(matrix: Matrix, point: Sequence[Rational]) -> int:
    return int(fmpq_mat(len(matrix), len(matrix), [fmpq(x(*point)) for row in matrix for x in row]).rank())


def _in_balls(matrix: Matrix, point: Sequence[Rational], constant: Constant | None, bits: int) -> Any:
    """A matrix of polynomials in the axes, and perhaps a constant, as balls."""
    n = len(matrix)
    if constant is None:
        at = RationalPoint({k: rationals.fraction(x) for k, x in enumerate(point)})
        return arb_mat(evaluated(matrix, at))
    flat = [[constant.polynomial_at(entry, point) for entry in row] for row in matrix]
    c = constant.number.enclosure(bits)
    values: list[Any] = [arb_poly(entry)(c) if entry != 0 else arb(0) for row in flat for entry in row]
    return arb_mat(n, n, values)


def _spectrum(matrix: Any) -> list[Any] | None:
    """Balls around the eigenvalues of a matrix with real ones, as real balls."""
    try:
        return [x.real for x in acb_mat(matrix).eig(multiple=True)]
    except ValueError:
        return None
