"""Branches of relative equilibria over one parameter, as a map with what goes on from cell to cell."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from enum import StrEnum

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.plane.numbers import Number
from mbsym.maps.branches_events import Event, Named
from mbsym.maps.result import Cell, Map
from mbsym.problems.relative_equilibria.equilibria import CoordinateValue, RelativeEquilibrium
from mbsym.problems.stability.verdict import Verdict


class Doubt(StrEnum):
    """Why something is not proved."""

    UNFINISHED = "the exact solution is not finished"
    THROUGHOUT = "singular equilibria over a whole interval of the parameter"
    STABILITY = "where the stability changes is not solved"
    UNCOUNTED = "equilibria at a critical value are not all solved"
    MISMATCH = "counts beside a critical value contradict what was found there"
    INCOMPLETE = "the list at a sample is not complete"
    FAMILIES = "equilibria at a sample are not isolated"


@dataclass(frozen=True)
class Remark:
    """A doubt, with its reason and the number of the interval or critical value that it is about."""

    doubt: Doubt
    about: str = ""


@dataclass(frozen=True)
class Meeting:
    """An equilibrium at a critical value: what it is on the curve, and its verdict there.

    ``values`` of the coordinates, in the angles of ``coordinates_of``; ``verdict`` is None where it was not sought.
    """

    values: tuple[CoordinateValue, ...]
    coordinates_of: str
    named: Named
    verdict: Verdict | None


@dataclass(frozen=True)
class Critical:
    """What happens, or may, at a value of the parameter.

    ``meetings``: the equilibria there; None where they could not be counted.  ``continuum``: some are not isolated.
    ``border``: on some solution an unknown is at infinity, a root or a denominator zero, or the mass matrix singular.
    ``rank_lost``: equilibria tend to positions in which the constraints have another rank, or are there.
    ``tried``: nothing was solved there, but the numbers of equilibria at values tried on both sides differ.
    ``balance``: whether the counts on both sides agree with the events named (None: an end, or nothing to compare).
    """

    meetings: tuple[Meeting, ...] | None
    continuum: bool
    border: bool
    balance: bool | None = None
    rank_lost: bool = False
    tried: bool = False

    @property
    def events(self) -> tuple[Event, ...]:
        """What happens, each as often as it does."""
        found = [meeting.named.event for meeting in self.meetings or () if meeting.named.event is not Event.REGULAR]
        return (*found, Event.CONTINUUM) if self.continuum else tuple(found)


@dataclass(frozen=True)
class Piece:
    """A branch over an interval: equilibrium number ``number`` of its sample.

    ``throughout``: whether the verdict at the sample is proved for the whole open interval.
    ``start``, ``end``: the meeting at the critical value below and above which it tends to, found by following it in
    floating point; None where it is not told.  ``parameter``, ``values``: points for pictures, rounded.
    """

    interval: int
    number: int
    throughout: bool
    start: int | None
    end: int | None
    parameter: tuple[float, ...]
    values: tuple[tuple[float, ...], ...]


@dataclass(frozen=True, kw_only=True)
class Branches(Map):
    """Cells are intervals, with the equilibria at their samples, and critical values between them, or at the ends.

    ``pieces`` of branches, interval by interval.  ``coordinates``: those that the equations contain.
    """

    coordinates: tuple[str, ...]
    pieces: tuple[Piece, ...]
    remarks: tuple[Remark, ...]

    @property
    def intervals(self) -> list[Cell]:
        """Those that were reached."""
        return [region for region in self.regions if region.counted is not None]

    @property
    def criticals(self) -> list[Cell]:
        """The critical values that were reached, each with ``critical``."""
        return [corner for corner in self.corners if corner.said is not None]

    def critical(self, at: Cell) -> Critical:
        """What happens at a critical value."""
        assert isinstance(at.said, Critical)
        return at.said

    def equilibria(self, interval: Cell) -> tuple[RelativeEquilibrium, ...]:
        """Those at a sample."""
        return () if interval.counted is None else interval.counted.equilibria

    def ends(self, interval: Cell) -> tuple[Number, Number]:
        """From where to where an interval goes."""
        line, (first, last) = self.line, self.place(interval).ends
        low, high = (None if k is None else line.zeros[k].number for k in (first, last))
        return line.low if low is None else low, line.high if high is None else high

    def sides(self, at: Cell) -> tuple[Cell | None, Cell | None]:
        """The intervals below and above a critical value, where they were reached."""
        below, above = (cell if cell is not None and cell.counted is not None else None for cell in self.beside(at))
        return below, above

    def count_changes(self, at: Cell) -> bool:
        """Whether there are other numbers of equilibria on the two sides."""
        below, above = self.sides(at)
        return below is None or above is None or len(self.equilibria(below)) != len(self.equilibria(above))

    def leaves(self, at: Cell) -> bool:
        """Whether equilibria go to infinity or to a border: what is found there does not account for the counts."""
        critical = self.critical(at)
        if not critical.border or critical.meetings is None:
            return critical.border
        for side, name in zip(self.sides(at), ("below", "above"), strict=True):
            near = [getattr(x.named, name) for x in critical.meetings]
            if side is not None and (None in near or sum(near) != len(self.equilibria(side))):
                return True
        return False

    def verdict_changes(self, at: Cell) -> bool:
        """Whether a branch that goes on regularly has other verdicts on the two sides, or cannot be told apart."""
        below, above = self.sides(at)
        if below is None or above is None:
            return False
        words = [Counter(x.verdict.word for x in self.equilibria(side)) for side in (below, above)]
        if words[0] != words[1]:
            return True
        meetings = self.critical(at).meetings or ()
        return any(
            self.verdict(a).word is not self.verdict(b).word
            for a in self.pieces
            for b in self.pieces
            if (a.interval, b.interval) == (below.number, above.number)
            and a.end is not None
            and a.end == b.start
            and meetings[a.end].named.event is Event.REGULAR
        )

    def verdict(self, piece: Piece) -> Verdict:
        """The verdict at the sample of a piece's interval."""
        return self.equilibria(self.regions[piece.interval])[piece.number].verdict

    def certain(self, at: Cell) -> bool:
        """Whether the verdicts on both sides are proved up to a critical value."""
        sides = [side.number for side in self.sides(at) if side is not None]
        return all(x.throughout for x in self.pieces if x.interval in sides)

    def happens(self, at: Cell) -> bool:
        """Whether anything is to be told of a critical value."""
        critical = self.critical(at)
        changed = None not in self.sides(at) and self.count_changes(at)
        changed = changed or self.leaves(at) or self.verdict_changes(at)
        return bool(critical.events) or critical.balance is False or changed

    def between(self, interval: Cell) -> tuple[Cell | None, Cell | None]:
        """The critical values at which an interval starts and ends, where they were reached."""
        first, last = (
            None if k is None or self.corners[k].said is None else self.corners[k] for k in self.place(interval).ends
        )
        return first, last

    def spans(self) -> list[tuple[Cell, Cell]]:
        """The first and last of the intervals between which nothing happens, in their order."""
        found: list[tuple[Cell, Cell]] = []
        for interval in self.intervals:
            start = self.between(interval)[0]
            if found and start is not None and not self.happens(start):
                found[-1] = found[-1][0], interval
            else:
                found.append((interval, interval))
        return found

    @property
    def proved(self) -> bool:
        """Whether the numbers of equilibria are proved everywhere in the open intervals."""
        return not self.interrupted and all(interval.certainty is Certainty.PROVED for interval in self.intervals)
