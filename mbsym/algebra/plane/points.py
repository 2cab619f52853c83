"""Exact points of the plane, at which the sign of every polynomial with rational coefficients is decided."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from flint import fmpq, fmpq_poly

from mbsym.algebra.plane.fields import Over
from mbsym.algebra.plane.numbers import AlgebraicNumber, Ball, enclosure, sign
from mbsym.algebra.plane.projection import Polynomial, coefficients


@dataclass(frozen=True, eq=False)
class Point:
    """(x, y): each a flint.fmpq or an AlgebraicNumber; y may be the root of a polynomial over QQ(x) instead."""

    x: Any
    y: Any

    @property
    def rational(self) -> bool:
        return isinstance(self.x, fmpq) and isinstance(self.y, fmpq)

    def sign(self, polynomial: Polynomial) -> int:
        """The sign of polynomial(x, y), exactly."""
        in_y = coefficients(polynomial, 1)
        if isinstance(self.x, fmpq):
            over = fmpq_poly([c(self.x) for c in in_y])
            return sign(over(self.y)) if isinstance(self.y, fmpq) else self.y.sign(over)
        x: AlgebraicNumber = self.x
        if isinstance(self.y, fmpq):
            total = fmpq_poly([0])
            for c in reversed(in_y):
                total = total * self.y + c
            return x.sign(total)
        root: Over = self.y
        return root.sign(root.over.trimmed(in_y))

    def enclosures(self, bits: int = 64) -> tuple[Ball, Ball]:
        """Balls around x and y of about this relative accuracy."""
        return enclosure(self.x, bits), self.y.enclosure(bits) if isinstance(self.y, Over) else enclosure(self.y, bits)

    def floats(self) -> tuple[float, float]:
        """The nearest doubles, or their neighbours."""
        x, y = self.enclosures(60)
        return float(x.mid()), float(y.mid())
