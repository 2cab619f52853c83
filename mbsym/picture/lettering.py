"""Where letters stand beside what they belong to: none upon another, and as few as possible upon lines."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from itertools import pairwise
from math import ceil, cos, dist, hypot, pi, sin
from typing import Generic, NamedTuple, TypeVar

Place = tuple[float, float]
T = TypeVar("T")

#: The height of a letter, the width of the first and of each further one, in centimetres.
HIGH, FIRST, FURTHER = 0.36, 0.26, 0.17

#: Lines are kept in mind by points so far apart.
APART = 0.12

#: Directions and distances that are tried.
AROUND, FURTHER_OUT = 12, (0.0, 0.12, 0.26, 0.45)


class _Wanted(NamedTuple, Generic[T]):
    what: T
    wide: float
    place: Place
    away: Place
    near: float


class Letters(Generic[T]):
    """Letters that are wanted, and points of ``lines`` on which they had better not stand."""

    def __init__(self) -> None:
        self._wanted: list[_Wanted[T]] = []
        self.lines: list[Place] = []
        self._boxes: list[tuple[Place, float]] = []

    def avoid(self, points: Sequence[Place], closed: bool) -> None:
        """A line of a drawing."""
        ring = [*points, points[0]] if closed else list(points)
        for first, second in pairwise(ring):
            count = max(1, ceil(dist(first, second) / APART))
            for k in range(count + 1):
                s = k / count
                self.lines.append((first[0] + s * (second[0] - first[0]), first[1] + s * (second[1] - first[1])))
        if len(ring) == 1:
            self.lines.append(ring[0])

    def add(self, what: T, letters: str, place: Place, away: Place, near: float) -> None:
        """One of so many ``letters`` beside a place, at ``near`` centimetres, rather in the direction ``away``."""
        self._wanted.append(_Wanted(what, FIRST + FURTHER * (len(letters) - 1), place, away, near))

    def box(self) -> tuple[Place, Place]:
        """The corners about everything so far."""
        points = [*self.lines]
        for (x, y), wide in self._boxes:
            points += [(x - wide / 2, y - HIGH / 2), (x + wide / 2, y + HIGH / 2)]
        xs, ys = [x for x, _ in points], [y for _, y in points]
        return (min(xs), min(ys)), (max(xs), max(ys))

    def placed(self) -> list[tuple[T, Place]]:
        """Each with the middle of its place; what would cover another one stands nowhere."""
        placements, lines = [], sorted(self.lines)
        for letter in self._wanted:
            place = self._best(letter, lines)
            if place is not None:
                self._boxes.append((place, letter.wide))
                placements.append((letter.what, place))
        return placements

    def _best(self, letter: _Wanted[T], lines: Sequence[Place]) -> Place | None:
        """``lines`` are those to be avoided, from left to right."""
        best, least = None, float("inf")
        size = hypot(*letter.away)
        for out in FURTHER_OUT:
            for k in range(AROUND if letter.near else 1):
                angle = 2 * pi * k / AROUND
                x, y = (letter.away[0] / size, letter.away[1] / size) if size else (1.0, 0.0)
                x, y = x * cos(angle) - y * sin(angle), x * sin(angle) + y * cos(angle)
                # So far that the box just leaves the place.
                reach = letter.near + out + min(letter.wide / 2 / max(abs(x), 1e-9), HIGH / 2 / max(abs(y), 1e-9))
                place = (letter.place[0] + reach * x, letter.place[1] + reach * y) if letter.near else letter.place
                if any(_meet(place, letter.wide, other, wide) for other, wide in self._boxes):
                    continue
                half = letter.wide / 2 + 0.02
                near = slice(bisect_left(lines, (place[0] - half,)), bisect_left(lines, (place[0] + half,)))
                crossed = sum(abs(q - place[1]) < HIGH / 2 + 0.02 for _, q in lines[near])
                cost = 3 * crossed + 4 * out + (1 - cos(angle) if size else 0.0)
                if cost < least - 1e-9:
                    best, least = place, cost
            if not letter.near:
                break
        return best


def _meet(first: Place, wide: float, second: Place, other: float) -> bool:
    return abs(first[0] - second[0]) < (wide + other) / 2 + 0.04 and abs(first[1] - second[1]) < HIGH + 0.02
