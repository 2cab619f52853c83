"""From an analysis to its map: boundaries, their exact arrangement, a proved verdict in every region (or interval), on
every arc and at every corner."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import islice
from typing import Any, TypeVar

from flint import Ordering, fmpq, fmpq_mpoly_ctx

from mbsym.algebra import rationals
from mbsym.algebra.arrangements import Arrangement, areas, decompose
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.characteristic import leading_minors
from mbsym.algebra.failures import Failure, TooLargeError
from mbsym.algebra.plane import AlgebraicNumber, Box, Point
from mbsym.algebra.plane.line import Line, decompose_line
from mbsym.algebra.plane.numbers import in_square_roots, sign
from mbsym.algebra.ring import Polynomial
from mbsym.algebra.signs import SIGN_WORDS
from mbsym.algebra.terms import univariate
from mbsym.analysis import Analysis
from mbsym.analysis.higher import FirstTerm, first_terms
from mbsym.analysis.judge import Judge as OneJudge
from mbsym.maps.admissible import Admissibility, admissibility
from mbsym.maps.boundaries import Boundaries, Condition, Origin, boundaries
from mbsym.maps.check import Check, ExactVerdicts, beside, check
from mbsym.maps.result import Cell, Ground, Lack, Map, Of, Shape
from mbsym.maps.section import Axis, Complaint, Fault, Section, Unfit, in_velocities, section
from mbsym.maps.soft_borders import Onset, SoftBorders, SoftOrHard, lost
from mbsym.maps.verdicts import Judged, matrix_at, verdict_at
from mbsym.problems.stability.exact import inertia

#: So many points of a map are judged by the nonlinear system, too.
MOST_ASKED = 200

#: Tells what is being done: a word, how much of it is done, and how much there is.
Watch = Callable[[str, int, int], None]


def unwatched(_: str, done: int, whole: int) -> None:
    """Tells nobody."""


def exact_map(
    analysis: Analysis,
    axes: Sequence[Axis],
    settings: Mapping[str, Fraction],
    of: Of = Of.STABILITY,
    watch: Watch = unwatched,
) -> Map:
    """The map of a description over one or two axes.

    Raises Unfit for axes or values that do not fit, Unavailable where there is no first approximation to judge,
    TooLargeError where the arrangement is beyond its budget.  KeyboardInterrupt while verdicts are found ends the work:
    what was not reached says so.
    """
    watch("first approximation", 0, 1)
    there = section(analysis, axes, settings)
    kept = kept_in(analysis, there)
    watch("boundaries", 0, 1)
    diagram = mapped(there, kept, bounded(analysis, there, kept), of, watch)
    return with_nonlinear(with_onsets(diagram, SoftBorders(analysis, there), watch), analysis, watch)


def kept_in(analysis: Analysis, there: Section) -> Admissibility:
    """What points of a section have to keep.  Raises Unfit where none does."""
    admissible = admissibility(analysis, there)
    if admissible.broken:
        raise Unfit([Complaint(Fault.OUTSIDE, "", demand.condition.about) for demand in admissible.broken])
    return admissible


def bounded(analysis: Analysis, there: Section, kept: Admissibility) -> Boundaries:
    """All boundaries of a section: of verdicts, of what is kept, and the axes' zeros where the energy asks for them."""
    conditions = [Condition(Origin.ENERGY, x, about=str(x)) for x in there.asked]
    degenerate = first_term_in(analysis, there)
    if degenerate is not None:
        conditions += [Condition(Origin.HIGHER_ORDER, x) for x in degenerate.coefficients]
    return boundaries(there, [*(demand.condition for demand in kept.demands), *conditions], kept.known)


@dataclass(frozen=True)
class ByFirstTerm:
    """Decides cells of a section in which K of the one coordinate vanishes, by the first term of V that does not.

    ``coefficients`` of ``terms``, and ``damping``: what has their signs, polynomials in the axes.
    """

    terms: tuple[FirstTerm, ...]
    coefficients: tuple[Any, ...]
    damping: Any

    def __call__(self, cell: Cell) -> Cell:
        """The cell, decided if its verdict is open and a coefficient does not vanish at its sample."""
        if cell.judged is None or not cell.judged.verdict.word.open:
            return cell
        signs = [_sign(cell.sample, x) for x in self.coefficients]
        first = next((k for k, x in enumerate(signs) if x), -1)
        term = replace(self.terms[first], damped=_sign(cell.sample, self.damping) > 0)
        verdict = term.verdict(SIGN_WORDS[frozenset({signs[first]})])
        return cell if verdict is None else replace(cell, said=replace(cell.judged, verdict=verdict))


