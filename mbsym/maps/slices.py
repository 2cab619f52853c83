"""A map over three axes: a stack of exact maps of planes, so that no picture between them is missed.

The boundary polynomials of the section of three axes are found once.  At all values of the third axis at which their
arrangement in the plane of the first two may change (``critical_levels``), and at one rational value between any two,
the plane is decomposed and judged as any other map.  Between two neighbouring critical values

* regions, arcs and corners of the slices are deformed into each other (McCallum 1988), and
* a region sweeps an open connected set on which no boundary polynomial vanishes, so that its verdict is one and the
  same (``maps.boundaries``).

On arcs and at corners verdicts are those of the slice that is looked at.  Another slice between the same two values
checks both statements: it has to correspond to the first one (``arrangements.likeness``), verdicts of regions included.

Slices in which the same is shown (``maps.slices``) are one ``Picture``.  A critical value ends it unless the same is
shown at that value, too; values at which it was not looked at are told with the picture.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from flint import fmpq

from mbsym.algebra import rationals
from mbsym.algebra.arrangements import Arrangement, decompose
from mbsym.algebra.arrangements.arrangement import CornerKind
from mbsym.algebra.arrangements.space import Graph, alike, corresponding, critical_levels, flattened, levels_of
from mbsym.algebra.failures import Limit, TooLargeError
from mbsym.algebra.plane import AlgebraicNumber, Point
from mbsym.algebra.plane.line import Line
from mbsym.algebra.plane.numbers import Number, between_simply, sign
from mbsym.analysis import Analysis
from mbsym.expressions.message import Message
from mbsym.maps.admissible import Admissibility, Demand
from mbsym.maps.boundaries import Boundaries, norm_of_factors
from mbsym.maps.mapping import (
    Judge,
    Watch,
    bounded,
    box_of,
    ends,
    first_term_in,
    kept_in,
    mapped,
    unwatched,
    with_nonlinear,
    with_onsets,
)
from mbsym.maps.result import Cell, Joined, Lack, Map, Of, Shape
from mbsym.maps.section import Axis, Law, Section, section
from mbsym.maps.soft_borders import SoftBorders
from mbsym.problems.stability.constant import Constant, context_of
from mbsym.problems.stability.words import Fact

#: Slices take seconds each: with more critical values than this none is begun.
MOST_LEVELS = 120
#: Slices are made at irrational values of up to this degree.
MOST_DEGREE = 4


@dataclass(frozen=True)
class Layer:
    """The slice at one value of the third axis.

    ``critical``: the picture may be another one on its two sides.  ``plane`` is its map, ``lack`` says why there is
    none; ``broken``: what no point of the slice keeps.  ``second``: of one that is not critical, another value up to
    the same critical ones, at which the slice was compared; ``confirmed``: whether it corresponds.
    """

    number: int
    z: Number
    critical: bool
    plane: Map | None = None
    lack: Lack | None = None
    broken: tuple[Demand, ...] = ()
    second: Any = None
    confirmed: bool = True


@dataclass(frozen=True)
class Picture:
    """Neighbouring ``layers`` that show the same, by their numbers; ``unseen`` of them were not looked at.

    ``shown``: the one that stands for all.
    """

    layers: tuple[int, ...]
    shown: int
    unseen: tuple[int, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Stack(Map):
    """A map over three axes: its ground is the line of the critical values of the third; ``layers`` ascend along it."""

    layers: tuple[Layer, ...]
    pictures: tuple[Picture, ...]

    @property
    def axis(self) -> Axis:
        """The third axis."""
        return self.axes[2]

    @property
    def planes(self) -> list[Map]:
        """The slices that there are maps of."""
        return [layer.plane for layer in self.layers if layer.plane is not None]

    @property
    def sound(self) -> bool:
        """Whether all checks of all slices hold."""
        return all(layer.confirmed for layer in self.layers) and all(plane.sound for plane in self.planes)

    def ends(self, picture: Picture) -> tuple[Number, bool, Number, bool]:
        """(from, whether that belongs to it, to, whether that does), values of the third axis."""
        first, last = self.layers[picture.layers[0]], self.layers[picture.layers[-1]]
        low, high = first.z, last.z
        if not first.critical:
            low = self.layers[first.number - 1].z if first.number else self.line.low
        if not last.critical:
            high = self.layers[last.number + 1].z if last.number + 1 < len(self.layers) else self.line.high
        return low, first.critical or not first.number, high, last.critical or last.number + 1 == len(self.layers)


def stack(
    analysis: Analysis,
    axes: Sequence[Axis],
    settings: Mapping[str, Fraction],
    of: Of = Of.STABILITY,
    watch: Watch = unwatched,
) -> Stack:
    """The slices of a description over three axes, at all critical values of the third and between them.

    Raises what ``exact_map`` raises, TooLargeError for more than ``MOST_LEVELS`` critical values, too.
    KeyboardInterrupt ends the work once a slice is judged: what was not reached says so.
    """
    watch("first approximation", 0, 1)
    there = section(analysis, axes, settings)
    admissibility = kept_in(analysis, there)
    watch("boundaries", 0, 1)
    boundaries = bounded(analysis, there, admissibility)
    line = critical_levels(boundaries.factors, box_of(axes), *ends(axes[2]), progress=watch)
    if len(line.zeros) > MOST_LEVELS:
        raise TooLargeError(
            "values of [[name]] at which the picture may change: [[count]], more than [[most]]",
            name=axes[2].name,
            count=len(line.zeros),
            most=MOST_LEVELS,
            limit=Limit.WORK,
            remedy=Message("take a smaller interval of [[name]]", name=axes[2].name),
        )
    slicing = _Slicing(analysis, there, admissibility, boundaries, of, watch)
    levels = levels_of(line)
    layers: list[Layer] = []
    interrupted = False
    for number, (z, critical) in enumerate(levels):
        if not interrupted:
            try:
                layers.append(slicing(number, len(levels), z, critical, line))
                made = layers[-1].plane
                interrupted = made is not None and made.interrupted
                continue
            except KeyboardInterrupt:
                interrupted = True
        layers.append(Layer(number, z, critical, lack=Lack.NOT_REACHED))
    if interrupted and all(layer.plane is None for layer in layers):
        raise KeyboardInterrupt
    return Stack(
        of, there.axes, there.told, line, boundaries, section=there, admissibility=admissibility,
        interrupted=interrupted, layers=tuple(layers), pictures=_pictures(layers),
    )  # fmt: skip


# --- one slice --------------------------------------------------------------------------------------------------------


class _Slicing:
    """Makes the slices of one section."""

    def __init__(
        self, analysis: Analysis, there: Section, kept: Admissibility, found: Boundaries, of: Of, watch: Watch
    ) -> None:
        self.analysis = analysis
        self.section, self.kept, self.boundaries, self.of, self.watch = there, kept, found, of, watch

    def __call__(self, number: int, whole: int, z: Number, critical: bool, line: Line) -> Layer:
        def told(text: str, done: int, of: int) -> None:
            self.watch(f"slice {number + 1} of {whole}, {text}", done, of)

        self.watch(f"slice {number + 1} of {whole}", 0, 1)
        if isinstance(z, AlgebraicNumber) and z.polynomial.degree() > MOST_DEGREE:
            return Layer(number, z, critical, lack=Lack.IRRATIONAL)
        cut, admissibility = at_level(self.section, self.kept, z)
        if admissibility.broken:
            return Layer(number, z, critical, lack=Lack.OUTSIDE, broken=admissibility.broken)
        try:
            plane = mapped(cut, admissibility, self._flat(cut, admissibility, z), self.of, told)
            plane = with_nonlinear(with_onsets(plane, SoftBorders(self.analysis, cut), told), self.analysis, told)
            if critical or plane.interrupted:
                return Layer(number, z, critical, plane)
            told("another value", 0, 1)
            second = self._second(z, line)
            return Layer(number, z, critical, plane, second=second, confirmed=self._confirmed(plane, second))
        except TooLargeError:
            return Layer(number, z, critical, lack=Lack.TOO_LARGE)

    def _flat(self, cut: Section, admissibility: Admissibility, z: Any) -> Boundaries:
        """The boundary polynomials in the slice, in their old places.

        Where one vanishes on the whole slice, other verdicts are possible in it than near it: what bounds them is
        looked for in the slice itself.
        """
        flat = [cut.reduced(flattened(p, last_of(cut, z), cut.context)) for p in self.boundaries.factors]
        flat = [p if p == 0 else norm_of_factors(cut, p) for p in flat]
        if all(p != 0 for p in flat):
            return Boundaries(tuple(flat), self.boundaries.conditions, self.boundaries.vanishing)
        own = bounded(self.analysis, cut, admissibility)
        here = [p if p != 0 else cut.context.constant(1) for p in flat]
        further = [
            (p, why)
            for p, why in zip(own.factors, own.conditions, strict=True)
            if not any(q.gcd(p) == p / p.leading_coefficient() for q in here)
        ]
        lying = [
            condition for p, why in zip(flat, self.boundaries.conditions, strict=True) if p == 0 for condition in why
        ]
        return Boundaries(
            (*here, *(p for p, _ in further)),
            (*self.boundaries.conditions, *(why for _, why in further)),
            (*self.boundaries.vanishing, *lying),
        )

    def _second(self, z: Any, line: Line) -> Any:
        """Another value between the same critical ones."""
        interval = next(span for span in line.intervals if span.sample == z)
        last = line.high if interval.ends[1] is None else line.zeros[interval.ends[1]].number
        return between_simply(z, last)

    def _confirmed(self, plane: Map, z: Any) -> bool:
        """Whether the slice at another value corresponds to a map, with the verdicts of regions."""
        cut, admissibility = at_level(self.section, self.kept, z)
        flat = [flattened(p, z, cut.context) for p in self.boundaries.factors]
        there: Arrangement = decompose([p if p != 0 else cut.context.constant(1) for p in flat], box_of(cut.axes))
        judge = Judge(cut, admissibility)
        cells = [judge(Shape.REGION, region.id, Point(*region.sample)) for region in there.regions]
        decided = first_term_in(self.analysis, cut) if self.of is Of.STABILITY else None
        kinds = [(cell if decided is None else decided(cell)).kind for cell in cells]
        return alike(
            plane.arrangement,
            there,
            lambda shape, k: plane.regions[k].kind if shape == Shape.REGION else None,
            lambda shape, k: kinds[k] if shape == Shape.REGION else None,
        )


class _Fixed(Law):
    """The law of a section's energy where its last axis has a number of this sign."""

    def __init__(self, law: Law, sign: int) -> None:
        self._law, self._sign = law, sign
        self.everywhere, self.settled = law.everywhere, law.settled

    def shown(self, signs: tuple[int, ...]) -> tuple[bool, frozenset[Fact]]:
        return self._law.shown((*signs, self._sign))


