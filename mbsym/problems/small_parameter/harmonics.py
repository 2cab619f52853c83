"""Trigonometric polynomials of one phase over the elements of a tower: sum_k C_k cos(k T) + S_k sin(k T)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mbsym.algebra.tower import Element, Tower

#: k >= 0 -> (C_k, S_k); S_0 is zero.  What is zero is left out.
Waves = Mapping[int, tuple[Element, Element]]


class Harmonics:
    """sum of ``waves`` in the phase T."""

    __slots__ = ("tower", "waves")

    def __init__(self, tower: Tower, waves: Waves) -> None:
        self.tower = tower
        self.waves = {k: (c, s) for k, (c, s) in waves.items() if not (c.is_zero() and s.is_zero())}

    @classmethod
    def constant(cls, tower: Tower, value: Element) -> Harmonics:
        return cls(tower, {0: (value, tower.zero)})

    @property
    def is_zero(self) -> bool:
        return not self.waves

    def wave(self, k: int) -> tuple[Element, Element]:
        return self.waves.get(k, (self.tower.zero, self.tower.zero))

    @property
    def mean(self) -> Element:
        return self.wave(0)[0]

    @property
    def start(self) -> Element:
        """The value at T = 0."""
        return sum((c for c, _ in self.waves.values()), self.tower.zero)

    def __add__(self, other: Harmonics) -> Harmonics:
        total = dict(self.waves)
        for k, (c, s) in other.waves.items():
            total[k] = (total[k][0] + c, total[k][1] + s) if k in total else (c, s)
        return Harmonics(self.tower, total)

    def __sub__(self, other: Harmonics) -> Harmonics:
        return self + other.scaled(-self.tower.one)

    def scaled(self, factor: Element) -> Harmonics:
        return Harmonics(self.tower, {k: (c * factor, s * factor) for k, (c, s) in self.waves.items()})

    def __mul__(self, other: Harmonics) -> Harmonics:
        total: dict[int, tuple[Element, Element]] = {}
        half, zero = self.tower.number(1) / self.tower.number(2), self.tower.zero

        def add(k: int, c: Element, s: Element) -> None:
            if k < 0:
                k, s = -k, -s
            if k == 0:
                s = zero
            total[k] = (total[k][0] + c, total[k][1] + s) if k in total else (c, s)

        for m, (a, b) in self.waves.items():
            for n, (c, d) in other.waves.items():
                if m == 0 or n == 0:
                    # exact: neither product with sin(0) is there
                    add(m + n, a * c, a * d if m == 0 else b * c)
                    continue
                ac, bd, ad, bc = a * c, b * d, a * d, b * c
                add(m + n, (ac - bd) * half, (ad + bc) * half)
                add(m - n, (ac + bd) * half, (bc - ad) * half)
        return Harmonics(self.tower, total)

    def slope(self) -> Harmonics:
        """d/dT."""
        return Harmonics(self.tower, {k: (s * k, -(c * k)) for k, (c, s) in self.waves.items() if k})

    def sum_from_zero(self) -> Harmonics:
        """The integral from T = 0 of what has no mean."""
        tower, parts = self.tower, {}
        total = tower.zero
        for k, (c, s) in self.waves.items():
            if k:
                parts[k] = (-(s / tower.number(k)), c / tower.number(k))
                total = total - parts[k][0]
        parts[0] = (total, tower.zero)
        return Harmonics(tower, parts)

    def mapped(self, change: Any) -> Harmonics:
        return Harmonics(self.tower, {k: (change(c), change(s)) for k, (c, s) in self.waves.items()})