def first_term_in(analysis: Analysis, there: Section, most: int | None = 1) -> ByFirstTerm | None:
    """What decides cells of a section in which K of the one coordinate vanishes; None of others.

    By ``most`` terms of V; the signs of all their coefficients have to be told apart by cells.
    """
    if there.constant is not None or len(there.parts) != 1 or any(x != 0 for row in there.parts[0].K for x in row):
        return None

    def carried(x: Polynomial) -> Any:
        above, below = there.images(x)
        return above * below

    def sign_of(x: Polynomial) -> str:
        image = carried(x)
        if not image.is_constant():
            return "unknown"
        return "zero" if image == 0 else SIGN_WORDS[frozenset({sign(image.leading_coefficient())})]

    numbers = {name: x for name, x in there.numbers.items() if name in analysis.system.parameter_names}
    try:
        terms = tuple(islice(first_terms(analysis, analysis.balance.at(numbers), sign_of), most))
        coefficients = tuple(carried(term.coefficient) for term in terms)
        return ByFirstTerm(terms, coefficients, there.parts[0].D[0][0]) if terms else None
    except Failure:
        return None


AnyMap = TypeVar("AnyMap", bound=Map)


def by_first_term(found: AnyMap, analysis: Analysis) -> AnyMap:
    """The map with open verdicts decided by the first term of V, whose coefficient's sign bounds regions."""
    decided = None if found.section is None else first_term_in(analysis, found.section)
    if decided is None or found.of is not Of.STABILITY:
        return found
    regions, arcs, corners = (tuple(map(decided, part)) for part in (found.regions, found.arcs, found.corners))
    return replace(found, regions=regions, arcs=arcs, corners=corners)


def with_onsets(diagram: Map, onsets: SoftBorders, watch: Watch) -> Map:
    """The map with what terms of higher order say of arcs and corners where a pair of roots is imaginary.

    They say it where stability is lost: of the cells beside one has roots to the right, the other none.
    """
    if diagram.of is not Of.STABILITY or diagram.interrupted:
        return diagram

    def told(cell: Cell) -> Cell:
        if not cell.imaginary:
            return cell
        near = diagram.beside(cell) if cell.shape is Shape.ARC else diagram.around(cell)
        why = lost([None if x is None else x.right for x in near])
        if why:
            return replace(cell, soft=SoftOrHard(Onset.NEITHER, why))
        if isinstance(diagram.ground, Arrangement) and cell.shape is Shape.ARC:
            return replace(cell, soft=onsets.along(diagram.ground, diagram.place(cell)))
        return replace(cell, soft=onsets.at(cell.sample))

    arcs, corners = list(diagram.arcs), list(diagram.corners)
    interrupted = False
    try:
        for cells in (arcs, corners):
            for k, cell in enumerate(cells):
                if cell.imaginary:
                    watch("soft or hard", k, len(cells))
                cells[k] = told(cell)
    except KeyboardInterrupt:
        interrupted = True
    return replace(diagram, arcs=tuple(arcs), corners=tuple(corners), interrupted=interrupted, onsets=onsets)


@dataclass(frozen=True)
class Nonlinear:
    """What the one judge says of the nonlinear system at samples of cells that are rational, or square roots."""

    judge: OneJudge
    there: Section

    def may_add(self, cell: Cell) -> bool:
        """Whether it may say more than the cell's verdict."""
        told = all(in_square_roots(x) is not None for x in _coordinates(cell.sample))
        return cell.judged is not None and told and self.judge.may_add(cell.judged.verdict)

    def __call__(self, cell: Cell) -> Cell:
        """The cell, ``nonlinear`` being what is said at its sample where that is more."""
        assert cell.judged is not None
        first, axes = cell.judged.verdict, self.there.axes
        told = (in_square_roots(x) for x in _coordinates(cell.sample))
        point = {axis.name: x for axis, x in zip(axes, told, strict=True) if x is not None}
        try:
            verdict = self.judge.at({**self.there.numbers, **point}, first)
        except Failure:
            return cell
        return cell if verdict.word.open or verdict.word is first.word else replace(cell, nonlinear=verdict)


def nonlinear_in(analysis: Analysis, there: Section) -> Nonlinear | None:
    """None where axes, or what is given, are no parameters with rational numbers."""
    system, names = analysis.system, {axis.name for axis in there.axes}
    related = {item.name for item in system.relations} | {name for name, _ in analysis.equilibrium.solved}
    plain = {*system.parameter_names} - related == {*there.numbers, *names} - related
    return Nonlinear(OneJudge(in_velocities(analysis)), there) if plain and there.constant is None else None


