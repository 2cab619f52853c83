"""Branches of relative equilibria over one parameter, as values."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction

from mbsym.algebra.plane.numbers import Number, compare
from mbsym.maps.branches_events import Event, Named
from mbsym.maps.section import Axis
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
    """A value of the parameter at which something happens, or may: ``number`` is exact.

    ``meetings``: the equilibria there; None where they could not be counted.  ``continuum``: some are not isolated.
    ``border``: on some solution an unknown is at infinity, a root or a denominator zero, or the mass matrix singular.
    ``balance``: whether the counts on both sides agree with the events named (None: an end, or nothing to compare).
    """

    number: Number
    meetings: tuple[Meeting, ...] | None
    continuum: bool
    border: bool
    balance: bool | None

    @property
    def events(self) -> tuple[Event, ...]:
        """What happens, each as often as it does."""
        found = [one.named.event for one in self.meetings or () if one.named.event is not Event.REGULAR]
        return (*found, Event.CONTINUUM) if self.continuum else tuple(found)


@dataclass(frozen=True)
class Interval:
    """Between two critical values (or ends): ``sample`` is rational, ``equilibria`` those there, ``constant`` whether
    their number is proved to be the same in the whole open interval."""

    low: Number
    high: Number
    sample: Fraction
    equilibria: tuple[RelativeEquilibrium, ...]
    constant: bool

    @property
    def stable(self) -> int:
        return sum(one.verdict.stable for one in self.equilibria)

    @property
    def undecided(self) -> int:
        """Those of which nothing decides whether they are stable."""
        return sum(one.verdict.word.open for one in self.equilibria)


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


@dataclass(frozen=True)
class Branches:
    """``criticals`` ascending; ``intervals`` between them; ``pieces`` of branches, interval by interval.

    ``given``: the numbers of the other parameters.  ``coordinates``: those that the equations contain.
    """

    axis: Axis
    given: Mapping[str, Fraction]
    coordinates: tuple[str, ...]
    criticals: tuple[Critical, ...]
    intervals: tuple[Interval, ...]
    pieces: tuple[Piece, ...]
    remarks: tuple[Remark, ...]
    interrupted: bool = False

    def sides(self, one: Critical) -> tuple[int | None, int | None]:
        """The numbers of the intervals below and above a critical value."""
        below = [k for k, x in enumerate(self.intervals) if compare(x.high, one.number) == 0]
        above = [k for k, x in enumerate(self.intervals) if compare(x.low, one.number) == 0]
        return (below[0] if below else None), (above[0] if above else None)

    def count_changes(self, one: Critical) -> bool:
        """Whether there are other numbers of equilibria on the two sides."""
        below, above = self.sides(one)
        if below is None or above is None:
            return True
        return len(self.intervals[below].equilibria) != len(self.intervals[above].equilibria)

    def leaves(self, one: Critical) -> bool:
        """Whether equilibria go to infinity or to a border: what is found there does not account for the counts."""
        if not one.border or one.meetings is None:
            return one.border
        sides = zip(self.sides(one), ("below", "above"), strict=True)
        for k, side in sides:
            near = [getattr(x.named, side) for x in one.meetings]
            if k is not None and (None in near or sum(near) != len(self.intervals[k].equilibria)):
                return True
        return False

    def verdict_changes(self, one: Critical) -> bool:
        """Whether a branch that goes on regularly has other verdicts on the two sides, or cannot be told apart."""
        below, above = self.sides(one)
        if below is None or above is None:
            return False
        words = [Counter(x.verdict.word for x in self.intervals[k].equilibria) for k in (below, above)]
        if words[0] != words[1]:
            return True
        on = self.criticals.index(one)
        pairs = [
            (a, b)
            for a in self.pieces
            for b in self.pieces
            if a.interval == below and b.interval == above and a.end is not None and a.end == b.start
        ]
        regular = [
            (a, b) for a, b in pairs if (self.criticals[on].meetings or ())[a.end or 0].named.event is Event.REGULAR
        ]
        return any(self.verdict(a).word is not self.verdict(b).word for a, b in regular)

    def verdict(self, piece: Piece) -> Verdict:
        """The verdict at the sample of a piece's interval."""
        return self.intervals[piece.interval].equilibria[piece.number].verdict

    def certain(self, one: Critical) -> bool:
        """Whether the verdicts on both sides are proved up to a critical value."""
        sides = self.sides(one)
        return all(x.throughout for x in self.pieces if x.interval in sides)

    def happens(self, one: Critical) -> bool:
        """Whether anything is to be told of a critical value."""
        changed = None not in self.sides(one) and self.count_changes(one)
        changed = changed or self.leaves(one) or self.verdict_changes(one)
        return bool(one.events) or one.balance is False or changed

    def spans(self) -> list[tuple[Interval, Interval]]:
        """The first and last of the intervals between which nothing happens, in their order."""
        found: list[tuple[Interval, Interval]] = []
        for one in self.intervals:
            between = next((c for c in self.criticals if compare(c.number, one.low) == 0), None)
            if found and between is not None and not self.happens(between):
                found[-1] = found[-1][0], one
            else:
                found.append((one, one))
        return found

    @property
    def proved(self) -> bool:
        """Whether the numbers of equilibria are proved everywhere in the open intervals."""
        return not self.interrupted and all(one.constant for one in self.intervals)
