"""Spatial chains with numbers, as mbsym descriptions and for Pinocchio: joints about axes 3, 2, 1, 3, 2, 1, ...

``principal``
    each joint and each mass centre on the third axis of the link before it, principal moments of inertia.
``full``
    joints and mass centres anywhere, full tensors.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True)
class Link:
    """One link: joint axis and place (in the axes of the link before), mass, mass centre, central inertia tensor."""

    axis: int
    place: tuple[Fraction, ...]
    mass: Fraction
    centre: tuple[Fraction, ...]
    inertia: tuple[tuple[Fraction, ...], ...]


GRAVITY = (Fraction(0), Fraction(0), Fraction(-981, 100))


def chain(joints: int, full: bool, seed: int = 7) -> list[Link]:
    """A chain of links of about unit size; the same on every run."""
    source = random.Random(seed)

    def length() -> Fraction:
        return Fraction(source.randint(20, 80), 100)

    links = []
    for k in range(joints):
        a, b, c = (length() + 1 for _ in range(3))
        off = [length() / 10 for _ in range(3)] if full else [Fraction(0)] * 3
        tensor = ((a, off[0], off[1]), (off[0], b, off[2]), (off[1], off[2], c))
        place = (length(), length(), length()) if full else (Fraction(0), Fraction(0), length())
        if k == 0:
            place = (Fraction(0),) * 3
        centre = (length(), length(), length()) if full else (Fraction(0), Fraction(0), length())
        links.append(Link((3, 2, 1)[k % 3], place, length() + 1, centre, tensor))
    return links


def state(joints: int, seed: int = 11) -> tuple[list[Fraction], list[Fraction]]:
    """(q, q')."""
    source = random.Random(seed)
    q = [Fraction(source.randint(-100, 100), 100) for _ in range(joints)]
    return q, [Fraction(source.randint(-100, 100), 100) for _ in range(joints)]


def _vector(values: tuple[Fraction, ...]) -> str:
    return "[" + ", ".join(str(float(value)) for value in values) + "]"


def description(links: list[Link]) -> str:
    """The chain as YAML; every number is in the description, as it is in Pinocchio's model."""
    q, qd = state(len(links))
    lines = ["mbsym: 1", f"name: Chain of {len(links)} joints", "bodies:"]
    for k, link in enumerate(links, 1):
        lines += [
            f"  - name: link {k}",
            f"    attached to: {'0' if k == 1 else f'link {k - 1}'}",
            f"    rotation: {{axes: [{link.axis}], angles: [q{k}]}}",
            f"    connection point: {_vector(link.place)}",
            f"    mass centre: {_vector(link.centre)}",
            f"    mass: {float(link.mass)}",
            "    inertia about: mass centre",
            f"    inertia: [{', '.join(_vector(row) for row in link.inertia)}]",
        ]
    lines += ["loads:", f"  - uniform gravity: {{vector: {_vector(GRAVITY)}}}", "initial:"]
    for k, (position, velocity) in enumerate(zip(q, qd, strict=True), 1):
        lines.append(f"  q{k}: {{position: {float(position)}, velocity: {float(velocity)}}}")
    return "\n".join(lines) + "\n"


def for_pinocchio(links: list[Link]) -> str:
    """What ``peer_pinocchio`` reads; torques are zero."""
    q, qd = state(len(links))
    lines = [f"{len(links)} " + " ".join(str(float(x)) for x in GRAVITY)]
    for link in links:
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = link.inertia
        numbers = (*link.place, link.mass, *link.centre, xx, xy, yy, xz, yz, zz)
        lines.append(f"{link.axis} " + " ".join(str(float(x)) for x in numbers))
    lines.append(" ".join(str(float(x)) for x in (*q, *qd)) + " 0" * len(links))
    return "\n".join(lines) + "\n"