def with_nonlinear(diagram: Map, analysis: Analysis, watch: Watch) -> Map:
    """The map with what the nonlinear system shows where the first approximation and the energy leave more to be said.

    Of one coordinate whose K vanishes in the whole section the first term of V decides.  Else it is what the one judge
    says of samples that are rational, or square roots: only where the axes and all that is given are parameters with
    numbers, and at the first ``MOST_ASKED`` of such points.
    """
    there = diagram.section
    if diagram.of is not Of.STABILITY or diagram.interrupted or there is None or there.constant is not None:
        return diagram
    diagram = by_first_term(diagram, analysis)
    further, left = nonlinear_in(analysis, there), MOST_ASKED
    if further is None:
        return diagram

    def asked(cell: Cell) -> Cell:
        nonlocal left
        if not left or not further.may_add(cell):
            return cell
        left -= 1
        watch("terms of higher order", cell.number, len(diagram.regions))
        return further(cell)

    try:
        regions, arcs, corners = (tuple(map(asked, part)) for part in (diagram.regions, diagram.arcs, diagram.corners))
    except KeyboardInterrupt:
        return replace(diagram, interrupted=True)
    return replace(diagram, regions=regions, arcs=arcs, corners=corners)


def mapped(
    there: Section, kept: Admissibility, found: Boundaries, of: Of = Of.STABILITY, watch: Watch = unwatched
) -> Map:
    """The map of a section of one or two axes with these boundaries, judged and checked; fails as ``exact_map``."""
    found = without_constant(there, found)
    line = len(there.axes) == 1
    ground: Arrangement | Line
    if line:
        ground = decompose_line(found.factors, *ends(there.axes[0]))
    else:
        ground = decompose(found.factors, box_of(there.axes), progress=watch)
    cells, interrupted = _judged(Judge(there, kept), places(ground), watch)
    regions, arcs, corners = ([x for x in cells if x.shape in shapes] for shapes in _PARTS)
    checked = None
    if not interrupted:
        try:
            of_regions, of_arcs, of_corners = ([x.judged for x in part] for part in (regions, arcs, corners))
            checked = check(there, ground, of_regions, of_arcs, of_corners, progress=watch)
            regions, arcs, corners = (withdrawn(x, k, checked) for k, x in enumerate((regions, arcs, corners)))
        except KeyboardInterrupt:
            interrupted = True
    sizes = lengths(ground) if isinstance(ground, Line) else areas(ground)
    return Map(
        of, there.axes, there.told, ground, found, tuple(regions), tuple(arcs), tuple(corners), sizes,
        section=there, admissibility=kept, interrupted=interrupted, check=checked,
    )  # fmt: skip


#: Regions, arcs and corners.
_PARTS = ((Shape.REGION, Shape.INTERVAL), (Shape.ARC,), (Shape.CORNER, Shape.ZERO))


def _judged(judge: Judge, where: Sequence[tuple[Shape, int, Any]], watch: Watch) -> tuple[list[Cell], bool]:
    """A cell for each place, and whether Ctrl-C ended that."""
    cells: list[Cell] = []
    interrupted = False
    for done, place in enumerate(where):
        try:
            if not interrupted:
                watch("verdicts", done, len(where))
                cells.append(judge(*place))
                continue
        except KeyboardInterrupt:
            interrupted = True
        cells.append(Cell(*place, lack=Lack.NOT_REACHED))
    return cells, interrupted


def withdrawn(cells: list[Cell], part: int, checked: Check) -> list[Cell]:
    """Regions, arcs or corners (``part`` 0, 1, 2) without the verdicts that the check does not confirm.

    What is wrong with the arrangement as a whole takes all verdicts with it.
    """
    locations = [(finding.region, finding.arc, finding.corner) for finding in checked.findings]
    lone = all(mistake.breach is None for mistake in checked.findings) and all(
        any(k is not None for k in x) for x in locations
    )
    wrong = {location[part] for location in locations}
    return [cell.withdrawn if cell.said is not None and (cell.number in wrong or not lone) else cell for cell in cells]


def without_constant(there: Section, found: Boundaries) -> Boundaries:
    """Boundaries as polynomials in the axes alone."""
    if there.constant is None:
        return found
    plane = fmpq_mpoly_ctx.get([axis.name for axis in there.axes], Ordering.lex)
    return replace(found, factors=tuple(x.project_to_context(plane) for x in found.factors))


def ends(axis: Axis) -> tuple[Any, Any]:
    """As numbers of flint."""
    return rationals.exact(axis.low), rationals.exact(axis.high)


