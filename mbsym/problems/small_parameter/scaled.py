"""A polynomial field sorted by powers of a small parameter."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from mbsym.algebra.polynomial_field import PolynomialField

Polynomial = Any  # a flint.fmpq_mpoly: python-flint carries no types
#: Exponent of eps -> coefficient; none is zero.
Graded = Mapping[int, Polynomial]


@dataclass(frozen=True)
class ScaledField:
    """x'_i = (sum_k rows[i][k] eps^k) / (sum_k denominator[k] eps^k), over the context of ``field``.

    ``powers``: every parameter P in it stands for P eps^power.  The small parameter itself, where it is one of the
    parameters, occurs in no coefficient.  The lowest exponent of the denominator is 0.
    """

    field: PolynomialField
    small: str
    powers: tuple[tuple[str, int], ...]
    rows: tuple[Graded, ...]
    denominator: Graded

    @property
    def scales(self) -> tuple[int, ...]:
        """k_i for which eps^k_i x'_i is regular at eps = 0 and not zero there; negative for what moves slowly."""
        return tuple(-min(row, default=0) for row in self.rows)


def scaled(field: PolynomialField, small: str, powers: Mapping[str, int]) -> ScaledField:
    """The field with P eps^power in place of parameters P; without ``powers`` the small parameter is one of them."""
    names = tuple(field.context.names())
    weights = [0] * len(names)
    if small in names:
        weights[names.index(small)] = 1
    for name, power in powers.items():
        if name in names:
            weights[names.index(name)] = power
    own = names.index(small) if small in names else None

    def graded(p: Polynomial) -> dict[int, Polynomial]:
        parts: dict[int, dict[tuple[int, ...], Any]] = {}
        for monomial, c in p.to_dict().items():
            order = sum(weights[k] * int(e) for k, e in enumerate(monomial) if e)
            if own is not None:
                monomial = (*monomial[:own], 0, *monomial[own + 1 :])
            parts.setdefault(order, {})[monomial] = c
        return {k: field.context.from_dict(part) for k, part in parts.items()}

    denominator = graded(field.denominator)
    least = min(denominator)
    return ScaledField(
        field,
        small,
        tuple(powers.items()),
        tuple({k - least: p for k, p in graded(row).items()} for row in field.numerators),
        {k - least: p for k, p in denominator.items()},
    )
