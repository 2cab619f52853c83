"""``orbit.json`` of ``mbsym orbit``."""

from __future__ import annotations

from typing import Annotated

from mbsym.report.documents.base import ASIDE, Hashed, Part


class Verified(Part, frozen=True):
    """the same by another method"""

    closure: Annotated[float | None, "how far; null where no other method could"]
    method: Annotated[str, "which one"]


class Multiplier(Part, frozen=True):
    """a complex number"""

    real: Annotated[float, "real part"]
    imaginary: Annotated[float, "imaginary part"]
    size: Annotated[float, "absolute value"]


class Reason(Part, frozen=True):
    """one of them"""

    reason: Annotated[str, "why"]
    moved: Annotated[float, "by how much the monodromy matrix moves its vector, relatively"]


class Trivial(Part, frozen=True):
    """multipliers that are 1 for a reason"""

    count: Annotated[int, "how many the reasons stand for"]
    reasons: Annotated[list[Reason], "the reasons"]


class Orbit(Hashed, frozen=True, kw_only=True):
    """A periodic motion that was found in floating point, and its Floquet multipliers; nothing in it is proved."""

    initial: Annotated[dict[str, Annotated[float, "value"]], "coordinates and velocities at t = 0, by name"]
    period: Annotated[float, "the period T"]
    repeats: Annotated[int, "how many times the motion runs through itself in T, as far as is seen"]
    turns: Annotated[dict[str, Annotated[float, "angle"]], "by what angles come back turned, in radians, by name"]
    energy: Annotated[float, "generalised energy"]
    closure: Annotated[float, "how far the motion is from closing, as part of the state's size"]
    verified: Verified
    newton_steps: Annotated[int, "steps of Newton's method", ASIDE]
    autonomous: Annotated[bool, "whether the equations do not know the time"]
    multipliers: Annotated[list[Multiplier], "Floquet multipliers, the largest first"]
    uncertainty: Annotated[float, "how far the multipliers move when they are computed with another tolerance"]
    determinant: Annotated[float, "of the monodromy matrix"]
    trivial: Trivial
    monodromy: Annotated[list[Annotated[list[Annotated[float, "entry"]], "row"]], "the monodromy matrix, row by row"]
