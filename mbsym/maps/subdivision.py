"""Where an exact arrangement is out of reach: boxes that are halved until a verdict is proved on each, or left white.

Two ways to prove one verdict for all points of a box:

* ``ByBoundaries``: no boundary polynomial vanishes in it, so the verdict at its centre, which is exact, holds
  everywhere (``boundaries``).  About the centre p = sum c_ij u^i v^j with |u|, |v| <= 1; |c_00| greater than the sum
  of all other |c_ij| is the proof, in rational numbers.
* ``ByEnclosures``: the matrices of the first approximation over the whole box, as balls, are judged by theorems that
  need strict inequalities only (``problems.stability.enclosed``).  It needs no boundaries, and works where conditions
  are no polynomials; it proves less.

What is white is no statement: its share of the area is told.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Generic, Protocol, TypeVar

from flint import arb, ctx, fmpq

from mbsym.algebra.characteristic import characteristic_polynomial
from mbsym.algebra.matrices import added
from mbsym.algebra.plane.numbers import Rational, between, sign
from mbsym.algebra.plane.projection import Box, Polynomial, Progress, nothing
from mbsym.maps.section import Section
from mbsym.problems.stability import nonholonomic
from mbsym.problems.stability.enclosed import enclosed_verdict_with_cyclic
from mbsym.problems.stability.linear_form import LinearSystem
from mbsym.problems.stability.nonholonomic import to_the_right
from mbsym.problems.stability.verdict import Verdict, concluded, exactly
from mbsym.problems.stability.words import Because, Fact, Reason, Word

Proved = TypeVar("Proved")
Given = TypeVar("Given", covariant=True)

#: Working precision of enclosures over boxes, in bits: boxes are wide.
BITS = 64


class End(StrEnum):
    """Why no more boxes were halved."""

    DONE = "all boxes are proved or as small as asked for"
    BUDGET = "the number of boxes is used up"
    INTERRUPTED = "interrupted"


@dataclass(frozen=True)
class Tile(Generic[Proved]):
    """A box with what is proved of all its points; None: white."""

    box: Box
    proved: Proved | None


@dataclass(frozen=True)
class Subdivision(Generic[Proved]):
    """``tiles`` fill the box, without common inner points."""

    box: Box
    tiles: tuple[Tile[Proved], ...]
    end: End

    @property
    def white(self) -> Rational:
        """The share of the area of which nothing is proved, exactly."""
        total = fmpq(0)
        for tile in self.tiles:
            if tile.proved is None:
                total += tile.box.area
        return total / self.box.area

    def locate(self, x: Rational, y: Rational) -> Tile[Proved]:
        """A tile with the point; a proved one if there is one.  Raises ValueError outside of the box."""
        tiles = [tile for tile in self.tiles if (x, y) in tile.box]
        if not tiles:
            raise ValueError("a point outside of the box")
        return next((tile for tile in tiles if tile.proved is not None), tiles[0])


class Prover(Protocol[Given]):
    """``hint`` is handed from a box to its halves: what need not be shown again."""

    def __call__(self, box: Box, hint: Any) -> tuple[Given | None, Any]: ...


def subdivide(
    box: Box, prove: Prover[Proved], depth: int = 12, most: int = 20_000, progress: Progress = nothing
) -> Subdivision[Proved]:
    """Boxes halved across their longer side, in units of the whole, the largest first.

    Down to 2^-depth of the area, and at most so many boxes.  KeyboardInterrupt ends the work: what is proved is kept,
    the rest is white.
    """
    done: list[Tile[Proved]] = []
    open_: list[tuple[int, int, Box, Any]] = [(0, 0, box, None)]
    made, end = 1, End.DONE
    while open_:
        level, number, current, hint = heapq.heappop(open_)
        try:
            progress("boxes", made, most)
            proved, hint = prove(current, hint)
        except KeyboardInterrupt:
            end = End.INTERRUPTED
            open_.append((level, number, current, hint))
            break
        if proved is not None or level >= depth:
            done.append(Tile(current, proved))
            continue
        if made + 2 > most:
            end = End.BUDGET
            done.append(Tile(current, None))
            continue
        for half in halves(current, box):
            made += 1
            heapq.heappush(open_, (level + 1, made, half, hint))
    done += [Tile(pending[2], None) for pending in open_]
    return Subdivision(box, tuple(done), end)


def halves(box: Box, whole: Box) -> tuple[Box, Box]:
    """The halves of a box across the side that is longer as a part of the whole."""
    wide = (box.x1 - box.x0) * (whole.y1 - whole.y0) >= (box.y1 - box.y0) * (whole.x1 - whole.x0)
    if wide:
        x = (box.x0 + box.x1) / 2
        return Box(box.x0, x, box.y0, box.y1), Box(x, box.x1, box.y0, box.y1)
    y = (box.y0 + box.y1) / 2
    return Box(box.x0, box.x1, box.y0, y), Box(box.x0, box.x1, y, box.y1)


def centre(box: Box) -> tuple[Rational, Rational]:
    """The middle of a box."""
    return (box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2


def about_centre(p: Polynomial, box: Box) -> tuple[Rational, Rational]:
    """(c, r) with |p - c| <= r everywhere in the box."""
    x, y = centre(box)
    context = p.context()
    u, v = context.gens()
    moved = p.compose(u * ((box.x1 - box.x0) / 2) + x, v * ((box.y1 - box.y0) / 2) + y, ctx=context)
    middle, radius = fmpq(0), fmpq(0)
    for powers, value in moved.to_dict().items():
        if any(powers):
            radius += abs(value)
        else:
            middle = value
    return middle, radius


class ByBoundaries(Generic[Proved]):
    """The verdict at the centre of a box in which no boundary polynomial vanishes.

    ``judge`` gives what is proved at a rational point.  The hint lists the polynomials that may still vanish.
    """

    def __init__(self, boundaries: Sequence[Polynomial], judge: Callable[[Rational, Rational], Proved]) -> None:
        self._boundaries, self._judge = tuple(boundaries), judge

    def __call__(self, box: Box, hint: Any) -> tuple[Proved | None, Any]:
        left = []
        for p in self._boundaries if hint is None else hint:
            middle, radius = about_centre(p, box)
            if abs(middle) <= radius:
                left.append(p)
        return (None if left else self._judge(*centre(box))), tuple(left)


class ByEnclosures:
    """The verdict of theorems that the first approximation of a section shows over a whole box.

    Routh's scheme with the characteristic polynomial's coefficients over the box comes first; then the matrices.
    """

    def __init__(self, section: Section) -> None:
        self._section = section
        self._polynomials = [_characteristic(part) for part in section.parts]

    def __call__(self, box: Box, hint: Any) -> tuple[Verdict | None, Any]:
        verdict = self.verdict(box)
        return (None if verdict.word is Word.UNDECIDED else verdict), None

    def verdict(self, box: Box) -> Verdict:
        """The combined verdict; undecided where the balls leave it open."""
        ranges = ((box.x0, box.x1), (box.y0, box.y1))
        if any(a <= 0 <= b for a, b in ranges):
            parts, one_energy = self._section.parts, self._section.one_energy
        else:
            parts, one_energy = self._section.judged([sign(a) for a, _ in ranges])
        pairs = zip(parts, self._polynomials, strict=True)
        verdicts = ((part, _enclosed(part, polynomial, box)) for part, polynomial in pairs)
        return self._section.whole((exactly(x) if part.exact else x for part, x in verdicts), one_energy)


def _characteristic(part: LinearSystem) -> tuple[Polynomial, ...]:
    """The coefficients of the determinant, without those that a part's followers make vanish at its end."""
    whole = characteristic_polynomial(part.M, added(part.D, part.G), added(part.K, part.N))
    return tuple(whole[: len(whole) - len(part.following)])


def _enclosed(part: LinearSystem, polynomial: Sequence[Polynomial], box: Box) -> Verdict:
    zero_power = next((k for k, c in enumerate(polynomial) if c != 0), 0)
    if part.nonholonomic is None:
        with ctx.workprec(BITS):
            right = to_the_right([_ball(c, box) for c in polynomial[zero_power:]])
        if right:
            return concluded({Fact.ROOT_RIGHT}, Reason(Because.RIGHT_ROOTS, (right,)))
        if right == 0 == zero_power:
            return concluded({Fact.ROOTS_LEFT})
    matrices = [[[_ball(entry, box) for entry in row] for row in matrix] for matrix in part.matrices]
    if part.nonholonomic is not None:
        return nonholonomic.enclosed(part.nonholonomic, matrices, zero_power, BITS, exact=part.exact)
    cyclic = part.cyclic if not part.driven else ()
    return enclosed_verdict_with_cyclic(matrices, part.conservative, cyclic, BITS, part.exact)


def _ball(entry: Polynomial, box: Box) -> Any:
    """An entry over a box; one that vanishes identically is exactly 0."""
    if entry == 0:
        return arb(0)
    middle, radius = about_centre(entry, box)
    return between(middle - radius, middle + radius, BITS)
