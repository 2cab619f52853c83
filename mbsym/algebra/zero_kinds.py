"""What is known of the zeros of a polynomial: sets, values, and how each is known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from mbsym.algebra.polynomial_systems import Limits
from mbsym.algebra.ring import Polynomial

#: How a set is known: its zeros isolated exactly, or in number fields; a change of sign proved by balls; a search.
EXACT, SIGNS, UNDECIDED = "exact", "signs", "undecided"

#: Boxes that are looked at for one factor, and bits at which that is done.
MOST_BOXES, BITS = 6_000, 96

#: Zeros are known to so many bits.
PRECISION = 320

#: A factor in half angles is not formed beyond so many terms.
MOST_TERMS = 3_000

#: Critical points are sought with so much work.
CRITICAL = Limits(branches=60, elements=40, terms=200, solutions=40, work=400_000)


@dataclass(frozen=True)
class Zero:
    """A value of a variable: ``turns`` * pi where it is that exactly, else None; ``ball`` encloses it."""

    ball: Any
    turns: Fraction | None = None
    rational: Fraction | None = None


@dataclass(frozen=True)
class ZeroSet:
    """Where one irreducible ``factor`` vanishes.

    ``names`` are what it depends on.  With one name ``zeros`` lists all its values, an angle's in one period.  With
    several names ``point`` is a point of the set (exact, or proved to lie near a zero by signs), None where the search
    was undecided; ``nearest`` is then the point where the factor was smallest.  ``isolated``: the point is one of
    finitely many ``points``.
    """

    factor: Polynomial
    names: tuple[str, ...]
    known: str
    zeros: tuple[Zero, ...] = ()
    points: tuple[Mapping[str, Any], ...] = ()
    isolated: bool = False


@dataclass(frozen=True)
class Zeros:
    """All ``sets``; ``nowhere`` are the factors proved to have no zero; coordinates beyond ``range`` of several-name
    factors were not looked at (None: nothing depends on that)."""

    sets: tuple[ZeroSet, ...]
    nowhere: tuple[Polynomial, ...]
    bounded: tuple[str, ...]

    @property
    def complete(self) -> bool:
        """Whether it is proved that there are no others (coordinates within their ranges)."""
        return all(one.known != UNDECIDED for one in self.sets)
