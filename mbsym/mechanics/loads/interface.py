"""What every kind of load can say of itself: its force function, and the wrenches and generalised forces it exerts.

The two are independent statements of one thing.  Lagrange's equations take the force function U where there is one and
wrenches otherwise; the Newton-Euler recursion takes wrenches always; where they disagree the self-check fails.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from mbsym.algebra.base import Scalar
from mbsym.algebra.vectors import Vector
from mbsym.mechanics.kinematics import Scene

L = TypeVar("L")


@dataclass(frozen=True, slots=True)
class Wrench:
    """A force on a body and its moment about the body's connection point O_k, in the body's axes."""

    body: str
    force: Vector
    moment: Vector


@dataclass(frozen=True, slots=True)
class Action:
    """What a load does: wrenches on bodies, and generalised forces Q on coordinates."""

    wrenches: tuple[Wrench, ...] = ()
    generalized: dict[str, Scalar] = field(default_factory=dict)


@dataclass(frozen=True)
class Kind(Generic[L]):
    """``force_function`` is None for loads that have none; ``action`` is always there."""

    action: Callable[[L, Scene], Action]
    force_function: Callable[[L, Scene], Scalar] | None = None


def force_at(point: Vector, force: Vector) -> Wrench:
    """The wrench of a force on a point of a body, both in its axes."""
    return Wrench(force.frame, force, point.cross(force))