def box_of(axes: Sequence[Axis]) -> Box:
    """The box of the first two axes."""
    across, up = axes[:2]
    return Box(*ends(across), *ends(up))


def lengths(line: Line) -> tuple[tuple[float, float], ...]:
    """Of the intervals, and their errors, which are those of rounding."""
    marks = [line.low if x is None else line.zeros[x].number for interval in line.intervals for x in interval.ends[:1]]
    last = [line.high if x is None else line.zeros[x].number for interval in line.intervals for x in interval.ends[1:]]
    return tuple((float_of(b) - float_of(a), 1e-15 * abs(float_of(b))) for a, b in zip(marks, last, strict=True))


def float_of(x: Any) -> float:
    """A rational or algebraic number in floats."""
    return float(x.p) / float(x.q) if isinstance(x, fmpq) else float(x)


def places(ground: Ground) -> list[tuple[Shape, int, Any]]:
    """(shape, number, exact sample) of all cells of an arrangement or a line: regions, arcs, corners."""
    if isinstance(ground, Line):
        intervals = [(Shape.INTERVAL, interval.id, interval.sample) for interval in ground.intervals]
        return [*intervals, *((Shape.ZERO, zero.id, zero.number) for zero in ground.zeros)]
    assert isinstance(ground, Arrangement)
    regions = [(Shape.REGION, region.id, Point(*region.sample)) for region in ground.regions]
    arcs = [(Shape.ARC, arc.id, arc.point) for arc in ground.arcs]
    return [*regions, *arcs, *((Shape.CORNER, corner.id, corner.point) for corner in ground.corners)]


class Judge:
    """Judges exact points of a section one by one: a number, a Point, or the rational coordinates of more axes."""

    def __init__(self, there: Section, kept: Admissibility) -> None:
        self.section, self.kept = there, kept

    def __call__(self, shape: Shape, number: int, point: Any) -> Cell:
        """What is proved at a point."""
        try:
            return self._at(shape, number, point)
        except TooLargeError:
            return Cell(shape, number, point, lack=Lack.TOO_LARGE)

    def _at(self, shape: Shape, number: int, point: Any) -> Cell:
        place = beside(point, self.section.constant)
        broken = tuple(
            demand for demand in self.kept.demands if not demand.kept(_sign(place, demand.condition.polynomial))
        )
        if broken:
            return Cell(shape, number, point, lack=Lack.OUTSIDE, broken=broken)
        if any(_sign(place, x) == 0 for x in self.section.undefined):
            return Cell(shape, number, point, lack=Lack.UNDEFINED)
        if not self.positive(point, place):
            return Cell(shape, number, point, lack=Lack.MASSLESS)
        # boundary polynomials bound verdicts in regions; on an arc a verdict is that of the point
        surely = Certainty.UNDECIDED if shape is Shape.ARC else Certainty.PROVED
        return Cell(shape, number, point, self.judged(shape, point, place), surely)

    def judged(self, shape: Shape, point: Any, place: Any) -> Judged:
        """The verdict at a point, ``place`` being the same with the section's constant."""
        if shape not in (Shape.REGION, Shape.INTERVAL, Shape.BOX):
            return self._on_curves(place)
        if self.section.constant is None:
            return verdict_at(self.section, _coordinates(point))
        return replace(self._on_curves(place), border=None)

    @cached_property
    def _on_curves(self) -> ExactVerdicts:
        return ExactVerdicts(self.section)

    def positive(self, point: Any, place: Any) -> bool:
        """Whether M of every part is positive definite: its leading minors are."""
        if self.section.constant is None and all(isinstance(x, fmpq) for x in _coordinates(point)):
            at = _coordinates(point)
            return all(
                inertia(matrix_at(m, at))[0] == len(m) for m in (x.kinetic for x in self.section.parts if x.kinetic)
            )
        return all(_sign(place, minor) > 0 for minors in self._minors for minor in minors)

    @cached_property
    def _minors(self) -> list[tuple[Any, ...]]:
        return [leading_minors(part.kinetic) for part in self.section.parts if part.kinetic]


def _coordinates(point: Any) -> tuple[Any, ...]:
    if isinstance(point, tuple):
        return point
    return (point.x, point.y) if isinstance(point, Point) else (point,)


def _sign(place: Any, p: Any) -> int:
    """The sign of a polynomial of the section's context at an exact point."""
    if isinstance(place, AlgebraicNumber):
        return place.sign(univariate(p))
    if isinstance(place, fmpq | tuple):
        return sign(fmpq(p(*_coordinates(place))))
    return int(place.sign(p))
