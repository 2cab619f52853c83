"""An interval of a parameter, or of a symbol of the notation."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True)
class Axis:
    """Open: ``low`` and ``high`` do not belong to it."""

    name: str
    low: Fraction
    high: Fraction
