"""``lyapunov.json`` of ``mbsym lyapunov``."""

from __future__ import annotations

from typing import Annotated

from mbsym.numerics.orbits.lyapunov import Parting
from mbsym.report.documents.base import Hashed, Part, words


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
