"""What continuity demands of counts on curves and at corners: a check of verdicts there that asks nobody for a verdict.

Roots depend continuously on the parameters, and those to the right of the imaginary axis stay there nearby: at a point
there are at most as many of them as in any region beside it.  The same holds for the negative eigenvalues of K, of
which in turn there are beside the point at most as many as are negative or zero at it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mbsym.algebra.arrangements.arrangement import Arrangement
from mbsym.algebra.plane.line import Line
from mbsym.maps.verdicts import Judged

Verdicts = Sequence[Judged | None]


def jumps(
    found: Arrangement | Line, regions: Verdicts, arcs: Verdicts, corners: Verdicts
) -> tuple[list[int], list[int]]:
    """The arcs and the corners (zeros of a line) whose counts do not fit those of the regions beside them."""
    if isinstance(found, Line):
        beside = [[one.id for one in found.intervals if zero.id in one.ends] for zero in found.zeros]
        return [], list(_misfits(corners, beside, regions))
    by_arc = {arc.id: [k for k in arc.regions if k is not None] for arc in found.arcs}
    # an arrangement that breaks a law may lack arcs: that is found elsewhere
    by_corner = [[k for arc in one.arcs for k in by_arc.get(arc, ())] for one in found.corners]
    by_corner = [near or _around(found, one.place) for near, one in zip(by_corner, found.corners, strict=True)]
    return list(_misfits(arcs, [*by_arc.values()], regions)), list(_misfits(corners, by_corner, regions))


def _around(found: Arrangement, place: tuple[int, int]) -> list[int]:
    """The region around an isolated point."""
    at, j = place
    places = ((at, k) for k in (j, j - 1))
    return [found.places.intervals[key] for key in places if key in found.places.intervals]


def _misfits(points: Verdicts, beside: Sequence[Sequence[int]], regions: Verdicts) -> Iterator[int]:
    for k, (here, near) in enumerate(zip(points, beside, strict=False)):
        there = [regions[r] for r in near if r < len(regions)]
        if here is not None and any(one is not None and not _fits(here, one) for one in there):
            yield k


def _fits(here: Judged, beside: Judged) -> bool:
    if here.right is not None and beside.right is not None and here.right > beside.right:
        return False
    if here.degree is None or here.null is None or beside.degree is None:
        return True
    return here.degree <= beside.degree <= here.degree + here.null
