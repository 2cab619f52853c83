"""Soft or hard: what becomes of a motion on the border at which a pair of roots becomes imaginary.

At an exact point of an arc where problem 6 finds one pair +-i w and all other roots to the left, terms of third order
decide (problem 11):  r' = a r^3 + ... on the centre manifold.  a < 0: the motion is asymptotically stable on the border
and small stable oscillations arise beyond it (soft).  a > 0: it is unstable on the border already (hard).  Both are
said only where stability is lost: of the cells beside the arc one has roots to the right, the other none.  Elsewhere
(x'' + (p^2 + x^2) x' + x = 0 is asymptotically stable at p = 0 and on both sides of it) the border is neither.  Zero
roots, more pairs and systems without such an expansion are left open, with the reason.

``at`` decides at a point, by enclosures; that the pair is imaginary is known exactly.  ``along`` decides on a whole
arc: a is a fraction of polynomials on the curve, its zeros and poles are among the real roots of resultants, and one
point between two neighbouring ones stands for all (``normal_forms.on_curve``); there both routes have to agree.

Source: N. N. Bautin, The Behaviour of Dynamical Systems near the Boundaries of the Stability Region (1949).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from itertools import pairwise
from typing import Any

from flint import acb, acb_poly, arb, ctx, fmpq, fmpq_poly

from mbsym.algebra import rationals
from mbsym.algebra.arrangements import Arrangement
from mbsym.algebra.arrangements.arrangement import Arc, Piece, sample_of
from mbsym.algebra.factors import irreducible_factors
from mbsym.algebra.failures import Failure, Limit, TooLargeError
from mbsym.algebra.plane import Point
from mbsym.algebra.plane.numbers import Root, between_simply, compare, enclosure, primitive, roots_between
from mbsym.algebra.plane.numbers import high as upper
from mbsym.algebra.plane.numbers import low as lower
from mbsym.algebra.plane.projection import Curve, coefficients
from mbsym.algebra.tower import Element, Tower
from mbsym.analysis import Analysis
from mbsym.analysis.higher import ignorable
from mbsym.expressions.message import Told
from mbsym.maps.images import Images
from mbsym.maps.section import Section, in_velocities
from mbsym.problems.normal_forms.along import judged_enclosed
from mbsym.problems.normal_forms.dissipative import state_field
from mbsym.problems.normal_forms.exact import OnCurve, on_curve
from mbsym.problems.normal_forms.expansion import Expansion, Numbers, expansion
from mbsym.problems.normal_forms.problem import PRECISION
from mbsym.problems.normal_forms.result import Judged as Higher
from mbsym.problems.normal_forms.result import Outcome, Theorem, Why

#: Resultants of a higher degree than this are not formed: the arc is decided at its point then.
MOST_DEGREE = 2_000


class Onset(Told):
    """How stability is lost where a pair of roots becomes imaginary."""

    SOFT = "soft", "soft: asymptotically stable at the border, small oscillations arise beyond"
    HARD = "hard", "hard: unstable at the border already"
    OPEN = "open", "open whether soft or hard: terms of third order do not decide, or are not at hand"
    #: Nothing is lost there, or that is not known.
    NEITHER = (
        "neither",
        "neither soft nor hard: roots are to the right on both sides or on none, one side is not judged, or the "
        "equations are exactly linear",
    )


class Missing(StrEnum):
    """Why there is no field to be expanded; other reasons are those of problem 11."""

    CONSTRAINTS = "constraints"
    #: There are no terms of higher order.
    LINEAR = "exactly-linear"
    CONDITIONS = "unsolved-conditions"
    EXPANSION = "no-expansion"
    #: Of what is neither soft nor hard: both cells beside have roots to the right, or none has; or one of them is not
    #: in the map or not judged.
    NO_LOSS = "no-loss"
    ONE_SIDE = "one-side"


@dataclass(frozen=True)
class Stretch:
    """A part of an arc between two values of an axis, in the arc's order; on the open part ``onset`` holds.

    ``axis``: 0, or 1 along a line on which the first axis is constant.
    """

    start: Any
    end: Any
    onset: Onset
    axis: int = 0


@dataclass(frozen=True)
class SoftOrHard:
    """``onset`` at the exact point; +-i ``frequency``, a = ``coefficient`` of r' = a r^3, r that of ``amplitude_of``.

    ``stretches``: the whole arc but for their ends, neighbours of different onset; one: the onset is that of all points
    of the arc but for its corners.  None: nothing is said but of the point.  ``why``: of an open one.
    """

    onset: Onset
    why: Why | Missing = Why.NONE
    frequency: Any = None
    coefficient: Any = None
    amplitude_of: str = ""
    stretches: tuple[Stretch, ...] | None = None


def lost(beside: Sequence[int | None]) -> Missing | None:
    """None where stability is lost between cells with so many roots to the right (None: not known); or why not."""
    known = {count for count in beside if count is not None}
    if 0 in known and len(known) > 1:
        return None
    return Missing.ONE_SIDE if None in beside or not beside else Missing.NO_LOSS


class SoftBorders:
    """Decides points and arcs of a section; the expansion is formed when it is first needed."""

    def __init__(self, analysis: Analysis, section: Section) -> None:
        self.analysis = in_velocities(analysis)
        self.section = section
        self._along: dict[int, _Along | None] = {}

    @cached_property
    def _expanded(self) -> tuple[Expansion, Images] | Missing:
        system = self.analysis.system
        if system.constraints:
            return Missing.CONSTRAINTS
        if system.linear is not None or self.analysis.balance.exactly_linear:
            return Missing.LINEAR
        try:
            motion = self.analysis.equilibrium
            if len(motion.conditions) > len(motion.solved):
                return Missing.CONDITIONS
            _, cyclic = ignorable(self.analysis)
            scene = self.analysis.parameters_scene
            series = expansion(scene, system, motion, 4, cyclic)
        except (Failure, ZeroDivisionError):
            return Missing.EXPANSION
        axes = [axis.name for axis in self.section.axes]
        solved = {name: value.polynomial for name, value in motion.solved}
        there, constant = self.section, self.section.constant
        if constant is not None and constant.text in system.parameter_names and not constant.images:
            # the irrational value of the third axis of slices
            constant = replace(constant, images={scene.ring.index("parameter", constant.text): fmpq_poly([0, 1])})
        return series, Images(scene, axes, there.context, there.numbers, solved, constant)

    def at(self, place: Any) -> SoftOrHard:
        """At an exact point (of a line: an exact number) at which a pair of roots is imaginary."""
        expanded = self._expanded
        if isinstance(expanded, Missing):
            return SoftOrHard(Onset.NEITHER if expanded is Missing.LINEAR else Onset.OPEN, expanded)
        numbers = place.enclosures(PRECISION) if isinstance(place, Point) else (enclosure(place, PRECISION),)
        with ctx.workprec(PRECISION):
            return self._at(numbers)

    def _at(self, numbers: Sequence[Any]) -> SoftOrHard:
        expanded = self._expanded
        assert not isinstance(expanded, Missing)
        series, images = expanded
        constant = self.section.constant
        point = [*numbers, *([] if constant is None else [constant.number.enclosure(PRECISION)])]

        def carry(p: Any) -> acb:
            top, bottom = images(p)
            return acb(rationals.value_at(top, point, arb)) / acb(rationals.value_at(bottom, point, arb))

        try:
            field = state_field(Numbers(series, carry, lambda x: 1 / x, acb(0), acb(1)))
        except (Failure, ZeroDivisionError):
            return SoftOrHard(Onset.OPEN, Missing.EXPANSION)
        return _told(judged_enclosed(*field, ("pair",)))

    def along(self, made: Arrangement, arc: Arc) -> SoftOrHard:
        """On an arc: at its point, and on all of it where formulas are small enough."""
        there = self.at(arc.point)
        # Where the coefficient vanishes at the arc's point it need not beside it.
        if there.onset is Onset.NEITHER or (there.onset is Onset.OPEN and there.why is not Why.COEFFICIENT_OPEN):
            return there
        if self.section.constant is not None:
            return there
        if arc.pieces[0].vertical:
            with ctx.workprec(PRECISION):
                return replace(there, stretches=self._up(made, arc))
        curve = next(k for k, candidate in enumerate(made.curves) if set(candidate.of) & set(arc.factors))
        with ctx.workprec(PRECISION):
            if curve not in self._along:
                self._along[curve] = self._formula(made.curves[curve].polynomial, arc)
            formula = self._along[curve]
            stretches = None if formula is None else _stretches(self, formula, made, arc, curve)
        return replace(there, stretches=stretches)

    def _up(self, made: Arrangement, arc: Arc) -> tuple[Stretch, ...] | None:
        """Stretches of a line on which the first axis is constant; None where a sign is not told."""
        piece, x = arc.pieces[0], arc.point.x
        points = made.fibres[piece.strip].points
        ends = [points[piece.section + k].y for k in (0, 1)]
        if not isinstance(x, fmpq) or not all(isinstance(y, (fmpq, Root)) for y in ends):
            return None
        formula = self._formula(self.section.context.gen(0) - x, arc, 1)
        if formula is None:
            return None
        across = enclosure(x, PRECISION)
        runs = _runs(self, formula, [ends[0], *formula.between(*ends), ends[1]], lambda ball: (across, ball))
        return None if runs is None else tuple(runs)

    def _formula(self, curve: Any, arc: Arc, axis: int = 0) -> _Along | None:
        """a on a curve along an axis; None where it outgrows its budgets, or the curve is another one."""
        expanded = self._expanded
        assert not isinstance(expanded, Missing)
        series, images = expanded
        tower = Tower([axis.name for axis in self.section.axes])
        gens = [tower.parameter(name).top for name in tower.parameters]
        values = dict(zip(tower.parameters, arc.point.enclosures(PRECISION), strict=True))

        def carry(p: Any) -> Element:
            top, bottom = (x.compose(*gens, ctx=tower.context) for x in images(p))
            return tower.made(top, bottom)

        def size(x: Element) -> float:
            value = tower.enclosed(x, values)
            return 0.0 if value.contains(0) else float(abs(value).mid())

        try:
            field, positions = state_field(Numbers(series, carry, tower.reciprocal, tower.zero, tower.one))
            whole = on_curve(tower, field, positions, size)
            return _Along(whole, curve, axis) if _lies_on(whole, curve) else None
        except (Failure, ZeroDivisionError):
            return None


def _told(judged: Higher) -> SoftOrHard:
    """What problem 11 says, in the words of borders."""
    onset = Onset.OPEN
    cubic = judged.degree is None  # of another power the border is neither soft nor hard
    if judged.theorem is Theorem.REDUCTION and judged.coefficient is not None and judged.amplitude_of and cubic:
        onset = Onset.SOFT if judged.outcome is Outcome.ASYMPTOTIC else Onset.HARD
    frequency = judged.frequencies[0] if judged.frequencies else None
    why = Why.NONE if onset is not Onset.OPEN else judged.why if cubic else Why.COEFFICIENT_OPEN
    return SoftOrHard(onset, why, frequency, judged.coefficient if cubic else 0, judged.amplitude_of)


def _plane(x: Any, curve: Any) -> Any:
    """A polynomial of a tower without roots in the context of a curve's."""
    context, skipped = curve.context(), x.context().nvars() - 2
    return context.from_dict({tuple(map(int, powers))[skipped:]: value for powers, value in x.to_dict().items()})


