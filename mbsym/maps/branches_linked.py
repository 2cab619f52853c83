"""Which branch tends to which equilibrium at a critical value: followed in floating point, then held against counts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import chain

from flint import arb

from mbsym.algebra.plane.numbers import enclosure
from mbsym.maps.branches_curve import Curve
from mbsym.maps.branches_followed import followed, uses_only_known
from mbsym.maps.branches_result import Branches, Meeting, Piece
from mbsym.maps.mapping import float_of
from mbsym.maps.result import Cell
from mbsym.problems.relative_equilibria.equilibria import RelativeEquilibrium
from mbsym.problems.relative_equilibria.place import Place

#: Farther than this (in direction cosines, sines, cosines, lengths) a branch does not tend to an equilibrium.
FAR = 0.05


def linked(parts: Sequence[Curve], found: Branches) -> list[Piece]:
    """The branches over all intervals, with the meetings they start from and end in."""
    usable = {one.label: one for one in parts if uses_only_known(one.ring, [*one.forcing, *chain(*one.slopes)])}
    pieces: list[Piece] = []
    for interval in found.intervals:
        made: list[Piece] = []
        arrivals: list[tuple[tuple[float, ...] | None, tuple[float, ...] | None]] = []
        for number, one in enumerate(found.equilibria(interval)):
            piece, where = _followed(usable.get(one.coordinates_of), one, found, interval, number)
            made.append(piece)
            arrivals.append(where)
        starts, stops = (
            _assigned(found, critical, [x[side] for x in arrivals], usable, below=side == 1)
            for side, critical in enumerate(found.between(interval))
        )
        pieces += [replace(one, start=a, end=b) for one, a, b in zip(made, starts, stops, strict=True)]
    return pieces


def _followed(
    curve: Curve | None, one: RelativeEquilibrium, found: Branches, interval: Cell, number: int
) -> tuple[Piece, tuple[tuple[float, ...] | None, tuple[float, ...] | None]]:
    sample, k = float_of(interval.sample), interval.number
    values = {x.name: x.value for x in one.values}
    if curve is None or set(curve.names) != set(values):
        start = tuple(x.value for x in one.values)
        return Piece(k, number, False, None, None, (sample,), (start,)), (None, None)
    low, high = (float(enclosure(x).mid()) for x in found.ends(interval))
    start = tuple(values[name] for name in curve.names)
    ps, qs, at_low, at_high = followed(curve, start, sample, low, high)
    piece = Piece(k, number, False, None, None, tuple(ps), tuple(qs))
    arrived = (
        _features(curve, ps[0], qs[0]) if at_low else None,
        _features(curve, ps[-1], qs[-1]) if at_high else None,
    )
    return piece, arrived


def _features(curve: Curve, p: float, q: Sequence[float]) -> tuple[float, ...]:
    balls = {name: arb(x) for name, x in zip(curve.names, q, strict=True)} | {curve.parameter: arb(p)}
    place = Place(curve.found, balls, {}, None)
    return tuple(float(x.mid()) for x in curve.search._features(place))


def _assigned(
    found: Branches,
    at: Cell | None,
    arrivals: Sequence[tuple[float, ...] | None],
    usable: dict[str, Curve],
    below: bool,
) -> list[int | None]:
    """For every branch the number of the nearest meeting; nothing where the numbers that events demand do not come out.

    ``below``: the branches lie at smaller values of the parameter than the critical one.
    """
    nobody: list[int | None] = [None] * len(arrivals)
    meetings = None if at is None else found.critical(at).meetings
    if at is None or meetings is None:
        return nobody
    p = float(enclosure(at.sample).mid())
    places = [_features_at(one, usable, p) for one in meetings]
    chosen: list[int | None] = []
    for where in arrivals:
        distances = [
            (math.dist(where, x), k) for k, x in enumerate(places) if where is not None and x is not None
            and len(x) == len(where)
        ]  # fmt: skip
        nearest = min(distances, default=(math.inf, -1))
        chosen.append(nearest[1] if nearest[0] < FAR else None)
    wanted = [one.named.below if below else one.named.above for one in meetings]
    return [
        k if k is not None and (wanted[k] is None or chosen.count(k) == wanted[k]) else None for k in chosen
    ]  # fmt: skip


def _features_at(one: Meeting, usable: dict[str, Curve], p: float) -> tuple[float, ...] | None:
    curve = usable.get(one.coordinates_of)
    if curve is None:
        return None
    values = {x.name: x.value for x in one.values}
    if set(values) != set(curve.names):
        return None
    return _features(curve, p, [values[name] for name in curve.names])
