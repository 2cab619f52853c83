"""``map.json`` of ``mbsym map``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

from msgspec import UNSET, Meta, UnsetType

from mbsym.algebra.plane import Point
from mbsym.maps.admissible import Demand as Demanded
from mbsym.maps.boundaries import OF_EQUILIBRIA, Origin
from mbsym.maps.boxes import Method
from mbsym.maps.check import Mistake
from mbsym.maps.result import Lack, Of
from mbsym.maps.soft_borders import Onset
from mbsym.maps.subdivision import End
from mbsym.maps.verdicts import Border
from mbsym.report.documents.base import From, Hashed, Part, or_null, words
from mbsym.report.documents.parts import Axis, Number, Verdict

#: Which condition a curve comes from.
ORIGINS = tuple(x.value for x in Origin if x not in OF_EQUILIBRIA)
#: Whether there is a verdict at a place, and if not, why.
STANDINGS = ("judged", *(Lack.OUTSIDE, Lack.MASSLESS, Lack.UNDEFINED, Lack.TOO_LARGE, Lack.WITHDRAWN, Lack.NOT_REACHED))


def demanded(demands: Sequence[Demanded]) -> list[str]:
    """What is demanded, in words, or the polynomials that should have a sign."""
    return [x.condition.about or str(x.condition.polynomial) for x in demands]


def _coordinates(point: Any) -> tuple[Any, ...]:
    return (point.x, point.y) if isinstance(point, Point) else (point,)


#: What is proved at a place, field by field: files have them in orders of their own.
StandingThere = Annotated[str, words(*STANDINGS), "whether there is a verdict, and if not, why", From("standing")]
Broken = Annotated[list[str], "what is not kept there", From("broken", demanded)]
VerdictThere = Annotated[
    Verdict | None,
    "the verdict of problem 6, without terms of higher order; nothing where none is given",
    From("judged.verdict"),
]
UnstableRoots = Annotated[
    int | None, "roots with a positive real part, with multiplicity, over all subsystems", From("judged.right")
]
RealUnstableRoots = Annotated[int | None, "how many of them are real", From("judged.real_right")]
NegativeEigenvalues = Annotated[int | None, "Poincare's degree of instability", From("judged.degree")]
ZeroEigenvalues = Annotated[int | None, "how many of K's eigenvalues vanish", From("judged.null")]
BorderOf = Annotated[Border | None, "of arcs and corners: what is special about the roots there", From("judged.border")]


class Condition(Part, frozen=True):
    """a condition of which the curve is a border"""

    origin: Annotated[str, words(*ORIGINS), "which condition it is"]
    subsystem: Annotated[
        int | None,
        "the subsystem it belongs to, by its place in subsystems; nothing for the whole system",
        From("part"),
    ]
    about: Annotated[str, "which factor, assumption, parameter or body"]
    reduced: Annotated[bool, "whether it belongs to the system that Routh's reduction leaves"]


class Demand(Condition, frozen=True):
    """polynomial relation 0"""

    polynomial: Annotated[str, "in the axes"]
    relation: Annotated[str, words(">", ">=", "!="), "to zero"]


class Curve(Part, frozen=True):
    """a curve"""

    number: Annotated[int, "its place in this list"]
    polynomial: Annotated[str, "in the axes"]
    conditions: Annotated[list[Condition], "the conditions that it comes from"]


class Finding(Part, frozen=True):
    """a disagreement"""

    mistake: Annotated[Mistake, "what does not agree"]
    region: Annotated[int | None, "the region it is about"]
    arc: Annotated[int | None, "the arc it is about"]
    corner: Annotated[int | None, "the corner it is about"]
    near: Annotated[list[float], "about where"]


class MapCheck(Part, frozen=True):
    """more points judged by a route without the boundary polynomials; nothing where that was not done"""

    points: Annotated[int, "points in regions"]
    arcs: Annotated[int, "points on arcs"]
    enclosed: Annotated[int, "points in regions at which enclosures of the eigenvalues decide all counts"]
    findings: Annotated[list[Finding], "what did not agree"]


class Place(Part, frozen=True, kw_only=True):
    """a place and what is proved there"""

    number: Annotated[int, "its place in this list"]
    point: Annotated[
        list[Number], "the exact point at which it was judged, a coordinate for each axis", From("sample", _coordinates)
    ]
    standing: StandingThere
    broken: Broken
    stability: VerdictThere
    unstable_roots: UnstableRoots
    real_unstable_roots: RealUnstableRoots
    negative_eigenvalues_of_K: NegativeEigenvalues
    zero_eigenvalues_of_K: ZeroEigenvalues
    border: BorderOf
    nonlinear: Annotated[
        Verdict | UnsetType,
        "of a verdict that leaves the motion open, or stable where energy may be lost: what the nonlinear system shows "
        "at the exact point alone",
        From(),
    ] = UNSET


class Region(Place, frozen=True, kw_only=True):
    """a region"""

    signs: Annotated[list[int], "signs of the curves' polynomials there"]
    arcs: Annotated[list[int], "the arcs that bound it"]
    ends: Annotated[
        list[int | None] | UnsetType, "of an interval: the corners at which it ends; nothing: an end of the line"
    ] = UNSET
    area: Annotated[float, "its area"]
    area_error: Annotated[float, "an estimate of the area's error"]


class Along(Part, frozen=True):
    """a stretch"""

    axis: Annotated[
        int, words(0, 1), "by which axis the stretch is told: 0, or 1 along a line on which the first axis is constant"
    ]
    from_: Annotated[Number, "where it starts, by its axis", From("start")]
    to: Annotated[Number, "where it ends", From("end")]
    onset: Annotated[str, words("soft", "hard", "open"), "soft, hard or open"]


class SoftOrHard(Part, frozen=True):
    """what they decide"""

    onset: Annotated[
        Onset,
        "at the exact point, where stability is lost: soft (asymptotically stable there; small oscillations arise "
        "beyond), hard (unstable there), or open; neither, where it is not lost or that is not known",
    ]
    reason: Annotated[
        str,
        words(
            "",
            "zero-root",
            "equal-frequencies",
            "equal-more",
            "more-pairs",
            "mixed-roots",
            "coefficient-open",
            "constraints",
            "exactly-linear",
            "unsolved-conditions",
            "no-expansion",
            "no-loss",
            "one-side",
        ),
        "why it is open: of problem 11, or why there is no expansion; or why it is neither",
        From("why"),
    ]
    frequency: Annotated[float | None, "w of the pair +-i w at the point"]
    coefficient: Annotated[float | None, "a of r' = a r^3 at the point"]
    amplitude_of: Annotated[str, "the coordinate whose amplitude r is"]
    along: Annotated[
        list[Along] | None,
        "of an arc: its stretches with what holds on each but for its ends; one: it holds on the whole arc but for "
        "its corners; nothing: only the point is decided",
        From("stretches"),
    ]


SoftOrHardThere = Annotated[
    SoftOrHard | UnsetType | None,
    "where a pair of roots is imaginary and none to the right: what terms of third order decide; nothing "
    "elsewhere, or where that was not asked",
]


class Arc(Place, frozen=True, kw_only=True):
    """an arc"""

    soft_or_hard: SoftOrHardThere = UNSET
    curves: Annotated[list[int], "the curves that it is part of"]
    regions: Annotated[
        list[int | None],
        "below and above its point, or left and right of a vertical line; nothing: outside of the plane",
    ]
    corners: Annotated[list[int | None], "where it starts and ends; nothing: it is closed"]
    separates: Annotated[bool, "whether what the picture shows differs between its sides"]


class Corner(Place, frozen=True, kw_only=True):
    """a corner"""

    soft_or_hard: SoftOrHardThere = UNSET
    curves: Annotated[list[int], "the curves through it"]
    arcs: Annotated[list[int], "the arcs that meet there"]
    kind: Annotated[str, words("crossing", "singular", "isolated", "edge", "zero"), "what it is"]


class Picture(Part, frozen=True):
    """slices in which the same is shown, and all values of the third axis between them"""

    slices: Annotated[list[int], "by their numbers", From("layers")]
    shown: Annotated[int, "the slice that stands for them"]
    not_looked_at: Annotated[
        list[int], "slices among them that were not looked at: nothing is said of these single values", From("unseen")
    ]
    low: Annotated[Number, "from this value of the third axis"]
    low_belongs: Annotated[bool, "whether that value belongs to it"]
    high: Annotated[Number, "to this value"]
    high_belongs: Annotated[bool, "whether that value belongs to it"]


class Slice(Part, frozen=True):
    """a slice; between two critical values regions, with their verdicts, are deformed into each other"""

    number: Annotated[int, "its place in this list"]
    value: Annotated[Number, "the value of the third axis", From("z")]
    critical: Annotated[bool, "whether the arrangement of the curves may be another one on its two sides"]
    missing: Annotated[
        str | None,
        words(Lack.IRRATIONAL, Lack.OUTSIDE, Lack.TOO_LARGE, Lack.NOT_REACHED),
        "why there is no map of it",
        From("lack"),
    ]
    broken: Annotated[list[str], "what no point of it keeps", From(by=demanded)]
    further_curves: Annotated[
        list[Curve],
        "curves that bound something in this slice alone; others are those of the whole, which may vanish in the slice",
    ]
    second: Annotated[
        str | None, "another value between the same critical ones, at which the slice was decomposed to be compared"
    ]
    confirmed: Annotated[bool, "whether that one corresponds to it, with the verdicts of its regions"]
    interrupted: Annotated[bool, "whether some places were not reached"]
    check: Annotated[MapCheck | None, "more points of this slice", From("plane.check")]
    regions: Annotated[
        list[Region],
        "connected regions of the slice; the signs are those of the curves, 1 for one that vanishes in the whole "
        "slice; at an irrational value those of their norms, products over its conjugates",
    ]
    arcs: Annotated[list[Arc], "smooth arcs of curves in the slice"]
    corners: Annotated[list[Corner], "points of the slice"]


class Statement(Part, frozen=True):
    """a statement"""

    standing: StandingThere
    broken: Broken
    stability: VerdictThere
    unstable_roots: UnstableRoots
    real_unstable_roots: RealUnstableRoots
    negative_eigenvalues_of_K: NegativeEigenvalues
    zero_eigenvalues_of_K: ZeroEigenvalues
    border: BorderOf


class Box(Part, frozen=True):
    """a box"""

    edges: Annotated[list[str], "exact: left, right, lower, upper", Meta(min_length=4, max_length=4)]
    statement: Annotated[int | None, "what is proved of it, by its place in statements; nothing: white"]


class Subdivision(Part, frozen=True):
    """of planes without an exact arrangement: boxes, each with what is proved at all of its points"""

    because: Annotated[
        str | None, "why there is no exact arrangement; nothing where boxes were asked for", From(by=or_null)
    ]
    method: Annotated[Method, "how boxes are proved"]
    end: Annotated[End, "why no more boxes were halved", From("subdivision.end")]
    white: Annotated[str, "exact share of the area of which nothing is proved", From("subdivision.white")]
    statements: Annotated[list[Statement], "what is proved of boxes, each once"]
    boxes: Annotated[list[Box], "they fill the plane"]


class Map(Hashed, frozen=True, kw_only=True):
    """A plane of two parameters divided into regions, arcs and corners, or a line of one parameter divided into
    intervals (regions) and points (corners), each with what was proved there; or a stack of slices over three
    parameters, regions, arcs and corners within each.
    """

    of: Annotated[str, words(Of.STABILITY, Of.SIGNATURE), "what the picture is coloured by"]
    axes: Annotated[list[Axis], "to the right, upwards, and the one that is different in every slice"]
    values: Annotated[dict[str, str], "exact numbers that were put in for parameters and symbols, by name"]
    constant: Annotated[
        str | None, "an irrational number among the coefficients, if there is one", From("section.constant.text")
    ]
    subsystems: Annotated[
        list[Annotated[list[str], "its coordinates"]], "coordinates of each subsystem", From("section.coordinates")
    ]
    demands: Annotated[list[Demand], "what parameters have to keep: declared signs, assumptions, triangle inequalities"]
    left_out: Annotated[
        list[str], "what they have to keep besides, but cannot be expressed in the axes", From("admissibility.left_out")
    ]
    curves: Annotated[list[Curve], "irreducible polynomials whose zeros are the curves"]
    vanishing: Annotated[
        list[Condition], "conditions that are equalities in the whole plane", From("boundaries.vanishing")
    ]
    interrupted: Annotated[bool, "whether some places were not reached"]
    check: Annotated[MapCheck | None, "the map's check of itself"]
    regions: Annotated[list[Region], "open regions of one verdict each"]
    arcs: Annotated[list[Arc], "smooth arcs of curves between corners; what is told of one is found at its point"]
    corners: Annotated[list[Corner], "points where curves cross, touch, are singular or isolated, or meet the edge"]
    pictures: Annotated[
        list[Picture] | UnsetType, "of maps over three axes: neighbouring slices in which the same is shown"
    ] = UNSET
    slices: Annotated[
        list[Slice] | UnsetType,
        "of maps over three axes: the slices at all critical values of the third, and at one value between any two, "
        "ascending",
    ] = UNSET
    subdivision: Subdivision | UnsetType = UNSET
