"""Which generators stand in polynomials."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import compress, count

from mbsym.algebra.factors import Polynomial


def occurring(polynomials: Iterable[Polynomial]) -> list[int]:
    """Positions of the generators that stand plainly in at least one of the polynomials, in order.

    What an adjoined generator is made of (the argument of a root or a function) is not looked into.
    """
    found: set[int] = set()
    for x in polynomials:
        if x:  # else all degrees are -1
            found.update(compress(count(), x.degrees()))
    return sorted(found)
