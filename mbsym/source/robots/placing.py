"""From a link's pose and joints to bodies: displacements and turns in a row, as few bodies as they fit in.

A body of a description is placed by one displacement in the axes of its carrier, followed by up to three turns.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from mbsym.source.robots.numbers import NOWHERE, Texts, angle, number, opposite
from mbsym.source.robots.robot import Joint, Turns

#: What a body can turn about.
MOST_TURNS = 3


@dataclass(frozen=True, slots=True)
class Step:
    """A displacement and the turns after it; ``coordinates`` are those that it introduces."""

    place: Texts = NOWHERE
    turns: Turns = ()
    coordinates: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Moving:
    """A joint with the coordinates that it introduces; one that turns or slides does so by ``value``."""

    joint: Joint
    names: tuple[str, ...]
    value: str = ""


def steps(place: Texts, turned: Turns, joints: tuple[Moving, ...]) -> tuple[Step, ...]:
    """The steps that lead over a link's pose and its joints to its axes."""
    moves = [Step(place), *(Step(turns=(turn,)) for turn in turned)]
    for moving in joints:
        moves += _moves(moving)
    return tuple(_joined(moves))


def _moves(moving: Moving) -> list[Step]:
    """A joint as elementary steps; a turn about a point elsewhere goes there and comes back."""
    joint, names, value = moving.joint, moving.names, moving.value
    match joint.kind:
        case "slide":
            return [Step(along(joint.axis, value), (), names)]
        case "turn":
            turns = [
                Step(turns=(turn,), coordinates=names if value in turn[1] else ())
                for turn in turns_about(joint.axis, value)
            ]
        case _:
            angles = names[-3:]
            turns = [
                Step(turns=((axis, name),), coordinates=(name,)) for axis, name in zip((3, 2, 1), angles, strict=True)
            ]
    if joint.kind == "free":
        return [Step((names[0], names[1], names[2]), (), names[:3]), *turns]
    there, back = joint.anchor, tuple(map(opposite, joint.anchor))
    return turns if there == NOWHERE else [Step(there), *turns, Step((back[0], back[1], back[2]))]


def _joined(moves: list[Step]) -> Iterator[Step]:
    """Steps put together as far as a body can hold them."""
    now = Step()
    for move in moves:
        names = (*now.coordinates, *move.coordinates)
        if move.place != NOWHERE:
            if now.turns:
                yield now
                now = move
            else:
                now = Step(_sum(now.place, move.place), move.turns, names)
        elif len(now.turns) + len(move.turns) > MOST_TURNS:
            yield now
            now = move
        else:
            now = Step(now.place, now.turns + move.turns, names)
    yield now


def _sum(one: Texts, other: Texts) -> Texts:
    added = [
        b if a == "0" else a if b == "0" else f"{a} - {b[1:]}" if b.startswith("-") else f"{a} + {b}"
        for a, b in zip(one, other, strict=True)
    ]
    return added[0], added[1], added[2]


def turns_about(axis: Texts, name: str) -> Turns:
    """The turn by a name or formula about an axis: e_3 = Ry(b) Rz(a) turned onto it, where it is no coordinate axis."""
    x, y, z = map(float, axis)
    on = [k for k, value in enumerate((x, y, z), start=1) if value != 0]
    if len(on) == 1:
        positive = (x, y, z)[on[0] - 1] > 0
        return ((on[0], name if positive else _negative(name)),)
    azimuth, slope = angle(repr(math.atan2(y, x))), angle(repr(math.atan2(math.hypot(x, y), z)))
    return tuple(
        turn
        for turn in ((3, azimuth), (2, slope), (3, name), (2, opposite(slope)), (3, opposite(azimuth)))
        if turn[1] != "0"
    )


def _negative(name: str) -> str:
    return f"-{name}" if name.isidentifier() else f"-({name})"


def along(axis: Texts, name: str) -> Texts:
    """``name`` (or a formula) times the unit vector of an axis."""
    name = name if name.isidentifier() else f"({name})"
    components = list(map(float, axis))
    length = math.hypot(*components)
    moved = []
    for component in components:
        size = number(repr(abs(component) / length))
        step = "0" if size == "0" else name if size == "1" else f"{size}*{name}"
        moved.append(f"-{step}" if component < 0 and step != "0" else step)
    return moved[0], moved[1], moved[2]
