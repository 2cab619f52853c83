"""``floquet.json`` of ``mbsym floquet``."""

from __future__ import annotations

from typing import Annotated, Literal

from mbsym.numerics.orbits.floquet import Word
from mbsym.report.documents.base import ASIDE, Hashed, Part, words


class Multiplier(Part, frozen=True):
    """one of them"""

    real: Annotated[str, "real part, midpoint and radius"]
    imaginary: Annotated[str, "imaginary part, midpoint and radius"]
    size_at_least: Annotated[float, "proved lower bound of its absolute value"]
    size_at_most: Annotated[float, "proved upper bound"]
    on_unit_circle: Annotated[bool, "whether it is proved to be on the unit circle"]


class Floquet(Hashed, frozen=True, kw_only=True):
    """What the multipliers of a time-periodic first approximation prove."""

    verdict: Annotated[
        str, words(Word), "what is proved of the unperturbed motion; of the first approximation only where it says so"
    ]
    motion: Annotated[
        Literal["proved", "verified numerically"],
        "how far it is known that the unperturbed motion satisfies the equations",
    ]
    lagrangian: Annotated[
        bool,
        "whether the equations are known to follow from a Lagrangian, so that multipliers come in pairs mu, 1/conj(mu)",
    ]
    frequency: Annotated[str, "2 pi over the period, an exact fraction of the numbers as they are computed with"]
    period: Annotated[str, "a period of the coefficients, 30 digits"]
    multipliers: Annotated[list[Multiplier], "multipliers as balls, the largest first"]
    simple: Annotated[bool, "whether all multipliers are proved to be simple"]
    monodromy: Annotated[
        list[Annotated[list[Annotated[str, "entry, midpoint and radius"]], "row"]],
        "a matrix of balls that contains the monodromy matrix, row by row",
    ]
    steps: Annotated[int, "steps of the enclosure", ASIDE]
