"""A map as a value: cells of dimension 0, 1 and 2, each with an exact sample, what is said there, and how surely.

Over one parameter cells are intervals and the points between them; over two they are regions, arcs and corners, or
boxes; over three a stack of slices, each a map of its own.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field, replace
from enum import StrEnum
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias

from mbsym.algebra import rationals
from mbsym.algebra.arrangements import Arc, Arrangement, Corner, CornerKind
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.plane.line import Line, Zero
from mbsym.expressions.message import Told
from mbsym.maps.admissible import Admissibility, Demand
from mbsym.maps.axis import Axis
from mbsym.maps.boundaries import Boundaries, Condition
from mbsym.maps.check import Check
from mbsym.maps.section import Section
from mbsym.maps.soft_borders import SoftBorders, SoftOrHard
from mbsym.maps.subdivision import Subdivision
from mbsym.maps.verdicts import Border, Judged
from mbsym.problems.stability.verdict import Verdict
from mbsym.problems.stability.words import Word

if TYPE_CHECKING:
    from mbsym.maps.branches_result import Critical
    from mbsym.problems.relative_equilibria.equilibria import RelativeEquilibrium


class Of(StrEnum):
    """What a map is coloured by."""

    STABILITY = "stability"
    SIGNATURE = "signature"
    EQUILIBRIA = "equilibria"


class Shape(StrEnum):
    """What a cell is: of a plane, of a line, of a plane without an arrangement."""

    REGION = "region"
    ARC = "arc"
    CORNER = "corner"
    INTERVAL = "interval"
    ZERO = "point"
    BOX = "box"


class Lack(Told):
    """Why nothing is said of a cell."""

    OUTSIDE = "outside of the assumptions", "not admissible"
    MASSLESS = "the mass matrix is not positive definite", "kinetic energy not positive definite"
    UNDEFINED = "formulas divide by zero"
    TOO_LARGE = "too large to be decided"
    WITHDRAWN = "withdrawn: the check failed"
    NOT_REACHED = "not reached"
    #: Of slices.
    IRRATIONAL = "at an irrational value: not looked at"
    #: Of boxes.
    UNPROVED = "nothing is proved"
    #: Of numbers of equilibria.
    INCOMPLETE = "the list may be incomplete", "not counted: the list is not complete"
    FAMILIES = "infinitely many", "infinitely many equilibria"
    UNCOUNTED = "not counted"


#: Nothing is told by these: a border with one of them does not stand out.
UNKNOWN = frozenset({Lack.TOO_LARGE, Lack.WITHDRAWN, Lack.NOT_REACHED, Lack.UNCOUNTED})


#: Where the ground has its parts of each shape.
_LISTED = {shape: f"{shape.name.lower()}s" for shape in Shape} | {Shape.BOX: "tiles"}


@dataclass(frozen=True)
class Counted:
    """The relative ``equilibria`` at a sample.

    ``throughout``: those stable there are proved to be so in the whole cell, by the signs of K, which do not change.
    ``confirmed``: how many a second route found at another point (None: it was not asked).
    """

    equilibria: tuple[RelativeEquilibrium, ...]
    throughout: bool = False
    confirmed: int | None = None

    @property
    def count(self) -> int:
        return len(self.equilibria)

    @property
    def stable(self) -> int:
        """Stable ones at the sample."""
        return sum(equilibrium.verdict.stable for equilibrium in self.equilibria)

    @property
    def undecided(self) -> int:
        """Those at the sample of which nothing decides whether they are stable."""
        return sum(equilibrium.verdict.word.open for equilibrium in self.equilibria)


@dataclass(frozen=True)
class Cell:
    """A cell: ``number`` is its place among those of its shape, ``sample`` the exact point at which it was judged.

    ``said`` holds at the sample exactly, ``certainty`` is how surely it holds in the whole cell (of counted equilibria:
    their number).  Where nothing is said ``lack`` says why; ``broken``: the demands that are not kept there.
    ``soft``: of borders at which one pair of roots is imaginary and none to the right; None elsewhere.  ``nonlinear``:
    of a verdict that leaves the motion open, or stable where energy may be lost, what the nonlinear system shows at the
    sample alone.
    """

    shape: Shape
    number: int
    sample: Any = None
    said: Judged | Counted | Critical | None = None
    certainty: Certainty = Certainty.UNDECIDED
    lack: Lack | None = None
    broken: tuple[Demand, ...] = ()
    soft: SoftOrHard | None = None
    nonlinear: Verdict | None = None

    @property
    def standing(self) -> str:
        """Whether there is a verdict, and if not, why."""
        return self.lack or "judged"

    @property
    def judged(self) -> Judged | None:
        """The verdict on the one motion that a map is of."""
        return self.said if isinstance(self.said, Judged) and self.lack is None else None

    @property
    def counted(self) -> Counted | None:
        """The equilibria there; those of a list that is not complete, or withdrawn, are ``said``, but not counted."""
        return self.said if isinstance(self.said, Counted) and self.lack is None else None

    @property
    def withdrawn(self) -> Cell:
        """The cell without what was said, which a check did not confirm."""
        return replace(self, said=None, certainty=Certainty.UNDECIDED, lack=Lack.WITHDRAWN)

    @property
    def right(self) -> int | None:
        """How many roots are to the right; None where that is not known."""
        return None if self.judged is None else self.judged.right

    @property
    def imaginary(self) -> bool:
        """Whether a pair of roots is imaginary there and none to the right: a border of flutter if it is lost there."""
        return self.judged is not None and self.judged.border is Border.IMAGINARY and self.judged.right == 0

    @property
    def word(self) -> Word | None:
        return None if self.judged is None else self.judged.verdict.word

    @property
    def kind(self) -> tuple[object, ...]:
        """What cells have in common that look alike in every respect that a map shows."""
        if self.judged is None:
            return (self.lack,)
        judged = self.judged
        return (judged.verdict.word, judged.verdict.theorems, judged.right, judged.real_right, judged.degree)


class Joined:
    """Numbers that are joined to classes; the least stands for each."""

    def __init__(self, count: int) -> None:
        self._above = list(range(count))

    def __call__(self, k: int) -> int:
        while self._above[k] != k:
            self._above[k] = self._above[self._above[k]]
            k = self._above[k]
        return k

    def join(self, a: int, b: int) -> None:
        a, b = self(a), self(b)
        self._above[max(a, b)] = min(a, b)


#: How the space of parameters is divided.
Ground: TypeAlias = Arrangement | Line | Subdivision[Any]


@dataclass(frozen=True)
class Map:
    """``regions`` are the cells that fill the space (intervals of a line, boxes), in the order of the ``ground``.

    ``values``: the numbers that were put in.  ``boundaries``: the curves, or points, that bound cells, with the
    conditions they come from.  ``areas``: of the regions (lengths), with estimates of their errors.  ``check``: more
    points judged by another route; None where it was not carried out.  ``section``, ``admissibility``: of maps of one
    motion.  ``onsets`` tells of further points whether a border is soft or hard; None where that was not asked.
    """

    of: Of
    axes: tuple[Axis, ...]
    values: Mapping[str, Fraction]
    ground: Ground
    boundaries: Boundaries
    regions: tuple[Cell, ...] = ()
    arcs: tuple[Cell, ...] = ()
    corners: tuple[Cell, ...] = ()
    areas: tuple[tuple[float, float], ...] = ()
    _: KW_ONLY
    section: Section | None = None
    admissibility: Admissibility = Admissibility((), (), ())
    interrupted: bool = False
    check: Check | None = None
    onsets: SoftBorders | None = field(default=None, repr=False, compare=False)

    @property
    def arrangement(self) -> Arrangement:
        """The ground of an exact map over a plane."""
        assert isinstance(self.ground, Arrangement)
        return self.ground

    @property
    def line(self) -> Line:
        """The ground of a map over one parameter; of a stack, the critical values of the third."""
        assert isinstance(self.ground, Line)
        return self.ground

    @property
    def cells(self) -> Iterator[Cell]:
        yield from self.regions
        yield from self.arcs
        yield from self.corners

    @property
    def borders(self) -> tuple[Cell, ...]:
        """The cells between regions."""
        return self.corners if isinstance(self.ground, Line) else self.arcs

    @cached_property
    def counts(self) -> frozenset[int]:
        """All numbers of equilibria that regions have."""
        return frozenset(region.counted.count for region in self.regions if region.counted is not None)

    @property
    def whole(self) -> float:
        """The length of the interval, the area of the plane."""
        return float(self.ground.high - self.ground.low if isinstance(self.ground, Line) else self.ground.box.area)

    @property
    def sound(self) -> bool:
        """Whether no check of the map fails."""
        return self.check is None or self.check.holds

    def place(self, cell: Cell) -> Any:
        """What of the ground a cell stands on."""
        return getattr(self.ground, _LISTED[cell.shape])[cell.number]

    def at(self, *values: Fraction) -> Cell | None:
        """The cell of a rational point, exactly; None outside.  Of boxes that meet there, one of which more is said."""
        x = tuple(rationals.exact(value) for value in values)
        ground = self.ground
        if isinstance(ground, Line):
            if not ground.low <= x[0] <= ground.high:
                return None
            there = ground.locate(x[0])
            return self.corners[there.id] if isinstance(there, Zero) else self.regions[there.id]
        point = x[0], x[1]
        if point not in ground.box:
            return None
        if isinstance(ground, Subdivision):
            around = (self.regions[k] for k, tile in enumerate(ground.tiles) if point in tile.box)
            return min(around, key=lambda cell: cell.lack is Lack.UNPROVED)
        place = ground.locate(*point)
        if isinstance(place, Arc):
            return self.arcs[place.id]
        return self.corners[place.id] if isinstance(place, Corner) else self.regions[place.id]

    # --- what is shown ---

    def look(self, cell: Cell) -> tuple[object, ...]:
        """What a picture tells apart."""
        if (counted := cell.counted) is not None:
            return (counted.count, counted.stable, counted.undecided)
        if (judged := cell.judged) is None:
            return (cell.lack,)
        if self.of is Of.SIGNATURE:
            return (judged.degree, judged.null)
        return (judged.verdict.word, judged.right, judged.real_right)

    def beside(self, border: Cell) -> tuple[Cell | None, Cell | None]:
        """The regions below and above an arc or a point (left and right of a vertical arc); None is outside."""
        if isinstance(self.ground, Line):
            ends = ([x.id for x in self.ground.intervals if x.ends[k] == border.number] for k in (1, 0))
            below, above = (end[0] if end else None for end in ends)
        else:
            below, above = self.place(border).regions
        return None if below is None else self.regions[below], None if above is None else self.regions[above]

    def around(self, corner: Cell) -> Sequence[Cell | None]:
        """The regions that meet at a corner, each once; None is outside.  Of an isolated point the one around it."""
        if isinstance(self.ground, Line):
            return list(self.beside(corner))
        there = self.place(corner)
        if there.kind is CornerKind.ISOLATED:
            at, j = there.place
            inside = self.arrangement.places.intervals
            return [self.regions[inside[key]] for key in ((at, j), (at, j - 1)) if key in inside][:1]
        pairs = [self.beside(self.arcs[k]) for k in there.arcs]
        return list({None if x is None else x.number: x for pair in pairs for x in pair}.values())

    def separates(self, border: Cell) -> bool:
        """Whether what is shown differs between the two sides of a border."""
        below, above = self.beside(border)
        return below is not None and above is not None and self.look(below) != self.look(above)

    def singles_out(self, border: Cell) -> bool:
        """Whether what is shown on a border differs from both of its sides, which are alike."""
        sides = {self.look(x) for x in self.beside(border) if x is not None}
        return (
            border.lack not in UNKNOWN and not self.separates(border) and bool(sides) and self.look(border) not in sides
        )

    def drawn(self, border: Cell) -> bool:
        """Whether a border is part of the picture: another look on its two sides, or on it alone."""
        sides = [cell for cell in self.beside(border) if cell is not None]
        if len(sides) < 2:
            return False
        return self.separates(border) or (
            self.singles_out(border) and any(cell.lack is None for cell in (*sides, border))
        )

    @property
    def together(self) -> tuple[int, ...]:
        """For each region the first of those that it makes one with, as no border between them changes anything."""
        regions = Joined(len(self.regions))
        for border in self.borders:
            a, b = self.beside(border)
            if a is not None and b is not None and self.look(a) == self.look(border) == self.look(b):
                regions.join(a.number, b.number)
        return tuple(map(regions, range(len(self.regions))))

    def conditions(self, cell: Cell) -> list[Condition]:
        """The conditions that are equalities on a border."""
        return [condition for k in self.place(cell).factors for condition in self.boundaries.conditions[k]]