def last_of(cut: Section, z: Any) -> Any:
    """What stands for the third axis in a slice: its value, or the generator of an irrational one."""
    return z if cut.constant is None else cut.context.gen(2)


def at_level(there: Section, admissibility: Admissibility, z: Number) -> tuple[Section, Admissibility]:
    """A section of three axes where the last has the value z, and what its points have to keep.

    An irrational z is the constant of the section.
    """
    axes = there.axes[:2]
    constant = Constant(z, {}, there.axes[2].name) if isinstance(z, AlgebraicNumber) else None
    plane = context_of([axis.name for axis in axes], constant)
    last = z if constant is None else plane.gen(2)

    def flat(p: Any) -> Any:
        image = flattened(p, last, plane)
        return image if constant is None else constant.reduced(image)

    def known(p: Any) -> Any:
        """The number that a polynomial is in the whole slice, or one of its sign; None where it depends on the axes."""
        if p == 0:
            return fmpq(0)
        if any(p.degrees()[:2]):
            return None
        return p.leading_coefficient() if constant is None else fmpq(constant.sign(p))

    parts = []
    for part in there.parts:
        m, d, g, k, n = (tuple(tuple(map(flat, row)) for row in matrix) for matrix in part.matrices)
        parts.append(replace(part, M=m, D=d, G=g, K=k, N=n, turned=tuple(map(flat, part.turned))))
    values = {} if constant is not None else {there.axes[2].name: rationals.fraction(z)}
    cut = replace(
        there,
        axes=axes,
        context=plane,
        parts=tuple(parts),
        law=_Fixed(there.law, sign(z) if constant is None else z.compare(fmpq(0))),
        undefined=tuple(x for x in map(flat, there.undefined) if not known(x)),
        numbers={**there.numbers, **values},
        told={**there.told, **values},
        constant=constant,
    )
    demands, broken = [], []
    for demand in admissibility.demands:
        polynomial = flat(demand.condition.polynomial)
        flat_demand = replace(demand, condition=replace(demand.condition, polynomial=polynomial))
        value = known(polynomial)
        if value is None:
            demands.append(flat_demand)
        elif not flat_demand.kept(value):
            broken.append(flat_demand)
    return cut, Admissibility(tuple(demands), tuple(broken), admissibility.left_out)