def _lies_on(whole: OnCurve, curve: Any) -> bool:
    """Whether E and O have a common root all along the curve, exactly."""
    return whole.resultant.is_zero() or divmod(_plane(whole.resultant.top, curve), curve)[1] == 0


class _Along:
    """a along one curve, by the values of an ``axis``: where its sign may change, and its sign at a point."""

    def __init__(self, whole: OnCurve, curve: Any, axis: int = 0) -> None:
        self.curve, self.axis = curve, axis
        self.top, self.bottom = (_plane(x, curve) for x in (whole.coefficient.top, whole.coefficient.bottom))
        watched = [self.top, self.bottom]
        watched += [_plane(x, curve) for part in (whole.slope, whole.constant) for x in (part.top, part.bottom)]
        self.critical = list(self._abscissas(watched))

    def _abscissas(self, watched: Sequence[Any]) -> Iterator[Any]:
        """Polynomials along the axis that vanish where one of the watched does on the curve.  Raises TooLargeError."""
        seen, other = set(), 1 - self.axis
        for p in watched:
            for factor, _ in [] if p.is_constant() else irreducible_factors(p)[1]:
                if factor.is_constant() or str(factor) in seen:
                    continue
                seen.add(str(factor))
                a, b = factor.degrees(), self.curve.degrees()
                if int(a[0]) * int(b[1]) + int(a[1]) * int(b[0]) > MOST_DEGREE:
                    raise TooLargeError("a resultant of a high degree", limit=Limit.DEGREE)
                met = factor if not a[other] else factor.resultant(self.curve, other)
                if met == 0:
                    raise TooLargeError("it vanishes all along the curve", limit=Limit.DEGREE)
                yield coefficients(met, other)[0]

    def between(self, low: Any, high: Any) -> list[Any]:
        """The critical abscissas between two exact numbers, in order, each once."""
        whole = fmpq_poly([1])
        for factor in self.critical:
            whole *= factor
        if whole.degree() < 1:
            return []
        square_free = primitive(whole / whole.gcd(whole.derivative()))
        samples = [sample_of(root) for root in roots_between(square_free, lower(low), upper(high))]
        return [x for x in samples if compare(low, x) < 0 and compare(x, high) < 0]

    def sign(self, x: Any, y: Any) -> int:
        """Of a at enclosed numbers; 0 where it is not told."""
        value = rationals.value_at(self.top, (x, y), arb) * rationals.value_at(self.bottom, (x, y), arb)
        return 1 if value > 0 else -1 if value < 0 else 0


