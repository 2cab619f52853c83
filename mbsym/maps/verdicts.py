"""The verdict of problem 6 at a point of a section."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from flint import fmpq, fmpq_mat

from mbsym.algebra import rationals
from mbsym.algebra.arrangements.arrangement import Arrangement
from mbsym.algebra.plane.line import Line
from mbsym.algebra.roots import count_real_roots
from mbsym.maps.section import Section
from mbsym.problems.stability.exact import inertia
from mbsym.problems.stability.exact import verdict_at as exact_verdict
from mbsym.problems.stability.linear_form import LinearSystem
from mbsym.problems.stability.verdict import Verdict


class Border(StrEnum):
    """What is special about the roots at a point of a curve."""

    ZERO = "zero root"
    IMAGINARY = "imaginary pair"
    SEMISIMPLE = "coincidence, semisimple"
    JORDAN = "coincidence, Jordan block"
    MASS = "mass matrix singular"


@dataclass(frozen=True)
class Judged:
    """``verdict``: of the whole system.  Roots and eigenvalues are counted with multiplicity, over all subsystems.

    ``right``: roots with a positive real part; ``real_right`` of them are real (divergence, the others: flutter).
    ``degree``: negative eigenvalues of K (Poincare's degree of instability), ``null``: its zero ones.  Counts are None
    where M is singular or they are not decided.  ``border``: on curves and corners.
    """

    verdict: Verdict
    right: int | None
    real_right: int | None
    degree: int | None
    null: int | None
    border: Border | None = None


def verdict_at(section: Section, point: Sequence[Any]) -> Judged:
    """The exact verdict at a rational point, coordinates in the order of the axes."""
    values = {k: rationals.fraction(x) for k, x in enumerate(point)}
    parts, one_energy = section.judged([(x > 0) - (x < 0) for x in point])
    verdicts = [exact_verdict(part, values) for part in parts]
    verdict = section.whole((part_verdict.verdict for part_verdict in verdicts), one_energy)
    signature = [inertia(stiffness_at(part, point)) for part in parts]
    degree, null = sum(counts[2] for counts in signature), sum(counts[1] for counts in signature)
    right: int | None = 0
    real: int | None = 0
    for point_verdict in verdicts:
        if point_verdict.roots is None or right is None or real is None:
            right = real = None
            break
        right += point_verdict.roots.right
        real += count_real_roots(point_verdict.characteristic)[2] if point_verdict.roots.right else 0
    return Judged(verdict, right, real, degree, null)


def stiffness_at(part: LinearSystem, point: Sequence[Any]) -> Any:
    """K at a rational point."""
    return matrix_at(part.K, point)


def matrix_at(matrix: Any, point: Sequence[Any]) -> Any:
    """A matrix of polynomials in the axes at a rational point, as a ``flint.fmpq_mat``."""
    n = len(matrix)
    return fmpq_mat(n, n, [fmpq(x(*point)) for row in matrix for x in row])


# What continuity demands of counts on curves and at corners: a check of verdicts there that asks nobody for a verdict.
#
# Roots depend continuously on the parameters, and those to the right of the imaginary axis stay there nearby: at a
# point there are at most as many of them as in any region beside it.  The same holds for the negative eigenvalues of
# K, of which in turn there are beside the point at most as many as are negative or zero at it.


Verdicts = Sequence[Judged | None]


def jumps(
    decomposition: Arrangement | Line, regions: Verdicts, arcs: Verdicts, corners: Verdicts
) -> tuple[list[int], list[int]]:
    """The arcs and the corners (zeros of a line) whose counts do not fit those of the regions beside them."""
    if isinstance(decomposition, Line):
        beside = [[part.id for part in decomposition.intervals if zero.id in part.ends] for zero in decomposition.zeros]
        return [], list(_misfits(corners, beside, regions))
    by_arc = {arc.id: [k for k in arc.regions if k is not None] for arc in decomposition.arcs}
    # an arrangement that breaks a law may lack arcs: that is found elsewhere
    by_corner = [[k for arc in corner.arcs for k in by_arc.get(arc, ())] for corner in decomposition.corners]
    by_corner = [
        near or _around(decomposition, corner.place)
        for near, corner in zip(by_corner, decomposition.corners, strict=True)
    ]
    return list(_misfits(arcs, [*by_arc.values()], regions)), list(_misfits(corners, by_corner, regions))


def _around(arrangement: Arrangement, place: tuple[int, int]) -> list[int]:
    """The region around an isolated point."""
    at, j = place
    places = ((at, k) for k in (j, j - 1))
    return [arrangement.places.intervals[key] for key in places if key in arrangement.places.intervals]


def _misfits(points: Verdicts, beside: Sequence[Sequence[int]], regions: Verdicts) -> Iterator[int]:
    for k, (here, near) in enumerate(zip(points, beside, strict=False)):
        there = [regions[r] for r in near if r < len(regions)]
        if here is not None and any(judged is not None and not _fits(here, judged) for judged in there):
            yield k


def _fits(here: Judged, beside: Judged) -> bool:
    if here.right is not None and beside.right is not None and here.right > beside.right:
        return False
    if here.degree is None or here.null is None or beside.degree is None:
        return True
    return here.degree <= beside.degree <= here.degree + here.null