# --- pictures ---------------------------------------------------------------------------------------------------------


def _pictures(layers: Sequence[Layer]) -> tuple[Picture, ...]:
    """Neighbours that show the same, joined."""
    pictures: list[Picture] = []
    open_levels: list[Layer] = []
    for layer in layers:
        if layer.critical and layer.lack in (Lack.IRRATIONAL, Lack.TOO_LARGE):
            open_levels.append(layer)
            continue
        between = tuple(open_level.number for open_level in open_levels)
        if pictures and _same(layers[pictures[-1].shown], layer):
            last = pictures.pop()
            joined = (*last.layers, *between, layer.number)
            pictures.append(Picture(joined, _better(layers, last.shown, layer), (*last.unseen, *between)))
        else:
            pictures += [Picture((k,), k, (k,)) for k in between]
            pictures.append(Picture((layer.number,), layer.number))
        open_levels = []
    pictures += [Picture((open_level.number,), open_level.number, (open_level.number,)) for open_level in open_levels]
    return tuple(pictures)


def _better(layers: Sequence[Layer], shown: int, layer: Layer) -> int:
    """A slice between critical values stands for others rather than one at such a value."""
    return layer.number if layers[shown].critical and not layer.critical else shown


def _same(first: Layer, other: Layer) -> bool:
    """Whether two slices are one picture."""
    if first.plane is None or other.plane is None:
        reasons = [[x.condition.about for x in layer.broken] for layer in (first, other)]
        return first.lack is other.lack and first.lack is not None and reasons[0] == reasons[1]
    if first.plane.interrupted or other.plane.interrupted or not (first.confirmed and other.confirmed):
        return False
    return corresponding(seen(first.plane), seen(other.plane))