def _stretches(
    borders: SoftBorders, formula: _Along, made: Arrangement, arc: Arc, curve: int
) -> tuple[Stretch, ...] | None:
    """Stretches of one sign of a; None where a point of the arc could not be told."""
    stretches: list[Stretch] = []
    for piece in arc.pieces:
        new = _of_piece(borders, formula, made, piece, curve)
        if new is None:
            return None
        if piece.backwards:
            new = [Stretch(stretch.end, stretch.start, stretch.onset) for stretch in reversed(new)]
        if stretches and stretches[-1].onset is new[0].onset and _same_between(borders, made, piece, new[0].onset):
            stretches[-1:] = [Stretch(stretches[-1].start, new[0].end, new[0].onset)]
            new = new[1:]
        stretches += new
    if arc.corners == (None, None) and not _same_between(borders, made, arc.pieces[0], stretches[0].onset):
        return None  # closed: where it starts is a point of it
    return tuple(stretches)


def _same_between(borders: SoftBorders, made: Arrangement, piece: Piece, onset: Onset) -> bool:
    """Whether the point from which a piece goes on has the same onset."""
    right = piece.backwards
    fibre = made.fibres[piece.strip + right]
    firsts = fibre.left if right else fibre.right
    j = next(j for j in range(len(firsts) - 1) if firsts[j] <= piece.section < firsts[j + 1])
    return borders.at(Point(fibre.abscissa.x, fibre.points[j].y)).onset is onset


