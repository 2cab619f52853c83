"""The map where no exact arrangement can be had, or where none is asked for: boxes with one proved verdict each.

What is proved holds at every point of a box, its edges included.  A box of which nothing is proved is white: that is no
statement about it, and the share of the area is told.  ``Method`` says how: by the boundary polynomials where these
can be had, by enclosures of the matrices where they are too large.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from fractions import Fraction
from random import Random
from typing import Any

from flint import ctx, fmpq

from mbsym.algebra import rationals
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.characteristic import leading_minors
from mbsym.algebra.failures import NoValue, TooLargeError
from mbsym.algebra.plane import Box, Point
from mbsym.algebra.plane.numbers import Rational, between, sign
from mbsym.analysis import Analysis
from mbsym.maps.admissible import Admissibility
from mbsym.maps.boundaries import Boundaries
from mbsym.maps.check import check_boxes
from mbsym.maps.mapping import Judge, Watch, bounded, box_of, by_first_term, kept_in, unwatched, without_constant
from mbsym.maps.result import Cell, Lack, Map, Of, Shape
from mbsym.maps.section import Axis, Complaint, Fault, Section, Unfit, section, unmade
from mbsym.maps.subdivision import ByBoundaries, ByEnclosures, End, Subdivision, about_centre, centre, subdivide
from mbsym.maps.verdicts import Judged
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import relations
from mbsym.problems.stability.enclosed import enclosed_verdict_with_cyclic
from mbsym.problems.stability.linear_form import LinearSystem
from mbsym.problems.stability.problem import ExactVerdicts, blocks_of
from mbsym.problems.stability.verdict import Verdict, displaced, off_the_leaf
from mbsym.problems.stability.words import Word

#: Boxes are halved so often at most, and there are so many of them at most.
DEPTH, MOST = 12, 20_000
#: So many proved boxes are tried at a second point.
TRIED = 200


class Method(StrEnum):
    """How boxes are proved."""

    BOUNDARIES = "no boundary polynomial vanishes in a box"
    ENCLOSURES = "theorems that hold for enclosures of the matrices"


@dataclass(frozen=True, kw_only=True)
class BoxMap(Map):
    """Regions are boxes that fill the plane; of white ones nothing is proved.

    ``because``: why there is no exact arrangement; empty where boxes were asked for.  The check tries a second point in
    proved boxes, judged by itself.
    """

    method: Method
    because: str

    @property
    def subdivision(self) -> Subdivision[Any]:
        assert isinstance(self.ground, Subdivision)
        return self.ground


def box_map(
    analysis: Analysis,
    axes: Sequence[Axis],
    settings: Mapping[str, Fraction],
    of: Of = Of.STABILITY,
    watch: Watch = unwatched,
    because: str = "",
    depth: int = DEPTH,
    most: int = MOST,
) -> BoxMap:
    """The plane of two axes in boxes: halved down to 2^-depth of its area, ``most`` boxes.

    Where matrices are no fractions of polynomials enclosures prove them.

    Raises Unfit and Unavailable as ``exact_map`` does; TooLargeError where boundaries are too large and the matrices
    hold an irrational constant or no signature is asked of them.  KeyboardInterrupt ends the halving: what is proved
    is kept.
    """
    watch("first approximation", 0, 1)
    functions: IrrationalSection | None = None
    try:
        there = section(analysis, axes, settings)
    except Unfit as unfit:
        if not unfit.irrational or of is not Of.STABILITY:
            raise
        functions, because = IrrationalSection(analysis, axes, settings, unfit.complaints), because or unfit_text(unfit)
        there = functions.plain
    admissibility = kept_in(analysis, there)
    watch("boundaries", 0, 1)
    prove: Any
    boundaries, method = Boundaries((), (), ()), Method.ENCLOSURES
    try:
        if functions is None:
            boundaries = bounded(analysis, there, admissibility)
            method = Method.BOUNDARIES
    except TooLargeError as error:
        if there.constant is not None or of is not Of.STABILITY:
            raise
        because = because or str(error)
    if method is Method.BOUNDARIES:
        prove = _bounded(there, admissibility, boundaries)
    else:
        prove = _Enclosed(there, admissibility, functions or ByEnclosures(there))
    made = subdivide(box_of(there.axes), prove, depth, most, watch)
    cells = [_cell(k, tile.proved, centre(tile.box)) for k, tile in enumerate(made.tiles)]
    checked = None
    if made.end is not End.INTERRUPTED:
        try:
            judge = None if functions is None else functions.at
            checked = check_boxes(there, _tried(made, cells), judge, progress=watch)
        except KeyboardInterrupt:
            checked = None
    if checked is not None and not checked.holds:  # a route that is wrong in one box is trusted in none
        cells = [cell if cell.said is None else cell.withdrawn for cell in cells]
    found = BoxMap(
        of, there.axes, there.told, made, boundaries, tuple(cells),
        areas=tuple((float(tile.box.area), 0.0) for tile in made.tiles), section=there, admissibility=admissibility,
        interrupted=checked is None, check=checked, method=method, because=because,
    )  # fmt: skip
    return by_first_term(found, analysis) if method is Method.BOUNDARIES else found


def _cell(number: int, proved: Cell | None, sample: tuple[Rational, Rational]) -> Cell:
    """A box by its number, white or not."""
    if proved is None:
        return Cell(Shape.BOX, number, Point(*sample), lack=Lack.UNPROVED)
    return replace(proved, number=number, sample=Point(*sample))


def _tried(made: Subdivision[Cell], cells: Sequence[Cell]) -> list[tuple[int, Judged, tuple[Rational, Rational]]]:
    """(number, verdict, a random point) of some proved boxes, those of the largest area first."""
    source = Random(20261123)
    judged = [(cell.number, cell.judged, made.tiles[cell.number].box) for cell in cells if cell.judged is not None]
    judged.sort(key=lambda entry: -entry[2].area)
    trials = []
    chosen = [*judged[: TRIED // 2], *source.sample(judged, min(TRIED // 2, len(judged)))]
    # where boxes are few, several points in each
    for number, verdict, box in chosen * (TRIED // len(chosen) if chosen else 0):
        shares = [fmpq(source.randint(0, 996), 996) for _ in range(2)]
        at = (box.x0 + (box.x1 - box.x0) * shares[0], box.y0 + (box.y1 - box.y0) * shares[1])
        trials.append((number, verdict, at))
    return trials


def _bounded(there: Section, admissibility: Admissibility, boundaries: Boundaries) -> ByBoundaries[Cell]:
    """Judged at the centre, exactly."""
    judge = Judge(there, admissibility)

    def at(x: Rational, y: Rational) -> Any:
        cell = judge(Shape.BOX, 0, Point(x, y))
        return None if cell.lack is Lack.TOO_LARGE else cell

    return ByBoundaries(without_constant(there, boundaries).factors, at)


class _Enclosed:
    """By enclosures, where what parameters have to keep is seen to be kept, or to be broken, in the whole box."""

    def __init__(self, there: Section, kept: Admissibility, verdicts: ByEnclosures | IrrationalSection) -> None:
        self._section, self._kept, self._verdicts = there, kept, verdicts
        self._minors = [minor for part in there.parts for minor in leading_minors(part.kinetic)]

    def __call__(self, box: Box, hint: Any) -> tuple[Cell | None, Any]:
        return self._proved(box), None

    def _proved(self, box: Box) -> Cell | None:
        broken = []
        for demand in self._kept.demands:
            sign = _sign(demand.condition.polynomial, box)
            if not sign:
                return None
            if not demand.kept(sign):
                broken.append(demand)
        if broken:
            return Cell(Shape.BOX, 0, lack=Lack.OUTSIDE, broken=tuple(broken))
        if not all(_sign(p, box) for p in self._section.undefined) or any(_sign(p, box) != 1 for p in self._minors):
            return None
        verdict = self._verdicts.verdict(box)
        if verdict.word is Word.UNDECIDED:
            return None
        return Cell(Shape.BOX, 0, said=Judged(verdict, None, None, None, None), certainty=Certainty.PROVED)


def _sign(p: Any, box: Box) -> int:
    """1 or -1 where p has that sign in the whole box, 0 where that is not seen."""
    middle, radius = about_centre(p, box)
    return int(middle > radius) - int(-middle > radius)


# Boxes where matrices hold functions of the axes that are no fractions of polynomials: sin(a), sqrt(a), exp(a).
#
# There are no boundary polynomials.  All entries of the first approximation are enclosed over a box (a ball for each
# function, dependences between them forgotten), and a box is proved by theorems that need strict inequalities only,
# as in ``subdivision.ByEnclosures``.  Axes are parameters of the description; everything else has a rational number.


#: Working precision, in bits: boxes are wide.
BITS = 64


class IrrationalSection:
    """``plain`` is the section without its matrices; ``verdict`` judges a box, ``at`` a rational point."""

    def __init__(
        self, analysis: Analysis, axes: Sequence[Axis], settings: Mapping[str, Fraction], why: Sequence[Complaint]
    ) -> None:
        """Raises Unfit for ``why`` where an axis or a setting is a symbol of the notation, or there are constraints.

        Unfit, too, where a name that occurs has no number.
        """
        names = {item.name for item in analysis.system.parameters}
        if not {*settings, *(axis.name for axis in axes)} <= names or analysis.system.constraints:
            raise Unfit(why)
        self.plain, self._systems = unmade(analysis, axes, settings)
        self._analysis, self._scene, self._linear = analysis, analysis.parameters_scene, analysis.judgeable
        self._solved = {name: value.polynomial for name, value in analysis.equilibrium.solved}
        self._exact: ExactVerdicts | None = None
        (x, y), made = axes, fmpq
        whole = Box(*(made(v.numerator, v.denominator) for v in (x.low, x.high, y.low, y.high)))
        try:
            for part in self._systems:
                self._matrices(part, whole)
        except NoValue as error:
            raise Unfit([Complaint(Fault.MISSING, str(error.args[0]))]) from error

    def verdict(self, box: Box) -> Verdict:
        """What theorems show of all points of a box; undecided where enclosures leave it open."""
        ranges = ((box.x0, box.x1), (box.y0, box.y1))
        apart = all(a > 0 or b < 0 for a, b in ranges)
        bounded = self.plain.law(tuple(sign(a) for a, _ in ranges)) if apart else self.plain.law.everywhere
        return self.plain.whole((self._judged(part, box, bounded) for part in self._systems), bounded)

    def _judged(self, part: LinearSystem, box: Box, bounded: bool) -> Verdict:
        matrices = self._matrices(part, box)
        cyclic = () if part.driven else part.cyclic
        verdict = displaced(enclosed_verdict_with_cyclic(matrices, bounded, cyclic, BITS, part.exact), part.basis)
        return off_the_leaf(verdict) if part.leaf else verdict

    def _matrices(self, part: LinearSystem, box: Box) -> list[list[list[Any]]]:
        """M, D, G, K, N of a part in balls over a box."""
        x, y = self.plain.axes
        numbers = {name: rationals.exact(value) for name, value in self.plain.numbers.items()}
        with ctx.workprec(BITS):
            ranges = {x.name: between(box.x0, box.x1, BITS), y.name: between(box.y0, box.y1, BITS)}
            values = _Values(self._scene, self._solved, numbers | ranges)
            names = part.names if part.basis is None else part.basis.coordinates
            blocks = blocks_of(self._scene, self._linear, names, part.basis)
            return [[[self._scene.ring.evaluate(x, values) for x in row] for row in block] for block in blocks]

    def at(self, x: Rational, y: Rational) -> Verdict:
        """The verdict at a point, by the route that problem 6 takes at the numbers of a description."""
        if self._exact is None:
            analysis = self._analysis
            self._exact = ExactVerdicts(
                analysis.parameters_scene, analysis.balance, analysis.judgeable, analysis.equilibrium, analysis.signs
            )
        point = (rationals.fraction(v) for v in (x, y))
        names = {item.name for item in self._analysis.system.parameters}
        known = {name: value for name, value in self.plain.numbers.items() if name in names}
        return self._exact(known | dict(zip((axis.name for axis in self.plain.axes), point, strict=True)))


class _Values(dict[str, Any]):
    """Numbers by name; what follows from others is enclosed when it is asked for."""

    def __init__(self, scene: Scene, solved: Mapping[str, Any], known: Mapping[str, Any]) -> None:
        super().__init__(known)
        self._scene = scene
        generators = scene.ring.generators
        self._images = {str(generators[k].name): image for k, image in relations(scene).items()} | dict(solved)
        self._symbols = {item.name: item.value for item in scene.system.notation}

    def __missing__(self, name: str) -> Any:
        if name in self._images:
            image = self._images.pop(name)
        elif name in self._symbols:
            image = self._scene.lower(self._symbols.pop(name))
        else:
            raise NoValue(name)
        self[name] = self._scene.ring.evaluate(image, self)
        return self[name]


def unfit_text(error: Unfit) -> str:
    """``the matrices hold what is no rational number there: sin(a)``."""
    return "the matrices hold what is no fraction of polynomials: " + ", ".join(
        dict.fromkeys(complaint.name for complaint in error.complaints)
    )
