"""Which generators stand in polynomials."""

from __future__ import annotations

from collections.abc import Iterable

from mbsym.algebra.factors import Polynomial


def occurring(polynomials: Iterable[Polynomial]) -> list[int]:
    """Positions of the generators that stand plainly in at least one of the polynomials, in order.

    What an adjoined generator is made of (the argument of a root or a function) is not looked into.
    """
    return sorted({k for x in polynomials for k, degree in enumerate(x.degrees()) if degree > 0})