def _of_piece(
    borders: SoftBorders, formula: _Along, made: Arrangement, piece: Piece, curve: int
) -> list[Stretch] | None:
    """Stretches of a piece from left to right; None where a sign is not told."""
    sections = made.columns[piece.strip].sections
    place = sum(1 for section in sections[: piece.section] if section.curve == curve)
    count = sum(1 for section in sections if section.curve == curve)
    ends = [made.fibres[piece.strip + k].abscissa.x for k in (0, 1)]

    def point(x: Any) -> tuple[Any, Any] | None:
        y = _ordinate(made.curves[curve], made, x, place, count)
        return None if y is None else (x, y)

    return _runs(borders, formula, [ends[0], *formula.between(*ends), ends[1]], point)


def _runs(
    borders: SoftBorders, formula: _Along, marks: Sequence[Any], point: Callable[[Any], tuple[Any, Any] | None]
) -> list[Stretch] | None:
    """Stretches between marks along the formula's axis, joined where the mark between has the same onset.

    ``point`` gives the enclosed point of the curve over an enclosed number; None where a sign is not told.
    """
    runs: list[Stretch] = []
    for start, end in pairwise(marks):
        here = point(arb(between_simply(start, end)))
        onset = None if here is None else _confirmed(borders, formula, *here)
        if onset is None:
            return None
        if runs and runs[-1].onset is onset:
            meeting = point(enclosure(start, PRECISION))
            if meeting is not None and borders._at(meeting).onset is onset:
                runs[-1] = replace(runs[-1], end=end)
                continue
        runs.append(Stretch(start, end, onset, formula.axis))
    return runs


def _confirmed(borders: SoftBorders, formula: _Along, x: Any, y: Any) -> Onset | None:
    """The onset at enclosed numbers on the curve, by both routes; None where they do not tell it alike."""
    sign = formula.sign(x, y)
    onset = borders._at((x, y)).onset if sign else None
    if onset is None or onset is Onset.OPEN:
        return onset
    return onset if (onset is Onset.HARD) == (sign > 0) else None


def _ordinate(curve: Curve, made: Arrangement, x: Any, place: int, count: int) -> Any:
    """The ``place``-th of the ``count`` ordinates of a curve over an enclosed x within a strip; None if not told."""
    rows = acb_poly([arb_poly_at(c, x) for c in curve.in_y])
    try:
        roots = rows.roots(tol=arb(2) ** (-(PRECISION // 2)))
    except ValueError:
        return None
    low, high = arb(made.box.y0), arb(made.box.y1)
    real = sorted((z.real for z in roots if z.imag.contains(0)), key=lambda root: float(root.mid()))
    inside = [y for y in real if y > low and y < high]
    return inside[place] if len(inside) == count else None


def arb_poly_at(p: Any, x: Any) -> Any:
    """A polynomial with rational coefficients at an enclosed number."""
    total = arb(0)
    for c in reversed(p.coeffs()):
        total = total * x + arb(c)
    return total