# What a picture of a map shows, as a graph: areas of one look, the lines drawn between them, points where they meet.
#
# Curves at which nothing changes are no part of it: regions on their two sides are one area where they look alike, and
# lines are one where only such a curve crosses them.


def seen(diagram: Map) -> Graph:
    """Areas, lines and points with their looks; lines have edges to the areas beside them and to their end points."""
    there = diagram.arrangement
    areas, lines = Joined(len(there.regions)), Joined(len(there.arcs))
    shown = [diagram.drawn(arc) for arc in diagram.arcs]
    for arc, visible in zip(there.arcs, shown, strict=True):
        below, above = arc.regions
        if not visible and below is not None and above is not None:
            areas.join(below, above)
    looks = [_line(diagram, arc) for arc in diagram.arcs]
    points: list[tuple[object, list[int]]] = []
    for corner, cell in zip(there.corners, diagram.corners, strict=True):
        ends = [k for k in corner.arcs if shown[k] for end in there.arcs[k].corners if end == corner.id]
        differs = stands_out(diagram, cell)
        plain = not differs and corner.kind is not CornerKind.SINGULAR
        if plain and len(ends) == 2 and looks[ends[0]] == looks[ends[1]]:
            lines.join(*ends)
        elif ends or differs:
            points.append((("point", corner.kind is CornerKind.EDGE, diagram.look(cell) if differs else None), ends))
    return _graph(diagram, areas, lines, [k for k, visible in enumerate(shown) if visible], looks, points)


def stands_out(diagram: Map, corner: Cell) -> bool:
    """Whether an isolated point has another verdict than the region around it."""
    if corner.judged is None or diagram.place(corner).kind is not CornerKind.ISOLATED:
        return False
    return any(x is not None and x.judged is not None and diagram.look(x) != diagram.look(corner)
               for x in diagram.around(corner))  # fmt: skip


def _line(diagram: Map, arc: Cell) -> object:
    """How an arc is drawn."""
    alone = not diagram.separates(arc)
    return diagram.place(arc).factors, diagram.look(arc) if alone else None


def _graph(
    diagram: Map,
    areas: Joined,
    lines: Joined,
    visible: list[int],
    looks: list[object],
    points: list[tuple[object, list[int]]],
) -> Graph:
    labels: list[object] = []
    nodes: dict[tuple[str, int], int] = {}
    for k, cell in enumerate(diagram.regions):
        if areas(k) == k:
            nodes["area", k] = len(labels)
            labels.append(("area", diagram.look(cell)))
    beside: dict[int, set[int]] = {}
    for k in visible:
        if lines(k) not in beside:
            nodes["line", lines(k)] = len(labels)
            labels.append(("line", looks[lines(k)]))
        sides = beside.setdefault(lines(k), set())
        sides |= {areas(x.number) for x in diagram.beside(diagram.arcs[k]) if x is not None}
    edges = [(nodes["line", k], nodes["area", r]) for k, sides in beside.items() for r in sorted(sides)]
    for label, meeting in points:
        edges += [(nodes["line", lines(k)], len(labels)) for k in meeting]
        labels.append(label)
    return Graph(tuple(labels), tuple(edges))
