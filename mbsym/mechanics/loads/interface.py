"""What every kind of load can say of itself: its force function, and the wrenches and generalised forces it exerts.

The two are independent statements of one thing.  Lagrange's equations take the force function U where there is one and
wrenches otherwise; the Newton-Euler recursion takes wrenches always; where they disagree the self-check fails.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any, Generic, NamedTuple, TypeVar

from mbsym.algebra.base import S
from mbsym.algebra.vectors import Vector
from mbsym.mechanics.intermediates import Quantity
from mbsym.mechanics.kinematics import Scene

L = TypeVar("L")


@dataclass(frozen=True, slots=True)
class Wrench(Generic[S]):
    """A force on a body and its moment about the body's connection point O_k, in the body's axes."""

    body: str
    force: Vector[S]
    moment: Vector[S]


@dataclass(frozen=True, slots=True)
class Action(Generic[S]):
    """What a load does: wrenches on bodies, and generalised forces Q on coordinates, in speeds on these, too."""

    wrenches: tuple[Wrench[S], ...] = ()
    generalized: dict[str, S] = field(default_factory=dict)


class Note(NamedTuple):
    """A vector or scalar on which a load depends and that has a name in mechanics; ``body`` is empty for none."""

    quantity: Quantity
    body: str
    value: Any


@dataclass(frozen=True)
class Kind(Generic[L]):
    """What a kind of load does to a motion; what it says of itself stands with its type in ``mbsym.model.loads``.

    ``force_function``: U; None where it has none.
    ``field``: the acceleration g that it gives to every mass alike, in inertial axes: a base accelerated by -g has the
    same effect.  None for all other loads.
    ``falls``: frames may fall in it (``mbsym.mechanics.falling``), and seen from these it acts by its variation only.
    ``notes``: the quantities that its formulas are told through.
    ``upward``: against it, in the axes of a frame, where there is such a direction: for pictures.
    """

    action: Callable[[L, Scene[S]], Action[S]]
    force_function: Callable[[L, Scene[S]], S] | None = None
    field: Callable[[L, Scene[S]], Vector[S]] | None = None
    falls: bool = False
    notes: Callable[[L, Scene[S]], Iterable[Note]] | None = None
    upward: Callable[[L, Scene[S], str], Vector[S] | None] | None = None


def force_at(point: Vector[S], force: Vector[S]) -> Wrench[S]:
    """The wrench of a force on a point of a body, both in its axes."""
    return Wrench(force.frame, force, point.cross(force))
