"""``orbit.json``, ``floquet.json``, ``lyapunov.json`` of the commands of these names."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from mbsym.numerics.orbits.floquet import Word
from mbsym.numerics.orbits.lyapunov import Parting
from mbsym.report.documents.base import ASIDE, From, Hashed, Part, words


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
    turns: Annotated[
        dict[str, Annotated[float, "angle"]],
        "by what angles come back turned, in radians, or coordinates shifted, by name",
    ]
    energy: Annotated[float, "generalised energy"]
    closure: Annotated[float, "how far the motion is from closing, as part of the motion's size"]
    verified: Verified
    newton_steps: Annotated[int, "steps of Newton's method", ASIDE, From("steps")]
    autonomous: Annotated[bool, "whether the equations do not know the time"]
    multipliers: Annotated[list[Multiplier], "Floquet multipliers, the largest first"]
    uncertainty: Annotated[float, "how far the multipliers move when they are computed with another tolerance"]
    determinant: Annotated[float, "of the monodromy matrix"]
    trivial: Trivial
    monodromy: Annotated[list[Annotated[list[Annotated[float, "entry"]], "row"]], "the monodromy matrix, row by row"]


#: Digits of enclosed numbers.
DIGITS = 12


def _shown(ball: Any) -> str:
    return str(ball.str(DIGITS))


def _entries(matrix: Any) -> list[list[str]]:
    return [[_shown(entry) for entry in row] for row in matrix.tolist()]


class PeriodicMultiplier(Part, frozen=True):
    """one of them"""

    real: Annotated[str, "real part, midpoint and radius", From("ball.real", _shown)]
    imaginary: Annotated[str, "imaginary part, midpoint and radius", From("ball.imag", _shown)]
    size_at_least: Annotated[float, "proved lower bound of its absolute value", From("least")]
    size_at_most: Annotated[float, "proved upper bound", From("greatest")]
    on_unit_circle: Annotated[bool, "whether it is proved to be on the unit circle", From("on_circle")]


class Floquet(Hashed, frozen=True, kw_only=True):
    """What the multipliers of a time-periodic first approximation prove."""

    verdict: Annotated[
        str,
        words(Word),
        "what is proved of the unperturbed motion; of the first approximation only where it says so",
        From("word"),
    ]
    motion: Annotated[
        Literal["proved", "verified numerically"],
        "how far it is known that the unperturbed motion satisfies the equations",
        From("rests", lambda rests: "proved" if rests else "verified numerically"),
    ]
    lagrangian: Annotated[
        bool,
        "whether the equations are known to follow from a Lagrangian, so that multipliers come in pairs mu, 1/conj(mu)",
    ]
    frequency: Annotated[str, "2 pi over the period, an exact fraction of the numbers as they are computed with"]
    period: Annotated[str, "a period of the coefficients, 30 digits", From(by=lambda x: x.str(30, radius=False))]
    multipliers: Annotated[list[PeriodicMultiplier], "multipliers as balls, the largest first"]
    simple: Annotated[bool, "whether all multipliers are proved to be simple"]
    monodromy: Annotated[
        list[Annotated[list[Annotated[str, "entry, midpoint and radius"]], "row"]],
        "a matrix of balls that contains the monodromy matrix, row by row",
        From(by=_entries),
    ]
    steps: Annotated[int, "steps of the enclosure", ASIDE]


class Exponent(Part, frozen=True):
    """one of them"""

    value: Annotated[float | None, "its value"]
    uncertainty: Annotated[
        float | None,
        "half of the 95 % interval of the mean, statistics only; null where there was too little to average",
    ]


class Lyapunov(Hashed, frozen=True, kw_only=True):
    """Lyapunov exponents over a finite time; they prove nothing about all times."""

    time: Annotated[float, "over how long"]
    exponents: Annotated[list[Exponent], "exponents, the largest first"]
    largest: Annotated[str | None, "what the largest one says over this time", words(Parting)]
    divergence: Annotated[float | None, "mean of the trace of the Jacobian along the motion"]
    sum_error: Annotated[float | None, "how far the sum of all exponents is from it; null where not all were measured"]
    ended: Annotated[str | None, "why it ended early"]
